//! From light and the colour of the surface itself to bytes.

use super::colors::Colors;
use crate::render::effects::{Batch, Light, Rows, load, set};
use crate::render::numbers::real::{Kernel, Machine, Number, Triple};

/// The colour t of the surface itself: one, or one for each pixel.
#[derive(Clone, Copy, Debug)]
pub(in crate::render) enum Own<'a, T> {
    Tint([T; 3]),
    Texels(&'a Rows<T>),
}

impl<T: Number> Own<'_, T> {
    #[inline(always)]
    pub(in crate::render) fn at<M: Machine<Number = T>>(
        self,
        machine: M,
        at: usize,
    ) -> Triple<M::R> {
        match self {
            Self::Tint(tint) => set(machine, tint),
            Self::Texels(texels) => load(machine, texels, at),
        }
    }
}

/// Makes bytes of colours: t D + S where it is lit, with D and S the two kinds of light, else t.
pub(super) struct Finish<'a, T> {
    pub(super) batch: &'a Batch<T>,
    pub(super) lit: bool,
    pub(super) own: Own<'a, T>,
    pub(super) colors: &'a mut Colors,
}

impl<T: Light> Kernel<T> for Finish<'_, T> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { batch, lit, own, colors } = self;
        for at in (0..batch.len).step_by(M::LANES) {
            let mut color = own.at(machine, at);
            if lit {
                color = reflected(machine, color, batch, at);
            }
            colors.store(machine, color, at);
        }
    }
}

/// t D + S at some places.
#[inline(always)]
pub(super) fn reflected<M: Machine>(
    machine: M,
    Triple([tr, tg, tb]): Triple<M::R>,
    batch: &Batch<M::Number>,
    at: usize,
) -> Triple<M::R> {
    let Triple([r, g, b]) = load(machine, &batch.diffuse, at);
    let specular = load(machine, &batch.specular, at);
    Triple([tr * r, tg * g, tb * b]).plus(specular)
}
