//! Memory is taken for bytes that are there, whatever a header announces.

use allocation_counter::measure;
use labio::format::MemoryLimit;

/// What a reader may take beside the contents: buffers.
const BUFFERS: u64 = 4 << 20;

/// Copies of what is unpacked that there may be at a time: the bytes, the numbers and the series,
/// and the room of a list that grows.
const COPIES: u64 = 4;

/// Memory per byte of an uncompressed file: a cell of a table, say, with its place, its number and
/// its copies.
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
