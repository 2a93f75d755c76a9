//! A value with its earlier values.
//!
//! Every transformation pushes the old value onto a stack, so `u` can walk back. The stack is a
//! linked list with a shared tail: copying it takes constant time, and old values come back bit for
//! bit.

use std::sync::Arc;

/// A value with the stack of its earlier values.
pub struct Tracked<T> {
    now: T,
    before: Option<Arc<Self>>,
}

impl<T> Tracked<T> {
    /// Creates a value without earlier values.
    pub const fn new(now: T) -> Self {
        Self { now, before: None }
    }

    /// Returns the current value.
    pub const fn now(&self) -> &T {
        &self.now
    }

    /// Returns the number of earlier values.
    pub fn depth(&self) -> usize {
        self.earlier().count()
    }

    /// Returns whether both have the same earlier values, so one comes from the other without a
    /// push.
    pub fn shares_stack_with(&self, other: &Self) -> bool {
        match (&self.before, &other.before) {
            (None, None) => true,
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (Some(_), None) | (None, Some(_)) => false,
        }
    }

    /// Returns the earlier values, the latest first.
    pub fn earlier(&self) -> impl Iterator<Item = &T> {
        std::iter::successors(self.before.as_deref(), |placed| placed.before.as_deref())
            .map(|placed| &placed.now)
    }
}

impl<T: Clone> Tracked<T> {
    /// Sets the value to `now` and pushes the old one onto the stack.
    #[must_use]
    pub fn moved(&self, now: T) -> Self {
        Self { now, before: Some(Arc::new(self.clone())) }
    }

    /// Sets the value to `now` and leaves the stack as it is.
    #[must_use]
    pub fn replaced(&self, now: T) -> Self {
        Self { now, before: self.before.clone() }
    }

    /// Returns the value before the last transformation; `None` before the first.
    #[must_use]
    pub fn undone(&self) -> Option<Self> {
        self.before.as_deref().cloned()
    }
}

impl<T: Clone> Clone for Tracked<T> {
    fn clone(&self) -> Self {
        Self { now: self.now.clone(), before: self.before.clone() }
    }
}

impl<T: Default> Default for Tracked<T> {
    fn default() -> Self {
        Self::new(T::default())
    }
}

/// Compares value and stack; a shared tail is skipped.
impl<T: PartialEq> PartialEq for Tracked<T> {
    fn eq(&self, other: &Self) -> bool {
        let (mut a, mut b) = (self, other);
        loop {
            if a.now != b.now {
                return false;
            }
            match (&a.before, &b.before) {
                (None, None) => return true,
                (Some(x), Some(y)) if Arc::ptr_eq(x, y) => return true,
                (Some(x), Some(y)) => (a, b) = (x, y),
                _ => return false,
            }
        }
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for Tracked<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tracked").field("now", &self.now).field("depth", &self.depth()).finish()
    }
}

/// Drops a long stack in a loop, since the generated code would recurse once for each value.
impl<T> Drop for Tracked<T> {
    fn drop(&mut self) {
        let mut next = self.before.take();
        while let Some(mut last) = next.and_then(Arc::into_inner) {
            next = last.before.take();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stack_of_a_million_is_walked_compared_and_dropped() {
        let build = || (1..=1_000_000).fold(Tracked::new(0), |placed, i| placed.moved(i));
        let (a, b) = (build(), build());
        assert_eq!(a.depth(), 1_000_000);
        assert!(a == b);
        assert_eq!(a.undone().map(|placed| *placed.now()), Some(999_999));
    }
}
