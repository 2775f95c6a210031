//! Tektronix traces with a text preamble (`.isf`).
//!
//! A recorded number n represents the sample (n - `YOFF`) `YMULT` + `YZERO`; the time of sample i
//! is `XZERO` + (i - `PT_OFF`) `XINCR`.

use super::{Trace, contents};
use crate::error::{malformed, truncated};
use crate::format::number_type::NumberType;
use crate::format::text::quoted;
use crate::format::{Reader, Strictness};
use crate::{Contents, LabioError, Place};

const FORMAT: &str = "isf";

/// Number of bytes at the start of a file within which the preamble begins.
const LEAD: usize = 64;

/// Tektronix traces with a text preamble (`.isf`); see the [module](super).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TektronixIsf;

impl Reader for TektronixIsf {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        let lead = head.get(..head.len().min(LEAD)).unwrap_or(&[]);
        let lead = lead.trim_ascii_start();
        let begins = [&b":WFMP"[..], b":WFMO", b"WFMP", b"BYT_N"];
        begins.into_iter().any(|begin| lead.starts_with(begin))
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        let (preamble, curve, at) = parts(bytes)?;
        let read = Preamble { text: &preamble };
        let form = read.word("PT_F", "Y");
        if !form.eq_ignore_ascii_case("Y") {
            let expected = "one value for each time (Y)";
            return Err(wrong(0, "form of the points", quoted(&form), expected));
        }
        let number = |key, default| read.number(key, default);
        let (x_step, x_start, x_first) = (
            number("XIN", None)?,
            number("XZE", Some(0.0))?,
            number("PT_O", Some(0.0))?,
        );
        let (y_step, y_zero, y_first) = (
            number("YMU", None)?,
            number("YZE", Some(0.0))?,
            number("YOF", Some(0.0))?,
        );
        let count = number("NR_P", Some(f64::NAN))?;
        let (values, cut) = if read
            .word("ENC", "BIN")
            .to_ascii_uppercase()
            .starts_with("ASC")
        {
            (read_text(curve, at)?, None)
        } else {
            block(&read, curve, at)?
        };
        if let (Some(missing_bytes), Strictness::Strict) = (cut, strictness) {
            let found = format!("{missing_bytes} bytes missing");
            return Err(wrong(at, "curve", found, "all samples"));
        }
        if count.is_finite() && cut.is_none() && (count - values.len() as f64).abs() > 0.5 {
            let found = format!("{} samples", values.len());
            return Err(wrong(
                at,
                "curve",
                found,
                &format!("{count}, as stated by NR_PT"),
            ));
        }
        let trace = Trace {
            name: read
                .word("WFI", "")
                .split(',')
                .next()
                .unwrap_or("")
                .trim()
                .to_owned(),
            start: x_start - x_first * x_step,
            step: x_step,
            time_unit: read.word("XUN", "s"),
            values: values
                .iter()
                .map(|n| (n - y_first) * y_step + y_zero)
                .collect(),
            unit: read.word("YUN", ""),
            properties: vec![("preamble".to_owned(), preamble.trim().to_owned())],
        };
        let cut = cut.map(|missing_bytes| truncated(FORMAT, missing_bytes));
        Ok(contents(FORMAT, vec![trace], cut))
    }
}

/// Returns the preamble, the curve, and the offset at which the curve begins.
fn parts(bytes: &[u8]) -> Result<(String, &[u8], usize), LabioError> {
    let at = bytes
        .windows(5)
        .position(|window| {
            window.eq_ignore_ascii_case(b"CURV ") || window.eq_ignore_ascii_case(b"CURVE")
        })
        .ok_or_else(|| wrong(0, "curve", "none".to_owned(), "`:CURVE` after the preamble"))?;
    let (head, rest) = bytes.split_at(at);
    let preamble = head.iter().map(|&byte| char::from(byte)).collect();
    let keyword = rest
        .iter()
        .position(|byte| !byte.is_ascii_alphabetic())
        .unwrap_or(rest.len());
    let (_, curve) = rest.split_at(keyword);
    Ok((preamble, curve, at + keyword))
}

/// Returns the samples of a binary curve, and the number of missing bytes.
fn block(
    preamble: &Preamble<'_>,
    curve: &[u8],
    at: usize,
) -> Result<(Vec<f64>, Option<usize>), LabioError> {
    let is_wide = match preamble.number("BYT_N", Some(1.0))? {
        1.0 => false,
        2.0 => true,
        other => {
            let expected = "integers of 1 or 2 bytes";
            return Err(wrong(0, "BYT_NR", other.to_string(), expected));
        }
    };
    let form = preamble.word("BN_F", "RI").to_ascii_uppercase();
    let kind = match (form.as_str(), is_wide) {
        ("RI", false) => NumberType::I8,
        ("RI", true) => NumberType::I16,
        ("RP", false) => NumberType::U8,
        ("RP", true) => NumberType::U16,
        _ => return Err(wrong(0, "BN_FMT", quoted(&form), "RI or RP")),
    };
    let big_endian = !preamble.word("BYT_O", "MSB").eq_ignore_ascii_case("LSB");
    let begin = curve.iter().position(|&byte| byte == b'#');
    let header = begin.and_then(|begin| {
        let rest = curve.get(begin + 1..)?;
        let (&digits, rest) = rest.split_first()?;
        let n_digits = usize::from(digits.checked_sub(b'0').filter(|n| (1..=9).contains(n))?);
        let (length, rest) = rest.split_at_checked(n_digits)?;
        let length: usize = std::str::from_utf8(length).ok()?.parse().ok()?;
        Some((length, rest))
    });
    let Some((length, rest)) = header else {
        let expected = "a block such as #520000";
        return Err(wrong(
            at,
            "curve",
            "without a block header".to_owned(),
            expected,
        ));
    };
    let there = rest.len().min(length);
    let missing = length - there;
    let values = kind.numbers(rest.get(..there).unwrap_or(&[]), big_endian);
    Ok((values, (missing > 0).then_some(missing)))
}

/// Reads samples written as text, separated by commas.
fn read_text(curve: &[u8], at: usize) -> Result<Vec<f64>, LabioError> {
    let text = String::from_utf8_lossy(curve);
    let texts = text.trim().trim_end_matches(';').split(',');
    texts
        .map(|one| {
            let value = one
                .trim()
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite());
            value.ok_or_else(|| wrong(at, "curve", quoted(one), "a number"))
        })
        .collect()
}

/// Fields `KEY value` separated by semicolons; keys may be abbreviated and follow a path.
struct Preamble<'a> {
    text: &'a str,
}

impl Preamble<'_> {
    /// Returns the value of the first key that begins with `key`.
    fn value(&self, key: &str) -> Option<&str> {
        let mut quoted = false;
        let fields = self.text.split(move |c: char| {
            quoted ^= c == '"';
            c == ';' && !quoted
        });
        fields.into_iter().find_map(|field| {
            let (name, value) = field.trim().split_once(char::is_whitespace)?;
            let own = name.rsplit(':').next().unwrap_or(name);
            let begins = own.get(..key.len())?.eq_ignore_ascii_case(key);
            begins.then_some(value.trim())
        })
    }

    fn word(&self, key: &str, default: &str) -> String {
        let value = self.value(key).unwrap_or(default);
        value.trim_matches('"').to_owned()
    }

    /// Returns a finite number; `default` if the key is missing.
    fn number(&self, key: &str, default: Option<f64>) -> Result<f64, LabioError> {
        let Some(text) = self.value(key) else {
            return default
                .ok_or_else(|| wrong(0, &format!("{key}.."), "missing".to_owned(), "a number"));
        };
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| wrong(0, &format!("{key}.."), quoted(text), "a number"))
    }
}

fn wrong(at: usize, field: &str, found: String, expected: &str) -> LabioError {
    malformed(FORMAT, Place::Byte(at as u64), field, found, expected)
}
