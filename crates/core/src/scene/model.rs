//! A model: the shape, materials and textures of a file, and the options for reading it.

use std::collections::BTreeMap;
use std::ops::Neg;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{Crease, Material, Mesh, Panorama, SurfaceMaps, Texture, Wrap};
use crate::base::{Shared, color::Color};

/// The content of a loaded file. Objects share it, and it never changes.
#[derive(Debug, PartialEq)]
pub struct Model {
    /// The name in the outline: the file name without folders and extension.
    pub name: String,
    /// The file; `None` for the three built-in models.
    pub source: Option<PathBuf>,
    /// Further files of the model: MTL files and textures.
    pub companions: Vec<PathBuf>,
    /// The options with which the file was read.
    pub options: LoadOptions,
    /// The shape.
    pub mesh: Mesh,
    /// The materials; the mesh's parts refer to them by index.
    pub materials: Vec<FileMaterial>,
    /// The colour of edges, from the file's line `c r g b` or `# color r g b`.
    pub edge_color: Option<Color>,
    /// Whether all vertex colours are grey: they are baked light, such as ambient occlusion, and
    /// multiply textures, which replace the colours of a scan.
    pub baked_light: bool,
}

impl Model {
    /// Creates a model of this shape that comes from no file.
    pub fn of_mesh(name: &str, mesh: Mesh) -> Self {
        let is_grey = |color: &[f32; 3]| color[0] == color[1] && color[1] == color[2];
        Self {
            baked_light: mesh.colors().iter().all(is_grey),
            name: name.to_owned(),
            source: None,
            companions: Vec::new(),
            options: LoadOptions::default(),
            mesh,
            materials: Vec::new(),
            edge_color: None,
        }
    }

    /// Builds a box of this side that replaces a missing or unreadable model. The box keeps the
    /// file's path and options, so saving the scene loses neither.
    pub fn placeholder(source: PathBuf, options: LoadOptions, side: f64) -> Self {
        let stem = source.file_stem().unwrap_or(source.as_os_str()).to_string_lossy();
        let model = Self::of_mesh(&stem, Mesh::placeholder(side));
        Self { source: Some(source), options, ..model }
    }

    /// Returns whether the model is a box that replaces a missing file.
    pub const fn is_placeholder(&self) -> bool {
        self.mesh.is_placeholder()
    }

    /// Copies the model with another crease angle, without reading the file again.
    #[must_use]
    pub fn with_crease(&self, crease: Crease) -> Self {
        Self {
            baked_light: self.baked_light,
            name: self.name.clone(),
            source: self.source.clone(),
            companions: self.companions.clone(),
            options: LoadOptions { crease, ..self.options },
            mesh: self.mesh.with_crease(crease),
            materials: self.materials.clone(),
            edge_color: self.edge_color,
        }
    }

    /// Returns whether both come from one reading of a file, and so differ at most in their crease
    /// angles.
    pub fn shares_file_with(&self, other: &Self) -> bool {
        self.mesh.shares_shape_with(&other.mesh)
    }
}

/// The options for reading a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LoadOptions {
    /// The axis of the file that points up.
    pub up: UpAxis,
    /// The factor that multiplies the file's coordinates.
    pub scale: Scale,
    /// The orientation of the file's polygons, seen from outside.
    pub winding: Winding,
    /// The angle below which edges are smooth, if the file has no smoothing groups.
    pub crease: Crease,
    /// The interpretation of bump maps.
    pub bumps: BumpMaps,
}

/// The interpretation of the pictures of `bump` and `map_Bump`.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub enum BumpMaps {
    /// Pictures that show normals in tangent space are normals; other pictures are heights.
    #[default]
    Auto,
    /// All pictures are heights.
    Heights,
    /// All pictures are normals in tangent space.
    Normals,
}

/// The axis of a file that points up. The model is turned by the shortest rotation that brings this
/// axis to +Y, and never mirrored; for -Y it is half a turn about X.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub enum UpAxis {
    /// +X: (x, y, z) of the file is (-y, x, z) here, a quarter turn about Z.
    X,
    /// +Y, as here.
    #[default]
    Y,
    /// +Z: (x, y, z) of the file is (x, z, -y) here, a quarter turn about X.
    Z,
    /// -X: (x, y, z) of the file is (y, -x, z) here, a quarter turn about Z.
    MinusX,
    /// -Y: (x, y, z) of the file is (x, -y, -z) here, half a turn about X.
    MinusY,
    /// -Z: (x, y, z) of the file is (x, -z, y) here, a quarter turn about X.
    MinusZ,
}

impl UpAxis {
    /// All six axes.
    pub const ALL: [Self; 6] =
        [Self::X, Self::Y, Self::Z, Self::MinusX, Self::MinusY, Self::MinusZ];

    /// Returns the axis as a word: "z", "-z".
    pub const fn word(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::MinusX => "-x",
            Self::MinusY => "-y",
            Self::MinusZ => "-z",
        }
    }

    /// Turns a position or direction of the file so that this axis points up.
    pub fn upright<T: Copy + Neg<Output = T>>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self {
            Self::X => [-y, x, z],
            Self::Y => [x, y, z],
            Self::Z => [x, z, -y],
            Self::MinusX => [y, -x, z],
            Self::MinusY => [x, -y, -z],
            Self::MinusZ => [x, -z, y],
        }
    }
}

/// A factor that is finite and more than 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "f64", try_from = "f64")]
pub struct Scale(f64);

impl Scale {
    /// Returns `factor` as a scale if it is finite and more than 0.
    pub fn new(factor: f64) -> Option<Self> {
        (factor.is_finite() && factor > 0.0).then_some(Self(factor))
    }

    /// Returns the factor.
    pub const fn get(self) -> f64 {
        self.0
    }
}

impl Default for Scale {
    fn default() -> Self {
        Self(1.0)
    }
}

impl From<Scale> for f64 {
    fn from(scale: Scale) -> Self {
        scale.0
    }
}

impl TryFrom<f64> for Scale {
    type Error = &'static str;

    fn try_from(factor: f64) -> Result<Self, Self::Error> {
        Self::new(factor).ok_or("a scale must be a finite number above 0")
    }
}

/// The orientation of a file's polygons, seen from outside.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub enum Winding {
    /// Counter-clockwise, as here.
    #[default]
    Kept,
    /// Clockwise: the order of corners is reversed, and normals are flipped.
    Turned,
}

/// A material of an MTL file, with invalid values replaced.
#[derive(Clone, Debug, PartialEq)]
pub struct FileMaterial {
    /// The name, from `newmtl`.
    pub name: String,
    /// The coefficients.
    pub material: Material,
    /// The opacity `d`: the fraction of the background that the surface covers, from 0 to 1.
    pub opacity: f64,
    /// The texture `map_Kd`, if its file was found.
    pub texture: Option<Shared<Texture>>,
    /// The other maps, if their files were found.
    pub maps: SurfaceMaps,
    /// Whether the surface shows Kd regardless of light: `illum 0`.
    pub unlit: bool,
    /// Whether vertex colours multiply the texture, rather than being replaced by it.
    pub multiplies_colors: bool,
    /// The numbers of further statements, such as `Pr` and `sharpness`, for exports.
    pub undrawn: Undrawn,
    /// What the surface mirrors in place of the scene's background: `refl`.
    pub environment: Option<Environment>,
    /// The maps for exports alone, such as `map_Pr`; and `refl`.
    pub undrawn_maps: Vec<UndrawnMap>,
}

impl FileMaterial {
    /// Creates an opaque material without pictures.
    pub fn new(name: &str, material: Material) -> Self {
        Self {
            name: name.to_owned(),
            material,
            opacity: 1.0,
            texture: None,
            maps: SurfaceMaps::new(),
            unlit: false,
            multiplies_colors: true,
            undrawn: Undrawn::new(),
            environment: None,
            undrawn_maps: Vec::new(),
        }
    }
}

/// The surroundings of a material: a reflection map.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The picture of everything around. A cube of six pictures has become one.
    pub panorama: Shared<Panorama>,
    /// Whether nothing else is mirrored: `illum` 8 and 9.
    pub is_alone: bool,
}

/// A map of a file's material that is passed on to exports as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct UndrawnMap {
    /// The keyword of its statement.
    pub keyword: String,
    /// The options of its statement.
    pub options: String,
    /// The file, which may be missing.
    pub source: PathBuf,
    /// The wrapping of uvs outside 0 to 1.
    pub wrap: Wrap,
    /// The offset `-o u v`.
    pub offset: [f64; 2],
    /// The scale `-s u v`.
    pub scale: [f64; 2],
}

impl UndrawnMap {
    /// Returns the keyword and the options.
    pub fn words(&self) -> [String; 2] {
        [self.keyword.clone(), self.options.clone()]
    }

    /// Returns the channel that the option `-imfchan` chooses: r, g, b, m (alpha), l or z.
    pub fn channel(&self) -> Option<char> {
        let mut words = self.options.split(' ');
        words.find(|word| word.eq_ignore_ascii_case("-imfchan"))?;
        words.next()?.chars().next().map(|c| c.to_ascii_lowercase())
    }
}

/// The numbers of statements that exports pass on, by the usual spelling of the keyword.
pub type Undrawn = BTreeMap<&'static str, Vec<f64>>;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Axis;

    #[test]
    fn every_up_axis_is_turned_up_and_nothing_is_mirrored() {
        for up in UpAxis::ALL {
            let [x, y, z] = Axis::ALL.map(|axis| {
                let turned = up.upright(axis.unit().as_vec3().to_array());
                glam::DVec3::from_array(turned.map(f64::from))
            });
            assert_eq!(glam::DMat3::from_cols(x, y, z).determinant(), 1.0, "{up:?}");
            let sign = if up.word().starts_with('-') { -1.0 } else { 1.0 };
            let axis = match up.word().trim_start_matches('-') {
                "x" => x,
                "y" => y,
                _ => z,
            };
            assert_eq!(axis * sign, glam::DVec3::Y, "{up:?}");
        }
    }
}
