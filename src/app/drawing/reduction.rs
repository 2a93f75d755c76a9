//! Reductions of quality, which make a picture quicker to draw.

use serde::{Deserialize, Serialize};

use marraztu_core::accuracy::{Bounces, Filter, LightAt, LightSamples, Samples, Settings};
use marraztu_core::base::image::Size;

/// The divisor of the sides of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shrink {
    /// Full size.
    #[default]
    Whole,
    /// By two: a quarter of the pixels.
    Half,
    /// By four: a sixteenth of the pixels.
    Quarter,
}

impl Shrink {
    const ALL: [Self; 3] = [Self::Whole, Self::Half, Self::Quarter];

    /// Returns the side, in pixels, of the square that shows one drawn pixel.
    pub const fn factor(self) -> usize {
        match self {
            Self::Whole => 1,
            Self::Half => 2,
            Self::Quarter => 4,
        }
    }
}

/// A reduction of quality, which makes a picture quicker to draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reduction {
    /// One sample per pixel rather than several.
    pub one_sample: bool,
    /// The nearest texel rather than a filtered one.
    pub nearest_texels: bool,
    /// Lighting per vertex rather than per pixel.
    pub vertex_light: bool,
    /// One ray to each light, none to the sky, and two bounces: into glass and out of it.
    pub few_rays: bool,
    /// Fewer pixels, each shown as a square.
    pub shrink: Shrink,
}

/// The number of combinations, including full quality.
pub(crate) const COUNT: usize = 48;

impl Reduction {
    /// Full quality.
    pub const NONE: Self = Self {
        one_sample: false,
        nearest_texels: false,
        vertex_light: false,
        few_rays: false,
        shrink: Shrink::Whole,
    };

    /// The reduction of a first picture that is followed by the full one.
    pub(crate) const PREVIEW: Self = Self { few_rays: true, ..Self::NONE };

    /// Reductions to try before any is measured, from the least to the greatest loss. Half size is
    /// also tried with lighting per pixel, since a mesh may have more vertices than the picture has
    /// pixels.
    pub(crate) const CHAIN: [Self; 6] = {
        let one = Self { one_sample: true, few_rays: true, ..Self::NONE };
        let nearest = Self { nearest_texels: true, ..one };
        let all = Self { vertex_light: true, ..nearest };
        [
            one,
            Self { vertex_light: true, ..one },
            all,
            Self { shrink: Shrink::Half, ..one },
            Self { shrink: Shrink::Half, ..all },
            Self { shrink: Shrink::Quarter, ..all },
        ]
    };

    /// Returns the reduction at a place from 0 to `COUNT` - 1.
    pub(crate) const fn at(place: usize) -> Self {
        Self {
            one_sample: place & 1 != 0,
            nearest_texels: place & 2 != 0,
            vertex_light: place & 4 != 0,
            few_rays: place & 8 != 0,
            shrink: Shrink::ALL[place / 16],
        }
    }

    /// Returns its place: one bit for each flag, and the shrink factor above them.
    pub(crate) fn place(self) -> usize {
        let Self { one_sample, nearest_texels, vertex_light, few_rays, shrink } = self;
        let bit = |on: bool, place: usize| usize::from(on) << place;
        let size = match shrink {
            Shrink::Whole => 0,
            Shrink::Half => 16,
            Shrink::Quarter => 32,
        };
        let flags = [one_sample, nearest_texels, vertex_light, few_rays];
        flags.into_iter().zip(0..).map(|(on, place)| bit(on, place)).sum::<usize>() + size
    }

    /// Applies the reduction to the settings and the size of a picture.
    pub(crate) fn applied(self, settings: Settings, size: Size) -> (Settings, Size) {
        let light = match settings.light {
            LightAt::Pixel | LightAt::Sample if self.vertex_light => LightAt::Vertex,
            light => light,
        };
        let filter = if self.nearest_texels { Filter::Nearest } else { settings.filter };
        let samples = if self.one_sample { Samples::One } else { settings.samples };
        let light_samples = if self.few_rays { LightSamples::One } else { settings.light_samples };
        let bounces = match settings.bounces {
            Bounces::Four | Bounces::Eight if self.few_rays => Bounces::Two,
            bounces => bounces,
        };
        let side = |pixels: usize| pixels.div_ceil(self.shrink.factor());
        let size = Size::new(side(size.width), side(size.height));
        (Settings { light, filter, samples, light_samples, bounces, ..settings }, size)
    }

    /// Describes the reduction: "light per vertex, half size". Empty at full quality.
    pub fn words(self) -> String {
        let words = [
            (self.one_sample, "one sample"),
            (self.vertex_light, "light per vertex"),
            (self.nearest_texels, "nearest texels"),
            (self.few_rays, "few rays"),
            (self.shrink == Shrink::Half, "half size"),
            (self.shrink == Shrink::Quarter, "quarter size"),
        ];
        let words: Vec<&str> = words.iter().filter(|(on, _)| *on).map(|(_, word)| *word).collect();
        words.join(", ")
    }
}

/// The properties of a picture that decide which reductions have an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Applicable {
    pub(crate) settings: Settings,
    /// Whether any texture is shown.
    pub(crate) textured: bool,
    /// Whether any light has an extent, or any surface mirrors or refracts.
    pub(crate) casts_rays: bool,
}

impl Applicable {
    /// Removes the parts of a reduction that have no effect on this picture.
    pub(crate) fn limited(self, reduction: Reduction) -> Reduction {
        let Settings { light, filter, samples, light_samples, bounces, .. } = self.settings;
        let has_few = light_samples == LightSamples::One
            && matches!(bounces, Bounces::None | Bounces::One | Bounces::Two);
        Reduction {
            one_sample: reduction.one_sample && samples != Samples::One,
            vertex_light: reduction.vertex_light
                && matches!(light, LightAt::Pixel | LightAt::Sample),
            nearest_texels: reduction.nearest_texels && self.textured && filter != Filter::Nearest,
            few_rays: reduction.few_rays && self.casts_rays && !has_few,
            shrink: reduction.shrink,
        }
    }

    /// Lists all reductions that make a difference to this picture, without full quality.
    pub(crate) fn reductions(self) -> impl Iterator<Item = Reduction> {
        (1..COUNT).map(Reduction::at).filter(move |one| self.limited(*one) == *one)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_reduction_has_a_unique_place() {
        for place in 0..COUNT {
            assert_eq!(Reduction::at(place).place(), place);
        }
        assert_eq!(Reduction::at(0), Reduction::NONE);
    }

    #[test]
    fn nothing_is_reduced_that_the_picture_does_not_have() {
        let settings = Settings::default();
        let count = |settings, textured| {
            Applicable { settings, textured, casts_rays: false }.reductions().count()
        };
        assert_eq!(count(settings, false), 5, "light and size");
        assert_eq!(count(settings, true), 11);
        let sampled = Settings { samples: Samples::Four, ..settings };
        assert_eq!(count(sampled, true), 23);
        let with_rays = Applicable { settings, textured: false, casts_rays: true };
        assert_eq!(with_rays.reductions().count(), 11);
        let (few, _) = Reduction::PREVIEW.applied(settings, Size::new(8, 8));
        assert_eq!((few.light_samples, few.bounces), (LightSamples::One, Bounces::Two));
        let limited = Applicable { settings: few, ..with_rays }.limited(Reduction::PREVIEW);
        assert_eq!(limited, Reduction::NONE, "nothing is left to reduce");
        let flat = Settings { light: LightAt::Face, ..settings };
        assert_eq!(count(flat, false), 2, "size alone");
        let all = Reduction::CHAIN[5];
        let (applied, size) = all.applied(flat, Size::new(801, 600));
        assert_eq!((applied.light, size), (LightAt::Face, Size::new(201, 150)));
        assert_eq!(
            all.words(),
            "one sample, light per vertex, nearest texels, few rays, quarter size"
        );
    }
}
