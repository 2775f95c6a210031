//! Ticks of an axis and their labels. `report/script.js` of `rodlab` uses the same rules.

use super::unit::raised;
use super::{Axis, Scale};

/// The ticks of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ticks {
    /// Places with their labels.
    pub major: Vec<(f64, String)>,
    /// Places without labels.
    pub minor: Vec<f64>,
}

/// Returns about `wanted` labelled ticks in the range of `axis`: at multiples of 1, 2 or 5 times a
/// power of ten, at powers of ten, or, for angles, at fractions of a turn.
pub(super) fn ticks(axis: &Axis, range: [f64; 2], wanted: f64) -> Ticks {
    let least = (range[1] - range[0]) / wanted;
    match axis.scale {
        Scale::Linear
            if matches!(axis.unit.as_str(), "°" | "deg") && range[1] - range[0] > 60.0 =>
        {
            let turns = [15.0, 30.0, 45.0, 90.0, 180.0, 360.0];
            let part = turns.into_iter().find(|part| *part >= least);
            linear(range, part.unwrap_or_else(|| round_step(least)))
        }
        Scale::Linear => linear(range, round_step(least)),
        Scale::Logarithmic => logarithmic(range, wanted),
    }
}

/// Returns the least of 1, 2 and 5 times a power of ten that is not below `least`.
fn round_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|step| step * power >= least * (1.0 - 1e-9));
    step.unwrap_or(10.0) * power
}

fn linear([from, to]: [f64; 2], step: f64) -> Ticks {
    let mut major = Vec::new();
    let mut count = (from / step - 1e-9).ceil();
    while count * step <= to + 1e-9 * step {
        let value = count * step;
        major.push((value, label(value, step)));
        count += 1.0;
    }
    // a step of 2 is divided into four parts, a step of 1 or 5 into five, a fraction of a turn into
    // three
    let power = 10_f64.powf((step.log10() + 1e-9).floor());
    let parts = match step / power {
        lead if (lead - 2.0).abs() < 1e-6 => 4.0,
        lead if (lead - 1.0).abs() < 1e-6 || (lead - 5.0).abs() < 1e-6 => 5.0,
        _ => 3.0,
    };
    let part = step / parts;
    let mut minor = Vec::new();
    let mut count = (from / part - 1e-9).ceil();
    while count * part <= to + 1e-9 * part {
        if (count / parts).fract().abs() > 1e-9 {
            minor.push(count * part);
        }
        count += 1.0;
    }
    Ticks { major, minor }
}

fn logarithmic([from, to]: [f64; 2], wanted: f64) -> Ticks {
    let decades = (to / from).log10();
    if decades < 1.0 {
        return linear([from, to], round_step((to - from) / wanted));
    }
    let inside = |value: &f64| (from * (1.0 - 1e-9)..=to * (1.0 + 1e-9)).contains(value);
    let every = (decades / wanted).ceil().max(1.0);
    let mut ticks = Ticks {
        major: Vec::new(),
        minor: Vec::new(),
    };
    let mut exponent = from.log10().floor();
    while exponent <= to.log10() + 1e-9 {
        for digit in 1..10_u8 {
            let value = f64::from(digit) * 10_f64.powf(exponent);
            let labelled = digit == 1 && (exponent / every).fract().abs() < 1e-9
                || decades < 1.6 && (digit == 2 || digit == 5);
            if inside(&value) && labelled {
                // on an axis of many decades, all labels but 1 are written as powers of ten
                let label = if decades > 5.5 && exponent.abs() > 0.5 {
                    format!("10{}", superscript(exponent))
                } else {
                    label(value, value)
                };
                ticks.major.push((value, label));
            } else if inside(&value) && every < 1.5 {
                ticks.minor.push(value);
            }
        }
        exponent += 1.0;
    }
    ticks
}

/// Formats `value` with enough digits to distinguish it from its neighbours, which are `step` away.
pub(super) fn label(value: f64, step: f64) -> String {
    if value.abs() < 1e-6 * step {
        return "0".to_owned();
    }
    let exponent = |value: f64| (value.abs().log10() + 1e-9).floor();
    if value.abs() >= 99_999.5 || step < 0.99e-3 && value.abs() < 0.1 {
        let power = exponent(value);
        let digits = places(power - exponent(step));
        let mantissa = format!("{:.digits$}", value / 10_f64.powf(power));
        // a mantissa of one is omitted
        return match mantissa.as_str() {
            "1" => format!("10{}", superscript(power)),
            "-1" => format!("−10{}", superscript(power)),
            _ => format!("{}×10{}", mantissa.replace('-', "−"), superscript(power)),
        };
    }
    let digits = places(-exponent(step));
    format!("{value:.digits$}").replace('-', "−")
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of decimal places from 0 to 17"
)]
fn places(count: f64) -> usize {
    count.clamp(0.0, 17.0) as usize
}

/// Returns the exponent of a power of ten as superscript, such as `⁻³`.
#[must_use]
pub fn superscript(power: f64) -> String {
    format!("{power:.0}").chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(scale: Scale, unit: &str) -> Axis {
        Axis {
            scale,
            ..Axis::linear("x", unit)
        }
    }

    fn labels(scale: Scale, range: [f64; 2], wanted: f64) -> String {
        let ticks = ticks(&axis(scale, ""), range, wanted);
        let labels: Vec<String> = ticks.major.into_iter().map(|(_, label)| label).collect();
        labels.join(" ")
    }

    #[test]
    fn ticks_are_round_and_their_labels_tell_them_apart() {
        use Scale::{Linear, Logarithmic};
        let shown = [
            (Linear, [0.0, 1.0], 5.0),
            (Linear, [-0.31, 0.29], 6.0),
            (Linear, [2.5601, 2.5649], 5.0),
            (Linear, [0.0, 65_536.0], 5.0),
            (Linear, [-2.1e9, 3.2e9], 5.0),
            (Linear, [0.0, 4.2e-4], 5.0),
            (Linear, [1000.0, 1000.4], 4.0),
            (Logarithmic, [0.1, 8000.0], 6.0),
            (Logarithmic, [110.0, 900.0], 6.0),
            (Logarithmic, [300.0, 900.0], 6.0),
            (Logarithmic, [1e-12, 1e7], 6.0),
        ]
        .map(|(scale, range, wanted)| labels(scale, range, wanted))
        .join("\n");
        insta::assert_snapshot!(shown, @r"
        0 0.2 0.4 0.6 0.8 1.0
        −0.3 −0.2 −0.1 0 0.1 0.2
        2.561 2.562 2.563 2.564
        0 20000 40000 60000
        −2×10⁹ 0 2×10⁹
        0 10⁻⁴ 2×10⁻⁴ 3×10⁻⁴ 4×10⁻⁴
        1000.0 1000.1 1000.2 1000.3 1000.4
        0.1 1 10 100 1000
        200 400 600 800
        300 400 500 600 700 800 900
        10⁻¹² 10⁻⁸ 10⁻⁴ 1 10⁴
        ");
    }

    #[test]
    fn a_decade_has_eight_ticks_without_labels() {
        let ticks = ticks(&axis(Scale::Logarithmic, ""), [1.0, 1000.0], 6.0);
        assert_eq!(ticks.major.len(), 4);
        assert_eq!(ticks.minor.len(), 3 * 8);
    }

    #[test]
    fn a_step_is_divided_into_round_parts() {
        let minor = |range, wanted| -> Vec<String> {
            let ticks = ticks(&axis(Scale::Linear, ""), range, wanted);
            ticks
                .minor
                .iter()
                .map(|place| format!("{place:.2}"))
                .collect()
        };
        assert_eq!(
            minor([0.0, 2.0], 2.0).join(" "),
            "0.20 0.40 0.60 0.80 1.20 1.40 1.60 1.80"
        );
        assert_eq!(
            minor([-0.1, 3.9], 2.0).join(" "),
            "0.50 1.00 1.50 2.50 3.00 3.50"
        );
        assert_eq!(
            minor([10.0, 15.0], 1.0).join(" "),
            "11.00 12.00 13.00 14.00"
        );
    }

    #[test]
    fn a_turn_is_divided_as_turns_are() {
        let ticks = ticks(&axis(Scale::Linear, "°"), [-180.0, 180.0], 5.0);
        let places: Vec<f64> = ticks.major.iter().map(|(place, _)| *place).collect();
        assert_eq!(places, [-180.0, -90.0, 0.0, 90.0, 180.0]);
    }
}
