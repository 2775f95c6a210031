//! One figure per material: measured and simulated responses of the four tests, with their
//! residuals.

use rodfigure::{Mark, Panel, Role};

use super::super::drawn;
use super::materials::Material;

/// Returns the figure as a file.
pub(crate) fn of(material: &Material, impact_velocity: f64) -> (String, String) {
    let (mut responses, mut residuals) = (Vec::new(), Vec::new());
    for (index, history) in material.histories.iter().enumerate() {
        let role = Role::of_series(index);
        let time = history.times.iter().map(|time| 1e3 * time);
        let over_time = |values: &[f64]| time.clone().zip(values.to_vec());
        let pairs = history.simulated.iter().zip(&history.measured);
        let left = pairs.map(|(simulated, measured)| 100.0 * (simulated - measured));
        let left: Vec<f64> = left.map(|left| left / impact_velocity).collect();
        responses.extend([
            Mark::points("", role, over_time(&history.measured)),
            Mark::line(&history.name, role, over_time(&history.simulated)),
        ]);
        residuals.push(Mark::points(&history.name, role, over_time(&left)));
    }
    let time = ("time from the first sample", "ms");
    let panels = vec![
        Panel::new(time, ("velocity of the free end", "m/s"), responses),
        Panel::new(time, ("simulated - measured", "% of V0"), residuals),
    ];
    let title = format!(
        "{}: virtual measurements (points) and the identified law (lines)",
        material.material
    );
    let name = material.material.to_lowercase().replace(' ', "-");
    drawn(&name, &title, panels)
}
