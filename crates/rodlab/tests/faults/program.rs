//! The program as a person runs it, ended if it does not end by itself.

use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::mpsc;
use std::time::Duration;

use super::tally::Came;

pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_rodlab");

/// A busy machine takes seconds for the longest of these runs; a run that takes this long is
/// blocked.
const PATIENCE: Duration = Duration::from_secs(120);

pub(crate) fn rodlab(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(arguments);
    at(&mut command, folder);
    command
}

/// `script` of the shell, where `$0` is the program.
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
        // copies of a folder are of other times
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
    /// A panic, or an end that is none of the program's own.
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

    /// Requires a reason with status 1 or 2.
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
