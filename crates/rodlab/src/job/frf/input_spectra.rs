//! Frequency range of the input: spectra of the hits and their mean.

use labio::{AveragedSpectra, Channel, Record, SpectrumAverager};
use ndarray::Axis as Dimension;
use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::estimate;
use super::sheet::FrfSheet;
use crate::{InStep, RodlabError};

/// Fraction of the maximum of the mean autospectrum at which the spectrum of the input ends; 0.01
/// is -20 dB.
const END: f64 = 0.01;
/// Maximum number of spectra of single hits in the figure.
const MOST_HITS: usize = 10;

const KHZ: f64 = 1e-3;

/// Figure of the spectra of the input.
pub(super) fn figure(
    sheet: &FrfSheet,
    hits: &[&Record],
    spectra: &AveragedSpectra,
    greyed: &[Greyed],
    name: &str,
    title: &str,
) -> Result<Figure, RodlabError> {
    let frequency: Vec<f64> = spectra.frequency_hz().iter().map(|f| f * KHZ).collect();
    let mut marks = Vec::new();
    let mut draw = |lines: &[f64], name: &str, role| {
        marks.push(Mark::curve(name, role, &frequency, lines.to_vec()));
    };
    let known = spectra.channels().iter().find(|c| c.name() == sheet.input);
    let unit = known.map_or("", |channel| channel.quantity().unit());
    for (index, hit) in hits.iter().take(MOST_HITS).enumerate() {
        let alone = only(hit, &sheet.input).in_step("spectra of the input")?;
        let mut averager: SpectrumAverager = estimate::averager(sheet, &[&alone])?;
        averager.add(&alone).in_step("spectra of the input")?;
        let lines = averager
            .spectra()
            .and_then(|spectra| spectra.auto(&sheet.input))
            .in_step("spectra of the input")?;
        let name = if index == 0 { "single hits" } else { "" };
        draw(&lines, name, Role::Faint);
    }
    draw(
        &spectra.auto(&sheet.input).in_step("spectra of the input")?,
        "mean",
        Role::First,
    );
    let density = Axis::logarithmic(
        format!("energy spectral density of {}", sheet.input),
        format!("({unit})^2 s/Hz"),
    );
    let panel = Panel::new(Axis::logarithmic("frequency", "kHz"), density, marks)
        .with_greyed(greyed.to_vec());
    Ok(Figure::new(name, title, vec![panel]).with_caption(format!(
        "Energy spectral density of `{}`: {}. Where it falls off, so do the coherence and the accuracy of the response.",
        sheet.input,
        match sheet.segments {
            None => format!("single accepted hits (at most {MOST_HITS}) and the mean of all"),
            Some(_) => "the mean of all segments".to_owned(),
        }
    )))
}

/// Returns the channel `name` of `record` alone.
fn only(record: &Record, name: &str) -> Result<Record, labio::LabioError> {
    let samples = record.channel(name)?.insert_axis(Dimension(0)).to_owned();
    let channels: Vec<Channel> = record
        .channels()
        .iter()
        .filter(|channel| channel.name() == name)
        .cloned()
        .collect();
    Record::new(
        samples,
        record.sampling_rate_hz(),
        record.start_time(),
        channels,
        record.provenance().clone(),
    )
}

/// Returns the highest frequency up to which the mean spectrum of the input stays within 20 dB of
/// its maximum.
pub(super) fn end_of(spectra: &AveragedSpectra, input: &str) -> Result<f64, RodlabError> {
    let lines = spectra.auto(input).in_step("spectra of the input")?;
    let greatest = lines.iter().copied().fold(0.0, f64::max);
    let peak = lines.iter().position(|x| x.total_cmp(&greatest).is_eq());
    let from = peak.unwrap_or(0);
    let mut falling = lines.iter().enumerate().skip(from);
    let end = falling.find(|(_, level)| **level < END * greatest);
    let frequency = spectra.frequency_hz();
    Ok(end
        .and_then(|(line, _)| frequency.get(line.saturating_sub(1)))
        .or(frequency.last())
        .copied()
        .unwrap_or(f64::NAN))
}
