//! `marraztu render`: draws a picture into a file.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::DVec2;
use marraztu::picture_file::draw_into;
use marraztu_core::accuracy::{AccuracyPreset, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_core::edit::{framing, items, lighting};
use marraztu_core::scene::{
    CameraId, Command, Fill, Intrinsics, Light, Object, Observer, Pose, Projection, Scene,
};
use marraztu_io::{self as io, Progress};
use marraztu_lab::dial::{Dial, Figures, Step, error_in_words, is_steady};
use marraztu_lab::report::brief;
use marraztu_render::accel::Accelerated as _;
use marraztu_render::{
    LayerNames, Renderer, Unseen, fitted_exposure, plan_frame, unseen, without_ground,
};

use super::arguments::{
    Exposure, Look, PictureArguments, Render, SceneArguments, Seeing, ShadowSlots, Slots, Surfaces,
};
use super::bar::Bar;
use super::cameras::{CAMERAS, CameraFrame, Cameras, Earlier, check_cameras};
use super::failure::{Failure, usage};
use super::layers::LayerContent;
use super::stage::{Stage, Watch};
use super::talk::note;
use super::target::Target;

/// Draws the picture described by the arguments.
pub(crate) fn render(arguments: &Render) -> Result<(), Failure> {
    if arguments.report && !arguments.layers.has_color() {
        return Err(usage("--report measures the picture, and --layers has no color"));
    }
    if arguments.budget.is_given() && !arguments.layers.has_color() {
        return Err(usage("a budget is for the picture, and --layers has no color"));
    }
    let target = Target::of(arguments)?;
    let mut stage = stage(&arguments.picture)?;
    target.check(&stage.sources(&arguments.picture.files), arguments.transparent)?;
    if arguments.layers.are_given() {
        check_cameras(&target.folder().join(CAMERAS))?;
    }
    let progress = Progress::new();
    let bar = Bar::of("drawing", &progress);
    // For a single picture, computing a faster drawing order is not worth its time.
    for (_, object) in stage.scene.objects.iter() {
        object.model.mesh.draw_as_filed();
    }
    let shot = stage.shot(target.size(arguments.picture.size));
    stage.settings = arguments.budget.settings(&shot, &arguments.picture.accuracy)?;
    let shot = shot.with(stage.settings);
    if let Some(path) = target.plain_file(&arguments.layers) {
        let done = render_file(arguments, &shot, path, &progress, bar);
        // The process ends here, so freeing a million vertices would only waste time.
        std::mem::forget(stage);
        return done;
    }
    let mut renderer = Renderer::default();
    let options = &arguments.layers;
    let numbers = match options.set() {
        set if set.is_empty() => None,
        set => {
            set.check_memory(shot.size).map_err(|_full| Failure::Absent(NO_MEMORY.to_owned()))?;
            Some(renderer.layers(&shot, set, options.normal_space()))
        }
    };
    let numbers = numbers.as_ref();
    if arguments.transparent || !options.has_color() {
        let color = arguments.transparent.then(|| without_ground(&mut renderer, &shot));
        drop(bar);
        let content = LayerContent::new(&shot, color.as_ref(), numbers, arguments.transparent);
        return written(arguments, &target, &stage, &content);
    }
    let plan = plan_frame(&shot);
    // Nothing cancels this progress, so it is always wanted.
    let tell = |done, all| _ = progress.reached(done, all);
    let _ = renderer.render_watched(&plan, &|| true, &tell);
    drop(bar);
    tell_unseen(&mut renderer, &shot);
    let content = LayerContent::new(&shot, Some(renderer.picture()), numbers, false);
    written(arguments, &target, &stage, &content)?;
    if arguments.report {
        tell_cost(&mut renderer, &shot);
    }
    // The process ends here, so freeing a million vertices would only waste time.
    std::mem::forget((stage, renderer));
    Ok(())
}

/// Draws a picture into a file in bands of rows, without keeping all of it in memory.
fn render_file(
    arguments: &Render,
    shot: &Shot,
    path: &Path,
    progress: &Progress,
    bar: Bar,
) -> Result<(), Failure> {
    let transparent = arguments.transparent;
    let drawn = draw_into(shot, transparent, progress, |size, next| {
        io::save_bands(path, size, transparent, next)
    });
    drop(bar);
    // Nothing cancels this progress.
    let Ok((written, bands)) = drawn else { return Ok(()) };
    written?;
    if arguments.out.is_none() {
        note(&format_args!("the picture is in {}", path.display()));
    }
    if transparent {
        return Ok(());
    }
    let stays = bands.stays();
    let mut renderer = bands.into_renderer();
    if stays {
        tell_unseen(&mut renderer, shot);
    } else {
        let Size { width, height } = shot.size;
        let longest = width.max(height);
        let side = |side: usize| (side * LOOKED_THROUGH / longest).max(1);
        let smaller = Shot { size: Size::new(side(width), side(height)), ..shot.clone() };
        renderer.render(&plan_frame(&smaller));
        tell_unseen(&mut renderer, &smaller);
    }
    if arguments.report {
        tell_cost(&mut renderer, shot);
    }
    std::mem::forget(renderer);
    Ok(())
}

/// The reason why layers cannot be drawn.
pub(super) const NO_MEMORY: &str = "there is not enough memory for the layers";

/// The longest side of the picture in which objects are looked for, if the whole picture was never
/// in memory.
const LOOKED_THROUGH: usize = 4096;

/// Notes the time of a picture and its error against the ideal.
fn tell_cost(renderer: &mut Renderer, shot: &Shot) {
    // The difference from another picture shows where the details are.
    let presets = AccuracyPreset::dial().iter().map(|preset| preset.of(&shot.settings));
    let other = presets.into_iter().find(|settings| *settings != shot.settings);
    let all: Vec<Settings> = other.into_iter().chain([shot.settings]).collect();
    let mut dial = Dial::new(shot, &all);
    // It is always wanted, so it is never cancelled.
    while dial.step(renderer, &|| true) != Ok(Step::Done) {}
    let figures = dial.figures();
    let found = figures.iter().find(|figures| figures.settings == shot.settings);
    let Some(Figures { ms, error: Some(error), .. }) = found else { return };
    let threads = rayon::current_num_threads();
    let busy = if is_steady(ms) { "" } else { ", as far as this busy machine tells" };
    let error = error_in_words(error).map_or_else(
        || "an error that is not known well enough".to_owned(),
        |error| format!("error {error} of 255 against the ideal (RMSE, 95% interval)"),
    );
    note(&format_args!(
        "{} per pixel: {} ms a picture with {threads} threads{busy}; {error}",
        shot.settings.samples_in_words(),
        brief(ms.value),
    ));
}

/// Writes the picture with its layers, and prints its path if the user did not choose it.
fn written(
    arguments: &Render,
    target: &Target,
    stage: &Stage,
    content: &LayerContent<'_>,
) -> Result<(), Failure> {
    let Render { layers: options, picture, .. } = arguments;
    target.write(content, options)?;
    let Target::Files(files) = target else { return Ok(()) };
    if options.are_given() {
        let names = options.has_ids().then(|| LayerNames::of(&stage.scene));
        let inputs: Vec<String> =
            picture.files.iter().map(|file| file.display().to_string()).collect();
        let scene = (inputs.join(" "), "0");
        let shot = stage.shot(picture.size);
        let files = (target.folder(), &files[..]);
        let frame = CameraFrame::new(&shot, files, scene, (options, names.as_ref()));
        let mut cameras = Cameras::new(CAMERAS.to_owned(), Earlier::Kept, (None, None));
        cameras.add(frame)?;
        cameras.write()?;
    }
    if let (None, [first, ..]) = (&arguments.out, &files[..]) {
        note(&format_args!("the picture is in {}", first.path.display()));
    }
    Ok(())
}

/// Notes why some objects are invisible, with one line per reason.
fn tell_unseen(renderer: &mut Renderer, shot: &Shot) {
    let mut reasons: Vec<(Unseen, Vec<&str>)> = Vec::new();
    for (id, reason) in unseen(renderer, shot) {
        let name = shot.scene.objects.get(id).map_or("", |object| &*object.name);
        match reasons.iter_mut().find(|(other, _)| *other == reason) {
            Some((_, names)) => names.push(name),
            None => reasons.push((reason, vec![name])),
        }
    }
    for (reason, names) in &reasons {
        // Some reasons have an option that helps.
        let remedy = match reason {
            Unseen::TurnedAway { .. } => ": --sides two draws both sides",
            _ => "",
        };
        let others = match names.len() {
            1 => String::new(),
            2 => " and 1 other object".to_owned(),
            n => format!(" and {} other objects", n - 1),
        };
        note(&format_args!("nothing of {}{others} is visible: {reason}{remedy}", names[0]));
    }
}

/// Loads the files, applies the options, and reports findings.
pub(super) fn stage(picture: &PictureArguments) -> Result<Stage, Failure> {
    let PictureArguments { files, scene, accuracy, talk, .. } = picture;
    talk.apply();
    let mut stage = staged(files, scene)?;
    stage.settings = accuracy.of_file(&stage.settings);
    Ok(stage)
}

/// Loads the scene of these files and applies the options.
pub(crate) fn staged(files: &[PathBuf], scene: &SceneArguments) -> Result<Stage, Failure> {
    let mut stage = Stage::of(files, &scene.reading, Watch::Bar)?;
    cover(&mut stage, &scene.surfaces)?;
    for finding in &stage.findings {
        note(finding);
    }
    look(&mut stage, &scene.seeing, &Aim::Options)?;
    for text in &stage.notes {
        note(text);
    }
    Ok(stage)
}

/// Applies the options for surfaces to all objects.
pub(super) fn cover(stage: &mut Stage, surfaces: &Surfaces) -> Result<(), Failure> {
    let mut load = |path| io::load_texture_with(path, &mut stage.findings);
    let texture = surfaces.texture.as_deref().map(&mut load).transpose()?;
    let change = |object: &mut Object| {
        if let Some(material) = &surfaces.material {
            object.material = material.clone();
        }
        if texture.is_some() {
            object.texture.clone_from(&texture);
        }
        object.surface = surfaces.surface.unwrap_or(object.surface);
        object.sides = surfaces.sides.unwrap_or(object.sides);
        object.file_normals &= !surfaces.no_file_normals;
    };
    stage.change(items::change_all_objects(&stage.scene, change))?;
    // A texture has no effect without texture coordinates, so say why.
    if let Some(texture) = &surfaces.texture {
        let objects = stage.scene.objects.iter();
        for (_, object) in objects.filter(|(_, object)| object.model.mesh.uvs().is_empty()) {
            stage.notes.push(format!(
                "{} is not shown on {}, which has no texture coordinates",
                texture.display(),
                object.name
            ));
        }
    }
    Ok(())
}

/// The position of the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Aim {
    /// The one that the options describe.
    #[default]
    Options,
    /// Everything visible is framed from these degrees to the right of the front, and up.
    From([f64; 2]),
    /// A position with axes, and a lens.
    Pose(Pose, PoseLens),
}

/// The lens of a camera that is given by its pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PoseLens {
    /// The projection and the lens of the selected camera.
    Selected,
    /// A perspective projection, with the angle of the selected camera.
    Perspective,
    /// The tangents of half the angles of view across and upwards, for pictures of any shape.
    /// Pixels are square if one is missing.
    Angles([Option<f64>; 2]),
    /// A projection with these intrinsics.
    Calibrated(Projection, Intrinsics),
}

impl PoseLens {
    /// Returns the projection, unless it is that of the scene.
    const fn projection(self) -> Option<Projection> {
        match self {
            Self::Selected => None,
            Self::Perspective | Self::Angles(_) => Some(Projection::Perspective),
            Self::Calibrated(projection, _) => Some(projection),
        }
    }
}

impl Aim {
    /// Returns the aim for a picture of this size.
    #[expect(clippy::cast_precision_loss, reason = "at most 16,384 pixels")]
    pub(crate) fn at(self, size: Size) -> Self {
        let Self::Pose(pose, PoseLens::Angles(tangents)) = self else { return self };
        let half = DVec2::new(size.width as f64, size.height as f64) / 2.0;
        let [x, y] = [0, 1].map(|axis| tangents[axis].map(|tangent| half[axis] / tangent));
        let focal = DVec2::new(x.or(y).unwrap_or(half.x), y.or(x).unwrap_or(half.y));
        let intrinsics = Intrinsics { focal, principal_point: half, size };
        Self::Pose(pose, PoseLens::Calibrated(Projection::Perspective, intrinsics))
    }
}

/// Applies the options for the view.
pub(super) fn look(stage: &mut Stage, seeing: &Seeing, aim: &Aim) -> Result<(), Failure> {
    if seeing.from.is_some() && !stage.models_alone {
        return Err(usage(
            "--from works only for models without a scene; choose a camera of the scene with \
                --camera",
        ));
    }
    if seeing.look.is_some() && !stage.models_alone {
        return Err(usage(
            "--look works only for models without a scene, which has its own lights",
        ));
    }
    // Time moves what the camera frames.
    stage.view.time = seeing.time.unwrap_or(stage.view.time);
    // A camera that is asked for is the observer, even if an object was when the scene was saved.
    if seeing.camera.is_some() || *aim != Aim::Options {
        stage.view.observer = Observer::Camera;
    }
    // The camera comes first: lights and exposure depend on the view.
    match aim {
        Aim::Options => aim_by_options(stage, seeing)?,
        Aim::From(from) => frame(stage, *from)?,
        Aim::Pose(pose, lens) => place_camera(stage, *pose, *lens)?,
    }
    // A studio is the same from everywhere.
    if seeing.look == Some(Look::Studio)
        && let Ok(command) = lighting::studio(&stage.scene, &stage.view)
    {
        stage.change(command)?;
    }
    if let Some(sky) = &seeing.sky {
        // Locks are for the hands of a user.
        let unlocked = Scene { locked: Default::default(), ..stage.scene.clone() };
        let command = lighting::panorama_alone(&unlocked, sky.panorama()?);
        stage.change(command.map_err(|refusal| usage(&refusal.to_string()))?)?;
    }
    if let Some(Slots(slots)) = &seeing.lights {
        check_slots(stage, slots, |_| true, "")?;
        switch(stage, |light| slots.contains(&light.slot), |light| &mut light.on)?;
    }
    match &seeing.shadows {
        Some(ShadowSlots::All) => {
            switch(stage, Light::can_cast_shadows, |light| &mut light.shadows)?;
        }
        Some(ShadowSlots::These(Slots(slots))) => {
            check_slots(stage, slots, Light::can_cast_shadows, " that can cast shadows")?;
            switch(stage, |light| slots.contains(&light.slot), |light| &mut light.shadows)?;
        }
        None => {}
    }
    if let Some(background) = seeing.background {
        stage.change(Command::Background(background))?;
        stage.scene.hide_panoramas();
    }
    let view = &mut stage.view;
    view.projection = seeing.projection.unwrap_or(view.projection);
    view.normals = seeing.normals.unwrap_or(view.normals);
    if seeing.edges {
        view.fill = Fill::Edges;
    }
    view.edges_over_fill |= seeing.edges_over;
    view.back_faces |= seeing.back_faces;
    view.face_normals |= seeing.face_normals;
    view.vertex_normals |= seeing.vertex_normals;
    view.line_width = seeing.line_width.unwrap_or(view.line_width);
    view.marks = seeing.helpers.unwrap_or(view.marks && !stage.models_alone);
    // Exposure comes last, since fitting it draws the finished scene.
    match seeing.exposure {
        Some(Exposure::Stops(stops)) => stage.view.exposure = stops,
        Some(Exposure::Fit) => {
            stage.view.exposure = fitted_exposure(&stage.shot(Size::new(FITTED, FITTED)));
        }
        None => {}
    }
    Ok(())
}

/// The side of the picture that the exposure is fitted to.
const FITTED: usize = 256;

/// Selects the camera. Models without a scene are framed, and lit for that view. An explicitly
/// chosen camera sees them under the first scene's own lights.
fn aim_by_options(stage: &mut Stage, seeing: &Seeing) -> Result<(), Failure> {
    if let Some(number) = seeing.camera {
        stage.view.camera = camera(stage, number)?;
        return Ok(());
    }
    if !stage.models_alone {
        return Ok(());
    }
    frame(stage, seeing.from.unwrap_or(framing::MODELS_FROM))
}

/// Frames everything visible from a direction. Models without a scene are lit for that view.
fn frame(stage: &mut Stage, from: [f64; 2]) -> Result<(), Failure> {
    match framing::models(&stage.scene, &stage.view, from) {
        Ok(command) => stage.change(command)?,
        Err(refusal) => stage.notes.push(refusal.to_string()),
    }
    if !stage.models_alone {
        return Ok(());
    }
    match lighting::models(&stage.scene, &stage.view) {
        Ok(command) => stage.change(command),
        // The note about framing has already given the reason.
        Err(_) => Ok(()),
    }
}

/// Places the camera. The lights of models without a scene are those of the default view, so they
/// are the same for all positions, except for the camera's own spot.
fn place_camera(stage: &mut Stage, pose: Pose, lens: PoseLens) -> Result<(), Failure> {
    if stage.models_alone {
        frame(stage, framing::MODELS_FROM)?;
    }
    let intrinsics = match lens {
        PoseLens::Calibrated(projection, intrinsics) => Some((projection, intrinsics)),
        PoseLens::Selected | PoseLens::Perspective | PoseLens::Angles(_) => None,
    };
    stage.change(framing::from_pose(&stage.scene, &stage.view, pose, intrinsics))?;
    stage.view.projection = lens.projection().unwrap_or(stage.view.projection);
    Ok(())
}

/// Checks that each of these slots has a light that `suits`.
fn check_slots(
    stage: &Stage,
    slots: &BTreeSet<u32>,
    suits: impl Fn(&Light) -> bool,
    what: &str,
) -> Result<(), Failure> {
    let has =
        |slot: u32| stage.scene.lights.iter().any(|(_, light)| light.slot == slot && suits(light));
    slots.iter().find(|slot| !has(**slot)).map_or(Ok(()), |slot| {
        Err(Failure::Absent(format!("the scene has no light in slot {slot}{what}")))
    })
}

/// Switches a property of all lights on or off.
fn switch(
    stage: &mut Stage,
    to: impl Fn(&Light) -> bool,
    property: fn(&mut Light) -> &mut bool,
) -> Result<(), Failure> {
    let to: Vec<_> = stage.scene.lights.iter().map(|(id, light)| (id, to(light))).collect();
    for (id, to) in to {
        stage.change(items::change_light(&stage.scene, id, |light| *property(light) = to)?)?;
    }
    Ok(())
}

/// Returns the camera with this number in the list, from 1.
fn camera(stage: &Stage, number: u32) -> Result<CameraId, Failure> {
    let index = usize::try_from(number).unwrap_or(usize::MAX) - 1;
    stage.scene.cameras.ids().nth(index).ok_or_else(|| {
        let count = stage.scene.cameras.len();
        let cameras = if count == 1 { "camera" } else { "cameras" };
        Failure::Absent(format!("the scene has {count} {cameras}: there is no camera {number}"))
    })
}
