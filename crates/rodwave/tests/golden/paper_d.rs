//! Rods of paper D: Table 2 with the moduli of Table 4, and the three laws with the parameters of
//! Table A1.

use rodwave::band_limited::VelocityHistory;
use rodwave::inelastic::{
    Elastic, InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};
use rodwave::lumped::LumpedRod;
use rodwave::{DirectProblem, InelasticRod};

use super::table::GoldenTable;
use crate::bodies::PULSE;

/// Rows of Table 4 that contain the moduli, by the material of Table 2.
const MODULI: [(&str, &str); 5] = [
    ("Polypropylene", "Polypropylene / E"),
    ("Polyamide 6", "Polyamide 6 / E"),
    ("Polyoximethylene", "Polyoximethylene / E"),
    ("Polyethylene", "Polyethylene / E"),
    ("Rubber", "Rubber / E"),
];

/// Checks 25 tests with elastic rods: between its two sections, an elastic rod delays and doubles
/// the velocity, v_r(t) = 2Σ(-1)ⁿ v_e(t - (2n+1)L/c), with L and ρ of Table 2 and E of Table 4.
#[test]
fn elastic_responses_of_the_tests_of_table_2() {
    let tests = GoldenTable::read("paper_d_table_2.ron");
    let parameters = GoldenTable::read("paper_d_table_4.ron");
    assert_eq!(tests.rows.len(), 25);
    for row in &tests.rows {
        let material = row.text["material"].as_str();
        let (_, label) = MODULI.iter().find(|(name, _)| *name == material).unwrap();
        let modulus = parameters.constant(label);
        let (length, density) = (row.value("section_distance"), row.value("density"));
        assert!(length < row.value("rod_length"), "Test {}", row.label);
        let delay = length * (density / modulus.value).sqrt();
        let rod = InelasticRod::new(length, density, modulus.value, Elastic).unwrap();
        let times: Vec<f64> = (1..=80).map(|k| 50e-6 * f64::from(k)).collect();
        let found = DirectProblem::new(rod, 200)
            .unwrap()
            .free_end_velocity(&PULSE, &times)
            .unwrap();
        for (time, found) in times.iter().zip(found) {
            let exact: f64 = (0..20)
                .map(|n| {
                    let sign = if n % 2 == 0 { 2.0 } else { -2.0 };
                    sign * PULSE.at(time - f64::from(2 * n + 1) * delay)
                })
                .sum();
            // tolerance: the solution is exact at its steps; the interpolation between steps of at
            // most 4.3 µs (rubber) has an error below 1e-5 of the peak of a doubled pulse of 60 µs,
            // and at most eight pulses overlap
            assert!(
                (found - exact).abs() < 2e-3,
                "Test {}, {time}: {found} {exact}",
                row.label
            );
        }
        assert!(delay > 0.1e-3 && delay < 0.9e-3, "Test {}", row.label);
    }
}

/// Returns the largest response of the rod of the appendix with the `law`, and that of an elastic
/// rod. Checks that two solvers agree.
fn peaks<L: InelasticLaw>(density: f64, modulus: f64, law: L) -> (f64, f64) {
    let appendix = GoldenTable::read("paper_d_constants.ron");
    let length = appendix.constant("appendix_section_distance").value;
    let rod = InelasticRod::new(length, density, modulus, law).unwrap();
    let transit = rod.transit_time();
    let times: Vec<f64> = (0..60)
        .map(|k| transit + 200e-6 + 5e-6 * f64::from(k))
        .collect();
    let found = DirectProblem::new(rod.clone(), 400)
        .unwrap()
        .free_end_velocity(&PULSE, &times)
        .unwrap();
    let second = LumpedRod::new(&rod, 800, 0.8)
        .unwrap()
        .free_end_velocity(&PULSE, &times)
        .unwrap();
    let peak = found.iter().copied().fold(0.0, f64::max);
    for (a, b) in found.iter().zip(second) {
        // tolerance: dispersion of a chain with 25 cells or more per pulse width
        assert!((a - b).abs() < 5e-3 * peak, "{a} {b}");
    }
    (peak, 2.0 * PULSE.peak)
}

/// Checks that the units of Table A1 as printed make the rods elastic (erratum): the printed
/// parameters change the response by less than the error of 0.06 per cent that the table states for
/// them.
#[test]
fn the_parameters_of_table_a1_do_not_damp_as_printed() {
    let table = GoldenTable::read("paper_d_table_a1.ron");
    let smallest = GoldenTable::read("paper_d_constants.ron").constant("appendix_error_smallest");
    for column in ["input", "output"] {
        let value = |row: &str| table.row(row).value(column);
        let density = |row: &str| table.row(row).value("density");
        let responses = [
            peaks(
                density("M_1 / E"),
                value("M_1 / E"),
                Maxwell::new(value("M_1 / eta")).unwrap(),
            ),
            peaks(
                density("M_3 / E"),
                value("M_3 / E"),
                MaxwellGurevichRabinovich::new(value("M_3 / eta"), value("M_3 / m")).unwrap(),
            ),
        ];
        for (peak, elastic) in responses {
            let change = (peak / elastic - 1.0).abs();
            assert!(change < smallest.value, "{column}: {change:e}");
        }
        // M_2 with B = 320 TPa^kappa s does damp, because of its kappa and the unit Pa^kappa
        let norton = MaxwellNorton::new(value("M_2 / kappa"), value("M_2 / B")).unwrap();
        let (peak, elastic) = peaks(density("M_2 / E"), value("M_2 / E"), norton);
        let time_constant =
            value("M_2 / B") / value("M_2 / E") / 10e6_f64.powf(value("M_2 / kappa") - 1.0);
        let damps = (peak / elastic - 1.0).abs() > smallest.value;
        assert_eq!(damps, time_constant < 0.1, "{column}: {time_constant} s");
    }
}

/// Checks that the column of errors contains the relative distance between the other two columns.
#[test]
fn relative_errors_of_table_a1() {
    for row in &GoldenTable::read("paper_d_table_a1.ron").rows {
        let [input, output, error] =
            ["input", "output", "relative_error"].map(|column| row.values[column]);
        let found = (output.value / input.value - 1.0).abs();
        let allowed = (input.tolerance + output.tolerance) / input.value + error.tolerance;
        assert!(
            (found - error.value).abs() <= allowed,
            "{}: {found}",
            row.label
        );
    }
}
