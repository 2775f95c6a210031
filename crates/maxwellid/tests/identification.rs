//! Identification of virtual tests made by the lumped chain and the striker, and what it must
//! refuse or doubt.

use maxwellid::{
    Fit, IdentifiableLaw, Identification, MaxwellidError, Noise, Provenance, RodTest, RodTestData,
    Verdict,
};
use rodwave::band_limited::Recorder;
use rodwave::experiment::{Acquisition, VelocityRecord};
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::lumped::{self, LumpedRod};
use rodwave::{DirectProblem, InelasticRod, characteristics};

const ACQUISITION: Acquisition = Acquisition {
    recorder: Recorder {
        rate_hz: 51_200.0,
        cutoff_hz: 16_000.0,
    },
    samples_before: 32,
    samples_after: 128,
    transducer_range: 0.020,
};
const DENSITY: f64 = 1100.0;
const LENGTH: f64 = 0.4;

fn rod<L: InelasticLaw>(modulus: f64, law: &L) -> InelasticRod<L> {
    InelasticRod::new(LENGTH, DENSITY, modulus, law.clone()).unwrap()
}

/// The excitation that the striker of paper D gives a rod 8 mm longer than the distance between the
/// sections.
fn struck<L: InelasticLaw>(modulus: f64, law: &L) -> VelocityRecord {
    ImpactTest {
        striker: Striker::PAPER_D,
        rod: InelasticRod::new(LENGTH + 0.008, DENSITY, modulus, law.clone()).unwrap(),
        diameter: 0.016,
        section_distance: LENGTH,
    }
    .record(&ACQUISITION, 0.5e-3)
    .unwrap()
}

fn times(record: &VelocityRecord) -> Vec<f64> {
    (0..record.excitation.len())
        .map(|k| f64::from(u32::try_from(k).unwrap()) / record.sampling_rate_hz)
        .collect()
}

fn data(record: &VelocityRecord, response: Vec<f64>, generator: &str) -> RodTestData {
    RodTestData {
        name: "virtual rod".into(),
        length: LENGTH,
        density: DENSITY,
        impact_velocity: 10.0,
        sampling_rate_hz: record.sampling_rate_hz,
        excitation: record.excitation.clone(),
        response,
        provenance: Provenance::Virtual {
            generator: generator.into(),
        },
    }
}

/// Data of the lumped chain, driven by the excitation as it was before sampling.
fn independent_test<L: InelasticLaw>(modulus: f64, law: &L) -> RodTest {
    let record = struck(modulus, law);
    let response = LumpedRod::new(&rod(modulus, law), 800, 0.5)
        .unwrap()
        .free_end_velocity(&record.excitation_before_sampling, &times(&record))
        .unwrap();
    RodTest::new(data(&record, response, lumped::GENERATOR)).unwrap()
}

/// Data of the inverting solver itself, as in the appendix of paper D.
fn round_trip_test<L: InelasticLaw>(modulus: f64, law: &L, cell: f64) -> RodTest {
    let record = struck(modulus, law);
    let excitation =
        rodwave::band_limited::SampledHistory::new(&record.excitation, record.sampling_rate_hz)
            .unwrap();
    let response = DirectProblem::new(rod(modulus, law), (LENGTH / cell).ceil() as usize)
        .unwrap()
        .free_end_velocity(&excitation, &times(&record))
        .unwrap();
    RodTest::new(data(&record, response, characteristics::GENERATOR)).unwrap()
}

fn value<L: IdentifiableLaw>(fit: &Identification<L>, symbol: &str) -> f64 {
    fit.identifiability(Noise::FromResidual)
        .unwrap()
        .estimates
        .iter()
        .find(|e| e.symbol == symbol)
        .unwrap()
        .value
}

fn ratio_error(found: f64, expected: f64) -> f64 {
    (found / expected - 1.0).abs()
}

#[test]
fn maxwell_is_recovered_from_an_independent_solver() {
    // row M1 of Table A1 with its time unit read as ms
    let fit = Fit::of(Maxwell::new(1e6).unwrap())
        .with_cell(2e-3)
        .to(&[independent_test(3.056e9, &Maxwell::new(11.12e6).unwrap())])
        .unwrap();
    assert!(fit.termination().was_successful());
    // the two solvers differ by 1e-4 of V0; damping changes the response by some per cent of V0
    assert!(
        ratio_error(fit.modulus(), 3.056e9) < 5e-4,
        "{}",
        fit.report(Noise::FromResidual)
    );
    assert!(
        ratio_error(value(&fit, "eta"), 11.12e6) < 0.013,
        "{}",
        fit.report(Noise::FromResidual)
    );
}

#[test]
fn norton_is_recovered_from_an_independent_solver() {
    let truth = MaxwellNorton::new(2.108, 7e13).unwrap();
    let start = MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6).unwrap();
    let fit = Fit::of(start)
        .with_cell(2e-3)
        .to(&[independent_test(2.58e9, &truth)])
        .unwrap();
    assert!(fit.termination().was_successful());
    let report = fit.report(Noise::Known(0.02));
    assert!(ratio_error(fit.modulus(), 2.58e9) < 5e-4, "{report}");
    assert!((value(&fit, "kappa") - 2.108).abs() < 0.05, "{report}");
    assert!(
        ratio_error(value(&fit, "F(10 MPa)"), truth.inelastic_strain_rate(10e6)) < 0.02,
        "{report}"
    );
}

#[test]
fn gurevich_rabinovich_is_recovered_where_the_activation_stress_acts() {
    let truth = MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap();
    let start = MaxwellGurevichRabinovich::from_reference_rate(0.2, 1.0, 10e6).unwrap();
    let fit = Fit::of(start)
        .with_cell(2e-3)
        .to(&[independent_test(2.107e9, &truth)])
        .unwrap();
    let report = fit.report(Noise::Known(0.02));
    assert!(fit.termination().was_successful(), "{report}");
    assert!(ratio_error(fit.modulus(), 2.107e9) < 5e-4, "{report}");
    assert!(ratio_error(value(&fit, "m"), 7.08e6) < 0.03, "{report}");
    assert!(ratio_error(value(&fit, "eta"), 3.5e6) < 0.03, "{report}");
}

#[test]
fn a_round_trip_ends_at_rounding() {
    let truth = MaxwellNorton::new(2.108, 7e13).unwrap();
    let test = round_trip_test(2.58e9, &truth, 4e-3);
    let fit = Fit::of(MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6).unwrap())
        .round_trip()
        .to(&[test])
        .unwrap();
    assert!(
        fit.relative_error() < 1e-10,
        "{}",
        fit.report(Noise::FromResidual)
    );
    assert!(ratio_error(value(&fit, "B"), 7e13) < 1e-6);
}

#[test]
fn data_of_the_inverting_solver_are_refused() {
    let law = Maxwell::new(4e6).unwrap();
    let error = Fit::of(law)
        .to(&[round_trip_test(3e9, &law, 4e-3)])
        .unwrap_err();
    assert!(
        matches!(&error, MaxwellidError::InverseCrime { generator, .. } if generator == "rodwave::characteristics")
    );
    assert!(
        error
            .to_string()
            .contains("the solver that would invert it")
    );
}

/// Parameters that are not identifiable from `test` at 2 % of noise, and the report.
fn not_identifiable<L: IdentifiableLaw>(start: L, test: RodTest) -> (Vec<&'static str>, String) {
    let fit = Fit::of(start).to(&[test]).unwrap();
    let judged = fit.identifiability(Noise::Known(0.02)).unwrap();
    let symbols = judged
        .estimates
        .iter()
        .filter(|e| e.verdict == Verdict::NotIdentifiable)
        .map(|e| e.symbol)
        .collect();
    (symbols, fit.report(Noise::Known(0.02)).to_string())
}

#[test]
fn a_rod_without_visible_damping_is_called_not_identifiable() {
    // Table 4 read literally: relaxation times of 13 s to 20 min in a record of milliseconds
    let polyamide = independent_test(3.209e9, &Maxwell::new(40.85e9).unwrap());
    let (found, report) = not_identifiable(Maxwell::new(1e6).unwrap(), polyamide);
    assert_eq!(found, ["eta"], "{report}");
    let polypropylene = independent_test(2.58e9, &MaxwellNorton::new(2.108, 38.16e18).unwrap());
    let start = MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6).unwrap();
    let (found, report) = not_identifiable(start, polypropylene);
    assert_eq!(found, ["kappa", "F(10 MPa)", "B"], "{report}");
    let polyethylene = independent_test(
        2.107e9,
        &MaxwellGurevichRabinovich::new(314.6e9, 7.082e12).unwrap(),
    );
    let start = MaxwellGurevichRabinovich::from_reference_rate(0.2, 1.0, 10e6).unwrap();
    let (found, report) = not_identifiable(start, polyethylene);
    assert_eq!(found, ["F(10 MPa)", "m", "eta"], "{report}");
}

/// The test of `law` without noise, from two grids of the chain extrapolated.
fn extrapolated_test<L: InelasticLaw>(modulus: f64, law: &L) -> RodTest {
    let record = struck(modulus, law);
    let chain = |cells| {
        LumpedRod::new(&rod(modulus, law), cells, 0.5)
            .unwrap()
            .free_end_velocity(&record.excitation_before_sampling, &times(&record))
            .unwrap()
    };
    let response = chain(300)
        .iter()
        .zip(chain(600))
        .map(|(coarse, fine)| fine + (fine - coarse) / 3.0)
        .collect();
    RodTest::new(data(&record, response, lumped::GENERATOR)).unwrap()
}

#[test]
fn independent_data_without_noise_give_the_parameters_of_each_law() {
    // the fit's own errors: a grid of 1e-4 of V0 and the interpolation of the excitation
    let fit = Fit::of(Maxwell::new(1e6).unwrap())
        .with_accuracy(1e-4)
        .to(&[extrapolated_test(3.056e9, &Maxwell::new(11.12e6).unwrap())])
        .unwrap();
    let report = fit.report(Noise::FromResidual);
    assert!(ratio_error(value(&fit, "eta"), 11.12e6) < 0.005, "{report}");
    let truth = MaxwellNorton::new(2.108, 7e13).unwrap();
    let fit = Fit::of(MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6).unwrap())
        .with_accuracy(1e-4)
        .to(&[extrapolated_test(2.58e9, &truth)])
        .unwrap();
    let report = fit.report(Noise::FromResidual);
    assert!(ratio_error(value(&fit, "kappa"), 2.108) < 0.02, "{report}");
    let rate = truth.inelastic_strain_rate(10e6);
    assert!(
        ratio_error(value(&fit, "F(10 MPa)"), rate) < 0.013,
        "{report}"
    );
}

/// κ identified from a rod struck by a flat projectile and seen through a recorder of the given
/// rate.
fn exponent_through_recorder(rate_hz: f64, truth: &MaxwellNorton) -> f64 {
    let acquisition = Acquisition {
        recorder: Recorder {
            rate_hz,
            cutoff_hz: rate_hz * 16.0 / 51.2,
        },
        samples_before: 32,
        // samples in 2.5 ms
        samples_after: (2.5e-3 * rate_hz) as usize,
        transducer_range: 0.020,
    };
    let record = ImpactTest {
        striker: Striker::PAPER_D,
        rod: InelasticRod::new(LENGTH + 0.008, DENSITY, 2.58e9, *truth).unwrap(),
        diameter: 0.016,
        section_distance: LENGTH,
    }
    .record(&acquisition, 0.25e-3)
    .unwrap();
    let test = RodTest::new(data(&record, record.response.clone(), lumped::GENERATOR)).unwrap();
    let start = MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6).unwrap();
    value(&Fit::of(start).to(&[test]).unwrap(), "kappa")
}

#[test]
fn a_filter_after_a_nonlinear_rod_biases_its_exponent_until_it_passes_the_front() {
    let truth = MaxwellNorton::new(2.108, 7e13).unwrap();
    let at = |factor: f64| exponent_through_recorder(factor * 51_200.0, &truth);
    // The bias is not a defect of the inversion: it depends on the rise time of the filter.
    // Measured: 1.38, 1.85, 1.97, each the same to 0.01 on grids of half the cell. (A cell of 4 mm
    // at the highest rate gives 2.07, with an error of its own and twice the residual.)
    let exponents = [at(1.0), at(4.0), at(16.0)];
    assert!(exponents[0] < 2.108 - 0.5, "{exponents:?}");
    assert!(exponents[1] > exponents[0] + 0.2, "{exponents:?}");
    assert!(exponents[2] > exponents[1] + 0.06, "{exponents:?}");
    assert!((exponents[2] - 2.108).abs() < 0.2, "{exponents:?}");
}

#[test]
fn standard_errors_scale_with_the_noise() {
    let test = independent_test(3.209e9, &Maxwell::new(4e6).unwrap());
    let fit = Fit::of(Maxwell::new(1e6).unwrap()).to(&[test]).unwrap();
    let at = |noise| fit.identifiability(Noise::Known(noise)).unwrap().estimates[1].standard_error;
    // a linearised error is proportional to the noise, to rounding
    assert!((at(0.04) / at(0.02) - 2.0).abs() < 1e-12);
    // the residual of the fit is the lower limit of the noise
    let floor = fit.identifiability(Noise::Known(0.0)).unwrap();
    assert!(floor.noise >= fit.relative_error());
}

#[test]
fn bad_tests_are_refused_with_the_name_and_the_value() {
    let record = struck(3e9, &Maxwell::new(4e6).unwrap());
    let good = || data(&record, record.response.clone(), lumped::GENERATOR);
    let refused = |change: &dyn Fn(&mut RodTestData)| {
        let mut data = good();
        change(&mut data);
        RodTest::new(data).unwrap_err().to_string()
    };
    assert_eq!(
        refused(&|d| d.density = -1.0),
        "test `virtual rod`: density [kg/m^3] is -1, expected a finite value above 0"
    );
    assert_eq!(
        refused(&|d| d.response[17] = f64::NAN),
        "test `virtual rod`: sample 17 of response is NaN, expected a finite value"
    );
    assert_eq!(
        refused(&|d| d.excitation[3] = f64::INFINITY),
        "test `virtual rod`: sample 3 of excitation is inf, expected a finite value"
    );
    assert_eq!(
        refused(&|d| d.response.truncate(100)),
        "test `virtual rod`: the response has 100 samples, the excitation 160"
    );
    assert_eq!(
        refused(&|d| d.excitation[0] = 4.0),
        "test `virtual rod`: the first sample of the excitation is 4.0000 m/s, more than 1.5000 m/s: \
         the record must begin before the wave arrives"
    );
    assert_eq!(
        refused(&|d| {
            d.excitation.truncate(20);
            d.response.truncate(20);
        }),
        "test `virtual rod`: response has 20 samples, expected at least 32"
    );
    let test = RodTest::new(good()).unwrap();
    assert!(matches!(
        test.clone().with_window(4e-3).unwrap_err(),
        MaxwellidError::ExcitationTooShort { needed, found, .. } if needed > found
    ));
    assert_eq!(
        Fit::of(Maxwell::new(1e6).unwrap()).to(&[]).unwrap_err(),
        MaxwellidError::NoTest
    );
    let mut silent = good();
    silent.response.fill(0.0);
    assert_eq!(
        Fit::of(Maxwell::new(1e6).unwrap())
            .to(&[RodTest::new(silent).unwrap()])
            .unwrap_err()
            .to_string(),
        "test `virtual rod`: no arrival was found in the response, expected a record that begins at \
         rest and a wave that rises within it: are excitation and response exchanged, or is the \
         record too short?"
    );
}

#[test]
fn a_report_says_what_was_learnt_and_what_was_not() {
    // only the words are compared; the digits are tested elsewhere
    let words = |text: String| text.replace(|c: char| c.is_ascii_digit(), "0");
    let damped = independent_test(3.209e9, &Maxwell::new(4e6).unwrap());
    let fit = Fit::of(Maxwell::new(1e6).unwrap()).to(&[damped]).unwrap();
    insta::assert_snapshot!(words(fit.report(Noise::Known(0.02)).to_string()), @r"
    Maxwell law, converged: the sum of squares cannot be reduced further after 0 iterations; residual 0.000 % of V0
      E = 0.0000e0 Pa ± 0.00 % (identified)
      eta = 0.0000e0 Pa s ± 0.00 % (identified)
    ");
    let undamped = independent_test(3.209e9, &Maxwell::new(40.85e9).unwrap());
    let fit = Fit::of(Maxwell::new(1e6).unwrap()).to(&[undamped]).unwrap();
    let text = fit.report(Noise::Known(0.02)).to_string();
    let damping = text.lines().last().unwrap();
    assert!(
        damping.ends_with("(not identifiable from these data)"),
        "{text}"
    );
}
