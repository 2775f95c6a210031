//! Ratio of spectra in a universal file, for this and other programs.

use labio::{Abscissa, Contents, Ordinate, ResponseRatio, Series, SeriesKind};

use super::Found;
use crate::RodlabError;
use crate::outcome::Attachment;
use crate::universal::{self, axis, property};

/// Largest relative deviation of the line spacing that counts as even.
const EVEN: f64 = 1e-9;

/// Returns the file `ratio.uff` with the ratio and its coherence; `None` if the ratio is not one of
/// equal quantities, or its lines are not evenly spaced or not all finite.
pub(super) fn attachment(found: &Found<'_>) -> Result<Option<Attachment>, RodlabError> {
    let method = &found.sheet.method;
    let Some(ratio) = found.ratio().filter(|_| method.one_quantity()) else {
        return Ok(None);
    };
    let Some(abscissa) = even(ratio) else {
        return Ok(None);
    };
    let words = method.ratio_in_words()?;
    let mut contents = Contents::of_format("rodlab");
    let mut series = |name: &str, kind, ordinate| {
        contents.series.push(Series {
            name: name.to_owned(),
            kind,
            abscissa: abscissa.clone(),
            ordinate,
            abscissa_axis: axis("Frequency", "Hz"),
            ordinate_axis: axis(name, ""),
            properties: vec![
                property("id2", &found.sheet.title),
                property("id4", &format!("{name}: {words}")),
            ],
        });
    };
    series(
        "ratio",
        SeriesKind::Transmissibility,
        Ordinate::Complex(ratio.values.clone()),
    );
    if let Some(coherence) = &ratio.coherence {
        series(
            "coherence",
            SeriesKind::Coherence,
            Ordinate::Real(coherence.clone()),
        );
    }
    universal::attachment(&contents, "ratio.uff").map(Some)
}

/// Returns the frequencies as start and step; `None` if they are not evenly spaced, or a value of
/// the ratio is not finite.
fn even(ratio: &ResponseRatio) -> Option<Abscissa> {
    let frequency = &ratio.frequency_hz;
    let (first, last) = (*frequency.first()?, *frequency.last()?);
    let step = (last - first) / (frequency.len().checked_sub(1).filter(|n| *n > 0)? as f64);
    let is_even = frequency
        .iter()
        .enumerate()
        .all(|(index, f)| (f - (first + index as f64 * step)).abs() <= EVEN * last);
    let finite = ratio.values.iter().all(|value| value.is_finite());
    (is_even && finite).then_some(Abscissa::Even { start: first, step })
}
