//! Measures how long work takes.
//!
//! The laboratory hands its work to a [`Clock`], together with what it is: a test can replace the
//! clock by one that makes one choice slow, and expects that choice to be named and no other.

use std::time::{Duration, Instant};

use marraztu_core::accuracy::Settings;

/// Does the work, and measures how long it takes.
pub fn time(work: impl FnOnce()) -> Duration {
    let begun = Instant::now();
    work();
    begun.elapsed()
}

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work<'a> {
    /// A picture, drawn with these settings.
    Picture(&'a Settings),
    /// A small piece of arithmetic, by name.
    Kernel(&'static str),
}

/// Measures work.
pub trait Clock {
    /// Does the work, and gives the time that it took.
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
        time(todo)
    }

    fn now(&self) -> Duration {
        self.begun.elapsed()
    }
}
