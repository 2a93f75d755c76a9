//! Culls clusters of triangles outside the view frustum, and back-facing ones.
//!
//! A culled triangle would also be culled individually during setup, so no pixel changes. A cluster
//! is therefore culled only if this holds for each of its triangles after snapping, which reverses
//! some of the thinnest ones.

use glam::{DMat3, DVec3};

use crate::accel::{CLUSTER, Cluster, DrawTriangle};
use crate::frame::Viewport;
use crate::frame::draw::{Back, Draw};
use crate::screen::clip::{Clip, Screen};
use crate::screen::coverage::SUBPIXELS;
use marraztu_core::base::image::Size;

/// The thinnest and the smallest triangles on the screen that snapping cannot reverse: height in
/// pixels over the longest side, and doubled area in square pixels.
///
/// Snapping moves a corner by half a subpixel on each axis. Sides e and f change by at most sqrt 2
/// subpixels, and their product (twice the area) by 2 sqrt 2 subpixels times the longer side plus 2
/// square subpixels. Half of the area has to exceed each of the two; another fifth covers rounding.
const THINNEST: f64 = 1.2 * 2.0 * 2.0 * std::f64::consts::SQRT_2 / SUBPIXELS as f64;
const SMALLEST: f64 = 1.2 * 2.0 * 2.0 / (SUBPIXELS as f64 * SUBPIXELS as f64);

/// A margin around the picture, in pixels; nothing inside it counts as out of view.
const MARGIN: f64 = 2.0;

/// Returns the transform to a picture, or a window of one, with clipping planes this many pixels
/// beyond its border.
fn close_to_picture(screen: Screen, size: Size, pixels: f64) -> Screen {
    let (Viewport { width, height }, [left, top]) = (size.into(), screen.shift_in_pixels());
    let half = [width / 2.0, height / 2.0];
    screen.close_to([left + half[0], top + half[1]], half.map(|half| half + pixels))
}

/// The culling of one draw.
#[derive(Debug)]
pub(crate) struct Culling {
    screen: Screen,
    /// The transform to the drawn picture, with clipping planes close to its border.
    view: Screen,
    /// The gradient lengths of both sets of distances, and the lengths of the rows of clip space.
    slopes: [[f64; 6]; 2],
    rows: [f64; 4],
    /// The function g(p) = `at_origin` + `along` p. A face is turned away if the dot product of g
    /// and its normal is positive.
    at_origin: DVec3,
    along: f64,
    /// Whether back-facing triangles are culled.
    one_sided: bool,
}

impl Culling {
    /// Prepares to cull a draw for a picture, or a window of one, of this size.
    pub(crate) fn new(draw: &Draw, screen: Screen, size: Size) -> Self {
        Self::with(screen, size, draw.mirrored, draw.back == Back::Culled)
    }

    fn with(screen: Screen, size: Size, mirrored: bool, one_sided: bool) -> Self {
        let view = close_to_picture(screen, size, MARGIN);
        // Twice the area of a triangle on the screen, with the corners (x, y, w) = M p + t, is
        //
        //   -half_x half_y det[M p_i + t] / (w0 w1 w2),   det = (h p0 - e) . n,
        //
        // with n = (p1 - p0) x (p2 - p0), h = det M, and e = -adj(M) t, which is h times the
        // observer's position.
        let row = |i: usize| DVec3::from_slice(&screen.rows[i][..3]);
        let (x, y, w) = (row(0), row(1), row(3));
        let t = DVec3::new(screen.rows[0][3], screen.rows[1][3], screen.rows[3][3]);
        let adjugate = DMat3::from_cols(y.cross(w), w.cross(x), x.cross(y));
        let (h, e) = (x.dot(y.cross(w)), -(adjugate * t));
        let side = if mirrored { 1.0 } else { -1.0 } * screen.half[0] * screen.half[1];
        Self {
            slopes: [screen.slopes(), view.slopes()],
            rows: screen.rows.map(|row| DVec3::from_slice(&row[..3]).length()),
            at_origin: -e * side,
            along: h * side,
            one_sided,
            screen,
            view,
        }
    }

    /// Calls `each` with the ranges of triangles that are not culled. Adjacent clusters are merged
    /// into one range, to be set up together.
    pub(crate) fn each_left(
        &self,
        clusters: &[Cluster],
        triangles: &[DrawTriangle],
        mut each: impl FnMut(&[DrawTriangle]),
    ) {
        let mut from = 0;
        for (cluster, start) in clusters.iter().zip((0..triangles.len()).step_by(CLUSTER)) {
            if self.leaves_out(cluster) {
                if from < start {
                    each(&triangles[from..start]);
                }
                from = start + CLUSTER;
            }
        }
        if from < triangles.len() {
            each(&triangles[from..]);
        }
    }

    /// Returns whether a cluster is culled.
    pub(crate) fn leaves_out(&self, cluster: &Cluster) -> bool {
        let centre = cluster.centre.map(f64::from);
        let radius = f64::from(cluster.radius);
        let clip = self.screen.clip(centre);
        let far = |slope: &f64| slope * radius;
        // Frustum culling: the bounding sphere is outside one of the planes close to the picture.
        let distances = self.view.distances(self.view.clip(centre));
        if distances.iter().zip(&self.slopes[1]).any(|(at, slope)| *at < -far(slope)) {
            return true;
        }
        // Back-face culling only works for clusters that are not clipped.
        let distances = self.screen.distances(clip);
        let uncut = distances.iter().zip(&self.slopes[0]).all(|(at, slope)| *at > far(slope));
        self.one_sided && uncut && self.is_turned_away(cluster, (centre.into(), radius), clip)
    }

    /// Returns whether all triangles of a cluster are back-facing, even after snapping. None of
    /// them may be clipped.
    fn is_turned_away(
        &self,
        cluster: &Cluster,
        (centre, radius): (DVec3, f64),
        [x, y, _, w]: Clip,
    ) -> bool {
        let g = self.at_origin + centre * self.along;
        let axis = DVec3::from(cluster.axis.map(f64::from)).normalize_or_zero();
        let (reach, cosine) = (g.length(), f64::from(cluster.cosine));
        let off_axis = axis.dot(g) / reach;
        // The smallest cosine to any normal of the cone: cos(a + b), both angles below 90 degrees.
        let sines = ((1.0 - off_axis * off_axis) * (1.0 - cosine * cosine)).max(0.0).sqrt();
        let least = reach * (off_axis * cosine - sines) - self.along.abs() * radius;
        let [rx, ry, _, rw] = self.rows.map(|row| row * radius);
        let (nearest, farthest) = (w - rw, w + rw);
        let most = [(x.abs() + rx) / nearest, (y.abs() + ry) / nearest];
        // The largest length on the screen, in pixels, of one unit of object space.
        let [half_x, half_y] = self.screen.half;
        let [across, down] = [
            half_x * (self.rows[0] + most[0] * self.rows[3]),
            half_y * (self.rows[1] + most[1] * self.rows[3]),
        ];
        // Not `hypot`: calling it takes a hundredth of a frame of a million triangles.
        let longest = (across * across + down * down).sqrt() / nearest;
        let per_area = least / (farthest * farthest * farthest);
        // Any NaN makes a comparison false, and the cluster is kept.
        off_axis > 0.0
            && cosine > 0.0
            && nearest > 0.0
            && per_area * f64::from(cluster.least_height) > THINNEST * longest
            && per_area * f64::from(cluster.least_area) > SMALLEST
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DQuat};

    use super::*;
    use crate::accel::Accelerated as _;
    use crate::screen::clip::ScreenVertex;
    use crate::screen::coverage::doubled_area;
    use marraztu_core::base::rng::Rng;
    use marraztu_core::scene::{Lens, Mesh, MeshSource, Projection, SourceCorner};

    /// Returns a ball with corners displaced by at most `off`, so some triangles are slivers.
    fn ball(rows: u32, off: f64, rng: &mut Rng) -> Mesh {
        let columns = 2 * rows;
        let mut positions = Vec::new();
        for (row, column) in (0..=rows).flat_map(|row| (0..columns).map(move |c| (row, c))) {
            let up = std::f64::consts::PI * f64::from(row) / f64::from(rows);
            let round = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
            let (sine, cosine) = (libm::sin(up), libm::cos(up));
            let place = DVec3::new(sine * libm::sin(round), cosine, sine * libm::cos(round));
            positions.push((place + rng.vector(1.0) * off).as_vec3().to_array());
        }
        let mut corners = Vec::new();
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |c| (row, c))) {
            let at = |down: u32, right: u32| (row + down) * columns + (column + right) % columns;
            corners.extend([at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)]);
        }
        let arities = vec![3; corners.len() / 3];
        let corners = corners.into_iter().map(SourceCorner::bare);
        let source = MeshSource { positions, ..MeshSource::of_polygons(corners, arities) };
        Mesh::new(source).unwrap()
    }

    #[test]
    fn every_culled_triangle_faces_away_or_is_out_of_view() {
        let mut rng = Rng::new(1);
        let size = Size::new(640, 400);
        let (mut looked_at, mut left_out, mut turned_away) = (0, 0, 0);
        for round in 0..300 {
            let rough = [0.0, 0.001, 0.01, 0.05][round % 4];
            let mesh = ball([12, 24, 60][round % 3], rough, &mut rng);
            let order = mesh.draw_order();
            // From far away, where triangles are smaller than a subpixel, to inside the ball.
            let far = libm::exp(4.0 + 5.0 * rng.real(-1.0, 1.0));
            let stretch = DVec3::ONE + rng.vector(1.0) * 0.9;
            let mirror = if round % 5 == 0 { -1.0 } else { 1.0 };
            let turn = DQuat::from_scaled_axis(rng.vector(1.0) * 3.0);
            let object = DMat4::from_scale_rotation_translation(
                stretch * DVec3::new(mirror, 1.0, 1.0),
                turn,
                DVec3::new(rng.real(-1.0, 1.0) * 0.5 * far, rng.real(-1.0, 1.0) * 0.5 * far, -far),
            );
            let lens = Lens {
                near: 0.01,
                far: 4.0 * far,
                half_size: far,
                parallel_near: 0.01,
                parallel_far: 2.0 * far + 2.0,
                ..Lens::default()
            };
            let projection = match round % 7 {
                0 => Projection::Orthographic,
                _ => Projection::Perspective,
            };
            let lens = lens.clip_from_view(projection, size);
            let screen = Screen::new(lens * object, size);
            let culling = Culling::with(screen, size, mirror < 0.0, true);
            for (i, cluster) in order.clusters.iter().enumerate() {
                looked_at += 1;
                if !culling.leaves_out(cluster) {
                    continue;
                }
                left_out += 1;
                let triangles = order.triangles[i * CLUSTER..].iter().take(CLUSTER);
                for triangle in triangles {
                    let corners =
                        triangle.vertices.map(|vertex| screen.clip(order.position(vertex)));
                    let vertices = corners.map(|corner| screen.vertex(corner));
                    if vertices.iter().all(ScreenVertex::is_inside) {
                        let at = vertices.map(|vertex| vertex.at());
                        let area = doubled_area(at) * if mirror < 0.0 { -1 } else { 1 };
                        let [x, y] = [at.map(|at| at.x), at.map(|at| at.y)];
                        let beyond = |row: [i32; 3], pixels: i32| {
                            row.iter().all(|a| *a < -SUBPIXELS)
                                || row.iter().all(|a| *a > (pixels + 1) * SUBPIXELS)
                        };
                        let out = beyond(x, 640) || beyond(y, 400);
                        assert!(area > 0 || out, "round {round}, {area}: {at:?}");
                        turned_away += usize::from(!out);
                    } else {
                        let pieces = close_to_picture(screen, size, 1.0).cut(corners);
                        assert!(pieces.is_empty(), "round {round}: {pieces:?}");
                    }
                }
            }
        }
        assert!(left_out * 6 > looked_at, "{left_out} of {looked_at}");
        assert!(turned_away > 50_000, "{turned_away}");
    }
}
