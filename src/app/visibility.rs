//! Says when nothing is seen of an object that a file has brought, and why.
//!
//! It is found on a thread of its own, with pictures of its own: the window does not wait for it.

use egui::Context;

use super::editor::App;
use super::files::out_of_sight;
use super::state::{Notice, Offer, State};
use super::tasks::{Outcome, Task};
use crate::base::image::Size;
use crate::render::{FramePlan, Renderer, Unseen, unseen};
use crate::scene::ObjectId;

/// A search for the reasons why nothing of some objects is seen.
pub(super) type Search = Task<Vec<(ObjectId, Unseen)>>;

/// The size of the picture before the window has one.
const SIZE: Size = Size::new(800, 600);

impl App {
    /// Begins to find out which of these objects are not seen in the picture of the present scene.
    pub(super) fn look_for_unseen(&mut self, ctx: &Context, ids: Vec<ObjectId>) {
        let State { scene, view, settings, .. } = &self.state;
        let (scene, view, settings) = (scene.clone(), view.clone(), *settings);
        let size = self.viewport.size().unwrap_or(SIZE);
        let search = Task::start(ctx, "looking for objects".to_owned(), move |_| {
            let plan = FramePlan::new(&scene, &view, &settings, size);
            let mut renderer = Renderer::default();
            renderer.render(&plan);
            let mut all = unseen(&mut renderer, &scene, &view, &settings, size);
            all.retain(|(id, _)| ids.contains(id));
            all
        });
        // Without a thread there is no notice, and nothing is lost.
        self.searches.extend(search);
    }

    /// Tells what has been found out.
    pub(super) fn hear_searches(&mut self) {
        let mut found = Vec::new();
        self.searches.retain(|search| match search.outcome() {
            Outcome::Running => true,
            Outcome::Done(all) => {
                found.extend(all);
                false
            }
            Outcome::Lost => false,
        });
        let notices = found.into_iter().filter_map(|(id, why)| notice(&self.state, id, &why));
        let notices: Vec<Notice> = notices.collect();
        self.state.notices.extend(notices);
    }
}

/// What is told of an object; nothing if it is gone, or has been told of before.
fn notice(state: &State, id: ObjectId, why: &Unseen) -> Option<Notice> {
    let object = state.scene.objects.get(id)?;
    let name = &object.name;
    let far = out_of_sight(state, object, SIZE);
    let (text, offer) = match why {
        Unseen::TurnedAway { .. } => {
            (format!("Nothing of {name} is seen: {why}"), Some(Offer::TwoSides(id)))
        }
        _ if far => (format!("{name} can hardly be seen from here"), Some(Offer::Frame(id))),
        Unseen::Covered { .. } | Unseen::BetweenPixels => {
            (format!("Nothing of {name} is seen: {why}"), Some(Offer::Frame(id)))
        }
        Unseen::Transparent | Unseen::LeftOut(_) | Unseen::Unexamined => {
            (format!("Nothing of {name} is seen: {why}"), None)
        }
    };
    let told = state.notices.iter().any(|notice| offer.is_some() && notice.offer == offer);
    (!told).then(|| Notice { text, details: Vec::new(), offer })
}
