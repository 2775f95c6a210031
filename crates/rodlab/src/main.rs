//! The program `rodlab`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(rodlab::process::run(std::env::args_os()))
}
