//! A shape in the light of the first scene, with a camera that moves every frame.

use std::time::Duration;

use criterion::Bencher;
use glam::DVec3;
use marraztu_core::accuracy::Settings;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{
    CameraId, Command, Item, ItemId, MaterialChoice, Model, Object, ObjectId, Pose, PresetId,
    Scene, Tracked, View,
};
use marraztu_io as io;
use marraztu_render::plan_frame;
use marraztu_render::{FramePlan, Renderer};

/// The size of most windows.
pub(crate) const FULL: Size = Size { width: 1920, height: 1080 };

/// The scene of a benchmark.
pub(crate) struct Stage {
    pub(crate) scene: Scene,
    pub(crate) view: View,
    pub(crate) settings: Settings,
    pub(crate) size: Size,
}

impl Stage {
    /// Places a model in ruby at 20 times its size, the scale at which the first scene's lights
    /// work.
    pub(crate) fn new(model: &Shared<Model>, size: Size) -> Self {
        let (mut scene, view) = io::default_scene();
        let ids: Vec<ObjectId> = scene.objects.ids().collect();
        let removals = ids.into_iter().map(|id| Command::Remove(ItemId::Object(id)));
        Command::Batch(removals.collect()).apply(&mut scene).expect("they are there");
        let mut object = Object::new(model.clone(), MaterialChoice::Preset(PresetId::RUBY));
        object.placement = Tracked::new(glam::DMat4::from_scale(DVec3::splat(20.0)));
        let item = Item::Object(ObjectId(0), Box::new(object));
        Command::Insert { at: 0, item }.apply(&mut scene).expect("it fits");
        let view = View { object: Some(ObjectId(0)), marks: false, ..view };
        Self { scene, view, settings: Settings::default(), size }
    }

    /// Plans frame `i`. Each frame has a different camera position, which prevents the renderer
    /// from reusing the last one.
    #[expect(clippy::cast_precision_loss, reason = "few frames")]
    pub(crate) fn plan(&self, i: u64) -> FramePlan {
        let mut scene = self.scene.clone();
        let id: CameraId = scene.cameras.first().expect("there is one");
        let mut camera = scene.cameras.get(id).expect("it is there").clone();
        let eye = DVec3::new(0.001 * (i % 1000) as f64, 0.0, 46.0);
        camera.pose = Tracked::new(Pose::facing_minus_z(eye));
        let camera = Item::Camera(id, Box::new(camera));
        Command::Replace(camera).apply(&mut scene).expect("it is there");
        plan_frame(&Shot::new(&scene, &self.view, &self.settings, self.size))
    }

    /// Draws frames and sums the times that `time` reads from the renderer after each.
    pub(crate) fn drawn(
        &self,
        frames: u64,
        mut time: impl FnMut(&Renderer) -> Duration,
    ) -> Duration {
        let mut renderer = Renderer::default();
        renderer.render(&self.plan(frames));
        (0..frames)
            .map(|i| {
                renderer.render(&self.plan(i));
                time(&renderer)
            })
            .sum()
    }

    /// Measures whole frames, including their planning. The first frames, which grow the renderer's
    /// memory, are not measured: criterion calls this again for each sample.
    pub(crate) fn measure(&self, bencher: &mut Bencher<'_>) {
        let (mut renderer, mut i) = (Renderer::default(), 2);
        (0..i).for_each(|i| _ = renderer.render(&self.plan(i)));
        bencher.iter(|| {
            i += 1;
            renderer.render(&self.plan(i)).pixels()[0]
        });
    }
}
