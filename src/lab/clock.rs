//! What tells how long work takes.
//!
//! A clock is handed the work and told what it is, and gives back the time: so a test can put a false
//! one in its place that makes one choice slow, and see that choice named and no other.

use std::time::{Duration, Instant};

use crate::scene::Settings;

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work<'a> {
    /// A picture, drawn with these settings.
    Picture(&'a Settings),
    /// A small piece of arithmetic, by its name.
    Kernel(&'static str),
}

/// Measures work.
pub trait Clock {
    /// Does the work, and says how long it took.
    fn time(&mut self, work: Work<'_>, todo: &mut dyn FnMut()) -> Duration;
    /// The time since some fixed moment.
    fn now(&self) -> Duration;
}

/// The machine's own monotonic clock.
#[derive(Clone, Copy, Debug)]
pub struct WallClock {
    begun: Instant,
}

impl Default for WallClock {
    fn default() -> Self {
        Self { begun: Instant::now() }
    }
}

impl Clock for WallClock {
    fn time(&mut self, _: Work<'_>, todo: &mut dyn FnMut()) -> Duration {
        let begun = Instant::now();
        todo();
        begun.elapsed()
    }

    fn now(&self) -> Duration {
        self.begun.elapsed()
    }
}
