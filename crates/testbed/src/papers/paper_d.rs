//! Paper D as typed values: inputs for the reproduction of its tables, and values for comparison.

mod law;
mod readings;
mod tables;

use super::error::FixtureError;
use super::si_table::SiTable;
use super::{PAPERS, READINGS, transcribed_table};
use crate::generated::workspace_root;

use self::readings::Readings;

pub use self::law::{LawParameters, ModelKind};
pub use self::readings::UnitReading;

/// Printed number, converted to SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Printed {
    pub value: f64,
    /// Tolerance of a comparison with this number: half a unit of its last printed digit, or the
    /// allowance that the fixture states, with a reason, for this cell.
    pub tolerance: f64,
    /// Digits and unit as printed.
    pub printed: String,
}

/// Row of Table 2 (Ödeen 1993, paper D, Table 2).
#[derive(Debug, Clone, PartialEq)]
pub struct RodTestConditions {
    pub test: u32,
    pub material: String,
    /// ρ in kg/m³
    pub density: f64,
    /// D in m
    pub diameter: f64,
    /// `L_0` in m
    pub rod_length: f64,
    /// L in m: distance of the section of the excitation from the free end
    pub section_distance: f64,
    /// Range of the displacement transducers in m
    pub transducer_range: f64,
}

/// Material of Table 4.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifiedMaterial {
    pub material: String,
    pub model: ModelKind,
    pub values: LawParameters,
}

/// Row of Table 3.
#[derive(Debug, Clone, PartialEq)]
pub struct Adequacy {
    pub material: String,
    /// `P_1`, `P_2`, `P_3`
    pub measures: [Printed; 3],
    /// Model of Table 4.
    pub chosen: ModelKind,
}

/// Row of Table 5.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityErrors {
    pub material: String,
    pub model: ModelKind,
    /// Errors with Q = 1, 2, 3, 4 tests, as fractions of `V_0`
    pub by_number_of_tests: [Printed; 4],
}

/// Parameter of Table A1, as printed. Its relative error does not depend on the reading of the
/// units.
#[derive(Debug, Clone, PartialEq)]
pub struct AppendixParameter {
    /// Printed symbol.
    pub parameter: &'static str,
    pub input: Printed,
    pub output: Printed,
    /// Relative error as a fraction.
    pub relative_error: Printed,
}

/// Model of Table A1.
#[derive(Debug, Clone, PartialEq)]
pub struct AppendixRow {
    pub model: ModelKind,
    /// ρ in kg/m³
    pub density: f64,
    /// L in m
    pub section_distance: f64,
    /// D in m
    pub diameter: f64,
    /// Printed input, in the chosen reading.
    pub input: LawParameters,
    /// Printed output, in the chosen reading.
    pub output: LawParameters,
    /// Printed parameters.
    pub parameters: Vec<AppendixParameter>,
}

/// Projectile. Paper D states neither its density nor its modulus; those of the aluminium of paper
/// E are used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Striker {
    /// Length in m
    pub length: f64,
    /// Diameter in m
    pub diameter: f64,
    /// Density in kg/m³, paper E
    pub density: f64,
    /// Modulus in Pa, paper E
    pub modulus: f64,
    /// Impact velocity `V_0` in m/s
    pub velocity: f64,
}

/// Tables and constants of paper D.
#[derive(Debug, Clone)]
pub struct PaperD {
    /// Table 2
    pub tests: Vec<RodTestConditions>,
    /// Table 3
    pub adequacy: Vec<Adequacy>,
    /// Table 5
    pub errors: Vec<VelocityErrors>,
    pub striker: Striker,
    /// Sampling rate in Hz
    pub sampling_rate: f64,
    /// Number of parameter vectors for each model, about sixty.
    pub standard_samples_per_model: f64,
    /// Explanation that no reading of the units is consistent.
    pub no_consistent_reading: String,
    /// Tables 4 and A1: one pair per reading, in the order of [`UnitReading::ALL`].
    by_reading: [(Vec<IdentifiedMaterial>, Vec<AppendixRow>); 3],
}

impl PaperD {
    /// Returns Table 4 in a reading of its units.
    pub fn identified(&self, reading: UnitReading) -> &[IdentifiedMaterial] {
        &self.of(reading).0
    }

    /// Returns Table A1 in a reading of its units.
    pub fn appendix(&self, reading: UnitReading) -> &[AppendixRow] {
        &self.of(reading).1
    }

    const fn of(&self, reading: UnitReading) -> &(Vec<IdentifiedMaterial>, Vec<AppendixRow>) {
        let [literal, milliseconds, realistic] = &self.by_reading;
        match reading {
            UnitReading::Literal => literal,
            UnitReading::Milliseconds => milliseconds,
            UnitReading::Realistic => realistic,
        }
    }
}

/// Reads paper D from its transcribed tables.
pub fn load() -> Result<PaperD, FixtureError> {
    let constants = transcribed_table("paper_d_constants.ron")?;
    let paper_e = transcribed_table("paper_e_constants.ron")?;
    let constant = |table: &SiTable, name: &str| table.number(name, "value");
    let readings = Readings::load(&workspace_root().join(PAPERS).join(READINGS))?;
    let table_4 = transcribed_table("paper_d_table_4.ron")?;
    let table_a1 = transcribed_table("paper_d_table_a1.ron")?;
    let read = |reading| {
        Ok::<_, FixtureError>((
            tables::identified(&table_4, &readings, reading)?,
            tables::appendix(&table_a1, &constants, &readings, reading)?,
        ))
    };
    Ok(PaperD {
        tests: tables::rod_tests(&constants)?,
        adequacy: tables::adequacy()?,
        errors: tables::velocity_errors()?,
        striker: Striker {
            length: constant(&constants, "projectile_length")?,
            diameter: constant(&constants, "projectile_diameter")?,
            density: constant(&paper_e, "aluminium_density")?,
            modulus: constant(&paper_e, "aluminium_modulus")?,
            velocity: constant(&constants, "impact_velocity")?,
        },
        sampling_rate: constant(&constants, "sampling_rate")?,
        standard_samples_per_model: constant(&constants, "standard_samples_per_model")?,
        no_consistent_reading: readings.no_consistent_reading().to_owned(),
        by_reading: [
            read(UnitReading::Literal)?,
            read(UnitReading::Milliseconds)?,
            read(UnitReading::Realistic)?,
        ],
    })
}

#[cfg(test)]
#[expect(
    clippy::float_cmp,
    reason = "the digits are shifted as text: each value is the float of the written number"
)]
mod tests {
    use super::*;

    #[test]
    fn realistic_values_damp_as_the_materials_are_known_to() {
        // tan δ = E F(σ)/(ω σ) at a frequency and a stress that are typical of the impact: the
        // corner frequency Z/(2π M) of a projectile of mass M on a rod of impedance Z, and half of
        // the stress behind the first front, σ_0 = V_0 ρ c Z_p/(Z_p + Z)
        let known = [
            ("Polypropylene", 0.05..0.08),
            ("Polyamide 6", 0.02..0.09),
            ("Polyoximethylene", 0.015..0.03),
            ("Polyethylene", 0.05..0.10),
            ("Rubber", 0.2..0.4),
        ];
        let paper = load().unwrap();
        let area = |diameter: f64| std::f64::consts::PI * diameter * diameter / 4.0;
        let striker = &paper.striker;
        let striker_mass = striker.density * area(striker.diameter) * striker.length;
        let striker_impedance = area(striker.diameter) * (striker.density * striker.modulus).sqrt();
        for (row, (material, range)) in paper.identified(UnitReading::Realistic).iter().zip(known) {
            assert_eq!(row.material, material);
            let test = paper
                .tests
                .iter()
                .find(|test| test.material == material)
                .unwrap();
            let (LawParameters::Maxwell { modulus, .. }
            | LawParameters::MaxwellNorton { modulus, .. }
            | LawParameters::MaxwellGurevichRabinovich { modulus, .. }) = row.values;
            let impedance = area(test.diameter) * (test.density * modulus).sqrt();
            let front_velocity =
                striker.velocity * striker_impedance / (striker_impedance + impedance);
            let stress = 0.5 * front_velocity * (test.density * modulus).sqrt();
            let strain_rate = match row.values {
                LawParameters::Maxwell { viscosity, .. } => stress / viscosity,
                LawParameters::MaxwellNorton {
                    exponent,
                    coefficient,
                    ..
                } => stress.powf(exponent) / coefficient,
                LawParameters::MaxwellGurevichRabinovich {
                    viscosity,
                    activation_stress,
                    ..
                } => stress * (stress / activation_stress).exp() / viscosity,
            };
            let corner = impedance / striker_mass;
            let loss_factor = modulus * strain_rate / (corner * stress);
            // tolerance: a quarter of the known range, because the loss factors are known to one
            // digit and σ_0/2 is a convention
            assert!(
                (0.8 * range.start..1.25 * range.end).contains(&loss_factor),
                "{material}: tan δ = {loss_factor}"
            );
        }
    }

    /// Checks that tests and set-up are as printed (Ödeen 1993, paper D, Table 2).
    #[test]
    fn tests_and_set_up_are_those_of_the_print() {
        let paper = load().unwrap();
        assert_eq!(paper.tests.len(), 25);
        assert_eq!(
            paper.tests[24],
            RodTestConditions {
                test: 25,
                material: "Rubber".into(),
                density: 1320.0,
                diameter: 0.0122,
                rod_length: 0.402,
                section_distance: 0.392,
                transducer_range: 0.020,
            }
        );
        for (index, test) in paper.tests.iter().enumerate() {
            assert_eq!(test.test as usize, index + 1);
            assert_eq!(test.transducer_range, if index < 5 { 0.005 } else { 0.020 });
            assert!(
                test.section_distance < test.rod_length,
                "test {}: the section of the excitation is not inside the rod",
                test.test
            );
        }
        for material in paper.tests.chunks(5) {
            assert!(
                material
                    .iter()
                    .all(|test| test.material == material[0].material
                        && test.density == material[0].density)
            );
        }
        assert_eq!(paper.sampling_rate, 51200.0);
        assert_eq!(
            paper.striker,
            Striker {
                length: 0.030,
                diameter: 0.0158,
                density: 2700.0,
                modulus: 69e9,
                velocity: 10.0
            }
        );
    }

    #[test]
    fn the_model_of_table_4_is_the_most_adequate_of_table_3() {
        let paper = load().unwrap();
        assert_eq!(paper.adequacy.len(), 5);
        let models = [
            ModelKind::Maxwell,
            ModelKind::MaxwellNorton,
            ModelKind::MaxwellGurevichRabinovich,
        ];
        for ((adequacy, identified), errors) in paper
            .adequacy
            .iter()
            .zip(paper.identified(UnitReading::Literal))
            .zip(&paper.errors)
        {
            let largest = (0..3)
                .max_by(|&a, &b| {
                    adequacy.measures[a]
                        .value
                        .total_cmp(&adequacy.measures[b].value)
                })
                .unwrap();
            assert_eq!(models[largest], adequacy.chosen, "{}", adequacy.material);
            assert_eq!(
                (&identified.material, identified.model),
                (&adequacy.material, adequacy.chosen)
            );
            assert_eq!(
                (&errors.material, errors.model),
                (&adequacy.material, adequacy.chosen)
            );
        }
    }
}
