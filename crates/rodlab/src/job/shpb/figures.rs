//! Figures of a shot: waves with their windows, forces and equilibrium, stress and strain.

use impulse::hopkinson::{Curve, HopkinsonRecord, HopkinsonResult, HopkinsonTest, MeanCurve};
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::tables::{band, band_of_mean, microseconds, scaled};
use crate::{InStep, RodlabError};

/// Smallest amplification of a wave on its way to a face for which the curve with elastic bars is
/// also drawn.
const VISIBLE_AMPLIFICATION: f64 = 1.01;

pub(super) fn all(
    result: &HopkinsonResult,
    test: &HopkinsonTest,
    record: &HopkinsonRecord,
) -> Result<Vec<Figure>, RodlabError> {
    Ok(vec![
        stress_strain(result, &as_elastic(result, test, record))?,
        forces(result)?,
        waves(result, record),
        fronts(result, test, record)?,
    ])
}

/// Returns the band with half width `half` about a curve.
pub(super) fn around(name: &str, role: Role, x: &[f64], y: &[f64], half: &[f64]) -> Mark {
    let edges = x.iter().zip(y).zip(half);
    Mark::band(
        name,
        role,
        edges.map(|((x, y), half)| (*x, y - half, y + half)),
    )
}

/// Returns strain \[%\] and stress \[MPa\] from the same records with bars that are treated as
/// elastic, although they attenuate; `None` if the difference is not visible.
fn as_elastic(
    result: &HopkinsonResult,
    test: &HopkinsonTest,
    record: &HopkinsonRecord,
) -> Option<(Vec<f64>, Vec<f64>)> {
    if result.amplification < VISIBLE_AMPLIFICATION {
        return None;
    }
    let middle = 0.3 * result.band_hz;
    let [incident, transmitted] = &test.bars;
    let elastic = HopkinsonTest {
        bars: [
            incident.as_elastic(middle).ok()?,
            transmitted.as_elastic(middle).ok()?,
        ],
        band_hz: Some(result.band_hz),
        monte_carlo: None,
        variations: Vec::new(),
        ..test.clone()
    };
    // the comparison is not part of the answer; if it fails, the figure has one curve less
    let other = elastic
        .evaluate(record, &mut ChaCha8Rng::seed_from_u64(0))
        .ok()?;
    let of = |curve, unit| {
        let values = other.curves.of(curve).get(..other.loaded.end)?;
        Some(scaled(values, unit))
    };
    Some((of(Curve::Strain, 100.0)?, of(Curve::Stress, 1e-6)?))
}

fn stress_strain(
    result: &HopkinsonResult,
    as_elastic: &Option<(Vec<f64>, Vec<f64>)>,
) -> Result<Figure, RodlabError> {
    let loaded = result.loaded.clone();
    let of = |values: Vec<f64>| values.get(..loaded.end).map_or(Vec::new(), <[f64]>::to_vec);
    let strain = of(scaled(result.curves.of(Curve::Strain), 100.0));
    let stress = of(scaled(result.curves.of(Curve::Stress), 1e-6));
    let (held, band_of_stress) = match MeanCurve::of(std::slice::from_ref(result)) {
        Ok(curve) => (
            "at a given strain, errors of the strain included, up to the largest strain",
            around(
                "95 % band",
                Role::First,
                &scaled(&curve.strain, 100.0),
                &scaled(&curve.stress, 1e-6),
                &scaled(&band_of_mean(&curve)?, 1e-6),
            ),
        ),
        // the strain rises on too few samples for a band over strain
        Err(_) => (
            "at its time",
            around(
                "95 % band",
                Role::First,
                &strain,
                &stress,
                &of(band(result, Curve::Stress, 1e-6)?),
            ),
        ),
    };
    let mut marks = vec![
        band_of_stress,
        Mark::curve("stress", Role::First, &strain, stress),
    ];
    let mut compared = "";
    if let Some((strain, stress)) = as_elastic {
        marks.push(Mark::curve(
            "bars assumed elastic",
            Role::Reference,
            strain,
            stress.clone(),
        ));
        compared = " The grey line is the result from the same records if the bars are assumed elastic, with their wave speed in the middle of the band.";
    }
    let rate = of(result.curves.of(Curve::StrainRate).to_vec());
    let rate_half = of(band(result, Curve::StrainRate, 1.0)?);
    let title = "Stress and strain rate over strain";
    let rates = vec![
        around("95 % band", Role::Second, &strain, &rate, &rate_half),
        Mark::curve("strain rate", Role::Second, &strain, rate),
    ];
    let panels = vec![
        Panel::new(("strain", "%"), ("stress", "MPa"), marks),
        Panel::new(("strain", "%"), ("strain rate", "1/s"), rates),
    ];
    Ok(Figure::new("stress_strain", title, panels).with_caption(format!(
        "Engineering values up to the end of the loading. The band contains the stress with a probability of 95 % {held}. The band of the strain rate contains a single value at its time with the same probability.{compared}"
    )))
}

fn forces(result: &HopkinsonResult) -> Result<Figure, RodlabError> {
    let time = microseconds(result);
    let mut marks = Vec::new();
    for (name, role, curve) in [
        ("incident face", Role::First, Curve::Force1),
        ("transmitted face", Role::Second, Curve::Force2),
    ] {
        let force = result.curves.of(curve);
        marks.push(around("", role, &time, force, &band(result, curve, 1.0)?));
        marks.push(Mark::curve(name, role, &time, force.to_vec()));
    }
    let equilibrium = &result.equilibrium;
    let mut index = vec![
        around(
            "two standard errors",
            Role::First,
            &time,
            &equilibrium.index,
            &scaled(&equilibrium.standard_error, 2.0),
        ),
        Mark::curve("index", Role::First, &time, equilibrium.index.clone()),
    ];
    if let Some(from) = equilibrium.from {
        index.push(Mark::at("equilibrium", 1e6 * from));
    }
    let of_index = Axis::linear("equilibrium index", "").within([-0.5, 0.5]);
    let panels = vec![
        Panel::new(("time", "us"), ("force", "N"), marks),
        Panel::new(("time", "us"), of_index, index),
    ];
    Ok(Figure::new(
        "forces",
        "Forces of both faces, and the equilibrium index",
        panels,
    )
    .with_caption(
        "The index is the difference of the forces over their mean, where the specimen is loaded; in equilibrium it is at most 0.05.",
    ))
}

fn waves(result: &HopkinsonResult, record: &HopkinsonRecord) -> Figure {
    let mut panels = Vec::new();
    let windows = [("incident", 0), ("reflected", 1), ("transmitted", 2)];
    for (bar, gauges) in record.gauges.iter().enumerate() {
        let mut marks = Vec::new();
        for (at, strain) in gauges.iter().enumerate() {
            let time: Vec<f64> = (0..strain.len())
                .map(|n| 1e6 * n as f64 / record.rate_hz)
                .collect();
            let name = format!("gauge {}", at + 1);
            marks.push(Mark::curve(
                &name,
                Role::of_series(at),
                &time,
                scaled(strain, 1e6),
            ));
        }
        for (name, window) in windows {
            if (window == 2) == (bar == 1)
                && gauges.len() == 1
                && let Some([from, to]) = result.windows.get(window)
            {
                for (edge, x) in [("begins", from), ("ends", to)] {
                    marks.push(Mark::at(format!("{name} {edge}"), 1e6 * x));
                }
            }
        }
        let name = if bar == 0 {
            "incident bar"
        } else {
            "transmitted bar"
        };
        let strain = (format!("strain of the {name}"), "µm/m");
        panels.push(Panel::new(("time", "us"), strain, marks));
    }
    Figure::new("waves", "Strains of the bars", panels).with_caption(
        "As recorded, positive in tension. On a bar with one gauge, the windows of the pulses are marked.",
    )
}

/// Figure of the fronts of the waves over position and time, with the gauges. It shows where waves
/// overlap.
fn fronts(
    result: &HopkinsonResult,
    test: &HopkinsonTest,
    record: &HopkinsonRecord,
) -> Result<Figure, RodlabError> {
    let [incident, reflected, transmitted] = result.arrivals;
    let n_samples = record.gauges.iter().flatten().map(Vec::len).max();
    let end = n_samples.unwrap_or(0) as f64 / record.rate_hz;
    let mut marks = Vec::new();
    for (at, (bar, sign)) in test.bars.iter().zip([-1.0, 1.0]).enumerate() {
        let speed = bar
            .phase_velocity(0.3 * result.band_hz)
            .in_step("figure of the fronts")?;
        let length = bar.length.value;
        let (of_wave, away) = if at == 0 {
            (incident, reflected)
        } else {
            (transmitted, transmitted)
        };
        let Some((arrived, left)) = of_wave.zip(away).map(|(a, b)| (a.time, b.time)) else {
            continue;
        };
        let mut x = Vec::new();
        let mut time = Vec::new();
        if at == 0 {
            x.push(sign * length);
            time.push(1e6 * (arrived - length / speed));
            x.push(0.0);
            time.push(1e6 * arrived);
        }
        // the front travels back and forth between specimen and end, until the record ends
        let mut here = (0.0, left);
        while here.1 < end {
            x.push(here.0);
            time.push(1e6 * here.1);
            let there = sign * length - here.0;
            here = (there, here.1 + length / speed);
        }
        if let Some((last, time_of_last)) = x.last().copied().zip(time.last().copied()) {
            let left = end - 1e-6 * time_of_last;
            let there = sign * length - last;
            x.push(last + (there - last) * speed * left / length);
            time.push(1e6 * end);
        }
        let (name, role) = [
            ("incident bar", Role::First),
            ("transmitted bar", Role::Second),
        ]
        .get(at)
        .copied()
        .unwrap_or(("", Role::First));
        marks.push(Mark::curve(name, role, &x, time));
        for gauge in &bar.gauges {
            marks.push(Mark::at(
                format!("gauge, {name}"),
                sign * gauge.distance.value,
            ));
        }
    }
    let panel = Panel::new(("distance from the specimen", "m"), ("time", "us"), marks);
    Ok(Figure::new(
        "fronts",
        "Fronts of the waves over position and time",
        vec![panel],
    )
    .with_caption(
        "The specimen is at 0; each line is the front of a wave that travels back and forth in a bar at the wave speed in the middle of the band. Waves overlap at a gauge where one arrives before the previous one has ended.",
    ))
}
