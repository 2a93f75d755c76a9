//! The facts about a model: what `marraztu info` says, as data.

use std::collections::BTreeSet;
use std::path::Path;

use serde::Serialize;

use super::error::short_name;
use super::findings::Finding;
use marraztu_core::scene::{FileMaterial, Mesh, Model, Shape, Smoothing, Stroke, Texture, Winding};

/// The shape, parts, materials and findings of a model. Serialized, it is the object that
/// `docs/json.md` describes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelFacts {
    /// The name of the model.
    pub name: String,
    /// The file that it was read from, with slashes.
    pub file: Option<String>,
    /// The name of the shape, if it is a known one such as "cube".
    pub shape: Option<&'static str>,
    /// The options that the file was read with.
    pub read_with: ReadFacts,
    /// The number of vertices.
    pub vertices: usize,
    /// The faces by size.
    pub faces: FaceFacts,
    /// The number of lines.
    pub lines: usize,
    /// The number of points.
    pub points: usize,
    /// The extent, in the coordinates of the file.
    pub bounds: Option<BoundsFacts>,
    /// The point that positions are stored relative to.
    pub offset: [f64; 3],
    /// Whether any normals are the file's, rather than computed.
    pub file_normals: bool,
    /// The rule for computed normals.
    pub smoothing: SmoothingFacts,
    /// Whether any corner has texture coordinates.
    pub texture_coordinates: bool,
    /// Whether vertices have colours.
    pub vertex_colors: bool,
    /// The edges by their faces.
    pub edges: EdgeFacts,
    /// The colour of edges in the file, in bytes.
    pub edge_color: Option<[u8; 3]>,
    /// The parts in the order of the file.
    pub parts: Vec<PartFacts>,
    /// The materials in the order of the file.
    pub materials: Vec<MaterialFacts>,
    /// Everything that was repaired, left out or odd.
    pub findings: Vec<FindingFacts>,
}

/// The options that a file was read with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReadFacts {
    /// The up axis, such as "y" or "-z".
    pub up: &'static str,
    /// The factor of coordinates.
    pub scale: f64,
    /// Whether the winding of faces was reversed.
    pub flip_winding: bool,
}

/// The numbers of faces.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FaceFacts {
    /// All faces.
    pub all: usize,
    /// Faces with three corners.
    pub triangles: usize,
    /// Faces with four corners.
    pub quads: usize,
    /// Faces with more corners.
    pub larger: usize,
    /// The most corners of a face.
    pub most_corners: usize,
    /// The triangles that all faces are drawn with.
    pub drawn_triangles: usize,
}

/// The extent of a model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoundsFacts {
    /// The smallest coordinates.
    pub min: [f64; 3],
    /// The largest coordinates.
    pub max: [f64; 3],
    /// The lengths of the sides.
    pub size: [f64; 3],
}

/// The rule for sharing computed normals.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SmoothingFacts {
    /// All normals are the file's.
    FileNormals,
    /// Edges below this angle in degrees are smooth.
    Crease(f64),
    /// The number of smoothing groups; 0 if smoothing is off.
    Groups(usize),
}

/// The numbers of edges.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EdgeFacts {
    /// Whether the surface is closed, so that back faces are never seen.
    pub closed: bool,
    /// All edges.
    pub all: usize,
    /// Edges of one face.
    pub of_one_face: usize,
    /// Edges of three or more faces.
    pub of_more_than_two: usize,
    /// Edges that are split by corners of other faces, at which gaps may show.
    pub split: usize,
}

/// A part of a model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PartFacts {
    /// The name of the object or group.
    pub name: String,
    /// The number of faces.
    pub faces: usize,
    /// The number of lines.
    pub lines: usize,
    /// The number of points.
    pub points: usize,
    /// The name of the material.
    pub material: Option<String>,
}

/// A material of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaterialFacts {
    /// The name, from `newmtl`.
    pub name: String,
    /// `Ka`.
    pub ambient: [f64; 3],
    /// `Kd`.
    pub diffuse: [f64; 3],
    /// `Ks`.
    pub specular: [f64; 3],
    /// `Ns`.
    pub exponent: f64,
    /// `Ke`.
    pub emission: [f64; 3],
    /// Whether the surface is not lit: `illum 0`.
    pub unlit: bool,
    /// `d`, from 0 to 1.
    pub opacity: f64,
    /// The texture and the maps that were found.
    pub maps: Vec<MapFacts>,
}

/// A picture of a material.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MapFacts {
    /// "texture" for `map_Kd`, and otherwise the statement.
    pub kind: &'static str,
    /// The name of the file, without its folder.
    pub file: String,
    /// The width in pixels.
    pub width: usize,
    /// The height in pixels.
    pub height: usize,
}

/// A finding.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FindingFacts {
    /// The file, as it was named.
    pub file: String,
    /// The first line, from 1.
    pub line: Option<u32>,
    /// The number of cases.
    pub count: usize,
    /// The finding as a sentence.
    pub text: String,
}

impl ModelFacts {
    /// Collects the facts about a model.
    pub fn of(model: &Model, findings: &[Finding]) -> Self {
        let mesh = &model.mesh;
        let [lines, points] = mesh.stroke_counts();
        Self {
            name: model.name.clone(),
            file: model.source.as_deref().map(with_slashes),
            shape: Shape::of(model).map(|shape| shape.name()),
            read_with: ReadFacts {
                up: model.options.up.word(),
                scale: model.options.scale.get(),
                flip_winding: model.options.winding == Winding::Turned,
            },
            vertices: mesh.positions().len(),
            faces: FaceFacts::of(mesh),
            lines,
            points,
            bounds: BoundsFacts::of(mesh),
            offset: mesh.offset().to_array(),
            file_normals: mesh.has_file_normals(),
            smoothing: SmoothingFacts::of(mesh),
            texture_coordinates: polygons(mesh).any(|polygon| mesh.has_uvs(polygon)),
            vertex_colors: !mesh.colors().is_empty(),
            edges: EdgeFacts::of(mesh),
            edge_color: model.edge_color.map(|color| color.0),
            parts: parts(model),
            materials: model.materials.iter().map(MaterialFacts::of).collect(),
            findings: findings.iter().map(FindingFacts::of).collect(),
        }
    }
}

/// Formats a path with slashes, as on every system.
pub fn with_slashes(path: &Path) -> String {
    let text = path.to_string_lossy();
    if cfg!(windows) { text.replace('\\', "/") } else { text.into_owned() }
}

/// Returns the numbers of all polygons.
fn polygons(mesh: &Mesh) -> std::ops::Range<u32> {
    0..u32::try_from(mesh.polygon_count()).unwrap_or(u32::MAX)
}

impl FaceFacts {
    fn of(mesh: &Mesh) -> Self {
        let sizes = || polygons(mesh).map(|polygon| mesh.corners_of(polygon).len());
        let of = |right: fn(&usize) -> bool| sizes().filter(right).count();
        Self {
            all: mesh.polygon_count(),
            triangles: of(|n| *n == 3),
            quads: of(|n| *n == 4),
            larger: of(|n| *n > 4),
            most_corners: sizes().max().unwrap_or(0),
            drawn_triangles: mesh.triangle_count(),
        }
    }
}

impl BoundsFacts {
    fn of(mesh: &Mesh) -> Option<Self> {
        let bounds = mesh.bounds()?;
        // Positions are stored relative to the offset; the box shows the file's.
        let [min, max] = [bounds.min, bounds.max].map(|p| (p + mesh.offset()).to_array());
        Some(Self { min, max, size: bounds.extent().to_array() })
    }
}

impl SmoothingFacts {
    fn of(mesh: &Mesh) -> Self {
        match mesh.smoothing() {
            _ if mesh.has_file_normals_only() => Self::FileNormals,
            Smoothing::Crease(crease) => Self::Crease(crease.get()),
            Smoothing::Groups(groups) => {
                let groups: BTreeSet<u32> = groups.iter().copied().filter(|i| *i != 0).collect();
                Self::Groups(groups.len())
            }
        }
    }
}

impl EdgeFacts {
    fn of(mesh: &Mesh) -> Self {
        let edges = mesh.edges();
        let sides = |right: fn(usize) -> bool| {
            edges.iter().filter(|edge| right(mesh.edge_polygons(edge).len())).count()
        };
        let of_one_face = sides(|n| n == 1);
        Self {
            closed: !edges.is_empty() && mesh.is_closed(),
            all: edges.len(),
            of_one_face,
            of_more_than_two: sides(|n| n > 2),
            // An edge that is split has one face.
            split: if of_one_face > 0 { mesh.split_edges() } else { 0 },
        }
    }
}

fn parts(model: &Model) -> Vec<PartFacts> {
    let mut parts: Vec<PartFacts> = Vec::new();
    for part in model.mesh.parts() {
        let material = part.material.and_then(|i| model.materials.get(i as usize));
        let (name, material) = (part.name.to_string(), material.map(|it| it.name.clone()));
        parts.push(PartFacts { name, faces: 0, lines: 0, points: 0, material });
    }
    for part in model.mesh.polygon_parts() {
        parts[*part as usize].faces += 1;
    }
    for stroke in model.mesh.strokes() {
        let part = &mut parts[stroke.part as usize];
        *(if Stroke::is_point(stroke) { &mut part.points } else { &mut part.lines }) += 1;
    }
    parts
}

impl MaterialFacts {
    fn of(material: &FileMaterial) -> Self {
        let m = &material.material;
        let maps = material.maps.iter().map(|(kind, map)| (kind.statement(), &*map.texture));
        let texture = material.texture.iter().map(|texture| ("texture", &**texture));
        Self {
            name: material.name.clone(),
            ambient: m.ambient,
            diffuse: m.diffuse,
            specular: m.specular,
            exponent: m.exponent,
            emission: m.emission,
            unlit: material.unlit,
            opacity: material.opacity,
            maps: texture.chain(maps).map(MapFacts::of).collect(),
        }
    }
}

impl MapFacts {
    fn of((kind, texture): (&'static str, &Texture)) -> Self {
        let size = texture.picture.size();
        let file = short_name(&texture.source);
        Self { kind, file, width: size.width, height: size.height }
    }
}

impl FindingFacts {
    /// Returns the facts about a finding.
    pub fn of(finding: &Finding) -> Self {
        let Finding { file, line, count, text, .. } = finding;
        Self { file: file.clone(), line: *line, count: *count, text: text.clone() }
    }
}
