//! The paths of pictures in f32 besides lists.

use super::context::Group;
use super::full_blocks::{Blocks, Canvas};
use super::interpolated::ShadingNumber;
use super::runs::Runs;
use super::shader::Shader;

/// A number type for colouring tiles. The defaults are for f64, which colours all pixels from
/// lists: they handle nothing.
#[expect(unused_variables, reason = "the defaults read nothing")]
pub(crate) trait PathNumber: ShadingNumber {
    /// Colours fully covered blocks without a list of fragments, if their path allows it. Returns
    /// whether it did.
    fn blocks_in_one_pass(
        shader: &mut Shader<Self>,
        group: &Group<'_, Self>,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) -> bool {
        false
    }
    /// Lists a block of tiny triangles, to be coloured by [`Self::finish_tiny`]. Returns whether it
    /// did.
    fn wait_tiny(
        shader: &mut Shader<Self>,
        group: &Group<'_, Self>,
        block: (&Runs, [i32; 2]),
        to: (&mut Canvas<'_>, usize),
    ) -> bool {
        false
    }
    /// Colours the waiting blocks of tiny triangles.
    fn finish_tiny(shader: &mut Shader<Self>, group: &Group<'_, Self>, canvas: &mut Canvas<'_>) {}
}

impl PathNumber for f64 {}

impl PathNumber for f32 {
    fn blocks_in_one_pass(
        shader: &mut Shader<Self>,
        group: &Group<'_, Self>,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) -> bool {
        shader.blocks_in_one_pass(group, blocks, canvas)
    }

    fn wait_tiny(
        shader: &mut Shader<Self>,
        group: &Group<'_, Self>,
        block: (&Runs, [i32; 2]),
        to: (&mut Canvas<'_>, usize),
    ) -> bool {
        shader.wait_tiny(group, block, to)
    }

    fn finish_tiny(shader: &mut Shader<Self>, group: &Group<'_, Self>, canvas: &mut Canvas<'_>) {
        shader.finish_tiny(group, canvas);
    }
}
