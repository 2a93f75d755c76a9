//! The tangents of a mesh's corners, which orient normal and bump maps.
//!
//! These are the tangents of MikkTSpace, the convention that normal maps are made with, computed by
//! `bevy_mikktspace`: Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008. The arc cosine
//! comes from `libm`, so tangents are the same on every processor.

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};

use crate::base::once::get_or_compute;
use crate::scene::mesh::index;
use crate::scene::{Corner, Mesh, NormalSource};

/// The unit tangents T of a triangle's corners, each with the sign s of the bitangent s N x T; all
/// 0 without texture coordinates.
pub(crate) type CornerTangents = [[f32; 4]; 3];

struct LibmOps;

impl Ops for LibmOps {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

/// The triangles with texture coordinates, as the input of MikkTSpace.
struct WithUvs<'a> {
    mesh: &'a Mesh,
    source: NormalSource,
    /// The triangles' numbers.
    numbers: Vec<u32>,
    tangents: Vec<CornerTangents>,
}

impl WithUvs<'_> {
    fn corner(&self, face: usize, vertex: usize) -> &Corner {
        let corners = self.mesh.triangle(self.numbers[face] as usize);
        &self.mesh.corners()[corners[vertex]]
    }
}

impl Geometry<LibmOps> for WithUvs<'_> {
    fn num_faces(&self) -> usize {
        self.numbers.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vertex: usize) -> [f32; 3] {
        self.mesh.positions()[self.corner(face, vertex).position as usize]
    }

    fn normal(&self, face: usize, vertex: usize) -> [f32; 3] {
        let corner = self.corner(face, vertex);
        let point = match self.source {
            NormalSource::Computed => corner.smooth,
            NormalSource::File => corner.filed,
        };
        self.mesh.points()[point as usize].normal
    }

    fn tex_coord(&self, face: usize, vertex: usize) -> [f32; 2] {
        self.mesh.uvs()[self.corner(face, vertex).uv as usize]
    }

    fn set_tangent(&mut self, found: Option<TangentSpace>, face: usize, vertex: usize) {
        let number = self.numbers[face] as usize;
        // Without a tangent, for example if texture coordinates have no area, the bump is dropped.
        let encoded = found.map_or([0.0; 4], |it| it.tangent_encoded());
        let finite = encoded.iter().all(|x| x.is_finite());
        self.tangents[number][vertex] = if finite { encoded } else { [0.0; 4] };
    }
}

impl Mesh {
    /// Returns the tangents of each triangle's corners, for one kind of normals.
    pub fn tangents(&self, source: NormalSource) -> &[CornerTangents] {
        let cell = match source {
            NormalSource::Computed => &self.found.tangents[0],
            NormalSource::File => &self.found.tangents[1],
        };
        get_or_compute::<Vec<_>>(cell, || {
            let count = self.triangle_count();
            let numbers = (0..index(count)).filter(|number| self.triangle_uvs(*number).is_some());
            let tangents = vec![[[0.0; 4]; 3]; count];
            let mut with_uvs = WithUvs { mesh: self, source, numbers: numbers.collect(), tangents };
            // The error type is an enum without variants.
            let _done = generate_tangents(&mut with_uvs);
            with_uvs.tangents
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MeshSource, SourceCorner};

    /// Builds a square in the plane z = 0. Its second triangle is mirrored on the texture.
    fn square() -> Mesh {
        let corner = |(position, uv)| SourceCorner { position, uv, normal: crate::scene::NONE };
        Mesh::new(MeshSource {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0]],
            ..MeshSource::of_polygons(
                [(0, 0), (1, 1), (2, 2), (0, 0), (2, 2), (3, 3)].map(corner),
                vec![3, 3],
            )
        })
        .unwrap()
    }

    #[test]
    fn tangents_run_along_u_and_signs_tell_mirrored_triangles() {
        let mesh = square();
        let all = mesh.tangents(NormalSource::Computed);
        for [x, y, z, sign] in all[0] {
            assert!((x - 1.0).abs() < 1e-6 && y.abs() < 1e-6 && z.abs() < 1e-6, "{x} {y} {z}");
            assert_eq!(sign, 1.0);
        }
        // u falls along x and rises along y; v rises with u.
        assert!(all[1].iter().all(|corner| corner[3] == -1.0), "{:?}", all[1]);
    }
}
