//! The bounding spheres of a scene's objects in the world, in packed arrays. With thousands of
//! objects, frustum culling reads these arrays and not the objects.

use glam::{DMat3, DVec3};

use super::{Object, ObjectId, Objects};

/// A bounding sphere for each object.
#[derive(Debug, Default)]
pub struct Spheres {
    /// The centres, as x, y and z. All arrays are sorted by the objects' ids.
    pub centres: [Vec<f64>; 3],
    /// The radii; infinite for objects that turn over time.
    pub radii: Vec<f64>,
    /// The indices of the objects in the list.
    pub places: Vec<u32>,
}

/// Rounds radii up by more than the rounding error of the placement.
const ROUNDING: f64 = 1.0 + 1e-9;

impl Objects {
    /// Returns a bounding sphere for each object. The result is kept until an object changes.
    pub fn spheres(&self) -> &Spheres {
        self.derived(Spheres::of)
    }
}

impl Spheres {
    fn of(objects: &Objects) -> Self {
        let mut sorted: Vec<(ObjectId, u32, &Object)> =
            (0..).zip(objects.iter()).map(|(at, (id, object))| (id, at, object)).collect();
        sorted.sort_unstable_by_key(|(id, ..)| *id);
        let mut all = Self::default();
        for (_, at, object) in sorted {
            let (centre, radius) = sphere(object);
            for (of, value) in all.centres.iter_mut().zip(centre.to_array()) {
                of.push(value);
            }
            all.radii.push(radius);
            all.places.push(at);
        }
        all
    }
}

/// Bounds an object's placed box by a sphere. The Frobenius norm is an upper bound on the largest
/// stretch of the placement.
fn sphere(object: &Object) -> (DVec3, f64) {
    let Some(bounds) = object.model.mesh.bounds() else { return (DVec3::ZERO, f64::INFINITY) };
    let placement = object.placement.now();
    let stretch = DMat3::from_mat4(*placement).to_cols_array();
    let stretch = stretch.iter().map(|x| x * x).sum::<f64>().sqrt();
    let radius = bounds.extent().length() * 0.5 * stretch * ROUNDING;
    let still = !object.spin.is_on();
    let radius = if still && radius.is_finite() { radius } else { f64::INFINITY };
    (placement.transform_point3(bounds.centre() + object.model.mesh.offset()), radius)
}
