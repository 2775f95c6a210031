//! Real numbers as read and written by Fortran's `E` edit descriptor: `E13.5` and `E20.12`.

mod reading;
mod writing;

pub(super) use reading::{half_unit, parse};
pub(super) use writing::{compact, push};

fn digit(value: u64) -> u8 {
    // `value` is a remainder modulo ten
    b"0123456789"
        .get(usize::try_from(value).unwrap_or(0))
        .copied()
        .unwrap_or(b'0')
}
