//! Drags of handles, in small and large scenes, near the origin and far from it.

use super::*;
use crate::app::viewport::gizmo::Shape;
use egui::vec2;
use glam::{DMat3, DMat4};
use marraztu_core::edit::placement;
use marraztu_core::scene::Frame;

fn scene(offset: DVec3, size: f64) -> State {
    let (scene, view) = marraztu_io::default_scene();
    let mut state = State::new(scene, view);
    state.view.subject = marraztu_core::scene::Subject::Object;
    let id = state.view.object.unwrap();
    let m = DMat4::from_translation(offset) * DMat4::from_scale(DVec3::splat(size));
    let command = placement::object(&state.scene, &state.view, id, m, GesturePhase::First);
    command.unwrap().apply(&mut state.scene).unwrap();
    let turn = math::rotation(DVec3::Y, 0.4) * math::rotation(DVec3::X, -0.3);
    let eye = offset + turn * DVec3::new(20.0, 5.0, 300.0) * size;
    let camera = state.view.camera;
    let command = placement::camera(&state.scene, camera, eye, turn, GesturePhase::First);
    command.unwrap().apply(&mut state.scene).unwrap();
    state
}

fn placed(state: &State) -> DMat4 {
    *state.scene.objects.get(state.view.object.unwrap()).unwrap().placement.now()
}

fn gizmo(state: &State) -> Gizmo {
    let rect = Rect::from_min_size(Pos2::ZERO, vec2(800.0, 600.0));
    Gizmo::new(state, rect, Size::new(800, 600)).unwrap()
}

fn end(gizmo: &Gizmo, handle: Handle) -> Pos2 {
    let part = gizmo.parts.iter().find(|part| part.handle == handle).unwrap();
    match &part.shape {
        Shape::Line([_, to]) => *to,
        Shape::Square(corners) => corners[0] + (corners[2] - corners[0]) * 0.5,
        Shape::Ring { near, .. } => near[near.len() / 3],
        Shape::Circle(middle, radius) => *middle + vec2(*radius, 0.0),
        Shape::Disk(middle) => *middle,
    }
}

/// Drags a handle and applies the last request.
fn drag(state: &mut State, handle: Handle, by: Vec2, typed: &str) -> Option<Amount> {
    let gizmo = gizmo(state);
    let from = end(&gizmo, handle);
    assert_eq!(gizmo.handle_at(from), Some(handle));
    let mut grab = Grab::new(state, &gizmo, handle, from);
    let mut requests = Vec::new();
    // The drag takes a detour, which must not matter.
    let pull = |to, typed| Pull { to, snap: false, typed };
    grab.follow(&state.scene, pull(from + vec2(7.0, 31.0), ""), Gesture::Part(1), &mut requests);
    grab.follow(&state.scene, pull(from + by, typed), Gesture::Part(1), &mut requests);
    let Some(Request::Change { command, .. }) = requests.pop() else { return None };
    command.apply(&mut state.scene).unwrap();
    grab.asked
}

#[test]
fn a_drag_along_an_axis_stays_under_the_pointer_at_every_size_and_distance() {
    for (offset, size) in [(0.0, 1.0), (1e5, 1.0), (1e5, 1e-3), (-3e5, 1e3), (0.0, 1e-6)] {
        for axis in Axis::ALL {
            let mut state = scene(DVec3::splat(offset), size);
            let before = gizmo(&state);
            let from = end(&before, Handle::Axis(axis));
            let middle = |g: &Gizmo| g.sight.place(g.sight.in_view(g.pivot.origin)).unwrap();
            let way = from - middle(&before);
            drag(&mut state, Handle::Axis(axis), way * 0.4, "").unwrap();
            let after = gizmo(&state);
            let moved = middle(&after) - middle(&before);
            // The end of the handle was dragged, so the middle moves as far, except for
            // perspective.
            assert!((moved - way * 0.4).length() < 8.0, "{axis:?} {offset} {size}: {moved:?}");
            let delta = placed(&state).w_axis.truncate() - DVec3::splat(offset);
            let off = delta - axis.unit() * delta[axis.index()];
            assert!(off.length() <= offset.abs() * 1e-15, "{axis:?}: {delta}");
        }
    }
}

#[test]
fn a_typed_number_is_exact_whatever_the_pointer_does() {
    let typed = |kind, handle, text: &str| {
        let mut state = scene(DVec3::ZERO, 1.0);
        state.view.transformation = kind;
        drag(&mut state, handle, vec2(13.0, 5.0), text)
    };
    let moving = Transformation::Translation;
    let x = Handle::Axis(Axis::X);
    assert_eq!(typed(moving, x, "12"), Some(Amount::Move(DVec3::X * 12.0)));
    assert_eq!(typed(moving, x, "y-12\u{8}3"), Some(Amount::Move(DVec3::Y * -13.0)));
    assert_eq!(
        typed(moving, Handle::Plane(Axis::Z), "360/8"),
        Some(Amount::Move(DVec3::new(45.0, 45.0, 0.0)))
    );
    let turning = Transformation::Rotation;
    assert_eq!(
        typed(turning, Handle::Ring(Axis::Y), "90"),
        Some(Amount::Turn(DVec3::Y, 90.0_f64.to_radians()))
    );
    let scaling = Transformation::Scaling;
    assert_eq!(typed(scaling, Handle::Middle, "2"), Some(Amount::Scale(DVec3::splat(2.0))));
    assert_eq!(typed(scaling, x, "z3"), Some(Amount::Scale(DVec3::new(1.0, 1.0, 3.0))));
}

#[test]
fn a_scale_of_0_is_refused_and_a_negative_one_mirrors() {
    let mut state = scene(DVec3::ZERO, 1.0);
    state.view.transformation = Transformation::Scaling;
    assert_eq!(drag(&mut state, Handle::Axis(Axis::X), vec2(3.0, 0.0), "0"), None);
    drag(&mut state, Handle::Axis(Axis::X), vec2(3.0, 0.0), "-1").unwrap();
    assert_eq!(placed(&state).x_axis.x, -1.0);
}

#[test]
fn in_the_global_frame_rotation_and_scaling_pivot_on_the_origin() {
    let at = DVec3::new(5.0, 6.0, 7.0);
    for (frame, kind, origin) in [
        (Frame::Local, Transformation::Rotation, at),
        (Frame::Global, Transformation::Translation, at),
        (Frame::Global, Transformation::Rotation, DVec3::ZERO),
        (Frame::Global, Transformation::Scaling, DVec3::ZERO),
    ] {
        let mut state = scene(at, 3.0);
        (state.view.frame, state.view.transformation) = (frame, kind);
        let pivot = gizmo::pivot(&state.scene, &state.view).unwrap();
        assert_eq!((pivot.origin, pivot.axes), (origin, DMat3::IDENTITY), "{frame:?} {kind:?}");
    }
}

#[test]
fn amounts_snap_to_whole_steps_and_a_mirror_keeps_its_sign() {
    let state = scene(DVec3::ZERO, 1.0);
    let snap = |amount| gizmo::snapped(&state.scene, &state.view, amount);
    let delta = DVec3::new(14.9, -5.1, 0.0);
    assert_eq!(snap(Amount::Move(delta)), Amount::Move(DVec3::new(10.0, -10.0, 0.0)));
    let Amount::Turn(_, radians) = snap(Amount::Turn(DVec3::X, 0.5)) else { panic!() };
    assert!((radians.to_degrees() - 30.0).abs() < 1e-12);
    let Amount::Scale(factors) = snap(Amount::Scale(DVec3::new(-1.4, 1.0, 0.0))) else { panic!() };
    assert!((factors - DVec3::new(-1.44, 1.0, 0.0)).length() < 1e-12);
}

#[test]
fn a_ring_dragged_once_around_comes_back_and_a_half_turn_is_one() {
    let mut state = scene(DVec3::ZERO, 1.0);
    state.view.transformation = Transformation::Rotation;
    let gizmo = gizmo(&state);
    let middle = gizmo.sight.place(gizmo.sight.in_view(gizmo.pivot.origin)).unwrap();
    let from = end(&gizmo, Handle::Outer);
    let mut grab = Grab::new(&state, &gizmo, Handle::Outer, from);
    let mut turned = Vec::new();
    for i in 1..=16_u8 {
        let angle = f32::from(i) / 8.0 * std::f32::consts::PI;
        let to = middle + vec2(angle.cos(), -angle.sin()) * 120.0;
        let Some(Amount::Turn(_, radians)) = grab.of_pointer(to) else { panic!() };
        turned.push(radians.to_degrees());
    }
    assert!((turned[7] - 180.0).abs() < 0.5, "{turned:?}");
    assert!((turned[15] - 360.0).abs() < 0.5, "{turned:?}");
}

#[test]
fn every_letter_is_a_part_of_the_handle_of_its_axis() {
    for kind in [Transformation::Translation, Transformation::Rotation, Transformation::Scaling] {
        let mut state = scene(DVec3::ZERO, 1.0);
        state.view.transformation = kind;
        let gizmo = gizmo(&state);
        let letters =
            gizmo.parts.iter().filter_map(|part| Some((part.handle, part.shape.letter()?)));
        let letters: Vec<(Handle, Pos2)> = letters.collect();
        assert_eq!(letters.len(), 3, "{kind:?}");
        for (handle, at) in letters {
            for aside in [vec2(0.0, 0.0), vec2(7.0, 0.0), vec2(-4.0, 5.0), vec2(0.0, -7.0)] {
                assert_eq!(gizmo.handle_at(at + aside), Some(handle), "{kind:?} {aside:?}");
            }
        }
    }
}

#[test]
fn a_scaled_object_stays_under_the_pointer_and_moves_by_the_typed_number() {
    for size in [1e-3, 40.0, 2400.0] {
        let mut state = scene(DVec3::ZERO, size);
        let amount = drag(&mut state, Handle::Axis(Axis::X), vec2(30.0, 0.0), "60");
        assert_eq!(amount, Some(Amount::Move(DVec3::X * 60.0)));
        assert_eq!(placed(&state).w_axis.x, 60.0);
        let mut state = scene(DVec3::ZERO, size);
        let Some(Amount::Move(by)) = drag(&mut state, Handle::Middle, vec2(30.0, 0.0), "") else {
            panic!()
        };
        let moved = placed(&state).w_axis.truncate();
        assert!((moved.length() - by.length()).abs() < 1e-9 * by.length(), "{by} moves {moved}");
    }
}
