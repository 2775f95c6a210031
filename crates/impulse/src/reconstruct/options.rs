//! What the caller decides about a reconstruction.

/// How a line is divided.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Regularisation {
    /// $`\hat F = \hat x/H`$. Noise of the response is amplified by $`1/|H|`$ without limit.
    None,
    /// $`\hat F = H^*\hat x/(|H|^2+\lambda)`$, the minimum of $`|\hat x - H\hat F|^2 + \lambda|\hat F|^2`$. The gain stays
    /// below $`1/(2\sqrt\lambda)`$; lines with $`|H|^2 \ll \lambda`$ are lost, and the force comes out too small by
    /// $`|H|^2/(|H|^2+\lambda)`$.
    Tikhonov {
        /// $`\lambda`$ in the unit of $`|H|^2`$, above zero.
        lambda: f64,
    },
}

/// The lines used, both limits included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyBand {
    /// Lowest frequency \[Hz\].
    pub from_hz: f64,
    /// Highest frequency \[Hz\].
    pub to_hz: f64,
}

/// A time span from the first sample on, both limits included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeInterval {
    /// Begin \[s\].
    pub from: f64,
    /// End \[s\].
    pub to: f64,
}
