//! Helpers: models that represent cameras and bulbs, which have no mesh in the scene.

use std::sync::OnceLock;

use glam::{DMat3, DMat4, DVec3};

use super::observer::{CAMERA_MARK, ObserverSpace};
use marraztu_core::base::once::get_or_compute;
use marraztu_core::base::{Shared, color::Color, math};
use marraztu_core::scene::{Camera, Mesh, MeshSource, Model, SourceCorner};

/// The colour of a bulb's diamond.
pub(super) const YELLOW: Color = Color([255, 255, 0]);

/// Half of a diamond's diagonal in world units.
const DIAMOND: f64 = 1.0;

/// The smallest length of a diamond's diagonal in pixels.
const DIAMOND_PIXELS: f64 = 9.0;

/// Places a camera model at the camera's eye, in its frame.
pub(super) fn world_from_mark(camera: &Camera) -> DMat4 {
    let extent = camera.model.mesh.bounds().map_or(0.0, |bounds| bounds.extent().max_element());
    let scale = if extent > 0.0 { CAMERA_MARK / extent } else { 1.0 };
    camera.pose.now().world_from_camera() * DMat4::from_scale(DVec3::splat(scale))
}

/// Places the diamond of a bulb: it faces the observer and is never smaller than nine pixels.
/// `None` if the bulb is not in front of the observer.
pub(super) fn world_from_diamond(observer: &ObserverSpace, bulb: DVec3) -> Option<DMat4> {
    let place = observer.view_from_world.transform_point3(bulb);
    let w = (observer.clip_from_view * place.extend(1.0)).w;
    if w <= 0.0 {
        return None;
    }
    // The size of a world unit at that distance, in pixels.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 rows")]
    let pixels =
        observer.clip_from_view.y_axis.y * observer.unit / w * observer.size.height as f64 / 2.0;
    let half = DIAMOND.max(DIAMOND_PIXELS / 2.0 / pixels);
    // The axes of view space turn the diamond towards the observer.
    let axes = DMat3::from_mat4(observer.world_from_view);
    Some(math::placed(axes * half, bulb))
}

/// Returns a square on its corner, from -1 to 1, facing +Z.
pub(super) fn diamond() -> &'static Shared<Model> {
    static DIAMOND: OnceLock<Shared<Model>> = OnceLock::new();
    get_or_compute(&DIAMOND, || {
        let mesh = Mesh::new(MeshSource {
            positions: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
            ..MeshSource::of_polygons([0, 1, 2, 3].map(SourceCorner::bare), vec![4])
        });
        Shared::new(Model::of_mesh("diamond", mesh.expect("a square is a mesh")))
    })
}
