//! Generates scenes with hostile numbers (NaN, infinities, subnormal and huge values), flat
//! placements, lights on surfaces and cameras inside objects.
//!
//! They enter the scene as user input does, through meshes and commands. Those may reject them, but
//! must then leave the scene unchanged.

use glam::{DMat3, DMat4, DVec3, DVec4};

use super::Tally;
use marraztu_core::accuracy::{Arithmetic, Filter, LightAt, Samples, Settings, SpecularForm};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::base::{Shared, math};
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{GesturePhase, placement};
use marraztu_core::scene::{
    Aim, Attenuation, Camera, CameraId, Command, Fill, Frame, Item, Lens, Light, LightId,
    LightKind, Material, MaterialChoice, Mesh, MeshSource, Model, NONE, NormalLength, Normals,
    Object, ObjectId, Observer, Optics, Orbit, Part, Pose, PresetId, Projection, Reflection, Scene,
    Sides, SourceCorner, Spin, SpotOwner, Subject, Surface, Texture, Tracked, Transformation,
    Transmission, View, Wrap,
};

/// Applies a command, or checks that a refused one changes nothing.
fn try_out(scene: &mut Scene, command: Command, tally: &mut Tally) {
    let before = scene.clone();
    if command.apply(scene).is_err() {
        // Compared as text, because NaN is not equal to itself.
        let unchanged = format!("{scene:?}") == format!("{before:?}");
        assert!(unchanged, "a command that is refused changes nothing");
        tally.count("refusals", 1);
    }
}

/// Hard magnitudes.
const HARD: [f64; 26] = [
    0.0,
    5e-324,
    1e-310,
    2.3e-308,
    1e-46,
    1e-40,
    1.2e-38,
    1e-23,
    1e-12,
    1e-6,
    0.5,
    1.0,
    2.0,
    10.0,
    100.0,
    400.0,
    1e4,
    1e6,
    1e9,
    1e15,
    1e20,
    3e38,
    1e39,
    1e154,
    1e300,
    f64::MAX,
];

/// Generates hostile items.
pub(crate) struct Hostile {
    pub(crate) rng: Rng,
    /// Hostile numbers occur with a probability of 1 / `rarity`.
    rarity: u64,
    /// Positions on surfaces, where some lights are placed.
    surfaces: Vec<DVec3>,
}

impl Hostile {
    pub(crate) fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let rarity = rng.one_of(&[2, 5, 20, 60, 1000]);
        Self { rng, rarity, surfaces: vec![DVec3::ZERO] }
    }

    /// A number from -`size` to `size`, or a hostile one.
    fn number(&mut self, size: f64) -> f64 {
        if !self.rng.one_in(self.rarity) {
            return self.rng.real(-size, size);
        }
        let special = match self.rng.below(12) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            _ => self.rng.one_of(&HARD),
        };
        if self.rng.one_in(2) { special } else { -special }
    }

    /// A number from 0 to `size`, or a hostile one.
    fn amount(&mut self, size: f64) -> f64 {
        let number = self.number(size);
        if self.rng.one_in(self.rarity) { number } else { number.abs() }
    }

    fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::new(self.number(size), self.number(size), self.number(size))
    }

    #[expect(clippy::cast_possible_truncation, reason = "the nearest number is meant")]
    fn narrow<const N: usize>(&mut self, size: f64) -> [f32; N] {
        std::array::from_fn(|_| self.number(size) as f32)
    }

    fn bool(&mut self) -> bool {
        self.rng.one_in(2)
    }

    pub(crate) fn scene(&mut self, tally: &mut Tally) -> (Scene, View) {
        let mut scene = Scene::with_camera(self.camera(Pose::facing_minus_z(DVec3::Z * 400.0)));
        for id in 1..=self.rng.between(1, 4).unsigned_abs() {
            if let Some(object) = self.object() {
                let item = Item::Object(ObjectId(id), Box::new(object));
                try_out(&mut scene, Command::Insert { at: 0, item }, tally);
            }
        }
        let on_surface = self.rng.one_of(&self.surfaces.clone());
        for (slot, id) in (10..10 + self.rng.below(6)).zip(10..) {
            let light = self.light(u32::try_from(slot).unwrap_or(0), on_surface);
            let item = Item::Light(LightId(id), Box::new(light));
            try_out(&mut scene, Command::Insert { at: 0, item }, tally);
        }
        if self.bool() {
            let pose = self.pose(on_surface);
            let camera = self.camera(pose);
            let item = Item::Camera(CameraId(0), Box::new(camera));
            try_out(&mut scene, Command::Replace(item), tally);
        }
        let view = self.view(&scene);
        for _ in 0..self.rng.below(4) {
            if let Some(command) = self.command(&scene, &view) {
                try_out(&mut scene, command, tally);
            }
        }
        (scene, view)
    }

    fn command(&mut self, scene: &Scene, view: &View) -> Option<Command> {
        let object = view.object?;
        let (v, stroke) =
            (self.vector(10.0), self.rng.one_of(&[GesturePhase::First, GesturePhase::Continued]));
        let axis = self.rng.one_of(&math::Axis::ALL);
        match self.rng.below(7) {
            0 => transform::translate(scene, view, v, stroke),
            1 => transform::rotate(scene, view, v, self.number(7.0), stroke),
            2 => transform::stretch(scene, view, v, stroke),
            3 => placement::object_scale(scene, view, object, v, stroke),
            4 => placement::object_turn(scene, view, object, v, stroke),
            5 => placement::object_translation(scene, view, object, v, stroke),
            _ => transform::step(scene, view, axis, Sign::Positive, stroke),
        }
        .ok()
    }

    fn model(&mut self) -> Option<Shared<Model>> {
        let vertices = self.rng.between(3, 12).unsigned_abs();
        let (uvs, normals) = (self.rng.index(5), self.rng.index(5));
        let mut source = MeshSource {
            positions: (0..vertices).map(|_| self.narrow(60.0)).collect(),
            uvs: (0..uvs).map(|_| self.narrow(3.0)).collect(),
            normals: (0..normals).map(|_| self.narrow(1.0)).collect(),
            parts: vec![Part { name: "part".to_owned(), material: None }],
            ..MeshSource::default()
        };
        if self.bool() {
            source.colors = (0..vertices).map(|_| self.narrow(1.0)).collect();
        }
        // Indices are valid, because meshes with others are rejected at once.
        let index = |rng: &mut Rng, n: usize| match n {
            0 => NONE,
            n => u32::try_from(rng.index(n)).unwrap_or(NONE),
        };
        for _ in 0..self.rng.between(1, 6) {
            let corners = self.rng.between(3, 6).unsigned_abs();
            source.arities.push(corners);
            source.polygon_parts.push(0);
            for _ in 0..corners {
                source.corners.push(SourceCorner {
                    position: index(&mut self.rng, vertices as usize),
                    uv: index(&mut self.rng, uvs),
                    normal: index(&mut self.rng, normals),
                });
            }
        }
        let mesh = Mesh::new(source).ok()?;
        Some(Shared::new(Model::of_mesh("hostile", mesh)))
    }

    fn object(&mut self) -> Option<Object> {
        let model = self.model()?;
        let material = match self.rng.below(3) {
            0 => MaterialChoice::Preset(self.preset()),
            _ => MaterialChoice::Own(self.material()),
        };
        let mut object = Object::new(model, material);
        let placement = self.placement();
        let mean = placement.transform_point3(object.model.mesh.polygon_centre(0));
        self.surfaces.push(mean);
        object.placement = Tracked::new(placement);
        if self.rng.one_in(4) {
            let axes = [self.bool(), self.bool(), self.bool()];
            object.spin = Spin { axes, speed: self.number(90.0), since: self.number(1.0) };
        }
        object.surface =
            self.rng.one_of(&[Surface::Material, Surface::Texture, Surface::TextureAndLight]);
        if self.bool() {
            object.texture = Some(self.texture());
        }
        object.sides = if self.bool() { Sides::Two } else { Sides::One };
        object.file_normals = self.bool();
        object.tint = Color([255, 128, 9]);
        Some(object)
    }

    fn preset(&mut self) -> PresetId {
        let at = self.rng.index(PresetId::all().len());
        PresetId::all().nth(at).unwrap_or(PresetId::SILVER)
    }

    fn material(&mut self) -> Material {
        let mut color = || std::array::from_fn(|_| self.amount(1.0));
        let (ambient, diffuse, specular) = (color(), color(), color());
        Material {
            ambient,
            diffuse,
            specular,
            exponent: self.amount(128.0),
            emission: [self.amount(2.0), 0.0, 0.0],
            optics: self.optics(),
        }
    }

    fn optics(&mut self) -> Optics {
        Optics {
            reflection: self.rng.one_of(&Reflection::ALL),
            transmission: match self.rng.index(4) {
                0 => Transmission::Opacity,
                1 => Transmission::Filter(std::array::from_fn(|_| self.amount(1.0))),
                _ => Transmission::None,
            },
            index: self.amount(2.0),
        }
    }

    fn texture(&mut self) -> Shared<Texture> {
        let pixels = (0..6).map(|_| self.rng.bits().to_le_bytes());
        let pixels = pixels.map(|[r, g, b, a, ..]| [r, g, b, a]).collect();
        Shared::new(Texture {
            source: std::path::PathBuf::new(),
            picture: Picture::from_pixels(Size::new(3, 2), pixels).unwrap_or_default().into(),
            wrap: self.rng.one_of(&[Wrap::Repeat, Wrap::Clamp]),
            offset: [self.number(2.0), self.number(2.0)],
            scale: [self.number(5.0), self.number(5.0)],
        })
    }

    fn placement(&mut self) -> DMat4 {
        let axes = match self.rng.below(4) {
            0 => DMat3::from_cols(self.vector(1.0), self.vector(1.0), self.vector(1.0)),
            1 => DMat3::from_diagonal(self.vector(3.0)),
            2 => self.turn() * self.amount(3.0),
            _ => self.turn(),
        };
        let column = |v: DVec3| v.extend(0.0);
        let place: DVec4 = self.vector(150.0).extend(1.0);
        DMat4::from_cols(column(axes.x_axis), column(axes.y_axis), column(axes.z_axis), place)
    }

    fn turn(&mut self) -> DMat3 {
        let axis = math::unit(self.rng.vector(1.0)).unwrap_or(DVec3::Y);
        math::rotation(axis, self.rng.real(0.0, 7.0))
    }

    fn pose(&mut self, on_surface: DVec3) -> Pose {
        let eye = if self.rng.one_in(3) { on_surface } else { self.vector(300.0) };
        Pose { axes: self.turn(), ..Pose::facing_minus_z(eye) }
    }

    fn camera(&mut self, pose: Pose) -> Camera {
        let mut lens = Lens {
            half_angle: self.amount(89.0),
            near: self.amount(2.0),
            automatic_near: self.bool(),
            far: self.amount(4000.0),
            half_size: self.amount(500.0),
            parallel_near: self.number(10.0),
            parallel_far: self.amount(4000.0),
            ..Lens::default()
        };
        if self.rng.one_in(3) {
            lens.shift = [self.number(2.0), self.number(2.0)];
            lens.pixel_aspect = self.amount(2.0);
        }
        if self.bool() || !lens.is_valid() {
            lens = Lens::default();
        }
        Camera {
            name: "camera".to_owned(),
            visible: self.bool(),
            model: marraztu_io::cam_model(),
            material: MaterialChoice::Preset(PresetId::SILVER),
            pose: Tracked::new(pose),
            lens,
        }
    }

    fn light(&mut self, slot: u32, on_surface: DVec3) -> Light {
        let place = if self.rng.one_in(3) { on_surface } else { self.vector(200.0) };
        let direction = if self.bool() { self.turn().x_axis } else { self.vector(1.0) };
        let orbit = Orbit { on: self.bool(), speed: self.number(90.0), since: self.number(9.0) };
        let owner = match self.rng.below(4) {
            0 => SpotOwner::SelectedObject,
            1 => SpotOwner::SelectedCamera,
            2 => SpotOwner::Object(ObjectId(1)),
            _ => SpotOwner::Fixed(Tracked::new(Aim { position: place, direction })),
        };
        let kind = match self.rng.below(4) {
            0 => LightKind::Ambient,
            1 => LightKind::Sun { direction: Tracked::new(direction) },
            2 => LightKind::Bulb { position: Tracked::new(place), orbit },
            _ => LightKind::Spot {
                owner,
                half_aperture: self.amount(90.0),
                exponent: self.amount(9.0),
            },
        };
        let mut light = Light::new("light", slot, kind);
        if self.bool() {
            light.attenuation = Attenuation {
                constant: self.amount(1.0),
                linear: self.amount(0.1),
                quadratic: self.amount(0.1),
            };
        }
        light.color = self.rng.one_of(&[Color::WHITE, Color::BLACK, Color([1, 200, 90])]);
        light
    }

    fn view(&mut self, scene: &Scene) -> View {
        let mut view = scene.first_view();
        view.subject = Subject::Object;
        view.transformation = Transformation::Scaling;
        view.frame = self.rng.one_of(&[Frame::Local, Frame::Global]);
        view.steps.scaling = self.number(2.0);
        view.observer = self.rng.one_of(&[Observer::Camera, Observer::Camera, Observer::Object]);
        view.projection = self.rng.one_of(&[Projection::Perspective, Projection::Orthographic]);
        view.fill = self.rng.one_of(&[Fill::Filled, Fill::Filled, Fill::Edges]);
        view.normals = self.rng.one_of(&[Normals::Vertex, Normals::Face]);
        view.normal_length = self.rng.one_of(&[NormalLength::Units, NormalLength::BySize]);
        (view.back_faces, view.edges_over_fill) = (self.bool(), self.rng.one_in(4));
        (view.face_normals, view.vertex_normals) = (self.rng.one_in(4), self.rng.one_in(4));
        view.wide_lines = self.bool();
        view.time = self.number(10.0);
        view
    }

    pub(crate) fn settings(&mut self) -> Settings {
        let samples = self.rng.one_of(&[Samples::One, Samples::One, Samples::Four]);
        let mut light = self.rng.one_of(&[LightAt::Face, LightAt::Vertex, LightAt::Pixel]);
        if light == LightAt::Pixel && samples != Samples::One && self.bool() {
            light = LightAt::Sample;
        }
        Settings {
            arithmetic: self.rng.one_of(&[Arithmetic::F32, Arithmetic::F32, Arithmetic::F64]),
            light,
            samples,
            filter: self.rng.one_of(&[Filter::Nearest, Filter::Bilinear]),
            specular: self.rng.one_of(&[SpecularForm::Reflection, SpecularForm::HalfVector]),
            ..Settings::default()
        }
    }
}
