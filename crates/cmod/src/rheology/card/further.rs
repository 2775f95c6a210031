//! Cards for COMSOL and Code_Aster, and a program-independent card in JSON.

use std::fmt::Write as _;

use rodwave::modulus::ComplexModulus;

use super::isotropic::{Isotropic, young_and_poisson};
use super::{BulkBehaviour, MaterialCard, check_long_term, number};
use crate::error::{CmodError, check_not_negative, check_positive, check_that};

/// Points per decade of the functions for Code_Aster. The program interpolates between the points
/// on logarithmic scales; a Debye peak is then reproduced to 0.2 %.
const POINTS_PER_DECADE: f64 = 20.0;

/// Maximum number of points of a function for Code_Aster.
const MOST_POINTS: usize = 2000;

impl MaterialCard<'_> {
    /// Writes the table that a *Generalized Maxwell* material of COMSOL loads from a file: shear
    /// modulus \[Pa\] and relaxation time \[s\] of each branch, with [`BulkBehaviour::Elastic`].
    /// The comments state the density, and Young's modulus and Poisson's ratio of the main branch,
    /// which are the long-term values.
    ///
    /// # Errors
    /// The errors of [`Self::abaqus`].
    pub fn comsol(&self) -> Result<String, CmodError> {
        let solid = self.elastic_solid()?;
        let (young, poisson) = young_and_poisson(solid.long_term_shear(), solid.instantaneous_bulk);
        check_positive("long-term modulus of a card [Pa]", young)?;
        let mut text = format!(
            "% {}; units: m, kg, s, Pa; viscoelasticity: Generalized Maxwell, deviatoric, static stiffness: long term\n{}\
             % density {}\n% Young's modulus {}\n% Poisson's ratio {}\n% shear modulus, relaxation time\n",
            self.name,
            self.commented("%"),
            self.density,
            number(young),
            number(poisson),
        );
        for term in &solid.terms {
            // writing to a String cannot fail
            let _ = writeln!(
                text,
                "{} {}",
                number(term.shear),
                number(term.relaxation_time)
            );
        }
        Ok(text)
    }

    /// Writes the material for `DYNA_VISCO` of Code_Aster: storage modulus and loss factor as
    /// functions of frequency, and a constant Poisson's ratio, which `DYNA_VISCO` requires. Outside
    /// the band from `lowest_hz` to `highest_hz` \[Hz\] the functions are not defined.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless both frequencies are finite and above 0, the second is
    /// larger than the first by a factor of at most 10^100, and the modulus and the loss factor of
    /// the law are finite between them.
    pub fn code_aster(&self, lowest_hz: f64, highest_hz: f64) -> Result<String, CmodError> {
        let decades = (highest_hz / lowest_hz).log10();
        let steps = (POINTS_PER_DECADE * decades).ceil();
        let is_right = lowest_hz > 0.0 && steps >= 1.0 && steps < MOST_POINTS as f64;
        let quantity = "ratio of the ends of the band of a card";
        let expected = "above 1 and at most 1e100";
        check_that(is_right, quantity, highest_hz / lowest_hz, expected)?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 1 to `MOST_POINTS`"
        )]
        let last = steps as usize;
        let (mut storage, mut loss) = (String::new(), String::new());
        for point in 0..=last {
            let frequency = match point {
                0 => lowest_hz,
                _ if point == last => highest_hz,
                _ => lowest_hz * 10.0_f64.powf(decades * point as f64 / steps),
            };
            let modulus = self.law.at(std::f64::consts::TAU * frequency);
            let loss_factor = modulus.im / modulus.re;
            check_positive("storage modulus of a card [Pa]", modulus.re)?;
            check_not_negative("loss factor of a card", loss_factor)?;
            let _ = writeln!(
                storage,
                "    {}, {},",
                number(frequency),
                number(modulus.re)
            );
            let _ = writeln!(loss, "    {}, {},", number(frequency), number(loss_factor));
        }
        let name = self.name.replace('-', "_");
        let function = |of: &str, values: &str| {
            format!(
                "{name}_{of} = DEFI_FONCTION(\n    NOM_PARA=\"FREQ\", INTERPOL=(\"LOG\", \"LOG\"), PROL_GAUCHE=\"EXCLU\", PROL_DROITE=\"EXCLU\",\n    VALE=(\n{values}    ),\n)\n"
            )
        };
        Ok(format!(
            "# {}; units: m, kg, s, Pa, Hz\n{}{}{}# DYNA_VISCO(.., MATER_ELAS_FO=_F(GROUP_MA=\"..\", **{name}), ..)\n\
             {name} = dict(E={name}_E, AMOR_HYST={name}_ETA, RHO={}, NU={})\n",
            self.name,
            self.commented("#"),
            function("E", &storage),
            function("ETA", &loss),
            number(self.density),
            number(self.poisson_ratio),
        ))
    }

    /// Writes the material as JSON, with [`BulkBehaviour::Elastic`]; the names of the fields state
    /// the SI units. The text contains the series of the rod, the instantaneous bulk and shear
    /// modulus, and the terms by which the shear modulus relaxes.
    ///
    /// # Errors
    /// The errors of [`Self::abaqus`].
    pub fn json(&self) -> Result<String, CmodError> {
        let solid = self.elastic_solid()?;
        let of_rod = self.law.branches().iter();
        let of_rod = of_rod.map(|branch| {
            format!(
                "{{\"modulus_pa\": {}, \"relaxation_time_s\": {}}}",
                number(branch.modulus),
                number(branch.relaxation_time)
            )
        });
        let of_shear = solid.terms.iter().map(|term| {
            format!(
                "{{\"shear_modulus_pa\": {}, \"relaxation_time_s\": {}}}",
                number(term.shear),
                number(term.relaxation_time)
            )
        });
        let comments = self.comments.iter().map(|comment| quoted(comment));
        Ok(format!(
            "{{\n  \"name\": {},\n  \"density_kg_per_m3\": {},\n  \"poisson_ratio_instantaneous\": {},\n  \
             \"rod\": {{\n    \"equilibrium_modulus_pa\": {},\n    \"branches\": {}\n  }},\n  \
             \"solid\": {{\n    \"bulk_modulus_pa\": {},\n    \"shear_modulus_instantaneous_pa\": {},\n    \"terms\": {}\n  }},\n  \
             \"comments\": {}\n}}\n",
            quoted(self.name),
            number(self.density),
            number(self.instantaneous_ratio),
            number(self.law.equilibrium_modulus()),
            listed(of_rod, "    "),
            number(solid.instantaneous_bulk),
            number(solid.instantaneous_shear),
            listed(of_shear, "    "),
            listed(comments, "  "),
        ))
    }

    /// Returns the solid with [`BulkBehaviour::Elastic`], whose long-term shear modulus must be
    /// above 0.
    fn elastic_solid(&self) -> Result<Isotropic, CmodError> {
        let solid = Isotropic::of(&self.law, self.instantaneous_ratio, BulkBehaviour::Elastic)?;
        check_long_term(&solid)?;
        Ok(solid)
    }
}

/// Returns `text` as a JSON string. Control characters are not escaped, because comments contain
/// none.
fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{escaped}\"")
}

/// Returns a JSON list with one entry per line, its closing bracket indented by `indent`.
fn listed(entries: impl Iterator<Item = String>, indent: &str) -> String {
    let entries: Vec<String> = entries
        .map(|entry| format!("\n{indent}  {entry}"))
        .collect();
    if entries.is_empty() {
        return "[]".to_owned();
    }
    format!("[{}\n{indent}]", entries.join(","))
}
