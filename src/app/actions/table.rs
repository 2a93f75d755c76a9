//! What a user can ask for, in one table.
//!
//! Keys, menus, buttons and the cheat sheet all read [`Action::info`] and give back an [`Action`];
//! none of them changes anything. What an action means for a scene stands in one place too, and
//! whether it can be done now is asked there.

use egui::Key;

use super::chord::Chord;
use super::chord::Chord::{Command, CommandShift, Either, Lower, Named, Text, Upper};

/// How an action appears.
#[derive(Clone, Copy, Debug)]
pub struct ActionInfo {
    /// On menus and buttons.
    pub label: &'static str,
    /// Over them: one sentence.
    pub hint: &'static str,
    /// Every way to press it; the first is the one that is shown.
    pub keys: &'static [Chord],
    /// Where it stands in menus and in the cheat sheet.
    pub group: Group,
    /// Whether a held key asks for it again and again.
    pub repeats: bool,
}

/// Actions that stand together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Files and the program itself.
    File,
    /// Changes to what is selected, and taking them back.
    Edit,
    /// New things.
    Add,
    /// What the keys act on.
    Select,
    /// Moving, turning, scaling.
    Transform,
    /// What is drawn, and how.
    Show,
    /// Who looks, and from where.
    Camera,
    /// Lights on and off, colours, apertures.
    Light,
    /// Panels and help.
    Window,
}

impl Group {
    /// All of them, in the order of menus and cheat sheet.
    pub const ALL: [Self; 9] = [
        Self::File,
        Self::Edit,
        Self::Add,
        Self::Select,
        Self::Transform,
        Self::Show,
        Self::Camera,
        Self::Light,
        Self::Window,
    ];

    /// Its heading.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Add => "Add",
            Self::Select => "Select",
            Self::Transform => "Transform",
            Self::Show => "Show",
            Self::Camera => "Camera",
            Self::Light => "Light",
            Self::Window => "Window",
        }
    }

    /// Its actions, in order.
    pub fn actions(self) -> impl Iterator<Item = Action> {
        Action::ALL.iter().copied().filter(move |action| action.info().group == self)
    }
}

/// What a held key does: it asks once, or again and again.
const ONCE: bool = false;
const REPEATS: bool = true;

macro_rules! actions {
    ($($name:ident $group:ident $repeats:ident [$($key:expr),*] $label:literal $hint:literal;)+) => {
        /// Something a user can ask for that needs no further words.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Action {
            $(#[doc = $hint] $name,)+
        }

        impl Action {
            /// Every action, in the order in which menus and cheat sheet show them.
            pub const ALL: &'static [Self] = &[$(Self::$name),+];

            /// How the action appears.
            #[must_use]
            pub const fn info(self) -> ActionInfo {
                match self {
                    $(Self::$name => ActionInfo {
                        label: $label,
                        hint: $hint,
                        keys: &[$($key),*],
                        group: Group::$group,
                        repeats: $repeats,
                    },)+
                }
            }
        }
    };
}

#[rustfmt::skip]
mod table {
use super::*;
actions! {
    New            File ONCE [Command(Key::N)] "New scene" "Starts again with the first scene.";
    Open           File ONCE [Command(Key::O)] "Open scene..." "Opens a scene file in place of this scene.";
    Load           File ONCE [Lower(Key::F)] "Load model..." "Loads an .obj file, asks for its material and places it at the centre of the world.";
    Save           File ONCE [Command(Key::S)] "Save scene" "Saves the scene to its file.";
    SaveAs         File ONCE [CommandShift(Key::S)] "Save scene as..." "Saves the scene to another file.";
    SavePicture    File ONCE [Named(Key::F12)] "Save picture..." "Saves what the viewport shows as PNG, JPEG, WebP or PPM.";
    Quit           File ONCE [Named(Key::Escape), Command(Key::Q)] "Quit" "Leaves the program; asks first when something is not saved.";

    Undo           Edit ONCE [Command(Key::Z)] "Undo" "Takes the last change of the scene back.";
    Redo           Edit ONCE [CommandShift(Key::Z), Command(Key::Y)] "Redo" "Makes the change again that was last taken back.";
    TakeBack       Edit ONCE [Either(Key::U)] "Undo transformation" "Takes the last transformation of the selected item back.";
    Rename         Edit ONCE [Named(Key::F2)] "Rename" "Gives the selected item another name.";
    Duplicate      Edit ONCE [Command(Key::D)] "Duplicate" "Adds a copy of the selected item and selects it.";
    Delete         Edit ONCE [Named(Key::Delete)] "Delete" "Takes the selected item out of the scene, with what is attached to it.";
    Split          Edit ONCE [] "Split into parts" "Makes an object of each part of the selected object.";
    ToggleVisible  Edit ONCE [] "Visible" "Shows or hides the selected object or camera.";

    AddCamera      Add ONCE [Upper(Key::F)] "Camera..." "Asks for a material and adds a camera at the centre of the world, looking along -Z.";
    AddSun         Add ONCE [] "Sun" "Adds light from infinitely far away.";
    AddBulb        Add ONCE [] "Bulb" "Adds light from a point in all directions.";
    AddSpot        Add ONCE [] "Spot" "Adds light from a point in a cone, with a place of its own.";
    AddObjectSpot  Add ONCE [] "Spot on the object" "Adds a spot that shines from the selected object.";
    AddCameraSpot  Add ONCE [] "Spot on the camera" "Adds a spot that shines from the selected camera.";

    NextItem       Select REPEATS [Named(Key::Tab)] "Next item" "Selects the next camera, object or light of the subject.";
    NextPolygon    Select REPEATS [Named(Key::Enter)] "Next polygon" "Goes to the next polygon of the selected object while polygons are shown one at a time.";
    NextSubject    Select ONCE [Lower(Key::C)] "Next subject" "Goes on from camera to object to light: what the keys act on.";
    SubjectCamera  Select ONCE [] "Cameras" "The keys act on the selected camera.";
    SubjectObject  Select ONCE [] "Objects" "The keys act on the selected object.";
    SubjectLight   Select ONCE [] "Lights" "The keys act on the selected light.";

    Translate      Transform ONCE [Either(Key::T)] "Move" "The keys x, y and z move.";
    Rotate         Transform ONCE [Either(Key::R)] "Rotate" "The keys x, y and z rotate.";
    Scale          Transform ONCE [Either(Key::S)] "Scale" "The keys x, y and z scale the selected object.";
    ToggleFrame    Transform ONCE [Either(Key::G)] "Analysis / global" "Cameras: flying or looking at the selected object. Objects: own axes or the world's.";
    StepXUp        Transform REPEATS [Lower(Key::X)] "Step along or about +X" "Transforms the selected item along or about X.";
    StepXDown      Transform REPEATS [Upper(Key::X)] "Step along or about -X" "Transforms the selected item along or about X, the other way.";
    StepYUp        Transform REPEATS [Lower(Key::Y)] "Step along or about +Y" "Transforms the selected item along or about Y.";
    StepYDown      Transform REPEATS [Upper(Key::Y)] "Step along or about -Y" "Transforms the selected item along or about Y, the other way.";
    StepZUp        Transform REPEATS [Lower(Key::Z)] "Step along or about +Z" "Transforms the selected item along or about Z.";
    StepZDown      Transform REPEATS [Upper(Key::Z)] "Step along or about -Z" "Transforms the selected item along or about Z, the other way.";

    ToggleEdges    Show ONCE [Either(Key::L)] "Edges only" "Draws the edges of polygons, or fills them.";
    ToggleEdgesOverFill Show ONCE [] "Edges over faces" "Draws the edges of polygons over filled ones.";
    TogglePolygons Show ONCE [Either(Key::O)] "One polygon at a time" "Shows one polygon of the selected object, or whole objects.";
    ToggleOthers   Show ONCE [Either(Key::D)] "Selected alone" "Shows the selected object or polygon alone, or with the others.";
    ToggleBackFaces Show ONCE [Either(Key::B)] "Back faces" "Draws faces that are turned away, in red.";
    ToggleFaceNormals Show ONCE [Either(Key::N)] "Face normals" "Draws the normal of each polygon.";
    ToggleVertexNormals Show ONCE [Either(Key::M)] "Vertex normals" "Draws the normal of each vertex.";
    ToggleNormalLength Show ONCE [] "Normals by size" "Draws normals in proportion to the object rather than 5 units long.";
    ToggleLeaveOut Show ONCE [] "Leave out faint light" "Leaves out light that adds less than half a step of a byte together.";
    ToggleMarks    Show ONCE [] "Camera and lamp marks" "Draws the other cameras and the bulbs.";
    ToggleCoarse   Show ONCE [] "Coarser while moving" "Draws a slow scene less exactly while something moves, so that the picture follows; with all when it is still.";
    ToggleLightNormals Show ONCE [Either(Key::I)] "Light by face normals" "Lights polygons with the normals of faces, or of vertices.";

    ToggleProjection Camera ONCE [Either(Key::P)] "Orthographic" "Projects in parallel, or in perspective.";
    ToggleObserver Camera ONCE [Upper(Key::C)] "Look from the object" "Looks from the selected object, or through the selected camera.";
    FrameSelection Camera ONCE [Text(".")] "Frame selection" "Moves the camera so that the selected item fills the picture.";
    FrameAll       Camera ONCE [Named(Key::Home)] "Frame all" "Moves the camera so that all that is shown fills the picture.";
    LookFront      Camera ONCE [Command(Key::Num1)] "Front view" "Looks from the front, along -Z.";
    LookRight      Camera ONCE [Command(Key::Num3)] "Right view" "Looks from the right, along -X.";
    LookTop        Camera ONCE [Command(Key::Num7)] "Top view" "Looks from above, along -Y.";

    Light0         Light ONCE [Lower(Key::Num0)] "Light 0" "Switches the light with the key 0 on or off.";
    Light1         Light ONCE [Lower(Key::Num1)] "Light 1" "Switches the light with the key 1 on or off.";
    Light2         Light ONCE [Lower(Key::Num2)] "Light 2" "Switches the light with the key 2 on or off.";
    Light3         Light ONCE [Lower(Key::Num3)] "Light 3" "Switches the light with the key 3 on or off.";
    Light4         Light ONCE [Lower(Key::Num4)] "Light 4" "Switches the light with the key 4 on or off.";
    Light5         Light ONCE [Lower(Key::Num5)] "Light 5" "Switches the light with the key 5 on or off.";
    Light6         Light ONCE [Lower(Key::Num6)] "Light 6" "Switches the light with the key 6 on or off.";
    Light7         Light ONCE [Lower(Key::Num7)] "Light 7" "Switches the light with the key 7 on or off.";
    Light8         Light ONCE [Lower(Key::Num8)] "Light 8" "Switches the light with the key 8 on or off.";
    Light9         Light ONCE [Lower(Key::Num9)] "Light 9" "Switches the light with the key 9 on or off.";
    ApertureUp     Light REPEATS [Text("+")] "Wider spot" "Opens the selected spot by 5 degrees.";
    ApertureDown   Light REPEATS [Text("-")] "Narrower spot" "Closes the selected spot by 5 degrees.";
    RedUp          Light REPEATS [Lower(Key::Q)] "More red" "Adds 1 to the selected light's red.";
    RedDown        Light REPEATS [Upper(Key::Q)] "Less red" "Takes 1 from the selected light's red.";
    GreenUp        Light REPEATS [Lower(Key::V)] "More green" "Adds 1 to the selected light's green.";
    GreenDown      Light REPEATS [Upper(Key::V)] "Less green" "Takes 1 from the selected light's green.";
    BlueUp         Light REPEATS [Lower(Key::A)] "More blue" "Adds 1 to the selected light's blue.";
    BlueDown       Light REPEATS [Upper(Key::A)] "Less blue" "Takes 1 from the selected light's blue.";

    CheatSheet     Window ONCE [Either(Key::H), Text("?"), Named(Key::F1)] "Keys" "Lists every key, with what it would do now.";
    ToPanels       Window ONCE [Named(Key::F6)] "Keyboard to the panels" "Gives Tab and the arrows to the panels; Esc gives them back to the viewport.";
    ToggleOutline  Window ONCE [] "Outline" "Shows the list of objects, cameras and lights.";
    ToggleProperties Window ONCE [] "Properties" "Shows the properties of the selected item.";
    ToggleViewPanel Window ONCE [] "View switches" "Shows every switch of the view.";
    ToggleStatistics Window ONCE [] "Statistics" "Shows how much is drawn and how long it takes.";
    TogglePlan     Window ONCE [Named(Key::F3)] "Plan" "Shows each effect of the picture: on or left out, why, and what it costs.";
    MeasurePlan    Window ONCE [Named(Key::F4)] "Measure effects" "Measures how long a picture takes with and without each of its effects.";
    ToggleLaboratory Window ONCE [Named(Key::F5)] "Laboratory" "Shows what accuracy costs in time: each choice of each axis, measured and judged.";
    ThemeSystem    Window ONCE [] "As the system" "The window is light or dark as the system is.";
    ThemeLight     Window ONCE [] "Light" "Dark text on light panels.";
    ThemeDark      Window ONCE [] "Dark" "Light text on dark panels.";
}
}
pub use table::Action;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_actions_share_a_key() {
        let all: Vec<(Action, Chord)> = Action::ALL
            .iter()
            .flat_map(|action| action.info().keys.iter().map(|key| (*action, *key)))
            .collect();
        for (i, (a, key)) in all.iter().enumerate() {
            for (b, other) in &all[i + 1..] {
                assert!(!key.clashes_with(*other), "{a:?} and {b:?} are both on {key}");
            }
        }
    }

    #[test]
    fn every_key_of_the_specification_has_an_action() {
        let letters = "f F l L o O d D t T r R s S g G x X y Y z Z u U c C p P b B n N m M i I \
                       q Q v V a A 0 1 2 3 4 5 6 7 8 9 + - . ? h Tab Enter Esc Home Delete F1 F2 \
                       F12 Ctrl+Z Ctrl+Shift+Z Ctrl+Y Ctrl+S Ctrl+Shift+S Ctrl+O Ctrl+N Ctrl+D \
                       Ctrl+Q Ctrl+1 Ctrl+3 Ctrl+7";
        for name in letters.split_whitespace() {
            let named = |action: &&Action| {
                action.info().keys.iter().any(|key| key.names().iter().any(|text| text == name))
            };
            assert!(Action::ALL.iter().any(|action| named(&action)), "nothing is on {name}");
        }
    }

    #[test]
    fn only_what_the_specification_names_repeats() {
        let repeating: Vec<String> = Action::ALL
            .iter()
            .filter(|action| action.info().repeats)
            .flat_map(|action| action.info().keys.iter().flat_map(|key| key.names()))
            .collect();
        let expected = "Tab Enter x X y Y z Z + - q Q v V a A";
        assert_eq!(repeating.join(" "), expected);
    }

    #[test]
    fn every_hint_is_a_sentence_and_no_two_labels_are_alike_in_a_group() {
        for (i, action) in Action::ALL.iter().enumerate() {
            let look = action.info();
            assert!(look.hint.ends_with('.'), "{action:?}");
            for other in &Action::ALL[i + 1..] {
                let same = other.info().label == look.label;
                assert!(!same, "{action:?} and {other:?} are both called {}", look.label);
            }
        }
    }
}
