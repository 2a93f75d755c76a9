//! `marraztu info`: describes files as plain text.

use std::fmt::Write as _;
use std::path::Path;

use marraztu_core::scene::{Model, Observer, Projection, Scene, Shape, View};
use marraztu_io::{Input, Progress, describe};

use super::arguments::{Info, Reading};
use super::failure::Failure;
use super::stage::{Stage, Watch, input, is_scene, load};
use super::talk::{print, say};
use super::values::is_standard;

/// Describes each file. An unreadable file is reported, and the rest are still described.
pub(crate) fn info(arguments: &Info) -> Result<(), Failure> {
    let input = input(&arguments.files)?;
    let mut failed = false;
    for (i, file) in arguments.files.iter().enumerate() {
        let described = match description(file, input.as_ref(), &arguments.reading) {
            Ok(described) => described,
            Err(failure) => {
                say("error", &failure);
                failed = true;
                continue;
            }
        };
        let blank = if i == 0 { "" } else { "\n" };
        print(&format!("{blank}{described}"))?;
    }
    if failed { Err(Failure::Told) } else { Ok(()) }
}

fn description(file: &Path, input: Option<&Input>, reading: &Reading) -> Result<String, Failure> {
    let input = input.filter(|_| is_standard(file));
    if !input.map_or_else(|| is_scene(file), Input::is_scene) {
        let options = reading.options(file, input);
        let loaded = match input {
            Some(input) => input.model(&options, &Progress::new())?,
            None => load(file, &options)?,
        };
        return Ok(describe(&loaded));
    }
    let stage = Stage::of_scene(file, input, Watch::Bar)?;
    let mut text = scene_text(file, &stage.scene, &stage.view);
    for finding in &stage.findings {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {finding}");
    }
    Ok(text)
}

/// Describes the shape of an object: "a cube, 8 vertices, 6 faces".
fn model_text(model: &Model) -> String {
    if let (true, Some(file)) = (model.is_placeholder(), &model.source) {
        return format!("a box in place of the missing file {}", file.display());
    }
    let kind = Shape::of(model).map_or_else(String::new, |shape| format!("a {}, ", shape.name()));
    let (vertices, faces) = (model.mesh.positions().len(), model.mesh.polygon_count());
    format!("{kind}{vertices} vertices, {faces} faces")
}

/// Lists the objects, cameras and lights of a scene, one per line; an asterisk marks the selection.
pub(super) fn scene_text(file: &Path, scene: &Scene, view: &View) -> String {
    let mut lines = vec![format!("{:16}{}", "scene", file.display())];
    let head = |what: &str, count: usize| format!("{what:16}{count}");
    let mark = |selected| if selected { '*' } else { ' ' };
    lines.push(head("objects", scene.objects.len()));
    for (id, object) in scene.objects.iter() {
        let counts = model_text(&object.model);
        let hidden = if object.visible { "" } else { ", not shown" };
        let mark = mark(view.object == Some(id));
        lines.push(format!("{mark} {}: {counts}{hidden}", object.name));
    }
    lines.push(head("cameras", scene.cameras.len()));
    for (id, camera) in scene.cameras.iter() {
        let [x, y, z] = camera.pose.now().eye.to_array();
        lines.push(format!("{} {}: at ({x}, {y}, {z})", mark(view.camera == id), camera.name));
    }
    lines.push(head("lights", scene.lights.len()));
    for (id, light) in scene.lights.iter() {
        let [r, g, b] = light.color.0;
        let on = if light.on { "on" } else { "out" };
        let mark = mark(view.light == Some(id));
        let (slot, name) = (light.slot, &light.name);
        lines.push(format!("{mark} {slot} {name}: {on}, ({r}, {g}, {b})"));
    }
    let [r, g, b] = scene.background.0;
    lines.push(format!("{:16}({r}, {g}, {b})", "background"));
    let projection = match view.projection {
        Projection::Perspective => "in perspective",
        Projection::Orthographic => "in parallel projection",
    };
    // The observer and the projection determine the picture that `render` draws.
    let observer = match view.observer {
        Observer::Camera => "the selected camera",
        Observer::Object => "the selected object",
    };
    lines.push(format!("{:16}{observer}, {projection}", "observer"));
    lines.push(String::new());
    lines.join("\n")
}
