//! Memory for loading and drawing, measured by a counting allocator.
//!
//! Everything runs on one thread, which makes the counts reproducible: each further thread has
//! memory for its own tile, and chance decides which one gets the fullest tile first.

#![expect(clippy::cast_precision_loss, reason = "small whole numbers")]
#![expect(clippy::print_stdout, reason = "what was counted is to be read")]

mod common;

use std::fmt::Write as _;

use dhat::{HeapStats, Profiler};
use glam::DMat4;
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{LightAt, Samples, Settings};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::scene::LoadOptions;
use marraztu_io::{self as io, Progress};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

#[global_allocator]
static COUNTING: dhat::Alloc = dhat::Alloc;

/// An OBJ file with a wavy sheet of 2 x 256 x 256 triangles.
fn sheet() -> String {
    const SIDE: usize = 256;
    let mut text = String::new();
    for row in 0..=SIDE {
        for column in 0..=SIDE {
            let [x, y] = [column, row].map(|i| i as f64 / SIDE as f64 * 200.0 - 100.0);
            let z = 10.0 * libm::sin(x / 7.0) * libm::cos(y / 5.0);
            writeln!(text, "v {x:.6} {y:.6} {z:.6}").expect("texts grow");
        }
    }
    let at = |row: usize, column: usize| row * (SIDE + 1) + column + 1;
    for row in 0..SIDE {
        for column in 0..SIDE {
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column + 1), at(row + 1, column)];
            writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").expect("texts grow");
        }
    }
    text
}

#[test]
fn loading_takes_the_file_and_two_meshes_and_a_steady_frame_takes_two_meshes_and_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sheet.obj");
    let text = sheet();
    std::fs::write(&path, &text).unwrap();
    let file = text.len();
    drop(text);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    alone.install(|| measure(&path, file));
}

fn measure(path: &std::path::Path, file: usize) {
    let _profiler = Profiler::builder().testing().build();
    let loaded = io::load(path, &LoadOptions::default(), &Progress::default());
    let loaded = loaded.expect("the file is sound");
    let most = HeapStats::get().max_bytes;
    let (scene, view) = common::scene(&[(Shared::new(loaded.model), DMat4::IDENTITY)]);
    let size = Size::new(800, 600);
    let settings = Settings::default();
    // Data that drawing derives and caches in the mesh counts as part of the mesh.
    drop(plan_frame(&Shot::new(&scene, &view, &settings, size)));
    scene.objects.iter().for_each(|(_, object)| assert!(!object.model.mesh.facets().is_empty()));
    let mesh = HeapStats::get().curr_bytes;
    println!("file {file} bytes, mesh {mesh}, most while loading {most}");
    assert!(most <= file + 2 * mesh, "loading takes {most} bytes for a mesh of {mesh}");

    for (light, samples) in [
        (LightAt::Face, Samples::One),
        (LightAt::Vertex, Samples::One),
        (LightAt::Pixel, Samples::One),
        (LightAt::Pixel, Samples::Four),
    ] {
        let settings = Settings { light, samples, ..settings };
        let mut renderer = Renderer::default();
        let mut frame = |turn: i32| {
            let mut view = view.clone();
            view.time = f64::from(turn);
            renderer.render(&plan_frame(&Shot::new(&scene, &view, &settings, size)));
        };
        (0..3).for_each(&mut frame);
        let before = HeapStats::get();
        (3..23).for_each(&mut frame);
        let after = HeapStats::get();
        let own = after.curr_bytes - mesh;
        let blocks = after.total_blocks - before.total_blocks;
        let bytes = after.total_bytes - before.total_bytes;
        println!("{light:?}, {samples:?}: {own} bytes; 20 frames ask {blocks} times for {bytes}");
        let picture = size.area() * 4 * samples.count() as usize;
        assert!(own + mesh <= 2 * (mesh + picture), "a steady frame takes {own} bytes");
        // The test harness may allocate a little on its own thread.
        assert!(after.curr_bytes <= before.curr_bytes + 4096, "a steady frame grows");
        assert!(bytes < 20 * 16_384, "20 frames ask {blocks} times for {bytes} bytes");
    }
}
