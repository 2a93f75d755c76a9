use std::sync::Arc;

use egui::epaint::{ClippedPrimitive, ImageDelta, Mesh, Primitive, Vertex};
use egui::{Color32, ColorImage, Pos2, Rect, TextureId, TextureOptions, TexturesDelta, pos2};

use crate::{Canvas, WindowFrame, WindowPainter};
use marraztu_core::base::rng::Rng;
use marraztu_render::screen::coverage::{PixelBox, SUBPIXELS, Snapped, Triangle};

const WIDTH: usize = 97;
const HEIGHT: usize = 75;
const GROUND: Color32 = Color32::from_rgb(31, 122, 200);
const ATLAS: TextureId = TextureId::Managed(0);
const PICTURE: TextureId = TextureId::Managed(1);

/// A painter with textures, and its pixels.
struct Desk {
    painter: WindowPainter,
    pixels: Vec<u32>,
    age: usize,
}

impl Desk {
    fn new() -> Self {
        Self { painter: WindowPainter::new(), pixels: vec![0; WIDTH * HEIGHT], age: 0 }
    }

    fn paint(&mut self, meshes: &[(Rect, Mesh)], textures: &mut TexturesDelta) -> Vec<PixelBox> {
        let primitive = |(clip_rect, mesh): &(Rect, Mesh)| ClippedPrimitive {
            clip_rect: *clip_rect,
            primitive: Primitive::Mesh(mesh.clone()),
        };
        let primitives = meshes.iter().map(primitive).collect();
        let frame = WindowFrame { primitives, scale: 1.0, ground: GROUND };
        let mut canvas = Canvas { pixels: &mut self.pixels, size: [WIDTH, HEIGHT], age: self.age };
        self.age = 1;
        self.painter.paint(&mut canvas, frame, textures)
    }
}

fn everywhere() -> Rect {
    Rect::from_min_max(Pos2::ZERO, pos2(WIDTH as f32, HEIGHT as f32))
}

/// Creates an atlas with a white texel in the corner, as in egui's, and noise in the others.
fn atlas() -> ColorImage {
    let mut rng = Rng::new(5);
    let mut image = noise([16, 8], &mut rng);
    image.pixels[0] = Color32::WHITE;
    image
}

fn noise(size: [usize; 2], rng: &mut Rng) -> ColorImage {
    let count = size[0] * size[1];
    ColorImage::new(size, (0..count).map(|_| color(rng)).collect())
}

/// Draws a random colour: half of them are opaque, some transparent.
fn color(rng: &mut Rng) -> Color32 {
    let byte = |rng: &mut Rng| u8::try_from(rng.below(256)).unwrap();
    let alpha = if rng.percent(50) { 255 } else { byte(rng) & 0xf0 };
    Color32::from_rgba_unmultiplied(byte(rng), byte(rng), byte(rng), alpha)
}

fn delta(textures: &[(TextureId, &Arc<ColorImage>, TextureOptions)]) -> TexturesDelta {
    let mut delta = TexturesDelta::default();
    for (id, image, options) in textures {
        delta.push(*id, ImageDelta::full(Arc::clone(image), *options));
    }
    delta
}

fn quad(texture: TextureId, rect: Rect, uv: Rect, color: Color32) -> Mesh {
    let mut mesh = Mesh::with_texture(texture);
    mesh.add_rect_with_uv(rect, uv, color);
    mesh
}

fn whole() -> Rect {
    Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0))
}

fn plain(rect: Rect, color: Color32) -> Mesh {
    quad(ATLAS, rect, Rect::from_min_max(Pos2::ZERO, Pos2::ZERO), color)
}

fn place(rng: &mut Rng, most: usize) -> f32 {
    let at = rng.between(-20 * 4, 4 * i32::try_from(most).unwrap() + 80) as f32 / 4.0;
    // Half of the places lie on centres and borders of pixels or between them.
    if rng.percent(50) { at } else { at + rng.below(1000) as f32 / 1000.0 }
}

/// Draws a random shape; most are of a kind that egui makes.
fn shape(rng: &mut Rng) -> Mesh {
    let (x, y) = (place(rng, WIDTH), place(rng, HEIGHT));
    let to = pos2(x + rng.below(600) as f32 / 7.0, y + rng.below(400) as f32 / 8.0);
    let rect = Rect::from_min_max(pos2(x, y), to);
    match rng.below(5) {
        0 => plain(rect, color(rng)),
        1 => {
            // A glyph with one texel per pixel.
            let (left, top) = (rng.below(9) as f32, rng.below(5) as f32);
            let at = pos2(x.round(), y.round());
            let rect = Rect::from_min_size(at, egui::vec2(6.0, 3.0));
            let uv = Rect::from_min_max(
                pos2(left / 16.0, top / 8.0),
                pos2((left + 6.0) / 16.0, (top + 3.0) / 8.0),
            );
            quad(ATLAS, rect, uv, color(rng))
        }
        2 => quad(PICTURE, rect, whole(), Color32::WHITE),
        3 => quad(ATLAS, rect, whole(), color(rng)),
        _ => {
            let mut mesh = Mesh::default();
            let textured = rng.percent(30);
            for _ in 0..3 {
                let at = |rng: &mut Rng| rng.below(100) as f32 / 100.0;
                let uv = if textured { pos2(at(rng), at(rng)) } else { Pos2::ZERO };
                let pos = pos2(place(rng, WIDTH), place(rng, HEIGHT));
                mesh.vertices.push(Vertex { pos, uv, color: color(rng) });
            }
            mesh.indices = vec![0, 1, 2];
            mesh
        }
    }
}

/// Paints the same in f64 and in the plainest way: triangle by triangle, pixel by pixel.
#[expect(clippy::cast_possible_truncation, reason = "bytes, and places near the picture")]
fn reference(meshes: &[(Rect, Mesh)], textures: [&ColorImage; 2], nearest: [bool; 2]) -> Vec<u32> {
    let ground = GROUND.to_array().map(f64::from);
    let mut pixels = vec![[ground[0], ground[1], ground[2]]; WIDTH * HEIGHT];
    for (clip, mesh) in meshes {
        let which = usize::from(mesh.texture_id == PICTURE);
        let clip = super::items::clip_area(*clip, 1.0, [WIDTH, HEIGHT]);
        for corners in mesh.indices.chunks(3) {
            let corners = [0, 1, 2].map(|i| mesh.vertices[corners[i] as usize]);
            let snap = |at: f32| (f64::from(at) * f64::from(SUBPIXELS)).round() as i32;
            let at = corners.map(|p| Snapped { x: snap(p.pos.x), y: snap(p.pos.y) });
            let Some(triangle) = Triangle::new(at) else { continue };
            triangle.covered(clip, |pixel| {
                let weight = pixel.edges.map(|edge| edge as f64 / triangle.doubled_area() as f64);
                let mean = |pick: &dyn Fn(&Vertex) -> f64| -> f64 {
                    (0..3).map(|i| weight[i] * pick(&corners[i])).sum()
                };
                let (u, v) = (mean(&|p| f64::from(p.uv.x)), mean(&|p| f64::from(p.uv.y)));
                let texel = sample(textures[which], nearest[which], u, v);
                let source: [f64; 4] = std::array::from_fn(|i| {
                    mean(&|p| f64::from(p.color.to_array()[i])) * texel[i] / 255.0
                });
                let below = &mut pixels[pixel.y as usize * WIDTH + pixel.x as usize];
                for i in 0..3 {
                    let value = source[i] + below[i] * (1.0 - source[3] / 255.0);
                    below[i] = value.round().clamp(0.0, 255.0);
                }
            });
        }
    }
    pixels.iter().map(|[r, g, b]| (*r as u32) << 16 | (*g as u32) << 8 | *b as u32).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "brought to the borders of the picture")]
fn sample(image: &ColorImage, nearest: bool, u: f64, v: f64) -> [f64; 4] {
    let [width, height] = image.size;
    let texel = |x: f64, y: f64| {
        let x = x.clamp(0.0, width as f64 - 1.0) as usize;
        let y = y.clamp(0.0, height as f64 - 1.0) as usize;
        image.pixels[y * width + x].to_array().map(f64::from)
    };
    let (x, y) = (u * width as f64, v * height as f64);
    if nearest {
        return texel(x.floor(), y.floor());
    }
    let (x, y) = (x - 0.5, y - 0.5);
    let (a, b) = (x - x.floor(), y - y.floor());
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let parts = corners.map(|(dx, dy)| {
        let weight = (if dx == 0.0 { 1.0 - a } else { a }) * (if dy == 0.0 { 1.0 - b } else { b });
        texel(x.floor() + dx, y.floor() + dy).map(|value| value * weight)
    });
    std::array::from_fn(|i| parts.iter().map(|part| part[i]).sum())
}

/// Returns the largest difference of a channel.
fn difference(a: &[u32], b: &[u32]) -> u8 {
    let channels = |a: &u32, b: &u32| {
        let pairs = a.to_le_bytes().into_iter().zip(b.to_le_bytes());
        pairs.map(|(a, b)| a.abs_diff(b)).max().unwrap()
    };
    a.iter().zip(b).map(|(a, b)| channels(a, b)).max().unwrap()
}

#[test]
fn every_shape_is_painted_as_the_plainest_arithmetic_paints_it() {
    let mut rng = Rng::new(1);
    let mut desk = Desk::new();
    let (atlas, picture) = (Arc::new(atlas()), Arc::new(noise([13, 9], &mut rng)));
    let (linear, nearest) = (TextureOptions::LINEAR, TextureOptions::NEAREST);
    let mut textures = delta(&[(ATLAS, &atlas, linear), (PICTURE, &picture, nearest)]);
    let mut painted = 0;
    for i in 0..1500 {
        let mesh = shape(&mut rng);
        let corner = pos2(place(&mut rng, WIDTH), place(&mut rng, HEIGHT));
        let part = Rect::from_min_max(Pos2::ZERO, corner);
        let clip = if rng.percent(70) { everywhere() } else { part };
        // Rounding may move the border between two texels to either side of a pixel centre.
        let picture_moved = mesh.texture_id == PICTURE;
        let meshes = [(clip, mesh)];
        desk.paint(&meshes, &mut textures);
        let expected = reference(&meshes, [&atlas, &picture], [false, true]);
        let wrong =
            desk.pixels.iter().zip(&expected).filter(|(a, b)| difference(&[**a], &[**b]) > 1);
        let most = if picture_moved { WIDTH + HEIGHT } else { 0 };
        assert!(wrong.count() <= most, "shape {i}: {meshes:?}");
        painted += desk.pixels.iter().filter(|pixel| **pixel != desk.pixels[0]).count();
    }
    assert!(painted > 100_000, "{painted}");
}

#[test]
fn shapes_that_share_edges_cover_every_pixel_once() {
    // This colour adds 1 to each pixel each time it is painted.
    let one = Color32::from_rgba_premultiplied(1, 1, 1, 0);
    let mut rng = Rng::new(2);
    let white = Arc::new(ColorImage::filled([1, 1], Color32::WHITE));
    let mut desk = Desk::new();
    let mut textures = delta(&[(ATLAS, &white, TextureOptions::LINEAR)]);
    let far = pos2(WIDTH as f32, HEIGHT as f32);
    for round in 0..300 {
        // Upright rectangles around a cross; one of the four is a fan of triangles.
        let at = |rng: &mut Rng, most: usize| {
            let at = rng.below(4 * most as u64) as f32 / 4.0;
            if rng.percent(50) { at } else { at + rng.below(999) as f32 / 999.0 }
        };
        let (x, y) = (at(&mut rng, WIDTH), at(&mut rng, HEIGHT));
        let rect = |a: Pos2, b: Pos2| Rect::from_min_max(a, b);
        let mut mesh = Mesh::default();
        mesh.append(plain(rect(Pos2::ZERO, pos2(x, y)), one));
        mesh.append(plain(rect(pos2(x, 0.0), pos2(far.x, y)), one));
        mesh.append(plain(rect(pos2(0.0, y), pos2(x, far.y)), one));
        let centre = pos2(at(&mut rng, WIDTH).max(x), at(&mut rng, HEIGHT).max(y));
        let first = u32::try_from(mesh.vertices.len()).unwrap();
        let round_it = [pos2(x, y), pos2(far.x, y), far, pos2(x, far.y)];
        for pos in round_it.into_iter().chain([centre]) {
            mesh.vertices.push(Vertex { pos, uv: Pos2::ZERO, color: one });
        }
        for i in 0..4 {
            mesh.add_triangle(first + i, first + (i + 1) % 4, first + 4);
        }
        desk.paint(&[(everywhere(), mesh)], &mut textures);
        let [r, g, b, _] = GROUND.to_array().map(u32::from);
        let expected = (r + 1) << 16 | (g + 1) << 8 | (b + 1);
        let wrong = desk.pixels.iter().position(|pixel| *pixel != expected);
        assert_eq!(wrong, None, "round {round}: cross at {x} {y}, fan at {centre:?}");
    }
}

#[test]
fn only_columns_and_bands_that_differ_are_painted_again() {
    let white = Arc::new(ColorImage::filled([1, 1], Color32::WHITE));
    let mut desk = Desk::new();
    let mut textures = delta(&[(ATLAS, &white, TextureOptions::LINEAR)]);
    let rect = |x: f32, y: f32| Rect::from_min_size(pos2(x, y), egui::vec2(10.0, 8.0));
    let meshes = |moved: Rect| {
        let all = [rect(5.0, 5.0), moved, rect(80.0, 5.0)];
        all.map(|rect| (everywhere(), plain(rect, Color32::from_rgb(200, 3, 4))))
    };
    let all = desk.paint(&meshes(rect(40.0, 40.0)), &mut textures);
    assert_eq!(all.iter().map(|area| area.width() * area.height()).sum::<i32>(), 97 * 75);
    // A marker in all pixels shows that nothing outside of the change is painted.
    desk.pixels.fill(0xaa_bbcc);
    let changed = desk.paint(&meshes(rect(47.0, 40.0)), &mut textures);
    assert_eq!(changed, [PixelBox { left: 40, top: 32, right: 57, bottom: 64 }]);
    let mut fresh = Desk::new();
    fresh.paint(&meshes(rect(47.0, 40.0)), &mut delta(&[(ATLAS, &white, TextureOptions::LINEAR)]));
    for (i, pixel) in desk.pixels.iter().enumerate() {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let inside = (40..57).contains(&x) && (32..64).contains(&y);
        assert_eq!(*pixel, if inside { fresh.pixels[i] } else { 0xaa_bbcc }, "{x} {y}");
    }
    assert_eq!(desk.paint(&meshes(rect(47.0, 40.0)), &mut textures), []);
}

#[test]
fn incremental_repaints_equal_full_repaints() {
    let mut rng = Rng::new(3);
    let (linear, nearest) = (TextureOptions::LINEAR, TextureOptions::NEAREST);
    let atlas = Arc::new(atlas());
    let mut picture = Arc::new(noise([13, 9], &mut rng));
    let mut desk = Desk::new();
    let mut textures = delta(&[(ATLAS, &atlas, linear), (PICTURE, &picture, nearest)]);
    // Windows have one to three buffers, which are painted in turn. A frame without changes is not
    // shown.
    let mut buffers = vec![vec![0; WIDTH * HEIGHT]; 3];
    let mut painted_at = [None; 3];
    let (mut shown, mut frames) = (0, 0);
    let mut meshes: Vec<(Rect, Mesh)> = Vec::new();
    for i in 0..400 {
        for _ in 0..rng.below(3) {
            let at = rng.index(meshes.len() + 1);
            match rng.below(3) {
                0 if at < meshes.len() => drop(meshes.remove(at)),
                1 if at < meshes.len() => meshes[at].1 = shape(&mut rng),
                _ => meshes.insert(at, (everywhere(), shape(&mut rng))),
            }
        }
        meshes.truncate(12);
        if rng.percent(30) {
            picture = Arc::new(noise([13, 9], &mut rng));
            textures.push(PICTURE, ImageDelta::partial([0, 0], Arc::clone(&picture), nearest));
        }
        let buffer = rng.index(3);
        desk.age = painted_at[buffer].map_or(0, |then: usize| frames - then);
        std::mem::swap(&mut desk.pixels, &mut buffers[buffer]);
        let changed = desk.paint(&meshes, &mut textures);
        std::mem::swap(&mut desk.pixels, &mut buffers[buffer]);
        if !changed.is_empty() {
            painted_at[buffer] = Some(frames);
            (shown, frames) = (buffer, frames + 1);
        }
        let mut fresh = Desk::new();
        let mut again = delta(&[(ATLAS, &atlas, linear), (PICTURE, &picture, nearest)]);
        fresh.paint(&meshes, &mut again);
        assert!(buffers[shown] == fresh.pixels, "frame {i}");
    }
}

#[test]
fn a_picture_of_whole_or_half_size_is_shown_pixel_by_pixel() {
    let mut rng = Rng::new(4);
    let mut desk = Desk::new();
    let opaque = |image: ColorImage| {
        let solid = |color: &Color32| Color32::from_rgb(color.r(), color.g(), color.b());
        Arc::new(ColorImage::new(image.size, image.pixels.iter().map(solid).collect()))
    };
    for half in [1, 2] {
        let size = [80 / half, 60 / half];
        let picture = opaque(noise(size, &mut rng));
        let rect = Rect::from_min_size(pos2(9.0, 7.0), egui::vec2(80.0, 60.0));
        let mesh = quad(PICTURE, rect, whole(), Color32::WHITE);
        let mut textures = delta(&[(PICTURE, &picture, TextureOptions::NEAREST)]);
        desk.paint(&[(everywhere(), mesh)], &mut textures);
        for (i, pixel) in desk.pixels.iter().enumerate() {
            let (x, y) = (i % WIDTH, i / WIDTH);
            let inside = (9..89).contains(&x) && (7..67).contains(&y);
            let color = match inside {
                true => picture.pixels[(y - 7) / half * size[0] + (x - 9) / half],
                false => GROUND,
            };
            let [r, g, b, _] = color.to_array().map(u32::from);
            assert_eq!(*pixel, r << 16 | g << 8 | b, "{x} {y}, a part of {half}");
        }
    }
}

#[test]
fn changing_a_part_of_a_texture_repaints_the_meshes_that_show_it() {
    let mut desk = Desk::new();
    let black = Arc::new(ColorImage::filled([8, 8], Color32::BLACK));
    let white = Arc::new(ColorImage::filled([3, 2], Color32::WHITE));
    let rect = Rect::from_min_size(Pos2::ZERO, egui::vec2(8.0, 8.0));
    let meshes = [(everywhere(), quad(PICTURE, rect, whole(), Color32::WHITE))];
    desk.paint(&meshes, &mut delta(&[(PICTURE, &black, TextureOptions::NEAREST)]));
    let mut part = TexturesDelta::default();
    part.push(PICTURE, ImageDelta::partial([4, 5], white, TextureOptions::NEAREST));
    let changed = desk.paint(&meshes, &mut part);
    assert_eq!(changed, [PixelBox { left: 0, top: 0, right: 8, bottom: 32 }]);
    for (x, y) in (0..8).flat_map(|x| (0..8).map(move |y| (x, y))) {
        let inside = (4..7).contains(&x) && (5..7).contains(&y);
        assert_eq!(desk.pixels[y * WIDTH + x], if inside { 0xff_ffff } else { 0 }, "{x} {y}");
    }
    assert_eq!(black.pixels[5 * 8 + 4], Color32::BLACK, "the picture that was given is untouched");
    let mut gone = TexturesDelta::default();
    gone.free(PICTURE);
    desk.paint(&meshes, &mut gone);
    assert_eq!(desk.pixels[0], 0, "it is freed after the frame");
    desk.paint(&meshes, &mut TexturesDelta::default());
    assert_eq!(desk.pixels[0], 0x1f_7ac8);
}

#[test]
fn panels_and_text_of_egui_match_the_reference_painter() {
    let ctx = egui::Context::default();
    let input = egui::RawInput { screen_rect: Some(everywhere()), ..Default::default() };
    let mut output = ctx.run_ui(input, |ui| {
        egui::Frame::window(ui.style()).show(ui, |ui| {
            ui.heading("Viewport");
            let _ = ui.button("Frame all");
            ui.add(egui::Slider::new(&mut 0.3, 0.0..=1.0));
        });
    });
    let primitives = ctx.tessellate(output.shapes, output.pixels_per_point);
    let atlas = output.textures_delta.set.values().next().map(|deltas| deltas[0].image.clone());
    let Some(egui::ImageData::Color(atlas)) = atlas else { panic!("egui has an atlas") };
    let meshes: Vec<_> = primitives
        .into_iter()
        .filter_map(|ClippedPrimitive { clip_rect, primitive }| match primitive {
            Primitive::Mesh(mesh) => Some((clip_rect, mesh)),
            Primitive::Callback(_) => None,
        })
        .collect();
    let mut desk = Desk::new();
    desk.paint(&meshes, &mut output.textures_delta);
    let expected = reference(&meshes, [&atlas, &atlas], [false; 2]);
    assert!(difference(&desk.pixels, &expected) <= 1);
    let colors: std::collections::HashSet<_> = expected.iter().collect();
    assert!(colors.len() > 50, "text and rounded corners have many colours");
}
