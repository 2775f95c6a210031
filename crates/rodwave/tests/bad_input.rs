//! Impossible input is rejected with a message that contains the quantity, its value, the expected
//! values and, in a body, the element.

use std::fmt::{self, Display, Write};

use insta::assert_snapshot;
use num_complex::Complex64;
use rodwave::band_limited::SampledHistory;
use rodwave::chain::{AnalyticChain, AngularFrequency, ChainBuilder, LaplaceVariable, WaveMedium};
use rodwave::element::{Circle, CrossSection, Segment};
use rodwave::experiment::end_accelerations::HalfSine;
use rodwave::experiment::strains_in_a_frame::{Excitation, FrameMember};
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{
    self, InelasticLaw, LANES, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow,
    RelaxedStress,
};
use rodwave::line::{Body, Gauge, Line};
use rodwave::lumped::LumpedRod;
use rodwave::medium::Medium;
use rodwave::modulus::{
    ComplexModulus, Elastic, LaplaceModulus, PowerLawPropagation, Tabulated, Zener,
};
use rodwave::synthesis::DampedSynthesis;
use rodwave::transition::TransitionMatrix;
use rodwave::{Chain, DirectProblem, InelasticRod, RodwaveError, Termination};

/// Values that cannot be a length, an area or a density.
const IMPOSSIBLE: [f64; 4] = [0.0, -0.5, f64::NAN, f64::INFINITY];

/// Messages of the errors, one per line.
#[derive(Default)]
struct Refusals(String);

impl Refusals {
    fn add<T>(&mut self, what: impl Display, result: Result<T, RodwaveError>) {
        match result {
            Ok(_) => writeln!(self.0, "{what}: ACCEPTED").unwrap(),
            Err(error) => writeln!(self.0, "{what}: {error}").unwrap(),
        }
    }
}

impl Display for Refusals {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

fn steel() -> Medium<Elastic> {
    Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap()
}

fn circle() -> Circle {
    Circle::of_diameter(0.02).unwrap()
}

/// Starts a body with two valid elements, so that an invalid third element has the index 2.
fn begun() -> ChainBuilder {
    Chain::from_impact_face()
        .rod(&steel(), circle(), 0.1)
        .mass(0.1)
}

fn refuse(refusals: &mut Refusals, what: &str, builder: ChainBuilder) {
    // later elements neither mask the first invalid one nor change its index
    let ended = builder
        .spring(-1.0)
        .rod(&steel(), circle(), 0.1)
        .end(Termination::Free);
    refusals.add(what, ended);
}

/// Each impossible value is used for each size of a rod; cones and horns have one invalid size
/// each.
#[test]
fn sizes_of_elements() {
    let mut refusals = Refusals::default();
    let steel = steel();
    for value in IMPOSSIBLE {
        refuse(&mut refusals, "rod", begun().rod(&steel, circle(), value));
        let area = CrossSection::of_area(value);
        refuse(&mut refusals, "rod", begun().rod(&steel, area, 0.1));
        let diameter = Circle::of_diameter(value);
        refuse(&mut refusals, "rod", begun().rod(&steel, diameter, 0.1));
    }
    let wrong = || CrossSection::of_area(-0.5);
    // each of the two areas is valid alone, but their ratio is infinite
    let [least, most] = [1e-300, 1e300].map(|area| CrossSection::of_area(area).unwrap());
    for (what, builder) in [
        ("cone", begun().cone(&steel, circle(), circle(), -0.5)),
        ("horn", begun().horn(&steel, circle(), circle(), f64::NAN)),
        ("cone, near", begun().cone(&steel, wrong(), circle(), 0.1)),
        ("cone, far", begun().cone(&steel, circle(), wrong(), 0.1)),
        ("horn, near", begun().horn(&steel, wrong(), circle(), 0.1)),
        ("horn, far", begun().horn(&steel, circle(), wrong(), 0.1)),
        ("cone, ratio", begun().cone(&steel, least, most, 0.1)),
    ] {
        refuse(&mut refusals, what, builder);
    }
    assert_snapshot!(refusals, @r"
    rod: element 2: length [m] is 0, expected a finite value above 0
    rod: element 2: area of the cross-section [m^2] is 0, expected a finite value above 0
    rod: element 2: diameter [m] is 0, expected a finite value above 0
    rod: element 2: length [m] is -0.5, expected a finite value above 0
    rod: element 2: area of the cross-section [m^2] is -0.5, expected a finite value above 0
    rod: element 2: diameter [m] is -0.5, expected a finite value above 0
    rod: element 2: length [m] is NaN, expected a finite value above 0
    rod: element 2: area of the cross-section [m^2] is NaN, expected a finite value above 0
    rod: element 2: diameter [m] is NaN, expected a finite value above 0
    rod: element 2: length [m] is inf, expected a finite value above 0
    rod: element 2: area of the cross-section [m^2] is inf, expected a finite value above 0
    rod: element 2: diameter [m] is inf, expected a finite value above 0
    cone: element 2: length [m] is -0.5, expected a finite value above 0
    horn: element 2: length [m] is NaN, expected a finite value above 0
    cone, near: element 2: area of the cross-section [m^2] is -0.5, expected a finite value above 0
    cone, far: element 2: area of the cross-section [m^2] is -0.5, expected a finite value above 0
    horn, near: element 2: area of the cross-section [m^2] is -0.5, expected a finite value above 0
    horn, far: element 2: area of the cross-section [m^2] is -0.5, expected a finite value above 0
    cone, ratio: element 2: ratio of the end areas is inf, expected a finite value above 0
    ");
}

/// Medium implemented outside the crate, whose density is not checked when it is created.
#[derive(Debug, Clone)]
struct Claimed {
    density: f64,
}

impl WaveMedium<AngularFrequency> for Claimed {
    fn density(&self) -> f64 {
        self.density
    }

    fn propagation_coefficient(&self, argument: AngularFrequency) -> Complex64 {
        Complex64::new(0.0, argument.omega() / 5000.0)
    }

    fn static_impedance(&self) -> Complex64 {
        Complex64::ONE
    }
}

#[test]
fn densities() {
    let mut refusals = Refusals::default();
    for density in IMPOSSIBLE {
        let law = Elastic::new(206e9).unwrap();
        refusals.add("medium", Medium::new(density, law));
        let claimed = Claimed { density };
        refuse(&mut refusals, "rod", begun().rod(&claimed, circle(), 0.1));
    }
    let rod = InelasticRod::new(0.4, -0.5, 2.5e9, inelastic::Elastic);
    refusals.add("inelastic rod", rod);
    let claimed = Claimed { density: f64::NAN };
    let cone = begun().cone(&claimed, circle(), circle(), 0.1);
    refuse(&mut refusals, "cone", cone);
    let horn = begun().horn(&claimed, circle(), circle(), 0.1);
    refuse(&mut refusals, "horn", horn);
    let endless = Termination::semi_infinite(&claimed, circle());
    refusals.add("semi-infinite rod", begun().end(endless));
    assert_snapshot!(refusals, @r"
    medium: density [kg/m^3] is 0, expected a finite value above 0
    rod: element 2: density [kg/m^3] is 0, expected a finite value above 0
    medium: density [kg/m^3] is -0.5, expected a finite value above 0
    rod: element 2: density [kg/m^3] is -0.5, expected a finite value above 0
    medium: density [kg/m^3] is NaN, expected a finite value above 0
    rod: element 2: density [kg/m^3] is NaN, expected a finite value above 0
    medium: density [kg/m^3] is inf, expected a finite value above 0
    rod: element 2: density [kg/m^3] is inf, expected a finite value above 0
    inelastic rod: density [kg/m^3] is -0.5, expected a finite value above 0
    cone: element 2: density [kg/m^3] is NaN, expected a finite value above 0
    horn: element 2: density [kg/m^3] is NaN, expected a finite value above 0
    semi-infinite rod: density of the termination [kg/m^3] is NaN, expected a finite value above 0
    ");
}

#[test]
fn lumped_elements_and_terminations() {
    let mut refusals = Refusals::default();
    for value in [-0.5, f64::NAN, f64::INFINITY] {
        refuse(&mut refusals, "mass", begun().mass(value));
    }
    refuse(&mut refusals, "spring", begun().spring(-0.5));
    refuse(&mut refusals, "dashpot", begun().dashpot(f64::INFINITY));
    refusals.add("end", begun().end(Termination::Mass(-0.5)));
    refusals.add("end", begun().end(Termination::Dashpot(f64::NAN)));
    // a mass of zero has no effect, but a spring or a dashpot of zero is a gap
    refuse(&mut refusals, "spring", begun().spring(0.0));
    refuse(&mut refusals, "dashpot", begun().dashpot(0.0));
    assert!(begun().mass(0.0).end(Termination::Mass(0.0)).is_ok());
    assert_snapshot!(refusals, @r"
    mass: element 2: mass [kg] is -0.5, expected a finite value, 0 or above
    mass: element 2: mass [kg] is NaN, expected a finite value, 0 or above
    mass: element 2: mass [kg] is inf, expected a finite value, 0 or above
    spring: element 2: stiffness [N/m] is -0.5, expected a finite value above 0
    dashpot: element 2: resistance of the dashpot [kg/s] is inf, expected a finite value above 0
    end: mass of the termination [kg] is -0.5, expected a finite value, 0 or above
    end: resistance of the termination [kg/s] is NaN, expected a finite value, 0 or above
    spring: element 2: stiffness [N/m] is 0, expected a finite value above 0
    dashpot: element 2: resistance of the dashpot [kg/s] is 0, expected a finite value above 0
    ");
}

#[test]
fn elements_without_a_chain() {
    let mut refusals = Refusals::default();
    refusals.add("segment", Segment::rod(circle(), -0.5));
    let rod = InelasticRod::new(f64::INFINITY, 910.0, 2.5e9, inelastic::Elastic);
    refusals.add("inelastic rod", rod);
    let gamma = Complex64::new(0.0, 1.0);
    let matrix = TransitionMatrix::uniform_rod(gamma, Complex64::ONE, 0.0);
    refusals.add("matrix", matrix);
    let segment = Segment::cone(circle(), Circle::of_diameter(0.04).unwrap(), 0.3).unwrap();
    for distance in [-0.1, 0.31, f64::NAN] {
        refusals.add("area", segment.area_at(distance));
        refusals.add("cut", segment.cut(distance));
    }
    assert_snapshot!(refusals, @r"
    segment: length [m] is -0.5, expected a finite value above 0
    inelastic rod: length [m] is inf, expected a finite value above 0
    matrix: length [m] is 0, expected a finite value above 0
    area: distance of the section [m] is -0.1, expected between 0 and the length of the element
    cut: distance of the section [m] is -0.1, expected a finite value above 0
    area: distance of the section [m] is 0.31, expected between 0 and the length of the element
    cut: length beyond the section [m] is -0.010000000000000009, expected a finite value above 0
    area: distance of the section [m] is NaN, expected between 0 and the length of the element
    cut: distance of the section [m] is NaN, expected a finite value above 0
    ");
}

#[test]
fn laws_outside_their_table() {
    let lines = [(2.4e9, 1.6e8), (2.6e9, 1.5e8)].map(|(re, im)| Complex64::new(re, im));
    let table = Tabulated::new(&[1e3, 1e4], &lines).unwrap();
    let mut refusals = Refusals::default();
    for omega in [0.0, 999.0, 1.1e4, -2e4, f64::NAN] {
        refusals.add(format!("at {omega}"), table.lookup(omega));
    }
    assert!(table.lookup(-1e4).is_ok());
    // a law without a value outside its band returns NaN, and a body names the element
    let silent = Medium::new(1000.0, Banded(table)).unwrap();
    let body = begun()
        .rod(&silent, circle(), 0.1)
        .end(Termination::Free)
        .unwrap();
    assert!(body.mobility(5e3).is_ok());
    refusals.add("body", body.mobility(2e4));
    let endless = begun().end(Termination::semi_infinite(&silent, circle()));
    refusals.add("semi-infinite rod", endless.unwrap().mobility(2e4));
    refusals.add("medium", silent.try_propagation_coefficient(2e4));
    refusals.add("far face", body.far_face_mobility(2e4));
    refusals.add("matrix", body.transition_matrix(2e4));
    refusals.add("section", body.section(0, 0.05).unwrap().state(2e4));
    assert_snapshot!(refusals, @r"
    at 0: magnitude of the angular frequency [rad/s] is 0, expected a value from 1000 to 10000, the range of the table
    at 999: magnitude of the angular frequency [rad/s] is 999, expected a value from 1000 to 10000, the range of the table
    at 11000: magnitude of the angular frequency [rad/s] is 11000, expected a value from 1000 to 10000, the range of the table
    at -20000: magnitude of the angular frequency [rad/s] is 20000, expected a value from 1000 to 10000, the range of the table
    at NaN: magnitude of the angular frequency [rad/s] is NaN, expected a value from 1000 to 10000, the range of the table
    body: element 2: the law has no finite propagation coefficient at s = 0+20000i 1/s
    semi-infinite rod: the law has no finite propagation coefficient at s = 0+20000i 1/s
    medium: the law has no finite propagation coefficient at s = 0+20000i 1/s
    far face: element 2: the law has no finite propagation coefficient at s = 0+20000i 1/s
    matrix: element 2: the law has no finite propagation coefficient at s = 0+20000i 1/s
    section: element 2: the law has no finite propagation coefficient at s = 0+20000i 1/s
    ");
}

/// Law of a table that is not continued: NaN outside the band.
#[derive(Debug, Clone)]
struct Banded(Tabulated);

impl ComplexModulus for Banded {
    fn at(&self, omega: f64) -> Complex64 {
        self.0
            .lookup(omega)
            .unwrap_or(Complex64::new(f64::NAN, 0.0))
    }
}

/// Invalid Laplace variables: one with a negative real part, and three that are not finite.
fn wrong_sides() -> [Complex64; 4] {
    [
        Complex64::new(-1.0, 5.0),
        Complex64::new(f64::NAN, 5.0),
        Complex64::new(1.0, f64::NAN),
        Complex64::new(f64::INFINITY, 0.0),
    ]
}

#[test]
fn laplace_variable_on_the_wrong_side() {
    let law = Zener::new(1e9, 2e9, 1e-4).unwrap();
    let medium = Medium::new(1000.0, law).unwrap();
    let body = AnalyticChain::analytic_from_impact_face()
        .rod(&medium, circle(), 0.3)
        .end(Termination::Free)
        .unwrap();
    let section = body.section(0, 0.1).unwrap();
    let segment = Segment::rod(circle(), 0.3).unwrap();
    let mut refusals = Refusals::default();
    for s in wrong_sides() {
        let mut texts = [
            LaplaceVariable::new(s).map(|_| ()),
            law.try_at_s(s).map(|_| ()),
            medium.try_propagation_coefficient_at_s(s).map(|_| ()),
            segment.transition_matrix_at_s(&medium, s).map(|_| ()),
            body.mobility_at_s(s).map(|_| ()),
            body.far_face_mobility_at_s(s).map(|_| ()),
            section.state_at_s(s).map(|_| ()),
        ]
        .map(|result| result.unwrap_err().to_string());
        // all functions return the same message
        texts.sort();
        assert_eq!(texts.first(), texts.last());
        writeln!(refusals.0, "{s}: {}", texts[0]).unwrap();
    }
    // the slowness of a fluid has a pole at s = 0, where the propagation coefficient is rejected
    let fluid = Medium::new(1000.0, rodwave::modulus::Maxwell::new(1e9, 1e6).unwrap()).unwrap();
    let at_rest = fluid.try_propagation_coefficient_at_s(Complex64::ZERO);
    refusals.add("fluid at rest", at_rest);
    assert!(law.try_at_s(Complex64::ZERO).is_ok());
    assert_snapshot!(refusals, @r"
    -1+5i: real part of the Laplace variable [1/s] is -1, expected a finite value, 0 or above
    NaN+5i: real part of the Laplace variable [1/s] is NaN, expected a finite value, 0 or above
    1+NaNi: imaginary part of the Laplace variable [rad/s] is NaN, expected a finite value
    inf+0i: real part of the Laplace variable [1/s] is inf, expected a finite value, 0 or above
    fluid at rest: the law has no finite propagation coefficient at s = 0+0i 1/s
    ");
}

#[test]
fn damped_synthesis() {
    let mut refusals = Refusals::default();
    for value in IMPOSSIBLE {
        refusals.add("duration", DampedSynthesis::new(value, 1e-6));
    }
    refusals.add("interval", DampedSynthesis::new(1e-3, f64::NAN));
    let synthesis = DampedSynthesis::new(1e-3, 1e-6).unwrap();
    refusals.add("smoothing", synthesis.smoothed(-0.5));
    let synthesis = DampedSynthesis::new(4e-6, 1e-6).unwrap();
    refusals.add("smoothing", synthesis.smoothed(1e-6));
    // all arguments of the synthesis are in the right half plane
    assert!(
        synthesis
            .arguments()
            .all(|s| LaplaceVariable::new(s).is_ok() && s.re > 0.0)
    );
    let mut transform = vec![Complex64::ONE; synthesis.arguments().len()];
    refusals.add("short", synthesis.history(&transform[1..]));
    transform[2] = Complex64::new(f64::NAN, 0.0);
    refusals.add("transform", synthesis.history(&transform));
    assert_snapshot!(refusals, @r"
    duration: duration [s] is 0, expected a finite value above 0
    duration: duration [s] is -0.5, expected a finite value above 0
    duration: duration [s] is NaN, expected a finite value above 0
    duration: duration [s] is inf, expected a finite value above 0
    interval: interval between samples [s] is NaN, expected a finite value above 0
    smoothing: standard deviation of the smoothing [s] is -0.5, expected a finite value above 0
    smoothing: duration less 8 standard deviations of the smoothing [s] is -0.000004, expected a finite value above 0
    short: transform has 4 entries, expected 5
    transform: sample 2 of transform is NaN, expected a finite value
    ");
}

#[test]
fn frequencies_that_are_no_numbers() {
    let power = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970).unwrap();
    let waves_only = Medium::new(1150.0, power).unwrap();
    let body = begun().end(Termination::Free).unwrap();
    let section = body.section(0, 0.05).unwrap();
    let segment = Segment::rod(circle(), 0.3).unwrap();
    let member = FrameMember::new(&steel(), circle(), 0.8, &[0.3], Termination::Free).unwrap();
    let blow = HalfSine::new(50.0, 2e-4).unwrap();
    let force = Excitation::Force(&blow);
    let mut refusals = Refusals::default();
    for omega in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut texts = [
            Elastic::new(206e9).unwrap().try_at(omega).map(|_| ()),
            steel().try_propagation_coefficient(omega).map(|_| ()),
            waves_only.try_propagation_coefficient(omega).map(|_| ()),
            segment.transition_matrix(&steel(), omega).map(|_| ()),
            TransitionMatrix::lumped_mass(1.0, omega).map(|_| ()),
            TransitionMatrix::spring(1.0, omega).map(|_| ()),
            body.mobility(omega).map(|_| ()),
            body.far_face_mobility(omega).map(|_| ()),
            body.transition_matrix(omega).map(|_| ()),
            section.state(omega).map(|_| ()),
            section.waves(omega).map(|_| ()),
            member.strain_spectra(&force, &[1e3, omega]).map(|_| ()),
        ]
        .map(|result| result.unwrap_err().to_string());
        texts.sort();
        assert_eq!(texts.first(), texts.last());
        writeln!(refusals.0, "{}", texts[0]).unwrap();
    }
    assert_snapshot!(refusals, @r"
    angular frequency [rad/s] is NaN, expected a finite value
    angular frequency [rad/s] is inf, expected a finite value
    angular frequency [rad/s] is -inf, expected a finite value
    ");
}

#[test]
fn sections_outside_the_rod() {
    let body = begun().end(Termination::Free).unwrap();
    let mut refusals = Refusals::default();
    for (element, distance) in [(0, -0.01), (0, 0.11), (0, f64::NAN), (1, 0.01), (2, 0.0)] {
        let section = body.section(element, distance);
        refusals.add(format!("{distance} m into element {element}"), section);
    }
    for position in [-0.1, 0.9, f64::NAN] {
        let positions = [0.3, position];
        let member = FrameMember::new(&steel(), circle(), 0.8, &positions, Termination::Free);
        refusals.add("gauge", member);
    }
    refusals.add(
        "no gauge",
        FrameMember::new(&steel(), circle(), 0.8, &[], Termination::Free),
    );
    let test = |section_distance, velocity| {
        let striker = Striker {
            velocity,
            ..Striker::PAPER_D
        };
        let test = ImpactTest {
            striker,
            rod: elastic_rod(),
            diameter: 0.02,
            section_distance,
        };
        test.run(1e-3, 1e-3)
    };
    for section_distance in [0.0, -0.1, 0.5, f64::NAN] {
        refusals.add("impact test", test(section_distance, 10.0));
    }
    refusals.add("impact test", test(0.1, f64::NAN));
    assert_snapshot!(refusals, @r"
    -0.01 m into element 0: element 0: distance of the section [m] is -0.01, expected between 0 and the length of the element
    0.11 m into element 0: element 0: distance of the section [m] is 0.11, expected between 0 and the length of the element
    NaN m into element 0: element 0: distance of the section [m] is NaN, expected between 0 and the length of the element
    0.01 m into element 1: element 1: distance of the section [m] is 0.01, expected 0 in an element without length
    0 m into element 2: the list of elements up to the section has 3 entries, expected 2
    gauge: element 0: distance of the section [m] is -0.1, expected between 0 and the length of the element
    gauge: element 0: distance of the section [m] is 0.9, expected between 0 and the length of the element
    gauge: element 0: distance of the section [m] is NaN, expected between 0 and the length of the element
    no gauge: the list of positions has 0 samples, expected at least 1
    impact test: distance of the section from the free end [m] is 0, expected above 0 and at most the length of the rod
    impact test: distance of the section from the free end [m] is -0.1, expected above 0 and at most the length of the rod
    impact test: distance of the section from the free end [m] is 0.5, expected above 0 and at most the length of the rod
    impact test: section distance [m] is NaN, expected a finite value
    impact test: striker velocity [m/s] is NaN, expected a finite value above 0
    ");
}

#[test]
fn inelastic_laws_and_their_solvers() {
    let mut refusals = Refusals::default();
    let law = MaxwellNorton::new(2.1, 7e13).unwrap();
    let rod = || InelasticRod::new(0.4, 910.0, 2.5e9, law).unwrap();
    refusals.add("modulus", InelasticRod::new(0.4, 910.0, 0.0, law));
    refusals.add("parameters", law.with_parameters(&[2.0]));
    refusals.add("parameters", law.with_parameters(&[f64::NAN, 0.0]));
    refusals.add("parameters", law.with_parameters(&[2.0, f64::NAN]));
    refusals.add("cells", DirectProblem::new(rod(), 7));
    refusals.add("chain", LumpedRod::new(&rod(), 1, 0.8));
    refusals.add("chain", LumpedRod::new(&rod(), 100, 1.1));
    let problem = DirectProblem::new(rod(), 50).unwrap();
    let excitation = SampledHistory::new(&[0.0; 52], 51_200.0).unwrap();
    for time in [-1e-6, f64::NAN, 2e-3] {
        refusals.add(
            "response",
            problem.free_end_velocity(&excitation, &[0.0, time]),
        );
    }
    assert_snapshot!(refusals, @r"
    modulus: Young's modulus [Pa] is 0, expected a finite value above 0
    parameters: parameter array has 1 entries, expected 2
    parameters: exponent kappa is NaN, expected a finite value
    parameters: reference rate [1/s] is NaN, expected a finite value above 0
    cells: number of cells is 7, expected from 8 to 2^27
    chain: number of cells is 1, expected from 4 to 2^27
    chain: Courant number is 1.1, expected above 0 and at most 0.95
    response: time of the response [s] is -0.000001, expected a finite value not below 0
    response: time of the response [s] is NaN, expected a finite value not below 0
    response: the response is requested until 0.002 s, but the excitation ends at 0.00099609375 s
    ");
}

fn elastic_rod() -> InelasticRod<inelastic::Elastic> {
    InelasticRod::new(0.4, 1100.0, 3e9, inelastic::Elastic).unwrap()
}

/// Checks numbers of cells and steps for which no memory suffices and whose sums and products
/// overflow.
#[test]
fn endless_grids_and_runs() {
    let mut refusals = Refusals::default();
    let history = SampledHistory::new(&[0.0, 1.0, 0.5, 0.0], 1e-9).unwrap();
    let direct = |times: &[f64]| {
        DirectProblem::new(elastic_rod(), 8)
            .unwrap()
            .free_end_velocity(&history, times)
    };
    let lumped = |times: &[f64]| {
        LumpedRod::new(&elastic_rod(), 8, 0.5)
            .unwrap()
            .free_end_velocity(&history, times)
    };
    let struck = |cell, duration| {
        let test = ImpactTest {
            striker: Striker::PAPER_D,
            rod: elastic_rod(),
            diameter: 0.0158,
            section_distance: 0.2,
        };
        test.run(cell, duration)
    };
    let segment = rodwave::line::Segment::elastic(1.0, 1e-4, 7780.0, 206e9).unwrap();
    let line = Line::new([Body::new([segment]).unwrap()]).unwrap();
    refusals.add("direct", DirectProblem::new(elastic_rod(), usize::MAX));
    refusals.add("lumped", LumpedRod::new(&elastic_rod(), usize::MAX, 0.5));
    refusals.add("struck", struck(1e-300, 1e-3));
    assert_snapshot!(refusals, @r"
    direct: number of cells is 18446744073709552000, expected from 8 to 2^27
    lumped: number of cells is 18446744073709552000, expected from 4 to 2^27
    struck: number of cells is 18446744073709552000, expected from 4 to 2^27
    ");
    for error in [
        struck(1e-3, 1e300).unwrap_err(),
        direct(&[2e9]).unwrap_err(),
        lumped(&[2e9]).unwrap_err(),
        line.run(1e-5, 1e300, &[]).unwrap_err(),
    ] {
        let said = error.to_string();
        assert!(said.starts_with("number of time steps is "), "{said}");
    }
    // times before the start of the record are rejected
    assert!(lumped(&[-1e300]).is_err() && lumped(&[-1.0]).is_err());
}

#[test]
fn what_is_no_number_has_no_value() {
    let chain = LumpedRod::new(&elastic_rod(), 8, 0.5)
        .unwrap()
        .moving_at(3.0);
    assert!(chain.velocity_at(f64::NAN).is_nan());
}

#[test]
fn lines_that_are_not_there() {
    let mut refusals = Refusals::default();
    let body = |modulus| {
        let segment = rodwave::line::Segment::elastic(1.0, 1e-4, 1e-9, modulus).unwrap();
        Body::new([segment])
    };
    let line = |modulus| Line::new([body(modulus).unwrap()]).unwrap();
    let nowhere = Gauge {
        body: usize::MAX,
        position: 0.0,
    };
    refusals.add("body", line(1e9).run(1e-12, 1e-11, &[nowhere]));
    refusals.add("contact", line(1e9).with_gap(usize::MAX, 0.0));
    refusals.add("speed", body(1e300));
    assert_snapshot!(refusals, @r"
    body: list of bodies of a line has 1 entries, expected 18446744073709551615
    contact: list of contacts has 0 entries, expected 18446744073709551615
    speed: element 0: wave speed [m/s] is inf, expected a finite value above 0
    ");
}

/// Law with five parameters, one more than allowed.
#[derive(Debug, Clone)]
struct FiveParameters;

impl InelasticLaw for FiveParameters {
    const PARAMETERS: &'static [&'static str] = &["a", "b", "c", "d", "ln_reference_rate"];
    type Flow = Self;

    fn inelastic_strain_rate(&self, _stress: f64) -> f64 {
        0.0
    }

    fn flow(&self, _modulus: f64, _duration: f64) -> Self {
        Self
    }

    fn parameters(&self) -> Vec<f64> {
        vec![0.0; 5]
    }

    fn with_parameters(&self, _parameters: &[f64]) -> Result<Self, RodwaveError> {
        Ok(Self)
    }

    fn reference_stress(&self) -> f64 {
        1e6
    }
}

impl RelaxationFlow for FiveParameters {
    fn relax(&self, stress: f64) -> f64 {
        stress
    }

    fn relax_with_sensitivity(&self, stress: f64, by_parameter: &mut [f64]) -> RelaxedStress {
        by_parameter.fill(0.0);
        RelaxedStress {
            stress,
            by_stress: 1.0,
            by_log_modulus: 0.0,
        }
    }
}

#[test]
fn laws_of_too_many_parameters() {
    let mut refusals = Refusals::default();
    let history = SampledHistory::new(&[0.0, 1.0, 0.5, 0.0], 51_200.0).unwrap();
    let rod = InelasticRod::new(0.4, 1100.0, 3e9, FiveParameters).unwrap();
    let segment = rodwave::line::Segment::new(0.4, 1e-4, 1100.0).unwrap();
    let problem = DirectProblem::new(rod, 8).unwrap();
    assert!(problem.free_end_velocity(&history, &[1e-5]).is_ok());
    refusals.add(
        "derivatives",
        problem.free_end_velocity_with_sensitivities(&history, &[1e-5]),
    );
    refusals.add("branch", segment.with_branch(3e9, FiveParameters));
    assert_snapshot!(refusals, @r"
    derivatives: list of parameters of the law has 5 entries, expected 4
    branch: list of parameters of the law has 5 entries, expected 4
    ");
    // derivatives are computed for the first four parameters only
    let changes = FiveParameters.change_with_sensitivity(&[1e6; LANES], 5);
    assert_eq!(
        changes,
        FiveParameters.change_with_sensitivity(&[1e6; LANES], 4)
    );
}

/// Checks that a slice with fewer entries than the law has parameters receives the first
/// derivatives.
#[test]
fn slices_too_short_for_the_parameters() {
    fn check(law: &impl InelasticLaw) {
        let flow = law.flow(3e9, 1e-4);
        let mut all = [0.0; 2];
        let relaxed = flow.relax_with_sensitivity(1e6, &mut all);
        let mut first = [0.0; 1];
        assert_eq!(flow.relax_with_sensitivity(1e6, &mut first), relaxed);
        assert_eq!(flow.relax_with_sensitivity(1e6, &mut []), relaxed);
        assert_eq!(first[0].to_bits(), all[0].to_bits());
    }
    check(&inelastic::Maxwell::new(4e6).unwrap());
    check(&MaxwellNorton::new(2.108, 7e13).unwrap());
    check(&MaxwellGurevichRabinovich::new(3.5e6, 7.08e6).unwrap());
}
