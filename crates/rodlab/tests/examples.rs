//! The examples, run by the commands of their README and compared with the true values of their
//! records.

use std::path::Path;

use serde_json::Value;

use crate::runs::{Folder, Words};

/// The result of a sheet of the examples.
fn result_of(example: &str, job: &str) -> Value {
    result_in(&Folder::of_example(example), job)
}

fn result_in(folder: &Folder, job: &str) -> Value {
    let printed = folder.done(&format!("{job} {job}.ron --json --out result"));
    assert!(folder.has("result/report.html"));
    let result = serde_json::from_str(&printed).unwrap();
    names_are_plain(&result, &folder.file("result"));
    result
}

/// Checks that names of columns are plain identifiers, unique in their table, and equal in JSON and
/// CSV.
fn names_are_plain(result: &Value, folder: &Path) {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    for table in result["tables"].as_array().unwrap() {
        let columns = table["columns"].as_array().unwrap();
        let names: Vec<String> = columns.iter().map(|column| text(&column["name"])).collect();
        for name in &names {
            let is_lowercase = |c: char| c.is_ascii_lowercase();
            let is_plain = |c: char| is_lowercase(c) || c.is_ascii_digit() || c == '_';
            assert!(
                name.starts_with(is_lowercase) && name.chars().all(is_plain),
                "{name}"
            );
            assert!(!name.contains("__"), "{name}");
        }
        let distinct: std::collections::BTreeSet<&String> = names.iter().collect();
        assert_eq!(distinct.len(), names.len(), "{names:?}");
        let file = folder.join(format!("{}.csv", text(&table["name"])));
        let csv = std::fs::read_to_string(file).unwrap();
        assert_eq!(csv.lines().next().unwrap(), names.join(","));
    }
}

/// Value and standard error of a quantity that the result marks as valid.
fn quantity(result: &Value, name: &str) -> (f64, f64) {
    let all = result["quantities"].as_array().unwrap();
    let found = all.iter().find(|q| q["name"] == name);
    let found = found.unwrap_or_else(|| {
        let names: Vec<&Value> = all.iter().map(|q| &q["name"]).collect();
        unreachable!("no quantity {name} in {names:?}")
    });
    assert_eq!(found["valid"], true, "{found}");
    (
        found["value"].as_f64().unwrap(),
        found["standard_error"].as_f64().unwrap(),
    )
}

/// Fails unless a quantity is `truth` within `errors` standard errors, and its standard error is
/// below `share` of `truth`.
fn is_found(result: &Value, name: &str, truth: f64, [errors, share]: [f64; 2]) {
    let (value, error) = quantity(result, name);
    assert!(
        (value - truth).abs() < errors * error && error < share * truth,
        "{name}: {value} ± {error}"
    );
}

fn column(result: &Value, table: &str, name: &str) -> Vec<f64> {
    let tables = result["tables"].as_array().unwrap();
    let table = tables.iter().find(|t| t["name"] == table).unwrap();
    let columns = table["columns"].as_array().unwrap();
    let column = columns.iter().find(|c| c["name"] == name).unwrap();
    let cells = column["cells"].as_array().unwrap().iter();
    let numbers = cells.map(|cell| cell.as_f64().unwrap_or(f64::NAN));
    numbers.collect()
}

/// The material of a plan: |E| [GPa] at a frequency [Hz], and a loss factor that does not depend on
/// the frequency.
struct Material {
    modulus: f64,
    at: f64,
    loss_factor: f64,
}

const POLYPROPYLENE: Material = Material {
    modulus: 2.6,
    at: 1600.0,
    loss_factor: 0.07,
};

impl Material {
    fn storage_modulus(&self, frequency_hz: f64) -> f64 {
        let angle = self.loss_factor.atan();
        let exponent = 2.0 * angle / std::f64::consts::PI;
        self.modulus * (frequency_hz / self.at).powf(exponent) * angle.cos()
    }
}

/// The frequency in the name of a quantity, as in `storage modulus at 4.992 kHz`.
fn frequency_of(name: &str) -> f64 {
    let kilohertz = name.rsplit(" at ").next().unwrap();
    1e3 * kilohertz.trim_end_matches(" kHz").parse::<f64>().unwrap()
}

fn moduli_are_those_of(material: &Material, result: &Value) {
    let mut checked = 0;
    for quantity in result["quantities"].as_array().unwrap() {
        let name = quantity["name"].as_str().unwrap();
        let expected = if name.starts_with("storage modulus at ") {
            material.storage_modulus(frequency_of(name))
        } else if name.starts_with("loss factor at ") {
            material.loss_factor
        } else {
            continue;
        };
        let value = quantity["value"].as_f64().unwrap();
        let error = quantity["standard_error"].as_f64().unwrap();
        // tolerance: four standard errors
        assert!(
            (value - expected).abs() < 4.0 * error,
            "{name}: {value} ± {error}, expected {expected}"
        );
        checked += 1;
    }
    assert!(checked >= 4, "{checked} moduli");
}

#[test]
fn polypropylene_and_the_member_of_a_frame_have_the_modulus_of_their_plans() {
    for example in ["polypropylene", "frame"] {
        moduli_are_those_of(&POLYPROPYLENE, &result_of(example, "modulus"));
    }
}

#[test]
fn one_shot_gives_the_modulus_of_a_polymer_bar() {
    let result = result_of("polymer_bar", "modulus");
    let polycarbonate = Material {
        modulus: 2.4,
        at: 10e3,
        loss_factor: 0.02,
    };
    moduli_are_those_of(&polycarbonate, &result);
    // the true sensitivities of both gauges are equal, which the sheet does not state
    let (gain, error) = quantity(&result, "error of the sensitivity of gauge 2, found");
    assert!(
        gain.abs() < 4.0 * error && error < 0.1,
        "{gain} ± {error} %"
    );
}

/// At a constant strain rate the stress is the sum of 10 MPa (rate/8)^(1/4) in the dashpot and the
/// stress of a spring of 50 MPa in parallel.
#[test]
fn one_shot_gives_the_stress_of_a_polymer_between_bars() {
    let result = result_of("shpb", "shpb");
    let of = |name: &str| column(&result, "stress_strain", name);
    let in_mpa = |name: &str| -> Vec<f64> {
        let values = of(name).into_iter();
        values.map(|value| 1e-6 * value).collect()
    };
    let (strain, stress, rate) = (of("strain"), in_mpa("stress_pa"), of("strain_rate_per_s"));
    let half = in_mpa("half_width_stress_95_pa");
    let rate_half = of("half_width_strain_rate_95_per_s");
    let (mut checked, mut most) = (0, 0.0_f64);
    for at in 4..strain.len() - 4 {
        // the spring in series contributes to the strain rate
        let elastic = (stress[at + 4] - stress[at - 4]) / 16e-6 / 1200.0;
        let viscous = rate[at] - elastic;
        if strain[at] > 0.016 && viscous > 40.0 {
            let expected = 10.0 * (viscous / 8.0).powf(0.25) + 50.0 * strain[at];
            let by_rate = 0.25 * expected * rate_half[at] / viscous;
            assert!(
                (stress[at] - expected).abs() < half[at] + by_rate,
                "{}: {} ± {} and {expected} ± {by_rate}",
                strain[at],
                stress[at],
                half[at]
            );
            most = most.max((stress[at] / expected - 1.0).abs());
            checked += 1;
        }
    }
    // tolerance: at the end of the pulse the rate changes within the 32 us that the band limit
    // resolves
    assert!(checked > 40 && most < 0.035, "{checked} {most}");
}

/// The law and the parameters of `plan.ron` are found from records of a flat striker and a recorder
/// with a filter.
#[test]
fn the_nylon_rod_has_the_law_of_its_plan() {
    let result = result_of("nylon", "identify");
    let first = result["summary"][0].as_str().unwrap();
    first.must_begin("The data support the law Maxwell-Norton");
    for (name, truth) in [
        ("Maxwell-Norton: Young's modulus E", 3.2e9),
        ("Maxwell-Norton: exponent kappa", 2.1),
        (
            "Maxwell-Norton: inelastic strain rate at 10 MPa F(10 MPa)",
            10.0,
        ),
    ] {
        is_found(&result, name, truth, [3.0, 0.05]);
    }
}

/// The comment in the sheet states the true values: the shifts and the law must agree with it.
#[test]
fn the_epoxy_has_the_law_and_the_shifts_of_its_sheet() {
    let result = result_of("epoxy", "fit");
    for (name, truth) in [
        ("WLF, C1", 12.0),
        ("WLF, C2", 90.0),
        ("fractional Zener, exponent", 0.45),
    ] {
        is_found(&result, name, truth, [4.0, 0.1]);
    }
    assert_eq!(column(&result, "shifts", "temperature_degc").len(), 13);
}

/// First two steps of the force. Piston and shank have the same section, so that the first step is
/// their impedance times half the velocity. When the reflection from the collar has returned, the
/// force is larger by the reflection coefficient.
#[test]
fn the_piston_presses_as_the_sections_of_the_shank_say() {
    let folder = Folder::of_example("drill_string");
    // 40 draws, instead of 200, determine the standard error to 11 %; tolerance: half of the
    // expected 1 % of the impulse
    let few = "duration: \"2.5 ms\", uncertainty: (draws: 40),";
    let sheet = folder
        .read("force.ron")
        .replace("duration: \"2.5 ms\",", few);
    sheet.must_say(few);
    folder.write("force.ron", sheet);
    let result = result_in(&folder, "force");
    let time = column(&result, "force", "time_s");
    let force = column(&result, "force", "force_n");
    let at = |wanted: f64| force[time.iter().position(|t| *t >= wanted).unwrap()];
    let area = |d: f64| std::f64::consts::PI * d * d / 4.0;
    let (impedance, speed) = ((206e9_f64 * 7800.0).sqrt(), (206e9_f64 / 7800.0).sqrt());
    let first = 0.5 * 9.5 * area(0.038) * impedance;
    let reflected = (area(0.052) - area(0.038)) / (area(0.052) + area(0.038));
    let back = 2.0 * 0.15 / speed;
    assert!((at(0.9 * back) / first - 1.0).abs() < 1e-6);
    assert!((at(1.3 * back) / first - 1.0 - reflected).abs() < 1e-6);
    let (impulse, error) = quantity(&result, "impulse");
    let momentum = 9.5 * 0.5 * area(0.038) * 7800.0;
    // the piston rebounds with 15 % of its velocity
    assert!(impulse / momentum > 1.1 && impulse / momentum < 1.2);
    assert!(error / impulse > 0.005 && error / impulse < 0.015);
}

#[test]
fn the_cone_presses_as_computed_from_its_impedances() {
    let result = result_of("cone", "force");
    let (peak, error) = quantity(&result, "peak force in the band");
    // the first jump is V/(1/Z1 + 1/Z2) with the impedances of the two faces; that of nylon is
    // proportional to a power of the frequency
    let exponent = 2.0 * 0.094_f64.atan() / std::f64::consts::PI;
    let area = |d: f64| std::f64::consts::PI * d * d / 4.0;
    let nylon = |f: f64| area(0.075) * (1150.0 * 2.6e9 * (f / 3e3).powf(exponent)).sqrt();
    let steel = area(0.010) * (7780.0 * 206e9_f64).sqrt();
    let jump = |f: f64| 0.93 / (1.0 / nylon(f) + 1.0 / steel);
    // tolerance: the Gaussian low-pass of the band rounds the peak, and the force falls by a few
    // per cent within 2 sigma of the low-pass
    assert!(
        peak > 0.93 * jump(1e4) && peak < jump(1e5),
        "{peak}, {} to {}",
        jump(1e4),
        jump(1e5)
    );
    assert!(
        (error / (0.01 * peak) - 1.0).abs() < 0.15,
        "the force is proportional to the velocity, of which there are 200 draws"
    );
    assert_eq!(column(&result, "contacts", "start_s").len(), 4);
}
