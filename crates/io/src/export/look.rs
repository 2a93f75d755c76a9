//! The materials of an export: the distinct looks of the parts of objects.
//!
//! Looks are deduplicated by a hash of their name, their numbers and the addresses of their
//! pictures. The lookup takes constant time: scenes have up to a hundred thousand materials.

use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;

use super::gltf_roughness::Scalars;
use super::names::{Names, on_one_line};
use super::part_look::{Look, RoughMetal};
use marraztu_core::base::Shared;
use marraztu_core::scene::{
    FileMaterial, MapKind, Material, MaterialChoice, Object, PresetId, Stroke, Surface, Texture,
    Transmission, UndrawnMap, Wrap,
};

/// The level of detail at which a format distinguishes materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Detail {
    /// MTL does not store whether faces are two-sided.
    Mtl,
    /// glTF materials may be two-sided.
    Gltf,
}

/// Whether a look has the textures of its material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Maps {
    Kept,
    /// glTF shows textures only on faces with texture coordinates.
    LeftOut,
}

/// The distinct looks of a scene.
#[derive(Debug)]
pub(super) struct Looks {
    pub(super) all: Vec<Look>,
    numbers: HashMap<Key, usize>,
    names: Names,
    detail: Detail,
    /// The maps of roughness and metalness read so far.
    pub(super) scalars: Scalars,
}

/// Looks with equal keys are equal.
#[derive(Debug, PartialEq, Eq, Hash)]
struct Key {
    name: String,
    numbers: Vec<u64>,
    undrawn: Vec<(&'static str, Vec<u64>)>,
    undrawn_maps: Vec<[String; 2]>,
    sources: Vec<PathBuf>,
    maps: Vec<(Option<MapKind>, usize, Wrap, [u64; 5])>,
}

impl Key {
    /// Returns the key of a look, with its wanted name.
    fn of(look: &Look) -> Self {
        let Material { ambient, diffuse, specular, exponent, emission, optics } = look.material;
        let filter = match optics.transmission {
            Transmission::None => [0.0; 3],
            Transmission::Opacity => [-1.0; 3],
            Transmission::Filter(filter) => filter,
        };
        let colors = [ambient, diffuse, specular, emission, look.base, filter];
        let flags = [look.two_sided, look.unlit, look.colored].map(u64::from);
        let rays = [optics.illumination(), optics.index];
        let numbers = colors.into_iter().flatten().chain([exponent, look.opacity]).chain(rays);
        // Bits instead of floats make the key hashable and exact.
        let map = |kind, Texture { picture, wrap, offset, scale, .. }: &Texture, gain: f64| {
            let bits = [offset[0], offset[1], scale[0], scale[1], gain].map(f64::to_bits);
            (kind, Shared::address(picture), *wrap, bits)
        };
        let texture = look.texture.iter().map(|texture| map(None, texture, 1.0));
        let maps = look.maps.iter().map(|(kind, of)| map(Some(*kind), &of.texture, of.gain));
        let bits = |numbers: &Vec<f64>| numbers.iter().map(|x| x.to_bits()).collect();
        Self {
            name: look.name.clone(),
            numbers: numbers.map(f64::to_bits).chain(flags).collect(),
            undrawn: look.undrawn.iter().map(|(word, of)| (*word, bits(of))).collect(),
            undrawn_maps: look.undrawn_maps.iter().map(UndrawnMap::words).collect(),
            sources: look.undrawn_maps.iter().map(|map| map.source.clone()).collect(),
            maps: texture.chain(maps).collect(),
        }
    }
}

impl Looks {
    pub(super) fn new(detail: Detail) -> Self {
        let (all, numbers, names) = (Vec::new(), HashMap::new(), Names::default());
        Self { all, numbers, names, detail, scalars: Scalars::default() }
    }

    /// Returns the index of a part's look.
    pub(super) fn of_part(&mut self, object: &Object, part: u32, maps: Maps) -> usize {
        let file = file_material(object, part);
        let asked = object.model.mesh.part_names(part).material.as_deref();
        self.number(object, file, asked, maps)
    }

    /// Adds the looks of all materials of the object's file, in order. Materials that only hidden
    /// parts use are skipped.
    pub(super) fn add_file(&mut self, object: &Object) {
        if object.material != MaterialChoice::File {
            return;
        }
        let parts = || (0..).zip(object.model.mesh.parts());
        let is_shown = |part: &u32| !object.hidden_parts.contains(part);
        let [mut shown, mut hidden] = [BTreeSet::new(), BTreeSet::new()];
        for (part, of) in parts() {
            (if is_shown(&part) { &mut shown } else { &mut hidden }).extend(of.material);
        }
        for (number, file) in (0..).zip(&object.model.materials) {
            if shown.contains(&number) || !hidden.contains(&number) {
                self.number(object, Some(file), None, Maps::Kept);
            }
        }
    }

    fn number(
        &mut self,
        object: &Object,
        file: Option<&FileMaterial>,
        asked: Option<&str>,
        maps: Maps,
    ) -> usize {
        let mut look = self.look(object, file, asked, maps);
        let key = Key::of(&look);
        *self.numbers.entry(key).or_insert_with(|| {
            look.name = self.names.take(&look.name);
            if self.detail == Detail::Gltf {
                look.rough_metal = self.scalars.of(&look);
            }
            self.all.push(look);
            self.all.len() - 1
        })
    }

    /// Builds a look with its wanted name.
    fn look(
        &self,
        object: &Object,
        file: Option<&FileMaterial>,
        asked: Option<&str>,
        maps: Maps,
    ) -> Look {
        // The material as drawn: the object's choice overrides the file's.
        let shown = object.material_look(file);
        let of_file = object.material == MaterialChoice::File;
        let is_bare = object.surface == Surface::Texture;
        let tint = tint(object);
        let mut material = shown.material;
        material.ambient = std::array::from_fn(|i| material.ambient[i] * tint[i]);
        material.diffuse = std::array::from_fn(|i| material.diffuse[i] * tint[i]);
        // A texture shown without light replaces all shading.
        if is_bare {
            (material.diffuse, material.specular) = (tint, [0.0; 3]);
            material.emission = [0.0; 3];
        }
        let is_mapped = maps == Maps::Kept;
        let texture = shown.texture.filter(|_| is_mapped);
        let is_painted = texture.is_some() || (has_colors(object) && self.detail == Detail::Gltf);
        let is_nameless = of_file && file.is_none();
        let map = |kind: MapKind| {
            let is_seen = is_mapped && (!is_bare || kind == MapKind::Opacity);
            Some((kind, shown.map(kind).filter(|_| is_seen)?.clone()))
        };
        let undrawn = file.filter(|_| of_file);
        Look {
            name: on_one_line(wanted_name(object, file, asked)),
            base: if is_nameless && is_painted { tint } else { material.diffuse },
            material,
            opacity: shown.opacity,
            texture: texture.cloned(),
            colored: shown.shows_colors_with(texture),
            two_sided: self.detail == Detail::Gltf && object.is_two_sided(),
            unlit: shown.unlit || is_bare,
            maps: MapKind::ALL.into_iter().filter_map(map).collect(),
            undrawn: undrawn.map(|file| file.undrawn.clone()).unwrap_or_default(),
            undrawn_maps: undrawn
                .filter(|_| is_mapped && object.surface == Surface::TextureAndLight)
                .map(|file| file.undrawn_maps.clone())
                .unwrap_or_default(),
            rough_metal: RoughMetal::default(),
        }
    }
}

/// Returns the name of a material: the file's, the preset's or, for a custom material, the
/// object's.
fn wanted_name<'a>(
    object: &'a Object,
    file: Option<&'a FileMaterial>,
    asked: Option<&'a str>,
) -> &'a str {
    match object.material {
        MaterialChoice::Preset(id) => id.get().name,
        MaterialChoice::Own(_) => &object.name,
        MaterialChoice::File => {
            let asked = asked.filter(|name| !name.is_empty());
            file.map_or(asked.unwrap_or(PresetId::SILVER.get().name), |file| &file.name)
        }
    }
}

/// Returns the file's material of a part.
pub(super) fn file_material(object: &Object, part: u32) -> Option<&FileMaterial> {
    let place = object.model.mesh.parts().get(part as usize)?.material?;
    object.model.materials.get(place as usize)
}

/// Returns the colour that multiplies the surface of an object.
pub(super) fn tint(object: &Object) -> [f64; 3] {
    if object.surface == Surface::Material { [1.0; 3] } else { object.tint.factors() }
}

/// Returns whether an object shows its vertex colours.
pub(super) fn has_colors(object: &Object) -> bool {
    object.surface != Surface::Material && !object.model.mesh.colors().is_empty()
}

/// Returns the lines and points of an object that are exported.
pub(super) fn strokes(object: &Object) -> impl Iterator<Item = &Stroke> {
    let all = object.model.mesh.strokes().iter();
    all.filter(|stroke| !object.hidden_parts.contains(&stroke.part))
}

/// Returns the polygons of an object that are exported.
pub(super) fn polygons(object: &Object) -> impl Iterator<Item = u32> {
    let parts = object.model.mesh.polygon_parts();
    (0..).zip(parts).filter(|(_, part)| !object.hidden_parts.contains(part)).map(|(i, _)| i)
}
