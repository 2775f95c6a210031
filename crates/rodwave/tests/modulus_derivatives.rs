//! Exact derivatives compared with differences: with respect to every parameter and to frequency,
//! and those in the group velocity.
use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::medium::{Medium, PropagationLaw};
use rodwave::modulus::{
    ComplexModulus, ConstantQ, DifferentiableModulus, Elastic, FractionalZener, HavriliakNegami,
    KelvinVoigt, Maxwell, SpringPot, Tabulated, Zener,
};

use crate::bodies::{self, nylon, nylon_law, steel};

/// Frequencies within three decades on either side of 1/τ = ω₀ = 10⁴ rad/s, of either sign, and 0.
fn frequencies() -> Vec<f64> {
    let positive: Vec<f64> = (-12..=12)
        .map(|j| 1e4 * 10f64.powf(0.25 * f64::from(j)))
        .collect();
    let negative = positive.iter().map(|omega| -omega);
    [0.0]
        .into_iter()
        .chain(negative)
        .chain(positive.clone())
        .collect()
}

/// Derivative of `function` at 0 by a fourth-order difference.
fn difference(step: f64, function: impl Fn(f64) -> Complex64) -> Complex64 {
    let odd = |h: f64| function(h) - function(-h);
    (8.0 * odd(step) - odd(2.0 * step)) / (12.0 * step)
}

/// Tests that every law must pass.
pub(crate) trait Battery {
    fn run<M: DifferentiableModulus + Clone>(&self, name: &str, law: M);
}

pub(crate) fn every_law(battery: &impl Battery) {
    let branches = [(0.1e9, 1e-2), (0.2e9, 1e-3), (0.2e9, 1e-4)];
    let [solid, fluid] = [2.4e9, 0.0].map(|spring| bodies::prony(spring, &branches));
    let negami = HavriliakNegami::new(2.5e9, 2.9e9, 1e-4, 0.6, 1.4).unwrap();
    let fractional = FractionalZener::new(2.5e9, 2.9e9, 1e-4, 0.5).unwrap();
    battery.run("elastic", Elastic::new(2.7e9).unwrap());
    battery.run("Maxwell", Maxwell::new(2.7e9, 2.7e5).unwrap());
    battery.run("Kelvin-Voigt", KelvinVoigt::new(2.7e9, 2.7e4).unwrap());
    battery.run("Zener", Zener::new(2.5e9, 2.9e9, 1e-4).unwrap());
    battery.run("Prony series, solid", solid);
    battery.run("Prony series, fluid", fluid);
    battery.run("spring-pot", SpringPot::new(2.7e9, 0.4, 1e4).unwrap());
    battery.run("constant Q", ConstantQ::new(2.7e9, 0.1, 1e4).unwrap());
    battery.run("fractional Zener", fractional);
    battery.run("Havriliak-Negami", negami);
}

struct GradientsAreDerivatives;

impl Battery for GradientsAreDerivatives {
    fn run<M: DifferentiableModulus + Clone>(&self, name: &str, law: M) {
        let parameters = law.parameters();
        let names = law.parameter_names();
        assert_eq!(names.len(), parameters.len(), "{name}");
        let mut derivatives = vec![Complex64::ZERO; parameters.len()];
        for omega in frequencies() {
            let modulus = law.gradient(omega, &mut derivatives).unwrap();
            assert_eq!(modulus, law.at(omega), "{name}");
            for (index, derivative) in derivatives.iter().enumerate() {
                let differenced = difference(3e-4, |h| {
                    let mut moved = parameters.clone();
                    moved[index] += h;
                    law.with_parameters(&moved).unwrap().at(omega)
                });
                // Tolerance: truncation h⁴/30 = 3e-16 times a fifth derivative of at most E (ln
                // ωτ)⁵ = 2e4 E; rounding 4e-15 of a parameter ln E = 22 over h, 1e-11 E.
                let scale = law.at(omega).norm();
                assert!(
                    (derivative - differenced).norm() <= 1e-10 * scale,
                    "{name}: ∂E/∂{} at {omega} is {derivative}, by difference {differenced}",
                    names[index]
                );
            }
        }
    }
}

#[test]
fn gradients_are_the_derivatives_by_the_parameters() {
    every_law(&GradientsAreDerivatives);
}

struct ParametersRoundTrip;

impl Battery for ParametersRoundTrip {
    fn run<M: DifferentiableModulus + Clone>(&self, name: &str, law: M) {
        let parameters = law.parameters();
        let again = law.with_parameters(&parameters).unwrap();
        for omega in frequencies() {
            // Tolerance: exp(ln p) equals p except for the rounding of ln p = 22, 2e-15, times some
            // factors.
            let change = (again.at(omega) - law.at(omega)).norm();
            assert!(change <= 2e-14 * law.at(omega).norm(), "{name} at {omega}");
        }
        let mut one_more = parameters.clone();
        one_more.push(0.0);
        let mismatch = |found, expected| RodwaveError::LengthMismatch {
            what: "array of parameters",
            found,
            expected,
        };
        let n = parameters.len();
        assert_eq!(
            law.with_parameters(&one_more).err(),
            Some(mismatch(n + 1, n)),
            "{name}"
        );
        let mut too_short = vec![Complex64::ZERO; n - 1];
        assert!(law.gradient(1.0, &mut too_short).is_err(), "{name}");
        for index in 0..n {
            let mut broken = parameters.clone();
            broken[index] = f64::NAN;
            let outcome = law.with_parameters(&broken);
            assert!(
                matches!(outcome, Err(RodwaveError::NonPhysical { .. })),
                "{name}: parameter {index}"
            );
        }
    }
}

#[test]
fn parameters_make_the_law_and_wrong_ones_are_refused() {
    every_law(&ParametersRoundTrip);
}

/// Law that implements only its value; the trait computes the slope.
struct ValueOnly<M>(M);

impl<M: ComplexModulus> ComplexModulus for ValueOnly<M> {
    fn at(&self, omega: f64) -> Complex64 {
        self.0.at(omega)
    }
}

struct SlopesAreDerivatives;

impl Battery for SlopesAreDerivatives {
    fn run<M: DifferentiableModulus + Clone>(&self, name: &str, law: M) {
        let law = ValueOnly(law);
        for omega in frequencies() {
            let (exact, differenced) = (law.0.slope(omega), law.slope(omega));
            // The documented error of the difference is 3e-14 by truncation and 3e-13 by rounding;
            // the tolerance is larger.
            assert!(
                (exact - differenced).norm() <= 2e-12 * law.at(omega).norm(),
                "{name} at {omega}: {exact}, by difference {differenced}"
            );
        }
    }
}

#[test]
fn slopes_are_the_derivatives_by_frequency() {
    every_law(&SlopesAreDerivatives);
}

/// Propagation law that implements only its value.
struct WavesOnly<L>(L);

impl<L: PropagationLaw> PropagationLaw for WavesOnly<L> {
    fn propagation_coefficient(&self, omega: f64, density: f64) -> Complex64 {
        self.0.propagation_coefficient(omega, density)
    }

    fn modulus(&self, omega: f64, density: f64) -> Complex64 {
        self.0.modulus(omega, density)
    }
}

fn check_group_velocity<L: PropagationLaw + Clone>(name: &str, law: L) {
    let exact = Medium::new(1150.0, law.clone()).unwrap();
    let differenced = Medium::new(1150.0, WavesOnly(law)).unwrap();
    for omega in frequencies() {
        let ratio = if omega == 0.0 && exact.group_velocity(omega) == 0.0 {
            1.0 // for a fluid, both vanish
        } else {
            differenced.group_velocity(omega) / exact.group_velocity(omega)
        };
        // Tolerance: as for the slope, with γ in place of E; k is of the magnitude of γ unless the
        // loss is large.
        assert!((ratio - 1.0).abs() < 1e-11, "{name} at {omega}");
    }
}

struct GroupVelocities;

impl Battery for GroupVelocities {
    fn run<M: DifferentiableModulus + Clone>(&self, name: &str, law: M) {
        check_group_velocity(name, law);
    }
}

#[test]
fn group_velocity_is_the_derivative_of_frequency_by_wave_number() {
    every_law(&GroupVelocities);
    check_group_velocity("power laws of Nylon-6", nylon_law());
    // k = b ω^q: c_g = c/q
    let medium = nylon();
    assert!((medium.group_velocity(1e4) / medium.phase_velocity(1e4) * 0.970 - 1.0).abs() < 1e-14);
    // Without dispersion, the group and the phase velocity are equal.
    let steel = steel();
    assert!((steel.group_velocity(1e4) / steel.phase_velocity(1e4) - 1.0).abs() < 1e-15);
}

/// Checks that the slope of a table is that of its interpolation. The frequencies are further from
/// the points than the ±0.2 % of the difference.
#[test]
fn slope_of_a_table_is_that_of_its_interpolation() {
    let medium = nylon();
    let omega: Vec<f64> = (0..20).map(|j| 1e3 * 1.3f64.powi(j)).collect();
    let modulus: Vec<_> = omega.iter().map(|&omega| medium.modulus(omega)).collect();
    let law = ValueOnly(Tabulated::new(&omega, &modulus).unwrap().held());
    for omega in omega.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])) {
        let change = (law.0.slope(omega) - law.slope(omega)).norm();
        // Tolerance: within an interval, the difference is exact for a cubic; rounding causes
        // 3e-13.
        assert!(change < 2e-12 * law.at(omega).norm(), "{omega}");
    }
}
