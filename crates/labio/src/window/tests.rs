use super::*;

/// Rounding of a sum of a thousand terms of order one.
const SUM_ROUNDING: f64 = 1e-12;

const N: usize = 1000;

#[test]
fn corrections_are_the_sums_of_cosines() {
    let samples = N as f64;
    // sums of cos and cos^2 over whole periods; the symmetric one has N-1 samples a period and one extra zero
    let expected = [
        (Window::Rectangular, 1.0, 1.0, 1.0),
        (Window::HannPeriodic, 0.5, 0.375, 1.5),
        (
            Window::HannSymmetric,
            0.5 * (samples - 1.0) / samples,
            0.375 * (samples - 1.0) / samples,
            1.5 * samples / (samples - 1.0),
        ),
    ];
    for (window, coherent_gain, power_gain, bandwidth) in expected {
        let sampled = window.sample(N).unwrap();
        assert!((sampled.coherent_gain - coherent_gain).abs() < SUM_ROUNDING);
        assert!((sampled.power_gain - power_gain).abs() < SUM_ROUNDING);
        assert!((sampled.noise_bandwidth_lines - bandwidth).abs() < SUM_ROUNDING);
    }
}

#[test]
fn periodic_windows_of_cosines_have_the_gains_of_their_coefficients() {
    // over a whole period: mean a_0, mean square a_0^2 + sum a_k^2/2
    let windows: [(Window, &[f64]); 4] = [
        (Window::HannPeriodic, &[0.5, 0.5]),
        (Window::HammingPeriodic, &[0.54, 0.46]),
        (
            Window::BlackmanHarrisPeriodic,
            &[0.35875, 0.48829, 0.14128, 0.01168],
        ),
        (
            Window::FlatTopPeriodic,
            &[
                0.21557895,
                0.41663158,
                0.277263158,
                0.083578947,
                0.006947368,
            ],
        ),
    ];
    for (window, a) in windows {
        let sampled = window.sample(N).unwrap();
        let mean_square = a[0] * a[0] + a[1..].iter().map(|a| a * a / 2.0).sum::<f64>();
        assert!((sampled.coherent_gain - a[0]).abs() < SUM_ROUNDING);
        assert!((sampled.power_gain - mean_square).abs() < SUM_ROUNDING);
        let bandwidth = mean_square / (a[0] * a[0]);
        assert!((sampled.noise_bandwidth_lines - bandwidth).abs() < SUM_ROUNDING);
    }
}

#[test]
fn the_two_hann_windows_differ_in_their_last_sample() {
    let periodic = Window::HannPeriodic.sample(8).unwrap().weights;
    let symmetric = Window::HannSymmetric.sample(8).unwrap().weights;
    // cos(2 pi 7/8) = 1/sqrt 2; rounding of one cosine
    assert!((periodic[7] - (0.5 - 0.5 / 2.0_f64.sqrt())).abs() < 1e-15);
    assert!(symmetric[7].abs() < 1e-15);
}

#[test]
fn a_symmetric_window_is_a_periodic_one_of_one_sample_less_and_its_first_sample_again() {
    let pairs = [
        (Window::HannSymmetric, Window::HannPeriodic),
        (Window::HammingSymmetric, Window::HammingPeriodic),
        (
            Window::BlackmanHarrisSymmetric,
            Window::BlackmanHarrisPeriodic,
        ),
        (Window::FlatTopSymmetric, Window::FlatTopPeriodic),
        (
            Window::TukeySymmetric { taper: 0.3 },
            Window::TukeyPeriodic { taper: 0.3 },
        ),
    ];
    for (symmetric, periodic) in pairs {
        for n in [4, 17, 64] {
            let mut expected = periodic.sample(n - 1).unwrap().weights;
            expected.push(expected[0]);
            assert_eq!(symmetric.sample(n).unwrap().weights, expected);
            let mut reversed = expected.clone();
            reversed.reverse();
            for (a, b) in expected.iter().zip(&reversed) {
                // rounding of cosines of mirrored angles
                assert!((a - b).abs() < 1e-15);
            }
        }
    }
}

#[test]
fn tukey_lies_between_rectangular_and_hann() {
    let weights = |window: Window| window.sample(64).unwrap().weights;
    assert_eq!(
        weights(Window::TukeyPeriodic { taper: 0.0 }),
        weights(Window::Rectangular)
    );
    let hann = weights(Window::HannPeriodic);
    for (tukey, hann) in weights(Window::TukeyPeriodic { taper: 1.0 })
        .iter()
        .zip(hann)
    {
        assert!((tukey - hann).abs() < 1e-15); // rounding of one cosine
    }
    for taper in [-0.1, 1.1, f64::NAN] {
        let error = Window::TukeyPeriodic { taper }.sample(64).unwrap_err();
        assert!(matches!(error, LabioError::NonPhysical { .. }));
    }
}

#[test]
fn half_overlapped_hann_segments_are_nearly_independent() {
    let n = 1024;
    let hann = Window::HannPeriodic.sample(n).unwrap();
    // sum sin^2 cos^2 over half a window against sum sin^4: (N/16)/(3N/8) = 1/6
    assert!((hann.overlap_correlation(n / 2) - 1.0 / 36.0).abs() < SUM_ROUNDING);
    assert!((hann.overlap_correlation(0) - 1.0).abs() < SUM_ROUNDING);
    assert!(hann.overlap_correlation(n) <= 0.0);
    let k = 9.0;
    let expected = k / (1.0 + 2.0 * (1.0 - 1.0 / k) / 36.0);
    assert!((hann.independent_averages(9, n / 2).unwrap() - expected).abs() < SUM_ROUNDING);
    // no overlap, or one segment: what is counted
    assert!((hann.independent_averages(7, n).unwrap() - 7.0).abs() < SUM_ROUNDING);
    assert!((hann.independent_averages(1, 1).unwrap() - 1.0).abs() < SUM_ROUNDING);
    assert!(hann.independent_averages(3, 0).is_err() && hann.independent_averages(0, 3).is_err());
}

#[test]
fn rectangular_segments_that_overlap_by_half_share_a_quarter() {
    let window = Window::Rectangular.sample(100).unwrap();
    assert!((window.overlap_correlation(50) - 0.25).abs() < 1e-15); // one ratio of small integers, squared
}

#[test]
fn scalloping_of_known_windows() {
    // midway between lines the kernel of N samples is 1/(N sin(pi/2N)) -> 2/pi; Hann 8/(3 pi); flat top within 0.01 dB of 1
    let scalloping = |window: Window| window.sample(4096).unwrap().scalloping();
    // the limits hold to order 1/N^2 = 6e-8
    assert!((scalloping(Window::Rectangular) - 2.0 / PI).abs() < 1e-6);
    assert!((scalloping(Window::HannPeriodic) - 8.0 / (3.0 * PI)).abs() < 1e-6);
    assert!((scalloping(Window::FlatTopPeriodic) - 1.0).abs() < 1.2e-3);
}

#[test]
fn a_window_of_zeros_is_refused() {
    assert!(Window::HannSymmetric.sample(2).is_err());
    assert!(Window::Rectangular.sample(1).is_err());
}
