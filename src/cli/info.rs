//! `marraztu info`: describes files as plain text or JSON.

use std::fmt::Write as _;
use std::path::Path;

use marraztu_core::scene::{
    Camera, Light, Model, Object, Observer, Projection, Scene, Shape, View,
};
use marraztu_io::{FindingFacts, Input, Loaded, ModelFacts, Progress, describe, with_slashes};
use serde::Serialize;

use super::arguments::{Info, Reading};
use super::failure::Failure;
use super::stage::{Stage, Watch, input, is_scene, load};
use super::talk::{json, print, say};
use super::values::is_standard;

/// Describes each file. An unreadable file is reported, and the rest are still described.
pub(crate) fn info(arguments: &Info) -> Result<(), Failure> {
    let input = input(&arguments.files)?;
    let mut failed = false;
    let mut objects = Vec::new();
    for (i, file) in arguments.files.iter().enumerate() {
        match described(file, input.as_ref(), &arguments.reading) {
            Ok(described) if arguments.json => objects.push(described.facts(file)),
            Ok(described) => {
                let blank = if i == 0 { "" } else { "\n" };
                print(&format!("{blank}{}", described.text(file)))?;
            }
            Err(failure) => {
                say("error", &failure);
                failed = true;
                let (file, error) = (with_slashes(file), failure.to_string());
                objects.push(FileFacts::Unreadable { file, error });
            }
        }
    }
    if arguments.json {
        print(&json(&AllFacts { files: objects }))?;
    }
    if failed { Err(Failure::Told) } else { Ok(()) }
}

/// The content of a file.
enum Described {
    Model(Box<Loaded>),
    Scene(Box<Stage>),
}

/// The facts about a file.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum FileFacts {
    Model(Box<ModelFacts>),
    Scene(SceneFacts),
    Unreadable { file: String, error: String },
}

/// The facts about several files, as JSON.
#[derive(Serialize)]
struct AllFacts {
    files: Vec<FileFacts>,
}

fn described(file: &Path, input: Option<&Input>, reading: &Reading) -> Result<Described, Failure> {
    let input = input.filter(|_| is_standard(file));
    if input.map_or_else(|| is_scene(file), Input::is_scene) {
        return Ok(Described::Scene(Box::new(Stage::of_scene(file, input, Watch::Bar)?)));
    }
    let options = reading.options(file, input);
    Ok(Described::Model(Box::new(match input {
        Some(input) => input.model(&options, &Progress::new())?,
        None => load(file, &options)?,
    })))
}

impl Described {
    fn text(&self, file: &Path) -> String {
        match self {
            Self::Model(loaded) => describe(loaded),
            Self::Scene(stage) => {
                let mut text = scene_text(file, &stage.scene, &stage.view);
                for finding in &stage.findings {
                    // Writing to a string cannot fail.
                    let _ = writeln!(text, "  {finding}");
                }
                text
            }
        }
    }

    fn facts(&self, file: &Path) -> FileFacts {
        match self {
            Self::Model(loaded) => FileFacts::Model(Box::new(ModelFacts {
                // As it was named, not as the model keeps it.
                file: Some(with_slashes(file)),
                ..ModelFacts::of(&loaded.model, &loaded.findings)
            })),
            Self::Scene(stage) => FileFacts::Scene(SceneFacts {
                findings: stage.findings.iter().map(FindingFacts::of).collect(),
                ..SceneFacts::of(file, &stage.scene, &stage.view)
            }),
        }
    }
}

/// The facts about a scene.
#[derive(Serialize)]
struct SceneFacts {
    file: String,
    objects: Vec<ObjectFacts>,
    cameras: Vec<CameraFacts>,
    lights: Vec<LightFacts>,
    background: [u8; 3],
    observer: &'static str,
    projection: &'static str,
    findings: Vec<FindingFacts>,
}

/// An object of a scene.
#[derive(Serialize)]
struct ObjectFacts {
    name: String,
    selected: bool,
    visible: bool,
    file: Option<String>,
    /// Whether a box replaces the file, which is missing.
    missing: bool,
    shape: Option<&'static str>,
    vertices: usize,
    faces: usize,
}

/// A camera of a scene.
#[derive(Serialize)]
struct CameraFacts {
    name: String,
    selected: bool,
    position: [f64; 3],
}

/// A light of a scene.
#[derive(Serialize)]
struct LightFacts {
    slot: u32,
    name: String,
    selected: bool,
    on: bool,
    color: [u8; 3],
    /// The panorama of a sky.
    #[serde(skip_serializing_if = "Option::is_none")]
    panorama: Option<PanoramaFacts>,
}

/// The panorama of a sky.
#[derive(Serialize)]
struct PanoramaFacts {
    file: String,
    missing: bool,
    /// Degrees about Y.
    turn: f64,
    /// Whether it is the background.
    shown: bool,
}

impl SceneFacts {
    fn of(file: &Path, scene: &Scene, view: &View) -> Self {
        let object = |(id, object): (_, &Object)| ObjectFacts {
            selected: view.object == Some(id),
            visible: object.visible,
            ..ObjectFacts::of(&object.name, &object.model)
        };
        let camera = |(id, camera): (_, &Camera)| CameraFacts {
            name: camera.name.clone(),
            selected: view.camera == id,
            position: camera.pose.now().eye.to_array(),
        };
        let light = |(id, light): (_, &Light)| LightFacts {
            slot: light.slot,
            name: light.name.clone(),
            selected: view.light == Some(id),
            on: light.on,
            color: light.color.0,
            panorama: light.kind.panorama().map(|sky| PanoramaFacts {
                file: with_slashes(&sky.panorama.source),
                missing: sky.panorama.is_placeholder(),
                turn: sky.turn,
                shown: sky.is_shown,
            }),
        };
        Self {
            file: with_slashes(file),
            objects: scene.objects.iter().map(object).collect(),
            cameras: scene.cameras.iter().map(camera).collect(),
            lights: scene.lights.iter().map(light).collect(),
            background: scene.background.0,
            observer: match view.observer {
                Observer::Camera => "camera",
                Observer::Object => "object",
            },
            projection: match view.projection {
                Projection::Perspective => "perspective",
                Projection::Orthographic => "orthographic",
            },
            findings: Vec::new(),
        }
    }
}

impl ObjectFacts {
    fn of(name: &str, model: &Model) -> Self {
        Self {
            name: name.to_owned(),
            selected: false,
            visible: true,
            file: model.source.as_deref().map(with_slashes),
            missing: model.is_placeholder() && model.source.is_some(),
            shape: Shape::of(model).map(|shape| shape.name()),
            vertices: model.mesh.positions().len(),
            faces: model.mesh.polygon_count(),
        }
    }

    /// Describes the shape: "a cube, 8 vertices, 6 faces".
    fn text(&self) -> String {
        let Self { missing, shape, vertices, faces, .. } = self;
        if let (true, Some(file)) = (*missing, &self.file) {
            return format!("a box in place of the missing file {file}");
        }
        let kind = shape.map_or_else(String::new, |shape| format!("a {shape}, "));
        format!("{kind}{vertices} vertices, {faces} faces")
    }
}

/// Lists the objects, cameras and lights of a scene, one per line; an asterisk marks the selection.
pub(super) fn scene_text(file: &Path, scene: &Scene, view: &View) -> String {
    let facts = SceneFacts::of(file, scene, view);
    let mut lines = vec![format!("{:16}{}", "scene", file.display())];
    let head = |what: &str, count: usize| format!("{what:16}{count}");
    let mark = |selected| if selected { '*' } else { ' ' };
    lines.push(head("objects", facts.objects.len()));
    for object in &facts.objects {
        let hidden = if object.visible { "" } else { ", not shown" };
        let mark = mark(object.selected);
        lines.push(format!("{mark} {}: {}{hidden}", object.name, object.text()));
    }
    lines.push(head("cameras", facts.cameras.len()));
    for CameraFacts { name, selected, position: [x, y, z] } in &facts.cameras {
        lines.push(format!("{} {name}: at ({x}, {y}, {z})", mark(*selected)));
    }
    lines.push(head("lights", facts.lights.len()));
    for LightFacts { slot, name, selected, on, color: [r, g, b], panorama } in &facts.lights {
        let on = if *on { "on" } else { "out" };
        let sky = panorama.as_ref().map_or_else(String::new, |it| {
            let missing = if it.missing { " (missing)" } else { "" };
            let shown = if it.shown { "" } else { ", not shown" };
            format!(", {}{missing} turned {} deg{shown}", it.file, it.turn)
        });
        lines.push(format!("{} {slot} {name}: {on}, ({r}, {g}, {b}){sky}", mark(*selected)));
    }
    let [r, g, b] = facts.background;
    lines.push(format!("{:16}({r}, {g}, {b})", "background"));
    let projection = match view.projection {
        Projection::Perspective => "in perspective",
        Projection::Orthographic => "in parallel projection",
    };
    // The observer and the projection determine the picture that `render` draws.
    let observer = facts.observer;
    lines.push(format!("{:16}the selected {observer}, {projection}", "observer"));
    lines.push(String::new());
    lines.join("\n")
}
