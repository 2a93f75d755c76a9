//! Computes the layers of a picture from the visibility buffer.
//!
//! The visible triangle of each pixel is found like in a picture with one sample. Its corners are
//! weighted at the pixel's centre, in f64: see [`Weights`]. The weights follow from the corners on
//! the screen, which are snapped to 1/256 pixel, so the point always lies in the triangle. It is
//! seen within 1/256 pixel of the pixel's centre.

use glam::{DMat3, DMat4, DVec3};
use rayon::prelude::*;

use super::{Cancelled, Renderer};
use crate::accel::Accelerated as _;
use crate::cancellation::Cancellation;
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw};
use crate::layers::{
    Layer, LayerNames, LayerSet, LayerType, LayerValues, Layers, NormalSpace, id_at, surfaces_alone,
};
use crate::picture_camera::{AxesConvention, PictureCamera};
use crate::plan::plan_frame;
use crate::raster::geometry::ScreenGeometry;
use crate::raster::lines::LineNumber;
use crate::raster::strokes::along;
use crate::raster::visibility_buffer::{Visible, seen};
use crate::screen::clip::ScreenVertex;
use crate::screen::coverage::PixelBox;
use crate::screen::sample_positions::SamplePositions;
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS, TILE_SIDE, pixel_of, tiles_of};
use crate::screen::weights::{QuickWeights, Weights};
use crate::shading::painter::bounds_of;
use crate::shading::triangle_attributes::is_front;
use crate::simd::dispatch;
use crate::texture::uv::{Uvs, uv, uvs};
use crate::tile_layers::TileLayers;
use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::base::math::{self, each};
use marraztu_core::base::once::without_computing;
use marraztu_core::scene::{Derived, ItemId, List, Normals, Projection};

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
        let shot = without_light(shot);
        let plan = plan_frame(&shot);
        let watch = Cancellation::new(wanted);
        // The geometry of the last picture is overwritten.
        self.built = false;
        // Runs on a drawing thread, like a frame.
        rayon::scope(|_| {
            plan.prepare();
            // Layers read the normals of faces, lit or not.
            for draw in plan.draws.iter().filter(|draw| draw.normals == Normals::Face) {
                draw.model.mesh.prepare(Derived::PolygonNormals);
            }
            self.frame.build(self.level, &plan, SamplePositions::default(), &watch);
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
                        // An empty tile keeps the background that the layers begin with.
                        if frame.is_empty(tile) && !frame.is_layered(tile) {
                            continue;
                        }
                        let bounds = bounds_of(tile, size);
                        tile_seen.draw(*level, plan, frame, (tile, bounds));
                        for block in 0..BLOCK_PIXELS {
                            let corner = tile_seen.visibility.corner(block);
                            if let Some(words) = tile_seen.nearest(*level, frame, block) {
                                let at = (corner, bounds);
                                dispatch!(*level, _ => source.put(surfaces, &words, at, &mut band));
                            }
                        }
                    }
                });
            },
        );
    }
}

/// Returns the shot without lights and lines, and with the default settings.
fn without_light(shot: &Shot) -> Shot {
    let mut scene = shot.scene.clone();
    // Lights do not matter, and planning their shadows takes time.
    scene.lights = List::default();
    let view = surfaces_alone(&shot.view);
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
    projection: Projection,
    world_from_camera: DMat4,
    /// The rotation of normals from the camera's frame; `None` if they stay in it.
    turn: Option<DMat3>,
    /// The width of the picture.
    width: usize,
    /// Whether any layer depends on the point that a pixel shows.
    has_points: bool,
    /// Whether the normals are wanted.
    has_normals: bool,
    /// The number of world units per unit of view space.
    unit: f64,
}

/// A visible triangle, prepared for its pixels. Positions and normals are in the camera's frame, in
/// units of the world.
struct SurfaceTriangle {
    /// Object, part, material and polygon.
    ids: [i32; 4],
    /// `None` if no layer depends on the point that a pixel shows.
    shape: Option<Shape>,
}

/// The points of a visible triangle.
struct Shape {
    /// `None` on lines and points, which have one point and no normal.
    weights: Option<QuickWeights>,
    /// The first corner, and the vectors from it to the others.
    corners: [DVec3; 3],
    /// The same in the world.
    in_world: [DVec3; 3],
    normals: [DVec3; 3],
    /// The squared length below which a mean of the normals has no direction.
    least: f64,
    /// The triangle's own normal, if its corners have opposite ones.
    normal: DVec3,
    uvs: Option<Uvs>,
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
        let unit = 1.0 / plan.view_from_world.x_axis.length();
        let camera = PictureCamera::of(shot);
        let world_from_camera = camera.world_from_camera(AxesConvention::OpenGl);
        let world = DMat3::from_mat4(world_from_camera);
        let turn = (layers.normals == NormalSpace::World).then_some(world);
        // Layers of floats depend on the point, all others on the triangle alone.
        let has_points = layers.values.keys().any(|it| it.number_type() == LayerType::F32);
        let has_normals = layers.values.contains_key(&Layer::Normal);
        let width = shot.size.width;
        let projection = camera.projection;
        let objects = plan.draws.iter().map(id).collect();
        Self {
            plan,
            frame,
            names,
            objects,
            projection,
            world_from_camera,
            turn,
            width,
            has_points,
            has_normals,
            unit,
        }
    }

    /// Prepares a triangle.
    fn surface(&self, number: u32) -> SurfaceTriangle {
        let (index, start) = self.frame.draw_of(number);
        let number = number - start.number;
        let mesh = &self.plan.draws[index as usize].model.mesh;
        let polygon = mesh.polygon_of(number);
        let object = self.objects[index as usize];
        let [part, material] = self.names.part_of(object, mesh.polygon_parts()[polygon as usize]);
        SurfaceTriangle {
            ids: [object, part, material, id_at(polygon as usize)],
            shape: self.has_points.then(|| self.shape(index, number)),
        }
    }

    /// Prepares the point of a line or point of a model that a pixel shows: a triangle with this
    /// point at all corners, and without a normal. Edges and normals are not drawn here.
    fn stroke(&self, line: LineNumber, pixel: [i32; 2]) -> SurfaceTriangle {
        let Self { plan, frame, .. } = *self;
        let index = frame.line_seen(plan, line).map_or(0, |(draw, _)| draw);
        let draw = &plan.draws[index as usize];
        let mesh = &draw.model.mesh;
        let stroke = &mesh.strokes()[frame.stroke(line).unwrap_or(0) as usize];
        let object = self.objects[index as usize];
        let [part, material] = self.names.part_of(object, stroke.part);
        let [from, to] = mesh.stroke_ends(stroke);
        let t = if stroke.is_point() { 0.0 } else { along(plan, draw, stroke, pixel) };
        let place = from + (to - from) * t;
        let place = draw.view_from_object.transform_point3(place) * self.unit;
        let shape = Shape {
            weights: None,
            corners: [place, DVec3::ZERO, DVec3::ZERO],
            in_world: [self.world_from_camera.transform_point3(place), DVec3::ZERO, DVec3::ZERO],
            normals: [DVec3::ZERO; 3],
            least: 0.0,
            normal: DVec3::ZERO,
            uvs: None,
        };
        SurfaceTriangle { ids: [object, part, material, 0], shape: Some(shape) }
    }

    /// Prepares the points of a draw's triangle.
    fn shape(&self, index: u32, number: u32) -> Shape {
        let Self { plan, frame, .. } = *self;
        let draw = &plan.draws[index as usize];
        let vertices = frame.corners_of(index);
        let order = draw.model.mesh.draw_order();
        let ids = order.vertices_of(number);
        let [a, b, c] = each(ids, |vertex| {
            let place = DVec3::from_array(order.position(vertex));
            draw.view_from_object.transform_point3(place) * self.unit
        });
        let normals = if self.has_normals {
            self.normals(draw, (number, ids), vertices)
        } else {
            [DVec3::ZERO; 3]
        };
        let across = (b - a).cross(c - a);
        let ray = match self.projection {
            Projection::Perspective => a,
            Projection::Orthographic => DVec3::NEG_Z,
        };
        let world = |vector: DVec3| self.world_from_camera.transform_vector3(vector);
        Shape {
            weights: Some(QuickWeights::new(Weights::of_positions(plan, draw, vertices, number))),
            corners: [a, b - a, c - a],
            in_world: [self.world_from_camera.transform_point3(a), world(b - a), world(c - a)],
            normals,
            // Normals of stretched objects are not of length 1.
            least: 1e-12 * normals.map(DVec3::length_squared).into_iter().fold(0.0, f64::max),
            // Turned towards the camera.
            normal: if across.dot(ray) > 0.0 { -across } else { across },
            uvs: uvs(draw, number),
        }
    }

    /// Returns the normals at the corners of a triangle, in the camera's frame.
    fn normals(
        &self,
        draw: &Draw,
        (number, ids): (u32, [u32; 3]),
        vertices: &[ScreenVertex],
    ) -> [DVec3; 3] {
        let mesh = &draw.model.mesh;
        let order = mesh.draw_order();
        // Back faces are lit with reversed normals.
        let turned =
            draw.back != Back::Culled && is_front(ids, draw, self.plan, vertices) == draw.mirrored;
        let turn = if turned { -draw.view_from_normal } else { draw.view_from_normal };
        let normals = match draw.normals {
            Normals::Face => [mesh.polygon_normals()[mesh.polygon_of(number) as usize]; 3],
            Normals::Vertex => {
                let points = order.points(draw.normal_source);
                each(points.of(order, number, ids), |point| points.normals[point as usize])
            }
        };
        each(normals, |normal| turn * DVec3::from_array(normal.map(f64::from)))
    }

    /// Writes the layers of a block from the words of its pixels. Neighbours mostly show the same
    /// triangle, so they are written together, one layer after the other.
    #[inline(always)]
    fn put(
        &self,
        surfaces: &mut Surfaces,
        words: &[u64; BLOCK_PIXELS],
        ([left, top], bounds): ([i32; 2], PixelBox),
        band: &mut [(Layer, Rows<'_>)],
    ) {
        let Surfaces { cached, points } = surfaces;
        // The columns and rows of the block that are in the picture.
        let [columns, rows] = [bounds.right - left, bounds.bottom - top];
        let [columns, rows] =
            [columns, rows].map(|side| side.clamp(0, BLOCK).cast_unsigned() as usize);
        let first = left.cast_unsigned() as usize;
        let mut from = 0;
        while let Some(word) = words.get(from) {
            let alike = words[from..].iter().take_while(|other| seen(**other) == seen(*word));
            let to = from + alike.count();
            if let Visible::Line(line) = seen(*word) {
                for place in from..to {
                    let [x, y] = pixel_of([left, top], place);
                    if x < bounds.right && y < bounds.bottom {
                        let begin = y.cast_unsigned() as usize % TILE_SIDE * self.width;
                        let at = begin + x.cast_unsigned() as usize;
                        let point = [(at, DVec3::X)];
                        self.put_points(&self.stroke(line, [x, y]), &point, band);
                    }
                }
            }
            if let Visible::Triangle(number) = seen(*word) {
                let surface = of(cached, self, number);
                points.clear();
                let mut place = from;
                // The run may span several rows of the block; weights are computed row by row.
                while place < to {
                    let (row, next) = (place / SIDE, to.min((place / SIDE + 1) * SIDE));
                    let inside = next.min(row * SIDE + columns);
                    if row < rows && place < inside {
                        let y = top + i32::try_from(row).expect("a block has few rows");
                        // Ids are the same in the whole triangle.
                        let shape = surface.shape.as_ref();
                        let weights = shape.and_then(|shape| shape.weights.as_ref());
                        let weights = weights.map(|weights| weights.of_row([left, y]));
                        let [a, b, c] = weights.unwrap_or_default();
                        // A band is one row of tiles, so rows count from its top.
                        let begin = y.cast_unsigned() as usize % TILE_SIDE * self.width + first;
                        points.extend((place - row * SIDE..inside - row * SIDE).map(|column| {
                            (begin + column, DVec3::new(a[column], b[column], c[column]))
                        }));
                    }
                    place = next;
                }
                self.put_points(surface, points, band);
            }
            from = to;
        }
    }

    /// Writes the layers at points of a triangle: places in the band, with weights of its corners.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn put_points(
        &self,
        surface: &SurfaceTriangle,
        points: &[(usize, DVec3)],
        band: &mut [(Layer, Rows<'_>)],
    ) {
        let [object, part, material, polygon] = surface.ids;
        let shape = surface.shape.as_ref();
        // The kind of each layer is matched once for all points.
        for (layer, rows) in band {
            match (layer, rows, shape) {
                (Layer::Depth, Rows::F32(rows), Some(shape)) => {
                    fill(rows, points, |weights| [-point(shape.corners, weights).z as f32]);
                }
                (Layer::Distance, Rows::F32(rows), Some(shape)) => fill(rows, points, |weights| {
                    let position = point(shape.corners, weights);
                    match self.projection {
                        Projection::Perspective => [position.length() as f32],
                        // Parallel rays start in the camera's plane, so their length is the depth.
                        Projection::Orthographic => [-position.z as f32],
                    }
                }),
                (Layer::Normal, Rows::F32(rows), Some(shape)) => {
                    fill(rows, points, |weights| self.normal(shape, weights).as_vec3().to_array());
                }
                (Layer::Position, Rows::F32(rows), Some(shape)) => fill(rows, points, |weights| {
                    point(shape.in_world, weights).as_vec3().to_array()
                }),
                (Layer::Uv, Rows::F32(rows), Some(shape)) => match shape.uvs {
                    Some(uvs) => {
                        fill(rows, points, |weights| uv(uvs, weights).map(|x| x as f32));
                    }
                    None => fill(rows, points, |_| [0.0; 2]),
                },
                (Layer::Object, Rows::I32(rows), _) => fill(rows, points, |_| [object]),
                (Layer::Part, Rows::I32(rows), _) => fill(rows, points, |_| [part]),
                (Layer::Material, Rows::I32(rows), _) => fill(rows, points, |_| [material]),
                (Layer::Polygon, Rows::I32(rows), _) => fill(rows, points, |_| [polygon]),
                (Layer::Mask, Rows::U8(rows), _) => fill(rows, points, |_| [1]),
                (_, Rows::F32(_) | Rows::I32(_) | Rows::U8(_), _) => {
                    unreachable!("each layer has numbers of its type")
                }
            }
        }
    }

    /// Returns the unit normal at a point of a triangle.
    #[inline(always)]
    fn normal(&self, shape: &Shape, weights: DVec3) -> DVec3 {
        if shape.weights.is_none() {
            return DVec3::ZERO;
        }
        let [a, b, c] = shape.normals;
        let sum = a * weights.x + b * weights.y + c * weights.z;
        // Corners with opposite normals have none between them.
        let normal = match sum.length_squared() {
            square if square > shape.least => sum * (1.0 / square.sqrt()),
            _ => math::unit(shape.normal).unwrap_or(DVec3::Z),
        };
        self.turn.map_or(normal, |turn| turn * normal)
    }
}

/// The side of a block of pixels.
const SIDE: usize = BLOCK.cast_unsigned() as usize;

/// Writes the numbers of a layer at points of a triangle.
#[inline(always)]
fn fill<T: Copy, const N: usize>(
    rows: &mut [T],
    points: &[(usize, DVec3)],
    numbers: impl Fn(DVec3) -> [T; N],
) {
    for (place, weights) in points {
        rows[N * place..][..N].copy_from_slice(&numbers(*weights));
    }
}

/// Returns the point with these weights, from a corner and the vectors to the others.
#[inline(always)]
fn point([a, b, c]: [DVec3; 3], weights: DVec3) -> DVec3 {
    a + b * weights.y + c * weights.z
}

/// The triangles of the last pixels. Neighbouring pixels mostly show the same ones.
struct Surfaces {
    /// Prepared triangles, by the lowest bits of their numbers.
    cached: [Option<(u32, SurfaceTriangle)>; CACHED],
    /// The pixels of a block that show one triangle: places in the band, with weights.
    points: Vec<(usize, DVec3)>,
}

/// The number of prepared triangles.
const CACHED: usize = 64;

impl Default for Surfaces {
    fn default() -> Self {
        Self { cached: [const { None }; CACHED], points: Vec::new() }
    }
}

/// Returns a triangle, and prepares it if necessary.
fn of<'a>(
    cached: &'a mut [Option<(u32, SurfaceTriangle)>; CACHED],
    source: &Source<'_>,
    number: u32,
) -> &'a SurfaceTriangle {
    let slot = &mut cached[number as usize % CACHED];
    if slot.as_ref().is_some_and(|(other, _)| *other != number) {
        *slot = None;
    }
    &slot.get_or_insert_with(|| (number, source.surface(number))).1
}
