//! Framing: the camera position from which objects fill the picture.
//!
//! ```text
//! distance = r / sin(a)                                 r the bounding radius, a the half-angle
//! near     = min(1, (distance - r) / 2, distance / 1000)
//! far      = max(2000, distance + 2 r)
//! orthographic: half-size = 1.1 r
//! ```
//!
//! The camera keeps its direction. In analysis it keeps looking at the mean of the object's
//! vertices, so the framed sphere is centred there.

use glam::{DMat3, DVec3};

use super::{Change, GesturePhase, Refusal, set_transform};
use crate::base::math;
use crate::scene::{
    Camera, CameraMode, Command, Intrinsics, Item, Lens, Object, ObjectId, Observer, Pose,
    Projection, Scene, Tracked, View,
};

/// The bounding sphere to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre.
    pub centre: DVec3,
    /// The radius: at least 0.
    pub radius: f64,
}

/// A view of the scene along an axis of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// From +Z, along -Z.
    Front,
    /// From +X, along -X.
    Right,
    /// From +Y, along -Y, with -Z up.
    Top,
    /// From -Z, along +Z.
    Back,
    /// From -X, along +X.
    Left,
    /// From -Y, along +Y, with +Z up.
    Bottom,
}

impl Side {
    /// Returns the axes of a camera that looks from this side.
    pub const fn axes(self) -> DMat3 {
        match self {
            Self::Front => DMat3::IDENTITY,
            Self::Right => DMat3::from_cols(DVec3::NEG_Z, DVec3::Y, DVec3::X),
            Self::Top => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
            Self::Back => DMat3::from_cols(DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z),
            Self::Left => DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::NEG_X),
            Self::Bottom => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
        }
    }
}

/// The default direction for viewing models, in degrees: to the right of the front, and up.
pub const MODELS_FROM: [f64; 2] = [30.0, 20.0];

/// The margin around models in the picture, as a fraction of the distance.
const MARGIN: f64 = 1.0 / 20.0;

/// Frames the selected object (key `.`).
///
/// # Errors
/// If no object is selected, or it has no vertices.
pub fn selection(scene: &Scene, view: &View) -> Change {
    let (id, _) = set_transform::selected_object(scene, view)?;
    objects(scene, view, &[id])
}

/// Frames everything visible (key Home). A ground is framed only if nothing else is visible.
///
/// # Errors
/// If nothing is visible.
pub fn all(scene: &Scene, view: &View) -> Change {
    let all = shown(scene, view);
    let is_ground = |id: &ObjectId| scene.objects.get(*id).is_some_and(Object::is_ground);
    let others: Vec<_> = all.iter().copied().filter(|id| !is_ground(id)).collect();
    objects(scene, view, if others.is_empty() { &all } else { &others })
}

/// Returns the objects that the view shows.
pub(super) fn shown(scene: &Scene, view: &View) -> Vec<ObjectId> {
    let shown = scene.objects.iter().filter(|(id, object)| view.shows(*id, object));
    shown.map(|(id, _)| id).collect()
}

/// Frames these objects.
///
/// # Errors
/// If no object has vertices.
pub fn objects(scene: &Scene, view: &View, ids: &[ObjectId]) -> Change {
    framed(scene, view, ids, scene.selected_camera(view).pose.now().axes, 0.0)
}

/// Frames everything visible with a margin, from `right` degrees to the right of the front and `up`
/// degrees above it. This is the view of models that come without a scene.
///
/// # Errors
/// If nothing is visible.
pub fn models(scene: &Scene, view: &View, [right, up]: [f64; 2]) -> Change {
    let axes =
        math::rotation(DVec3::Y, right.to_radians()) * math::rotation(DVec3::X, -up.to_radians());
    framed(scene, view, &shown(scene, view), axes, MARGIN)
}

/// Places the selected camera, with the intrinsics of its lens in a projection if given. The planes
/// of the lens enclose everything visible, as closely as the depth buffer needs.
#[must_use]
pub fn from_pose(
    scene: &Scene,
    view: &View,
    pose: Pose,
    intrinsics: Option<(Projection, Intrinsics)>,
) -> Command {
    let camera = scene.selected_camera(view);
    let mut lens = camera.lens;
    if let Some(Sphere { centre, radius }) = sphere(scene, view, &shown(scene, view)) {
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let distance = pose.eye.distance(centre);
        // The near plane cuts by the depth along the axis.
        let depth = (pose.eye - centre).dot(pose.axes.z_axis);
        let near = ((depth - radius) / 2.0).max(radius / 1000.0).min(1.0);
        let far = 2000.0_f64.max(distance + 2.0 * radius);
        let parallel_near = lens.parallel_near.min(near);
        let half_size = 1.1 * radius;
        lens = Lens { near, far, half_size, parallel_near, parallel_far: far, ..lens };
    }
    if let Some((projection, intrinsics)) = intrinsics {
        lens = lens.with_intrinsics(projection, &intrinsics);
    }
    let camera = Camera { pose: Tracked::new(pose), lens, ..camera.clone() };
    Command::Replace(Item::Camera(view.camera, Box::new(camera)))
}

/// Returns the distance at which [`models`] shows a sphere of radius `r`.
pub fn models_distance(first: &Lens, r: f64) -> f64 {
    lens(first, r * (1.0 + MARGIN)).0
}

/// Frames the selected object from a side (Ctrl+1, 3 and 7).
///
/// # Errors
/// If no object is selected, or it has no vertices.
pub fn side(scene: &Scene, view: &View, side: Side) -> Change {
    let (id, _) = set_transform::selected_object(scene, view)?;
    framed(scene, view, &[id], side.axes(), 0.0)
}

/// Returns the bounding sphere of objects. For several objects, it encloses their spheres and is
/// centred in the box around these. `None` if no object has vertices.
pub fn sphere(scene: &Scene, view: &View, ids: &[ObjectId]) -> Option<Sphere> {
    let spheres: Vec<(DVec3, f64)> = ids
        .iter()
        .filter_map(|id| scene.objects.get(*id)?.bounding_sphere(view.time))
        .filter(|(centre, radius)| centre.is_finite() && radius.is_finite())
        .collect();
    if let [(centre, radius)] = spheres[..] {
        return Some(Sphere { centre, radius });
    }
    let min = spheres.iter().map(|(centre, radius)| *centre - *radius).reduce(DVec3::min)?;
    let max = spheres.iter().map(|(centre, radius)| *centre + *radius).reduce(DVec3::max)?;
    let centre = (min + max) * 0.5;
    let reach = |(other, radius): &(DVec3, f64)| other.distance(centre) + radius;
    Some(Sphere { centre, radius: spheres.iter().map(reach).fold(0.0, f64::max) })
}

/// Returns the distance from the centre of a sphere of radius `r`, and the lens for viewing it.
pub fn lens(lens: &Lens, r: f64) -> (f64, Lens) {
    let distance = r / libm::sin(lens.half_angle.to_radians());
    let near = 1.0_f64.min((distance - r) / 2.0).min(distance / 1000.0);
    let far = 2000.0_f64.max(distance + 2.0 * r);
    let framed = Lens {
        near,
        automatic_near: lens.automatic_near,
        far,
        half_size: 1.1 * r,
        parallel_near: lens.parallel_near.min(near),
        parallel_far: far,
        ..*lens
    };
    (distance, framed)
}

/// Frames these objects with these camera axes. The margin is a fraction of the distance.
fn framed(scene: &Scene, view: &View, ids: &[ObjectId], axes: DMat3, margin: f64) -> Change {
    if view.observer == Observer::Object && view.object.is_some() {
        return Err(Refusal::ObjectLooks);
    }
    let camera = scene.selected_camera(view);
    let mode = camera.pose.now().mode_with(view.object);
    // A camera in analysis of the framed object keeps orbiting it; any other camera flies.
    let analysed = match (mode, ids) {
        (CameraMode::Analysis { target }, [id]) if target == *id => scene.objects.get(*id),
        (CameraMode::Analysis { .. } | CameraMode::Fly, _) => None,
    };
    let (sphere, mode) = match analysed {
        Some(object) => (Some(about_the_mean(object, view.time)), mode),
        None => (sphere(scene, view, ids), CameraMode::Fly),
    };
    let Sphere { centre, radius } = sphere.ok_or(Refusal::NothingToFrame)?;
    // A single point is framed like a sphere of radius 1.
    let radius = if radius > 0.0 { radius } else { 1.0 };
    let (distance, lens) = lens(&camera.lens, radius * (1.0 + margin));
    // In orthographic projection, 1.1 r already includes a margin.
    let lens = Lens { half_size: 1.1 * radius, ..lens };
    let pose = Pose { eye: centre + axes.z_axis * distance, axes, mode };
    set_transform::pose_and_lens(scene, view.camera, pose, lens, GesturePhase::First)
}

/// Returns the sphere about the mean of an object's vertices, through the farthest vertex.
fn about_the_mean(object: &Object, time: f64) -> Sphere {
    let centre = object.centre(time);
    let squares = object.placed_vertices(time).map(|p| p.distance_squared(centre));
    Sphere { centre, radius: squares.fold(0.0, f64::max).sqrt() }
}
