//! Groups the fragments of a block that are coloured together: those of one draw and one pipeline.

use super::context::ShadingContext;
use super::fragments::Fragments;
use crate::render::frame::draw::Draw;

/// Fragments that are coloured together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group<'a> {
    pub(crate) draw: &'a Draw,
    pub(crate) draw_index: u32,
    /// The number of the draw's first triangle.
    pub(crate) base: u32,
    pub(crate) pipeline: u32,
}

/// The group that a triangle belongs to.
pub(crate) fn group_of<'a, T>(context: &ShadingContext<'a, T>, number: u32) -> Group<'a> {
    let (draw_index, start) = context.frame.draw_of(number);
    let draw = &context.plan.draws[draw_index as usize];
    let pipeline = draw.pipeline_of(number - start.number);
    Group { draw, draw_index, base: start.number, pipeline }
}

/// The group of all fragments of a list, if they belong to one.
pub(crate) fn one_group<'a, T>(
    context: &ShadingContext<'a, T>,
    fragments: &Fragments,
) -> Option<Group<'a>> {
    let group = group_of(context, fragments.numbers[0]);
    let end = context.frame.draw_of(fragments.numbers[0]).1.end;
    let numbers = &fragments.numbers[..fragments.count];
    let is_uniform = group.draw.uniform.is_some();
    if is_uniform && context.plan.draws.len() == 1 {
        return Some(group);
    }
    // Without a branch for each, so that several are compared at once.
    let of_draw = |number: &u32| (group.base <= *number) & (*number < end);
    let alike = |number: &u32| group.draw.pipeline_of(number - group.base) == group.pipeline;
    let is_one = numbers.iter().fold(true, |all, number| all & of_draw(number))
        && (is_uniform || numbers.iter().all(alike));
    is_one.then_some(group)
}
