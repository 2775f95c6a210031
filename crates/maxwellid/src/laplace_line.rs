//! Transforms of histories on a line Re s = a, their inverses, and the propagation coefficient of a
//! rod on this line.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

/// Damping aT_p over the period: the alias of the next period is damped by e^{-16} = 1.1e-7.
const DAMPING_OVER_PERIOD: f64 = 16.0;

/// Number of points over which a history is faded to zero after its end. The kink at the end causes
/// ringing, the only error before the end: n points away it is 1/n² of the change of slope.
const TAPER: usize = 64;

/// The discrete Laplace transform of one length.
pub(crate) struct LaplaceLine {
    interval: f64,
    count: usize,
    damping: f64,
    fourier: RealFourier,
}

impl LaplaceLine {
    /// Creates a transform for histories of `points` at `rate_hz`, with a period of at least twice
    /// the history.
    pub(crate) fn new(points: usize, rate_hz: f64) -> Self {
        let count = (2 * (points + TAPER)).next_power_of_two();
        let interval = 1.0 / rate_hz;
        Self {
            interval,
            count,
            damping: DAMPING_OVER_PERIOD / (interval * count as f64),
            fourier: RealFourier::new(count),
        }
    }

    /// The arguments s = a + iω.
    pub(crate) fn arguments(&self) -> impl Iterator<Item = Complex64> + use<> {
        let (damping, step) = (self.damping, TAU / (self.interval * self.count as f64));
        (0..=self.count / 2).map(move |k| Complex64::new(damping, step * k as f64))
    }

    /// Σ q(t_n) e^{-s t_n}, unscaled, of a history whose first `known` points are given by `at`,
    /// and which is then faded to zero.
    pub(crate) fn transform(&mut self, known: usize, at: impl Fn(usize) -> f64) -> Vec<Complex64> {
        let last = at(known - 1);
        let damped = self.fourier.samples();
        damped.fill(0.0);
        for (n, value) in damped.iter_mut().enumerate().take(known + TAPER) {
            let time = n as f64 * self.interval;
            let undamped = if n < known {
                at(n)
            } else {
                let u = (n + 1 - known) as f64 / (TAPER + 1) as f64;
                last * 0.5 * (1.0 + (0.5 * TAU * u).cos())
            };
            *value = undamped * (-self.damping * time).exp();
        }
        self.fourier.forward().to_vec()
    }

    /// Points per second of a history.
    pub(crate) fn rate_hz(&self) -> f64 {
        1.0 / self.interval
    }

    /// The first `points` points of the history whose unscaled transform is `lines`.
    pub(crate) fn history(&mut self, lines: &[Complex64], points: usize) -> Vec<f64> {
        for (own, line) in self.fourier.lines().iter_mut().zip(lines) {
            *own = *line;
        }
        let scale = 1.0 / self.count as f64;
        let (damping, interval) = (self.damping, self.interval);
        let samples = self.fourier.inverse().iter().take(points);
        samples
            .enumerate()
            .map(|(n, value)| value * (scale * (damping * interval * n as f64).exp()))
            .collect()
    }
}

/// γL = s `transit`/`shape`^½ with Re γL >= 0, for the transit time \[s\] of the front.
pub(crate) fn propagation(transit: f64, s: Complex64, shape: Complex64) -> Complex64 {
    let gamma_length = s * transit / square_root(shape);
    if gamma_length.re < 0.0 {
        -gamma_length
    } else {
        gamma_length
    }
}

/// The principal square root of a number whose square is within the range of `f64`, without the
/// trigonometric functions of [`Complex64::sqrt`].
fn square_root(z: Complex64) -> Complex64 {
    let root = (0.5 * (z.norm_sqr().sqrt() + z.re.abs())).sqrt();
    let other = 0.5 * z.im / root;
    if z.re >= 0.0 {
        Complex64::new(root, other)
    } else {
        Complex64::new(other.abs(), root.copysign(z.im))
    }
}

/// 1/cosh z and tanh z for Re z >= 0, without overflow.
pub(crate) fn secant_and_tangent(z: Complex64) -> (Complex64, Complex64) {
    let once = (-z).exp();
    let twice = once * once;
    let denominator = (1.0 + twice).inv();
    (2.0 * once * denominator, (1.0 - twice) * denominator)
}
