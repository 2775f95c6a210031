//! Energy, scale, order and bounds of averaged spectra.

use labio::{AveragedSpectra, LineValidity, Record, Welch, Window};
use ndarray::Array2;
use proptest::prelude::*;

use super::{INPUT, OUTPUT, any_hits, averaged, record};

fn scaled(hit: &Record, factors: [f64; 2]) -> Record {
    let row = |name: &str, factor: f64| -> Vec<f64> {
        hit.channel(name)
            .unwrap()
            .iter()
            .map(|x| x * factor)
            .collect()
    };
    let rows = [row(INPUT, factors[0]), row(OUTPUT, factors[1])];
    record([&rows[0], &rows[1]], hit.sampling_rate_hz())
}

proptest! {
    /// The Schwarz inequality: `|H1| <= |Hv| <= |H2|` with the same phase, and a coherence between
    /// 0 and 1.
    #[test]
    fn estimators_keep_their_order((hits, _) in any_hits(2)) {
        let spectra = averaged(&hits);
        let responses = [
            spectra.h1(INPUT, OUTPUT).unwrap(),
            spectra.hv(INPUT, OUTPUT).unwrap(),
            spectra.h2(INPUT, OUTPUT).unwrap(),
        ];
        let coherence = spectra.coherence(INPUT, OUTPUT).unwrap();
        for line in 0..coherence.values.len() {
            if responses.iter().any(|r| r.validity[line] != LineValidity::Valid) {
                continue;
            }
            let c = coherence.values[line];
            prop_assert!((0.0..=1.0).contains(&c), "{c}");
            let [h1, hv, h2] = [0, 1, 2].map(|k: usize| responses[k].values[line]);
            // tolerance: one rounding error of each
            let slack = 1.0 + 1e-14;
            prop_assert!(h1.norm() <= hv.norm() * slack && hv.norm() <= h2.norm() * slack);
            prop_assert!((h1.norm() * h2.norm() / hv.norm_sqr() - 1.0).abs() < 1e-12);
            prop_assert!((h1 / h2 * (h2.norm() / h1.norm()) - 1.0).norm() < 1e-12);
        }
    }

    /// Other units of force and motion: responses scale, the coherence does not change. Powers of
    /// two are exact in every step.
    #[test]
    fn units_scale_responses_to_the_bit((hits, _) in any_hits(2), powers in [-200..200_i32, -200..200_i32]) {
        let factors = powers.map(|p| 2.0_f64.powi(p));
        let others: Vec<Record> = hits.iter().map(|hit| scaled(hit, factors)).collect();
        let (plain, other) = (averaged(&hits), averaged(&others));
        let ratio = factors[1] / factors[0];
        for (a, b) in [
            (plain.h1(INPUT, OUTPUT).unwrap(), other.h1(INPUT, OUTPUT).unwrap()),
            (plain.hv(INPUT, OUTPUT).unwrap(), other.hv(INPUT, OUTPUT).unwrap()),
        ] {
            prop_assert_eq!(&a.validity, &b.validity);
            for line in 0..a.values.len() {
                if a.validity[line] == LineValidity::Valid {
                    prop_assert_eq!(a.values[line] * ratio, b.values[line]);
                }
            }
            let coherences = a.coherence.unwrap();
            for (a, b) in coherences.iter().zip(b.coherence.unwrap()) {
                prop_assert!(a.to_bits() == b.to_bits() || (a - b).abs() < 1e-14 || a.is_nan() && b.is_nan());
            }
        }
    }

    /// Sums depend on their order only through rounding errors.
    #[test]
    fn the_order_of_hits_is_lost_in_rounding((hits, _) in any_hits(2), turn in 1..6_usize) {
        let mut turned = hits.clone();
        turned.rotate_left(turn % hits.len());
        let (a, b) = (averaged(&hits), averaged(&turned));
        let (x, y) = (a.auto(INPUT).unwrap(), a.auto(OUTPUT).unwrap());
        let pairs = a.cross(INPUT, OUTPUT).unwrap().into_iter().zip(b.cross(INPUT, OUTPUT).unwrap());
        for (line, (a, b)) in pairs.enumerate() {
            prop_assert!((a - b).norm() <= 1e-14 * (x[line] * y[line]).sqrt());
        }
    }

    /// The average over segments without overlap of a long record equals the average over its
    /// pieces, bit for bit.
    #[test]
    fn a_cut_record_is_its_pieces((hits, rate) in any_hits(2)) {
        let n = hits[0].n_samples();
        let joined = Array2::from_shape_fn((2, n * hits.len()), |(row, k)| hits[k / n].samples()[(row, k % n)]);
        let rows: Vec<Vec<f64>> = joined.rows().into_iter().map(|row| row.to_vec()).collect();
        let whole = Welch::new(n).unwrap().with_overlap(0).unwrap().with_window(Window::Rectangular)
            .spectra(&record([&rows[0], &rows[1]], rate)).unwrap();
        let pieces = AveragedSpectra::of(&hits, Window::Rectangular).unwrap();
        prop_assert_eq!(whole.auto(INPUT).unwrap(), pieces.auto(INPUT).unwrap());
        prop_assert_eq!(whole.cross(INPUT, OUTPUT).unwrap(), pieces.cross(INPUT, OUTPUT).unwrap());
    }
}
