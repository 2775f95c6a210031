//! Noise of both histories in the residual, and the most likely excitation.
//!
//! The simulated response is the response to the *measured* excitation v_e = u + e, so that the
//! residual S(v_e; θ) - v_r contains the noise of the response and, through the rod, the noise of
//! the excitation. With H = ∂S/∂u, the rod linearised about its motion, the covariance of the
//! residual is C = C_r + H C_e Hᵀ. The factor L of C = L Lᵀ whitens it.
//!
//! Weighting alone leaves a bias: the derivatives ∂S/∂θ are evaluated at v_e and are therefore
//! correlated with the residual. The maximum of the joint likelihood of θ *and* u removes it:
//! linearised about a present estimate û the residual is S(û; θ) + H (v_e - û) - v_r, with the same
//! covariance, and û follows from it as v_e - C_e Hᵀ C⁻¹ (residual), whose error is independent of
//! the residual. Alternating between θ and u is the Gauss-Newton iteration for the joint problem;
//! it also prevents the nonlinear law from acting on the noise. The noise that remains in û would
//! enter the derivatives as if it were a signal, mainly ∂S/∂ln E, which is a derivative in time:
//! the problem is therefore linearised about û after a Wiener filter. The filter has no effect on
//! the residual, which to first order does not depend on the excitation about which it is
//! linearised.
//!
//! Above the highest frequency at which either history contains a signal, the excitation is assumed
//! to be zero: a low-pass filter before H removes the noise of v_e at these frequencies from the
//! residual. Without it, the comparison of laws would depend on how each law filters this noise.
//!
//! If the recorder is part of the model ([`RodTest::with_recorder`]), the excitation before its
//! filter takes the place of the record, the covariance of this excitation given the record takes
//! the place of the noise covariance, and H is followed by the filter.
//!
//! # Approximations
//! H is the derivative at the parameters of a previous stage. If there is a filter, H is computed
//! for some samples of the excitation and interpolated between them. H is recomputed about the
//! present û as long as the parameters change by more than half a standard error: with a fixed H
//! the estimate would depend on the start. A law is linearised over a change of the excitation of
//! the size of its noise. The discretisation error of the solver is treated as white noise of the
//! requested accuracy, so that frequencies at which a differentiator leaves no noise do not have
//! infinite weight.
//!
//! Theory: `docs/theory/identification.md#noise-of-both-histories`.

mod signal_band;
mod spectrum;

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, MatRef, Par, Side};
use rodwave::band_limited::SampledHistory;

use crate::deviation::Deviation;
use crate::model::{DrivenRod, RodModel, delayed, response_of};
use crate::noise::{HistoryNoise, TestNoise};
use crate::recorder::Drive;
use crate::test::RodTest;
use crate::vectors::dot;
use signal_band::SignalBand;
pub(crate) use spectrum::mirrored_spectrum;
use spectrum::wiener_filtered;

/// Largest cell of the grid for the transfer H \[m\]. The error of H multiplies the difference
/// between the measured excitation and the excitation of the linearisation. This difference
/// contains signal as well as noise. For example, with columns at every eighth sample and cells of
/// 8 mm, E of a strongly relaxing rod was too low by half a standard error at any noise level.
const TRANSFER_CELL: f64 = 4e-3;

/// Smallest cell chosen for the transfer \[m\].
const SHORTEST_TRANSFER_CELL: f64 = 0.25e-3;

/// Time step of the grid for the transfer, relative to the time between the points of the
/// excitation. The interpolation of a single point is a pulse of about this length, and a longer
/// step would miss some pulses.
const STEP_OF_POINTS: f64 = 0.6;

/// Returns the cell \[m\] of the grid for the transfer of an excitation with points at `rate_hz`
/// \[Hz\].
fn transfer_cell(test: &RodTest, parameters: &[f64], rate_hz: f64) -> Option<f64> {
    let speed = (parameters.first()?.exp() / test.density).sqrt();
    let of_points = STEP_OF_POINTS * speed / rate_hz;
    Some(of_points.clamp(SHORTEST_TRANSFER_CELL, TRANSFER_CELL))
}

/// Change of the parameters, in standard errors, up to which the transfer from excitation to
/// response is not recomputed.
pub(crate) const TRANSFER_HOLDS: f64 = 0.5;

/// Smallest change of the excitation for which a nonlinear rod is linearised, as a share of V0.
const LEAST_CHANGE: f64 = 1e-4;

/// Distance in samples between the columns that are computed for a nonlinear rod whose recorder is
/// part of the model; the columns between them are interpolated at equal delay.
const STRIDE_BEFORE_FILTER: usize = 2;

/// Path from the response of a driven rod to the samples of a test: direct or, if the recorder is
/// part of the model, through its filter.
struct Seen<'a> {
    drive: Option<&'a Drive>,
    /// Rate of the excitation \[Hz\].
    rate_hz: f64,
    /// Number of samples compared.
    window: usize,
}

impl<'a> Seen<'a> {
    fn of(test: &'a RodTest, is_linear: bool) -> Self {
        let drive = test.drive(is_linear);
        Self {
            drive,
            rate_hz: drive.map_or(test.sampling_rate_hz, |drive| drive.rate_hz),
            window: test.window,
        }
    }

    fn times(&self, test: &RodTest) -> Vec<f64> {
        self.drive
            .map_or_else(|| test.times(), |drive| drive.times(test.window))
    }

    /// Points of the excitation per sample.
    fn every(&self) -> usize {
        self.drive.map_or(1, |drive| drive.seen.every())
    }

    /// First point of the excitation that is not known to be at rest.
    fn first_unknown(&self) -> usize {
        let Some(drive) = self.drive else {
            return 0;
        };
        let covariance = &drive.covariance;
        let mut points = 0..covariance.nrows();
        points
            .find(|point| covariance[(*point, *point)] > 0.0)
            .unwrap_or(0)
    }

    /// Distance in points between the columns that are computed for a nonlinear rod.
    fn stride(&self) -> usize {
        match self.drive {
            Some(drive) => STRIDE_BEFORE_FILTER * drive.seen.every(),
            None => 1,
        }
    }

    /// The history of the response after the filter, at every point of the excitation's grid.
    fn at_points(&self, history: Vec<f64>) -> Vec<f64> {
        let Some(drive) = self.drive else {
            return history;
        };
        let at_points = drive.seen.with_every(1);
        // zero before the rod moves, except for the points from which the filter reaches the motion
        let rest = history.iter().take_while(|v| **v == 0.0).count();
        let rest = rest.saturating_sub(at_points.lead());
        let moving = at_points.of_history(history.get(rest..).unwrap_or_default());
        let mut seen = vec![0.0; rest];
        seen.extend(moving);
        seen
    }
}

/// H of one test: change of v_r at the samples of the window for a unit change of each sample of
/// v_e.
#[derive(Debug, Clone)]
pub(crate) struct Transfer {
    matrix: Mat<f64>,
    /// Frequencies to which the excitation is limited; `None` for all.
    band: Option<SignalBand>,
}

impl Transfer {
    /// Linearises the transfer about an excitation [m/s], a delay and a length, within the
    /// frequencies of the signal. Returns `None` if the model cannot be evaluated.
    pub(crate) fn new<M: RodModel + ?Sized>(
        model: &M,
        parameters: &[f64],
        test: &RodTest,
        about: (&[f64], Deviation),
    ) -> Option<Self> {
        let mut transfer = Self::at_all_frequencies(model, parameters, test, about)?;
        let band = match test.drive(model.is_linear()) {
            // the prior of the excitation already limits its band
            Some(_) => None,
            None => SignalBand::of(test),
        };
        if let Some(band) = &band {
            transfer.matrix = band.applied_before(&transfer.matrix);
        }
        transfer.band = band;
        Some(transfer)
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "the impulse response has an entry for each of its times, and a row of the window is `lead` of them further on at most"
    )]
    fn at_all_frequencies<M: RodModel + ?Sized>(
        model: &M,
        parameters: &[f64],
        test: &RodTest,
        (excitation, deviation): (&[f64], Deviation),
    ) -> Option<Self> {
        let seen = Seen::of(test, model.is_linear());
        let times = delayed(&seen.times(test), deviation.delay);
        // numbers of rows before the filter, and of columns
        let window = times.len();
        let samples = samples_of(excitation, window);
        let cell = transfer_cell(test, parameters, seen.rate_hz)?;
        if model.is_linear() {
            // the columns of H are shifted copies of one column, computed for a sample with half an
            // interpolation kernel before it
            let lead = SampledHistory::HALF_WIDTH;
            let base = vec![0.0; excitation.len() + lead];
            let times: Vec<f64> = (0..window + lead)
                .map(|k| sample_time(k, seen.rate_hz))
                .collect();
            let times = delayed(&times, deviation.delay);
            let mut samples = base;
            *samples.get_mut(lead)? = 1.0;
            let history = SampledHistory::new(&samples, seen.rate_hz).ok()?;
            let rod = DrivenRod {
                sampling_rate_hz: seen.rate_hz,
                samples: &samples,
                excitation: &history,
                ..deviation.of_rod(test.driven_rod(&times, cell))
            };
            let impulse = seen.at_points(response_of(model, &rod, parameters)?);
            let columns = samples_of(excitation, window);
            // the rod is at rest before the impulse
            let matrix = Mat::from_fn(seen.window, columns, |i, j| {
                let since = (i * seen.every() + lead).checked_sub(j);
                since.map_or(0.0, |since| impulse[since])
            });
            return Some(Self { matrix, band: None });
        }
        let history = SampledHistory::new(excitation, seen.rate_hz).ok()?;
        let rod = DrivenRod {
            sampling_rate_hz: seen.rate_hz,
            samples: excitation,
            excitation: &history,
            ..deviation.of_rod(test.driven_rod(&times, cell))
        };
        let stride = seen.stride();
        // the points before the contact are known to be at rest
        let first = seen.first_unknown();
        let places: Vec<usize> = (first..samples).step_by(stride).collect();
        let noise = test.noise.as_ref().map(|noise| &noise.excitation);
        let change = noise.map_or(0.0, HistoryNoise::standard_deviation);
        let change = change.max(LEAST_CHANGE * test.impact_velocity);
        let columns = model.by_samples(&rod, parameters, &places, change)?;
        // interpolation at equal delay commutes with the filter
        let columns = columns.into_iter().map(|column| seen.at_points(column));
        let columns: Vec<Vec<f64>> = columns.collect();
        let every = seen.every();
        let matrix = Mat::from_fn(seen.window, samples, |i, j| match j.checked_sub(first) {
            Some(since) => interpolated_at_equal_delay(&columns, stride, i * every, since),
            None => 0.0,
        });
        Some(Self { matrix, band: None })
    }

    /// H times a history [m/s].
    pub(crate) fn times(&self, history: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.matrix.nrows()];
        for (j, v) in history.iter().take(self.matrix.ncols()).enumerate() {
            if *v != 0.0 {
                let column = self.matrix.col_as_slice(j);
                sum.iter_mut().zip(column).for_each(|(s, h)| *s += h * v);
            }
        }
        sum
    }

    /// Hᵀ times a history of the window.
    fn transposed_times(&self, history: &[f64]) -> Vec<f64> {
        let columns = 0..self.matrix.ncols();
        columns
            .map(|j| dot(self.matrix.col_as_slice(j), history))
            .collect()
    }
}

/// Adds `scale` A Bᵀ to the lower triangle of a symmetric matrix.
fn add_lower(to: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, scale: f64) {
    triangular::matmul(
        to,
        BlockStructure::TriangularLower,
        Accum::Add,
        a,
        BlockStructure::Rectangular,
        b.transpose(),
        BlockStructure::Rectangular,
        scale,
        Par::Seq,
    );
}

fn samples_of(excitation: &[f64], window: usize) -> usize {
    excitation.len().min(window + SampledHistory::HALF_WIDTH)
}

fn sample_time(k: usize, rate_hz: f64) -> f64 {
    k as f64 / rate_hz
}

/// Entry of H in row `i` and `since` points after the first of `columns`, which are those of every
/// `stride`-th point.
fn interpolated_at_equal_delay(columns: &[Vec<f64>], stride: usize, i: usize, since: usize) -> f64 {
    let (before, offset) = (since / stride, since % stride);
    // rows at which the neighbouring columns have the same delay
    let at = |column: usize, row: Option<usize>| {
        let column = columns.get(column)?;
        row.and_then(|row| column.get(row)).copied()
    };
    let first = at(before, i.checked_sub(offset));
    let second = at(before + 1, Some(i + stride - offset));
    match (first, second) {
        (Some(a), Some(_)) if offset == 0 => a,
        (Some(a), Some(b)) => {
            let share = offset as f64 / stride as f64;
            a + share * (b - a)
        }
        (Some(v), None) | (None, Some(v)) => v,
        (None, None) => 0.0,
    }
}

/// Factor of the covariance of the residual of one test, and the excitation about which the model
/// is linearised.
#[derive(Debug, Clone)]
pub(crate) struct Weighting {
    transfer: Transfer,
    /// L of C = L Lᵀ [m/s], rows packed.
    factor: Vec<f64>,
    noise: TestNoise,
    is_linear: bool,
    /// û [m/s]
    pub(crate) estimate: Vec<f64>,
    /// û after the Wiener filter [m/s]; û itself if the recorder is part of the model
    pub(crate) excitation: Vec<f64>,
    pub(crate) history: SampledHistory,
    /// H times the record v_e, or the prior mean of the excitation, minus `excitation` [m/s]
    pub(crate) correction: Vec<f64>,
}

impl Weighting {
    /// Creates the weighting about the excitation `estimate` [m/s]. `floor` [m/s] is the standard
    /// deviation of white noise that represents the error of the solver. `None` if the model
    /// cannot be evaluated or the covariance is not positive definite.
    pub(crate) fn new(
        test: &RodTest,
        (transfer, is_linear): (Transfer, bool),
        floor: f64,
        estimate: Vec<f64>,
    ) -> Option<Self> {
        let noise = test.noise.clone()?;
        let (window, samples) = (transfer.matrix.nrows(), transfer.matrix.ncols());
        let mut covariance = toeplitz(&noise.response, window);
        match (test.drive(is_linear), &noise.excitation) {
            (Some(drive), _) => {
                let first = Seen::of(test, is_linear).first_unknown().min(samples);
                let count = samples - first;
                let moving = transfer.matrix.subcols(first, count);
                let through = moving * drive.covariance.submatrix(first, first, count, count);
                add_lower(&mut covariance, through.as_ref(), moving, 1.0);
            }
            (None, HistoryNoise::White { standard_deviation }) => {
                let variance = standard_deviation * standard_deviation;
                let matrix = transfer.matrix.as_ref();
                add_lower(&mut covariance, matrix, matrix, variance);
            }
            (None, HistoryNoise::Differentiated { .. } | HistoryNoise::Coloured { .. }) => {
                let through = &transfer.matrix * toeplitz(&noise.excitation, samples);
                add_lower(
                    &mut covariance,
                    through.as_ref(),
                    transfer.matrix.as_ref(),
                    1.0,
                );
            }
        }
        for i in 0..window {
            covariance[(i, i)] += floor * floor;
        }
        let factor = covariance.llt(Side::Lower).ok()?;
        let lower = factor.L();
        let packed = (0..window)
            .flat_map(|i| (0..=i).map(move |j| (i, j)))
            .map(|(i, j)| lower[(i, j)])
            .collect();
        let weighting = Self {
            correction: Vec::new(),
            estimate: Vec::new(),
            excitation: Vec::new(),
            history: test.excitation.clone(),
            factor: packed,
            transfer,
            noise,
            is_linear,
        };
        weighting.linearised_about(test, estimate)
    }

    /// Linearises about `excitation` [m/s], which is first Wiener-filtered unless the recorder is
    /// part of the model.
    fn linearised_about(mut self, test: &RodTest, excitation: Vec<f64>) -> Option<Self> {
        if let Some(drive) = test.drive(self.is_linear) {
            // no Wiener filter: with its prior, the excitation has little noise and is at rest
            // before the contact
            let pairs = drive.mean.iter().zip(&excitation);
            let error: Vec<f64> = pairs.map(|(mean, u)| mean - u).collect();
            self.correction = self.transfer.times(&error);
            self.history = SampledHistory::new(&excitation, drive.rate_hz).ok()?;
            self.estimate.clone_from(&excitation);
            self.excitation = excitation;
            return Some(self);
        }
        let excitation = match &self.transfer.band {
            Some(band) => band.of_history(&excitation),
            None => excitation,
        };
        self.excitation = wiener_filtered(&excitation, &self.noise.excitation);
        self.estimate = excitation;
        // the rod is at rest before the record, so that noise in the first sample is a jump, which
        // no grid resolves
        for (k, u) in self.excitation.iter_mut().take(FADE).enumerate() {
            let share = k as f64 / FADE as f64;
            *u *= (0.5 * std::f64::consts::PI * share).sin().powi(2);
        }
        let error: Vec<f64> = test
            .excitation_samples
            .iter()
            .zip(&self.excitation)
            .map(|(measured, u)| measured - u)
            .collect();
        self.correction = self.transfer.times(&error);
        self.history = SampledHistory::new(&self.excitation, test.sampling_rate_hz).ok()?;
        Some(self)
    }

    /// Times \[s\] at which the response of the rod is needed.
    pub(crate) fn times(&self, test: &RodTest) -> Vec<f64> {
        Seen::of(test, self.is_linear).times(test)
    }

    /// The rod of `test` driven by the excitation of this weighting, for the response at `times`
    /// \[s\].
    pub(crate) fn driven_rod<'a>(
        &'a self,
        test: &'a RodTest,
        times: &'a [f64],
        cell: f64,
    ) -> DrivenRod<'a> {
        DrivenRod {
            sampling_rate_hz: Seen::of(test, self.is_linear).rate_hz,
            samples: &self.excitation,
            excitation: &self.history,
            ..test.driven_rod(times, cell)
        }
    }

    /// The samples of a response at [`Self::times`].
    pub(crate) fn seen(&self, test: &RodTest, response: Vec<f64>) -> Vec<f64> {
        match test.drive(self.is_linear) {
            Some(drive) => drive.seen.of_history(&response),
            None => response,
        }
    }

    /// L⁻¹ times a history of the window [m/s], in place: the result is in standard deviations.
    #[allow(
        clippy::indexing_slicing,
        reason = "L is packed: row i has i + 1 entries from i (i + 1)/2 on, with as many rows as the window, and the histories have no more"
    )]
    pub(crate) fn whiten(&self, history: &mut [f64]) {
        let mut start = 0;
        for i in 0..history.len() {
            let row = &self.factor[start..=start + i];
            history[i] = (history[i] - dot(row, &history[..i])) / row[i];
            start += i + 1;
        }
    }

    /// L⁻ᵀ times a history, in place.
    #[allow(
        clippy::indexing_slicing,
        reason = "rows of the packed L as for `whiten`"
    )]
    fn whiten_back(&self, history: &mut [f64]) {
        for i in (0..history.len()).rev() {
            let start = i * (i + 1) / 2;
            let row = &self.factor[start..=start + i];
            history[i] /= row[i];
            let value = history[i];
            for (h, l) in history[..i].iter_mut().zip(row) {
                *h -= l * value;
            }
        }
    }

    /// The most likely excitation, given the white residual of this weighting.
    #[allow(
        clippy::indexing_slicing,
        reason = "`k` and `j` are indices of samples of the transfer, and `covariance` has a lag for each sample"
    )]
    pub(crate) fn cleaned(self, test: &RodTest, white_residual: &[f64]) -> Option<Self> {
        let mut weighted = white_residual.to_vec();
        self.whiten_back(&mut weighted);
        let samples = self.transfer.matrix.ncols();
        let through = self.transfer.transposed_times(&weighted);
        if let Some(drive) = test.drive(self.is_linear) {
            let each = drive.mean.iter().enumerate();
            // the covariance is symmetric
            let error = |k| dot(drive.covariance.col_as_slice(k), &through);
            let excitation = each.map(|(k, mean)| mean - error(k)).collect();
            return self.linearised_about(test, excitation);
        }
        let covariance: Vec<f64> = (0..samples)
            .map(|lag| self.noise.excitation.autocovariance(lag))
            .collect();
        let mut excitation = test.excitation_samples.clone();
        for (k, u) in excitation.iter_mut().take(samples).enumerate() {
            let error: f64 = through
                .iter()
                .enumerate()
                .map(|(j, t)| covariance[k.abs_diff(j)] * t)
                .sum();
            *u -= error;
        }
        self.linearised_about(test, excitation)
    }
}

/// Number of samples over which the excitation of the linearisation is faded in.
const FADE: usize = 8;

#[allow(
    clippy::indexing_slicing,
    reason = "the difference of two indices below `size`, of which the row has as many"
)]
pub(crate) fn toeplitz(noise: &HistoryNoise, size: usize) -> Mat<f64> {
    let row: Vec<f64> = (0..size).map(|lag| noise.autocovariance(lag)).collect();
    Mat::from_fn(size, size, |i, j| row[i.abs_diff(j)])
}
