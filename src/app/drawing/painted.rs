//! The progress of the picture that is being drawn.

use std::sync::atomic::{AtomicU64, Ordering};

/// The painted tiles of a picture and all of its tiles, shared with the drawing thread.
#[derive(Debug, Default)]
pub(crate) struct Painted(AtomicU64);

impl Painted {
    /// Notes the painted tiles and all tiles.
    pub(crate) fn tell(&self, done: usize, all: usize) {
        let part = |count: usize| u64::from(u32::try_from(count).unwrap_or(u32::MAX));
        self.0.store(part(done) << 32 | part(all), Ordering::Relaxed);
    }

    /// Returns the finished fraction; `None` before the first tile.
    pub(crate) fn fraction(&self) -> Option<f64> {
        let both = self.0.load(Ordering::Relaxed);
        let (done, all) = ((both >> 32) as u32, both as u32 & u32::MAX);
        (done > 0).then(|| f64::from(done) / f64::from(all.max(done)))
    }
}
