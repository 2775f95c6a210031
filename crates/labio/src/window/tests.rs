use super::*;

/// Rounding errors of a sum of a thousand terms of order one.
const SUM_ROUNDING: f64 = 1e-12;

#[test]
fn a_symmetric_window_has_one_sample_less_a_period_and_an_extra_zero() {
    let n = 1000.0;
    let sampled = Window::HannSymmetric.sample(1000).unwrap();
    assert!((sampled.coherent_gain - 0.5 * (n - 1.0) / n).abs() < SUM_ROUNDING);
    assert!((sampled.power_gain - 0.375 * (n - 1.0) / n).abs() < SUM_ROUNDING);
    assert!((sampled.noise_bandwidth_lines - 1.5 * n / (n - 1.0)).abs() < SUM_ROUNDING);
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
        assert!((tukey - hann).abs() < 1e-15); // rounding error of one cosine
    }
    for taper in [-0.1, 1.1, f64::NAN] {
        let error = Window::TukeyPeriodic { taper }.sample(64).unwrap_err();
        assert!(matches!(error, LabioError::NonPhysical { .. }));
    }
}

#[test]
fn segments_that_do_not_overlap_count_whole() {
    let n = 1024;
    let hann = Window::HannPeriodic.sample(n).unwrap();
    assert!((hann.overlap_correlation(0) - 1.0).abs() < SUM_ROUNDING);
    assert!(hann.overlap_correlation(n) <= 0.0);
    assert!((hann.independent_averages(7, n).unwrap() - 7.0).abs() < SUM_ROUNDING);
    assert!((hann.independent_averages(1, 1).unwrap() - 1.0).abs() < SUM_ROUNDING);
    assert!(hann.independent_averages(3, 0).is_err() && hann.independent_averages(0, 3).is_err());
}

#[test]
fn a_flat_top_is_flat_between_lines() {
    // within 0.01 dB
    let scalloping = Window::FlatTopPeriodic.sample(4096).unwrap().scalloping();
    assert!((scalloping - 1.0).abs() < 1.2e-3);
}

#[test]
fn a_window_of_zeros_is_refused() {
    assert!(Window::HannSymmetric.sample(2).is_err());
    assert!(Window::Rectangular.sample(1).is_err());
}
