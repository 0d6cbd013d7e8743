//! Long work: without the interpreter's lock, and ended by Ctrl-C.

use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// How often signals are looked for.
const PATIENCE: Duration = Duration::from_millis(20);

/// The stack of a worker, bytes: what a program's first thread has on Linux.
const STACK: usize = 8 << 20;

/// Work that nobody waits for any more.
struct Cancelled;

/// Asked by work from time to time, from any of its threads.
#[derive(Clone, Default)]
pub struct Patience(Arc<AtomicBool>);

impl Patience {
    /// Returns while somebody waits; then the work unwinds, silently, from here.
    pub fn check(&self) {
        if self.0.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Cancelled));
        }
    }
}

/// Does work on a thread of its own while this one looks for signals. Work that does not ask [`Patience`] goes on unseen
/// to its end after Ctrl-C, and what it finds is dropped.
///
/// # Errors
/// `KeyboardInterrupt`, or what else a signal's handler raises.
pub fn done<T: Send + 'static>(py: Python<'_>, work: impl FnOnce(&Patience) -> T + Send + 'static) -> PyResult<T> {
    let (patience, (sender, receiver)) = (Patience::default(), channel());
    let asked = patience.clone();
    let worker = thread::Builder::new().stack_size(STACK).spawn(move || {
        // Where nobody waits any more nobody misses it.
        let _ = sender.send(work(&asked));
    })?;
    let mut receiver = receiver;
    loop {
        // A receiver is one thread's at a time, so it goes and comes back.
        let (outcome, back) = py.detach(move || (receiver.recv_timeout(PATIENCE), receiver));
        receiver = back;
        match outcome {
            Ok(found) => return Ok(found),
            Err(RecvTimeoutError::Timeout) => {
                py.check_signals().inspect_err(|_| patience.0.store(true, Ordering::Relaxed))?
            }
            Err(RecvTimeoutError::Disconnected) => match worker.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => unreachable!("a worker that ends well has sent what it found"),
            },
        }
    }
}
