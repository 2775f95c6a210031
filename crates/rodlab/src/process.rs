//! The program from its command line to its exit status, with its reaction to interruptions. The
//! binary and the console script of the Python package both call it.

use std::any::Any;
use std::ffi::OsString;
use std::io::{self, Write};
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use clap::Parser;

use crate::arguments::Arguments;
use crate::output;
use crate::program::{self, Ending};

/// Longest wait after an interruption for the work to end by itself.
const PATIENCE: Duration = Duration::from_millis(250);

/// Stack size of the working thread, equal to the usual size of a main thread.
const STACK: usize = 8 << 20;

/// Event for which the main thread waits.
enum Event {
    Interrupted,
    /// The work has ended, or panicked.
    Ended(Result<Ending, Box<dyn Any + Send>>),
}

/// Executes `words`, the name of the program and its arguments, and returns the exit status. It
/// handles interruptions of the process (SIGINT), and ends the process if the work does not end
/// within 250 ms. It is meant for processes that do nothing else.
#[must_use]
pub fn run<W>(words: impl IntoIterator<Item = W>) -> u8
where
    W: Into<OsString> + Clone,
{
    let arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(error) => {
            // if nothing can be printed, the status alone reports the error
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(Ending::WRONG.status());
        }
    };
    let interrupted = Arc::new(AtomicBool::new(false));
    let (tell, events) = mpsc::channel();
    let flag = Arc::clone(&interrupted);
    let signal = tell.clone();
    // Without a handler, an interruption ends the program at once, which also leaves complete
    // files.
    let _ = ctrlc::set_handler(move || {
        // the program ends at once after a second interruption, or if no thread receives the first
        if flag.swap(true, Ordering::Relaxed) || signal.send(Event::Interrupted).is_err() {
            std::process::exit(i32::from(Ending::Interrupted.status()));
        }
    });
    // A computation in a library cannot be interrupted. It therefore runs in a thread of its own,
    // and an interrupted program ends without waiting for it.
    let work = move || {
        let ended = panic::catch_unwind(AssertUnwindSafe(|| {
            program::run(
                &arguments,
                &interrupted,
                &mut io::stdout(),
                &mut io::stderr(),
            )
        }));
        let _ = tell.send(Event::Ended(ended));
    };
    if let Err(error) = thread::Builder::new().stack_size(STACK).spawn(work) {
        let _ = writeln!(io::stderr(), "error: starting a thread: {error}");
        return Ending::WRONG.status();
    }
    let mut event = events.recv().ok();
    if matches!(event, Some(Event::Interrupted)) {
        event = events.recv_timeout(PATIENCE).ok();
    }
    match event {
        Some(Event::Ended(Ok(ending))) => ending.status(),
        Some(Event::Ended(Err(panic))) => panic::resume_unwind(panic),
        Some(Event::Interrupted) | None => abandon(),
    }
}

/// Ends the program while its working thread still computes, but never in the middle of a change of
/// files.
fn abandon() -> ! {
    output::stop_writing();
    let _ = writeln!(io::stderr(), "{}", program::INTERRUPTED);
    std::process::exit(i32::from(Ending::Interrupted.status()))
}
