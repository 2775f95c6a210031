//! Problems of a result, with the values found.

mod gauges;

use super::bar::HopkinsonBar;
use super::curves::Curve;
use super::pair::GaugePairs;
use super::plan::{MOST_AMPLIFICATION, Plan, WaveSeparation};
use super::record::HopkinsonRecord;
use super::result::HopkinsonResult;
use super::shot::HopkinsonTest;
use super::source::Side;
use super::specimen::Loading;

/// Largest difference between the fronts of the reflected and the incident wave, relative to the
/// rise of the latter, for which the specimen may be the reason.
const OF_RISE: f64 = 0.5;

/// Largest relative difference of the wave speed between passages.
const SPEED: f64 = 0.03;
/// Largest difference of the ratio of the two forces from 1, absolute and in standard errors: a
/// normal number is beyond three of them with a probability of 0.27 %.
const FORCES: f64 = 0.03;
const FORCES_APART: f64 = 3.0;
/// Number of standard errors by which the force of the transmitted face must exceed that of the
/// incident one to come before it; a normal number exceeds two with a probability of 2.3 %.
const LEAD_APART: f64 = 2.0;
/// Largest pull of a face in compression, relative to the largest force.
const PULL: f64 = 0.05;
/// Engineering strain of compression at which the length of the specimen is zero.
const CRUSHED: f64 = 1.0;
/// Largest strain of a bar: metals and glassy polymers are elastic up to about 2 %.
const BAR_STRAIN: f64 = 0.03;
/// Smallest plausible value of the largest strain in the records; smaller pulses are not measured
/// with strain gauges.
const LEAST_STRAIN: f64 = 5e-6;
/// Smallest ratio of the reflected to the incident wave; below it the specimen hardly deforms.
const REFLECTED: f64 = 0.05;

/// Largest force at the end of the record, relative to the largest, that shows that the loading is
/// over.
const UNLOADED: f64 = 0.8;

/// Largest incident wave at the end of its window, relative to its peak, that causes no remark.
const REMARKED_TAIL: f64 = 0.005;

/// A problem of a result, or a remark on it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Finding {
    /// The sign of the incident wave is opposite to that of the loading.
    #[error(
        "the incident wave has a peak of {peak:.3e} ({}), expected {}: state the other loading, or `inverted` channels",
        signs(*.loading)[0],
        signs(*.loading)[1]
    )]
    WrongSign {
        /// The loading of the test.
        loading: Loading,
        /// Peak of the incident strain.
        peak: f64,
    },
    /// Strains too large for a bar, or too small for a gauge.
    #[error(
        "the largest strain of a bar is {largest:.3e}, expected {:.0e} to {}: check gauge factor, excitation and the unit of the channels",
        LEAST_STRAIN,
        BAR_STRAIN
    )]
    StrainOfBar {
        /// Largest strain.
        largest: f64,
    },
    /// The specimen is compressed to nothing, which is impossible.
    #[error(
        "the largest strain of the specimen is {largest:.3} in compression, expected less than {}: check the length of the specimen, gains and gauge factors",
        CRUSHED
    )]
    StrainOfSpecimen {
        /// Largest engineering strain while the specimen is loaded.
        largest: f64,
    },
    /// The band ends above the frequency up to which the law of a bar was measured.
    #[error(
        "the band ends at {band_hz:.0} Hz, but the law of a bar was measured only up to {known_to_hz:.0} Hz: above this frequency, the error of the law is unknown"
    )]
    BeyondLaw {
        /// End of the band \[Hz\].
        band_hz: f64,
        /// The highest frequency of the law \[Hz\].
        known_to_hz: f64,
    },
    /// The incident pulse has not ended when the reflected one arrives.
    #[error(
        "the incident pulse lasts longer than the {:.1} us after which its reflection reaches the gauge, so that the gauge cannot separate the two waves: expected a shorter pulse, a second gauge, or balanced waves; or the position of the gauge or the wave speed is wrong",
        1e6 * .alone
    )]
    Overlap {
        /// Duration without overlap \[s\].
        alone: f64,
    },
    /// The incident wave has not died away when the reflected one arrives.
    #[error(
        "the gauge of the incident bar is still at {:.1} % of the peak when the reflected wave arrives. It may be a tail of the incident wave or a shift of the level: the bands of forces and strain include both possibilities; a second gauge or a shorter pulse would show which applies",
        100.0 * .part
    )]
    Tail {
        /// Mean of the incident wave at the end of its window, divided by its largest value.
        part: f64,
    },
    /// The record ends while the specimen is loaded (a problem) or during its unloading (a remark).
    #[error(
        "the record ends while the specimen carries {:.0} % of its largest force: there is no curve beyond",
        100.0 * .part
    )]
    RecordEnds {
        /// Force at the end, divided by its largest value.
        part: f64,
    },
    /// The arrival of the reflected wave contradicts the wave speed and the position of the gauge.
    #[error(
        "the arrival of the reflected wave gives a wave speed of {found:.0} m/s, expected {stated:.0} m/s: check wave speed, modulus and position of the gauge"
    )]
    WaveSpeed {
        /// Stated wave speed [m/s].
        stated: f64,
        /// Wave speed found between the passages [m/s].
        found: f64,
    },
    /// A gauge records the waves later or earlier than the other gauge of its bar predicts, before
    /// any wave returns.
    #[error(
        "before any wave returns, gauge {} of the {side} records the waves {:.2} us ± {:.2} us {} than gauge {} predicts ({:.1} mm of the bar), expected no difference beyond three standard errors: state or correct the delays (`time_skew`) or the positions of the two gauges of this bar, or its wave speed",
        .gauge + 1,
        1e6 * .lag.abs(),
        1e6 * .standard_error,
        if *.lag > 0.0 { "later" } else { "earlier" },
        2 - .gauge,
        1e3 * .distance.abs()
    )]
    GaugeLag {
        /// The bar.
        side: Side,
        /// The gauge that the waves reach last, counted from 0.
        gauge: usize,
        /// Lag of its record \[s\].
        lag: f64,
        /// Standard error of the lag \[s\].
        standard_error: f64,
        /// Distance that the waves travel in this time \[m\].
        distance: f64,
    },
    /// A gauge records a larger or smaller strain than the other gauge of its bar predicts, before
    /// any wave returns.
    #[error(
        "before any wave returns, gauge {} of the {side} records {ratio:.3} ± {standard_error:.3} times the strain that gauge {} predicts, expected 1 within three standard errors: check gauge factors and gains of the two gauges of this bar, and whether it bends",
        .gauge + 1,
        2 - .gauge
    )]
    GaugeRatio {
        /// The bar.
        side: Side,
        /// The gauge that the waves reach last, counted from 0.
        gauge: usize,
        /// Ratio of the recorded to the predicted strain.
        ratio: f64,
        /// Standard error of the ratio.
        standard_error: f64,
    },
    /// The level of a gauge drifts against the other gauge of its bar, before any wave returns.
    #[error(
        "before any wave returns, the level of gauge {} of the {side} changes by {:.1} % ± {:.1} % of the peak against gauge {}, expected no change beyond 0.5 % and three standard errors: one of the two bridges drifts; every passage adds this change to the separated waves, and the bands do not include it",
        .gauge + 1,
        100.0 * .drift,
        100.0 * .standard_error,
        2 - .gauge
    )]
    GaugeDrift {
        /// The bar.
        side: Side,
        /// The gauge that the waves reach last, counted from 0.
        gauge: usize,
        /// Drift of its level from the silence until a wave returns, relative to the largest
        /// strain.
        drift: f64,
        /// Standard error of the drift.
        standard_error: f64,
    },
    /// The force of the transmitted face begins before that of the incident one, which is
    /// impossible.
    #[error(
        "the force of the transmitted face begins {:.1} us before that of the incident face: check positions, wave speeds and delays of channels",
        1e6 * .by
    )]
    TransmittedEarly {
        /// Lead of the transmitted force \[s\].
        by: f64,
    },
    /// A face pulls on a specimen in compression, which it only touches.
    #[error(
        "the face of the {side} pulls on the specimen, which it only touches, with up to {pull:.3e} N ± {standard_error:.1e} N (largest push {largest:.3e} N): check wave speed, position and sign of the gauge"
    )]
    FacePulls {
        /// The bar.
        side: Side,
        /// Largest pull \[N\].
        pull: f64,
        /// Standard error of the pull \[N\].
        standard_error: f64,
        /// Largest force of the transmitted face \[N\].
        largest: f64,
    },
    /// The forces of the two faces differ by a nearly constant factor.
    #[error(
        "the force of the incident bar is {ratio:.3} ± {standard_error:.3} times that of the transmitted bar throughout: check {}gauge factors, diameters and moduli of the bars",
        if *.ratio < 0.0 { "the signs of the channels, " } else { "" }
    )]
    ForcesDiffer {
        /// Ratio of incident to transmitted force.
        ratio: f64,
        /// Standard error of the ratio.
        standard_error: f64,
    },
    /// The specimen is never in equilibrium.
    #[error(
        "the forces of the two faces do not become equal and stay so: at {:.0} % of the loaded samples they differ by more than 0.05 of their mean plus the errors, expected at most 5 % from some time on; {:.0} % of these samples are after the largest strain; in the median the difference is {index:.3} of the mean",
        100.0 * .outside,
        100.0 * .unloading
    )]
    NoEquilibrium {
        /// Median magnitude of the index while the specimen is loaded.
        index: f64,
        /// Share of the loaded samples whose forces differ by more than 0.05 of their mean plus the
        /// errors.
        outside: f64,
        /// Share of these samples that lie after the largest strain.
        unloading: f64,
    },
    /// Equilibrium was assumed and cannot be checked.
    #[error(
        "the force of the incident face was taken from the transmitted bar: equilibrium is assumed, not verified"
    )]
    EquilibriumSupposed,
    /// The specimen hardly deforms: it is stiffer or stronger than the bars.
    #[error(
        "the reflected wave is {:.1} % of the incident one: the specimen hardly deforms, and its strain is a difference of nearly equal waves",
        100.0 * .reflected
    )]
    StrongerThanBars {
        /// Ratio of the largest reflected to the largest incident wave.
        reflected: f64,
    },
    /// Lines are amplified more than tenfold.
    #[error(
        "waves are amplified up to {by:.0}-fold on their way back to the specimen, expected at most {:.0}: lower the end of the band",
        MOST_AMPLIFICATION
    )]
    Amplified {
        /// Largest amplification.
        by: f64,
    },
}

impl Finding {
    /// Returns true if the finding rules out a stress-strain curve; otherwise there is a curve, in
    /// doubt or with a remark.
    #[must_use]
    pub fn forbids(&self) -> bool {
        matches!(
            self,
            Self::WrongSign { .. }
                | Self::StrainOfBar { .. }
                | Self::StrainOfSpecimen { .. }
                | Self::Overlap { .. }
        )
    }

    /// Returns true for a remark that does not put the result in doubt.
    #[must_use]
    pub fn is_remark(&self) -> bool {
        match self {
            Self::EquilibriumSupposed | Self::Tail { .. } | Self::GaugeDrift { .. } => true,
            Self::RecordEnds { part } => *part < UNLOADED,
            _ => false,
        }
    }
}

/// Returns the words for the sign of an incident wave opposite to that of the loading, and for the
/// expected one.
fn signs(loading: Loading) -> [&'static str; 2] {
    match loading {
        Loading::Compression => ["tension", "compression"],
        Loading::Tension => ["compression", "tension"],
        Loading::Torsion => ["negative", "a positive torque"],
    }
}

/// Returns the objections to a result.
pub(super) fn of(
    result: &HopkinsonResult,
    test: &HopkinsonTest,
    record: &HopkinsonRecord,
    plan: &Plan,
    pairs: &GaugePairs,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let [incident, reflected, _] = result.arrivals;
    if let Some(incident) = incident
        && incident.peak * test.loading.sign() < 0.0
    {
        findings.push(Finding::WrongSign {
            loading: test.loading,
            peak: incident.peak,
        });
        return findings;
    }
    let strains = record.gauges.iter().flatten().flatten();
    let largest = strains.fold(0.0_f64, |most, x| most.max(x.abs()));
    let strain = result.curves.of(Curve::Strain).get(result.loaded.clone());
    let of_specimen = strain.unwrap_or(&[]).iter().copied().fold(0.0, f64::max);
    if !(LEAST_STRAIN..=BAR_STRAIN).contains(&largest) {
        findings.push(Finding::StrainOfBar { largest });
    } else if test.loading == Loading::Compression && of_specimen >= CRUSHED {
        findings.push(Finding::StrainOfSpecimen {
            largest: of_specimen,
        });
    }
    let known_to_hz = test
        .bars
        .iter()
        .fold(f64::INFINITY, |to, bar| to.min(bar.material.known_to_hz()));
    if result.band_hz > known_to_hz {
        findings.push(Finding::BeyondLaw {
            band_hz: result.band_hz,
            known_to_hz,
        });
    }
    if !plan.incident_ends {
        let [start, end] = result.windows[0];
        findings.push(Finding::Overlap { alone: end - start });
    }
    if plan.incident_ends && plan.tail_part > REMARKED_TAIL {
        findings.push(Finding::Tail {
            part: plan.tail_part,
        });
    }
    if plan.record_ends {
        let force = result.curves.of(Curve::Force2);
        let most = force.iter().copied().fold(0.0_f64, f64::max);
        let part = force.last().map_or(0.0, |last| last / most);
        if part > 0.2 {
            findings.push(Finding::RecordEnds { part });
        }
    }
    findings.extend(gauges::of(pairs, &test.bars, result.band_hz));
    passages(result, test, &mut findings, [incident, reflected]);
    balance(result, test, &mut findings);
    if test.loading == Loading::Compression {
        findings.extend(pulls(result));
    }
    let size = |curve: Curve| {
        let samples = result.curves.of(curve).iter();
        samples.fold(0.0_f64, |most, x| most.max(x.abs()))
    };
    let share = size(Curve::ReflectedWave) / size(Curve::IncidentWave);
    if share < REFLECTED {
        findings.push(Finding::StrongerThanBars { reflected: share });
    }
    if result.amplification > MOST_AMPLIFICATION {
        findings.push(Finding::Amplified {
            by: result.amplification,
        });
    }
    findings
}

fn passages(
    result: &HopkinsonResult,
    test: &HopkinsonTest,
    findings: &mut Vec<Finding>,
    [incident, reflected]: [Option<super::Arrival>; 2],
) {
    let position = test.bars[0]
        .gauges
        .first()
        .map(|gauge| gauge.distance.value);
    let speed = test.bars[0].phase_velocity(0.3 * result.band_hz).ok();
    let (Some(first), Some(distance), Some(speed)) = (incident, position, speed) else {
        return;
    };
    if test.separation[0] == WaveSeparation::Windows
        && let Some(second) = reflected
    {
        let expected = 2.0 * distance / speed;
        let late = second.time - first.time;
        let error = first.standard_error.hypot(second.standard_error);
        // a specimen reflects a front of another shape: in virtual shots with ramps, half sines and
        // triangles the reflected front begins up to 0.43 of the rise later, on a creeping specimen
        // 0.13 of the rise earlier
        let allowed = (SPEED * expected).max(OF_RISE * first.rise);
        if late.abs() > allowed + 5.0 * error {
            findings.push(Finding::WaveSpeed {
                stated: speed,
                found: 2.0 * distance / (expected + late),
            });
        }
    }
    // the forces are compared, not the arrivals of the waves: fronts of different shape begin at
    // different times, but the forces of the two faces begin together
    let position = |bar: &HopkinsonBar| -> f64 {
        let gauges = bar.gauges.iter();
        gauges.fold(0.0, |sum, gauge| {
            gauge.distance.standard_uncertainty.hypot(sum)
        })
    };
    let placed = position(&test.bars[0]).hypot(position(&test.bars[1])) / speed;
    let by = forces_lead(result);
    if by > 3.0 * placed + 0.25 / result.band_hz {
        findings.push(Finding::TransmittedEarly { by });
    }
}

/// Lead of the transmitted force over that of the incident face where each first exceeds a quarter
/// of the transmitted peak \[s\]; 0 if the errors of the forces explain their difference there.
fn forces_lead(result: &HopkinsonResult) -> f64 {
    let second = result.curves.of(Curve::Force2);
    let level = 0.25 * second.iter().copied().fold(0.0_f64, f64::max);
    let first_above = |force: &[f64]| force.iter().position(|f| *f > level);
    let (Some(first), Some(second)) = (
        first_above(result.curves.of(Curve::Force1)),
        first_above(second),
    ) else {
        return 0.0;
    };
    let difference = result.curves.of(Curve::ForceDifference).iter();
    let errors = result.standard_error(Curve::ForceDifference);
    let mut between = difference.zip(&errors).take(first).skip(second);
    if between.any(|(difference, error)| -difference > LEAD_APART * error) {
        (first as f64 - second as f64) * result.time_step
    } else {
        0.0
    }
}

/// Returns the face that pulls most, if the pull exceeds three standard errors plus a twentieth of
/// the largest force.
fn pulls(result: &HopkinsonResult) -> Option<Finding> {
    let largest = result.curves.of(Curve::Force2).iter().copied();
    let largest = largest.fold(0.0_f64, f64::max);
    let mut found: Option<(f64, Finding)> = None;
    for (side, curve) in Side::BOTH.into_iter().zip([Curve::Force1, Curve::Force2]) {
        let errors = result.standard_error(curve);
        for (force, standard_error) in result.curves.of(curve).iter().zip(errors) {
            let beyond = -force - 3.0 * standard_error - PULL * largest;
            if beyond > found.as_ref().map_or(0.0, |(most, _)| *most) {
                let finding = Finding::FacePulls {
                    side,
                    pull: -force,
                    standard_error,
                    largest,
                };
                found = Some((beyond, finding));
            }
        }
    }
    found.map(|(_, finding)| finding)
}

fn balance(result: &HopkinsonResult, test: &HopkinsonTest, findings: &mut Vec<Finding>) {
    if test.separation[0] == WaveSeparation::Balanced {
        findings.push(Finding::EquilibriumSupposed);
        return;
    }
    let equilibrium = &result.equilibrium;
    let (ratio, standard_error) = (equilibrium.force_ratio, equilibrium.force_ratio_error);
    if (ratio - 1.0).abs() > FORCES.max(FORCES_APART * standard_error) {
        findings.push(Finding::ForcesDiffer {
            ratio,
            standard_error,
        });
    } else if equilibrium.from.is_none() {
        let loaded = equilibrium.index.iter().filter(|index| index.is_finite());
        let mut sizes: Vec<f64> = loaded.map(|index| index.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let [loading, unloading] = equilibrium.outside.map(|count| count as f64);
        findings.push(Finding::NoEquilibrium {
            index: sizes.get(sizes.len() / 2).copied().unwrap_or(f64::NAN),
            outside: (loading + unloading) / (sizes.len() as f64).max(1.0),
            unloading: unloading / (loading + unloading).max(1.0),
        });
    }
}
