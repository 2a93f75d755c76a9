//! The attributes and edge functions of the triangles that a block shows.
//!
//! Each triangle has a slot. Its screen corners and the attributes at its corners (normals, or
//! light of vertices) are fetched once, row after row, which lets the fetches overlap. Then sixteen
//! triangles at a time are prepared for the pixels that gather from them.

use crate::accel::Accelerated as _;
use crate::simd::dispatch;
use fearless_simd::{
    Bytes as _, Level, Simd, SimdBase as _, SimdInt as _, SimdMask as _, f32x16, i32x16, mask32x16,
};
use glam::DVec3;

use super::fragments::Fragments;
use crate::accel::DrawOrder;
use crate::frame::draw::{Back, Draw};
use crate::frame::{Eye, FramePlan};
use crate::raster::vertices::fetch_vertices;
use crate::screen::clip::{Screen, ScreenVertex, faces_observer};
use crate::screen::coverage::{Grid, NARROW_AREA, NARROW_SIDE, Snapped, doubled_area};
use crate::simd::gather::SLOTS;
use crate::simd::{Bits, Kernel, Lanes, Number, Vec3};
use crate::texture::placement::Steps;
use marraztu_core::base::math::each;
use marraztu_core::scene::Normals;

/// The attributes of some triangles of one draw. See the [module](self).
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct TriangleAttributes<T> {
    pub(crate) count: usize,
    /// The number of first slots with triangles of the last list, which are prepared already.
    kept: usize,
    /// Whether the last list has other triangles than the list before.
    pub(crate) are_new: bool,
    /// The triangles' numbers in the mesh.
    pub(crate) numbers: [u32; SLOTS],
    /// Whether the corners were fetched.
    has_corners: bool,
    /// The vertices in the mesh's draw order.
    ids: [[u32; 3]; SLOTS],
    /// x and y of each corner on the screen, in subpixels.
    pub(crate) corners: [[[i32; SLOTS]; 2]; 3],
    /// The attributes of each corner.
    pub(crate) carried: [[[T; 4]; SLOTS]; 3],
    /// The coefficients a, b and c of the second and third edge function at pixels: e = a x + b y +
    /// c, modulo 2^32.
    pub(crate) edges: [[[i32; SLOTS]; 3]; 2],
    /// 1 / the doubled area.
    pub(crate) per_area: [f32; SLOTS],
    /// 1/w of each corner.
    pub(crate) by_w: [[T; SLOTS]; 3],
    /// The attributes of the first corner, and the differences of the second and third from it.
    pub(crate) values: [[[T; SLOTS]; 3]; 3],
    /// z of each corner in view space; only in orthographic projection.
    pub(crate) z: [[T; SLOTS]; 3],
    /// A bit per slot: the triangle is clipped.
    pub(crate) cut: u64,
    /// A bit per slot: its edge functions do not fit 31 bits.
    pub(crate) wide: u64,
    /// A bit per slot: it is a back face.
    pub(crate) back: u64,
    /// The index of the draw in the plan.
    draw: Option<u32>,
    /// The grid of the corners.
    pub(crate) grid: Grid,
    /// The distance between lit samples, in pixels.
    spacing: f64,
    /// For points that rays meet: the steps of the weights across each ray.
    pub(crate) footprints: Vec<Steps>,
}

impl<T: Number> Default for TriangleAttributes<T> {
    fn default() -> Self {
        let row = [T::default(); SLOTS];
        Self {
            count: 0,
            kept: 0,
            are_new: false,
            numbers: [0; SLOTS],
            has_corners: false,
            ids: [[0; 3]; SLOTS],
            corners: [[[0; SLOTS]; 2]; 3],
            carried: [[[T::default(); 4]; SLOTS]; 3],
            edges: [[[0; SLOTS]; 3]; 2],
            per_area: [0.0; SLOTS],
            by_w: [row; 3],
            values: [[row; 3]; 3],
            z: [row; 3],
            cut: 0,
            wide: 0,
            back: 0,
            draw: None,
            grid: Grid::Usual,
            spacing: 1.0,
            footprints: Vec::new(),
        }
    }
}

impl<T> TriangleAttributes<T> {
    /// Returns the slots of new triangles.
    fn new_slots(&self) -> std::ops::Range<usize> {
        self.kept..self.count
    }

    /// Returns a bit for each slot that is not new.
    const fn kept_bits(&self) -> u64 {
        (1 << self.kept) - 1
    }
}

/// Returns whether the inputs of a list of triangles are prefetched. Large models show many
/// triangles in a block, and are not in the near caches. With fewer triangles most data is cached,
/// and prefetching costs 2 to 5% of a frame.
pub(super) const fn asks_ahead(count: usize) -> bool {
    count > SLOTS / 2
}

/// A number type in which attributes are stored.
pub(crate) trait AttributeNumber: Number {
    /// Whether barycentric coordinates are computed from integers in f64, one by one.
    const EXACT: bool;
    /// Fetches the corners, and computes edge functions and 1/w.
    fn prepare(level: Level, attributes: &mut TriangleAttributes<Self>, vertices: &[ScreenVertex]);
}

impl<T: AttributeNumber> TriangleAttributes<T> {
    /// Creates triangles with these corners, for tests.
    #[cfg(test)]
    pub(crate) fn of(level: Level, ids: &[[u32; 3]], vertices: &[ScreenVertex]) -> Self {
        let mut attributes = Self { count: ids.len(), ..Self::default() };
        attributes.ids[..ids.len()].copy_from_slice(ids);
        T::prepare(level, &mut attributes, vertices);
        attributes
    }

    /// Drops the triangles of the last block.
    pub(crate) const fn forget(&mut self) {
        self.draw = None;
    }

    /// Forces the triangles of the last list to be prepared again.
    pub(crate) const fn keep_none(&mut self) {
        self.kept = 0;
    }

    /// Returns whether more triangles may be added to these. With clipped triangles, all are
    /// interpolated more slowly.
    pub(crate) const fn may_go_on(&self) -> bool {
        self.draw.is_some() && self.cut == 0
    }

    /// Sets the triangles of a list, all of one draw with numbers from `base`, with their corners
    /// if an order is given. Returns whether any triangle is new.
    pub(crate) fn take(
        &mut self,
        fragments: &Fragments,
        order: Option<&DrawOrder>,
        draw: u32,
        base: u32,
    ) -> bool {
        let count = fragments.count;
        // Without a branch per triangle, so the comparisons vectorise.
        let differ = |(own, number): (&u32, &u32)| own ^ number.wrapping_sub(base);
        let before = self.numbers[..self.count].iter().zip(&fragments.numbers);
        let goes_on = self.draw == Some(draw)
            && (self.has_corners || order.is_none())
            && self.count <= count
            && before.fold(0, |all, pair| all | differ(pair)) == 0;
        // Triangles at the front of the list that did not change stay prepared.
        self.kept = if goes_on { self.count } else { 0 };
        self.are_new = self.kept != count;
        if !self.are_new {
            return false;
        }
        (self.draw, self.count, self.has_corners) = (Some(draw), count, order.is_some());
        let new = self.kept..count;
        let numbers = &fragments.numbers[new.clone()];
        for (own, number) in self.numbers[new.clone()].iter_mut().zip(numbers) {
            *own = number - base;
        }
        if let Some(order) = order {
            for (ids, number) in self.ids[new.clone()].iter_mut().zip(&self.numbers[new]) {
                *ids = order.vertices_of(*number);
            }
        }
        true
    }

    /// Sets the triangles of a list of points that rays meet. Those in the mask `back` show their
    /// backs.
    pub(crate) fn take_alone(
        &mut self,
        fragments: &Fragments,
        order: &DrawOrder,
        (draw, back): (u32, u64),
    ) {
        self.forget();
        self.take(fragments, Some(order), draw, 0);
        self.are_new = true;
        (self.back, self.cut, self.wide) = (back, 0, 0);
    }

    /// Finds the back faces, if they matter.
    pub(crate) fn find_sides(
        &mut self,
        level: Level,
        draw: &Draw,
        plan: &FramePlan,
        vertices: &[ScreenVertex],
    ) {
        let kept = self.kept_bits();
        self.back &= kept;
        // With back-face culling only front faces get here.
        if draw.back == Back::Culled {
            return;
        }
        let (ids, new) = (&self.ids, self.new_slots());
        let (front, odd) = dispatch!(level, simd => fronts(simd, ids, new, vertices));
        // A mirrored object reverses the winding on the screen.
        let back = if draw.mirrored { front } else { !front };
        self.back |= back & !kept;
        // Clipped and wide triangles are decided one by one.
        for slot in Bits(odd & (u64::MAX >> (SLOTS - self.count.max(1))) & !kept) {
            let front = is_front(self.ids[slot], draw, plan, vertices);
            let back = u64::from(front == draw.mirrored) << slot;
            self.back = self.back & !(1 << slot) | back;
        }
    }

    /// Fetches the corners and prepares them for interpolation.
    pub(crate) fn locate(
        &mut self,
        level: Level,
        draw: &Draw,
        plan: &FramePlan,
        vertices: &[ScreenVertex],
    ) {
        (self.grid, self.spacing) = (plan.raster_mode().grid, plan.spacing);
        T::prepare(level, self, vertices);
        // The screen vertices hold 1/w in f32, and perspective needs no z.
        if !T::EXACT && plan.eye == Eye::Point {
            return;
        }
        // Exact arithmetic and orthographic depth need the positions themselves.
        let order = draw.model.mesh.draw_order();
        let screen = Screen::new(draw.clip_from_object, plan.viewport);
        for (slot, ids) in self.ids[..self.count].iter().enumerate().skip(self.kept) {
            for (corner, vertex) in ids.iter().copied().enumerate() {
                let place = order.position(vertex);
                if T::EXACT {
                    self.by_w[corner][slot] = T::from_f64(1.0 / screen.clip(place)[3]);
                }
                if plan.eye == Eye::Parallel {
                    let place = draw.view_from_object.transform_point3(DVec3::from_array(place));
                    self.z[corner][slot] = T::from_f64(place.z);
                }
            }
        }
    }

    /// Returns the steps of the grid from one lit sample to the next.
    #[inline(always)]
    pub(crate) fn parts_per_sample(&self) -> f64 {
        f64::from(self.grid.parts()) * self.spacing
    }

    /// Prefetches the inputs of [`Self::carry_normals`], if vertices have normals.
    pub(crate) fn prefetch_normals(&self, draw: &Draw) {
        if draw.normals == Normals::Vertex {
            let points = draw.model.mesh.draw_order().points(draw.normal_source);
            self.ids[self.new_slots()].iter().for_each(|ids| points.prefetch(*ids));
        }
    }

    /// Sets the attributes of corners to their normals, reversed on lit back faces.
    pub(crate) fn carry_normals(&mut self, draw: &Draw) {
        let mesh = &draw.model.mesh;
        let order = mesh.draw_order();
        let points = order.points(draw.normal_source);
        for (slot, number) in self.numbers[..self.count].iter().enumerate().skip(self.kept) {
            let normals = match draw.normals {
                // Flat normals: all corners carry the normal of the polygon.
                Normals::Face => {
                    let polygon = mesh.polygon_of(*number);
                    [mesh.polygon_normals()[polygon as usize]; 3]
                }
                Normals::Vertex => {
                    let of = points.of(order, *number, self.ids[slot]);
                    each(of, |point| points.normals[point as usize])
                }
            };
            // Back faces are lit with reversed normals.
            let turn = if self.back >> slot & 1 == 1 { -1.0 } else { 1.0 };
            for (carried, normal) in self.carried.iter_mut().zip(normals) {
                let [x, y, z] = each(normal, |x| T::from_f64(f64::from(x * turn)));
                carried[slot] = [x, y, z, T::default()];
            }
        }
    }

    /// Sets the attributes of corners to the light of their vertices. `light` returns it by vertex,
    /// for the front or the back.
    #[inline(always)]
    pub(crate) fn carry_light(&mut self, draw: &Draw, mut light: impl FnMut(u32, bool) -> [T; 4]) {
        let mesh = &draw.model.mesh;
        let order = mesh.draw_order();
        let points = order.points(draw.normal_source);
        for (slot, number) in self.numbers[..self.count].iter().enumerate().skip(self.kept) {
            // Light is stored by corner with face normals, else by point.
            let places = match draw.normals {
                Normals::Face => mesh.triangles()[*number as usize].corners,
                Normals::Vertex => points.of(order, *number, self.ids[slot]),
            };
            let back = self.back >> slot & 1 == 1;
            for (carried, place) in self.carried.iter_mut().zip(places) {
                carried[slot] = light(place, back);
            }
        }
    }

    /// Prepares the attributes of corners for interpolation.
    pub(crate) fn spread(&mut self, level: Level) {
        T::run(level, Spread(self));
    }

    /// Returns the corners of a triangle among the vertices of its draw.
    fn corners_among(&self, slot: usize, all: &[ScreenVertex]) -> [ScreenVertex; 3] {
        self.ids[slot].map(|id| all[id as usize])
    }

    /// Returns the corners of a triangle on the screen.
    pub(crate) fn corners(&self, slot: usize) -> [Snapped; 3] {
        self.corners.map(|[x, y]| Snapped { x: x[slot], y: y[slot] })
    }
}

/// Computes the first corner's attributes and the differences of the others.
struct Spread<'a, T>(&'a mut TriangleAttributes<T>);

impl<T: Number> Kernel<T> for Spread<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self(attributes) = self;
        for at in attributes.new_slots().step_by(M::LANES) {
            // Groups begin at the first new slot, so the last one may move back to fit in the rows.
            let at = at.min(SLOTS - M::LANES);
            let a = carried(lanes, &attributes.carried[0], at);
            let b = carried(lanes, &attributes.carried[1], at);
            let c = carried(lanes, &attributes.carried[2], at);
            for (rows, value) in attributes.values.iter_mut().zip([a, b.minus(a), c.minus(a)]) {
                lanes.store(value.0[0], &mut rows[0], at);
                lanes.store(value.0[1], &mut rows[1], at);
                lanes.store(value.0[2], &mut rows[2], at);
            }
        }
    }
}

/// Loads the attributes of one corner of some triangles.
#[inline(always)]
fn carried<M: Lanes>(lanes: M, rows: &[[M::Number; 4]; SLOTS], at: usize) -> Vec3<M::R> {
    let [x, y, z, _] = lanes.load_four(rows, at);
    Vec3([x, y, z])
}

/// Gathers three numbers of the triangles that some pixels show.
#[inline(always)]
pub(crate) fn picked<M: Lanes>(
    lanes: M,
    [x, y, z]: &[[M::Number; SLOTS]; 3],
    slots: M::Slots,
) -> Vec3<M::R> {
    Vec3([lanes.pick(x, slots), lanes.pick(y, slots), lanes.pick(z, slots)])
}

impl AttributeNumber for f64 {
    const EXACT: bool = true;

    fn prepare(_: Level, attributes: &mut TriangleAttributes<Self>, vertices: &[ScreenVertex]) {
        attributes.cut &= attributes.kept_bits();
        for slot in attributes.new_slots() {
            let own = attributes.corners_among(slot, vertices);
            let inside = own.iter().all(ScreenVertex::is_inside);
            attributes.cut |= u64::from(!inside) << slot;
            for ([x, y], own) in attributes.corners.iter_mut().zip(own) {
                (x[slot], y[slot]) = (own.at().x, own.at().y);
            }
        }
        // Exact arithmetic computes all other triangles in 64-bit integers, like wide ones.
        attributes.wide = !attributes.cut;
    }
}

impl AttributeNumber for f32 {
    const EXACT: bool = false;

    fn prepare(level: Level, attributes: &mut TriangleAttributes<Self>, vertices: &[ScreenVertex]) {
        let kept = attributes.kept_bits();
        (attributes.cut, attributes.wide) = (attributes.cut & kept, attributes.wide & kept);
        dispatch!(level, simd => prepare(simd, attributes, vertices));
        // Unused slots of the last group have meaningless bits.
        let used = u64::MAX >> (SLOTS - attributes.count.max(1));
        (attributes.cut, attributes.wide) = (attributes.cut & used, attributes.wide & used);
    }
}

/// The largest sides of a bounding box, in subpixels, with a doubled area of at most 31 bits.
const NARROW_BOX: i32 = 1 << 14;

/// Returns a bit mask of the triangles in some slots that face the observer if nothing is mirrored,
/// and a mask of the triangles to be decided one by one.
#[inline(always)]
fn fronts<S: Simd>(
    simd: S,
    ids: &[[u32; 3]; SLOTS],
    slots: std::ops::Range<usize>,
    vertices: &[ScreenVertex],
) -> (u64, u64) {
    let (mut front, mut odd) = (0, 0);
    for at in slots.step_by(16) {
        let at = at.min(SLOTS - 16);
        let [[x0, y0, ..], [x1, y1, ..], [x2, y2, ..]] = corners(simd, &ids[at..], vertices);
        let low = [x0.min(x1).min(x2), y0.min(y1).min(y2)];
        let high = [x0.max(x1).max(x2), y0.max(y1).max(y2)];
        // BEYOND is the smallest integer, so one minimum finds corners beyond the clipping planes.
        let beyond = low[0].simd_eq(ScreenVertex::BEYOND);
        let wide = (high[0] - low[0]).simd_gt(NARROW_BOX) | (high[1] - low[1]).simd_gt(NARROW_BOX);
        // 32 bits are enough for triangles that are not wide.
        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        front |= area.simd_lt(0).to_bitmask() << at;
        odd |= (beyond | wide).to_bitmask() << at;
    }
    (front, odd)
}

/// Returns whether a triangle with these vertices faces the observer if nothing is mirrored.
pub(crate) fn is_front(
    ids: [u32; 3],
    draw: &Draw,
    plan: &FramePlan,
    vertices: &[ScreenVertex],
) -> bool {
    let own = each(ids, |vertex| vertices[vertex as usize]);
    if own.iter().all(ScreenVertex::is_inside) {
        return doubled_area(own.map(|vertex| vertex.at())) < 0;
    }
    // Corners beyond a clipping plane have no screen position, so clip space decides.
    let order = draw.model.mesh.draw_order();
    let screen = Screen::new(draw.clip_from_object, plan.viewport);
    faces_observer(ids.map(|vertex| screen.clip(order.position(vertex))))
}

/// Computes the edge functions of sixteen triangles at a time.
#[inline(always)]
fn prepare<S: Simd>(simd: S, attributes: &mut TriangleAttributes<f32>, vertices: &[ScreenVertex]) {
    for at in attributes.new_slots().step_by(16) {
        let at = at.min(SLOTS - 16);
        let [[x0, y0, _, w0], [x1, y1, _, w1], [x2, y2, _, w2]] =
            corners(simd, &attributes.ids[at..], vertices);
        // Screen corners are kept, because wide triangles and footprints need them.
        for ([own_x, own_y], (x, y)) in
            attributes.corners.iter_mut().zip([(x0, y0), (x1, y1), (x2, y2)])
        {
            x.store_slice(&mut own_x[at..at + 16]);
            y.store_slice(&mut own_y[at..at + 16]);
        }
        for (row, w) in attributes.by_w.iter_mut().zip([w0, w1, w2]) {
            w.bitcast::<f32x16<S>>().store_slice(&mut row[at..at + 16]);
        }
        let edges = Edges::new(attributes.grid, [[x0, y0], [x1, y1], [x2, y2]]);
        attributes.cut |= edges.cut.to_bitmask() << at;
        // Side lengths of clipped triangles are meaningless, so they never count as wide.
        attributes.wide |= (edges.wide.to_bitmask() & !edges.cut.to_bitmask()) << at;
        edges.per_area().store_slice(&mut attributes.per_area[at..at + 16]);
        for (rows, functions) in attributes.edges.iter_mut().zip(edges.functions) {
            for (row, numbers) in rows.iter_mut().zip(functions) {
                numbers.store_slice(&mut row[at..at + 16]);
            }
        }
    }
}

/// The edge functions of sixteen triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edges<S: Simd> {
    /// The coefficients a, b and c of the second and third edge function, as in
    /// [`TriangleAttributes::edges`].
    pub(super) functions: [[i32x16<S>; 3]; 2],
    /// The doubled area: positive for triangles that run clockwise on the screen. Meaningless for
    /// clipped or wide triangles.
    pub(super) area: i32x16<S>,
    /// The mask of clipped triangles.
    pub(super) cut: mask32x16<S>,
    /// The mask of unclipped triangles with edge functions of more than 31 bits.
    pub(super) wide: mask32x16<S>,
}

impl<S: Simd> Edges<S> {
    /// Sets up triangles with these corners, on a grid.
    #[inline(always)]
    pub(super) fn new(grid: Grid, [[x0, y0], [x1, y1], [x2, y2]]: [[i32x16<S>; 2]; 3]) -> Self {
        let beyond = x0.simd_eq(ScreenVertex::BEYOND)
            | x1.simd_eq(ScreenVertex::BEYOND)
            | x2.simd_eq(ScreenVertex::BEYOND);
        // The area in f32 is accurate enough to find triangles that do not fit 31 bits.
        let (ux, uy, vx, vy) = (x1 - x0, y1 - y0, x2 - x0, y2 - y0);
        let rough = ux.to_float::<f32x16<S>>() * vy.to_float::<f32x16<S>>()
            - uy.to_float::<f32x16<S>>() * vx.to_float::<f32x16<S>>();
        let large = rough.simd_gt(NARROW_AREA) | rough.simd_lt(-NARROW_AREA);
        let (low, high) = (ux.min(uy).min(vx).min(vy), ux.max(uy).max(vx).max(vy));
        let wide = large | low.simd_lt(-NARROW_SIDE) | high.simd_gt(NARROW_SIDE);
        // a (x - p.x) + b (y - p.y) with x and y at the centre of a pixel.
        let parts = grid.parts();
        let (half, log2) = (parts / 2, parts.trailing_zeros());
        let (a, b) = (vy, x0 - x2);
        let second = [a << log2, b << log2, a * (half - x2) + b * (half - y2)];
        let (a, b) = (y0 - y1, ux);
        let third = [a << log2, b << log2, a * (half - x0) + b * (half - y0)];
        Self { functions: [second, third], area: ux * vy - uy * vx, cut: beyond, wide }
    }

    /// 1 / the doubled area.
    #[inline(always)]
    pub(super) fn per_area(&self) -> f32x16<S> {
        f32x16::splat(self.area.simd, 1.0) / self.area.to_float::<f32x16<S>>()
    }
}

/// Fetches x, y, depth and 1/w of the corners of the first sixteen triangles of a list. Unused
/// slots name vertices of other draws, so their results are meaningless.
#[inline(always)]
pub(super) fn corners<S: Simd>(
    simd: S,
    ids: &[[u32; 3]],
    vertices: &[ScreenVertex],
) -> [[i32x16<S>; 4]; 3] {
    let ids = &ids[..16];
    [
        fetch_vertices(
            simd,
            vertices,
            #[inline(always)]
            |lane| ids[lane][0],
        ),
        fetch_vertices(
            simd,
            vertices,
            #[inline(always)]
            |lane| ids[lane][1],
        ),
        fetch_vertices(
            simd,
            vertices,
            #[inline(always)]
            |lane| ids[lane][2],
        ),
    ]
}
