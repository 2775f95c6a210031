//! The same impacts by `rodwave::line`: characteristics in the time domain, which know nothing of mobilities.

use std::f64::consts::FRAC_PI_4;

use impulse::{Impact, Prediction};
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::inelastic::{Elastic as Spring, Maxwell};
use rodwave::line::{Body, Line, LineHistory, Segment};
use rodwave::medium::Medium;
use rodwave::modulus::Zener;

use super::bodies::{STEEL_DENSITY, STEEL_MODULUS, steel, wave_speed};
use testbed::claim::{Claims, Ours, Within, of};
use testbed::difference::largest;
use testbed::hold;

const VELOCITY: f64 = 3.0;
const DURATION: f64 = 1.2e-3;
const DENSITY: f64 = 1150.0;
const RELAXED: f64 = 2.2e9;
const UNRELAXED: f64 = 2.8e9;
const RELAXATION_TIME: f64 = 60e-6;

#[derive(Clone, Copy)]
enum Material {
    Zener,
    Steel,
}

/// From the impact face.
#[derive(Clone, Copy)]
struct Piece {
    material: Material,
    length: f64,
    diameter: f64,
}

/// An impact by both.
struct Both {
    predicted: Prediction,
    /// N
    by_line: Vec<f64>,
    /// s
    step: f64,
}

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims.by("method of characteristics in the time domain, rodwave::line");
    // transit times in whole microseconds: the line then changes no wave speed
    let steel = 1e-6 * wave_speed();
    let zener = 1e-6 * (UNRELAXED / DENSITY).sqrt();
    let piece = |material, length, diameter| Piece {
        material,
        length,
        diameter,
    };
    let rod = [piece(Material::Zener, 0.35, 0.020)];
    let head_and_tail = [
        piece(Material::Steel, 5.0 * steel, 0.008),
        piece(Material::Zener, 40.0 * zener, 0.016),
        piece(Material::Steel, 15.0 * steel, 0.024),
    ];
    let struck = |length| piece(Material::Steel, length, 0.016);
    for (name, found, contacts) in [
        ("Zener rod on a steel rod", both(&rod, struck(2.0)), 1.0),
        (
            "light head before a heavy tail",
            both(&head_and_tail, struck(400.0 * steel)),
            2.0,
        ),
    ] {
        claims.deviation(
            format!("{name}: force away from jumps, by the peak"),
            Within(5e-3, "kinks of the kernel, smeared over two steps"),
            of(&found, away_from_jumps),
        );
        claims.claim(
            format!("{name}: impulse over that by the line"),
            "1",
            1.0,
            Within(1e-3, "half a step at each parting"),
            of(&found, |both| {
                both.predicted.balance().impulse / (both.by_line.iter().sum::<f64>() * both.step)
            }),
        );
        claims.claim(
            format!("{name}: contacts of more than ten steps"),
            "1",
            contacts,
            Within(0.5, "a count"),
            of(&found, |both| {
                let contacts = both.predicted.contacts.iter();
                let long = contacts.filter(|contact| {
                    contact.end.unwrap_or(DURATION) - contact.begin > 10.0 * both.step
                });
                long.count() as f64
            }),
        );
    }
    hold!(claims);
}

fn both(striker: &[Piece], rod: Piece) -> Ours<Both> {
    let line = by_line(striker, rod)?;
    let step = line.grid.time_step;
    Ok(Both {
        predicted: by_mobilities(striker, rod, step)?,
        by_line: line.contacts[0].force.clone(),
        step,
    })
}

fn by_mobilities(striker: &[Piece], rod: Piece, step: f64) -> Ours<Prediction> {
    let zener = Medium::new(DENSITY, Zener::new(RELAXED, UNRELAXED, RELAXATION_TIME)?)?;
    let steel = steel()?;
    let chain = |pieces: &[Piece]| -> Ours<AnalyticChain> {
        let mut builder = AnalyticChain::analytic_from_impact_face();
        for piece in pieces {
            let section = Circle::of_diameter(piece.diameter)?;
            builder = match piece.material {
                Material::Zener => builder.rod(&zener, section, piece.length),
                Material::Steel => builder.rod(&steel, section, piece.length),
            };
        }
        Ok(builder.end(Termination::Free)?)
    };
    let (first, second) = (chain(striker)?, chain(&[rod])?);
    Ok(Impact::between(&first, &second)
        .at_velocity(VELOCITY)
        .in_steps_of(step)
        .predict(DURATION)?)
}

fn by_line(striker: &[Piece], rod: Piece) -> Ours<LineHistory> {
    let segment = |piece: &Piece| -> Ours<Segment> {
        let area = FRAC_PI_4 * piece.diameter.powi(2);
        Ok(match piece.material {
            Material::Steel => Segment::elastic(piece.length, area, STEEL_DENSITY, STEEL_MODULUS)?,
            Material::Zener => {
                let step = UNRELAXED - RELAXED;
                Segment::new(piece.length, area, DENSITY)?
                    .with_branch(RELAXED, Spring)?
                    .with_branch(step, Maxwell::new(step * RELAXATION_TIME)?)?
            }
        })
    };
    // the impact face is the right end of the left body
    let segments = striker
        .iter()
        .rev()
        .map(segment)
        .collect::<Ours<Vec<_>>>()?;
    let striker = Body::new(segments)?.moving_at(VELOCITY)?;
    let struck = Body::new([segment(&rod)?])?;
    Ok(Line::new([striker, struck])?.run(0.25e-6, DURATION, &[])?)
}

/// Without two samples around each jump of either history.
fn away_from_jumps(both: &Both) -> f64 {
    let (found, reference) = (both.predicted.history.force(), &both.by_line);
    let peak = reference.iter().copied().fold(0.0, f64::max);
    let change = |force: &[f64], m: usize| match (force.get(m), force.get(m + 1)) {
        (Some(a), Some(b)) => (a - b).abs(),
        _ => 0.0,
    };
    let smooth = |n: &usize| {
        (n.saturating_sub(2)..n + 2)
            .all(|m| change(reference, m).max(change(found, m)) <= 0.005 * peak)
    };
    largest(
        (0..found.len().min(reference.len()))
            .filter(smooth)
            .map(|n| (found[n] - reference[n]).abs() / peak),
    )
}
