//! Checks for implausible values, and for counts whose computation would take too long. Both are
//! refused before anything is computed.

use super::{Density, Length, Stated};
use crate::RodlabError;
use crate::digits::significant;

/// Wave speeds of solids \[m/s\], from soft foams to diamond.
const WAVE_SPEEDS: [f64; 2] = [20.0, 20_000.0];

/// Checks the speed \[m/s\] of waves in the material at `field`, which follows from its modulus and
/// density.
///
/// # Errors
///
/// [`RodlabError::Request`] for a speed outside the range of solids, unless the sheet confirms it.
pub(crate) fn wave_speed(speed: f64, unusual: bool, field: &str) -> Result<(), RodlabError> {
    let [least, most] = WAVE_SPEEDS;
    if unusual || (least..=most).contains(&speed) {
        return Ok(());
    }
    Err(RodlabError::request(
        field,
        format!("a material whose modulus and density give a wave speed of {speed:.3e} m/s"),
        format!("{least} to {most} m/s, or `unusual: true` next to the density if it is intended"),
    ))
}

/// Densities of solids [kg/m³], from light foams to osmium. A metal in g/cm³ is below the range.
const DENSITIES: [f64; 2] = [25.0, 25_000.0];

/// Checks the density [kg/m³] at `field`.
///
/// # Errors
///
/// [`RodlabError::Request`] for a density outside the range of solids.
pub(crate) fn density(
    stated: &Stated<Density>,
    field: impl Into<String>,
) -> Result<(), RodlabError> {
    let [least, most] = DENSITIES;
    let density = stated.with_uncertainty().value;
    if (least..=most).contains(&density) {
        return Ok(());
    }
    Err(RodlabError::request(
        field,
        format!("`{stated}`, {} kg/m3", significant(density, 4)),
        format!("{least} to {most} kg/m3, the densities of solids: water has 1000 kg/m3"),
    ))
}

/// Largest diameter of a body \[m\], that of the largest piles.
const LARGEST_DIAMETER: f64 = 5.0;

/// Checks the diameter of a body at `field`.
///
/// # Errors
///
/// [`RodlabError::Request`] for a diameter above 5 m.
pub(crate) fn diameter(
    stated: &Stated<Length>,
    field: impl Into<String>,
) -> Result<(), RodlabError> {
    if stated.nominal() <= LARGEST_DIAMETER {
        return Ok(());
    }
    Err(RodlabError::request(
        field,
        format!("`{stated}`"),
        format!("a diameter of at most {LARGEST_DIAMETER} m"),
    ))
}

/// Checks a count of `what` stated at `field`.
///
/// # Errors
///
/// [`RodlabError::Request`] for more than `most`, with both numbers.
pub(crate) fn at_most(
    count: f64,
    most: f64,
    what: &str,
    field: impl Into<String>,
) -> Result<(), RodlabError> {
    if count <= most {
        return Ok(());
    }
    Err(RodlabError::request(
        field,
        format!("{count:.0} {what}"),
        format!("at most {most:.0} {what}"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r20_a_number_that_is_none_is_not_plausible() {
        for speed in [f64::NAN, f64::INFINITY, 0.0, 19.9, 20_001.0] {
            assert!(wave_speed(speed, false, "materials: x").is_err(), "{speed}");
            assert!(wave_speed(speed, true, "materials: x").is_ok());
        }
        assert!(wave_speed(20.0, false, "materials: x").is_ok());
        for (text, is_solid) in [
            ("1.19 kg/m3", false),
            ("1.19 g/cm3", true),
            ("912 g/cm3", false),
        ] {
            let found = density(&text.parse().unwrap(), "specimen.density");
            assert_eq!(found.is_ok(), is_solid, "{text}");
        }
        assert!(at_most(f64::NAN, 10.0, "cells", "cell").is_err());
        let said = at_most(1e9, 2000.0, "cells", "cell")
            .unwrap_err()
            .to_string();
        assert_eq!(
            said,
            "cell is 1000000000 cells, expected at most 2000 cells"
        );
    }
}
