//! Calibration of a long bar: propagation of its waves, measured in one or more shots.
//!
//! The methods are those of [`modulus`]. Two or more gauges before the free end are evaluated by
//! least squares; one gauge is evaluated from the pulse and its reflection, whose windows are found
//! here.

mod figures;
mod passages;
mod separated;
mod table;

use serde::Deserialize;

use super::modulus::{
    self, ChecksSheet, Found, GaugeSheet, LateralInertiaSheet, LimitsSheet, MethodSheet,
    ModulusSheet, SectionSheet, SourceSheet, SpecimenSheet, TailSheet,
};
use super::{About, JobContext};
use crate::hits::HitsSheet;
use crate::laws::LawsSheet;
use crate::outcome::Setting;
use crate::records::Records;
use crate::sheet::{
    BandSheet, Coordinate, Density, Duration, Exact, Frequency, Length, PoissonRatio, Stated,
    Velocity,
};
use crate::{InStep, Outcome, RodlabError};
use passages::Passages;

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BarSheet {
    /// Title of the test.
    pub title: String,
    /// Persons, place, date and object of the test.
    #[serde(default)]
    pub about: About,
    /// The bar, free at one end and struck at the other.
    pub bar: LongBarSheet,
    /// One gauge, or more in the order in which the pulse passes them.
    pub gauges: Vec<BarGaugeSheet>,
    /// Files and channels; each record is a shot.
    pub records: Records,
    /// Silence of each record before the pulse, such as `"0.9 ms"`; the level at rest and the noise
    /// are measured in it.
    pub silent: Exact<Duration>,
    /// Guess of the wave speed, such as `"1700 m/s"`; by default the speed is searched.
    pub wave_speed: Option<Exact<Velocity>>,
    /// Lines used, such as `(from: "500 Hz", to: "15 kHz")`; by default all lines above 0 Hz.
    pub band: Option<BandSheet>,
    /// Requirements of a valid line.
    #[serde(default)]
    pub limits: LimitsSheet,
    /// Checks that need no reference values.
    #[serde(default)]
    pub checks: ChecksSheet,
    /// Laws fitted to the valid lines; later sheets can use the preferred law as a material.
    pub laws: Option<LawsSheet>,
    /// Frequencies whose results are reported individually.
    pub report_at: Option<Vec<Exact<Frequency>>>,
    /// Number of Monte Carlo draws, such as 1000, of the noise and of every quantity stated with ±;
    /// they check the linear errors.
    pub monte_carlo: Option<usize>,
}

/// The bar.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LongBarSheet {
    /// Length, such as `"2500 mm"`.
    pub length: Exact<Length>,
    /// Diameter, such as `"20 mm"`.
    pub diameter: Exact<Length>,
    /// Density, such as `"1190 kg/m3 ± 1 kg/m3"`. The modulus depends on it; the measured wave
    /// propagation does not.
    pub density: Stated<Density>,
    /// Poisson's ratio, such as `"0.37 ± 0.02"`, for lateral inertia; `"0"` for simulated
    /// one-dimensional waves.
    pub poisson_ratio: Option<Stated<PoissonRatio>>,
}

/// A gauge.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BarGaugeSheet {
    /// Channel.
    pub channel: String,
    /// Distance from the free end, such as `"900 mm ± 0.5 mm"`.
    pub from_free_end: Stated<Length>,
}

impl BarGaugeSheet {
    fn distance(&self) -> f64 {
        self.from_free_end.with_uncertainty().value
    }
}

impl BarSheet {
    /// Refuses gauges that cannot be on the bar, or are not in the order in which the pulse passes
    /// them.
    fn check(&self) -> Result<(), RodlabError> {
        RodlabError::refuse_empty(
            &self.gauges,
            "gauges",
            "one or more gauges between the struck end and the free end",
        )?;
        let mut before = self.bar.length.si();
        for (at, gauge) in self.gauges.iter().enumerate() {
            if gauge.distance() >= before {
                return Err(RodlabError::request(
                    format!("gauges[{at}].from_free_end"),
                    format!("`{}`", gauge.from_free_end),
                    if at == 0 {
                        format!("less than the length of the bar, {}", self.bar.length)
                    } else {
                        "less than that of the previous gauge: state the gauges in the order in which the pulse passes them".to_owned()
                    },
                ));
            }
            before = gauge.distance();
        }
        Ok(())
    }

    /// Returns a sheet for the job [`modulus`] that evaluates this test.
    fn as_modulus(&self, passages: &Passages) -> Result<ModulusSheet, RodlabError> {
        let method = match (self.gauges.as_slice(), passages.stated_windows()?) {
            ([gauge], Some([incident, reflected])) => MethodSheet::OneGauge {
                section: SectionSheet {
                    channel: gauge.channel.clone(),
                    from_free_end: coordinate(&gauge.from_free_end.to_string())?,
                    quantity: None,
                },
                incident,
                reflected,
                wave_speed: self.wave_speed.clone(),
            },
            (several, _) => MethodSheet::MultiPoint {
                // the coordinate grows towards the free end, which is at 0
                gauges: several
                    .iter()
                    .map(|gauge| {
                        Ok(GaugeSheet {
                            channel: gauge.channel.clone(),
                            at: coordinate(&format!("-{}", gauge.from_free_end))?,
                        })
                    })
                    .collect::<Result<_, RodlabError>>()?,
                wave_speed: self.wave_speed.clone(),
                free_end_at: Some(coordinate("0 mm")?),
            },
        };
        Ok(ModulusSheet {
            title: self.title.clone(),
            about: self.about.clone(),
            specimen: SpecimenSheet {
                length: None,
                diameter: length(&self.bar.diameter.to_string())?,
                density: self.bar.density.clone(),
                accelerometer_mass: None,
            },
            method,
            source: SourceSheet::Hits {
                tail: TailSheet::default(),
                records: self.records.clone(),
                hits: HitsSheet::default(),
                silent: Some(self.silent.clone()),
                exponential_window: None,
            },
            band: self.band.clone(),
            limits: self.limits.clone(),
            lateral_inertia: self.bar.poisson_ratio.clone().map(|poisson_ratio| {
                LateralInertiaSheet {
                    poisson_ratio,
                    theory: None,
                }
            }),
            checks: self.checks.clone(),
            causal: false,
            laws: self.laws.clone(),
            report_at: self.report_at.clone(),
            temperature: None,
            monte_carlo: None,
        })
    }
}

/// Converts the text of an exact length to a length.
fn length(text: &str) -> Result<Stated<Length>, RodlabError> {
    text.parse().in_step("the diameter of the bar")
}

/// Converts the text of a length to a coordinate.
fn coordinate(text: &str) -> Result<Stated<Coordinate>, RodlabError> {
    text.parse().in_step("the position of a gauge")
}

pub(crate) fn run(sheet: &BarSheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    sheet.check()?;
    context.progress.begins("reading", 0);
    let passages = Passages::of(sheet, context)?;
    let test = sheet.as_modulus(&passages)?;
    let mut outcome = modulus::run_with(&test, context, |outcome, found| {
        add(outcome, found, sheet, &passages)
    })?;
    outcome.job = "bar";
    outcome.settings.retain_mut(in_terms_of_a_bar);
    Ok(outcome)
}

/// Renames a setting of the job `modulus` to its name in the sheet of a bar. Returns false for a
/// setting that sheets of bars do not have.
fn in_terms_of_a_bar(setting: &mut Setting) -> bool {
    setting.name = match setting.name.as_str() {
        "specimen.accelerometer_mass" => return false,
        "method.wave_speed" => "wave_speed".to_owned(),
        "lateral_inertia" => "bar.poisson_ratio".to_owned(),
        "lateral_inertia.theory" => "theory of lateral inertia".to_owned(),
        other => other.strip_prefix("source.").unwrap_or(other).to_owned(),
    };
    true
}

/// Adds the results for the bar that the job `modulus` does not have.
fn add(
    outcome: &mut Outcome,
    found: &Found<'_>,
    sheet: &BarSheet,
    passages: &Passages,
) -> Result<(), RodlabError> {
    let lines = table::lines(found, sheet);
    outcome.tables.push(table::of(&lines)?);
    if let Some(words) = table::in_words(&lines)? {
        outcome.summary.insert(outcome.summary.len().min(1), words);
    }
    outcome.figures.push(figures::propagation(&lines)?);
    match separated::of(&lines, sheet, passages) {
        Ok(Some(waves)) => {
            outcome.figures.extend(figures::waves(&waves, passages));
            outcome.quantities.push(waves.misfit());
        }
        Ok(None) => {}
        Err(error) => outcome.warn(format!("The waves in the bar are not computed: {error}.")),
    }
    Ok(())
}
