//! Background tasks on threads of their own, such as loading and the system's dialogs.

use std::sync::mpsc::{self, Receiver, TryRecvError};

use egui::Context;

use marraztu_io::Progress;

/// Work that goes on while the window answers.
#[derive(Debug)]
pub(crate) struct Task<T> {
    /// "Loading teapot.obj".
    pub(crate) label: String,
    pub(crate) progress: Progress,
    receiver: Receiver<T>,
}

/// How far a task is.
#[derive(Debug)]
pub(crate) enum Outcome<T> {
    Running,
    Done(T),
    /// The thread ended without a word: a fault of the program's own.
    Lost,
}

impl<T: Send + 'static> Task<T> {
    /// Begins `work` on a thread, and wakes the window when it is done.
    ///
    /// # Errors
    /// If the system provides no thread.
    pub(crate) fn start(
        ctx: &Context,
        label: String,
        work: impl FnOnce(&Progress) -> T + Send + 'static,
    ) -> std::io::Result<Self> {
        let (sender, receiver) = mpsc::channel();
        let progress = Progress::new();
        let (theirs, ctx) = (progress.clone(), ctx.clone());
        std::thread::Builder::new().name(label.clone()).spawn(move || {
            // Dropped last, so that the window is woken when everything has been told.
            let _wake = Wake(ctx);
            let sender = sender;
            // The receiver may be gone.
            let _ = sender.send(work(&theirs));
        })?;
        Ok(Self { label, progress, receiver })
    }

    /// What has become of it. Once it is done it has nothing more to tell.
    pub(crate) fn outcome(&self) -> Outcome<T> {
        match self.receiver.try_recv() {
            Ok(result) => Outcome::Done(result),
            Err(TryRecvError::Empty) => Outcome::Running,
            Err(TryRecvError::Disconnected) => Outcome::Lost,
        }
    }
}

/// Wakes the window when its thread ends, whatever way.
struct Wake(Context);

impl Drop for Wake {
    fn drop(&mut self) {
        self.0.request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_that_panics_is_lost_and_not_waited_for_forever() {
        let work = |_: &Progress| -> u32 { panic!("on purpose") };
        let task = Task::start(&Context::default(), "work".to_owned(), work).unwrap();
        loop {
            match task.outcome() {
                Outcome::Running => std::thread::yield_now(),
                Outcome::Done(_) => unreachable!(),
                Outcome::Lost => break,
            }
        }
    }
}
