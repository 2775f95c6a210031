//! Half-sine pulses.

/// Returns the half-sine pulse over a `phase` from 0 to 1; it is 0 before and after.
pub fn half_sine(phase: f64) -> f64 {
    if (0.0..1.0).contains(&phase) {
        (std::f64::consts::PI * phase).sin()
    } else {
        0.0
    }
}
