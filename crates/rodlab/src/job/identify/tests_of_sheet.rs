//! Tests of a sheet: each has two histories, converted to velocities with their noise.

use labio::{Quantity, Record, SensorError};
use maxwellid::recorder::LONGEST_RECORD;
use maxwellid::{
    CommonError, Differentiator, DisplacementTransducers, ErrorOf, Provenance, RodTest, RodTestData,
};
use rayon::prelude::*;
use serde::Deserialize;

use super::{IdentifySheet, SpecimenSheet};
use crate::digits::significant;
use crate::job::JobContext;
use crate::job::simulate::AntiAliasSheet;
use crate::outcome::Setting;
use crate::records::{Records, clipped, expect_different_files, expect_quantity};
use crate::sheet::{
    Exact, Frequency, Length, NotFollowed, Temperature, Time, ValueWithUncertainty, Velocity,
};
use crate::{InStep, Outcome, RodlabError};

/// One test.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestSheet {
    /// Name of the test.
    pub name: String,
    /// The rod of this test, if the tests are made on several rods. Tests that state the same rod
    /// share the error of its length.
    pub specimen: Option<SpecimenSheet>,
    /// Record of the test, one file with both histories.
    pub records: Records,
    /// Channel of the section of excitation: a velocity or a displacement, positive away from the
    /// striker.
    pub excitation: String,
    /// Channel of the free end, of the same quantity.
    pub response: String,
    /// Impact velocity; errors are stated relative to it.
    pub impact_velocity: Exact<Velocity>,
    /// Beginning of the time span used; the rod must be at rest at this time.
    pub from: Option<Exact<Time>>,
    /// End of the time span that is compared.
    pub to: Option<Exact<Time>>,
    /// Noise of the histories; by default measured before the arrival of the wave.
    #[serde(default)]
    pub noise: NoiseSheet,
    /// Range of the displacement transducers; larger displacements are not recorded.
    pub range: Option<Exact<Length>>,
    /// Cut-off frequency of the recorder's low-pass filter; by default assumed from the sampling
    /// rate.
    pub cutoff: Option<Exact<Frequency>>,
    /// Temperature of the rod, such as `"40 degC"`; needed in every test if `arrhenius` is stated.
    pub temperature: Option<NotFollowed<Temperature>>,
    /// Name of the solver that made a virtual test.
    pub generator: Option<String>,
}

/// Noise of the two histories, as standard deviations of a sample.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum NoiseSheet {
    /// Noise measured before the arrival of the wave.
    #[default]
    BeforeArrival,
    /// Noise of velocities.
    Velocities {
        /// Noise of the excitation.
        excitation: Exact<Velocity>,
        /// Noise of the response.
        response: Exact<Velocity>,
    },
    /// Noise of displacements.
    Displacements {
        /// Noise of the excitation.
        excitation: Exact<Length>,
        /// Noise of the response.
        response: Exact<Length>,
    },
}

/// Savitzky-Golay differentiator for displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DifferentiatorSheet {
    /// Samples on either side.
    pub half_width: usize,
    /// Degree of the polynomial.
    pub degree: usize,
}

impl Default for DifferentiatorSheet {
    /// Nine points and degree 4, with which a slope is 1 % too small at a tenth of the sampling
    /// rate.
    fn default() -> Self {
        Self {
            half_width: 4,
            degree: 4,
        }
    }
}

/// Reads all tests of `sheet`, and enters files, settings and flags in `outcome`.
pub(super) fn read(
    sheet: &IdentifySheet,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<Vec<RodTest>, RodlabError> {
    RodlabError::refuse_empty(&sheet.tests, "tests", "at least one test")?;
    context.progress.begins("reading", sheet.tests.len());
    let mut tests = Vec::with_capacity(sheet.tests.len());
    for (number, of_sheet) in sheet.tests.iter().enumerate() {
        let field = format!("tests[{number}]");
        let test = one(of_sheet, sheet, &field, context, outcome)?;
        outcome.accept(format!("test `{}`", of_sheet.name), test.flags());
        tests.push(test);
        context.progress.one_more();
        context.check_cancelled()?;
    }
    expect_different_files(&outcome.inputs)?;
    check_temperatures(sheet, outcome)?;
    match &sheet.recorder {
        Some(recorder) => tests
            .into_par_iter()
            .map(|test| seen_through(recorder, test))
            .collect(),
        None => Ok(tests),
    }
}

/// Adds the filter of the recorder to the model of `test`.
fn seen_through(recorder: &AntiAliasSheet, test: RodTest) -> Result<RodTest, RodlabError> {
    let filter = super::recorder::filter(recorder, test.sampling_rate_hz())?;
    test.with_recorder(&filter).in_step("recorder")
}

/// Number of pairs of successive samples at the beginning of a history. If the samples of every
/// pair are equal, the noise is below the step of the converter.
const STILL: usize = 16;

/// Temperature difference \[K\] up to which a law without activation gives no warning.
const SAME_TEMPERATURE: f64 = 2.0;

/// Largest accepted velocity of a record, relative to the impact velocity. A free end reaches 2;
/// the remainder is a margin for noise.
const LARGEST_VELOCITY: f64 = 3.0;

/// Refuses activated laws without several temperatures, and warns of several temperatures without
/// activated laws.
fn check_temperatures(sheet: &IdentifySheet, outcome: &mut Outcome) -> Result<(), RodlabError> {
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    for (number, test) in sheet.tests.iter().enumerate() {
        match &test.temperature {
            Some(temperature) => {
                let kelvin = temperature.si();
                range = (range.0.min(kelvin), range.1.max(kelvin));
            }
            None if sheet.arrhenius.is_some() => {
                return Err(RodlabError::request(
                    format!("tests[{number}].temperature"),
                    "absent",
                    "the temperature of the rod: with `arrhenius`, the rates depend on it",
                ));
            }
            None => {}
        }
    }
    let span = range.1 - range.0;
    if sheet.arrhenius.is_some() && span < SAME_TEMPERATURE {
        return Err(RodlabError::request(
            "arrhenius",
            format!("stated, with temperatures within {span:.1} K"),
            "tests at several temperatures, from which an activation energy can be determined",
        ));
    }
    if let Some(arrhenius) = &sheet.arrhenius
        && !(range.0 - span..=range.1 + span).contains(&arrhenius.reference.si())
    {
        outcome.warn(format!(
            "the reference temperature, {}, is further from the temperatures of the tests than these from each other: the parameters there are extrapolated",
            arrhenius.reference
        ));
    }
    if sheet.arrhenius.is_none() && span > SAME_TEMPERATURE {
        outcome.warn(format!(
            "the temperatures of the tests differ by {span:.0} K, and one set of parameters is fitted to all: state `arrhenius` where the rates depend on the temperature"
        ));
    }
    Ok(())
}

fn one(
    test: &TestSheet,
    sheet: &IdentifySheet,
    field: &str,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<RodTest, RodlabError> {
    let records_field = format!("{field}.records");
    let loaded = test.records.load(context.folder, &records_field)?;
    let mut records = loaded.entered_in(outcome);
    let found = records.len();
    let Some(record) = records.pop().filter(|_| found == 1) else {
        return Err(RodlabError::request(
            records_field,
            format!("{found} records"),
            "one: each test has its own entry in `tests`",
        ));
    };
    let with_recorder = sheet.recorder.is_some();
    let record = part(record.record, test, with_recorder, field, outcome)?;
    let quantity = quantity_of(&record, test, field)?;
    let channels = [test.excitation.as_str(), test.response.as_str()];
    outcome.doubt_all(clipped(&record, &channels, field)?);
    let samples = |channel: &str| -> Result<Vec<f64>, RodlabError> {
        let samples = record.channel(channel);
        Ok(samples.in_step(field)?.to_vec())
    };
    let specimen = sheet.specimen_of(test, field)?;
    let histories = [samples(&test.excitation)?, samples(&test.response)?];
    expect_one_direction(&histories, test, field)?;
    let [excitation, response] = histories;
    let data = RodTestData {
        name: test.name.clone(),
        length: specimen.length.with_uncertainty().value,
        density: specimen.density.with_uncertainty().value,
        impact_velocity: test.impact_velocity.si(),
        sampling_rate_hz: record.sampling_rate_hz(),
        excitation,
        response,
        provenance: match &test.generator {
            Some(generator) => Provenance::Virtual {
                generator: generator.clone(),
            },
            None => Provenance::Measured,
        },
    };
    if sheet.monte_carlo.is_some() && quantity == Quantity::Displacement {
        return Err(RodlabError::request(
            "monte_carlo",
            "requested, with displacements",
            "velocities: the noise of differentiated displacements is not drawn",
        ));
    }
    let rod_test = match (quantity, &context.draw) {
        (Quantity::Displacement, _) => of_displacements(data, test, sheet, field)?,
        (_, None) => of_velocities(data, test, field)?,
        (_, Some(draw)) => {
            let as_measured = of_velocities(data.clone(), test, field)?;
            let mut drawn = data;
            if let Some([excitation, response]) = as_measured.noise_deviations() {
                let add = |samples: &mut [f64], deviation: f64| {
                    for sample in samples {
                        *sample += deviation * draw.standard();
                    }
                };
                add(&mut drawn.excitation, excitation);
                add(&mut drawn.response, response);
            }
            of_velocities(drawn, test, field)?
        }
    };
    if sheet.recorder.is_some() && test.cutoff.is_some() {
        return Err(RodlabError::request(
            format!("{field}.cutoff"),
            "stated together with `recorder`",
            "only one of the two: `recorder` states the cut-off of its filter",
        ));
    }
    let rod_test = rod_test
        .with_common_errors(common_errors(&record, test, sheet, field)?)
        .in_step(field)?;
    let rod_test = match (&specimen.diameter, &specimen.poisson_ratio) {
        (Some(diameter), Some(ratio)) => {
            let of_rod = diameter.with_uncertainty().value * ratio.with_uncertainty().value;
            rod_test
                .with_lateral_inertia(of_rod * of_rod / 8.0)
                .in_step(field)?
        }
        _ => rod_test,
    };
    let rod_test = match &test.temperature {
        Some(temperature) => rod_test.at_temperature(temperature.si()).in_step(field)?,
        None => rod_test,
    };
    match &test.to {
        Some(to) => rod_test
            .with_window(to.si() - record.start_time())
            .in_step(format!("{field}.to")),
        None => Ok(rod_test),
    }
}

/// Refuses histories that begin in opposite directions: a free end moves in the direction of the
/// wave that reaches it.
fn expect_one_direction(
    histories: &[Vec<f64>; 2],
    test: &TestSheet,
    field: &str,
) -> Result<(), RodlabError> {
    let directions = histories.each_ref().map(|history| {
        let largest = history.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let first = history.iter().find(|x| x.abs() > 0.5 * largest);
        first.map(|x| x.is_sign_positive())
    });
    match directions {
        [Some(excitation), Some(response)] if excitation != response => Err(RodlabError::request(
            format!("{field}.response"),
            format!(
                "`{}`, which begins in the direction opposite to `{}`",
                test.response, test.excitation
            ),
            "histories in one direction, as a free end moves with the wave that reaches it: state `inverted` of the reversed channel as true",
        )),
        _ => Ok(()),
    }
}

/// Refuses velocities that an impact at the stated velocity cannot cause: the struck face is at
/// most as fast as the striker, and a free end moves twice as fast as the wave that reaches it.
fn expect_possible(data: &RodTestData, test: &TestSheet, field: &str) -> Result<(), RodlabError> {
    let stated = data.impact_velocity;
    let histories = [
        (&test.excitation, &data.excitation),
        (&test.response, &data.response),
    ];
    for (name, history) in histories {
        let fastest = history.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        if fastest.is_finite() && fastest > LARGEST_VELOCITY * stated {
            return Err(RodlabError::request(
                format!("{field}.impact_velocity"),
                format!("`{}`", test.impact_velocity),
                format!(
                    "at least half of the largest velocity of the records: `{name}` reaches {} m/s",
                    significant(fastest, 3)
                ),
            ));
        }
    }
    Ok(())
}

fn of_velocities(data: RodTestData, test: &TestSheet, field: &str) -> Result<RodTest, RodlabError> {
    expect_possible(&data, test, field)?;
    let is_still = |history: &[f64]| {
        let mut pairs = history.iter().zip(history.iter().skip(1)).take(STILL);
        pairs.all(|(a, b)| (a - b).abs() <= 0.0)
    };
    let still = if is_still(&data.excitation) {
        Some(&test.excitation)
    } else {
        is_still(&data.response).then_some(&test.response)
    };
    let rod_test = RodTest::new(data).in_step(field)?;
    match &test.noise {
        NoiseSheet::BeforeArrival => {
            if let Some(name) = still {
                return Err(RodlabError::request(
                    format!("{field}.noise"),
                    format!("absent, and `{name}` has one value before the wave arrives"),
                    "`Velocities` with the noise of both histories: it is smaller than the step of the converter, and the error of rounding is 0.29 steps",
                ));
            }
            rod_test.with_noise_of_quiet_part()
        }
        NoiseSheet::Velocities {
            excitation,
            response,
        } => rod_test.with_noise(excitation.si(), response.si()),
        NoiseSheet::Displacements { .. } => {
            return Err(RodlabError::request(
                format!("{field}.noise"),
                "noise of displacements",
                "Velocities(..): the histories are velocities",
            ));
        }
    }
    .in_step(field)
}

/// Returns the common errors of a test: those of its transducers, those of lateral inertia and, if
/// the tests are made on several rods, that of the length of its rod.
fn common_errors(
    record: &Record,
    test: &TestSheet,
    sheet: &IdentifySheet,
    field: &str,
) -> Result<Vec<CommonError>, RodlabError> {
    let mut both = SensorError::default();
    let mut errors = Vec::new();
    for (of, name) in [
        (ErrorOf::ExcitationGain, &test.excitation),
        (ErrorOf::ResponseGain, &test.response),
    ] {
        let sensor = record.sensor_error(name).in_step(field)?;
        both = both.combined(sensor);
        errors.push(CommonError {
            of,
            shared_by: format!("`{name}`"),
            standard_uncertainty: sensor.gain,
        });
    }
    errors.push(CommonError {
        of: ErrorOf::Delay,
        shared_by: format!("`{}` after `{}`", test.response, test.excitation),
        standard_uncertainty: both.delay,
    });
    let specimen = sheet.specimen_of(test, field)?;
    if let (Some(diameter), Some(ratio)) = (&specimen.diameter, &specimen.poisson_ratio) {
        let mut inertia = |shared_by: String, of: ValueWithUncertainty| {
            // without lateral contraction there is no lateral inertia
            let relative = if of.value == 0.0 { 0.0 } else { of.relative() };
            errors.push(CommonError {
                of: ErrorOf::LateralInertia,
                shared_by,
                standard_uncertainty: 2.0 * relative,
            });
        };
        inertia(
            format!("rods of diameter {diameter}"),
            diameter.with_uncertainty(),
        );
        inertia(
            format!("rods with Poisson's ratio {ratio}"),
            ratio.with_uncertainty(),
        );
    }
    if sheet.single_specimen().is_none() {
        errors.push(CommonError {
            of: ErrorOf::Length,
            shared_by: format!("the rod of {}, {}", specimen.length, specimen.density),
            standard_uncertainty: specimen.length.with_uncertainty().relative(),
        });
    }
    Ok(errors)
}

fn of_displacements(
    data: RodTestData,
    test: &TestSheet,
    sheet: &IdentifySheet,
    field: &str,
) -> Result<RodTest, RodlabError> {
    let DifferentiatorSheet { half_width, degree } = sheet.differentiator;
    let differentiator = Differentiator::new(half_width, degree).in_step("differentiator")?;
    let noise = match &test.noise {
        NoiseSheet::BeforeArrival => None,
        NoiseSheet::Displacements {
            excitation,
            response,
        } => Some((excitation.si(), response.si())),
        NoiseSheet::Velocities { .. } => {
            return Err(RodlabError::request(
                format!("{field}.noise"),
                "that of velocities",
                "Displacements(..): the histories are displacements",
            ));
        }
    };
    let transducers = DisplacementTransducers {
        range: test.range.as_ref().map_or(f64::INFINITY, Exact::si),
        noise,
        differentiator,
    };
    RodTest::from_displacements(data, &transducers).in_step(field)
}

/// Returns the quantity of both histories.
fn quantity_of(record: &Record, test: &TestSheet, field: &str) -> Result<Quantity, RodlabError> {
    let of = |name: &str| {
        let mut channels = record.channels().iter();
        channels
            .find(|channel| channel.name() == name)
            .map(labio::Channel::quantity)
    };
    let wanted = match of(&test.excitation) {
        Some(Quantity::Displacement) => Quantity::Displacement,
        _ => Quantity::Velocity,
    };
    for (name, role) in [
        (&test.excitation, "excitation"),
        (&test.response, "response"),
    ] {
        expect_quantity(record, name, wanted, &format!("{field}.{role}"))?;
    }
    Ok(wanted)
}

/// Number of samples that are kept after the end of the comparison if the recorder is part of the
/// model. They are needed for interpolation, for the derivative of displacements and for the
/// ringing of the filter.
const KEPT_AFTER_END: usize = 64;

/// Number of samples that are kept before the arrival of the wave, for the noise, if a record is
/// cut by default.
const KEPT_BEFORE_ARRIVAL: usize = 200;

/// Number of travel times between the two sections that are kept after the arrival at the free end,
/// if a record is cut by default and [`LONGEST_RECORD`] allows it.
const KEPT_PASSAGES: usize = 10;

/// Returns the first sample and the end of the part that is used of a long record if its recorder
/// is part of the model and neither `from` nor `to` is stated: a quiet part before the arrival of
/// the wave, and several passages after it.
fn about_arrival(
    record: &Record,
    test: &TestSheet,
    field: &str,
) -> Result<(usize, usize), RodlabError> {
    // a displacement continues to grow after the front, so its level is lower
    let is_displacement = quantity_of(record, test, field)? == Quantity::Displacement;
    let level = if is_displacement { 0.02 } else { 0.25 };
    let arrival = |channel: &str| -> Result<usize, RodlabError> {
        let samples = record.channel(channel);
        let samples = samples.in_step(field)?;
        let largest = samples.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let first = samples.iter().position(|x| x.abs() >= level * largest);
        Ok(first.unwrap_or(0))
    };
    let (excited, answered) = (arrival(&test.excitation)?, arrival(&test.response)?);
    let begin = excited.saturating_sub(KEPT_BEFORE_ARRIVAL);
    let passages = KEPT_PASSAGES * answered.saturating_sub(excited) + KEPT_AFTER_END;
    Ok((begin, (begin + LONGEST_RECORD).min(answered + passages)))
}

/// Returns the part of the record from `from` on. If the recorder is part of the model, the
/// excitation is estimated on a fine grid over the whole part. The part then ends a short time
/// after `to`; if the sheet states neither `from` nor `to` and the record is too long, a part about
/// the arrival of the wave is chosen.
fn part(
    record: Record,
    test: &TestSheet,
    with_recorder: bool,
    field: &str,
    outcome: &mut Outcome,
) -> Result<Record, RodlabError> {
    let last = record.n_samples();
    let mut end = last;
    if let (true, Some(to)) = (with_recorder, &test.to) {
        let after = (0..last).find(|sample| record.time_at(*sample) > to.si());
        end = after.map_or(last, |after| last.min(after + KEPT_AFTER_END));
    }
    let mut begin = 0;
    if let Some(from) = &test.from {
        let first = (0..last).find(|sample| record.time_at(*sample) >= from.si());
        begin = first.ok_or_else(|| {
            RodlabError::request(
                format!("{field}.from"),
                from.to_string(),
                format!(
                    "a time before the end of the record, {} s",
                    record.time_at(last - 1)
                ),
            )
        })?;
    }
    let is_chosen = test.from.is_some() || test.to.is_some();
    if with_recorder && !is_chosen && last > LONGEST_RECORD {
        (begin, end) = about_arrival(&record, test, field)?;
        end = end.min(last);
        for (name, sample) in [("from", begin), ("to", end - 1)] {
            let time = significant(1e3 * record.time_at(sample), 4);
            let value = format!("{time} ms, about the arrival of the wave");
            outcome
                .settings
                .push(Setting::by_default(format!("{field}.{name}"), value));
        }
    }
    if begin == 0 && end == last {
        return Ok(record);
    }
    record
        .part(begin..end.max(begin))
        .in_step(format!("{field}.from"))
}
