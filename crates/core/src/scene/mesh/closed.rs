//! Decides whether a mesh, or some of its parts, is a closed surface.
//!
//! A closed surface traverses each of its edges as often in one direction as in the other.
//! Therefore the sum over all sides (p, q) of polygons
//!
//! ```text
//!   S = sum  h(p, q),   h(p, q) = -h(q, p)
//! ```
//!
//! is 0 for any such h. If h is a hash of 64 bits, S of an open surface is 0 with a probability of
//! 2^-64. This takes one pass and no table of edges. Corners are compared by position, so a surface
//! that a file splits at seams still counts as closed. Each part has its own sum, and S of several
//! parts is the sum of theirs.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::scene::mesh::outlines::Outlines;

/// The number of polygons that a thread takes at a time.
const SHARE: usize = 4096;

/// Returns S of each of `parts` parts. Parts with a total of 0 form closed surfaces, each with one
/// side outside. If the orientation of a polygon differs from its neighbour's, their edge is
/// traversed twice in one direction, so the surface is open.
pub(super) fn boundaries(
    outlines: &Outlines<'_>,
    polygon_parts: &[u32],
    parts: usize,
    key: impl Fn([f32; 3]) -> u64 + Sync,
) -> Vec<u64> {
    let keys: Vec<u64> = outlines.places.par_iter().map(|place| key(*place)).collect();
    let sums: Vec<AtomicU64> = (0..parts).map(|_| AtomicU64::new(0)).collect();
    polygon_parts.par_chunks(SHARE).enumerate().for_each(|(share, parts)| {
        let mut polygon = share * SHARE;
        // Files list the polygons of a part together, so each run is added at once.
        for run in parts.chunk_by(|a, b| a == b) {
            let own = polygon..polygon + run.len();
            polygon = own.end;
            let sum = own.fold(0, |sum: u64, polygon| {
                sum.wrapping_add(boundary(outlines.vertices(polygon), &keys))
            });
            sums[run[0] as usize].fetch_add(sum, Ordering::Relaxed);
        }
    });
    sums.into_iter().map(AtomicU64::into_inner).collect()
}

/// Returns the sum of the hashes of a polygon's sides.
pub(super) fn boundary(vertices: &[u32], keys: &[u64]) -> u64 {
    let Some(mut from) = vertices.last().map(|last| keys[*last as usize]) else { return 0 };
    let mut sum = 0_u64;
    for vertex in vertices {
        let to = keys[*vertex as usize];
        let side = mixed(from.min(to).wrapping_add(from.max(to).rotate_left(32)));
        // The direction of the side decides the sign, so that h(p, q) = -h(q, p).
        sum = match from.cmp(&to) {
            std::cmp::Ordering::Less => sum.wrapping_add(side),
            std::cmp::Ordering::Greater => sum.wrapping_sub(side),
            std::cmp::Ordering::Equal => sum,
        };
        from = to;
    }
    sum
}

/// Hashes a position. 0 and -0 have the same hash.
pub(super) fn key([x, y, z]: [f32; 3]) -> u64 {
    let bits = |x: f32| u64::from((x + 0.0).to_bits());
    mixed(mixed(bits(x) << 32 | bits(y)) ^ bits(z))
}

/// Hashes a position rounded to multiples of `step`: corners that differ far less are mostly one.
#[expect(clippy::cast_possible_truncation, reason = "rounded to whole steps, saturating")]
pub(super) fn key_in_steps(place: [f32; 3], step: f64) -> u64 {
    let [x, y, z] = place.map(|x| (f64::from(x) / step).round() as i64 as u64);
    mixed(mixed(mixed(x).wrapping_add(y)).wrapping_add(z))
}

/// Applies the mixing function of SplitMix64, a permutation of the 64-bit numbers: Steele, Lea and
/// Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
const fn mixed(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use crate::scene::{Mesh, MeshSource, Part, SourceCorner};

    /// The faces of a cube from -1 to 1, seen from outside.
    const CUBE: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

    fn corner_of_cube(i: u32) -> [f32; 3] {
        [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 })
    }

    fn mesh(positions: Vec<[f32; 3]>, faces: &[[u32; 4]]) -> Mesh {
        Mesh::new(MeshSource {
            positions,
            ..MeshSource::of_polygons(
                faces.iter().flatten().copied().map(SourceCorner::bare),
                vec![4; faces.len()],
            )
        })
        .unwrap()
    }

    fn cube(faces: &[[u32; 4]]) -> Mesh {
        mesh((0..8).map(corner_of_cube).collect(), faces)
    }

    #[test]
    fn a_cube_is_closed_and_a_box_without_lid_is_open() {
        assert!(cube(&CUBE).is_closed());
        for left_out in 0..6 {
            let faces: Vec<_> =
                CUBE.iter().enumerate().filter(|(i, _)| *i != left_out).map(|(_, f)| *f).collect();
            assert!(!cube(&faces).is_closed(), "without face {left_out}");
        }
    }

    #[test]
    fn a_cube_with_a_face_turned_round_is_open() {
        let mut faces = CUBE;
        faces[3].reverse();
        assert!(!cube(&faces).is_closed());
    }

    #[test]
    fn parts_are_closed_by_their_own_polygons() {
        // A cube, its walls and its lid as separate parts, and a sheet next to it.
        let of_cube = CUBE.iter().flatten().copied();
        let corners = of_cube.chain([8, 9, 10, 11]).map(SourceCorner::bare);
        let side = |i: u16| [5.0 + f32::from(i & 1), f32::from(i >> 1), 0.0];
        let positions = (0..8).map(corner_of_cube).chain([0, 1, 3, 2].map(side)).collect();
        let part = Part { name: String::new(), material: None };
        let mesh = Mesh::new(MeshSource {
            positions,
            polygon_parts: vec![0, 2, 0, 0, 0, 0, 1],
            parts: vec![part; 3],
            ..MeshSource::of_polygons(corners, vec![4; 7])
        })
        .unwrap();
        assert!(!mesh.is_closed());
        let closed = [&[1_u32][..], &[0, 1, 2]];
        for hidden in [&[0_u32][..], &[1], &[2], &[0, 1], &[0, 2], &[1, 2], &[0, 1, 2]] {
            let expected = closed.contains(&hidden);
            let without = mesh.is_closed_without(hidden.iter().copied());
            assert_eq!(without, expected, "without {hidden:?}");
        }
    }

    #[test]
    fn a_cube_turned_inside_out_is_closed() {
        let mut faces = CUBE;
        faces.iter_mut().for_each(|face| face.reverse());
        assert!(cube(&faces).is_closed());
    }

    #[test]
    fn faces_that_share_positions_but_no_vertices_are_closed() {
        let positions = CUBE.iter().flatten().map(|i| corner_of_cube(*i)).collect();
        let faces: Vec<[u32; 4]> = (0..6).map(|i| [0, 1, 2, 3].map(|k| 4 * i + k)).collect();
        assert!(mesh(positions, &faces).is_closed());
    }

    #[test]
    fn zero_and_minus_zero_are_one_position() {
        let flat = |x: f32| vec![[x, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [x, 1.0, 0.0]];
        let positions = [flat(0.0), flat(-0.0)].concat();
        assert!(mesh(positions, &[[0, 1, 2, 3], [7, 6, 5, 4]]).is_closed());
    }
}
