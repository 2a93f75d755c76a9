//! Placements typed as numbers, and the numbers displayed for them.

use glam::{DMat3, DMat4, DVec3};
use marraztu_core::base::math::Axis;
use marraztu_core::edit::{GesturePhase, Refusal, placement};
use marraztu_core::scene::{LightId, ObjectId, Pose, Subject, Transformation};
use proptest::prelude::*;

use super::desk::{Desk, close, close_matrix, turned};

const ID: ObjectId = ObjectId(3);

fn desk() -> Desk {
    Desk::new(Subject::Object, Transformation::Translation)
}

fn typed(desk: &mut Desk, m: DMat4) {
    desk.perform(placement::object(&desk.scene, &desk.view, ID, m, GesturePhase::First));
}

/// Angles as users type them: many round ones, and values near gimbal lock.
fn degrees() -> impl Strategy<Value = f64> {
    prop_oneof![
        prop::sample::select(vec![0.0, 90.0, -90.0, 180.0, 45.0, 89.9999999]),
        -180.0..180.0,
    ]
}

fn angles() -> impl Strategy<Value = DVec3> {
    (degrees(), degrees(), degrees()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

proptest! {
    #[test]
    fn typing_the_angles_that_are_shown_changes_nothing(angles in angles(), mirrored: bool) {
        let mut desk = desk();
        let scale = DVec3::new(if mirrored { -2.0 } else { 2.0 }, 3.0, 0.5);
        typed(&mut desk, DMat4::from_translation(DVec3::ONE) * DMat4::from_scale(scale));
        let first = GesturePhase::First;
        desk.perform(placement::object_turn(&desk.scene, &desk.view, ID, angles, first));
        let m = desk.placement();
        let expected = turned(Axis::X, angles.x) * turned(Axis::Y, angles.y)
            * turned(Axis::Z, angles.z) * DMat3::from_diagonal(scale);
        prop_assert!(DMat3::from_mat4(m).abs_diff_eq(expected, 1e-9));
        let shown = placement::turn_degrees(&m);
        desk.perform(placement::object_turn(&desk.scene, &desk.view, ID, shown, first));
        // At 90 degrees about Y (gimbal lock), the other two angles lose half of their digits.
        prop_assert!(desk.placement().abs_diff_eq(m, 1e-6));
        prop_assert!((placement::scale(&m) - scale).length() < 1e-9);
    }

    #[test]
    fn a_cameras_yaw_pitch_and_roll_equal_the_typed_values(angles in angles()) {
        let mut desk = desk();
        let (camera, first) = (desk.view.camera, GesturePhase::First);
        desk.perform(placement::camera_turn(&desk.scene, &desk.view, camera, angles, first));
        let [yaw, pitch] = [turned(Axis::Y, angles.x), turned(Axis::X, angles.y)];
        let axes = yaw * pitch * turned(Axis::Z, angles.z);
        prop_assert!(desk.pose().axes.abs_diff_eq(axes, 1e-9));
        let shown = placement::camera_degrees(&desk.pose());
        desk.perform(placement::camera_turn(&desk.scene, &desk.view, camera, shown, first));
        prop_assert!(desk.pose().axes.abs_diff_eq(axes, 1e-6));
        prop_assert_eq!(desk.pose().eye, DVec3::Z * 400.0);
    }
}

#[test]
fn one_typed_number_leaves_the_others_and_a_shear_alone() {
    let mut desk = desk();
    let shear = DMat4::from_cols_array(&[
        1.0, 0.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 7.0, 8.0, 9.0, 1.0,
    ]);
    typed(&mut desk, shear);
    let to = DVec3::new(1.0, 2.0, 3.0);
    desk.perform(placement::object_translation(
        &desk.scene,
        &desk.view,
        ID,
        to,
        GesturePhase::First,
    ));
    close_matrix(desk.placement(), DMat4 { w_axis: to.extend(1.0), ..shear });
    let scale = placement::scale(&desk.placement());
    let to = DVec3 { x: 4.0, ..scale };
    desk.perform(placement::object_scale(&desk.scene, &desk.view, ID, to, GesturePhase::First));
    close(desk.placement().x_axis.truncate(), DVec3::X * 4.0);
    close(desk.placement().y_axis.truncate(), DVec3::new(0.5, 1.0, 0.0));
    assert_eq!(desk.object().placement.depth(), 3, "each typed value is a step for u");
}

#[test]
fn an_invalid_placement_is_refused() {
    let desk = desk();
    let scale = |to| placement::object_scale(&desk.scene, &desk.view, ID, to, GesturePhase::First);
    assert_eq!(scale(DVec3::new(1.0, 0.0, 1.0)), Err(Refusal::Flat));
    let to = DVec3::new(f64::NAN, 0.0, 0.0);
    let moved = placement::object_translation(&desk.scene, &desk.view, ID, to, GesturePhase::First);
    assert_eq!(moved, Err(Refusal::TooLarge));
    let turned = placement::object_turn(&desk.scene, &desk.view, ID, to, GesturePhase::First);
    assert_eq!(turned, Err(Refusal::TooLarge));
    let sun = |to| placement::light_direction(&desk.scene, LightId(5), to, GesturePhase::First);
    assert_eq!(sun(DVec3::ZERO), Err(Refusal::NoDirection));
    assert_eq!(sun(to), Err(Refusal::TooLarge));
    let sun = placement::light_position(&desk.scene, LightId(5), DVec3::ONE, GesturePhase::First);
    assert_eq!(sun, Err(Refusal::SunMoved));
}

#[test]
fn a_typed_direction_has_length_one() {
    let mut desk = Desk::new(Subject::Light, Transformation::Translation);
    let to = DVec3::new(0.0, -3.0, 4.0);
    desk.perform(placement::light_direction(&desk.scene, LightId(5), to, GesturePhase::First));
    close(desk.light().1, DVec3::new(0.0, -0.6, 0.8));
}

#[test]
fn a_camera_in_analysis_keeps_its_centre_in_view_when_eye_or_angles_are_typed() {
    let mut desk = Desk::new(Subject::Camera, Transformation::Translation);
    desk.analyse();
    let eye = DVec3::new(50.0, 60.0, 70.0);
    desk.perform(placement::camera_eye(
        &desk.scene,
        &desk.view,
        desk.view.camera,
        eye,
        GesturePhase::First,
    ));
    assert_eq!(desk.pose().eye, eye);
    assert!(desk.off_aim() < 1e-12);
    let away = |pose: Pose, desk: &Desk| pose.eye.distance(desk.object().centre(0.0));
    let before = away(desk.pose(), &desk);
    let to = DVec3::new(90.0, 0.0, 0.0);
    desk.perform(placement::camera_turn(
        &desk.scene,
        &desk.view,
        desk.view.camera,
        to,
        GesturePhase::First,
    ));
    close(desk.pose().axes.z_axis, DVec3::X);
    assert!(desk.off_aim() < 1e-12 && (away(desk.pose(), &desk) - before).abs() < 1e-9);
}
