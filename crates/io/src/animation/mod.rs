//! Saves a sequence of pictures as a GIF, an animated PNG or numbered files.
//!
//! A GIF has 256 colours per picture and times in hundredths of a second; an animated PNG has full
//! colour. Both are written in one piece at the end, so a cancelled animation leaves no file
//! behind.

mod gif;
mod palette;

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use self::gif::GifWriter;
use super::error::reason;
use super::picture::{check_layer_target, check_picture_target, save_picture, sides_of};
use super::replace::{SaveError, Worth, check_scheme, check_target, replace};
use super::sources::Sources;
use marraztu_core::base::image::{Picture, Size};

/// The shortest time of a picture of a GIF, in hundredths of a second: browsers show a picture of
/// one hundredth for ten.
const LEAST_GIF_TIME: u32 = 2;

/// The longest time of a picture in its units, which a GIF and an animated PNG store in 16 bits.
const MOST_TIME: u32 = u16::MAX as u32;

/// The format of an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationFormat {
    /// A GIF.
    Gif,
    /// An animated PNG.
    Apng,
    /// A folder of numbered PNG files.
    Frames,
}

impl AnimationFormat {
    /// Returns the format for a file name.
    ///
    /// # Errors
    /// The supported extensions, if the name has another one.
    pub fn of(path: &Path) -> Result<Self, String> {
        let Some(ending) = path.extension() else { return Ok(Self::Frames) };
        match ending.to_string_lossy().to_lowercase().as_str() {
            "gif" => Ok(Self::Gif),
            "png" | "apng" => Ok(Self::Apng),
            _ => Err("its name has to end in .gif or .png (animated); the folder of numbered \
                pictures has no ending"
                .to_owned()),
        }
    }
}

/// The properties of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Animation {
    /// The width and height of its pictures.
    pub size: Size,
    /// The number of pictures, at least 1.
    pub frames: u32,
    /// The duration of the whole animation.
    pub seconds: f64,
    /// Whether pixels may be transparent.
    pub transparent: bool,
}

impl Animation {
    /// Returns the time of picture `i` in units of 1/`units` second. The times sum to the whole
    /// duration, rounded once.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within a day")]
    fn time(&self, i: u32, units: f64) -> u32 {
        let end = |i: u32| {
            let part = f64::from(i) / f64::from(self.frames.max(1));
            (self.seconds * units * part).round().clamp(0.0, 1e9) as u32
        };
        (end(i + 1) - end(i)).max(1)
    }

    /// Returns the time of picture `i` of a GIF in hundredths of a second.
    fn gif_time(&self, i: u32) -> u32 {
        self.time(i, 100.0).clamp(LEAST_GIF_TIME, MOST_TIME)
    }

    /// Returns the units per second of an animated PNG: the finest that hold the times.
    fn png_units(&self) -> u16 {
        let longest = |units: u16| self.seconds * f64::from(units) / f64::from(self.frames.max(1));
        let fits = |units: &u16| longest(*units) <= f64::from(MOST_TIME);
        [1000, 100, 10].into_iter().find(fits).unwrap_or(1)
    }

    /// Returns the duration of the animation as a GIF, in seconds.
    fn gif_seconds(&self) -> f64 {
        f64::from((0..self.frames).map(|i| self.gif_time(i)).sum::<u32>()) / 100.0
    }
}

/// A shared buffer: an encoder writes into it, and the writer takes the bytes at the end.
#[derive(Clone, Debug, Default)]
struct Bytes(Arc<Mutex<Vec<u8>>>);

impl Bytes {
    fn take(&self) -> Vec<u8> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Bytes {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

enum Encoder {
    Gif(GifWriter),
    Apng(Box<png::Writer<Bytes>>),
    Frames,
}

/// Writes an animation, picture by picture.
pub struct AnimationWriter {
    path: PathBuf,
    animation: Animation,
    encoder: Encoder,
    bytes: Bytes,
    written: u32,
    notes: Vec<String>,
}

impl std::fmt::Debug for AnimationWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AnimationWriter").field("path", &self.path).finish_non_exhaustive()
    }
}

impl AnimationWriter {
    /// Checks, before anything is drawn, whether an animation can be saved at `path` without
    /// overwriting one of `sources`.
    ///
    /// # Errors
    /// If it cannot.
    pub fn check(path: &Path, sources: &Sources) -> Result<(), SaveError> {
        check_scheme(path)?;
        sources.spare(path)?;
        let fail = |reason: &str| SaveError::new(path, reason);
        match AnimationFormat::of(path).map_err(|reason| fail(&reason))? {
            AnimationFormat::Gif if path.exists() && !is_gif(path) => {
                Err(fail("a file with this name exists and is not a GIF; choose another name"))
            }
            AnimationFormat::Gif => check_target(path),
            // It is a PNG, but the ending .apng is not one of pictures.
            AnimationFormat::Apng => check_layer_target(path),
            AnimationFormat::Frames if path.is_file() => {
                Err(fail("a file with this name exists; choose another name for the folder"))
            }
            AnimationFormat::Frames => Ok(()),
        }
    }

    /// Begins an animation.
    ///
    /// # Errors
    /// If it cannot be saved there.
    pub fn begin(path: &Path, animation: Animation, sources: &Sources) -> Result<Self, SaveError> {
        Self::check(path, sources)?;
        let fail = |reason: String| SaveError::new(path, reason);
        let bytes = Bytes::default();
        let encoder = match AnimationFormat::of(path).map_err(fail)? {
            AnimationFormat::Gif => {
                Encoder::Gif(GifWriter::new(animation.size, animation.transparent))
            }
            AnimationFormat::Apng => {
                let writer = apng(bytes.clone(), &animation);
                Encoder::Apng(Box::new(writer.map_err(|error| fail(error.to_string()))?))
            }
            AnimationFormat::Frames => {
                // Check every file now: a failure after an hour of drawing would be too late.
                fs::create_dir_all(path).map_err(|error| fail(reason(&error)))?;
                for i in 0..animation.frames {
                    let frame = frame(path, &animation, i);
                    sources.spare(&frame)?;
                    check_picture_target(&frame)?;
                }
                Encoder::Frames
            }
        };
        let notes = notes(path, &animation, &encoder);
        Ok(Self { path: path.to_owned(), animation, encoder, bytes, written: 0, notes })
    }

    /// Returns the differences between the file and the request, one sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn push(&mut self, picture: &Picture) -> Result<(), SaveError> {
        let i = self.written;
        self.written += 1;
        let (animation, path) = (self.animation, &self.path);
        let fail = |reason: String| SaveError::new(path, reason);
        match &mut self.encoder {
            Encoder::Gif(writer) => writer.push(picture).map_err(|error| fail(error.to_string())),
            Encoder::Apng(writer) => {
                // A single picture is a plain PNG, without times.
                let units = animation.png_units();
                let time = animation.time(i, f64::from(units));
                let time = u16::try_from(time).unwrap_or(u16::MAX);
                let timed = match animation.frames {
                    1 => Ok(()),
                    _ => writer.set_frame_delay(time, units),
                };
                let bytes = match animation.transparent {
                    true => picture.pixels().as_flattened().to_vec(),
                    false => {
                        picture.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
                    }
                };
                let written = timed.and_then(|()| writer.write_image_data(&bytes));
                written.map_err(|error| fail(error.to_string()))
            }
            Encoder::Frames => save_picture(&frame(path, &animation, i), picture),
        }
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If it cannot be written; an existing file stays as it was.
    pub fn finish(self) -> Result<(), SaveError> {
        let Self { path, encoder, bytes, animation, .. } = self;
        let fail = |error: &dyn std::fmt::Display| SaveError::new(&path, error.to_string());
        let content = match encoder {
            Encoder::Gif(writer) => {
                let delay = |number: usize| {
                    let number = u32::try_from(number).unwrap_or(u32::MAX);
                    u16::try_from(animation.gif_time(number)).unwrap_or(u16::MAX)
                };
                writer.finish(delay).map_err(|error| fail(&error))?
            }
            Encoder::Apng(writer) => {
                writer.finish().map_err(|error| fail(&error))?;
                bytes.take()
            }
            Encoder::Frames => return Ok(()),
        };
        replace(&path, &content, Worth::Product)
    }
}

fn notes(path: &Path, animation: &Animation, encoder: &Encoder) -> Vec<String> {
    match encoder {
        Encoder::Gif(_) => {
            let seconds = animation.gif_seconds();
            let takes = format!("{} pictures take {seconds} seconds", animation.frames);
            // Each time is rounded to a hundredth, and so is their sum.
            let note = if seconds > animation.seconds + 0.01 {
                format!(
                    "a GIF shows at most 50 pictures a second: {takes}; choose fewer pictures, or \
                     an animated PNG"
                )
            } else if seconds < animation.seconds - 0.01 {
                format!(
                    "a GIF shows a picture for at most 655 seconds: {takes}; choose more pictures, \
                     or an animated PNG"
                )
            } else {
                return Vec::new();
            };
            vec![note]
        }
        Encoder::Apng(_) => Vec::new(),
        Encoder::Frames => stale(path, animation).into_iter().collect(),
    }
}

/// Notes pictures in the folder that this animation does not replace.
fn stale(folder: &Path, animation: &Animation) -> Option<String> {
    // The folder may hold pictures of a longer animation with the same names.
    let is_stale = |name: &String| {
        frame_number(name).is_some_and(|number| {
            let is_own = (1..=animation.frames).contains(&number)
                && frame(folder, animation, number - 1).ends_with(name);
            !is_own
        })
    };
    let names = fs::read_dir(folder).ok()?.flatten();
    let names = names.filter_map(|entry| entry.file_name().into_string().ok());
    let mut stale: Vec<String> = names.filter(is_stale).collect();
    stale.sort();
    let (first, last) = (stale.first()?, stale.last()?);
    let folder = folder.display();
    Some(match stale.len() {
        1 => format!("{folder} also has a picture of an earlier run: {first}"),
        count => format!("{folder} also has {count} pictures of an earlier run: {first} to {last}"),
    })
}

/// Returns the number in a file name such as `frame-001.png`; `None` for other names.
fn frame_number(name: &str) -> Option<u32> {
    let digits = name.strip_prefix("frame-")?.strip_suffix(".png")?;
    digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok())?
}

/// Returns the file of picture `i` in a folder.
fn frame(folder: &Path, animation: &Animation, i: u32) -> PathBuf {
    let digits = animation.frames.to_string().len().max(3);
    folder.join(format!("frame-{:0digits$}.png", i + 1))
}

fn apng(to: Bytes, animation: &Animation) -> Result<png::Writer<Bytes>, png::EncodingError> {
    let [width, height] = sides_of(animation.size);
    let mut encoder = png::Encoder::new(to, width, height);
    encoder.set_color(match animation.transparent {
        true => png::ColorType::Rgba,
        false => png::ColorType::Rgb,
    });
    encoder.set_depth(png::BitDepth::Eight);
    if animation.frames > 1 {
        encoder.set_animated(animation.frames, 0)?;
    }
    encoder.write_header()
}

fn is_gif(path: &Path) -> bool {
    match fs::read(path) {
        Ok(content) => content.is_empty() || content.starts_with(b"GIF8"),
        Err(error) => error.kind() == ErrorKind::NotFound,
    }
}

#[cfg(test)]
mod tests {
    use image::{AnimationDecoder, Frame};

    use super::*;

    const SIZE: Size = Size::new(8, 6);

    fn animation(frames: u32) -> Animation {
        Animation { size: SIZE, frames, seconds: 1.0, transparent: false }
    }

    fn written(path: &Path, frames: u32) {
        let mut writer =
            AnimationWriter::begin(path, animation(frames), &Sources::default()).unwrap();
        for i in 0..frames {
            let gray = u8::try_from(i * 80).unwrap();
            writer.push(&Picture::filled(SIZE, [gray, 0, 255 - gray, 255])).unwrap();
        }
        writer.finish().unwrap();
    }

    #[test]
    fn a_gif_and_an_animated_png_have_every_picture_and_the_whole_time() {
        let folder = tempfile::tempdir().unwrap();
        let gif = folder.path().join("a.gif");
        written(&gif, 3);
        let file = std::io::BufReader::new(fs::File::open(&gif).unwrap());
        let frames = image::codecs::gif::GifDecoder::new(file).unwrap().into_frames();
        let frames: Vec<Frame> = frames.collect_frames().unwrap();
        let times: Vec<u32> = frames.iter().map(|it| it.delay().numer_denom_ms().0).collect();
        assert_eq!(times, [330, 340, 330]);
        assert_eq!(frames[2].buffer().get_pixel(3, 3).0, [160, 0, 95, 255]);

        let apng = folder.path().join("a.png");
        written(&apng, 3);
        let file = std::io::BufReader::new(fs::File::open(&apng).unwrap());
        let decoder = image::codecs::png::PngDecoder::new(file).unwrap().apng().unwrap();
        let frames: Vec<Frame> = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 3);
        assert_eq!(frames[1].buffer().get_pixel(3, 3).0, [80, 0, 175, 255]);
        let sum = frames.iter().map(|it| {
            let (ms, by) = it.delay().numer_denom_ms();
            f64::from(ms) / f64::from(by)
        });
        assert!((sum.sum::<f64>() - 1000.0).abs() < 0.5);
    }

    #[test]
    fn long_times_are_kept_or_noted() {
        let of = |frames, seconds| Animation { seconds, ..animation(frames) };
        // By hand: 3600 s / 2 exceed 65535 hundredths, but not tenths.
        for (frames, seconds, units) in
            [(60, 4.0, 1000), (2, 131.07, 1000), (2, 131.1, 100), (2, 3600.0, 10), (1, 1e9, 1)]
        {
            assert_eq!(of(frames, seconds).png_units(), units, "{frames} {seconds}");
        }
        let folder = tempfile::tempdir().unwrap();
        let apng = folder.path().join("long.png");
        let mut writer = AnimationWriter::begin(&apng, of(2, 600.0), &Sources::default()).unwrap();
        for _ in 0..2 {
            writer.push(&Picture::filled(SIZE, [9, 9, 9, 255])).unwrap();
        }
        writer.finish().unwrap();
        let file = std::io::BufReader::new(fs::File::open(&apng).unwrap());
        let decoder = image::codecs::png::PngDecoder::new(file).unwrap().apng().unwrap();
        let frames: Vec<Frame> = decoder.into_frames().collect_frames().unwrap();
        let times = frames.iter().map(|it| it.delay().numer_denom_ms());
        assert!(
            times.clone().all(|(ms, by)| ms == 300_000 * by),
            "{:?}",
            times.collect::<Vec<_>>()
        );
        let notes = |frames, seconds| {
            let path = folder.path().join("long.gif");
            let writer = AnimationWriter::begin(&path, of(frames, seconds), &Sources::default());
            writer.unwrap().notes().join("")
        };
        assert_eq!(notes(6, 3600.0), "");
        assert!(notes(2, 3600.0).contains("2 pictures take 1310.7 seconds; choose more"));
        assert!(notes(100, 1.0).contains("100 pictures take 2 seconds; choose fewer"));
    }

    #[test]
    fn a_still_part_of_a_gif_does_not_flicker() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gif");
        let size = Size::new(64, 64);
        let animation = Animation { size, frames: 4, seconds: 1.0, transparent: false };
        let mut writer = AnimationWriter::begin(&path, animation, &Sources::default()).unwrap();
        // The upper half is a constant gradient; the lower half changes its colours.
        let pixel = |frame: usize, i: usize| {
            let byte = |x: usize| u8::try_from(x % 256).unwrap();
            let (x, y) = (i % 64, i / 64);
            match y < 32 {
                true => [byte(4 * x), byte(8 * y), byte(4 * x + 8 * y), 255],
                false => [byte(60 * frame), byte(4 * x), byte(x * y), 255],
            }
        };
        for frame in 0..4 {
            let pixels = (0..64 * 64).map(|i| pixel(frame, i)).collect();
            writer.push(&Picture::from_pixels(size, pixels).unwrap()).unwrap();
        }
        writer.finish().unwrap();
        let file = std::io::BufReader::new(fs::File::open(&path).unwrap());
        let frames = image::codecs::gif::GifDecoder::new(file).unwrap().into_frames();
        let frames: Vec<Frame> = frames.collect_frames().unwrap();
        let upper = |frame: &Frame| frame.buffer().as_raw()[..64 * 32 * 4].to_vec();
        assert!(frames.iter().all(|frame| upper(frame) == upper(&frames[0])));
        // Dithering keeps the mean of the gradient.
        let mean =
            |bytes: &[u8]| bytes.iter().map(|x| f64::from(*x)).sum::<f64>() / bytes.len() as f64;
        let right: Vec<u8> = (0..64 * 32).flat_map(|i| pixel(0, i)).collect();
        assert!((mean(&upper(&frames[0])) - mean(&right)).abs() < 2.0);
    }

    #[test]
    fn numbered_pictures_are_written_to_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let frames = folder.path().join("turn");
        written(&frames, 3);
        let mut names: Vec<_> = fs::read_dir(&frames).unwrap().flatten().collect();
        names.sort_by_key(fs::DirEntry::file_name);
        assert_eq!(names[2].file_name(), "frame-003.png");
        assert_eq!(names.len(), 3);
        fs::write(frames.join("frame-001.png"), "a poem").unwrap();
        let again = AnimationWriter::begin(&frames, animation(3), &Sources::default());
        assert!(again.is_err(), "a file that is not a picture stays");
    }

    #[test]
    fn other_names_and_other_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let check =
            |name: &str| AnimationWriter::check(&folder.path().join(name), &Sources::default());
        fs::write(folder.path().join("poem.gif"), "Roses").unwrap();
        fs::write(folder.path().join("poem.apng"), "Roses").unwrap();
        fs::write(folder.path().join("poem.APNG"), "Roses").unwrap();
        fs::write(folder.path().join("poem"), "Roses").unwrap();
        for right in ["a.gif", "a.GIF", "a.png", "a.PNG", "a.apng", "a.APNG", "a"] {
            assert!(check(right).is_ok(), "{right}");
        }
        for wrong in ["a.mp4", "poem.gif", "poem.apng", "poem.APNG", "poem", "none/a.gif"] {
            assert!(check(wrong).is_err(), "{wrong}");
        }
    }
}
