//! Scene files: a saved scene opens unchanged, and a failed save loses nothing.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{
    Arithmetic, Bounces, BumpFilter, Coverage, DepthFormat, Filter, FormerAxis, Interpolation,
    LightAt, LightSamples, LightValues, NormalMatrix, Resolution, Rounding, Samples, Settings,
    ShadowMethod, SpecularForm, Subpixels, Tangents, Terminator, Transparency, VertexArithmetic,
};
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::math;
use marraztu_core::edit::items::set_crease;
use marraztu_core::scene::{
    Aim, Attenuation, BumpMaps, Camera, CameraId, CameraMode, Command, Crease, Fill, Frame, Item,
    Lens, Light, LightId, LightKind, LoadOptions, Material, MaterialChoice, NormalLength, Normals,
    Object, ObjectId, Observer, Optics, Orbit, PolygonMode, Pose, PresetId, Projection, Reflection,
    Scale, Scene, Sides, Spin, SpotOwner, Steps, Subject, Surface, Texture, Tracked,
    Transformation, Transmission, UpAxis, View, Winding, Wrap,
};
use marraztu_io::{
    FindingKind, Panels, Progress, SceneFileError, WindowState, default_scene, load, load_texture,
    open, save, save_picture, save_with_window, to_text,
};
use proptest::prelude::*;

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                    g a\nf 4 3 2 1\nf 5 6 7 8\ng b\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";

/// A folder with the model `models/cube.obj` and the picture `chess.png`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("models")).unwrap();
    std::fs::write(folder.path().join("models/cube.obj"), CUBE).unwrap();
    let picture = Picture::filled(Size::new(2, 2), [9, 8, 7, 255]);
    save_picture(&folder.path().join("chess.png"), &picture).unwrap();
    folder
}

fn insert(scene: &mut Scene, at: usize, item: Item) {
    Command::Insert { at, item }.apply(scene).unwrap();
}

/// A scene without default values.
fn rich(folder: &Path, numbers: [f64; 4]) -> (Scene, View, Settings) {
    let [a, b, c, d] = numbers;
    let (mut scene, _) = default_scene();
    // An object with odd loading options, texture, placement and name, and a copy with other
    // choices.
    let options = LoadOptions {
        up: UpAxis::Z,
        scale: Scale::new(2.5).unwrap(),
        winding: Winding::Turned,
        crease: Crease::new(12.5).unwrap(),
        bumps: BumpMaps::Normals,
    };
    let cube = load(&folder.join("models/cube.obj"), &options, &Progress::new()).unwrap().model;
    let plain = load_texture(&folder.join("chess.png")).unwrap();
    let texture =
        Texture { wrap: Wrap::Clamp, offset: [a, b], scale: [2.0, 3.0], ..Texture::clone(&plain) };
    let place = DMat4::from_cols_array_2d(&[
        [a, b, c, 0.0],
        [b, 1.0, d, 0.0],
        [c, d, 1.0, 0.0],
        [d, a, b, 1.0],
    ]);
    let object = Object {
        name: "a \"cube\"\nof two lines, \u{f1}".to_owned(),
        visible: false,
        model: Shared::new(cube),
        hidden_parts: BTreeSet::from([1]),
        placement: Tracked::new(DMat4::IDENTITY).moved(place),
        spin: Spin { axes: [true, false, true], speed: c, since: d },
        material: MaterialChoice::Own(Material {
            exponent: 7.25,
            emission: [0.5, 0.0, 2.0],
            optics: Optics {
                reflection: Reflection::Fresnel,
                transmission: Transmission::Filter([0.25, 0.5, 1.0]),
                index: 1.625,
            },
            ..Material::default()
        }),
        surface: Surface::Texture,
        texture: Some(Shared::new(texture)),
        tint: Color([1, 2, 3]),
        opacity: 0.375,
        sides: Sides::Two,
        file_normals: false,
        edge_color: Color([4, 5, 6]),
    };
    let mut second = Object { texture: Some(plain), ..object.clone() };
    second.material = MaterialChoice::File;
    insert(&mut scene, 0, Item::Object(ObjectId(20), Box::new(object)));
    insert(&mut scene, 3, Item::Object(ObjectId(21), Box::new(second)));

    // A camera that orbits the object.
    let axes = math::rotation(math::unit(DVec3::new(1.0, 2.0, 3.0)).unwrap(), a);
    let pose = Pose {
        eye: DVec3::new(b, c, d),
        axes,
        mode: CameraMode::Analysis { target: ObjectId(20) },
    };
    let camera = Camera {
        name: "second".to_owned(),
        visible: false,
        model: scene.objects.get(ObjectId(1)).unwrap().model.clone(),
        material: MaterialChoice::Preset(PresetId::EMERALD),
        pose: Tracked::new(pose),
        lens: Lens {
            half_angle: 30.0,
            near: 0.1,
            far: 70.0,
            half_size: 3.0,
            shift: [a.clamp(-1e5, 1e5), -1.0 / 3.0],
            pixel_aspect: 572.4 / 573.6,
            ..Lens::default()
        },
    };
    insert(&mut scene, 0, Item::Camera(CameraId(22), Box::new(camera)));

    // One light of each kind, with each kind of owner.
    let direction = math::unit(DVec3::new(a, b, 1.0)).unwrap();
    let aim = Tracked::new(Aim { position: DVec3::new(a, b, c), direction });
    let bulb = LightKind::Bulb {
        position: Tracked::new(DVec3::new(d, c, b)),
        orbit: Orbit { on: true, speed: a, since: b },
    };
    let spot = |owner| LightKind::Spot { owner, half_aperture: 90.0, exponent: 0.5 };
    let kinds = [
        LightKind::Sun { direction: Tracked::new(direction) },
        bulb,
        spot(SpotOwner::Fixed(aim)),
        spot(SpotOwner::Object(ObjectId(20))),
        spot(SpotOwner::Camera(CameraId(22))),
    ];
    for (kind, id) in kinds.into_iter().zip(30..) {
        let mut light = Light::new("another", id, kind);
        (light.on, light.color) = (false, Color([7, 8, 9]));
        light.attenuation = Attenuation { constant: 0.5, linear: 0.25, quadratic: 1e-300 };
        insert(&mut scene, 0, Item::Light(LightId(id), Box::new(light)));
    }
    scene.background = Color([10, 11, 12]);
    scene.next_id = 99;

    // A view and settings without any default.
    let view = View {
        exposure: 0.75,
        subject: Subject::Light,
        object: Some(ObjectId(20)),
        camera: CameraId(22),
        light: Some(LightId(30)),
        transformation: Transformation::Scaling,
        frame: Frame::Global,
        steps: Steps { translation: 0.1, by_size: true, rotation: 1.0 / 3.0, scaling: 1.5 },
        observer: Observer::Object,
        projection: Projection::Orthographic,
        fill: Fill::Edges,
        edges_over_fill: true,
        polygons: Some(PolygonMode { current: 3, shown: BTreeSet::from([0, 1, 3, 5]) }),
        polygons_stay: false,
        only_selected: true,
        normals: Normals::Face,
        back_faces: true,
        face_normals: true,
        vertex_normals: true,
        normal_length: NormalLength::BySize,
        wide_lines: true,
        line_width: 2.5,
        marks: false,
        time: a,
    };
    let settings = Settings {
        arithmetic: Arithmetic::F64,
        light: LightAt::Vertex,
        samples: Samples::Sixteen,
        resolution: Resolution::Half,
        filter: Filter::Nearest,
        specular: SpecularForm::HalfVector,
        rounding: Rounding::Dithered,
        stretched: NormalMatrix::AsItIs,
        vertices: VertexArithmetic::F32,
        subpixels: Subpixels::Bits4,
        coverage: Coverage::ScanLines,
        depth: DepthFormat::Bits24,
        interpolation: Interpolation::Affine,
        tangents: Tangents::Pixel,
        bump_filter: BumpFilter::Nearest,
        light_values: LightValues::Linear,
        transparency: Transparency::Objects,
        shadow_method: ShadowMethod::Map2048Pcf,
        terminator: Terminator::Smooth,
        light_samples: LightSamples::Four,
        bounces: Bounces::Two,
        former_normalising: FormerAxis,
        former_faint: FormerAxis,
        former_power: FormerAxis,
    };
    (scene, view, settings)
}

/// The scene without its undo stacks.
fn without_stacks(scene: &Scene) -> Scene {
    let mut plain = scene.clone();
    for (id, object) in scene.objects.iter() {
        let object = Object { placement: Tracked::new(*object.placement.now()), ..object.clone() };
        Command::Replace(Item::Object(id, Box::new(object))).apply(&mut plain).unwrap();
    }
    plain
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_saved_scene_opens_bit_for_bit_without_its_history(
        numbers in prop::array::uniform4(prop_oneof![
            -1e6..1e6_f64,
            -1e-300..1e-300_f64,
            Just(-0.0),
            Just(0.1),
            Just(f64::MIN_POSITIVE),
            Just(1e300),
        ]),
    ) {
        let folder = folder();
        let (scene, view, settings) = rich(folder.path(), numbers);
        let path = folder.path().join("scenes.marraztu");
        let panels = [("outline", false), ("statistics", true), ("plan", true)];
        let panels: Panels = panels.into_iter().collect();
        let window = WindowState { coarse_while_moving: false, panels };
        save_with_window(&path, &scene, &view, &settings, &window).unwrap();
        let opened = open(&path, &Progress::new()).unwrap();
        let scene = without_stacks(&scene);
        prop_assert_eq!(&opened.scene, &scene);
        prop_assert_eq!(opened.view, view);
        prop_assert_eq!(opened.settings, settings);
        prop_assert_eq!(opened.window, window);
        let bits = |scene: &Scene| {
            let placements = scene.objects.iter().map(|(_, o)| *o.placement.now());
            placements.flat_map(|m| m.to_cols_array().map(f64::to_bits)).collect::<Vec<_>>()
        };
        prop_assert_eq!(bits(&opened.scene), bits(&scene));
    }
}

/// Opens the first scene's text with one replacement.
fn changed(from: &str, to: &str) -> Result<marraztu_io::Opened, SceneFileError> {
    let folder = folder();
    let (scene, view) = default_scene();
    let path = folder.path().join("a.marraztu");
    let text = to_text(&path, &scene, &view, &Settings::default()).unwrap();
    assert!(text.contains(from), "{from:?} is not in\n{text}");
    std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
    open(&path, &Progress::new())
}

#[test]
fn the_file_of_the_first_scene_is_short_and_readable() {
    let (scene, view) = default_scene();
    let path = Path::new("/tmp/first.marraztu");
    let text = to_text(path, &scene, &view, &Settings::default()).unwrap();
    assert!(text.starts_with("(\n    version: 1,\n"), "{text}");
    for line in
        ["model: Own(\"r_falke\"),", "material: Preset(\"ruby\"),", "background: (0, 0, 179),"]
    {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
    assert!(text.lines().count() < 250, "{} lines", text.lines().count());
}

#[test]
fn the_first_scene_opens_as_it_was() {
    let opened = changed("version: 1", "version: 1").unwrap();
    let (scene, view) = default_scene();
    assert_eq!((opened.scene, opened.view), (scene, view));
    assert_eq!(opened.findings, []);
}

#[test]
fn axes_and_choices_of_older_scene_files_still_open() {
    for (from, to) in [
        ("depth: F32Reversed", "depth: F32Reversed, normalising: Newton, faint: LeftOut"),
        ("depth: F32Reversed", "power: Table256, depth: F32Reversed"),
        ("depth: F32Reversed", "depth: F32Reversed, power: Polynomial"),
        ("depth: F32Reversed", "depth: F32Reversed, power: Library"),
        ("vertices: F64", "vertices: F32ComposedInF64"),
    ] {
        let opened = changed(from, to).unwrap();
        assert_eq!((opened.settings, opened.findings), (Settings::default(), Vec::new()), "{to}");
    }
    assert!(changed("depth: F32Reversed", "norm: Newton").is_err());
    let (scene, view) = default_scene();
    let text = to_text(Path::new("/a"), &scene, &view, &Settings::default()).unwrap();
    for former in ["normalising", "faint", "power"] {
        assert!(!text.contains(former), "{text}");
    }
}

#[test]
fn a_choice_that_no_longer_exists_opens_as_the_default_with_a_finding() {
    for (from, to) in [
        ("interpolation: Perspective", "interpolation: EverySixteen"),
        ("transparency: Exact", "transparency: Weighted"),
        ("samples: 1", "samples: 1, power: Schlick"),
        ("r#shadow-method: Exact", "r#shadow-method: Map512Pcf"),
        ("r#shadow-method: Exact", "r#shadow-method: Map1024"),
        ("r#shadow-method: Exact", "r#shadow-method: Map1024Pcf"),
        ("r#shadow-method: Exact", "r#shadow-method: Map4096"),
        ("r#shadow-method: Exact", "r#shadow-method: Map4096Pcf"),
    ] {
        let opened = changed(from, to).unwrap();
        assert_eq!(opened.settings, Settings::default(), "{to}");
        let [finding] = &opened.findings[..] else { panic!("{to}: {:?}", opened.findings) };
        let setting = to.trim_start_matches("samples: 1, ").trim_start_matches("r#");
        let text = format!("the setting \"{setting}\" no longer exists; the default is used");
        assert_eq!((finding.kind, &finding.text), (FindingKind::SettingFormer, &text));
    }
    // Several of them are one finding.
    let opened = changed("transparency: Exact", "transparency: Weighted, power: Schlick").unwrap();
    let texts: Vec<_> = opened.findings.iter().map(|finding| &finding.text[..]).collect();
    let joined =
        "2 settings (the first: \"power: Schlick\") no longer exist; the defaults are used";
    assert_eq!(texts, [joined]);
    // A name with such a word is not a setting.
    let opened = changed("name: \"r_falke\"", "name: \"transparency: Weighted\"").unwrap();
    assert_eq!(opened.findings, []);
    let error = changed("transparency: Exact", "transparency: Map1024").unwrap_err();
    assert!(error.to_string().contains("Map1024"), "{error}");
}

#[test]
fn text_that_cannot_be_parsed_is_refused_with_its_position_in_plain_words() {
    let mut wrong = Vec::new();
    for (from, to, line, reason) in [
        ("version: 1", "version: 2", 2, "the file has version 2, from a newer program"),
        ("version: 1", "version: 0", 2, "0 is not a version: the first one is 1"),
        ("version: 1,", "", 0, "this is not a scene file: it has no version"),
        ("background", "foreground", 3, "the scene cannot have \"foreground\""),
        ("next_id: 9", "next_id: -9", 4, "this number is too large or too small here"),
        ("next_id: 9", "next_id: 99999999999", 4, "this number is too large or too small here"),
        ("next_id: 9", "next_id: 9, next_id: 9", 4, "the scene has \"next_id\" twice"),
        ("next_id: 9,", "next_id: 9", 5, "\",\" is missing here"),
        ("name: \"r_falke\"", "name: r_falke", 8, "a text in quotation marks is missing here"),
        ("name: \"r_falke\",", "", 0, "the object has no \"name\""),
        ("(\n    version", "\n    version", 1, "this is not a scene file: it does not begin with"),
        ("visible: true", "visible: yes", 9, "true or false is missing here"),
        ("Preset(\"ruby\")", "Preset(\"mud\")", 0, "there is no material called \"mud\""),
        (
            "Preset(\"ruby\")",
            "Reset(\"ruby\")",
            0,
            "\"Reset\" cannot be here; use Preset, File or Own",
        ),
        ("(0, 0, 179)", "(0, 0)", 3, "is expected here"),
        ("(0, 0, 179)", "(0, 0, 300)", 3, "this number is too large or too small here"),
    ] {
        let error = changed(from, to).unwrap_err();
        let text = error.to_string();
        let SceneFileError::Line { line: at, column, ref file, .. } = error else {
            panic!("{to}: {text}")
        };
        assert!(text.starts_with(&format!("{file}:{at}:{column}: ")), "{to}: {text}");
        if (line != 0 && at != line) || !text.contains(reason) {
            wrong.push(format!("{to}: {text}"));
        }
    }
    assert_eq!(wrong, [""; 0]);
}

/// Users cannot interpret messages of the parser or of Rust.
#[test]
fn no_error_speaks_of_the_parser() {
    let folder = folder();
    let path = folder.path().join("a.marraztu");
    let (scene, view) = default_scene();
    let whole = to_text(&path, &scene, &view, &Settings::default()).unwrap();
    let refusal = |text: &str| {
        std::fs::write(&path, text).unwrap();
        open(&path, &Progress::new()).err().map(|error| error.to_string())
    };
    // Deep nesting must not overflow the parser's stack.
    let nested = format!("(a: {}", "[".repeat(5000));
    let mut refusals: Vec<String> = refusal(&nested).into_iter().collect();
    assert!(refusals[0].contains("nested too deeply"), "{refusals:?}");
    // Replaces or deletes a character, or truncates the text, at every 17th position.
    let places: Vec<usize> = whole.char_indices().map(|(place, _)| place).collect();
    for place in places.iter().step_by(17) {
        for change in ["", "'", "?", "\"", "(", "_", "/*"] {
            refusals.extend(refusal(&format!(
                "{}{change}{}",
                &whole[..*place],
                &whole[place + 1..]
            )));
        }
        refusals.extend(refusal(&whole[..*place]));
    }
    assert!(refusals.len() > 1000, "{}", refusals.len());
    for refusal in refusals {
        let words =
            ["Expected", "Unexpected", "struct", "RON", "ron::", "`", "enum", "u32", "FileS"];
        let refusal = refusal.replace(&path.display().to_string(), "");
        let of_rust = words.into_iter().find(|word| refusal.contains(word));
        assert_eq!(of_rust, None, "{refusal}");
    }
}

#[test]
fn invalid_items_of_a_scene_are_refused_by_name() {
    for (from, to, reason) in [
        ("id: 1,", "id: 2,", "object 2 \"x_wing\": its id is used twice"),
        (
            "(-100.0, 0.0, 0.0, 1.0)",
            "(inf, 0.0, 0.0, 1.0)",
            "\"r_falke\": its placement has a number that is infinite or NaN",
        ),
        (
            "eye: (0.0, 0.0, 400.0)",
            "eye: (0.0, 0.0, NaN)",
            "\"camera 1\": its position has a number that is infinite or NaN",
        ),
        ("half_angle: 22.5", "half_angle: 90.0", "the lens needs an angle between 0 and 90"),
        ("half_angle: 22.5", "half_angle: 22.5, pixel_aspect: -1.0", "a pixel aspect from 0.001"),
        ("half_angle: 22.5", "half_angle: 22.5, shift: (NaN, 0.0)", "the lens needs an angle"),
        ("slot: 1,", "slot: 0,", "another light has slot 0 already"),
        (
            "direction: (0.0, -1.0, 0.0)",
            "direction: (0.0, 0.0, 0.0)",
            "its direction has no length",
        ),
        ("scaling: 1.2", "scaling: 1.0", "of scaling above 1"),
        ("Own(\"x_wing\")", "Own(\"y_wing\")", "there is no built-in model \"y_wing\""),
        ("next_id: 9", "next_id: 9, unknown: 1", "unknown"),
        ("id: 0,", "id: 4294967295,", "an id is too large"),
    ] {
        let text = changed(from, to).unwrap_err().to_string();
        assert!(text.contains(reason), "{to}: {text}");
    }
    let emission = |emission: &str| {
        let black = "(ambient: (0, 0, 0), diffuse: (0, 0, 0), specular: (0, 0, 0), exponent: 1";
        let material = format!("material: Own({black}, emission: {emission})),");
        changed("material: Preset(\"ruby\"),", &material)
            .map(|_| ())
            .map_err(|error| error.to_string())
    };
    assert_eq!(emission("(0, 0.5, 20)"), Ok(()), "light has no largest value");
    for (wrong, reason) in [
        ("(NaN, 0.5, 0)", "its material has a number that is infinite or NaN"),
        ("(0, inf, 0)", "its material has a number that is infinite or NaN"),
        ("(0, 0.5, -5)", "an emission and an exponent of at least 0"),
    ] {
        let text = emission(wrong).unwrap_err();
        assert!(text.contains(reason), "{wrong}: {text}");
    }
}

#[test]
fn a_missing_selection_is_listed_and_the_first_item_is_selected() {
    for (from, to, what) in [
        ("object: Some(2)", "object: Some(77)", "object 77"),
        ("camera: 3,", "camera: 77,", "camera 77"),
        ("light: Some(5)", "light: Some(77)", "light 77"),
    ] {
        let opened = changed(from, to).unwrap();
        let (_, view) = default_scene();
        assert_eq!(opened.view, view, "{to}");
        let [finding] = &opened.findings[..] else { panic!("{to}: {:?}", opened.findings) };
        let text = format!(
            "the view selects {what}, which is not in the scene: the first one is selected"
        );
        assert_eq!((finding.kind, &finding.text), (FindingKind::SelectionMissing, &text));
    }
}

#[test]
fn a_scene_without_a_view_has_no_findings() {
    let folder = folder();
    let path = folder.path().join("a.marraztu");
    std::fs::write(&path, "(version: 1, cameras: [(id: 5, name: \"only\")])").unwrap();
    assert_eq!(open(&path, &Progress::new()).unwrap().findings, []);
}

#[test]
fn spots_and_cameras_attached_to_missing_items_are_listed() {
    for (from, to, text) in [
        (
            "owner: SelectedObject",
            "owner: Object(77)",
            "the light \"object spot\" belongs to object 77, which is not in the scene",
        ),
        (
            "mode: Fly",
            "mode: Analysis(77)",
            "the camera \"camera 1\" is aimed at object 77, which is not in the scene",
        ),
    ] {
        let opened = changed(from, to).unwrap();
        let texts: Vec<&str> = opened.findings.iter().map(|finding| &*finding.text).collect();
        assert_eq!(texts, [text]);
    }
}

#[test]
fn a_file_that_is_not_a_scene_file_is_refused() {
    let folder = folder();
    let path = folder.path().join("b.marraztu");
    let refusal = || open(&path, &Progress::new()).unwrap_err().to_string();
    let shown = path.display();
    assert_eq!(refusal(), format!("{shown}: there is no such file"));
    for (content, reason) in [
        (&b""[..], ":1:1: this is not a scene file: it does not begin with \"(\""),
        (b"\x89PNG\xFF", ": this is not a scene file: it is not text"),
        (b"hello", ":1:1: this is not a scene file: it does not begin with \"(\""),
        (b"()", ":1:2: this is not a scene file: it has no version"),
    ] {
        std::fs::write(&path, content).unwrap();
        assert_eq!(refusal(), format!("{shown}{reason}"));
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_scene_that_is_a_pipe_is_refused_at_once_and_one_that_names_it_opens_without_it() {
    let folder = folder();
    let make_pipe = |path: &Path| {
        assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
    };
    let [scene, model] = ["a.marraztu", "a.obj"].map(|name| folder.path().join(name));
    make_pipe(&scene);
    let refusal = |path: &Path| format!("{}: this is a pipe, not a file", path.display());
    let error = open(&scene, &Progress::new()).unwrap_err().to_string();
    assert_eq!(error, refusal(&scene));
    make_pipe(&model);
    let named = folder.path().join("b.marraztu");
    let text = "(version: 1, cameras: [(id: 1, name: \"a\", model: File(path: \"a.obj\"))])";
    std::fs::write(&named, text).unwrap();
    let opened = open(&named, &Progress::new()).unwrap();
    assert!(opened.findings[0].text.ends_with(&refusal(&model)), "{:?}", opened.findings);
}

#[test]
fn a_picture_of_two_models_and_an_object_is_read_once() {
    let folder = folder();
    let mtl = "newmtl m\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nmap_Kd chess.png\n";
    std::fs::write(folder.path().join("m.mtl"), mtl).unwrap();
    for name in ["a.obj", "b.obj"] {
        let text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let object = |id: u32, name: &str| {
        format!(
            "(id: {id}, name: \"{name}\", model: File(path: \"{name}\"), \
             texture: Some((path: \"chess.png\", offset: (0.5, {id}.0)))),"
        )
    };
    let text = format!(
        "(version: 1, cameras: [(id: 9, name: \"c\")], objects: [{}{}])",
        object(1, "a.obj"),
        object(2, "b.obj")
    );
    let path = folder.path().join("a.marraztu");
    std::fs::write(&path, text).unwrap();
    let opened = open(&path, &Progress::new()).unwrap();
    let objects = opened.scene.objects.iter().map(|(_, object)| object);
    let own = |object: &Object| object.texture.clone().unwrap().picture.clone();
    let file = |object: &Object| object.model.materials[0].texture.clone().unwrap().picture.clone();
    let pictures: Vec<_> = objects.flat_map(|object| [own(object), file(object)]).collect();
    assert_eq!(pictures.len(), 4);
    assert!(pictures.iter().all(|picture| Shared::same(picture, &pictures[0])));
}

#[test]
fn a_scene_opens_without_its_files_and_is_saved_as_it_was() {
    let folder = folder();
    let (scene, view, settings) = rich(folder.path(), [1.0, 2.0, 3.0, 4.0]);
    let view = View { polygons: None, ..view };
    let path = folder.path().join("a.marraztu");
    save(&path, &scene, &view, &settings).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let files = ["models/cube.obj", "chess.png"].map(|name| folder.path().join(name));
    files.iter().for_each(|file| std::fs::remove_file(file).unwrap());

    let opened = open(&path, &Progress::new()).unwrap();
    let missing: BTreeSet<&Path> = files.iter().map(PathBuf::as_path).collect();
    assert_eq!(opened.scene.missing_files(), missing);
    let found: Vec<(FindingKind, &str)> =
        opened.findings.iter().map(|finding| (finding.kind, finding.text.as_str())).collect();
    let model = "the model \"models/cube.obj\" was not found: a box is shown instead";
    let texture = "the texture \"chess.png\" was not found";
    assert!(found.contains(&(FindingKind::ModelMissing, model)), "{found:?}");
    assert!(found.contains(&(FindingKind::TextureMissing, texture)), "{found:?}");
    let object = opened.scene.objects.get(ObjectId(20)).unwrap();
    assert!(object.model.is_placeholder() && object.texture.as_ref().unwrap().is_placeholder());
    assert_eq!(object.hidden_parts, BTreeSet::from([1]), "parts of the missing model");

    let again = to_text(&path, &opened.scene, &opened.view, &opened.settings).unwrap();
    assert_eq!(again, text, "nothing of the scene is lost");
    // Saved in another folder, the path still leads to the same file.
    let elsewhere = tempfile::tempdir().unwrap();
    let moved = elsewhere.path().join("b.marraztu");
    save(&moved, &opened.scene, &opened.view, &opened.settings).unwrap();
    std::fs::write(&files[0], CUBE).unwrap();
    let opened = open(&moved, &Progress::new()).unwrap();
    assert_eq!(opened.scene.missing_files(), [&*files[1]].into());
    let mesh =
        |scene: &Scene| scene.objects.get(ObjectId(20)).unwrap().model.mesh.positions().to_vec();
    assert_eq!(mesh(&opened.scene), mesh(&scene));
}

/// Opens a scene text next to the folder's files.
fn opened_text(folder: &Path, text: &str) -> marraztu_io::Opened {
    let path = folder.join("a.marraztu");
    std::fs::write(&path, text).unwrap();
    open(&path, &Progress::new()).unwrap()
}

#[test]
fn the_box_of_a_missing_model_is_sized_by_the_other_objects() {
    let folder = folder();
    let extent = |text: &str| {
        let scene = opened_text(folder.path(), text).scene;
        scene.objects.get(ObjectId(1)).unwrap().largest_extent()
    };
    let place = "placement: ((0.01, 0.0, 0.0, 0.0), (0.0, 0.01, 0.0, 0.0), (0.0, 0.0, 0.01, 0.0), \
                 (0.0, 0.0, 0.0, 1.0))";
    let others = format!(
        r#"(version: 1, cameras: [(id: 3, name: "c")], objects: [
            (id: 1, name: "gone", model: File(path: "gone.obj"), {place}),
            (id: 2, name: "cube", model: File(path: "models/cube.obj")),
            (id: 4, name: "ground", model: Own("ground"))])"#
    );
    assert!((extent(&others) - 0.6).abs() < 1e-6, "by the cube, whatever its own scale");
    let alone = r#"(version: 1, cameras: [(id: 3, name: "c", eye: (0.0, 0.0, 100.0))],
        objects: [(id: 1, name: "gone", model: File(path: "gone.obj"))])"#;
    let size = extent(alone);
    assert!((10.0..40.0).contains(&size), "well seen from 100 units away: {size}");
}

#[test]
fn a_model_and_a_texture_that_cannot_be_read_are_placeholders_too() {
    let folder = folder();
    std::fs::write(folder.path().join("bad.obj"), "v 0 zero 0\n").unwrap();
    std::fs::write(folder.path().join("bad.png"), "no picture").unwrap();
    let text = r#"(version: 1, cameras: [(id: 3, name: "c", model: File(path: "gone.obj"))],
        objects: [(id: 1, name: "bad", model: File(path: "bad.obj"),
            texture: Some((path: "bad.png")), hidden_parts: "0-4294967295")])"#;
    let opened = opened_text(folder.path(), text);
    let kinds: BTreeSet<FindingKind> = opened.findings.iter().map(|finding| finding.kind).collect();
    let wanted =
        [FindingKind::ModelMissing, FindingKind::ModelUnreadable, FindingKind::TextureUnreadable];
    assert_eq!(kinds, wanted.into());
    assert!(opened.findings.iter().any(|finding| finding.text.contains("bad.obj:1:")));
    assert_eq!(opened.scene.missing_files().len(), 3);
}

#[test]
fn a_folder_with_its_scene_and_its_models_can_be_moved() {
    let folder = folder();
    let (scene, view, settings) = rich(folder.path(), [1.0, 2.0, 3.0, 4.0]);
    save(&folder.path().join("a.marraztu"), &scene, &view, &settings).unwrap();
    let moved = tempfile::tempdir().unwrap();
    let to = moved.path().join("there");
    std::fs::rename(folder.path(), &to).unwrap();
    let opened = open(&to.join("a.marraztu"), &Progress::new()).unwrap();
    let source = opened.scene.objects.get(ObjectId(20)).unwrap().model.source.clone();
    assert_eq!(source, Some(to.join("models/cube.obj")));
}

#[test]
fn one_model_in_many_objects_is_read_once_and_shared() {
    let folder = folder();
    let (scene, view, settings) = rich(folder.path(), [1.0, 2.0, 3.0, 4.0]);
    let path = folder.path().join("a.marraztu");
    save(&path, &scene, &view, &settings).unwrap();
    let opened = open(&path, &Progress::new()).unwrap();
    let model = |id| &opened.scene.objects.get(ObjectId(id)).unwrap().model;
    assert!(Shared::same(model(20), model(21)));
}

#[test]
fn objects_of_one_file_keep_their_crease_angles() {
    let folder = folder();
    let (mut scene, view, settings) = rich(folder.path(), [1.0, 2.0, 3.0, 4.0]);
    for (id, degrees) in [(21, 90.0), (20, 180.0)] {
        let crease = Crease::new(degrees).unwrap();
        set_crease(&scene, ObjectId(id), crease).unwrap().apply(&mut scene).unwrap();
    }
    let path = folder.path().join("a.marraztu");
    save(&path, &scene, &view, &settings).unwrap();
    let opened = open(&path, &Progress::new()).unwrap();
    assert_eq!(opened.scene, without_stacks(&scene));
    let model = |id| &opened.scene.objects.get(ObjectId(id)).unwrap().model;
    assert_eq!([20, 21].map(|id| model(id).options.crease.get()), [180.0, 90.0]);
    assert!(model(20).shares_file_with(model(21)), "the file is read once");

    // Files from before the crease setting get the default.
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("crease: 180.0,", "").replace("crease: 90.0,", "")).unwrap();
    let opened = open(&path, &Progress::new()).unwrap().scene;
    let model = |id| &opened.objects.get(ObjectId(id)).unwrap().model;
    assert_eq!([20, 21].map(|id| model(id).options.crease), [Crease::default(); 2]);

    std::fs::write(&path, text.replace("crease: 180.0", "crease: 181.0")).unwrap();
    let error = open(&path, &Progress::new()).unwrap_err().to_string();
    let reason = "the crease angle of models/cube.obj has to be from 0 to 180 degrees";
    assert_eq!(error, format!("{}: {reason}", path.display()));
}

#[test]
fn saving_keeps_the_previous_file_as_a_backup() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.marraztu");
    let (mut scene, view) = default_scene();
    let mut write = |color: u8| {
        scene.background = Color([color; 3]);
        save(&path, &scene, &view, &Settings::default()).unwrap();
    };
    write(1);
    write(2);
    write(3);
    let background =
        |name: &str| open(&folder.path().join(name), &Progress::new()).unwrap().scene.background;
    assert_eq!(background("a.marraztu"), Color([3; 3]));
    assert_eq!(background("a.marraztu~"), Color([2; 3]));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_nan_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.marraztu");
    let (scene, mut view) = default_scene();
    view.time = f64::NAN;
    let error = save(&path, &scene, &view, &Settings::default()).unwrap_err();
    assert!(error.to_string().contains("NaN"), "{error}");
    assert!(!path.exists());
}

#[test]
fn opening_can_be_cancelled() {
    let folder = folder();
    let (scene, view, settings) = rich(folder.path(), [1.0, 2.0, 3.0, 4.0]);
    let path = folder.path().join("a.marraztu");
    save(&path, &scene, &view, &settings).unwrap();
    let progress = Progress::new();
    progress.cancel();
    let error = open(&path, &progress).unwrap_err();
    assert_eq!(error.to_string(), "loading was cancelled");
}
