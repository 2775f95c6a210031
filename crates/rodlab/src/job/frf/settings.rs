//! Settings, stated in the sheet or taken by default.

use super::sheet::{FrfSheet, WindowSheet};
use crate::outcome::Setting;
use crate::responses::MergeSheet;

/// All settings of the sheet except those of records and hits.
pub(super) fn settings(sheet: &FrfSheet) -> Vec<Setting> {
    let mut settings = sheet.about.settings();
    let mut say = |name: &str, value: String, by_default: bool| {
        settings.push(Setting {
            name: name.to_owned(),
            value,
            by_default,
        });
    };
    say("input", sheet.input.clone(), false);
    if !sheet.further_inputs.is_empty() {
        say("further_inputs", sheet.further_inputs.join(", "), false);
    }
    if let Some(segments) = &sheet.segments {
        say("segments.length", segments.length.to_string(), false);
        let overlap = segments.overlap.as_ref();
        say(
            "segments.overlap",
            overlap.map_or("50 %".to_owned(), ToString::to_string),
            overlap.is_none(),
        );
    }
    let outputs = sheet
        .outputs
        .as_ref()
        .map_or("all other channels".to_owned(), |outputs| {
            outputs.join(", ")
        });
    say("outputs", outputs, sheet.outputs.is_none());
    let estimator = sheet.estimator.unwrap_or_default();
    say(
        "estimator",
        format!("{estimator:?}"),
        sheet.estimator.is_none(),
    );
    let window = match sheet.window_or_default() {
        WindowSheet::Tukey { taper } => format!("Tukey, taper {taper}"),
        window => format!("{window:?}"),
    };
    say("window", window, sheet.window.is_none());
    let force_window = sheet.force_window.as_ref().map_or("none".to_owned(), |w| {
        format!("from {} to {}, edges of {}", w.start, w.end, w.taper)
    });
    say("force_window", force_window, sheet.force_window.is_none());
    let exponential = sheet.exponential_window.as_ref();
    let exponential = exponential.map_or("none".to_owned(), ToString::to_string);
    say(
        "exponential_window",
        exponential,
        sheet.exponential_window.is_none(),
    );
    let usual = match sheet.segments {
        None => "rest before the blow, where there is some",
        Some(_) => "mean",
    };
    let detrend = sheet.detrend.map_or(usual.to_owned(), |detrend| {
        format!("{detrend:?}").to_lowercase()
    });
    say("detrend", detrend, sheet.detrend.is_none());
    let band = sheet
        .band
        .as_ref()
        .map_or("all lines above 0 Hz".to_owned(), |b| {
            format!("from {} to {}", b.from, b.to)
        });
    say("band", band, sheet.band.is_none());
    let kind = sheet.kind.unwrap_or_default();
    let kind_text = kind
        .kind()
        .map_or("as measured".to_owned(), |kind| kind.to_string());
    say("kind", kind_text, sheet.kind.is_none());
    if let Some(second) = &sheet.second_hammer {
        let merge = match second.merge.unwrap_or_default() {
            MergeSheet::InverseVariance => "by inverse variance",
            MergeSheet::LargerInput => "by the larger coherent input",
        };
        say(
            "second_hammer.merge",
            merge.to_owned(),
            second.merge.is_none(),
        );
    }
    if let Some(weighed) = &sheet.weighed_mass {
        let value = format!(
            "{} below {}, elastic term from the lines up to {}",
            weighed.mass, weighed.below, weighed.fitted_to
        );
        say("weighed_mass", value, false);
    }
    settings
}
