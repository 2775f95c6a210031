//! Responses and coherences as a universal file, for other programs.

use labio::{Abscissa, Contents, Ordinate, Quantity, Series, SeriesKind};

use super::estimate::Estimated;
use crate::RodlabError;
use crate::outcome::Attachment;
use crate::universal::{self, axis, property};

/// `frf.uff` with the response to every output, and the coherence of every test.
pub(super) fn attachment(
    estimated: &[(String, Estimated)],
    input: &str,
    title: &str,
) -> Result<Attachment, RodlabError> {
    let mut contents = Contents::of_format("rodlab");
    for (output, one) in estimated {
        let response = &one.response;
        let frequency = &response.frequency_hz;
        // a line at 0 Hz that is not defined is not written: few programs read what is no number
        let first = usize::from(response.invalid_lines().next() == Some(0));
        let step = frequency.get(1).copied().unwrap_or(f64::NAN);
        let abscissa = |first: usize| Abscissa::Even {
            start: first as f64 * step,
            step,
        };
        let (input_quantity, output_quantity) =
            (response.input.quantity(), response.output.quantity());
        contents.series.push(Series {
            name: output.clone(),
            kind: if input_quantity == output_quantity {
                SeriesKind::Transmissibility
            } else {
                SeriesKind::FrequencyResponse
            },
            abscissa: abscissa(first),
            ordinate: Ordinate::Complex(response.values.iter().skip(first).copied().collect()),
            abscissa_axis: axis("Frequency", "Hz"),
            ordinate_axis: axis(output_quantity.name(), unit(output_quantity)),
            properties: vec![
                property("id2", title),
                property("id4", &format!("response of {output} over {input}")),
                property("response_node", "2"),
                property("response_direction", "1"),
                property("reference_node", "1"),
                property("reference_direction", "1"),
                property("denominator_label", input_quantity.name()),
                property("denominator_unit", unit(input_quantity)),
            ],
        });
        for (number, coherence) in one.coherences.iter().enumerate() {
            contents.series.push(Series {
                name: output.clone(),
                kind: SeriesKind::Coherence,
                abscissa: abscissa(0),
                ordinate: Ordinate::Real(coherence.values.clone()),
                abscissa_axis: axis("Frequency", "Hz"),
                ordinate_axis: axis("coherence", ""),
                properties: vec![
                    property("id2", title),
                    property(
                        "id4",
                        &format!("coherence of {output} over {input}, test {}", number + 1),
                    ),
                ],
            });
        }
    }
    universal::attachment(&contents, "frf.uff")
}

/// The unit in text; a pure number has none.
fn unit(quantity: Quantity) -> &'static str {
    match quantity.unit() {
        "1" => "",
        unit => unit,
    }
}
