//! Reports loaded objects that are not visible, and why.
//!
//! The search runs on a background thread and draws separate pictures, so the window does not wait.

use egui::Context;

use super::App;
use crate::app::state::{Notice, Offer, State};
use crate::app::tasks::{Outcome, Task};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{ItemId, Object, ObjectId, Projection};
use marraztu_render::plan_frame;
use marraztu_render::{Renderer, Unseen, unseen};

/// A search for objects that are not visible, with the reasons.
#[derive(Debug)]
pub(crate) struct Search {
    task: Task<Vec<(ObjectId, Unseen)>>,
    /// The object that the user asked about. If it is visible, that is reported too.
    asked: Option<ObjectId>,
}

/// The size of the picture before the window has one.
const SIZE: Size = Size::new(800, 600);

impl App {
    /// Starts to search for objects among these that are not visible in the current scene. Objects
    /// without faces are skipped, since their files already have a finding about it.
    pub(crate) fn look_for_unseen(&mut self, ctx: &Context, mut ids: Vec<ObjectId>) {
        let has_faces = |object: &Object| object.model.mesh.polygon_count() > 0;
        ids.retain(|id| self.state.scene.objects.get(*id).is_some_and(has_faces));
        self.search(ctx, ids, None);
    }

    /// Reports why an object is not visible, or that it is.
    pub(crate) fn why_unseen(&mut self, ctx: &Context, id: ObjectId) {
        let Some(object) = self.state.scene.objects.get(id) else { return };
        if object.visible {
            return self.search(ctx, vec![id], Some(id));
        }
        let (text, offer) = (format!("{} is hidden", object.name), Some(Offer::Show(id)));
        let notice = Notice { text, details: Vec::new(), offer };
        if !self.state.notices.contains(&notice) {
            self.state.notices.push(notice);
        }
    }

    fn search(&mut self, ctx: &Context, ids: Vec<ObjectId>, asked: Option<ObjectId>) {
        let shot = self.state.shot(self.viewport.size().unwrap_or(SIZE));
        let search = Task::start(ctx, "looking for objects".to_owned(), move |_| {
            let plan = plan_frame(&shot);
            let mut renderer = Renderer::default();
            renderer.render(&plan);
            let mut all = unseen(&mut renderer, &shot);
            all.retain(|(id, _)| ids.contains(id));
            all
        });
        // Without a thread there is no notice, but nothing is lost.
        self.searches.extend(search.map(|task| Search { task, asked }));
    }

    /// Adds notices about the objects found.
    pub(crate) fn hear_searches(&mut self) {
        let (mut found, mut seen) = (Vec::new(), None);
        self.searches.retain(|search| match search.task.outcome() {
            Outcome::Running => true,
            Outcome::Done(all) => {
                seen = search.asked.filter(|id| all.iter().all(|(other, _)| other != id));
                found.extend(all);
                false
            }
            Outcome::Lost => false,
        });
        if let Some(name) = seen.and_then(|id| self.state.name(ItemId::Object(id))) {
            let text = format!("{name} is in the picture: nothing hides all of it");
            self.state.tell(Some(text));
        }
        let notices = found.into_iter().filter_map(|(id, why)| notice(&self.state, id, &why));
        let notices: Vec<Notice> = notices.collect();
        self.state.notices.extend(notices);
    }
}

/// Creates the notice about an object; `None` if the object is gone or was reported before.
fn notice(state: &State, id: ObjectId, why: &Unseen) -> Option<Notice> {
    let object = state.scene.objects.get(id)?;
    let name = &object.name;
    let offer = match why {
        Unseen::TurnedAway { .. } => Some(Offer::TwoSides(id)),
        Unseen::Covered { .. } | Unseen::BetweenPixels => Some(Offer::Frame(id)),
        Unseen::Transparent => Some(Offer::Opaque(id)),
        // The plan leaves out surfaces outside of the view.
        Unseen::LeftOut(_) | Unseen::Unexamined => {
            (object.model.mesh.polygon_count() > 0).then_some(Offer::Frame(id))
        }
    };
    let turned_away = matches!(why, Unseen::TurnedAway { .. });
    let (text, offer) = if !turned_away && out_of_sight(state, object, SIZE) {
        (format!("{name} is out of view or too small to see"), Some(Offer::Frame(id)))
    } else {
        (format!("Nothing of {name} is visible: {why}"), offer)
    };
    let told = state.notices.iter().any(|notice| offer.is_some() && notice.offer == offer);
    (!told).then(|| Notice { text, details: Vec::new(), offer })
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
    // The bounding sphere is compared with the sides of the frustum and with four pixels.
    let aside = centre.x.abs() - radius > half * width / shorter
        || centre.y.abs() - radius > half * height / shorter;
    let pixels = radius / half * shorter / 2.0;
    before + radius < near || before - radius > far || aside || pixels < 4.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat4, DVec3};
    use marraztu_io as io;

    #[test]
    fn an_object_that_the_plan_leaves_out_can_be_framed() {
        let (scene, view) = io::default_scene();
        let id = scene.objects.ids().next().unwrap();
        let state = State::new(scene, view);
        let notice = notice(&state, id, &Unseen::LeftOut("outside the view".into())).unwrap();
        assert_eq!(notice.offer, Some(Offer::Frame(id)));
    }

    #[test]
    fn objects_behind_outside_or_tiny_are_out_of_sight() {
        let (scene, view) = io::default_scene();
        let (_, object) = scene.objects.iter().next().unwrap();
        let mut object = object.clone();
        let state = State::new(scene.clone(), view);
        let mut at = |m: DMat4| {
            object.placement = marraztu_core::scene::Tracked::new(m);
            out_of_sight(&state, &object, Size::new(800, 600))
        };
        assert!(!at(DMat4::IDENTITY));
        assert!(at(DMat4::from_translation(DVec3::Z * 900.0)), "behind the camera");
        assert!(at(DMat4::from_translation(DVec3::X * 900.0)), "beside what it sees");
        assert!(at(DMat4::from_scale(DVec3::splat(0.001))), "smaller than a few pixels");
        assert!(at(DMat4::from_translation(DVec3::Z * -4000.0)), "beyond the far plane");
    }
}
