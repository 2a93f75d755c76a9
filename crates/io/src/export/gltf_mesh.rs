//! Exports the objects of a scene as glTF nodes and meshes.
//!
//! An object becomes a node with its placement. If its file has several objects or groups, each
//! becomes a child node. A level that would hold a single node of the same name is left out.

use std::collections::{BTreeMap, HashMap};

use glam::{DMat3, DMat4, DQuat, DVec3};
use gltf_json::Index;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::{Node, UnitQuaternion};
use gltf_json::validation::Checked;

use super::gltf::Writer;
use super::gltf_buffer::{Vertex, Vertices, columns, is_single, single, single3};
use super::gltf_opacity::Layout;
use super::gltf_surface::linear;
use super::gltf_texture::layouts;
use super::look::{Looks, Maps, has_colors, polygons, strokes};
use marraztu_core::base::math;
use marraztu_core::scene::{MapKind, Mesh, NONE, NormalSource, Object, Stroke, Triangle, dvec3};

/// The largest scale of a placement that is written as a matrix: its entries are then accurate to
/// 1e-6.
const LARGEST_IN_MATRIX: f64 = 10.0;

/// A name from the file; `None` if the file gives no name.
type Name<'a> = Option<&'a str>;

/// The meshes of an object of a file, each with its group.
type Groups<'a> = Vec<(Name<'a>, Index<gltf_json::Mesh>)>;

/// The triangles and strokes of an object, by piece and look.
#[derive(Default)]
struct Sorted<'a> {
    /// The objects and groups of the file, in the order of their first faces, or strokes.
    pieces: Vec<(Name<'a>, Name<'a>)>,
    numbers: HashMap<(Name<'a>, Name<'a>), usize>,
    /// The piece and the look of each part, with and without maps, filled in when a triangle uses
    /// it.
    parts: HashMap<(u32, Maps), (usize, usize)>,
    triangles: BTreeMap<(usize, usize), Vec<usize>>,
    /// The lines, and the points.
    strokes: [BTreeMap<(usize, usize), Vec<&'a Stroke>>; 2],
}

impl<'a> Sorted<'a> {
    /// Returns the piece and the look of a part.
    fn key(
        &mut self,
        looks: &mut Looks,
        object: &'a Object,
        (part, maps): (u32, Maps),
    ) -> (usize, usize) {
        let Self { pieces, numbers, parts, .. } = self;
        // Looks are expensive to build, so each part is resolved once.
        *parts.entry((part, maps)).or_insert_with(|| {
            let names = object.model.mesh.part_names(part);
            let names = (names.object.as_deref(), names.group.as_deref());
            let piece = *numbers.entry(names).or_insert_with(|| {
                pieces.push(names);
                pieces.len() - 1
            });
            (piece, looks.of_part(object, part, maps))
        })
    }
}

impl Writer<'_> {
    pub(super) fn object(&mut self, object: &Object) {
        let world = object.world_from_mesh(self.view.time);
        // A glTF matrix must be a product of translation, rotation and scale. Other placements are
        // baked into the positions.
        let baked = if is_product(&world) { DMat4::IDENTITY } else { world };
        let objects = self.meshes(object, &baked);
        let node = match &objects[..] {
            [] => {
                self.notes.push(format!("{} shows nothing: it is an empty node", object.name));
                self.named(&object.name)
            }
            [(name, groups)] => {
                // A name from the user replaces the name of the file's only object.
                let only = match &groups[..] {
                    [(group, _)] if name.is_none() => *group,
                    _ => *name,
                };
                let kept = only.filter(|name| !name.is_empty() && object.name == object.model.name);
                let is_one = only != *name;
                let groups: Groups<'_> =
                    groups.iter().map(|(group, mesh)| (group.filter(|_| !is_one), *mesh)).collect();
                self.file_object(kept.unwrap_or(&object.name), &groups)
            }
            _ => {
                let parent = self.named(&object.name);
                let mut children = Vec::new();
                for (name, groups) in &objects {
                    let node = self.file_object(name.unwrap_or_default(), groups);
                    children.push(self.root.push(node));
                }
                Node { children: Some(children), ..parent }
            }
        };
        self.node(if baked == DMat4::IDENTITY { with_placement(node, &world) } else { node });
        if baked != DMat4::IDENTITY {
            let text =
                format!("{} is skewed: its placement is applied to its positions", object.name);
            self.notes.push(text);
        }
    }

    /// Makes the node of an object of a file, with child nodes for its groups.
    fn file_object(&mut self, name: &str, groups: &[(Name<'_>, Index<gltf_json::Mesh>)]) -> Node {
        let mut node = self.named(name);
        let mut children = Vec::new();
        let is_single = groups.len() == 1;
        for (group, mesh) in groups {
            match group {
                Some(group) if !(is_single && (group.is_empty() || *group == name)) => {
                    let child = Node { mesh: Some(*mesh), ..self.named(group) };
                    children.push(self.root.push(child));
                }
                _ => node.mesh = Some(*mesh),
            }
        }
        Node { children: Some(children).filter(|list| !list.is_empty()), ..node }
    }

    /// Writes the meshes of an object, by the objects and groups of its file.
    fn meshes<'a>(&mut self, object: &'a Object, baked: &DMat4) -> Vec<(Name<'a>, Groups<'a>)> {
        // One primitive per piece and look, since a primitive has one material.
        let Sorted { pieces, triangles, strokes, .. } = self.sorted(object);
        let mut by_piece: Vec<Vec<Primitive>> = pieces.iter().map(|_| Vec::new()).collect();
        for ((piece, look), triangles) in triangles {
            by_piece[piece].extend(self.primitive(object, baked, look, &triangles));
        }
        for ((piece, look), strokes) in strokes.into_iter().flatten() {
            by_piece[piece].push(self.stroke_primitive(object, baked, look, &strokes));
        }
        let mut objects: Vec<(Name<'a>, Groups<'a>)> = Vec::new();
        let mut numbers = HashMap::new();
        for ((name, group), primitives) in pieces.into_iter().zip(by_piece) {
            if primitives.is_empty() {
                continue;
            }
            let own = [group, name].into_iter().flatten().find(|name| !name.is_empty());
            let mesh = self.root.push(gltf_json::Mesh {
                extensions: None,
                extras: Default::default(),
                name: Some(own.unwrap_or(&object.name).to_owned()),
                primitives,
                weights: None,
            });
            let number = *numbers.entry(name).or_insert_with(|| {
                objects.push((name, Vec::new()));
                objects.len() - 1
            });
            objects[number].1.push((group, mesh));
        }
        objects
    }

    fn sorted<'a>(&mut self, object: &'a Object) -> Sorted<'a> {
        let mesh = &object.model.mesh;
        let mut sorted = Sorted::default();
        for triangle in polygons(object).flat_map(|polygon| mesh.triangles_of(polygon)) {
            let Triangle { corners, polygon, .. } = mesh.triangles()[triangle];
            let part = mesh.polygon_parts()[polygon as usize];
            let has_uvs = corners.iter().all(|it| mesh.corners()[*it as usize].uv != NONE);
            let maps = if has_uvs { Maps::Kept } else { Maps::LeftOut };
            let key = sorted.key(&mut self.looks, object, (part, maps));
            sorted.triangles.entry(key).or_default().push(triangle);
        }
        for stroke in strokes(object) {
            let key = sorted.key(&mut self.looks, object, (stroke.part, Maps::LeftOut));
            sorted.strokes[usize::from(stroke.is_point())].entry(key).or_default().push(stroke);
        }
        sorted
    }

    /// Writes triangles that share a look.
    fn primitive(
        &mut self,
        object: &Object,
        baked: &DMat4,
        look: usize,
        triangles: &[usize],
    ) -> Option<Primitive> {
        let mesh = &object.model.mesh;
        let is_mirrored = DMat3::from_mat4(*baked).determinant() < 0.0;
        let is_bumpy = self.looks.all[look].map(MapKind::Normal).is_some();
        let source = if object.file_normals { NormalSource::File } else { NormalSource::Computed };
        // Readers would compute different tangents for a normal map, so ours are written.
        let tangents = is_bumpy.then(|| mesh.tangents(source));
        // Corners become vertices: glTF has one index for all attributes.
        let mut vertices = Vertices::default();
        let mut indices = Vec::new();
        for triangle in triangles {
            let mut corners = std::array::from_fn(|i| {
                let corner = mesh.corners()[mesh.triangles()[*triangle].corners[i] as usize];
                vertices.number(Vertex {
                    point: if object.file_normals { corner.filed } else { corner.smooth },
                    uv: corner.uv,
                    tangent: tangents.map_or([0; 4], |all| all[*triangle][i].map(f32::to_bits)),
                })
            });
            // A baked mirror reverses the winding, which would swap front and back.
            if is_mirrored {
                corners.reverse();
            }
            indices.extend::<[u32; 3]>(corners);
        }
        if indices.is_empty() {
            return None;
        }
        // Attributes that the look does not need are left out.
        let layouts = layouts(&self.looks.all[look]);
        let (root, buffer) = (&mut self.root, &mut self.buffer);
        let mut attributes = BTreeMap::new();
        let mut put = |semantic, accessor| attributes.insert(Checked::Valid(semantic), accessor);
        let points = || vertices.all.iter().map(|it| mesh.points()[it.point as usize]);
        let positions: Vec<_> = points().map(|point| placed(baked, mesh, point.position)).collect();
        put(Semantic::Positions, buffer.positions(root, &positions));
        let normals: Vec<_> = points().map(|point| turned(baked, point.normal)).collect();
        put(Semantic::Normals, buffer.floats(root, &normals));
        if is_bumpy {
            let tangent = |(vertex, normal): (&Vertex, &[f32; 3])| {
                tangent(baked, vertex.tangent.map(f32::from_bits), *normal)
            };
            let tangents: Vec<_> = vertices.all.iter().zip(&normals).map(tangent).collect();
            put(Semantic::Tangents, buffer.floats(root, &tangents));
        }
        let uv = |it: &Vertex| mesh.uvs().get(it.uv as usize).copied().unwrap_or_default();
        for (i, layout) in (0..).zip(&layouts) {
            let uvs: Vec<_> = vertices.all.iter().map(|it| layout.laid(uv(it))).collect();
            put(Semantic::TexCoords(i), buffer.floats(root, &uvs));
        }
        // Unused texture coordinates are kept for other programs.
        if layouts.is_empty() && vertices.all.iter().any(|it| it.uv != NONE) {
            let plain = Layout::default();
            let uvs: Vec<_> = vertices.all.iter().map(|it| plain.laid(uv(it))).collect();
            put(Semantic::TexCoords(0), buffer.floats(root, &uvs));
        }
        if self.looks.all[look].colored && has_colors(object) {
            let color = |i: u32| mesh.colors()[i as usize].map(|s| linear(f64::from(s)));
            let colors: Vec<_> = points().map(|point| color(point.position)).collect();
            put(Semantic::Colors(0), buffer.floats(root, &colors));
        }
        let indices = buffer.indices(root, &indices);
        Some(Primitive {
            attributes,
            extensions: None,
            extras: Default::default(),
            indices: Some(indices),
            material: Some(Index::new(u32::try_from(look).ok()?)),
            mode: Checked::Valid(Mode::Triangles),
            targets: None,
        })
    }
}

/// Returns a position in the space of the node.
pub(super) fn placed(baked: &DMat4, mesh: &Mesh, position: u32) -> [f32; 3] {
    let position = mesh.positions()[position as usize];
    if *baked == DMat4::IDENTITY {
        return position;
    }
    single3(baked.transform_point3(dvec3(position)))
}

/// Returns a unit normal in the space of the node.
fn turned(baked: &DMat4, normal: [f32; 3]) -> [f32; 3] {
    let own = dvec3(normal);
    if *baked == DMat4::IDENTITY && (own.length_squared() - 1.0).abs() < 1e-4 {
        return normal;
    }
    let placed = math::normal_matrix(DMat3::from_mat4(*baked)) * own;
    single3(math::unit(placed).or_else(|| math::unit(own)).unwrap_or(DVec3::Y))
}

/// Returns a unit tangent in the space of the node, with the sign of the bitangent. If the texture
/// coordinates define no tangent, it is any direction orthogonal to the normal.
fn tangent(baked: &DMat4, [x, y, z, sign]: [f32; 4], normal: [f32; 3]) -> [f32; 4] {
    let turn = DMat3::from_mat4(*baked);
    let placed = math::unit(turn * dvec3([x, y, z]));
    let [x, y, z] = single3(placed.unwrap_or_else(|| dvec3(normal).any_orthonormal_vector()));
    let sign = if sign < 0.0 { -1.0 } else { 1.0 };
    [x, y, z, if turn.determinant() < 0.0 { -sign } else { sign }]
}

/// Adds a placement to a node: as a matrix, or as its factors if a scale is above
/// [`LARGEST_IN_MATRIX`]. A matrix with large f32 entries is no longer an exact product of
/// translation, rotation and scale.
fn with_placement(node: Node, world: &DMat4) -> Node {
    if *world == DMat4::IDENTITY {
        return node;
    }
    let turn = DMat3::from_mat4(*world);
    // Readers decompose a matrix, which loses precision in large entries.
    let lengths = [turn.x_axis, turn.y_axis, turn.z_axis].map(DVec3::length);
    if lengths.into_iter().all(|length| length <= LARGEST_IN_MATRIX) {
        return Node { matrix: Some(columns(world)), ..node };
    }
    // A rotation cannot mirror, so one scale takes the sign.
    let mirror = if turn.determinant() < 0.0 { -1.0 } else { 1.0 };
    let scale = DVec3::new(mirror * lengths[0], lengths[1], lengths[2]);
    let axes = turn * DMat3::from_diagonal(scale.recip());
    let rotation = DQuat::from_mat3(&axes).normalize();
    Node {
        translation: Some(single3(world.w_axis.truncate())),
        rotation: Some(UnitQuaternion(rotation.to_array().map(single))),
        scale: Some(single3(scale)),
        ..node
    }
}

/// Returns whether a placement is a product of translation, rotation and scale, within f32
/// precision.
fn is_product(world: &DMat4) -> bool {
    let turn = DMat3::from_mat4(*world);
    let axes = [turn.x_axis, turn.y_axis, turn.z_axis];
    let [x, y, z] = axes;
    let across = |a: DVec3, b: DVec3| a.dot(b).abs() <= 1e-6 * a.length() * b.length();
    let is_flat = axes.into_iter().any(|axis| axis.length() < f64::from(f32::MIN_POSITIVE));
    is_single(world) && !is_flat && across(x, y) && across(y, z) && across(z, x)
}
