//! New shapes: their size and place.
//!
//! Catches: a shape around the camera, in another object, outside of the picture or in the air; a
//! size that follows a ground instead of the view.

use glam::{DMat3, DMat4, DVec3};
use marraztu_core::base::math;
use marraztu_core::edit::{arrange, selection, shapes};
use marraztu_core::scene::{
    Bounds, Command, Item, ItemId, MaterialChoice, Object, Pose, Projection, Scene, Shape, Tracked,
    View,
};
use marraztu_io as io;

const SOLIDS: [Shape; 4] = [Shape::Cube, Shape::Sphere, Shape::Cylinder, Shape::Torus];

struct Stage {
    scene: Scene,
    view: View,
}

impl Stage {
    fn first() -> Self {
        let (scene, view) = io::default_scene();
        Self { scene, view }
    }

    fn empty() -> Self {
        let (scene, view) = io::empty_scene();
        Self { scene, view }
    }

    /// A scene with an object of this shape, as if it were a model.
    fn with(shape: Shape, placement: DMat4) -> Self {
        let mut stage = Self::empty();
        let mut object = Object::new(shape.model(), MaterialChoice::File);
        object.placement = Tracked::new(placement);
        stage.apply(marraztu_core::edit::items::insert_object(&stage.scene, object));
        stage
    }

    fn apply(&mut self, command: Command) {
        let before = self.scene.clone();
        command.apply(&mut self.scene).unwrap();
        selection::follow(&before, &self.scene, &mut self.view);
    }

    fn look(&mut self, eye: DVec3, axes: DMat3) {
        let mut camera = self.scene.selected_camera(&self.view).clone();
        camera.pose = Tracked::new(Pose { axes, ..Pose::facing_minus_z(eye) });
        self.apply(Command::Replace(Item::Camera(self.view.camera, Box::new(camera))));
    }

    /// Adds a shape, and returns its box.
    fn add(&mut self, shape: Shape) -> Bounds {
        self.apply(shapes::insert(&self.scene, &self.view, shape));
        self.boxes()[0]
    }

    /// The boxes of all objects, the newest first.
    fn boxes(&self) -> Vec<Bounds> {
        let objects = self.scene.objects.iter();
        objects.map(|(_, object)| arrange::world_box(object, 0.0).unwrap()).collect()
    }

    fn pose(&self) -> Pose {
        *self.scene.selected_camera(&self.view).pose.now()
    }

    /// The width of the newest object as a part of the view's height at its depth. All of it has to
    /// be in the picture.
    fn part_of_view(&self) -> f64 {
        let [newest, ..] = self.boxes()[..] else { panic!("no object") };
        let (pose, lens) = (self.pose(), self.scene.selected_camera(&self.view).lens);
        let seen = |p: DVec3| {
            let at = pose.axes.transpose() * (p - pose.eye);
            let half = match self.view.projection {
                Projection::Perspective => -at.z * lens.half_angle.to_radians().tan(),
                Projection::Orthographic => lens.half_size,
            };
            assert!(-at.z > lens.near, "it reaches behind the eye: {newest:?}");
            assert!(at.x.abs().max(at.y.abs()) <= half, "it is outside of the picture: {newest:?}");
            half
        };
        newest.corners().into_iter().for_each(|corner| _ = seen(corner));
        newest.extent().x / (2.0 * seen(newest.centre()))
    }
}

fn touch(a: &Bounds, b: &Bounds) -> bool {
    a.min.cmplt(b.max).all() && b.min.cmplt(a.max).all()
}

#[test]
fn after_a_ground_eight_shapes_are_a_fifth_of_the_view_and_rest_on_it_apart() {
    for ground in [Shape::Ground, Shape::Plane] {
        for down in [0.0, 20.0, 60.0] {
            let mut stage = Stage::empty();
            let turn = math::rotation(DVec3::X, -f64::to_radians(down));
            stage.look(turn * DVec3::Z * 400.0, turn);
            let floor = stage.add(ground);
            for i in 0..8 {
                let new = stage.add(SOLIDS[i % 4]);
                let part = stage.part_of_view();
                assert!((0.09..=0.42).contains(&part), "{part} of the view");
                assert_eq!(new.min.y, floor.max.y, "{ground:?} {down} {i}");
                let boxes = stage.boxes();
                let others = &boxes[1..=i];
                assert!(!others.iter().any(|other| touch(other, &new)), "{ground:?} {down} {i}");
            }
        }
    }
}

#[test]
fn a_new_shape_fits_the_view_whatever_is_there() {
    let turned = math::rotation(DVec3::Y, 0.7) * math::rotation(DVec3::X, -0.4);
    let far = DVec3::new(4e6, 300.0, -2e6);
    let cases: Vec<(&str, Stage)> = vec![
        ("the first scene", Stage::first()),
        ("nothing", Stage::empty()),
        ("a small model", {
            let placement = DMat4::from_scale(DVec3::splat(1e-3));
            let mut stage = Stage::with(Shape::Cube, placement);
            stage.look(turned * DVec3::Z * 4e-3, turned);
            let mut camera = stage.scene.selected_camera(&stage.view).clone();
            camera.lens.near = 1e-6;
            stage.apply(Command::Replace(Item::Camera(stage.view.camera, Box::new(camera))));
            stage
        }),
        ("a large model far away", {
            let placement = DMat4::from_translation(far) * DMat4::from_scale(DVec3::splat(500.0));
            let mut stage = Stage::with(Shape::Sphere, placement);
            stage.look(far + turned * DVec3::Z * 1500.0, turned);
            stage
        }),
        ("a room around the camera", {
            let placement = DMat4::from_scale(DVec3::new(900.0, 300.0, 1200.0));
            let mut stage = Stage::with(Shape::Cube, placement);
            stage.look(DVec3::new(50.0, 0.0, 200.0), math::rotation(DVec3::X, -0.3));
            stage
        }),
        ("a view of nothing", {
            let mut stage = Stage::first();
            stage.look(DVec3::new(0.0, 50.0, 400.0), math::rotation(DVec3::Y, 3.0));
            stage
        }),
        ("an orthographic view", {
            let mut stage = Stage::first();
            stage.view.projection = Projection::Orthographic;
            stage
        }),
        ("a wall", {
            let placement = DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2)
                * DMat4::from_scale(DVec3::splat(600.0));
            Stage::with(Shape::Plane, placement)
        }),
    ];
    for (name, mut stage) in cases {
        for shape in SOLIDS {
            let new = stage.add(shape);
            let part = stage.part_of_view();
            assert!((0.09..=0.45).contains(&part), "{name}: {shape:?} is {part} of the view");
            let eye = stage.pose().eye;
            let around = new.nearest_to(eye).distance(eye) < new.extent().x / 4.0;
            assert!(!around, "{name}: {shape:?} is around the camera");
            let others = stage.boxes();
            let others = others[1..].iter().filter(|other| other.nearest_to(eye) != eye);
            let touched = others.filter(|other| touch(other, &new)).count();
            assert_eq!(touched, 0, "{name}: {shape:?} is in another object");
        }
    }
}

#[test]
fn equal_shapes_share_a_model_and_other_sizes_have_their_own() {
    let mut stage = Stage::empty();
    stage.add(Shape::Torus);
    stage.add(Shape::Torus);
    let same = |stage: &Stage, i: usize, j: usize| {
        let models: Vec<_> = stage.scene.objects.iter().map(|(_, it)| it.model.clone()).collect();
        marraztu_core::base::Shared::same(&models[i], &models[j])
    };
    assert!(same(&stage, 0, 1));
    stage.look(DVec3::Z * 4000.0, DMat3::IDENTITY);
    stage.add(Shape::Torus);
    assert!(!same(&stage, 0, 1));
    let newest = stage.scene.objects.first().unwrap();
    assert!(stage.scene.contains(ItemId::Object(newest)));
}
