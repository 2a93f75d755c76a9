//! The attributes of what is seen: from the place in a triangle to colours.
//!
//! Attributes are interpolated with perspective from the corners of the mesh's own triangle, also
//! where it was cut: a pixel's weights in a piece are turned into weights in the whole. A value that
//! all corners share comes out as it went in, bit for bit, since only differences are weighted.
//!
//! Perspective: Heckbert and Moreton, "Interpolation for Polygon Texture Mapping and Shading", 1991.

use fearless_simd::Level;
use glam::DVec3;

use super::coverage::Triangle;
use super::effects::{BATCH, Batch, Light as Number};
use super::geometry::{Geometry, ScreenTriangle, Side};
use super::light::{Lit, face_normal};
use super::lines::point_of;
use super::plan::{Eye, FramePlan, Pipeline, Shaded, Stage};
use super::texture;
use crate::base::color::Color;
use crate::scene::{LightAt, NONE, Normals};

/// The parts that the corners of the mesh's triangle have in a pixel, with perspective; `edges` are
/// the edge functions there.
#[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
pub(super) fn weights(
    geometry: &Geometry,
    triangle: &ScreenTriangle,
    coverage: &Triangle,
    edges: [i64; 3],
) -> DVec3 {
    let area = coverage.doubled_area() as f64;
    let linear = DVec3::from_array(edges.map(|edge| edge as f64 / area));
    let w = DVec3::from_array(triangle.corners.map(|corner| corner.inverse_w));
    let by_w = linear * w;
    let weights = by_w / by_w.element_sum();
    if triangle.cut == NONE {
        return weights;
    }
    let [a, b, c] = geometry.cuts[triangle.cut as usize];
    a * weights.x + b * weights.y + c * weights.z
}

/// A pixel of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixel {
    /// The triangle's place in the geometry.
    pub(super) triangle: u32,
    /// Column and row.
    pub(super) at: [i32; 2],
}

/// Colours pixels of one pipeline, a batch at a time.
#[derive(Debug)]
pub(super) struct Shader<'a, T> {
    pub(super) plan: &'a FramePlan,
    pub(super) geometry: &'a Geometry,
    pub(super) lit: &'a Lit<T>,
    pub(super) level: Level,
    batch: Box<Batch<T>>,
    texels: Box<[[T; 3]; BATCH]>,
}

impl<'a, T: Number> Shader<'a, T> {
    pub(super) fn new(
        plan: &'a FramePlan,
        geometry: &'a Geometry,
        lit: &'a Lit<T>,
        level: Level,
    ) -> Self {
        let texels = Box::new([[T::default(); 3]; BATCH]);
        Self { plan, geometry, lit, level, batch: Box::default(), texels }
    }

    /// Gives the colour of each of at most [`BATCH`] pixels, all of the same pipeline.
    pub(super) fn shade(&mut self, pixels: &[Pixel], mut give: impl FnMut([i32; 2], [u8; 4])) {
        let first = &self.geometry.triangles[pixels[0].triangle as usize];
        match &self.plan.pipelines[first.pipeline as usize] {
            Pipeline::Flat(color) => pixels.iter().for_each(|p| give(p.at, color.opaque())),
            Pipeline::Shaded(shaded) => {
                self.fill(pixels, shaded);
                if let (Some(stages), LightAt::Pixel) = (&shaded.light, self.plan.light_at) {
                    self.light(stages, shaded);
                }
                for (i, pixel) in pixels.iter().enumerate() {
                    give(pixel.at, self.color(i, shaded.light.is_some()));
                }
            }
        }
    }

    /// Adds up light at every place of the batch.
    fn light(&mut self, stages: &[Stage], shaded: &Shaded) {
        run(stages, shaded, self.plan, self.level, &mut self.batch);
    }

    /// Writes the attributes of pixels into the batch.
    fn fill(&mut self, pixels: &[Pixel], shaded: &Shaded) {
        self.batch.len = pixels.len();
        for row in self.batch.diffuse.iter_mut().chain(&mut self.batch.specular) {
            row.fill(T::default());
        }
        for (i, pixel) in pixels.iter().enumerate() {
            let triangle = &self.geometry.triangles[pixel.triangle as usize];
            let corners = triangle.corners.map(|corner| corner.at);
            let coverage = Triangle::new(corners).expect("what is seen has area");
            let [x, y] = pixel.at;
            let edges = coverage.edges_at(x, y);
            let weights = weights(self.geometry, triangle, &coverage, edges);
            self.texels[i] = texel(self.plan, triangle, shaded, weights);
            if shaded.light.is_none() {
                continue;
            }
            match self.plan.light_at {
                LightAt::Pixel => self.fill_place(i, triangle, weights),
                LightAt::Face | LightAt::Vertex => self.fill_light(i, triangle, weights),
            }
        }
    }

    /// Place, normal and direction to the observer, for light per pixel.
    fn fill_place(&mut self, i: usize, triangle: &ScreenTriangle, weights: DVec3) {
        let draw = &self.plan.draws[triangle.draw as usize];
        let mesh = &draw.model.mesh;
        let base = self.geometry.bases[triangle.draw as usize];
        let own = mesh.triangles()[triangle.triangle as usize];
        let corners = own.corners.map(|corner| mesh.corners()[corner as usize]);
        let places =
            corners.map(|corner| self.geometry.positions[base.position + corner.position as usize]);
        let position = interpolate(places, weights);
        let normal = match draw.normals {
            Normals::Vertex => {
                let normals = corners.map(|corner| {
                    self.geometry.normals[base.point + point_of(draw, &corner) as usize]
                });
                interpolate(normals, weights)
            }
            Normals::Face => face_normal(draw, own.polygon),
        };
        let normal = if triangle.side == Side::Back { -normal } else { normal };
        self.batch.put(i, position, normal, self.plan.eye);
    }

    /// Light that was evaluated elsewhere.
    fn fill_light(&mut self, i: usize, triangle: &ScreenTriangle, weights: DVec3) {
        let draw = &self.plan.draws[triangle.draw as usize];
        let own = draw.model.mesh.triangles()[triangle.triangle as usize];
        let light = match self.plan.light_at {
            LightAt::Face => self.lit.of_polygon(triangle.draw, own.polygon, triangle.side),
            _ => {
                let at = own.corners.map(|c| self.lit.of_corner(triangle.draw, c, triangle.side));
                mix(at, weights)
            }
        };
        for axis in 0..3 {
            self.batch.diffuse[axis][i] = light[0][axis];
            self.batch.specular[axis][i] = light[1][axis];
        }
    }

    /// I = t D + S where lit, t elsewhere.
    fn color(&self, i: usize, lit: bool) -> [u8; 4] {
        let mut color = Color::BLACK.opaque();
        for axis in 0..3 {
            let t = self.texels[i][axis];
            let diffuse = self.batch.diffuse[axis][i];
            let light = if lit { t * diffuse + self.batch.specular[axis][i] } else { t };
            color[axis] = light.byte();
        }
        color
    }
}

/// Adds up the light of some stages at every place of a batch.
pub(super) fn run<T: Number>(
    stages: &[Stage],
    shaded: &Shaded,
    plan: &FramePlan,
    level: Level,
    batch: &mut Batch<T>,
) {
    for stage in stages {
        let lamp = &plan.lamps[stage.lamp as usize];
        T::add_light(stage.variant(), level, batch, lamp, &shaded.matter);
    }
}

impl<T: Number> Batch<T> {
    /// Writes one place into the batch: its position and its normal (of any length) in view space.
    pub(super) fn put(&mut self, i: usize, position: DVec3, normal: DVec3, eye: Eye) {
        let unit = |v: DVec3| crate::base::math::unit(v).unwrap_or(DVec3::ZERO);
        let to_eye = match eye {
            Eye::Point => unit(-position),
            Eye::Parallel => DVec3::Z,
        };
        let normal = unit(normal);
        for axis in 0..3 {
            self.position[axis][i] = T::from_f64(position[axis]);
            self.normal[axis][i] = T::from_f64(normal[axis]);
            self.to_eye[axis][i] = T::from_f64(to_eye[axis]);
        }
    }
}

/// A value between those of three corners; exactly theirs where they are equal.
fn interpolate([a, b, c]: [DVec3; 3], weights: DVec3) -> DVec3 {
    a + (b - a) * weights.y + (c - a) * weights.z
}

/// The same for light.
fn mix<T: Number>([a, b, c]: [[[T; 3]; 2]; 3], weights: DVec3) -> [[T; 3]; 2] {
    let (v, w) = (T::from_f64(weights.y), T::from_f64(weights.z));
    let mut light = a;
    for kind in 0..2 {
        for axis in 0..3 {
            let [a, b, c] = [a, b, c].map(|corner| corner[kind][axis]);
            light[kind][axis] = a + (b - a) * v + (c - a) * w;
        }
    }
    light
}

/// The place on the texture; `None` where a corner has none.
fn uv(plan: &FramePlan, triangle: &ScreenTriangle, weights: DVec3) -> Option<[f64; 2]> {
    let mesh = &plan.draws[triangle.draw as usize].model.mesh;
    let own = mesh.triangles()[triangle.triangle as usize];
    let ids = own.corners.map(|corner| mesh.corners()[corner as usize].uv);
    if ids.contains(&NONE) {
        return None;
    }
    let [a, b, c] = ids.map(|id| mesh.uvs()[id as usize].map(f64::from));
    let between = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
        let value = a[axis] + (b[axis] - a[axis]) * weights.y + (c[axis] - a[axis]) * weights.z;
        value.clamp(low, high)
    };
    Some([between(0), between(1)])
}

/// The texture's alpha at a pixel, 1 where it has no texture there.
pub(super) fn alpha(
    plan: &FramePlan,
    triangle: &ScreenTriangle,
    shaded: &Shaded,
    weights: DVec3,
) -> f64 {
    let texture = shaded.texture.as_deref();
    let place = texture.zip(uv(plan, triangle, weights));
    place.map_or(1.0, |(texture, uv)| texture::sample::<f64>(texture, uv, plan.filter)[3])
}

/// t: texel x tint x vertex colour, each 1 where absent.
fn texel<T: Number>(
    plan: &FramePlan,
    triangle: &ScreenTriangle,
    shaded: &Shaded,
    weights: DVec3,
) -> [T; 3] {
    let mut t = shaded.tint.map(T::from_f64);
    let place = shaded.texture.as_deref().zip(uv(plan, triangle, weights));
    if let Some((texture, uv)) = place {
        let [r, g, b, _] = texture::sample::<T>(texture, uv, plan.filter);
        t = [t[0] * r, t[1] * g, t[2] * b];
    }
    if shaded.vertex_colors {
        let mesh = &plan.draws[triangle.draw as usize].model.mesh;
        let own = mesh.triangles()[triangle.triangle as usize];
        let colors = own.corners.map(|corner| {
            let vertex = mesh.corners()[corner as usize].position as usize;
            crate::scene::dvec3(mesh.colors()[vertex])
        });
        let color = interpolate(colors, weights).to_array().map(T::from_f64);
        t = [t[0] * color[0], t[1] * color[1], t[2] * color[2]];
    }
    t
}
