//! Which pixels of a block are coloured together: those of one draw that are drawn in one way.

use super::items::Items;
use super::surface::Scenery;
use crate::render::plan::Draw;

/// Pixels that are coloured together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<'a> {
    pub(super) draw: &'a Draw,
    pub(super) draw_index: u32,
    /// The number of the draw's first triangle.
    pub(super) base: u32,
    pub(super) pipeline: u32,
}

/// The group that a triangle belongs to.
pub(super) fn group_of<'a, T>(scenery: &Scenery<'a, T>, number: u32) -> Group<'a> {
    let (draw_index, start) = scenery.frame.draw_of(number);
    let draw = &scenery.plan.draws[draw_index as usize];
    let pipeline = draw.pipeline_of(number - start.number);
    Group { draw, draw_index, base: start.number, pipeline }
}

/// The group of all triangles of a list, where they are all of one.
pub(super) fn one_group<'a, T>(scenery: &Scenery<'a, T>, items: &Items) -> Option<Group<'a>> {
    let group = group_of(scenery, items.numbers[0]);
    let end = scenery.frame.draw_of(items.numbers[0]).1.end;
    let numbers = &items.numbers[..items.count];
    let alike = |number: &u32| {
        (group.base..end).contains(number)
            && (group.draw.uniform.is_some()
                || group.draw.pipeline_of(number - group.base) == group.pipeline)
    };
    numbers.iter().all(alike).then_some(group)
}
