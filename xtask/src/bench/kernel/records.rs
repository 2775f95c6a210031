//! Kernels of records: averaged spectra of hits, and the reading of a universal file.

use std::hint::black_box;

use labio::format::uff58::{Encoding, Precision, Uff58, Uff58Writer};
use labio::format::{Reader, Strictness, Writer};
use labio::{
    Abscissa, AveragedSpectra, Channel, Contents, Ordinate, Provenance, Quantity, Record, Series,
    SeriesAxis, SeriesKind, Window,
};
use ndarray::Array2;
use num_complex::Complex64;

use super::{Kernel, noise};

pub(super) const SPECTRA_OF_HITS: Kernel = Kernel {
    name: "spectra-of-hits",
    what: "frequency response and coherence of three hits of two channels, 16 384 samples each",
    of: "sample",
    count: 3 * 2 * 16_384,
    prepare: || {
        let mut state = 1;
        let hits = (0..3)
            .map(|_| hit(16_384, &mut state))
            .collect::<Result<Vec<Record>, _>>()?;
        Ok(Box::new(move || {
            let spectra = AveragedSpectra::of(black_box(&hits), Window::Rectangular)?;
            black_box((
                spectra.h1("force", "response")?,
                spectra.coherence("force", "response")?,
            ));
            Ok(())
        }))
    },
};

/// Returns a hit whose input is noise. Its output is the input after a low-pass filter, with
/// additional noise.
fn hit(n_samples: usize, state: &mut u64) -> Result<Record, labio::LabioError> {
    let mut samples = Array2::zeros((2, n_samples));
    let mut output = 0.0;
    for n in 0..n_samples {
        let input = noise(state);
        output = 0.9 * output + input;
        samples[(0, n)] = input;
        samples[(1, n)] = output + 0.1 * noise(state);
    }
    let channels = vec![
        Channel::new("force", Quantity::Force)?,
        Channel::new("response", Quantity::Acceleration)?,
    ];
    Record::new(
        samples,
        51_200.0,
        0.0,
        channels,
        Provenance::computed("noise"),
    )
}

pub(super) const UNIVERSAL_FILE: Kernel = Kernel {
    name: "universal-file",
    what: "reading a universal file of 4097 complex lines in text of 13 digits",
    of: "line",
    count: 4097,
    prepare: || {
        let values = (0..4097_u32).map(|line| {
            let ratio = f64::from(line) / 625.3;
            1e-7 / Complex64::new(1.0 - ratio * ratio, 0.02 * ratio)
        });
        let mut contents = Contents::of_format("computed");
        contents.series.push(Series {
            name: "end A".to_owned(),
            kind: SeriesKind::FrequencyResponse,
            abscissa: Abscissa::Even {
                start: 0.0,
                step: 0.5,
            },
            ordinate: Ordinate::Complex(values.collect()),
            abscissa_axis: SeriesAxis::default(),
            ordinate_axis: SeriesAxis::default(),
            properties: Vec::new(),
        });
        let writer = Uff58Writer {
            encoding: Encoding::Ascii,
            precision: Precision::Double,
        };
        let mut file = Vec::new();
        writer.write(&contents, &mut file)?;
        Ok(Box::new(move || {
            black_box(Uff58.read(black_box(&file), Strictness::Strict)?);
            Ok(())
        }))
    },
};
