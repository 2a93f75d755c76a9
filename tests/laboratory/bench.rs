//! A fake clock and a fake picture source, with planted slowdowns and errors.

use std::time::Duration;

use marraztu_core::accuracy::{AXES, Axis, Choice, Samples, Settings};
use marraztu_core::base::image::{Picture, Size};
use marraztu_io as io;
use marraztu_lab::candidates::{LeftOut, Thoroughness, all_axes, candidates};
use marraztu_lab::pairs::{Limits, Watch};
use marraztu_lab::picture_source::PictureSource;
use marraztu_lab::sweep::{Bench, Findings, Question};
use marraztu_lab::timing::{Clock, Work};

/// The choice with the planted effect.
pub(crate) type Planted = Option<(&'static Axis, &'static Choice)>;

/// Every choice except the defaults that changes the default settings.
pub(crate) fn plantable() -> impl Iterator<Item = (&'static Axis, &'static Choice)> {
    let all = AXES.iter().flat_map(|axis| axis.choices.iter().map(move |choice| (axis, choice)));
    let default = Settings::default();
    all.filter(move |(axis, choice)| {
        let is_ideal = choice.of(&default).samples == Samples::TwoFiftySix;
        choice.word != axis.default_choice().word && (choice.among)(&default).is_ok() && !is_ideal
    })
}

/// A clock with 1 ms per picture, and 3 ms for pictures with the planted choice.
pub(crate) struct FakeClock {
    pub(crate) slow: Planted,
    /// A choice with times that are real in one pair, and four or sixteen times as long in others.
    pub(crate) disturbed: Planted,
    /// The number of pictures drawn with the disturbed choice.
    turns: usize,
    now: Duration,
}

impl FakeClock {
    pub(crate) fn new(slow: Planted) -> Self {
        Self { slow, disturbed: None, turns: 0, now: Duration::ZERO }
    }
}

impl Clock for FakeClock {
    fn time(&mut self, work: Work<'_>, todo: &mut dyn FnMut()) -> Duration {
        todo();
        let slow = match work {
            Work::Picture(settings) => self.slow.is_some_and(|(_, choice)| choice.is(settings)),
            Work::Kernel(_) => false,
        };
        let mut time = Duration::from_millis(if slow { 3 } else { 1 });
        let disturbed = |settings| self.disturbed.is_some_and(|(_, choice)| choice.is(settings));
        if matches!(work, Work::Picture(settings) if disturbed(settings)) {
            // The first picture is a warm-up. After that the factor changes from pair to pair.
            let part = [1, 4, 16][(self.turns.div_ceil(2) + 2) % 3];
            self.turns += 1;
            time *= part;
        }
        self.now += time;
        time
    }

    fn now(&self) -> Duration {
        self.now
    }
}

/// A source of grey pictures. With the planted choice one pixel is 9 steps lighter, and with
/// `coverage` one pixel shows another triangle.
pub(crate) struct FakeSource {
    pub(crate) wrong: Planted,
    pub(crate) coverage: Planted,
    /// Whether the error and the coverage change are in one pixel.
    pub(crate) same_pixel: bool,
    picture: Picture,
    primitives: Vec<u32>,
}

pub(crate) const SIZE: Size = Size::new(8, 8);

impl FakeSource {
    pub(crate) fn new(wrong: Planted, coverage: Planted) -> Self {
        let picture = Picture::filled(SIZE, [100, 100, 100, 255]);
        Self { wrong, coverage, same_pixel: false, picture, primitives: vec![1; SIZE.area()] }
    }
}

impl PictureSource for FakeSource {
    fn draw(&mut self, settings: &Settings) {
        let made = |planted: Planted| planted.is_some_and(|(_, choice)| choice.is(settings));
        let light = if made(self.wrong) { 109 } else { 100 };
        self.picture.pixels_mut()[27] = [light, 100, 100, 255];
        self.primitives[if self.same_pixel { 27 } else { 3 }] =
            if made(self.coverage) { 2 } else { 1 };
    }

    fn picture(&self) -> &Picture {
        &self.picture
    }

    fn primitives(&mut self) -> Vec<u32> {
        self.primitives.clone()
    }
}

/// Sweeps all axes on a scene to which all of them apply.
pub(crate) fn found(clock: &mut FakeClock, source: &mut FakeSource) -> Findings {
    let limits = Limits { pairs: 3, least: 3, time: Duration::from_secs(1) };
    let (combinations, time) = (20, Duration::from_secs(9));
    let thoroughness = Thoroughness { word: "test", limits, combinations, time, presets: true };
    let current = Settings::default();
    let question = Question::new(current, all_axes(), thoroughness);
    let (scene, view) = textured_scene();
    let candidates = candidates(&scene, &view, &question);
    let others = |left_out: &&LeftOut| {
        !left_out.what.contains("combinations")
            && left_out.what != "per sample shading"
            && left_out.what != "256 samples per pixel"
    };
    assert_eq!(candidates.left_out.iter().find(others), None);
    let watch = Watch::default();
    let mut bench = Bench { clock, source, watch: &watch, question: &question, size: SIZE };
    bench.run(candidates, &mut |_| {}).unwrap()
}

/// The first scene with soft shadows, a ball with bumps, and a stretched, transparent, textured and
/// mirroring triangle with an exponent of 32.
fn textured_scene() -> (marraztu_core::scene::Scene, marraztu_core::scene::View) {
    use marraztu_core::base::Shared;
    use marraztu_core::scene::*;
    let (mut scene, view) = io::default_scene();
    let cast = |(id, light): (LightId, &Light)| {
        (id, Light { shadows: light.can_cast_shadows(), size: 2.0, ..light.clone() })
    };
    scene.lights = scene.lights.iter().map(cast).collect::<Vec<_>>().into_iter().collect();
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    let options = LoadOptions::default();
    let loaded = io::parse(text, "triangle.obj", None, &options, &io::Progress::new()).unwrap();
    let [ambient, diffuse, specular] = [[0.5; 3]; 3];
    let optics = Optics { reflection: Reflection::Constant, ..Optics::NONE };
    let dull = Material::matte(ambient, diffuse);
    let material = Material { specular, exponent: 32.0, optics, ..dull };
    let mut object = Object::new(Shared::new(loaded.model), MaterialChoice::Own(material));
    let stretch = glam::DMat4::from_scale(glam::DVec3::new(1.0, 2.0, 1.0));
    object.placement = Tracked::new(stretch);
    let picture = Picture::filled(Size::new(1, 1), [255; 4]);
    object.texture = Some(Shared::new(Texture::new("", picture)));
    object.opacity = 0.5;
    let item = Item::Object(ObjectId(100), Box::new(object));
    Command::Insert { at: 0, item }.apply(&mut scene).unwrap();
    let dimples = Object::new(io::own_model("dimples").unwrap(), MaterialChoice::File);
    let item = Item::Object(ObjectId(101), Box::new(dimples));
    Command::Insert { at: 0, item }.apply(&mut scene).unwrap();
    (scene, view)
}
