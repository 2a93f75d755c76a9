//! A model placed in the scene.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};
use serde::{Deserialize, Serialize};

use super::{
    Bounds, Environment, FileMaterial, MapKind, MaterialChoice, Model, PresetId, Shape, SurfaceMap,
    SurfaceMaps, Texture, Tracked,
};
use crate::base::math::{self, Axis};
use crate::base::{Shared, color::Color};

/// A model placed in the scene, with the appearance of its surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// The name in the outline.
    pub name: String,
    /// Whether the object is drawn.
    pub visible: bool,
    /// The shape.
    pub model: Shared<Model>,
    /// The indices of the model's parts that are not drawn.
    pub hidden_parts: BTreeSet<u32>,
    /// The matrix `world_from_object`, without the spin. A step in the global frame on a turned
    /// object need not be a product of one translation, rotation and scale, so a matrix is needed.
    pub placement: Tracked<DMat4>,
    /// The object's rotation over time.
    pub spin: Spin,
    /// The choice of material.
    pub material: MaterialChoice,
    /// The choice between material, texture and light.
    pub surface: Surface,
    /// A texture chosen by the user, instead of the file's.
    pub texture: Option<Shared<Texture>>,
    /// The colour that multiplies the texture.
    pub tint: Color,
    /// The opacity, from 0 (not drawn) to 1. It multiplies the opacities of the file's materials.
    pub opacity: f64,
    /// The sides of faces that are drawn.
    pub sides: Sides,
    /// Whether the file's normals are used for polygons that have them.
    pub file_normals: bool,
    /// The colour of its edges and normals.
    pub edge_color: Color,
}

/// The appearance of a surface: material, texture, or texture and light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Surface {
    /// The material, lit.
    Material,
    /// The texture, not lit.
    Texture,
    /// The texture, lit; without a texture, the material alone.
    #[default]
    TextureAndLight,
}

/// The sides of an object's faces that are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Sides {
    /// The front side, with back-face culling.
    One,
    /// Both sides; a back face is lit with its normal flipped.
    Two,
    /// Both sides of an open surface, the front side of a closed one. Only shown parts count.
    #[default]
    Auto,
}

/// A rotation about the object's own axes over time, after its placement: M Rx Ry Rz.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Spin {
    /// Whether the object turns about X, Y and Z.
    pub axes: [bool; 3],
    /// The speed in degrees per second.
    pub speed: f64,
    /// The start time, in seconds of the scene's clock.
    pub since: f64,
}

impl Default for Spin {
    fn default() -> Self {
        Self { axes: [false; 3], speed: 30.0, since: 0.0 }
    }
}

impl Spin {
    /// Returns whether the object turns about any axis.
    pub fn is_on(&self) -> bool {
        self.axes.contains(&true)
    }

    /// Returns the rotation at `time`, in seconds of the scene's clock.
    pub fn at(&self, time: f64) -> DMat3 {
        // Whole turns are dropped, since a small angle keeps more digits.
        let degrees = (self.speed * (time - self.since)) % 360.0;
        Axis::ALL
            .into_iter()
            .filter(|axis| self.axes[axis.index()])
            .fold(DMat3::IDENTITY, |turn, axis| {
                turn * math::rotation(axis.unit(), degrees.to_radians())
            })
    }
}

impl Object {
    /// Places a model at the centre of the world, with the orientation of its file. A model from a
    /// file gets [`Sides::Auto`], a built-in one [`Sides::One`].
    pub fn new(model: Shared<Model>, material: MaterialChoice) -> Self {
        Self {
            name: model.name.clone(),
            visible: true,
            hidden_parts: BTreeSet::new(),
            placement: Tracked::new(DMat4::IDENTITY),
            spin: Spin::default(),
            material,
            surface: Surface::default(),
            texture: None,
            tint: Color::WHITE,
            opacity: 1.0,
            sides: if model.source.is_some() { Sides::Auto } else { Sides::One },
            file_normals: true,
            edge_color: model.edge_color.unwrap_or(Color::WHITE),
            model,
        }
    }

    /// Returns whether the object is the shape of a ground, which reaches far beyond what stands on
    /// it.
    pub fn is_ground(&self) -> bool {
        Shape::of(&self.model) == Some(Shape::Ground)
    }

    /// Returns whether both sides of the object's faces are drawn and lit.
    pub fn is_two_sided(&self) -> bool {
        match self.sides {
            Sides::One => false,
            Sides::Two => true,
            Sides::Auto => match self.shows_all_parts() {
                true => !self.model.mesh.is_closed(),
                false => !self.model.mesh.is_closed_without(self.hidden_parts.iter().copied()),
            },
        }
    }

    /// Returns the matrix `world_from_object` at `time`, in seconds of the scene's clock.
    pub fn world_from_object(&self, time: f64) -> DMat4 {
        let placement = *self.placement.now();
        if self.spin.is_on() { placement * DMat4::from_mat3(self.spin.at(time)) } else { placement }
    }

    /// Returns the matrix `world_from_mesh` at `time`. It places the positions of the mesh, which
    /// are relative to [`Mesh::offset`](super::Mesh::offset).
    pub fn world_from_mesh(&self, time: f64) -> DMat4 {
        self.world_from_object(time) * self.model.mesh.object_from_mesh()
    }

    /// Returns the world positions of the vertices that a face of a shown part uses. If parts are
    /// hidden, a vertex may come once for each of its faces.
    pub fn placed_vertices(&self, time: f64) -> impl Iterator<Item = DVec3> {
        let world_from_mesh = self.world_from_mesh(time);
        self.shown_positions().map(move |p| world_from_mesh.transform_point3(p))
    }

    /// Returns whether every part of the model is drawn.
    fn shows_all_parts(&self) -> bool {
        self.hidden_parts.is_empty() || self.model.is_placeholder()
    }

    /// Returns the positions of [`Self::placed_vertices`] in the space of the mesh.
    fn shown_positions(&self) -> impl Iterator<Item = DVec3> {
        let mesh = &self.model.mesh;
        let all = self.shows_all_parts();
        let whole = all.then(|| mesh.used_positions());
        let shown = (!all).then(|| mesh.positions_of_parts(|part| self.shows_part(part)));
        whole.into_iter().flatten().chain(shown.into_iter().flatten())
    }

    /// Returns the extent of [`Self::shown_positions`]; `None` without any.
    fn shown_bounds(&self) -> Option<Bounds> {
        match self.shows_all_parts() {
            true => self.model.mesh.bounds(),
            false => Bounds::of(self.shown_positions()),
        }
    }

    /// Returns the mean of the model's vertices in the world. Hidden parts count, so cameras that
    /// orbit the object stay where they are when a part is hidden.
    pub fn centre(&self, time: f64) -> DVec3 {
        self.world_from_mesh(time).transform_point3(self.model.mesh.mean())
    }

    /// Returns the centre and radius of a bounding sphere of the shown parts in the world. The
    /// centre is the middle of their box along the object's axes, and the sphere passes through the
    /// farthest vertex. `None` without vertices.
    pub fn bounding_sphere(&self, time: f64) -> Option<(DVec3, f64)> {
        let middle = self.shown_bounds()?.centre();
        let world_from_mesh = self.world_from_mesh(time);
        let centre = world_from_mesh.transform_point3(middle);
        let radius = || {
            let squares = self.placed_vertices(time).map(|p| p.distance_squared(centre));
            squares.fold(0.0, f64::max).sqrt()
        };
        let all = self.shows_all_parts();
        let known = all.then(|| self.model.mesh.radius_of(world_from_mesh, radius));
        Some((centre, known.unwrap_or_else(radius)))
    }

    /// Returns the largest side of the object's box along the object's axes, in world units. Steps
    /// "by size" depend on it.
    pub fn largest_extent(&self) -> f64 {
        let Some(bounds) = self.model.mesh.bounds() else { return 0.0 };
        let m = *self.placement.now();
        let side = |axis: Axis| m.transform_vector3(axis.unit()).length();
        let sides = Axis::ALL.map(|axis| side(axis) * bounds.extent()[axis.index()]);
        sides.into_iter().fold(0.0, f64::max)
    }

    /// Returns whether a part of the model is drawn. A placeholder is drawn as a whole, since the
    /// hidden parts belong to the missing file.
    pub fn shows_part(&self, part: u32) -> bool {
        self.model.is_placeholder() || !self.hidden_parts.contains(&part)
    }

    /// Returns the parts of the model that are drawn.
    pub fn shown_parts(&self) -> impl Iterator<Item = u32> {
        let parts = 0..u32::try_from(self.model.mesh.parts().len()).unwrap_or(u32::MAX);
        parts.filter(|part| self.shows_part(*part))
    }

    /// Returns the coefficients, opacity and texture of one of the model's parts.
    pub fn part_look(&self, part: u32) -> PartLook<'_> {
        let named = self.model.mesh.parts().get(part as usize).and_then(|part| part.material);
        self.material_look(named.and_then(|material| self.model.materials.get(material as usize)))
    }

    /// Returns the coefficients, opacity and texture of a part with this material of the model.
    pub fn material_look<'a>(&'a self, file: Option<&'a FileMaterial>) -> PartLook<'a> {
        let material = match &self.material {
            MaterialChoice::Preset(id) => id.get().material,
            MaterialChoice::Own(material) => *material,
            MaterialChoice::File => {
                file.map_or(PresetId::SILVER.get().material, |file| file.material)
            }
        };
        let texture = self.texture.as_ref().or_else(|| file?.texture.as_ref());
        let opacity = match self.material {
            MaterialChoice::File => file.map_or(1.0, |file| file.opacity),
            MaterialChoice::Preset(_) | MaterialChoice::Own(_) => 1.0,
        };
        let of_file = self.material == MaterialChoice::File;
        PartLook {
            material,
            opacity: opacity * self.opacity,
            unlit: of_file && file.is_some_and(|file| file.unlit),
            multiplies_colors: self.model.baked_light
                || (self.texture.is_none() && file.is_none_or(|file| file.multiplies_colors)),
            texture: texture.filter(|_| self.surface != Surface::Material),
            maps: file.map(|file| &file.maps).filter(|_| self.surface != Surface::Material),
            environment: file
                .and_then(|file| file.environment.as_ref())
                .filter(|_| of_file && self.surface != Surface::Material),
            of_file,
        }
    }
}

/// The appearance of one part of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartLook<'a> {
    /// The coefficients.
    pub material: super::Material,
    /// The object's opacity, multiplied by `d` of the file's material if that material is used.
    pub opacity: f64,
    /// Whether the part shows Kd regardless of light: `illum 0` of the file's material.
    pub unlit: bool,
    /// The texture to show, if any.
    pub texture: Option<&'a Shared<Texture>>,
    /// Whether vertex colours multiply the texture, rather than being replaced by it.
    multiplies_colors: bool,
    /// The maps to show, if any.
    maps: Option<&'a SurfaceMaps>,
    /// What the part mirrors in place of the scene's background.
    pub environment: Option<&'a Environment>,
    /// Whether the material is the file's. If so, its opacity map is used together with its `d`.
    of_file: bool,
}

impl<'a> PartLook<'a> {
    /// Returns whether vertex colours are shown on faces with this texture, or without one.
    pub fn shows_colors_with(&self, texture: Option<&Shared<Texture>>) -> bool {
        texture.is_none() || self.multiplies_colors
    }

    /// Returns the map of this kind to show, if any. Like the file's texture, the file's maps apply
    /// to any chosen material. The exception is `map_d`, which goes with the `d` of the file's
    /// material.
    pub fn map(&self, kind: MapKind) -> Option<&'a SurfaceMap> {
        self.maps?.get(&kind).filter(|_| kind != MapKind::Opacity || self.of_file)
    }
}
