//! Reads a universal file and writes it as text or as a 58b: `rewrite_uff58 INPUT OUTPUT
//! text|little-endian|big-endian`.
//!
//! `fixtures/reference/pyuff/make.py` runs this program and lets pyuff read the files that it
//! writes.
#![allow(
    clippy::print_stderr,
    reason = "a command-line program writes to the terminal"
)]

use std::process::ExitCode;

use labio::LabioError;
use labio::format;
use labio::format::uff58::{ByteOrder, Encoding, Precision, Uff58Writer};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, output, encoding] = arguments.as_slice() else {
        eprintln!("usage: rewrite_uff58 INPUT OUTPUT text|little-endian|big-endian");
        return ExitCode::FAILURE;
    };
    let encoding = match encoding.as_str() {
        "text" => Encoding::Ascii,
        "little-endian" => Encoding::Binary(ByteOrder::LittleEndian),
        "big-endian" => Encoding::Binary(ByteOrder::BigEndian),
        other => {
            eprintln!("encoding `{other}`, expected text, little-endian or big-endian");
            return ExitCode::FAILURE;
        }
    };
    match rewrite(input, output, encoding) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn rewrite(input: &str, output: &str, encoding: Encoding) -> Result<(), LabioError> {
    let writer = Uff58Writer {
        encoding,
        precision: Precision::Double,
    };
    format::write(output, &format::read(input)?, &writer)
}
