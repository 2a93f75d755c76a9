//! The sizes of steps for the keys x, y and z.
//!
//! By size, a step is a hundredth of the scene's extent, rounded to 1, 2 or 5 times a power of 10.
//! It then has few digits and stays the same while objects are moved about.

use glam::DVec3;

use crate::scene::{Object, Scene, Shape, Steps, View};

/// The number of steps across the extent of the scene, before rounding.
const STEPS_ACROSS: f64 = 100.0;

/// Returns the length of a step of translation, in units of the world.
pub fn length(scene: &Scene, view: &View) -> f64 {
    let by_size = || rounded(extent(scene) / STEPS_ACROSS);
    view.steps.by_size.then(by_size).flatten().unwrap_or(view.steps.translation)
}

/// Returns the extent of a scene: the largest extent of a single object, or the largest side of the
/// box around several. 0 for an empty scene.
///
/// Each object counts as a cube as wide as its largest extent, so turning it does not change the
/// extent of the scene, nor does moving a single object. Ground and plane shapes do not count if
/// there are other objects, because they are larger than the objects on them.
pub fn extent(scene: &Scene) -> f64 {
    extent_without_grounds(scene).or_else(|| extent_of(scene, |_| true)).unwrap_or(0.0)
}

/// Returns the extent of the objects that are not ground or plane shapes; `None` without any.
pub(super) fn extent_without_grounds(scene: &Scene) -> Option<f64> {
    extent_of(scene, |object| !is_ground(object))
}

/// Returns the extent of some objects; `None` without any.
fn extent_of(scene: &Scene, counts: impl Fn(&Object) -> bool) -> Option<f64> {
    let cube = |object: &Object| {
        let mesh = &object.model.mesh;
        let middle = mesh.bounds()?.centre() + mesh.offset();
        let half = DVec3::splat(object.largest_extent() / 2.0);
        let centre = object.placement.now().transform_point3(middle);
        Some((centre - half, centre + half))
    };
    let objects = scene.objects.iter().map(|(_, object)| object);
    let cubes = objects.filter(|object| counts(object)).filter_map(cube);
    let around = cubes.reduce(|(min, max), (low, high)| (min.min(low), max.max(high)));
    around.map(|(min, max)| (max - min).max_element())
}

/// Returns the spacing of the lines of the ground grid. Ten of them are about as long as the scene.
pub fn of_grid(scene: &Scene) -> f64 {
    rounded(extent(scene) / 10.0).unwrap_or(Steps::DEFAULT.translation)
}

/// Returns whether an object is a ground or plane shape.
pub(super) fn is_ground(object: &Object) -> bool {
    Shape::of(&object.model).is_some_and(Shape::is_ground)
}

/// Rounds to 1, 2 or 5 times a power of 10, the nearest by ratio; `None` if `length` is not
/// positive and finite.
pub(super) fn rounded(length: f64) -> Option<f64> {
    if !(length.is_finite() && length > 0.0) {
        return None;
    }
    let power = libm::floor(libm::log10(length));
    let candidates = [(1, 0.0), (2, 0.0), (5, 0.0), (1, 1.0)];
    let steps = candidates.map(|(digit, more)| decimal(digit, power + more));
    let ratio = |step: f64| libm::fabs(libm::log(step / length));
    steps.into_iter().filter(|step| *step > 0.0).min_by(|a, b| ratio(*a).total_cmp(&ratio(*b)))
}

/// Returns the number nearest to `digit` times a power of 10, as if it were parsed from text.
#[expect(clippy::cast_possible_truncation, reason = "the exponent of a double has three digits")]
fn decimal(digit: u8, power: f64) -> f64 {
    format!("{digit}e{}", power as i32).parse().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_rounded_to_the_nearest_of_1_2_and_5_by_ratio() {
        for (length, step) in [
            (1.0, 1.0),
            (1.4, 1.0),
            (1.42, 2.0),
            (3.1, 2.0),
            (3.2, 5.0),
            (7.0, 5.0),
            (7.1, 10.0),
            (0.0173, 0.02),
            (1e-9, 1e-9),
            (4.4e12, 5e12),
        ] {
            assert_eq!(rounded(length), Some(step), "{length}");
        }
        for none in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(rounded(none), None, "{none}");
        }
    }
}
