//! Exports lines and points as primitives of glTF. They have no normals, so readers do not light
//! them.

use std::collections::{BTreeMap, HashMap};

use glam::DMat4;
use gltf_json::Index;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;

use super::gltf::Writer;
use super::gltf_mesh::placed;
use super::gltf_surface::linear;
use super::look::has_colors;
use marraztu_core::scene::{Object, Stroke};

impl Writer<'_> {
    /// Writes lines, or points, that share a look: a polyline as a strip.
    pub(super) fn stroke_primitive(
        &mut self,
        object: &Object,
        baked: &DMat4,
        look: usize,
        strokes: &[&Stroke],
    ) -> Primitive {
        let mesh = &object.model.mesh;
        let is_strip = strokes.len() > 1 && strokes.windows(2).all(|two| two[0].leads_to(two[1]));
        let (mode, ends): (_, Vec<u32>) = match strokes {
            [first, ..] if first.is_point() => {
                (Mode::Points, strokes.iter().map(|stroke| stroke.ends[0]).collect())
            }
            [first, ..] if is_strip => {
                let others = strokes.iter().map(|stroke| stroke.ends[1]);
                (Mode::LineStrip, [first.ends[0]].into_iter().chain(others).collect())
            }
            _ => (Mode::Lines, strokes.iter().flat_map(|stroke| stroke.ends).collect()),
        };
        // A vertex of several strokes is written once.
        let (mut numbers, mut vertices) = (HashMap::new(), Vec::new());
        let mut number = |vertex: u32| {
            *numbers.entry(vertex).or_insert_with(|| {
                vertices.push(vertex);
                u32::try_from(vertices.len() - 1).unwrap_or(u32::MAX)
            })
        };
        let indices: Vec<u32> = ends.into_iter().map(&mut number).collect();
        let (root, buffer) = (&mut self.root, &mut self.buffer);
        let mut attributes = BTreeMap::new();
        let mut put = |semantic, accessor| attributes.insert(Checked::Valid(semantic), accessor);
        let positions: Vec<_> = vertices.iter().map(|own| placed(baked, mesh, *own)).collect();
        put(Semantic::Positions, buffer.positions(root, &positions));
        if self.looks.all[look].colored && has_colors(object) {
            let color = |own: &u32| mesh.colors()[*own as usize].map(|s| linear(f64::from(s)));
            let colors: Vec<_> = vertices.iter().map(color).collect();
            put(Semantic::Colors(0), buffer.floats(root, &colors));
        }
        let indices = buffer.indices(root, &indices);
        Primitive {
            attributes,
            extensions: None,
            extras: Default::default(),
            indices: Some(indices),
            material: u32::try_from(look).ok().map(Index::new),
            mode: Checked::Valid(mode),
            targets: None,
        }
    }
}
