//! Mobilities of the four faces, compared with reference values, with the closed forms exactly as
//! printed, and with their limits at low frequency.

use std::f64::consts::TAU;

use impulse::Impact;
use num_complex::Complex64;
use rodwave::digits::significant;
use serde::Serialize;

use super::super::number::above;
use super::super::{Error, Table, table_of};
use testbed::papers::paper_e::PaperE;
use testbed::papers::paper_e::bodies::Face;

/// Mobilities with eq. 7 in s/kg, in the order of [`Face::ALL`]: an independent computation with 40
/// digits.
#[rustfmt::skip]
const REFERENCE: [(f64, [(f64, f64); 4]); 5] = [
    (100.0, [
        (5.31702952414e-6, -1.4623478043e-3),
        (9.31840260879e-7, -1.49841205652e-3),
        (5.82588165916e-6, -2.00742012736e-3),
        (1.91181467262e-6, -2.03921895148e-3),
    ]),
    (1000.0, [
        (5.70373002497e-5, 3.06064811985e-4),
        (1.01565191904e-5, -6.99280439324e-5),
        (7.91809056486e-5, 3.52231105718e-4),
        (4.60934471297e-5, 5.46301178705e-5),
    ]),
    (2500.0, [
        (2.20833662124e-4, -3.37985844279e-4),
        (3.94183962733e-5, -1.2385051913e-4),
        (2.45834470276e-4, 9.59612500319e-4),
        (1.19138983695e-5, -2.56789489377e-4),
    ]),
    (5000.0, [
        (3.06939503322e-4, 3.14599004025e-4),
        (5.03250036202e-5, 1.91254852944e-5),
        (1.17376788626e-4, -5.48143204229e-4),
        (4.36249800141e-6, -6.95050576031e-5),
    ]),
    (8900.0, [
        (4.50113158686e-4, 1.72090787155e-4),
        (7.26455200693e-5, 9.3924835634e-6),
        (1.53766745325e-3, 1.60264981624e-3),
        (2.98807001438e-6, -1.94545071098e-5),
    ]),
];

/// Frequencies at which a body is nearly rigid, in Hz.
const SLOW: [f64; 4] = [100.0, 1.0, 1e-2, 1e-4];

/// Independently computed forces of the faces, in N: the greatest force of the first contact, for
/// nylon of constant loss, smoothed by a Gaussian of 10 µs.
const REFERENCE_PEAK: [f64; 4] = [2247.0, 2029.0, 1617.0, 2450.0];

/// One face at one frequency.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Line {
    face: &'static str,
    frequency_hz: f64,
    /// Real and imaginary part, in s/kg.
    mobility: [f64; 2],
    /// Relative differences from the reference and from eqs. 8 and 9 exactly as printed.
    pub(crate) at_rounding: [f64; 2],
}

/// One face at low frequency.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Slow {
    face: &'static str,
    /// |iωMG - 1| at the frequencies of [`SLOW`], computed by the chain of transition matrices.
    at_rounding: [f64; 4],
    /// Values from eqs. 8 and 9 exactly as printed.
    #[serde(skip)]
    to_the_letter: [f64; 4],
}

/// Initial response of a face.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Jump {
    face: &'static str,
    /// Force V/(1/|Z_1| + 1/Z_2) in N, with the material of the face at 10 kHz.
    from_impedances: f64,
    /// Force of the first 0.1 µs of the march, in N.
    pub(crate) first_step: f64,
    /// Greatest force in N, smoothed as the reference is.
    pub(crate) rounded_peak: f64,
    pub(crate) reference_peak: f64,
    elastic: bool,
}

impl Jump {
    /// Returns first step over expected force, minus 1, for an elastic face; its impedance does not
    /// depend on frequency.
    pub(crate) fn excess(&self) -> Option<f64> {
        self.elastic
            .then_some(self.first_step / self.from_impedances - 1.0)
    }
}

pub(crate) fn lines(paper: &PaperE) -> Result<Vec<Line>, Error> {
    let mut lines = Vec::new();
    for (index, face) in Face::ALL.into_iter().enumerate() {
        let body = paper.printed(face)?;
        for (frequency_hz, references) in REFERENCE {
            let mobility = body.mobility(TAU * frequency_hz)?;
            let reference = Complex64::new(references[index].0, references[index].1);
            let closed = paper.closed_form(face, TAU * frequency_hz)?;
            lines.push(Line {
                face: face.name(),
                frequency_hz,
                mobility: [mobility.re, mobility.im],
                at_rounding: [reference, closed]
                    .map(|other| (mobility - other).norm() / mobility.norm()),
            });
        }
    }
    Ok(lines)
}

pub(crate) fn slow(paper: &PaperE) -> Result<Vec<Slow>, Error> {
    Face::ALL
        .into_iter()
        .map(|face| {
            let body = paper.printed(face)?;
            let mass = paper.mass(face)?;
            let from_rigid = |frequency_hz: f64, mobility: Complex64| {
                (Complex64::new(0.0, TAU * frequency_hz * mass) * mobility - 1.0).norm()
            };
            let mut slow = Slow {
                face: face.name(),
                at_rounding: [0.0; 4],
                to_the_letter: [0.0; 4],
            };
            for (index, f) in SLOW.into_iter().enumerate() {
                slow.at_rounding[index] = from_rigid(f, body.mobility(TAU * f)?);
                slow.to_the_letter[index] = from_rigid(f, paper.closed_form(face, TAU * f)?);
            }
            Ok(slow)
        })
        .collect()
}

pub(crate) fn jumps(paper: &PaperE) -> Result<Vec<Jump>, Error> {
    let rod = paper.long_rod()?;
    Face::ALL
        .into_iter()
        .zip(REFERENCE_PEAK)
        .map(|(face, reference_peak)| {
            let velocity = paper.case(face)?.impact_velocity;
            let impedances = [paper.front_impedance(face)?, paper.rod_impedance()?];
            let body = paper.causal(face)?;
            let impact = Impact::between(&body, &rod).at_velocity(velocity);
            let first = impact.clone().in_steps_of(1e-7).predict(1e-4)?;
            Ok(Jump {
                face: face.name(),
                from_impedances: velocity / (1.0 / impedances[0] + 1.0 / impedances[1]),
                first_step: first.history.force().first().copied().unwrap_or(f64::NAN),
                // 2.5 intervals of 4 µs are the 10 µs of the Gaussian
                rounded_peak: impact.stick_force_damped(2e-3, 4e-6)?.peak().force,
                reference_peak,
                elastic: face.is_elastic(),
            })
        })
        .collect()
}

pub(crate) fn table(lines: &[Line]) -> Table {
    table_of!(lines, |line|
        "face" => line.face,
        "frequency, Hz" => format!("{:.0}", line.frequency_hz),
        "Re G, s/kg" => format!("{:.10e}", line.mobility[0]),
        "Im G, s/kg" => format!("{:.10e}", line.mobility[1]),
        "from the reference" => above(line.at_rounding[0], 1e-11),
        "from eqs. 8, 9" => above(line.at_rounding[1], 1e-11),
    )
}

pub(crate) fn slow_table(rows: &[Slow]) -> Table {
    let mut headings = vec!["face".to_owned(), "by".into()];
    headings.extend(SLOW.map(|f| format!("{f} Hz")));
    let mut table = Table::new(&headings);
    for row in rows {
        for (way, values) in [
            ("chain", row.at_rounding),
            ("eqs. 8, 9 as printed", row.to_the_letter),
        ] {
            let mut cells = vec![row.face.to_owned(), way.into()];
            cells.extend(values.map(|value| format!("{value:.1e}")));
            table.row(cells);
        }
    }
    table
}

pub(crate) fn jump_table(rows: &[Jump]) -> Table {
    table_of!(rows, |row|
        "face" => row.face,
        "V/(1/Z_1 + 1/Z_2), N" => format!("{:.1}", row.from_impedances),
        "first 0.1 µs, N" => format!("{:.1}", row.first_step),
        "greatest force, smoothed, N" => format!("{:.1}", row.rounded_peak),
        "reference, N" => format!("{:.0}", row.reference_peak),
    )
}

/// Describes the limits in words.
pub(crate) fn conclusion(lines: &[Line], slow: &[Slow], jumps: &[Jump]) -> Vec<String> {
    let worst = |index: usize| {
        lines
            .iter()
            .map(|line| line.at_rounding[index])
            .fold(0.0, f64::max)
    };
    let mut sentences = vec![format!(
        "Mobilities: the four faces agree with the reference, computed with 40 digits, to {:.0e}, the accuracy of its printed digits, and with eqs. 8 and 9 as \
         printed to {:.0e}.",
        worst(0),
        worst(1)
    )];
    if let Some(cone) = slow.iter().find(|row| row.face == Face::ConeA.name()) {
        sentences.push(format!(
            "Low frequency: by the chain, iωMG is 1 to {:.0e} at 0.01 Hz. In eq. 8 as printed, the differences of coth cancel: \
             the relative error of face A of the cone is {} at 0.01 Hz and {} at 0.0001 Hz; on the lines of the paper, from 8.7 Hz on, it is negligible.",
            slow.iter().map(|row| row.at_rounding[2]).fold(0.0, f64::max),
            significant(cone.to_the_letter[2], 1),
            significant(cone.to_the_letter[3], 1),
        ));
    }
    let aluminium = jumps.iter().find_map(Jump::excess);
    let rounded = jumps
        .iter()
        .map(|jump| (jump.rounded_peak / jump.reference_peak - 1.0).abs())
        .fold(0.0, f64::max);
    if let Some(excess) = aluminium {
        sentences.push(format!(
            "First jump: for the aluminium face it is V/(1/Z_1 + 1/Z_2) to {excess:.0e}; the impedance of nylon increases with frequency, and its \
             initial force is therefore larger. Smoothed by 10 µs, the greatest forces agree with those of the independent computation to {} %.",
            significant(100.0 * rounded, 1)
        ));
    }
    sentences
}
