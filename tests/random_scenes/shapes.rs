//! Shapes, materials and textures for random scenes.

use std::sync::OnceLock;

use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::once::get_or_compute;
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    FileMaterial, MapKind, Material, Mesh, MeshSource, Model, NONE, Optics, Part, Reflection,
    SourceCorner, SurfaceMap, SurfaceMaps, Texture, Transmission, Undrawn, Wrap,
};

/// Coefficients on both sides of the thresholds for leaving terms out.
const COEFFICIENTS: [f64; 8] =
    [0.0, -0.0, 5e-324, 1e-45, f32::MIN_POSITIVE as f64, 1.0 / 255.0, 0.4, 1.0];

/// The shapes.
pub(crate) fn shapes() -> &'static [Shared<Model>] {
    static SHAPES: OnceLock<Vec<Shared<Model>>> = OnceLock::new();
    get_or_compute::<Vec<_>>(&SHAPES, || {
        vec![triangle(), square(), cube(), ball(4), two_parts(), colored(), ball(7)]
    })
}

fn model(name: &str, mut source: MeshSource, materials: Vec<FileMaterial>) -> Shared<Model> {
    for part in source.parts.iter_mut().filter(|part| part.name.is_empty()) {
        name.clone_into(&mut part.name);
    }
    let mesh = Mesh::new(source).expect("these shapes are meshes");
    Shared::new(Model { materials, ..Model::of_mesh(name, mesh) })
}

fn triangle() -> Shared<Model> {
    let source = MeshSource {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]],
        ..MeshSource::of_polygons([0, 1, 2].map(SourceCorner::bare), vec![3])
    };
    model("triangle", source, Vec::new())
}

/// A square that faces +Z, with texture coordinates.
fn square_source() -> MeshSource {
    let textured = |i| SourceCorner { position: i, uv: i, normal: NONE };
    MeshSource {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        uvs: vec![[0.0, 0.0], [1.5, 0.0], [1.5, 1.0], [0.0, 1.0]],
        ..MeshSource::of_polygons([0, 1, 2, 3].map(textured), vec![4])
    }
}

fn square() -> Shared<Model> {
    model("square", square_source(), Vec::new())
}

fn cube() -> Shared<Model> {
    let side = |i: u32, bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
    let source = MeshSource {
        positions: (0..8).map(|i| [1, 2, 4].map(|bit| side(i, bit))).collect(),
        ..MeshSource::of_polygons(
            [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5]
                .map(SourceCorner::bare),
            vec![4; 6],
        )
    };
    model("cube", source, Vec::new())
}

#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
fn ball(rings: u32) -> Shared<Model> {
    let segments = 2 * rings;
    let mut positions = vec![[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for segment in 0..segments {
            let angle = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let (s, c) = (libm::sin(polar), libm::cos(polar));
            positions.push([s * libm::sin(angle), c, s * libm::cos(angle)].map(|x| x as f32));
        }
    }
    let at = |ring: u32, segment: u32| 2 + (ring - 1) * segments + segment % segments;
    let mut corners = Vec::new();
    for segment in 0..segments {
        corners.extend([0, at(1, segment), at(1, segment + 1)].map(SourceCorner::bare));
        corners.extend(
            [1, at(rings - 1, segment + 1), at(rings - 1, segment)].map(SourceCorner::bare),
        );
        for ring in 1..rings - 1 {
            let (a, b, c) = (at(ring, segment), at(ring + 1, segment), at(ring + 1, segment + 1));
            corners.extend([a, b, c, a, c, at(ring, segment + 1)].map(SourceCorner::bare));
        }
    }
    let triangles = corners.len() / 3;
    let source = MeshSource { positions, ..MeshSource::of_polygons(corners, vec![3; triangles]) };
    model("ball", source, Vec::new())
}

/// Two squares, one behind the other, with two materials: one dull, one half transparent.
fn two_parts() -> Shared<Model> {
    let one = square_source();
    let behind = one.positions.iter().map(|[x, y, z]| [x + 0.5, y + 0.25, z - 0.5]);
    let source = MeshSource {
        positions: one.positions.iter().copied().chain(behind).collect(),
        corners: (0..8).map(|i| SourceCorner { position: i, uv: i % 4, normal: NONE }).collect(),
        arities: vec![4, 4],
        polygon_parts: vec![0, 1],
        parts: ["front", "back"]
            .into_iter()
            .zip(0..)
            .map(|(name, i)| Part { name: name.to_owned(), material: Some(i) })
            .collect(),
        ..one
    };
    let dull = Material::matte([0.1; 3], [0.7, 0.4, 0.2]);
    let shiny =
        Material { specular: [0.9; 3], exponent: 20.0, ..Material::matte([0.0; 3], [0.0; 3]) };
    let shiny = FileMaterial { opacity: 0.6, ..FileMaterial::new("shiny", shiny) };
    model("two parts", source, vec![FileMaterial::new("dull", dull), shiny])
}

/// A tetrahedron with a colour at each vertex.
fn colored() -> Shared<Model> {
    let source = MeshSource {
        positions: vec![[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]],
        colors: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]],
        ..MeshSource::of_polygons(
            [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3].map(SourceCorner::bare),
            vec![3; 4],
        )
    };
    model("tetrahedron", source, Vec::new())
}

/// A random material; coefficients of 0 are frequent.
pub(crate) fn material(rng: &mut Rng) -> Material {
    let mut row = || match rng.index(4) {
        0 => [0.0; 3],
        1 => [rng.unit(), rng.unit(), rng.unit()],
        _ => [0; 3].map(|_| rng.one_of(&COEFFICIENTS)),
    };
    let (ambient, diffuse, specular) = (row(), row(), row());
    let exponent = rng.one_of(&[0.0, 1.0, 5.0, 32.0, 128.0, 1000.0]);
    let emission =
        if rng.percent(70) { [0.0; 3] } else { [0; 3].map(|_| rng.one_of(&[0.0, 0.2, 3.0])) };
    let optics = optics(rng);
    Material { ambient, diffuse, specular, exponent, emission, optics }
}

/// Random mirrors and refraction; most materials have neither.
fn optics(rng: &mut Rng) -> Optics {
    if rng.percent(90) {
        return Optics::NONE;
    }
    Optics {
        reflection: rng.one_of(&Reflection::ALL),
        transmission: rng.one_of(&[
            Transmission::None,
            Transmission::Opacity,
            Transmission::Filter([0.9, 1.0, 0.4]),
        ]),
        index: rng.one_of(&[1.0, 1.33, 1.5, 0.7]),
    }
}

/// Random maps, each present with a random probability.
pub(crate) fn maps(rng: &mut Rng) -> SurfaceMaps {
    let mut maps = SurfaceMaps::new();
    for kind in MapKind::ALL {
        if rng.percent(35) {
            let texture = texture(rng);
            maps.insert(kind, SurfaceMap { texture, gain: rng.one_of(&[0.0, 1.0, -2.5]) });
        }
    }
    maps
}

/// A sheet of two squares, one with mirrored texture coordinates, with random maps.
pub(crate) fn mapped(rng: &mut Rng) -> Shared<Model> {
    let one = square_source();
    let behind = one.positions.iter().map(|[x, y, z]| [x + 0.5, y + 0.25, z - 0.5]);
    let mirrored = [1, 0, 3, 2];
    let uv = |i: u32| if i < 4 { i } else { mirrored[i as usize - 4] };
    let source = MeshSource {
        positions: one.positions.iter().copied().chain(behind).collect(),
        corners: (0..8).map(|i| SourceCorner { position: i, uv: uv(i), normal: NONE }).collect(),
        arities: vec![4, 4],
        polygon_parts: vec![0, 0],
        parts: vec![Part { name: "mapped".to_owned(), material: Some(0) }],
        ..one
    };
    let file = FileMaterial {
        name: "mapped".to_owned(),
        material: material(rng),
        opacity: rng.one_of(&[1.0, 1.0, 0.7]),
        texture: rng.percent(50).then(|| texture(rng)),
        maps: maps(rng),
        unlit: rng.percent(10),
        multiplies_colors: true,
        undrawn: Undrawn::new(),
        environment: None,
        undrawn_maps: Vec::new(),
    };
    model("mapped", source, vec![file])
}

/// A texture of a few texels, with or without holes.
pub(crate) fn texture(rng: &mut Rng) -> Shared<Texture> {
    let side = rng.one_of(&[1, 2, 5]);
    let alphas: &[u8] = if rng.percent(50) { &[255] } else { &[0, 127, 128, 255] };
    let mut texel = || {
        let byte = |rng: &mut Rng| rng.one_of(&[0_u8, 1, 100, 255]);
        [byte(rng), byte(rng), byte(rng), rng.one_of(alphas)]
    };
    let texels = (0..side * side).map(|_| texel()).collect();
    let picture = Picture::from_pixels(Size::new(side, side), texels).expect("as many as it has");
    let wrap = rng.one_of(&[Wrap::Repeat, Wrap::Clamp]);
    Texture { wrap, ..Texture::new("", picture) }.into()
}
