//! The built-in models, and the first scene.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use glam::{DMat4, DVec3};

use super::dimples;
use super::load::parse;
use super::progress::Progress;
use super::texture::own_picture;
use marraztu_core::base::Shared;
use marraztu_core::base::once::get_or_compute;
use marraztu_core::scene::{
    Camera, CameraId, Crease, Light, LightId, List, LoadOptions, MaterialChoice, Model, Object,
    ObjectId, PresetId, Scene, Shape, Texture, Tracked, View,
};

/// A built-in model.
#[derive(Debug)]
struct Asset {
    name: &'static str,
    text: &'static [u8],
    model: OnceLock<Shared<Model>>,
}

impl Asset {
    const fn new(name: &'static str, text: &'static [u8]) -> Self {
        Self { name, text, model: OnceLock::new() }
    }

    /// Returns the model. It is parsed on first use.
    fn model(&self) -> Shared<Model> {
        let read = || {
            let file = format!("{}.obj", self.name);
            let options = LoadOptions { crease: Crease::SMOOTH, ..LoadOptions::default() };
            let loaded = parse(self.text, &file, None, &options, &Progress::new());
            Shared::new(loaded.expect("the program's own models are sound").model)
        };
        get_or_compute(&self.model, read).clone()
    }
}

static CAM: Asset = Asset::new("cam", include_bytes!("../../../assets/cam.obj"));
static X_WING: Asset = Asset::new("x_wing", include_bytes!("../../../assets/x_wing.obj"));
static R_FALKE: Asset = Asset::new("r_falke", include_bytes!("../../../assets/r_falke.obj"));
static BALL: Asset = Asset::new("ball", include_bytes!("../../../assets/lessons/ball.obj"));
static CUSHION: Asset =
    Asset::new("cushion", include_bytes!("../../../assets/lessons/cushion.obj"));
static PLATE: Asset = Asset::new("plate", include_bytes!("../../../assets/lessons/plate.obj"));
static WHEEL: Asset = Asset::new("wheel", include_bytes!("../../../assets/lessons/wheel.obj"));

/// The built-in texture, by its path in a scene file.
const TILES: (&str, &[u8]) = ("own:tiles.png", include_bytes!("../../../assets/lessons/tiles.png"));

/// Returns the pyramid that marks cameras.
pub fn cam_model() -> Shared<Model> {
    CAM.model()
}

/// Finds a built-in model or a simple shape by name.
pub fn own_model(name: &str) -> Option<Shared<Model>> {
    if let Some(shape) = Shape::named(name) {
        return Some(shape.model());
    }
    if name == dimples::NAME {
        static DIMPLES: OnceLock<Shared<Model>> = OnceLock::new();
        return Some(get_or_compute(&DIMPLES, dimples::model).clone());
    }
    let all = [&CAM, &X_WING, &R_FALKE, &BALL, &CUSHION, &PLATE, &WHEEL];
    all.into_iter().find(|asset| asset.name == name).map(Asset::model)
}

/// Finds a built-in texture by its path in a scene file.
pub fn own_texture(path: &str) -> Option<Shared<Texture>> {
    static TEXTURE: OnceLock<Shared<Texture>> = OnceLock::new();
    let (own, content) = TILES;
    let read = || {
        let picture = own_picture(content).expect("the program's own texture is sound");
        Shared::new(Texture::new(own, picture))
    };
    (path == own).then(|| get_or_compute(&TEXTURE, read).clone())
}

/// Builds the first scene, with its view.
///
/// The order is as if three objects had been loaded one after the other, each to the front of the
/// list. The last one is therefore first and selected.
pub fn default_scene() -> (Scene, View) {
    let object = |asset: &Asset, material, place| {
        let mut object = Object::new(asset.model(), MaterialChoice::Preset(material));
        object.placement = Tracked::new(DMat4::from_translation(place));
        object
    };
    let cam = object(&CAM, PresetId::OBSIDIAN, DVec3::new(0.0, 0.0, -400.0));
    let x_wing = object(&X_WING, PresetId::EMERALD, DVec3::new(100.0, 0.0, 0.0));
    let r_falke = object(&R_FALKE, PresetId::RUBY, DVec3::new(-100.0, 0.0, 0.0));
    let (mut scene, _) = empty_scene();
    scene.background = Scene::BACKGROUND;
    scene.objects =
        List::from_iter([(ObjectId(2), r_falke), (ObjectId(1), x_wing), (ObjectId(0), cam)]);
    let view = scene.first_view();
    (scene, view)
}

/// Builds the first scene without its objects, on a background that contrasts with all models.
pub fn empty_scene() -> (Scene, View) {
    let obsidian = MaterialChoice::Preset(PresetId::OBSIDIAN);
    let camera = Camera::new("camera 1", cam_model(), obsidian, DVec3::new(0.0, 0.0, 400.0));
    let lights = Light::five().into_iter().zip(4..).map(|(light, id)| (LightId(id), light));
    let scene = Scene {
        objects: List::default(),
        cameras: List::from_iter([(CameraId(3), camera)]),
        lights: lights.collect(),
        background: Scene::NEUTRAL,
        next_id: 9,
        locked: BTreeSet::new(),
    };
    let view = scene.first_view();
    (scene, view)
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::scene::LightKind;

    #[test]
    fn the_first_scene_is_the_one_of_the_ancestor() {
        let (scene, view) = default_scene();
        let names: Vec<&str> = scene.objects.iter().map(|(_, o)| o.name.as_str()).collect();
        assert_eq!(names, ["r_falke", "x_wing", "cam"]);
        let places: Vec<DVec3> =
            scene.objects.iter().map(|(_, o)| o.placement.now().w_axis.truncate()).collect();
        assert_eq!(places, [DVec3::X * -100.0, DVec3::X * 100.0, DVec3::Z * -400.0]);
        assert_eq!(view.object, scene.objects.first());
        let light = scene.lights.get(view.light.unwrap()).unwrap();
        assert!(matches!(light.kind, LightKind::Sun { .. }));
        assert_eq!(scene.lights.len(), 5);
        let ids = scene.lights.ids().map(|id| id.0);
        assert!(ids.chain(scene.objects.ids().map(|id| id.0)).all(|id| id < scene.next_id));
    }

    #[test]
    fn the_programs_own_models_are_sound_and_have_polygons_of_many_sizes() {
        for asset in [&CAM, &X_WING, &R_FALKE] {
            let loaded =
                parse(asset.text, asset.name, None, &LoadOptions::default(), &Progress::new());
            assert_eq!(loaded.unwrap().findings, []);
            let mesh = &asset.model().mesh;
            for sides in [3, 4, 5] {
                let count = |i: u32| mesh.polygon(i).len();
                let polygons = u32::try_from(mesh.polygon_count()).unwrap();
                let right = (0..polygons).any(|i| count(i).min(5) == sides);
                assert!(right, "{} has no polygon of {sides} corners", asset.name);
            }
        }
    }
}
