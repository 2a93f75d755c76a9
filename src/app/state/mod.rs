//! Everything that panels read. Only the app writes it.

pub mod laboratory;
pub mod layout;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use egui::ThemePreference;

use crate::accuracy::{Samples, Settings};
pub use crate::app::drawing::reduction::{Reduction, Shrink};
use crate::app::drawing::refinement::can_refine;
use crate::app::drawing::viewport_renderer::Drawn;
use crate::base::image::Size;
use crate::edit::several::Others;
use crate::edit::{Gesture, GesturePhase, History, Refusal, framing, items, selection};
use crate::io::{Helpers, Panels, WindowState};
use crate::lab::cost::{Costs, Explained};
use crate::render::{Damage, PixelColor};
use crate::scene::{
    Command, ItemId, Light, LightId, MaterialChoice, Object, ObjectId, Scene, Sides, Surface, View,
};
use laboratory::Laboratory;
use layout::Layout;

/// The scene being edited, and everything shown about it.
#[derive(Debug)]
pub struct State {
    /// The scene.
    pub scene: Scene,
    /// The view.
    pub view: View,
    /// The settings of accuracy.
    pub settings: Settings,
    /// How the window draws beyond what the settings say.
    pub drawing: DrawingChoices,
    /// The history of changes.
    pub history: History,
    /// The scene's file, if it has one.
    pub path: Option<PathBuf>,
    /// The last message, for the status line.
    pub message: Option<Message>,
    /// Notices that stay until the user dismisses them.
    pub notices: Vec<Notice>,
    /// Statistics of the last picture.
    pub statistics: Statistics,
    /// The effects of the last picture, while the plan is shown.
    pub plan: Plan,
    /// Which panels are shown.
    pub panels: Panels,
    /// Whether pictures may be coarser while something moves, if they would come too late
    /// otherwise.
    pub coarse_while_moving: bool,
    /// How the window is divided among them.
    pub layout: Layout,
    /// Whether the palette is open.
    pub palette: bool,
    /// Whether the selection's outline, axes and marks of lights are drawn over the picture.
    pub overlays: bool,
    /// Whether handles to move, rotate and scale the selection lie over the picture.
    pub gizmo: bool,
    /// What else is drawn over the picture.
    pub helpers: Helpers,
    /// Whether models are read again when their files change.
    pub watches: bool,
    /// The lights that were on before one was left alone.
    pub lit_before: BTreeSet<LightId>,
    /// The items that are selected beside the one that the keys act on.
    pub several: Others,
    /// Whether the next click into the picture aims the selected light.
    pub aiming: bool,
    /// The title of the system's dialog that is open.
    pub asking: Option<&'static str>,
    /// Whether the strip of the first minute is shown.
    pub greeting: bool,
    /// Whether the next click into the picture explains a pixel.
    pub explaining: bool,
    /// The pixel that is explained.
    pub explained: Option<Arc<ExplainedPixel>>,
    /// How large the interface is; 1 is the system's size.
    pub zoom: f32,
    /// Whether the window is so narrow that panels are folded.
    pub narrow: bool,
    /// Whether the window is light or dark.
    pub theme: ThemePreference,
    /// The state of the laboratory.
    pub lab: Laboratory,
    /// The files opened or saved last, the latest first.
    pub recent: Vec<PathBuf>,
    /// What is said about each unsaved work that a program has left behind.
    pub recoverable: Vec<String>,
    /// The item that is being renamed.
    pub renaming: Option<ItemId>,
    /// The gesture of the last change.
    pub(crate) gesture: Gesture,
    /// How many changes it has had.
    pub(crate) repeats: u32,
}

/// How the window draws beyond what the settings of accuracy say: a preference of the user's, which
/// neither files nor the laboratory know.
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
    /// Without refining: the program's window does what the preferences say.
    fn default() -> Self {
        Self { refines: false, refined: Samples::Sixteen, budget_ms: 33 }
    }
}

/// A message to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// One sentence.
    pub text: String,
    /// Its tone.
    pub tone: Tone,
}

/// The tone of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// It was done.
    Done,
    /// It was not done, for this reason.
    Refused,
}

/// A notice that stays until the user dismisses it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// One line.
    pub text: String,
    /// Details, one line each.
    pub details: Vec<String>,
    /// An offer shown with it as a button.
    pub offer: Option<Offer>,
}

/// An action that a notice offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offer {
    /// To bring an object into view.
    Frame(ObjectId),
    /// To draw both sides of an object's faces.
    TwoSides(ObjectId),
    /// To show an object that is hidden.
    Show(ObjectId),
    /// To make an object opaque.
    Opaque(ObjectId),
}

impl Offer {
    /// The label of its button.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Frame(_) => "Frame",
            Self::TwoSides(_) => "Draw both sides",
            Self::Show(_) => "Show",
            Self::Opaque(_) => "Make opaque",
        }
    }

    /// The object that it is about.
    #[must_use]
    pub const fn object(self) -> ObjectId {
        let (Self::Frame(id) | Self::TwoSides(id) | Self::Show(id) | Self::Opaque(id)) = self;
        id
    }

    /// The change of the scene, and its label in the history.
    ///
    /// # Errors
    /// If the object is gone, or the observer is an object.
    pub fn command(self, scene: &Scene, view: &View) -> Result<(Command, String), Refusal> {
        let id = self.object();
        let name = &scene.objects.get(id).ok_or(Refusal::Gone)?.name;
        Ok(match self {
            Self::Frame(_) => (framing::objects(scene, view, &[id])?, format!("Frame {name}")),
            Self::TwoSides(_) => {
                let two = |object: &mut Object| object.sides = Sides::Two;
                (items::change_object(scene, id, two)?, format!("Draw both sides of {name}"))
            }
            Self::Show(_) => {
                let show = |object: &mut Object| object.visible = true;
                (items::change_object(scene, id, show)?, format!("Show {name}"))
            }
            Self::Opaque(_) => {
                (items::change_object(scene, id, make_opaque)?, format!("Make {name} opaque"))
            }
        })
    }
}

/// Makes an object opaque: its own opacity becomes 1. If it was, the materials or the texture of
/// its file hide it: it gets the first part's material as its own, or shows its material alone.
fn make_opaque(object: &mut Object) {
    let was_transparent = object.opacity < 1.0;
    object.opacity = 1.0;
    if was_transparent {
        return;
    }
    let parts = u32::try_from(object.model.mesh.parts().len()).unwrap_or(u32::MAX);
    if (0..parts).all(|part| object.part_look(part).opacity == 0.0) {
        object.material = MaterialChoice::Own(object.part_look(0).material);
    } else if (0..parts).any(|part| object.part_look(part).texture.is_some()) {
        object.surface = Surface::Material;
    }
}

/// Statistics of the last picture.
#[derive(Clone, Debug)]
pub struct Statistics {
    /// From the snapshot to the finished picture in memory, on the thread that draws.
    pub time: Duration,
    /// The size of the picture.
    pub size: Size,
    /// The number of pictures drawn.
    pub pictures: u64,
    /// The number of pictures shown in the last second.
    pub rate: u32,
    /// The number of triangles drawn.
    pub triangles: usize,
    /// How its quality is reduced.
    pub reduction: Reduction,
    /// The measured error of that: the root mean square, in steps of a byte.
    pub lost: Option<f64>,
    /// The samples per pixel that it is refined to.
    pub refined: Option<Samples>,
    /// What was redrawn, and why.
    pub changes: Option<Damage>,
}

impl Default for Statistics {
    fn default() -> Self {
        Self {
            time: Duration::ZERO,
            size: Size::new(0, 0),
            pictures: 0,
            rate: 0,
            triangles: 0,
            reduction: Reduction::NONE,
            lost: None,
            refined: None,
            changes: None,
        }
    }
}

impl Statistics {
    /// Records a picture, the `rate`th in the last second.
    pub(crate) fn note(&mut self, drawn: &Drawn, rate: u32) {
        let [width, height] = drawn.image.size;
        *self = Self {
            time: drawn.time,
            size: Size::new(width, height),
            pictures: self.pictures + 1,
            rate,
            triangles: drawn.triangles,
            reduction: drawn.reduction,
            lost: drawn.lost,
            refined: drawn.refined,
            changes: Some(drawn.changes.clone()),
        };
    }
}

/// The effects of the last picture.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Its effects.
    pub explained: Option<Arc<Explained>>,
    /// Their costs in time, if measured.
    pub costs: Option<Arc<Measured>>,
    /// Whether it is being measured.
    pub measuring: bool,
}

/// The measured costs of effects, and their picture.
#[derive(Clone, Debug)]
pub struct Measured {
    /// What was measured.
    pub costs: Costs,
    /// What there was to draw.
    pub scene: Scene,
    /// How it was looked at.
    pub view: View,
    /// How exactly it was drawn.
    pub settings: Settings,
}

/// A pixel that is explained, and the picture that it belongs to.
#[derive(Clone, Debug)]
pub struct ExplainedPixel {
    /// Column and row, from the upper left.
    pub at: [usize; 2],
    /// What there is to draw.
    pub scene: Scene,
    /// How it is looked at.
    pub view: View,
    /// How exactly it is drawn.
    pub settings: Settings,
    /// The size of the picture.
    pub size: Size,
    /// The explanation; `None` if the pixel is outside of the picture.
    pub explained: Option<PixelColor>,
}

impl ExplainedPixel {
    /// Whether the picture is still the one that was explained.
    #[must_use]
    pub fn is_of(&self, state: &State, size: Size) -> bool {
        let Self { scene, view, settings, .. } = self;
        self.size == size
            && (settings, view) == (&state.settings, &state.view)
            && *scene == state.scene
    }
}

impl State {
    /// The state of a new scene, without history.
    #[must_use]
    pub fn new(scene: Scene, view: View) -> Self {
        Self {
            scene,
            view,
            settings: Settings::default(),
            drawing: DrawingChoices::default(),
            history: History::default(),
            path: None,
            message: None,
            notices: Vec::new(),
            statistics: Statistics::default(),
            plan: Plan::default(),
            panels: WindowState::DEFAULT.panels,
            coarse_while_moving: WindowState::DEFAULT.coarse_while_moving,
            layout: Layout::default(),
            palette: false,
            overlays: true,
            gizmo: true,
            helpers: Helpers::default(),
            watches: false,
            lit_before: BTreeSet::new(),
            several: Others::default(),
            aiming: false,
            asking: None,
            greeting: false,
            explaining: false,
            explained: None,
            zoom: 1.0,
            narrow: false,
            theme: ThemePreference::System,
            lab: Laboratory::default(),
            recent: Vec::new(),
            recoverable: Vec::new(),
            renaming: None,
            gesture: Gesture::Whole,
            repeats: 0,
        }
    }

    /// The item that the keys act on.
    #[must_use]
    pub fn selected(&self) -> Option<ItemId> {
        selection::selected(&self.view)
    }

    /// The items that are selected beside the one that the keys act on.
    #[must_use]
    pub fn others(&self) -> Vec<ItemId> {
        self.several.of(&self.scene, &self.view).collect()
    }

    /// Whether an item is selected, as the one that the keys act on or beside it.
    #[must_use]
    pub fn is_selected(&self, id: ItemId) -> bool {
        self.selected() == Some(id)
            || self.several.of(&self.scene, &self.view).any(|other| other == id)
    }

    /// What commands act on, in words: the name of the selected item, or how many there are.
    #[must_use]
    pub fn acted_on_name(&self) -> String {
        match self.others().len() {
            0 => self.selected_name().to_owned(),
            others => format!("{} items", others + 1),
        }
    }

    /// Whether anything is drawn over the picture now: a comparison shows the pictures alone.
    #[must_use]
    pub fn shows_overlays(&self) -> bool {
        self.overlays && self.lab.compare == laboratory::Compare::Off
    }

    /// The samples per pixel that the picture is refined to while nothing happens; `None` if it is
    /// shown as the settings say. Comparisons and measurements are of the settings alone.
    #[must_use]
    pub fn refined_to(&self) -> Option<Samples> {
        let DrawingChoices { refines, refined, .. } = self.drawing;
        let is_alone = self.lab.compare == laboratory::Compare::Off && self.lab.running.is_none();
        let more = refined.count() > self.settings.samples.count();
        let wanted = refines && is_alone && more && !self.is_animated();
        (wanted && can_refine(&self.settings)).then_some(refined)
    }

    /// The items whose outlines are drawn over the picture: first the one that the keys act on.
    pub(crate) fn outlined(&self) -> Vec<ItemId> {
        match self.selected() {
            Some(first) if self.shows_overlays() => {
                std::iter::once(first).chain(self.others()).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Its name; empty if nothing is selected.
    #[must_use]
    pub fn selected_name(&self) -> &str {
        self.selected().and_then(|id| self.name(id)).unwrap_or_default()
    }

    /// The name of an item.
    #[must_use]
    pub fn name(&self, id: ItemId) -> Option<&str> {
        self.scene.name(id)
    }

    /// The file name of the scene, or a placeholder.
    #[must_use]
    pub fn file_name(&self) -> String {
        let name = self.path.as_deref().and_then(Path::file_name);
        name.map_or_else(|| "new scene".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Shows a message in the status line.
    pub(crate) fn tell(&mut self, text: Option<String>) {
        self.message = text.map(|text| Message { text, tone: Tone::Done });
    }

    /// What a scene file keeps of the window.
    #[must_use]
    pub const fn window(&self) -> WindowState {
        WindowState { coarse_while_moving: self.coarse_while_moving, panels: self.panels }
    }

    /// Takes what a scene file has kept of the window.
    pub(crate) const fn set_window(&mut self, window: WindowState) {
        let WindowState { coarse_while_moving, panels } = window;
        (self.coarse_while_moving, self.panels) = (coarse_while_moving, panels);
    }

    /// Whether anything in the scene moves by itself.
    #[must_use]
    pub fn is_animated(&self) -> bool {
        let circles = |light: &Light| light.kind.orbit().is_some_and(|orbit| orbit.on);
        self.scene.objects.iter().any(|(_, object)| object.spin.is_on())
            || self.scene.lights.iter().any(|(_, light)| circles(light))
    }

    /// How many changes `gesture` will have had after the next one.
    pub(crate) fn next_repeat(&self, gesture: Gesture) -> u32 {
        match self.phase(gesture) {
            GesturePhase::First => 1,
            GesturePhase::Continued => self.repeats.saturating_add(1),
        }
    }

    /// The phase of the next change in `gesture`: the first one pushes the old transform.
    #[must_use]
    pub fn phase(&self, gesture: Gesture) -> GesturePhase {
        if gesture != Gesture::Whole && gesture == self.gesture {
            GesturePhase::Continued
        } else {
            GesturePhase::First
        }
    }
}
