//! Framing: the camera moves until whole objects are in view.

use glam::DVec3;
use marraztu_core::base::image::Size;
use marraztu_core::edit::framing::{self, Side};
use marraztu_core::edit::{GesturePhase, Refusal, items, placement, shapes};
use marraztu_core::scene::{
    CameraMode, ItemId, ObjectId, Observer, Projection, Shape, Subject, Transformation, dvec3,
};

use super::desk::{Desk, close};

fn desk() -> Desk {
    Desk::new(Subject::Camera, Transformation::Translation)
}

#[test]
fn the_object_is_seen_from_r_through_the_sine_of_the_half_angle() {
    let mut desk = desk();
    desk.perform(framing::selection(&desk.scene, &desk.view));
    // The bounding box of the plate has its centre at (1, 2, 3) and its corners 5 from there;
    // 5 / sin 22.5 is 13.0656...
    let distance = 13.065_629_648_763_766;
    close(desk.pose().eye, DVec3::new(-99.0, 2.0, 3.0 + distance));
    close(desk.pose().axes.z_axis, DVec3::Z);
    let lens = desk.scene.selected_camera(&desk.view).lens;
    assert!((lens.near - distance / 1000.0).abs() < 1e-12, "{}", lens.near);
    assert!((lens.half_size - 5.5).abs() < 1e-12 && lens.far == 2000.0);
    assert_eq!(desk.camera_depth(), 1);
}

#[test]
fn models_alone_are_seen_from_the_right_and_above_with_a_margin() {
    let mut desk = desk();
    desk.view.only_selected = true;
    desk.perform(framing::models(&desk.scene, &desk.view, framing::MODELS_FROM));
    // sin 30 cos 20, sin 20, cos 30 cos 20
    let z = DVec3::new(0.469_846_310_392_954, 0.342_020_143_325_669, 0.813_797_681_349_374);
    close(desk.pose().axes.z_axis, z);
    let [x, y] = [desk.pose().axes.x_axis, desk.pose().axes.y_axis];
    assert!(x.y.abs() < 1e-12 && y.y > 0.9, "it is upright: {x} {y}");
    // The margin makes the distance 1.05 times as large.
    close(desk.pose().eye, DVec3::new(-99.0, 2.0, 3.0) + z * (1.05 * 13.065_629_648_763_766));
    let lens = desk.scene.selected_camera(&desk.view).lens;
    assert!((lens.half_size - 5.5).abs() < 1e-12, "{}", lens.half_size);
}

#[test]
fn whatever_its_size_every_vertex_is_in_the_picture_in_both_projections() {
    for scale in [1e-6, 0.16, 1.0, 1e6] {
        let mut desk = desk();
        let to = DVec3::splat(scale);
        let id = ObjectId(3);
        desk.perform(placement::object_scale(&desk.scene, &desk.view, id, to, GesturePhase::First));
        desk.perform(framing::selection(&desk.scene, &desk.view));
        let lens = desk.scene.selected_camera(&desk.view).lens;
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let clip_from_view = lens.clip_from_view(projection, Size::new(640, 480));
            let clip_from_object =
                clip_from_view * desk.pose().world_from_camera().inverse() * desk.placement();
            for position in desk.object().model.mesh.positions() {
                let p = clip_from_object * dvec3(*position).extend(1.0);
                assert!(p.x.abs() <= p.w && p.y.abs() <= p.w, "{scale} {projection:?} {p}");
                assert!((0.0..=p.w).contains(&p.z), "{scale} {projection:?} {p}");
            }
        }
    }
}

#[test]
fn home_sees_all_that_is_shown() {
    let mut desk = desk();
    let far_away = ItemId::Object(ObjectId(1));
    desk.perform(items::toggle_shown(&desk.scene, far_away));
    desk.perform(framing::all(&desk.scene, &desk.view));
    // Two spheres of radius 5 about (-99, 2, 3) and (101, 2, 3).
    let distance = 105.0 / 22.5_f64.to_radians().sin();
    close(desk.pose().eye, DVec3::new(1.0, 2.0, 3.0 + distance));
    desk.view.only_selected = true;
    desk.perform(framing::all(&desk.scene, &desk.view));
    close(desk.pose().eye, DVec3::new(-99.0, 2.0, 3.0 + 5.0 / 22.5_f64.to_radians().sin()));
    for id in [2, 3] {
        desk.perform(items::toggle_shown(&desk.scene, ItemId::Object(ObjectId(id))));
    }
    assert_eq!(framing::all(&desk.scene, &desk.view), Err(Refusal::NothingToFrame));
}

#[test]
fn home_frames_what_stands_on_a_ground_and_a_ground_alone() {
    let mut desk = desk();
    desk.perform(framing::all(&desk.scene, &desk.view));
    let before = desk.pose().eye;
    let add = shapes::insert(&desk.scene, &desk.view, Shape::Ground);
    desk.perform(Ok(add));
    desk.perform(framing::all(&desk.scene, &desk.view));
    close(desk.pose().eye, before);
    for id in [1, 2, 3] {
        desk.perform(items::toggle_shown(&desk.scene, ItemId::Object(ObjectId(id))));
    }
    desk.perform(framing::all(&desk.scene, &desk.view));
    assert!(desk.pose().eye.distance(before) > 100.0);
}

#[test]
fn the_sides_look_along_the_axes_of_the_world() {
    let expected = [
        (Side::Front, DVec3::Z, DVec3::Y),
        (Side::Right, DVec3::X, DVec3::Y),
        (Side::Top, DVec3::Y, DVec3::NEG_Z),
        (Side::Back, DVec3::NEG_Z, DVec3::Y),
        (Side::Left, DVec3::NEG_X, DVec3::Y),
        (Side::Bottom, DVec3::NEG_Y, DVec3::Z),
    ];
    for (side, z, y) in expected {
        let mut desk = desk();
        desk.perform(framing::side(&desk.scene, &desk.view, side));
        assert_eq!((desk.pose().axes.z_axis, desk.pose().axes.y_axis), (z, y), "{side:?}");
        let away = desk.pose().eye - DVec3::new(-99.0, 2.0, 3.0);
        close(away, z * 13.065_629_648_763_766);
    }
}

#[test]
fn analysis_from_above_does_not_turn_the_picture() {
    for side in [Side::Top, Side::Bottom] {
        // In practice the centre is never exactly below the camera.
        for aside in [DVec3::new(0.1, 0.0, 0.1), DVec3::new(-0.1, 0.0, -0.2)] {
            let mut desk = desk();
            desk.perform(framing::side(&desk.scene, &desk.view, side));
            let id = desk.view.camera;
            let eye = desk.pose().eye + aside;
            desk.perform(placement::camera_eye(
                &desk.scene,
                &desk.view,
                id,
                eye,
                GesturePhase::First,
            ));
            let before = desk.pose().axes;
            desk.analyse();
            assert!(desk.pose().axes.x_axis.dot(before.x_axis) > 0.99, "{side:?} {aside}");
        }
    }
}

#[test]
fn framing_in_analysis_stays_in_analysis_and_framing_something_else_does_not() {
    let mut desk = desk();
    desk.analyse();
    desk.perform(framing::selection(&desk.scene, &desk.view));
    assert_eq!(desk.mode(), CameraMode::Analysis { target: ObjectId(3) });
    assert!(desk.off_aim() < 1e-12);
    desk.perform(framing::all(&desk.scene, &desk.view));
    assert_eq!(desk.mode(), CameraMode::Fly);
    desk.view.observer = Observer::Object;
    assert_eq!(framing::all(&desk.scene, &desk.view), Err(Refusal::ObjectLooks));
}
