//! Comparison of rods with a nonlinear branch and a linear part with other solvers, and tests of
//! their derivatives.

use rodwave::InelasticRod;
use rodwave::band_limited::SampledHistory;
use rodwave::inelastic::{MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::lumped::LumpedRod;
use testbed::struck_rod::pulse;

use num_complex::Complex64;

use super::*;
use crate::law::Scale;
use crate::linear::{ConstantQ, LinearModel, MaxwellBranches};
use crate::special_case::Branch;

const RATE: f64 = 51_200.0;
const LENGTH: f64 = 0.391;
const DENSITY: f64 = 1140.0;
const MODULUS: f64 = 3.2e9;

fn norton() -> MaxwellNorton {
    MaxwellNorton::from_reference_rate(1.8, 20.0, 10e6).unwrap()
}

fn excitation() -> Vec<f64> {
    pulse(140, 35.0, 6.0)
}

fn times() -> Vec<f64> {
    (0..130).map(|k| f64::from(k) / RATE).collect()
}

/// Calls `take` with a rod driven by [`excitation`], on cells of length `cell` \[m\].
fn driven<T>(cell: f64, take: impl FnOnce(&DrivenRod<'_>) -> T) -> T {
    let samples = excitation();
    let history = SampledHistory::new(&samples, RATE).unwrap();
    let times = times();
    take(&DrivenRod {
        length: LENGTH,
        density: DENSITY,
        sampling_rate_hz: RATE,
        samples: &samples,
        excitation: &history,
        times: &times,
        cell,
        temperature: None,
        lateral_inertia: 0.0,
    })
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |top, (a, b)| f64::max(top, (a - b).abs()))
}

/// Compares with the chain of masses, which integrates the rate of the law, without exact
/// relaxation and without characteristics.
#[test]
fn the_response_is_that_of_the_lumped_chain() {
    let model = BranchedRod::standard_solid(norton(), "solid");
    // a third of the modulus in the nonlinear branch
    let parameters = [MODULUS.ln(), 0.5_f64.ln(), 1.8, 20.0_f64.ln()];
    let found = driven(2e-3, |rod| model.response(rod, &parameters)).unwrap();
    let rod = InelasticRod::new(LENGTH, DENSITY, MODULUS, norton()).unwrap();
    let history = SampledHistory::new(&excitation(), RATE).unwrap();
    let by_the_chain = |rod: &InelasticRod<MaxwellNorton>| {
        let chain = LumpedRod::new(rod, 800, 0.5).unwrap();
        chain.free_end_velocity(&history, &times()).unwrap()
    };
    let solid = rod.clone().with_spring(2.0 / 3.0).unwrap();
    let with_spring = largest_difference(&found, &by_the_chain(&solid));
    assert!(with_spring < 0.01, "{with_spring} of 16 m/s");
    // the effect of the spring is at least fifty times as large
    let without = largest_difference(&found, &by_the_chain(&rod));
    assert!(without > 0.5, "{without}");
}

/// Checks the linear limit: with an exponent of 1 the solid can be solved in the Laplace domain.
#[test]
fn its_linear_limit_is_the_zener_rod_of_the_laplace_domain() {
    let series = PronySeries {
        modulus: MODULUS,
        spring: 0.8,
        branches: vec![Branch {
            share: 0.2,
            time: 6e-5,
        }],
    };
    let model = BranchedRod::standard_solid(norton(), "solid");
    let case = model.special_case(&series).unwrap();
    assert_eq!(case.limit, "with kappa = 1");
    let zener = LinearModel::new(MaxwellBranches::zener());
    let of_zener = [MODULUS.ln(), 0.25_f64.ln(), 6e-5_f64.ln()];
    let [found, expected] = driven(2e-3, |rod| {
        let linear = zener.response(rod, &of_zener).unwrap();
        [model.response(rod, &case.parameters).unwrap(), linear]
    });
    let difference = largest_difference(&found, &expected);
    assert!(difference < 0.01, "{difference} of 16 m/s");
    let elastic = model.special_case(&PronySeries::elastic(MODULUS)).unwrap();
    assert_eq!(elastic.limit, "without damping");
    // a series with two branches is not one of its limits
    let mut two = series;
    two.branches.push(Branch {
        share: 0.1,
        time: 1e-3,
    });
    assert!(model.special_case(&two).is_none());
}

/// Compares with central differences over ±1e-5; tolerance: with the high frequencies of a front
/// they are accurate only to 1e-4 of the largest derivative.
#[test]
fn derivatives_are_those_of_differences() {
    fn check<L: IdentifiableLaw>(model: &BranchedRod<L>, parameters: &[f64]) {
        driven(2e-3, |rod| {
            let linearised = model.linearised_response(rod, parameters).unwrap();
            let plain = model.response(rod, parameters).unwrap();
            // tolerance: rounding, because both responses come from the same computation
            assert!(largest_difference(&linearised.velocity, &plain) < 1e-9);
            assert_eq!(linearised.by_parameter.len(), parameters.len());
            let names = model.parameter_names();
            for (index, by) in linearised.by_parameter.iter().enumerate() {
                let at = |sign: f64| {
                    let mut moved = parameters.to_vec();
                    moved[index] += sign * 1e-5;
                    model.response(rod, &moved).unwrap()
                };
                let ends = at(1.0).into_iter().zip(at(-1.0));
                let differences: Vec<f64> = ends.map(|(a, b)| (a - b) / 2e-5).collect();
                let largest = differences
                    .iter()
                    .fold(0.0, |top, d| f64::max(top, d.abs()));
                let off = largest_difference(by, &differences);
                assert!(largest > 1e-3, "{} has no effect", names[index]);
                assert!(off < 1e-4 * largest, "{}: {off} of {largest}", names[index]);
            }
        });
    }
    let ln = f64::ln;
    let solid = BranchedRod::standard_solid(norton(), "solid");
    check(&solid, &[ln(MODULUS), ln(0.5), 1.8, ln(20.0)]);
    let gurevich = MaxwellGurevichRabinovich::from_reference_rate(1.2, 20.0, 10e6).unwrap();
    let beside = BranchedRod::beside_maxwell(gurevich, "two branches");
    check(&beside, &[ln(MODULUS), ln(2.0), ln(4e-5), 1.2, ln(20.0)]);
    let three = BranchedRod::standard_solid(norton(), "three").with_linear_branch();
    check(
        &three,
        &[ln(MODULUS), ln(0.2), ln(0.5), ln(4e-5), 1.8, ln(20.0)],
    );
    let flat = BranchedRod::beside_flat_loss(norton(), "flat");
    check(&flat, &[ln(MODULUS), ln(0.5), ln(0.05), 1.8, ln(20.0)]);
}

/// Compares the modulus of the branches of a flat loss factor with the power law that they
/// represent: both agree to 1 % from 0.1 to 30 kHz. Without the correction of the first and the
/// last branch the loss factor would be 5 % too small.
#[test]
fn a_flat_loss_factor_is_flat() {
    for loss_factor in [1e-3, 0.02, 0.1, 0.3] {
        let composition = Neighbours::FlatLoss
            .at(&[-40.0, f64::ln(loss_factor)])
            .unwrap();
        let modulus = |frequency: f64| -> Complex64 {
            let s = Complex64::new(0.0, std::f64::consts::TAU * frequency);
            let branches = composition.linear.iter();
            let branches: Complex64 = branches
                .map(|branch| branch.share * s * branch.time / (1.0 + s * branch.time))
                .sum();
            composition.spring + branches
        };
        let shares: f64 = composition.linear.iter().map(|branch| branch.share).sum();
        assert!((composition.spring + shares - 1.0).abs() < 1e-12);
        let exponent = std::f64::consts::FRAC_2_PI * f64::atan(loss_factor);
        let middle = modulus(2e3).norm();
        for step in 0..=40 {
            let frequency = 100.0 * 300_f64.powf(f64::from(step) / 40.0);
            let found = modulus(frequency);
            let ratio = found.im / found.re / loss_factor;
            assert!((ratio - 1.0).abs() < 0.01, "{frequency} {ratio}");
            let expected = middle * (frequency / 2e3).powf(exponent);
            assert!((found.norm() / expected - 1.0).abs() < 0.01, "{frequency}");
        }
    }
}

/// Checks the linear limit: with a negligible nonlinear branch the response is that of the
/// constant-Q law, which is solved in the Laplace domain and has no branches.
#[test]
fn its_linear_limit_is_the_rod_of_constant_q() {
    let loss_factor = 0.06_f64;
    let model = BranchedRod::beside_flat_loss(norton(), "flat");
    let at_4_khz = {
        let composition = Neighbours::FlatLoss.at(&[-14.0, loss_factor.ln()]).unwrap();
        let s = Complex64::new(0.0, std::f64::consts::TAU * 4e3);
        let branches = composition.linear.iter();
        let branches: Complex64 = branches
            .map(|branch| branch.share * s * branch.time / (1.0 + s * branch.time))
            .sum();
        (composition.spring + branches).norm()
    };
    let theta = [MODULUS.ln(), -14.0, loss_factor.ln(), 1.8, 20.0_f64.ln()];
    let constant_q = LinearModel::new(ConstantQ::default());
    let of_q = [(MODULUS * at_4_khz).ln(), loss_factor.ln()];
    let [found, expected, without] = driven(2e-3, |rod| {
        [
            model.response(rod, &theta).unwrap(),
            constant_q.response(rod, &of_q).unwrap(),
            constant_q.response(rod, &[of_q[0], -9.0]).unwrap(),
        ]
    });
    let difference = largest_difference(&found, &expected);
    assert!(difference < 0.015, "{difference} of 16 m/s");
    // the effect of the loss is a hundred times as large
    assert!(largest_difference(&found, &without) > 1.5);
}

/// Checks the gradients of the stated quantities by differences, the sum of the shares, and that
/// the counts agree.
#[test]
fn stated_quantities_have_their_gradients() {
    let flat = BranchedRod::beside_flat_loss(norton(), "flat");
    let parameters = [MODULUS.ln(), -0.7, -3.0, 1.8, 3.0];
    let stated = flat.stated(&parameters);
    let names: Vec<&str> = stated.iter().map(|s| s.symbol).collect();
    assert_eq!(names, ["E", "w", "tan delta", "kappa", "F(10 MPa)", "B"]);
    has_gradients_of_differences(&flat, &parameters);
    let model = BranchedRod::standard_solid(norton(), "solid").with_linear_branch();
    let parameters = [
        MODULUS.ln(),
        0.2_f64.ln(),
        0.5_f64.ln(),
        4e-5_f64.ln(),
        1.8,
        3.0,
    ];
    let stated = model.stated(&parameters);
    let names: Vec<&str> = stated.iter().map(|s| s.symbol).collect();
    assert_eq!(
        names,
        ["E", "w_0", "w_1", "tau_1", "kappa", "F(10 MPa)", "B"]
    );
    assert!((stated[1].value - 1.0 / 1.7).abs() < 1e-12);
    assert!((stated[2].value - 0.2 / 1.7).abs() < 1e-12);
    has_gradients_of_differences(&model, &parameters);
    for model in [
        BranchedRod::standard_solid(norton(), "solid"),
        BranchedRod::beside_maxwell(norton(), "two branches"),
        BranchedRod::beside_maxwell(norton(), "three").with_linear_branch(),
        BranchedRod::beside_flat_loss(norton(), "flat"),
    ] {
        crate::model::check_counts(&model, MODULUS, 2e-3).unwrap();
        let damping = model.damping_parameter().unwrap();
        assert_eq!(model.parameter_names()[damping], "ln_reference_rate");
        let start = &RodModel::starts(&model, MODULUS, 2e-3)[0];
        let count = model.specimen_sensitivities(start).len();
        assert_eq!(count, start.len());
        assert!(model.response(&driven_rod_of_nothing(), start).is_none());
    }
}

fn has_gradients_of_differences(model: &BranchedRod<MaxwellNorton>, parameters: &[f64]) {
    for (place, quantity) in model.stated(parameters).iter().enumerate() {
        assert_eq!(quantity.gradient.len(), parameters.len());
        for (index, gradient) in quantity.gradient.iter().enumerate() {
            let at = |sign: f64| {
                let mut moved = parameters.to_vec();
                moved[index] += sign * 1e-5;
                let value = model.stated(&moved)[place].value;
                match quantity.scale {
                    Scale::Ratio => value.ln(),
                    Scale::Difference => value,
                }
            };
            let difference = (at(1.0) - at(-1.0)) / 2e-5;
            let name = quantity.name;
            assert!((gradient - difference).abs() < 1e-6, "{name} {index}");
        }
    }
}

/// A rod of length zero.
fn driven_rod_of_nothing() -> DrivenRod<'static> {
    static SAMPLES: [f64; 64] = [0.0; 64];
    let history = Box::leak(Box::new(SampledHistory::new(&SAMPLES, RATE).unwrap()));
    DrivenRod {
        length: 0.0,
        density: DENSITY,
        sampling_rate_hz: RATE,
        samples: &SAMPLES,
        excitation: history,
        times: &[],
        cell: 2e-3,
        temperature: None,
        lateral_inertia: 0.0,
    }
}

/// Compares derivatives with respect to samples of the excitation with differences of the response.
#[test]
fn derivatives_by_samples_are_those_of_differences() {
    let model = BranchedRod::standard_solid(norton(), "solid").with_linear_branch();
    let theta = [MODULUS.ln(), -0.7, 0.5_f64.ln(), -10.0, 1.8, 20.0_f64.ln()];
    let places: Vec<usize> = (0..120).step_by(7).collect();
    let (found, expected) = driven(4e-3, |rod| {
        let differences = crate::model::differences_by_samples(&model, rod, &theta, &places, 1e-4);
        (model.by_samples(rod, &theta, &places, 0.0), differences)
    });
    for (found, expected) in found.unwrap().iter().zip(&expected.unwrap()) {
        // tolerance: differences over 1e-4 of 8 m/s have a relative error of 5e-5 due to the
        // curvature
        assert!(largest_difference(found, expected) < 2e-4);
    }
}
