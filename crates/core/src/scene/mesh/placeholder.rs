//! A box that replaces a shape with a missing file.
//!
//! The box has no texture coordinates and no file normals, so the object's material shows.

use crate::scene::{Mesh, MeshSource, SourceCorner};

/// The sides of the box that single precision can draw.
const SIDES: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// The corners of each face, counter-clockwise seen from outside. In a corner's number, bit 0 is X,
/// bit 1 is Y and bit 2 is Z.
const FACES: [[u32; 4]; 6] =
    [[4, 5, 7, 6], [1, 0, 2, 3], [5, 1, 3, 7], [0, 4, 6, 2], [6, 7, 3, 2], [0, 1, 5, 4]];

impl Mesh {
    /// Builds a cube of this side around the origin, as a replacement for a missing file.
    pub fn placeholder(side: f64) -> Self {
        let half = side.clamp(*SIDES.start(), *SIDES.end()) / 2.0;
        let along = |corner: u32, bit: u32| if corner >> bit & 1 == 1 { half } else { -half };
        let position = |corner: u32| {
            glam::DVec3::new(along(corner, 0), along(corner, 1), along(corner, 2))
                .as_vec3()
                .to_array()
        };
        let corners = FACES.as_flattened().iter().copied().map(SourceCorner::bare);
        let source = MeshSource {
            positions: (0..8).map(position).collect(),
            ..MeshSource::of_polygons(corners, vec![4; FACES.len()])
        };
        let mesh = Self::new(source).expect("every index of a box is in range");
        Self { is_placeholder: true, ..mesh }
    }

    /// Returns whether the mesh is a box that replaces a missing file.
    pub const fn is_placeholder(&self) -> bool {
        self.is_placeholder
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::scene::Crease;

    #[test]
    fn a_placeholder_is_a_closed_box_of_the_wanted_size_and_stays_one_with_another_crease() {
        let mesh = Mesh::placeholder(3.0);
        assert_eq!(mesh.bounds().map(|bounds| bounds.extent()), Some(DVec3::splat(3.0)));
        assert_eq!(mesh.mean(), DVec3::ZERO);
        assert!(mesh.is_closed());
        let other = mesh.with_crease(Crease::new(120.0).unwrap());
        assert!(mesh.is_placeholder() && other.is_placeholder());
        for side in [0.0, f64::MAX, 1e-300] {
            assert!(Mesh::placeholder(side).is_placeholder());
        }
    }
}
