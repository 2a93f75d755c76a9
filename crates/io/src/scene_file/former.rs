//! Finds choices of older scene files that no longer exist.
//!
//! [`Settings`](marraztu_core::accuracy::Settings) read them as the default of their axis. That
//! changes the picture, so each is noted here, by parsing the settings a second time.

use serde::Deserialize;

use crate::findings::{FindingKind, Findings};

/// A choice of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
enum Choice {
    EverySixteen,
    Map512Pcf,
    Map1024,
    Map1024Pcf,
    Map4096,
    Map4096Pcf,
    Schlick,
    Weighted,
    /// Any choice that still exists, or that equals the default.
    #[default]
    #[serde(other)]
    Other,
}

/// The former choices, as they may occur in a text.
const FORMER: [Choice; 8] = [
    Choice::EverySixteen,
    Choice::Map512Pcf,
    Choice::Map1024,
    Choice::Map1024Pcf,
    Choice::Map4096,
    Choice::Map4096Pcf,
    Choice::Schlick,
    Choice::Weighted,
];

/// The axes that lost choices.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Choices {
    power: Choice,
    transparency: Choice,
    #[serde(rename = "shadow-method")]
    shadow_method: Choice,
    interpolation: Choice,
}

/// The part of a scene file with the settings.
#[derive(Deserialize)]
struct Part {
    #[serde(default)]
    settings: Choices,
}

/// Notes the former choices in the text of a valid scene file.
pub(super) fn note(text: &str, findings: &mut Findings) {
    // Few files name one, perhaps as a part of another word; all others are parsed only once.
    if !FORMER.iter().any(|choice| text.contains(&format!("{choice:?}"))) {
        return;
    }
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    let Ok(Part { settings }) = ron::from_str(text) else { return };
    let Choices { power, transparency, shadow_method, interpolation } = settings;
    for (axis, choice) in [
        ("power", power),
        ("transparency", transparency),
        ("shadow-method", shadow_method),
        ("interpolation", interpolation),
    ] {
        if choice != Choice::Other {
            findings.add(FindingKind::SettingFormer, &format!("{axis}: {choice:?}"), None);
        }
    }
}
