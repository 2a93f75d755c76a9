//! What tells one model of a scene file from another.

use super::format::FileModel;
use marraztu_core::scene::{BumpMaps, UpAxis, Winding};

/// The identity of a model in a scene file: its name or path, the size of a shape, and the load
/// options of a file. The crease angle comes last, so files that differ only in it are neighbours.
pub(super) type ModelKey = (String, Option<u64>, Option<(UpAxis, u64, Winding, BumpMaps, u64)>);

pub(super) fn key(model: &FileModel) -> ModelKey {
    match model {
        FileModel::Own(name) => (name.clone(), None, None),
        FileModel::Shape { name, size } => (name.clone(), Some(size.to_bits()), None),
        FileModel::File { path, up, scale, winding, crease, bumps } => {
            let options = (*up, scale.to_bits(), *winding, *bumps, crease.to_bits());
            (path.clone(), None, Some(options))
        }
    }
}
