//! Every path to a colour interpolates as the setting says, on clipped triangles, too.
//!
//! The oracle is a floor that was cut at the near plane beforehand, with attributes computed at the
//! cut. It needs no clipping, and has to look like the floor that the renderer clips.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]
#![expect(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "small numbers")]

mod common;

use common::{draw, edit, model_of, scene};
use glam::DMat4;
use marraztu_core::accuracy::{
    Arithmetic, Coverage, Filter, Interpolation, LightAt, Samples, Settings, Subpixels,
};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    Material, MaterialChoice, MeshSource, Model, NONE, Object, ObjectId, Scene, Sides,
    SourceCorner, Surface, Texture, View,
};

const FIRST: ObjectId = ObjectId(10);
const SIDE: usize = 160;

/// The eye of the camera, and the distance of the near plane.
const EYE: f64 = 400.0;
const NEAR: f64 = 1.0;

/// A corner of the floor: x and z, and its texture coordinates.
type Corner = ([f64; 2], [f64; 2]);

/// The triangle of the floor, from in front of the observer to behind.
const FLOOR: [Corner; 3] =
    [([-300.0, 0.0], [0.0, 0.0]), ([40.0, 600.0], [10.0, 9.0]), ([300.0, -500.0], [3.0, 14.0])];

/// The floor cut at the near plane, as a fan around the first corner of the polygon: it starts
/// where the edge of the last corner enters.
fn cut() -> Vec<Corner> {
    let inner = |corner: &Corner| EYE - corner.0[1] - NEAR * (1.0 + 1e-6);
    let mut kept = Vec::new();
    for (i, to) in FLOOR.iter().enumerate() {
        let from = &FLOOR[(i + 2) % 3];
        let between = |a: [f64; 2], b: [f64; 2], t: f64| [0, 1].map(|k| a[k] + (b[k] - a[k]) * t);
        let t = inner(from) / (inner(from) - inner(to));
        if (inner(from) >= 0.0) != (inner(to) >= 0.0) {
            kept.push((between(from.0, to.0, t), between(from.1, to.1, t)));
        }
        if inner(to) >= 0.0 {
            kept.push(*to);
        }
    }
    kept
}

/// Builds a floor from a polygon, with colours by uv if asked for.
fn floor(corners: &[Corner], colored: bool) -> Shared<Model> {
    let count = u32::try_from(corners.len()).unwrap();
    let corner = |i| SourceCorner { position: i, uv: i, normal: NONE };
    let fan = (2..count).flat_map(|i| [0, i - 1, i]).map(corner);
    let mut source = MeshSource::of_polygons(fan, vec![3; corners.len() - 2]);
    for ([x, z], uv) in corners {
        source.positions.push([*x as f32, -30.0, *z as f32]);
        source.uvs.push(uv.map(|x| x as f32));
        if colored {
            let [r, g] = uv.map(|x| (x / 14.0) as f32);
            source.colors.push([r, g, 0.5]);
        }
    }
    model_of("floor", source)
}

/// A texture of 16 rows, smooth in both directions, with a hole if asked for.
fn texture(width: usize, has_hole: bool) -> Shared<Texture> {
    let size = Size::new(width, 16);
    let texel = |i: usize| {
        let (x, y) = (i % width * 16 / width, i / width);
        let [red, green] = [x, y].map(|at| u8::try_from(16 * at.min(15 - at) + 64).unwrap());
        [red, green, 120, if has_hole && x < 6 && y < 9 { 0 } else { 255 }]
    };
    let texels = (0..size.area()).map(texel).collect();
    Texture::new("tiles", Picture::from_pixels(size, texels).unwrap()).into()
}

/// A way to draw the floor.
struct Path {
    name: &'static str,
    settings: Settings,
    look: fn(&mut Object),
    colored: bool,
    lit: bool,
}

fn path(name: &'static str, settings: Settings) -> Path {
    let look = |object: &mut Object| object.texture = Some(texture(16, false));
    Path { name, settings, look, colored: false, lit: false }
}

/// The ways to a colour: blocks, lists, corners, layers, holes, and each kind of numbers.
fn paths() -> Vec<Path> {
    let usual = Settings::default();
    let unlit = |object: &mut Object| {
        object.texture = Some(texture(16, false));
        object.surface = Surface::Texture;
    };
    let wide = |object: &mut Object| object.texture = Some(texture(2048, false));
    let holes = |object: &mut Object| object.texture = Some(texture(16, true));
    let clear = |object: &mut Object| {
        object.texture = Some(texture(16, false));
        object.opacity = 0.6;
    };
    vec![
        path("lit texture", usual),
        Path { look: unlit, ..path("unlit texture", usual) },
        Path { look: holes, ..path("holes", usual) },
        Path { look: clear, ..path("transparent", usual) },
        Path { look: |_| (), colored: true, ..path("vertex colours", usual) },
        // More texels than f32 can tell apart.
        Path { look: wide, ..path("many texels", usual) },
        Path { lit: true, ..path("lit by all lights", usual) },
        path("face light", Settings { light: LightAt::Face, ..usual }),
        path("vertex light", Settings { light: LightAt::Vertex, ..usual }),
        path("four samples", Settings { samples: Samples::Four, ..usual }),
        path(
            "four samples, each lit",
            Settings { samples: Samples::Four, light: LightAt::Sample, ..usual },
        ),
        path("f64", Settings { arithmetic: Arithmetic::F64, ..usual }),
        path("mipmaps", Settings { filter: Filter::Trilinear, ..usual }),
        path("12 subpixel bits", Settings { subpixels: Subpixels::Bits12, ..usual }),
        path("f32 edges", Settings { coverage: Coverage::F32Edges, ..usual }),
        path("scan lines", Settings { coverage: Coverage::ScanLines, ..usual }),
    ]
}

/// Draws the floor of these corners, on one path.
fn drawn(corners: &[Corner], path: &Path, interpolation: Interpolation) -> Picture {
    let model = floor(corners, path.colored);
    let (mut scene, view) = scene(&[(model, DMat4::IDENTITY)]);
    edit(&mut scene, FIRST, |object| {
        object.sides = Sides::Two;
        object.material = MaterialChoice::Own(Material::matte([0.7; 3], [0.3; 3]));
        (path.look)(object);
    });
    if !path.lit {
        darken(&mut scene);
    }
    let settings = Settings { interpolation, ..path.settings };
    draw(&scene, &View { marks: false, ..view }, &settings, SIDE)
}

/// Leaves the ambient light alone: other light is not linear along the floor.
fn darken(scene: &mut Scene) {
    scene.lights = scene
        .lights
        .iter()
        .map(|(id, light)| {
            let mut light = light.clone();
            light.on = light.slot == 0;
            light.color = marraztu_core::base::color::Color::WHITE;
            (id, light)
        })
        .collect();
}

/// The share of pixels that differ by more than a few byte steps.
fn apart(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.pixels().iter().zip(b.pixels());
    let differing = pairs.filter(|(a, b)| (0..3).any(|i| a[i].abs_diff(b[i]) > 3));
    differing.count() as f64 / a.pixels().len() as f64
}

#[test]
fn a_triangle_across_the_near_plane_is_affine_on_its_clipped_polygon_in_every_colour_path() {
    for path in paths() {
        let [exact, affine] = [Interpolation::Perspective, Interpolation::Affine]
            .map(|interpolation| drawn(&FLOOR, &path, interpolation));
        let bent = apart(&exact, &affine);
        assert!(bent > 0.1, "{}: only {bent} of the picture is bent", path.name);
        let other = apart(&affine, &drawn(&cut(), &path, Interpolation::Affine));
        assert!(other < 0.01, "{}: {other} differs from the floor cut by hand", path.name);
        let other = apart(&exact, &drawn(&cut(), &path, Interpolation::Perspective));
        assert!(other < 0.02, "{}: {other} differs with perspective", path.name);
    }
}

/// Light at corners is interpolated on the screen, too.
#[test]
fn vertex_light_of_a_clipped_triangle_is_affine() {
    let path = path("", Settings::default());
    let path = Path { lit: true, colored: true, look: |_| (), ..path };
    let settings = Settings { light: LightAt::Vertex, ..path.settings };
    let path = Path { settings, ..path };
    let [exact, affine] = [Interpolation::Perspective, Interpolation::Affine]
        .map(|interpolation| drawn(&FLOOR, &path, interpolation));
    let bent = apart(&exact, &affine);
    assert!(bent > 0.05, "{bent}");
}
