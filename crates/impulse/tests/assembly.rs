//! Assemblies against closed forms, against chains of the same parts, and against bodies in a line
//! by characteristics in the time domain.

use std::f64::consts::{FRAC_PI_4, TAU};
use std::sync::Arc;

use impulse::{
    Assembly, AtFace, BandLimit, ForceHistory, Impact, ImpactBody, ImpulseError, Joint,
    LowFrequency, MeasuredBody, MeasuredPoints, Point, SharedSubstructure, Substructure,
    WeighedMass,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::line::{Body, Line, Segment};
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Zener};

use crate::bodies::{
    STEEL_DENSITY, STEEL_MODULUS, between_samples, circle, long_rod, mass, nylon_rod, rod,
    wave_speed,
};

/// Mobilities of the two points of a member.
fn at(member: &dyn Substructure, s: Complex64) -> [[Complex64; 2]; 2] {
    let mut mobilities = [Complex64::ZERO; 4];
    member.write_mobilities(s, &mut mobilities).unwrap();
    let [a, b, c, d] = mobilities;
    [[a, b], [c, d]]
}

fn member(kilograms: f64) -> SharedSubstructure {
    Arc::new(AtFace::of(mass(kilograms)))
}

fn relative(found: Complex64, expected: Complex64) -> f64 {
    (found - expected).norm() / expected.norm()
}

/// Lossy materials in both domains: rod, spring, rod and mass, joined and as one chain.
#[test]
fn parts_joined_are_the_chain_of_them() {
    let polymer = Medium::new(1150.0, ConstantQ::new(3e9, 0.1, 1e4).unwrap()).unwrap();
    let thin = circle(0.016);
    let wide = circle(0.030);
    let begin = AnalyticChain::analytic_from_impact_face;
    let first = begin().rod(&polymer, thin, 0.2).end(Termination::Free);
    let second = begin()
        .cone(&polymer, wide, thin, 0.3)
        .end(Termination::Free);
    let members: Vec<SharedSubstructure> = vec![
        Arc::new(first.unwrap()),
        Arc::new(second.unwrap()),
        member(0.05),
    ];
    let joints = [
        Joint::compliant(Point::of(0, 1), Point::of(1, 0), 3e7, 0.0).unwrap(),
        Joint::rigid(Point::of(2, 0), Point::of(1, 1)),
    ];
    let joined = Assembly::of(members, &joints, Point::of(0, 0)).unwrap();
    let chain = begin()
        .rod(&polymer, thin, 0.2)
        .spring(3e7)
        .cone(&polymer, wide, thin, 0.3)
        .end(Termination::Mass(0.05))
        .unwrap();
    assert_eq!(joined.domain(), ImpactBody::domain(&chain));
    let masses = [joined.free_mass().unwrap(), chain.free_mass().unwrap()];
    assert!((masses[0] / masses[1] - 1.0).abs() < 1e-14);
    for s in [
        Complex64::new(0.0, 1.0),
        Complex64::new(0.0, TAU * 3.3e3),
        Complex64::new(0.0, TAU * 41e3),
        Complex64::new(2e3, TAU * 9e3),
        Complex64::new(1e5, 0.0),
    ] {
        let expected = chain.mobility_at_s(s).unwrap();
        // tolerance: rounding of a difference of mobilities, which near 0 Hz is amplified by the
        // ratio of the masses
        assert!(
            relative(joined.mobility_at(s).unwrap(), expected) < 1e-12,
            "{s}"
        );
    }
    // on the frequency axis, for a law that is not known off it
    let part = |length| nylon_rod(0.016, length);
    let members: Vec<SharedSubstructure> = vec![Arc::new(part(0.1)), Arc::new(part(0.25))];
    let joint = Joint::rigid(Point::of(0, 1), Point::of(1, 0));
    let joined = Assembly::of(members, &[joint], Point::of(0, 0)).unwrap();
    let s = Complex64::new(0.0, TAU * 7e3);
    let expected = part(0.35).mobility(s.im).unwrap();
    assert!(relative(joined.mobility_at(s).unwrap(), expected) < 1e-12);
    assert!(joined.mobility_at(Complex64::new(1.0, 0.0)).is_err());
}

/// Closed forms: a member alone, two masses with a spring and a dashpot between, one held by the
/// ground, and three bodies at one point, whose impedances add.
#[test]
fn joints_obey_closed_forms() {
    let s = Complex64::new(0.0, TAU * 1.7e3);
    let alone = rod(0.02, 0.7);
    let one = Assembly::of(vec![Arc::new(alone.clone())], &[], Point::of(0, 0)).unwrap();
    assert_eq!(one.mobility_at(s).unwrap(), alone.mobility_at_s(s).unwrap());
    let (m, n, k, c) = (0.8, 0.3, 2e8, 4e3);
    let joint = Joint::compliant(Point::of(0, 0), Point::of(1, 0), k, c).unwrap();
    let pair = Assembly::of(vec![member(m), member(n)], &[joint], Point::of(0, 0)).unwrap();
    // the impedance of the second mass behind the joint: 1/(1/(ns) + s/(k + cs))
    let behind = 1.0 / (1.0 / (n * s) + s / (k + c * s));
    let found = pair.mobility_at(s).unwrap();
    assert!(relative(found, 1.0 / (m * s + behind)) < 1e-13);
    assert!((pair.free_mass().unwrap() - (m + n)).abs() < 1e-15);
    let members: Vec<SharedSubstructure> = vec![member(m), Arc::new(AtFace::ground())];
    let held = Assembly::of(members, &[joint], Point::of(0, 0)).unwrap();
    let expected = 1.0 / (m * s + k / s + c);
    assert!(relative(held.mobility_at(s).unwrap(), expected) < 1e-13);
    assert!(held.free_mass().is_none());
    let rods = [rod(0.02, 0.7), rod(0.03, 1.1)];
    let members: Vec<SharedSubstructure> = vec![
        member(m),
        Arc::new(rods[0].clone()),
        Arc::new(rods[1].clone()),
    ];
    let at = Point::of(0, 0);
    let joints = [
        Joint::rigid(at, Point::of(1, 0)),
        Joint::rigid(Point::of(2, 1), at),
    ];
    let star = Assembly::of(members, &joints, at).unwrap();
    let [a, b] = rods.map(|rod| rod.mobility_at_s(s).unwrap());
    let expected = 1.0 / (m * s + 1.0 / a + 1.0 / b);
    assert!(relative(star.mobility_at(s).unwrap(), expected) < 1e-12);
}

/// Force of the first contact of a [`Line`], whose samples are means over its steps of at most
/// `step` \[s\].
fn by_line(bodies: Vec<Body>, step: f64, duration: f64) -> ForceHistory {
    let line = Line::new(bodies).unwrap();
    let history = line.run(step, duration, &[]).unwrap();
    let step = history.grid.time_step;
    ForceHistory::new(0.5 * step, step, history.contacts[0].force.clone()).unwrap()
}

/// Three free rods of steel: the first strikes the second, to whose other end the third, of another
/// section, is joined. The whole force in the band agrees within a thousandth of its peak.
#[test]
fn three_rods_in_a_row_are_those_of_a_line() {
    // transit times in whole microseconds, so that `Line` adjusts no wave speed
    let lengths = [150e-6, 20e-6, 60e-6].map(|time| wave_speed() * time);
    let diameters = [0.030, 0.030, 0.015];
    let (duration, velocity) = (1.5e-3, 8.0);
    let members: Vec<SharedSubstructure> = vec![
        Arc::new(rod(diameters[1], lengths[1])),
        Arc::new(rod(diameters[2], lengths[2])),
    ];
    let joint = Joint::rigid(Point::of(0, 1), Point::of(1, 0));
    let struck = Assembly::of(members, &[joint], Point::of(0, 0)).unwrap();
    let segment = |at: usize| {
        let area = FRAC_PI_4 * diameters[at] * diameters[at];
        Segment::elastic(lengths[at], area, STEEL_DENSITY, STEEL_MODULUS).unwrap()
    };
    let moving = Body::new([segment(0)]).unwrap().moving_at(velocity);
    let bonded = Body::new([segment(1), segment(2)]).unwrap();
    let line = by_line(vec![moving.unwrap(), bonded], 1e-6, duration);
    let step = line.time_step();
    let striker = rod(diameters[0], lengths[0]);
    let prediction = Impact::between(&striker, &struck)
        .at_velocity(velocity)
        .in_steps_of(step)
        .predict(duration)
        .unwrap();
    let band = BandLimit::PAPER_E;
    let ours = prediction.band_limited(band).unwrap();
    let theirs = band.apply(&line).unwrap();
    let peak = theirs.smooth_peak().force;
    assert!((ours.smooth_peak().force / peak - 1.0).abs() < 1e-3);
    // until the faces have parted
    assert!(
        prediction
            .main_contacts()
            .all(|contact| contact.end.is_some())
    );
    let worst = (0..1500)
        .map(|n| {
            let time = f64::from(n) * step;
            let [ours, theirs] =
                [&ours, &theirs].map(|force| between_samples(force, time).unwrap());
            (ours - theirs).abs()
        })
        .fold(0.0, f64::max);
    assert!(worst < 1e-3 * peak, "{}", worst / peak);
}

/// A bit between a rod and the rock, given by the lines of its three mobilities: the mobility and
/// the impact force are compared with those of a chain of the same bodies, the front impedance with
/// that of the rod, and the scatter of drawn bits with a closed form.
#[test]
fn a_measured_member_is_the_computed_one() {
    let (step_hz, n_lines) = (25.0, 1025);
    let polymer = Medium::new(1150.0, Zener::new(2.4e9, 3e9, 20e-6).unwrap()).unwrap();
    let section = circle(0.020);
    let begin = AnalyticChain::analytic_from_impact_face;
    let bit = begin().rod(&polymer, section, 0.15).end(Termination::Free);
    let bit = bit.unwrap();
    let weighed = LowFrequency::Free(WeighedMass {
        mass: bit.free_mass().unwrap(),
        standard_error: 1e-4,
    });
    let entry = |row: usize, column: usize| {
        let lines: Vec<Complex64> = (0..n_lines)
            .map(|line| match line {
                0 => Complex64::ZERO,
                _ => {
                    let s = Complex64::new(0.0, TAU * step_hz * f64::from(line));
                    at(&bit, s)[row][column]
                }
            })
            .collect();
        let variance: Vec<f64> = lines.iter().map(|v| (1e-3 * v.norm()).powi(2)).collect();
        let body = MeasuredBody::from_mobility(&lines, step_hz, weighed).unwrap();
        body.with_variance(&variance).unwrap()
    };
    let measured = MeasuredPoints::of(2, vec![entry(0, 0), entry(0, 1), entry(1, 1)]).unwrap();
    let near = begin().rod(&polymer, section, 0.4).end(Termination::Free);
    let near: SharedSubstructure = Arc::new(near.unwrap());
    let rock: SharedSubstructure = Arc::new(AtFace::of(long_rod(900.0)));
    let joints = [
        Joint::rigid(Point::of(0, 1), Point::of(1, 0)),
        Joint::rigid(Point::of(1, 1), Point::of(2, 0)),
    ];
    let with = |bit: SharedSubstructure| {
        let members = vec![Arc::clone(&near), bit, Arc::clone(&rock)];
        Assembly::of(members, &joints, Point::of(0, 0)).unwrap()
    };
    let joined = with(Arc::new(measured.clone()));
    let chain = begin()
        .rod(&polymer, section, 0.55)
        .end(Termination::Dashpot(900.0))
        .unwrap();
    let s = Complex64::new(0.0, TAU * step_hz * 321.0);
    let expected = chain.mobility_at_s(s).unwrap();
    assert!(relative(joined.mobility_at(s).unwrap(), expected) < 1e-12);
    assert!(joined.mobility_at(s * 1.0001).is_err());
    // the front impedance is that of the rod at high frequency; tolerance: the modulus differs from
    // its limit by (E₁ - E₀)/E₁ divided by about 1e8 x 20 us
    let front = joined.front_impedance().unwrap();
    let expected_front = (3e9_f64 * 1150.0).sqrt() * FRAC_PI_4 * 4e-4;
    assert!((front / expected_front - 1.0).abs() < 1e-4, "{front}");
    // impact of a hammer head of 0.2 kg, once on the assembly with lines and once on the computed
    // chain
    let hammer = mass(0.2);
    let peak = |body: &dyn ImpactBody| {
        let impact = Impact::between(&hammer, body).at_velocity(2.0);
        let force = impact.in_steps_of(5e-6).predict(2e-3).unwrap();
        let limited = force.band_limited(BandLimit::up_to(6e3).unwrap()).unwrap();
        (limited.smooth_peak().force, force.balance().impulse)
    };
    let (by_lines, computed) = (peak(&joined), peak(&chain));
    // tolerance: above 25.6 kHz, where the lines end, the front impedance replaces the mobility
    assert!(
        (by_lines.0 / computed.0 - 1.0).abs() < 2e-3,
        "{by_lines:?} {computed:?}"
    );
    assert!(
        (by_lines.1 / computed.1 - 1.0).abs() < 1e-3,
        "{by_lines:?} {computed:?}"
    );
    // scatter of the mobility over draws with noise alone, which is drawn independently for each
    // entry
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut squares = 0.0;
    for _ in 0..400 {
        let drawn = with(Arc::new(measured.drawn(0.0, 0.0, &mut random).unwrap()));
        squares += relative(drawn.mobility_at(s).unwrap(), expected).powi(2) / 400.0;
    }
    // expected variance from the forces f on the points of the bit: E|δG|² = |f₁|⁴ v₁₁ + 4 |f₁f₂|²
    // v₁₂ + |f₂|⁴ v₂₂
    let y = at(&bit, s);
    let far_of_rod = at(near.as_ref(), s);
    let behind = 1.0 / 900.0;
    // forces on the first and the second point of the bit, divided by the force on the struck face
    let of_bit = y[0][0] - y[0][1] * y[0][1] / (y[1][1] + behind);
    let first = far_of_rod[0][1] / (far_of_rod[1][1] + of_bit);
    let second = -first * y[0][1] / (y[1][1] + behind);
    let v = |i: usize, k: usize| (1e-3 * y[i][k].norm()).powi(2);
    let variance = first.norm().powi(4) * v(0, 0)
        + 4.0 * (first * second).norm_sqr() * v(0, 1)
        + second.norm().powi(4) * v(1, 1);
    let ratio = squares * expected.norm_sqr() / variance;
    // tolerance: four standard errors of a mean of 400 exponentially distributed values, 5 % each
    assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
}

#[test]
fn what_is_not_joined_is_named() {
    let pair = || -> Vec<SharedSubstructure> { vec![member(1.0), Arc::new(rod(0.02, 0.5))] };
    let at = |member, point| Point::of(member, point);
    let refused = |joints: &[Joint], face| Assembly::of(pair(), joints, face).unwrap_err();
    let apart = refused(&[], at(0, 0));
    assert_eq!(apart, ImpulseError::NotJoined { member: 1 });
    let joint = Joint::rigid(at(0, 1), at(1, 0));
    let text = refused(&[joint], at(0, 0)).to_string();
    assert_eq!(
        text,
        "one side of a joint is point 1 of member 0, expected one of the points of the member"
    );
    let text = refused(&[], at(7, 0)).to_string();
    assert_eq!(
        text,
        "the struck point is point 0 of member 7, expected one of the members"
    );
    let itself = Joint::rigid(at(1, 1), at(1, 1));
    assert!(matches!(
        refused(&[itself], at(0, 0)),
        ImpulseError::NoSuchPoint { .. }
    ));
    assert!(Joint::compliant(at(0, 0), at(1, 0), 0.0, 0.0).is_err());
    assert!(Joint::compliant(at(0, 0), at(1, 0), f64::NAN, 0.0).is_err());
    assert!(Assembly::of(Vec::new(), &[], at(0, 0)).is_err());
    let lines = vec![Complex64::ONE; 16];
    let on = |step| MeasuredBody::from_mobility(&lines, step, LowFrequency::Fixed).unwrap();
    let error = MeasuredPoints::of(2, vec![on(10.0), on(11.0), on(10.0)]).unwrap_err();
    assert!(
        matches!(error, ImpulseError::GridMismatch { .. }),
        "{error}"
    );
    assert!(MeasuredPoints::of(2, vec![on(10.0)]).is_err());
    let members: Vec<SharedSubstructure> = vec![
        Arc::new(AtFace::of(on(10.0))),
        Arc::new(AtFace::of(on(20.0))),
    ];
    let joint = Joint::rigid(at(0, 0), at(1, 0));
    let error = Assembly::of(members, &[joint], at(0, 0)).unwrap_err();
    assert!(
        matches!(error, ImpulseError::GridMismatch { .. }),
        "{error}"
    );
    // the front of a measured face is not known
    let members: Vec<SharedSubstructure> = vec![Arc::new(AtFace::of(on(10.0))), member(1.0)];
    let joined = Assembly::of(members, &[joint], at(0, 0)).unwrap();
    assert!(joined.front_impedance().is_none());
}
