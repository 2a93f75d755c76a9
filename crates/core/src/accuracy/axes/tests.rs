use super::*;
use crate::accuracy::AccuracyPreset;
use crate::accuracy::{Filter, LightAt, Resolution, Samples, SpecularForm};

#[test]
fn each_choice_is_read_back_as_set_and_changes_no_other_axis() {
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
fn the_ideal_has_every_axis_at_its_most_exact_and_keeps_the_models() {
    let chosen = Settings {
        light: LightAt::Face,
        specular: SpecularForm::HalfVector,
        ..Settings::default()
    };
    let ideal = chosen.ideal();
    for axis in AXES.iter().filter(|axis| axis.kind == AxisKind::Scored) {
        assert_eq!(axis.chosen(&ideal).word, axis.choices.last().unwrap().word, "{}", axis.key);
    }
    assert_eq!(ideal.specular, SpecularForm::HalfVector);
    assert_eq!((ideal.samples, ideal.light), (Samples::TwoFiftySix, LightAt::Sample));
    assert_eq!(chosen.reference(), Settings { samples: Samples::One, ..ideal });
}

#[test]
fn the_ideal_depends_on_no_choice_but_models_and_the_reference_on_the_samples_too() {
    let one = Settings::default();
    for axis in AXES.iter().filter(|axis| axis.kind != AxisKind::Model) {
        for choice in axis.choices {
            let chosen = choice.of(&one);
            assert_eq!(chosen.ideal(), one.ideal(), "{} {}", axis.key, choice.word);
            let reference = Settings { samples: chosen.samples, ..one.reference() };
            assert_eq!(chosen.reference(), reference, "{} {}", axis.key, choice.word);
        }
    }
    let sample = Axis::named("shading").unwrap().choice("sample").unwrap();
    assert_eq!((sample.among)(&one), Err("a pixel has one sample"));
    assert_eq!((sample.among)(&Settings { samples: Samples::Four, ..one }), Ok(()));
}

#[test]
fn one_axis_alone_is_judged_against_its_own_most_exact_choice() {
    let chosen = Settings { light: LightAt::Face, filter: Filter::Nearest, ..Settings::default() };
    let shading = chosen.exact_in(Axis::named("shading").unwrap());
    assert_eq!(shading, Settings { light: LightAt::Pixel, ..chosen });
    let half = Settings { specular: SpecularForm::HalfVector, ..chosen };
    assert_eq!(half.exact_in(Axis::named("specular").unwrap()), chosen);
}

#[test]
fn presets_have_the_settings_that_their_names_promise() {
    let of = |word: &str| AccuracyPreset::named(word).unwrap().of(&Settings::default());
    let draft = Settings { resolution: Resolution::Half, ..of("default") };
    assert_eq!(of("draft"), draft);
    assert_eq!(of("default"), Settings::default());
    // Exact is the reference itself, also when it is refined.
    let exact = of("exact");
    assert_eq!(exact, Settings::default().reference());
    let refined = exact.refined();
    assert_eq!(refined, refined.reference());
    assert_eq!(of("ideal"), Settings::default().ideal());
    assert_eq!(of("ideal").refined(), of("ideal"));
    let dial: Vec<&str> = AccuracyPreset::dial().iter().map(|preset| preset.word).collect();
    assert_eq!(dial, ["draft", "default", "exact", "ideal"]);
    assert_eq!(draft.in_words(), "Draft");
    let other = Settings { specular: SpecularForm::HalfVector, ..of("exact") };
    assert_eq!(other.in_words(), "Exact, highlights by N.H");
    let other = Settings { light: LightAt::Face, ..draft };
    assert_eq!(other.in_words(), "flat shading, half resolution");
}

#[test]
fn a_filter_changes_nothing_without_a_texture_nor_a_highlight_without_ks() {
    use crate::base::Shared;
    use crate::scene::*;
    let source = MeshSource {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        ..MeshSource::of_polygons((0..3).map(SourceCorner::bare), vec![3])
    };
    let model = Shared::new(Model::of_mesh("", Mesh::new(source).unwrap()));
    let dull = Material::matte([0.1; 3], [0.5; 3]);
    let camera = Camera::new("", model.clone(), MaterialChoice::Own(dull), glam::DVec3::Z);
    let mut scene = Scene::with_camera(camera);
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
