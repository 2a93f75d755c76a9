//! Written files: no input is replaced, and formats keep their promises.

use std::fs;

use super::*;

/// A folder with the inputs of a scene: scene file, models, MTL files and a texture.
fn inputs() -> (Folder, Vec<String>) {
    let folder = Folder::with(&[
        ("room.obj", &SQUARE.replace("a.mtl", "room.mtl")),
        ("room.mtl", "newmtl m\nKd 1 1 1\nmap_Kd t.png\nmap_Ks s.png\n"),
        ("a.obj", &SQUARE.replace("a.mtl", "room.mtl")),
    ]);
    folder.picture("t.png", 2, |_, _| [200, 100, 50, 255]);
    folder.picture("s.png", 2, |_, _| [255; 4]);
    let scene = "(version: 1, objects: [(id: 1, name: \"r\", model: File(path: \"room.obj\"))], \
                 cameras: [(id: 2, name: \"c\")], lights: [], view: (object: Some(1), camera: 2))";
    fs::write(folder.at("room.marraztu"), scene).unwrap();
    let files = ["room.obj", "room.mtl", "a.obj", "t.png", "s.png", "room.marraztu"];
    (folder, files.map(str::to_owned).to_vec())
}

#[test]
fn no_command_replaces_a_file_that_it_has_read() {
    let (folder, files) = inputs();
    let before: Vec<Vec<u8>> = files.iter().map(|name| folder.read(name)).collect();
    #[cfg(unix)]
    std::os::unix::fs::symlink("room.obj", folder.at("link.obj")).unwrap();
    let commands: [&[&str]; 12] = [
        &["export", "room.marraztu", "--out", "room.obj"],
        &["export", "room.marraztu", "--out", "./room.obj"],
        &["export", "room.marraztu", "--out", "link.obj"],
        &["export", "a.obj", "--out", "room.obj"],
        &["export", "room.obj", "--out", "room.obj"],
        &["export", "a.obj", "--out", "a.obj"],
        &["render", "room.marraztu", "--out", "t.png"],
        &["render", "a.obj", "--out", "s.png"],
        &["turntable", "a.obj", "--out", "t.png", "--frames", "2", "--size", "8"],
        &["turntable", "room.marraztu", "--out", "s.png", "--frames", "2", "--size", "8"],
        &["render", "a.obj", "--texture", "t.png", "--out", "t.png"],
        &["lab", "room.marraztu", "--quick", "--size", "8x8", "--out", "lab"],
    ];
    // The laboratory writes into a folder that contains a file of the scene.
    fs::create_dir(folder.at("lab")).unwrap();
    fs::rename(folder.at("s.png"), folder.at("lab/ideal.png")).unwrap();
    fs::write(folder.at("room.mtl"), "newmtl m\nKd 1 1 1\nmap_Kd t.png\nmap_Ks lab/ideal.png\n")
        .unwrap();
    let mtl = folder.read("room.mtl");
    for command in commands {
        let own = command.iter().map(|word| if *word == "s.png" { "lab/ideal.png" } else { word });
        let told = folder.ends(1, &own.collect::<Vec<_>>());
        assert!(told.contains("is an input"), "{command:?}: {told}");
    }
    for (name, before) in files.iter().zip(&before) {
        match name.as_str() {
            "s.png" => assert_eq!(folder.read("lab/ideal.png"), *before),
            "room.mtl" => assert_eq!(folder.read("room.mtl"), mtl),
            name => assert_eq!(folder.read(name), *before, "{name}"),
        }
    }
}

#[test]
fn a_folder_of_frames_does_not_replace_a_texture() {
    let folder =
        Folder::with(&[("a.obj", SQUARE), ("a.mtl", "newmtl m\nmap_Kd frames/frame-002.png\n")]);
    fs::create_dir(folder.at("frames")).unwrap();
    folder.picture("frames/frame-002.png", 2, |_, _| [1, 2, 3, 255]);
    let before = folder.read("frames/frame-002.png");
    let turn = ["turntable", "a.obj", "--out", "frames", "--size", "8", "--frames", "3"];
    assert!(folder.ends(1, &turn).contains("is an input"));
    assert_eq!(folder.read("frames/frame-002.png"), before);
    assert!(!folder.at("frames/frame-001.png").exists(), "nothing is written before the check");
}

#[test]
fn an_export_replaces_its_own_companion_files_but_no_others() {
    let (folder, _) = inputs();
    for (out, companion) in
        [("ship.obj", "ship.mtl"), ("ship.obj", "ship-texture-1.png"), ("ship.gltf", "ship.bin")]
    {
        fs::write(folder.at(companion), "mine").unwrap();
        let told = folder.ends(1, &["export", "a.obj", "--out", out]);
        assert!(told.contains(companion), "{told}");
        assert_eq!(folder.read(companion), b"mine");
        assert!(!folder.at(out).exists(), "nothing is written before the check");
        fs::remove_file(folder.at(companion)).unwrap();
        for again in ["for the first time", "again"] {
            let told = folder.ends(0, &["export", "a.obj", "--out", out]);
            assert!(folder.at(companion).exists(), "{again}: {told}");
        }
        // Texts and textures of an earlier export are recognised even without its main file.
        if out == "ship.obj" {
            fs::remove_file(folder.at(out)).unwrap();
            folder.ends(0, &["export", "a.obj", "--out", out]);
            // An export without textures in between leaves the textures.
            fs::write(folder.at("plain.obj"), CUBE).unwrap();
            folder.ends(0, &["export", "plain.obj", "--out", out]);
            folder.ends(0, &["export", "a.obj", "--out", out]);
        }
        for name in ["ship.obj", "ship.mtl", "ship-texture-1.png", "ship-texture-2.png"] {
            let _ = fs::remove_file(folder.at(name));
        }
    }
}

#[cfg(unix)]
#[test]
fn a_link_is_written_through_whether_its_file_exists_or_not() {
    use std::os::unix::fs::symlink;
    let folder = Folder::with(&[("a.obj", CUBE)]);
    fs::create_dir(folder.at("pictures")).unwrap();
    symlink("pictures/new.png", folder.at("p.png")).unwrap();
    symlink("p.png", folder.at("q.png")).unwrap();
    symlink("r.png", folder.at("r.png")).unwrap();
    for link in ["p.png", "q.png", "p.png"] {
        folder.ends(0, &["render", "a.obj", "--size", "8", "--out", link]);
        assert!(folder.at(link).is_symlink(), "{link}");
        assert!(io::load_picture(&folder.at("pictures/new.png")).is_ok(), "{link}");
        fs::remove_file(folder.at("pictures/new.png")).unwrap();
    }
    assert!(folder.ends(1, &["render", "a.obj", "--size", "8", "--out", "r.png"]).contains("loop"));
}

#[test]
fn a_format_without_alpha_is_refused_for_a_transparent_picture() {
    let folder = Folder::with(&[("a.obj", CUBE)]);
    for (name, word) in [("a.jpg", "JPEG"), ("a.jpeg", "JPEG"), ("a.ppm", "PPM")] {
        let told =
            folder.ends(1, &["render", "a.obj", "--transparent", "--size", "8", "--out", name]);
        assert!(told.contains(word) && told.contains("transparent"), "{told}");
        assert!(!folder.at(name).exists());
        folder.ends(0, &["render", "a.obj", "--size", "8", "--out", name]);
    }
    for name in ["a.png", "a.webp"] {
        folder.ends(0, &["render", "a.obj", "--transparent", "--size", "8", "--out", name]);
        let picture = io::load_picture(&folder.at(name)).unwrap();
        assert_eq!(picture.pixel(0, 0)[3], 0, "{name}");
    }
}

#[test]
fn pictures_in_files_have_sixteen_samples_unless_a_quick_one_is_asked_for() {
    let folder = Folder::with(&[("a.obj", CUBE)]);
    let drawn = |arguments: &[&str]| {
        let render = ["render", "a.obj", "--size", "48", "--out", "a.png"];
        folder.ends(0, &[&render, arguments].concat());
        io::load_picture(&folder.at("a.png")).unwrap()
    };
    let (usual, one) = (drawn(&[]), drawn(&["--samples", "1"]));
    assert!(usual == drawn(&["--samples", "16"]) && usual != one);
    assert!(usual == drawn(&["--preset", "default"]));
    assert!(drawn(&["--preset", "draft"]) == drawn(&["--preset", "draft", "--samples", "1"]));
    let turn = ["turntable", "a.obj", "--size", "48", "--frames", "1", "--out", "turn.png"];
    folder.ends(0, &turn);
    assert!(io::load_picture(&folder.at("turn.png")).unwrap() == usual);
}

#[test]
fn frames_of_an_earlier_run_are_reported() {
    let folder = Folder::with(&[("a.obj", CUBE)]);
    let turn = |frames| {
        let turn = ["turntable", "a.obj", "--out", "f", "--size", "8", "--samples", "1"];
        folder.ends(0, &[&turn[..], &["--frames", frames]].concat())
    };
    assert_eq!(turn("8"), "");
    assert_eq!(turn("8"), "", "all of them are replaced");
    let told = turn("3");
    assert!(
        told.contains("5 pictures") && told.contains("frame-004.png to frame-008.png"),
        "{told}"
    );
}

#[test]
fn a_gif_has_no_delay_that_browsers_stretch() {
    let folder = Folder::with(&[("a.obj", CUBE)]);
    let turn = |frames, seconds| {
        let turn = ["turntable", "a.obj", "--out", "a.gif", "--size", "8", "--samples", "1"];
        let told =
            folder.ends(0, &[&turn[..], &["--frames", frames, "--seconds", seconds]].concat());
        (delays(&folder.read("a.gif")), told)
    };
    let (slow, told) = turn("30", "1");
    assert_eq!((slow.iter().sum::<u16>(), slow.len()), (100, 30));
    assert_eq!(told, "");
    for (frames, seconds) in [("90", "1"), ("120", "0.5")] {
        let (delays, told) = turn(frames, seconds);
        assert!(delays.iter().all(|delay| *delay == 2), "{delays:?}");
        assert!(told.contains("at most 50 pictures a second"), "{told}");
    }
}

/// The frame delays of a GIF in 1/100 s, from its graphic control extensions.
fn delays(gif: &[u8]) -> Vec<u16> {
    let controls = gif.windows(8).filter(|it| it[..3] == [0x21, 0xF9, 4] && it[7] == 0);
    controls.map(|it| u16::from_le_bytes([it[4], it[5]])).collect()
}
