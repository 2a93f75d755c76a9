//! A model: the shape, materials and textures of a file, and how the file is read.

use std::collections::BTreeMap;
use std::ops::Neg;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{Crease, Material, Mesh, SurfaceMaps, Texture};
use crate::base::{Shared, color::Color};

/// The content of a file as it was loaded. Objects share it, and it never changes.
#[derive(Debug, PartialEq)]
pub struct Model {
    /// Its name in the outline: the file's, without folders and extension.
    pub name: String,
    /// The file; `None` for the three built-in models.
    pub source: Option<PathBuf>,
    /// The further files that it was read from: MTL files and textures.
    pub companions: Vec<PathBuf>,
    /// The options with which it was read.
    pub options: LoadOptions,
    /// Its shape.
    pub mesh: Mesh,
    /// Its materials; the mesh's parts refer to them by index.
    pub materials: Vec<FileMaterial>,
    /// The colour of edges, from its line `c r g b` or `# color r g b`.
    pub edge_color: Option<Color>,
}

impl Model {
    /// A box of this side in the place of a model whose file is missing or cannot be read. It keeps
    /// the file's path and options, so that saving the scene loses neither.
    #[must_use]
    pub fn placeholder(source: PathBuf, options: LoadOptions, side: f64) -> Self {
        let stem = source.file_stem().unwrap_or(source.as_os_str());
        Self {
            name: stem.to_string_lossy().into_owned(),
            source: Some(source),
            options,
            companions: Vec::new(),
            mesh: Mesh::placeholder(side),
            materials: Vec::new(),
            edge_color: None,
        }
    }

    /// Whether it is a box in the place of a missing file.
    #[must_use]
    pub const fn is_placeholder(&self) -> bool {
        self.mesh.is_placeholder()
    }

    /// The model with another crease angle; the file is not read again.
    #[must_use]
    pub fn with_crease(&self, crease: Crease) -> Self {
        Self {
            name: self.name.clone(),
            source: self.source.clone(),
            companions: self.companions.clone(),
            options: LoadOptions { crease, ..self.options },
            mesh: self.mesh.with_crease(crease),
            materials: self.materials.clone(),
            edge_color: self.edge_color,
        }
    }

    /// Whether both come from one reading of a file, so that they differ at most in their crease
    /// angles.
    #[must_use]
    pub fn shares_file_with(&self, other: &Self) -> bool {
        self.mesh.shares_shape_with(&other.mesh)
    }
}

/// How a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LoadOptions {
    /// Which of the file's axes points up.
    pub up: UpAxis,
    /// The factor of the file's coordinates.
    pub scale: Scale,
    /// Which way its polygons run, seen from outside.
    pub winding: Winding,
    /// The angle up to which its edges are smooth, if it has no smoothing groups.
    pub crease: Crease,
    /// How its bump maps are read.
    pub bumps: BumpMaps,
}

/// How the pictures of `bump` and `map_Bump` are read.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub enum BumpMaps {
    /// A picture that shows normals in tangent space as normals, others as heights.
    #[default]
    Auto,
    /// As heights.
    Heights,
    /// As normals in tangent space.
    Normals,
}

/// Which of a file's axes points up. The model is turned by the shortest rotation that brings that
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
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::X, Self::Y, Self::Z, Self::MinusX, Self::MinusY, Self::MinusZ];

    /// Its word: "z", "-z".
    #[must_use]
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

    /// A position or direction of the file, turned so that this axis points up.
    #[must_use]
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
    /// `factor`, if it is finite and more than 0.
    #[must_use]
    pub fn new(factor: f64) -> Option<Self> {
        (factor.is_finite() && factor > 0.0).then_some(Self(factor))
    }

    /// The factor.
    #[must_use]
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

/// Which way a file's polygons run.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub enum Winding {
    /// Counter-clockwise seen from outside, as here.
    #[default]
    Kept,
    /// Clockwise: corners are taken in the opposite order, and normals turned.
    Turned,
}

/// A material of an MTL file, with invalid values replaced.
#[derive(Clone, Debug, PartialEq)]
pub struct FileMaterial {
    /// Its name, from `newmtl`.
    pub name: String,
    /// Its coefficients.
    pub material: Material,
    /// `d`: how much it covers of what is behind it, from 0 to 1.
    pub opacity: f64,
    /// `map_Kd`, if its file was found.
    pub texture: Option<Shared<Texture>>,
    /// Its other maps whose files were found.
    pub maps: SurfaceMaps,
    /// Whether Kd alone is shown, whatever the light: `illum 0`.
    pub unlit: bool,
    /// The numbers of statements that pictures do not show, as `Ni` and `Pr`, for exports.
    pub undrawn: Undrawn,
}

/// The numbers of statements that pictures do not show, by keyword as it is usually spelled.
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
