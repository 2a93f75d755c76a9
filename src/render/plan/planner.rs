//! From the things of a scene to draws.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};

use super::draw::Form;
use super::lamps::Shining;
use super::{Back, Draw, FramePlan, Lines, ObserverSpace, Pipeline, Shaded, Stage};
use crate::base::{Shared, color::Color, math};
use crate::render::effects::Matter;
use crate::render::marks;
use crate::scene::{
    Arithmetic, Fill, ItemId, LightId, LightKind, Model, NormalLength, NormalSource, Object,
    Observer, PartLook, Scene, Settings, SpecularForm, Surface, Texture, View,
};

/// What planning reads.
pub(super) struct Planner<'a> {
    pub(super) scene: &'a Scene,
    pub(super) view: &'a View,
    pub(super) settings: &'a Settings,
    pub(super) observer: ObserverSpace,
    pub(super) shining: Vec<Shining>,
}

impl Planner<'_> {
    /// Objects, the oldest first.
    pub(super) fn add_objects(&self, plan: &mut FramePlan) {
        let mut objects: Vec<_> = self.scene.objects.iter().collect();
        objects.sort_by_key(|(id, _)| *id);
        for (id, object) in objects {
            let selected = self.view.object == Some(id);
            let alone = self.view.only_selected || self.view.polygons.is_some();
            if !object.visible {
                plan.skip(&object.name, "hidden");
            } else if alone && !selected {
                plan.skip(&object.name, "only the selected object is shown");
            } else {
                self.add_object(plan, ItemId::Object(id), object, selected);
            }
        }
    }

    fn add_object(&self, plan: &mut FramePlan, item: ItemId, object: &Object, selected: bool) {
        let placement = object.world_from_object(self.view.time);
        let part_pipelines = (0..object.model.mesh.parts().len())
            .map(|part| {
                let part = u32::try_from(part).expect("parts are numbered by 32 bits");
                (!object.hidden_parts.contains(&part))
                    .then(|| self.object_pipeline(plan, object, part))
                    .flatten()
            })
            .collect();
        let polygons = self.view.polygons.as_ref().filter(|_| selected).map(|mode| {
            if self.view.polygons_stay {
                mode.shown.clone()
            } else {
                BTreeSet::from([mode.current])
            }
        });
        let back = match (object.two_sided, self.view.back_faces) {
            (true, _) => Back::Lit,
            (false, true) => Back::Red,
            (false, false) => Back::Left,
        };
        let draw = Draw {
            back,
            normal_source: if object.file_normals {
                NormalSource::File
            } else {
                NormalSource::Computed
            },
            part_pipelines,
            polygons,
            lines: self.lines(&object.model, object.edge_color),
            ..self.draw(item, &object.model, placement)
        };
        self.add(plan, &object.name, draw);
    }

    /// A draw of a mesh at a place, with everything about its surface still to be said.
    fn draw(&self, item: ItemId, model: &Shared<Model>, world_from_object: DMat4) -> Draw {
        let view_from_object = self.observer.view_from_world * world_from_object;
        let linear = DMat3::from_mat4(view_from_object);
        Draw {
            item,
            model: model.clone(),
            clip_from_object: self.observer.clip_from_view * view_from_object,
            view_from_object,
            view_from_normal: math::normal_matrix(linear),
            mirrored: linear.determinant() < 0.0,
            back: Back::Left,
            normals: self.view.normals,
            normal_source: NormalSource::File,
            part_pipelines: Vec::new(),
            uniform: None,
            polygons: None,
            filled: self.view.fill == Fill::Filled,
            lines: Lines {
                edges: false,
                face_normals: None,
                vertex_normals: None,
                color: Color::WHITE,
            },
        }
    }

    /// Puts a draw into the plan, unless nothing of it can be seen.
    fn add(&self, plan: &mut FramePlan, name: &str, mut draw: Draw) {
        let first = draw.part_pipelines.first().copied().flatten();
        let alike = draw.part_pipelines.iter().all(|pipeline| *pipeline == first);
        draw.uniform = first.filter(|_| alike);
        let linear = DMat3::from_mat4(draw.view_from_object);
        let Some(bounds) = draw.model.mesh.bounds() else {
            return plan.skip(name, "has no vertices");
        };
        let drawn_normals =
            draw.lines.face_normals.is_some() || draw.lines.vertex_normals.is_some();
        if draw.model.mesh.polygon_count() == 0 {
            plan.skip(name, "has no faces");
        } else if !math::has_full_rank(linear) {
            plan.skip(name, "its placement is flat: it has no inside and no outside");
        } else if !drawn_normals && self.observer.misses(draw.clip_from_object, bounds.corners()) {
            plan.skip(name, "outside the view");
        } else {
            plan.draws.push(draw);
        }
    }

    fn lines(&self, model: &Model, color: Color) -> Lines {
        let view = self.view;
        let extent = model.mesh.bounds().map_or(0.0, |bounds| bounds.extent().max_element());
        let length = match view.normal_length {
            NormalLength::Units => 5.0,
            NormalLength::BySize => extent / 20.0,
        };
        Lines {
            edges: view.fill == Fill::Edges || view.edges_over_fill,
            face_normals: view.face_normals.then_some(length),
            vertex_normals: view.vertex_normals.then_some(length),
            color,
        }
    }

    /// How one part of an object is drawn; `None` where its opacity leaves nothing.
    fn object_pipeline(&self, plan: &mut FramePlan, object: &Object, part: u32) -> Option<u32> {
        let look = object.part_look(part);
        let texture = look.texture.filter(|_| !object.model.mesh.uvs().is_empty());
        if object.surface != Surface::Material && texture.is_none() {
            plan.skip(format!("texture of {}", object.name), "there is none");
        }
        let opaque = |texture: &Shared<Texture>| {
            let mut texels = texture.picture.pixels().iter();
            texels.all(|texel| f64::from(texel[3]) / 255.0 * look.opacity >= 0.5)
        };
        let cutout = texture.filter(|texture| !opaque(texture)).map(|_| look.opacity);
        if look.opacity < 0.5 {
            let name = object.model.mesh.parts().get(part as usize).map_or("", |part| &part.name);
            plan.skip(format!("{} of {}", name, object.name), "its opacity is below one half");
            return None;
        }
        let colored = object.surface != Surface::Material;
        let shaded = Shaded {
            vertex_colors: colored && !object.model.mesh.colors().is_empty(),
            tint: if colored { object.tint.factors() } else { [1.0; 3] },
            texture: texture.cloned(),
            cutout,
            ..self.lit(plan, &object.name, &look, object.surface != Surface::Texture)
        };
        Some(plan.pipeline(Pipeline::Shaded(shaded)))
    }

    /// The light of a material.
    fn lit(&self, plan: &mut FramePlan, name: &str, look: &PartLook<'_>, lit: bool) -> Shaded {
        let material = look.material;
        let mut matter = Matter {
            ambient: material.ambient,
            diffuse: material.diffuse,
            specular: material.specular,
            exponent: material.exponent,
            ..Matter::default()
        }
        .with_floor(-24.0);
        let light = lit.then(|| self.stages(plan, name, &matter));
        if !lit {
            plan.skip(format!("light of {name}"), "only its texture is shown");
        }
        if self.settings.arithmetic == Arithmetic::F32 {
            let stages = light.as_deref().unwrap_or_default();
            let count = stages.iter().filter(|stage| stage.highlight != Form::Plain).count();
            let count = u32::try_from(count.max(1)).unwrap_or(u32::MAX);
            // 2^-10 shared out among the highlights, so that all that is left out stays below a
            // quarter of a byte step.
            matter = matter.with_floor(-10.0 - libm::log2(f64::from(count)));
        }
        let (vertex_colors, tint) = (false, [1.0; 3]);
        Shaded { matter, light, vertex_colors, tint, texture: None, cutout: None }
    }

    /// The lights that a material needs, the oldest first.
    fn stages(&self, plan: &mut FramePlan, name: &str, matter: &Matter) -> Vec<Stage> {
        let mut stages = Vec::new();
        for Shining { name: light, effect, lamp, .. } in &self.shining {
            let source = plan.lamps[*lamp as usize];
            if let Some(reason) = (effect.needless)(&source, matter) {
                plan.skip(format!("{light} on {name}"), reason);
                continue;
            }
            let mirrored =
                matter.specular.iter().zip(source.color).any(|(ks, color)| ks * color != 0.0);
            let highlight = match self.settings.specular {
                _ if !mirrored => Form::Plain,
                SpecularForm::Reflection => Form::Reflection,
                SpecularForm::HalfVector => Form::HalfVector,
            };
            stages.push(Stage { effect, lamp: *lamp, highlight });
        }
        stages
    }

    /// Cameras that do not look, and bulbs that shine.
    pub(super) fn add_marks(&self, plan: &mut FramePlan) {
        let object_looks = self.view.observer == Observer::Object
            && self.view.object.is_some_and(|id| self.scene.objects.get(id).is_some());
        for (id, camera) in self.scene.cameras.iter() {
            let looks = !object_looks && self.view.camera == id;
            if looks || !camera.visible {
                continue;
            }
            let mark = Object {
                name: camera.name.clone(),
                ..Object::new(camera.model.clone(), camera.material.clone())
            };
            let placement = marks::world_from_mark(camera);
            let pipelines = (0..mark.model.mesh.parts().len()).map(|part| {
                let part = u32::try_from(part).expect("parts are numbered by 32 bits");
                self.object_pipeline(plan, &mark, part)
            });
            let part_pipelines = pipelines.collect();
            let draw = Draw {
                back: if self.view.back_faces { Back::Red } else { Back::Left },
                part_pipelines,
                lines: self.lines(&mark.model, mark.edge_color),
                ..self.draw(ItemId::Camera(id), &mark.model, placement)
            };
            self.add(plan, &camera.name, draw);
        }
        for (id, position) in self.shining.iter().filter_map(|light| self.bulb_place(light.id)) {
            let Some(placement) = marks::world_from_diamond(&self.observer, position) else {
                continue;
            };
            let pipeline = plan.pipeline(Pipeline::Flat(marks::YELLOW));
            let draw = Draw {
                part_pipelines: vec![Some(pipeline)],
                filled: true,
                ..self.draw(ItemId::Light(id), marks::diamond(), placement)
            };
            self.add(plan, "mark of the bulb", draw);
        }
    }

    fn bulb_place(&self, id: LightId) -> Option<(LightId, DVec3)> {
        match &self.scene.lights.get(id)?.kind {
            LightKind::Bulb { position, orbit } => {
                Some((id, orbit.at(*position.now(), self.view.time)))
            }
            _ => None,
        }
    }
}
