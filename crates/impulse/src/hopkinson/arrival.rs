//! Arrival of a wave, found from the wave itself.

/// Fractions of the peak between which the front is approximated by a straight line.
const FROM: f64 = 0.1;
const TO: f64 = 0.5;

/// Time at which a wave begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// Time at which the straight line through 10 % and 50 % of the peak starts from zero \[s\].
    pub time: f64,
    /// Standard error of the time, from noise and sampling \[s\].
    pub standard_error: f64,
    /// Duration of the front \[s\], extrapolated from its rise between 10 % and 50 % of the peak.
    pub rise: f64,
    /// The peak, with its sign.
    pub peak: f64,
}

impl Arrival {
    /// Finds the arrival of the wave in `samples`, `step` \[s\] apart from `start` \[s\] on, with
    /// noise of the standard deviation `noise`.
    ///
    /// `None` if the largest sample does not exceed ten times the noise.
    ///
    /// With the noise $`u`$ and the slope $`s`$ of the front, the time at which a level is crossed
    /// has the error $`u/s`$, and the intercept $`t_0 = t_{10} - \tfrac14(t_{50} - t_{10})`$ has
    /// the error $`u/s\,\sqrt{(5/4)^2 + (1/4)^2}`$.
    #[must_use]
    pub fn of(samples: &[f64], start: f64, step: f64, noise: f64) -> Option<Self> {
        let peak = samples
            .iter()
            .copied()
            .fold(0.0, |a: f64, x| if x.abs() > a.abs() { x } else { a });
        if peak.abs() <= 10.0 * noise || peak == 0.0 {
            return None;
        }
        let part = |x: &f64| x / peak;
        let half = samples.iter().position(|x| part(x) >= TO)?;
        let before = samples.get(..half)?;
        let low = before.iter().rposition(|x| part(x) < FROM)?;
        let crossing = |below: usize, level: f64| -> Option<f64> {
            let (a, b) = (part(samples.get(below)?), part(samples.get(below + 1)?));
            Some(below as f64 + (level - a) / (b - a))
        };
        let (t10, t50) = (crossing(low, FROM)?, crossing(half - 1, TO)?);
        let rise = (t50 - t10).max(0.25);
        let by_noise = noise / peak.abs() / (TO - FROM) * rise * 1.25_f64.hypot(0.25);
        Some(Self {
            time: start + step * (t10 - rise * FROM / (TO - FROM)),
            standard_error: step * by_noise.hypot(1.0 / 12.0_f64.sqrt()),
            rise: step * rise / (TO - FROM),
            peak,
        })
    }
}

/// Returns the first sample of a pulse: three samples in succession exceed 5 % of the largest one
/// and five times the noise.
pub(super) fn first_sample(samples: &[f64], noise: f64) -> Option<usize> {
    let largest = samples.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    if largest <= 10.0 * noise {
        return None;
    }
    let level = (0.05 * largest).max(5.0 * noise);
    samples
        .windows(3)
        .position(|three| three.iter().all(|x| x.abs() > level))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_begins_where_it_begins() {
        let samples: Vec<f64> = (0..200)
            .map(|n| -0.25 * (f64::from(n) - 63.4).clamp(0.0, 40.0))
            .collect();
        let found = Arrival::of(&samples, 1.0, 0.5, 1e-9).unwrap();
        assert!((found.time - (1.0 + 0.5 * 63.4)).abs() < 1e-9, "{found:?}");
        assert!((found.peak + 10.0).abs() < 1e-12);
        assert!((found.rise - 0.5 * 40.0).abs() < 1e-9);
        assert!(Arrival::of(&samples, 1.0, 0.5, 1.1).is_none());
        assert_eq!(first_sample(&samples, 1e-9), Some(66));
    }
}
