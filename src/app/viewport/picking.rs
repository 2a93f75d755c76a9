//! Finds all objects under the pointer, nearest first. The z-buffer of the picture knows only the
//! nearest.

use egui::{Pos2, Rect};
use glam::{DMat4, DVec2, DVec3, DVec4};

use super::marks::Projection;
use crate::app::state::State;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Object, ObjectId, dvec3};

/// The transformations from an object's mesh to the picture.
struct Onto {
    view_from_mesh: DMat4,
    clip_from_view: DMat4,
    size: Size,
}

impl Onto {
    fn new(state: &State, object: &Object, size: Size) -> Self {
        let (scene, view) = (&state.scene, &state.view);
        let view_from_world = scene.observer_frame(view).inverse();
        let lens = scene.selected_camera(view).lens;
        Self {
            view_from_mesh: view_from_world * object.world_from_mesh(view.time),
            clip_from_view: lens.clip_from_view(view.projection, size),
            size,
        }
    }

    /// Converts a point from clip space to pixels.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    fn pixel(&self, clip: DVec4) -> DVec2 {
        let (width, height) = (self.size.width as f64, self.size.height as f64);
        DVec2::new((clip.x / clip.w + 1.0) * 0.5 * width, (1.0 - clip.y / clip.w) * 0.5 * height)
    }

    fn clip(&self, position: [f32; 3]) -> DVec4 {
        let view = self.view_from_mesh.transform_point3(dvec3(position));
        self.clip_from_view * view.extend(1.0)
    }
}

/// Lists the drawn objects at a pixel, nearest first.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
pub(crate) fn objects_at(state: &State, [x, y]: [usize; 2], size: Size) -> Vec<ObjectId> {
    let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
    let mut found: Vec<(f64, ObjectId)> = Vec::new();
    for (id, object) in drawn(state) {
        let onto = Onto::new(state, object, size);
        let nearest = nearest_depth(&onto, object, at);
        found.extend(nearest.map(|depth| (depth, id)));
    }
    // With reversed depth, the near plane has depth 1.
    found.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    found.into_iter().map(|(_, id)| id).collect()
}

/// Lists the drawn objects in a part of the window: with a vertex in it, or with a surface at its
/// middle or at a corner. A ground counts only if nothing else is there.
pub(crate) fn objects_within(
    state: &State,
    onto: &Projection,
    area: Rect,
    size: Size,
) -> Vec<ObjectId> {
    let points =
        [area.center(), area.left_top(), area.right_top(), area.left_bottom(), area.right_bottom()];
    let rect = onto.rect();
    let pixel = |at: Pos2| {
        let part = (at - rect.min) / rect.size();
        #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels")]
        DVec2::new(f64::from(part.x) * size.width as f64, f64::from(part.y) * size.height as f64)
    };
    let touches = |object: &Object| {
        let mut vertices = object.placed_vertices(state.view.time);
        let at_points = || {
            let own = Onto::new(state, object, size);
            points.iter().any(|at| nearest_depth(&own, object, pixel(*at)).is_some())
        };
        vertices.any(|p| onto.place(p).is_some_and(|at| area.contains(at))) || at_points()
    };
    let found: Vec<_> = drawn(state).filter(|(_, object)| touches(object)).collect();
    let only_ground = found.iter().all(|(_, object)| object.is_ground());
    let counts = |(_, object): &(ObjectId, &Object)| only_ground || !object.is_ground();
    found.into_iter().filter(counts).map(|(id, _)| id).collect()
}

/// Lists the objects that the view shows.
fn drawn(state: &State) -> impl Iterator<Item = (ObjectId, &Object)> {
    state.scene.objects.iter().filter(|(id, object)| state.view.shows(*id, object))
}

/// Finds the depth of the nearest triangle at a point. Triangles that cross the near plane are
/// skipped.
fn nearest_depth(onto: &Onto, object: &Object, at: DVec2) -> Option<f64> {
    let mesh = &object.model.mesh;
    // Each vertex is projected once; triangles share the results.
    let points: Vec<Option<DVec3>> = mesh
        .positions()
        .iter()
        .map(|position| {
            let clip = onto.clip(*position);
            let seen = clip.w > 0.0 && clip.z <= clip.w && clip.z >= 0.0;
            seen.then(|| onto.pixel(clip).extend(clip.z / clip.w))
        })
        .collect();
    let triangles = mesh.triangles().iter().filter(|triangle| {
        let part = mesh.polygon_parts()[triangle.polygon as usize];
        object.shows_part(part)
    });
    let depths = triangles.filter_map(|triangle| {
        let [a, b, c] = triangle
            .corners
            .map(|corner| points[mesh.corners()[corner as usize].position as usize]);
        depth_in(at, [a?, b?, c?])
    });
    depths.max_by(f64::total_cmp)
}

/// Interpolates the depth at a point inside a projected triangle. Projected depth is linear in the
/// picture.
fn depth_in(at: DVec2, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let side = |p: DVec3, q: DVec3| (q - p).truncate().perp_dot(at - p.truncate());
    let [u, v, w] = [side(b, c), side(c, a), side(a, b)];
    let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let area = u + v + w;
    (inside && area != 0.0).then(|| (u * a.z + v * b.z + w * c.z) / area)
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::Shared;
    use marraztu_core::scene::{Command, Item, LoadOptions, MaterialChoice, Tracked};
    use marraztu_io as io;

    const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\n\
        v 1 1 1\nv -1 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

    /// Creates cubes of ten units a side, one behind the other along the view.
    fn state(depths: &[f64]) -> State {
        let options = LoadOptions::default();
        let progress = io::Progress::new();
        let loaded = io::parse(CUBE.as_bytes(), "cube", None, &options, &progress).unwrap();
        let model = Shared::new(loaded.model);
        let (mut scene, view) = io::default_scene();
        for id in scene.objects.ids().collect::<Vec<_>>() {
            Command::Remove(marraztu_core::scene::ItemId::Object(id)).apply(&mut scene).unwrap();
        }
        for (id, depth) in (100..).zip(depths) {
            let mut object = Object::new(model.clone(), MaterialChoice::File);
            let placement =
                DMat4::from_translation(DVec3::Z * *depth) * DMat4::from_scale(DVec3::splat(5.0));
            object.placement = Tracked::new(placement);
            let item = Item::Object(ObjectId(id), Box::new(object));
            Command::Insert { at: 0, item }.apply(&mut scene).unwrap();
        }
        State::new(scene, view)
    }

    #[test]
    fn points_behind_the_observer_are_not_picked() {
        let state = state(&[500.0]);
        assert!(objects_at(&state, [400, 300], Size::new(800, 600)).is_empty());
    }

    #[test]
    fn of_an_isolated_object_none_of_the_others_is_picked() {
        let mut state = state(&[-50.0, 100.0, 0.0]);
        state.view.object = Some(ObjectId(102));
        state.view.only_selected = true;
        let size = Size::new(800, 600);
        assert_eq!(objects_at(&state, [400, 300], size), [ObjectId(102)]);
        let rect = Rect::from_min_size(Pos2::ZERO, egui::vec2(800.0, 600.0));
        let onto = Projection::new(&state, rect, size);
        assert_eq!(objects_within(&state, &onto, rect, size), [ObjectId(102)]);
        // Inside of its nearest face, without a vertex.
        let inside = Rect::from_center_size(rect.center(), egui::vec2(4.0, 4.0));
        assert_eq!(objects_within(&state, &onto, inside, size), [ObjectId(102)]);
    }

    #[test]
    fn objects_one_behind_the_other_are_found_from_near_to_far() {
        let state = state(&[-50.0, 100.0, 0.0]);
        let found = objects_at(&state, [400, 300], Size::new(800, 600));
        assert_eq!(found, [ObjectId(101), ObjectId(102), ObjectId(100)]);
    }
}
