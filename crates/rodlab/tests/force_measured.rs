//! The force when a measured body meets another: the body is struck by a virtual hammer first, and
//! the impact is integrated in time.

use std::fmt::Write as _;

use rodlab::outcome::{Outcome, Verdict};
use rodlab::output::{SheetIdentity, write};

use crate::runge_kutta::after_step;
use crate::runs::{
    Folder, Refused, Words, answered, column, doubts, estimate, figures_of, quantity, tables_of,
};
use crate::two_masses::{BODY, HAMMER, Hammer, struck};

const VELOCITY: f64 = 2.0;
const IMPEDANCE: f64 = 1000.0;

/// A folder with `body.uff`: the mobility by eight hits, lines up to 6 kHz.
fn measured() -> Folder {
    mobility().0
}

fn mobility() -> (Folder, Outcome) {
    let hammer = Hammer {
        pulse: 0.2e-3,
        ..HAMMER
    };
    let folder = struck("hit", BODY, hammer);
    let text = r#"Mobility(title: "two masses", source: Hits(
            records: (files: ["hit*.csv"], channels: [(name: "hammer", from: "force"), (name: "face", from: "acceleration")]),
            force: "hammer", response: "face"),
            support: Free(mass: "1.5 kg ± 1 gram"), up_to: "6 kHz", complete: (below: "100 Hz", fitted_to: "400 Hz"))"#;
    let outcome = folder.run(text).unwrap();
    folder.write("body.uff", &outcome.attachments[0].bytes);
    (folder, outcome)
}

/// Force at steps of 1 µs between the two masses, moving with [`VELOCITY`], and a long rod while
/// they are in contact, by the classical Runge-Kutta method.
fn truth(duration: f64) -> Vec<f64> {
    let step = 1e-6;
    let rate = |_, state: [f64; 3]| {
        // elongation of the spring, velocities of the struck mass and of the other mass
        let [stretch, face, other] = state;
        let pull = BODY.stiffness * stretch + BODY.damping * (face - other);
        [
            face - other,
            (-IMPEDANCE * face - pull) / BODY.struck,
            pull / BODY.behind,
        ]
    };
    let mut state = [0.0, VELOCITY, VELOCITY];
    let mut force = Vec::new();
    for _ in 0..=(duration / step) as u32 {
        force.push(IMPEDANCE * state[1]);
        state = after_step(state, 0.0, step, rate);
    }
    force
}

fn sheet(first: &str, rest: &str) -> String {
    format!(
        r#"Force(title: "measured", problem: Impact(first: Measured({first}), second: Impedance("1000 kg/s"),
        velocity: "2 m/s ± 0.5 %", duration: "5 ms", {rest}))"#
    )
}

const FIRST: &str =
    r#"file: "body.uff", support: Free(mass: "1.5 kg ± 1 gram"), scale_uncertainty: "1 %""#;

/// Front impedance of a face that is a rigid mass, whose velocity does not jump.
const FRONT: &str = r#", front_impedance: "1e9 kg/s""#;

#[test]
fn r05_without_a_front_impedance_the_force_is_had_on_lines_only() {
    let folder = measured();
    let outcome = answered(folder.run(&sheet(FIRST, "uncertainty: (draws: 60)")));
    let march = ["peak force", "end of the last contact"];
    let mut quantities = outcome.quantities.iter();
    assert!(!quantities.any(|q| march.contains(&q.name.as_str())));
    assert_eq!(tables_of(&outcome), "force, stick_force");
    outcome.warnings.must_say("front_impedance");
    outcome.summary[0].must_begin("On lines up to 6 kHz");
    // jobs that need time marching are refused
    for rest in [r#"contact: Linear("20 MN/m")"#, r#"time_step: "1 us""#] {
        let run = folder.run(&sheet(FIRST, rest));
        run.refused().must_say("front_impedance");
    }
}

#[test]
fn a_measured_body_presses_as_the_body_itself() {
    let folder = measured();
    let text = sheet(&format!("{FIRST}{FRONT}"), "uncertainty: (draws: 60)");
    let outcome = answered(folder.run(&text));
    let exact = truth(5e-3);
    let at = |time: f64| exact[(time * 1e6).round() as usize];
    // the two masses stay in contact: velocity and force decay with a time constant of 1.5 ms and
    // ring at 1.7 kHz
    let time = column(&outcome, "force", "time");
    let force = column(&outcome, "force", "force");
    for (t, f) in time.iter().zip(force) {
        // tolerance: the band ends at 6 kHz, so that the force rings after its initial jump (2 kN);
        // 0.5 ms later the amplitude is 1/(2 pi^2 6 kHz 0.5 ms) = 1.7 % of the jump
        if *t > 0.5e-3 && *t < 4.9e-3 {
            let exact = at(*t);
            assert!((f - exact).abs() < 0.03 * 2e3, "{t}: {f}, exact {exact}");
        }
    }
    // the band of the stick force, which is computed on lines
    let [time, force, errors, lower, upper] = [
        "time",
        "stick force",
        "standard error",
        "band of the whole contact, lower",
        "band of the whole contact, upper",
    ]
    .map(|name| column(&outcome, "stick_force", name));
    let mut n_inside = 0;
    let mut n_all = 0;
    for n in 0..time.len() {
        if time[n] > 0.5e-3 && time[n] < 4.9e-3 {
            // every error contains the common errors of the scale, 1 %, and of the velocity, 0.5 %
            assert!(errors[n] > 0.0 && lower[n] < force[n] && force[n] < upper[n]);
            n_all += 1;
            n_inside += usize::from(lower[n] <= at(time[n]) && at(time[n]) <= upper[n]);
        }
    }
    // the ringing due to the band limit is not a random error, but the wide band due to a scale
    // error of 1 % covers most of it
    assert!(n_inside * 10 > n_all * 7, "{n_inside} of {n_all}");
    let (peak, error) = estimate(&outcome, "peak of the stick force on lines");
    assert!(error > 0.005 * peak, "{peak} {error}");
    assert!(quantity(&outcome, "problem.first: lines that make energy").valid);
    assert_eq!(
        figures_of(&outcome),
        "force, faces, energies, sources, mobilities, stick_force"
    );
    let mut settings = outcome.settings.iter();
    let seed = settings.find(|setting| setting.name == "problem.uncertainty.seed");
    assert_eq!(seed.unwrap().value, "1");
}

/// The measured body is projected on causal and on passive bodies: the force is nearly unchanged,
/// and the change of the lines is reported.
#[test]
fn a_projection_says_what_it_has_changed() {
    let folder = measured();
    let peak = |projection: &str| {
        let first = format!("{FIRST}{FRONT}{projection}");
        let text = sheet(&first, "uncertainty: (draws: 60)");
        let outcome = answered(folder.run(&text));
        let peak = quantity(&outcome, "peak force in the band").value.unwrap();
        (outcome, peak)
    };
    let (_, before) = peak("");
    for (projection, onto) in [
        (", causal: true", "causal"),
        (", passive: true", "passive"),
        (", causal: true, passive: true", "causal and passive"),
    ] {
        let (outcome, after) = peak(projection);
        let name = format!("problem.first: change to the nearest {onto} body, in standard errors");
        let change = quantity(&outcome, &name);
        // tolerance: at the end of the band, lines with very small errors change by many of them
        let moved = change.value.unwrap();
        assert!(
            change.valid && moved < 15.0 && (onto == "passive" || moved > 1.0),
            "{change:?}"
        );
        assert!(
            (after / before - 1.0).abs() < 0.02,
            "{onto}: {after} {before}"
        );
    }
}

#[test]
fn more_error_of_the_scale_is_more_error_of_the_force() {
    let folder = measured();
    let error_of = |scale: &str| {
        let first = FIRST.replace("1 %", scale);
        let text = sheet(&first, "uncertainty: (draws: 60)");
        let outcome = folder.run(&text).unwrap();
        // the face is a mass: the initial jump Z V does not depend on the scale of the mobility,
        // but the later force does
        let errors = column(&outcome, "stick_force", "standard error");
        let later = column(&outcome, "stick_force", "time")
            .iter()
            .position(|time| *time > 1.5e-3);
        errors[later.unwrap()]
    };
    let (small, large) = (error_of("1 %"), error_of("5 %"));
    assert!(large > 2.0 * small, "{small} {large}");
}

#[test]
fn what_cannot_be_is_refused_where_it_stands() {
    let folder = measured();
    let refused = |first: &str, rest: &str| folder.run(&sheet(first, rest)).refused();
    let refusals = [
        refused(r#"file: "body.uff""#, ""),
        refused(FIRST, r#"lines: (up_to: "5 kHz", samples: 512)"#),
        refused(&format!("{FIRST}, kind: Accelerance"), ""),
        refused(&format!("{FIRST}, up_to: \"100 Hz\""), ""),
        refused(
            r#"file: "body.uff", support: Fixed, complete: (below: "100 Hz", fitted_to: "400 Hz")"#,
            "",
        ),
        refused(&FIRST.replace("file", "fiel"), ""),
        refused(&format!("{FIRST}{FRONT}"), r#"time_step: "17 us""#),
    ]
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    problem.first: line 0 of the measured mobility is not finite, expected the line at 0 Hz, a weighed mass or a fixed body
    problem.lines.samples is 512, expected no value: the lines are those of the measured body
    problem.first.kind is accelerance, expected mobility, because body.uff is in (m/s)/N
    problem.first.up_to is 100 Hz, with 5 lines up to it, expected a frequency with at least 8 lines below it
    problem.first.complete is stated, expected a free body, whose weighed mass replaces the low-frequency lines
    test.ron:1:58: Force.problem.Impact.first.Measured.fiel: there is no field `fiel`, only `file`, `data_set`, `imaginary`, `kind`, `standard_error`, `coherence`, `averages`, `up_to`, `support`, `complete`, `front_impedance`, `scale_uncertainty`, `delay_uncertainty`, `causal`, `passive`
    problem: ratio of the period of the measured lines to the time step is 2352.9411952941177, expected a whole number
    ");
}

/// A lossy rod with mobilities at both faces and a scale uncertainty, behind a computed rod and in
/// front of a dashpot: the force is that on one rod of both lengths.
#[test]
fn a_member_with_two_measured_faces_presses_as_in_one_piece() {
    use num_complex::Complex64;
    let folder = Folder::new();
    let (step, modulus, density, area) = (20.0, 3e9, 1150.0, 3.1416e-4);
    // mobilities of a Zener rod of 0.15 m, proportional to coth and 1/sinh of gamma L
    let entry = |of_ways: fn(Complex64) -> Complex64| {
        let mut text = String::from(
            "frequency [Hz],real part [m/(N s)],imaginary part [m/(N s)],error [m/(N s)]\n",
        );
        for line in 1..1400 {
            let s = Complex64::new(0.0, std::f64::consts::TAU * step * f64::from(line));
            let modulus = 0.8 * modulus + 0.2 * modulus * (s * 20e-6) / (1.0 + s * 20e-6);
            let impedance = area * (modulus * density).sqrt();
            let g = of_ways(s * (density / modulus).sqrt() * 0.15) / impedance;
            let (f, error) = (step * f64::from(line), 1e-3 * g.norm());
            writeln!(text, "{f},{:e},{:e},{error:e}", g.re, g.im).unwrap();
        }
        text
    };
    folder.write("same.csv", entry(|x| 1.0 / x.tanh()));
    folder.write("across.csv", entry(|x| 1.0 / x.sinh()));
    let mass = density * area * 0.15;
    let response = |file: &str| {
        format!(
            r#"response: (file: "{file}.csv", data_set: "real part", imaginary: "imaginary part", standard_error: "error")"#
        )
    };
    let bit = format!(
        r#"(name: "bit", measured: (points: ["shank", "edge"], support: Free(mass: "{mass} kg ± 0.1 gram"), scale_uncertainty: "1 %",
        mobilities: [(between: ("shank", "shank"), {same}), (between: ("edge", "shank"), {across}), (between: ("edge", "edge"), {same})]))"#,
        same = response("same"),
        across = response("across"),
    );
    let sheet = |second: &str| {
        format!(
            r#"Force(title: "bit", materials: {{ "it": (density: "1150 kg/m3", law: Zener(relaxed: "2.4 GPa", unrelaxed: "3 GPa", relaxation_time: "20 us")) }},
            problem: Impact(first: RigidMass("200 gram"), second: {second}, velocity: "2 m/s", duration: "3 ms", band: "5 kHz",
            time_step: "5 us", uncertainty: (draws: 40)))"#
        )
    };
    let rod =
        |length: &str| format!(r#"Rod(material: "it", diameter: "20 mm", length: "{length}")"#);
    let joints = r#"[(between: ("rod, end", "bit, shank")), (between: ("bit, edge", "rock"))]"#;
    let joined = format!(
        r#"Assembly(face: "rod", members: [(name: "rod", body: Chain(elements: [{}])), {bit}, (name: "rock", body: Impedance("900 kg/s"))], joints: {joints})"#,
        rod("400 mm")
    );
    let whole = format!(
        r#"Chain(elements: [{}], end: Dashpot("900 kg/s"))"#,
        rod("550 mm")
    );
    let found = answered(folder.run(&sheet(&joined)));
    let exact = folder.run(&sheet(&whole)).unwrap();
    let [ours, theirs] =
        [&found, &exact].map(|outcome| column(outcome, "force_in_band", "force in the band"));
    let peak = theirs.iter().copied().fold(0.0, f64::max);
    for (a, b) in ours.iter().zip(theirs) {
        assert!((a - b).abs() < 2e-3 * peak, "{a}, in one piece {b}");
    }
    // the error comes from the scale of the bit alone, behind a rod with exact properties: less
    // than 0.5 % of the force
    let (_, error) = estimate(&found, "peak force in the band");
    assert!(
        error > 1e-5 * peak && error < 5e-3 * peak,
        "{error} of {peak}"
    );
    // if the mobility is measured in the other direction, too, it must be equal by reciprocity;
    // otherwise the result is in doubt
    let backward = format!(r#"(between: ("edge", "shank"), {})"#, response("across"));
    folder.write("louder.csv", entry(|x| 1.05 / x.sinh()));
    for (file, difference, verdict) in [("across", 0.0, true), ("louder", 0.0488, false)] {
        let forward = format!(r#"(between: ("shank", "edge"), {})"#, response(file));
        let both = joined.replacen(&backward, &format!("{backward}, {forward}"), 1);
        let found = folder.run(&sheet(&both)).unwrap();
        let is_answered = found.verdict == Verdict::Answered;
        assert_eq!(is_answered, verdict, "{:?}", found.verdict);
        let compared = quantity(
            &found,
            "problem.second.members[1]: difference of the directions between \"shank\" and \"edge\"",
        );
        assert!(
            (compared.value.unwrap() - difference).abs() < 1e-3,
            "{compared:?}"
        );
    }
    // two mobilities between the same points, or a missing one, are refused with their place
    for (from, to, expected) in [
        (
            r#"("edge", "shank")"#,
            r#"("shank", "shank")"#,
            "several mobilities between \"shank\" and \"shank\"",
        ),
        (
            r#"("edge", "shank")"#,
            r#"("edge", "rim")"#,
            "one of \"shank\", \"edge\"",
        ),
    ] {
        let run = folder.run(&sheet(&joined.replacen(from, to, 1)));
        run.refused().must_say(expected);
    }
}

#[test]
fn r11_a_doubt_about_a_mobility_is_one_about_its_force() {
    let (folder, mut mobility) = mobility();
    let identity = SheetIdentity {
        file: "body.ron".to_owned(),
        sha256: "0".repeat(64),
    };
    let first = FIRST.replace("body.uff", "result/mobility.uff");
    let mut force = || {
        write(&mobility, &identity, &folder.file("result"), &[]).unwrap();
        mobility.doubt("the hits are one measurement");
        folder.run(&sheet(&first, ""))
    };
    answered(force());
    assert_eq!(
        doubts(&force().unwrap()),
        [
            "problem.first: the response of result/mobility.uff is in doubt: the hits are one measurement"
        ]
    );
}
