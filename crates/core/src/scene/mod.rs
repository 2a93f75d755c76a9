//! The scene: objects, cameras and lights, the view, and the commands that change them.
//!
//! This module is plain data: it does not draw, read files or use windows.

mod anchor;
mod bounds;
mod camera;
mod command;
mod light;
mod light_kind;
mod list;
mod material;
mod mesh;
mod missing;
mod model;
mod object;
mod optics;
mod panorama;
mod shapes;
mod smoothing;
mod spheres;
mod surface_map;
mod texture;
mod tracked;
pub mod triangulate;
mod view;

pub use anchor::{Aim, Anchor, AnchorMut, LightOrigin, Orbit, SpotOwner};
pub use bounds::Bounds;
pub use camera::{Camera, CameraMode, Intrinsics, Lens, Pose};
pub use command::{Command, CommandError, Item, Target};
pub use light::{Attenuation, Light};
pub use light_kind::{
    CONCENTRATION, HALF_APERTURE, LIGHT_NUMBERS, LightKind, LightKindInfo, LightNumber,
};
pub use list::List;
pub use material::{Material, MaterialChoice, PRESETS, Preset, PresetId};
pub use mesh::accelerator::{Accelerator, AcceleratorPlace};
pub use mesh::cache::{Derived, Facet, NormalSource};
pub use mesh::edges::Edge;
pub use mesh::outlines::CornerLists;
pub use mesh::strokes::Stroke;
pub use mesh::{
    ClosedBodies, Corner, Mesh, MeshError, MeshSource, NONE, Part, PartNames, Point, SourceCorner,
    Triangle, dvec3, newell, split_positions,
};
pub use model::{
    BumpMaps, Environment, FileMaterial, LoadOptions, Model, Scale, Undrawn, UndrawnMap, UpAxis,
    Winding,
};
pub use object::{Object, PartLook, Sides, Spin, Surface};
pub use optics::{Optics, Reflection, Transmission};
pub use panorama::{Moments, Panorama, PanoramaLight, SkyPanorama};
pub use shapes::Shape;
pub use smoothing::{Crease, Smoothing};
pub use spheres::Spheres;
pub use surface_map::{MapKind, SurfaceMap, SurfaceMaps};
pub use texture::{Texture, Wrap};
pub use tracked::Tracked;
pub use view::{
    Fill, Frame, NormalLength, Normals, Observer, PolygonMode, Projection, Steps, Subject,
    Transformation, View,
};

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};
use serde::{Deserialize, Serialize};

use crate::base::{color::Color, math};

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident),+ $(,)?) => {
        $(
            $(#[$doc])*
            #[derive(
                Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize
            )]
            pub struct $name(pub u32);
        )+
    };
}

ids! {
    /// Identifies an object for as long as the scene lives. A smaller number is an older object.
    ObjectId,
    /// Identifies a camera for as long as the scene lives.
    CameraId,
    /// Identifies a light for as long as the scene lives.
    LightId,
}

/// Identifies an item of any of the three lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum ItemId {
    /// An object.
    Object(ObjectId),
    /// A camera.
    Camera(CameraId),
    /// A light.
    Light(LightId),
}

/// The objects of a scene, and their bounding spheres.
pub type Objects = List<ObjectId, Object, Spheres>;

/// Everything that can be drawn. A clone is cheap, since all large data is shared.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The objects, in the order that the user sees.
    pub objects: Objects,
    /// The cameras; there is always at least one.
    pub cameras: List<CameraId, Camera>,
    /// The lights.
    pub lights: List<LightId, Light>,
    /// The background colour.
    pub background: Color,
    /// The id that the next new item gets.
    pub next_id: u32,
    /// The locked items. A click in the picture does not select them; they are not moved or
    /// deleted.
    pub locked: BTreeSet<ItemId>,
}

impl Scene {
    /// The blue of the first scene.
    pub const BACKGROUND: Color = Color([0, 0, 179]);
    /// The background for models without a scene. Both black and white models contrast with it.
    pub const NEUTRAL: Color = Color([88, 92, 98]);

    /// Creates a scene with one camera and no other items.
    pub fn with_camera(camera: Camera) -> Self {
        Self {
            objects: List::default(),
            cameras: List::from_iter([(CameraId(0), camera)]),
            lights: List::default(),
            background: Self::BACKGROUND,
            next_id: 1,
            locked: BTreeSet::new(),
        }
    }

    /// Returns whether the scene has an item with this id.
    pub fn contains(&self, id: ItemId) -> bool {
        match id {
            ItemId::Object(id) => self.objects.contains(id),
            ItemId::Camera(id) => self.cameras.contains(id),
            ItemId::Light(id) => self.lights.contains(id),
        }
    }

    /// Returns the name of an item.
    pub fn name(&self, id: ItemId) -> Option<&str> {
        Some(match id {
            ItemId::Object(id) => &self.objects.get(id)?.name,
            ItemId::Camera(id) => &self.cameras.get(id)?.name,
            ItemId::Light(id) => &self.lights.get(id)?.name,
        })
    }

    /// Hides the panoramas behind all objects, which leaves their light.
    pub fn hide_panoramas(&mut self) {
        let shown = self
            .lights
            .iter()
            .filter(|(_, light)| light.kind.panorama().is_some_and(|panorama| panorama.is_shown));
        let hidden: Vec<(LightId, Light)> = shown.map(|(id, light)| (id, light.clone())).collect();
        for (id, mut light) in hidden {
            if let LightKind::Sky { panorama: Some(panorama), .. } = &mut light.kind {
                panorama.is_shown = false;
            }
            self.lights.replace(id, light);
        }
    }

    /// Returns the lowest free slot.
    pub fn free_slot(&self) -> u32 {
        let taken: BTreeSet<u32> = self.lights.iter().map(|(_, light)| light.slot).collect();
        (0..).find(|slot| !taken.contains(slot)).unwrap_or(0)
    }

    /// Returns the first view of a scene. It selects the first object, camera and light; suns
    /// precede other lights.
    pub fn first_view(&self) -> View {
        let is_sun = |light: &Light| matches!(light.kind.anchor(), Anchor::Direction(_));
        let sun = self.lights.iter().find(|(_, light)| is_sun(light));
        let light = sun.map(|(id, _)| id).or_else(|| self.lights.first());
        let camera = self.cameras.first().unwrap_or(CameraId(0));
        View::new(self.objects.first(), camera, light)
    }

    /// Returns the selected camera, or the first camera if the selected one is gone.
    pub fn selected_camera(&self, view: &View) -> &Camera {
        let first = || self.cameras.first().and_then(|id| self.cameras.get(id));
        self.cameras.get(view.camera).or_else(first).expect("a scene always has a camera")
    }

    /// Returns the frame of an object as an observer, and of its spot. The axes come from the Z and
    /// Y columns by Gram-Schmidt, so the frame is never mirrored or scaled.
    pub fn frame_of_object(object: &Object, time: f64) -> DMat4 {
        let m = object.world_from_object(time);
        let axes = DMat3::from_mat4(m);
        let axes = math::frame(axes.z_axis, axes.y_axis, DMat3::IDENTITY);
        math::placed(axes, m.w_axis.truncate())
    }

    /// Returns the current position and direction of a spot; `None` if its owner is gone.
    pub fn aim(&self, view: &View, owner: &SpotOwner) -> Option<Aim> {
        let object = |id| self.objects.get(id).map(|o| Self::frame_of_object(o, view.time));
        let camera = |id| self.cameras.get(id).map(|c| c.pose.now().world_from_camera());
        let frame = match owner {
            SpotOwner::SelectedObject => object(view.object?),
            SpotOwner::SelectedCamera => camera(view.camera),
            SpotOwner::Object(id) => object(*id),
            SpotOwner::Camera(id) => camera(*id),
            SpotOwner::Fixed(aim) => return Some(*aim.now()),
        }?;
        Some(Aim { position: frame.w_axis.truncate(), direction: -frame.z_axis.truncate() })
    }

    /// Returns the current position and direction of a light; `None` if its owner is gone.
    pub fn light_origin(&self, view: &View, kind: &LightKind) -> Option<LightOrigin> {
        let circled = |at: DVec3| kind.orbit().map_or(at, |orbit| orbit.at(at, view.time));
        let (position, direction) = match kind.anchor() {
            Anchor::Everywhere => (None, None),
            Anchor::Direction(direction) => (None, Some(*direction.now())),
            Anchor::Position(position) => (Some(circled(*position.now())), None),
            Anchor::Owner(owner) => {
                let Aim { position, direction } = self.aim(view, owner)?;
                (Some(position), Some(direction))
            }
        };
        Some(LightOrigin { position, direction })
    }

    /// Returns the matrix `world_from_view` of the observer: the frame of the selected object if
    /// the view asks for it and an object is selected, else the frame of the selected camera.
    pub fn observer_frame(&self, view: &View) -> DMat4 {
        let object = match view.observer {
            Observer::Object => view.object.and_then(|id| self.objects.get(id)),
            Observer::Camera => None,
        };
        object.map_or_else(
            || self.selected_camera(view).pose.now().world_from_camera(),
            |object| Self::frame_of_object(object, view.time),
        )
    }
}
