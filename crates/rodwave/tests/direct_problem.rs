//! The direct problem of paper D against closed forms, the frequency domain, an independent second solver, its own
//! convergence, energy, and finite differences.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::float_cmp,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a failing test should say so at once, and exact zeros are compared exactly"
)]

use num_complex::Complex64;
use proptest::prelude::*;
use realfft::RealFftPlanner;
use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::inelastic::{
    Elastic, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};
use rodwave::lumped::LumpedRod;
use rodwave::{DirectProblem, InelasticRod, RodwaveError};

/// A smooth pulse known at every time: the shape of a struck rod's excitation without its corner.
struct Pulse {
    peak: f64,
}

impl Pulse {
    const CENTRE: f64 = 0.25e-3;
    const WIDTH: f64 = 50e-6;
}

impl VelocityHistory for Pulse {
    fn at(&self, time: f64) -> f64 {
        self.peak * (-((time - Self::CENTRE) / Self::WIDTH).powi(2)).exp()
    }

    fn slope(&self, time: f64) -> f64 {
        -2.0 * (time - Self::CENTRE) / Self::WIDTH.powi(2) * self.at(time)
    }

    fn end(&self) -> f64 {
        1.0
    }
}

/// A velocity that jumps at time 0 and stays.
struct Jump(f64);

impl VelocityHistory for Jump {
    fn at(&self, _time: f64) -> f64 {
        self.0
    }

    fn slope(&self, _time: f64) -> f64 {
        0.0
    }

    fn end(&self) -> f64 {
        1.0
    }
}

const PULSE: Pulse = Pulse { peak: 9.0 };

fn rod<L: InelasticLaw>(law: L) -> InelasticRod<L> {
    InelasticRod::new(0.39, 910.0, 2.58e9, law).unwrap()
}

fn times(end: f64, count: u32) -> Vec<f64> {
    (0..count)
        .map(|k| f64::from(k) * end / f64::from(count - 1))
        .collect()
}

fn respond<L: InelasticLaw>(law: L, cells: usize, times: &[f64]) -> Vec<f64> {
    DirectProblem::new(rod(law), cells)
        .unwrap()
        .free_end_velocity(&PULSE, times)
        .unwrap()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn elastic_rod_is_the_sum_of_its_reflections() {
    let times = times(1.9e-3, 400);
    let transit = rod(Elastic).transit_time();
    // v_r = 2 [v_e(t - T) - v_e(t - 3T) + v_e(t - 5T) - ...]
    let expected: Vec<f64> = times
        .iter()
        .map(|t| {
            (0_i32..6)
                .map(|n| {
                    let sign = if n % 2 == 0 { 2.0 } else { -2.0 };
                    sign * PULSE.at(t - f64::from(2 * n + 1) * transit)
                })
                .sum()
        })
        .collect();
    // the shift is exact: what remains is the quintic interpolation in time, 1e-9 of the peak at 200 cells
    let found = respond(Elastic, 200, &times);
    assert!(largest_difference(&found, &expected) < 1e-8 * PULSE.peak);
}

/// Stress of the front on arrival at the free end, in a rod whose end is set in motion at once.
fn front_on_arrival<L: InelasticLaw>(law: &L, velocity: f64) -> f64 {
    let arrival = |cells: usize| {
        let problem = DirectProblem::new(rod(law.clone()), cells).unwrap();
        let mut march = problem.march(velocity);
        for _ in 0..cells {
            march.advance(velocity);
        }
        // the free end doubles the incident velocity
        0.5 * march.free_end_velocity() * problem.rod().specific_impedance()
    };
    // behind a jump the splitting is of first order: one extrapolation makes it second
    2.0 * arrival(2000) - arrival(1000)
}

#[test]
fn fronts_decay_as_the_closed_forms() {
    // Behind a jump d[σ]/dt = -(1/2) E F([σ]), so [σ] follows the law's own relaxation for half the time of travel.
    // After the extrapolation the error is of order (dt/τ)², 1e-7.
    let (modulus, density) = (2.58e9, 910.0);
    let speed = rod(Elastic).wave_speed();
    let jump = density * speed * 9.0;
    let half_time = 0.5 * rod(Elastic).transit_time();

    let viscosity = 0.9e6;
    let found = front_on_arrival(&Maxwell::new(viscosity).unwrap(), 9.0);
    let expected = jump * (-modulus * half_time / viscosity).exp();
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");

    let (exponent, coefficient) = (2.108_f64, 3e13);
    let found = front_on_arrival(&MaxwellNorton::new(exponent, coefficient).unwrap(), 9.0);
    let n = exponent - 1.0;
    let expected =
        jump * (1.0 + n * modulus * half_time / coefficient * jump.powf(n)).powf(-1.0 / n);
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    // and the decay is no formality
    assert!(expected < 0.85 * jump);
}

/// v_r = v_e/cosh(γL) with γ² = ρ s² (1/E + 1/(ηs)) on the line s = a + iω (numerical Laplace transform).
fn linear_response_in_the_frequency_domain(viscosity: f64, step: f64, count: usize) -> Vec<f64> {
    let rod = rod(Maxwell::new(viscosity).unwrap());
    let period = step * f64::from(u32::try_from(count).unwrap());
    // e^{-a T} = 1e-10 is the error of the periodic continuation; rounding grows to 1e-16 e^{a t} in the first half only
    let damping = 10.0 * std::f64::consts::LN_10 / period;
    let mut planner = RealFftPlanner::<f64>::new();
    let forward = planner.plan_fft_forward(count);
    let mut input: Vec<f64> = (0..count)
        .map(|k| {
            let t = step * f64::from(u32::try_from(k).unwrap());
            PULSE.at(t) * (-damping * t).exp()
        })
        .collect();
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut input, &mut spectrum).unwrap();
    for (k, line) in spectrum.iter_mut().enumerate() {
        let omega = std::f64::consts::TAU * f64::from(u32::try_from(k).unwrap()) / period;
        let s = Complex64::new(damping, omega);
        let gamma = (s * s * rod.density() * (1.0 / rod.modulus() + 1.0 / (viscosity * s))).sqrt();
        *line /= (gamma * rod.length()).cosh();
        if k == 0 || 2 * k == count {
            line.im = 0.0;
        }
    }
    let inverse = planner.plan_fft_inverse(count);
    let mut output = inverse.make_output_vec();
    inverse.process(&mut spectrum, &mut output).unwrap();
    output
        .iter()
        .enumerate()
        .map(|(k, v)| {
            let k = f64::from(u32::try_from(k).unwrap());
            v / f64::from(u32::try_from(count).unwrap()) * (damping * step * k).exp()
        })
        .collect()
}

#[test]
fn maxwell_rod_agrees_with_the_frequency_domain() {
    let viscosity = 1.5e6;
    let step = 1e-6;
    let expected = linear_response_in_the_frequency_domain(viscosity, step, 8192);
    let times: Vec<f64> = (0..2500_u32).map(|k| f64::from(k) * step).collect();
    let found = respond(Maxwell::new(viscosity).unwrap(), 800, &times);
    // second order: 800 cells give 3e-6 of the peak here (next test measures the order)
    let difference = largest_difference(&found, &expected[..2500]) / PULSE.peak;
    assert!(difference < 1e-5, "{difference}");
}

fn measured_order<L: InelasticLaw>(law: &L) -> f64 {
    let times = times(1.9e-3, 300);
    let [coarse, middle, fine] = [100, 200, 400].map(|cells| respond(law.clone(), cells, &times));
    (largest_difference(&coarse, &middle) / largest_difference(&middle, &fine)).log2()
}

#[test]
fn the_scheme_is_of_second_order() {
    // the fully asymptotic value is 2; at 100 cells the next term still shows
    for order in [
        measured_order(&Maxwell::new(0.9e6).unwrap()),
        measured_order(&MaxwellNorton::new(2.108, 3e13).unwrap()),
        measured_order(&MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap()),
    ] {
        assert!((order - 2.0).abs() < 0.1, "{order}");
    }
}

fn agrees_with_the_lumped_chain<L: InelasticLaw>(law: &L) {
    let times = times(1.9e-3, 300);
    let found = respond(law.clone(), 800, &times);
    // the chain is refined once and extrapolated, which removes its leading (dx)² error
    let chain = |cells| {
        LumpedRod::new(&rod(law.clone()), cells, 0.5)
            .unwrap()
            .free_end_velocity(&PULSE, &times)
            .unwrap()
    };
    let expected: Vec<f64> = chain(400)
        .iter()
        .zip(chain(800))
        .map(|(coarse, fine)| fine + (fine - coarse) / 3.0)
        .collect();
    // both schemes leave about 1e-5 at this resolution
    let difference = largest_difference(&found, &expected) / PULSE.peak;
    assert!(difference < 3e-5, "{law:?}: {difference}");
}

#[test]
fn two_solvers_that_share_nothing_agree() {
    agrees_with_the_lumped_chain(&Elastic);
    agrees_with_the_lumped_chain(&Maxwell::new(0.9e6).unwrap());
    agrees_with_the_lumped_chain(&MaxwellNorton::new(2.108, 3e13).unwrap());
    agrees_with_the_lumped_chain(&MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap());
}

fn sensitivities_agree_with_differences<L: InelasticLaw>(law: &L) {
    const H: f64 = 1e-4;
    let times = times(1.9e-3, 200);
    // the excitation enters through its samples, as in an identification
    let samples: Vec<f64> = (0..120_u8)
        .map(|k| PULSE.at(f64::from(k) / 51_200.0))
        .collect();
    let excitation = SampledHistory::new(&samples, 51_200.0).unwrap();
    let run = |modulus: f64, law: L| {
        let rod = InelasticRod::new(0.39, 910.0, modulus, law).unwrap();
        DirectProblem::new(rod, 300)
            .unwrap()
            .free_end_velocity(&excitation, &times)
            .unwrap()
    };
    let response = DirectProblem::new(rod(law.clone()), 300)
        .unwrap()
        .free_end_velocity_with_sensitivities(&excitation, &times)
        .unwrap();
    assert!(largest_difference(&response.velocity, &run(2.58e9, law.clone())) < 1e-13);
    let compare = |name: &str, exact: &[f64], plus: Vec<f64>, minus: Vec<f64>| {
        let differences: Vec<f64> = plus
            .iter()
            .zip(&minus)
            .map(|(p, m)| (p - m) / (2.0 * H))
            .collect();
        let scale = differences.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        // central differences err by H²/6 times the third derivative; for ln E that is (ωt/2)³ H² of the pulse, 1e-4 of
        // the derivative after five reflections, and the cubic interpolation of the samples adds as much to the slope
        let error = largest_difference(exact, &differences) / scale;
        assert!(error < 5e-4, "{law:?}, {name}: {error}");
        assert!(scale > 0.0, "{law:?}, {name} has no effect");
    };
    compare(
        "ln modulus",
        &response.by_log_modulus,
        run(2.58e9 * H.exp(), law.clone()),
        run(2.58e9 * (-H).exp(), law.clone()),
    );
    for (index, name) in L::PARAMETERS.iter().enumerate() {
        let moved = |h: f64| {
            let mut parameters = law.parameters();
            parameters[index] += h;
            run(2.58e9, law.with_parameters(&parameters).unwrap())
        };
        compare(name, &response.by_parameter[index], moved(H), moved(-H));
    }
}

#[test]
fn tangent_linear_model_agrees_with_finite_differences() {
    sensitivities_agree_with_differences(&Elastic);
    sensitivities_agree_with_differences(&Maxwell::new(1.5e6).unwrap());
    sensitivities_agree_with_differences(&MaxwellNorton::new(2.108, 4e13).unwrap());
    sensitivities_agree_with_differences(&MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap());
}

fn energy_is_balanced<L: InelasticLaw>(law: L, length: f64, modulus: f64, velocities: &[f64]) {
    let rod = InelasticRod::new(length, 1200.0, modulus, law).unwrap();
    let mut march = DirectProblem::new(rod, 40).unwrap().march(velocities[0]);
    let mut before = march.energy();
    let mut scale = 1e-300_f64;
    for velocity in velocities.iter().cycle().take(400) {
        march.advance(*velocity);
        let now = march.energy();
        // rounding goes with the energy that has passed through the rod, all of which an elastic one may have given back
        scale = scale.max(now.supplied.abs() + now.stored + now.dissipated);
        let residual = (now.supplied - now.stored - now.dissipated).abs() / scale;
        assert!(residual < 1e-11, "{residual}: {now:?}");
        assert!(now.dissipated >= before.dissipated, "{before:?} {now:?}");
        before = now;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever the law, the rod and the (arbitrarily rough) excitation: energy is never created.
    #[test]
    fn energy_is_never_created(
        velocities in prop::collection::vec(-30.0..30.0_f64, 2..40),
        length in 0.05..2.0_f64,
        log_modulus in 18.0..26.0_f64,
        exponent in 0.6..4.0_f64,
        sharpness in -2.0..4.0_f64,
        log_rate in -6.0..8.0_f64,
    ) {
        let modulus = log_modulus.exp();
        let rate = log_rate.exp();
        energy_is_balanced(Elastic, length, modulus, &velocities);
        energy_is_balanced(
            Maxwell::from_reference_rate(rate, 10e6).unwrap(), length, modulus, &velocities);
        energy_is_balanced(
            MaxwellNorton::from_reference_rate(exponent, rate, 10e6).unwrap(), length, modulus, &velocities);
        energy_is_balanced(
            MaxwellGurevichRabinovich::from_reference_rate(sharpness, rate, 10e6).unwrap(),
            length, modulus, &velocities);
    }
}

#[test]
fn the_rod_is_at_rest_until_the_front_arrives() {
    let law = MaxwellNorton::new(2.108, 7e13).unwrap();
    let problem = DirectProblem::new(rod(law), 100).unwrap();
    let transit = problem.rod().transit_time();
    let times = [0.0, 0.5 * transit, 0.96 * transit, 1.04 * transit];
    let v = problem.free_end_velocity(&Jump(5.0), &times).unwrap();
    assert_eq!(&v[..3], &[0.0; 3]);
    assert!(v[3] > 5.0);
}

#[test]
fn bad_requests_are_refused_with_the_quantity_and_the_value() {
    let rod = || rod(Maxwell::new(1e6).unwrap());
    assert_eq!(
        DirectProblem::new(rod(), 3).unwrap_err().to_string(),
        "number of cells is 3, expected from 8 to 2^27"
    );
    assert_eq!(
        InelasticRod::new(0.4, -910.0, 2.5e9, Elastic)
            .unwrap_err()
            .to_string(),
        "density [kg/m^3] is -910, expected a finite value above 0"
    );
    let problem = DirectProblem::new(rod(), 50).unwrap();
    let excitation = SampledHistory::new(&[0.0; 52], 51_200.0).unwrap();
    assert!(matches!(
        problem.free_end_velocity(&excitation, &[2e-3]).unwrap_err(),
        RodwaveError::ExcitationTooShort { needed, found } if needed > found
    ));
    assert_eq!(
        problem
            .free_end_velocity(&excitation, &[f64::NAN])
            .unwrap_err()
            .to_string(),
        "time of the response [s] is NaN, expected a finite value not below 0"
    );
}
