//! Laws in closed form: the true values are recovered, errors equal the scatter, intervals cover
//! the truth, and residuals reveal a wrong law.

use cmod::rheology::{
    Ending, ErrorScale, FitOptions, FittedLaw, Law, ModulusData, ModulusPoint, PronyFit,
    RheologicalFit,
};
use num_complex::Complex64;
use rodwave::medium::PropagationLaw;
use rodwave::modulus::{ComplexModulus, FractionalZener, HavriliakNegami, KelvinVoigt, Zener};
use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;

use super::measured::{Noise, logarithmic, measured, series};
use crate::materials::printed_nylon;
use crate::reference_lmfit::coordinate;

type Truth = (Law, Box<dyn Fn(f64) -> Complex64>, Vec<f64>);

/// Returns laws with the true values of their parameters, in the order of the fit.
fn truths() -> Vec<Truth> {
    let kelvin_voigt = KelvinVoigt::new(2.0e9, 1.5e4).unwrap();
    let zener = Zener::new(2.0e9, 2.7e9, 4e-5).unwrap();
    let fractional = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let skew = HavriliakNegami::new(1.5e9, 3.6e9, 2e-4, 0.7, 0.5).unwrap();
    let nylon = printed_nylon(1.0);
    let series = series(2.0e9, &[(0.4e9, 2e-5), (0.3e9, 1e-3)]);
    vec![
        (
            Law::KelvinVoigt,
            Box::new(move |omega| kelvin_voigt.at(omega)),
            vec![2.0e9, 1.5e4],
        ),
        (
            Law::Zener,
            Box::new(move |omega| zener.at(omega)),
            vec![2.0e9, 0.7e9, 4e-5],
        ),
        (
            Law::FractionalZener,
            Box::new(move |omega| fractional.at(omega)),
            vec![1.8e9, 1.6e9, 4e-5, 0.45],
        ),
        (
            Law::HavriliakNegami,
            Box::new(move |omega| skew.at(omega)),
            vec![1.5e9, 2.1e9, 2e-4, 0.7, 0.35],
        ),
        (
            Law::PowerLaw { density: 1150.0 },
            Box::new(move |omega| PropagationLaw::modulus(&nylon, omega, 1150.0)),
            vec![8.818e-5, 0.894, 8.937e-4, 0.970],
        ),
        (
            Law::GeneralisedMaxwell,
            Box::new(move |omega| series.at(omega)),
            vec![2.0e9, 0.4e9, 2e-5, 0.3e9, 1e-3],
        ),
    ]
}

fn band() -> Vec<f64> {
    logarithmic(50.0, 50e3, 100)
}

fn fitted(data: &ModulusData, law: Law) -> RheologicalFit {
    let options = FitOptions::default();
    match law {
        Law::GeneralisedMaxwell => PronyFit::with_order(data, 2, &options).unwrap().fit,
        _ => RheologicalFit::new(data, law, &options).unwrap(),
    }
}

/// With stated errors of 1 % but no actual error, the minimum is at the true values, to the
/// accuracy at which the iteration ends.
#[test]
fn exact_data_return_their_law() {
    let mut worst = 0.0_f64;
    for (law, modulus, truth) in truths() {
        let points: Vec<_> = band()
            .into_iter()
            .map(|f| {
                let e = modulus(std::f64::consts::TAU * f);
                ModulusPoint::circular(f, e, 0.01 * e.norm())
            })
            .collect();
        let fit = fitted(&ModulusData::new(&points).unwrap(), law);
        assert_eq!(fit.ending, Ending::Converged, "{law}");
        assert!(fit.chi_squared < 1e-6, "{law}: {:e}", fit.chi_squared);
        assert_eq!(fit.parameters.len(), truth.len(), "{law}");
        let errors = fit.parameters.iter().zip(&truth);
        worst = worst.max(largest(
            errors.map(|(found, truth)| found.value / truth - 1.0),
        ));
    }
    let mut claims = Claims::default();
    claims.by("parameters of the law from which the modulus is computed, among them the printed ones of paper E, eq. 7");
    claims.deviation(
        "Kelvin and Voigt, Zener, fractional Zener, Havriliak and Negami, power laws, two branches: worst parameter of a fit to exact data",
        // the last steps of the iteration are Newton steps
        Within(1e-6, "1e-4 of the standard error for a stated noise of 1 %"),
        Ok(worst),
    );
    hold!(claims);
}

/// Compares the scatter over 200 seeds with the stated covariance, and counts how often the 95 %
/// intervals contain the true values. The errors of E' and E'' are correlated.
#[test]
fn covariance_is_the_scatter_and_intervals_cover() {
    let seeds: u32 = 200;
    for (law, modulus, truth) in truths() {
        let p = truth.len();
        let mut sum = vec![vec![0.0; p]; p];
        let mut stated = vec![vec![0.0; p]; p];
        let mut covered = vec![0; p];
        let mut chi_squared = 0.0;
        for seed in 0..seeds {
            let data = measured(&modulus, &band(), Noise::CORRELATED, u64::from(seed));
            let fit = fitted(&data, law);
            chi_squared += fit.chi_squared / f64::from(seeds) / fit.degrees_of_freedom as f64;
            let covariance = fit.covariance.as_ref().unwrap();
            let error: Vec<f64> = fit
                .parameters
                .iter()
                .zip(&truth)
                .map(|(parameter, truth)| {
                    let of = |value| coordinate(parameter.scale, value);
                    of(parameter.value) - of(*truth)
                })
                .collect();
            for i in 0..p {
                covered[i] += u32::from(fit.parameters[i].interval.contains(truth[i]));
                for j in 0..p {
                    sum[i][j] += error[i] * error[j] / f64::from(seeds);
                    stated[i][j] += covariance[i][j] / f64::from(seeds);
                }
            }
        }
        // tolerance: four times 0.007, the scatter of the mean of 200 values of χ²/ν with a
        // standard deviation of √(2/ν) = 0.1 each
        assert!((chi_squared - 1.0).abs() < 0.03, "{law}: {chi_squared}");
        for i in 0..p {
            let share = f64::from(covered[i]) / f64::from(seeds);
            // 0.95 ± 0.0154 by the binomial distribution; the limits are three standard deviations
            // away
            assert!((0.90..=0.99).contains(&share), "{law}, {i}: {share}");
            for j in 0..p {
                let scale = (stated[i][i] * stated[j][j]).sqrt();
                // tolerance: four times the scatter of the mean of 200 products, (1 + r²)^½/√200 <=
                // 0.1
                assert!(
                    (sum[i][j] - stated[i][j]).abs() < 0.4 * scale,
                    "{law}, {i} {j}: {:e} {:e}",
                    sum[i][j],
                    stated[i][j]
                );
            }
        }
    }
}

/// Errors from the residual are right even if the stated errors are five times too small, and the
/// scatter is reported.
#[test]
fn errors_from_the_residual_do_not_depend_on_the_stated_ones() {
    let law = Zener::new(2.0e9, 2.7e9, 4e-5).unwrap();
    let points = super::measured::points(|omega| law.at(omega), &band(), Noise::CORRELATED, 3);
    let optimistic: Vec<_> = points
        .iter()
        .map(|point| ModulusPoint {
            covariance: point.covariance.through(0.2.into()),
            ..*point
        })
        .collect();
    let options = FitOptions::default().with_error_scale(ErrorScale::FromResidual);
    let fit = |points: &[_]| {
        RheologicalFit::new(&ModulusData::new(points).unwrap(), Law::Zener, &options).unwrap()
    };
    let (right, wrong) = (fit(&points), fit(&optimistic));
    assert!((wrong.variance_factor / right.variance_factor / 25.0 - 1.0).abs() < 1e-6);
    // tolerance: three standard deviations of χ²/ν with ν = 197
    assert!((right.variance_factor - 1.0).abs() < 0.3);
    for (a, b) in right.parameters.iter().zip(&wrong.parameters) {
        // tolerance: both minima are accurate to 1e-9 of χ², which is 3e-5 standard errors
        assert!((a.standard_error / b.standard_error - 1.0).abs() < 1e-4);
    }
}

/// Checks that residuals are white under the true law with the stated probability, and not white
/// under wrong laws.
#[test]
fn residuals_tell_a_wrong_law() {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45).unwrap();
    let options = FitOptions::default();
    let mut refused = 0;
    for seed in 0..200 {
        let data = measured(
            |omega| law.at(omega),
            &band(),
            Noise::CORRELATED,
            5000 + seed,
        );
        let right = RheologicalFit::new(&data, Law::FractionalZener, &options).unwrap();
        refused += u32::from(!right.whiteness.is_white(0.05));
        if seed < 10 {
            assert!(right.p_value() > 1e-4);
            let wrong = RheologicalFit::new(&data, Law::Zener, &options).unwrap();
            assert!(!wrong.whiteness.is_white(0.01), "{}", wrong.whiteness);
            assert!(wrong.p_value() < 1e-6);
            assert!(wrong.bic > right.bic + 20.0);
        }
    }
    // 10 ± 3.1 of 200 cases are expected at the level of 5 %, and the limit is three standard
    // deviations above. The two tests are nearly independent, so the number is not far below 10
    assert!((1..=20).contains(&refused), "{refused}");
}

/// Checks that the law of a power-law fit is the law of rodwave, if rodwave accepts it.
#[test]
fn power_laws_are_those_of_rodwave() {
    let nylon = printed_nylon(1.0);
    let data = measured(
        |omega| PropagationLaw::modulus(&nylon, omega, 1150.0),
        &band(),
        Noise::circular(0.002),
        7,
    );
    let law = Law::PowerLaw { density: 1150.0 };
    let fit = RheologicalFit::new(&data, law, &FitOptions::default()).unwrap();
    let FittedLaw::PowerLaw(found) = fit.law else {
        panic!("{:?}", fit.law)
    };
    let same = found.law().unwrap();
    let error = PropagationLaw::modulus(&same, 1e4, 1150.0) - found.modulus(1e4);
    assert!(error.norm() < 1e-14 * found.modulus(1e4).norm());
    // an elastic rod has q = 1 and no damping: the fit may find q > 1, which rodwave does not
    // accept
    let mut softer = found;
    softer.wave_number_exponent = 1.001;
    assert!(softer.law().is_err());
}
