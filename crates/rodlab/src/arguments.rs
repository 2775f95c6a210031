//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

use crate::RodlabError;
use crate::batch::Shard;
use crate::convert::ConvertOptions;
use crate::output::TableFiles;
use crate::sheet::{Exact, Frequency};
use crate::sheet_command::{FrfCommand, ModulusCommand, SheetCommand};
use crate::templates::{JobName, Rig};

/// Determines a complex modulus, a constitutive law or an impact force, with their errors, from
/// recordings of struck rods.
#[derive(Debug, Parser)]
#[command(
    name = "rodlab",
    version,
    max_term_width = 100,
    after_help = "Examples:
  rodlab demo                             a virtual test, with its records, result and report
  rodlab inspect hits.uff                 the contents of a recording
  rodlab init modulus rod.toml            a commented test sheet to fill in
  rodlab check rod.toml                   the mistakes in it, before anything is computed
  rodlab view rod.toml                    the sheet and its result side by side in a browser
  rodlab modulus rod.toml                 the result in rod-result/, its page in rod-result/report.html
  rodlab batch campaign/ --out results    all sheets of a folder, with one summary

Exit status: 0 answered; 1 not allowed: the data do not allow the result; 2 wrong input: a sheet, a file or a folder is wrong; 3 in doubt: there is an answer, but a check fails; 130 interrupted. The exit status of a campaign is that of its worst test, from worst to best: 2, 1, 3, 0."
)]
pub struct Arguments {
    /// Command.
    #[command(subcommand)]
    pub command: Command,
    /// Print nothing but errors.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Print the result as JSON on the standard output, instead of text.
    #[arg(long, global = true)]
    pub json: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Show the contents of a recording: channels, units, rates, and anything that looks wrong.
    #[command(after_help = "Example:\n  rodlab inspect hits.uff")]
    Inspect {
        /// A file in any supported format, which is recognised from the content.
        file: PathBuf,
    },
    /// Convert a recording to another format, given by the extension of the new file.
    #[command(after_help = "Examples:
  rodlab convert hits.tdms hits.csv
  rodlab convert hits.tdms hits.csv --force     replaces an existing file
  rodlab convert hits.npy hits.wav --rate 51.2kHz")]
    Convert {
        /// The file to read.
        input: PathBuf,
        /// The file to write.
        output: PathBuf,
        /// Options of the conversion.
        #[command(flatten)]
        options: ConvertArguments,
    },
    /// Commands that compute the job of a sheet.
    #[command(flatten)]
    Job(Box<JobCommand>),
    /// Write a commented sheet to start from.
    #[command(after_help = "Examples:
  rodlab init modulus rod.toml
  rodlab init modulus member.toml --rig three-gauges
  rodlab init --rig dma")]
    Init {
        /// The job; not needed with `--rig`.
        job: Option<JobName>,
        /// The new sheet; by default the name of the job with the extension toml. A file with the
        /// extension ron is written in RON.
        path: Option<PathBuf>,
        /// Arrangement on the bench; with it, the sheet contains only the fields of that
        /// arrangement.
        #[arg(long)]
        rig: Option<Rig>,
        /// Write the sheet in RON instead of TOML.
        #[arg(long)]
        ron: bool,
    },
    /// Run a virtual test, from its plan to the report of its modulus, and show the commands used.
    #[command(after_help = "Example:\n  rodlab demo")]
    Demo {
        /// The new folder.
        #[arg(default_value = "rodlab-demo")]
        folder: PathBuf,
    },
    /// Read sheets and their files, and report what is wrong with them; nothing is computed.
    #[command(after_help = "Examples:\n  rodlab check rod.toml\n  rodlab check campaign")]
    Check {
        /// Sheets, folders of sheets, or patterns in quotes.
        #[arg(required = true)]
        sheets: Vec<String>,
    },
    /// List sheets with their jobs, input files and hashes; nothing is computed.
    #[command(after_help = "Examples:
  rodlab list campaign
  rodlab list campaign --json     for programs that plan their own work")]
    List {
        /// Sheets, folders of sheets, or patterns in quotes.
        #[arg(required = true)]
        sheets: Vec<String>,
    },
    /// Check by hash that results, and the earlier results that they use, still match their sheets
    /// and files.
    #[command(
        after_help = "Examples:\n  rodlab verify shot-result\n  rodlab verify results --sheets sheets     of `rodlab batch sheets --out results`"
    )]
    Verify {
        /// Folders of results, such as results/cone-1, or of campaigns, such as results.
        #[arg(required = true)]
        results: Vec<PathBuf>,
        /// Folder of the sheets of these results; by default the parent folder of each result.
        #[arg(long, value_name = "FOLDER")]
        sheets: Option<PathBuf>,
    },
    /// Write one sheet for each combination of values and seeds in a plan.
    #[command(
        after_help = "Example:\n  rodlab sweep plan.toml --out sheets && rodlab batch sheets --out results"
    )]
    Sweep {
        /// The plan.
        plan: PathBuf,
        /// Folder that receives the sheets; by default next to the plan, with its name and
        /// `-sheets`. No file is replaced.
        #[arg(long, value_name = "FOLDER")]
        out: Option<PathBuf>,
    },
    /// Show a sheet and its result side by side in a browser: values can be dragged, hits accepted
    /// or rejected, and the sheet saved. The page is served to this machine only, until Ctrl+C.
    #[command(after_help = "Example:\n  rodlab view rod.toml")]
    View {
        /// The sheet.
        sheet: PathBuf,
        /// Port on 127.0.0.1; by default any free port.
        #[arg(long, default_value_t = 0, hide_default_value = true)]
        port: u16,
    },
    /// Run many sheets in parallel, for one job or several.
    #[command(after_help = "Examples:
  rodlab batch campaign --out results
  rodlab batch campaign --out results --resume          only what is not done or has changed
  rodlab batch campaign --out results --shard 3/8       the third of eight parts; `rodlab merge results` at the end")]
    Batch {
        /// Sheets, folders of sheets, or patterns in quotes.
        #[arg(required = true)]
        sheets: Vec<String>,
        /// Folder for the results: one folder per test, and the summary.
        #[arg(long, value_name = "FOLDER")]
        out: PathBuf,
        /// Skip tests that have a complete result of the same sheet, files and software.
        #[arg(long)]
        resume: bool,
        /// Run only part I of N of the tests, and write no summary.
        #[arg(long, value_name = "I/N")]
        shard: Option<Shard>,
        /// Number of tests run at the same time; by default the number of processors.
        #[arg(long, value_name = "N")]
        jobs: Option<std::num::NonZeroUsize>,
        /// Formats of the tables.
        #[command(flatten)]
        tables: TableFiles,
    },
    /// Write one summary of the results in all parts of a campaign.
    #[command(after_help = "Example:\n  rodlab merge results")]
    Merge {
        /// Folders of results.
        #[arg(required = true)]
        folders: Vec<PathBuf>,
        /// Folder that receives the summary; by default the first of the folders.
        #[arg(long, value_name = "FOLDER")]
        out: Option<PathBuf>,
    },
    /// Print the completions for a shell on the standard output.
    #[command(
        after_help = "Example:\n  rodlab completions bash > ~/.local/share/bash-completion/completions/rodlab"
    )]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Write the manual pages to a folder.
    #[command(after_help = "Example:\n  rodlab man ~/.local/share/man/man1")]
    Man {
        /// The folder.
        folder: PathBuf,
    },
}

/// Conversion of a recording.
#[derive(Debug, Args)]
pub struct ConvertArguments {
    /// Convert the readable part of a damaged file, and list the unreadable parts.
    #[arg(long)]
    pub tolerant: bool,
    /// Refuse a conversion that would lose anything.
    #[arg(long)]
    pub lossless: bool,
    /// Write a universal file with IEEE numbers (58b), which keeps every bit, instead of text.
    #[arg(long)]
    pub binary: bool,
    /// Replace the new file if it exists; the file that is read is never replaced.
    #[arg(long)]
    pub force: bool,
    /// Sampling rate, such as 51.2kHz, if the file does not state it, or states it rounded.
    #[arg(long, value_name = "RATE")]
    pub rate: Option<Exact<Frequency>>,
}

impl ConvertArguments {
    /// Returns the options of the conversion.
    #[must_use]
    pub fn options(&self) -> ConvertOptions {
        ConvertOptions {
            tolerant: self.tolerant,
            lossless: self.lossless,
            binary: self.binary,
            force: self.force,
            rate_hz: self.rate.as_ref().map(Exact::si),
        }
    }
}

/// The commands that read a sheet.
#[derive(Debug, Subcommand)]
pub enum JobCommand {
    /// Frequency responses of hits, with coherence and errors.
    #[command(after_help = "Examples:
  rodlab frf hammer.toml --out hammer-frf
  rodlab frf hits-*.npy --rate 51.2kHz --input 1:N --output 2:m/s2     writes and runs frf.toml")]
    Frf(FrfCommand),
    /// Complex modulus of a rod from the motion of its sections.
    #[command(after_help = "Examples:
  rodlab modulus rod.toml
  rodlab modulus hits-*.npy --rate 65.536kHz --impacted 1:m/s2 --free 2:m/s2 --length '799 mm ± 0.3 mm' --diameter '15.8 mm' --density '912 kg/m3 ± 0.1 %' --accelerometer '2.9 gram'
                              writes and runs modulus.toml")]
    Modulus(ModulusCommand),
    /// Loss factor from creep recovery.
    #[command(after_help = "Example:\n  rodlab recovery creep.toml")]
    Recovery(SheetCommand),
    /// Material laws, master curve and material cards from tables of a modulus, such as those of a
    /// DMA.
    #[command(after_help = "Example:\n  rodlab fit sweep.toml")]
    Fit(SheetCommand),
    /// Constitutive law from two histories of an impacted rod.
    #[command(after_help = "Example:\n  rodlab identify shots.toml")]
    Identify(SheetCommand),
    /// Mobility of an impact face, screened and completed.
    #[command(after_help = "Example:\n  rodlab mobility cone.toml")]
    Mobility(SheetCommand),
    /// Force between two bodies that collide, or from a measured response.
    #[command(after_help = "Example:\n  rodlab force cone-on-rod.toml")]
    Force(SheetCommand),
    /// Propagation of waves in a long bar, from one or more shots: damping and speed, as a material
    /// for later sheets.
    #[command(after_help = "Example:\n  rodlab bar bar.ron")]
    Bar(SheetCommand),
    /// Stress-strain curve of a specimen between split Hopkinson bars.
    #[command(after_help = "Example:\n  rodlab shpb shot.toml")]
    Shpb(SheetCommand),
    /// A virtual test, for planning and for trying the other commands.
    #[command(
        after_help = "Example:\n  rodlab simulate plan.toml && rodlab modulus plan-result/modulus.toml"
    )]
    Simulate(SheetCommand),
}

impl JobCommand {
    /// Returns the job and its sheet; the sheet is written first if the command has recordings
    /// instead.
    ///
    /// # Errors
    /// Those of [`FrfCommand::sheet`].
    pub fn sheet(&self) -> Result<(JobName, SheetCommand), RodlabError> {
        let (job, sheet) = match self {
            Self::Frf(command) => return Ok((JobName::Frf, command.sheet()?)),
            Self::Modulus(command) => return Ok((JobName::Modulus, command.sheet()?)),
            Self::Recovery(sheet) => (JobName::Recovery, sheet),
            Self::Fit(sheet) => (JobName::Fit, sheet),
            Self::Identify(sheet) => (JobName::Identify, sheet),
            Self::Mobility(sheet) => (JobName::Mobility, sheet),
            Self::Force(sheet) => (JobName::Force, sheet),
            Self::Bar(sheet) => (JobName::Bar, sheet),
            Self::Shpb(sheet) => (JobName::Shpb, sheet),
            Self::Simulate(sheet) => (JobName::Simulate, sheet),
        };
        Ok((job, sheet.clone()))
    }
}
