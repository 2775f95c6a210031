//! Direct problem of paper D: closed forms, the frequency domain, a second solver, the order of the
//! scheme, sensitivities.

use num_complex::Complex64;
use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::inelastic::{
    Elastic, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};
use rodwave::lumped::LumpedRod;
use rodwave::synthesis::DampedSynthesis;
use rodwave::{DirectProblem, InelasticRod};
use testbed::claim::{Claims, Within};
use testbed::difference::{largest, largest_difference};
use testbed::hold;

use crate::bodies::Gaussian;

const LENGTH: f64 = 0.39;
const DENSITY: f64 = 910.0;
const MODULUS: f64 = 2.58e9;
const PEAK: f64 = 9.0;

const PULSE: Gaussian = Gaussian {
    peak: PEAK,
    centre: 0.25e-3,
    width: 50e-6,
};

/// Laplace transform of the pulse, with the part of the Gaussian before time 0, which is below
/// e^{-25} of the peak.
fn transform(s: Complex64) -> Complex64 {
    let smooth = s * s * (0.25 * PULSE.width * PULSE.width);
    PEAK * PULSE.width * std::f64::consts::PI.sqrt() * (smooth - s * PULSE.centre).exp()
}

fn rod<L: InelasticLaw>(law: L) -> InelasticRod<L> {
    InelasticRod::new(LENGTH, DENSITY, MODULUS, law).unwrap()
}

fn times(count: u32) -> Vec<f64> {
    let step = 1.9e-3 / f64::from(count - 1);
    (0..count).map(|k| f64::from(k) * step).collect()
}

fn respond<L: InelasticLaw>(law: L, cells: usize, times: &[f64]) -> Vec<f64> {
    let problem = DirectProblem::new(rod(law), cells).unwrap();
    problem.free_end_velocity(&PULSE, times).unwrap()
}

fn norton() -> MaxwellNorton {
    MaxwellNorton::new(2.108, 3e13).unwrap()
}

fn gurevich() -> MaxwellGurevichRabinovich {
    MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap()
}

/// Computes a number for the elastic rod and for the three laws.
fn of_each_law(number: &impl Number) -> [f64; 4] {
    let maxwell = Maxwell::new(0.9e6).unwrap();
    [
        number.of(&Elastic),
        number.of(&maxwell),
        number.of(&norton()),
        number.of(&gurevich()),
    ]
}

/// Number that can be computed for any law.
trait Number {
    fn of<L: InelasticLaw>(&self, law: &L) -> f64;
}

/// Claims on the direct problem (Ödeen 1993, paper D, eqs. 1, 2, 5, 6, 7 and 8).
#[test]
fn claims_hold() {
    let mut report = Claims::default();
    report
        .by("d'Alembert: 2[v(t - T) - v(t - 3T) + ...]")
        .deviation(
            "elastic rod: free end against the sum of its reflections, relative to the peak",
            Within(
                1e-9,
                "interpolation in time at 200 cells; the shift is exact",
            ),
            Ok(reflections()),
        );
    fronts(&mut report);
    report
        .by("Laplace transform on a line, inverted numerically")
        .deviation(
            "Maxwell rod: free end against v/cosh γL, relative to the peak",
            Within(1e-6, "second order at 800 cells"),
            Ok(frequency_domain()),
        );
    report
        .by("lumped chain, extrapolated from two grids")
        .deviation(
            "free end by the lumped chain, elastic and the three laws, relative to the peak",
            Within(
                3e-5,
                "each of the two schemes has an error of 1e-5 at this resolution",
            ),
            Ok(largest(of_each_law(&LumpedChain))),
        );
    report.by("Strang splitting is of second order").deviation(
        "order of convergence from 100 to 400 cells minus 2, three laws",
        Within(0.02, "the next term of the error at 100 cells"),
        Ok(largest(of_each_law(&Order))),
    );
    report.by("central differences of the solver").deviation(
        "sensitivity of the free end to ln E, elastic and the three laws",
        Within(2e-5, "H²/6 times the third derivative, (ωt/2)³"),
        Ok(largest(of_each_law(&Sensitivity::ToModulus))),
    );
    report.deviation(
        "sensitivity of the free end to the parameters of the three laws",
        Within(1e-8, "H²/6 times the third derivative"),
        Ok(largest(of_each_law(&Sensitivity::ToParameters))),
    );
    hold!(report);
}

fn reflections() -> f64 {
    let times = times(400);
    let transit = rod(Elastic).transit_time();
    let at = |t: f64| -> f64 {
        let reflection =
            |n: i32| 2.0 * (-1_f64).powi(n) * PULSE.at(t - f64::from(2 * n + 1) * transit);
        (0..6).map(reflection).sum()
    };
    let expected: Vec<f64> = times.iter().map(|t| at(*t)).collect();
    largest_difference(&respond(Elastic, 200, &times), &expected) / PEAK
}

/// Stress of the front when it arrives at the free end of a rod whose other end is set in motion
/// suddenly.
fn front_on_arrival<L: InelasticLaw>(law: &L) -> f64 {
    let arrival = |cells: usize| {
        let problem = DirectProblem::new(rod(law.clone()), cells).unwrap();
        let mut march = problem.march(PEAK);
        for _ in 0..cells {
            march.advance(PEAK);
        }
        // the free end doubles the incident velocity
        0.5 * march.free_end_velocity() * problem.rod().specific_impedance()
    };
    // behind a jump the splitting is of first order; one extrapolation makes it second order
    2.0 * arrival(2000) - arrival(1000)
}

/// Claims the decay behind a jump, d[σ]/dt = -(1/2) E F([σ]): the relaxation of the law for half
/// the travel time.
fn fronts(report: &mut Claims) {
    let speed = (MODULUS / DENSITY).sqrt();
    let jump = DENSITY * speed * PEAK;
    let half_time = 0.5 * LENGTH / speed;
    let maxwell = jump * (-MODULUS * half_time / 0.9e6).exp();
    let n = 1.108;
    let a = n * MODULUS * half_time / 3e13 * jump.powf(n);
    let of_norton = jump * (1.0 + a).powf(-1.0 / n);
    // the decay must not be negligible
    assert!(maxwell < 0.85 * jump && of_norton < 0.85 * jump);
    report
        .by("closed forms e^(-x/2cτ) and (1 + na)^(-1/n)")
        .deviation(
            "front in a Maxwell and in a Norton rod after 0.39 m",
            Within(1e-6, "second order of the extrapolated splitting"),
            Ok(largest([
                front_on_arrival(&Maxwell::new(0.9e6).unwrap()) / maxwell - 1.0,
                front_on_arrival(&norton()) / of_norton - 1.0,
            ])),
        );
}

fn frequency_domain() -> f64 {
    let viscosity = 1.5e6;
    let synthesis = DampedSynthesis::new(4e-3, 1e-6).unwrap();
    let spectrum: Vec<Complex64> = synthesis
        .arguments()
        .map(|s| {
            let compliance = 1.0 / MODULUS + 1.0 / (viscosity * s);
            let gamma = (s * s * DENSITY * compliance).sqrt();
            transform(s) / (gamma * LENGTH).cosh()
        })
        .collect();
    let expected = synthesis.history(&spectrum).unwrap();
    let times: Vec<f64> = (0..2500).map(|k| expected.time(k)).collect();
    let found = respond(Maxwell::new(viscosity).unwrap(), 800, &times);
    largest_difference(&found, &expected.samples[..2500]) / PEAK
}

struct LumpedChain;

impl Number for LumpedChain {
    fn of<L: InelasticLaw>(&self, law: &L) -> f64 {
        let times = times(300);
        let chain = |cells| {
            let chain = LumpedRod::new(&rod(law.clone()), cells, 0.5).unwrap();
            chain.free_end_velocity(&PULSE, &times).unwrap()
        };
        let (coarse, fine) = (chain(400), chain(800));
        let pairs = coarse.iter().zip(&fine);
        let expected: Vec<f64> = pairs.map(|(c, f)| f + (f - c) / 3.0).collect();
        largest_difference(&respond(law.clone(), 800, &times), &expected) / PEAK
    }
}

/// Order of the error minus 2; an elastic rod has no error of this kind.
struct Order;

impl Number for Order {
    fn of<L: InelasticLaw>(&self, law: &L) -> f64 {
        if L::PARAMETERS.is_empty() {
            return 0.0;
        }
        let times = times(300);
        let [coarse, middle, fine] = [100, 200, 400].map(|n| respond(law.clone(), n, &times));
        (largest_difference(&coarse, &middle) / largest_difference(&middle, &fine)).log2() - 2.0
    }
}

/// Excitation given by its samples, as in an identification.
fn excitation() -> SampledHistory {
    let samples: Vec<f64> = (0..120)
        .map(|k| PULSE.at(f64::from(k) / 51_200.0))
        .collect();
    SampledHistory::new(&samples, 51_200.0).unwrap()
}

const H: f64 = 1e-4;

/// Error of a derivative of the response, compared with a central difference, relative to the
/// largest value.
fn derivative_error(exact: &[f64], run: impl Fn(f64) -> Vec<f64>) -> f64 {
    let (plus, minus) = (run(H), run(-H));
    let pairs = plus.iter().zip(&minus);
    let differences: Vec<f64> = pairs.map(|(p, m)| (p - m) / (2.0 * H)).collect();
    largest_difference(exact, &differences) / largest(differences.iter().copied())
}

fn sampled<L: InelasticLaw>(modulus: f64, law: L) -> Vec<f64> {
    let rod = InelasticRod::new(LENGTH, DENSITY, modulus, law).unwrap();
    let problem = DirectProblem::new(rod, 300).unwrap();
    problem
        .free_end_velocity(&excitation(), &times(200))
        .unwrap()
}

enum Sensitivity {
    ToModulus,
    ToParameters,
}

impl Number for Sensitivity {
    fn of<L: InelasticLaw>(&self, law: &L) -> f64 {
        let problem = DirectProblem::new(rod(law.clone()), 300).unwrap();
        let exact = problem
            .free_end_velocity_with_sensitivities(&excitation(), &times(200))
            .unwrap();
        let plain = sampled(MODULUS, law.clone());
        assert!(largest_difference(&exact.velocity, &plain) < 1e-13);
        if matches!(self, Self::ToModulus) {
            return derivative_error(&exact.by_log_modulus, |h| {
                sampled(MODULUS * h.exp(), law.clone())
            });
        }
        let by_parameter = exact.by_parameter.iter().enumerate();
        largest(by_parameter.map(|(index, exact)| {
            derivative_error(exact, |h| {
                let mut parameters = law.parameters();
                parameters[index] += h;
                sampled(MODULUS, law.with_parameters(&parameters).unwrap())
            })
        }))
    }
}
