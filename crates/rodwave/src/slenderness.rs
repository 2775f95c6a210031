//! Slenderness: limits of one-dimensional theory, and corrections beyond them.
//!
//! The waves of this crate obey γ² = -ρω²/E. In a rod of finite diameter D, the material also moves
//! laterally, according to Poisson's ratio ν, and the inertia of this motion slows down short
//! waves. The wave number k is then too large for the modulus, and a modulus that one-dimensional
//! theory gives from a measured k is too small.
//!
//! | theory | assumption | range |
//! |---|---|---|
//! | elementary, [`medium`](crate::medium) | no lateral inertia | E' within 1 % for λ > 11D at ν = 1/2, for λ > 9D at 0.4 |
//! | [`LoveRayleigh`] | lateral motion as in statics | E' within 1 % for λ > 3.2D; any section |
//! | [`MindlinHerrmann`] | two degrees of freedom per section | for comparison only |
//! | [`PochhammerChree`] | an infinitely long, homogeneous, isotropic cylinder | everywhere |
//!
//! All theories except the elementary one implement [`RodTheory`], in both directions: the
//! propagation coefficient from the complex modulus, and the modulus, corrected for lateral
//! inertia, from a measured propagation coefficient. [`Slenderness`] contains the conditions (i)
//! and (ii) of paper A; [`Theory::error_left`] gives the remaining error of a theory. Use one
//! theory for a whole band: at a change from one theory to another, the modulus has a step.
//!
//! ```
//! use num_complex::Complex64;
//! use rodwave::medium::modulus_from_propagation;
//! use rodwave::slenderness::{PochhammerChree, RodTheory, RoundRod};
//!
//! // Polypropylene, 15.8 mm in diameter, at 20 kHz: k = 78 rad/m was measured, a wavelength of five diameters.
//! let rod = RoundRod { density: 912.0, diameter: 0.0158, poisson_ratio: 0.40 };
//! let omega = 2.0 * std::f64::consts::PI * 20e3;
//! let measured = Complex64::new(3.0, 78.0);
//!
//! let apparent = modulus_from_propagation(measured, omega, rod.density)?;
//! let corrected = PochhammerChree::new(rod)?.modulus(measured, omega)?.found().expect("the first branch");
//! assert!((apparent.re / corrected.modulus.re - 0.968).abs() < 1e-3); // one-dimensional theory is 3 % low
//!
//! // ν is known to ± 0.02: the relative error of the correction of 3 % is 2 × 0.02/0.40.
//! let error = corrected.standard_error(0.02)?;
//! assert!((error.storage_modulus / corrected.modulus.re - 0.0030).abs() < 1e-4);
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! # Variables
//! All theories here contain E and ω only in ρω²/E, and γ only in γ². With the radius a = D/2, they
//! relate two complex numbers,
//!
//! ```text
//! B = ρω²a²/E        K = -γ²a²        (real E: B = (ωa/c₀)², K = (ka)²)
//! ```
//!
//! by an equation f(B, K, ν) = 0, which reduces to elementary theory, K = B, for thin rods. The
//! equation is also valid for complex E, because the field equations in the frequency domain are
//! those of elasticity with complex moduli.
//!
//! # Limitations
//! - Poisson's ratio is one real number per rod. In a polymer it has a small imaginary part ν'' and
//!   depends on frequency: ν = 1/2 - E/6K_b for a real bulk modulus K_b. Because B is an analytic
//!   function of ν, the effect of ν'' is i ν'' ∂E/∂ν to first order, with ∂E/∂ν from
//!   [`CorrectedModulus::by_poisson_ratio`]: for ν = 0.4, λ = 5D and ν'' = -0.008, this lowers
//!   E''/E' by 0.0012.
//! - Rods are round, except for [`LoveRayleigh::rectangular`], and far longer than their diameter:
//!   end effects are not included.
//! - Only the first branch is included. Above the cut-off of the second branch, a struck rod
//!   carries more than one wave.
//!
//! Theory: `docs/theory/slenderness.md`.

mod conditions;
mod frequency_equation;
mod love_rayleigh;
mod mindlin_herrmann;
mod model_error;
mod pochhammer_chree;
mod rayleigh_wave;
mod theory;

pub use conditions::{GREATEST_WAVELENGTH_IN_LENGTHS, LEAST_WAVELENGTH_IN_DIAMETERS, Slenderness};
pub use love_rayleigh::{LoveRayleigh, RectangularRod};
pub use mindlin_herrmann::MindlinHerrmann;
pub use model_error::{ApparentModulusError, Theory, elementary_theory_error};
pub use pochhammer_chree::PochhammerChree;
pub use rayleigh_wave::rayleigh_to_shear_speed;
pub use theory::{CorrectedModulus, FirstBranch, ModulusError, RodTheory, RoundRod};
