//! The triangles of an STL file, and the model that they make.

use std::collections::HashMap;

use super::colors::Rgb;
use crate::error::LoadError;
use crate::findings::{FindingKind, Findings, joined};
use crate::loaded::{Loaded, place};
use crate::packed::model_name;
use crate::progress::{Cancelled, Progress};
use marraztu_core::scene::{
    CornerLists, FileMaterial, LoadOptions, Material, Mesh, MeshSource, Model, NONE, Part,
    PartNames, Smoothing, Winding, split_positions,
};

/// The number of triangles between two progress checks.
pub(super) const PIECE: usize = 1 << 16;

/// The triangles of a file.
#[derive(Debug, Default)]
pub(super) struct Solids {
    /// The positions of vertices.
    positions: Vec<[f64; 3]>,
    /// The vertex at each position, by the bits of its coordinates.
    places: HashMap<[u32; 3], u32>,
    /// The vertices of each triangle's corners.
    corners: Vec<u32>,
    /// The name of each solid with triangles, and its first triangle.
    solids: Vec<(String, usize)>,
    /// The colour of each triangle; empty if no triangle has one.
    pub(super) colors: Vec<Option<Rgb>>,
}

impl Solids {
    /// Begins a solid. A solid without triangles is dropped when the next one begins.
    pub(super) fn begin(&mut self, name: String) {
        let triangles = self.triangles();
        self.solids.pop_if(|(_, first)| *first == triangles);
        self.solids.push((name, triangles));
    }

    /// Adds a triangle; returns whether its corners are finite. Others are left out.
    pub(super) fn add(&mut self, triangle: [[f32; 3]; 3]) -> bool {
        if !triangle.as_flattened().iter().all(|x| x.is_finite()) {
            return false;
        }
        for corner in triangle {
            // 0 and -0 are the same position.
            let next = u32::try_from(self.positions.len()).unwrap_or(NONE);
            let place = *self.places.entry(corner.map(|x| (x + 0.0).to_bits())).or_insert(next);
            if place == next {
                self.positions.push(corner.map(f64::from));
            }
            self.corners.push(place);
        }
        true
    }

    pub(super) fn triangles(&self) -> usize {
        self.corners.len() / 3
    }

    /// Returns the parts: the triangles of a solid with equal colours.
    fn parts(&self, progress: &Progress) -> Result<Parts, Cancelled> {
        let mut parts = Parts::default();
        let mut places: HashMap<(usize, Option<Rgb>), u32> = HashMap::new();
        // The end of each solid is the start of the next.
        let ends = self.solids.iter().skip(1).map(|(_, first)| *first);
        let mut ends = ends.chain([usize::MAX]).enumerate().peekable();
        let mut last = None;
        for triangle in 0..self.triangles() {
            if triangle.is_multiple_of(PIECE) {
                progress.reached(triangle, self.triangles())?;
            }
            while ends.next_if(|(_, end)| *end <= triangle).is_some() {}
            let solid = ends.peek().map_or(0, |(solid, _)| *solid);
            let key = (solid, self.colors.get(triangle).copied().flatten());
            // Neighbours mostly belong to one part, and hashing takes longer than comparing.
            let place = match last {
                Some((same, place)) if same == key => place,
                _ => *places.entry(key).or_insert_with(|| {
                    let name = self.solids.get(solid).map_or("", |(name, _)| name);
                    parts.push(name, key.1)
                }),
            };
            last = Some((key, place));
            parts.of_triangles.push(place);
        }
        Ok(parts)
    }

    /// Builds the model.
    pub(super) fn model(
        self,
        file: &str,
        options: &LoadOptions,
        mut findings: Findings,
        progress: &Progress,
    ) -> Result<Loaded, LoadError> {
        let parts = self.parts(&progress.part(0.0, 0.3))?;
        let Self { mut positions, mut corners, .. } = self;
        let progress = progress.part(0.3, 1.0);
        place(&mut positions, &mut [], options);
        if options.winding == Winding::Turned {
            corners.as_chunks_mut::<3>().0.iter_mut().for_each(|corners| corners.reverse());
        }
        let (offset, positions) = split_positions(&positions, &corners);
        if !positions.iter().flatten().all(|x| x.is_finite()) {
            return Err(LoadError::file(file, "the coordinates are too large at this scale"));
        }
        progress.reached(1, 10)?;
        let source = MeshSource {
            offset,
            positions,
            arities: vec![3; parts.of_triangles.len()],
            polygon_parts: parts.of_triangles,
            parts: parts.list,
            part_names: parts.names,
            smoothing: Smoothing::Crease(options.crease),
            ..MeshSource::default()
        };
        let lists = CornerLists { positions: corners, ..CornerLists::default() };
        let mesh = Mesh::from_lists(source, lists);
        let mesh = mesh.map_err(|error| LoadError::file(file, error.to_string()))?;
        findings.note_all(FindingKind::FaceNoArea, mesh.without_area().len(), None);
        findings.note_inside_out(&mesh);
        progress.reached(1, 1)?;
        let model = Model::of_mesh(&model_name(file), mesh);
        let model = Model { options: *options, materials: parts.materials, ..model };
        Ok(Loaded { model, findings: joined(findings.into_list()) })
    }
}

/// The parts of a model.
#[derive(Debug, Default)]
struct Parts {
    list: Vec<Part>,
    names: Vec<PartNames>,
    materials: Vec<FileMaterial>,
    /// The material of each colour.
    colors: HashMap<Rgb, u32>,
    /// The part of each triangle.
    of_triangles: Vec<u32>,
}

impl Parts {
    /// Adds a part of a solid, which may have no name, and returns its index.
    fn push(&mut self, solid: &str, color: Option<Rgb>) -> u32 {
        let index = |length: usize| u32::try_from(length).unwrap_or(NONE);
        let material = color.map(|color| {
            *self.colors.entry(color).or_insert_with(|| {
                self.materials.push(material_of(color));
                index(self.materials.len() - 1)
            })
        });
        let of_file = material.and_then(|material| self.materials.get(material as usize));
        let of_file = of_file.map(|material| material.name.clone());
        let object = Some(solid.to_owned()).filter(|name| !name.is_empty());
        let place = self.list.len();
        let name = object.clone().or_else(|| of_file.clone());
        let name = name.unwrap_or_else(|| format!("part {}", place + 1));
        self.list.push(Part { name, material });
        self.names.push(PartNames { object, material: of_file, ..PartNames::default() });
        index(place)
    }
}

/// Returns the matt material of a colour.
fn material_of(color: Rgb) -> FileMaterial {
    let diffuse = color.map(|byte| f64::from(byte) / 255.0);
    let [r, g, b] = color;
    let material = Material::matte(diffuse.map(|x| 0.2 * x), diffuse);
    FileMaterial::new(&format!("rgb_{r:02x}{g:02x}{b:02x}"), material)
}
