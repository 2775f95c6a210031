//! Laws defined by a user.

use super::*;

/// Law defined by a user, without parameters: the Maxwell law with a fixed viscosity.
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

/// Compares a law defined by a user with the same law of the crate (Ödeen 1993, paper D, eq. 3).
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
        // tolerance: the same exponential, computed directly and from its difference to 1
        assert!((a - b).abs() < 1e-11 * 500.0 / AREA, "{a} {b}");
    }
}
