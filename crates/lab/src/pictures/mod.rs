//! The listed pictures: the same bytes on every processor.
//!
//! Some show one feature each, and one is drawn for each choice of each axis of accuracy. Their
//! hashes are listed in `tests/pictures.sums`, which is built into the program: `marraztu verify`
//! draws the pictures and compares.

pub mod flat;

use fearless_simd::Level;
use glam::{DMat4, DVec3};

use self::flat::Flat;
use super::hash::fnv1a;
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{AXES, Arithmetic, Filter, LightAt, Samples, Settings, SpecularForm};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::base::threads::{self, Caller};
use marraztu_core::edit::lighting;
use marraztu_core::scene::{
    Command, Fill, Item, Mesh, MeshSource, Model, NONE, Normals, Object, Panorama, Projection,
    Scene, SourceCorner, Texture, View,
};
use marraztu_io as io;
use marraztu_render::plan_frame;
use marraztu_render::screen::coverage::{SUBPIXELS, Snapped};
use marraztu_render::{FramePlan, Renderer};

/// The width and height of the pictures in pixels.
const SIDE: usize = 128;

/// A picture with the same bytes on every processor.
#[derive(Debug)]
pub struct TestPicture {
    /// The name of the picture.
    pub name: String,
    plan: FramePlan,
}

impl TestPicture {
    /// Draws the picture with these instructions and this number of threads, or fewer if the system
    /// limits them. Without a further thread, as in WebAssembly, the pool of the process draws.
    pub fn draw(&self, level: Level, threads: usize) -> Picture {
        let draw = || Renderer::new(level).render(&self.plan).clone();
        match threads::pool(threads, Caller::Waits, "picture") {
            Ok(pool) => pool.install(draw),
            Err(_limit) => draw(),
        }
    }

    /// Returns the name of the picture as the name of a file without its ending.
    pub fn file_stem(&self) -> String {
        self.name.replace(|letter: char| !letter.is_ascii_alphanumeric(), "-")
    }
}

/// Hashes the width, the height and the bytes of a picture with FNV-1a.
pub fn sum(picture: &Picture) -> u64 {
    let Size { width, height } = picture.size();
    let sides = [width, height].map(|side| (side as u64).to_le_bytes());
    let bytes = sides.as_flattened().iter().chain(picture.pixels().as_flattened());
    fnv1a(bytes.copied().map(u64::from))
}

/// Returns the list: the name of each picture with its hash.
///
/// # Panics
/// If a line of the list is neither a comment nor a hash with a name.
pub fn listed() -> Vec<(&'static str, u64)> {
    let line = |line: &'static str| {
        let (sum, name) = line.split_once("  ")?;
        Some((name, u64::from_str_radix(sum, 16).ok()?))
    };
    include_str!("../../../../tests/pictures.sums")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|text| line(text).expect("a line has a sum and a name"))
        .collect()
}

/// Returns the pictures, in the order of the list.
pub fn all() -> Vec<TestPicture> {
    let (scene, view) = io::default_scene();
    let near = nearer(&scene);
    let settings = Settings::default();
    let picture = |name: &str, scene: &Scene, view: &View, settings: Settings| {
        let plan = plan_frame(&Shot::new(scene, view, &settings, Size::new(SIDE, SIDE)));
        TestPicture { name: String::from(name), plan }
    };
    let exact = Settings { arithmetic: Arithmetic::F64, ..settings };
    let at = |light| Settings { light, ..settings };
    let parallel = View { projection: Projection::Orthographic, ..view.clone() };
    let faces = View { normals: Normals::Face, ..view.clone() };
    let edges = View { fill: Fill::Edges, back_faces: true, ..view.clone() };
    let drawn = View {
        edges_over_fill: true,
        wide_lines: true,
        face_normals: true,
        vertex_normals: true,
        ..view.clone()
    };
    let of = |samples| Settings { samples, ..settings };
    let each_lit = Settings { light: LightAt::Sample, ..of(Samples::Four) };
    let half = Settings { specular: SpecularForm::HalfVector, ..settings };
    let (textured, rough) = (textured(&near), Settings { filter: Filter::Nearest, ..settings });
    let filtered = Settings { filter: Filter::Trilinear, ..each_lit };
    // Overlapping random triangles stress coverage and depth.
    let (stage, from_above) = flat::scene(&[scattered()], SIDE);
    let mut all = vec![
        picture("first scene", &scene, &view, settings),
        picture("first scene in f64", &scene, &view, exact),
        picture("near", &near, &view, settings),
        picture("near, lit at vertices", &near, &view, at(LightAt::Vertex)),
        picture("near, lit at faces", &near, &view, at(LightAt::Face)),
        picture("near, half-vector", &near, &view, half),
        picture("face normals", &near, &faces, settings),
        picture("in parallel", &scene, &parallel, settings),
        picture("edges and back faces", &near, &edges, settings),
        picture("edges and normals over", &near, &drawn, settings),
        picture("texture", &textured, &view, settings),
        picture("texture, nearest", &textured, &view, rough),
        picture("scattered triangles", &stage, &from_above, settings),
        picture("four samples", &near, &drawn, of(Samples::Four)),
        picture("sixteen samples", &stage, &from_above, of(Samples::Sixteen)),
        picture("four samples, each lit", &near, &drawn, each_lit),
        picture("texture, four samples, each lit and filtered", &textured, &view, filtered),
        picture("texture, ideal", &textured, &view, settings.ideal()),
    ];
    let mirrors = io::lesson_scene("mirrors").expect("the program has it");
    for (name, settings) in [
        ("mirrors and glass", settings),
        ("mirrors and glass in f64", exact),
        ("mirrors and glass, sixteen samples", of(Samples::Sixteen)),
    ] {
        all.push(picture(name, &mirrors.scene, &mirrors.view, settings));
    }
    let soft = io::lesson_scene("soft").expect("the program has it");
    all.push(picture("soft shadows", &soft.scene, &soft.view, settings));
    all.push(picture("soft shadows in f64", &soft.scene, &soft.view, exact));
    let studio = in_studio(&soft.scene, &soft.view);
    all.push(picture("sky with occlusion", &studio, &soft.view, settings));
    let outside = under_panorama(&mirrors.scene);
    all.push(picture("panorama", &outside, &mirrors.view, settings));
    all.push(picture("panorama, sixteen samples", &outside, &mirrors.view, of(Samples::Sixteen)));
    // One picture for each choice that differs from the default and is portable.
    let bent = bent(&textured);
    for (axis, choice) in AXES.iter().flat_map(|axis| axis.choices.iter().map(move |it| (axis, it)))
    {
        let rare = choice.of(&settings);
        if rare != settings {
            let name = format!("{} {}", axis.key, choice.word);
            let (scene, view) = match axis.key {
                "bounces" => (&mirrors.scene, &mirrors.view),
                "light-samples" => (&soft.scene, &soft.view),
                _ => (&bent, &view),
            };
            all.push(picture(&name, scene, view, rare));
        }
    }
    all
}

/// Lights a scene by a panorama with a lamp.
fn under_panorama(scene: &Scene) -> Scene {
    const SIZE: Size = Size::new(64, 32);
    let texel = |place: usize| match (place % SIZE.width, place / SIZE.width) {
        (20, 8) => [90.0, 80.0, 60.0],
        #[expect(clippy::cast_precision_loss, reason = "small numbers")]
        (column, row) => [column as f32 / 64.0, 1.0 - row as f32 / 32.0, 0.5],
    };
    let light = (0..SIZE.area()).map(texel).collect();
    let panorama = Panorama::new("", SIZE, light, true).expect("its size fits");
    let mut scene = scene.clone();
    let command = lighting::panorama_alone(&scene, panorama.into()).expect("no light is locked");
    command.apply(&mut scene).expect("it fits");
    scene
}

/// Lights a scene by a sky and a large lamp.
fn in_studio(scene: &Scene, view: &View) -> Scene {
    let mut scene = scene.clone();
    let command = lighting::studio(&scene, view).expect("it has objects");
    command.apply(&mut scene).expect("it is made for the scene");
    scene
}

/// Stretches the first object of a scene.
fn bent(scene: &Scene) -> Scene {
    change(scene, |object| {
        let stretch = DMat4::from_scale(DVec3::new(1.0, 0.4, 1.0));
        object.placement = object.placement.replaced(*object.placement.now() * stretch);
    })
}

/// Moves the first object so close that the near plane clips it.
fn nearer(scene: &Scene) -> Scene {
    change(scene, |object| {
        let place = DMat4::from_translation(DVec3::new(5.0, -8.0, 370.0));
        let turn = DMat4::from_rotation_y(0.7) * DMat4::from_rotation_x(0.3);
        object.placement = object.placement.replaced(place * turn);
    })
}

/// Gives the first object a noise texture.
fn textured(scene: &Scene) -> Scene {
    let mut rng = Rng::new(5);
    let texels = (0..64).map(|_| rng.bits().to_le_bytes());
    let texels = texels.map(|[r, g, b, ..]| [r, g, b, 255]).collect();
    let picture = Picture::from_pixels(Size::new(8, 8), texels).unwrap_or_default();
    let (offset, scale) = ([0.1, 0.2], [3.0, 5.0]);
    let texture = Shared::new(Texture { offset, scale, ..Texture::new("", picture) });
    change(scene, |object| {
        object.model = wall();
        object.texture = Some(texture);
    })
}

/// Builds a leaning square of 2 x 2 quads with texture coordinates.
fn wall() -> Shared<Model> {
    let mut source = MeshSource::of_polygons([], Vec::new());
    for i in 0..9_u8 {
        let (x, y) = (f32::from(i % 3) - 1.0, f32::from(i / 3) - 1.0);
        source.positions.push([9.0 * x, 9.0 * y, -3.0 * x * y]);
        source.uvs.push([x, y]);
    }
    for first in [0, 1, 3, 4] {
        let quad = [first, first + 1, first + 4, first + 3];
        source.push_polygon(&quad.map(|i| SourceCorner { position: i, uv: i, normal: NONE }));
    }
    Shared::new(Model::of_mesh("wall", Mesh::new(source).expect("these numbers are finite")))
}

fn change(scene: &Scene, change: impl FnOnce(&mut Object)) -> Scene {
    let mut scene = scene.clone();
    let id = scene.objects.first().expect("the first scene has objects");
    let mut object = scene.objects.get(id).expect("it is the first").clone();
    change(&mut object);
    let command = Command::Replace(Item::Object(id, Box::new(object)));
    command.apply(&mut scene).expect("it is there");
    scene
}

/// Makes overlapping triangles of all sizes.
fn scattered() -> Vec<Flat> {
    let mut rng = Rng::new(7);
    let far = i32::try_from(SIDE).expect("small") * SUBPIXELS;
    let mut triangle = |_| {
        let mut corner =
            || Snapped { x: rng.between(-far / 2, 2 * far), y: rng.between(-far / 2, 2 * far) };
        let corners = [corner(), corner(), corner()];
        let distances = [0, 1, 2].map(|_| f64::from(rng.between(0, 1024)));
        Flat { corners, distances }
    };
    (0..300).map(&mut triangle).collect()
}
