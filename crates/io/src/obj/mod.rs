//! Loads a model from an OBJ file.
//!
//! The text is split into chunks ([`chunks`]), which all threads parse: plain lines on a fast path
//! ([`quick`]), all others on a tolerant path ([`scan`], [`faces`]). tobj parses the numbers of
//! `v`, `vt` and `vn` ([`rows`]), but not the faces: it would parse them on one thread, lose their
//! line numbers, and reject the file for one bad index. The chunks are joined as if they had been
//! parsed in order ([`join`]), usable faces are selected ([`sound`]), and a [`Mesh`] is built from
//! them. Each `v` of the file becomes a vertex of the mesh, used or not.
//!
//! Faults that can be skipped or repaired without guessing become [`Finding`](crate::Finding)s: an
//! unreadable vertex costs only its faces, not the file.
//!
//! The format is that of Wavefront's "Advanced Visualizer", Appendix B1, with the vertex colours
//! that MeshLab and others write.

mod chunks;
mod corners;
mod faces;
mod foreign;
mod join;
pub(super) mod lines;
mod parts;
mod piece;
mod quick;
mod rows;
mod scan;
mod sound;
mod strokes;

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::Read;
use std::iter;
use std::path::Path;

use rayon::prelude::*;

use self::join::Content;
use self::parts::NamedPart;
use self::sound::FaceRuns;
use super::error::{LoadError, short_name, shown};
use super::findings::{FindingKind, Findings, joined};
use super::loaded::{Loaded, place, placement};
use super::locate::of_model;
use super::mtl::Library;
use super::packed::{Unpacked, model_name, unpacked_name};
use super::progress::Progress;
use super::read::{self, MOST_MODEL_BYTES};
use super::texture::{Pictures, texture_endings};
use marraztu_core::scene::{
    Corner, CornerLists, FileMaterial, LoadOptions, Mesh, MeshSource, Model, Part, Smoothing,
    Texture, Winding, dvec3, newell, split_positions,
};

/// The most distinct `mtllib` statements that are followed.
const MOST_LIBRARIES: usize = 1000;

/// Loads an OBJ file with its MTL files and textures. Pictures that are already in `pictures` are
/// reused. Fails if the file cannot be read, is no such file, or has only unusable faces; and if
/// `progress` is cancelled.
pub(super) fn load(
    path: &Path,
    options: &LoadOptions,
    pictures: &mut Pictures,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    let file = shown(path);
    let (text, size) = read::open(path, MOST_MODEL_BYTES)?;
    let mut findings = Findings::new(&file);
    let part = progress.part(0.0, 0.6);
    let content = match unpacked_name(&file) {
        // The unpacked size is unknown; text is typically four times as large.
        Some(_) => content(Unpacked::new(text), 4 * size, &file, &mut findings, &part)?,
        None => content(text, size, &file, &mut findings, &part)?,
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut library = Library::new(pictures, options.bumps);
    let missing = read_libraries(&mut library, &content, folder, &mut findings);
    own_library(&mut library, &content, path, missing, &mut findings);
    model(content, &file, library, options, findings, &progress.part(0.6, 1.0))
}

/// Parses the text of an OBJ file. MTL files are searched for in `folder`, if given. Fails like
/// [`load`].
pub(super) fn parse(
    bytes: &[u8],
    file: &str,
    folder: Option<&Path>,
    options: &LoadOptions,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    let mut findings = Findings::new(file);
    let content = content(bytes, bytes.len(), file, &mut findings, &progress.part(0.0, 0.6))?;
    let mut pictures = Pictures::default();
    let mut library = Library::new(&mut pictures, options.bumps);
    if let Some(folder) = folder {
        for (line, name) in read_libraries(&mut library, &content, folder, &mut findings) {
            findings.add(FindingKind::MtlMissing, &name, Some(line));
        }
    }
    model(content, file, library, options, findings, &progress.part(0.6, 1.0))
}

/// Parses the text of an OBJ file; `size` is its size in bytes, or an estimate.
fn content(
    text: impl Read + Send,
    size: usize,
    file: &str,
    findings: &mut Findings,
    progress: &Progress,
) -> Result<Content, LoadError> {
    let text = read::in_utf_8(text, file)?;
    let mut content = join::content(text, size, file, findings, progress)?;
    refuse_nothing(file, &content)?;
    content.show_vertices(findings);
    Ok(content)
}

/// Builds a model from parsed content.
fn model(
    content: Content,
    file: &str,
    library: Library<'_>,
    options: &LoadOptions,
    mut findings: Findings,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    let parts = named_parts(&content.parts, &library, &mut findings);
    let used = parts.iter().filter_map(|part| part.material).collect();
    if content.parts.iter().all(|part| part.names.material.is_none()) {
        findings.note_all(FindingKind::MaterialsUnused, library.count(), None);
    }
    // Finishing the library decides how `Tr 1` and `d 0` are read, which depends on the used
    // materials.
    let companions = library.files();
    let (materials, of_materials) = library.finish(&used);
    let edge_color = content.edge_color;
    progress.reached(1, 10)?;

    // The checks below need the triangles and normals of the finished mesh.
    let mut content = content;
    let faces = FaceRuns::of(std::mem::take(&mut content.faces.runs));
    let (source, corners) = source(content, &faces, parts, options)
        .ok_or_else(|| LoadError::file(file, "the coordinates are too large at this scale"))?;
    let mesh = Mesh::from_lists(source, corners);
    let mesh = mesh.map_err(|error| LoadError::file(file, error.to_string()))?;
    for polygon in mesh.without_area() {
        findings.note(FindingKind::FaceNoArea, faces.line(*polygon));
    }
    note_crossings(&mesh, &faces, &mut findings);
    note_orientation(&mesh, &faces, &mut findings);
    findings.note_all(FindingKind::VertexUnused, mesh.unused_vertices().len(), None);
    note_unmapped(&mesh, &materials, &mut findings);
    progress.reached(1, 1)?;

    let model = Model::of_mesh(&model_name(file), mesh);
    if !model.baked_light {
        note_replaced_colors(&model.mesh, &materials, &mut findings);
    }
    let model = Model { companions, options: *options, materials, edge_color, ..model };
    let findings = findings.into_list().into_iter().chain(of_materials).collect();
    Ok(Loaded { model, findings: joined(findings) })
}

/// Rejects a file without lines and points if all of its faces, or all of its vertices, are
/// unusable.
fn refuse_nothing(file: &str, content: &Content) -> Result<(), LoadError> {
    if !content.faces.runs.is_empty() || !content.strokes.is_empty() {
        return Ok(());
    }
    // The unreadable vertex is the root cause, so it is reported before the faces.
    if let Some((line, reason)) = &content.refused
        && (content.positions.is_empty() || content.faces.refused.is_some())
    {
        let what = if content.positions.is_empty() { "the vertices" } else { "its faces" };
        let reason = format!("{reason}; none of {what} can be used");
        return Err(LoadError::line(file, *line, reason));
    }
    if let Some((line, reason)) = &content.faces.refused {
        let reason = format!("{reason}; none of its faces can be used");
        return Err(LoadError::line(file, *line, reason));
    }
    if !content.positions.is_empty() {
        return Ok(());
    }
    Err(LoadError::file(
        file,
        match content.vertices {
            0 => "this is not an OBJ file: it has neither vertices nor faces",
            _ => "all of its vertices are infinite or NaN",
        },
    ))
}

/// Reads the MTL files in `folder`. Returns missing files, with their lines.
fn read_libraries(
    library: &mut Library<'_>,
    content: &Content,
    folder: &Path,
    findings: &mut Findings,
) -> Vec<(u32, String)> {
    let mut missing = Vec::new();
    let mut seen = BTreeSet::new();
    for (line, names) in &content.libraries {
        // Exporters repeat the statement for every object.
        if !seen.insert(names) {
            continue;
        }
        // Each file costs a disk access.
        if seen.len() > MOST_LIBRARIES {
            findings.note(FindingKind::MtlMany, *line);
            continue;
        }
        for (name, path) in library.locator.locate_all(folder, names, ".mtl") {
            match path {
                Some(path) => library.read(&path, folder),
                None => missing.push((*line, name)),
            }
        }
    }
    missing
}

/// Searches for an MTL file or a picture with the model's name.
///
/// Renaming a model breaks its reference to the MTL file, and some models never had one. If faces
/// name undefined materials, the MTL file with the model's name is read, as in Blender.
fn own_library(
    library: &mut Library<'_>,
    content: &Content,
    path: &Path,
    missing: Vec<(u32, String)>,
    findings: &mut Findings,
) {
    let folder = path.parent().unwrap_or(Path::new(""));
    let shown = shown(path);
    let stem = model_name(&shown);
    let own = |ending: &str| of_model(folder, &stem, ending);
    let has_library = !content.libraries.is_empty() && missing.is_empty();
    let mtl = if has_library { None } else { own("mtl") };
    // Without such an MTL file, a picture of that name is worth a note.
    let Some(mtl) = mtl.filter(|mtl| !library.has_read(mtl)) else {
        if content.libraries.is_empty()
            && let Some(picture) = texture_endings().into_iter().find_map(own)
        {
            findings.add(FindingKind::PictureUnnamed, &short_name(&picture), None);
        }
        for (line, name) in missing {
            findings.add(FindingKind::MtlMissing, &name, Some(line));
        }
        return;
    };
    // If no face names a material, the file is only noted.
    let names_materials = content.parts.iter().any(|part| part.names.material.is_some());
    if missing.is_empty() && !names_materials {
        return findings.add(FindingKind::MtlUnnamed, &short_name(&mtl), None);
    }
    library.read(&mtl, folder);
    if missing.is_empty() {
        findings.add(FindingKind::MtlOfModel, &short_name(&mtl), None);
    }
    // It replaces one file.
    let kinds = iter::once(FindingKind::MtlRenamed).chain(iter::repeat(FindingKind::MtlMissing));
    for ((line, name), kind) in missing.into_iter().zip(kinds) {
        findings.add(kind, &name, Some(line));
    }
}

/// Names the parts after their groups, objects or materials.
fn named_parts(parts: &[NamedPart], library: &Library<'_>, findings: &mut Findings) -> Vec<Part> {
    let mut unknown = BTreeSet::new();
    let named = |(i, part): (usize, &NamedPart)| {
        let names = &part.names;
        let material = names.material.as_deref().and_then(|name| {
            let place = library.place(name);
            if place.is_none() && !name.is_empty() && unknown.insert(name.to_owned()) {
                findings.add(FindingKind::MaterialUnknown, name, Some(part.line));
            }
            place
        });
        let given = [&names.group, &names.object, &names.material];
        let name = given.into_iter().flatten().find(|name| !name.is_empty());
        let name = name.cloned().unwrap_or_else(|| format!("part {}", i + 1));
        Part { name, material }
    };
    parts.iter().enumerate().map(named).collect()
}

/// Builds the lists of the mesh with the requested rotation and scale; `None` if they are not
/// finite.
fn source(
    content: Content,
    faces: &FaceRuns,
    parts: Vec<Part>,
    options: &LoadOptions,
) -> Option<(MeshSource, CornerLists)> {
    let Content { mut positions, uvs, mut normals, colors, has_smoothing, .. } = content;
    let part_names = content.parts.into_iter().map(|part| part.names).collect();
    if placement(options) != placement(&LoadOptions::default()) {
        place(&mut positions, &mut normals, options);
    }
    // Splitting off the offset keeps f32 precision far from the origin.
    let mut used = Cow::from(&content.faces.corners.positions);
    if !content.strokes.is_empty() {
        used.to_mut().extend(content.strokes.iter().flat_map(|stroke| stroke.ends));
    }
    let (offset, positions) = split_positions(&positions, &used);
    drop(used);
    let (arities, polygon_parts) = (faces.arities(), faces.parts());
    let smoothing = if has_smoothing {
        Smoothing::Groups(faces.smoothing())
    } else {
        Smoothing::Crease(options.crease)
    };
    let mut corners = content.faces.corners;
    // Reversing the corners of each polygon flips its winding.
    if options.winding == Winding::Turned {
        let CornerLists { positions, uvs, normals } = &mut corners;
        for list in [positions, uvs, normals].into_iter().filter(|list| !list.is_empty()) {
            let mut rest = &mut list[..];
            for arity in &arities {
                let (polygon, others) = rest.split_at_mut(*arity as usize);
                polygon.reverse();
                rest = others;
            }
        }
    }
    let finite = positions.iter().flatten().all(|x| x.is_finite());
    let source = MeshSource {
        offset,
        positions,
        colors,
        uvs,
        normals,
        corners: Vec::new(),
        arities,
        polygon_parts,
        strokes: content.strokes,
        parts,
        part_names,
        smoothing,
    };
    finite.then_some((source, corners))
}

/// Notes polygons with triangles of opposite orientation: they cross themselves, or were too large
/// to be triangulated correctly.
fn note_crossings(mesh: &Mesh, faces: &FaceRuns, findings: &mut Findings) {
    // Triangles cannot cross themselves.
    if mesh.triangle_count() == mesh.polygon_count() {
        return;
    }
    let crossing = |polygon: &u32| mesh.corners_of(*polygon).len() > 3 && crosses(mesh, *polygon);
    let polygons = 0..u32::try_from(mesh.polygon_count()).unwrap_or(u32::MAX);
    for polygon in polygons.into_par_iter().filter(crossing).collect::<Vec<_>>() {
        let corners = mesh.corners_of(polygon).len().to_string();
        findings.add(FindingKind::PolygonCrosses, &corners, Some(faces.line(polygon)));
    }
}

/// Notes bodies that are inside out, and faces with normals on their back side.
fn note_orientation(mesh: &Mesh, faces: &FaceRuns, findings: &mut Findings) {
    findings.note_inside_out(mesh);
    let against = mesh.polygons_against_normals();
    if let Some(first) = against.first() {
        findings.note_all(FindingKind::NormalsAgainst, against.len(), Some(faces.line(*first)));
    }
}

/// Notes textures on faces without texture coordinates.
fn note_unmapped(mesh: &Mesh, materials: &[FileMaterial], findings: &mut Findings) {
    let texture = |part: &Part| -> Option<(&FileMaterial, &Texture)> {
        let material = materials.get(part.material? as usize)?;
        let map = material.maps.values().map(|map| &map.texture).next();
        Some((material, material.texture.as_ref().or(map)?))
    };
    if !mesh.parts().iter().any(|part| texture(part).is_some()) {
        return;
    }
    // A part is reported if it has faces, but none with texture coordinates.
    let mut seen = vec![[false; 2]; mesh.parts().len()];
    for (polygon, part) in (0..).zip(mesh.polygon_parts()) {
        let [is_used, is_mapped] = &mut seen[*part as usize];
        *is_used = true;
        *is_mapped = *is_mapped || mesh.has_uvs(polygon);
    }
    let mut noted = BTreeSet::new();
    for (part, seen) in mesh.parts().iter().zip(seen) {
        if let ([true, false], Some((material, texture))) = (seen, texture(part))
            && noted.insert(part.material)
        {
            let name = format!("{} of material \"{}\"", short_name(&texture.source), material.name);
            findings.add(FindingKind::TextureUnmapped, &name, None);
        }
    }
}

/// Notes vertex colours other than white that textures replace.
fn note_replaced_colors(mesh: &Mesh, materials: &[FileMaterial], findings: &mut Findings) {
    if mesh.colors().is_empty() {
        return;
    }
    let is_replaced = |material: &u32| {
        let material = materials.get(*material as usize);
        material.is_some_and(|it| it.texture.is_some())
    };
    let of_part: Vec<Option<u32>> =
        mesh.parts().iter().map(|part| part.material.filter(is_replaced)).collect();
    let mut replaced = BTreeSet::new();
    for (polygon, part) in (0..).zip(mesh.polygon_parts()) {
        let Some(material) = of_part[*part as usize] else { continue };
        let white = |corner: &Corner| mesh.colors()[corner.position as usize] == [1.0; 3];
        if mesh.has_uvs(polygon) && !replaced.contains(&material) {
            let is_colored = !mesh.polygon(polygon).iter().all(white);
            replaced.extend(is_colored.then_some(material));
        }
    }
    for material in replaced {
        findings.add(FindingKind::ColorTextured, &materials[material as usize].name, None);
    }
}

fn crosses(mesh: &Mesh, polygon: u32) -> bool {
    let normal = dvec3(mesh.polygon_normals()[polygon as usize]);
    let at =
        |corner: u32| dvec3(mesh.positions()[mesh.corners()[corner as usize].position as usize]);
    // Slightly curved polygons may have triangles that barely face away.
    let [mut backwards, mut forwards] = [0.0; 2];
    for triangle in &mesh.triangles()[mesh.triangles_of(polygon)] {
        let area = newell(triangle.corners.into_iter().map(at)).dot(normal);
        backwards += (-area).max(0.0);
        forwards += area.max(0.0);
    }
    backwards > 1e-3 * forwards
}
