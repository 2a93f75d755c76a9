//! Decides how a surface covers the surfaces behind it: opaque, with holes, transparent, or not
//! drawn.

use marraztu_core::accuracy::Transparency;
use marraztu_core::scene::{MapKind, PartLook};

/// The way a part of an object covers the surfaces behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cover {
    /// Not drawn: it is too transparent.
    Nothing,
    /// Opaque at points where its texture's alpha, multiplied by this opacity, is at least one
    /// half.
    Threshold(f64),
    /// Transparent: this opacity, multiplied by the texture's alpha and the opacity map.
    Transparent(f64),
}

impl Cover {
    /// Returns the cover of a part.
    ///
    /// If all texels of a texture, or of an opacity map, are fully opaque or fully transparent, it
    /// is a stencil on a part of opacity 1: it cuts holes, as with [`Transparency::Threshold`],
    /// regardless of how its edges are filtered.
    pub(super) fn of(look: &PartLook<'_>, textured: bool, transparency: Transparency) -> Self {
        // NaN counts as opaque.
        let opacity = if look.opacity < 1.0 { look.opacity.max(0.0) } else { 1.0 };
        let texture = look.texture.filter(|_| textured);
        let map = look.map(MapKind::Opacity).filter(|_| textured);
        // Partial alpha needs blending; alphas of 0 and 1 only cut holes.
        let fades = texture.is_some_and(|texture| texture.picture.has_partial_alpha())
            || map.is_some_and(|map| map.texture.picture.fades());
        match transparency {
            // No texel can raise the product to one half.
            Transparency::Threshold if opacity < 0.5 => Self::Nothing,
            Transparency::Threshold => Self::Threshold(opacity),
            Transparency::Objects | Transparency::Exact => {
                if opacity == 0.0 {
                    Self::Nothing
                } else if opacity < 1.0 || fades {
                    Self::Transparent(opacity)
                } else {
                    Self::Threshold(opacity)
                }
            }
        }
    }
}
