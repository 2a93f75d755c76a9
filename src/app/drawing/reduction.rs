//! What can be reduced in a picture so that it is drawn sooner.

use marraztu_core::accuracy::{Filter, LightAt, Samples, Settings};
use marraztu_core::base::image::Size;

/// By how much the sides of a picture are divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shrink {
    /// Not at all.
    #[default]
    Whole,
    /// By two: a quarter of the pixels.
    Half,
    /// By four: a sixteenth of the pixels.
    Quarter,
}

impl Shrink {
    /// All of them.
    const ALL: [Self; 3] = [Self::Whole, Self::Half, Self::Quarter];

    /// The side in pixels of the square that a drawn pixel is shown as.
    #[must_use]
    pub const fn factor(self) -> usize {
        match self {
            Self::Whole => 1,
            Self::Half => 2,
            Self::Quarter => 4,
        }
    }
}

/// What is reduced in a picture so that it is drawn sooner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reduction {
    /// One sample per pixel rather than several.
    pub one_sample: bool,
    /// The nearest texel rather than a mean.
    pub nearest_texels: bool,
    /// Light at vertices rather than at pixels.
    pub vertex_light: bool,
    /// Fewer pixels, each shown as a square.
    pub shrink: Shrink,
}

/// The number of reductions, full quality among them.
pub(crate) const COUNT: usize = 24;

impl Reduction {
    /// Full quality.
    pub const NONE: Self = Self {
        one_sample: false,
        nearest_texels: false,
        vertex_light: false,
        shrink: Shrink::Whole,
    };

    /// Reductions to try before any is measured, from the least to the greatest loss. Half size
    /// also comes with light at pixels, since a mesh may have more vertices than the picture has
    /// pixels.
    pub(crate) const CHAIN: [Self; 6] = {
        let one = Self { one_sample: true, ..Self::NONE };
        let nearest = Self { one_sample: true, nearest_texels: true, ..Self::NONE };
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

    /// The reduction at this place of all.
    pub(crate) const fn at(place: usize) -> Self {
        Self {
            one_sample: place & 1 != 0,
            nearest_texels: place & 2 != 0,
            vertex_light: place & 4 != 0,
            shrink: Shrink::ALL[place / 8],
        }
    }

    /// Its place among all.
    pub(crate) fn place(self) -> usize {
        let Self { one_sample, nearest_texels, vertex_light, shrink } = self;
        let bit = |on: bool, place: usize| usize::from(on) << place;
        let size = match shrink {
            Shrink::Whole => 0,
            Shrink::Half => 8,
            Shrink::Quarter => 16,
        };
        bit(one_sample, 0) + bit(nearest_texels, 1) + bit(vertex_light, 2) + size
    }

    /// Settings and size of the picture.
    pub(crate) fn applied(self, settings: Settings, size: Size) -> (Settings, Size) {
        let light = match settings.light {
            LightAt::Pixel | LightAt::Sample if self.vertex_light => LightAt::Vertex,
            light => light,
        };
        let filter = if self.nearest_texels { Filter::Nearest } else { settings.filter };
        let samples = if self.one_sample { Samples::One } else { settings.samples };
        let side = |pixels: usize| pixels.div_ceil(self.shrink.factor());
        let size = Size::new(side(size.width), side(size.height));
        (Settings { light, filter, samples, ..settings }, size)
    }

    /// In words: "light per vertex, half size". Empty at full quality.
    #[must_use]
    pub fn words(self) -> String {
        let words = [
            (self.one_sample, "one sample"),
            (self.vertex_light, "light per vertex"),
            (self.nearest_texels, "nearest texels"),
            (self.shrink == Shrink::Half, "half size"),
            (self.shrink == Shrink::Quarter, "quarter size"),
        ];
        let words: Vec<&str> = words.iter().filter(|(on, _)| *on).map(|(_, word)| *word).collect();
        words.join(", ")
    }
}

/// What can be reduced in this picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Applicable {
    pub(crate) settings: Settings,
    /// Whether any texture is shown.
    pub(crate) textured: bool,
}

impl Applicable {
    /// The part of a reduction that applies.
    pub(crate) fn limited(self, reduction: Reduction) -> Reduction {
        let Settings { light, filter, samples, .. } = self.settings;
        Reduction {
            one_sample: reduction.one_sample && samples != Samples::One,
            vertex_light: reduction.vertex_light
                && matches!(light, LightAt::Pixel | LightAt::Sample),
            nearest_texels: reduction.nearest_texels && self.textured && filter != Filter::Nearest,
            shrink: reduction.shrink,
        }
    }

    /// All reductions of this picture but full quality.
    pub(crate) fn reductions(self) -> impl Iterator<Item = Reduction> {
        (1..COUNT).map(Reduction::at).filter(move |one| self.limited(*one) == *one)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_reduction_has_a_place_of_its_own() {
        for place in 0..COUNT {
            assert_eq!(Reduction::at(place).place(), place);
        }
        assert_eq!(Reduction::at(0), Reduction::NONE);
    }

    #[test]
    fn nothing_is_reduced_that_the_picture_does_not_have() {
        let settings = Settings::default();
        let count = |settings, textured| Applicable { settings, textured }.reductions().count();
        assert_eq!(count(settings, false), 5, "light and size");
        assert_eq!(count(settings, true), 11);
        let sampled = Settings { samples: Samples::Four, ..settings };
        assert_eq!(count(sampled, true), 23);
        let flat = Settings { light: LightAt::Face, ..settings };
        assert_eq!(count(flat, false), 2, "size alone");
        let all = Reduction::CHAIN[5];
        let (applied, size) = all.applied(flat, Size::new(801, 600));
        assert_eq!((applied.light, size), (LightAt::Face, Size::new(201, 150)));
        assert_eq!(all.words(), "one sample, light per vertex, nearest texels, quarter size");
    }
}
