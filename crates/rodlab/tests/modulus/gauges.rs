//! Modulus from strain gauges along a rod.

use super::*;
use crate::runs::{Folder, Words, answered, refusal};
use crate::virtual_rod::{FAST_RATE_HZ, LongRod};

/// A sheet for gauges on a rod that is free at both ends, with each hit in its own file.
fn gauge_sheet(method: &str, positions: &[(usize, &str)], rest: &str) -> String {
    let channels: Vec<String> = positions
        .iter()
        .map(|(from, _)| format!("(name: \"gauge {from}\", from: {from}, unit: \"µε\")"))
        .collect();
    let gauges: Vec<String> = positions
        .iter()
        .map(|(from, at)| format!("(channel: \"gauge {from}\", at: \"{at}\")"))
        .collect();
    format!(
        r#"Modulus(title: "Gauges", specimen: (diameter: "15.8 mm", density: "912 kg/m3"),
    method: {method}(gauges: [{}]{rest}),
    source: Hits(
        records: (files: ["gauges_*.npy"], sampling_rate: "{RATE_HZ} Hz", channels: [{}]),
        hits: (criteria: (peak_over_noise: 5.0)),
        silent: "1.5 ms",
    ),
    band: (from: "200 Hz", to: "12 kHz"),
    lateral_inertia: (poisson_ratio: "0"),
    causal: true,
)"#,
        gauges.join(", "),
        channels.join(", ")
    )
}

#[test]
fn gauges_along_a_rod_give_its_modulus_and_see_its_free_end() {
    let folder = Folder::new();
    let rod = virtual_rod::polypropylene();
    virtual_rod::write_gauges(folder.path(), &[0.25, 0.29, 0.40, 0.48, 0.55], 5, 11);
    let five = [
        (1, "250 mm"),
        (2, "290 mm"),
        (3, "400 mm"),
        (4, "480 mm"),
        (5, "550 mm"),
    ];
    let text = gauge_sheet("MultiPoint", &five, ", free_end_at: \"800 mm\"");
    let outcome = answered(folder.run(&text));
    let (count, mean_square) = check_lines(&outcome, &rod);
    assert!(count > 400, "{count} {:?}", outcome.summary);
    // tolerance: the errors are due to noise alone, which is measured before the hits and known to
    // 10 %; over so many lines the mean square is 1 within a few per cent
    assert!((mean_square - 1.0).abs() < 0.35, "{mean_square}");
    let (count, z, _) = check_causal(&outcome, &rod);
    assert!(count > 400 && z < 1.8, "{count} {z}");
    let null = quantity(&outcome, "check: free-end null, p-value");
    assert!(null.valid, "{null:?}");

    // a gauge 8 mm from its stated position
    let moved = gauge_sheet(
        "MultiPoint",
        &[five[0], five[1], (3, "408 mm"), five[3], five[4]],
        ", free_end_at: \"800 mm\"",
    );
    refusal(&folder.run(&moved).unwrap()).must_say("two waves do not explain the gauges");

    let three = gauge_sheet("ThreePoint", &[five[0], five[2], five[4]], "");
    let outcome = answered(folder.run(&three));
    assert!(check_lines(&outcome, &rod).0 > 200);
}

#[test]
fn pulses_in_a_long_rod_give_the_modulus_by_two_sections_and_by_one() {
    let folder = Folder::new();
    let rod = LongRod {
        length: 3.0,
        stiffness: 2.6e9,
        viscosity: 2500.0,
        density: 912.0,
    };
    rod.write_pulses(folder.path(), [1.0, 2.0], 8, 3);
    let exact = |f: f64| Complex64::new(rod.stiffness, TAU * f * rod.viscosity);
    let sheet = |method: &str| {
        format!(
            r#"Modulus(title: "Pulses", specimen: (diameter: "10 mm", density: "912 kg/m3 ± 0.1 %"), method: {method},
    source: Hits(
        records: (
            files: ["pulses_*.npy"], sampling_rate: "{FAST_RATE_HZ} Hz",
            channels: [(name: "first", from: 1, unit: "µε"), (name: "second", from: 2, unit: "µε")],
        ),
        // the records end while the pulses still run to and fro
        hits: (criteria: (remainder: None, level_shift: None)),
    ),
    band: (from: "500 Hz", to: "8 kHz"), limits: (loss_factor: "20 %"),
)"#
        )
    };
    // the wave passes the sections 0.59 ms and 1.18 ms after the hit, and returns to the second
    // section at 2.37 ms
    let two = r#"SeparatePulses(first: (channel: "first", from: "1.4 ms", to: "2.3 ms"), second: (channel: "second", from: "2.0 ms", to: "3.0 ms"), distance: "1000 mm ± 0.5 mm")"#;
    let one = r#"OneGauge(section: (channel: "second", from_free_end: "1000 mm"), incident: ("2.0 ms", "3.0 ms"), reflected: ("3.2 ms", "4.3 ms"))"#;
    for (method, fewest) in [(two, 10), (one, 10)] {
        let outcome = answered(folder.run(&sheet(method)));
        let frequency = numbers(&outcome, "modulus", "frequency");
        let storage = numbers(&outcome, "modulus", "E'");
        let loss = numbers(&outcome, "modulus", "loss factor");
        let mut count = 0;
        for (line, _) in is_valid(&outcome).iter().enumerate().filter(|(_, v)| **v) {
            let truth = exact(frequency[line]);
            // tolerance: the limits of a valid line, and the error of the discrete rod
            assert!(
                (1e9 * storage[line] / truth.re - 1.0).abs() < 0.011,
                "{} Hz",
                frequency[line]
            );
            let eta = truth.im / truth.re;
            assert!(
                (loss[line] / eta - 1.0).abs() < 0.21,
                "{} Hz",
                frequency[line]
            );
            count += 1;
        }
        assert!(count >= fewest, "{count}");
    }
    // the window contains the reflected pulse at the second section instead of the incident one
    let later = two.replace(
        r#"from: "2.0 ms", to: "3.0 ms""#,
        r#"from: "3.0 ms", to: "4.2 ms""#,
    );
    let said = json(&folder.run(&sheet(&later)).unwrap());
    said.must_say("the windows `first` and `second` lies another pulse");
}
