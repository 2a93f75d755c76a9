//! Previews of materials as small spheres, drawn by the program's renderer.
//!
//! The preview shows a sphere of radius 1 through an orthographic camera, lit by ambient light and
//! by a sun from the upper left. It is drawn at twice its size and averaged over squares of four
//! pixels. Its outline is not the renderer's, which is not anti-aliased, but a disk with alpha
//! equal to the coverage of each border pixel. The sphere is slightly larger than the disk.

use std::sync::Arc;

use egui::mutex::Mutex;
use egui::{Color32, ColorImage, Id, Rect, TextureHandle, TextureOptions, Ui, pos2};
use fearless_simd::Level;
use glam::DVec3;

use marraztu_core::accuracy::Settings;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::math;
use marraztu_core::scene::{
    Camera, Command, Item, Lens, Light, LightId, LightKind, Material, MaterialChoice, Mesh,
    MeshSource, Model, NONE, Object, ObjectId, PresetId, Projection, Scene, SourceCorner, Tracked,
};
use marraztu_io::cam_model;
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

/// The supersampling factor per axis.
const FINER: usize = 2;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sphere {
    /// One of the nineteen presets.
    Preset(PresetId),
    /// The material of a file.
    File(Material),
    /// A material edited by the user.
    Own(Material),
}

impl Sphere {
    fn material(self) -> Material {
        match self {
            Self::Preset(id) => id.get().material,
            Self::File(material) | Self::Own(material) => material,
        }
    }

    /// Returns the index of its texture. Spheres with equal indices share one texture in turn.
    fn place(self) -> usize {
        match self {
            Self::Preset(id) => PresetId::all().position(|other| other == id).unwrap_or(0),
            Self::File(_) => PresetId::all().len(),
            Self::Own(_) => PresetId::all().len() + 1,
        }
    }
}

/// Draws the sphere of a material into a square.
pub(crate) fn paint(ui: &Ui, rect: Rect, sphere: Sphere) {
    let side = (rect.width().min(rect.height()) * ui.pixels_per_point()).round();
    // Dialogs use another size, so each layer has separate textures.
    let id = Id::unique(("spheres of materials", ui.layer_id()));
    let all = ui.data_mut(|data| data.get_temp_mut_or_default::<Arc<Mutex<Spheres>>>(id).clone());
    let texture = all.lock().texture(ui, sphere, pixels(side));
    let rect =
        Rect::from_center_size(rect.center(), egui::Vec2::splat(side / ui.pixels_per_point()));
    let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture, rect, all, Color32::WHITE);
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "kept from 1 to 512")]
fn pixels(side: f32) -> usize {
    side.clamp(1.0, 512.0) as usize
}

/// The textures of spheres drawn so far, and the scene and renderer for others.
#[derive(Default)]
struct Spheres {
    drawn: Vec<Option<Drawn>>,
    studio: Option<(Scene, Renderer)>,
}

struct Drawn {
    material: Material,
    side: usize,
    texture: TextureHandle,
}

impl Spheres {
    fn texture(&mut self, ui: &Ui, sphere: Sphere, side: usize) -> egui::TextureId {
        let (place, material) = (sphere.place(), sphere.material());
        self.drawn.resize_with(self.drawn.len().max(place + 1), || None);
        if let Some(drawn) = &self.drawn[place]
            && drawn.material == material
            && drawn.side == side
        {
            return drawn.texture.id();
        }
        // The studio is created with the first sphere and used for all.
        let (scene, renderer) = self.studio.get_or_insert_with(studio);
        let image = image(scene, renderer, material, side);
        let texture =
            ui.ctx().load_texture(format!("sphere {place}"), image, TextureOptions::LINEAR);
        let id = texture.id();
        self.drawn[place] = Some(Drawn { material, side, texture });
        id
    }
}

/// Creates a scene with a sphere, a camera and two lights.
fn studio() -> (Scene, Renderer) {
    let lens = Lens { half_size: 0.95, parallel_far: 10.0, ..Lens::default() };
    let camera = Camera::new("", cam_model(), MaterialChoice::File, DVec3::Z * 5.0);
    let mut scene = Scene::with_camera(Camera { visible: false, lens, ..camera });
    let direction = math::unit(DVec3::new(0.5, -0.6, -0.75)).unwrap_or(DVec3::NEG_Z);
    let sun = LightKind::Sun { direction: Tracked::new(direction) };
    let object = Object::new(ball(), MaterialChoice::File);
    let items = [
        Item::Object(ObjectId(1), Box::new(object)),
        Item::Light(LightId(2), Box::new(Light::new("", 0, LightKind::Ambient))),
        Item::Light(LightId(3), Box::new(Light::new("", 1, sun))),
    ];
    let inserts = items.map(|item| Command::Insert { at: 0, item });
    let inserted = Command::Batch(inserts.into()).apply(&mut scene);
    debug_assert!(inserted.is_ok(), "{inserted:?}");
    (scene, Renderer::new(Level::new()))
}

/// Draws a disk of `side` by `side` pixels that shows a material.
fn image(
    scene: &mut Scene,
    renderer: &mut Renderer,
    material: Material,
    side: usize,
) -> ColorImage {
    // The object in the scene gets the material, and the scene is drawn again.
    if let Some(object) = scene.objects.get(ObjectId(1)) {
        let object = Object { material: MaterialChoice::Own(material), ..object.clone() };
        let item = Item::Object(ObjectId(1), Box::new(object));
        let replaced = Command::Replace(item).apply(scene);
        debug_assert!(replaced.is_ok(), "{replaced:?}");
    }
    let mut view = scene.first_view();
    view.projection = Projection::Orthographic;
    let size = Size::new(side * FINER, side * FINER);
    let plan = plan_frame(&Shot::new(scene, &view, &Settings::default(), size));
    disk(renderer.render(&plan), side)
}

/// Averages squares of four pixels, and cuts out a disk.
#[expect(clippy::cast_precision_loss, reason = "a sphere has a few hundred pixels at most")]
fn disk(picture: &Picture, side: usize) -> ColorImage {
    let radius = side as f32 / 2.0;
    let mut pixels = Vec::with_capacity(side * side);
    for y in 0..side {
        for x in 0..side {
            let mut sum = [0_u32; 3];
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let pixel = picture.pixel(x * FINER + dx, y * FINER + dy);
                sum.iter_mut().zip(pixel).for_each(|(sum, part)| *sum += u32::from(part));
            }
            let [r, g, b] = sum.map(|sum| u8::try_from((sum + 2) / 4).unwrap_or(u8::MAX));
            let away = (x as f32 + 0.5 - radius).hypot(y as f32 + 0.5 - radius);
            let cover = marraztu_core::base::color::byte(f64::from(radius - 0.5 - away + 0.5));
            pixels.push(Color32::from_rgba_unmultiplied(r, g, b, cover));
        }
    }
    ColorImage::new([side, side], pixels)
}

/// Creates a sphere of radius 1 with exact normals.
fn ball() -> Shared<Model> {
    const RINGS: u32 = 24;
    const SECTORS: u32 = 48;
    let mut source = MeshSource::of_polygons([], Vec::new());
    // Vertices in rings from pole to pole. The poles are rings of equal points.
    for ring in 0..=RINGS {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(RINGS);
        for sector in 0..SECTORS {
            let angle = std::f64::consts::TAU * f64::from(sector) / f64::from(SECTORS);
            let across = libm::sin(polar);
            let place = [across * libm::sin(angle), libm::cos(polar), across * libm::cos(angle)];
            source.positions.push(place.map(narrow));
        }
    }
    source.normals.clone_from(&source.positions);
    // Positions of a unit sphere are also its normals.
    let corner = |ring: u32, sector: u32| {
        let position = ring * SECTORS + sector % SECTORS;
        SourceCorner { position, uv: NONE, normal: position }
    };
    for ring in 0..RINGS {
        for sector in 0..SECTORS {
            source.push_polygon(&[
                corner(ring, sector),
                corner(ring + 1, sector),
                corner(ring + 1, sector + 1),
                corner(ring, sector + 1),
            ]);
        }
    }
    Shared::new(Model::of_mesh(
        "ball",
        Mesh::new(source).expect("all places are finite and all indices in range"),
    ))
}

#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
fn narrow(number: f64) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_its_material_brightest_at_the_upper_left_and_clear_about_it() {
        let (mut scene, mut renderer) = studio();
        let red = Material::matte([0.1, 0.0, 0.0], [0.8, 0.0, 0.0]);
        let image = image(&mut scene, &mut renderer, red, 32);
        let at = |x: usize, y: usize| image.pixels[y * 32 + x];
        assert_eq!(at(0, 0), Color32::TRANSPARENT);
        assert_eq!(at(16, 16).a(), 255);
        assert!(at(11, 9).r() > at(16, 16).r() && at(16, 16).r() > at(24, 26).r());
        assert!(image.pixels.iter().all(|pixel| pixel.g() == 0 && pixel.b() == 0), "no background");
        // The far side gets ambient light only: 0.1 of 255.
        assert_eq!(at(25, 27).r(), 26);
    }
}
