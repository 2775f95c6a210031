//! Sheet that evaluates a virtual impact.

use labio::Record;

use super::{FREE, ImpactedRodSheet, NEAR, SensorsSheet};
use crate::RodlabError;
use crate::job::simulate::blows::Recorded;
use crate::job::simulate::instrument::InstrumentSheet;
use crate::job::simulate::{Evaluation, Request};

/// Returns the sheet for `rodlab identify`; `levels` are the standard deviations of the noise of
/// each test, if there is noise.
pub(super) fn sheet(
    sheet: &ImpactedRodSheet,
    request: &Request<'_>,
    recorded: &Recorded,
    levels: &[Vec<Option<f64>>],
    instrument: &InstrumentSheet,
) -> Result<Evaluation, RodlabError> {
    let mut tests = String::new();
    for (number, ((velocity, record), levels)) in sheet
        .velocities
        .iter()
        .zip(&recorded.records)
        .zip(levels)
        .enumerate()
    {
        let file = request.naming.file(number + 1, sheet.velocities.len());
        tests.push_str(&one(
            sheet,
            request,
            &file,
            &velocity.to_string(),
            record,
            levels,
            &recorded.generator,
        ));
    }
    let text = format!(
        r#"Identify(
    title: {title:?},
    specimen: (
        // from the section near the struck end to the free end
        length: "{length}",
        density: "{density}",
    ),
    // the filter before sampling, which is part of the experiment
    recorder: {recorder},
    tests: [{tests}
    ],
)
"#,
        recorder = instrument.filter_in_ron(),
        title = request.title,
        length = sheet.section_distance,
        density = sheet.density,
    );
    Ok(Evaluation::new(
        "identify",
        "identify.ron",
        text,
        &recorded.generator,
    ))
}

fn one(
    sheet: &ImpactedRodSheet,
    request: &Request<'_>,
    file: &str,
    velocity: &str,
    record: &Record,
    levels: &[Option<f64>],
    generator: &str,
) -> String {
    let records = request
        .naming
        .records_of_sheet((file, record), "", "            ");
    let (kind, unit, range) = match &sheet.sensors {
        SensorsSheet::Velocity => ("Velocities", "m/s", String::new()),
        SensorsSheet::Displacement { range } => (
            "Displacements",
            "m",
            format!("\n            range: \"{range}\","),
        ),
    };
    let noise = match levels {
        [Some(near), Some(free)] => format!(
            "\n            noise: {kind}(excitation: \"{near:e} {unit}\", response: \"{free:e} {unit}\"),"
        ),
        _ => String::new(),
    };
    format!(
        r#"
        (
            name: "{velocity}",
            {records},
            excitation: "{NEAR}",
            response: "{FREE}",
            impact_velocity: "{velocity}",{noise}{range}
            // data are never inverted with the solver that generated them
            generator: "{generator}",
        ),"#
    )
}
