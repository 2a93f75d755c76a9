//! The observer's spaces, and view frustum culling.

use glam::{DMat3, DMat4, DVec3, DVec4};

use super::stroke_width;
use crate::frame::Viewport;
use crate::lights::region::Region;
use crate::screen::clip::Screen;
use crate::screen::coverage::SUBPIXELS;
use marraztu_core::accuracy::{Resolution, Shot};
use marraztu_core::base::image::Size;
use marraztu_core::base::math;
use marraztu_core::scene::{CameraId, Lens, Observer, Projection, Spheres};

/// The size of a camera model: its longest side, in world units.
pub(super) const CAMERA_MARK: f64 = 24.0;

/// The distance of the far plane in units of view space: at least this, and less than twice this.
const FAR: f64 = 1024.0;

/// Returns the unit of view space for a lens, clamped to keep its square within f64.
fn unit(lens: &Lens, projection: Projection) -> f64 {
    let far = match projection {
        Projection::Perspective => lens.far,
        Projection::Orthographic => {
            lens.parallel_near.abs().max(lens.parallel_far.abs()).max(lens.half_size)
        }
    };
    FAR / math::power_of_two_near(far.clamp(1e-120, 1e120))
}

/// The largest distance of the planes of an orthographic lens, relative to that of the farthest
/// thing that is drawn, up to a power of two.
const SLACK: f64 = 16.0;

/// Returns the lens of the camera. In orthographic projection, its planes are brought close to the
/// things that are drawn.
///
/// Orthographic depth is linear: between planes for large scenes, a small model would share a few
/// depths. In perspective, the reversed depth does not depend on the far plane.
fn drawn_lens(shot: &Shot, world_from_view: DMat4) -> Lens {
    let Shot { scene, view, .. } = shot;
    let lens = scene.selected_camera(view).lens;
    if view.projection == Projection::Perspective {
        return lens;
    }
    let [towards, eye] = [world_from_view.z_axis, world_from_view.w_axis].map(DVec4::truncate);
    // The depth of a point, and its change along a vector.
    let depth = |p: DVec3| (p - eye).dot(towards).abs();
    let along = |v: DVec4| v.truncate().dot(towards).abs();
    let objects = scene.objects.iter().filter(|(id, object)| view.shows(*id, object));
    let objects = objects.filter_map(|(_, object)| {
        let bounds = object.model.mesh.bounds()?;
        let m = object.world_from_mesh(view.time);
        let half = bounds.extent() * 0.5;
        let own = along(m.x_axis) * half.x + along(m.y_axis) * half.y + along(m.z_axis) * half.z;
        Some(depth(m.transform_point3(bounds.centre())) + own)
    });
    // Bulbs are flat marks that face the observer.
    let lights = scene.lights.iter().filter(|(_, light)| light.on);
    let bulbs = lights.filter_map(|(_, light)| scene.light_origin(view, &light.kind)?.position);
    // The camera that looks has no mark.
    let looks = |id: CameraId| view.observer == Observer::Camera && id == view.camera;
    let others = scene.cameras.iter().filter(|(id, _)| !looks(*id));
    let cameras = others.map(|(_, camera)| depth(camera.pose.now().eye) + CAMERA_MARK);
    let marks = bulbs.map(depth).chain(cameras).filter(|_| view.marks);
    let farthest = objects.chain(marks).filter(|depth| depth.is_finite()).fold(0.0, f64::max);
    if farthest == 0.0 {
        return lens;
    }
    // A power of two rarely changes while things move.
    let most = 2.0 * SLACK * math::power_of_two_near(farthest);
    let Lens { parallel_near: near, parallel_far: far, .. } = lens;
    let [parallel_near, parallel_far] = [near.max(-most), far.min(most)];
    // Planes that exclude everything stay.
    if parallel_near < parallel_far { Lens { parallel_near, parallel_far, ..lens } } else { lens }
}

/// Returns the size of the picture that is drawn, before it is enlarged.
fn drawn_viewport(size: Size, resolution: Resolution) -> Viewport {
    let Viewport { width, height } = size.into();
    match resolution {
        Resolution::Full => Viewport { width, height },
        Resolution::Half => Viewport { width: width / 2.0, height: height / 2.0 },
    }
}

/// The observer's spaces.
///
/// View space has a separate unit, a power of two, with the far plane about a thousand units away.
/// Lighting in f32 therefore works equally well for scenes of atoms and of stars. For scenes of
/// ordinary size the unit equals the world's.
#[derive(Debug)]
pub(crate) struct ObserverSpace {
    /// The number of view space units per world unit.
    pub(crate) unit: f64,
    pub(crate) world_from_view: DMat4,
    pub(crate) view_from_world: DMat4,
    pub(crate) clip_from_view: DMat4,
    /// The size of the finished picture, for marks with a size in pixels.
    pub(crate) size: Size,
    /// The size of the drawn picture.
    pub(crate) viewport: Viewport,
    /// The distance in pixels at which a line may be drawn from its position.
    line_reach: f64,
}

impl ObserverSpace {
    pub(super) fn new(shot: &Shot) -> Self {
        let Shot { scene, view, size, .. } = shot;
        let size = *size;
        let world_from_view = scene.observer_frame(view);
        // The axes are orthonormal, so the inverse of the rotation is its transpose.
        let turn = DMat3::from_mat4(world_from_view).transpose();
        let eye = world_from_view.w_axis.truncate();
        let lens = drawn_lens(shot, world_from_view);
        let unit = unit(&lens, view.projection);
        let turned = math::placed(turn, DVec3::ZERO) * DMat4::from_translation(-eye);
        // Lengths are converted to units of view space; the angle stays.
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
            viewport: drawn_viewport(size, shot.settings.resolution),
            line_reach: LINE
                .max(f64::from(stroke_width(view, shot.settings.resolution) / SUBPIXELS)),
        }
    }

    /// Returns whether a box is completely outside one of the frustum's planes, far enough that no
    /// line along its border reaches in.
    pub(super) fn misses(&self, clip_from_object: DMat4, corners: [DVec3; 8]) -> bool {
        let clip = corners.map(|corner| clip_from_object * corner.extend(1.0));
        // The sides move outwards, because lines are drawn around their positions.
        let aside = |pixels: f64| 1.0 + 2.0 * self.line_reach / pixels;
        let (x, y) = (aside(self.viewport.width), aside(self.viewport.height));
        // A margin for rounding: nothing may be culled that geometry would keep.
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

    /// Returns the frustum's planes for spheres in the world, moved outwards as in
    /// [`Self::misses`].
    pub(super) fn spheres_outside(&self) -> SpherePlanes {
        let rows = (self.clip_from_view * self.view_from_world).transpose();
        let [x, y, z, w] = [rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis];
        let aside = |pixels: f64| 1.0 + 2.0 * self.line_reach / pixels;
        let (wx, wy) = (w * aside(self.viewport.width), w * aside(self.viewport.height));
        let sizes = [x, y, z, w].map(|row| row.abs());
        // The rounding error of a plane's distance is relative to these sums.
        let sum = sizes.into_iter().sum::<DVec4>();
        SpherePlanes {
            planes: [wx + x, wx - x, wy + y, wy - y, z, w - z]
                .map(|plane| (plane, plane.truncate().length())),
            per_distance: MARGIN * sum.truncate().max_element(),
            fixed: MARGIN * sum.w,
        }
    }

    /// Returns whether a box is far enough inside the clipping planes that nothing in it is
    /// clipped.
    pub(super) fn holds(&self, clip_from_object: DMat4, corners: [DVec3; 8]) -> bool {
        let screen = Screen::new(clip_from_object, self.viewport);
        corners.iter().all(|corner| screen.holds(screen.clip(corner.to_array())))
    }

    /// Returns the region of positions at which a box's content is lit per pixel, provided that
    /// nothing of it is clipped.
    ///
    /// A pixel's position is the point of its ray at the depth of the snapped triangle: a fraction
    /// of a pixel aside from the true position. In perspective, its w has the error of 1/w at the
    /// triangle's nearest corner.
    pub(super) fn seen_region(&self, view_from_object: DMat4, corners: [DVec3; 8]) -> Region {
        let placed = Region::placed(view_from_object, corners, 0.0);
        let w =
            corners.map(|corner| (self.clip_from_view * view_from_object * corner.extend(1.0)).w);
        let (nearest, farthest) =
            w.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), w| (low.min(*w), high.max(*w)));
        // Pixels are widest at the farthest corner; errors of depth grow with the range of w.
        let beside = SNAPPED * self.pixel() * farthest;
        let deeper = ROUNDING * placed.reach() * (1.0 + farthest / nearest);
        Region::placed(view_from_object, corners, beside + deeper)
    }

    /// Returns the size of a pixel in view space at w = 1.
    fn pixel(&self) -> f64 {
        let Viewport { width, height } = self.viewport;
        let across = 2.0 / (width * self.clip_from_view.x_axis.x);
        across.max(2.0 / (height * self.clip_from_view.y_axis.y))
    }
}

/// The planes of a view frustum in the world, positive inside.
#[derive(Debug)]
pub(super) struct SpherePlanes {
    /// The planes, each with the length of its normal.
    planes: [(DVec4, f64); 6],
    /// The margin for rounding, per unit of distance from the origin,
    per_distance: f64,
    /// plus this constant margin.
    fixed: f64,
}

impl SpherePlanes {
    /// Returns whether sphere `i` is completely outside one of the planes.
    pub(super) fn misses(&self, spheres: &Spheres, i: usize) -> bool {
        let [x, y, z] = math::each([0, 1, 2], |axis| spheres.centres[axis][i]);
        let radius = spheres.radii[i];
        let far = x.abs() + y.abs() + z.abs() + radius;
        let margin = far * self.per_distance + self.fixed;
        let centre = DVec4::new(x, y, z, 1.0);
        self.planes.iter().any(|(plane, length)| plane.dot(centre) + length * radius < -margin)
    }
}

/// The margin of spheres: larger than that of [`ObserverSpace::misses`], so both tests agree.
const MARGIN: f64 = 1e-8;

/// The distance in pixels at which an edge may be drawn from its position: half of its width, and
/// half a pixel of rounding. Strokes of models may be wider.
const LINE: f64 = 2.0;

/// Twice the largest distance, in pixels, that snapping moves a position.
const SNAPPED: f64 = 0.006;

/// The error of interpolation in f32, relative to the largest value.
const ROUNDING: f64 = 2e-6;
