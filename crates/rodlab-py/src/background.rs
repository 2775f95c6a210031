//! Work on a separate thread, so that the interpreter stays responsive: the work can be
//! interrupted, its progress is reported, and a panic becomes an exception.

use std::any::Any;
use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rodlab::RodlabError;
use rodlab::job::Progress;

use crate::errors::raised;

/// Time between two checks for signals to the interpreter.
const LOOK: Duration = Duration::from_millis(50);

/// Time in which interrupted work must end. After this time its thread is no longer waited for; an
/// interrupted thread writes no files.
const PATIENCE: Duration = Duration::from_millis(150);

/// Stack size of the thread that does the work, equal to that of most main threads.
const STACK: usize = 8 << 20;

/// Message from the work to the interpreter.
enum Event<T> {
    Begins(String, usize),
    OneMore,
    Ended(thread::Result<Result<T, RodlabError>>),
}

/// Sender of the progress to the interpreter.
struct Told<T>(Sender<Event<T>>);

impl<T> std::fmt::Debug for Told<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Told")
    }
}

impl<T: Send> Progress for Told<T> {
    fn begins(&self, step: &str, of: usize) {
        // sending fails after an interruption, because there is no receiver any more
        let _ = self.0.send(Event::Begins(step.to_owned(), of));
    }

    fn one_more(&self) {
        let _ = self.0.send(Event::OneMore);
    }
}

/// Runs `work` on a separate thread, without the lock of the interpreter. If `progress` is given,
/// it is called on the calling thread as `progress(step, done, of)`; `of` is 0 if the total is not
/// known.
///
/// # Errors
///
/// The error of the work; an exception raised by `progress` or by a signal handler
/// (`KeyboardInterrupt`), within 0.3 s; `RuntimeError` for a panic.
pub(crate) fn done<T, W>(py: Python<'_>, progress: Option<Py<PyAny>>, work: W) -> PyResult<T>
where
    T: Send + 'static,
    W: FnOnce(&dyn Progress, &AtomicBool) -> Result<T, RodlabError> + Send + 'static,
{
    let (tell, events) = mpsc::channel();
    let events = Mutex::new(events);
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    let told = Told(tell.clone());
    let body = move || {
        let ended = panic::catch_unwind(AssertUnwindSafe(|| work(&told, &flag)));
        let _ = tell.send(Event::Ended(ended));
    };
    thread::Builder::new()
        .stack_size(STACK)
        .spawn(body)
        .map_err(|error| PyRuntimeError::new_err(format!("starting a thread: {error}")))?;
    match listened(py, &events, progress.as_ref()) {
        Ok(ended) => ended_with(py, ended),
        Err(exception) => {
            interrupted.store(true, Ordering::Relaxed);
            py.detach(|| wait_for_the_end(&events, Instant::now() + PATIENCE));
            Err(exception)
        }
    }
}

/// Waits until the work has ended and returns its result, or returns an exception that is raised
/// before.
fn listened<T: Send>(
    py: Python<'_>,
    events: &Mutex<Receiver<Event<T>>>,
    progress: Option<&Py<PyAny>>,
) -> PyResult<thread::Result<Result<T, RodlabError>>> {
    let mut step = String::new();
    let (mut part, mut parts) = (0, 0);
    loop {
        let event = py.detach(|| next(events, LOOK));
        py.check_signals()?;
        match event {
            Ok(Event::Ended(ended)) => return Ok(ended),
            Ok(Event::Begins(name, of)) => (step, part, parts) = (name, 0, of),
            Ok(Event::OneMore) => part += 1,
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work ended without a result"));
            }
        }
        if let Some(progress) = progress {
            progress.call1(py, (step.as_str(), part, parts))?;
        }
    }
}

fn next<T>(
    events: &Mutex<Receiver<Event<T>>>,
    patience: Duration,
) -> Result<Event<T>, RecvTimeoutError> {
    let events = events.lock().unwrap_or_else(PoisonError::into_inner);
    events.recv_timeout(patience)
}

fn wait_for_the_end<T>(events: &Mutex<Receiver<Event<T>>>, until: Instant) {
    loop {
        let left = until.saturating_duration_since(Instant::now());
        if matches!(next(events, left), Ok(Event::Ended(_)) | Err(_)) {
            return;
        }
    }
}

fn ended_with<T>(py: Python<'_>, ended: thread::Result<Result<T, RodlabError>>) -> PyResult<T> {
    match ended {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(raised(py, &error)),
        Err(panic) => Err(PyRuntimeError::new_err(format!(
            "fault in rodlab, please report it: {}",
            words_of(&*panic)
        ))),
    }
}

fn words_of(panic: &(dyn Any + Send)) -> &str {
    if let Some(words) = panic.downcast_ref::<&str>() {
        words
    } else {
        panic.downcast_ref::<String>().map_or("", String::as_str)
    }
}
