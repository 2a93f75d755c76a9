//! Texture sampling, compared with an independent oracle in f64, for shapes, coordinates and
//! distances that are hard for f32 lanes.

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{Arithmetic, Filter, Settings, Transparency};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    MeshSource, NONE, ObjectId, Scene, Sides, SourceCorner, Surface, Texture, View, Wrap,
};

use super::common::{draw, edit, model_of, scene};
use super::figures::Figure;
use super::oracle::{Eye, meet};

const SIDE: usize = 128;

/// A texture of random greys.
fn noise(width: usize, height: usize, wrap: Wrap, scale: [f64; 2]) -> Shared<Texture> {
    let mut rng = Rng::new((width * 31 + height) as u64);
    let texels = (0..width * height).map(|_| {
        let grey = rng.real(0.0, 256.0) as u8;
        [grey, grey, grey, 255]
    });
    let picture = Picture::from_pixels(Size::new(width, height), texels.collect()).unwrap();
    Shared::new(Texture { wrap, scale, ..Texture::new("", picture) })
}

/// An unlit quad with texture coordinates at its corners.
fn quad(corners: [DVec3; 4], uvs: [[f32; 2]; 4], texture: &Shared<Texture>) -> (Scene, View) {
    let source = MeshSource {
        positions: corners.map(|corner| corner.as_vec3().to_array()).to_vec(),
        uvs: uvs.to_vec(),
        ..MeshSource::of_polygons(
            [0, 1, 2, 0, 2, 3].map(|i| SourceCorner { position: i, uv: i, normal: NONE }),
            vec![3, 3],
        )
    };
    let (mut scene, view) = scene(&[(model_of("quad", source), DMat4::IDENTITY)]);
    edit(&mut scene, ObjectId(10), |object| {
        object.sides = Sides::Two;
        object.surface = Surface::Texture;
        object.texture = Some(texture.clone());
    });
    (scene, View { marks: false, ..view })
}

/// The texel at any column and row, counted from the lower left corner, after wrapping.
fn texel(texture: &Texture, column: f64, row: f64) -> f64 {
    let Size { width, height } = texture.picture.size();
    let inside = |i: f64, side: usize| match texture.wrap {
        Wrap::Repeat => i.rem_euclid(side as f64),
        Wrap::Clamp => i.clamp(0.0, side as f64 - 1.0),
    };
    let (column, row) = (inside(column, width) as usize, inside(row, height) as usize);
    f64::from(texture.picture.pixel(column, height - 1 - row)[0])
}

/// The filtered grey at texture coordinates, from 0 to 255.
fn grey(texture: &Texture, [u, v]: [f64; 2], filter: Filter) -> f64 {
    let Size { width, height } = texture.picture.size();
    let x = (u * texture.scale[0] + texture.offset[0]) * width as f64;
    let y = (v * texture.scale[1] + texture.offset[1]) * height as f64;
    if filter == Filter::Nearest {
        return texel(texture, x.floor(), y.floor());
    }
    let (x, y) = (x - 0.5, y - 0.5);
    let (column, row) = (x.floor(), y.floor());
    let (s, t) = (x - column, y - row);
    let along =
        |row: f64| texel(texture, column, row) * (1.0 - s) + texel(texture, column + 1.0, row) * s;
    along(row) * (1.0 - t) + along(row + 1.0) * t
}

/// The texture coordinates of a quad at a pixel, by ray casting.
fn place(corners: [DVec3; 4], uvs: [[f32; 2]; 4], x: usize, y: usize) -> Option<[f64; 2]> {
    let eye = Eye::first(SIDE);
    [[0, 1, 2], [0, 2, 3]].into_iter().find_map(|ids: [usize; 3]| {
        let (_, parts) = meet(eye.at, eye.ray(x, y), ids.map(|i| corners[i]))?;
        Some([0, 1].map(|axis| (0..3).map(|i| parts[i] * f64::from(uvs[ids[i]][axis])).sum()))
    })
}

/// A close-up of a wall that recedes to the right.
fn wall() -> [DVec3; 4] {
    [(-20.0, -18.0, 350.0), (25.0, -20.0, 320.0), (25.0, 22.0, 320.0), (-20.0, 19.0, 350.0)]
        .map(|(x, y, z)| DVec3::new(x, y, z))
}

/// The texture coordinates of a rectangle that begins at (u, v).
fn square(u: f32, v: f32, width: f32, height: f32) -> [[f32; 2]; 4] {
    [[u, v], [u + width, v], [u + width, v + height], [u, v + height]]
}

/// Draws a quad, and returns the largest difference from the oracle in byte steps.
fn farthest_off(
    (corners, uvs): ([DVec3; 4], [[f32; 2]; 4]),
    texture: &Shared<Texture>,
    filter: Filter,
) -> f64 {
    let (scene, view) = quad(corners, uvs, texture);
    let settings = Settings { filter, ..Settings::default() };
    let picture = draw(&scene, &view, &settings, SIDE);
    let (mut off, mut pixels) = (0.0_f64, 0);
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let shown = picture.pixel(x, y);
        let Some(at) = place(corners, uvs, x, y) else { continue };
        if shown == scene.background.opaque() {
            continue;
        }
        pixels += 1;
        off = off.max((f64::from(shown[0]) - grey(texture, at, filter)).abs());
    }
    assert!(pixels > 1000, "{pixels}");
    off
}

#[test]
fn case_37_bilinear_texels_of_every_shape_are_right_to_a_step() {
    let mut ours = 0.0_f64;
    for wrap in [Wrap::Repeat, Wrap::Clamp] {
        for (width, height, uvs) in [
            (1, 1, square(0.0, 0.0, 1.0, 1.0)),
            (1, 7, square(-0.5, -0.25, 2.0, 1.5)),
            (1, 16_384, square(0.25, 0.5, 0.5, 0.001)),
            (16_384, 1, square(-3.001, 0.5, 0.002, 0.5)),
            (5, 3, square(-1.5, -2.25, 3.0, 4.0)),
            (61, 47, square(0.0, 0.0, 0.5, 0.5)),
            (16, 16, square(-1.0, -1.0, 1.5, 2.0)),
        ] {
            let texture = noise(width, height, wrap, [1.0; 2]);
            ours = ours.max(farthest_off((wall(), uvs), &texture, Filter::Bilinear));
        }
    }
    // The bound includes snapping to 1/256 pixel, which moves the texture by up to 1/512 pixel.
    Figure {
        case: 37,
        what: "bilinear texels of textures of 1 x 1 to 16384 x 1, odd sides among them",
        naive: None,
        ours,
        bound: 1.0,
        unit: "steps of 255",
    }
    .hold();
}

#[test]
fn case_39_texels_far_from_the_origin_of_the_texture_are_right_to_a_step() {
    // Integers up to 2^24 are exact in f32; the texture repeats every 1024 units.
    let texture = noise(32, 32, Wrap::Repeat, [1.0 / 1024.0; 2]);
    let uvs = square(1e7, -1e7, 500.0, 400.0);
    let ours = farthest_off((wall(), uvs), &texture, Filter::Bilinear);
    // At 1e7, f32 coordinates are integers, so the naive texel jumps.
    let naive = {
        let (mut off, at) = (0.0_f64, |x, y| place(wall(), uvs, x, y));
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
            if let Some([u, v]) = at(x, y) {
                let exact = grey(&texture, [u, v], Filter::Bilinear);
                let rounded = [u, v].map(|at| f64::from(at as f32));
                off = off.max((grey(&texture, rounded, Filter::Bilinear) - exact).abs());
            }
        }
        off
    };
    Figure {
        case: 39,
        what: "bilinear texels at coordinates of 1e7",
        naive: Some(("coordinates interpolated in f32", naive)),
        ours,
        bound: 1.0,
        unit: "steps of 255",
    }
    .hold();
}

#[test]
fn case_39_a_pixel_is_a_hole_exactly_if_its_alpha_is_below_one_half() {
    let opaque = noise(23, 17, Wrap::Repeat, [1.0; 2]);
    let texels = opaque.picture.pixels().iter().map(|[grey, ..]| [*grey; 4]).collect();
    let picture = Picture::from_pixels(Size::new(23, 17), texels).unwrap();
    let texture = Shared::new(Texture { picture: picture.into(), ..Texture::clone(&opaque) });
    let uvs = square(-0.5, 0.25, 1.5, 1.0);
    let (scene, view) = quad(wall(), uvs, &texture);
    let (mut wrong, mut holes, mut pixels) = (0, 0, 0);
    for filter in crate::FILTERS {
        let transparency = Transparency::Threshold;
        let settings = Settings { filter, transparency, ..Settings::default() };
        let picture = draw(&scene, &view, &settings, SIDE);
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
            let Some(at) = place(wall(), uvs, x, y) else { continue };
            let alpha = grey(&texture, at, filter) - 127.5;
            // Snapping to 1/256 pixel can change the nearest texel, or a filtered alpha by some
            // steps; such pixels are skipped.
            let is_clear = match filter {
                Filter::Nearest => {
                    let moved = |by: f64| grey(&texture, [at[0] + by, at[1] + by], filter) - 127.5;
                    [0.002, -0.002].iter().all(|by| moved(*by).signum() == alpha.signum())
                }
                Filter::Bilinear | Filter::Trilinear | Filter::Anisotropic => alpha.abs() > 2.0,
            };
            if is_clear && inside(x, y) {
                pixels += 1;
                let is_hole = picture.pixel(x, y) == scene.background.opaque();
                holes += usize::from(is_hole);
                wrong += usize::from(is_hole != (alpha < 0.0));
            }
        }
    }
    assert!(pixels > 3000 && holes > pixels / 4, "{holes} of {pixels}");
    Figure {
        case: 39,
        what: "pixels that are a hole, or none, against their alpha",
        naive: None,
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

/// Whether the wall covers a pixel and all its neighbours.
fn inside(x: usize, y: usize) -> bool {
    let uvs = square(0.0, 0.0, 1.0, 1.0);
    let beside = |i: usize| i.saturating_sub(1)..(i + 2).min(SIDE);
    beside(y).all(|y| beside(x).all(|x| place(wall(), uvs, x, y).is_some()))
}

#[test]
fn case_39_minified_a_thousand_times_a_texture_is_its_mean() {
    let texels = (0..64 * 64).map(|i| if (i % 64 + i / 64) % 2 == 0 { [0; 3] } else { [254; 3] });
    let texels = texels.map(|[r, g, b]| [r, g, b, 255]).collect();
    let picture = Picture::from_pixels(Size::new(64, 64), texels).unwrap();
    let noise = noise(1, 1, Wrap::Repeat, [1.0; 2]);
    let texture = Shared::new(Texture { picture: picture.into(), ..Texture::clone(&noise) });
    let uvs = square(0.1, 0.2, 2000.0, 1500.0);
    let off = |filter| {
        let (scene, view) = quad(wall(), uvs, &texture);
        let picture = draw(&scene, &view, &Settings { filter, ..Settings::default() }, SIDE);
        let background = scene.background.opaque();
        let own = picture.pixels().iter().filter(|pixel| **pixel != background);
        own.map(|pixel| (f64::from(pixel[0]) - 127.0).abs()).fold(0.0, f64::max)
    };
    Figure {
        case: 39,
        what: "a chequered texture, a thousand texels a pixel",
        naive: Some(("without mip maps", off(Filter::Bilinear))),
        ours: off(Filter::Trilinear),
        bound: 1.0,
        unit: "steps of 255",
    }
    .hold();
}

#[test]
fn case_39_no_texel_of_the_other_side_shows_at_a_seam() {
    // Corners on pixel centres, where u is exactly 0 or 1.
    let texels = (0..8).map(|i| if i < 4 { [10, 10, 10, 255] } else { [200, 200, 200, 255] });
    let picture = Picture::from_pixels(Size::new(8, 1), texels.collect()).unwrap();
    let noise = noise(1, 1, Wrap::Repeat, [1.0; 2]);
    let mut wrong = 0;
    for wrap in [Wrap::Repeat, Wrap::Clamp] {
        let picture = picture.clone().into();
        let texture = Shared::new(Texture { picture, wrap, ..Texture::clone(&noise) });
        for k in 0..40 {
            // An odd width in pixels puts the sides on pixel centres.
            let half = (f64::from(k) + 20.5) * 400.0 * (2.0_f64.sqrt() - 1.0) * 2.0 / SIDE as f64;
            let corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
                .map(|(x, y)| DVec3::new(x, y, 0.0));
            let (scene, view) = quad(corners, square(0.0, 0.0, 1.0, 1.0), &texture);
            let settings = Settings { filter: Filter::Nearest, ..Settings::default() };
            let picture = draw(&scene, &view, &settings, SIDE);
            for y in 0..SIDE {
                for (x, expected) in (0..SIDE).map(|x| (x, if x < SIDE / 2 { 10 } else { 200 })) {
                    let shown = picture.pixel(x, y);
                    let own = shown != scene.background.opaque();
                    wrong += usize::from(own && shown[0] != expected);
                }
            }
        }
    }
    Figure {
        case: 39,
        what: "pixels of 80 squares that show the texel beyond a seam",
        naive: None,
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_37_a_floor_is_right_up_to_its_horizon() {
    // A floor through the near plane, 60 repetitions deep: f32 lanes against the f64 kernel, which
    // samples one pixel at a time.
    let corners = [(-3e3, -20.0, 500.0), (3e3, -20.0, 500.0), (3e3, -20.0, -1500.0)]
        .map(|(x, y, z)| DVec3::new(x, y, z));
    let corners = [corners[0], corners[1], corners[2], DVec3::new(-3e3, -20.0, -1500.0)];
    // Clamped, the texture is the middle of the floor, and its border texels are everywhere else.
    let floors = [
        (noise(64, 64, Wrap::Repeat, [1.0; 2]), square(0.0, 0.0, 180.0, 60.0)),
        (noise(64, 64, Wrap::Clamp, [1.0; 2]), square(-90.0, -20.0, 180.0, 60.0)),
    ];
    let off = |filter| {
        let settings = Settings { filter, ..Settings::default() };
        let exact = Settings { arithmetic: Arithmetic::F64, ..settings };
        let mut off = 0.0_f64;
        for (texture, uvs) in &floors {
            let (scene, view) = quad(corners, *uvs, texture);
            let [ours, exact] = [&settings, &exact].map(|own| draw(&scene, &view, own, SIDE));
            let pairs = ours.pixels().iter().zip(exact.pixels());
            let apart = pairs.map(|(a, b)| (f64::from(a[0]) - f64::from(b[0])).abs());
            off = apart.fold(off, f64::max);
        }
        off
    };
    for (filter, what) in [
        (Filter::Trilinear, "trilinear texels of a floor up to its horizon, against f64"),
        (Filter::Anisotropic, "anisotropic texels of a floor up to its horizon, against f64"),
    ] {
        let (case, ours) = (37, off(filter));
        Figure { case, what, naive: None, ours, bound: 1.0, unit: "steps of 255" }.hold();
    }
}
