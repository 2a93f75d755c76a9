//! Placements after a million steps, cameras over the pole, and what comes back by undo.
//!
//! | case | what is broken where it fails |
//! |---|---|
//! | 5 | rank judged by the determinant alone |
//! | 7 | a scale of 0 let through |
//! | 56 | look-at without its last right vector |
//! | 57, 61 | placements in 32 bits; cameras whose axes are not made orthonormal |
//! | 58 | whole turns taken off by a rounded 2 pi |
//! | 59 | aiming with the world's Y up after each step of an orbit |
//! | 60 | orbits that are not turns, or that aim without turning |
//! | 62 | `tests/history.rs`: undoing by an inverse |
//! | 63 | undoing that builds anew what was removed |

use glam::{DMat3, DVec3};
use marraztu::base::math::Axis;
use marraztu::edit::transform::{self, Sign};
use marraztu::edit::{Gesture, History, Refusal, Stroke, items, look, place, selection};
use marraztu::io::{self, Progress};
use marraztu::scene::{
    Command, Frame, ItemId, ObjectId, Pose, Scene, Settings, Subject, Transformation, View,
};

use super::common::three_objects;

fn desk(subject: Subject, transformation: Transformation) -> (Scene, View) {
    let (scene, view) = three_objects();
    (scene, View { subject, transformation, ..view })
}

#[track_caller]
fn apply(scene: &mut Scene, command: Result<Command, Refusal>) {
    command.unwrap().apply(scene).unwrap();
}

fn linear(scene: &Scene, view: &View) -> DMat3 {
    DMat3::from_mat4(*scene.objects.get(view.object.unwrap()).unwrap().placement.now())
}

fn pose(scene: &Scene, view: &View) -> Pose {
    *scene.selected_camera(view).pose.now()
}

fn centre(scene: &Scene, view: &View) -> DVec3 {
    scene.objects.get(view.object.unwrap()).unwrap().centre(view.time)
}

/// The largest entry of M'M - I.
fn skew(m: DMat3) -> f64 {
    let rest = m.transpose() * m - DMat3::IDENTITY;
    rest.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// How far, in radians, the camera looks past the selected object's centre.
fn off_aim(scene: &Scene, view: &View) -> f64 {
    let pose = pose(scene, view);
    let to_eye = pose.eye - centre(scene, view);
    to_eye.cross(pose.axes.z_axis).length().atan2(to_eye.dot(pose.axes.z_axis))
}

/// The angle between two frames, in radians: |R - S| = sqrt(8) sin(angle / 2).
fn between(a: DMat3, b: DMat3) -> f64 {
    let squares: f64 = (a - b).to_cols_array().iter().map(|x| x * x).sum();
    2.0 * (squares / 8.0).sqrt().min(1.0).asin()
}

#[test]
fn case_5_an_object_made_smaller_329_times_is_still_an_object() {
    let (mut scene, view) = desk(Subject::Object, Transformation::Scaling);
    for _ in 0..329 {
        let command = transform::scale(&scene, &view, 0.9, Stroke::First);
        apply(&mut scene, command);
    }
    let m = linear(&scene, &view);
    assert!((m.x_axis.x / 0.9_f64.powi(329) - 1.0).abs() < 1e-12);
    for _ in 0..329 {
        let command = transform::take_back(&scene, &view);
        apply(&mut scene, command);
    }
    assert_eq!(linear(&scene, &view), DMat3::IDENTITY);
}

#[test]
fn case_7_a_scale_of_zero_is_refused_whatever_way_it_comes() {
    let (scene, view) = desk(Subject::Object, Transformation::Scaling);
    let id = view.object.unwrap();
    for factors in [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, -0.0, 1.0)] {
        for frame in [Frame::Local, Frame::Global] {
            let view = View { frame, ..view.clone() };
            let dragged = transform::stretch(&scene, &view, factors, Stroke::First);
            assert_eq!(dragged, Err(Refusal::Flat));
        }
        let typed = place::object_scale(&scene, &view, id, factors, Stroke::First);
        assert_eq!(typed, Err(Refusal::Flat));
    }
    let mut view = view;
    view.steps.scaling = 0.0;
    assert!(transform::step(&scene, &view, Axis::X, Sign::Positive, Stroke::First).is_err());
    assert!(transform::step(&scene, &view, Axis::X, Sign::Negative, Stroke::First).is_err());
}

#[test]
fn case_56_looking_straight_down_or_at_ones_own_eye_is_finite_and_does_not_jump() {
    let (scene, view) = desk(Subject::Camera, Transformation::Translation);
    let middle = centre(&scene, &view);
    let turn = DVec3::new(37.0, -90.0, 0.0);
    for height in [1e-3, 1.0, 1e3] {
        for aside in [0.0, 1e-12, 1e-9, 1e-7, 7e-7] {
            let mut scene = scene.clone();
            let eye = middle + DVec3::new(aside * height, height, -aside * height);
            let camera = view.camera;
            let command = place::camera_turn(&scene, &view, camera, turn, Stroke::First);
            apply(&mut scene, command);
            let command = place::camera_eye(&scene, &view, camera, eye, Stroke::First);
            apply(&mut scene, command);
            let before = pose(&scene, &view).axes;
            let command = transform::toggle_analysis(&scene, &view);
            apply(&mut scene, command);
            let after = pose(&scene, &view).axes;
            assert!(between(before, after) < 1e-5, "{height} {aside}: {before} {after}");
            assert!(skew(after) < 1e-12);
        }
    }
    let mut scene = scene;
    let command = place::camera_eye(&scene, &view, view.camera, middle, Stroke::First);
    apply(&mut scene, command);
    let before = pose(&scene, &view).axes;
    let command = transform::toggle_analysis(&scene, &view);
    apply(&mut scene, command);
    assert_eq!(pose(&scene, &view).axes, before);
    // From there, turning and going away still works.
    for axis in Axis::ALL {
        let command = transform::step(&scene, &view, axis, Sign::Positive, Stroke::First);
        apply(&mut scene, command);
        assert!(skew(pose(&scene, &view).axes) < 1e-12);
    }
    assert!((pose(&scene, &view).eye.distance(middle) - 10.0).abs() < 1e-9);
}

#[test]
fn case_57_a_million_turns_of_one_degree_end_where_280_degrees_do() {
    let one = 1.0_f64.to_radians();
    for frame in [Frame::Local, Frame::Global] {
        let (mut scene, mut view) = desk(Subject::Object, Transformation::Rotation);
        view.frame = frame;
        let axis = DVec3::new(1.0, 2.0, 3.0);
        for _ in 0..1_000_000 {
            let command = transform::rotate(&scene, &view, axis, one, Stroke::Continued);
            apply(&mut scene, command);
        }
        let expected = DMat3::from_axis_angle(axis / 14.0_f64.sqrt(), 280.0_f64.to_radians());
        let m = linear(&scene, &view);
        assert!(between(m, expected) < 1e-9, "{:e}", between(m, expected));
        assert!(skew(m) < 1e-9, "{:e}", skew(m));
    }
    let (mut scene, mut view) = desk(Subject::Camera, Transformation::Rotation);
    view.steps.rotation = 1.0;
    for _ in 0..1_000_000 {
        let sign = Sign::Positive;
        let command = transform::step(&scene, &view, Axis::X, sign, Stroke::Continued);
        apply(&mut scene, command);
    }
    let axes = pose(&scene, &view).axes;
    let expected = DMat3::from_axis_angle(DVec3::Y, 280.0_f64.to_radians());
    assert!(between(axes, expected) < 1e-9, "{:e}", between(axes, expected));
    assert!(skew(axes) < 1e-12, "{:e}", skew(axes));
}

#[test]
fn case_58_an_angle_of_a_million_radians_is_that_angle() {
    // cos and sin of 1e6, to 16 and 17 digits, from arithmetic of many digits.
    let (cos, sin) = (0.936_752_127_533_144_8, -0.349_993_502_171_292_94);
    let (mut scene, view) = desk(Subject::Object, Transformation::Rotation);
    let command = transform::rotate(&scene, &view, DVec3::Z, 1e6, Stroke::First);
    apply(&mut scene, command);
    let x = linear(&scene, &view).x_axis;
    assert!((x - DVec3::new(cos, sin, 0.0)).length() < 1e-15, "{x}");
    for radians in [f64::INFINITY, f64::NAN] {
        let refused = transform::rotate(&scene, &view, DVec3::Z, radians, Stroke::First);
        assert_eq!(refused, Err(Refusal::TooLarge));
    }
}

#[test]
fn case_59_an_orbit_over_the_pole_is_continuous() {
    let by_key = |scene: &Scene, view: &View| {
        transform::step(scene, view, Axis::Y, Sign::Negative, Stroke::First)
    };
    let by_mouse = |scene: &Scene, view: &View| {
        look::orbit(scene, view, 0.0, -1.0_f64.to_radians(), Stroke::First)
    };
    type Way = fn(&Scene, &View) -> Result<Command, Refusal>;
    for way in [by_key as Way, by_mouse as Way] {
        let (mut scene, mut view) = desk(Subject::Camera, Transformation::Rotation);
        view.steps.rotation = 1.0;
        let command = transform::toggle_analysis(&scene, &view);
        apply(&mut scene, command);
        let start = pose(&scene, &view);
        let mut highest = f64::NEG_INFINITY;
        for _ in 0..360 {
            let before = pose(&scene, &view);
            let command = way(&scene, &view);
            apply(&mut scene, command);
            let after = pose(&scene, &view);
            let angle = between(before.axes, after.axes).to_degrees();
            assert!((angle - 1.0).abs() < 1e-9, "{angle} degrees in a step of one");
            assert!(off_aim(&scene, &view) < 1e-12);
            highest = highest.max(after.eye.y);
        }
        assert!(highest > 400.0, "it was not over the pole");
        assert!((pose(&scene, &view).eye - start.eye).length() < 1e-9, "once round");
    }
}

#[test]
fn case_60_the_radius_of_an_orbit_is_kept_through_36000_steps() {
    for away in [DVec3::ZERO, DVec3::new(1e6, -1e6, 1e6)] {
        let (mut scene, mut view) = desk(Subject::Camera, Transformation::Rotation);
        let id = view.object.unwrap();
        let command = place::object_translation(&scene, &view, id, away, Stroke::First);
        apply(&mut scene, command);
        let eye = away + DVec3::new(100.0, 200.0, 300.0);
        let command = place::camera_eye(&scene, &view, view.camera, eye, Stroke::First);
        apply(&mut scene, command);
        let command = transform::toggle_analysis(&scene, &view);
        apply(&mut scene, command);
        let middle = centre(&scene, &view);
        let distance = pose(&scene, &view).eye.distance(middle);
        view.steps.rotation = 0.7;
        for i in 0..36_000 {
            let axis = if i % 3 == 0 { Axis::Y } else { Axis::X };
            let command = transform::step(&scene, &view, axis, Sign::Positive, Stroke::Continued);
            apply(&mut scene, command);
        }
        let drift = (pose(&scene, &view).eye.distance(middle) - distance).abs();
        assert!(drift < 1e-9 * (distance + middle.length()), "{drift:e}");
        assert!(off_aim(&scene, &view) < 1e-12 * (1.0 + middle.length()));
        assert!(skew(pose(&scene, &view).axes) < 1e-12);
    }
}

#[test]
fn case_61_a_million_steps_of_a_tenth_are_a_hundred_thousand() {
    let (mut scene, mut view) = desk(Subject::Object, Transformation::Translation);
    view.steps.translation = 0.1;
    for _ in 0..1_000_000 {
        let sign = Sign::Positive;
        let command = transform::step(&scene, &view, Axis::Y, sign, Stroke::Continued);
        apply(&mut scene, command);
    }
    let object = scene.objects.get(view.object.unwrap()).unwrap();
    let error = (object.placement.now().w_axis.y - 100_000.0).abs();
    assert!(error < 1e-5, "{error:e}");
}

#[test]
fn case_63_deletion_and_return_and_joined_drags_bring_back_every_stack() {
    let (mut scene, mut view) = desk(Subject::Object, Transformation::Rotation);
    let mut history = History::new();
    let mut seen = vec![scene.clone()];
    let drag = |history: &mut History, scene: &mut Scene, view: &View, number| {
        for i in 0..100 {
            let stroke = if i == 0 { Stroke::First } else { Stroke::Continued };
            let command = transform::rotate(scene, view, DVec3::ONE, 0.1, stroke).unwrap();
            history.perform(scene, command, Gesture::Part(number), "Turn").unwrap();
        }
    };
    for number in 0..5 {
        drag(&mut history, &mut scene, &view, number);
        seen.push(scene.clone());
        let before = scene.clone();
        let id = [ObjectId(3), ObjectId(1), ObjectId(2)][usize::from(number > 2)];
        if scene.objects.get(id).is_some() {
            let command = items::remove(&scene, ItemId::Object(id)).unwrap();
            history.perform(&mut scene, command, Gesture::Whole, "Remove").unwrap();
            seen.push(scene.clone());
        }
        selection::follow(&before, &scene, &mut view);
    }
    for round in 0..2 {
        for (position, expected) in seen.iter().enumerate().rev() {
            history.go_to(&mut scene, position);
            assert!(scene == *expected, "round {round}, step {position}");
        }
        history.go_to(&mut scene, usize::MAX);
        assert!(Some(&scene) == seen.last());
    }
}

#[test]
fn case_63_a_scene_saved_on_the_way_is_the_one_that_redo_comes_back_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.marraztu");
    let (mut scene, mut view) = io::default_scene();
    view.subject = Subject::Object;
    let settings = Settings::default();
    let text = |scene: &Scene| io::to_text(&path, scene, &view, &settings).unwrap();
    let mut history = History::new();
    for axis in Axis::ALL.into_iter().cycle().take(30) {
        let command = transform::step(&scene, &view, axis, Sign::Positive, Stroke::First).unwrap();
        history.perform(&mut scene, command, Gesture::Whole, "Move").unwrap();
        if history.position() == 20 {
            io::save(&path, &scene, &view, &settings).unwrap();
            history.mark_saved();
        }
    }
    history.go_to(&mut scene, 0);
    history.go_to(&mut scene, 20);
    assert!(history.is_saved());
    assert_eq!(text(&scene), std::fs::read_to_string(&path).unwrap());
    let opened = io::open(&path, &Progress::new()).unwrap().scene;
    assert_eq!(text(&opened), text(&scene));
    let depths = opened.objects.iter().map(|(_, object)| object.placement.depth());
    assert_eq!(depths.sum::<usize>(), 0, "a loaded scene starts with no past");
}
