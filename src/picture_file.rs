//! Draws pictures into files: while a band of rows is encoded, the next one is drawn.

use std::sync::mpsc::{channel, sync_channel};
use std::thread::Builder;

use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::{Picture, Size};
use marraztu_io::{self as io, Cancelled, Progress};
use marraztu_render::Bands;

/// Draws a picture and passes it to `save`, which runs on another thread. It receives the size and
/// a function that returns the next rows. Returns its result, and the drawn bands.
///
/// # Errors
/// If `progress` was cancelled; `save` has then received an error, too.
pub fn draw_into<T: Send, F: FnOnce(Size, &mut io::NextBand<'_>) -> T + Send>(
    shot: &Shot,
    transparent: bool,
    progress: &Progress,
    save: F,
) -> Result<(T, Bands), Cancelled> {
    let mut bands = Bands::new(shot, transparent);
    let size = bands.size();
    let wanted = || !progress.is_cancelled();
    let tell = |done, all| {
        // Drawing asks `wanted`.
        let _ = progress.reached(done, all);
    };
    let (giver, taker) = channel::<F>();
    let (sender, receiver) = sync_channel::<Picture>(0);
    let drawn = std::thread::scope(|scope| {
        let encode = move || {
            let save = taker.recv().ok()?;
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
            Some(save(size, &mut next))
        };
        let thread = Builder::new().name("encoder".to_owned());
        // Without a further thread, as in WebAssembly, a band is drawn when it is needed.
        let Ok(encoder) = thread.spawn_scoped(scope, encode) else {
            let mut next = || bands.draw_next(&wanted, &tell).map_err(|_cancelled| cancelled());
            return Some(save(size, &mut next));
        };
        // The encoder ends without a result only if it gets no function.
        let _ = giver.send(save);
        while let Ok(Some(band)) = bands.draw_next(&wanted, &tell) {
            // Saving has failed, and its result says why.
            if sender.send(band).is_err() {
                break;
            }
        }
        drop(sender);
        encoder.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    });
    match drawn {
        Some(saved) if !progress.is_cancelled() => Ok((saved, bands)),
        _ => Err(Cancelled),
    }
}

fn cancelled() -> std::io::Error {
    std::io::Error::other("it was cancelled")
}
