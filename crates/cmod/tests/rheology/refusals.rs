//! Refusal of impossible points and requests.

use cmod::CmodError;
use cmod::rheology::{ErrorScale, FitOptions, Law, ModulusData, ModulusPoint, RheologicalFit};
use num_complex::Complex64;

fn good() -> Vec<ModulusPoint> {
    [100.0, 200.0, 400.0]
        .map(|f| ModulusPoint::circular(f, Complex64::new(2e9, 1e8), 1e7))
        .to_vec()
}

#[test]
fn points_that_cannot_be() {
    assert_eq!(ModulusData::new(&[]), Err(CmodError::NoLines));
    let refused = |change: &dyn Fn(&mut ModulusPoint)| {
        let mut points = good();
        change(&mut points[1]);
        ModulusData::new(&points).unwrap_err().to_string()
    };
    let texts = [
        refused(&|p| p.frequency_hz = f64::NAN),
        refused(&|p| p.frequency_hz = -200.0),
        refused(&|p| p.frequency_hz = 0.0),
        refused(&|p| p.frequency_hz = 100.0),
        refused(&|p| p.modulus.re = f64::INFINITY),
        refused(&|p| p.modulus.im = f64::NAN),
        refused(&|p| p.covariance.real = -1.0),
        refused(&|p| p.covariance.imaginary = 0.0),
        refused(&|p| p.covariance.mixed = 1.5e14),
    ];
    assert_eq!(
        texts,
        [
            "frequency [Hz] of point 1 is NaN, expected a finite value above 0",
            "frequency [Hz] of point 1 is -200, expected a finite value above 0",
            "frequency [Hz] of point 1 is 0, expected a finite value above 0",
            "frequency of line 1 is 100 Hz, expected more than the 100 Hz of the previous line",
            "storage modulus [Pa] of point 1 is inf, expected a finite value",
            "loss modulus [Pa] of point 1 is NaN, expected a finite value",
            "variance of the storage modulus [Pa^2] of point 1 is -1, expected a finite value above 0",
            "variance of the loss modulus [Pa^2] of point 1 is 0, expected a finite value above 0",
            "correlation of storage and loss modulus of point 1 is 1.5, expected a value between -1 and 1",
        ]
    );
    // over such a band the grid of relaxation times would be infinite
    for frequency_hz in [1e308, 1e-310] {
        assert_eq!(
            refused(&|p| p.frequency_hz = frequency_hz),
            format!(
                "frequency [Hz] of point 1 is {frequency_hz}, expected a value whose angular frequency and its inverse are finite"
            )
        );
    }
}

#[test]
fn requests_that_cannot_be() {
    let data = ModulusData::new(&good()).unwrap();
    let one = ModulusData::new(&good()[..1]).unwrap();
    let options = FitOptions::default();
    assert_eq!(
        RheologicalFit::new(&one, Law::Zener, &options).unwrap_err(),
        CmodError::TooFewReadings {
            found: 2,
            expected: 3
        }
    );
    let from_residual = options.with_error_scale(ErrorScale::FromResidual);
    assert_eq!(
        RheologicalFit::new(&one, Law::KelvinVoigt, &from_residual).unwrap_err(),
        CmodError::TooFewReadings {
            found: 2,
            expected: 3
        }
    );
    for confidence in [0.0, 1.0, f64::NAN] {
        assert!(
            RheologicalFit::new(&data, Law::Zener, &options.with_confidence(confidence)).is_err()
        );
    }
    let law = Law::PowerLaw { density: -1.0 };
    assert!(matches!(
        RheologicalFit::new(&data, law, &options),
        Err(CmodError::NonPhysical { value: -1.0, .. })
    ));
    let fit = RheologicalFit::new(&data, Law::Zener, &options).unwrap();
    assert!(fit.prediction(0.0).is_err());
    // moduli with the other sign of the time factor describe growing waves
    let growing: Vec<_> = good()
        .iter()
        .map(|point| ModulusPoint {
            modulus: point.modulus.conj(),
            ..*point
        })
        .collect();
    let growing = ModulusData::new(&growing).unwrap();
    let refused = RheologicalFit::new(&growing, Law::PowerLaw { density: 900.0 }, &options);
    assert!(
        matches!(refused, Err(CmodError::NoLaw { .. })),
        "{refused:?}"
    );
}

/// The fields of a result may be changed; inconsistent fields are refused.
#[test]
fn a_law_in_the_place_of_a_fitted_one_of_fewer_parameters() {
    let points: Vec<ModulusPoint> = (1..20)
        .map(|k| {
            let f = 100.0 * f64::from(k);
            ModulusPoint::circular(f, Complex64::new(2e9 + 1e5 * f, 1e5 * f), 1e7)
        })
        .collect();
    let data = ModulusData::new(&points).unwrap();
    let options = FitOptions::default().with_profiles(false);
    let mut fit = RheologicalFit::new(&data, Law::KelvinVoigt, &options).unwrap();
    assert!(fit.prediction(1e3).is_ok());
    fit.law = RheologicalFit::new(&data, Law::Zener, &options)
        .unwrap()
        .law;
    assert_eq!(
        fit.prediction(1e3).unwrap_err().to_string(),
        "the changed result has 2 fitted parameters, expected at least 3"
    );
}
