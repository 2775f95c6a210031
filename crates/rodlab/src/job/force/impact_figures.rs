//! Figures of an impact: the force with its contacts, the faces, the mobilities.

use impulse::ForceHistory;
use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::bodies::FaceBody;
use super::impact::{Found, ImpactSheet};
use super::impact_lines::OnLines;
use super::impact_march::March;
use crate::RodlabError;

/// Lines on which mobilities are drawn.
const LINES: usize = 400;

pub(super) fn all(
    found: &Found,
    bodies: [&FaceBody; 2],
    sheet: &ImpactSheet,
) -> Result<Vec<Figure>, RodlabError> {
    let mut figures = Vec::new();
    if let Some(march) = &found.march {
        figures.extend([force(march, found.on_lines.as_ref()), faces(march)]);
    }
    figures.push(mobilities(bodies, sheet)?);
    let until = 1e3 * sheet.duration.si();
    figures.extend(found.on_lines.as_ref().map(|lines| stick(lines, until)));
    Ok(figures)
}

fn milliseconds(history: &ForceHistory) -> Vec<f64> {
    (0..history.force().len())
        .map(|step| 1e3 * history.time_at(step))
        .collect()
}

/// Times at which the faces are apart.
fn apart(march: &March) -> Vec<Greyed> {
    let contacts = &march.prediction.contacts;
    let because = "the faces are apart".to_owned();
    let mut greyed = Vec::new();
    for (contact, next) in contacts
        .iter()
        .zip(contacts.iter().skip(1).map(Some).chain([None]))
    {
        if let Some(end) = contact.end {
            greyed.push(Greyed {
                from: 1e3 * end,
                to: next.map_or(f64::INFINITY, |next| 1e3 * next.begin),
                because: because.clone(),
            });
        }
    }
    greyed
}

fn force(march: &March, on_lines: Option<&OnLines>) -> Figure {
    let time = milliseconds(&march.limited);
    let newtons = march.limited.force();
    let mut marks = Vec::new();
    if let Some(errors) = march.limited_errors() {
        let edge = |sign: f64| -> Vec<f64> {
            let pairs = newtons.iter().zip(&errors);
            pairs.map(|(f, e)| f + sign * 2.0 * e).collect()
        };
        marks.push(Mark::Band {
            name: "two standard errors of the force in the band".to_owned(),
            role: Role::First,
            x: time.clone(),
            lower: edge(-1.0),
            upper: edge(1.0),
        });
    }
    marks.push(Mark::Line {
        name: "without a limit to the band".to_owned(),
        role: Role::Second,
        x: milliseconds(&march.prediction.history),
        y: march.prediction.history.force().to_vec(),
    });
    if let Some(lines) = on_lines {
        let history = &lines.stick.history;
        let (x, y) = history
            .force()
            .iter()
            .enumerate()
            .map(|(n, force)| (1e3 * history.time_at(n), *force))
            .filter(|(time, _)| *time >= -0.1)
            .unzip();
        marks.push(Mark::Line {
            name: "stick force on lines".to_owned(),
            role: Role::Reference,
            x,
            y,
        });
    }
    marks.push(Mark::Line {
        name: format!(
            "force up to {} kHz",
            super::impact_march::khz(march.band.upper_hz())
        ),
        role: Role::First,
        x: time,
        y: newtons.to_vec(),
    });
    Figure {
        name: "force".to_owned(),
        title: "Impact force".to_owned(),
        caption: "Positive in compression. Where it is grey the faces are apart. The band ends where its Gaussian low-pass is 3 dB down.".to_owned(),
        panels: vec![Panel {
            x: Axis::linear("time", "ms"),
            y: Axis::linear("force", "N"),
            marks,
            greyed: apart(march),
            equal_axes: false,
        }],
    }
}

fn faces(march: &March) -> Figure {
    let time = milliseconds(&march.prediction.history);
    let prediction = &march.prediction;
    let [first, second] = &prediction.face_velocity;
    let line = |name: &str, role: Role, y: Vec<f64>| Mark::Line {
        name: name.to_owned(),
        role,
        x: time.clone(),
        y,
    };
    Figure {
        name: "faces".to_owned(),
        title: "Velocities and approach of the faces".to_owned(),
        caption: "The approach is negative where there is a gap.".to_owned(),
        panels: vec![
            Panel {
                x: Axis::linear("time", "ms"),
                y: Axis::linear("velocity", "m/s"),
                marks: vec![
                    line("first body", Role::First, first.clone()),
                    line("second body", Role::Second, second.clone()),
                ],
                greyed: apart(march),
                equal_axes: false,
            },
            Panel {
                x: Axis::linear("time", "ms"),
                y: Axis::linear("approach", "µm"),
                marks: vec![line(
                    "",
                    Role::First,
                    prediction.approach.iter().map(|d| 1e6 * d).collect(),
                )],
                greyed: apart(march),
                equal_axes: false,
            },
        ],
    }
}

fn mobilities(bodies: [&FaceBody; 2], sheet: &ImpactSheet) -> Result<Figure, RodlabError> {
    // three decades up to the end of the band, or to the resolution of a step of a thousandth of
    // the duration
    let highest = sheet
        .lines
        .as_ref()
        .map_or(100.0 / sheet.duration.si(), |lines| lines.up_to.si());
    let frequencies: Vec<f64> = (0..LINES)
        .map(|line| highest * 10f64.powf(-3.0 * (1.0 - line as f64 / (LINES - 1) as f64)))
        .collect();
    let mut panels = [
        (Axis::logarithmic("mobility", "m/(N s)"), Vec::new()),
        (
            Axis::linear("phase", "deg").within([-100.0, 100.0]),
            Vec::new(),
        ),
    ];
    for ((body, name), role) in bodies
        .iter()
        .zip(["first body", "second body"])
        .zip([Role::First, Role::Second])
    {
        let (frequencies, values) = body.curve(&frequencies, &format!("mobility of the {name}"))?;
        let curves = [
            values.iter().map(|g| g.norm()).collect(),
            values.iter().map(|g| g.arg().to_degrees()).collect(),
        ];
        for ((_, marks), y) in panels.iter_mut().zip(curves) {
            marks.push(Mark::Line {
                name: name.to_owned(),
                role,
                x: frequencies.iter().map(|f| 1e-3 * f).collect(),
                y,
            });
        }
    }
    Ok(Figure {
        name: "mobilities".to_owned(),
        title: "Mobilities of the impact faces".to_owned(),
        caption: "A passive body has a phase between -90 and 90 degrees.".to_owned(),
        panels: panels
            .into_iter()
            .map(|(y, marks)| Panel {
                x: Axis::logarithmic("frequency", "kHz"),
                y,
                marks,
                greyed: Vec::new(),
                equal_axes: false,
            })
            .collect(),
    })
}

/// The stick force with its bands, and the impact force until the faces part.
#[allow(
    clippy::indexing_slicing,
    reason = "the bands and the impact force are those of the stick force, sample by sample"
)]
fn stick(lines: &OnLines, until: f64) -> Figure {
    let history = &lines.stick.history;
    let shown: Vec<usize> = (0..history.force().len())
        .filter(|n| 1e3 * history.time_at(*n) <= until)
        .collect();
    let time: Vec<f64> = shown.iter().map(|n| 1e3 * history.time_at(*n)).collect();
    let of = |values: &[f64]| -> Vec<f64> { shown.iter().map(|n| values[*n]).collect() };
    let band = |name: String, role: Role, band: &impulse::ForceBand| Mark::Band {
        name,
        role,
        x: time.clone(),
        lower: of(&band.lower),
        upper: of(&band.upper),
    };
    let line = |name: &str, role: Role, values: &[f64]| Mark::Line {
        name: name.to_owned(),
        role,
        x: time.clone(),
        y: of(values),
    };
    let mut marks = Vec::new();
    let mut caption =
        "By the Fourier transform on lines. Where it is negative the faces would have to pull."
            .to_owned();
    if let Some(bands) = &lines.bands {
        let percent = 100.0 * bands.level;
        marks.push(band(
            format!("whole history, {percent:.0} %"),
            Role::Second,
            &bands.simultaneous,
        ));
        marks.push(band(
            format!("at each time, {percent:.0} %"),
            Role::First,
            &bands.pointwise,
        ));
        marks.push(band(
            format!("impact force by draws, {percent:.0} %"),
            Role::Third,
            &bands.contact,
        ));
        if let impulse::ContactEnd::Separated { time } = lines.impact.end {
            marks.push(Mark::At {
                name: "the faces part".to_owned(),
                x: 1e3 * time,
            });
        }
        caption.push_str(
            " The bands are those of the random errors of mobilities, scales, velocity and masses.",
        );
    }
    marks.push(line("stick force", Role::First, history.force()));
    if lines.bands.is_some() {
        marks.push(line(
            "until the faces part",
            Role::Reference,
            lines.impact.history.force(),
        ));
    }
    Figure {
        name: "stick_force".to_owned(),
        title: "Stick force on lines".to_owned(),
        caption,
        panels: vec![Panel {
            x: Axis::linear("time", "ms"),
            y: Axis::linear("force", "N"),
            marks,
            greyed: Vec::new(),
            equal_axes: false,
        }],
    }
}
