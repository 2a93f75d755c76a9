//! Interpolation of values between corners.

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{Arithmetic, Filter, LightAt, Settings};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Material, MaterialChoice, MeshSource, ObjectId, SourceCorner, Surface, Texture, View, Wrap,
};
use marraztu_lab::pictures::flat::{self, Flat};
use marraztu_render::Renderer;
use marraztu_render::screen::coverage::{SUBPIXELS, Snapped};

use super::clipping::{ruler, textured};
use super::common::{draw, edit, model, model_of, scene};
use super::depth::planar;
use super::figures::Figure;
use super::oracle::{Eye, inside_by, meet};

const SIDE: usize = 256;

/// Distance in texels between a shown texel and a position on the repeating ruler. Errors below
/// half a texel are invisible and count as 0.
fn texels_off(u: f64, scale: f64, shown: u8) -> f64 {
    let off = (u * scale).fract() * 256.0 - (f64::from(shown) + 0.5);
    (off.rem_euclid(256.0).min((-off).rem_euclid(256.0)) - 0.5).max(0.0)
}

#[test]
fn case_37_a_texture_lies_still_on_a_wall_that_runs_away() {
    // A wall from 2.2 to 100 in front of the eye, 1024 texels long.
    let wall = |x: f64, y: f64, z: f64| DVec3::new(x, y, 400.0 - z).as_vec3().as_dvec3();
    let corners = [wall(-0.9, -0.8, 2.2), wall(30.0, -9.0, 100.0), wall(-0.9, 0.9, 2.2)];
    let u = [0.0_f32, 1.0, 0.0];
    let settings = Settings { filter: Filter::Nearest, ..Settings::default() };
    let (scene, view) = textured(corners, u, &ruler(64.0));
    let picture = draw(&scene, &view, &settings, SIDE);
    let eye = Eye::first(SIDE);
    let places = corners.map(|corner| eye.pixel(corner));
    let (mut ours, mut affine, mut pixels) = (0.0_f64, 0.0_f64, 0);
    // u at a pixel, by ray casting and by areas on the screen (affine).
    let exact = |x: usize, y: usize| meet(eye.at, eye.ray(x, y), corners);
    let by_area = |x: usize, y: usize| {
        let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let at = [x as f64 + 0.5, y as f64 + 0.5];
        area(places[0], at, places[2]) / area(places[0], places[1], places[2])
    };
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let Some((_, parts)) = exact(x, y) else { continue };
        if inside_by(parts) < 1e-4 {
            continue;
        }
        pixels += 1;
        ours = ours.max(texels_off(parts[1], 64.0, picture.pixel(x, y)[0]) / 16.0);
        affine = affine.max((by_area(x, y) - parts[1]).abs() * 1024.0);
    }
    assert!(pixels > 100, "{pixels}");
    // Corners are snapped to 1/256 pixel, which moves the texture by up to 1/512 pixel. The bound
    // is that shift at the far end of the wall, in texels.
    Figure {
        case: 37,
        what: "texture on a wall from z 2.2 to 100, against affine",
        naive: Some(("affine", affine)),
        ours,
        bound: 0.5,
        unit: "texels of 1024",
    }
    .hold();
}

#[test]
fn case_38_colours_stay_within_the_colours_of_the_corners() {
    let mut rng = Rng::new(38);
    let (mut beyond, mut naive, mut pixels) = (0, 0.0_f64, 0);
    for _ in 0..400 {
        let side = SIDE as i32 * SUBPIXELS;
        let mut corner = || Snapped { x: rng.between(-999, side), y: rng.between(-999, side) };
        let (p, q) = (corner(), corner());
        // A third corner next to the first makes a sliver, and colours one byte apart leave no
        // slack.
        let beside = Snapped { x: p.x + rng.between(-2, 2), y: p.y + rng.between(-2, 2) };
        let corners = [p, q, beside];
        let bytes = [0, 1, 2].map(|_| rng.between(100, 101));
        let within = bytes[0].min(bytes[1]).min(bytes[2])..=bytes[0].max(bytes[1]).max(bytes[2]);
        let colors = bytes.map(|byte| [byte as f32 / 255.0; 3]);
        let picture = painted(corners, colors, SIDE);
        let channel = colors.map(|color| color[0]);
        for (i, pixel) in picture.pixels().iter().enumerate() {
            if pixel[..3] == [0; 3] {
                continue;
            }
            pixels += 1;
            beyond +=
                usize::from(pixel[..3].iter().any(|byte| !within.contains(&i32::from(*byte))));
            let planar = planar(corners, channel, (i % SIDE) as i32, (i / SIDE) as i32);
            let (least, most) = (f64::from(*within.start()), f64::from(*within.end()));
            naive = naive.max(least - planar * 255.0).max(planar * 255.0 - most);
        }
    }
    assert!(pixels > 100, "{pixels}");
    Figure {
        case: 38,
        what: "pixels of slivers with colours beyond their corners'",
        naive: Some(("a plane equation in f32: byte steps beyond", naive)),
        ours: beyond as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

/// Draws a triangle on the test stage with a colour at each corner.
fn painted(corners: [Snapped; 3], colors: [[f32; 3]; 3], side: usize) -> Picture {
    let (mut scene, view) = flat::scene(&[vec![Flat::new(corners)]], side);
    let source = MeshSource {
        positions: corners.map(|c| flat::place(c, 512.0, side).as_vec3().to_array()).to_vec(),
        colors: colors.to_vec(),
        ..MeshSource::of_polygons([0, 1, 2].map(SourceCorner::bare), vec![3])
    };
    edit(&mut scene, ObjectId(1), |object| object.model = model_of("painted", source));
    flat::draw(&(scene, view), side, &mut Renderer::default())
}

#[test]
fn case_39_places_beyond_the_texture_are_brought_back_into_it() {
    // Two texels: the shown colour tells which half of the texture was sampled.
    let texture = |wrap: Wrap| {
        let texels = vec![[10, 0, 0, 255], [20, 0, 0, 255]];
        let picture = Picture::from_pixels(Size::new(2, 1), texels).unwrap();
        Shared::new(Texture { wrap, ..Texture::new("", picture) })
    };
    let corners = [(-90.0, -90.0), (90.0, -90.0), (0.0, 90.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let mut wrong = 0;
    for (u, repeated, held) in [
        (-0.25_f32, 20, 10),
        (-3.75, 10, 10),
        (1.0, 10, 20),
        (0.5, 20, 20),
        (1e4, 10, 20),
        (-1e4 - 0.25, 20, 10),
        (1e30, 10, 20),
        (f32::MAX, 10, 20),
        (-f32::MAX, 10, 10),
        (f32::MIN_POSITIVE, 10, 10),
        (-1e-45, 20, 10),
    ] {
        for (wrap, expected) in [(Wrap::Repeat, repeated), (Wrap::Clamp, held)] {
            for filter in crate::FILTERS {
                let (scene, view) = textured(corners, [u; 3], &texture(wrap));
                let settings = Settings { filter, ..Settings::default() };
                let byte = draw(&scene, &view, &settings, 32).pixel(16, 16)[0];
                // Filters may return any mixture of the two texels.
                let right = match filter {
                    Filter::Nearest => byte == expected,
                    Filter::Bilinear | Filter::Trilinear | Filter::Anisotropic => {
                        (10..=20).contains(&byte)
                    }
                };
                // -1e-45 is indistinguishable from the border at 1, where either texel is right.
                wrong += usize::from(!right && u != -1e-45);
            }
        }
    }
    // 32-bit integers overflow, and the texel is arbitrary.
    let by_i32 = |u: f32| 10 + 10 * ((u * 2.0) as i32 & 1);
    let naive = [(-0.25_f32, 20), (-3.75, 10), (-1e4 - 0.25, 20), (1e30, 10), (f32::MAX, 10)]
        .into_iter()
        .filter(|(u, want)| by_i32(*u) != *want)
        .count();
    let mut source = MeshSource { uvs: vec![[f32::NAN, 0.0]], ..MeshSource::default() };
    source.positions = vec![[0.0; 3]];
    assert!(
        marraztu_core::scene::Mesh::new(source).is_err(),
        "places that are no numbers are refused"
    );
    Figure {
        case: 39,
        what: "wrong texels at places of -1e4, 1, 1e4, 1e30 and the largest f32",
        naive: Some(("texels by whole numbers of 32 bits, of 5", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "texels",
    }
    .hold();
}

#[test]
fn case_40_one_colour_at_all_corners_stays_that_colour() {
    let mut rng = Rng::new(40);
    let (mut wrong, mut naive) = (0, 0);
    for byte in 0..=255_u8 {
        let factor = f32::from(byte) / 255.0;
        let side = 64 * SUBPIXELS;
        let mut corner =
            || Snapped { x: rng.between(-side, 2 * side), y: rng.between(-side, 2 * side) };
        let corners = [corner(), corner(), corner()];
        let picture = painted(corners, [[factor, 1.0, 1.0]; 3], 64);
        let shown = picture.pixels().iter().filter(|pixel| pixel[1] == 255);
        wrong += shown.filter(|pixel| pixel[0] != byte).count();
        // Normalised weights in f32, with the product truncated to a byte.
        for _ in 0..200 {
            let [a, b, c] = [0, 1, 2].map(|_| rng.unit() as f32);
            let sum = a + b + c;
            let mixed = factor * (a / sum) + factor * (b / sum) + factor * (c / sum);
            naive += usize::from((mixed * 255.0) as u8 != byte);
        }
    }
    Figure {
        case: 40,
        what: "pixels of one-coloured triangles with another colour",
        naive: Some(("weights that sum to 1 but for rounding, of 51,200", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_40_a_constant_stays_that_constant_in_perspective_too() {
    let mut rng = Rng::new(41);
    let scale = f64::from(1 << 14);
    let mut off = 0.0_f64;
    for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
        for _ in 0..30 {
            let mut corner = || {
                DVec3::new(rng.real(-90.0, 90.0), rng.real(-90.0, 90.0), rng.real(-900.0, 390.0))
            };
            let corners = [corner(), corner(), corner()];
            let u = rng.unit() as f32;
            let (scene, view) = textured(corners, [u; 3], &ruler(scale));
            let settings = Settings { filter: Filter::Nearest, arithmetic, ..Settings::default() };
            let picture = draw(&scene, &view, &settings, 64);
            for pixel in picture.pixels().iter().filter(|pixel| pixel[0] == pixel[2]) {
                off = off.max(texels_off(f64::from(u), scale, pixel[0]));
            }
        }
    }
    assert!(off < 1e-6, "{off} texels of 2^-22");
}

#[test]
fn case_40_the_same_light_at_all_corners_stays_that_light() {
    let mut rng = Rng::new(42);
    let (mut uneven, mut naive) = (0, 0);
    for byte in 0..255_u8 {
        // Light on the border between two bytes, where the last bit decides.
        let factor = (f64::from(byte) + 0.5) / 255.0;
        let corners =
            [0, 1, 2].map(|_| (rng.vector(1.0) * DVec3::new(90.0, 90.0, 300.0)).as_vec3());
        let face = model("face", &corners.map(|c| c.to_array()), &[&[0, 1, 2], &[2, 1, 0]]);
        let (mut scene, view) = scene(&[(face, DMat4::IDENTITY)]);
        edit(&mut scene, ObjectId(10), |object| {
            let (ambient, none) = ([factor; 3], [0.0; 3]);
            let dull = Material::matte(ambient, none);
            object.material = MaterialChoice::Own(dull);
        });
        let settings = Settings { light: LightAt::Vertex, ..Settings::default() };
        let picture = draw(&scene, &View { marks: false, ..view }, &settings, 64);
        let background = scene.background.opaque();
        let shown = picture.pixels().iter().filter(|pixel| **pixel != background);
        let bytes: Vec<u8> = shown.map(|pixel| pixel[0]).collect();
        uneven += bytes.iter().filter(|byte| **byte != bytes[0]).count();
        let single = factor as f32;
        for _ in 0..200 {
            let [b, c] = [0, 1].map(|_| rng.unit() as f32 / 2.0);
            let mixed = single * (1.0 - b - c) + single * b + single * c;
            naive += usize::from((mixed * 255.0 + 0.5) as u8 != (single * 255.0 + 0.5) as u8);
        }
    }
    Figure {
        case: 40,
        what: "pixels of evenly lit triangles with another byte, on the border between two",
        naive: Some(("corners weighted in f32, not their differences, of 51,000", naive as f64)),
        ours: uneven as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_41_a_quad_is_cut_from_its_first_corner_to_its_third() {
    // The middle of a quad shows the mean of the two corners on its diagonal.
    let corners = [(-60.0, -60.0), (60.0, -60.0), (60.0, 60.0), (-60.0, 60.0)];
    let shown = |turned: usize| {
        let source = MeshSource {
            positions: corners.map(|(x, y)| [x, y, 0.0]).to_vec(),
            colors: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            ..MeshSource::of_polygons(
                (0..4).map(|i| SourceCorner::bare((i + turned as u32) % 4)),
                vec![4],
            )
        };
        let (mut scene, view) = scene(&[(model_of("quad", source), DMat4::IDENTITY)]);
        edit(&mut scene, ObjectId(10), |object| object.surface = Surface::Texture);
        let view = View { marks: false, ..view };
        draw(&scene, &view, &Settings::default(), 65).pixel(32, 32)
    };
    let (red, green) = (shown(0), shown(1));
    let off = [(red[0], 255), (red[1], 0), (green[0], 0), (green[1], 255)]
        .into_iter()
        .map(|(got, want): (u8, u8)| got.abs_diff(want))
        .max()
        .unwrap();
    Figure {
        case: 41,
        what: "the middle of a quad against the mean of its diagonal's ends",
        naive: Some(("the other diagonal", 255.0)),
        ours: f64::from(off),
        bound: 1.0,
        unit: "byte steps",
    }
    .hold();
}

#[test]
fn case_33_textures_on_slivers_are_within_two_last_places() {
    // Drawn in orthographic projection, with light in f32 and in f64. Texture coordinates are read
    // off a ruler with texels one f32 epsilon wide.
    const SIDE: usize = 512;
    let mut rng = Rng::new(330);
    let scale = f64::from(1 << 15);
    let (mut worst, mut naive, mut pixels) = ([0.0_f64; 2], 0.0_f64, 0);
    for _ in 0..200 {
        let side = SIDE as i32 * SUBPIXELS;
        let mut along = || rng.between(0, side);
        let (p, q) = (Snapped { x: along(), y: along() }, Snapped { x: along(), y: along() });
        let width = rng.one_of(&[3, 20, 300, 3000]);
        let beside = Snapped {
            x: (p.x + q.x) / 2 + rng.between(-width, width),
            y: (p.y + q.y) / 2 + rng.between(-width, width),
        };
        let corners = [p, q, beside];
        let u = [0.0_f32, 1.0, rng.unit() as f32];
        for (arithmetic, worst) in [Arithmetic::F32, Arithmetic::F64].into_iter().zip(&mut worst) {
            let (mut scene, view) = flat::scene(&[vec![Flat::new(corners)]], SIDE);
            let (painted, _) =
                textured(corners.map(|c| flat::place(c, 512.0, SIDE)), u, &ruler(scale));
            let painted = painted.objects.get(ObjectId(10)).unwrap().clone();
            edit(&mut scene, ObjectId(1), |object| *object = painted);
            let settings = Settings { filter: Filter::Nearest, arithmetic, ..Settings::default() };
            let picture = draw(&scene, &view, &settings, SIDE);
            for y in 0..SIDE {
                let span = crate::claims::exact::span(corners, y as i32);
                for x in span.filter(|x| (0..SIDE as i64).contains(x)) {
                    let exact = between(corners, u, x as i32, y as i32);
                    let shown = picture.pixel(x as usize, y)[0];
                    let off = texels_off(exact, scale, shown) / 256.0 / scale;
                    *worst = worst.max(off / f64::from(f32::EPSILON));
                    let planar = planar(corners, u, x as i32, y as i32);
                    naive = naive.max((planar - exact).abs() / f64::from(f32::EPSILON));
                    pixels += 1;
                }
            }
        }
    }
    assert!(pixels > 100, "{pixels}");
    for (what, ours) in [
        ("places on the texture on slivers, light in f32", worst[0]),
        ("places on the texture on slivers, light in f64", worst[1]),
    ] {
        Figure {
            case: 33,
            what,
            naive: Some(("a plane equation in f32", naive)),
            ours,
            bound: 2.0,
            unit: "ulp of the largest corner",
        }
        .hold();
    }
}

/// The value at a pixel centre, by integer edge functions and f64 weights.
fn between([p, q, r]: [Snapped; 3], u: [f32; 3], x: i32, y: i32) -> f64 {
    let edge = |p: Snapped, q: Snapped| {
        let (cx, cy) = (i64::from(x) * 256 + 128, i64::from(y) * 256 + 128);
        let e = (i64::from(q.x) - i64::from(p.x)) * (cy - i64::from(p.y))
            - (i64::from(q.y) - i64::from(p.y)) * (cx - i64::from(p.x));
        e as f64
    };
    let parts = [edge(q, r), edge(r, p), edge(p, q)];
    let sum: f64 = parts.iter().sum();
    parts.iter().zip(u).map(|(part, u)| part * f64::from(u)).sum::<f64>() / sum
}
