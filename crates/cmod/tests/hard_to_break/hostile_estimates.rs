//! Every method with extreme specimens, settings and lines: each estimate is either a number with
//! an error, or the line is refused.

use num_complex::Complex64;

use cmod::branch::{Branch, BranchTracker, FreeEnd as FreeEndPhase, FreeEndRoot, PhaseRecord};
use cmod::checks::{Arrivals, Channel, kramers_kronig_on, passivity};
use cmod::estimate::coverage_factor;
use cmod::multi_point::Quantity;
use cmod::multi_point::advice::{ExpectedWaves, common_spacing, predict, singular_frequencies};
use cmod::two_point::{AveragedRatio, SpecimenUncertainty, variance_from_coherence};
use cmod::{
    CmodError, EndSection, FreeEnd, GaugeSpectra, GaugedRod, LateralInertia, ModulusEstimate,
    MultiPoint, OneGauge, PulsedRod, RatioOfSpectra, Resonances, RodWithFreeEnd,
    SectionUncertainty, SeparatePulses, Solver, ThreePoint, TwoPoint,
};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use super::specimen::{Specimen, strain_of_two_waves};
use super::{Findings, Numbers};

const LINES: usize = 40;
const SOUND: cmod::Specimen = cmod::Specimen {
    length: 1.0,
    diameter: 0.02,
    density: 1150.0,
    accelerometer_mass: 0.0,
};

/// Returns scaled frequencies over some half waves of the specimen.
fn frequencies(specimen: &Specimen, scale: f64) -> Vec<f64> {
    let step = scale * 0.1 * specimen.fundamental_hz();
    (1..=LINES).map(|k| step * k as f64).collect()
}

/// Returns all results of an estimate for its lines.
fn numbers(estimate: &ModulusEstimate) -> Vec<f64> {
    let mut numbers = Vec::new();
    for line in estimate.lines() {
        numbers.extend([
            line.modulus.re,
            line.modulus.im,
            line.loss_factor,
            line.phase_velocity,
        ]);
        numbers.extend([
            line.damping_coefficient(),
            line.wave_number(),
            line.wavelength(),
        ]);
        let error = line.standard_error;
        numbers.extend([error.storage_modulus, error.loss_modulus, error.loss_factor]);
        numbers.extend([
            error.damping_coefficient,
            error.wave_number,
            error.phase_velocity,
        ]);
        let random = line.random_error();
        let systematic = line.systematic_error();
        numbers.extend([random.loss_modulus, systematic.loss_modulus]);
        let _ = line.validity.to_string();
    }
    for refused in estimate.refused() {
        let _ = format!("{:?}", refused.reason);
    }
    let _ = estimate.columns();
    numbers
}

/// Returns frequencies and ratios of a valid specimen; the real part of one ratio is multiplied by
/// `value`.
fn spoilt(specimen: &Specimen, value: f64) -> (Vec<f64>, Vec<Complex64>) {
    let frequency_hz = frequencies(specimen, 1.0);
    let motion = |f: &f64| specimen.motion_at(specimen.length, *f);
    let mut ratio: Vec<Complex64> = frequency_hz.iter().map(motion).collect();
    ratio[LINES / 2].re *= value;
    (frequency_hz, ratio)
}

/// Returns the estimate from lines whose frequencies are multiplied by the first number; the second
/// number multiplies the real part of one ratio, and the third number is the variance.
fn estimated(
    a: &[f64],
    estimate: impl Fn(&[f64], &[Complex64], &[f64]) -> Result<ModulusEstimate, CmodError>,
) -> Numbers {
    let (mut frequency_hz, ratio) = spoilt(&Specimen::polymer(), a[1]);
    frequency_hz.iter_mut().for_each(|f| *f *= a[0]);
    estimate(&frequency_hz, &ratio, &[a[2]; LINES]).map(|estimate| numbers(&estimate))
}

#[test]
fn two_points() {
    let mut findings = Findings::default();
    let sound = [1.0, 0.02, 1150.0, 1e-3, 1.0, 1.0, 1e-6];
    for solver in [Solver::Continuation, Solver::Newton, Solver::Series] {
        findings.sweep(&format!("TwoPoint {solver:?}"), &sound, |a| {
            let specimen = cmod::Specimen {
                length: a[0],
                diameter: a[1],
                density: a[2],
                accelerometer_mass: a[3],
            };
            let uncertainty = SpecimenUncertainty {
                length: 1e-4,
                diameter: 1e-5,
                density: 1.0,
                accelerometer_mass: 1e-5,
            };
            let method = TwoPoint::new(specimen)?
                .with_solver(solver)
                .with_specimen_uncertainty(uncertainty)?;
            estimated(&a[4..], |f, r, v| method.estimate(f, r, v))
        });
    }
    findings.sweep("AveragedRatio", &[0.99, 10.0, 1.0], |a| {
        let (frequency_hz, acceleration_ratio) = spoilt(&Specimen::polymer(), a[2]);
        let averaged = AveragedRatio {
            frequency_hz: &frequency_hz,
            acceleration_ratio: &acceleration_ratio,
            coherence: &[a[0]; LINES],
            averages: a[1],
        };
        Ok(numbers(
            &TwoPoint::new(SOUND)?.estimate_averaged(&averaged)?,
        ))
    });
    findings.sweep_pairs("variance_from_coherence", &[1.0, 0.9, 10.0], |a| {
        let ratio = [Complex64::new(a[0], 0.5)];
        let variance = variance_from_coherence(&ratio, &[a[1]], a[2])?;
        // a line without coherence has an infinite variance, and is refused later
        assert!(
            variance
                .iter()
                .all(|variance| *variance >= 0.0 || !ratio[0].is_finite())
        );
        Ok(Vec::new())
    });
    findings.none();
}

#[test]
fn neighbours_of_two_points() {
    let mut findings = Findings::default();
    let section = |quantity, distance| EndSection { distance, quantity };
    let (strain, acceleration) = (Quantity::Strain, Quantity::Acceleration);
    let uncertainty = SectionUncertainty {
        distance: 1e-4,
        diameter: 1e-5,
        density: 1.0,
        end_mass: 1e-6,
    };
    let rod = |a: &[f64]| RodWithFreeEnd {
        diameter: a[0],
        density: a[1],
        end_mass: a[2],
    };
    let sound = [0.02, 1150.0, 1e-3, 1.0, 0.0, 1600.0, 1.0, 1.0, 1e-6];
    for (name, first, second) in [
        ("accelerations", acceleration, acceleration),
        ("strain and acceleration", strain, acceleration),
        ("acceleration and strain", acceleration, strain),
    ] {
        findings.sweep(&format!("FreeEnd of {name}"), &sound, |a| {
            let method = FreeEnd::new(rod(a), section(first, a[3]), section(second, a[4]))?
                .with_wave_speed(a[5])?
                .with_uncertainty(uncertainty)?;
            estimated(&a[6..], |f, r, v| method.estimate(f, r, v))
        });
    }
    findings.sweep("FreeEnd without a wave speed", &sound, |a| {
        let method = FreeEnd::new(
            rod(a),
            section(acceleration, a[3]),
            section(acceleration, a[4]),
        )?;
        estimated(&a[6..], |f, r, v| method.estimate(f, r, v))
    });
    findings.sweep(
        "OneGauge",
        &[0.02, 1150.0, 1e-3, 0.4, 1600.0, 1.0, 1.0, 1e-6],
        |a| {
            let method = OneGauge::new(rod(a), section(strain, a[3]))?
                .with_wave_speed(a[4])?
                .with_uncertainty(uncertainty)?;
            estimated(&a[5..], |f, r, v| method.estimate(f, r, v))
        },
    );
    findings.sweep(
        "SeparatePulses",
        &[0.4, 0.02, 1150.0, 1600.0, 1.0, 1.0, 1e-6],
        |a| {
            let rod = PulsedRod {
                distance: a[0],
                diameter: a[1],
                density: a[2],
            };
            let method = SeparatePulses::new(rod)?
                .with_wave_speed(a[3])?
                .with_uncertainty(uncertainty)?;
            estimated(&a[4..], |f, r, v| method.estimate(f, r, v))
        },
    );
    findings.sweep(
        "Resonances",
        &[0.02, 1150.0, 1e-3, 1.0, 1.0, 1.0, 1e-6],
        |a| {
            let method = Resonances::new(rod(a), a[3])?.with_uncertainty(uncertainty)?;
            estimated(&a[4..], |f, r, v| method.estimate(f, r, v))
        },
    );
    findings.sweep("RatioOfSpectra", &[1.0, 2.0, 0.1, 0.2], |a| {
        let (above, below) = ([Complex64::new(a[0], 1.0)], [Complex64::new(a[1], 0.3)]);
        // a ratio that is NaN is refused where it is used
        RatioOfSpectra::new(&[&above], &[&below], &[a[2]], &[a[3]]).map(|_| Vec::new())
    });
    findings.none();
}

fn gauge_spectra(positions: &[f64], scale: f64, spoil: f64) -> (Vec<f64>, Vec<Vec<Complex64>>) {
    let specimen = Specimen::polymer();
    let frequency_hz = frequencies(&specimen, scale);
    let spectra = positions
        .iter()
        .map(|x| {
            let sound = frequencies(&specimen, 1.0);
            let reflected = Complex64::new(-0.7, 0.2);
            let at = |f: &f64| strain_of_two_waves(specimen.gamma(*f), *x, reflected);
            let mut spectrum: Vec<Complex64> = sound.iter().map(at).collect();
            spectrum[LINES / 2] *= spoil;
            spectrum
        })
        .collect();
    (frequency_hz, spectra)
}

#[test]
fn several_gauges() {
    let mut findings = Findings::default();
    let sound = [-0.2, 0.0, 0.2, 0.02, 1150.0, 1600.0, 1.0, 1.0, 1e-3];
    let rod = |a: &[f64]| GaugedRod {
        positions: a[..3].to_vec(),
        diameter: a[3],
        density: a[4],
    };
    let estimate = |a: &[f64], with: &dyn Fn(&GaugeSpectra<'_>) -> Numbers| {
        let (frequency_hz, spectra) = gauge_spectra(&[-0.2, 0.0, 0.2], a[6], a[7]);
        with(&GaugeSpectra {
            frequency_hz: &frequency_hz,
            tests: &[&spectra],
            noise: &vec![vec![a[8]; LINES]; 3],
        })
    };
    findings.sweep("ThreePoint", &sound, |a| {
        let method = ThreePoint::new(rod(a))?;
        estimate(a, &|spectra| Ok(numbers(&method.estimate(spectra)?)))
    });
    findings.sweep("MultiPoint", &sound, |a| {
        let method = MultiPoint::new(rod(a))?.with_wave_speed(a[5])?;
        estimate(a, &|spectra| {
            let found = method.estimate(spectra)?;
            let mut numbers = numbers(found.modulus());
            for (line, fit) in found.fits().iter().enumerate() {
                numbers.extend([fit.propagation_variance, fit.second_order]);
                let waves = found.waves(line, 0, a[1], Quantity::Strain).unwrap();
                numbers.extend([waves.forward.norm(), waves.backward.norm()]);
            }
            Ok(numbers)
        })
    });
    findings.sweep(
        "predict",
        &[-0.2, 0.0, 0.3, 0.01, 100.0, -0.9, 0.1, 0.5],
        |a| {
            let medium = Medium::new(1150.0, ConstantQ::new(3e9, 0.05, 1e4).unwrap()).unwrap();
            let waves = ExpectedWaves {
                incident_at: a[6],
                reflector_at: a[7],
                reflection: Complex64::new(a[5], 0.0),
            };
            let predicted = predict(&medium, &a[..3], waves, a[3], &[a[4]])?;
            assert!(
                predicted
                    .iter()
                    .all(|line| !line.relative_deviation.is_nan())
            );
            Ok(Vec::new())
        },
    );
    findings.sweep_pairs("common_spacing", &[-0.2, 0.0, 0.3, 1e-4], |a| {
        Ok(common_spacing(&a[..3], a[3])?.into_iter().collect())
    });
    findings.sweep("singular_frequencies", &[-0.2, 0.0, 0.3, 1e-4, 1e4], |a| {
        let medium = Medium::new(1150.0, ConstantQ::new(3e9, 0.05, 1e4).unwrap()).unwrap();
        singular_frequencies(&medium, &a[..3], a[3], a[4])
    });
    findings.none();
}

#[test]
fn branches() {
    let mut findings = Findings::default();
    findings.sweep_pairs("FreeEndRoot", &[0.5, 0.1], |a| {
        let root = FreeEndRoot::of(Complex64::new(a[0], a[1]));
        if !(a[0].is_finite() && a[1].is_finite()) {
            return Ok(Vec::new());
        }
        let on = root.on(Branch::in_quadrant(3));
        Ok(vec![on.re, on.im])
    });
    for quadrant in [0, 1, u32::MAX - 1, u32::MAX] {
        assert!(
            FreeEndRoot::of(Complex64::I)
                .on(Branch::in_quadrant(quadrant))
                .is_finite()
        );
    }
    findings.sweep(
        "BranchTracker",
        &[1600.0, 0.1, 500.0, 2.0, 0.5, 1.0, 1.0, 1e-6],
        |a| {
            let (mut frequency_hz, observed) = spoilt(&Specimen::polymer(), a[6]);
            frequency_hz.iter_mut().for_each(|f| *f *= a[5]);
            let tracker = BranchTracker::new()
                .with_wave_speed(a[0], a[1])?
                .with_wave_number(a[2], a[3], a[4])?;
            let tracked = tracker.track(&[PhaseRecord {
                observation: &FreeEndPhase,
                length: 1.0,
                frequency_hz: &frequency_hz,
                observed: &observed,
                variance: Some(&[a[7]; LINES]),
            }])?;
            let lines = tracked.records.iter().flatten();
            let said = lines.flat_map(|line| {
                let root = line.root.unwrap_or_default();
                [root.re, root.im, line.confidence]
            });
            Ok(said.collect())
        },
    );
    findings.sweep("length of a record", &[1.0, 1e-6], |a| {
        let (frequency_hz, observed) = spoilt(&Specimen::polymer(), 1.0);
        let tracked = BranchTracker::new().track(&[PhaseRecord {
            observation: &FreeEndPhase,
            length: a[0],
            frequency_hz: &frequency_hz,
            observed: &observed,
            variance: Some(&[a[1]; LINES]),
        }])?;
        let lines = tracked.records.iter().flatten();
        Ok(lines.map(|line| line.confidence).collect())
    });
    findings.none();
}

/// Checks a band far above its resolution: waves of a kilometre at a terahertz cannot be counted,
/// and no count is tried.
#[test]
fn hopeless_bands_are_undetermined() {
    for (first, step) in [(1e6, 1.0), (1e9, 1e-3), (1e12, 1e-3), (1e12, 1e9)] {
        let frequency_hz: Vec<f64> = (0..LINES).map(|k| first + step * k as f64).collect();
        let ratio: Vec<Complex64> = (0..LINES)
            .map(|k| Complex64::from_polar(0.7, 0.3 * k as f64))
            .collect();
        let specimen = cmod::Specimen {
            length: 1e3,
            ..SOUND
        };
        let method = TwoPoint::new(specimen).unwrap();
        let estimate = method
            .estimate(&frequency_hz, &ratio, &[1e-6; LINES])
            .unwrap();
        assert_eq!(estimate.valid().count(), 0, "from {first} Hz");
    }
}

fn sound_estimate() -> ModulusEstimate {
    let (frequency_hz, ratio) = spoilt(&Specimen::polymer(), 1.0);
    let method = TwoPoint::new(SOUND).unwrap();
    method
        .estimate(&frequency_hz, &ratio, &[1e-8; LINES])
        .unwrap()
}

#[test]
fn checks_and_corrections() {
    let mut findings = Findings::default();
    let estimate = sound_estimate();
    assert!(estimate.valid().count() > LINES / 2);
    let said = |outcome: cmod::checks::CheckOutcome| {
        let _ = outcome.to_string();
        vec![outcome.statistic, outcome.p_value]
    };
    findings.sweep("passivity", &[0.01], |a| {
        passivity(&estimate, a[0]).map(said)
    });
    findings.sweep("kramers_kronig_on", &[0.01], |a| {
        kramers_kronig_on(&estimate, 20, 1.0, a[0]).map(said)
    });
    findings.sweep("LateralInertia", &[0.02, 1150.0, 0.35, 0.01], |a| {
        let corrected = LateralInertia::new(a[0], a[1], a[2])?
            .with_poisson_ratio_uncertainty(a[3])?
            .correct(&estimate)?;
        let mut numbers = numbers(corrected.modulus());
        numbers.extend(
            corrected
                .corrections()
                .iter()
                .map(|line| line.remaining_error),
        );
        Ok(numbers)
    });
    findings.sweep_pairs("coverage_factor", &[0.95, 9.0], |a| {
        Ok(vec![
            coverage_factor(a[0], Some(a[1]))?,
            coverage_factor(a[0], None)?,
        ])
    });
    let sound = [0.1, 0.4, 1e-5, 1600.0, 1e-4, 0.01, 1.0];
    findings.sweep("Arrivals", &sound, |a| {
        let noise = |k: u32| f64::from((k * 7919) % 101) - 50.0;
        let history: Vec<f64> = (0..200).map(|k| a[6] * noise(k)).collect();
        let channels = [a[0], a[1]].map(|distance| Channel {
            samples: &history,
            distance,
        });
        let arrivals = Arrivals::new(channels.into(), a[2], 50)?;
        let causality = arrivals.causality(a[3], a[5]).map(said).unwrap_or_default();
        let polarity = arrivals.polarity(a[3], a[4], a[5]).map(said);
        Ok([causality, polarity?].concat())
    });
    findings.none();
}

/// Checks empty arrays, arrays of one entry, and arrays of different lengths.
#[test]
fn empty_and_unequal_arrays() {
    let one = [Complex64::ONE];
    let specimen = cmod::Specimen {
        accelerometer_mass: 1e-3,
        ..SOUND
    };
    let rod = RodWithFreeEnd {
        diameter: 0.02,
        density: 1150.0,
        end_mass: 0.0,
    };
    let section = |distance| EndSection {
        distance,
        quantity: Quantity::Acceleration,
    };
    type Estimate = Box<dyn Fn(&[f64], &[Complex64], &[f64]) -> Result<ModulusEstimate, CmodError>>;
    let two_point = TwoPoint::new(specimen).unwrap();
    let free_end = FreeEnd::new(rod, section(1.0), section(0.0)).unwrap();
    let one_gauge = OneGauge::new(rod, section(0.4)).unwrap();
    let resonances = Resonances::new(rod, 1.0).unwrap();
    let pulses = SeparatePulses::new(PulsedRod {
        distance: 0.4,
        diameter: 0.02,
        density: 1150.0,
    })
    .unwrap();
    let methods: [Estimate; 5] = [
        Box::new(move |f, r, v| two_point.estimate(f, r, v)),
        Box::new(move |f, r, v| free_end.estimate(f, r, v)),
        Box::new(move |f, r, v| one_gauge.estimate(f, r, v)),
        Box::new(move |f, r, v| resonances.estimate(f, r, v)),
        Box::new(move |f, r, v| pulses.estimate(f, r, v)),
    ];
    for method in &methods {
        assert!(method(&[], &[], &[]).is_err());
        assert!(method(&[100.0], &[], &[]).is_err());
        assert!(method(&[100.0], &one, &[]).is_err());
        assert!(method(&[100.0], &[], &[1e-6]).is_err());
        assert!(method(&[100.0, 200.0], &one, &[1e-6]).is_err());
        for frequency_hz in [0.0, 100.0, 5e-324, 1e300] {
            for ratio in [0.0, 1.0, -1.0, f64::NAN, 1e300, 5e-324] {
                let ratio = [Complex64::new(ratio, 0.0)];
                let estimate = method(&[frequency_hz], &ratio, &[0.0]).unwrap();
                // the waves of a single line cannot be counted
                assert_eq!(estimate.valid().count(), 0);
                assert!(numbers(&estimate).iter().all(|number| number.is_finite()));
            }
        }
        // all lines are without a signal
        let frequency_hz: Vec<f64> = (1..=LINES).map(|k| k as f64).collect();
        let estimate = method(&frequency_hz, &[Complex64::ZERO; LINES], &[0.0; LINES]).unwrap();
        assert_eq!(estimate.valid().count(), 0);
        assert!(numbers(&estimate).iter().all(|number| number.is_finite()));
    }
    let gauged = GaugedRod {
        positions: vec![-0.2, 0.0, 0.2],
        diameter: 0.02,
        density: 1150.0,
    };
    assert!(RatioOfSpectra::new(&[], &[], &[], &[]).is_err());
    assert!(RatioOfSpectra::new(&[&one], &[&[]], &[], &[]).is_err());
    assert!(Arrivals::new(Vec::new(), 1e-5, 10).is_err());
    let found = MultiPoint::new(gauged).unwrap();
    let (frequency_hz, spectra) = gauge_spectra(&[-0.2, 0.0, 0.2], 1.0, 1.0);
    let found = found
        .estimate(&GaugeSpectra {
            frequency_hz: &frequency_hz,
            tests: &[&spectra],
            noise: &vec![vec![1e-3; LINES]; 3],
        })
        .unwrap();
    for (line, test) in [
        (usize::MAX, 0),
        (0, usize::MAX),
        (usize::MAX, usize::MAX),
        (LINES, 0),
    ] {
        assert!(found.waves(line, test, 0.0, Quantity::Strain).is_none());
    }
    for section in [f64::NAN, f64::INFINITY, 1e300] {
        let _ = found.waves(0, 0, section, Quantity::Velocity);
    }
}
