//! Files that are read block by block must have the samples of the whole file.

use std::io::Cursor;

use labio::format::{self, Reader, Strictness};
use labio::{BlockSource, Channel, LabioError, Ordinate, Quantity};
use ndarray::Array2;

use super::{memory, prints};

/// Number of samples in a block: it divides neither the number of samples in the buffer of a reader
/// nor, usually, the number of samples in the file.
const BLOCK: usize = 7;

/// Returns all samples of `source`, channel by channel.
fn all(mut source: impl BlockSource) -> Result<Vec<Vec<f64>>, LabioError> {
    let rate = source.sampling_rate_hz();
    assert!(rate.is_finite() && rate > 0.0, "sampling rate {rate}");
    let mut block = Array2::zeros((source.channels().len(), BLOCK));
    let mut samples: Vec<Vec<f64>> = vec![Vec::new(); source.channels().len()];
    loop {
        let n = source.read_block(&mut block)?;
        if n == 0 {
            break;
        }
        for (row, samples) in block.rows().into_iter().zip(&mut samples) {
            samples.extend(row.iter().take(n));
        }
    }
    let announced = source.n_samples();
    for samples in &samples {
        assert!(announced.is_none_or(|n| n == samples.len() as u64));
        assert!(samples.iter().all(|sample| sample.is_finite()));
    }
    Ok(samples)
}

fn channels(n: usize) -> Vec<Channel> {
    let channel = |index| Channel::new(format!("channel {index}"), Quantity::Voltage);
    (0..n)
        .map(channel)
        .collect::<Result<_, _>>()
        .expect("names and quantities of channels")
}

/// Compares the blocks with the values of the whole file. If the blocks could not be read, checks
/// the message of their error.
fn same(blocks: Result<Vec<Vec<f64>>, LabioError>, whole: &[&[f64]]) {
    match blocks {
        Ok(blocks) => {
            assert_eq!(blocks.len(), whole.len());
            for (blocks, whole) in blocks.iter().zip(whole) {
                let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(blocks), bits(whole));
            }
        }
        Err(error) => prints(&error),
    }
}

/// Returns the values of all real series of a file.
fn reals(contents: &labio::Contents) -> Vec<&[f64]> {
    let series = contents.series.iter();
    series
        .filter_map(|series| match &series.ordinate {
            Ordinate::Real(values) => Some(values.as_slice()),
            Ordinate::Complex(_) => None,
        })
        .collect()
}

/// Checks that a WAVE file read in blocks has the samples of the whole file.
pub fn wav(bytes: &[u8]) {
    let whole = format::wav::Wav.read(bytes, Strictness::Strict);
    let n = whole.as_ref().map_or(1, |contents| contents.series.len());
    let blocks = format::wav::Blocks::new(Cursor::new(bytes), &channels(n), &vec![1.0; n]);
    match (blocks.and_then(all), whole) {
        (blocks, Ok(whole)) => same(blocks, &reals(&whole)),
        (Ok(blocks), Err(error)) => panic!(
            "{} channels are read in blocks, but not as a whole file: {error}",
            blocks.len()
        ),
        (Err(error), Err(_)) => prints(&error),
    }
}

/// Checks that an array of NumPy read in blocks, with and without a row of times, has the values of
/// the whole file.
pub fn npy(bytes: &[u8]) {
    let whole = format::npy::Npy.read(bytes, Strictness::Strict);
    let n = whole.as_ref().map_or(1, |contents| contents.series.len());
    let rows = whole.as_ref().map_or(Vec::new(), reals);
    let without = format::npy::Blocks::without_times(Cursor::new(bytes), &channels(n), 1.0);
    same(without.and_then(all), &rows);
    let with = format::npy::Blocks::new(Cursor::new(bytes), &channels(n.saturating_sub(1)));
    same(with.and_then(all), rows.get(1..).unwrap_or_default());
    let record = memory::bounded(bytes, || {
        format::npy::read_from(bytes, &channels(n.saturating_sub(1)))
    });
    if let Err(error) = record {
        prints(&error);
    }
}
