//! Velocities at sections along the rod, which show the propagation of the waves.

use rodfigure::{Figure, Mark, Panel, Role};
use rodwave::inelastic::InelasticLaw;

use super::Struck;
use crate::RodlabError;
use crate::job::JobContext;

/// Number of sections.
pub(super) const COUNT: usize = 9;
/// Number of points drawn per history.
const POINTS: usize = 800;

/// Figure of the histories at sections of the rod struck at the last velocity. Each history is
/// drawn about the position of its section.
pub(super) fn figure<L: InelasticLaw>(
    struck: &Struck<'_, L>,
    context: &JobContext<'_>,
) -> Result<Figure, RodlabError> {
    let length = struck.sheet.length.si();
    let velocity = struck.sheet.velocities.last().map_or(0.0, |v| v.si());
    let mut histories = Vec::with_capacity(COUNT);
    for section in 0..COUNT {
        let from_struck_end = length * section as f64 / (COUNT - 1) as f64;
        // the last section is the free end, whose velocity every test contains
        let distance = (length - from_struck_end).max(struck.cell);
        let history = struck.run(velocity, distance)?;
        let values = if section + 1 == COUNT {
            history.free_end_velocity
        } else {
            history.section_velocity
        };
        histories.push((from_struck_end, history.step, values));
        context.progress.one_more();
        context.check_cancelled()?;
    }
    let peak = histories
        .iter()
        .flat_map(|(_, _, values)| values)
        .fold(0.0_f64, |peak, v| peak.max(v.abs()));
    // the largest peak reaches the base line of the neighbouring section
    let scale = 1e3 * length / (COUNT - 1) as f64 / peak;
    let marks = histories
        .into_iter()
        .map(|(place, step, values)| {
            let stride = values.len().div_ceil(POINTS).max(1);
            let kept = values.iter().enumerate().step_by(stride);
            let points =
                kept.map(|(k, v)| (1e3 * (k as f64 + 0.5) * step, 1e3 * place + scale * v));
            Mark::line("", Role::First, points)
        })
        .collect();
    let distance = ("distance from the struck end", "mm");
    let panel = Panel::new(("time", "ms"), distance, marks);
    Ok(Figure::new("sections", "Velocities along the rod", vec![panel]).with_caption(format!(
        "Velocity of {COUNT} sections of the rod struck at {velocity} m/s, each drawn around its distance from the struck end; {peak:.3} m/s \
         corresponds to the distance between two sections. Time starts at the contact."
    )))
}
