//! Choice of gauge positions.
//!
//! From a guess of the material and of the waves, the standard error of γ is predicted before the
//! gauges are mounted, by the Cramér-Rao bound as in [`MultiPoint`](super::MultiPoint). Gauges on a
//! grid of spacing a are singular at ka = nπ, for any waves.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::medium::{Medium, PropagationLaw};

use super::projection::Projection;
use super::spectra::{WhiteLine, check_positions};
use crate::error::{
    CmodError, check_finite, check_frequencies, check_not_negative, check_positive, check_that,
};

/// Expected waves in the rod: an incident wave of amplitude 1 along +x, and its reflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedWaves {
    /// Section at which the incident wave has the amplitude 1 \[m\].
    pub incident_at: f64,
    /// Section from which the incident wave is reflected \[m\].
    pub reflector_at: f64,
    /// Reflection coefficient N/P at the reflector: -1 for the strain at a free end, 1 at a fixed
    /// end, 0 for no reflection.
    pub reflection: Complex64,
}

/// Predicted error of one line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Prediction {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Relative standard deviation (E|δγ|²)^½/|γ|; infinite where the gauges do not determine γ.
    /// The relative standard deviation of the modulus, for both parts together, is twice as large.
    pub relative_deviation: f64,
}

/// Returns the relative standard deviation of γ (root mean square of real and imaginary part
/// together) for gauges at `positions` \[m\] with `noise`, relative to the amplitude of the
/// incident wave, in a rod of `medium`.
///
/// # Errors
/// [`CmodError::GaugeCount`], [`CmodError::PositionOrder`], [`CmodError::NonPhysical`] for
/// positions, noise and waves; [`CmodError::NoLines`], [`CmodError::Frequency`],
/// [`CmodError::FrequencyOrder`].
pub fn predict<L: PropagationLaw>(
    medium: &Medium<L>,
    positions: &[f64],
    waves: ExpectedWaves,
    noise: f64,
    frequency_hz: &[f64],
) -> Result<Vec<Prediction>, CmodError> {
    check_positions(positions)?;
    check_frequencies(frequency_hz)?;
    check_not_negative("noise relative to the incident wave", noise)?;
    for value in [
        waves.incident_at,
        waves.reflector_at,
        waves.reflection.norm(),
    ] {
        check_finite("section or reflection of the expected waves", value)?;
    }
    let mut projection = Projection::new(positions);
    let n = positions.len();
    let mut line = WhiteLine::of_values(vec![Complex64::ZERO; n], vec![1.0; n]);
    let prediction = |&frequency_hz: &f64| {
        let gamma = medium.propagation_coefficient(TAU * frequency_hz);
        for (value, x) in line.values.iter_mut().zip(positions) {
            let way = 2.0 * waves.reflector_at - waves.incident_at - x;
            *value =
                (-gamma * (x - waves.incident_at)).exp() + waves.reflection * (-gamma * way).exp();
        }
        let relative = projection
            .evaluate(gamma, &line)
            .map(|at| noise / (at.information.sqrt() * gamma.norm()))
            .filter(|relative| !relative.is_nan());
        Prediction {
            frequency_hz,
            relative_deviation: relative.unwrap_or(f64::INFINITY),
        }
    };
    Ok(frequency_hz.iter().map(prediction).collect())
}

/// Returns the spacing of the coarsest grid on which all `positions` \[m\] lie within `tolerance`
/// \[m\], by Euclid's algorithm on their distances. Returns `None` if this spacing is not above ten
/// times the tolerance.
///
/// # Errors
/// [`CmodError::GaugeCount`], [`CmodError::PositionOrder`] and [`CmodError::NonPhysical`].
pub fn common_spacing(positions: &[f64], tolerance: f64) -> Result<Option<f64>, CmodError> {
    check_positions(positions)?;
    check_positive("tolerance [m]", tolerance)?;
    let mut spacing = 0.0;
    for (x, y) in positions.iter().zip(positions.iter().skip(1)) {
        let (mut a, mut b): (f64, f64) = (y - x, spacing);
        while b > tolerance {
            // nearest multiple: a remainder slightly below b is treated as a remainder slightly
            // below 0
            (a, b) = (b, (a - b * (a / b).round()).abs());
        }
        spacing = a;
    }
    // for distances so unequal that their quotient overflows, the spacing is undetermined
    check_not_negative("common spacing of the gauges [m]", spacing)?;
    Ok((spacing > 10.0 * tolerance).then_some(spacing))
}

/// Maximum number of half waves in the common spacing up to which singular frequencies are listed.
const MOST_HALF_WAVES: f64 = 1e5;

/// Returns the frequencies \[Hz\] up to `highest_hz` at which all distances between gauges are
/// multiples of half a wavelength: ka = nπ with the [`common_spacing`] a. At these frequencies the
/// gauges cannot separate the waves and, apart from the effect of damping, γ is undetermined.
///
/// # Errors
/// The errors of [`common_spacing`]; [`CmodError::NonPhysical`] for `highest_hz`.
pub fn singular_frequencies<L: PropagationLaw>(
    medium: &Medium<L>,
    positions: &[f64],
    tolerance: f64,
    highest_hz: f64,
) -> Result<Vec<f64>, CmodError> {
    check_positive("highest frequency [Hz]", highest_hz)?;
    let Some(spacing) = common_spacing(positions, tolerance)? else {
        return Ok(Vec::new());
    };
    let half_waves = |f: f64| medium.wave_number(TAU * f) * spacing / PI;
    let most = half_waves(highest_hz);
    let quantity = "half waves in the common spacing at the highest frequency";
    check_that(most <= MOST_HALF_WAVES, quantity, most, "at most 1e5")?;
    let mut found = Vec::new();
    let mut number = 1.0;
    let mut below = 0.0;
    while most >= number {
        let (mut low, mut high) = (below, highest_hz);
        // k increases with frequency, so bisection finds the root, down to rounding
        while high - low > 1e-13 * highest_hz {
            let middle = 0.5 * (low + high);
            if half_waves(middle) < number {
                low = middle;
            } else {
                high = middle;
            }
        }
        found.push(high);
        below = high;
        number += 1.0;
    }
    Ok(found)
}
