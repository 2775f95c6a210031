//! Continuation of a measured mobility above its last line, from the echoes found in its lines.
//!
//! Theory: `docs/theory/force-uncertainty.md#continuation-above-the-measured-lines`.

use std::f64::consts::{PI, TAU};

use faer::linalg::solvers::SolveLstsq;
use faer::{Mat, MatRef, Scale, Side};
use num_complex::Complex64;

use crate::{Domain, ImpactBody, ImpulseError};

/// Lines of a measured body that are treated as known.
#[derive(Debug, Clone, Copy)]
pub(super) enum Known {
    All,
    /// The lower two thirds; the lines above them are replaced by a continuation.
    Lower,
}

/// Number of lines divided by the number of lowest lines that are left out, because a soft material
/// delays echoes more there.
const LEFT_OUT: usize = 5;

/// Number of lines above the last one, divided by the number of measured lines.
const ABOVE: usize = 15;

/// Largest number of lines of a window in which the echoes are found. If a body has more lines, the
/// lines of the window are several lines apart, so that the window spans a third of all.
const HIGHEST_ORDER: usize = 48;

/// Minimum number of lines of a window.
const FEWEST: usize = 2;

/// Smallest ratio of the power of an echo to the noise, which is the median power of all
/// directions.
const ABOVE_NOISE: f64 = 10.0;

/// Smallest ratio of the power of an echo to that of the strongest echo.
const ROUNDING: f64 = 1e-10;

/// A measured body with lines above the last measured one.
///
/// The wave that returns to a face of front impedance Z is $`R = (ZG - 1)/(ZG + 1)`$ times the one
/// that left it. Each echo of delay $`\tau`$ is a term $`a\,e^{-i\omega\tau}`$ of R whose amplitude
/// changes slowly with frequency: R is a sum of damped exponentials over the lines, and this sum
/// continues above the lines. No exponential may grow, and |R| stays at most 1, so that the
/// continued body is passive. R is rolled off to 0, its value for the front impedance alone, over
/// fifteen times the measured lines.
pub(super) struct Continued<'a> {
    body: &'a dyn ImpactBody,
    frequency_step_hz: f64,
    n_measured: usize,
    /// Mobility of the lines above the last measured one.
    above: Vec<Complex64>,
}

impl<'a> Continued<'a> {
    /// Continues a body that is known on lines; `None` for a body of another kind, without a front
    /// impedance, or if the lines are too few or not finite.
    pub(super) fn of(body: &'a dyn ImpactBody, known: Known) -> Result<Option<Self>, ImpulseError> {
        let (
            Domain::Lines {
                frequency_step_hz,
                n_lines,
            },
            Some(impedance),
        ) = (body.domain(), body.front_impedance())
        else {
            return Ok(None);
        };
        let n_known = match known {
            Known::All => n_lines,
            Known::Lower => 2 * n_lines / 3,
        };
        let first = n_known / LEFT_OUT;
        let reflection = (first..n_known)
            .map(|line| {
                let s = Complex64::new(0.0, TAU * frequency_step_hz * line as f64);
                let ratio = impedance * body.mobility_at(s)?;
                Ok((ratio - 1.0) / (ratio + 1.0))
            })
            .collect::<Result<Vec<_>, ImpulseError>>()?;
        let stride = reflection.len().div_ceil(3 * HIGHEST_ORDER).max(1);
        let order = reflection.len() / (3 * stride);
        // the kernel rejects a line that is not finite and reports its index
        let all_finite = reflection.iter().all(|line: &Complex64| line.is_finite());
        if order < FEWEST || !all_finite {
            return Ok(None);
        }
        let n_above = (ABOVE + 1) * n_lines - n_known;
        let continued = continued(&reflection, (order, stride), n_above)
            .ok_or(ImpulseError::NoDecomposition { size: order })?;
        let above = continued.into_iter().enumerate().map(|(index, echo)| {
            let roll_off = 0.5 + 0.5 * (PI * (index + 1) as f64 / n_above as f64).cos();
            let echo = echo * roll_off / echo.norm().max(1.0);
            (1.0 + echo) / (1.0 - echo) / impedance
        });
        Ok(Some(Self {
            body,
            frequency_step_hz,
            n_measured: n_known,
            above: above.collect(),
        }))
    }
}

/// A measured body reduced to every second line: its period is half as long, so that long ringing
/// wraps round twice as early.
pub(super) struct EverySecond<'a>(pub(super) &'a dyn ImpactBody);

impl ImpactBody for EverySecond<'_> {
    fn domain(&self) -> Domain {
        match self.0.domain() {
            Domain::Lines {
                frequency_step_hz,
                n_lines,
            } => Domain::Lines {
                frequency_step_hz: 2.0 * frequency_step_hz,
                n_lines: n_lines.div_ceil(2),
            },
            other => other,
        }
    }

    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        self.0.mobility_at(s)
    }

    fn free_mass(&self) -> Option<f64> {
        self.0.free_mass()
    }

    fn front_impedance(&self) -> Option<f64> {
        self.0.front_impedance()
    }
}

impl ImpactBody for Continued<'_> {
    fn domain(&self) -> Domain {
        Domain::Lines {
            frequency_step_hz: self.frequency_step_hz,
            n_lines: self.n_measured + self.above.len(),
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive number of lines"
    )]
    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        let line = (s.im / (TAU * self.frequency_step_hz)).round() as usize;
        let above = line.checked_sub(self.n_measured);
        match above.and_then(|index| self.above.get(index)) {
            Some(mobility) if s.re.abs() <= 0.0 => Ok(*mobility),
            _ => self.body.mobility_at(s),
        }
    }

    fn free_mass(&self) -> Option<f64> {
        self.body.free_mass()
    }

    fn front_impedance(&self) -> Option<f64> {
        self.body.front_impedance()
    }
}

/// Continues `values` by `n_more` values as a sum of damped exponentials, found by the rotation of
/// the signal subspace of `order` values that are `stride` apart (ESPRIT: Roy and Kailath 1989). No
/// term grows; terms below the noise are left out. `None` if the decomposition fails.
fn continued(
    values: &[Complex64],
    (order, stride): (usize, usize),
    n_more: usize,
) -> Option<Vec<Complex64>> {
    let windows = values.windows((order - 1) * stride + 1);
    let mut covariance = Mat::<Complex64>::zeros(order, order);
    for window in windows.clone() {
        for (column, second) in window.iter().step_by(stride).enumerate() {
            let second = second.conj();
            let entries = covariance.col_mut(column);
            let terms = entries.iter_mut().zip(window.iter().step_by(stride));
            terms
                .skip(column)
                .for_each(|(sum, first)| *sum += first * second);
        }
    }
    let eigen = covariance.self_adjoint_eigen(Side::Lower).ok()?;
    // the eigenvalues are in ascending order
    let powers: Vec<f64> = eigen
        .S()
        .column_vector()
        .iter()
        .map(|power| power.re)
        .collect();
    let most = powers.last().copied()?;
    let noise = powers.get(order / 2).copied()?;
    let least = (ABOVE_NOISE * noise).max(ROUNDING * most);
    let n_terms = powers.iter().filter(|power| **power > least).count();
    if n_terms == 0 {
        return Some(vec![Complex64::ZERO; n_more]);
    }
    let signal = eigen.U().subcols(order - n_terms, n_terms);
    // the least squares solution of (all rows but the last) x rotation = (all rows but the first)
    let last = signal.row(order - 1);
    let without = 1.0 - last.squared_norm_l2();
    let upper = signal.subrows(0, order - 1).adjoint() * signal.subrows(1, order - 1);
    let rotation = &upper + last.adjoint() * (last * &upper) * Scale((1.0 / without).into());
    let modes = rotation.eigen().ok()?;
    // a growing term is noise or an echo that hardly decays: it is made to decay at its rate of
    // growth
    let passive = |z: &Complex64| {
        if z.norm_sqr() > 1.0 {
            1.0 / z.conj()
        } else {
            *z
        }
    };
    let ratios: Vec<Complex64> = modes.S().column_vector().iter().map(passive).collect();
    // amplitudes by least squares, separately for each of the `stride` interleaved series: lines
    // that are `stride` apart do not distinguish delays beyond half of their period
    let n_each = values.len() / stride;
    let series = values.get(values.len() - n_each * stride..)?;
    let mut basis = Mat::<Complex64>::zeros(n_each, n_terms);
    let mut after = ratios.clone();
    for (column, (ratio, after)) in ratios.iter().zip(&mut after).enumerate() {
        *after = Complex64::ONE;
        for entry in basis.col_mut(column).iter_mut() {
            *entry = *after;
            *after *= ratio;
        }
    }
    let series = MatRef::from_column_major_slice(series, stride, n_each);
    let amplitudes = basis.col_piv_qr().solve_lstsq(series.transpose());
    let mut more = vec![Complex64::ZERO; n_more];
    for (phase, amplitudes) in amplitudes.col_iter().enumerate() {
        let mut terms: Vec<Complex64> = amplitudes.iter().zip(&after).map(|(a, b)| a * b).collect();
        for value in more.iter_mut().skip(phase).step_by(stride) {
            for (term, ratio) in terms.iter_mut().zip(&ratios) {
                *value += *term;
                *term *= ratio;
            }
        }
    }
    more.iter().all(|value| value.is_finite()).then_some(more)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LowFrequency, MeasuredBody};

    const IMPEDANCE: f64 = 1000.0;

    /// A long rod with a soft piece behind its front piece: two echoes, each weaker at higher
    /// frequency.
    fn reflection(frequency_hz: f64) -> Complex64 {
        let echo = |size: f64, delay: f64, loss: f64| {
            size * Complex64::from_polar((-loss * frequency_hz).exp(), -TAU * frequency_hz * delay)
        };
        echo(-0.4, 0.11e-3, 1e-5) + echo(0.3, 0.37e-3, 2e-5)
    }

    fn body(step_hz: f64, n_lines: usize) -> MeasuredBody {
        let lines: Vec<Complex64> = (0..n_lines)
            .map(|line| {
                let echo = reflection(step_hz * line as f64);
                (1.0 + echo) / (1.0 - echo) / IMPEDANCE
            })
            .collect();
        let body = MeasuredBody::from_mobility(&lines, step_hz, LowFrequency::Measured).unwrap();
        body.with_front_impedance(IMPEDANCE).unwrap()
    }

    #[test]
    fn echoes_go_on_above_the_lines() {
        for (step_hz, n_lines) in [(50.0, 201), (5.0, 2001)] {
            let measured = body(step_hz, n_lines);
            let continued = Continued::of(&measured, Known::All).unwrap().unwrap();
            // tolerance: up to an octave above the lines, the roll-off removes a twentieth of the
            // echo and the continuation has an error of the same size; without a continuation the
            // whole echo would be missing
            for line in n_lines..2 * n_lines - 1 {
                let s = Complex64::new(0.0, TAU * step_hz * line as f64);
                let ratio = IMPEDANCE * continued.mobility_at(s).unwrap();
                let found = (ratio - 1.0) / (ratio + 1.0);
                let exact = reflection(step_hz * line as f64);
                assert!((found - exact).norm() < 0.08, "{line}: {found} {exact}");
                assert!(ratio.re > 0.0, "{line}: {ratio}");
            }
            let last = Complex64::new(0.0, TAU * step_hz * (16 * n_lines - 1) as f64);
            let last = IMPEDANCE * continued.mobility_at(last).unwrap();
            assert!((last - 1.0).norm() < 1e-9, "{last}");
        }
    }

    /// Lines that a `Domain` may state, including some that a `MeasuredBody` refuses.
    #[test]
    fn few_lines_and_wrong_ones_are_not_continued() {
        struct Wrong(usize, f64);
        impl ImpactBody for Wrong {
            fn domain(&self) -> Domain {
                Domain::Lines {
                    frequency_step_hz: 10.0,
                    n_lines: self.0,
                }
            }
            fn mobility_at(&self, _s: Complex64) -> Result<Complex64, ImpulseError> {
                Ok(self.1.into())
            }
            fn free_mass(&self) -> Option<f64> {
                None
            }
            fn front_impedance(&self) -> Option<f64> {
                Some(IMPEDANCE)
            }
        }
        for n_lines in 0..8 {
            let few = Wrong(n_lines, 2.0 / IMPEDANCE);
            let continued = Continued::of(&few, Known::All).unwrap();
            assert!(continued.is_none() || n_lines > 4, "{n_lines}");
        }
        for wrong in [f64::NAN, f64::INFINITY, -1.0 / IMPEDANCE] {
            assert!(
                Continued::of(&Wrong(64, wrong), Known::All)
                    .unwrap()
                    .is_none()
            );
        }
        // as a body on lines, it is not known off the frequency axis
        let measured = body(50.0, 201);
        let continued = Continued::of(&measured, Known::All).unwrap().unwrap();
        let off_axis = Complex64::new(1.0, TAU * 50.0 * 300.0);
        assert!(continued.mobility_at(off_axis).is_err());
    }

    #[test]
    fn a_body_without_echoes_stays_its_front() {
        let lines = vec![Complex64::from(1.0 / IMPEDANCE); 64];
        let body = MeasuredBody::from_mobility(&lines, 10.0, LowFrequency::Measured).unwrap();
        assert!(Continued::of(&body, Known::All).unwrap().is_none());
        let body = body.with_front_impedance(IMPEDANCE).unwrap();
        let continued = Continued::of(&body, Known::All).unwrap().unwrap();
        let above = Complex64::new(0.0, TAU * 10.0 * 100.0);
        assert!((IMPEDANCE * continued.mobility_at(above).unwrap() - 1.0).norm() < 1e-12);
    }
}
