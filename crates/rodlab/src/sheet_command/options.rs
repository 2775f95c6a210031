//! Options of a command without a sheet, in place of the fields of the sheet that it writes.
//!
//! If the input is wrong, the sheet is removed; messages therefore name the options and not the
//! fields of the sheet, and show no excerpt of it.

use super::{ChannelArgument, SheetCommand};
use crate::RodlabError;
use crate::sheet::SheetError;

/// Fields of the sheet of `rodlab modulus` that are stated by options of their own, with the words
/// for these options.
pub(super) const OF_ROD: [(&str, &str); 7] = [
    ("specimen.length", "`--length`"),
    ("specimen.diameter", "`--diameter`"),
    ("specimen.density", "`--density`"),
    ("specimen.accelerometer_mass", "`--accelerometer`"),
    ("lateral_inertia.poisson_ratio", "`--poisson`"),
    ("method.two_point.impacted_end", "`--impacted`"),
    ("method.two_point.free_end", "`--free`"),
];

/// Returns the fields of the records in `table` of a sheet, and of the band, with the words for the
/// options that state them. `channels` contains the option and the argument of each channel.
pub(super) fn options_of<'a>(
    table: &str,
    channels: impl IntoIterator<Item = (&'a str, &'a ChannelArgument)>,
) -> Vec<(String, String)> {
    let mut options = vec![
        (format!("{table}.sampling_rate"), "`--rate`".to_owned()),
        ("band".to_owned(), "`--band`".to_owned()),
        (
            "band.from".to_owned(),
            "the beginning of `--band`".to_owned(),
        ),
        ("band.to".to_owned(), "the end of `--band`".to_owned()),
    ];
    for (at, (option, channel)) in channels.into_iter().enumerate() {
        let place = format!("{table}.channels[{at}]");
        let stated = format!("{option} {}", channel.from);
        let unit = channel.unit.as_deref().unwrap_or("UNIT");
        options.push((
            format!("{place}.unit"),
            format!("the unit in `{stated}:{unit}`"),
        ));
        options.push((
            format!("{place}.sensitivity"),
            format!("the sensitivity in `{stated}:{unit}:SENSITIVITY`"),
        ));
        options.push((place, format!("`{option}`")));
    }
    options
}

impl SheetCommand {
    /// Returns `error` with the options of the command in place of the fields of its sheet.
    pub(crate) fn in_options(&self, error: RodlabError) -> RodlabError {
        match error {
            RodlabError::Sheet(error) => self.mistakes(&error),
            RodlabError::Request {
                field,
                found,
                expected,
            } => RodlabError::request(self.option_of(&field), found, expected),
            RodlabError::Step { what, source } => RodlabError::Step {
                what: self.option_of(&what),
                source,
            },
            RodlabError::NoFile {
                pattern,
                folder,
                similar,
                ..
            } => RodlabError::NoFile {
                pattern,
                folder,
                field: String::new(),
                similar,
            },
            error => error,
        }
    }

    /// Returns the mistakes of the sheet with their options, without lines and columns.
    fn mistakes(&self, error: &SheetError) -> RodlabError {
        let mistakes = std::iter::once(error).chain(error.others());
        let mut texts = mistakes.map(|mistake| {
            let what = match mistake.field() {
                "" => "the command".to_owned(),
                field => self.option_of(field),
            };
            let advice = mistake.advice().map(|advice| format!(" ({advice})"));
            let text = format!("{}{}", mistake.problem(), advice.unwrap_or_default());
            (what, text)
        });
        let (what, first) = texts.next().unwrap_or_default();
        let source = texts.fold(first, |text, (what, next)| {
            format!("{text}; {what}: {next}")
        });
        RodlabError::Step {
            what,
            source: source.into(),
        }
    }

    /// Returns `field` with the words for its option, if it has one; the name of a file may follow
    /// the field.
    fn option_of(&self, field: &str) -> String {
        let (place, rest) = field.split_at(field.find([' ', ',', ':']).unwrap_or(field.len()));
        let is_part = |known: &str| {
            let rest = place.strip_prefix(known);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        let options = self.options.iter().filter(|(known, _)| is_part(known));
        match options.max_by_key(|(known, _)| known.len()) {
            Some((_, option)) => format!("{option}{rest}"),
            None => field.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::output::TableFiles;

    #[test]
    fn a_message_names_the_option_of_its_field() {
        let channels: [ChannelArgument; 2] = ["1".parse().unwrap(), "b:V".parse().unwrap()];
        let command = SheetCommand {
            sheet: PathBuf::from("frf.toml"),
            out: None,
            tables: TableFiles::default(),
            is_own: true,
            options: options_of(
                "records",
                ["--input", "--output"].into_iter().zip(&channels),
            ),
        };
        let said = |field: &str| {
            let error = RodlabError::request(field, "not stated", "it");
            command.in_options(error).to_string()
        };
        for (field, option) in [
            ("records.sampling_rate", "`--rate`"),
            ("records.channels[0].unit", "the unit in `--input 1:UNIT`"),
            (
                "records.channels[1].sensitivity",
                "the sensitivity in `--output b:V:SENSITIVITY`",
            ),
            ("records.channels[1].from", "`--output`"),
            ("records.channels[0], hits.csv", "`--input`, hits.csv"),
            ("band", "`--band`"),
            ("band.to", "the end of `--band`"),
            ("bandage", "bandage"),
            ("records.files", "records.files"),
        ] {
            assert_eq!(said(field), format!("{option} is not stated, expected it"));
        }
        // a mistake in the sheet is reported without line and excerpt
        let text = r#"job = "frf"
title = "Frequency response"
band = { from = "20", to = "10kHz" }
input = "input"

[records]
files = ["hit.npy"]
sampling_rate = "51.2"
channels = [{ name = "input", from = 1 }, { name = "output", from = "b" }]
"#;
        let error = crate::job::parse(&command.sheet, text).unwrap_err();
        let error = command.in_options(error.into());
        assert!(matches!(error, RodlabError::Step { .. }), "{error:?}");
        assert_eq!(
            error.to_string(),
            "the beginning of `--band`: `20` has no unit, expected a frequency, such as \"51.2 kHz\"; \
             `--rate`: `51.2` has no unit, expected a frequency, such as \"51.2 kHz\""
        );
    }
}
