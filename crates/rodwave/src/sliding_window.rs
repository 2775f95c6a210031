//! Values that travel along a grid without being copied.
#![allow(
    clippy::indexing_slicing,
    reason = "the window is not empty, and window and padding lie in the buffer: they begin at `start`, and both slides copy the window to the other end \
              before they would leave it"
)]

use crate::inelastic::LANES;

/// Window of fixed length on a longer buffer: to shift the values, the window moves and the values
/// stay.
///
/// The window is followed by `padding` zeros, which complete its last block.
#[derive(Debug, Clone)]
pub(crate) struct SlidingWindow {
    buffer: Vec<f64>,
    start: usize,
    len: usize,
    padding: usize,
}

impl SlidingWindow {
    pub(crate) fn zeros(len: usize) -> Self {
        Self::filled(len, 0.0)
    }

    pub(crate) fn filled(len: usize, value: f64) -> Self {
        let padded = len.next_multiple_of(LANES);
        let mut buffer = vec![0.0; 4 * padded];
        buffer[..len].fill(value);
        Self {
            buffer,
            start: 0,
            len,
            padding: padded - len,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// End of the window and start of the padding.
    fn end(&self) -> usize {
        self.start + self.len
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.buffer[self.start..self.end()]
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [f64] {
        let window = self.start..self.end();
        &mut self.buffer[window]
    }

    pub(crate) fn first(&self) -> f64 {
        self.buffer[self.start]
    }

    pub(crate) fn last(&self) -> f64 {
        self.buffer[self.end() - 1]
    }

    pub(crate) fn set_first(&mut self, value: f64) {
        self.buffer[self.start] = value;
    }

    pub(crate) fn set_last(&mut self, value: f64) {
        let last = self.end() - 1;
        self.buffer[last] = value;
    }

    /// Returns the blocks that contain the first `count` values; the window must have that many.
    /// After the last value of the window, the blocks contain zeros, which must remain zero.
    #[inline(always)]
    pub(crate) fn blocks_mut(&mut self, count: usize) -> &mut [[f64; LANES]] {
        let end = self.start + count.next_multiple_of(LANES);
        self.buffer[self.start..end].as_chunks_mut().0
    }

    /// Moves every value to the next higher index; the caller must set the first.
    pub(crate) fn slide_towards_end(&mut self) {
        if self.start == 0 {
            let target = self.buffer.len() - self.len - self.padding;
            self.buffer.copy_within(0..self.len - 1, target + 1);
            self.start = target;
            let end = self.end();
            self.buffer[end..].fill(0.0);
        } else {
            self.start -= 1;
            // the former last value is now in the padding
            let end = self.end();
            self.buffer[end] = 0.0;
        }
    }

    /// Moves every value to the next lower index; the caller must set the last.
    pub(crate) fn slide_towards_start(&mut self) {
        let padded_end = self.end() + self.padding;
        if padded_end == self.buffer.len() {
            let window = self.start + 1..self.end();
            self.buffer.copy_within(window, 0);
            self.start = 0;
            let padding = self.len..self.len + self.padding;
            self.buffer[padding].fill(0.0);
        } else {
            self.start += 1;
            self.buffer[padded_end] = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_slides_as_an_array_shifts_and_is_padded_with_zeros() {
        // lengths below, at and above whole blocks, with enough slides to reach the end of the
        // buffer often
        for len in 9..50 {
            let (mut up, mut down) = (SlidingWindow::zeros(len), SlidingWindow::zeros(len));
            let (mut shifted_up, mut shifted_down) = (vec![0.0; len], vec![0.0; len]);
            let mut value = 0.0;
            for _ in 0..700 {
                value += 1.0;
                up.slide_towards_end();
                up.as_mut_slice()[0] = value;
                shifted_up.rotate_right(1);
                shifted_up[0] = value;
                down.slide_towards_start();
                down.as_mut_slice()[len - 1] = value;
                shifted_down.rotate_left(1);
                shifted_down[len - 1] = value;
                for (window, expected) in [(&mut up, &shifted_up), (&mut down, &shifted_down)] {
                    assert_eq!(window.as_slice(), expected, "{len} values");
                    let cells = window.blocks_mut(len).as_flattened();
                    assert_eq!(cells.len(), len.next_multiple_of(LANES));
                    assert_eq!(&cells[..len], expected, "{len} values");
                    assert!(cells[len..].iter().all(|cell| *cell == 0.0), "{len} values");
                }
            }
        }
    }
}
