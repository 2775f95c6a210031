//! An outcome with everything that an outcome can contain: every kind of mark and role, both
//! scales, gaps, and texts that contain markup.

pub(crate) mod figures;

use figures::{hardly_anything, histories, moduli, nyquist, response, steps};
use rodlab::outcome::{
    Attachment, Column, InputFile, LogEntry, Outcome, Quantity, Setting, Table, Verdict,
};
use rodlab::output::SheetIdentity;

pub(crate) fn sheet() -> SheetIdentity {
    SheetIdentity {
        file: "rod.ron".to_owned(),
        sha256: "0".repeat(64),
    }
}

pub(crate) fn outcome() -> Outcome {
    let mut outcome = Outcome::of(
        "modulus",
        "Polypropylene rod, test 6 </script><script>alert(1)</script>",
    );
    outcome.verdict = Verdict::NotAllowed {
        reason: "Only two of ten hits were accepted above 4 kHz.".into(),
    };
    outcome.summary = vec![
        "The modulus at 1 kHz is 2.612 ± 0.014 GPa, the loss factor 0.0700 ± 0.0004.".into(),
        "72 of 80 lines are valid within 1 % of E' and 5 % of the loss factor.".into(),
    ];
    outcome.warnings = vec![
        "Hit 3 overloads channel 2 and was left out.".into(),
        "The mass of the accelerometer is known to 5 % only, which is half of the error above 6 kHz.".into(),
    ];
    outcome.inputs = vec![
        InputFile {
            path: "records/hits.npy".into(),
            format: "NPY".into(),
            bytes: 1_048_704,
            sha256: "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08".into(),
            pattern: Some("records/*.npy".into()),
        },
        InputFile {
            path: "records/a very long name of a file & its <folder>/hit_0002_channel_acceleration.uff".into(),
            format: "UFF 58".into(),
            bytes: 524_288,
            sha256: "60303ae22b998861bce3b28f33eec1be758a213c86c93c076dbe9f558c11c752".into(),
            pattern: None,
        },
    ];
    outcome.settings = [
        ("specimen.length", "799 mm ± 0.3 mm", false),
        (
            "processing.window",
            "exponential, time constant 40 ms",
            true,
        ),
    ]
    .map(|(name, value, by_default)| Setting {
        name: name.into(),
        value: value.into(),
        by_default,
    })
    .into();
    outcome.log = (1..=10_u32)
        .map(|hit| LogEntry {
            what: format!("hits.npy, hit {hit} at {:.3} s", 0.8 * f64::from(hit)),
            accepted: hit != 3 && hit != 7,
            reasons: match hit {
                3 => vec!["overload of channel 2, 14 samples at 4.998 V".into()],
                7 => vec![
                    "double hit after 3.2 ms".into(),
                    "signal 14 dB above noise, 20 dB are needed".into(),
                ],
                _ => vec![],
            },
        })
        .collect();
    let unknown = "not identifiable: no line below its relaxation frequency of 3 Hz";
    let (modulus, viscosity) = (Some([2.61234, 0.01412]), Some([2.3e7, 4.1e8]));
    outcome.quantities = [
        ("storage modulus at 1 kHz", "GPa", modulus, "valid"),
        ("viscosity of the third branch", "Pa s", viscosity, unknown),
        ("creep recovery time", "s", None, "no load was removed"),
    ]
    .map(|(name, unit, found, verdict)| Quantity {
        name: name.into(),
        unit: unit.into(),
        value: found.map(|[value, _]| value),
        standard_error: found.map(|[_, error]| error),
        valid: verdict == "valid",
        verdict: verdict.into(),
    })
    .into();
    let frequency = steps(80, 250.0, 10_000.0);
    outcome.tables = vec![Table {
        name: "modulus".into(),
        title: "Modulus by frequency".into(),
        columns: vec![
            Column::numbers(
                "storage modulus",
                "GPa",
                frequency.iter().map(|f| 2.0 + 0.1 * f.ln()).collect(),
            ),
            Column::numbers(
                "loss factor",
                "",
                frequency
                    .iter()
                    .map(|f| if *f > 9500.0 { f64::NAN } else { 0.07 })
                    .collect(),
            ),
            Column::words(
                "verdict",
                frequency
                    .iter()
                    .map(|f| {
                        if *f > 9500.0 {
                            "wavelength below five diameters".into()
                        } else {
                            "valid".into()
                        }
                    })
                    .collect(),
            ),
            Column::numbers("frequency", "Hz", frequency),
        ],
    }];
    outcome.figures = vec![
        histories(),
        response(),
        moduli(),
        nyquist(),
        hardly_anything(),
    ];
    outcome.attachments = vec![Attachment {
        name: "response.uff".into(),
        bytes: b"    -1\n".to_vec(),
    }];
    outcome
}
