//! Memory is taken for bytes that are there, whatever a header announces.

use allocation_counter::measure;

/// What a reader may take beside the contents: buffers.
const BUFFERS: u64 = 4 << 20;

/// What a byte of a file may become: a deflated one becomes at most 1032, each of which may be a number of a real and an
/// imaginary part, with a copy or two on the way.
const OF_A_DEFLATED_BYTE: u64 = 1032 * 16 * 3;

/// What a byte of a file becomes that is not deflated: a cell of a table, say, with its place, its number and its copies.
const OF_A_BYTE: u64 = 256;

/// Reads, and looks at how much memory was taken at most.
pub fn bounded<T>(bytes: &[u8], read: impl FnOnce() -> T) -> T {
    let mut result = None;
    let taken = measure(|| result = Some(read())).bytes_max;
    let is_deflated = bytes.starts_with(b"PK") || bytes.starts_with(b"MATLAB");
    let each = if is_deflated {
        OF_A_DEFLATED_BYTE
    } else {
        OF_A_BYTE
    };
    let most = BUFFERS + each * bytes.len() as u64;
    assert!(
        taken <= most,
        "{taken} bytes taken for a file of {}",
        bytes.len()
    );
    result.expect("it was read")
}
