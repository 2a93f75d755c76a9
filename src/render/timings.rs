//! Where the time of a frame went.

use std::time::{Duration, Instant};

/// How long each stage of a frame took, from beginning to end, on all threads together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stages {
    /// Vertices to the screen.
    pub vertices: Duration,
    /// Triangles to the tiles, the small ones to pixels.
    pub set_up: Duration,
    /// Lines to the tiles, the short ones to pixels.
    pub lines: Duration,
    /// What is seen in each tile, its light and its colours in the picture.
    pub tiles: Duration,
}

impl std::ops::AddAssign for Stages {
    fn add_assign(&mut self, other: Self) {
        let Self { vertices, set_up, lines, tiles } = other;
        self.vertices += vertices;
        self.set_up += set_up;
        self.lines += lines;
        self.tiles += tiles;
    }
}

/// Measures one stage after the other.
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
