//! The excitation of a rod before the filter of its recorder.
//!
//! # Problem
//! The record of the excitation u is v_e = G u + e, where G filters and samples u, and e is noise.
//! A nonlinear rod must be driven by u, because its dissipation depends on the full stress of a
//! front, which G reduces.
//!
//! # Method
//! The excitation u is estimated on a grid of [`FINER`] points per sample, with a normal prior: u
//! is zero until the contact begins, then a step of unknown height plus the integral of a white
//! noise, both smoothed by a contact of time constant τ,
//!
//! ```text
//! u = B w ,    B(t) = 1 - e^{-t/τ} ,    var w = D = q I + h² (1 0.8; 0.8 1) at the first two points .
//! ```
//!
//! The prior assumes one impact and bounded forces, but no particular striker or pulse shape. Given
//! the record, u is normally distributed with
//!
//! ```text
//! mean u₁ = Σ Gᵀ K⁻¹ v_e ,    covariance P = Σ - Σ Gᵀ K⁻¹ G Σ ,    Σ = B D Bᵀ ,  K = G Σ Gᵀ + C_e .
//! ```
//!
//! C_e is the covariance of e, and h the largest value of the record. The contact begins between
//! two points of the grid; the step heights at these points have a correlation of 0.8. The onset of
//! the contact, τ and q maximise the likelihood of the record about its front, ln N(v_e; 0, K); the
//! mean and covariance used are those of the mixture over all likely onsets and τ, weighted by
//! their likelihoods. Where the record changes more abruptly than q permits, as at waves that
//! return from the free end and at the end of the contact, q is increased. The response of a law is
//! computed for the excitation u, then filtered and sampled by the same G. The covariance of the
//! residual contains P, which represents the noise of the record and the unresolved part of the
//! front (see [`crate::whitening`]).
//!
//! A linear rod commutes with the filter. It is driven by the filtered excitation at twice the
//! sampling rate, and its response is not filtered again.
//!
//! # Validity
//! Both histories must have passed the same filter. Above the cut-off of the filter the prior alone
//! determines the shape of a front; the standard error of the excitation includes this uncertainty.
//!
//! Theory: `docs/theory/identification.md#the-recorder-as-part-of-the-model`.

use std::fmt;
use std::sync::Arc;

use faer::Mat;
use rodwave::band_limited::SampledHistory;

use crate::error::MaxwellidError;
use crate::model::{DrivenRod, RodModel, delayed, response_of};
use crate::noise::HistoryNoise;
use crate::recorder::contact::{Contact, mixed, mixed_mean};
use crate::recorder::filter::{Observation, RecorderFilter};
use crate::recorder::front::Front;
use crate::recorder::later_fronts::LaterFronts;
use crate::test::{RodTest, half_rise};
use crate::whitening::{mirrored_spectrum, toeplitz};

/// Points of the grid of the excitation per sample of the record. With eight points instead, the
/// estimates for a Norton rod change by less than a twentieth of their standard errors.
const FINER: usize = 4;

/// Number of points of a still finer grid for each point of the fine grid. The difference of the
/// responses on the two grids shows the error of the coarser one.
const STILL_FINER: usize = 4;

/// Points per sample of the excitation of a linear rod, which resolve all frequencies that the
/// filter passes.
const OF_LINEAR_ROD: usize = 2;

/// Largest number of samples of a record whose recorder is part of the model.
pub const LONGEST_RECORD: usize = 750;

/// Largest number of points of the grid: their covariance takes 70 MB.
const MOST_POINTS: usize = LONGEST_RECORD * FINER;

/// Standard deviation of white noise that represents the errors of the grid and of the
/// interpolation, relative to the largest sample; without it, the covariance of a record without
/// noise would be singular.
const ROUNDING: f64 = 1e-4;

/// The excitation of a test before the filter of its recorder, as the record and the prior
/// determine it.
#[derive(Debug, Clone)]
pub struct UnfilteredExcitation {
    filter: RecorderFilter,
    contact: Contact<'static>,
    /// Drive of a nonlinear rod, the excitation u.
    drive: Drive,
    /// Drive of a linear rod, the filtered excitation.
    of_linear_rod: Drive,
    finer: FinerFront,
}

/// The excitation on its grid and on a still finer one. The change of the response of a nonlinear
/// rod between the two shows the effect of a front that begins between two points.
#[derive(Debug, Clone)]
pub(crate) struct FinerFront {
    coarse: OnGrid,
    fine: OnGrid,
}

/// The most likely excitation on one grid, given its record alone.
#[derive(Debug, Clone)]
struct OnGrid {
    /// Points per second \[Hz\].
    rate_hz: f64,
    /// Velocity at the points [m/s].
    mean: Vec<f64>,
    history: SampledHistory,
    /// Filter and sampler of the response.
    seen: Observation,
}

/// An excitation that is known with a covariance, and the filter and sampler of the response to it.
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    /// Points per second \[Hz\].
    pub(crate) rate_hz: f64,
    /// Most likely excitation, given its record alone [m/s].
    pub(crate) mean: Vec<f64>,
    /// Covariance of the excitation, given its record alone [m²/s²].
    pub(crate) covariance: Mat<f64>,
    /// Filter and sampler of the response.
    pub(crate) seen: Observation,
}

impl Drive {
    /// Times \[s\] at which the response is needed to compute `samples` filtered samples.
    pub(crate) fn times(&self, samples: usize) -> Vec<f64> {
        (0..self.seen.points(samples))
            .map(|point| point as f64 / self.rate_hz)
            .collect()
    }
}

impl UnfilteredExcitation {
    /// Estimates the excitation of `test` from its `record` with `noise`. The record has the
    /// sampling rate `rate_hz` \[Hz\] and reaches half of the first rise at sample `half_rise`.
    /// `seen` is the filter at [`FINER`] points per sample or a multiple.
    pub(crate) fn of(
        test: &str,
        record: &[f64],
        (noise, rate_hz, half_rise): (&HistoryNoise, f64, f64),
        (filter, [seen, finer]): (&RecorderFilter, [Observation; 2]),
    ) -> Result<Self, MaxwellidError> {
        let points = seen.points(record.len());
        if points > MOST_POINTS {
            return Err(MaxwellidError::RecordTooLong {
                test: test.to_owned(),
                found: record.len(),
                expected: MOST_POINTS / seen.every(),
            });
        }
        let unlikely = || MaxwellidError::NoUnfilteredExcitation {
            test: test.to_owned(),
        };
        let largest = record.iter().fold(0.0_f64, |top, v| top.max(v.abs()));
        let covariance_of_noise = with_rounding(toeplitz(noise, record.len()), largest);
        let front =
            Front::of(record, &covariance_of_noise, half_rise, &seen).ok_or_else(unlikely)?;
        let contact = front.contact(largest).ok_or_else(unlikely)?;
        let given = |contact: &Contact<'_>, first: usize| {
            contact.given(record, &covariance_of_noise, (points, first), &seen)
        };
        let later =
            LaterFronts::of(record, &covariance_of_noise, contact, &seen).ok_or_else(unlikely)?;
        let factors = later.at_points(points, &seen);
        let likely = with_factors(front.likely(contact), &factors);
        let (mean, covariance) = mixed(&likely, points, given).ok_or_else(unlikely)?;
        let finer = FinerFront::of(
            record,
            (&covariance_of_noise, half_rise, &later),
            (&likely, &mean),
            (rate_hz, [&seen, &finer]),
        )
        .ok_or_else(unlikely)?;
        let fine_rate = rate_hz * seen.every() as f64;
        let of_linear = seen.with_every(seen.every() / OF_LINEAR_ROD);
        let of_linear_rod = Drive {
            rate_hz: rate_hz * OF_LINEAR_ROD as f64,
            mean: of_linear.of_history(&mean),
            covariance: of_linear.of_covariance(&covariance),
            seen: Observation::direct(OF_LINEAR_ROD),
        };
        Ok(Self {
            filter: filter.clone(),
            contact,
            drive: Drive {
                rate_hz: fine_rate,
                mean,
                covariance,
                seen,
            },
            of_linear_rod,
            finer,
        })
    }

    pub(crate) fn drive(&self, is_linear: bool) -> &Drive {
        if is_linear {
            &self.of_linear_rod
        } else {
            &self.drive
        }
    }

    /// Filter and sampler of the response of a nonlinear rod, for the grid of the excitation and
    /// for the still finer one.
    pub(crate) fn observations(&self) -> [&Observation; 2] {
        [&self.finer.coarse.seen, &self.finer.fine.seen]
    }

    /// The filter of the recorder.
    #[must_use]
    pub fn filter(&self) -> &RecorderFilter {
        &self.filter
    }

    /// Number of grid points per second \[Hz\].
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.drive.rate_hz
    }

    /// Most likely velocity [m/s], given the record alone; the first point is at the time of the
    /// first sample.
    #[must_use]
    pub fn velocity(&self) -> &[f64] {
        &self.drive.mean
    }

    /// Standard error of each point [m/s].
    #[must_use]
    pub fn standard_error(&self) -> Vec<f64> {
        let covariance = &self.drive.covariance;
        (0..covariance.nrows())
            .map(|k| covariance[(k, k)].max(0.0).sqrt())
            .collect()
    }

    /// Onset of the contact in the prior \[s\], from the first sample.
    #[must_use]
    pub fn begin(&self) -> f64 {
        self.contact.begin as f64 / self.drive.rate_hz
    }

    /// Share of the estimated excitation above the cut-off of the recorder, as the ratio of the
    /// root mean squares. The filter removed most of this part, so that it depends on the prior.
    #[must_use]
    pub fn share_above_cutoff(&self) -> f64 {
        let silence = HistoryNoise::White {
            standard_deviation: 0.0,
        };
        let lines = mirrored_spectrum(&self.drive.mean, &silence);
        let spacing = 0.5 * self.drive.rate_hz / lines.len().saturating_sub(1).max(1) as f64;
        let power = |from: f64| -> f64 {
            let each = lines.iter().enumerate();
            each.filter(|(line, _)| *line as f64 * spacing >= from)
                .map(|(_, (power, _))| power)
                .sum()
        };
        let all = power(0.0);
        if all > 0.0 {
            (power(self.filter.cutoff_hz()) / all).sqrt()
        } else {
            0.0
        }
    }
}

/// Formats the assumptions and the contribution of the prior in one sentence.
impl fmt::Display for UnfilteredExcitation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the recorder is part of the model: {}. {:.1} % of the excitation (root mean square) is above its cut-off. This part follows from the \
             model of the contact, which begins at {:.3} ms",
            self.filter.name(),
            100.0 * self.share_above_cutoff(),
            1e3 * self.begin()
        )
    }
}

impl FinerFront {
    /// Estimates the excitation of a `record` on the finer grid; `likely` and `mean` are its
    /// contacts and its excitation on the coarser grid.
    fn of(
        record: &[f64],
        (noise, half_rise, later): (&Mat<f64>, f64, &LaterFronts),
        (likely, mean): (&[(f64, Contact<'_>)], &[f64]),
        (rate_hz, [coarse, fine]): (f64, [&Observation; 2]),
    ) -> Option<Self> {
        let points = fine.points(record.len());
        let front = Front::of(record, noise, half_rise, fine)?;
        let factors = later.at_points(points, fine);
        let likely = with_factors(front.likely_on_finer_grid(likely, STILL_FINER)?, &factors);
        let contacts = likely.iter();
        let means = contacts.map(|(_, contact)| contact.mean_given(record, noise, points, fine));
        let of_fine = mixed_mean(&likely, &means.collect::<Option<Vec<_>>>()?);
        Some(Self {
            coarse: OnGrid::of(mean.to_vec(), rate_hz, coarse)?,
            fine: OnGrid::of(of_fine, rate_hz, fine)?,
        })
    }

    /// Filtered response of `rod` in the window of a test, delayed by `delay` \[s\]: that on the
    /// finer grid minus that on the coarser one [m/s]; `None` if the model does not exist.
    pub(crate) fn difference<M: RodModel + ?Sized>(
        &self,
        model: (&M, &[f64]),
        rod: (&DrivenRod<'_>, usize),
        delay: f64,
    ) -> Option<Vec<f64>> {
        let fine = self.fine.response(model, rod, delay)?;
        let coarse = self.coarse.response(model, rod, delay)?;
        Some(fine.iter().zip(coarse).map(|(f, c)| f - c).collect())
    }
}

impl OnGrid {
    /// Creates the excitation `mean` on the grid of `seen`, for a record sampled at `rate_hz`.
    fn of(mean: Vec<f64>, rate_hz: f64, seen: &Observation) -> Option<Self> {
        let rate_hz = rate_hz * seen.every() as f64;
        Some(Self {
            rate_hz,
            history: SampledHistory::new(&mean, rate_hz).ok()?,
            mean,
            seen: seen.clone(),
        })
    }

    /// The first `samples` samples of the filtered response of `rod` [m/s], delayed by `delay`
    /// \[s\].
    fn response<M: RodModel + ?Sized>(
        &self,
        (model, parameters): (&M, &[f64]),
        (rod, samples): (&DrivenRod<'_>, usize),
        delay: f64,
    ) -> Option<Vec<f64>> {
        let points = 0..self.seen.points(samples);
        let times: Vec<f64> = points.map(|point| point as f64 / self.rate_hz).collect();
        let rod = DrivenRod {
            sampling_rate_hz: self.rate_hz,
            samples: &self.mean,
            excitation: &self.history,
            times: &delayed(&times, delay),
            ..*rod
        };
        Some(self.seen.of_history(&response_of(model, &rod, parameters)?))
    }
}

/// Sets the factors of q at the points of the grid in all `likely` contacts.
fn with_factors<'a>(
    likely: Vec<(f64, Contact<'static>)>,
    factors: &'a [f64],
) -> Vec<(f64, Contact<'a>)> {
    let each = likely.into_iter();
    each.map(|(weight, contact)| (weight, contact.with_factors(factors)))
        .collect()
}

fn with_rounding(noise: Mat<f64>, largest: f64) -> Mat<f64> {
    let floor = (ROUNDING * largest).powi(2);
    Mat::from_fn(noise.nrows(), noise.ncols(), |i, j| {
        noise[(i, j)] + if i == j { floor } else { 0.0 }
    })
}

impl RodTest {
    /// Makes the filter of the recorder a part of the model: a nonlinear rod is driven by the
    /// excitation before the filter, and its response is filtered before it is compared. A linear
    /// rod is driven by the filtered excitation, which is estimated from the same record and prior.
    ///
    /// # Errors
    /// [`MaxwellidError::NoiseUnknown`] without stated noise; [`MaxwellidError::Setting`] for a
    /// cut-off above half of the sampling rate; [`MaxwellidError::NoArrival`] without a front;
    /// [`MaxwellidError::RecordTooLong`]; [`MaxwellidError::NoUnfilteredExcitation`].
    pub fn with_recorder(self, filter: &RecorderFilter) -> Result<Self, MaxwellidError> {
        let rate = self.sampling_rate_hz;
        if filter.cutoff_hz() > 0.5 * rate {
            return Err(MaxwellidError::Setting {
                setting: "cut-off of the recorder's filter [Hz]",
                value: filter.cutoff_hz(),
                expected: "at most half of the sampling rate",
            });
        }
        let noise = self.noise.as_ref().map(|noise| &noise.excitation);
        let observation = |finer: usize| match noise {
            // the recorder filtered the displacement, whose samples were then differentiated
            Some(HistoryNoise::Differentiated {
                differentiator,
                rate_hz,
                ..
            }) => {
                let (differentiator, rate) = (differentiator.clone(), *rate_hz);
                let gain = move |f: f64| differentiator.gain(f / rate);
                let filter = filter.followed_by(gain);
                filter.observation(self.sampling_rate_hz * finer as f64, finer)
            }
            _ => filter.observation(rate * finer as f64, finer),
        };
        let observations = [FINER, STILL_FINER * FINER].map(observation);
        self.seen_through(filter, observations)
    }

    /// Returns the test with a filter. The `observations` are the filter on the grid of the
    /// excitation, with a multiple of [`FINER`] points per sample, and on a grid with
    /// [`STILL_FINER`] times as many.
    pub(crate) fn seen_through(
        self,
        filter: &RecorderFilter,
        observations: [Observation; 2],
    ) -> Result<Self, MaxwellidError> {
        let Some(noise) = &self.noise else {
            return Err(MaxwellidError::NoiseUnknown { test: self.name });
        };
        let Some(half_rise) = half_rise(&self.excitation_samples) else {
            return Err(MaxwellidError::NoArrival {
                test: self.name,
                history: "excitation",
            });
        };
        let unfiltered = UnfilteredExcitation::of(
            &self.name,
            &self.excitation_samples,
            (&noise.excitation, self.sampling_rate_hz, half_rise),
            (filter, observations),
        )?;
        Ok(Self {
            unfiltered: Some(Arc::new(unfiltered)),
            ..self
        })
    }

    /// The excitation before the filter of the recorder, if the filter is part of the model.
    #[must_use]
    pub fn unfiltered_excitation(&self) -> Option<&UnfilteredExcitation> {
        self.unfiltered.as_deref()
    }

    /// The excitation of a nonlinear rod on the grid of its fits and on a finer one.
    pub(crate) fn finer_front(&self, is_linear: bool) -> Option<&FinerFront> {
        let unfiltered = self.unfiltered.as_ref().filter(|_| !is_linear)?;
        Some(&unfiltered.finer)
    }

    /// The drive of a rod whose recorder is part of the model.
    pub(crate) fn drive(&self, is_linear: bool) -> Option<&Drive> {
        Some(self.unfiltered.as_ref()?.drive(is_linear))
    }

    /// Most likely excitation of the rod, given its record alone [m/s]: the record itself unless
    /// the recorder is part of the model.
    pub(crate) fn known_excitation(&self, is_linear: bool) -> &[f64] {
        let drive = self.drive(is_linear);
        drive.map_or(&self.excitation_samples, |drive| &drive.mean)
    }
}

#[cfg(test)]
mod tests {
    use faer::Side;
    use faer::linalg::solvers::Solve;
    use num_complex::Complex64;
    use testbed::noise::Noise as Draws;

    use super::*;

    const RATE: f64 = 51_200.0;
    const CUTOFF: f64 = 16e3;
    const NOISE: f64 = 0.05;

    fn two_poles() -> RecorderFilter {
        RecorderFilter::new("two poles", CUTOFF, |f| {
            (Complex64::ONE + Complex64::I * f / CUTOFF).powi(-2)
        })
        .unwrap()
    }

    fn white() -> HistoryNoise {
        HistoryNoise::White {
            standard_deviation: NOISE,
        }
    }

    /// An impact at `begin` \[s\] that rises with a time constant of 8 us and decays with one of 60
    /// us.
    fn blow(time: f64, begin: f64) -> f64 {
        let since = (time - begin).max(0.0);
        10.0 * ((-since / 60e-6).exp() - (-since / 8e-6).exp())
    }

    /// Compares mean and covariance with those from the precision matrix of w given v_e, D⁻¹ + Aᵀ
    /// C_e⁻¹ A with A = G B.
    #[test]
    fn mean_and_covariance_are_those_of_the_normal_equations() {
        let seen = two_poles().observation(4.0 * RATE, 4);
        let samples = 12;
        let points = seen.points(samples);
        let factors: Vec<f64> = [1.0; 20].into_iter().chain([5.0; 9]).collect();
        let contact = Contact {
            begin: 9,
            memory: 0.4,
            change: 0.8,
            factors: &factors,
            step: 3.0,
        };
        let record: Vec<f64> = (0..samples).map(|k| (0.4 * k as f64).sin()).collect();
        let noise = toeplitz(&white(), samples);
        let given = |contact: &Contact<'_>, first: usize| {
            contact.given(&record, &noise, (points, first), &seen)
        };
        let of = |contacts: &[(f64, Contact<'_>)]| mixed(contacts, points, given).unwrap();
        let (mean, covariance) = of(&[(1.0, contact)]);
        let moving = points - contact.begin;
        let unit = |at: usize, count: usize| (0..count).map(move |k| f64::from(u8::from(k == at)));
        let moves: Vec<Vec<f64>> = (0..moving)
            .map(|w| contact.moved(unit(contact.begin + w, points)))
            .collect();
        let shown: Vec<Vec<f64>> = moves.iter().map(|u| seen.of_history(u)).collect();
        let own = Mat::from_fn(moving, moving, |i, k| {
            let column: Vec<f64> = unit(contact.begin + k, points).collect();
            contact.correlated(column)[contact.begin + i]
        });
        assert!((own[(0, 0)] - 3.8).abs() < 1e-15 && (own[(0, 1)] - 2.4).abs() < 1e-15);
        assert!((own[(2, 2)] - 0.8).abs() < 1e-15 && own[(2, 1)].abs() < 1e-15);
        // points 20 to 28 of the grid have a larger variance, and the matrix begins at point 9
        assert!([11, 19].iter().all(|k| (own[(*k, *k)] - 4.0).abs() < 1e-15));
        assert!([10, 20].iter().all(|k| (own[(*k, *k)] - 0.8).abs() < 1e-15));
        let factor = own.llt(Side::Lower).unwrap();
        let inverse = factor.solve(Mat::<f64>::identity(moving, moving));
        let precision = Mat::from_fn(moving, moving, |i, k| {
            let of_data: f64 = shown[i].iter().zip(&shown[k]).map(|(a, b)| a * b).sum();
            inverse[(i, k)] + of_data / (NOISE * NOISE)
        });
        let right = Mat::from_fn(moving, 1, |i, _| {
            let along: f64 = shown[i].iter().zip(&record).map(|(a, b)| a * b).sum();
            along / (NOISE * NOISE)
        });
        let factor = precision.llt(Side::Lower).unwrap();
        let w = factor.solve(&right);
        let of_w = factor.solve(Mat::<f64>::identity(moving, moving));
        for point in 0..points {
            let expected: f64 = (0..moving).map(|i| w[(i, 0)] * moves[i][point]).sum();
            // tolerance: rounding of two solutions of a system with a condition number of 1e5
            assert!((mean[point] - expected).abs() < 1e-9, "{point}");
            for other in 0..points {
                let expected: f64 = (0..moving)
                    .flat_map(|i| (0..moving).map(move |k| (i, k)))
                    .map(|(i, k)| moves[i][point] * of_w[(i, k)] * moves[k][other])
                    .sum();
                assert!((covariance[(point, other)] - expected).abs() < 1e-9);
            }
        }
        // E(u uᵀ) of a mixture is the mean of those of its parts
        let later = Contact {
            begin: 11,
            memory: 0.7,
            ..contact
        };
        let (mean_of_later, of_later) = of(&[(1.0, later)]);
        let (of_both, covariance_of_both) = of(&[(0.3, contact), (0.7, later)]);
        for i in 0..points {
            for k in 0..points {
                let of_one = covariance[(i, k)] + mean[i] * mean[k];
                let of_other = of_later[(i, k)] + mean_of_later[i] * mean_of_later[k];
                let found = covariance_of_both[(i, k)] + of_both[i] * of_both[k];
                assert!((found - 0.3 * of_one - 0.7 * of_other).abs() < 1e-12);
            }
        }
    }

    /// e^{-bt}, b = 1/`constant`, behind two poles: a² t e^{-at} * e^{-bt}
    /// = a²/(a-b)² (e^{-bt} - e^{-at} (1 + (a-b) t)).
    fn passed(time: f64, constant: f64) -> f64 {
        let (t, a, b) = (
            time.max(0.0),
            std::f64::consts::TAU * CUTOFF,
            constant.recip(),
        );
        (a / (a - b)).powi(2) * ((-b * t).exp() - (-a * t).exp() * (1.0 + (a - b) * t))
    }

    fn estimate(record: &[f64]) -> UnfilteredExcitation {
        let half = half_rise(record).unwrap();
        let filter = two_poles();
        let observations = [4_u32, 16].map(|n| filter.observation(f64::from(n) * RATE, n as usize));
        UnfilteredExcitation::of(
            "blow",
            record,
            (&white(), RATE, half),
            (&filter, observations),
        )
        .unwrap()
    }

    /// Checks that the impact is estimated within its standard errors about the front, of which the
    /// record shows little. The records are the closed-form response of a filter with two poles.
    #[test]
    fn a_blow_is_found_within_its_standard_errors() {
        let (mut squares, mut count) = (0.0, 0.0);
        for seed in 0..20 {
            let mut draws = Draws::seeded(seed);
            let begin = (40.0 + f64::from(u8::try_from(seed).unwrap()) / 20.0) / RATE;
            let record: Vec<f64> = (0..110)
                .map(|k| {
                    let t = f64::from(k) / RATE - begin;
                    10.0 * (passed(t, 60e-6) - passed(t, 8e-6)) + NOISE * draws.normal()
                })
                .collect();
            let found = estimate(&record);
            // one sample
            assert!(
                (found.begin() - begin).abs() < 20e-6,
                "{}",
                found.begin() - begin
            );
            let errors = found.standard_error();
            let pairs = found.velocity().iter().zip(&errors).enumerate();
            for (k, (v, error)) in pairs.skip(160).take(60) {
                let off = v - blow(k as f64 / found.rate_hz(), begin);
                squares += (off / error.max(NOISE)).powi(2);
                count += 1.0;
            }
            // a quarter of the spectrum 1/((1 + iω 60 us)(1 + iω 8 us)), as root mean square, is
            // above 16 kHz
            assert!((0.1..0.6).contains(&found.share_above_cutoff()), "{found}");
        }
        // expected: 1; tolerance: the errors within each of the twenty records are not independent
        let mean: f64 = squares / count;
        assert!((0.2..1.5).contains(&mean), "{mean}");
    }

    /// Checks that the drive of a linear rod is estimated within its standard errors at a wave that
    /// returns 80 samples after a smooth impact of half its height and rises seven times as fast,
    /// and that is outside the part of the record from which q follows. The records have a closed
    /// form. With the variance q everywhere, the mean square of error over standard error is 180,
    /// and the drive is off by 2.3 m/s.
    #[test]
    fn a_returning_wave_is_found_within_its_standard_errors() {
        let (mut squares, mut count) = (0.0, 0.0);
        for seed in 0..10 {
            let mut draws = Draws::seeded(seed);
            let begin = (40.0 + f64::from(u8::try_from(seed).unwrap()) / 10.0) / RATE;
            let later = begin + 80.3 / RATE;
            let seen = |time: f64| {
                let (of_blow, of_wave) = (time - begin, time - later);
                10.0 * (passed(of_blow, 1e-3) - passed(of_blow, 60e-6))
                    + 20.0 * (passed(of_wave, 60e-6) - passed(of_wave, 8e-6))
            };
            let record: Vec<f64> = (0..150)
                .map(|k| seen(f64::from(k) / RATE) + NOISE * draws.normal())
                .collect();
            let found = estimate(&record);
            let drive = found.drive(true);
            for point in 232..272 {
                let off = drive.mean[point] - seen(point as f64 / drive.rate_hz);
                let error = drive.covariance[(point, point)].sqrt();
                squares += (off / error.max(NOISE)).powi(2);
                count += 1.0;
            }
        }
        // expected: 1; tolerance: the errors within each of the ten records are not independent
        let mean: f64 = squares / count;
        assert!((0.3..2.0).contains(&mean), "{mean}");
    }
}
