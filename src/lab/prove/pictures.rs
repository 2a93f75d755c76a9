//! A dozen pictures and more by their sums: the same on every processor.
//!
//! The sum is FNV-1a (Fowler, Noll and Vo) in 64 bits, over width, height and the bytes of the
//! pixels. The list of what the sums are is `tests/pictures.sums`; `marraztu prove pictures` prints it
//! for the machine that it runs on.

use fearless_simd::Level;
use glam::{DMat4, DVec3};

use super::dice::Dice;
use super::stage::{self, Flat};
use crate::base::Shared;
use crate::base::image::{Picture, Size};
use crate::io;
use crate::render::screen::coverage::{SUBPIXELS, Snapped};
use crate::render::{FramePlan, Renderer};
use crate::scene::{
    AXES, Arithmetic, Command, Fill, Filter, Item, LightAt, LoadOptions, Mesh, MeshSource, Model,
    NONE, Normals, Object, Part, Projection, Samples, Scene, Settings, SourceCorner, SpecularForm,
    SpecularPower, Texture, View, Wrap,
};

/// Pixels to a side.
const SIDE: usize = 128;

/// The levels of instructions that this processor has, the oldest first.
#[must_use]
pub fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![Level::baseline()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(
        [best.as_sse4_2().map(Level::Sse4_2), best.as_avx2().map(Level::Avx2)]
            .into_iter()
            .flatten(),
    );
    levels.push(best);
    levels
}

/// A picture that has to come out the same everywhere.
#[derive(Debug)]
pub struct Sample {
    /// What it shows.
    pub name: String,
    plan: FramePlan,
}

impl Sample {
    /// The picture's sum, drawn with these instructions by these many threads.
    ///
    /// # Panics
    /// Where the system has no more threads to give.
    #[must_use]
    pub fn sum(&self, level: Level, threads: usize) -> u64 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("the system gives threads");
        pool.install(|| sum(Renderer::new(level).render(&self.plan)))
    }
}

/// FNV-1a over a picture.
#[must_use]
pub fn sum(picture: &Picture) -> u64 {
    let Size { width, height } = picture.size();
    let sides = [width, height].map(|side| (side as u64).to_le_bytes());
    let bytes = sides.as_flattened().iter().chain(picture.pixels().as_flattened());
    bytes.fold(0xcbf2_9ce4_8422_2325, |sum, byte| {
        (sum ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// The dozen.
#[must_use]
pub fn samples() -> Vec<Sample> {
    let (scene, view) = io::default_scene();
    let near = nearer(&scene);
    let settings = Settings::default();
    let sample = |name: &str, scene: &Scene, view: &View, settings: Settings| {
        let plan = FramePlan::new(scene, view, &settings, Size::new(SIDE, SIDE));
        Sample { name: String::from(name), plan }
    };
    let (arithmetic, power) = (Arithmetic::F64, SpecularPower::Library);
    let exact = Settings { arithmetic, power, ..settings };
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
    let (stage, from_above) = stage::scene(&[scattered()], SIDE);
    let mut all = vec![
        sample("first scene", &scene, &view, settings),
        sample("first scene in f64", &scene, &view, exact),
        sample("near", &near, &view, settings),
        sample("near, lit at vertices", &near, &view, at(LightAt::Vertex)),
        sample("near, lit at faces", &near, &view, at(LightAt::Face)),
        sample("near, half-vector", &near, &view, half),
        sample("face normals", &near, &faces, settings),
        sample("in parallel", &scene, &parallel, settings),
        sample("edges and back faces", &near, &edges, settings),
        sample("edges and normals over", &near, &drawn, settings),
        sample("texture", &textured, &view, settings),
        sample("texture, nearest", &textured, &view, rough),
        sample("scattered triangles", &stage, &from_above, settings),
        sample("four samples", &near, &drawn, of(Samples::Four)),
        sample("sixteen samples", &stage, &from_above, of(Samples::Sixteen)),
        sample("four samples, each lit", &near, &drawn, each_lit),
    ];
    let bent = bent(&textured);
    for (axis, choice) in AXES.iter().flat_map(|axis| axis.choices.iter().map(move |it| (axis, it)))
    {
        let rare = choice.of(&settings);
        if rare != settings && rare.is_alike_everywhere() {
            let name = format!("{} {}", axis.key, choice.word);
            all.push(sample(&name, &bent, &view, rare));
        }
    }
    all
}

/// The same, stretched, with a texture that has light on it.
fn bent(scene: &Scene) -> Scene {
    change(scene, |object| {
        let stretch = DMat4::from_scale(DVec3::new(1.0, 0.4, 1.0));
        object.placement = object.placement.replaced(*object.placement.now() * stretch);
    })
}

/// The first scene with everything about its first object, which is cut by the near plane.
fn nearer(scene: &Scene) -> Scene {
    change(scene, |object| {
        let place = DMat4::from_translation(DVec3::new(5.0, -8.0, 370.0));
        let turn = DMat4::from_rotation_y(0.7) * DMat4::from_rotation_x(0.3);
        object.placement = object.placement.replaced(place * turn);
    })
}

/// The same with a picture of noise laid over it.
fn textured(scene: &Scene) -> Scene {
    let mut dice = Dice::new(5);
    let texels = (0..64).map(|_| dice.bits().to_le_bytes());
    let texels = texels.map(|[r, g, b, ..]| [r, g, b, 255]).collect();
    let texture = Shared::new(Texture {
        source: std::path::PathBuf::new(),
        picture: Picture::from_pixels(Size::new(8, 8), texels).unwrap_or_default().into(),
        wrap: Wrap::Repeat,
        offset: [0.1, 0.2],
        scale: [3.0, 5.0],
    });
    change(scene, |object| {
        object.model = wall();
        object.texture = Some(texture);
    })
}

/// A leaning square of two by two quads with places on the texture.
fn wall() -> Shared<Model> {
    let mut source = MeshSource {
        parts: vec![Part { name: "wall".to_owned(), material: None }],
        polygon_parts: vec![0; 4],
        arities: vec![4; 4],
        ..MeshSource::default()
    };
    for i in 0..9_u8 {
        let (x, y) = (f32::from(i % 3) - 1.0, f32::from(i / 3) - 1.0);
        source.positions.push([9.0 * x, 9.0 * y, -3.0 * x * y]);
        source.uvs.push([x, y]);
    }
    for first in [0, 1, 3, 4] {
        for i in [first, first + 1, first + 4, first + 3] {
            source.corners.push(SourceCorner { position: i, uv: i, normal: NONE });
        }
    }
    Shared::new(Model {
        name: "wall".to_owned(),
        source: None,
        options: LoadOptions::default(),
        mesh: Mesh::new(source).expect("these numbers are finite"),
        materials: Vec::new(),
        edge_color: None,
    })
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

/// Triangles of all sizes, over and under each other.
fn scattered() -> Vec<Flat> {
    let mut dice = Dice::new(7);
    let far = i32::try_from(SIDE).expect("small") * SUBPIXELS;
    let mut triangle = |_| {
        let mut corner =
            || Snapped { x: dice.between(-far / 2, 2 * far), y: dice.between(-far / 2, 2 * far) };
        let corners = [corner(), corner(), corner()];
        let distances = [0, 1, 2].map(|_| f64::from(dice.between(0, 1024)));
        Flat { corners, distances }
    };
    (0..300).map(&mut triangle).collect()
}
