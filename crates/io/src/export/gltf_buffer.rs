//! The buffer of a glTF file, the accessors that refer to it, and the conversion of numbers.

use std::collections::HashMap;

use glam::{DMat4, DVec3};
use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Index, Root, Value};

/// The bytes of the buffer: vertex attributes, indices and pictures.
pub(super) struct Buffer {
    pub(super) bytes: Vec<u8>,
}

impl Buffer {
    /// Appends bytes, aligned to 4, as a view of the buffer.
    pub(super) fn view(
        &mut self,
        root: &mut Root,
        bytes: impl IntoIterator<Item = u8>,
        target: Option<Target>,
    ) -> Index<View> {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - start;
        // glTF requires accessors to be aligned to their component size, at most 4 bytes.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(length),
            byte_offset: Some(USize64::from(start)),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
            extensions: None,
            extras: Default::default(),
        })
    }

    /// Appends `N` floats for each vertex.
    pub(super) fn floats<const N: usize>(
        &mut self,
        root: &mut Root,
        all: &[[f32; N]],
    ) -> Index<Accessor> {
        let bytes = all.iter().flatten().flat_map(|x| x.to_le_bytes());
        let view = self.view(root, bytes, Some(Target::ArrayBuffer));
        let kind = match N {
            2 => Type::Vec2,
            3 => Type::Vec3,
            _ => Type::Vec4,
        };
        root.push(accessor(view, all.len(), ComponentType::F32, kind))
    }

    /// Appends positions, with their least and greatest values, which glTF requires.
    pub(super) fn positions(&mut self, root: &mut Root, all: &[[f32; 3]]) -> Index<Accessor> {
        let index = self.floats(root, all);
        let [min, max] = [f32::min, f32::max].map(|of| {
            let limit = all.iter().copied().reduce(|a, b| std::array::from_fn(|i| of(a[i], b[i])));
            limit.map(|limit| Value::from(limit.to_vec()))
        });
        if let Some(accessor) = root.accessors.last_mut() {
            (accessor.min, accessor.max) = (min, max);
        }
        index
    }

    /// Appends indices.
    pub(super) fn indices(&mut self, root: &mut Root, all: &[u32]) -> Index<Accessor> {
        let bytes = all.iter().flat_map(|i| i.to_le_bytes());
        let view = self.view(root, bytes, Some(Target::ElementArrayBuffer));
        root.push(accessor(view, all.len(), ComponentType::U32, Type::Scalar))
    }
}

fn accessor(view: Index<View>, count: usize, component: ComponentType, kind: Type) -> Accessor {
    Accessor {
        buffer_view: Some(view),
        byte_offset: Some(USize64(0)),
        count: USize64::from(count),
        component_type: Checked::Valid(GenericComponentType(component)),
        extensions: None,
        extras: Default::default(),
        type_: Checked::Valid(kind),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    }
}

/// A glTF vertex: one index for all attributes of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Vertex {
    /// The point, which has the position and the normal.
    pub(super) point: u32,
    /// The texture coordinates, or [`marraztu_core::scene::NONE`].
    pub(super) uv: u32,
    /// The bits of the tangent, all 0 if the look has no normal map.
    pub(super) tangent: [u32; 4],
}

/// The distinct vertices of a primitive.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    numbers: HashMap<Vertex, u32>,
    pub(super) all: Vec<Vertex>,
}

impl Vertices {
    /// Returns the index of a vertex, adding it if it is new.
    pub(super) fn number(&mut self, vertex: Vertex) -> u32 {
        let next = u32::try_from(self.all.len()).unwrap_or(u32::MAX);
        let number = *self.numbers.entry(vertex).or_insert(next);
        if number == next {
            self.all.push(vertex);
        }
        number
    }
}

pub(super) fn columns(world: &DMat4) -> [f32; 16] {
    world.to_cols_array().map(single)
}

/// Returns whether all entries of a placement are finite as f32.
pub(super) fn is_single(world: &DMat4) -> bool {
    world.to_cols_array().into_iter().all(|x| x.abs() <= f64::from(f32::MAX))
}

/// Rounds a number to f32, the precision of glTF. Infinite values become the largest finite ones,
/// NaN becomes 0.
#[expect(clippy::cast_possible_truncation, reason = "numbers of glTF are single")]
pub(super) const fn single(x: f64) -> f32 {
    if x.is_nan() { 0.0 } else { (x as f32).clamp(f32::MIN, f32::MAX) }
}

pub(super) fn single3(at: DVec3) -> [f32; 3] {
    at.to_array().map(single)
}
