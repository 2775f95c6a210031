//! Figures 2 and 4.

use num_complex::Complex64;
use rodfigure::{Mark, Panel, Role};

use super::super::{Error, drawn};
use super::estimates::{Line, Series};
use super::rig::{GAUGE_DISTANCE, Mounting, positions, strains};
use testbed::papers::paper_b::PaperB;

/// Draws Figure 2 over the band of the paper: the strain ratios depend on the ends of the bar,
/// whereas Ψ is the same in every structure.
pub(crate) fn phasors(paper: &PaperB) -> Result<(String, String), Error> {
    let positions = positions(paper, GAUGE_DISTANCE);
    // lines close enough to show the loops at the nodes of the middle gauge as smooth curves
    let frequency_hz: Vec<f64> = (0..=2000_u32)
        .map(|j| paper.lowest_hz + (paper.highest_hz - paper.lowest_hz) * f64::from(j) / 2000.0)
        .collect();
    let mut panels = Vec::new();
    for mounting in [Mounting::StructureI, Mounting::StructureII] {
        let strain = strains(paper, mounting, &positions, &frequency_hz)?;
        let curve = |name: &str, role, of: &dyn Fn(usize) -> Complex64| {
            let ratios = (0..frequency_hz.len()).map(|line| of(line) / strain[1][line]);
            Mark::line(name, role, ratios.map(|ratio| (ratio.re, ratio.im)))
        };
        let marks = vec![
            curve("ε1/ε0", Role::First, &|line| strain[0][line]),
            curve("ε2/ε0", Role::Second, &|line| strain[2][line]),
            curve("Ψ", Role::Third, &|line| {
                0.5 * (strain[0][line] + strain[2][line])
            }),
        ];
        let imaginary = format!("imaginary part, {}", mounting.name());
        panels.push(Panel {
            equal_axes: true,
            ..Panel::new(("real part", ""), (imaginary, ""), marks)
        });
    }
    let title = "Paper B, Figure 2: ratios of strains";
    Ok(drawn("figure-2", title, panels))
}

/// Draws Figure 4: points with bars of one standard error, and the curve of the material.
pub(crate) fn moduli(series: &[Series]) -> (String, String) {
    let panel = |label: &str, part: fn(&Line) -> [f64; 3]| {
        let mut marks = Vec::new();
        for (index, one) in series.iter().enumerate() {
            let valid = one.lines.iter().filter(|line| line.valid);
            let points = valid.map(|line| {
                let [value, error, _] = part(line);
                (1e-3 * line.frequency_hz, 1e-9 * value, 1e-9 * error)
            });
            let role = Role::of_series(index);
            marks.push(Mark::points_with_errors(one.way.clone(), role, points));
        }
        if let Some(one) = series.first() {
            let lines = one.lines.iter();
            let exact = lines.map(|line| (1e-3 * line.frequency_hz, 1e-9 * part(line)[2]));
            marks.push(Mark::line("material", Role::Reference, exact));
        }
        Panel::new(("frequency", "kHz"), (label, "GPa"), marks)
    };
    let panels = vec![
        panel("E'", |line| {
            [line.storage_modulus, line.storage_error, line.truth.re]
        }),
        panel("E''", |line| {
            [line.loss_modulus, line.loss_error, line.truth.im]
        }),
    ];
    drawn("figure-4", "Paper B, Figure 4 on virtual tests", panels)
}
