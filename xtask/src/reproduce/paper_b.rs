//! `cargo xtask reproduce-paper-b`: Table 1, Figures 2 and 4, independence of the ends, and the
//! effect of the gauge distance.
//!
//! The figures are drawn as in (Ödeen 1993, paper B, Figures 2 and 4).

mod branches;
mod estimates;
mod figure;
mod rig;
mod spacing;

use rodwave::digits::significant;
use serde_json::json;

use super::{Error, Reproduction, Table};
use estimates::Series;
use testbed::papers::paper_b::{PaperB, load};

/// Number of computed frequency lines per row of the table of moduli.
const EVERY: usize = 4;

pub(crate) fn reproduce() -> Result<Reproduction, Error> {
    let paper = load()?;
    let branches = branches::all(&paper)?;
    let series = estimates::all(&paper)?;
    let spacings = spacing::all(&paper)?;
    let table_1 = branches::table(&branches);
    let moduli = moduli(&series, EVERY);
    let distances = spacing::table(&spacings);
    Ok(Reproduction {
        title: "Paper B: tables and figures recomputed".into(),
        introduction: format!(
            "S. Ödeen and B. Lundberg, In-situ determination of complex modulus from strain measurements on an impacted structure \
             (Ödeen 1993, paper B).\n\n\
             **All tests are virtual**: the bar, its ends and the number of tests are those of the paper; the material (loss factor 0.07, 2.6 GPa \
             at 1.6 kHz), the gauge distance a = {} mm, the mass of the lump (100 g) and the errors of the instruments ({} % of the \
             largest strain, {} % of the acceleration) are assumed, because the paper does not state them. The layout of Table 1 is lost in print and \
             is restored from eq. 6.\n",
            1e3 * rig::GAUGE_DISTANCE,
            100.0 * rig::STRAIN_NOISE,
            100.0 * rig::ACCELERATION_NOISE,
        ),
        body: format!(
            "## Table 1: the branch of eq. 8 along the measured frequencies\n\n{}\n\
             ## Figure 4: E' and E'' with standard errors, GPa\n\n{}\n\
             ## Distance of the gauges\n\n\
             Standard error of E' in structure I, median over the lines, and the first frequency at which the distance of neighbouring \
             gauges is half a wavelength.\n\n{}",
            table_1.markdown(),
            moduli.markdown(),
            distances.markdown(),
        ),
        conclusion: conclusion(&paper, &series, &spacings),
        summary: json!({
            "command": "cargo xtask reproduce-paper-b",
            "source": "Ödeen 1993, paper B",
            "tests": "virtual: the measured strains were not published",
            "table_1": branches,
            "figure_4": series,
            "gauge_distance": spacings,
        }),
        files: vec![
            ("table-1.csv".into(), table_1.csv()),
            ("figure-4.csv".into(), self::moduli(&series, 1).csv()),
            ("gauge-distance.csv".into(), distances.csv()),
            figure::phasors(&paper)?,
            figure::moduli(&series),
        ],
    })
}

fn moduli(series: &[Series], every: usize) -> Table {
    let mut headings = vec!["frequency, Hz".to_owned(), "E' of the material, GPa".into()];
    headings.push("E'' of the material, GPa".into());
    for one in series {
        headings.push(format!("E', {}", one.way));
        headings.push(format!("E'', {}", one.way));
    }
    let mut table = Table::new(&headings);
    let Some(first) = series.first() else {
        return table;
    };
    for index in (0..first.lines.len()).step_by(every) {
        let line = &first.lines[index];
        let mut cells = vec![
            format!("{:.0}", line.frequency_hz),
            format!("{:.4}", 1e-9 * line.truth.re),
            format!("{:.4}", 1e-9 * line.truth.im),
        ];
        for one in series {
            let found = one
                .lines
                .iter()
                .find(|other| (other.frequency_hz - line.frequency_hz).abs() < 1e-6);
            for part in 0..2 {
                cells.push(found.map_or("-".into(), |line| {
                    let (value, error) = match part {
                        0 => (line.storage_modulus, line.storage_error),
                        _ => (line.loss_modulus, line.loss_error),
                    };
                    let text = format!("{:.4} ± {}", 1e-9 * value, significant(1e-9 * error, 2));
                    if line.valid {
                        text
                    } else {
                        format!("({text})")
                    }
                }));
            }
        }
        table.row(cells);
    }
    table
}

fn conclusion(paper: &PaperB, series: &[Series], spacings: &[spacing::Distance]) -> Vec<String> {
    let mut sentences: Vec<String> = series
        .iter()
        .map(|one| {
            format!(
                "{}: {} of {} lines valid; {:.0} % of their E' and E'' are within one standard error of the material, {:.0} % within two.",
                one.way,
                one.valid,
                one.lines.len(),
                100.0 * one.within_one,
                100.0 * one.within_two,
            )
        })
        .collect();
    if let [one, two, free, accelerations] = series {
        sentences.push(format!(
            "Independence of the ends: the root mean square difference over its standard error is {:.2} between structures I and II, \
             {:.2} between I and the dismounted bar, {:.2} between I and the end accelerations; noise alone gives 1.",
            estimates::difference(one, two),
            estimates::difference(one, free),
            estimates::difference(one, accelerations),
        ));
    }
    if let (Some(near), Some(far)) = (spacings.first(), spacings.last()) {
        sentences.push(format!(
            "A distance of {:.0} mm instead of {:.0} mm divides the error of the modulus by {:.0}, as the paper states for the lower bound; \
             the singular frequency decreases from {:.0} to {:.0} Hz.",
            1e3 * far.distance,
            1e3 * near.distance,
            near.deviation / far.deviation,
            near.singular_hz,
            far.singular_hz,
        ));
    }
    sentences.push(format!(
        "At 3 kHz, the wavelength is {:.0} diameters here; the paper states about {:.0}.",
        rig::polypropylene(paper).map_or(f64::NAN, |medium| {
            std::f64::consts::TAU
                / medium.wave_number(std::f64::consts::TAU * paper.highest_hz)
                / paper.diameter
        }),
        paper.wavelength_over_diameter,
    ));
    sentences.push(
        "Not reproduced: the measured points of Figure 4, which were not published as numbers."
            .into(),
    );
    sentences
}
