//! Pictures on 1 to 64 threads: none hangs, and all have the same bytes.
//!
//! A hang occurs in some runs only, and with three threads or more. Each test therefore repeats its
//! pictures a thousand times, on fresh meshes without computed normals, edges and orders. A test
//! that exceeds its time prints the stacks of all threads (if `gdb` is installed) and fails.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

#[path = "common/mod.rs"]
mod common;

use std::process::{Command as Process, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::DMat4;
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Filter, LightAt, Samples, Settings};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{Fill, Normals, ObjectId, Scene, Sides, View};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

use common::{ball, edit, scene};

/// The time limit of a test: many times the duration on a slow machine.
const LIMIT: Duration = Duration::from_secs(600);

/// The number of pictures for each number of threads.
const RUNS: usize = 1000;

/// Prints the stacks of all threads and fails unless it is dropped in time.
struct Watchdog(Arc<AtomicBool>);

impl Watchdog {
    #[expect(clippy::print_stderr, reason = "the stacks are what a hang is found by")]
    fn new(test: &'static str) -> Self {
        let over = Arc::new(AtomicBool::new(false));
        let watched = Arc::clone(&over);
        let watch = move || {
            let start = Instant::now();
            while start.elapsed() < LIMIT {
                if watched.load(Ordering::Relaxed) {
                    return;
                }
                std::thread::sleep(Duration::from_millis(200));
            }
            eprintln!("{test} hangs: not done after {} s", LIMIT.as_secs());
            let process = std::process::id().to_string();
            let stacks = ["-p", &process, "-batch", "-ex", "thread apply all backtrace 40"];
            if Process::new("gdb").args(stacks).stdout(Stdio::inherit()).status().is_err() {
                eprintln!("install gdb to see the stacks of its threads");
            }
            std::process::abort();
        };
        std::thread::Builder::new().name("watchdog".to_owned()).spawn(watch).unwrap();
        Self(over)
    }
}

impl Drop for Watchdog {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Combinations of view and settings that compute different parts of a mesh.
fn ways() -> Vec<(View, Settings, Sides)> {
    let (_, view) = scene(&[]);
    let mut ways = Vec::new();
    for light in [LightAt::Face, LightAt::Vertex, LightAt::Pixel, LightAt::Sample] {
        for normals in [Normals::Vertex, Normals::Face] {
            for (edges, sides) in [(false, Sides::One), (true, Sides::Auto)] {
                let view = View {
                    normals,
                    object: Some(ObjectId(10)),
                    edges_over_fill: edges,
                    face_normals: edges,
                    vertex_normals: edges,
                    ..view.clone()
                };
                let samples = if edges { Samples::One } else { Samples::Four };
                let filter = Filter::Nearest;
                ways.push((
                    view,
                    Settings { light, samples, filter, ..Settings::default() },
                    sides,
                ));
            }
        }
    }
    let edges = View { fill: Fill::Edges, ..ways[0].0.clone() };
    ways.push((edges, Settings::default(), Sides::Two));
    ways
}

/// Two balls with fresh meshes, for which nothing has been computed.
fn new_scene(sides: Sides) -> Scene {
    let near = DMat4::from_translation(glam::dvec3(0.0, 0.0, 340.0))
        * DMat4::from_scale(glam::DVec3::splat(20.0));
    let far = DMat4::from_translation(glam::dvec3(9.0, 3.0, 320.0))
        * DMat4::from_scale(glam::DVec3::splat(20.0));
    let (mut scene, _) = scene(&[(ball(24), near), (ball(9), far)]);
    edit(&mut scene, ObjectId(10), |object| object.sides = sides);
    scene
}

fn picture((view, settings, sides): &(View, Settings, Sides)) -> Picture {
    let plan = plan_frame(&Shot::new(&new_scene(*sides), view, settings, Size::new(200, 136)));
    Renderer::default().render(&plan).clone()
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

#[test]
fn a_thousand_pictures_of_new_meshes_are_the_same_on_every_number_of_threads() {
    let _watchdog = Watchdog::new("a thousand pictures of new meshes");
    let ways = ways();
    let expected: Vec<Picture> = pool(1).install(|| ways.iter().map(picture).collect());
    for (i, one) in expected.iter().enumerate() {
        assert!(
            one.pixels().iter().any(|pixel| *pixel != one.pixels()[0]),
            "way {i} shows nothing"
        );
    }
    for threads in [2, 3, 5, 8, 16] {
        let pool = pool(threads);
        for run in 0..RUNS {
            let way = run % ways.len();
            let drawn = pool.install(|| picture(&ways[way]));
            assert!(drawn == expected[way], "{threads} threads, run {run}, {:?}", ways[way].1);
        }
    }
}

#[test]
fn pictures_drawn_at_the_same_time_by_the_same_threads_do_not_wait_for_each_other() {
    let _watchdog = Watchdog::new("pictures drawn at the same time");
    let ways = ways();
    let expected: Vec<Picture> = pool(1).install(|| ways.iter().map(picture).collect());
    for threads in [3, 8] {
        let pool = pool(threads);
        for run in 0..RUNS / ways.len() {
            pool.scope(|scope| {
                for (way, expected) in ways.iter().zip(&expected) {
                    scope.spawn(move |_| assert!(picture(way) == *expected, "run {run}"));
                }
            });
        }
    }
}

/// Each run is a new process, which computes everything again.
#[test]
fn a_thousand_runs_of_the_program_come_to_their_end() {
    let _watchdog = Watchdog::new("a thousand runs of the program");
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.ppm");
    let mut first = None;
    for run in 0..RUNS {
        let threads = [3, 5, 8, 16][run % 4].to_string();
        let status = Process::new(env!("CARGO_BIN_EXE_marraztu"))
            .args(["render", "--size", "96x96", "--shading", "face", "--out"])
            .arg(&out)
            .env("RAYON_NUM_THREADS", &threads)
            .status()
            .unwrap();
        assert!(status.success(), "run {run}");
        let drawn = std::fs::read(&out).unwrap();
        assert!(
            *first.get_or_insert_with(|| drawn.clone()) == drawn,
            "run {run}: {threads} threads"
        );
    }
}
