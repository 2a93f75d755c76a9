//! A picture that lacks surfaces is quick, and is never called faster or better.

use std::time::Duration;

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{Axis, Coverage, Settings, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{
    Command, Item, Material, MaterialChoice, Mesh, MeshSource, Model, Object, ObjectId, Scene,
    Sides, SourceCorner, Tracked, View,
};
use marraztu_io as io;
use marraztu_lab::candidates::Thoroughness;
use marraztu_lab::error::{Measure, Region};
use marraztu_lab::pairs::{Limits, Watch};
use marraztu_lab::picture_source::Studio;
use marraztu_lab::report::{Budgets, Report, csv, markdown, text};
use marraztu_lab::sweep::{Question, sweep};
use marraztu_lab::timing::{Clock, Work};

/// A clock by which pictures of points take a fortieth of the time.
#[derive(Default)]
struct QuickPoints(Duration);

impl Clock for QuickPoints {
    fn time(&mut self, work: Work<'_>, todo: &mut dyn FnMut()) -> Duration {
        todo();
        let is_quick =
            matches!(work, Work::Picture(settings) if settings.coverage == Coverage::Points);
        let time = Duration::from_micros(if is_quick { 100 } else { 4000 });
        self.0 += time;
        time
    }

    fn now(&self) -> Duration {
        self.0
    }
}

/// Adds a square of this half side to a scene.
fn square(scene: &mut Scene, id: u32, half: f32, placement: DMat4) {
    let corners = [0, 1, 2, 3].map(SourceCorner::bare);
    let mut source = MeshSource::of_polygons(corners, vec![4]);
    source.positions = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[x, y]: [f32; 2]| [x * half, y * half, 0.0])
        .to_vec();
    let model = Model::of_mesh("square", Mesh::new(source).unwrap());
    let matte = MaterialChoice::Own(Material::matte([0.9, 0.7, 0.4], [0.0; 3]));
    let mut object = Object::new(Shared::new(model), matte);
    object.placement = Tracked::new(placement);
    object.sides = Sides::Two;
    let item = Item::Object(ObjectId(id), Box::new(object));
    Command::Insert { at: 0, item }.apply(scene).unwrap();
}

/// A floor under a level camera, alone or in front of a wall.
fn floor(has_wall: bool) -> (Scene, View) {
    let (mut scene, view) = io::empty_scene();
    let level = DMat4::from_translation(DVec3::new(0.0, -40.0, 0.0))
        * DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    square(&mut scene, 500, 1000.0, level);
    if has_wall {
        square(&mut scene, 501, 900.0, DMat4::from_translation(DVec3::new(0.0, 0.0, -900.0)));
    }
    (scene, View { marks: false, ..view })
}

/// Measures coverage and the presets.
fn report(has_wall: bool) -> Report {
    let (scene, view) = floor(has_wall);
    let current = Settings::default();
    let limits = Limits { pairs: 3, least: 3, time: Duration::from_secs(1) };
    let time = Duration::from_secs(9);
    let thoroughness = Thoroughness { word: "test", limits, combinations: 0, time, presets: true };
    let axes = vec![Axis::named("coverage").unwrap()];
    let question = Question::new(current, axes, thoroughness);
    let mut studio = Studio::new(Shot::new(&scene, &view, &current, Size::new(64, 48)));
    let (mut clock, watch) = (QuickPoints::default(), Watch::default());
    Report {
        scene: "a floor".to_owned(),
        command: String::new(),
        measure: Measure::Rmse,
        region: Region::Whole,
        budgets: Budgets { error: Some(255.0), ms: Some(2.0) },
        findings: sweep(&mut studio, &question, &mut clock, &watch, &mut |_| {}).unwrap(),
    }
}

#[test]
fn a_floor_that_points_leave_out_is_lacking_and_neither_faster_nor_on_the_front() {
    for has_wall in [false, true] {
        let report = report(has_wall);
        let axis = Axis::named("coverage").unwrap();
        let row = report.findings.rows_of(axis).find(|row| row.name == "Points").unwrap();
        assert!(row.error.lost > 0.3, "{}", row.error.lost);
        let whole = report.findings.rows_of(axis).filter(|row| row.name != "Points");
        assert!(whole.map(|row| row.error.lost).all(|lost| lost == 0.0));
        // Nothing else is as fast, so points would be on the front.
        let is_points = |i: usize| report.findings.points[i].settings.coverage == Coverage::Points;
        assert!(!report.front().into_iter().any(is_points));
        assert!(!report.overview().into_iter().any(is_points));
        assert!(!report.fastest().unwrap().is_some_and(is_points));
        assert_eq!(report.most_exact(), Some(None));
        // Both rows, of the axis and of the preset, have the mark.
        let table = text(&report);
        for name in ["Points", "Ancestor A (points)"] {
            let mut lines = table.lines();
            let line = lines.find(|line| line.trim_start().starts_with(&format!("! {name}")));
            let line = line.unwrap_or_else(|| panic!("{name}: {table}"));
            assert!(line.contains("lacking") && !line.contains("faster"), "{line}");
        }
        let verdict = report.verdict().join(" ");
        assert!(verdict.contains("overage by points loses"), "{verdict}");
        assert!(!verdict.contains("saves 97"), "{verdict}");
        assert!(report.verdict_on(axis).contains("no time is saved by that"), "{verdict}");
        let choice = axis.choice("points").unwrap();
        let told = report.verdict_on_choice(axis, choice).unwrap();
        assert!(told.contains("of the surfaces are lost") && !told.contains("the time of"));
        assert!(markdown(&report, axis).contains("of the surfaces are lost"));
        let csv = csv(&report);
        let line = csv.lines().find(|line| line.contains(",Points,")).unwrap();
        assert!(line.contains(",lacking,") && !line.contains(",faster,"), "{line}");
    }
}
