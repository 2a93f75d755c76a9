//! Measures the time of each stage of a frame.

use std::time::{Duration, Instant};

/// The wall-clock time of each stage of a frame, over all threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timings {
    /// Transforming vertices to the screen.
    pub vertices: Duration,
    /// Triangle setup: tile binning, and rasterising small triangles.
    pub set_up: Duration,
    /// Line setup: tile binning, and rasterising short lines.
    pub lines: Duration,
    /// Visibility, shading and storing of each tile.
    pub tiles: Duration,
}

impl std::ops::AddAssign for Timings {
    fn add_assign(&mut self, other: Self) {
        let Self { vertices, set_up, lines, tiles } = other;
        self.vertices += vertices;
        self.set_up += set_up;
        self.lines += lines;
        self.tiles += tiles;
    }
}

/// Measures consecutive stages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Laps(Instant);

impl Laps {
    pub(crate) fn start() -> Self {
        Self(Instant::now())
    }

    /// Returns the time since the last lap.
    pub(crate) fn lap(&mut self) -> Duration {
        let now = Instant::now();
        now - std::mem::replace(&mut self.0, now)
    }
}
