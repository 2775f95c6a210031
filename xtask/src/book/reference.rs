//! References of the pages to numbered equations: `(E A10)`, `(A 3-4)`, or in words "paper E, eq.
//! 8", "paper A, eqs. 5-7".

use super::page::Page;

/// Numbered equations of the papers: letter, last number of the text, last number of the appendix.
const PAPERS: [(char, u32, u32); 5] = [
    ('A', 7, 0),
    ('B', 9, 0),
    ('C', 5, 0),
    ('D', 14, 0),
    ('E', 10, 16),
];

/// Returns a fault for each reference of `page` to an equation that has another form, or whose
/// equation does not exist in the paper.
pub(super) fn faults(page: &Page) -> Vec<(usize, String)> {
    let mut faults = Vec::new();
    let mut own = Vec::new();
    for equation in &page.equations {
        let Ok((_, Some(tag))) = super::math::split_tag(&equation.tex) else {
            continue;
        };
        if tag.parse::<u32>().is_ok() {
            if own.contains(&tag) {
                faults.push((
                    equation.line,
                    format!("a second equation has the number ({tag})"),
                ));
            }
            own.push(tag);
        } else if let Err(fault) = of_a_paper(&tag) {
            faults.push((equation.line, fault));
        }
    }
    for prose in &page.prose {
        for inner in parenthesised(&prose.text) {
            let begins_as_reference = matches!(
                inner.as_bytes(),
                [b'A'..=b'E', b' ', b'0'..=b'9', ..] | [b'A'..=b'E', b' ', b'A', b'0'..=b'9', ..]
            );
            let glued =
                matches!(inner.as_bytes(), [b'A'..=b'E', b'0'..=b'9', ..]) && inner.len() <= 3;
            if glued {
                faults.push((
                    prose.line,
                    format!(
                        "({inner}): expected a blank between the paper and the number, as in (E 8)"
                    ),
                ));
            } else if begins_as_reference && !inner.contains(|c: char| c.is_ascii_lowercase()) {
                if let Err(fault) = of_a_paper(inner) {
                    faults.push((prose.line, fault));
                }
            } else if inner.len() == 1
                && inner.bytes().all(|c| c.is_ascii_digit())
                && !own.iter().any(|tag| tag == inner)
            {
                faults.push((
                    prose.line,
                    format!("({inner}): no equation of this page has that number"),
                ));
            }
        }
        faults.extend(
            in_words(&prose.text)
                .into_iter()
                .map(|fault| (prose.line, fault)),
        );
    }
    faults
}

/// Returns the contents of parentheses that contain no other parentheses and do not belong to a
/// function, as in G(0).
fn parenthesised(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut open = None;
    for (at, c) in text.char_indices() {
        match c {
            '(' => {
                let of_a_function = text[..at].ends_with(|before: char| before.is_alphanumeric());
                open = (!of_a_function).then_some(at + 1);
            }
            ')' => {
                if let Some(start) = open.take() {
                    found.push(&text[start..at]);
                }
            }
            _ => {}
        }
    }
    found
}

/// Checks references such as `E 8, 9, A7, A13-A14` and `A 2, B 3`: a letter, followed by numbers or
/// ranges, which must all exist; another paper may follow.
fn of_a_paper(reference: &str) -> Result<(), String> {
    let wrong = |why: &str| {
        Err(format!(
            "`{reference}` {why}; expected a letter and numbers, as in `E 8, A3-A4`"
        ))
    };
    let mut paper = None;
    for part in reference.split(", ") {
        let numbers = match part.split_once(' ') {
            Some(("Table", _)) => continue,
            Some((letter, numbers)) => {
                paper = PAPERS.iter().find(|paper| letter.chars().eq([paper.0]));
                numbers
            }
            None => part,
        };
        let Some(&(letter, last, last_of_appendix)) = paper else {
            return wrong("has no letter of a paper");
        };
        for end in numbers.split('-') {
            let (digits, limit) = match end.strip_prefix('A') {
                Some(digits) => (digits, last_of_appendix),
                None => (end, last),
            };
            match digits.parse::<u32>() {
                Ok(number) if (1..=limit).contains(&number) => {}
                Ok(_) => {
                    return Err(format!(
                        "`{reference}`: the numbers of paper {letter} end at {last}, those of its appendix at {last_of_appendix}; found {end}"
                    ));
                }
                Err(_) => return wrong("has a part that is not a number"),
            }
        }
    }
    Ok(())
}

/// Returns a fault for each abbreviation of "equation" that differs from `eq. 5` and `eqs. 5-7`.
fn in_words(text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    for other in [
        "Eq.", "Eqs.", "eqn", "Eqn", "eq.(", "eq. (", "eqs. (", "eqs.(",
    ] {
        if text.contains(other) {
            faults.push(format!("`{other}`: expected `eq. 5` or `eqs. 5-7`"));
        }
    }
    for (at, abbreviation) in text.match_indices("eq. ") {
        let number: String = text[at + abbreviation.len()..]
            .chars()
            .take_while(|c| c.is_ascii_digit() || matches!(c, 'A' | '-'))
            .collect();
        if number.contains('-') {
            faults.push(format!("`eq. {number}`: expected `eqs. {number}`"));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults_of(source: &str) -> Vec<String> {
        faults(&Page::read(source))
            .into_iter()
            .map(|(_, fault)| fault)
            .collect()
    }

    #[test]
    fn references_to_nothing_fail() {
        for wrong in [
            "(E A17)",
            "(A 8)",
            "(C 1-6)",
            "(E8)",
            "By (1).",
            "eq. (5)",
            "Eq. 5",
            "eq. 5-7",
            "```math\nx\n\\tag{F 1}\n```",
            "```math\nx\n\\tag{1}\n```\n\n```math\ny\n\\tag{1}\n```",
        ] {
            assert!(!faults_of(wrong).is_empty(), "{wrong}");
        }
    }
}
