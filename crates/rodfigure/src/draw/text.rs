//! Estimate of the length of a text.

/// Size of the numbers at ticks and of the names of vertical lines.
pub(super) const SMALL: f64 = 11.0;

/// Estimates the width of `text` in a sans-serif font of `size` pixels. No font is read; the
/// estimate is more likely too long than too short.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | '\'' | '.' | ',' | ':' | ';' | '|' | '!' => 0.28,
            'f' | 't' | 'r' | 'I' | ' ' | '(' | ')' | '[' | ']' | '/' | '-' => 0.34,
            'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.88,
            'A'..='Z' => 0.69,
            '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | '⁻' => 0.40,
            _ => 0.57,
        })
        .sum();
    em * size
}

/// Breaks `text` into lines no longer than `most`, if its words are short enough.
pub(super) fn lines(text: &str, size: f64, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line, size) + width(word, size) + 0.34 * size <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
