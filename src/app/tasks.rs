//! Background tasks on separate threads, such as loading and the system's dialogs.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};

use egui::Context;

use marraztu_io::Progress;

/// Work on a thread while the window stays responsive.
#[derive(Debug)]
pub(crate) struct Task<T> {
    /// "Loading teapot.obj".
    pub(crate) label: String,
    pub(crate) progress: Progress,
    receiver: Receiver<T>,
}

/// The state of a task.
#[derive(Debug)]
pub(crate) enum Outcome<T> {
    Running,
    Done(T),
    /// The thread ended without a result, which is a fault of the program.
    Lost,
}

impl<T: Send + 'static> Task<T> {
    /// Starts `work` on a thread and wakes the window when it is done. WebAssembly has no threads:
    /// there the shell does the work after this frame, by [`do_waiting`].
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
        let (theirs, repaint, ctx) = (progress.clone(), ctx, ctx.clone());
        let work = move || {
            // Dropped last, so the window wakes after the result was sent.
            let _wake = Wake(ctx);
            let sender = sender;
            // The receiver may have been dropped.
            let _ = sender.send(work(&theirs));
        };
        if cfg!(target_family = "wasm") {
            WAITING.with_borrow_mut(|waiting| waiting.push_back(Box::new(work)));
            repaint.request_repaint();
        } else {
            std::thread::Builder::new().name(label.clone()).spawn(work)?;
        }
        Ok(Self { label, progress, receiver })
    }

    /// Returns a task, and the sender for its result.
    pub(crate) fn promised(label: String) -> (Self, Sender<T>) {
        let (sender, receiver) = mpsc::channel();
        (Self { label, progress: Progress::new(), receiver }, sender)
    }

    /// Takes the result, if there is one. It can be taken only once.
    pub(crate) fn outcome(&self) -> Outcome<T> {
        match self.receiver.try_recv() {
            Ok(result) => Outcome::Done(result),
            Err(TryRecvError::Empty) => Outcome::Running,
            Err(TryRecvError::Disconnected) => Outcome::Lost,
        }
    }
}

thread_local! {
    /// Work for the thread of the window.
    static WAITING: RefCell<VecDeque<Box<dyn FnOnce()>>> = RefCell::default();
}

/// Does the work that waits for the thread of the window, if any.
pub(crate) fn do_waiting() {
    while let Some(work) = WAITING.with_borrow_mut(VecDeque::pop_front) {
        work();
    }
}

/// Wakes the window when its thread ends, even by a panic.
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
