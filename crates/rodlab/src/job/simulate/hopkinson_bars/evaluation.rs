//! Sheet that evaluates the shot.

use super::super::blows::Recorded;
use super::super::instrument::InstrumentSheet;
use super::super::{Evaluation, Request};
use super::{Bar, HopkinsonBarsSheet, channels};

pub(super) fn sheet(
    sheet: &HopkinsonBarsSheet,
    bars: &[Bar<'_>; 2],
    request: &Request<'_>,
    recorded: &Recorded,
    instrument: &InstrumentSheet,
) -> Evaluation {
    let sides = ["incident", "transmitted"];
    let mut materials = String::new();
    for (side, bar) in sides.iter().zip(bars) {
        let branches: String = bar
            .law
            .branches()
            .iter()
            .map(|branch| {
                format!(
                    "\n            (modulus: \"{} Pa\", relaxation_time: \"{} s\"),",
                    branch.modulus, branch.relaxation_time
                )
            })
            .collect();
        let (density, spring) = (bar.density, bar.law.equilibrium_modulus());
        let law = if branches.is_empty() {
            format!("Elastic(modulus: \"{spring} Pa\")")
        } else if spring > 0.0 {
            format!("Prony(equilibrium: \"{spring} Pa\", branches: [{branches}\n        ])")
        } else {
            format!("Prony(branches: [{branches}\n        ])")
        };
        materials.push_str(&format!(
            "\n        \"{side}\": (density: \"{density} kg/m3\", law: {law}),"
        ));
    }
    let mut described = String::new();
    for (side, bar) in sides.iter().zip(bars) {
        let gauges: String = channels(side, bar.sheet)
            .iter()
            .zip(&bar.sheet.gauges)
            .map(|(channel, at)| format!("(channel: {channel:?}, at: \"{at}\"), "))
            .collect();
        described.push_str(&format!(
            "\n        {side}: (waves: Material(\"{side}\"), diameter: \"{}\", length: \"{}\", gauges: [{gauges}]),",
            bar.sheet.diameter, bar.sheet.length
        ));
    }
    let text = format!(
        r#"Shpb(
    title: {title:?},
    loading: Compression,
    materials: {{{materials}
    }},
    bars: ({described}
    ),
    specimen: (length: "{length}", diameter: "{diameter}"),
    records: [{records}],
    // the filter reaches ahead of the pulse
    silent: "{silent:.4} ms",
)
"#,
        title = request.title,
        length = sheet.specimen.length,
        diameter = sheet.specimen.diameter,
        records = request
            .records_of_sheet(recorded, "    ")
            .trim_start_matches("records: "),
        silent = 1e3 * request.silent(instrument),
    );
    Evaluation::new("shpb", "shpb.ron", text, &recorded.generator)
}
