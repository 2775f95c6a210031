//! Comparison of the two gauges of a bar while waves pass them in one direction only.

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

use super::bar::Known;
use super::plan::Plan;
use super::record::HopkinsonRecord;
use super::separation::{BarLines, Spectra};
use super::source::{Setup, Side};

/// Ratio of the recorded to the expected strain of the second gauge along x minus 1, lag of the
/// record \[s\], and drift of its level from the silence until a wave returns, relative to the
/// largest expected strain, of each bar; `None` without two gauges.
pub(super) type Differences = [Option<[f64; 3]>; 2];

/// Computes the differences of both bars.
pub(super) fn differences(
    setup: &Setup,
    lines: &[BarLines; 2],
    record: &HopkinsonRecord,
    plan: &Plan,
) -> Differences {
    let of = |bar: usize, lines: &BarLines| {
        let gauges = record.gauges.get(bar)?;
        if gauges.len() < 2 {
            return None;
        }
        let spectra = Spectra {
            plan,
            setup,
            record,
            transform: RealFourier::new(plan.n_transform),
        };
        difference(spectra, bar, lines)
    };
    [of(0, &lines[0]), of(1, &lines[1])]
}

/// Fits $`\varepsilon_b - \varepsilon_e = g\,\varepsilon_e - \tau\,d\varepsilon_e/dt`$ by least
/// squares, with the strain $`\varepsilon_e`$ that is expected from the first gauge. The drift is
/// the coefficient of a third term, a ramp that rises from 0 in the middle of the silence to 1 at
/// the end of this time.
fn difference(mut spectra: Spectra<'_>, bar: usize, lines: &BarLines) -> Option<[f64; 3]> {
    let plan = spectra.plan;
    let window = plan.one_way.get(bar)?.clone();
    let at_rest = 0.5 * spectra.record.silent as f64;
    let [expected, rest] = spectra.one_way(bar, lines)?;
    let falling: Vec<Complex64> = expected
        .iter()
        .enumerate()
        .map(|(line, strain)| Complex64::new(0.0, -plan.omega(line)) * strain)
        .collect();
    let mut history = |lines: &[Complex64]| -> Option<Vec<f64>> {
        spectra.transform.lines().fill(Complex64::ZERO);
        for (to, from) in spectra.transform.lines().iter_mut().zip(lines) {
            *to = *from;
        }
        let samples = spectra.transform.inverse();
        samples.get(window.clone()).map(<[f64]>::to_vec)
    };
    let (expected, falling, rest) = (history(&expected)?, history(&falling)?, history(&rest)?);
    let product =
        |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() };
    let (ee, ff, ef) = (
        product(&expected, &expected),
        product(&falling, &falling),
        product(&expected, &falling),
    );
    let determinant = ee * ff - ef * ef;
    let fit = |samples: &[f64]| -> [f64; 2] {
        let (es, fs) = (product(&expected, samples), product(&falling, samples));
        [
            (ff * es - ef * fs) / determinant,
            (ee * fs - ef * es) / determinant,
        ]
    };
    let [excess, lag] = fit(&rest);
    let ramp: Vec<f64> = window
        .clone()
        .map(|sample| (sample as f64 - at_rest) / (window.end as f64 - at_rest))
        .collect();
    let [of_expected, of_falling] = fit(&ramp);
    // the part of the ramp that neither a ratio nor a lag explains
    let own: Vec<f64> = ramp
        .iter()
        .zip(expected.iter().zip(&falling))
        .map(|(r, (e, f))| r - of_expected * e - of_falling * f)
        .collect();
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let drift = product(&own, &rest) / (product(&own, &own) * largest);
    let found = [excess, lag, drift];
    found.iter().all(|x| x.is_finite()).then_some(found)
}

/// Differences of both bars, with their variances.
#[derive(Debug, Clone)]
pub(super) struct GaugePairs {
    pub(super) found: Differences,
    variances: [[f64; 3]; 2],
}

impl GaugePairs {
    /// Creates differences without errors.
    pub(super) fn new(found: Differences) -> Self {
        Self {
            found,
            variances: [[0.0; 3]; 2],
        }
    }

    /// Adds the squared differences between `a` and `b`, times `weight`, to the variances.
    pub(super) fn add(&mut self, a: &Differences, b: &Differences, weight: f64) {
        for (variances, (a, b)) in self.variances.iter_mut().zip(a.iter().zip(b)) {
            let (Some(a), Some(b)) = (a, b) else {
                continue;
            };
            for (variance, (a, b)) in variances.iter_mut().zip(a.iter().zip(b)) {
                *variance += weight * (a - b).powi(2);
            }
        }
    }

    /// Returns the differences of a bar with their standard errors.
    pub(super) fn of(&self, side: Side) -> Option<[Known; 3]> {
        let [excess, lag, drift] = (*self.found.get(side.index())?)?;
        let [of_ratio, of_lag, of_drift] = *self.variances.get(side.index())?;
        Some([
            Known::within(excess, of_ratio.sqrt()),
            Known::within(lag, of_lag.sqrt()),
            Known::within(drift, of_drift.sqrt()),
        ])
    }
}
