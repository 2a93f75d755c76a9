//! Models from files and arrays.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use marraztu_core::base::Shared;
use marraztu_core::scene::{
    BumpMaps, CornerLists, Crease, FileMaterial, LoadOptions, Material, MaterialChoice, MeshSource,
    Model, Part, Scale, Smoothing, SurfaceMaps, Texture, UpAxis, Winding, Wrap, dvec3,
    split_positions,
};
use marraztu_io::{self as io, Loaded};
use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::errors::Failure;
use crate::pictures::{self, Pixels};
use crate::threads::{work, work_while};
use crate::values::{MaterialValue, item};

/// A shape with its materials, which scenes share. It never changes.
#[pyclass(frozen, module = "marraztu._marraztu")]
pub(crate) struct Mesh {
    pub(crate) model: Shared<Model>,
    #[pyo3(get)]
    findings: Vec<String>,
}

/// The options for reading a file.
struct Reading {
    up: Option<String>,
    scale: f64,
    flip_winding: bool,
    crease: Option<f64>,
    bump_maps: String,
}

impl<'py> FromPyObject<'_, 'py> for Reading {
    type Error = PyErr;

    fn extract(options: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self {
            up: item(options, "up")?,
            scale: item(options, "scale")?,
            flip_winding: item(options, "flip_winding")?,
            crease: item(options, "crease")?,
            bump_maps: item(options, "bump_maps")?,
        })
    }
}

impl Reading {
    fn options(&self, path: &Path) -> Result<LoadOptions, Failure> {
        let up = match &self.up {
            Some(word) => {
                let found = UpAxis::ALL.into_iter().find(|axis| axis.word() == word);
                found.ok_or_else(|| Failure::value("up is x, y, z, -x, -y or -z"))?
            }
            None => io::usual_up(path),
        };
        let scale = Scale::new(self.scale);
        let bumps = match &*self.bump_maps {
            "auto" => BumpMaps::Auto,
            "heights" => BumpMaps::Heights,
            "normals" => BumpMaps::Normals,
            _ => return Err(Failure::value("bump_maps is auto, heights or normals")),
        };
        Ok(LoadOptions {
            up,
            scale: scale.ok_or_else(|| Failure::value("scale is a finite number above 0"))?,
            winding: if self.flip_winding { Winding::Turned } else { Winding::Kept },
            crease: self.crease.map_or_else(|| Ok(io::usual_crease(path)), crease)?,
            bumps,
        })
    }
}

/// Converts an angle in radians.
fn crease(radians: f64) -> Result<Crease, Failure> {
    Crease::new(radians.to_degrees()).ok_or_else(|| Failure::value("crease is from 0 to pi"))
}

/// Arrays that describe a mesh. The lists of vertices have one row per vertex.
struct Arrays<'py> {
    name: String,
    vertices: PyReadonlyArray2<'py, f64>,
    /// The vertices of all polygons, one polygon after the other.
    corners: PyReadonlyArray1<'py, u32>,
    /// The number of corners of each polygon.
    arities: PyReadonlyArray1<'py, u32>,
    normals: Option<PyReadonlyArray2<'py, f32>>,
    uvs: Option<PyReadonlyArray2<'py, f32>>,
    colors: Option<PyReadonlyArray2<'py, f32>>,
    texture: Option<Pixels<'py>>,
    material: Option<MaterialValue>,
    crease: f64,
}

impl<'py> FromPyObject<'_, 'py> for Arrays<'py> {
    type Error = PyErr;

    fn extract(arrays: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self {
            name: item(arrays, "name")?,
            vertices: item(arrays, "vertices")?,
            corners: item(arrays, "corners")?,
            arities: item(arrays, "arities")?,
            normals: item(arrays, "normals")?,
            uvs: item(arrays, "uvs")?,
            colors: item(arrays, "colors")?,
            texture: item(arrays, "texture")?,
            material: item(arrays, "material")?,
            crease: item(arrays, "crease")?,
        })
    }
}

/// Copies the rows of an array.
fn rows_of<T: numpy::Element + Copy, const N: usize>(
    array: &PyReadonlyArray2<'_, T>,
) -> Result<Vec<[T; N]>, Failure> {
    if array.shape()[1] != N {
        return Err(Failure::Value(format!("an array needs the shape (n, {N})")));
    }
    Ok(array.as_slice().map_err(Failure::value)?.as_chunks::<N>().0.to_vec())
}

fn optional<T: numpy::Element + Copy, const N: usize>(
    array: Option<&PyReadonlyArray2<'_, T>>,
) -> Result<Vec<[T; N]>, Failure> {
    array.map_or_else(|| Ok(Vec::new()), rows_of)
}

impl Arrays<'_> {
    /// Copies the arrays.
    fn copied(self) -> Result<Copied, Failure> {
        let picture = self.texture.as_ref().map(pictures::picture).transpose()?;
        let texture = picture.map(|picture| Texture {
            source: PathBuf::new(),
            picture: Shared::new(picture),
            wrap: Wrap::default(),
            offset: [0.0; 2],
            scale: [1.0; 2],
        });
        Ok(Copied {
            vertices: rows_of(&self.vertices)?,
            corners: self.corners.as_slice().map_err(Failure::value)?.to_vec(),
            arities: self.arities.as_slice().map_err(Failure::value)?.to_vec(),
            normals: optional(self.normals.as_ref())?,
            uvs: optional(self.uvs.as_ref())?,
            colors: optional(self.colors.as_ref())?,
            texture: texture.map(Shared::new),
            material: self.material.map(MaterialValue::choice).transpose()?,
            crease: crease(self.crease)?,
            name: self.name,
        })
    }
}

/// [`Arrays`] in memory of Rust.
struct Copied {
    name: String,
    vertices: Vec<[f64; 3]>,
    corners: Vec<u32>,
    arities: Vec<u32>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colors: Vec<[f32; 3]>,
    texture: Option<Shared<Texture>>,
    material: Option<MaterialChoice>,
    crease: Crease,
}

impl Copied {
    fn model(self) -> Result<Model, Failure> {
        let Self { name, corners, crease, .. } = self;
        // Like a file's texture without coefficients: shown in its own colours.
        let white = Material::matte([0.2; 3], [1.0; 3]);
        let is_colored = self.texture.is_some() || !self.colors.is_empty();
        let material = match self.material {
            None | Some(MaterialChoice::File) if is_colored => white,
            None | Some(MaterialChoice::File) => Material::default(),
            Some(MaterialChoice::Own(material)) => material,
            Some(MaterialChoice::Preset(id)) => id.get().material,
        };
        let (offset, positions) = split_positions(&self.vertices, &corners);
        let per_corner = |is_empty: bool| if is_empty { Vec::new() } else { corners.clone() };
        let lists = CornerLists {
            uvs: per_corner(self.uvs.is_empty()),
            normals: per_corner(self.normals.is_empty()),
            positions: corners.clone(),
        };
        let source = MeshSource {
            offset,
            positions,
            colors: self.colors,
            uvs: self.uvs,
            normals: self.normals,
            corners: Vec::new(),
            polygon_parts: vec![0; self.arities.len()],
            strokes: Vec::new(),
            arities: self.arities,
            parts: vec![Part { name: name.clone(), material: Some(0) }],
            part_names: Vec::new(),
            smoothing: Smoothing::Crease(crease),
        };
        let mesh = marraztu_core::scene::Mesh::from_lists(source, lists).map_err(Failure::value)?;
        let material = FileMaterial {
            name: name.clone(),
            material,
            opacity: 1.0,
            texture: self.texture,
            maps: SurfaceMaps::default(),
            unlit: false,
            multiplies_colors: true,
            undrawn: BTreeMap::new(),
            environment: None,
            undrawn_maps: Vec::new(),
        };
        let options = LoadOptions { crease, ..LoadOptions::default() };
        Ok(Model { options, materials: vec![material], ..Model::of_mesh(&name, mesh) })
    }
}

impl Mesh {
    pub(crate) fn of(model: Shared<Model>) -> Self {
        Self { model, findings: Vec::new() }
    }
}

#[pymethods]
impl Mesh {
    /// Loads an OBJ file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, reading: Reading) -> PyResult<Self> {
        let Loaded { model, findings } = work_while(py, 0, |_, interrupt| {
            let options = reading.options(&path)?;
            Ok(io::load(&path, &options, &interrupt.progress)?)
        })?;
        let findings = findings.iter().map(ToString::to_string).collect();
        Ok(Self { model: Shared::new(model), findings })
    }

    /// Builds a mesh from arrays.
    #[staticmethod]
    fn from_arrays(py: Python<'_>, arrays: Arrays<'_>) -> PyResult<Self> {
        let copied = arrays.copied()?;
        let model = work(py, 0, |_| copied.model())?;
        Ok(Self::of(Shared::new(model)))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    /// The position of each vertex, as an array of shape (n, 3).
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pictures::load_numpy(py)?;
        let mesh = &self.model.mesh;
        let offset = mesh.offset();
        let place = |p: &[f32; 3]| (dvec3(*p) + offset).to_array();
        rows_array(py, mesh.positions().iter().map(place).collect())
    }

    /// The vertices of each triangle, as an array of shape (n, 3).
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        pictures::load_numpy(py)?;
        let triangles = work(py, 0, |_| {
            let mesh = &self.model.mesh;
            let corners = mesh.corners();
            let vertices = |corner: u32| corners[corner as usize].position;
            Ok(mesh.triangles().iter().map(|it| it.corners.map(vertices)).collect())
        })?;
        rows_array(py, triangles)
    }

    /// The number of polygons.
    #[getter]
    fn polygons(&self) -> usize {
        self.model.mesh.polygon_count()
    }

    /// The smallest and the largest corner of the bounding box; `None` without vertices.
    #[getter]
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let (bounds, offset) = (self.model.mesh.bounds()?, self.model.mesh.offset());
        Some([bounds.min, bounds.max].map(|corner| (corner + offset).to_array()))
    }
}

fn rows_array<T: numpy::Element, const N: usize>(
    py: Python<'_>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, N])
}
