//! Reports loaded objects that are not visible, and why.
//!
//! The search runs on a background thread and draws separate pictures, so the window does not wait.

use std::collections::BTreeSet;

use egui::Context;

use super::App;
use crate::app::state::{Notice, NoticeKind, OUT_OF_VIEW, Offer, State};
use crate::app::tasks::{Outcome, Task};
use marraztu_core::accuracy::{Samples, Shot};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{ItemId, Object, ObjectId, Projection};
use marraztu_render::plan_frame;
use marraztu_render::{Renderer, Unseen, unseen};

/// A search for objects that are not visible, with the reasons.
#[derive(Debug)]
pub(crate) struct Search {
    task: Task<Vec<(ObjectId, Unseen)>>,
    ids: BTreeSet<ObjectId>,
    /// The object that the user asked about. If it is visible, that is reported too.
    asked: Option<ObjectId>,
}

/// The searches for objects that are not visible.
#[derive(Debug, Default)]
pub(crate) struct Searches {
    running: Vec<Search>,
    /// Searches that wait for the next frame, when the size of the picture is known.
    waiting: Vec<(BTreeSet<ObjectId>, Option<ObjectId>)>,
    /// The picture of the last search.
    last: Option<Shot>,
}

impl Searches {
    pub(super) fn are_running(&self) -> bool {
        !(self.running.is_empty() && self.waiting.is_empty())
    }
}

/// The size of the picture before the window has one.
const SIZE: Size = Size::new(800, 600);

impl App {
    /// Starts to search for objects among these that are not visible in the current scene. Objects
    /// without anything to draw are skipped, since their files already have a finding about it.
    pub(crate) fn look_for_unseen(
        &mut self,
        ctx: &Context,
        ids: impl IntoIterator<Item = ObjectId>,
    ) {
        let objects = &self.state.scene.objects;
        let has_shapes = |object: &Object| object.model.mesh.has_shapes();
        let ids = ids.into_iter().filter(|id| objects.get(*id).is_some_and(has_shapes));
        self.searches.waiting.push((ids.collect(), None));
        ctx.request_repaint();
    }

    /// Reports why an object is not visible, or that it is.
    pub(crate) fn why_unseen(&mut self, ctx: &Context, id: ObjectId) {
        let Some(object) = self.state.scene.objects.get(id) else { return };
        if object.visible {
            self.searches.waiting.push(([id].into(), Some(id)));
            return ctx.request_repaint();
        }
        let notice = Notice::new(NoticeKind::Hidden, format!("{} is hidden", object.name));
        let notice = notice.offering(Some(Offer::Show(id)));
        if !self.state.notices.contains(&notice) {
            self.state.notices.push(notice);
        }
    }

    /// Starts the searches that wait. If the view has changed since the last search and rests,
    /// objects with a notice are searched for again.
    pub(crate) fn start_searches(&mut self, ctx: &Context) {
        let mut waiting = std::mem::take(&mut self.searches.waiting);
        let again = self.reported();
        if waiting.is_empty() && again.is_empty() {
            return;
        }
        let mut shot = self.state.shot(self.viewport.size().unwrap_or(SIZE));
        // As many samples as the finest picture has next to the centre of a pixel: what it shows
        // is not reported.
        if shot.settings.samples == Samples::One && self.state.refined_to().is_some() {
            shot.settings.samples = Samples::Four;
        }
        let rests = self.searches.running.is_empty() && self.is_at_rest(ctx);
        if waiting.is_empty() && rests && self.searches.last.as_ref() != Some(&shot) {
            waiting.push((again, None));
        }
        for (ids, asked) in waiting {
            self.searches.last = Some(shot.clone());
            let (of, theirs) = (shot.clone(), ids.clone());
            let task = Task::start(ctx, "looking for objects".to_owned(), move |_| {
                let plan = plan_frame(&of);
                let mut renderer = Renderer::default();
                renderer.render(&plan);
                let mut all = unseen(&mut renderer, &of);
                all.retain(|(id, _)| theirs.contains(id));
                all
            });
            // Without a thread there is no notice, but nothing is lost.
            self.searches.running.extend(task.map(|task| Search { task, ids, asked }));
        }
    }

    /// Lists the objects that notices report as not visible.
    fn reported(&self) -> BTreeSet<ObjectId> {
        let notices = self.state.notices.iter().filter(|notice| is_about_sight(notice));
        notices.filter_map(|notice| notice.offer.as_ref()?.object()).collect()
    }

    /// Adds notices about the objects found, and removes those about objects that are visible now.
    pub(crate) fn hear_searches(&mut self) {
        let (mut found, mut seen) = (Vec::new(), None);
        let mut searched = BTreeSet::new();
        self.searches.running.retain(|search| match search.task.outcome() {
            Outcome::Running => true,
            Outcome::Done(all) => {
                seen = search.asked.filter(|id| all.iter().all(|(other, _)| other != id));
                found.extend(all);
                searched.extend(search.ids.iter().copied());
                false
            }
            Outcome::Lost => false,
        });
        if let Some(name) = seen.and_then(|id| self.state.name(ItemId::Object(id))) {
            let text = format!("{name} is in the picture: nothing hides all of it");
            self.state.tell(Some(text));
        }
        if searched.is_empty() {
            return;
        }
        let size = self.viewport.size().unwrap_or(SIZE);
        let new = found.iter().filter_map(|(id, why)| notice(&self.state, (*id, size), why));
        let new: Vec<Notice> = new.collect();
        // A tiny object is still reported if it covers a pixel.
        let mut notices = std::mem::take(&mut self.state.notices);
        notices.retain(|notice| {
            let id = notice.offer.as_ref().and_then(Offer::object);
            let id = id.filter(|id| is_about_sight(notice) && searched.contains(id));
            let object = id.and_then(|id| self.state.scene.objects.get(id));
            let is_found = found.iter().any(|(other, _)| Some(*other) == id);
            object.is_none_or(|object| !is_found && out_of_sight(&self.state, object, size))
        });
        notices.extend(new);
        self.state.notices = notices;
    }
}

/// Returns whether a notice is about an object that is not visible in a view.
const fn is_about_sight(notice: &Notice) -> bool {
    matches!(notice.kind, NoticeKind::Unseen | NoticeKind::TurnedAway | NoticeKind::Transparent)
}

/// Creates the notice about an object; `None` if the object is gone.
fn notice(state: &State, (id, size): (ObjectId, Size), why: &Unseen) -> Option<Notice> {
    let object = state.scene.objects.get(id)?;
    let name = &object.name;
    let (kind, offer) = match why {
        Unseen::TurnedAway { .. } => (NoticeKind::TurnedAway, Offer::TwoSides(id)),
        Unseen::Transparent => (NoticeKind::Transparent, Offer::Opaque(id)),
        // The plan leaves out surfaces outside of the view.
        Unseen::Covered { .. }
        | Unseen::BetweenPixels
        | Unseen::LeftOut(_)
        | Unseen::Unexamined => (NoticeKind::Unseen, Offer::Frame(id)),
    };
    let has_shapes = object.model.mesh.has_shapes();
    if kind != NoticeKind::TurnedAway && out_of_sight(state, object, size) {
        let notice = Notice::new(NoticeKind::Unseen, format!("{name}{OUT_OF_VIEW}"));
        return Some(notice.offering(Some(Offer::Frame(id))));
    }
    // From inside, all faces of a closed surface are turned away.
    if kind == NoticeKind::TurnedAway && surrounds_observer(state, object) {
        let notice = Notice::new(NoticeKind::Unseen, format!("The camera is inside {name}"));
        return Some(notice.offering(Some(Offer::Frame(id))));
    }
    let notice = Notice::new(kind, format!("Nothing of {name} is visible: {why}"));
    Some(notice.offering(Some(offer).filter(|_| has_shapes)))
}

/// Returns whether the observer is inside the box of an object, which is not flat.
fn surrounds_observer(state: &State, object: &Object) -> bool {
    let State { scene, view, .. } = state;
    let eye = scene.observer_frame(view).w_axis.truncate();
    let eye = object.world_from_mesh(view.time).inverse().transform_point3(eye);
    object
        .model
        .mesh
        .bounds()
        .is_some_and(|bounds| bounds.min.cmplt(bounds.max).all() && bounds.nearest_to(eye) == eye)
}

/// Returns whether an object would be outside of the picture or too small to notice.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
pub(crate) fn out_of_sight(state: &State, object: &Object, size: Size) -> bool {
    let Some((centre, radius)) = object.bounding_sphere(0.0) else { return false };
    let (view, scene) = (&state.view, &state.scene);
    let centre = scene.observer_frame(view).inverse().transform_point3(centre);
    let lens = scene.selected_camera(view).lens;
    let (width, height) = (size.width as f64, size.height as f64);
    let shorter = width.min(height);
    let before = -centre.z;
    let (near, far, half) = match view.projection {
        Projection::Perspective => {
            let slope = libm::tan(lens.half_angle.to_radians());
            (lens.near, lens.far, slope * before.max(lens.near))
        }
        Projection::Orthographic => (lens.parallel_near, lens.parallel_far, lens.half_size),
    };
    // The bounding sphere is compared with the sides of the frustum and with four pixels. A shifted
    // lens moves the sides, and pixels that are not square change their distance.
    let [right, down] = lens.shift.map(|by| 2.0 * half * by);
    let aspect = lens.pixel_aspect;
    let aside = (centre.x + right * aspect).abs() - radius > half * aspect * width / shorter
        || (centre.y - down).abs() - radius > half * height / shorter;
    let pixels = radius / half * shorter / 2.0;
    before + radius < near || before - radius > far || aside || pixels < 4.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat4, DVec3};
    use marraztu_core::scene::{Command, Item, Tracked};
    use marraztu_io as io;

    #[test]
    fn an_object_that_the_plan_leaves_out_can_be_framed() {
        let (scene, view) = io::default_scene();
        let id = scene.objects.ids().next().unwrap();
        let state = State::new(scene, view);
        let notice =
            notice(&state, (id, SIZE), &Unseen::LeftOut("outside the view".into())).unwrap();
        assert_eq!(notice.offer, Some(Offer::Frame(id)));
    }

    #[test]
    fn objects_behind_outside_or_tiny_are_out_of_sight() {
        let (scene, view) = io::default_scene();
        let (_, object) = scene.objects.iter().next().unwrap();
        let mut object = object.clone();
        let mut state = State::new(scene.clone(), view);
        // With a lens shift of a whole height, the axis is beyond the upper left of the picture.
        let mut camera = scene.selected_camera(&state.view).clone();
        camera.lens.shift = [-1.0, -1.0];
        let item = Item::Camera(state.view.camera, Box::new(camera));
        let undo = Command::Replace(item).apply(&mut state.scene).unwrap();
        let size = Size::new(800, 600);
        assert!(out_of_sight(&state, &object, size), "at the axis");
        object.placement = Tracked::new(DMat4::from_translation(DVec3::new(320.0, -320.0, 0.0)));
        assert!(!out_of_sight(&state, &object, size), "to the lower right of the axis");
        undo.apply(&mut state.scene).unwrap();
        let mut at = |m: DMat4| {
            object.placement = Tracked::new(m);
            out_of_sight(&state, &object, size)
        };
        assert!(!at(DMat4::IDENTITY));
        assert!(at(DMat4::from_translation(DVec3::Z * 900.0)), "behind the camera");
        assert!(at(DMat4::from_translation(DVec3::X * 900.0)), "beside what it sees");
        assert!(at(DMat4::from_scale(DVec3::splat(0.001))), "smaller than a few pixels");
        assert!(at(DMat4::from_translation(DVec3::Z * -4000.0)), "beyond the far plane");
    }
}
