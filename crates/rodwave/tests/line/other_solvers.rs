//! Comparison with other solvers: the direct problem, lumped chains.

use super::*;

fn norton_rod() -> InelasticRod<MaxwellNorton> {
    InelasticRod::new(
        0.394,
        910.0,
        2.58e9,
        MaxwellNorton::new(2.108, 7e13).unwrap(),
    )
    .unwrap()
}

/// Compares the line with the direct problem of paper D, which has another grid.
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
    // the velocity reaches 15 m/s
    assert!(fine < 1e-3, "{coarse} {fine}");
    assert!(coarse / fine > 3.0, "{coarse} {fine}");
}

/// Checks that the direct problem rejects a standard solid, which has several branches.
#[test]
fn a_spring_is_refused_by_the_direct_problem() {
    let solid = norton_rod().with_spring(0.5).unwrap();
    assert_eq!(
        DirectProblem::new(solid, 100).unwrap_err().to_string(),
        "share of a spring in the modulus is 0.5, expected 0: this solver has one branch; use `BranchedProblem` for several"
    );
}

/// Compares the impact of paper D with the lumped chains, which share neither grid nor contact with
/// this solver: the rod of the paper, and a rod whose dashpot is ten times as fast and has a spring
/// in parallel.
#[test]
fn agrees_with_the_lumped_impact() {
    let rod = |coefficient| {
        let law = MaxwellNorton::new(2.108, coefficient).unwrap();
        InelasticRod::new(0.8, 910.0, 2.58e9, law).unwrap()
    };
    agrees_with_lumped(rod(7e13));
    agrees_with_lumped(rod(7e12).with_spring(0.5).unwrap());
}

fn agrees_with_lumped(rod: InelasticRod<MaxwellNorton>) {
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
    // both fronts are steps, so the displacements ∫v dt are compared, which the ringing of the
    // lumped chain does not affect
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
    // tolerance: displacements of some 2 mm are compared at times that differ by less than a step,
    // and 0.1 µs at 10 m/s is 1 µm
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
