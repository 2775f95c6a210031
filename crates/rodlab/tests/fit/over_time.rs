//! Relaxation and creep in tables. The virtual material is a standard linear solid, whose responses
//! to a ramp are known in closed form.

use rodlab::Outcome;
use rodlab::outcome::Verdict;
use testbed::noise::Noise;

use super::{interval_of, numbers};
use crate::runs::{Folder, Words, attachments_of, figures_of};

const RELAXED: f64 = 0.4e9;
const INCREMENT: f64 = 1.6e9;
const TIME: f64 = 30.0;
const RAMP: f64 = 12.0;

/// Mean of e^{-t/τ} over the ramp.
fn decay(time: f64, tau: f64) -> f64 {
    let start = (time - RAMP).max(0.0);
    (tau / RAMP) * ((-start / tau).exp() - (-time / tau).exp())
}

/// Stress divided by the final strain, which is held after the ramp \[Pa\].
fn relaxation(time: f64) -> f64 {
    RELAXED * (time / RAMP).min(1.0) + INCREMENT * decay(time, TIME)
}

/// Strain divided by the final stress, which is held after the ramp; the retardation time is τ
/// (E₀ + ΔE)/E₀.
fn creep(time: f64) -> f64 {
    let tau = TIME * (RELAXED + INCREMENT) / RELAXED;
    let retarded = 1.0 / RELAXED - 1.0 / (RELAXED + INCREMENT);
    (time / RAMP).min(1.0) / RELAXED - retarded * decay(time, tau)
}

/// Rows from the start of the load on, two per second for 10 minutes, with 0.5 % of noise.
fn rows(names: &str, seed: u64, of: impl Fn(f64) -> f64) -> String {
    let mut noise = Noise::seeded(seed);
    let row = |k: u32| {
        let seconds = 0.5 * f64::from(k);
        let value = of(seconds) * (1.0 + 0.005 * noise.normal());
        format!("{},{value}\n", seconds / 60.0)
    };
    format!("{names}\n{}", (0..1200).map(row).collect::<String>())
}

fn fitted(folder: &Folder, tables: &str) -> Outcome {
    let sheet = format!(
        r#"Fit(title: "x", density: "1200 kg/m3", tables: [{tables}], laws: (laws: [Zener, Elastic], most_lines: 150))"#
    );
    folder.run(&sheet).unwrap()
}

const RELAXATION: &str = r#"(files: ["relaxation.csv"], time: "t", ramp: "12 s", modulus: Relaxation(modulus: "E"),
    temperature: Stated("23 degC"), errors: OverTime("0.5 %"))"#;
const CREEP: &str = r#"(files: ["creep.csv"], time: 1, ramp: "0.2 min", modulus: Creep(compliance: "J"),
    temperature: Stated("23 degC"), errors: OverTime("0.5 %"))"#;

fn folder() -> Folder {
    let folder = Folder::new();
    let relaxation = rows("t (min),E (MPa)", 1, |t| 1e-6 * relaxation(t));
    folder.write("relaxation.csv", relaxation);
    let creep = rows("t (min),J (1/GPa)", 2, |t| 1e9 * creep(t));
    folder.write("creep.csv", creep);
    folder
}

fn covers(outcome: &Outcome) {
    for (name, truth) in [
        ("relaxed modulus", RELAXED),
        ("modulus increment", INCREMENT),
        ("relaxation time", TIME),
    ] {
        let (lower, upper) = interval_of(outcome, "Zener", name);
        // tolerance: twice the 95 % interval, outside which one value in 10 000 lies
        let half = 0.5 * (upper - lower);
        let middle = 0.5 * (lower + upper);
        assert!(
            (truth - middle).abs() < 2.0 * half,
            "{name}: {lower} {upper}"
        );
        assert!(half < 0.06 * truth, "{name}: {lower} {upper}");
    }
}

#[test]
fn a_solid_is_found_from_relaxation_from_creep_and_from_both() {
    let folder = folder();
    let both = format!("{RELAXATION}, {CREEP}");
    let mut widths = Vec::new();
    for tables in [RELAXATION, CREEP, &both] {
        let outcome = fitted(&folder, tables);
        assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.warnings);
        covers(&outcome);
        let (lower, upper) = interval_of(&outcome, "Zener", "relaxation time");
        widths.push(upper - lower);
        let chi = numbers(&outcome, "laws", "chi-square")[0];
        let freedom = numbers(&outcome, "laws", "degrees of freedom")[0];
        assert!((chi / freedom - 1.0).abs() < 0.5, "{chi} {freedom}");
        // rows during the ramp are left out, and there are no more rows than requested
        let times = numbers(&outcome, "data", "time");
        assert!(times.iter().all(|time| *time > RAMP), "{times:?}");
        assert!((60..=150).contains(&times.len()), "{}", times.len());
        attachments_of(&outcome).must_say("material.json");
        assert_eq!(figures_of(&outcome), "over_time, laws_over_time");
    }
    // the joint fit uses half of the rows of each test, and thus half of the information
    let information = |width: &f64| 0.5 / (width * width);
    let of_both = 1.0 / (information(&widths[0]) + information(&widths[1])).sqrt();
    assert!(
        (widths[2] / of_both - 1.0).abs() < 0.15,
        "{widths:?} {of_both}"
    );
}

/// Unstated ramp: chi-square shows that no law fits, and puts the answer and the
/// material file in doubt.
#[test]
fn a_ramp_that_is_forgotten_is_seen() {
    let folder = folder();
    let outcome = fitted(&folder, &RELAXATION.replace(r#"ramp: "12 s", "#, ""));
    let doubt = "no law explains the moduli within their stated errors";
    super::reasons(&outcome).must_say(doubt);
    let mut files = outcome.attachments.iter();
    let material = files.find(|file| file.name == "material.json").unwrap();
    let material = String::from_utf8(material.bytes.clone()).unwrap();
    material.must_say(doubt);
}

#[test]
fn times_are_chosen_and_without_errors_the_scatter_gives_them() {
    let folder = folder();
    let tables = RELAXATION
        .replace(
            r#"errors: OverTime("0.5 %")"#,
            r#"times: (from: "20 s", to: "300 s")"#,
        )
        .replace("temperature", "units: (time: \"min\"), temperature");
    let outcome = fitted(&folder, &tables);
    covers(&outcome);
    let times = numbers(&outcome, "data", "time");
    assert!(
        times.iter().all(|time| (19.999..300.001).contains(time)),
        "{times:?}"
    );
}

/// A DMA and a relaxation test at the same temperature are fitted together.
#[test]
fn moduli_over_frequency_stand_beside_those_over_time() {
    let folder = folder();
    let mut noise = Noise::seeded(3);
    let row = |k: i32| {
        let f = 10.0_f64.powf(-3.0 + 0.1 * f64::from(k));
        let s_tau = num_complex::Complex64::new(0.0, std::f64::consts::TAU * f * TIME);
        let modulus = RELAXED + INCREMENT * s_tau / (1.0 + s_tau);
        let mut part = |value: f64| value + 0.005 * modulus.norm() * noise.normal();
        format!("{f},{},{}\n", part(modulus.re), part(modulus.im))
    };
    let text: String = (0..31).map(row).collect();
    folder.write("dma.csv", format!("f (Hz),E1 (Pa),E2 (Pa)\n{text}"));
    let dma = r#"(files: ["dma.csv"], frequency: "f", modulus: Parts(storage: "E1", loss: "E2"), temperature: Stated("23 degC"),
        errors: MagnitudeAndPhase(magnitude: "0.5 %", phase: "0.005"))"#;
    let outcome = fitted(&folder, &format!("{RELAXATION}, {dma}"));
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.warnings);
    covers(&outcome);
    let frequencies = numbers(&outcome, "data", "frequency");
    let times = numbers(&outcome, "data", "time");
    for (frequency, time) in frequencies.iter().zip(times) {
        assert!(frequency.is_nan() != time.is_nan(), "{frequency} {time}");
    }
    assert_eq!(outcome.figures.len(), 5);
}

#[test]
fn a_modulus_that_rises_with_time_is_in_doubt() {
    let folder = Folder::new();
    let text = rows("t (min),E (MPa)", 4, |t| 1000.0 * (1.0 + t).powf(0.02));
    folder.write("relaxation.csv", text);
    let said = super::reasons(&fitted(&folder, RELAXATION));
    said.must_say("the modulus rises with time in 1 test(s), first at 23 \u{b0}C");
}

/// A Poisson's ratio of 0.1 in the middle of a decade and a half of modulus, with a constant bulk
/// modulus, is impossible at the ends: there is no card, but the laws are fitted nevertheless.
#[test]
fn a_card_that_cannot_be_costs_no_other_result() {
    let folder = Folder::new();
    let text = rows("t (min),E (MPa)", 4, |t| {
        10.0 + 3000.0 * (1.0 + t).powf(-0.9)
    });
    folder.write("relaxation.csv", text);
    let sheet = format!(
        r#"Fit(title: "x", density: "1200 kg/m3", tables: [{RELAXATION}], laws: (laws: [GeneralisedMaxwell],
            cards: (name: "A", poisson_ratio: "0.1", programs: [Abaqus])))"#
    );
    let outcome = folder.run(&sheet).unwrap();
    let said = outcome.warnings.join("\n");
    said.must_say("No card is written: instantaneous Poisson ratio");
    assert_eq!(attachments_of(&outcome), "material.json");
}

/// Monte Carlo draws of the rows are fitted like the rows: the scatter of the results equals the
/// stated errors.
#[test]
fn draws_of_moduli_over_time_scatter_by_the_stated_errors() {
    let folder = folder();
    let sheet = format!(
        r#"Fit(title: "x", monte_carlo: 60, tables: [{RELAXATION}], laws: (laws: [Zener], most_lines: 60))"#
    );
    let outcome = folder.run(&sheet).unwrap();
    let names = super::words(&outcome, "monte_carlo", "quantity");
    let of = |column: &str| numbers(&outcome, "monte_carlo", column);
    for name in ["relaxed modulus", "modulus increment", "relaxation time"] {
        let row = names.iter().position(|own| own.contains(name)).unwrap();
        let ratio = of("Monte Carlo standard error")[row] / of("standard error")[row];
        // tolerance: the standard deviation of 60 draws is known to 9 %
        assert!((ratio - 1.0).abs() < 0.3, "{name}: {ratio}");
    }
}
