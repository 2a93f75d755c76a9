//! Where a thing is, and where it was before.
//!
//! Every transformation pushes what the thing was, so that `u` can walk back through them. The
//! stack is a list whose tail is shared: a copy of a scene costs nothing, and what comes back is
//! what was stored, bit for bit.

use std::sync::Arc;

/// A value with the stack of those it had before.
pub struct Tracked<T> {
    now: T,
    before: Option<Arc<Self>>,
}

impl<T> Tracked<T> {
    /// A value that was never anything else.
    pub const fn new(now: T) -> Self {
        Self { now, before: None }
    }

    /// What it is.
    pub const fn now(&self) -> &T {
        &self.now
    }

    /// How many values there are to walk back through.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.earlier().count()
    }

    /// What it was, the latest first.
    pub fn earlier(&self) -> impl Iterator<Item = &T> {
        std::iter::successors(self.before.as_deref(), |placed| placed.before.as_deref())
            .map(|placed| &placed.now)
    }
}

impl<T: Clone> Tracked<T> {
    /// It becomes `now`, and what it was goes onto the stack.
    #[must_use]
    pub fn moved(&self, now: T) -> Self {
        Self { now, before: Some(Arc::new(self.clone())) }
    }

    /// It becomes `now`, and its stack stays as it is.
    #[must_use]
    pub fn replaced(&self, now: T) -> Self {
        Self { now, before: self.before.clone() }
    }

    /// What it was before the last transformation; `None` where it never was anything else.
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

/// Two are equal where value and stack are; a shared tail is not walked.
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

/// Lets go of a long stack one by one: the compiler's own way would call itself once for each.
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
