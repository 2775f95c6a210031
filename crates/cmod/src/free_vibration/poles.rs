//! Frequency and decay of modes from the lines around them.

use std::f64::consts::{PI, TAU};

use faer::Mat;
use faer::linalg::solvers::{Solve as _, SolveLstsq as _};
use num_complex::Complex64;
use rodwave::fourier::RealFourier;

use crate::error::{CmodError, check_finite, check_positive, check_that};
use crate::estimate::VarianceFreedom;
use crate::median::median;

/// Half width of the search range around the expected frequency of a mode, as a fraction of the
/// spacing of the modes.
const REACH: f64 = 0.3;
/// Minimum ratio of the power of a mode to the median power in its search range.
const ABOVE_MEDIAN: f64 = 100.0;
/// Minimum number of fitted lines on each side of a mode.
const FEWEST_LINES: usize = 12;
/// Maximum number of fitted lines on each side of a mode.
const MOST_LINES: usize = 400;
/// Power of another vibration, relative to the strongest mode, above which this other vibration is
/// reported.
const ELSEWHERE: f64 = 0.1;
/// Number of fitted lines on each side, as a multiple of the width of the peak of the mode at half
/// power.
const WIDTHS: f64 = 6.0;
/// Number of unknowns of a mode: amplitude, pole, and the three coefficients of a parabola for all
/// other modes.
const UNKNOWNS: usize = 5;
/// Maximum number of steps of the iteration.
const MOST_STEPS: usize = 60;
/// Minimum number of lines from one mode to the next in a shortened record.
const LINES_PER_SPACING: f64 = 50.0;
/// Ratio of the variance of a mode from a shorter part of the records to its variance from a longer
/// part, below which the result of the shorter part is used.
const BETTER: f64 = 0.5;
/// Number of standard errors by which a decay rate must change to be reported.
const CHANGES_BEYOND: f64 = 5.0;
/// Relative change of a decay rate that is required, in addition, to report it.
const CHANGES: f64 = 0.03;
/// Difference between the frequency of a mode and the frequency predicted from the mode below, as a
/// fraction of the spacing of the modes, above which the mode is reported. Lateral inertia shifts a
/// mode by as much only if its wavelength is below about two diameters.
const DEPARTS: f64 = 0.1;
/// Fraction of the sampling rate up to which modes are sought.
const HIGHEST: f64 = 0.45;

/// Pole of a mode $`e^{st}`$.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pole {
    /// Number of the mode, from 1.
    pub order: u32,
    /// Pole s = -δ + iω [1/s].
    pub s: Complex64,
    /// Variance E|δs|² [1/s²].
    pub variance: f64,
    /// Degrees of freedom of the variance.
    pub freedom: VarianceFreedom,
}

/// Mode that was not found at its expected frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Missing {
    /// Number of the mode, from 1.
    pub order: u32,
    /// Expected frequency \[Hz\].
    pub frequency_hz: f64,
}

/// Mode whose frequency does not follow from that of the mode below: one of the two is probably
/// another vibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Number of the mode, from 1.
    pub order: u32,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Frequency predicted from the mode below \[Hz\].
    pub expected_hz: f64,
}

/// Mode whose decay rate changes while it decays, because the damping depends on the amplitude or
/// two modes are close together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangingDecay {
    /// Number of the mode, from 1.
    pub order: u32,
    /// Decay rate δ from the beginning of the records [1/s].
    pub decay_rate: f64,
    /// Decay rate after the amplitude has fallen to 1/e [1/s].
    pub later: f64,
}

/// Modes of a rod, found in the records of its free vibration.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Poles {
    /// Modes that were found, in order.
    pub found: Vec<Pole>,
    /// Expected modes that do not stand out from the other lines.
    pub missing: Vec<Missing>,
    /// Frequency \[Hz\] of the strongest line that belongs to none of the modes, if its power is
    /// more than a tenth of the power of the strongest mode. Its cause is another vibration, or a
    /// wrong guess of the wave speed.
    pub strongest_elsewhere: Option<f64>,
    /// Modes whose decay is not exponential, with their decay rates.
    pub changing: Vec<ChangingDecay>,
    /// Modes whose frequencies do not follow from those of the modes below them.
    pub departing: Vec<Departure>,
}

impl Poles {
    /// Finds the modes at increasing `phases` κ, expected at the frequencies `hz_per_phase`·κ
    /// \[Hz\], in records of the free vibration after one or several hits.
    ///
    /// The DFT of a mode in white noise is, on every line k, with z = e^{sΔt},
    ///
    /// ```text
    /// X_k = B/(1 - z e^{-iω_kΔt}) + b₀ + b₁k + b₂k² ,
    /// ```
    ///
    /// The first term is exact, wherever the record ends; the parabola approximates the
    /// contributions of all other modes, whose frequencies are far away. B, b and z follow by least
    /// squares on the lines around the mode, and the noise of these lines follows from the
    /// residual. The frequency of a mode predicts the frequency of the next mode. The poles of
    /// several records are averaged; if they differ by more than their errors, the variance of the
    /// mean follows from their scatter.
    ///
    /// If a mode decays long before the end of the records, noise dominates the rest of the
    /// records. Therefore the first half, quarter, ... of each record is tried too, and replaces a
    /// longer part if its variance is less than half as large.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a rate that is not above 0, a sample that is not finite, or
    /// records of fewer than 64 samples.
    pub fn of(
        records: &[&[f64]],
        rate_hz: f64,
        phases: impl Iterator<Item = f64>,
        hz_per_phase: f64,
    ) -> Result<Self, CmodError> {
        check_positive("sampling rate [Hz]", rate_hz)?;
        let shortest = records.iter().map(|record| record.len()).min().unwrap_or(0);
        let n = shortest as f64;
        check_that(n >= 64.0, "samples of a free vibration", n, "at least 64")?;
        let mut parts: Vec<Vec<Spectrum>> = Vec::new();
        let spacing_hz = PI * hz_per_phase;
        let mut divisor = 1;
        while divisor == 1
            || (shortest / divisor >= 64
                && spacing_hz * (shortest / divisor) as f64 >= LINES_PER_SPACING * rate_hz)
        {
            let of_part = records.iter().map(|record| {
                let part = record.get(..record.len() / divisor);
                Spectrum::of(part.unwrap_or_default(), rate_hz)
            });
            parts.push(of_part.collect::<Result<_, _>>()?);
            divisor *= 2;
        }
        let mut poles = Self {
            found: Vec::new(),
            missing: Vec::new(),
            strongest_elsewhere: None,
            changing: Vec::new(),
            departing: Vec::new(),
        };
        let mut per_phase = hz_per_phase;
        let mut taken: Vec<(f64, f64)> = Vec::new();
        let mut lowest = f64::INFINITY;
        let mut of_first = 0;
        for (order, phase) in (1_u32..).zip(phases) {
            let expected = per_phase * phase;
            let reach = REACH * PI * per_phase;
            lowest = lowest.min(expected);
            if expected + reach > HIGHEST * rate_hz {
                break;
            }
            let mut best: Option<Fit> = None;
            let mut of_best = 0;
            for (part, spectra) in parts.iter().enumerate() {
                let fits = spectra
                    .iter()
                    .filter_map(|spectrum| spectrum.mode(expected, reach));
                let found = mean(&fits.collect::<Vec<_>>());
                let limit = best.as_ref().map_or(f64::INFINITY, |b| BETTER * b.variance);
                if let Some(found) = found.filter(|found| found.variance < limit) {
                    if poles.found.is_empty() {
                        of_first = part;
                    }
                    best = Some(found);
                    of_best = part;
                }
            }
            match best {
                Some(Fit {
                    s,
                    variance,
                    freedom,
                    width_hz,
                }) => {
                    let frequency_hz = s.im / TAU;
                    let limit = DEPARTS * PI * per_phase;
                    if !poles.found.is_empty() && (frequency_hz - expected).abs() > limit {
                        poles.departing.push(Departure {
                            order,
                            frequency_hz,
                            expected_hz: expected,
                        });
                    }
                    per_phase = frequency_hz / phase;
                    taken.push((frequency_hz, width_hz));
                    let length = shortest >> of_best;
                    let later = records.iter().filter_map(|record| {
                        let part = after_a_decay(record, length, -s.re / rate_hz)?;
                        let spectrum = Spectrum::of(part, rate_hz).ok()?;
                        spectrum.mode(frequency_hz, reach)
                    });
                    let later = mean(&later.collect::<Vec<_>>());
                    if let Some(later) = later.filter(|later| differ((s, variance), later)) {
                        poles.changing.push(ChangingDecay {
                            order,
                            decay_rate: -s.re,
                            later: -later.s.re,
                        });
                    }
                    poles.found.push(Pole {
                        order,
                        s,
                        variance,
                        freedom: VarianceFreedom::new(freedom, freedom)?,
                    });
                }
                None => poles.missing.push(Missing {
                    order,
                    frequency_hz: expected,
                }),
            }
        }
        if let Some(spectrum) = parts.get(of_first).and_then(|spectra| spectra.first()) {
            let from = 0.3 * poles.found.first().map_or(lowest, |pole| pole.s.im / TAU);
            let to = HIGHEST * rate_hz;
            let is_mode = |line: usize| {
                let mut modes = taken.iter();
                let at = line as f64 * spectrum.step_hz;
                modes.any(|(frequency, width)| (at - frequency).abs() <= *width)
            };
            let strongest = spectrum.strongest((from, to), |line| !is_mode(line));
            let of_modes = spectrum.strongest((from, to), is_mode);
            let (other, mode) = (
                strongest.map_or(0.0, |s| s.1),
                of_modes.map_or(0.0, |s| s.1),
            );
            if mode > 0.0 && other > ELSEWHERE * mode {
                poles.strongest_elsewhere =
                    strongest.map(|(line, _)| line as f64 * spectrum.step_hz);
            }
        }
        Ok(poles)
    }
}

/// Returns up to `length` samples of a record, starting when a mode that loses the fraction `decay`
/// of its amplitude per sample has fallen to 1/e; `None` if less than half of `length` remains.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of samples above 0, and the cast saturates"
)]
fn after_a_decay(record: &[f64], length: usize, decay: f64) -> Option<&[f64]> {
    let from = (decay > 0.0).then(|| decay.recip().ceil() as usize)?;
    let to = record.len().min(from.saturating_add(length));
    record.get(from..to).filter(|part| 2 * part.len() >= length)
}

/// Returns true if the decay rate of a mode changes by more than [`CHANGES_BEYOND`] standard errors
/// and by more than the fraction [`CHANGES`].
fn differ((s, variance): (Complex64, f64), later: &Fit) -> bool {
    let apart = (s.re - later.s.re).abs();
    // half of E|δs|² is the variance of the decay rate
    let error = (0.5 * (variance + later.variance)).sqrt();
    apart > CHANGES_BEYOND * error && apart > CHANGES * s.re.abs()
}

/// Returns the mean of the poles of several records.
fn mean(fits: &[Fit]) -> Option<Fit> {
    let weights: f64 = fits.iter().map(|fit| fit.variance.recip()).sum();
    let sum: Complex64 = fits.iter().map(|fit| fit.s / fit.variance).sum();
    let freedom: f64 = fits.iter().map(|fit| fit.freedom).sum();
    let mean = sum / weights;
    let scatter: f64 = fits
        .iter()
        .map(|fit| (fit.s - mean).norm_sqr() / fit.variance)
        .sum();
    let repeats = fits.len().saturating_sub(1) as f64;
    // the variance is E|δs|² of both parts of s: its estimate from n records has 2(n - 1) degrees
    // of freedom
    let excess = if repeats > 0.0 {
        scatter / repeats
    } else {
        0.0
    };
    let (variance, freedom) = if excess > 1.0 {
        (excess / weights, 2.0 * repeats)
    } else {
        (weights.recip(), freedom)
    };
    (!fits.is_empty() && mean.is_finite()).then(|| Fit {
        s: mean,
        variance,
        freedom,
        width_hz: fits.iter().map(|fit| fit.width_hz).fold(0.0, f64::max),
    })
}

/// Fit of a mode in one record, or the mean of several.
struct Fit {
    s: Complex64,
    variance: f64,
    freedom: f64,
    /// Half the width of the widest band of fitted lines \[Hz\].
    width_hz: f64,
}

/// Spectrum of one record.
struct Spectrum {
    /// Fourier transform without a window.
    lines: Vec<Complex64>,
    /// Power with Hann's window, with which a distant mode contributes little to a line.
    power: Vec<f64>,
    /// Spacing of the lines \[Hz\].
    step_hz: f64,
    /// Sampling interval \[s\].
    sample: f64,
}

impl Spectrum {
    fn of(record: &[f64], rate_hz: f64) -> Result<Self, CmodError> {
        for value in record {
            check_finite("sample of a free vibration", *value)?;
        }
        let n = record.len();
        let mut transform = RealFourier::new(n);
        transform.samples().copy_from_slice(record);
        let lines = transform.forward().to_vec();
        for (index, (sample, x)) in transform.samples().iter_mut().zip(record).enumerate() {
            *sample = 0.5 * x * (1.0 - (TAU * index as f64 / n as f64).cos());
        }
        let power = transform
            .forward()
            .iter()
            .map(Complex64::norm_sqr)
            .collect();
        Ok(Self {
            lines,
            power,
            step_hz: rate_hz / n as f64,
            sample: rate_hz.recip(),
        })
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the value is not negative, and the index is limited to the last line"
    )]
    fn line_at(&self, frequency_hz: f64) -> usize {
        let line = (frequency_hz / self.step_hz).round().max(0.0) as usize;
        line.min(self.lines.len().saturating_sub(1))
    }

    /// Returns the strongest line in a band among those for which `counted` returns true, with its
    /// power.
    fn strongest(
        &self,
        (from_hz, to_hz): (f64, f64),
        counted: impl Fn(usize) -> bool,
    ) -> Option<(usize, f64)> {
        let lines = self.line_at(from_hz)..self.line_at(to_hz);
        let powers = lines.filter_map(|line| Some((line, *self.power.get(line)?)));
        powers
            .filter(|(line, _)| counted(*line))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Fits the mode near `expected` \[Hz\]; `None` if no mode stands out from the other lines.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of lines"
    )]
    fn mode(&self, expected: f64, reach: f64) -> Option<Fit> {
        let (from, to) = (
            self.line_at(expected - reach),
            self.line_at(expected + reach),
        );
        let within = self.power.get(from..=to)?;
        let (peak, power) = within
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(b.1))?;
        if *power <= ABOVE_MEDIAN * median(&mut within.to_vec())? {
            return None;
        }
        let peak = from + peak;
        let half = |line: &&f64| **line > 0.5 * power;
        let above = self.power.get(peak..)?.iter().take_while(half).count();
        let below = self
            .power
            .get(..peak)?
            .iter()
            .rev()
            .take_while(half)
            .count();
        let wide = (WIDTHS * (above + below) as f64) as usize;
        let spacing = (to - from) / 2;
        let n_around = wide
            .clamp(FEWEST_LINES, MOST_LINES)
            .min(spacing.max(FEWEST_LINES));
        let (first, last) = (peak.checked_sub(n_around)?, peak + n_around);
        let around = self.lines.get(first..=last)?;
        let mode = LinesOfMode {
            turns: (first..=last)
                .map(|line| Complex64::cis(-TAU * line as f64 * self.step_hz * self.sample))
                .collect(),
            places: (0..around.len())
                .map(|line| (line as f64 - n_around as f64) / n_around as f64)
                .collect(),
            values: around,
        };
        let omega = TAU * peak as f64 * self.step_hz;
        let start = |decay: f64| (Complex64::new(-decay, omega) * self.sample).exp();
        // starting values of the decay rate, from 0.2 to 200 times the inverse of the length of the
        // record
        let per_record = TAU * self.step_hz;
        let fits = [0.03, 0.3, 1.0, 3.0, 10.0, 30.0]
            .into_iter()
            .filter_map(|decay| mode.fit(start(decay * per_record)));
        let best = fits.min_by(|a, b| a.square.total_cmp(&b.square))?;
        let s = best.z.ln() / self.sample;
        let freedom = 2.0 * (around.len() - UNKNOWNS) as f64;
        let inside = (s.im / TAU - expected).abs() <= 1.5 * reach;
        inside.then_some(Fit {
            s,
            variance: best.variance / (best.z.norm_sqr() * self.sample * self.sample),
            freedom,
            width_hz: n_around as f64 * self.step_hz,
        })
    }
}

struct LinesOfMode<'a> {
    /// Factor $`e^{-i\omega_k\Delta t}`$ of each line.
    turns: Vec<Complex64>,
    /// Positions of the lines in the band, from -1 to 1.
    places: Vec<f64>,
    values: &'a [Complex64],
}

/// Fitted z of a mode.
struct FittedPole {
    z: Complex64,
    /// Variance E|δz|².
    variance: f64,
    /// Sum of squares of the residual.
    square: f64,
}

impl LinesOfMode<'_> {
    /// Fits z by Gauss-Newton steps from `start`; for each z, B and the parabola follow by linear
    /// least squares.
    fn fit(&self, start: Complex64) -> Option<FittedPole> {
        let mut z = start;
        let mut best = self.linear(z)?;
        for _ in 0..MOST_STEPS {
            let jacobian = self.columns(z, Some(best.amplitude));
            let step = least_squares(&jacobian, &best.residual)?.last().copied()?;
            // the step is halved until it improves the fit
            let mut part = 1.0;
            let better = loop {
                let next = z + part * step;
                match self.linear(next) {
                    Some(own) if own.square < best.square && next.norm() <= 1.0 + 1e-9 => {
                        break Some((next, own));
                    }
                    _ if part < 1e-6 => break None,
                    _ => part *= 0.5,
                }
            };
            let Some((next, own)) = better else {
                break;
            };
            let gained = best.square - own.square;
            let settled = (next - z).norm() <= 1e-14 || gained <= 1e-13 * best.square;
            (z, best) = (next, own);
            if settled {
                break;
            }
        }
        let jacobian = self.columns(z, Some(best.amplitude));
        let square = best.square;
        let of_noise = square / (self.values.len() - UNKNOWNS) as f64;
        let variance = of_noise * last_of_inverse(&jacobian)?;
        (z.is_finite() && variance.is_finite() && variance > 0.0).then_some(FittedPole {
            z,
            variance,
            square,
        })
    }

    /// Returns the columns of the design matrix for B and the parabola and, if the `amplitude` is
    /// given, for z.
    fn columns(&self, z: Complex64, amplitude: Option<Complex64>) -> Vec<Vec<Complex64>> {
        let pole: Vec<Complex64> = self
            .turns
            .iter()
            .map(|turn| (1.0 - z * turn).inv())
            .collect();
        let power = |n: i32| {
            self.places
                .iter()
                .map(move |x| Complex64::from(x.powi(n)))
                .collect()
        };
        let mut columns = vec![pole.clone(), power(0), power(1), power(2)];
        if let Some(amplitude) = amplitude {
            let slopes = pole.iter().zip(&self.turns);
            columns.push(slopes.map(|(p, turn)| amplitude * turn * p * p).collect());
        }
        columns
    }

    /// Returns the linear least-squares fit of B and the parabola for a given z.
    fn linear(&self, z: Complex64) -> Option<Linear> {
        let columns = self.columns(z, None);
        let found = least_squares(&columns, self.values)?;
        let residual = residual(&columns, &found, self.values);
        Some(Linear {
            amplitude: *found.first()?,
            square: residual.iter().map(Complex64::norm_sqr).sum(),
            residual,
        })
    }
}

/// Result of the linear least squares for a given z.
struct Linear {
    amplitude: Complex64,
    residual: Vec<Complex64>,
    /// Sum of squares of the residual.
    square: f64,
}

fn residual(
    columns: &[Vec<Complex64>],
    factors: &[Complex64],
    values: &[Complex64],
) -> Vec<Complex64> {
    let mut left = values.to_vec();
    for (column, factor) in columns.iter().zip(factors) {
        for (left, entry) in left.iter_mut().zip(column) {
            *left -= factor * entry;
        }
    }
    left
}

fn matrix(columns: &[Vec<Complex64>]) -> Mat<Complex64> {
    let rows = columns.first().map_or(0, Vec::len);
    Mat::from_fn(rows, columns.len(), |i, j| {
        let entry = columns.get(j).and_then(|column| column.get(i));
        entry.copied().unwrap_or(Complex64::ZERO)
    })
}

/// Returns the least-squares factors of the columns; `None` if a factor is not finite.
fn least_squares(columns: &[Vec<Complex64>], values: &[Complex64]) -> Option<Vec<Complex64>> {
    let (scaled, sizes) = unit(columns);
    let right = Mat::from_fn(values.len(), 1, |i, _| {
        values.get(i).copied().unwrap_or(Complex64::ZERO)
    });
    let solved = matrix(&scaled).qr().solve_lstsq(right);
    let factors: Vec<Complex64> = sizes
        .iter()
        .enumerate()
        .map(|(j, size)| solved[(j, 0)] / size)
        .collect();
    factors.iter().all(|x| x.is_finite()).then_some(factors)
}

/// Returns the last element of the diagonal of (JᴴJ)⁻¹.
fn last_of_inverse(columns: &[Vec<Complex64>]) -> Option<f64> {
    let (scaled, sizes) = unit(columns);
    let jacobian = matrix(&scaled);
    let normal = jacobian.adjoint() * &jacobian;
    let last = columns.len().checked_sub(1)?;
    let unit = Mat::from_fn(columns.len(), 1, |i, _| {
        Complex64::from(f64::from(u8::from(i == last)))
    });
    let solved = normal.partial_piv_lu().solve(unit);
    let size = sizes.last()?;
    Some(solved[(last, 0)].re / (size * size))
}

/// Returns the columns scaled to unit length, and their original lengths.
fn unit(columns: &[Vec<Complex64>]) -> (Vec<Vec<Complex64>>, Vec<f64>) {
    columns
        .iter()
        .map(|column| {
            let size = column.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
            let size = if size > 0.0 { size } else { 1.0 };
            (column.iter().map(|x| x / size).collect(), size)
        })
        .unzip()
}
