//! What both formats need of an object: how its parts look, and which polygons are exported.

use crate::base::Shared;
use crate::io::picture::PICTURE_FORMATS;
use crate::scene::{MapKind, Material, Object, Surface, SurfaceMap, Texture};

/// How a part of an object looks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Look {
    pub(super) material: Material,
    pub(super) opacity: f64,
    pub(super) texture: Option<Shared<Texture>>,
    pub(super) tint: [f64; 3],
    pub(super) two_sided: bool,
    /// Whether the texture is shown without light.
    pub(super) unlit: bool,
    /// Its maps beside the texture, with the factor of heights.
    pub(super) maps: Vec<(MapKind, SurfaceMap)>,
    /// Whether the vertices have colours.
    pub(super) colored: bool,
}

/// All looks of a scene, each once.
#[derive(Debug, Default)]
pub(super) struct Looks {
    pub(super) all: Vec<Look>,
    textures: Vec<Shared<Texture>>,
}

impl Looks {
    /// The number of the look of a part.
    pub(super) fn number(&mut self, object: &Object, part: u32) -> usize {
        let of_part = object.part_look(part);
        let textured = of_part.texture.is_some();
        let look = Look {
            material: of_part.material,
            opacity: of_part.opacity,
            texture: of_part.texture.cloned(),
            tint: if textured { object.tint.factors() } else { [1.0; 3] },
            two_sided: object.is_two_sided(),
            unlit: of_part.unlit || (textured && object.surface == Surface::Texture),
            maps: MapKind::ALL
                .into_iter()
                .filter_map(|kind| Some((kind, of_part.map(kind)?.clone())))
                .collect(),
            colored: !object.model.mesh.colors().is_empty(),
        };
        match self.all.iter().position(|other| *other == look) {
            Some(number) => number,
            None => {
                self.all.push(look);
                self.all.len() - 1
            }
        }
    }

    /// The number of the texture of a look, from 1: of its picture, which several may share.
    pub(super) fn texture_number(&mut self, texture: &Shared<Texture>) -> usize {
        let same = |other: &Shared<Texture>| Shared::same(&other.picture, &texture.picture);
        match self.textures.iter().position(same) {
            Some(number) => number + 1,
            None => {
                self.textures.push(texture.clone());
                self.textures.len()
            }
        }
    }

    /// The textures as PNG, in the order of their numbers.
    pub(super) fn encoded(&self) -> Result<Vec<Vec<u8>>, String> {
        self.textures.iter().map(|it| PICTURE_FORMATS[0].encode(&it.picture)).collect()
    }
}

/// The polygons of an object that are exported.
pub(super) fn polygons(object: &Object) -> impl Iterator<Item = u32> {
    let parts = object.model.mesh.polygon_parts();
    (0..).zip(parts).filter(|(_, part)| !object.hidden_parts.contains(part)).map(|(i, _)| i)
}
