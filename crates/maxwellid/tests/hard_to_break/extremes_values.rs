//! Tests of extreme numbers for every argument: a number is refused with an error that names it, or
//! the result is finite.

use maxwellid::adequacy::{RobbinsMonro, Weights};
use maxwellid::conformal::p_values;
use maxwellid::design::{Design, Estimated, PlannedTest};
use maxwellid::profile::profiles;
use maxwellid::samples::{Pattern, StandardSamples};
use maxwellid::selection::{Candidate, Selection};
use maxwellid::{
    Differentiator, DisplacementTransducers, Fit, Freedom, MaxwellidError, Nuisances, RodModel,
    RodTest, RodTestData,
};
use rodwave::inelastic::Maxwell;

use super::hostile;
use super::{MODULUS, V0, data, excitation, test_of};

fn sweep(name: &str, door: impl Fn(f64) -> Result<Vec<f64>, MaxwellidError>) {
    hostile::sweep(name, door);
}

fn maxwell() -> Maxwell {
    Maxwell::from_reference_rate(20.0, 10e6).unwrap()
}

fn test() -> RodTest {
    test_of(&maxwell(), &RodModel::parameters(&maxwell(), MODULUS), V0)
}

fn fit(test: Result<RodTest, MaxwellidError>) -> Result<Vec<f64>, MaxwellidError> {
    let found = Fit::of(maxwell()).with_cell(16e-3).to(&[test?])?;
    Ok([found.parameters(), &[found.relative_error()]].concat())
}

#[test]
fn tests_of_rods() {
    let plain = || {
        let mut response = test().response().to_vec();
        response.resize(excitation(V0).len(), response[response.len() - 1]);
        data(V0, response)
    };
    let base = plain();
    let of = |change: &dyn Fn(&mut RodTestData)| {
        let mut data = base.clone();
        change(&mut data);
        fit(RodTest::new(data))
    };
    sweep("length", |x| of(&|d| d.length = x));
    sweep("density", |x| of(&|d| d.density = x));
    sweep("impact velocity", |x| of(&|d| d.impact_velocity = x));
    sweep("sampling rate", |x| of(&|d| d.sampling_rate_hz = x));
    sweep("excitation", |x| of(&|d| d.excitation[60] = x));
    sweep("response", |x| of(&|d| d.response[60] = x));
    sweep("unit of velocity", |x| {
        of(&|d| {
            d.excitation
                .iter_mut()
                .chain(&mut d.response)
                .for_each(|v| *v *= x);
        })
    });
    sweep("window", |x| test().with_window(x).map(|t| t.times()));
    sweep("noise of the excitation", |x| {
        test()
            .with_noise(x, 0.1)
            .map(|t| vec![t.noise().unwrap().excitation.standard_deviation()])
    });
    sweep("noise of the response", |x| {
        test()
            .with_noise(0.1, x)
            .map(|t| vec![t.noise().unwrap().response.standard_deviation()])
    });
    assert!(
        test().with_noise(0.1, 0.0).is_err(),
        "a test without noise has no weight"
    );
    sweep("range of a transducer", |x| {
        let transducers = DisplacementTransducers {
            range: x,
            noise: Some((1e-6, 1e-6)),
            differentiator: Differentiator::new(3, 4)?,
        };
        RodTest::from_displacements(base.clone(), &transducers)
            .map(|t| t.response().to_vec())
            .and_then(|r| {
                // an infinite range is permitted, but the sweep expects an error for a number that
                // is not finite
                if x.is_finite() {
                    Ok(r)
                } else {
                    Err(MaxwellidError::NoTest)
                }
            })
    });
    // records with no sample, with one sample, and of unequal lengths
    for (excitation, response) in [
        (vec![], vec![]),
        (vec![0.0], vec![0.0]),
        (vec![0.0; 100], vec![0.0; 99]),
    ] {
        assert!(
            RodTest::new(RodTestData {
                excitation,
                response,
                ..base.clone()
            })
            .is_err()
        );
    }
}

#[test]
fn fits() {
    let tests = [test()];
    let of = |fit: Fit<Maxwell>| fit.to(&tests).map(|found| found.parameters().to_vec());
    sweep("cell", |x| of(Fit::of(maxwell()).with_cell(x)));
    sweep("accuracy", |x| {
        of(Fit::of(maxwell()).with_accuracy(x).with_cell(16e-3))
    });
    sweep("modulus to start from", |x| {
        of(Fit::of(maxwell()).starting_from(x).with_cell(16e-3))
    });
    sweep("calibration", |x| {
        let nuisances = Nuisances {
            response_gain: Freedom::Within(x),
            ..Nuisances::default()
        };
        let noisy = [test().with_noise(0.05, 0.05)?];
        let found = Fit::of(maxwell())
            .with_cell(16e-3)
            .with_nuisances(nuisances)
            .to(&noisy)?;
        Ok(found.parameters().to_vec())
    });
    // a grid with more cells than memory has bytes
    let fine = Fit::of(maxwell()).with_cell(1e-15).to(&tests);
    assert!(
        matches!(
            fine,
            Err(MaxwellidError::Setting {
                setting: "cell of the grid [m]",
                ..
            })
        ),
        "{:?}",
        fine.map(|_| ())
    );
    assert!(matches!(
        Fit::of(maxwell()).to(&[]),
        Err(MaxwellidError::NoTest)
    ));
}

#[test]
fn selections_profiles_and_designs() {
    let noisy = [test().with_noise(0.05, 0.05).unwrap()];
    let candidate = Candidate::inelastic(maxwell(), &[]).unwrap();
    let parameters = candidate.model().parameters(MODULUS);
    let estimated = Estimated {
        candidate: &candidate,
        parameters: &parameters,
    };
    for cell in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e-300, 1e-12] {
        let is_refused = |error: MaxwellidError| matches!(error, MaxwellidError::Setting { .. });
        assert!(
            is_refused(profiles(&candidate, &noisy, cell).unwrap_err()),
            "{cell}"
        );
        let design = Design {
            tests: &noisy,
            cell,
        };
        assert!(
            is_refused(design.deviations(estimated, &[]).unwrap_err()),
            "{cell}"
        );
        let selection = Selection::new(vec![candidate.clone()])
            .unwrap()
            .with_cell(cell);
        assert!(
            is_refused(selection.and_then(|s| s.compare(&noisy)).unwrap_err()),
            "{cell}"
        );
    }
    sweep("planned velocity", |x| {
        PlannedTest::at_velocity(&noisy[0], x).map(|_| Vec::new())
    });
    sweep("samples of the noise", |x| {
        Selection::new(vec![candidate.clone()])?
            .with_noise_of(x)
            .map(|_| Vec::new())
    });
    sweep("probability", |x| {
        Selection::new(vec![candidate.clone()])?
            .with_levels(x, 0.01)
            .map(|_| Vec::new())
    });
    sweep("level", |x| {
        Selection::new(vec![candidate.clone()])?
            .with_levels(0.95, x)
            .map(|_| Vec::new())
    });
    sweep("prior weight", |x| {
        candidate.clone().with_prior_weight(x).map(|_| Vec::new())
    });
    assert!(Selection::new(Vec::new()).is_err());
    // patterns of other tests are refused
    let samples =
        StandardSamples::of(std::slice::from_ref(&candidate), &noisy, 4, Pattern::Signed).unwrap();
    let projection = samples.projection(1).unwrap();
    let pattern = samples.measured(&noisy);
    assert!(projection.project(&pattern).is_ok());
    assert!(matches!(
        projection.project(&pattern[1..]),
        Err(MaxwellidError::WrongLength { .. })
    ));
    let mut broken = samples.clone();
    broken.patterns[1].pop();
    assert!(matches!(
        broken.projection(1),
        Err(MaxwellidError::WrongLength { .. })
    ));
    broken.patterns.clear();
    assert!(matches!(
        broken.projection(1),
        Err(MaxwellidError::TooManyComponents { found: 0, .. })
    ));
}

#[test]
fn classes() {
    let features = vec![vec![1.0, 0.0], vec![1.0, 1.0], vec![1.0, 2.0]];
    let settings = RobbinsMonro::default();
    // a class number that is too large for any list of classes
    for classes in [[0, 1, usize::MAX], [0, 1, 1 << 60], [0, 1, 3]] {
        assert!(Weights::robbins_monro(&features, &classes, &settings).is_err());
        assert!(Weights::least_squares(&features, &classes, 1.0).is_err());
        assert!(p_values(&features, &classes, &[1.0, 0.5]).is_err());
    }
    for passes in [0, usize::MAX] {
        let settings = RobbinsMonro { passes, ..settings };
        assert!(
            Weights::robbins_monro(&features, &[0, 1, 1], &settings).is_err(),
            "{passes}"
        );
    }
    sweep("gain", |x| {
        Weights::robbins_monro(
            &features,
            &[0, 1, 1],
            &RobbinsMonro {
                gain: x,
                passes: 2,
                ..settings
            },
        )?
        .adequacies(&[1.0, 1.0])
        .map(|_| Vec::new())
    });
    sweep("delay", |x| {
        Weights::robbins_monro(
            &features,
            &[0, 1, 1],
            &RobbinsMonro {
                delay: Some(x),
                passes: 2,
                ..settings
            },
        )?
        .adequacies(&[1.0, 1.0])
        .map(|_| Vec::new())
    });
    sweep("ridge", |x| {
        Weights::least_squares(&features, &[0, 1, 1], x)?
            .adequacies(&[1.0, 1.0])
            .map(|_| Vec::new())
    });
    for bad in [f64::NAN, f64::INFINITY] {
        let features = vec![vec![1.0, bad], vec![1.0, 1.0], vec![1.0, 2.0]];
        assert!(Weights::least_squares(&features, &[0, 1, 1], 1.0).is_err());
        assert!(Weights::robbins_monro(&features, &[0, 1, 1], &settings).is_err());
        assert!(p_values(&[vec![1.0], vec![2.0]], &[0, 0], &[bad]).is_err());
    }
    let weights = Weights::least_squares(&features, &[0, 1, 1], 1.0).unwrap();
    assert!(matches!(
        weights.adequacies(&[1.0]),
        Err(MaxwellidError::WrongLength {
            what: "set of features",
            found: 1,
            expected: 2
        })
    ));
}
