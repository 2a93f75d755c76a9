//! The items that a frame is painted from: rectangles of one colour, upright pictures, triangles.
//!
//! egui's meshes consist of triangles. Most triangles come in pairs that make an upright rectangle.
//! This module finds the pairs, since a rectangle is painted many times faster than two triangles.
//!
//! Corners are snapped to 1/256 pixel, as in graphics cards, and pixel centres decide coverage by
//! the top-left rule: rectangles and triangles that share an edge leave no gap between them, and
//! paint no pixel twice.

use std::hash::{DefaultHasher, Hash, Hasher};

use egui::epaint::{Mesh, Vertex};
use egui::{Pos2, Rect};

use marraztu_render::screen::coverage::{PixelBox, SUBPIXELS, Snapped, Triangle};

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    pub(crate) at: Snapped,
    /// From 0 to 1 across the texture, to the right and down.
    pub(crate) uv: [f32; 2],
    /// Red, green, blue, alpha; premultiplied.
    pub(crate) color: [u8; 4],
}

/// A texture coordinate as a function of the column or row of pixels: `start + step * i` at the
/// centre of pixel i, from 0 to 1 across the texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ramp {
    pub(crate) start: f64,
    pub(crate) step: f64,
}

/// One item to paint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    /// An upright rectangle of one colour, which is multiplied by one texel.
    Plain { color: [u8; 4], uv: [f32; 2] },
    /// An upright rectangle of a texture, multiplied by a colour.
    Picture { color: [u8; 4], u: Ramp, v: Ramp },
    /// A triangle.
    Triangle([Corner; 3]),
}

/// One item to paint, and the pixels that it may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Item {
    pub(crate) area: PixelBox,
    pub(crate) shape: Shape,
    /// A hash of the item: equal items have equal keys, and other items almost certainly do not.
    pub(crate) key: u64,
}

/// Converts a clip rectangle from points to pixels of a picture of this size.
pub(crate) fn clip_area(clip: Rect, scale: f32, [width, height]: [usize; 2]) -> PixelBox {
    let most = |count: usize| i32::try_from(count).unwrap_or(i32::MAX);
    let (width, height) = (most(width), most(height));
    let at =
        |points: f32, least: i32, most: i32| rounded(f64::from(points * scale)).clamp(least, most);
    let (left, top) = (at(clip.min.x, 0, width), at(clip.min.y, 0, height));
    PixelBox { left, top, right: at(clip.max.x, left, width), bottom: at(clip.max.y, top, height) }
}

/// Adds the items of a mesh that lie in `clip`, in their order.
pub(crate) fn items_of(mesh: &Mesh, clip: PixelBox, scale: f32, items: &mut Vec<Item>) {
    let corners: Vec<Corner> = mesh.vertices.iter().map(|vertex| corner(vertex, scale)).collect();
    let triangle = |first: usize| -> Option<[Corner; 3]> {
        let [a, b, c] = *mesh.indices.get(first..first + 3)?.first_chunk()?;
        let of = |index: u32| corners.get(usize::try_from(index).ok()?).copied();
        Some([of(a)?, of(b)?, of(c)?])
    };
    // A pair of triangles that makes a rectangle is taken at once, else one triangle.
    let mut first = 0;
    while first + 3 <= mesh.indices.len() {
        let Some(one) = triangle(first) else { return };
        first += 3;
        let pair = triangle(first).and_then(|other| upright(&one, &other));
        let (area, shape) = match pair {
            Some(found) => {
                first += 3;
                found
            }
            None => match Triangle::new(one.map(|corner| corner.at)) {
                Some(set_up) => (set_up.bounds(), Shape::Triangle(one)),
                None => continue,
            },
        };
        let area = area.intersection(clip);
        // Wholly transparent items change no pixel.
        if !area.is_empty() && !is_nothing(&shape) {
            items.push(Item { area, shape, key: key(area, &shape) });
        }
    }
}

fn is_nothing(shape: &Shape) -> bool {
    match shape {
        Shape::Plain { color, .. } | Shape::Picture { color, .. } => *color == [0; 4],
        Shape::Triangle(corners) => corners.iter().all(|corner| corner.color == [0; 4]),
    }
}

fn corner(vertex: &Vertex, scale: f32) -> Corner {
    let Pos2 { x, y } = vertex.pos;
    let snapped = |at: f32| rounded(f64::from(at) * f64::from(scale) * f64::from(SUBPIXELS));
    // The edge functions are exact within this range.
    let within = |at: i32| at.clamp(-(1 << 27), 1 << 27);
    Corner {
        at: Snapped { x: within(snapped(x)), y: within(snapped(y)) },
        uv: [vertex.uv.x, vertex.uv.y],
        color: vertex.color.to_array(),
    }
}

#[expect(clippy::cast_possible_truncation, reason = "saturates beyond every picture")]
fn rounded(x: f64) -> i32 {
    x.round() as i32
}

/// Finds the rectangle that two triangles make, if it is upright, has one colour and shows an
/// upright part of its texture.
fn upright(one: &[Corner; 3], other: &[Corner; 3]) -> Option<(PixelBox, Shape)> {
    let color = one[0].color;
    let all = || one.iter().chain(other);
    if all().any(|corner| corner.color != color) {
        return None;
    }
    // All corners must be corners of the bounding box of the first triangle.
    let least = |pick: fn(&Corner) -> i32| one.iter().map(pick).min();
    let most = |pick: fn(&Corner) -> i32| one.iter().map(pick).max();
    let (left, right) = (least(|p| p.at.x)?, most(|p| p.at.x)?);
    let (top, bottom) = (least(|p| p.at.y)?, most(|p| p.at.y)?);
    if left == right || top == bottom {
        return None;
    }
    // Bit 0: right, bit 1: below. Each triangle lacks one corner, and the two are opposite.
    let mut uvs = [None; 4];
    let mut corners_of = |triangle: &[Corner; 3]| -> Option<u8> {
        let mut seen = 0;
        for Corner { at, uv, .. } in triangle {
            if (at.x != left && at.x != right) || (at.y != top && at.y != bottom) {
                return None;
            }
            let place = usize::from(at.x == right) | usize::from(at.y == bottom) << 1;
            if *uvs[place].get_or_insert(*uv) != *uv {
                return None;
            }
            seen |= 1 << place;
        }
        Some(seen)
    };
    let (seen, seen_by_other) = (corners_of(one)?, corners_of(other)?);
    let lacks = |seen: u8| (seen.count_ones() == 3).then(|| (seen ^ 0b1111).trailing_zeros());
    if lacks(seen)? != lacks(seen_by_other)? ^ 3 {
        return None;
    }
    // The texture coordinates must be upright too: u depends on the column alone, v on the row.
    let [a, b, c, d] = [uvs[0]?, uvs[1]?, uvs[2]?, uvs[3]?];
    if [a[0], b[0]] != [c[0], d[0]] || [a[1], c[1]] != [b[1], d[1]] {
        return None;
    }
    let shape = match a == d {
        true => Shape::Plain { color, uv: a },
        false => {
            let (u, v) =
                (Ramp::new([left, right], a[0], b[0]), Ramp::new([top, bottom], a[1], c[1]));
            Shape::Picture { color, u, v }
        }
    };
    // The first centre at or after each side. A centre on the right or lower side is not covered.
    let first = |at: i32| (at + SUBPIXELS / 2 - 1).div_euclid(SUBPIXELS);
    let area =
        PixelBox { left: first(left), top: first(top), right: first(right), bottom: first(bottom) };
    Some((area, shape))
}

impl Ramp {
    /// Creates the ramp from `from` to `to` between two positions in subpixels.
    fn new([begin, end]: [i32; 2], from: f32, to: f32) -> Self {
        let pixels = f64::from(end - begin) / f64::from(SUBPIXELS);
        let step = (f64::from(to) - f64::from(from)) / pixels;
        let start = f64::from(from) + step * (0.5 - f64::from(begin) / f64::from(SUBPIXELS));
        Self { start, step }
    }

    /// Returns the coordinate at the centre of pixel `i`.
    pub(crate) fn at(self, i: i32) -> f64 {
        self.start + self.step * f64::from(i)
    }
}

fn key(area: PixelBox, shape: &Shape) -> u64 {
    let mut hasher = DefaultHasher::new();
    (area.left, area.top, area.right, area.bottom).hash(&mut hasher);
    match shape {
        Shape::Plain { color, uv } => (0, color, uv.map(f32::to_bits)).hash(&mut hasher),
        Shape::Picture { color, u, v } => {
            let bits = [u.start, u.step, v.start, v.step].map(f64::to_bits);
            (1, color, bits).hash(&mut hasher);
        }
        Shape::Triangle(corners) => {
            for Corner { at, uv, color } in corners {
                (at.x, at.y, uv.map(f32::to_bits), color).hash(&mut hasher);
            }
        }
    }
    hasher.finish()
}
