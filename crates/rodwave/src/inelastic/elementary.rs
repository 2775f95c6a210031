//! Branch-free logarithm and exponential of several numbers at once, which the compiler vectorises.
//!
//! The relaxation of one step changes a stress by a thousandth or so. A relative error of 1e-14 in
//! that change is below the rounding of the stress. These series have that accuracy at a fraction
//! of the cost of a call to the mathematical library.

use super::LANES;

/// Bits of √½: mantissas are between √½ and √2.
const SQRT_HALF_BITS: u64 = 0x3FE6_A09E_667F_3BCD;
const ONE_BITS: u64 = 0x3FF0_0000_0000_0000;
const MANTISSA: u64 = 0x000F_FFFF_FFFF_FFFF;
/// Bits of 2^52. Combined with an integer below 2^52, they are the bits of the sum of both numbers.
const TWO_TO_52_BITS: u64 = 0x4330_0000_0000_0000;
const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
/// 1.5 · 2^52: adding it to a number rounds the number to the nearest integer.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Coefficients 1/(2k + 1) of the series of artanh(t)/t in powers of t².
pub(super) const ARTANH: [f64; 9] = [
    1.0,
    1.0 / 3.0,
    1.0 / 5.0,
    1.0 / 7.0,
    1.0 / 9.0,
    1.0 / 11.0,
    1.0 / 13.0,
    1.0 / 15.0,
    1.0 / 17.0,
];

/// Coefficients 1/k! of the series of the exponential.
const EXPONENTIAL: [f64; 13] = [
    1.0,
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
];

/// Computes Σ cₖ xᵏ by Estrin's rule, four terms at a time: the processor runs several short chains
/// of operations in parallel, instead of the single long chain of Horner's rule.
#[inline(always)]
#[allow(
    clippy::indexing_slicing,
    reason = "`first` is a multiple of 4 below `N`, and a term is taken only where it exists"
)]
pub(super) fn polynomial<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let square = x * x;
    let fourth = square * square;
    // plain loops: an iterator that is not inlined prevents vector instructions
    let group = |first: usize| match N - first {
        1 => coefficients[first],
        2 => coefficients[first] + coefficients[first + 1] * x,
        3 => (coefficients[first] + coefficients[first + 1] * x) + coefficients[first + 2] * square,
        _ => {
            (coefficients[first] + coefficients[first + 1] * x)
                + (coefficients[first + 2] + coefficients[first + 3] * x) * square
        }
    };
    let mut first = (N - 1) / 4 * 4;
    let mut sum = group(first);
    while first > 0 {
        first -= 4;
        sum = sum * fourth + group(first);
    }
    sum
}

/// Returns the largest of several numbers, found by halving the array; NaN may be skipped.
#[inline(always)]
#[allow(
    clippy::indexing_slicing,
    reason = "both halves of `x` have `HALF` entries, and `width` begins at `HALF` and is halved before it is used"
)]
pub(super) fn largest(x: &[f64; LANES]) -> f64 {
    const HALF: usize = LANES / 2;
    let mut largest = [0.0; HALF];
    for i in 0..HALF {
        largest[i] = larger(x[i], x[i + HALF]);
    }
    let mut width = HALF;
    while width > 1 {
        width /= 2;
        for i in 0..width {
            largest[i] = larger(largest[i], largest[i + width]);
        }
    }
    largest[0]
}

/// Returns the larger of two numbers in one vector instruction, unlike `f64::max`.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Computes ln of non-negative numbers with an error below 1e-14 times the larger of 1 and |ln x|;
/// about -709 at zero.
#[inline(always)]
pub(super) fn ln(x: &[f64; LANES]) -> [f64; LANES] {
    lanes!(|i| {
        let shifted = x[i].to_bits().wrapping_add(ONE_BITS - SQRT_HALF_BITS);
        let exponent = f64::from_bits((shifted >> 52) | TWO_TO_52_BITS) - TWO_TO_52 - 1023.0;
        let mantissa = f64::from_bits((shifted & MANTISSA) + SQRT_HALF_BITS);
        // ln m = 2 artanh t, |t| < 0.172; the first omitted term is t^19/19 = 2e-16
        let t = (mantissa - 1.0) / (mantissa + 1.0);
        let series = polynomial(&ARTANH, t * t);
        exponent * std::f64::consts::LN_2 + 2.0 * t * series
    })
}

/// Computes exp of numbers between -708 and 709, to 1e-14 times 1 + |x|; outside this range, the
/// value at the nearer end.
#[inline(always)]
pub(super) fn exp(x: &[f64; LANES]) -> [f64; LANES] {
    lanes!(|i| {
        // both comparisons are false for a NaN, which is thus passed on
        let x = if x[i] < -708.0 { -708.0 } else { x[i] };
        let x = if x > 709.0 { 709.0 } else { x };
        let rounded = x * std::f64::consts::LOG2_E + ROUNDER;
        let k = rounded - ROUNDER;
        // ln 2 in two parts, the first with trailing zeros
        let f = (x - k * 0.693_147_180_369_123_8) - k * 1.908_214_929_270_587_7e-10;
        // |f| < 0.347; the first omitted term is f^13/13! = 2e-16
        let series = polynomial(&EXPONENTIAL, f);
        // the integer k is in the low bits of the rounded sum
        let scale = f64::from_bits(rounded.to_bits().wrapping_add(1023) << 52);
        series * scale
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agree_with_the_mathematical_library() {
        let mut x = 1e-300_f64;
        while x < 1e300 {
            let values: [f64; LANES] =
                lanes!(|i| x * (1.0 + 0.11 * f64::from(u8::try_from(i).unwrap())));
            for (value, found) in values.iter().zip(ln(&values)) {
                // tolerance: a few units of rounding of the result or, near 1, of the argument
                let allowed = 1e-15 * value.ln().abs().max(1.0) * 4.0;
                assert!((found - value.ln()).abs() < allowed, "ln {value}: {found}");
            }
            x *= 1.37;
        }
        let mut x = -700.0_f64;
        while x < 700.0 {
            let values: [f64; LANES] = lanes!(|i| x + 0.031 * f64::from(u8::try_from(i).unwrap()));
            for (value, found) in values.iter().zip(exp(&values)) {
                assert!(
                    (found / value.exp() - 1.0).abs() < 4e-15,
                    "exp {value}: {found}"
                );
            }
            x += 0.377;
        }
    }

    #[test]
    fn ends_of_the_range_are_kept() {
        assert!(ln(&[0.0; LANES])[0] < -700.0);
        assert!(exp(&[-1e4; LANES])[0] < 1e-300);
        assert!(exp(&[1e4; LANES])[0] > 1e300);
    }
}
