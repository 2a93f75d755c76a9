//! Turns clicks into the picture into requests, as soon as the picked item is known.

use egui::Context;

use super::marks::Projection;
use super::over::Over;
use super::{Menu, Purpose, Viewport, menu, picking};
use crate::app::actions::{Action, Also, Request, Requests};
use crate::app::drawing::worker::Pick;
use crate::app::state::State;
use marraztu_core::base::image::Size;
use marraztu_core::edit::Refusal;
use marraztu_core::scene::ItemId;
use marraztu_render::Hit;

impl Viewport {
    /// Handles the answer to a pick and adds the resulting requests.
    pub(super) fn answer(
        &mut self,
        ctx: &Context,
        state: &State,
        pick: Pick<Purpose>,
        hit: Option<Hit>,
        requests: &mut Requests,
    ) {
        let item = hit.map(|hit| hit.item);
        match pick.purpose {
            Purpose::Hover => {
                if let Some((at, seen)) = &mut self.hovered
                    && *at == pick.at
                {
                    *seen = hit;
                }
            }
            Purpose::Select => requests.extend(hit.map(|hit| self.selecting(state, pick.at, hit))),
            Purpose::SelectAlso => {
                let also = |item| Request::SelectAlso(vec![item], Also::Toggle);
                let found = item.map(|item| self.unlocked(state, pick.at, item));
                requests.extend(found.map(|item| item.map_or_else(Request::Refuse, also)));
            }
            // A box is answered without a pick in the picture.
            Purpose::Box(_) => {}
            Purpose::Aim(at) => requests.push(match (hit, self.place) {
                (Some(hit), Some((rect, size))) => {
                    match Projection::new(state, rect, size).world(at, hit.depth) {
                        Some(point) => Request::AimAt(point),
                        None => Request::Refuse("there is no surface here".to_owned()),
                    }
                }
                _ => Request::Refuse("there is nothing to aim at here: click an object".to_owned()),
            }),
            // A light's mark is skipped in favour of the object under it.
            Purpose::Frame => match self.framed(state, pick.at, item) {
                Some(item) => {
                    requests.extend([Request::Select(item), Request::Do(Action::FrameSelection)]);
                }
                None => requests.push(Request::Do(Action::FrameAll)),
            },
            Purpose::Menu(at) => {
                // As in the outline, the menu of one of several selected items acts on all of them.
                let alone = item.filter(|item| !state.is_selected(*item));
                requests.extend(alone.map(Request::Select));
                self.menu = Some(Menu { at, item });
                egui::Popup::open_id(ctx, menu::id());
            }
        }
    }

    /// Returns the item that a double click frames. A light's mark is skipped in favour of the
    /// object under it.
    fn framed(&self, state: &State, at: [usize; 2], item: Option<ItemId>) -> Option<ItemId> {
        match item {
            Some(ItemId::Light(_)) => {
                let objects = picking::objects_at(state, at, self.size()?);
                objects.first().copied().map(ItemId::Object)
            }
            item => item,
        }
    }

    /// Returns the request of a click on `hit`: it selects the polygon in polygon mode, else the
    /// item. A second click on the same pixel selects the object behind the selected one.
    fn selecting(&mut self, state: &State, at: [usize; 2], hit: Hit) -> Request {
        match self.unlocked(state, at, hit.item) {
            Ok(item) if item == hit.item => {}
            Ok(item) => return Request::Select(item),
            Err(why) => return Request::Refuse(why),
        }
        let click = (at, state.scene.observer_frame(&state.view));
        let again = self.clicked.replace(click) == Some(click);
        match hit.item {
            ItemId::Object(id)
                if state.view.polygons.is_some() && state.view.object == Some(id) =>
            {
                hit.polygon.map_or(Request::Select(hit.item), Request::SelectPolygon)
            }
            ItemId::Object(_) if again && state.view.polygons.is_none() => {
                let Some((rect, size)) = self.place else { return Request::Select(hit.item) };
                let projection = Projection::new(state, rect, size);
                let over = Over::new(state, rect, &projection);
                Request::Select(self.deeper(state, &over, self.point(at), true, hit.item))
            }
            item => Request::Select(item),
        }
    }

    /// Returns the item that a click selects: `item`, or the nearest unlocked one behind it.
    fn unlocked(&self, state: &State, at: [usize; 2], item: ItemId) -> Result<ItemId, String> {
        let is_locked = |item: &ItemId| state.scene.locked.contains(item);
        if !is_locked(&item) {
            return Ok(item);
        }
        let size = self.size().unwrap_or(Size::new(0, 0));
        let mut objects = picking::objects_at(state, at, size).into_iter().map(ItemId::Object);
        objects.find(|item| !is_locked(item)).ok_or_else(|| {
            let locked = Refusal::Locked(state.name(item).unwrap_or_default().to_owned());
            locked.to_string()
        })
    }
}
