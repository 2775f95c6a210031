//! Behaviour of a body at low frequency, where force transducers measure poorly.

use impulse::{LowFrequency, MeasuredBody, WeighedMass};
use labio::{FrequencyResponse, ResponseKind, RigidBand, RigidBody};
use num_complex::Complex64;
use serde::Deserialize;

use super::{expect_undamped, line_spacing_hz};
use crate::sheet::{
    Exact, Frequency, ImpactMass, NotFollowed, SpecificImpedance, Stated, ValueWithUncertainty,
};
use crate::{InStep, RodlabError};

/// Support of a body.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum SupportSheet {
    /// No support: below its first resonance, the body moves like a rigid mass.
    Free {
        /// Mass of the body, such as `"1.504 kg ± 1 gram"`.
        mass: Stated<ImpactMass>,
    },
    /// A rigid support.
    Fixed,
    /// A rod so long that no wave returns.
    LongRod {
        /// Characteristic impedance of the rod, such as `"392 kg/s"`.
        impedance: NotFollowed<SpecificImpedance>,
    },
    /// The support that the line at 0 Hz indicates.
    #[default]
    AsMeasured,
}

impl SupportSheet {
    /// Returns the support in words, for the report.
    #[must_use]
    pub fn in_words(&self) -> String {
        match self {
            Self::Free { mass } => format!("free, mass {mass}"),
            Self::Fixed => "fixed".to_owned(),
            Self::LongRod { impedance } => format!("a long rod, impedance {impedance}"),
            Self::AsMeasured => "as indicated by the line at 0 Hz".to_owned(),
        }
    }

    /// Returns the weighed mass of a free body; `None` for other supports.
    #[must_use]
    pub fn weighed(&self) -> Option<WeighedMass> {
        match self {
            Self::Free { mass } => {
                let mass = mass.with_uncertainty();
                Some(WeighedMass {
                    mass: mass.value,
                    standard_error: mass.uncertainty(),
                })
            }
            _ => None,
        }
    }
}

/// Replacement of low-frequency lines by the lines of a rigid body with the weighed mass.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CompletionSheet {
    /// Lines below this frequency are replaced, such as `"30 Hz"`.
    pub below: Exact<Frequency>,
    /// Lines from `below` up to this frequency, well below the first resonance, determine the
    /// elastic term, such as `"200 Hz"`.
    pub fitted_to: Exact<Frequency>,
}

impl CompletionSheet {
    /// Returns `response` with its low-frequency lines replaced, and the number of the first
    /// measured line.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Request`] for a body that is not free; [`RodlabError::Step`] for an error of
    /// `labio`.
    pub fn complete(
        &self,
        response: &FrequencyResponse,
        support: &SupportSheet,
        field: &str,
    ) -> Result<(FrequencyResponse, usize), RodlabError> {
        let Some(weighed) = support.weighed() else {
            return Err(RodlabError::request(
                field,
                "stated",
                "a free body, whose weighed mass replaces the low-frequency lines",
            ));
        };
        let completed = RigidBody::new(weighed.mass, weighed.standard_error)
            .and_then(|body| {
                body.complete(
                    response,
                    RigidBand {
                        from_hz: self.below.si(),
                        to_hz: self.fitted_to.si(),
                    },
                )
            })
            .in_step(field)?;
        Ok((completed.response, completed.first_measured))
    }
}

/// Returns the body with this driving-point response, which may be of any kind.
///
/// # Errors
///
/// [`RodlabError::Request`] for a response with an exponential window; [`RodlabError::Step`] if
/// `labio` cannot convert the kind, or if `impulse` refuses a line, such as a line without
/// information.
pub fn measured_body(
    response: &FrequencyResponse,
    support: &SupportSheet,
    front_impedance: Option<ValueWithUncertainty>,
    field: &str,
) -> Result<MeasuredBody, RodlabError> {
    expect_undamped(response, field)?;
    let mobility = response.to_kind(ResponseKind::Mobility).in_step(field)?;
    let mut values = mobility.values.clone();
    let (low, front) = match support {
        SupportSheet::Fixed => (LowFrequency::Fixed, None),
        SupportSheet::LongRod { impedance } => {
            if let Some(first) = values.first_mut() {
                *first = Complex64::from(1.0 / impedance.si());
            }
            (LowFrequency::Measured, Some(impedance.si()))
        }
        free => match free.weighed() {
            Some(weighed) => (LowFrequency::Free(weighed), None),
            None => (LowFrequency::Measured, None),
        },
    };
    let spacing = line_spacing_hz(&mobility)?;
    let mut body = MeasuredBody::from_mobility(&values, spacing, low).in_step(field)?;
    if let Some(variance) = &mobility.variance {
        let mut variance = variance.clone();
        if let Some(first) = variance.first_mut() {
            *first = 0.0;
        }
        body = body.with_variance(&variance).in_step(field)?;
        if let Some(freedom) = &mobility.degrees_of_freedom {
            body = body.with_degrees_of_freedom(freedom).in_step(field)?;
        }
    }
    let common = mobility.common_error.iter().flatten();
    let scale = common
        .copied()
        .filter(|e| e.is_finite())
        .fold(0.0, f64::max);
    body = body.with_scale_error(scale).in_step(field)?;
    if let Some(impedance) = front_impedance.map(|stated| stated.value).or(front) {
        body = body.with_front_impedance(impedance).in_step(field)?;
    }
    let front_error = front_impedance.map_or(0.0, |stated| stated.uncertainty());
    body.with_front_error(front_error).in_step(field)
}
