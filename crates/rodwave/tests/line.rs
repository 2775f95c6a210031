//! Bodies in a line against closed forms, other solvers and their own balances.
#![allow(
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "in a test, a refusal where none is expected is a failure; counts are small"
)]

use num_complex::Complex64;
use proptest::prelude::*;
use rodwave::band_limited::SampledHistory;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::CrossSection;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{
    Elastic, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow,
    RelaxedStress,
};
use rodwave::line::{Body, Drive, End, Gauge, Line, LineHistory, Parameter, Segment};
use rodwave::medium::Medium;
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};
use rodwave::synthesis::DampedSynthesis;
use rodwave::{DirectProblem, InelasticRod, RodwaveError};

const AREA: f64 = 2e-4;

fn steel(length: f64, area: f64) -> Segment {
    Segment::elastic(length, area, 7780.0, 206e9).unwrap()
}

fn aluminium(length: f64, area: f64) -> Segment {
    Segment::elastic(length, area, 2700.0, 69e9).unwrap()
}

fn line(segments: impl IntoIterator<Item = Segment>) -> Line {
    Line::new([Body::new(segments).unwrap()]).unwrap()
}

/// A smooth pulse with a maximum of 1 at 50 µs, negligible at time 0.
fn pulse(time: f64) -> f64 {
    (-((time - 50e-6) / 10e-6).powi(2)).exp()
}

fn pushed(line: Line, force: f64) -> Line {
    line.with_left_end(End::Force(Drive::of(move |t| force * pulse(t))))
        .unwrap()
}

fn closes(history: &LineHistory) {
    let ledger = history.ledger;
    let energy = ledger.initial_energy + ledger.supplied.abs() + ledger.stored;
    // thousands of steps, each rounded relatively by 1e-16 or so
    assert!(
        ledger.energy_residual().abs() < 1e-11 * energy,
        "{ledger:?}"
    );
    assert!(ledger.dissipated >= 0.0 && ledger.radiated >= -1e-15 * energy);
    assert!(ledger.lost_in_contact >= 0.0);
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

/// d'Alembert: an elastic rod hands a pulse on without change, turns it at a free end, and again.
#[test]
fn elastic_pulse_travels_unchanged() {
    let segment = steel(1.0, AREA);
    let (z, c) = (segment.impedance(), segment.wave_speed());
    let cells = 250;
    let step = segment.transit_time() / f64::from(cells);
    // at the centre of a cell, where nothing has to be interpolated
    let position = 100.5 / f64::from(cells);
    let gauge = Gauge { body: 0, position };
    let history = pushed(line([segment]), 1000.0)
        .run(step * (1.0 + 1e-9), 4.0 / c, &[gauge])
        .unwrap();
    let incident = |t: f64| if t > 0.0 { 1000.0 * pulse(t) / z } else { 0.0 };
    for (k, (velocity, stress)) in history.gauges[0]
        .velocity
        .iter()
        .zip(&history.gauges[0].stress)
        .enumerate()
    {
        let time = k as f64 * history.grid.time_step;
        let right = incident(time - position / c) + incident(time - (position + 2.0) / c);
        let left = incident(time - (2.0 - position) / c) + incident(time - (4.0 - position) / c);
        // a thousand additions of numbers of the size of the pulse
        assert!((velocity - right - left).abs() < 1e-12 * 1000.0 / z, "{k}");
        assert!((stress * AREA + z * (right - left)).abs() < 1e-9, "{k}");
    }
    closes(&history);
    // a free rod keeps the impulse √π · 10 µs · 1000 N; the trapezoidal rule is exact for a Gaussian
    let impulse = std::f64::consts::PI.sqrt() * 10e-6 * 1000.0;
    assert!((history.ledger.momentum / impulse - 1.0).abs() < 1e-9);
}

/// Donnell: a step of the impedance reflects (z2 - z1)/(z2 + z1) of the force and transmits 2 z2/(z1 + z2).
#[test]
fn impedance_step_splits_the_pulse() {
    let (first, second) = (steel(1.0, AREA), aluminium(1.0, 1.7 * AREA));
    let (z1, z2) = (first.impedance(), second.impedance());
    let (c1, c2) = (first.wave_speed(), second.wave_speed());
    let gauges = [0.5, 1.5].map(|position| Gauge { body: 0, position });
    let history = pushed(line([first, second]), 1000.0)
        .with_right_end(End::Matched)
        .unwrap()
        .run(0.2e-6, 450e-6, &gauges)
        .unwrap();
    // the two wave speeds were changed by less than this to make whole numbers of cells, and the pulse is delayed by as much
    let change = largest(history.grid.speed_change.iter().copied());
    assert!(change < 2e-6, "{change}");
    let (reflected, transmitted) = ((z2 - z1) / (z2 + z1), 2.0 * z2 / (z1 + z2));
    for k in 0..history.gauges[0].stress.len() {
        let time = k as f64 * history.grid.time_step;
        let force = |at: usize, area: f64| -history.gauges[at].stress[k] * area;
        let once = 1000.0 * pulse(time - 0.5 / c1);
        let turned = 1000.0 * reflected * pulse(time - 1.5 / c1);
        // the free face turns it again
        let again = -1000.0 * reflected * pulse(time - 2.5 / c1);
        let passed = 1000.0 * transmitted * pulse(time - 1.0 / c1 - 0.5 / c2);
        let passed_again = -1000.0 * reflected * transmitted * pulse(time - 3.0 / c1 - 0.5 / c2);
        // speeds to 2e-6 over 300 µs are 0.6 ns, on a slope of 1/10 µs: 6e-5; the cubic in space 1e-7
        assert!((force(0, AREA) - once - turned - again).abs() < 0.1, "{k}");
        assert!(
            (force(1, 1.7 * AREA) - passed - passed_again).abs() < 0.1,
            "{k}"
        );
    }
    closes(&history);
}

/// A mass on the end of a rod is brought to twice the velocity of a step wave as 1 - e^{-zt/m}.
#[test]
fn mass_at_an_end_follows_its_exponential() {
    let error = |cells: f64| -> f64 {
        let segment = steel(1.0, AREA);
        let (z, transit) = (segment.impedance(), segment.transit_time());
        let mass = z * 20e-6;
        let history = line([segment])
            .with_left_end(End::Velocity(Drive::of(|_| 1.0)))
            .unwrap()
            .with_right_end(End::Mass(mass))
            .unwrap()
            .run(transit / cells * (1.0 + 1e-9), 2.5 * transit, &[])
            .unwrap();
        closes(&history);
        let end = &history.ends[1].velocity;
        let step = history.grid.time_step;
        largest(end.iter().enumerate().map(|(k, velocity)| {
            let time = (k as f64 + 0.5) * step - transit;
            let exact = if time > 0.0 {
                2.0 * (1.0 - (-z * time / mass).exp())
            } else {
                0.0
            };
            velocity - exact
        }))
    };
    // velocities at half steps are means of whole ones: (z dt/m)²/8 of a final velocity of 2
    let (coarse, fine) = (error(200.0), error(400.0));
    let ratio_of_step = steel(1.0, AREA).transit_time() / 200.0 / 20e-6;
    assert!(coarse < 0.3 * ratio_of_step.powi(2), "{coarse}");
    assert!((3.5..4.5).contains(&(coarse / fine)), "{coarse} {fine}");
}

/// de Saint-Venant: a rod that strikes one of its own kind, twice as long, keeps contact for 2 L/c with force zV/2, and stops.
#[test]
fn equal_impedances_exchange_their_motion() {
    let (striker, rod) = (steel(0.25, AREA), steel(0.5, AREA));
    let (z, transit, mass) = (striker.impedance(), striker.transit_time(), striker.mass());
    let bodies = [
        Body::new([striker]).unwrap().moving_at(4.0).unwrap(),
        Body::new([rod]).unwrap(),
    ];
    let history = Line::new(bodies)
        .unwrap()
        .run(transit / 100.0 * (1.0 + 1e-9), 7.0 * transit, &[])
        .unwrap();
    for (k, force) in history.contacts[0].force.iter().enumerate() {
        let time = (k as f64 + 0.5) * history.grid.time_step;
        let expected = if time < 2.0 * transit { 2.0 * z } else { 0.0 };
        assert!((force - expected).abs() < 1e-9 * z, "{time}: {force}");
    }
    let momentum = history.ledger.momentum;
    assert!((momentum / (4.0 * mass) - 1.0).abs() < 1e-12);
    assert!(history.ledger.lost_in_contact < 1e-12 * history.ledger.initial_energy);
    closes(&history);
}

/// A striker of higher impedance pushes in steps: after m passages the force is zV/(1+r) times ((1-r)/(1+r))^m, and reopens not before.
#[test]
fn heavy_striker_pushes_in_steps() {
    let (striker, rod) = (steel(0.25, 3.0 * AREA), steel(4.0, AREA));
    let (z, transit) = (rod.impedance(), striker.transit_time());
    let r: f64 = 1.0 / 3.0;
    let bodies = [
        Body::new([striker]).unwrap().moving_at(4.0).unwrap(),
        Body::new([rod]).unwrap(),
    ];
    let history = Line::new(bodies)
        .unwrap()
        .run(transit / 40.0 * (1.0 + 1e-9), 20.0 * transit, &[])
        .unwrap();
    for (k, force) in history.contacts[0].force.iter().enumerate() {
        let passages = ((k as f64 + 0.5) * history.grid.time_step / (2.0 * transit)).floor();
        let expected = z * 4.0 / (1.0 + r) * ((1.0 - r) / (1.0 + r)).powf(passages);
        assert!(
            (force - expected).abs() < 1e-9 * z,
            "{k}: {force} {expected}"
        );
    }
}

/// A gap delays the contact, and closing it costs less energy the finer the grid.
#[test]
fn a_gap_closes_with_the_relative_velocity() {
    let lost = |step: f64| -> f64 {
        let bodies = [
            Body::new([steel(0.25, AREA)])
                .unwrap()
                .moving_at(4.0)
                .unwrap(),
            Body::new([aluminium(0.5, AREA)]).unwrap(),
        ];
        let history = Line::new(bodies)
            .unwrap()
            .with_gap(0, 0.4137e-3)
            .unwrap()
            .run(step, 0.5e-3, &[])
            .unwrap();
        closes(&history);
        let first = history.contacts[0]
            .force
            .iter()
            .position(|f| *f > 0.0)
            .unwrap();
        let time = first as f64 * history.grid.time_step;
        assert!((time - 0.4137e-3 / 4.0).abs() < 1.1 * step, "{time}");
        history.ledger.lost_in_contact / history.ledger.initial_energy
    };
    let (coarse, fine) = (lost(1e-6), lost(0.25e-6));
    // at most one cell of the striker in 48
    assert!(coarse < 0.05 && fine < 0.0125, "{coarse} {fine}");
}

fn prony() -> GeneralisedMaxwell {
    GeneralisedMaxwell::new(
        2.2e9,
        vec![
            MaxwellBranch {
                modulus: 0.5e9,
                relaxation_time: 1e-3,
            },
            MaxwellBranch {
                modulus: 0.9e9,
                relaxation_time: 4e-5,
            },
        ],
    )
    .unwrap()
}

/// A stack of Prony and elastic parts in time against its transition matrices on a line of the Laplace plane.
#[test]
fn prony_stack_agrees_with_its_transform() {
    let duration = 1.5e-3;
    let synthesis = DampedSynthesis::new(duration, 1e-6).unwrap();
    let medium = Medium::new(1140.0, prony()).unwrap();
    let metal = Medium::new(2700.0, rodwave::modulus::Elastic::new(69e9).unwrap()).unwrap();
    let section = |area: f64| CrossSection::of_area(area).unwrap();
    let chain = AnalyticChain::analytic_from_impact_face()
        .rod(&medium, section(AREA), 0.3)
        .rod(&metal, section(0.5 * AREA), 0.2)
        .rod(&medium, section(AREA), 0.2)
        .end(Termination::Free)
        .unwrap();
    // the Gaussian pulse of 1 N, whose transform is entire; what it has before time 0 is e^{-25}
    let transform =
        |s: Complex64| 10e-6 * std::f64::consts::PI.sqrt() * (s * s * 25e-12 - s * 50e-6).exp();
    let velocity: Vec<Complex64> = synthesis
        .arguments()
        .map(|s| chain.mobility_at_s(s).unwrap() * transform(s))
        .collect();
    let exact = synthesis.history(&velocity).unwrap();
    let peak = largest(exact.samples.iter().copied());
    let error = |step: f64| -> f64 {
        let stack = [
            Segment::prony(0.3, AREA, 1140.0, &prony()).unwrap(),
            aluminium(0.2, 0.5 * AREA),
            Segment::prony(0.2, AREA, 1140.0, &prony()).unwrap(),
        ];
        let history = pushed(line(stack), 1.0)
            .run(
                step,
                duration,
                &[Gauge {
                    body: 0,
                    position: 0.0,
                }],
            )
            .unwrap();
        closes(&history);
        let of_line = &history.gauges[0].velocity;
        let step = history.grid.time_step;
        largest(exact.samples.iter().enumerate().map(|(index, exact)| {
            let position = index as f64 * 1e-6 / step;
            let base = (position.floor() as usize).min(of_line.len() - 2);
            let u = position - base as f64;
            let linear = of_line[base] * (1.0 - u) + of_line[base + 1] * u;
            // the second difference turns the chord into the parabola, good to the third order
            let bend = if base == 0 {
                0.0
            } else {
                of_line[base - 1] - 2.0 * of_line[base] + of_line[base + 1]
            };
            linear - 0.5 * u * (1.0 - u) * bend - exact
        })) / peak
    };
    let (coarse, fine) = (error(0.8e-6), error(0.2e-6));
    // e^{-16} of the damped transform and, of second order, grid, gauge at the face and wave speeds
    assert!(fine < 1e-3 && coarse < 1e-2, "{coarse} {fine}");
    assert!(coarse / fine > 8.0, "{coarse} {fine}");
}

fn norton_rod() -> InelasticRod<MaxwellNorton> {
    InelasticRod::new(
        0.394,
        910.0,
        2.58e9,
        MaxwellNorton::new(2.108, 7e13).unwrap(),
    )
    .unwrap()
}

/// The direct problem of paper D on the other grid.
#[test]
fn agrees_with_the_direct_problem_to_second_order() {
    let rate = 51_200.0;
    let samples: Vec<f64> = (0..120)
        .map(|k| 9.0 * (-((f64::from(k) / rate - 0.6e-3) / 0.1e-3).powi(2)).exp())
        .collect();
    let excitation = SampledHistory::new(&samples, rate).unwrap();
    let times: Vec<f64> = (0..100).map(|k| f64::from(k) / rate).collect();
    let reference = DirectProblem::new(norton_rod(), 1600)
        .unwrap()
        .free_end_velocity(&excitation, &times)
        .unwrap();
    let error = |cells: f64| -> f64 {
        let segment = Segment::of_rod(&norton_rod(), AREA).unwrap();
        let step = segment.transit_time() / cells * (1.0 + 1e-9);
        let history = line([segment])
            .with_left_end(End::Velocity(Drive::history(excitation.clone())))
            .unwrap()
            .run(
                step,
                2.1e-3,
                &[Gauge {
                    body: 0,
                    position: 0.394,
                }],
            )
            .unwrap();
        closes(&history);
        let of_line = &history.gauges[0].velocity;
        let step = history.grid.time_step;
        largest(times.iter().zip(&reference).map(|(time, reference)| {
            let position = time / step;
            let base = (position.floor() as usize).max(1);
            let u = position - base as f64;
            let bend = of_line[base - 1] - 2.0 * of_line[base] + of_line[base + 1];
            let chord = of_line[base] * (1.0 - u) + of_line[base + 1] * u;
            chord - 0.5 * u * (1.0 - u) * bend - reference
        }))
    };
    let (coarse, fine) = (error(100.0), error(200.0));
    // of 15 m/s
    assert!(fine < 1e-3, "{coarse} {fine}");
    assert!(coarse / fine > 3.0, "{coarse} {fine}");
}

/// The impact of paper D by the lumped chains, which share neither grid nor contact with this solver.
#[test]
fn agrees_with_the_lumped_impact() {
    let rod =
        InelasticRod::new(0.8, 910.0, 2.58e9, MaxwellNorton::new(2.108, 7e13).unwrap()).unwrap();
    let test = ImpactTest {
        striker: Striker::PAPER_D,
        rod: rod.clone(),
        diameter: 0.0158,
        section_distance: 0.394,
    };
    let lumped = test.run(0.8 / 3200.0, 1.0e-3).unwrap();
    let area = Striker::PAPER_D.area();
    let bodies = [
        Body::new([aluminium(0.030, area)])
            .unwrap()
            .moving_at(10.0)
            .unwrap(),
        Body::new([Segment::of_rod(&rod, area).unwrap()]).unwrap(),
    ];
    let history = Line::new(bodies)
        .unwrap()
        .run(
            0.1e-6,
            1.0e-3,
            &[Gauge {
                body: 1,
                position: 0.8 - 0.394,
            }],
        )
        .unwrap();
    closes(&history);
    // both fronts are steps: compared are the displacements, ∫v dt, which the ringing of the lumped chain does not spoil
    let mut displacement = [0.0; 2];
    let mut worst = 0.0_f64;
    let mut next = 0;
    for (k, velocity) in lumped.section_velocity.iter().enumerate() {
        displacement[0] += velocity * lumped.step;
        let until = (k as f64 + 1.0) * lumped.step;
        while (next as f64 + 1.0) * history.grid.time_step <= until {
            let of = &history.gauges[0].velocity;
            displacement[1] += 0.5 * (of[next] + of[next + 1]) * history.grid.time_step;
            next += 1;
        }
        worst = worst.max((displacement[0] - displacement[1]).abs());
    }
    // the last fraction of a step of the other solver, 0.1 µs at 10 m/s, is 1 µm of some 2 mm
    assert!(
        displacement[0] > 1e-3 && worst < 4e-6,
        "{displacement:?} {worst}"
    );
    let impulse = |forces: &[f64], step: f64| forces.iter().sum::<f64>() * step;
    let (of_line, of_lumped) = (
        impulse(&history.contacts[0].force, history.grid.time_step),
        impulse(&lumped.contact_force, lumped.step),
    );
    assert!(
        (of_line / of_lumped - 1.0).abs() < 2e-3,
        "{of_line} {of_lumped}"
    );
}

/// A law of a user's own, with nothing to identify: the Maxwell law of one viscosity.
#[derive(Debug, Clone)]
struct Fixed;

const VISCOSITY: f64 = 4e5;

#[derive(Debug, Clone)]
struct FixedFlow(f64);

impl InelasticLaw for Fixed {
    const PARAMETERS: &'static [&'static str] = &[];
    type Flow = FixedFlow;

    fn inelastic_strain_rate(&self, stress: f64) -> f64 {
        stress / VISCOSITY
    }

    fn flow(&self, modulus: f64, duration: f64) -> FixedFlow {
        FixedFlow((-modulus * duration / VISCOSITY).exp())
    }

    fn parameters(&self) -> Vec<f64> {
        Vec::new()
    }

    fn with_parameters(&self, _: &[f64]) -> Result<Self, RodwaveError> {
        Ok(Self)
    }

    fn reference_stress(&self) -> f64 {
        10e6
    }
}

impl RelaxationFlow for FixedFlow {
    fn relax(&self, stress: f64) -> f64 {
        stress * self.0
    }

    fn relax_with_sensitivity(&self, stress: f64, _: &mut [f64]) -> RelaxedStress {
        RelaxedStress {
            stress: stress * self.0,
            by_stress: self.0,
            by_log_modulus: stress * self.0 * self.0.ln(),
        }
    }
}

/// Laws plug in, with parameters or without.
#[test]
fn a_law_of_the_users_own_relaxes() {
    let gauge = Gauge {
        body: 0,
        position: 0.3,
    };
    let run = |segment: Segment| {
        let line = pushed(line([segment]), 500.0);
        line.run(1e-6, 0.8e-3, &[gauge]).unwrap()
    };
    let rod = || Segment::new(0.4, AREA, 910.0).unwrap();
    let own = run(rod().with_branch(2.58e9, Fixed).unwrap());
    let ours = run(rod()
        .with_branch(2.58e9, Maxwell::new(VISCOSITY).unwrap())
        .unwrap());
    assert!(own.ledger.dissipated > 0.1 * own.ledger.supplied);
    for (a, b) in own.gauges[0].stress.iter().zip(&ours.gauges[0].stress) {
        // the same exponential, by its value and by its distance from 1
        assert!((a - b).abs() < 1e-11 * 500.0 / AREA, "{a} {b}");
    }
}

/// The strain of all cells adds up to the elongation, whatever the material.
#[test]
fn strain_adds_up_to_the_elongation() {
    let segment = Segment::prony(0.2, AREA, 1140.0, &prony()).unwrap();
    let cells = 100;
    let step = segment.transit_time() / f64::from(cells) * (1.0 + 1e-9);
    let gauges: Vec<Gauge> = (0..cells)
        .map(|j| Gauge {
            body: 0,
            position: 0.2 * (f64::from(j) + 0.5) / f64::from(cells),
        })
        .collect();
    let history = pushed(line([segment]), 500.0)
        .with_right_end(End::Fixed)
        .unwrap()
        .run(step, 0.6e-3, &gauges)
        .unwrap();
    let elongation: f64 = history.ends[0].velocity.iter().sum::<f64>() * -history.grid.time_step;
    let of_strain: f64 = history
        .gauges
        .iter()
        .map(|gauge| gauge.strain.last().unwrap() * 0.2 / f64::from(cells))
        .sum();
    let scale = largest(history.gauges[50].strain.iter().copied()) * 0.2;
    // both sums are midpoint rules of a pulse that is twenty cells long
    assert!(
        (elongation - of_strain).abs() < 1e-3 * scale,
        "{elongation} {of_strain}"
    );
    // and elastic strain is stress over modulus
    let elastic = pushed(line([steel(0.2, AREA)]), 500.0)
        .run(
            1e-6,
            0.2e-3,
            &[Gauge {
                body: 0,
                position: 0.11,
            }],
        )
        .unwrap();
    for (strain, stress) in elastic.gauges[0]
        .strain
        .iter()
        .zip(&elastic.gauges[0].stress)
    {
        assert!((strain * 206e9 - stress).abs() < 1e-12 * 500.0 / AREA);
    }
}

/// Time step of the line of [`Joined`] \[s\].
const STEP: f64 = 0.1e-6;

/// An elastic striker, a rod of two branches in parallel and a rod of one, each crossed in a whole number of steps, and
/// what a difference quotient changes of them.
#[derive(Clone, Copy)]
struct Joined {
    cells: [i32; 3],
    /// modulus of the elastic branch of the second segment; the other branch has the rest
    elastic_modulus: f64,
    rates: [f64; 2],
    exponent: f64,
    sharpness: f64,
}

const JOINED: Joined = Joined {
    cells: [200, 975, 1190],
    elastic_modulus: 1.1e9,
    rates: [400.0, 300.0],
    exponent: 2.1,
    sharpness: 1.5,
};

impl Joined {
    const LENGTHS: [f64; 3] = [0.1, 0.15, 0.2];
    const DENSITIES: [f64; 3] = [2700.0, 1140.0, 910.0];

    fn modulus(&self, segment: usize) -> f64 {
        let speed = Self::LENGTHS[segment] / (f64::from(self.cells[segment]) * STEP);
        Self::DENSITIES[segment] * speed * speed
    }

    fn line(&self) -> Line {
        let segment = |index: usize, area: f64| {
            Segment::new(Self::LENGTHS[index], area, Self::DENSITIES[index]).unwrap()
        };
        let norton =
            MaxwellNorton::from_reference_rate(self.exponent, self.rates[0], 10e6).unwrap();
        let gurevich =
            MaxwellGurevichRabinovich::from_reference_rate(self.sharpness, self.rates[1], 10e6)
                .unwrap();
        let striker = segment(0, AREA)
            .with_branch(self.modulus(0), Elastic)
            .unwrap();
        let parallel = segment(1, 0.8 * AREA)
            .with_branch(self.modulus(1) - self.elastic_modulus, norton)
            .unwrap()
            .with_branch(self.elastic_modulus, Elastic)
            .unwrap();
        let single = segment(2, AREA)
            .with_branch(self.modulus(2), gurevich)
            .unwrap();
        let bodies = [
            Body::new([striker]).unwrap(),
            Body::new([parallel, single]).unwrap(),
        ];
        let push = |t: f64| 3000.0 * (-((t - 100e-6) / 20e-6).powi(2)).exp();
        Line::new(bodies)
            .unwrap()
            .with_left_end(End::Force(Drive::of(push)))
            .unwrap()
            .with_right_end(End::Mass(0.02))
            .unwrap()
    }

    /// The line with one parameter changed by `notches`, and by how much: a modulus so that the segment is crossed in as many
    /// steps less, anything else by 5e-4 a notch.
    fn changed(&self, parameter: &Parameter, notches: i32) -> (Line, f64) {
        let mut to = *self;
        let small = 5e-4 * f64::from(notches);
        let change = match (parameter.segment, parameter.branch, parameter.name) {
            (segment, branch, "ln_modulus") => {
                to.cells[segment] -= notches;
                let total = to.modulus(segment) - self.modulus(segment);
                let own = match (segment, branch) {
                    (1, 0) => self.modulus(1) - self.elastic_modulus,
                    (1, _) => {
                        to.elastic_modulus += total;
                        self.elastic_modulus
                    }
                    _ => self.modulus(segment),
                };
                (total / own).ln_1p()
            }
            (_, _, "exponent") => {
                to.exponent += small;
                small
            }
            (_, _, "sharpness") => {
                to.sharpness += small;
                small
            }
            (segment, ..) => {
                to.rates[segment - 1] *= small.exp();
                small
            }
        };
        (to.line(), change)
    }
}

/// Weights of the derivative at 0 of the polynomial through values at 0 and at the four `points`; that at 0 last.
fn derivative_at_zero(points: [f64; 4]) -> [f64; 5] {
    let weight = |i: usize| -> f64 {
        // of x Π (x - xⱼ), j ≠ i, over its value at xᵢ
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        others.fold(1.0 / points[i], |w, (_, x)| w * -x / (points[i] - x))
    };
    let [a, b, c, d] = std::array::from_fn(weight);
    [a, b, c, d, -(a + b + c + d)]
}

/// Derivatives against differences of the same solver, through joints, branches, a contact and a mass.
///
/// A wave that crosses the striker a dozen times is shifted by a dozen steps a notch, 0.03 of its duration: the quotient of fourth order is good to
/// 1e-6, and the tolerance of 1e-4 for the moduli is for the second order of the tangent in the cell. The others have no
/// such error: what is left is rounding over the notch, and the moment of the first contact, which moves by less than a step.
#[test]
fn derivatives_agree_with_differences() {
    let line = JOINED.line();
    let gauges = [0.07, 0.29].map(|position| Gauge { body: 1, position });
    let parameters = line.parameters();
    assert_eq!(parameters.len(), 1 + 3 + 1 + 3);
    let (step, duration) = (STEP * (1.0 + 1e-9), 0.35e-3);
    let run = |line: &Line| line.run(step, duration, &gauges).unwrap();
    let with = line
        .run_with_derivatives(step, duration, &gauges, &parameters)
        .unwrap();
    let plain = run(&line);
    closes(&with);
    for (a, b) in with.gauges[1]
        .velocity
        .iter()
        .zip(&plain.gauges[1].velocity)
    {
        // the same sums in another order
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    // later the bodies part, where a derivative of the force jumps and no difference follows it
    assert!(
        plain.contacts[0].force[1000..]
            .iter()
            .all(|force| *force > 0.0)
    );
    for (parameter, derivatives) in parameters.iter().zip(&with.derivatives) {
        let changed = [-2, -1, 1, 2].map(|notches| JOINED.changed(parameter, notches));
        let weights = derivative_at_zero([0, 1, 2, 3].map(|i| changed[i].1));
        let runs = [0, 1, 2, 3].map(|i| run(&changed[i].0));
        let tolerance = if parameter.name == "ln_modulus" {
            1e-4
        } else {
            1e-7
        };
        let check = |what: &str, of: &dyn Fn(&LineHistory) -> &[f64], by: &[f64]| {
            let (scale, at) = (largest(by.iter().copied()), of(&with));
            let worst = largest((0..by.len()).map(|k| {
                let around: f64 = runs
                    .iter()
                    .zip(weights)
                    .map(|(run, w)| w * of(run)[k])
                    .sum();
                around + weights[4] * at[k] - by[k]
            }));
            assert!(
                scale > 0.0 && worst <= tolerance * scale,
                "{parameter:?} {what}: {worst:e} of {scale:e}"
            );
        };
        for (gauge, by) in derivatives.gauges.iter().enumerate() {
            check("velocity", &|run| &run.gauges[gauge].velocity, &by.velocity);
            check("stress", &|run| &run.gauges[gauge].stress, &by.stress);
            check("strain", &|run| &run.gauges[gauge].strain, &by.strain);
        }
        check(
            "contact",
            &|run| &run.contacts[0].force,
            &derivatives.contact_forces[0],
        );
        check(
            "mass",
            &|run| &run.ends[1].force,
            &derivatives.ends[1].force,
        );
        check(
            "mass",
            &|run| &run.ends[1].velocity,
            &derivatives.ends[1].velocity,
        );
    }
}

fn law(choice: u8, rate: f64, shape: f64, segment: Segment, modulus: f64) -> Segment {
    match choice {
        0 => segment.with_branch(modulus, Elastic),
        1 => segment.with_branch(modulus, Maxwell::from_reference_rate(rate, 10e6).unwrap()),
        2 => {
            let law = MaxwellNorton::from_reference_rate(1.0 + shape, rate, 10e6).unwrap();
            segment.with_branch(modulus, law)
        }
        _ => {
            let law = MaxwellGurevichRabinovich::from_reference_rate(shape, rate, 10e6).unwrap();
            segment.with_branch(modulus, law)
        }
    }
    .unwrap()
}

fn any_segment() -> impl Strategy<Value = Segment> {
    let branch = (0_u8..4, 1.0..5e4_f64, 0.0..2.0_f64, 1e9..5e9_f64);
    (
        0.02..0.3_f64,
        1e-5..5e-4_f64,
        900.0..8000.0_f64,
        prop::collection::vec(branch, 1..4),
    )
        .prop_map(|(length, area, density, branches)| {
            branches.into_iter().fold(
                Segment::new(length, area, density).unwrap(),
                |segment, (choice, rate, shape, modulus)| {
                    law(choice, rate, shape, segment, modulus)
                },
            )
        })
}

fn any_end() -> impl Strategy<Value = End> {
    prop_oneof![
        Just(End::Free),
        Just(End::Fixed),
        (1e-3..1.0_f64).prop_map(End::Mass),
        (1.0..1e4_f64).prop_map(End::Dashpot),
        Just(End::Matched),
        (-5.0..5.0_f64).prop_map(|v| End::Velocity(Drive::of(move |t| v * (t * 3e4).sin()))),
        (-5e3..5e3_f64).prop_map(|f| End::Force(Drive::of(move |t| f * (t * 2e4).cos()))),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Energy and momentum close to rounding for any bodies, laws, ends and gaps, on any grid.
    #[test]
    fn balances_close(
        bodies in prop::collection::vec((prop::collection::vec(any_segment(), 1..4), -8.0..8.0_f64), 1..4),
        left in any_end(),
        right in any_end(),
        gap in 0.0..1e-3_f64,
        step in 1e-6..8e-6_f64,
    ) {
        let many = bodies.len() > 1;
        let bodies = bodies
            .into_iter()
            .map(|(segments, velocity)| Body::new(segments).unwrap().moving_at(velocity).unwrap());
        let mut line = Line::new(bodies).unwrap();
        if many {
            line = line.with_gap(0, gap).unwrap();
        }
        let line = line
            .with_left_end(left).unwrap()
            .with_right_end(right).unwrap()
            // the balances are those of the grid's own bodies
            .with_speed_tolerance(0.2).unwrap();
        let history = line.run(step, 1.5e-3, &[]).unwrap();
        let ledger = history.ledger;
        // all that has come in or gone out; thousands of steps, each rounded relatively by 1e-16 or so
        let energy = ledger.initial_energy + ledger.supplied.abs() + ledger.stored
            + ledger.dissipated + ledger.radiated + ledger.lost_in_contact;
        prop_assert!(ledger.energy_residual().abs() <= 1e-10 * energy, "{ledger:?}");
        let mass: f64 = line.segments().map(Segment::mass).sum();
        let momentum = ledger.momentum.abs() + ledger.impulse.abs() + (2.0 * mass * energy).sqrt();
        prop_assert!(ledger.momentum_residual().abs() <= 1e-10 * momentum, "{ledger:?}");
        prop_assert!(ledger.dissipated >= 0.0 && ledger.lost_in_contact >= 0.0);
        prop_assert!(ledger.radiated >= -1e-14 * energy);
        for contact in &history.contacts {
            for (force, gap) in contact.force.iter().zip(&contact.gap) {
                prop_assert!(*force >= 0.0 && *gap >= 0.0 && (*force == 0.0 || *gap == 0.0));
            }
        }
    }
}

#[test]
fn impossible_lines_are_refused() {
    let rod = || line([steel(1.0, AREA)]);
    let gauge = |position| {
        rod()
            .run(1e-6, 1e-4, &[Gauge { body: 0, position }])
            .unwrap_err()
    };
    let unknown = Parameter {
        segment: 0,
        branch: 1,
        name: "ln_modulus",
    };
    let driven = |end: End| {
        rod()
            .with_right_end(end)
            .unwrap()
            .run(1e-6, 1e-4, &[])
            .unwrap_err()
    };
    let short = SampledHistory::new(&[0.0, 1.0, 0.0, 0.0], 51_200.0).unwrap();
    let refusals = [
        Segment::new(0.0, AREA, 7780.0).unwrap_err(),
        Segment::new(1.0, -1.0, 7780.0).unwrap_err(),
        Segment::new(1.0, AREA, f64::NAN).unwrap_err(),
        Segment::elastic(1.0, AREA, 7780.0, 0.0).unwrap_err(),
        Body::new([]).unwrap_err(),
        Body::new([steel(1.0, AREA), Segment::new(1.0, AREA, 1e3).unwrap()]).unwrap_err(),
        rod().with_gap(0, 0.0).unwrap_err(),
        rod().with_left_end(End::Mass(-1.0)).unwrap_err(),
        rod().with_left_end(End::Dashpot(0.0)).unwrap_err(),
        gauge(1.1),
        gauge(-0.1),
        gauge(f64::NAN),
        rod()
            .run(
                1e-6,
                1e-4,
                &[Gauge {
                    body: 1,
                    position: 0.0,
                }],
            )
            .unwrap_err(),
        rod().run(0.0, 1e-4, &[]).unwrap_err(),
        rod().run(1e-6, f64::INFINITY, &[]).unwrap_err(),
        rod()
            .run_with_derivatives(1e-6, 1e-4, &[], &[unknown])
            .unwrap_err(),
        driven(End::Velocity(Drive::of(|_| f64::NAN))),
        driven(End::Force(Drive::history(short))),
    ]
    .map(|error| error.to_string())
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    length [m] is 0, expected a finite value above 0
    cross-sectional area [m^2] is -1, expected a finite value above 0
    density [kg/m^3] is NaN, expected a finite value above 0
    modulus of a branch [Pa] is 0, expected a finite value above 0
    list of segments of a body has 0 entries, expected 1
    element 1: sum of the moduli of the branches [Pa] is 0, expected a finite value above 0
    list of contacts has 0 entries, expected 1
    mass at an end [kg] is -1, expected a finite value above 0
    resistance at an end [N s/m] is 0, expected a finite value above 0
    a gauge is 1.1 m from the end of a body of 1 m, expected a position inside
    a gauge is -0.1 m from the end of a body of 1 m, expected a position inside
    a gauge is NaN m from the end of a body of 1 m, expected a position inside
    list of bodies of a line has 1 entries, expected 2
    time step [s] is 0, expected a finite value above 0
    duration [s] is inf, expected a finite value above 0
    segment 0, branch 1 has no parameter `ln_modulus`
    velocity prescribed at the right end [m/s] is NaN, expected a finite value
    the response is asked for until 0.0000592977947728372 s, but the excitation ends at 0.00005859375 s
    ");
}
