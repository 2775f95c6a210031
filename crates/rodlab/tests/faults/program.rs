//! The program as a user runs it, killed if it does not end.

use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::mpsc;
use std::time::Duration;

use super::tally::Came;

pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_rodlab");

/// Time after which a run counts as blocked; on a busy machine the longest of these runs takes
/// seconds.
const PATIENCE: Duration = Duration::from_secs(120);

pub(crate) fn rodlab(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(arguments);
    at(&mut command, folder);
    command
}

/// Command that runs `script` in the shell, with the program as `$0`.
pub(crate) fn shell(folder: &Path, script: &str) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", script, PROGRAM]);
    at(&mut command, folder);
    command
}

fn at(command: &mut Command, folder: &Path) {
    command
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .env("RUST_BACKTRACE", "0")
        // results have a fixed date, so that those of different runs are equal
        .env("SOURCE_DATE_EPOCH", "0")
        .stdin(Stdio::null());
}

/// Exit status, signal and output of a run.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) status: Option<i32>,
    pub(crate) signal: Option<i32>,
    pub(crate) out: Vec<u8>,
    pub(crate) err: String,
}

impl Ran {
    /// Returns the defect if the program panicked or ended without one of its own statuses.
    pub(crate) fn broke(&self) -> Option<Came> {
        let known = matches!(self.status, Some(0..=3));
        (!known || self.err.contains("panicked")).then(|| {
            Came::Broke(format!(
                "status {:?}, signal {:?}: {}",
                self.status,
                self.signal,
                self.err.lines().next().unwrap_or_default()
            ))
        })
    }

    /// Judges a run that must end with status 1 or 2 and a reason.
    pub(crate) fn refused(&self) -> Came {
        if self.status == Some(0) {
            return Came::Lost("not refused".to_owned());
        }
        if self.err.trim().is_empty() {
            return Came::Lost("refused without a reason".to_owned());
        }
        Came::Refused
    }
}

pub(crate) fn run(command: &mut Command) -> Ran {
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let id = child.id().to_string();
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || sender.send(child.wait_with_output()));
    match receiver.recv_timeout(PATIENCE) {
        Ok(output) => ran(output.unwrap()),
        Err(_) => {
            Command::new("kill").args(["-KILL", &id]).status().unwrap();
            let mut ended = ran(receiver.recv().unwrap().unwrap());
            ended.err = format!("did not end: {}", ended.err);
            ended
        }
    }
}

fn ran(output: Output) -> Ran {
    Ran {
        status: output.status.code(),
        signal: output.status.signal(),
        out: output.stdout,
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}
