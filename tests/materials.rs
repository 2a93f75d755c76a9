//! The material files and textures that an OBJ file names: whether they are found, and what is said
//! where they are not.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use marraztu::base::image::{Picture, Size};
use marraztu::io::{Finding, FindingKind, Loaded, Progress, load, save_picture};
use marraztu::scene::{LoadOptions, Wrap};

/// The only finding of a file, as text, with its kind.
fn only(loaded: &Loaded) -> (FindingKind, &str) {
    let [finding] = &loaded.findings[..] else { panic!("{:?}", loaded.findings) };
    (finding.kind, &finding.text)
}

fn kinds(findings: &[Finding]) -> Vec<FindingKind> {
    findings.iter().map(|finding| finding.kind).collect()
}

/// A folder with an OBJ file of this text, an MTL file, and a texture in a folder of its own.
fn with_files(obj: &str, mtl: (&str, &str)) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{obj}")).unwrap();
    std::fs::create_dir(folder.path().join("Maps")).unwrap();
    std::fs::write(folder.path().join(mtl.0), mtl.1).unwrap();
    let picture = Picture::filled(Size::new(1, 2), [1, 2, 3, 255]);
    save_picture(&folder.path().join("Maps/wood 1.png"), &picture).unwrap();
    load(&path, &LoadOptions::default(), &Progress::new()).unwrap()
}

const RED: &str = "newmtl red\nKa 0.1 0 0\nKd 0.5 0 0\nKs 0 0 0\n";

#[test]
fn a_material_is_found_under_names_with_blanks_and_in_any_order_of_statements() {
    for (line, file) in [
        ("mtllib a b.mtl", "a b.mtl"),
        ("mtllib none.mtl a b.mtl other.mtl", "a b.mtl"),
        ("mtllib \"a b.mtl\"", "a b.mtl"),
        ("mtllib C:\\models\\A.MTL # from there", "a.mtl"),
    ] {
        let loaded = with_files(&format!("usemtl red\nf 1 2 3\n{line}\n"), (file, RED));
        assert_eq!(loaded.model.materials.len(), 1, "{line}: {:?}", loaded.findings);
        assert_eq!(loaded.model.mesh.parts()[0].material, Some(0), "{line}");
        let missing = kinds(&loaded.findings);
        assert!(missing.iter().all(|kind| *kind == FindingKind::MtlMissing), "{missing:?}");
        assert_eq!(missing.len(), if line.contains("none") { 2 } else { 0 }, "{line}");
    }
}

#[test]
fn missing_materials_and_files_are_listed() {
    let loaded = with_files("mtllib x.mtl y.mtl\nusemtl blue\nf 1 2 3\n", ("z.mtl", RED));
    let texts: Vec<String> = loaded.findings.iter().map(ToString::to_string).collect();
    assert_eq!(
        texts,
        [
            "a.obj: the material file \"x.mtl\" was not found (line 4)",
            "a.obj: the material file \"y.mtl\" was not found (line 4)",
            "a.obj: the material \"blue\" is not known: silver is taken (line 5)",
        ]
    );
}

#[test]
fn a_material_and_its_use_may_both_have_no_name() {
    let mtl = RED.replace("newmtl red", "newmtl");
    let loaded = with_files("mtllib m.mtl\nusemtl\nf 1 2 3\n", ("m.mtl", &mtl));
    assert_eq!(loaded.model.mesh.parts()[0].material, Some(0));
    assert_eq!(loaded.findings, []);
}

#[test]
fn a_texture_is_found_by_back_slashes_by_its_last_name_and_in_another_case() {
    for name in ["Maps\\wood 1.png", ".\\\\maps\\\\WOOD 1.PNG", "maps/wood 1.png"] {
        let mtl = format!("{RED}map_Kd -clamp on -o 0.5 -s 2 3 {name}\n");
        let loaded = with_files("mtllib m.mtl\nusemtl red\nf 1 2 3\n", ("m.mtl", &mtl));
        assert_eq!(loaded.findings, [], "{name}");
        let texture = loaded.model.materials[0].texture.clone().unwrap();
        assert_eq!(texture.picture.size(), Size::new(1, 2));
        assert_eq!((texture.wrap, texture.offset), (Wrap::Clamp, [0.5, 0.0]));
        assert_eq!(texture.scale, [2.0, 3.0]);
    }
}

#[test]
fn a_texture_that_is_missing_or_broken_is_listed_and_the_model_stays() {
    let mtl = format!("{RED}map_Kd none.png\n");
    let loaded = with_files("mtllib m.mtl\nusemtl red\nf 1 2 3\n", ("m.mtl", &mtl));
    assert_eq!(
        only(&loaded),
        (FindingKind::TextureMissing, "the texture \"none.png\" was not found (line 5)")
    );
    let mtl = format!("{RED}map_Kd a.obj\n");
    let loaded = with_files("mtllib m.mtl\nusemtl red\nf 1 2 3\n", ("m.mtl", &mtl));
    assert_eq!(
        only(&loaded),
        (
            FindingKind::TextureUnreadable,
            "the texture cannot be read: a.obj: this is no PNG, JPEG, BMP, TGA or GIF (line 5)"
        )
    );
}
