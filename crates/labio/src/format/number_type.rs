//! Numbers and characters in the bytes of a file.

/// Type of the numbers in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NumberType {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// Number of bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Appends the numbers in `bytes` to `values`, exactly, except for 64-bit integers, which are
    /// rounded to 53 bits. Bytes of an incomplete number at the end are ignored.
    pub(super) fn append(self, bytes: &[u8], big_endian: bool, values: &mut Vec<f64>) {
        macro_rules! append {
            ($kind:ty) => {{
                let numbers = bytes.as_chunks().0.iter();
                if big_endian {
                    values.extend(numbers.map(|&number| <$kind>::from_be_bytes(number) as f64));
                } else {
                    values.extend(numbers.map(|&number| <$kind>::from_le_bytes(number) as f64));
                }
            }};
        }
        match self {
            Self::I8 => append!(i8),
            Self::I16 => append!(i16),
            Self::I32 => append!(i32),
            Self::I64 => append!(i64),
            Self::U8 => append!(u8),
            Self::U16 => append!(u16),
            Self::U32 => append!(u32),
            Self::U64 => append!(u64),
            Self::F32 => append!(f32),
            Self::F64 => append!(f64),
        }
    }

    /// Returns the numbers in `bytes` as [`NumberType::append`] converts them.
    pub(super) fn numbers(self, bytes: &[u8], big_endian: bool) -> Vec<f64> {
        let mut values = Vec::new();
        self.append(bytes, big_endian, &mut values);
        values
    }
}

/// Returns the characters of a text in UTF-32; `None` if a code is not that of a character.
pub(super) fn utf32<T: FromIterator<char>>(bytes: &[u8], big_endian: bool) -> Option<T> {
    let units = bytes.as_chunks::<4>().0.iter();
    let units = units.map(|&unit| match big_endian {
        true => u32::from_be_bytes(unit),
        false => u32::from_le_bytes(unit),
    });
    units.map(char::from_u32).collect()
}
