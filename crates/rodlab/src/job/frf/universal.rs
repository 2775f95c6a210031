//! Responses and coherences in a universal file for other programs.

use labio::{Abscissa, Contents, Ordinate, Series, SeriesKind};

use super::Named;
use crate::RodlabError;
use crate::outcome::{Attachment, shown_unit};
use crate::responses::{AVERAGES, COMMON_ERROR, FREEDOM, MOST_FREEDOM, STANDARD_ERROR};
use crate::universal::{self, axis, property};

/// Returns the file `frf.uff` with the response of every output, and the coherence of every test.
pub(super) fn attachment(estimated: &[Named], title: &str) -> Result<Attachment, RodlabError> {
    let mut contents = Contents::of_format("rodlab");
    for Named {
        output,
        input,
        node,
        one,
    } in estimated
    {
        let name = &match one.multiple {
            None => output.clone(),
            Some(_) => format!("{output} over {input}"),
        };
        let response = &one.response;
        let frequency = &response.frequency_hz;
        // an undefined line at 0 Hz is not written, because few programs read NaN
        let first = usize::from(response.invalid_lines().next() == Some(0));
        let step = frequency.get(1).copied().unwrap_or(f64::NAN);
        let abscissa = |first: usize| Abscissa::Even {
            start: first as f64 * step,
            step,
        };
        let (input_quantity, output_quantity) =
            (response.input.quantity(), response.output.quantity());
        let units = (
            shown_unit(output_quantity.unit()),
            shown_unit(input_quantity.unit()),
        );
        let damped = if response.added_damping.is_some() {
            ", under an exponential window"
        } else {
            ""
        };
        contents.series.push(Series {
            name: name.clone(),
            kind: if input_quantity == output_quantity {
                SeriesKind::Transmissibility
            } else {
                SeriesKind::FrequencyResponse
            },
            abscissa: abscissa(first),
            ordinate: Ordinate::Complex(response.values.iter().skip(first).copied().collect()),
            abscissa_axis: axis("Frequency", "Hz"),
            ordinate_axis: axis(output_quantity.name(), units.0),
            properties: [
                property("id2", title),
                property("id3", &format!("{AVERAGES}{}", response.n_averages)),
                property("id4", &format!("response of {output} over {input}{damped}")),
                property("response_node", "2"),
                property("response_direction", "1"),
                property("reference_node", &node.to_string()),
                property("reference_direction", "1"),
                property("denominator_label", input_quantity.name()),
                property("denominator_unit", units.1),
            ]
            .into_iter()
            .chain(universal::damping(response.added_damping))
            .collect(),
        });
        let roots = response.variance.as_ref();
        let roots = roots.map(|variance| variance.iter().map(|v| v.sqrt()).collect());
        let freedom = response.degrees_of_freedom.as_ref();
        let freedom = freedom.map(|freedom| freedom.iter().map(|f| f.min(MOST_FREEDOM)).collect());
        for (what, note, (over, under), values) in [
            (
                STANDARD_ERROR,
                "root of the variance of the complex line",
                units,
                roots,
            ),
            (
                FREEDOM,
                "degrees of freedom of the standard error",
                ("", ""),
                freedom,
            ),
            (
                COMMON_ERROR,
                "relative standard uncertainty that lines share",
                ("", ""),
                response.common_error.clone(),
            ),
        ] {
            let Some(values): Option<Vec<f64>> = values else {
                continue;
            };
            contents.series.push(Series {
                name: format!("{name}{what}"),
                kind: SeriesKind::General,
                abscissa: abscissa(first),
                ordinate: Ordinate::Real(values.into_iter().skip(first).collect()),
                abscissa_axis: axis("Frequency", "Hz"),
                ordinate_axis: axis("", over),
                properties: vec![
                    property("id2", title),
                    property("id4", note),
                    property("denominator_unit", under),
                ],
            });
        }
        for (number, coherence) in one.coherences.iter().enumerate() {
            contents.series.push(Series {
                name: name.clone(),
                kind: SeriesKind::Coherence,
                abscissa: abscissa(0),
                ordinate: Ordinate::Real(coherence.values.clone()),
                abscissa_axis: axis("Frequency", "Hz"),
                ordinate_axis: axis("coherence", ""),
                properties: vec![
                    property("id2", title),
                    property(
                        "id4",
                        &match one.multiple {
                            None => {
                                format!("coherence of {output} and {input}, test {}", number + 1)
                            }
                            Some(_) => format!("partial coherence of {output} and {input}"),
                        },
                    ),
                ],
            });
        }
    }
    universal::attachment(&contents, "frf.uff")
}
