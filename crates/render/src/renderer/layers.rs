//! Computes the layers of a picture from the visibility buffer.
//!
//! The visible triangle of each pixel is found like in a picture with one sample. Its corners are
//! weighted at the pixel's centre, in f64: see [`Weights`]. The weights follow from the corners on
//! the screen, which are snapped to 1/256 pixel, so the point always lies in the triangle. It is
//! seen within 1/256 pixel of the pixel's centre.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::{Cancelled, Renderer};
use crate::accel::Accelerated as _;
use crate::cancellation::Cancellation;
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw};
use crate::layers::{
    Layer, LayerNames, LayerSet, LayerType, LayerValues, Layers, NormalSpace, id_at,
};
use crate::picture_camera::{AxesConvention, PictureCamera};
use crate::plan::plan_frame;
use crate::raster::geometry::ScreenGeometry;
use crate::raster::visibility_buffer::{Visible, seen};
use crate::screen::sample_positions::SamplePositions;
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS, TILE_SIDE, tiles_of};
use crate::screen::weights::Weights;
use crate::shading::painter::bounds_of;
use crate::shading::triangle_attributes::is_front;
use crate::texture::uv::{Uvs, uv, uvs};
use crate::tile_layers::TileLayers;
use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::base::math::{self, each};
use marraztu_core::base::once::without_computing;
use marraztu_core::scene::{Derived, Fill, ItemId, List, Normals, Projection, View};

impl Renderer {
    /// Computes layers of the picture of a shot; its settings do not matter. The last picture, and
    /// queries about it, stay valid. See [`Layer`] for the content of each layer.
    #[must_use]
    pub fn layers(&mut self, shot: &Shot, set: LayerSet, normals: NormalSpace) -> Layers {
        self.layers_while(shot, set, normals, &|| true).expect("it is always wanted")
    }

    /// Computes layers, like [`Self::layers`].
    ///
    /// # Errors
    /// [`Cancelled`] if `wanted`, which every thread calls between tiles, returns false.
    pub fn layers_while(
        &mut self,
        shot: &Shot,
        set: LayerSet,
        normals: NormalSpace,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Layers, Cancelled> {
        let names = LayerNames::of(&shot.scene);
        let mut layers = Layers::new(shot.size, set, normals);
        let shot = surfaces_alone(shot);
        let plan = plan_frame(&shot);
        let watch = Cancellation::new(wanted);
        // The geometry of the last picture is overwritten.
        self.built = false;
        // Runs on a drawing thread, like a frame.
        rayon::scope(|_| {
            plan.prepare();
            for draw in plan.draws.iter().filter(|draw| draw.normals == Normals::Face) {
                draw.model.mesh.prepare(Derived::PolygonNormals);
            }
            self.frame.build(self.level, &plan, (SamplePositions::default(), None), &watch);
            if !watch.is_given_up() {
                let source = Source::new(&shot, &plan, (&self.frame, &names), &layers);
                self.fill(&source, &mut layers, &watch);
            }
        });
        layers.names = names;
        if watch.is_given_up() { Err(Cancelled) } else { Ok(layers) }
    }

    /// Fills the layers in parallel, one row of tiles at a time.
    fn fill(&self, source: &Source<'_>, layers: &mut Layers, watch: &Cancellation<'_>) {
        let Self { level, frame, .. } = self;
        let (plan, size) = (source.plan, layers.size);
        let [columns, _] = tiles_of(size).map(|tiles| usize::try_from(tiles).unwrap_or(0));
        bands_of(layers).into_par_iter().enumerate().for_each_init(
            || (TileLayers::default(), Surfaces::default()),
            |(tile_seen, surfaces), (row, mut band)| {
                without_computing(|| {
                    for tile in row * columns..(row + 1) * columns {
                        if !watch.goes_on() {
                            return;
                        }
                        if frame.is_empty(tile) && !frame.is_layered(tile) {
                            continue;
                        }
                        let bounds = bounds_of(tile, size);
                        tile_seen.draw(*level, plan, frame, (tile, bounds));
                        for block in 0..BLOCK_PIXELS {
                            let words = tile_seen.nearest(*level, frame, block);
                            let [left, top] = tile_seen.visibility.corner(block);
                            for (place, word) in (0..).zip(words.iter().flatten()) {
                                let at = [left + place % BLOCK, top + place / BLOCK];
                                let is_inside = at[0] < bounds.right && at[1] < bounds.bottom;
                                if let (true, Visible::Triangle(number)) = (is_inside, seen(*word))
                                {
                                    source.put(surfaces.of(source, number), at, &mut band);
                                }
                            }
                        }
                    }
                });
            },
        );
    }
}

/// Returns the shot without lights and lines, and with the default settings.
fn surfaces_alone(shot: &Shot) -> Shot {
    let mut scene = shot.scene.clone();
    // Lights do not matter, and planning their shadows takes time.
    scene.lights = List::default();
    let view = View {
        fill: Fill::Filled,
        edges_over_fill: false,
        face_normals: false,
        vertex_normals: false,
        marks: false,
        ..shot.view.clone()
    };
    Shot { scene, view, settings: Settings::default(), size: shot.size }
}

/// The rows of a layer that belong to one row of tiles.
enum Rows<'a> {
    F32(&'a mut [f32]),
    I32(&'a mut [i32]),
    U8(&'a mut [u8]),
}

/// Divides the layers into rows of tiles.
fn bands_of(layers: &mut Layers) -> Vec<Vec<(Layer, Rows<'_>)>> {
    let Layers { size, values, .. } = layers;
    let mut bands = Vec::new();
    bands.resize_with(size.height.div_ceil(TILE_SIDE), Vec::new);
    for (layer, values) in values {
        let length = TILE_SIDE * size.width * layer.channels();
        let rows: Vec<Rows<'_>> = match values {
            LayerValues::F32(values) => values.chunks_mut(length).map(Rows::F32).collect(),
            LayerValues::I32(values) => values.chunks_mut(length).map(Rows::I32).collect(),
            LayerValues::U8(values) => values.chunks_mut(length).map(Rows::U8).collect(),
        };
        for (band, rows) in bands.iter_mut().zip(rows) {
            band.push((*layer, rows));
        }
    }
    bands
}

/// Everything that the layers are computed from.
struct Source<'a> {
    plan: &'a FramePlan,
    frame: &'a ScreenGeometry,
    names: &'a LayerNames,
    /// The id of each draw's object.
    objects: Vec<i32>,
    camera: PictureCamera,
    /// The rotation of normals from the camera's frame; `None` if they stay in it.
    turn: Option<DMat3>,
    /// The width of the picture.
    width: usize,
    /// Whether any layer depends on the point that a pixel shows.
    has_points: bool,
    /// The number of world units per unit of view space.
    unit: f64,
}

/// A visible triangle, prepared for its pixels. Positions and normals are in the camera's frame, in
/// units of the world.
struct SurfaceTriangle {
    weights: Weights,
    /// The first corner, and the vectors from it to the others.
    corners: [DVec3; 3],
    normals: [DVec3; 3],
    /// The triangle's own normal, if its corners have opposite ones.
    normal: DVec3,
    uvs: Option<Uvs>,
    /// Object, part, material and polygon.
    ids: [i32; 4],
}

impl<'a> Source<'a> {
    fn new(
        shot: &Shot,
        plan: &'a FramePlan,
        (frame, names): (&'a ScreenGeometry, &'a LayerNames),
        layers: &Layers,
    ) -> Self {
        let id = |draw: &Draw| match draw.item {
            ItemId::Object(object) => shot.scene.objects.position(object).map_or(0, id_at),
            ItemId::Camera(_) | ItemId::Light(_) => 0,
        };
        let objects = plan.draws.iter().map(id).collect();
        let unit = 1.0 / plan.view_from_world.x_axis.length();
        let camera = PictureCamera::of(shot);
        let world = DMat3::from_mat4(camera.world_from_camera(AxesConvention::OpenGl));
        let turn = (layers.normals == NormalSpace::World).then_some(world);
        let has_points = layers.values.keys().any(|it| it.number_type() == LayerType::F32);
        let width = shot.size.width;
        Self { plan, frame, names, objects, camera, turn, width, has_points, unit }
    }

    /// Prepares a triangle.
    fn surface(&self, number: u32) -> SurfaceTriangle {
        let Self { plan, frame, .. } = *self;
        let (index, start) = frame.draw_of(number);
        let draw = &plan.draws[index as usize];
        let vertices = frame.corners_of(index);
        let number = number - start.number;
        let mesh = &draw.model.mesh;
        let order = mesh.draw_order();
        let ids = order.vertices_of(number);
        let [a, b, c] = each(ids, |vertex| {
            let place = DVec3::from_array(order.position(vertex));
            draw.view_from_object.transform_point3(place) * self.unit
        });
        let polygon = mesh.polygon_of(number);
        // Back faces are lit with reversed normals.
        let turned =
            draw.back != Back::Culled && is_front(ids, draw, plan, vertices) == draw.mirrored;
        let turn = if turned { -draw.view_from_normal } else { draw.view_from_normal };
        let points = order.points(draw.normal_source);
        let normals = match draw.normals {
            Normals::Face => [mesh.polygon_normals()[polygon as usize]; 3],
            Normals::Vertex => {
                each(points.of(order, number, ids), |point| points.normals[point as usize])
            }
        };
        let normals = each(normals, |normal| turn * DVec3::from_array(normal.map(f64::from)));
        let object = self.objects[index as usize];
        let [part, material] = self.names.part_of(object, mesh.polygon_parts()[polygon as usize]);
        let across = (b - a).cross(c - a);
        SurfaceTriangle {
            weights: Weights::new(plan, draw, vertices, number, [0; 2]),
            corners: [a, b - a, c - a],
            normals,
            normal: if across.dot(a) > 0.0 { -across } else { across },
            uvs: uvs(draw, number),
            ids: [object, part, material, id_at(polygon as usize)],
        }
    }

    /// Writes the layers of a pixel.
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn put(&self, surface: &SurfaceTriangle, at: [i32; 2], band: &mut [(Layer, Rows<'_>)]) {
        let [x, y] = at.map(|i| i.cast_unsigned() as usize);
        let place = y % TILE_SIDE * self.width + x;
        // Ids are the same in the whole triangle.
        let weights = if self.has_points { surface.weights.at(at) } else { DVec3::X };
        let [a, b, c] = surface.corners;
        let position = a + b * weights.y + c * weights.z;
        let [object, part, material, polygon] = surface.ids;
        for (layer, rows) in band {
            match (layer, rows) {
                (Layer::Depth, Rows::F32(rows)) => rows[place] = -position.z as f32,
                (Layer::Distance, Rows::F32(rows)) => {
                    rows[place] = match self.camera.projection {
                        Projection::Perspective => position.length() as f32,
                        Projection::Orthographic => -position.z as f32,
                    };
                }
                (Layer::Normal, Rows::F32(rows)) => {
                    let normal = self.normal(surface, weights);
                    rows[3 * place..][..3].copy_from_slice(&normal.as_vec3().to_array());
                }
                (Layer::Position, Rows::F32(rows)) => {
                    let world = self.camera.world_from_camera(AxesConvention::OpenGl);
                    let point = world.transform_point3(position).as_vec3();
                    rows[3 * place..][..3].copy_from_slice(&point.to_array());
                }
                (Layer::Uv, Rows::F32(rows)) => {
                    let uv = surface.uvs.map_or([0.0; 2], |uvs| uv(uvs, weights));
                    rows[2 * place..][..2].copy_from_slice(&uv.map(|x| x as f32));
                }
                (Layer::Object, Rows::I32(rows)) => rows[place] = object,
                (Layer::Part, Rows::I32(rows)) => rows[place] = part,
                (Layer::Material, Rows::I32(rows)) => rows[place] = material,
                (Layer::Polygon, Rows::I32(rows)) => rows[place] = polygon,
                (Layer::Mask, Rows::U8(rows)) => rows[place] = 1,
                (_, Rows::F32(_) | Rows::I32(_) | Rows::U8(_)) => {
                    unreachable!("each layer has numbers of its type")
                }
            }
        }
    }

    /// Returns the unit normal at a point of a triangle.
    fn normal(&self, surface: &SurfaceTriangle, weights: DVec3) -> DVec3 {
        let [a, b, c] = surface.normals;
        let sum = a * weights.x + b * weights.y + c * weights.z;
        // Corners with opposite normals have none between them.
        let normal = match sum.length_squared() {
            square if square > 1e-12 => sum / square.sqrt(),
            _ => math::unit(surface.normal).unwrap_or(DVec3::Z),
        };
        self.turn.map_or(normal, |turn| turn * normal)
    }
}

/// The triangles of the last pixels. Neighbouring pixels mostly show the same ones.
struct Surfaces([Option<(u32, SurfaceTriangle)>; CACHED]);

/// The number of prepared triangles, by the lowest bits of their numbers.
const CACHED: usize = 64;

impl Default for Surfaces {
    fn default() -> Self {
        Self([const { None }; CACHED])
    }
}

impl Surfaces {
    fn of(&mut self, source: &Source<'_>, number: u32) -> &SurfaceTriangle {
        let slot = &mut self.0[number as usize % CACHED];
        if slot.as_ref().is_some_and(|(other, _)| *other != number) {
            *slot = None;
        }
        &slot.get_or_insert_with(|| (number, source.surface(number))).1
    }
}
