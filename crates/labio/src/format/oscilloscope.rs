//! Waveforms of oscilloscopes, read only: LeCroy (`.trc`), Tektronix (`.wfm`, `.isf`).
//!
//! Each trace is a series in the vertical unit of the file; its abscissa is the time from the
//! trigger. Each segment of a sequence or of a fast frame is a separate series, `C1 (segment 2)`. A
//! number stored in single precision, such as the interval of a LeCroy trace, is read as the
//! shortest decimal number with that single-precision value.
//!
//! # Rejected files
//!
//! Envelopes, histograms, pixel maps and complex traces are rejected with an error that names the
//! kind. A strict reading rejects a file that is shorter than its header states; a tolerant one
//! returns the samples that exist.

mod fields;
mod isf;
mod lecroy;
mod wfm;

pub use isf::TektronixIsf;
pub use lecroy::LeCroy;
pub use wfm::TektronixWfm;

use crate::format::text::axis;
use crate::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesKind};

/// A trace, or a segment of one.
struct Trace {
    name: String,
    /// Time of the first sample; `step` is the time between samples.
    start: f64,
    step: f64,
    time_unit: String,
    values: Vec<f64>,
    unit: String,
    properties: Vec<(String, String)>,
}

impl Trace {
    fn into_series(self) -> Series {
        // LeCroy writes the unit second as a capital `S`, which is the symbol of the siemens
        let seconds = if self.time_unit.eq_ignore_ascii_case("s") {
            "s".to_owned()
        } else {
            self.time_unit
        };
        Series {
            name: self.name,
            kind: SeriesKind::TimeResponse,
            abscissa: Abscissa::Even {
                start: self.start,
                step: self.step,
            },
            ordinate: Ordinate::Real(self.values),
            abscissa_axis: axis("time", seconds),
            ordinate_axis: axis("", self.unit),
            properties: self.properties,
        }
    }
}

/// Returns the contents of traces, with the defect of a file that is too short.
fn contents(format: &'static str, traces: Vec<Trace>, cut: Option<LabioError>) -> Contents {
    let mut contents = Contents::of_format(format);
    contents.series = traces.into_iter().map(Trace::into_series).collect();
    contents.defects.extend(cut);
    contents
}

/// Returns the shortest decimal number that is stored as `value` in single precision.
fn decimal(value: f32) -> f64 {
    value
        .to_string()
        .parse()
        .unwrap_or_else(|_| f64::from(value))
}
