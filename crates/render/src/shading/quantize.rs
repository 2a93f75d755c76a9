//! Combines light with the surface colour, and converts colours to bytes.

use super::colors::{Colors, Form};
use crate::lights::{Batch, Rows, load, set};
use crate::simd::{BATCH, Encoding, Kernel, Lanes, Number, Vec3};

/// The surface colour t: one tint, or a texel for each pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SurfaceColor<'a, T> {
    Tint([T; 3]),
    Texels(&'a Rows<T>),
}

impl<T: Number> SurfaceColor<'_, T> {
    #[inline(always)]
    pub(crate) fn at<M: Lanes<Number = T>>(self, lanes: M, at: usize) -> Vec3<M::R> {
        match self {
            Self::Tint(tint) => set(lanes, tint),
            Self::Texels(texels) => load(lanes, texels, at),
        }
    }
}

/// Converts colours to bytes: t D + S + e if the surface is lit, else t + e, with diffuse light D,
/// specular light S and emitted light e; encoded if they are linear. Only `FINISHES` adds e and
/// encodes: most surfaces need a smaller kernel.
pub(crate) struct Quantize<'a, T, const FINISHES: bool> {
    pub(crate) batch: &'a Batch<T>,
    pub(crate) lit: bool,
    pub(crate) own: SurfaceColor<'a, T>,
    /// The emitted light e.
    pub(crate) glow: Option<&'a Rows<T>>,
    /// The rounding threshold of each pixel, if it is not one half.
    pub(crate) thresholds: Option<&'a [T; BATCH]>,
    /// The encoding, if colours are linear.
    pub(crate) encoding: Option<&'a Encoding>,
    pub(crate) colors: &'a mut Colors,
}

impl<T: Number, const FINISHES: bool> Kernel<T> for Quantize<'_, T, FINISHES> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { batch, lit, own, glow, mut thresholds, encoding, colors } = self;
        // Linear values are rounded later, when they are summed and encoded.
        if FINISHES && encoding.is_some() && colors.form == Form::Parts {
            thresholds = None;
        }
        for at in (0..batch.len).step_by(M::LANES) {
            let mut color = own.at(lanes, at);
            if lit {
                color = reflected(lanes, color, batch, at);
            }
            if FINISHES && let Some(glow) = glow {
                color = color.plus(load(lanes, glow, at));
            }
            if FINISHES
                && let Some(encoding) = encoding
                && colors.form == Form::Pixels
            {
                let Vec3([r, g, b]) = color;
                color = Vec3([encoding.of(r), encoding.of(g), encoding.of(b)]);
            }
            match thresholds {
                None => colors.store(lanes, color, at),
                Some(thresholds) => {
                    colors.store_by(lanes, color, lanes.load(thresholds, at), at);
                }
            }
        }
    }
}

/// Computes t D + S at some pixels.
#[inline(always)]
pub(crate) fn reflected<M: Lanes>(
    lanes: M,
    Vec3([tr, tg, tb]): Vec3<M::R>,
    batch: &Batch<M::Number>,
    at: usize,
) -> Vec3<M::R> {
    let Vec3([r, g, b]) = load(lanes, &batch.diffuse, at);
    let specular = load(lanes, &batch.specular, at);
    Vec3([tr * r, tg * g, tb * b]).plus(specular)
}
