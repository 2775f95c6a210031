//! Named sources of errors that are common to all times of a result.

use std::fmt;

use super::bar::{BarMaterial, HopkinsonBar, Known};
use super::specimen::TestSpecimen;

/// One of the two bars.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The bar of the incident and the reflected wave.
    Incident,
    /// The bar of the transmitted wave.
    Transmitted,
}

impl Side {
    /// Both bars, in the order of the arrays.
    pub const BOTH: [Self; 2] = [Self::Incident, Self::Transmitted];

    pub(super) fn index(self) -> usize {
        match self {
            Self::Incident => 0,
            Self::Transmitted => 1,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Incident => "incident bar",
            Self::Transmitted => "transmitted bar",
        })
    }
}

/// A source of an error that is common to all times.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Source {
    /// Gauge factor, bridge and amplifier of a gauge; gauges are counted from 0.
    GaugeFactor(Side, usize),
    /// Distance of a gauge from the specimen.
    GaugePosition(Side, usize),
    /// Time of the record of a gauge relative to the others.
    Delay(Side, usize),
    /// Diameter of a bar.
    Diameter(Side),
    /// Length of a bar, where its free end is used.
    BarLength(Side),
    /// Poisson's ratio of a bar.
    PoissonRatio(Side),
    /// A property of the materials, by the name of its variation.
    Material(String),
    /// Incident wave after the end of its window, which is neglected: its mean at that end is the
    /// standard uncertainty.
    Tail,
    /// Part of the incident wave, or a shifted level, in the window of the reflected wave; the
    /// standard uncertainty is that of the tail.
    LevelOfReflected,
    /// Part of the records above the end of the band, up to twice its frequency, where it exceeds
    /// the noise.
    AboveBand,
    /// Length of the specimen.
    SpecimenLength,
    /// Diameter of the specimen.
    SpecimenDiameter,
    /// Thickness of the wall of the specimen.
    SpecimenWall,
}

impl Source {
    /// Returns true if the error of this source differs between shots with the same bars. The tail
    /// of a pulse comes from the striker, which all shots share.
    #[must_use]
    pub fn is_of_one_shot(&self) -> bool {
        matches!(
            self,
            Self::SpecimenLength | Self::SpecimenDiameter | Self::SpecimenWall
        )
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::GaugeFactor(side, gauge) => {
                write!(f, "gauge factor, {side}, gauge {}", gauge + 1)
            }
            Self::GaugePosition(side, gauge) => {
                write!(f, "gauge position, {side}, gauge {}", gauge + 1)
            }
            Self::Delay(side, gauge) => write!(f, "delay, {side}, gauge {}", gauge + 1),
            Self::Diameter(side) => write!(f, "diameter of the {side}"),
            Self::BarLength(side) => write!(f, "length of the {side}"),
            Self::PoissonRatio(side) => write!(f, "Poisson's ratio of the {side}"),
            Self::Material(name) => f.write_str(name),
            Self::Tail => f.write_str("tail of the incident wave"),
            Self::LevelOfReflected => f.write_str("level under the reflected wave"),
            Self::AboveBand => f.write_str("part of the waves above the band"),
            Self::SpecimenLength => f.write_str("specimen length"),
            Self::SpecimenDiameter => f.write_str("specimen diameter"),
            Self::SpecimenWall => f.write_str("specimen wall"),
        }
    }
}

/// An uncertain property of materials, given by the materials of both bars one standard uncertainty
/// above and below it; `None` for a bar of another material.
#[derive(Debug, Clone)]
pub struct MaterialVariation {
    /// Name, such as `wave speed of steel`.
    pub name: String,
    /// Materials of the two bars one standard uncertainty above.
    pub above: [Option<BarMaterial>; 2],
    /// Materials of the two bars one standard uncertainty below.
    pub below: [Option<BarMaterial>; 2],
}

/// Values of a test that its sources vary.
#[derive(Debug, Clone)]
pub(super) struct Setup {
    pub(super) bars: [HopkinsonBar; 2],
    pub(super) specimen: TestSpecimen,
    /// Factor and delay of each gauge of each bar.
    gauges: [Vec<(f64, f64)>; 2],
    /// Strain of the incident wave after its window.
    pub(super) tail: f64,
    /// Strain in the window of the reflected wave that does not belong to this wave.
    pub(super) level: f64,
    tail_uncertainty: f64,
}

impl Setup {
    /// Creates the values of a test whose incident wave ends its window with a strain of `tail`.
    pub(super) fn new(bars: &[HopkinsonBar; 2], specimen: TestSpecimen, tail: f64) -> Self {
        let plain = |bar: &HopkinsonBar| vec![(1.0, 0.0); bar.gauges.len()];
        Self {
            gauges: [plain(&bars[0]), plain(&bars[1])],
            bars: bars.clone(),
            specimen,
            tail: 0.0,
            level: 0.0,
            tail_uncertainty: tail,
        }
    }

    /// Returns factor and delay \[s\] of a gauge.
    pub(super) fn of_gauge(&self, bar: usize, gauge: usize) -> (f64, f64) {
        let of_bar = self.gauges.get(bar);
        let found = of_bar.and_then(|gauges| gauges.get(gauge));
        found.copied().unwrap_or((1.0, 0.0))
    }

    /// Subtracts `lag` \[s\] from the times of the gauges of the transmitted bar.
    pub(super) fn advance_transmitted(&mut self, lag: f64) {
        for (_, delay) in &mut self.gauges[1] {
            *delay += lag;
        }
    }

    pub(super) fn sources(&self, variations: &[MaterialVariation]) -> Vec<Source> {
        let mut found = Vec::new();
        let mut add = |source: Source, uncertainty: f64| {
            if uncertainty > 0.0 {
                found.push(source);
            }
        };
        for side in Side::BOTH {
            let Some(bar) = self.bars.get(side.index()) else {
                continue;
            };
            for (at, gauge) in bar.gauges.iter().enumerate() {
                add(Source::GaugeFactor(side, at), gauge.factor_uncertainty);
                let position = gauge.distance.standard_uncertainty;
                add(Source::GaugePosition(side, at), position);
                add(Source::Delay(side, at), gauge.delay_uncertainty);
            }
            add(Source::Diameter(side), bar.diameter.standard_uncertainty);
            add(Source::BarLength(side), bar.length.standard_uncertainty);
            if let Some(ratio) = bar.poisson_ratio {
                add(Source::PoissonRatio(side), ratio.standard_uncertainty);
            }
        }
        let specimen = &self.specimen;
        add(Source::SpecimenLength, specimen.length.standard_uncertainty);
        let diameter = specimen.diameter.standard_uncertainty;
        add(Source::SpecimenDiameter, diameter);
        let wall = specimen.wall.map_or(0.0, |wall| wall.standard_uncertainty);
        add(Source::SpecimenWall, wall);
        add(Source::Tail, self.tail_uncertainty.abs());
        add(Source::LevelOfReflected, self.tail_uncertainty.abs());
        for variation in variations {
            found.push(Source::Material(variation.name.clone()));
        }
        found
    }

    /// Returns the values with one `source` moved by `standard` standard uncertainties.
    pub(super) fn moved(
        &self,
        source: &Source,
        standard: f64,
        variations: &[MaterialVariation],
    ) -> Self {
        let mut moved = self.clone();
        let move_known = |known: &mut Known| known.value = known.moved(standard);
        match source {
            Source::GaugeFactor(side, at)
            | Source::GaugePosition(side, at)
            | Source::Delay(side, at) => {
                let bar = moved.bars.get_mut(side.index());
                let gauge = bar.and_then(|bar| bar.gauges.get_mut(*at));
                let reading = moved.gauges.get_mut(side.index());
                let reading = reading.and_then(|gauges| gauges.get_mut(*at));
                if let (Some(gauge), Some(reading)) = (gauge, reading) {
                    match source {
                        Source::GaugeFactor(..) => {
                            reading.0 *= 1.0 + standard * gauge.factor_uncertainty;
                        }
                        Source::Delay(..) => reading.1 += standard * gauge.delay_uncertainty,
                        _ => move_known(&mut gauge.distance),
                    }
                }
            }
            Source::Diameter(side) | Source::BarLength(side) | Source::PoissonRatio(side) => {
                if let Some(bar) = moved.bars.get_mut(side.index()) {
                    match (source, &mut bar.poisson_ratio) {
                        (Source::Diameter(_), _) => move_known(&mut bar.diameter),
                        (Source::BarLength(_), _) => move_known(&mut bar.length),
                        (_, Some(ratio)) => move_known(ratio),
                        (_, None) => {}
                    }
                }
            }
            Source::Material(name) => {
                if let Some(variation) = variations.iter().find(|v| v.name == *name) {
                    let materials = if standard > 0.0 {
                        &variation.above
                    } else {
                        &variation.below
                    };
                    for (bar, material) in moved.bars.iter_mut().zip(materials) {
                        if let Some(material) = material {
                            bar.material = material.clone();
                        }
                    }
                }
            }
            Source::Tail => moved.tail = standard * self.tail_uncertainty,
            Source::LevelOfReflected => moved.level = standard * self.tail_uncertainty,
            // this source acts on the histories, not on a value of the test
            Source::AboveBand => {}
            Source::SpecimenLength => move_known(&mut moved.specimen.length),
            Source::SpecimenDiameter => move_known(&mut moved.specimen.diameter),
            Source::SpecimenWall => {
                if let Some(wall) = &mut moved.specimen.wall {
                    move_known(wall);
                }
            }
        }
        moved
    }
}
