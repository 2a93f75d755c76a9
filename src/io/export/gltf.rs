//! Exports a scene as glTF 2.0: meshes with their placements, cameras and lights.
//!
//! Positions stay in the object's own space, bit for bit. What the format does not know is
//! approximated, and said:
//!
//! * colours are display values here and linear there: `c = ((s + 0.055) / 1.055)^2.4`;
//! * Phong's exponent n becomes roughness r = (2 / (4 n + 2))^(1/4): Blinn's exponent is about 4 n,
//!   and that of a microfacet distribution is 2 / alpha^2 - 2 with alpha = r^2 (Walter et al.,
//!   "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007);
//! * lamps fade with the square of the distance there: theirs is the light that arrives at the
//!   middle of the scene; light from everywhere is left out.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4, DVec3};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::Node;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Index, Root, image, texture};

use super::gltf_buffer::{Buffer, Limits, Vertices, columns, single};
use super::gltf_surface::{linear, surface};
use super::look::{Looks, polygons};
use super::{Content, escaped};
use crate::base::math;
use crate::scene::{MapKind, NONE, Object, Scene, Texture, View, Wrap, dvec3};

/// The maps that glTF has, too.
const MAPS: [MapKind; 2] = [MapKind::Emission, MapKind::Normal];

/// Whether the buffer is a file of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// A text with a buffer beside it.
    Separate,
    /// One file.
    Binary,
}

pub(super) struct Writer<'a> {
    pub(super) scene: &'a Scene,
    pub(super) view: &'a View,
    pub(super) root: Root,
    buffer: Buffer,
    looks: Looks,
    nodes: Vec<Index<Node>>,
    pub(super) notes: Vec<String>,
}

/// The files.
pub(super) fn written(
    stem: &str,
    scene: &Scene,
    view: &View,
    form: Form,
) -> Result<Content, String> {
    let mut writer = Writer {
        scene,
        view,
        root: Root::default(),
        buffer: Buffer { bytes: Vec::new() },
        looks: Looks::default(),
        nodes: Vec::new(),
        notes: Vec::new(),
    };
    writer.root.asset.generator = Some("Marraztu".to_owned());
    for (_, object) in scene.objects.iter().filter(|(_, object)| object.visible) {
        writer.object(object);
    }
    writer.materials()?;
    for (_, camera) in scene.cameras.iter() {
        writer.camera(camera);
    }
    writer.lights();
    let Writer { mut root, buffer, nodes, notes, .. } = writer;
    let all = gltf_json::Scene {
        extensions: None,
        extras: Default::default(),
        name: Some(stem.to_owned()),
        nodes,
    };
    root.scene = Some(root.push(all));
    let uri = (form == Form::Separate).then(|| format!("{}.bin", escaped(stem)));
    root.buffers.push(gltf_json::Buffer {
        byte_length: USize64::from(buffer.bytes.len()),
        name: None,
        uri,
        extensions: None,
        extras: Default::default(),
    });
    let text = root.to_vec().map_err(|error| error.to_string())?;
    let files = match form {
        Form::Separate => {
            vec![(format!("{stem}.bin"), buffer.bytes), (format!("{stem}.gltf"), text)]
        }
        Form::Binary => vec![(format!("{stem}.glb"), binary(text, buffer.bytes)?)],
    };
    Ok(Content { files, notes })
}

/// A .glb file: a header of 12 bytes, and the text and the buffer as chunks.
fn binary(mut text: Vec<u8>, mut buffer: Vec<u8>) -> Result<Vec<u8>, String> {
    text.resize(text.len().next_multiple_of(4), b' ');
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let length = |bytes: usize| u32::try_from(bytes).map_err(|_large| "it is too large".to_owned());
    let whole = length(12 + 8 + text.len() + 8 + buffer.len())?;
    let mut file = Vec::with_capacity(12 + 16 + text.len() + buffer.len());
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend(whole.to_le_bytes());
    for (kind, bytes) in [(b"JSON", text), (b"BIN\0", buffer)] {
        file.extend(length(bytes.len())?.to_le_bytes());
        file.extend(kind);
        file.extend(bytes);
    }
    Ok(file)
}

impl Writer<'_> {
    fn object(&mut self, object: &Object) {
        let world = object.world_from_object(self.view.time);
        // A matrix of glTF has to be a product of moving, turning and scaling: others go into the
        // positions.
        let baked = if is_product(&world) { DMat4::IDENTITY } else { world };
        let mut by_look: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for polygon in polygons(object) {
            let part = object.model.mesh.polygon_parts()[polygon as usize];
            by_look.entry(self.looks.number(object, part)).or_default().push(polygon);
        }
        let primitives: Vec<Primitive> = by_look
            .into_iter()
            .filter_map(|(look, polygons)| self.primitive(object, &baked, look, &polygons))
            .collect();
        if primitives.is_empty() {
            return;
        }
        let mesh = self.root.push(gltf_json::Mesh {
            extensions: None,
            extras: Default::default(),
            name: Some(object.name.clone()),
            primitives,
            weights: None,
        });
        let matrix =
            (baked == DMat4::IDENTITY && world != DMat4::IDENTITY).then(|| columns(&world));
        let name = Some(object.name.clone());
        self.node(Node { mesh: Some(mesh), matrix, name, ..Node::default() });
        if baked != DMat4::IDENTITY {
            let text = format!("{} is skewed: its placement is in its positions", object.name);
            self.notes.push(text);
        }
    }

    /// Adds a node; some readers want no two of the same name.
    pub(super) fn node(&mut self, mut node: Node) {
        if let Some(name) = &node.name {
            let taken =
                |name: &String| self.root.nodes.iter().any(|it| it.name.as_ref() == Some(name));
            let numbered = (2..).map(|number| format!("{name} {number}"));
            let mut names = std::iter::once(name.clone()).chain(numbered);
            node.name = names.find(|name| !taken(name));
        }
        let node = self.root.push(node);
        self.nodes.push(node);
    }

    /// The triangles of some polygons of one look.
    fn primitive(
        &mut self,
        object: &Object,
        baked: &DMat4,
        look: usize,
        polygons: &[u32],
    ) -> Option<Primitive> {
        let mesh = &object.model.mesh;
        let is_turned = DMat3::from_mat4(*baked).determinant() < 0.0;
        let mut vertices = Vertices::default();
        let mut indices = Vec::new();
        for triangle in polygons.iter().flat_map(|it| &mesh.triangles()[mesh.triangles_of(*it)]) {
            let mut corners = triangle.corners.map(|i| {
                let corner = mesh.corners()[i as usize];
                let point = if object.file_normals { corner.filed } else { corner.smooth };
                vertices.number(point, corner.uv)
            });
            if is_turned {
                corners.reverse();
            }
            indices.extend(corners);
        }
        if indices.is_empty() {
            return None;
        }
        let (root, buffer) = (&mut self.root, &mut self.buffer);
        let mut attributes = BTreeMap::new();
        let mut put = |semantic, accessor| attributes.insert(Checked::Valid(semantic), accessor);
        let points = || vertices.all.iter().map(|(point, _)| mesh.points()[*point as usize]);
        let position = |i: u32| placed(baked, mesh.positions()[i as usize]);
        let positions: Vec<_> = points().map(|point| position(point.position)).collect();
        put(Semantic::Positions, buffer.floats(root, &positions, Limits::Told));
        let normals: Vec<_> = points().map(|point| turned(baked, point.normal)).collect();
        put(Semantic::Normals, buffer.floats(root, &normals, Limits::LeftOut));
        if vertices.all.iter().any(|(_, uv)| *uv != NONE) {
            let texture = self.looks.all[look].texture.clone();
            let uv = |uv: u32| mesh.uvs().get(uv as usize).copied().unwrap_or_default();
            let laid = |of: &(u32, u32)| laid(texture.as_deref(), uv(of.1));
            let uvs: Vec<[f32; 2]> = vertices.all.iter().map(laid).collect();
            put(Semantic::TexCoords(0), buffer.floats(root, &uvs, Limits::LeftOut));
        }
        if !mesh.colors().is_empty() {
            let color = |i: u32| mesh.colors()[i as usize].map(|s| linear(f64::from(s)));
            let colors: Vec<_> = points().map(|point| color(point.position)).collect();
            put(Semantic::Colors(0), buffer.floats(root, &colors, Limits::LeftOut));
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

    fn materials(&mut self) -> Result<(), String> {
        let mut shown = Vec::new();
        let mut left_out = false;
        for i in 0..self.looks.all.len() {
            let look = self.looks.all[i].clone();
            let map = |kind| look.maps.iter().find(|map| map.0 == kind).map(|map| &map.1.texture);
            left_out |= look.maps.iter().any(|(kind, _)| !MAPS.contains(kind));
            let of_look = [look.texture.as_ref(), map(MAPS[0]), map(MAPS[1])];
            shown.push(
                of_look
                    .map(|texture| texture.map(|it| (it.clone(), self.looks.texture_number(it)))),
            );
        }
        if left_out {
            let text = "glTF has no maps of heights, highlights, ambient light and opacity";
            self.notes.push(format!("{text}: left out"));
        }
        for (i, bytes) in self.looks.encoded()?.into_iter().enumerate() {
            let view = self.buffer.view(&mut self.root, bytes, None);
            self.root.push(gltf_json::Image {
                buffer_view: Some(view),
                mime_type: Some(image::MimeType("image/png".to_owned())),
                name: Some(format!("texture {}", i + 1)),
                uri: None,
                extensions: None,
                extras: Default::default(),
            });
        }
        for (i, shown) in shown.into_iter().enumerate() {
            let infos = shown.map(|it| it.map(|(texture, number)| self.texture(&texture, number)));
            let look = self.looks.all[i].clone();
            if look.unlit {
                self.uses("KHR_materials_unlit");
            }
            self.root.push(surface(i, &look, infos));
        }
        Ok(())
    }

    pub(super) fn uses(&mut self, extension: &str) {
        let used = &mut self.root.extensions_used;
        if !used.iter().any(|other| other == extension) {
            used.push(extension.to_owned());
        }
    }

    fn texture(&mut self, texture: &Texture, number: usize) -> texture::Info {
        let wrap = Checked::Valid(match texture.wrap {
            Wrap::Repeat => texture::WrappingMode::Repeat,
            Wrap::Clamp => texture::WrappingMode::ClampToEdge,
        });
        let sampler = texture::Sampler {
            mag_filter: Some(Checked::Valid(texture::MagFilter::Linear)),
            min_filter: Some(Checked::Valid(texture::MinFilter::LinearMipmapLinear)),
            wrap_s: wrap,
            wrap_t: wrap,
            ..texture::Sampler::default()
        };
        let sampler = Some(self.root.push(sampler));
        let source = Index::new(u32::try_from(number - 1).unwrap_or(u32::MAX));
        let index = self.root.push(gltf_json::Texture {
            name: None,
            sampler,
            source,
            extensions: None,
            extras: Default::default(),
        });
        texture::Info { index, tex_coord: 0, extensions: None, extras: Default::default() }
    }
}

/// Texture coordinates with (0, 0) at the upper left, with the texture's own offset and scale.
fn laid(texture: Option<&Texture>, [u, v]: [f32; 2]) -> [f32; 2] {
    let Some(texture) = texture else { return [u, 1.0 - v] };
    let along = |x: f32, i: usize| f64::from(x) * texture.scale[i] + texture.offset[i];
    [single(along(u, 0)), single(1.0 - along(v, 1))]
}

fn placed(baked: &DMat4, position: [f32; 3]) -> [f32; 3] {
    if *baked == DMat4::IDENTITY {
        return position;
    }
    baked.transform_point3(dvec3(position)).as_vec3().to_array()
}

fn turned(baked: &DMat4, normal: [f32; 3]) -> [f32; 3] {
    if *baked == DMat4::IDENTITY {
        return normal;
    }
    let placed = math::normal_matrix(DMat3::from_mat4(*baked)) * dvec3(normal);
    math::unit(placed).unwrap_or(placed).as_vec3().to_array()
}

/// Whether a placement is a product of moving, turning and scaling, within the precision of f32.
fn is_product(world: &DMat4) -> bool {
    let turn = DMat3::from_mat4(*world);
    let [x, y, z] = [turn.x_axis, turn.y_axis, turn.z_axis];
    let across = |a: DVec3, b: DVec3| a.dot(b).abs() <= 1e-6 * a.length() * b.length();
    across(x, y) && across(y, z) && across(z, x)
}
