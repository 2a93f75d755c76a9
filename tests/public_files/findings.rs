//! Every unsupported or missing feature of a file is among the findings.

use super::*;

#[test]
fn bodies_inside_out_and_normals_against_the_winding_are_found() {
    let turned: String = CUBE
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(corners) => {
                let corners: Vec<&str> = corners.split(' ').rev().collect();
                format!("f {}\n", corners.join(" "))
            }
            None => format!("{line}\n"),
        })
        .collect();
    let folder = Folder::with(&[
        ("winding.obj", &turned),
        ("plain.obj", CUBE),
        ("normals.obj", &format!("{SQUARE}vn 0 0 -1\nf 1//1 2//1 3//1\n")),
    ]);
    let info = folder.info("winding.obj");
    assert!(info.contains("inside out; --flip-winding"), "{info}");
    assert!(!folder.ends(0, &["info", "--flip-winding", "winding.obj"]).contains("inside out"));
    assert!(!folder.info("plain.obj").contains("inside out"));
    let info = folder.info("normals.obj");
    assert!(
        info.contains("the normals of a face point against") && info.contains("--no-file-normals")
    );
}

#[test]
fn materials_and_pictures_that_nothing_uses_are_found() {
    let mtl = "newmtl m\nKd 1 0 0\nmap_Kd t.png\n";
    let without = SQUARE.replace("usemtl m\n", "");
    let finding = |obj: &str, files: &[(&str, &str)]| {
        let folder = Folder::with(&[&[("model.obj", obj)], files].concat());
        folder.picture("t.png", 2, |_, _| [255; 4]);
        folder.info("model.obj")
    };
    let info = finding(&without, &[("a.mtl", mtl)]);
    assert!(info.contains("no face names a material"), "{info}");
    let info = finding(SQUARE, &[("model.mtl", mtl)]);
    assert!(info.contains("the one with the model's name is used"), "{info}");
    assert!(!info.contains("silver"), "{info}");
    // Only the first missing file is replaced, and not by a file that the model names itself.
    let named = |names: &str| SQUARE.replace("a.mtl", names);
    let info = finding(&named("a.mtl b.mtl"), &[("model.mtl", mtl)]);
    assert!(
        info.contains("\"a.mtl\" was not found; the one with the model's name is used"),
        "{info}"
    );
    assert!(info.contains("\"b.mtl\" was not found (line 1)"), "{info}");
    let info = finding(&named("b.mtl model.mtl c.mtl"), &[("model.mtl", mtl)]);
    for name in ["b.mtl", "c.mtl"] {
        assert!(info.contains(&format!("\"{name}\" was not found (line 1)")), "{info}");
    }
    let info = finding(&SQUARE.replace("mtllib a.mtl\n", ""), &[("model.mtl", mtl)]);
    assert!(info.contains("names materials but no material file; \"model.mtl\" is used"), "{info}");
    let info = finding(CUBE, &[("model.mtl", mtl)]);
    assert!(info.contains("\"model.mtl\" is not used"), "{info}");
    let folder = Folder::with(&[("t.obj", CUBE)]);
    folder.picture("t.png", 2, |_, _| [255; 4]);
    assert!(folder.info("t.obj").contains("the picture \"t.png\" is not used"));
    assert!(finding(SQUARE, &[]).contains("the material file \"a.mtl\" was not found"));
}

#[test]
fn textures_that_cannot_be_seen_are_found() {
    let unmapped = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\n";
    let folder = Folder::with(&[
        ("black.obj", SQUARE),
        ("a.mtl", "newmtl m\nKd 0 0 0\nmap_Kd t.png\n"),
        ("unmapped.obj", unmapped),
    ]);
    folder.picture("t.png", 2, |_, _| [255; 4]);
    assert!(folder.info("black.obj").contains("Kd 0 makes its texture black"));
    let info = folder.info("unmapped.obj");
    assert!(info.contains("the texture t.png of material \"m\" is not shown"), "{info}");
    let told = folder.ends(
        0,
        &["render", "unmapped.obj", "--texture", "t.png", "--size", "8", "--out", "p.png"],
    );
    assert!(told.contains("t.png is not shown on unmapped"), "{told}");
}

#[test]
fn comments_with_colours_of_zbrush_are_found() {
    let text = format!("#MRGB ffff0000ffff0000\n{CUBE}");
    let folder = Folder::with(&[("a.obj", &text)]);
    assert!(folder.info("a.obj").contains("a comment #MRGB (vertex colours of ZBrush) is ignored"));
}

#[test]
fn pointers_of_git_lfs_are_named_wherever_a_file_is_read() {
    const POINTER: &str = "version https://git-lfs.github.com/spec/v1\noid sha256:\
        4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 12345\n";
    let folder = Folder::with(&[
        ("a.obj", POINTER),
        ("a.obj.gz", POINTER),
        ("a.stl", POINTER),
        ("a.marraztu", POINTER),
        ("unnamed", POINTER),
        ("b.obj", SQUARE),
        ("a.mtl", POINTER),
    ]);
    for name in ["a.obj", "a.obj.gz", "a.stl", "a.marraztu", "unnamed"] {
        let told = folder.ends(1, &["info", name]);
        assert!(told.contains("Git LFS pointer") && told.contains("git lfs pull"), "{told}");
    }
    let info = folder.info("b.obj");
    assert!(info.contains("the material file cannot be read: this is a Git LFS pointer"), "{info}");
    // Textures of a repository without its contents are one finding.
    let mtl = "newmtl m\nKd 1 1 1\nmap_Kd 0.png\nmap_Ks 1.png\nmap_Ke 2.jpg\n";
    let folder = Folder::with(&[
        ("b.obj", SQUARE),
        ("a.mtl", mtl),
        ("0.png", POINTER),
        ("1.png", POINTER),
        ("2.jpg", POINTER),
    ]);
    let info = folder.info("b.obj");
    assert_eq!(info.matches("Git LFS").count(), 1, "{info}");
    assert!(info.contains("3 textures (the first: \"0.png\") are Git LFS pointers"), "{info}");
}

#[test]
fn repairs_of_many_materials_are_one_finding_each() {
    let folder = Folder::with(&[]);
    folder.picture("n.png", 32, |x, y| {
        let tilt = |i: usize| u8::try_from(118 + 20 * (i % 2)).unwrap();
        [tilt(x), tilt(y), 254, 255]
    });
    let (mut obj, mut mtl) =
        (String::from("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"), String::new());
    for i in 0..30 {
        obj += &format!("g a{i}\nusemtl m{i}\nf 1 2 3\ng b{i}\nusemtl none{i}\nf 1 2 3\n");
        mtl += &format!(
            "newmtl m{i}\nKa 1 1 1\nKd 40.5 2 1\nKs 1 1 1\nNs 0.5\nd 0\nTr 0\nillum 7\n\
             map_Kd n.png\nmap_d n.png\nmap_Bump n.png\nnewmtl m{i}\nKd 1 1 1\n"
        );
    }
    std::fs::write(folder.at("a.obj"), obj).unwrap();
    std::fs::write(folder.at("a.mtl"), mtl).unwrap();
    let info = folder.info("a.obj");
    let findings: Vec<&str> =
        info.lines().skip_while(|line| !line.starts_with("findings")).collect();
    assert!(findings.len() < 14, "{}", findings.join("\n"));
    for text in [
        "30 materials (the first: \"none0\") are not defined",
        "30 definitions repeat earlier ones",
        "30 bump maps (the first: \"n.png\") show normals",
        "the textures of 30 materials",
        "30 materials: d 0 contradicts Tr 0",
    ] {
        assert!(info.contains(text), "{text}: {info}");
    }
}
