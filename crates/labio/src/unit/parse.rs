//! The grammar of compound units.
//!
//! ```text
//! product = factor { ("*" | "." | "·" | blank | "/") factor }
//! factor  = ( symbol | "1" | "(" product ")" ) [ exponent ]
//! exponent = [ "^" | "**" ] [ "-" ] digit | superscript digit
//! ```

use std::iter::Peekable;
use std::str::Chars;

use super::symbol::{self, Definition, G};
use crate::LabioError;

/// Greatest length of the text of a unit; a longer text is a comment in the wrong column.
const LONGEST: usize = 64;
/// Largest depth of nested brackets; units in use have at most two.
const DEEPEST: usize = 8;

/// The reason why a text is not a unit: the token and its fault.
#[derive(Debug)]
struct Fault {
    token: String,
    reason: &'static str,
}

fn fault<T>(token: impl Into<String>, reason: &'static str) -> Result<T, Fault> {
    Err(Fault {
        token: token.into(),
        reason,
    })
}

/// Parses the whole of `text`, which has no blanks around it; the parameter `g` is the meaning of
/// the symbol `g`.
pub(super) fn parse(text: &str, g: G) -> Result<Definition, LabioError> {
    let parsed = if text.chars().count() > LONGEST {
        let start: String = text.chars().take(16).collect();
        fault(start, "begins a text that is longer than any unit")
    } else if text == "-" || text == "dimensionless" {
        Ok(Definition::NUMBER)
    } else {
        whole(text, g)
    };
    parsed.map_err(|Fault { token, reason }| LabioError::UnknownUnit {
        found: text.chars().take(LONGEST).collect(),
        token,
        reason,
    })
}

fn whole(text: &str, g: G) -> Result<Definition, Fault> {
    // an offset is meaningful only if the unit is alone
    if let Some(alone) = symbol::find(text, g) {
        return Ok(alone);
    }
    let mut scanner = Scanner {
        chars: text.chars().peekable(),
        g,
    };
    let parsed = scanner.product(0)?;
    if let Some(&rest) = scanner.chars.peek() {
        return fault(rest, "does not belong there");
    }
    if !parsed.ratio.is_usable() {
        return fault(text, "has a scale beyond the range of numbers");
    }
    Ok(parsed)
}

/// The operator between two factors.
#[derive(Clone, Copy, PartialEq)]
enum Operator {
    Times,
    Over,
}

struct Scanner<'a> {
    chars: Peekable<Chars<'a>>,
    g: G,
}

impl Scanner<'_> {
    fn product(&mut self, depth: usize) -> Result<Definition, Fault> {
        if depth > DEEPEST {
            return fault("(", "is nested too deeply");
        }
        let mut product = Definition::NUMBER;
        let mut operator = Operator::Times;
        let mut divided = false;
        loop {
            let (factor, exponent, token) = self.factor(depth)?;
            let signed = if operator == Operator::Over {
                -exponent
            } else {
                exponent
            };
            let Some(next) = product.times(factor, signed) else {
                return fault(token, "takes the exponents out of range");
            };
            product = next;
            operator = match self.operator()? {
                None => return Ok(product),
                // a/b*c is ambiguous: a*c/b or a/(b*c)
                Some(Operator::Times) if divided => {
                    return fault("/", "needs brackets around the product after it");
                }
                Some(next) => next,
            };
            divided |= operator == Operator::Over;
        }
    }

    /// Parses a symbol or a bracket with its exponent and, for messages, its text.
    fn factor(&mut self, depth: usize) -> Result<(Definition, i8, String), Fault> {
        self.skip_blanks();
        let (base, token) = match self.chars.peek().copied() {
            None => return fault("", "ends where a symbol is expected"),
            Some('(') => {
                self.chars.next();
                let inner = self.product(depth + 1)?;
                self.skip_blanks();
                if self.chars.next() != Some(')') {
                    return fault("(", "is not closed");
                }
                (inner, "(...)".to_owned())
            }
            Some('1') => {
                self.chars.next();
                if let Some(&digit) = self.chars.peek()
                    && (digit.is_ascii_digit() || digit == '.')
                {
                    return fault(
                        digit,
                        "makes a factor other than 1, which a unit cannot have",
                    );
                }
                (Definition::NUMBER, "1".to_owned())
            }
            Some(_) => self.symbol()?,
        };
        let exponent = self.exponent()?;
        Ok((base, exponent, token))
    }

    fn symbol(&mut self) -> Result<(Definition, String), Fault> {
        let mut token = String::new();
        while let Some(&c) = self.chars.peek()
            && (c.is_alphabetic() || matches!(c, '%' | '°' | '\u{b5}' | '\u{2126}' | '_'))
        {
            token.push(c);
            self.chars.next();
        }
        if token.is_empty() {
            let found: String = self.chars.next().into_iter().collect();
            let reason = if found == "," {
                "is not a decimal mark: write a point"
            } else {
                "occurs where a symbol is expected"
            };
            return fault(found, reason);
        }
        match symbol::find(&token, self.g) {
            Some(found) if found.offset == 0.0 => Ok((found, token)),
            Some(_) => fault(
                token,
                "has a shifted zero and cannot be part of a compound unit",
            ),
            None => match token.as_str() {
                "lb" | "lbs" | "Pounds" => {
                    fault(token, "may be a mass or a force, expected lbm or lbf")
                }
                "dB" => fault(token, "is a logarithm, not a unit"),
                _ => fault(token, "is not among the known symbols"),
            },
        }
    }

    fn exponent(&mut self) -> Result<i8, Fault> {
        let marked = self.raising_mark();
        let sign = match self.chars.peek() {
            Some('-' | '⁻' | '\u{2212}') => {
                self.chars.next();
                -1
            }
            Some('+') if marked => {
                self.chars.next();
                1
            }
            _ => 0,
        };
        let digit = self.chars.peek().copied().and_then(digit_of);
        match digit {
            Some(value) => {
                self.chars.next();
                if let Some(&next) = self.chars.peek()
                    && (digit_of(next).is_some() || next == '.' && self.is_decimal())
                {
                    return fault(
                        next,
                        "makes an exponent that is not a whole number of one digit",
                    );
                }
                Ok(if sign < 0 { -value } else { value })
            }
            None if marked || sign != 0 => fault(
                self.chars.peek().map(char::to_string).unwrap_or_default(),
                "occurs where an exponent is expected",
            ),
            None => Ok(1),
        }
    }

    /// Consumes `^` or `**` and the blanks before it, or nothing: a single asterisk means
    /// multiplication.
    fn raising_mark(&mut self) -> bool {
        let mut ahead = self.chars.clone();
        while ahead.next_if(|c| c.is_whitespace()).is_some() {}
        let marked = match ahead.next() {
            Some('^') => true,
            Some('*') => ahead.next() == Some('*'),
            _ => false,
        };
        if marked {
            self.chars = ahead;
        }
        marked
    }

    /// Returns true if a point is followed by a digit: `m^2.5` has an exponent, `m^2.s` is a
    /// product.
    fn is_decimal(&self) -> bool {
        let mut ahead = self.chars.clone();
        ahead.next();
        ahead.next().is_some_and(|c| c.is_ascii_digit())
    }

    fn operator(&mut self) -> Result<Option<Operator>, Fault> {
        let blanks = self.skip_blanks();
        match self.chars.peek() {
            None | Some(')') => Ok(None),
            Some('/') => {
                self.chars.next();
                Ok(Some(Operator::Over))
            }
            Some('*' | '.' | '·' | '\u{22c5}') => {
                self.chars.next();
                Ok(Some(Operator::Times))
            }
            Some('(') => Ok(Some(Operator::Times)),
            Some(_) if blanks => Ok(Some(Operator::Times)),
            Some(&c) => fault(c, "does not belong there"),
        }
    }

    fn skip_blanks(&mut self) -> bool {
        let mut any = false;
        while self.chars.next_if(|c| c.is_whitespace()).is_some() {
            any = true;
        }
        any
    }
}

/// Returns the value of an ordinary or a superscript digit.
fn digit_of(c: char) -> Option<i8> {
    let raised = "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().zip(0..).find(|(digit, _)| *digit == c);
    raised
        .map(|(_, value)| value)
        .or_else(|| i8::try_from(c.to_digit(10)?).ok())
}
