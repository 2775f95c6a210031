//! Lines to which laws are fitted.

use cmod::rheology::{ErrorScale, ModulusData};
use num_complex::Complex64;
use rodfigure::Axis;

use crate::sheet::ValueWithUncertainty;

/// Lines to which laws are fitted, with the settings of the fit and its figure.
pub(crate) struct Lines<'a> {
    /// Lines with their errors.
    pub(crate) data: &'a ModulusData,
    /// Frequency \[Hz\] and modulus \[Pa\] of each line, for the figure.
    pub(crate) points: Vec<(f64, Complex64)>,
    /// Basis of the errors.
    pub(crate) error_scale: ErrorScale,
    /// Probability of chi-square below which no law explains the lines, and the answer is in doubt.
    /// It is used only if the errors of the lines are stated. `None` if the caller judges
    /// chi-square.
    pub(crate) chance: Option<f64>,
    /// True to compute profiles of the parameters of a Prony series; this takes long for many
    /// branches.
    pub(crate) series_profiles: bool,
    /// Density of the material \[kg/m³\], if it is known.
    pub(crate) density: Option<ValueWithUncertainty>,
    /// True for Young's modulus, with which later sheets can describe rods.
    pub(crate) is_youngs: bool,
    /// Temperature of the lines for a card, if the sheet states none for the card.
    pub(crate) temperature: Option<String>,
    /// Appearance of the figure.
    pub(crate) drawn: Drawn,
}

/// Appearance of the figure of laws.
pub(crate) struct Drawn {
    /// Axis of frequency, and number of axis units per Hz.
    pub(crate) frequency: (Axis, f64),
    /// Axis of the storage modulus, and number of axis units per Pa.
    pub(crate) storage: (Axis, f64),
    /// End of the caption, after the preferred law.
    pub(crate) caption: String,
}
