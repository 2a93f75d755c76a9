//! The editor as a WebAssembly module for a page of a browser.
//!
//! The module is built for WASI, so the standard library provides files, clocks and random numbers.
//! The page provides a file system in memory. The page's code is in `web/page`.
//!
//! Exported functions pass numbers. Longer values pass through two byte buffers: the page fills
//! [`input`] before a call, and reads [`output`] after it. Events and results are JSON; see
//! [`PageEvent`] and [`Frame`].

mod events;
mod frame;
mod missing;
mod verify;

use std::cell::RefCell;
use std::io::{Read as _, Write as _};
use std::path::PathBuf;
use std::sync::Arc;

use marraztu::app::{CanvasShell, DrawingServer, JobKind};
use marraztu::directions::direction;

use events::PageEvent;
use frame::Frame;
use missing::missing as missing_files;
use verify::Verified;

/// The editor or its drawing server, and the buffers.
#[derive(Default)]
struct Page {
    shell: Option<CanvasShell>,
    server: Option<DrawingServer>,
    input: Vec<u8>,
    output: Vec<u8>,
    /// Red, green, blue and opacity of the pixels that the page copies.
    rgba: Vec<u8>,
    /// The same of a picture for the clipboard.
    picture: Vec<u8>,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

fn with<T>(work: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(work)
}

impl Page {
    /// Returns the paths in the input, one per line.
    fn paths(&self) -> Vec<PathBuf> {
        String::from_utf8_lossy(&self.input).lines().map(PathBuf::from).collect()
    }

    fn write(&mut self, output: &impl serde::Serialize) -> usize {
        // Numbers, strings and lists always have a JSON form.
        self.output = serde_json::to_vec(output).unwrap_or_default();
        self.output.len()
    }
}

/// Returns the address of an input buffer of `length` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    with(|page| {
        page.input.resize(length, 0);
        page.input.as_mut_ptr()
    })
}

/// Returns the address of the output of the last call that returned a length.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    with(|page| page.output.as_ptr())
}

/// Starts the editor on a canvas of `width` x `height` pixels, with `scale` pixels per point, and
/// opens the files whose paths are in the input. Returns 0.
#[unsafe(no_mangle)]
pub extern "C" fn start(width: usize, height: usize, scale: f32) -> u32 {
    with(|page| page.shell = Some(CanvasShell::new([width, height], scale, page.paths())));
    0
}

/// Lets another instance draw the viewport: its [`ask`] takes each [`request`], and [`reply`] takes
/// what its [`work`] returns. To be called between [`start`] and the first frame.
#[unsafe(no_mangle)]
pub extern "C" fn draw_elsewhere() {
    with(|page| {
        if let Some(shell) = &mut page.shell {
            shell.draw_elsewhere();
        }
    });
}

/// Returns the length of the next request to the other instance in the output, or 0. To be called
/// after each [`run`] and each reply.
#[unsafe(no_mangle)]
pub extern "C" fn request() -> usize {
    with(|page| {
        page.output = page.shell.as_mut().and_then(CanvasShell::request).unwrap_or_default();
        page.output.len()
    })
}

/// Takes the reply of the other instance in the input. An empty one means that the instance has
/// stopped and was replaced.
#[unsafe(no_mangle)]
pub extern "C" fn reply() {
    with(|page| {
        let Page { shell: Some(shell), input, .. } = page else { return };
        shell.reply((!input.is_empty()).then_some(input));
    });
}

/// Takes the request in the input, in the instance that draws.
#[unsafe(no_mangle)]
pub extern "C" fn ask() {
    with(|page| {
        let server = page.server.get_or_insert_with(|| DrawingServer::new(is_awaited));
        server.hear(&page.input);
    });
}

/// Returns whether a request waits: the page then provides a byte of standard input.
fn is_awaited() -> bool {
    std::io::stdin().read(&mut [0]).is_ok_and(|count| count > 0)
}

/// Draws. Returns the length of a reply in the output, or 0.
#[unsafe(no_mangle)]
pub extern "C" fn work() -> usize {
    with(|page| {
        page.output = page.server.as_mut().and_then(DrawingServer::work).unwrap_or_default();
        page.output.len()
    })
}

/// Returns the milliseconds until the next work, or -1 if only a request brings some.
#[unsafe(no_mangle)]
pub extern "C" fn rest() -> f64 {
    with(|page| {
        page.server
            .as_ref()
            .and_then(DrawingServer::rest)
            .map_or(-1.0, |rest| rest.as_secs_f64() * 1000.0)
    })
}

/// Tells the instance that draws that files have changed.
#[unsafe(no_mangle)]
pub extern "C" fn files_changed() {
    with(|page| {
        if let Some(server) = &mut page.server {
            server.files_changed();
        }
    });
}

/// Returns the length of the next job of a kind in the output, for [`do_job`] of another instance,
/// or 0. To be called after each frame. A kind is an index in [`JobKind::ALL`].
#[unsafe(no_mangle)]
pub extern "C" fn job(kind: usize) -> usize {
    with(|page| {
        let job = page.shell.as_mut().and_then(|shell| shell.job(JobKind::ALL[kind]));
        page.output = job.unwrap_or_default();
        page.output.len()
    })
}

/// Returns 1 if the result of a job of a kind is awaited, or else 0: the other instance may be
/// stopped.
#[unsafe(no_mangle)]
pub extern "C" fn awaits(kind: usize) -> u32 {
    with(|page| {
        u32::from(page.shell.as_ref().is_some_and(|shell| shell.awaits(JobKind::ALL[kind])))
    })
}

/// Takes what a job of a kind tells, in the input.
#[unsafe(no_mangle)]
pub extern "C" fn told(kind: usize) {
    with(|page| {
        let Page { shell: Some(shell), input, .. } = page else { return };
        shell.told(JobKind::ALL[kind], &String::from_utf8_lossy(input));
    });
}

/// Takes the end of a job of a kind, in the input. An empty one means that the instance has failed.
#[unsafe(no_mangle)]
pub extern "C" fn done(kind: usize) {
    with(|page| {
        let Page { shell: Some(shell), input, .. } = page else { return };
        shell.done(JobKind::ALL[kind], input);
    });
}

/// Does the job in the input. What it tells is written to the standard output, a line each. Returns
/// the length of the end in the output; by then, the files of the job are written.
#[unsafe(no_mangle)]
pub extern "C" fn do_job() -> usize {
    let job = with(|page| std::mem::take(&mut page.input));
    let tell = |told: String| {
        // The page always takes it.
        let _ = writeln!(std::io::stdout(), "{told}");
    };
    let end = marraztu::app::do_job(&job, Arc::new(tell));
    with(|page| {
        page.output = end;
        page.output.len()
    })
}

/// Shows only the picture, for other pages to embed. Models are seen from the direction in the
/// input, if there is one. Returns 0, or 1 if it is not a direction.
#[unsafe(no_mangle)]
pub extern "C" fn show_picture_only() -> u32 {
    with(|page| {
        let text = String::from_utf8_lossy(&page.input);
        let from = match text.trim() {
            "" => None,
            text => match direction(text) {
                Ok(from) => Some(from),
                Err(_the_page_lists_them) => return 1,
            },
        };
        if let Some(shell) = &mut page.shell {
            shell.show_picture_only(from);
        }
        0
    })
}

/// Changes the size of the canvas.
#[unsafe(no_mangle)]
pub extern "C" fn resize(width: usize, height: usize, scale: f32) {
    with(|page| {
        if let Some(shell) = &mut page.shell {
            shell.resize([width, height], scale);
        }
    });
}

/// Takes the event in the input. Returns 0, or 1 if it is not a [`PageEvent`].
#[unsafe(no_mangle)]
pub extern "C" fn hear() -> u32 {
    with(|page| {
        let Page { shell: Some(shell), input, .. } = page else { return 1 };
        let Ok(event) = serde_json::from_slice::<PageEvent>(input) else { return 1 };
        for event in event.into_events(shell.zoom()) {
            shell.hear(event);
        }
        0
    })
}

/// Shows the sentence in the input in a notice.
#[unsafe(no_mangle)]
pub extern "C" fn tell() {
    with(|page| {
        let sentence = String::from_utf8_lossy(&page.input).into_owned();
        if let Some(shell) = &mut page.shell {
            shell.tell(sentence);
        }
    });
}

/// Opens the files whose paths are in the input, as if they were dropped on the editor.
#[unsafe(no_mangle)]
pub extern "C" fn drop_files() {
    with(|page| {
        let paths = page.paths();
        if let Some(shell) = &mut page.shell {
            shell.drop_files(paths);
        }
    });
}

/// Gives the editor the files that it has asked for. No paths in the input mean that the user has
/// cancelled.
#[unsafe(no_mangle)]
pub extern "C" fn answer() {
    with(|page| {
        let paths = page.paths();
        if let Some(shell) = &mut page.shell {
            shell.answer(paths);
        }
    });
}

/// Runs a frame at a time in seconds, and does not paint it.
#[unsafe(no_mangle)]
pub extern "C" fn run(time: f64) {
    with(|page| {
        if let Some(shell) = &mut page.shell {
            shell.run(time);
        }
    });
}

/// Paints the frame. Returns the length of a [`Frame`] in the output.
#[unsafe(no_mangle)]
pub extern "C" fn paint() -> usize {
    with(|page| {
        let Some(shell) = &mut page.shell else { return 0 };
        let painted = shell.paint();
        let (frame, image) = Frame::new(shell, painted);
        if let Some(image) = image {
            page.picture = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
        }
        page.write(&frame)
    })
}

/// Returns the address of the RGBA bytes of the last picture for the clipboard, row by row.
#[unsafe(no_mangle)]
pub extern "C" fn picture() -> *const u8 {
    with(|page| page.picture.as_ptr())
}

/// Returns the address of the RGBA bytes of a rectangle of the canvas, row by row; null if it is
/// not within the canvas.
#[unsafe(no_mangle)]
pub extern "C" fn rgba(x: usize, y: usize, width: usize, height: usize) -> *const u8 {
    with(|page| {
        let Page { shell: Some(shell), rgba, .. } = page else { return std::ptr::null() };
        match shell.copy_rgba([x, y], [width, height], rgba) {
            true => rgba.as_ptr(),
            false => std::ptr::null(),
        }
    })
}

/// Draws the listed pictures and compares their sums. Returns the length of a [`Verified`] in the
/// output.
#[unsafe(no_mangle)]
pub extern "C" fn verify() -> usize {
    with(|page| page.write(&Verified::now()))
}

/// Lists the files that the model or scene at the path in the input refers to and that do not
/// exist. Returns the length of a JSON list in the output: for each file, a list of the paths at
/// which it may be.
#[unsafe(no_mangle)]
pub extern "C" fn missing() -> usize {
    with(|page| {
        let found = page.paths().iter().flat_map(|path| missing_files(path)).collect::<Vec<_>>();
        page.write(&found)
    })
}
