//! A model from an OBJ file.
//!
//! One pass over the bytes finds out what the statements say ([`scan`]), the faces that can be used
//! are picked ([`sound`]), `tobj` reads the numbers from a text that it reads rightly
//! ([`canonical`]), and a [`Mesh`] is made of them. A vertex of the mesh is a `v` of the file, used
//! or not.
//!
//! A number that cannot be read refuses the file, for what follows would be guesswork. What can be
//! left out or mended without guessing is, and each such thing is a [`Finding`].
//!
//! The format is that of Wavefront's "Advanced Visualizer", Appendix B1, with the colours of
//! vertices that MeshLab and others write.

mod canonical;
pub(super) mod lines;
mod parts;
mod scan;
mod sound;

use std::path::Path;

use self::canonical::Numbers;
use self::parts::PartNames;
use self::scan::Scan;
use self::sound::SoundFaces;
use super::error::{LoadError, short_name};
use super::findings::{Finding, FindingKind, Findings};
use super::locate::locate_all;
use super::mtl::Library;
use super::progress::Progress;
use crate::base::math;
use crate::scene::{
    LoadOptions, Mesh, MeshSource, Model, Part, SourceCorner, UpAxis, Winding, dvec3, newell,
};

/// A model, with what was found on the way.
#[derive(Debug)]
pub struct Loaded {
    /// The model.
    pub model: Model,
    /// What was mended, left out or odd.
    pub findings: Vec<Finding>,
}

/// Reads an OBJ file, with the MTL files and textures that it names.
///
/// # Errors
/// Where the file cannot be read, is no OBJ file, has a number that cannot be read, or has faces of
/// which none can be used; and where `progress` is cancelled.
pub fn load(path: &Path, options: &LoadOptions, progress: &Progress) -> Result<Loaded, LoadError> {
    let file = short_name(path);
    let bytes = read(path, &file, &progress.part(0.0, 0.1))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut loaded = parse(&bytes, &file, Some(folder), options, &progress.part(0.1, 1.0))?;
    // Complete, so that it holds wherever the program goes on to work.
    loaded.model.source = Some(std::path::absolute(path).unwrap_or_else(|_empty| path.to_owned()));
    Ok(loaded)
}

/// Reads the text of an OBJ file. `folder` is where its MTL files are looked for; where it is `None`
/// none are.
///
/// # Errors
/// As [`load`].
pub fn parse(
    bytes: &[u8],
    file: &str,
    folder: Option<&Path>,
    options: &LoadOptions,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    if let Some(reason) = no_obj(bytes) {
        return Err(LoadError::file(file, reason));
    }
    let mut findings = Findings::new(file);
    let mut scan = scan::scan(bytes, file, &mut findings, &progress.part(0.0, 0.4))?;
    let faces = sound::sound_faces(&mut scan, &mut findings);
    refuse_nothing(file, &scan, &faces)?;
    if faces.arities.is_empty() {
        findings.add(FindingKind::NoFaces, "", None);
    }

    let library = libraries(&scan, folder, &mut findings);
    let parts = named_parts(&scan.parts.list, &library, &mut findings);
    let colors = std::mem::take(&mut scan.colors);
    let edge_color = scan.edge_color;

    let numbers = canonical::through_tobj(scan, &faces, &progress.part(0.4, 0.7))
        .map_err(|reason| reason.map_or(LoadError::Cancelled, |r| LoadError::file(file, r)))?;
    progress.reached(7, 10)?;
    let lines = faces.lines.clone();
    let source = source(&numbers, colors, faces, parts, options)
        .ok_or_else(|| LoadError::file(file, "its coordinates are too large at this scale"))?;
    note_shapes(&source, &lines, &mut findings);
    let mesh = Mesh::new(source).map_err(|error| LoadError::file(file, error.to_string()))?;
    note_crossings(&mesh, &lines, &mut findings);
    progress.reached(1, 1)?;

    let name = Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let Library { materials, findings: of_materials, .. } = library;
    let model = Model { name, source: None, options: *options, mesh, materials, edge_color };
    Ok(Loaded { model, findings: findings.into_list().into_iter().chain(of_materials).collect() })
}

/// Reads a file in pieces, so that it can be watched and cancelled.
fn read(path: &Path, file: &str, progress: &Progress) -> Result<Vec<u8>, LoadError> {
    use std::io::Read;
    let system = |error: std::io::Error| LoadError::system(file, &error);
    let mut handle = std::fs::File::open(path).map_err(system)?;
    let metadata = handle.metadata().map_err(system)?;
    if metadata.is_dir() {
        return Err(LoadError::file(file, "this is a folder, not a file"));
    }
    let size = usize::try_from(metadata.len()).unwrap_or(0);
    let mut bytes = Vec::new();
    bytes
        .try_reserve(size)
        .map_err(|_full| LoadError::file(file, "there is not enough memory for it"))?;
    loop {
        let piece = handle.by_ref().take(8 << 20).read_to_end(&mut bytes).map_err(system)?;
        progress.reached(bytes.len(), size)?;
        if piece == 0 {
            return Ok(bytes);
        }
    }
}

/// Why these bytes are no text of an OBJ file, where one can tell by their beginning.
fn no_obj(bytes: &[u8]) -> Option<String> {
    let known = [
        (&b"\xFF\xFE"[..], "a text of UTF-16; save it as UTF-8"),
        (b"\xFE\xFF", "a text of UTF-16; save it as UTF-8"),
        (b"glTF", "a glTF file"),
        (b"PK\x03\x04", "a ZIP archive; unpack it first"),
        (b"\x1F\x8B", "a gzip archive; unpack it first"),
        (b"Kaydara FBX", "an FBX file"),
        (b"BLENDER", "a Blender file; export it as OBJ"),
        (b"\x89PNG", "a PNG picture"),
        (b"\xFF\xD8\xFF", "a JPEG picture"),
        (b"ply\n", "a PLY file"),
        (b"ply\r\n", "a PLY file"),
        (b"solid ", "an STL file"),
        (b"OFF\n", "an OFF file"),
    ];
    if bytes.trim_ascii().is_empty() {
        return Some("the file is empty".to_owned());
    }
    for (begin, what) in known {
        if bytes.starts_with(begin) {
            return Some(format!("this is no OBJ file, but {what}"));
        }
    }
    bytes[..bytes.len().min(4096)].contains(&0).then(|| "this is no OBJ file: it is no text".into())
}

/// Refuses a file of which nothing would be left.
fn refuse_nothing(file: &str, scan: &Scan, faces: &SoundFaces) -> Result<(), LoadError> {
    if !faces.arities.is_empty() {
        return Ok(());
    }
    if let Some((line, reason)) = &faces.refused {
        let reason = format!("{reason}; no face of the file can be used");
        return Err(LoadError::line(file, *line, reason));
    }
    if scan.vertices.kept() > 0 {
        return Ok(());
    }
    Err(LoadError::file(
        file,
        match scan.vertices.count {
            0 => "this is no OBJ file: it has neither vertices nor faces",
            _ => "none of its vertices is finite",
        },
    ))
}

/// The materials of the MTL files that are found in `folder`.
fn libraries(scan: &Scan, folder: Option<&Path>, findings: &mut Findings) -> Library {
    let mut library = Library::default();
    let Some(folder) = folder else { return library };
    for (line, names) in &scan.libraries {
        for (name, path) in locate_all(folder, names, ".mtl") {
            match path {
                Some(path) => library.read(&path, folder),
                None => findings.add(FindingKind::MtlMissing, &name, Some(*line)),
            }
        }
    }
    library
}

/// The parts, by the names of their groups, objects or materials.
fn named_parts(names: &[PartNames], library: &Library, findings: &mut Findings) -> Vec<Part> {
    let part = |(i, names): (usize, &PartNames)| {
        let material = names.material.as_deref().and_then(|name| {
            let place = library.place(name);
            if place.is_none() && !name.is_empty() {
                findings.add(FindingKind::MaterialUnknown, name, Some(names.line));
            }
            place
        });
        let given = [&names.group, &names.object, &names.material];
        let name = given.into_iter().flatten().find(|name| !name.is_empty());
        let name = name.cloned().unwrap_or_else(|| format!("part {}", i + 1));
        Part { name, material }
    };
    names.iter().enumerate().map(part).collect()
}

/// What the mesh is made of, turned and scaled as asked for; `None` where that is not finite.
fn source(
    numbers: &Numbers,
    colors: Vec<[f32; 3]>,
    faces: SoundFaces,
    parts: Vec<Part>,
    options: &LoadOptions,
) -> Option<MeshSource> {
    let up = |[x, y, z]: [f32; 3]| match options.up {
        UpAxis::Y => [x, y, z],
        UpAxis::Z => [x, z, -y],
    };
    let scale = options.scale.get();
    #[expect(clippy::cast_possible_truncation, reason = "checked to be finite below")]
    let scaled = |x: f32| if scale == 1.0 { x } else { (f64::from(x) * scale) as f32 };
    let turned = options.winding == Winding::Turned;
    let normal = |row: &[f32; 3]| up(row.map(|x| if turned { -x } else { x }));

    let mut corners = faces.corners;
    if turned {
        let mut begin = 0;
        for arity in &faces.arities {
            corners[begin..begin + *arity as usize].reverse();
            begin += *arity as usize;
        }
    }
    let positions: Vec<[f32; 3]> =
        numbers.positions.as_chunks().0.iter().map(|row| up(*row).map(scaled)).collect();
    let finite = positions.iter().flatten().all(|x| x.is_finite());
    finite.then(|| MeshSource {
        positions,
        colors,
        uvs: numbers.uvs.as_chunks().0.to_vec(),
        normals: numbers.normals.as_chunks().0.iter().map(normal).collect(),
        corners,
        arities: faces.arities,
        polygon_parts: faces.parts,
        parts,
    })
}

/// The polygons of a source, as ranges of its corners.
fn polygons(source: &MeshSource) -> impl Iterator<Item = &[SourceCorner]> {
    let mut rest = &source.corners[..];
    source.arities.iter().map(move |arity| {
        let (polygon, others) = rest.split_at(*arity as usize);
        rest = others;
        polygon
    })
}

/// Notes the faces without area.
fn note_shapes(source: &MeshSource, lines: &[u32], findings: &mut Findings) {
    for (polygon, line) in polygons(source).zip(lines) {
        let at = |corner: &SourceCorner| dvec3(source.positions[corner.position as usize]);
        if math::unit(newell(polygon.iter().map(at))).is_none() {
            findings.note(FindingKind::FaceNoArea, *line);
        }
    }
}

/// Notes polygons whose triangles do not all run the polygon's way: they cross
/// themselves, or were too large to be cut up rightly.
fn note_crossings(mesh: &Mesh, lines: &[u32], findings: &mut Findings) {
    for (polygon, line) in (0..).zip(lines) {
        let corners = mesh.corners_of(polygon).len();
        if corners < 4 {
            continue;
        }
        let normal = dvec3(mesh.polygon_normals()[polygon as usize]);
        let at = |corner: u32| {
            dvec3(mesh.positions()[mesh.corners()[corner as usize].position as usize])
        };
        let triangles = mesh.triangles()[mesh.triangles_of(polygon)].iter();
        let areas: Vec<f64> = triangles
            .map(|triangle| newell(triangle.corners.into_iter().map(at)).dot(normal))
            .collect();
        // Polygons that are not quite flat have triangles that are only just turned away.
        let backwards: f64 = areas.iter().map(|area| (-area).max(0.0)).sum();
        let forwards: f64 = areas.iter().map(|area| area.max(0.0)).sum();
        if backwards > 1e-3 * forwards {
            findings.add(FindingKind::PolygonCrosses, &corners.to_string(), Some(*line));
        }
    }
}
