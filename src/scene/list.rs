//! Things in the order in which the user sees them, each under an id that is never used twice.

/// A list of things under ids.
#[derive(Clone, Debug, PartialEq)]
pub struct List<K, T> {
    items: Vec<(K, T)>,
}

impl<K, T> Default for List<K, T> {
    fn default() -> Self {
        Self { items: Vec::new() }
    }
}

impl<K: Copy + PartialEq, T> List<K, T> {
    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Where the thing stands in the list.
    #[must_use]
    pub fn position(&self, id: K) -> Option<usize> {
        self.items.iter().position(|(other, _)| *other == id)
    }

    /// The thing under `id`.
    #[must_use]
    pub fn get(&self, id: K) -> Option<&T> {
        self.items.iter().find(|(other, _)| *other == id).map(|(_, item)| item)
    }

    pub(super) fn get_mut(&mut self, id: K) -> Option<&mut T> {
        self.items.iter_mut().find(|(other, _)| *other == id).map(|(_, item)| item)
    }

    /// All of them, first to last.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (K, &T)> + ExactSizeIterator {
        self.items.iter().map(|(id, item)| (*id, item))
    }

    /// Their ids, first to last.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = K> + ExactSizeIterator {
        self.items.iter().map(|(id, _)| *id)
    }

    /// The first of them.
    #[must_use]
    pub fn first(&self) -> Option<K> {
        self.items.first().map(|(id, _)| *id)
    }

    /// The one after `id`, the first after the last; the first where `id` is not there.
    #[must_use]
    pub fn after(&self, id: Option<K>) -> Option<K> {
        let next = id.and_then(|id| self.position(id)).map_or(0, |at| at + 1);
        self.items.get(next).or_else(|| self.items.first()).map(|(id, _)| *id)
    }

    /// The one that takes over when `id` is removed: the next in the list, else the one before.
    #[must_use]
    pub fn successor(&self, id: K) -> Option<K> {
        let at = self.position(id)?;
        let other = self.items.get(at + 1).or_else(|| self.items.get(at.checked_sub(1)?));
        other.map(|(id, _)| *id)
    }

    pub(super) fn insert(&mut self, at: usize, id: K, item: T) {
        self.items.insert(at.min(self.items.len()), (id, item));
    }

    pub(super) fn remove(&mut self, id: K) -> Option<(usize, T)> {
        let at = self.position(id)?;
        Some((at, self.items.remove(at).1))
    }
}

impl<K: Copy + PartialEq, T> FromIterator<(K, T)> for List<K, T> {
    fn from_iter<I: IntoIterator<Item = (K, T)>>(items: I) -> Self {
        Self { items: items.into_iter().collect() }
    }
}
