use super::*;
use crate::accuracy::AccuracyPreset;
use crate::accuracy::{Arithmetic, Filter, LightAt, Samples, SpecularForm, SpecularPower};

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
fn the_reference_has_every_axis_at_its_most_exact_and_keeps_the_models() {
    let chosen = Settings {
        light: LightAt::Face,
        specular: SpecularForm::HalfVector,
        ..Settings::default()
    };
    let reference = chosen.reference();
    assert_eq!(reference.arithmetic, Arithmetic::F64);
    assert_eq!(reference.light, LightAt::Pixel);
    assert_eq!(reference.filter, Filter::Trilinear);
    assert_eq!(reference.power, SpecularPower::Library);
    assert_eq!(reference.specular, SpecularForm::HalfVector);
}

#[test]
fn the_references_depend_on_no_choice_but_models() {
    let one = Settings::default();
    for axis in AXES.iter().filter(|axis| axis.kind != AxisKind::Model) {
        for choice in axis.choices {
            let chosen = choice.of(&one);
            assert_eq!(chosen.reference(), one.reference(), "{} {}", axis.key, choice.word);
            assert_eq!(chosen.sampled(), one, "{} {}", axis.key, choice.word);
        }
    }
    assert_eq!((one.reference().samples, one.reference().light), (Samples::One, LightAt::Pixel));
    let sample = Axis::named("shading").unwrap().choice("sample").unwrap();
    assert_eq!((sample.among)(&one), Err("a pixel has one sample"));
    assert_eq!((sample.among)(&Settings { samples: Samples::Four, ..one }), Ok(()));
    let half = Settings { specular: SpecularForm::HalfVector, ..one };
    assert_eq!(half.sampled(), half);
}

#[test]
fn presets_have_the_settings_that_their_names_promise() {
    let of = |word: &str| AccuracyPreset::named(word).unwrap().of(&Settings::default());
    let draft = Settings { light: LightAt::Vertex, filter: Filter::Nearest, ..of("default") };
    assert_eq!(of("draft"), draft);
    assert_eq!(of("default"), Settings::default());
    let exact = Settings {
        arithmetic: Arithmetic::F64,
        power: SpecularPower::Library,
        ..Settings::default()
    };
    assert_eq!(of("exact"), exact);
    assert_eq!(draft.in_words(), "Draft");
    let other = Settings { specular: SpecularForm::HalfVector, ..of("exact") };
    assert_eq!(other.in_words(), "Exact, highlights by N.H");
    let other = Settings { light: LightAt::Face, ..other };
    assert_eq!(
        other.in_words(),
        "flat shading, light in 64 bits, specular power by libm, highlights by N.H"
    );
}

#[test]
fn a_filter_changes_nothing_without_a_texture_nor_a_highlight_without_ks() {
    use crate::base::Shared;
    use crate::scene::*;
    let source = MeshSource {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        corners: (0..3).map(|position| SourceCorner { position, uv: NONE, normal: NONE }).collect(),
        arities: vec![3],
        polygon_parts: vec![0],
        parts: vec![Part { name: String::new(), material: None }],
        ..MeshSource::default()
    };
    let model = Shared::new(Model {
        name: String::new(),
        source: None,
        companions: Vec::new(),
        options: LoadOptions::default(),
        mesh: Mesh::new(source).unwrap(),
        materials: Vec::new(),
        edge_color: None,
    });
    let dull = Material {
        ambient: [0.1; 3],
        diffuse: [0.5; 3],
        specular: [0.0; 3],
        exponent: 1.0,
        emission: [0.0; 3],
    };
    let mut scene = Scene::with_camera(Camera {
        name: String::new(),
        visible: true,
        model: model.clone(),
        material: MaterialChoice::Own(dull),
        pose: Tracked::new(Pose::facing_minus_z(glam::DVec3::Z)),
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
