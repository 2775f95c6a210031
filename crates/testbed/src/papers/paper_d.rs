//! Paper D as typed values: input for the reproduction of its tables, and values for comparison.

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

/// Projectile. Paper D gives neither density nor modulus; those of the aluminium of paper E are
/// used.
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
    /// Reason why every result names its reading of the units.
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

    fn values(reading: UnitReading) -> Vec<(String, LawParameters)> {
        let paper = load().unwrap();
        paper
            .identified(reading)
            .iter()
            .map(|row| (row.material.clone(), row.values))
            .collect()
    }

    #[test]
    fn table_4_as_printed() {
        let expected = [
            (
                "Polypropylene",
                LawParameters::MaxwellNorton {
                    modulus: 2.580e9,
                    exponent: 2.108,
                    coefficient: 3.816e19,
                },
            ),
            (
                "Polyamide 6",
                LawParameters::Maxwell {
                    modulus: 3.209e9,
                    viscosity: 40.85e9,
                },
            ),
            (
                "Polyoximethylene",
                LawParameters::MaxwellNorton {
                    modulus: 2.911e9,
                    exponent: 1.876,
                    coefficient: 7.917e18,
                },
            ),
            (
                "Polyethylene",
                LawParameters::MaxwellGurevichRabinovich {
                    modulus: 2.107e9,
                    viscosity: 314.6e9,
                    activation_stress: 7.082e12,
                },
            ),
            (
                "Rubber",
                LawParameters::MaxwellGurevichRabinovich {
                    modulus: 276.6e6,
                    viscosity: 81.20e9,
                    activation_stress: 108.9e9,
                },
            ),
        ]
        .map(|(material, law)| (material.to_owned(), law));
        assert_eq!(values(UnitReading::Literal), expected);
    }

    #[test]
    fn milliseconds_touch_only_what_carries_time() {
        let rows = values(UnitReading::Milliseconds);
        assert_eq!(
            rows[0].1,
            LawParameters::MaxwellNorton {
                modulus: 2.580e9,
                exponent: 2.108,
                coefficient: 3.816e16
            }
        );
        assert_eq!(
            rows[1].1,
            LawParameters::Maxwell {
                modulus: 3.209e9,
                viscosity: 40.85e6
            }
        );
        assert_eq!(
            rows[4].1,
            LawParameters::MaxwellGurevichRabinovich {
                modulus: 276.6e6,
                viscosity: 81.20e6,
                activation_stress: 108.9e9
            }
        );
    }

    #[test]
    fn realistic_values_damp_as_the_materials_are_known_to() {
        // tan δ = E F(σ)/(ω σ) at a frequency and a stress that are typical of the blow: at the
        // corner frequency Z/(2π M) of a projectile of mass M on a rod of impedance Z, and at σ =
        // σ_0/2, half the stress behind the first front, σ_0 = V_0 ρ c Z_p/(Z_p + Z).
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
            // A quarter beyond the known range is allowed: the loss factors are known to one digit,
            // and σ_0/2 is a convention.
            assert!(
                (0.8 * range.start..1.25 * range.end).contains(&loss_factor),
                "{material}: tan δ = {loss_factor}"
            );
        }
    }

    /// Tests and set-up are those of the print (Ödeen 1993, paper D, Table 2).
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
                "test {}: the excitation is read inside the rod",
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

    #[test]
    fn printed_relative_errors_follow_from_printed_input_and_output() {
        // The difference of two rounded numbers has an error of up to one unit of their last digit.
        // The half unit of the printed error itself is added.
        for row in load().unwrap().appendix(UnitReading::Literal) {
            for cell in &row.parameters {
                let relative_error =
                    (cell.output.value - cell.input.value).abs() / cell.input.value;
                let allowed = (cell.input.tolerance + cell.output.tolerance) / cell.input.value
                    + cell.relative_error.tolerance;
                assert!(
                    (relative_error - cell.relative_error.value).abs() <= allowed,
                    "{:?} {}: {relative_error} against {}",
                    row.model,
                    cell.parameter,
                    cell.relative_error.printed
                );
            }
        }
    }

    #[test]
    fn appendix_in_each_reading() {
        let paper = load().unwrap();
        let literal = paper.appendix(UnitReading::Literal);
        assert_eq!(
            literal.iter().map(|row| row.density).collect::<Vec<_>>(),
            [1100.0, 1400.0, 1120.0]
        );
        assert!(
            literal
                .iter()
                .all(|row| row.section_distance == 0.4 && row.diameter == 0.016)
        );
        assert_eq!(
            literal[1].output,
            LawParameters::MaxwellNorton {
                modulus: 2.512e9,
                exponent: 1.558,
                coefficient: 319.8e12
            }
        );
        assert_eq!(
            paper.appendix(UnitReading::Milliseconds)[0].input,
            LawParameters::Maxwell {
                modulus: 3.056e9,
                viscosity: 11.12e6
            }
        );
        let realistic = paper.appendix(UnitReading::Realistic);
        assert_eq!(
            realistic[2].input,
            LawParameters::MaxwellGurevichRabinovich {
                modulus: 270e6,
                viscosity: 0.222e6,
                activation_stress: 12.0e6
            }
        );
        assert_eq!(
            realistic[2].output,
            LawParameters::MaxwellGurevichRabinovich {
                modulus: 270.4e6,
                viscosity: 0.2216e6,
                activation_stress: 11.97e6
            }
        );
    }
}
