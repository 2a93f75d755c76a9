//! Scene files use the words of the table of axes.

use std::path::Path;

use marraztu_core::accuracy::{AXES, Settings};
use marraztu_io as io;

/// Converts "half-vector" to the form in scene files, `HalfVector`.
fn camel(word: &str) -> String {
    let upper = |part: &str| part[..1].to_uppercase() + &part[1..];
    word.split('-').map(upper).collect()
}

fn settings_text(settings: &Settings) -> String {
    let (scene, view) = io::default_scene();
    let text = io::to_text(Path::new("scene.marraztu"), &scene, &view, settings).unwrap();
    let settings = text.split("settings: (").nth(1).unwrap();
    settings.split(')').next().unwrap().to_owned()
}

/// A setting without a row in the table would be neither offered nor measured.
#[test]
fn a_scene_file_says_each_axis_by_its_key_and_each_choice_by_its_word() {
    let fields = settings_text(&Settings::default()).matches(':').count();
    assert_eq!(fields, AXES.len(), "an axis is not in the table");
    for axis in AXES {
        for choice in axis.choices {
            let text = settings_text(&choice.of(&Settings::default()));
            let field = format!("{}: {},", axis.key, camel(choice.word));
            assert!(text.contains(&field), "{field} is not in {text}");
        }
    }
}

#[test]
fn a_scene_file_of_the_time_when_shading_was_called_light_still_opens() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.marraztu");
    let (scene, view) = io::default_scene();
    let text = io::to_text(&path, &scene, &view, &Settings::default()).unwrap();
    std::fs::write(&path, text.replace("shading: Pixel", "light: Face")).unwrap();
    let opened = io::open(&path, &io::Progress::new()).unwrap();
    assert_eq!(opened.settings.light, marraztu_core::accuracy::LightAt::Face);
    std::fs::write(&path, text.replace("shading: Pixel", "shadnig: Face")).unwrap();
    assert!(io::open(&path, &io::Progress::new()).is_err());
}
