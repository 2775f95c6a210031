//! The frequency equation of Pochhammer and Chree for longitudinal waves in a cylinder, and its
//! derivatives.
//!
//! In its textbook form
//!
//! ```text
//! (2p/a)(q² + k²) J₁(pa) J₁(qa) - (q² - k²)² J₀(pa) J₁(qa) - 4k²pq J₁(pa) J₀(qa) = 0
//! p² = ρω²/(λ+2μ) - k² ,    q² = ρω²/μ - k²
//! ```
//!
//! it has branch points at p = 0 and q = 0 and the trivial root q = 0. With X = (pa)², Y = (qa)²
//! and the entire functions jₙ(z²) = Jₙ(z)/zⁿ it is, divided by qa,
//!
//! ```text
//! 2X j₁(X) (Y + K) j₁(Y) - (Y - K)² j₀(X) j₁(Y) - 4K X j₁(X) j₀(Y) = 0
//! X = B (1+ν)(1-2ν)/(1-ν) - K ,    Y = 2(1+ν)B - K
//! ```
//!
//! which is analytic in B = ρω²a²/E, K = k²a² and ν and regular up to ν = 1/2. The left side
//! vanishes at B = 0 for every K; here the equation is solved after division by B. In the limit of
//! thin rods it is proportional to K - B.

use complex_bessel::besselj_scaled;
use num_complex::Complex64;

use crate::numerics::Jet;

/// Variable that changes while the other two are constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Variable {
    /// B = ρω²a²/E
    Bar,
    /// K = -γ²a²
    Wave,
    /// ν
    PoissonRatio,
}

/// Frequency equation at one point (B, K, ν), times the positive factor exp(-|Im pa| - |Im qa|).
#[derive(Debug, Clone, Copy)]
pub(super) struct FrequencyEquation {
    bar: Complex64,
    wave: Complex64,
    poisson_ratio: f64,
    /// j₀, j₁, j₂ at X
    dilatation: [Complex64; 3],
    /// j₀, j₁, j₂, j₃ at Y
    shear: [Complex64; 4],
}

impl FrequencyEquation {
    /// Evaluates the equation at B = `bar` and K = `wave`; `None` for |pa| or |qa| above about 10⁹,
    /// where the Bessel functions fail.
    pub(super) fn at(bar: Complex64, wave: Complex64, poisson_ratio: f64) -> Option<Self> {
        let x = (1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio) / (1.0 - poisson_ratio) * bar
            - wave;
        let y = 2.0 * (1.0 + poisson_ratio) * bar - wave;
        Some(Self {
            bar,
            wave,
            poisson_ratio,
            dilatation: entire_bessel(x)?,
            shear: entire_bessel(y)?,
        })
    }

    /// Returns the left side, divided by B, with its derivatives along `variable`.
    pub(super) fn along(&self, variable: Variable) -> Jet {
        let slope = |of: Variable| if variable == of { 1.0 } else { 0.0 };
        let b = Jet::linear(self.bar, slope(Variable::Bar));
        let k = Jet::linear(self.wave, slope(Variable::Wave));
        let nu = Jet::linear(self.poisson_ratio.into(), slope(Variable::PoissonRatio));
        let one = Jet::linear(Complex64::ONE, 0.0);

        let x = (one + nu) * (one - nu * 2.0) / (one - nu) * b - k;
        let y = (one + nu) * 2.0 * b - k;
        // jₙ' = -½ jₙ₊₁, and (X j₁)' = ½ j₀
        let [p0, p1, p2] = self.dilatation;
        let [q0, q1, q2, q3] = self.shear;
        let j0_x = x.compose([p0, -0.5 * p1, 0.25 * p2]);
        let x_j1_x = x.compose([x.value * p1, 0.5 * p0, -0.25 * p1]);
        let j0_y = y.compose([q0, -0.5 * q1, 0.25 * q2]);
        let j1_y = y.compose([q1, -0.5 * q2, 0.25 * q3]);

        let left = x_j1_x * 2.0 * (y + k) * j1_y
            - (y - k) * (y - k) * j0_x * j1_y
            - k * 4.0 * x_j1_x * j0_y;
        left / b
    }
}

/// Computes jₙ(z²) = Jₙ(z)/zⁿ for n = 0, 1, ..., times exp(-|Im z|), at z² = `argument`.
fn entire_bessel<const N: usize>(argument: Complex64) -> Option<[Complex64; N]> {
    let z = argument.sqrt();
    // jₙ = (1 - z²/(4n+4) + ...)/(2ⁿ n!): below this limit only the first term matters, and zⁿ may
    // underflow
    let is_small = argument.norm() < 1e-16;
    let mut values = [Complex64::ZERO; N];
    let mut power = Complex64::ONE;
    let mut limit = 1.0;
    let mut order = 0.0;
    for value in &mut values {
        *value = if is_small {
            limit.into()
        } else {
            besselj_scaled(order, z).ok()? / power
        };
        order += 1.0;
        power *= z;
        limit /= 2.0 * order;
    }
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with values of exp(-|Im z|) Jₙ(z), n = 0...3, by mpmath 1.3.0 with 40 digits.
    #[test]
    fn bessel_functions_are_those_of_mpmath() {
        type Parts = (f64, f64);
        let rows: [(Parts, [Parts; 4]); 7] = [
            (
                (0.3, 0.1),
                [
                    (0.88678039403452635, -0.013437202918100178),
                    (0.13470739760844581, 0.043778944103493152),
                    (0.0090218798231348175, 0.0066960723221674541),
                    (0.00033944955784182494, 0.00048640446997702484),
                ],
            ),
            (
                (1.5, -0.4),
                [
                    (0.35064448041541201, 0.15250032962321733),
                    (0.39585536013826202, -0.038059275246959201),
                    (0.15475531236979688, -0.068472751876440551),
                    (0.034886663604927253, -0.029670190092031789),
                ],
            ),
            (
                (0.0, 3.0),
                [
                    (0.2430003541618254, 0.0),
                    (0.0, 0.19682671329730085),
                    (-0.11178254529695816, 0.0),
                    (0.0, -0.047783319568023303),
                ],
            ),
            (
                (5.0, -2.0),
                [
                    (-0.058158170586051642, -0.16135206245113317),
                    (-0.166287623863441, 0.037989214358601102),
                    (-0.0044222810025281641, 0.15151556755914169),
                    (0.12144037694883076, 0.065284340922868156),
                ],
            ),
            (
                (12.0, 7.0),
                [
                    (0.049165250995728595, 0.095598441527574875),
                    (-0.092344159676075949, 0.051317170504297296),
                    (-0.056925973509540308, -0.082518491643801826),
                    (0.066214809963721618, -0.063581213720024545),
                ],
            ),
            (
                (30.0, -25.0),
                [
                    (-0.018026205266116891, -0.061378050473243443),
                    (-0.061054754282982899, 0.017270022112717164),
                    (0.015057820766041591, 0.060055731530695171),
                    (0.058301551226494685, -0.011556927122364652),
                ],
            ),
            (
                (0.5, -40.0),
                [
                    (0.055719424043032128, 0.029986157428210032),
                    (0.02961780442334899, -0.055013830336080571),
                    (-0.052950654018779796, -0.028539876832345736),
                    (-0.026830440583237909, 0.049683922886201203),
                ],
            ),
        ];
        for ((re, im), references) in rows {
            let z = Complex64::new(re, im);
            let found: [Complex64; 4] = entire_bessel(z * z).unwrap();
            for (n, (value, reference)) in (0..).zip(found.iter().zip(references)) {
                let reference = Complex64::new(reference.0, reference.1);
                let error = (value * z.powi(n) - reference).norm() / reference.norm();
                // tolerance: rounding of z² and √ at |z| = 40 changes the phase by 40 eps; the
                // functions themselves are accurate to 1e-15
                assert!(error < 2e-14, "J{n}({z}): {error:e}");
            }
        }
    }

    /// Checks that the functions agree on both sides of the limit below which only the first term
    /// of their series is used.
    #[test]
    fn small_arguments_need_no_division() {
        let above: [Complex64; 4] = entire_bessel(1.01e-16.into()).unwrap();
        let below: [Complex64; 4] = entire_bessel(0.99e-16.into()).unwrap();
        let at_zero: [Complex64; 4] = entire_bessel(Complex64::ZERO).unwrap();
        for n in 0..4 {
            // tolerance: Jₙ of the library computes zⁿ from a logarithm, which costs n |ln z| = 55
            // roundings
            let jump = (above[n] / below[n] - 1.0).norm();
            assert!(jump < 2e-14, "J{n}: {jump:e}");
            assert_eq!(below[n], at_zero[n]);
        }
    }

    /// Compares both derivatives along all three variables with central differences. The
    /// exponential scaling is not analytic. The differences are therefore taken where the scale
    /// factor is 1: at real points with real p and q.
    #[test]
    fn derivatives_agree_with_differences() {
        let (bar, wave, nu) = (4.0, 0.9, 0.3);
        let value = |b: f64, k: f64, nu: f64| {
            FrequencyEquation::at(b.into(), k.into(), nu)
                .unwrap()
                .along(Variable::Bar)
                .value
        };
        let equation = FrequencyEquation::at(bar.into(), wave.into(), nu).unwrap();
        let h = 1e-4;
        for (variable, [db, dk, dnu]) in [
            (Variable::Bar, [h, 0.0, 0.0]),
            (Variable::Wave, [0.0, h, 0.0]),
            (Variable::PoissonRatio, [0.0, 0.0, h]),
        ] {
            let jet = equation.along(variable);
            let right = value(bar + db, wave + dk, nu + dnu);
            let left = value(bar - db, wave - dk, nu - dnu);
            let first = (right - left) / (2.0 * h);
            let second = (right - 2.0 * jet.value + left) / (h * h);
            // tolerance: truncation h² times third and fourth derivatives of order 10; rounding
            // eps/h² = 2e-8 in the second
            assert!((jet.first - first).norm() < 1e-6, "{variable:?}");
            assert!((jet.second - second).norm() < 1e-5, "{variable:?}");
        }
    }

    /// Checks that the equation is regular at p = 0, q = 0 and ν = 1/2, where its textbook form has
    /// a branch point, a trivial root or an infinite λ.
    #[test]
    fn equation_is_regular_where_p_or_q_vanish() {
        let nu = 0.3;
        let p_zero = 0.9 * 1.3 * 0.4 / 0.7;
        let q_zero = 0.9 * 2.0 * 1.3;
        for wave in [p_zero, q_zero] {
            let at = |k: f64| {
                let equation = FrequencyEquation::at(0.9.into(), k.into(), nu).unwrap();
                let scale = (p_zero - k).min(0.0).abs().sqrt() + (q_zero - k).min(0.0).abs().sqrt();
                scale.exp() * equation.along(Variable::Wave).value
            };
            let (left, middle, right) = (at(wave - 1e-4), at(wave), at(wave + 1e-4));
            // tolerance: h² times the second derivative, of order 1; with a singularity like a
            // root, h^½ = 1e-2 would remain
            assert!((middle - 0.5 * (left + right)).norm() < 1e-7);
            assert!(middle.norm() > 1e-2); // q = 0 is no root
        }
        let incompressible = FrequencyEquation::at(0.9.into(), 1.0.into(), 0.5).unwrap();
        let nearly = FrequencyEquation::at(0.9.into(), 1.0.into(), 0.5 - 1e-9).unwrap();
        let change =
            incompressible.along(Variable::Wave).value - nearly.along(Variable::Wave).value;
        assert!(change.norm() < 1e-8); // δν times a slope of order 1
    }
}
