//! Reduction of a long series to its visible points.
//!
//! A history of 65 536 samples, on an axis some hundred pixels wide, is drawn by its extremes: of
//! the samples in one column of pixels, the first, the least, the greatest and the last are kept.
//! No peak is lost, and the curve looks the same. A curve that runs back and forth, as in a Nyquist
//! plot, is reduced to samples a fraction of a pixel apart.
#![allow(
    clippy::indexing_slicing,
    reason = "the lists of a mark are cut to the same length, and all indices are below it"
)]

use super::span::on;
use super::{Axis, Figure, Mark, Panel, Scale};

/// Number of columns of the range shown, and of the whole range of the data for samples outside the
/// range shown. A panel with more than twelve marks has fewer columns, but not fewer than 50.
const COLUMNS: usize = 500;
const FEWEST_COLUMNS: usize = 50;
/// Largest number of samples in a column: the first, the least, the greatest and the last.
const A_COLUMN: usize = 4;
/// Number of samples of all marks of a panel above which it has fewer columns.
const MOST_OF_A_PANEL: usize = 24_000;
/// Largest number of samples of a curve that runs back and forth.
const MOST: usize = 3000;

/// Returns the figure as drawn: long series are reduced to their extremes over 1/500 of the
/// horizontal axis.
///
/// Series of up to 2000 samples are unchanged. A longer series keeps at most four samples and one
/// interruption (NaN) in each of 500 columns of the range shown, and as many outside it. The least
/// and the greatest sample are always kept. On a panel with more than twelve marks, the columns are
/// wider and the unchanged series shorter, in proportion.
#[must_use]
pub fn thinned(figure: &Figure) -> Figure {
    Figure {
        name: figure.name.clone(),
        title: figure.title.clone(),
        caption: figure.caption.clone(),
        panels: figure.panels.iter().map(thinned_panel).collect(),
    }
}

fn thinned_panel(panel: &Panel) -> Panel {
    let mut thinned = panel.clone();
    let columns = MOST_OF_A_PANEL / A_COLUMN / panel.marks.len().max(1);
    let columns = columns.clamp(FEWEST_COLUMNS, COLUMNS);
    for mark in &mut thinned.marks {
        match mark {
            Mark::Line { x, y, .. } => {
                let kept = kept(&panel.x, columns, x, y, y);
                pick([x, y], &kept);
            }
            Mark::Points { x, y, error, .. } if error.is_empty() => {
                let kept = kept(&panel.x, columns, x, y, y);
                pick([x, y], &kept);
            }
            Mark::Points { x, y, error, .. } => {
                // a bar whose length is not finite is not drawn, so that only its point is used
                let end = |sign: f64| -> Vec<f64> {
                    let reach = |(y, error): (&f64, &f64)| {
                        if error.is_finite() {
                            y + sign * error
                        } else {
                            *y
                        }
                    };
                    y.iter().zip(&*error).map(reach).collect()
                };
                let kept = kept(&panel.x, columns, x, &end(-1.0), &end(1.0));
                pick([x, y, error], &kept);
            }
            Mark::Band {
                x, lower, upper, ..
            } => {
                let kept = kept(&panel.x, columns, x, lower, upper);
                pick([x, lower, upper], &kept);
            }
            Mark::At { .. } => {}
        }
    }
    thinned
}

/// Reduces each list of a mark to the samples `kept`.
fn pick<const N: usize>(columns: [&mut Vec<f64>; N], kept: &[usize]) {
    for column in columns {
        *column = kept.iter().map(|&index| column[index]).collect();
    }
}

/// Returns the indices of the samples that are drawn; `low` and `high` differ only for a band or
/// for error bars.
fn kept(axis: &Axis, columns: usize, x: &[f64], low: &[f64], high: &[f64]) -> Vec<usize> {
    let samples = x.len().min(low.len()).min(high.len());
    if samples <= A_COLUMN * columns {
        return (0..samples).collect();
    }
    let (x, low, high) = (&x[..samples], &low[..samples], &high[..samples]);
    let there =
        |index: usize| on(axis, x[index]) && low[index].is_finite() && high[index].is_finite();
    let mut all = [f64::INFINITY, f64::NEG_INFINITY];
    let mut forwards = true;
    for &x in x.iter().filter(|&&x| on(axis, x)) {
        forwards &= x >= all[1];
        all = [all[0].min(x), all[1].max(x)];
    }
    if !forwards {
        return followed(axis, x, low, there);
    }
    let shown = axis
        .range
        .filter(|range| on(axis, range[0]) && range[1] > range[0])
        .unwrap_or(all);
    by_columns(Columns::new(axis, columns, shown, all), x, low, high, there)
}

/// Columns of pixels along an axis: the same number in the range shown, and over the whole range of
/// the data for the parts outside it.
struct Columns {
    logarithmic: bool,
    number: f64,
    shown: [f64; 2],
    all: [f64; 2],
}

impl Columns {
    fn new(axis: &Axis, number: usize, shown: [f64; 2], all: [f64; 2]) -> Self {
        let logarithmic = axis.scale == Scale::Logarithmic;
        let place = |range: [f64; 2]| {
            if logarithmic {
                range.map(f64::log10)
            } else {
                range
            }
        };
        Self {
            logarithmic,
            number: number as f64,
            shown: place(shown),
            all: place(all),
        }
    }

    /// Returns the end of the column that contains `x`.
    fn end(&self, x: f64) -> f64 {
        let place = if self.logarithmic { x.log10() } else { x };
        let within = |range: [f64; 2]| {
            let width = (range[1] - range[0]) / self.number;
            let end = range[0] + (((place - range[0]) / width).floor() + 1.0) * width;
            // rounding must not make a column empty
            if end > place { end } else { place + width }
        };
        let end = if (self.shown[0]..=self.shown[1]).contains(&place) {
            within(self.shown)
        } else if place < self.shown[0] {
            within(self.all).min(self.shown[0])
        } else {
            within(self.all)
        };
        if self.logarithmic {
            10_f64.powf(end)
        } else {
            end
        }
    }
}

/// Returns the first, least, greatest and last sample of each column, and a NaN sample for a gap
/// between two columns.
fn by_columns(
    columns: Columns,
    x: &[f64],
    low: &[f64],
    high: &[f64],
    there: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    let mut gap = None;
    let mut run: Option<[usize; 4]> = None;
    let mut end = f64::NEG_INFINITY;
    let close = |kept: &mut Vec<usize>, mut run: [usize; 4]| {
        run.sort_unstable();
        for index in run {
            if kept.last() != Some(&index) {
                kept.push(index);
            }
        }
    };
    for index in 0..x.len() {
        if !there(index) {
            gap = gap.or(Some(index));
            continue;
        }
        match &mut run {
            Some([_, least, greatest, last]) if x[index] < end => {
                if low[index] < low[*least] {
                    *least = index;
                }
                if high[index] > high[*greatest] {
                    *greatest = index;
                }
                *last = index;
            }
            _ => {
                if let Some(run) = run {
                    close(&mut kept, run);
                    kept.extend(gap);
                }
                run = Some([index; 4]);
                end = columns.end(x[index]);
            }
        }
        // a gap within one column is not visible
        gap = None;
    }
    if let Some(run) = run {
        close(&mut kept, run);
    }
    kept
}

/// Returns samples of a curve that runs back and forth that are a fraction of a column apart, or
/// further apart if too many samples would remain.
fn followed(axis: &Axis, x: &[f64], y: &[f64], there: impl Fn(usize) -> bool) -> Vec<usize> {
    let along: Vec<f64> = if axis.scale == Scale::Logarithmic {
        x.iter().map(|x| x.log10()).collect()
    } else {
        x.to_vec()
    };
    let step = |values: &[f64]| {
        let [least, greatest] = values.iter().filter(|value| value.is_finite()).fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[least, greatest], &value| [least.min(value), greatest.max(value)],
        );
        ((greatest - least) / COLUMNS as f64).max(f64::MIN_POSITIVE)
    };
    let steps = [step(&along), step(y)];
    let mut tolerance = 0.25;
    loop {
        let mut kept: Vec<usize> = Vec::new();
        let mut last: Option<usize> = None;
        let mut gap = None;
        for index in 0..x.len() {
            if !there(index) {
                gap = gap.or(Some(index));
                continue;
            }
            let far = last.is_none_or(|last| {
                let moved = |values: &[f64], step: f64| (values[index] - values[last]).abs() / step;
                moved(&along, steps[0]).max(moved(y, steps[1])) >= tolerance
            });
            if far || gap.is_some() || index + 1 == x.len() {
                if last.is_some() {
                    kept.extend(gap);
                }
                kept.push(index);
                last = Some(index);
            }
            gap = None;
        }
        if kept.len() <= MOST || tolerance > COLUMNS as f64 {
            return kept;
        }
        tolerance *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Role;

    fn line(x: Vec<f64>, y: Vec<f64>, axis: Axis) -> (Vec<f64>, Vec<f64>) {
        first_of(1, x, y, axis)
    }

    /// Returns the first of `n_lines` equal lines as drawn.
    fn first_of(n_lines: usize, x: Vec<f64>, y: Vec<f64>, axis: Axis) -> (Vec<f64>, Vec<f64>) {
        let line = Mark::Line {
            name: String::new(),
            role: Role::First,
            x,
            y,
        };
        let figure = Figure {
            name: "a".into(),
            title: String::new(),
            caption: String::new(),
            panels: vec![Panel {
                x: axis,
                y: Axis::linear("y", ""),
                marks: vec![line; n_lines],
                greyed: vec![],
                equal_axes: false,
            }],
        };
        match thinned(&figure).panels.remove(0).marks.remove(0) {
            Mark::Line { x, y, .. } => (x, y),
            other => panic!("a line became {other:?}"),
        }
    }

    fn time(samples: u32) -> Vec<f64> {
        (0..samples).map(|i| f64::from(i) * 1e-5).collect()
    }

    #[test]
    fn the_one_sample_that_sticks_out_stays_wherever_it_is() {
        for at in [0, 1, 777, 50_000, 99_998, 99_999] {
            let mut y = vec![0.0; 100_000];
            y[at] = -3.0;
            let (x, y) = line(time(100_000), y, Axis::linear("t", "s"));
            assert!(x.len() <= 2000, "{} samples are left of 1e5", x.len());
            let peak = y.iter().position(|&y| y < -2.0).map(|index| x[index]);
            let truth = f64::from(u32::try_from(at).unwrap()) * 1e-5;
            assert!(
                peak.is_some_and(|peak| (peak - truth).abs() < 1e-12),
                "the peak at {truth} s is found at {peak:?}"
            );
        }
    }

    #[test]
    fn forty_lines_share_the_samples_of_a_panel() {
        let y: Vec<f64> = (0..65_536).map(|i| f64::from(i % 7)).collect();
        let (x, y) = first_of(40, time(65_536), y, Axis::linear("t", "s"));
        assert!(40 * x.len() <= MOST_OF_A_PANEL, "{} samples", x.len());
        assert!(y.contains(&0.0) && y.contains(&6.0));
    }

    #[test]
    fn a_short_series_is_untouched() {
        let x = time(2000);
        let y: Vec<f64> = x.iter().map(|x| (1e4 * x).sin()).collect();
        assert_eq!(line(x.clone(), y.clone(), Axis::linear("t", "s")), (x, y));
    }

    #[test]
    fn a_gap_wider_than_a_column_stays_a_gap_and_a_narrower_one_goes() {
        let mut y = vec![1.0; 100_000];
        y[40_000..41_000].fill(f64::NAN);
        y[70_050] = f64::NAN; // columns are 200 samples wide
        let (x, y) = line(time(100_000), y, Axis::linear("t", "s"));
        let gaps: Vec<f64> = (0..y.len())
            .filter(|&i| y[i].is_nan())
            .map(|i| x[i])
            .collect();
        assert_eq!(gaps.len(), 1, "gaps at {gaps:?} s");
        assert!((gaps[0] - 0.4).abs() < 1e-9, "gap at {} s", gaps[0]);
    }

    #[test]
    fn what_is_shown_is_thinned_by_what_is_shown() {
        let y: Vec<f64> = (0..100_000).map(|i| f64::from(i % 7)).collect();
        let axis = Axis::linear("t", "s").within([0.5, 0.502]); // 200 samples
        let (x, _) = line(time(100_000), y, axis);
        let shown = x.iter().filter(|x| (0.5..=0.502).contains(*x)).count();
        assert!(shown >= 200, "{shown} of 201 samples in the range are left");
        assert!(x.len() <= 2300, "{} samples are left in all", x.len());
    }

    #[test]
    fn decades_are_thinned_alike() {
        let x: Vec<f64> = (1..=100_000).map(f64::from).collect();
        let y = vec![0.0; 100_000];
        let (x, _) = line(x, y, Axis::logarithmic("f", "Hz"));
        let in_decade = |from: f64| {
            x.iter()
                .filter(|x| (from..10.0 * from).contains(*x))
                .count()
        };
        assert_eq!(in_decade(1.0), 9, "the nine lines of the first decade");
        // 100 columns per decade, with two samples in each because y is constant
        assert!(
            (190..=202).contains(&in_decade(1e4)),
            "{} samples in the last decade",
            in_decade(1e4)
        );
    }

    #[test]
    fn a_circle_run_through_many_times_stays_a_circle() {
        let angle = |i: u32| f64::from(i) * 1e-2;
        let x: Vec<f64> = (0..100_000).map(|i| angle(i).cos()).collect();
        let y: Vec<f64> = (0..100_000).map(|i| angle(i).sin()).collect();
        let (x, y) = line(x, y, Axis::linear("real part", "Pa"));
        assert!(x.len() <= MOST, "{} samples are left", x.len());
        let off = x.iter().zip(&y).map(|(x, y)| (x.hypot(*y) - 1.0).abs());
        assert!(
            off.fold(0.0, f64::max) < 1e-12,
            "samples are kept, not moved"
        );
    }
}
