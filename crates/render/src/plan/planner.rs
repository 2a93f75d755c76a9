//! Converts the items of a scene to draws.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};

use super::cover::Cover;
use super::features::presence;
use super::helpers;
use super::observer::ObserverSpace;
use super::planning::{Ground, Planner, Planning};
use super::rays::numbers_of;
use super::rules::Thing;
use super::turning::{shows_fronts_only, turning_of};
use super::uses::{self, EffectState, EffectUse};
use crate::frame::Rules;
use crate::frame::draw::{Back, Draw, DrawnStrokes, Lines, Pipeline, uniform};
use crate::frame::raster_mode::RasterMode;
use crate::lights::region::Region;
use marraztu_core::accuracy::{LightAt, NormalMatrix, VertexArithmetic};
use marraztu_core::base::color::{Color, byte};
use marraztu_core::base::{Shared, math};
use marraztu_core::scene::{
    Fill, ItemId, LightKind, MaterialChoice, Model, NormalLength, NormalSource, Object, ObjectId,
    Observer, Surface,
};

impl Planner<'_> {
    /// Adds objects, the oldest first.
    pub(super) fn add_objects(&self, into: &mut Planning) {
        let scene = &self.shot.scene;
        let spheres = scene.objects.spheres();
        // With thousands of objects, most are rejected by their spheres alone.
        let outside = self.culls_spheres(into).then(|| self.observer.spheres_outside());
        for (i, place) in spheres.places.iter().enumerate() {
            if outside.as_ref().is_some_and(|planes| planes.misses(spheres, i)) {
                continue;
            }
            let (id, object) = scene.objects.at(*place as usize).expect("a sphere for each object");
            match self.not_asked_for(id, object) {
                Some(reason) => left_out(into, ItemId::Object(id), &object.name, reason),
                None => self.add_object(into, id, object),
            }
        }
    }

    /// Returns whether objects with spheres outside the view are skipped: nothing of them is
    /// visible, and no explanation was requested.
    fn culls_spheres(&self, into: &Planning) -> bool {
        let view = &self.shot.view;
        into.plan.rules == Rules::Applied
            && !self.is_around
            && !into.notes.are_wanted()
            && !into.plan.raster_mode().moves_geometry()
            && !view.face_normals
            && !view.vertex_normals
    }

    /// Returns the reason why the view does not show an object, if there is one.
    pub(super) fn not_asked_for(&self, id: ObjectId, object: &Object) -> Option<&'static str> {
        if !object.visible {
            Some("hidden")
        } else if !self.shot.view.shows(id, object) {
            Some("only the selected object is shown")
        } else {
            None
        }
    }

    /// Returns the polygons of an object that the view shows; `None` for all.
    pub(super) fn polygons_of(&self, id: ObjectId) -> Option<BTreeSet<u32>> {
        let view = &self.shot.view;
        let mode = view.polygons.as_ref().filter(|_| view.object == Some(id))?;
        Some(match view.polygons_stay {
            true => mode.shown.clone(),
            false => BTreeSet::from([mode.current]),
        })
    }

    fn add_object(&self, into: &mut Planning, id: ObjectId, object: &Object) {
        // Back-face culling depends on whether the surface is closed and on the view.
        let back = match (object.is_two_sided(), self.shot.view.back_faces) {
            (true, _) => Back::Lit,
            (false, true) => Back::Red,
            (false, false) => Back::Culled,
        };
        let draw = Draw {
            back,
            normal_source: if object.file_normals {
                NormalSource::File
            } else {
                NormalSource::Computed
            },
            polygons: self.polygons_of(id),
            // Rays meet surfaces alone.
            lines: match self.is_around {
                true => Lines::NONE,
                false => self.lines(&object.model, object.edge_color),
            },
            strokes: self.strokes(id, object).filter(|_| !self.is_around),
            ..self.draw(
                ItemId::Object(id),
                &object.model,
                object.world_from_mesh(self.shot.view.time),
            )
        };
        self.add(into, object, draw);
    }

    /// Creates the draw of a placed mesh, without a decision about its surface.
    fn draw(&self, item: ItemId, model: &Shared<Model>, world_from_object: DMat4) -> Draw {
        let [view_from_object, clip_from_object] = self.placement(world_from_object);
        let linear = DMat3::from_mat4(view_from_object);
        Draw {
            item,
            model: model.clone(),
            clip_from_object,
            view_from_object,
            // The cofactor matrix keeps normals perpendicular under non-uniform scale.
            view_from_normal: match self.shot.settings.stretched {
                NormalMatrix::Cofactor => math::normal_matrix(linear),
                NormalMatrix::AsItIs => math::at_power_of_two(linear),
            },
            mirrored: linear.determinant() < 0.0,
            back: Back::Culled,
            culls_opaque: false,
            normals: self.shot.view.normals,
            normal_source: NormalSource::File,
            part_pipelines: Vec::new(),
            uniform: None,
            bodies: Vec::new(),
            polygons: None,
            filled: self.shot.view.fill == Fill::Filled,
            lines: Lines::NONE,
            strokes: None,
        }
    }

    /// Returns an object's transforms to view and clip space.
    fn placement(&self, world_from_object: DMat4) -> [DMat4; 2] {
        let ObserverSpace { view_from_world, clip_from_view, .. } = self.observer;
        if self.shot.settings.vertices == VertexArithmetic::F32 {
            // This variant also composes matrices in f32.
            let view_from_object = view_from_world.as_mat4() * world_from_object.as_mat4();
            let clip_from_object = (clip_from_view.as_mat4() * view_from_object).as_dmat4();
            return [view_from_object.as_dmat4(), clip_from_object];
        }
        let view_from_object = view_from_world * world_from_object;
        [view_from_object, clip_from_view * view_from_object]
    }

    /// Returns whether a visible part of an object is transparent, other than by rays.
    fn is_any_transparent(&self, object: &Object) -> bool {
        let textured = !object.model.mesh.uvs().is_empty();
        object.shown_parts().any(|part| {
            let mut look = object.part_look(part);
            self.settle_transmission(object, &mut look);
            let cover = Cover::of(&look, textured, self.shot.settings.transparency);
            matches!(cover, Cover::Transparent(_))
        })
    }

    /// Adds the draw of an object, or of a helper converted to one, unless nothing of it is
    /// visible.
    fn add(&self, into: &mut Planning, object: &Object, mut draw: Draw) {
        let item = draw.item;
        let mesh = &object.model.mesh;
        let Some(bounds) = mesh.bounds() else {
            return left_out(into, item, &object.name, "it has no vertices");
        };
        // Decides which faces are drawn before anything else is decided about the object.
        if draw.back == Back::Culled && draw.filled && self.is_any_transparent(object) {
            // The back is visible through its transparent front.
            (draw.back, draw.culls_opaque) = (Back::Lit, true);
        }
        let moves = into.plan.raster_mode().moves_geometry();
        if draw.back == Back::Lit
            && !draw.culls_opaque
            && !moves
            && !self.is_around
            && shows_fronts_only(&draw, self.shot.view.projection)
        {
            draw.back = Back::Culled;
        }
        // An object that shows no pixel is left out before its surfaces are planned.
        let thing = Thing { observer: &self.observer, draw: &draw, bounds };
        let rules = into.plan.rules;
        let reason = if mesh.polygon_count() == 0 && draw.strokes.is_none() {
            Some(if mesh.has_shapes() { "nothing of it is shown" } else { "it has no faces" })
        } else if !math::has_full_rank(DMat3::from_mat4(draw.view_from_object)) {
            Some("its placement is flat: it has no inside and no outside")
        } else if moves || self.is_around {
            // A variant may move it on the screen, and rays go everywhere.
            None
        } else {
            rules.thing(&thing)
        };
        if let Some(reason) = reason {
            return left_out(into, item, &object.name, reason);
        }
        // Surfaces are only planned for objects; bulbs come with a flat pipeline.
        if draw.part_pipelines.is_empty() {
            let seen = rules.surfaces(&thing).is_none();
            let (region, tiled) = self.region(&draw, bounds.corners());
            let turning = match self.is_around {
                true => None,
                false => turning_of(&draw, self.shot.settings.light),
            };
            let bodies = self.bodies(object);
            let ground = Ground { item, object, region, turning, tiled, seen, bodies };
            draw.part_pipelines = self.part_pipelines(into, &ground);
            draw.bodies = numbers_of(&ground.bodies);
        }
        draw.uniform = uniform(&draw.part_pipelines);
        self.note_features(into, object, &draw);
        into.plan.draws.push(draw);
    }

    /// Returns the pipeline of each part; `None` for parts that are hidden or not opaque enough.
    fn part_pipelines(&self, into: &mut Planning, ground: &Ground<'_>) -> Vec<Option<u32>> {
        let shown = |part: &u32| ground.object.shows_part(*part);
        (0..ground.object.model.mesh.parts().len())
            .map(|part| u32::try_from(part).expect("parts are numbered by 32 bits"))
            .map(|part| Some(part).filter(shown))
            .map(|part| part.and_then(|part| self.pipeline_of_part(into, ground, part)))
            .collect()
    }

    /// Returns the region of an object's lit points, if it is known, and whether nothing of it is
    /// clipped.
    fn region(&self, draw: &Draw, corners: [DVec3; 8]) -> (Option<Region>, bool) {
        if self.is_around {
            return (None, false);
        }
        if self.shot.settings.light != LightAt::Pixel {
            // Lit at vertices or faces: clipping does not matter.
            let exact = Region::placed(draw.view_from_object, corners, 0.0);
            // Positions in f32 are off by a few roundings of the largest coordinate.
            let error = 2e-6 * exact.reach();
            return (Some(Region::placed(draw.view_from_object, corners, error)), false);
        }
        // Geometry that moves may put pixels out of the region.
        let moves = RasterMode::of(&self.shot.settings).moves_geometry();
        if moves || !self.observer.holds(draw.clip_from_object, corners) {
            return (None, false);
        }
        (Some(self.observer.seen_region(draw.view_from_object, corners)), true)
    }

    fn lines(&self, model: &Model, color: Color) -> Lines {
        let view = &self.shot.view;
        let extent = model.mesh.bounds().map_or(0.0, |bounds| bounds.extent().max_element());
        let length = match view.normal_length {
            NormalLength::Units => 5.0,
            NormalLength::BySize => extent / 20.0,
        };
        Lines {
            edges: view.fill == Fill::Edges || view.edges_over_fill,
            face_normals: view.face_normals.then_some(length),
            vertex_normals: view.vertex_normals.then_some(length),
            color,
        }
    }

    /// Plans the lines and points of an object. `None` if none are drawn.
    fn strokes(&self, id: ObjectId, object: &Object) -> Option<DrawnStrokes> {
        let mesh = &object.model.mesh;
        // Polygon mode shows single polygons.
        if mesh.strokes().is_empty() || self.polygons_of(id).is_some() {
            return None;
        }
        let is_bare = object.surface == Surface::Material;
        let tint = if is_bare { [1.0; 3] } else { object.tint.factors() };
        let color = |part: u32| {
            let look = object.part_look(part);
            let is_plain = mesh.parts()[part as usize].material.is_none();
            let own = match object.material {
                // Without a material, they are as easy to see as edges.
                MaterialChoice::File if is_plain => object.edge_color,
                _ => Color(std::array::from_fn(|i| byte(look.material.diffuse[i] * tint[i]))),
            };
            (object.shows_part(part) && look.opacity > 0.0).then_some(own)
        };
        let parts = 0..u32::try_from(mesh.parts().len()).unwrap_or(u32::MAX);
        let colors: Vec<Option<Color>> = parts.map(color).collect();
        let is_shown = mesh.strokes().iter().any(|it| colors[it.part as usize].is_some());
        let vertex_colors = !is_bare && !mesh.colors().is_empty();
        is_shown.then_some(DrawnStrokes { colors, vertex_colors })
    }

    /// Adds helpers: the cameras other than the observer, and the bulbs that are on.
    pub(super) fn add_marks(&self, into: &mut Planning) {
        let object_looks = self.shot.view.observer == Observer::Object
            && self.shot.view.object.is_some_and(|id| self.shot.scene.objects.get(id).is_some());
        // Cameras: a model at each one, except at the observer.
        for (id, camera) in self.shot.scene.cameras.iter() {
            let looks = !object_looks && self.shot.view.camera == id;
            let reason = match (looks, camera.visible) {
                (true, _) => Some("it looks"),
                (false, false) => Some("hidden"),
                (false, true) => None,
            };
            if let Some(reason) = reason {
                left_out(into, ItemId::Camera(id), &camera.name, reason);
                continue;
            }
            let mark = Object {
                name: camera.name.clone(),
                ..Object::new(camera.model.clone(), camera.material.clone())
            };
            let placement = helpers::world_from_mark(camera);
            let draw = Draw {
                back: if self.shot.view.back_faces { Back::Red } else { Back::Culled },
                lines: self.lines(&mark.model, mark.edge_color),
                ..self.draw(ItemId::Camera(id), &mark.model, placement)
            };
            self.add(into, &mark, draw);
        }
        // Bulbs: a diamond at each light that is on and has a position.
        for (id, light) in self.shot.scene.lights.iter().filter(|(_, light)| light.on) {
            let placement = self.bulb_place(&light.kind);
            let place = |at| helpers::world_from_diamond(&self.observer, at);
            let Some(placement) = placement.and_then(place) else { continue };
            let pipeline = into.pipeline(Pipeline::Flat(helpers::YELLOW));
            let draw = Draw {
                part_pipelines: vec![Some(pipeline)],
                filled: true,
                ..self.draw(ItemId::Light(id), helpers::diamond(), placement)
            };
            let mark = Object {
                name: light.name.clone(),
                ..Object::new(draw.model.clone(), MaterialChoice::File)
            };
            self.add(into, &mark, draw);
        }
    }

    fn bulb_place(&self, kind: &LightKind) -> Option<DVec3> {
        let origin = self.shot.scene.light_origin(&self.shot.view, kind)?;
        origin.position.filter(|_| kind.has_diamond())
    }
}

/// Notes that an item is not drawn.
fn left_out(into: &mut Planning, item: ItemId, name: &str, reason: &'static str) {
    let thing = || Some(uses::Thing { item, name: name.to_owned() });
    into.notes.add(|| EffectUse::new(presence(item), thing(), EffectState::left_out(reason)));
}
