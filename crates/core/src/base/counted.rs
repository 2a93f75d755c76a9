//! For tests: numbers that count how often they are compared.

use std::cell::Cell;
use std::cmp::Ordering;

thread_local! {
    static COMPARISONS: Cell<usize> = const { Cell::new(0) };
}

/// A number that counts how often it is compared with another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counted(pub(crate) u32);

impl Ord for Counted {
    fn cmp(&self, other: &Self) -> Ordering {
        COMPARISONS.set(COMPARISONS.get() + 1);
        self.0.cmp(&other.0)
    }
}

impl PartialOrd for Counted {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Counted {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Counted {}

/// Returns the number of comparisons that `work` takes.
pub(crate) fn comparisons<R>(work: impl FnOnce() -> R) -> usize {
    COMPARISONS.set(0);
    work();
    COMPARISONS.get()
}
