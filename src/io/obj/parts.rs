//! The parts of a model: what its `o`, `g` and `usemtl` call its faces.

use std::collections::HashMap;

use crate::scene::NONE;

/// The runs of `o`, `g` and `usemtl`, those with the same names together.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) list: Vec<PartNames>,
    places: HashMap<PartNames, u32>,
    now: PartNames,
    /// The place of `now`, once a face has needed it.
    place: Option<u32>,
}

/// What a part is called: by its object, its group and its material; each is `None` as long as no
/// statement has named one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct PartNames {
    pub(super) object: Option<String>,
    pub(super) group: Option<String>,
    pub(super) material: Option<String>,
    /// The line of the `usemtl`.
    pub(super) line: u32,
}

impl Parts {
    pub(super) fn rename(&mut self, rename: impl FnOnce(&mut PartNames)) {
        rename(&mut self.now);
        self.place = None;
    }

    pub(super) fn place(&mut self) -> u32 {
        *self.place.get_or_insert_with(|| {
            let key = PartNames { line: 0, ..self.now.clone() };
            let next = u32::try_from(self.list.len()).unwrap_or(NONE);
            *self.places.entry(key).or_insert_with(|| {
                self.list.push(self.now.clone());
                next
            })
        })
    }

    /// Takes up the parts of the lines that follow the first `lines` lines; gives the place here of
    /// each part there.
    pub(super) fn append(&mut self, following: &Self, lines: u32) -> Vec<u32> {
        let before = self.now.clone();
        let mut place = |names: &PartNames| {
            self.rename(|now| *now = names.after(&before, lines));
            self.place()
        };
        let places = following.list.iter().map(&mut place).collect();
        self.rename(|now| *now = following.now.after(&before, lines));
        places
    }
}

impl PartNames {
    /// The names with those that were given before; `lines` lines are before these.
    fn after(&self, before: &Self, lines: u32) -> Self {
        let given = |ours: &Option<String>, earlier: &Option<String>| {
            ours.as_ref().or(earlier.as_ref()).cloned()
        };
        // An object begins without a group.
        let group = if self.object.is_some() { &None } else { &before.group };
        Self {
            object: given(&self.object, &before.object),
            group: given(&self.group, group),
            material: given(&self.material, &before.material),
            line: if self.material.is_some() { self.line + lines } else { before.line },
        }
    }
}
