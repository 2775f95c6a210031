//! Instruction counts of the kernels, by callgrind: they do not depend on the load of the machine.

use std::path::Path;
use std::process::{Command, Stdio};

use super::kernel::KERNELS;
use super::machine;
use super::measured::{Instructions, KernelCount};
use crate::Outcome;
use crate::cargo::run;
use crate::files::at;

/// Relative increase that is tolerated: other versions of the mathematical library and other
/// inlining by the compiler change counts by less.
const TOLERANCE: f64 = 0.02;

/// Number of runs of each kernel; their counts should be equal.
const RUNS: usize = 2;

/// Returns the version of valgrind; `None` if it is not installed.
fn valgrind() -> Option<String> {
    let output = Command::new("valgrind").arg("--version").output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output
        .status
        .success()
        .then(|| text.trim().replace('-', " "))
}

/// Returns the version of valgrind, which counts the instructions, followed by ` on ` and the
/// platform, which affects the counts: architecture, AVX2 and version of libc. `None` without
/// valgrind.
pub(super) fn counter() -> Option<String> {
    let library = Command::new("ldd").arg("--version").output().ok();
    let library = library.and_then(|output| {
        let text = String::from_utf8(output.stdout).ok()?;
        let version = text.lines().next()?.rsplit(' ').next()?.to_owned();
        Some(format!(", libc {version}"))
    });
    Some(format!(
        "{} on {}{}{}",
        valgrind()?,
        std::env::consts::ARCH,
        if has_wide_lanes() { " with AVX2" } else { "" },
        library.unwrap_or_default()
    ))
}

#[cfg(target_arch = "x86_64")]
fn has_wide_lanes() -> bool {
    std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_wide_lanes() -> bool {
    false
}

/// Returns the reason why counts from this machine cannot be compared with `reference`, if there is
/// one.
pub(super) fn not_comparable(reference: &Instructions) -> Option<String> {
    let Some(here) = counter() else {
        return Some("valgrind is not installed".to_owned());
    };
    let compiler = machine::compiler();
    if machine_of(&here) != machine_of(&reference.counted_by) {
        Some(format!(
            "the reference was counted by {}, but this machine has {here}",
            reference.counted_by
        ))
    } else if compiler != reference.compiler {
        Some(format!(
            "the reference was compiled by {}, but this machine has {compiler}",
            reference.compiler
        ))
    } else {
        None
    }
}

/// Returns the platform in the description of a `counter`.
fn machine_of(counter: &str) -> &str {
    counter
        .split_once(" on ")
        .map_or("", |(_, machine)| machine)
}

/// Counts the instructions of all kernels; callgrind writes its files to `folder`.
pub(super) fn count(folder: &Path) -> Outcome<Instructions> {
    let counted_by = counter().ok_or("valgrind is not installed: no instructions were counted")?;
    let mut kernels = Vec::new();
    for kernel in &KERNELS {
        eprintln!("  {}", kernel.name);
        let mut counts = Vec::with_capacity(RUNS);
        for _ in 0..RUNS {
            counts.push(count_once(kernel.name, folder)?);
        }
        let least = counts.iter().copied().min().unwrap_or(0);
        let greatest = counts.iter().copied().max().unwrap_or(0);
        kernels.push(KernelCount {
            name: kernel.name.to_owned(),
            instructions: least,
            spread: greatest - least,
        });
    }
    Ok(Instructions {
        counted_by,
        compiler: machine::compiler(),
        kernels,
    })
}

fn count_once(name: &str, folder: &Path) -> Outcome<u64> {
    std::fs::create_dir_all(folder).map_err(at(folder))?;
    let file = folder.join(format!("callgrind.{name}"));
    let said = run(Command::new("valgrind")
        .args([
            "--tool=callgrind",
            "--toggle-collect=*collected_by_callgrind*",
        ])
        .arg(format!("--callgrind-out-file={}", file.display()))
        .arg(std::env::current_exe()?)
        .args(["bench-kernel", name])
        .stdin(Stdio::null()))?;
    match collected(&said.remarks) {
        Some(0) => Err(format!(
            "{name}: nothing was collected: the function that callgrind looks for was not entered"
        )
        .into()),
        Some(count) => Ok(count),
        None => Err(format!("{name}: callgrind printed no line `Collected : N`").into()),
    }
}

/// Returns the count that callgrind prints at its end.
fn collected(said: &str) -> Option<u64> {
    let (_, count) = said.split_once("Collected : ")?;
    count.split_whitespace().next()?.parse().ok()
}

/// Fails if the count of a kernel exceeds its reference by more than the tolerance. Returns a line
/// of text for each other kernel whose count differs from its reference.
pub(super) fn compare(reference: &Instructions, found: &Instructions) -> Outcome<Vec<String>> {
    let (mut moved, mut risen) = (Vec::new(), Vec::new());
    for kernel in &found.kernels {
        let before = reference.kernels.iter().find(|k| k.name == kernel.name);
        let Some(before) = before else {
            risen.push(format!("{} has no reference", kernel.name));
            continue;
        };
        let change = relative(before.instructions, kernel.instructions);
        let text = format!(
            "{}: {} instructions, {} before ({:+.1} %)",
            kernel.name,
            kernel.instructions,
            before.instructions,
            100.0 * change
        );
        if change > TOLERANCE {
            risen.push(text);
        } else if change.abs() > 0.0 {
            moved.push(text);
        }
    }
    if risen.is_empty() {
        Ok(moved)
    } else {
        Err(format!(
            "the instruction counts of {} kernels rose by more than {:.0} %: {}",
            risen.len(),
            100.0 * TOLERANCE,
            risen.join("; ")
        )
        .into())
    }
}

fn relative(before: u64, now: u64) -> f64 {
    now as f64 / before as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(count: u64) -> Instructions {
        Instructions {
            kernels: vec![KernelCount {
                name: "march".into(),
                instructions: count,
                spread: 0,
            }],
            ..Instructions::default()
        }
    }

    #[test]
    fn what_callgrind_says_is_read() {
        let said = "==7== Events    : Ir\n==7== Collected : 166514\n==7== \n";
        assert_eq!(collected(said), Some(166_514));
        assert_eq!(collected("killed"), None);
    }

    #[test]
    fn counts_of_another_machine_or_compiler_are_not_compared() {
        let Some(counted_by) = counter() else {
            return; // without valgrind, nothing is compared
        };
        let here = Instructions {
            counted_by,
            compiler: machine::compiler(),
            kernels: Vec::new(),
        };
        assert_eq!(not_comparable(&here), None);
        let mut other = here.clone();
        other.counted_by = "valgrind 3.19.0 on vax".into();
        assert!(
            not_comparable(&other)
                .unwrap()
                .contains("the reference was counted by valgrind 3.19.0 on vax")
        );
        let mut older = here;
        older.compiler = "rustc 1.0.0".into();
        assert!(
            not_comparable(&older)
                .unwrap()
                .contains("the reference was compiled by rustc 1.0.0")
        );
    }

    #[test]
    fn a_rise_beyond_the_tolerance_fails_and_a_fall_is_told() {
        let reference = counts(1000);
        assert!(compare(&reference, &counts(1000)).unwrap().is_empty());
        assert_eq!(compare(&reference, &counts(1019)).unwrap().len(), 1);
        assert_eq!(compare(&reference, &counts(500)).unwrap().len(), 1);
        let error = compare(&reference, &counts(1021)).unwrap_err().to_string();
        assert!(
            error.contains("march: 1021 instructions, 1000 before (+2.1 %)"),
            "{error}"
        );
        assert!(compare(&Instructions::default(), &counts(1)).is_err());
    }
}
