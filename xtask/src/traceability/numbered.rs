//! Numbered items of the thesis: every equation, table and figure of the survey and of papers A to
//! E.
//!
//! The list was counted in the text of the thesis. It is kept apart from the rows of the page, so
//! that a missing row is noticed.

use std::fmt;

/// The survey or a paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    Survey,
    A,
    B,
    C,
    D,
    E,
}

impl Part {
    pub(crate) const ALL: [Self; 6] = [Self::Survey, Self::A, Self::B, Self::C, Self::D, Self::E];

    /// Returns the paper with this letter.
    pub(crate) fn of_letter(letter: char) -> Option<Self> {
        let mut papers = ('A'..='E').zip(Self::ALL.into_iter().skip(1));
        papers.find_map(|(own, paper)| (own == letter).then_some(paper))
    }

    /// Returns the title in the thesis.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Survey => "Survey",
            Self::A => {
                "Determination of complex modulus from measured end-point accelerations of an impacted rod specimen"
            }
            Self::B => {
                "In-situ determination of complex modulus from strain measurements on an impacted structure"
            }
            Self::C => {
                "Effects of load and recovery time on the complex modulus of polyoximethylene"
            }
            Self::D => {
                "Identification of viscoelastic materials from two-point electro-optical displacement measurements on an impacted rod"
            }
            Self::E => "Prediction of impact force by impulse response method",
        }
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Survey => write!(f, "survey"),
            paper => write!(f, "paper {paper:?}"),
        }
    }
}

/// Kind of a numbered item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Equation,
    Table,
    Figure,
}

impl Kind {
    pub(crate) const ALL: [Self; 3] = [Self::Equation, Self::Table, Self::Figure];
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Equation => "eq.",
            Self::Table => "Table",
            Self::Figure => "Figure",
        })
    }
}

/// Equation, table or figure of the thesis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Numbered {
    pub(crate) part: Part,
    pub(crate) kind: Kind,
    pub(crate) number: String,
}

impl Numbered {
    /// Returns true if the item can be cited by a number.
    pub(crate) fn has_number(&self) -> bool {
        self.number != UNNUMBERED
    }
}

impl fmt::Display for Numbered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} {}", self.part, self.kind, self.number)
    }
}

/// Runs of numbers: the text before the number, and the last number of the run. The first number
/// is 1.
const RUNS: [(Part, Kind, &str, u32); 24] = [
    (Part::Survey, Kind::Equation, "2.", 5),
    (Part::Survey, Kind::Equation, "3.", 3),
    (Part::Survey, Kind::Equation, "4.", 1),
    (Part::Survey, Kind::Equation, "5.", 3),
    (Part::Survey, Kind::Figure, "3.", 4),
    (Part::Survey, Kind::Figure, "4.", 1),
    (Part::Survey, Kind::Figure, "5.", 2),
    (Part::A, Kind::Equation, "", 7),
    (Part::A, Kind::Table, "", 2),
    (Part::A, Kind::Figure, "", 6),
    (Part::B, Kind::Equation, "", 9),
    (Part::B, Kind::Table, "", 1),
    (Part::B, Kind::Figure, "", 4),
    (Part::C, Kind::Equation, "", 5),
    (Part::C, Kind::Table, "", 1),
    (Part::C, Kind::Figure, "", 3),
    (Part::D, Kind::Equation, "", 14),
    (Part::D, Kind::Equation, UNNUMBERED, 0),
    (Part::D, Kind::Table, "", 5),
    (Part::D, Kind::Table, "A", 1),
    (Part::D, Kind::Figure, "", 2),
    (Part::E, Kind::Equation, "", 10),
    (Part::E, Kind::Equation, "A", 16),
    (Part::E, Kind::Figure, "", 6),
];

/// Item without a number: the error in Table 5, a displayed formula in the text of paper D,
/// section 4.
const UNNUMBERED: &str = "δ";

/// Returns all numbered items, in the order of the thesis.
pub(crate) fn all() -> Vec<Numbered> {
    Part::ALL
        .into_iter()
        .flat_map(|part| Kind::ALL.into_iter().map(move |kind| (part, kind)))
        .flat_map(|(part, kind)| {
            numbers(part, kind)
                .into_iter()
                .map(move |number| Numbered { part, kind, number })
        })
        .collect()
}

/// Returns the numbers of one kind in one part.
pub(crate) fn numbers(part: Part, kind: Kind) -> Vec<String> {
    RUNS.iter()
        .filter(|run| (run.0, run.1) == (part, kind))
        .flat_map(|(_, _, before, last)| match last {
            0 => vec![(*before).to_owned()],
            last => (1..=*last)
                .map(|number| format!("{before}{number}"))
                .collect(),
        })
        .collect()
}

/// Returns the numbers of one kind in one part as text, for messages.
pub(crate) fn in_words(part: Part, kind: Kind) -> String {
    let runs: Vec<String> = RUNS
        .iter()
        .filter(|run| (run.0, run.1) == (part, kind))
        .map(|(_, _, before, last)| match last {
            0 => (*before).to_owned(),
            1 => format!("{before}1"),
            last => format!("{before}1 to {before}{last}"),
        })
        .collect();
    match runs.as_slice() {
        [] => format!("no {kind}"),
        runs => format!("{kind} {}", runs.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with the counts for each part, which were made independently of the runs above.
    #[test]
    fn counts_are_those_of_the_thesis() {
        let counts = |part| Kind::ALL.map(|kind| numbers(part, kind).len());
        assert_eq!(counts(Part::Survey), [12, 0, 7]);
        assert_eq!(counts(Part::A), [7, 2, 6]);
        assert_eq!(counts(Part::B), [9, 1, 4]);
        assert_eq!(counts(Part::C), [5, 1, 3]);
        assert_eq!(counts(Part::D), [15, 6, 2]);
        assert_eq!(counts(Part::E), [26, 0, 6]);
        assert_eq!(all().len(), 112);
        assert!(
            RUNS.iter()
                .all(|run| Part::ALL.contains(&run.0) && Kind::ALL.contains(&run.1))
        );
    }
}
