//! Reading OBJ files as users and programs write them.
//!
//! Each test is a small file. `tobj` alone fails on the files of the first part or misreads them,
//! because the program passes it only input that it reads correctly. For other files
//! `tests/models.rs` compares the program with `tobj`.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::path::Path;

use marraztu_core::base::color::Color;
use marraztu_core::scene::{LoadOptions, Mesh, NONE, Scale, UpAxis, Winding};
use marraztu_io::{
    Finding, FindingKind, LoadError, Loaded, Progress, describe, load, load_texture, parse,
};
use proptest::prelude::*;

fn read_bytes(bytes: &[u8]) -> Result<Loaded, LoadError> {
    parse(bytes, "a.obj", None, &LoadOptions::default(), &Progress::new())
}

fn read(text: &str) -> Loaded {
    read_bytes(text.as_bytes()).unwrap()
}

/// The mesh of a file without findings.
fn clean(text: &str) -> Mesh {
    let loaded = read(text);
    assert_eq!(loaded.findings, []);
    loaded.model.mesh
}

fn refusal(text: &str) -> String {
    read_bytes(text.as_bytes()).unwrap_err().to_string()
}

/// Kind and text of the only finding of a file.
fn only(loaded: &Loaded) -> (FindingKind, &str) {
    let [finding] = &loaded.findings[..] else { panic!("{:?}", loaded.findings) };
    (finding.kind, &finding.text)
}

fn kinds(findings: &[Finding]) -> Vec<FindingKind> {
    findings.iter().map(|finding| finding.kind).collect()
}

fn outline(mesh: &Mesh, polygon: u32) -> Vec<u32> {
    mesh.polygon(polygon).iter().map(|corner| corner.position).collect()
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

fn triangle_and(rest: &str) -> String {
    format!("{TRIANGLE}{rest}")
}

// Text that `tobj` alone rejects or misreads.

#[test]
fn a_mark_of_the_byte_order_hides_no_vertex() {
    let mesh = clean(&format!("\u{feff}{}", triangle_and("f 1 2 3\n")));
    assert_eq!(mesh.positions(), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn lines_end_in_any_way_and_the_last_need_not() {
    let text = triangle_and("f 1 2 3");
    for ending in ["\n", "\r\n", "\r"] {
        assert_eq!(clean(&text.replace('\n', ending)), clean(&text), "{ending:?}");
    }
}

#[test]
fn a_back_slash_continues_a_line_between_numbers_and_inside_names() {
    let mesh = clean("v 0 \\\n0 0\nv 1 0\\\r\n 0\nv 0 1 0\ng Hell\\\noWorld\nf 1 \\\n 2 \\\n 3\n");
    assert_eq!(mesh.positions()[1], [1.0, 0.0, 0.0]);
    assert_eq!(mesh.parts()[0].name, "HelloWorld");
    assert_eq!(outline(&mesh, 0), [0, 1, 2]);
}

#[test]
fn a_comment_may_follow_numbers_and_corners() {
    let mesh = clean("v 0 0 0 # origin\nv 1 0 0# near\nv 0 1 0 #1 2 3\nf 1 2 3 # 2\nf 1 3 2#4\n");
    assert_eq!((mesh.positions().len(), mesh.polygon_count()), (3, 2));
}

#[test]
fn three_words_of_a_comment_are_not_a_colour_and_a_zero_weight_is_harmless() {
    let loaded = read("v 0 0 0 # no colour\nv 1 0 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(loaded.model.mesh.positions()[..2], [[0.0; 3], [1.0, 0.0, 0.0]]);
    assert!(loaded.model.mesh.colors().is_empty());
    assert_eq!(only(&loaded).0, FindingKind::Weight);
}

#[test]
fn numbers_that_tobj_passes_over_are_found_all_the_same() {
    for (text, kind, word) in [
        ("vt 0 0 x\n", FindingKind::UvUnreadable, "(line 1)"),
        ("vt 0 0 1e\n", FindingKind::UvUnreadable, "(line 1)"),
        ("vn 0 0 1 x\n", FindingKind::NormalUnreadable, "(line 1)"),
        ("v 0 0 0 . 0 0\n", FindingKind::VertexUnreadable, "\".\" is not a number"),
        ("v 0 0 0 1 1 -\n", FindingKind::VertexUnreadable, "\"-\" is not a number"),
        // The first fault is reported, on whichever thread it is found.
        ("v 0 0 --1\nv 0 0\n", FindingKind::VertexUnreadable, "\"--1\" is not a number"),
        ("v 0 0 1..\nv 0 x 0\n", FindingKind::VertexUnreadable, "\"1..\" is not a number"),
    ] {
        let loaded = read(&format!("{text}{TRIANGLE}f -3 -2 -1\n"));
        let (found, told) = only(&loaded);
        assert!(found == kind && told.contains(word), "{text}: {told}");
        assert_eq!(loaded.model.mesh.polygon_count(), 1, "{text}");
    }
}

#[test]
fn tabs_and_many_blanks_divide_as_one_blank_does() {
    let mesh = clean("  v\t0  0\t 0 \nv 1 0 0\nv 0 1 0\nusemtl\t\nf\t1   2\t3  \n");
    assert_eq!(outline(&mesh, 0), [0, 1, 2]);
}

#[test]
fn bytes_that_are_not_utf_8_are_read_as_latin_1() {
    let mesh = read_bytes(b"# caf\xE9\ng caf\xE9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert_eq!(mesh.model.mesh.parts()[0].name, "caf\u{e9}");
}

#[test]
fn lines_and_points_are_read_with_their_parts() {
    let text = "l 1 2\ng b\nl 2/1 3/1 -3 # back\np 1 3\nl 2 2\nf 1 2 3\nl 1\np\nl 1 9\np x\n";
    let loaded = read(&triangle_and(text));
    let mesh = &loaded.model.mesh;
    assert_eq!(mesh.polygon_count(), 1);
    let strokes: Vec<_> = mesh.strokes().iter().map(|it| (it.ends, it.part)).collect();
    let want = [([0, 1], 0), ([1, 2], 1), ([2, 0], 1), ([0, 0], 1), ([2, 2], 1)];
    assert_eq!(strokes, want);
    let texts: Vec<&str> = loaded.findings.iter().map(|f| f.text.as_str()).collect();
    assert_eq!(
        texts,
        [
            "2 lines or points refer to vertices that the file does not have (the first: \"x\") \
             and are skipped (first: line 13)",
            "2 lines have fewer than two vertices, or points none, and are skipped \
             (first: line 10)",
        ]
    );
}

#[test]
fn a_line_to_a_lost_vertex_is_skipped_and_the_others_keep_theirs() {
    let loaded = read("v 0 0 0\nv x\nv 1 0 0\nv 0 1 0\nl 1 3\nl 1 2\nl 3 4\n");
    let ends: Vec<_> = loaded.model.mesh.strokes().iter().map(|it| it.ends).collect();
    assert_eq!(ends, [[0, 1], [1, 2]]);
    assert_eq!(kinds(&loaded.findings), [FindingKind::VertexUnreadable, FindingKind::StrokeVertex]);
    // Lines are enough: the file is not refused, and their vertices count as used.
    assert!(loaded.model.mesh.unused_vertices().is_empty());
}

#[test]
fn texture_coordinates_and_normals_stay_with_their_corners_if_others_lack_them() {
    let loaded = read(&triangle_and(
        "vt 0.25 0.5\nvt 0.5 0.75\nvn 0 0 1\nvn 0 1 0\n\
         f 1 2 3\nf 1/2 2/1 3/2\nf 1//2 2//1 3//2\nf 1/1/1 2/2/2 3/1/1\nf 1/2 2 3\n",
    ));
    let mesh = &loaded.model.mesh;
    let uvs = |polygon| -> Vec<Option<[f32; 2]>> {
        let uv = |uv: u32| (uv != NONE).then(|| mesh.uvs()[uv as usize]);
        mesh.polygon(polygon).iter().map(|corner| uv(corner.uv)).collect()
    };
    let [a, b] = [Some([0.25, 0.5]), Some([0.5, 0.75])];
    assert_eq!(uvs(0), [None; 3]);
    assert_eq!(uvs(1), [b, a, b]);
    assert_eq!(uvs(2), [None; 3]);
    assert_eq!(uvs(3), [a, b, a]);
    assert_eq!(uvs(4), [b, None, None]);
    let normals = |polygon| -> Vec<[f32; 3]> {
        let normal = |i: u32| mesh.points()[i as usize].normal;
        mesh.polygon(polygon).iter().map(|corner| normal(corner.filed)).collect()
    };
    let (y, z) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    assert_eq!(normals(2), [y, z, y]);
    assert_eq!(normals(3), [z, y, z]);
    assert_eq!(kinds(&loaded.findings), [FindingKind::UvMixed, FindingKind::NormalMixed]);
}

#[test]
fn vertices_keep_their_numbers_whether_faces_use_them_or_not() {
    let loaded = read("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 8 8 8\nv 0 1 0\nv 7 7 7\nf 5 2 3\n");
    let text =
        "3 vertices are not used by any face, line or point and do not affect size and centre";
    assert_eq!(only(&loaded), (FindingKind::VertexUnused, text));
    let mesh = loaded.model.mesh;
    assert_eq!(mesh.positions().len(), 6);
    assert_eq!(mesh.positions()[3], [8.0; 3]);
    assert_eq!(outline(&mesh, 0), [4, 1, 2]);
}

#[test]
fn vertices_without_a_colour_are_white_if_others_have_one() {
    let loaded = read("v 0 0 0\nv 1 0 0 0.5 0.25 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(loaded.model.mesh.colors(), [[1.0; 3], [0.5, 0.25, 0.0], [1.0; 3]]);
    let text = "2 vertices have no colour, while others have: they are white";
    assert_eq!(only(&loaded), (FindingKind::ColorPartly, text));
}

#[test]
fn a_fourth_number_is_not_a_colour_and_a_seventh_is_ignored() {
    let loaded = read("v 0 0 0 1\nv 1 0 0 0.5\nv 0 1 0 1 0 0.5 1\nf 1 2 3\n");
    assert_eq!(loaded.model.mesh.positions()[1], [1.0, 0.0, 0.0]);
    assert_eq!(loaded.model.mesh.colors()[2], [1.0, 0.0, 0.5]);
    assert_eq!(kinds(&loaded.findings), [FindingKind::Weight, FindingKind::ColorPartly]);
}

#[test]
fn whole_colours_above_16_are_read_as_bytes() {
    let loaded = read("v 0 0 0 255 0 0\nv 1 0 0 0 51 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
    assert_eq!(loaded.model.mesh.colors()[..2], [[1.0, 0.0, 0.0], [0.0, 0.2, 0.0]]);
    assert_eq!(only(&loaded).0, FindingKind::ColorBytes);
}

#[test]
fn vertices_that_are_not_finite_go_with_their_faces_and_the_others_keep_theirs() {
    for bad in ["nan 0 0", "0 inf 0", "0 0 -1e39", "1.#QNAN 0 0", "-nan(ind) 0 0"] {
        let loaded = read(&format!("v {bad}\n{TRIANGLE}v 0 0 1\nf 2 3 4\nf 1 2 3\nf -3 -2 -1\n"));
        let mesh = &loaded.model.mesh;
        assert_eq!((mesh.positions().len(), mesh.polygon_count()), (4, 2), "{bad}");
        assert_eq!([outline(mesh, 0), outline(mesh, 1)], [[0, 1, 2], [1, 2, 3]], "{bad}");
        assert_eq!(
            kinds(&loaded.findings),
            [FindingKind::VertexNotFinite, FindingKind::FaceOnLostVertex],
            "{bad}"
        );
    }
}

#[test]
fn texture_places_and_normals_that_are_not_finite_are_left_out() {
    let loaded = read(&triangle_and(
        "vt nan 0\nvt 0.5 0.5\nvn 0 inf 0\nvn 0 0 1\nf 1/1/2 2/2/2 3/2/2\nf 1/2/1 2/2/2 3/2/2\n",
    ));
    let uvs: Vec<u32> = loaded.model.mesh.polygon(0).iter().map(|corner| corner.uv).collect();
    assert_eq!(uvs[0], NONE);
    assert_eq!(loaded.model.mesh.uvs()[uvs[1] as usize], [0.5, 0.5]);
    let found = kinds(&loaded.findings);
    assert!(found.contains(&FindingKind::UvNotFinite), "{found:?}");
    assert!(found.contains(&FindingKind::NormalNotFinite), "{found:?}");
}

#[test]
fn a_texture_coordinate_of_one_number_gets_zero_for_the_other() {
    let loaded = read(&triangle_and("vt 0.5\nvt 0.5 0.25 0\nf 1/1 2/2 3/1\n"));
    let mesh = &loaded.model.mesh;
    assert_eq!(mesh.uvs()[mesh.corners()[0].uv as usize], [0.5, 0.0]);
    assert_eq!(mesh.uvs()[mesh.corners()[1].uv as usize], [0.5, 0.25]);
    assert_eq!(only(&loaded).0, FindingKind::UvSingle);
}

// The rules of the format.

#[test]
fn negative_indices_count_back_from_their_statement() {
    let text = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\n\
                f -3/-2/-1 -2/-1/-1 4/1/1\nv 5 5 5\nvt 1 1\nf -4 -3 -1\n";
    let loaded = read(text);
    let mesh = &loaded.model.mesh;
    assert_eq!([outline(mesh, 0), outline(mesh, 1)], [[1, 2, 3], [1, 2, 4]]);
    let uvs = mesh.polygon(0).iter().map(|corner| mesh.uvs()[corner.uv as usize]);
    assert_eq!(uvs.collect::<Vec<_>>(), [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]);
}

#[test]
fn minus_zero_names_no_vertex_not_even_the_one_that_follows() {
    for face in ["f -0 1 2", "f 1 -0 2", "f 1/-0 2/1 3/1", "f 1//-0 2//1 3//1"] {
        let lines = format!("vt 0 0\nvn 0 0 1\n{face}\nv 5 5 5\nvt 1 1\nvn 0 1 0\nf 1 2 3\n");
        let loaded = read(&triangle_and(&lines));
        assert!(!loaded.findings.is_empty(), "{face}");
        let mesh = loaded.model.mesh;
        assert!(mesh.corners().iter().all(|corner| corner.position != 3), "{face}");
        assert!(mesh.corners().iter().all(|corner| corner.uv != 1), "{face}");
        assert!(!mesh.points().iter().any(|point| point.normal == [0.0, 1.0, 0.0]), "{face}");
    }
}

#[test]
fn positive_indices_may_refer_to_later_vertices() {
    assert_eq!(outline(&clean(&format!("f 1 2 3\n{TRIANGLE}")), 0), [0, 1, 2]);
}

#[test]
fn corners_are_written_in_all_their_ways() {
    let mesh = read(&triangle_and("vt 0 0\nvn 0 0 1\nf 1// 2/ 3\nf 1/1 2//1 3/1/1\nf +1 2 3\n"));
    assert_eq!(mesh.model.mesh.polygon_count(), 3);
}

#[test]
fn runs_with_the_same_names_are_one_part_and_are_called_by_group_object_or_material() {
    let mesh = read(&triangle_and(
        "f 1 2 3\no ship\nf 1 2 3\ng  hull  left \nf 1 2 3\nusemtl red\nf 1 2 3\ng hull  left\n\
         f 1 2 3\no\ng\nusemtl red\nf 1 2 3\no ship\nusemtl red\nf 1 2 3\ng wing\n\
         f 1 2 3\no boat\nf 1 2 3\n",
    ));
    let parts: Vec<&str> = mesh.model.mesh.parts().iter().map(|part| part.name.as_str()).collect();
    assert_eq!(
        parts,
        ["part 1", "ship", "hull  left", "hull  left", "red", "ship", "wing", "boat"]
    );
    assert_eq!(mesh.model.mesh.polygon_parts(), [0, 1, 2, 3, 3, 4, 5, 6, 7]);
}

#[test]
fn a_colour_of_edges_is_a_statement_or_a_comment() {
    let color =
        |line: &str| read(&format!("{line}\n{}", triangle_and("f 1 2 3\n"))).model.edge_color;
    assert_eq!(color("c 255 128 0"), Some(Color([255, 128, 0])));
    assert_eq!(color("# color 1 2 3"), Some(Color([1, 2, 3])));
    assert_eq!(color("#color 1 2 3"), Some(Color([1, 2, 3])));
    assert_eq!(color("# color of the sea"), None);
    assert_eq!(color("# a comment"), None);
}

#[test]
fn the_axes_the_scale_and_the_winding_are_as_asked_for() {
    let text = "v 1 2 3\nv 2 2 3\nv 1 3 3\nvn 0 1 0.5\nf 1//1 2//1 3//1\n";
    let with = |up, scale, winding| {
        let scale = Scale::new(scale).unwrap();
        let options = LoadOptions { up, scale, winding, ..LoadOptions::default() };
        parse(text.as_bytes(), "a.obj", None, &options, &Progress::new())
    };
    let mesh = with(UpAxis::Z, 10.0, Winding::Kept).unwrap().model.mesh;
    assert_eq!(mesh.positions()[0], [10.0, 30.0, -20.0]);
    assert_eq!(mesh.polygon_normals()[0], [0.0, 1.0, 0.0]);
    let filed = mesh.points()[mesh.corners()[0].filed as usize].normal;
    assert!(filed[1] > 0.0 && filed[2] < 0.0, "{filed:?}");

    let mesh = with(UpAxis::Y, 1.0, Winding::Turned).unwrap().model.mesh;
    assert_eq!(outline(&mesh, 0), [2, 1, 0]);
    assert_eq!(mesh.polygon_normals()[0], [0.0, 0.0, -1.0]);
    let filed = mesh.points()[mesh.corners()[0].filed as usize].normal;
    assert!(filed[1] < 0.0 && filed[2] < 0.0, "{filed:?}");

    let error = with(UpAxis::Y, 1e39, Winding::Kept).unwrap_err();
    assert_eq!(error.to_string(), "a.obj: the coordinates are too large at this scale");
}

// Rejected files: line and reason.

#[test]
fn a_file_without_a_usable_vertex_is_refused_by_its_first_bad_line() {
    for (text, message) in [
        ("v 0 0 zero\n", "a.obj:1: \"zero\" is not a number"),
        ("# x\n\nv 1 2\nv x\n", "a.obj:3: a vertex needs three numbers, but has 2"),
        ("v 0 0 \\\n0x\n", "a.obj:1: \"0x\" is not a number"),
    ] {
        assert_eq!(refusal(text), format!("{message}; none of the vertices can be used"));
    }
}

#[test]
fn a_decimal_comma_is_read_with_a_finding() {
    let loaded = read("v 0 0 0\nv 0,5 1 1\nv 1 0 0\nf 1 2 3\n");
    assert_eq!(loaded.model.mesh.positions()[1], [0.5, 1.0, 1.0]);
    assert_eq!(only(&loaded).0, FindingKind::NumberOdd);
}

#[test]
fn a_file_without_a_usable_face_is_refused_by_its_first_bad_line() {
    assert_eq!(
        refusal(&triangle_and("f 1 2 9\nf 1 2\n")),
        "a.obj:4: a face refers to vertex 9, but the file has 3 vertices; \
         none of its faces can be used"
    );
    assert_eq!(
        refusal(&triangle_and("f 1 2\n")),
        "a.obj:4: a face needs at least three corners, but has 2; \
         none of its faces can be used"
    );
    assert_eq!(
        refusal(&triangle_and("f a b c\n")),
        "a.obj:4: \"a\" is not a corner of a face; none of its faces can be used"
    );
    assert_eq!(
        refusal(&triangle_and("f 0 1 2\n")),
        "a.obj:4: a face refers to vertex 0, which the file does not have; \
         none of its faces can be used"
    );
}

#[test]
fn a_file_that_is_not_an_obj_file_is_refused() {
    for (bytes, message) in [
        (&b""[..], "a.obj: the file is empty"),
        (b" \n\n", "a.obj: the file is empty"),
        (b"\x89PNG\r\n\x1a\n", "a.obj: this is not an OBJ file but a PNG picture"),
        (b"ab\0cd", "a.obj: this is not an OBJ file: it is not text"),
        (b"v\0 \x000\0", "a.obj: this is not an OBJ file: it is not text"),
        (b"Dear Sir,\n", "a.obj: this is not an OBJ file: it has neither vertices nor faces"),
        (b"v nan 0 0\n", "a.obj: all of its vertices are infinite or NaN"),
    ] {
        assert_eq!(read_bytes(bytes).unwrap_err().to_string(), message);
    }
}

#[test]
fn a_missing_file_or_a_folder_is_refused_in_plain_words() {
    let folder = tempfile::tempdir().unwrap();
    let refusal = |path: &Path| {
        let error = load(path, &LoadOptions::default(), &Progress::new()).unwrap_err().to_string();
        let lead = format!("{}: ", path.display());
        error.strip_prefix(&lead).map(ToOwned::to_owned).unwrap_or(error)
    };
    assert_eq!(refusal(&folder.path().join("b.obj")), "there is no such file");
    let inner = folder.path().join("c.obj");
    std::fs::create_dir(&inner).unwrap();
    assert_eq!(refusal(&inner), "this is a folder, not a file");
}

/// Opening a pipe waits until another program writes to it.
#[test]
#[cfg(target_os = "linux")]
fn a_pipe_and_a_device_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("a.obj");
    make_pipe(&pipe);
    let refusal = |path: &Path| {
        load(path, &LoadOptions::default(), &Progress::new()).unwrap_err().to_string()
    };
    assert_eq!(refusal(&pipe), format!("{}: this is a pipe, not a file", pipe.display()));
    assert_eq!(refusal(Path::new("/dev/zero")), "/dev/zero: this is a device, not a file");
    let picture = folder.path().join("a.png");
    make_pipe(&picture);
    let error = load_texture(&picture).unwrap_err().to_string();
    assert_eq!(error, format!("{}: this is a pipe, not a file", picture.display()));
}

#[cfg(target_os = "linux")]
fn make_pipe(path: &Path) {
    assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn an_error_names_the_file_as_the_user_did() {
    let path = Path::new("tests/../no such folder/b.obj");
    let error = load(path, &LoadOptions::default(), &Progress::new()).unwrap_err();
    assert_eq!(error.to_string(), "tests/../no such folder/b.obj: there is no such file");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("./c.obj");
    std::fs::write(&path, "v 0 0 zero\n").unwrap();
    let error = load(&path, &LoadOptions::default(), &Progress::new()).unwrap_err();
    let begin = format!("{}:1: \"zero\" is not a number", path.display());
    assert!(error.to_string().starts_with(&begin), "{error}");
}

#[test]
fn a_text_of_utf_16_is_read_in_either_order_of_bytes() {
    let text = "\u{FEFF}g \u{e9}\u{4e2d}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let mesh = clean(text);
    assert_eq!(mesh.parts()[0].name, "\u{e9}\u{4e2d}");
    for bytes in [little, big] {
        let loaded = read_bytes(&bytes).unwrap();
        assert_eq!(loaded.findings, []);
        assert!(loaded.model.mesh == mesh);
    }
}

// Faults that are repaired and listed.

#[test]
fn faces_that_cannot_be_are_left_out_and_the_others_stay() {
    let loaded =
        read(&triangle_and("f 1 2 3\nf 1 2 4\nf 0 1 2\nf -9 1 2\nf 1 2\nf 1 x 3\nf 3 2 1\n"));
    let mesh = &loaded.model.mesh;
    assert_eq!([outline(mesh, 0), outline(mesh, 1)], [[0, 1, 2], [2, 1, 0]]);
    let texts: Vec<&str> = loaded.findings.iter().map(|f| f.text.as_str()).collect();
    assert_eq!(
        texts,
        [
            "3 faces refer to vertices that the file does not have and are skipped (first: line 6)",
            "a face has fewer than three corners and is skipped (line 8)",
            "a face has a corner that is not a number (\"x\") and is skipped (line 9)",
        ]
    );
}

#[test]
fn corners_lose_texture_places_and_normals_that_are_not_there() {
    let loaded = read(&triangle_and("vt 0 0\nvn 0 0 1\nf 1/2/1 2/1/-2 3/0/1\n"));
    let uvs: Vec<u32> = loaded.model.mesh.corners().iter().map(|corner| corner.uv).collect();
    assert_eq!(uvs, [NONE, 0, NONE]);
    let found = kinds(&loaded.findings);
    assert_eq!(found[..2], [FindingKind::UvRange, FindingKind::NormalRange]);
}

#[test]
fn faces_that_repeat_a_vertex_or_have_no_area_are_kept_and_listed() {
    let loaded = read(&triangle_and("v 2 0 0\nf 1 2 2\nf 1 2 4\nf 1 2 3\n"));
    assert_eq!(loaded.model.mesh.polygon_count(), 3);
    let counts: Vec<(FindingKind, usize)> =
        loaded.findings.iter().map(|f| (f.kind, f.count)).collect();
    assert_eq!(counts, [(FindingKind::FaceRepeats, 1), (FindingKind::FaceNoArea, 2)]);
}

#[test]
fn unknown_statements_are_passed_over_and_listed_by_name() {
    let loaded = read(&triangle_and("f 1 2 3\ncurv 0 1\nfoo 1\nbar 2\nfoo 3\ns 1\nvp 0 1\n"));
    let found: Vec<(FindingKind, usize)> =
        loaded.findings.iter().map(|f| (f.kind, f.count)).collect();
    use FindingKind::{FreeForm, Unknown};
    assert_eq!(found, [(FreeForm, 2), (Unknown, 1), (Unknown, 2)]);
}

#[test]
fn a_file_of_vertices_alone_is_read_as_points() {
    let loaded = read(TRIANGLE);
    assert_eq!(loaded.model.mesh.stroke_counts(), [0, 3]);
    assert_eq!(only(&loaded).0, FindingKind::OnlyVertices);
    assert!(describe(&loaded).contains("points          3"));
    assert!(describe(&loaded).contains("closed          no: there are no edges"));
}

#[test]
fn work_is_watched_and_cancelled() {
    let text = triangle_and("f 1 2 3\n").repeat(20_000);
    let progress = Progress::new();
    let options = LoadOptions::default();
    parse(text.as_bytes(), "a.obj", None, &options, &progress).unwrap();
    assert!((progress.fraction() - 1.0).abs() < 1e-12);
    progress.cancel();
    let error = parse(text.as_bytes(), "a.obj", None, &options, &progress).unwrap_err();
    assert_eq!(error, LoadError::Cancelled);
}

// The result does not depend on how a file is split into chunks and which reading path is taken.

/// A file of many chunks with every kind of statement: a strip of squares, some with relative
/// indices, some with texture coordinates and normals, and parts and faults in between.
fn long(lines: u32) -> String {
    let mut text = String::new();
    let mut vertices = 0;
    for i in 0..lines {
        text += &match i % 11 {
            0 | 2 | 4 | 6 => {
                vertices += 1;
                let color = if i % 7 == 0 { " 0.5 0.25 1" } else { "" };
                format!("v {}.{i:03} {:e} {}{color}\n", i % 97, f64::from(i) * 1e-3, i % 3)
            }
            1 => format!("vt 0.{i} 1.{i}\n"),
            3 => format!("vn 0 {} 1\n", i % 5),
            5 if i % 13 == 0 => format!("o object {}\n", i % 4),
            5 if i % 5 == 0 => format!("g group {}\n", i % 3),
            5 => format!("usemtl {}\n", i % 2),
            7 if i % 3 == 0 => format!("f -4 -3 -2/-1 -1//-1 # {i}\n"),
            7 => format!("f {} \\\n{}/{} {}\n", i / 11 + 1, i / 11 + 2, i / 11 + 1, i / 11 + 3),
            8 if i % 3 == 0 => format!("f {0}/1/1 {0}/1/1 1/1/1\n", i / 11 + 1),
            8 if i % 101 == 0 => format!("f 1 2 {vertices}000\n\n"),
            8 => format!("f {} {} 1 2\r\n", vertices - 1, vertices),
            9 if i % 17 == 0 => "v nan 0 0\n".to_owned(),
            9 => format!("odd{} 1\n", i % 3),
            _ => "\n".to_owned(),
        };
    }
    text
}

fn described(text: &str) -> (Mesh, Vec<Finding>) {
    let loaded = read(text);
    (loaded.model.mesh, loaded.findings)
}

#[test]
fn a_file_says_the_same_however_many_threads_read_it() {
    let text = long(40_000);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| described(&text))
    };
    let one = with(1);
    assert!(one.0.polygon_count() > 6000 && one.0.parts().len() > 10);
    assert!(one.1.len() > 8, "{:?}", one.1);
    for threads in [2, 7] {
        assert!(
            with(threads) == one,
            "with {threads} threads: {:?} for {:?}",
            with(threads).1,
            one.1
        );
    }
}

#[test]
fn the_quick_way_reads_a_line_like_the_tolerant_way() {
    let text = long(4000);
    // A leading blank sends a line to the tolerant path.
    let slow: String = text.split_inclusive('\n').map(|line| format!(" {line}")).collect();
    let (quick, slow) = (described(&text), described(&slow));
    assert_eq!(quick.1, slow.1);
    assert!(quick.0 == slow.0);
}

#[test]
fn a_line_that_cannot_be_read_is_named_by_its_number_wherever_it_is() {
    let mut text = long(20_000);
    let lines = text.lines().count();
    text += "v 1 2 x\nv 3 4 y\n";
    text += &long(20_000);
    let loaded = read(&text);
    let unreadable = |finding: &&Finding| finding.kind == FindingKind::VertexUnreadable;
    let finding = loaded.findings.iter().find(unreadable).unwrap();
    assert_eq!(finding.line, Some(u32::try_from(lines).unwrap() + 1));
    assert!(finding.text.contains("\"x\" is not a number"), "{}", finding.text);
}

// Files that claim more elements than memory or time allow.

#[test]
fn an_index_promises_nothing() {
    let loaded =
        read(&triangle_and("f 1 2 3\nf 1 2 1000000000\nf 1 2 -1000000000\nf 1 2 99999999999\n"));
    assert_eq!(loaded.model.mesh.polygon_count(), 1);
    let text =
        "3 faces refer to vertices that the file does not have and are skipped (first: line 6)";
    assert_eq!(only(&loaded), (FindingKind::FaceRange, text));
}

#[test]
fn a_face_of_a_million_corners_is_cut_up() {
    // A comb: every second corner is a tooth.
    let corners = 1_000_000_u32;
    let mut text = String::from("v 0 -1 0\nv 1000000 -1 0\n");
    for i in (2..corners).rev() {
        text += &format!("v {i} {} 0\n", if i % 2 == 0 { 1.0 } else { 0.001 });
    }
    text += "f";
    for i in 1..=corners {
        text += &format!(" {i}");
    }
    let (mesh, findings) = described(&text);
    assert_eq!((mesh.polygon_count(), mesh.triangles().len()), (1, 999_998));
    assert_eq!(findings, []);
}

/// The corners of a face without area share the face's normal, which is computed once.
#[test]
fn a_face_of_many_corners_without_area_is_read_as_quickly_as_others() {
    let corners = 200_000_u32;
    for place in [|_: u32| 1, |i: u32| i] {
        let vertices = (0..corners).map(|i| format!("v {} 0 0\n", place(i)));
        let face = (1..=corners).map(|i| format!(" {i}"));
        let text = vertices.chain(["f".to_owned()]).chain(face).collect::<String>();
        let (mesh, findings) = described(&text);
        assert_eq!(mesh.triangles().len(), corners as usize - 2);
        assert_eq!(kinds(&findings), [FindingKind::FaceNoArea]);
    }
}

#[test]
fn a_line_without_end_is_refused_in_a_short_message() {
    for text in ["x".repeat(5_000_000), format!("v 0 0 {}", "9x".repeat(2_500_000))] {
        let message = refusal(&text);
        assert!(message.len() < 200, "{} signs", message.len());
    }
    let numbers = format!("v{}\n", " 1".repeat(2_000_000));
    assert_eq!(
        kinds(&read(&numbers).findings),
        [FindingKind::ExtraNumbers, FindingKind::OnlyVertices]
    );
}

#[test]
fn parts_and_names_without_end_are_read_as_quickly_as_others() {
    let mut text = String::from(TRIANGLE);
    for i in 0..100_000 {
        text += &format!("usemtl {i}\nf 1 2 3\nunknown{i}\n");
    }
    let (mesh, findings) = described(&text);
    assert_eq!(mesh.parts().len(), 100_000);
    assert!(findings.len() < 300, "{} findings", findings.len());
}

#[test]
fn a_vertex_with_a_hundred_thousand_normals_keeps_them_all() {
    let mut text = String::from(TRIANGLE);
    for i in 1..=100_000 {
        text += &format!("vn {i} 1 0\nf 1//{i} 2//{i} 3//{i}\n");
    }
    let (mesh, _) = described(&text);
    let normal =
        |corner: &marraztu_core::scene::Corner| mesh.points()[corner.filed as usize].normal;
    assert_eq!(mesh.points().len(), 300_003);
    let [x, y, _] = normal(&mesh.polygon(49_999)[0]);
    assert!((x / y - 50_000.0).abs() < 1.0, "{x} / {y}");
}

proptest! {
    /// Random statements, half of them nonsense, are rejected or loaded without a panic.
    #[test]
    fn no_text_breaks_the_reader(
        lines in prop::collection::vec(
            prop_oneof![
                "(v|vt|vn|f|l|p|o|g|usemtl|c|#|s)( [-+0-9./eE#a]{1,6}){0,8}",
                "v( -?[0-9]\\.[0-9]){3,7}",
                "f( [1-9](/[1-9]?){0,2}){3,7}",
                "f( -[1-9]){3,7}",
                "[ -~]{0,12}\\\\?",
            ],
            0..40,
        ),
        ending in prop_oneof![Just("\n"), Just("\r\n"), Just("\r"), Just("\\\n")],
    ) {
        if let Ok(loaded) = read_bytes(lines.join(ending).as_bytes()) {
            let text = describe(&loaded);
            prop_assert!(text.starts_with("name"));
        }
    }

    #[test]
    fn no_bytes_break_the_reader(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        if let Ok(loaded) = read_bytes(&bytes) {
            prop_assert!(!loaded.model.mesh.positions().is_empty());
        }
    }

    /// Every element of a file keeps its value and its index.
    #[test]
    fn whatever_the_faces_use_everything_keeps_its_number(
        vertices in prop::collection::vec(prop::array::uniform3(-1e3..1e3_f32), 3..30),
        uvs in prop::collection::vec(prop::array::uniform2(-2.0..2.0_f32), 0..30),
        faces in prop::collection::vec(
            prop::collection::vec((0..1000_usize, 0..1000_usize), 3..6),
            1..30,
        ),
    ) {
        // Writes the file; some corners have no texture coordinates.
        let mut text = String::new();
        for [x, y, z] in &vertices {
            text += &format!("v {x} {y} {z}\n");
        }
        for [u, v] in &uvs {
            text += &format!("vt {u} {v}\n");
        }
        for face in &faces {
            text.push('f');
            for (v, t) in face {
                text += &format!(" {}", v % vertices.len() + 1);
                if !uvs.is_empty() && t % 3 > 0 {
                    text += &format!("/{}", t % uvs.len() + 1);
                }
            }
            text.push('\n');
        }
        let mesh = read(&text).model.mesh;
        // Positions and indices equal the written ones.
        prop_assert_eq!(mesh.positions(), &vertices[..]);
        for (polygon, face) in faces.iter().enumerate() {
            let corners = mesh.polygon(u32::try_from(polygon).unwrap());
            prop_assert_eq!(corners.len(), face.len());
            for (corner, (v, t)) in corners.iter().zip(face) {
                prop_assert_eq!(corner.position as usize, v % vertices.len());
                let uv = (corner.uv != NONE).then(|| mesh.uvs()[corner.uv as usize]);
                let named = !uvs.is_empty() && t % 3 > 0;
                prop_assert_eq!(uv, named.then(|| uvs[t % uvs.len()]));
            }
        }
    }
}
