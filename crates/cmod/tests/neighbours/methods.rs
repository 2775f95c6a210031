//! Every method with its own data of one rod. An estimate is a function of the assumed description
//! of the rod.

use std::f64::consts::TAU;

use cmod::estimate::ModulusEstimate;
use cmod::multi_point::Quantity;
use cmod::validity::AcceptanceLimits;
use cmod::{
    CmodError, EndSection, FreeEnd, OneGauge, PulsedRod, Resonances, RodWithFreeEnd,
    SectionUncertainty, SeparatePulses,
};
use num_complex::Complex64;

use super::rod::{DENSITY, DIAMETER, LENGTH, VirtualRod, polypropylene};
use testbed::noise::Noise;

const END_MASS: f64 = 2.9e-3;
pub(crate) const UNCERTAINTY: SectionUncertainty = SectionUncertainty {
    distance: 5e-4,
    diameter: 3e-5,
    density: 3.0,
    end_mass: 1e-4,
};

/// Assumed description of the rod: distances from the free end, or between sections, and the rod
/// itself.
#[derive(Clone, Copy)]
pub(crate) struct Belief {
    moved: [f64; 2],
    rod: RodWithFreeEnd,
    uncertainty: SectionUncertainty,
    /// Assumed wave speed, for the count of waves.
    wave_speed: Option<f64>,
}

pub(crate) const RIGHT: Belief = Belief {
    moved: [0.0; 2],
    rod: RodWithFreeEnd {
        diameter: DIAMETER,
        density: DENSITY,
        end_mass: END_MASS,
    },
    uncertainty: UNCERTAINTY,
    wave_speed: Some(1700.0),
};

impl Belief {
    pub(crate) fn certain(wave_speed: Option<f64>) -> Self {
        Self {
            uncertainty: SectionUncertainty::default(),
            wave_speed,
            ..RIGHT
        }
    }

    /// Returns the limits; there are none for tests of the noise alone.
    fn limits(&self) -> AcceptanceLimits {
        if self.uncertainty == UNCERTAINTY {
            AcceptanceLimits::default()
        } else {
            AcceptanceLimits::NONE
        }
    }

    pub(crate) fn drawn(random: &mut Noise) -> Self {
        let mut draw = |uncertainty: f64| uncertainty * random.normal();
        Self {
            moved: [0, 1].map(|_| draw(UNCERTAINTY.distance)),
            rod: RodWithFreeEnd {
                diameter: DIAMETER + draw(UNCERTAINTY.diameter),
                density: DENSITY + draw(UNCERTAINTY.density),
                end_mass: END_MASS + draw(UNCERTAINTY.end_mass),
            },
            ..RIGHT
        }
    }
}

type Estimate = fn(&Belief, &[f64], &[Complex64], &[f64]) -> Result<ModulusEstimate, CmodError>;

pub(crate) struct Method {
    pub(crate) name: &'static str,
    /// Spectra of the numerator and of the denominator of the ratio.
    pub(crate) spectra: Vec<[Complex64; 2]>,
    estimate: Estimate,
    frequency_hz: Vec<f64>,
}

impl Method {
    pub(crate) fn estimate(
        &self,
        belief: &Belief,
        ratio: &[Complex64],
        variance: &[f64],
    ) -> ModulusEstimate {
        (self.estimate)(belief, &self.frequency_hz, ratio, variance).unwrap()
    }

    pub(crate) fn without_noise(&self, belief: &Belief) -> ModulusEstimate {
        let ratio: Vec<Complex64> = self.spectra.iter().map(|[n, d]| n / d).collect();
        self.estimate(belief, &ratio, &vec![0.0; ratio.len()])
    }
}

fn section(distance: f64, quantity: Quantity) -> EndSection {
    EndSection { distance, quantity }
}

/// Returns the methods: free end, one gauge and separate pulses.
pub(crate) fn methods(frequency_hz: &[f64]) -> [Method; 3] {
    use Quantity::Strain;

    let rod = VirtualRod::new(&polypropylene(), END_MASS);
    let of = |name, pair: &dyn Fn(f64) -> [Complex64; 2], estimate: Estimate| Method {
        name,
        spectra: frequency_hz.iter().map(|f| pair(TAU * f)).collect(),
        estimate,
        frequency_hz: frequency_hz.to_vec(),
    };
    [
        of(
            "free end",
            &|w| [0.5, 0.22].map(|distance| rod.at(section(distance, Strain), w)),
            |b, f, ratio, variance| {
                let sections = [0.5 + b.moved[0], 0.22 + b.moved[1]].map(|d| section(d, Strain));
                let mut method = FreeEnd::new(b.rod, sections[0], sections[1])?
                    .with_limits(b.limits())?
                    .with_uncertainty(b.uncertainty)?;
                if let Some(speed) = b.wave_speed {
                    method = method.with_wave_speed(speed)?;
                }
                method.estimate(f, ratio, variance)
            },
        ),
        of(
            "one gauge",
            &|w| {
                let [incident, reflected] = rod.waves(0.3, w);
                [reflected, incident]
            },
            |b, f, ratio, variance| {
                let mut method = OneGauge::new(b.rod, section(0.3 + b.moved[0], Strain))?
                    .with_limits(b.limits())?
                    .with_uncertainty(b.uncertainty)?;
                if let Some(speed) = b.wave_speed {
                    method = method.with_wave_speed(speed)?;
                }
                method.estimate(f, ratio, variance)
            },
        ),
        of(
            "pulses",
            &|w| [0.2, 0.6].map(|distance| rod.waves(distance, w)[0]),
            |b, f, ratio, variance| {
                let mut method = SeparatePulses::new(PulsedRod {
                    distance: 0.4 + b.moved[0],
                    diameter: b.rod.diameter,
                    density: b.rod.density,
                })?
                .with_limits(b.limits())?
                .with_uncertainty(b.uncertainty)?;
                if let Some(speed) = b.wave_speed {
                    method = method.with_wave_speed(speed)?;
                }
                method.estimate(f, ratio, variance)
            },
        ),
    ]
}

pub(crate) fn resonances(frequency_hz: Vec<f64>) -> Method {
    let rod = VirtualRod::new(&polypropylene(), END_MASS);
    let ends = [LENGTH, 0.0].map(|distance| section(distance, Quantity::Acceleration));
    let pair = |f: &f64| ends.map(|end| rod.at(end, TAU * f));
    Method {
        name: "resonances",
        spectra: frequency_hz.iter().map(pair).collect(),
        estimate: |b, f, ratio, variance| {
            Resonances::new(b.rod, LENGTH + b.moved[0])?
                .with_uncertainty(b.uncertainty)?
                .estimate(f, ratio, variance)
        },
        frequency_hz,
    }
}
