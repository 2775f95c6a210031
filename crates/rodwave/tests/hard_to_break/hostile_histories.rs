//! Histories, syntheses, marches and impacts with hostile sizes, steps and durations.

use num_complex::Complex64;
use rodwave::band_limited::{Recorder, SampledHistory, VelocityHistory};
use rodwave::chain::AnalyticChain;
use rodwave::element::CrossSection;
use rodwave::experiment::Acquisition;
use rodwave::experiment::impact_of_two_bodies::ImpactOfTwoBodies;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{Elastic, Maxwell};
use rodwave::line::{Body, Drive, End, Gauge, Line, Segment};
use rodwave::lumped::LumpedRod;
use rodwave::medium::Medium;
use rodwave::synthesis::{DampedSynthesis, FourierSynthesis};
use rodwave::{DirectProblem, InelasticRod, Termination, modulus};

use super::Findings;
use super::hostile::are_modest;

#[test]
fn sampled_histories() {
    let mut findings = Findings::default();
    findings.sweep_pairs("SampledHistory", &[0.1, 0.5, 1e5, 2e-5], |a| {
        let history = SampledHistory::new(&[0.0, a[0], a[1], 0.3, 0.1], a[2])?;
        let (value, slope) = (history.at(a[3]), history.slope(a[3]));
        // the velocity at a NaN time is NaN
        let numbers = are_modest(a).then_some([value, slope]);
        Ok(numbers.into_iter().flatten().collect())
    });
    findings.sweep_pairs("Recorder", &[1e5, 4e4, 1e-6, 5e-5], |a| {
        let recorder = Recorder {
            rate_hz: a[0],
            cutoff_hz: a[1],
        };
        // the function does not check its arguments; the only requirement is that it does not panic
        let _ = recorder.filtered(&[0.0, 1.0, 0.5, 0.0, 0.2], a[2], a[3]);
        Ok(Vec::new())
    });
    findings.none();
}

#[test]
fn syntheses() {
    let mut findings = Findings::default();
    findings.sweep_pairs("DampedSynthesis", &[1e-3, 1e-4, 1e-5, 2.0, 1.0], |a| {
        let synthesis = DampedSynthesis::new(a[0], a[1])?.smoothed(a[2])?;
        let count = synthesis.arguments().len();
        if count > 1000 {
            return Ok(vec![synthesis.damping()]);
        }
        let arguments: Vec<Complex64> = synthesis.arguments().collect();
        let history = synthesis.history(&vec![Complex64::new(a[3], a[4]); count])?;
        let mut numbers = history.samples;
        numbers.extend([history.start, history.interval]);
        numbers.extend(arguments.iter().flat_map(|s| [s.re, s.im]));
        Ok(numbers)
    });
    findings.sweep_pairs("FourierSynthesis", &[10.0, 2.0, 1.0], |a| {
        let synthesis = FourierSynthesis::new(a[0], 8)?;
        let history = synthesis.history(&[Complex64::new(a[1], a[2]); 8])?;
        let mut numbers = history.samples;
        numbers.extend(synthesis.omegas());
        numbers.push(history.interval);
        Ok(numbers)
    });
    findings.none();
}

/// Checks that sizes that would fill the memory or take too long are rejected.
#[test]
fn absurd_counts() {
    let rod = || InelasticRod::new(0.4, 1140.0, 3.2e9, Elastic).unwrap();
    for cells in [
        0,
        1,
        2,
        3,
        1 << 40,
        usize::MAX / 8,
        usize::MAX - 1,
        usize::MAX,
    ] {
        assert!(DirectProblem::new(rod(), cells).is_err(), "{cells}");
        assert!(LumpedRod::new(&rod(), cells, 0.8).is_err(), "{cells}");
    }
    for lines in [0, 1, usize::MAX] {
        assert!(FourierSynthesis::new(10.0, lines).is_err(), "{lines}");
    }
    assert!(Line::new([]).is_err() && Body::new([]).is_err());
    let acquisition = |samples_before, samples_after| Acquisition {
        recorder: Recorder {
            rate_hz: 1e5,
            cutoff_hz: 4e4,
        },
        samples_before,
        samples_after,
        transducer_range: 0.1,
    };
    let test = impact(Striker::PAPER_D, 0.4, 0.016, 0.1);
    for (before, after) in [
        (0, 0),
        (usize::MAX, 1),
        (1, usize::MAX),
        (usize::MAX, usize::MAX),
    ] {
        let recorded = test.record(&acquisition(before, after), 4e-3);
        assert!(recorded.is_err(), "{before}, {after}");
    }
}

fn impact(striker: Striker, length: f64, diameter: f64, distance: f64) -> ImpactTest<Elastic> {
    ImpactTest {
        striker,
        rod: InelasticRod::new(length, 1140.0, 3.2e9, Elastic).unwrap(),
        diameter,
        section_distance: distance,
    }
}

#[test]
fn marches() {
    let mut findings = Findings::default();
    findings.sweep_pairs("InelasticRod", &[0.4, 1140.0, 3.2e9, 1e6, 1e-5], |a| {
        let rod = InelasticRod::new(a[0], a[1], a[2], Maxwell::new(a[3])?)?;
        let mut numbers = vec![
            rod.wave_speed(),
            rod.specific_impedance(),
            rod.transit_time(),
        ];
        let mut march = DirectProblem::new(rod, 8)?.march(a[4]);
        for _ in 0..20 {
            march.advance(a[4]);
        }
        if are_modest(a) {
            numbers.push(march.free_end_velocity());
        }
        Ok(numbers)
    });
    let sampled = || SampledHistory::new(&[0.0, 1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0], 1e5).unwrap();
    findings.sweep_pairs("free_end_velocity", &[0.4, 1140.0, 3.2e9, 3e-5], |a| {
        let rod = InelasticRod::new(a[0], a[1], a[2], Elastic)?;
        if is_long(a[3] / rod.transit_time() * 8.0, 8.0) {
            return Ok(Vec::new());
        }
        let lumped = LumpedRod::new(&rod, 8, 0.8)?.free_end_velocity(&sampled(), &[a[3]])?;
        let problem = DirectProblem::new(rod, 8)?;
        let response = problem.free_end_velocity_with_sensitivities(&sampled(), &[a[3]])?;
        let velocity = problem.free_end_velocity(&sampled(), &[a[3]])?;
        Ok([lumped, response.velocity, response.by_log_modulus, velocity].concat())
    });
    findings.sweep_pairs("LumpedRod", &[0.4, 0.8, 0.2], |a| {
        let rod = InelasticRod::new(a[0], 1140.0, 3.2e9, Elastic)?;
        let lumped = LumpedRod::new(&rod, 8, a[1])?;
        // the velocity at a NaN position is NaN
        let velocity = lumped.velocity_at(a[2]);
        let numbers = [lumped.time_step(), lumped.end_mass()];
        Ok(numbers
            .into_iter()
            .chain(are_modest(a).then_some(velocity))
            .collect())
    });
    findings.none();
}

#[test]
fn impacts() {
    let mut findings = Findings::default();
    let sound = [0.03, 0.016, 2700.0, 69e9, 10.0, 0.4, 0.016, 0.1, 1e-3, 1e-4];
    findings.sweep("ImpactTest", &sound, |a| {
        let striker = Striker {
            length: a[0],
            diameter: a[1],
            density: a[2],
            modulus: a[3],
            velocity: a[4],
        };
        let test = ImpactTest {
            rod: InelasticRod::new(a[5], 1140.0, 3.2e9, Elastic)?,
            striker,
            diameter: a[6],
            section_distance: a[7],
        };
        if is_long_impact(&test, a[8], a[9]) {
            return Ok(Vec::new());
        }
        let history = test.run(a[8], a[9])?;
        let balance = history.balance;
        let mut numbers = vec![
            balance.momentum_residual,
            balance.energy_before,
            balance.energy_after,
            balance.energy_dissipated,
        ];
        numbers.extend(history.contact_force);
        numbers.extend(history.free_end_velocity);
        numbers.extend(history.section_velocity);
        Ok(numbers)
    });
    findings.none();
}

/// Returns true if a march of this many steps and cells is allowed but takes too long for a test.
fn is_long(steps: f64, cells: f64) -> bool {
    steps * cells > 2e5 && steps < 1e9 && cells < 2e8
}

fn is_long_impact(test: &ImpactTest<Elastic>, cell: f64, duration: f64) -> bool {
    let cells = (test.rod.length() / cell).max(4.0);
    let step = 0.8 * test.rod.length() / cells / test.rod.wave_speed();
    let striker = test.striker;
    let of_striker = striker.length / (striker.modulus / striker.density).sqrt() / step;
    is_long(duration / step, cells + of_striker.max(4.0))
}

#[test]
fn lines() {
    let mut findings = Findings::default();
    let sound = [0.1, 1e-4, 7800.0, 2e11, 1e6, 5.0, 1e-6, 1e-4, 0.05, 0.1];
    findings.sweep("Line", &sound, |a| {
        let segment =
            Segment::elastic(a[0], a[1], a[2], a[3])?.with_branch(1e10, Maxwell::new(a[4])?)?;
        let mut numbers = vec![
            segment.mass(),
            segment.wave_speed(),
            segment.impedance(),
            segment.transit_time(),
        ];
        let striker = Body::new([segment.clone()])?.moving_at(a[5])?;
        let struck = Body::new([segment])?;
        let line = Line::new([striker, struck])?
            .with_gap(0, a[9])?
            .with_right_end(End::Mass(a[9]))?;
        let cells = 2.0
            * line
                .segments()
                .map(Segment::transit_time)
                .fold(0.0, f64::max)
            / a[6];
        if is_long(a[7] / a[6] + 8.0 * a[7] * cells, cells) {
            return Ok(numbers);
        }
        let gauge = Gauge {
            body: 1,
            position: a[8],
        };
        let history = line.run(a[6], a[7], &[gauge])?;
        let ledger = history.ledger;
        numbers.extend([ledger.stored, ledger.momentum, ledger.dissipated]);
        for gauge in &history.gauges {
            numbers.extend(&gauge.velocity);
            numbers.extend(&gauge.stress);
            numbers.extend(&gauge.strain);
        }
        Ok(numbers)
    });
    findings.sweep_pairs("driven Line", &[1.0, 10.0], |a| {
        let segment = Segment::elastic(0.1, 1e-4, 7800.0, 2e11)?;
        let (force, velocity) = (a[0], a[1]);
        let line = Line::new([Body::new([segment])?])?
            .with_left_end(End::Force(Drive::of(move |_| force)))?
            .with_right_end(End::Velocity(Drive::of(move |_| velocity)))?;
        let history = line.run(1e-6, 5e-5, &[])?;
        let ends = history.ends.iter();
        Ok(ends
            .flat_map(|end| [&end.force[..], &end.velocity].concat())
            .collect())
    });
    findings.none();
}

#[test]
fn two_bodies() {
    let mut findings = Findings::default();
    findings.sweep_pairs("ImpactOfTwoBodies", &[1e-4, 0.2, 2.0, 2e-4, 4e-6], |a| {
        let steel = Medium::new(7780.0, modulus::Elastic::new(206e9)?)?;
        let body = |length| {
            AnalyticChain::analytic_from_impact_face()
                .rod(&steel, CrossSection::of_area(a[0]), length)
                .end(Termination::Free)
        };
        let (first, second) = (body(a[1])?, body(0.3)?);
        let impact = ImpactOfTwoBodies {
            first: &first,
            second: &second,
            velocity: a[2],
        };
        if a[3] / a[4] > 1e3 && a[3] / a[4] < 4e7 {
            return Ok(Vec::new()); // long, but possible
        }
        let record = impact.run(a[3], a[4])?;
        let mut numbers = Vec::new();
        if are_modest(a) {
            numbers.extend([record.impulse(), record.work_on_second()]);
        }
        numbers.extend(record.second_acceleration()?);
        numbers.extend(record.transmitted_force(0, 0.1)?);
        numbers.extend(record.force);
        Ok(numbers)
    });
    findings.none();
}
