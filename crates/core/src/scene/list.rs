//! A list of items in the user's order, each under an id that is never reused.
//!
//! A copy shares everything with its original. The first change of a copy copies the table of ids
//! and pointers, but not the items.

use std::fmt;
use std::hash::Hash;
use std::sync::{Arc, OnceLock};

use indexmap::IndexMap;

use crate::base::once::get_or_compute;

/// A list of items under ids, and a value `D` that is computed from the list on first use.
pub struct List<K, T, D = ()> {
    items: Arc<IndexMap<K, Arc<T>>>,
    /// The derived value, shared by all copies until they change.
    derived: Arc<OnceLock<D>>,
}

impl<K, T, D> Clone for List<K, T, D> {
    fn clone(&self) -> Self {
        Self { items: Arc::clone(&self.items), derived: Arc::clone(&self.derived) }
    }
}

impl<K: Copy + Eq + Hash + fmt::Debug, T: fmt::Debug, D> fmt::Debug for List<K, T, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter()).finish()
    }
}

impl<K, T, D> Default for List<K, T, D> {
    fn default() -> Self {
        Self { items: Arc::default(), derived: Arc::default() }
    }
}

/// Compares addresses first: lists that share their items are equal.
impl<K: PartialEq, T: PartialEq, D> PartialEq for List<K, T, D> {
    fn eq(&self, other: &Self) -> bool {
        let alike = |item: &Arc<T>, other: &Arc<T>| Arc::ptr_eq(item, other) || item == other;
        Arc::ptr_eq(&self.items, &other.items)
            || (self.items.len() == other.items.len()
                && self.items.keys().eq(other.items.keys())
                && self.items.values().zip(other.items.values()).all(|(a, b)| alike(a, b)))
    }
}

impl<K: Copy + Eq + Hash, T, D> List<K, T, D> {
    /// Returns the number of items.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Returns whether the list is empty.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Returns the position of the item with this id.
    pub fn position(&self, id: K) -> Option<usize> {
        self.items.get_index_of(&id)
    }

    /// Returns whether the list has an item with this id.
    pub fn contains(&self, id: K) -> bool {
        self.items.contains_key(&id)
    }

    /// Returns the item with this id.
    pub fn get(&self, id: K) -> Option<&T> {
        self.items.get(&id).map(|item| &**item)
    }

    /// Returns all items with their ids, first to last.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (K, &T)> + ExactSizeIterator {
        self.items.iter().map(|(id, item)| (*id, &**item))
    }

    /// Returns the item at a position, counted from 0, with its id.
    pub fn at(&self, at: usize) -> Option<(K, &T)> {
        self.items.get_index(at).map(|(id, item)| (*id, &**item))
    }

    /// Returns the value that `compute` derives from the list. It is computed once, and all copies
    /// keep it until they change.
    pub(super) fn derived(&self, compute: impl FnOnce(&Self) -> D) -> &D {
        get_or_compute(&self.derived, || compute(self))
    }

    /// Returns all ids, first to last.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = K> + ExactSizeIterator {
        self.items.keys().copied()
    }

    /// Returns the id of the first item.
    pub fn first(&self) -> Option<K> {
        self.id_at(0)
    }

    /// Returns the id at a position, counted from 0.
    pub fn id_at(&self, at: usize) -> Option<K> {
        self.items.get_index(at).map(|(id, _)| *id)
    }

    /// Returns the id after `id`, wrapping at the end; the first if `id` is not in the list.
    pub fn after(&self, id: Option<K>) -> Option<K> {
        let next = id.and_then(|id| self.position(id)).map_or(0, |at| at + 1);
        self.id_at(next).or_else(|| self.first())
    }

    /// Returns the first id that is not in `before`.
    pub fn first_since(&self, before: &Self) -> Option<K> {
        if Arc::ptr_eq(&self.items, &before.items) {
            return None;
        }
        // Lists are mostly the same up to the change, so ids are looked up only after it.
        let alike = self.ids().zip(before.ids()).take_while(|(own, other)| own == other).count();
        self.ids().skip(alike).find(|id| !before.contains(*id))
    }
}

impl<K: Copy + Eq + Hash, T, D> List<K, T, D> {
    /// Begins a change: the table is copied if other lists share it.
    fn change(&mut self) -> &mut IndexMap<K, Arc<T>> {
        self.derived = Arc::default();
        Arc::make_mut(&mut self.items)
    }

    /// Inserts an item before the item at `at`; past the end means last.
    pub(super) fn insert(&mut self, at: usize, id: K, item: T) {
        let at = at.min(self.len());
        self.change().shift_insert(at, id, Arc::new(item));
    }
}

impl<K: Copy + Eq + Hash, T: Clone, D> List<K, T, D> {
    /// Replaces the item with this id, and returns the old one.
    pub(super) fn replace(&mut self, id: K, item: T) -> Option<T> {
        let at = self.position(id)?;
        Some(Arc::unwrap_or_clone(std::mem::replace(&mut self.change()[at], Arc::new(item))))
    }

    /// Removes the item with this id, and returns it with its position.
    pub(super) fn remove(&mut self, id: K) -> Option<(usize, T)> {
        let at = self.position(id)?;
        let (_, item) = self.change().shift_remove_index(at)?;
        Some((at, Arc::unwrap_or_clone(item)))
    }
}

/// The ids must differ.
impl<K: Copy + Eq + Hash, T, D> FromIterator<(K, T)> for List<K, T, D> {
    fn from_iter<I: IntoIterator<Item = (K, T)>>(items: I) -> Self {
        let items = items.into_iter().map(|(id, item)| (id, Arc::new(item))).collect();
        Self { items: Arc::new(items), derived: Arc::default() }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_copy_keeps_its_items_and_shares_the_unchanged_ones() {
        let mut list: List<u32, Vec<u32>> = (0..1_000).map(|i| (i, vec![i])).collect();
        let before = list.clone();
        list.replace(3, vec![7]);
        list.remove(900);
        assert_eq!((before.get(3), list.get(3)), (Some(&vec![3]), Some(&vec![7])));
        assert_eq!((before.len(), list.len()), (1_000, 999));
        let shared = list
            .iter()
            .filter(|(id, item)| before.get(*id).is_some_and(|other| std::ptr::eq(other, *item)));
        assert_eq!(shared.count(), 998);
    }

    /// Generates a change of a list: its position and its kind.
    fn change() -> impl Strategy<Value = (usize, u8)> {
        (0_usize..40, 0_u8..4)
    }

    proptest! {
        #[test]
        fn a_list_behaves_like_a_vector(changes in prop::collection::vec(change(), 0..200)) {
            let mut list: List<usize, usize> = List::default();
            let mut plain: Vec<(usize, usize)> = Vec::new();
            for (next, (at, what)) in changes.into_iter().enumerate() {
                let before = list.clone();
                let there = plain.get(at).map(|(id, _)| *id);
                match (what, there) {
                    (0 | 1, _) | (_, None) => {
                        list.insert(at, next, next);
                        plain.insert(at.min(plain.len()), (next, next));
                        prop_assert_eq!(list.first_since(&before), Some(next));
                        prop_assert_eq!(before.first_since(&list), None);
                    }
                    (2, Some(id)) => {
                        prop_assert_eq!(list.remove(id), Some((at, plain.remove(at).1)));
                        prop_assert_eq!(before.first_since(&list), Some(id));
                    }
                    (_, Some(id)) => {
                        let old = std::mem::replace(&mut plain[at].1, next);
                        prop_assert_eq!(list.replace(id, next), Some(old));
                        prop_assert_eq!(list.first_since(&before), None);
                    }
                }
                prop_assert!(list != before);
                let all: Vec<(usize, usize)> = list.iter().map(|(id, item)| (id, *item)).collect();
                prop_assert_eq!(&all, &plain);
                for (at, (id, item)) in plain.iter().enumerate() {
                    prop_assert_eq!(list.position(*id), Some(at));
                    prop_assert_eq!(list.get(*id), Some(item));
                }
            }
        }
    }
}
