//! The lines and points of models: drawn in their colours, hidden and picked like faces, the same
//! by every way of drawing, exported and counted.
//!
//! Catches: a file of lines that shows nothing, lines with another depth than the faces they lie
//! on, colours of one end alone, strokes that a redraw or another instruction set draws otherwise,
//! lines that an export loses.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

mod common;

use std::process::Command as Process;

use common::{at, covered, cube, draw, edit, model_of, scene, square};
use glam::DMat4;
use marraztu_core::accuracy::{AXES, Samples, Settings, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Command, Fill, ItemId, LoadOptions, MeshSource, Model, ObjectId, Part, Projection, Scene,
    Stroke, Surface, Tracked, View,
};
use marraztu_io::{self as io, Progress};
use marraztu_render::{
    Effect, EffectState, Layer, LayerSet, NormalSpace, Renderer, explain_frame, plan_everything,
    plan_frame,
};

const LINE: ObjectId = ObjectId(10);

/// A model of strokes between these vertices, which have colours.
fn strokes(vertices: &[([f32; 3], [f32; 3])], ends: &[[u32; 2]]) -> Shared<Model> {
    let source = MeshSource {
        positions: vertices.iter().map(|(place, _)| *place).collect(),
        colors: vertices.iter().map(|(_, color)| *color).collect(),
        strokes: ends.iter().map(|ends| Stroke { ends: *ends, part: 0 }).collect(),
        parts: vec![Part { name: "strokes".to_owned(), material: None }],
        ..MeshSource::default()
    };
    model_of("strokes", source)
}

/// A level line from -1 to 1, from black to white.
fn level() -> Shared<Model> {
    strokes(&[([-1.0, 0.0, 0.0], [0.0; 3]), ([1.0, 0.0, 0.0], [1.0; 3])], &[[0, 1]])
}

/// A scene without marks, drawn with wide lines.
fn shown(models: &[(Shared<Model>, DMat4)], line_width: f64) -> (Scene, View) {
    let (scene, view) = scene(models);
    (scene, View { marks: false, line_width, ..view })
}

#[test]
fn a_line_has_its_width_and_runs_from_the_colour_of_one_end_to_that_of_the_other() {
    let (scene, view) = shown(&[(level(), at(60.0, 0.0, 0.0, 0.0))], 6.0);
    for samples in Samples::ALL.into_iter().take(4) {
        let settings = Settings { samples, ..Settings::default() };
        let picture = draw(&scene, &view, &settings, 128);
        let column = |x: usize| (0..128).map(move |y| [x, y]);
        let drawn = |at: &[usize; 2]| picture.pixel(at[0], at[1]) != scene.background.opaque();
        let middle: Vec<_> = column(64).filter(drawn).collect();
        assert!((6..=7).contains(&middle.len()), "{samples:?}: {middle:?}");
        let row: Vec<_> = (0..128).map(|x| [x, 64]).filter(drawn).collect();
        let grey = |at: &[usize; 2]| picture.pixel(at[0], at[1]).map(i32::from)[0];
        assert!(grey(&row[2]) < 20 && grey(&row[row.len() - 3]) > 235, "{samples:?}");
        assert!((grey(&[64, 64]) - 128).abs() < 6, "{samples:?}: {}", grey(&[64, 64]));
        let inner = &row[2..row.len() - 2];
        assert!(inner.windows(2).all(|two| grey(&two[0]) <= grey(&two[1])), "{samples:?}");
    }
}

#[test]
fn perspective_moves_the_middle_of_the_colours_to_the_far_end() {
    // One end is three times as far from the camera at z 400 as the other.
    let line =
        strokes(&[([-40.0, 0.0, 300.0], [0.0; 3]), ([120.0, 0.0, 100.0], [1.0; 3])], &[[0, 1]]);
    let (scene, view) = shown(&[(line, DMat4::IDENTITY)], 5.0);
    let picture = draw(&scene, &view, &Settings::default(), 256);
    // The ends are at equal distances from the middle column, which shows a quarter of the way.
    let [grey, ..] = picture.pixel(128, 128);
    assert!((i32::from(grey) - 64).abs() <= 3, "{grey}");
}

#[test]
fn points_are_discs_in_the_colours_of_their_vertices_or_in_kd() {
    let point = strokes(&[([0.0; 3], [0.0, 1.0, 0.0])], &[[0, 0]]);
    let (mut scene, view) = shown(&[(point, at(50.0, 0.0, 0.0, 0.0))], 20.0);
    let settings = Settings { samples: Samples::Sixteen, ..Settings::default() };
    let picture = draw(&scene, &view, &settings, 64);
    assert_eq!(picture.pixel(32, 32), [0, 255, 0, 255]);
    let count = covered(&picture, &scene).iter().filter(|is| **is).count();
    // A disc of diameter 20 has 314 pixels, and touches some more.
    assert!((314..400).contains(&count), "{count}");
    edit(&mut scene, LINE, |object| object.surface = Surface::Material);
    let kd = scene.objects.get(LINE).unwrap().part_look(0).material.diffuse;
    let want = kd.map(|k| (k * 255.0).round());
    let [r, g, b, _] = draw(&scene, &view, &settings, 64).pixel(32, 32);
    assert_eq!([r, g, b].map(f64::from), want);
}

#[test]
fn faces_hide_the_lines_behind_them_and_show_those_that_lie_on_them() {
    let mut source = MeshSource {
        positions: vec![
            [-1.0, -1.0, 0.0],
            [1.0, -1.0, 0.0],
            [1.0, 1.0, 0.0],
            [-1.0, 1.0, 0.0],
            [-1.0, 0.0, -0.5],
            [1.0, 0.0, -0.5],
        ],
        ..MeshSource::default()
    };
    source.parts = vec![Part { name: String::new(), material: None }];
    source.push_polygon(&[0, 1, 2, 3].map(marraztu_core::scene::SourceCorner::bare));
    // A diagonal of the face, and a line behind the face.
    for (ends, want) in [([0, 2], true), ([4, 5], false)] {
        let strokes = vec![Stroke { ends, part: 0 }];
        let model = model_of("plate", MeshSource { strokes, ..source.clone() });
        let (scene, view) = shown(&[(model, at(80.0, 0.0, 0.0, 0.0))], 2.0);
        let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(128, 128)));
        let mut renderer = Renderer::default();
        renderer.render(&plan);
        let hits = (0..128).flat_map(|y| (0..128).map(move |x| (x, y)));
        let hits: Vec<_> = hits.filter_map(|(x, y)| renderer.hit(x, y)).collect();
        let lines = hits.iter().filter(|hit| hit.polygon.is_none()).count();
        assert!(hits.iter().all(|hit| hit.item == ItemId::Object(LINE)));
        // All of the diagonal is seen, one or two pixels of each column.
        assert!(if want { lines > 90 } else { lines == 0 }, "{ends:?}: {lines}");
    }
}

/// A tangle of lines and points around a cube, some of them behind the camera.
fn tangle(rng: &mut Rng) -> (Scene, View) {
    let mut random = |most: i32| (rng.between(-most, most) as f32) / 100.0;
    let vertices: Vec<_> = (0..40)
        .map(|_| {
            ([random(300), random(200), random(900)], [random(100).abs(), 0.5, random(100).abs()])
        })
        .collect();
    let ends: Vec<[u32; 2]> = (0..60).map(|i| [i % 40, (i * i + i / 3) % 40]).collect();
    let models =
        [(strokes(&vertices, &ends), at(60.0, 0.0, 0.0, 0.0)), (cube(), at(70.0, 9.0, 0.0, 0.0))];
    shown(&models, 2.75)
}

#[test]
fn every_instruction_set_and_every_redraw_give_the_same_picture() {
    let mut rng = Rng::new(23);
    for round in 0..12 {
        let (mut scene, view) = tangle(&mut rng);
        let projection = rng.one_of(&[Projection::Perspective, Projection::Orthographic]);
        let fill = rng.one_of(&[Fill::Filled, Fill::Edges]);
        let view = View { projection, fill, ..view };
        let mut settings = Settings::default();
        // Some choices of some axes; samples lit one by one take long.
        for axis in AXES.iter().filter(|axis| axis.key != "shading") {
            if rng.percent(20) {
                settings = axis.choices[rng.index(axis.choices.len())].of(&settings);
            }
        }
        if settings.samples == Samples::TwoFiftySix {
            settings.samples = Samples::SixtyFour;
        }
        let shot = |scene: &Scene| Shot::new(scene, &view, &settings, Size::new(150, 110));
        let mut renderer = Renderer::default();
        renderer.render(&plan_frame(&shot(&scene)));
        edit(&mut scene, LINE, |object| {
            object.placement = Tracked::new(*object.placement.now() * at(1.0, 0.1, 0.05, 0.0));
        });
        let plan = plan_frame(&shot(&scene));
        renderer.redraw(&plan, &|| true).unwrap();
        for level in marraztu_lab::instructions::levels() {
            let picture = Renderer::new(level).render(&plan).clone();
            assert!(picture == *renderer.picture(), "round {round}, {level:?}");
        }
    }
}

#[test]
fn an_outline_surrounds_lines_and_leaves_them_visible() {
    let (scene, view) = shown(&[(level(), at(60.0, 0.0, 0.0, 0.0))], 1.5);
    let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(64, 64)));
    let mut renderer = Renderer::default();
    renderer.render(&plan);
    let item = ItemId::Object(LINE);
    let (own, outlined) = (renderer.pixels_of(item), renderer.outlined_pixels(&[item]));
    assert!(own.contains(&true) && outlined.len() == own.len());
    for (at, is_outlined) in outlined.iter().enumerate() {
        let near = |at: usize| (at.saturating_sub(1)..at + 2).any(|at| own.get(at) == Some(&true));
        let rows = [at.wrapping_sub(64), at, at + 64];
        assert_eq!(*is_outlined, rows.into_iter().any(|row| row < own.len() && near(row)));
    }
}

#[test]
fn the_plan_says_whether_a_model_has_lines_and_points() {
    let state = |model: Shared<Model>, surface| {
        let (mut scene, view) = shown(&[(model, at(60.0, 0.0, 0.0, 0.0))], 1.5);
        edit(&mut scene, LINE, |object| object.surface = surface);
        let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(64, 64));
        let (plan, mut uses) = explain_frame(&shot);
        let mut renderer = Renderer::default();
        renderer.render(&plan);
        renderer.count(&mut uses);
        let own = uses.into_iter().find(|it| it.effect == Effect::Strokes).unwrap();
        assert!(plan.without(Effect::Strokes).is_some() == own.state.is_on());
        (own.state, own.pixels)
    };
    let lit = Surface::TextureAndLight;
    let (on, pixels) = state(level(), lit);
    assert_eq!(on, EffectState::On("in the colours of vertices".into()));
    assert!(pixels.unwrap() > 15);
    let in_kd = "in Kd; without a material, in the colour of edges";
    assert_eq!(state(level(), Surface::Material).0, EffectState::On(in_kd.into()));
    assert_eq!(state(square(), lit).0, EffectState::LeftOut("the file has none".into()));
}

#[test]
fn a_plan_of_lines_names_no_light_and_no_surface() {
    let (scene, view) = shown(&[(level(), at(60.0, 0.0, 0.0, 0.0))], 1.5);
    let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(64, 64));
    let (_, uses) = explain_frame(&shot);
    let of_line = |it: &&marraztu_render::EffectUse| {
        it.on.as_ref().is_some_and(|thing| thing.item == ItemId::Object(LINE))
    };
    let on = uses.iter().filter(of_line).filter(|it| it.state.is_on());
    assert_eq!(on.map(|it| it.effect).collect::<Vec<_>>(), [Effect::Strokes]);
    let surfaces = uses.iter().filter(of_line).find(|it| it.effect == Effect::Surfaces).unwrap();
    assert_eq!(surfaces.state, EffectState::LeftOut("it has no faces".into()));
}

#[test]
fn a_wide_point_beside_the_picture_reaches_into_it() {
    let point = strokes(&[([0.0; 3], [1.0; 3])], &[[0, 0]]);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        // Further and further to the right, until nothing of the point is seen.
        let mut seen = Vec::new();
        for step in 0..400 {
            let place = at(1.0, 3.0 * f64::from(step), 0.0, 0.0);
            let (scene, view) = shown(&[(point.clone(), place)], 60.0);
            let view = View { projection, ..view };
            let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(100, 100));
            let [plan, everything] = [plan_frame(&shot), plan_everything(&shot)];
            let picture = Renderer::default().render(&plan).clone();
            assert!(picture == *Renderer::default().render(&everything), "{projection:?} {step}");
            seen.push(covered(&picture, &scene).contains(&true));
        }
        assert!(seen[0] && !seen[399], "{projection:?}");
    }
}

#[test]
fn layers_hold_the_points_of_lines() {
    let (scene, view) = shown(&[(level(), at(60.0, 0.0, 0.0, 50.0))], 4.0);
    let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(64, 64));
    let layers = Renderer::default().layers(&shot, LayerSet::ALL, NormalSpace::Camera);
    let middle = 64 * 32 + 32;
    assert!((layers.floats(Layer::Depth)[middle] - 350.0).abs() < 1e-3);
    assert_eq!(layers.ids(Layer::Object)[middle], 1);
    assert_eq!(layers.ids(Layer::Polygon)[middle], 0);
    assert_eq!(layers.floats(Layer::Normal)[3 * middle..][..3], [0.0; 3]);
}

/// Every kind of stroke, with colours: a square as one line, two lines, and points.
const FILE: &str = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 0\nl 1 2 3 4 1\n\
                    g others\nl 1 3\nl 2 4\np 1 2 3\n";

fn parsed(text: &[u8]) -> Model {
    io::parse(text, "a.obj", None, &LoadOptions::default(), &Progress::new()).unwrap().model
}

#[test]
fn a_file_of_lines_and_points_is_framed_drawn_described_and_exported() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("a.obj"), FILE).unwrap();
    let run = |arguments: &[&str]| {
        let program = env!("CARGO_BIN_EXE_marraztu");
        let out =
            Process::new(program).current_dir(folder.path()).args(arguments).output().unwrap();
        let told = String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned();
        assert!(out.status.success(), "{arguments:?}\n{told}");
        told
    };
    let told = run(&["info", "a.obj"]);
    for line in ["lines           6", "points          3", "  \"others\": 2 lines, 3 points,"] {
        assert!(told.contains(line), "{told}");
    }
    let told = run(&["render", "a.obj", "--size", "200", "--line-width", "8", "--out", "a.png"]);
    assert!(!told.contains("not visible") && !told.contains("nothing"), "{told}");
    let picture = io::load_picture(&at("a.png")).unwrap();
    let background = picture.pixel(0, 0);
    let drawn = picture.pixels().iter().filter(|pixel| **pixel != background).count();
    assert!(drawn > 4000, "{drawn} pixels");

    // OBJ keeps polylines, parts and colours.
    run(&["export", "a.obj", "--out", "b.obj"]);
    let text = std::fs::read_to_string(at("b.obj")).unwrap();
    assert!(text.contains("l 1 2 3 4 1\n") && text.contains("p 1 2 3\n"), "{text}");
    let (before, after) = (parsed(FILE.as_bytes()), parsed(text.as_bytes()));
    assert_eq!(before.mesh.strokes(), after.mesh.strokes());
    assert_eq!(before.mesh.colors(), after.mesh.colors());
    run(&["export", "a.obj", "--out", "a.gltf"]);
    let text = std::fs::read_to_string(at("a.gltf")).unwrap();
    // A strip, lines, and points.
    for mode in ["\"mode\":3", "\"mode\":1", "\"mode\":0"] {
        assert!(text.replace(' ', "").contains(mode), "{mode}: {text}");
    }
    let options = ["--line-width", "0.5", "--out", "c.png"];
    let out = Process::new(env!("CARGO_BIN_EXE_marraztu"))
        .current_dir(folder.path())
        .args([&["render", "a.obj"], &options[..]].concat())
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&out.stderr).contains("pixels from 1 to 64"));
}

#[test]
fn hidden_parts_have_no_lines_and_the_width_is_kept_in_scene_files() {
    let model = Shared::new(parsed(FILE.as_bytes()));
    let (mut scene, view) = shown(&[(model, at(60.0, -30.0, -30.0, 0.0))], 3.5);
    let count = |scene: &Scene| {
        let picture = draw(scene, &view, &Settings::default(), 128);
        covered(&picture, scene).iter().filter(|is| **is).count()
    };
    let all = count(&scene);
    edit(&mut scene, LINE, |object| _ = object.hidden_parts.insert(1));
    let some = count(&scene);
    assert!(some > 0 && some < all, "{some} of {all}");
    edit(&mut scene, LINE, |object| _ = object.hidden_parts.insert(0));
    assert_eq!(count(&scene), 0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.marraztu");
    Command::Remove(ItemId::Object(LINE)).apply(&mut scene).unwrap();
    io::save(&path, &scene, &view, &Settings::default()).unwrap();
    assert!((io::open(&path, &Progress::new()).unwrap().view.line_width - 3.5).abs() < 1e-12);
}
