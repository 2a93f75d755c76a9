//! Reading and writing of models, textures, scene files and pictures.
//!
//! Files come from untrusted sources, so no content may stop the program. A file is either rejected
//! with one reason, or loaded with a list of all repairs.
//!
//! ```
//! let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n";
//! let (options, progress) = Default::default();
//! let loaded = marraztu_io::parse(obj, "sail.obj", None, &options, &progress)?;
//! assert_eq!(loaded.model.mesh.triangles().len(), 1);
//! for finding in &loaded.findings {
//!     println!("{}", finding.text);
//! }
//! # assert_eq!(loaded.findings.len(), 1);
//! # Ok::<(), marraztu_io::LoadError>(())
//! ```

mod animation;
mod assets;
mod companions;
mod describe;
mod dimples;
mod error;
mod examples;
mod export;
mod facts;
mod finding_kinds;
mod findings;
mod fingerprint;
mod input;
mod keeping;
mod layers;
mod lessons;
mod load;
mod loaded;
mod locate;
mod mark;
mod mtl;
mod numbers;
mod obj;
mod packed;
mod panorama;
mod part;
mod picture;
mod progress;
mod read;
mod replace;
mod scene_file;
mod sources;
mod spool;
mod stamp;
mod stl;
mod texture;
mod up_axis;
mod window_state;

pub use animation::{Animation, AnimationFormat, AnimationWriter};
pub use assets::{cam_model, default_scene, empty_scene, own_model, own_texture};
pub use companions::{Companion, companions};
pub use describe::{describe, describe_model, short as short_number};
pub use error::LoadError;
pub use examples::{EXAMPLES, Example, check_file, is_example};
pub use export::{EXPORT_ENDINGS, ExportOptions, Exported, check_export_target, export};
pub use facts::{
    BoundsFacts, EdgeFacts, FaceFacts, FindingFacts, MapFacts, MaterialFacts, ModelFacts,
    PartFacts, ReadFacts, SmoothingFacts, with_slashes,
};
pub use findings::{Finding, FindingKind, joined};
pub use fingerprint::Fingerprint;
pub use input::Input;
pub use keeping::{
    Abandoned, Discarded, Helpers, Journal, JournalNews, MOST_RECENT, OwnFolders, Preferences,
    Theme, Unsaved,
};
pub use layers::{
    ExrCamera, IdPixels, LayerKind, LayerNumbers, LayerPicture, PngNumbers, layer_npy, layer_png,
    layers_exr,
};
pub use lessons::{Lesson, lesson_on, lesson_scene, lessons};
pub use load::{load, parse};
pub use loaded::Loaded;
pub use numbers::{Numbers, PictureContent, load_content};
pub use panorama::{load_panorama, panorama_endings};
pub use part::sweep_once;
pub use picture::{
    NextBand, PICTURE_FORMATS, PictureFormat, check_alpha, check_layer_target,
    check_picture_target, check_replaced, save_bands, save_encoded, save_picture,
};
pub use progress::{Cancelled, Progress};
pub use read::read_file;
pub use replace::{NewFile, SaveError, check_scheme};
pub use scene_file::{
    Fragment, Known, Opened, SCENE_ENDING, SceneFileError, items_of_text, items_to_text,
    material_to_text, open, save, save_with_window, scene_of_message, scene_to_message, to_text,
};
pub use sources::Sources;
pub use spool::Spool;
pub use stamp::{encode_stamped, read_stamp, stamp_of, stamped_at_end};
pub use stl::usual_crease;
pub use texture::{
    load_picture, load_texture, load_texture_with, texture_endings, texture_formats,
};
pub use up_axis::{StatedUp, stated_up, usual_up};
pub use window_state::{Panels, WindowState};
