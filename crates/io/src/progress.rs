//! The progress of a long task, with a flag to cancel it.
//!
//! The task and its observer hold clones of the same value.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// A fraction of some work, from 0 to 1, with a flag that cancels it.
#[derive(Clone, Debug)]
pub struct Progress {
    state: Arc<Status>,
    /// The start of this part of the work, and its share of the whole.
    begin: f64,
    share: f64,
}

#[derive(Default)]
struct Status {
    /// The bits of an f64.
    fraction: AtomicU64,
    cancelled: AtomicBool,
    /// Called with each fraction.
    hear: Option<Box<dyn Fn(f64) + Send + Sync>>,
}

impl std::fmt::Debug for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { fraction, cancelled, hear: _ } = self;
        f.debug_struct("Status")
            .field("fraction", fraction)
            .field("cancelled", cancelled)
            .finish_non_exhaustive()
    }
}

/// The work was cancelled: its result is no longer wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl Default for Progress {
    fn default() -> Self {
        Self { state: Arc::default(), begin: 0.0, share: 1.0 }
    }
}

impl Progress {
    /// Starts at 0.
    pub fn new() -> Self {
        Self::default()
    }

    /// Starts at 0, and calls `hear` with the completed fraction of the whole work at each step.
    pub fn heard_by(hear: impl Fn(f64) + Send + Sync + 'static) -> Self {
        let state = Status { hear: Some(Box::new(hear)), ..Status::default() };
        Self { state: Arc::new(state), ..Self::default() }
    }

    /// Returns the completed fraction of the whole work, from 0 to 1.
    pub fn fraction(&self) -> f64 {
        f64::from_bits(self.state.fraction.load(Ordering::Relaxed))
    }

    /// Cancels the work. It ends with an error, and changes nothing.
    pub fn cancel(&self) {
        self.state.cancelled.store(true, Ordering::Relaxed);
    }

    /// Returns whether [`Self::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.state.cancelled.load(Ordering::Relaxed)
    }

    /// Returns the part between two fractions of this work, as work in itself.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        Self {
            state: Arc::clone(&self.state),
            begin: self.begin + self.share * from,
            share: self.share * (to - from),
        }
    }

    /// Reports that `done` of `all` steps are done.
    ///
    /// # Errors
    /// If the work was cancelled.
    #[expect(clippy::cast_precision_loss, reason = "for the eye")]
    pub fn reached(&self, done: usize, all: usize) -> Result<(), Cancelled> {
        self.set((done as f64 / all.max(1) as f64).min(1.0));
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Reports that a fraction from 0 to 1 is done.
    pub fn set(&self, fraction: f64) {
        let whole = self.begin + self.share * fraction;
        self.state.fraction.store(whole.to_bits(), Ordering::Relaxed);
        if let Some(hear) = &self.state.hear {
            hear(whole);
        }
    }
}
