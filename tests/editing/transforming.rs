//! The effect of the keys x, y, z, g and u on objects, cameras and lights.

use glam::{DMat3, DMat4, DVec3};
use marraztu_core::base::math::Axis;
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{GesturePhase, Refusal, items, lights, selection};
use marraztu_core::scene::{
    CameraMode, Frame, ItemId, LightId, LightKind, ObjectId, SpotOwner, Subject, Transformation,
};

use super::desk::{Desk, close, close_matrix, turned};

const SIGNS: [(Sign, f64); 2] = [(Sign::Positive, 1.0), (Sign::Negative, -1.0)];

#[test]
fn an_object_takes_a_step_from_the_right_in_its_own_frame_and_from_the_left_in_the_worlds() {
    use Transformation::{Rotation, Scaling, Translation};
    for axis in Axis::ALL {
        for (sign, s) in SIGNS {
            for kind in [Translation, Rotation, Scaling] {
                let t = match kind {
                    Translation => DMat4::from_translation(axis.unit() * 10.0 * s),
                    Rotation => DMat4::from_mat3(turned(axis, 10.0 * s)),
                    Scaling => {
                        DMat4::from_scale(DVec3::splat(if s > 0.0 { 1.2 } else { 1.0 / 1.2 }))
                    }
                };
                for frame in [Frame::Local, Frame::Global] {
                    let mut desk = Desk::new(Subject::Object, kind);
                    desk.view.frame = frame;
                    // A rotated object, for which the frames differ.
                    let view = desk.view.clone();
                    desk.view.transformation = Rotation;
                    desk.press(Axis::Y, Sign::Positive);
                    desk.view = view;
                    let m = desk.placement();
                    desk.press(axis, sign);
                    let expected = if frame == Frame::Local { m * t } else { t * m };
                    close_matrix(desk.placement(), expected);
                }
            }
        }
    }
}

#[test]
fn a_camera_in_fly_yaws_by_x_pitches_by_y_and_moves_or_rolls_by_z() {
    for kind in [Transformation::Translation, Transformation::Rotation] {
        for (sign, s) in SIGNS {
            let mut desk = Desk::new(Subject::Camera, kind);
            desk.press(Axis::Y, sign);
            desk.press(Axis::X, sign);
            let axes = turned(Axis::X, 10.0 * s) * turned(Axis::Y, 10.0 * s);
            close(desk.pose().eye, DVec3::Z * 400.0);
            close(desk.pose().axes.z_axis, axes.z_axis);
            close(desk.pose().axes.y_axis, axes.y_axis);
            desk.press(Axis::Z, sign);
            let pose = desk.pose();
            close(pose.axes.z_axis, axes.z_axis);
            if kind == Transformation::Translation {
                close(pose.eye, DVec3::Z * 400.0 + axes.z_axis * 10.0 * s);
                close(pose.axes.y_axis, axes.y_axis);
            } else {
                close(pose.eye, DVec3::Z * 400.0);
                close(pose.axes.y_axis, axes * turned(Axis::Z, 10.0 * s) * DVec3::Y);
            }
        }
    }
}

#[test]
fn entering_analysis_aims_at_the_mean_of_the_vertices_and_leaving_moves_nothing() {
    let mut desk = Desk::new(Subject::Camera, Transformation::Translation);
    desk.analyse();
    // The centre is (-100 + 1, 2, 3), the eye (0, 0, 400).
    let z = DVec3::new(99.0, -2.0, 397.0) / 99.0_f64.hypot(2.0).hypot(397.0);
    close(desk.pose().axes.z_axis, z);
    assert!(desk.pose().axes.x_axis.y.abs() < 1e-12, "upright");
    assert_eq!(desk.camera_depth(), 1);
    assert_eq!(desk.mode(), CameraMode::Analysis { target: ObjectId(3) });

    let pose = desk.pose();
    desk.analyse();
    close(desk.pose().axes.z_axis, pose.axes.z_axis);
    assert_eq!((desk.pose().mode, desk.camera_depth()), (CameraMode::Fly, 1));
    desk.take_back();
    assert_eq!(desk.pose().axes, DMat3::IDENTITY, "u takes the look-at back");
}

#[test]
fn a_camera_in_analysis_orbits_by_x_and_y_about_axes_parallel_to_its_own() {
    for (axis, about) in [(Axis::X, Axis::Y), (Axis::Y, Axis::X)] {
        for (sign, s) in SIGNS {
            let mut desk = Desk::new(Subject::Camera, Transformation::Translation);
            desk.analyse();
            let (before, centre) = (desk.pose(), desk.object().centre(0.0));
            desk.press(axis, sign);
            let after = desk.pose();
            // Rotation about an axis k of the camera: the rotation in the camera's frame,
            // conjugated into the world.
            let turn = before.axes * turned(about, 10.0 * s) * before.axes.transpose();
            close(after.eye, centre + turn * (before.eye - centre));
            close(after.axes.x_axis, turn * before.axes.x_axis);
            assert!(desk.off_aim() < 1e-12);
        }
    }
}

#[test]
fn a_camera_in_analysis_goes_away_and_comes_near_but_never_past_the_centre() {
    let mut desk = Desk::new(Subject::Camera, Transformation::Translation);
    desk.analyse();
    let distance = |desk: &Desk| desk.pose().eye.distance(desk.object().centre(0.0));
    let start = distance(&desk);
    desk.press(Axis::Z, Sign::Positive);
    assert!((distance(&desk) - start - 10.0).abs() < 1e-9);
    while let Ok(command) = desk.step(Axis::Z, Sign::Negative) {
        let side = desk.pose().axes.z_axis;
        desk.perform(Ok(command));
        close(desk.pose().axes.z_axis, side);
    }
    assert!((distance(&desk) - 1.0).abs() < 1e-9, "as near as the near plane");
    assert_eq!(desk.step(Axis::Z, Sign::Negative).unwrap_err(), Refusal::Nearest);

    desk.view.transformation = Transformation::Rotation;
    let before = desk.pose();
    desk.press(Axis::Z, Sign::Positive);
    close(desk.pose().eye, before.eye);
    close(desk.pose().axes.x_axis, before.axes * turned(Axis::Z, 10.0) * DVec3::X);
}

#[test]
fn moving_the_object_aims_the_camera_in_analysis_again_and_pushes_nothing_on_it() {
    let mut desk = Desk::new(Subject::Camera, Transformation::Translation);
    desk.analyse();
    desk.view.transformation = Transformation::Rotation;
    desk.press(Axis::Z, Sign::Positive);
    let rolled = desk.pose();
    desk.view.subject = Subject::Object;
    desk.view.transformation = Transformation::Translation;
    let before = desk.scene.clone();
    let back = desk.perform(desk.step(Axis::Y, Sign::Positive));
    assert!(desk.off_aim() < 1e-12);
    assert!(desk.pose().axes.x_axis.dot(rolled.axes.x_axis) > 0.999, "the roll stays");
    assert_eq!((desk.camera_depth(), desk.object().placement.depth()), (2, 1));
    back.apply(&mut desk.scene).unwrap();
    assert_eq!(desk.scene, before, "one command took both back");
}

#[test]
fn a_camera_that_was_left_in_analysis_at_another_object_is_in_fly() {
    let mut desk = Desk::new(Subject::Camera, Transformation::Translation);
    desk.analyse();
    let camera = items::duplicate(&desk.scene, ItemId::Camera(desk.view.camera), DVec3::ZERO);
    desk.perform(camera);
    assert_eq!(desk.mode(), CameraMode::Analysis { target: ObjectId(3) }, "a copy is a copy");
    desk.choose(selection::select(&desk.scene, &desk.view, ItemId::Object(ObjectId(2))));
    assert!(desk.off_aim() < 1e-12, "the selected camera looks at the selected object");
    let first = desk.scene.cameras.iter().next().unwrap().1.pose.now().mode_with(desk.view.object);
    assert_eq!(first, CameraMode::Fly);
}

#[test]
fn a_camera_that_fell_back_to_fly_stays_there_when_its_target_is_selected_again() {
    let mut desk = Desk::new(Subject::Camera, Transformation::Translation);
    desk.analyse();
    let target = desk.view.object.map(ItemId::Object).unwrap();
    desk.choose(selection::select(&desk.scene, &desk.view, ItemId::Object(ObjectId(2))));
    // The key u restores the camera that looked at the first object, which is not selected now.
    let back = transform::take_back(&desk.scene, &desk.view);
    desk.perform(back);
    assert_eq!(desk.mode(), CameraMode::Fly);
    desk.choose(selection::select(&desk.scene, &desk.view, target));
    assert_eq!(desk.mode(), CameraMode::Fly, "nothing has aimed it");
}

#[test]
fn walking_back_past_the_look_at_returns_to_fly() {
    let mut desk = Desk::new(Subject::Camera, Transformation::Translation);
    desk.press(Axis::X, Sign::Positive);
    let flown = desk.pose();
    desk.analyse();
    desk.press(Axis::X, Sign::Positive);
    desk.choose(selection::select(&desk.scene, &desk.view, ItemId::Object(ObjectId(1))));
    assert_eq!(desk.camera_depth(), 4, "selecting in analysis pushes a look-at");
    desk.take_back();
    assert_eq!(desk.mode(), CameraMode::Fly, "the target is not the selected object");
    desk.take_back();
    desk.take_back();
    assert_eq!(desk.pose(), flown);
}

#[test]
fn cameras_are_never_scaled_and_only_objects_can_be() {
    let mut desk = Desk::new(Subject::Camera, Transformation::Scaling);
    for axis in Axis::ALL {
        assert_eq!(desk.step(axis, Sign::Positive).unwrap_err(), Refusal::CameraScaled);
    }
    desk.view.transformation = Transformation::Translation;
    let refusal = selection::set_transformation(&mut desk.view, Transformation::Scaling);
    assert_eq!(refusal.unwrap_err(), Refusal::OnlyObjectsScale);
    assert_eq!(desk.view.transformation, Transformation::Translation);
}

#[test]
fn a_scale_that_would_flatten_the_object_is_refused() {
    let desk = Desk::new(Subject::Object, Transformation::Scaling);
    let stretch = |factors| {
        transform::stretch(&desk.scene, &desk.view, factors, GesturePhase::First).map(drop)
    };
    assert_eq!(stretch(DVec3::new(1.0, 0.0, 1.0)), Err(Refusal::Flat));
    assert_eq!(stretch(DVec3::ZERO), Err(Refusal::Flat));
    assert_eq!(stretch(DVec3::splat(f64::NAN)), Err(Refusal::TooLarge));
    assert_eq!(stretch(DVec3::splat(f64::INFINITY)), Err(Refusal::TooLarge));
    assert_eq!(stretch(DVec3::new(-1.0, 1.0, 1.0)), Ok(()), "a mirrored object is one");
}

#[test]
fn the_sun_only_turns_and_the_bulb_only_moves_whatever_is_chosen() {
    for kind in [Transformation::Translation, Transformation::Rotation, Transformation::Scaling] {
        let mut desk = Desk::new(Subject::Light, kind);
        desk.press(Axis::X, Sign::Positive);
        close(desk.light().1, turned(Axis::X, 10.0) * DVec3::NEG_Y);
        desk.press(Axis::Z, Sign::Negative);
        close(desk.light().1, turned(Axis::Z, -10.0) * turned(Axis::X, 10.0) * DVec3::NEG_Y);
        desk.view.light = Some(LightId(6));
        desk.press(Axis::X, Sign::Negative);
        close(desk.light().0, DVec3::new(-10.0, 0.0, -200.0));
    }
}

#[test]
fn ambient_light_and_spots_with_an_owner_stay_and_say_why() {
    let mut desk = Desk::new(Subject::Light, Transformation::Translation);
    let reasons = [
        (4, Refusal::Ambient),
        (7, Refusal::SpotFollows("object")),
        (8, Refusal::SpotFollows("camera")),
    ];
    for (id, reason) in reasons {
        desk.view.light = Some(LightId(id));
        assert_eq!(desk.step(Axis::X, Sign::Positive), Err(reason.clone()));
        assert_eq!(transform::take_back(&desk.scene, &desk.view), Err(reason));
    }
    desk.view.light = None;
    assert_eq!(desk.step(Axis::X, Sign::Positive), Err(Refusal::NoLight));
}

#[test]
fn an_unattached_spot_moves_and_turns() {
    let mut desk = Desk::new(Subject::Light, Transformation::Translation);
    desk.perform(items::insert_light(&desk.scene, lights::spot(lights::fixed())));
    desk.press(Axis::Y, Sign::Positive);
    close(desk.light().0, DVec3::Y * 10.0);
    desk.view.transformation = Transformation::Rotation;
    desk.press(Axis::Y, Sign::Positive);
    close(desk.light().0, DVec3::Y * 10.0);
    close(desk.light().1, turned(Axis::Y, 10.0) * DVec3::NEG_Z);
    desk.take_back();
    desk.take_back();
    assert_eq!(desk.light(), (DVec3::ZERO, DVec3::NEG_Z));
}

#[test]
fn by_size_a_step_is_a_rounded_hundredth_of_the_scenes_extent() {
    for frame in [Frame::Local, Frame::Global] {
        let mut desk = Desk::new(Subject::Object, Transformation::Scaling);
        desk.view.frame = frame;
        desk.view.steps.by_size = true;
        desk.press(Axis::X, Sign::Positive);
        desk.view.transformation = Transformation::Translation;
        let before = desk.placement();
        desk.press(Axis::X, Sign::Positive);
        // The scene reaches from -404 to 4.8 along Z, so a step by size is 5, in every frame.
        let moved = (desk.placement().w_axis - before.w_axis).truncate();
        close(moved, DVec3::X * 5.0);
    }
}

#[test]
fn u_takes_a_whole_drag_back_and_says_when_there_is_nothing_more() {
    let mut desk = Desk::new(Subject::Object, Transformation::Translation);
    let start = desk.placement();
    for phase in [GesturePhase::First, GesturePhase::Continued, GesturePhase::Continued] {
        let (scene, view) = (&desk.scene, &desk.view);
        desk.perform(transform::translate(scene, view, DVec3::X, phase));
    }
    close_matrix(desk.placement(), DMat4::from_translation(DVec3::X * 3.0) * start);
    desk.take_back();
    assert_eq!(desk.placement(), start);
    let refusal = transform::take_back(&desk.scene, &desk.view).unwrap_err();
    assert_eq!(refusal, Refusal::NothingToTakeBack);
    assert_eq!(refusal.to_string(), "there is no transformation to undo");
}

#[test]
fn without_objects_analysis_says_why() {
    let mut desk = Desk::new(Subject::Camera, Transformation::Translation);
    for id in [1, 2, 3] {
        desk.perform(items::remove(&desk.scene, ItemId::Object(ObjectId(id))));
    }
    let refusal = transform::toggle_analysis(&desk.scene, &desk.view).unwrap_err();
    assert_eq!(refusal, Refusal::NoObject);
    desk.view.subject = Subject::Object;
    assert_eq!(desk.step(Axis::X, Sign::Positive), Err(Refusal::NoObject));
    let spot = desk.scene.lights.get(LightId(7)).unwrap();
    assert!(matches!(spot.kind, LightKind::Spot { owner: SpotOwner::SelectedObject, .. }));
}
