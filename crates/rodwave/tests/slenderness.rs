//! Theories of lateral inertia: long waves, veering, branches, round trips, comparisons, rejected
//! input.
use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use proptest::prelude::*;
use rodwave::RodwaveError;
use rodwave::medium::modulus_from_propagation;
use rodwave::slenderness::{
    FirstBranch, LoveRayleigh, MindlinHerrmann, PochhammerChree, RectangularRod, RodTheory,
    RoundRod, Theory, elementary_theory_error, rayleigh_to_shear_speed,
};

/// Radius [m], density [kg/m³] and modulus [Pa] of a rod. None of the values is 1, so that a
/// missing factor shows.
const RADIUS: f64 = 0.0079;
const DENSITY: f64 = 912.0;
pub(crate) const MODULUS: f64 = 2.4e9;

pub(crate) fn rod(poisson_ratio: f64) -> RoundRod {
    RoundRod {
        density: DENSITY,
        diameter: 2.0 * RADIUS,
        poisson_ratio,
    }
}

pub(crate) fn love(nu: f64) -> LoveRayleigh {
    LoveRayleigh::round(rod(nu)).unwrap()
}

pub(crate) fn mindlin_herrmann(nu: f64) -> MindlinHerrmann {
    MindlinHerrmann::new(rod(nu)).unwrap()
}

pub(crate) fn exact(nu: f64) -> PochhammerChree {
    PochhammerChree::new(rod(nu)).unwrap()
}

/// Returns the ω at which (ωa/c₀)² has the `value` for a rod of modulus E.
pub(crate) fn omega_of_bar_number(value: f64) -> f64 {
    (value * MODULUS / DENSITY).sqrt() / RADIUS
}

/// Computes B = ρω²a²/E by a theory from K = -γ²a².
pub(crate) fn bar_number(theory: &dyn RodTheory, wave: Complex64) -> Complex64 {
    let omega = 3.0e5; // any value: B and K do not depend on it
    let gamma = Complex64::I * wave.sqrt() / RADIUS;
    let corrected = theory.modulus(gamma, omega).unwrap().found().unwrap();
    DENSITY * (omega * RADIUS).powi(2) / corrected.modulus
}

/// Computes K = -γ²a² by a theory from B = ρω²a²/E.
pub(crate) fn wave_number(theory: &dyn RodTheory, bar: Complex64) -> Complex64 {
    let omega = 3.0e5;
    let modulus = DENSITY * (omega * RADIUS).powi(2) / bar;
    let gamma = theory.propagation_coefficient(modulus, omega).unwrap();
    -(gamma.found().unwrap() * RADIUS).powu(2)
}

/// Computes E'_apparent/E' - 1 of an elastic rod in per cent, at λ/D.
pub(crate) fn apparent_error_percent(theory: &dyn RodTheory, wavelength_in_diameters: f64) -> f64 {
    let wave = (PI / wavelength_in_diameters).powi(2);
    100.0 * (bar_number(theory, wave.into()).re / wave - 1.0)
}

/// Returns the ω at which the wavelength 2π/k is `ratio` diameters, by fixed-point iteration,
/// because k/ω hardly changes.
pub(crate) fn omega_of_wavelength(theory: &dyn RodTheory, modulus: Complex64, ratio: f64) -> f64 {
    let target = TAU / (ratio * 2.0 * RADIUS);
    let mut omega = target * (modulus.re / DENSITY).sqrt();
    for _ in 0..60 {
        let gamma = theory.propagation_coefficient(modulus, omega).unwrap();
        omega *= target / gamma.found().unwrap().im;
    }
    omega
}

/// Checks that the error at λ = 5D increases with Poisson's ratio and is below 5 per cent for all
/// values.
#[test]
fn condition_i_is_worst_for_an_incompressible_rod() {
    let errors =
        [0.3, 0.35, 0.4, 0.45, 0.499, 0.5].map(|nu| apparent_error_percent(&exact(nu), 5.0));
    assert!(errors.is_sorted_by(|a, b| a > b && *b > -5.0), "{errors:?}");
}

/// Checks that the remainder of B/K = 1 - ½ν²K + b₂K² + O(K³) falls as K³, with b₂ from the power
/// series of the Bessel functions by computer algebra.
#[test]
fn long_waves_have_the_asymptotic_series() {
    for nu in [-0.5_f64, 0.1, 0.35, 0.5] {
        let polynomial = 7.0 - 4.0 * nu - 32.0 * nu.powi(2) + 4.0 * nu.powi(3) + 24.0 * nu.powi(4);
        let b2 = -nu * nu * polynomial / (48.0 * (1.0 - nu * nu));
        let remainder = |wave: f64| {
            let ratio = bar_number(&exact(nu), wave.into()).re / wave;
            (ratio - (1.0 - 0.5 * nu * nu * wave + b2 * wave * wave)).abs()
        };
        let (coarse, fine) = (remainder(0.04), remainder(0.02));
        // The factor is 2³ = 8; tolerance: 20 % for the next order. The remainder is some 1e-3 ν²
        // K³, far above rounding
        assert!(
            (coarse / fine - 8.0).abs() < 1.6,
            "{nu}: {coarse:e} {fine:e}"
        );

        // Love's theory contains only the first term of this series: its remainder decreases as K²
        let love_remainder = |wave: f64| {
            (bar_number(&love(nu), wave.into()) - bar_number(&exact(nu), wave.into())).norm() / wave
        };
        assert!((love_remainder(0.02) / love_remainder(0.01) - 4.0).abs() < 0.1);
    }
}

/// Checks that, for small ν, the correction is of order ν² as long as the second branch is far
/// away.
#[test]
fn small_lateral_contraction_corrects_little() {
    for nu in [1e-9, 1e-5, 1e-3] {
        let change = bar_number(&exact(nu), 2.0.into()) / 2.0 - 1.0;
        assert!(change.norm() < 10.0 * nu * nu + 1e-14, "{nu}: {change}");
    }
}

/// Checks branches that almost cross, ν = 1e-3 near ka = 1.84: the branch of an elastic rod turns
/// away, that of a lossy rod continues straight.
#[test]
fn veering_is_followed_not_jumped() {
    let bar = 3.8;
    let elastic = wave_number(&exact(1e-3), bar.into());
    assert!(elastic.re > 4.5 && elastic.im.abs() < 1e-9, "{elastic}");
    let lossy_bar = bar / Complex64::new(1.0, 0.1);
    let lossy = wave_number(&exact(1e-3), lossy_bar);
    assert!((lossy / lossy_bar - 1.0).norm() < 1e-3, "{lossy}");
    let back = bar_number(&exact(1e-3), elastic);
    assert!((back / bar - 1.0).norm() < 1e-9, "{back}"); // rounding over the gap of 1e-3
    // At ν = 1e-13, double precision cannot separate the branches, and the result states this.
    let undecidable = exact(1e-13)
        .propagation_coefficient(MODULUS.into(), omega_of_bar_number(bar))
        .unwrap();
    let FirstBranch::Left { reached } = undecidable else {
        panic!("{undecidable:?}");
    };
    // the branch is lost at ka = 1.841, on the path to √3.8 = 1.949
    assert!((reached * bar.sqrt() - 1.8412).abs() < 1e-3, "{reached}");
}

/// Checks that a rectangle with the same polar radius of gyration as a circle carries the same
/// waves. k_p² = (b² + h²)/12 is the mean of x² + y² over the area, computed here by Simpson's
/// rule, which is exact for a quadratic function.
#[test]
fn rectangle_enters_by_its_polar_radius_of_gyration() {
    let (width, height) = (0.012, 0.007);
    let rectangle = RectangularRod {
        density: DENSITY,
        width,
        height,
        poisson_ratio: 0.4,
    };
    let rectangle = LoveRayleigh::rectangular(rectangle).unwrap();
    let mean_square = |side: f64| (0.25 * side * side + 4.0 * 0.0 + 0.25 * side * side) / 6.0;
    let squared = mean_square(width) + mean_square(height);
    assert!((rectangle.polar_radius_of_gyration().powi(2) / squared - 1.0).abs() < 1e-14);

    let circle = RoundRod {
        diameter: (8.0 * squared).sqrt(),
        ..rod(0.4)
    };
    let circle = LoveRayleigh::round(circle).unwrap();
    let modulus = MODULUS * Complex64::new(1.0, 0.1);
    let of_rectangle = rectangle
        .propagation_coefficient(modulus, 1e5)
        .unwrap()
        .found()
        .unwrap();
    let of_circle = circle
        .propagation_coefficient(modulus, 1e5)
        .unwrap()
        .found()
        .unwrap();
    assert!((of_rectangle / of_circle - 1.0).norm() < 1e-14);
}

/// Checks the relative error 2 δν/ν, which follows from Love's theory.
#[test]
fn standard_error_by_poissons_ratio() {
    let gamma = Complex64::new(4.0, 90.0); // λ = 4.4 D
    let corrected = exact(0.4).modulus(gamma, 1.5e5).unwrap().found().unwrap();
    let error = corrected.standard_error(0.02).unwrap();
    let correction = (corrected.modulus - corrected.apparent_modulus).norm();
    // 2 δν/ν = 0.1 of the correction is the leading term; tolerance: the next term may add 20 % at
    // λ = 4.4 D
    assert!((error.storage_modulus / correction / 0.1 - 1.0).abs() < 0.2);
    // E'' is hardly affected; the relative error of E''/E' is therefore that of E', again to 20 %
    let relative = error.loss_factor / corrected.loss_factor();
    assert!((relative / (error.storage_modulus / corrected.modulus.re) - 1.0).abs() < 0.2);
}

/// Compares the effect of a small imaginary part of Poisson's ratio on the loss factor with the
/// number in the documentation of the module.
#[test]
fn imaginary_part_of_poissons_ratio_lowers_the_loss_factor() {
    let modulus = MODULUS * Complex64::new(1.0, 0.08);
    let omega = omega_of_wavelength(&exact(0.4), modulus, 5.0);
    let gamma = exact(0.4)
        .propagation_coefficient(modulus, omega)
        .unwrap()
        .found()
        .unwrap();
    let corrected = exact(0.4).modulus(gamma, omega).unwrap().found().unwrap();
    let change = Complex64::new(0.0, -0.008) * corrected.by_poisson_ratio / corrected.modulus.re;
    assert!((change.im + 0.0012).abs() < 5e-5, "{change}"); // to the printed digits
}

/// Compares the stated errors with the exact theory. Tolerance: the terms of order K³ and beyond
/// are up to a quarter of Love's error, of order K², at λ = 3D, and therefore 6 % of the whole
/// error.
#[test]
fn error_left_by_each_theory_is_that_against_the_exact_one() {
    for nu in [0.2, 0.3, 0.4, 0.5] {
        for ratio in [3.0, 4.0, 5.0, 8.0, 10.0, 20.0] {
            let stated = |theory: Theory| theory.error_left(ratio, nu).unwrap();
            let elementary = 0.01 * apparent_error_percent(&exact(nu), ratio);
            let wave = (PI / ratio).powi(2);
            let left_by_love = bar_number(&exact(nu), wave.into()).re
                / bar_number(&love(nu), wave.into()).re
                - 1.0;
            assert!(
                (stated(Theory::Elementary) / elementary - 1.0).abs() < 0.06,
                "{nu} {ratio} {elementary}"
            );
            assert!(
                (stated(Theory::LoveRayleigh) / left_by_love - 1.0).abs() < 0.25,
                "{nu} {ratio}: {left_by_love}"
            );
            assert!(stated(Theory::PochhammerChree).abs() < f64::MIN_POSITIVE);
        }
    }
}

/// Checks that γ is 0 at ω = 0 and the complex conjugate at -ω, and that the elementary modulus is
/// that of `medium`.
#[test]
fn conventions_are_those_of_the_medium() {
    let modulus = MODULUS * Complex64::new(1.0, 0.1);
    let theories: [&dyn RodTheory; 3] = [&love(0.4), &mindlin_herrmann(0.4), &exact(0.4)];
    for theory in theories {
        let gamma = |modulus, omega| {
            theory
                .propagation_coefficient(modulus, omega)
                .unwrap()
                .found()
                .unwrap()
        };
        assert_eq!(gamma(modulus, 0.0), Complex64::ZERO);
        let forward = gamma(modulus, 2e5);
        assert!(forward.re > 0.0 && forward.im > 0.0);
        assert!((gamma(modulus.conj(), -2e5) - forward.conj()).norm() < 1e-12 * forward.norm());
        let corrected = theory.modulus(forward, 2e5).unwrap().found().unwrap();
        let apparent = modulus_from_propagation(forward, 2e5, DENSITY).unwrap();
        assert!((corrected.apparent_modulus / apparent - 1.0).norm() < 1e-14);
    }
}

#[test]
fn unphysical_input_is_refused() {
    for nu in [-1.0, 0.51, f64::NAN] {
        let error = PochhammerChree::new(rod(nu)).unwrap_err();
        assert!(matches!(
            error,
            RodwaveError::NonPhysical {
                quantity: "Poisson's ratio",
                ..
            }
        ));
        assert!(MindlinHerrmann::new(rod(nu)).is_err() && LoveRayleigh::round(rod(nu)).is_err());
        assert!(
            Theory::Elementary.error_left(5.0, nu).is_err()
                && elementary_theory_error(5.0, nu).is_err()
        );
        assert!(rayleigh_to_shear_speed(nu).is_err());
    }
    let thin = RoundRod {
        diameter: 0.0,
        ..rod(0.4)
    };
    assert!(PochhammerChree::new(thin).is_err() && LoveRayleigh::round(thin).is_err());
    assert!(mindlin_herrmann(0.4).with_shear_coefficient(0.0).is_err());
    let theories: [&dyn RodTheory; 3] = [&love(0.4), &mindlin_herrmann(0.4), &exact(0.4)];
    for theory in theories {
        assert!(
            theory
                .propagation_coefficient(Complex64::ZERO, 1.0)
                .is_err()
        );
        assert!(
            theory
                .propagation_coefficient(MODULUS.into(), f64::NAN)
                .is_err()
        );
        assert!(
            theory
                .propagation_coefficient(MODULUS.into(), 1e300)
                .is_err()
        );
        assert!(theory.modulus(Complex64::ZERO, 1.0).is_err());
        assert!(theory.modulus(Complex64::I, 0.0).is_err());
        assert!(theory.modulus(Complex64::new(f64::NAN, 1.0), 1.0).is_err());
    }
    let corrected = love(0.4)
        .modulus(Complex64::I, 1e3)
        .unwrap()
        .found()
        .unwrap();
    assert!(corrected.standard_error(-0.1).is_err());
    assert!(Theory::LoveRayleigh.error_left(0.0, 0.4).is_err());
}

/// Checks an example of high losses in which two moduli have the same short wave on their first
/// branches. The documentation states which one is returned.
#[test]
fn short_wave_in_a_lossy_rod_has_two_moduli() {
    let (nu, bar) = (-0.2334730977594613, 5.8641233886872765);
    let modulus = MODULUS * Complex64::new(1.0, 0.5243893012060041);
    let omega = omega_of_bar_number(bar);
    let wave = |modulus| {
        let gamma = exact(nu).propagation_coefficient(modulus, omega);
        gamma.unwrap().found().unwrap()
    };
    let gamma = wave(modulus);
    let other = exact(nu)
        .modulus(gamma, omega)
        .unwrap()
        .found()
        .unwrap()
        .modulus;
    assert!((other / modulus - 1.0).norm() > 0.5, "{other}");
    assert!((wave(other) / gamma - 1.0).norm() < 1e-10); // both are roots to rounding
}

/// Checks that a modulus found from γ whose first branch does not have this γ is not returned, with
/// a heavily damped auxetic rod as an example.
#[test]
fn modulus_of_another_branch_is_withheld() {
    let gamma = Complex64::new(0.5, 1.0) * 1.95 / RADIUS;
    let outcome = exact(-0.9).modulus(gamma, 3e5).unwrap();
    assert_eq!(outcome, FirstBranch::Left { reached: 1.0 });
}

proptest! {
    /// Checks that a round trip through each theory gives the modulus again, and that a passive rod
    /// damps: α >= 0 if E'' >= 0.
    #[test]
    fn modulus_survives_the_round_trip(
        nu in 0.0..0.5f64,
        root_bar in 0.001..1.5f64,
        loss_factor in 0.0..1.0f64,
    ) {
        let modulus = MODULUS * Complex64::new(1.0, loss_factor);
        let omega = omega_of_bar_number(root_bar * root_bar);
        let theories: [&dyn RodTheory; 3] = [&love(nu), &mindlin_herrmann(nu), &exact(nu)];
        for theory in theories {
            let gamma = theory.propagation_coefficient(modulus, omega).unwrap().found().unwrap();
            prop_assert!(gamma.im > 0.0 && gamma.re >= -1e-12 * gamma.im, "{gamma}");
            let back = theory.modulus(gamma, omega).unwrap().found().unwrap().modulus;
            // tolerance: rounding, magnified if the second branch is near
            prop_assert!((back / modulus - 1.0).norm() < 1e-10, "{back} {modulus}");
        }
    }

    /// Checks that a modulus returned for a wave has this wave on its first branch, at any
    /// frequency and loss, even if other moduli have it too.
    #[test]
    fn modulus_leads_back_to_the_wave(
        nu in -0.9..0.5f64,
        root_wave in 0.001..6.0f64,
        attenuation in 0.0..0.5f64,
    ) {
        let gamma = Complex64::new(attenuation, 1.0) * root_wave / RADIUS;
        if let Some(found) = exact(nu).modulus(gamma, 3e5).unwrap().found() {
            let back = exact(nu).propagation_coefficient(found.modulus, 3e5).unwrap().found().unwrap();
            // tolerance: the method requires 1e-6 of γ²; most cases are much better
            prop_assert!((back / gamma - 1.0).norm() < 1e-6, "{back} {gamma}");
        }
    }

}
