//! The job `fit` on virtual sweeps with known true values, on wrong tables, and on measured sweeps.
//!
//! The virtual material is a fractional Zener model whose relaxation time follows WLF or Arrhenius;
//! its formulas are in `fit/sweep.rs`.

mod measured;
mod over_time;
mod refused;
mod sweep;

use std::fs;

use rodfigure::Mark;
use rodlab::Outcome;
use rodlab::outcome::Verdict;
use sweep::{Sweep, Temperatures};

use crate::runs::{
    Folder, Words, answered, attachments_of, column as numbers, doubts, estimate, figures_of,
    is_found, path_of_example, quantity, tables_of, words,
};

fn interval_of(outcome: &Outcome, law: &str, parameter: &str) -> (f64, f64) {
    let laws = words(outcome, "parameters", "law").iter();
    let mut rows = laws.zip(words(outcome, "parameters", "parameter"));
    let row = rows.position(|(own, name)| own == law && name == parameter);
    let end = |name: &str| numbers(outcome, "parameters", name)[row.unwrap()];
    (end("lower end"), end("upper end"))
}

/// Confidence interval of a parameter of the fractional Zener model.
fn interval(outcome: &Outcome, parameter: &str) -> (f64, f64) {
    interval_of(outcome, "fractional Zener", parameter)
}

fn reasons(outcome: &Outcome) -> String {
    doubts(outcome).join("; ")
}

const LAWS: &str = "laws: (laws: [FractionalZener, GeneralisedMaxwell]),";

/// 41 rows of the virtual material at one temperature with 1 % of noise: the causal estimate gives
/// the modulus with smaller errors than the rows have, and rows with a fifth less loss contradict
/// every relaxing material.
#[test]
fn rows_are_told_from_those_of_no_relaxing_material() {
    let folder = Folder::new();
    let truth = |f: f64| {
        let power = num_complex::Complex64::new(0.0, std::f64::consts::TAU * f * 1e-2).powf(0.5);
        1e9 + 2e9 * power / (1.0 + power)
    };
    let mut noise = testbed::noise::Noise::seeded(5);
    let mut found = |loss: f64| {
        let rows = (0..41).map(|k| {
            let f = 10.0_f64.powf(0.075 * f64::from(k));
            let modulus = truth(f);
            let mut with_error = |value: f64| value * (1.0 + 0.01 * noise.normal());
            let (storage, loss) = (with_error(modulus.re), with_error(loss * modulus.im));
            format!("{f},{storage},{loss}\n")
        });
        let text = format!("f (Hz),E1 (Pa),E2 (Pa)\n{}", rows.collect::<String>());
        folder.write("rows.csv", text);
        let sheet = r#"Fit(title: "x", causal: true, tables: [(files: ["rows.csv"], frequency: "f", modulus: Parts(storage: "E1", loss: "E2"),
            temperature: Stated("20 degC"), errors: Parts(storage: "1 %", loss: "1 %"))])"#;
        folder.run(sheet).unwrap()
    };
    let good = found(1.0);
    assert_eq!(good.verdict, Verdict::Answered);
    let at = |column: &str| numbers(&good, "causal", column).to_vec();
    let rows = at("frequency").into_iter().zip(at("E'"));
    let mut squares = 0.0;
    for ((f, storage), error) in rows.zip(at("standard error of E'")) {
        let truth = 1e-9 * truth(f).re;
        squares += ((storage - truth) / error).powi(2) / 41.0;
        assert!(error < 0.01 * truth, "{f} Hz: {error}");
    }
    // tolerance: the errors of the causal estimate are common to many rows, so that there are only
    // a few independent values
    assert!((0.05..4.0).contains(&squares), "{squares}");
    assert!(reasons(&found(0.8)).contains("contradict every relaxing material"));
}

#[test]
fn a_virtual_sweep_gives_its_material_shifts_and_card_within_the_errors() {
    let sweep = Sweep::default();
    let folder = sweep.written(1993);
    let rest = r#"density: "1180 kg/m3", laws: (laws: [Zener, FractionalZener, GeneralisedMaxwell],
        cards: (name: "EPOXY", poisson_ratio: "0.38", programs: [Abaqus, LsDyna])),"#;
    let outcome = answered(folder.run(&sweep.sheet(rest)));

    let temperatures = numbers(&outcome, "shifts", "temperature");
    let log_shifts = numbers(&outcome, "shifts", "log10 of the shift");
    let errors = numbers(&outcome, "shifts", "standard error");
    assert_eq!(temperatures.len(), sweep.temperatures.len());
    for ((t, log), error) in temperatures.iter().zip(log_shifts).zip(errors) {
        let truth = sweep.log10_shift(*t);
        assert!(
            (log - truth).abs() <= 4.0 * error && *error < 0.2,
            "{t}: {log} ± {error}, true {truth}"
        );
    }
    outcome.summary[0]
        .must_begin("One curve at 60 °C from 13 of 13 temperatures (30 °C to 90 °C), over ");

    for (name, truth) in [("WLF, C1", sweep::C1), ("WLF, C2", sweep::C2)] {
        assert!(is_found(&outcome, name, truth, [4.0, 0.1]).valid);
    }
    assert!(!quantity(&outcome, "Arrhenius, activation energy").valid);

    // the law of the material and its parameters
    assert_eq!(words(&outcome, "laws", "law")[0], "fractional Zener");
    for (name, truth) in sweep.parameters() {
        let found = quantity(&outcome, &format!("fractional Zener, {name}"));
        let (low, high) = interval(&outcome, name);
        let margin = 0.5 * (high - low);
        assert!(
            found.valid && low - margin < truth && truth < high + margin,
            "{name}: {low} to {high}, true {truth}"
        );
    }
    let one_curve = "check: one curve for all temperatures, probability";
    assert!(quantity(&outcome, one_curve).valid);

    // the errors of the parameters include those of the shifts, which are similar to their random
    // errors
    let time = quantity(&outcome, "fractional Zener, relaxation time");
    let of = |part: &str| -> f64 {
        let (_, behind) = time.verdict.split_once(part).unwrap();
        behind.split([';', ',']).next().unwrap().parse().unwrap()
    };
    let (random, common) = (of("random ± "), of("common ± "));
    assert!(common > 0.3 * random, "{}", time.verdict);

    // the Prony series is compared with the formula over the band
    let x = numbers(&outcome, "master_curve", "reduced frequency");
    let storage = numbers(&outcome, "master_curve", "E' of the series");
    let loss = numbers(&outcome, "master_curve", "E'' of the series");
    for ((f, storage), loss) in x.iter().zip(storage).zip(loss) {
        let truth = 1e-9 * sweep.at_reference(*f);
        let off = (storage - truth.re).hypot(loss - truth.im) / truth.norm();
        assert!(off < 0.02, "{f}: {off}");
    }

    let names = attachments_of(&outcome);
    assert_eq!(names, "material.json, EPOXY.inp, EPOXY.k");
    let card = String::from_utf8(outcome.attachments[1].bytes.clone()).unwrap();
    card.must_say_all(&[
        "** data: 169 lines, ",
        "** temperature: master curve of 13 temperatures at 60 °C",
        "** source: sweep.csv",
        &format!("** SHA-256 {}", outcome.inputs[0].sha256),
        "*VISCOELASTIC, TIME=PRONY",
    ]);
    assert_eq!(
        figures_of(&outcome),
        "master_curve, nomogram, shifts, moduli, black_diagram, laws"
    );
    assert_eq!(
        tables_of(&outcome),
        "data, master_curve, shifts, shift_laws, series, laws, parameters"
    );
}

/// The nomogram is read as in ISO 10112: horizontally to the line of a temperature, then vertically
/// to the curves. The series is accurate to 2 %; a shift that is wrong by a tenth of a decade
/// changes the modulus by at least 5 %.
#[test]
fn a_modulus_read_from_the_nomogram_is_that_at_its_frequency_and_temperature() {
    let sweep = Sweep::default();
    let folder = sweep.written(1993);
    let outcome = folder.run(&sweep.sheet("")).unwrap();
    let figure = outcome.figures.iter().find(|f| f.name == "nomogram");
    let panels = &figure.unwrap().panels;
    let at = |mark: &Mark, x: f64| {
        let Mark::Line { x: xs, y: ys, .. } = mark else {
            panic!("{mark:?}")
        };
        let next = xs.iter().position(|other| *other > x).unwrap().max(1);
        let share = (x / xs[next - 1]).ln() / (xs[next] / xs[next - 1]).ln();
        ys[next - 1] * (ys[next] / ys[next - 1]).powf(share)
    };
    let mut read = 0;
    for line in &panels[1].marks {
        let Mark::Line { name, x, y, .. } = line else {
            panic!("{line:?}")
        };
        let temperature: f64 = name.split(' ').next().unwrap().parse().unwrap();
        for frequency in [1.0, 31.0, 1e4] {
            let (low, high) = (y.first().unwrap(), y.last().unwrap());
            if !(low..high).contains(&&frequency) {
                continue;
            }
            let reduced = x[0] * frequency / low;
            let truth = sweep.at_reference(frequency * 10_f64.powf(sweep.log10_shift(temperature)));
            let curve = |name: &str| {
                let mut marks = panels[0].marks.iter();
                marks.find(|mark| matches!(mark, Mark::Line { name: own, .. } if own == name))
            };
            let storage = 1e9 * at(curve("E'").unwrap(), reduced);
            let loss = storage * at(curve("loss factor").unwrap(), reduced);
            let off = (storage - truth.re).hypot(loss - truth.im) / truth.norm();
            assert!(off < 0.03, "{temperature} °C, {frequency} Hz: {off}");
            read += 1;
        }
    }
    assert!(read >= 10, "{read} places read");
}

/// The file of the example equals the virtual sweep; with `RODLAB_WRITE_EXAMPLES` set, it is
/// written first.
#[test]
fn the_example_is_the_sweep_of_this_test() {
    let file = path_of_example("epoxy/sweep.csv");
    let table = Sweep::default().table(1993);
    if std::env::var_os("RODLAB_WRITE_EXAMPLES").is_some() {
        fs::write(&file, &table).unwrap();
    }
    let is_it = fs::read_to_string(&file).unwrap() == table;
    assert!(is_it, "{} is another sweep", file.display());
}

/// Evaluates 40 sweeps, or the number in the environment variable `SEEDS`.
#[test]
fn intervals_of_shifts_and_parameters_cover_the_truth() {
    let seeds: u64 = testbed::noise::draws(40);
    let folder = Folder::new();
    let sweep = Sweep {
        per_decade: 3,
        ..Sweep::default()
    };
    let (mut shifts, mut all_shifts) = (0_u32, 0_u32);
    let (mut parameters, mut all_parameters) = (0_u32, 0_u32);
    let mut answered = 0_u32;
    let (mut chi_squared, mut admitted, mut constants) = (0.0, 0_u32, 0_u32);
    let mut series = std::collections::BTreeMap::new();
    for seed in 0..seeds {
        sweep.write(&folder.file("sweep.csv"), seed);
        let laws = "laws: (laws: [FractionalZener]),";
        let outcome = folder.run(&sweep.sheet(laws)).unwrap();
        answered += u32::from(outcome.verdict == Verdict::Answered);
        let of_shifts = |column: &str| numbers(&outcome, "shifts", column).iter();
        let ends = of_shifts("lower end").zip(of_shifts("upper end"));
        for (t, (lower, upper)) in of_shifts("temperature").zip(ends) {
            if (t - sweep::REFERENCE).abs() > 0.1 {
                let truth = sweep.log10_shift(*t);
                all_shifts += 1;
                shifts += u32::from(*lower <= truth && truth <= *upper);
            }
        }
        let of_curve = |column: &str| numbers(&outcome, "master_curve", column);
        let of_part = |part: &str| {
            let error = format!("standard error of {part} of the series");
            let values = of_curve(&format!("{part} of the series")).iter();
            values.zip(of_curve(&error)).collect::<Vec<_>>()
        };
        let (storage, loss) = (of_part("E'"), of_part("E''"));
        for (row, f) in of_curve("reduced frequency").iter().enumerate() {
            let truth = 1e-9 * sweep.at_reference(*f);
            let decade = f.log10().floor() as i32;
            for (part, ((value, error), truth)) in [
                ("E'", (storage[row], truth.re)),
                ("E''", (loss[row], truth.im)),
            ] {
                let of: &mut (f64, f64) = series.entry((part, decade)).or_default();
                of.0 += ((value - truth) / error).powi(2);
                of.1 += 1.0;
            }
        }
        let of_law = |column: &str| numbers(&outcome, "shift_laws", column)[0];
        chi_squared += of_law("chi-square") / seeds as f64;
        admitted += u32::from(of_law("probability") >= 0.01);
        for (name, truth) in [("C1", sweep::C1), ("C2", sweep::C2)] {
            let end = |which: &str| of_law(&format!("{which} end of {name}"));
            constants += u32::from(end("lower") <= truth && truth <= end("upper"));
        }
        for (name, truth) in sweep.parameters() {
            let (low, high) = interval(&outcome, name);
            all_parameters += 1;
            parameters += u32::from(low <= truth && truth <= high);
        }
    }
    let share = |part: u32, all: u32| f64::from(part) / f64::from(all);
    println!(
        "{seeds} sweeps, {answered} answered: {shifts} of {all_shifts} shifts and {parameters} of {all_parameters} parameters within 95 %;
         WLF: mean chi-square {chi_squared} of 10, {admitted} admitted, {constants} of {} constants within 95 %",
        2 * seeds
    );
    // tolerance: in every decade of the curve, including its ends, the Prony series deviates from
    // the power law by up to one of its standard errors, in addition to the random errors
    for ((part, decade), (squares, lines)) in series {
        let z = (squares / lines).sqrt();
        assert!(z < 1.5, "{part} from 1e{decade} Hz: {z} standard errors");
    }
    // tolerance: the shifts of one sweep have the error of the reference in common, so that 40
    // sweeps give about 100 independent values
    for (name, covered) in [
        ("shifts", share(shifts, all_shifts)),
        ("parameters", share(parameters, all_parameters)),
    ] {
        assert!((0.88..=0.995).contains(&covered), "{name}: {covered}");
    }
    // expected: a mean chi-square of 10, 99 % of the fits admitted, 95 % of the constants covered;
    // the errors of C1 and C2 are correlated
    let seeds = seeds as f64;
    assert!((chi_squared / 10.0 - 1.0).abs() < 0.3, "{chi_squared}");
    assert!(f64::from(admitted) > 0.9 * seeds, "{admitted}");
    assert!(f64::from(constants) > 0.85 * 2.0 * seeds, "{constants}");
    // expected: the check of the curve, with p < 0.01, rejects one sweep in a hundred
    assert!(f64::from(answered) > 0.9 * seeds, "{answered}");
}

#[test]
fn shifts_of_arrhenius_are_told_from_those_of_wlf() {
    let sweep = Sweep {
        activation_energy: Some(250e3),
        ..Sweep::default()
    };
    let folder = sweep.written(7);
    let outcome = folder.run(&sweep.sheet("")).unwrap();
    let name = "Arrhenius, activation energy";
    assert!(is_found(&outcome, name, 250.0, [4.0, 0.02]).valid);
    outcome.summary.must_begin("The shifts follow Arrhenius: ");
}

/// Errors that the sheet does not state follow from the scatter, even with two frequencies per
/// decade and a phase error \[rad\] of a fifth of the relative error of |E|.
#[test]
fn unstated_errors_are_those_of_the_scatter() {
    let sparse = Sweep {
        per_decade: 2,
        phase_noise: 0.002,
        ..Sweep::default()
    };
    for (sweep, said) in [
        (Sweep::default(), "weighted by |E|, temperatures"),
        (sparse, "weighted by |E|, which scatters "),
    ] {
        let folder = sweep.written(3);
        let stated = answered(folder.run(&sweep.sheet("")));
        let text = sweep.sheet("");
        let (before, after) = text.split_once("errors: ").unwrap();
        let (_, after) = after.split_once('\n').unwrap();
        let outcome = folder.run(&format!("{before}{after}")).unwrap();
        let warning = &outcome.warnings[0];
        warning.must_begin("No errors of the moduli are stated: ");
        warning.must_say(said);
        let of = |name: &str| [&stated, &outcome].map(|found| numbers(found, "shifts", name));
        let ([shifts, others], [errors, found]) = (of("log10 of the shift"), of("standard error"));
        assert_eq!(shifts.len(), sweep.temperatures.len());
        for row in 0..shifts.len() {
            let (a, b, error) = (shifts[row], others[row], errors[row]);
            assert!((a - b).abs() <= error.max(1e-9), "{a} {b}");
            let ratio = found[row] / error;
            assert!((ratio - 1.0).abs() < 0.15 || error == 0.0, "{ratio}");
        }
    }
}

/// The same numbers in another layout are the same data.
#[test]
fn columns_units_and_order_of_rows_do_not_matter() {
    let folder = Folder::new();
    let sweep = Sweep {
        temperatures: Temperatures::of(40, 80, 10),
        ..Sweep::default()
    };
    let shifts = |text: &str| {
        let outcome = folder.run(text).unwrap();
        let frequencies = numbers(&outcome, "data", "frequency");
        assert!((frequencies[0] - 0.1).abs() < 1e-6, "{} Hz", frequencies[0]);
        let modulus = numbers(&outcome, "data", "E'")[0];
        assert!((1.0..2.6).contains(&modulus), "{modulus} GPa");
        numbers(&outcome, "shifts", "log10 of the shift").to_vec()
    };
    sweep.write(&folder.file("sweep.csv"), 5);
    let expected = shifts(&sweep.sheet(""));
    for (modulus, errors, layout) in [
        (
            r#"StorageAndLossFactor(storage: "E'", loss_factor: "tan delta")"#,
            r#"Columns(StorageAndLossFactor(storage: "u E'", loss_factor: "u tan"))"#,
            sweep::Layout::LossFactor,
        ),
        (
            r#"MagnitudeAndPhase(magnitude: 3, phase: 4)"#,
            r#"MagnitudeAndPhase(magnitude: "1 %", phase: "0.01")"#,
            sweep::Layout::Phase,
        ),
    ] {
        sweep.write_as(&folder.file("other.txt"), 5, layout);
        let sheet = format!(
            r#"Fit(title: "other layout", tables: [(files: ["other.txt"], angular_frequency: "omega", modulus: {modulus},
                temperature: Column("T"), errors: {errors}, units: (temperature: "K"))], reference_temperature: "333.15 K")"#
        );
        let found = shifts(&sheet);
        for (a, b) in expected.iter().zip(&found) {
            // the errors of E' and tan δ differ slightly from those of |E| and δ
            assert!((a - b).abs() < 0.02, "{layout:?}: {expected:?} {found:?}");
        }
    }
    // one file for each temperature
    let mut names = Vec::new();
    for t in sweep.temperatures.all() {
        let one = Sweep {
            temperatures: Temperatures::of(t, t, 10),
            ..sweep.clone()
        };
        let name = format!("T{t}.csv");
        one.write(&folder.file(&name), 100 + u64::from(t.unsigned_abs()));
        names.push(name);
    }
    let text = sweep.sheet("").replace("\"sweep.csv\"", "\"T*.csv\"");
    let outcome = folder.run(&text).unwrap();
    let joined = numbers(&outcome, "shifts", "temperature").len();
    assert_eq!([outcome.inputs.len(), joined], [names.len(); 2]);
}

#[test]
fn one_temperature_gives_laws_alone() {
    let sweep = Sweep {
        temperatures: Temperatures::of(60, 60, 1),
        per_decade: 8,
        ..Sweep::default()
    };
    let folder = sweep.written(2);
    let text = sweep
        .sheet(LAWS)
        .replace("reference_temperature: \"60 degC\",", "");
    let outcome = answered(folder.run(&text));
    outcome.summary[0].must_begin("25 rows from 0.1 Hz to 100 Hz at 60 °C: E' = ");
    let (low, high) = interval(&outcome, "exponent");
    assert!(
        low < sweep::EXPONENT && sweep::EXPONENT < high && high - low < 0.2,
        "{low} {high}"
    );
}

#[test]
fn temperatures_that_overlap_nowhere_are_named_and_joined_by_a_stated_law() {
    let sweep = Sweep {
        temperatures: Temperatures::of(40, 120, 40),
        ..Sweep::default()
    };
    let folder = sweep.written(11);
    let text = sweep.sheet("").replace("\"60 degC\"", "\"80 degC\"");
    let outcome = folder.run(&text).unwrap();
    let said = reasons(&outcome);
    said.must_say("of 3 temperatures do not join the curve, because they do not overlap their neighbours within the errors: 40 °C");
    let (c1, c2) = (sweep::C1, sweep::C2);
    let known = format!("stated_shifts: Wlf(c1: {c1}, c2: {c2}, at: \"60 degC\"), reference");
    let outcome = answered(folder.run(&text.replace("reference", &known)));
    words(&outcome, "shifts", "verdict").must_say("as stated, without overlap");
}

/// Moduli proportional to T/T_r over 20 K can hardly be distinguished from constant moduli: the
/// errors of the parameters include both possibilities, and a warning states this.
#[test]
fn an_open_choice_of_the_factors_is_stated() {
    let seeds = 20;
    let folder = Folder::new();
    let sweep = Sweep {
        temperatures: Temperatures::of(50, 70, 5),
        per_decade: 2,
        is_entropic: true,
        ..Sweep::default()
    };
    let (mut squares, mut kept) = (0.0, 0);
    for seed in 0..seeds {
        sweep.write(&folder.file("sweep.csv"), seed);
        let text = sweep.sheet("laws: (laws: [FractionalZener]),");
        let outcome = folder.run(&text).unwrap();
        for (name, truth) in sweep.parameters() {
            let (value, error) = estimate(&outcome, &format!("fractional Zener, {name}"));
            squares += ((value - truth) / error).powi(2) / 4.0 / seeds as f64;
        }
        let factors = numbers(&outcome, "shifts", "factor of the modulus");
        if factors.iter().all(|factor| *factor == 1.0) {
            kept += 1;
            let warnings = &outcome.warnings;
            warnings.must_say("almost equally well: BIC differs by ");
            warnings.must_say(" 1 is used; with T/T_r the ");
        }
    }
    let rms = squares.sqrt();
    println!(
        "{kept} of {seeds} sweeps keep a factor of 1, rms of the errors {rms} standard errors"
    );
    assert!(kept > 0, "{kept}");
    // The errors of the four parameters are correlated, so that the mean square has a standard
    // deviation of 0.32. In 16 sweeps generated with NumPy the mean square is 0.76 if the errors
    // include the choice of the factors, and 2.9 otherwise.
    assert!(rms < 1.96_f64.sqrt(), "{rms}");
}

/// The labels of two temperatures are exchanged, as if relaxation slowed down with temperature.
#[test]
fn shifts_that_rise_with_temperature_put_the_result_in_doubt() {
    let sweep = Sweep::default();
    let folder = sweep.written(13);
    folder.edit("sweep.csv", |_, line| match line.rsplit_once(',') {
        Some((row, "55")) => format!("{row},65"),
        Some((row, "65")) => format!("{row},55"),
        _ => line.to_owned(),
    });
    let outcome = folder.run(&sweep.sheet("")).unwrap();
    let said = reasons(&outcome);
    said.must_say("the shifts do not fall with temperature from 55 °C to 60 °C");
    assert!(!quantity(&outcome, "check: shifts that rise with temperature").valid);
}

/// The exponent of the material falls with temperature: its curves differ in form.
#[test]
fn a_material_that_is_not_simple_is_in_doubt() {
    let sweep = Sweep {
        exponent_per_kelvin: -0.002,
        ..Sweep::default()
    };
    let folder = sweep.written(17);
    let outcome = folder.run(&sweep.sheet("")).unwrap();
    reasons(&outcome).must_say(
        "the temperatures do not form a single curve within the stated errors: chi-square",
    );
}

#[test]
fn a_negative_loss_is_noise_or_a_doubt() {
    let sweep = Sweep::default();
    let folder = sweep.written(19);
    folder.edit("sweep.csv", |number, line| {
        if number != 9 {
            return line.to_owned();
        }
        let cells: Vec<&str> = line.split(',').collect();
        format!("{},{},-{},{}", cells[0], cells[1], cells[2], cells[3])
    });
    let outcome = folder.run(&sweep.sheet("")).unwrap();
    let said = reasons(&outcome);
    said.must_say("the loss modulus is negative in 1 row(s), first in sweep.csv, line 10 (");
}
