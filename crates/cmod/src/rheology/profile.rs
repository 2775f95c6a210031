//! Profile of χ²: range of a parameter when all other parameters are refitted.

use super::data::ModulusData;
use super::least_squares::{Effort, Minimum, minimise};
use super::model::Model;

/// Distance on its scale over which a parameter is varied; for a logarithm it is a factor of 1e21.
/// Beyond this range no law of this module depends on the parameter.
const RANGE: f64 = 50.0;
/// Distances beyond an end at which χ² is evaluated again: after a rise, χ² may fall to a plateau
/// below the threshold.
const BEYOND: [f64; 5] = [0.0, 1.0, 3.0, 9.0, 27.0];
/// Longest step of a walk along the profile.
const LONGEST: f64 = 8.0;
/// Maximum number of plateaus that are followed beyond an end.
const MOST_PLATEAUS: usize = 4;
/// Number of lines on which a search from another region begins: the search is long, and all lines
/// are only needed at its end.
const SOME_LINES: usize = 64;

/// End of the interval on one side of the minimum.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum End {
    /// χ² has risen by the threshold at this coordinate, and stays above the threshold over the
    /// distances that are tried.
    At(f64),
    /// χ² has not risen by the threshold within [`RANGE`].
    Open,
    /// χ² has fallen: the start of the profile was not a global minimum.
    LowerMinimum(Vec<f64>),
}

/// Starting points in other regions, from which a law may reach an equally good fit.
#[derive(Default)]
pub(super) struct Elsewhere {
    starts: Vec<Vec<f64>>,
    /// Selection of the lines of the data, if there are more than twice as many lines as
    /// [`SOME_LINES`].
    some_lines: Option<ModulusData>,
}

impl Elsewhere {
    pub(super) fn new(data: &ModulusData, starts: Vec<Vec<f64>>) -> Self {
        let stride = data.len().div_ceil(SOME_LINES);
        let is_needed = stride > 2 && !starts.is_empty();
        let some_lines = is_needed.then(|| {
            let lines: Vec<usize> = (0..data.len()).step_by(stride).collect();
            data.picked(&lines)
        });
        Self { starts, some_lines }
    }

    /// Returns the minima of χ² found from these coordinates, with the parameter `held` at its
    /// coordinate. If χ² of a minimum is not below `least`, the value may be larger than the true
    /// minimum.
    pub(super) fn minima<M: Model + ?Sized>(
        &self,
        (model, data): (&M, &ModulusData),
        held: Option<(usize, f64)>,
        least: f64,
    ) -> impl Iterator<Item = Minimum> {
        let index = held.map(|(index, _)| index);
        self.starts.iter().filter_map(move |start| {
            let mut start = start.clone();
            if let Some((index, coordinate)) = held
                && let Some(own) = start.get_mut(index)
            {
                *own = coordinate;
            }
            let first = self.some_lines.as_ref();
            let first =
                first.and_then(|lines| minimise(model, lines, &start, index, Effort::Comparison));
            let start = first.map_or(start, |first| first.at);
            minimise(model, data, &start, index, Effort::Below(least))
        })
    }
}

/// Minimum of χ², and the parameter whose profile is followed from this minimum.
pub(super) struct Profile<'a, M: ?Sized> {
    pub(super) model: &'a M,
    pub(super) data: &'a ModulusData,
    pub(super) at: &'a [f64],
    pub(super) chi_squared: f64,
    pub(super) elsewhere: &'a Elsewhere,
    pub(super) index: usize,
    pub(super) threshold: f64,
}

/// Rise of χ², and the coordinates at which it is reached.
type Reached = (f64, Vec<f64>);

#[allow(
    clippy::indexing_slicing,
    reason = "`index` is that of a parameter of the model, and `at` and the minima have one coordinate for each"
)]
impl<M: Model + ?Sized> Profile<'_, M> {
    /// Searches for the end of the interval in the direction of the sign of `first_step`.
    pub(super) fn end(&self, first_step: f64) -> End {
        let mut inside = (0.0, self.at.to_vec());
        let mut step = first_step;
        for _ in 0..MOST_PLATEAUS {
            let (from, outside) = match self.walk(inside, step) {
                Walk::Risen(inside, outside) => (inside, outside),
                Walk::Open => return End::Open,
                Walk::Lower(at) => return End::LowerMinimum(at),
            };
            let far = BEYOND
                .iter()
                .map(|beyond| outside.0 + beyond.copysign(first_step))
                .filter(|coordinate| (coordinate - self.at[self.index]).abs() <= RANGE)
                .filter_map(|coordinate| self.least(coordinate))
                .find(|(rise, _)| *rise <= self.threshold);
            match far {
                None => return End::At(self.between(from, outside)),
                Some((rise, at)) if self.is_lower(rise) => return End::LowerMinimum(at),
                Some(plateau) => {
                    inside = plateau;
                    step = 1.0_f64.copysign(first_step);
                }
            }
        }
        End::Open
    }

    fn is_lower(&self, rise: f64) -> bool {
        rise < -2e-2 * self.threshold
    }

    fn rise(&self, coordinate: f64, start: &[f64]) -> Option<Reached> {
        let mut start = start.to_vec();
        start[self.index] = coordinate;
        let held = Some(self.index);
        minimise(self.model, self.data, &start, held, Effort::Comparison)
            .map(|minimum| (minimum.chi_squared - self.chi_squared, minimum.at))
    }

    /// Returns the least χ² at a coordinate from the other starting points. A value above the
    /// threshold may be larger than the true minimum.
    fn least(&self, coordinate: f64) -> Option<Reached> {
        let problem = (self.model, self.data);
        let held = Some((self.index, coordinate));
        self.elsewhere
            .minima(problem, held, self.chi_squared + self.threshold)
            .map(|minimum| (minimum.chi_squared - self.chi_squared, minimum.at))
            .filter(|(_, at)| self.model.is_in_order(at))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Walks from a point inside the interval until χ² has risen by the threshold. The other
    /// coordinates start from their last values, or are extrapolated by the last step: a valley is
    /// nearly straight in the logarithms.
    fn walk(&self, mut inside: Reached, mut step: f64) -> Walk {
        let mut coordinate = inside.1[self.index];
        let mut before: Option<Vec<f64>> = None;
        loop {
            coordinate += step;
            if (coordinate - self.at[self.index]).abs() > RANGE {
                return Walk::Open;
            }
            let ahead = before.as_ref().and_then(|before| {
                let here = &inside.1;
                let share = step / (here[self.index] - before[self.index]);
                let further = here.iter().zip(before).map(|(h, b)| h + share * (h - b));
                self.rise(coordinate, &further.collect::<Vec<f64>>())
            });
            let follows = ahead
                .as_ref()
                .is_some_and(|(rise, _)| *rise <= self.threshold);
            let reached = if follows {
                ahead
            } else {
                let own = self.rise(coordinate, &inside.1);
                own.into_iter()
                    .chain(ahead)
                    .min_by(|a, b| a.0.total_cmp(&b.0))
            };
            // the range ends where there is no law
            let Some((rise, point)) = reached else {
                return Walk::Risen(inside, (coordinate, f64::INFINITY));
            };
            if self.is_lower(rise) {
                return Walk::Lower(point);
            }
            if rise > self.threshold {
                return Walk::Risen(inside, (coordinate, rise));
            }
            before = Some(inside.1);
            inside = (rise, point);
            step = (1.6 * step).clamp(-LONGEST, LONGEST);
        }
    }

    /// Returns the coordinate at which the rise of χ² reaches the threshold. The rise is nearly
    /// parabolic, so its square root is nearly linear.
    fn between(&self, mut inside: Reached, (mut outside, mut rise_outside): (f64, f64)) -> f64 {
        let threshold = self.threshold;
        for _ in 0..20 {
            let (low, high) = (inside.0.max(0.0).sqrt(), rise_outside.sqrt());
            let share = if high.is_finite() {
                ((threshold.sqrt() - low) / (high - low)).clamp(0.05, 0.95)
            } else {
                0.5
            };
            let here = inside.1[self.index];
            let middle = here + share * (outside - here);
            match self.rise(middle, &inside.1) {
                Some((rise, _)) if rise > threshold => {
                    (outside, rise_outside) = (middle, rise);
                }
                Some(point) => inside = point,
                None => (outside, rise_outside) = (middle, f64::INFINITY),
            }
            let close = (inside.0 - threshold)
                .abs()
                .min((rise_outside - threshold).abs());
            if close < 1e-2 * threshold || (outside - inside.1[self.index]).abs() < 1e-3 {
                break;
            }
        }
        if (rise_outside - threshold).abs() < (threshold - inside.0).abs() {
            outside
        } else {
            inside.1[self.index]
        }
    }
}

enum Walk {
    /// Last point inside the interval, and the coordinate and the rise of the next point outside.
    Risen(Reached, (f64, f64)),
    Open,
    Lower(Vec<f64>),
}
