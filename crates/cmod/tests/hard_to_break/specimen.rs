//! Ratios and spectra of rods in closed form, computed from single exponentials and without any of
//! the code that inverts them.

use std::f64::consts::TAU;

use num_complex::Complex64;

/// Rod with a free end, with a constant loss factor and wave speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Specimen {
    pub(crate) length: f64,
    pub(crate) diameter: f64,
    pub(crate) density: f64,
    pub(crate) end_mass: f64,
    /// Modulus E at the first line [Pa].
    pub(crate) modulus: f64,
    pub(crate) loss_factor: f64,
}

impl Specimen {
    pub(crate) fn polymer() -> Self {
        Self {
            length: 1.0,
            diameter: 0.02,
            density: 1150.0,
            end_mass: 0.0,
            modulus: 3e9,
            loss_factor: 0.05,
        }
    }

    /// Returns E (1 + i tan δ).
    pub(crate) fn complex_modulus(&self) -> Complex64 {
        self.modulus * Complex64::new(1.0, self.loss_factor)
    }

    /// Returns γ from ρω² = -Eγ² by the half angle, without the root of a complex number.
    pub(crate) fn gamma(&self, frequency_hz: f64) -> Complex64 {
        let magnitude = self.modulus * self.loss_factor.hypot(1.0);
        let slowness = (self.density / magnitude).sqrt();
        let half = 0.5 * self.loss_factor.atan();
        TAU * frequency_hz * slowness * Complex64::new(half.sin(), half.cos())
    }

    /// Returns the ratio of the mass on the end to the mass of the rod.
    pub(crate) fn mass_ratio(&self) -> f64 {
        let area = 0.125 * TAU * self.diameter * self.diameter;
        self.end_mass / (self.density * area * self.length)
    }

    /// Returns the ratio of the motion at a distance from the free end to the motion of the free
    /// end: (e^x + e^-x)/2 + μγL (e^x - e^-x)/2, x = γd.
    pub(crate) fn motion_at(&self, distance: f64, frequency_hz: f64) -> Complex64 {
        let gamma = self.gamma(frequency_hz);
        let (up, down) = exponentials(gamma * distance);
        let load = self.mass_ratio() * gamma * self.length;
        0.5 * ((up + down) + load * (up - down))
    }

    /// Returns the first resonance of the rod with free ends [Hz], by its wave speed.
    pub(crate) fn fundamental_hz(&self) -> f64 {
        0.5 * (self.modulus / self.density).sqrt() / self.length
    }
}

/// Returns e^x and e^-x.
fn exponentials(x: Complex64) -> (Complex64, Complex64) {
    let (sine, cosine) = x.im.sin_cos();
    let turn = Complex64::new(cosine, sine);
    (x.re.exp() * turn, (-x.re).exp() * turn.conj())
}

/// Returns the strain of two waves that travel in opposite directions, forward with amplitude 1 at
/// x = 0 and backward with `reflected`.
pub(crate) fn strain_of_two_waves(gamma: Complex64, x: f64, reflected: Complex64) -> Complex64 {
    let (up, down) = exponentials(gamma * x);
    down + reflected * up
}
