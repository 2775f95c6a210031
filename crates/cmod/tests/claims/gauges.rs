//! Three gauges and more on the bar of paper B, in its structures and dismounted.

use std::f64::consts::TAU;

use cmod::multi_point::{MultiPointEstimate, Quantity};
use cmod::validity::AcceptanceLimits;
use cmod::{GaugeSpectra, GaugedRod, ModulusEstimate, MultiPoint, ThreePoint};
use num_complex::Complex64;
use rodwave::chain::Termination;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::HalfSine;
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use testbed::claim::{Claims, Ours, Within, missing};
use testbed::difference::largest;
use testbed::hold;

const DENSITY: f64 = 919.0;
const DIAMETER: f64 = 0.016;
pub(super) const THREE: [f64; 3] = [0.3, 0.4, 0.5];
pub(super) const FIVE: [f64; 5] = [0.2, 0.27, 0.4, 0.45, 0.6];

pub(super) type Strains = Vec<Vec<Complex64>>;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Structure {
    /// Two cantilever beams.
    I,
    /// The same with a lump at the right end, of 0.1 kg: the paper gives no mass.
    II,
    Dismounted,
}

pub(super) const STRUCTURES: [(&str, Structure); 3] = [
    ("structure I", Structure::I),
    ("structure II", Structure::II),
    ("dismounted", Structure::Dismounted),
];

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    without_noise(claims);
    waves(claims);
    hold!(claims);
}

pub(super) fn polypropylene() -> Ours<Medium<ConstantQ>> {
    Ok(Medium::new(DENSITY, ConstantQ::new(2.6e9, 0.07, 1e4)?)?)
}

/// Strains (n_gauges)(n_lines) of the bar, 800 mm long, struck by a half sine of 50 N and 0.1 ms.
pub(super) fn strains(
    structure: Structure,
    positions: &[f64],
    frequency_hz: &[f64],
) -> Ours<Strains> {
    let beam = EndSupport::PAPER_B_BEAM;
    let (left, right) = match structure {
        Structure::I => (beam.termination(), beam.termination()),
        Structure::II => (beam.termination(), beam.with_lump(0.1).termination()),
        Structure::Dismounted => (Termination::Free, Termination::Free),
    };
    let section = Circle::of_diameter(DIAMETER)?;
    let member = FrameMember::new(&polypropylene()?, section, 0.8, positions, right)?
        .with_left_structure(left)?;
    let blow = HalfSine::new(50.0, 1e-4)?;
    let omegas: Vec<f64> = frequency_hz.iter().map(|f| TAU * f).collect();
    Ok(member.strain_spectra(&Excitation::Force(&blow), &omegas)?)
}

pub(super) fn rod(positions: &[f64]) -> GaugedRod {
    GaugedRod {
        positions: positions.to_vec(),
        diameter: DIAMETER,
        density: DENSITY,
    }
}

pub(super) fn lines(first: f64, step: f64, count: u32) -> Vec<f64> {
    (0..count).map(|j| first + step * f64::from(j)).collect()
}

pub(super) fn flat(noise: &[f64], count: usize) -> Vec<Vec<f64>> {
    noise.iter().map(|&noise| vec![noise; count]).collect()
}

/// By three gauges in closed form.
pub(super) fn by_three(
    frequency_hz: &[f64],
    strains: &Strains,
    noise: &[Vec<f64>],
) -> Ours<ModulusEstimate> {
    Ok(ThreePoint::new(rod(&THREE))?
        .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
        .estimate(&GaugeSpectra {
            frequency_hz,
            tests: &[strains],
            noise,
        })?)
}

/// By least squares over tests.
pub(super) fn by_least_squares(
    positions: &[f64],
    frequency_hz: &[f64],
    tests: &[Strains],
    noise: &[Vec<f64>],
    limits: AcceptanceLimits,
) -> Ours<MultiPointEstimate> {
    let tests: Vec<&[Vec<Complex64>]> = tests.iter().map(Vec::as_slice).collect();
    Ok(MultiPoint::new(rod(positions))?
        .with_limits(limits)?
        .estimate(&GaugeSpectra {
            frequency_hz,
            tests: &tests,
            noise,
        })?)
}

/// Largest relative error of γ; infinite if lines are missing.
fn worst(estimate: &ModulusEstimate, lines: usize) -> Ours {
    let medium = polypropylene()?;
    if estimate.lines().len() != lines {
        return Ok(f64::INFINITY);
    }
    Ok(largest(estimate.lines().iter().map(|line| {
        let exact = medium.propagation_coefficient(TAU * line.frequency_hz);
        (line.propagation_coefficient - exact).norm() / exact.norm()
    })))
}

fn without_noise(claims: &mut Claims) {
    let frequency_hz = lines(50.0, 50.0, 200);
    let within = Within(
        1e-9,
        "strains of 1e-12, magnified up to 1000-fold at low frequency and nodes",
    );
    claims.by("paper B, eqs. 6 to 9: three gauges in closed form, any ends");
    for (name, structure) in STRUCTURES {
        let found = || -> Ours {
            let strains = strains(structure, &THREE, &frequency_hz)?;
            worst(
                &by_three(&frequency_hz, &strains, &flat(&[0.0; 3], 200))?,
                200,
            )
        };
        claims.deviation(
            format!("three gauges, {name}: propagation coefficient, 50 Hz to 10 kHz"),
            within,
            found(),
        );
    }
    claims.by("least squares over five gauges, any ends");
    for (name, structure) in STRUCTURES {
        let found = || -> Ours {
            let tests = [strains(structure, &FIVE, &frequency_hz)?];
            let noise = flat(&[0.0; 5], 200);
            let estimate = by_least_squares(
                &FIVE,
                &frequency_hz,
                &tests,
                &noise,
                AcceptanceLimits::ONE_DIMENSIONAL,
            )?;
            worst(estimate.modulus(), 200)
        };
        claims.deviation(
            format!("five gauges, {name}: propagation coefficient, 50 Hz to 10 kHz"),
            within,
            found(),
        );
    }
}

/// A free end sends back a wave of strain that cancels the incident one.
fn waves(claims: &mut Claims) {
    claims.by("paper B, eq. 4; no force at a free end");
    let frequency_hz = lines(300.0, 100.0, 50);
    let positions = [0.2, 0.29, 0.5, 0.55];
    let sum = || -> Ours {
        let tests = [strains(Structure::Dismounted, &positions, &frequency_hz)?];
        let found = by_least_squares(
            &positions,
            &frequency_hz,
            &tests,
            &flat(&[1e-9; 4], 50),
            AcceptanceLimits::ONE_DIMENSIONAL,
        )?;
        let mut worst = 0.0_f64;
        for index in 0..frequency_hz.len() {
            let end = found
                .waves(index, 0, 0.8, Quantity::Strain)
                .ok_or_else(|| missing("the waves of a line"))?;
            worst = worst.max(end.sum().norm() / end.forward.norm());
        }
        Ok(worst)
    };
    claims.deviation(
        "dismounted bar: sum of both waves of strain at the free end by the incident one",
        Within(
            1e-8,
            "strains of 1e-12, magnified at low frequency and nodes",
        ),
        sum(),
    );
}
