//! Output to a reader that closes the pipe early, such as `head`. This is not an error and does not
//! change the exit status.

use std::io::{self, ErrorKind, Write};

/// Passes on output until its reader closes the pipe.
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
