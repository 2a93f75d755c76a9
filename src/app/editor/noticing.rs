//! Answers the notices over the picture.

use egui::Context;

use super::App;
use crate::app::actions::Request;
use crate::app::documents::dialogs::Dialog;
use crate::app::state::{Notice, NoticeGroup, NoticeKind, Offer, State};
use marraztu_core::edit::{Gesture, Refusal, framing};
use marraztu_core::scene::ObjectId;
use marraztu_io::{Finding, FindingKind};

impl App {
    /// Does what the notices of a kind offer, and removes them.
    pub(super) fn accept(&mut self, ctx: &Context, kind: NoticeKind) {
        let of_kind = |notice: &Notice| notice.kind == kind;
        let accepted: Vec<_> =
            self.state.notices.iter().filter(|it| of_kind(it)).cloned().collect();
        let offers: Vec<&Offer> = accepted.iter().filter_map(|it| it.offer.as_ref()).collect();
        if offers.is_empty() {
            return;
        }
        match self.accepted(&offers) {
            Ok(Some(request)) => self.answer(ctx, request),
            Ok(None) => {
                let paths = offers.iter().filter_map(|offer| match offer {
                    Offer::Reload(path) => Some(path.clone()),
                    _ => None,
                });
                self.reload_models(ctx, Some(&paths.collect()));
            }
            Err(refusal) => self.refuse(refusal.to_string()),
        }
        // A missing texture stays missing until one is chosen, which withdraws its notice.
        self.state.notices.retain(|notice| !of_kind(notice) || kind == NoticeKind::Texture);
    }

    /// Offers to find the texture of an object with these findings about its file, if it is missing
    /// and the only one: the texture of an object covers all of it.
    pub(super) fn offer_texture(&mut self, id: ObjectId, findings: &[Finding]) {
        let mut missing = findings.iter().filter(|it| it.kind == FindingKind::TextureMissing);
        let (Some(Finding { count: 1, .. }), None) = (missing.next(), missing.next()) else {
            return;
        };
        let Some(object) = self.state.scene.objects.get(id) else { return };
        let parts = u32::try_from(object.model.mesh.parts().len()).unwrap_or(u32::MAX);
        if (0..parts).all(|part| object.part_look(part).texture.is_none()) {
            let text = format!("The texture of {} was not found", object.name);
            let notice = Notice::new(NoticeKind::Texture, text);
            self.state.notices.push(notice.offering(Some(Offer::Texture(id))));
        }
    }

    /// Returns the request for offers of one kind; `None` if files have to be read again first.
    fn accepted(&self, offers: &[&Offer]) -> Result<Option<Request>, Refusal> {
        let (scene, view, gesture) = (&self.state.scene, &self.state.view, Gesture::Whole);
        if matches!(offers.first(), Some(Offer::Frame(_))) {
            let ids: Vec<_> = offers.iter().filter_map(|offer| offer.object()).collect();
            let command = framing::objects(scene, view, &ids)?;
            return Ok(Some(Request::Navigate { command, gesture }));
        }
        if matches!(offers.first(), Some(Offer::Texture(_))) {
            let ids = offers.iter().filter_map(|offer| offer.object()).collect();
            return Ok(Some(Request::ChooseTexture(ids)));
        }
        let change = Offer::command(offers, scene)?;
        Ok(change.map(|(command, label)| Request::Change { command, gesture, label }))
    }

    /// Lists the details of the notices of a kind in a dialog.
    pub(super) fn show_details(&mut self, kind: NoticeKind) {
        let groups = NoticeGroup::of(&self.state.notices);
        if let Some(group) = groups.iter().find(|group| group.kind == kind) {
            self.dialogs.show(Dialog::Details(group.text(), group.details()));
        }
    }

    /// Lists all notices in a dialog, the shown ones first.
    pub(super) fn show_past_notices(&mut self) {
        let State { notices, past_notices, .. } = &self.state;
        let all = notices.iter().chain(past_notices.iter().rev());
        let lines = all.flat_map(|notice| {
            let details = notice.details.iter().map(|line| format!("    {line}"));
            std::iter::once(notice.text.clone()).chain(details)
        });
        let lines: Vec<String> = lines.collect();
        match lines.is_empty() {
            true => self.state.tell(Some("There were no notices".to_owned())),
            false => self.dialogs.show(Dialog::Details("Notices".to_owned(), lines)),
        }
    }

    /// Returns whether the grid on the ground is on, and behind a ground.
    pub(super) fn hides_grid(&self) -> bool {
        let State { scene, view, helpers, .. } = &self.state;
        let mut all = scene.objects.iter();
        helpers.grid && all.any(|(id, object)| object.is_ground() && view.shows(id, object))
    }

    /// Dismisses all notices, which stay in the list of the status line. Unsaved work of a crashed
    /// program is offered until the user has decided. Returns whether there was a notice.
    pub(super) fn dismiss_notices(&mut self) -> bool {
        let state = &mut self.state;
        let is_missing = !state.missing.dismissed && !state.scene.missing_files().is_empty();
        let had_some = is_missing || !state.missing.nearby.is_empty() || !state.notices.is_empty();
        state.settle_notices(|_| true);
        state.missing.dismissed |= is_missing;
        state.missing.nearby.clear();
        had_some
    }

    /// Removes notices that no longer describe the scene, for example after an undo.
    pub(super) fn withdraw_notices(&mut self) {
        let scene = &self.state.scene;
        self.state.notices.retain(|notice| notice.holds(scene));
    }
}
