//! Loads a model from an STL file, binary or ASCII.
//!
//! STL lists triangles, each with its own corners. Corners at equal positions become one vertex, so
//! the surface is closed like that of an OBJ file. It is flat unless the user chooses a crease
//! angle, as in other programs. Normals of facets are ignored: they follow from the corners, and
//! many programs write zeros.
//!
//! The crate `stl_io` is not used. It rejects files without a name after `solid`, with capital
//! letters or with normals that are not numbers, takes binary files that begin with "solid" for
//! text, stops at the first of several solids, and its errors have no line.
//!
//! The format is that of 3D Systems' "StereoLithography Interface Specification", 1989.

mod ascii;
mod colors;
mod solids;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use self::colors::colors;
use self::solids::{PIECE, Solids};
use super::error::LoadError;
use super::findings::{FindingKind, Findings};
use super::loaded::Loaded;
use super::obj::lines::unmarked;
use super::packed::unpacked_name;
use super::progress::Progress;
use marraztu_core::scene::{Crease, LoadOptions};

/// The bytes before the triangles of a binary file: a comment of 80 bytes, and their number.
const HEADER: usize = 84;

/// The bytes of a triangle: a normal, three corners, and two bytes that may hold a colour.
const TRIANGLE: usize = 50;

/// The bytes at the beginning of a file that tell its format.
const HEAD: usize = 4096;

/// Returns whether a file with these first bytes and this size is an STL file.
pub(super) fn has_stl_content(head: &[u8], size: usize) -> bool {
    let head = &head[..head.len().min(HEAD)];
    has_size_of_binary(head, size) || is_ascii(head, head.len() == size)
}

/// Returns the crease angle to read a file with, unless the user chooses one.
pub fn usual_crease(path: &Path) -> Crease {
    crease_of(is_stl(path))
}

/// Returns the usual crease angle of a file that is an STL file or not.
pub(super) fn crease_of(is_stl: bool) -> Crease {
    if is_stl { Crease::FLAT } else { Crease::default() }
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
pub(super) fn has_stl_name(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = Path::new(unpacked_name(&name).unwrap_or(&name));
    name.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("stl"))
}

/// Returns the number of triangles that a binary file states.
fn binary_count(head: &[u8]) -> Option<usize> {
    let count = head.get(HEADER - 4..HEADER)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

/// Returns whether a file has exactly the size that it states as a binary file.
fn has_size_of_binary(head: &[u8], size: usize) -> bool {
    let stated = binary_count(head).and_then(|count| count.checked_mul(TRIANGLE));
    stated.and_then(|triangles| triangles.checked_add(HEADER)) == Some(size)
}

/// Returns whether a text has a line that begins with `solid`, and a facet or the end after it. A
/// part of a text may end before the facet, if only solids and comments precede it.
fn is_ascii(text: &[u8], is_whole: bool) -> bool {
    // The number of triangles of binary files has zeros.
    if has_zeros(text) {
        return false;
    }
    let (mut has_begun, mut has_others) = (false, false);
    let is_break = |byte: &u8| matches!(byte, b'\n' | b'\r');
    let mut lines = unmarked(text).split(is_break).peekable();
    while let Some(line) = lines.next() {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let Some(first) = words.next() else { continue };
        let is_solid = first.eq_ignore_ascii_case(b"solid");
        has_begun |= is_solid;
        let is_end = |word: &[u8]| {
            word.eq_ignore_ascii_case(b"facet") || word.eq_ignore_ascii_case(b"endsolid")
        };
        if has_begun && (is_end(first) || words.any(is_end)) {
            return true;
        }
        // The last line of a part of a text may be cut off.
        let is_cut = !is_whole && lines.peek().is_none();
        has_others |= has_begun && !is_solid && !is_cut && !ascii::is_comment(first);
    }
    has_begun && !has_others && !is_whole
}

fn has_zeros(bytes: &[u8]) -> bool {
    bytes[..bytes.len().min(HEAD)].contains(&0)
}

/// Parses an STL file. Fails if it is damaged or has no triangles, or `progress` is cancelled.
pub(super) fn parse(
    bytes: &[u8],
    file: &str,
    options: &LoadOptions,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    let part = progress.part(0.0, 0.6);
    let mut findings = Findings::new(file);
    // A binary file may begin with "solid", too: its size decides.
    let is_binary = has_size_of_binary(bytes, bytes.len()) || !is_ascii(bytes, true);
    let solids = match is_binary {
        true => binary(bytes, file, &mut findings, &part)?,
        false => ascii::read(unmarked(bytes), file, &mut findings, &part)?,
    };
    if solids.triangles() == 0 {
        let lost = findings.count(FindingKind::TriangleNotFinite);
        return Err(LoadError::file(
            file,
            match lost {
                0 => "the STL file has no triangles",
                _ => "all triangles of the STL file are too large, infinite or NaN",
            },
        ));
    }
    solids.model(file, options, findings, &progress.part(0.6, 1.0))
}

fn binary(
    bytes: &[u8],
    file: &str,
    findings: &mut Findings,
    progress: &Progress,
) -> Result<Solids, LoadError> {
    let damaged = |reason: String| LoadError::file(file, reason);
    let count = binary_count(bytes)
        .ok_or_else(|| damaged(format!("this is not an STL file: it has {} bytes", bytes.len())))?;
    if !has_zeros(bytes) {
        return Err(damaged("this is not an STL file: it has no facets".to_owned()));
    }
    let rest = &bytes[HEADER..];
    if rest.len() / TRIANGLE < count {
        let there = rest.len() / TRIANGLE;
        return Err(damaged(format!(
            "this is not a whole STL file: it states {count} triangles and has {there}"
        )));
    }
    let mut solids = Solids::default();
    let mut attributes = Vec::new();
    for (i, triangle) in rest.as_chunks::<TRIANGLE>().0.iter().take(count).enumerate() {
        if i.is_multiple_of(PIECE) {
            progress.reached(i, count)?;
        }
        let (numbers, last) = triangle.as_chunks::<4>();
        // The normal comes first.
        let corner = |i: usize| [0, 1, 2].map(|k| f32::from_le_bytes(numbers[3 * i + k]));
        if solids.add([1, 2, 3].map(corner)) {
            attributes.extend(last.first_chunk().map(|bytes| u16::from_le_bytes(*bytes)));
        } else {
            findings.add(FindingKind::TriangleNotFinite, "", None);
        }
    }
    solids.colors = colors(&bytes[..HEADER - 4], &attributes);
    Ok(solids)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use marraztu_core::scene::Winding;

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
        let mut more = whole.clone();
        more[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        let mut not_finite = whole.clone();
        for triangle in not_finite[HEADER..].as_chunks_mut::<TRIANGLE>().0 {
            triangle[12..16].copy_from_slice(&f32::INFINITY.to_le_bytes());
        }
        let text = ascii_file("");
        let short = text.replacen("vertex 0e0 0 0", "", 1);
        for (file, reason) in [
            (whole[..whole.len() - 1].to_vec(), "it states 4 triangles and has 3"),
            (more, "it states 4294967295 triangles and has 4"),
            (not_finite, "all triangles of the STL file are too large, infinite or NaN"),
            (whole[..40].to_vec(), "this is not an STL file: it has 40 bytes"),
            ("<html>".repeat(40).into(), "this is not an STL file: it has no facets"),
            (b"solid a\nendsolid a\n".to_vec(), "the STL file has no triangles"),
            (text.replace("vertex", "vertex nan").into(), "all triangles of the STL file"),
            (short.clone().into(), "a.stl:8: the facet has 2 corners"),
            (short.replace('\n', "\r\n").into(), "a.stl:8: the facet has 2 corners"),
            (short.replace('\n', "\r").into(), "a.stl:8: the facet has 2 corners"),
            (text[..90].to_owned().into(), "the file ends within a facet"),
            // The last number of a facet is cut off.
            (text[..text.find("endloop").unwrap() - 2].into(), "the file ends within a facet"),
        ] {
            let error = load(&file, &LoadOptions::default()).unwrap_err().to_string();
            assert!(error.contains(reason), "{error}");
        }
    }

    /// The kinds, counts and lines of the findings of a file, and its number of triangles.
    fn found(bytes: &[u8]) -> (Vec<(FindingKind, usize, Option<u32>)>, usize) {
        let Loaded { model, findings } = load(bytes, &LoadOptions::default()).unwrap();
        let findings = findings.iter().map(|it| (it.kind, it.count, it.line)).collect();
        (findings, model.mesh.polygon_count())
    }

    #[test]
    fn a_triangle_that_is_not_finite_costs_no_other() {
        let whole = binary_file(b"");
        for (number, at) in [(f32::NAN, 12), (f32::NEG_INFINITY, 44)] {
            let mut file = whole.clone();
            file[HEADER + TRIANGLE + at..][..4].copy_from_slice(&number.to_le_bytes());
            assert_eq!(found(&file), (vec![(FindingKind::TriangleNotFinite, 1, None)], 3));
        }
        for corner in [
            "nan 0 0",
            "0 inf 0",
            "0 0 -Infinity",
            "-nan(ind) 0 0",
            "1.#QNAN 0 0",
            "1e39 0 0",
            "0 zero 0",
            "0 0",
            "0 0 0 0",
        ] {
            let text = ascii_file("").replacen("vertex 0e0 0 0", &format!("vertex {corner}"), 1);
            let lost = vec![(FindingKind::TriangleNotFinite, 1, Some(8))];
            assert_eq!(found(text.as_bytes()), (lost, 3), "{corner}");
        }
        // The normal of a facet is ignored.
        assert_eq!(found(&ascii_file("").into_bytes()), (Vec::new(), 4));
        let odd = ascii_file("").replacen("vertex 0e0 0 0", "vertex 0,0 0 0", 1);
        assert_eq!(found(odd.as_bytes()), (vec![(FindingKind::NumberOdd, 1, Some(4))], 4));
    }

    #[test]
    fn comments_and_words_of_other_formats_are_skipped() {
        let text = ascii_file(" a #3");
        let clean = load(text.as_bytes(), &LoadOptions::default()).unwrap().model.mesh;
        assert_eq!(clean.parts()[0].name, "a #3");
        let comments = [
            format!("# made by hand\n; so\n// facet normal 0 0 1\n{text}"),
            text.replace("outer loop", "outer loop # vertex 9 9 9"),
            text.replace("endfacet", "endfacet // endsolid\n#vertex 9 9 9"),
            text.replacen("a #3", "a #3 # made by hand", 1).replace('\n', "\r\n"),
        ];
        let words = [
            format!("+\n {text}"),
            text.replacen("outer loop", "inner loop", 1),
            text.replacen("endloop", "endloop\ncolor 0.5 0.5 0.5", 1),
        ];
        for (texts, kinds) in
            [(&comments[..], &[][..]), (&words[..], &[(FindingKind::StlUnknown, 1)][..])]
        {
            for text in texts {
                assert!(has_stl_content(text.as_bytes(), text.len()), "{text}");
                let other = load(text.as_bytes(), &LoadOptions::default()).unwrap();
                let found: Vec<_> = other.findings.iter().map(|it| (it.kind, it.count)).collect();
                assert_eq!(found, kinds, "{text}");
                let mesh = other.model.mesh;
                assert_eq!((mesh.parts(), mesh.corners()), (clean.parts(), clean.corners()));
            }
        }
    }

    #[test]
    fn a_facet_after_many_lines_of_solids_and_comments_is_found() {
        for line in ["solid\n", "# a licence\n", "solid a\n\n"] {
            let text = line.repeat(HEAD) + &ascii_file(" a");
            assert_eq!(found(text.as_bytes()).1, 4);
            let head = text.as_bytes()[..HEAD].to_vec();
            let is_known = line.starts_with("solid");
            assert_eq!(has_stl_content(&head, text.len()), is_known, "without its name: {line}");
        }
    }

    #[test]
    fn empty_solids_are_no_parts() {
        // As parts, each would cost a pass over all triangles.
        let text = "solid a\nendsolid a\n".repeat(200_000) + &ascii_file(" b").repeat(1000);
        let loaded = load(text.as_bytes(), &LoadOptions::default()).unwrap();
        let parts = loaded.model.mesh.parts();
        assert_eq!((parts.len(), &*parts[0].name), (1000, "b"));
        let one_line = text[..1 << 20].replace('\n', " ") + &ascii_file(" b");
        assert_eq!(found(one_line.as_bytes()).1, 4);
    }

    #[test]
    fn one_long_line_and_many_empty_solids_can_be_cancelled() {
        // Each report of progress checks for cancellation.
        let reports = |text: &str| {
            let count = Arc::new(AtomicUsize::new(0));
            let heard = Arc::clone(&count);
            let progress = Progress::heard_by(move |_| {
                heard.fetch_add(1, Ordering::Relaxed);
            });
            parse(text.as_bytes(), "a.stl", &LoadOptions::default(), &progress).unwrap();
            count.load(Ordering::Relaxed)
        };
        let few = reports(&ascii_file(" a"));
        assert!(reports(&ascii_file(" a").repeat(10_000).replace('\n', " ")) > few + 3);
        assert!(reports(&("solid\n".repeat(300_000) + &ascii_file(" a"))) > few + 3);
    }

    #[test]
    fn triangles_of_one_colour_are_a_part_with_its_material() {
        let mut file = binary_file(b"");
        for (i, color) in [0xFC00_u16, 0x801F, 0xFC00, 0].into_iter().enumerate() {
            file[HEADER + i * TRIANGLE + 48..][..2].copy_from_slice(&color.to_le_bytes());
        }
        let model = load(&file, &LoadOptions::default()).unwrap().model;
        let names: Vec<&str> = model.mesh.parts().iter().map(|part| &*part.name).collect();
        assert_eq!(names, ["rgb_ff0000", "rgb_0000ff", "part 3"]);
        assert_eq!(model.mesh.polygon_parts(), [0, 1, 0, 2]);
        let materials: Vec<Option<u32>> = model.mesh.parts().iter().map(|it| it.material).collect();
        assert_eq!(materials, [Some(0), Some(1), None]);
        assert_eq!(model.materials[0].material.diffuse, [1.0, 0.0, 0.0]);
        assert!(model.mesh.is_closed());
        assert!(
            load(&binary_file(b""), &LoadOptions::default()).unwrap().model.materials.is_empty()
        );
    }

    #[test]
    fn other_files_are_not_taken_for_stl() {
        let long = [&b"solid state\n"[..], &b"v 0 0 0\n".repeat(1000)].concat();
        for other in [&b"v 0 0 0\n"[..], b"solid state\nv 0 0 0\n", b"o solid\nfacet\n", b"", &long]
        {
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
