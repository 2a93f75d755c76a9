//! Which pixels of a block are coloured together: those of one draw that are drawn in one way.

use super::context::ShadingContext;
use crate::render::frame::draw::Draw;
use crate::render::shading::fragments::Fragments;

/// Pixels that are coloured together.
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

/// The group of all triangles of a list, where they are all of one.
pub(crate) fn one_group<'a, T>(
    context: &ShadingContext<'a, T>,
    items: &Fragments,
) -> Option<Group<'a>> {
    let group = group_of(context, items.numbers[0]);
    let end = context.frame.draw_of(items.numbers[0]).1.end;
    let numbers = &items.numbers[..items.count];
    let alike = |number: &u32| {
        (group.base..end).contains(number)
            && (group.draw.uniform.is_some()
                || group.draw.pipeline_of(number - group.base) == group.pipeline)
    };
    numbers.iter().all(alike).then_some(group)
}
