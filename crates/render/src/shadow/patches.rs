//! Groups the points of a packet by position.
//!
//! The pixels of a block may show surfaces far apart, one in front of another. A box around all of
//! them would be large, and its rays would pass through much of the scene. Points are therefore
//! divided at wide gaps, and each patch of a surface gets a separate box.

use glam::DVec3;

use super::shaft::{Around, POINTS};
use crate::simd::Bits;
use marraztu_core::base::math::each;

/// Points that lie close together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// The points, a bit for each.
    pub(super) points: u64,
    /// A box around the points.
    pub(super) around: Around,
}

/// The largest number of patches in a packet.
const MOST: usize = 8;

/// The number of empty neighbouring sixteenths of a box's length at which it is divided.
const EMPTY: u32 = 4;

/// Divides the first `len` points of a list into patches; the rest of the list repeats the first
/// point. `normal` returns the normal of a point's triangle, if the point lies in one.
#[inline(always)]
pub(super) fn find_patches(
    at: &[[f64; POINTS]; 3],
    len: usize,
    normal: impl Fn(usize) -> Option<DVec3>,
    patches: &mut Vec<Patch>,
) {
    let mut open = vec![u64::MAX >> (POINTS - len)];
    while let Some(points) = open.pop() {
        // The unused end of the list repeats the first point, so a box of all points needs no copy.
        let around = if points.count_ones() as usize == len {
            around(at, points, &normal)
        } else {
            around(&only(at, points), points, &normal)
        };
        // Every patch costs a shaft and a traversal for each caster, so their number is limited.
        let may_be_divided = patches.len() + open.len() + 1 < MOST;
        match may_be_divided.then(|| divided(at, points, &around)).flatten() {
            Some(parts) => open.extend(parts),
            None => patches.push(Patch { points, around }),
        }
    }
}

/// Copies the points of a mask and replaces all others with the first of them.
fn only(at: &[[f64; POINTS]; 3], points: u64) -> [[f64; POINTS]; 3] {
    let first = nth(points, 0);
    let mut some = each([0, 1, 2], |axis: usize| [at[axis][first]; POINTS]);
    for i in Bits(points) {
        for (to, from) in some.iter_mut().zip(at) {
            to[i] = from[i];
        }
    }
    some
}

/// Computes a box around a list of points, aligned with the triangle of a point in the middle or,
/// if that is unknown, with the plane of three points.
#[inline(always)]
fn around(at: &[[f64; POINTS]; 3], points: u64, normal: impl Fn(usize) -> Option<DVec3>) -> Around {
    let count = points.count_ones() as usize;
    let point = |n: usize| {
        let i = nth(points, n);
        DVec3::new(at[0][i], at[1][i], at[2][i])
    };
    // In a full block, these are both ends of the first row and the last pixel.
    let [a, b, c] = [point(0), point(count.min(8) - 1), point(count - 1)];
    let normal = normal(nth(points, count / 2)).unwrap_or_else(|| (b - a).cross(c - a));
    Around::new(at, normal, b - a)
}

/// Returns the points on either side of the first wide gap along their box, if there is one.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 16")]
fn divided(at: &[[f64; POINTS]; 3], points: u64, around: &Around) -> Option<[u64; 2]> {
    let [a, b, c] = around.halves.map(DVec3::length_squared);
    let longest = around.halves[if a >= b && a >= c { 0 } else { usize::from(c > b) + 1 }];
    // The position along the longest edge, from -1 to 1.
    let along = longest / longest.length_squared();
    let offset = 1.0 - around.centre.dot(along);
    let mut places = [0; POINTS];
    for (i, place) in places.iter_mut().enumerate() {
        let x = at[0][i] * along.x + at[1][i] * along.y + at[2][i] * along.z;
        *place = ((x + offset) * 8.0) as u32;
    }
    let taken = Bits(points).fold(0_u32, |taken, i| taken | 1 << places[i].min(15));
    // The sixteenths where a gap begins, between the first and last occupied ones.
    let empty = !taken & 0xffff;
    let gaps = (1..EMPTY).fold(empty, |gaps, i| gaps & empty >> i);
    let below = |bit: u32| (1_u32 << bit) - 1;
    let between = below(taken.checked_ilog2()?) & !below(taken.trailing_zeros());
    let gap = gaps & between;
    if gap == 0 {
        return None;
    }
    let near = Bits(points).filter(|i| places[*i] < gap.trailing_zeros());
    let near = near.fold(0, |near, i| near | 1 << i);
    Some([near, points & !near])
}

/// Returns the index of the n-th set bit of a mask, which must have enough.
fn nth(mask: u64, n: usize) -> usize {
    Bits(mask).nth(n).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::rays::Origins;
    use marraztu_core::base::rng::Rng;

    /// Points on squares of a plane, some columns of each.
    fn origins(squares: &[(DVec3, usize)]) -> Origins {
        let mut origins = Origins::default();
        origins.begin(None, false);
        let points = squares.iter().flat_map(|(at, columns)| {
            (0..8 * columns).map(move |i| at + DVec3::new((i / 8) as f64, (i % 8) as f64, 0.0))
        });
        points.enumerate().for_each(|(i, point)| origins.set(i, point, [0; 2], 0));
        origins
    }

    fn patches(mut origins: Origins) -> Vec<Patch> {
        origins.find_patches(|_, _| Some(DVec3::Z));
        origins.patches
    }

    #[test]
    fn a_surface_is_one_patch_and_surfaces_with_a_gap_between_them_are_two() {
        assert_eq!(patches(origins(&[(DVec3::ZERO, 8)])).len(), 1);
        let far = DVec3::new(40.0, 0.0, -9.0);
        let two = patches(origins(&[(DVec3::ZERO, 5), (far, 3)]));
        let mut points: Vec<u64> = two.iter().map(|patch| patch.points).collect();
        points.sort_unstable();
        assert_eq!(points, [(1 << 40) - 1, u64::MAX << 40]);
        // Neither box is longer than its own points.
        assert!(two.iter().all(|patch| patch.around.extent().max_element() < 4.0));
    }

    #[test]
    fn every_point_is_in_one_patch_and_inside_its_box() {
        let mut rng = Rng::new(11);
        for round in 0..500 {
            let mut origins = Origins::default();
            origins.begin(None, false);
            let len = 1 + rng.index(64);
            let mut number = |range: usize| rng.index(2 * range + 1) as f64 - range as f64;
            for i in 0..len {
                // Clustered points, so gaps of every width occur.
                let cluster = DVec3::new(number(1), number(1), number(1)) * (round % 50) as f64;
                origins.set(i, cluster + DVec3::new(number(9), number(9), number(9)), [0; 2], 0);
            }
            origins.find_patches(|_, _| None);
            assert!(origins.patches.len() <= MOST);
            let mut all = 0;
            for Patch { points, around } in &origins.patches {
                assert!(all & points == 0 && *points != 0, "a point is in two patches");
                all |= points;
                for i in Bits(*points) {
                    let from = origins.point(i) - around.centre;
                    let inside = around
                        .halves
                        .iter()
                        .all(|half| from.dot(*half).abs() <= half.length_squared() * (1.0 + 1e-12));
                    assert!(inside, "a point is outside of its box");
                }
            }
            assert_eq!(all, u64::MAX >> (64 - len));
        }
    }
}
