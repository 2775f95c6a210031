//! Sums over histories.

/// Number of partial sums, which the compiler keeps in vector registers.
const LANES: usize = 8;

/// Σ aᵢ bᵢ over the shorter of both, the same to the last digit on every processor.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let (a, b) = (a.get(..count).unwrap_or(a), b.get(..count).unwrap_or(b));
    let (of_a, rest_a) = a.as_chunks::<LANES>();
    let (of_b, rest_b) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in of_a.iter().zip(of_b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    let [s0, s1, s2, s3, s4, s5, s6, s7] = sums;
    (((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7))) + rest
}
