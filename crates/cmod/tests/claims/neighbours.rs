//! Free end, separate pulses, one gauge, resonances: the rod of Test 3 of paper A with an accelerometer on its end, by the chain.

use std::f64::consts::{FRAC_PI_4, TAU};

use cmod::estimate::ModulusEstimate;
use cmod::multi_point::Quantity;
use cmod::validity::AcceptanceLimits;
use cmod::{
    EndSection, FreeEnd, OneGauge, PulsedRod, Resonances, RodWithFreeEnd, SeparatePulses, Specimen,
    TwoPoint,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rodwave::chain::{Chain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use testbed::claim::{Claims, Ours, Within, of};
use testbed::difference::largest;
use testbed::hold;

const LENGTH: f64 = 0.801;
const DIAMETER: f64 = 0.0106;
const DENSITY: f64 = 903.0;
const END_MASS: f64 = 2.9e-3;
/// Of one gauge from the free end.
const GAUGE: f64 = 0.3;

const ROD: RodWithFreeEnd = RodWithFreeEnd {
    diameter: DIAMETER,
    density: DENSITY,
    end_mass: END_MASS,
};

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    let rod = VirtualRod::new();
    without_noise(claims, &rod);
    errors(claims, &rod);
    hold!(claims);
}

struct VirtualRod {
    medium: Medium<ConstantQ>,
    chain: Chain,
}

impl VirtualRod {
    fn new() -> Ours<Self> {
        let medium = Medium::new(DENSITY, ConstantQ::new(2.6e9, 0.07, TAU * 1e3)?)?;
        let chain = Chain::from_impact_face()
            .rod(&medium, Circle::of_diameter(DIAMETER)?, LENGTH)
            .end(Termination::Mass(END_MASS))?;
        Ok(Self { medium, chain })
    }

    /// What is measured there for a blow of 1 N s, strains exactly.
    fn at(&self, section: EndSection, f: f64) -> Ours<Complex64> {
        let omega = TAU * f;
        let position = LENGTH - section.distance;
        let state = self.chain.section(0, position)?.state(omega)?;
        let s = Complex64::new(0.0, omega);
        Ok(match section.quantity {
            Quantity::Strain => {
                state.normal_force / (self.medium.modulus(omega) * FRAC_PI_4 * DIAMETER.powi(2))
            }
            Quantity::Displacement => state.velocity / s,
            Quantity::Velocity => state.velocity,
            _ => state.velocity * s,
        })
    }

    /// Normal forces of the waves towards the free end and back.
    fn waves(&self, distance: f64, f: f64) -> Ours<[Complex64; 2]> {
        let waves = self.chain.section(0, LENGTH - distance)?.waves(TAU * f)?;
        Ok([waves.forward_at(0.0), waves.backward_at(0.0)])
    }

    fn ratio(&self, first: EndSection, second: EndSection, lines: &[f64]) -> Ours<Vec<Complex64>> {
        let ratio = |f: &f64| Ok(self.at(first, *f)? / self.at(second, *f)?);
        lines.iter().map(ratio).collect()
    }

    /// Largest error by the amplification of each line.
    fn worst(&self, estimate: &ModulusEstimate, lines: usize) -> f64 {
        if estimate.lines().len() != lines {
            return f64::INFINITY;
        }
        largest(estimate.lines().iter().map(|line| {
            let exact = self.medium.modulus(TAU * line.frequency_hz);
            (line.modulus - exact).norm() / exact.norm() / (1.0 + line.error_amplification)
        }))
    }
}

const fn at(distance: f64, quantity: Quantity) -> EndSection {
    EndSection { distance, quantity }
}

fn lines(count: u32, step: f64) -> Vec<f64> {
    (1..=count).map(|j| step * f64::from(j)).collect()
}

fn without_noise(claims: &mut Claims, rod: &Ours<VirtualRod>) {
    use Quantity::{Acceleration, Displacement, Strain, Velocity};

    let frequency_hz = lines(300, 50.0);
    let none = vec![0.0; 300];
    let within = Within(
        1e-12,
        "rounding of the chain, by the amplification of the line",
    );
    claims.by("cosh or sinh of gamma d at two sections before a free end with a mass");
    for (name, first, second) in [
        ("two strains", at(0.5, Strain), at(0.25, Strain)),
        (
            "accelerations of both ends",
            at(LENGTH, Acceleration),
            at(0.0, Acceleration),
        ),
        ("two velocities", at(0.6, Velocity), at(0.1, Velocity)),
        (
            "displacement by acceleration",
            at(0.4, Displacement),
            at(0.0, Acceleration),
        ),
        (
            "strain by acceleration",
            at(0.35, Strain),
            at(0.0, Acceleration),
        ),
    ] {
        let found = || -> Ours {
            let rod = rod.as_ref().map_err(Clone::clone)?;
            let ratio = rod.ratio(first, second, &frequency_hz)?;
            let estimate = FreeEnd::new(ROD, first, second)?
                .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
                .estimate(&frequency_hz, &ratio, &none)?;
            Ok(rod.worst(&estimate, 300))
        };
        claims.deviation(
            format!("free end, {name}: modulus, 50 Hz to 15 kHz, by the amplification"),
            within,
            found(),
        );
    }
    claims.by("reflected over incident wave, exp(-2 gamma d) times that of the mass");
    let one_gauge = || -> Ours {
        let rod = rod.as_ref().map_err(Clone::clone)?;
        let ratio = frequency_hz
            .iter()
            .map(|f| {
                rod.waves(GAUGE, *f)
                    .map(|[incident, reflected]| reflected / incident)
            })
            .collect::<Ours<Vec<_>>>()?;
        let estimate = OneGauge::new(ROD, at(GAUGE, Strain))?
            .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
            .estimate(&frequency_hz, &ratio, &none)?;
        Ok(rod.worst(&estimate, 300))
    };
    claims.deviation(
        "one gauge: modulus, 50 Hz to 15 kHz, by the amplification",
        within,
        one_gauge(),
    );
    claims.by("exp(-gamma d) between two sections");
    let pulses = || -> Ours {
        let rod = rod.as_ref().map_err(Clone::clone)?;
        let ratio = frequency_hz
            .iter()
            .map(|f| Ok(rod.waves(0.2, *f)?[0] / rod.waves(0.6, *f)?[0]))
            .collect::<Ours<Vec<_>>>()?;
        let estimate = SeparatePulses::new(PulsedRod {
            distance: 0.4,
            diameter: DIAMETER,
            density: DENSITY,
        })?
        .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
        .estimate(&frequency_hz, &ratio, &none)?;
        Ok(rod.worst(&estimate, 300))
    };
    claims.deviation(
        "separate pulses: modulus, 50 Hz to 15 kHz, by the amplification",
        within,
        pulses(),
    );
    claims.by("the two-point method is the free end with d_1 = L, d_2 = 0");
    let same = || -> Ours {
        let rod = rod.as_ref().map_err(Clone::clone)?;
        let ends = [at(LENGTH, Acceleration), at(0.0, Acceleration)];
        let ratio = rod.ratio(ends[0], ends[1], &frequency_hz)?;
        let variance: Vec<f64> = ratio.iter().map(|ratio| 1e-6 * ratio.norm_sqr()).collect();
        let free_end = FreeEnd::new(ROD, ends[0], ends[1])?
            .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
            .estimate(&frequency_hz, &ratio, &variance)?;
        let two_point = TwoPoint::new(Specimen {
            length: LENGTH,
            diameter: DIAMETER,
            density: DENSITY,
            accelerometer_mass: END_MASS,
        })?
        .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
        .estimate(&frequency_hz, &ratio, &variance)?;
        let pairs = free_end.lines().iter().zip(two_point.lines());
        Ok(largest(pairs.map(|(one, other)| {
            (one.standard_error.loss_modulus / other.standard_error.loss_modulus - 1.0).abs()
        })))
    };
    claims.deviation(
        "standard error of E'' by the free end and by the two-point method",
        Within(1e-9, "two iterations on the same numbers, amplified"),
        same(),
    );
    claims.by("resonances: the real part of the ratio of the ends changes its sign");
    let dense = lines(1500, 5.0);
    let resonances = || -> Ours<[f64; 3]> {
        let rod = rod.as_ref().map_err(Clone::clone)?;
        let ratio = rod.ratio(at(LENGTH, Acceleration), at(0.0, Acceleration), &dense)?;
        let estimate = Resonances::new(ROD, LENGTH)?
            .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
            .estimate(&dense, &ratio, &[0.0; 1500])?;
        let changes = ratio
            .windows(2)
            .filter(|pair| pair[0].re * pair[1].re < 0.0);
        let worst = largest((1..).zip(estimate.lines()).map(|(n, line)| {
            let exact = rod.medium.modulus(TAU * line.frequency_hz);
            f64::from(n) * (line.modulus - exact).norm() / exact.norm()
        }));
        Ok([estimate.lines().len() as f64, changes.count() as f64, worst])
    };
    let resonances = resonances();
    claims.claim(
        "resonances up to 7.5 kHz that are found, of those that the chain has",
        "1",
        1.0,
        Within(1e-6, "a count"),
        of(&resonances, |found| found[0] / found[1]),
    );
    claims.deviation(
        "modulus at the n-th resonance, n times the error",
        Within(
            6e-5,
            "a polynomial of third degree over 0.3 rad, 0.3^4/192, and the mass",
        ),
        of(&resonances, |found| found[2]),
    );
}

fn errors(claims: &mut Claims, rod: &Ours<VirtualRod>) {
    let frequency_hz = [900.0, 1700.0, 3100.0, 5200.0, 8800.0];
    let relative = 3e-3_f64;
    claims.by("variance of gamma by variance of H over (2 d H)^2");
    let closed = || -> Ours {
        let rod = rod.as_ref().map_err(Clone::clone)?;
        let (ratio, variance) = reflected(rod, &frequency_hz, relative)?;
        let massless = RodWithFreeEnd {
            end_mass: 0.0,
            ..ROD
        };
        let estimate = OneGauge::new(massless, at(GAUGE, Quantity::Strain))?
            .with_wave_speed(1700.0)?
            .with_limits(AcceptanceLimits::NONE)?
            .estimate(&frequency_hz, &ratio, &variance)?;
        Ok(largest(estimate.lines().iter().map(|line| {
            let h = ratio[line.index].norm();
            let expected = (0.5 * variance[line.index]).sqrt() / (2.0 * GAUGE * h);
            (line.standard_error.damping_coefficient / expected - 1.0).abs()
        })))
    };
    claims.deviation(
        "one gauge before a free end: standard error of the damping coefficient",
        Within(1e-10, "rounding of a logarithm"),
        closed(),
    );
    claims.by("1500 draws of noise of 0.3 %, five lines");
    let drawn = || -> Ours<f64> {
        let rod = rod.as_ref().map_err(Clone::clone)?;
        let (ratio, variance) = reflected(rod, &frequency_hz, relative)?;
        let method = OneGauge::new(ROD, at(GAUGE, Quantity::Strain))?
            .with_wave_speed(1700.0)?
            .with_limits(AcceptanceLimits::NONE)?;
        let mut random = ChaCha8Rng::seed_from_u64(1988);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut sums = [[0.0; 2]; 5];
        for _ in 0..1500 {
            let noisy: Vec<Complex64> = ratio
                .iter()
                .zip(&variance)
                .map(|(h, variance)| {
                    h + Complex64::new(normal(), normal()) * (0.5 * variance).sqrt()
                })
                .collect();
            let estimate = method.estimate(&frequency_hz, &noisy, &variance)?;
            for (line, sums) in estimate.lines().iter().zip(&mut sums) {
                let exact = rod.medium.modulus(TAU * line.frequency_hz);
                sums[0] += (line.modulus.im - exact.im).powi(2);
                sums[1] += line.standard_error.loss_modulus.powi(2);
            }
        }
        Ok(largest(sums.iter().map(|[found, stated]| {
            ((found / stated).sqrt() - 1.0).abs()
        })))
    };
    claims.deviation(
        "one gauge with a mass: scatter of E'' over its standard error, worst of five lines",
        Within(0.073, "four of 1/sqrt(3000)"),
        drawn(),
    );
}

/// Reflected over incident wave, and the variance of so much noise.
fn reflected(
    rod: &VirtualRod,
    frequency_hz: &[f64],
    relative: f64,
) -> Ours<(Vec<Complex64>, Vec<f64>)> {
    let ratio = frequency_hz
        .iter()
        .map(|f| {
            rod.waves(GAUGE, *f)
                .map(|[incident, reflected]| reflected / incident)
        })
        .collect::<Ours<Vec<_>>>()?;
    let variance = ratio
        .iter()
        .map(|h| (relative * h.norm()).powi(2))
        .collect();
    Ok((ratio, variance))
}
