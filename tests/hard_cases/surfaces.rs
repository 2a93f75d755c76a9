//! Surfaces: bump mapping, emission, and lighting in linear values.

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{Arithmetic, Filter, LightValues, Samples, Settings, Shot, Tangents};
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    FileMaterial, Light, LightId, LightKind, MapKind, Material, MaterialChoice, Mesh, MeshSource,
    Model, NONE, ObjectId, Part, Scene, SourceCorner, Surface, SurfaceMap, SurfaceMaps, Texture,
    Tracked, View, Wrap,
};
use marraztu_render::plan_frame;

use super::common::{draw, edit, scene};
use super::figures::Figure;

const SIDE: usize = 33;
const DIFFUSE: f64 = 0.8;

/// A grey texture, by column and by row from the top.
fn greys(width: usize, height: usize, of: impl Fn(usize, usize) -> u8) -> Shared<Texture> {
    let texel = |i: usize| {
        let grey = of(i % width, i / width);
        [grey, grey, grey, 255]
    };
    let texels = (0..width * height).map(texel).collect();
    picture(Picture::from_pixels(Size::new(width, height), texels).unwrap(), Wrap::Repeat)
}

fn picture(picture: Picture, wrap: Wrap) -> Shared<Texture> {
    Shared::new(Texture { wrap, ..Texture::new("", picture) })
}

/// A sheet of two squares in the plane z = 0, side by side, with texture coordinates at their
/// corners: lower left first, then counter-clockwise.
fn sheet(uvs: [[[f32; 2]; 4]; 2], maps: SurfaceMaps, material: Material) -> Shared<Model> {
    let positions = [[-1.0, -1.0], [0.0, -1.0], [0.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
    let positions = positions.map(|[x, y]: [f32; 2]| [x * 300.0, y * 300.0, 0.0]).to_vec();
    let corner = |(position, uv)| SourceCorner { position, uv, normal: NONE };
    let source = MeshSource {
        positions,
        uvs: uvs.concat(),
        parts: vec![Part { name: "sheet".to_owned(), material: Some(0) }],
        ..MeshSource::of_polygons(
            [0, 1, 2, 3, 1, 4, 5, 2].into_iter().zip(0..).map(corner),
            vec![4, 4],
        )
    };
    let material = FileMaterial { maps, ..FileMaterial::new("sheet", material) };
    let mesh = Mesh::new(source).unwrap();
    Shared::new(Model { materials: vec![material], ..Model::of_mesh("sheet", mesh) })
}

fn dull() -> Material {
    Material::matte([0.0; 3], [DIFFUSE; 3])
}

/// The sheet in front of the camera, lit by a sun with this direction of travel or unlit.
fn lit(model: Shared<Model>, sun: Option<DVec3>) -> (Scene, View) {
    let (mut scene, view) = scene(&[(model, DMat4::IDENTITY)]);
    edit(&mut scene, ObjectId(10), |object| object.material = MaterialChoice::File);
    let sun = sun.map(|direction| LightKind::Sun { direction: Tracked::new(direction) });
    let light = |kind| (LightId(1), Light::new("sun", 1, kind));
    scene.lights = sun.into_iter().map(light).collect();
    (scene, View { marks: false, light: None, ..view })
}

/// Texture coordinates across a square, from `left` to `right` in u.
const fn across(left: f32, right: f32) -> [[f32; 2]; 4] {
    [[left, 0.0], [right, 0.0], [right, 1.0], [left, 1.0]]
}

fn bump(texture: Shared<Texture>, gain: f64) -> SurfaceMaps {
    SurfaceMaps::from([(MapKind::Bump, SurfaceMap { texture, gain })])
}

/// Every combination of arithmetic and tangents.
fn ways() -> impl Iterator<Item = Settings> {
    let tangents = [Tangents::Vertex, Tangents::Pixel];
    let all = [Arithmetic::F32, Arithmetic::F64].into_iter().flat_map(move |arithmetic| {
        tangents.map(|tangents| Settings { arithmetic, tangents, ..Settings::default() })
    });
    all.collect::<Vec<_>>().into_iter()
}

#[test]
fn case_90_a_bump_on_the_mirrored_half_is_still_a_bump() {
    // Grey rises by 8 from column to column and from row to row: slopes of 8 / 255 per texel.
    let gain = 8.0;
    let slope = gain * 8.0 / 255.0;
    let ramp = greys(16, 16, |column, row| 8 * (column + row) as u8);
    let model = sheet([across(0.0, 1.0), across(1.0, 0.0)], bump(ramp, gain), dull());
    let sun = DVec3::new(-0.48, -0.36, -0.8);
    let (scene, view) = lit(model, Some(sun));
    // Heights rise downwards everywhere, to the right on the left half, and to the left on the
    // mirrored half.
    let light = |across: f64| {
        let normal = DVec3::new(-across, slope, 1.0).normalize_or_zero();
        255.0 * DIFFUSE * normal.dot(-sun)
    };
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    for settings in ways() {
        let picture = draw(&scene, &view, &settings, SIDE);
        for (column, slope) in [(10, slope), (22, -slope)] {
            let [got, ..] = picture.pixel(column, 16);
            ours = ours.max((f64::from(got) - light(slope)).abs());
            naive = naive.max((light(slope.abs()) - light(slope)).abs());
        }
    }
    Figure {
        case: 90,
        what: "the light of a ramp on both halves of a mirrored sheet",
        naive: Some(("tangents along x on both", naive)),
        ours,
        bound: 0.51,
        unit: "byte steps",
    }
    .hold();
}

#[test]
fn case_91_bumps_run_on_across_a_seam() {
    let hills = |wrap| {
        let height =
            |i: usize| (127.5 + 127.5 * (i as f64 / 16.0 * std::f64::consts::TAU).sin()) as u8;
        let texture = greys(16, 16, |column, row| height(column) / 2 + height(row) / 2);
        Shared::new(Texture { wrap, ..Texture::clone(&texture) })
    };
    let picture = |uvs, wrap, settings: &Settings| {
        let sun = DVec3::new(-0.6, -0.64, -0.48);
        let (scene, view) = lit(sheet(uvs, bump(hills(wrap), 6.0), dull()), Some(sun));
        draw(&scene, &view, settings, SIDE)
    };
    // The same texture, once with a seam in the middle and once continuous.
    let (seam, whole) = ([across(0.0, 1.0); 2], [across(0.0, 1.0), across(1.0, 2.0)]);
    let difference = |a: &Picture, b: &Picture| {
        let pairs = a.pixels().iter().zip(b.pixels());
        f64::from(pairs.map(|(a, b)| a[0].abs_diff(b[0])).max().unwrap())
    };
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    for settings in ways() {
        let right = picture(whole, Wrap::Repeat, &settings);
        ours = ours.max(difference(&right, &picture(seam, Wrap::Repeat, &settings)));
        naive = naive.max(difference(&right, &picture(whole, Wrap::Clamp, &settings)));
    }
    Figure {
        case: 91,
        what: "bumps with a seam in the middle against bumps without",
        naive: Some(("heights that end at the border", naive)),
        ours,
        bound: 1.0,
        unit: "byte steps",
    }
    .hold();
}

/// The number of pixels that differ between two pictures.
fn differing(a: &Picture, b: &Picture) -> f64 {
    a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b).count() as f64
}

#[test]
fn case_92_faces_without_texture_area_have_neither_bumps_nor_nan() {
    let noise = greys(8, 8, |column, row| (column * 91 + row * 57) as u8);
    let sun = Some(DVec3::new(-0.48, -0.36, -0.8));
    let flat = [[[0.3, 0.7]; 4]; 2];
    let (mut ours, mut naive) = (0.0, 0.0);
    for settings in ways() {
        let (scene, view) = lit(sheet(flat, SurfaceMaps::new(), dull()), sun);
        let plain = draw(&scene, &view, &settings, SIDE);
        let (scene, view) = lit(sheet(flat, bump(noise.clone(), 5.0), dull()), sun);
        ours += differing(&plain, &draw(&scene, &view, &settings, SIDE));
        // The naive tangent divides by the area in texture space, which is 0: NaN, drawn black.
        let nan = Picture::filled(Size::new(SIDE, SIDE), [0, 0, 0, 255]);
        naive += differing(&plain, &nan);
    }
    Figure {
        case: 92,
        what: "pixels of a surface that is one point on its texture",
        naive: Some(("divided by that area", naive)),
        ours,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn next_to_a_clamped_texture_there_are_no_bumps() {
    let ramp = greys(8, 8, |column, _| (column * 36) as u8);
    let clamped = Shared::new(Texture { wrap: Wrap::Clamp, ..Texture::clone(&ramp) });
    let sun = Some(DVec3::new(-0.48, -0.36, -0.8));
    for (settings, uvs) in ways().flat_map(|way| {
        [[across(-3.0, -1.5), across(-1.5, 0.0)], [across(1.0, 2.5), across(2.5, 4.0)]]
            .map(|uvs| (way, uvs))
    }) {
        let [plain, bumpy] = [SurfaceMaps::new(), bump(clamped.clone(), 5.0)].map(|maps| {
            let (scene, view) = lit(sheet(uvs, maps, dull()), sun);
            draw(&scene, &view, &settings, SIDE)
        });
        assert!(plain == bumpy, "{settings:?}");
    }
}

#[test]
fn case_93_bumps_of_no_height_change_no_bit_and_are_left_out() {
    let noise = greys(8, 8, |column, row| (column * 91 + row * 57) as u8);
    let sun = Some(DVec3::new(-0.48, -0.36, -0.8));
    let uvs = [across(0.0, 1.0), across(1.0, 2.0)];
    let mut ours = 0.0;
    for settings in ways() {
        let (plain, view) = lit(sheet(uvs, SurfaceMaps::new(), dull()), sun);
        let (bumpy, _) = lit(sheet(uvs, bump(noise.clone(), 0.0), dull()), sun);
        let shot = |scene| plan_frame(&Shot::new(scene, &view, &settings, Size::new(SIDE, SIDE)));
        assert_eq!(shot(&plain).keys(), shot(&bumpy).keys());
        let (a, b) = (draw(&plain, &view, &settings, SIDE), draw(&bumpy, &view, &settings, SIDE));
        ours += differing(&a, &b);
    }
    Figure {
        case: 93,
        what: "pixels that -bm 0 changes",
        naive: None,
        ours,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_94_a_flat_map_of_normals_changes_no_byte() {
    let flat = || {
        let texel = Picture::filled(Size::new(4, 4), [128, 128, 255, 255]);
        let map = SurfaceMap { texture: picture(texel, Wrap::Repeat), gain: 1.0 };
        SurfaceMaps::from([(MapKind::Normal, map)])
    };
    let uvs = [across(0.0, 1.0), across(1.0, 0.0)];
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    // 128 decoded as 2 x 128 / 255 - 1.
    let tilted = DVec3::new(1.0 / 255.0, 1.0 / 255.0, 1.0).normalize_or_zero();
    for sun in [DVec3::new(-0.48, -0.36, -0.8), DVec3::new(-0.7, -0.7, -0.141)] {
        let sun = sun.normalize_or_zero();
        naive = naive.max(255.0 * DIFFUSE * (tilted - DVec3::Z).dot(-sun).abs());
        for settings in ways() {
            let (scene, view) = lit(sheet(uvs, SurfaceMaps::new(), dull()), Some(sun));
            let plain = draw(&scene, &view, &settings, SIDE);
            let (scene, view) = lit(sheet(uvs, flat(), dull()), Some(sun));
            ours += differing(&plain, &draw(&scene, &view, &settings, SIDE));
        }
    }
    Figure {
        case: 94,
        what: "what the texel (128, 128, 255) changes",
        naive: Some(("2 c - 1", naive)),
        ours,
        bound: 0.0,
        unit: "byte steps",
    }
    .hold();
}

#[test]
fn case_95_emission_is_as_bright_in_the_dark() {
    let uvs = [across(0.0, 1.0); 2];
    let mut ours = 0.0_f64;
    for (emission, want) in [([1.0; 3], 255), ([0.2; 3], 51), ([7.0; 3], 255), ([0.0; 3], 0)] {
        for settings in ways() {
            let model = sheet(uvs, SurfaceMaps::new(), Material { emission, ..dull() });
            let (scene, view) = lit(model, None);
            let [got, ..] = draw(&scene, &view, &settings, SIDE).pixel(16, 16);
            ours = ours.max((f64::from(got) - f64::from(want)).abs());
        }
    }
    // Emission, also from a map, is added to reflected light: 255 x (0.2 + 0.8 x 0.5).
    let white = SurfaceMap { texture: greys(2, 2, |_, _| 255), gain: 1.0 };
    for maps in [SurfaceMaps::new(), SurfaceMaps::from([(MapKind::Emission, white)])] {
        let model = sheet(uvs, maps, Material { emission: [0.2; 3], ..dull() });
        let (scene, view) = lit(model, Some(DVec3::new(0.0, -0.75_f64.sqrt(), -0.5)));
        for settings in ways() {
            let [got, ..] = draw(&scene, &view, &settings, SIDE).pixel(16, 16);
            ours = ours.max((f64::from(got) - 153.0).abs());
        }
    }
    Figure {
        case: 95,
        what: "Ke without any light, and with some",
        naive: Some(("Ke times the light that arrives", 255.0)),
        ours,
        bound: 0.0,
        unit: "byte steps",
    }
    .hold();
}

/// The byte shown for an unlit texture of this grey.
fn shown(grey: u8, settings: &Settings) -> u8 {
    let (mut scene, view) = lit(sheet([across(0.0, 1.0); 2], SurfaceMaps::new(), dull()), None);
    edit(&mut scene, ObjectId(10), |object| {
        object.surface = Surface::Texture;
        object.texture = Some(greys(2, 2, |_, _| grey));
    });
    draw(&scene, &view, settings, 9).pixel(4, 4)[0]
}

#[test]
fn case_96_every_byte_comes_back_from_linear_light() {
    let mut ours = 0;
    for grey in 0..=255 {
        let linear = Settings { light_values: LightValues::Linear, ..Settings::default() };
        ours += usize::from(shown(grey, &linear) != grey);
        if grey % 16 == 15 || grey == 0 {
            let exact = Settings { arithmetic: Arithmetic::F64, ..linear };
            let four = Settings { samples: Samples::Four, ..linear };
            let many = Settings { samples: Samples::Sixteen, ..linear };
            for settings in [exact, four, many] {
                ours += usize::from(shown(grey, &settings) != grey);
            }
        }
    }
    // Decoded to bytes by the power 2.2, and encoded by its inverse.
    let power = |byte: u8, by: f64| (255.0 * (f64::from(byte) / 255.0).powf(by)).round() as u8;
    let naive = (0..=255).filter(|byte| power(power(*byte, 2.2), 1.0 / 2.2) != *byte).count();
    Figure {
        case: 96,
        what: "bytes that do not survive decoding and encoding",
        naive: Some(("linear values in bytes", naive as f64)),
        ours: ours as f64,
        bound: 0.0,
        unit: "bytes",
    }
    .hold();
}

#[test]
fn case_97_half_of_the_light_is_the_byte_188() {
    let linear = Settings { light_values: LightValues::Linear, ..Settings::default() };
    let mut ours = 0.0_f64;
    // A minified checkerboard.
    let chess = greys(64, 64, |column, row| if (column + row) % 2 == 0 { 255 } else { 0 });
    let (mut scene, view) = lit(sheet([across(0.0, 16.0); 2], SurfaceMaps::new(), dull()), None);
    edit(&mut scene, ObjectId(10), |object| {
        object.surface = Surface::Texture;
        object.texture = Some(chess);
    });
    for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
        let settings = Settings { filter: Filter::Trilinear, arithmetic, ..linear };
        let [got, ..] = draw(&scene, &view, &settings, 9).pixel(2, 4);
        ours = ours.max((f64::from(got) - 188.0).abs());
    }
    // A white sheet covers half of the samples in the middle column, against black.
    let white = Material { emission: [1.0; 3], ..dull() };
    let (mut scene, view) = lit(sheet([across(0.0, 1.0); 2], SurfaceMaps::new(), white), None);
    scene.background = Color::BLACK;
    edit(&mut scene, ObjectId(10), |object| {
        object.placement = Tracked::new(DMat4::from_translation(DVec3::X * 300.0));
    });
    for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
        let [got, ..] = draw(&scene, &view, &Settings { samples, ..linear }, 9).pixel(4, 4);
        ours = ours.max((f64::from(got) - 188.0).abs());
    }
    Figure {
        case: 97,
        what: "the mean of as much black as white",
        naive: Some(("the mean of the bytes", 188.0 - 128.0)),
        ours,
        bound: 0.0,
        unit: "byte steps",
    }
    .hold();
}
