//! The time that each stage of a frame takes.

use std::time::{Duration, Instant};

/// How long each stage of a frame took on the wall clock, over all threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timings {
    /// Vertices to the screen.
    pub vertices: Duration,
    /// Setup of triangles: binning, and rasterizing the small ones.
    pub set_up: Duration,
    /// Setup of lines: binning, and rasterizing the short ones.
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

    /// The time since the last lap.
    pub(crate) fn lap(&mut self) -> Duration {
        let now = Instant::now();
        now - std::mem::replace(&mut self.0, now)
    }
}
