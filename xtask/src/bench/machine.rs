//! Machine on which the measurements are made.

use std::fs;
use std::process::Command;
use std::thread;

use super::measured::Machine;

/// Returns the properties of this machine, as it reports them; missing entries are `unknown`.
pub(super) fn machine(quick: bool) -> Machine {
    Machine {
        processor: processor().unwrap_or_else(unknown),
        processors: thread::available_parallelism().map_or(1, usize::from),
        system: system().unwrap_or_else(unknown),
        compiler: compiler(),
        load_before: load(),
        quick,
    }
}

/// Returns the compiler that cargo uses here.
pub(super) fn compiler() -> String {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    Command::new(rustc)
        .arg("--version")
        .output()
        .ok()
        .filter(|output| output.status.success())
        .map_or_else(unknown, |output| {
            String::from_utf8_lossy(&output.stdout).trim().to_owned()
        })
}

fn unknown() -> String {
    "unknown".to_owned()
}

fn processor() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn system() -> Option<String> {
    let release = fs::read_to_string("/proc/sys/kernel/osrelease").ok()?;
    Some(format!("{} {}", std::env::consts::OS, release.trim()))
}

fn load() -> Option<f64> {
    let text = fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}
