//! The direct problem of paper D: closed forms, the frequency domain, a second solver, its order, energy, sensitivities.

use num_complex::Complex64;
use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::inelastic::{
    Elastic, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};
use rodwave::lumped::LumpedRod;
use rodwave::synthesis::DampedSynthesis;
use rodwave::{DirectProblem, InelasticRod};

use testbed::claim::{Claim, Claims, Fallible, Found};
use testbed::difference::{largest, largest_difference};
use testbed::hold;

const LENGTH: f64 = 0.39;
const DENSITY: f64 = 910.0;
const MODULUS: f64 = 2.58e9;
const PEAK: f64 = 9.0;

/// A smooth pulse known at every time.
struct Pulse;

impl Pulse {
    const CENTRE: f64 = 0.25e-3;
    const WIDTH: f64 = 50e-6;

    /// Its Laplace transform, that of a whole Gaussian: before time 0 it has e^{-25}.
    fn transform(s: Complex64) -> Complex64 {
        let smooth = s * s * (0.25 * Self::WIDTH * Self::WIDTH);
        PEAK * Self::WIDTH * std::f64::consts::PI.sqrt() * (smooth - s * Self::CENTRE).exp()
    }
}

impl VelocityHistory for Pulse {
    fn at(&self, time: f64) -> f64 {
        PEAK * (-((time - Self::CENTRE) / Self::WIDTH).powi(2)).exp()
    }

    fn slope(&self, time: f64) -> f64 {
        -2.0 * (time - Self::CENTRE) / Self::WIDTH.powi(2) * self.at(time)
    }

    fn end(&self) -> f64 {
        1.0
    }
}

fn rod<L: InelasticLaw>(law: L) -> Fallible<InelasticRod<L>> {
    Ok(InelasticRod::new(LENGTH, DENSITY, MODULUS, law)?)
}

fn times(end: f64, count: u32) -> Vec<f64> {
    (0..count)
        .map(|k| f64::from(k) * end / f64::from(count - 1))
        .collect()
}

fn respond<L: InelasticLaw>(law: L, cells: usize, times: &[f64]) -> Fallible<Vec<f64>> {
    let problem = DirectProblem::new(rod(law)?, cells)?;
    Ok(problem.free_end_velocity(&Pulse, times)?)
}

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    elastic(&mut report);
    fronts(&mut report);
    frequency_domain(&mut report);
    for_law(
        &mut report,
        "Maxwell",
        Maxwell::new(0.9e6).map_err(Into::into),
    );
    for_law(
        &mut report,
        "Norton",
        MaxwellNorton::new(2.108, 3e13).map_err(Into::into),
    );
    let law = MaxwellGurevichRabinovich::new(3.5e6, 7.08e6);
    for_law(
        &mut report,
        "Gurevich and Rabinovich",
        law.map_err(Into::into),
    );
    hold!(report);
}

fn elastic(report: &mut Claims) {
    report.check(
        Claim::new(
            "elastic rod: free end against the sum of its reflections, by the peak",
            "d'Alembert: 2[v(t - T) - v(t - 3T) + ...]",
        )
        .within(
            1e-8,
            "interpolation in time at 200 cells; the shift is exact",
        ),
        || {
            let times = times(1.9e-3, 400);
            let transit = rod(Elastic)?.transit_time();
            let expected: Vec<f64> = times
                .iter()
                .map(|t| {
                    (0..6)
                        .map(|n| {
                            let sign = if n % 2 == 0 { 2.0 } else { -2.0 };
                            sign * Pulse.at(t - f64::from(2 * n + 1) * transit)
                        })
                        .sum()
                })
                .collect();
            Ok(largest_difference(&respond(Elastic, 200, &times)?, &expected) / PEAK)
        },
    );
    report.check(
        Claim::new(
            "elastic rod by the lumped chain, by the peak",
            "lumped chain, extrapolated from two grids",
        )
        .within(3e-5, "third order of either scheme"),
        || lumped_difference(&Elastic),
    );
}

/// Stress of the front on arrival at the free end of a rod whose other end is set in motion at once.
fn front_on_arrival<L: InelasticLaw>(law: &L) -> Found {
    let arrival = |cells: usize| -> Found {
        let problem = DirectProblem::new(rod(law.clone())?, cells)?;
        let mut march = problem.march(PEAK);
        for _ in 0..cells {
            march.advance(PEAK);
        }
        // the free end doubles the incident velocity
        Ok(0.5 * march.free_end_velocity() * problem.rod().specific_impedance())
    };
    // behind a jump the splitting is of first order: one extrapolation makes it second
    Ok(2.0 * arrival(2000)? - arrival(1000)?)
}

fn fronts(report: &mut Claims) {
    let speed = (MODULUS / DENSITY).sqrt();
    let jump = DENSITY * speed * PEAK;
    // behind a jump d[σ]/dt = -(1/2) E F([σ]): the law's own relaxation for half the time of travel
    let half_time = 0.5 * LENGTH / speed;
    let why = "second order of the extrapolated splitting";
    report.check(
        Claim::new(
            "front in a Maxwell rod after 0.39 m",
            "closed form e^(-x/2cτ)",
        )
        .expects(jump * (-MODULUS * half_time / 0.9e6).exp(), "Pa")
        .within_part(1e-6, why),
        || front_on_arrival(&Maxwell::new(0.9e6)?),
    );
    let (n, coefficient) = (1.108, 3e13);
    let a = n * MODULUS * half_time / coefficient * jump.powf(n);
    report.check(
        Claim::new(
            "front in a Norton rod after 0.39 m",
            "closed form, power of the jump",
        )
        .expects(jump * (1.0 + a).powf(-1.0 / n), "Pa")
        .within_part(1e-6, why),
        || front_on_arrival(&MaxwellNorton::new(2.108, coefficient)?),
    );
}

fn frequency_domain(report: &mut Claims) {
    report.check(
        Claim::new(
            "Maxwell rod: free end against v/cosh γL, by the peak",
            "Laplace transform on a line, inverted numerically",
        )
        .within(1e-5, "second order at 800 cells, 3e-6"),
        || {
            let (viscosity, step) = (1.5e6, 1e-6);
            let synthesis = DampedSynthesis::new(4e-3, step)?;
            let transform: Vec<Complex64> = synthesis
                .arguments()
                .map(|s| {
                    let compliance = 1.0 / MODULUS + 1.0 / (viscosity * s);
                    let gamma = (s * s * DENSITY * compliance).sqrt();
                    Pulse::transform(s) / (gamma * LENGTH).cosh()
                })
                .collect();
            let expected = synthesis.history(&transform)?;
            let times: Vec<f64> = (0..2000).map(|k| expected.time(k)).collect();
            let found = respond(Maxwell::new(viscosity)?, 800, &times)?;
            Ok(largest_difference(&found, &expected.samples[..2000]) / PEAK)
        },
    );
}

fn lumped_difference<L: InelasticLaw>(law: &L) -> Found {
    let times = times(1.9e-3, 300);
    let found = respond(law.clone(), 800, &times)?;
    let chain = |cells| -> Fallible<Vec<f64>> {
        let rod = rod(law.clone())?;
        Ok(LumpedRod::new(&rod, cells, 0.5)?.free_end_velocity(&Pulse, &times)?)
    };
    let (coarse, fine) = (chain(400)?, chain(800)?);
    let expected: Vec<f64> = coarse
        .iter()
        .zip(&fine)
        .map(|(coarse, fine)| fine + (fine - coarse) / 3.0)
        .collect();
    Ok(largest_difference(&found, &expected) / PEAK)
}

fn for_law<L: InelasticLaw>(report: &mut Claims, name: &str, law: Fallible<L>) {
    let law = match law {
        Ok(law) => law,
        Err(error) => return report.check(Claim::new(name, "its parameters"), || Err(error)),
    };
    let claim = |what: &str, source| Claim::new(format!("{name} rod: {what}"), source);
    report.check(
        claim(
            "order of convergence, 100 to 400 cells",
            "Strang splitting is of second order",
        )
        .expects(2.0, "1")
        .within(0.1, "the next term at 100 cells"),
        || {
            let times = times(1.9e-3, 300);
            let [coarse, middle, fine] =
                [100, 200, 400].map(|cells| respond(law.clone(), cells, &times));
            let middle = middle?;
            let errors = [
                largest_difference(&coarse?, &middle),
                largest_difference(&middle, &fine?),
            ];
            Ok((errors[0] / errors[1]).log2())
        },
    );
    report.check(
        claim(
            "free end by the lumped chain, by the peak",
            "lumped chain, extrapolated from two grids",
        )
        .within(3e-5, "1e-5 of either scheme at this resolution"),
        || lumped_difference(&law),
    );
    report.check(
        claim(
            "energy supplied, stored and dissipated, over a rough excitation",
            "balance of energy",
        )
        .within(1e-11, "rounding of 400 steps"),
        || {
            let mut march = DirectProblem::new(rod(law.clone())?, 40)?.march(PEAK);
            let (mut scale, mut residuals) = (0.0_f64, Vec::new());
            for step in 0..400 {
                march.advance(PEAK * (f64::from(step) * 0.7).sin());
                let now = march.energy();
                scale = scale.max(now.supplied.abs() + now.stored + now.dissipated);
                residuals.push((now.supplied - now.stored - now.dissipated) / scale);
            }
            Ok(largest(residuals))
        },
    );
    sensitivities(report, name, &law);
}

fn sensitivities<L: InelasticLaw>(report: &mut Claims, name: &str, law: &L) {
    const H: f64 = 1e-4;
    let times = times(1.9e-3, 200);
    let run = |modulus: f64, law: L| -> Fallible<Vec<f64>> {
        let rod = InelasticRod::new(LENGTH, DENSITY, modulus, law)?;
        Ok(DirectProblem::new(rod, 300)?.free_end_velocity(&excitation()?, &times)?)
    };
    let exact = || -> Fallible<_> {
        let problem = DirectProblem::new(rod(law.clone())?, 300)?;
        Ok(problem.free_end_velocity_with_sensitivities(&excitation()?, &times)?)
    };
    let error = |exact: &[f64], plus: &[f64], minus: &[f64]| {
        let differences: Vec<f64> = plus
            .iter()
            .zip(minus)
            .map(|(p, m)| (p - m) / (2.0 * H))
            .collect();
        largest_difference(exact, &differences) / largest(differences.iter().copied())
    };
    let why =
        "H²/6 of the third derivative, (ωt/2)³ for ln E, and the interpolation of the samples";
    report.check(
        Claim::new(
            format!("{name} rod: sensitivity of the free end to ln E"),
            "central differences of the solver",
        )
        .within(5e-4, why),
        || {
            let [plus, minus] = [H, -H].map(|h: f64| run(MODULUS * h.exp(), law.clone()));
            Ok(error(&exact()?.by_log_modulus, &plus?, &minus?))
        },
    );
    for (index, parameter) in L::PARAMETERS.iter().enumerate() {
        report.check(
            Claim::new(
                format!("{name} rod: sensitivity of the free end to {parameter}"),
                "central differences of the solver",
            )
            .within(5e-4, why),
            || {
                let moved = |h: f64| -> Fallible<Vec<f64>> {
                    let mut parameters = law.parameters();
                    parameters[index] += h;
                    run(MODULUS, law.with_parameters(&parameters)?)
                };
                Ok(error(
                    &exact()?.by_parameter[index],
                    &moved(H)?,
                    &moved(-H)?,
                ))
            },
        );
    }
}

/// The pulse through its samples, as in an identification.
fn excitation() -> Fallible<SampledHistory> {
    let samples: Vec<f64> = (0..120)
        .map(|k| Pulse.at(f64::from(k) / 51_200.0))
        .collect();
    Ok(SampledHistory::new(&samples, 51_200.0)?)
}
