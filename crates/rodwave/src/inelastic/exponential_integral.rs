//! Exponential integrals of the Gurevich-Rabinovich law (Abramowitz & Stegun, chapter 5).

use statrs::function::exponential::integral;

/// Entire exponential integral Ein(x) = Σ xᵏ/(k k!) for x >= 0.
pub(super) fn entire(x: f64) -> f64 {
    let (mut sum, mut power, mut k) = (0.0, 1.0, 0.0);
    loop {
        k += 1.0;
        power *= x / k;
        let term = power / k;
        sum += term;
        // beyond k = x the terms decrease
        if term <= 1e-17 * sum || !sum.is_finite() {
            return sum;
        }
    }
}

/// Euler's constant γ.
pub(super) const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;
/// Value of E1(1).
pub(super) const E1_OF_ONE: f64 = 0.219_383_934_395_520_27;

/// Positive nodes and weights of the eight-point Gauss-Legendre rule on [-1, 1].
pub(super) const GAUSS_LEGENDRE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// Computes E1(y) for y > 0.
///
/// For y > 1 the library evaluates a continued fraction, which fails after 100 terms at scattered
/// points of 1 < y < 1.42. There, E1(1) - ∫₁^y e^{-t}/t dt by Gauss-Legendre quadrature is exact to
/// rounding.
pub(super) fn e1(y: f64) -> f64 {
    if y > 1.0 && y < 1.5 {
        let (middle, half) = (0.5 * (1.0 + y), 0.5 * (y - 1.0));
        let area: f64 = GAUSS_LEGENDRE
            .iter()
            .map(|(node, weight)| {
                let (a, b) = (middle - half * node, middle + half * node);
                weight * ((-a).exp() / a + (-b).exp() / b)
            })
            .sum();
        return E1_OF_ONE - half * area;
    }
    // where the library has no value, e^{-y} has underflowed
    integral(y, 1).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn e1_agrees_with_high_precision_values() {
        // values to 20 digits from mpmath 1.3
        for (y, expected) in [
            (1e-8, 17.843465089050833),
            (0.5, 0.55977359477616081),
            (1.0001, 0.219347150129891),
            (3.3, 0.0089390425420321406),
            (20.0, 9.8355252906498817e-11),
            (700.0, 1.4065187662340329e-307),
        ] {
            let found = e1(y);
            // tolerance: the library sums its continued fraction to some units of rounding
            assert!(
                (found / expected - 1.0).abs() < 2e-14,
                "E1({y}) = {found}, expected {expected}"
            );
        }
    }

    #[test]
    fn quadrature_joins_the_library_on_both_sides() {
        // two independent evaluations meet at 1.5; tolerance: between 1.5 (1 - 1e-14) and 1.5, E1
        // changes by a relative 2e-14
        let below = e1(1.5 * (1.0 - 1e-14));
        let above = e1(1.5);
        assert!((below / above - 1.0).abs() < 1e-13, "{below} {above}");
    }

    #[test]
    fn the_entire_integral_agrees_with_high_precision_values() {
        // Ein(x) = Ei(x) - ln x - γ; Ei(1), Ei(40) to 17 digits from mpmath 1.3
        for (x, ei) in [
            (1.0, 1.895_117_816_355_936_8),
            (40.0, 6.039_718_263_611_242e15),
        ] {
            let expected = ei - f64::ln(x) - EULER_GAMMA;
            assert!((entire(x) / expected - 1.0).abs() < 1e-14);
        }
    }
}
