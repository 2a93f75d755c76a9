//! Values that are computed when a thread first needs them.
//!
//! The value is computed outside its cell. A rayon thread runs other work while it waits for
//! others; if that work needed the same cell, the thread would wait for itself. Computing a value
//! twice is the cheaper mistake.
//!
//! For the same reason nothing is computed inside [`without_computing`], where threads hold locks
//! on parts of the picture.

use std::cell::Cell;
use std::sync::OnceLock;

thread_local! {
    /// Whether this thread is inside [`without_computing`].
    static FORBIDDEN: Cell<bool> = const { Cell::new(false) };
}

/// Returns the value of a cell, computing it first if the cell is empty.
///
/// # Panics
/// In builds with debug assertions, if the cell is empty inside [`without_computing`].
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

/// Runs a part of a parallel section. All values that it reads must have been computed before.
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
    fn a_value_that_needs_itself_while_threads_wait_is_still_computed() {
        static CELL: OnceLock<u32> = OnceLock::new();
        fn value(depth: u32) -> u32 {
            // As if a waiting thread ran work that needs the same value.
            if depth == 0 { 7 } else { *get_or_compute(&CELL, || value(depth - 1)) }
        }
        assert_eq!(*get_or_compute(&CELL, || value(3)), 7);
    }

    #[test]
    #[should_panic(expected = "computed inside a parallel section")]
    fn computing_inside_a_parallel_section_panics() {
        let cell = OnceLock::new();
        without_computing(|| *get_or_compute(&cell, || 1));
    }

    #[test]
    fn values_computed_before_can_be_read_inside_a_parallel_section() {
        let cell = OnceLock::new();
        get_or_compute(&cell, || 1);
        assert_eq!(without_computing(|| *get_or_compute(&cell, || 2)), 1);
        // Outside, values may be computed again.
        assert_eq!(*get_or_compute(&OnceLock::new(), || 3), 3);
    }
}
