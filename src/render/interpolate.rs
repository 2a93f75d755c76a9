//! From pixels and the triangles that they show to what is there: place, normal, light.
//!
//! First where in its triangle each pixel lies, linear on the screen, from whole numbers; then the
//! same with perspective; then what the corners carry, mixed. A value that all corners share comes
//! out as it went in, bit for bit, since only differences are weighted.
//!
//! The place of a pixel in space is the point of its ray at its depth, so that the direction to the
//! observer is exact whatever the triangle.
//!
//! Perspective: Heckbert and Moreton, "Interpolation for Polygon Texture Mapping and Shading", 1991.

use fearless_simd::{Level, Simd, SimdBase as _, SimdInt as _, dispatch, f32x16, i32x16};
use glam::{DMat3, DVec3};

use super::colors::Colors;
use super::coverage::{SUBPIXELS, Triangle};
use super::effects::{BATCH, Batch, Rows, set, store};
use super::faces::{Faced, Faces, barycentric, cut_place, cut_w, cut_weights};
use super::items::Items;
use super::pick::{SLOTS, pick};
use super::plan::{Draw, Eye, FramePlan};
use super::real::{Kernel, Machine, Number, Real, Sixteen, Triple};
use super::whole::{self, Blocks, Canvas, Linear as _, Wide};

/// Where the pixels of a list lie in their triangles.
#[derive(Debug)]
pub struct Located<T> {
    /// The second and third barycentric coordinate, linear on the screen.
    pub(super) linear: [[T; BATCH]; 2],
    /// The same with perspective.
    pub(super) weights: [[T; BATCH]; 2],
    /// The distance along the observer's axis.
    pub(super) w: [T; BATCH],
    /// Where they are looked at, in pixels; where they [share](Items::shared) their pixels only.
    pub(super) places: [[T; BATCH]; 2],
}

impl<T: Number> Default for Located<T> {
    fn default() -> Self {
        let row = [T::default(); BATCH];
        Self { linear: [row; 2], weights: [row; 2], w: row, places: [row; 2] }
    }
}

/// Numbers that are interpolated.
pub trait Interpolated: Faced {
    /// Finds where every pixel lies, where the triangles allow it to be done sixteen pixels at a time;
    /// says whether they do.
    fn find(level: Level, items: &Items, faces: &Faces<Self>, to: &mut Located<Self>) -> bool;
    /// Finds the linear barycentric coordinates, but for those of wide triangles.
    fn find_linear(level: Level, items: &Items, faces: &Faces<Self>, to: &mut Located<Self>);
    /// Mixes the colours that the corners of one triangle carry in blocks of a tile that it covers as
    /// a whole, where that can be done in one pass; says whether it can.
    fn mix_blocks(level: Level, faces: &Faces<Self>, blocks: Blocks, to: &mut Canvas<'_>) -> bool;
}

/// Does something for as many pages of slots as `count` triangles take.
macro_rules! paged {
    ($count:expr, $pages:ident => $what:expr) => {
        match $count {
            0..=16 => {
                const $pages: usize = 1;
                $what
            }
            17..=32 => {
                const $pages: usize = 2;
                $what
            }
            _ => {
                const $pages: usize = 4;
                $what
            }
        }
    };
}

impl<T: Interpolated> Located<T> {
    /// Finds where every pixel lies.
    pub(super) fn find(
        &mut self,
        level: Level,
        items: &Items,
        faces: &Faces<T>,
        (plan, draw): (&FramePlan, &Draw),
    ) {
        if items.shared || !T::find(level, items, faces, self) {
            T::find_linear(level, items, faces, self);
            self.find_wide(items, faces);
            if items.shared {
                self.hold(level, items, faces);
            }
            let count = faces.count;
            paged!(count, PAGES => T::run(level, Perspective::<T, PAGES> { items, faces, to: self }));
            if faces.cut != 0 {
                self.find_cut(items, faces, plan, draw);
            }
        }
    }

    /// Triangles that were cut are looked at one pixel at a time, in homogeneous coordinates.
    #[cold]
    fn find_cut(&mut self, items: &Items, faces: &Faces<T>, plan: &FramePlan, draw: &Draw) {
        for i in 0..items.len {
            let slot = items.slots[i].cast_unsigned() as usize;
            if faces.cut >> slot & 1 == 1 {
                let number = faces.numbers[slot];
                let pixel = [items.x[i], items.y[i]];
                let weights = cut_weights(plan, draw, number, (pixel, [0; 2]));
                self.weights[0][i] = T::from_f64(weights.y);
                self.weights[1][i] = T::from_f64(weights.z);
                self.w[i] = T::from_f64(cut_w(plan, draw, number, weights));
                if items.shared {
                    let place = cut_place(plan, draw, number, weights);
                    for (row, place) in self.places.iter_mut().zip(place) {
                        row[i] = T::from_f64(place);
                    }
                }
            }
        }
    }

    /// The parts that the corners have in pixel `i` of the list.
    pub(super) fn weights(&self, i: usize) -> DVec3 {
        let (b, c): (f64, f64) = (self.weights[0][i].into(), self.weights[1][i].into());
        DVec3::new(1.0 - b - c, b, c)
    }

    /// Finds the linear coordinates in wide triangles, with whole numbers of 64 bits.
    fn find_wide(&mut self, items: &Items, faces: &Faces<T>) {
        let (mut last, mut triangle) = (usize::MAX, None);
        for i in 0..items.len {
            let slot = items.slots[i].cast_unsigned() as usize;
            if faces.wide >> slot & 1 == 0 {
                continue;
            }
            if slot != last {
                (last, triangle) = (slot, Triangle::new(faces.corners(slot)));
            }
            if let Some(triangle) = &triangle {
                let [second, third] = barycentric(triangle, [items.x[i], items.y[i]]);
                self.linear[0][i] = T::from_f64(second);
                self.linear[1][i] = T::from_f64(third);
            }
        }
    }
}

impl Interpolated for f64 {
    fn find(_: Level, _: &Items, _: &Faces<Self>, _: &mut Located<Self>) -> bool {
        false
    }

    fn find_linear(_: Level, _: &Items, _: &Faces<Self>, _: &mut Located<Self>) {}

    fn mix_blocks(_: Level, _: &Faces<Self>, _: Blocks, _: &mut Canvas<'_>) -> bool {
        false
    }
}

impl Interpolated for f32 {
    fn find(level: Level, items: &Items, faces: &Faces<Self>, to: &mut Located<Self>) -> bool {
        let wide = faces.count == 1 && faces.wide == 1;
        if wide && let Some(triangle) = Triangle::new(faces.corners(0)) {
            dispatch!(level, simd => find_in_one(simd, items, &triangle, faces, to));
            return true;
        }
        if (faces.wide | faces.cut) != 0 {
            return false;
        }
        paged!(faces.count, PAGES => {
            dispatch!(level, simd => find_narrow::<_, PAGES>(simd, items, faces, to));
        });
        true
    }

    fn find_linear(level: Level, items: &Items, faces: &Faces<Self>, to: &mut Located<Self>) {
        paged!(faces.count, PAGES => {
            dispatch!(level, simd => find_narrow::<_, PAGES>(simd, items, faces, to));
        });
    }

    fn mix_blocks(level: Level, faces: &Faces<Self>, blocks: Blocks, to: &mut Canvas<'_>) -> bool {
        whole::mix(level, faces, blocks, to)
    }
}

/// Where pixels lie in narrow triangles.
#[inline(always)]
fn find_narrow<S: Simd, const PAGES: usize>(
    simd: S,
    items: &Items,
    faces: &Faces<f32>,
    to: &mut Located<f32>,
) {
    let machine = Sixteen(simd);
    for at in (0..items.len).step_by(16) {
        let slots = machine.slots(&items.slots, at);
        let x = i32x16::from_slice(simd, &items.x[at..at + 16]);
        let y = i32x16::from_slice(simd, &items.y[at..at + 16]);
        let per_area = machine.pick::<PAGES>(&faces.per_area, slots);
        let second = edge::<S, PAGES>(simd, &faces.edges[0], slots, [x, y]) * per_area;
        let third = edge::<S, PAGES>(simd, &faces.edges[1], slots, [x, y]) * per_area;
        machine.store(second, &mut to.linear[0], at);
        machine.store(third, &mut to.linear[1], at);
        let by_w = picked::<_, PAGES>(machine, &faces.by_w, slots);
        to.put(machine, at, [second, third], by_w);
    }
}

/// The edge functions of narrow triangles are exact in 32 bits, even where products of theirs are
/// not: what overflows is taken away again.
#[inline(always)]
fn edge<S: Simd, const PAGES: usize>(
    simd: S,
    [a, b, c]: &[[i32; SLOTS]; 3],
    slots: i32x16<S>,
    [x, y]: [i32x16<S>; 2],
) -> f32x16<S> {
    let a = pick::<S, PAGES>(simd, a, slots);
    let b = pick::<S, PAGES>(simd, b, slots);
    let c = pick::<S, PAGES>(simd, c, slots);
    (a * x + b * y + c).to_float()
}

/// Where pixels lie in one triangle whose edge functions need more bits.
#[inline(always)]
fn find_in_one<S: Simd>(
    simd: S,
    items: &Items,
    triangle: &Triangle,
    faces: &Faces<f32>,
    to: &mut Located<f32>,
) {
    let machine = Sixteen(simd);
    let wide = Wide::new(simd, triangle);
    let [w0, w1, w2] = faces.by_w;
    let by_w = set(machine, [w0[0], w1[0], w2[0]]);
    if items.is_whole() {
        for (pair, linear) in wide.block(simd, [items.x[0], items.y[0]]).into_iter().enumerate() {
            to.put(machine, 16 * pair, linear, by_w);
        }
        return;
    }
    for at in (0..items.len).step_by(16) {
        let linear = wide.scattered(simd, &items.x[at..at + 16], &items.y[at..at + 16]);
        to.put(machine, at, linear, by_w);
    }
}

/// Linear coordinates get perspective.
struct Perspective<'a, T, const PAGES: usize> {
    items: &'a Items,
    faces: &'a Faces<T>,
    to: &'a mut Located<T>,
}

impl<T: Number, const PAGES: usize> Kernel<T> for Perspective<'_, T, PAGES> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { items, faces, to } = self;
        for at in (0..items.len).step_by(M::LANES) {
            let slots = machine.slots(&items.slots, at);
            let linear = [machine.load(&to.linear[0], at), machine.load(&to.linear[1], at)];
            let by_w = picked::<M, PAGES>(machine, &faces.by_w, slots);
            to.put(machine, at, linear, by_w);
        }
    }
}

impl<T: Number> Located<T> {
    /// Linear coordinates get perspective.
    #[inline(always)]
    fn put<M: Machine<Number = T>>(
        &mut self,
        machine: M,
        at: usize,
        linear: [M::R; 2],
        by_w: Triple<M::R>,
    ) {
        let (weights, w) = with_perspective(machine, linear, by_w);
        machine.store(w, &mut self.w, at);
        machine.store(weights[0], &mut self.weights[0], at);
        machine.store(weights[1], &mut self.weights[1], at);
    }
}

/// m1 = l1 / w1 / (l0 / w0 + l1 / w1 + l2 / w2), and m2 alike; and one by the sum, which is the
/// pixel's own w.
#[inline(always)]
pub(super) fn with_perspective<M: Machine>(
    machine: M,
    [second, third]: [M::R; 2],
    Triple([w0, w1, w2]): Triple<M::R>,
) -> ([M::R; 2], M::R) {
    let w = machine.lift(1.0) / (w0 + second * (w1 - w0) + third * (w2 - w0));
    ([second * w1 * w, third * w2 * w], w)
}

/// Three numbers of the triangles that some pixels show.
#[inline(always)]
fn picked<M: Machine, const PAGES: usize>(
    machine: M,
    [x, y, z]: &[[M::Number; SLOTS]; 3],
    slots: M::Slots,
) -> Triple<M::R> {
    Triple([
        machine.pick::<PAGES>(x, slots),
        machine.pick::<PAGES>(y, slots),
        machine.pick::<PAGES>(z, slots),
    ])
}

/// What the corners carry, at some pixels.
#[inline(always)]
fn mixed<M: Machine, const PAGES: usize>(
    machine: M,
    rows: &[[[M::Number; SLOTS]; 3]; 3],
    slots: M::Slots,
    weights: [M::R; 2],
) -> Triple<M::R> {
    let a = picked::<M, PAGES>(machine, &rows[0], slots);
    let b = picked::<M, PAGES>(machine, &rows[1], slots);
    let c = picked::<M, PAGES>(machine, &rows[2], slots);
    between([a, b, c], weights)
}

/// What the first corner carries, and the weighted differences of the others from it.
#[inline(always)]
pub(super) fn between<R: Real>([a, b, c]: [Triple<R>; 3], [second, third]: [R; 2]) -> Triple<R> {
    a.plus(b.times(second)).plus(c.times(third))
}

/// Where what is mixed goes.
#[derive(Debug)]
pub(super) enum Mixed<'a, T> {
    /// Light.
    Rows(&'a mut Rows<T>),
    /// Colours.
    Colors(&'a mut Colors),
}

/// Mixes what the corners carry at every pixel.
pub(super) fn mix<T: Number>(
    level: Level,
    items: &Items,
    faces: &Faces<T>,
    located: &Located<T>,
    to: Mixed<'_, T>,
) {
    paged!(faces.count, PAGES => T::run(level, Mix::<T, PAGES> { items, faces, located, to }));
}

struct Mix<'a, T, const PAGES: usize> {
    items: &'a Items,
    faces: &'a Faces<T>,
    located: &'a Located<T>,
    to: Mixed<'a, T>,
}

impl<T: Number, const PAGES: usize> Kernel<T> for Mix<'_, T, PAGES> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { items, faces, located, mut to } = self;
        for at in (0..items.len).step_by(M::LANES) {
            let slots = machine.slots(&items.slots, at);
            let weights =
                [machine.load(&located.weights[0], at), machine.load(&located.weights[1], at)];
            let value = mixed::<M, PAGES>(machine, &faces.values, slots, weights);
            match &mut to {
                Mixed::Rows(rows) => store(machine, value, rows, at),
                Mixed::Colors(colors) => colors.store(machine, value, at),
            }
        }
    }
}

/// Place, normal and direction to the observer of every pixel, from normals that the corners carry.
pub(super) fn surroundings<T: Number>(
    level: Level,
    (plan, draw): (&FramePlan, &Draw),
    items: &Items,
    faces: &Faces<T>,
    located: &Located<T>,
    batch: &mut Batch<T>,
) {
    let rays = Rays::new(plan);
    let normals = matrix(draw.view_from_normal);
    let way = plan.ways.rare_roots();
    match (items.shared, way) {
        (true, Some(_)) => {
            let kernel = Surroundings::<T, 4, true> { items, faces, located, batch, rays, normals };
            T::run_by(level, way, kernel);
        }
        (false, Some(_)) => {
            let kernel =
                Surroundings::<T, 4, false> { items, faces, located, batch, rays, normals };
            T::run_by(level, way, kernel);
        }
        (true, None) => paged!(faces.count, PAGES => T::run(
            level,
            Surroundings::<T, PAGES, true> { items, faces, located, batch, rays, normals },
        )),
        (false, None) => paged!(faces.count, PAGES => T::run(
            level,
            Surroundings::<T, PAGES, false> { items, faces, located, batch, rays, normals },
        )),
    }
}

/// The columns of a matrix.
fn matrix<T: Number>(m: DMat3) -> [[T; 3]; 3] {
    [m.x_axis, m.y_axis, m.z_axis].map(|column| column.to_array().map(T::from_f64))
}

/// From a pixel to the way on which its surface lies: x = (column a + b), y = (row c + d), each times
/// w in perspective, where -w is z.
#[derive(Clone, Copy, Debug)]
struct Rays<T> {
    parallel: bool,
    x: [T; 2],
    y: [T; 2],
}

impl<T: Number> Rays<T> {
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    fn new(plan: &FramePlan) -> Self {
        let (px, py) = (plan.clip_from_view.x_axis.x, plan.clip_from_view.y_axis.y);
        let (width, height) = (plan.size.width as f64, plan.size.height as f64);
        let mut x = [2.0 / width / px, -1.0 / px];
        let mut y = [-2.0 / height / py, 1.0 / py];
        // What is looked at lies beside the middle of its pixel.
        for (way, shift) in [&mut x, &mut y].into_iter().zip(plan.shift) {
            if shift != 0 {
                way[1] += way[0] * f64::from(shift) / f64::from(SUBPIXELS);
            }
        }
        let parallel = plan.eye == Eye::Parallel;
        Self { parallel, x: x.map(T::from_f64), y: y.map(T::from_f64) }
    }
}

struct Surroundings<'a, T, const PAGES: usize, const SHARED: bool> {
    items: &'a Items,
    faces: &'a Faces<T>,
    located: &'a Located<T>,
    batch: &'a mut Batch<T>,
    rays: Rays<T>,
    normals: [[T; 3]; 3],
}

impl<T: Number, const PAGES: usize, const SHARED: bool> Kernel<T>
    for Surroundings<'_, T, PAGES, SHARED>
{
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { items, faces, located, batch, rays, normals } = self;
        let [nx, ny, nz] = normals;
        let (nx, ny, nz) = (set(machine, nx), set(machine, ny), set(machine, nz));
        for at in (0..items.len).step_by(M::LANES) {
            let slots = machine.slots(&items.slots, at);
            let weights =
                [machine.load(&located.weights[0], at), machine.load(&located.weights[1], at)];
            let Triple([x, y, z]) = mixed::<M, PAGES>(machine, &faces.values, slots, weights);
            let n = nx.times(x).plus(ny.times(y)).plus(nz.times(z)).unit();
            store(machine, n, &mut batch.normal, at);

            let (one, half) = (machine.lift(1.0), machine.lift(0.5));
            let [column, row] = match SHARED {
                true => {
                    [machine.load(&located.places[0], at), machine.load(&located.places[1], at)]
                }
                false => [machine.whole(&items.x, at) + half, machine.whole(&items.y, at) + half],
            };
            let x = column * machine.set(rays.x[0]) + machine.set(rays.x[1]);
            let y = row * machine.set(rays.y[0]) + machine.set(rays.y[1]);
            if rays.parallel {
                let Triple([z0, z1, z2]) = picked::<M, PAGES>(machine, &faces.z, slots);
                let z = z0 + (z1 - z0) * weights[0] + (z2 - z0) * weights[1];
                store(machine, Triple([x, y, z]), &mut batch.position, at);
                let zero = machine.lift(0.0);
                store(machine, Triple([zero, zero, one]), &mut batch.to_eye, at);
            } else {
                let w = machine.load(&located.w, at);
                store(machine, Triple([x * w, y * w, -w]), &mut batch.position, at);
                store(machine, Triple([-x, -y, one]).unit(), &mut batch.to_eye, at);
            }
        }
    }
}
