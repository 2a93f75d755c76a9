//! Runs plans.

use super::FramePlan;
use crate::base::image::{Picture, Size};
use crate::scene::ItemId;

/// Draws pictures, and keeps the memory that this takes from one to the next.
#[derive(Debug, Default)]
pub struct Renderer {
    picture: Picture,
}

/// What is seen at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object, the camera whose mark it is, or the bulb's light.
    pub item: ItemId,
    /// The polygon of its mesh.
    pub polygon: u32,
    /// The depth in the picture: 1 at the near plane, 0 at the far one.
    pub depth: f32,
}

impl Renderer {
    /// Draws what is planned.
    pub fn render(&mut self, plan: &FramePlan) -> &Picture {
        self.picture =
            Picture::filled(Size::new(plan.size.width, plan.size.height), plan.background);
        &self.picture
    }

    /// What the last picture shows in column `x` of row `y`; `None` for the background.
    #[must_use]
    pub fn hit(&self, x: usize, y: usize) -> Option<Hit> {
        let _ = (x, y);
        None
    }
}
