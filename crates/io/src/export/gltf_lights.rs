//! Exports the cameras and lights of a scene to glTF.

use glam::{DMat3, DMat4, DVec3};
use gltf_json::extensions::scene::khr_lights_punctual as punctual;
use gltf_json::scene::Node;
use gltf_json::validation::Checked;
use gltf_json::{Index, extensions};

use super::gltf::Writer;
use super::gltf_buffer::{columns, single};
use super::gltf_surface::linear;
use marraztu_core::base::math;
use marraztu_core::scene::{
    Anchor, Attenuation, Camera, HALF_APERTURE, Light, ObjectId, Projection, SpotOwner,
};

impl Writer<'_> {
    pub(super) fn camera(&mut self, camera: &Camera) {
        let lens = &camera.lens;
        if lens.shift != [0.0; 2] || lens.pixel_aspect != 1.0 {
            let text = "has a centred lens with square pixels, since glTF has no other";
            self.notes.push(format!("{} {text}", camera.name));
        }
        let is_perspective = self.view.projection == Projection::Perspective;
        // Near and far planes that are equal as f32 are invalid. A perspective camera may omit the
        // far plane, so it is dropped then.
        let near = single(lens.near).max(f32::MIN_POSITIVE);
        let perspective = gltf_json::camera::Perspective {
            aspect_ratio: None,
            yfov: single(2.0 * lens.half_angle.to_radians()).max(f32::MIN_POSITIVE),
            zfar: Some(single(lens.far)).filter(|far| *far > near),
            znear: near,
            extensions: None,
            extras: Default::default(),
        };
        let half_size = single(lens.half_size).max(f32::MIN_POSITIVE);
        let parallel_near = single(lens.parallel_near.max(0.0)).min(f32::MAX.next_down());
        let orthographic = gltf_json::camera::Orthographic {
            xmag: half_size,
            ymag: half_size,
            zfar: single(lens.parallel_far).max(parallel_near.next_up()),
            znear: parallel_near,
            extensions: None,
            extras: Default::default(),
        };
        let index = self.root.push(gltf_json::Camera {
            name: Some(camera.name.clone()),
            orthographic: (!is_perspective).then_some(orthographic),
            perspective: is_perspective.then_some(perspective),
            type_: Checked::Valid(match is_perspective {
                true => gltf_json::camera::Type::Perspective,
                false => gltf_json::camera::Type::Orthographic,
            }),
            extensions: None,
            extras: Default::default(),
        });
        let matrix = Some(columns(&camera.pose.now().world_from_camera()));
        let named = self.named(&camera.name);
        self.node(Node { camera: Some(index), matrix, ..named });
    }

    pub(super) fn lights(&mut self) {
        let mut all = Vec::new();
        let mut left_out = 0;
        for (_, light) in self.scene.lights.iter().filter(|(_, light)| light.on) {
            match self.light(light) {
                Some((own, world)) => all.push((own, world)),
                None => left_out += 1,
            }
        }
        if left_out > 0 {
            let text = "glTF has no ambient lights, no skies and no closed spots: left out";
            self.notes.push(format!("{text}: {left_out}"));
        }
        if all.is_empty() {
            return;
        }
        // The extension keeps all lights in the root; nodes refer to them by index.
        self.uses("KHR_lights_punctual");
        let mut lights = Vec::new();
        for (i, (light, world)) in (0..).zip(all) {
            let of_node = punctual::KhrLightsPunctual { light: Index::new(i) };
            let extensions = extensions::scene::Node { khr_lights_punctual: Some(of_node) };
            let named = self.named(light.name.as_deref().unwrap_or_default());
            let matrix = Some(columns(&world));
            self.node(Node { extensions: Some(extensions), matrix, ..named });
            lights.push(light);
        }
        let of_root = extensions::root::KhrLightsPunctual { lights };
        self.root.extensions = Some(extensions::root::Root { khr_lights_punctual: Some(of_root) });
    }

    /// Returns a light and its placement; `None` if glTF has no equivalent.
    fn light(&self, light: &Light) -> Option<(punctual::Light, DMat4)> {
        // glTF lights shine along -Z of their node.
        let along = |direction: DVec3| {
            math::frame(-direction, DVec3::Y, DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y))
        };
        let (kind, world) = match light.kind.anchor() {
            Anchor::Everywhere => return None,
            Anchor::Direction(direction) => {
                let world = math::placed(along(*direction.now()), DVec3::ZERO);
                (punctual::Type::Directional, world)
            }
            Anchor::Position(_) => {
                let at = self.scene.light_origin(self.view, &light.kind)?.position?;
                (punctual::Type::Point, DMat4::from_translation(at))
            }
            Anchor::Owner(owner) => {
                // glTF spots do not follow an owner: each is placed where its owner is now.
                let world = match owner {
                    SpotOwner::SelectedObject => self.object_frame(self.view.object?)?,
                    SpotOwner::Object(id) => self.object_frame(*id)?,
                    SpotOwner::SelectedCamera => {
                        self.scene.selected_camera(self.view).pose.now().world_from_camera()
                    }
                    SpotOwner::Camera(id) => {
                        self.scene.cameras.get(*id)?.pose.now().world_from_camera()
                    }
                    SpotOwner::Fixed(aim) => {
                        math::placed(along(aim.now().direction), aim.now().position)
                    }
                };
                (punctual::Type::Spot, world)
            }
        };
        let spot = (kind == punctual::Type::Spot).then(|| {
            let half_aperture = (HALF_APERTURE.get)(&light.kind).unwrap_or(HALF_APERTURE.largest);
            let outer_cone_angle = single(half_aperture.to_radians());
            // The angle must be above 0 and at most pi/2, but the nearest f32 exceeds pi/2.
            let widest = std::f32::consts::FRAC_PI_2.next_down();
            let outer_cone_angle = outer_cone_angle.clamp(f32::MIN_POSITIVE, widest);
            punctual::Spot { inner_cone_angle: 0.0, outer_cone_angle }
        });
        let intensity = match kind {
            punctual::Type::Directional => 1.0,
            punctual::Type::Point | punctual::Type::Spot => {
                self.candela(&light.attenuation, world.w_axis.truncate())
            }
        };
        let light = punctual::Light {
            color: light.color.factors().map(linear),
            extensions: None,
            extras: Default::default(),
            intensity,
            name: Some(light.name.clone()),
            range: None,
            spot,
            type_: Checked::Valid(kind),
        };
        Some((light, world))
    }

    /// Returns the frame of an object that a spot shines from.
    fn object_frame(&self, id: ObjectId) -> Option<DMat4> {
        let world = self.scene.objects.get(id)?.world_from_object(self.view.time);
        let turn = DMat3::from_mat4(world);
        let axes = math::frame(turn.z_axis, turn.y_axis, DMat3::IDENTITY);
        Some(math::placed(axes, world.w_axis.truncate()))
    }

    /// Returns the intensity with which a light with inverse-square falloff lights the middle of
    /// the scene as brightly as this one.
    fn candela(&self, fades: &Attenuation, at: DVec3) -> f32 {
        let objects = self.scene.objects.iter().filter(|(_, object)| object.visible);
        let centres = objects.map(|(_, object)| object.centre(self.view.time));
        let (sum, count) = centres.fold((DVec3::ZERO, 0.0), |(sum, n), p| (sum + p, n + 1.0));
        let d = if count > 0.0 { at.distance(sum / count).max(1.0) } else { 1.0 };
        single(d * d / (fades.constant + fades.linear * d + fades.quadratic * d * d)).max(0.0)
    }
}
