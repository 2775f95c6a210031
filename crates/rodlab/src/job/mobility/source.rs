//! Source of a mobility.

use labio::{
    AveragedSpectra, Channel, Coherence, FrequencyResponse, MergedResponse, Quantity, Record,
    SensorError,
};
use num_complex::Complex64;
use serde::Deserialize;

use super::MobilitySheet;
use crate::bodies::face::{BodySheet, ComputedBody};
use crate::bodies::replacement::{Replacement, WithoutUncertainty};
use crate::hits::{FoundHits, expect_independent};
use crate::job::JobContext;
use crate::records::expect_different_files;
use crate::responses::{HitsSource, MergeSheet, ResponseFile, disagreements, with_silence};
use crate::sheet::{Exact, Frequency};
use crate::{InStep, Outcome, RodlabError};

/// Source of the mobility.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    clippy::large_enum_variant,
    reason = "a sheet contains only one of these"
)]
pub enum SourceSheet {
    /// Hits with a force and a motion.
    Hits(HitsSource),
    /// Tests of the same body with a heavy and a light hammer, merged line by line.
    TwoHammers {
        /// The heavy hammer, for low frequencies.
        low: HitsSource,
        /// The light hammer, for high frequencies.
        high: HitsSource,
        /// The method of merging; by default `InverseVariance`.
        #[serde(default)]
        merge: MergeSheet,
    },
    /// An averaged response.
    File(ResponseFile),
    /// A computed body.
    Computed {
        /// The body from its impact face on.
        body: BodySheet,
        /// Highest frequency, such as `"10 kHz"`.
        up_to: Exact<Frequency>,
        /// Number of lines above 0 Hz, such as 1024.
        lines: usize,
    },
}

/// Data read from the source.
pub(super) enum Read<'a> {
    Tests(Vec<Test<'a>>),
    Response(Box<FrequencyResponse>),
    Computed(ComputedBody),
}

/// Test with one hammer.
pub(super) struct Test<'a> {
    source: &'a HitsSource,
    field: &'static str,
    found: FoundHits,
}

/// A response before processing.
pub(super) struct Raw {
    pub(super) response: FrequencyResponse,
    /// Coherence of every test.
    pub(super) coherences: Vec<Coherence>,
    /// The responses of two hammers, and their agreement.
    pub(super) merged: Option<MergedResponse>,
    /// Standard uncertainty of the delay between the channels \[s\].
    pub(super) delay: f64,
    /// The body, if it was computed.
    pub(super) body: Option<ComputedBody>,
    /// Origin of the response, as the end of a sentence.
    pub(super) origin: String,
}

pub(super) fn read<'a>(
    sheet: &'a MobilitySheet,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<Read<'a>, RodlabError> {
    let mut test = |source: &'a HitsSource, field: &'static str| {
        Ok::<_, RodlabError>(Test {
            found: source.read(context, field, outcome)?,
            source,
            field,
        })
    };
    match &sheet.source {
        SourceSheet::Hits(hits) => Ok(Read::Tests(vec![test(hits, "source")?])),
        SourceSheet::TwoHammers { low, high, .. } => {
            let tests = [test(low, "source.low")?, test(high, "source.high")?];
            expect_different_files(&outcome.inputs)?;
            let [first, second] = &tests;
            check_same_channels(&tests)?;
            let found = [&first.found, &second.found];
            outcome.doubt_all(expect_independent(&found, &[&low.force, &low.response])?);
            outcome.by_default("source.merge", format!("{:?}", MergeSheet::default()));
            Ok(Read::Tests(tests.into()))
        }
        SourceSheet::File(file) => file
            .read(context.folder, "source", outcome)
            .map(|response| Read::Response(Box::new(response))),
        SourceSheet::Computed { body, .. } => {
            if sheet.head_mass.is_some() {
                return Err(RodlabError::request(
                    "head_mass",
                    "stated",
                    "no value: a computed body has no impedance head",
                ));
            }
            let mut without = WithoutUncertainty {
                why: "it is not propagated to the mobility of a computed body",
            };
            without.materials(&sheet.materials)?;
            without.body(body, "source.body")?;
            body.body(&sheet.materials, "source.body")
                .map(Read::Computed)
        }
    }
}

/// Returns the response before processing. If the hits do not allow a response, returns `None`, and
/// `outcome` states the reason.
pub(super) fn raw(
    read: &Read<'_>,
    sheet: &MobilitySheet,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<Option<Raw>, RodlabError> {
    match read {
        Read::Tests(tests) => of_tests(tests, sheet, context, outcome),
        Read::Response(response) => Ok(Some(Raw {
            response: (**response).clone(),
            coherences: Vec::new(),
            merged: None,
            delay: 0.0,
            body: None,
            origin: ", as in the file".to_owned(),
        })),
        Read::Computed(body) => computed(body, &sheet.source).map(Some),
    }
}

fn of_tests(
    tests: &[Test<'_>],
    sheet: &MobilitySheet,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<Option<Raw>, RodlabError> {
    let mut spectra: Vec<(AveragedSpectra, f64)> = Vec::new();
    let mut counts = Vec::new();
    let mut delay: f64 = 0.0;
    for test in tests {
        let accepted: Vec<&Record> = test.found.accepted();
        if accepted.len() < 2 {
            outcome.refuse(format!(
                    "{} hit{} of {} accepted in `{}`, and a mobility with errors needs at least 2: the log states what is wrong with the others",
                    accepted.len(),
                    if accepted.len() == 1 { "" } else { "s" },
                    test.found.n_found(),
                    test.field,
                ));
            outcome.say("There is no mobility: too few hits are accepted.");
            return Ok(None);
        }
        let source = test.source;
        let sensors = match accepted.first() {
            Some(first) => source.calibration(first, test.field)?,
            None => SensorError::default(),
        };
        delay = delay.max(sensors.delay);
        counts.push(test.found.in_words());
        let averaged = source.spectra(accepted.iter().copied(), context, test.field)?;
        source.judge_window(&accepted, &averaged, context, test.field, outcome)?;
        let n_silent = source.silent_samples(&test.found, test.field, outcome)?;
        let channels = [source.force.as_str(), source.response.as_str()];
        let field = format!("{}.silent", test.field);
        let averaged = with_silence(averaged, &accepted, n_silent, &channels, &field)?;
        spectra.push((averaged, sensors.gain));
    }
    let Some(((first, sensors), source)) = spectra.first().zip(tests.first().map(|t| t.source))
    else {
        return Ok(None);
    };
    let names = (source.force.as_str(), source.response.as_str());
    let estimator = source.estimator.unwrap_or_default();
    let (response, merged) = if let SourceSheet::TwoHammers { merge, .. } = &sheet.source {
        let merged = merge.merge(&spectra, estimator, names).in_step("source")?;
        outcome.doubt_all(disagreements(&merged, "the hammer `high`", names.1));
        (merged.response.clone(), Some(merged))
    } else {
        let response = first
            .response(estimator, names.0, names.1)
            .and_then(|response| response.with_common_error(*sensors))
            .in_step("source")?;
        (response, None)
    };
    let of_first = merged.as_ref().map(|merged| merged.shares.row(0).to_vec());
    let response =
        source.add_leakage(response, &spectra, of_first.as_deref(), "source", outcome)?;
    let coherences = spectra
        .iter()
        .map(|(test, _)| test.coherence(names.0, names.1))
        .collect::<Result<Vec<_>, _>>()
        .in_step("source")?;
    Ok(Some(Raw {
        response,
        coherences,
        merged,
        delay,
        body: None,
        origin: format!(": {}", counts.join("; ")),
    }))
}

fn check_same_channels(tests: &[Test<'_>]) -> Result<(), RodlabError> {
    let [low, high] = tests else { return Ok(()) };
    for (name, expected, found) in [
        ("force", &low.source.force, &high.source.force),
        ("response", &low.source.response, &high.source.response),
    ] {
        if expected != found {
            return Err(RodlabError::request(
                format!("source.high.{name}"),
                format!("`{found}`"),
                format!("`{expected}`, as in source.low"),
            ));
        }
    }
    let estimator = |source: &HitsSource| source.estimator.unwrap_or_default();
    let (expected, found) = (estimator(low.source), estimator(high.source));
    if expected != found {
        return Err(RodlabError::request(
            "source.high.estimator",
            format!("{found:?}"),
            format!("{expected:?}, as in source.low"),
        ));
    }
    Ok(())
}

fn computed(body: &ComputedBody, source: &SourceSheet) -> Result<Raw, RodlabError> {
    let SourceSheet::Computed { up_to, lines, .. } = source else {
        return Err(RodlabError::request(
            "source",
            "not computed",
            "a computed body",
        ));
    };
    if !(8..=1 << 22).contains(lines) {
        return Err(RodlabError::request(
            "source.lines",
            lines.to_string(),
            "a number from 8 to 4194304",
        ));
    }
    let spacing_hz = up_to.si() / *lines as f64;
    let mut values = Vec::with_capacity(lines + 1);
    // the value at 0 Hz is kept only if it is finite and the body is not free, as for a long rod
    values.push(match body.mobility(0.0) {
        Ok(value) if body.free_mass().is_none() && value.is_finite() => value,
        _ => Complex64::new(f64::NAN, f64::NAN),
    });
    for line in 1..=*lines {
        let value = body.mobility(line as f64 * spacing_hz);
        values.push(value.in_step("source.body")?);
    }
    let channel = |quantity: Quantity| Channel::new(quantity.name(), quantity).in_step("source");
    let response = FrequencyResponse::of_lines(
        channel(Quantity::Force)?,
        channel(Quantity::Velocity)?,
        spacing_hz,
        values,
    )
    .in_step("source")?;
    Ok(Raw {
        response,
        coherences: Vec::new(),
        merged: None,
        delay: 0.0,
        body: Some(body.clone()),
        origin: ", computed from the body of the sheet".to_owned(),
    })
}
