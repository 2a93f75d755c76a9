//! A drawing job for comparisons with other renderers: a camera orbits a mesh lit by five lights,
//! in one of several modes.
//!
//! The time of a frame runs from the setting of its camera to bytes in memory, including planning.
//! No two frames have the same camera. Loading the mesh is not measured.
//!
//! ```text
//! cargo run --release --example job -- --mesh bunny.obj --mode phong
//! ```

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use cpu_time::ProcessTime;
use fearless_simd::Level;
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Axis, Choice, Filter, LightAt, Samples, Settings};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::{Shared, color::Color, math};
use marraztu_core::scene::{
    Aim, Attenuation, Camera, CameraId, Command, CommandError, Crease, Fill, Item, Lens, Light,
    LightId, LightKind, LoadOptions, Material, MaterialChoice, Mesh, MeshSource, Model, NONE,
    Normals, Object, ObjectId, Orbit, Part, Pose, Scene, Sides, SourceCorner, SpotOwner, Surface,
    Texture, Tracked, View, Wrap, dvec3,
};
use marraztu_io::{self as io, LoadError, Progress, SaveError};
use marraztu_lab::instructions;
use marraztu_lab::statistics::median;
use marraztu_lab::timing::time;
use marraztu_render::{RayCount, Renderer, Timings, plan_frame};

/// Measures one drawing job, in a form that other renderers share.
#[derive(Debug, Parser)]
#[command(
    name = "job",
    after_help = "\
Draws a mesh from an orbit, lit by five lights, and prints one line of comma-separated figures:
R, label, mesh, triangles, mode, size, samples, frames, median and shortest milliseconds a frame,
processor milliseconds a frame, the same three again, and the number of covered pixels.

Exit status 3: this mode, number of samples or instruction set is not supported."
)]
struct Job {
    /// The model (.obj)
    #[arg(long)]
    mesh: PathBuf,
    /// How to draw it: flat, gouraud, phong, nearest, bilinear, trilinear, depth, wire
    #[arg(long)]
    mode: String,
    /// Width and height in pixels; one number for a square
    #[arg(long, value_name = "WxH", default_value = "800x800", value_parser = size)]
    size: Size,
    /// Samples per pixel: 1, 4, 16, 64
    #[arg(long, default_value_t = 1)]
    msaa: u32,
    /// Maximum number of frames to measure
    #[arg(long, default_value_t = 200)]
    frames: usize,
    /// Number of warm-up frames, which are not measured
    #[arg(long, default_value_t = 3)]
    warm: usize,
    /// Milliseconds after which measuring stops
    #[arg(long, default_value_t = 1000.0)]
    budget: f64,
    /// Distance of the camera from the origin
    #[arg(long, default_value_t = 290.0)]
    dist: f64,
    /// Look straight at the mesh and hardly turn
    #[arg(long)]
    face: bool,
    /// Keep the position and size that the mesh has in its file
    #[arg(long)]
    raw: bool,
    /// Let the sun, the bulb and the spots cast shadows, and print a second line: S, label, mesh,
    /// triangles, mode, size, frames, shortest milliseconds with shadows and without, in turn, the
    /// difference, rays and occluded rays of the first frame
    #[arg(long)]
    shadows: bool,
    /// Draw this many objects of the mesh, side by side in a square
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        value_parser = clap::value_parser!(u32).range(1..=10_000)
    )]
    copies: u32,
    /// Print a second line: T, label, and the median milliseconds of each stage: vertices, set-up,
    /// lines, tiles, and all else (plan and damage)
    #[arg(long)]
    stages: bool,
    /// The shadow method: exact, map-2048, map-2048-pcf and others, as in
    /// `marraztu render --shadow-method`
    #[arg(long, value_name = "METHOD", default_value = "exact")]
    shadow_method: String,
    /// Save the first frame's picture: .ppm, .png, .jpg or .webp
    #[arg(long)]
    out: Option<PathBuf>,
    /// The label of the line
    #[arg(long, default_value = "marraztu")]
    label: String,
    /// The instruction set: best, avx512, avx2, sse4.2, plain. The picture is the same
    #[arg(long, value_name = "SET", default_value = "best")]
    instructions: String,
    /// Number of threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Parses a picture's size: "800x600", or "800" for a square.
fn size(text: &str) -> Result<Size, String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=16_384).contains(side));
    let (width, height) = text.split_once(['x', 'X']).unwrap_or((text, text));
    let sides = side(width).zip(side(height)).map(|(width, height)| Size::new(width, height));
    sides.ok_or_else(|| "write width x height, each from 1 to 16384, as 800x600".to_owned())
}

/// The drawing mode of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// Lit once per face, with its normal.
    Flat,
    /// Lit at vertices.
    Gouraud,
    /// Lit at pixels.
    Phong,
    /// Lit at pixels, with a texture.
    Textured(Filter),
    /// One colour.
    Depth,
    /// All edges, each once.
    Wire,
}

impl Mode {
    const ALL: [(&str, Self); 8] = [
        ("flat", Self::Flat),
        ("gouraud", Self::Gouraud),
        ("phong", Self::Phong),
        ("nearest", Self::Textured(Filter::Nearest)),
        ("bilinear", Self::Textured(Filter::Bilinear)),
        ("trilinear", Self::Textured(Filter::Trilinear)),
        ("depth", Self::Depth),
        ("wire", Self::Wire),
    ];
}

/// The reason why a job fails.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error("{0}")]
    Unsupported(String),
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error(transparent)]
    Save(#[from] SaveError),
    #[error(transparent)]
    Scene(#[from] CommandError),
    #[error("standard output: {0}")]
    Output(#[from] std::io::Error),
}

fn main() -> ExitCode {
    let job = Job::parse();
    // This thread joins the pool, since it would otherwise idle.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(job.threads.map_or(0, usize::from));
    // This fails only if the pool exists already, which is impossible here.
    let _ = pool.use_current_thread().build_global();
    let done = run(&job).and_then(|line| Ok(writeln!(std::io::stdout().lock(), "{line}")?));
    let Err(failure) = done else { return ExitCode::SUCCESS };
    let _ = writeln!(std::io::stderr().lock(), "error: {failure}");
    match failure {
        Failure::Unsupported(_) => ExitCode::from(3),
        Failure::Load(_) | Failure::Save(_) | Failure::Scene(_) | Failure::Output(_) => {
            ExitCode::FAILURE
        }
    }
}

/// Draws the job's frames, and returns the line of figures.
fn run(job: &Job) -> Result<String, Failure> {
    let (mode, samples, level) = supported(job).map_err(Failure::Unsupported)?;
    // The job computes its own normals, so the crease angle of the loader does not matter.
    let options = LoadOptions { crease: Crease::SMOOTH, ..LoadOptions::default() };
    let loaded = &io::load(&job.mesh, &options, &Progress::new())?.model;
    let model = prepared(loaded, job.raw, matches!(mode, Mode::Textured(_)));
    let triangles = model.mesh.triangle_count();
    let measured = measure(job, level, &stage(job, mode, samples, Shared::new(model))?)?;
    if let Some(out) = &job.out {
        io::save_picture(out, &measured.picture)?;
    }
    // The count of covered pixels lets other renderers check that they draw the same mesh.
    let pixels = measured.picture.pixels().iter();
    let covered = pixels.filter(|pixel| **pixel != BACKGROUND.opaque()).count();
    let shortest = measured.frames.iter().copied().reduce(f64::min);
    let [median, shortest] = [median(&measured.frames), shortest].map(|ms| ms.unwrap_or(f64::NAN));
    let times = format!("{median:.4},{shortest:.4},{:.4}", measured.processor);
    let (Size { width, height }, frames) = (job.size, measured.frames.len());
    let Job { label, msaa, .. } = job;
    let (mesh, mode) = (job.mesh.display(), &job.mode);
    let drawn = format!("{label},{mesh},{triangles},{mode},{width}x{height},{msaa}");
    let mut line = format!("R,{drawn},{frames},{times},{times},{covered}");
    if job.stages {
        let stages = measured.stages().map(|ms| format!(",{ms:.4}")).concat();
        line += &format!("\nT,{label}{stages}");
    }
    let Some(plain) = measured.plain else { return Ok(line) };
    let RayCount { traced, occluded, .. } = measured.rays;
    let drawn = format!("{label},{mesh},{triangles},{mode},{width}x{height},{frames}");
    let times = format!("{shortest:.3},{plain:.3},{:.3}", shortest - plain);
    Ok(format!("{line}\nS,{drawn},{times},{traced},{occluded}"))
}

/// Returns the mode, samples and instructions of a job, or the unsupported option.
fn supported(job: &Job) -> Result<(Mode, Samples, Level), String> {
    let Job { mode, msaa, instructions, .. } = job;
    let found = Mode::ALL.into_iter().find(|(name, _)| name == mode);
    let (_, mode) = found.ok_or_else(|| {
        let all = Mode::ALL.map(|(name, _)| name).join(", ");
        format!("the mode \"{mode}\" is not supported; possible values: {all}")
    })?;
    let samples = Samples::ALL.into_iter().find(|samples| samples.count() == *msaa);
    let samples = samples.ok_or_else(|| {
        format!("{msaa} samples per pixel are not supported; possible values: 1, 4, 16 and 64")
    })?;
    // Other renderers lack some options, too: status 3 lets a script skip them.
    let level = instructions::named(instructions).ok_or_else(|| {
        format!(
            "the instruction set \"{instructions}\" is unknown, or not supported by this \
                processor; possible values: best, avx512, avx2, sse4.2, plain"
        )
    })?;
    method(job).ok_or_else(|| format!("the shadow method \"{}\" is unknown", job.shadow_method))?;
    Ok((mode, samples, level))
}

/// Returns the chosen shadow method.
fn method(job: &Job) -> Option<&'static Choice> {
    Axis::named("shadow-method")?.choice(&job.shadow_method)
}

/// The measurements of a job.
struct Measured {
    /// The time of each frame in milliseconds.
    frames: Vec<f64>,
    /// The stage timings of each frame.
    timings: Vec<Timings>,
    /// The mean processor milliseconds per frame, summed over all threads.
    processor: f64,
    /// The shortest time of a frame without shadows, if shadows were measured.
    plain: Option<f64>,
    /// The shadow rays of the first picture.
    rays: RayCount,
    /// The first picture.
    picture: Picture,
}

impl Measured {
    /// Returns the median time of each stage and of the rest, in milliseconds.
    fn stages(&self) -> [f64; 5] {
        let of = |stage: &dyn Fn(f64, &Timings) -> f64| {
            let times = self.frames.iter().zip(&self.timings);
            let times: Vec<f64> = times.map(|(all, timings)| stage(*all, timings)).collect();
            median(&times).unwrap_or(f64::NAN)
        };
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        [
            of(&|_, it| ms(it.vertices)),
            of(&|_, it| ms(it.set_up)),
            of(&|_, it| ms(it.lines)),
            of(&|_, it| ms(it.tiles)),
            of(&|all, it| all - ms(it.vertices + it.set_up + it.lines + it.tiles)),
        ]
    }
}

/// The colour of pixels outside the mesh.
const BACKGROUND: Color = Color([26, 26, 31]);

/// A scene with its view and settings.
type Stage = (Scene, View, Settings);

fn measure(
    job: &Job,
    level: Level,
    (scene, view, settings): &Stage,
) -> Result<Measured, CommandError> {
    // One renderer for each kind of frame, so shadow maps are reused.
    let [mut renderer, mut other] = [Renderer::new(level), Renderer::new(level)];
    let unshaded = without_shadows(scene)?;
    let frame = |renderer: &mut Renderer, scene: &Scene, i| -> Result<f64, CommandError> {
        let mut scene = scene.clone();
        let mut changed = Ok(());
        let elapsed = time(|| {
            let camera = Item::Camera(CameraId(0), Box::new(camera(job, i, &scene)));
            changed = Command::Replace(camera).apply(&mut scene).map(drop);
            renderer.render(&plan_frame(&Shot::new(&scene, view, settings, job.size)));
        });
        changed.map(|()| elapsed.as_secs_f64() * 1e3)
    };
    for i in 0..job.warm {
        frame(&mut renderer, scene, i + 1)?;
    }
    let (begun, processor) = (Instant::now(), ProcessTime::now());
    let (mut frames, mut timings) = (Vec::new(), Vec::new());
    let mut plain = None;
    while frames.len() < job.frames.max(1) && begun.elapsed().as_secs_f64() * 1e3 < job.budget {
        let i = job.warm + 1 + frames.len();
        frames.push(frame(&mut renderer, scene, i)?);
        timings.push(renderer.timings());
        // The same camera without shadows, in alternation, so drift affects both alike.
        if job.shadows {
            plain = Some(frame(&mut other, &unshaded, i)?.min(plain.unwrap_or(f64::INFINITY)));
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "few frames")]
    let processor = processor.elapsed().as_secs_f64() * 1e3 / frames.len() as f64;
    // The saved picture is that of the first camera, whatever number of frames fits the budget.
    frame(&mut renderer, scene, 0)?;
    let (picture, rays) = (renderer.picture().clone(), renderer.rays());
    Ok(Measured { frames, timings, processor, plain, rays, picture })
}

/// Returns a copy of the scene without shadows.
fn without_shadows(scene: &Scene) -> Result<Scene, CommandError> {
    let mut plain = scene.clone();
    for (id, light) in scene.lights.iter() {
        let light = Light { shadows: false, ..light.clone() };
        Command::Replace(Item::Light(id, Box::new(light))).apply(&mut plain)?;
    }
    Ok(plain)
}

/// Prepares the job's mesh: its bounding box is centred at the origin, and its farthest vertex is
/// at distance 100. Vertex normals are area-weighted sums of face normals. A `textured` mesh gets
/// texture coordinates.
fn prepared(model: &Model, raw: bool, textured: bool) -> Model {
    let mesh = &model.mesh;
    let positions: Vec<DVec3> = mesh.positions().iter().map(|p| dvec3(*p)).collect();
    // Normalise position and size, so one camera orbit fits every mesh.
    let centre = mesh.bounds().map_or(DVec3::ZERO, |bounds| bounds.centre());
    let farthest = positions.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
    let scale = 100.0 / farthest.max(f64::MIN_POSITIVE);
    let moved = |p: &DVec3| if raw { *p } else { (*p - centre) * scale };
    let positions: Vec<DVec3> = positions.iter().map(moved).collect();
    let mut normals = vec![DVec3::ZERO; positions.len()];
    let position = |corner: u32| mesh.corners()[corner as usize].position;
    let corners: Vec<[u32; 3]> =
        mesh.triangles().iter().map(|triangle| triangle.corners.map(position)).collect();
    // The cross product has twice the area as length, so the sums are area-weighted.
    for [a, b, c] in corners.iter().map(|ids| ids.map(|id| id as usize)) {
        let normal = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
        for vertex in [a, b, c] {
            normals[vertex] += normal;
        }
    }
    let narrow = |v: &DVec3| v.as_vec3().to_array();
    let unit = |v: &DVec3| narrow(&math::unit(*v).unwrap_or(DVec3::Z));
    // Positions, texture coordinates and normals share their indices.
    let corner = |&position: &u32| {
        let uv = if textured { position } else { NONE };
        SourceCorner { position, uv, normal: position }
    };
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    let uv = |p: &DVec3| [(2.0 + p.x / 50.0) as f32, (2.0 + p.y / 50.0) as f32];
    let source = MeshSource {
        positions: positions.iter().map(narrow).collect(),
        uvs: if textured { positions.iter().map(uv).collect() } else { Vec::new() },
        normals: normals.iter().map(unit).collect(),
        corners: corners.as_flattened().iter().map(corner).collect(),
        arities: vec![3; corners.len()],
        polygon_parts: vec![0; corners.len()],
        parts: vec![Part { name: model.name.clone(), material: None }],
        ..MeshSource::default()
    };
    let mesh = Mesh::new(source).expect("a mesh's own triangles are a mesh");
    Model { options: model.options, ..Model::of_mesh(&model.name, mesh) }
}

/// Makes the job's texture: random texels, starting with the row at v = 0.
fn texture() -> Texture {
    const SIDE: usize = 512;
    let mut state = 1_u32;
    let mut byte = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state.to_be_bytes()[0]
    };
    let rows: Vec<[[u8; 4]; SIDE]> =
        (0..SIDE).map(|_| std::array::from_fn(|_| [byte(), byte(), byte(), 255])).collect();
    // Rows of a picture run from top to bottom, so they are reversed.
    let pixels = rows.iter().rev().flatten().copied().collect();
    let picture = Picture::from_pixels(Size::new(SIDE, SIDE), pixels).expect("all its pixels");
    Texture {
        source: PathBuf::new(),
        picture: picture.into(),
        wrap: Wrap::Repeat,
        offset: [0.0; 2],
        scale: [1.0; 2],
    }
}

fn stage(
    job: &Job,
    mode: Mode,
    samples: Samples,
    model: Shared<Model>,
) -> Result<Stage, CommandError> {
    // The depth mode measures rasterisation, so its surface is one constant colour.
    let [ambient, diffuse, specular] = match mode {
        Mode::Depth => [[0.9, 0.8, 0.6], [0.0; 3], [0.0; 3]],
        Mode::Flat | Mode::Gouraud | Mode::Phong | Mode::Textured(_) | Mode::Wire => {
            [[0.8, 0.75, 0.7], [0.8, 0.75, 0.7], [0.5; 3]]
        }
    };
    let material = MaterialChoice::Own(Material {
        specular,
        exponent: 32.0,
        ..Material::matte(ambient, diffuse)
    });
    let mut scene = Scene::with_camera(Camera {
        name: "camera".to_owned(),
        visible: true,
        model: model.clone(),
        material: material.clone(),
        pose: Tracked::new(Pose::facing_minus_z(DVec3::Z * job.dist)),
        lens: Lens::default(),
    });
    scene.background = BACKGROUND;
    let mut object = Object::new(model, material);
    object.edge_color = Color::from_factors([0.9, 0.8, 0.6]);
    // Edges of back faces are drawn, too.
    object.sides = if mode == Mode::Wire { Sides::Two } else { Sides::One };
    let mut settings = Settings { samples, ..Settings::default() };
    match mode {
        Mode::Textured(filter) => {
            object.texture = Some(Shared::new(texture()));
            settings.filter = filter;
        }
        _ => object.surface = Surface::Material,
    }
    // Objects share the mesh; ids continue with the lights.
    for (i, placement) in (1..).zip(placements(job.copies)) {
        let object = Object { placement: Tracked::new(placement), ..object.clone() };
        let item = Item::Object(ObjectId(i), Box::new(object));
        Command::Insert { at: usize::MAX, item }.apply(&mut scene)?;
    }
    for (i, mut light) in (1 + job.copies..).zip(lights(mode)) {
        light.shadows = job.shadows && light.can_cast_shadows();
        let item = Item::Light(LightId(i), Box::new(light));
        Command::Insert { at: usize::MAX, item }.apply(&mut scene)?;
    }
    let view = View {
        marks: false,
        fill: if mode == Mode::Wire { Fill::Edges } else { Fill::Filled },
        normals: if mode == Mode::Flat { Normals::Face } else { Normals::Vertex },
        ..scene.first_view()
    };
    settings = method(job).map_or(settings, |method| method.of(&settings));
    // The mode decides where lighting is evaluated.
    settings.light = match mode {
        Mode::Flat => LightAt::Face,
        Mode::Gouraud => LightAt::Vertex,
        Mode::Phong | Mode::Textured(_) | Mode::Depth | Mode::Wire => LightAt::Pixel,
    };
    Ok((scene, view, settings))
}

/// Places copies of the mesh. A single copy stays at the origin; more are shrunk to fit a square
/// that is two meshes wide.
fn placements(copies: u32) -> impl Iterator<Item = DMat4> {
    let side = (1..).find(|side| side * side >= copies).unwrap_or(copies);
    let scale = if copies == 1 { 1.0 } else { 2.0 / f64::from(side) };
    let at = move |i: u32| (f64::from(i) - f64::from(side - 1) / 2.0) * 150.0 * scale;
    (0..copies).map(move |i| {
        let place = DVec3::new(at(i % side), at(i / side), 0.0);
        DMat4::from_translation(place) * DMat4::from_scale(DVec3::splat(scale))
    })
}

fn lights(mode: Mode) -> Vec<Light> {
    let ambient = if mode == Mode::Depth { [1.0; 3] } else { [0.15; 3] };
    let light = |slot, color, kind| Light {
        color: Color::from_factors(color),
        attenuation: Attenuation::default(),
        ..Light::new("light", slot, kind)
    };
    // The job's spots have no distance falloff.
    let steady = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 };
    let unfading = |slot, color, kind| Light { attenuation: steady, ..light(slot, color, kind) };
    let spot = |position: DVec3| LightKind::Spot {
        owner: SpotOwner::Fixed(Tracked::new(Aim {
            position,
            direction: math::unit(-position).unwrap_or(DVec3::NEG_Z),
        })),
        half_aperture: 22.5,
        exponent: 5.0,
    };
    let sun = math::unit(-DVec3::new(0.5, 0.8, 0.6)).unwrap_or(DVec3::NEG_Y);
    let bulb = Tracked::new(DVec3::new(150.0, 120.0, 180.0));
    vec![
        light(0, ambient, LightKind::Ambient),
        light(1, [0.45, 0.43, 0.40], LightKind::Sun { direction: Tracked::new(sun) }),
        light(2, [0.50, 0.45, 0.40], LightKind::Bulb { position: bulb, orbit: Orbit::default() }),
        unfading(3, [0.50, 0.20, 0.20], spot(DVec3::new(-200.0, 150.0, 150.0))),
        unfading(4, [0.20, 0.30, 0.60], spot(DVec3::new(100.0, -180.0, 200.0))),
    ]
}

/// Returns camera `i` of the orbit.
#[expect(clippy::cast_precision_loss, reason = "few frames")]
fn camera(job: &Job, i: usize, scene: &Scene) -> Camera {
    let (yaw, pitch) =
        if job.face { (0.002 * i as f64, 0.0) } else { (0.6 + 0.02 * i as f64, 0.349_066) };
    let turn = DMat4::from_mat3(math::rotation(DVec3::Y, yaw) * math::rotation(DVec3::X, -pitch));
    let eye = turn.transform_point3(DVec3::Z * job.dist);
    let mut camera = scene.cameras.get(CameraId(0)).expect("a scene always has a camera").clone();
    let last = camera.pose.now().axes;
    let axes = math::look_at(eye, DVec3::ZERO, DVec3::Y, last);
    camera.pose = Tracked::new(Pose { axes, ..Pose::facing_minus_z(eye) });
    camera
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "v 5 5 5\nv 6 5 5\nv 6 6 5\nv 5 6 5\nf 1 2 3 4\n";

    /// Two sides of a tent, one facing away.
    const TENT: &str = "v -1 0 -1\nv 1 0 -1\nv 0 1 0\nv 0 -1 1\nf 1 3 2\nf 1 4 2\nf 4 3 1\n";

    /// Returns the cells of the line, and the pixels of the picture.
    fn drawn(
        threads: usize,
        model: &str,
        options: &[&str],
    ) -> Result<(Vec<String>, Vec<u8>), Failure> {
        let folder = tempfile::tempdir().unwrap();
        let [mesh, out] = ["mesh.obj", "drawn.ppm"].map(|name| folder.path().join(name));
        std::fs::write(&mesh, model).unwrap();
        let fixed = ["--size", "96x64", "--frames", "1"].map(Into::into);
        let files = ["--mesh".into(), mesh.into_os_string(), "--out".into(), out.clone().into()];
        let options = options.iter().map(Into::into);
        let name = std::iter::once("job".into());
        let job = Job::try_parse_from(name.chain(fixed).chain(files).chain(options)).unwrap();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let line = pool.install(|| run(&job))?;
        let picture = std::fs::read(out).unwrap();
        let pixels = picture[picture.len() - 96 * 64 * 3..].to_vec();
        Ok((line.split(',').map(str::to_owned).collect(), pixels))
    }

    #[test]
    fn the_line_has_every_cell_and_the_picture_does_not_depend_on_instructions_or_threads() {
        let square = |threads, options: &[&str]| {
            let options = [&["--dist", "300"], options].concat();
            drawn(threads, SQUARE, &options).unwrap()
        };
        let (cells, best) = square(2, &["--mode", "phong"]);
        assert_eq!(cells.len(), 15);
        assert_eq!(cells[3..8], ["2", "phong", "96x64", "1", "1"]);
        assert!(cells[14].parse::<u32>().unwrap() > 100, "{cells:?}");
        assert!(square(3, &["--mode", "phong", "--instructions", "plain"]).1 == best);
        assert!(square(2, &["--mode", "flat"]).1 != best);
    }

    #[test]
    fn copies_are_placed_side_by_side_and_each_stage_is_timed() {
        let covered = |copies| {
            let options = ["--mode", "phong", "--dist", "300", "--stages", "--copies", copies];
            let (cells, pixels) = drawn(2, SQUARE, &options).unwrap();
            assert_eq!(cells.len(), 15 + 6, "{cells:?}");
            assert!(cells[16..].iter().all(|ms| ms.parse::<f64>().unwrap() >= 0.0), "{cells:?}");
            let columns = pixels.as_chunks::<3>().0.as_chunks::<96>().0;
            let background = |x: &usize| columns.iter().all(|row| row[*x] == [26, 26, 31]);
            let (count, _) = cells[14].split_once('\n').unwrap();
            (count.parse::<u32>().unwrap(), (44..52).any(|x| background(&x)))
        };
        let ((one, one_parts), (four, four_parts)) = (covered("1"), covered("4"));
        assert!(one > 100 && four > 100, "{one} {four}");
        assert!(!one_parts && four_parts, "a column of background parts four copies");
    }

    #[test]
    fn edges_have_one_colour_whichever_way_their_faces_are_turned() {
        let (cells, pixels) = drawn(2, TENT, &["--mode", "wire"]).unwrap();
        let pixels = pixels.as_chunks::<3>().0;
        let count = |color| pixels.iter().filter(|pixel| **pixel == color).count();
        let (edges, background) = (count([230, 204, 153]), count([26, 26, 31]));
        assert_eq!(edges + background, pixels.len());
        assert!(edges > 20, "{edges}");
        assert_eq!(cells[14], edges.to_string());
    }

    #[test]
    fn unsupported_options_are_refused_in_one_sentence() {
        for (options, sentence) in [
            (["--mode", "phong", "--msaa", "3"], "3 samples per pixel are not supported"),
            (["--mode", "phong", "--instructions", "foo"], "instruction set \"foo\" is unknown"),
            (["--mode", "oil", "--msaa", "1"], "mode \"oil\" is not supported"),
        ] {
            let Err(Failure::Unsupported(said)) = drawn(1, SQUARE, &options) else {
                panic!("{options:?} is drawn");
            };
            assert!(said.contains(sentence) && said.lines().count() == 1, "{said}");
        }
    }
}
