//! A list of items in the user's order, each under an id that is never reused.
//!
//! A list is a persistent data structure: a copy shares everything with its original, and a change
//! copies only the few nodes on the path to it. Snapshots of lists of any length are therefore
//! cheap, and every query takes at most logarithmic time.
//!
//! Each item has a label, a number that increases along the list. An id maps to a label, and a
//! binary search for the label finds the position. A new item gets a label between the labels of
//! its neighbours. If all of these are taken, the whole list is relabelled: Dietz and Sleator, "Two
//! Algorithms for Maintaining Order in a List", STOC 1987.

use std::fmt;
use std::sync::{Arc, OnceLock};

use imbl::ordmap::DiffItem;
use imbl::{OrdMap, Vector};

use crate::base::once::get_or_compute;

/// The initial distance between the labels of neighbours.
const STEP: i64 = 1 << 32;

/// The largest distance of a new label from the previous label. It leaves room for items that are
/// inserted one after the other.
const NEAR: u64 = 1 << 16;

/// A list of items under ids, and a value `D` that is computed from the list on first use.
pub struct List<K, T, D = ()> {
    entries: Vector<Entry<K, T>>,
    labels: OrdMap<K, i64>,
    /// The derived value, shared by all copies until they change.
    derived: Arc<OnceLock<D>>,
}

/// An item with its label.
#[derive(Debug)]
struct Entry<K, T> {
    label: i64,
    id: K,
    item: Arc<T>,
}

impl<K: Copy, T> Clone for Entry<K, T> {
    fn clone(&self) -> Self {
        Self { label: self.label, id: self.id, item: Arc::clone(&self.item) }
    }
}

impl<K: Copy, T, D> Clone for List<K, T, D> {
    fn clone(&self) -> Self {
        Self {
            entries: self.entries.clone(),
            labels: self.labels.clone(),
            derived: Arc::clone(&self.derived),
        }
    }
}

impl<K: Copy + Ord + fmt::Debug, T: fmt::Debug, D> fmt::Debug for List<K, T, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter()).finish()
    }
}

impl<K, T, D> Default for List<K, T, D> {
    fn default() -> Self {
        Self { entries: Vector::new(), labels: OrdMap::new(), derived: Arc::default() }
    }
}

/// Compares addresses first: lists that share their items are equal.
impl<K: PartialEq, T: PartialEq, D> PartialEq for List<K, T, D> {
    fn eq(&self, other: &Self) -> bool {
        let alike = |(a, b): (&Entry<K, T>, &Entry<K, T>)| {
            a.id == b.id && (Arc::ptr_eq(&a.item, &b.item) || a.item == b.item)
        };
        self.entries.ptr_eq(&other.entries)
            || (self.entries.len() == other.entries.len()
                && self.entries.iter().zip(&other.entries).all(alike))
    }
}

impl<K: Copy + Ord, T, D> List<K, T, D> {
    /// Returns the number of items.
    #[must_use]
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns whether the list is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Returns the position of the item with this id.
    #[must_use]
    pub fn position(&self, id: K) -> Option<usize> {
        let label = self.labels.get(&id)?;
        self.entries.binary_search_by_key(label, |entry| entry.label).ok()
    }

    /// Returns whether the list has an item with this id.
    #[must_use]
    pub fn contains(&self, id: K) -> bool {
        self.labels.contains_key(&id)
    }

    /// Returns the item with this id.
    #[must_use]
    pub fn get(&self, id: K) -> Option<&T> {
        Some(&*self.entries.get(self.position(id)?)?.item)
    }

    /// Returns all items with their ids, first to last.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (K, &T)> + ExactSizeIterator {
        self.entries.iter().map(|entry| (entry.id, &*entry.item))
    }

    /// Returns the item at a position, counted from 0, with its id.
    #[must_use]
    pub fn at(&self, at: usize) -> Option<(K, &T)> {
        self.entries.get(at).map(|entry| (entry.id, &*entry.item))
    }

    /// Returns the value that `compute` derives from the list. It is computed once, and all copies
    /// keep it until they change.
    pub(super) fn derived(&self, compute: impl FnOnce(&Self) -> D) -> &D {
        get_or_compute(&self.derived, || compute(self))
    }

    /// Returns all ids, first to last.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = K> + ExactSizeIterator {
        self.entries.iter().map(|entry| entry.id)
    }

    /// Returns the id of the first item.
    #[must_use]
    pub fn first(&self) -> Option<K> {
        self.id_at(0)
    }

    /// Returns the id at a position, counted from 0.
    #[must_use]
    pub fn id_at(&self, at: usize) -> Option<K> {
        self.entries.get(at).map(|entry| entry.id)
    }

    /// Returns the id after `id`, wrapping at the end; the first if `id` is not in the list.
    #[must_use]
    pub fn after(&self, id: Option<K>) -> Option<K> {
        let next = id.and_then(|id| self.position(id)).map_or(0, |at| at + 1);
        self.id_at(next).or_else(|| self.first())
    }

    /// Returns the first id that is not in `before`. Nodes that both lists share are skipped.
    #[must_use]
    pub fn first_since(&self, before: &Self) -> Option<K> {
        let new = before.labels.diff(&self.labels).filter_map(|difference| match difference {
            DiffItem::Add(id, label) => Some((*label, *id)),
            DiffItem::Update { .. } | DiffItem::Remove(..) => None,
        });
        new.min_by_key(|(label, _)| *label).map(|(_, id)| id)
    }

    /// Inserts an item before the item at `at`; past the end means last.
    pub(super) fn insert(&mut self, at: usize, id: K, item: T) {
        self.derived = Arc::default();
        let at = at.min(self.len());
        let label = self.free_label(at).unwrap_or_else(|| {
            self.label_anew();
            self.free_label(at).expect("new labels leave room between them")
        });
        self.labels.insert(id, label);
        self.entries.insert(at, Entry { label, id, item: Arc::new(item) });
    }

    /// Returns a free label between the previous item and the item at `at`; `None` if all are
    /// taken.
    fn free_label(&self, at: usize) -> Option<i64> {
        let label = |at: usize| self.entries.get(at).map(|entry| entry.label);
        match (at.checked_sub(1).and_then(label), label(at)) {
            (None, None) => Some(0),
            (Some(before), None) => before.checked_add(STEP),
            (None, Some(after)) => after.checked_sub(STEP),
            (Some(before), Some(after)) => {
                // The new label stays near the previous one, since the next item is often inserted
                // after it.
                let step = (before.abs_diff(after) / 2).min(NEAR);
                (step > 0).then_some(before.checked_add_unsigned(step)?)
            }
        }
    }

    fn label_anew(&mut self) {
        let labels = std::iter::successors(Some(0), |label: &i64| label.checked_add(STEP));
        for (entry, label) in self.entries.iter_mut().zip(labels) {
            entry.label = label;
            self.labels.insert(entry.id, label);
        }
    }
}

impl<K: Copy + Ord, T: Clone, D> List<K, T, D> {
    /// Replaces the item with this id, and returns the old one.
    pub(super) fn replace(&mut self, id: K, item: T) -> Option<T> {
        let at = self.position(id)?;
        self.derived = Arc::default();
        let entry = self.entries.get_mut(at)?;
        Some(Arc::unwrap_or_clone(std::mem::replace(&mut entry.item, Arc::new(item))))
    }

    /// Removes the item with this id, and returns it with its position.
    pub(super) fn remove(&mut self, id: K) -> Option<(usize, T)> {
        let at = self.position(id)?;
        self.derived = Arc::default();
        self.labels.remove(&id);
        Some((at, Arc::unwrap_or_clone(self.entries.remove(at).item)))
    }
}

/// The ids must differ.
impl<K: Copy + Ord, T, D> FromIterator<(K, T)> for List<K, T, D> {
    fn from_iter<I: IntoIterator<Item = (K, T)>>(items: I) -> Self {
        let mut list = Self::default();
        for (id, item) in items {
            list.insert(usize::MAX, id, item);
        }
        list
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::base::counted::{Counted, comparisons};

    #[test]
    fn a_query_on_ten_thousand_items_takes_few_comparisons_of_ids() {
        let mut list: List<Counted, u32> = (0..10_000).map(|i| (Counted(i), i)).collect();
        let before = list.clone();
        let middle = Counted(5_000);
        let few = 200;
        assert!(comparisons(|| before.get(middle)) < few);
        assert!(comparisons(|| before.position(middle)) < few);
        assert!(comparisons(|| before.after(Some(middle))) < few);
        assert!(comparisons(|| list.insert(0, Counted(10_000), 7)) < few);
        assert!(comparisons(|| list.remove(Counted(9_000))) < few);
        assert!(comparisons(|| list.replace(middle, 7)) < few);
        assert!(comparisons(|| assert!(list.first_since(&before) == Some(Counted(10_000)))) < few);
        assert!(comparisons(|| assert!(before == before.clone())) < few);
    }

    #[test]
    fn a_copy_keeps_its_items_and_shares_those_that_did_not_change() {
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

    #[test]
    fn any_number_of_items_can_be_inserted_at_the_same_position() {
        let mut list: List<u32, ()> = [(0, ()), (1, ())].into_iter().collect();
        for id in 2..500 {
            list.insert(1, id, ());
        }
        let expected: Vec<u32> = [0].into_iter().chain((2..500).rev()).chain([1]).collect();
        assert_eq!(list.ids().collect::<Vec<_>>(), expected);
        assert!(expected.iter().enumerate().all(|(at, id)| list.position(*id) == Some(at)));
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
