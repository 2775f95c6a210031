//! Memory is allocated for existing bytes only, whatever a header states.

use allocation_counter::measure;
use labio::format::MemoryLimit;

/// Memory of a reader in addition to the contents: buffers.
const BUFFERS: u64 = 4 << 20;

/// Simultaneous copies of unpacked data: bytes, numbers, series, and the reserve of a growing list.
const COPIES: u64 = 4;

/// Memory per byte of an uncompressed file, for example a cell of a table, with its place, number
/// and copies.
const OF_A_BYTE: u64 = 256;

/// Reads, and looks at how much memory was taken at most.
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
        "{taken} bytes taken for a file of {}",
        bytes.len()
    );
    result.expect("it was read")
}
