//! Gate for all changes of files. It lets the program end between two changes, and never in the
//! middle of one.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use crate::RodlabError;

/// The gate of this process.
static GATE: Gate = Gate::open();

/// Waits until no file is being changed, and prevents later changes: a later attempt returns
/// [`RodlabError::Interrupted`]. A program that ends while other threads still compute must call
/// this first.
pub fn stop_writing() {
    GATE.close();
}

/// Returns the right to change files, which lasts until it is dropped.
pub(super) fn pass() -> Result<Passage<'static>, RodlabError> {
    GATE.pass()
}

#[derive(Debug)]
struct Gate {
    state: Mutex<State>,
    quiet: Condvar,
}

#[derive(Debug)]
struct State {
    changes: usize,
    closed: bool,
}

/// A change of files in progress.
#[derive(Debug)]
pub(super) struct Passage<'a> {
    gate: &'a Gate,
}

impl Gate {
    const fn open() -> Self {
        Self {
            state: Mutex::new(State {
                changes: 0,
                closed: false,
            }),
            quiet: Condvar::new(),
        }
    }

    /// Returns the state. It is consistent even if a thread panicked while it held the lock,
    /// because such a thread has changed at most a counter, in one step.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn pass(&self) -> Result<Passage<'_>, RodlabError> {
        let mut state = self.state();
        if state.closed {
            return Err(RodlabError::Interrupted);
        }
        state.changes += 1;
        Ok(Passage { gate: self })
    }

    fn close(&self) {
        let mut state = self.state();
        state.closed = true;
        while state.changes > 0 {
            state = self
                .quiet
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl Drop for Passage<'_> {
    fn drop(&mut self) {
        self.gate.state().changes -= 1;
        self.gate.quiet.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::thread;
    use std::time::Duration;

    use super::*;

    #[test]
    fn r20_a_closed_gate_waits_for_changes_and_lets_none_begin() {
        let gate = Gate::open();
        let passage = gate.pass().unwrap();
        thread::scope(|scope| {
            let closing = scope.spawn(|| gate.close());
            thread::sleep(Duration::from_millis(30));
            assert!(!closing.is_finished());
            assert!(matches!(gate.pass(), Err(RodlabError::Interrupted)));
            drop(passage);
        });
        assert!(matches!(gate.pass(), Err(RodlabError::Interrupted)));
    }
}
