//! Long random records, inputs that act together, and records of unequal length.

use super::*;
use crate::runs::{Folder, Words, answered, refusal};

/// Writes forces on both masses and the acceleration of the struck mass in volts, with 2 mV/N and
/// 100 mV/g, noise of 30 mV on the acceleration and a tenth of it on the forces. The forces are 0
/// in the first `silent` samples, and the second one is multiplied by `other`. They are random
/// cubic splines with a knot every eighth sample: their power above half the sampling rate, which a
/// recorder would remove, is below 1e-9 of that in the band (with forces linear between knots it
/// would be 1e-5, an error of 0.3 % in |H| that no stated error contains).
fn shaken(path: &Path, n: usize, silent: usize, other: f64, seed: u64) {
    const KNOTS: usize = 8;
    const STEPS: usize = 8;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut numbers = [0, 1].map(|_| {
        (0..n / KNOTS + 5)
            .map(|_| 60.0 * normal())
            .collect::<Vec<f64>>()
    });
    for numbers in &mut numbers {
        numbers[..silent.div_ceil(KNOTS) + 3].fill(0.0);
    }
    // the forces of the two shakers are correlated
    let forces = |t: f64| {
        let place = t * RATE / KNOTS as f64;
        let (knot, u) = (place as usize, place.fract());
        let weights = [
            (1.0 - u).powi(3),
            4.0 - 6.0 * u * u + 3.0 * u.powi(3),
            1.0 + 3.0 * (u + u * u - u.powi(3)),
            u.powi(3),
        ];
        let at = |k: usize| {
            let knots = weights.iter().zip(&numbers[k][knot..]);
            knots
                .map(|(weight, number)| weight * number / 6.0)
                .sum::<f64>()
        };
        [at(0), other * (at(1) + 0.5 * at(0))]
    };
    let (stiffness, damping) = spring();
    let rates = |t: f64, [q, p]: [f64; 2]| {
        let [one, two] = forces(t);
        let tension = stiffness * q + damping * p;
        [
            p,
            one / STRUCK - two / OTHER - tension * MASS / (STRUCK * OTHER),
        ]
    };
    let h = 1.0 / RATE / STEPS as f64;
    let mut state = [0.0; 2];
    let mut volts = Array2::zeros((3, n));
    for k in 0..n {
        let start = k as f64 / RATE;
        let tension = stiffness * state[0] + damping * state[1];
        let [one, two] = forces(start);
        let acceleration = (one - tension) / STRUCK;
        for (row, value) in [2e-3 * one, 2e-3 * two, 0.1 / 9.80665 * acceleration]
            .into_iter()
            .enumerate()
        {
            volts[[row, k]] = value + 3e-2 * if row == 2 { normal() } else { 0.1 * normal() };
        }
        for step in 0..STEPS {
            state = after_step(state, start + step as f64 * h, h, rates);
        }
    }
    let channels =
        ["one", "two", "acceleration"].map(|name| Channel::new(name, Quantity::Voltage).unwrap());
    let (channels, from) = (channels.to_vec(), Provenance::computed("shakers"));
    write(
        path,
        &Record::new(volts, RATE, 0.0, channels, from).unwrap(),
    );
}

fn shaken_sheet(rest: &str) -> String {
    format!(
        r#"Frf(title: "Shakers", records: (files: ["*.npy"], sampling_rate: "8192 Hz", channels: [
            (name: "shaker", from: 1, unit: "V", sensitivity: "2 mV/N"),
            (name: "other shaker", from: 2, unit: "V", sensitivity: "2 mV/N"),
            (name: "struck end", from: 3, unit: "V", sensitivity: "100 mV/g"),
        ]), input: "shaker", outputs: ["struck end"], band: (from: "50 Hz", to: "450 Hz"), {rest})"#
    )
}

/// Numbers of lines whose magnitude, and of lines whose phase, is within two standard errors of the
/// true value, including the error due to the width of the lines; and the number of all lines.
fn within_two(
    outcome: &Outcome,
    table: &str,
    truth: impl Fn(Complex64) -> Complex64,
) -> [usize; 3] {
    let of = |name: &str| column(outcome, table, name);
    let (frequency, magnitude, phase) =
        (of("frequency"), of("magnitude of accelerance"), of("phase"));
    let errors = [
        of("random error of the magnitude"),
        of("random error of the phase"),
    ];
    let width = of("systematic error by the width of the lines");
    let mut found = [0, 0, frequency.len()];
    for line in 0..frequency.len() {
        let truth = truth(Complex64::new(0.0, TAU * frequency[line]));
        let off = (Complex64::from_polar(magnitude[line], phase[line].to_radians()) / truth).ln();
        let width = width[line] / 100.0;
        let limits =
            [errors[0][line] / 100.0, errors[1][line].to_radians()].map(|e| 2.0 * e.hypot(width));
        found[0] += usize::from(off.re.abs() < limits[0]);
        found[1] += usize::from(off.im.abs() < limits[1]);
    }
    found
}

/// Accelerance of the struck mass for a force on the other one, closed form.
fn across(s: Complex64) -> Complex64 {
    let (stiffness, damping) = spring();
    let z = stiffness + damping * s;
    z / (STRUCK * OTHER * s * s + MASS * z)
}

#[test]
fn s14_long_random_records_give_the_response_of_the_body() {
    let folder = Folder::new();
    let silent = 4096;
    for (name, seed) in [("a.npy", 1), ("b.npy", 2)] {
        shaken(&folder.file(name), 10 * 8192 + silent, silent, 0.0, seed);
    }
    let sheet = shaken_sheet(r#"segments: (length: "1 s"), silent: "0.49 s","#);
    let outcome = answered(run(&folder, &sheet));
    let table = "response_struck_end";
    let [magnitude, phase, lines] = within_two(&outcome, table, accelerance);
    println!("{magnitude} {phase} of {lines}");
    // tolerance: 95.45 % of the lines are expected; with a Hann window a third of the 401 lines are
    // independent, so that the fraction has a standard error of 1.8 %, of which three are allowed
    assert!(magnitude as f64 > 0.90 * lines as f64 && phase as f64 > 0.90 * lines as f64);
    // each record has 19 half-overlapped segments; each independent segment except the first adds
    // two degrees of freedom
    let (averages, _) = quantity(&outcome, "averages");
    assert!((averages - 38.0).abs() < 1e-12, "{averages}");
    let freedom = column(&outcome, table, "degrees of freedom of the errors");
    assert!((60.0..74.0).contains(&freedom[0]), "{}", freedom[0]);
    // noise of (3 mV)^2 over 4096 Hz relative to (65 mV)^2 over some 500 Hz is 0.026 %, and several
    // times as much where the force is small by chance
    let bias = column(&outcome, table, "bias of the magnitude by noise at rest");
    assert!(bias.iter().all(|b| (-0.3..0.0).contains(b)), "{bias:?}");
    let mean = bias.iter().sum::<f64>() / bias.len() as f64;
    assert!((-0.05..-0.015).contains(&mean), "{mean}");
    let width = "systematic error by the width of the lines";
    let width = column(&outcome, table, width);
    assert!(width.iter().all(|e| e.is_finite()));
    let validity = words(&outcome, table, "validity").iter();
    assert!(validity.filter(|word| *word == "valid").count() > 390);
}

#[test]
fn s14_inputs_that_act_together_have_a_response_each() {
    let folder = Folder::new();
    shaken(&folder.file("a.npy"), 20 * 8192, 0, 1.0, 3);
    let both =
        r#"segments: (length: "8192 samples", overlap: "60 %"), further_inputs: ["other shaker"],"#;
    let outcome = answered(run(&folder, &shaken_sheet(both)));
    for (table, truth) in [
        (
            "response_struck_end_over_shaker",
            accelerance as fn(Complex64) -> Complex64,
        ),
        ("response_struck_end_over_other_shaker", across),
    ] {
        let [magnitude, phase, lines] = within_two(&outcome, table, truth);
        println!("{table}: {magnitude} {phase} of {lines}");
        assert!(
            magnitude as f64 > 0.90 * lines as f64 && phase as f64 > 0.90 * lines as f64,
            "{table}"
        );
        let multiple = column(&outcome, table, "multiple coherence");
        let partial = column(&outcome, table, "partial coherence");
        let mut pairs = multiple.iter().zip(&partial);
        assert!(pairs.all(|(all, one)| *all >= one - 1e-12));
        assert!(multiple.iter().sum::<f64>() > 0.9 * lines as f64);
    }
    // without the second shaker as an input, its part of the response is not coherent with the
    // first
    let alone = shaken_sheet(r#"segments: (length: "8192 samples"),"#);
    let alone = run(&folder, &alone).unwrap();
    let coherence = column(&alone, "response_struck_end", "coherence");
    assert!(coherence.iter().sum::<f64>() < 0.9 * coherence.len() as f64);
    for (rest, expected) in [
        (
            r#"further_inputs: ["other shaker"],"#,
            "further_inputs is other shaker, expected none with hits",
        ),
        (
            r#"segments: (length: "1 s"), further_inputs: ["shaker"],"#,
            "further_inputs[0] is `shaker`, expected every input once",
        ),
        (
            r#"segments: (length: "1 s"), further_inputs: ["other shaker"], estimator: H2,"#,
            "estimator is H2, expected H1",
        ),
        (
            r#"segments: (length: "1001 samples"),"#,
            "segments.length is 1001 samples, expected an even number",
        ),
        (
            r#"segments: (length: "1 s", overlap: "100 %"),"#,
            "segments.overlap is 100 %, expected a part",
        ),
        (
            r#"segments: (length: "1 s"), hits: (odd: LeaveOut),"#,
            "hits is stated together with `segments`",
        ),
        (
            r#"segments: (length: "21 s"),"#,
            "the record to be cut into segments has 163840 samples, expected at least 172032",
        ),
    ] {
        let said = run(&folder, &shaken_sheet(rest)).unwrap_err();
        said.must_say(expected);
    }
}

#[test]
fn s14_hits_of_unequal_length_are_continued_by_rest() {
    let folder = hits(4, 1e-3, NOISE);
    let cut = |n: usize, name: &str, seed: u64| {
        let history = history(n, |t| blow(t - ONSET, 180.0, 1e-3));
        write(&folder.file(name), &recorded(&history, NOISE, seed));
    };
    cut(3000, "hit_8.npy", 18);
    let outcome = answered(frf(&folder, "*.npy", BAND));
    let settings = outcome.settings.iter();
    let said = settings.filter(|s| s.name.contains("extended at rest"));
    let said: Vec<_> = said.map(|s| (s.name.as_str(), s.value.as_str())).collect();
    assert_eq!(said, [("hits: hits extended at rest to 4096 samples", "5")]);
    let (mean, _) = spread(&outcome, "accelerance", |f| accelerance(on_axis(f)));
    // for five hits the ratio is distributed as F(2, 8), with the mean 4/3
    assert!((0.9..2.0).contains(&mean), "{mean}");
    // at sample 1100 the mode has decayed to a hundredth, which is three thousandths of the peak:
    // the checks pass, but the record is not at rest
    cut(1100, "hit_9.npy", 19);
    let moving = frf(&folder, "*.npy", BAND).unwrap_err();
    moving.must_say_all(&[
            "hits: hit 6, hit_9.npy is 1100 samples, and `struck end` deviates",
            "expected 4096 samples, the length of the longest hit, or a hit that ends at rest, so that it can be extended",
        ]);
}

#[test]
fn s14_a_hysteresis_beyond_the_signal_is_told() {
    let folder = hits(1, 1e-3, NOISE);
    let sheet = sheet_of(
        "*.npy",
        r#"hits: (cut: Trigger(level: "20 N", hysteresis: "300 N", pre_trigger: "10 ms", length: "2048 samples")),"#,
    );
    let outcome = run(&folder, &sheet).unwrap();
    insta::assert_snapshot!(refusal(&outcome), @"no hit is found (hit 1, hit_0.npy: not triggered: `hammer` crosses 20.00, but was never at least 300.0 (the hysteresis) on the other side of it; its values are between -0.334 and 147.9)");
}
