//! A worker that draws for the window of another instance of the program.

use std::time::Duration;

use super::message::{Reply, Request, Wanted, read, write};
use super::{News, Pick, Worker};
use crate::app::drawing::snapshot::Snapshot;
use marraztu_core::accuracy::Shot;
use marraztu_core::scene::Scene;
use marraztu_io::{Known, scene_of_message};

/// Draws for a [`CanvasShell`](crate::app::CanvasShell) of another instance, in a worker of a page.
///
/// Both instances need the same files, because a message refers to models by their paths.
#[derive(Debug)]
pub struct DrawingServer {
    worker: Worker<()>,
    /// The scene of the previous message.
    scene: Option<Scene>,
    /// Whether files have changed since its models were loaded.
    is_stale: bool,
    /// Whether a request waits for its answer.
    is_asked: bool,
    /// Whether the last request could not be read.
    has_failed: bool,
}

impl DrawingServer {
    /// Prepares to draw. `is_awaited` returns whether a request waits, which interrupts the
    /// refinement of a picture; it is asked between tiles.
    pub fn new(is_awaited: fn() -> bool) -> Self {
        let worker = Worker::here(|| {}, is_awaited);
        Self { worker, scene: None, is_stale: false, is_asked: false, has_failed: false }
    }

    /// Takes a request of [`CanvasShell::request`](crate::app::CanvasShell::request).
    pub fn hear(&mut self, request: &[u8]) {
        self.is_asked = true;
        self.has_failed = self.take(request).is_none();
    }

    fn take(&mut self, request: &[u8]) -> Option<()> {
        let (Request { picks, border, ideal, wanted }, _) = read(request)?;
        for at in picks {
            self.worker.pick(Pick { at, purpose: () });
        }
        if let Some([item]) = border {
            self.worker.border(item);
        }
        if let Some(window) = ideal {
            self.worker.ideal(window);
        }
        if let Some(wanted) = wanted {
            let snapshot = self.snapshot(wanted)?;
            // Unless objects arrive, none of their models is loaded again.
            let before = self.scene.replace(snapshot.shot.scene.clone());
            self.is_stale &=
                before.is_some_and(|before| before.objects == snapshot.shot.scene.objects);
            self.worker.draw(snapshot);
        }
        Some(())
    }

    fn snapshot(&self, wanted: Wanted) -> Option<Snapshot> {
        let before = self.scene.as_ref();
        let known = before.filter(|_| !self.is_stale).map(Known::of).unwrap_or_default();
        let (scene, view, settings) = scene_of_message(&wanted.scene, before, &known).ok()?;
        let shot = Shot { scene, view, settings, size: wanted.size };
        Some(Snapshot { shot, options: wanted.options })
    }

    /// Notes that files have changed: the models of the next objects are loaded again.
    pub const fn files_changed(&mut self) {
        self.is_stale = true;
    }

    /// Answers the requests, or refines the last picture by a step. Returns the reply for
    /// [`CanvasShell::reply`](crate::app::CanvasShell::reply), if there are results.
    pub fn work(&mut self) -> Option<Vec<u8>> {
        let news = self.worker.news();
        let done = std::mem::take(&mut self.is_asked);
        let failed = std::mem::take(&mut self.has_failed);
        let News { border, drawn, refined, outline, explained, dial, ideal, picked, .. } = news;
        let has_results = done || refined.is_some() || dial.is_some() || news.failed;
        has_results.then(|| {
            let pictures = [
                drawn.as_ref().map(|drawn| drawn.image.as_raw()),
                refined.as_ref().map(|refined| refined.image.as_raw()),
                ideal.as_ref().map(|(_, picture)| picture.pixels().as_flattened()),
            ];
            let pictures: Vec<&[u8]> = pictures.into_iter().flatten().collect();
            let reply = Reply {
                done,
                border,
                drawn: drawn.clone(),
                refined: refined.clone(),
                outline,
                explained: explained.as_deref().cloned(),
                dial: dial.map(|dial| dial.measured),
                ideal: ideal.as_ref().map(|(window, picture)| (*window, picture.size())),
                picked: picked.into_iter().map(|(_, hit)| hit).collect(),
                failed: failed || news.failed,
            };
            write(&reply, &pictures)
        })
    }

    /// Returns the time until the next work, or `None` if only a request brings some.
    pub fn rest(&self) -> Option<Duration> {
        if self.is_asked { Some(Duration::ZERO) } else { self.worker.shared.rest() }
    }
}
