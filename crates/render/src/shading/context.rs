//! The inputs of shading, and groups of fragments that are coloured together because they share a
//! draw and a pipeline.

use std::collections::BTreeMap;

use fearless_simd::Level;

use super::face_colors::FaceColors;
use super::fragments::Fragments;
use super::interpolated::ShadingNumber;
use super::light::Lit;
use super::light_terms::LightTerms;
use super::surroundings::Surroundings;
use crate::frame::FramePlan;
use crate::frame::draw::{Draw, Pipeline, Shaded, Stage};
use crate::frame::program::{Program, Programs};
use crate::frame::shading_mode::ShadingMode;
use crate::plan::compile::{compile, compile_around};
use crate::raster::geometry::ScreenGeometry;
use crate::shadow::tracer::Tracer;

/// The parts of a frame that shading reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadingContext<'a, T> {
    pub(crate) level: Level,
    pub(crate) plan: &'a FramePlan,
    pub(crate) frame: &'a ScreenGeometry,
    pub(crate) lit: &'a Lit<T>,
    pub(crate) terms: &'a LightTerms<T>,
    /// The colours of triangles, if they are looked up.
    pub(crate) faces: Option<&'a FaceColors>,
    /// How pixels are coloured.
    pub(crate) programs: &'a Programs,
    /// The tracer, if any light casts shadows.
    pub(crate) tracer: Option<&'a Tracer<'a>>,
    /// What rays can meet, if any surface mirrors or refracts.
    pub(crate) around: Option<&'a Around<'a, T>>,
}

/// What the rays of a frame can meet, and the inputs for shading it.
#[derive(Debug)]
pub(crate) struct Around<'a, T> {
    pub(crate) surroundings: Surroundings<'a>,
    pub(crate) context: ShadingContext<'a, T>,
    /// The thing of each draw of the picture.
    pub(crate) of_draws: Vec<Option<u32>>,
}

/// What shading prepares for the frames of one arithmetic. The memory is kept from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Prepared<T> {
    programs: Programs,
    terms: LightTerms<T>,
    lit: Lit<T>,
    /// The same for the surroundings, if rays can meet them.
    around_programs: Programs,
    around_terms: LightTerms<T>,
    /// Points that rays meet have no place on the screen.
    off_screen: ScreenGeometry,
}

impl<T: ShadingNumber> Prepared<T> {
    /// Prepares a frame.
    pub(crate) fn prepare(&mut self, plan: &FramePlan) {
        let Self { programs, terms, lit, around_programs, around_terms, off_screen: _ } = self;
        compile(plan, programs);
        terms.prepare(plan, &programs.mode);
        lit.prepare(plan, programs);
        if let Some(around) = &plan.surroundings {
            compile_around(around, around_programs);
            around_terms.prepare(around, &around_programs.mode);
        }
    }

    /// Returns whether the colours of faces are looked up.
    pub(crate) const fn looks_up_faces(&self) -> bool {
        self.programs.looks_up_faces
    }

    /// Returns what rays can meet, if the frame casts any.
    pub(crate) fn around<'a>(
        &'a self,
        level: Level,
        picture: &'a FramePlan,
        tracer: Option<&'a Tracer<'a>>,
    ) -> Option<Around<'a, T>> {
        let plan = picture.surroundings.as_deref()?;
        let items = plan.draws.iter().map(|draw| draw.item);
        let of_items: BTreeMap<_, _> = items.zip(0_u32..).collect();
        let surroundings = Surroundings::new(plan);
        let own = |draw: &Draw| surroundings.thing_of(*of_items.get(&draw.item)?);
        let of_draws = picture.draws.iter().map(own).collect();
        let Self { around_programs: programs, around_terms: terms, lit, .. } = self;
        let (frame, faces, around) = (&self.off_screen, None, None);
        let context =
            ShadingContext { level, plan, frame, lit, terms, faces, programs, tracer, around };
        Some(Around { surroundings, context, of_draws })
    }

    /// Returns the inputs of shading a frame.
    pub(crate) fn context<'a>(
        &'a self,
        level: Level,
        (plan, frame): (&'a FramePlan, &'a ScreenGeometry),
        faces: Option<&'a FaceColors>,
        (tracer, around): (Option<&'a Tracer<'a>>, Option<&'a Around<'a, T>>),
    ) -> ShadingContext<'a, T> {
        let Self { programs, terms, lit, .. } = self;
        ShadingContext { level, plan, frame, lit, terms, faces, programs, tracer, around }
    }
}

impl<'a, T> ShadingContext<'a, T> {
    /// Returns the choices that hold for all surfaces.
    pub(crate) const fn mode(&self) -> &'a ShadingMode {
        &self.programs.mode
    }

    /// Returns the tracer for a draw, and the draw's own caster. `None` if the draw receives no
    /// shadows.
    pub(crate) fn tracer_of(&self, draw: u32) -> Option<(&'a Tracer<'a>, u32)> {
        let tracer = self.tracer?;
        Some((tracer, tracer.caster_of(draw)?))
    }
}

/// Fragments that are coloured together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group<'a, T> {
    pub(crate) context: &'a ShadingContext<'a, T>,
    pub(crate) draw: &'a Draw,
    pub(crate) draw_index: u32,
    /// The number of the draw's first triangle.
    pub(crate) base: u32,
    /// The number after the draw's last triangle.
    pub(crate) end: u32,
    pub(crate) pipeline: u32,
    /// The surface, if it is more than one colour.
    pub(crate) shaded: Option<&'a Shaded>,
    pub(crate) program: &'a Program,
}

impl<'a, T> Group<'a, T> {
    /// Returns whether a triangle belongs to the group.
    pub(crate) fn holds(&self, number: u32) -> bool {
        (self.base..self.end).contains(&number)
            && self.draw.pipeline_of(number - self.base) == self.pipeline
    }

    /// Returns the surface and its lights, if it is lit.
    pub(crate) fn lit(&self) -> Option<(&'a Shaded, &'a [Stage])> {
        let shaded = self.shaded?;
        Some((shaded, shaded.light.as_deref()?))
    }
}

/// Returns the group of a triangle.
pub(crate) fn group_of<'a, T>(context: &'a ShadingContext<'_, T>, number: u32) -> Group<'a, T> {
    let (draw_index, start) = context.frame.draw_of(number);
    let draw = &context.plan.draws[draw_index as usize];
    let pipeline = draw.pipeline_of(number - start.number);
    let shaded = match &context.plan.pipelines[pipeline as usize] {
        Pipeline::Shaded(shaded) => Some(shaded),
        Pipeline::Flat(_) => None,
    };
    let program = context.programs.of(draw_index, pipeline);
    let (base, end) = (start.number, start.end);
    Group { context, draw, draw_index, base, end, pipeline, shaded, program }
}

/// Returns the group of all fragments of a list, if they belong to one.
pub(crate) fn one_group<'a, T>(
    context: &'a ShadingContext<'_, T>,
    fragments: &Fragments,
) -> Option<Group<'a, T>> {
    let group = group_of(context, fragments.numbers[0]);
    are_of(&group, &fragments.numbers[..fragments.count]).then_some(group)
}

/// Returns whether all of some triangles belong to a group.
pub(crate) fn are_of<T>(group: &Group<'_, T>, numbers: &[u32]) -> bool {
    let Group { context, draw, base, end, pipeline, .. } = *group;
    let is_uniform = draw.uniform.is_some();
    // A single draw with one pipeline holds all triangles.
    if is_uniform && context.plan.draws.len() == 1 {
        return true;
    }
    // Without a branch per triangle, so the comparisons vectorise.
    let of_draw = |number: &u32| (base <= *number) & (*number < end);
    let alike = |number: &u32| draw.pipeline_of(number - base) == pipeline;
    numbers.iter().fold(true, |all, number| all & of_draw(number))
        && (is_uniform || numbers.iter().all(alike))
}
