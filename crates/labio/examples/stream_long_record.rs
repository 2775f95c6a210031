//! Computes spectra of a record that is larger than memory: writes a file of two channels, streams
//! it, and prints the peak memory.
//!
//! ```text
//! cargo run --release --package labio --example stream_long_record [samples per channel [file]]
//! ```
//!
//! The default of 10^8 samples needs 1.6 GB in the folder for temporary files while the program
//! runs. A file named on the command line is kept; if it already has the right length, it is not
//! written again.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example prints its results, and may panic on a wrong index"
)]

use std::error::Error;
use std::fs::{self, File};
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::Path;
use std::time::Instant;

use labio::{BlockSource, Channel, LabioError, Quantity, Welch};
use ndarray::Array2;

const RATE: f64 = 51_200.0;

fn main() -> Result<(), Box<dyn Error>> {
    let n_samples: u64 = match std::env::args().nth(1) {
        Some(text) => text.parse()?,
        None => 100_000_000,
    };
    let folder = tempfile::tempdir()?;
    let path = match std::env::args().nth(2) {
        Some(path) => path.into(),
        None => folder.path().join("long.f64"),
    };
    if fs::metadata(&path).map_or(true, |found| found.len() != 16 * n_samples) {
        let started = Instant::now();
        write_record(&path, n_samples)?;
        println!(
            "wrote {:.3} GB in {:.1} s",
            16e-9 * n_samples as f64,
            started.elapsed().as_secs_f64()
        );
    }

    let started = Instant::now();
    let mut source = InterleavedFile::open(&path)?;
    let spectra = Welch::new(8192)?.spectra_of_stream(&mut source)?;
    let response = spectra.h1("input", "output")?;
    println!(
        "{n_samples} samples of two channels, {} segments, {:.0} independent, in {:.1} s",
        spectra.n_averages(),
        spectra.effective_averages(),
        started.elapsed().as_secs_f64()
    );

    // y_n = 0.9 y_(n-1) + x_n has the response 1/(1 - 0.9 z^-1)
    let line = 800;
    let angle = std::f64::consts::TAU * response.frequency_hz[line] / RATE;
    let exact = (1.0 - 0.9 * num_complex::Complex64::cis(-angle)).inv();
    let error = (response.values[line] / exact - 1.0).norm();
    let variance = response.variance.as_ref().ok_or("too short")?[line];
    println!(
        "at {:.0} Hz: off by {error:.1e} of the exact response, standard error {:.1e}",
        response.frequency_hz[line],
        variance.sqrt() / exact.norm()
    );
    match peak_memory_kb() {
        Some(kb) => println!("peak memory (VmHWM): {:.1} MB", kb * 1.024e-3),
        None => println!("peak memory: this system has no /proc/self/status"),
    }
    Ok(())
}

/// Writes noise, and the filtered noise with independent noise added, as interleaved little-endian
/// doubles.
fn write_record(path: &Path, n_samples: u64) -> Result<(), Box<dyn Error>> {
    let mut file = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let mut state = 1_u64;
    let mut noise = move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut output = 0.0;
    for _ in 0..n_samples {
        let input = noise();
        output = 0.9 * output + input;
        file.write_all(&input.to_le_bytes())?;
        file.write_all(&(output + noise()).to_le_bytes())?;
    }
    file.flush()?;
    Ok(())
}

/// A file of interleaved doubles.
struct InterleavedFile {
    file: BufReader<File>,
    channels: [Channel; 2],
    n_samples: u64,
}

impl InterleavedFile {
    fn open(path: &Path) -> Result<Self, LabioError> {
        let read = |source| LabioError::Read { source };
        let file = File::open(path).map_err(read)?;
        let n_bytes = file.metadata().map_err(read)?.len();
        Ok(Self {
            file: BufReader::with_capacity(1 << 20, file),
            channels: [
                Channel::new("input", Quantity::Force)?,
                Channel::new("output", Quantity::Velocity)?,
            ],
            n_samples: n_bytes / 16,
        })
    }
}

impl BlockSource for InterleavedFile {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn sampling_rate_hz(&self) -> f64 {
        RATE
    }

    fn n_samples(&self) -> Option<u64> {
        Some(self.n_samples)
    }

    fn read_block(&mut self, block: &mut Array2<f64>) -> Result<usize, LabioError> {
        if block.nrows() != 2 {
            return Err(LabioError::CountMismatch {
                what: "rows of a block",
                found: block.nrows(),
                expected: 2,
            });
        }
        let left = usize::try_from(self.n_samples).unwrap_or(usize::MAX);
        let n = block.ncols().min(left);
        let mut sample = [0; 8];
        for index in 0..n {
            for channel in 0..2 {
                self.file
                    .read_exact(&mut sample)
                    .map_err(|source| LabioError::Read { source })?;
                block[(channel, index)] = f64::from_le_bytes(sample);
            }
        }
        self.n_samples -= n as u64;
        Ok(n)
    }
}

/// Largest resident set of this process \[kB\].
fn peak_memory_kb() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
