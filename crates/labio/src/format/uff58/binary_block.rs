//! Record 12 of a data set 58b: IEEE numbers without line ends, and the search for their end.

use super::header::{BinaryForm, Header, malformed};
use super::lines::Lines;
use super::{ByteOrder, FORMAT};
use crate::LabioError;
use crate::error::not_representable;
use crate::format::number_type::NumberType;

/// Layout of the numbers of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Packing {
    abscissa: usize,
    ordinate: usize,
    ordinates_per_point: usize,
}

impl Packing {
    fn point(self) -> usize {
        self.abscissa + self.ordinate * self.ordinates_per_point
    }
}

/// Returns the packings that a header allows. According to the format (`E13.5`, `E20.12`), an
/// uneven abscissa is in single precision even with double ordinates, but the common writers store
/// it in double precision; the length shows which one was used.
fn packings(header: &Header) -> impl Iterator<Item = Packing> + use<> {
    let ordinate = if header.double { 8 } else { 4 };
    let ordinates_per_point = if header.complex { 2 } else { 1 };
    let first = Packing {
        abscissa: if header.even { 0 } else { ordinate },
        ordinate,
        ordinates_per_point,
    };
    let single_abscissa = (header.double && !header.even).then_some(Packing {
        abscissa: 4,
        ..first
    });
    std::iter::once(first).chain(single_abscissa)
}

/// Reads the numbers of a block and advances past its separator. The number of bytes in the
/// identifier line is used only if a separator follows there: it is wrong in files of several
/// programs, whereas the number of points is right. A CR LF before the separator, which the format
/// forbids and some programs write, is skipped.
///
/// After an error, `values` contains the numbers read so far, and `lines` is at their end.
pub(super) fn read(
    lines: &mut Lines<'_>,
    form: BinaryForm,
    header: &Header,
    values: &mut Vec<f64>,
) -> Result<(), LabioError> {
    let place = lines.byte();
    let available = lines.rest().len();
    let stated = usize::try_from(form.n_bytes).unwrap_or(usize::MAX);
    let candidates = |packing: Packing| {
        let n_bytes = header.n_points.checked_mul(packing.point())?;
        (n_bytes <= available).then_some((packing, n_bytes))
    };
    let mut complete: Vec<(Packing, usize)> = packings(header).filter_map(candidates).collect();
    // if both packings end before a separator, the stated number of bytes decides
    complete.sort_by_key(|(_, n_bytes)| *n_bytes != stated);
    for (packing, n_bytes) in &complete {
        let mut ahead = *lines;
        if let Some(block) = ahead.take_bytes(*n_bytes)
            && take_separator(&mut ahead)
        {
            decode(block, *packing, form.byte_order, values);
            *lines = ahead;
            return Ok(());
        }
    }
    salvage(lines, form, header, &complete, values);
    let wanted: Vec<String> = packings(header)
        .map(|packing| (header.n_points as u128 * packing.point() as u128).to_string())
        .collect();
    Err(malformed(
        place,
        format!("record 12 ({} bytes stated)", form.n_bytes),
        format!("{available} bytes to the end of the file"),
        format!(
            "{} bytes for the {} values of record 7, and a line `    -1` after them",
            wanted.join(" or "),
            header.n_points
        ),
    ))
}

/// Consumes the line `    -1`, and a line end before it, if they come next.
fn take_separator(lines: &mut Lines<'_>) -> bool {
    let mut ahead = *lines;
    let Some(mut line) = ahead.next_line() else {
        return false;
    };
    if line.bytes.is_empty() {
        match ahead.next_line() {
            Some(next) => line = next,
            None => return false,
        }
    }
    let found = line.is_separator();
    if found {
        *lines = ahead;
    }
    found
}

/// Decodes the available part of a block whose end is misplaced: the whole points before the
/// separator, if the stated number of bytes leads to one; otherwise all points if there are enough
/// bytes, else the whole points before the end of the file.
fn salvage(
    lines: &mut Lines<'_>,
    form: BinaryForm,
    header: &Header,
    complete: &[(Packing, usize)],
    values: &mut Vec<f64>,
) {
    let Some(packing) = packings(header).next() else {
        return;
    };
    let stated = usize::try_from(form.n_bytes).unwrap_or(usize::MAX);
    let mut ahead = *lines;
    if let Some(block) = ahead.take_bytes(stated)
        && take_separator(&mut ahead)
    {
        decode(block, packing, form.byte_order, values);
        *lines = ahead;
        return;
    }
    let (packing, n_bytes) = complete
        .first()
        .copied()
        .unwrap_or((packing, lines.rest().len()));
    if let Some(block) = lines.take_bytes(n_bytes) {
        decode(block, packing, form.byte_order, values);
    }
}

/// Appends the numbers of `block`, from whole points only.
fn decode(block: &[u8], packing: Packing, order: ByteOrder, values: &mut Vec<f64>) {
    let point = packing.point();
    values.reserve(block.len() / packing.ordinate);
    if packing.abscissa == 0 || packing.abscissa == packing.ordinate {
        let whole = block.get(..block.len() / point * point).unwrap_or_default();
        decode_run(whole, packing.ordinate, order, values);
        return;
    }
    for point in block.chunks_exact(point) {
        let (abscissa, ordinates) = point.split_at(packing.abscissa);
        decode_run(abscissa, packing.abscissa, order, values);
        decode_run(ordinates, packing.ordinate, order, values);
    }
}

fn decode_run(bytes: &[u8], width: usize, order: ByteOrder, values: &mut Vec<f64>) {
    let kind = match width {
        8 => NumberType::F64,
        _ => NumberType::F32,
    };
    kind.append(bytes, order == ByteOrder::BigEndian, values);
}

/// Returns the number of bytes of a block as written: every number in the precision of the
/// ordinates.
pub(super) fn n_bytes(header: &Header) -> Option<u64> {
    let packing = packings(header).next()?;
    u64::try_from(header.n_points.checked_mul(packing.point())?).ok()
}

/// Writes the numbers of a block.
pub(super) struct BlockWriter<'a> {
    double: bool,
    order: ByteOrder,
    output: &'a mut Vec<u8>,
}

impl<'a> BlockWriter<'a> {
    pub(super) fn new(header: &Header, order: ByteOrder, output: &'a mut Vec<u8>) -> Self {
        Self {
            double: header.double,
            order,
            output,
        }
    }

    /// Appends `value`, rounded in single precision.
    ///
    /// # Errors
    ///
    /// [`LabioError::NotRepresentable`] for a finite value that overflows in single precision.
    #[inline]
    pub(super) fn put(&mut self, value: f64) -> Result<(), LabioError> {
        if self.double {
            self.output.extend(match self.order {
                ByteOrder::LittleEndian => value.to_le_bytes(),
                ByteOrder::BigEndian => value.to_be_bytes(),
            });
            return Ok(());
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "single precision was requested"
        )]
        let single = value as f32;
        if single.is_infinite() && value.is_finite() {
            return Err(not_representable(
                FORMAT,
                format!("{value:e} in single precision"),
            ));
        }
        self.output.extend(match self.order {
            ByteOrder::LittleEndian => single.to_le_bytes(),
            ByteOrder::BigEndian => single.to_be_bytes(),
        });
        Ok(())
    }
}
