//! Builds a mesh from its source, and checks it.
//!
//! Threads share each long list by ranges. The result does not depend on the number of threads.

use rayon::prelude::*;

use crate::base::Shared;
use crate::scene::mesh::cache::{Found, FoundOfShape};
use crate::scene::mesh::points::{Computed, points_and_corners};
use crate::scene::mesh::{Shape, index, mean, used};
use crate::scene::{
    Bounds, CornerLists, Crease, Mesh, MeshError, MeshSource, NONE, Smoothing, SourceCorner,
};

impl Mesh {
    /// Checks the parts, triangulates the polygons and computes their normals.
    ///
    /// # Errors
    /// If a number is not finite, an index is out of range, or a list has the wrong length.
    pub fn new(mut source: MeshSource) -> Result<Self, MeshError> {
        let corners = std::mem::take(&mut source.corners);
        let list = |some: fn(&SourceCorner) -> u32| -> Vec<u32> {
            if corners.iter().any(|corner| some(corner) != NONE) {
                corners.iter().map(some).collect()
            } else {
                Vec::new()
            }
        };
        let corners = CornerLists {
            positions: corners.iter().map(|corner| corner.position).collect(),
            uvs: list(|corner| corner.uv),
            normals: list(|corner| corner.normal),
        };
        Self::from_lists(source, corners)
    }

    /// Builds a mesh like [`Self::new`], from corners in lists, which take less memory. The corners
    /// of `source` are ignored.
    ///
    /// # Errors
    /// The same as [`Self::new`].
    pub fn from_lists(source: MeshSource, corners: CornerLists) -> Result<Self, MeshError> {
        check(&source, &corners)?;
        let starts = running_sum(&source.arities);
        let triangles_only = corners.positions.len() == 3 * source.arities.len();
        // The mean depends on the order of its terms, so one thread computes it while others do the
        // rest.
        let ((computed, corner_points), (unused, bounds, mean)) = rayon::join(
            || points_and_corners(&source, &corners, &starts),
            || {
                let unused = unused(&source, &corners.positions);
                let positions = || used(&source.positions, &unused);
                let (bounds, mean) = (Bounds::of(positions()), mean(positions()));
                (unused, bounds, mean)
            },
        );
        let shape = Shape {
            offset: source.offset,
            unused,
            bounds,
            mean,
            without_area: computed.without_area,
            positions: source.positions,
            colors: source.colors,
            uvs: source.uvs,
            corners: corners.positions,
            corner_uvs: corners.uvs,
            starts,
            polygon_parts: source.polygon_parts,
            strokes: source.strokes,
            parts: source.parts,
            part_names: source.part_names,
            found: FoundOfShape::default(),
        };
        Ok(Self {
            shape: Shared::new(shape),
            smoothing: source.smoothing,
            points: computed.points,
            corners: corner_points,
            triangles_only,
            is_placeholder: false,
            found: Found::default(),
        })
    }

    /// Copies the mesh with another crease angle. The copy shares everything but the normals. A
    /// mesh with smoothing groups keeps them and ignores the angle.
    #[must_use]
    pub fn with_crease(&self, crease: Crease) -> Self {
        let smoothing = match &self.smoothing {
            Smoothing::Crease(_) => Smoothing::Crease(crease),
            groups @ Smoothing::Groups(_) => groups.clone(),
        };
        let outlines = self.outlines();
        let computed = Computed::of(&outlines, self.positions().len(), &smoothing);
        let (points, corners) =
            self.corners.with_computed(&self.points, computed, outlines.corners);
        Self {
            shape: self.shape.clone(),
            smoothing,
            points,
            corners,
            triangles_only: self.triangles_only,
            is_placeholder: self.is_placeholder,
            found: Found::default(),
        }
    }

    /// Returns whether `other` is the same mesh up to the crease angle; see [`Self::with_crease`].
    pub fn shares_shape_with(&self, other: &Self) -> bool {
        Shared::same(&self.shape, &other.shape)
    }
}

/// Finds the vertices that no corner and no stroke refers to, in ascending order.
fn unused(source: &MeshSource, corners: &[u32]) -> Vec<u32> {
    let mut is_used = vec![false; source.positions.len()];
    for vertex in corners.iter().chain(source.strokes.iter().flat_map(|stroke| &stroke.ends)) {
        is_used[*vertex as usize] = true;
    }
    (0..).zip(is_used).filter(|(_, is_used)| !is_used).map(|(vertex, _)| vertex).collect()
}

/// Returns the starts of consecutive lists with these lengths, and the end of the last list.
fn running_sum(counts: &[u32]) -> Vec<u32> {
    let mut sums = Vec::with_capacity(counts.len() + 1);
    let mut sum = 0;
    sums.push(sum);
    for count in counts {
        sum += count;
        sums.push(sum);
    }
    sums
}

/// Checks that every index is in range and every number finite.
fn check(source: &MeshSource, corners: &CornerLists) -> Result<(), MeshError> {
    let room = |what, length: usize| {
        // A vertex may need one point per corner, and NONE is reserved.
        if length < NONE as usize / 4 { Ok(()) } else { Err(MeshError::TooMany(what)) }
    };
    room("vertices", source.positions.len())?;
    room("corners", corners.positions.len())?;
    room("lines and points", source.strokes.len())?;
    let length = |what, right: bool| if right { Ok(()) } else { Err(MeshError::Length(what)) };
    let all: u64 = source.arities.iter().map(|&n| u64::from(n)).sum();
    let right = |list: &[u32]| list.is_empty() || list.len() as u64 == all;
    length("corners", corners.positions.len() as u64 == all)?;
    length("corners", right(&corners.uvs) && right(&corners.normals))?;
    length("parts of polygons", source.polygon_parts.len() == source.arities.len())?;
    if let Smoothing::Groups(groups) = &source.smoothing {
        length("smoothing groups", groups.len() == source.arities.len())?;
    }
    length("colours", [0, source.positions.len()].contains(&source.colors.len()))?;
    let finite = |what, right: bool| if right { Ok(()) } else { Err(MeshError::NotFinite(what)) };
    // Threads check numbers in parts: rayon looks for an early exit after each item, and that takes
    // longer than checking one number.
    const PART: usize = 4096;
    let all =
        |numbers: &[f32]| numbers.par_chunks(PART).all(|part| part.iter().all(|x| x.is_finite()));
    finite("positions", source.offset.is_finite() && all(source.positions.as_flattened()))?;
    finite("colours", all(source.colors.as_flattened()))?;
    finite("normals", all(source.normals.as_flattened()))?;
    finite("places on the texture", all(source.uvs.as_flattened()))?;
    if let Some(short) = source.arities.iter().position(|&n| n < 3) {
        return Err(MeshError::Short(index(short)));
    }
    let within = |what, list: &[u32], length: usize, optional: bool| {
        let wrong = |i: &&u32| **i as usize >= length && !(optional && **i == NONE);
        match list.par_chunks(PART).find_map_first(|part| part.iter().find(wrong)) {
            Some(wrong) => Err(MeshError::Index(what, *wrong)),
            None => Ok(()),
        }
    };
    within("vertex", &corners.positions, source.positions.len(), false)?;
    within("place on the texture", &corners.uvs, source.uvs.len(), true)?;
    within("normal", &corners.normals, source.normals.len(), true)?;
    within("part", &source.polygon_parts, source.parts.len(), false)?;
    let strokes = || source.strokes.iter();
    let ends: Vec<u32> = strokes().flat_map(|stroke| stroke.ends).collect();
    within("vertex", &ends, source.positions.len(), false)?;
    let parts: Vec<u32> = strokes().map(|stroke| stroke.part).collect();
    within("part", &parts, source.parts.len(), false)
}
