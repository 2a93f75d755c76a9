//! The view in scene files: its format, and conversions in both directions.
//!
//! Reading builds a whole [`View`], so the compiler reports new fields that are missing here.

use serde::{Deserialize, Serialize};

use super::fields::{Numbers, finite};
use crate::findings::{FindingKind, Findings};
use crate::window_state::{Panels, WindowState};
use marraztu_core::scene::{
    CameraId, Fill, Frame, LightId, NormalLength, Normals, ObjectId, Observer, PolygonMode,
    Projection, Scene, Steps, Subject, Transformation, View,
};

/// The camera id of a view that does not name one: no camera has this id.
pub(super) const UNSAID: u32 = u32::MAX;

#[derive(Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct FileView {
    pub(super) subject: Subject,
    pub(super) object: Option<u32>,
    pub(super) camera: u32,
    pub(super) light: Option<u32>,
    pub(super) transformation: Transformation,
    pub(super) frame: Frame,
    pub(super) steps: Steps,
    pub(super) observer: Observer,
    pub(super) projection: Projection,
    pub(super) fill: Fill,
    pub(super) edges_over_fill: bool,
    pub(super) polygons: Option<FilePolygons>,
    pub(super) polygons_stay: bool,
    pub(super) only_selected: bool,
    pub(super) normals: Normals,
    pub(super) back_faces: bool,
    pub(super) face_normals: bool,
    pub(super) vertex_normals: bool,
    pub(super) normal_length: NormalLength,
    pub(super) wide_lines: bool,
    #[serde(skip_serializing_if = "is_first_width")]
    pub(super) line_width: f64,
    pub(super) marks: bool,
    pub(super) coarse_while_moving: bool,
    #[serde(skip_serializing_if = "is_zero")]
    pub(super) exposure: f64,
    pub(super) time: f64,
    pub(super) panels: Panels,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilePolygons {
    pub(super) current: u32,
    #[serde(default)]
    pub(super) shown: Numbers,
}

impl FileView {
    /// Converts a view and the state of its window.
    pub(super) fn of(view: &View, window: &WindowState) -> Self {
        let polygons = view
            .polygons
            .as_ref()
            .map(|mode| FilePolygons { current: mode.current, shown: Numbers::of(&mode.shown) });
        Self {
            subject: view.subject,
            object: view.object.map(|id| id.0),
            camera: view.camera.0,
            light: view.light.map(|id| id.0),
            transformation: view.transformation,
            frame: view.frame,
            steps: view.steps,
            observer: view.observer,
            projection: view.projection,
            fill: view.fill,
            edges_over_fill: view.edges_over_fill,
            polygons,
            polygons_stay: view.polygons_stay,
            only_selected: view.only_selected,
            normals: view.normals,
            back_faces: view.back_faces,
            face_normals: view.face_normals,
            vertex_normals: view.vertex_normals,
            normal_length: view.normal_length,
            wide_lines: view.wide_lines,
            line_width: view.line_width,
            marks: view.marks,
            coarse_while_moving: window.coarse_while_moving,
            exposure: view.exposure,
            time: view.time,
            panels: window.panels.clone(),
        }
    }

    /// Returns the state of the window.
    pub(super) fn window(&self) -> WindowState {
        let panels = self.panels.clone();
        WindowState { coarse_while_moving: self.coarse_while_moving, panels }
    }
}

impl Default for FileView {
    fn default() -> Self {
        Self {
            camera: UNSAID,
            ..Self::of(&View::new(None, CameraId(0), None), &WindowState::DEFAULT)
        }
    }
}
fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

fn is_first_width(x: &f64) -> bool {
    x.to_bits() == View::LINE_WIDTH.to_bits()
}

/// Reads the view of a scene. Fails with the reason if one of its numbers is invalid.
pub(super) fn read_view(
    file: &FileView,
    scene: &Scene,
    findings: &mut Findings,
) -> Result<View, String> {
    let Steps { translation, rotation, scaling, .. } = file.steps;
    finite(
        "the view",
        &[translation, rotation, scaling, file.exposure, file.time, file.line_width],
    )?;
    if translation <= 0.0 || rotation <= 0.0 || scaling <= 1.0 {
        return Err(
            "the steps of the view must be above 0, and the step of scaling above 1".to_owned()
        );
    }
    // A missing item falls back to the selection of a new scene.
    let first = scene.first_view();
    let mut check = |what: &str, id: u32, is_there: bool| {
        if !is_there {
            findings.add(FindingKind::SelectionMissing, &format!("{what} {id}"), None);
        }
        is_there
    };
    let is_there = |id: &ObjectId| check("object", id.0, scene.objects.get(*id).is_some());
    let object = file.object.map(ObjectId).filter(is_there);
    let is_there = |id: &CameraId| check("camera", id.0, scene.cameras.get(*id).is_some());
    let camera = Some(file.camera).filter(|id| *id != UNSAID).map(CameraId).filter(is_there);
    let is_there = |id: &LightId| check("light", id.0, scene.lights.get(*id).is_some());
    let light = file.light.map(LightId).filter(is_there);
    let object = object.or(first.object);
    // Polygon mode belongs to the selected object.
    let polygons = object.and_then(|id| scene.objects.get(id)).and_then(|object| {
        let file = file.polygons.as_ref()?;
        let count = object.model.mesh.polygon_count();
        let there = |polygon: u32| (polygon as usize) < count;
        // The model may have changed on disk, and have fewer polygons now.
        let shown = file.shown.below(count);
        let mut mode = PolygonMode { current: 0, shown };
        mode.go_to(if there(file.current) { file.current } else { 0 });
        Some(mode)
    });
    Ok(View {
        subject: file.subject,
        object,
        camera: camera.unwrap_or(first.camera),
        light: light.or(first.light),
        transformation: file.transformation,
        frame: file.frame,
        steps: file.steps,
        observer: file.observer,
        projection: file.projection,
        fill: file.fill,
        edges_over_fill: file.edges_over_fill,
        polygons,
        polygons_stay: file.polygons_stay,
        only_selected: file.only_selected,
        normals: file.normals,
        back_faces: file.back_faces,
        face_normals: file.face_normals,
        vertex_normals: file.vertex_normals,
        normal_length: file.normal_length,
        wide_lines: file.wide_lines,
        line_width: file.line_width.clamp(*View::LINE_WIDTHS.start(), *View::LINE_WIDTHS.end()),
        marks: file.marks,
        exposure: file.exposure.clamp(-View::MOST_EXPOSURE, View::MOST_EXPOSURE),
        time: file.time,
    })
}
