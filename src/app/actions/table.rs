//! The table of actions: labels, hints, keys and groups.
//!
//! Keys, menus, buttons and the cheat sheet read [`Action::info`] and return an [`Action`]; none of
//! them changes anything. The effect of an action on a scene, and whether the action is available,
//! are decided in one place too: `resolve`. Each panel has an action, made from the table of
//! panels.

use egui::Key;

use super::info::StepName::{self, Amount, Around, Switched};
use super::info::{ActionInfo, Group, ONCE, REPEATS, actions};
use crate::app::chord::Chord::{
    Alt, Command, CommandShift, Either, Lower, Named, Shifted, Text, Upper,
};
use crate::app::panels::Panel;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::transform::Sign;

actions! {
    New File ONCE [Command(Key::N)]
        "New scene" "Starts over with the default scene."
        "reset empty start over clear";
    NewAncestor File ONCE []
        "New ancestor's scene" "Starts over with the first scene as ancestor A drew it."
        "reset first points preset history original";
    Open File ONCE [Command(Key::O)]
        "Open scene..." "Opens a scene file instead of this scene."
        "project file import";
    Load File ONCE [Lower(Key::F)]
        "Load model..." "Loads an .obj file, asks for its material and places it at the origin."
        "import obj add mesh object insert file";
    ReloadModels File ONCE [Command(Key::R)]
        "Reload models" "Reloads all model files as one undo step."
        "refresh update reread file disk again";
    ToggleWatch File ONCE []
        "Reload when files change" "Reloads models when another program saves them."
        "watch hot live refresh auto update disk";
    RecoverWork File ONCE [CommandShift(Key::R)]
        "Recover unsaved work" "Recovers unsaved work after a crash."
        "crash restore lost backup journal autosave";
    RecoverDiscarded File ONCE []
        "Recover discarded work..." "Restores work that was discarded in the last 30 days."
        "crash restore lost backup journal trash undelete";
    FindMissing File ONCE []
        "Find missing files..." "Locates the missing models and textures of the scene."
        "locate relink lost path broken placeholder box texture model";
    Save File ONCE [Command(Key::S)]
        "Save scene" "Saves the scene to its file."
        "write store keep";
    SaveAs File ONCE [CommandShift(Key::S)]
        "Save scene as..." "Saves the scene to a new file."
        "write export copy";
    SavePicture File ONCE [Named(Key::F12)]
        "Save picture..." "Saves the picture in the viewport as PNG, JPEG, WebP or PPM."
        "screenshot render export image png capture snapshot photo";
    PictureOptions File ONCE [Shifted(Key::F12)]
        "Save picture with options..."
        "Asks for size, samples, a transparent background and overlays, and saves a picture."
        "screenshot render resolution size transparent alpha large print wallpaper";
    SaveTurntable File ONCE [Command(Key::F12)]
        "Turntable..." "Saves a turntable as a GIF, an APNG or numbered pictures."
        "animation gif apng video movie spin rotate frames";
    ExportModels File ONCE []
        "Export models..."
        "Exports the objects as OBJ with MTL, or as glTF, without cameras and lights."
        "save obj mtl gltf glb blender three convert";
    ExportScene File ONCE []
        "Export scene..." "Exports the objects, cameras and lights as glTF, or the objects as OBJ."
        "save obj mtl gltf glb blender three convert";
    CopyPicture File ONCE [CommandShift(Key::C)]
        "Copy picture" "Copies the picture in the viewport to the clipboard."
        "screenshot clipboard image capture snapshot";
    Quit File ONCE [Command(Key::Q)]
        "Quit" "Closes the program; asks first if there are unsaved changes."
        "exit leave close";

    Undo Edit REPEATS [Command(Key::Z)]
        "Undo" "Undoes the last change to the scene."
        "back revert";
    Redo Edit REPEATS [CommandShift(Key::Z), Command(Key::Y)]
        "Redo" "Redoes the last change that was undone."
        "again forward repeat";
    TakeBack Edit ONCE [Either(Key::U)]
        "Undo transformation" "Undoes the last transformation of the selected item."
        "revert step back reset";
    Rename Edit ONCE [Named(Key::F2)]
        "Rename" "Renames the selected item."
        "name title label"
        => Around("Rename", "");
    Cut Edit ONCE [Command(Key::X)]
        "Cut" "Moves the selected items to the clipboard as text."
        "clipboard take move"
        => Around("Cut", "");
    Copy Edit ONCE [Command(Key::C)]
        "Copy" "Copies the selected items to the clipboard as text."
        "clipboard text";
    Paste Edit ONCE [Command(Key::V)]
        "Paste" "Adds the copied items, or applies the copied material to the selected objects."
        "clipboard insert text";
    CopyMaterial Edit ONCE []
        "Copy material" "Copies the material of the selected object; Paste applies it to others."
        "clipboard surface look shader";
    Duplicate Edit ONCE [Command(Key::D)]
        "Duplicate" "Adds a copy next to the selected item and selects it."
        "copy clone paste"
        => Around("Duplicate", "");
    Delete Edit ONCE [Named(Key::Delete)]
        "Delete" "Deletes the selected item and the spots attached to it."
        "remove erase trash"
        => Around("Delete", "");
    Split Edit ONCE []
        "Split into parts" "Splits the selected object into one object per part."
        "separate explode ungroup pieces";
    SelectAll Edit ONCE [Command(Key::A)]
        "Select all" "Selects all items of the subject; pressed again, everything."
        "everything several multiple";
    Escape Window ONCE [Named(Key::Escape)]
        "Cancel" "Dismisses notices, cancels work or deselects; twice with nothing left, it quits."
        "escape dismiss abort stop close deselect quit";
    SelectNone Edit ONCE []
        "Select one" "Selects only the current item, which the keys act on."
        "none deselect clear single nothing";
    ChooseTexture Edit ONCE []
        "Texture..." "Chooses a picture as the texture of the selected object."
        "texture image map picture skin uv wrap paint";
    ToggleVisible Edit ONCE []
        "Visible" "Shows or hides the selected object or camera."
        "hide show eye"
        => Switched("Hide", "Show");
    ToggleLocked Edit ONCE [Command(Key::L)]
        "Locked" "Protects the selected item from being clicked, moved or deleted."
        "lock unlock protect freeze pin fix selectable"
        => Switched("Unlock", "Lock");

    AddGround Add ONCE []
        "Ground" "Adds ground below all objects; it receives shadows and fades out far away."
        "floor plane horizon fade infinite disc shape new";
    AddPlane Add ONCE []
        "Plane" "Adds a square plane below all objects."
        "floor ground quad primitive shape new";
    AddCube Add ONCE []
        "Cube" "Adds a cube, a fifth as large as the view, on the ground next to the others."
        "box primitive shape new";
    AddSphere Add ONCE []
        "Sphere" "Adds a sphere, a fifth as large as the view, on the ground next to the others."
        "ball globe primitive shape new";
    AddCylinder Add ONCE []
        "Cylinder"
        "Adds a cylinder, a fifth as large as the view, on the ground next to the others."
        "tube pipe primitive shape new";
    AddTorus Add ONCE []
        "Torus" "Adds a torus, a fifth as large as the view, on the ground next to the others."
        "ring donut primitive shape new";
    AddCamera Add ONCE [Upper(Key::F)]
        "Camera..." "Asks for a material and adds a camera at the origin, looking along -Z."
        "viewpoint eye new";
    AddSky Add ONCE []
        "Sky" "Adds light from the sky above and the ground below."
        "ambient occlusion hemisphere environment dome light new";
    AddSun Add ONCE []
        "Sun" "Adds a directional light, infinitely far away."
        "directional light lamp new";
    AddBulb Add ONCE []
        "Bulb" "Adds a light that shines from a point in all directions."
        "point light lamp omni new";
    AddSpot Add ONCE []
        "Spot" "Adds a light that shines from a point in a cone."
        "spotlight cone light lamp torch new";
    AddObjectSpot Add ONCE []
        "Spot on the object" "Adds a spot that shines from the selected object."
        "spotlight headlight torch";
    AddCameraSpot Add ONCE []
        "Spot on the camera" "Adds a spot that shines from the selected camera."
        "spotlight headlight torch flash";

    NextItem Select REPEATS [Named(Key::Tab)]
        "Next item" "Selects the next camera, object or light of the subject."
        "cycle select following";
    NextPolygon Select REPEATS [Named(Key::Enter)]
        "Next polygon" "Selects the next polygon of the selected object in polygon mode."
        "face triangle cycle";
    NextSubject Select ONCE [Lower(Key::C)]
        "Next subject" "Makes the keys act on the next subject: cameras, objects or lights."
        "cycle mode what";
    SubjectCamera Select ONCE []
        "Cameras" "Makes the keys act on the selected camera."
        "subject view navigate";
    SubjectObject Select ONCE []
        "Objects" "Makes the keys act on the selected object."
        "subject model mesh";
    SubjectLight Select ONCE []
        "Lights" "Makes the keys act on the selected light."
        "subject lamp brightness intensity";

    Translate Transform ONCE [Either(Key::T)]
        "Move" "Makes the keys x, y and z move the selected item."
        "translate translation position grab shift";
    Rotate Transform ONCE [Either(Key::R)]
        "Rotate" "Makes the keys x, y and z rotate the selected item."
        "rotation turn spin angle";
    Scale Transform ONCE [Either(Key::S)]
        "Scale" "Makes the keys x, y and z scale the selected object."
        "scaling size resize bigger smaller stretch enlarge";
    ToggleFrame Transform ONCE [Either(Key::G)]
        "Analysis / global"
        "Switches cameras between fly and orbit, objects between local and global axes."
        "orbit fly look around local global world axes turntable";
    TypeAmount Transform ONCE []
        "Transform by a number" "Transforms by a typed axis and number: x 12 Enter."
        "type amount exact distance angle factor numeric move rotate scale";
    DropToGround Transform ONCE []
        "Drop to the ground" "Moves the selected object up or down until it rests on the ground."
        "floor land rest snap lowest stand"
        => Around("Drop", "to the ground");
    ResetPlacement Transform ONCE []
        "Reset the placement" "Restores the placement of the selected object from its file."
        "origin clear transformation identity zero original"
        => Around("Reset the placement of", "");
    AlignX Transform ONCE []
        "Align along X" "Aligns the other selected objects with this one along X."
        "line up arrange distribute centre center left right";
    AlignY Transform ONCE []
        "Align along Y" "Aligns the other selected objects with this one along Y."
        "line up arrange distribute centre center height";
    AlignZ Transform ONCE []
        "Align along Z" "Aligns the other selected objects with this one along Z."
        "line up arrange distribute centre center depth";
    StepXUp Transform REPEATS [Lower(Key::X)]
        "Step along or about +X" "Transforms the selected item one step along or about +X."
        "nudge move turn grow x"
        => Amount(Axis::X, Sign::Positive);
    StepXDown Transform REPEATS [Upper(Key::X)]
        "Step along or about -X" "Transforms the selected item one step along or about -X."
        "nudge move turn grow x"
        => Amount(Axis::X, Sign::Negative);
    StepYUp Transform REPEATS [Lower(Key::Y)]
        "Step along or about +Y" "Transforms the selected item one step along or about +Y."
        "nudge move turn grow y"
        => Amount(Axis::Y, Sign::Positive);
    StepYDown Transform REPEATS [Upper(Key::Y)]
        "Step along or about -Y" "Transforms the selected item one step along or about -Y."
        "nudge move turn grow y"
        => Amount(Axis::Y, Sign::Negative);
    StepZUp Transform REPEATS [Lower(Key::Z)]
        "Step along or about +Z" "Transforms the selected item one step along or about +Z."
        "nudge move turn grow z"
        => Amount(Axis::Z, Sign::Positive);
    StepZDown Transform REPEATS [Upper(Key::Z)]
        "Step along or about -Z" "Transforms the selected item one step along or about -Z."
        "nudge move turn grow z"
        => Amount(Axis::Z, Sign::Negative);

    ToggleEdges Show ONCE [Either(Key::L)]
        "Wireframe" "Draws the edges of polygons instead of filling them."
        "wire mesh lines edges outline";
    ToggleEdgesOverFill Show ONCE []
        "Edges over faces" "Draws the edges of polygons over the filled polygons."
        "wireframe overlay lines mesh contour";
    TogglePolygons Show ONCE [Either(Key::O)]
        "Polygon by polygon"
        "Shows a single polygon of the selected object instead of whole objects."
        "face triangle single step";
    ToggleOthers Show ONCE [Either(Key::D)]
        "Isolate selection" "Hides everything but the selected object or polygon."
        "solo only hide others focus";
    ToggleBackFaces Show ONCE [Either(Key::B)]
        "Back faces" "Draws back faces in red instead of culling them."
        "culling inside two sided backface";
    ToggleFaceNormals Show ONCE [Either(Key::N)]
        "Face normals" "Draws the normal of each polygon."
        "arrows direction perpendicular";
    ToggleVertexNormals Show ONCE [Either(Key::M)]
        "Vertex normals" "Draws the normal of each vertex."
        "arrows direction perpendicular smooth";
    ToggleNormalLength Show ONCE []
        "Normals by size" "Draws normals in proportion to the object instead of 5 units long."
        "long short arrows scale";
    ToggleMarks Show ONCE []
        "Camera and light models" "Draws the models of the other cameras and of bulbs."
        "icons gizmo markers pyramids diamond";
    ToggleOverlays Show ONCE []
        "Overlays" "Draws the selection outline, the axes and light markers over the picture."
        "gizmo axes cones helpers outline guides widgets";
    ToggleGizmo Show ONCE []
        "Gizmo" "Shows handles that move, rotate and scale the selection."
        "handles manipulator arrows rings widget transform drag move rotate scale";
    ToggleGrid Show ONCE []
        "Ground grid" "Draws a grid on the ground, at height 0, behind everything."
        "floor lines helper helpers plane horizon";
    ToggleDimensions Show ONCE []
        "Dimensions" "Draws the bounding boxes of the selected objects, with their sizes."
        "size measure ruler bounding box extent length width height helper helpers";
    ToggleDirections Show ONCE []
        "Light directions" "Draws the direction of every sun and spot."
        "cones arrows sun spot helper helpers aim";
    ToggleCoarse Show ONCE []
        "Coarser while moving" "Draws slow scenes at reduced quality while something moves."
        "quality fast preview performance resolution";
    ToggleRefine Show ONCE []
        "Refine when still"
        "Increases the samples per pixel while nothing moves."
        "smooth edges progressive quality sharp";
    DialDraft Show ONCE [Named(Key::F7)]
        "Draft accuracy" "Draws a quarter of the pixels, for speed."
        "preset quality fast preview low dial";
    DialDefault Show ONCE [Named(Key::F8)]
        "Default accuracy" "Draws with the default of every choice."
        "preset quality normal medium reset dial";
    DialExact Show ONCE [Named(Key::F9)]
        "Exact accuracy" "Draws with every choice at its most exact."
        "preset quality high reference best dial";
    DialIdeal Show ONCE [Named(Key::F10)]
        "Ideal accuracy" "Draws 256 samples per pixel, with every choice at its most exact."
        "preset quality highest supersampling ground truth dial";
    ToggleDial Show ONCE []
        "Accuracy dial" "Shows or hides what accuracy costs in this view."
        "presets time error milliseconds quality cost";
    ToggleLoupe Show ONCE [Either(Key::K)]
        "Loupe" "Shows the pixels under the pointer next to the ideal; hold the key or press it."
        "magnifier zoom pixels compare difference ideal";
    ToggleLightNormals Show ONCE [Either(Key::I)]
        "Flat shading (face normals)"
        "Lights polygons with face normals instead of vertex normals."
        "smooth shading faceted hard soft";

    ToggleProjection Camera ONCE [Either(Key::P)]
        "Orthographic" "Switches between orthographic and perspective projection."
        "ortho parallel perspective isometric";
    ToggleObserver Camera ONCE [Upper(Key::C)]
        "Look from the object"
        "Looks from the selected object instead of through the selected camera."
        "ride first person point of view";
    FrameSelection Camera ONCE [Text(".")]
        "Frame selection" "Moves the camera so that the selected item fills the picture."
        "zoom focus centre center fit find";
    FrameAll Camera ONCE [Named(Key::Home)]
        "Frame all" "Moves the camera so that everything visible fills the picture."
        "zoom fit home everything centre center reset view";
    PreviousView Camera ONCE [Alt(Key::ArrowLeft)]
        "Previous view" "Moves the camera back to where the last movement of the view began."
        "undo view camera back earlier history orbit zoom lost";
    NextView Camera ONCE [Alt(Key::ArrowRight)]
        "Next view" "Moves the camera forward again, after Previous view."
        "redo view camera forward later history";
    SavedView Camera ONCE []
        "Back to the saved view"
        "Moves the camera to where it was when the scene was opened or last saved."
        "reset view camera home restore original start file";
    LookFront Camera ONCE [Command(Key::Num1)]
        "Front view" "Looks from the front, along -Z."
        "camera ahead";
    LookRight Camera ONCE [Command(Key::Num3)]
        "Right view" "Looks from the right, along -X."
        "camera side left";
    LookTop Camera ONCE [Command(Key::Num7)]
        "Top view" "Looks from above, along -Y."
        "camera above bird plan down";
    ExplainPixel Show ONCE [Either(Key::E)]
        "Explain a pixel"
        "Explains the surface and the colour of the next pixel that you click."
        "why colour color value inspect probe light terms debug vectors";
    LookBack Camera ONCE []
        "Back view" "Looks from behind, along +Z."
        "camera behind rear";
    LookLeft Camera ONCE []
        "Left view" "Looks from the left, along +X."
        "camera side";
    LookBottom Camera ONCE []
        "Bottom view" "Looks from below, along +Y."
        "camera under up";
    WhyUnseen Camera ONCE [Either(Key::W)]
        "Why can't I see it?" "Explains why the selected object is invisible, and how to fix it."
        "invisible missing gone lost hidden vanished black find";

    Light0 Light ONCE [Lower(Key::Num0)]
        "Light 0" "Switches light 0 on or off."
        "lamp turn on off";
    Light1 Light ONCE [Lower(Key::Num1)]
        "Light 1" "Switches light 1 on or off."
        "lamp turn on off";
    Light2 Light ONCE [Lower(Key::Num2)]
        "Light 2" "Switches light 2 on or off."
        "lamp turn on off";
    Light3 Light ONCE [Lower(Key::Num3)]
        "Light 3" "Switches light 3 on or off."
        "lamp turn on off";
    Light4 Light ONCE [Lower(Key::Num4)]
        "Light 4" "Switches light 4 on or off."
        "lamp turn on off";
    Light5 Light ONCE [Lower(Key::Num5)]
        "Light 5" "Switches light 5 on or off."
        "lamp turn on off";
    Light6 Light ONCE [Lower(Key::Num6)]
        "Light 6" "Switches light 6 on or off."
        "lamp turn on off";
    Light7 Light ONCE [Lower(Key::Num7)]
        "Light 7" "Switches light 7 on or off."
        "lamp turn on off";
    Light8 Light ONCE [Lower(Key::Num8)]
        "Light 8" "Switches light 8 on or off."
        "lamp turn on off";
    Light9 Light ONCE [Lower(Key::Num9)]
        "Light 9" "Switches light 9 on or off."
        "lamp turn on off";
    ApertureUp Light REPEATS [Text("+")]
        "Wider spot" "Opens the selected spot by 5 degrees."
        "cone angle bigger widen";
    ApertureDown Light REPEATS [Text("-")]
        "Narrower spot" "Closes the selected spot by 5 degrees."
        "cone angle smaller tighten";
    SoloLight Light ONCE []
        "Only this light" "Switches off all lights but this one; pressed again, restores them."
        "solo isolate single mute others";
    LightStudio Light ONCE []
        "Studio lights" "Replaces all lights by a sky with occlusion and a large soft lamp."
        "look ambient occlusion soft shadows beautiful render setup preset";
    ChoosePanorama Light ONCE []
        "Panorama..." "Lights the scene with a picture of everything around, shown behind it."
        "sky environment hdri hdr exr equirectangular ibl image based lighting background map";
    FitExposure Light ONCE []
        "Fit exposure" "Sets the highest exposure that does not overexpose surfaces."
        "exposure brightness overexposed burnt white tone mapping stops levels auto";
    ToggleAllShadows Light ONCE []
        "Shadows" "Switches the shadows of all lights on or off."
        "shadow cast ray trace occlusion shade";
    ToggleShadows Light ONCE []
        "Shadows of this light" "Switches the shadows of the selected light on or off."
        "shadow cast ray trace occlusion shade lamp";
    AimAtSelection Light ONCE []
        "Aim at selection" "Turns the selected spot or sun towards the selected object."
        "point target look track direct"
        => Around("Aim", "at the selection");
    AimByClick Light ONCE []
        "Aim by a click" "Turns the selected spot or sun towards the next point that you click."
        "point target look direct";
    RedUp Light REPEATS [Lower(Key::Q)]
        "More red" "Adds 1 to the selected light's red."
        "color colour tint";
    RedDown Light REPEATS [Upper(Key::Q)]
        "Less red" "Subtracts 1 from the selected light's red."
        "color colour tint";
    GreenUp Light REPEATS [Lower(Key::V)]
        "More green" "Adds 1 to the selected light's green."
        "color colour tint";
    GreenDown Light REPEATS [Upper(Key::V)]
        "Less green" "Subtracts 1 from the selected light's green."
        "color colour tint";
    BlueUp Light REPEATS [Lower(Key::A)]
        "More blue" "Adds 1 to the selected light's blue."
        "color colour tint";
    BlueDown Light REPEATS [Upper(Key::A)]
        "Less blue" "Subtracts 1 from the selected light's blue."
        "color colour tint";

    Palette Window ONCE [Command(Key::K), Command(Key::P)]
        "Command palette" "Finds actions, items and settings by name."
        "search find run commands";
    ToPanels Window ONCE [Named(Key::F6)]
        "Focus next region"
        "Moves keyboard focus to the next region; Esc returns it to the viewport."
        "focus next region tab";
    ToPanelsBack Window ONCE [Shifted(Key::F6)]
        "Focus previous region"
        "Moves keyboard focus to the previous region; from the first, to the viewport."
        "focus previous region tab";
    Present Window ONCE [Named(Key::F11)]
        "Presentation"
        "Shows the picture and the dial alone on the full screen, in large type; Esc ends it."
        "full screen fullscreen lecture projector beamer teach large";
    MeasurePlan Window ONCE [Named(Key::F4)]
        "Measure effects" "Measures the time of a picture with and without each effect."
        "benchmark time profile speed";
    PastNotices Window ONCE []
        "Past notices..." "Lists the notices so far, with their findings."
        "findings messages warnings log";
    LargerText Window ONCE [Command(Key::Plus), Command(Key::Equals)]
        "Larger interface" "Makes text and panels larger."
        "zoom in scale font size big ui";
    SmallerText Window ONCE [Command(Key::Minus)]
        "Smaller interface" "Makes text and panels smaller."
        "zoom out scale font size small ui";
    NormalText Window ONCE [Command(Key::Num0)]
        "Normal interface size" "Resets text and panels to the size set in the system."
        "zoom reset scale font size ui";
    ThemeSystem Window ONCE []
        "System theme" "Makes the window light or dark like the system."
        "theme auto colours colors";
    ThemeLight Window ONCE []
        "Light theme" "Shows dark text on light panels."
        "theme mode white day bright";
    ThemeDark Window ONCE []
        "Dark theme" "Shows light text on dark panels."
        "theme mode black night";
}
