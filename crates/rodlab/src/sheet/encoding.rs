//! Text of a sheet, and errors for files that are not sheets: text in another encoding, and
//! recordings.

use std::path::Path;

use labio::format;

use super::SheetError;
use crate::RodlabError;

/// Byte-order mark, which some editors write at the beginning of a text.
pub(super) const MARK: char = '\u{feff}';

/// Name of the format of text tables, the only format without a signature.
const TABLE: &str = "csv";

/// Returns the text of the sheet at `path`, which must be UTF-8.
pub(super) fn text_of(path: &Path, bytes: &[u8]) -> Result<String, RodlabError> {
    if let Some(reader) = format::recognise(bytes).filter(|reader| reader.name() != TABLE) {
        return Err(no_sheet(path, reader.name()));
    }
    if let Some(found) = wide(bytes) {
        return Err(RodlabError::Encoding {
            path: path.to_path_buf(),
            line: 1,
            column: 1,
            found: found.to_owned(),
        });
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(error) => Err(not_utf8(path, bytes, error.valid_up_to())),
    }
}

/// Returns the error for a text that is not a sheet. This is [`RodlabError::NoSheet`] if a table of
/// numbers shows that the text is a recording; otherwise it is `error`.
pub(super) fn or_recording(path: &Path, bytes: &[u8], error: Box<SheetError>) -> RodlabError {
    match format::recognise(bytes) {
        Some(reader) => no_sheet(path, reader.name()),
        None => error.into(),
    }
}

fn no_sheet(path: &Path, format: &str) -> RodlabError {
    RodlabError::NoSheet {
        path: path.to_path_buf(),
        format: format.to_uppercase(),
        job: "JOB",
    }
}

/// Returns the name of an encoding with several bytes per character. It is recognised by its
/// byte-order mark or by a zero byte next to the first letter.
fn wide(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => {
            Some("UTF-32, judging by its byte-order mark")
        }
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Some("UTF-16, judging by its byte-order mark"),
        [letter, 0, ..] | [0, letter, ..] if letter.is_ascii_graphic() => {
            Some("UTF-16, judging by a zero byte next to the first letter")
        }
        _ => None,
    }
}

/// Returns the error for the first byte that is not UTF-8, with the character that this byte
/// represents in Latin-1.
fn not_utf8(path: &Path, bytes: &[u8], at: usize) -> RodlabError {
    let before = String::from_utf8_lossy(bytes.get(..at).unwrap_or_default());
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
    let found = bytes.get(at).map_or_else(String::new, |&byte| {
        // the bytes 0x80 to 0x9f are control characters in Latin-1, but symbols in Windows-1252
        let meant = if byte >= 0xa0 {
            format!(
                ", `{}` in Latin-1 (ISO 8859-1, Windows-1252)",
                char::from(byte)
            )
        } else {
            ", not a UTF-8 character".to_owned()
        };
        format!("the byte {byte:#04x}{meant}")
    });
    RodlabError::Encoding {
        path: path.to_path_buf(),
        line,
        column,
        found,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::parse;
    use crate::sheet::Language;
    use crate::templates::JobName;

    fn said(name: &str, bytes: &[u8]) -> String {
        let path = Path::new(name);
        let text = text_of(path, bytes);
        let parsed = text
            .and_then(|text| parse(path, &text).map_err(|error| or_recording(path, bytes, error)));
        parsed.unwrap_err().to_string()
    }

    #[test]
    fn r20_what_is_no_sheet_is_named() {
        let sheet = "// length 799 mm\nForce(title: \"\u{e5}\u{b1}\")";
        let latin: Vec<u8> = sheet
            .chars()
            .map(|c| u8::try_from(u32::from(c)).unwrap())
            .collect();
        let wide = |mark: bool| -> Vec<u8> {
            let mark = mark.then_some(MARK).into_iter();
            let text: String = mark.chain(sheet.chars()).collect();
            text.encode_utf16().flat_map(u16::to_le_bytes).collect()
        };
        let mut npy = b"\x93NUMPY\x01\0\x76\0".to_vec();
        npy.extend(b"{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }");
        let all = [
            said("latin.ron", &latin),
            said("marked.ron", &wide(true)),
            said("unmarked.ron", &wide(false)),
            said("hits.npy", &npy),
            said("hits.csv", b"time [s],force [N]\n0,1\n1,2\n2,3\n"),
            said("empty.ron", b""),
            said("text.ron", b"Dear all"),
        ];
        insta::assert_snapshot!(all.join("\n"), @r#"
        latin.ron:2:15: found the byte 0xe5, `å` in Latin-1 (ISO 8859-1, Windows-1252), expected UTF-8 text: save the sheet as UTF-8
        marked.ron:1:1: found UTF-16, judging by its byte-order mark, expected UTF-8 text: save the sheet as UTF-8
        unmarked.ron:1:1: found UTF-16, judging by a zero byte next to the first letter, expected UTF-8 text: save the sheet as UTF-8
        hits.npy is a file of data (NPY), expected a test sheet; `rodlab init JOB` writes a sheet
        hits.csv is a file of data (CSV), expected a test sheet; `rodlab init JOB` writes a sheet
        empty.ron:1:1: not the beginning of a test sheet, which in TOML is a line such as `job = "modulus"`, in RON a name such as `Modulus(`
        text.ron:1:1: not the beginning of a test sheet, which in TOML is a line such as `job = "modulus"`, in RON a name such as `Modulus(`
        "#);
    }

    #[test]
    fn r20_a_byte_order_mark_is_passed_over() {
        let path = Path::new("sheet.ron");
        for (job, language) in JobName::ALL
            .into_iter()
            .flat_map(|job| [Language::Toml, Language::Ron].map(|language| (job, language)))
        {
            let marked = format!("{MARK}{}", job.template(language));
            let text = text_of(path, marked.as_bytes()).unwrap();
            assert_eq!(parse(path, &text).unwrap().name(), job.name());
            // a sheet must not be recognised as a recording; otherwise its mistakes would not be
            // reported
            assert!(format::recognise(marked.as_bytes()).is_none());
        }
    }
}
