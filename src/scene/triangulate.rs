//! A polygon as triangles.
//!
//! A fan where it is right, which one look at its triangles tells; else ears are cut off one by
//! one. Every cut takes a triangle's signed area from the ring that is left, so the areas of the
//! triangles sum to the polygon's whatever its shape; that no triangle lies outside the polygon is
//! what the choice of ears is for.
//!
//! The corners are taken from the first one, so that thin polygons far from the origin keep their
//! shape, and seen along the normal: corners of a polygon that is not flat keep their order best so.
//! What is closer together than rounding can tell counts as touching.
//!
//! Ear clipping is Meisters', "Polygons Have Ears", American Mathematical Monthly 1975. A hole that
//! is joined to the outline by a bridge names positions twice; a corner that stands on a corner of
//! the ear blocks it only where it has a side inside the ear.

use std::collections::VecDeque;

use glam::{DVec2, DVec3};

/// How many corners are looked at before the rest is left to a fan: about a quarter of a second.
///
/// Enough for any simple polygon of ten thousand corners; half of them turn inwards at most.
const BUDGET: usize = 50_000_000;

/// Cuts a polygon into triangles, each as three places in `outline`, in its order of rotation.
///
/// `normal` is the polygon's normal; there are `outline.len() - 2` triangles. A polygon that crosses
/// itself gets some, too; one that is not convex and has tens of thousands of corners may end in a
/// fan.
#[must_use]
pub fn triangulate(outline: &[DVec3], normal: DVec3) -> Vec<[u32; 3]> {
    match outline.len() {
        0..3 => Vec::new(),
        3 => vec![[0, 1, 2]],
        _ => {
            let flat = flatten(outline, normal);
            if fan_is_right(&flat) { fan(flat.len()) } else { Ring::new(flat).cut() }
        }
    }
}

/// The corners seen along the normal, counter-clockwise where they are so about it.
fn flatten(outline: &[DVec3], normal: DVec3) -> Vec<DVec2> {
    let (x, y) = normal.any_orthonormal_pair();
    let flat = |p: &DVec3| DVec2::new((*p - outline[0]).dot(x), (*p - outline[0]).dot(y));
    outline.iter().map(flat).collect()
}

/// Twice the area of a triangle, positive where it runs counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether the fan from the first corner has triangles of the right rotation alone. Seen from that
/// corner a simple polygon then turns one way only, and by less than a whole turn.
fn fan_is_right(flat: &[DVec2]) -> bool {
    let tolerance = tolerance(flat);
    flat[1..].windows(2).all(|side| {
        let longest = side[0].abs().max(side[1].abs()).max_element();
        side[0].perp_dot(side[1]) > tolerance * longest
    }) && turns_once(flat)
}

/// Whether no side turns back past a whole turn in all, as those of a star do.
fn turns_once(flat: &[DVec2]) -> bool {
    // From the first corner, directions run through less than half a turn or come back to the
    // first side's other half-plane once.
    let first = flat[1];
    let behind = |p: &DVec2| first.perp_dot(*p) < 0.0;
    flat[2..].iter().skip_while(|p| !behind(p)).all(behind)
}

fn fan(corners: usize) -> Vec<[u32; 3]> {
    (1..number(corners) - 1).map(|i| [0, i, i + 1]).collect()
}

fn number(corners: usize) -> u32 {
    u32::try_from(corners).expect("a mesh numbers its corners with 32 bits")
}

/// What a cross product with a vector of length 1 may be wrong by.
fn tolerance(flat: &[DVec2]) -> f64 {
    let extent = flat.iter().fold(0.0, |size: f64, p| size.max(p.abs().max_element()));
    8.0 * f64::EPSILON * extent
}

/// Which way the outline turns at a corner.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    /// To the left: the corner may be an ear.
    Convex,
    /// Not at all.
    Straight,
    /// To the right: the corner may stand in the way of ears.
    Reflex,
    /// Back onto itself, or a side has no length: nothing is lost with the corner.
    Back,
}

/// How much stands in the way of an ear.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Blocked {
    /// By corners inside it or on its border.
    Touching,
    /// By corners inside it.
    Inside,
}

/// What is left of the outline.
struct Ring {
    flat: Vec<DVec2>,
    next: Vec<u32>,
    last: Vec<u32>,
    turn: Vec<Turn>,
    /// Corners that are not convex, or were not when this list was last swept.
    inward: Vec<u32>,
    /// Corners that may be ears, in the order in which they are looked at: those beside straight
    /// ones, then the others.
    candidates: [VecDeque<u32>; 2],
    gone: Vec<bool>,
    left: usize,
    tolerance: f64,
    looked_at: usize,
}

impl Ring {
    fn new(flat: Vec<DVec2>) -> Self {
        let corners = number(flat.len());
        let mut ring = Self {
            next: (1..corners).chain([0]).collect(),
            last: std::iter::once(corners - 1).chain(0..corners - 1).collect(),
            turn: vec![Turn::Straight; flat.len()],
            inward: Vec::new(),
            candidates: [VecDeque::new(), VecDeque::new()],
            gone: vec![false; flat.len()],
            left: flat.len(),
            tolerance: tolerance(&flat),
            looked_at: 0,
            flat,
        };
        for i in 0..corners {
            ring.turn[i as usize] = ring.turn_at(i);
        }
        ring.inward = (0..corners).filter(|&i| ring.turn[i as usize] != Turn::Convex).collect();
        // Every other corner first: triangles grow evenly in place of a fan of long ones.
        for i in (0..corners).step_by(2).chain((1..corners).step_by(2)) {
            ring.queue(i);
        }
        ring
    }

    /// Cuts ear after ear; three corners, or what nobody has the time for, are a fan.
    fn cut(mut self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.left - 2);
        while self.left > 3 && self.looked_at < BUDGET {
            let ear = self.ear().unwrap_or_else(|| self.forced());
            triangles.push([self.last[ear as usize], ear, self.next[ear as usize]]);
            self.remove(ear);
        }
        let ring: Vec<u32> = self.corners_left().collect();
        triangles.extend(ring[1..].windows(2).map(|side| [ring[0], side[0], side[1]]));
        triangles
    }

    fn corners_left(&self) -> impl Iterator<Item = u32> {
        (0..number(self.flat.len())).filter(|&i| !self.gone[i as usize])
    }

    fn remove(&mut self, ear: u32) {
        let (last, next) = (self.last[ear as usize], self.next[ear as usize]);
        self.next[last as usize] = next;
        self.last[next as usize] = last;
        self.gone[ear as usize] = true;
        self.left -= 1;
        for corner in [last, next] {
            self.turn[corner as usize] = self.turn_at(corner);
        }
        // The ears beside a corner go first where the cut has left it straight.
        let [last, next] = [last, next].map(|i| i as usize);
        for corner in [self.last[last], number(last), number(next), self.next[next]] {
            self.queue(corner);
        }
    }

    fn turn_at(&self, corner: u32) -> Turn {
        let [a, b, c] = self.triangle(corner);
        let (come, go) = (b - a, c - b);
        let cross = come.perp_dot(go);
        let longest = come.abs().max_element() + go.abs().max_element();
        let error = self.tolerance * longest;
        if cross > error {
            Turn::Convex
        } else if cross < -error {
            Turn::Reflex
        } else if come.dot(go) <= 0.0 {
            Turn::Back
        } else {
            Turn::Straight
        }
    }

    /// The places of a corner and its neighbours, in order.
    fn triangle(&self, corner: u32) -> [DVec2; 3] {
        let at = |i: u32| self.flat[i as usize];
        [at(self.last[corner as usize]), at(corner), at(self.next[corner as usize])]
    }

    fn is_straight(&self, corner: u32) -> bool {
        self.turn[corner as usize] == Turn::Straight
    }

    fn queue(&mut self, corner: u32) {
        let i = corner as usize;
        let line = match self.turn[i] {
            // An ear beside a straight corner makes a corner of it that has an ear of its own;
            // cut last, it would leave a triangle without area.
            Turn::Convex if !self.is_straight(self.last[i]) && !self.is_straight(self.next[i]) => 1,
            Turn::Convex | Turn::Back => 0,
            Turn::Straight | Turn::Reflex => return,
        };
        self.candidates[line].push_back(corner);
    }

    /// The next ear of those that are waiting.
    fn ear(&mut self) -> Option<u32> {
        loop {
            let [first, later] = &mut self.candidates;
            let corner = first.pop_front().or_else(|| later.pop_front())?;
            if self.gone[corner as usize] {
                continue;
            }
            let turn = self.turn[corner as usize];
            match turn {
                Turn::Back => return Some(corner),
                Turn::Convex if self.is_free(corner, Blocked::Touching) => return Some(corner),
                _ => {}
            }
        }
    }

    /// Where no corner waits: an ear that others merely touch; else the polygon crosses itself, and
    /// some corner has to go.
    fn forced(&mut self) -> u32 {
        let left: Vec<u32> = self.corners_left().collect();
        self.looked_at += self.flat.len();
        for &i in &left {
            if self.turn[i as usize] == Turn::Convex && self.is_free(i, Blocked::Inside) {
                return i;
            }
        }
        let least = |of: Turn| {
            let size = |i: &u32| {
                let [a, b, c] = self.triangle(*i);
                area(a, b, c).abs()
            };
            let some = left.iter().filter(|&&i| self.turn[i as usize] == of);
            some.copied().min_by(|a, b| size(a).total_cmp(&size(b)))
        };
        least(Turn::Straight)
            .or_else(|| least(Turn::Convex))
            .or_else(|| least(Turn::Reflex))
            .unwrap_or(left[0])
    }

    /// Whether no corner that is left stands in the way of the ear at `corner`.
    fn is_free(&mut self, corner: u32, how: Blocked) -> bool {
        let own = [self.last[corner as usize], corner, self.next[corner as usize]];
        let ear = self.triangle(corner);
        let mut inward = std::mem::take(&mut self.inward);
        // The list is swept where half of it is gone; each sweep is paid by what went.
        let mut stale = 0;
        let blocked = inward.iter().any(|&other| {
            self.looked_at += 1;
            if self.gone[other as usize] || self.turn[other as usize] == Turn::Convex {
                stale += 1;
                return false;
            }
            !own.contains(&other) && self.blocks(ear, other, how)
        });
        if stale > inward.len() / 2 {
            inward.retain(|&i| !self.gone[i as usize] && self.turn[i as usize] != Turn::Convex);
        }
        self.inward = inward;
        !blocked
    }

    fn blocks(&self, [a, b, c]: [DVec2; 3], other: u32, how: Blocked) -> bool {
        let [before, p, after] = self.triangle(other);
        let error = self.tolerance * ((b - a).abs() + (c - b).abs()).max_element();
        let least = area(a, b, p).min(area(b, c, p)).min(area(c, a, p));
        let inside = match how {
            Blocked::Touching => least >= -error,
            Blocked::Inside => least > error,
        };
        if !inside {
            return false;
        }
        // On a corner of the ear: in the way only with a side that goes into it.
        let into = |corner: DVec2, next: DVec2, last: DVec2| {
            [before, after].iter().any(|end| {
                let side = *end - p;
                (next - corner).perp_dot(side) > 0.0 && side.perp_dot(last - corner) > 0.0
            })
        };
        if p == a {
            into(a, b, c)
        } else if p == b {
            into(b, c, a)
        } else if p == c {
            into(c, a, b)
        } else {
            true
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::base::math;
    use crate::scene::newell;

    fn outline(places: &[(f64, f64)]) -> Vec<DVec3> {
        places.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect()
    }

    /// Twice the signed areas of the triangles about `normal`.
    fn areas(outline: &[DVec3], normal: DVec3, triangles: &[[u32; 3]]) -> Vec<f64> {
        let area = |t: &[u32; 3]| newell(t.iter().map(|&i| outline[i as usize])).dot(normal);
        triangles.iter().map(area).collect()
    }

    /// The areas of the triangles, all of them checked to be positive and to sum to the polygon's.
    fn sound(outline: &[DVec3]) -> Vec<f64> {
        let twice = newell(outline.iter().copied());
        let normal = math::unit(twice).unwrap();
        let triangles = triangulate(outline, normal);
        assert_eq!(triangles.len(), outline.len() - 2);
        let areas = areas(outline, normal, &triangles);
        let sum: f64 = areas.iter().sum();
        assert!((sum / twice.length() - 1.0).abs() < 1e-9, "{sum} is not {}", twice.length());
        let worst = areas.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(worst >= -1e-9 * sum, "a triangle of {worst} in a polygon of {sum}");
        areas
    }

    /// A square with a square hole, joined by a bridge from the one's first corner to the other's.
    fn square_with_a_hole() -> Vec<DVec3> {
        outline(&[
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 4.0),
            (0.0, 4.0),
            (0.0, 0.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (3.0, 3.0),
            (3.0, 1.0),
            (1.0, 1.0),
        ])
    }

    #[test]
    fn an_arrow_is_cut_from_its_notch_wherever_its_corners_begin() {
        let mut arrow = outline(&[(0.0, 0.0), (4.0, 0.0), (1.0, 1.0), (0.0, 4.0)]);
        for _ in 0..4 {
            sound(&arrow);
            arrow.rotate_left(1);
        }
    }

    #[test]
    fn a_hole_joined_by_a_bridge_stays_a_hole_seen_from_any_side() {
        let mut ring = square_with_a_hole();
        for turn in 0..ring.len() {
            let turned = math::rotation(DVec3::new(0.6, 0.0, 0.8), turn as f64);
            let placed: Vec<DVec3> = ring.iter().map(|p| turned * *p + DVec3::X * 1e3).collect();
            assert!((sound(&placed).iter().sum::<f64>() - 24.0).abs() < 1e-6);
            ring.rotate_left(1);
        }
    }

    #[test]
    fn corners_in_a_row_leave_no_triangle_without_area() {
        let mut square: Vec<(f64, f64)> = Vec::new();
        for i in 0..4 {
            let t = f64::from(i);
            square.extend([(t, 0.0), (4.0, t), (4.0 - t, 4.0), (0.0, 4.0 - t)]);
        }
        square.sort_by(|a, b| {
            let angle = |p: &(f64, f64)| libm::atan2(p.1 - 2.0, p.0 - 2.0);
            angle(a).total_cmp(&angle(b))
        });
        let mut square = outline(&square);
        for _ in 0..square.len() {
            assert!(sound(&square).iter().all(|area| *area > 0.5));
            square.rotate_left(1);
        }
    }

    #[test]
    fn a_thin_quad_far_from_the_origin_keeps_its_shape() {
        let at = |x: f32, z: f32| DVec3::new(f64::from(x), 0.0, f64::from(z));
        sound(&[
            at(14680.0, 9605.0),
            at(14680.002, 9606.5),
            at(14680.001, 9608.0),
            at(14679.999, 9608.0),
        ]);
    }

    #[test]
    fn a_polygon_that_crosses_itself_has_as_many_triangles_as_any_other() {
        let star: Vec<(f64, f64)> = (0..5)
            .map(|i| f64::from(i) * 2.513_274)
            .map(|a| (libm::cos(a), libm::sin(a)))
            .collect();
        let bow = [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)];
        for places in [&star[..], &bow, &[(1.0, 1.0); 7]] {
            let corners = outline(places);
            let triangles = triangulate(&corners, DVec3::Z);
            assert_eq!(triangles.len(), corners.len() - 2);
            let sum: f64 = areas(&corners, DVec3::Z, &triangles).iter().sum();
            assert!((sum - newell(corners.iter().copied()).z).abs() < 1e-9);
        }
    }

    #[test]
    fn a_million_corners_are_cut_in_no_more_than_seconds() {
        let comb = |i: u32| (f64::from(i), if i.is_multiple_of(2) { 0.0 } else { 1.0 });
        let teeth = (0..1_000_000).map(comb).chain([(1e6, -1.0), (0.0, -1.0)]);
        let corners = outline(&teeth.rev().collect::<Vec<_>>());
        let begin = std::time::Instant::now();
        let triangles = triangulate(&corners, DVec3::NEG_Z);
        assert_eq!(triangles.len(), corners.len() - 2);
        assert!(begin.elapsed().as_secs() < 10, "{:?}", begin.elapsed());
    }

    proptest! {
        /// Polygons that are stars about the origin: simple, and as concave as can be.
        #[test]
        fn simple_polygons_are_cut_into_triangles_inside_them(
            radii in prop::collection::vec(1_u8..=10, 4..80),
            turn in 0.0..6.3_f64,
        ) {
            let sector = 2.0 * std::f64::consts::PI / radii.len() as f64;
            let corner = |(i, r): (usize, &u8)| {
                let angle = sector * i as f64;
                DVec3::new(libm::cos(angle), libm::sin(angle), 0.0) * f64::from(*r)
            };
            let turned = math::rotation(DVec3::new(0.0, 0.6, 0.8), turn);
            let corners: Vec<DVec3> =
                radii.iter().enumerate().map(corner).map(|p| turned * p).collect();
            sound(&corners);
        }

        /// Stairs on a grid: many corners in a row, many that touch the ears' borders.
        #[test]
        fn stairs_are_cut_into_triangles_inside_them(
            heights in prop::collection::vec(1_u8..6, 2..30),
        ) {
            let mut places = vec![(0.0, 0.0)];
            places.extend((0..=heights.len()).skip(1).map(|x| (x as f64, 0.0)));
            for (x, height) in heights.iter().enumerate().rev() {
                let top = f64::from(*height);
                places.extend([((x + 1) as f64, top), (x as f64, top)]);
            }
            sound(&outline(&places));
        }

        /// Any corners at all on a small grid: many fall together, most outlines cross themselves.
        #[test]
        fn areas_sum_to_the_polygons_whatever_its_shape(
            places in prop::collection::vec((0_u8..4, 0_u8..4), 3..24),
        ) {
            let places: Vec<(f64, f64)> =
                places.iter().map(|&(x, y)| (f64::from(x), f64::from(y))).collect();
            let corners = outline(&places);
            let triangles = triangulate(&corners, DVec3::Z);
            prop_assert_eq!(triangles.len(), corners.len() - 2);
            let sum: f64 = areas(&corners, DVec3::Z, &triangles).iter().sum();
            prop_assert!((sum - newell(corners.iter().copied()).z).abs() < 1e-9);
        }
    }
}
