//! Rotations after a million steps, and cameras above the pole.

use glam::{DMat3, DVec3, Mat3, Vec3};
use marraztu_core::base::math::Axis;
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{GesturePhase, Refusal, navigation, placement};
use marraztu_core::scene::{
    Command, Frame, Light, LightKind, Pose, Scene, Subject, Transformation, View,
};

use super::cases::quick_round;
use super::figures::Figure;
use super::plates::three_objects;

pub(super) fn desk(subject: Subject, transformation: Transformation) -> (Scene, View) {
    let (scene, view) = three_objects();
    (scene, View { subject, transformation, ..view })
}

#[track_caller]
pub(super) fn apply(scene: &mut Scene, command: Result<Command, Refusal>) {
    command.unwrap().apply(scene).unwrap();
}

pub(super) fn linear(scene: &Scene, view: &View) -> DMat3 {
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

/// The angle in radians between the camera's axis and the centre of the selected object.
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
fn case_56_looking_straight_down_or_at_ones_own_eye_is_finite_and_does_not_jump() {
    let (scene, view) = desk(Subject::Camera, Transformation::Translation);
    let middle = centre(&scene, &view);
    // The axes before and after aiming at the object, from a height above it and a little aside.
    let aimed = |pitch: f64, height: f64, aside: f64| {
        let (mut scene, camera) = (scene.clone(), view.camera);
        let turn = DVec3::new(37.0, pitch, 0.0);
        let command = placement::camera_turn(&scene, &view, camera, turn, GesturePhase::First);
        apply(&mut scene, command);
        let eye = middle + DVec3::new(aside * height, height, -aside * height);
        let command = placement::camera_eye(&scene, &view, camera, eye, GesturePhase::First);
        apply(&mut scene, command);
        let before = pose(&scene, &view).axes;
        let command = transform::toggle_analysis(&scene, &view);
        apply(&mut scene, command);
        let after = pose(&scene, &view).axes;
        assert!(skew(after) < 1e-12);
        [before, after]
    };
    let mut jump = 0.0_f64;
    for height in [1e-3, 1.0, 1e3] {
        // A level camera has the target right below: its up and the direction are parallel.
        let [_, below] = aimed(0.0, height, 0.0);
        for aside in [0.0, 1e-12, 1e-9, 1e-7, 7e-7] {
            let [_, after] = aimed(0.0, height, aside);
            jump = jump.max(between(below, after));
            // This one already looks straight down, so aiming at the object should hardly turn it.
            let [before, after] = aimed(-90.0, height, aside);
            jump = jump.max(between(before, after));
        }
    }
    // The eye at the target: there is no direction to look along, so the axes stay as they are.
    let mut scene = scene;
    let command = placement::camera_eye(&scene, &view, view.camera, middle, GesturePhase::First);
    apply(&mut scene, command);
    let before = pose(&scene, &view).axes;
    let command = transform::toggle_analysis(&scene, &view);
    apply(&mut scene, command);
    assert_eq!(pose(&scene, &view).axes, before);
    // From there the camera still rotates and moves away.
    for axis in Axis::ALL {
        let command = transform::step(&scene, &view, axis, Sign::Positive, GesturePhase::First);
        apply(&mut scene, command);
        assert!(skew(pose(&scene, &view).axes) < 1e-12);
    }
    assert!((pose(&scene, &view).eye.distance(middle) - 10.0).abs() < 1e-9);
    // The naive camera normalises up x z, which is 0 here.
    let across = DVec3::Y.cross(DVec3::Y);
    Figure {
        case: 56,
        what: "how far a camera jumps that is aimed straight down, or 1e-12 to 7e-7 beside it",
        naive: Some(("up x z brought to length 1", (across / across.length()).x)),
        ours: jump,
        bound: 1e-5,
        unit: "radians",
    }
    .hold();
}

#[test]
fn case_57_a_million_turns_of_one_degree_end_where_280_degrees_do() {
    let one = 1.0_f64.to_radians();
    let (mut off, mut skewed) = (0.0_f64, 0.0_f64);
    // Objects, in both frames.
    for frame in [Frame::Local, Frame::Global] {
        let (mut scene, mut view) = desk(Subject::Object, Transformation::Rotation);
        view.frame = frame;
        let axis = DVec3::new(1.0, 2.0, 3.0);
        for _ in 0..1_000_000 {
            let command = transform::rotate(&scene, &view, axis, one, GesturePhase::Continued);
            apply(&mut scene, command);
        }
        let expected = DMat3::from_axis_angle(axis / 14.0_f64.sqrt(), 280.0_f64.to_radians());
        let m = linear(&scene, &view);
        off = off.max(between(m, expected));
        skewed = skewed.max(skew(m));
    }
    // The camera, with steps of one degree.
    let (mut scene, mut view) = desk(Subject::Camera, Transformation::Rotation);
    view.steps.rotation = 1.0;
    for _ in 0..1_000_000 {
        let sign = Sign::Positive;
        let command = transform::step(&scene, &view, Axis::X, sign, GesturePhase::Continued);
        apply(&mut scene, command);
    }
    let axes = pose(&scene, &view).axes;
    let expected = DMat3::from_axis_angle(DVec3::Y, 280.0_f64.to_radians());
    let (naive_off, naive_skewed) = single_turns();
    for (what, naive, ours, bound) in [
        ("angle of an object after a million turns of 1 degree", naive_off, off, 1e-9),
        ("largest entry of M'M - I of that object", naive_skewed, skewed, 1e-9),
        ("angle of a camera after as many", naive_off, between(axes, expected), 1e-9),
        ("largest entry of M'M - I of that camera", naive_skewed, skew(axes), 1e-12),
    ] {
        let naive = Some(("matrices in f32", naive));
        Figure { case: 57, what, naive, ours, bound, unit: "radians" }.hold();
    }
}

/// Error in angle and orthogonality after a million rotations of one degree in f32, which should
/// end at 280 degrees.
fn single_turns() -> (f64, f64) {
    let axis = Vec3::new(1.0, 2.0, 3.0) / 14.0_f32.sqrt();
    let turn = Mat3::from_axis_angle(axis, 1.0_f32.to_radians());
    let mut m = Mat3::IDENTITY;
    for _ in 0..1_000_000 {
        m *= turn;
    }
    let exact = DVec3::new(1.0, 2.0, 3.0) / 14.0_f64.sqrt();
    let expected = DMat3::from_axis_angle(exact, 280.0_f64.to_radians());
    (between(m.as_dmat3(), expected), skew(m.as_dmat3()))
}

#[test]
fn case_57_a_million_presses_of_any_turning_key_end_where_twice_the_digits_do() {
    let tally = quick_round("presses");
    for (what, name, bound) in [
        ("object's angle", "angle of objects after 250,000 turns by any key", 1e-9),
        ("camera's angle", "angle of a camera after as many turns by any key", 1e-9),
        ("object's way", "place of an object after 250,000 steps by any key", 1e-9),
    ] {
        let unit = if what == "object's way" { "of the way" } else { "radians" };
        Figure { case: 57, what: name, naive: None, ours: tally.worst[what], bound, unit }.hold();
    }
}

#[test]
fn case_58_an_angle_of_a_million_radians_is_that_angle() {
    // cos and sin of 1e6, to 16 and 17 digits, from multiple-precision arithmetic.
    let (cos, sin) = (0.936_752_127_533_144_8, -0.349_993_502_171_292_94);
    let (mut scene, view) = desk(Subject::Object, Transformation::Rotation);
    let command = transform::rotate(&scene, &view, DVec3::Z, 1e6, GesturePhase::First);
    apply(&mut scene, command);
    let x = linear(&scene, &view).x_axis;
    // Argument reduction in f32.
    let single = 1e6_f32 % std::f32::consts::TAU;
    Figure {
        case: 58,
        what: "where a turn by a million radians ends",
        naive: Some(("whole turns taken off in f32", f64::from(single.sin() - sin as f32).abs())),
        ours: (x - DVec3::new(cos, sin, 0.0)).length(),
        bound: 1e-15,
        unit: "of the radius",
    }
    .hold();
    // Angles without a finite sine are rejected.
    for radians in [f64::INFINITY, f64::NAN] {
        let refused = transform::rotate(&scene, &view, DVec3::Z, radians, GesturePhase::First);
        assert_eq!(refused, Err(Refusal::TooLarge));
    }
}

#[test]
fn case_59_an_orbit_over_the_pole_is_continuous() {
    let by_key = |scene: &Scene, view: &View| {
        transform::step(scene, view, Axis::Y, Sign::Negative, GesturePhase::First)
    };
    let by_mouse = |scene: &Scene, view: &View| {
        navigation::orbit(scene, view, 0.0, -1.0_f64.to_radians(), GesturePhase::First)
    };
    type Way = fn(&Scene, &View) -> Result<Command, Refusal>;
    let (mut uneven, mut naive) = (0.0_f64, 0.0_f64);
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
            uneven = uneven.max((angle - 1.0).abs());
            // The naive camera rebuilds its frame from the world's Y at each step.
            let upright = |pose: &Pose| {
                let z = pose.axes.z_axis;
                let x = DVec3::Y.cross(z) / DVec3::Y.cross(z).length();
                DMat3::from_cols(x, z.cross(x), z)
            };
            let angle = between(upright(&before), upright(&after)).to_degrees();
            naive = naive.max((angle - 1.0).abs());
            assert!(off_aim(&scene, &view) < 1e-12);
            highest = highest.max(after.eye.y);
        }
        assert!(highest > 400.0, "it was not over the pole");
        assert!((pose(&scene, &view).eye - start.eye).length() < 1e-9, "once round");
    }
    Figure {
        case: 59,
        what: "how far a step of one degree over the pole is from one degree",
        naive: Some(("up is always the world's Y", naive)),
        ours: uneven,
        bound: 1e-9,
        unit: "degrees",
    }
    .hold();
}

#[test]
fn case_60_the_radius_of_an_orbit_is_kept_through_36000_steps() {
    for (away, what) in [
        (DVec3::ZERO, "drift of an orbit's radius, by distance plus centre"),
        (DVec3::new(1e6, -1e6, 1e6), "drift of an orbit's radius, a million units off"),
    ] {
        let (mut scene, mut view) = desk(Subject::Camera, Transformation::Rotation);
        let id = view.object.unwrap();
        let command = placement::object_translation(&scene, &view, id, away, GesturePhase::First);
        apply(&mut scene, command);
        // The camera orbits the object in steps of 0.7 degrees, by turns about X and Y.
        let eye = away + DVec3::new(100.0, 200.0, 300.0);
        let command = placement::camera_eye(&scene, &view, view.camera, eye, GesturePhase::First);
        apply(&mut scene, command);
        let command = transform::toggle_analysis(&scene, &view);
        apply(&mut scene, command);
        let middle = centre(&scene, &view);
        let distance = pose(&scene, &view).eye.distance(middle);
        view.steps.rotation = 0.7;
        for i in 0..36_000 {
            let axis = if i % 3 == 0 { Axis::Y } else { Axis::X };
            let command =
                transform::step(&scene, &view, axis, Sign::Positive, GesturePhase::Continued);
            apply(&mut scene, command);
        }
        let drift = (pose(&scene, &view).eye.distance(middle) - distance).abs();
        Figure {
            case: 60,
            what,
            naive: Some(("turned in f32, not aimed again", single_drift(middle, distance))),
            ours: drift / (distance + middle.length()),
            bound: 1e-9,
            unit: "of both",
        }
        .hold();
        assert!(off_aim(&scene, &view) < 1e-12 * (1.0 + middle.length()));
        assert!(skew(pose(&scene, &view).axes) < 1e-12);
    }
}

/// The drift of the same steps in f32 about a centre, relative to distance plus centre.
fn single_drift(centre: DVec3, distance: f64) -> f64 {
    let middle = centre.as_vec3();
    let step = 0.7_f32.to_radians();
    let turns = [Mat3::from_rotation_x(step), Mat3::from_rotation_y(step)];
    let mut eye = middle + Vec3::Z * distance as f32;
    for i in 0..36_000 {
        eye = middle + turns[usize::from(i % 3 != 0)] * (eye - middle);
    }
    (f64::from((eye - middle).length()) - distance).abs() / (distance + centre.length())
}

#[test]
fn case_61_a_million_steps_of_a_tenth_are_a_hundred_thousand() {
    let single = (0..1_000_000).fold(0.0_f32, |sum, _| sum + 0.1);
    for (subject, what) in [
        (Subject::Object, "a million steps of 0.1 of an object against 100,000"),
        (Subject::Camera, "a million steps of 0.1 of a camera against 100,000"),
        (Subject::Light, "a million steps of 0.1 of a light against 100,000"),
    ] {
        let (mut scene, mut view) = desk(subject, Transformation::Translation);
        view.steps.translation = 0.1;
        if subject == Subject::Light {
            let bulb = |light: &Light| matches!(light.kind, LightKind::Bulb { .. });
            view.light = scene.lights.iter().find(|(_, light)| bulb(light)).map(|(id, _)| id);
        }
        // The stepped coordinate of the subject.
        let place = |scene: &Scene| match subject {
            Subject::Object => {
                scene.objects.get(view.object.unwrap()).unwrap().placement.now().w_axis.z
            }
            Subject::Camera => pose(scene, &view).eye.z,
            Subject::Light => match &scene.lights.get(view.light.unwrap()).unwrap().kind {
                LightKind::Bulb { position, .. } => position.now().z,
                kind => panic!("{kind:?} is no bulb"),
            },
        };
        let before = place(&scene);
        for _ in 0..1_000_000 {
            let command =
                transform::step(&scene, &view, Axis::Z, Sign::Positive, GesturePhase::Continued);
            apply(&mut scene, command);
        }
        Figure {
            case: 61,
            what,
            naive: Some(("summed in f32", f64::from(single - 100_000.0).abs())),
            ours: ((place(&scene) - before).abs() - 100_000.0).abs(),
            bound: 1e-5,
            unit: "units",
        }
        .hold();
    }
}
