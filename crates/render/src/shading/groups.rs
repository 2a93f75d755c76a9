//! Groups fragments that are coloured together, because they share a draw and a pipeline.

use super::context::ShadingContext;
use super::fragments::Fragments;
use crate::frame::color_path::ColorPath;
use crate::frame::draw::Draw;

/// Fragments that are coloured together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group<'a> {
    pub(crate) draw: &'a Draw,
    pub(crate) draw_index: u32,
    /// The number of the draw's first triangle.
    pub(crate) base: u32,
    /// The number after the draw's last triangle.
    pub(crate) end: u32,
    pub(crate) pipeline: u32,
    pub(crate) path: ColorPath,
}

/// Returns the group of a triangle.
pub(crate) fn group_of<'a, T>(context: &ShadingContext<'a, T>, number: u32) -> Group<'a> {
    let (draw_index, start) = context.frame.draw_of(number);
    let draw = &context.plan.draws[draw_index as usize];
    let pipeline = draw.pipeline_of(number - start.number);
    let path = context.paths.of(draw_index, pipeline);
    Group { draw, draw_index, base: start.number, end: start.end, pipeline, path }
}

/// Returns the group of all fragments of a list, if they belong to one.
pub(crate) fn one_group<'a, T>(
    context: &ShadingContext<'a, T>,
    fragments: &Fragments,
) -> Option<Group<'a>> {
    let group = group_of(context, fragments.numbers[0]);
    are_of(context, &group, &fragments.numbers[..fragments.count]).then_some(group)
}

/// Returns whether all of some triangles belong to a group.
pub(crate) fn are_of<T>(
    context: &ShadingContext<'_, T>,
    group: &Group<'_>,
    numbers: &[u32],
) -> bool {
    let Group { draw, base, end, pipeline, .. } = *group;
    let is_uniform = draw.uniform.is_some();
    if is_uniform && context.plan.draws.len() == 1 {
        return true;
    }
    // Without a branch per triangle, so the comparisons vectorise.
    let of_draw = |number: &u32| (base <= *number) & (*number < end);
    let alike = |number: &u32| draw.pipeline_of(number - base) == pipeline;
    numbers.iter().fold(true, |all, number| all & of_draw(number))
        && (is_uniform || numbers.iter().all(alike))
}
