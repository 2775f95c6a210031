//! The program `rodlab`.

use std::io;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Parser;
use rodlab::arguments::Arguments;
use rodlab::program;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    // Without a handler an interruption ends the program at once, which leaves whole files too.
    let _ = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(program::Ending::Interrupted.status()));
        }
    });
    let ending = program::run(
        &arguments,
        &interrupted,
        &mut io::stdout(),
        &mut io::stderr(),
    );
    ExitCode::from(ending.status())
}
