//! Presentation: the picture on the full screen, with large type, for a lecture.
//!
//! Menus, panels and the status line are away; the dial, the lesson and whatever a key opens stay.
//! The end restores the panels and the size of the interface.

use egui::{Context, ViewportCommand};

use super::App;
use crate::app::panels::OpenPanels;
use crate::app::state::Presenting;

/// The size of the interface in a presentation, relative to the usual one.
const LARGER: f32 = 1.5;

impl App {
    /// Begins a presentation, or ends it.
    pub(super) fn present(&mut self, ctx: &Context) {
        if self.ends_presenting(ctx) {
            return;
        }
        let (panels, zoom) = (self.state.panels, ctx.zoom_factor());
        let since = ctx.input(|input| input.time);
        self.state.presenting = Some(Presenting { panels, zoom, since });
        self.state.panels = OpenPanels::NONE;
        ctx.set_zoom_factor(zoom * LARGER);
        ctx.send_viewport_cmd(ViewportCommand::Fullscreen(true));
    }

    /// Ends a presentation. Returns whether there was one.
    pub(super) fn ends_presenting(&mut self, ctx: &Context) -> bool {
        let Some(Presenting { panels, zoom, .. }) = self.state.presenting.take() else {
            return false;
        };
        self.state.panels = panels;
        ctx.set_zoom_factor(zoom);
        ctx.send_viewport_cmd(ViewportCommand::Fullscreen(false));
        true
    }
}
