//! Laws of a complex modulus in a sheet, their fits, and material cards for other programs.

mod cards;
pub(crate) mod causal;
mod fit;
mod lines;

pub(crate) use fit::{fit, of_value, unexplained};
pub(crate) use lines::{Drawn, Lines};

use cmod::rheology::{Criterion, ErrorScale, FitOptions, Law};
use serde::Deserialize;

use crate::RodlabError;
use crate::outcome::Setting;
use crate::sheet::{Exact, Frequency, PoissonRatio, Ratio, Stated, Temperature};

/// Default of the maximum number of fitted lines.
pub(crate) const MOST_LINES: usize = 400;
/// Maximum number of randomly drawn cards for one program.
const MOST_DRAWS: usize = 1000;
/// Maximum probability with which the whiteness tests reject residuals that are white.
pub(crate) const WHITE: f64 = 0.01;

/// Laws to be fitted.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LawsSheet {
    /// The laws, such as `[Zener, FractionalZener, GeneralisedMaxwell]`.
    pub laws: Vec<Law>,
    /// Criterion for comparing laws and numbers of branches; `Bic` by default.
    pub criterion: Option<Criterion>,
    /// Confidence of the intervals, such as `"95 %"`, which is the default.
    pub confidence: Option<Exact<Ratio>>,
    /// Largest number of branches of a Prony series, for example the number that a program accepts;
    /// by default no limit.
    pub most_branches: Option<usize>,
    /// Maximum number of fitted lines, chosen evenly among the valid lines; by default 400.
    pub most_lines: Option<usize>,
    /// Cards of the generalised Maxwell model for other programs.
    pub cards: Option<CardsSheet>,
}

/// Cards for other programs.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CardsSheet {
    /// Name of the material, a letter followed by letters, digits, `-` or `_`.
    pub name: String,
    /// Poisson's ratio, such as `"0.40 ± 0.02"`.
    pub poisson_ratio: Stated<PoissonRatio>,
    /// Frequency to which this ratio applies, such as `"1 kHz"`; by default the middle of the
    /// fitted lines.
    pub poisson_ratio_at: Option<Exact<Frequency>>,
    /// Temperature of the specimen, such as `"23 degC"`, for a comment in the card.
    pub temperature: Option<Exact<Temperature>>,
    /// The programs, such as `[Abaqus, Ansys, LsDyna, Comsol, CodeAster, Json]`.
    pub programs: Vec<ProgramSheet>,
    /// Number of additional cards, such as 100, for a Monte Carlo calculation with the program.
    /// Each card has a draw of the modulus, the density and Poisson's ratio. None by default.
    pub draws: Option<usize>,
}

/// A program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum ProgramSheet {
    /// Card for Abaqus with long-term moduli and an elastic bulk modulus.
    Abaqus,
    /// Card for ANSYS with an elastic bulk modulus.
    Ansys,
    /// Card for LS-DYNA with an elastic bulk modulus.
    LsDyna,
    /// Card for COMSOL with an elastic bulk modulus.
    Comsol,
    /// Card for Code_Aster with modulus and loss factor over the band and a constant Poisson's
    /// ratio.
    CodeAster,
    /// JSON file with an elastic bulk modulus.
    Json,
}

impl LawsSheet {
    /// Returns the defaults of the fields that the sheet does not state.
    pub(crate) fn defaults(&self) -> Vec<Setting> {
        let mut defaults = vec![
            Setting::by_default("laws.criterion", "Bayesian information criterion"),
            Setting::by_default("laws.confidence", "95 %"),
            Setting::by_default("laws.most_branches", "not limited"),
            Setting::by_default("laws.most_lines", MOST_LINES),
        ];
        if self.cards.is_some() {
            defaults.push(Setting::by_default(
                "laws.cards.poisson_ratio_at",
                "geometric mean of the lowest and the highest line",
            ));
            defaults.push(Setting::by_default("laws.cards.temperature", "not stated"));
        }
        defaults
    }

    /// Refuses settings that are wrong whatever the data are.
    pub(crate) fn check(&self) -> Result<(), RodlabError> {
        RodlabError::refuse_empty(&self.laws, "laws.laws", "at least one law")?;
        for (field, value) in [
            ("laws.most_lines", self.most_lines),
            ("laws.most_branches", self.most_branches),
        ] {
            if value == Some(0) {
                return Err(RodlabError::request(field, "0", "at least 1"));
            }
        }
        if self.cards.is_some() && !self.laws.contains(&Law::GeneralisedMaxwell) {
            return Err(RodlabError::request(
                "laws.cards",
                "requested",
                "the law `generalised_maxwell` (in RON `GeneralisedMaxwell`) among `laws.laws`: cards are made from it",
            ));
        }
        let draws = self.cards.as_ref().and_then(|cards| cards.draws);
        if let Some(draws) = draws.filter(|draws| !(1..=MOST_DRAWS).contains(draws)) {
            return Err(RodlabError::request(
                "laws.cards.draws",
                draws.to_string(),
                format!("from 1 to {MOST_DRAWS}"),
            ));
        }
        Ok(())
    }

    /// Returns the settings of the fits.
    pub(crate) fn options(&self, error_scale: ErrorScale) -> FitOptions {
        let options = FitOptions::default();
        let options = match self.most_branches {
            Some(most) => options.with_most_branches(most),
            None => options,
        };
        let options = options
            .with_error_scale(error_scale)
            .with_criterion(self.criterion.unwrap_or_default());
        match &self.confidence {
            Some(confidence) => options.with_confidence(confidence.si()),
            None => options,
        }
    }

    /// Returns the laws, for a material of this density.
    pub(crate) fn kinds(&self, density: Option<f64>) -> Result<Vec<Law>, RodlabError> {
        let of = |law: &Law| match (law, density) {
            (Law::PowerLaw { .. }, Some(density)) => Ok(Law::PowerLaw { density }),
            (Law::PowerLaw { .. }, None) => Err(RodlabError::request(
                "laws.laws",
                "`power_law` (in RON `PowerLaw`), a law of waves in a rod",
                "the density of the material as well",
            )),
            (law, _) => Ok(*law),
        };
        self.laws.iter().map(of).collect()
    }
}
