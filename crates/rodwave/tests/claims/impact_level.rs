//! Initial effect of the projectile of paper D on its rods, and the time after which the printed
//! laws would have an effect.

use rodwave::impact::Striker;
use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::line::{Body, Gauge, Line, Segment};

use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;
use testbed::papers::paper_d::{LawParameters, PaperD, UnitReading, load};

/// A material of Table 4, with: the test of Table 2 that gives density and diameter; wave speed in
/// m/s; velocity of the struck face in m/s and stress in MPa; the decay time in µs of the velocity
/// of a rigid projectile; s₀/(E F(s₀)) in s, with half of its last digit.
struct Row(&'static str, usize, f64, [f64; 2], f64, (f64, f64));

#[rustfmt::skip]
const ROWS: [Row; 5] = [
    Row("Polypropylene", 2, 1684.0, [9.02, 13.8], 55.0, (181.0, 0.5)),
    Row("Polyamide 6", 7, 1678.0, [8.66, 16.6], 38.0, (12.7, 0.05)),
    Row("Polyoximethylene", 12, 1442.0, [8.75, 17.7], 42.0, (1219.0, 0.5)),
    Row("Polyethylene", 17, 1497.0, [9.03, 12.7], 55.0, (149.0, 0.5)),
    Row("Rubber", 22, 458.0, [9.74, 5.9], 225.0, (294.0, 0.5)),
];

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    let levels = ROWS.map(|row| (Level::of(&row), row));
    // in units of half of the last printed digit
    let worst = |error: &dyn Fn(&Level, &Row) -> f64| {
        Ok(largest(levels.iter().map(|(level, row)| error(level, row))))
    };
    let why = Within(1.0, "half the last printed digit");
    report.by("paper D, Tables 2 and 4, computed elsewhere to the printed digits");
    let striker = Striker::PAPER_D;
    report.deviation(
        "projectile of paper D: mass minus 15.88 g, impedance minus 2676 kg/s, in units of half a digit",
        why,
        Ok(largest([
            (striker.mass() - 15.88e-3) / 5e-6,
            (striker.impedance() - 2676.0) / 0.5,
        ])),
    );
    report.deviation(
        "rods of paper D, five materials: wave speeds of 458 to 1684 m/s, in units of half a digit",
        why,
        worst(&|level, row| (level.wave_speed - row.2) / 0.5),
    );
    report.deviation(
        "rods of paper D: velocities of the struck face, 8.66 to 9.74 m/s, by the march of two bodies, in units of half a digit",
        why,
        worst(&|level, row| (level.velocity - row.3[0]) / 0.005),
    );
    report.deviation(
        "rods of paper D: stresses of the front, 5.9 to 17.7 MPa, by the march of two bodies, in units of half a digit",
        why,
        worst(&|level, row| (1e-6 * level.stress - row.3[1]) / 0.05),
    );
    report.deviation(
        "rods of paper D: mass of the projectile over the impedance of the rod, 38 to 225 µs, in units of half a digit",
        why,
        worst(&|level, row| (1e6 * level.decay_time - row.4) / 0.5),
    );
    report
        .by("paper D, Tables 2 and 4 read literally, an erratum: computed elsewhere")
        .deviation(
            "rods of paper D: relaxation times at the stress of the front by the printed laws, 12.7 to 1219 s, in units of half a digit",
            why,
            worst(&|level, row| {
                let (time, half_digit) = row.5;
                (relaxation_time(row, level.stress) - time) / half_digit
            }),
        );
    hold!(report);
}

/// State of the elastic rod immediately after the contact.
struct Level {
    wave_speed: f64,
    velocity: f64,
    stress: f64,
    decay_time: f64,
}

fn printed(row: &Row) -> (PaperD, LawParameters) {
    let paper = load().unwrap();
    let values = paper
        .identified(UnitReading::Literal)
        .iter()
        .find(|identified| identified.material == row.0)
        .map(|identified| identified.values)
        .unwrap();
    (paper, values)
}

fn modulus_of(values: &LawParameters) -> f64 {
    match *values {
        LawParameters::Maxwell { modulus, .. }
        | LawParameters::MaxwellNorton { modulus, .. }
        | LawParameters::MaxwellGurevichRabinovich { modulus, .. } => modulus,
    }
}

fn area(diameter: f64) -> f64 {
    0.25 * std::f64::consts::PI * diameter * diameter
}

impl Level {
    fn of(row: &Row) -> Self {
        let (paper, values) = printed(row);
        let test = &paper.tests[row.1 - 1];
        let striker = &paper.striker;
        let projectile = Segment::elastic(
            striker.length,
            area(striker.diameter),
            striker.density,
            striker.modulus,
        )
        .unwrap();
        let rod = Segment::elastic(
            test.rod_length,
            area(test.diameter),
            test.density,
            modulus_of(&values),
        )
        .unwrap();
        let wave_speed = rod.wave_speed();
        // evaluated 1 mm inside the rod, a third of the first round trip in the projectile after
        // the arrival of the front
        let position = 1e-3;
        let arrived = position / wave_speed + 4e-6;
        let decay_time = projectile.mass() / rod.impedance();
        let bodies = [
            Body::new([projectile])
                .unwrap()
                .moving_at(striker.velocity)
                .unwrap(),
            Body::new([rod]).unwrap(),
        ];
        let gauge = Gauge { body: 1, position };
        let history = Line::new(bodies)
            .unwrap()
            .run(0.1e-6, arrived + 1e-6, &[gauge])
            .unwrap();
        let at = |values: &[f64], time: f64| values[(time / history.grid.time_step) as usize];
        Self {
            wave_speed,
            velocity: at(&history.gauges[0].velocity, arrived),
            stress: -at(&history.gauges[0].stress, arrived),
            decay_time,
        }
    }
}

fn relaxation_time(row: &Row, stress: f64) -> f64 {
    let values = printed(row).1;
    let rate = match values {
        LawParameters::Maxwell { viscosity, .. } => Maxwell::new(viscosity)
            .unwrap()
            .inelastic_strain_rate(stress),
        LawParameters::MaxwellNorton {
            exponent,
            coefficient,
            ..
        } => MaxwellNorton::new(exponent, coefficient)
            .unwrap()
            .inelastic_strain_rate(stress),
        LawParameters::MaxwellGurevichRabinovich {
            viscosity,
            activation_stress,
            ..
        } => MaxwellGurevichRabinovich::new(viscosity, activation_stress)
            .unwrap()
            .inelastic_strain_rate(stress),
    };
    stress / (modulus_of(&values) * rate)
}
