//! Commands that take a sheet, or recordings instead of it.
//!
//! If the options describe recordings, this description is first written as a sheet, and the sheet
//! is run. The result refers to the sheet, and the sheet can be edited for a second test.

mod options;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;

use crate::output::{self, TableFiles};
use crate::sheet::value_and_uncertainty;
use crate::{RodlabError, input};
use options::{OF_ROD, options_of};

/// A sheet, and the folder for its results.
#[derive(Debug, Clone, Args)]
pub struct SheetCommand {
    /// The test sheet.
    pub sheet: PathBuf,
    /// Folder for the results; by default next to the sheet, with its name and `-result`.
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Formats of the tables.
    #[command(flatten)]
    pub tables: TableFiles,
    /// True for a sheet that this run has written under a name of its own choice. It is removed
    /// again if there is no result.
    #[arg(skip)]
    pub is_own: bool,
    /// Fields of a sheet that was written from options, each with the words for its option; empty
    /// for another sheet.
    #[arg(skip)]
    pub options: Vec<(String, String)>,
}

/// A channel of recordings, such as `1`, `1:N` or `hammer:V:2.25 mV/N ± 1 %`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelArgument {
    /// Number from 1, or name in the file.
    from: String,
    /// Unit of the samples; by default that of the file.
    unit: Option<String>,
    sensitivity: Option<String>,
}

/// Form of a channel, with examples.
const FORM: &str =
    "CHANNEL, CHANNEL:UNIT or CHANNEL:UNIT:SENSITIVITY, such as `2`, `2:m/s2` or `2:V:10.2 mV/g`";

impl FromStr for ChannelArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.splitn(3, ':').map(|part| part.trim().to_owned());
        match (parts.next(), parts.next(), parts.next()) {
            (Some(_), Some(_), Some(sensitivity)) if is_pure_number(&sensitivity) => Err(format!(
                "the sensitivity `{sensitivity}` has no unit, expected {FORM}"
            )),
            (Some(from), unit, sensitivity)
                if !from.is_empty() && unit.as_ref().is_none_or(|unit| !unit.is_empty()) =>
            {
                Ok(Self {
                    from,
                    unit,
                    sensitivity,
                })
            }
            _ => Err(format!("expected {FORM}")),
        }
    }
}

/// Returns true for a number without a unit, with or without an uncertainty.
fn is_pure_number(text: &str) -> bool {
    let (value, _) = value_and_uncertainty(text);
    value.trim().parse::<f64>().is_ok()
}

/// Options that describe recordings, in commands without a sheet.
#[derive(Debug, Clone, Args)]
pub struct Recordings {
    /// Sampling rate, such as 51.2kHz, if the files do not state it.
    #[arg(long, value_name = "RATE")]
    rate: Option<String>,
    /// Frequency band of the result, such as `--band 20Hz 10kHz`.
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"])]
    band: Option<Vec<String>>,
    /// The sheet to write, by default JOB.toml in this folder; an existing file is not replaced.
    #[arg(long, value_name = "SHEET")]
    save: Option<PathBuf>,
    /// Folder for the results; by default next to the sheet, with its name and `-result`.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Formats of the tables.
    #[command(flatten)]
    tables: TableFiles,
}

/// `rodlab frf`, with a sheet or with recordings.
#[derive(Debug, Clone, Args)]
pub struct FrfCommand {
    /// The test sheet, or recordings together with `--input` and `--output`.
    #[arg(required = true, value_name = "SHEET|RECORDINGS")]
    files: Vec<PathBuf>,
    /// Channel of the force in the recordings, such as 1:N or "1:V:2.25 mV/N"; without a unit, that
    /// of the file. A sensitivity needs the unit before it. In a table, channel 1 is the first
    /// column after the times.
    #[arg(long, value_name = "CHANNEL[:UNIT[:SENSITIVITY]]", requires = "output")]
    input: Option<ChannelArgument>,
    /// Channel of a motion, such as 2:m/s2; repeat the option for further motions.
    #[arg(long, value_name = "CHANNEL[:UNIT[:SENSITIVITY]]", requires = "input")]
    output: Vec<ChannelArgument>,
    #[command(flatten)]
    recordings: Recordings,
}

/// `rodlab modulus`, with a sheet or with recordings of both ends of a struck rod.
#[derive(Debug, Clone, Args)]
pub struct ModulusCommand {
    /// The test sheet, or recordings of both ends of a rod together with `--impacted` and `--free`.
    #[arg(required = true, value_name = "SHEET|RECORDINGS")]
    files: Vec<PathBuf>,
    /// Channel of the struck end, such as 1:m/s2 or "1:V:10.2 mV/g"; without a unit, that of the
    /// file. In a table, channel 1 is the first column after the times.
    #[arg(
        long,
        value_name = "CHANNEL[:UNIT[:SENSITIVITY]]",
        requires_all = ["free", "length", "diameter", "density"]
    )]
    impacted: Option<ChannelArgument>,
    /// Channel of the free end.
    #[arg(
        long,
        value_name = "CHANNEL[:UNIT[:SENSITIVITY]]",
        requires = "impacted"
    )]
    free: Option<ChannelArgument>,
    /// Length of the rod, such as "799 mm ± 0.3 mm".
    #[arg(long, requires = "impacted")]
    length: Option<String>,
    /// Diameter of the rod.
    #[arg(long, requires = "impacted")]
    diameter: Option<String>,
    /// Density of the rod, such as "912 kg/m3 ± 0.3 kg/m3".
    #[arg(long, requires = "impacted")]
    density: Option<String>,
    /// Mass on the free end, such as "2.9 gram"; none by default.
    #[arg(long, value_name = "MASS", requires = "impacted")]
    accelerometer: Option<String>,
    /// Poisson's ratio, such as "0.40 ± 0.02", for the correction of lateral inertia.
    #[arg(long, value_name = "RATIO", requires = "impacted")]
    poisson: Option<String>,
    #[command(flatten)]
    recordings: Recordings,
}

/// Maximum number of sheets of one job in a folder that are written under default names.
const MOST_SHEETS: usize = 1000;

impl FrfCommand {
    /// Returns the command with its sheet. If the command has recordings instead, the sheet is
    /// written first.
    ///
    /// # Errors
    /// [`RodlabError::Request`] for several files without channels, and for `--rate`, `--band` or
    /// `--save` together with a sheet; [`RodlabError::Exists`] if another sheet has the name of the
    /// sheet to write.
    pub fn sheet(&self) -> Result<SheetCommand, RodlabError> {
        let Some(input) = &self.input else {
            let options = "one sheet, or recordings with --input and --output";
            return self.recordings.of_sheet(&self.files, options);
        };
        let name = |index: usize| match self.output.len() {
            1 => "output".to_owned(),
            _ => format!("output {}", index + 1),
        };
        let outputs = self.output.iter().enumerate();
        let channels = std::iter::once(("input".to_owned(), input))
            .chain(outputs.map(|(index, channel)| (name(index), channel)));
        let mut text = self
            .recordings
            .head("frf", "Frequency response", &self.files);
        text.push_str("input = \"input\"\n");
        self.recordings
            .write_records(&mut text, "records", &self.files, channels);
        let outputs = self.output.iter().map(|channel| ("--output", channel));
        let channels = std::iter::once(("--input", input)).chain(outputs);
        let mut options = options_of("records", channels);
        options.push(("input".to_owned(), "`--input`".to_owned()));
        options.push(("outputs".to_owned(), "`--output`".to_owned()));
        self.recordings.saved("frf", &text, options)
    }
}

impl ModulusCommand {
    /// Returns the command with its sheet. If the command has recordings instead, the sheet is
    /// written first.
    ///
    /// # Errors
    /// The errors of [`FrfCommand::sheet`].
    pub fn sheet(&self) -> Result<SheetCommand, RodlabError> {
        let (Some(impacted), Some(free)) = (&self.impacted, &self.free) else {
            let options = "one sheet, or recordings with --impacted and --free";
            return self.recordings.of_sheet(&self.files, options);
        };
        let mut text = self
            .recordings
            .head("modulus", "Complex modulus", &self.files);
        text.push_str("\n[specimen]\n");
        for (field, value) in [
            ("length", &self.length),
            ("diameter", &self.diameter),
            ("density", &self.density),
            ("accelerometer_mass", &self.accelerometer),
        ] {
            if let Some(value) = value {
                _ = writeln!(text, "{field} = {}", quoted(value));
            }
        }
        if let Some(ratio) = &self.poisson {
            let ratio = quoted(ratio);
            _ = write!(text, "\n[lateral_inertia]\npoisson_ratio = {ratio}\n");
        }
        text.push_str(
            "\n[method.two_point]\nimpacted_end = \"struck end\"\nfree_end = \"free end\"\n",
        );
        let channels = [
            ("struck end".to_owned(), impacted),
            ("free end".to_owned(), free),
        ];
        self.recordings
            .write_records(&mut text, "source.hits.records", &self.files, channels);
        let channels = [("--impacted", impacted), ("--free", free)];
        let mut options = options_of("source.hits.records", channels);
        options.extend(OF_ROD.map(|(field, option)| (field.to_owned(), option.to_owned())));
        self.recordings.saved("modulus", &text, options)
    }
}

impl Recordings {
    fn of_sheet(&self, files: &[PathBuf], expected: &str) -> Result<SheetCommand, RodlabError> {
        let stray = [
            ("--rate", self.rate.is_some()),
            ("--band", self.band.is_some()),
            ("--save", self.save.is_some()),
        ];
        if let Some((option, _)) = stray.iter().find(|(_, is_stated)| *is_stated) {
            return Err(RodlabError::request(
                *option,
                "stated together with a sheet",
                "recordings and their channels: a sheet states this itself",
            ));
        }
        let [sheet] = files else {
            let found = format!("{} files", files.len());
            return Err(RodlabError::request("the input", found, expected));
        };
        Ok(self.command(sheet.clone()))
    }

    fn command(&self, sheet: PathBuf) -> SheetCommand {
        SheetCommand {
            sheet,
            out: self.out.clone(),
            tables: self.tables,
            is_own: false,
            options: Vec::new(),
        }
    }

    fn head(&self, job: &str, what: &str, files: &[PathBuf]) -> String {
        let first = files.first().map(|file| file.display().to_string());
        let title = format!("{what} from {}", first.unwrap_or_default());
        let mut text = format!("job = \"{job}\"\ntitle = {}\n", quoted(&title));
        if let Some([from, to]) = self.band.as_deref() {
            _ = writeln!(
                text,
                "band = {{ from = {}, to = {} }}",
                quoted(from),
                quoted(to)
            );
        }
        text
    }

    fn write_records<'a>(
        &self,
        text: &mut String,
        table: &str,
        files: &[PathBuf],
        channels: impl IntoIterator<Item = (String, &'a ChannelArgument)>,
    ) {
        // paths in a sheet are relative to its folder, so a sheet in another folder needs absolute
        // paths
        let is_elsewhere = self.save.as_ref().and_then(|sheet| sheet.parent());
        let is_elsewhere = is_elsewhere.is_some_and(|folder| folder != Path::new(""));
        let files: Vec<String> = files
            .iter()
            .map(|file| {
                let whole = is_elsewhere.then(|| std::path::absolute(file));
                let file = whole.and_then(Result::ok).unwrap_or_else(|| file.clone());
                quoted(&file.display().to_string())
            })
            .collect();
        _ = writeln!(text, "\n[{table}]\nfiles = [{}]", files.join(", "));
        if let Some(rate) = &self.rate {
            _ = writeln!(text, "sampling_rate = {}", quoted(rate));
        }
        text.push_str("channels = [\n");
        for (name, channel) in channels {
            let from = match channel.from.parse::<u32>() {
                Ok(number) => number.to_string(),
                Err(_) => quoted(&channel.from),
            };
            _ = write!(text, "    {{ name = \"{name}\", from = {from}");
            for (field, value) in [
                ("unit", &channel.unit),
                ("sensitivity", &channel.sensitivity),
            ] {
                if let Some(value) = value {
                    _ = write!(text, ", {field} = {}", quoted(value));
                }
            }
            text.push_str(" },\n");
        }
        text.push_str("]\n");
    }

    /// Writes the sheet of `job` under the stated name, or else under the first of the names
    /// `job.toml`, `job-2.toml`, … that no other sheet has. A file that already contains the same
    /// text is used.
    fn saved(
        &self,
        job: &str,
        text: &str,
        options: Vec<(String, String)>,
    ) -> Result<SheetCommand, RodlabError> {
        let written = |path: PathBuf| -> Result<SheetCommand, RodlabError> {
            let is_there = path.exists() && input::read(&path)? == text.as_bytes();
            if !is_there {
                output::write_new(&path, text.as_bytes())?;
            }
            Ok(SheetCommand {
                is_own: !is_there && self.save.is_none(),
                options: options.clone(),
                ..self.command(path)
            })
        };
        if let Some(path) = &self.save {
            return written(path.clone());
        }
        let mut number = 1;
        loop {
            let name = match number {
                1 => format!("{job}.toml"),
                _ => format!("{job}-{number}.toml"),
            };
            match written(PathBuf::from(name)) {
                Err(RodlabError::Exists { .. }) if number < MOST_SHEETS => number += 1,
                done => return done,
            }
        }
    }
}

/// Returns `text` as a TOML string, which has the same escapes as a JSON string.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::arguments::{Arguments, Command};

    #[test]
    fn a_channel_has_a_place_and_maybe_a_unit_and_a_sensitivity() {
        let parsed = |text: &str| text.parse::<ChannelArgument>();
        let channel = parsed("hammer:V:2.25 mV/N ± 1 %").unwrap();
        assert_eq!(
            (channel.from.as_str(), channel.unit.as_deref()),
            ("hammer", Some("V"))
        );
        assert_eq!(channel.sensitivity.as_deref(), Some("2.25 mV/N ± 1 %"));
        assert_eq!(parsed("1:N").unwrap().sensitivity, None);
        assert_eq!(parsed("1").unwrap().unit, None);
        for text in ["", ":N", "1:"] {
            assert!(parsed(text).unwrap_err().contains("CHANNEL:UNIT"), "{text}");
        }
        assert_eq!(
            parsed("1:V:5").unwrap_err(),
            "the sensitivity `5` has no unit, expected CHANNEL, CHANNEL:UNIT or CHANNEL:UNIT:SENSITIVITY, such as `2`, `2:m/s2` or `2:V:10.2 mV/g`"
        );
        assert!(parsed("1:V:5 ± 1 %").is_err() && parsed("1:V:5 ± 0.1 mV/N").is_ok());
    }

    /// Parses a command whose arguments are separated by `|`.
    fn parsed(command: &str) -> Result<Arguments, clap::Error> {
        Arguments::try_parse_from(["rodlab"].into_iter().chain(command.split('|')))
    }

    /// Returns the text of the sheet that the `command` writes, and the job of this sheet.
    fn written(command: &str) -> Result<(String, String), RodlabError> {
        let folder = tempfile::tempdir().unwrap();
        let sheet = folder.path().join("sheet.toml");
        let command = parsed(&format!("{command}|--save|{}", sheet.display())).unwrap();
        let Command::Job(job) = &command.command else {
            panic!("no job")
        };
        let (name, command) = job.sheet()?;
        assert_eq!(command.sheet, sheet);
        // the second call finds the same sheet already there
        job.sheet()?;
        let text = std::fs::read_to_string(&sheet).unwrap();
        let parsed = crate::job::parse(&sheet, &text)?;
        assert_eq!(parsed.name(), name.name());
        // the sheet is not in the folder of the recordings, so it states their folder
        let here = std::env::current_dir().unwrap().join("x");
        let here = quoted(&here.display().to_string());
        let here = here.trim_start_matches('"').trim_end_matches("x\"");
        assert!(text.contains(&format!("files = [\"{here}")), "{text}");
        Ok((text.replace(here, "HERE/"), format!("{parsed:?}")))
    }

    #[test]
    fn recordings_make_a_sheet_that_states_them() {
        let frf = r#"frf|hits-1.npy|a "b" \ 1.npy|--rate|51.2kHz|--band|20Hz|10kHz|--input|1:V:2.25 mV/N ± 1 %|--output|2:m/s2|--output|end B"#;
        let (text, parsed) = written(frf).unwrap();
        insta::assert_snapshot!(text, @r#"
        job = "frf"
        title = "Frequency response from hits-1.npy"
        band = { from = "20Hz", to = "10kHz" }
        input = "input"

        [records]
        files = ["HERE/hits-1.npy", "HERE/a \"b\" \\ 1.npy"]
        sampling_rate = "51.2kHz"
        channels = [
            { name = "input", from = 1, unit = "V", sensitivity = "2.25 mV/N ± 1 %" },
            { name = "output 1", from = 2, unit = "m/s2" },
            { name = "output 2", from = "end B" },
        ]
        "#);
        assert!(parsed.contains("/a \\\"b\\\" \\\\ 1.npy"), "{parsed}");
        let modulus = "modulus|hits-*.npy|--rate|65536 Hz|--impacted|1:m/s2|--free|2:m/s2|--length|799 mm ± 0.3 mm|--diameter|15.8 mm|--density|912 kg/m3 ± 0.1 %";
        let (text, _) = written(modulus).unwrap();
        insta::assert_snapshot!(text, @r#"
        job = "modulus"
        title = "Complex modulus from hits-*.npy"

        [specimen]
        length = "799 mm ± 0.3 mm"
        diameter = "15.8 mm"
        density = "912 kg/m3 ± 0.1 %"

        [method.two_point]
        impacted_end = "struck end"
        free_end = "free end"

        [source.hits.records]
        files = ["HERE/hits-*.npy"]
        sampling_rate = "65536 Hz"
        channels = [
            { name = "struck end", from = 1, unit = "m/s2" },
            { name = "free end", from = 2, unit = "m/s2" },
        ]
        "#);
    }

    #[test]
    fn what_makes_no_sheet_is_refused() {
        let refused = written("frf|a.npy|b.npy").unwrap_err().to_string();
        assert!(refused.contains("--save"));
        // the command for a rod needs its density
        assert!(parsed("modulus|a.npy|--impacted|1:m/s2|--free|2:m/s2").is_err());
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("frf.toml");
        std::fs::write(&taken, "another").unwrap();
        let words = "frf|a.npy|--input|1:N|--output|2:m/s2|--save";
        let command = parsed(&format!("{words}|{}", taken.display())).unwrap();
        let Command::Job(job) = &command.command else {
            panic!("no job")
        };
        assert!(matches!(job.sheet(), Err(RodlabError::Exists { .. })));
        assert_eq!(std::fs::read_to_string(&taken).unwrap(), "another");
    }
}
