//! Impacts compared with `rodwave::line`, which uses characteristics in the time domain, without
//! mobilities.

use std::f64::consts::FRAC_PI_4;

use impulse::{Impact, Prediction};
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::inelastic::{Elastic as Spring, Maxwell};
use rodwave::line::{Body, Line, LineHistory, Segment};
use rodwave::medium::Medium;
use rodwave::modulus::Zener;

use crate::bodies::{STEEL_DENSITY, STEEL_MODULUS, steel, wave_speed};
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

/// A piece of a body; pieces are counted from the impact face.
#[derive(Clone, Copy)]
struct Piece {
    material: Material,
    length: f64,
    diameter: f64,
}

/// An impact computed by both methods.
struct Both {
    predicted: Prediction,
    /// Force from `rodwave::line` \[N\].
    by_line: Vec<f64>,
    /// Time step \[s\].
    step: f64,
}

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims.by("method of characteristics in the time domain, rodwave::line");
    // transit times in whole microseconds, so that `Line` adjusts no wave speed
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
    let found = || -> Ours<[Both; 2]> {
        let rod = both(&rod, struck(2.0))?;
        Ok([rod, both(&head_and_tail, struck(400.0 * steel))?])
    };
    let found = found();
    claims.deviation(
        "Zener rod, and light head before a heavy tail, on a steel rod: force away from jumps, relative to the peak",
        Within(5e-3, "kinks of the kernel, smeared over two steps"),
        of(&found, |found| largest(found.iter().map(away_from_jumps))),
    );
    claims.deviation(
        "Zener rod, and light head before a heavy tail, on a steel rod: impulse over that of `rodwave::line`, minus 1",
        Within(2e-6, "half a sample of the lowest force at each parting"),
        of(&found, |found| {
            let by_line = |both: &Both| both.by_line.iter().sum::<f64>() * both.step;
            let impulse = |both: &Both| both.predicted.balance().impulse;
            largest(found.iter().map(|both| impulse(both) / by_line(both) - 1.0))
        }),
    );
    claims.claim(
        "Zener rod once, light head before a heavy tail twice: contacts of more than ten steps",
        "contacts of both",
        3.0,
        Within(0.0, "exact"),
        of(&found, |found| {
            let long = found.each_ref().map(|both| {
                let contacts = both.predicted.contacts.iter();
                let lasts = |contact: &impulse::ContactInterval| {
                    contact.end.unwrap_or(DURATION) - contact.begin
                };
                contacts
                    .filter(|contact| lasts(contact) > 10.0 * both.step)
                    .count()
            });
            assert_eq!(long, [1, 2]);
            (long[0] + long[1]) as f64
        }),
    );
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
    let steel = steel();
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

/// Largest difference of the two histories, relative to the peak. Two samples on either side of
/// each jump of either history are excluded.
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
    let all = found.len().min(reference.len());
    let compared: Vec<usize> = (0..all).filter(smooth).collect();
    // at most five samples are excluded per echo; the short head has an echo every 10 us, 120 in
    // 1.2 ms, so that at most 600 samples are excluded
    assert!(all - compared.len() < 600, "{} of {all}", compared.len());
    largest(
        compared
            .into_iter()
            .map(|n| (found[n] - reference[n]).abs() / peak),
    )
}
