//! Measured bodies of a sheet: a file with the frequency response of the impact face.

use labio::ResponseKind;
use serde::Deserialize;

use crate::records::Selector;
use crate::responses::{CompletionSheet, ResponseFile, SupportSheet};
use crate::sheet::{Duration, Exact, Frequency, Ratio, SpecificImpedance, Stated};

/// A body, described by the measured response of its impact face, as written by `rodlab mobility`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredBodySheet {
    /// Name of the file, relative to the sheet, such as `"hammer.uff"`.
    pub file: String,
    /// The data set, by number from 1 or by name; by default the only complex data set.
    pub data_set: Option<Selector>,
    /// Column of the imaginary part, if it is separate.
    pub imaginary: Option<Selector>,
    /// Kind of response, such as `Mobility` or `Accelerance`; by default the kind that suits the
    /// unit.
    pub kind: Option<ResponseKind>,
    /// Data set with the standard errors of the lines.
    pub standard_error: Option<Selector>,
    /// Data set with the coherence, from which the standard error is computed together with
    /// `averages`.
    pub coherence: Option<Selector>,
    /// Number of averaged hits.
    pub averages: Option<usize>,
    /// Upper frequency of the lines used, such as `"10 kHz"`; by default all lines.
    pub up_to: Option<Exact<Frequency>>,
    /// Support of the body, such as `Free(mass: "1.5 kg ± 1 gram")`; by default the support that
    /// the line at 0 Hz indicates.
    #[serde(default)]
    pub support: SupportSheet,
    /// Replacement of low-frequency lines of a free body by its weighed mass; by default the lines
    /// stay as measured.
    pub complete: Option<CompletionSheet>,
    /// Characteristic impedance of the material at the face, such as `"2250 kg/s ± 2 %"`; it
    /// determines the response before any echo returns.
    pub front_impedance: Option<Stated<SpecificImpedance>>,
    /// Standard uncertainty of the scale, such as `"1 %"`, due to the sensors; common to all lines.
    pub scale_uncertainty: Option<Exact<Ratio>>,
    /// Standard uncertainty of the delay of the response relative to the force, such as `"2 us"`,
    /// due to the channels; common to all lines.
    pub delay_uncertainty: Option<Exact<Duration>>,
    /// Removes the part of the impulse response before the impulse; by default it is kept.
    #[serde(default)]
    pub causal: bool,
    /// Removes negative real parts, with which the body would generate energy; by default they are
    /// kept.
    #[serde(default)]
    pub passive: bool,
}

impl MeasuredBodySheet {
    /// Returns the file of the response.
    #[must_use]
    pub fn response(&self) -> ResponseFile {
        ResponseFile {
            file: self.file.clone(),
            data_set: self.data_set.clone(),
            imaginary: self.imaginary.clone(),
            kind: self.kind,
            standard_error: self.standard_error.clone(),
            coherence: self.coherence.clone(),
            averages: self.averages,
        }
    }
}
