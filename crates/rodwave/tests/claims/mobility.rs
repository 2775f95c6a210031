//! Mobilities of chains: an integration of the equations of motion, closed forms, limits.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::element::{CrossSection, Segment};
use rodwave::transition::State;
use rodwave::{Chain, Termination};
use testbed::claim::{Claims, Within};
use testbed::difference::{largest, relative};
use testbed::hold;

use crate::bodies::{aluminium, circle, cone, cylinder, nylon, polymer};

/// Integrates (A2) with the cross-section A(x) by the classical fourth-order Runge-Kutta method.
fn integrated(segment: &Segment, omega: f64, left: State) -> State {
    let medium = polymer();
    let iomega = Complex64::new(0.0, omega);
    let steps = 4000;
    let h = segment.length() / f64::from(steps);
    let derivative = |half_steps: i32, (n, v): (Complex64, Complex64)| {
        let x = (f64::from(half_steps) * h / 2.0).min(segment.length());
        let area = segment.area_at(x).unwrap();
        (
            iomega * medium.density() * area * v,
            iomega / (medium.modulus(omega) * area) * n,
        )
    };
    let mut y = (left.normal_force, left.velocity);
    for step in 0..steps {
        let along = |k: (Complex64, Complex64), h: f64| (y.0 + k.0 * h, y.1 + k.1 * h);
        let k1 = derivative(2 * step, y);
        let k2 = derivative(2 * step + 1, along(k1, h / 2.0));
        let k3 = derivative(2 * step + 1, along(k2, h / 2.0));
        let k4 = derivative(2 * step + 2, along(k3, h));
        y.0 += (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0) * (h / 6.0);
        y.1 += (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1) * (h / 6.0);
    }
    State {
        normal_force: y.0,
        velocity: y.1,
    }
}

/// Error of the state behind a segment: the larger of the errors of N and Zv.
fn segment_error(segment: &Segment, frequency_hz: f64) -> f64 {
    let left = State {
        normal_force: Complex64::new(3.0, -1.0),
        velocity: Complex64::new(0.01, 0.02),
    };
    let omega = TAU * frequency_hz;
    let expected = integrated(segment, omega, left);
    let matrix = segment.transition_matrix(&polymer(), omega).unwrap();
    let found = matrix.transfer(left);
    let z = 1.4e6 * 4.5e-4;
    ((found.normal_force - expected.normal_force).norm()
        + z * (found.velocity - expected.velocity).norm())
        / (expected.normal_force.norm() + z * expected.velocity.norm())
}

/// Claims on mobilities (Ödeen 1993, paper E, eqs. A1 and A16).
#[test]
fn claims_hold() {
    let mut report = Claims::default();
    let [thin, thick] = [0.7e-4, 4.5e-4].map(|area| CrossSection::of_area(area).unwrap());
    let segments = [
        Segment::rod(thin, 0.4),
        Segment::cone(thin, thick, 0.4),
        Segment::cone(thick, thin, 0.4),
        Segment::cone(thin, thin, 0.4),
        Segment::horn(thin, thick, 0.4),
        Segment::horn(thick, thin, 0.4),
        Segment::horn(thick, thick, 0.4),
    ];
    let errors = segments.into_iter().flat_map(|segment| {
        let segment = segment.unwrap();
        [0.01, 50.0, 700.0, 5000.0, 20e3].map(|f| segment_error(&segment, f))
    });
    report
        .by("paper E, eq. A2, integrated by a method of fourth order")
        .deviation(
            "rod, cones and horns of a Zener material solve the equations of motion, 0.01 Hz to 20 kHz",
            Within(2e-9, "|γL| (|γ|h)⁴/120 of the integration at 20 kHz"),
            Ok(largest(errors)),
        );
    rigid_bodies(&mut report);
    terminations(&mut report);
    hold!(report);
}

fn rigid_bodies(report: &mut Claims) {
    let of_cone = 1150.0 * PI * 0.400 / 12.0 * (0.030 * 0.030 + 0.030 * 0.075 + 0.075 * 0.075);
    let of_cylinder = PI / 4.0 * 0.032 * 0.032 * 0.250 * (1150.0 + 2700.0);
    report
        .by("volumes of a frustum and of a cylinder")
        .deviation(
            "masses of the truncated cone and of the compound cylinder",
            Within(2e-15, "a few roundings"),
            Ok(largest([
                cone(Termination::Free).free_mass().unwrap() / of_cone - 1.0,
                cylinder(Termination::Free).free_mass().unwrap() / of_cylinder - 1.0,
            ])),
        );
    let every_element = Chain::from_impact_face()
        .mass(0.010)
        .horn(&aluminium(), circle(0.050), circle(0.0005), 0.2)
        .spring(1e7)
        .cone(&nylon(), circle(0.002), circle(0.100), 0.1)
        .dashpot(1e9)
        .rod(&aluminium(), circle(0.020), 1.0)
        .horn(&aluminium(), circle(0.001), circle(0.100), 0.2)
        .end(Termination::Mass(0.25));
    let bodies = [
        cone(Termination::Free),
        cylinder(Termination::Mass(0.0029)),
        every_element.unwrap(),
    ];
    let errors = bodies.iter().flat_map(|body| {
        [1e-6, 1e-3].into_iter().flat_map(|frequency_hz| {
            let omega = TAU * frequency_hz;
            let rigid = Complex64::new(0.0, omega * body.free_mass().unwrap());
            let mobilities = [body.mobility(omega), body.far_face_mobility(omega)];
            mobilities.map(|mobility| (mobility.unwrap() * rigid - 1.0).norm())
        })
    });
    report.by("Newton's second law").deviation(
        "bodies of every element are rigid at 1 µHz and 1 mHz: Ĝ iωM - 1 at both faces",
        Within(1e-9, "ω²M/k of the thinnest horn at 1 mHz"),
        Ok(largest(errors)),
    );
    let medium = polymer();
    let rod = |end| {
        let row = Chain::from_impact_face().rod(&medium, circle(0.016), 0.4);
        row.rod(&medium, circle(0.016), 0.4).end(end).unwrap()
    };
    let area = PI / 4.0 * 0.016 * 0.016;
    let (free, fixed) = (rod(Termination::Free), rod(Termination::Fixed));
    let mut errors: Vec<f64> = [1e-9, 1e-6, 1e-3, 1.0]
        .map(|frequency_hz| {
            let omega = TAU * frequency_hz;
            let x = medium.propagation_coefficient(omega) * 0.8;
            let mass = 910.0 * area * 0.8;
            let scaled = free.mobility(omega).unwrap() * Complex64::new(0.0, omega * mass);
            (scaled - 1.0 - x * x / 3.0 + x.powu(4) / 45.0).norm()
        })
        .to_vec();
    let omega = TAU * 1e-6;
    let compliance = Complex64::new(0.0, omega) * 0.8 / (medium.modulus(omega) * area);
    errors.push(relative(fixed.mobility(omega).unwrap(), compliance));
    report.by("series of x coth x; iωL/(AE)").deviation(
        "rod at low frequency: free, with the first corrections of a rigid mass, 1 nHz to 1 Hz; fixed, as a spring",
        Within(5e-15, "a dozen rounding errors; the next term is 1e-18"),
        Ok(largest(errors)),
    );
}

fn terminations(report: &mut Claims) {
    let (nylon, face, omega) = (nylon(), circle(0.030), TAU * 1234.0);
    let z = nylon.specific_characteristic_impedance(omega) * CrossSection::from(face).area();
    let t = (nylon.propagation_coefficient(omega) * 0.3).tanh();
    let long = (69e9_f64 * 2700.0).sqrt() * PI / 4.0 * 0.010 * 0.010;
    let measured = Complex64::new(250.0, -80.0);
    let ends: [(Termination, Complex64); 5] = [
        (Termination::Free, Complex64::ZERO),
        (Termination::Mass(0.05), Complex64::new(0.0, omega * 0.05)),
        (Termination::Dashpot(700.0), 700.0.into()),
        (Termination::impedance(move |_| measured), measured),
        (
            Termination::semi_infinite(&aluminium(), circle(0.010)),
            long.into(),
        ),
    ];
    let rod = |end| Chain::from_impact_face().rod(&nylon, face, 0.3).end(end);
    let mut errors = Vec::new();
    for (end, z_end) in ends {
        let rod = rod(end).unwrap();
        let near = (z + z_end * t) / (z * (z_end + z * t));
        // at the far face, the impedances of both sides add up
        let far = 1.0 / (z * t + z_end);
        errors.push(relative(rod.mobility(omega).unwrap(), near));
        errors.push(relative(rod.far_face_mobility(omega).unwrap(), far));
    }
    let fixed = rod(Termination::Fixed).unwrap();
    errors.push(relative(fixed.mobility(omega).unwrap(), t / z));
    errors.push(fixed.far_face_mobility(omega).unwrap().norm());
    report
        .by("closed form: Z(Z_end + Z tanh γL)/(Z + Z_end tanh γL)")
        .deviation(
            "rod of Nylon-6, free, fixed, on a mass, a dashpot, a measured impedance, a long rod: both faces",
            Within(5e-15, "a few dozen roundings"),
            Ok(largest(errors)),
        );
}
