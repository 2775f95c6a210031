//! Contradictions between the two gauges of a bar.

use super::Finding;
use crate::hopkinson::bar::{HopkinsonBar, Known};
use crate::hopkinson::pair::GaugePairs;
use crate::hopkinson::source::Side;

/// Number of standard errors beyond which two gauges contradict each other; a normal number exceeds
/// three with a probability of 0.27 %.
const APART: f64 = 3.0;
/// Largest lag, relative to the transit time between the gauges, that is not reported. A lag puts
/// this part of a passing wave into the difference of the separated waves, and so into the velocity
/// of the face.
const LAG: f64 = 0.005;
/// Largest difference of the ratio of the gauges from 1 that is not reported.
const RATIO: f64 = 0.01;
/// Largest drift of the level, relative to the largest strain, that is not reported, as for the end
/// of the incident wave at a single gauge.
const DRIFT: f64 = 0.005;

/// Returns the contradictions between the gauges of each bar: a lag, or otherwise a ratio and a
/// drift, which a large lag changes as well.
pub(super) fn of(pairs: &GaugePairs, bars: &[HopkinsonBar; 2], band_hz: f64) -> Vec<Finding> {
    let beyond = |known: Known, least: f64| {
        known.value.abs() > least.max(APART * known.standard_uncertainty)
    };
    let of_bar = |(side, bar): (Side, &HopkinsonBar)| {
        let (Some([excess, lag, drift]), [one, other]) = (pairs.of(side), bar.gauges.as_slice())
        else {
            return Vec::new();
        };
        let Ok(speed) = bar.phase_velocity(0.3 * band_hz) else {
            return Vec::new();
        };
        let apart = other.distance.value - one.distance.value;
        // waves along x reach the nearer gauge of the incident bar last
        let gauge = usize::from((apart > 0.0) == (side == Side::Transmitted));
        if beyond(lag, LAG * apart.abs() / speed) {
            return vec![Finding::GaugeLag {
                side,
                gauge,
                lag: lag.value,
                standard_error: lag.standard_uncertainty,
                distance: lag.value * speed,
            }];
        }
        let ratio = beyond(excess, RATIO).then_some(Finding::GaugeRatio {
            side,
            gauge,
            ratio: 1.0 + excess.value,
            standard_error: excess.standard_uncertainty,
        });
        let drift = beyond(drift, DRIFT).then_some(Finding::GaugeDrift {
            side,
            gauge,
            drift: drift.value,
            standard_error: drift.standard_uncertainty,
        });
        ratio.into_iter().chain(drift).collect()
    };
    Side::BOTH.into_iter().zip(bars).flat_map(of_bar).collect()
}
