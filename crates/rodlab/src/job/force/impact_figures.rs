//! Figures of an impact: the force with its contacts, the motion of the faces, and the mobilities.

use impulse::{ImpactSource, UncertainPrediction};
use rodfigure::{Axis, Figure, Greyed, Mark, Panel, Role};

use super::bodies::FaceBody;
use super::histories::milliseconds;
use super::impact_lines::OnLines;
use super::impact_sheet::ImpactSheet;
use super::impact_tables;
use super::impact_tables::Found;
use crate::RodlabError;

/// Number of frequencies at which the mobilities are plotted.
const LINES: usize = 400;

pub(super) fn all(
    found: &Found,
    bodies: [&FaceBody; 2],
    sheet: &ImpactSheet,
) -> Result<Vec<Figure>, RodlabError> {
    let mut figures = Vec::new();
    if let Some(march) = &found.march {
        figures.extend([force(march, found.on_lines.as_ref())?, faces(march)]);
        figures.push(energies(march));
        figures.extend(sources(march));
    }
    figures.push(mobilities(bodies, sheet)?);
    let until = 1e3 * sheet.duration.si();
    figures.extend(found.on_lines.as_ref().map(|lines| stick(lines, until)));
    Ok(figures)
}

/// Times at which the faces are apart.
fn apart(march: &UncertainPrediction) -> Vec<Greyed> {
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

fn force(march: &UncertainPrediction, on_lines: Option<&OnLines>) -> Result<Figure, RodlabError> {
    let time = milliseconds(&march.limited);
    let newtons = march.limited.force();
    let mut marks = Vec::new();
    if let Some(band) = impact_tables::whole_history(march)? {
        let ends = time.iter().zip(&band.lower).zip(&band.upper);
        let edges = ends.map(|((t, lower), upper)| (*t, *lower, *upper));
        marks.push(Mark::band("95 % band, whole history", Role::Third, edges));
    }
    if let Some(errors) = march.limited_errors() {
        let values = time.iter().zip(newtons).zip(&errors);
        let edges = values.map(|((t, f), e)| (*t, f - 2.0 * e, f + 2.0 * e));
        let name = "two standard errors of the force in the band";
        marks.push(Mark::band(name, Role::First, edges));
    }
    let history = &march.prediction.history;
    let (name, forces) = ("without band limit", history.force().to_vec());
    marks.push(Mark::curve(
        name,
        Role::Second,
        &milliseconds(history),
        forces,
    ));
    if let Some(lines) = on_lines {
        let history = &lines.stick.history;
        let forces = history.force().iter().enumerate();
        let points = forces
            .map(|(n, force)| (1e3 * history.time_at(n), *force))
            .filter(|(time, _)| *time >= -0.1);
        marks.push(Mark::line("stick force on lines", Role::Reference, points));
    }
    let upper = super::impact_march::khz(march.band.upper_hz());
    let name = format!("force up to {upper} kHz");
    marks.push(Mark::curve(name, Role::First, &time, newtons.to_vec()));
    let panel = Panel::new(("time", "ms"), ("force", "N"), marks).with_greyed(apart(march));
    Ok(Figure::new("force", "Impact force", vec![panel]).with_caption(
        "Positive in compression. The faces are apart in the grey intervals. The band ends where its Gaussian low-pass is 3 dB down.",
    ))
}

fn faces(march: &UncertainPrediction) -> Figure {
    let time = milliseconds(&march.prediction.history);
    let prediction = &march.prediction;
    let [first, second] = &prediction.face_velocity;
    let panel = |label: &str, unit: &str, marks| {
        Panel::new(("time", "ms"), (label, unit), marks).with_greyed(apart(march))
    };
    let velocities = vec![
        Mark::curve("first body", Role::First, &time, first.clone()),
        Mark::curve("second body", Role::Second, &time, second.clone()),
    ];
    let approach = prediction.approach.iter().map(|d| 1e6 * d).collect();
    let approach = vec![Mark::curve("", Role::First, &time, approach)];
    let panels = vec![
        panel("velocity", "m/s", velocities),
        panel("approach", "µm", approach),
    ];
    Figure::new("faces", "Velocities and approach of the faces", panels)
        .with_caption("The approach is negative where there is a gap.")
}

/// Figure of energy and momentum over time.
fn energies(march: &UncertainPrediction) -> Figure {
    let prediction = &march.prediction;
    let found = prediction.energies();
    let half = 0.5e3 * prediction.history.time_step();
    let time: Vec<f64> = milliseconds(&prediction.history)
        .iter()
        .map(|middle| middle + half)
        .collect();
    let panel =
        |y: (&str, &str), marks| Panel::new(("time", "ms"), y, marks).with_greyed(apart(march));
    let mut marks = Vec::new();
    let roles = [[Role::First, Role::Second], [Role::Third, Role::Fourth]];
    let bodies = ["first", "second"].into_iter().zip(roles);
    let of_bodies = found.translation.into_iter().zip(found.inner);
    for ((body, [moves, rest]), (translation, inner)) in bodies.zip(of_bodies) {
        let name = format!("motion of the {body} body");
        marks.extend(translation.map(|energy| Mark::curve(name, moves, &time, energy)));
        let name = format!("vibration, waves and heat of the {body} body");
        marks.push(Mark::curve(name, rest, &time, inner));
    }
    let largest = found.in_contact.iter().map(|e| e.abs()).fold(0.0, f64::max);
    let given = prediction.balance();
    if largest > 1e-3 * given.inner.iter().copied().fold(0.0, f64::max) {
        marks.push(Mark::curve("contact", Role::Fifth, &time, found.in_contact));
    }
    let momentum = Mark::curve("", Role::First, &time, found.impulse);
    Figure::new(
        "energies",
        "Energy and momentum over time",
        vec![
            panel(("energy", "J"), marks),
            panel(("momentum transferred", "N s"), vec![momentum]),
        ],
    )
    .with_caption(
        "In the frame in which the second body is at rest before the impact. If the first body is free, all energies add up to its energy before the impact.",
    )
}

/// Figure of the contributions of the error sources to the band over time; `None` without draws.
fn sources(march: &UncertainPrediction) -> Option<Figure> {
    let spread = march.spread.as_ref()?;
    let time = milliseconds(&march.limited);
    let parts = spread.parts.iter().map(|(source, part)| {
        let (name, role) = match source {
            ImpactSource::FirstBody => ("first body", Role::First),
            ImpactSource::SecondBody => ("second body", Role::Second),
            ImpactSource::Contact => ("contact", Role::Third),
            _ => ("velocity", Role::Fourth),
        };
        Mark::curve(name, role, &time, part.clone())
    });
    let mut marks: Vec<Mark> = parts.collect();
    let numerical = march.numerical.clone();
    marks.push(Mark::curve("numerical", Role::Fifth, &time, numerical));
    let all = march.limited_errors()?;
    marks.push(Mark::curve("all", Role::Reference, &time, all));
    Some(Figure::new(
        "sources",
        "Contributions to the band of the force",
        vec![Panel::new(("time", "ms"), ("standard error", "N"), marks).with_greyed(apart(march))],
    )
    .with_caption(
        "Standard errors of the force in the band by each source alone; their squares add up. The numerical error is the change with half the time step, combined with the change when parts of the lines of measured bodies are left out.",
    ))
}

fn mobilities(bodies: [&FaceBody; 2], sheet: &ImpactSheet) -> Result<Figure, RodlabError> {
    // three decades, up to the highest line or, without lines, up to 100 periods in the duration,
    // so that each period has ten steps of a thousandth of the duration
    let highest = sheet
        .lines
        .as_ref()
        .map_or(100.0 / sheet.duration.si(), |lines| lines.up_to.si());
    let frequencies: Vec<f64> = (0..LINES)
        .map(|line| highest * 10f64.powf(-3.0 * (1.0 - line as f64 / (LINES - 1) as f64)))
        .collect();
    let (mut magnitudes, mut phases) = (Vec::new(), Vec::new());
    for ((body, name), role) in bodies
        .iter()
        .zip(["first body", "second body"])
        .zip([Role::First, Role::Second])
    {
        let (frequencies, values) = body.curve(&frequencies, &format!("mobility of the {name}"))?;
        let x: Vec<f64> = frequencies.iter().map(|f| 1e-3 * f).collect();
        let magnitude = values.iter().map(|g| g.norm()).collect();
        magnitudes.push(Mark::curve(name, role, &x, magnitude));
        let phase = values.iter().map(|g| g.arg().to_degrees()).collect();
        phases.push(Mark::curve(name, role, &x, phase));
    }
    let panel = |y: Axis, marks| Panel::new(Axis::logarithmic("frequency", "kHz"), y, marks);
    let phase = Axis::linear("phase", "deg").within([-100.0, 100.0]);
    let panels = vec![
        panel(Axis::logarithmic("mobility", "m/(N s)"), magnitudes),
        panel(phase, phases),
    ];
    Ok(
        Figure::new("mobilities", "Mobilities of the impact faces", panels)
            .with_caption("A passive body has a phase between -90 and 90 degrees."),
    )
}

/// Figure of the stick force with its bands, and of the impact force until the faces part.
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
    let mut marks = Vec::new();
    let mut caption =
        "From the Fourier transform on lines. Where the force is negative, the faces would have to pull on each other."
            .to_owned();
    if let Some(bands) = &lines.bands {
        let percent = 100.0 * bands.level;
        for (name, role, band) in [
            ("whole contact", Role::Second, &bands.simultaneous),
            ("at each time", Role::First, &bands.pointwise),
            ("impact force by draws", Role::Third, &bands.contact),
        ] {
            let edges = shown.iter().zip(&time);
            let edges = edges.map(|(n, time)| (*time, band.lower[*n], band.upper[*n]));
            marks.push(Mark::band(format!("{name}, {percent:.0} %"), role, edges));
        }
        if let impulse::ContactEnd::Separated { time } = lines.impact.end {
            marks.push(Mark::at("the faces part", 1e3 * time));
        }
        caption.push_str(
            " The bands are those of the random errors of mobilities, scales, velocity and masses.",
        );
    }
    let stick = of(history.force());
    marks.push(Mark::curve("stick force", Role::First, &time, stick));
    if lines.bands.is_some() {
        let (name, force) = ("until the faces part", of(lines.impact.history.force()));
        marks.push(Mark::curve(name, Role::Reference, &time, force));
    }
    let panel = Panel::new(("time", "ms"), ("force", "N"), marks);
    Figure::new("stick_force", "Stick force on lines", vec![panel]).with_caption(caption)
}
