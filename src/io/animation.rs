//! Saves pictures that follow each other: as a GIF, as an animated PNG, or as numbered files.
//!
//! A GIF has 256 colours a picture, chosen for each, and times in hundredths of a second; an
//! animated PNG has every colour. Both are written whole when they are finished, so that what is
//! cancelled leaves nothing behind.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, RgbaImage};

use super::error::reason;
use super::picture::{check_picture_target, save_picture};
use super::replace::{SaveError, Worth, check_target, replace};
use crate::base::image::{Picture, Size};

/// How carefully the colours of a GIF are chosen: 1 is the best, 30 the quickest.
const GIF_SPEED: i32 = 10;

/// The form of an animation.
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
    /// The form that the name of a file asks for.
    ///
    /// # Errors
    /// The endings, if it has another one.
    pub fn of(path: &Path) -> Result<Self, String> {
        let Some(ending) = path.extension() else { return Ok(Self::Frames) };
        match ending.to_string_lossy().to_lowercase().as_str() {
            "gif" => Ok(Self::Gif),
            "png" | "apng" => Ok(Self::Apng),
            _ => Err("its name has to end in .gif or .png (animated), or in nothing: then it is \
                      a folder of numbered pictures"
                .to_owned()),
        }
    }
}

/// What an animation is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Animation {
    /// The width and height of its pictures.
    pub size: Size,
    /// The number of pictures: at least 1.
    pub frames: u32,
    /// How long all of them take.
    pub seconds: f64,
    /// Whether pixels may be transparent.
    pub transparent: bool,
}

impl Animation {
    /// The time of picture `i` in whole units; a second has `units`. The sum of all times
    /// is the whole time, rounded once.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within a day")]
    fn time(&self, i: u32, units: f64) -> u32 {
        let end = |i: u32| {
            let part = f64::from(i) / f64::from(self.frames.max(1));
            (self.seconds * units * part).round().clamp(0.0, 1e9) as u32
        };
        (end(i + 1) - end(i)).max(1)
    }
}

/// Bytes that an encoder writes and that are read when it is done.
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
    Gif(Box<GifEncoder<Bytes>>),
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
}

impl std::fmt::Debug for AnimationWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AnimationWriter").field("path", &self.path).finish_non_exhaustive()
    }
}

impl AnimationWriter {
    /// Checks, before anything is drawn, whether an animation could be saved at `path`.
    ///
    /// # Errors
    /// If it could not.
    pub fn check(path: &Path) -> Result<(), SaveError> {
        let fail = |reason: &str| SaveError::new(path, reason);
        match AnimationFormat::of(path).map_err(|reason| fail(&reason))? {
            AnimationFormat::Gif if path.exists() && !is_gif(path) => {
                Err(fail("there is a file of that name, and it is not a GIF; choose another name"))
            }
            AnimationFormat::Gif => check_target(path),
            AnimationFormat::Apng if path.extension().is_some_and(|it| it == "apng") => {
                check_target(path)
            }
            AnimationFormat::Apng => check_picture_target(path),
            AnimationFormat::Frames if path.is_file() => {
                Err(fail("there is a file of that name: name a folder"))
            }
            AnimationFormat::Frames => Ok(()),
        }
    }

    /// Begins an animation.
    ///
    /// # Errors
    /// If it could not be saved there.
    pub fn begin(path: &Path, animation: Animation) -> Result<Self, SaveError> {
        Self::check(path)?;
        let fail = |reason: String| SaveError::new(path, reason);
        let bytes = Bytes::default();
        let encoder = match AnimationFormat::of(path).map_err(fail)? {
            AnimationFormat::Gif => {
                let mut encoder = GifEncoder::new_with_speed(bytes.clone(), GIF_SPEED);
                let repeated = encoder.set_repeat(Repeat::Infinite);
                repeated.map_err(|error| fail(error.to_string()))?;
                Encoder::Gif(Box::new(encoder))
            }
            AnimationFormat::Apng => {
                let writer = apng(bytes.clone(), &animation);
                Encoder::Apng(Box::new(writer.map_err(|error| fail(error.to_string()))?))
            }
            AnimationFormat::Frames => {
                fs::create_dir_all(path).map_err(|error| fail(reason(&error)))?;
                Encoder::Frames
            }
        };
        Ok(Self { path: path.to_owned(), animation, encoder, bytes, written: 0 })
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
            Encoder::Gif(encoder) => {
                let [width, height] = sides(animation.size);
                let pixels = picture.pixels().as_flattened().to_vec();
                let image = RgbaImage::from_raw(width, height, pixels);
                let image = image.ok_or_else(|| fail("a picture has another size".to_owned()))?;
                let delay = Delay::from_numer_denom_ms(animation.time(i, 100.0) * 10, 1);
                let frame = Frame::from_parts(image, 0, 0, delay);
                encoder.encode_frame(frame).map_err(|error| fail(error.to_string()))
            }
            Encoder::Apng(writer) => {
                let time = u16::try_from(animation.time(i, 1000.0)).unwrap_or(u16::MAX);
                let timed = match animation.frames {
                    1 => Ok(()),
                    _ => writer.set_frame_delay(time, 1000),
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
            Encoder::Frames => {
                let digits = animation.frames.to_string().len().max(3);
                let file = path.join(format!("frame-{:0digits$}.png", i + 1));
                check_picture_target(&file)?;
                save_picture(&file, picture)
            }
        }
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If it cannot be written; an existing file stays as it was.
    pub fn finish(self) -> Result<(), SaveError> {
        let Self { path, encoder, bytes, .. } = self;
        match encoder {
            // The end of the file is written when the encoder is gone.
            Encoder::Gif(encoder) => drop(encoder),
            Encoder::Apng(writer) => {
                let finished = writer.finish();
                finished.map_err(|error| SaveError::new(&path, error.to_string()))?;
            }
            Encoder::Frames => return Ok(()),
        }
        replace(&path, &bytes.take(), Worth::Product)
    }
}

fn apng(to: Bytes, animation: &Animation) -> Result<png::Writer<Bytes>, png::EncodingError> {
    let [width, height] = sides(animation.size);
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

fn sides(size: Size) -> [u32; 2] {
    [size.width, size.height].map(|side| u32::try_from(side).unwrap_or(u32::MAX))
}

fn is_gif(path: &Path) -> bool {
    match fs::read(path) {
        Ok(content) => content.is_empty() || content.starts_with(b"GIF8"),
        Err(error) => error.kind() == ErrorKind::NotFound,
    }
}

#[cfg(test)]
mod tests {
    use image::AnimationDecoder;

    use super::*;

    const SIZE: Size = Size::new(8, 6);

    fn animation(frames: u32) -> Animation {
        Animation { size: SIZE, frames, seconds: 1.0, transparent: false }
    }

    fn written(path: &Path, frames: u32) {
        let mut writer = AnimationWriter::begin(path, animation(frames)).unwrap();
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
    fn numbered_pictures_stand_in_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let frames = folder.path().join("turn");
        written(&frames, 3);
        let mut names: Vec<_> = fs::read_dir(&frames).unwrap().flatten().collect();
        names.sort_by_key(fs::DirEntry::file_name);
        assert_eq!(names[2].file_name(), "frame-003.png");
        assert_eq!(names.len(), 3);
        fs::write(frames.join("frame-001.png"), "a poem").unwrap();
        let mut again = AnimationWriter::begin(&frames, animation(3)).unwrap();
        assert!(again.push(&Picture::filled(SIZE, [0; 4])).is_err(), "what is no picture stays");
    }

    #[test]
    fn other_names_and_other_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let check = |name: &str| AnimationWriter::check(&folder.path().join(name));
        fs::write(folder.path().join("poem.gif"), "Roses").unwrap();
        fs::write(folder.path().join("poem"), "Roses").unwrap();
        assert!(check("a.gif").is_ok() && check("a.png").is_ok() && check("a").is_ok());
        for wrong in ["a.mp4", "poem.gif", "poem", "none/a.gif"] {
            assert!(check(wrong).is_err(), "{wrong}");
        }
    }
}
