//! Numbers, blanks, continuations and names in unusual spellings.

use super::*;

#[track_caller]
fn same_shape(text: &str, finding: &str) {
    let folder = Folder::with(&[("odd.obj", text), ("plain.obj", CUBE)]);
    let info = folder.info("odd.obj");
    assert!(info.contains(finding), "{finding}: {info}");
    assert!(folder.drawn(&["odd.obj"]) == folder.drawn(&["plain.obj"]), "{text}");
}

#[test]
fn odd_numbers_are_read_with_a_finding() {
    for odd in ["-1D0", "-1.0d+00", "-1,0", "-1f", "\u{2212}1", "-1;", "-10E-1,", "-0.1Q1"] {
        same_shape(&CUBE.replacen("v -1 -1 -1", &format!("v {odd} -1 -1"), 1), "unusual way");
    }
}

#[test]
fn control_characters_are_blanks() {
    for odd in ["\u{b}", "\u{c}", "\0", "\u{b}\u{c} "] {
        same_shape(&CUBE.replacen("v 1 -1 -1", &format!("v{odd}1{odd}-1 -1"), 1), "control");
        same_shape(&CUBE.replacen("f 1 3 4 2", &format!("f 1{odd}3 4 2"), 1), "control");
    }
    let folder =
        Folder::with(&[("end.obj", &format!("{CUBE}\0\0\0")), ("nul.obj", &format!("{CUBE}\0"))]);
    for name in ["end.obj", "nul.obj"] {
        assert!(folder.info(name).contains("control characters"), "{name}");
    }
    let binary: String = (0_u8..128).map(char::from).cycle().take(4096).collect();
    let folder = Folder::with(&[("binary.obj", &binary)]);
    assert!(folder.ends(1, &["info", "binary.obj"]).contains("not text"));
}

#[test]
fn a_number_that_cannot_be_read_costs_its_faces_and_not_the_file() {
    let folder = Folder::with(&[
        ("a.obj", &CUBE.replacen("v 1 1 1", "v 1 what 1", 1)),
        ("short.obj", &CUBE.replacen("v 1 1 1", "v 1 1", 1)),
        ("none.obj", "v a b c\nv 1 2\nv x\nf 1 2 3\n"),
        ("uv.obj", &format!("{SQUARE}vt what 0\nvn 1 2\n")),
    ]);
    let info = folder.info("a.obj");
    assert!(info.contains("\"what\" is not a number") && info.contains("(line 8)"), "{info}");
    assert!(info.contains("3 faces refer to skipped vertices"), "{info}");
    assert!(folder.info("short.obj").contains("a vertex needs three numbers, but has 2"));
    let told = folder.ends(1, &["info", "none.obj"]);
    assert!(told.contains("none.obj:1: \"a\" is not a number"), "{told}");
    let info = folder.info("uv.obj");
    assert!(info.contains("a texture coordinate cannot be read"), "{info}");
    assert!(info.contains("a normal cannot be read"), "{info}");
}

#[test]
fn a_backslash_does_not_swallow_a_statement() {
    let comment = format!("# exported to C:\\out\\\n{CUBE}");
    let folder = Folder::with(&[("a.obj", &comment), ("plain.obj", CUBE)]);
    assert!(folder.drawn(&["a.obj"]) == folder.drawn(&["plain.obj"]));
    for (statement, red) in [
        ("g dir\\", "newmtl m\\\nKd 1 0 0\n"),
        ("o dir\\  ", "newmtl m\\\nd 1\nKd 1 0 0\n"),
        ("usemtl x\\", "newmtl m\\\nPr 1\nKd 1 0 0\n"),
    ] {
        let text = SQUARE.replace("usemtl m\n", &format!("{statement}\nusemtl m\n"));
        let folder = Folder::with(&[("a.obj", &text), ("a.mtl", red), ("plain.obj", SQUARE)]);
        let info = folder.info("a.obj");
        assert!(info.contains("ends in a backslash"), "{info}");
        assert!(folder.drawn(&["a.obj"]) == folder.drawn(&["plain.obj"]), "{statement}");
    }
    // Continued lines form one statement.
    let long = CUBE.replace("f 1 3 4 2", "f 1 3 \\\n4 2").replace("v 1 1 1", "v 1 \\\n1 \\\n1");
    let folder = Folder::with(&[("a.obj", &long), ("plain.obj", CUBE)]);
    assert!(folder.drawn(&["a.obj"]) == folder.drawn(&["plain.obj"]));
}

#[test]
fn files_are_found_by_escaped_decomposed_and_encoded_names() {
    for (named, file) in [
        ("my\\ wood.png", "my wood.png"),
        ("my%20wood.png", "my wood.png"),
        ("Cafe\u{301}.png", "Caf\u{e9}.png"),
    ] {
        let mtl = format!("newmtl m\nmap_Kd {named}\n");
        let folder = Folder::with(&[("a.obj", SQUARE), ("a.mtl", &mtl)]);
        folder.picture(file, 2, |_, _| [200, 100, 50, 255]);
        let info = folder.info("a.obj");
        assert!(!info.contains("not found"), "{named}: {info}");
    }
}
