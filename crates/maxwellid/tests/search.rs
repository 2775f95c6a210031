//! Tests of the search of a fit: starts, minima that belong to another period of the waveform,
//! bounds, grids.

use crate::virtual_rod;

use maxwellid::{Fit, MaxwellidError, Noise, RodModel, RodTest};
use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::inelastic::{
    Elastic, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};
use virtual_rod::{RATE, struck};

fn ratio_error(found: f64, expected: f64) -> f64 {
    (found / expected - 1.0).abs()
}

#[test]
fn a_minimum_of_another_period_is_found_and_left() {
    let truth = Maxwell::new(4e6).unwrap();
    let test = RodTest::new(struck(0.4, 10.0, 3e9, &truth, 100).data).unwrap();
    // with these moduli the front is 50 us early or 100 us late; the pulse lasts 60 us
    for wrong in [1.6 * 3e9, 0.5 * 3e9] {
        let fit = Fit::of(truth)
            .starting_from(wrong)
            .to(std::slice::from_ref(&test))
            .unwrap();
        assert!(
            ratio_error(fit.modulus(), 3e9) < 1e-3,
            "{}",
            fit.report(Noise::FromResidual)
        );
        assert!(ratio_error(fit.law().viscosity(), 4e6) < 0.02);
        assert!(fit.flags().is_empty(), "{:?}", fit.flags());
    }
    let left: usize = [1.6, 0.5, 0.3, 3.0]
        .iter()
        .map(|factor| {
            let fit = Fit::of(truth)
                .starting_from(factor * 3e9)
                .to(std::slice::from_ref(&test))
                .unwrap();
            assert!(ratio_error(fit.modulus(), 3e9) < 1e-3);
            fit.cycle_skips_left()
        })
        .sum();
    assert!(
        left > 0,
        "no start led to a wrong minimum, so that this test proves nothing"
    );
}

#[test]
fn many_starts_end_where_one_does_and_tell_where_each_led() {
    let truth = MaxwellNorton::new(2.0, 1.3e13).unwrap();
    let test = RodTest::new(struck(0.4, 10.0, 2.6e9, &truth, 100).data).unwrap();
    let start = MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6).unwrap();
    let one = Fit::of(start)
        .with_cell(8e-3)
        .to(std::slice::from_ref(&test))
        .unwrap();
    let many = Fit::of(start)
        .with_cell(8e-3)
        .with_starts(12)
        .to(&[test])
        .unwrap();
    for (a, b) in one.parameters().iter().zip(many.parameters()) {
        // tolerance: both iterations end where a step would reduce the sum of squares by less than
        // 1e-10 of it
        assert!(
            (a - b).abs() < 1e-4,
            "{:?} {:?}",
            one.parameters(),
            many.parameters()
        );
    }
    assert_eq!((one.starts().len(), many.starts().len()), (1, 12));
    assert!(
        many.starts()
            .iter()
            .any(|s| (s.start[0] - one.starts()[0].start[0]).abs() > 0.01)
    );
    let best = many
        .starts()
        .iter()
        .map(|s| s.relative_error)
        .fold(1.0, f64::min);
    assert!(
        many.starts()
            .iter()
            .filter(|s| s.relative_error < 1.01 * best)
            .count()
            >= 3
    );
}

#[test]
fn the_grid_is_as_fine_as_the_accuracy_asks_for() {
    let truth = MaxwellNorton::new(2.108, 7e13).unwrap();
    let test = RodTest::new(struck(0.4, 10.0, 2.58e9, &truth, 100).data).unwrap();
    let mut last = f64::INFINITY;
    for accuracy in [1e-3, 2e-6, 4e-7] {
        let fit = Fit::of(truth)
            .with_accuracy(accuracy)
            .to(std::slice::from_ref(&test))
            .unwrap();
        assert!(
            fit.grid_difference() <= accuracy,
            "{accuracy}: {}",
            fit.grid_difference()
        );
        assert!(fit.cell() < last, "{accuracy}: {}", fit.cell());
        last = fit.cell();
    }
    // `grid_difference` is the difference from the response with half the cell
    let fit = Fit::of(truth)
        .with_cell(8e-3)
        .to(std::slice::from_ref(&test))
        .unwrap();
    let times = test.times();
    let response = |cell| {
        fit.model()
            .response(&test.driven_rod(&times, cell), fit.parameters())
    };
    let squares: f64 = response(8e-3)
        .unwrap()
        .iter()
        .zip(response(4e-3).unwrap())
        .map(|(a, b)| ((a - b) / 10.0).powi(2))
        .sum();
    let rms = (squares / times.len() as f64).sqrt();
    assert!(ratio_error(fit.grid_difference(), rms) < 1e-9);
}

#[test]
fn the_excitation_between_its_samples_is_known_to_a_thousandth() {
    let rod = struck(0.4, 10.0, 3e9, &Maxwell::new(4e6).unwrap(), 100);
    let history = SampledHistory::new(&rod.data.excitation, RATE).unwrap();
    let end = (rod.data.excitation.len() - SampledHistory::HALF_WIDTH) as f64 / RATE;
    let linear = |t: f64| {
        let (k, u) = ((t * RATE) as usize, (t * RATE).fract());
        let v = &rod.data.excitation;
        v[k] * (1.0 - u) + v[k + 1] * u
    };
    let (mut worst, mut squares, mut of_linear) = (0.0_f64, 0.0, 0.0);
    let points = 4000;
    for k in 0..points {
        let t = end * f64::from(k) / f64::from(points);
        let truth = rod.excitation.at(t);
        worst = worst.max((history.at(t) - truth).abs() / 10.0);
        squares += ((history.at(t) - truth) / 10.0).powi(2);
        of_linear += ((linear(t) - truth) / 10.0).powi(2);
    }
    let rms = |sum: f64| (sum / f64::from(points)).sqrt();
    // the largest error is below the default accuracy of 0.1 % of V0; linear interpolation between
    // the samples has at least ten times the rms error
    assert!(worst < 1e-3, "{worst}");
    assert!(rms(squares) < 1e-4, "{}", rms(squares));
    assert!(rms(of_linear) > 10.0 * rms(squares), "{}", rms(of_linear));
}

#[test]
fn laws_are_models_and_say_whether_they_are_linear() {
    assert!(Elastic.is_linear() && Maxwell::new(1e6).unwrap().is_linear());
    let norton = MaxwellNorton::new(2.0, 1e13).unwrap();
    let rabinovich = MaxwellGurevichRabinovich::new(3e6, 7e6).unwrap();
    assert!(!norton.is_linear() && !rabinovich.is_linear());
    for (count, parameters, bounds, limits) in [
        (
            3,
            RodModel::parameters(&norton, 2e9),
            norton.bounds(),
            norton.step_limits(),
        ),
        (
            3,
            RodModel::parameters(&rabinovich, 2e9),
            rabinovich.bounds(),
            rabinovich.step_limits(),
        ),
    ] {
        assert_eq!(
            (parameters.len(), bounds.len(), limits.len()),
            (count, count, count)
        );
        for (t, (low, high)) in parameters.iter().zip(bounds) {
            assert!(low < *t && *t < high);
        }
    }
    // the linear law is inside the bounds, not at one of them
    assert!(norton.bounds()[1].0 < 1.0 && rabinovich.bounds()[1].0 < 0.0);
    let stated = RodModel::stated(&norton, &RodModel::parameters(&norton, 2e9));
    assert_eq!(stated[0].symbol, "E");
    assert!(ratio_error(stated[0].value, 2e9) < 1e-12);
    assert!(ratio_error(stated[2].value, norton.inelastic_strain_rate(10e6)) < 1e-12);
}

#[test]
fn bad_requests_are_refused() {
    let law = Maxwell::new(4e6).unwrap();
    let test = RodTest::new(struck(0.4, 10.0, 3e9, &law, 100).data).unwrap();
    for (fit, message) in [
        (
            Fit::of(law).with_accuracy(0.0),
            "the direct problem fails at the starting values: accuracy as a share of V0 is 0, expected a finite value above 0",
        ),
        (
            Fit::of(law).with_cell(f64::NAN),
            "the direct problem fails at the starting values: cell of the grid [m] is NaN, expected a finite value above 0",
        ),
    ] {
        let error: MaxwellidError = fit.to(std::slice::from_ref(&test)).unwrap_err();
        assert_eq!(error.to_string(), message);
    }
}
