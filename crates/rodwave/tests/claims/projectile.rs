//! The projectile of paper D by lumped chains: closed forms, balances, the march of two bodies.

use rodwave::InelasticRod;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{Elastic, MaxwellNorton};
use rodwave::line::{Body, Line, Segment};

use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::worst;
use testbed::hold;

const SAINT_VENANT: &str = "closed form (de Saint-Venant)";

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    let rod = || InelasticRod::new(0.4, 910.0, 2.58e9, Elastic);
    let test = |length: f64| -> Fallible<ImpactTest<Elastic>> {
        Ok(ImpactTest {
            striker: Striker::PAPER_D,
            rod: InelasticRod::new(length, 910.0, 2.58e9, Elastic)?,
            diameter: 0.0155,
            section_distance: length - 0.008,
        })
    };
    report.check(
        Claim::new(
            "projectile of paper D, lumped chains: eight plateaus of the force, each relative",
            SAINT_VENANT,
        )
        .within(0.01, "ringing of the grid over the middle third"),
        || {
            let test = test(0.4)?;
            let history = test.run(0.2e-3, 0.2e-3)?;
            let zs = test.striker.impedance();
            let zr = 0.25 * std::f64::consts::PI * 0.0155_f64.powi(2) * rod()?.specific_impedance();
            let trip = 2.0 * 0.030 / (69e9_f64 / 2700.0).sqrt();
            worst(0..8, |n| {
                let from = (f64::from(n) + 1.0 / 3.0) * trip / history.step;
                let to = (f64::from(n) + 2.0 / 3.0) * trip / history.step;
                let plateau: Vec<f64> = history
                    .contact_force
                    .iter()
                    .enumerate()
                    .filter(|(k, _)| (from..to).contains(&(*k as f64)))
                    .map(|(_, force)| *force)
                    .collect();
                let mean = plateau.iter().sum::<f64>() / plateau.len() as f64;
                let step = ((zs - zr) / (zs + zr)).powi(n);
                Ok(mean / (10.0 / (1.0 / zs + 1.0 / zr) * step) - 1.0)
            })
        },
    );
    report.check(
        Claim::new(
            "projectile of paper D, lumped chains, Norton rod: momentum that is missing, as a part",
            "conservation of momentum",
        )
        .within(1e-10, "rounding"),
        || {
            let test = ImpactTest {
                striker: Striker::PAPER_D,
                rod: InelasticRod::new(0.4, 910.0, 2.58e9, MaxwellNorton::new(2.108, 7e13)?)?,
                diameter: 0.0155,
                section_distance: 0.392,
            };
            Ok(test.run(0.5e-3, 2e-3)?.balance.momentum_residual)
        },
    );
    report.check(
        Claim::new(
            "projectile of paper D on a rod of 0.2 m: end of contact",
            "closed form: return of the wave, 2L/c",
        )
        .expects(0.4 / (2.58e9_f64 / 910.0).sqrt(), "s")
        .within(10e-6, "ringing holds the face for the time of some cells"),
        || {
            let history = test(0.2)?.run(0.2e-3, 0.6e-3)?;
            let last = history.contact_force.iter().rposition(|force| *force > 0.0);
            Ok(last.map_or(f64::NAN, |k| k as f64 * history.step))
        },
    );
    report.check(
        Claim::new("projectile of paper D: impulse of the contact by lumped chains and by characteristics, ratio", "two solvers that share neither grid nor contact")
            .expects(1.0, "1")
            .within(2e-3, "first order at the jump of the force"),
        || {
            let law = MaxwellNorton::new(2.108, 7e13)?;
            let rod = InelasticRod::new(0.8, 910.0, 2.58e9, law)?;
            let test = ImpactTest {
                striker: Striker::PAPER_D,
                rod: rod.clone(),
                diameter: 0.0158,
                section_distance: 0.394,
            };
            let lumped = test.run(0.8 / 3200.0, 1.0e-3)?;
            let area = Striker::PAPER_D.area();
            let bodies = [
                Body::new([Segment::elastic(0.030, area, 2700.0, 69e9)?])?.moving_at(10.0)?,
                Body::new([Segment::of_rod(&rod, area)?])?,
            ];
            let history = Line::new(bodies)?.run(0.1e-6, 1.0e-3, &[])?;
            let of_line = history.contacts[0].force.iter().sum::<f64>() * history.grid.time_step;
            Ok(of_line / (lumped.contact_force.iter().sum::<f64>() * lumped.step))
        },
    );
    hold!(report);
}
