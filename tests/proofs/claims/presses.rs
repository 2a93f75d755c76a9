//! The accuracy after a million key presses.
//!
//! Rotates an object about its own axes and the world's, and a camera about its own, both by the
//! commands of the keys and in double-double.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4, DVec3};

use super::double_double::Double;
use super::{Proof, Tally};
use marraztu_core::base::math::Axis;
use marraztu_core::base::rng::Rng;
use marraztu_core::edit::GesturePhase;
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::scene::{Frame, Scene, Subject, Transformation, View};
use marraztu_io as io;

pub(crate) const PROOF: Proof = Proof {
    name: "presses",
    claim: "after a million presses of the turning keys objects and cameras stand within 1e-9 \
            radians of where numbers of twice the digits have them, and moved objects within 1e-9 \
            of their way",
    unit: "presses",
    batch: PRESSES,
    quick: PRESSES,
    whole: PRESSES,
    shows: &[],
    regressions: &[],
    check,
};

const PRESSES: u64 = 1_000_000;

/// The largest error of an angle in radians, and of a translation relative to its length.
const BOUND: f64 = 1e-9;

type Turn = [[Double; 3]; 3];

fn check(batch: u64) -> Result<Tally, String> {
    let mut tally = Tally::default();
    let each = PRESSES / 4;
    for frame in [Frame::Local, Frame::Global] {
        let off = object_turned(&mut Rng::new(batch), frame, each);
        tally.error("object's angle", off.0);
        tally.error("object's skew", off.1);
    }
    let off = camera_turned(&mut Rng::new(batch), each);
    tally.error("camera's angle", off.0);
    tally.error("camera's skew", off.1);
    tally.error("object's way", object_moved(&mut Rng::new(batch), each));
    tally.count("presses", each * 4);
    let bounds = BTreeMap::from([("camera's skew", 1e-12)]);
    for (what, off) in &tally.worst {
        let bound = bounds.get(what).copied().unwrap_or(BOUND);
        if off.is_nan() || *off > bound {
            return Err(format!("{what} is off by {off:e}"));
        }
    }
    Ok(tally)
}

fn desk(subject: Subject, transformation: Transformation, frame: Frame) -> (Scene, View) {
    let (scene, view) = io::default_scene();
    (scene, View { subject, transformation, frame, ..view })
}

fn press(scene: &mut Scene, view: &View, (axis, sign): (Axis, Sign)) {
    let command = transform::step(scene, view, axis, sign, GesturePhase::Continued);
    command.expect("nothing is in the way").apply(scene).expect("the item is there");
}

fn key(rng: &mut Rng) -> (Axis, Sign) {
    (rng.one_of(&Axis::ALL), rng.one_of(&[Sign::Positive, Sign::Negative]))
}

/// The angle between an object and its exact rotation, and the largest entry of M'M - I.
fn object_turned(rng: &mut Rng, frame: Frame, presses: u64) -> (f64, f64) {
    let (mut scene, view) = desk(Subject::Object, Transformation::Rotation, frame);
    let id = view.object.expect("the first scene has objects");
    let mut exact = identity();
    for _ in 0..presses {
        let key = key(rng);
        press(&mut scene, &view, key);
        // Local rotations multiply from the right, global ones from the left.
        exact = match frame {
            Frame::Local => product(&exact, &step(key)),
            Frame::Global => product(&step(key), &exact),
        };
    }
    let object = scene.objects.get(id).expect("it was not taken out");
    compare(DMat3::from_mat4(*object.placement.now()), &exact)
}

/// The same for a camera: x rotates about its own Y, y about its own X, z about its own Z.
fn camera_turned(rng: &mut Rng, presses: u64) -> (f64, f64) {
    let (mut scene, view) = desk(Subject::Camera, Transformation::Rotation, Frame::Local);
    let mut exact = identity();
    for _ in 0..presses {
        let (axis, sign) = key(rng);
        press(&mut scene, &view, (axis, sign));
        let own = match axis {
            Axis::X => Axis::Y,
            Axis::Y => Axis::X,
            Axis::Z => Axis::Z,
        };
        exact = product(&exact, &step((own, sign)));
    }
    compare(scene.selected_camera(&view).pose.now().axes, &exact)
}

/// The distance of an object from its exact position, relative to the length of the path.
fn object_moved(rng: &mut Rng, presses: u64) -> f64 {
    let (mut scene, mut view) = desk(Subject::Object, Transformation::Translation, Frame::Global);
    view.steps.translation = 0.1;
    let id = view.object.expect("the first scene has objects");
    let place = |scene: &Scene| {
        let object = scene.objects.get(id).expect("it was not taken out");
        object.placement.now().w_axis.truncate()
    };
    let start: DVec3 = place(&scene);
    // The exact position follows from the net number of steps per axis.
    let mut steps = [0_i32; 3];
    for _ in 0..presses {
        let (axis, sign) = key(rng);
        press(&mut scene, &view, (axis, sign));
        steps[axis.index()] += if sign == Sign::Positive { 1 } else { -1 };
    }
    let off = |i: usize| {
        let way = Double::from(0.1) * Double::from(f64::from(steps[i]));
        (Double::from(place(&scene)[i]) - Double::from(start[i]) - way).abs().nearest()
    };
    #[expect(clippy::cast_precision_loss, reason = "a million")]
    let way = 0.1 * presses as f64;
    off(0).max(off(1)).max(off(2)) / way
}

/// The rotation of one press: ten degrees.
fn step((axis, sign): (Axis, Sign)) -> Turn {
    let angle = Double::PI / Double::from(18.0);
    let (s, c) = angle.sin_cos();
    let s = if sign == Sign::Positive { s } else { -s };
    let mut turn = identity();
    let (i, j) = ((axis.index() + 1) % 3, (axis.index() + 2) % 3);
    (turn[i][i], turn[j][j], turn[j][i], turn[i][j]) = (c, c, s, -s);
    turn
}

/// `m[row][column]`.
fn identity() -> Turn {
    let (one, zero) = (Double::ONE, Double::default());
    [[one, zero, zero], [zero, one, zero], [zero, zero, one]]
}

fn product(a: &Turn, b: &Turn) -> Turn {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
    })
}

/// The angle between two rotations, |R - S| = sqrt 8 sin(angle / 2), and the largest entry of
/// R'R - I.
fn compare(m: DMat3, exact: &Turn) -> (f64, f64) {
    let rows = DMat4::from_mat3(m).transpose().to_cols_array_2d();
    let squares: f64 = (0..9)
        .map(|i| (Double::from(rows[i / 3][i % 3]) - exact[i / 3][i % 3]).nearest().powi(2))
        .sum();
    let skew = (m.transpose() * m - DMat3::IDENTITY).to_cols_array();
    let skew = skew.into_iter().map(f64::abs).fold(0.0, f64::max);
    (2.0 * libm::asin((squares / 8.0).sqrt().min(1.0)), skew)
}
