//! A camera, its pose and its lens. It looks along -Z of its frame.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};
use serde::{Deserialize, Serialize};

use super::{MaterialChoice, Model, ObjectId, Projection, Tracked};
use crate::base::image::Size;
use crate::base::{Shared, math};

/// A camera, with the model that marks it for other observers.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name in the outline.
    pub name: String,
    /// Whether its marker is drawn.
    pub visible: bool,
    /// The marker's shape.
    pub model: Shared<Model>,
    /// The marker's material.
    pub material: MaterialChoice,
    /// The position, orientation and mode.
    pub pose: Tracked<Pose>,
    /// The field of view and its planes.
    pub lens: Lens,
}

impl Camera {
    /// Creates a camera at `eye` that looks along -Z, with the default lens.
    pub fn new(name: &str, model: Shared<Model>, material: MaterialChoice, eye: DVec3) -> Self {
        let pose = Tracked::new(Pose::facing_minus_z(eye));
        let lens = Lens::default();
        Self { name: name.to_owned(), visible: true, model, material, pose, lens }
    }
}

/// The position, orientation and mode of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The position in the world.
    pub eye: DVec3,
    /// The axes as columns, orthonormal and right-handed.
    pub axes: DMat3,
    /// The mode of movement.
    pub mode: CameraMode,
}

/// A camera's mode of movement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum CameraMode {
    /// The camera moves in its own frame.
    #[default]
    Fly,
    /// The camera orbits the centre of an object and looks at it (an orbit camera).
    Analysis {
        /// The object.
        target: ObjectId,
    },
}

impl Pose {
    /// Creates a pose at `eye` that looks along -Z.
    pub const fn facing_minus_z(eye: DVec3) -> Self {
        Self { eye, axes: DMat3::IDENTITY, mode: CameraMode::Fly }
    }

    /// Returns the matrix `world_from_camera`.
    pub fn world_from_camera(&self) -> DMat4 {
        math::placed(self.axes, self.eye)
    }

    /// Creates a pose from a matrix `world_from_camera`; `None` unless it is a rotation with a
    /// position. Matrices in files have few digits, so the axes are made orthonormal again.
    pub fn from_matrix(world_from_camera: DMat4) -> Option<Self> {
        /// The largest difference of an entry of R R' from the identity, and of the last row from
        /// 0 0 0 1.
        const MOST: f64 = 1e-3;
        let (axes, eye) = (DMat3::from_mat4(world_from_camera), world_from_camera.w_axis);
        let is_rotation = (axes * axes.transpose()).abs_diff_eq(DMat3::IDENTITY, MOST);
        // A matrix for row vectors has the position in its last row.
        let is_affine = world_from_camera.row(3).abs_diff_eq(DVec4::W, MOST);
        if !is_rotation || !is_affine || axes.determinant() < 0.0 || !eye.is_finite() {
            return None;
        }
        let z = axes.z_axis.normalize_or_zero();
        let x = axes.y_axis.cross(z).normalize_or_zero();
        let axes = DMat3::from_cols(x, z.cross(x), z);
        Some(Self { eye: eye.truncate(), axes, mode: CameraMode::Fly })
    }

    /// Returns the current mode. The camera orbits only while its target is the selected object.
    pub fn mode_with(&self, selected: Option<ObjectId>) -> CameraMode {
        match self.mode {
            CameraMode::Analysis { target } if Some(target) == selected => self.mode,
            CameraMode::Analysis { .. } | CameraMode::Fly => CameraMode::Fly,
        }
    }
}

/// The lens of a camera, in perspective and in orthographic projection.
///
/// Its axis meets the picture at the principal point. With the defaults of `shift` and
/// `pixel_aspect`, that is the centre of the picture, and pixels are square.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Lens {
    /// Degrees to each side of the axis, across the shorter side of a centred picture with square
    /// pixels: above 0, below 90. This defines the vertical focal length.
    pub half_angle: f64,
    /// The near plane in perspective: more than 0.
    pub near: f64,
    /// Whether the window moves the near plane towards the eye where it would cut a surface.
    #[serde(skip_serializing_if = "is_on")]
    pub automatic_near: bool,
    /// The far plane in perspective: more than `near`.
    pub far: f64,
    /// Units to each side of the axis in orthographic projection, across the shorter side: above 0.
    pub half_size: f64,
    /// The near plane in orthographic projection.
    pub parallel_near: f64,
    /// The far plane in orthographic projection: more than `parallel_near`.
    pub parallel_far: f64,
    /// The lens shift: the principal point relative to the centre of the picture, to the right and
    /// down, in lengths of the shorter side.
    #[serde(skip_serializing_if = "is_centred")]
    pub shift: [f64; 2],
    /// The width of a pixel divided by its height, which is `f_y / f_x`: above 0.
    #[serde(skip_serializing_if = "is_square")]
    pub pixel_aspect: f64,
}

fn is_centred(shift: &[f64; 2]) -> bool {
    *shift == [0.0; 2]
}

fn is_square(pixel_aspect: &f64) -> bool {
    *pixel_aspect == 1.0
}

/// The intrinsics of a camera for pictures of one size: the numbers of the matrix K.
///
/// ```text
///     f_x  0   c_x
/// K =  0  f_y  c_y      in pixels; the centre of the first pixel is (0.5, 0.5)
///      0   0    1
/// ```
///
/// Hartley and Zisserman, "Multiple View Geometry in Computer Vision", section 6.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// The focal lengths in perspective, or the pixels per unit in orthographic projection, along x
    /// and y.
    pub focal: DVec2,
    /// The principal point, from the upper left corner, x to the right and y down.
    pub principal_point: DVec2,
    /// The size of the picture.
    pub size: Size,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
const fn is_on(automatic: &bool) -> bool {
    *automatic
}

impl Default for Lens {
    fn default() -> Self {
        Self {
            half_angle: 22.5,
            near: 1.0,
            automatic_near: true,
            far: 2000.0,
            half_size: 500.0,
            parallel_near: 0.0,
            parallel_far: 2000.0,
            shift: [0.0; 2],
            pixel_aspect: 1.0,
        }
    }
}

/// The largest lens shift: a crop of one pixel from a picture of 16,384 pixels fits.
const MOST_SHIFT: f64 = 1e5;

/// The range of the aspect of pixels.
const PIXEL_ASPECTS: std::ops::RangeInclusive<f64> = 1e-3..=1e3;

impl Lens {
    /// Returns whether the lens gives a valid projection.
    pub fn is_valid(&self) -> bool {
        let Self { half_angle, near, far, half_size, parallel_near, parallel_far, .. } = *self;
        let finite = [half_angle, near, far, half_size, parallel_near, parallel_far];
        finite.iter().all(|x| x.is_finite())
            && half_angle > 0.0
            && half_angle < 90.0
            && near > 0.0
            && far > near
            && half_size > 0.0
            && parallel_far > parallel_near
            && self.shift.iter().all(|by| by.abs() <= MOST_SHIFT)
            && PIXEL_ASPECTS.contains(&self.pixel_aspect)
    }

    /// Returns the matrix `clip_from_view` for a picture of this size.
    pub fn clip_from_view(&self, projection: Projection, size: Size) -> DMat4 {
        // The principal point from -1 to 1, to the right and up. Twice the shift is in halves of
        // the shorter side.
        let [right, down] = self.shift.map(|by| 2.0 * by);
        let sides = math::shorter_side(size);
        let (x, y) = (right * sides.x, down * sides.y);
        let mut clip = match projection {
            Projection::Perspective => {
                math::perspective(self.half_angle.to_radians(), self.near, self.far, size)
            }
            Projection::Orthographic => {
                math::orthographic(self.half_size, self.parallel_near, self.parallel_far, size)
            }
        };
        clip.x_axis.x /= self.pixel_aspect;
        // Both are multiplied by w, which is -z in perspective and 1 in orthographic projection.
        // Subtracting from 0 keeps the zeros of a centred lens positive.
        match projection {
            Projection::Perspective => (clip.z_axis.x, clip.z_axis.y) = (0.0 - x, y),
            Projection::Orthographic => (clip.w_axis.x, clip.w_axis.y) = (x, 0.0 - y),
        }
        clip
    }

    /// Returns the principal point of a picture, in pixels from its upper left corner.
    pub fn principal_point(&self, size: Size) -> DVec2 {
        let (sides, shorter) = sides(size);
        sides / 2.0 + DVec2::from_array(self.shift) * shorter
    }

    /// Returns the intrinsics for a picture of this size.
    pub fn intrinsics(&self, projection: Projection, size: Size) -> Intrinsics {
        let per_half = match projection {
            Projection::Perspective => 1.0 / libm::tan(self.half_angle.to_radians()),
            Projection::Orthographic => 1.0 / self.half_size,
        };
        let y = sides(size).1 / 2.0 * per_half;
        let focal = DVec2::new(y / self.pixel_aspect, y);
        Intrinsics { focal, principal_point: self.principal_point(size), size }
    }

    /// Returns this lens with the intrinsics of a calibrated camera. The planes are kept.
    #[must_use]
    pub fn with_intrinsics(self, projection: Projection, intrinsics: &Intrinsics) -> Self {
        let Intrinsics { focal, principal_point, size } = *intrinsics;
        let (sides, shorter) = sides(size);
        let half = shorter / 2.0 / focal.y;
        let shift = ((principal_point - sides / 2.0) / shorter).to_array();
        let lens = Self { shift, pixel_aspect: focal.y / focal.x, ..self };
        match projection {
            Projection::Perspective => Self { half_angle: libm::atan(half).to_degrees(), ..lens },
            Projection::Orthographic => Self { half_size: half, ..lens },
        }
    }
}

/// Returns the sides of a picture in pixels, and the shorter one.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
fn sides(size: Size) -> (DVec2, f64) {
    let sides = DVec2::new(size.width as f64, size.height as f64);
    (sides, sides.min_element())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::Rng;

    #[test]
    fn points_are_projected_by_k_within_1_256_pixel_for_any_camera() {
        let mut rng = Rng::new(21);
        for i in 0..1000 {
            let side = |rng: &mut Rng| 1 + usize::try_from(rng.below(4096)).unwrap();
            let size = Size::new(side(&mut rng), side(&mut rng));
            let (sides, _) = sides(size);
            let longer = sides.max_element();
            let part = |rng: &mut Rng, low: f64, high: f64| {
                DVec2::new(rng.real(low, high), rng.real(low, high))
            };
            let focal = part(&mut rng, 0.2, 5.0) * longer;
            // The principal point of a crop lies outside.
            let principal_point = part(&mut rng, -1.0, 2.0) * sides;
            let intrinsics = Intrinsics { focal, principal_point, size };
            for projection in [Projection::Perspective, Projection::Orthographic] {
                let lens = Lens::default().with_intrinsics(projection, &intrinsics);
                assert!(lens.is_valid(), "{i}: {lens:?}");
                let back = lens.intrinsics(projection, size);
                assert!(back.focal.distance(focal) < 1e-9 * longer, "{i}: {back:?}");
                assert!(back.principal_point.distance(principal_point) < 1e-9 * longer, "{i}");
                // A point that K sees in the picture, with the axes of OpenCV.
                let pixel = part(&mut rng, 0.0, 1.0) * sides;
                let depth = rng.real(2.0, 1500.0);
                let aside = (pixel - principal_point) / focal;
                let aside = match projection {
                    Projection::Perspective => aside * depth,
                    Projection::Orthographic => aside,
                };
                let view = DVec3::new(aside.x, -aside.y, -depth);
                let clip = lens.clip_from_view(projection, size) * view.extend(1.0);
                let ndc = clip.truncate() / clip.w;
                let found = (DVec2::new(ndc.x, -ndc.y) + 1.0) * sides / 2.0;
                assert!(found.distance(pixel) < 1.0 / 256.0, "{i}: {found} {pixel}");
                assert!((0.0..=1.0).contains(&ndc.z), "{i}: {ndc}");
            }
        }
    }

    #[test]
    fn a_centred_lens_with_square_pixels_has_the_bits_of_the_plain_projection() {
        let lens = Lens { half_angle: 31.7, ..Lens::default() };
        for size in [Size::new(640, 480), Size::new(3, 1000), Size::new(7, 7)] {
            let plain = [
                math::perspective(lens.half_angle.to_radians(), lens.near, lens.far, size),
                math::orthographic(lens.half_size, lens.parallel_near, lens.parallel_far, size),
            ];
            for (projection, plain) in
                [Projection::Perspective, Projection::Orthographic].into_iter().zip(plain)
            {
                let own = lens.clip_from_view(projection, size);
                assert!(math::same_bits(&own, &plain), "{size:?} {projection:?}: {own}");
            }
        }
    }

    #[test]
    fn half_the_size_has_half_the_intrinsics() {
        let focal = DVec2::new(572.4, 573.6);
        let principal_point = DVec2::new(325.3, 242.0);
        let size = Size::new(640, 480);
        let whole = Intrinsics { focal, principal_point, size };
        let lens = Lens::default().with_intrinsics(Projection::Perspective, &whole);
        let half = lens.intrinsics(Projection::Perspective, Size::new(320, 240));
        assert!(half.focal.distance(focal / 2.0) < 1e-9, "{half:?}");
        assert!(half.principal_point.distance(principal_point / 2.0) < 1e-9, "{half:?}");
    }

    #[test]
    fn lenses_without_a_projection_are_invalid() {
        for (shift, pixel_aspect) in [
            ([f64::NAN, 0.0], 1.0),
            ([0.0, f64::INFINITY], 1.0),
            ([0.0, 2e5], 1.0),
            ([0.0; 2], 0.0),
            ([0.0; 2], -1.0),
            ([0.0; 2], f64::NAN),
        ] {
            let lens = Lens { shift, pixel_aspect, ..Lens::default() };
            assert!(!lens.is_valid(), "{lens:?}");
        }
    }
}
