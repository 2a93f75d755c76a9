//! Cuts a polygon into triangles.
//!
//! If one pass shows that a fan is valid, the fan is used; else ears are cut off one by one. Each
//! cut takes a triangle's signed area from the remaining ring, so the areas of the triangles sum to
//! the polygon's area for any shape. The choice of ears keeps triangles inside the polygon.
//!
//! Corners are stored relative to the first one, so thin polygons far from the origin keep their
//! shape. They are projected along the normal, which keeps the order of the corners if the polygon
//! is not flat. Points closer together than the rounding error count as touching.
//!
//! The search for ears may take quadratic time. For more than a thousand corners it is limited, and
//! a sweep line (`sweep`) cuts the rest into slimmer triangles.
//!
//! Ear clipping follows Meisters, "Polygons Have Ears", American Mathematical Monthly 1975. A
//! bridge between a hole and the outline visits positions twice, so a corner at the position of a
//! corner of the ear does not block it.

mod grid;
mod status;
mod sweep;

use std::collections::VecDeque;

use glam::{DVec2, DVec3};

use self::grid::Grid;

/// The largest number of corners for which the search for ears is not limited.
const FEW: usize = 1000;

/// The number of corners and cells that may be visited for each corner beyond [`FEW`].
const LOOKS: usize = 16;

/// Cuts a polygon into triangles, each as three indices into `outline`, with its orientation.
///
/// `normal` is the polygon's normal. There are `outline.len() - 2` triangles, even if the polygon
/// crosses itself.
pub fn triangulate(outline: &[DVec3], normal: DVec3) -> Vec<[u32; 3]> {
    Triangulator::default().cut(outline.iter().copied(), normal).to_vec()
}

/// Cuts polygons one after the other, reusing memory.
#[derive(Debug, Default)]
pub(super) struct Triangulator {
    /// The corners projected along the normal. Their orientation about the normal is kept.
    flat: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
}

impl Triangulator {
    /// Cuts a polygon like [`triangulate`].
    pub(super) fn cut(
        &mut self,
        mut outline: impl ExactSizeIterator<Item = DVec3>,
        normal: DVec3,
    ) -> &[[u32; 3]] {
        self.triangles.clear();
        self.flat.clear();
        match outline.len() {
            0..3 => {}
            3 => self.triangles.push([0, 1, 2]),
            _ => {
                // Project the corners, relative to the first one, onto a plane across the normal.
                let (x, y) = normal.any_orthonormal_pair();
                let origin = outline.next().unwrap_or_default();
                let flat = |p: DVec3| DVec2::new((p - origin).dot(x), (p - origin).dot(y));
                self.flat.push(flat(origin));
                self.flat.extend(outline.map(flat));
                if fan_is_right(&self.flat) {
                    let last = number(self.flat.len()) - 1;
                    self.triangles.extend((1..last).map(|i| [0, i, i + 1]));
                } else {
                    self.triangles = Ring::new(std::mem::take(&mut self.flat)).cut();
                }
            }
        }
        &self.triangles
    }
}

/// Returns twice the area of a triangle, positive if it runs counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Returns whether all triangles of the fan from the first corner have the right orientation. Seen
/// from that corner, a simple polygon then turns one way only, and by less than a full turn.
fn fan_is_right(flat: &[DVec2]) -> bool {
    let tolerance = tolerance(flat);
    flat[1..].windows(2).all(|side| {
        let longest = side[0].abs().max(side[1].abs()).max_element();
        side[0].perp_dot(side[1]) > tolerance * longest
    }) && turns_once(flat)
}

/// Returns whether the directions from the first corner span less than a full turn, unlike those of
/// a star.
fn turns_once(flat: &[DVec2]) -> bool {
    // In less than a full turn, directions enter the half-plane behind the first side once and stay
    // there.
    let first = flat[1];
    let behind = |p: &DVec2| first.perp_dot(*p) < 0.0;
    flat[2..].iter().skip_while(|p| !behind(p)).all(behind)
}

fn number(corners: usize) -> u32 {
    u32::try_from(corners).expect("a mesh numbers its corners with 32 bits")
}

/// Returns the error bound of a cross product with a vector of length 1.
fn tolerance(flat: &[DVec2]) -> f64 {
    let extent = flat.iter().fold(0.0, |size: f64, p| size.max(p.abs().max_element()));
    8.0 * f64::EPSILON * extent
}

/// The turn of the outline at a corner.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    /// A left turn: the corner may be an ear.
    Convex,
    /// No turn.
    Straight,
    /// A right turn: the corner may block ears.
    Reflex,
    /// A turn back, or a side without length: the corner can be cut off without loss.
    Back,
}

/// The corners that block an ear.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Blocked {
    /// Corners inside the ear or on its border.
    Touching,
    /// Corners inside the ear.
    Inside,
}

/// The remaining outline.
struct Ring {
    flat: Vec<DVec2>,
    next: Vec<u32>,
    last: Vec<u32>,
    turn: Vec<Turn>,
    /// Corners that are not convex, or were not at the last visit.
    inward: Grid,
    /// Corners that may be ears, in the order of the search.
    candidates: VecDeque<u32>,
    gone: Vec<bool>,
    left: usize,
    tolerance: f64,
    looked_at: usize,
    /// The number of corners and cells that may be visited.
    budget: usize,
}

impl Ring {
    fn new(flat: Vec<DVec2>) -> Self {
        let corners = number(flat.len());
        let mut ring = Self {
            next: (1..corners).chain([0]).collect(),
            last: std::iter::once(corners - 1).chain(0..corners - 1).collect(),
            turn: vec![Turn::Straight; flat.len()],
            inward: Grid::default(),
            candidates: VecDeque::new(),
            gone: vec![false; flat.len()],
            left: flat.len(),
            tolerance: tolerance(&flat),
            looked_at: 0,
            budget: FEW * flat.len().min(FEW) + LOOKS * flat.len().saturating_sub(FEW),
            flat,
        };
        for i in 0..corners {
            ring.turn[i as usize] = ring.turn_at(i);
        }
        let inward = (0..corners).filter(|&i| ring.turn[i as usize] != Turn::Convex);
        ring.inward = Grid::new(inward.map(|i| (i, ring.flat[i as usize])).collect());
        // Every second corner comes first, so triangles grow evenly instead of forming a fan of
        // long ones.
        for i in (0..corners).step_by(2).chain((1..corners).step_by(2)) {
            ring.queue(i);
        }
        ring
    }

    /// Cuts off ears, and leaves the rest to a sweep if that takes too long.
    fn cut(&mut self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.left - 2);
        while self.left > 3
            && let Some(ear) = self.ear().or_else(|| self.forced())
        {
            self.cut_off(ear, &mut triangles);
        }
        if self.left > 3 {
            self.cut_off_what_turns_back(&mut triangles);
        }
        let ring: Vec<u32> = self.corners_left().collect();
        match ring[..] {
            [a, b, c] => triangles.push([a, b, c]),
            _ => sweep::cut(&self.flat, &ring, &mut triangles),
        }
        triangles
    }

    /// Cuts off corners without extent. A sweep cannot tell them from slits.
    fn cut_off_what_turns_back(&mut self, triangles: &mut Vec<[u32; 3]>) {
        let turns_back = |ring: &Self, corner: u32| ring.turn[corner as usize] == Turn::Back;
        self.candidates = self.corners_left().filter(|corner| turns_back(self, *corner)).collect();
        while let Some(corner) = self.candidates.pop_front() {
            if self.left > 3 && turns_back(self, corner) && !self.gone[corner as usize] {
                self.cut_off(corner, triangles);
            }
        }
    }

    fn cut_off(&mut self, ear: u32, triangles: &mut Vec<[u32; 3]>) {
        triangles.push([self.last[ear as usize], ear, self.next[ear as usize]]);
        self.remove(ear);
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
            let now = self.turn_at(corner);
            let before = std::mem::replace(&mut self.turn[corner as usize], now);
            // This happens only if the outline crosses itself.
            if before == Turn::Convex && now != Turn::Convex {
                self.inward.add(corner, self.flat[corner as usize]);
            }
            self.queue(corner);
        }
    }

    fn turn_at(&self, corner: u32) -> Turn {
        let [a, b, c] = self.triangle(corner);
        let (come, go) = (b - a, c - b);
        let cross = come.perp_dot(go);
        let longest = come.abs().max_element() + go.abs().max_element();
        // Turns within the rounding error are neither left nor right.
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

    /// Returns the positions of a corner and its neighbours, in order.
    fn triangle(&self, corner: u32) -> [DVec2; 3] {
        let at = |i: u32| self.flat[i as usize];
        [at(self.last[corner as usize]), at(corner), at(self.next[corner as usize])]
    }

    fn queue(&mut self, corner: u32) {
        if matches!(self.turn[corner as usize], Turn::Convex | Turn::Back) {
            self.candidates.push_back(corner);
        }
    }

    /// Returns whether the search for ears has reached its limit.
    const fn is_spent(&self) -> bool {
        self.looked_at >= self.budget
    }

    /// Returns the next ear among the candidates.
    fn ear(&mut self) -> Option<u32> {
        while !self.is_spent() {
            let corner = self.candidates.pop_front()?;
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
        None
    }

    /// Finds an ear that other corners merely touch, after the candidates have run out. Without
    /// such an ear, the polygon crosses itself, and any corner is returned. `None` if the search
    /// has reached its limit.
    fn forced(&mut self) -> Option<u32> {
        let left: Vec<u32> = self.corners_left().collect();
        self.looked_at += left.len() * if self.flat.len() > FEW { 4 } else { 1 };
        for &i in &left {
            if self.is_spent() {
                return None;
            }
            if self.turn[i as usize] == Turn::Convex && self.is_free(i, Blocked::Inside) {
                return Some(i);
            }
        }
        // The polygon crosses itself: prefer the corner with the smallest triangle.
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
            .or(left.first().copied())
    }

    /// Returns whether the ear at `corner` is free of other remaining corners.
    fn is_free(&mut self, corner: u32, how: Blocked) -> bool {
        let own = [self.last[corner as usize], corner, self.next[corner as usize]];
        let ear = self.triangle(corner);
        let mut inward = std::mem::take(&mut self.inward);
        let mut looked_at = 0;
        let blocked = inward.any(self.reach(ear), &mut |other| {
            looked_at += 1;
            // Removed and convex corners never block an ear, so they leave the grid.
            if self.gone[other as usize] || self.turn[other as usize] == Turn::Convex {
                return None;
            }
            Some(!own.contains(&other) && self.blocks(ear, other, how))
        });
        self.looked_at += looked_at + inward.cells_looked_at();
        self.inward = inward;
        !blocked
    }

    /// Returns a box that contains every corner that may block an ear, including rounding errors.
    ///
    /// Each side of the ear moves outwards by at most error / length, so the ear grows about the
    /// centre of its inscribed circle by that over the circle's radius.
    fn reach(&self, [a, b, c]: [DVec2; 3]) -> [DVec2; 2] {
        let lengths = [a.distance(b), b.distance(c), c.distance(a)];
        let shortest = lengths.into_iter().fold(f64::INFINITY, f64::min);
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let radius = area(a, b, c) / (lengths[0] + lengths[1] + lengths[2]);
        let grown = 2.0 * longest * self.error([a, b, c]) / (shortest * radius);
        // An ear without area may be touched from anywhere.
        let grown = if grown.is_finite() { grown.abs() } else { f64::INFINITY };
        [a.min(b).min(c) - grown, a.max(b).max(c) + grown]
    }

    /// Returns the error bound of the area of a triangle with a side of the ear.
    fn error(&self, [a, b, c]: [DVec2; 3]) -> f64 {
        self.tolerance * ((b - a).abs() + (c - b).abs()).max_element()
    }

    fn blocks(&self, [a, b, c]: [DVec2; 3], other: u32, how: Blocked) -> bool {
        let p = self.flat[other as usize];
        let error = self.error([a, b, c]);
        let least = area(a, b, p).min(area(b, c, p)).min(area(c, a, p));
        let inside = match how {
            Blocked::Touching => least >= -error,
            Blocked::Inside => least > error,
        };
        if !inside {
            return false;
        }
        // A corner at the position of a corner of the ear belongs to a bridge, or the outline
        // touches itself there. Its sides lead away from the ear, or to corners that block the ear
        // themselves.
        p != a && p != b && p != c
    }
}

#[cfg(test)]
mod tests;
