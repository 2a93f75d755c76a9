//! Layers of `render` and `batch`: files, cameras, resuming and parts.

use super::*;

/// The arguments that draw layers of two models from two views.
fn layers<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let base = [
        "batch",
        "models/cam.obj",
        "models/wheel.obj",
        "--views",
        "2",
        "--layers",
        "color,depth,object,mask",
        "--depth-scale",
        "10",
    ];
    [&base[..], &SMALL, more].concat()
}

pub(super) fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Returns the samples of a PNG as it stores them.
pub(super) fn samples(path: &Path) -> image::DynamicImage {
    image::open(path).unwrap()
}

const OUT: [&str; 2] = ["--out", "out/{stem}-{view}-{layer}.{ext}"];

#[test]
fn each_layer_is_a_file_and_the_cameras_draw_the_same_pictures_again() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    ends_with(0, folder.path(), &layers(&[&OUT[..], &["--report", "r.jsonl"]].concat()));
    let files = contents(&at("out"));
    assert_eq!(files.len(), 2 * 2 * 4 + 1, "{:?}", files.keys());
    let lines = report(&at("r.jsonl"));
    assert_eq!(lines[0]["out"], "out/cam-0-color.png");
    assert_eq!(lines[0]["layers"][0]["out"], "out/cam-0-depth.png");
    assert_eq!(lines[0]["layers"].as_array().unwrap().len(), 3);
    // The layers of a view agree about its background.
    let depth = samples(&at("out/cam-0-depth.png")).into_luma16();
    let ids = samples(&at("out/cam-0-object.png")).into_luma16();
    let mask = samples(&at("out/cam-0-mask.png")).into_luma8();
    let color = io::load_picture(&at("out/cam-0-color.png")).unwrap();
    let mut covered = 0;
    for (x, y, mask) in mask.enumerate_pixels() {
        let is_there = mask[0] == 255;
        assert_eq!(depth.get_pixel(x, y)[0] > 0, is_there, "{x},{y}");
        assert_eq!(ids.get_pixel(x, y)[0], u16::from(is_there), "{x},{y}");
        let is_background = color.pixel(x as usize, y as usize) == color.pixel(0, 0);
        assert!(is_background != is_there, "{x},{y}");
        covered += usize::from(is_there);
    }
    assert!((500..3500).contains(&covered), "{covered}");
    // The cameras have nerfstudio's fields, and the matrices are inverse to each other.
    let cameras = json(&at("out/cameras.json"));
    let frames = cameras["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 4);
    assert_eq!((&cameras["pixel_center"], &frames[0]["w"]), (&0.5.into(), &64.into()));
    assert_eq!(frames[0]["file_path"], "cam-0-color.png");
    assert_eq!(frames[0]["depth_file_path"], "cam-0-depth.png");
    assert_eq!(frames[0]["depth_scale"], 10.0);
    assert_eq!(frames[0]["transform_matrix"], frames[0]["opengl"]["c2w"]);
    assert_eq!(cameras["ids"]["models/cam.obj"]["objects"][0]["name"], "cam");
    let matrix = |json: &serde_json::Value| -> Vec<Vec<f64>> {
        serde_json::from_value(json.clone()).unwrap()
    };
    let (c2w, w2c) = (matrix(&frames[1]["opencv"]["c2w"]), matrix(&frames[1]["opencv"]["w2c"]));
    for (i, row) in c2w.iter().enumerate() {
        let column = |j: usize| row.iter().zip(&w2c).map(|(a, b)| a * b[j]).sum::<f64>();
        for (j, sum) in [0, 1, 2, 3].map(column).into_iter().enumerate() {
            assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-9, "{i} {j}: {sum}");
        }
    }
    // The same depths come from the cameras in the file.
    for model in ["cam", "wheel"] {
        let mut own = cameras.clone();
        let is_own =
            |frame: &serde_json::Value| frame["file_path"].as_str().unwrap().starts_with(model);
        own["frames"].as_array_mut().unwrap().retain(is_own);
        std::fs::write(at("own.json"), own.to_string()).unwrap();
        let file = format!("models/{model}.obj");
        let again = ["batch", &file, "--views", "own.json", "--layers", "depth,object"];
        let out = ["--out", "again/{view_name}-{layer}.png", "--depth-scale", "10"];
        ends_with(0, folder.path(), &[&again[..], &out].concat());
        for view in ["0", "1"] {
            for layer in ["depth", "object"] {
                let first = samples(&at(&format!("out/{model}-{view}-{layer}.png"))).into_luma16();
                let name = format!("again/{model}-{view}-color-{layer}.png");
                let second = samples(&at(&name)).into_luma16();
                let off = first
                    .pixels()
                    .zip(second.pixels())
                    .filter(|(a, b)| a[0].abs_diff(b[0]) > u16::from(layer == "depth"));
                // The stored digits of a matrix may move an edge over the centre of a pixel.
                let off = off.count();
                assert!(off <= 2, "{name}: {off} pixels");
            }
        }
    }
}

#[test]
fn cameras_name_layers_in_other_folders_relative_to_their_file() {
    let folder = folder();
    let out = ["--out", "out/{layer}/{stem}-{view}.png"];
    ends_with(0, folder.path(), &layers(&out));
    let cameras = json(&folder.path().join("out/color/cameras.json"));
    assert_eq!(cameras["frames"][0]["file_path"], "cam-0.png");
    assert_eq!(cameras["frames"][0]["depth_file_path"], "../depth/cam-0.png");
    assert_eq!(cameras["frames"][0]["mask_path"], "../mask/cam-0.png");
}

#[test]
fn an_orthographic_camera_is_drawn_again_from_its_file_and_rejected_by_bop_and_nerf() {
    let folder = folder();
    let base = ["batch", "models/cam.obj", "--size", "64x48", "--samples", "1"];
    let first = ["--views", "front", "--projection", "orthographic", "--layers", "color"];
    ends_with(0, folder.path(), &[&base[..], &first, &["--out", "a.png"]].concat());
    let again = ["--views", "cameras.json", "--out", "b.png"];
    ends_with(0, folder.path(), &[&base[..], &again].concat());
    // The lights of the first picture are placed for its own view.
    let compare = ["compare", "a.png", "b.png", "--max", "8"];
    ends_with(0, folder.path(), &compare);
    for kind in ["bop", "nerf"] {
        let set = ["--dataset", kind, "--out", "set", "--projection", "orthographic"];
        let (_, err) = ends_with(1, folder.path(), &[&base[..], &set].concat());
        assert!(err.contains("in perspective alone"), "{err}");
    }
}

#[test]
fn layers_are_resumed_and_divided_into_parts_with_the_same_bytes() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for (format, name) in [("png", "{stem}-{view}-{layer}"), ("exr", "{stem}-{view}")] {
        let out = |to: &str| format!("{to}/{name}.{{ext}}");
        let (whole, parts) = (out(&format!("{format}-whole")), out(&format!("{format}-parts")));
        let run = |out: &str, more: &[&str]| {
            let arguments = [&["--out", out, "--format", format][..], more].concat();
            ends_with(0, folder.path(), &layers(&arguments));
        };
        run(&whole, &["--times", "first"]);
        run(&whole, &["--resume", "--times", "second"]);
        assert_eq!(drawn_and_unchanged(&at("first")), (4, 0));
        assert_eq!(drawn_and_unchanged(&at("second")), (0, 4));
        // A single file that is gone or cut is written again.
        let victim = at(&format!("{format}-whole")).join(match format {
            "png" => "wheel-1-depth.png",
            _ => "wheel-1.exr",
        });
        let content = std::fs::read(&victim).unwrap();
        std::fs::write(&victim, &content[..content.len() - 1]).unwrap();
        run(&whole, &["--resume", "--times", "third"]);
        assert_eq!(drawn_and_unchanged(&at("third")), (1, 3));
        assert_eq!(std::fs::read(&victim).unwrap(), content);
        // Parts write the same pictures; a last run over the whole list joins the cameras.
        for shard in ["0/2", "1/2"] {
            run(&parts, &["--shard", shard, "--threads", "1"]);
        }
        run(&parts, &["--resume", "--times", "fourth"]);
        assert_eq!(drawn_and_unchanged(&at("fourth")), (0, 4));
        let (whole, mut parts) =
            (contents(&at(&format!("{format}-whole"))), contents(&at(&format!("{format}-parts"))));
        for shard in ["cameras-0-of-2.json", "cameras-1-of-2.json"] {
            assert!(parts.remove(Path::new(shard)).is_some(), "{shard}");
        }
        assert!(whole == parts, "{:?} {:?}", whole.keys(), parts.keys());
    }
}

#[test]
fn layers_that_fail_leave_no_file() {
    let folder = folder();
    let layers = ["--layers", "color,depth", "--size", "64", "--samples", "1"];
    let before = contents(folder.path());
    // The depths of this model are above 65535 steps.
    let far = ["--depth-scale", "1e9"];
    let render = ["render", "models/cam.obj", "--out", "a-{layer}.png"];
    let (_, err) = ends_with(1, folder.path(), &[&render[..], &layers, &far].concat());
    assert!(err.starts_with("error: a-depth.png: "), "{err}");
    let batch = ["batch", "models/cam.obj", "--out", "a-{layer}.png"];
    ends_with(1, folder.path(), &[&batch[..], &layers, &far].concat());
    assert!(contents(folder.path()) == before);
    // A file of another program is kept.
    std::fs::write(folder.path().join("cameras.json"), "[1]").unwrap();
    let before = contents(folder.path());
    for command in [render, batch] {
        let (_, err) = ends_with(1, folder.path(), &[&command[..], &layers].concat());
        assert!(err.contains("a file with this name exists and has other content"), "{err}");
        assert!(contents(folder.path()) == before);
    }
}

#[test]
fn layers_that_do_not_fit_their_files_are_rejected() {
    let folder = folder();
    for (arguments, reason) in [
        (&["--layers", "depth,mask", "--out", "a.png"][..], "write {layer} in its name"),
        (&["--layers", "uv", "--out", "a.png"], "PNG cannot hold the layer uv"),
        (&["--layers", "height"], "there is no layer \"height\""),
        (&["--layers", "depth", "--out", "-"], "not to standard output"),
        (&["--layers", "depth", "--depth-scale", "0"], "steps above 0"),
    ] {
        let all = [&["render", "models/cam.obj"][..], arguments].concat();
        let (_, error) = ends_with(2, folder.path(), &all);
        assert!(error.contains(reason), "{error}");
    }
    // A depth that does not fit is an error and not a wrong number.
    let deep = ["render", "models/cam.obj", "--layers", "depth", "--depth-scale", "1e6"];
    let (_, error) = ends_with(1, folder.path(), &deep);
    assert!(error.contains("steps at the depth scale 1000000"), "{error}");
    assert!(!folder.path().join("cam-depth.png").exists());
    let many = ["batch", "models/cam.obj", "--layers", "depth", "--depth-scale", "1e6"];
    let strict = [&many[..], &["--strict-exit", "--report", "r.jsonl"]].concat();
    ends_with(4, folder.path(), &strict);
    assert_eq!(report(&folder.path().join("r.jsonl"))[0]["status"], "invalid");
}

#[test]
fn an_stl_file_is_drawn_like_the_same_obj_file() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let obj = "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let corners = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let points = [[0.0_f32, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 1.0]];
    let mut stl = vec![b' '; 80];
    stl.extend(4_u32.to_le_bytes());
    for face in corners {
        stl.extend([0; 12]);
        stl.extend(face.iter().flat_map(|i: &usize| points[*i]).flat_map(f32::to_le_bytes));
        stl.extend([0; 2]);
    }
    std::fs::write(at("a.obj"), obj).unwrap();
    std::fs::write(at("a.stl"), &stl).unwrap();
    std::fs::write(at("b.stl"), &stl[..stl.len() - 10]).unwrap();
    let size = ["--size", "64", "--samples", "1"];
    let render = |file: &str, more: &[&str]| {
        ends_with(0, folder.path(), &[&["render", file], &size[..], more].concat());
    };
    // The table of a printer is the plane z = 0, so z is up.
    render("a.obj", &["--up", "z", "--out", "obj.png"]);
    render("a.stl", &["--out", "stl.png"]);
    render("a.stl", &["--up", "y", "--out", "lying.png"]);
    let [obj, stl, lying] =
        ["obj.png", "stl.png", "lying.png"].map(|name| io::load_picture(&at(name)).unwrap());
    assert!(obj == stl && obj != lying);
    let batch = ["batch", "*.stl", "--size", "64", "--report", "r.jsonl"];
    ends_with(1, folder.path(), &batch);
    let lines = report(&at("r.jsonl"));
    assert_eq!((&lines[0]["status"], &lines[1]["status"]), (&"done".into(), &"invalid".into()));
    let error = lines[1]["error"].as_str().unwrap();
    assert!(
        error.contains("b.stl: this is not a whole STL file: it states 4 triangles"),
        "{error}"
    );
    let (facts, _) = ends_with(0, folder.path(), &["info", "a.stl"]);
    assert!(facts.contains('4'), "{facts}");
    ends_with(0, folder.path(), &["views", "a.stl", "--size", "64"]);
    // A thumbnailer sees a copy without an extension.
    std::fs::copy(at("a.stl"), at("copy")).unwrap();
    ends_with(0, folder.path(), &["thumbnail", "--size", "64", "copy", "small"]);
    assert!(std::fs::read(at("small")).unwrap().starts_with(b"\x89PNG"));
}
