//! Common tests of every inelastic law: its flow compared with an independent integration of
//! dσ/dt = -E F(σ), the semigroup property, dissipation, and every derivative compared with finite
//! differences.

use super::{InelasticLaw, LANES, RelaxationFlow};

const MODULUS: f64 = 2.5e9;

/// Classical Runge-Kutta method for ln|σ|. The steps are uniform while the stress barely changes;
/// later they are proportional to the elapsed time, so that the stress changes by about the same
/// fraction in each step, even if the relaxation was fast at its start.
fn integrate<L: InelasticLaw>(law: &L, stress: f64, duration: f64) -> f64 {
    let rate = |z: f64| -MODULUS * law.inelastic_strain_rate(z.exp()) / z.exp();
    let step = |z: f64, h: f64| {
        let k1 = rate(z);
        let k2 = rate(z + 0.5 * h * k1);
        let k3 = rate(z + 0.5 * h * k2);
        let k4 = rate(z + h * k3);
        z + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    };
    let mut z = stress.abs().ln();
    let mut time = 0.0;
    while time < duration {
        let h = (1e-3 / rate(z).abs()).min(1e-3 * duration).max(2e-3 * time);
        let h = h.min(duration - time);
        z = step(z, h);
        time += h;
        if duration - time < 1e-12 * duration {
            break;
        }
    }
    z.exp().copysign(stress)
}

/// Durations from far below to above the relaxation time of the tested laws at 10 MPa (about 1 ms).
const DURATIONS: [f64; 5] = [1e-8, 1e-6, 3e-5, 4e-4, 2e-3];
const STRESSES: [f64; 7] = [1e2, -4e4, 1e6, -5e6, 1.2e7, 3e7, -6e7];

/// Checks the flow of `law`, whose rate at 10 MPa is about 4/s, and all derivatives of the flow.
pub(super) fn battery<L: InelasticLaw>(law: &L) {
    for duration in DURATIONS {
        let flow = law.flow(MODULUS, duration);
        let half = law.flow(MODULUS, 0.5 * duration);
        assert!(flow.relax(0.0) == 0.0, "{law:?}");
        for stress in STRESSES {
            let relaxed = flow.relax(stress);
            let context = format!("{law:?}, {stress} Pa for {duration} s: {relaxed}");
            if relaxed == 0.0 {
                // for κ < 1, the stress is zero after 1/|κ - 1| times the time that the initial
                // rate would need
                let initial_rate = MODULUS * law.inelastic_strain_rate(stress) / stress;
                assert!(
                    (1.0 - law.parameters()[0]) * initial_rate * duration >= 1.0,
                    "{context}"
                );
                continue;
            }
            // tolerance: the integration is of fourth order with steps of 1e-3 of a time constant
            let expected = integrate(law, stress, duration);
            assert!(
                (relaxed / expected - 1.0).abs() < 1e-9,
                "{context}, expected {expected}"
            );
            assert!(
                relaxed.abs() <= stress.abs() && relaxed * stress >= 0.0,
                "{context}"
            );
            // tolerance: two half steps and the whole step are both exact and differ by rounding
            // only
            let twice = half.relax(half.relax(stress));
            assert!(
                (relaxed / twice - 1.0).abs() < 2e-13,
                "{context}, twice half {twice}"
            );
            assert!(
                (flow.relax(-stress) + relaxed).abs() < f64::EPSILON,
                "odd: {context}"
            );
            derivatives(law, stress, duration);
            several_cells(law, stress, duration);
        }
    }
}

/// Compares the flow of several cells together with the flow of each cell.
fn several_cells<L: InelasticLaw>(law: &L, stress: f64, duration: f64) {
    let count = L::PARAMETERS.len();
    let flow = law.flow(MODULUS, duration);
    // from a hundredth of the stress to all of it, so that one block contains short and long steps
    // and a cell at rest
    let mut cells = [0.0; LANES];
    for (lane, cell) in (0_u8..).zip(&mut cells[1..]) {
        *cell = stress * 0.01_f64.powf(1.0 - f64::from(lane) / 14.0);
    }
    let change = flow.change(&cells);
    let sensitivity = flow.change_with_sensitivity(&cells, count);
    let mut by_parameter = vec![0.0; count];
    for (lane, &cell) in cells.iter().enumerate() {
        let context = format!("{law:?}, {cell} Pa for {duration} s");
        let exact = flow.relax_with_sensitivity(cell, &mut by_parameter);
        // tolerance: two evaluations of one exact flow, each accurate to some 1e-14 of the stress
        let rounding = 1e-13 * cell.abs();
        assert!(
            (change[lane] - (flow.relax(cell) - cell)).abs() <= rounding,
            "{context}"
        );
        assert!(
            (sensitivity.stress[lane] - change[lane]).abs() <= rounding,
            "{context}"
        );
        let close = |name: &str, found: f64, expected: f64, scale: f64| {
            assert!(
                (found - expected).abs() <= 1e-11 * expected.abs() + 1e-13 * scale,
                "{context}: {name} {found}, cell by cell {expected}"
            );
        };
        // at rest, dσ1/dσ0 jumps if κ is just above 1: it is 1 at 0 Pa and e^{-q} at 1e-300 Pa,
        // where q is the duration over the relaxation time
        if cell != 0.0 {
            close(
                "by stress",
                1.0 + sensitivity.by_stress[lane],
                exact.by_stress,
                1.0,
            );
        }
        close(
            "by ln modulus",
            sensitivity.by_log_modulus[lane],
            exact.by_log_modulus,
            cell.abs(),
        );
        for (found, expected) in sensitivity.by_parameter.iter().zip(&by_parameter) {
            close("by parameter", found[lane], *expected, cell.abs());
        }
    }
}

/// Compares the derivatives of the flow with central differences, whose error is of order (1e-4)²
/// times a third derivative of order one.
fn derivatives<L: InelasticLaw>(law: &L, stress: f64, duration: f64) {
    const H: f64 = 1e-4;
    let mut by_parameter = vec![0.0; L::PARAMETERS.len()];
    let result = law
        .flow(MODULUS, duration)
        .relax_with_sensitivity(stress, &mut by_parameter);
    let relaxed = law.flow(MODULUS, duration).relax(stress);
    let context = format!("{law:?}, {stress} Pa for {duration} s");
    assert!(
        (result.stress - relaxed).abs() <= 1e-15 * stress.abs(),
        "{context}"
    );
    let check = |name: &str, exact: f64, plus: f64, minus: f64| {
        let difference = (plus - minus) / (2.0 * H);
        // tolerance: relative to the value or, if the derivative is a small part of the stress, to
        // the rounding of the stress
        let scale = exact.abs().max(1e-9 * stress.abs());
        assert!(
            (exact - difference).abs() < 2e-6 * scale + 1e-11 * stress.abs(),
            "{context}: {name} {exact}, by differences {difference}"
        );
    };
    let flow = law.flow(MODULUS, duration);
    check(
        "by ln stress",
        result.by_stress * stress,
        flow.relax(stress * H.exp()),
        flow.relax(stress * (-H).exp()),
    );
    let stretched = |h: f64| law.flow(MODULUS * f64::exp(h), duration).relax(stress);
    check(
        "by ln modulus",
        result.by_log_modulus,
        stretched(H),
        stretched(-H),
    );
    for (index, name) in L::PARAMETERS.iter().enumerate() {
        let moved = |h: f64| {
            let mut parameters = law.parameters();
            parameters[index] += h;
            law.with_parameters(&parameters)
                .unwrap()
                .flow(MODULUS, duration)
                .relax(stress)
        };
        check(name, by_parameter[index], moved(H), moved(-H));
    }
}
