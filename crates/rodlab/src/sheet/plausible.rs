//! Checks for implausible values, and for numbers of items that would take too long to compute.
//! Both are refused before anything is computed.

use std::fmt::Display;

use super::{Density, Exact, Frequency, Length, Ratio, Stated};
use crate::RodlabError;
use crate::digits::{hertz, rate, short, significant};

/// Wave speeds of solids \[m/s\], from soft foams to diamond.
const WAVE_SPEEDS: [f64; 2] = [20.0, 20_000.0];

/// Checks the wave speed \[m/s\] in the material at `field`, which is computed from modulus and
/// density.
pub(crate) fn wave_speed(speed: f64, unusual: bool, field: &str) -> Result<(), RodlabError> {
    let [least, most] = WAVE_SPEEDS;
    if unusual || (least..=most).contains(&speed) {
        return Ok(());
    }
    Err(RodlabError::request(
        field,
        format!("a material whose modulus and density give a wave speed of {speed:.3e} m/s"),
        format!(
            "{least} to {most} m/s, or `unusual` as true next to the density if this wave speed is intended"
        ),
    ))
}

/// Densities of solids \[kg/m³\], from light foams to osmium. The density of a metal in g/cm³ is
/// below this range.
const DENSITIES: [f64; 2] = [25.0, 25_000.0];

/// Checks the density \[kg/m³\] at `field`.
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

/// Largest storage modulus \[Pa\]: diamond, the stiffest solid, has about 1200 GPa.
const STIFFEST: f64 = 1500e9;

/// Checks the storage modulus \[Pa\] in the row of a table at `field`.
pub(crate) fn storage_modulus(
    modulus: f64,
    unusual: bool,
    field: impl FnOnce() -> String,
) -> Result<(), RodlabError> {
    if unusual || modulus <= STIFFEST {
        return Ok(());
    }
    Err(RodlabError::request(
        field(),
        format!("a modulus of {} GPa", significant(1e-9 * modulus, 4)),
        format!(
            "at most {} GPa, because diamond has 1200 GPa: is the unit MPa or kPa? State `unusual` as true in the sheet if this modulus is intended",
            1e-9 * STIFFEST
        ),
    ))
}

/// Largest diameter of a body \[m\]; it is that of the largest piles.
const LARGEST_DIAMETER: f64 = 5.0;

/// Checks the diameter of a body at `field`.
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

/// Checks the mass \[kg\] on the end of a specimen, stated at `field`; `specimen` is the mass of
/// the specimen \[kg\].
pub(crate) fn end_mass(
    stated: &impl Display,
    mass: f64,
    specimen: f64,
    field: impl Into<String>,
) -> Result<(), RodlabError> {
    if mass <= specimen {
        return Ok(());
    }
    let gram = |mass: f64| short(1e3 * mass);
    Err(RodlabError::request(
        field,
        format!(
            "`{stated}`, {} g, more than the specimen, {} g",
            gram(mass),
            gram(specimen)
        ),
        "less: gram is the usual unit",
    ))
}

/// Checks the limit of a relative error at `field`.
pub(crate) fn limit(
    stated: &Exact<Ratio>,
    most: f64,
    field: impl Into<String>,
) -> Result<(), RodlabError> {
    let text = stated.to_string();
    if stated.si() <= most || text.parse::<f64>().is_err() {
        return Ok(());
    }
    Err(RodlabError::request(
        field,
        format!("`{text}`, {} %", short(100.0 * stated.si())),
        format!("at most {most} without a unit: did you mean \"{text} %\"?"),
    ))
}

/// Allowed relative excess over half the sampling rate, because sampling rates in files are
/// rounded.
const ROUNDED_RATE: f64 = 1e-3;

/// Checks that the frequency at `field` is not above half the sampling rate \[Hz\].
pub(crate) fn below_nyquist(
    stated: &Exact<Frequency>,
    rate_hz: f64,
    field: impl Into<String>,
) -> Result<(), RodlabError> {
    if stated.si() <= 0.5 * rate_hz * (1.0 + ROUNDED_RATE) {
        return Ok(());
    }
    Err(RodlabError::request(
        field,
        format!("`{stated}`"),
        format!(
            "at most {}, half the sampling rate{}",
            hertz(0.5 * rate_hz),
            without_kilo(rate_hz, stated.si()).unwrap_or_default()
        ),
    ))
}

/// Returns a question, after "sampling rate", about a rate \[Hz\] that is probably stated without
/// the k of kHz: it is below 1 kHz, and half of it in kHz is enough for `highest_hz`, but half of
/// it in Hz is not. Returns `None` for any other rate.
pub(crate) fn without_kilo(rate_hz: f64, highest_hz: f64) -> Option<String> {
    let is_without = rate_hz < 1e3 && (0.5 * rate_hz..=500.0 * rate_hz).contains(&highest_hz);
    let number = rate(rate_hz);
    is_without.then(|| format!(" of {number} Hz: did you mean {number} kHz?"))
}

/// Checks the number of `what` that is stated at `field`.
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
    use super::super::AddedMass;
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
        let said = |checked: Result<(), RodlabError>| checked.unwrap_err().to_string();
        let row = || "modulus.storage".to_owned();
        assert!(storage_modulus(1200e9, false, row).is_ok());
        assert!(storage_modulus(2400e9, true, row).is_ok());
        assert_eq!(
            said(storage_modulus(2400e9, false, row)),
            "modulus.storage is a modulus of 2400 GPa, expected at most 1500 GPa, because diamond has 1200 GPa: is the unit MPa or kPa? State `unusual` as true in the sheet if this modulus is intended"
        );
        let mass: Stated<AddedMass> = "0.8 kg".parse().unwrap();
        assert!(end_mass(&mass, 0.8, 0.9, "mass").is_ok());
        assert_eq!(
            said(end_mass(&mass, 0.8, 0.08, "specimen.accelerometer_mass")),
            "specimen.accelerometer_mass is `0.8 kg`, 800 g, more than the specimen, 80 g, expected less: gram is the usual unit"
        );
        let of = |text: &str| limit(&text.parse().unwrap(), 2.0, "limits.loss_factor");
        assert!(of("0.2").is_ok() && of("300 %").is_ok());
        assert_eq!(
            said(of("20")),
            "limits.loss_factor is `20`, 2000 %, expected at most 2 without a unit: did you mean \"20 %\"?"
        );
        let band = |rate_hz| below_nyquist(&"25.6 kHz".parse().unwrap(), rate_hz, "band.to");
        assert!(band(51_199.0).is_ok());
        assert_eq!(
            said(band(44_100.0)),
            "band.to is `25.6 kHz`, expected at most 22.05 kHz, half the sampling rate"
        );
        assert_eq!(
            said(band(51.2)),
            "band.to is `25.6 kHz`, expected at most 25.6 Hz, half the sampling rate of 51.2 Hz: did you mean 51.2 kHz?"
        );
        assert!(!said(band(44.1)).contains("did you mean"));
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
