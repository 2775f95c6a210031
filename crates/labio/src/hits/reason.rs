//! Reasons to reject a hit.

use std::fmt;

use thiserror::Error;

/// A reason to reject a hit, with its numbers. Levels and peaks are in the SI unit of the channel.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the text of a reason names its fields")]
#[non_exhaustive]
pub enum Reason {
    /// No signal exceeds the noise.
    #[error(
        "no hit: the largest excursion of `{channel}` is {}, its noise {}",
        Short(*.peak),
        Short(*.noise)
    )]
    NoHit {
        channel: String,
        /// Largest excursion from the rest level.
        peak: f64,
        /// Standard deviation of the noise.
        noise: f64,
    },
    /// The trigger never fired.
    #[error(
        "not triggered: `{channel}` {}; its values are between {} and {}",
        untriggered(*.level, *.hysteresis, [*.least, *.greatest]),
        Short(*.least),
        Short(*.greatest)
    )]
    NotTriggered {
        channel: String,
        level: f64,
        /// Distance from the level, on its other side, that the channel must have reached before.
        hysteresis: f64,
        /// Smallest sample.
        least: f64,
        /// Largest sample.
        greatest: f64,
    },
    /// The record begins too late.
    #[error(
        "cut at the start: {missing} samples are missing before the hit; start the record earlier, with a pre-trigger of about a tenth of its length"
    )]
    CutAtStart {
        /// Number of missing samples before the hit.
        missing: usize,
    },
    /// The record ends too early.
    #[error("cut at the end: {missing} samples are missing after the hit")]
    CutAtEnd {
        /// Number of missing samples after the hit.
        missing: usize,
    },
    /// A sample is NaN or infinite; some recorders mark lost samples in this way.
    #[error("lost samples: `{channel}` is NaN or infinite at sample {index}")]
    NonFinite {
        channel: String,
        /// Index of the first such sample in the hit.
        index: usize,
    },
    /// All samples of a channel are the same.
    #[error("dead channel: `{channel}` is {} throughout", Short(*.value))]
    Dead { channel: String, value: f64 },
    /// There was a second contact.
    #[error(
        "double hit: two contacts in `{channel}`, peaks in the ratio {}, {} ms apart",
        Short(*.ratio),
        Short(1e3 * .separation)
    )]
    DoubleHit {
        /// The channel of the force.
        channel: String,
        /// Peak of the smaller contact divided by that of the larger.
        ratio: f64,
        /// Time between the two peaks \[s\].
        separation: f64,
    },
    /// Samples reach the range of the recorder.
    #[error(
        "overload: {n_samples} samples of `{channel}` from sample {index} on reach the full scale of {}",
        Short(*.full_scale)
    )]
    Overload {
        channel: String,
        /// The stated range, in the recorded unit.
        full_scale: f64,
        n_samples: usize,
        /// Index of the first of these samples in the hit.
        index: usize,
    },
    /// The largest or smallest value repeats while the signal was moving.
    #[error(
        "clipped: `{channel}` stays at its extreme {} for {run} samples from sample {index} on",
        Short(*.value)
    )]
    Clipped {
        channel: String,
        /// The value, in the recorded unit.
        value: f64,
        /// Number of equal samples.
        run: usize,
        /// Index of the first of these samples in the hit.
        index: usize,
    },
    /// The signal is constant in the middle of a movement.
    #[error(
        "drop-out: `{channel}` stays at {} for {run} samples from sample {index} on",
        Short(*.value)
    )]
    DropOut {
        channel: String,
        /// The value, in the recorded unit.
        value: f64,
        /// Number of equal samples.
        run: usize,
        /// Index of the first of these samples in the hit.
        index: usize,
    },
    /// The rest level is far from zero.
    #[error(
        "static offset: `{channel}` rests at {}, more than {} times its peak of {}",
        Short(*.level),
        Short(*.limit),
        Short(*.peak)
    )]
    StaticOffset {
        channel: String,
        /// Rest level before the hit.
        level: f64,
        /// Largest excursion from the rest level.
        peak: f64,
        /// Largest accepted ratio of level to peak.
        limit: f64,
    },
    /// The rest levels before and after differ.
    #[error(
        "level shift: `{channel}` rests at {} before and at {} after, a difference of more than {} times its peak of {}",
        Short(*.before),
        Short(*.after),
        Short(*.limit),
        Short(*.peak)
    )]
    LevelShift {
        channel: String,
        /// Level before the hit.
        before: f64,
        /// Level at the end.
        after: f64,
        /// Largest excursion.
        peak: f64,
        /// Largest accepted ratio of shift to peak.
        limit: f64,
    },
    /// A channel departs from the response of the other hits.
    #[error(
        "departs from the others: `{channel}` departs by a relative {} from the prediction by the other hits, which depart by at most {}; this hit is {} times as large and {} ms later{}",
        Short(*.departure),
        Short(*.others),
        Short(*.scale),
        Short(1e3 * .delay),
        where_most(*.index)
    )]
    Departs {
        channel: String,
        /// Square root of the ratio of the energy of the departure to that of the prediction by the
        /// other hits.
        departure: f64,
        /// Largest departure, in the same measure, among the other hits.
        others: f64,
        /// Gain relative to the prediction by the other hits.
        scale: f64,
        /// Delay relative to the prediction by the other hits \[s\], rounded to whole samples.
        delay: f64,
        /// Index of the sample with the largest departure, if the departure is concentrated there.
        index: Option<usize>,
    },
    /// The signal still moves at the end.
    #[error(
        "not decayed: `{channel}` ends at {} rms, more than {} times its peak of {}",
        Short(*.remainder),
        Short(*.limit),
        Short(*.peak)
    )]
    NotDecayed {
        channel: String,
        /// Root mean square of the last part about its level, with the noise subtracted.
        remainder: f64,
        /// Largest excursion.
        peak: f64,
        /// Largest accepted ratio of remainder to peak.
        limit: f64,
    },
}

impl Reason {
    /// Name of the reason without its numbers, for example `double hit`: the printed sentence of
    /// the reason begins with it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::NoHit { .. } => "no hit",
            Self::NotTriggered { .. } => "not triggered",
            Self::CutAtStart { .. } => "cut at the start",
            Self::CutAtEnd { .. } => "cut at the end",
            Self::NonFinite { .. } => "lost samples",
            Self::Dead { .. } => "dead channel",
            Self::DoubleHit { .. } => "double hit",
            Self::Overload { .. } => "overload",
            Self::Clipped { .. } => "clipped",
            Self::DropOut { .. } => "drop-out",
            Self::StaticOffset { .. } => "static offset",
            Self::LevelShift { .. } => "level shift",
            Self::NotDecayed { .. } => "not decayed",
            Self::Departs { .. } => "departs from the others",
        }
    }
}

/// A number with as many digits as a reason needs.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.abs();
        if magnitude == 0.0 || (0.01..100_000.0).contains(&magnitude) {
            // four significant digits, less those before the decimal point
            let decimals = [(10.0, 3), (100.0, 2), (1000.0, 1)];
            let decimals = decimals.iter().find(|(limit, _)| magnitude < *limit);
            write!(f, "{:.*}", decimals.map_or(0, |(_, n)| *n), self.0)
        } else {
            write!(f, "{:.3e}", self.0)
        }
    }
}

/// Returns the clause that compares the values of a channel with the level of a trigger that never
/// fired.
fn untriggered(level: f64, hysteresis: f64, [least, greatest]: [f64; 2]) -> String {
    let [in_words, hysteresis] = [level, hysteresis].map(Short);
    if least < level && level < greatest {
        format!(
            "crosses {in_words}, but was never at least {hysteresis} (the hysteresis) on the other side of it"
        )
    } else {
        format!("never crosses {in_words}")
    }
}

/// Returns the clause about the sample with the largest departure.
fn where_most(index: Option<usize>) -> String {
    let clause = index.map(|index| format!(", and departs most at sample {index}"));
    clause.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each reason begins with its name and states its numbers with at most four digits.
    #[test]
    fn reasons_say_their_figures() {
        let channel = || "force".to_owned();
        let said = [
            Reason::NoHit {
                channel: channel(),
                peak: 0.5,
                noise: 0.1234567,
            },
            Reason::NotTriggered {
                channel: channel(),
                level: 10.0,
                hysteresis: 1.0,
                least: -0.25,
                greatest: 9.5,
            },
            Reason::NotTriggered {
                channel: channel(),
                level: 10.0,
                hysteresis: 1.0,
                least: 9.5,
                greatest: 300.0,
            },
            Reason::CutAtStart { missing: 12 },
            Reason::CutAtEnd { missing: 7 },
            Reason::NonFinite {
                channel: channel(),
                index: 9,
            },
            Reason::Dead {
                channel: channel(),
                value: 0.0,
            },
            Reason::DoubleHit {
                channel: channel(),
                ratio: 0.25,
                separation: 2.5e-3,
            },
            Reason::Overload {
                channel: channel(),
                full_scale: 10.0,
                n_samples: 3,
                index: 81,
            },
            Reason::Clipped {
                channel: channel(),
                value: -9.99,
                run: 4,
                index: 80,
            },
            Reason::DropOut {
                channel: channel(),
                value: 1.5e-5,
                run: 30,
                index: 40,
            },
            Reason::StaticOffset {
                channel: channel(),
                level: 25.0,
                peak: 100.0,
                limit: 0.1,
            },
            Reason::LevelShift {
                channel: channel(),
                before: 0.0,
                after: 123_456.0,
                peak: 1000.0,
                limit: 0.05,
            },
            Reason::NotDecayed {
                channel: channel(),
                remainder: 2.0,
                peak: 100.0,
                limit: 0.01,
            },
            Reason::Departs {
                channel: channel(),
                departure: 0.4,
                others: 0.02,
                scale: 1.3,
                delay: 1e-3,
                index: Some(77),
            },
            Reason::Departs {
                channel: channel(),
                departure: 0.4,
                others: 0.02,
                scale: 1.3,
                delay: -2e-3,
                index: None,
            },
        ];
        let said: Vec<String> = said.iter().map(ToString::to_string).collect();
        insta::assert_snapshot!(said.join("\n"), @r"
        no hit: the largest excursion of `force` is 0.500, its noise 0.123
        not triggered: `force` never crosses 10.00; its values are between -0.250 and 9.500
        not triggered: `force` crosses 10.00, but was never at least 1.000 (the hysteresis) on the other side of it; its values are between 9.500 and 300.0
        cut at the start: 12 samples are missing before the hit; start the record earlier, with a pre-trigger of about a tenth of its length
        cut at the end: 7 samples are missing after the hit
        lost samples: `force` is NaN or infinite at sample 9
        dead channel: `force` is 0.000 throughout
        double hit: two contacts in `force`, peaks in the ratio 0.250, 2.500 ms apart
        overload: 3 samples of `force` from sample 81 on reach the full scale of 10.00
        clipped: `force` stays at its extreme -9.990 for 4 samples from sample 80 on
        drop-out: `force` stays at 1.500e-5 for 30 samples from sample 40 on
        static offset: `force` rests at 25.00, more than 0.100 times its peak of 100.0
        level shift: `force` rests at 0.000 before and at 1.235e5 after, a difference of more than 0.050 times its peak of 1000
        not decayed: `force` ends at 2.000 rms, more than 0.010 times its peak of 100.0
        departs from the others: `force` departs by a relative 0.400 from the prediction by the other hits, which depart by at most 0.020; this hit is 1.300 times as large and 1.000 ms later, and departs most at sample 77
        departs from the others: `force` departs by a relative 0.400 from the prediction by the other hits, which depart by at most 0.020; this hit is 1.300 times as large and -2.000 ms later
        ");
    }
}
