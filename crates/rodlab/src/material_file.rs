//! File `material.json` of a result, which contains a fitted law with its errors and its density
//! for the sheets of later jobs.

use std::f64::consts::TAU;

use cmod::rheology::{FittedLaw, Law, LawError, MeasuredLaw, RheologicalFit};
use serde::{Deserialize, Serialize};

use crate::outcome::InputFile;
use crate::sheet::{ValueWithUncertainty, quoted};
use crate::{InStep, RodlabError};

/// Name of the file among the results.
pub(crate) const NAME: &str = "material.json";
/// First entry of the file.
const FORMAT: &str = "rodlab material 1";
/// Name of the error of the density among the error sources of a modulus that was computed with the
/// density.
pub(crate) const DENSITY: &str = "density";

/// A law with its errors and its density.
#[derive(Debug, Clone)]
pub(crate) struct MaterialFile {
    entries: Entries,
    law: MeasuredLaw,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entries {
    format: String,
    title: String,
    law: String,
    /// Reference frequency of a law with constant loss factor, or of a spring-pot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reference_frequency_hz: Option<f64>,
    parameters: Vec<ParameterEntry>,
    /// Density \[kg/m³\].
    density: f64,
    band_hz: [f64; 2],
    errors: Vec<ErrorEntry>,
    doubts: Vec<String>,
    inputs: Vec<InputEntry>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ParameterEntry {
    name: String,
    unit: String,
    value: f64,
}

/// Changes of density and parameters due to one standard uncertainty of one independent source.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ErrorEntry {
    source: String,
    /// Change of the density \[kg/m³\].
    density: f64,
    /// Changes of the parameters: relative for moduli and viscosities, of the natural logarithms
    /// for times and factors, and of the log odds for exponents.
    parameters: Vec<f64>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct InputEntry {
    path: String,
    sha256: String,
}

impl MaterialFile {
    /// Returns the material of a fitted law.
    ///
    /// If the modulus was computed with the density, the error of the density is the source called
    /// [`DENSITY`] among the errors of the modulus; otherwise it is independent.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] if the effect of a common error cannot be expressed by a change of the
    /// parameters.
    pub(crate) fn of(
        title: &str,
        fit: &RheologicalFit,
        density: ValueWithUncertainty,
        band_hz: [f64; 2],
        doubts: Vec<String>,
        inputs: &[InputFile],
    ) -> Result<Self, RodlabError> {
        let law = MeasuredLaw::of(fit).in_step(NAME)?;
        let mut errors: Vec<ErrorEntry> = law
            .errors()
            .iter()
            .map(|error| ErrorEntry {
                density: if error.source == DENSITY {
                    density.uncertainty()
                } else {
                    0.0
                },
                source: error.source.clone(),
                parameters: error.shift.clone(),
            })
            .collect();
        if density.uncertainty() > 0.0 && !errors.iter().any(|error| error.source == DENSITY) {
            errors.push(ErrorEntry {
                source: DENSITY.to_owned(),
                density: density.uncertainty(),
                parameters: vec![0.0; fit.parameters.len()],
            });
        }
        let entries = Entries {
            format: FORMAT.to_owned(),
            title: title.to_owned(),
            law: fit.law.law().to_string(),
            reference_frequency_hz: fit.law.reference_omega().map(|omega| omega / TAU),
            parameters: fit
                .parameters
                .iter()
                .map(|parameter| ParameterEntry {
                    name: parameter.name.clone(),
                    unit: parameter.unit.to_owned(),
                    value: parameter.value,
                })
                .collect(),
            density: density.value,
            band_hz,
            errors,
            doubts,
            inputs: inputs
                .iter()
                .map(|input| InputEntry {
                    path: input.path.clone(),
                    sha256: input.sha256.clone(),
                })
                .collect(),
        };
        let law = entries.law(NAME)?;
        Ok(Self { entries, law })
    }

    /// Reads the file; `what` completes the message "reading …".
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] for a text that is not a material file, and for parameters out of
    /// their range; [`RodlabError::Request`] for a file of another version, and for a density or a
    /// band out of range.
    pub(crate) fn read(bytes: &[u8], what: &str) -> Result<Self, RodlabError> {
        let entries: Entries = serde_json::from_slice(bytes).in_step(what)?;
        if entries.format != FORMAT {
            return Err(RodlabError::request(
                what,
                format!("format `{}`", entries.format),
                format!("`{FORMAT}`"),
            ));
        }
        let [from, to] = entries.band_hz;
        let finite = entries.errors.iter().all(|error| error.density.is_finite());
        if !(entries.density > 0.0
            && entries.density.is_finite()
            && finite
            && 0.0 < from
            && from <= to)
        {
            return Err(RodlabError::request(
                what,
                format!(
                    "density {} kg/m3, band from {from} Hz to {to} Hz",
                    entries.density
                ),
                "a density above 0 with finite errors, and an increasing band above 0 Hz",
            ));
        }
        let law = entries.law(what)?;
        Ok(Self { entries, law })
    }

    /// Returns the text of the file.
    pub(crate) fn text(&self) -> Result<Vec<u8>, RodlabError> {
        let mut text = serde_json::to_vec_pretty(&self.entries).in_step(NAME)?;
        text.push(b'\n');
        Ok(text)
    }

    /// Returns the reasons why the law is in doubt.
    pub(crate) fn doubts(&self) -> &[String] {
        &self.entries.doubts
    }

    /// Returns the lowest and the highest frequency of the data \[Hz\].
    pub(crate) fn band_hz(&self) -> [f64; 2] {
        self.entries.band_hz
    }

    /// Returns the sources of the independent errors.
    pub(crate) fn sources(&self) -> impl Iterator<Item = &str> {
        self.entries
            .errors
            .iter()
            .map(|error| error.source.as_str())
    }

    /// Returns density \[kg/m³\] and law, with each error moved by `standard` times its standard
    /// uncertainty.
    pub(crate) fn moved(
        &self,
        standard: &[f64],
        field: &str,
    ) -> Result<(f64, FittedLaw), RodlabError> {
        let law = self.law.moved(standard).in_step(field)?;
        let errors = self.entries.errors.iter().zip(standard);
        let change: f64 = errors.map(|(error, z)| z * error.density).sum();
        Ok((self.entries.density + change, law))
    }
}

impl Entries {
    fn law(&self, what: &str) -> Result<MeasuredLaw, RodlabError> {
        let kinds = Law::all(self.density);
        let law = kinds
            .into_iter()
            .find(|law| law.to_string() == self.law)
            .ok_or_else(|| {
                let found = format!("law `{}`", self.law);
                let names = quoted(kinds.map(|law| law.to_string()));
                RodlabError::request(what, found, format!("one of {names}"))
            })?;
        let values: Vec<f64> = self.parameters.iter().map(|entry| entry.value).collect();
        let reference_omega = self.reference_frequency_hz.map(|f| TAU * f);
        let law = law
            .with_parameters(&values, reference_omega)
            .in_step(what)?;
        let errors = self.errors.iter().map(|error| LawError {
            source: error.source.clone(),
            shift: error.parameters.clone(),
        });
        MeasuredLaw::new(law, errors.collect()).in_step(what)
    }
}
