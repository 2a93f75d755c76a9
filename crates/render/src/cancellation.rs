//! Cancellation of a frame in progress.
//!
//! Every thread asks between chunks and between tiles whether the frame is still wanted. Once the
//! answer is no, it stays no, so a frame is cancelled completely.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Asks whether a frame is still wanted, and reports its progress.
pub(crate) struct Cancellation<'a> {
    wanted: &'a (dyn Fn() -> bool + Sync),
    given_up: AtomicBool,
    told: Option<Told<'a>>,
}

/// Reports the number of painted tiles and their total.
struct Told<'a> {
    tell: &'a (dyn Fn(usize, usize) + Sync),
    painted: AtomicUsize,
    all: AtomicUsize,
}

impl<'a> Cancellation<'a> {
    pub(crate) const fn new(wanted: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self { wanted, given_up: AtomicBool::new(false), told: None }
    }

    /// Adds a callback that receives the painted tiles and all tiles, over all passes.
    pub(crate) const fn telling(self, tell: &'a (dyn Fn(usize, usize) + Sync)) -> Self {
        let (painted, all) = (AtomicUsize::new(0), AtomicUsize::new(0));
        Self { told: Some(Told { tell, painted, all }), ..self }
    }

    /// Announces the total number of tiles, over all passes.
    pub(crate) fn expect_tiles(&self, all: usize) {
        if let Some(told) = &self.told {
            told.all.store(all, Ordering::Relaxed);
        }
    }

    /// Counts another painted tile.
    pub(crate) fn tile_is_painted(&self) {
        if let Some(told) = &self.told {
            let painted = told.painted.fetch_add(1, Ordering::Relaxed) + 1;
            (told.tell)(painted, told.all.load(Ordering::Relaxed));
        }
    }

    /// Returns whether drawing should continue.
    pub(crate) fn goes_on(&self) -> bool {
        if self.is_given_up() {
            return false;
        }
        let wanted = (self.wanted)();
        if !wanted {
            self.given_up.store(true, Ordering::Relaxed);
        }
        wanted
    }

    /// Returns whether the frame was cancelled.
    pub(crate) fn is_given_up(&self) -> bool {
        self.given_up.load(Ordering::Relaxed)
    }
}
