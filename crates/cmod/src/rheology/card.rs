//! Cards of finite-element programs for a Prony series.
//!
//! A test of a rod gives E(ω); a program for solids needs the shear and the bulk modulus. The
//! missing information is the Poisson ratio, and an assumption about its change with time
//! ([`BulkBehaviour`]). All programs but one describe a relaxation by a sum of exponentials:
//!
//! | program | card | moduli | relaxation times |
//! |---|---|---|---|
//! | Abaqus | `*VISCOELASTIC, TIME=PRONY` | ratios gᵢ, kᵢ to the instantaneous modulus; `*ELASTIC` is instantaneous or long-term as stated | τᵢ, common to shear and bulk |
//! | ANSYS | `TB,PRONY` for `SHEAR` and `BULK` | ratios αᵢ to the instantaneous modulus, which is `MP,EX` | τᵢ |
//! | LS-DYNA | `*MAT_GENERAL_VISCOELASTIC` (076) | Gᵢ themselves, the Gᵢ of rate 0 is the long-term modulus; `BULK` elastic | βᵢ = 1/τᵢ |
//! | COMSOL | *Generalized Maxwell*, table of branches | Gᵢ; the main branch is long-term; bulk elastic | τᵢ |
//! | Code_Aster | `DYNA_VISCO` | E'(f) and E''/E'(f) in the band | |
//! | JSON | | Eᵢ of the rod; G(∞), Gᵢ and K of the solid, bulk elastic | τᵢ |
//!
//! Units are SI. Numbers are written with all their digits, except in the ten-column fields of
//! LS-DYNA, where values of 1e-9 and above have at least six digits.
//!
//! ```
//! use cmod::rheology::card::{BulkBehaviour, MaterialCard, Moduli};
//! use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};
//!
//! let law = GeneralisedMaxwell::new(1.5e9, vec![MaxwellBranch { modulus: 0.5e9, relaxation_time: 1e-4 }])?;
//! let card = MaterialCard::new("PP", 912.0, 0.4, &law)?;
//! let text = card.abaqus(Moduli::LongTerm, BulkBehaviour::ConstantPoissonRatio)?;
//! assert!(text.contains("*ELASTIC, MODULI=LONG TERM\n1.5e9, 0.4\n"));
//! assert!(text.ends_with("*VISCOELASTIC, TIME=PRONY\n2.5e-1, 2.5e-1, 1e-4\n"));
//! # Ok::<(), cmod::CmodError>(())
//! ```

mod further;
mod in_band;
mod isotropic;

use std::fmt::Write as _;

use num_complex::Complex64;
use rodwave::modulus::{ComplexModulus, GeneralisedMaxwell};

use super::data::ModulusData;
use super::fit::{ErrorScale, FitOptions, RheologicalFit};
use super::law::FittedLaw;
use super::measured_law::{LawError, MeasuredLaw};
use crate::error::{CmodError, check_not_negative, check_positive, check_that};
use in_band::in_band;
use isotropic::Isotropic;

/// Maximum number of Prony terms of ANSYS, for shear and for bulk each.
pub const ANSYS_TERMS: usize = 100;
/// Maximum number of terms of `*MAT_GENERAL_VISCOELASTIC`, including the term of rate 0.
pub const LS_DYNA_TERMS: usize = 18;

/// Probability of chi-square below which a card states that its series does not explain the data.
const UNEXPLAINED: f64 = 0.01;

/// Meaning of the elastic constants that accompany a Prony series in Abaqus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moduli {
    /// Constants for instantaneous loading, E(∞): `MODULI=INSTANTANEOUS`. Abaqus does not accept
    /// this in the frequency domain.
    Instantaneous,
    /// Constants for long-term loading, E(0): `MODULI=LONG TERM`.
    LongTerm,
}

/// Relaxation of the response to pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BulkBehaviour {
    /// The bulk modulus relaxes like the shear modulus: the Poisson ratio is the same at all rates,
    /// and gᵢ = kᵢ = Eᵢ/E(∞).
    ConstantPoissonRatio,
    /// The bulk modulus does not relax: K = E(∞)/(3 (1 - 2ν)) with the instantaneous ν, and G =
    /// 3KE/(9K - E), which is a Prony series with as many branches as E and shorter times. The
    /// Poisson ratio increases towards 1/2 as the material relaxes, as in polymers.
    Elastic,
}

/// Material data from which the cards of the programs are written.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialCard<'a> {
    name: &'a str,
    density: f64,
    poisson_ratio: f64,
    /// Instantaneous Poisson ratio for an elastic bulk.
    instantaneous_ratio: f64,
    law: GeneralisedMaxwell,
    /// Series with its errors, if the card comes from a fit.
    measured: Option<MeasuredLaw>,
    /// Largest deviation from the fitted series, if the card comes from a fit.
    deviation: Option<CardDeviation>,
    comments: Vec<String>,
}

/// Largest difference between the fitted series and the series of the card, whose relaxation times
/// are within the band.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CardDeviation {
    /// Largest difference of the complex moduli, relative to |E|.
    pub relative: f64,
    /// Frequency of the largest difference \[Hz\].
    pub frequency_hz: f64,
}

impl<'a> MaterialCard<'a> {
    /// Creates a material with the Prony series of a `fit` to `data`, restricted to the parameters
    /// that the data determine.
    ///
    /// If a branch relaxes outside the band, only its flank affects the data. Therefore the card
    /// has only relaxation times within the band, 1/ω₂ <= τᵢ <= 1/ω₁. Slower branches become a part
    /// of the long-term modulus, faster branches become a branch at the upper end, and the moduli
    /// are fitted again. Branches that are not identified are omitted. The card then fulfils
    ///
    /// ```text
    /// E(∞) <= E'(ω₂) + E''(ω₂) ,    E(0) >= E'(ω₁) - E''(ω₁)
    /// ```
    ///
    /// The card begins with comments: the band, the largest deviation of the card from the data and
    /// from the fitted series, |E| at both ends and the middle of the band with its standard
    /// uncertainty due to random and common errors ([`RheologicalFit::prediction`]), E(0) and E(∞),
    /// and the interval of each parameter.
    ///
    /// # Errors
    /// The errors of [`Self::new`]; [`CmodError::CardLaw`] if another law was fitted;
    /// [`CmodError::CardUndetermined`] if the data determine no long-term modulus or no relaxation.
    pub fn from_fit(
        name: &'a str,
        density: f64,
        poisson_ratio: f64,
        fit: &RheologicalFit,
        data: &ModulusData,
    ) -> Result<Self, CmodError> {
        let card_law = || CmodError::CardLaw {
            law: fit.law.law().to_string(),
        };
        let series = fit.law.prony_series().ok_or_else(card_law)?;
        let options = FitOptions::default().with_error_scale(fit.error_scale);
        let own = in_band(data, series, options)?;
        let law = own.law.prony_series().ok_or_else(card_law)?;
        let mut card = Self {
            measured: MeasuredLaw::of(&own).ok(),
            ..Self::new(name, density, poisson_ratio, law)?
        };
        let (lowest, highest) = data.band();
        let hertz = |omega: f64| omega / std::f64::consts::TAU;
        card.comments.push(format!(
            "data: {} lines, {:.4e} to {:.4e} Hz",
            data.len(),
            hertz(lowest),
            hertz(highest)
        ));
        let response = own.law.response(data);
        let largest = |other: &[Complex64]| {
            let (relative, at) = (response.iter().zip(other).zip(&data.omega))
                .map(|((law, other), omega)| ((law / other - 1.0).norm(), *omega))
                .fold((0.0, lowest), |a, b| if a.0 >= b.0 { a } else { b });
            CardDeviation {
                relative,
                frequency_hz: hertz(at),
            }
        };
        let of_series = largest(&fit.law.response(data));
        card.deviation = Some(of_series);
        for (from, deviation) in [
            ("data", largest(&data.modulus)),
            ("fitted series", of_series),
        ] {
            card.comments.push(format!(
                "largest deviation from the {from}: {:.2e} % of |E|, at {:.3e} Hz",
                100.0 * deviation.relative,
                deviation.frequency_hz
            ));
        }
        card.comments
            .push("modulus with its standard uncertainty".to_owned());
        for omega in [lowest, (lowest * highest).sqrt(), highest] {
            card.comments.push(size_at(fit, omega)?);
        }
        card.comments.push(format!(
            "E(0) = {:.4e} Pa, E(inf) = {:.4e} Pa if nothing relaxes outside the band",
            law.equilibrium_modulus(),
            law.unrelaxed_modulus()
        ));
        let intervals = format!("{:.0} % intervals", 100.0 * options.confidence);
        if own.error_scale == ErrorScale::Stated && own.p_value() < UNEXPLAINED {
            card.comments.push(format!(
                "{intervals} of a series that does not explain the data:"
            ));
            card.comments.push(format!(
                "chi-square {:.3e} with {} degrees of freedom",
                own.chi_squared, own.degrees_of_freedom
            ));
        } else {
            card.comments
                .push(format!("{intervals}; all parameters are identified"));
        }
        for parameter in &own.parameters {
            card.comments.push(format!(
                "{}: {:.3e} to {:.3e} {}",
                parameter.name, parameter.interval.lower, parameter.interval.upper, parameter.unit
            ));
        }
        if own.parameters.len() < 1 + 2 * law.branches().len() {
            card.comments
                .push("a relaxation time without an interval is at an end of the band".to_owned());
        }
        Ok(card)
    }

    /// Adds a line of comment at the end, such as the temperature and the source of the data.
    /// Non-printing characters, and all characters after the first 76, are omitted.
    #[must_use]
    pub fn with_comment(mut self, comment: &str) -> Self {
        let prints = comment.chars().filter(|c| !c.is_control());
        self.comments.push(prints.take(76).collect());
        self
    }

    /// Declares that the Poisson ratio applies at `frequency_hz`, and is not the instantaneous
    /// Poisson ratio. For [`BulkBehaviour::Elastic`], K = E'/(3 (1 - 2ν)) with E' at this
    /// frequency; the real part of ν(ω) = 1/2 - E(ω)/(6K) then equals ν at this frequency. The
    /// `standard_uncertainty` u of ν, if stated, causes a relative uncertainty 2u/(1 - 2ν) of K,
    /// which is stated in a comment.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless the frequency is finite and above 0, the uncertainty is
    /// finite and not negative, and the resulting instantaneous ratio is not negative, or above -1
    /// if the Poisson ratio itself is negative. The long-term ratio is between the Poisson ratio
    /// and 1/2.
    pub fn with_poisson_ratio_at(
        mut self,
        frequency_hz: f64,
        standard_uncertainty: Option<f64>,
    ) -> Result<Self, CmodError> {
        let frequency = check_positive("frequency of the Poisson ratio [Hz]", frequency_hz)?;
        let ratio = self.poisson_ratio;
        let of = |uncertainty| check_not_negative("uncertainty of the Poisson ratio", uncertainty);
        let (of_ratio, of_bulk) = match standard_uncertainty.map(of).transpose()? {
            Some(u) => {
                let percent = 200.0 * u / (1.0 - 2.0 * ratio);
                (format!("+- {u}"), format!(" +- {percent:.1e} %"))
            }
            None => ("(uncertainty not stated)".to_owned(), String::new()),
        };
        let storage = self.law.at(std::f64::consts::TAU * frequency).re;
        let bulk = storage / (3.0 * (1.0 - 2.0 * self.poisson_ratio));
        let instantaneous = 0.5 - self.law.unrelaxed_modulus() / (6.0 * bulk);
        let check = |is_right, expected| {
            let quantity = "instantaneous Poisson ratio";
            check_that(is_right, quantity, instantaneous, expected)
        };
        check(instantaneous > -1.0, "above -1")?;
        let expected = "0 or above, because the stated ratio is not negative";
        check(ratio < 0.0 || instantaneous >= 0.0, expected)?;
        self.instantaneous_ratio = instantaneous;
        self.comments.push(format!(
            "Poisson ratio {ratio} {of_ratio} at {frequency:.3e} Hz"
        ));
        self.comments.push(format!(
            "elastic bulk: K = {bulk:.4e} Pa{of_bulk}, instantaneous ratio {instantaneous:.4}"
        ));
        Ok(self)
    }

    /// Returns the largest deviation from the series of the fit; `None` if the card does not come
    /// from a fit.
    #[must_use]
    pub fn deviation(&self) -> Option<CardDeviation> {
        self.deviation
    }

    /// Returns the instantaneous Poisson ratio.
    fn ratio(&self, bulk: BulkBehaviour) -> f64 {
        match bulk {
            BulkBehaviour::ConstantPoissonRatio => self.poisson_ratio,
            BulkBehaviour::Elastic => self.instantaneous_ratio,
        }
    }

    /// Returns the comments, one per line, each after the comment `mark` of the program.
    fn commented(&self, mark: &str) -> String {
        let comments = self.comments.iter();
        comments.map(|text| format!("{mark} {text}\n")).collect()
    }

    /// Creates a material of `name`, `density` [kg/m³] and instantaneous `poisson_ratio` with the
    /// modulus `law`.
    ///
    /// # Errors
    /// [`CmodError::CardName`] unless the name is a letter followed by at most 79 letters, digits,
    /// `-` or `_`; [`CmodError::NonPhysical`] unless the density is finite and above 0, the Poisson
    /// ratio is above -1 and below 1/2 (at 1/2 the bulk modulus is infinite), and the series has
    /// branches and a long-term modulus. Without a long-term modulus the ratios of Abaqus and ANSYS
    /// sum to 1; these programs refuse or round such ratios.
    pub fn new(
        name: &'a str,
        density: f64,
        poisson_ratio: f64,
        law: &GeneralisedMaxwell,
    ) -> Result<Self, CmodError> {
        let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if !(name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.len() <= 80
            && name.chars().all(allowed))
        {
            return Err(CmodError::CardName {
                name: name.to_owned(),
            });
        }
        check_positive("density [kg/m^3]", density)?;
        let is_right = poisson_ratio > -1.0 && poisson_ratio < 0.5;
        let expected = "above -1 and below 0.5";
        check_that(is_right, "Poisson ratio", poisson_ratio, expected)?;
        check_positive(
            "long-term modulus of a card [Pa]",
            law.equilibrium_modulus(),
        )?;
        let has_branches = !law.branches().is_empty();
        let quantity = "number of branches of a card";
        check_that(has_branches, quantity, 0.0, "at least 1")?;
        Ok(Self {
            name,
            density,
            poisson_ratio,
            instantaneous_ratio: poisson_ratio,
            law: law.clone(),
            measured: None,
            deviation: None,
            comments: Vec::new(),
        })
    }

    /// Returns the independent errors of the series; empty unless the series comes from a fit for
    /// which [`MeasuredLaw::of`] finds them.
    #[must_use]
    pub fn errors(&self) -> &[LawError] {
        self.measured.as_ref().map_or(&[], MeasuredLaw::errors)
    }

    /// Creates a card for a random draw of the material. The series is moved by `standard[k]`
    /// standard uncertainties of the error k of [`Self::errors`]; the card has the given `density`
    /// [kg/m³] and instantaneous `poisson_ratio`, and no comments. If `standard` contains standard
    /// normal numbers, the draws have the covariance of the fit, for a Monte Carlo calculation with
    /// the program.
    ///
    /// # Errors
    /// The errors of [`Self::new`] and [`MeasuredLaw::moved`].
    pub fn moved(
        &self,
        standard: &[f64],
        density: f64,
        poisson_ratio: f64,
    ) -> Result<Self, CmodError> {
        let moved = self.measured.as_ref().map(|law| law.moved(standard));
        let moved = moved.transpose()?;
        let series = moved.as_ref().and_then(FittedLaw::prony_series);
        Self::new(
            self.name,
            density,
            poisson_ratio,
            series.unwrap_or(&self.law),
        )
    }

    /// Writes the Abaqus keywords of the material, from `*MATERIAL` to the Prony series.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] if the relaxation times of branches are so close that the roots
    /// of [`BulkBehaviour::Elastic`] cannot be separated.
    pub fn abaqus(&self, moduli: Moduli, bulk: BulkBehaviour) -> Result<String, CmodError> {
        let solid = Isotropic::of(&self.law, self.ratio(bulk), bulk)?;
        let (keyword, shear, compression) = match moduli {
            Moduli::Instantaneous => (
                "INSTANTANEOUS",
                solid.instantaneous_shear,
                solid.instantaneous_bulk,
            ),
            Moduli::LongTerm => {
                check_long_term(&solid)?;
                ("LONG TERM", solid.long_term_shear(), solid.long_term_bulk())
            }
        };
        let (young, poisson) = isotropic::young_and_poisson(shear, compression);
        let (young, poisson) = match (moduli, bulk) {
            // the values are used as given, without rounding by a conversion back and forth
            (Moduli::Instantaneous, _) => (self.law.unrelaxed_modulus(), self.ratio(bulk)),
            (Moduli::LongTerm, BulkBehaviour::ConstantPoissonRatio) => {
                (self.law.equilibrium_modulus(), self.poisson_ratio)
            }
            (Moduli::LongTerm, BulkBehaviour::Elastic) => (young, poisson),
        };
        let mut text = format!(
            "** units: m, kg, s, Pa\n{}*MATERIAL, NAME={}\n*DENSITY\n{},\n*ELASTIC, MODULI={keyword}\n{}, {poisson}\n*VISCOELASTIC, TIME=PRONY\n",
            self.commented("**"),
            self.name,
            self.density,
            number(young),
        );
        for term in &solid.terms {
            // writing to a String cannot fail
            let _ = writeln!(
                text,
                "{}, {}, {}",
                number(term.shear / solid.instantaneous_shear),
                number(term.bulk / solid.instantaneous_bulk),
                number(term.relaxation_time)
            );
        }
        Ok(text)
    }

    /// Writes the ANSYS commands for material number `material`, to be read in `/PREP7`.
    ///
    /// # Errors
    /// [`CmodError::CardTerms`] for more than [`ANSYS_TERMS`] terms; the errors of
    /// [`Self::abaqus`].
    pub fn ansys(&self, material: u32, bulk: BulkBehaviour) -> Result<String, CmodError> {
        let solid = Isotropic::of(&self.law, self.ratio(bulk), bulk)?;
        check_terms("ANSYS", solid.terms.len(), ANSYS_TERMS)?;
        let mut text = format!(
            "! {}; units: m, kg, s, Pa; elastic constants are instantaneous\n{}MP,EX,{material},{}\nMP,PRXY,{material},{}\nMP,DENS,{material},{}\n",
            self.name,
            self.commented("!"),
            number(self.law.unrelaxed_modulus()),
            self.ratio(bulk),
            self.density,
        );
        let shear = |term: &isotropic::Term| term.shear / solid.instantaneous_shear;
        let compression = |term: &isotropic::Term| term.bulk / solid.instantaneous_bulk;
        let mut table = |option: &str, ratio: &dyn Fn(&isotropic::Term) -> f64| {
            let _ = writeln!(text, "TB,PRONY,{material},1,{},{option}", solid.terms.len());
            for (place, term) in solid.terms.iter().enumerate() {
                let _ = writeln!(
                    text,
                    "TBDATA,{},{},{}",
                    2 * place + 1,
                    number(ratio(term)),
                    number(term.relaxation_time)
                );
            }
        };
        table("SHEAR", &shear);
        if bulk == BulkBehaviour::ConstantPoissonRatio {
            table("BULK", &compression);
        }
        Ok(text)
    }

    /// Writes the LS-DYNA keyword for material number `material`, with [`BulkBehaviour::Elastic`].
    ///
    /// # Errors
    /// [`CmodError::CardTerms`] for more than [`LS_DYNA_TERMS`] terms, including the long-term
    /// modulus; the errors of [`Self::abaqus`].
    pub fn ls_dyna(&self, material: u32) -> Result<String, CmodError> {
        let solid = Isotropic::of(&self.law, self.instantaneous_ratio, BulkBehaviour::Elastic)?;
        check_terms("LS-DYNA", solid.terms.len() + 1, LS_DYNA_TERMS)?;
        let mut text = format!(
            "*MAT_GENERAL_VISCOELASTIC_TITLE\n{}\n$ units: m, kg, s, Pa\n{}$#     mid        ro      bulk       pcf        ef      tref         a         b\n{material:>10}{}{}{}\n$#    lcid        nt    bstart     tramp     lcidk       ntk   bstartk    trampk\n{}\n$#      gi     betai        ki    betaki\n",
            self.name,
            self.commented("$"),
            column(self.density),
            column(solid.instantaneous_bulk),
            column(0.0).repeat(5),
            format!("{:>10}", 0).repeat(8),
        );
        check_long_term(&solid)?;
        let zero = column(0.0).repeat(2);
        let long_term = (solid.long_term_shear(), 0.0);
        let terms = solid
            .terms
            .iter()
            .map(|t| (t.shear, t.relaxation_time.recip()));
        for (shear, rate) in std::iter::once(long_term).chain(terms) {
            let _ = writeln!(text, "{}{}{zero}", column(shear), column(rate));
        }
        Ok(text)
    }
}

/// Returns |E| at `omega` with its standard uncertainty, as text.
fn size_at(fit: &RheologicalFit, omega: f64) -> Result<String, CmodError> {
    let predicted = fit.prediction(omega)?;
    let size = predicted.modulus.norm();
    let Complex64 { re, im } = predicted.modulus / size;
    // d|E| = Re(conj(E) dE)/|E|
    let along = |c: [[f64; 2]; 2]| {
        let [[storage, mixed], [_, loss]] = c;
        re * re * storage + 2.0 * re * im * mixed + im * im * loss
    };
    let random = along(predicted.random_covariance);
    let common = (along(predicted.covariance) - random).max(0.0);
    let percent = |variance: f64| 100.0 * variance.sqrt() / size;
    Ok(format!(
        "|E| at {:.3e} Hz: {size:.4e} Pa +- {:.1e} % (random {:.1e} %, common {:.1e} %)",
        omega / std::f64::consts::TAU,
        percent(random + common),
        percent(random),
        percent(common),
    ))
}

/// Checks that the long-term shear modulus (the instantaneous shear modulus minus the terms) is
/// above 0 in spite of rounding.
fn check_long_term(solid: &Isotropic) -> Result<(), CmodError> {
    check_positive("long-term shear modulus [Pa]", solid.long_term_shear()).map(drop)
}

fn check_terms(program: &'static str, found: usize, most: usize) -> Result<(), CmodError> {
    if found <= most {
        Ok(())
    } else {
        Err(CmodError::CardTerms {
            program,
            found,
            most,
        })
    }
}

/// Writes the shortest digits that read back as the same number.
fn number(value: f64) -> String {
    format!("{value:e}")
}

/// Writes the number with all digits that fit into ten columns.
fn column(value: f64) -> String {
    let all = number(value);
    if all.len() <= 10 {
        return format!("{all:>10}");
    }
    (0..=8)
        .rev()
        .map(|digits| format!("{value:.digits$e}"))
        .find(|text| text.len() <= 10)
        .map_or_else(|| format!("{value:>10.0e}"), |text| format!("{text:>10}"))
}
