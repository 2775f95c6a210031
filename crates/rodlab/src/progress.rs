//! Progress display of long work on a terminal.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::context::Progress;

/// Progress bar on the standard error; hidden if the standard error is not a terminal.
#[derive(Debug)]
pub struct Bar {
    bar: ProgressBar,
}

impl Bar {
    /// Creates a bar, which is hidden if `quiet` is true or the standard error is not a terminal.
    #[must_use]
    pub fn new(quiet: bool) -> Self {
        let bar = if quiet || !std::io::stderr().is_terminal() {
            ProgressBar::hidden()
        } else {
            let bar = ProgressBar::new_spinner();
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        };
        Self { bar }
    }

    /// Lets `print` print a line above the bar.
    pub fn above<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn begins(&self, step: &str, of: usize) {
        let style = if of == 0 {
            ProgressStyle::with_template("{spinner} {msg}")
        } else {
            ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}")
        };
        if let Ok(style) = style {
            self.bar.set_style(style);
        }
        self.bar.set_length(of as u64);
        self.bar.set_position(0);
        self.bar.set_message(step.to_owned());
    }

    fn one_more(&self) {
        self.bar.inc(1);
    }
}
