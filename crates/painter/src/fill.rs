//! Paints items into rows of pixels.
//!
//! The colour of a pixel never depends on the area being painted. A window painted in parts
//! therefore equals the same window painted at once.

use std::ops::Range;

use egui::Color32;

use crate::blend::{is_opaque, lay, over, packed, product, tint};
use crate::items::{Corner, Item, Ramp, Shape};
use crate::textures::{Between, Filter, Texture, mix};
use marraztu_render::screen::coverage::{PixelBox, Triangle};

/// Adjacent rows of pixels: blue in the lowest byte, then green, red and a zero.
#[derive(Debug)]
pub(crate) struct Strip<'a> {
    pub(crate) pixels: &'a mut [u32],
    pub(crate) width: usize,
    /// The first row.
    pub(crate) top: i32,
}

impl Strip<'_> {
    /// Returns the indices of pixels of a row.
    fn place(&self, y: i32, left: i32, right: i32) -> Range<usize> {
        let start = index(y - self.top) * self.width;
        start + index(left)..start + index(right)
    }

    fn row(&mut self, y: i32, left: i32, right: i32) -> &mut [u32] {
        let place = self.place(y, left, right);
        &mut self.pixels[place]
    }

    /// Fills an area with one colour.
    pub(crate) fn clear(&mut self, area: PixelBox, color: Color32) {
        for y in area.top..area.bottom {
            self.row(y, area.left, area.right).fill(packed(color));
        }
    }
}

/// Paints the part of an item in `within`, an area of the strip.
pub(crate) fn paint(strip: &mut Strip<'_>, item: &Item, texture: &Texture, within: PixelBox) {
    let area = item.area.intersection(within);
    if area.is_empty() {
        return;
    }
    match &item.shape {
        Shape::Plain { color, uv } => {
            let source = plain_source(*color, *uv, texture);
            for y in area.top..area.bottom {
                lay(strip.row(y, area.left, area.right), source);
            }
        }
        Shape::Picture { color, u, v } => {
            let map = Map::new(item.area, area, texture, (*u, *v));
            match map.is_texel_for_pixel {
                true => paint_texels(strip, area, texture, (*color, &map)),
                false => paint_between_texels(strip, area, texture, (*color, *u, *v)),
            }
        }
        Shape::Triangle(corners) => {
            paint_triangle(strip, (item.area.left, area), texture, corners);
        }
    }
}

/// Returns whether an item hides everything painted before it in an area.
pub(crate) fn hides(item: &Item, texture: &Texture, area: PixelBox) -> bool {
    if item.area.intersection(area) != area {
        return false;
    }
    match &item.shape {
        Shape::Plain { color, uv } => is_opaque(plain_source(*color, *uv, texture)),
        Shape::Picture { color, u, v } => {
            let map = Map::new(item.area, area, texture, (*u, *v));
            map.is_texel_for_pixel && *color == [255; 4] && texture.is_opaque
        }
        Shape::Triangle(_) => false,
    }
}

/// Maps the pixels of a picture to texels.
#[derive(Debug)]
struct Map {
    /// Whether every pixel shows exactly one texel, without filtering.
    is_texel_for_pixel: bool,
    columns: Columns,
    rows: Vec<usize>,
}

#[derive(Debug)]
enum Columns {
    /// Consecutive texels.
    Run(Range<usize>),
    Table(Vec<usize>),
}

impl Map {
    /// Creates the map for a part of the pixels. The filter is chosen for the whole picture, so
    /// every part is painted alike.
    fn new(whole: PixelBox, area: PixelBox, texture: &Texture, (u, v): (Ramp, Ramp)) -> Self {
        let [width, height] = texture.size();
        let (across, down) = (length(width), length(height));
        let filter = texture.filter((u.step * across).abs().max((v.step * down).abs()));
        let run = run(u, whole.left..whole.right, width, filter);
        let column = run.is_some();
        let row = self::run(v, whole.top..whole.bottom, height, filter);
        let is_texel_for_pixel = filter == Filter::Nearest || (column && row.is_some());
        let part = |run: Range<usize>| {
            let first = run.start + index(area.left - whole.left);
            Columns::Run(first..first + index(area.width()))
        };
        let texel = |ramp: Ramp, i: i32, count: usize| {
            texture.wrapped(floor(ramp.at(i) * length(count)), count)
        };
        Self {
            is_texel_for_pixel,
            columns: run.map_or_else(
                || Columns::Table((area.left..area.right).map(|x| texel(u, x, width)).collect()),
                part,
            ),
            rows: (area.top..area.bottom).map(|y| texel(v, y, height)).collect(),
        }
    }
}

/// Returns the texels of these pixels, if each pixel shows the texel after that of the pixel
/// before.
fn run(ramp: Ramp, pixels: Range<i32>, count: usize, filter: Filter) -> Option<Range<usize>> {
    // The largest distance between the centres of a pixel and of its texel.
    let most = match filter {
        Filter::Nearest => 0.25,
        Filter::Linear => 1.0 / 512.0,
    };
    let texel = |pixel: i32| {
        let at = ramp.at(pixel) * length(count);
        let whole = floor(at);
        ((at - at.floor() - 0.5).abs() <= most).then_some(whole)
    };
    // The steps are equal, so the first and the last pixel decide for all between them.
    let (first, last) = (texel(pixels.start)?, texel(pixels.end - 1)?);
    let many = i64::from(pixels.end - 1 - pixels.start);
    let (first, last) = (usize::try_from(first).ok()?, usize::try_from(last - many).ok()?);
    let end = first + index(pixels.end - pixels.start);
    (first == last && end <= count).then_some(first..end)
}

/// Paints a picture that shows one texel per pixel.
fn paint_texels(
    strip: &mut Strip<'_>,
    area: PixelBox,
    texture: &Texture,
    (color, map): ([u8; 4], &Map),
) {
    // Opaque texels are copied; all others are blended.
    let is_copied = color == [255; 4] && texture.is_opaque;
    // The row of texels that the row of pixels above shows, if it was copied.
    let mut above = None;
    for (y, row) in (area.top..area.bottom).zip(&map.rows) {
        let place = strip.place(y, area.left, area.right);
        // An enlarged picture repeats rows of pixels, and copying is cheaper than painting.
        if above == Some(*row) {
            let last = place.start - strip.width..place.end - strip.width;
            strip.pixels.copy_within(last, place.start);
            continue;
        }
        let texels = texture.row(*row);
        let into = &mut strip.pixels[place];
        above = match &map.columns {
            Columns::Run(run) if is_copied => {
                into.iter_mut().zip(&texels[run.clone()]).for_each(|(to, it)| *to = packed(*it));
                Some(*row)
            }
            Columns::Table(table) if is_copied => {
                into.iter_mut().zip(table).for_each(|(to, x)| *to = packed(texels[*x]));
                Some(*row)
            }
            Columns::Run(run) => {
                into.iter_mut().zip(&texels[run.clone()]).for_each(|(to, it)| tint(to, color, *it));
                None
            }
            Columns::Table(table) => {
                into.iter_mut().zip(table).for_each(|(to, x)| tint(to, color, texels[*x]));
                None
            }
        };
    }
}

/// Paints a picture with pixels between texels, by linear filtering.
fn paint_between_texels(
    strip: &mut Strip<'_>,
    area: PixelBox,
    texture: &Texture,
    (color, u, v): ([u8; 4], Ramp, Ramp),
) {
    let [width, height] = texture.size();
    let color = color.map(f32::from);
    let across: Vec<Between> = (area.left..area.right)
        .map(|x| texture.between(single(u.at(x) * length(width)), width))
        .collect();
    // An enlarged picture has several rows of pixels between two rows of texels, so those are
    // interpolated across only once.
    let mut above = MixedRow::default();
    let mut below = MixedRow::default();
    for y in area.top..area.bottom {
        let down = texture.between(single(v.at(y) * length(height)), height);
        if below.row == Some(down.first) {
            std::mem::swap(&mut above, &mut below);
        }
        above.mix(texture, down.first, &across);
        below.mix(texture, down.next, &across);
        let row = strip.row(y, area.left, area.right);
        for ((pixel, above), below) in row.iter_mut().zip(&above.texels).zip(&below.texels) {
            let texel = mix(*above, *below, down.part);
            *pixel = over(*pixel, product(color, texel));
        }
    }
}

/// A row of texels, interpolated at each column of pixels.
#[derive(Default)]
struct MixedRow {
    row: Option<usize>,
    texels: Vec<[f32; 4]>,
}

impl MixedRow {
    /// Interpolates a row, unless that was done before.
    fn mix(&mut self, texture: &Texture, row: usize, across: &[Between]) {
        if self.row.replace(row) != Some(row) {
            let texels = texture.row(row);
            self.texels.clear();
            self.texels.extend(across.iter().map(|x| x.mixed(texels)));
        }
    }
}

/// A value that is linear along a row of a triangle: its value at pixel 0, and its step per pixel.
#[derive(Clone, Copy)]
struct Slope<const N: usize> {
    start: [f32; N],
    step: [f32; N],
}

/// Paints the part of a triangle in `area`. Pixels are counted from the column `left`, whatever the
/// part, so every part is painted alike.
fn paint_triangle(
    strip: &mut Strip<'_>,
    (left, area): (i32, PixelBox),
    texture: &Texture,
    corners: &[Corner; 3],
) {
    let Some(triangle) = Triangle::new(corners.map(|corner| corner.at)) else { return };
    let [first, others @ ..] = corners;
    // Triangles of one colour and one texel need no interpolation.
    let one_color = others.iter().all(|corner| corner.color == first.color);
    let one_place = others.iter().all(|corner| corner.uv == first.uv);
    let [width, height] = texture.size().map(length);
    let colors = corners.map(|corner| corner.color.map(f64::from));
    let places =
        corners.map(|corner| [f64::from(corner.uv[0]) * width, f64::from(corner.uv[1]) * height]);
    let ([step, _], whole) = (triangle.steps(), triangle.doubled_area());
    // The larger of the steps in texels per pixel selects the filter, as for pictures.
    let [across, down] = at_edges(step, whole, &places).map(f64::abs);
    let filter = texture.filter(across.max(down));
    let texel = texture.at(filter, single(places[0][0]), single(places[0][1]));
    for y in area.top..area.bottom {
        // The edge functions limit the row to the covered pixels; no pixel is tested.
        let edges = triangle.edges_at(left, y);
        let part = area.left - left..area.right - left;
        let Some(part) = span(edges, step, triangle.least(), part) else { continue };
        let row = strip.row(y, left + part.start, left + part.end);
        if one_place && one_color {
            lay(row, product(first.color.map(f32::from), texel));
            continue;
        }
        let color = Slope::new(edges, step, whole, &colors);
        let place = Slope::new(edges, step, whole, &places);
        for (i, pixel) in part.zip(row) {
            let texel = if one_place {
                texel
            } else {
                let [u, v] = place.at(i);
                texture.at(filter, u, v)
            };
            *pixel = over(*pixel, product(color.at(i), texel));
        }
    }
}

/// Interpolates a value from the edge functions at a point: the mean weighted by them.
fn at_edges<const N: usize>(edges: [i64; 3], whole: i64, values: &[[f64; N]; 3]) -> [f64; N] {
    #[expect(clippy::cast_precision_loss, reason = "weights need no more than 53 bits")]
    let weight = edges.map(|edge| edge as f64 / whole as f64);
    std::array::from_fn(|i| (0..3).map(|corner| values[corner][i] * weight[corner]).sum())
}

impl<const N: usize> Slope<N> {
    fn new(edges: [i64; 3], step: [i64; 3], whole: i64, values: &[[f64; N]; 3]) -> Self {
        let [start, step] = [edges, step].map(|edges| at_edges(edges, whole, values).map(single));
        Self { start, step }
    }

    #[expect(clippy::cast_precision_loss, reason = "a row has fewer than 2^24 pixels")]
    #[inline(always)]
    fn at(&self, i: i32) -> [f32; N] {
        std::array::from_fn(|n| self.start[n] + self.step[n] * i as f32)
    }
}

/// Returns the pixels of a part of a row at which no edge function is below its `least`. `edges`
/// are the values at pixel 0.
fn span(edges: [i64; 3], step: [i64; 3], least: [i64; 3], part: Range<i32>) -> Option<Range<i32>> {
    let (mut start, mut end) = (i64::from(part.start), i64::from(part.end));
    for ((edge, step), least) in edges.into_iter().zip(step).zip(least) {
        let room = edge - least;
        match step {
            0 if room < 0 => return None,
            0 => {}
            1.. => start = start.max(-room.div_euclid(step)),
            _ => end = end.min(room.div_euclid(-step) + 1),
        }
    }
    let within = |i: i64| i32::try_from(i).ok();
    if start < end { Some(within(start)?..within(end)?) } else { None }
}

fn plain_source(color: [u8; 4], uv: [f32; 2], texture: &Texture) -> [f32; 4] {
    let [width, height] = texture.size().map(length);
    let (u, v) = (f64::from(uv[0]) * width, f64::from(uv[1]) * height);
    product(color.map(f32::from), texture.at(texture.filter(0.0), single(u), single(v)))
}

#[expect(clippy::cast_possible_truncation, reason = "colours and texels need no more")]
fn single(value: f64) -> f32 {
    value as f32
}

#[expect(clippy::cast_possible_truncation, reason = "saturates far beyond every texture")]
fn floor(x: f64) -> i64 {
    x.floor() as i64
}

#[expect(clippy::cast_precision_loss, reason = "a picture has fewer than 2^53 columns")]
fn length(count: usize) -> f64 {
    count as f64
}

/// Converts an index of a pixel; pixels left of the picture or above it are never painted.
fn index(i: i32) -> usize {
    usize::try_from(i).unwrap_or(0)
}
