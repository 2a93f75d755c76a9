//! The built-in ball with dimples: a coarse ball with a procedural bump map.

use std::f64::consts::{PI, TAU};

use marraztu_core::base::Shared;
use marraztu_core::base::color::byte;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    FileMaterial, MapKind, Material, Mesh, MeshSource, Model, Part, Smoothing, SourceCorner,
    SurfaceMap, SurfaceMaps, Texture,
};

/// The name of the model in scene files.
pub(super) const NAME: &str = "dimples";

/// Segments about the axis, and rings from pole to pole: few, to make tangents differ strongly
/// between vertices.
const SEGMENTS: u32 = 16;
const RINGS: u32 = 10;
const RADIUS: f64 = 40.0;

/// The size of the bump map in texels.
const TEXELS: Size = Size::new(128, 64);
/// The number of repetitions of the map about the ball.
const REPEATED: [f64; 2] = [4.0, 4.0];
/// The height of a white texel, in texels.
const GAIN: f64 = 20.0;

/// Makes the heights: round hills and pits, with fine grooves across them.
fn heights() -> Picture {
    let mut picture = Picture::filled(TEXELS, [0, 0, 0, 255]);
    for (i, pixel) in picture.pixels_mut().iter_mut().enumerate() {
        let part = |i: usize, side: usize| f64::from(u32::try_from(i).unwrap_or(0)) / side as f64;
        let (u, v) = (part(i % TEXELS.width, TEXELS.width), part(i / TEXELS.width, TEXELS.height));
        let hills = libm::cos(2.0 * TAU * u) * libm::cos(TAU * v);
        let grooves = libm::cos(16.0 * TAU * u);
        let height = byte(0.5 + 0.45 * hills + 0.02 * grooves);
        *pixel = [height, height, height, 255];
    }
    picture
}

/// Builds the ball with its poles on the y axis.
#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
fn source() -> MeshSource {
    let mut source = MeshSource {
        parts: vec![Part { name: NAME.to_owned(), material: Some(0) }],
        smoothing: Smoothing::default(),
        ..MeshSource::default()
    };
    // The seam shares positions but not texture coordinates: there u jumps from 1 to 0.
    for ring in 0..=RINGS {
        let polar = PI * f64::from(ring) / f64::from(RINGS);
        for segment in 0..=SEGMENTS {
            let u = f64::from(segment) / f64::from(SEGMENTS);
            if segment < SEGMENTS {
                let (s, angle) = (libm::sin(polar), TAU * u);
                let at = [s * libm::sin(angle), libm::cos(polar), s * libm::cos(angle)];
                source.positions.push(at.map(|x| (RADIUS * x) as f32));
            }
            let v = 1.0 - f64::from(ring) / f64::from(RINGS);
            source.uvs.push([u as f32, v as f32]);
        }
    }
    let corner = |ring: u32, segment: u32| SourceCorner {
        position: ring * SEGMENTS + segment % SEGMENTS,
        uv: ring * (SEGMENTS + 1) + segment,
        normal: marraztu_core::scene::NONE,
    };
    for (ring, segment) in (0..RINGS).flat_map(|ring| (0..SEGMENTS).map(move |i| (ring, i))) {
        let (a, b) = (corner(ring, segment), corner(ring + 1, segment));
        let (c, d) = (corner(ring + 1, segment + 1), corner(ring, segment + 1));
        // Quads between the rings, triangles at the poles.
        let outline: &[SourceCorner] = match ring {
            0 => &[a, b, c],
            _ if ring + 1 == RINGS => &[a, b, d],
            _ => &[a, b, c, d],
        };
        source.push_polygon(outline);
    }
    source
}

/// Builds the model with its material.
pub(super) fn model() -> Shared<Model> {
    let texture = Texture { scale: REPEATED, ..Texture::new("own:dimples", heights()) };
    let texture = Shared::new(texture);
    let material = Material {
        specular: [0.35; 3],
        exponent: 30.0,
        ..Material::matte([0.1; 3], [0.65, 0.6, 0.5])
    };
    let maps = SurfaceMaps::from([(MapKind::Bump, SurfaceMap { texture, gain: GAIN })]);
    let material = FileMaterial { maps, ..FileMaterial::new(NAME, material) };
    let mesh = Mesh::new(source()).expect("the coordinates are finite");
    Shared::new(Model { materials: vec![material], ..Model::of_mesh(NAME, mesh) })
}
