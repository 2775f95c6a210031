//! The classical Runge-Kutta method, which integrates virtual records in time.

/// Returns the state one step after `time`; `rate` is its derivative.
pub(crate) fn after_step<const N: usize>(
    state: [f64; N],
    time: f64,
    step: f64,
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    let moved = |rate: [f64; N], by: f64| std::array::from_fn(|n| state[n] + by * rate[n]);
    let k1 = rate(time, state);
    let k2 = rate(time + step / 2.0, moved(k1, step / 2.0));
    let k3 = rate(time + step / 2.0, moved(k2, step / 2.0));
    let k4 = rate(time + step, moved(k3, step));
    std::array::from_fn(|n| state[n] + step / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]))
}
