//! Kernels of rods: a march in time, a response with its derivatives, the interpolation of a
//! history, the mobility of a chain, and a contact.

use std::hint::black_box;

use impulse::{ContactLaw, Impact, MobilityLaw};
use num_complex::Complex64;
use rodwave::band_limited::SampledHistory;
use rodwave::element::Circle;
use rodwave::inelastic::{MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use rodwave::{Chain, DirectProblem, InelasticRod, Termination};

use super::Kernel;

pub(super) const GUREVICH_MARCH: Kernel = Kernel {
    name: "gurevich-march",
    what: "march of a Maxwell-Gurevich-Rabinovich rod, 400 cells, 1000 steps",
    of: "cell",
    count: 401_000,
    prepare: || {
        let law = MaxwellGurevichRabinovich::new(3.5e6, 7.08e6)?;
        let problem = DirectProblem::new(InelasticRod::new(0.394, 910.0, 2.58e9, law)?, 400)?;
        Ok(Box::new(move || {
            let mut march = problem.march(9.0);
            for _ in 0..1000 {
                march.advance(black_box(9.0));
            }
            black_box(march.free_end_velocity());
            Ok(())
        }))
    },
};

pub(super) const NORTON_DERIVATIVES: Kernel = Kernel {
    name: "norton-derivatives",
    what: "response of a Maxwell-Norton rod of 100 cells with its three derivatives, 144 samples",
    of: "sample",
    count: 144,
    prepare: || {
        let rate = 51_200.0;
        let samples: Vec<f64> = (0..160_u32)
            .map(|k| 9.0 * (-((f64::from(k) - 35.0) / 3.0).powi(2)).exp())
            .collect();
        let excitation = SampledHistory::new(&samples, rate)?;
        let times: Vec<f64> = (0..144_u32).map(|k| f64::from(k) / rate).collect();
        let rod = InelasticRod::new(0.394, 910.0, 2.58e9, MaxwellNorton::new(2.108, 7e13)?)?;
        let problem = DirectProblem::new(rod, 100)?;
        Ok(Box::new(move || {
            let response =
                problem.free_end_velocity_with_sensitivities(black_box(&excitation), &times)?;
            black_box(response);
            Ok(())
        }))
    },
};

pub(super) const HISTORY: Kernel = Kernel {
    name: "history-between-samples",
    what: "band-limited interpolation of an excitation of 1000 samples, prepared once",
    of: "sample",
    count: 1000,
    prepare: || {
        let samples: Vec<f64> = (0..1000_u32)
            .map(|k| 9.0 * (-((f64::from(k) - 35.0) / 3.0).powi(2)).exp())
            .collect();
        Ok(Box::new(move || {
            black_box(SampledHistory::new(black_box(&samples), 51_200.0)?);
            Ok(())
        }))
    },
};

pub(super) const CHAIN_MOBILITY: Kernel = Kernel {
    name: "chain-mobility",
    what: "mobility of sixteen rods and cones of constant loss at 512 frequencies",
    of: "element and frequency",
    count: 16 * 512,
    prepare: || {
        let nylon = Medium::new(1150.0, ConstantQ::new(2.6e9, 0.094, 18_850.0)?)?;
        let (thin, thick) = (Circle::of_diameter(0.02)?, Circle::of_diameter(0.03)?);
        let mut builder = Chain::from_impact_face();
        for _ in 0..8 {
            builder = builder
                .rod(&nylon, thin, 0.1)
                .cone(&nylon, thin, thick, 0.1);
        }
        let chain = builder.end(Termination::Free)?;
        Ok(Box::new(move || {
            let mut sum = Complex64::ZERO;
            for line in 1..=512_u32 {
                sum += chain.mobility(black_box(60.0 * f64::from(line)))?;
            }
            black_box(sum);
            Ok(())
        }))
    },
};

pub(super) const CONTACT_MARCH: Kernel = Kernel {
    name: "contact-march",
    what: "force between a mass and a long rod through a Hertzian contact, 10 000 steps, kernels made before",
    of: "step",
    count: 10_000,
    prepare: || {
        let striker = MobilityLaw::analytic(|s| 1.0 / (0.1 * s)).free(0.1)?;
        let rod = MobilityLaw::analytic(|_| Complex64::from(1e-3));
        let duration = 1e-3;
        let impact = Impact::between(&striker, &rod)
            .at_velocity(1.0)
            .through(ContactLaw::hertz(5e9)?)
            .in_steps_of(duration / 10_000.0)
            .discretised(duration)?;
        Ok(Box::new(move || {
            black_box(black_box(&impact).predict()?);
            Ok(())
        }))
    },
};
