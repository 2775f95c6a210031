//! Conversion of the values of a sheet to the type of the sheet, with a list of all mistakes.
//!
//! Serde stops at the first mistake. Here the mistake is stored, its place is filled with a value
//! of the right type, and the sheet is read again, until no new mistake is found. Unknown and
//! repeated fields do not stop a reading; they are noted as mistakes during the reading.

mod access;
mod fault;
mod filler;
mod reading;

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use serde::de::DeserializeOwned;

use self::fault::Fault;
use self::filler::Filler;
use self::reading::{At, Reading, read_value};
use super::language::Language;
use super::mistake::Mistake;
use super::quantity_text::moved;
use super::tree::Node;

/// Type name with which a quantity is deserialized from its text, so that an example can replace a
/// faulty quantity.
pub(super) const QUANTITY: &str = "$rodlab::sheet::Quantity";

/// Maximum number of listed mistakes.
const MOST_MISTAKES: usize = 20;

/// State of the repeated readings of a sheet, in which a filler replaces each mistake.
#[derive(Debug)]
struct Pass {
    language: Language,
    /// Fields for which a filler is read.
    filled: BTreeSet<String>,
    /// Names of the fields of the sheet itself.
    of_sheet: Cell<&'static [&'static str]>,
    /// Mistakes that did not stop the reading.
    noted: RefCell<Vec<Mistake>>,
    /// Statements of the sheet, in the order of its text.
    stated: RefCell<Vec<Statement>>,
    /// Random numbers for a draw of the sheet within its stated uncertainties.
    random: Option<RefCell<ChaCha8Rng>>,
}

/// A statement of a sheet: its place, such as `specimen.length`, and its value as written, except
/// that choices have the names of their variants.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Statement {
    pub(crate) name: String,
    pub(crate) value: String,
    /// Byte offset in `value` of its last part.
    last: usize,
}

impl Pass {
    fn of(language: Language, random: Option<ChaCha8Rng>) -> Self {
        Self {
            language,
            filled: BTreeSet::new(),
            of_sheet: Cell::new(&[]),
            noted: RefCell::default(),
            stated: RefCell::default(),
            random: random.map(RefCell::new),
        }
    }

    /// Notes a statement; if the previous one has the same place, appends `value` to it after
    /// `separator`.
    fn note(&self, name: String, separator: &str, value: &str) {
        let mut stated = self.stated.borrow_mut();
        match stated.last_mut() {
            Some(known) if known.name == name => {
                known.value.push_str(separator);
                known.last = known.value.len();
                known.value.push_str(value);
            }
            _ => stated.push(Statement {
                name,
                value: value.to_owned(),
                last: 0,
            }),
        }
    }

    /// Replaces the last noted part of a value by another name of the same value.
    fn note_again(&self, value: &str) {
        if let Some(known) = self.stated.borrow_mut().last_mut() {
            known.value.truncate(known.last);
            known.value.push_str(value);
        }
    }

    /// Returns a draw of the quantity `text` within its uncertainty; `None` for a text without an
    /// uncertainty, or if the sheet is not drawn.
    fn drawn(&self, text: &str) -> Option<String> {
        let mut random = self.random.as_ref()?.borrow_mut();
        moved(text, || random.sample(StandardNormal))
    }

    /// Returns true if a field below `field` is filled; the value of `field` is then not the value
    /// that the sheet states.
    fn is_filled_below(&self, field: &str) -> bool {
        let below = |filled: &String| {
            let rest = filled.strip_prefix(field);
            rest.is_some_and(|rest| field.is_empty() || rest.starts_with(['.', '[']))
        };
        self.filled.iter().any(below)
    }
}

/// Reads `root` as `T`, with all its statements.
///
/// # Errors
///
/// All mistakes, in the order of the text.
pub(super) fn read<T: DeserializeOwned>(
    language: Language,
    root: &Node,
) -> Result<(T, Vec<Statement>), Vec<Mistake>> {
    let mut pass = Pass::of(language, None);
    let mut found: Vec<Mistake> = Vec::new();
    loop {
        let start = Reading {
            node: root,
            at: &At::ROOT,
            pass: &pass,
        };
        let value = read_value(std::marker::PhantomData::<T>, start);
        if !found.is_empty() || value.is_err() {
            pass.stated.take();
        }
        for mistake in pass.noted.take() {
            if !found.contains(&mistake) {
                found.push(mistake);
            }
        }
        let fault = match value {
            Ok(value) if found.is_empty() => return Ok((value, pass.stated.take())),
            Ok(_) => break,
            Err(fault) => fault,
        };
        // a fault in a value that contains a filler may be due to the filler
        let is_own = fault.is_missing() || !pass.is_filled_below(fault.field());
        let spot = fault.spot();
        if is_own && !pass.filled.contains(&spot) {
            found.push(fault.into_mistake(language));
        }
        if found.len() >= MOST_MISTAKES || !fill(&mut pass.filled, &spot) {
            break;
        }
    }
    found.sort_by_key(|mistake| mistake.place.start);
    Err(found)
}

/// Reads `root` as `T`, with every quantity drawn within its stated uncertainty.
///
/// # Errors
///
/// The first mistake, such as a length that is drawn below 0.
pub(super) fn read_drawn<T: DeserializeOwned>(
    language: Language,
    root: &Node,
    random: ChaCha8Rng,
) -> Result<T, Vec<Mistake>> {
    let pass = Pass::of(language, Some(random));
    let start = Reading {
        node: root,
        at: &At::ROOT,
        pass: &pass,
    };
    read_value(std::marker::PhantomData::<T>, start)
        .map_err(|fault| vec![fault.into_mistake(language)])
}

/// Adds `spot`, or the innermost field around it that is not filled yet; returns false if all are
/// filled.
fn fill(filled: &mut BTreeSet<String>, mut spot: &str) -> bool {
    while !spot.is_empty() {
        if filled.insert(spot.to_owned()) {
            return true;
        }
        let outer = spot.rfind(['.', '[']).unwrap_or(0);
        spot = spot.get(..outer).unwrap_or_default();
    }
    false
}
