//! Limit of the memory that a reader may allocate for packed contents.

use crate::{LabioError, Ordinate, Place, Series};

/// Limit of the memory that the contents of a packed or nested file may take.
///
/// Packed contents may need far more memory than the file: deflate compresses up to a thousand
/// bytes to one, and each of the many small arrays that fit into a MATLAB file becomes a series
/// with a name. The readers of such formats, for example [`mat5`](super::mat5) and
/// [`npz`](super::npz), count the memory of the contents before they allocate it, and reject a file
/// that needs more than the limit with [`LabioError::MemoryLimit`], even in a tolerant reading. By
/// default the limit is [`Self::OF_ANY_FILE`] plus [`Self::OF_A_BYTE`] bytes for every byte of the
/// file, at most [`Self::MOST`]; packing shrinks records of measurements to a half or a third.
///
/// # Examples
///
/// ```
/// use labio::format::{MemoryLimit, Strictness, npz};
///
/// # fn main() -> Result<(), labio::LabioError> {
/// # let mut bytes = Vec::new();
/// # use labio::format::Writer;
/// # let mut contents = labio::Contents::of_format("computed");
/// # contents.properties.push(("specimen".to_owned(), "rod 3".to_owned()));
/// # npz::Npz.write(&contents, &mut bytes)?;
/// let limit = MemoryLimit::new(32 << 30);
/// let contents = npz::read_within(&bytes, Strictness::Strict, limit)?;
/// # assert_eq!(contents.properties.len(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemoryLimit {
    bytes: u64,
}

impl MemoryLimit {
    /// Bytes that the contents of any file may take by default: 256 MiB.
    pub const OF_ANY_FILE: u64 = 256 << 20;
    /// Bytes that the contents may take by default for every byte of the file, in addition to
    /// [`Self::OF_ANY_FILE`].
    pub const OF_A_BYTE: u64 = 64;
    /// Upper bound of the default limit: 16 GiB.
    pub const MOST: u64 = 16 << 30;

    /// Creates a limit of `bytes`, whatever the length of the file.
    #[must_use]
    pub fn new(bytes: u64) -> Self {
        Self { bytes }
    }

    /// The default limit for a file of `n_bytes`.
    #[must_use]
    pub fn of_file(n_bytes: usize) -> Self {
        let for_bytes = u64::try_from(n_bytes).ok().and_then(|n| {
            n.checked_mul(Self::OF_A_BYTE)?
                .checked_add(Self::OF_ANY_FILE)
        });
        let bytes = for_bytes.map_or(Self::MOST, |bytes| bytes.min(Self::MOST));
        Self::new(bytes)
    }

    /// The limit in bytes.
    #[must_use]
    pub fn bytes(self) -> u64 {
        self.bytes
    }
}

/// Memory used so far while a file is read.
#[derive(Debug)]
pub(super) struct Budget {
    format: &'static str,
    limit: MemoryLimit,
    taken: u64,
}

/// Memory of a text in addition to its bytes: its entry in a list and the smallest allocation.
const OF_A_TEXT: usize = size_of::<String>() + 16;

impl Budget {
    pub(super) fn new(format: &'static str, limit: MemoryLimit) -> Self {
        Self {
            format,
            limit,
            taken: 0,
        }
    }

    /// Counts `count` items of `each` bytes, or returns an error if they are too many.
    pub(super) fn take(
        &mut self,
        count: usize,
        each: usize,
        place: Place,
        what: &str,
    ) -> Result<(), LabioError> {
        let bytes = (count as u64).saturating_mul(each as u64);
        let needed = self.taken.saturating_add(bytes);
        if needed > self.limit.bytes {
            return Err(LabioError::MemoryLimit {
                format: self.format,
                place,
                what: super::text::quoted(what),
                needed,
                limit: self.limit.bytes,
            });
        }
        self.taken = needed;
        Ok(())
    }

    /// Subtracts memory that was needed temporarily.
    pub(super) fn give_back(&mut self, bytes: usize) {
        self.taken = self.taken.saturating_sub(bytes as u64);
    }

    /// Counts a text of `n_bytes`.
    pub(super) fn take_text(
        &mut self,
        n_bytes: usize,
        place: Place,
        what: &str,
    ) -> Result<(), LabioError> {
        self.take(1, n_bytes.saturating_add(OF_A_TEXT), place, what)
    }

    /// Counts a property.
    pub(super) fn take_property(
        &mut self,
        key: &str,
        value: &str,
        place: Place,
    ) -> Result<(), LabioError> {
        self.take_text(key.len(), place, key)?;
        self.take_text(value.len(), place, key)
    }

    /// Counts a series.
    pub(super) fn take_series(&mut self, series: &Series, place: Place) -> Result<(), LabioError> {
        let each = match series.ordinate {
            Ordinate::Real(_) => 8,
            Ordinate::Complex(_) => 16,
        };
        let name = &series.name;
        self.take(series.ordinate.len(), each, place, name)?;
        let labels = series.abscissa_axis.label.len();
        self.take(
            1,
            size_of::<Series>() + name.len() + labels + 32,
            place,
            name,
        )?;
        for (key, value) in &series.properties {
            self.take_property(key, value, place)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_limit_grows_with_the_file_up_to_its_end() {
        assert_eq!(MemoryLimit::of_file(0).bytes(), 256 << 20);
        assert_eq!(
            MemoryLimit::of_file(1 << 20).bytes(),
            (256 << 20) + (64 << 20)
        );
        assert_eq!(MemoryLimit::of_file(usize::MAX).bytes(), 16 << 30);
    }

    #[test]
    fn what_is_too_much_says_how_much() {
        let mut budget = Budget::new("mat5", MemoryLimit::new(1000));
        budget.take(100, 8, Place::Byte(8), "a").unwrap();
        let error = budget.take(26, 8, Place::Byte(900), "b").unwrap_err();
        assert_eq!(
            error.to_string(),
            "mat5, byte 900: with `b` the contents need 1008 bytes of memory, expected at most 1000; a caller who trusts the file may raise the limit"
        );
        budget.give_back(800);
        budget.take(125, 8, Place::Byte(900), "b").unwrap();
        assert!(
            budget
                .take(usize::MAX, usize::MAX, Place::Byte(0), "c")
                .is_err()
        );
    }
}
