//! MTL files and textures that an OBJ file names: how they are found, and the report if they are
//! missing.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{LoadOptions, MapKind, Wrap};
use marraztu_io::{Finding, FindingKind, Loaded, Progress, load, save_picture};

/// Kind and text of the only finding of a file.
fn only(loaded: &Loaded) -> (FindingKind, &str) {
    let [finding] = &loaded.findings[..] else { panic!("{:?}", loaded.findings) };
    (finding.kind, &finding.text)
}

fn kinds(findings: &[Finding]) -> Vec<FindingKind> {
    findings.iter().map(|finding| finding.kind).collect()
}

/// Loads an OBJ file with this text, next to an MTL file and a texture in a subfolder.
fn with_files(obj: &str, mtl: (&str, &str)) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{obj}")).unwrap();
    std::fs::create_dir(folder.path().join("Maps")).unwrap();
    std::fs::write(folder.path().join(mtl.0), mtl.1).unwrap();
    let picture = Picture::filled(Size::new(1, 2), [1, 2, 3, 200]);
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
    let texts: Vec<&str> = loaded.findings.iter().map(|finding| finding.text.as_str()).collect();
    assert_eq!(
        texts,
        [
            "the material file \"x.mtl\" was not found (line 4)",
            "the material file \"y.mtl\" was not found (line 4)",
            "the material \"blue\" is not defined: silver is used (line 5)",
        ]
    );
    let source = loaded.model.source.as_ref().unwrap();
    assert_eq!(loaded.findings[0].file, source.display().to_string());
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
        let loaded =
            with_files("mtllib m.mtl\nusemtl red\nvt 0 0\nf 1/1 2/1 3/1\n", ("m.mtl", &mtl));
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
    let (kind, text) = only(&loaded);
    assert_eq!(kind, FindingKind::TextureUnreadable);
    let path = loaded.model.source.as_ref().unwrap().display();
    let reason = "this is not a PNG, JPEG, WebP, TIFF, BMP, TGA or GIF (line 5)";
    assert_eq!(text, format!("the texture cannot be read: {path}: {reason}"));
}

/// Loads three materials with these statements of opacity, two of them used. Returns the opacity of
/// the first, and the findings.
fn with_opacities(given: [&str; 3]) -> (f64, Vec<(FindingKind, usize)>) {
    let material = |(name, given): (&str, &str)| format!("{}{given}\n", RED.replace("red", name));
    let mtl: String = ["a", "b", "c"].into_iter().zip(given).map(material).collect();
    let obj = "mtllib m.mtl\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n";
    let loaded = with_files(obj, ("m.mtl", &mtl));
    let found = loaded.findings.iter().map(|finding| (finding.kind, finding.count)).collect();
    (loaded.model.materials[0].opacity, found)
}

#[test]
fn an_opacity_that_hides_all_used_materials_is_1_and_else_0() {
    use FindingKind::{MendedContradiction, MendedTransparency, Transparent};
    let rows = [
        (["Tr 1.0", "Tr 1", "Tr 1.0"], 1.0, vec![(MendedTransparency, 3)]),
        (["d 0", "d 0.000", "d 0"], 1.0, vec![(MendedTransparency, 3)]),
        (["d 0", "Tr 1", "d 1"], 1.0, vec![(MendedTransparency, 2)]),
        // Unused materials do not count as evidence for a convention.
        (["Tr 1.0", "Tr 1", "d 0.5"], 1.0, vec![(MendedTransparency, 2)]),
        (["Tr 1.0", "Tr 0", "Tr 0"], 0.0, vec![(Transparent, 1)]),
        (["Tr 1.0", "d 1", "d 1"], 0.0, vec![(Transparent, 1)]),
        (["d 0", "d 1", "d 1"], 0.0, vec![(Transparent, 1)]),
        (["d 0\nTr 1", "d 1", "d 1"], 0.0, vec![(Transparent, 1)]),
        (["Tr 1", "Tr 0.9", "Tr 0.1"], 0.0, vec![(Transparent, 1)]),
        (["Tr 0.75", "Tr 0.9", "Tr 0.1"], 0.25, Vec::new()),
        // One of the two statements is meant the other way.
        (["d 0\nTr 0", "d 1", "d 1"], 1.0, vec![(MendedContradiction, 1)]),
        (["Tr 0.0\nd 0", "Tr 0.0\nd 0", "d 1"], 1.0, vec![(MendedContradiction, 2)]),
    ];
    for (given, opacity, findings) in rows {
        assert_eq!(with_opacities(given), (opacity, findings), "{given:?}");
    }
}

#[test]
fn the_same_fault_in_many_files_is_one_finding_with_the_first_line() {
    let folder = tempfile::tempdir().unwrap();
    let mut obj = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    for i in 0..7 {
        let mtl = format!("# by hand\nnewmtl a{i}\nKd 1 0 0\nnewmtl b{i}\nKd 0 1 0\n");
        std::fs::write(folder.path().join(format!("{i}.mtl")), mtl).unwrap();
        obj += &format!("mtllib {i}.mtl\nusemtl a{i}\nf 1 2 3\n");
    }
    let path = folder.path().join("a.obj");
    std::fs::write(&path, obj).unwrap();
    let loaded = load(&path, &LoadOptions::default(), &Progress::new()).unwrap();
    let texts: Vec<String> = loaded.findings.iter().map(ToString::to_string).collect();
    let first = folder.path().join("0.mtl").display().to_string();
    assert_eq!(
        texts,
        [
            format!(
                "{first}: 14 materials: Ka is missing, white, above 1 or equal to Kd, and is \
                 taken as 0.2 Kd (first: line 2; 7 files)"
            ),
            format!(
                "{first}: 14 materials: Ks is missing or switched off by illum, and is taken as 0 \
                 (first: line 2; 7 files)"
            ),
        ]
    );
}

#[test]
fn a_picture_that_many_textures_show_is_read_once() {
    let folder = tempfile::tempdir().unwrap();
    let picture = Picture::filled(Size::new(2, 2), [1, 2, 3, 255]);
    save_picture(&folder.path().join("a.png"), &picture).unwrap();
    let mut obj = String::from("mtllib a.mtl b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    for file in ["a", "b"] {
        let mut mtl = String::new();
        for i in 0..3 {
            mtl += &RED.replace("red", &format!("{file}{i}"));
            mtl += &format!("map_Kd -o 0.{i} ./a.png\n");
            obj += &format!("usemtl {file}{i}\nf 1 2 3\n");
        }
        std::fs::write(folder.path().join(format!("{file}.mtl")), mtl).unwrap();
    }
    let path = folder.path().join("a.obj");
    std::fs::write(&path, obj).unwrap();
    let loaded = load(&path, &LoadOptions::default(), &Progress::new()).unwrap();
    let textures = loaded.model.materials.iter().map(|material| material.texture.clone().unwrap());
    let textures: Vec<_> = textures.collect();
    assert_eq!(textures.len(), 6);
    assert_eq!(textures[5].offset, [0.2, 0.0]);
    assert!(textures.iter().all(|texture| Shared::same(&texture.picture, &textures[0].picture)));
}

#[test]
fn a_material_file_in_utf_16_is_read_and_one_that_is_not_text_is_listed() {
    let units = || "\u{FEFF}".encode_utf16().chain(RED.encode_utf16());
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib m.mtl\nusemtl red\nf 1 2 3\n";
    let with = |mtl: Vec<u8>| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, obj).unwrap();
        std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
        load(&path, &LoadOptions::default(), &Progress::new()).unwrap()
    };
    for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        let loaded = with(units().flat_map(bytes).collect());
        assert_eq!(loaded.findings, []);
        assert_eq!(loaded.model.materials[0].material.diffuse, [0.5, 0.0, 0.0]);
    }
    let loaded = with(units().skip(1).flat_map(u16::to_le_bytes).collect());
    assert_eq!(kinds(&loaded.findings), [FindingKind::MaterialUnknown, FindingKind::MtlUnreadable]);
    assert!(loaded.findings.iter().all(|finding| !finding.text.contains('\0')));
}

#[test]
#[cfg(target_os = "linux")]
fn material_files_and_textures_that_are_pipes_are_listed_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let make_pipe = |name: &str| {
        let path = folder.path().join(name);
        assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
    };
    make_pipe("p.mtl");
    make_pipe("p.png");
    let mtl = format!("{RED}map_Kd p.png\n");
    std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    let path = folder.path().join("a.obj");
    let obj = "mtllib p.mtl\nmtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    std::fs::write(&path, obj).unwrap();
    let loaded = load(&path, &LoadOptions::default(), &Progress::new()).unwrap();
    assert_eq!(
        kinds(&loaded.findings),
        [FindingKind::MtlUnreadable, FindingKind::TextureUnreadable]
    );
    let is_said = |finding: &Finding| finding.text.contains("this is a pipe, not a file");
    assert!(loaded.findings.iter().all(is_said), "{:?}", loaded.findings);
}

#[test]
fn maps_are_read_with_their_options_and_one_picture_is_held_once() {
    let maps = "map_Ka Maps/wood 1.png\nmap_Ks -s 2 3 Maps/wood 1.png\n\
                map_Ns -t 1 2 3 Maps/wood 1.png\nmap_d -clamp on Maps/wood 1.png\n\
                map_Ke -o 0.5 Maps/wood 1.png\nmap_Bump Maps/wood 1.png -bm 0.25\n\
                norm Maps/wood 1.png\nmap_Kd Maps/wood 1.png\ndisp Maps/wood 1.png\n";
    let red = format!("{RED}Ke 0.5 2 0\nillum 0\n{maps}");
    let loaded = with_files("mtllib a.mtl\nusemtl red\nvt 0 0\nf 1/1 2/1 3/1\n", ("a.mtl", &red));
    let expected = [FindingKind::MapUnused, FindingKind::MapOption];
    assert_eq!(kinds(&loaded.findings), expected, "{:?}", loaded.findings);
    let material = &loaded.model.materials[0];
    assert_eq!((material.material.emission, material.unlit), ([0.5, 2.0, 0.0], true));
    // A texture is a height map or a normal map, not both; the statement decides.
    let kinds = MapKind::ALL.into_iter().filter(|kind| *kind != MapKind::Bump);
    assert!(material.maps.keys().copied().eq(kinds));
    let texture = material.texture.as_ref().unwrap();
    for (kind, map) in &material.maps {
        assert!(Shared::same(&map.texture.picture, &texture.picture), "{kind:?}");
    }
    let map = |kind| &material.maps[&kind];
    assert!(Shared::same(&map(MapKind::Ambient).texture, texture), "with the same options");
    assert_eq!(map(MapKind::Specular).texture.scale, [2.0, 3.0]);
    assert_eq!(map(MapKind::Emission).texture.offset, [0.5, 0.0]);
    assert_eq!(map(MapKind::Opacity).texture.wrap, Wrap::Clamp);
    assert_eq!(map(MapKind::Normal).gain, 1.0);
    let heights = format!("{RED}map_Bump Maps/wood 1.png -bm 0.25\n");
    let loaded =
        with_files("mtllib a.mtl\nusemtl red\nvt 0 0\nf 1/1 2/1 3/1\n", ("a.mtl", &heights));
    assert_eq!(loaded.model.materials[0].maps[&MapKind::Bump].gain, 0.25);
}

#[test]
fn a_light_or_a_highlight_that_is_only_mapped_is_taken_as_white() {
    let read = |statements: &str| {
        let text = format!("newmtl red\nKa 0.1 0 0\nKd 0.5 0 0\nNs 9\n{statements}");
        let loaded =
            with_files("mtllib a.mtl\nusemtl red\nvt 0 0\nf 1/1 2/1 3/1\n", ("a.mtl", &text));
        let mut kinds = kinds(&loaded.findings);
        kinds.sort_unstable();
        (loaded.model.materials[0].material, kinds)
    };
    let (material, found) = read("map_Ke Maps/wood 1.png\nmap_Ks Maps/wood 1.png\n");
    assert_eq!((material.emission, material.specular), ([1.0; 3], [1.0; 3]));
    assert_eq!(found, [FindingKind::MendedEmission, FindingKind::MendedMapped]);
    let (material, found) = read("Ks 0 0 0\nKe 0 0 0\nillum 7\nmap_Ke Maps/wood 1.png\n");
    assert_eq!((material.emission, material.specular), ([0.0; 3], [0.0; 3]));
    assert_eq!(found, []);
}
