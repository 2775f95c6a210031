//! The checks without truth: which of them fail on records with a fault of known kind, and how often on right ones.

use std::f64::consts::TAU;

use cmod::checks::{CheckOutcome, FreeEndNull, USUAL_LEVEL, kramers_kronig, passivity};
use cmod::estimate::ModulusEstimate;
use cmod::multi_point::{GaugeSpectra, Quantity};
use cmod::{EndSection, FreeEnd, RatioOfSpectra, RodWithFreeEnd};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rodwave::chain::{AngularFrequency, Chain, Termination, WaveMedium};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{ComplexModulus, GeneralisedMaxwell, MaxwellBranch};

use testbed::claim::{Claims, Ours, Within};
use testbed::hold;

const LENGTH: f64 = 1.2;
const DIAMETER: f64 = 0.0106;
const DENSITY: f64 = 903.0;
const END_MASS: f64 = 1e-3;
/// From the free end, in m.
const DISTANCES: [f64; 3] = [0.52, 0.25, 0.11];
/// Error of a strain by the root mean square of the spectra of a line.
const NOISE: f64 = 2e-3;

const ROD: RodWithFreeEnd = RodWithFreeEnd {
    diameter: DIAMETER,
    density: DENSITY,
    end_mass: END_MASS,
};

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    let yes = Within(0.5, "yes or no");
    claims.by("no force at a free end");
    let right = |level| -> Ours<bool> {
        Ok(Record::of(&relaxing()?, DISTANCES, 5)?
            .free_end_null(level)?
            .has_failed())
    };
    claims.claim(
        "right record: force at the free end is seen",
        "1",
        0.0,
        yes,
        right(USUAL_LEVEL).map(number),
    );
    let displaced = || -> Ours<bool> {
        let mut distances = DISTANCES;
        distances[2] += 1e-3;
        Ok(Record::of(&relaxing()?, distances, 6)?
            .free_end_null(USUAL_LEVEL)?
            .has_failed())
    };
    claims.claim(
        "gauge 1 mm out of place: force at the free end is seen",
        "1",
        1.0,
        yes,
        displaced().map(number),
    );
    let delayed = || -> Ours<bool> {
        let mut record = Record::of(&relaxing()?, DISTANCES, 10)?;
        let lines = record.frequency_hz.clone();
        for (value, f) in record.strains[2].iter_mut().zip(&lines) {
            *value *= Complex64::from_polar(1.0, -TAU * f * 1e-6);
        }
        Ok(record.free_end_null(USUAL_LEVEL)?.has_failed())
    };
    claims.claim(
        "channel late by a microsecond: force at the free end is seen",
        "1",
        1.0,
        yes,
        delayed().map(number),
    );
    let alarms = || -> Ours {
        let medium = relaxing()?;
        let mut alarms = 0.0;
        for seed in 0..200 {
            let record = Record::of(&medium, DISTANCES, 1000 + seed)?;
            alarms += number(record.free_end_null(0.05)?.has_failed());
        }
        Ok(alarms / 200.0)
    };
    claims.claim(
        "right records: part of false alarms of the free end at the level 0.05",
        "1",
        0.05,
        Within(0.062, "sqrt(0.05 0.95/200) = 1.5 %, four of it"),
        alarms(),
    );
    claims.by("a material takes energy: E'' >= 0");
    let conjugated = || -> Ours<bool> {
        let mut record = Record::of(&relaxing()?, DISTANCES, 12)?;
        for value in record.strains.iter_mut().flatten() {
            *value = value.conj();
        }
        Ok(passivity(&record.estimate()?, USUAL_LEVEL)?.has_failed())
    };
    claims.claim(
        "spectra of the other sign of time: the material seems to give energy",
        "1",
        1.0,
        yes,
        conjugated().map(number),
    );
    let passive = || -> Ours<bool> {
        let record = Record::of(&relaxing()?, DISTANCES, 5)?;
        Ok(passivity(&record.estimate()?, USUAL_LEVEL)?.has_failed())
    };
    claims.claim(
        "right record: the material seems to give energy",
        "1",
        0.0,
        yes,
        passive().map(number),
    );
    claims.by("Kramers and Kronig's relations");
    let not_causal = || -> Ours<bool> {
        let medium = Medium::new(DENSITY, ConstantBoth)?;
        let record = Record::of(&medium, DISTANCES, 11)?;
        Ok(kramers_kronig(&record.estimate()?, USUAL_LEVEL)?.has_failed())
    };
    claims.claim(
        "E' and E'' both constant over frequency: refused as a material",
        "1",
        1.0,
        yes,
        not_causal().map(number),
    );
    let causal = || -> Ours<bool> {
        let record = Record::of(&relaxing()?, DISTANCES, 5)?;
        Ok(kramers_kronig(&record.estimate()?, USUAL_LEVEL)?.has_failed())
    };
    claims.claim(
        "relaxing material: refused as a material",
        "1",
        0.0,
        yes,
        causal().map(number),
    );
    hold!(claims);
}

fn number(yes: bool) -> f64 {
    f64::from(u8::from(yes))
}

/// Loss factors of about 0.06 between 100 Hz and 20 kHz.
fn relaxing() -> Ours<Medium<GeneralisedMaxwell>> {
    let branches = (0..6)
        .map(|j| MaxwellBranch {
            modulus: 1.3e8,
            relaxation_time: 3e-6 * 4f64.powi(j),
        })
        .collect();
    Ok(Medium::new(
        DENSITY,
        GeneralisedMaxwell::new(2.14e9, branches)?,
    )?)
}

/// Passive, but no material.
#[derive(Debug, Clone)]
struct ConstantBoth;

impl ComplexModulus for ConstantBoth {
    fn at(&self, omega: f64) -> Complex64 {
        2.6e9 * Complex64::new(1.0, 0.07 * omega.signum())
    }
}

/// Strains at three sections, with noise.
struct Record {
    frequency_hz: Vec<f64>,
    strains: Vec<Vec<Complex64>>,
    noise: Vec<Vec<f64>>,
}

impl Record {
    fn of<M>(medium: &M, distances: [f64; 3], seed: u64) -> Ours<Self>
    where
        M: WaveMedium<AngularFrequency> + Clone + 'static,
    {
        let frequency_hz: Vec<f64> = (1..=120).map(|j| 80.0 * f64::from(j)).collect();
        let chain = Chain::from_impact_face()
            .rod(medium, Circle::of_diameter(DIAMETER)?, LENGTH)
            .end(Termination::Mass(END_MASS))?;
        let mut strains = Vec::new();
        for distance in distances {
            let section = chain.section(0, LENGTH - distance)?;
            let mut spectrum = Vec::new();
            for f in &frequency_hz {
                spectrum.push(section.state(TAU * f)?.normal_force);
            }
            strains.push(spectrum);
        }
        let level: Vec<f64> = (0..frequency_hz.len())
            .map(|line| {
                let power: f64 = strains.iter().map(|s| s[line].norm_sqr()).sum();
                NOISE * (power / 3.0).sqrt()
            })
            .collect();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        for strain in &mut strains {
            for (value, level) in strain.iter_mut().zip(&level) {
                *value += level * Complex64::new(normal(), normal()) * 0.5_f64.sqrt();
            }
        }
        Ok(Self {
            frequency_hz,
            strains,
            noise: vec![level; 3],
        })
    }

    /// By the first two gauges and the free end.
    fn estimate(&self) -> Ours<ModulusEstimate> {
        let section = |distance| EndSection {
            distance,
            quantity: Quantity::Strain,
        };
        let ratio = RatioOfSpectra::new(
            &[&self.strains[0]],
            &[&self.strains[1]],
            &self.noise[0],
            &self.noise[1],
        )?;
        Ok(
            FreeEnd::new(ROD, section(DISTANCES[0]), section(DISTANCES[1]))?
                .with_limits(cmod::validity::AcceptanceLimits::ONE_DIMENSIONAL)?
                .estimate(&self.frequency_hz, &ratio.ratio, &ratio.variance)?,
        )
    }

    fn free_end_null(&self, level: f64) -> Ours<CheckOutcome> {
        let mut gamma = vec![Complex64::new(f64::NAN, 0.0); self.frequency_hz.len()];
        for line in self.estimate()?.lines() {
            gamma[line.index] = line.propagation_coefficient;
        }
        let spectra = GaugeSpectra {
            frequency_hz: &self.frequency_hz,
            tests: &[&self.strains],
            noise: &self.noise,
        };
        let null = FreeEndNull::new(ROD, DISTANCES.to_vec(), Quantity::Strain)?;
        Ok(null.check(&spectra, &gamma, level)?)
    }
}
