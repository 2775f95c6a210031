//! Calls a function with every argument, or every pair of arguments, at the limits of the
//! floating-point range: it must return an error with a message, or numbers. The tests named
//! `hard_to_break` of all crates share this file.
#![allow(dead_code, reason = "each crate uses some of these functions")]

use std::fmt::Display;
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Hostile arguments: NaN and infinities, zeros of both signs, denormals, the limits of the range,
/// numbers whose squares overflow or vanish, and sizes that no rod has.
pub(crate) const HOSTILE: [f64; 28] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    5e-324,
    -5e-324,
    1e-310,
    f64::MIN_POSITIVE,
    1e-300,
    1e-200,
    1e-155,
    1e-154,
    f64::EPSILON,
    1e-12,
    -1.0,
    0.5,
    1.0,
    3.0,
    1e12,
    9_007_199_254_740_992.0,
    1e154,
    1e155,
    1e200,
    1e300,
    -1e300,
    f64::MAX,
    f64::MIN,
];

/// Calls `function` with each extreme number: a non-finite number must be rejected, and every
/// result must be finite.
pub(crate) fn sweep<E: Display>(name: &str, function: impl Fn(f64) -> Result<Vec<f64>, E>) {
    for value in HOSTILE {
        match function(value) {
            Ok(results) => {
                assert!(value.is_finite(), "{name} accepts {value}");
                assert!(
                    results.iter().all(|r| r.is_finite()),
                    "{name} of {value} gives {results:?}"
                );
            }
            // a message with the quantity and the number has more than ten characters
            Err(error) => assert!(error.to_string().len() > 10, "{name} of {value}: {error}"),
        }
    }
}

/// Failures of functions with errors of type `E`, one per line.
pub(crate) struct Findings<E> {
    lines: Vec<String>,
    refusal: PhantomData<fn() -> E>,
}

impl<E> Default for Findings<E> {
    fn default() -> Self {
        Self {
            lines: Vec::new(),
            refusal: PhantomData,
        }
    }
}

/// Returns true if the arguments are far from the limits of the range: functions that do not check
/// them must then give finite results too.
pub(crate) fn are_modest(arguments: &[f64]) -> bool {
    arguments
        .iter()
        .all(|argument| *argument == 0.0 || (1e-100..=1e100).contains(&argument.abs()))
}

impl<E: Display> Findings<E> {
    /// Calls `function` with the arguments `sound`, which must succeed, and then with an extreme
    /// argument in each place.
    pub(crate) fn sweep(
        &mut self,
        name: &str,
        sound: &[f64],
        function: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) {
        match function(sound) {
            Ok(values) if values.iter().all(|value| value.is_finite()) => {}
            Ok(values) => self.add(name, sound, &format!("sound arguments gave {values:?}")),
            Err(error) => self.add(
                name,
                sound,
                &format!("sound arguments were refused: {error}"),
            ),
        }
        let mut arguments = sound.to_vec();
        for first in 0..sound.len() {
            for hostile in HOSTILE {
                arguments[first] = hostile;
                self.ask(name, &arguments, &function);
            }
            arguments[first] = sound[first];
        }
    }

    /// Calls `function` as `sweep` does, and then with hostile arguments in two places.
    pub(crate) fn sweep_pairs(
        &mut self,
        name: &str,
        sound: &[f64],
        function: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) {
        self.sweep(name, sound, &function);
        let mut arguments = sound.to_vec();
        for first in 0..sound.len() {
            for second in first + 1..sound.len() {
                for (one, other) in HOSTILE.iter().flat_map(|x| HOSTILE.map(|y| (*x, y))) {
                    (arguments[first], arguments[second]) = (one, other);
                    self.ask(name, &arguments, &function);
                }
                (arguments[first], arguments[second]) = (sound[first], sound[second]);
            }
        }
    }

    fn ask(
        &mut self,
        name: &str,
        arguments: &[f64],
        function: &impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) {
        match catch_unwind(AssertUnwindSafe(|| function(arguments))) {
            Err(_) => self.add(name, arguments, "panicked"),
            Ok(Ok(values)) if values.iter().any(|value| !value.is_finite()) => {
                self.add(name, arguments, &format!("returned {values:?}"));
            }
            Ok(Err(error)) if error.to_string().is_empty() => {
                self.add(name, arguments, "was refused with an empty message");
            }
            Ok(_) => {}
        }
    }

    fn add(&mut self, name: &str, arguments: &[f64], what: &str) {
        self.lines.push(format!("{name}{arguments:?}: {what}"));
    }

    /// Fails if there are findings, and prints at most sixty of them.
    pub(crate) fn none(self) {
        let stride = self.lines.len().div_ceil(60).max(1);
        let some: Vec<&str> = self
            .lines
            .iter()
            .step_by(stride)
            .map(String::as_str)
            .collect();
        assert!(
            self.lines.is_empty(),
            "{} findings, among them:\n{}",
            self.lines.len(),
            some.join("\n")
        );
    }
}
