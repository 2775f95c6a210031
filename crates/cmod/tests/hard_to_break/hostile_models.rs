//! Recovery after creep, fits of laws, master curves and cards with extreme readings and
//! parameters.

use num_complex::Complex64;

use cmod::estimate::ComplexCovariance;
use cmod::recovery::{
    LoadHistory, LoadSegment, LossFactorReadings, Recovery, RecoveryTest, SingleTestFit,
    ThreeElement, ThreeElementParameters,
};
use cmod::rheology::card::{BulkBehaviour, MaterialCard, Moduli};
use cmod::rheology::{
    FitOptions, Law, ModulusData, ModulusPoint, PronyFit, RheologicalFit, TemperatureSweep,
};
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};

use super::hostile::are_modest;
use super::{Findings, Numbers};

fn recovered(model: &ThreeElement, recovery: &Recovery, omega: f64, time: f64) -> Vec<f64> {
    let stress = recovery.initial_dashpot_stress();
    let modulus = model.complex_modulus(omega, stress);
    vec![
        stress,
        modulus.re,
        modulus.im,
        model.loss_factor(omega, stress),
        model.modulus_change(omega, stress),
        recovery.loss_factor_change(omega, time),
        recovery.dashpot_stress(time),
        recovery.modulus_change(omega, time),
    ]
}

/// Returns true for stresses at which the dashpot flows so fast that the integration needs all of
/// its four million steps before it fails.
fn is_stiff(stress: &[f64]) -> bool {
    stress
        .iter()
        .any(|stress| (1e11..1e290).contains(&stress.abs()))
}

#[test]
fn recovery_after_loads() {
    let mut findings = Findings::default();
    let sound = [3e9, 1e9, 1e-26, 2.0, 2e7, 100.0, 1e4, 50.0];
    findings.sweep_pairs("ThreeElement", &sound, |a| {
        let model = ThreeElement::new(ThreeElementParameters {
            series_modulus: a[0],
            parallel_modulus: a[1],
            coefficient: a[2],
            exponent: a[3],
        })?;
        let recovery = model.recovery(&LoadHistory::creep(a[4], a[5])?)?;
        let mut numbers = vec![recovery.initial_dashpot_stress()];
        if are_modest(a) && a[6] > 0.0 && a[7] >= 0.0 {
            numbers.extend(recovered(&model, &recovery, a[6], a[7]));
        }
        Ok(numbers)
    });
    let model = ThreeElement::new(ThreeElementParameters {
        series_modulus: 3e9,
        parallel_modulus: 1e9,
        coefficient: 1e-26,
        exponent: 2.0,
    })
    .unwrap();
    findings.sweep("Ramp", &[0.0, 2e7, 100.0], |a| {
        if is_stiff(&a[..2]) {
            return Ok(Vec::new());
        }
        let ramp = LoadSegment::Ramp {
            from: a[0],
            to: a[1],
            duration: a[2],
        };
        let recovery = model.recovery(&LoadHistory::new(vec![ramp])?)?;
        Ok(vec![recovery.initial_dashpot_stress()])
    });
    findings.sweep("Periodic", &[1e7, 1e7, 2.0, 20.0], |a| {
        if a[2] * a[3] > 1e3 && a[2] * a[3] < 1e6 || is_stiff(&a[..2]) {
            return Ok(Vec::new()); // long, but possible
        }
        let load = LoadSegment::Periodic {
            mean: a[0],
            amplitude: a[1],
            frequency_hz: a[2],
            duration: a[3],
        };
        let recovery = model.recovery(&LoadHistory::new(vec![load])?)?;
        Ok(vec![recovery.initial_dashpot_stress()])
    });
    findings.sweep("LoadHistory::from_samples", &[0.0, 1.0, 1e7, 2e7], |a| {
        let load = LoadHistory::from_samples(&a[..2], &a[2..])?;
        Ok(vec![load.largest_stress(), load.duration()])
    });
    assert!(LoadHistory::new(Vec::new()).is_err());
    assert!(LoadHistory::from_samples(&[], &[]).is_err());
    assert!(LoadHistory::from_samples(&[1.0], &[1.0]).is_err());
    findings.none();
}

#[test]
fn fits_of_recovery() {
    let mut findings = Findings::default();
    let sound = [2e7, 100.0, 500.0, 1e-3, 5e-4, 1e-5, 1e-5];
    findings.sweep("SingleTestFit", &sound, |a| {
        let readings = LossFactorReadings {
            time: &[1.0, 10.0, 100.0, 1000.0],
            change: &[a[3], a[4], 2e-4, 1e-4],
            standard_error: &[a[5]; 4],
            virgin_standard_error: a[6],
        };
        let load = LoadHistory::creep(a[0], a[1])?;
        let test = RecoveryTest::new("hostile", load, a[2], readings)?;
        let fit = SingleTestFit::new(&test)?;
        let parameters = fit.parameters_for(&test, 2.0, 3e9)?;
        Ok(vec![parameters.parallel_modulus, parameters.coefficient])
    });
    findings.none();
}

fn points(a: &[f64]) -> Vec<ModulusPoint> {
    (0..12_u32)
        .map(|k| {
            let frequency_hz = a[0] * 10f64.powf(0.25 * f64::from(k));
            let x = Complex64::new(0.0, frequency_hz * 1e-3 * std::f64::consts::TAU);
            let mut modulus = 1e9 + a[1] * x / (1.0 + x);
            if k == 5 {
                modulus *= a[2];
            }
            ModulusPoint::circular(frequency_hz, modulus, a[3])
        })
        .collect()
}

fn fitted(fit: &RheologicalFit) -> Vec<f64> {
    let _ = fit.to_string();
    let mut numbers = vec![fit.chi_squared];
    for parameter in &fit.parameters {
        assert!(!parameter.value.is_nan());
        assert!(!(parameter.interval.lower.is_nan() || parameter.interval.upper.is_nan()));
    }
    let at = fit.prediction(1e3).unwrap().modulus;
    numbers.extend([at.re, at.im]);
    numbers
}

#[test]
fn laws_of_moduli() {
    let mut findings = Findings::default();
    let options = FitOptions::default().with_profiles(false);
    let laws = [
        Law::Zener,
        Law::KelvinVoigt,
        Law::FractionalZener,
        Law::HavriliakNegami,
        Law::PowerLaw { density: 1150.0 },
    ];
    for law in laws {
        findings.sweep(&format!("fit of {law}"), &[10.0, 1e9, 1.0, 1e6], |a| {
            let data = ModulusData::new(&points(a))?;
            Ok(fitted(&RheologicalFit::new(&data, law, &options)?))
        });
    }
    findings.sweep("PronyFit", &[10.0, 1e9, 1.0, 1e6], |a| {
        let data = ModulusData::new(&points(a))?;
        Ok(fitted(&PronyFit::new(&data, &options)?.fit))
    });
    findings.sweep_pairs("confidence and weight", &[0.95, 1e6], |a| {
        let data = ModulusData::new(&points(&[10.0, 1e9, 1.0, a[1]]))?;
        let options = options.with_confidence(a[0]);
        Ok(fitted(&RheologicalFit::new(&data, Law::Zener, &options)?))
    });
    let data = ModulusData::new(&points(&[10.0, 1e9, 1.0, 1e6])).unwrap();
    for branches in [13, 1000, usize::MAX / 2, usize::MAX - 1, usize::MAX] {
        assert!(
            PronyFit::with_order(&data, branches, &options).is_err(),
            "{branches}"
        );
    }
    findings.none();
}

/// Checks that points whose E' and E'' are correlated completely, up to rounding, do not make χ²
/// infinite.
#[test]
fn points_that_are_all_but_correlated() {
    let mut accepted = 0;
    for k in 0..4000_u32 {
        let (real, imaginary) = (1.0 + 0.37 * f64::from(k), 3.0 + 0.11 * f64::from(k % 97));
        let mixed = (real * imaginary).sqrt() * (1.0 - f64::from(k % 5) * f64::EPSILON);
        let point = ModulusPoint {
            frequency_hz: 10.0,
            modulus: Complex64::new(1e9, 1e8),
            covariance: ComplexCovariance {
                real,
                imaginary,
                mixed,
            },
        };
        let other = ModulusPoint::circular(20.0, Complex64::new(1e9, 1e8), 1e6);
        let Ok(data) = ModulusData::new(&[point, other]) else {
            continue;
        };
        accepted += 1;
        let options = FitOptions::default().with_profiles(false);
        if let Ok(fit) = RheologicalFit::new(&data, Law::KelvinVoigt, &options) {
            assert!(fit.chi_squared.is_finite(), "{real} {imaginary} {mixed}");
        }
    }
    assert!(accepted > 100);
}

fn card(a: &[f64]) -> Numbers {
    let branches = vec![MaxwellBranch {
        modulus: a[3],
        relaxation_time: a[4],
    }];
    // arguments that no law accepts are skipped
    let Ok(law) = GeneralisedMaxwell::new(a[2], branches) else {
        return Ok(Vec::new());
    };
    let card = MaterialCard::new("PA6", a[0], a[1], &law)?;
    let cards = [
        card.abaqus(Moduli::Instantaneous, BulkBehaviour::Elastic),
        card.abaqus(Moduli::LongTerm, BulkBehaviour::Elastic),
        card.abaqus(Moduli::LongTerm, BulkBehaviour::ConstantPoissonRatio),
        card.ansys(1, BulkBehaviour::Elastic),
        card.ansys(1, BulkBehaviour::ConstantPoissonRatio),
        card.ls_dyna(1),
        card.comsol(),
        card.json(),
        card.code_aster(1.0, 1e4),
    ];
    for text in cards.into_iter().flatten() {
        let numbers = text
            .lines()
            .filter(|line| !line.starts_with(['$', '*', '!']));
        for line in numbers {
            assert!(!line.contains("NaN") && !line.contains("inf"), "{text}");
        }
    }
    Ok(Vec::new())
}

#[test]
fn cards() {
    let mut findings = Findings::default();
    findings.sweep_pairs("MaterialCard", &[1150.0, 0.35, 1e9, 2e9, 1e-4], card);
    findings.none();
}

#[test]
fn temperatures() {
    let mut findings = Findings::default();
    findings.sweep_pairs("TemperatureSweep", &[250.0, 300.0, 1150.0], |a| {
        let data = || ModulusData::new(&points(&[10.0, 1e9, 1.0, 1e6])).unwrap();
        let sweep = TemperatureSweep::new(vec![(a[0], data()), (a[1], data())])?;
        Ok(sweep
            .with_rubber_elasticity(&[a[2], a[2]])?
            .temperatures()
            .to_vec())
    });
    assert!(TemperatureSweep::new(Vec::new()).is_err());
    assert!(ModulusData::new(&[]).is_err());
    findings.none();
}
