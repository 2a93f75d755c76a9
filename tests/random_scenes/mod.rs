//! Small random scenes that favour border cases: a light on a surface, a cone that touches a
//! bounding box, a face that ends at a tile border, coefficients of 0, -0 and the smallest number,
//! apertures of 0 and 90 degrees.

#![allow(dead_code, reason = "each test uses its own part of it")]

pub(crate) mod shapes;

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};

use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{
    Arithmetic, BumpFilter, Filter, LightAt, LightValues, Samples, Settings, ShadowMethod,
    SpecularForm, Tangents, Terminator,
};
use marraztu_core::base::image::Size;
use marraztu_core::base::rng::Rng;
use marraztu_core::base::{color::Color, math};
use marraztu_core::scene::{
    Aim, Attenuation, Camera, CameraId, Fill, Lens, Light, LightId, LightKind, List,
    MaterialChoice, Normals, Object, ObjectId, Observer, Orbit, PolygonMode, Pose, PresetId,
    Projection, Scene, Sides, SpotOwner, Surface, Tracked, View,
};
use marraztu_render::FramePlan;
use marraztu_render::plan_frame;

use self::shapes::shapes;

/// A scene with view, settings and size: everything its picture depends on.
#[derive(Clone, Debug)]
pub(crate) struct RandomScene {
    pub(crate) seed: u64,
    pub(crate) scene: Scene,
    pub(crate) view: View,
    pub(crate) settings: Settings,
    pub(crate) size: Size,
}

impl RandomScene {
    /// The plan of the scene's picture.
    pub(crate) fn plan(&self) -> FramePlan {
        plan_frame(&Shot::new(&self.scene, &self.view, &self.settings, self.size))
    }
}

/// The first id of objects; lower ids stay free.
const FIRST_OBJECT: u32 = 100;

/// An id without an item.
const UNUSED: u32 = 99;

/// Generates the scene of a seed.
pub(crate) fn random_scene(seed: u64) -> RandomScene {
    let rng = &mut Rng::new(seed);
    // One tile, or four with borders in the middle of the scene.
    let size = if rng.percent(75) { Size::new(32, 32) } else { Size::new(96, 72) };
    let cameras = cameras(rng, size);
    let count = 1 + rng.index(3);
    let objects: Vec<(ObjectId, Object)> =
        (FIRST_OBJECT..).map(ObjectId).zip((0..count).map(|_| object(rng))).collect();
    let lights = lights(rng, &objects);
    let mut scene = Scene {
        locked: BTreeSet::new(),
        objects: objects.into_iter().collect(),
        cameras,
        lights,
        background: Color(rng.one_of(&[[0, 0, 179], [0; 3], [255; 3]])),
        next_id: 1000,
    };
    if rng.percent(30) {
        let reversed: Vec<_> = scene.objects.iter().map(|(id, o)| (id, o.clone())).rev().collect();
        scene.objects = List::from_iter(reversed);
    }
    let view = view(rng, &scene);
    let mut settings = settings(rng);
    if settings.filter == Filter::Bilinear {
        let smooth = [Filter::Bilinear, Filter::Trilinear, Filter::Anisotropic];
        settings.filter = smooth[usize::try_from(seed % 3).unwrap_or(0)];
    }
    RandomScene { seed, view, settings, scene, size }
}

/// Cameras with one unit per pixel in orthographic projection.
fn cameras(rng: &mut Rng, size: Size) -> List<CameraId, Camera> {
    #[expect(clippy::cast_precision_loss, reason = "a small picture")]
    let half_size = size.width.min(size.height) as f64 / 2.0;
    let camera = |rng: &mut Rng, name: &str| {
        let distance = rng.one_of(&[20.0, 60.0, 60.0, 60.0, 300.0]);
        let mut pose = Pose::facing_minus_z(DVec3::Z * distance);
        if rng.percent(40) {
            let yaw = rng.real(-0.4, 0.4);
            pose.axes =
                math::rotation(DVec3::Y, yaw) * math::rotation(DVec3::X, rng.real(-0.3, 0.3));
            pose.eye = pose.axes * pose.eye;
        }
        let near = rng.one_of(&[1.0, 0.01, 55.0]);
        let shift = shift(rng, size);
        Camera {
            name: name.to_owned(),
            visible: rng.percent(90),
            model: shapes()[rng.index(2)].clone(),
            material: MaterialChoice::Preset(PresetId::OBSIDIAN),
            pose: Tracked::new(pose),
            lens: Lens { near, half_size, shift, ..Lens::default() },
        }
    };
    let first = camera(rng, "camera 1");
    let second = camera(rng, "camera 2");
    let all = [(CameraId(0), first), (CameraId(1), second)];
    let count = if rng.percent(20) { 2 } else { 1 };
    all.into_iter().take(count).collect()
}

/// A lens shift by whole pixels, so faces stay on borders of pixels. It leaves the random numbers
/// of everything else as they are.
#[expect(clippy::cast_precision_loss, reason = "a small picture")]
fn shift(rng: &Rng, size: Size) -> [f64; 2] {
    let mut rng = rng.clone();
    let shorter = size.width.min(size.height) as f64;
    let sides = [size.width, size.height].map(|side| side as f64 / 2.0);
    if rng.percent(70) {
        return [0.0; 2];
    }
    sides.map(|side| rng.real(-side, side).round() / shorter)
}

/// A random position. Integers put faces on borders of pixels and tiles.
fn place(rng: &mut Rng) -> DVec3 {
    if rng.percent(40) {
        let whole = |rng: &mut Rng| rng.real(-40.0, 40.0).round();
        return DVec3::new(whole(rng), whole(rng), rng.one_of(&[0.0, -8.0, 10.0]));
    }
    let reach = rng.one_of(&[5.0, 20.0, 60.0]);
    let part = |rng: &mut Rng| rng.real(-1.0, 1.0);
    DVec3::new(part(rng), part(rng), part(rng)) * reach
}

fn turn(rng: &mut Rng) -> DMat3 {
    if rng.percent(40) {
        return DMat3::IDENTITY;
    }
    math::rotation(direction(rng), rng.real(-3.2, 3.2))
}

fn direction(rng: &mut Rng) -> DVec3 {
    if rng.percent(30) {
        return rng.one_of(&[
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            DVec3::NEG_X,
            DVec3::NEG_Y,
            DVec3::NEG_Z,
        ]);
    }
    let part = |rng: &mut Rng| rng.real(-1.0, 1.0);
    let v = DVec3::new(part(rng), part(rng), part(rng));
    math::unit(v).unwrap_or(DVec3::NEG_Z)
}

fn object(rng: &mut Rng) -> Object {
    let material = match rng.index(4) {
        0 => MaterialChoice::File,
        1 => MaterialChoice::Preset(rng.one_of(&PresetId::all().collect::<Vec<_>>())),
        _ => MaterialChoice::Own(shapes::material(rng)),
    };
    let mut model = rng.one_of(shapes());
    if rng.percent(20) {
        model = shapes::mapped(rng);
    }
    let scale = match rng.index(10) {
        // A box around the camera, so its faces are clipped.
        0 => DVec3::splat(400.0),
        1 => DVec3::new(-6.0, 9.0, 3.0),
        2..5 => DVec3::splat(rng.one_of(&[1.0, 4.0, 16.0, 32.0])),
        _ => DVec3::splat(rng.real(1.0, 30.0)),
    };
    let axes = turn(rng) * DMat3::from_diagonal(scale);
    let mut object = Object::new(model, material);
    object.placement = Tracked::new(math::placed(axes, place(rng)));
    object.visible = rng.percent(92);
    object.surface = rng.one_of(&[
        Surface::Material,
        Surface::Texture,
        Surface::TextureAndLight,
        Surface::TextureAndLight,
    ]);
    object.texture = rng.percent(35).then(|| shapes::texture(rng));
    object.tint = rng.one_of(&[Color::WHITE, Color::WHITE, Color([0; 3]), Color([200, 100, 0])]);
    if rng.percent(25) {
        object.opacity = rng.one_of(&[0.0, 1e-9, 0.25, 0.5, 0.75, 1.0 - f64::EPSILON]);
    }
    object.sides = if rng.percent(20) { Sides::Two } else { Sides::One };
    object.file_normals = rng.percent(50);
    if rng.percent(5) {
        object.hidden_parts.insert(0);
    }
    object
}

fn lights(rng: &mut Rng, objects: &[(ObjectId, Object)]) -> List<LightId, Light> {
    let count = rng.index(8);
    let light = |rng: &mut Rng, slot: u32| {
        let kind = match rng.index(6) {
            0 => LightKind::Ambient,
            1 => LightKind::Sun { direction: Tracked::new(direction(rng)) },
            2 | 3 => LightKind::Bulb {
                position: Tracked::new(lamp_place(rng, objects)),
                orbit: Orbit::default(),
            },
            _ => spot(rng, objects),
        };
        // Dark lights and extreme attenuations test the rules for leaving lights out.
        let levels = [0, 1, 128, 255];
        let color = if rng.percent(15) { [0; 3] } else { [0; 3].map(|_| rng.one_of(&levels)) };
        let attenuation = |constant, linear, quadratic| Attenuation { constant, linear, quadratic };
        Light {
            on: rng.percent(75),
            shadows: rng.percent(40),
            color: Color(color),
            attenuation: rng.one_of(&[
                Attenuation::default(),
                attenuation(1.0, 0.0, 0.0),
                attenuation(0.0, 0.02, 0.0),
                attenuation(0.0, 0.0, 0.001),
                attenuation(1.0, 0.5, 0.5),
            ]),
            ..Light::new("light", slot, kind)
        }
    };
    (10..).zip((0..count).map(|_| ())).map(|(id, ())| (LightId(id), light(rng, id))).collect()
}

/// The position of a light: anywhere, or exactly on an object's surface.
fn lamp_place(rng: &mut Rng, objects: &[(ObjectId, Object)]) -> DVec3 {
    match rng.index(3) {
        0 => {
            let (_, object) = &objects[rng.index(objects.len())];
            let mesh = &object.model.mesh;
            let triangle = mesh.triangles()[rng.index(mesh.triangles().len())];
            let corners = triangle.corners.map(|c| mesh.corners()[c as usize].position as usize);
            let [a, b, c] = corners.map(|at| marraztu_core::scene::dvec3(mesh.positions()[at]));
            let place = rng.one_of(&[a, (a + b) / 2.0, (a + b + c) / 3.0]);
            object.placement.now().transform_point3(place)
        }
        _ => place(rng) * rng.one_of(&[1.0, 1.0, 4.0]),
    }
}

fn spot(rng: &mut Rng, objects: &[(ObjectId, Object)]) -> LightKind {
    let exponent = rng.one_of(&[0.0, 0.0, 0.5, 5.0, 30.0]);
    let owner = match rng.index(8) {
        0 => Some(SpotOwner::SelectedObject),
        1 => Some(SpotOwner::SelectedCamera),
        2 => Some(SpotOwner::Object(ObjectId(rng.one_of(&[FIRST_OBJECT, UNUSED])))),
        _ => None,
    };
    let aperture = |rng: &mut Rng| match rng.index(3) {
        0 => rng.one_of(&[0.0, 1e-6, 0.5, 45.0, 89.9999, 90.0]),
        _ => rng.real(0.5, 40.0),
    };
    if let Some(owner) = owner {
        return LightKind::Spot { owner, half_aperture: aperture(rng), exponent };
    }
    let (position, direction) = (lamp_place(rng, objects), direction(rng));
    let mut half_aperture = aperture(rng);
    if rng.percent(40) {
        // The cone touches, or nearly touches, a corner of an object's bounding box.
        let (_, object) = &objects[rng.index(objects.len())];
        let corners = object.model.mesh.bounds().map(|bounds| bounds.corners());
        let corner = corners.map_or(DVec3::ZERO, |corners| rng.one_of(&corners));
        let way: DMat4 = *object.placement.now();
        let way = way.transform_point3(corner) - position;
        let angle = libm::atan2(direction.cross(way).length(), direction.dot(way)).to_degrees();
        let beside = rng.one_of(&[0.0, 0.0, 1e-9, -1e-9, 1e-4, -1e-4, 0.1, -0.1]);
        half_aperture = (angle + beside).clamp(0.0, 90.0);
    }
    let owner = SpotOwner::Fixed(Tracked::new(Aim { position, direction }));
    LightKind::Spot { owner, half_aperture, exponent }
}

fn view(rng: &mut Rng, scene: &Scene) -> View {
    let polygons = rng.percent(6).then(PolygonMode::begin);
    View {
        object: scene.objects.ids().nth(rng.index(4)).or_else(|| scene.objects.first()),
        observer: if rng.percent(4) { Observer::Object } else { Observer::Camera },
        projection: rng.one_of(&[
            Projection::Perspective,
            Projection::Perspective,
            Projection::Orthographic,
        ]),
        fill: if rng.percent(8) { Fill::Edges } else { Fill::Filled },
        edges_over_fill: rng.percent(8),
        polygons,
        only_selected: rng.percent(8),
        normals: rng.one_of(&[Normals::Vertex, Normals::Face]),
        back_faces: rng.percent(20),
        face_normals: rng.percent(4),
        vertex_normals: rng.percent(4),
        marks: rng.percent(50),
        wide_lines: rng.percent(10),
        ..scene.first_view()
    }
}

/// Usually one sample, because more take longer.
fn samples(rng: &mut Rng) -> Samples {
    match rng.percent(25) {
        true if rng.percent(10) => rng.one_of(&[Samples::Sixteen, Samples::SixtyFour]),
        true => Samples::Four,
        false => Samples::One,
    }
}

fn settings(rng: &mut Rng) -> Settings {
    let at = [LightAt::Face, LightAt::Vertex, LightAt::Pixel, LightAt::Pixel, LightAt::Pixel];
    let settings = Settings {
        arithmetic: if rng.percent(8) { Arithmetic::F64 } else { Arithmetic::F32 },
        light: rng.one_of(&at),
        samples: samples(rng),
        filter: rng.one_of(&[Filter::Nearest, Filter::Bilinear]),
        specular: rng.one_of(&[SpecularForm::Reflection, SpecularForm::HalfVector]),
        tangents: rng.one_of(&[Tangents::Vertex, Tangents::Pixel]),
        bump_filter: rng.one_of(&[BumpFilter::Nearest, BumpFilter::Trilinear]),
        light_values: rng.one_of(&[
            LightValues::Stored,
            LightValues::Stored,
            LightValues::Stored,
            LightValues::Linear,
        ]),
        shadow_method: match rng.percent(20) {
            true => rng.one_of(&[ShadowMethod::Map512, ShadowMethod::Map2048Pcf]),
            false => ShadowMethod::Exact,
        },
        terminator: rng.one_of(&[Terminator::Triangles, Terminator::Smooth]),
        ..Settings::default()
    };
    // Rare, because every sample is shaded.
    let several = [Samples::Four, Samples::Sixteen].contains(&settings.samples);
    let each = several && settings.light == LightAt::Pixel && rng.percent(30);
    if each { Settings { light: LightAt::Sample, ..settings } } else { settings }
}
