//! Shades points that rays meet, by the stages that shade fragments.
//!
//! A list of points takes the place of a list of fragments: each has a triangle, its weights in
//! it, its position, and the direction back along its ray. From there on everything is the same:
//! normals, bumps, light, shadows, texels and maps. The result is light instead of bytes.

use fearless_simd::Level;
use glam::DVec3;

use super::context::Group;
use super::interpolate::{Points, mixed};
use super::interpolated::ShadingNumber;
use super::quantize::{SurfaceColor, reflected};
use super::shader::Shader;
use super::surface::Origin;
use crate::accel::Accelerated as _;
use crate::frame::draw::{Back, Draw, Pipeline};
use crate::frame::program::LightOp;
use crate::lights::{Batch, Rows, columns, load, store, turned};
use crate::rays::{Corners, Hit};
use crate::simd::gather::SLOTS;
use crate::simd::{BATCH, Kernel, Lanes, Number, Vec3};
use crate::texture::placement::Steps;
use marraztu_core::base::color::{Color, linear};

/// A point that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) hit: Hit,
    /// The direction of the ray, in view space.
    pub(super) towards: DVec3,
    /// The corners of the triangle, in view space.
    pub(super) corners: Corners,
    /// The width of the ray where it meets the surface: textures are filtered for it.
    pub(super) width: f64,
    /// The place of its samples in the sequences of lights.
    pub(super) place: u32,
}

/// The most points of a list.
pub(super) const MOST: usize = SLOTS;

impl Point {
    /// Returns the position, in view space.
    pub(super) fn position(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        a + (b - a) * self.hit.weights.y + (c - a) * self.hit.weights.z
    }

    /// Returns the normal of the face on the side of the ray, of length 1.
    pub(super) fn face(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if normal.dot(self.towards) > 0.0 { -normal } else { normal }
    }

    /// Returns the steps of the weights across the ray: along two directions perpendicular to it,
    /// by its width, to the plane of the triangle. There is no perspective inside a ray.
    fn steps(&self) -> Steps {
        let [a, b, c] = self.corners;
        let (u, v) = (b - a, c - a);
        let normal = u.cross(v);
        let (right, down) = self.towards.any_orthonormal_pair();
        let facing = normal.dot(self.towards);
        [right, down].map(|across| {
            let across = across * self.width;
            let on_plane = across - self.towards * (normal.dot(across) / facing);
            let part = |cross: DVec3| cross.dot(normal) / normal.length_squared();
            let [second, third] = [part(on_plane.cross(v)), part(u.cross(on_plane))];
            [-(second + third), second, third]
        })
    }
}

impl<T: ShadingNumber> Shader<T> {
    /// Shades at most [`MOST`] points of a group and stores their light in `to`. Afterwards, the
    /// batch holds the normals of surfaces that send rays on.
    pub(super) fn shade_points(
        &mut self,
        group: &Group<'_, T>,
        points: &[Point],
        to: &mut Rows<T>,
    ) {
        let context = group.context;
        let linear_values = context.mode().is_linear();
        let level = context.level;
        match &context.plan.pipelines[group.pipeline as usize] {
            Pipeline::Flat(color) => fill(to, *color, linear_values),
            Pipeline::Shaded(shaded) => {
                self.take_points(group, points);
                let lit = group.program.light == LightOp::Points;
                if lit {
                    self.light_points(group, shaded, Origin::Hits(points));
                }
                self.batch.len = points.len();
                let glows = self.surface_light(group, shaded);
                let Self { batch, texels, maps, .. } = self;
                let own = match shaded.varies() {
                    true => SurfaceColor::Texels(texels),
                    false => SurfaceColor::Tint(shaded.tint.map(T::from_f64)),
                };
                let glow = glows.then_some(&maps.glow);
                T::run(level, Radiance { batch, lit, own, glow, to });
            }
        }
        if group.draw.back == Back::Red {
            let red = Color::BACK_FACE.factors();
            for (i, _) in points.iter().enumerate().filter(|(_, point)| !point.hit.is_front) {
                for (row, part) in to.iter_mut().zip(red) {
                    row[i] = T::from_f64(if linear_values { linear(part) } else { part });
                }
            }
        }
    }

    /// Lists points, each with a slot of its own.
    fn take_points(&mut self, group: &Group<'_, T>, points: &[Point]) {
        let Self { fragments, attributes, barycentrics, batch, .. } = self;
        let mut numbers = [0; MOST];
        let mut back = 0;
        for (i, (number, point)) in numbers.iter_mut().zip(points).enumerate() {
            *number = point.hit.triangle;
            back |= u64::from(!point.hit.is_front) << i;
        }
        fragments.list_faces(&numbers[..points.len()]);
        let order = group.draw.model.mesh.draw_order();
        attributes.take_alone(fragments, order, (group.draw_index, back));
        attributes.footprints.clear();
        attributes.footprints.extend(points.iter().map(Point::steps));
        for (i, point) in points.iter().enumerate() {
            barycentrics.weights[0][i] = T::from_f64(point.hit.weights.y);
            barycentrics.weights[1][i] = T::from_f64(point.hit.weights.z);
            barycentrics.w[i] = T::from_f64(1.0);
            let (position, back) = (point.position().to_array(), (-point.towards).to_array());
            for axis in 0..3 {
                batch.position[axis][i] = T::from_f64(position[axis]);
                batch.to_eye[axis][i] = T::from_f64(back[axis]);
            }
        }
        batch.len = points.len();
    }
}

/// Sets all light to a colour.
fn fill<T: Number>(to: &mut Rows<T>, color: Color, linear_values: bool) {
    for (row, part) in to.iter_mut().zip(color.factors()) {
        row.fill(T::from_f64(if linear_values { linear(part) } else { part }));
    }
}

/// Interpolates the normals of a list of points.
pub(super) fn place_normals<T: Number>(
    level: Level,
    draw: &Draw,
    points: Points<'_, T>,
    batch: &mut Batch<T>,
) {
    let normals = columns(draw.view_from_normal);
    T::run(level, PlaceNormals { points, normals, batch });
}

struct PlaceNormals<'a, T> {
    points: Points<'a, T>,
    /// The columns of the matrix that transforms normals to view space.
    normals: [[T; 3]; 3],
    batch: &'a mut Batch<T>,
}

impl<T: Number> Kernel<T> for PlaceNormals<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { points: Points { fragments, attributes, barycentrics }, normals, batch } = self;
        for at in (0..fragments.len).step_by(M::LANES) {
            let slots = lanes.slots((&fragments.slots, attributes.count), at);
            let weights = barycentrics.weights_at(lanes, at);
            let normal = mixed(lanes, &attributes.values, slots, weights);
            store(lanes, turned(lanes, normals, normal).unit(), &mut batch.normal, at);
        }
    }
}

/// Computes the light that leaves points: t D + S + e if the surface is lit, else t + e, with the
/// surface colour t, diffuse light D, specular light S and emitted light e. It is not clamped.
struct Radiance<'a, T> {
    batch: &'a Batch<T>,
    lit: bool,
    own: SurfaceColor<'a, T>,
    glow: Option<&'a Rows<T>>,
    to: &'a mut Rows<T>,
}

impl<T: Number> Kernel<T> for Radiance<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { batch, lit, own, glow, to } = self;
        for at in (0..batch.len).step_by(M::LANES) {
            let mut light: Vec3<M::R> = own.at(lanes, at);
            if lit {
                light = reflected(lanes, light, batch, at);
            }
            if let Some(glow) = glow {
                light = light.plus(load(lanes, glow, at));
            }
            store(lanes, light, to, at);
        }
    }
}

/// Returns empty rows.
pub(super) fn no_light<T: Number>() -> Rows<T> {
    [[T::default(); BATCH]; 3]
}
