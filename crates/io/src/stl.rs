//! Loads a model from an STL file, binary or ASCII.
//!
//! STL lists triangles, each with its own corners. Corners at equal positions become one vertex, so
//! the surface is smooth and closed like that of an OBJ file. Normals of facets are ignored: they
//! follow from the corners, and many programs write zeros.
//!
//! The crate `stl_io` is not used. It rejects files without a name after `solid`, with capital
//! letters or with normals that are not numbers, takes binary files that begin with "solid" for
//! text, stops at the first of several solids, and its errors have no line.
//!
//! The format is that of 3D Systems' "StereoLithography Interface Specification", 1989.

use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
use std::iter;
use std::path::Path;

use super::error::LoadError;
use super::findings::{FindingKind, Findings, joined};
use super::obj::lines::unmarked;
use super::obj::{Loaded, place};
use super::packed::{model_name, unpacked_name};
use super::progress::Progress;
use marraztu_core::scene::{
    CornerLists, LoadOptions, Mesh, MeshSource, Model, Part, PartNames, Smoothing, Winding,
    split_positions,
};

/// The bytes before the triangles of a binary file: a comment of 80 bytes, and their number.
const HEADER: usize = 84;

/// The bytes of a triangle: a normal, three corners, and two bytes without meaning.
const TRIANGLE: usize = 50;

/// The bytes at the beginning of a text that are searched for a facet.
const HEAD: usize = 4096;

/// The number of triangles between two progress checks.
const PIECE: usize = 1 << 16;

/// Returns whether a file with these first bytes and this size is an STL file.
pub(super) fn has_stl_content(head: &[u8], size: usize) -> bool {
    binary_count(head).is_some_and(|count| size_of(count) == Some(size)) || is_ascii(head)
}

/// Returns whether the file at `path` is an STL file, judged by its name or by its content.
pub(super) fn is_stl(path: &Path) -> bool {
    // Reading from a pipe would consume bytes that the loader needs.
    let size = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file);
    let size = size.and_then(|metadata| usize::try_from(metadata.len()).ok());
    let head = || {
        let mut head = Vec::new();
        let read = File::open(path).ok()?.take(HEAD as u64).read_to_end(&mut head);
        read.ok().map(|_| head)
    };
    has_stl_name(path)
        || size.is_some_and(|size| head().is_some_and(|head| has_stl_content(&head, size)))
}

/// Returns whether a name ends in .stl or .stl.gz.
fn has_stl_name(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = Path::new(unpacked_name(&name).unwrap_or(&name));
    name.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("stl"))
}

/// Returns the number of triangles that a binary file states.
fn binary_count(head: &[u8]) -> Option<usize> {
    let count = head.get(HEADER - 4..HEADER)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

fn size_of(count: usize) -> Option<usize> {
    count.checked_mul(TRIANGLE)?.checked_add(HEADER)
}

/// Returns whether a text begins with `solid`, with a facet or the end after it.
fn is_ascii(head: &[u8]) -> bool {
    let head = unmarked(&head[..head.len().min(HEAD)]).trim_ascii_start().to_ascii_lowercase();
    let text = String::from_utf8_lossy(&head);
    let mut words = text.split_ascii_whitespace();
    words.next() == Some("solid") && words.any(|word| word == "facet" || word == "endsolid")
}

/// The triangles of a file.
#[derive(Debug, Default)]
struct Solids {
    /// The positions of vertices.
    positions: Vec<[f64; 3]>,
    /// The vertex at each position, by the bits of its coordinates.
    places: HashMap<[u32; 3], u32>,
    /// The vertices of each triangle's corners.
    corners: Vec<u32>,
    /// The name of each solid, and its first triangle.
    solids: Vec<(String, usize)>,
}

impl Solids {
    /// Adds a corner; `None` if it is not finite, or there are too many.
    fn add(&mut self, corner: [f32; 3]) -> Option<()> {
        if !corner.iter().all(|x| x.is_finite()) {
            return None;
        }
        // 0 and -0 are the same position.
        let next = u32::try_from(self.positions.len()).ok()?;
        let place = *self.places.entry(corner.map(|x| (x + 0.0).to_bits())).or_insert(next);
        if place == next {
            self.positions.push(corner.map(f64::from));
        }
        self.corners.push(place);
        Some(())
    }

    fn triangles(&self) -> usize {
        self.corners.len() / 3
    }
}

/// Parses an STL file. Fails if it is damaged or has no triangles, or `progress` is cancelled.
pub(super) fn parse(
    bytes: &[u8],
    file: &str,
    options: &LoadOptions,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    let part = progress.part(0.0, 0.6);
    // A binary file may begin with "solid", too: its size decides.
    let is_binary = binary_count(bytes).is_some_and(|count| size_of(count) == Some(bytes.len()));
    let solids = match is_binary || !is_ascii(bytes) {
        true => binary(bytes, file, &part)?,
        false => ascii(unmarked(bytes), file, &part)?,
    };
    if solids.corners.is_empty() {
        return Err(LoadError::file(file, "the STL file has no triangles"));
    }
    model(solids, file, options, &progress.part(0.6, 1.0))
}

fn binary(bytes: &[u8], file: &str, progress: &Progress) -> Result<Solids, LoadError> {
    let damaged = |reason: String| LoadError::file(file, reason);
    let count = binary_count(bytes)
        .ok_or_else(|| damaged(format!("this is not an STL file: it has {} bytes", bytes.len())))?;
    let rest = &bytes[HEADER..];
    if rest.len() / TRIANGLE < count {
        let there = rest.len() / TRIANGLE;
        return Err(damaged(format!(
            "this is not a whole STL file: it states {count} triangles and has {there}"
        )));
    }
    let mut solids = Solids::default();
    solids.solids.push((String::new(), 0));
    for (i, triangle) in rest.chunks_exact(TRIANGLE).take(count).enumerate() {
        if i.is_multiple_of(PIECE) {
            progress.reached(i, count)?;
        }
        let (numbers, _) = triangle.as_chunks::<4>();
        // The normal comes first.
        for corner in numbers[3..12].as_chunks::<3>().0 {
            solids.add(corner.map(f32::from_le_bytes)).ok_or_else(|| {
                damaged(format!(
                    "triangle {} of the STL file has a corner that is not finite",
                    i + 1
                ))
            })?;
        }
    }
    Ok(solids)
}

fn ascii(bytes: &[u8], file: &str, progress: &Progress) -> Result<Solids, LoadError> {
    let mut solids = Solids::default();
    let (mut read, mut number) = (0, 0);
    // The corners before the current facet, and whether it is open.
    let (mut facet, mut is_open) = (0, false);
    for line in bytes.split(|byte| matches!(byte, b'\n' | b'\r')) {
        let begin = read;
        read += line.len() + 1;
        // CR LF is one line end.
        if line.is_empty() && begin > 0 && bytes[begin - 1..].starts_with(b"\r\n") {
            continue;
        }
        if u32::is_multiple_of(number, 1 << 18) {
            progress.reached(begin, bytes.len())?;
        }
        number = u32::saturating_add(number, 1);
        let wrong = |reason: String| LoadError::line(file, number, reason);
        let text = String::from_utf8_lossy(line);
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        for (word, arguments) in statements(&words) {
            match word.to_ascii_lowercase().as_str() {
                "solid" => solids.solids.push((arguments.join(" "), solids.triangles())),
                "facet" => (facet, is_open) = (solids.corners.len(), true),
                "vertex" => {
                    let numbers = arguments.iter().map(|word| word.parse::<f32>().ok());
                    let numbers: Option<Vec<f32>> = numbers.collect();
                    let corner = numbers.and_then(|numbers| <[f32; 3]>::try_from(numbers).ok());
                    let added = corner.and_then(|corner| solids.add(corner));
                    added.ok_or_else(|| wrong("a vertex has three finite numbers".to_owned()))?;
                }
                "endfacet" => {
                    let corners = solids.corners.len() - facet;
                    if corners != 3 {
                        return Err(wrong(format!("the facet has {corners} corners instead of 3")));
                    }
                    is_open = false;
                }
                "outer" | "endloop" | "endsolid" => {}
                _ => return Err(wrong(format!("{word:?} is not a statement of STL"))),
            }
        }
    }
    if is_open || !solids.corners.len().is_multiple_of(3) {
        return Err(LoadError::line(file, number, "the file ends within a facet"));
    }
    Ok(solids)
}

/// Splits the words of a line into statements, each with its arguments. Usually there is one.
fn statements<'a>(mut words: &'a [&'a str]) -> impl Iterator<Item = (&'a str, &'a [&'a str])> {
    iter::from_fn(move || {
        let (word, after) = words.split_first()?;
        let (arguments, next) = after.split_at(argument_count(word, after));
        words = next;
        Some((*word, arguments))
    })
}

/// Returns the number of words that belong to a statement: all up to the next one in the line.
fn argument_count(word: &str, after: &[&str]) -> usize {
    const KEYWORDS: [&str; 6] = ["facet", "outer", "vertex", "endloop", "endfacet", "endsolid"];
    let is = |word: &str, other: &str| word.eq_ignore_ascii_case(other);
    // Names may contain keywords, so only a whole statement ends a name.
    let is_facet = |pair: &[&str]| is(pair[0], "facet") && is(pair[1], "normal");
    let facet = || after.windows(2).position(is_facet);
    let end = match word.to_ascii_lowercase().as_str() {
        "solid" => facet(),
        "endsolid" => {
            facet().and_then(|end| after[..end].iter().position(|word| is(word, "solid")))
        }
        _ => after.iter().position(|word| KEYWORDS.iter().any(|keyword| is(word, keyword))),
    };
    end.unwrap_or(after.len())
}

fn model(
    solids: Solids,
    file: &str,
    options: &LoadOptions,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    let triangles = solids.triangles();
    let Solids { mut positions, mut corners, solids, .. } = solids;
    place(&mut positions, &mut [], options);
    if options.winding == Winding::Turned {
        corners.as_chunks_mut::<3>().0.iter_mut().for_each(|corners| corners.reverse());
    }
    let (offset, positions) = split_positions(&positions, &corners);
    if !positions.iter().flatten().all(|x| x.is_finite()) {
        return Err(LoadError::file(file, "the coordinates are too large at this scale"));
    }
    progress.reached(1, 10)?;
    let mut polygon_parts = vec![0; triangles];
    for (part, (_, first)) in (0..).zip(&solids) {
        polygon_parts[*first..].fill(part);
    }
    let (mut parts, mut part_names) = (Vec::new(), Vec::new());
    for (i, (name, _)) in solids.into_iter().enumerate() {
        let object = Some(name.clone()).filter(|name| !name.is_empty());
        let name = object.clone().unwrap_or_else(|| format!("part {}", i + 1));
        parts.push(Part { name, material: None });
        part_names.push(PartNames { object, ..PartNames::default() });
    }
    let smoothing = Smoothing::Crease(options.crease);
    let arities = vec![3; triangles];
    let source = MeshSource {
        offset,
        positions,
        arities,
        polygon_parts,
        parts,
        part_names,
        smoothing,
        ..MeshSource::default()
    };
    let lists = CornerLists { positions: corners, ..CornerLists::default() };
    let mesh = Mesh::from_lists(source, lists);
    let mesh = mesh.map_err(|error| LoadError::file(file, error.to_string()))?;
    let mut findings = Findings::new(file);
    findings.note_all(FindingKind::FaceNoArea, mesh.without_area().len(), None);
    findings.note_inside_out(&mesh);
    progress.reached(1, 1)?;
    let model = Model { options: *options, ..Model::of_mesh(&model_name(file), mesh) };
    Ok(Loaded { model, findings: joined(findings.into_list()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a tetrahedron's faces, seen from outside counter-clockwise.
    const FACES: [[[f32; 3]; 3]; 4] = [
        [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, 1.0]],
    ];

    fn binary_file(header: &[u8]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(4_u32.to_le_bytes());
        for face in FACES {
            bytes.extend([0; 12]);
            bytes.extend(face.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn ascii_file(name: &str) -> String {
        let mut text = format!("solid{name}\n");
        for face in FACES {
            text += "  facet normal nan 0 0\n    outer loop\n";
            for [x, y, z] in face {
                text += &format!("      vertex {x:e} {y} {z}\n");
            }
            text += "    endloop\n  endfacet\n";
        }
        text + "endsolid\n"
    }

    fn load(bytes: &[u8], options: &LoadOptions) -> Result<Loaded, LoadError> {
        parse(bytes, "a.stl", options, &Progress::new())
    }

    #[test]
    fn binary_and_ascii_files_give_the_same_closed_mesh() {
        let options = LoadOptions::default();
        let files = [
            binary_file(b"a comment"),
            binary_file(b"solid facet as some programs begin"),
            ascii_file(" pyramid of mine").into_bytes(),
            ascii_file("").into_bytes(),
            ascii_file(" A").to_uppercase().replace('\n', "\r\n").into_bytes(),
            ascii_file(" a").replace('\n', "\r").into_bytes(),
            ascii_file(" a vertex").replace('\n', " ").into_bytes(),
            format!("\u{feff}{}", ascii_file(" a")).into_bytes(),
        ];
        let first = load(&files[0], &options).unwrap();
        assert!(first.findings.is_empty(), "{:?}", first.findings);
        let mesh = &first.model.mesh;
        assert_eq!((mesh.positions().len(), mesh.polygon_count()), (4, 4));
        assert!(mesh.is_closed());
        for file in &files {
            assert!(has_stl_content(file, file.len()));
            let other = load(file, &options).unwrap();
            assert_eq!(other.model.mesh.positions(), mesh.positions());
            assert_eq!(other.model.mesh.corners(), mesh.corners());
        }
        let named = load(&files[2], &options).unwrap();
        assert_eq!(named.model.mesh.parts()[0].name, "pyramid of mine");
        // Turned inside out, and so noted.
        let turned = LoadOptions { winding: Winding::Turned, ..options };
        let turned = load(&files[0], &turned).unwrap();
        assert_eq!(turned.findings[0].kind, FindingKind::InsideOut);
    }

    #[test]
    fn several_solids_are_several_parts() {
        let text = ascii_file(" a") + &ascii_file(" b");
        let loaded = load(text.as_bytes(), &LoadOptions::default()).unwrap();
        let mesh = &loaded.model.mesh;
        let names: Vec<&str> = mesh.parts().iter().map(|part| &*part.name).collect();
        assert_eq!(names, ["a", "b"]);
        assert_eq!(mesh.polygon_parts(), [0, 0, 0, 0, 1, 1, 1, 1]);
        // Words decide, not lines. Keywords in names are no statements.
        let text = (ascii_file(" a") + &ascii_file(" b")).replace("endsolid", "endsolid a");
        for text in [text.replace('\n', " "), text.replace("endsolid a", "endsolid Solid facet")] {
            let other = load(text.as_bytes(), &LoadOptions::default()).unwrap().model.mesh;
            assert_eq!((other.parts(), other.corners()), (mesh.parts(), mesh.corners()), "{text}");
        }
    }

    #[test]
    fn damaged_files_have_one_clear_error() {
        let whole = binary_file(b"");
        let mut not_finite = whole.clone();
        not_finite[HEADER + TRIANGLE + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        let mut more = whole.clone();
        more[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        let text = ascii_file("");
        let wrong = text.replacen("vertex 0e0 0 0", "vertex 0 zero 0", 1);
        for (file, reason) in [
            (whole[..whole.len() - 1].to_vec(), "it states 4 triangles and has 3"),
            (more, "it states 4294967295 triangles and has 4"),
            (not_finite, "triangle 2 of the STL file has a corner that is not finite"),
            (whole[..40].to_vec(), "this is not an STL file: it has 40 bytes"),
            (b"solid a\nendsolid a\n".to_vec(), "the STL file has no triangles"),
            (wrong.clone().into(), "a.stl:4: a vertex has"),
            (wrong.replace('\n', "\r\n").into(), "a.stl:4: a vertex has"),
            (wrong.replace('\n', "\r").into(), "a.stl:4: a vertex has"),
            (text.replacen("vertex 0e0 0 0", "vertex 0 0 0 0", 1).into(), "a.stl:4: a vertex has"),
            (text.replacen("vertex 0e0 0 0", "vertex 0 inf 0", 1).into(), "a.stl:4: a vertex has"),
            (text.replacen("vertex 0e0 0 0", "", 1).into(), "a.stl:8: the facet has 2 corners"),
            (text.replacen("outer", "inner", 1).into(), "a.stl:3: \"inner\" is not a statement"),
            (text[..90].to_owned().into(), "the file ends within a facet"),
            // The last number of a facet is cut off.
            (text[..text.find("endloop").unwrap() - 2].into(), "the file ends within a facet"),
        ] {
            let error = load(&file, &LoadOptions::default()).unwrap_err().to_string();
            assert!(error.contains(reason), "{error}");
        }
    }

    #[test]
    fn other_files_are_not_taken_for_stl() {
        for other in [&b"v 0 0 0\n"[..], b"solid state\nv 0 0 0\n", b"o solid\nfacet\n", b""] {
            assert!(!has_stl_content(other, other.len()), "{other:?}");
        }
        let text = [b'v'; HEADER + TRIANGLE];
        assert!(!has_stl_content(&text, text.len()));
        for (name, is_stl) in
            [("a.stl", true), ("b.STL.gz", true), ("stl", false), ("a.obj", false)]
        {
            assert_eq!(has_stl_name(Path::new(name)), is_stl, "{name}");
        }
    }
}
