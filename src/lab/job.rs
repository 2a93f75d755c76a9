//! One job of drawing that other renderers do too, so that they can be compared: a mesh orbited by a
//! camera, lit by five lights, in one of several modes.
//!
//! A frame is measured from the setting of its camera to bytes in memory, with the planning, and no
//! two frames have the same camera. Loading stays outside.

use std::time::Instant;

use cpu_time::ProcessTime;
use fearless_simd::Level;
use glam::{DMat4, DVec3};

use crate::base::image::{Picture, Size};
use crate::base::{Shared, color::Color, math};
use crate::render::{FramePlan, Renderer};
use crate::scene::{
    Aim, Attenuation, Camera, CameraId, Command, CommandError, Fill, Item, Lens, Light, LightAt,
    LightId, LightKind, Material, MaterialChoice, Mesh, MeshSource, Model, Normals, Object,
    ObjectId, Orbit, Placed, Pose, Samples, Scene, Settings, Sides, SourceCorner, SpotOwner, View,
    dvec3,
};

/// How the mesh is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Lit once a face, with its normal.
    Flat,
    /// Lit at vertices.
    Gouraud,
    /// Lit at pixels.
    Phong,
    /// One colour.
    Depth,
    /// Every edge once.
    Wire,
}

impl Mode {
    /// The mode of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "flat" => Self::Flat,
            "gouraud" => Self::Gouraud,
            "phong" => Self::Phong,
            "depth" => Self::Depth,
            "wire" => Self::Wire,
            _ => return None,
        })
    }
}

/// What is drawn, how, and for how long.
#[derive(Clone, Debug)]
pub struct Job {
    /// How the mesh is drawn.
    pub mode: Mode,
    /// The picture's.
    pub size: Size,
    /// How many of each pixel.
    pub samples: Samples,
    /// How many frames are measured at the most.
    pub frames: usize,
    /// How many are drawn first.
    pub warm_up: usize,
    /// After how many milliseconds the measuring stops.
    pub budget: f64,
    /// From where the camera looks at the origin.
    pub distance: f64,
    /// Whether the camera looks straight at the mesh and hardly turns.
    pub face: bool,
    /// Whether the mesh is left where its file has it.
    pub raw: bool,
    /// Instructions that it is drawn with.
    pub level: Level,
}

/// What was measured.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The time of each frame in milliseconds, shortest first.
    pub frames: Vec<f64>,
    /// Milliseconds of processors that a frame took on average, of all threads.
    pub processor: f64,
    /// How many triangles the mesh has.
    pub triangles: usize,
    /// How many pixels of the first picture are not background.
    pub covered: usize,
    /// The first picture.
    pub picture: Picture,
}

impl Measured {
    /// The median time of a frame in milliseconds.
    #[must_use]
    pub fn median(&self) -> f64 {
        self.frames.get(self.frames.len() / 2).copied().unwrap_or(f64::NAN)
    }

    /// The time of the shortest frame in milliseconds.
    #[must_use]
    pub fn shortest(&self) -> f64 {
        self.frames.first().copied().unwrap_or(f64::NAN)
    }
}

/// What no pixel of a mesh shows.
const BACKGROUND: Color = Color([26, 26, 31]);

/// Draws the job's frames.
///
/// # Errors
/// Where the scene cannot be made of the mesh.
pub fn run(job: &Job, model: &Model) -> Result<Measured, CommandError> {
    let mesh = prepared(model, job.raw);
    let triangles = mesh.mesh.triangle_count();
    let (scene, view, settings) = scene(job, Shared::new(mesh))?;
    let mut renderer = Renderer::new(job.level);
    let mut frame = |i: usize| -> Result<f64, CommandError> {
        let mut scene = scene.clone();
        let begin = Instant::now();
        let camera = camera(job, i, &scene);
        Command::Replace(Item::Camera(CameraId(0), Box::new(camera))).apply(&mut scene)?;
        renderer.render(&FramePlan::new(&scene, &view, &settings, job.size));
        Ok(begin.elapsed().as_secs_f64() * 1e3)
    };
    for i in 0..job.warm_up {
        frame(i + 1)?;
    }
    let (begin, processor) = (Instant::now(), ProcessTime::now());
    let mut frames = Vec::new();
    while frames.len() < job.frames && (begin.elapsed().as_secs_f64() * 1e3 < job.budget) {
        frames.push(frame(job.warm_up + 1 + frames.len())?);
    }
    #[expect(clippy::cast_precision_loss, reason = "few frames")]
    let processor = processor.elapsed().as_secs_f64() * 1e3 / frames.len() as f64;
    frame(0)?;
    frames.sort_by(f64::total_cmp);
    let picture = renderer.picture().clone();
    let covered = picture.pixels().iter().filter(|pixel| **pixel != BACKGROUND.opaque()).count();
    Ok(Measured { frames, processor, triangles, covered, picture })
}

/// The job's mesh: in the middle, its farthest vertex 100 from the origin, with normals that are the
/// sums of the face normals around a vertex by their areas.
fn prepared(model: &Model, raw: bool) -> Model {
    let mesh = &model.mesh;
    let places: Vec<DVec3> = mesh.positions().iter().map(|p| dvec3(*p)).collect();
    let centre = mesh.bounds().map_or(DVec3::ZERO, |bounds| bounds.centre());
    let farthest = places.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
    let scale = 100.0 / farthest.max(f64::MIN_POSITIVE);
    let placed = |p: &DVec3| if raw { *p } else { (*p - centre) * scale };
    let places: Vec<DVec3> = places.iter().map(placed).collect();
    let mut normals = vec![DVec3::ZERO; places.len()];
    let corners: Vec<[u32; 3]> = mesh
        .triangles()
        .iter()
        .map(|triangle| triangle.corners.map(|c| mesh.corners()[c as usize].position))
        .collect();
    for [a, b, c] in corners.iter().map(|ids| ids.map(|id| id as usize)) {
        let normal = (places[b] - places[a]).cross(places[c] - places[a]);
        for vertex in [a, b, c] {
            normals[vertex] += normal;
        }
    }
    let narrow = |v: &DVec3| v.as_vec3().to_array();
    let unit = |v: &DVec3| narrow(&math::unit(*v).unwrap_or(DVec3::Z));
    let source = MeshSource {
        positions: places.iter().map(narrow).collect(),
        normals: normals.iter().map(unit).collect(),
        corners: corners
            .as_flattened()
            .iter()
            .map(|&position| SourceCorner { position, uv: crate::scene::NONE, normal: position })
            .collect(),
        arities: vec![3; corners.len()],
        polygon_parts: vec![0; corners.len()],
        parts: vec![crate::scene::Part { name: model.name.clone(), material: None }],
        ..MeshSource::default()
    };
    Model {
        name: model.name.clone(),
        source: None,
        options: model.options,
        mesh: Mesh::new(source).expect("a mesh's own triangles are a mesh"),
        materials: Vec::new(),
        edge_color: None,
    }
}

fn scene(job: &Job, model: Shared<Model>) -> Result<(Scene, View, Settings), CommandError> {
    let [ambient, diffuse, specular] = match job.mode {
        Mode::Depth => [[0.9, 0.8, 0.6], [0.0; 3], [0.0; 3]],
        _ => [[0.8, 0.75, 0.7], [0.8, 0.75, 0.7], [0.5; 3]],
    };
    let material = MaterialChoice::Own(Material { ambient, diffuse, specular, exponent: 32.0 });
    let mut scene = Scene::with_camera(Camera {
        name: "camera".to_owned(),
        visible: true,
        model: model.clone(),
        material: material.clone(),
        pose: Placed::new(Pose::facing_minus_z(DVec3::Z * job.distance)),
        lens: Lens::default(),
    });
    scene.background = BACKGROUND;
    let mut object = Object::new(model, material);
    object.edge_color = Color::from_factors([0.9, 0.8, 0.6]);
    // Edges have one colour, whichever way their faces look.
    object.sides = if job.mode == Mode::Wire { Sides::Two } else { Sides::One };
    let item = Item::Object(ObjectId(1), Box::new(object));
    Command::Insert { at: 0, item }.apply(&mut scene)?;
    for (i, light) in (0..).zip(lights(job.mode)) {
        let item = Item::Light(LightId(2 + i), Box::new(light));
        Command::Insert { at: usize::MAX, item }.apply(&mut scene)?;
    }
    let view = View {
        marks: false,
        fill: if job.mode == Mode::Wire { Fill::Edges } else { Fill::Filled },
        normals: if job.mode == Mode::Flat { Normals::Face } else { Normals::Vertex },
        ..scene.first_view()
    };
    let light = match job.mode {
        Mode::Flat => LightAt::Face,
        Mode::Gouraud => LightAt::Vertex,
        Mode::Phong | Mode::Depth | Mode::Wire => LightAt::Pixel,
    };
    Ok((scene, view, Settings { light, samples: job.samples, ..Settings::default() }))
}

fn lights(mode: Mode) -> Vec<Light> {
    let ambient = if mode == Mode::Depth { [1.0; 3] } else { [0.15; 3] };
    let light = |slot, color, kind| Light {
        color: Color::from_factors(color),
        attenuation: Attenuation::default(),
        ..Light::new("light", slot, kind)
    };
    // The job's spots do not fade.
    let steady = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 };
    let unfading = |slot, color, kind| Light { attenuation: steady, ..light(slot, color, kind) };
    let spot = |position: DVec3| LightKind::Spot {
        owner: SpotOwner::Fixed(Placed::new(Aim {
            position,
            direction: math::unit(-position).unwrap_or(DVec3::NEG_Z),
        })),
        half_aperture: 22.5,
        exponent: 5.0,
    };
    let sun = math::unit(-DVec3::new(0.5, 0.8, 0.6)).unwrap_or(DVec3::NEG_Y);
    let bulb = Placed::new(DVec3::new(150.0, 120.0, 180.0));
    vec![
        light(0, ambient, LightKind::Ambient),
        light(1, [0.45, 0.43, 0.40], LightKind::Sun { direction: Placed::new(sun) }),
        light(2, [0.50, 0.45, 0.40], LightKind::Bulb { position: bulb, orbit: Orbit::default() }),
        unfading(3, [0.50, 0.20, 0.20], spot(DVec3::new(-200.0, 150.0, 150.0))),
        unfading(4, [0.20, 0.30, 0.60], spot(DVec3::new(100.0, -180.0, 200.0))),
    ]
}

/// Camera number `i` of the orbit.
#[expect(clippy::cast_precision_loss, reason = "few frames")]
fn camera(job: &Job, i: usize, scene: &Scene) -> Camera {
    let (yaw, pitch) =
        if job.face { (0.002 * i as f64, 0.0) } else { (0.6 + 0.02 * i as f64, 0.349_066) };
    let turn = DMat4::from_mat3(math::rotation(DVec3::Y, yaw) * math::rotation(DVec3::X, -pitch));
    let eye = turn.transform_point3(DVec3::Z * job.distance);
    let mut camera = scene.cameras.get(CameraId(0)).expect("a scene always has a camera").clone();
    let last = camera.pose.now().axes;
    let axes = math::look_at(eye, DVec3::ZERO, DVec3::Y, last);
    camera.pose = Placed::new(Pose { axes, ..Pose::facing_minus_z(eye) });
    camera
}
