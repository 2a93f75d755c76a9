//! What is known of one triangle that a pixel shows.

use glam::DVec3;

use super::clip::{Screen, ScreenVertex, faces_observer, homogeneous_weights};
use super::coverage::{Snapped, Triangle, doubled_area};
use super::effects::Light;
use super::light::Lit;
use super::plan::{Back, Draw, Eye, FramePlan};
use crate::base::math::each;
use crate::scene::{LightAt, Normals};

/// The largest box, in parts of a pixel, whose edge functions fit 31 bits inside.
const NARROW: i32 = 1 << 14;

/// What is known of one triangle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Corners<T> {
    pub(super) at: [Snapped; 3],
    /// Of each corner: its normal in object space, where light is evaluated per pixel, and one by w.
    pub(super) corners: [[T; 4]; 3],
    /// z in view space; in parallel projection only.
    pub(super) z: [T; 3],
    /// Diffuse and specular light; where it is not evaluated per pixel.
    pub(super) light: [[[T; 4]; 2]; 3],
    /// Whether it reaches beyond the planes that triangles are cut by.
    pub(super) cut: bool,
    /// Its edges, where their functions do not fit 31 bits inside.
    pub(super) wide: Option<Wide>,
    pub(super) back: bool,
}

/// A triangle whose edge functions need 64 bits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wide {
    pub(super) triangle: Triangle,
    pub(super) per_area: f64,
}

impl<T: Light> Corners<T> {
    #[inline(always)]
    pub(super) fn new(
        plan: &FramePlan,
        draw: &Draw,
        vertices: &[ScreenVertex],
        number: u32,
    ) -> Self {
        let mut corners = Self::default();
        corners.take(plan, draw, vertices, number);
        corners
    }

    /// Takes what is known of another triangle, but for its normals and its light. In place, since
    /// this is done for every triangle that is seen.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        plan: &FramePlan,
        draw: &Draw,
        vertices: &[ScreenVertex],
        number: u32,
    ) {
        let order = draw.model.mesh.draw_order();
        let ids = order.vertices_of(number);
        let own = each(ids, |vertex| vertices[vertex as usize]);
        let at = each(own, |vertex| vertex.at());
        let cut = !(own[0].is_inside() & own[1].is_inside() & own[2].is_inside());
        (self.at, self.cut, self.wide) = (at, cut, None);
        if !cut && (T::EXACT || !is_narrow(at)) {
            self.wide = Wide::new(at);
        }
        if draw.back != Back::Left {
            let screen = Screen::new(draw.clip_from_object, plan.size);
            self.back = shows_back(draw, &screen, number, (!cut).then_some(at));
        }
        if T::EXACT {
            let screen = Screen::new(draw.clip_from_object, plan.size);
            let w = ids.map(|vertex| screen.clip(order.position(vertex))[3]);
            for (corner, w) in self.corners.iter_mut().zip(w) {
                corner[3] = T::from_f64(1.0 / w);
            }
        } else {
            for (corner, vertex) in self.corners.iter_mut().zip(own) {
                corner[3] = T::from_f64(f64::from(vertex.inverse_w));
            }
        }
        if plan.eye == Eye::Parallel {
            self.z = ids.map(|vertex| {
                let place = DVec3::from_array(order.position(vertex));
                T::from_f64(draw.view_from_object.transform_point3(place).z)
            });
        }
    }

    /// The parts that the corners have in a pixel, with perspective, in f64.
    pub(super) fn weights(
        &self,
        plan: &FramePlan,
        draw: &Draw,
        number: u32,
        pixel: [i32; 2],
    ) -> DVec3 {
        if self.cut {
            return cut_weights(plan, draw, number, pixel);
        }
        let [second, third] = self.wide.map_or([0.0; 2], |wide| wide.barycentric(pixel));
        let linear = DVec3::new(1.0 - second - third, second, third);
        let by_w = linear * DVec3::from_array(self.corners.map(|corner| corner[3].into()));
        by_w / by_w.element_sum()
    }
}

impl Wide {
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    fn new(at: [Snapped; 3]) -> Option<Self> {
        let triangle = Triangle::new(at)?;
        Some(Self { triangle, per_area: 1.0 / triangle.doubled_area() as f64 })
    }

    /// The second and third barycentric coordinate of a pixel, linear on the screen.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    pub(super) fn barycentric(&self, [x, y]: [i32; 2]) -> [f64; 2] {
        let [_, second, third] = self.triangle.edges_at(x, y);
        [second as f64 * self.per_area, third as f64 * self.per_area]
    }
}

#[inline(always)]
fn is_narrow([a, b, c]: [Snapped; 3]) -> bool {
    let extent = |a: i32, b: i32, c: i32| a.max(b).max(c) - a.min(b).min(c);
    extent(a.x, b.x, c.x) <= NARROW && extent(a.y, b.y, c.y) <= NARROW
}

/// Takes the normals at the corners, in object space.
#[inline(always)]
pub(super) fn gather_places<T: Light>(draw: &Draw, number: u32, corners: &mut Corners<T>) {
    let normals = match draw.normals {
        Normals::Face => {
            let mesh = &draw.model.mesh;
            let own = mesh.triangles()[number as usize];
            [mesh.polygon_normals()[own.polygon as usize]; 3]
        }
        Normals::Vertex => {
            let order = draw.model.mesh.draw_order();
            let points = order.points(draw.normal_source);
            each(points.of[order.place(number)], |point| points.normals[point as usize])
        }
    };
    for (corner, [x, y, z]) in corners.corners.iter_mut().zip(normals) {
        corner[0] = T::from_f64(f64::from(x));
        corner[1] = T::from_f64(f64::from(y));
        corner[2] = T::from_f64(f64::from(z));
    }
}

/// Takes light that was evaluated at the triangle's polygon or vertices.
pub(super) fn gather_light<T: Light>(
    plan: &FramePlan,
    lit: &Lit<T>,
    (index, draw): (u32, &Draw),
    number: u32,
    pipeline: u32,
    corners: &mut Corners<T>,
) {
    let mesh = &draw.model.mesh;
    let table = lit.table(index, pipeline, corners.back);
    let light = if table.is_empty() {
        [[T::default(); 6]; 3]
    } else if plan.light_at == LightAt::Face {
        [table[mesh.triangles()[number as usize].polygon as usize]; 3]
    } else if draw.normals == Normals::Face {
        each(mesh.triangles()[number as usize].corners, |corner| table[corner as usize])
    } else {
        let order = mesh.draw_order();
        let points = order.points(draw.normal_source);
        each(points.of[order.place(number)], |point| table[point as usize])
    };
    let zero = T::default();
    corners.light = each(light, |[a, b, c, d, e, f]| [[a, b, c, zero], [d, e, f, zero]]);
}

/// Whether the observer sees the back of a triangle.
pub(super) fn shows_back(
    draw: &Draw,
    screen: &Screen,
    number: u32,
    at: Option<[Snapped; 3]>,
) -> bool {
    let front = match at {
        Some(at) => doubled_area(at) < 0,
        None => {
            let order = draw.model.mesh.draw_order();
            let vertices = order.vertices_of(number);
            faces_observer(vertices.map(|vertex| screen.clip(order.position(vertex))))
        }
    };
    front == draw.mirrored
}

/// The parts of a cut triangle's corners in a pixel, with perspective.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
pub(super) fn cut_weights(plan: &FramePlan, draw: &Draw, number: u32, pixel: [i32; 2]) -> DVec3 {
    let screen = Screen::new(draw.clip_from_object, plan.size);
    let order = draw.model.mesh.draw_order();
    let vertices = order.vertices_of(number);
    let clip = vertices.map(|vertex| screen.clip(order.position(vertex)));
    let x = (f64::from(pixel[0]) + 0.5) / plan.size.width as f64 * 2.0 - 1.0;
    let y = 1.0 - (f64::from(pixel[1]) + 0.5) / plan.size.height as f64 * 2.0;
    homogeneous_weights(clip, [x, y])
}
