//! Exports a scene as glTF 2.0: meshes with their placements, cameras and lights.
//!
//! Positions stay in the object's own space, bit for bit. Where the format knows less than the
//! scene, it is approximated, and said:
//!
//! * colours are display values here and linear there: `c = ((s + 0.055) / 1.055)^2.4`;
//! * Phong's exponent n becomes roughness r = (2 / (4 n + 2))^(1/4): Blinn's exponent is about 4 n,
//!   and that of a microfacet distribution is 2 / alpha^2 - 2 with alpha = r^2 (Walter et al.,
//!   "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007);
//! * lamps fade with the square of the distance there: theirs is the light that arrives at the
//!   middle of the scene; light from everywhere is left out.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4, DVec3};
use gltf_json::extensions::scene::khr_lights_punctual as punctual;
use gltf_json::material::{AlphaCutoff, AlphaMode, PbrBaseColorFactor, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::Node;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Index, Root, extensions, image, material, texture};

use super::Content;
use super::gltf_buffer::{Buffer, Limits, Vertices};
use super::look::{Look, Looks, polygons};
use crate::base::math;
use crate::scene::{
    Attenuation, Camera, Light, LightKind, MapKind, NONE, Object, Projection, Scene,
};
use crate::scene::{SpotOwner, Texture, View, Wrap, dvec3};

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

struct Writer<'a> {
    scene: &'a Scene,
    view: &'a View,
    root: Root,
    buffer: Buffer,
    looks: Looks,
    nodes: Vec<Index<Node>>,
    notes: Vec<String>,
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

/// A name in a URI: everything but letters, digits, `-`, `_` and `.` as percent and digits.
fn escaped(name: &str) -> String {
    let byte = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => {
            char::from(byte).to_string()
        }
        _ => format!("%{byte:02X}"),
    };
    name.bytes().map(byte).collect()
}

/// A .glb file: a header of 12 bytes, and the text and the buffer as chunks.
fn binary(mut text: Vec<u8>, mut buffer: Vec<u8>) -> Result<Vec<u8>, String> {
    text.resize(text.len().next_multiple_of(4), b' ');
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let length = |bytes: usize| u32::try_from(bytes).map_err(|_| "it is too large".to_owned());
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
    fn node(&mut self, mut node: Node) {
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

    fn uses(&mut self, extension: &str) {
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

    fn camera(&mut self, camera: &Camera) {
        let lens = &camera.lens;
        let is_perspective = self.view.projection == Projection::Perspective;
        let perspective = gltf_json::camera::Perspective {
            aspect_ratio: None,
            yfov: single(2.0 * lens.half_angle.to_radians()),
            zfar: Some(single(lens.far)),
            znear: single(lens.near),
            extensions: None,
            extras: Default::default(),
        };
        let orthographic = gltf_json::camera::Orthographic {
            xmag: single(lens.half_size),
            ymag: single(lens.half_size),
            zfar: single(lens.parallel_far),
            znear: single(lens.parallel_near.max(0.0)),
            extensions: None,
            extras: Default::default(),
        };
        let index = self.root.push(gltf_json::Camera {
            name: Some(camera.name.clone()),
            orthographic: (!is_perspective).then_some(orthographic),
            perspective: is_perspective.then_some(perspective),
            type_: Checked::Valid(match is_perspective {
                true => gltf_json::camera::Type::Perspective,
                false => gltf_json::camera::Type::Orthographic,
            }),
            extensions: None,
            extras: Default::default(),
        });
        let matrix = Some(columns(&camera.pose.now().world_from_camera()));
        let name = Some(camera.name.clone());
        self.node(Node { camera: Some(index), matrix, name, ..Node::default() });
    }

    fn lights(&mut self) {
        let mut all = Vec::new();
        let mut left_out = 0;
        for (_, light) in self.scene.lights.iter().filter(|(_, light)| light.on) {
            match self.light(light) {
                Some((own, world)) => all.push((own, world)),
                None => left_out += 1,
            }
        }
        if left_out > 0 {
            let text = "glTF has no light from everywhere, and no spot of nothing: left out";
            self.notes.push(format!("{text}: {left_out}"));
        }
        if all.is_empty() {
            return;
        }
        self.uses("KHR_lights_punctual");
        let mut lights = Vec::new();
        for (i, (light, world)) in (0..).zip(all) {
            let of_node = punctual::KhrLightsPunctual { light: Index::new(i) };
            let extensions = extensions::scene::Node { khr_lights_punctual: Some(of_node) };
            let (name, matrix) = (light.name.clone(), Some(columns(&world)));
            self.node(Node { extensions: Some(extensions), name, matrix, ..Node::default() });
            lights.push(light);
        }
        let of_root = extensions::root::KhrLightsPunctual { lights };
        self.root.extensions = Some(extensions::root::Root { khr_lights_punctual: Some(of_root) });
    }

    /// A light with its place in the world; `None` if glTF has none of its kind.
    fn light(&self, light: &Light) -> Option<(punctual::Light, DMat4)> {
        let along = |direction: DVec3| {
            math::frame(-direction, DVec3::Y, DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y))
        };
        let (kind, world, spot) = match &light.kind {
            LightKind::Ambient => return None,
            LightKind::Sun { direction } => {
                let world = math::placed(along(*direction.now()), DVec3::ZERO);
                (punctual::Type::Directional, world, None)
            }
            LightKind::Bulb { position, orbit } => {
                let at = orbit.at(*position.now(), self.view.time);
                (punctual::Type::Point, DMat4::from_translation(at), None)
            }
            LightKind::Spot { owner, half_aperture, .. } => {
                let world = match owner {
                    SpotOwner::SelectedObject => self.object_frame(self.view.object?)?,
                    SpotOwner::Object(id) => self.object_frame(*id)?,
                    SpotOwner::SelectedCamera => {
                        self.scene.selected_camera(self.view).pose.now().world_from_camera()
                    }
                    SpotOwner::Camera(id) => {
                        self.scene.cameras.get(*id)?.pose.now().world_from_camera()
                    }
                    SpotOwner::Fixed(aim) => {
                        math::placed(along(aim.now().direction), aim.now().position)
                    }
                };
                let outer_cone_angle = single(half_aperture.to_radians());
                let spot = punctual::Spot { inner_cone_angle: 0.0, outer_cone_angle };
                (punctual::Type::Spot, world, Some(spot))
            }
        };
        let intensity = match kind {
            punctual::Type::Directional => 1.0,
            punctual::Type::Point | punctual::Type::Spot => {
                self.candela(&light.attenuation, world.w_axis.truncate())
            }
        };
        let light = punctual::Light {
            color: light.color.factors().map(linear),
            extensions: None,
            extras: Default::default(),
            intensity,
            name: Some(light.name.clone()),
            range: None,
            spot,
            type_: Checked::Valid(kind),
        };
        Some((light, world))
    }

    /// The frame of an object that a spot shines from.
    fn object_frame(&self, id: crate::scene::ObjectId) -> Option<DMat4> {
        let world = self.scene.objects.get(id)?.world_from_object(self.view.time);
        let turn = DMat3::from_mat4(world);
        let axes = math::frame(turn.z_axis, turn.y_axis, DMat3::IDENTITY);
        Some(math::placed(axes, world.w_axis.truncate()))
    }

    /// The intensity with which a lamp that fades with the square of the distance lights the middle
    /// of the scene as this one does.
    fn candela(&self, fades: &Attenuation, at: DVec3) -> f32 {
        let objects = self.scene.objects.iter().filter(|(_, object)| object.visible);
        let centres = objects.map(|(_, object)| object.centre(self.view.time));
        let (sum, count) = centres.fold((DVec3::ZERO, 0.0), |(sum, n), p| (sum + p, n + 1.0));
        let d = if count > 0.0 { at.distance(sum / count).max(1.0) } else { 1.0 };
        single(d * d / (fades.constant + fades.linear * d + fades.quadratic * d * d))
    }
}

/// A material: Phong's as metallic roughness.
fn surface(i: usize, look: &Look, infos: [Option<texture::Info>; 3]) -> gltf_json::Material {
    let [info, emissive, normal] = infos;
    let normal = normal.map(|info| material::NormalTexture {
        index: info.index,
        scale: 1.0,
        tex_coord: 0,
        extensions: None,
        extras: Default::default(),
    });
    let base = match (&look.texture, look.colored) {
        (Some(_), _) => look.tint,
        (None, true) => [1.0; 3],
        (None, false) => look.material.diffuse,
    };
    let [r, g, b] = base.map(linear);
    let has_holes = look.texture.as_ref().is_some_and(|it| it.picture.least_alpha() < 255);
    let unlit = look.unlit.then(extensions::material::Unlit::default);
    gltf_json::Material {
        alpha_cutoff: has_holes.then_some(AlphaCutoff(0.5)),
        alpha_mode: Checked::Valid(match (has_holes, look.opacity < 1.0) {
            (true, _) => AlphaMode::Mask,
            (false, true) => AlphaMode::Blend,
            (false, false) => AlphaMode::Opaque,
        }),
        double_sided: look.two_sided,
        emissive_texture: emissive,
        emissive_factor: material::EmissiveFactor(look.material.emission.map(linear)),
        normal_texture: normal,
        name: Some(format!("material {}", i + 1)),
        pbr_metallic_roughness: material::PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([r, g, b, single(look.opacity)]),
            base_color_texture: info,
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(roughness(look.material.exponent)),
            ..material::PbrMetallicRoughness::default()
        },
        extensions: Some(extensions::material::Material { unlit }),
        ..gltf_json::Material::default()
    }
}

/// The roughness for a highlight with Phong's exponent.
fn roughness(exponent: f64) -> f32 {
    single(libm::pow(2.0 / (4.0 * exponent.max(0.0) + 2.0), 0.25))
}

/// A display value as linear light (IEC 61966-2-1).
fn linear(display: f64) -> f32 {
    let s = display.clamp(0.0, 1.0);
    single(if s <= 0.04045 { s / 12.92 } else { libm::pow((s + 0.055) / 1.055, 2.4) })
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

fn columns(world: &DMat4) -> [f32; 16] {
    world.to_cols_array().map(single)
}

#[expect(clippy::cast_possible_truncation, reason = "numbers of glTF are single")]
const fn single(x: f64) -> f32 {
    x as f32
}
