//! The parts of a model: faces with equal names from `o`, `g` and `usemtl`.

use std::collections::HashMap;

use marraztu_core::scene::{NONE, PartNames};

/// The distinct combinations of `o`, `g` and `usemtl`.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) list: Vec<NamedPart>,
    places: HashMap<PartNames, u32>,
    now: NamedPart,
    /// The index of `now`, set when a face needs it.
    place: Option<u32>,
}

/// A part by its names.
#[derive(Clone, Debug, Default)]
pub(super) struct NamedPart {
    pub(super) names: PartNames,
    /// The line of the `usemtl`.
    pub(super) line: u32,
}

impl Parts {
    pub(super) fn rename(&mut self, rename: impl FnOnce(&mut NamedPart)) {
        rename(&mut self.now);
        self.place = None;
    }

    pub(super) fn place(&mut self) -> u32 {
        *self.place.get_or_insert_with(|| {
            let next = u32::try_from(self.list.len()).unwrap_or(NONE);
            *self.places.entry(self.now.names.clone()).or_insert_with(|| {
                self.list.push(self.now.clone());
                next
            })
        })
    }

    /// Appends the parts of the text that follows the first `lines` lines. Returns the index here
    /// of each part there.
    pub(super) fn append(&mut self, following: &Self, lines: u32) -> Vec<u32> {
        let before = self.now.clone();
        let mut place = |part: &NamedPart| {
            self.rename(|now| *now = part.after(&before, lines));
            self.place()
        };
        let places = following.list.iter().map(&mut place).collect();
        self.rename(|now| *now = following.now.after(&before, lines));
        places
    }
}

impl NamedPart {
    /// Completes the names with earlier ones; `lines` lines precede these.
    fn after(&self, before: &Self, lines: u32) -> Self {
        let given = |ours: &Option<String>, earlier: &Option<String>| {
            ours.as_ref().or(earlier.as_ref()).cloned()
        };
        let (ours, earlier) = (&self.names, &before.names);
        // A new object starts without a group.
        let group = if ours.object.is_some() { &None } else { &earlier.group };
        let names = PartNames {
            object: given(&ours.object, &earlier.object),
            group: given(&ours.group, group),
            material: given(&ours.material, &earlier.material),
        };
        let line = if ours.material.is_some() { self.line + lines } else { before.line };
        Self { names, line }
    }
}
