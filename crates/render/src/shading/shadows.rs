//! Shadows of batches: light reaches a position only if nothing blocks its ray.
//!
//! A light with shadows is first added like any other. Rays then run to it from the positions where
//! it added something, and positions with a blocked ray get back their previous values, bit for
//! bit. Light shaders therefore do not handle shadows, and a position that no light reaches costs
//! no ray. If a light's shadow on a pixel is cached from an earlier frame, no ray is traced either.
//!
//! Rays start where light is evaluated: at the triangle's point in a pixel (with several samples,
//! at the point that is lit), at a vertex, or at the centre of a face. That point is computed in
//! f64 for either arithmetic, so both have the same shadows.

use crate::simd::dispatch;
use fearless_simd::{Level, Simd, SimdBase as _, SimdMask as _, u32x16};
use glam::DVec3;

use super::fragments::Fragments;
use super::interpolated::ShadingNumber;
use super::occlusion::add_sky;
use super::soft_shadows::add_soft_light;
use super::triangle_attributes::TriangleAttributes;
use crate::frame::draw::{Draw, Stage};
use crate::lights::{Batch, LightTerm, Rows, add_light};
use crate::shadow::known::{BatchPixels, KnownPixels};
use crate::shadow::map_face::{Reading, TAPS};
use crate::shadow::rays::{Origins, RayScratch};
use crate::shadow::sequence::place_of_point;
use crate::shadow::shaft::POINTS;
use crate::shadow::tracer::Tracer;
use crate::shadow::tracer::filters::Shares;
use crate::simd::{BATCH, Bits, Number};
use marraztu_core::scene::dvec3;

/// The shadows on a batch.
pub(crate) struct BatchShadows<'a> {
    tracer: &'a Tracer<'a>,
    scratch: &'a mut RayScratch,
    /// Sets the points at which the batch is lit; called if a ray is needed.
    place: &'a mut dyn FnMut(&mut Origins),
    /// Whether the points are set.
    is_placed: bool,
    /// The pixels of the batch, if the cache may be used for them.
    pixels: Option<BatchPixels<'a>>,
}

impl<'a> BatchShadows<'a> {
    pub(crate) fn new(
        tracer: &'a Tracer<'a>,
        scratch: &'a mut RayScratch,
        place: &'a mut dyn FnMut(&mut Origins),
    ) -> Self {
        Self { tracer, scratch, place, is_placed: false, pixels: None }
    }

    /// Returns the same for a batch of these fragments. Unless layers are painted, each fragment is
    /// the only one of its pixel.
    pub(crate) fn of_pixels(self, fragments: &'a Fragments) -> Self {
        let Fragments { len, pixels, x, y, .. } = fragments;
        let of_batch = BatchPixels { first: [x[0], y[0]], places: &pixels[..*len] };
        Self { pixels: (!self.scratch.paints_layers).then_some(of_batch), ..self }
    }

    /// Sets the points at which the batch is lit.
    fn place(&mut self) {
        if !self.is_placed {
            (self.place)(&mut self.scratch.origins);
            self.is_placed = true;
        }
    }

    /// Returns the positions of a mask where a light is blocked. Positions without a cached result
    /// are traced.
    fn traced(&mut self, level: Level, (number, light): (u32, DVec3), mask: u64) -> u64 {
        let known = self.pixels.zip(self.tracer.known(number));
        // The cache has a bit per pixel of the block; the batch may hold only some pixels.
        let before = known.map_or(KnownPixels::default(), |(pixels, known)| {
            let KnownPixels { traced, shaded } = known.at(pixels.first);
            KnownPixels { traced: pixels.in_batch(traced), shaded: pixels.in_batch(shaded) }
        });
        // Only pixels without a cached result need a ray.
        let unknown = mask & !before.traced;
        if unknown == 0 {
            return before.shaded & mask;
        }
        self.place();
        let shaded = self.tracer.shaded(level, light, self.scratch, unknown);
        if let Some((pixels, known)) = known {
            let [traced, shaded] = [unknown, shaded].map(|mask| pixels.in_block(mask));
            known.note(pixels.first, KnownPixels { traced, shaded });
        }
        before.shaded & mask | shaded
    }

    /// Returns the fraction of a light that passes through glass on its way to positions of a mask;
    /// `None` if there is none.
    fn filtered(&mut self, level: Level, light: DVec3, mask: u64) -> Option<Shares> {
        if !self.tracer.has_glass() {
            return None;
        }
        self.place();
        self.tracer.filtered_from(level, self.scratch, light, mask)
    }

    /// Adds the light of a stage at every position of a batch that it reaches.
    pub(crate) fn add_light<T: ShadingNumber>(
        &mut self,
        stage: &Stage,
        term: &LightTerm<T>,
        level: Level,
        batch: &mut Batch<T>,
    ) {
        if let Some(sky) = self.tracer.sky(stage.light) {
            self.place();
            let Self { tracer, scratch, .. } = self;
            return add_sky((tracer, sky), scratch, term, level, batch);
        }
        // Lights without shadows are only added.
        let Some(light) = self.tracer.light(stage.light) else {
            return add_light(level, batch, term);
        };
        if let Some(soft) = self.tracer.soft(stage.light) {
            self.place();
            let Self { tracer, scratch, .. } = self;
            return add_soft_light((tracer, soft), scratch, term, level, batch);
        }
        let before = (first(&batch.diffuse), first(&batch.specular));
        add_light(level, batch, term);
        // Positions that the light did not change need no ray.
        let lit = lit(level, batch, &before);
        if lit == 0 {
            return;
        }
        let reading = match self.tracer.map(stage.light) {
            None => Reading {
                occluded: self.traced(level, (stage.light, light), lit),
                partly: 0,
                open: [0; POINTS],
            },
            Some(map) => {
                self.place();
                let at = &self.scratch.origins.at;
                dispatch!(level, _ => map.read(at, lit))
            }
        };
        if reading.occluded == lit {
            // Unlit positions have not changed, so the whole batch can be restored.
            let rows = batch.diffuse.iter_mut().chain(&mut batch.specular);
            for (row, before) in rows.zip(before.0.iter().chain(&before.1)) {
                row[..POINTS].copy_from_slice(before);
            }
            return;
        }
        // Blocked positions get back their values; PCF scales the light of partly open ones.
        for i in Bits(reading.occluded) {
            for axis in 0..3 {
                batch.diffuse[axis][i] = before.0[axis][i];
                batch.specular[axis][i] = before.1[axis][i];
            }
        }
        let open = lit & !reading.occluded;
        if let Some(shares) = self.filtered(level, light, open) {
            for i in Bits(open) {
                for (axis, share) in shares[i].into_iter().enumerate() {
                    let share = T::from_f64(share);
                    let (diffuse, specular) = (before.0[axis][i], before.1[axis][i]);
                    batch.diffuse[axis][i] = diffuse + (batch.diffuse[axis][i] - diffuse) * share;
                    batch.specular[axis][i] =
                        specular + (batch.specular[axis][i] - specular) * share;
                }
            }
        }
        for i in Bits(reading.partly) {
            let share = T::from_f64(f64::from(reading.open[i]) / f64::from(TAPS));
            for axis in 0..3 {
                let (diffuse, specular) = (before.0[axis][i], before.1[axis][i]);
                batch.diffuse[axis][i] = diffuse + (batch.diffuse[axis][i] - diffuse) * share;
                batch.specular[axis][i] = specular + (batch.specular[axis][i] - specular) * share;
            }
        }
    }
}

/// The first numbers of three rows. Batches with shadows have no more.
pub(super) type Firsts<T> = [[T; POINTS]; 3];

pub(super) fn first<T: Number>(rows: &Rows<T>) -> Firsts<T> {
    std::array::from_fn(|i| *rows[i].first_chunk().expect("a batch has room for more"))
}

/// Returns the positions of a batch with changed light, at most [`POINTS`], a bit for each.
pub(super) fn lit<T: Number>(
    level: Level,
    batch: &Batch<T>,
    before: &(Firsts<T>, Firsts<T>),
) -> u64 {
    let mut changed = [0_u32; POINTS];
    let rows = batch.diffuse.iter().chain(&batch.specular);
    for (row, before) in rows.zip(before.0.iter().chain(&before.1)) {
        for ((changed, now), before) in changed.iter_mut().zip(row).zip(before) {
            *changed |= u32::from(now != before);
        }
    }
    let lit = dispatch!(level, simd => bit_of_each(simd, &changed));
    // Lanes beyond the batch may have changed, too.
    lit & u64::MAX >> (POINTS - batch.len)
}

/// Returns a bit for each number other than 0.
#[inline(always)]
fn bit_of_each<S: Simd>(simd: S, numbers: &[u32; POINTS]) -> u64 {
    let zero = u32x16::splat(simd, 0);
    let mut bits = 0;
    for at in (0..POINTS).step_by(16) {
        let some = u32x16::from_slice(simd, &numbers[at..at + 16]);
        bits |= some.simd_gt(zero).to_bitmask() << at;
    }
    bits
}

/// Sets the points at which vertices are lit, from their positions in object space.
pub(crate) fn place_vertices<T: Number>(
    (tracer, caster): (&Tracer<'_>, u32),
    positions: &[[T; BATCH]; 3],
    count: usize,
    origins: &mut Origins,
) {
    origins.begin(Some(caster), false);
    let world_from_object = tracer.placement(caster);
    let [x, y, z] = positions;
    for (i, ((x, y), z)) in x.iter().zip(y).zip(z).take(count).enumerate() {
        let [x, y, z]: [f64; 3] = [*x, *y, *z].map(Into::into);
        // Computed like the casters' corners, so both are equal; adding 0 removes negative zeros.
        let at = world_from_object.transform_point3(DVec3::new(x + 0.0, y + 0.0, z + 0.0));
        origins.set(i, at, [0; 2], place_of_point(at));
    }
}

/// Sets the points at which faces are lit: the centres of their polygons. No triangle of the
/// polygon shades its centre.
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
        let at = world_from_object.transform_point3(centre);
        origins.set(i, at, ends, place_of_point(at));
    }
}
