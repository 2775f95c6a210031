//! The program `rodlab`.

use std::any::Any;
use std::io::{self, Write};
use std::panic::{self, AssertUnwindSafe};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use clap::Parser;
use rodlab::arguments::Arguments;
use rodlab::output;
use rodlab::program::{self, Ending};

/// Time for the work to end by itself after an interruption.
const PATIENCE: Duration = Duration::from_millis(250);

/// Stack size of the working thread, that usual for a main thread.
const STACK: usize = 8 << 20;

/// An event the main thread waits for.
enum Event {
    Interrupted,
    /// The work ended or panicked.
    Ended(Result<Ending, Box<dyn Any + Send>>),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let interrupted = Arc::new(AtomicBool::new(false));
    let (tell, events) = mpsc::channel();
    let flag = Arc::clone(&interrupted);
    let signal = tell.clone();
    // Without a handler, an interruption ends the program at once, which also leaves complete files.
    let _ = ctrlc::set_handler(move || {
        // a second interruption ends the program at once, as does one that the main thread no longer receives
        if flag.swap(true, Ordering::Relaxed) || signal.send(Event::Interrupted).is_err() {
            std::process::exit(i32::from(Ending::Interrupted.status()));
        }
    });
    // A computation in a library cannot be interrupted: it runs in a separate thread, and the program ends without it.
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
        return ExitCode::from(Ending::WRONG.status());
    }
    let mut event = events.recv().ok();
    if matches!(event, Some(Event::Interrupted)) {
        event = events.recv_timeout(PATIENCE).ok();
    }
    match event {
        Some(Event::Ended(Ok(ending))) => ExitCode::from(ending.status()),
        Some(Event::Ended(Err(panic))) => panic::resume_unwind(panic),
        Some(Event::Interrupted) | None => abandon(),
    }
}

/// Ends the program while the thread still computes: between two changes of files, never within one.
fn abandon() -> ! {
    output::stop_writing();
    let _ = writeln!(io::stderr(), "{}", program::INTERRUPTED);
    std::process::exit(i32::from(Ending::Interrupted.status()))
}
