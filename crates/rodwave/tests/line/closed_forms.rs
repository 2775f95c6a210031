//! Pulses, joints, masses and impacts whose solution is known.

use super::*;

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
