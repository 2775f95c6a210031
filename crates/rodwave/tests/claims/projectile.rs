//! Projectile of paper D, computed by lumped chains and compared with closed forms.

use rodwave::InelasticRod;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::Elastic;
use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;

/// Claims on the projectile (Ödeen 1993, paper D, Figure 1).
#[test]
fn claims_hold() {
    let mut report = Claims::default();
    let test = |length: f64| ImpactTest {
        striker: Striker::PAPER_D,
        rod: InelasticRod::new(length, 910.0, 2.58e9, Elastic).unwrap(),
        diameter: 0.0155,
        section_distance: length - 0.008,
    };
    let struck = test(0.4);
    let history = struck.run(0.2e-3, 0.2e-3).unwrap();
    let zs = struck.striker.impedance();
    let area = 0.25 * std::f64::consts::PI * 0.0155_f64.powi(2);
    let zr = area * struck.rod.specific_impedance();
    let trip = 2.0 * 0.030 / (69e9_f64 / 2700.0).sqrt();
    let plateaus = (0..8).map(|n| {
        let at = |part: f64| ((f64::from(n) + part) * trip / history.step).ceil() as usize;
        let plateau = &history.contact_force[at(1.0 / 3.0)..at(2.0 / 3.0)];
        let mean = plateau.iter().sum::<f64>() / plateau.len() as f64;
        let step = ((zs - zr) / (zs + zr)).powi(n);
        mean / (10.0 / (1.0 / zs + 1.0 / zr) * step) - 1.0
    });
    report.by("closed form (de Saint-Venant)").deviation(
        "projectile of paper D, lumped chains: eight plateaus of the force, each relative",
        Within(
            0.003,
            "ringing of the grid in the middle third of a plateau",
        ),
        Ok(largest(plateaus)),
    );
    let history = test(0.2).run(0.2e-3, 0.6e-3).unwrap();
    let last = history.contact_force.iter().rposition(|force| *force > 0.0);
    report.by("closed form: return of the wave, 2L/c").claim(
        "projectile of paper D on a rod of 0.2 m: end of contact",
        "s",
        0.4 / (2.58e9_f64 / 910.0).sqrt(),
        Within(
            5e-6,
            "because of ringing, the contact ends later by the travel time over some cells",
        ),
        Ok(last.map_or(f64::NAN, |k| k as f64 * history.step)),
    );
    hold!(report);
}
