//! Bodies of a sheet that were measured: a file with the frequency response of the impact face.

use serde::Deserialize;

use super::{Exact, Frequency, NotFollowed, Ratio, SpecificImpedance};
use crate::records::Selector;
use crate::responses::{CompletionSheet, KindSheet, ResponseFile, SupportSheet};

/// A body by the measured response of its impact face, as `rodlab mobility` writes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredBodySheet {
    /// Name of the file, relative to the sheet, as `"hammer.uff"`.
    pub file: String,
    /// The data set, by number from 1 or by name; by default the only complex one.
    #[serde(default)]
    pub data_set: Option<Selector>,
    /// Column of the imaginary part, where it is one of its own.
    #[serde(default)]
    pub imaginary: Option<Selector>,
    /// What it is, as `Mobility` or `Accelerance`; by default as its unit says.
    #[serde(default)]
    pub kind: Option<KindSheet>,
    /// Data set of the standard error of the lines.
    #[serde(default)]
    pub standard_error: Option<Selector>,
    /// Data set of the coherence, which with `averages` tells the standard error.
    #[serde(default)]
    pub coherence: Option<Selector>,
    /// Number of hits that were averaged.
    #[serde(default)]
    pub averages: Option<usize>,
    /// Lines above this frequency are left out, as `"10 kHz"`; by default none is.
    #[serde(default)]
    pub up_to: Option<Exact<Frequency>>,
    /// What holds the body, as `Free(mass: "1.5 kg ± 1 gram")`; by default what the line at 0 Hz says.
    #[serde(default)]
    pub support: SupportSheet,
    /// Low lines of a free body by its weighed mass; by default they stay as measured.
    #[serde(default)]
    pub complete: Option<CompletionSheet>,
    /// Characteristic impedance of the material at the face, with which it answers at once.
    #[serde(default)]
    pub front_impedance: Option<NotFollowed<SpecificImpedance>>,
    /// Standard uncertainty of the scale, the same on all lines, as `"1 %"`: that of the sensors.
    #[serde(default)]
    pub scale_uncertainty: Option<Exact<Ratio>>,
    /// Takes off what the impulse response has ahead of the impulse; by default nothing is.
    #[serde(default)]
    pub causal: bool,
}

impl MeasuredBodySheet {
    /// Where the response stands.
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
