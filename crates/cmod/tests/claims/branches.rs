//! Paper A, Table 1: the integers of the closed form, as the software counts them along a record.

use std::f64::consts::{FRAC_PI_2, TAU};

use cmod::branch::{Branch, FreeEndRoot, ResolvedRoot, resolve};
use num_complex::Complex64;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{EndAccelerationTest, Specimen};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;
use testbed::papers::paper_a;

/// Roots of a record and the exact γL.
struct Counted {
    roots: Vec<ResolvedRoot>,
    exact: Vec<Complex64>,
}

impl Counted {
    /// What all lines agree on whose kL is in this quarter turn; NaN where they do not.
    fn in_quarter(&self, quarter: f64, number: fn(&Branch) -> f64) -> f64 {
        let lines = self.roots.iter().zip(&self.exact);
        let inside = lines.filter(|(_, exact)| {
            let turns = exact.im / FRAC_PI_2;
            turns > quarter && turns < quarter + 1.0
        });
        let found: Vec<f64> = inside.map(|(root, _)| number(&root.branch)).collect();
        match found.first() {
            Some(first) if found.iter().all(|other| (other - first).abs() < 0.5) => *first,
            _ => f64::NAN,
        }
    }
}

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims.by("paper A, Table 1 (layout lost in print, restored)");
    let counted = counted();
    match paper_a::load() {
        Ok(paper) => {
            for turn in &paper.branches {
                let quarter = turn.quarter_turn;
                claims.claim(
                    format!("kL in {}: sign s along a record", turn.interval),
                    "1",
                    turn.s,
                    Within(0.5, "an integer"),
                    of(&counted, |counted| {
                        counted.in_quarter(quarter, |branch| f64::from(branch.sign()))
                    }),
                );
                claims.claim(
                    format!("kL in {}: half waves n along a record", turn.interval),
                    "1",
                    turn.n,
                    Within(0.5, "an integer"),
                    of(&counted, |counted| {
                        counted.in_quarter(quarter, |branch| f64::from(branch.half_waves()))
                    }),
                );
            }
        }
        Err(error) => claims.claim(
            "Table 1 can be read",
            "1",
            1.0,
            Within(0.5, "yes or no"),
            Err(error.into()),
        ),
    }
    claims.by("paper A, eqs. 3 and 4: cosh(gamma L) = Psi");
    claims.deviation(
        "closed form along a record without mass",
        Within(
            1e-10,
            "rounding of the transition matrix, amplified near kL = n pi",
        ),
        of(&counted, |counted| {
            let pairs = counted.roots.iter().zip(&counted.exact);
            largest(pairs.map(|(root, exact)| (root.gamma_length - exact).norm() / exact.norm()))
        }),
    );
    claims.by("paper A, eq. 4 (as printed, its differences lose digits)");
    claims.deviation(
        "closed form: damping of 1e-6 at kL from 0.3 to 9, away from n pi",
        Within(1e-9, "rounding of Psi, 1e-16, over the damping"),
        Ok(small_damping()),
    );
    hold!(claims);
}

/// Test 6 of Table 2 without accelerometer.
fn counted() -> Ours<Counted> {
    let paper = paper_a::load()?;
    let test = paper.tests.get(5).ok_or_else(|| missing("Test 6"))?;
    let law = ConstantQ::new(2.6e9, 0.07, TAU * 1e3)?;
    let medium = Medium::new(test.density, law)?;
    let specimen = Specimen {
        section: Circle::of_diameter(test.diameter)?.into(),
        length: test.length,
        accelerometer_mass: 0.0,
    };
    let rod = EndAccelerationTest::new(&medium, &specimen)?;
    let frequency_hz: Vec<f64> = (1..=240).map(|j| 20.0 * f64::from(j)).collect();
    let ratio = frequency_hz
        .iter()
        .map(|f| rod.acceleration_ratio(TAU * f))
        .collect::<Result<Vec<_>, _>>()?;
    let exact = |f: &f64| medium.propagation_coefficient(TAU * f) * test.length;
    Ok(Counted {
        roots: resolve(&frequency_hz, &ratio)?,
        exact: frequency_hz.iter().map(exact).collect(),
    })
}

fn small_damping() -> f64 {
    let damping = 1e-6;
    largest((0..30).map(|j| {
        let angle = 0.3 + 0.3 * f64::from(j);
        if angle.sin().abs() < 0.1 {
            return 0.0;
        }
        let quarter = (0..8)
            .filter(|q| f64::from(*q + 1) * FRAC_PI_2 <= angle)
            .count();
        let branch = Branch::in_quadrant(u32::try_from(quarter).unwrap_or(u32::MAX));
        // cosh and sinh of 1e-6 to all digits
        let ratio = Complex64::new(
            (1.0 + 0.5 * damping * damping) * angle.cos(),
            damping * angle.sin(),
        );
        (FreeEndRoot::of(ratio).on(branch).re / damping - 1.0).abs()
    }))
}
