//! Quantity of a sheet that takes no uncertainty, with the reason for this.

use std::fmt;
use std::marker::PhantomData;
use std::str::FromStr;

use serde::de::{Deserialize, Deserializer};

use super::kind::Kind;
use super::quantity_text::value_and_uncertainty;
use super::stated::{Written, from_text, parsed};

/// Advice, appended to another sentence, for a sheet with an uncertainty that its job cannot
/// propagate.
pub(crate) const ADVICE: &str = ". To see the effect of the uncertainty, run a second sheet with the value increased by one standard \
                                 uncertainty: the results differ by the error that it causes";

/// Reason why a field takes no uncertainty.
pub trait Reason {
    /// Completes a message that begins with the text found, "`10 kHz ± 1 %`".
    const PROBLEM: &'static str;
    /// Suggested alternative, appended to the expected text.
    const ADVICE: &'static str;
}

/// Reason: the value is chosen, not measured. Examples are a limit, a band, a window, a threshold,
/// a step, a level, a noise level, and the true values of a virtual test.
#[derive(Debug, Clone, Copy)]
pub enum ByDefinition {}

impl Reason for ByDefinition {
    const PROBLEM: &'static str =
        "has an uncertainty, but this field is exact by definition: it is chosen, not measured";
    const ADVICE: &'static str = "";
}

/// Reason: the value is measured, but the job does not propagate its uncertainty to the result.
#[derive(Debug, Clone, Copy)]
pub enum NoWay {}

impl Reason for NoWay {
    const PROBLEM: &'static str =
        "has an uncertainty, which this job cannot propagate to its result yet";
    const ADVICE: &'static str = ADVICE;
}

/// A quantity of a sheet, in SI units, without uncertainty. A text with a `±` other than `± 0` is
/// refused at its place in the sheet, for the reason `R`.
///
/// # Examples
///
/// ```
/// use rodlab::sheet::{Exact, Frequency, NotFollowed, Pressure};
///
/// let limit: Exact<Frequency> = "10 kHz".parse()?;
/// assert_eq!(limit.si(), 10e3);
/// let error = "10 kHz ± 1 %".parse::<Exact<Frequency>>().unwrap_err();
/// assert!(error.to_string().contains("exact by definition"), "{error}");
/// let error = "2.6 GPa ± 1 %".parse::<NotFollowed<Pressure>>().unwrap_err();
/// assert!(error.to_string().contains("cannot propagate"), "{error}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Exact<K, R = ByDefinition> {
    si: f64,
    text: String,
    kind: PhantomData<(K, R)>,
}

/// A measured quantity whose uncertainty the job does not propagate to its result. A sheet with an
/// uncertainty of this quantity is refused.
pub type NotFollowed<K> = Exact<K, NoWay>;

impl<K, R> Exact<K, R> {
    /// Returns the value in SI units.
    #[must_use]
    pub fn si(&self) -> f64 {
        self.si
    }
}

impl<K, R> fmt::Debug for Exact<K, R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.text)
    }
}

/// Text of the quantity as written in the sheet.
impl<K, R> fmt::Display for Exact<K, R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl<K: Kind, R: Reason> FromStr for Exact<K, R> {
    type Err = Written;

    fn from_str(text: &str) -> Result<Self, Written> {
        let wrong = |problem: String, without: &str| Written {
            text: text.to_owned(),
            problem,
            expected: format!("{}, such as {}{without}", K::NAME, K::EXAMPLE),
        };
        let (quantity, uncertainty) = value_and_uncertainty(text);
        let si = parsed::<K>(&quantity)
            .map_err(|problem| wrong(problem, ""))?
            .value;
        if uncertainty.is_some()
            && !parsed::<K>(text).is_ok_and(|stated| stated.uncertainty() == 0.0)
        {
            let without = format!(", without ±{}", R::ADVICE);
            return Err(wrong(R::PROBLEM.to_owned(), &without));
        }
        Ok(Self {
            si,
            text: text.trim().to_owned(),
            kind: PhantomData,
        })
    }
}

impl<'de, K: Kind, R: Reason> Deserialize<'de> for Exact<K, R> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        from_text::<Self, K, D>(deserializer)
    }
}
