//! Text tables whose last line may be incomplete.
//!
//! Files of all other formats state their length, and their readers refuse a file that ends too
//! early. A text table does not state its length: if it was cut at the end of a line, it is a
//! shorter table; if it was cut within its last number, that number is wrong. Only the second case
//! is detected.

/// Returns a warning about `bytes` in `format` if the last line has no line ending; `name` is the
/// name of the file.
pub(crate) fn warning(bytes: &[u8], format: &str, name: &str) -> Option<String> {
    let is_text = labio::format::reader(format).is_some_and(|reader| !reader.states_length());
    // a line ends with LF or CR, which are two bytes in UTF-16
    let ended = match bytes {
        [.., b'\n' | b'\r'] | [.., b'\n' | b'\r', 0] => true,
        bytes => bytes.is_empty(),
    };
    (is_text && !ended).then(|| {
        format!("the last line of {name} has no line ending: if the file was cut short, its last number may be incomplete")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_table_in_text_without_an_end_is_suspected() {
        assert!(warning(b"0;1\n1;2.", "csv", "hit.csv").is_some());
        for ended in [&b"0;1\n"[..], b"0;1\r", b"0\n\0", b""] {
            assert!(warning(ended, "csv", "hit.csv").is_none(), "{ended:?}");
        }
        assert!(warning(b"\x93NUMPY", "npy", "hit.npy").is_none());
    }
}
