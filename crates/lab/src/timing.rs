//! Measures the time of work.
//!
//! The laboratory passes its work to a [`Clock`] together with a description. A test can substitute
//! a clock that makes one choice slow, and check that only this choice is reported.

use std::time::{Duration, Instant};

use marraztu_core::accuracy::Settings;

/// Runs the work and returns its duration.
pub fn time(work: impl FnOnce()) -> Duration {
    let begun = Instant::now();
    work();
    begun.elapsed()
}

/// A description of timed work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work<'a> {
    /// A picture with these settings.
    Picture(&'a Settings),
    /// A small kernel, by name.
    Kernel(&'static str),
}

/// Measures durations.
pub trait Clock {
    /// Runs the work and returns its duration.
    fn time(&mut self, work: Work<'_>, todo: &mut dyn FnMut()) -> Duration;
    /// Returns the time since a fixed moment.
    fn now(&self) -> Duration;
}

/// The machine's monotonic clock.
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
