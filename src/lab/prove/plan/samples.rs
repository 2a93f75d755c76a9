//! Small scenes by chance, which stand on borders more often than chance would: a lamp on a surface, a
//! cone that touches a box, a face that ends where a tile does, coefficients of 0, -0 and the smallest
//! number, apertures of 0 and 90.

use glam::{DMat3, DMat4, DVec3};

use super::shapes::{self, shapes};
use crate::base::image::Size;
use crate::base::{color::Color, math};
use crate::lab::prove::dice::Dice;
use crate::scene::{
    Aim, Arithmetic, Attenuation, Camera, CameraId, Fill, Filter, LeaveOut, Lens, Light, LightAt,
    LightId, LightKind, List, MaterialChoice, Normals, Object, ObjectId, Observer, Orbit, Placed,
    PolygonMode, Pose, PresetId, Projection, Samples, Scene, Settings, Sides, SpecularForm,
    SpotOwner, Surface, View,
};

/// What a picture is made of.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Its number.
    pub seed: u64,
    /// What there is.
    pub scene: Scene,
    /// How it is looked at.
    pub view: View,
    /// How exactly it is drawn.
    pub settings: Settings,
    /// The picture's.
    pub size: Size,
}

/// The ids from here on are those of objects; so there are lower ones that are free.
const FIRST_OBJECT: u32 = 100;

/// An id that nothing has.
const NOBODY: u32 = 99;

/// The scene of a seed.
#[must_use]
pub fn sample(seed: u64) -> Sample {
    let dice = &mut Dice::new(seed);
    // One tile, or four whose borders are in the middle of things.
    let size = if dice.percent(75) { Size::new(32, 32) } else { Size::new(96, 72) };
    let cameras = cameras(dice, size);
    let count = 1 + dice.index(3);
    let objects: Vec<(ObjectId, Object)> =
        (FIRST_OBJECT..).map(ObjectId).zip((0..count).map(|_| object(dice))).collect();
    let lights = lights(dice, &objects);
    let mut scene = Scene {
        objects: objects.into_iter().collect(),
        cameras,
        lights,
        background: Color(dice.pick(&[[0, 0, 179], [0; 3], [255; 3]])),
        next_id: 1000,
    };
    if dice.percent(30) {
        let reversed: Vec<_> = scene.objects.iter().map(|(id, o)| (id, o.clone())).rev().collect();
        scene.objects = List::from_iter(reversed);
    }
    let view = view(dice, &scene);
    Sample { seed, view, settings: settings(dice), scene, size }
}

/// In pixels of a picture 32 high, where one unit is one pixel in parallel projection.
fn cameras(dice: &mut Dice, size: Size) -> List<CameraId, Camera> {
    #[expect(clippy::cast_precision_loss, reason = "a small picture")]
    let half_size = size.width.min(size.height) as f64 / 2.0;
    let camera = |dice: &mut Dice, name: &str| {
        let distance = dice.pick(&[20.0, 60.0, 60.0, 60.0, 300.0]);
        let mut pose = Pose::facing_minus_z(DVec3::Z * distance);
        if dice.percent(40) {
            let yaw = dice.real(-0.4, 0.4);
            pose.axes =
                math::rotation(DVec3::Y, yaw) * math::rotation(DVec3::X, dice.real(-0.3, 0.3));
            pose.eye = pose.axes * pose.eye;
        }
        let near = dice.pick(&[1.0, 0.01, 55.0]);
        Camera {
            name: name.to_owned(),
            visible: dice.percent(90),
            model: shapes()[dice.index(2)].clone(),
            material: MaterialChoice::Preset(PresetId::OBSIDIAN),
            pose: Placed::new(pose),
            lens: Lens { near, half_size, ..Lens::default() },
        }
    };
    let first = camera(dice, "camera 1");
    let second = camera(dice, "camera 2");
    let all = [(CameraId(0), first), (CameraId(1), second)];
    let count = if dice.percent(20) { 2 } else { 1 };
    all.into_iter().take(count).collect()
}

/// Units of the world; on whole ones faces end at pixels, and at tiles.
fn place(dice: &mut Dice) -> DVec3 {
    if dice.percent(40) {
        let whole = |dice: &mut Dice| dice.real(-40.0, 40.0).round();
        return DVec3::new(whole(dice), whole(dice), dice.pick(&[0.0, -8.0, 10.0]));
    }
    let reach = dice.pick(&[5.0, 20.0, 60.0]);
    let part = |dice: &mut Dice| dice.real(-1.0, 1.0);
    DVec3::new(part(dice), part(dice), part(dice)) * reach
}

fn turn(dice: &mut Dice) -> DMat3 {
    if dice.percent(40) {
        return DMat3::IDENTITY;
    }
    math::rotation(direction(dice), dice.real(-3.2, 3.2))
}

fn direction(dice: &mut Dice) -> DVec3 {
    if dice.percent(30) {
        return dice.pick(&[
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            DVec3::NEG_X,
            DVec3::NEG_Y,
            DVec3::NEG_Z,
        ]);
    }
    let part = |dice: &mut Dice| dice.real(-1.0, 1.0);
    let v = DVec3::new(part(dice), part(dice), part(dice));
    math::unit(v).unwrap_or(DVec3::NEG_Z)
}

fn object(dice: &mut Dice) -> Object {
    let material = match dice.index(4) {
        0 => MaterialChoice::File,
        1 => MaterialChoice::Preset(dice.pick(&PresetId::all().collect::<Vec<_>>())),
        _ => MaterialChoice::Own(shapes::material(dice)),
    };
    let model = dice.pick(shapes());
    let scale = match dice.index(10) {
        // Around the camera: its faces are cut.
        0 => DVec3::splat(400.0),
        1 => DVec3::new(-6.0, 9.0, 3.0),
        2..5 => DVec3::splat(dice.pick(&[1.0, 4.0, 16.0, 32.0])),
        _ => DVec3::splat(dice.real(1.0, 30.0)),
    };
    let axes = turn(dice) * DMat3::from_diagonal(scale);
    let mut object = Object::new(model, material);
    object.placement = Placed::new(math::placed(axes, place(dice)));
    object.visible = dice.percent(92);
    object.surface = dice.pick(&[
        Surface::Material,
        Surface::Texture,
        Surface::TextureAndLight,
        Surface::TextureAndLight,
    ]);
    object.texture = dice.percent(35).then(|| shapes::texture(dice));
    object.tint = dice.pick(&[Color::WHITE, Color::WHITE, Color([0; 3]), Color([200, 100, 0])]);
    object.sides = if dice.percent(20) { Sides::Two } else { Sides::One };
    object.file_normals = dice.percent(50);
    if dice.percent(5) {
        object.hidden_parts.insert(0);
    }
    object
}

fn lights(dice: &mut Dice, objects: &[(ObjectId, Object)]) -> List<LightId, Light> {
    let count = dice.index(8);
    let light = |dice: &mut Dice, slot: u32| {
        let kind = match dice.index(6) {
            0 => LightKind::Ambient,
            1 => LightKind::Sun { direction: Placed::new(direction(dice)) },
            2 | 3 => LightKind::Bulb {
                position: Placed::new(lamp_place(dice, objects)),
                orbit: Orbit::default(),
            },
            _ => spot(dice, objects),
        };
        let levels = [0, 1, 128, 255];
        let color = if dice.percent(15) { [0; 3] } else { [0; 3].map(|_| dice.pick(&levels)) };
        let attenuation = |constant, linear, quadratic| Attenuation { constant, linear, quadratic };
        Light {
            on: dice.percent(75),
            color: Color(color),
            attenuation: dice.pick(&[
                Attenuation::default(),
                attenuation(1.0, 0.0, 0.0),
                attenuation(0.0, 0.02, 0.0),
                attenuation(0.0, 0.0, 0.001),
                attenuation(1.0, 0.5, 0.5),
            ]),
            ..Light::new("light", slot, kind)
        }
    };
    (10..).zip((0..count).map(|_| ())).map(|(id, ())| (LightId(id), light(dice, id))).collect()
}

/// Where a lamp stands: anywhere, or in the very surface of an object.
fn lamp_place(dice: &mut Dice, objects: &[(ObjectId, Object)]) -> DVec3 {
    match dice.index(3) {
        0 => {
            let (_, object) = &objects[dice.index(objects.len())];
            let mesh = &object.model.mesh;
            let triangle = mesh.triangles()[dice.index(mesh.triangles().len())];
            let corners = triangle.corners.map(|c| mesh.corners()[c as usize].position as usize);
            let [a, b, c] = corners.map(|at| crate::scene::dvec3(mesh.positions()[at]));
            let place = dice.pick(&[a, (a + b) / 2.0, (a + b + c) / 3.0]);
            object.placement.now().transform_point3(place)
        }
        _ => place(dice) * dice.pick(&[1.0, 1.0, 4.0]),
    }
}

fn spot(dice: &mut Dice, objects: &[(ObjectId, Object)]) -> LightKind {
    let exponent = dice.pick(&[0.0, 0.0, 0.5, 5.0, 30.0]);
    let owner = match dice.index(8) {
        0 => Some(SpotOwner::SelectedObject),
        1 => Some(SpotOwner::SelectedCamera),
        2 => Some(SpotOwner::Object(ObjectId(dice.pick(&[FIRST_OBJECT, NOBODY])))),
        _ => None,
    };
    let aperture = |dice: &mut Dice| match dice.index(3) {
        0 => dice.pick(&[0.0, 1e-6, 0.5, 45.0, 89.9999, 90.0]),
        _ => dice.real(0.5, 40.0),
    };
    if let Some(owner) = owner {
        return LightKind::Spot { owner, half_aperture: aperture(dice), exponent };
    }
    let (position, direction) = (lamp_place(dice, objects), direction(dice));
    let mut half_aperture = aperture(dice);
    if dice.percent(40) {
        // It touches a corner of an object's box, or all but.
        let (_, object) = &objects[dice.index(objects.len())];
        let corners = object.model.mesh.bounds().map(|bounds| bounds.corners());
        let corner = corners.map_or(DVec3::ZERO, |corners| dice.pick(&corners));
        let way: DMat4 = *object.placement.now();
        let way = way.transform_point3(corner) - position;
        let angle = libm::atan2(direction.cross(way).length(), direction.dot(way)).to_degrees();
        let beside = dice.pick(&[0.0, 0.0, 1e-9, -1e-9, 1e-4, -1e-4, 0.1, -0.1]);
        half_aperture = (angle + beside).clamp(0.0, 90.0);
    }
    let owner = SpotOwner::Fixed(Placed::new(Aim { position, direction }));
    LightKind::Spot { owner, half_aperture, exponent }
}

fn view(dice: &mut Dice, scene: &Scene) -> View {
    let polygons = dice.percent(6).then(PolygonMode::begin);
    View {
        object: scene.objects.ids().nth(dice.index(4)).or_else(|| scene.objects.first()),
        observer: if dice.percent(4) { Observer::Object } else { Observer::Camera },
        projection: dice.pick(&[
            Projection::Perspective,
            Projection::Perspective,
            Projection::Orthographic,
        ]),
        fill: if dice.percent(8) { Fill::Edges } else { Fill::Filled },
        edges_over_fill: dice.percent(8),
        polygons,
        only_selected: dice.percent(8),
        normals: dice.pick(&[Normals::Vertex, Normals::Face]),
        back_faces: dice.percent(20),
        face_normals: dice.percent(4),
        vertex_normals: dice.percent(4),
        marks: dice.percent(50),
        wide_lines: dice.percent(10),
        ..scene.first_view()
    }
}

/// Mostly one, for many take longer.
fn samples(dice: &mut Dice) -> Samples {
    match dice.percent(25) {
        true if dice.percent(10) => dice.pick(&[Samples::Sixteen, Samples::SixtyFour]),
        true => Samples::Four,
        false => Samples::One,
    }
}

fn settings(dice: &mut Dice) -> Settings {
    let at = [LightAt::Face, LightAt::Vertex, LightAt::Pixel, LightAt::Pixel, LightAt::Pixel];
    let settings = Settings {
        arithmetic: if dice.percent(8) { Arithmetic::F64 } else { Arithmetic::F32 },
        light: dice.pick(&at),
        samples: samples(dice),
        filter: dice.pick(&[Filter::Nearest, Filter::Bilinear]),
        specular: dice.pick(&[SpecularForm::Reflection, SpecularForm::HalfVector]),
        leave_out: LeaveOut::Unseen,
        ..Settings::default()
    };
    // As many pictures as samples: now and then.
    let several = [Samples::Four, Samples::Sixteen].contains(&settings.samples);
    let each = several && settings.light == LightAt::Pixel && dice.percent(30);
    if each { Settings { light: LightAt::Sample, ..settings } } else { settings }
}
