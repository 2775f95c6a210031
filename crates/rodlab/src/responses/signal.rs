//! Lines with a signal.

/// Returns the first and the last line of the range with a signal: the range in which the number of
/// lines with a coherence above the chance level exceeds the number of other lines by most. Single
/// antiresonances do not end the range, and chance peaks of noise do not extend it.
pub(crate) fn stretch_with_signal(
    above_chance: impl IntoIterator<Item = bool>,
) -> Option<(usize, usize)> {
    let mut best: Option<(i64, usize, usize)> = None;
    let (mut sum, mut from) = (0_i64, 0);
    for (line, above) in above_chance.into_iter().enumerate() {
        sum += if above { 1 } else { -1 };
        if sum <= 0 {
            (sum, from) = (0, line + 1);
        } else if best.is_none_or(|(most, _, _)| sum > most) {
            best = Some((sum, from, line));
        }
    }
    best.map(|(_, from, to)| (from, to))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r24_a_stretch_bridges_antiresonances_and_leaves_noise_out() {
        let of = |lines: &str| stretch_with_signal(lines.chars().map(|c| c == '+'));
        assert_eq!(of("-+-++++-+++++--++++---+--+---"), Some((3, 18)));
        assert_eq!(of("++++"), Some((0, 3)));
        assert_eq!(of("----"), None);
        assert_eq!(of(""), None);
    }
}
