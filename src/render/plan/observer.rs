//! Who looks, and what is outside the view.

use glam::{DMat3, DMat4, DVec3, DVec4};

use crate::accuracy::Shot;
use crate::base::image::Size;
use crate::base::math;
use crate::render::lights::region::Region;
use crate::render::screen::clip::Screen;
use crate::scene::{Lens, Projection};

/// How far is seen in the unit of view space: at least so far, and less than twice as far.
const FAR: f64 = 1024.0;

/// The unit of view space that a lens calls for. Held to where its square has room in f64.
fn unit(lens: &Lens, projection: Projection) -> f64 {
    let far = match projection {
        Projection::Perspective => lens.far,
        Projection::Orthographic => {
            lens.parallel_near.abs().max(lens.parallel_far.abs()).max(lens.half_size)
        }
    };
    FAR / math::power_of_two_near(far.clamp(1e-120, 1e120))
}

/// The observer's spaces.
///
/// View space has a unit of its own, a power of two, in which the observer sees about a thousand
/// units far: so light of 32 bits is the same for scenes of atoms and of stars, and for scenes of
/// ordinary size the unit is the world's.
#[derive(Debug)]
pub(crate) struct ObserverSpace {
    /// How many units of view space a unit of the world is.
    pub(crate) unit: f64,
    pub(crate) world_from_view: DMat4,
    pub(crate) view_from_world: DMat4,
    pub(crate) clip_from_view: DMat4,
    pub(crate) size: Size,
}

impl ObserverSpace {
    pub(super) fn new(shot: &Shot) -> Self {
        let Shot { scene, view, size, .. } = shot;
        let size = *size;
        let world_from_view = scene.observer_frame(view);
        // The axes are orthonormal, so the inverse turn is the transposed one.
        let turn = DMat3::from_mat4(world_from_view).transpose();
        let eye = world_from_view.w_axis.truncate();
        let lens = scene.selected_camera(view).lens;
        let unit = unit(&lens, view.projection);
        let turned = math::placed(turn, DVec3::ZERO) * DMat4::from_translation(-eye);
        let lens = Lens {
            near: lens.near * unit,
            far: lens.far * unit,
            half_size: lens.half_size * unit,
            parallel_near: lens.parallel_near * unit,
            parallel_far: lens.parallel_far * unit,
            ..lens
        };
        Self {
            unit,
            world_from_view,
            view_from_world: DMat4::from_scale(DVec3::splat(unit)) * turned,
            clip_from_view: lens.clip_from_view(view.projection, size),
            size,
        }
    }

    /// Whether a box lies wholly outside one of the planes of the view, and so far beside it that no
    /// line along its border reaches in.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    pub(super) fn misses(&self, clip_from_object: DMat4, corners: [DVec3; 8]) -> bool {
        let clip = corners.map(|corner| clip_from_object * corner.extend(1.0));
        let aside = |pixels: usize| 1.0 + 2.0 * LINE / pixels as f64;
        let (x, y) = (aside(self.size.width), aside(self.size.height));
        // A little is left for rounding, so that nothing is missed that geometry would keep.
        let beyond = |distance: &dyn Fn(DVec4) -> f64| {
            clip.iter().all(|p| distance(*p) < -1e-9 * (p.w.abs() + p.abs().max_element()))
        };
        beyond(&|p| p.w * x + p.x)
            || beyond(&|p| p.w * x - p.x)
            || beyond(&|p| p.w * y + p.y)
            || beyond(&|p| p.w * y - p.y)
            || beyond(&|p| p.z)
            || beyond(&|p| p.w - p.z)
    }

    /// Whether a box lies so far inside the planes that triangles are cut by that nothing in it is cut.
    pub(super) fn holds(&self, clip_from_object: DMat4, corners: [DVec3; 8]) -> bool {
        let screen = Screen::new(clip_from_object, self.size);
        corners.iter().all(|corner| screen.holds(screen.clip(corner.to_array())))
    }

    /// Where the places are at which what a box holds is lit at pixels, where nothing of it is cut.
    ///
    /// A pixel's place is its ray's at the depth of the snapped triangle: a part of a pixel beside the
    /// true one, and in perspective as wrong in w as 1/w is at the triangle's nearest corner.
    pub(super) fn seen_region(&self, view_from_object: DMat4, corners: [DVec3; 8]) -> Region {
        let placed = Region::placed(view_from_object, corners, 0.0);
        let w =
            corners.map(|corner| (self.clip_from_view * view_from_object * corner.extend(1.0)).w);
        let (nearest, farthest) =
            w.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), w| (low.min(*w), high.max(*w)));
        let beside = SNAPPED * self.pixel() * farthest;
        let deeper = ROUNDING * placed.reach() * (1.0 + farthest / nearest);
        Region::placed(view_from_object, corners, beside + deeper)
    }

    /// The side of a pixel in view space where w is 1.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    fn pixel(&self) -> f64 {
        let Size { width, height } = self.size;
        let across = 2.0 / (width as f64 * self.clip_from_view.x_axis.x);
        across.max(2.0 / (height as f64 * self.clip_from_view.y_axis.y))
    }
}

/// How many pixels beside where it is a line may be drawn: half the width of a wide one, and the
/// half of a pixel that its place is rounded by.
const LINE: f64 = 2.0;

/// By how many pixels snapping moves a place at most, and twice that.
const SNAPPED: f64 = 0.006;

/// What interpolation in 32 bits may be wrong by, as a part of the largest value.
const ROUNDING: f64 = 2e-6;
