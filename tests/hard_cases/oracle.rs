//! The oracle of pictures: ray casting and the lighting equation in f64, independent of the
//! renderer's code.

use glam::DVec3;

/// A pinhole camera: pixels per side, position, and tangent of the half-angle of view.
#[derive(Clone, Copy)]
pub(crate) struct Eye {
    pub(crate) side: usize,
    pub(crate) at: DVec3,
    pub(crate) tangent: f64,
}

impl Eye {
    /// The camera of the scenes of `common`: at (0, 0, 400), looking along -Z.
    pub(crate) fn first(side: usize) -> Self {
        Self { side, at: DVec3::Z * 400.0, tangent: (2.0_f64.sqrt() - 1.0) }
    }

    /// The ray from the eye through a pixel centre.
    pub(crate) fn ray(&self, x: usize, y: usize) -> DVec3 {
        let across = |i: usize| ((i as f64 + 0.5) * 2.0 / self.side as f64 - 1.0) * self.tangent;
        DVec3::new(across(x), -across(y), -1.0)
    }

    /// Projects a world position into the picture, in pixels.
    pub(crate) fn pixel(&self, place: DVec3) -> [f64; 2] {
        let p = place - self.at;
        let half = self.side as f64 / 2.0;
        let scale = half / self.tangent / -p.z;
        [half + p.x * scale, half - p.y * scale]
    }
}

/// Intersects a ray with a triangle: distance along the ray and barycentric coordinates.
///
/// Cramer's rule: Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997.
pub(crate) fn meet(origin: DVec3, ray: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 3])> {
    let (e, f) = (b - a, c - a);
    let p = ray.cross(f);
    let determinant = e.dot(p);
    let from = origin - a;
    let q = from.cross(e);
    let [v, w] = [from.dot(p) / determinant, ray.dot(q) / determinant];
    let t = f.dot(q) / determinant;
    let parts = [1.0 - v - w, v, w];
    (parts.iter().all(|part| *part >= 0.0) && t > 0.0).then_some((t, parts))
}

/// The smallest barycentric coordinate: the distance from the nearest side, relative to the size
/// of the triangle.
pub(crate) fn inside_by(parts: [f64; 3]) -> f64 {
    parts.into_iter().fold(f64::INFINITY, f64::min)
}

/// A light.
#[derive(Clone, Copy)]
pub(crate) enum OracleLight {
    Ambient,
    /// The direction of travel.
    Sun(DVec3),
    Bulb(DVec3),
    /// Position, axis, half-aperture in degrees, exponent.
    Spot(DVec3, DVec3, f64, f64),
}

/// A material.
#[derive(Clone, Copy)]
pub(crate) struct OracleMaterial {
    pub(crate) ambient: f64,
    pub(crate) diffuse: f64,
    pub(crate) specular: f64,
    pub(crate) exponent: f64,
}

/// Light from white lights at a position with the normal `n` towards `v`, not clamped. `power`
/// raises cosines to the exponent, so variants of it can be compared.
pub(crate) fn light(
    lamps: &[OracleLight],
    matter: &OracleMaterial,
    [place, n, v]: [DVec3; 3],
    power: &dyn Fn(f64, f64) -> f64,
) -> f64 {
    let mut sum = 0.0;
    for lamp in lamps {
        // Direction to the light and its attenuation; ambient light needs neither.
        let (to_light, strength) = match *lamp {
            OracleLight::Ambient => {
                sum += matter.ambient;
                continue;
            }
            OracleLight::Sun(direction) => (-direction, 1.0),
            OracleLight::Bulb(at) | OracleLight::Spot(at, ..) => {
                let d = (at - place).length();
                ((at - place) / d, 1.0 / (1.0 + 5e-6 * d + 5e-6 * d * d))
            }
        };
        // The falloff of a spot inside its cone.
        let gathered = match *lamp {
            OracleLight::Spot(_, axis, half_aperture, exponent) => {
                let c = axis.dot(-to_light).min(1.0);
                if c > half_aperture.to_radians().cos() { c.powf(exponent) } else { 0.0 }
            }
            _ => 1.0,
        };
        // Phong: diffuse by N.L; specular by R.V, only on the lit side.
        let n_l = n.dot(to_light);
        let mirrored = n * (2.0 * n_l) - to_light;
        let mut reflected = matter.diffuse * n_l.max(0.0);
        if n_l > 0.0 && mirrored.dot(v) > 0.0 {
            reflected += matter.specular * power(mirrored.dot(v).min(1.0), matter.exponent);
        }
        sum += strength * gathered * reflected;
    }
    sum
}

/// Normalises a vector of ordinary length.
pub(crate) fn unit(v: DVec3) -> DVec3 {
    v / v.length()
}

/// The angle between two directions, accurate for small angles too.
pub(crate) fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}
