//! Parameters and their profiles in words.

use maxwellid::profile::Profile;
use maxwellid::{Estimate, Scale};

use crate::digits::{prefix_for, significant};
use crate::outcome::shown_unit;

/// Returns value and unit, such as `2.601 GPa`.
fn with_unit(value: f64, unit: &str, digits: usize) -> String {
    let (size, prefix) = prefix_for(value, unit);
    let unit = shown_unit(unit);
    format!("{} {prefix}{unit}", significant(value / size, digits))
        .trim_end()
        .to_owned()
}

/// Standard error of ln of a parameter above which not even the order of magnitude of the parameter
/// is known; 3 is the logarithm of a factor of 20.
const UNKNOWN_ORDER: f64 = 3.0;

/// Returns a parameter in words, such as `E = 2.601 GPa ± 0.1 %`, with the verdict if the data do
/// not determine it.
pub(super) fn of_estimate(estimate: &Estimate) -> String {
    let value = with_unit(estimate.value, estimate.unit, 4);
    let error = match estimate.scale {
        _ if !estimate.standard_error.is_finite() => " error unbounded".to_owned(),
        Scale::Ratio if estimate.standard_error > UNKNOWN_ORDER => {
            ", of unknown order of magnitude".to_owned()
        }
        Scale::Ratio if estimate.standard_error > 1.0 => {
            let factor = significant(estimate.standard_error.exp(), 2);
            format!(", known to a factor of {factor}")
        }
        Scale::Ratio => format!(" ± {} %", significant(100.0 * estimate.standard_error, 2)),
        Scale::Difference => format!(" ± {}", significant(estimate.standard_error, 2)),
    };
    let verdict = if estimate.verdict == maxwellid::Verdict::Identified {
        String::new()
    } else {
        format!(" ({})", estimate.verdict)
    };
    format!("{} = {value}{error}{verdict}", estimate.symbol)
}

/// Name and unit of the parameter of a profile. If the parameter is a logarithm, it is the
/// logarithm of the value in this unit.
struct Named {
    name: String,
    unit: &'static str,
    is_logarithm: bool,
}

fn named(parameter: &str) -> Named {
    let (name, is_logarithm) = match parameter.strip_prefix("ln_") {
        Some(name) => (name, true),
        None => (parameter, false),
    };
    let (name, unit) = match name {
        "modulus" => ("Young's modulus", "Pa"),
        "reference_rate" => ("inelastic strain rate at 10 MPa", "1/s"),
        "activation_energy" => ("activation energy", "J/mol"),
        time if time.starts_with("relaxation_time") => (time, "s"),
        other => (other, "1"),
    };
    Named {
        name: name.replace('_', " "),
        unit,
        is_logarithm,
    }
}

/// Description of a profile over the parameter itself, even if the fit uses the logarithm of the
/// parameter.
pub(super) struct Shown {
    pub(super) name: String,
    pub(super) unit: String,
    /// Conversion of a number of the profile to `unit`.
    of: Box<dyn Fn(f64) -> f64>,
}

impl Shown {
    pub(super) fn of(profile: &Profile) -> Self {
        let Named {
            name,
            unit,
            is_logarithm,
        } = named(&profile.parameter);
        let (size, prefix) = if is_logarithm {
            prefix_for(profile.value.exp(), unit)
        } else {
            (1.0, "")
        };
        let of: Box<dyn Fn(f64) -> f64> = if is_logarithm {
            Box::new(move |value| value.exp() / size)
        } else {
            Box::new(|value| value)
        };
        let unit = shown_unit(unit);
        Self {
            name,
            unit: format!("{prefix}{unit}"),
            of,
        }
    }

    pub(super) fn value(&self, number: f64) -> f64 {
        (self.of)(number)
    }

    /// Returns the profile in words, such as
    /// `Young's modulus: from 2.59 GPa to 2.61 GPa at 95 % (profile likelihood).`.
    pub(super) fn in_words(&self, profile: &Profile) -> String {
        let text = |number: f64| {
            let value = significant(self.value(number), 4);
            format!("{value} {}", self.unit).trim_end().to_owned()
        };
        let (low, high) = (text(profile.range.0), text(profile.range.1));
        match (profile.lower, profile.upper) {
            (Some(lower), Some(upper)) => format!(
                "{}: from {} to {} at 95 % (profile likelihood).",
                self.name,
                text(lower),
                text(upper)
            ),
            (Some(lower), None) => format!(
                "{}: above {} at 95 %; nothing up to {high} is excluded (profile likelihood).",
                self.name,
                text(lower)
            ),
            (None, Some(upper)) => format!(
                "{}: below {} at 95 %; nothing down to {low} is excluded (profile likelihood).",
                self.name,
                text(upper)
            ),
            (None, None) => format!(
                "{}: no value from {low} to {high} is excluded at 95 % (profile likelihood).",
                self.name
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_long_as_they_are_good() {
        let cases = [
            (with_unit(2.6014e9, "Pa", 4), "2.601 GPa"),
            (with_unit(4.8264e6, "Pa s", 4), "4.826 MPa s"),
            (with_unit(8.1264e4, "J/mol", 4), "81.26 kJ/mol"),
            (with_unit(1.793_74, "1", 4), "1.794"),
            (with_unit(8.2648, "1/s", 4), "8.265 1/s"),
            (with_unit(4.354e11, "Pa^kappa s", 4), "4.354e11 Pa^kappa s"),
            (significant(0.051, 2), "0.051"),
            (significant(12.3, 2), "12"),
        ];
        for (found, expected) in cases {
            assert_eq!(found, expected);
        }
    }
}
