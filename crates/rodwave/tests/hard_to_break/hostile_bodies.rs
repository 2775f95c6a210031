//! Elements, chains, waves and theories of thick rods with hostile sizes.

use num_complex::Complex64;
use rodwave::chain::AnalyticChain;
use rodwave::element::{Circle, CrossSection, Segment};
use rodwave::experiment::end_accelerations::{
    EndAccelerationTest, HalfSine, Pulse, RaisedCosine, Specimen,
};
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
use rodwave::medium::Medium;
use rodwave::modulus::Elastic;
use rodwave::slenderness::{
    LoveRayleigh, MindlinHerrmann, PochhammerChree, RectangularRod, RodTheory, RoundRod,
    Slenderness, Theory, elementary_theory_error, rayleigh_to_shear_speed,
};
use rodwave::transition::TransitionMatrix;
use rodwave::waves::TravellingWaves;
use rodwave::{Chain, Termination};

use super::hostile::are_modest;
use super::{Findings, Numbers, parts};
use crate::bodies::polymer;

fn entries(matrix: &TransitionMatrix) -> Vec<f64> {
    parts(matrix.entries().concat())
}

fn segment(segment: &Segment, omega: f64, distance: f64) -> Numbers {
    let cut = segment.cut(distance)?;
    let matrix = segment.transition_matrix(&polymer(), omega)?;
    let mut numbers = entries(&matrix);
    numbers.extend([segment.area_at(distance)?, segment.volume()]);
    numbers.extend([
        cut.near.volume(),
        cut.far.volume(),
        segment.turned().volume(),
    ]);
    Ok(numbers)
}

#[test]
fn elements() {
    let mut findings = Findings::default();
    findings.sweep_pairs("rod", &[1e-4, 0.5, 1e4, 0.2], |a| {
        segment(
            &Segment::rod(CrossSection::of_area(a[0])?, a[1])?,
            a[2],
            a[3],
        )
    });
    findings.sweep_pairs("cone", &[1e-4, 3e-4, 0.5, 1e4, 0.2], |a| {
        let ends = [CrossSection::of_area(a[0])?, CrossSection::of_area(a[1])?];
        segment(&Segment::cone(ends[0], ends[1], a[2])?, a[3], a[4])
    });
    findings.sweep_pairs("horn", &[1e-4, 3e-4, 0.5, 1e4, 0.2], |a| {
        let ends = [CrossSection::of_area(a[0])?, CrossSection::of_area(a[1])?];
        segment(&Segment::horn(ends[0], ends[1], a[2])?, a[3], a[4])
    });
    findings.sweep_pairs("Circle", &[0.02], |a| {
        let circle = Circle::of_diameter(a[0])?;
        Ok(vec![circle.diameter(), CrossSection::from(circle).area()])
    });
    findings.sweep_pairs("uniform_rod", &[0.1, 10.0, 100.0, 1.0, 0.5], |a| {
        let (gamma, z) = (Complex64::new(a[0], a[1]), Complex64::new(a[2], a[3]));
        let matrix = TransitionMatrix::uniform_rod(gamma, z, a[4])?;
        Ok([entries(&matrix), parts([matrix.mobility_free_end()?])].concat())
    });
    findings.sweep_pairs("lumped_mass", &[0.1, 1e4], |a| {
        TransitionMatrix::lumped_mass(a[0], a[1]).map(|matrix| entries(&matrix))
    });
    findings.sweep_pairs("spring", &[1e6, 1e4], |a| {
        TransitionMatrix::spring(a[0], a[1]).map(|matrix| entries(&matrix))
    });
    findings.sweep_pairs("dashpot", &[1e3], |a| {
        TransitionMatrix::dashpot(a[0]).map(|matrix| entries(&matrix))
    });
    findings.none();
}

/// Returns all numbers that a chain can give at one frequency.
fn answers(chain: &Chain, omega: f64) -> Numbers {
    let mut numbers = parts([chain.mobility(omega)?, chain.far_face_mobility(omega)?]);
    if let Ok(matrix) = chain.transition_matrix(omega) {
        numbers.extend(entries(&matrix));
    }
    for element in 0..chain.n_elements() {
        let section = chain.section(element, 0.0)?;
        let state = section.state(omega)?;
        numbers.extend(parts([state.normal_force, state.velocity]));
        if let Ok(waves) = section.waves(omega) {
            numbers.extend(parts([waves.forward_at(0.0), waves.backward_at(0.0)]));
        }
    }
    Ok(numbers)
}

#[test]
fn chains() {
    let mut findings = Findings::default();
    findings.sweep_pairs("chain", &[1e-4, 2e-4, 0.5, 0.3, 0.1, 1e6, 1e3, 1e4], |a| {
        let medium = polymer();
        let [near, far] = [0, 1].map(|i| CrossSection::of_area(a[i]));
        let chain = Chain::from_impact_face()
            .rod(&medium, near.clone(), a[2])
            .cone(&medium, near.clone(), far.clone(), a[3])
            .mass(a[4])
            .spring(a[5])
            .horn(&medium, far, near, 0.2)
            .dashpot(a[6])
            .end(Termination::Mass(a[4]))?;
        answers(&chain, a[7])
    });
    findings.sweep_pairs("material of a chain", &[910.0, 3e9, 1e-4, 0.5, 1e4], |a| {
        let medium = Medium::new(a[0], Elastic::new(a[1])?)?;
        let section = CrossSection::of_area(a[2])?;
        let chain = Chain::from_impact_face()
            .rod(&medium, section, a[3])
            .end(Termination::semi_infinite(&medium, section))?;
        answers(&chain, a[4])
    });
    findings.sweep_pairs("analytic chain", &[1e-4, 0.5, 1e3, 1e4, 0.1], |a| {
        let chain = AnalyticChain::analytic_from_impact_face()
            .rod(&polymer(), CrossSection::of_area(a[0]), a[1])
            .end(Termination::impedance_at_s({
                let mass = a[4];
                move |s| s * mass
            }))?;
        let s = Complex64::new(a[2], a[3]);
        let state = chain.section(0, 0.5 * a[1])?.state_at_s(s)?;
        let faces = [chain.mobility_at_s(s)?, chain.far_face_mobility_at_s(s)?];
        Ok(parts([
            faces[0],
            faces[1],
            state.normal_force,
            state.velocity,
        ]))
    });
    findings.none();
}

#[test]
fn waves_at_sections() {
    let mut findings = Findings::default();
    let sound = [0.3, 12.0, 0.0, 0.1, 0.25, 1.0, -0.5, 2.0, 0.1];
    findings.sweep_pairs("TravellingWaves", &sound, |a| {
        let gamma = Complex64::new(a[0], a[1]);
        let values =
            [(a[5], a[6]), (a[7], a[8]), (0.3, 0.2)].map(|(re, im)| Complex64::new(re, im));
        let found = TravellingWaves::from_sections(gamma, &a[2..5], &values)?;
        assert!(!found.condition_number.is_nan());
        let mut numbers = vec![found.misfit];
        if found.condition_number < 1e12 {
            // the waves at the sections, if the sections can separate them
            numbers.extend(parts(a[2..5].iter().map(|x| found.waves.at(*x))));
        }
        Ok(numbers)
    });
    findings.none();
}

fn theory(theory: &impl RodTheory, modulus: Complex64, omega: f64) -> Numbers {
    let mut numbers = Vec::new();
    if let Some(gamma) = theory.propagation_coefficient(modulus, omega)?.found() {
        numbers.extend(parts([gamma]));
        if let Some(found) = theory.modulus(gamma, omega)?.found() {
            numbers.extend(parts([found.modulus, found.by_poisson_ratio]));
            numbers.push(found.standard_error(0.01)?.loss_factor);
        }
    }
    Ok(numbers)
}

#[test]
fn thick_rods() {
    let mut findings = Findings::default();
    let round = |a: &[f64]| RoundRod {
        density: a[0],
        diameter: a[1],
        poisson_ratio: a[2],
    };
    let sound = [910.0, 0.02, 0.35, 2e9, 1e8, 3e4];
    let modulus = |a: &[f64]| Complex64::new(a[3], a[4]);
    findings.sweep_pairs("LoveRayleigh", &sound, |a| {
        theory(&LoveRayleigh::round(round(a))?, modulus(a), a[5])
    });
    findings.sweep_pairs("LoveRayleigh, rectangular", &sound, |a| {
        let rod = RectangularRod {
            density: a[0],
            width: a[1],
            height: 0.03,
            poisson_ratio: a[2],
        };
        theory(&LoveRayleigh::rectangular(rod)?, modulus(a), a[5])
    });
    findings.sweep_pairs("MindlinHerrmann", &sound, |a| {
        theory(&MindlinHerrmann::new(round(a))?, modulus(a), a[5])
    });
    findings.sweep("PochhammerChree", &sound, |a| {
        theory(&PochhammerChree::new(round(a))?, modulus(a), a[5])
    });
    findings.sweep_pairs("Slenderness", &[10.0, 0.02, 0.5], |a| {
        let slenderness = Slenderness::of_wave_number(a[0], a[1], a[2])?;
        Ok(vec![
            slenderness.wavelength_in_diameters(),
            slenderness.wavelength_in_lengths(),
        ])
    });
    for theory in [Theory::Elementary, Theory::LoveRayleigh] {
        findings.sweep_pairs("Theory::error_left", &[8.0, 0.35], |a| {
            theory.error_left(a[0], a[1]).map(|error| vec![error])
        });
    }
    findings.sweep_pairs("elementary_theory_error", &[8.0, 0.35], |a| {
        let error = elementary_theory_error(a[0], a[1])?;
        Ok(vec![error.storage_modulus, error.loss_factor])
    });
    findings.sweep_pairs("rayleigh_to_shear_speed", &[0.35], |a| {
        rayleigh_to_shear_speed(a[0]).map(|ratio| vec![ratio])
    });
    findings.none();
}

#[test]
fn pulses_and_instruments() {
    let mut findings = Findings::default();
    findings.sweep_pairs("EndAccelerationTest", &[1e-4, 0.5, 1e-3, 1e4], |a| {
        let specimen = Specimen {
            section: CrossSection::of_area(a[0])?,
            length: a[1],
            accelerometer_mass: a[2],
        };
        let test = EndAccelerationTest::new(&polymer(), &specimen)?;
        Ok(parts([test.acceleration_ratio(a[3])?]))
    });
    findings.sweep_pairs(
        "FrameMember",
        &[1e-4, 0.5, 0.2, 1e6, 10.0, 0.1, 1e4, 1e-4],
        |a| {
            let support = EndSupport {
                stiffness: a[3],
                resistance: a[4],
                mass: a[5],
            };
            let section = CrossSection::of_area(a[0])?;
            let member =
                FrameMember::new(&polymer(), section, a[1], &[a[2]], support.termination())?
                    .with_left_structure(support.termination())?;
            let pulse = HalfSine::new(10.0, a[7])?;
            let force = member.strain_spectra(&Excitation::Force(&pulse), &[a[6]])?;
            let velocity = member.strain_spectra(&Excitation::Velocity(&pulse), &[a[6]])?;
            Ok(parts(force.concat().into_iter().chain(velocity.concat())))
        },
    );
    findings.sweep_pairs("pulses in time", &[10.0, 1e-3, 2e-4], |a| {
        let pulses = (HalfSine::new(a[0], a[1])?, RaisedCosine::new(a[0], a[1])?);
        let values = vec![pulses.0.at(a[2]), pulses.1.at(a[2])];
        Ok(if are_modest(a) { values } else { Vec::new() })
    });
    findings.none();
}
