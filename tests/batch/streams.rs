//! Batches of many pictures: their memory does not grow with them.

use super::*;

/// Runs the program, and returns the most memory that it had in KiB, and standard output.
#[cfg(target_os = "linux")]
fn memory(folder: &Path, arguments: &[&str]) -> (usize, String) {
    let out = std::fs::File::create(folder.join("stdout")).unwrap();
    let mut child = command(folder, arguments).stdout(out).stderr(Stdio::null()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0;
    let ended = loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let now = line.and_then(|line| line.trim().trim_end_matches(" kB").trim().parse().ok());
        most = most.max(now.unwrap_or(0));
        if let Some(ended) = child.try_wait().unwrap() {
            break ended;
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    assert!(ended.success(), "{arguments:?}");
    (most, std::fs::read_to_string(folder.join("stdout")).unwrap())
}

#[cfg(target_os = "linux")]
#[test]
fn a_batch_of_more_pictures_takes_no_more_memory_with_reports_layers_and_data_sets() {
    /// The difference in KiB that is allowed; a picture of a data set once took 40 to 140 KiB.
    const MOST: usize = 14_000;
    let folder = folder();
    std::fs::write(folder.path().join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let draw = ["batch", "a.obj", "--size", "8", "--samples", "1", "--threads", "2"];
    for (kind, more) in [
        ("report", &["--report", "r.jsonl", "--times", "t.jsonl"][..]),
        ("layers", &["--layers", "color,object", "--report", "r.jsonl"]),
        ("nerf", &["--dataset", "nerf"]),
        ("bop", &["--dataset", "bop"]),
        ("coco", &["--dataset", "coco"]),
    ] {
        let measured = |views: &str| {
            let folder_name = format!("{kind}{views}");
            let out = match kind {
                "report" => format!("{folder_name}/{{view}}.png"),
                "layers" => format!("{folder_name}/{{view}}-{{layer}}.png"),
                _ => folder_name,
            };
            let own = ["--views", views, "--out", &out];
            memory(folder.path(), &[&draw[..], &own, more].concat()).0
        };
        let (few, many) = (measured("100"), measured("1000"));
        assert!(many < few + MOST, "{kind}: {few} KiB for 100 pictures, {many} for 1000");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_batch_of_more_models_takes_no_more_memory() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let model = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for i in 0..1500 {
        std::fs::write(at(&format!("models/{i}.obj")), model).unwrap();
    }
    let measured = |count: usize| {
        let names: String = (0..count).map(|i| format!("models/{i}.obj\n")).collect();
        std::fs::write(at("list.txt"), names).unwrap();
        let draw = ["batch", "--list", "list.txt", "--size", "8", "--samples", "1"];
        memory(folder.path(), &[&draw[..], &["--out", "out/{stem}.png"]].concat()).0
    };
    let (few, many) = (measured(100), measured(1500));
    assert!(many < few + 6_000, "{few} KiB for 100 models, {many} for 1500");
}

#[cfg(target_os = "linux")]
#[test]
fn a_part_of_a_million_pictures_is_planned_without_the_others() {
    let folder = folder();
    let names = (0..20_000).map(|i| format!("models/{}/{i}.obj\n", i % 100));
    std::fs::write(folder.path().join("list.txt"), names.collect::<String>()).unwrap();
    let list = ["batch", "--list", "list.txt", "--views", "50", "--dry-run"];
    for out in ["{stem}-{view:03}.png", "out/{dir}/{stem}/{view_name}.png", "{index:07}.png"] {
        let part = ["--shard", "3/1000", "--out", out];
        let (most, text) = memory(folder.path(), &[&list[..], &part].concat());
        assert_eq!(text.lines().count(), 20 * 50, "{out}");
        // The names of all pictures alone would take 50 MB.
        assert!(most < 70_000, "{out}: {most} KiB");
    }
}

#[test]
fn a_data_set_does_not_mix_with_the_pictures_of_an_earlier_one() {
    let folder = folder();
    let draw = ["batch", "models/cam.obj", "models/wheel.obj", "--size", "16", "--samples", "1"];
    let draw = [&draw[..], &["--depth-scale", "100"]].concat();
    for (kind, stale) in [
        ("nerf", "set/cam/color/00002.png"),
        ("bop", "set/000000/depth/000002.png"),
        ("coco", "set/images/000004.png"),
    ] {
        let set = |views: &'static str| {
            let own = ["--dataset", kind, "--out", "set", "--views", views];
            run(folder.path(), &[&draw[..], &own].concat())
        };
        assert!(set("3").status.success(), "{kind}");
        let before = contents(&folder.path().join("set"));
        let output = set("2");
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{kind}\n{err}");
        assert!(
            err.contains("of another data set that would stay") && err.contains(stale),
            "{err}"
        );
        assert!(contents(&folder.path().join("set")) == before, "{kind}: nothing has changed");
        // The same data set is drawn again, and a larger one replaces it.
        assert!(set("3").status.success(), "{kind}");
        assert!(contents(&folder.path().join("set")) == before, "{kind}");
        assert!(set("4").status.success(), "{kind}");
        // Nor does one of another kind.
        for other in ["nerf", "bop", "coco"].iter().filter(|other| **other != kind) {
            let own = ["--dataset", other, "--out", "set", "--views", "4"];
            let output = run(folder.path(), &[&draw[..], &own].concat());
            assert_eq!(output.status.code(), Some(2), "{other} over {kind}");
        }
        std::fs::remove_dir_all(folder.path().join("set")).unwrap();
    }
}

#[test]
fn a_picture_of_a_data_set_that_fails_leaves_no_earlier_one_and_no_camera() {
    let folder = folder();
    let draw = ["batch", "models/cam.obj", "models/wheel.obj", "--size", "16", "--samples", "1"];
    let draw = [&draw[..], &["--depth-scale", "100"]].concat();
    let nerf = [&draw[..], &["--dataset", "nerf", "--out", "set", "--views", "2"]].concat();
    ends_with(0, folder.path(), &nerf);
    let coco = [&draw[..], &["--dataset", "coco", "--out", "coco", "--views", "2"]].concat();
    ends_with(0, folder.path(), &coco);
    std::fs::write(folder.path().join("models/cam.obj"), "this is a poem").unwrap();
    ends_with(1, folder.path(), &nerf);
    ends_with(1, folder.path(), &coco);
    let names: Vec<PathBuf> = contents(&folder.path().join("set")).into_keys().collect();
    assert!(names.iter().all(|name| !name.starts_with("cam/color")), "{names:?}");
    assert!(names.iter().any(|name| name.starts_with("wheel/color")), "{names:?}");
    let images: Vec<PathBuf> = contents(&folder.path().join("coco/images")).into_keys().collect();
    assert_eq!(images, ["000002.png", "000003.png"].map(PathBuf::from));
}

#[test]
fn objects_that_have_left_a_scene_leave_no_masks() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let save = |models: &[&str]| {
        let object = |(id, model): (usize, &&str)| {
            format!("(id: {id}, name: \"{id}\", model: File(path: \"{model}\")),")
        };
        let objects: String = (3..).zip(models).map(object).collect();
        let scene = format!(
            "(version: 1, next_id: 9, objects: [{objects}],
              cameras: [(id: 1, name: \"c\", eye: (0.0, 0.0, 500.0))],
              lights: [(id: 2, name: \"ambient\", slot: 0, kind: Ambient)],
              view: (object: Some(3), camera: 1, light: Some(2), subject: Object, marks: false))"
        );
        std::fs::write(at("a.marraztu"), scene).unwrap();
    };
    let bop = ["batch", "a.marraztu", "--size", "16", "--samples", "1", "--dataset", "bop"];
    let bop = [&bop[..], &["--depth-scale", "10", "--out", "set"]].concat();
    save(&["models/cam.obj", "models/wheel.obj"]);
    ends_with(0, folder.path(), &bop);
    assert!(at("set/000000/mask/000000_000001.png").exists());
    save(&["models/cam.obj"]);
    ends_with(0, folder.path(), &bop);
    let names: Vec<PathBuf> = contents(&at("set/000000/mask")).into_keys().collect();
    assert_eq!(names, [PathBuf::from("000000_000000.png")]);
}

#[test]
fn progress_states_the_pictures_per_second_and_the_time_left() {
    let folder = folder();
    let (_, err) = ends_with(0, folder.path(), &all_models(&["--progress"]));
    let last = err.lines().rfind(|line| line.starts_with("progress: ")).unwrap();
    assert!(last.contains("100%: 15 of 15 pictures, 0 missing, "), "{err}");
    assert!(last.contains(" a second, 0 s left"), "{err}");
}

#[test]
fn a_dry_run_estimates_bytes_and_time_by_a_sample_and_writes_nothing() {
    let folder = folder();
    let before = contents(folder.path());
    std::fs::write(folder.path().join("models/broken.obj"), "f 1 2 3\n").unwrap();
    let estimate = |more: &[&str]| {
        let (out, err) = ends_with(0, folder.path(), &all_models(&[&["--dry-run"], more].concat()));
        assert_eq!(out.lines().count(), 18);
        err
    };
    let err = estimate(&["--threads", "1"]);
    assert!(err.starts_with("note: 18 pictures of 6 models: about "), "{err}");
    assert!(err.contains(" on 1 thread, by a sample of 18\n"), "{err}");
    assert!(err.contains("note: 3 of the sample cannot be drawn, such as: models/broken"), "{err}");
    assert!(err.contains("note: shards are not needed"), "{err}");
    assert_eq!(estimate(&["--quiet"]), "");
    std::fs::remove_file(folder.path().join("models/broken.obj")).unwrap();
    assert!(contents(folder.path()) == before);
    // The sample has all pictures, so the bytes are right to the digits that are shown.
    ends_with(0, folder.path(), &all_models(&[]));
    let bytes: usize = contents(&folder.path().join("out")).values().map(Vec::len).sum();
    let (_, err) = ends_with(0, folder.path(), &all_models(&["--dry-run"]));
    let stated = err.split("about ").nth(1).and_then(|rest| rest.split(" kB").next()).unwrap();
    let stated: f64 = stated.parse().unwrap();
    assert!((stated - bytes as f64 / 1e3).abs() < 0.011, "{stated} kB instead of {bytes} B");
    let (_, err) = ends_with(0, folder.path(), &all_models(&["--dry-run", "--resume"]));
    assert!(err.contains("about 0 B and 0 s"), "{err}");
}

#[cfg(unix)]
#[test]
fn a_model_that_is_edited_while_it_is_drawn_is_drawn_again_later() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let model = |x: u32| format!("v 0 0 0\nv {x} 0 0\nv 0 1 0\nf 1 2 3\n");
    std::fs::write(at("a.obj"), model(1)).unwrap();
    let draw =
        ["batch", "a.obj", "--size", "700", "--samples", "256", "--out", "a.png", "--resume"];
    let mut child = command(folder.path(), &draw).stderr(Stdio::null()).spawn().unwrap();
    // Usually the model is loaded then, and the picture not drawn.
    std::thread::sleep(Duration::from_millis(300));
    std::fs::write(at("a.obj"), model(7)).unwrap();
    assert!(child.wait().unwrap().success());
    ends_with(0, folder.path(), &[&draw[..], &["--times", "t.jsonl"]].concat());
    let new = io::load_picture(&at("a.png")).unwrap();
    let again = [&draw[..2], &["--size", "700", "--samples", "256", "--out", "b.png"]].concat();
    ends_with(0, folder.path(), &again);
    assert!(io::load_picture(&at("b.png")).unwrap() == new, "the picture shows the new model");
}
