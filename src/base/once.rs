//! Values that are computed when they are first needed, by whichever thread needs them first.
//!
//! The value is computed outside of its cell. A thread that computes with others, as rayon does,
//! takes up other work while it waits for them; if that work needs the same cell, the thread waits
//! for itself. Computing a value twice is the cheaper mistake.
//!
//! For the same reason nothing is computed inside a section of [`without_computing`]: there threads
//! hold locks on what they draw.

use std::cell::Cell;
use std::sync::OnceLock;

thread_local! {
    /// Whether this thread is inside [`without_computing`].
    static FORBIDDEN: Cell<bool> = const { Cell::new(false) };
}

/// Returns the value of a cell, and computes it first if the cell is empty.
///
/// # Panics
/// In builds with debug assertions, inside of [`without_computing`] if the cell is empty.
#[inline]
#[expect(clippy::disallowed_methods, reason = "this is the function to use instead")]
pub fn get_or_compute<T>(cell: &OnceLock<T>, compute: impl FnOnce() -> T) -> &T {
    cell.get().unwrap_or_else(|| {
        debug_assert!(
            !FORBIDDEN.get(),
            "{} is computed inside a parallel section: prepare it before",
            std::any::type_name::<T>()
        );
        let value = compute();
        cell.get_or_init(|| value)
    })
}

/// Runs a part of a parallel section in which all that it reads has been computed before.
pub fn without_computing<R>(work: impl FnOnce() -> R) -> R {
    /// Restores the flag, also if the work panics.
    struct Restore(bool);
    impl Drop for Restore {
        fn drop(&mut self) {
            FORBIDDEN.set(self.0);
        }
    }
    let _restore = Restore(FORBIDDEN.replace(true));
    work()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_needs_itself_while_threads_wait_is_computed_all_the_same() {
        static CELL: OnceLock<u32> = OnceLock::new();
        fn value(depth: u32) -> u32 {
            // What a waiting thread does when it takes up work that needs the same value.
            if depth == 0 { 7 } else { *get_or_compute(&CELL, || value(depth - 1)) }
        }
        assert_eq!(*get_or_compute(&CELL, || value(3)), 7);
    }

    #[test]
    #[should_panic(expected = "computed inside a parallel section")]
    fn computing_inside_a_parallel_section_is_noticed() {
        let cell = OnceLock::new();
        without_computing(|| *get_or_compute(&cell, || 1));
    }

    #[test]
    fn what_was_computed_before_is_read_inside_a_parallel_section() {
        let cell = OnceLock::new();
        get_or_compute(&cell, || 1);
        assert_eq!(without_computing(|| *get_or_compute(&cell, || 2)), 1);
        // Outside it may be computed again.
        assert_eq!(*get_or_compute(&OnceLock::new(), || 3), 3);
    }
}
