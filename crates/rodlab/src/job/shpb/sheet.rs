//! Sheet of the job `shpb`.

use impulse::hopkinson::{Loading, StressFrom, WaveSeparation};
use serde::Deserialize;

use crate::bodies::material_sheet::Materials;
use crate::job::About;
use crate::outcome::Setting;
use crate::records::Records;
use crate::sheet::{Density, Duration, Exact, Frequency, Length, PoissonRatio, Stated, Velocity};

/// Sheet of the job `shpb`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShpbSheet {
    /// Title of the test.
    pub title: String,
    /// Persons, place, date and object of the test.
    #[serde(default)]
    pub about: About,
    /// Loading of the specimen.
    pub loading: Loading,
    /// Materials of the bars, by name; for torsion the modulus of a law is the shear modulus.
    #[serde(default)]
    pub materials: Materials,
    /// The bars.
    pub bars: BarsSheet,
    /// The specimen.
    pub specimen: ShpbSpecimenSheet,
    /// Files and channels of the shot, all sampled together. If each channel has its own file,
    /// there are several entries.
    pub records: Vec<Records>,
    /// Further shots with the same bars on specimens of the same kind; the result is the mean of
    /// all shots at equal strain.
    #[serde(default)]
    pub further_shots: Vec<FurtherShotSheet>,
    /// Silence at the beginning of the record, before any pulse, such as `"90 us"`; the level at
    /// rest and the noise are measured in it.
    pub silent: Exact<Duration>,
    /// Forces from which the stress is computed; by default both.
    #[serde(default)]
    pub stress_from: StressFrom,
    /// End of the band, at which the amplitude is one half, such as `"50 kHz"`. By default this
    /// frequency is at most the highest frequency at which the laws of the bars were measured, and
    /// 1.25 times this frequency is at most the least of three frequencies: a third of the sampling
    /// rate, the frequency at which the wavelength is two diameters, and the frequency above which
    /// the correction of attenuation amplifies a wave more than tenfold on its way back to the
    /// specimen.
    pub band: Option<Exact<Frequency>>,
    /// Removes the lag between the arrivals at the two faces by a shift of the transmitted bar,
    /// instead of relying on positions and wave speeds.
    #[serde(default)]
    pub align_arrivals: bool,
    /// Number of Monte Carlo draws, such as 1000, of the noise and all error sources together; they
    /// check the linear errors.
    pub monte_carlo: Option<usize>,
}

/// The two bars.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BarsSheet {
    /// The bar that is struck.
    pub incident: BarSheet,
    /// The other bar.
    pub transmitted: BarSheet,
}

/// A bar.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BarSheet {
    /// Waves of the bar.
    pub waves: WavesSheet,
    /// Diameter, such as `"20 mm ± 0.02 mm"`.
    pub diameter: Stated<Length>,
    /// Length, such as `"1800 mm"`; an uncertainty is accepted only if the separation uses the free
    /// end.
    pub length: Stated<Length>,
    /// Poisson's ratio, such as `"0.29 ± 0.01"`, for lateral inertia by Pochhammer and Chree;
    /// without it, the waves are one-dimensional.
    pub poisson_ratio: Option<Stated<PoissonRatio>>,
    /// One gauge, or two.
    pub gauges: Vec<ShpbGaugeSheet>,
    /// Separation of the waves: by default `Passages` for one gauge, `TwoGauges` for two.
    pub separation: Option<WaveSeparationSheet>,
}

/// Waves of a bar.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum WavesSheet {
    /// Name of the material.
    Material(String),
    /// Wave speed of an elastic bar.
    Speed {
        /// Density, such as `"7800 kg/m3 ± 0.2 %"`.
        density: Stated<Density>,
        /// Speed of long waves, such as `"5172 m/s ± 10 m/s"`.
        wave_speed: Stated<Velocity>,
    },
}

/// A gauge of a bar.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShpbGaugeSheet {
    /// Channel with the strain of the gauge.
    pub channel: String,
    /// Channels of other gauges around the same section, such as the gauge on the opposite side.
    /// The mean of all these gauges is used, in which bending cancels.
    #[serde(default)]
    pub averaged_with: Vec<String>,
    /// Distance from the specimen, such as `"700 mm ± 1 mm"`.
    pub at: Stated<Length>,
}

/// Separation of the waves of a bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum WaveSeparationSheet {
    /// The pulses pass the gauge one after the other.
    Passages,
    /// Two gauges.
    TwoGauges,
    /// One gauge before the free end, on the transmitted bar.
    FreeEnd,
    /// One gauge on the incident bar. The force at the specimen is assumed to be equal to that of
    /// the transmitted bar.
    Balanced,
}

/// The specimen.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShpbSpecimenSheet {
    /// Length, such as `"6 mm ± 0.02 mm"`.
    pub length: Stated<Length>,
    /// Diameter; for a tube the outer diameter.
    pub diameter: Stated<Length>,
    /// Thickness of the wall of a tube in torsion.
    pub wall: Option<Stated<Length>>,
}

/// A further shot.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FurtherShotSheet {
    /// Files and channels, with the same channel names as in the first shot.
    pub records: Vec<Records>,
    /// Specimen of this shot; by default the dimensions of the first specimen.
    pub specimen: Option<ShpbSpecimenSheet>,
}

impl ShpbGaugeSheet {
    pub(super) fn channels(&self) -> impl Iterator<Item = &String> {
        std::iter::once(&self.channel).chain(&self.averaged_with)
    }
}

impl BarSheet {
    pub(super) fn separation(&self) -> WaveSeparation {
        match self.separation {
            Some(WaveSeparationSheet::Passages) => WaveSeparation::Windows,
            Some(WaveSeparationSheet::TwoGauges) => WaveSeparation::TwoGauges,
            Some(WaveSeparationSheet::FreeEnd) => WaveSeparation::FreeEnd,
            Some(WaveSeparationSheet::Balanced) => WaveSeparation::Balanced,
            None if self.gauges.len() == 2 => WaveSeparation::TwoGauges,
            None => WaveSeparation::Windows,
        }
    }
}

impl ShpbSheet {
    pub(super) fn shots(&self) -> impl Iterator<Item = (String, &[Records], &ShpbSpecimenSheet)> {
        let first = (
            "records".to_owned(),
            self.records.as_slice(),
            &self.specimen,
        );
        let further = self.further_shots.iter().enumerate().map(|(at, shot)| {
            let specimen = shot.specimen.as_ref().unwrap_or(&self.specimen);
            let field = format!("further_shots[{at}].records");
            (field, shot.records.as_slice(), specimen)
        });
        std::iter::once(first).chain(further)
    }

    /// Returns the defaults of optional fields.
    pub(super) fn defaults(&self) -> Vec<Setting> {
        let mut defaults = Vec::new();
        let sides = [
            ("incident", &self.bars.incident),
            ("transmitted", &self.bars.transmitted),
        ];
        for (side, bar) in sides {
            let mut open = |name: &str, value: String| {
                let name = format!("bars.{side}.{name}");
                defaults.push(Setting::by_default(name, value));
            };
            let none = "not stated: one-dimensional waves".to_owned();
            open("poisson_ratio", none);
            open("separation", format!("{:?}", bar.separation()));
        }
        for at in 0..self.further_shots.len() {
            let name = format!("further_shots[{at}].specimen");
            defaults.push(Setting::by_default(name, "that of the first shot"));
        }
        defaults.push(Setting::by_default(
            "stress_from",
            format!("{:?}", self.stress_from),
        ));
        defaults.push(Setting::by_default("align_arrivals", self.align_arrivals));
        defaults.push(Setting::by_default("band", "chosen for the bars"));
        defaults.push(Setting::by_default("monte_carlo", "none"));
        defaults
    }
}
