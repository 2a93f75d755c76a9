//! Edges of polygons and drawn normals: which lines there are, and which pixels a line takes.
//!
//! A pixel belongs to a line where the line leaves the pixel's diamond, the points nearer than half
//! a pixel to its centre in the sum of both directions: Vulkan's rule for Bresenham lines
//! ("Bresenham Line Segment Rasterization"). Lines that follow one another take no pixel twice. The
//! ends are snapped and everything is computed in whole numbers.

use glam::{DMat3, DVec3};

use super::clip::{Screen, ScreenVertex};
use super::coverage::{PixelBox, SUBPIXELS, Snapped, doubled_area};
use super::plan::{Back, Draw, Lines};
use crate::base::color::Color;
use crate::base::image::Size;
use crate::scene::{Corner, Mesh, NormalSource, dvec3};

/// How many steps of depth lines are nearer than the surfaces that they lie on.
const NEARER: u32 = 2;

/// A line on the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScreenLine {
    pub(super) ends: [ScreenVertex; 2],
    /// Its draw's place in the plan.
    pub(super) draw: u32,
    /// The polygon that picking finds.
    pub(super) polygon: u32,
    pub(super) color: [u8; 4],
    /// How many steps of depth it is nearer than it is.
    nearer: u32,
}

/// Adds the lines of a draw, whose vertices are on the screen.
pub(super) fn collect(
    draw: &Draw,
    index: u32,
    size: Size,
    vertices: &[ScreenVertex],
    lines: &mut Vec<ScreenLine>,
) {
    let Lines { edges, face_normals, vertex_normals, .. } = draw.lines;
    if !edges && face_normals.is_none() && vertex_normals.is_none() {
        return;
    }
    let screen = Screen::new(draw.clip_from_object, size);
    let mesh = &draw.model.mesh;
    let all = 0..u32::try_from(mesh.polygon_count()).expect("polygons have 32-bit numbers");
    let outlines: Vec<Option<Color>> =
        all.clone().map(|polygon| outline(draw, &screen, vertices, polygon)).collect();
    let mut add = |ends: [DVec3; 2], polygon: u32, color: Color, nearer: u32| {
        let clip = ends.map(|end| screen.clip(end.to_array()));
        if let Some(ends) = screen.segment(clip) {
            let color = color.opaque();
            lines.push(ScreenLine { ends, draw: index, polygon, color, nearer });
        }
    };
    if edges {
        let nearer = if draw.filled { NEARER } else { 0 };
        for edge in mesh.edges() {
            // The side that is not red decides where there are both.
            let shown = mesh.edge_polygons(edge).iter().filter_map(|&polygon| {
                let color = outlines[polygon as usize]?;
                Some((color == Color::BACK_FACE, polygon, color))
            });
            if let Some((_, polygon, color)) = shown.min_by_key(|shown| (shown.0, shown.1)) {
                let ends = edge.ends.map(|end| dvec3(mesh.positions()[end as usize]));
                add(ends, polygon, color, nearer);
            }
        }
    }
    if face_normals.is_some() || vertex_normals.is_some() {
        for (ends, polygon) in normals(draw, all) {
            add(ends, polygon, draw.lines.color, NEARER);
        }
    }
}

/// The colour of a polygon's outline; `None` where it is not drawn.
fn outline(draw: &Draw, screen: &Screen, vertices: &[ScreenVertex], polygon: u32) -> Option<Color> {
    let mesh = &draw.model.mesh;
    if !draw.shows(polygon) {
        return None;
    }
    let area: i64 = mesh
        .triangles_of(polygon)
        .map(|triangle| u32::try_from(triangle).expect("triangles have 32-bit numbers"))
        .map(|triangle| area_on_screen(mesh, screen, vertices, triangle))
        .sum();
    let front = (area < 0) != draw.mirrored;
    match draw.back {
        _ if area == 0 => None,
        Back::Lit => Some(draw.lines.color),
        _ if front => Some(draw.lines.color),
        Back::Red => Some(Color::BACK_FACE),
        Back::Left => None,
    }
}

/// Twice the area of what is seen of a triangle, in square parts of a pixel.
fn area_on_screen(mesh: &Mesh, screen: &Screen, vertices: &[ScreenVertex], triangle: u32) -> i64 {
    let order = mesh.draw_order();
    let corners = order.vertices_of(triangle);
    let own = corners.map(|vertex| vertices[vertex as usize]);
    if own.iter().all(ScreenVertex::is_inside) {
        return doubled_area(own.map(|corner| corner.at()));
    }
    let pieces = screen.cut(corners.map(|vertex| screen.clip(order.position(vertex))));
    let piece = |i: usize| doubled_area([pieces[0], pieces[i - 1], pieces[i]].map(|p| p.at()));
    (2..pieces.len()).map(piece).sum()
}

/// The normals of polygons that are shown, whichever way they face, in object space.
fn normals(draw: &Draw, polygons: std::ops::Range<u32>) -> Vec<([DVec3; 2], u32)> {
    let mesh = &draw.model.mesh;
    let mut normals = Vec::new();
    let mut drawn = vec![false; mesh.points().len()];
    for polygon in polygons {
        if !draw.shows(polygon) {
            continue;
        }
        let mut add = |from: DVec3, normal: [f32; 3], length: f64| {
            let to = from + normal_in_object(draw, dvec3(normal), length);
            normals.push(([from, to], polygon));
        };
        if let Some(length) = draw.lines.face_normals {
            let normal = mesh.polygon_normals()[polygon as usize];
            add(mesh.polygon_centre(polygon), normal, length);
        }
        let Some(length) = draw.lines.vertex_normals else { continue };
        for corner in mesh.polygon(polygon) {
            let point = point_of(draw, corner) as usize;
            if !std::mem::replace(&mut drawn[point], true) {
                let point = mesh.points()[point];
                let from = mesh.positions()[point.position as usize];
                add(dvec3(from), point.normal, length);
            }
        }
    }
    normals
}

/// The point of a corner with the vertex normals that the draw uses.
fn point_of(draw: &Draw, corner: &Corner) -> u32 {
    match draw.normal_source {
        NormalSource::File => corner.filed,
        NormalSource::Computed => corner.smooth,
    }
}

/// A drawn normal in object space: it stands on the placed surface, and is as long as `length` units
/// of object space along the unplaced normal.
fn normal_in_object(draw: &Draw, normal: DVec3, length: f64) -> DVec3 {
    let linear = DMat3::from_mat4(draw.view_from_object);
    let across = linear.inverse() * (draw.view_from_normal * normal);
    let scale = (linear * normal).length() / (linear * across).length();
    if scale.is_finite() { across * (scale * length) } else { normal * length }
}

/// The pixels that a line may take.
pub(super) fn bounds(line: &ScreenLine, width: i32) -> PixelBox {
    let [a, b] = line.ends.map(|end| end.at());
    let low = |p: i32, q: i32| p.min(q).div_euclid(SUBPIXELS) - width;
    let high = |p: i32, q: i32| p.max(q).div_euclid(SUBPIXELS) + 1 + width;
    PixelBox {
        left: low(a.x, b.x),
        top: low(a.y, b.y),
        right: high(a.x, b.x),
        bottom: high(a.y, b.y),
    }
}

/// Calls `take` with every pixel of a line inside `clip`, and with the depth there.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "the nearest number is meant"
)]
pub(super) fn pixels(
    line: &ScreenLine,
    width: i32,
    clip: PixelBox,
    mut take: impl FnMut(i32, i32, f32),
) {
    let [a, b] = line.ends;
    let steep = (b.at().y - a.at().y).abs() > (b.at().x - a.at().x).abs();
    // Along the major axis u, and across it v. A wide line has its middle on the segment: the
    // segment is moved back by half of what it gains, and each of its pixels is repeated.
    let shift = (width - 1) * SUBPIXELS / 2;
    let turn = |p: ScreenVertex| {
        let Snapped { x, y } = p.at();
        if steep { (y, x - shift) } else { (x, y - shift) }
    };
    let ((ua, va), (ub, vb)) = (turn(a), turn(b));
    let (du, dv) = (i64::from(ub) - i64::from(ua), i64::from(vb) - i64::from(va));
    if du == 0 {
        return;
    }
    let (first, last) = if steep { (clip.top, clip.bottom) } else { (clip.left, clip.right) };
    let begin = ua.min(ub).div_euclid(SUBPIXELS).max(first);
    let end = (ua.max(ub).div_euclid(SUBPIXELS) + 1).min(last);
    for u in begin..end {
        let centre = i64::from(u) * i64::from(SUBPIXELS) + i64::from(SUBPIXELS / 2);
        let along = centre - i64::from(ua);
        // v where the line crosses the middle of the column: (va du + dv along) / du, rounded down.
        let (above, below) = (i64::from(va) * du + dv * along, du * i64::from(SUBPIXELS));
        let v = (above * below.signum()).div_euclid(below.abs());
        let Ok(v) = i32::try_from(v) else { continue };
        if !leaves(u, v, along, du, (ua, va), (ub, vb)) {
            continue;
        }
        let t = (along as f64 / du as f64).clamp(0.0, 1.0);
        let depth = f64::from(a.depth) + t * (f64::from(b.depth) - f64::from(a.depth));
        let depth = nearer(depth as f32, line.nearer);
        for side in 0..width {
            let v = v + side;
            let (x, y) = if steep { (v, u) } else { (u, v) };
            let inside = x >= clip.left && x < clip.right && y >= clip.top && y < clip.bottom;
            if inside {
                take(x, y, depth);
            }
        }
    }
}

/// Whether a line leaves the diamond of the pixel in whose column it is.
fn leaves(u: i32, v: i32, along: i64, du: i64, from: (i32, i32), to: (i32, i32)) -> bool {
    let half = SUBPIXELS / 2;
    let within = |(pu, pv): (i32, i32)| {
        let (cu, cv) = (u * SUBPIXELS + half, v * SUBPIXELS + half);
        (pu - cu).abs() + (pv - cv).abs() < half
    };
    if within(to) {
        return false;
    }
    let crosses = if du > 0 { along >= 0 && along <= du } else { along <= 0 && along >= du };
    crosses || within(from)
}

/// A depth that is some steps nearer.
fn nearer(depth: f32, steps: u32) -> f32 {
    f32::from_bits(depth.to_bits() + steps).min(1.0)
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
mod tests {
    use super::*;

    const EVERYWHERE: PixelBox = PixelBox { left: -99, top: -99, right: 99, bottom: 99 };

    fn drawn(ends: [(f64, f64); 2]) -> Vec<(i32, i32)> {
        drawn_wide(ends, 1)
    }

    fn drawn_wide(ends: [(f64, f64); 2], width: i32) -> Vec<(i32, i32)> {
        let vertex = |(x, y): (f64, f64)| {
            ScreenVertex::new(Snapped { x: (x * 256.0) as i32, y: (y * 256.0) as i32 }, 0.5)
        };
        let line =
            ScreenLine { ends: ends.map(vertex), draw: 0, polygon: 0, color: [0; 4], nearer: 0 };
        let mut pixels = Vec::new();
        super::pixels(&line, width, EVERYWHERE, |x, y, _| pixels.push((x, y)));
        pixels.sort_unstable();
        pixels
    }

    /// The rule itself, tried at many places of the line: the last place inside a diamond is not the
    /// end of the line.
    fn by_the_rule([from, to]: [(f64, f64); 2]) -> Vec<(i32, i32)> {
        let n = 200_000;
        let mut entered = Vec::new();
        let inside = |x: f64, y: f64| {
            let (column, row) = (x.floor(), y.floor());
            ((x - column - 0.5).abs() + (y - row - 0.5).abs() < 0.5)
                .then_some((column as i32, row as i32))
        };
        for i in 0..=n {
            let t = f64::from(i) / f64::from(n);
            let at = inside(from.0 + (to.0 - from.0) * t, from.1 + (to.1 - from.1) * t);
            entered.extend(at.filter(|pixel| entered.last() != Some(pixel)));
        }
        if let Some(last) = inside(to.0, to.1) {
            entered.retain(|pixel| *pixel != last);
        }
        entered.sort_unstable();
        entered.dedup();
        entered
    }

    #[test]
    fn a_line_takes_the_pixels_whose_diamonds_it_leaves() {
        let lines = [
            [(0.3, 0.4), (9.7, 3.9)],
            [(9.7, 3.9), (0.3, 0.4)],
            [(5.2, -7.6), (3.1, 8.4)],
            [(3.1, 8.4), (5.2, -7.6)],
            [(0.6, 0.55), (4.45, 4.6)],
            [(2.05, 2.45), (2.9, 2.55)],
            [(-3.4, 6.3), (4.4, -1.7)],
            [(1.9, 1.9), (2.1, 7.2)],
        ];
        for ends in lines {
            let snapped = ends.map(|(x, y): (f64, f64)| {
                ((x * 256.0).trunc() / 256.0, (y * 256.0).trunc() / 256.0)
            });
            assert_eq!(drawn(ends), by_the_rule(snapped), "{ends:?}");
        }
    }

    #[test]
    fn a_line_two_pixels_wide_has_its_middle_on_the_segment() {
        // Along the border of rows 4 and 5, and of columns 4 and 5.
        let level = drawn_wide([(0.5, 5.0), (3.5, 5.0)], 2);
        assert_eq!(level, [(0, 4), (0, 5), (1, 4), (1, 5), (2, 4), (2, 5)]);
        let upright = drawn_wide([(5.0, 0.5), (5.0, 3.5)], 2);
        assert_eq!(upright, [(4, 0), (4, 1), (4, 2), (5, 0), (5, 1), (5, 2)]);
    }

    #[test]
    fn two_lines_that_follow_one_another_take_no_pixel_twice() {
        let (a, b, c) = ((0.3, 0.4), (5.6, 2.3), (9.1, 7.7));
        let first = drawn([a, b]);
        assert!(drawn([b, c]).iter().all(|pixel| !first.contains(pixel)));
    }
}
