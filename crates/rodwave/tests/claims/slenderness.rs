//! Lateral inertia: tables computed by other means, a Rayleigh-Ritz calculation without Bessel
//! functions, limits.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::slenderness::{FirstBranch, LoveRayleigh, RodTheory, rayleigh_to_shear_speed};
use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;

use crate::slenderness::{
    MODULUS, apparent_error_percent, bar_number, exact, love, mindlin_herrmann,
    omega_of_bar_number, omega_of_wavelength, rod, wave_number,
};

const NAMES: [&str; 3] = ["Love", "Mindlin and Herrmann", "Pochhammer and Chree"];

/// Returns the theories of Love, of Mindlin and Herrmann, and of Pochhammer and Chree.
fn theories(nu: f64) -> [Box<dyn RodTheory>; 3] {
    [
        Box::new(love(nu)),
        Box::new(mindlin_herrmann(nu)),
        Box::new(exact(nu)),
    ]
}

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    table_of_errors(&mut report);
    viscoelastic_rod(&mut report);
    let errors = RITZ.into_iter().flat_map(|(nu, row)| {
        [1.0, 2.0, 4.0, 8.0]
            .into_iter()
            .zip(row)
            .flat_map(move |(ka, expected)| {
                let wave = Complex64::from(ka * ka);
                [
                    (bar_number(&exact(nu), wave) / expected - 1.0).norm(),
                    (wave_number(&exact(nu), expected.into()) / wave - 1.0).norm(),
                ]
            })
    });
    report
        .by("Rayleigh-Ritz by mpmath, 50 digits; no Bessel function")
        .deviation(
            "first branch of a cylinder, ν from -0.8 to 0.49, ka = 1 to 8, modulus to wave and wave to modulus",
            Within(
                1e-13,
                "rounding of the frequency equation at ka = 8 and near the second branch",
            ),
            Ok(largest(errors)),
        );
    let errors = LOSSY
        .into_iter()
        .flat_map(|(nu, elastic, loss_factor, [re, im])| {
            let bar = elastic / Complex64::new(1.0, loss_factor);
            let wave = Complex64::new(re, im);
            [
                (wave_number(&exact(nu), bar) / wave - 1.0).norm(),
                (bar_number(&exact(nu), wave) / bar - 1.0).norm(),
            ]
        });
    report
        .by("roots of the printed frequency equation by mpmath, 30 digits")
        .deviation(
            "first branch of a lossy cylinder, tan δ up to 1, modulus to wave and wave to modulus",
            Within(1e-13, "some hundred rounding errors"),
            Ok(largest(errors)),
        );
    limits(&mut report);
    report.by("central differences of the modulus").deviation(
        "∂E/∂ν at λ = 4.4 D by three theories, ν = 0.15, 0.4, 0.49",
        Within(
            2e-9,
            "truncation of 1e-10 of E, for slopes of a hundredth of E or more",
        ),
        Ok(largest(
            [0.15, 0.4, 0.49].into_iter().flat_map(slope_errors),
        )),
    );
    hold!(report);
}

/// Claims a table of E'_apparent/E' - 1 in per cent by the three theories, computed independently.
/// A row contains λ/D, ν and, for each theory, the value with three digits (two for some values of
/// Mindlin and Herrmann) and half of its last digit. The κ of the table is the common approximation
/// of c_R/c_S.
fn table_of_errors(report: &mut Claims) {
    type Row = (f64, f64, [(f64, f64); 3]);
    #[rustfmt::skip]
    const ROWS: [Row; 9] = [
        (3.0, 0.35, [(-6.29, 0.005), (-4.56, 0.005), (-7.49, 0.005)]),
        (3.0, 0.40, [(-8.07, 0.005), (-5.77, 0.005), (-9.24, 0.005)]),
        (3.0, 0.499, [(-12.0, 0.05), (-8.4, 0.05), (-12.8, 0.05)]),
        (5.0, 0.35, [(-2.36, 0.005), (-1.64, 0.005), (-2.52, 0.005)]),
        (5.0, 0.40, [(-3.06, 0.005), (-2.13, 0.005), (-3.23, 0.005)]),
        // the table has -4.69 for Love's theory; its closed form gives -4.6848
        (5.0, 0.499, [(-4.68, 0.005), (-3.27, 0.005), (-4.81, 0.005)]),
        (10.0, 0.35, [(-0.601, 5e-4), (-0.409, 5e-4), (-0.611, 5e-4)]),
        (10.0, 0.40, [(-0.783, 5e-4), (-0.538, 5e-4), (-0.794, 5e-4)]),
        (10.0, 0.499, [(-1.21, 0.005), (-0.85, 0.005), (-1.22, 0.005)]),
    ];
    report.by("table computed beforehand by another program");
    for (index, name) in NAMES.into_iter().enumerate() {
        let errors = ROWS.map(|(ratio, nu, printed)| {
            let mut theories = theories(nu);
            let kappa = (0.87 + 1.12 * nu) / (1.0 + nu);
            let approximate = mindlin_herrmann(nu).with_shear_coefficient(kappa * kappa);
            theories[1] = Box::new(approximate.unwrap());
            let (expected, half_digit) = printed[index];
            (apparent_error_percent(theories[index].as_ref(), ratio) - expected) / half_digit
        });
        report.deviation(
            format!("apparent E' at λ = 3, 5, 10 D, ν = 0.35, 0.4, 0.499, in units of half the last digit: {name}"),
            Within(1.0, "half the last printed digit"),
            Ok(largest(errors)),
        );
    }
}

fn viscoelastic_rod(report: &mut Claims) {
    let modulus = MODULUS * Complex64::new(1.0, 0.08);
    // ratios to the true values: E' and E''/E' by one-dimensional theory, then both after Love's
    // correction
    let rows = [
        (5.0, [0.967576, 1.03539, 0.998292, 1.00353]),
        (3.0, [0.907087, 1.11901, 0.987143, 1.02826]),
    ];
    let errors = rows.into_iter().flat_map(|(ratio, row)| {
        let omega = omega_of_wavelength(&exact(0.4), modulus, ratio);
        let gamma = exact(0.4).propagation_coefficient(modulus, omega).unwrap();
        let corrected = LoveRayleigh::round(rod(0.4)).unwrap();
        let corrected = corrected.modulus(gamma.found().unwrap(), omega).unwrap();
        let corrected = corrected.found().unwrap();
        let found = [corrected.apparent_modulus, corrected.modulus];
        let found = found
            .into_iter()
            .flat_map(|e| [e.re / modulus.re, e.im / e.re / 0.08]);
        found
            .zip(row)
            .map(|(found, expected)| found - expected)
            .collect::<Vec<_>>()
    });
    report
        .by("roots of the printed frequency equation by mpmath, 25 digits")
        .deviation(
            "ν = 0.4, tan δ = 0.08, λ = 5 and 3 D: E' and loss factor of one-dimensional theory and after Love's correction, relative to the true ones",
            Within(5e-6, "half the last printed digit"),
            Ok(largest(errors)),
        );
}

/// ν, (ωa/c₀)² for the storage modulus, tan δ, and the root -γ²a² of the printed form by mpmath
/// with 30 digits; the branch was followed in 200 steps from B = 0.
#[rustfmt::skip]
const LOSSY: [(f64, f64, f64, [f64; 2]); 4] = [
    (0.4, 1.0, 0.08, [1.0935760340203608583, -0.097886928303428387904]),
    (0.35, 4.0, 0.1, [7.577325845279913678, -1.4035511860109801198]),
    (0.45, 9.0, 0.3, [23.675076676843369766, -8.5849908228236648873]),
    (0.1, 6.0, 1.0, [2.898375319009708053, -3.0210126024149953131]),
];

/// First branch of an elastic cylinder by the method of Rayleigh and Ritz: u_r and u_z are
/// polynomials of r with 14 terms each, 50 digits; (ωa/c₀)² at ka = 1, 2, 4, 8.
#[rustfmt::skip]
const RITZ: [(f64, [f64; 4]); 6] = [
    (0.02, [0.999718786580890895, 3.49772818884996951, 6.64360357697898755, 23.2777182369375707]),
    (0.3, [0.947753735045376094, 2.88745495628418146, 6.38929265944177181, 21.3229598209700608]),
    (0.4, [0.91600823648375943, 2.68575962348539749, 6.2092687531307476, 20.6398420608982612]),
    (0.49, [0.885500866857381302, 2.52591663354172454, 6.02619689629948292, 20.0240062882797492]),
    (-0.3, [0.941822839107359901, 2.64327454772365029, 6.72451313341943784, 26.8029800580166803]),
    (-0.8, [0.76568942507360776, 2.3596335384479662, 11.5387444102250995, 62.1866429560876435]),
];

fn limits(report: &mut Claims) {
    report
        .by("closed forms √(3 - √5) and √(2 - 2/√3)")
        .deviation(
            "speed of Rayleigh's wave over that of the shear wave, ν = 0 and 1/4",
            Within(1e-15, "a few roundings"),
            Ok(largest([
                rayleigh_to_shear_speed(0.0).unwrap() - (3.0 - 5f64.sqrt()).sqrt(),
                rayleigh_to_shear_speed(0.25).unwrap() - (2.0 - 2.0 / 3f64.sqrt()).sqrt(),
            ])),
        );
    let (mut exact_errors, mut approximate) = (Vec::new(), Vec::new());
    for nu in [0.0001, 0.2, 0.29, 0.4, 0.5, -0.4] {
        let limit = rayleigh_to_shear_speed(nu).unwrap().powi(2) / (2.0 + 2.0 * nu);
        let speed = |theory: &dyn RodTheory, ka: f64| {
            (bar_number(theory, (ka * ka).into()).re / (ka * ka) / limit).sqrt()
        };
        let far = speed(&exact(nu), 80.0);
        assert!((far - 1.0).abs() < 1.0 / 80.0, "{nu}: {far}");
        exact_errors.push(2.0 * far - speed(&exact(nu), 40.0) - 1.0);
        approximate.push(speed(&mindlin_herrmann(nu), 100.0) - 1.0);
    }
    report.by("the surface wave");
    report.deviation(
        "short waves by the exact theory, ν from -0.4 to 0.5: speed extrapolated to infinite ka, over that of Rayleigh's wave, minus 1",
        Within(5e-4, "terms of order 1/(ka)² at ka = 40"),
        Ok(largest(exact_errors)),
    );
    report.deviation(
        "short waves by Mindlin and Herrmann, ν from -0.4 to 0.5: speed at ka = 100, over that of Rayleigh's wave, minus 1",
        Within(2e-3, "of order 1/(ka)²"),
        Ok(largest(approximate)),
    );
    let bar = 7.0 / Complex64::new(1.0, 0.2);
    let elementary: [&dyn RodTheory; 2] = [&love(0.0), &exact(0.0)];
    let errors = elementary.into_iter().flat_map(|theory| {
        [wave_number(theory, bar), bar_number(theory, bar)].map(|found| (found / bar - 1.0).norm())
    });
    report.by("elementary theory, ν = 0").deviation(
        "correction without lateral contraction, ν = 0",
        Within(3e-15, "a few roundings"),
        Ok(largest(errors)),
    );
    let ends = love(0.4).propagation_coefficient(MODULUS.into(), omega_of_bar_number(2.5 / 0.16));
    report.by("closed form ν²B/2").claim(
        "Love's theory ends at B = 2/ν²: lateral inertia at 1.25 times this limit",
        "1",
        1.25,
        Within(5e-15, "rounding"),
        Ok(match ends.unwrap() {
            FirstBranch::BeyondCutOff { lateral_inertia } => lateral_inertia,
            other => panic!("{other:?}"),
        }),
    );
    let at_5 = apparent_error_percent(&exact(0.5), 5.0);
    report.by("paper A, condition (i), after Pritz").claim(
        "incompressible rod at λ = 5 D: error of E' by the exact theory",
        "%",
        -5.0,
        Within(0.5, "half the printed digit"),
        Ok(at_5),
    );
}

fn slope_errors(nu: f64) -> [f64; 3] {
    let (gamma, omega, h) = (Complex64::new(4.0, 90.0), TAU * 24e3, 1e-5);
    [0, 1, 2].map(|index| {
        let solve = |nu: f64| {
            let outcome = theories(nu)[index].modulus(gamma, omega).unwrap();
            outcome.found().unwrap()
        };
        let slope = (solve(nu + h).modulus - solve(nu - h).modulus) / (2.0 * h);
        (solve(nu).by_poisson_ratio / slope - 1.0).norm()
    })
}
