//! Files of any format: the format is recognised from the content.

use labio::format;
use rodlab::inspect::inspect_bytes;

use super::super::records::prints;
use super::super::records::reader::both_manners;

/// Recognises the format, reads the file and inspects it.
pub fn recognition(bytes: &[u8]) {
    let known = format::recognise(bytes).map(format::Reader::name);
    let found = both_manners(bytes, |strictness| {
        format::read_bytes_with(bytes, strictness)
    });
    if let Some(found) = found {
        assert_eq!(Some(found.format), known);
    }
    match inspect_bytes(bytes, "input") {
        Ok(inspection) => {
            assert_eq!(Some(inspection.format.as_str()), known);
            assert!(!inspection.to_text().is_empty());
        }
        Err(error) => prints(&error),
    }
}
