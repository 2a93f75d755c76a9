//! The sizes of placeholder boxes for missing models.
//!
//! A box is a fraction of the median of the other objects' largest extents in world space: a full
//! cube of that width would look larger than the objects. Without other objects, it fills a
//! fraction of the height that the camera sees at its distance.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3};

use super::format::{FileModel, FileObject, FileScene};
use super::model_key::{ModelKey, key};
use marraztu_core::scene::{Model, Shape};

/// The side of a box as a fraction of the median extent.
const PART_OF_USUAL: f64 = 0.6;

/// The side of a box as a fraction of half the visible height, without other objects.
const PART_SEEN: f64 = 0.5;

/// The reference sizes for boxes.
pub(super) struct BoxSizes<'a> {
    file: &'a FileScene,
    /// The first object of each model: thousands of models may be missing.
    first: BTreeMap<ModelKey, &'a FileObject>,
    /// The side derived from the other objects.
    usual: Option<f64>,
}

impl<'a> BoxSizes<'a> {
    /// Measures the objects of this scene; `known` returns the models that exist.
    pub(super) fn new<'m>(
        file: &'a FileScene,
        known: impl Fn(&FileModel) -> Option<&'m Model>,
    ) -> Self {
        let extent = |object: &FileObject| {
            let bounds = known(&object.model)?.mesh.bounds()?;
            let sides = column_lengths(object) * bounds.extent();
            Some(sides.max_element()).filter(|extent| extent.is_finite() && *extent > 0.0)
        };
        let objects = file.objects.iter().filter(|object| !is_ground(&object.model));
        let mut extents: Vec<f64> = objects.filter_map(extent).collect();
        extents.sort_by(f64::total_cmp);
        let usual = extents.get(extents.len() / 2);
        // Of equal keys the last one is kept.
        let first = file.objects.iter().rev().map(|object| (key(&object.model), object)).collect();
        Self { file, first, usual: usual.map(|extent| extent * PART_OF_USUAL) }
    }

    /// Returns the side of the box for a missing model, in object space. If several objects use the
    /// model, the first decides. Camera models are always drawn in one size.
    pub(super) fn side(&self, model: &FileModel) -> f64 {
        let Some(object) = self.first.get(&key(model)).copied() else { return 1.0 };
        let scale = column_lengths(object).max_element();
        let side = self.usual.or_else(|| self.seen_at(object)).unwrap_or(1.0) / scale;
        if side.is_finite() && side > 0.0 { side } else { 1.0 }
    }

    /// Returns a size that is easy to see from the camera at an object's position.
    fn seen_at(&self, object: &FileObject) -> Option<f64> {
        let cameras = &self.file.cameras;
        let selected = cameras.iter().find(|camera| camera.id == self.file.view.camera);
        let camera = selected.or(cameras.first())?;
        let place = placement(object).w_axis.truncate();
        let distance = DVec3::from_array(camera.eye).distance(place);
        let size = PART_SEEN * distance * libm::tan(camera.lens.half_angle.to_radians());
        Some(size).filter(|size| size.is_finite() && *size > 0.0)
    }
}

fn is_ground(model: &FileModel) -> bool {
    match model {
        FileModel::Own(name) | FileModel::Shape { name, .. } => {
            Shape::named(name).is_some_and(Shape::is_ground)
        }
        FileModel::File { .. } => false,
    }
}

fn placement(object: &FileObject) -> DMat4 {
    DMat4::from_cols_array_2d(&object.placement)
}

/// Returns the lengths of an object's axes in world space.
fn column_lengths(object: &FileObject) -> DVec3 {
    let m = placement(object);
    DVec3::new(
        m.x_axis.truncate().length(),
        m.y_axis.truncate().length(),
        m.z_axis.truncate().length(),
    )
}
