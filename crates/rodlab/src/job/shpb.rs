//! Stress-strain curve of specimens between split Hopkinson bars, from one or several shots.

mod answer;
mod average;
mod bars;
mod figures;
mod sheet;
mod tables;

pub use sheet::{
    BarSheet, BarsSheet, FurtherShotSheet, ShpbGaugeSheet, ShpbSheet, ShpbSpecimenSheet,
    WaveSeparationSheet, WavesSheet,
};

use impulse::hopkinson::{BarGauge, HopkinsonRecord, HopkinsonTest, MeanCurve};
use labio::{Quantity, Record};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::JobContext;
use crate::bodies::material_sheet;
use crate::records::{Records, clipped, expect_quantity, expect_same_times};
use crate::{InStep, Outcome, RodlabError};

/// Seed of the draws of the noise, so that the same sheet gives the same digits.
const SEED: u64 = 1;

pub(crate) fn run(sheet: &ShpbSheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("shpb", sheet.title.as_str());
    outcome.settings = sheet.defaults();
    context.progress.begins("reading", 0);
    let sheet = &ShpbSheet {
        materials: material_sheet::read(&sheet.materials, context.folder, &mut outcome)?,
        ..sheet.clone()
    };
    let mut loaded = Vec::new();
    for (field, records, _) in sheet.shots() {
        loaded.push(load(&field, records, context, &mut outcome)?);
    }
    let mut shots = Vec::new();
    for ((field, _, specimen), loaded) in sheet.shots().zip(&loaded) {
        let (mut test, record) = of_sheet(sheet, &field, loaded)?;
        test.specimen = bars::specimen_of(specimen);
        shots.push((test, record));
    }
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;

    let mut results = Vec::new();
    for (at, (test, record)) in shots.iter().enumerate() {
        context.progress.begins("evaluating", 0);
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        match test.evaluate(record, &mut random) {
            Ok(result) => results.push(result),
            Err(
                error @ (impulse::ImpulseError::NoPulse { .. }
                | impulse::ImpulseError::TransmittedFirst { .. }),
            ) => {
                let reason = format!("{}{error}", answer::shot(at, shots.len()));
                outcome.deny("There is no stress-strain curve", reason);
                return Ok(outcome);
            }
            Err(error) => {
                let step = format!("evaluating the bars{}", answer::shot(at, shots.len()));
                return Err(RodlabError::step(step, error));
            }
        }
        context.check_cancelled()?;
    }
    let several = results.len() > 1;
    if several {
        let mean = MeanCurve::of(&results).in_step("the mean of the shots")?;
        average::state(&mut outcome, &results, &mean)?;
        outcome.tables.push(average::table(&mean)?);
        outcome.figures.push(average::figure(&results, &mean)?);
    }
    for (at, (result, (test, record))) in results.iter().zip(&shots).enumerate() {
        if !several {
            answer::state(&mut outcome, sheet, result)?;
        }
        let mut tables = tables::all(result)?;
        let mut figures = figures::all(result, test, record)?;
        if several {
            let names = tables
                .iter_mut()
                .map(|table| (&mut table.name, &mut table.title));
            let figures = figures
                .iter_mut()
                .map(|figure| (&mut figure.name, &mut figure.title));
            for (name, title) in names.chain(figures) {
                *name = format!("{name}_{}", at + 1);
                *title = format!("{title}, shot {}", at + 1);
            }
        }
        outcome.tables.append(&mut tables);
        outcome.figures.append(&mut figures);
        let shot = answer::shot(at, results.len());
        answer::monte_carlo(&mut outcome, result, sheet.monte_carlo, &shot);
        answer::findings(&mut outcome, result, &shot);
    }
    Ok(outcome)
}

/// Reads the records of one shot.
fn load(
    field: &str,
    records: &[Records],
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<Vec<Record>, RodlabError> {
    let mut loaded = Vec::new();
    for (at, records) in records.iter().enumerate() {
        let field = format!("{field}[{at}]");
        let found = records.load(context.folder, &field)?;
        match found.entered_in(outcome).as_slice() {
            [one] => {
                let channels: Vec<&str> = one.record.channels().iter().map(|c| c.name()).collect();
                outcome.doubt_all(clipped(&one.record, &channels, &field)?);
                loaded.push(one.record.clone());
            }
            several => {
                return Err(RodlabError::request(
                    format!("{field}.files"),
                    format!("{} records", several.len()),
                    "the record of one shot",
                ));
            }
        }
    }
    Ok(loaded)
}

/// Returns the test and its record.
fn of_sheet(
    sheet: &ShpbSheet,
    field: &str,
    loaded: &[Record],
) -> Result<(HopkinsonTest, HopkinsonRecord), RodlabError> {
    let first = loaded.first().ok_or_else(|| {
        RodlabError::request(field, "empty", "the records of the gauges of both bars")
    })?;
    for (at, other) in loaded.iter().enumerate().skip(1) {
        let (place, of_first) = (format!("{field}[{at}]"), format!("{field}[0]"));
        expect_same_times((other, &place), (first, &of_first))?;
    }
    let mut test = bars::test(sheet)?;
    let mut gauges = [Vec::new(), Vec::new()];
    let sides = [
        (&sheet.bars.incident, "incident"),
        (&sheet.bars.transmitted, "transmitted"),
    ];
    for ((bar, side), (gauges, of_test)) in
        sides.into_iter().zip(gauges.iter_mut().zip(&mut test.bars))
    {
        for (at, (gauge, of_test)) in bar.gauges.iter().zip(&mut of_test.gauges).enumerate() {
            let field = format!("bars.{side}.gauges[{at}].channel");
            gauges.push(mean(gauge, loaded, first, &field, of_test)?);
        }
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a duration above 0, and longer ones than the record are refused"
    )]
    let silent = (sheet.silent.si() * first.sampling_rate_hz()).floor() as usize;
    let record = HopkinsonRecord {
        rate_hz: first.sampling_rate_hz(),
        gauges,
        silent,
    };
    Ok((test, record))
}

/// Returns the mean of the channels of a gauge. The errors of their sensor chains are independent
/// of each other.
fn mean(
    gauge: &ShpbGaugeSheet,
    loaded: &[Record],
    first: &Record,
    field: &str,
    of_test: &mut BarGauge,
) -> Result<Vec<f64>, RodlabError> {
    let part = 1.0 / gauge.channels().count() as f64;
    let mut samples = vec![0.0; first.n_samples()];
    for (at, name) in gauge.channels().enumerate() {
        if gauge.channels().take(at).any(|earlier| earlier == name) {
            return Err(RodlabError::request(
                field,
                format!("`{name}` twice"),
                "different channels: otherwise a channel would be averaged with itself",
            ));
        }
        let has = |record: &&Record| {
            let mut channels = record.channels().iter();
            channels.any(|channel| channel.name() == name)
        };
        let record = loaded.iter().find(has).unwrap_or(first);
        expect_quantity(record, name, Quantity::Strain, field)?;
        for (sum, x) in samples.iter_mut().zip(record.channel(name).in_step(field)?) {
            *sum += part * x;
        }
        let sensor = record.sensor_error(name).in_step(field)?;
        let both = |sum: f64, own: f64| sum.hypot(part * own);
        of_test.factor_uncertainty = both(of_test.factor_uncertainty, sensor.gain);
        of_test.delay_uncertainty = both(of_test.delay_uncertainty, sensor.delay);
    }
    Ok(samples)
}
