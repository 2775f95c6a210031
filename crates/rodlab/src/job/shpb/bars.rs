//! Test of a sheet: bars and specimen, with the uncertainties of their materials.

use std::sync::Arc;

use impulse::hopkinson::{
    BarGauge, BarMaterial, HopkinsonBar, HopkinsonTest, Known, Loading, MaterialVariation,
    TestSpecimen, WaveSeparation,
};

use super::sheet::{BarSheet, ShpbSheet, ShpbSpecimenSheet, WavesSheet};
use crate::bodies::material::Material;
use crate::bodies::material_sheet::{MaterialSheet, Materials, material_called};
use crate::bodies::replacement::Replacement;
use crate::sheet::{Kind, Length, Stated, plausible};
use crate::{InStep, RodlabError};

fn known<K>(stated: &Stated<K>) -> Known {
    let stated = stated.with_uncertainty();
    Known::within(stated.value, stated.uncertainty())
}

/// Returns the test of a sheet, without the uncertainties of the gauges, which are taken from the
/// channels later.
pub(super) fn test(sheet: &ShpbSheet) -> Result<HopkinsonTest, RodlabError> {
    for (name, material) in &sheet.materials {
        if material.measured.is_some() && sheet.loading == Loading::Torsion {
            return Err(RodlabError::request(
                format!("materials: {name}"),
                material.in_words(),
                "a law of the shear modulus; a result contains a law of Young's modulus",
            ));
        }
    }
    let bars = [
        bar(&sheet.bars.incident, &sheet.materials, "incident")?,
        bar(&sheet.bars.transmitted, &sheet.materials, "transmitted")?,
    ];
    for (name, material) in &sheet.materials {
        let uses = |bar: &BarSheet| matches!(&bar.waves, WavesSheet::Material(n) if n == name);
        if !uses(&sheet.bars.incident) && !uses(&sheet.bars.transmitted) {
            return Err(RodlabError::request(
                format!("materials: {name}"),
                material.in_words(),
                "the material of a bar: no bar uses it",
            ));
        }
    }
    check_geometry(sheet)?;
    Ok(HopkinsonTest {
        bars,
        specimen: specimen_of(&sheet.specimen),
        loading: sheet.loading,
        separation: [
            sheet.bars.incident.separation(),
            sheet.bars.transmitted.separation(),
        ],
        stress: sheet.stress_from,
        band_hz: sheet.band.as_ref().map(crate::sheet::Exact::si),
        align_arrivals: sheet.align_arrivals,
        variations: variations(sheet)?,
        monte_carlo: sheet.monte_carlo,
    })
}

/// Ratio of the diameters of specimen and bar above which the specimen is refused as wider than the
/// bar.
const WIDER: f64 = 1.02;
/// Largest length of a specimen, in diameters of the bar; a longer one is probably the bar itself.
const LONGEST: f64 = 10.0;

/// Refuses a specimen that is wider than a bar, because the bar then presses only on a part of it,
/// and a specimen that is longer than [`LONGEST`] bar diameters.
fn check_geometry(sheet: &ShpbSheet) -> Result<(), RodlabError> {
    let value = |stated: &Stated<Length>| stated.with_uncertainty().value;
    let ShpbSpecimenSheet {
        length, diameter, ..
    } = &sheet.specimen;
    for bar in [&sheet.bars.incident, &sheet.bars.transmitted] {
        let of_bar = value(&bar.diameter);
        let refused = |field: &str, found: &Stated<Length>, expected: String| {
            Err(RodlabError::request(
                format!("specimen.{field}"),
                format!("`{found}`"),
                expected,
            ))
        };
        if value(diameter) > WIDER * of_bar {
            let expected = format!("at most the diameter of the bars, `{}`", bar.diameter);
            return refused("diameter", diameter, expected);
        }
        if value(length) > LONGEST * of_bar {
            let expected = format!(
                "at most {LONGEST} diameters of the bars, `{}`",
                bar.diameter
            );
            return refused("length", length, expected);
        }
    }
    Ok(())
}

pub(super) fn specimen_of(sheet: &ShpbSpecimenSheet) -> TestSpecimen {
    TestSpecimen {
        length: known(&sheet.length),
        diameter: known(&sheet.diameter),
        wall: sheet.wall.as_ref().map(known),
    }
}

fn bar(sheet: &BarSheet, materials: &Materials, side: &str) -> Result<HopkinsonBar, RodlabError> {
    if sheet.separation() != WaveSeparation::FreeEnd {
        sheet.length.exact(
            &format!("bars.{side}.length"),
            "the length of a bar only limits the time of the result unless its free end is used",
        )?;
    }
    Ok(HopkinsonBar {
        material: material(sheet, materials, side, 0.0, 0.0)?,
        diameter: known(&sheet.diameter),
        length: known(&sheet.length),
        poisson_ratio: sheet.poisson_ratio.as_ref().map(known),
        gauges: sheet
            .gauges
            .iter()
            .map(|gauge| BarGauge {
                distance: known(&gauge.at),
                factor_uncertainty: 0.0,
                delay_uncertainty: 0.0,
            })
            .collect(),
    })
}

/// Returns the material of a bar. If the material is stated by density and wave speed, these are
/// changed by `of_density` and `of_speed` times their standard uncertainties.
fn material(
    sheet: &BarSheet,
    materials: &Materials,
    side: &str,
    of_density: f64,
    of_speed: f64,
) -> Result<BarMaterial, RodlabError> {
    let field = format!("bars.{side}.waves");
    match &sheet.waves {
        WavesSheet::Material(name) => match material_called(materials, name, &field)? {
            Material::Analytic(medium) => {
                BarMaterial::new(medium.density(), Arc::new(medium.law().clone()))
            }
            Material::OnAxis(medium) => BarMaterial::new(medium.density(), Arc::new(*medium.law())),
        }
        .map(|own| {
            let measured = materials
                .get(name)
                .and_then(MaterialSheet::measured_band_hz);
            measured.map_or(own.clone(), |[_, to]| own.known_to(to))
        }),
        WavesSheet::Speed {
            density,
            wave_speed,
        } => {
            plausible::density(density, format!("{field}.density"))?;
            let (density, speed) = (density.with_uncertainty(), wave_speed.with_uncertainty());
            BarMaterial::of_wave_speed(
                density.value + of_density * density.uncertainty(),
                speed.value + of_speed * speed.uncertainty(),
            )
        }
    }
    .in_step(field)
}

/// Returns the variations of the materials. Every uncertain quantity of a named material changes
/// all bars of this material together.
fn variations(sheet: &ShpbSheet) -> Result<Vec<MaterialVariation>, RodlabError> {
    let mut found = Vec::new();
    let sides = [
        (&sheet.bars.incident, "incident"),
        (&sheet.bars.transmitted, "transmitted"),
    ];
    for (at, (bar, side)) in sides.into_iter().enumerate() {
        let WavesSheet::Speed {
            density,
            wave_speed,
        } = &bar.waves
        else {
            continue;
        };
        let mut add = |what: &str, of_density: f64, of_speed: f64| -> Result<(), RodlabError> {
            let moved = |sign: f64| -> Result<[Option<BarMaterial>; 2], RodlabError> {
                let (density, speed) = (sign * of_density, sign * of_speed);
                let own = material(bar, &sheet.materials, side, density, speed)?;
                Ok(if at == 0 {
                    [Some(own), None]
                } else {
                    [None, Some(own)]
                })
            };
            found.push(MaterialVariation {
                name: format!("{what} of the {side} bar"),
                above: moved(1.0)?,
                below: moved(-1.0)?,
            });
            Ok(())
        };
        if density.with_uncertainty().uncertainty() > 0.0 {
            add("density", 1.0, 0.0)?;
        }
        if wave_speed.with_uncertainty().uncertainty() > 0.0 {
            add("wave speed", 0.0, 1.0)?;
        }
    }
    for target in 0.. {
        let moved = |standard: f64| -> Result<(Option<String>, Materials), RodlabError> {
            let mut one = MovesOne {
                target,
                standard,
                met: 0,
                moved: None,
            };
            let materials = one.materials(&sheet.materials)?;
            Ok((one.moved, materials))
        };
        let (Some(name), above) = moved(1.0)? else {
            break;
        };
        let (_, below) = moved(-1.0)?;
        let of = |materials: &Materials| -> Result<[Option<BarMaterial>; 2], RodlabError> {
            let own = |(bar, side): (&BarSheet, &str)| match &bar.waves {
                WavesSheet::Material(_) => material(bar, materials, side, 0.0, 0.0).map(Some),
                WavesSheet::Speed { .. } => Ok(None),
            };
            Ok([own(sides[0])?, own(sides[1])?])
        };
        found.push(MaterialVariation {
            name,
            above: of(&above)?,
            below: of(&below)?,
        });
    }
    Ok(found)
}

/// Replacement that changes one of the uncertain quantities of the materials, selected by its
/// position in their order.
struct MovesOne {
    target: usize,
    standard: f64,
    met: usize,
    /// Name of the quantity that was moved.
    moved: Option<String>,
}

impl Replacement for MovesOne {
    fn standard(&mut self, source: &str) -> Result<f64, RodlabError> {
        self.met += 1;
        if self.met != self.target + 1 {
            return Ok(0.0);
        }
        self.moved = Some(source.to_owned());
        Ok(self.standard)
    }

    fn replace<K: Kind>(&mut self, stated: &mut Stated<K>, field: &str) -> Result<(), RodlabError> {
        if stated.with_uncertainty().uncertainty() <= 0.0 {
            return Ok(());
        }
        self.met += 1;
        if self.met == self.target + 1 {
            self.moved = Some(format!("{field}, {stated}"));
            let problem = "which is out of range one standard uncertainty away";
            *stated = stated.moved(self.standard, field, problem)?;
        }
        Ok(())
    }
}
