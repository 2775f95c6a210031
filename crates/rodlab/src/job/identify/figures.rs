//! Figures and tables of an identification: responses, residuals, profiles.

use maxwellid::RodModel;
use maxwellid::selection::Comparison;
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::Found;
use super::laws::FittedLaw;
use super::words::Shown;
use crate::outcome::Table;

/// Rise of chi-square at the ends of a 95 % interval.
const AT_95_PER_CENT: f64 = 3.84;

pub(super) fn all(found: &Found) -> Vec<Figure> {
    let mut figures = vec![responses(found), residuals(found)];
    if !found.profiles.is_empty() {
        figures.push(profiles(found));
    }
    figures
}

/// Returns the law named by the comparison, if it was fitted; otherwise the law with the nearest
/// response.
fn best(found: &Found) -> Option<&FittedLaw> {
    let named = found.comparison.as_ref().and_then(Comparison::law);
    let laws = || found.laws.iter();
    named
        .and_then(|named| laws().find(|law| Some(law.law) == named.law))
        .or_else(|| nearest(found))
}

fn nearest(found: &Found) -> Option<&FittedLaw> {
    found
        .laws
        .iter()
        .min_by(|a, b| a.relative_error.total_cmp(&b.relative_error))
}

fn milliseconds(times: &[f64]) -> Vec<f64> {
    times.iter().map(|time| 1e3 * time).collect()
}

fn responses(found: &Found) -> Figure {
    let best = best(found);
    let panels = found
        .tests
        .iter()
        .enumerate()
        .map(|(number, test)| {
            let time = milliseconds(&test.times());
            let measured = test.response().to_vec();
            let mut marks = vec![Mark::curve(
                "free end, measured",
                Role::First,
                &time,
                measured,
            )];
            if let Some((law, simulated)) =
                best.and_then(|law| Some((law, law.simulated(found, number)?)))
            {
                let name = format!("simulated, {}", law.law.name());
                marks.push(Mark::curve(name, Role::Second, &time, simulated));
            }
            let velocity = (format!("velocity, {}", test.name()), "m/s");
            Panel::new(("time", "ms"), velocity, marks)
        })
        .collect();
    Figure::new("responses", "Velocity of the free end", panels).with_caption(
        "The measured response, and the response simulated from the measured excitation with the law that the data support or, if there is none, with the law whose response differs least.",
    )
}

fn residuals(found: &Found) -> Figure {
    let panels = found
        .tests
        .iter()
        .enumerate()
        .map(|(number, test)| {
            let time = milliseconds(&test.times());
            let marks = found
                .laws
                .iter()
                .enumerate()
                .filter_map(|(index, law)| {
                    let residual = law.residuals.get(number)?;
                    let points = time.iter().copied().zip(residual.iter().map(|r| 100.0 * r));
                    Some(Mark::line(law.law.name(), Role::of_series(index), points))
                })
                .collect();
            let residual = (format!("residual, {}", test.name()), "% of impact velocity");
            Panel::new(("time", "ms"), residual, marks)
        })
        .collect();
    Figure::new("residuals", "Simulated minus measured response", panels)
        .with_caption("The residual should look like the noise before the wave arrives.")
}

fn profiles(found: &Found) -> Figure {
    let panels = found
        .profiles
        .iter()
        .map(|profile| {
            let shown = Shown::of(profile);
            let mut curve = profile.smooth_curve();
            if let (Some(lower), Some(upper)) = (profile.lower, profile.upper) {
                // if the interval has both ends, the curve is shown up to half of its width beyond
                // each end
                let beyond = 0.5 * (upper - lower);
                curve.retain(|(at, _)| (lower - beyond..=upper + beyond).contains(at));
            }
            let points = curve.into_iter().map(|(at, rise)| (shown.value(at), rise));
            let points: Vec<(f64, f64)> = points.collect();
            let ends = [points.first(), points.last()];
            let level = ends.map(|end| (end.map_or(f64::NAN, |(x, _)| *x), AT_95_PER_CENT));
            let interval = [profile.lower, profile.upper].into_iter().flatten();
            let interval = interval.map(|end| Mark::at("end of the interval", shown.value(end)));
            let mut marks = vec![
                Mark::line("profile", Role::First, points),
                Mark::line("95 %", Role::Reference, level),
                Mark::at("minimum", shown.value(profile.value)),
            ];
            marks.extend(interval);
            let rise = Axis::linear("rise of chi-square", "").within([0.0, 12.0]);
            Panel::new((shown.name.as_str(), shown.unit.as_str()), rise, marks)
        })
        .collect();
    Figure::new("profiles", "Profile likelihoods", panels)
        .with_caption("Values where the curve is above the line are excluded at 95 %.")
}

/// Returns the tables with the histories and residuals of each test.
pub(super) fn tables(found: &Found) -> Vec<Table> {
    let of_test = |(number, test): (usize, &maxwellid::RodTest)| {
        let title = format!("Responses of test {}", test.name());
        let mut table = Table::new(format!("response-{}", number + 1), title)
            .numbers("time", "s", test.times())
            .numbers("measured response", "m/s", test.response());
        for law in &found.laws {
            if let Some(simulated) = law.simulated(found, number) {
                let name = format!("simulated response, {}", law.law.name());
                table = table.numbers(name, "m/s", simulated);
            }
        }
        table
    };
    found.tests.iter().enumerate().map(of_test).collect()
}

impl FittedLaw {
    /// Returns the simulated response of a test \[m/s\].
    fn simulated(&self, found: &Found, number: usize) -> Option<Vec<f64>> {
        let test = found.tests.get(number)?;
        let velocity = found.impact_velocities.get(number)?;
        let residual = self.residuals.get(number)?;
        let measured = test.response().iter();
        Some(
            measured
                .zip(residual)
                .map(|(v, r)| v + velocity * r)
                .collect(),
        )
    }
}
