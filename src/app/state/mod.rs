//! Everything that panels read. Only the app writes it.

pub mod dial;
pub mod laboratory;
mod last_picture;
pub mod layout;
mod notices;
mod viewpoints;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::ThemePreference;

pub use crate::app::drawing::reduction::{Reduction, Shrink};
use crate::app::panels::{OpenPanels, Panel};
use crate::app::widgets::text::file_name;
use dial::DialState;
use laboratory::Laboratory;
pub use last_picture::{ExplainedPixel, Late, Measured, Plan, Statistics};
use layout::Layout;
use marraztu_core::accuracy::{Samples, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_core::edit::near_plane::MovedNear;
use marraztu_core::edit::several::Others;
use marraztu_core::edit::{Gesture, GesturePhase, History, Viewpoint, selection};
use marraztu_core::scene::{ItemId, Light, LightId, Object, Scene, UpAxis, View};
use marraztu_io::{Fingerprint, Helpers, Sources, WindowState, is_example};
use marraztu_lab::picture_source::Reference;
use marraztu_lab::report::Report;
pub use notices::{Message, MissingFiles, Notice, NoticeKind, Offer, Tone};
pub(crate) use notices::{NoticeGroup, OUT_OF_VIEW};
pub(crate) use viewpoints::ViewStep;
pub use viewpoints::Viewpoints;

/// The number of items from which the outline has a filter.
const MANY: usize = 12;

/// A presentation: what it has replaced, and when it began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Presenting {
    /// The open panels before.
    pub panels: OpenPanels,
    /// The size of the interface before.
    pub zoom: f32,
    /// The seconds since the program started, at the beginning.
    pub since: f64,
}

/// The scene being edited, and everything shown about it.
#[derive(Debug)]
pub struct State {
    /// The scene.
    pub scene: Scene,
    /// The view.
    pub view: View,
    /// The settings of accuracy.
    pub settings: Settings,
    /// The user's preferences for drawing in the window.
    pub drawing: DrawingChoices,
    /// The history of changes.
    pub history: History,
    /// The viewpoints of the past.
    pub viewpoints: Viewpoints,
    /// The near plane that was moved automatically, if it was.
    pub(crate) moved_near: Option<MovedNear>,
    /// The scene's file, if it has one.
    pub path: Option<PathBuf>,
    /// The last message, for the status line.
    pub message: Option<Message>,
    /// Notices over the picture. Some stay until the user dismisses them, others for a few seconds.
    pub notices: Vec<Notice>,
    /// Notices that have moved to the status line, the latest last.
    pub past_notices: Vec<Notice>,
    /// Statistics of the last picture.
    pub statistics: Statistics,
    /// The effects of the last picture, while the plan is shown.
    pub plan: Plan,
    /// The panels that are shown.
    pub panels: OpenPanels,
    /// Whether pictures may be drawn at reduced quality while something moves.
    pub coarse_while_moving: bool,
    /// The division of the window among the panels.
    pub layout: Layout,
    /// Whether the palette is open.
    pub palette: bool,
    /// Whether the selection's outline, axes and marks of lights are drawn over the picture.
    pub overlays: bool,
    /// The dial over the picture.
    pub dial: DialState,
    /// Whether the loupe is shown at the pointer.
    pub loupe: bool,
    /// Whether handles to move, rotate and scale the selection lie over the picture.
    pub gizmo: bool,
    /// The other helpers drawn over the picture.
    pub helpers: Helpers,
    /// Whether models are read again when their files change.
    pub watches: bool,
    /// The up axis of models if their files do not state one.
    pub up: UpAxis,
    /// The filter of the outline, a part of a name.
    pub filter: String,
    /// The lights that were on before the user isolated one.
    pub lit_before: BTreeSet<LightId>,
    /// The other selected items, without the one that the keys act on.
    pub several: Others,
    /// Whether the next click into the picture aims the selected light.
    pub aiming: bool,
    /// The title of the system dialog that is open.
    pub asking: Option<&'static str>,
    /// Whether the greeting over the first picture is shown.
    pub greeting: bool,
    /// Whether the next click into the picture explains a pixel.
    pub explaining: bool,
    /// The explanation of a pixel.
    pub explained: Option<Arc<ExplainedPixel>>,
    /// The scale of the interface; 1 is the system's size.
    pub zoom: f32,
    /// Whether the window is so narrow that panels are folded.
    pub narrow: bool,
    /// Whether only the picture is shown, to look at: a page in which it is embedded.
    pub picture_only: bool,
    /// What a presentation has replaced, while there is one.
    pub presenting: Option<Presenting>,
    /// Whether the window is light or dark.
    pub theme: ThemePreference,
    /// The state of the laboratory.
    pub lab: Laboratory,
    /// The files opened or saved last, the latest first.
    pub recent: Vec<PathBuf>,
    /// A description of each unsaved work that a crashed program has left behind.
    pub recoverable: Vec<String>,
    /// The item that is being renamed.
    pub renaming: Option<ItemId>,
    /// The notices about missing files.
    pub missing: MissingFiles,
    /// A description of each discarded work that can be restored.
    pub discarded: Vec<String>,
    /// The content of the scene's file as this program read or wrote it last.
    pub(crate) content: Option<Fingerprint>,
    /// The number of scenes that were shown before this one.
    pub(crate) generation: u32,
    /// The gesture of the last change.
    pub(crate) gesture: Gesture,
    /// The number of changes in that gesture.
    pub(crate) repeats: u32,
}

/// Preferences for drawing in the window. They are not part of files and do not affect the
/// laboratory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawingChoices {
    /// Whether the picture is refined while nothing happens.
    pub refines: bool,
    /// The samples per pixel that it is refined to.
    pub refined: Samples,
    /// The milliseconds that a picture may take while something moves.
    pub budget_ms: u16,
}

impl Default for DrawingChoices {
    /// Returns choices without refinement; the program's window takes it from the preferences.
    fn default() -> Self {
        Self { refines: false, refined: Settings::REFINED, budget_ms: 33 }
    }
}

impl State {
    /// Creates the state of a new scene, without history.
    pub fn new(scene: Scene, view: View) -> Self {
        Self {
            viewpoints: Viewpoints::new(Viewpoint::of(&scene, &view)),
            moved_near: None,
            scene,
            view,
            settings: Settings::default(),
            drawing: DrawingChoices::default(),
            history: History::default(),
            path: None,
            message: None,
            notices: Vec::new(),
            past_notices: Vec::new(),
            statistics: Statistics::default(),
            plan: Plan::default(),
            panels: OpenPanels::DEFAULT,
            coarse_while_moving: WindowState::DEFAULT.coarse_while_moving,
            layout: Layout::default(),
            palette: false,
            overlays: true,
            dial: DialState::default(),
            loupe: false,
            gizmo: true,
            helpers: Helpers::default(),
            watches: false,
            up: UpAxis::default(),
            filter: String::new(),
            lit_before: BTreeSet::new(),
            several: Others::default(),
            aiming: false,
            asking: None,
            greeting: false,
            explaining: false,
            explained: None,
            zoom: 1.0,
            narrow: false,
            picture_only: false,
            presenting: None,
            theme: ThemePreference::System,
            lab: Laboratory::default(),
            recent: Vec::new(),
            recoverable: Vec::new(),
            renaming: None,
            missing: MissingFiles::default(),
            discarded: Vec::new(),
            content: None,
            generation: 0,
            gesture: Gesture::Whole,
            repeats: 0,
        }
    }

    /// Returns the scene as it is shown now, in a picture of this size.
    pub(crate) fn shot(&self, size: Size) -> Shot {
        Shot::new(&self.scene, &self.view, &self.settings, size)
    }

    /// Returns the item that the keys act on.
    pub fn selected(&self) -> Option<ItemId> {
        selection::selected(&self.view)
    }

    /// Returns the other selected items, without the one that the keys act on.
    pub fn others(&self) -> Vec<ItemId> {
        self.several.of(&self.scene, &self.view).collect()
    }

    /// Returns whether an item is selected, whether or not the keys act on it.
    pub fn is_selected(&self, id: ItemId) -> bool {
        self.selected() == Some(id)
            || self.several.of(&self.scene, &self.view).any(|other| other == id)
    }

    /// Returns whether an object or a camera's mark is drawn, or a light is on.
    pub(crate) fn is_shown(&self, id: ItemId) -> Option<bool> {
        Some(match id {
            ItemId::Object(id) => self.scene.objects.get(id)?.visible,
            ItemId::Camera(id) => self.scene.cameras.get(id)?.visible,
            ItemId::Light(id) => self.scene.lights.get(id)?.on,
        })
    }

    /// Returns whether there are enough items for the outline to have a filter.
    pub fn has_filter(&self) -> bool {
        let Scene { objects, cameras, lights, .. } = &self.scene;
        objects.len() + cameras.len() + lights.len() >= MANY
    }

    /// Returns whether the outline lists an item.
    pub fn is_listed(&self, id: ItemId) -> bool {
        let filter = self.filter.to_lowercase();
        !self.has_filter()
            || filter.is_empty()
            || self.renaming == Some(id)
            || self.name(id).is_some_and(|name| name.to_lowercase().contains(&filter))
    }

    /// Names the targets of commands: the name of the selected item, or the number of items.
    pub fn acted_on_name(&self) -> String {
        match self.others().len() {
            0 => self.selected_name().to_owned(),
            others => format!("{} items", others + 1),
        }
    }

    /// Returns whether overlays are drawn over the picture now. A comparison hides them.
    pub fn shows_overlays(&self) -> bool {
        self.overlays && self.lab.compare == laboratory::Compare::Off
    }

    /// Returns the samples per pixel for refinement while the user is idle; `None` if the picture
    /// is shown with the samples of the settings. A comparison of one axis alone uses the settings,
    /// since more samples would hide what the axis does; so do measurements.
    pub fn refined_to(&self) -> Option<Samples> {
        let DrawingChoices { refines, refined, .. } = self.drawing;
        let is_whole =
            self.lab.compare == laboratory::Compare::Off || self.lab.reference == Reference::Ideal;
        let is_alone = is_whole && self.lab.running.is_none();
        let more = refined.count() > self.settings.samples.count();
        let wanted = refines && is_alone && more && !self.is_animated();
        (wanted && self.settings.can_refine()).then_some(refined)
    }

    /// Returns the items to outline in the picture, first the one that the keys act on.
    pub(crate) fn outlined(&self) -> Vec<ItemId> {
        match self.selected() {
            Some(first) if self.shows_overlays() => {
                std::iter::once(first).chain(self.others()).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Returns the name of the selected item; empty if nothing is selected.
    pub fn selected_name(&self) -> &str {
        self.selected().and_then(|id| self.name(id)).unwrap_or_default()
    }

    /// Returns the name of an item.
    pub fn name(&self, id: ItemId) -> Option<&str> {
        self.scene.name(id)
    }

    /// Returns the file name of the scene or of its only model; `None` if it has no file.
    pub fn file_name(&self) -> Option<String> {
        let name = self.path.as_deref().or(self.only_model()).and_then(Path::file_name);
        name.map(|name| name.to_string_lossy().into_owned())
    }

    fn only_model(&self) -> Option<&Path> {
        let mut objects = self.scene.objects.iter();
        let model = objects.next().and_then(|(_, object)| object.model.source.as_deref());
        model.filter(|_| objects.next().is_none())
    }

    /// Returns the folder of the scene, of its selected model, or of the first model with a file.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        let source = |object: &Object| object.model.source.clone().filter(|path| !is_example(path));
        let selected = self.view.object.and_then(|id| self.scene.objects.get(id)).and_then(source);
        let first = || self.scene.objects.iter().find_map(|(_, object)| source(object));
        let file = self.path.clone().or(selected).or_else(first)?;
        let file = std::path::absolute(&file).unwrap_or(file);
        file.parent().map(Path::to_owned)
    }

    /// Proposes a name without extension for a file of the scene: that of the scene file, or of the
    /// only model.
    pub(crate) fn proposed_name(&self) -> String {
        let stem = self.path.as_deref().or(self.only_model()).and_then(Path::file_stem);
        stem.map_or_else(|| "scene".to_owned(), |stem| stem.to_string_lossy().into_owned())
    }

    /// Shows a message in the status line.
    pub(crate) fn tell(&mut self, text: Option<String>) {
        self.message = text.map(|text| Message { text, tone: Tone::Done });
    }

    /// Reports that a file was saved. Pages of browsers download it, so their users know no folder.
    pub(crate) fn tell_saved(&mut self, path: &Path) {
        self.tell(Some(match cfg!(target_family = "wasm") {
            true => format!("Downloaded {}", file_name(path)),
            false => format!("Saved {}", path.display()),
        }));
    }

    /// Moves notices from the picture to the status line.
    pub(crate) fn settle_notices(&mut self, which: impl Fn(&Notice) -> bool) {
        for notice in self.notices.extract_if(.., |notice| which(notice)) {
            self.past_notices.retain(|other| *other != notice);
            self.past_notices.push(notice);
        }
    }

    /// Returns the last message and everything reported over the picture, one per line.
    pub(crate) fn said(&self) -> String {
        let message = self.message.iter().map(|message| message.text.clone());
        let notices = NoticeGroup::of(&self.notices).into_iter().map(|group| group.text());
        let cost = self.lab.lesson.and_then(|lesson| self.lab.costs.get(lesson.axis.as_str()));
        let report = self.lab.shown().filter(|_| self.panels.has(Panel::Laboratory));
        let cost = cost.map(|cost| cost.all.clone());
        let lab = cost.into_iter().chain(report.map(Report::verdict).unwrap_or_default());
        let all = message.chain(self.recoverable.clone()).chain(notices).chain(lab);
        all.collect::<Vec<_>>().join("\n")
    }

    /// Returns the files that the scene was read from.
    pub(crate) fn sources(&self) -> Sources {
        Sources::of(&self.scene).with(&self.path)
    }

    /// Returns the panels that files and preferences remember: not those of a presentation.
    pub(crate) fn lasting_panels(&self) -> OpenPanels {
        self.presenting.map_or(self.panels, |before| before.panels).lasting()
    }

    /// Returns the state of the window that a scene file stores.
    pub fn window(&self) -> WindowState {
        WindowState {
            coarse_while_moving: self.coarse_while_moving,
            panels: self.lasting_panels().kept(),
        }
    }

    /// Applies the state of the window that a scene file has stored.
    pub(crate) fn set_window(&mut self, window: &WindowState) {
        let WindowState { coarse_while_moving, panels } = window;
        self.coarse_while_moving = *coarse_while_moving;
        let is_open = self.panels.has(Panel::Laboratory);
        self.panels = OpenPanels::of_kept(panels).with(Panel::Laboratory, is_open);
    }

    /// Returns whether anything in the scene moves by itself.
    pub fn is_animated(&self) -> bool {
        let circles = |light: &Light| light.kind.orbit().is_some_and(|orbit| orbit.on);
        self.scene.objects.iter().any(|(_, object)| object.spin.is_on())
            || self.scene.lights.iter().any(|(_, light)| circles(light))
    }

    /// Returns the number of changes in `gesture` after the next one.
    pub(crate) fn next_repeat(&self, gesture: Gesture) -> u32 {
        match self.phase(gesture) {
            GesturePhase::First => 1,
            GesturePhase::Continued => self.repeats.saturating_add(1),
        }
    }

    /// Returns the phase of the next change in `gesture`. The first change pushes the old
    /// transform.
    pub fn phase(&self, gesture: Gesture) -> GesturePhase {
        if gesture != Gesture::Whole && gesture == self.gesture {
            GesturePhase::Continued
        } else {
            GesturePhase::First
        }
    }
}
