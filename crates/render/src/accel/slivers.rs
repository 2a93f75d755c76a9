//! Splits the boxes of long, slanting triangles, which are mostly empty.
//!
//! The triangles of a fan, or of a polygon with a thousand corners, lie side by side, but a box
//! around each covers many others: a ray would be tested against a quarter of them. Such a triangle
//! is listed several times, each time with the box of a part of it: Ernst and Greiner, "Early Split
//! Clipping for Bounding Volume Hierarchies", 2007; Karras and Aila, "Fast Parallel Construction of
//! High-Quality Bounding Volume Hierarchies", HPG 2013.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::bvh::BvhTriangle;
use super::eight_boxes::{Box3, EMPTY, union};
use marraztu_core::base::math::each;

/// Boxes are split until their empty parts have no more than this many times the area of the box
/// around all: a ray then meets few boxes in vain. In meshes of even triangles they have less.
const EMPTY_AREA: f64 = 8.0;

/// The most boxes that are added: two for each triangle, and some more for small meshes, but no
/// more than this in all.
const MORE: usize = 1 << 17;
const MOST: usize = 1 << 20;

/// A part of a triangle.
struct Part {
    /// The empty part of the area of its box.
    empty: f64,
    /// The index of the triangle in the list.
    of: usize,
    corners: Vec<DVec3>,
}

impl Part {
    fn new(of: usize, corners: Vec<DVec3>) -> Self {
        Self { empty: empty_area(&corners), of, corners }
    }

    /// Returns the halves on both sides of the middle of its longest side.
    fn halves(&self) -> [Self; 2] {
        let (low, high) = extent(&self.corners);
        let axis = (high - low).max_position();
        let middle = (low[axis] + high[axis]) / 2.0;
        [1.0, -1.0].map(|side| Self::new(self.of, clipped(&self.corners, axis, (middle, side))))
    }

    /// Returns the box in f32, rounded outwards, but not beyond the box of the triangle.
    #[expect(clippy::cast_possible_truncation, reason = "rounded outwards")]
    fn around(&self, [least, most]: Box3) -> Box3 {
        let (low, high) = extent(&self.corners);
        let low = low.to_array().map(|x| (x as f32).next_down());
        let high = high.to_array().map(|x| (x as f32).next_up());
        let inner = |i: usize| [low[i].max(least[i]), high[i].min(most[i])];
        let sides = [0, 1, 2].map(inner);
        [0, 1].map(|end| each(sides, |side| side[end]))
    }
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Part {}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        self.empty.total_cmp(&other.empty).then(other.of.cmp(&self.of))
    }
}

/// Returns whether the boxes of triangles have much empty area.
pub(super) fn have_empty_boxes(all: &[BvhTriangle]) -> bool {
    let around = all.iter().flat_map(|it| it.corners);
    let [low, high] = around.fold(EMPTY, |around, corner| union(around, [corner; 2])).map(double);
    let empty: f64 = all.iter().map(|it| empty_area(&it.corners.map(double))).sum();
    empty > EMPTY_AREA * half_area(high - low)
}

/// Replaces triangles with large empty boxes by parts, the emptiest first.
pub(super) fn split(all: &mut Vec<(Box3, BvhTriangle)>) {
    let [low, high] = all.iter().fold(EMPTY, |around, (own, _)| union(around, *own)).map(double);
    let most = EMPTY_AREA * half_area(high - low);
    let own = |(_, it): &(Box3, BvhTriangle)| empty_area(&it.corners.map(double));
    let mut empty: f64 = all.iter().map(own).sum();
    if empty <= most || !empty.is_finite() {
        return;
    }
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 triangles")]
    let least = most / all.len() as f64;
    let large = all.iter().enumerate().filter(|(_, it)| own(it) > least);
    let large = large.map(|(i, (_, it))| Part::new(i, it.corners.map(double).into()));
    let mut open: BinaryHeap<Part> = large.collect();
    let mut left = (2 * all.len() + MORE).min(MOST);
    let mut is_split = vec![false; all.len()];
    while empty > most
        && left > 0
        && let Some(part) = open.pop()
    {
        is_split[part.of] = true;
        left -= 1;
        empty -= part.empty;
        for half in part.halves().into_iter().filter(|half| !half.corners.is_empty()) {
            empty += half.empty;
            open.push(half);
        }
    }
    let parts = open.into_iter().filter(|part| is_split[part.of]);
    let parts = parts.map(|part| (part.around(all[part.of].0), all[part.of].1));
    let parts: Vec<_> = parts.collect();
    let mut kept = is_split.iter();
    all.retain(|_| !kept.next().copied().unwrap_or(false));
    all.extend(parts);
}

/// Returns the part of a convex polygon on one side of a plane across an axis.
fn clipped(corners: &[DVec3], axis: usize, (at, side): (f64, f64)) -> Vec<DVec3> {
    let beyond = |corner: DVec3| (corner[axis] - at) * side;
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (i, corner) in corners.iter().enumerate() {
        let before = corners[(i + corners.len() - 1) % corners.len()];
        let [from, to] = [before, *corner].map(beyond);
        if from * to < 0.0 {
            let mut crossing = before + (*corner - before) * (from / (from - to));
            crossing[axis] = at;
            kept.push(crossing);
        }
        if to >= 0.0 {
            kept.push(*corner);
        }
    }
    kept
}

/// Returns the area of the box around a convex polygon that it could spare: all but the
/// projections of the polygon on the three planes.
fn empty_area(corners: &[DVec3]) -> f64 {
    let fan = corners.windows(2).skip(1).map(|it| (it[0] - corners[0]).cross(it[1] - it[0]));
    let area = fan.sum::<DVec3>().abs().element_sum() / 2.0;
    let (low, high) = extent(corners);
    half_area(high - low) - area
}

fn extent(corners: &[DVec3]) -> (DVec3, DVec3) {
    let low = corners.iter().fold(DVec3::INFINITY, |low, corner| low.min(*corner));
    (low, corners.iter().fold(DVec3::NEG_INFINITY, |high, corner| high.max(*corner)))
}

fn double(corner: [f32; 3]) -> DVec3 {
    DVec3::from_array(corner.map(f64::from))
}

fn half_area(sides: DVec3) -> f64 {
    sides.x * sides.y + sides.y * sides.z + sides.z * sides.x
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::rng::Rng;

    /// A disk in the plane y = 0 of this number of triangles around its centre.
    fn disk(count: u32) -> Vec<(Box3, BvhTriangle)> {
        let on_rim = |i: u32| {
            let (sin, cos) = libm::sincosf(std::f32::consts::TAU * i as f32 / count as f32);
            [cos, 0.0, sin]
        };
        let triangle = |i| {
            let corners = [[0.0; 3], on_rim(i), on_rim(i + 1)];
            let around = corners.iter().fold(EMPTY, |around, corner| union(around, [*corner; 2]));
            (around, BvhTriangle { corners, number: i })
        };
        (0..count).map(triangle).collect()
    }

    fn holds([low, high]: &Box3, p: DVec3) -> bool {
        (0..3).all(|i| f64::from(low[i]) <= p[i] && p[i] <= f64::from(high[i]))
    }

    #[test]
    fn points_lie_in_few_boxes_of_a_fan_and_each_in_one_of_its_own_triangle() {
        let whole = disk(2000);
        let mut parts = whole.clone();
        split(&mut parts);
        assert!(parts.len() < 60_000, "{}", parts.len());
        let mut rng = Rng::new(1);
        let (mut before, mut after) = (0, 0);
        for _ in 0..2000 {
            let number = rng.index(2000);
            let (_, triangle) = whole[number];
            let [a, b, c] = triangle.corners.map(|it| DVec3::from_array(it.map(f64::from)));
            let [mut u, mut v] = [rng.unit(), rng.unit()];
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let p = a + (b - a) * u + (c - a) * v;
            let own = parts.iter().filter(|(_, it)| it.number == triangle.number);
            assert!(own.clone().any(|(around, _)| holds(around, p)), "{number}: {p}");
            before += whole.iter().filter(|(around, _)| holds(around, p)).count();
            after += parts.iter().filter(|(around, _)| holds(around, p)).count();
        }
        assert!(after * 8 < before, "{before} boxes around each 2000 points, then {after}");
    }

    #[test]
    fn meshes_of_even_triangles_are_left_alone() {
        let corner = |i: u32, j: u32| [i as f32, 0.1 * ((i + j) % 3) as f32, j as f32];
        let mut grid: Vec<(Box3, BvhTriangle)> = Vec::new();
        for (i, j) in (0..20).flat_map(|i| (0..20).map(move |j| (i, j))) {
            for corners in [
                [corner(i, j), corner(i + 1, j), corner(i, j + 1)],
                [corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)],
            ] {
                let around = corners.iter().fold(EMPTY, |all, corner| union(all, [*corner; 2]));
                grid.push((around, BvhTriangle { corners, number: 0 }));
            }
        }
        let before = grid.clone();
        split(&mut grid);
        assert_eq!(grid, before);
    }
}
