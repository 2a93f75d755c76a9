//! The terms of one light at one point, and the path of the light to it.

use glam::{DMat3, DVec3};

use crate::frame::FramePlan;
use crate::frame::draw::Stage;
use crate::lights::{Batch, Form, Rows, ViewLight};
use crate::shading::interpolated::ShadingNumber;
use crate::shading::pixel_color::{LightRay, Part, Term};

/// Returns the terms of one light: ambient, or diffuse and specular.
pub(super) fn light_terms<T: ShadingNumber>(
    plan: &FramePlan,
    stage: &Stage,
    batch: &Batch<T>,
    [diffuse, specular]: [[f64; 3]; 2],
    own: [f64; 3],
) -> Vec<Term> {
    let id = plan.light_ids[stage.light as usize];
    let light = &plan.lights[stage.light as usize];
    let value = [0, 1, 2].map(|i| own[i] * diffuse[i]);
    if !stage.effect.reads_positions {
        return vec![Term { light: Some(id), ..Term::new(Part::Ambient, value) }];
    }
    let ray = Some(ray(plan, stage, light, batch));
    vec![
        Term { light: Some(id), ray, ..Term::new(Part::Diffuse, value) },
        Term { light: Some(id), ..Term::new(Part::Specular, specular) },
    ]
}

/// Describes how a light reaches the first position of a batch.
fn ray<T: ShadingNumber>(
    plan: &FramePlan,
    stage: &Stage,
    light: &ViewLight,
    batch: &Batch<T>,
) -> LightRay {
    let world = World::new(plan);
    let (position, normal) = (vec3(&batch.position), vec3(&batch.normal));
    let to_eye = vec3(&batch.to_eye);
    let travels = DVec3::from_array(light.direction);
    let has_position = stage.effect.has_position;
    let way = DVec3::from_array(light.position) - position;
    // A sun has a direction, but no position.
    let (to_light, distance) = if has_position {
        (way.normalize_or_zero(), Some(way.length() / world.unit))
    } else {
        (-travels, None)
    };
    // The equations of Phong and Blinn for this point, in f64.
    let n_l = normal.dot(to_light);
    let reflected = normal * (2.0 * n_l) - to_light;
    let half_vector = stage.highlight == Form::HalfVector;
    let highlight = match half_vector {
        true => normal.dot((to_light + to_eye).normalize_or_zero()),
        false => reflected.dot(to_eye),
    };
    let [a0, a1, a2] = light.attenuation;
    let d = way.length();
    let cosine = travels.dot(-to_light).min(1.0);
    LightRay {
        to_light: world.direction(to_light),
        reflected: world.direction(reflected),
        n_l,
        highlight,
        half_vector,
        distance,
        attenuation: if has_position { 1.0 / (a0 + (a1 + a2 * d) * d) } else { 1.0 },
        cone: (stage.effect.fraction_at)(light, cosine),
        shadow: 1.0,
    }
}

/// The transform from view space to the world.
pub(super) struct World {
    world_from_view: glam::DMat4,
    turn: DMat3,
    /// The length of a world unit in view space.
    pub(super) unit: f64,
}

impl World {
    pub(super) fn new(plan: &FramePlan) -> Self {
        let unit = plan.view_from_world.x_axis.truncate().length();
        let world_from_view = plan.view_from_world.inverse();
        Self { world_from_view, turn: DMat3::from_mat4(world_from_view) * unit, unit }
    }

    pub(super) fn point(&self, at: DVec3) -> DVec3 {
        self.world_from_view.transform_point3(at)
    }

    pub(super) fn direction(&self, v: DVec3) -> DVec3 {
        self.turn * v
    }
}

/// Returns the first number of each of three rows.
pub(super) fn first<T: ShadingNumber>(rows: &Rows<T>) -> [f64; 3] {
    [rows[0][0].into(), rows[1][0].into(), rows[2][0].into()]
}

pub(super) fn vec3<T: ShadingNumber>(rows: &Rows<T>) -> DVec3 {
    DVec3::from_array(first(rows))
}

pub(super) fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Computes t D + S for the first position of a batch, in the arithmetic of the picture.
pub(super) fn reflect<T: ShadingNumber>(batch: &Batch<T>, own: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (T::from_f64(own[i]) * batch.diffuse[i][0] + batch.specular[i][0]).into())
}
