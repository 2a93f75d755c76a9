//! Reads every collected public model and compares it with a table of contents.
//!
//! The models belong to others and are not part of the project. If they are missing, the test is
//! skipped with a message; `MARRAZTU_REQUIRE_SHARED=1` makes that a failure, and `MARRAZTU_SHARED`
//! names their folder.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Arithmetic, LightAt, Samples, Settings};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::math;
use marraztu_core::edit::{framing, items, selection};
use marraztu_core::scene::{
    Bounds, Camera, Command, Corner, ItemId, LoadOptions, MaterialChoice, Mesh, Model, Object,
    Pose, Scene, Tracked, View, dvec3, newell,
};
use marraztu_io::{Finding, FindingKind, LoadError, Progress, default_scene, load};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

/// The folder of the models, if it exists.
#[expect(clippy::print_stderr, reason = "who runs the tests has to see what is left out")]
fn models() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let shared = std::env::var_os("MARRAZTU_SHARED").map_or_else(beside, PathBuf::from);
    let models = shared.join("models");
    if models.is_dir() {
        return Some(models);
    }
    let required = std::env::var_os("MARRAZTU_REQUIRE_SHARED").is_some_and(|value| value == "1");
    assert!(!required, "there are no models at {}", models.display());
    eprintln!("LEFT OUT: there are no models at {}", models.display());
    None
}

/// A row of the table.
#[derive(Debug)]
struct Row {
    file: String,
    vertices: usize,
    faces: usize,
    triangles: usize,
    bounds: String,
    features: String,
    purpose: String,
}

impl Row {
    /// The number of faults of a kind that the table lists for the file.
    fn broken(&self, what: &str) -> usize {
        let Some((_, broken)) = self.features.split_once("BROKEN: ") else { return 0 };
        let words: Vec<&str> = broken.split([' ', ',', ';']).collect();
        words.windows(2).find(|two| two[0] == what).map_or(0, |two| two[1].parse().unwrap())
    }
}

fn table(models: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(models.join("MODELS.md")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let file = cells.get(1)?.to_string();
        let number = |i: usize| cells.get(i)?.parse().ok();
        let text = |i: usize| cells.get(i).map(ToString::to_string);
        let (bounds, features, purpose) = (text(6)?, text(7)?, text(8)?);
        let [vertices, faces, triangles] = [number(3)?, number(4)?, number(5)?];
        Some(Row { file, vertices, faces, triangles, bounds, features, purpose })
    };
    text.lines().filter_map(row).collect()
}

/// Loads every file of the table.
fn sweep() -> Option<Vec<(Row, Result<marraztu_io::Loaded, LoadError>)>> {
    let models = models()?;
    let load = |row: Row| {
        let loaded = load(&models.join(&row.file), &LoadOptions::default(), &Progress::new());
        (row, loaded)
    };
    Some(table(&models).into_iter().map(load).collect())
}

fn count(findings: &[Finding], kind: FindingKind) -> usize {
    findings.iter().filter(|finding| finding.kind == kind).map(|finding| finding.count).sum()
}

/// Parses the numbers of "(x, y, z) to (x, y, z)".
fn numbers(bounds: &str) -> Vec<f64> {
    let sign = |c: char| !(c.is_ascii_digit() || "-+.e".contains(c));
    bounds.split(sign).filter_map(|word| word.parse().ok()).collect()
}

/// Whether two sides of a polygon cross as seen along its normal. Sides that touch do not count.
fn crosses_itself(corners: &[DVec3], normal: DVec3) -> bool {
    let side = |i: usize| (corners[i], corners[(i + 1) % corners.len()]);
    let turn = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).dot(normal);
    let cross = |i: usize, j: usize| {
        let ((a, b), (c, d)) = (side(i), side(j));
        turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
    };
    (0..corners.len()).any(|j| (0..j).any(|i| cross(i, j)))
}

/// The polygons of a mesh: index, positions of the corners, normal.
fn polygons(mesh: &Mesh) -> impl Iterator<Item = (u32, Vec<DVec3>, DVec3)> {
    let at = |corner: &Corner| dvec3(mesh.positions()[corner.position as usize]);
    mesh.polygon_normals().iter().zip(0..).map(move |(normal, polygon)| {
        (polygon, mesh.polygon(polygon).iter().map(at).collect(), dvec3(*normal))
    })
}

#[test]
fn every_model_has_as_much_in_it_as_the_table_says() {
    let Some(sweep) = sweep() else { return };
    assert!(sweep.len() > 70, "the table has only {} rows", sweep.len());
    for (row, loaded) in sweep {
        // Files with an unreadable number or without a triangle must be rejected.
        let refused = row.broken("number") > 0 || (row.faces > 0 && row.triangles == 0);
        let loaded = match loaded {
            Err(error) if refused => {
                assert!(matches!(error, LoadError::Line { .. }), "{}: {error}", row.file);
                continue;
            }
            Err(error) => panic!("{} is refused: {error}", row.file),
            Ok(_) if refused => panic!("{} is not refused", row.file),
            Ok(loaded) => loaded,
        };
        let (mesh, findings) = (&loaded.model.mesh, &loaded.findings);
        let found = |kind| count(findings, kind);
        // Counts and findings, as in the table.
        assert_eq!(mesh.positions().len(), row.vertices, "vertices of {}", row.file);
        assert_eq!(found(FindingKind::FaceShort), row.broken("face_short"), "{}", row.file);
        assert_eq!(found(FindingKind::FaceRange), row.broken("face_range"), "{}", row.file);
        assert_eq!(found(FindingKind::FaceRepeats), row.broken("face_repeat"), "{}", row.file);
        let left_out = row.broken("face_short") + row.broken("face_range");
        assert_eq!(mesh.polygon_count(), row.faces - left_out, "faces of {}", row.file);
        assert_eq!(mesh.triangles().len(), row.triangles, "triangles of {}", row.file);
        let kinds = [FindingKind::UvRange, FindingKind::NormalRange];
        let attributes = kinds.map(found).into_iter().max();
        assert_eq!(attributes, Some(row.broken("attr_range")), "{}: {findings:?}", row.file);
        // The bounding box, to the digits of the table.
        let vertices = mesh.positions().iter().map(|place| dvec3(*place) + mesh.offset());
        if let Some(bounds) = Bounds::of(vertices) {
            let ours = [bounds.min.to_array(), bounds.max.to_array()].concat();
            for (ours, theirs) in ours.iter().zip(numbers(&row.bounds)) {
                assert!((ours - theirs).abs() <= 1e-3 * theirs.abs() + 1e-9, "box of {}", row.file);
            }
        }
    }
}

/// The position, normal and texture coordinates of each corner as `tobj` reads them, as bits.
#[expect(clippy::cast_possible_truncation, reason = "the rounding that is meant")]
fn by_tobj(path: &Path) -> Option<Vec<Vec<[Vec<u32>; 3]>>> {
    let (models, _) = tobj::load_obj(path, &tobj::LoadOptions::default()).ok()?;
    let bits = |numbers: &[f64], size: usize, index: Option<&u32>| {
        let begin = *index.unwrap_or(&u32::MAX) as usize * size;
        let row = numbers.get(begin..begin + size).unwrap_or_default();
        row.iter().map(|x| (*x as f32).to_bits()).collect::<Vec<u32>>()
    };
    let mut faces = Vec::new();
    for mesh in models.into_iter().map(|model| model.mesh) {
        let mut begin = 0;
        let triangles = vec![3; mesh.indices.len() / 3];
        let arities = if mesh.face_arities.is_empty() { &triangles } else { &mesh.face_arities };
        for arity in arities {
            let end = begin + *arity as usize;
            let corner = |i: usize| {
                [
                    bits(&mesh.positions, 3, mesh.indices.get(i)),
                    bits(&mesh.normals, 3, mesh.normal_indices.get(i)),
                    bits(&mesh.texcoords, 2, mesh.texcoord_indices.get(i)),
                ]
            };
            faces.push((begin..end).map(corner).collect());
            begin = end;
        }
    }
    Some(faces)
}

#[test]
fn models_are_read_as_tobj_reads_them_bit_for_bit() {
    let Some(models) = models() else { return };
    let mut compared = 0;
    for row in table(&models) {
        let path = models.join(&row.file);
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        // tobj reads lines and points as faces, and miscounts corners if only some have all
        // indices.
        let statement = |word: &str| text.lines().any(|line| line.starts_with(word));
        let loaded = load(&path, &LoadOptions::default(), &Progress::new());
        let (Ok(loaded), false) = (loaded, statement("l ") || statement("p ")) else { continue };
        // tobj assigns the first texture coordinates to faces without any.
        let named = text.lines().any(|line| line.starts_with('f') && line.contains('/'));
        let count = |kind| count(&loaded.findings, kind);
        let mixed = count(FindingKind::UvMixed) + count(FindingKind::NormalMixed);
        let short = count(FindingKind::FaceShort) + count(FindingKind::FaceRange);
        // tobj divides positions by their weights; this program ignores weights and reports them.
        let other = mixed + short + count(FindingKind::Weight);
        let Some(theirs) = by_tobj(&path).filter(|_| other == 0) else { continue };
        let mesh = &loaded.model.mesh;
        assert_eq!(mesh.polygon_count(), theirs.len(), "faces of {}", row.file);
        let row_of = |row: Option<&[f32]>| -> Vec<u32> {
            row.unwrap_or_default().iter().map(|x| x.to_bits()).collect()
        };
        for (polygon, theirs) in (0..).zip(theirs) {
            assert_eq!(mesh.polygon(polygon).len(), theirs.len(), "{}: {polygon}", row.file);
            for (corner, [position, normal, uv]) in mesh.polygon(polygon).iter().zip(theirs) {
                let ours = mesh.positions()[corner.position as usize];
                if mesh.offset() == DVec3::ZERO {
                    assert_eq!(row_of(Some(&ours)), position, "{}: {polygon}", row.file);
                } else {
                    // tobj rounds positions that this program keeps as an offset and differences.
                    let ours = (dvec3(ours) + mesh.offset()).as_vec3().to_array();
                    let theirs = position.iter().map(|bits| f32::from_bits(*bits));
                    let is_near = |(a, b): (f32, f32)| (a - b).abs() <= 2e-7 * b.abs().max(1.0);
                    assert!(ours.into_iter().zip(theirs).all(is_near), "{}", row.file);
                }
                let ours = mesh.uvs().get(corner.uv as usize).map(|row| &row[..]);
                if named {
                    assert_eq!(row_of(ours), uv, "{}: {polygon}", row.file);
                }
                // This program normalises normals; tobj keeps them as written.
                let theirs = normal.iter().map(|bits| f64::from(f32::from_bits(*bits)));
                let theirs = DVec3::from_slice(&theirs.chain([0.0; 3]).collect::<Vec<_>>());
                if let Some(unit) = math::unit(theirs).filter(|_| corner.filed != corner.smooth) {
                    let ours = mesh.points()[corner.filed as usize].normal;
                    assert_eq!(ours, unit.as_vec3().to_array(), "{}: {polygon}", row.file);
                }
            }
        }
        compared += 1;
    }
    assert!(compared > 60, "only {compared} models");
}

#[test]
fn no_polygon_is_cut_outside_its_outline_unless_it_crosses_itself() {
    let Some(sweep) = sweep() else { return };
    let mut checked = 0;
    for (row, loaded) in sweep {
        let Ok(loaded) = loaded else { continue };
        if row.purpose.contains("self-crossing") {
            continue;
        }
        let mesh = &loaded.model.mesh;
        let mut crossing = 0;
        for (polygon, corners, normal) in polygons(mesh) {
            // Triangles cannot be cut wrongly, and self-crossing polygons have no right cut.
            if corners.len() == 3 {
                continue;
            }
            if crosses_itself(&corners, normal) {
                crossing += 1;
                continue;
            }
            checked += 1;
            // A triangle outside the outline would have a negative area.
            let begin = mesh.corners_of(polygon).start;
            for triangle in &mesh.triangles()[mesh.triangles_of(polygon)] {
                let at = |corner: u32| corners[corner as usize - begin];
                let area = newell(triangle.corners.into_iter().map(at)).dot(normal);
                let all = newell(corners.iter().copied()).dot(normal);
                assert!(area > -1e-6 * all, "polygon {polygon} of {}", row.file);
            }
        }
        let found = count(&loaded.findings, FindingKind::PolygonCrosses);
        assert_eq!(found, crossing, "{}: {:?}", row.file, loaded.findings);
    }
    assert!(checked > 20_000, "only {checked} polygons of four corners and more");
}

#[test]
fn textures_in_the_folder_of_a_model_are_found() {
    let Some(sweep) = sweep() else { return };
    for (row, loaded) in sweep {
        let Ok(loaded) = loaded else { continue };
        let textured = loaded.model.materials.iter().filter(|m| m.texture.is_some()).count();
        let here = row.features.split(" textures named, ").nth(1);
        let here: usize =
            here.and_then(|here| here.split(' ').next()?.parse().ok()).unwrap_or_default();
        assert_eq!(textured > 0, here > 0, "{}: {:?}", row.file, loaded.findings);
        let unreadable = count(&loaded.findings, FindingKind::TextureUnreadable);
        assert_eq!(unreadable, 0, "{}: {:?}", row.file, loaded.findings);
    }
}

/// Builds a scene with a model alone under the first scene's lights, framed from `side`.
fn staged(model: &Shared<Model>, side: DVec3) -> (Scene, View) {
    let (mut scene, mut view) = default_scene();
    let objects: Vec<_> = scene.objects.ids().map(ItemId::Object).map(Command::Remove).collect();
    Command::Batch(objects).apply(&mut scene).unwrap();
    let object = Object::new(model.clone(), MaterialChoice::File);
    items::insert_object(&scene, object).apply(&mut scene).unwrap();
    selection::settle(&scene, &mut view);
    view.marks = false;
    let turned = |camera: &mut Camera| {
        let axes = math::frame(side, DVec3::Y, DMat3::IDENTITY);
        camera.pose = Tracked::new(Pose { axes, ..*camera.pose.now() });
    };
    items::change_camera(&scene, view.camera, turned).unwrap().apply(&mut scene).unwrap();
    // A file without vertices cannot be framed.
    if let Ok(framed) = framing::all(&scene, &view) {
        framed.apply(&mut scene).unwrap();
    }
    (scene, view)
}

/// The largest difference between two pictures in byte steps, and the index of its byte.
fn farthest_bytes(a: &Picture, b: &Picture) -> (u8, usize) {
    let pairs = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
    pairs.map(|(a, b)| a.abs_diff(*b)).zip(0..).max().unwrap()
}

#[test]
fn every_model_is_seen_and_drawn_alike_to_a_step_in_both_arithmetics() {
    let Some(sweep) = sweep() else { return };
    let side = 128;
    let draw = |scene: &Scene, view: &View, settings: Settings| {
        let plan = plan_frame(&Shot::new(scene, view, &settings, Size::new(side, side)));
        Renderer::default().render(&plan).clone()
    };
    for (row, loaded) in sweep {
        let Ok(loaded) = loaded else { continue };
        let shown = loaded.model.materials.iter().all(|material| material.opacity >= 0.5);
        let model = Shared::new(loaded.model);
        let mut seen = false;
        // Two opposite directions, because a flat model is visible from one side only.
        for from in [DVec3::new(-0.5, 0.4, 1.0), DVec3::new(0.5, -0.4, -1.0)] {
            let (scene, view) = staged(&model, from);
            for light in [LightAt::Face, LightAt::Vertex, LightAt::Pixel] {
                let settings = |arithmetic| Settings { arithmetic, light, ..Settings::default() };
                let fast = draw(&scene, &view, settings(Arithmetic::F32));
                let exact = draw(&scene, &view, settings(Arithmetic::F64));
                let (steps, byte) = farthest_bytes(&fast, &exact);
                let at = (byte / 4 % side, byte / 4 / side);
                assert!(steps <= 1, "{}, {light:?}: {steps} steps at {at:?}", row.file);
                seen |= fast.pixels().iter().any(|pixel| *pixel != scene.background.opaque());
            }
        }
        let has_shapes = model.mesh.has_shapes();
        assert_eq!(seen, shown && has_shapes, "{} is seen", row.file);
    }
}

/// Draws a model with every shading, on the current thread pool, directly after loading.
fn pictures_of(file: &Path) -> Vec<Picture> {
    let shadings = [LightAt::Face, LightAt::Vertex, LightAt::Pixel, LightAt::Sample];
    let draw = |light: LightAt| {
        // A fresh mesh each time, so every picture has to derive its data itself.
        let loaded = load(file, &LoadOptions::default(), &Progress::new()).ok()?;
        let (scene, view) = staged(&Shared::new(loaded.model), DVec3::new(3.0, 2.0, 5.0));
        let settings = Settings { light, samples: Samples::Four, ..Settings::default() };
        let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(96, 80)));
        Some(Renderer::default().render(&plan).clone())
    };
    shadings.into_iter().filter_map(draw).collect()
}

#[test]
fn every_model_is_drawn_alike_by_1_to_64_threads_in_every_shading() {
    let Some(models) = models() else { return };
    let pools: Vec<rayon::ThreadPool> = [1, 2, 3, 8, 64]
        .map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap())
        .into();
    let mut drawn = 0;
    for row in table(&models) {
        let file = models.join(&row.file);
        let alone = pools[0].install(|| pictures_of(&file));
        for pool in &pools[1..] {
            let threads = pool.current_num_threads();
            let several = pool.install(|| pictures_of(&file));
            assert!(several == alone, "{}: {threads} threads", row.file);
            drawn += several.len();
        }
    }
    assert!(drawn > 1000, "only {drawn} pictures were compared");
}
