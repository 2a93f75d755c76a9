//! Exports a scene as glTF 2.0: meshes with their placements, cameras and lights.
//!
//! Positions stay in the object's space, bit for bit. Names survive: each object becomes a node,
//! each object and group of its file a node below it, and materials keep their names. Features that
//! glTF lacks are approximated, with a note to the user:
//!
//! * display colours become linear ones: `c = ((s + 0.055) / 1.055)^2.4`;
//! * Phong's exponent n becomes roughness r = (2 / (4 n + 2))^(1/4): Blinn's exponent is about 4 n,
//!   and a microfacet distribution has 2 / alpha^2 - 2 with alpha = r^2 (Walter et al., "Microfacet
//!   Models for Refraction through Rough Surfaces", EGSR 2007);
//! * bulbs and spots fade with the square of the distance in glTF: each gets the intensity that
//!   lights the middle of the scene as before; ambient lights are left out.

use gltf_json::scene::Node;
use gltf_json::validation::USize64;
use gltf_json::{Index, Root};

use super::gltf_buffer::Buffer;
use super::look::{Detail, Looks};
use super::names::Names;
use super::{Content, ExportOptions, Format};
use crate::mark::escaped;
use marraztu_core::scene::{Scene, View};

pub(super) struct Writer<'a> {
    pub(super) scene: &'a Scene,
    pub(super) view: &'a View,
    pub(super) root: Root,
    pub(super) buffer: Buffer,
    pub(super) looks: Looks,
    names: Names,
    nodes: Vec<Index<Node>>,
    pub(super) notes: Vec<String>,
}

/// Writes the files.
pub(super) fn written(
    stem: &str,
    scene: &Scene,
    view: &View,
    (format, options): (Format, ExportOptions),
) -> Result<Content, String> {
    let mut writer = Writer {
        scene,
        view,
        root: Root::default(),
        buffer: Buffer { bytes: Vec::new() },
        looks: Looks::new(Detail::Gltf),
        names: Names::default(),
        nodes: Vec::new(),
        notes: Vec::new(),
    };
    writer.root.asset.generator = Some("Marraztu".to_owned());
    // Objects come first: their looks determine the materials.
    for (_, object) in scene.objects.iter().filter(|(_, object)| object.visible) {
        writer.object(object);
    }
    writer.materials()?;
    if options.cameras {
        scene.cameras.iter().for_each(|(_, camera)| writer.camera(camera));
    }
    if options.lights {
        writer.lights();
    }
    let Writer { mut root, buffer, nodes, notes, .. } = writer;
    let all = gltf_json::Scene {
        extensions: None,
        extras: Default::default(),
        name: Some(stem.to_owned()),
        nodes,
    };
    root.scene = Some(root.push(all));
    // A buffer without bytes is invalid, so a scene without faces gets no buffer.
    if !buffer.bytes.is_empty() {
        let uri = (format == Format::Gltf).then(|| format!("{}.bin", escaped(stem)));
        root.buffers.push(gltf_json::Buffer {
            byte_length: USize64::from(buffer.bytes.len()),
            name: None,
            uri,
            extensions: None,
            extras: Default::default(),
        });
    }
    // The text comes last in the list: the main file is written last.
    let text = root.to_vec().map_err(|error| error.to_string())?;
    let files = match format {
        Format::Glb => vec![(format!("{stem}.glb"), binary(text, buffer.bytes)?)],
        _ => {
            let bytes = Some((format!("{stem}.bin"), buffer.bytes));
            let bytes = bytes.filter(|(_, bytes)| !bytes.is_empty());
            bytes.into_iter().chain([(format!("{stem}.gltf"), text)]).collect()
        }
    };
    Ok(Content { files, notes })
}

/// Builds a .glb file: a header of 12 bytes, then the text and the buffer as chunks.
fn binary(mut text: Vec<u8>, mut buffer: Vec<u8>) -> Result<Vec<u8>, String> {
    text.resize(text.len().next_multiple_of(4), b' ');
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let length = |bytes: usize| u32::try_from(bytes).map_err(|_large| "it is too large".to_owned());
    let more = if buffer.is_empty() { 0 } else { 8 + buffer.len() };
    let whole = length(12 + 8 + text.len() + more)?;
    // The header: magic, version 2 and the total length, all little-endian.
    let mut file = Vec::with_capacity(12 + 16 + text.len() + buffer.len());
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend(whole.to_le_bytes());
    let chunks = [(b"JSON", text), (b"BIN\0", buffer)];
    for (kind, bytes) in chunks.into_iter().filter(|(_, bytes)| !bytes.is_empty()) {
        file.extend(length(bytes.len())?.to_le_bytes());
        file.extend(kind);
        file.extend(bytes);
    }
    Ok(file)
}

impl Writer<'_> {
    /// Makes a node with a unique name, since some readers reject duplicates. An empty name is left
    /// out.
    pub(super) fn named(&mut self, name: &str) -> Node {
        let name = (!name.is_empty()).then(|| self.names.take(name));
        Node { name, ..Node::default() }
    }

    /// Adds a node to the scene.
    pub(super) fn node(&mut self, node: Node) {
        let node = self.root.push(node);
        self.nodes.push(node);
    }

    pub(super) fn uses(&mut self, extension: &str) {
        let used = &mut self.root.extensions_used;
        if !used.iter().any(|other| other == extension) {
            used.push(extension.to_owned());
        }
    }
}
