//! Values that travel along a grid without being moved.

/// A window of fixed length on a longer buffer: shifting the values moves the window, not the values.
#[derive(Debug, Clone)]
pub(crate) struct SlidingWindow {
    buffer: Vec<f64>,
    start: usize,
    len: usize,
}

impl SlidingWindow {
    pub(crate) fn filled(len: usize, value: f64) -> Self {
        Self {
            buffer: vec![value; 4 * len],
            start: 0,
            len,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.buffer[self.start..self.start + self.len]
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.buffer[self.start..self.start + self.len]
    }

    /// Every value moves to the next higher index; the first is to be set by the caller.
    pub(crate) fn slide_towards_end(&mut self) {
        if self.start == 0 {
            let target = self.buffer.len() - self.len;
            self.buffer.copy_within(0..self.len - 1, target + 1);
            self.start = target;
        } else {
            self.start -= 1;
        }
    }

    /// Every value moves to the next lower index; the last is to be set by the caller.
    pub(crate) fn slide_towards_start(&mut self) {
        if self.start + self.len == self.buffer.len() {
            self.buffer
                .copy_within(self.start + 1..self.start + self.len, 0);
            self.start = 0;
        } else {
            self.start += 1;
        }
    }
}
