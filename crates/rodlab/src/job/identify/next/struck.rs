//! Planned impacts of a striker on other rods, and the sheets of their virtual tests.

use maxwellid::design::PlannedTest;
use maxwellid::{MaxwellidError, RodTest};
use rodwave::InelasticRod;
use rodwave::band_limited::Recorder;
use rodwave::experiment::Acquisition;
use rodwave::inelastic::InelasticLaw;

use super::choice::{Choice, StruckRod};
use super::{IdentifySheet, LeftLaw};
use crate::job::simulate::inelastic_law::{self, LawVisitor};

/// Number of samples of a planned record before the impact; it is twice the length over which the
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
    inelastic_law::planned(leading.law, of_law, by).map_err(refused)?
}

/// An impact of a striker on a rod with any law.
struct Blow<'a> {
    rod: &'a StruckRod<'a>,
    velocity: f64,
    modulus: f64,
    /// Existing test whose instruments are assumed.
    like: &'a RodTest,
}

impl LawVisitor for Blow<'_> {
    type Result = Result<PlannedTest, MaxwellidError>;

    fn on<L: InelasticLaw>(self, law: L) -> Self::Result {
        let rate_hz = self.like.sampling_rate_hz();
        let length = self.rod.length.si();
        let rod = InelasticRod::new(length, self.like.density(), self.modulus, law).map_err(
            |source| MaxwellidError::InTest {
                test: "a planned test".to_owned(),
                source,
            },
        )?;
        let striker = self.rod.striker.at(self.velocity);
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
    let law = inelastic_law::in_ron(leading.law, value)?;
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
