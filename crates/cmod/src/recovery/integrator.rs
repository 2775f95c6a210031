//! Integration of a smooth system of ordinary differential equations with error control.
//!
//! The method is the Runge-Kutta pair of orders 5 and 4 of Dormand and Prince (1980). The error is
//! controlled per unit of time, so that the tolerance applies to the whole interval and not to each
//! of, for example, a hundred thousand steps.

/// Number of unknowns: the stress and its derivatives with respect to the two parameters.
pub(super) const UNKNOWNS: usize = 3;

/// Values of all unknowns.
pub(super) type Unknowns = [f64; UNKNOWNS];

const MOST_STEPS: u32 = 4_000_000;
/// Error of a step due to rounding alone, for unknowns of order 1.
const ROUNDING: f64 = 1e-15;

const NODES: [f64; 6] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0];
const STAGES: [&[f64]; 6] = [
    &[],
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[
        19372.0 / 6561.0,
        -25360.0 / 2187.0,
        64448.0 / 6561.0,
        -212.0 / 729.0,
    ],
    &[
        9017.0 / 3168.0,
        -355.0 / 33.0,
        46732.0 / 5247.0,
        49.0 / 176.0,
        -5103.0 / 18656.0,
    ],
];
const FIFTH: [f64; 6] = [
    35.0 / 384.0,
    0.0,
    500.0 / 1113.0,
    125.0 / 192.0,
    -2187.0 / 6784.0,
    11.0 / 84.0,
];
/// Weights of the fifth-order formula minus those of the fourth-order formula; the seventh entry
/// belongs to the slope at the end of the step.
const DIFFERENCE: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// Interval of integration and its accuracy.
pub(super) struct Interval {
    /// Length of the interval, which begins at 0.
    pub(super) duration: f64,
    /// Longest allowed step; a longer step could miss variations of the load.
    pub(super) longest_step: f64,
    /// Accepted error of the unknowns at the end of the interval; the unknowns must be of order 1.
    pub(super) tolerance: f64,
}

/// Returns the unknowns at the end of `interval`, or, as an error, the time at which there were too
/// many steps or the steps became too small.
#[allow(
    clippy::indexing_slicing,
    reason = "a row of `STAGES` computes the stage of its own index, and there are more stages than rows"
)]
pub(super) fn integrate(
    start: Unknowns,
    interval: &Interval,
    slope: impl Fn(f64, &Unknowns) -> Unknowns,
) -> Result<Unknowns, f64> {
    let &Interval {
        duration,
        longest_step,
        tolerance,
    } = interval;
    // the integration would need too many steps
    if duration / longest_step > f64::from(MOST_STEPS) {
        return Err(0.0);
    }
    let mut values = start;
    let mut time = 0.0;
    let mut step = longest_step.min(duration);
    let mut stages = [[0.0; UNKNOWNS]; 7];
    stages[0] = slope(0.0, &values);
    for _ in 0..MOST_STEPS {
        if time >= duration {
            return Ok(values);
        }
        let last = time + step >= duration;
        let h = if last { duration - time } else { step };
        for (i, (node, row)) in NODES.iter().zip(STAGES).enumerate().skip(1) {
            let at = advanced(&values, h, row, &stages);
            stages[i] = slope(time + node * h, &at);
        }
        let end = advanced(&values, h, &FIFTH, &stages);
        stages[6] = slope(time + h, &end);
        // the sum and not the maximum of the errors, because f64::max would ignore a NaN
        let error: f64 = advanced(&[0.0; UNKNOWNS], h, &DIFFERENCE, &stages)
            .iter()
            .map(|e| e.abs())
            .sum();
        // the error per unit of time of the lower formula is of order h⁴; a step so long that the
        // slope overflows is rejected
        let allowed = (tolerance * h / duration).max(ROUNDING);
        let factor = if error.is_finite() {
            0.9 * (allowed / error.max(f64::MIN_POSITIVE)).powf(0.25)
        } else {
            0.0
        };
        if error <= allowed {
            time = if last { duration } else { time + h };
            values = end;
            stages[0] = stages[6];
        } else if h < 1e-15 * duration {
            return Err(time);
        }
        step = (h * factor.clamp(0.2, 4.0)).min(longest_step);
    }
    Err(time)
}

fn advanced(from: &Unknowns, h: f64, weights: &[f64], stages: &[Unknowns; 7]) -> Unknowns {
    let mut sum = [0.0; UNKNOWNS];
    for (weight, stage) in weights.iter().zip(stages) {
        for (s, k) in sum.iter_mut().zip(stage) {
            *s += weight * k;
        }
    }
    for (s, value) in sum.iter_mut().zip(from) {
        *s = value + h * *s;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_formula_is_of_fifth_order() {
        // y' = y on [0, 1] with steps of 1/n; the tolerance is so large that every step is accepted
        let error = |n: f64| {
            let interval = Interval {
                duration: 1.0,
                longest_step: 1.0 / n,
                tolerance: 1e9,
            };
            let end = integrate([1.0; 3], &interval, |_, y| *y).unwrap();
            (end[0] - 1.0_f64.exp()).abs()
        };
        // the next term of the error makes the observed order differ from 5 by about 1/n
        let order = (error(8.0) / error(16.0)).log2();
        assert!((order - 5.0).abs() < 0.2, "{order}");
    }

    #[test]
    fn the_error_is_that_asked_for() {
        // three driven unknowns of different rates: y' = -a (y - cos t) - sin t, with the solution
        // y = cos t + (y₀ - 1) e^(-at)
        let rates = [0.1, 1.0, 30.0];
        for tolerance in [1e-5, 1e-8, 1e-11] {
            let interval = Interval {
                duration: 20.0,
                longest_step: 1.0,
                tolerance,
            };
            let end = integrate([2.0; 3], &interval, |t, y| {
                std::array::from_fn(|i| -rates[i] * (y[i] - t.cos()) - t.sin())
            })
            .unwrap();
            for (value, rate) in end.iter().zip(rates) {
                let exact = 20.0_f64.cos() + (-20.0 * rate).exp();
                // tolerance: the stated tolerance, and less than 1e-13 for rounding over 20 s in
                // some thousand steps; the equations damp errors
                assert!(
                    (value - exact).abs() < tolerance + 1e-13,
                    "{tolerance} {rate}"
                );
            }
        }
    }

    #[test]
    fn a_pole_is_reported_with_its_time() {
        // y' = y² has the solution y = 1/(1 - t), with a pole at t = 1
        let interval = Interval {
            duration: 2.0,
            longest_step: 0.1,
            tolerance: 1e-9,
        };
        let time = integrate([1.0; 3], &interval, |_, y| y.map(|y| y * y)).unwrap_err();
        assert!((time - 1.0).abs() < 1e-2, "{time}");
    }
}
