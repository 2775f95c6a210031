//! Readers must allocate memory for existing bytes only, whatever a header states.

use allocation_counter::measure;
use labio::format::MemoryLimit;

/// Allowed memory of a reader for buffers, in addition to that for the contents \[bytes\].
const BUFFERS: u64 = 4 << 20;

/// Allowed number of simultaneous copies of unpacked data: bytes, numbers, series, and the spare
/// capacity of a growing list.
const COPIES: u64 = 4;

/// Allowed memory per byte of an uncompressed file. A cell of a table, for example, takes memory
/// for its place, its number and copies.
const OF_A_BYTE: u64 = 256;

/// Calls `read` and checks the largest amount of memory that it allocated.
pub fn bounded<T>(bytes: &[u8], read: impl FnOnce() -> T) -> T {
    let mut result = None;
    let taken = measure(|| result = Some(read())).bytes_max;
    let is_deflated =
        bytes.starts_with(b"PK") || matches!(bytes.get(126..128), Some(b"IM" | b"MI"));
    let most = if is_deflated {
        COPIES * MemoryLimit::of_file(bytes.len()).bytes()
    } else {
        OF_A_BYTE * bytes.len() as u64
    };
    let most = BUFFERS + most;
    assert!(
        taken <= most,
        "{taken} bytes of memory for a file of {} bytes",
        bytes.len()
    );
    result.expect("it was read")
}
