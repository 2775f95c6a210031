//! Real numbers as Fortran's `E` edit descriptor reads and writes them: `E13.5` and `E20.12`.

mod reading;
mod writing;

pub(super) use reading::{half_unit, parse};
pub(super) use writing::{compact, push};

fn digit(value: u64) -> u8 {
    // a remainder of ten
    b"0123456789"
        .get(usize::try_from(value).unwrap_or(0))
        .copied()
        .unwrap_or(b'0')
}
