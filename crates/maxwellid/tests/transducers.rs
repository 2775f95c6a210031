//! Tests of displacements, their noise and range, of gain, offset and delay of transducers, and of
//! tests that contradict each other.

use crate::virtual_rod;

use maxwellid::{
    Differentiator, DisplacementTransducers, Fit, FitFlag, Freedom, MaxwellidError, Noise,
    Nuisances, RodTest, RodTestData, TestFlag,
};
use rodwave::inelastic::Maxwell;
use virtual_rod::{RATE, V0, add_noise, struck, struck_before};

fn ratio_error(found: f64, expected: f64) -> f64 {
    (found / expected - 1.0).abs()
}

fn transducers(range: f64, noise: Option<(f64, f64)>) -> DisplacementTransducers {
    DisplacementTransducers {
        range,
        noise,
        differentiator: Differentiator::new(3, 4).unwrap(),
    }
}

#[test]
fn displacements_give_the_linear_law_that_made_them() {
    let truth = Maxwell::new(4e6).unwrap();
    let rod = struck(0.4, V0, 3e9, &truth, 110);
    let test = RodTest::from_displacements(
        rod.displacements(),
        &transducers(f64::INFINITY, Some((1e-7, 1e-7))),
    )
    .unwrap();
    // a filter of seven points needs three samples at either end
    assert_eq!(test.response().len(), 142 - 6 - 16);
    assert!(test.flags().is_empty());
    let fit = Fit::of(Maxwell::new(1e6).unwrap()).to(&[test]).unwrap();
    // the differentiator causes no error, because the same one on both histories commutes with a
    // linear rod
    assert!(
        ratio_error(fit.modulus(), 3e9) < 5e-4,
        "{}",
        fit.report(Noise::Stated)
    );
    assert!(
        ratio_error(fit.law().viscosity(), 4e6) < 5e-3,
        "{}",
        fit.report(Noise::Stated)
    );
}

#[test]
fn intervals_from_noisy_displacements_cover_and_scatter_as_stated() {
    let truth = Maxwell::new(4e6).unwrap();
    let rod = struck(0.4, V0, 3e9, &truth, 100);
    // one micrometre is a five-thousandth of the range of 5 mm, and gives 0.4 % of V0 after the
    // differentiator
    let noise = 1e-6;
    let (mut covered, mut squares) = (0, 0.0);
    let seeds = 24;
    for seed in 0..seeds {
        let mut data = rod.displacements();
        add_noise(&mut data, noise, seed);
        let test =
            RodTest::from_displacements(data, &transducers(f64::INFINITY, Some((noise, noise))))
                .unwrap();
        let fit = Fit::of(Maxwell::new(1e6).unwrap()).to(&[test]).unwrap();
        let judged = fit.identifiability(Noise::Stated).unwrap();
        let eta = &judged.estimates[1];
        let (low, high) = eta.interval_95();
        covered += usize::from(low < 4e6 && 4e6 < high);
        squares += ((eta.value / 4e6).ln() / eta.standard_error).powi(2);
        assert!(
            (fit.ratio_to_noise() - 1.0).abs() < 0.35,
            "{}",
            fit.ratio_to_noise()
        );
    }
    // tolerance: with a probability of 0.95 each, fewer than 20 of 24 intervals cover the truth in
    // one of 200 cases; the mean square is chi-square divided by its 24 degrees of freedom
    assert!(covered >= 20, "{covered} of {seeds}");
    let mean_square = squares / seeds as f64;
    assert!((0.35..2.1).contains(&mean_square), "{mean_square}");
}

#[test]
fn noise_is_taken_from_the_quiet_part() {
    let rod = struck_before(0.4, V0, 3e9, &Maxwell::new(4e6).unwrap(), 200, 100);
    let test = RodTest::new(rod.noisy(0.1, 5))
        .unwrap()
        .with_noise_of_quiet_part()
        .unwrap();
    let noise = test.noise().unwrap();
    // tolerance: three standard deviations; from 190 and 200 samples the levels are known to 5 %
    assert!(ratio_error(noise.excitation.standard_deviation(), 0.1) < 0.16);
    assert!(ratio_error(noise.response.standard_deviation(), 0.1) < 0.16);
    let short = struck_before(0.4, V0, 3e9, &Maxwell::new(4e6).unwrap(), 25, 100);
    let error = RodTest::new(short.noisy(0.1, 5))
        .unwrap()
        .with_noise_of_quiet_part()
        .unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("test `virtual rod`: the excitation has 1")
            && error
                .to_string()
                .ends_with("quiet samples before the wave, expected at least 16"),
        "{error}"
    );
}

#[test]
fn a_displacement_out_of_range_ends_the_window_and_is_flagged() {
    let rod = struck(0.4, V0, 3e9, &Maxwell::new(4e6).unwrap(), 110);
    let whole = rod.displacements();
    let largest = whole.response.iter().copied().fold(0.0, f64::max);
    let range = 0.8 * largest;
    let expected = whole.response.iter().position(|u| *u >= range).unwrap();
    for stuck in [false, true] {
        let mut data = whole.clone();
        let mut known_range = range;
        if stuck {
            // the range is not stated, but the clipped signal is constant
            data.response.iter_mut().for_each(|u| *u = u.min(range));
            known_range = f64::INFINITY;
        }
        let test = RodTest::from_displacements(data, &transducers(known_range, Some((1e-7, 1e-7))))
            .unwrap();
        let of_response = test.flags().iter().find_map(|flag| match flag {
            TestFlag::Clipped { history, time } if *history == "response" => Some(*time),
            _ => None,
        });
        let time = of_response.unwrap();
        // with a stated range the excitation is clipped too, at another time
        assert_eq!(test.flags().len(), if stuck { 1 } else { 2 });
        assert!((time * RATE - expected as f64).abs() < 1e-6);
        assert!(test.response().len() <= expected - 6);
        let text = test.flags()[test.flags().len() - 1].to_string();
        assert!(text.starts_with("the transducer of the response is out of range from"));
        // a window cannot extend beyond the clipped sample
        let samples = test.response().len();
        let end = test.times()[samples - 1];
        if let Ok(longer) = test.clone().with_window(end + 2.0 / RATE) {
            assert_eq!(longer.response().len(), samples);
        }
        let fit = Fit::of(Maxwell::new(1e6).unwrap()).to(&[test]).unwrap();
        assert!(ratio_error(fit.law().viscosity(), 4e6) < 0.01);
    }
    let error =
        RodTest::from_displacements(whole, &transducers(1e-5, Some((1e-7, 1e-7)))).unwrap_err();
    assert!(
        error.to_string().contains("too early to be used"),
        "{error}"
    );
}

#[test]
fn a_calibration_holds_what_the_data_cannot_see() {
    let truth = Maxwell::new(4e6).unwrap();
    let rod = struck(0.4, V0, 3e9, &truth, 100);
    let test = RodTest::new(rod.noisy(0.05, 3))
        .unwrap()
        .with_noise(0.05, 0.05)
        .unwrap();
    // for a linear rod only the product of the two gains is observable; the calibrations of 1 % and
    // 3 % determine each gain
    let fit = Fit::of(Maxwell::new(1e6).unwrap())
        .with_nuisances(Nuisances {
            response_gain: Freedom::Within(0.01),
            excitation_gain: Freedom::Within(0.03),
            ..Nuisances::default()
        })
        .to(std::slice::from_ref(&test))
        .unwrap();
    let [excitation, response] = &fit.nuisances()[0][..] else {
        panic!("{:?}", fit.nuisances());
    };
    assert_eq!(
        (excitation.name, response.name),
        ("excitation gain", "response gain")
    );
    // the gain with the better calibration keeps its uncertainty, and the data determine the other
    // gain from it
    assert!(
        ratio_error(response.standard_error, 0.01) < 0.15,
        "{response:?} {excitation:?}"
    );
    assert!(excitation.standard_error < 0.015, "{excitation:?}");
    assert!((response.value - 1.0).abs() < 0.02 && (excitation.value - 1.0).abs() < 0.03);
    // an unknown gain increases the error of the damping, and a calibrated gain increases it less
    let error = |freedom| {
        let fit = Fit::of(Maxwell::new(1e6).unwrap())
            .with_nuisances(Nuisances {
                response_gain: freedom,
                ..Nuisances::default()
            })
            .to(std::slice::from_ref(&test))
            .unwrap();
        fit.identifiability(Noise::Stated).unwrap().estimates[1].standard_error
    };
    let (fixed, within, free) = (
        error(Freedom::Fixed),
        error(Freedom::Within(2e-3)),
        error(Freedom::Free),
    );
    assert!(fixed < within && within < free, "{fixed} {within} {free}");
}

#[test]
fn calibrations_that_mean_nothing_are_refused() {
    let test = RodTest::new(struck(0.4, V0, 3e9, &Maxwell::new(4e6).unwrap(), 100).data).unwrap();
    let refused = |freedom| {
        Fit::of(Maxwell::new(1e6).unwrap())
            .with_nuisances(Nuisances {
                delay: freedom,
                ..Nuisances::default()
            })
            .to(std::slice::from_ref(&test))
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        refused(Freedom::Within(-1.0)),
        "the calibration of the delay [s] has the standard deviation -1, expected a finite value above 0"
    );
    assert_eq!(
        refused(Freedom::Within(1e-6)),
        "the calibration of the delay [s] needs tests with stated noise, because the noise sets the weight of the calibration"
    );
}

#[test]
fn tests_that_contradict_each_other_are_refused_or_flagged() {
    let truth = Maxwell::new(4e6).unwrap();
    let (long, middle, short) = (
        struck(0.6, V0, 3e9, &truth, 120),
        struck(0.4, V0, 3e9, &truth, 100),
        struck(0.3, V0, 3e9, &truth, 100),
    );
    let tests = |change: &dyn Fn(&mut RodTestData)| -> Vec<RodTest> {
        let mut changed = short.named("short");
        change(&mut changed);
        [long.named("long"), middle.named("middle"), changed]
            .into_iter()
            .map(|data| RodTest::new(data).unwrap())
            .collect()
    };
    let fit = |tests: &[RodTest]| Fit::of(Maxwell::new(1e6).unwrap()).to(tests);
    let agreeing = fit(&tests(&|_| ())).unwrap();
    assert!(agreeing.flags().is_empty(), "{:?}", agreeing.flags());
    assert!(ratio_error(agreeing.modulus(), 3e9) < 1e-3);
    // with half of the true sampling rate the time of flight gives a quarter of the modulus
    let error = fit(&tests(&|data| data.sampling_rate_hz *= 0.5)).unwrap_err();
    assert!(
        matches!(&error, MaxwellidError::Contradiction { test, .. } if test == "short"),
        "{error}"
    );
    assert!(
        error
            .to_string()
            .contains("a length, a density or a sampling rate is wrong, or the materials differ")
    );
    // an error of the length of 2 % is too small for the check of the times of flight, but the fit
    // detects it
    let doubtful = fit(&tests(&|data| data.length *= 1.02)).unwrap();
    assert!(
        doubtful.flags().iter().any(|flag| matches!(
            flag,
            FitFlag::TestDisagrees { test, parameter, .. } if test == "short" && parameter == "ln_modulus"
        )),
        "{:?}",
        doubtful.flags()
    );
}

#[test]
fn windows_and_noise_that_are_no_good_are_named() {
    let truth = Maxwell::new(4e6).unwrap();
    let rod = struck(0.4, V0, 3e9, &truth, 100);
    let test = RodTest::new(rod.data.clone()).unwrap();
    let fit = |tests: &[RodTest]| Fit::of(Maxwell::new(1e6).unwrap()).to(tests).unwrap_err();
    // the wave arrives 0.24 ms after the 32 samples at rest, at 0.87 ms
    let short = test.clone().with_window(0.95e-3).unwrap();
    let error = fit(&[short]);
    assert!(
        matches!(error, MaxwellidError::WindowTooShort { .. }),
        "{error}"
    );
    assert!(
        error.to_string().contains("but the wave arrives at 0.000"),
        "{error}"
    );
    let other = RodTest::new(rod.noisy(0.1, 1)).unwrap();
    let error = fit(&[test.clone().with_noise(0.1, 0.1).unwrap(), other]);
    assert_eq!(
        error.to_string(),
        "test `virtual rod` states no noise, but other tests do: state the noise for all tests or for none"
    );
    assert_eq!(
        test.clone().with_noise(0.1, 0.0).unwrap_err().to_string(),
        "test `virtual rod`: the noise of the response is 0 m/s, expected a finite value above 0 (0 is permitted for the \
         excitation)"
    );
    assert!(test.clone().with_noise(f64::NAN, 0.1).is_err());
    assert!(test.with_noise(0.0, 0.1).is_ok());
    assert_eq!(
        RodTest::from_displacements(rod.displacements(), &transducers(-1.0, None))
            .unwrap_err()
            .to_string(),
        "test `virtual rod`: the range of the transducer is -1 m, expected a value above 0"
    );
}

#[test]
fn noise_stated_too_low_is_found_out() {
    let rod = struck(0.4, V0, 3e9, &Maxwell::new(4e6).unwrap(), 100);
    let fit = |stated| {
        let test = RodTest::new(rod.noisy(0.1, 7))
            .unwrap()
            .with_noise(stated, stated)
            .unwrap();
        Fit::of(Maxwell::new(1e6).unwrap()).to(&[test]).unwrap()
    };
    let (right, wrong) = (fit(0.1), fit(0.04));
    assert!(right.flags().is_empty(), "{:?}", right.flags());
    assert!(
        matches!(wrong.flags()[0], FitFlag::ResidualAboveNoise { ratio } if (ratio - 2.5).abs() < 0.5)
    );
    // the errors follow from the residual, not from the stated noise
    let error = |fit: &maxwellid::Identification<Maxwell>| {
        fit.identifiability(Noise::Stated).unwrap().estimates[1].standard_error
    };
    assert!(ratio_error(error(&wrong), error(&right)) < 0.25);
}
