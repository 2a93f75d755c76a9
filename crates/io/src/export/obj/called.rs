//! The names of objects, groups and materials in an exported OBJ file.
//!
//! Names from a file survive unchanged. Objects of the scene that share a name or a file get
//! numbered names, since readers merge equal ones. A file without `o` that is exported alone stays
//! without, as does a file without `usemtl`.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;

use crate::export::look::{Looks, Maps, file_material, tint};
use crate::export::names::{self, on_one_line};
use marraztu_core::scene::{MaterialChoice, Object, PartNames, Surface};

/// The names in use, and the statements in effect.
#[derive(Debug, Default)]
pub(super) struct Names {
    /// Whether the file has only one object of the scene, which then needs no name.
    alone: bool,
    objects: names::Names,
    groups: names::Names,
    /// The statements in effect for the last face.
    now: PartNames,
    of_object: OfObject,
}

/// The names within one object of the scene.
#[derive(Debug, Default)]
struct OfObject {
    /// Whether the object names of the file are kept.
    keeps: bool,
    /// Exported names, by the names in the file.
    objects: HashMap<Option<String>, Option<String>>,
    groups: HashMap<String, String>,
    parts: HashMap<u32, PartNames>,
    /// The part of the last face.
    last: Option<u32>,
}

impl Names {
    /// Creates the names for a file with this number of objects of the scene.
    pub(super) fn new(objects: usize) -> Self {
        Self { alone: objects == 1, ..Self::default() }
    }

    /// Begins an object of the scene. A name from the user replaces the name of the file's only
    /// object, but not the names of several.
    pub(super) fn begin(&mut self, object: &Object) {
        let mesh = &object.model.mesh;
        let parts = 0..u32::try_from(mesh.parts().len()).unwrap_or(u32::MAX);
        let shown = parts.filter(|part| !object.hidden_parts.contains(part));
        let names: BTreeSet<_> = shown.map(|part| &mesh.part_names(part).object).collect();
        let keeps = names.len() > 1 || object.name == object.model.name;
        self.of_object = OfObject { keeps, ..OfObject::default() };
    }

    /// Names an object that has nothing but vertices.
    pub(super) fn object_without_shapes(&mut self, object: &Object, text: &mut String) {
        if !object.model.mesh.has_shapes() && !self.alone {
            let name = self.objects.take(&on_one_line(&object.name));
            self.call(PartNames { object: Some(name), group: None, ..self.now.clone() }, text);
        }
    }

    /// Writes the statements that change between the last face and a face of a part.
    pub(super) fn part(
        &mut self,
        object: &Object,
        part: u32,
        looks: &mut Looks,
        text: &mut String,
    ) {
        if self.of_object.last.replace(part) == Some(part) {
            return;
        }
        let called = match self.of_object.parts.get(&part) {
            Some(called) => called.clone(),
            None => {
                let called = self.called(object, part, looks);
                self.of_object.parts.insert(part, called.clone());
                called
            }
        };
        self.call(called, text);
    }

    fn call(&mut self, called: PartNames, text: &mut String) {
        let PartNames { object, group, material } = &called;
        // In OBJ only a new object ends a group.
        let ends_group = group.is_none() && self.now.group.is_some();
        if let Some(object) = object
            && (ends_group || self.now.object.as_ref() != Some(object))
        {
            say(text, "o", object);
            self.now.group = None;
        }
        if let Some(group) = group
            && self.now.group.as_ref() != Some(group)
        {
            say(text, "g", group);
        }
        if let Some(material) = material
            && self.now.material.as_ref() != Some(material)
        {
            say(text, "usemtl", material);
        }
        self.now = called;
    }

    fn called(&mut self, object: &Object, part: u32, looks: &mut Looks) -> PartNames {
        let names = object.model.mesh.part_names(part);
        // The object's name is taken once and reused by its other parts.
        let own = match self.of_object.objects.get(&names.object) {
            Some(name) => name.clone(),
            None => {
                let name = self.object(object, names.object.as_deref());
                self.of_object.objects.insert(names.object.clone(), name.clone());
                name
            }
        };
        let group = names.group.as_ref().map(|group| {
            let taken = &mut self.groups;
            let name = || taken.take(&on_one_line(group));
            self.of_object.groups.entry(group.clone()).or_insert_with(name).clone()
        });
        // Plain faces need no material, unless an earlier `usemtl` is still in effect.
        let asked = names.material.as_deref();
        let material = match asked.filter(|name| !name.is_empty()) {
            None if is_plain(object, part)
                && (self.now.material.is_none() || (asked.is_some() && self.alone)) =>
            {
                asked.map(str::to_owned)
            }
            _ => {
                let number = looks.of_part(object, part, Maps::Kept);
                Some(looks.all[number].name.clone())
            }
        };
        PartNames { object: own, group, material }
    }

    /// Returns the exported name of an object of the file.
    fn object(&mut self, object: &Object, own: Option<&str>) -> Option<String> {
        let name = match own {
            Some(own) if self.of_object.keeps => own,
            None if self.of_object.keeps && self.alone => return None,
            Some(_) | None => &object.name,
        };
        Some(self.objects.take(&on_one_line(name)))
    }
}

/// Returns whether a part looks like faces without any material.
fn is_plain(object: &Object, part: u32) -> bool {
    object.material == MaterialChoice::File
        && file_material(object, part).is_none()
        && object.texture.is_none()
        && object.opacity == 1.0
        && object.surface != Surface::Texture
        && tint(object) == [1.0; 3]
}

fn say(text: &mut String, statement: &str, name: &str) {
    let _ = match name {
        "" => writeln!(text, "{statement}"),
        name => writeln!(text, "{statement} {name}"),
    };
}
