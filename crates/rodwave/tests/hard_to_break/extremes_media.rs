//! Materials from almost lossless to almost fluid, rods from a millimetre to a kilometre, and
//! attenuation beyond the range of a double.

use num_complex::Complex64;
use rodwave::element::{CrossSection, Segment};
use rodwave::experiment::end_accelerations::{EndAccelerationTest, Specimen};
use rodwave::medium::{Medium, modulus_from_propagation, propagation_from_modulus};
use rodwave::modulus::{
    ComplexModulus, ConstantQ, FractionalZener, KelvinVoigt, LaplaceModulus, TimeDomainModulus,
    Zener,
};
use rodwave::{Chain, Termination};

/// α and k from half of the phase angle of the modulus, without a root of a complex number.
fn by_half_angle(storage: f64, loss_factor: f64, omega: f64, density: f64) -> (f64, f64) {
    let half = 0.5 * loss_factor.atan();
    let slowness = (density / (storage * loss_factor.hypot(1.0))).sqrt();
    (omega * slowness * half.sin(), omega * slowness * half.cos())
}

/// Checks that α and k are accurate to some units in their last place for tan δ from 1e-12 to 1e6
/// and 1 nHz to 1 THz, however small α is relative to k.
#[test]
fn damping_and_wave_number_keep_their_digits() {
    for exponent in -12..=6 {
        let loss_factor = 10f64.powi(exponent);
        for frequency_hz in [1e-9, 1e-3, 1.0, 1e4, 1e8, 1e12] {
            let omega = std::f64::consts::TAU * frequency_hz;
            let modulus = 3e9 * Complex64::new(1.0, loss_factor);
            let gamma = propagation_from_modulus(modulus, omega, 1150.0).unwrap();
            let (alpha, k) = by_half_angle(3e9, loss_factor, omega, 1150.0);
            assert!(
                (gamma.re / alpha - 1.0).abs() < 1e-15 * 8.0,
                "tan δ = {loss_factor:e}"
            );
            assert!(
                (gamma.im / k - 1.0).abs() < 1e-15 * 8.0,
                "tan δ = {loss_factor:e}"
            );
            // the reverse: E'' is proportional to the product kα and loses no digits
            let back = modulus_from_propagation(gamma, omega, 1150.0).unwrap();
            // E' is proportional to the difference k² - α²: its relative error grows with tan δ
            let lost = loss_factor.max(1.0);
            assert!(
                (back.re / modulus.re - 1.0).abs() < 1e-14 * lost,
                "tan δ = {loss_factor:e}"
            );
            assert!(
                (back.im / modulus.im - 1.0).abs() < 1e-14 * 2.0,
                "tan δ = {loss_factor:e}"
            );
        }
    }
}

/// Checks that laws whose loss factor has a closed form reproduce it from 1e-13 to 1e6.
#[test]
fn laws_keep_their_loss_factors() {
    for exponent in -12..=6 {
        let wanted = 10f64.powi(exponent);
        let omega = 1e4;
        // ωη/E
        let kelvin_voigt = KelvinVoigt::new(3e9, 3e9 * wanted / omega)
            .unwrap()
            .at(omega);
        assert!((kelvin_voigt.im / kelvin_voigt.re / wanted - 1.0).abs() < 1e-15);
    }
    for exponent in 0..=9 {
        // far below its relaxation, a Zener material has E''/E' = (E1/E0 - 1) ωτ
        let omega_tau = 10f64.powi(-exponent - 4);
        let modulus = Zener::new(1e9, 3e9, 1e-5).unwrap().at(omega_tau / 1e-5);
        let expected = 2.0 * omega_tau / (1.0 + omega_tau * omega_tau * 3.0);
        assert!((modulus.im / modulus.re / expected - 1.0).abs() < 1e-14);
    }
}

/// Checks that no wave returns from the far end at αL from 50 to 1e8, so that the mobility is that
/// of an infinite rod, and that no number overflows.
#[test]
fn strong_attenuation_leaves_an_infinite_rod() {
    for (loss_factor, length) in [(1e-3, 1e6), (0.1, 2e4), (1.0, 1e3), (10.0, 1e3)] {
        let medium = Medium::new(1150.0, ConstantQ::new(3e9, loss_factor, 1e4).unwrap()).unwrap();
        let section = CrossSection::of_area(1e-4).unwrap();
        for attenuation in [50.0, 700.0, 1e3, 1e4, 1e8] {
            // frequency at which αL has the wanted value: α grows almost in proportion to ω
            let mut omega = 1e4;
            for _ in 0..60 {
                omega *= attenuation / (medium.damping_coefficient(omega) * length);
            }
            let rod = Chain::from_impact_face().rod(&medium, section, length);
            let impedance = medium.specific_characteristic_impedance(omega) * 1e-4;
            for end in [
                Termination::Free,
                Termination::Fixed,
                Termination::Mass(3.0),
            ] {
                let chain = rod.clone().end(end).unwrap();
                let product = chain.mobility(omega).unwrap() * impedance;
                assert!(
                    (product - 1.0).norm() < 1e-14,
                    "tan δ {loss_factor}, αL {attenuation:e}: {product}"
                );
                let middle = chain
                    .section(0, 0.5 * length)
                    .unwrap()
                    .state(omega)
                    .unwrap();
                // e^{-αL/2} of the force, or less than a double can represent
                let expected = -0.5 * attenuation;
                if expected > -600.0 {
                    let found = middle.normal_force.norm().ln();
                    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
                } else {
                    assert!(middle.normal_force.norm() < 1e-200);
                }
            }
            // the plain matrix returns an error
            let matrix = Segment::rod(section, length)
                .unwrap()
                .transition_matrix(&medium, omega);
            assert_eq!(matrix.is_ok(), attenuation <= 700.0, "αL {attenuation:e}");
        }
    }
}

/// Checks that products of matrices that overflow although each factor is finite are rejected, not
/// returned as infinite.
#[test]
fn products_that_overflow_are_refused() {
    let medium = Medium::new(1150.0, ConstantQ::new(3e9, 0.1, 1e4).unwrap()).unwrap();
    let section = CrossSection::of_area(1e-4);
    let length = 600.0 / medium.damping_coefficient(1e4);
    let chain = Chain::from_impact_face()
        .rod(&medium, section.clone(), length)
        .rod(&medium, section, length)
        .end(Termination::Free)
        .unwrap();
    let error = chain.transition_matrix(1e4).unwrap_err().to_string();
    assert!(
        error.starts_with("magnitude of an entry of the matrix is"),
        "{error}"
    );
    assert!(chain.mobility(1e4).is_ok());
}

/// Checks that rods from a millimetre to a kilometre at frequencies from 1 nHz to 1 THz give a
/// number or, if no wave reaches the far end, an error.
#[test]
fn rods_of_all_lengths() {
    let medium = Medium::new(1150.0, ConstantQ::new(3e9, 0.05, 1e4).unwrap()).unwrap();
    let mut refused = 0;
    for length in [1e-3, 0.1, 1.0, 1e3] {
        for area in [1e-12, 1e-4, 1e3] {
            let specimen = Specimen {
                section: CrossSection::of_area(area).unwrap(),
                length,
                accelerometer_mass: 0.0,
            };
            let test = EndAccelerationTest::new(&medium, &specimen).unwrap();
            for exponent in -9..=12 {
                let omega = std::f64::consts::TAU * 10f64.powi(exponent);
                let gamma_length = medium.propagation_coefficient(omega) * length;
                match test.acceleration_ratio(omega) {
                    Ok(ratio) => {
                        // cosh x in parts, each of which is accurate; the phase is known only to
                        // its rounding
                        let (c, s) = (gamma_length.im.cos(), gamma_length.im.sin());
                        let (ch, sh) = (gamma_length.re.cosh(), gamma_length.re.sinh());
                        let expected = Complex64::new(ch * c, sh * s);
                        let rounding = 1e-14 * (1.0 + gamma_length.norm());
                        assert!(
                            (ratio - expected).norm() <= rounding * ch,
                            "{length} m, 1e{exponent} Hz"
                        );
                    }
                    Err(_) => {
                        assert!(gamma_length.re > 600.0, "αL = {}", gamma_length.re);
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(refused > 0); // no terahertz wave passes a kilometre of polymer
}

/// Checks the creep of a fractional Zener material of very small exponent, whose retardation time
/// overflows although the power of this time does not. E_α(-z) → 1/(1 + z) as α → 0, to O(α).
#[test]
fn creep_of_small_exponents() {
    for exponent in [1e-3, 1e-5, 1e-8] {
        let law = FractionalZener::new(1e8, 3e9, 1e-5, exponent).unwrap();
        let ratio = 30.0;
        let creep = law.creep_compliance(1e-5).unwrap();
        let decay = 1.0 / (1.0 + 1.0 / ratio);
        let expected = (1.0 - (1.0 - 1.0 / ratio) * decay) / 1e8;
        assert!(
            (creep / expected - 1.0).abs() < 2.0 * exponent + 1e-13,
            "{exponent:e}: {creep:e} {expected:e}"
        );
    }
}

/// Checks that a material has its unrelaxed modulus far above its relaxation, also where the square
/// of ωτ overflows.
#[test]
fn far_above_its_relaxation_a_material_is_its_glass() {
    for exponent in [10, 100, 150, 160, 200, 290] {
        let law = Zener::new(1e9, 3e9, 1.0).unwrap();
        let omega = 10f64.powi(exponent);
        for modulus in [law.at(omega), law.at_s(Complex64::new(omega, omega))] {
            assert!((modulus.re / 3e9 - 1.0).abs() < 1e-9);
            assert!(modulus.im >= 0.0 && modulus.im.is_finite());
        }
        let slope = law.slope(omega);
        assert!(slope.is_finite() && slope.norm() <= 2e9 * 10f64.powi(-exponent) * 1.1);
    }
}
