//! Mistakes of a laboratory, each with the finding that names it, and inputs that are refused.

use impulse::ImpulseError;
use std::sync::Arc;

use impulse::hopkinson::{
    BarGauge, BarMaterial, Curve, Finding, HopkinsonRecord, HopkinsonResult, HopkinsonTest, Known,
    Loading, MeanCurve, Side, Source, WaveSeparation,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodwave::modulus::ConstantQ;
use testbed::hopkinson::HopkinsonRig;

use super::rig::{self, RATE};

const DIAMETER: f64 = 0.014;

/// A fault-free shot with a creeping specimen between nylon bars, and its sheet.
fn shot_of(rig: &HopkinsonRig) -> (HopkinsonTest, HopkinsonRecord) {
    let specimen = rig::norton();
    let length = specimen.length();
    let truth = rig.shot(Some(specimen)).unwrap();
    let record = rig::record(&truth, &rig::quiet(rig, 1e-6), 4);
    (rig::test_of(rig, length, DIAMETER), record)
}

fn shot() -> (HopkinsonTest, HopkinsonRecord) {
    shot_of(&rig::nylon())
}

fn scaled(record: &mut HopkinsonRecord, bar: usize, factor: f64) {
    for sample in record.gauges[bar].iter_mut().flatten() {
        *sample *= factor;
    }
}

/// The findings after a change of sheet and record.
fn found(change: impl Fn(&mut HopkinsonTest, &mut HopkinsonRecord)) -> Vec<Finding> {
    let (mut test, mut record) = shot();
    change(&mut test, &mut record);
    rig::evaluated(&test, &record).findings
}

/// The first finding for which `number` returns a value, with the value and the text of the
/// finding.
fn named(
    findings: &[Finding],
    number: impl Fn(&Finding) -> Option<f64>,
) -> (&Finding, f64, String) {
    let mut all = findings.iter();
    let named = all.find_map(|finding| Some((finding, number(finding)?, finding.to_string())));
    named.unwrap_or_else(|| panic!("{findings:?}"))
}

/// The only finding that is not a remark, and its text.
fn only(findings: &[Finding]) -> (&Finding, String) {
    let grave: Vec<&Finding> = findings.iter().filter(|f| !f.is_remark()).collect();
    let [one] = grave[..] else {
        panic!("{findings:?}");
    };
    (one, one.to_string())
}

#[test]
fn hopkinson_a_good_shot_has_no_findings() {
    let findings = found(|_, _| {});
    assert!(findings.is_empty(), "{findings:?}");
}

#[test]
fn hopkinson_inverted_channels_and_another_loading_are_named() {
    let inverted = found(|_, record| [0, 1].into_iter().for_each(|bar| scaled(record, bar, -1.0)));
    let (finding, said) = only(&inverted);
    assert!(matches!(finding, Finding::WrongSign { peak, .. } if *peak > 0.0) && finding.forbids());
    assert!(said.contains("(tension), expected compression"), "{said}");
    let tension = found(|test, _| test.loading = Loading::Tension);
    let (_, said) = only(&tension);
    assert!(said.contains("(compression), expected tension"), "{said}");
}

#[test]
fn hopkinson_strains_in_another_unit_are_named() {
    let findings = found(|_, record| [0, 1].into_iter().for_each(|bar| scaled(record, bar, 1e3)));
    let (finding, said) = only(&findings);
    assert!(matches!(finding, Finding::StrainOfBar { largest } if *largest > 1.0));
    assert!(finding.forbids() && said.contains("gauge factor"), "{said}");
}

/// The gauge factor of the transmitted bar is a quarter too large: its force is 1.25 times the true
/// one.
#[test]
fn hopkinson_a_wrong_gauge_factor_is_named_by_the_ratio_of_the_forces() {
    let findings = found(|_, record| scaled(record, 1, 1.25));
    let (finding, said) = only(&findings);
    let Finding::ForcesDiffer {
        ratio,
        standard_error,
    } = finding
    else {
        panic!("{findings:?}");
    };
    // in a fault-free shot the two forces are equal within 1 %
    assert!(
        (ratio - 0.8).abs() < 0.02 && *standard_error < 0.05,
        "{said}"
    );
    assert!(!finding.forbids() && said.contains("0.8"), "{said}");
}

/// With gauge factors known to 1 %, a force that is wrong by 3.9 standard errors of the ratio is
/// reported: the limit is three.
#[test]
fn hopkinson_forces_four_errors_apart_are_named() {
    let (mut test, mut record) = shot();
    for bar in &mut test.bars {
        bar.gauges[0].factor_uncertainty = 0.01;
    }
    let right = rig::evaluated(&test, &record);
    let error = right.equilibrium.force_ratio_error;
    let differ = |finding: &Finding| matches!(finding, Finding::ForcesDiffer { .. });
    assert!(
        error > 0.01 && !right.findings.iter().any(differ),
        "{error}"
    );
    scaled(&mut record, 1, 1.0 - 3.9 * error);
    let wrong = rig::evaluated(&test, &record);
    let equilibrium = &wrong.equilibrium;
    let apart = (equilibrium.force_ratio - 1.0) / equilibrium.force_ratio_error;
    // the error is above the limit of three standard errors and would be below a limit of five
    assert!((3.0..5.0).contains(&apart), "{apart}");
    assert!(
        wrong.findings.iter().any(differ),
        "{apart}: {:?}",
        wrong.findings
    );
}

/// The stated length of the specimen is too small: the specimen seems to be compressed to less than
/// nothing.
#[test]
fn hopkinson_a_strain_of_one_in_compression_is_refused() {
    let (mut test, record) = shot();
    let right = rig::evaluated(&test, &record);
    let strain = &right.curves.of(Curve::Strain)[right.loaded.clone()];
    let most = strain.iter().copied().fold(0.0, f64::max);
    test.specimen.length.value *= most / 1.2;
    let findings = rig::evaluated(&test, &record).findings;
    let (finding, largest, said) = named(&findings, |finding| match finding {
        Finding::StrainOfSpecimen { largest } => Some(*largest),
        _ => None,
    });
    assert!(finding.forbids() && (largest - 1.2).abs() < 1e-6, "{said}");
    assert!(
        said.contains("1.200 in compression, expected less than 1: check the length"),
        "{said}"
    );
}

/// A modulus that makes the wave speed 8 or 15 % too high. At 15 % the reflected wave arrives too
/// late for the stated speed. At 8 % the delay could be due to the front of the specimen, because
/// the wave rises within 0.12 ms; the error is then found from the forces of the two faces.
#[test]
fn hopkinson_a_wrong_wave_speed_is_named_with_the_one_found() {
    let with = |factor: f64| {
        found(|test, _| {
            for bar in &mut test.bars {
                bar.material = bar.material.scaled(factor * factor, 1.0).unwrap();
            }
        })
    };
    let (less, said) = (with(1.08), "8 % too high");
    assert!(less.iter().any(|finding| !finding.is_remark()), "{said}");
    let findings = with(1.15);
    let (_, ratio, said) = named(&findings, |finding| match finding {
        Finding::WaveSpeed { stated, found } => Some(stated / found),
        _ => None,
    });
    // tolerance: the creeping specimen reflects another front, which shifts the arrival by a few
    // per cent
    assert!((ratio - 1.15).abs() < 0.03, "{said}");
}

/// Pulses that rise slowly, as behind a pulse shaper: the front reflected by the specimen begins
/// later, which is not flagged as a wrong wave speed.
#[test]
fn hopkinson_a_slow_front_is_no_wrong_wave_speed() {
    for rise in [150e-6, 250e-6] {
        let mut rig = rig::nylon();
        rig.pulse[0] = rise;
        let (test, record) = shot_of(&rig);
        let findings = rig::evaluated(&test, &record).findings;
        let is_speed = |finding: &Finding| matches!(finding, Finding::WaveSpeed { .. });
        assert!(!findings.iter().any(is_speed), "{rise}: {findings:?}");
    }
}

fn ahead(record: &mut HopkinsonRecord) {
    for samples in &mut record.gauges[1] {
        samples.rotate_left(60);
    }
}

/// The recorder of the transmitted bar is 60 us ahead.
#[test]
fn hopkinson_a_channel_ahead_of_the_others_is_named_and_alignment_takes_its_lag() {
    let findings = found(|_, record| ahead(record));
    let (_, by, said) = named(&findings, |finding| match finding {
        Finding::TransmittedEarly { by } => Some(*by),
        _ => None,
    });
    // tolerance: the specimen delays the rise of the transmitted force, and with it the time at
    // which the force exceeds a quarter of its peak, by some microseconds
    assert!((by - 60e-6).abs() < 15e-6, "{said}");
    let (mut test, mut record) = shot();
    let right = rig::evaluated(&test, &record);
    ahead(&mut record);
    test.align_arrivals = true;
    let aligned = rig::evaluated(&test, &record);
    assert!(
        (aligned.lag_taken + 60e-6).abs() < 15e-6,
        "{}",
        aligned.lag_taken
    );
    let mean = |result: &HopkinsonResult| {
        let stress = result.curves.of(Curve::Stress);
        let loaded = &stress[result.loaded.clone()];
        loaded.iter().sum::<f64>() / loaded.len() as f64
    };
    assert!((mean(&aligned) / mean(&right) - 1.0).abs() < 0.03);
}

/// The recorder of the transmitted bar is 60 us ahead, and its delay is known to 60 us.
#[test]
fn hopkinson_a_lead_within_the_errors_of_the_forces_is_not_reported() {
    let findings = found(|test, record| {
        test.bars[1].gauges[0].delay_uncertainty = 60e-6;
        ahead(record);
    });
    let early = |finding: &Finding| matches!(finding, Finding::TransmittedEarly { .. });
    assert!(!findings.iter().any(early), "{findings:?}");
}

#[test]
fn hopkinson_a_law_that_ends_below_the_band_is_named() {
    let findings = found(|test, _| {
        for bar in &mut test.bars {
            bar.material = bar.material.clone().known_to(5e3);
        }
        test.band_hz = Some(9e3);
    });
    let beyond = Finding::BeyondLaw {
        band_hz: 9e3,
        known_to_hz: 5e3,
    };
    assert!(findings.contains(&beyond), "{findings:?}");
    let said = beyond.to_string();
    assert!(
        said.contains("9000 Hz") && said.contains("5000 Hz"),
        "{said}"
    );
    // without a stated end, the band ends where the law does
    let (mut test, record) = shot();
    for bar in &mut test.bars {
        bar.material = bar.material.clone().known_to(5e3);
    }
    assert!(rig::evaluated(&test, &record).band_hz <= 5e3);
}

/// A ramp from the trigger on, on the second gauge that the incident wave reaches.
#[test]
fn hopkinson_a_drifting_bridge_of_two_is_remarked() {
    let rig = HopkinsonRig {
        gauges: [vec![1.1, 0.6], vec![0.3, 0.8]],
        ..rig::steel()
    };
    let specimen = rig::hardening();
    let length = specimen.length();
    let truth = rig.shot(Some(specimen)).unwrap();
    let test = rig::test_of(&rig, length, 0.010);
    let drifts = |slope: f64| {
        let mut record = rig::record(&truth, &rig::quiet(&rig, 1e-6), 4);
        for (sample, strain) in record.gauges[0][1].iter_mut().enumerate() {
            *strain += slope * sample as f64;
        }
        let findings = rig::evaluated(&test, &record).findings.into_iter();
        findings
            .filter(|found| matches!(found, Finding::GaugeDrift { .. }))
            .collect::<Vec<_>>()
    };
    let none = drifts(0.0);
    assert!(none.is_empty(), "{none:?}");
    // a wave returns about 0.5 ms, 500 samples, after the middle of the silence: the drift is 500 x
    // 2.4e-8 = 1.2e-5, which is 1.3 % of the peak of 9.3e-4
    let found = drifts(2.4e-8);
    let &[
        Finding::GaugeDrift {
            side: Side::Incident,
            gauge: 1,
            drift,
            ..
        },
    ] = found.as_slice()
    else {
        panic!("{found:?}");
    };
    assert!((drift - 0.013).abs() < 0.003, "{drift}");
    assert!(found[0].is_remark());
}

#[test]
fn hopkinson_a_record_that_ends_under_load_is_named() {
    let (test, record) = shot();
    let whole = rig::evaluated(&test, &record);
    let middle = rig::middle(&whole);
    let gauges = [0, 1].map(|bar: usize| test.bars[bar].gauges[0].distance.value);
    let speed = test.bars[0].phase_velocity(3e3).unwrap();
    // travel time to the farther gauge, and one period of the highest frequency of the band
    let way = gauges[0].max(gauges[1]) / speed + 1.0 / whole.band_hz;
    let end = (whole.time_at(middle) + way) * RATE;
    let end = end as usize;
    let findings = found(|_, record| {
        for samples in record.gauges.iter_mut().flatten() {
            samples.truncate(end);
        }
    });
    let (_, part, said) = named(&findings, |finding| match finding {
        Finding::RecordEnds { part } => Some(*part),
        _ => None,
    });
    // a record that ends during unloading is only a remark: the curve is correct up to its end
    assert!(Finding::RecordEnds { part: 0.3 }.is_remark());
    assert!(!Finding::RecordEnds { part: 0.9 }.is_remark());
    assert!(
        (0.2..=1.0).contains(&part) && said.contains("record ends"),
        "{said}"
    );
}

#[test]
fn hopkinson_a_band_in_which_waves_have_died_out_is_named() {
    // a wave of 30 kHz falls by e^-8 on its way of 0.7 m
    let lossy = ConstantQ::new(2.9e9, 0.2, std::f64::consts::TAU * 1e3).unwrap();
    let findings = found(|test, _| {
        let density = test.bars[0].material.density();
        test.bars[0].material = BarMaterial::new(density, Arc::new(lossy)).unwrap();
        test.band_hz = Some(3e4);
    });
    let (_, by, said) = named(&findings, |finding| match finding {
        Finding::Amplified { by } => Some(*by),
        _ => None,
    });
    assert!(
        by > 10.0 && said.contains("lower the end of the band"),
        "{said}"
    );
}

/// The incident gauge is 0.04 m nearer than stated: the reflected wave is propagated to the face
/// too early, and the face seems to pull.
#[test]
fn hopkinson_a_face_that_pulls_is_named() {
    let findings = found(|test, _| test.bars[0].gauges[0].distance.value += 0.04);
    let said = (findings.iter())
        .find(|f| matches!(f, Finding::FacePulls { .. }))
        .map_or_else(|| panic!("{findings:?}"), Finding::to_string);
    assert!(said.contains("incident bar pulls"), "{said}");
}

/// The relative effect of a source on the stress in the middle of the loading.
fn of_source(result: &HopkinsonResult, source: Source) -> f64 {
    let middle = rig::middle(result);
    let effect = result.common.iter().find(|e| e.source == source).unwrap();
    effect.on(Curve::Stress)[middle] / result.curves.of(Curve::Stress)[middle]
}

/// Torsion of a thin tube, from the records of the compression as shear strains at the surface of
/// the bars: the stress due to the torque π d³ G γ/16, compared with that due to the force
/// π d² E ε/4.
#[test]
fn hopkinson_torsion_has_the_stress_of_a_torque() {
    let (axial, record) = shot();
    let rig = rig::nylon();
    let in_compression = rig::evaluated(&axial, &record);
    let (outer, wall) = (0.014, 0.0008);
    let mut test = axial.clone();
    test.loading = Loading::Torsion;
    test.specimen.wall = Some(Known::within(wall, 8e-6));
    let mut torque = record.clone();
    [0, 1]
        .into_iter()
        .for_each(|bar| scaled(&mut torque, bar, -1.0));
    let in_torsion = rig::evaluated(&test, &torque);
    let radius = 0.5 * (outer - wall);
    let per_torque = 1.0 / (2.0 * std::f64::consts::PI * radius * radius * wall);
    let expected = 0.25 * rig.diameter * per_torque * rig::area(outer);
    let middle = rig::middle(&in_compression);
    let at = |result: &HopkinsonResult| result.curves.of(Curve::Stress)[middle];
    // records and law of the modulus are the same in both loadings, so that the stresses differ
    // only by constant factors
    let ratio = at(&in_torsion) / at(&in_compression);
    assert!((ratio / expected - 1.0).abs() < 1e-9, "{ratio} {expected}");
    // the stress is proportional to 1/(r² t); the mean radius r decreases by half of the increase
    // of the wall t
    let relative = of_source(&in_torsion, Source::SpecimenWall);
    let exact = 8e-6 * (1.0 / wall - 1.0 / radius);
    assert!(
        (relative.abs() / exact - 1.0).abs() < 1e-3,
        "{relative} {exact}"
    );
}

/// Every source has its name in the budget, and only the sources of the specimen differ between
/// shots.
#[test]
fn hopkinson_sources_of_errors_are_named() {
    let (mut test, record) = shot();
    for bar in &mut test.bars {
        bar.diameter.standard_uncertainty = 1e-5;
        bar.poisson_ratio = Some(Known::within(0.39, 0.01));
        bar.gauges[0] = BarGauge {
            distance: Known::within(bar.gauges[0].distance.value, 1e-3),
            factor_uncertainty: 0.005,
            delay_uncertainty: 1e-7,
        };
    }
    test.separation[1] = WaveSeparation::FreeEnd;
    test.bars[1].length.standard_uncertainty = 1e-3;
    test.specimen.length.standard_uncertainty = 1e-5;
    test.specimen.diameter.standard_uncertainty = 1e-5;
    let result = rig::evaluated(&test, &record);
    let named: Vec<String> = result.common.iter().map(|e| e.source.to_string()).collect();
    for expected in [
        "gauge factor, incident bar, gauge 1",
        "gauge position, transmitted bar, gauge 1",
        "delay, transmitted bar, gauge 1",
        "diameter of the incident bar",
        "length of the transmitted bar",
        "Poisson's ratio of the incident bar",
        "specimen length",
        "specimen diameter",
    ] {
        assert!(
            named.iter().any(|name| name == expected),
            "{expected}: {named:?}"
        );
    }
    let own = result.common.iter().filter(|e| e.source.is_of_one_shot());
    assert_eq!(own.count(), 2);
    // the standard uncertainty of the diameter is 1e-5 m of 14e-3 m; the relative error of the
    // area, and so of the stress, is twice as large
    let relative = of_source(&result, Source::SpecimenDiameter);
    assert!(
        (relative.abs() / (2e-5 / DIAMETER) - 1.0).abs() < 1e-3,
        "{relative}"
    );
}

/// Sheets and records that cannot be evaluated, each with a part of the message.
#[test]
fn hopkinson_sheets_and_records_that_cannot_be_are_refused() {
    type Change = fn(&mut HopkinsonTest, &mut HopkinsonRecord);
    let (good, record) = shot();
    let refused = |test: &HopkinsonTest, record: &HopkinsonRecord| {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        test.evaluate(record, &mut random)
            .map(|result| result.findings)
            .unwrap_err()
    };
    let cases: [(Change, &str); 19] = [
        (
            |test, _| test.bars[0].gauges[0].distance.value = 9.0,
            "less than the length of its bar",
        ),
        (|test, _| test.bars[1].gauges.clear(), "gauges of a bar"),
        (
            |test, _| {
                let gauge = test.bars[0].gauges[0];
                test.bars[0].gauges.push(gauge);
            },
            "two gauges at one section",
        ),
        (
            |test, _| test.separation[0] = WaveSeparation::TwoGauges,
            "given its separation of the waves",
        ),
        (
            |test, _| test.separation[0] = WaveSeparation::FreeEnd,
            "the striker touches that end",
        ),
        (
            |test, _| test.separation[1] = WaveSeparation::Balanced,
            "this bar itself provides the force",
        ),
        (
            |test, _| {
                test.loading = Loading::Torsion;
                test.specimen.wall = Some(Known::exactly(1e-3));
                test.bars[0].poisson_ratio = Some(Known::exactly(0.3));
            },
            "Poisson's ratio of a bar in torsion",
        ),
        (
            |test, _| test.loading = Loading::Torsion,
            "torsion requires a thin tube",
        ),
        (
            |test, _| {
                test.loading = Loading::Torsion;
                test.specimen.wall = Some(Known::exactly(0.007));
            },
            "less than its outer radius",
        ),
        (
            |test, _| test.specimen.wall = Some(Known::exactly(1e-3)),
            "none, except for torsion",
        ),
        (
            |test, _| test.band_hz = Some(0.5 * RATE),
            "at most 0.4 of the sampling rate",
        ),
        (
            |test, _| test.specimen.length.value = f64::NAN,
            "length of the specimen",
        ),
        (
            |_, record| record.gauges[1].clear(),
            "list of records of a bar",
        ),
        (
            |_, record| record.gauges[1][0].truncate(900),
            "record of a gauge",
        ),
        (|_, record| record.silent = 1 << 20, "record of a gauge"),
        (
            |_, record| record.gauges[0][0][7] = f64::NAN,
            "record of a gauge",
        ),
        (|_, record| record.rate_hz = 0.0, "sampling rate"),
        (
            |_, record| {
                let middle = record.gauges[0][0].len() / 2;
                record.silent = middle;
            },
            "silence",
        ),
        (
            |_, record| {
                for samples in record.gauges.iter_mut().flatten() {
                    samples.truncate(record.silent + 10);
                }
            },
            "incident bar",
        ),
    ];
    for (number, (change, expected)) in cases.iter().enumerate() {
        let (mut test, mut record) = (good.clone(), record.clone());
        change(&mut test, &mut record);
        let said = refused(&test, &record).to_string();
        assert!(said.contains(expected), "{number}: {said}");
    }
    // the transmitted bar responds first if the records are exchanged
    let mut record = record.clone();
    record.gauges.swap(0, 1);
    let error = refused(&good, &record);
    assert!(
        matches!(error, ImpulseError::TransmittedFirst { .. }),
        "{error}"
    );
}

#[test]
fn hopkinson_a_mean_needs_shots_and_a_probability() {
    let error = MeanCurve::of(&[]).unwrap_err().to_string();
    assert!(error.contains("list of shots"), "{error}");
    let (test, record) = shot();
    let one = rig::evaluated(&test, &record);
    let single = MeanCurve::of(std::slice::from_ref(&one)).unwrap();
    assert!(!single.specimens_differ(0.05).unwrap() && single.specimens_differ(1.5).is_err());
    // two shots, one with a specimen stated 20 % too thin: its stress is 1/0.8² = 1.56 times as
    // large
    let mut thin = test;
    thin.specimen.diameter.value *= 0.8;
    let two = MeanCurve::of(&[one.clone(), rig::evaluated(&thin, &record)]).unwrap();
    assert!(two.specimens_differ(0.01).unwrap());
    let mut unloaded = one;
    unloaded.loaded = unloaded.loaded.start..unloaded.loaded.start + 3;
    let error = MeanCurve::of(&[unloaded]).unwrap_err().to_string();
    assert!(error.contains("rising strain"), "{error}");
}
