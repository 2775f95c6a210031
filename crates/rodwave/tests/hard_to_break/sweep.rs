//! A function asked with every argument, or every two, at the ends of the scale: it refuses in words or it answers with
//! numbers.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rodwave::RodwaveError;

/// What a function makes of its arguments.
pub(crate) type Numbers = Result<Vec<f64>, RodwaveError>;

/// What arguments must survive: no numbers, zeros of both signs, denormals, the ends of the range, squares that overflow or
/// vanish, and sizes that no rod has.
pub(crate) const HOSTILE: [f64; 22] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    -1.0,
    1.0,
    5e-324,
    -5e-324,
    f64::MIN_POSITIVE,
    f64::MAX,
    f64::MIN,
    f64::EPSILON,
    1e-12,
    1e12,
    9_007_199_254_740_992.0,
    1e-200,
    1e200,
    1e-154,
    1e154,
    1e-300,
    1e300,
];

/// What went wrong, a line each.
#[derive(Default)]
pub(crate) struct Findings(Vec<String>);

/// Whether arguments are far from the ends of the range, so that plain functions, which nobody checks, give numbers too.
pub(crate) fn are_modest(arguments: &[f64]) -> bool {
    arguments
        .iter()
        .all(|argument| *argument == 0.0 || (1e-100..=1e100).contains(&argument.abs()))
}

impl Findings {
    /// Asks `function` with `sound` arguments, which it must answer, and then with a hostile one in each place.
    pub(crate) fn sweep(
        &mut self,
        name: &str,
        sound: &[f64],
        function: impl Fn(&[f64]) -> Numbers,
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

    /// The same, and then with hostile arguments in two places.
    pub(crate) fn sweep_pairs(
        &mut self,
        name: &str,
        sound: &[f64],
        function: impl Fn(&[f64]) -> Numbers,
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

    fn ask(&mut self, name: &str, arguments: &[f64], function: &impl Fn(&[f64]) -> Numbers) {
        match catch_unwind(AssertUnwindSafe(|| function(arguments))) {
            Err(_) => self.add(name, arguments, "panicked"),
            Ok(Ok(values)) if values.iter().any(|value| !value.is_finite()) => {
                self.add(name, arguments, &format!("answered {values:?}"));
            }
            Ok(Err(error)) if error.to_string().is_empty() => {
                self.add(name, arguments, "was refused without a word");
            }
            Ok(_) => {}
        }
    }

    fn add(&mut self, name: &str, arguments: &[f64], what: &str) {
        self.0.push(format!("{name}{arguments:?}: {what}"));
    }

    /// Fails with what was found, thinned out to lines that can be read.
    pub(crate) fn none(self) {
        let stride = self.0.len().div_ceil(60).max(1);
        let some: Vec<&str> = self.0.iter().step_by(stride).map(String::as_str).collect();
        assert!(
            self.0.is_empty(),
            "{} findings, among them:\n{}",
            self.0.len(),
            some.join("\n")
        );
    }
}
