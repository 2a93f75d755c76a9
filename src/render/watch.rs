//! Whether a frame that is being drawn is still wanted.
//!
//! It is asked between chunks and tiles, by every thread. Once the answer was no, it stays no: a frame
//! is given up as a whole.

use std::sync::atomic::{AtomicBool, Ordering};

/// What asks.
pub(super) struct Watch<'a> {
    wanted: &'a (dyn Fn() -> bool + Sync),
    given_up: AtomicBool,
}

impl<'a> Watch<'a> {
    pub(super) const fn new(wanted: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self { wanted, given_up: AtomicBool::new(false) }
    }

    /// Whether drawing goes on.
    pub(super) fn goes_on(&self) -> bool {
        if self.is_given_up() {
            return false;
        }
        let wanted = (self.wanted)();
        if !wanted {
            self.given_up.store(true, Ordering::Relaxed);
        }
        wanted
    }

    /// Whether the frame was given up.
    pub(super) fn is_given_up(&self) -> bool {
        self.given_up.load(Ordering::Relaxed)
    }
}
