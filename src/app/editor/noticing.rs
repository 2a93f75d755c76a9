//! Answers the notices over the picture.

use egui::Context;

use super::App;
use crate::app::actions::Request;
use crate::app::documents::dialogs::Dialog;
use crate::app::state::{Notice, NoticeGroup, NoticeKind, Offer};
use marraztu_core::edit::{Gesture, Refusal, framing};

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
        self.state.notices.retain(|notice| !of_kind(notice));
    }

    /// Returns the request for offers of one kind; `None` if files have to be read again first.
    fn accepted(&self, offers: &[&Offer]) -> Result<Option<Request>, Refusal> {
        let (scene, view, gesture) = (&self.state.scene, &self.state.view, Gesture::Whole);
        if matches!(offers.first(), Some(Offer::Frame(_))) {
            let ids: Vec<_> = offers.iter().filter_map(|offer| offer.object()).collect();
            let command = framing::objects(scene, view, &ids)?;
            return Ok(Some(Request::Navigate { command, gesture }));
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
