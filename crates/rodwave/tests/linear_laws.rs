//! Common tests of every linear law: symmetry, passivity, limits, analyticity, and the waves in a
//! medium with the law.
use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::medium::{Medium, PropagationLaw, modulus_from_propagation, propagation_from_modulus};
use rodwave::modulus::{
    ComplexModulus, ConstantQ, DifferentiableModulus, Elastic, FractionalMaxwell, FractionalZener,
    GeneralisedMaxwell, HavriliakNegami, KelvinVoigt, LaplaceModulus, Maxwell, MaxwellBranch,
    PowerLawPropagation, SpringPot, Tabulated, Zener,
};

use crate::bodies::{self, nylon, nylon_law};
use crate::modulus_derivatives::{Battery, every_law};

const DENSITY: f64 = 1150.0;

/// Frequencies from far below to far above every characteristic frequency of the laws below.
pub(crate) fn frequencies() -> impl Iterator<Item = f64> {
    (0..=60).map(|j| 10f64.powf(-1.0 + 0.15 * f64::from(j)))
}

fn prony() -> GeneralisedMaxwell {
    bodies::prony(2.4e9, &[(0.1e9, 1e-2), (0.2e9, 1e-3), (0.2e9, 1e-4)])
}

/// Law with its limits: E(0), and E(∞) if it is finite.
struct Case {
    name: &'static str,
    law: Box<dyn LaplaceModulus>,
    static_modulus: f64,
    unrelaxed_modulus: Option<f64>,
}

fn laplace_laws() -> [Case; 10] {
    fn case(
        name: &'static str,
        law: impl LaplaceModulus + 'static,
        static_modulus: f64,
        unrelaxed_modulus: Option<f64>,
    ) -> Case {
        let law = Box::new(law);
        Case {
            name,
            law,
            static_modulus,
            unrelaxed_modulus,
        }
    }
    let maxwell = Maxwell::new(2.7e9, 2.7e5).unwrap();
    let fluid = FractionalMaxwell::new(2.7e9, 1e-4, 0.5).unwrap();
    let kelvin_voigt = KelvinVoigt::new(2.7e9, 2.7e4).unwrap();
    let zener = Zener::new(2.5e9, 2.9e9, 1e-4).unwrap();
    let spring_pot = SpringPot::new(2.7e9, 0.4, 1e4).unwrap();
    let constant_q = ConstantQ::new(2.7e9, 0.1, 1e4).unwrap();
    let fractional = FractionalZener::new(2.5e9, 2.9e9, 1e-4, 0.5).unwrap();
    let negami = HavriliakNegami::new(2.5e9, 2.9e9, 1e-4, 0.6, 1.4).unwrap();
    let elastic = Elastic::new(2.7e9).unwrap();
    [
        case("elastic", elastic, 2.7e9, Some(2.7e9)),
        case("Maxwell", maxwell, 0.0, Some(2.7e9)),
        case("fractional Maxwell", fluid, 0.0, Some(2.7e9)),
        case("Kelvin-Voigt", kelvin_voigt, 2.7e9, None),
        case("Zener", zener, 2.5e9, Some(2.9e9)),
        case("Prony series", prony(), 2.4e9, Some(2.9e9)),
        case("spring-pot", spring_pot, 0.0, None),
        case("constant Q", constant_q, 0.0, None),
        case("fractional Zener", fractional, 2.5e9, Some(2.9e9)),
        case("Havriliak-Negami", negami, 2.5e9, Some(2.9e9)),
    ]
}

/// Table of the Nylon-6 of paper E, narrower than the frequencies of the tests.
fn table() -> Tabulated {
    let medium = nylon();
    let omega: Vec<f64> = (0..20).map(|j| 1e3 * 1.3f64.powi(j)).collect();
    let modulus: Vec<_> = omega.iter().map(|&omega| medium.modulus(omega)).collect();
    Tabulated::new(&omega, &modulus).unwrap()
}

fn close(a: Complex64, b: Complex64, relative: f64) -> bool {
    (a - b).norm() <= relative * b.norm()
}

#[test]
fn moduli_are_conjugate_symmetric_passive_and_reach_their_limits() {
    for case in laplace_laws() {
        let Case { name, law, .. } = &case;
        for omega in frequencies() {
            let modulus = law.at(omega);
            assert_eq!(law.at(-omega), modulus.conj(), "{name} at {omega}");
            assert!(modulus.im >= 0.0 && modulus.re > 0.0, "{name} at {omega}");
            assert_eq!(law.slope(-omega), law.slope(omega).conj(), "{name}");
        }
        let static_modulus = Complex64::from(case.static_modulus);
        assert_eq!(law.at(0.0), static_modulus, "{name}");
        assert_eq!(law.slope(0.0), Complex64::ZERO, "{name}");
        // The law that approaches its limit most slowly, as ω^0.06, is within (1e-304)^0.06 = 1e-18
        // of it.
        assert!(
            (law.at(1e-300) - static_modulus).norm() < 1e-9 * 2.7e9,
            "{name}"
        );
        // The law that approaches E(∞) most slowly, as ω^-0.5, is within (1e96)^-0.5 of it.
        if let Some(unrelaxed_modulus) = case.unrelaxed_modulus {
            assert!(
                (law.at(1e100) - unrelaxed_modulus).norm() < 1e-9 * 2.7e9,
                "{name}"
            );
        } else {
            assert!(law.at(1e100).norm() > 1e5 * 2.7e9, "{name}");
        }
    }
}

/// Checks that the values of `at_s` equal those of `at` on the frequency axis, are real on the real
/// axis, and obey the Cauchy-Riemann equations between the two axes.
#[test]
fn laplace_laws_are_analytic_in_the_right_half_plane() {
    for Case { name, law, .. } in laplace_laws() {
        for omega in frequencies() {
            assert_eq!(
                law.at_s(Complex64::new(0.0, omega)),
                law.at(omega),
                "{name}"
            );
            assert_eq!(law.at_s(Complex64::new(omega, 0.0)).im, 0.0, "{name}");
            let s = Complex64::new(0.6 * omega, 0.8 * omega);
            assert_eq!(law.at_s(s.conj()), law.at_s(s).conj(), "{name}");
            let h = 1e-4 * omega;
            let along = (law.at_s(s + h) - law.at_s(s - h)) / (2.0 * h);
            let ih = Complex64::new(0.0, h);
            let across = (law.at_s(s + ih) - law.at_s(s - ih)) / (2.0 * ih);
            // Tolerance: central differences at h = 1e-4 |s| have a truncation error of 1e-8 and a
            // rounding error of 1e-12 of E/|s|.
            assert!(
                (along - across).norm() < 1e-7 * law.at_s(s).norm() / omega,
                "{name} at {s}"
            );
        }
    }
}

/// Checks that a wave in a passive medium decays, and that it decays faster in the damped
/// transform.
struct WavesDecay;

impl Battery for WavesDecay {
    fn run<M: DifferentiableModulus + Clone>(&self, name: &str, law: M) {
        let medium = Medium::new(DENSITY, law).unwrap();
        for omega in frequencies() {
            let axis = medium.propagation_coefficient(omega);
            let inside = medium.propagation_coefficient_at_s(Complex64::new(0.1 * omega, omega));
            assert!(inside.re > axis.re && inside.im > 0.0, "{name} at {omega}");
            let impedance =
                medium.specific_characteristic_impedance_at_s(Complex64::new(0.0, omega));
            assert_eq!(
                impedance,
                medium.specific_characteristic_impedance(omega),
                "{name}"
            );
        }
    }
}

#[test]
fn waves_decay_along_x_in_the_right_half_plane() {
    every_law(&WavesDecay);
}

/// Checks paper E, eqs. 4-6, and the statements below them for a law of a medium.
fn medium_battery<L: PropagationLaw>(name: &str, law: L) {
    let medium = Medium::new(DENSITY, law).unwrap();
    assert_eq!(
        medium.propagation_coefficient(0.0),
        Complex64::ZERO,
        "{name}"
    );
    for omega in frequencies() {
        let gamma = medium.propagation_coefficient(omega);
        let modulus = medium.modulus(omega);
        assert!(
            gamma.re >= 0.0 && gamma.im > 0.0,
            "{name} at {omega}: {gamma}"
        );
        assert!(modulus.im >= 0.0, "{name} at {omega}: {modulus}");
        // Tolerance: about six roundings each; 1e-14 is 45 units in the last place.
        let balance = gamma * gamma * modulus;
        assert!(
            close(balance, Complex64::from(-DENSITY * omega * omega), 1e-14),
            "{name}"
        );
        let impedance = medium.specific_characteristic_impedance(omega);
        assert!(
            close(
                impedance * gamma,
                Complex64::new(0.0, omega * DENSITY),
                1e-14
            ),
            "{name}"
        );
        // eq. 6 in its printed form
        let per_area = DENSITY * omega / gamma.norm_sqr();
        let printed = Complex64::new(per_area * gamma.im, per_area * gamma.re);
        assert!(close(impedance, printed, 1e-14), "{name} at {omega}");

        assert_eq!(
            medium.propagation_coefficient(-omega),
            gamma.conj(),
            "{name}"
        );
        assert_eq!(medium.modulus(-omega), modulus.conj(), "{name}");
        assert_eq!(medium.damping_coefficient(-omega), gamma.re, "{name}");
        assert_eq!(medium.wave_number(-omega), -gamma.im, "{name}");
        assert_eq!(medium.phase_velocity(-omega), omega / gamma.im, "{name}");
        let group_velocity = medium.group_velocity(omega);
        assert!(group_velocity > 0.0, "{name} at {omega}");
        assert_eq!(medium.group_velocity(-omega), group_velocity, "{name}");

        let back = modulus_from_propagation(gamma, omega, DENSITY).unwrap();
        assert!(close(back, modulus, 1e-14), "{name} at {omega}");
        let again = propagation_from_modulus(back, omega, DENSITY).unwrap();
        assert!(close(again, gamma, 1e-14), "{name} at {omega}");
    }
}

struct Relations;

impl Battery for Relations {
    fn run<M: DifferentiableModulus + Clone>(&self, name: &str, law: M) {
        medium_battery(name, law);
    }
}

#[test]
fn every_medium_obeys_the_relations_of_paper_e() {
    every_law(&Relations);
    medium_battery("table", table().held());
    medium_battery("power laws of Nylon-6", nylon_law());
    medium_battery(
        "power laws without losses",
        PowerLawPropagation::new(0.0, 1.0, 6e-4, 1.0).unwrap(),
    );
}

#[test]
fn at_zero_frequency_every_quantity_is_its_limit() {
    let maxwell = Medium::new(DENSITY, Maxwell::new(2.7e9, 2.7e5).unwrap()).unwrap();
    assert_eq!(maxwell.phase_velocity(0.0), 0.0);
    assert_eq!(
        maxwell.specific_characteristic_impedance(0.0),
        Complex64::ZERO
    );
    let zener = Medium::new(DENSITY, Zener::new(2.5e9, 2.9e9, 1e-4).unwrap()).unwrap();
    // The dispersion at ωτ = 1e-7 is of order (ωτ)² = 1e-14.
    assert!((zener.phase_velocity(0.0) / zener.phase_velocity(1e-3) - 1.0).abs() < 1e-13);
    let nylon = nylon();
    assert_eq!(nylon.modulus(0.0), Complex64::ZERO);
    let straight = PowerLawPropagation::new(1e-9, 2.0, 6e-4, 1.0).unwrap();
    let limit = Medium::new(DENSITY, straight).unwrap().modulus(0.0);
    assert!(close(
        limit,
        Complex64::from(DENSITY / 6e-4f64.powi(2)),
        1e-14
    ));
}

#[test]
fn impossible_materials_are_refused() {
    let quantity = |error: RodwaveError| match error {
        RodwaveError::NonPhysical { quantity, .. } => quantity,
        other => panic!("unexpected {other}"),
    };
    let branch = |modulus, relaxation_time| MaxwellBranch {
        modulus,
        relaxation_time,
    };
    let cases = [
        (Elastic::new(0.0).unwrap_err(), "Young's modulus [Pa]"),
        (Elastic::new(f64::NAN).unwrap_err(), "Young's modulus [Pa]"),
        (Maxwell::new(1e9, -1.0).unwrap_err(), "viscosity [Pa s]"),
        (
            KelvinVoigt::new(1e9, f64::INFINITY).unwrap_err(),
            "viscosity [Pa s]",
        ),
        (
            Zener::new(2e9, 2e9, 1e-3).unwrap_err(),
            "unrelaxed modulus [Pa]",
        ),
        (
            PowerLawPropagation::new(-1e-5, 0.9, 9e-4, 0.97).unwrap_err(),
            "factor of the damping coefficient [s^p/m]",
        ),
        (
            PowerLawPropagation::new(1e-5, 0.9, 9e-4, 1.01).unwrap_err(),
            "exponent of the wave number",
        ),
        (
            GeneralisedMaxwell::new(-1.0, Vec::new()).unwrap_err(),
            "equilibrium modulus [Pa]",
        ),
        (
            GeneralisedMaxwell::new(0.0, Vec::new()).unwrap_err(),
            "unrelaxed modulus [Pa]",
        ),
        (
            GeneralisedMaxwell::new(1e9, vec![branch(-1.0, 1.0)]).unwrap_err(),
            "modulus of a branch [Pa]",
        ),
        (
            GeneralisedMaxwell::new(1e9, vec![branch(1.0, f64::NAN)]).unwrap_err(),
            "relaxation time of a branch [s]",
        ),
        (
            SpringPot::new(1e9, 1.0, 1.0).unwrap_err(),
            "exponent of the modulus",
        ),
        (ConstantQ::new(1e9, -0.1, 1.0).unwrap_err(), "loss factor"),
        (
            FractionalZener::new(1e9, 2e9, 1.0, 1.1).unwrap_err(),
            "exponent of the relaxation",
        ),
        (
            HavriliakNegami::new(1e9, 2e9, 1.0, 0.6, 1.7).unwrap_err(),
            "product of breadth and skewness exponents",
        ),
        (
            Medium::new(-1.0, nylon_law()).unwrap_err(),
            "density [kg/m^3]",
        ),
        (
            modulus_from_propagation(Complex64::ZERO, 1.0, 1.0).unwrap_err(),
            "magnitude of the propagation coefficient [1/m]",
        ),
        (
            propagation_from_modulus(Complex64::new(1e9, 0.0), f64::NAN, 1.0).unwrap_err(),
            "angular frequency [rad/s]",
        ),
    ];
    for (error, expected) in cases {
        assert_eq!(quantity(error), expected);
    }
}

/// Checks E'' of fractional models far above their relaxation, to the last digits: with p = (ωτ)^α
/// e^{iπα/2}, it is ΔE Im p/|1 + p|².
#[test]
fn l9_loss_far_above_a_fractional_relaxation_keeps_its_digits() {
    let (increment, time) = (1.6e9, 1.0);
    for alpha in [0.3, 0.5, 0.8, 1.0] {
        let law = FractionalZener::new(1.8e9, 1.8e9 + increment, time, alpha).unwrap();
        let fluid = FractionalMaxwell::new(increment, time, alpha).unwrap();
        for decade in [-6, 0, 3, 6, 9, 12, 15, 18, 30] {
            let omega = 10f64.powi(decade);
            let size = omega.powf(alpha);
            let (sine, cosine) = (0.5 * std::f64::consts::PI * alpha).sin_cos();
            // |1 + p|² over |p|, which does not overflow
            let exact = increment * sine / (1.0 / size + 2.0 * cosine + size);
            for loss in [law.at(omega).im, fluid.at(omega).im] {
                assert!(
                    (loss / exact - 1.0).abs() < 1e-12,
                    "{alpha} 1e{decade}: {loss:e} {exact:e}"
                );
            }
        }
    }
}

/// Checks a Havriliak-Negami model with a very small skewness exponent, which is ΔE β ln(1 + p),
/// and ΔE β p far below its relaxation. Neither value may be lost in the difference between 1 and a
/// number close to 1.
#[test]
fn l9_small_shares_of_a_skew_relaxation_keep_their_digits() {
    let (time, alpha) = (1e-4, 0.6);
    for beta in [1e-4, 1e-8, 1e-15] {
        let law = HavriliakNegami::new(1e9, 1e9 + 1e9 / beta, time, alpha, beta).unwrap();
        for omega in [1e2, 1e4, 1e7] {
            let power = Complex64::new(0.0, omega * time).powf(alpha);
            let logarithm = (1.0 + power).ln();
            // the next terms are (β ln)²/2 and (β ln)³/6
            let z = beta * logarithm;
            let exact = 1e9 / beta * z * (1.0 - 0.5 * z + z * z / 6.0);
            let found = law.at(omega) - 1e9;
            // tolerance: the increment 1e9/β, computed as a difference of moduli, has lost its last
            // digits; the fourth term is 4e-11 at β = 1e-4
            assert!(
                (found - exact).norm() < 1e-10 * exact.norm(),
                "{beta} {omega}: {found} {exact}"
            );
        }
    }
    let law = HavriliakNegami::new(1e3, 1e15, 1.0, alpha, 0.5).unwrap();
    let power = Complex64::new(0.0, 1e-25).powf(alpha);
    let loss = law.at(1e-25).im;
    assert!(
        (loss / (1e15 * 0.5 * power.im) - 1.0).abs() < 1e-10,
        "{loss:e}"
    );
}
