//! Planned blows of a striker on other rods, and the sheets of their virtual tests.

use maxwellid::design::PlannedTest;
use maxwellid::{Law, MaxwellidError, RodTest};
use rodwave::InelasticRod;
use rodwave::band_limited::Recorder;
use rodwave::experiment::Acquisition;
use rodwave::impact::Striker;
use rodwave::inelastic::{Elastic, Eyring, InelasticLaw, MaxwellGurevichRabinovich, MaxwellNorton};

use super::choice::{Choice, StruckRod};
use super::{IdentifySheet, LeftLaw};

/// Number of samples of a planned record before the blow; it is twice the length over which the
/// filter of the recorder acts.
const BEFORE: usize = 48;

/// Ratio of the cut-off of a planned record to its sampling rate.
const CUTOFF: f64 = 0.3125;

/// Plans a test with the striker on another rod of the same material.
pub(super) fn planned(
    rod: &StruckRod<'_>,
    velocity: f64,
    leading: &LeftLaw<'_>,
    like: &RodTest,
) -> Result<PlannedTest, MaxwellidError> {
    let refused = |source| MaxwellidError::InTest {
        test: "a planned test".to_owned(),
        source,
    };
    let of_law = leading.parameters.get(1..).unwrap_or_default();
    let modulus = leading
        .parameters
        .first()
        .map_or(f64::NAN, |ln_modulus| ln_modulus.exp());
    let by = Blow {
        rod,
        velocity,
        modulus,
        like,
    };
    match leading.law {
        Law::Norton => {
            let norton = MaxwellNorton::from_reference_rate(2.0, 1.0, 10e6).map_err(refused)?;
            by.on(norton.with_parameters(of_law).map_err(refused)?)
        }
        Law::GurevichRabinovich => {
            let gurevich = MaxwellGurevichRabinovich::new(1e6, 1e7).map_err(refused)?;
            by.on(gurevich.with_parameters(of_law).map_err(refused)?)
        }
        Law::Eyring => {
            let eyring = Eyring::from_reference_rate(2.0, 1.0, 10e6).map_err(refused)?;
            by.on(eyring.with_parameters(of_law).map_err(refused)?)
        }
        // the law matters only between the struck end and the section of excitation, where the
        // other laws damp the wave little
        _ => by.on(Elastic),
    }
}

/// A blow on a rod; the type of its law is chosen by the caller of `on`.
struct Blow<'a> {
    rod: &'a StruckRod<'a>,
    velocity: f64,
    modulus: f64,
    /// Existing test whose instruments are assumed.
    like: &'a RodTest,
}

impl Blow<'_> {
    fn on<L: InelasticLaw>(&self, law: L) -> Result<PlannedTest, MaxwellidError> {
        let rate_hz = self.like.sampling_rate_hz();
        let length = self.rod.length.si();
        let rod = InelasticRod::new(length, self.like.density(), self.modulus, law).map_err(
            |source| MaxwellidError::InTest {
                test: "a planned test".to_owned(),
                source,
            },
        )?;
        let striker = self.rod.striker;
        let striker = Striker {
            length: striker.length.si(),
            diameter: striker.diameter.si(),
            density: striker.density.si(),
            modulus: striker.modulus.si(),
            velocity: self.velocity,
        };
        let acquisition = Acquisition {
            recorder: Recorder {
                rate_hz,
                cutoff_hz: CUTOFF * rate_hz,
            },
            samples_before: BEFORE,
            samples_after: self.like.response().len(),
            // larger than the displacement in any test
            transducer_range: 1e3,
        };
        let section = length - self.rod.gap.si();
        let diameter = self.rod.diameter.si();
        PlannedTest::of_striker(striker, rod, diameter, section, &acquisition)?
            .with_instruments_of(self.like)
    }
}

/// Returns the sheet of virtual tests like `best`; `None` if virtual tests do not offer the law, or
/// if `best` has no struck rod.
pub(super) fn plan(
    sheet: &IdentifySheet,
    best: &Choice<'_>,
    leading: &LeftLaw<'_>,
    like: &RodTest,
) -> Option<String> {
    let stated = leading.candidate.model().stated(leading.parameters);
    let value = |name: &str| {
        let mut stated = stated.iter();
        stated.find(|one| one.name == name).map(|one| one.value)
    };
    let law = match leading.law {
        Law::Elastic => "Elastic".to_owned(),
        Law::Norton => format!(
            "Norton(exponent: \"{}\", rate_at_10_mpa: \"{} 1/s\")",
            value("exponent")?,
            value("inelastic strain rate at 10 MPa")?
        ),
        Law::GurevichRabinovich => format!(
            "GurevichRabinovich(viscosity: \"{} Pa s\", activation_stress: \"{} Pa\")",
            value("viscosity")?,
            value("activation stress")?
        ),
        Law::Eyring => format!(
            "Eyring(activation_stress: \"{} Pa\", rate_at_10_mpa: \"{} 1/s\")",
            value("activation stress")?,
            value("inelastic strain rate at 10 MPa")?
        ),
        _ => return None,
    };
    let rod = best.rod.as_ref()?;
    let length = rod.length.si();
    let velocities = vec![format!("\"{} m/s\"", best.velocity.si()); best.repeats];
    let rate_hz = like.sampling_rate_hz();
    let samples = like.response().len() + BEFORE;
    let striker = rod.striker;
    let [excitation, response] = like.noise_deviations()?;
    Some(format!(
        r#"Simulate(
    title: {title:?},
    experiment: ImpactedRod(
        length: "{length} m", diameter: "{diameter}", density: "{density} kg/m3", modulus: "{modulus} Pa",
        law: {law},
        section_distance: "{section} m",
        striker: (length: "{s_length}", diameter: "{s_diameter}", density: "{s_density}", modulus: "{s_modulus}"),
        velocities: [{velocities}],
    ),
    instrument: (
        sampling_rate: "{rate_hz} Hz", length: "{duration} s", before: "{before} s",
        noise_of: {{"near end": "{excitation} m/s", "free end": "{response} m/s"}},
    ),
)
"#,
        title = format!("{}: planned test", sheet.title),
        diameter = rod.diameter,
        density = like.density(),
        modulus = value("Young's modulus")?,
        section = length - rod.gap.si(),
        s_length = striker.length,
        s_diameter = striker.diameter,
        s_density = striker.density,
        s_modulus = striker.modulus,
        velocities = velocities.join(", "),
        duration = samples as f64 / rate_hz,
        before = BEFORE as f64 / rate_hz,
    ))
}
