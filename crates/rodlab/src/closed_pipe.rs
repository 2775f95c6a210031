//! A reader that has seen enough, as `head`, is no reason to stop or to end otherwise.

use std::io::{self, ErrorKind, Write};

/// Passes on what is written until nobody reads it any longer.
pub(crate) struct UntilClosed<'a> {
    output: &'a mut (dyn Write + Send),
    closed: bool,
}

impl<'a> UntilClosed<'a> {
    pub(crate) fn new(output: &'a mut (dyn Write + Send)) -> Self {
        Self {
            output,
            closed: false,
        }
    }
}

impl Write for UntilClosed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.closed {
            return Ok(bytes.len());
        }
        match self.output.write(bytes) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(bytes.len())
            }
            done => done,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.output.flush() {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            done => done,
        }
    }
}
