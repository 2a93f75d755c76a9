//! A partial redraw gives the same bytes as drawing everything.
//!
//! Catches: forgotten old positions of moved or removed objects; bounds that are too small, behind
//! the camera, or without drawn normals; a comparison that ignores lights, material, tint, the
//! choice of normals, polygons, parts with holes, line width, drawn normals or the order; stale
//! vertices and bins; a cancelled picture taken for finished.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

mod bands;
#[path = "../common/mod.rs"]
mod common;
mod shadows;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use common::{at, ball, cube, edit, model_of, scene, square};
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{
    AXES, Arithmetic, Filter, LightAt, LightValues, Rounding, Samples, Settings, SpecularForm,
};
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::math::Axis;
use marraztu_core::base::rng::Rng;
use marraztu_core::edit::lights::{self, Channel};
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{
    Gesture, GesturePhase, History, Refusal, items, motion, navigation, selection,
};
use marraztu_core::scene::{
    Command, Fill, Frame, Item, ItemId, Light, LightKind, MaterialChoice, MeshSource, Model,
    Normals, Object, ObjectId, Observer, Part, PolygonMode, PresetId, Projection, Scene, Sides,
    SourceCorner, SpotOwner, Subject, Surface, Texture, Transformation, View,
};
use marraztu_render::plan_frame;
use marraztu_render::{Cancelled, Change, Damage, DamageCause, FramePlan, Hit, Renderer};

fn random_color(rng: &mut Rng) -> Color {
    Color([0; 3].map(|_| rng.one_of(&[0, 1, 90, 255])))
}

/// Two textured squares, each its own part, with normals that differ from the faces' normals.
fn plates() -> Shared<Model> {
    let corner = |(position, uv): (u32, u32)| SourceCorner { position, uv, normal: 0 };
    let part = |name: &str| Part { name: name.to_owned(), material: None };
    model_of(
        "plates",
        MeshSource {
            positions: vec![
                [-1.0, -1.0, 0.0],
                [0.0, -1.0, 0.0],
                [0.0, 1.0, 0.0],
                [-1.0, 1.0, 0.0],
                [1.0, -1.0, 0.3],
                [1.0, 1.0, 0.3],
            ],
            normals: vec![[0.6, 0.0, 0.8]],
            uvs: vec![[0.0, 0.0], [1.5, 0.0], [1.5, 1.5], [0.0, 1.5]],
            corners: [(0, 0), (1, 1), (2, 2), (3, 3), (1, 0), (4, 1), (5, 2), (2, 3)]
                .map(corner)
                .to_vec(),
            arities: vec![4, 4],
            polygon_parts: vec![0, 1],
            parts: vec![part("left"), part("right")],
            ..MeshSource::default()
        },
    )
}

/// A texture of 2 x 2 texels, in one case of three with a hole.
fn texture(rng: &mut Rng) -> Shared<Texture> {
    let hole = rng.one_of(&[255, 255, 20]);
    let texel = |rng: &mut Rng, alpha| {
        let [r, g, b] = random_color(rng).0;
        [r, g, b, alpha]
    };
    let pixels = vec![texel(rng, 255), texel(rng, hole), texel(rng, 255), texel(rng, 255)];
    Texture::new("none", Picture::from_pixels(Size::new(2, 2), pixels).unwrap()).into()
}

/// The edited scene, its view and settings.
struct Desk {
    scene: Scene,
    view: View,
    settings: Settings,
    size: Size,
    history: History,
    stays: usize,
}

impl Desk {
    fn new() -> Self {
        let (mut scene, view) = scene(&[
            (ball(6), at(30.0, -110.0, 60.0, 0.0)),
            (cube(), at(25.0, 100.0, -60.0, -30.0)),
            (plates(), at(40.0, 90.0, 90.0, 10.0)),
            (square(), at(20.0, -100.0, -80.0, 0.0)),
        ]);
        for (id, name) in (10..).zip(["ruby", "jade", "black plastic", "brass"]) {
            let material = MaterialChoice::Preset(PresetId::named(name).unwrap());
            edit(&mut scene, ObjectId(id), |object| object.material = material);
        }
        let (settings, size) = (Settings::default(), Size::new(330, 260));
        Self { scene, view, settings, size, history: History::new(), stays: 0 }
    }

    fn plan(&self) -> FramePlan {
        plan_frame(&Shot::new(&self.scene, &self.view, &self.settings, self.size))
    }

    /// Changes anything, mostly the scene, sometimes the view.
    fn change(&mut self, rng: &mut Rng) {
        self.stays = self.stays.saturating_sub(1);
        match rng.index(20) {
            0 => self.look(rng),
            1 if self.stays == 0 => self.stand_elsewhere(rng),
            2 | 3 => {
                let before = self.scene.clone();
                let _ = match rng.index(3) {
                    0 => self.history.redo(&mut self.scene),
                    _ => self.history.undo(&mut self.scene),
                };
                selection::follow(&before, &self.scene, &mut self.view);
            }
            _ => {
                let command = self.command(rng);
                self.perform(command);
            }
        }
    }

    fn perform(&mut self, command: Result<Command, Refusal>) {
        let Ok(command) = command else { return };
        let before = self.scene.clone();
        self.history.perform(&mut self.scene, command, Gesture::Whole, "anything").unwrap();
        selection::follow(&before, &self.scene, &mut self.view);
    }

    /// Changes camera, size or a setting, which damages everything, then keeps it for 12 changes.
    fn stand_elsewhere(&mut self, rng: &mut Rng) {
        self.stays = 12;
        let settings = &mut self.settings;
        match rng.index(9) {
            0 => {
                self.size = Size::new(130 + 40 * rng.index(6), 70 + 40 * rng.index(6));
            }
            1 => {
                let all = [LightAt::Face, LightAt::Vertex, LightAt::Pixel, LightAt::Sample];
                settings.light = rng.one_of(&all);
            }
            2 => {
                settings.filter = rng.one_of(&[Filter::Nearest, Filter::Bilinear]);
                settings.samples =
                    rng.one_of(&[Samples::One, Samples::Four, Samples::Four, Samples::Sixteen]);
            }
            3 => settings.arithmetic = rng.one_of(&[Arithmetic::F32, Arithmetic::F64]),
            4 => {
                settings.specular =
                    rng.one_of(&[SpecularForm::Reflection, SpecularForm::HalfVector]);
            }
            5 => {
                self.view.projection =
                    rng.one_of(&[Projection::Perspective, Projection::Orthographic]);
            }
            6 => self.perform(Ok(Command::Background(random_color(rng)))),
            7 => {
                let axis = &AXES[rng.index(AXES.len())];
                *settings = axis.choices[rng.index(axis.choices.len())].of(settings);
            }
            _ => {
                let turn = [0.2 * rng.real(-1.0, 1.0), 0.2 * rng.real(-1.0, 1.0)];
                let first = GesturePhase::First;
                self.perform(navigation::look(&self.scene, &self.view, turn[0], turn[1], first));
            }
        }
    }

    /// Changes the view of the same camera.
    fn look(&mut self, rng: &mut Rng) {
        let view = &mut self.view;
        match rng.index(12) {
            0 => view.fill = rng.one_of(&[Fill::Filled, Fill::Filled, Fill::Edges]),
            1 => view.edges_over_fill ^= true,
            2 => {
                view.polygons = view.polygons.is_none().then(PolygonMode::begin);
            }
            3 => {
                let _ = selection::next_polygon(&self.scene, view);
            }
            4 => view.only_selected ^= true,
            5 => view.normals = rng.one_of(&[Normals::Vertex, Normals::Face]),
            6 => view.back_faces ^= true,
            7 => view.face_normals ^= true,
            8 => view.vertex_normals ^= true,
            9 => view.marks ^= true,
            10 => view.wide_lines ^= true,
            _ => {
                view.observer = rng.one_of(&[Observer::Camera, Observer::Camera, Observer::Object]);
            }
        }
        if self.view.face_normals || self.view.vertex_normals || self.view.polygons.is_some() {
            // Such views have little to keep or show, so they end soon.
            if rng.index(2) == 0 {
                (self.view.face_normals, self.view.vertex_normals) = (false, false);
                self.view.polygons = None;
            }
        }
    }

    fn item(&self, rng: &mut Rng) -> ItemId {
        let objects = self.scene.objects.ids().map(ItemId::Object);
        let cameras = self.scene.cameras.ids().map(ItemId::Camera);
        let lights = self.scene.lights.ids().map(ItemId::Light);
        let all: Vec<ItemId> = objects.chain(cameras).chain(lights).collect();
        rng.one_of(&all)
    }

    fn command(&mut self, rng: &mut Rng) -> Result<Command, Refusal> {
        let item = self.item(rng);
        match rng.index(18) {
            0..5 => self.step(rng),
            5 => {
                let few = self.scene.objects.len() + self.scene.cameras.len() < 8;
                items::duplicate(&self.scene, item, DVec3::ZERO)
                    .and_then(|command| if few { Ok(command) } else { Err(Refusal::TooLarge) })
            }
            6 if self.scene.objects.len() > 2 => items::remove(&self.scene, item),
            7 => items::toggle_shown(&self.scene, item),
            8 => items::reorder(&self.scene, item, rng.index(5)),
            9 => {
                let channel = rng.one_of(&[Channel::Red, Channel::Green, Channel::Blue]);
                lights::step_color(&self.scene, &self.view, channel, rng.one_of(&[-80, 80]))
            }
            10 => lights::step_aperture(&self.scene, &self.view, rng.one_of(&[-5.0, 5.0])),
            11 => {
                self.view.time += 0.4;
                let object = self.view.object.ok_or(Refusal::NoObject)?;
                motion::toggle_spin(&self.scene, object, rng.one_of(&Axis::ALL), self.view.time)
            }
            12 if self.scene.lights.len() < 8 => {
                let spot: LightKind = lights::spot(match self.view.object {
                    Some(object) if rng.index(2) == 0 => SpotOwner::Object(object),
                    _ => lights::fixed(),
                });
                items::insert_light(&self.scene, spot)
            }
            14 if rng.index(3) == 0 => lights::toggle_all_shadows(&self.scene),
            14 => {
                let all: Vec<_> = self.scene.lights.ids().collect();
                lights::toggle_shadows(&self.scene, rng.one_of(&all))
            }
            13 => {
                let chosen = selection::select(&self.scene, &self.view, item)?;
                self.view = chosen.view;
                chosen.command.ok_or(Refusal::OnlyOne)
            }
            _ => {
                let objects: Vec<ObjectId> = self.scene.objects.ids().collect();
                let id = rng.one_of(&objects);
                items::change_object(&self.scene, id, |object| dress(object, rng))
            }
        }
    }

    /// A step of the keys x, y or z.
    fn step(&mut self, rng: &mut Rng) -> Result<Command, Refusal> {
        use Transformation::{Rotation, Scaling, Translation};
        let subjects = [Subject::Object, Subject::Object, Subject::Object, Subject::Light];
        selection::set_subject(&mut self.view, rng.one_of(&subjects));
        let _ = selection::set_transformation(
            &mut self.view,
            rng.one_of(&[Translation, Rotation, Scaling]),
        );
        self.view.frame = rng.one_of(&[Frame::Local, Frame::Global]);
        let sign = rng.one_of(&[Sign::Positive, Sign::Negative]);
        let first = GesturePhase::First;
        transform::step(&self.scene, &self.view, rng.one_of(&Axis::ALL), sign, first)
    }
}

/// Changes the appearance or the position of an object.
fn dress(object: &mut Object, rng: &mut Rng) {
    match rng.index(10) {
        0 => {
            let name = rng.one_of(&["ruby", "jade", "black plastic", "brass"]);
            object.material = MaterialChoice::Preset(PresetId::named(name).unwrap());
        }
        1 => {
            object.surface =
                rng.one_of(&[Surface::Material, Surface::Texture, Surface::TextureAndLight]);
        }
        2 => object.texture = (rng.index(3) > 0).then(|| texture(rng)),
        3 => object.tint = random_color(rng),
        4 => object.sides = if object.sides == Sides::Two { Sides::One } else { Sides::Two },
        5 => object.file_normals ^= true,
        6 => object.edge_color = random_color(rng),
        7 if !object.hidden_parts.remove(&0) => {
            object.hidden_parts.insert(0);
        }
        _ => {
            // Anywhere; sometimes near the camera or directly behind it.
            let near = rng.one_of(&[0.0, 0.0, 0.0, 330.0, 395.0]);
            let across = if near > 0.0 { 20.0 } else { 150.0 };
            let place = rng.vector(1.0) * DVec3::new(across, across, 80.0) + DVec3::Z * near;
            let turn = DMat4::from_rotation_y(rng.real(-1.0, 1.0));
            let size = DMat4::from_scale(DVec3::splat(25.0 + 20.0 * rng.real(-1.0, 1.0)));
            let placement = DMat4::from_translation(place) * turn * size;
            object.placement = object.placement.replaced(placement);
        }
    }
}

/// The items shown at a grid of pixels.
fn seen(renderer: &mut Renderer, size: Size) -> Vec<Option<Hit>> {
    let steps = |length: usize| (3..length).step_by(length / 5);
    let places = steps(size.height).flat_map(|y| steps(size.width).map(move |x| (x, y)));
    places.map(|(x, y)| renderer.hit(x, y)).collect()
}

/// Redraws a frame that is cancelled after `patience` checks.
fn impatient(
    renderer: &mut Renderer,
    plan: &FramePlan,
    patience: usize,
) -> Result<Damage, Cancelled> {
    let asked = AtomicUsize::new(0);
    renderer.redraw(plan, &|| asked.fetch_add(1, Ordering::Relaxed) < patience)
}

#[test]
fn after_any_commands_a_partial_redraw_gives_the_same_bytes_as_a_full_one() {
    let mut rng = Rng::new(1);
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    let (mut given_up, mut partial, mut frames) = (0, 0, 0);
    for _ in 0..24 {
        let mut desk = Desk::new();
        let mut renderer = Renderer::default();
        let mut last = desk.plan();
        renderer.render(&last);
        for step in 0..60 {
            desk.change(&mut rng);
            let plan = desk.plan();
            if rng.index(4) == 0 && impatient(&mut renderer, &plan, rng.index(30)).is_err() {
                given_up += 1;
                // Until the next picture is finished, picking uses the previous one.
                let mut other = Renderer::default();
                other.render(&last);
                let size = last.size();
                assert_eq!(seen(&mut renderer, size), seen(&mut other, size), "step {step}");
                match rng.index(3) {
                    // Next comes the previous plan, another change, or the cancelled plan again.
                    0 => agrees(&mut renderer, &last),
                    1 => desk.change(&mut rng),
                    _ => {}
                }
            }
            let plan = desk.plan();
            let changes = renderer.redraw(&plan, &|| true).unwrap();
            let mut fresh = Renderer::default();
            let same = *fresh.render(&plan) == *renderer.picture();
            assert!(same, "step {step}: {changes:?}");
            assert_eq!(renderer.triangles_drawn(), fresh.triangles_drawn(), "{changes:?}");
            let size = desk.size;
            assert_eq!(seen(&mut renderer, size), seen(&mut fresh, size), "{changes:?}");
            frames += 1;
            partial += usize::from((1..changes.tiles_in_all()).contains(&changes.tiles()));
            match changes.cause() {
                DamageCause::Items(items) => {
                    for (_, change) in items {
                        *kinds.entry(format!("{change:?}")).or_default() += 1;
                    }
                }
                cause => *kinds.entry(format!("{cause:?}")).or_default() += 1,
            }
            last = plan;
        }
    }
    // Makes sure that the random changes tested enough.
    assert!(given_up > 50 && partial > 250, "{given_up}, {partial} of {frames} {kinds:?}");
    for kind in ["Came", "Went", "Moved", "Shape", "Look", "First", "Size", "Camera", "Settings"] {
        assert!(kinds.get(kind).is_some_and(|count| *count > 1), "{kind}: {kinds:?}");
    }
}

/// Redraws the damage, and checks that the picture equals a full redraw.
fn agrees(renderer: &mut Renderer, plan: &FramePlan) {
    let changes = renderer.redraw(plan, &|| true).unwrap();
    assert!(Renderer::default().render(plan) == renderer.picture(), "{changes:?}");
}

/// With light at vertices, small triangles are coloured during setup, or after visibility is known
/// if geometry is reused or most of the picture is kept.
#[test]
fn triangles_of_all_sizes_have_the_same_colors_whenever_they_are_colored() {
    let (mut scene, view) = scene(&[
        (ball(40), at(60.0, -60.0, 40.0, 0.0)),
        (ball(40), at(40.0, 50.0, 20.0, 10.0)),
        (ball(30), at(50.0, 20.0, -60.0, -30.0)),
        (plates(), at(60.0, 80.0, 60.0, 0.0)),
        (ball(12), at(70.0, -50.0, -50.0, 20.0)),
        (ball(5), at(90.0, 60.0, -20.0, -20.0)),
        (cube(), at(400.0, 0.0, 0.0, -900.0)),
        (square(), at(90.0, -70.0, 10.0, 30.0)),
    ]);
    for (light_values, rounding, sides) in [
        (LightValues::Stored, Rounding::Truncated, Sides::One),
        (LightValues::Stored, Rounding::Dithered, Sides::Two),
        (LightValues::Linear, Rounding::Nearest, Sides::One),
    ] {
        let settings =
            Settings { light: LightAt::Vertex, light_values, rounding, ..Settings::default() };
        for id in [10, 11, 12, 14, 15, 16, 17] {
            edit(&mut scene, ObjectId(id), |object| object.sides = sides);
        }
        let plan =
            |scene: &Scene| plan_frame(&Shot::new(scene, &view, &settings, Size::new(330, 260)));
        // The first picture colours triangles during setup. Then only materials change: the
        // geometry is reused, and colours are computed after visibility.
        let mut renderer = Renderer::default();
        renderer.render(&plan(&scene));
        for name in ["ruby", "jade", "brass"] {
            let material = || MaterialChoice::Preset(PresetId::named(name).unwrap());
            for id in [10, 11, 12, 14, 15, 16, 17] {
                edit(&mut scene, ObjectId(id), |object| object.material = material());
            }
            agrees(&mut renderer, &plan(&scene));
        }
    }
}

#[test]
fn marks_in_one_place_are_drawn_again_when_their_order_changes() {
    let (mut scene, view) = scene(&[]);
    for name in ["ruby", "jade"] {
        let material = MaterialChoice::Preset(PresetId::named(name).unwrap());
        items::insert_camera(&scene, cube(), material).apply(&mut scene).unwrap();
    }
    let plan = |scene: &Scene| {
        plan_frame(&Shot::new(scene, &view, &Settings::default(), Size::new(200, 200)))
    };
    let mut renderer = Renderer::default();
    let before = renderer.render(&plan(&scene)).clone();
    let last = scene.cameras.ids().last().unwrap();
    items::reorder(&scene, ItemId::Camera(last), 0).unwrap().apply(&mut scene).unwrap();
    agrees(&mut renderer, &plan(&scene));
    assert!(before != *renderer.picture(), "the first of two in one place is seen");
}

#[test]
fn drawn_normals_follow_a_change_of_the_objects_normals() {
    let (mut scene, view) = scene(&[(plates(), at(60.0, 0.0, 0.0, 0.0))]);
    let view = View { vertex_normals: true, ..view };
    let plan = |scene: &Scene| {
        plan_frame(&Shot::new(scene, &view, &Settings::default(), Size::new(200, 200)))
    };
    let mut renderer = Renderer::default();
    renderer.render(&plan(&scene));
    edit(&mut scene, ObjectId(10), |object| object.file_normals ^= true);
    agrees(&mut renderer, &plan(&scene));
}

#[test]
fn objects_that_reach_behind_the_camera_are_redrawn_wherever_they_are_visible() {
    let (mut scene, view) = scene(&[(plates(), DMat4::IDENTITY)]);
    let plan = |scene: &Scene| {
        plan_frame(&Shot::new(scene, &view, &Settings::default(), Size::new(500, 500)))
    };
    let mut renderer = Renderer::default();
    renderer.render(&plan(&scene));
    // A floor below the camera, from behind it to far in front.
    let flat = DMat4::from_rotation_x(-90_f64.to_radians()) * at(300.0, 0.0, 0.0, 0.0);
    for x in [0.0, 40.0, -500.0, 0.0] {
        edit(&mut scene, ObjectId(10), |object| {
            let place = DMat4::from_translation(DVec3::new(x, -20.0, 350.0)) * flat;
            object.placement = object.placement.replaced(place);
        });
        agrees(&mut renderer, &plan(&scene));
    }
}

#[test]
fn a_moved_object_takes_the_tiles_of_its_old_and_its_new_place_and_no_others() {
    let (mut scene, view) =
        scene(&[(square(), at(20.0, -125.0, 125.0, 0.0)), (square(), at(20.0, 125.0, 125.0, 0.0))]);
    let view = View { marks: false, ..view };
    let size = Size::new(640, 640);
    let plan = |scene: &Scene| plan_frame(&Shot::new(scene, &view, &Settings::default(), size));
    // Removes the spots of the selected object and camera, which follow it, and the diamond mark.
    for (id, light) in
        scene.lights.iter().map(|(id, light)| (id, light.clone())).collect::<Vec<_>>()
    {
        if light.slot >= 3 {
            Command::Remove(ItemId::Light(id)).apply(&mut scene).unwrap();
        }
    }
    let mut renderer = Renderer::default();
    renderer.render(&plan(&scene));
    edit(&mut scene, ObjectId(10), |object| {
        object.placement = object.placement.replaced(at(20.0, -125.0, -125.0, 0.0));
    });
    let changes = renderer.redraw(&plan(&scene), &|| true).unwrap();
    // 640 pixels show 331 units. The square is 77 pixels wide with its centre at (79, 79), in
    // columns 0 and 1 and rows 0 and 1; at the bottom it touches four tiles as well.
    assert_eq!((changes.tiles(), changes.tiles_in_all()), (8, 100));
    let moved = vec![(ItemId::Object(ObjectId(10)), Change::Moved)];
    assert_eq!(*changes.cause(), DamageCause::Items(moved));
}

/// A closed box from -1 to 1 with its lid, at z = 1, as the second part.
fn box_with_lid() -> Shared<Model> {
    let mesh = &cube().mesh;
    let corners = mesh.corners().iter().map(|corner| SourceCorner::bare(corner.position));
    let part = |name: &str| Part { name: name.to_owned(), material: None };
    model_of(
        "box",
        MeshSource {
            positions: mesh.positions().to_vec(),
            polygon_parts: vec![0, 1, 0, 0, 0, 0],
            parts: vec![part("walls"), part("lid")],
            ..MeshSource::of_polygons(corners, vec![4; 6])
        },
    )
}

#[test]
fn a_box_shows_its_inside_while_its_lid_is_hidden() {
    let (mut scene, view) = scene(&[(box_with_lid(), at(30.0, 0.0, 0.0, 0.0))]);
    let view = View { marks: false, ..view };
    let size = Size::new(300, 300);
    let plan = |scene: &Scene| plan_frame(&Shot::new(scene, &view, &Settings::default(), size));
    edit(&mut scene, ObjectId(10), |object| object.sides = Sides::Auto);
    let mut renderer = Renderer::default();
    renderer.render(&plan(&scene));
    let ground = scene.background.opaque();
    for hidden in [Some(1), None, Some(0), None] {
        edit(&mut scene, ObjectId(10), |object| {
            object.hidden_parts = hidden.into_iter().collect();
        });
        agrees(&mut renderer, &plan(&scene));
        let middle = renderer.picture().pixel(150, 150);
        assert!(middle != ground, "without part {hidden:?}");
    }
    // The lid alone is visible from behind.
    edit(&mut scene, ObjectId(10), |object| {
        object.hidden_parts = [0].into();
        let turned = DMat4::from_rotation_y(std::f64::consts::PI) * *object.placement.now();
        object.placement = object.placement.replaced(turned);
    });
    agrees(&mut renderer, &plan(&scene));
    assert!(renderer.picture().pixel(150, 150) != ground);
}

#[test]
fn an_invisible_change_paints_no_tile() {
    let (mut scene, view) = scene(&[(square(), at(20.0, 0.0, 0.0, 0.0))]);
    let plan = |scene: &Scene| {
        plan_frame(&Shot::new(scene, &view, &Settings::default(), Size::new(100, 100)))
    };
    let mut renderer = Renderer::default();
    renderer.render(&plan(&scene));
    edit(&mut scene, ObjectId(10), |object| object.name = "another name".to_owned());
    let changes = renderer.redraw(&plan(&scene), &|| true).unwrap();
    assert!(changes.is_nothing() && *changes.cause() == DamageCause::Items(Vec::new()));
}

#[test]
fn edges_across_a_tile_border_are_drawn_again_on_both_sides() {
    // In orthographic projection a pixel is 1000 / 128 units wide. The border of the tiles is at 0.
    let pixel = 1000.0 / 128.0;
    for offset in [-1.5, -1.0, -0.5, -0.01, 0.0, 0.01, 0.5, 1.0] {
        for wide_lines in [false, true] {
            let [x, y] = [offset - 20.0, 20.0 - offset].map(|pixels: f64| pixels * pixel);
            let (mut scene, view) = scene(&[(square(), at(20.0 * pixel, x, y, 0.0))]);
            let projection = Projection::Orthographic;
            let view = View { projection, wide_lines, edges_over_fill: true, ..view };
            let plan = |scene: &Scene| {
                plan_frame(&Shot::new(scene, &view, &Settings::default(), Size::new(128, 128)))
            };
            let mut renderer = Renderer::default();
            renderer.render(&plan(&scene));
            edit(&mut scene, ObjectId(10), |object| object.edge_color = Color([0, 255, 0]));
            renderer.redraw(&plan(&scene), &|| true).unwrap();
            let again = renderer.picture().clone();
            let anew = Renderer::default().render(&plan(&scene)).clone();
            assert!(again == anew, "{offset} pixels beside the border, wide lines: {wide_lines}");
        }
    }
}
