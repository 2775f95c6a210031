//! What the projectile of paper D does to its rods at first, and how long the printed laws would take to matter.

use rodwave::impact::Striker;
use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::line::{Body, Gauge, Line, Segment};

use testbed::claim::{Claim, Claims, Fallible, Found};
use testbed::hold;
use testbed::papers::paper_d::{LawParameters, PaperD, UnitReading, load};

/// A material of Table 4 with the density and the diameter of Table 2.
struct Row {
    material: &'static str,
    /// The test whose rod it is.
    test: usize,
    wave_speed: f64,
    /// Of the struck face, with half of its last digit.
    velocity: f64,
    stress: (f64, f64),
    /// In which a rigid projectile would be braked, in µs.
    decay_time: f64,
    /// s₀/(E F(s₀)), with half of its last digit.
    relaxation_time: (f64, f64),
}

const ROWS: [Row; 5] = [
    Row {
        material: "Polypropylene",
        test: 2,
        wave_speed: 1684.0,
        velocity: 9.02,
        stress: (13.8, 0.05),
        decay_time: 55.0,
        relaxation_time: (181.0, 0.5),
    },
    Row {
        material: "Polyamide 6",
        test: 7,
        wave_speed: 1678.0,
        velocity: 8.66,
        stress: (16.6, 0.05),
        decay_time: 38.0,
        relaxation_time: (12.7, 0.05),
    },
    Row {
        material: "Polyoximethylene",
        test: 12,
        wave_speed: 1442.0,
        velocity: 8.75,
        stress: (17.7, 0.05),
        decay_time: 42.0,
        relaxation_time: (1219.0, 0.5),
    },
    Row {
        material: "Polyethylene",
        test: 17,
        wave_speed: 1497.0,
        velocity: 9.03,
        stress: (12.7, 0.05),
        decay_time: 55.0,
        relaxation_time: (149.0, 0.5),
    },
    Row {
        material: "Rubber",
        test: 22,
        wave_speed: 458.0,
        velocity: 9.74,
        stress: (5.9, 0.05),
        decay_time: 225.0,
        relaxation_time: (294.0, 0.5),
    },
];

const SOURCE: &str = "paper D, Tables 2 and 4, computed elsewhere to the printed digits";
const LITERAL: &str = "paper D, Tables 2 and 4 read literally, an erratum: computed elsewhere";
const WHY: &str = "half the last printed digit";

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    report.check(
        Claim::new("projectile of paper D: mass", SOURCE)
            .expects(15.88e-3, "kg")
            .within(5e-6, WHY),
        || Ok(Striker::PAPER_D.mass()),
    );
    report.check(
        Claim::new("projectile of paper D: impedance", SOURCE)
            .expects(2676.0, "kg/s")
            .within(0.5, WHY),
        || Ok(Striker::PAPER_D.impedance()),
    );
    for row in &ROWS {
        let claim = |what: &str, source| Claim::new(format!("{}: {what}", row.material), source);
        report.check(
            claim("wave speed", SOURCE)
                .expects(row.wave_speed, "m/s")
                .within(0.5, WHY),
            || Ok(Level::of(row)?.wave_speed),
        );
        report.check(
            claim(
                "velocity of the struck face by the march of two bodies",
                SOURCE,
            )
            .expects(row.velocity, "m/s")
            .within(0.005, WHY),
            || Ok(Level::of(row)?.velocity),
        );
        let (stress, half_digit) = row.stress;
        report.check(
            claim("stress of the front by the march of two bodies", SOURCE)
                .expects(stress, "MPa")
                .within(half_digit, WHY),
            || Ok(1e-6 * Level::of(row)?.stress),
        );
        report.check(
            claim("mass of the projectile by the impedance of the rod", SOURCE)
                .expects(row.decay_time, "µs")
                .within(0.5, WHY),
            || Ok(1e6 * Level::of(row)?.decay_time),
        );
        let (time, half_digit) = row.relaxation_time;
        report.check(
            claim("relaxation time at that stress by the printed law", LITERAL)
                .expects(time, "s")
                .within(half_digit, WHY),
            || relaxation_time(row),
        );
    }
    hold!(report);
}

/// The elastic rod right after the blow.
struct Level {
    wave_speed: f64,
    velocity: f64,
    stress: f64,
    decay_time: f64,
}

fn printed(row: &Row) -> Fallible<(PaperD, LawParameters)> {
    let paper = load()?;
    let values = paper
        .identified(UnitReading::Literal)
        .iter()
        .find(|identified| identified.material == row.material)
        .map(|identified| identified.values)
        .ok_or_else(|| format!("no {} in Table 4", row.material))?;
    Ok((paper, values))
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
    fn of(row: &Row) -> Fallible<Self> {
        let (paper, values) = printed(row)?;
        let test = &paper.tests[row.test - 1];
        let striker = &paper.striker;
        let projectile = Segment::elastic(
            striker.length,
            area(striker.diameter),
            striker.density,
            striker.modulus,
        )?;
        let rod = Segment::elastic(
            test.rod_length,
            area(test.diameter),
            test.density,
            modulus_of(&values),
        )?;
        let wave_speed = rod.wave_speed();
        // a third of the first round trip in the projectile after the front, a millimetre inside
        let position = 1e-3;
        let arrived = position / wave_speed + 4e-6;
        let decay_time = projectile.mass() / rod.impedance();
        let bodies = [
            Body::new([projectile])?.moving_at(striker.velocity)?,
            Body::new([rod])?,
        ];
        let gauge = Gauge { body: 1, position };
        let history = Line::new(bodies)?.run(0.1e-6, arrived + 1e-6, &[gauge])?;
        let at = |values: &[f64], time: f64| {
            let steps = time / history.grid.time_step;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "the number of a step"
            )]
            let value = values.get(steps as usize);
            value.copied().unwrap_or(f64::NAN)
        };
        Ok(Self {
            wave_speed,
            velocity: at(&history.gauges[0].velocity, arrived),
            stress: -at(&history.gauges[0].stress, arrived),
            decay_time,
        })
    }
}

fn relaxation_time(row: &Row) -> Found {
    let stress = Level::of(row)?.stress;
    let values = printed(row)?.1;
    let rate = match values {
        LawParameters::Maxwell { viscosity, .. } => {
            Maxwell::new(viscosity)?.inelastic_strain_rate(stress)
        }
        LawParameters::MaxwellNorton {
            exponent,
            coefficient,
            ..
        } => MaxwellNorton::new(exponent, coefficient)?.inelastic_strain_rate(stress),
        LawParameters::MaxwellGurevichRabinovich {
            viscosity,
            activation_stress,
            ..
        } => MaxwellGurevichRabinovich::new(viscosity, activation_stress)?
            .inelastic_strain_rate(stress),
    };
    Ok(stress / (modulus_of(&values) * rate))
}
