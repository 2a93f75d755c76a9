//! The window's side of a worker without common memory.
//!
//! One request is being answered at a time; newer ones replace each other meanwhile, so a slow
//! picture never delays more than one other.

use std::collections::VecDeque;
use std::sync::Arc;

use egui::ColorImage;

use super::message::{Pictures, Reply, Request, Wanted, read, write};
use super::{Asking, Due, Pick, Shared};
use crate::app::drawing::dial::{DialFigures, Dialled};
use crate::app::drawing::snapshot::Snapshot;
use crate::app::drawing::viewport_renderer::Drawn;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Picture;
use marraztu_io::scene_to_message;

/// What the window knows about the worker.
pub(super) struct Elsewhere<P> {
    /// The picks that are being answered.
    picks: VecDeque<Pick<P>>,
    /// The last picture that was requested.
    sent: Option<Snapshot>,
    /// The last picture that was drawn.
    drawn: Option<Snapshot>,
    wake: Box<dyn Fn()>,
}

impl<P> std::fmt::Debug for Elsewhere<P> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Elsewhere").field("picks", &self.picks.len()).finish_non_exhaustive()
    }
}

impl<P> Elsewhere<P> {
    pub(super) const fn new(wake: Box<dyn Fn()>) -> Self {
        Self { picks: VecDeque::new(), sent: None, drawn: None, wake }
    }

    /// Writes all requests, unless the last ones are still being answered.
    pub(super) fn request(&mut self, shared: &Shared<P>) -> Option<Vec<u8>> {
        let mut desk = shared.lock();
        if desk.busy {
            return None;
        }
        let Due::Answer(asking) = shared.due(&mut desk) else { return None };
        drop(desk);
        let Asking { picks, border, ideal, wanted } = *asking;
        let Ok(written) = wanted.as_ref().map(|wanted| self.written(wanted)).transpose() else {
            self.fail(shared);
            return None;
        };
        let at = picks.iter().map(|pick| pick.at).collect();
        (self.picks, self.sent) = (picks, wanted.or(self.sent.take()));
        let border = border.map(|item| [item]);
        Some(write(&Request { picks: at, border, ideal, wanted: written }, &[]))
    }

    fn written(&self, wanted: &Snapshot) -> Result<Wanted, String> {
        let Snapshot { shot: Shot { scene, view, settings, size }, options } = wanted;
        let before = self.sent.as_ref().map(|sent| &sent.shot.scene);
        let scene = scene_to_message((scene, view, settings), before)?;
        Ok(Wanted { scene, size: *size, options: options.clone() })
    }

    /// Takes results; `None` if the worker has failed and was replaced.
    pub(super) fn hear(&mut self, shared: &Shared<P>, reply: Option<&[u8]>) {
        let Some((reply, mut pictures)) = reply.and_then(read::<Reply>) else {
            return self.fail(shared);
        };
        let mut desk = shared.lock();
        if reply.done {
            if desk.begun.is_some() {
                self.drawn.clone_from(&self.sent);
            }
            (desk.busy, desk.begun) = (false, None);
        }
        // These belong to the last picture, not to one that is requested meanwhile.
        let is_stale = desk.begun.is_some() || desk.wanted.is_some();
        let Reply { border, drawn, refined, outline, explained, dial, ideal, picked, .. } = reply;
        if let Some(drawn) = drawn.and_then(|head| head.with_pixels(&mut pictures)) {
            (desk.news.drawn, desk.news.refined) = (Some(drawn), None);
            desk.news.border = None;
        }
        let refined = refined.and_then(|head| head.with_pixels(&mut pictures));
        let ideal = ideal.and_then(|(window, size)| {
            let (pixels, _) = pictures.take([size.width, size.height])?.as_chunks();
            Some((window, Picture::from_pixels(size, pixels.to_vec())?))
        });
        if !is_stale {
            desk.news.refined = refined.or(desk.news.refined.take());
            desk.news.ideal = ideal.or(desk.news.ideal.take());
            if let (Some(measured), Some(of)) = (dial, self.drawn.as_ref().and_then(dialled)) {
                desk.news.dial = Some(Box::new(DialFigures { of, measured }));
            }
        }
        desk.news.border = border.or(desk.news.border.take());
        desk.news.outline = outline.or(desk.news.outline.take());
        desk.news.explained = explained.map(Arc::new).or(desk.news.explained.take());
        desk.news.picked.extend(self.picks.drain(..picked.len().min(self.picks.len())).zip(picked));
        if reply.failed {
            // The worker may lack the last scene, so the next one is sent as a whole.
            self.sent = None;
            desk.news.failed = true;
        }
        drop(desk);
        (self.wake)();
    }

    /// Reports that the requested picture cannot be drawn. The next one is sent as a whole.
    fn fail(&mut self, shared: &Shared<P>) {
        (self.sent, self.drawn) = (None, None);
        self.picks.clear();
        let mut desk = shared.lock();
        (desk.busy, desk.begun) = (false, None);
        desk.news.failed = true;
        drop(desk);
        (self.wake)();
    }
}

/// Returns what the figures of the dial depend on, as
/// [`IdleDial`](crate::app::drawing::dial::IdleDial) does.
fn dialled(snapshot: &Snapshot) -> Option<Dialled> {
    snapshot.options.dial.map(|wish| Dialled::of(&snapshot.shot, wish))
}

impl Drawn {
    fn with_pixels(mut self, pictures: &mut Pictures<'_>) -> Option<Self> {
        let size = self.image.size;
        let pixels = bytemuck::pod_collect_to_vec(pictures.take(size)?);
        self.image = Arc::new(ColorImage::new(size, pixels));
        Some(self)
    }
}
