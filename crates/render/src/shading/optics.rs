//! The directions of mirrored and refracted rays, and the fractions of light that they carry.
//!
//! I is the direction of a ray, N the interpolated normal of the surface that it meets and G the
//! normal of its face, both on the side that the ray comes from. N may lean away from a ray that
//! meets the edge of a round body; the new ray then would leave on the wrong side of the face, and
//! is turned back until it just leaves on the right one.

use glam::DVec3;

use marraztu_core::base::math::unit;
use marraztu_core::scene::Reflection;

/// The sine of the smallest angle between a new ray and the face that it leaves.
const LEAST: f64 = 1e-3;

/// A ray that meets a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// The direction of the ray: I, of length 1.
    pub(super) towards: DVec3,
    /// N, of length 1.
    pub(super) normal: DVec3,
    /// G, of length 1.
    pub(super) face: DVec3,
}

/// A refracted ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refracted {
    pub(super) towards: DVec3,
    /// The cosine of the angle between the ray and the normal.
    pub(super) cosine: f64,
}

impl Meeting {
    /// Returns the cosine of the angle of incidence.
    pub(super) fn cosine(&self) -> f64 {
        (-self.normal.dot(self.towards)).clamp(0.0, 1.0)
    }

    /// Returns the direction of the mirrored ray: I + 2 c N.
    pub(super) fn mirrored(&self) -> DVec3 {
        let Self { towards, normal, face } = *self;
        let way = towards + normal * (2.0 * self.cosine());
        let along = way.dot(face);
        let way = if along < LEAST { way + face * (LEAST - along) } else { way };
        unit(way).unwrap_or(face)
    }

    /// Returns the refracted ray, with the ratio `eta` of the indices of the media in front of the
    /// surface and behind it: eta I + (eta c - sqrt(1 - eta^2 (1 - c^2))) N. `None` for total
    /// reflection.
    pub(super) fn refracted(&self, eta: f64) -> Option<Refracted> {
        let Self { towards, normal, face } = *self;
        let cosine = self.cosine();
        let square = 1.0 - eta * eta * (1.0 - cosine * cosine);
        if square < 0.0 {
            return None;
        }
        let behind = square.sqrt();
        let way = towards * eta + normal * (eta * cosine - behind);
        let along = way.dot(face);
        let way = if along > -LEAST { way - face * (along + LEAST) } else { way };
        Some(Refracted { towards: unit(way).unwrap_or(-face), cosine: behind })
    }
}

/// Returns the reflectance of a surface with this Ks, channel by channel. `cosine` is that of the
/// angle in the medium of the lower index, and `indices` are those of the two media.
///
/// Schlick, "An Inexpensive BRDF Model for Physically-Based Rendering", 1994.
pub(super) fn reflectance(
    reflection: Reflection,
    specular: [f64; 3],
    cosine: f64,
    indices: [f64; 2],
) -> [f64; 3] {
    match reflection {
        Reflection::None => [0.0; 3],
        Reflection::Constant => specular.map(|ks| ks.clamp(0.0, 1.0)),
        Reflection::Fresnel => {
            let [from, to] = indices;
            let part = (from - to) / (from + to);
            let grazing = (1.0 - cosine).clamp(0.0, 1.0);
            let rises = grazing * grazing * grazing * grazing * grazing;
            specular.map(|ks| {
                let normal = ks.max(part * part).clamp(0.0, 1.0);
                normal + (1.0 - normal) * rises
            })
        }
    }
}

/// The bodies that a ray is inside of, the last one entered last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Media {
    bodies: [(u64, f64); Self::MOST],
    count: usize,
}

impl Media {
    /// The most bodies inside each other; further ones are not noted.
    const MOST: usize = 4;

    /// Returns the index of refraction around a ray.
    fn index(&self) -> f64 {
        self.bodies[..self.count].last().map_or(1.0, |(_, index)| *index)
    }

    /// Returns the indices in front of a surface of a body and behind it, and the media behind it.
    pub(super) fn across(&self, body: u64, index: f64, enters: bool) -> ([f64; 2], Self) {
        let mut behind = *self;
        if enters {
            if let Some(place) = behind.bodies.get_mut(self.count) {
                *place = (body, index);
                behind.count += 1;
            }
            return ([self.index(), index], behind);
        }
        // Overlapping bodies may be left in another order than they were entered in.
        let own = self.bodies[..self.count].iter().rposition(|(other, _)| *other == body);
        if let Some(place) = own {
            behind.bodies.copy_within(place + 1..self.count, place);
            behind.count -= 1;
        }
        ([index, behind.index()], behind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meeting(towards: DVec3, normal: DVec3) -> Meeting {
        let [towards, normal] = [towards, normal].map(DVec3::normalize_or_zero);
        Meeting { towards, normal, face: DVec3::Y }
    }

    #[test]
    fn a_ray_leaves_at_the_angle_of_incidence_and_obeys_snell() {
        let it = meeting(DVec3::new(3.0, -4.0, 0.0), DVec3::Y);
        assert!(it.mirrored().abs_diff_eq(DVec3::new(0.6, 0.8, 0.0), 1e-15));
        let inside = it.refracted(1.0 / 1.5).unwrap();
        // sin = 0.6 / 1.5.
        assert!((inside.towards.x - 0.4).abs() < 1e-15, "{inside:?}");
        assert!((inside.cosine - (1.0_f64 - 0.16).sqrt()).abs() < 1e-15);
        assert!(it.refracted(2.0).is_none(), "0.6 x 2 is more than 1");
        let unbent = it.refracted(1.0).unwrap().towards;
        assert!(unbent.abs_diff_eq(it.towards, 1e-15));
    }

    #[test]
    fn no_ray_leaves_on_the_wrong_side_of_its_face() {
        for i in 0..200 {
            // Normals that lean far away, also from the ray.
            let angle = f64::from(i) * 0.03;
            let normal = DVec3::new(libm::cos(angle), libm::sin(angle).abs(), 0.1);
            let it = meeting(DVec3::new(1.0, -0.05, 0.2), normal);
            assert!(it.mirrored().dot(it.face) > 0.9 * LEAST, "{i}");
            if let Some(inside) = it.refracted(0.7) {
                assert!(inside.towards.dot(it.face) < -0.9 * LEAST, "{i}");
            }
        }
    }

    #[test]
    fn glass_mirrors_4_percent_head_on_and_all_at_grazing_angles() {
        let glass = |cosine| reflectance(Reflection::Fresnel, [0.0; 3], cosine, [1.0, 1.5])[0];
        assert!((glass(1.0) - 0.04).abs() < 1e-15);
        assert_eq!(glass(0.0), 1.0);
        let metal = reflectance(Reflection::Fresnel, [0.9, 0.5, 0.0], 1.0, [1.0, 1.0]);
        assert_eq!(metal, [0.9, 0.5, 0.0]);
        assert_eq!(reflectance(Reflection::Constant, [0.3; 3], 0.0, [1.0, 1.5]), [0.3; 3]);
    }

    #[test]
    fn a_ray_in_water_in_a_glass_knows_both() {
        let (indices, in_glass) = Media::default().across(1, 1.5, true);
        assert_eq!(indices, [1.0, 1.5]);
        let (indices, in_water) = in_glass.across(2, 1.33, true);
        assert_eq!(indices, [1.5, 1.33]);
        // The glass ends before the water does.
        let (indices, behind) = in_water.across(1, 1.5, false);
        assert_eq!(indices, [1.5, 1.33]);
        assert_eq!(behind.across(2, 1.33, false).0, [1.33, 1.0]);
        let (indices, outside) = Media::default().across(7, 2.0, false);
        assert_eq!((indices, outside.count), ([2.0, 1.0], 0), "the observer is inside");
    }
}
