//! Screening and correction of measured mobilities, on chains of `rodwave` with faults of known
//! size.

use std::f64::consts::TAU;

use impulse::{
    Impact, ImpactBody, ImpulseError, LineBand, LowFrequency, MeasuredBody, MobilityLaw,
    Projection, Reciprocity, Screening, ScreeningFlag, WeighedMass, lines_of,
};
use num_complex::Complex64;
use rodwave::chain::{AngularFrequency, Chain, ChainBuilder, Termination};
use rodwave::element::CrossSection;
use rodwave::medium::Medium;
use testbed::noise::Noise;

use crate::bodies::{circle, nylon, nylon_rod};

pub(crate) const STEP_HZ: f64 = 10.0;
pub(crate) const N_LINES: usize = 1025;

/// A rod of the material of paper E, for which the real part of the upper lines swings about 1/Z.
fn rod() -> Chain {
    nylon_rod(0.040, 0.300)
}

pub(crate) fn mass() -> f64 {
    rod().free_mass().unwrap()
}

pub(crate) fn front_impedance() -> f64 {
    nylon().specific_characteristic_impedance(TAU * 10e3).re
        * CrossSection::from(circle(0.040)).area()
}

pub(crate) fn exact() -> Vec<Complex64> {
    lines_of(&rod(), STEP_HZ, N_LINES).unwrap()
}

fn weighed(mass: f64) -> LowFrequency {
    LowFrequency::Free(WeighedMass {
        mass,
        standard_error: 1e-4 * mass,
    })
}

/// Circular noise of `relative` size on every line, and its variance.
pub(crate) fn noisy(
    mobility: &[Complex64],
    relative: f64,
    seed: u64,
) -> (Vec<Complex64>, Vec<f64>) {
    let mut random = Noise::seeded(seed);
    mobility
        .iter()
        .map(|line| {
            let size = relative * line.norm();
            let noise = Complex64::new(random.normal(), random.normal());
            (line + noise * (0.5_f64.sqrt() * size), size * size)
        })
        .unzip()
}

pub(crate) fn measured(mobility: &[Complex64]) -> MeasuredBody {
    MeasuredBody::from_mobility(mobility, STEP_HZ, weighed(mass())).unwrap()
}

fn flagged(screening: &Screening, is_it: impl Fn(&ScreeningFlag) -> bool) {
    let flags = screening.flags();
    assert!(flags.iter().any(is_it), "{flags:?}");
}

/// The lines of a body whose motion precedes the force by this time \[s\].
fn advanced(exact: &[Complex64], by: f64) -> Vec<Complex64> {
    let turn = |line: usize| Complex64::cis(TAU * STEP_HZ * line as f64 * by);
    let lines = exact.iter().enumerate();
    lines.map(|(line, value)| value * turn(line)).collect()
}

#[test]
fn a_delay_between_the_channels_is_acausal_and_active() {
    // the velocity is recorded 0.4 ms too early
    let screening = measured(&advanced(&exact(), 400e-6)).screen();
    flagged(
        &screening,
        |flag| matches!(flag, ScreeningFlag::Acausal { part, .. } if *part > 0.02),
    );
    flagged(
        &screening,
        |flag| matches!(flag, ScreeningFlag::Active { lines, .. } if *lines > 50),
    );
}

/// Lines that are 10 % too large leave a step of 0.05/M in the impulse response before the impulse.
/// It is not flagged if the error of the scale is stated.
#[test]
fn a_stated_error_of_the_scale_is_not_energy_before_the_impulse() {
    let scaled: Vec<Complex64> = exact().iter().map(|line| line * 1.1).collect();
    let is_acausal = |body: MeasuredBody| {
        let flags = body.screen().flags();
        flags
            .iter()
            .any(|flag| matches!(flag, ScreeningFlag::Acausal { .. }))
    };
    assert!(is_acausal(measured(&scaled)));
    assert!(!is_acausal(
        measured(&scaled).with_scale_error(0.05).unwrap()
    ));
}

#[test]
fn a_reversed_sensor_is_active_at_every_line() {
    let reversed: Vec<Complex64> = exact().iter().map(|line| -line).collect();
    let screening = measured(&reversed).screen();
    flagged(
        &screening,
        |flag| matches!(flag, ScreeningFlag::Active { lines, .. } if *lines == N_LINES - 1),
    );
    flagged(
        &screening,
        |flag| matches!(flag, ScreeningFlag::MassContradicted { apparent, .. } if *apparent < 0.0),
    );
}

#[test]
fn active_lines_within_their_error_are_no_fault() {
    // at low frequency the real part of 1/(iωM) is a thousandth of the magnitude: noise of 2 %
    // makes it negative at half the lines
    let (mobility, variance) = noisy(&exact(), 0.02, 11);
    let without = measured(&mobility).screen();
    assert!(without.passivity.active_lines > 10);
    let with = measured(&mobility).with_variance(&variance).unwrap();
    assert_eq!(with.screen().passivity.active_lines, 0);
}

/// Averages of `hits` blows of unit force, each with noise of `level` times the greatest
/// accelerance within the band: the lines, their estimated variances, and their degrees of freedom.
fn struck(exact: &[Complex64], hits: usize, level: f64, seed: u64) -> MeasuredBody {
    let mut random = Noise::seeded(seed);
    let mut normal = || random.normal();
    let omega = |line: usize| TAU * STEP_HZ * line as f64;
    let accelerance = |line: usize| exact[line].norm() * omega(line);
    let greatest = (1..exact.len()).map(accelerance).fold(0.0, f64::max);
    let n = hits as f64;
    let (mut lines, mut variance) = (exact.to_vec(), vec![0.0; exact.len()]);
    for line in 1..exact.len() {
        let size = level * greatest / omega(line) * 0.5_f64.sqrt();
        let blows: Vec<Complex64> = (0..hits)
            .map(|_| Complex64::new(normal(), normal()) * size)
            .collect();
        let mean = blows.iter().sum::<Complex64>() / n;
        lines[line] += mean;
        variance[line] = blows.iter().map(|b| (b - mean).norm_sqr()).sum::<f64>() / (n - 1.0) / n;
    }
    measured(&lines)
        .with_variance(&variance)
        .and_then(|body| body.with_degrees_of_freedom(&vec![2.0 * (n - 1.0); exact.len()]))
        .unwrap()
}

/// Numbers of faultless bodies, out of `n_bodies`, that are wrongly flagged for generating energy,
/// for their mass, and for a delay.
fn accusations(exact: &[Complex64], hits: usize, level: f64, n_bodies: u64) -> [usize; 3] {
    let mut accused = [0; 3];
    for seed in 0..n_bodies {
        for flag in struck(exact, hits, level, 1000 * hits as u64 + seed)
            .screen()
            .flags()
        {
            match flag {
                ScreeningFlag::Active { .. } => accused[0] += 1,
                ScreeningFlag::MassContradicted { .. } => accused[1] += 1,
                ScreeningFlag::Delayed { .. } => accused[2] += 1,
                _ => {}
            }
        }
    }
    accused
}

#[test]
fn s12_right_bodies_are_accused_once_in_a_hundred() {
    let exact = exact();
    let mut all = [0; 3];
    for hits in [3, 5, 10] {
        for level in [5e-4, 5e-3] {
            let accused = accusations(&exact, hits, level, 60);
            println!("{hits} hits, noise {level}: energy, mass, delay of 60: {accused:?}");
            for (sum, one) in all.iter_mut().zip(accused) {
                *sum += one;
            }
        }
    }
    // at a level of 1 %, 3.6 false flags of each kind are expected for 360 bodies; tolerance: four
    // standard deviations above, 11
    assert!(all.iter().all(|accused| *accused <= 11), "{all:?}");
}

#[test]
fn s12_a_delay_of_5_us_is_found_where_it_is_said_that_it_would_be() {
    let exact = exact();
    let right = struck(&exact, 5, 2e-4, 77).screen();
    assert_eq!(right.flags(), []);
    for (direction, sign) in [(0, 1.0), (1, -1.0)] {
        let by_energy = right.passivity.seen_delays[direction].unwrap_or(f64::INFINITY);
        let seen = by_energy.min(right.delay.unwrap().least_seen());
        assert!(seen < 5e-6, "{direction}: {seen}");
        let moved = advanced(&exact, sign * 5e-6);
        flagged(&struck(&moved, 5, 2e-4, 78).screen(), |flag| {
            matches!(
                flag,
                ScreeningFlag::Delayed { .. } | ScreeningFlag::Active { .. }
            )
        });
    }
}

#[test]
fn reciprocity_is_judged_by_the_variances() {
    let exact = exact();
    let ((forward, first), (backward, second)) = (noisy(&exact, 0.03, 5), noisy(&exact, 0.03, 6));
    let same = Reciprocity::between(&forward, &backward, [&first, &second]).unwrap();
    assert_eq!(same.contradicting_lines, 0, "{same:?}");
    let scaled: Vec<Complex64> = backward.iter().map(|line| 1.5 * line).collect();
    let other = Reciprocity::between(&forward, &scaled, [&first, &second]).unwrap();
    assert!(other.contradicting_lines > 1000, "{other:?}");
    assert!((other.relative_difference - 0.25 / 1.5).abs() < 0.02);
}

/// The two directions differ by their noise alone, and their mean has half of its variance.
#[test]
fn the_mean_of_both_directions_has_half_of_the_variance() {
    let exact = exact();
    let of = |seed| {
        let (lines, variance) = noisy(&exact, 0.03, seed);
        measured(&lines).with_variance(&variance).unwrap()
    };
    let (forward, backward) = (of(5), of(6));
    let (mean, found) = forward.mean_of_directions(&backward).unwrap();
    assert_eq!(found.contradicting_lines, 0, "{found:?}");
    // tolerance: three standard errors, 1.6 % each, of a root mean square over 1024 circular lines
    let change = measured(&exact).change_from(&mean);
    assert!((change.in_errors.unwrap() - 1.0).abs() < 0.05, "{change:?}");
    let variances = [&mean, &forward].map(|body| body.variance().unwrap()[500]);
    assert!((2.0 * variances[0] / variances[1] - 1.0).abs() < 1e-9);
    let other = MeasuredBody::from_mobility(&exact, 2.0 * STEP_HZ, weighed(mass())).unwrap();
    assert!(forward.mean_of_directions(&other).is_err());
}

/// A causal projection of noise alone removes half of the power, and a passive one removes the real
/// parts below 0; a body that responds 0.2 ms early changes by far more than its errors.
#[test]
fn a_projection_tells_by_how_much_it_moves_the_lines() {
    let exact = exact();
    let of = |lines: &[Complex64], variance: &[f64]| {
        let body = measured(lines).with_variance(variance).unwrap();
        body.with_front_impedance(front_impedance()).unwrap()
    };
    let (lines, variance) = noisy(&exact, 0.1, 3);
    let body = of(&lines, &variance);
    let causal = body.projected(Projection::Causal).change_from(&body);
    // the noise of the lowest lines is largest and also changes its neighbours
    let in_errors = causal.in_errors.unwrap();
    assert!(in_errors > 0.6 && in_errors < 1.0, "{causal:?}");
    let passive = body.projected(Projection::Passive);
    let change = passive.change_from(&body);
    let below = lines.iter().skip(1).filter(|line| line.re < 0.0).count();
    assert!(below > 10 && change.n_lines == below, "{below} {change:?}");
    let both = body.projected(Projection::CausalAndPassive);
    assert!(both.mobility().iter().all(|line| line.re >= 0.0));
    // causal as well: a further causal projection changes little
    let left = both.projected(Projection::Causal).change_from(&both);
    assert!(
        left.relative < 0.05 * causal.relative,
        "{left:?} {causal:?}"
    );
    let early = of(&advanced(&exact, 2e-4), &variance);
    let moved = early.projected(Projection::Causal).change_from(&early);
    assert!(moved.in_errors.unwrap() > 5.0, "{moved:?}");
}

#[test]
fn what_cannot_be_is_refused() {
    let exact = exact();
    let text = |result: Result<MeasuredBody, ImpulseError>| result.unwrap_err().to_string();
    let mut hole = exact.clone();
    hole[7].im = f64::NAN;
    assert_eq!(
        text(MeasuredBody::from_mobility(&hole, STEP_HZ, weighed(1.0))),
        "element 7 of the measured mobility is not finite"
    );
    let mut no_zero_line = exact.clone();
    no_zero_line[0].re = f64::INFINITY;
    assert!(matches!(
        MeasuredBody::from_mobility(&no_zero_line, STEP_HZ, LowFrequency::Measured),
        Err(ImpulseError::MissingZeroLine { .. })
    ));
    assert!(MeasuredBody::from_mobility(&no_zero_line, STEP_HZ, LowFrequency::Fixed).is_ok());
    assert_eq!(
        text(MeasuredBody::from_mobility(&exact, STEP_HZ, weighed(-1.0))),
        "weighed mass [kg] is -1, expected a finite value above 0"
    );
    let body = measured(&exact);
    assert_eq!(
        text(body.clone().with_variance(&[0.0; 3])),
        "the variance of the mobility has 3 elements, expected 1025"
    );
    assert_eq!(
        lines_of(&body, 20.0, 100).unwrap_err().to_string(),
        "the lines of the measured body are 10 Hz apart, expected 20 Hz as for the other body"
    );
    assert!(lines_of(&body, STEP_HZ, 2 * N_LINES).is_err());
    // the mobility is unknown between the lines and off the frequency axis
    for s in [Complex64::new(0.0, 100.0), Complex64::new(1.0, TAU * 100.0)] {
        assert!(matches!(
            body.mobility_at(s),
            Err(ImpulseError::OutsideDomain { .. })
        ));
    }
}

/// Nylon of 40 mm in front of nylon of 30 mm, and a PMMA-like rod: bodies of few resonances,
/// measured up to 10 kHz.
fn stepped_and_plain() -> [(Vec<Complex64>, f64, f64); 2] {
    let zener = |relaxed: f64, unrelaxed: f64, density: f64| {
        let law = rodwave::modulus::Zener::new(relaxed, unrelaxed, 50e-6).unwrap();
        Medium::new(density, law).unwrap()
    };
    let nylon = zener(2.5e9, 2.9e9, 1150.0);
    let pmma = zener(4.5e9, 5.0e9, 1185.0);
    let stepped = Chain::from_impact_face()
        .rod(&nylon, circle(0.040), 0.150)
        .rod(&nylon, circle(0.030), 0.150);
    let plain = Chain::from_impact_face().rod(&pmma, circle(0.050), 0.400);
    let of = |builder: ChainBuilder<AngularFrequency>, diameter, front_per_area: f64| {
        let chain = builder.end(Termination::Free).unwrap();
        let area = CrossSection::from(circle(diameter)).area();
        (
            lines_of(&chain, STEP_HZ, 1001).unwrap(),
            chain.free_mass().unwrap(),
            area * front_per_area,
        )
    };
    [
        of(stepped, 0.040, (1150.0_f64 * 2.9e9).sqrt()),
        of(plain, 0.050, (1185.0_f64 * 5.0e9).sqrt()),
    ]
}

#[test]
fn r05_no_mean_over_lines_stands_in_for_the_front_impedance() {
    for (mobility, mass, impedance) in stepped_and_plain() {
        let body = MeasuredBody::from_mobility(&mobility, STEP_HZ, weighed(mass)).unwrap();
        assert_eq!(body.front_impedance(), None);
        let rod = MobilityLaw::analytic(|_| Complex64::from(1e-3));
        let impact = Impact::between(&body, &rod).at_velocity(1.0);
        assert_eq!(
            impact.predict(4e-3).unwrap_err(),
            ImpulseError::NoFrontImpedance
        );
        // the stick force on lines needs no front impedance
        let band = LineBand {
            highest_hz: 10e3,
            n_samples: 2000,
        };
        assert!(impact.stick_force_on_lines(band).is_ok());
        let given = body.with_front_impedance(impedance).unwrap();
        let impact = Impact::between(&given, &rod).at_velocity(1.0);
        assert!(impact.predict(4e-3).is_ok());
    }
}

#[test]
fn r05_the_true_front_impedance_is_never_contradicted_and_a_wrong_one_is() {
    let screened = |mobility: &[Complex64], mass: f64, front: f64| {
        let body = MeasuredBody::from_mobility(mobility, STEP_HZ, weighed(mass)).unwrap();
        body.with_front_impedance(front).unwrap().screen()
    };
    for (mobility, mass, impedance) in stepped_and_plain() {
        let right = screened(&mobility, mass, impedance);
        assert_eq!(right.flags(), [], "{right:?}");
    }
    // a rod of one section with enough resonances reveals it: an impedance a fifth larger means
    // another section
    let long = nylon_rod(0.040, 0.900);
    let mobility = lines_of(&long, STEP_HZ, 1001).unwrap();
    for (factor, contradicted) in [(1.0, false), (1.3, true), (0.75, true)] {
        let mass = long.free_mass().unwrap();
        let screening = screened(&mobility, mass, factor * front_impedance());
        let front = screening.front.unwrap();
        assert!(
            (front.apparent / front_impedance() - 1.0).abs() < 0.08,
            "{front:?}"
        );
        let flags = screening.flags();
        let found = flags
            .iter()
            .any(|flag| matches!(flag, ScreeningFlag::FrontContradicted { .. }));
        assert_eq!(found, contradicted, "{factor} {front:?}");
    }
    let reversed: Vec<Complex64> = mobility.iter().map(|line| -line).collect();
    flagged(&measured(&reversed).screen(), |flag| {
        matches!(flag, ScreeningFlag::FrontNotPositive { .. })
    });
}

/// The objections to the mass of a body of 2 kg that is stated to be free but is on a support with
/// a resonance at `support_hz`; its lines above `from_hz` have errors of 0.1 %.
fn objections_to_the_mass(support_hz: f64, from_hz: f64, seed: u64) -> Vec<ScreeningFlag> {
    let step = 25.0 / 16.0;
    let exact = |line: u32| {
        if line == 0 {
            return Complex64::ZERO;
        }
        let s = Complex64::new(0.0, TAU * step * f64::from(line));
        let mode = |hz: f64, damping: f64| {
            let omega = TAU * hz;
            s / (s * s + 2.0 * damping * omega * s + omega * omega)
        };
        0.5 * mode(support_hz, 0.02) + 0.3 * mode(1700.0, 0.02)
    };
    let exact: Vec<Complex64> = (0..2560).map(exact).collect();
    let (mobility, variance) = noisy(&exact, 1e-3, seed);
    let screening = MeasuredBody::from_mobility(&mobility, step, weighed(2.0))
        .and_then(|body| body.with_variance(&variance))
        .unwrap()
        .with_first_measured((from_hz / step).ceil() as usize)
        .screen();
    let mut flags = screening.flags();
    flags.retain(|flag| {
        matches!(
            flag,
            ScreeningFlag::MassContradicted { .. } | ScreeningFlag::NotFree { .. }
        )
    });
    if let [ScreeningFlag::MassContradicted { standard_error, .. }] = flags[..] {
        // the message states the standard error of the mass
        assert_eq!(
            Some(standard_error),
            screening.mass.map(|mass| mass.standard_error)
        );
    }
    flags
}

/// Only four lines are nearly rigid, and their scatter leaves the mass undetermined.
#[test]
fn s12_a_support_that_resonates_below_the_lines_is_told() {
    for seed in 0..5 {
        for (support_hz, from_hz) in [(25.0, 60.0), (40.0, 80.0)] {
            let flags = objections_to_the_mass(support_hz, from_hz, seed);
            assert_eq!(flags.len(), 1, "{support_hz} Hz: {flags:?}");
        }
    }
    assert_eq!(objections_to_the_mass(1.0, 60.0, 1), []);
}
