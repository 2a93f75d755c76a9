//! Draws pictures into files: while a band of rows is encoded, the next one is drawn.

use std::sync::mpsc::sync_channel;

use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::{Picture, Size};
use marraztu_io::{self as io, Cancelled, Progress};
use marraztu_render::Bands;

/// Draws a picture and passes it to `save`, which runs on another thread. It receives the size and
/// a function that returns the next rows. Returns its result, and the drawn bands.
///
/// # Errors
/// If `progress` was cancelled; `save` has then received an error, too.
pub fn draw_into<T: Send>(
    shot: &Shot,
    transparent: bool,
    progress: &Progress,
    save: impl FnOnce(Size, &mut io::NextBand<'_>) -> T + Send,
) -> Result<(T, Bands), Cancelled> {
    let mut bands = Bands::new(shot, transparent);
    let size = bands.size();
    let wanted = || !progress.is_cancelled();
    let tell = |done, all| {
        // Drawing asks `wanted`.
        let _ = progress.reached(done, all);
    };
    let cancelled = || std::io::Error::other("it was cancelled");
    // WebAssembly has no threads: a band is drawn when it is needed.
    if cfg!(target_family = "wasm") {
        let mut next = || bands.draw_next(&wanted, &tell).map_err(|_cancelled| cancelled());
        let saved = save(size, &mut next);
        return if progress.is_cancelled() { Err(Cancelled) } else { Ok((saved, bands)) };
    }
    let (sender, receiver) = sync_channel::<Picture>(0);
    let saved = std::thread::scope(|scope| {
        let saved = scope.spawn(move || {
            let mut missing = size.height;
            let mut next = || match receiver.recv() {
                _ if progress.is_cancelled() => Err(cancelled()),
                Ok(band) => {
                    missing -= band.size().height;
                    Ok(Some(band))
                }
                Err(_) if missing == 0 => Ok(None),
                Err(_) => Err(std::io::Error::other("the picture is not complete")),
            };
            save(size, &mut next)
        });
        while let Ok(Some(band)) = bands.draw_next(&wanted, &tell) {
            // Saving has failed, and its result says why.
            if sender.send(band).is_err() {
                break;
            }
        }
        drop(sender);
        saved.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    });
    if progress.is_cancelled() { Err(Cancelled) } else { Ok((saved, bands)) }
}
