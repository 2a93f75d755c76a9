//! Triangulates a polygon in the time that it takes to sort its corners.
//!
//! A line sweeps upwards over the corners and divides the polygon by diagonals into monotone
//! pieces. One pass over its corners cuts each piece into triangles. Corners are rounded to 2^-50
//! of the polygon's size; all later steps use integer arithmetic.
//!
//! If the polygon crosses itself, some diagonals are wrong. Diagonals that cross others in the
//! order of the corners are left out, so the number of triangles is the same as for any other
//! polygon.
//!
//! Lee and Preparata, "Location of a Point in a Planar Subdivision and its Applications", SIAM
//! Journal on Computing 1977; Garey, Johnson, Preparata and Tarjan, "Triangulating a Simple
//! Polygon", Information Processing Letters 1978. The names follow de Berg and others,
//! "Computational Geometry", chapter 3.

use glam::DVec2;

use super::number;
use super::status::Status;

/// The bits of a coordinate: products of two differences fit into 128 bits.
const BITS: i32 = 50;

/// Cuts the polygon with the corners `ring` of `flat`, in ascending and counter-clockwise order.
pub(super) fn cut(flat: &[DVec2], ring: &[u32], triangles: &mut Vec<[u32; 3]>) {
    let points = on_a_grid(ring.iter().map(|corner| flat[*corner as usize]).collect());
    let (points, ring) = without_repeats(&points, ring, triangles);
    let sweep = Sweep::new(points);
    let named = |triangle: [u32; 3]| triangle.map(|place| ring[place as usize]);
    for piece in pieces(number(ring.len()), sweep.diagonals()) {
        sweep.cut_piece(&piece, &mut |triangle| triangles.push(named(triangle)));
    }
}

/// The corners of a ring, by their indices in the ring.
struct Sweep {
    points: Vec<[i64; 2]>,
    /// The indices from bottom to top, and from left to right at equal height.
    upwards: Vec<u32>,
    /// The position of each index in `upwards`.
    rank: Vec<u32>,
}

/// The sweep line: the edges that have the polygon on their right. An edge is numbered by its first
/// corner, the upper one.
struct Line {
    edges: Status,
    /// The last corner that the line passed between each edge and the next edge on its right.
    helper: Vec<u32>,
    diagonals: Vec<[u32; 2]>,
}

/// Rounds coordinates to integers.
fn on_a_grid(flat: Vec<DVec2>) -> Vec<[i64; 2]> {
    let extent = flat.iter().fold(0.0, |size: f64, p| size.max(p.abs().max_element()));
    // Scaling by a power of two keeps all digits; only digits below the grid are rounded.
    let scale = libm::scalbn(1.0, BITS - libm::ilogb(extent.max(f64::MIN_POSITIVE)) - 1);
    #[expect(clippy::cast_possible_truncation, reason = "the scale sees to that")]
    let point = |p: DVec2| [libm::rint(p.x * scale) as i64, libm::rint(p.y * scale) as i64];
    flat.into_iter().map(point).collect()
}

/// Drops corners that repeat the one before from a ring and its points. Each dropped corner becomes
/// a triangle without area. At least three corners are kept.
fn without_repeats(
    points: &[[i64; 2]],
    ring: &[u32],
    triangles: &mut Vec<[u32; 3]>,
) -> (Vec<[i64; 2]>, Vec<u32>) {
    let mut kept: Vec<usize> = Vec::with_capacity(ring.len());
    for corner in 0..ring.len() {
        let repeated = kept.last().filter(|last| points[**last] == points[corner]).copied();
        // At least three corners are kept, even if all coincide.
        match repeated {
            Some(last) if kept.len() + ring.len() - corner > 3 => {
                let next = ring.get(corner + 1).unwrap_or(&ring[0]);
                let mut triangle = [ring[last], ring[corner], *next];
                triangle.sort_unstable();
                triangles.push(triangle);
            }
            _ => kept.push(corner),
        }
    }
    // The last corner may repeat the first.
    while let [first, .., before, last] = kept[..]
        && kept.len() > 3
        && points[first] == points[last]
    {
        triangles.push([first, before, last].map(|corner| ring[corner]));
        kept.pop();
    }
    let points = kept.iter().map(|corner| points[*corner]).collect();
    (points, kept.into_iter().map(|corner| ring[corner]).collect())
}

impl Sweep {
    fn new(points: Vec<[i64; 2]>) -> Self {
        let mut upwards: Vec<u32> = (0..number(points.len())).collect();
        let height = |place: &u32| {
            let [x, y] = points[*place as usize];
            (y, x, *place)
        };
        upwards.sort_unstable_by_key(height);
        let mut rank = vec![0; points.len()];
        for (place, corner) in (0..).zip(&upwards) {
            rank[*corner as usize] = place;
        }
        Self { points, upwards, rank }
    }

    fn next(&self, corner: u32) -> u32 {
        if corner + 1 == number(self.points.len()) { 0 } else { corner + 1 }
    }

    fn last(&self, corner: u32) -> u32 {
        if corner == 0 { number(self.points.len()) - 1 } else { corner - 1 }
    }

    fn is_below(&self, a: u32, b: u32) -> bool {
        self.rank[a as usize] < self.rank[b as usize]
    }

    /// Returns twice the area of a triangle, positive if it runs counter-clockwise.
    fn area(&self, a: u32, b: u32, c: u32) -> i128 {
        let [a, b, c] = [a, b, c].map(|corner| self.points[corner as usize].map(i128::from));
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    /// Returns whether a corner is to the right of an edge. If it is on the edge, the other corners
    /// decide.
    fn is_right_of(&self, edge: u32, corners: [u32; 3]) -> bool {
        let lower = self.next(edge);
        let side = |corner: u32| Some(self.area(lower, edge, corner)).filter(|area| *area != 0);
        corners.into_iter().find_map(side).is_none_or(|area| area < 0)
    }

    /// Finds diagonals that divide the ring into monotone pieces.
    fn diagonals(&self) -> Vec<[u32; 2]> {
        let corners = self.points.len();
        let helper = vec![0; corners];
        let mut line = Line { edges: Status::new(corners), helper, diagonals: Vec::new() };
        for &corner in &self.upwards {
            self.pass(corner, &mut line);
        }
        line.diagonals
    }

    /// Moves the line past a corner.
    fn pass(&self, corner: u32, line: &mut Line) {
        let (last, next) = (self.last(corner), self.next(corner));
        let is_reflex = self.area(last, corner, next) < 0;
        match (self.is_below(last, corner), self.is_below(next, corner)) {
            // The outline runs down through the corner: the polygon is on its right.
            (false, true) => {
                self.close(corner, corner, line);
                line.edges.replace(corner, last);
                line.helper[last as usize] = corner;
            }
            // The outline runs up through the corner: the polygon is on its left.
            (true, false) => self.reach_left(corner, Helper::OnlyMerges, line),
            // A piece begins, or one piece is divided into two (a split vertex).
            (false, false) => {
                if is_reflex {
                    self.reach_left(corner, Helper::Any, line);
                }
                let is_left = |edge| self.is_right_of(edge, [corner, last, next]);
                line.edges.insert(last, is_left);
                line.helper[last as usize] = corner;
            }
            // A piece ends, or two pieces become one (a merge vertex).
            (true, true) => {
                self.close(corner, corner, line);
                line.edges.remove(corner);
                if is_reflex {
                    self.reach_left(corner, Helper::OnlyMerges, line);
                }
            }
        }
    }

    /// Returns whether two pieces become one at a corner, i.e. whether it is a merge vertex.
    fn merges(&self, corner: u32) -> bool {
        let (last, next) = (self.last(corner), self.next(corner));
        self.is_below(last, corner)
            && self.is_below(next, corner)
            && self.area(last, corner, next) < 0
    }

    /// Adds a diagonal from a corner to an edge's helper, if the helper is a merge vertex.
    fn close(&self, corner: u32, edge: u32, line: &mut Line) {
        let helper = line.helper[edge as usize];
        if line.edges.holds(edge) && self.merges(helper) {
            line.diagonals.push([corner, helper]);
        }
    }

    /// Makes a corner the helper of the edge on its left.
    fn reach_left(&self, corner: u32, joined: Helper, line: &mut Line) {
        let others = [corner, self.next(corner), self.last(corner)];
        // If no edge is on the left, the polygon crosses itself.
        let Some(edge) = line.edges.last_of(|edge| self.is_right_of(edge, others)) else { return };
        let helper = &mut line.helper[edge as usize];
        let before = std::mem::replace(helper, corner);
        if joined == Helper::Any || self.merges(before) {
            line.diagonals.push([corner, before]);
        }
    }

    /// Cuts a piece with ascending corners into triangles.
    fn cut_piece(&self, piece: &[u32], triangle: &mut dyn FnMut([u32; 3])) {
        let mut sorted = |a: u32, b: u32, c: u32| {
            let mut corners = [a, b, c];
            corners.sort_unstable();
            triangle(corners);
        };
        let Some(upwards) = self.in_one_stretch(piece) else {
            return self.cut_any(piece, &mut sorted);
        };
        // The stack holds corners that still need triangles; they form a concave chain.
        let mut stack: Vec<(u32, Side)> = Vec::new();
        for (i, &(corner, side)) in upwards.iter().enumerate() {
            let top = stack.last().copied();
            match top {
                Some((_, before)) if before != side || i + 1 == upwards.len() => {
                    // On the opposite side, or at the top of the piece, the corner sees the whole
                    // stack.
                    for two in stack.windows(2) {
                        sorted(two[0].0, two[1].0, corner);
                    }
                    stack.clear();
                    stack.extend(top);
                }
                _ => {
                    // On the same side, the corner cuts off triangles while they lie inside the
                    // piece.
                    while let [.., (a, _), (b, _)] = stack[..] {
                        let area = self.area(a, b, corner);
                        if (side == Side::Right && area > 0) || (side == Side::Left && area < 0) {
                            sorted(a, b, corner);
                            stack.pop();
                        } else {
                            break;
                        }
                    }
                }
            }
            stack.push((corner, side));
        }
    }

    /// Sorts the corners of a piece from bottom to top, each with its side; `None` if the piece is
    /// not monotone.
    fn in_one_stretch(&self, piece: &[u32]) -> Option<Vec<(u32, Side)>> {
        let rank = |place: &usize| self.rank[piece[*place] as usize];
        let lowest = (0..piece.len()).min_by_key(rank)?;
        let highest = (0..piece.len()).max_by_key(rank)?;
        let chain = |from: usize, to: usize| {
            let length = (to + piece.len() - from) % piece.len();
            (0..length).map(move |i| piece[(from + i) % piece.len()])
        };
        // In counter-clockwise order, the right side runs up and the left side down.
        let right: Vec<u32> = chain(lowest, highest).collect();
        let mut left: Vec<u32> = chain(highest, lowest).collect();
        left.reverse();
        let ascends = |chain: &[u32]| chain.is_sorted_by(|a, b| self.is_below(*a, *b));
        if !ascends(&right) || !ascends(&left) {
            return None;
        }
        let right = right.into_iter().map(|corner| (corner, Side::Right));
        let left = left.into_iter().map(|corner| (corner, Side::Left));
        let mut all: Vec<(u32, Side)> = right.chain(left).collect();
        all.sort_unstable_by_key(|(corner, _)| self.rank[*corner as usize]);
        Some(all)
    }

    /// Cuts off all corners that turn left, and the rest as a fan. Serves pieces that are not
    /// monotone.
    fn cut_any(&self, piece: &[u32], triangle: &mut dyn FnMut(u32, u32, u32)) {
        let mut stack: Vec<u32> = Vec::new();
        for &corner in piece {
            while let [.., a, b] = stack[..] {
                if self.area(a, b, corner) < 0 {
                    break;
                }
                triangle(a, b, corner);
                stack.pop();
            }
            stack.push(corner);
        }
        for two in stack[1..].windows(2) {
            triangle(stack[0], two[0], two[1]);
        }
    }
}

/// The helpers that a corner is joined with.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Helper {
    Any,
    OnlyMerges,
}

/// One of the two chains of a monotone piece.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

/// Divides a ring of corners by diagonals; if two diagonals cross, one is left out.
fn pieces(corners: u32, mut diagonals: Vec<[u32; 2]>) -> Vec<Vec<u32>> {
    for diagonal in &mut diagonals {
        diagonal.sort_unstable();
    }
    // Sorted by their ends; of diagonals with the same end, the shortest comes first.
    diagonals.sort_unstable_by_key(|[begin, end]| (*end, std::cmp::Reverse(*begin)));
    let mut diagonals = diagonals.into_iter().peekable();
    let mut pieces = Vec::new();
    let mut open: Vec<u32> = Vec::new();
    for corner in 0..corners {
        // A diagonal that ends here cuts off the corners since its beginning. If these were already
        // cut off, it crosses another diagonal and is left out.
        while let Some([begin, _]) = diagonals.next_if(|[_, end]| *end == corner) {
            let Ok(place) = open.binary_search(&begin) else { continue };
            if place + 1 < open.len() {
                let mut piece = open.split_off(place + 1);
                piece.insert(0, begin);
                piece.push(corner);
                pieces.push(piece);
            }
        }
        open.push(corner);
    }
    pieces.push(open);
    pieces.retain(|piece| piece.len() > 2);
    pieces
}
