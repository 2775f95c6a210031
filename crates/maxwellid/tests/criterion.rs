//! The criterion of paper D, computed here from the two velocity histories: pattern, sum of
//! squares, gradient and error.

use crate::virtual_rod;

use maxwellid::samples::{Pattern, StandardSamples};
use maxwellid::selection::Candidate;
use maxwellid::{Fit, Law, Noise, RodTest, RodTestData};
use rodwave::band_limited::SampledHistory;
use rodwave::characteristics::Response;
use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellNorton};
use rodwave::{DirectProblem, InelasticRod};
use virtual_rod::{DENSITY, RATE, V0, struck};

const CELL: f64 = 4e-3;
const MODULUS: f64 = 2.6e9;

/// Records of two rods of different length (Q = 2), with noise on both histories.
fn records<L: InelasticLaw>(law: &L) -> [RodTestData; 2] {
    [(0.2, 1), (0.4, 2)]
        .map(|(length, seed)| struck(length, V0, MODULUS, law, 96).noisy(0.02, seed))
}

/// Simulated response v_r^s of eq. 11 and its derivatives, by the direct problem.
fn simulated<L: InelasticLaw>(data: &RodTestData, modulus: f64, law: &L, n: usize) -> Response {
    let excitation = SampledHistory::new(&data.excitation, RATE).unwrap();
    let rod = InelasticRod::new(data.length, DENSITY, modulus, law.clone()).unwrap();
    let times: Vec<f64> = (0..n).map(|k| k as f64 / RATE).collect();
    DirectProblem::new(rod, (data.length / CELL).ceil() as usize)
        .unwrap()
        .free_end_velocity_with_sensitivities(&excitation, &times)
        .unwrap()
}

/// Sum of squares H of eq. 12 and number N of samples, over the samples of each record that a fit
/// compares.
fn criterion<L: InelasticLaw>(records: &[RodTestData], modulus: f64, law: &L) -> (f64, f64) {
    records.iter().fold((0.0, 0.0), |(sum, count), data| {
        let n = RodTest::new(data.clone()).unwrap().response().len();
        let squares: f64 = simulated(data, modulus, law, n)
            .velocity
            .iter()
            .zip(&data.response)
            .map(|(simulated, measured)| (measured - simulated).powi(2))
            .sum();
        (sum + squares, count + n as f64)
    })
}

/// Checks that the identified parameters minimise the sum of squares H, and that the residual of
/// the fit is the error δ of Table 4 (Ödeen 1993, paper D, eqs. 10, 11 and 12).
#[test]
fn parameters_make_the_sum_of_squares_least_and_the_error_is_its_root() {
    let records = records(&Maxwell::new(4e6).unwrap());
    let tests: Vec<RodTest> = records
        .iter()
        .map(|data| RodTest::new(data.clone()).unwrap())
        .collect();
    let fit = Fit::of(Maxwell::new(1e6).unwrap())
        .with_cell(CELL)
        .to(&tests)
        .unwrap();
    let estimates = fit.identifiability(Noise::FromResidual).unwrap().estimates;
    // standard errors of the values, from those of the logarithms
    let [(modulus, of_modulus), (viscosity, of_viscosity)] = [0, 1].map(|index| {
        let estimate = &estimates[index];
        (estimate.value, estimate.value * estimate.standard_error)
    });
    let at = |modulus: f64, viscosity: f64| {
        criterion(&records, modulus, &Maxwell::new(viscosity).unwrap())
    };
    let (least, count) = at(modulus, viscosity);
    let delta = (least / count).sqrt() / V0;
    // tolerance: both compute the same response, up to the rounding of some hundred steps relative
    // to a residual of 2e-3
    assert!(
        (delta / fit.relative_error() - 1.0).abs() < 1e-9,
        "{delta} {}",
        fit.relative_error()
    );
    // between the noise of the response, 2e-3, and its sum of squares with the doubled noise of the
    // excitation at each of up to eight arrivals at the free end of the short rod: √(1 + 8 · 4)
    assert!((2e-3..2e-3 * 33f64.sqrt()).contains(&delta), "{delta}");
    // distance of the end of the search from the vertex of a parabola through three points a
    // twentieth of a standard error apart; tolerance: the search ends where a step would reduce H
    // by less than 1e-10 of itself, which is about 1e-4 standard errors for some hundred samples
    let part = 0.05;
    for step in [(part * of_modulus, 0.0), (0.0, part * of_viscosity)] {
        let side = |sign: f64| at(modulus + sign * step.0, viscosity + sign * step.1).0;
        let (before, after) = (side(-1.0), side(1.0));
        assert!(before > least && after > least, "{before} {least} {after}");
        let bottom = part * 0.5 * (before - after) / (before - 2.0 * least + after);
        assert!(bottom.abs() < 1e-3, "{bottom} standard errors");
    }
}

/// Compares the gradient away from the minimum, 2 Σ (∂v/∂p)ᵀ (v - measured) (Ödeen 1993, paper D,
/// eq. 13), with central differences of eq. 12.
#[test]
fn gradient_is_that_of_the_sum_of_squares() {
    let records = records(&MaxwellNorton::new(2.0, 4e13).unwrap());
    let at = [2.7e9, 2.1, 5e13];
    let law = |p: &[f64; 3]| MaxwellNorton::new(p[1], p[2]).unwrap();
    let mut gradient = [0.0; 3];
    for data in &records {
        let n = RodTest::new(data.clone()).unwrap().response().len();
        let response = simulated(data, at[0], &law(&at), n);
        let [by_modulus, by_exponent, by_rate] = [
            &response.by_log_modulus,
            &response.by_parameter[0],
            &response.by_parameter[1],
        ]
        .map(|column| -> f64 {
            column
                .iter()
                .zip(response.velocity.iter().zip(&data.response))
                .map(|(slope, (simulated, measured))| 2.0 * slope * (simulated - measured))
                .sum()
        });
        // derivatives with respect to (E, κ, B) of the paper from those with respect to (ln E, κ,
        // ln r) of the solver, by ln r = κ ln σ_ref - ln B
        let reference = law(&at).reference_stress().ln();
        gradient[0] += by_modulus / at[0];
        gradient[1] += by_exponent + reference * by_rate;
        gradient[2] -= by_rate / at[2];
    }
    for index in 0..3 {
        let side = |sign: f64| {
            let mut p = at;
            p[index] *= 1.0 + sign * 1e-4;
            criterion(&records, p[0], &law(&p)).0
        };
        let difference = (side(1.0) - side(-1.0)) / (2e-4 * at[index]);
        // tolerance: the relative error of the differences is (1e-4)² times a third derivative of
        // some hundreds for E and up to (κ ln σ_ref)² = 1e3 for κ
        assert!(
            (difference / gradient[index] - 1.0).abs() < 1e-4,
            "{index}: {difference} {}",
            gradient[index]
        );
    }
}

/// Checks that the pattern is |v_e - v_r| or v_e - v_r, divided by V0 (Ödeen 1993, paper D, eq. 9).
#[test]
fn pattern_is_the_difference_of_the_two_velocities() {
    let [data, _] = records(&Maxwell::new(4e6).unwrap());
    let test = [RodTest::new(data.clone()).unwrap()];
    let laws = [Candidate::of(Law::Maxwell)];
    for (kind, of) in [
        (Pattern::Absolute, f64::abs as fn(f64) -> f64),
        (Pattern::Signed, |difference| difference),
    ] {
        let samples = StandardSamples::of(&laws, &test, 2, kind).unwrap();
        let pattern = samples.measured(&test);
        assert_eq!(pattern.len(), test[0].response().len());
        assert!(samples.patterns.iter().all(|p| p.len() == pattern.len()));
        for (found, (excitation, response)) in pattern
            .iter()
            .zip(data.excitation.iter().zip(&data.response))
        {
            assert!((found - of(excitation - response) / V0).abs() < 1e-15); // two roundings
        }
    }
}
