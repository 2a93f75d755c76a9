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
        let half = |bits: u64| u32::try_from(bits & u64::from(u32::MAX)).unwrap_or(0);
        let (done, all) = (half(both >> 32), half(both));
        (done > 0).then(|| f64::from(done) / f64::from(all.max(done)))
    }
}
