//! Claims on the selection of a law from tests at two velocities and at one, on the classifier of
//! paper D, and on p-values that may reject all laws.

use maxwellid::adequacy::{Basis, RobbinsMonro, Weights};
use maxwellid::conformal::p_values;
use maxwellid::design::{Design, Estimated, PlannedTest};
use maxwellid::profile::profiles;
use maxwellid::samples::{Pattern, StandardSamples};
use maxwellid::selection::{Candidate, Comparison, Decision, Selection};
use maxwellid::{Law, Provenance, RodTest, Verdict};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use rodwave::inelastic::{Elastic, Maxwell, MaxwellNorton};
use rodwave::line::{self, Segment};
use rodwave::modulus::{ComplexModulus, ConstantQ, GeneralisedMaxwell};

use crate::virtual_rod::{DENSITY, LENGTH, VirtualRod, struck, times};
use crate::virtual_tests::constant_q_stack;
use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;
use testbed::struck_rod::by_line;

const MODULUS: f64 = 2.6e9;
const REFERENCE_OMEGA: f64 = std::f64::consts::TAU * 4e3;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    nonlinear(claims);
    linear(claims);
    profile(claims);
    planned(claims);
    classifier(claims);
    conformal(claims);
    hold!(claims);
}

/// A law of polypropylene with a relaxation time of 0.5 ms at 10 MPa.
fn norton() -> Ours<MaxwellNorton> {
    Ok(MaxwellNorton::from_reference_rate(2.0, 8.0, 10e6)?)
}

/// Returns a test with stated noise of `level` times the impact velocity on both histories.
fn with_noise(clean: &VirtualRod, level: f64, seed: u64) -> Ours<RodTest> {
    let deviation = level * clean.data.impact_velocity;
    Ok(RodTest::new(clean.noisy(deviation, seed))?.with_noise(deviation, deviation)?)
}

fn compared(clean: &[VirtualRod], seed: u64) -> Ours<Comparison> {
    let tests = clean
        .iter()
        .zip(0..)
        .map(|(test, k)| with_noise(test, 0.01, 10 * seed + k))
        .collect::<Ours<Vec<_>>>()?;
    Ok(Selection::new(Candidate::standard())?
        .with_cell(8e-3)?
        .compare(&tests)?)
}

fn all_compared(clean: &Ours<Vec<VirtualRod>>, seeds: u64) -> Ours<Vec<Comparison>> {
    let clean = clean.as_ref().map_err(Clone::clone)?;
    (0..seeds)
        .into_par_iter()
        .map(|seed| compared(clean, seed))
        .collect()
}

fn nonlinear(claims: &mut Claims) {
    claims.by("Norton rod of the lumped chain at 3 and 27 m/s, 5 draws of noise of 1 %");
    let clean = || -> Ours<Vec<VirtualRod>> {
        let law = norton()?;
        let at = |v| struck(LENGTH, v, MODULUS, &law, 128);
        Ok(vec![at(3.0), at(27.0)])
    };
    let found = all_compared(&clean(), 5);
    let names_norton = |comparison: &&Comparison| match &comparison.decision {
        Decision::Law { candidate, .. } => comparison
            .laws
            .get(*candidate)
            .is_some_and(|law| law.law == Some(Law::Norton)),
        _ => false,
    };
    claims.claim(
        "two velocities: draws in which the Norton law is named",
        "1",
        5.0,
        Within(1.5, "the law has to be named in 19 of 20 draws"),
        of(&found, |found| {
            found.iter().filter(names_norton).count() as f64
        }),
    );
    claims.claim(
        "two velocities: mean exponent of the Norton law",
        "1",
        2.0,
        Within(0.09, "four times 0.05/sqrt(5)"),
        of(&found, |found| {
            let exponents = found.iter().map(|comparison| {
                let mut laws = comparison.laws.iter();
                let norton = laws.find(|law| law.law == Some(Law::Norton));
                norton
                    .and_then(|law| law.parameters.get(1).copied())
                    .unwrap_or(f64::NAN)
            });
            exponents.sum::<f64>() / found.len() as f64
        }),
    );
    claims.by("probabilities of exclusive laws");
    claims.deviation(
        "two velocities: sum of the probabilities of all laws, minus 1",
        Within(1e-12, "rounding of nine terms"),
        of(&found, |found| {
            largest(found.iter().map(|comparison| {
                let sum: f64 = comparison.laws.iter().map(|law| law.probability).sum();
                (sum - 1.0).abs()
            }))
        }),
    );
}

/// A rod of a linear `material`: the response is computed by `rodwave::line`, the excitation is
/// that of a Maxwell rod of nearly the same damping.
fn linear_rod(material: &GeneralisedMaxwell) -> Ours<VirtualRod> {
    let mut rod = struck(LENGTH, 10.0, MODULUS, &Maxwell::new(4e6)?, 128);
    let segment = Segment::prony(LENGTH, 1e-4, DENSITY, material)?;
    let times = times(rod.data.excitation.len());
    rod.data.response = by_line(segment, &rod.excitation, &times, 1.5e-6)?;
    rod.data.provenance = Provenance::Virtual {
        generator: line::GENERATOR.into(),
    };
    Ok(rod)
}

fn linear(claims: &mut Claims) {
    claims.by("Kjartansson's constant loss factor of 0.07, 0.2 to 20 kHz");
    let flatness = || -> Ours {
        let stack = constant_q_stack(0.07);
        let exact = ConstantQ::new(MODULUS, 0.07, REFERENCE_OMEGA)?;
        Ok(largest((0..=40).map(|k| {
            let omega = std::f64::consts::TAU * 200.0 * 10.0_f64.powf(f64::from(k) / 20.0);
            (stack.at(omega).norm() / exact.at(omega).norm() - 1.0).abs()
        })))
    };
    claims.deviation(
        "modulus of the Prony series that represents a constant loss factor",
        Within(2e-3, "branches a third of a decade apart"),
        flatness(),
    );
    claims.by("linear rod of constant loss factor by rodwave::line, one velocity, 6 draws of noise of 1 %");
    let clean = || -> Ours<Vec<VirtualRod>> { Ok(vec![linear_rod(&constant_q_stack(0.07))?]) };
    let found = all_compared(&clean(), 6);
    claims.claim(
        "constant loss factor: draws in which a nonlinear law is named",
        "1",
        0.0,
        Within(0.5, "a count"),
        of(&found, |found| {
            found.iter().filter(|c| c.is_nonlinear_verdict()).count() as f64
        }),
    );
    claims.claim(
        "constant loss factor: largest probability of nonlinear laws together",
        "1",
        0.0,
        Within(
            1e-6,
            "the misfit of nonlinear laws is 2 % of the impact velocity and more",
        ),
        of(&found, |found| {
            largest(found.iter().map(|c| c.nonlinear_probability))
        }),
    );
    claims.claim(
        "constant loss factor: draws in which all laws are refused",
        "1",
        0.0,
        Within(0.5, "a count at a level of 0.001"),
        of(&found, |found| {
            let refused = |c: &&Comparison| matches!(c.decision, Decision::NoneOfThese { .. });
            found.iter().filter(refused).count() as f64
        }),
    );
}

fn profile(claims: &mut Claims) {
    claims.by("a linear rod of the lumped chain, the power law fitted, noise of 1 %");
    let linear = || -> Ours {
        let clean = struck(LENGTH, 10.0, MODULUS, &Maxwell::new(2e6)?, 128);
        let tests = [with_noise(&clean, 0.01, 5)?];
        let found = profiles(&Candidate::of(Law::Norton), &tests, 8e-3)?;
        let exponent = found.get(1).ok_or_else(|| missing("the exponent"))?;
        let reason = exponent.reason();
        assert_eq!(exponent.verdict, Verdict::Identified, "{reason}");
        // the linearised errors of such a test are of order 0.1
        let width = exponent.upper.unwrap() - exponent.lower.unwrap();
        assert!(width > 0.05 && width < 1.5, "{reason}");
        Ok(f64::from(u8::from(exponent.contains(1.0))))
    };
    let yes = Within(0.5, "yes or no");
    claims.claim(
        "linear rod: the profile interval of the exponent contains 1",
        "1",
        1.0,
        yes,
        linear(),
    );
    claims.by("an elastic rod of the lumped chain, noise of 2 %");
    let elastic = || -> Ours<[f64; 2]> {
        let clean = struck(LENGTH, 10.0, MODULUS, &Elastic, 128);
        let tests = [with_noise(&clean, 0.02, 8)?];
        let verdict = |law: Law| -> Ours<Verdict> {
            let found = profiles(&Candidate::of(law), &tests, 8e-3)?;
            Ok(found.get(1).ok_or_else(|| missing("a parameter"))?.verdict)
        };
        let time = verdict(Law::Maxwell)?;
        // the window is 2.8 ms; a relaxation time as long would reduce a wave by a tenth on its way
        // through the rod
        if let Verdict::BoundedBelow(least) = &time {
            assert!(*least > 1e-3_f64.ln() && *least < 1.0_f64.ln(), "{least}");
        }
        let bounded = matches!(time, Verdict::BoundedBelow(_));
        let open = verdict(Law::Norton)? == Verdict::NotIdentifiable;
        Ok([bounded, open].map(|is| f64::from(u8::from(is))))
    };
    let elastic = elastic();
    claims.claim(
        "elastic rod: the relaxation time is bounded from below only",
        "1",
        1.0,
        yes,
        of(&elastic, |found| found[0]),
    );
    claims.claim(
        "elastic rod: the exponent is not identifiable",
        "1",
        1.0,
        yes,
        of(&elastic, |found| found[1]),
    );
}

/// Claims on a planned repetition, which changes the information from A = P + I, with the prior P
/// and the first test I, to P + 2I = 2A - P.
fn planned(claims: &mut Claims) {
    claims.by("a repetition adds the information of the first test again");
    let ratios = || -> Ours<f64> {
        let clean = struck(LENGTH, 10.0, MODULUS, &norton()?, 128);
        let tests = [with_noise(&clean, 0.01, 1)?];
        let design = Design {
            tests: &tests,
            cell: 8e-3,
        };
        let candidate = Candidate::of(Law::Norton);
        let parameters = [MODULUS.ln(), 2.0, 8.0_f64.ln()];
        let law = Estimated {
            candidate: &candidate,
            parameters: &parameters,
        };
        let again = PlannedTest::at_velocity(&tests[0], 10.0)?;
        let before = design.deviations(law, &[])?;
        let after = design.deviations(law, &[again])?;
        Ok(before[0].powi(2) / after[0].powi(2))
    };
    claims.claim(
        "variance of ln E before a repetition over that after it",
        "1",
        2.0,
        Within(
            0.02,
            "the repetition does not repeat the prior, whose share of the information is below 1 %",
        ),
        ratios(),
    );
}

fn classifier(claims: &mut Claims) {
    claims.by("paper D, section 2.2 (erratum of Table 3): converged least squares sum to one");
    let found = || -> Ours<[f64; 2]> {
        let clean = struck(LENGTH, 10.0, MODULUS, &norton()?, 128);
        let tests = [with_noise(&clean, 0.01, 1)?];
        let laws = [Law::Maxwell, Law::Norton, Law::GurevichRabinovich].map(Candidate::of);
        let samples = StandardSamples::of(&laws, &tests, 60, Pattern::Absolute)?;
        let projection = samples.projection(6)?;
        let features: Vec<Vec<f64>> = samples
            .patterns
            .iter()
            .map(|pattern| Ok(Basis::Linear.of(&projection.project(pattern)?)))
            .collect::<Ours<_>>()?;
        let measured = Basis::Linear.of(&projection.project(&samples.measured(&tests))?);
        let limit = Weights::least_squares(&features, &samples.class_of, 0.0)?;
        let limit = limit.adequacies(&measured)?;
        let settings = RobbinsMonro::default();
        let recursion = Weights::robbins_monro(&features, &samples.class_of, &settings)?;
        let recursion = recursion.adequacies(&measured)?;
        Ok([
            limit.iter().sum::<f64>(),
            largest(recursion.iter().zip(&limit).map(|(a, b)| (a - b).abs())),
        ])
    };
    let found = found();
    claims.claim(
        "classifier of paper D: sum of the measures at the limit",
        "1",
        1.0,
        Within(1e-10, "rounding of a least-squares solution"),
        of(&found, |found| found[0]),
    );
    claims.deviation(
        "classifier of paper D: recursion of Robbins and Monro against its limit",
        Within(0.02, "300 passes with gains of 1/k, averaged"),
        of(&found, |found| found[1]),
    );
}

/// Claims on conformal p-values: all ranks of a pattern that is exchangeable with its 40 samples
/// are equally likely.
fn conformal(claims: &mut Claims) {
    claims.by("ranks of exchangeable patterns: p <= e with a probability of at most e");
    let found = || -> Ours<[f64; 2]> {
        let mut random = ChaCha8Rng::seed_from_u64(6);
        let (mut mean, mut below) = (0.0, 0.0);
        let draws = 2000;
        for _ in 0..draws {
            let mut pattern = || -> Vec<f64> { (0..3).map(|_| random.random()).collect() };
            let samples: Vec<Vec<f64>> = (0..40).map(|_| pattern()).collect();
            let p = p_values(&samples, &[0; 40], &pattern())?;
            let p = p.first().copied().unwrap_or(f64::NAN);
            mean += p / f64::from(draws);
            below += f64::from(u8::from(p <= 0.1)) / f64::from(draws);
        }
        Ok([mean, below])
    };
    let found = found();
    claims.claim(
        "conformal p-values of 2000 patterns: mean of uniform ranks",
        "1",
        42.0 / 82.0,
        Within(
            0.035,
            "four times 0.29/sqrt(2000), and the effect of one neighbour fewer for a sample",
        ),
        of(&found, |found| found[0]),
    );
    claims.claim(
        "conformal p-values of 2000 patterns: part at 0.1 or below",
        "1",
        4.0 / 41.0,
        Within(0.027, "sqrt(0.1 0.9/2000), times four"),
        of(&found, |found| found[1]),
    );
}
