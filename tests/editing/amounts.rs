//! Amounts of drags and typed numbers count in units of the world; keys count in the object's
//! units.
//!
//! Catches: a move of 60 that moves by 2,400, a turn that shears a stretched object, a mirrored
//! object that turns the other way than by the keys.

use glam::{DMat3, DMat4, DVec3};
use marraztu_core::base::math::{self, Axis};
use marraztu_core::edit::gizmo::{self, Amount};
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{GesturePhase, placement};
use marraztu_core::scene::{Frame, Subject, Transformation};

use super::desk::{Desk, close};

const FIRST: GesturePhase = GesturePhase::First;

/// The placements of an object that is scaled, stretched, mirrored, sheared, tiny or huge.
fn placements() -> Vec<DMat4> {
    let turn = math::rotation(DVec3::new(1.0, 2.0, 3.0).normalize_or_zero(), 1.1);
    let linear = [
        DMat3::from_diagonal(DVec3::splat(40.0)),
        turn * DMat3::from_diagonal(DVec3::new(2.0, 30.0, 0.5)),
        turn * DMat3::from_diagonal(DVec3::new(-3.0, 3.0, 3.0)),
        turn * DMat3::from_cols(DVec3::X, DVec3::new(0.5, 1.0, 0.0), DVec3::Z * 7.0),
        DMat3::from_diagonal(DVec3::splat(1e-6)),
        DMat3::from_diagonal(DVec3::splat(1e9)),
    ];
    linear.map(|linear| math::placed(linear, DVec3::new(10.0, -20.0, 30.0))).to_vec()
}

fn desk(m: DMat4, kind: Transformation) -> Desk {
    let mut desk = Desk::new(Subject::Object, kind);
    desk.view.frame = Frame::Local;
    let id = desk.view.object.unwrap();
    desk.perform(placement::object(&desk.scene, &desk.view, id, m, FIRST));
    desk
}

fn placed(desk: &Desk) -> DMat4 {
    *desk.object().placement.now()
}

#[test]
fn a_move_of_60_moves_by_60_along_the_objects_axis_whatever_its_scale() {
    for m in placements() {
        for axis in Axis::ALL {
            let mut desk = desk(m, Transformation::Translation);
            let amount = Amount::Move(axis.unit() * 60.0);
            desk.perform(gizmo::transform(&desk.scene, &desk.view, amount, FIRST));
            let way = (placed(&desk).w_axis - m.w_axis).truncate();
            let along = m.transform_vector3(axis.unit()).normalize_or_zero();
            close(way, along * 60.0);
            assert_eq!(DMat3::from_mat4(placed(&desk)), DMat3::from_mat4(m));
        }
    }
}

#[test]
fn a_key_still_moves_by_its_step_in_the_units_of_the_object() {
    for m in placements() {
        for axis in Axis::ALL {
            let mut desk = desk(m, Transformation::Translation);
            desk.press(axis, Sign::Positive);
            let expected = m * DMat4::from_translation(axis.unit() * 10.0);
            assert_eq!(placed(&desk), expected, "M := M T");
        }
    }
}

#[test]
fn a_turn_is_rigid_about_the_objects_axis_and_runs_like_the_keys() {
    for m in placements() {
        for axis in Axis::ALL {
            let mut desk = desk(m, Transformation::Rotation);
            let amount = Amount::Turn(axis.unit(), 0.3);
            desk.perform(gizmo::transform(&desk.scene, &desk.view, amount, FIRST));
            let after = placed(&desk);
            assert_eq!(after.w_axis, m.w_axis);
            let [before, after] = [m, after].map(DMat3::from_mat4);
            // Lengths and angles between the columns stay.
            let [old, new] = [before, after].map(|l| l.transpose() * l);
            let size = old.to_cols_array().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!((old - new).to_cols_array().iter().all(|x| x.abs() < 1e-12 * size), "{m}");
            let along = before.col(axis.index());
            close(after.col(axis.index()) / along.length(), along / along.length());
            // Of a uniformly scaled object, the key's formula gives the same.
            let lengths = Axis::ALL.map(|axis| before.col(axis.index()).length());
            let is_even = lengths.iter().all(|length| (length / lengths[0] - 1.0).abs() < 1e-9);
            if is_even && (before.col(0).dot(before.col(1))).abs() < 1e-9 * size {
                let keys = before * math::rotation(axis.unit(), 0.3);
                let error = (after - keys).to_cols_array();
                assert!(error.iter().all(|x| x.abs() < 1e-12 * lengths[0]), "{m}");
            }
        }
    }
}

#[test]
fn moves_snap_to_steps_of_the_world() {
    let desk = desk(placements()[0], Transformation::Translation);
    let snapped = gizmo::snapped(&desk.scene, &desk.view, Amount::Move(DVec3::new(58.0, 0.0, 4.0)));
    assert_eq!(snapped, Amount::Move(DVec3::new(60.0, 0.0, 0.0)));
    let step = transform::distance(&desk.scene, &desk.view, Axis::X);
    assert_eq!(step, 10.0, "the key's step is in the object's units");
}
