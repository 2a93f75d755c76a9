//! Explains a pixel of the picture on a background thread, which draws a separate picture.

use std::sync::Arc;

use egui::Context;

use super::App;
use crate::app::state::ExplainedPixel;
use crate::app::tasks::{Outcome, Task};
use marraztu_core::accuracy::{Samples, Settings};
use marraztu_core::base::image::Size;
use marraztu_render::{PixelColor, Renderer, plan_frame};

/// A pixel being explained.
#[derive(Debug)]
pub(crate) struct Explaining {
    task: Task<Option<PixelColor>>,
    of: ExplainedPixel,
}

impl App {
    /// Explains a pixel, and again whenever the picture changes.
    pub(crate) fn explain_pixel(&mut self, ctx: &Context, at: [usize; 2]) {
        self.state.explaining = false;
        let Some(size) = self.viewport.size() else { return };
        let of = ExplainedPixel { at, shot: self.state.shot(size), explained: None };
        // One sample at the centre, since several samples would mix several surfaces.
        let shot = of.shot.with(Settings { samples: Samples::One, ..of.shot.settings });
        let task = Task::start(ctx, "explain a pixel".to_owned(), move |_| {
            let mut renderer = Renderer::default();
            renderer.render(&plan_frame(&shot));
            renderer.explain(at[0], at[1])
        });
        match task {
            Ok(task) => self.explaining = Some(Explaining { task, of }),
            Err(error) => self.refuse(format!("cannot start a thread to explain: {error}")),
        }
    }

    /// Shows the explanation, and starts again if the picture has changed since.
    pub(crate) fn hear_explaining(&mut self, ctx: &Context) {
        let outcome = self.explaining.as_ref().map(|explaining| explaining.task.outcome());
        match outcome {
            Some(Outcome::Running) => return,
            Some(Outcome::Done(explained)) => {
                if let Some(Explaining { of, .. }) = self.explaining.take() {
                    self.state.explained = Some(Arc::new(ExplainedPixel { explained, ..of }));
                }
            }
            Some(Outcome::Lost) => {
                self.explaining = None;
                self.state.explained = None;
                self.refuse("the pixel could not be explained: this is a bug".to_owned());
            }
            None => {}
        }
        let Some(last) = self.state.explained.clone() else { return };
        let size = self.viewport.size().unwrap_or(Size::new(0, 0));
        let [x, y] = last.at;
        let inside = x < size.width && y < size.height;
        if inside && last.shot != self.state.shot(size) && !self.state.is_animated() {
            self.explain_pixel(ctx, last.at);
        }
    }
}
