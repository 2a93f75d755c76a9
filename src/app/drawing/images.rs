//! The images into which pictures of the viewport are copied.
//!
//! There are three: one may be held by the window and one by the code that paints it, so a third is
//! always free to copy into. No picture is overwritten while it is shown.

use std::sync::Arc;

use egui::ColorImage;

use marraztu_core::base::image::{Picture, Size};

/// The form of an image in a message: its size. Its pixels follow the message.
pub(super) mod without_pixels {
    use std::sync::Arc;

    use egui::ColorImage;
    use serde::{Deserialize, Deserializer, Serialize as _, Serializer};

    pub(crate) fn serialize<S: Serializer>(
        image: &Arc<ColorImage>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        image.size.serialize(to)
    }

    pub(crate) fn deserialize<'a, D: Deserializer<'a>>(
        from: D,
    ) -> Result<Arc<ColorImage>, D::Error> {
        let size = Deserialize::deserialize(from)?;
        Ok(Arc::new(ColorImage { size, ..ColorImage::default() }))
    }
}

/// Copies a picture into a free image and moves that image to the end.
pub(super) fn present(images: &mut [Arc<ColorImage>; 3], picture: &Picture) {
    let [first, second, _] = images;
    let free = if Arc::get_mut(first).is_some() { 0 } else { 1 };
    // If both are still held, the second is replaced by a new image rather than overwritten.
    if free == 1 && Arc::get_mut(second).is_none() {
        *second = Arc::default();
    }
    show(picture, Arc::make_mut(&mut images[free]));
    images.swap(free, 2);
}

/// Copies opaque pixels, which are equal with straight and with premultiplied alpha.
fn show(picture: &Picture, image: &mut ColorImage) {
    let Size { width, height } = picture.size();
    if image.size != [width, height] {
        *image = ColorImage::filled([width, height], egui::Color32::BLACK);
    }
    let bytes: &mut [[u8; 4]] = bytemuck::cast_slice_mut(&mut image.pixels);
    bytes.copy_from_slice(picture.pixels());
}

pub(crate) fn picture(image: &ColorImage) -> Option<Picture> {
    let [width, height] = image.size;
    let pixels: &[[u8; 4]] = bytemuck::cast_slice(&image.pixels);
    Picture::from_pixels(Size::new(width, height), pixels.to_vec())
}
