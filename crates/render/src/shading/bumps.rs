//! Bump and normal mapping: tilts the normals of pixels by maps of heights or normals.
//!
//! In tangent space, with T along u, B along v and N across the surface, the normal comes from the
//! map, or is (-g dh/du, -g dh/dv, 1) with the slopes of heights h per texel and their factor g: a
//! white texel is g texels high. Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978.
//!
//! T and B come from one of two places:
//!
//! * vertices: T by MikkTSpace, and B = s N x T, both interpolated and not normalised, as normal
//!   maps are made for;
//! * the pixel: the gradients of u and v on the triangle, perpendicular to N, each of length 1: T ~
//!   (du1 e2 - du2 e1) x N with the sides e1 and e2 and the steps of u along them; B likewise with
//!   v. Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU", JGT 2010; Schueler,
//!   "Followup: Normal Mapping Without Precomputed Tangents", 2013.
//!
//! The back of a surface has the negated normal of its front.

use glam::{DMat3, DVec3};

use super::context::Group;
use super::interpolate::{Points, mixed};
use super::interpolated::ShadingNumber;
use super::map_rows::{Map, MapRows, TangentRows};
use super::map_texels::TexelSource;
use super::texels::Texels;

use super::triangle_attributes::{TriangleAttributes, picked};
use crate::frame::draw::Draw;
use crate::frame::extras::Bump;
use crate::frame::variants::Decoding;
use crate::lights::{Batch, Rows, columns, load, store, turned};
use crate::simd::{Kernel, Lanes, Number, Real, Vec3};
use crate::texture::uv::uvs;
use marraztu_core::accuracy::Tangents;

impl<T: Number> TangentRows<T> {
    fn set(&mut self, slot: usize, vectors: [DVec3; 3]) {
        for (rows, vector) in self.vectors.iter_mut().zip(vectors) {
            for (row, x) in rows.iter_mut().zip(vector.to_array()) {
                row[slot] = T::from_f64(x);
            }
        }
    }

    /// Sets the tangents at the vertices of the triangles of a list.
    fn of_vertices(&mut self, draw: &Draw, attributes: &TriangleAttributes<T>) {
        let all = draw.model.mesh.tangents(draw.normal_source);
        for (slot, number) in attributes.numbers[..attributes.count].iter().enumerate() {
            // On the back, T, B and N are all reversed; mirroring reverses only the cross product.
            let turn = if attributes.back >> slot & 1 == 1 { -1.0 } else { 1.0 };
            let mirror = if draw.mirrored { -1.0 } else { 1.0 };
            let corners = all[*number as usize];
            let [a, b, c] =
                corners.map(|[x, y, z, _]| DVec3::from_array([x, y, z].map(f64::from)) * turn);
            self.set(slot, [a, b - a, c - a]);
            self.signs[slot] = T::from_f64(f64::from(corners[0][3]) * turn * mirror);
        }
    }

    /// Sets the gradients of the texture coordinates on the triangles of a list.
    fn of_pixels(&mut self, draw: &Draw, attributes: &TriangleAttributes<T>) {
        let mesh = &draw.model.mesh;
        for (slot, number) in attributes.numbers[..attributes.count].iter().enumerate() {
            // Without texture coordinates there is no gradient to follow.
            let Some([a, b, c]) = uvs(draw, *number) else {
                self.set(slot, [DVec3::ZERO; 3]);
                continue;
            };
            let corners = mesh.triangle(*number as usize);
            let [p, q, r] = corners.map(|corner| mesh.corner_position(corner));
            let (e1, e2) = (q - p, r - p);
            let turn = if attributes.back >> slot & 1 == 1 { -1.0 } else { 1.0 };
            // The attributes are reversed on back faces, and turned back here.
            let normal = |corner: usize| {
                let [x, y, z, _] = attributes.carried[corner][slot];
                DVec3::new(x.into(), y.into(), z.into()) * turn
            };
            // The sign follows the vertex normals, for either winding and for mirrored objects.
            let sum = normal(0) + normal(1) + normal(2);
            let inward = (e1.cross(e2).dot(sum) < 0.0) != draw.mirrored;
            let sign = if inward { -1.0 } else { 1.0 };
            let linear = DMat3::from_mat4(draw.view_from_object);
            let across = |axis: usize| {
                let along = e2 * (b[axis] - a[axis]) - e1 * (c[axis] - a[axis]);
                (linear * along).normalize_or_zero() * sign
            };
            self.set(slot, [across(0), across(1), DVec3::ZERO]);
        }
    }
}

/// Tilts the interpolated normals of a batch.
pub(super) fn bend<T: ShadingNumber>(
    group: &Group<'_, T>,
    points: Points<'_, T>,
    bump: &Bump,
    (maps, batch): (&mut MapRows<T>, &mut Batch<T>),
) {
    let (level, mode) = (group.context.level, group.context.mode());
    let mut source = TexelSource::new(group.context, &bump.map, Decoding::Stored);
    source.filter = mode.bump_filter;
    let what = if bump.gain.is_some() { Texels::Slopes } else { Texels::Colors };
    maps.read(group, points, (Map::Bump, source, what), [1.0; 3]);
    let attributes = points.attributes;
    if attributes.are_new {
        match mode.tangents {
            Tangents::Vertex => maps.tangents.of_vertices(group.draw, attributes),
            Tangents::Pixel => maps.tangents.of_pixels(group.draw, attributes),
        }
    }
    // A negative texture scale reverses the direction of u or v.
    let directions = bump.map.scale.map(|scale| if scale < 0.0 { -1.0 } else { 1.0 });
    T::run(
        level,
        Bend {
            points,
            texels: &maps.texels,
            tangents: &maps.tangents,
            at_vertices: mode.tangents == Tangents::Vertex,
            gain: bump.gain,
            directions,
            spaces: Spaces::new(group.draw),
            batch,
        },
    );
}

/// The transforms of normals and tangents to view space, both without scale.
#[derive(Clone, Copy)]
struct Spaces<T> {
    normals: [[T; 3]; 3],
    tangents: [[T; 3]; 3],
}

impl<T: Number> Spaces<T> {
    fn new(draw: &Draw) -> Self {
        // T, B and N are added up, so neither transform may change their relative lengths.
        let unscaled = |m: DMat3| {
            let scale = libm::cbrt(m.determinant().abs());
            columns(if scale > 0.0 { m * (1.0 / scale) } else { m })
        };
        Self {
            normals: unscaled(draw.view_from_normal),
            tangents: unscaled(DMat3::from_mat4(draw.view_from_object)),
        }
    }
}

struct Bend<'a, T> {
    points: Points<'a, T>,
    texels: &'a Rows<T>,
    tangents: &'a TangentRows<T>,
    /// Whether tangents come from vertices.
    at_vertices: bool,
    /// The factor of heights; `None` if texels are normals.
    gain: Option<f64>,
    /// Whether texels run along u and v, or against them.
    directions: [f64; 2],
    spaces: Spaces<T>,
    batch: &'a mut Batch<T>,
}

impl<T: Number> Kernel<T> for Bend<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { points, texels, tangents, gain, directions, spaces, batch, .. } = self;
        let Points { fragments, attributes, barycentrics } = points;
        for at in (0..fragments.len).step_by(M::LANES) {
            let slots = lanes.slots((&fragments.slots, attributes.count), at);
            let unbent = load(lanes, &batch.normal, at);
            let [x, y, z] = load(lanes, texels, at).0;
            let [x, y, z] = match gain {
                Some(gain) => [x * lanes.lift(-gain), y * lanes.lift(-gain), lanes.lift(1.0)],
                // Bytes minus 128, divided by 127: 128 is exactly 0, and 255 is 1.
                None => {
                    let (scale, middle) = (lanes.lift(255.0 / 127.0), lanes.lift(128.0 / 127.0));
                    [x * scale - middle, y * scale - middle, z * scale - middle]
                }
            };
            let (x, y) = (x * lanes.lift(directions[0]), y * lanes.lift(directions[1]));
            // The tangent frame: interpolated from vertices, or from the gradients on the triangle.
            let (tangent, bitangent, normal) = if self.at_vertices {
                let weights = barycentrics.weights_at(lanes, at);
                let normal = mixed(lanes, &attributes.values, slots, weights);
                let normal = turned(lanes, spaces.normals, normal);
                let tangent = mixed(lanes, &tangents.vectors, slots, weights);
                let tangent = turned(lanes, spaces.tangents, tangent);
                let sign = lanes.pick(&tangents.signs, slots);
                (tangent, normal.cross(tangent).times(sign), normal)
            } else {
                let a = picked(lanes, &tangents.vectors[0], slots);
                let b = picked(lanes, &tangents.vectors[1], slots);
                (a.cross(unbent).unit(), b.cross(unbent).unit(), unbent)
            };
            let bent = tangent.times(x).plus(bitangent.times(y)).plus(normal.times(z)).unit();
            // A flat texel changes no bit. Rounding errors of filtering also count as flat.
            let slope = x * x + y * y;
            let flat = lanes.lift(1e-12);
            let select = |bent: M::R, unbent: M::R| slope.if_more(flat, bent, unbent);
            let [p, q, r] = bent.0;
            let [s, t, u] = unbent.0;
            let normal = Vec3([select(p, s), select(q, t), select(r, u)]);
            store(lanes, normal, &mut batch.normal, at);
        }
    }
}
