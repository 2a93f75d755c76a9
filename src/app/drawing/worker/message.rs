//! Messages between the window and a drawing worker without common memory: another instance of the
//! program, in a worker of a page.
//!
//! A message is a JSON head and the pixels of its pictures. The head's length comes first, as 4
//! bytes, least significant first.

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::app::drawing::border::Border;
use crate::app::drawing::dial::Measured;
use crate::app::drawing::snapshot::DrawOptions;
use crate::app::drawing::viewport_renderer::Drawn;
use marraztu_core::base::image::Size;
use marraztu_core::scene::ItemId;
use marraztu_lab::cost::Explained;
use marraztu_render::Hit;
use marraztu_render::screen::coverage::PixelBox;

#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Request {
    pub(super) picks: Vec<[usize; 2]>,
    /// The item under the pointer, if that changes. JSON has one `null`, hence the list.
    pub(super) border: Option<[Option<ItemId>; 1]>,
    pub(super) ideal: Option<PixelBox>,
    pub(super) wanted: Option<Wanted>,
}

/// A [`Snapshot`](crate::app::drawing::snapshot::Snapshot). Its scene, view and settings are a
/// text.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Wanted {
    pub(super) scene: String,
    pub(super) size: Size,
    pub(super) options: DrawOptions,
}

/// Results of a worker. Pictures follow in the order of their fields.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Reply {
    /// Whether all requests are answered.
    pub(super) done: bool,
    pub(super) border: Option<Border>,
    pub(super) drawn: Option<Drawn>,
    pub(super) refined: Option<Drawn>,
    pub(super) outline: Option<[Option<Border>; 2]>,
    pub(super) explained: Option<Explained>,
    pub(super) dial: Option<Measured>,
    pub(super) ideal: Option<(PixelBox, Size)>,
    pub(super) picked: Vec<Option<Hit>>,
    pub(super) failed: bool,
}

/// The number of bytes of the length.
const LENGTH: usize = 4;

/// The number of bytes of a pixel.
const PIXEL: usize = 4;

/// Writes a message with the bytes of its pictures.
pub(crate) fn write(head: &impl Serialize, pictures: &[&[u8]]) -> Vec<u8> {
    let mut bytes = vec![0; LENGTH];
    // Numbers, texts and lists always have a JSON form.
    let _ = serde_json::to_writer(&mut bytes, head);
    let length = u32::try_from(bytes.len() - LENGTH).unwrap_or(u32::MAX);
    bytes[..LENGTH].copy_from_slice(&length.to_le_bytes());
    for picture in pictures {
        bytes.extend_from_slice(picture);
    }
    bytes
}

/// Reads a message: its head and its pictures. `None` if it is incomplete.
pub(crate) fn read<T: DeserializeOwned>(bytes: &[u8]) -> Option<(T, Pictures<'_>)> {
    let (length, rest) = bytes.split_first_chunk::<LENGTH>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let (head, pictures) = rest.split_at_checked(length)?;
    Some((serde_json::from_slice(head).ok()?, Pictures(pictures)))
}

/// The bytes of pictures that have not been taken yet.
pub(crate) struct Pictures<'a>(&'a [u8]);

impl<'a> Pictures<'a> {
    /// Takes the next picture; `None` if there are not enough bytes.
    pub(crate) fn take(&mut self, [width, height]: [usize; 2]) -> Option<&'a [u8]> {
        let length = width.checked_mul(height)?.checked_mul(PIXEL)?;
        let (own, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_follow_the_head_and_a_cut_message_is_refused() {
        let pixels: Vec<u8> = (0..24).collect();
        let head = Reply { picked: vec![None, None], ..Reply::default() };
        let bytes = write(&head, &[&pixels[..16], &pixels[16..]]);
        let (head, mut pictures) = read::<Reply>(&bytes).unwrap();
        assert_eq!(head.picked, [None, None]);
        assert_eq!(pictures.take([2, 2]), Some(&pixels[..16]));
        assert_eq!(pictures.take([1, 2]), Some(&pixels[16..]));
        assert_eq!(pictures.take([1, 1]), None);
        for length in 0..bytes.len() - pixels.len() {
            assert!(read::<Reply>(&bytes[..length]).is_none(), "{length}");
        }
    }
}
