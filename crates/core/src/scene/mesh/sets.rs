//! Disjoint sets of numbers (union-find).
//!
//! Tarjan, "Efficiency of a Good But Not Linear Set Union Algorithm", Journal of the ACM 1975.

use super::index;

/// Disjoint sets of the numbers from 0 on. The smallest number of a set represents it.
#[derive(Debug, Default)]
pub(super) struct Sets {
    /// For each number a smaller number of the same set; the smallest number refers to itself.
    parents: Vec<u32>,
}

impl Sets {
    /// Begins with `count` sets of one number each.
    pub(super) fn reset(&mut self, count: usize) {
        self.parents.clear();
        self.parents.extend(0..index(count));
    }

    /// Returns the smallest number of a number's set.
    pub(super) fn first(&mut self, mut number: u32) -> u32 {
        loop {
            let parent = self.parents[number as usize];
            if parent == number {
                return number;
            }
            // Path halving keeps the paths short.
            let next = self.parents[parent as usize];
            self.parents[number as usize] = next;
            number = next;
        }
    }

    /// Unites the sets of two numbers.
    pub(super) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}
