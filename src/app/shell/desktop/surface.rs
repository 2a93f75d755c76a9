//! The memory of a window, and the painter that fills it.

use std::num::NonZeroU32;
use std::sync::Arc;

use egui::{Color32, ColorImage, TexturesDelta};
use softbuffer::SoftBufferError;
use winit::window::Window;

use super::StartError;
use marraztu_painter::{Canvas, WindowFrame, WindowPainter};
use marraztu_render::screen::coverage::PixelBox;

type Shared = Arc<Window>;

/// The memory of a window.
pub(super) struct Surface {
    context: softbuffer::Context<Shared>,
    surface: softbuffer::Surface<Shared, Shared>,
    painter: WindowPainter,
    /// Whether the window has lost its content and has to be presented as a whole.
    exposed: bool,
    /// Whether the memory may differ from the last frame.
    lost: bool,
}

impl Surface {
    pub(super) fn new(window: &Shared) -> Result<Self, StartError> {
        let context =
            softbuffer::Context::new(Arc::clone(window)).map_err(|error| other(&error))?;
        let surface = softbuffer::Surface::new(&context, Arc::clone(window));
        let surface = surface.map_err(|error| other(&error))?;
        Ok(Self { context, surface, painter: WindowPainter::new(), exposed: true, lost: true })
    }

    /// Presents the whole window in the next frame, not only the changes.
    pub(super) const fn expose(&mut self) {
        self.exposed = true;
    }

    /// Paints and presents a frame. Returns a copy of its pixels on request.
    pub(super) fn show(
        &mut self,
        size: [u32; 2],
        frame: WindowFrame,
        textures: &mut TexturesDelta,
        copy: bool,
    ) -> Result<Option<ColorImage>, StartError> {
        let [Some(width), Some(height)] = size.map(NonZeroU32::new) else { return Ok(None) };
        let shown = self.try_show([width, height], frame, textures, copy);
        self.lost = shown.is_err();
        shown.or_else(|error| self.renew(&error).map(|()| None))
    }

    fn try_show(
        &mut self,
        [width, height]: [NonZeroU32; 2],
        frame: WindowFrame,
        textures: &mut TexturesDelta,
        copy: bool,
    ) -> Result<Option<ColorImage>, SoftBufferError> {
        self.surface.resize(width, height)?;
        let window = Arc::clone(self.surface.window());
        let mut buffer = self.surface.buffer_mut()?;
        let size = [buffer.width(), buffer.height()];
        let size = size.map(|count| usize::try_from(count.get()).unwrap_or(usize::MAX));
        // Without a known age, the painter paints every pixel.
        let age = if self.lost { 0 } else { usize::from(buffer.age()) };
        let mut canvas = Canvas { pixels: &mut buffer, size, age };
        let changed = self.painter.paint(&mut canvas, frame, textures);
        let copy = copy.then(|| copied(&buffer, size));
        let all = softbuffer::Rect { x: 0, y: 0, width, height };
        let damage = if std::mem::take(&mut self.exposed) {
            vec![all]
        } else {
            changed.into_iter().filter_map(rect).collect()
        };
        if !damage.is_empty() {
            window.pre_present_notify();
            buffer.present_with_damage(&damage)?;
        }
        Ok(copy)
    }

    /// Replaces the memory of the window. The next frame is presented as a whole.
    fn renew(&mut self, error: &SoftBufferError) -> Result<(), StartError> {
        let window = Arc::clone(self.surface.window());
        let lost = |_| StartError::Lost(error.to_string());
        self.surface = softbuffer::Surface::new(&self.context, window).map_err(lost)?;
        self.exposed = true;
        Ok(())
    }
}

fn rect(area: PixelBox) -> Option<softbuffer::Rect> {
    let count = |count: i32| u32::try_from(count).ok();
    Some(softbuffer::Rect {
        x: count(area.left)?,
        y: count(area.top)?,
        width: NonZeroU32::new(count(area.width())?)?,
        height: NonZeroU32::new(count(area.height())?)?,
    })
}

fn copied(pixels: &[u32], size: [usize; 2]) -> ColorImage {
    let color = |pixel: &u32| {
        let [b, g, r, _] = pixel.to_le_bytes();
        Color32::from_rgb(r, g, b)
    };
    ColorImage::new(size, pixels.iter().map(color).collect())
}

fn other(error: &SoftBufferError) -> StartError {
    StartError::Other(error.to_string())
}
