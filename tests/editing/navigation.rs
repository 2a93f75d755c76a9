//! Navigation: the mouse moves the camera.

use glam::{DVec2, DVec3};
use marraztu_core::base::image::Size;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::navigation::{self, Pointer};
use marraztu_core::edit::{GesturePhase, Refusal};
use marraztu_core::scene::{
    CameraMode, Command, Item, Lens, Observer, Projection, Subject, Transformation,
};

use super::desk::{Desk, close, turned};

const SIZE: Size = Size::new(640, 480);

fn desk() -> Desk {
    Desk::new(Subject::Camera, Transformation::Translation)
}

/// Projects a world position into the picture, in pixels from the upper left.
fn pixel(desk: &Desk, point: DVec3) -> DVec2 {
    let lens = desk.scene.selected_camera(&desk.view).lens;
    let view_from_world = desk.pose().world_from_camera().inverse();
    let clip =
        lens.clip_from_view(desk.view.projection, SIZE) * view_from_world * point.extend(1.0);
    DVec2::new((clip.x / clip.w + 1.0) * 320.0, (1.0 - clip.y / clip.w) * 240.0)
}

#[test]
fn looking_yaws_about_the_worlds_y_and_pitches_about_the_cameras_x() {
    let mut desk = desk();
    let angle = |degrees: f64| degrees.to_radians();
    for (yaw, pitch) in [(0.0, 30.0), (40.0, 0.0)] {
        let (scene, view) = (&desk.scene, &desk.view);
        desk.perform(navigation::look(scene, view, angle(yaw), angle(pitch), GesturePhase::First));
    }
    let expected = turned(Axis::Y, 40.0) * turned(Axis::X, 30.0);
    close(desk.pose().axes.z_axis, expected.z_axis);
    close(desk.pose().axes.x_axis, expected.x_axis);
    assert_eq!(desk.pose().eye, DVec3::Z * 400.0);
}

#[test]
fn an_orbit_keeps_its_centre_at_the_same_pixel_and_distance() {
    for analysis in [false, true] {
        let mut desk = desk();
        if analysis {
            desk.analyse();
        }
        let centre = desk.object().centre(0.0);
        let (before, distance) = (pixel(&desk, centre), desk.pose().eye.distance(centre));
        desk.perform(navigation::orbit(&desk.scene, &desk.view, 0.7, -0.4, GesturePhase::First));
        assert!((pixel(&desk, centre) - before).length() < 1e-9);
        assert!((desk.pose().eye.distance(centre) - distance).abs() < 1e-9);
        assert_eq!(desk.mode() == CameraMode::Fly, !analysis);
    }
}

/// A desk for each projection, with a centred lens and with one that is shifted and has wide
/// pixels.
fn desks() -> Vec<Desk> {
    let mut desks = Vec::new();
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for (shift, pixel_aspect) in [([0.0; 2], 1.0), ([0.3, -0.4], 1.5)] {
            let mut desk = desk();
            desk.view.projection = projection;
            let mut camera = desk.scene.selected_camera(&desk.view).clone();
            camera.lens = Lens { shift, pixel_aspect, ..camera.lens };
            let camera = Item::Camera(desk.view.camera, Box::new(camera));
            desk.perform(Ok(Command::Replace(camera)));
            desks.push(desk);
        }
    }
    desks
}

#[test]
fn in_parallel_and_in_perspective_a_pan_takes_the_object_along_with_the_pointer() {
    for mut desk in desks() {
        desk.analyse();
        let projection = desk.view.projection;
        let centre = desk.object().centre(0.0);
        let (before, by) = (pixel(&desk, centre), DVec2::new(30.0, -20.0));
        desk.perform(navigation::pan(&desk.scene, &desk.view, by, SIZE, GesturePhase::First));
        assert!((pixel(&desk, centre) - before - by).length() < 1e-9, "{projection:?}");
        assert_eq!(desk.mode(), CameraMode::Fly);
    }
}

#[test]
fn the_wheel_keeps_the_point_under_the_pointer_fixed() {
    for mut desk in desks() {
        let projection = desk.view.projection;
        let point = DVec3::new(-60.0, 40.0, 100.0);
        let at = pixel(&desk, point);
        let pointer = Pointer { at, depth: Some(300.0) };
        let zoom =
            navigation::zoom(&desk.scene, &desk.view, 3.0, pointer, SIZE, GesturePhase::First);
        desk.perform(zoom);
        assert!((pixel(&desk, point) - at).length() < 1e-9, "{projection:?}");
        if projection == Projection::Perspective {
            let depth = (desk.pose().eye - point).dot(desk.pose().axes.z_axis);
            assert!((depth - 300.0 * 0.9 * 0.9 * 0.9).abs() < 1e-9);
        } else {
            let lens = desk.scene.selected_camera(&desk.view).lens;
            assert!((lens.half_size - 500.0 * 0.729).abs() < 1e-9);
        }
    }
}

#[test]
fn the_wheel_in_analysis_keeps_to_the_axis_and_stops_at_the_near_plane() {
    let mut desk = desk();
    desk.analyse();
    let pointer = Pointer { at: DVec2::new(10.0, 10.0), depth: None };
    let centre = desk.object().centre(0.0);
    let mut refusal = None;
    for _ in 0..100 {
        match navigation::zoom(&desk.scene, &desk.view, 1.0, pointer, SIZE, GesturePhase::First) {
            Ok(command) => drop(desk.perform(Ok(command))),
            Err(error) => refusal = Some(error),
        }
        assert!(desk.off_aim() < 1e-9);
        assert!(desk.pose().eye.distance(centre) > 1.0 - 1e-9);
    }
    assert_eq!(refusal, Some(Refusal::Nearest));
    assert_ne!(desk.mode(), CameraMode::Fly);
}

#[test]
fn the_wheel_zooms_through_the_target_without_stopping() {
    let mut desk = desk();
    let pointer = Pointer { at: DVec2::new(320.0, 240.0), depth: None };
    for _ in 0..300 {
        let zoom =
            navigation::zoom(&desk.scene, &desk.view, 1.0, pointer, SIZE, GesturePhase::First);
        desk.perform(zoom);
    }
    assert!(desk.pose().eye.z < 0.0, "{}", desk.pose().eye);
}

#[test]
fn while_an_object_looks_the_mouse_moves_nothing_and_says_why() {
    let mut desk = desk();
    desk.view.observer = Observer::Object;
    let (scene, view) = (&desk.scene, &desk.view);
    let pointer = Pointer { at: DVec2::ZERO, depth: None };
    let all = [
        navigation::look(scene, view, 0.1, 0.1, GesturePhase::First),
        navigation::orbit(scene, view, 0.1, 0.1, GesturePhase::First),
        navigation::pan(scene, view, DVec2::ONE, SIZE, GesturePhase::First),
        navigation::fly(scene, view, DVec3::ONE, GesturePhase::First),
        navigation::zoom(scene, view, 1.0, pointer, SIZE, GesturePhase::First),
    ];
    for result in all {
        assert_eq!(result, Err(Refusal::ObjectLooks));
    }
}
