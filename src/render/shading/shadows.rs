//! Shades batches: light reaches a position only if nothing stands between.
//!
//! A light with shadows is added like any other. Then rays run to it from the positions at which
//! it added something, and those whose ray is stopped get back what they had before, bit for bit.
//! So the shaders of lights know nothing of shadows, and a position that no light reaches costs no
//! ray.
//!
//! Rays begin where light is evaluated: at the point of the triangle that a pixel shows (with
//! several samples, at the point at which they are lit), at a vertex, or at the centre of a face.
//! That point is computed in f64 in either arithmetic, so both have the same shadows.

use fearless_simd::Level;
use glam::DVec3;

use super::interpolated::ShadingNumber;
use super::triangle_attributes::TriangleAttributes;
use crate::render::frame::draw::{Draw, Stage};
use crate::render::lights::{Batch, LightTerm};
use crate::render::shadow::rays::{Origins, RayScratch};
use crate::render::shadow::tracer::Tracer;
use crate::render::simd::Number;
use crate::scene::dvec3;

/// The shadows on a batch.
pub(crate) struct BatchShadows<'a> {
    pub(crate) tracer: &'a Tracer<'a>,
    pub(crate) scratch: &'a mut RayScratch,
    /// Sets the points at which the batch is lit; called if a ray is needed.
    pub(crate) place: &'a mut dyn FnMut(&mut Origins),
    /// Whether they are set.
    pub(crate) is_placed: bool,
}

impl std::fmt::Debug for BatchShadows<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("BatchShadows").field("is_placed", &self.is_placed).finish_non_exhaustive()
    }
}

impl<'a> BatchShadows<'a> {
    pub(crate) fn new(
        tracer: &'a Tracer<'a>,
        scratch: &'a mut RayScratch,
        place: &'a mut dyn FnMut(&mut Origins),
    ) -> Self {
        Self { tracer, scratch, place, is_placed: false }
    }

    /// Adds the light of a stage at every position of a batch that sees it.
    pub(crate) fn add_light<T: ShadingNumber>(
        &mut self,
        stage: &Stage,
        term: &LightTerm<T>,
        level: Level,
        batch: &mut Batch<T>,
    ) {
        let Some(light) = self.tracer.light(stage.light) else {
            return T::add_light(stage.variant(), level, batch, term);
        };
        let before = (batch.diffuse, batch.specular);
        T::add_light(stage.variant(), level, batch, term);
        let rows = || batch.diffuse.iter().chain(&batch.specular);
        let rows_before = || before.0.iter().chain(&before.1);
        let mut lit = 0;
        for (row, before) in rows().zip(rows_before()) {
            for (i, (now, before)) in row[..batch.len].iter().zip(before).enumerate() {
                let [now, before]: [f64; 2] = [(*now).into(), (*before).into()];
                lit |= u64::from(now != before) << i;
            }
        }
        if lit == 0 {
            return;
        }
        if !self.is_placed {
            (self.place)(&mut self.scratch.origins);
            self.is_placed = true;
        }
        let mut shaded = self.tracer.shaded(level, light, self.scratch, lit);
        let rows = batch.diffuse.iter_mut().chain(&mut batch.specular);
        if shaded == lit {
            // What is not lit has not changed.
            rows.zip(rows_before()).for_each(|(row, before)| *row = *before);
            return;
        }
        while shaded != 0 {
            let i = shaded.trailing_zeros() as usize;
            shaded &= shaded - 1;
            for axis in 0..3 {
                batch.diffuse[axis][i] = before.0[axis][i];
                batch.specular[axis][i] = before.1[axis][i];
            }
        }
    }
}

/// Sets the points at which vertices are lit, from their positions in object space.
pub(crate) fn place_vertices<T: Number>(
    (tracer, caster): (&Tracer<'_>, u32),
    positions: &[[T; crate::render::simd::BATCH]; 3],
    count: usize,
    origins: &mut Origins,
) {
    origins.begin(Some(caster), false);
    let world_from_object = tracer.placement(caster);
    let [x, y, z] = positions;
    for (i, ((x, y), z)) in x.iter().zip(y).zip(z).take(count).enumerate() {
        let [x, y, z]: [f64; 3] = [*x, *y, *z].map(Into::into);
        let at = world_from_object.transform_point3(DVec3::new(x + 0.0, y + 0.0, z + 0.0));
        origins.set(i, at, [0; 2]);
    }
}

/// Sets the points at which faces are lit: the centres of their polygons, none of whose triangles
/// shades them.
pub(crate) fn place_faces<T: Number>(
    (tracer, caster): (&Tracer<'_>, u32),
    draw: &Draw,
    attributes: &TriangleAttributes<T>,
    origins: &mut Origins,
) {
    origins.begin(Some(caster), false);
    let mesh = &draw.model.mesh;
    let world_from_object = tracer.placement(caster);
    for (i, number) in attributes.numbers[..attributes.count].iter().enumerate() {
        let polygon = mesh.polygon_of(*number);
        let centre = dvec3(mesh.facets()[polygon as usize].centre);
        let own = mesh.triangles_of(polygon);
        let ends = [own.start, own.end].map(|i| u32::try_from(i).unwrap_or(u32::MAX));
        origins.set(i, world_from_object.transform_point3(centre), ends);
    }
}
