//! Figures with every mark and role, on both scales, with gaps, errors and greyed ranges.

use std::f64::consts::{FRAC_PI_2, TAU};

use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

pub(crate) fn steps(count: u32, from: f64, to: f64) -> Vec<f64> {
    (0..count)
        .map(|i| from + (to - from) * f64::from(i) / f64::from(count - 1))
        .collect()
}

fn line(name: &str, role: Role, x: &[f64], y: impl Fn(f64) -> f64) -> Mark {
    Mark::Line {
        name: name.into(),
        role,
        x: x.to_vec(),
        y: x.iter().map(|&x| y(x)).collect(),
    }
}

fn panel(x: Axis, y: Axis, marks: Vec<Mark>) -> Panel {
    Panel {
        x,
        y,
        marks,
        greyed: vec![],
        equal_axes: false,
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
    let near = panel(
        Axis::linear("time", "ms"),
        Axis::linear("acceleration", "m/s^2"),
        vec![
            line("impacted end", Role::First, &time, |t| {
                900.0 * (hit(t, 200.0) + hit(t, 760.0)) + 8.0 * rough(t)
            }),
            line("free end", Role::Second, &time, |t| {
                430.0 * (hit(t, 201.3) + hit(t, 761.3)) + 8.0 * rough(t + 0.3)
            }),
            Mark::At {
                name: "trigger of hit 1".into(),
                x: 200.0,
            },
            Mark::At {
                name: "window begins".into(),
                x: 210.0,
            },
            Mark::At {
                name: "trigger of hit 2".into(),
                x: 760.0,
            },
            Mark::At {
                name: "end of the record".into(),
                x: 1280.0,
            },
        ],
    );
    Figure {
        name: "histories".into(),
        title: "Accelerations at both ends, two hits".into(),
        caption: "Vertical lines: triggers and the window of the first hit.".into(),
        panels: vec![near],
    }
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
    let band = Mark::Band {
        name: "one standard error".into(),
        role: Role::First,
        x: frequency.clone(),
        lower: frequency
            .iter()
            .map(|&f| magnitude(f) * (1.0 - 2.6 * error(f)))
            .collect(),
        upper: frequency
            .iter()
            .map(|&f| magnitude(f) * (1.0 + 2.6 * error(f)))
            .collect(),
    };
    let axis = || Axis::logarithmic("frequency", "Hz");
    Figure {
        name: "response".into(),
        title: "Frequency response of the face, ten hits".into(),
        caption: "Magnitude, phase and coherence on one axis of frequency.".into(),
        panels: vec![
            panel(
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
            panel(
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
            panel(
                axis(),
                Axis::linear("coherence", "").within([0.0, 1.05]),
                vec![line("coherence", Role::Third, &frequency, |f| {
                    1.0 / (1.0 + error(f).powi(2)) - 0.02 * rough(f).abs()
                })],
            ),
        ],
    }
}

/// Moduli with errors, bands, greyed ranges and lines that do not hold.
pub(crate) fn moduli() -> Figure {
    let frequency = steps(80, 0.25, 10.0);
    let storage = |f: f64| 2.6 + 0.12 * f.ln();
    let loss = |f: f64| 0.07 + 0.006 * (1.3 * f).sin();
    let sd = |f: f64| 0.012 + 0.0012 * f * f;
    let invalid = |f: f64| (3.9..4.6).contains(&f);
    let points =
        |name: &str, role, keep: &dyn Fn(f64) -> bool, scale: f64, y: &dyn Fn(f64) -> f64| {
            let x: Vec<f64> = frequency.iter().copied().filter(|&f| keep(f)).collect();
            Mark::Points {
                name: name.into(),
                role,
                y: x.iter().map(|&f| y(f) + scale * sd(f) * rough(f)).collect(),
                error: x.iter().map(|&f| scale * sd(f)).collect(),
                x,
            }
        };
    let greyed = || {
        vec![
            Greyed {
                from: f64::NEG_INFINITY,
                to: 0.6,
                because: "rod shorter than a tenth of a wave".into(),
            },
            Greyed {
                from: 3.9,
                to: 4.6,
                because: "near a multiple of half a wave".into(),
            },
        ]
    };
    let mut upper = panel(
        Axis::linear("frequency", "kHz"),
        Axis::linear("E'", "GPa"),
        vec![
            Mark::Band {
                name: "fit, two standard errors".into(),
                role: Role::Second,
                x: frequency.clone(),
                lower: frequency
                    .iter()
                    .map(|&f| storage(f) - 2.0 * sd(f))
                    .collect(),
                upper: frequency
                    .iter()
                    .map(|&f| storage(f) + 2.0 * sd(f))
                    .collect(),
            },
            line("fractional model", Role::Second, &frequency, |f| {
                if invalid(f) { f64::NAN } else { storage(f) }
            }),
            points("two points", Role::First, &|f| !invalid(f), 1.0, &storage),
            points("not valid", Role::Faint, &invalid, 9.0, &storage),
        ],
    );
    upper.greyed = greyed();
    let mut lower = panel(
        Axis::linear("frequency", "kHz"),
        Axis::linear("loss factor", ""),
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
    lower.greyed = greyed();
    Figure {
        name: "modulus".into(),
        title: "Complex modulus of polypropylene at 23 °C".into(),
        caption: "Points with standard errors; grey where the result does not hold.".into(),
        panels: vec![upper, lower],
    }
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
    let mut figure = panel(
        Axis::linear("E'", "GPa"),
        Axis::linear("E''", "GPa"),
        vec![
            Mark::Line {
                name: "measured".into(),
                role: Role::First,
                x: at(0.0),
                y: at(-FRAC_PI_2).iter().map(|v| v - 2.0).collect(),
            },
            Mark::Line {
                name: "model".into(),
                role: Role::Fifth,
                x: at(0.0).iter().map(|v| v + 0.05).collect(),
                y: at(-FRAC_PI_2).iter().map(|v| v - 1.98).collect(),
            },
        ],
    );
    figure.equal_axes = true;
    Figure {
        name: "cole-cole".into(),
        title: "Loss over storage modulus".into(),
        caption: "A unit is as long on one axis as on the other.".into(),
        panels: vec![figure],
    }
}

/// Figure of everything that is hard to draw: nothing, nothing that can be shown, one point, a
/// constant, bands to infinity, unequal lengths.
pub(crate) fn hardly_anything() -> Figure {
    let nan = f64::NAN;
    let mut shown = panel(
        Axis::linear("strain", "µε").within([1.0, 1.0]),
        Axis::linear("stress", "MPa"),
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
            Mark::Band {
                name: "without end".into(),
                role: Role::Fourth,
                x: vec![0.0, 1.0, 2.0],
                lower: vec![4.9, f64::NEG_INFINITY, 4.9],
                upper: vec![5.1, f64::INFINITY, 5.1],
            },
            Mark::At {
                name: "nowhere".into(),
                x: nan,
            },
        ],
    );
    shown.greyed = vec![Greyed {
        from: 5.0,
        to: f64::INFINITY,
        because: "beyond what is shown".into(),
    }];
    let negative = panel(
        Axis::logarithmic("frequency", "Hz"),
        Axis::logarithmic("power", "m²/s⁴"),
        vec![line("not positive", Role::First, &[-1.0, 0.0], |x| x)],
    );
    let empty = panel(
        Axis::linear("time", "s"),
        Axis::linear("force", "N"),
        vec![],
    );
    Figure {
        name: "hardly anything".into(),
        title: "Hardly anything".into(),
        caption: "".into(),
        panels: vec![shown, negative, empty],
    }
}
