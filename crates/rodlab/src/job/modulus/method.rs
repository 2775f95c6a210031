//! Methods for the modulus: their sheets, their arrangements of sensors and their construction.

mod arrangement;
pub(super) mod rod;
mod section;

use cmod::multi_point::{GaugeMethod, Quantity};
use cmod::section_ratio::RatioMethod;
use cmod::two_point::SpecimenUncertainty;
use cmod::{
    CmodError, FreeEnd, MultiPoint, OneGauge, PulsedRod, Resonances, SeparatePulses, Solver,
    Specimen, ThreePoint, TwoPoint,
};
use labio::{ResponseRatio, SectionSpectra};
use serde::Deserialize;

use super::ModulusSheet;
use crate::RodlabError;
use crate::sheet::{Coordinate, Exact, Language, Length, Stated, Time, Velocity};
pub(super) use arrangement::{Arrangement, Counted, FromHits, Pulse, Taken, Vibration};
use rod::{
    end_mass, gauge_quantity, gauge_uncertainty, gauged_rod, length, limits, noise_freedom,
    rod_with_free_end, section_uncertainty, uncertainty,
};
pub(super) use section::of_channel;
pub use section::{GaugeSheet, SectionSheet, WindowSheet};

/// Method with its data.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum MethodSheet {
    /// The motions of both ends of a rod struck at one of them (paper A).
    TwoPoint {
        /// Channel of the struck end.
        impacted_end: String,
        /// Channel of the other end.
        free_end: String,
        /// Solver of the equation; `Continuation` by default.
        #[serde(default)]
        solver: Option<Solver>,
    },
    /// The motions of both ends of a rod, evaluated at the resonances only.
    Resonances {
        /// Channel of the struck end.
        impacted_end: String,
        /// Channel of the other end.
        free_end: String,
    },
    /// Frequencies and decays of the longitudinal modes of a freely hanging rod after an impact,
    /// for metals, ceramics and glasses. One sensor of motion, strain or sound anywhere on the rod
    /// is sufficient.
    FreeVibration {
        /// Channel of the sensor.
        channel: String,
        /// Beginning of the evaluated free vibration, after the hammer has left the rod, measured
        /// from the beginning of a hit's record, such as `"5 ms"`.
        from: Exact<Time>,
        /// Guess of the wave speed, such as `"5100 m/s"`, within a fifth of the true value; it
        /// determines the numbers of the modes.
        wave_speed: Exact<Velocity>,
    },
    /// Two sections of a rod with a free end.
    FreeEnd {
        /// The section in the numerator, usually the one nearer to the impact.
        first: SectionSheet,
        /// The section in the denominator, usually the free end.
        second: SectionSheet,
        /// Guess of the wave speed, such as `"1700 m/s"`, within 30 % of the true value; by default
        /// the speed is searched.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
    },
    /// One pulse at two sections, before any reflection returns.
    SeparatePulses {
        /// The section that the pulse passes first.
        first: WindowSheet,
        /// The section that the pulse passes second.
        second: WindowSheet,
        /// Distance between the two sections.
        distance: Stated<Length>,
        /// Guess of the wave speed; by default the speed is searched.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
    },
    /// The incident pulse and the reflected pulse at one section of a rod with a free end.
    OneGauge {
        /// The section.
        section: SectionSheet,
        /// Start and end of the incident pulse, measured from the beginning of a hit's record.
        incident: (Exact<Time>, Exact<Time>),
        /// Start and end of the reflected pulse.
        reflected: (Exact<Time>, Exact<Time>),
        /// Guess of the wave speed; by default the speed is searched.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
    },
    /// Three equidistant gauges, in closed form (paper B).
    ThreePoint {
        /// The gauges, in order of their positions.
        gauges: Vec<GaugeSheet>,
    },
    /// Three or more gauges at any positions, or two before a free end, by least squares.
    MultiPoint {
        /// The gauges, in order of their positions.
        gauges: Vec<GaugeSheet>,
        /// Guess of the wave speed; by default the speed is searched.
        #[serde(default)]
        wave_speed: Option<Exact<Velocity>>,
        /// Position of a free end beyond the last gauge, if the rod has one. For two gauges the
        /// free end, with the `accelerometer_mass` of the specimen on it, is the third condition.
        /// Three or more gauges are checked against it.
        #[serde(default)]
        free_end_at: Option<Stated<Coordinate>>,
    },
}

impl MethodSheet {
    /// Returns the name of the method in the sheet, and its name for a sentence.
    fn names(&self) -> (&'static str, &'static str) {
        match self {
            Self::TwoPoint { .. } => ("TwoPoint", "the two-point method"),
            Self::Resonances { .. } => ("Resonances", "the resonances of the rod"),
            Self::FreeVibration { .. } => (
                "FreeVibration",
                "frequency and decay of the modes of the free rod",
            ),
            Self::FreeEnd { .. } => ("FreeEnd", "the method of two sections and a free end"),
            Self::SeparatePulses { .. } => ("SeparatePulses", "separate pulses at two sections"),
            Self::OneGauge { .. } => (
                "OneGauge",
                "the incident and the reflected pulse at one gauge",
            ),
            Self::ThreePoint { .. } => ("ThreePoint", "the three-point method"),
            Self::MultiPoint { .. } => ("MultiPoint", "least squares over all gauges"),
        }
    }

    /// Returns the name of the method in the sheet.
    pub(super) fn name(&self) -> &'static str {
        self.names().0
    }

    /// Returns the name of the method for a sentence.
    pub(super) fn words(&self) -> &'static str {
        self.names().1
    }

    /// Returns the place in the sheet of the field `name` of the method.
    pub(super) fn field(&self, name: &str) -> String {
        format!("method.{}.{name}", Language::Toml.name_of(self.name()))
    }

    /// Returns the optional field of the method, and its default in words.
    pub(super) fn left_open(&self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::TwoPoint { .. } => Some(("method.solver", "continuation in the mass ratio")),
            Self::FreeEnd { .. }
            | Self::SeparatePulses { .. }
            | Self::OneGauge { .. }
            | Self::MultiPoint { .. } => Some(("method.wave_speed", "searched")),
            Self::Resonances { .. } | Self::FreeVibration { .. } | Self::ThreePoint { .. } => None,
        }
    }

    /// Returns the sensors of the method.
    pub(super) fn arrangement(&self) -> Arrangement<'_> {
        match self {
            Self::TwoPoint {
                impacted_end,
                free_end,
                ..
            }
            | Self::Resonances {
                impacted_end,
                free_end,
            } => Arrangement::Ends {
                impacted_end,
                free_end,
            },
            Self::FreeVibration {
                channel,
                from,
                wave_speed,
            } => Arrangement::FreeRod(Vibration {
                channel,
                from,
                wave_speed,
            }),
            Self::FreeEnd { first, second, .. } => Arrangement::Sections { first, second },
            Self::SeparatePulses {
                first,
                second,
                distance,
                ..
            } => Arrangement::Pulses {
                first,
                second,
                distance,
            },
            Self::OneGauge {
                section,
                incident,
                reflected,
                ..
            } => Arrangement::OneGauge {
                section,
                incident,
                reflected,
            },
            Self::ThreePoint { gauges } => Arrangement::Gauges {
                gauges,
                free_end_at: None,
                may_ring: false,
            },
            // with two gauges, the free end is the third condition
            Self::MultiPoint {
                gauges,
                free_end_at,
                ..
            } => Arrangement::Gauges {
                gauges,
                free_end_at: free_end_at.as_ref().filter(|_| gauges.len() == 2),
                may_ring: true,
            },
        }
    }
}

/// Returns the method of the sheet for a ratio; `quantities` are those of the channels of the hits.
pub(super) fn ratio_method(
    sheet: &ModulusSheet,
    quantities: &[(String, Quantity)],
    ratio: &ResponseRatio,
) -> Result<Box<dyn RatioMethod>, RodlabError> {
    let (specimen, limits) = (&sheet.specimen, limits(sheet));
    let diameter = specimen.diameter.with_uncertainty();
    let density = specimen.density.with_uncertainty();
    let at = |one, field| rod::section(quantities, one, &sheet.method.field(field));
    match &sheet.method {
        MethodSheet::TwoPoint { solver, .. } => TwoPoint::new(Specimen {
            length: length(sheet)?,
            diameter: diameter.value,
            density: density.value,
            accelerometer_mass: end_mass(sheet),
        })
        .and_then(|method| method.with_limits(limits))
        .and_then(|method| {
            method.with_specimen_uncertainty(SpecimenUncertainty {
                length: uncertainty(specimen.length.as_ref()),
                diameter: diameter.uncertainty(),
                density: density.uncertainty(),
                accelerometer_mass: uncertainty(specimen.accelerometer_mass.as_ref()),
            })
        })
        .map(|method| boxed(method.with_solver(solver.unwrap_or_default()))),
        MethodSheet::Resonances { .. } => {
            let error = uncertainty(specimen.length.as_ref());
            Resonances::new(rod_with_free_end(sheet), length(sheet)?)
                .and_then(|method| method.with_limits(limits))
                .and_then(|method| method.with_uncertainty(section_uncertainty(sheet, error)))
                .map(boxed)
        }
        MethodSheet::FreeEnd {
            first,
            second,
            wave_speed,
        } => {
            let sections = (at(first, "first")?, at(second, "second")?);
            let error = uncertainty(Some(&first.from_free_end))
                .max(uncertainty(Some(&second.from_free_end)));
            FreeEnd::new(rod_with_free_end(sheet), sections.0, sections.1)
                .and_then(|method| method.with_limits(limits))
                .and_then(|method| method.with_uncertainty(section_uncertainty(sheet, error)))
                .and_then(|method| if_some(method, speed(wave_speed), FreeEnd::with_wave_speed))
                .map(boxed)
        }
        MethodSheet::SeparatePulses {
            distance,
            wave_speed,
            ..
        } => {
            let error = uncertainty(Some(distance));
            SeparatePulses::new(PulsedRod {
                distance: distance.with_uncertainty().value,
                diameter: diameter.value,
                density: density.value,
            })
            .and_then(|method| method.with_limits(limits))
            .and_then(|method| method.with_uncertainty(section_uncertainty(sheet, error)))
            .and_then(|method| if_some(method, speed(wave_speed), SeparatePulses::with_wave_speed))
            .and_then(|method| if_some(method, ratio.delay, SeparatePulses::with_delay))
            .map(boxed)
        }
        MethodSheet::OneGauge {
            section,
            wave_speed,
            ..
        } => {
            let error = uncertainty(Some(&section.from_free_end));
            OneGauge::new(rod_with_free_end(sheet), at(section, "section")?)
                .and_then(|method| method.with_limits(limits))
                .and_then(|method| method.with_uncertainty(section_uncertainty(sheet, error)))
                .and_then(|method| if_some(method, speed(wave_speed), OneGauge::with_wave_speed))
                .and_then(|method| if_some(method, ratio.delay, OneGauge::with_delay))
                .map(boxed)
        }
        // for these methods a ratio has been refused before it is read
        MethodSheet::ThreePoint { .. }
        | MethodSheet::MultiPoint { .. }
        | MethodSheet::FreeVibration { .. } => {
            sheet.method.ratio_in_words()?;
            Err(CmodError::NoLines)
        }
    }
    .map_err(refused)
}

/// Returns the method of the sheet for the spectra of gauges; `quantities` are those of the
/// channels of the hits.
pub(super) fn gauge_method(
    sheet: &ModulusSheet,
    quantities: &[(String, Quantity)],
    spectra: &SectionSpectra,
) -> Result<Box<dyn GaugeMethod>, CmodError> {
    let limits = limits(sheet);
    match &sheet.method {
        MethodSheet::ThreePoint { gauges } => ThreePoint::new(gauged_rod(sheet, gauges))?
            .with_limits(limits)?
            .with_noise_freedom(noise_freedom(spectra)?)?
            .with_uncertainty(gauge_uncertainty(sheet, gauges, spectra))
            .map(|method| Box::new(method) as Box<dyn GaugeMethod>),
        MethodSheet::MultiPoint {
            gauges, wave_speed, ..
        } => {
            let rod = gauged_rod(sheet, gauges);
            let method = match sheet.method.used_free_end() {
                Some(end) => MultiPoint::before_free_end(rod, end.with_uncertainty().value)?
                    .with_end_mass(end_mass(sheet))?,
                None => MultiPoint::new(rod)?,
            }
            .with_limits(limits)?
            .with_added_damping(spectra.decay_rate())?
            .with_uncertainty(gauge_uncertainty(sheet, gauges, spectra))?;
            let method = if_some(method, speed(wave_speed), MultiPoint::with_wave_speed)?
                .with_noise_freedom(noise_freedom(spectra)?)?;
            Ok(Box::new(
                method.with_quantity(gauge_quantity(quantities, gauges)),
            ))
        }
        MethodSheet::TwoPoint { .. }
        | MethodSheet::Resonances { .. }
        | MethodSheet::FreeVibration { .. }
        | MethodSheet::FreeEnd { .. }
        | MethodSheet::SeparatePulses { .. }
        | MethodSheet::OneGauge { .. } => Err(CmodError::NoLines),
    }
}

fn boxed(method: impl RatioMethod + 'static) -> Box<dyn RatioMethod> {
    Box::new(method)
}

fn speed(stated: &Option<Exact<Velocity>>) -> Option<f64> {
    stated.as_ref().map(Exact::si)
}

/// Returns the method with a setting, if there is a value for it.
fn if_some<M>(
    method: M,
    value: Option<f64>,
    set: impl FnOnce(M, f64) -> Result<M, CmodError>,
) -> Result<M, CmodError> {
    match value {
        Some(value) => set(method, value),
        None => Ok(method),
    }
}

pub(super) fn refused(error: CmodError) -> RodlabError {
    RodlabError::step("finding the modulus", error)
}
