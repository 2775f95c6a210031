//! Diagram of a whole line.

use super::*;

/// Line of a steel striker, a gap, and a polymer with an inelastic law, bonded to a polymer with
/// two branches.
fn varied() -> Line {
    let flow = MaxwellNorton::from_reference_rate(2.0, 2e4, 10e6).unwrap();
    let flowing = Segment::new(0.1, AREA, 1140.0).unwrap();
    let flowing = flowing.with_branch(3.1e9, flow).unwrap();
    let relaxing = Segment::prony(0.15, AREA, 1140.0, &prony()).unwrap();
    let striker = Body::new([steel(0.05, AREA)]).unwrap().moving_at(6.0);
    let target = Body::new([flowing, relaxing]).unwrap();
    let line = Line::new([striker.unwrap(), target]).unwrap();
    line.with_gap(0, 1e-4).unwrap()
}

#[test]
fn a_cell_is_what_a_gauge_at_its_centre_sees() {
    let line = varied();
    let (step, duration, stride) = (1e-6, 0.3e-3, 3);
    let diagram = line.diagram(step, duration, stride).unwrap();
    let n_cells = diagram.positions.len();
    assert_eq!(n_cells, diagram.grid.cells.iter().sum::<usize>());
    assert_eq!(diagram.velocity.len(), diagram.times.len() * n_cells);
    let begin = [0.0, 0.05 + 1e-4];
    // including the first and the last cell of every segment
    let bounds = diagram.grid.cells.iter().scan(0, |before, cells| {
        let first = *before;
        *before += cells;
        Some([first, *before - 1])
    });
    let cells: Vec<usize> = bounds.flatten().chain([n_cells / 2]).collect();
    let gauges: Vec<Gauge> = cells
        .iter()
        .map(|&cell| {
            let body = diagram.bodies[cell];
            let position = diagram.positions[cell] - begin[body];
            Gauge { body, position }
        })
        .collect();
    let history = line.run(step, duration, &gauges).unwrap();
    for (cell, seen) in cells.iter().zip(&history.gauges) {
        for (quantity, seen, size) in [
            (&diagram.velocity, &seen.velocity, 6.0),
            (&diagram.stress, &seen.stress, 20e6),
            (&diagram.strain, &seen.strain, 5e-3),
        ] {
            for (index, seen) in seen.iter().step_by(stride).enumerate() {
                let found = diagram.at(quantity, index)[*cell];
                // tolerance: the position of a gauge is rounded, which gives the neighbours a
                // weight of 1e-13 in the cubic
                assert!((found - seen).abs() < 1e-11 * size, "{cell}, {index}");
            }
        }
    }
    let last = *diagram.times.last().unwrap();
    assert!((last - duration).abs() < stride as f64 * step, "{last}");
}

/// Checks that two free elastic bodies conserve momentum and energy, summed over the cells.
#[test]
fn what_is_in_the_cells_is_conserved() {
    let bars = [steel(0.1, AREA), aluminium(0.2, 2.0 * AREA)];
    let [striker, bar] = bars.map(|segment| Body::new([segment]).unwrap());
    let line = Line::new([striker.moving_at(5.0).unwrap(), bar]).unwrap();
    // at the last times, the bodies are separated
    let diagram = line.diagram(1e-6, 0.2e-3, 1).unwrap();
    let of_body = [(7780.0, 206e9, AREA, 0.1), (2700.0, 69e9, 2.0 * AREA, 0.2)];
    let sum = |index: usize, term: &dyn Fn(usize, f64, f64, f64) -> f64| -> f64 {
        let (velocity, stress, strain) = (
            diagram.at(&diagram.velocity, index),
            diagram.at(&diagram.stress, index),
            diagram.at(&diagram.strain, index),
        );
        (0..diagram.positions.len())
            .map(|cell| {
                let body = diagram.bodies[cell];
                let (_, _, area, length) = of_body[body];
                let volume = area * length / diagram.grid.cells[body] as f64;
                volume * term(body, velocity[cell], stress[cell], strain[cell])
            })
            .sum()
    };
    let momentum = |body: usize, v: f64, _: f64, _: f64| of_body[body].0 * v;
    let energy = |body: usize, v: f64, stress: f64, strain: f64| {
        0.5 * (of_body[body].0 * v * v + stress * strain)
    };
    let whole = |part: &dyn Fn(usize, f64, f64, f64) -> f64| {
        let before = sum(0, part);
        (0..diagram.times.len())
            .map(|index| (sum(index, part) / before - 1.0).abs())
            .fold(0.0, f64::max)
    };
    // at whole steps, every wave is in a cell; it passes a contact half a step later
    assert!(whole(&momentum) < 1e-12, "{}", whole(&momentum));
    assert!(whole(&energy) < 1e-12, "{}", whole(&energy));
}

/// Checks that the strains of all cells add up to the difference between the displacements of the
/// ends.
#[test]
fn strains_add_up_to_the_displacement_of_the_ends() {
    let line = pushed(
        line([Segment::prony(0.2, AREA, 1140.0, &prony()).unwrap()]),
        800.0,
    );
    let (step, duration) = (1e-6, 0.25e-3);
    let diagram = line.diagram(step, duration, 1).unwrap();
    let history = line.run(step, duration, &[]).unwrap();
    let cell = 0.2 / diagram.positions.len() as f64;
    let mut apart = 0.0;
    let [left, right] = &history.ends;
    for (index, (left, right)) in left.velocity.iter().zip(&right.velocity).enumerate() {
        apart += (right - left) * diagram.grid.time_step;
        let strain: f64 = diagram.at(&diagram.strain, index + 1).iter().sum();
        // tolerance: rounding of sums of some hundred strains of 1e-3
        assert!((strain * cell - apart).abs() < 1e-14, "{index}");
    }
    assert!(apart.abs() > 1e-6);
}

#[test]
fn diagrams_that_cannot_be_are_refused() {
    let line = varied();
    let said = |stride, duration| {
        let refused = line.diagram(1e-6, duration, stride);
        refused.unwrap_err().to_string()
    };
    assert_eq!(
        said(0, 1e-3),
        "stride of the diagram [steps] is 0, expected at least 1"
    );
    assert!(said(1, 100.0).contains("expected at most 2^27; use a longer stride or step"));
    assert!(line.diagram(1e-6, f64::NAN, 1).is_err());
}
