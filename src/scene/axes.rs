//! The axes of accuracy: every choice that trades exactness for time, in one table.
//!
//! Menus, the command line and the laboratory read this table, and a scene file's words are held to
//! it by test: an axis is known everywhere by standing here. A row says what the axis is, how its
//! choices are set in [`Settings`] and read back, which of them is the most exact, where the axis
//! means something, and what there is to learn from it. The default of an axis is what
//! [`Settings::default`] has.

use super::{Arithmetic, Filter, LeaveOut, LightAt, Scene, Settings, SpecularForm, View};

/// One way in which a picture can be more or less exact, or otherwise modelled.
#[derive(Debug)]
pub struct Axis {
    /// What it is called in text: "light evaluated".
    pub name: &'static str,
    /// Its option on the command line, and its field in a scene file.
    pub key: &'static str,
    /// Its name on a narrow row: "Shading".
    pub label: &'static str,
    /// What it says, as a phrase: "Where light is evaluated".
    pub what: &'static str,
    /// Whether one choice is nearer to the truth than another.
    pub kind: AxisKind,
    /// The choices, from the coarse to the exact where they are scored.
    pub choices: &'static [Choice],
    /// Whether it changes anything in a scene that is seen so, and why not.
    pub sense: fn(&Scene, &View) -> Result<(), &'static str>,
    /// What it teaches.
    pub lesson: Lesson,
}

/// Whether the choices of an axis can be ranked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisKind {
    /// The last choice is the most exact, and the others have an error against it.
    Scored,
    /// The choices are different models of the world: none is an error of another.
    Model,
}

/// A place on an axis.
#[derive(Debug)]
pub struct Choice {
    /// Its word on the command line.
    pub word: &'static str,
    /// Its name on a button.
    pub label: &'static str,
    /// What it does, in a sentence.
    pub what: &'static str,
    /// The error to expect of it, in words.
    pub error: &'static str,
    set: fn(&mut Settings),
    is: fn(&Settings) -> bool,
}

/// What an axis teaches, in three sentences.
#[derive(Debug)]
pub struct Lesson {
    /// What it is.
    pub what: &'static str,
    /// What goes wrong when it is coarse.
    pub coarse: &'static str,
    /// Where that shows.
    pub shows: &'static str,
    /// The small scene, carried by the program, in which the difference is plain to see.
    pub scene: &'static str,
}

/// A named point in the space of accuracy.
#[derive(Debug)]
pub struct Preset {
    /// Its word on the command line.
    pub word: &'static str,
    /// Its name on a button.
    pub label: &'static str,
    /// What it is for, in a sentence.
    pub what: &'static str,
    /// Where it differs from the default: keys of axes, with words of their choices.
    pub points: &'static [(&'static str, &'static str)],
}

/// A choice that sets one field of the settings to one value.
macro_rules! choice {
    ($word:literal $label:literal $field:ident = $value:expr, $what:literal, $error:literal) => {
        Choice {
            word: $word,
            label: $label,
            what: $what,
            error: $error,
            set: |settings| settings.$field = $value,
            is: |settings| settings.$field == $value,
        }
    };
}

/// Every axis, in the order in which they are shown.
pub const AXES: &[Axis] = &[
    Axis {
        name: "light evaluated",
        key: "shading",
        label: "Shading",
        what: "Where light is evaluated",
        kind: AxisKind::Scored,
        choices: &[
            choice!("face" "Face" light = LightAt::Face,
                "Light is evaluated once a polygon (flat).",
                "whole polygons, by as much as light changes across one"),
            choice!("vertex" "Vertex" light = LightAt::Vertex,
                "Light is evaluated at vertices (Gouraud).",
                "highlights smaller than a polygon dim or vanish"),
            choice!("pixel" "Pixel" light = LightAt::Pixel,
                "Light is evaluated at each pixel (Phong).",
                "none"),
        ],
        sense: |scene, view| if_any(scene, view, is_lit, "nothing that is shown is lit"),
        lesson: Lesson {
            what: "Light can be worked out once a polygon, once a corner, or once a pixel.",
            coarse: "Between corners colours are only mixed, so a highlight that falls inside a \
                polygon is missed, and one on a corner is smeared along its edges.",
            shows: "Shiny surfaces of few polygons show it most: compare the bright spot on the \
                ball with Vertex and with Pixel.",
            scene: "ball",
        },
    },
    Axis {
        name: "arithmetic of light",
        key: "arithmetic",
        label: "Arithmetic",
        what: "The numbers that light is computed in",
        kind: AxisKind::Scored,
        choices: &[
            choice!("f32" "32 bits" arithmetic = Arithmetic::F32,
                "Light in 32-bit numbers, sixteen at once.",
                "0.008 of a byte step, before rounding"),
            choice!("f64" "64 bits" arithmetic = Arithmetic::F64,
                "Light in 64-bit numbers: the reference, slow.",
                "none"),
        ],
        sense: |scene, view| if_any(scene, view, is_lit, "nothing that is shown is lit"),
        lesson: Lesson {
            what: "Every number is rounded when it is stored: 32 bits keep 7 digits, 64 bits 16.",
            coarse: "The digits that are lost almost never reach the eye: a byte changes only \
                where the exact value lies next to the border between two steps.",
            shows: "Nowhere without help: look at the picture of the error, amplified 256 times.",
            scene: "ball",
        },
    },
    Axis {
        name: "faint light",
        key: "faint",
        label: "Faint light",
        what: "What becomes of light too faint to matter",
        kind: AxisKind::Scored,
        choices: &[
            choice!("left-out" "Left out" leave_out = LeaveOut::HalfStep,
                "Light that together adds less than half a step of a byte is not evaluated.",
                "one byte step at the most"),
            choice!("kept" "Kept" leave_out = LeaveOut::Unseen,
                "Only what changes no bit of the picture is left out.",
                "none"),
        ],
        sense: |scene, view| if_any(scene, view, is_lit, "nothing that is shown is lit"),
        lesson: Lesson {
            what: "A lamp that is far off, or a highlight at its rim, may add less light than a byte \
                can tell.",
            coarse: "What is left out together adds less than half a step, so that a byte may be \
                rounded the other way: one step at the most.",
            shows: "Nowhere without help: look at the picture of the error, amplified 256 times, where \
                highlights fade out.",
            scene: "ball",
        },
    },
    Axis {
        name: "texture filter",
        key: "filter",
        label: "Textures",
        what: "What a texture gives between its texels",
        kind: AxisKind::Scored,
        choices: &[
            choice!("nearest" "Nearest" filter = Filter::Nearest,
                "The texel that a place falls into.",
                "as much as neighbouring texels differ"),
            choice!("bilinear" "Bilinear" filter = Filter::Bilinear,
                "A mean of the four texels around a place.",
                "none"),
        ],
        sense: |scene, view| {
            if_any(scene, view, is_textured, "nothing that is shown has a texture")
        },
        lesson: Lesson {
            what: "A texture is a grid of colours, and pixels seldom fall on the middle of a \
                texel: the nearest one is taken, or the four around are mixed.",
            coarse: "With the nearest texel alone a picture that is seen from near falls into \
                blocks, and its edges jump as the view moves.",
            shows: "Look at a texture from so near that a texel covers many pixels.",
            scene: "plate",
        },
    },
    Axis {
        name: "specular form",
        key: "specular",
        label: "Highlight",
        what: "The form of the highlight",
        kind: AxisKind::Model,
        choices: &[
            choice!("reflection" "R.V" specular = SpecularForm::Reflection,
                "Phong's highlight: (R.V)^Ns.",
                "a model, not scored"),
            choice!("half-vector" "N.H" specular = SpecularForm::HalfVector,
                "Blinn's highlight: (N.H)^Ns.",
                "a model, not scored"),
        ],
        sense: |scene, view| {
            if_any(scene, view, is_mirroring, "nothing that is shown mirrors light")
        },
        lesson: Lesson {
            what: "A highlight can be measured from the mirrored light to the eye (R.V), or from \
                the normal to the half-way between light and eye (N.H).",
            coarse: "Neither is an error of the other: with the same exponent N.H is about twice \
                as wide, and it stretches where light grazes.",
            shows: "On the rim of a shiny ball lit from behind, and in the size of every highlight.",
            scene: "ball",
        },
    },
];

/// Named points, from the fast to the exact.
pub const ACCURACY_PRESETS: &[Preset] = &[
    Preset {
        word: "draft",
        label: "Draft",
        what: "Quick: light at vertices, the nearest texel.",
        points: &[("shading", "vertex"), ("filter", "nearest")],
    },
    Preset {
        word: "default",
        label: "Default",
        what: "What the editor begins with: at most a quarter of a byte step of light is lost.",
        points: &[],
    },
    Preset {
        word: "exact",
        label: "Exact",
        what: "At most one byte step from the reference on every pixel.",
        points: &[("arithmetic", "f64")],
    },
];

impl Axis {
    /// The axis of this key.
    #[must_use]
    pub fn named(key: &str) -> Option<&'static Self> {
        AXES.iter().find(|axis| axis.key == key)
    }

    /// The choice of this word.
    #[must_use]
    pub fn choice(&self, word: &str) -> Option<&'static Choice> {
        self.choices.iter().find(|choice| choice.word == word)
    }

    /// What these settings have chosen.
    #[must_use]
    pub fn chosen(&self, settings: &Settings) -> &'static Choice {
        let chosen = self.choices.iter().find(|choice| choice.is(settings));
        chosen.expect("every value of a setting is a choice of its axis")
    }

    /// What settings have that nobody has touched.
    #[must_use]
    pub fn default_choice(&self) -> &'static Choice {
        self.chosen(&Settings::default())
    }

    /// The most exact choice; of a model, the one that the settings have.
    #[must_use]
    pub fn most_exact(&self, settings: &Settings) -> &'static Choice {
        match (self.kind, self.choices.last()) {
            (AxisKind::Scored, Some(last)) => last,
            _ => self.chosen(settings),
        }
    }
}

impl Choice {
    /// The settings with this choice made.
    #[must_use]
    pub fn of(&self, settings: &Settings) -> Settings {
        let mut settings = *settings;
        (self.set)(&mut settings);
        settings
    }

    /// Whether it is the choice of these settings.
    #[must_use]
    pub fn is(&self, settings: &Settings) -> bool {
        (self.is)(settings)
    }
}

impl Preset {
    /// The preset of this word.
    #[must_use]
    pub fn named(word: &str) -> Option<&'static Self> {
        ACCURACY_PRESETS.iter().find(|preset| preset.word == word)
    }

    /// The settings that the preset names. Models stay as they are chosen.
    #[must_use]
    pub fn of(&self, settings: &Settings) -> Settings {
        self.points.iter().fold(Settings::default().modelled_as(settings), |settings, point| {
            let choice = Axis::named(point.0).and_then(|axis| axis.choice(point.1));
            choice.expect("presets name axes and choices of the table").of(&settings)
        })
    }
}

impl Settings {
    /// The reference: every axis at its most exact. Models stay as they are chosen.
    #[must_use]
    pub fn reference(&self) -> Self {
        AXES.iter().fold(*self, |settings, axis| axis.most_exact(&settings).of(&settings))
    }

    /// These settings with the models that others have chosen.
    #[must_use]
    pub fn modelled_as(&self, others: &Self) -> Self {
        let models = AXES.iter().filter(|axis| axis.kind == AxisKind::Model);
        models.fold(*self, |settings, axis| axis.chosen(others).of(&settings))
    }

    /// In words, where they differ from the default: "shading vertex, filter nearest".
    #[must_use]
    pub fn in_words(&self) -> String {
        let preset = ACCURACY_PRESETS.iter().find(|preset| preset.of(self) == *self);
        let differs = |axis: &&Axis| axis.chosen(self).word != axis.default_choice().word;
        let words: Vec<String> = AXES
            .iter()
            .filter(differs)
            .filter(|axis| preset.is_none() || axis.kind == AxisKind::Model)
            .map(|axis| format!("{} {}", axis.key, axis.chosen(self).word))
            .collect();
        match (preset, words.is_empty()) {
            (Some(preset), true) => preset.label.to_owned(),
            (Some(preset), false) => format!("{}, {}", preset.label, words.join(", ")),
            (None, _) => words.join(", "),
        }
    }
}

/// Whether one of the parts that are shown has it; else the reason that is given.
fn if_any(
    scene: &Scene,
    view: &View,
    has: fn(&super::Object, u32) -> bool,
    reason: &'static str,
) -> Result<(), &'static str> {
    let alone = |id| view.object == Some(id);
    let all = !view.only_selected && view.polygons.is_none();
    let shown = scene.objects.iter().filter(|(id, object)| object.visible && (all || alone(*id)));
    let mut parts = shown.flat_map(|(_, object)| {
        let count = u32::try_from(object.model.mesh.parts().len()).unwrap_or(u32::MAX);
        (0..count).filter(|part| !object.hidden_parts.contains(part)).map(move |i| (object, i))
    });
    if parts.any(|(object, part)| has(object, part)) { Ok(()) } else { Err(reason) }
}

fn is_lit(object: &super::Object, _: u32) -> bool {
    object.surface != super::Surface::Texture
}

fn is_textured(object: &super::Object, part: u32) -> bool {
    !object.model.mesh.uvs().is_empty() && object.part_look(part).texture.is_some()
}

fn is_mirroring(object: &super::Object, part: u32) -> bool {
    is_lit(object, part) && object.part_look(part).material.specular.iter().any(|ks| *ks > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_choice_is_read_back_as_it_was_set_and_touches_no_other_axis() {
        for axis in AXES {
            for choice in axis.choices {
                let settings = choice.of(&Settings::default());
                assert_eq!(axis.chosen(&settings).word, choice.word);
                let held = axis.choices.iter().filter(|choice| choice.is(&settings)).count();
                assert_eq!(held, 1, "{}: {}", axis.key, choice.word);
                for other in AXES.iter().filter(|other| other.key != axis.key) {
                    assert_eq!(other.chosen(&settings).word, other.default_choice().word);
                }
            }
        }
    }

    #[test]
    fn the_reference_is_exact_in_everything_and_keeps_the_models() {
        let chosen = Settings {
            light: LightAt::Face,
            specular: SpecularForm::HalfVector,
            ..Settings::default()
        };
        let reference = chosen.reference();
        assert_eq!(reference.arithmetic, Arithmetic::F64);
        assert_eq!(reference.light, LightAt::Pixel);
        assert_eq!(reference.filter, Filter::Bilinear);
        assert_eq!(reference.leave_out, LeaveOut::Unseen);
        assert_eq!(reference.specular, SpecularForm::HalfVector);
    }

    #[test]
    fn presets_are_the_points_that_their_names_promise() {
        let of = |word: &str| Preset::named(word).unwrap().of(&Settings::default());
        let draft = Settings { light: LightAt::Vertex, filter: Filter::Nearest, ..of("default") };
        assert_eq!(of("draft"), draft);
        assert_eq!(of("default"), Settings::default());
        assert_eq!(of("exact"), Settings { arithmetic: Arithmetic::F64, ..Settings::default() });
        assert_eq!(draft.in_words(), "Draft");
        let other = Settings { specular: SpecularForm::HalfVector, ..of("exact") };
        assert_eq!(other.in_words(), "Exact, specular half-vector");
        let other = Settings { light: LightAt::Face, ..other };
        assert_eq!(other.in_words(), "shading face, arithmetic f64, specular half-vector");
    }

    #[test]
    fn a_filter_makes_no_sense_without_a_texture_and_a_highlight_none_without_ks() {
        use crate::base::Shared;
        use crate::scene::*;
        let source = MeshSource {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            corners: (0..3)
                .map(|position| SourceCorner { position, uv: NONE, normal: NONE })
                .collect(),
            arities: vec![3],
            polygon_parts: vec![0],
            parts: vec![Part { name: String::new(), material: None }],
            ..MeshSource::default()
        };
        let model = Shared::new(Model {
            name: String::new(),
            source: None,
            options: LoadOptions::default(),
            mesh: Mesh::new(source).unwrap(),
            materials: Vec::new(),
            edge_color: None,
        });
        let dull =
            Material { ambient: [0.1; 3], diffuse: [0.5; 3], specular: [0.0; 3], exponent: 1.0 };
        let mut scene = Scene::with_camera(Camera {
            name: String::new(),
            visible: true,
            model: model.clone(),
            material: MaterialChoice::Own(dull),
            pose: Placed::new(Pose::facing_minus_z(glam::DVec3::Z)),
            lens: Lens::default(),
        });
        let sense = |scene: &Scene, key: &str| {
            (Axis::named(key).unwrap().sense)(scene, &scene.first_view()).is_ok()
        };
        for axis in AXES {
            assert!(!sense(&scene, axis.key), "{} of an empty scene", axis.key);
        }
        let object = Object::new(model, MaterialChoice::Own(dull));
        let item = Item::Object(ObjectId(1), Box::new(object));
        Command::Insert { at: 0, item }.apply(&mut scene).unwrap();
        assert!(sense(&scene, "shading") && sense(&scene, "arithmetic"));
        assert!(!sense(&scene, "filter") && !sense(&scene, "specular"));
    }
}
