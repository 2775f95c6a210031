//! Figures and tables of virtual records: histories and their spectra.

use labio::{AveragedSpectra, Record, Window};
use rodfigure::{Figure, Mark, Panel, Role};

use crate::outcome::Table;
use crate::{InStep, RodlabError};

/// Returns the number of drawn units per SI unit of a quantity, and the drawn unit.
fn shown(quantity: labio::Quantity) -> (f64, &'static str) {
    match quantity {
        labio::Quantity::Strain => (1e6, "µm/m"),
        labio::Quantity::Displacement => (1e3, "mm"),
        other => (1.0, other.unit()),
    }
}

/// Figure of the histories of all channels; at most five records are drawn, as separate lines.
pub(super) fn histories(records: &[Record], names: &[String]) -> Option<Figure> {
    let first = records.first()?;
    let panels = first
        .channels()
        .iter()
        .map(|channel| {
            let (factor, unit) = shown(channel.quantity());
            let marks = records
                .iter()
                .zip(names)
                .take(5)
                .enumerate()
                .filter_map(|(index, (record, name))| {
                    let samples = record.channel(channel.name()).ok()?;
                    let samples = samples.iter().enumerate();
                    let points = samples.map(|(k, v)| (1e3 * record.time_at(k), factor * v));
                    Some(Mark::line(name, Role::of_series(index), points))
                })
                .collect();
            let label = format!("{}, {}", channel.quantity().name(), channel.name());
            Panel::new(("time", "ms"), (label, unit), marks)
        })
        .collect();
    Some(
        Figure::new("histories", "Virtual records", panels)
            .with_caption("As recorded, with the noise of the instruments; five records at most."),
    )
}

/// Figure of the magnitudes of the spectra of the first record: √(G_xx) of each channel, relative
/// to its largest line.
pub(super) fn spectra(records: &[Record], cutoff_hz: f64) -> Result<Option<Figure>, RodlabError> {
    let Some(first) = records.first() else {
        return Ok(None);
    };
    let spectra =
        AveragedSpectra::of([first], Window::Rectangular).in_step("spectra of the records")?;
    let mut marks = Vec::new();
    for (index, channel) in first.channels().iter().enumerate() {
        let auto = spectra
            .auto(channel.name())
            .in_step("spectra of the records")?;
        let largest = auto.iter().skip(1).fold(0.0_f64, |a, b| a.max(*b));
        let lines = spectra.frequency_hz().iter().zip(&auto).skip(1);
        let points = lines.map(|(f, g)| (1e-3 * f, 10.0 * (g / largest).log10()));
        marks.push(Mark::line(channel.name(), Role::of_series(index), points));
    }
    marks.push(Mark::at("cut-off of the filter", 1e-3 * cutoff_hz));
    let panel = Panel::new(("frequency", "kHz"), ("auto-spectrum", "dB"), marks);
    Ok(Some(
        Figure::new("spectra", "Spectra of the first record", vec![panel])
            .with_caption("Each channel relative to its largest line."),
    ))
}

pub(super) fn table(records: &[Record]) -> Option<Table> {
    let first = records.first()?;
    let time = (0..first.n_samples()).map(|k| first.time_at(k));
    let mut table = Table::new("first-record", "First record").numbers("time", "s", time);
    for channel in first.channels() {
        let samples = first.channel(channel.name()).ok()?;
        table = table.numbers(channel.name(), channel.quantity().unit(), samples);
    }
    Some(table)
}
