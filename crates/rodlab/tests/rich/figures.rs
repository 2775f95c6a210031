//! Figures with every kind of mark and role, on both scales, with gaps, errors and shaded ranges.

use std::f64::consts::{FRAC_PI_2, TAU};

use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

pub(crate) fn steps(count: u32, from: f64, to: f64) -> Vec<f64> {
    (0..count)
        .map(|i| from + (to - from) * f64::from(i) / f64::from(count - 1))
        .collect()
}

fn line(name: &str, role: Role, x: &[f64], y: impl Fn(f64) -> f64) -> Mark {
    Mark::curve(name, role, x, x.iter().map(|&x| y(x)).collect())
}

fn figure(name: &str, title: &str, caption: &str, panels: Vec<Panel>) -> Figure {
    Figure {
        caption: caption.into(),
        ..Figure::new(name, title, panels)
    }
}

/// A reproducible disturbance between -1 and 1.
fn rough(x: f64) -> f64 {
    (91.7 * x).sin() * (333.1 * x).cos() * (1777.3 * x + 1.0).sin()
}

/// Time histories of two channels with triggers and windows.
pub(crate) fn histories() -> Figure {
    let time = steps(65_536, 0.0, 1280.0);
    let hit = |t: f64, at: f64| {
        let since = t - at;
        if since < 0.0 {
            0.0
        } else {
            (-since / 40.0).exp() * (since * 2.1).sin()
        }
    };
    let at = |name: &str, x: f64| Mark::At {
        name: name.into(),
        x,
    };
    let near = Panel::new(
        ("time", "ms"),
        ("acceleration", "m/s^2"),
        vec![
            line("impacted end", Role::First, &time, |t| {
                900.0 * (hit(t, 200.0) + hit(t, 760.0)) + 8.0 * rough(t)
            }),
            line("free end", Role::Second, &time, |t| {
                430.0 * (hit(t, 201.3) + hit(t, 761.3)) + 8.0 * rough(t + 0.3)
            }),
            at("trigger of hit 1", 200.0),
            at("window begins", 210.0),
            at("trigger of hit 2", 760.0),
            at("end of the record", 1280.0),
        ],
    );
    figure(
        "histories",
        "Accelerations at both ends, two hits",
        "Vertical lines: triggers and the window of the first hit.",
        vec![near],
    )
}

/// Real and imaginary part of the response of two resonators.
fn resonators(f: f64) -> (f64, f64) {
    let part = |f0: f64, damping: f64| {
        let ratio = f / f0;
        let (real, imaginary) = (1.0 - ratio * ratio, damping * ratio);
        let square = real * real + imaginary * imaginary;
        (real / square, -imaginary / square)
    };
    let (low, high) = (part(120.0, 0.06), part(2300.0, 0.04));
    (low.0 + 1e-3 * high.0, low.1 + 1e-3 * high.1)
}

/// Magnitude of the response in the figure [m/s/N].
pub(crate) fn magnitude(f: f64) -> f64 {
    let (real, imaginary) = resonators(f);
    3e-5 * real.hypot(imaginary)
}

/// A frequency response with its phase and coherence.
pub(crate) fn response() -> Figure {
    let frequency: Vec<f64> = steps(800, 0.5, 4.0)
        .iter()
        .map(|e| 10_f64.powf(*e))
        .collect();
    let error = |f: f64| 0.03 + 0.4 * (f / 9000.0).powi(2);
    let edges = frequency.iter().map(|&f| {
        let edge = |sign: f64| magnitude(f) * (1.0 + sign * 2.6 * error(f));
        (f, edge(-1.0), edge(1.0))
    });
    let band = Mark::band("one standard error", Role::First, edges);
    let axis = || Axis::logarithmic("frequency", "Hz");
    figure(
        "response",
        "Frequency response of the face, ten hits",
        "Magnitude, phase and coherence on one axis of frequency.",
        vec![
            Panel::new(
                axis(),
                Axis::logarithmic("magnitude", "m/s/N"),
                vec![
                    band,
                    line("measured", Role::First, &frequency, magnitude),
                    line("chain model", Role::Reference, &frequency, |f| {
                        1.1 * magnitude(1.01 * f)
                    }),
                ],
            ),
            Panel::new(
                axis(),
                Axis::linear(
                    "phase of the velocity of the face relative to the force of the hammer",
                    "deg",
                )
                .within([-180.0, 180.0]),
                vec![line("measured", Role::First, &frequency, |f| {
                    let (real, imaginary) = resonators(f);
                    imaginary.atan2(real).to_degrees()
                })],
            ),
            Panel::new(
                axis(),
                Axis::linear("coherence", "").within([0.0, 1.05]),
                vec![line("coherence", Role::Third, &frequency, |f| {
                    1.0 / (1.0 + error(f).powi(2)) - 0.02 * rough(f).abs()
                })],
            ),
        ],
    )
}

/// Moduli with errors, bands, shaded ranges and invalid lines.
pub(crate) fn moduli() -> Figure {
    let frequency = steps(80, 0.25, 10.0);
    let storage = |f: f64| 2.6 + 0.12 * f.ln();
    let loss = |f: f64| 0.07 + 0.006 * (1.3 * f).sin();
    let sd = |f: f64| 0.012 + 0.0012 * f * f;
    let invalid = |f: f64| (3.9..4.6).contains(&f);
    let points =
        |name: &str, role, keep: &dyn Fn(f64) -> bool, scale: f64, y: &dyn Fn(f64) -> f64| {
            let kept = frequency.iter().copied().filter(|&f| keep(f));
            let points = kept.map(|f| (f, y(f) + scale * sd(f) * rough(f), scale * sd(f)));
            Mark::points_with_errors(name, role, points)
        };
    let grey = |from: f64, to: f64, because: &str| Greyed {
        from,
        to,
        because: because.into(),
    };
    let greyed = || {
        vec![
            grey(f64::NEG_INFINITY, 0.6, "rod shorter than a tenth of a wave"),
            grey(3.9, 4.6, "near a multiple of half a wave"),
        ]
    };
    let edges = frequency.iter();
    let edges = edges.map(|&f| (f, storage(f) - 2.0 * sd(f), storage(f) + 2.0 * sd(f)));
    let upper = Panel::new(
        ("frequency", "kHz"),
        ("E'", "GPa"),
        vec![
            Mark::band("fit, two standard errors", Role::Second, edges),
            line("fractional model", Role::Second, &frequency, |f| {
                if invalid(f) { f64::NAN } else { storage(f) }
            }),
            points("two points", Role::First, &|f| !invalid(f), 1.0, &storage),
            points("not valid", Role::Faint, &invalid, 9.0, &storage),
        ],
    );
    let lower = Panel::new(
        ("frequency", "kHz"),
        ("loss factor", ""),
        vec![
            line("fractional model", Role::Second, &frequency, loss),
            points("two points", Role::First, &|f| !invalid(f), 0.2, &loss),
            points(
                "three gauges",
                Role::Third,
                &|f| !invalid(f) && f < 7.0,
                0.15,
                &|f| loss(f) + 0.004,
            ),
            points("resonances", Role::Fourth, &|f| rough(f) > 0.4, 0.1, &|f| {
                loss(f) - 0.003
            }),
            points("supplier", Role::Fifth, &|f| rough(f) < -0.5, 0.1, &|f| {
                loss(f) + 0.006
            }),
            points(
                "printed",
                Role::Reference,
                &|f| rough(f).abs() < 0.05,
                0.1,
                &loss,
            ),
        ],
    );
    figure(
        "modulus",
        "Complex modulus of polypropylene at 23 °C",
        "Points with standard errors; grey where the result does not hold.",
        vec![upper.with_greyed(greyed()), lower.with_greyed(greyed())],
    )
}

/// A curve that runs back and forth on equal axes.
pub(crate) fn nyquist() -> Figure {
    let angle = steps(20_000, 0.0, TAU);
    let at = |offset: f64| -> Vec<f64> {
        angle
            .iter()
            .map(|a| 2.6 + 0.4 * (a + offset).cos() + 0.004 * rough(*a))
            .collect()
    };
    let curve = |name: &str, role, right: f64, down: f64| {
        let points = at(0.0).into_iter().zip(at(-FRAC_PI_2));
        Mark::line(name, role, points.map(|(x, y)| (x + right, y - down)))
    };
    let marks = vec![
        curve("measured", Role::First, 0.0, 2.0),
        curve("model", Role::Fifth, 0.05, 1.98),
    ];
    let round = Panel {
        equal_axes: true,
        ..Panel::new(("E'", "GPa"), ("E''", "GPa"), marks)
    };
    figure(
        "cole-cole",
        "Loss over storage modulus",
        "A unit is as long on one axis as on the other.",
        vec![round],
    )
}

/// Figure of cases that are hard to draw: no data, no visible data, one point, a constant, infinite
/// bands, unequal lengths.
pub(crate) fn hardly_anything() -> Figure {
    let nan = f64::NAN;
    let shown = Panel::new(
        Axis::linear("strain", "µε").within([1.0, 1.0]),
        ("stress", "MPa"),
        vec![
            line("constant", Role::First, &[0.0, 1.0, 2.0], |_| 5.0),
            line("none", Role::Second, &[0.0, 1.0], |_| f64::NAN),
            Mark::Points {
                name: "one".into(),
                role: Role::Third,
                x: vec![1.5, nan],
                y: vec![5.1, 5.0, 3.0],
                error: vec![f64::INFINITY],
            },
            Mark::band(
                "without end",
                Role::Fourth,
                [
                    (0.0, 4.9, 5.1),
                    (1.0, f64::NEG_INFINITY, f64::INFINITY),
                    (2.0, 4.9, 5.1),
                ],
            ),
            Mark::At {
                name: "nowhere".into(),
                x: nan,
            },
        ],
    );
    let shown = shown.with_greyed(vec![Greyed {
        from: 5.0,
        to: f64::INFINITY,
        because: "beyond what is shown".into(),
    }]);
    let negative = Panel::new(
        Axis::logarithmic("frequency", "Hz"),
        Axis::logarithmic("power", "m²/s⁴"),
        vec![line("not positive", Role::First, &[-1.0, 0.0], |x| x)],
    );
    let empty = Panel::new(("time", "s"), ("force", "N"), vec![]);
    let panels = vec![shown, negative, empty];
    Figure::new("hardly anything", "Hardly anything", panels)
}
