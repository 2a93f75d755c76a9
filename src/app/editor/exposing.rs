//! Fits the exposure to the picture.

use super::App;
use marraztu_core::base::image::Size;
use marraztu_core::scene::View;
use marraztu_render::fitted_exposure;

/// The longer side of the picture used to fit the exposure. The share of brightest pixels needs no
/// larger picture.
const SIDE: usize = 160;

impl App {
    /// Fits the exposure so the brightest surfaces are just below white.
    pub(crate) fn fit_exposure(&mut self) {
        let Some(Size { width, height }) = self.viewport.size() else { return };
        let longest = width.max(height).max(1);
        let side = |side: usize| (side * SIDE / longest).max(1);
        let size = Size::new(side(width), side(height));
        let exposure = fitted_exposure(&self.state.shot(size));
        self.state.tell(Some(format!("Exposure {exposure} stops")));
        self.show_view(View { exposure, ..self.state.view.clone() });
    }
}
