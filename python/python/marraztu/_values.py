"""Materials, lights, colours and the axes of accuracy."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Sequence
from os import PathLike
from typing import Any, NamedTuple

from . import _marraztu

Triple = tuple[float, float, float]
"""Three numbers: a point, a direction, or red, green and blue."""


def bytes_of(color: Sequence[int] | str) -> tuple[int, int, int]:
    """Checks a colour: three bytes, "#rrggbb" or "#rgb"."""
    try:
        if isinstance(color, str):
            if not re.fullmatch("#([0-9a-fA-F]{3}){1,2}", color):
                raise ValueError
            digits = color[1:] if len(color) == 7 else "".join(2 * digit for digit in color[1:])
            color = bytes.fromhex(digits)
        red, green, blue = (operator.index(channel) for channel in color)
    except (TypeError, ValueError):
        wrong = f'a colour is three bytes, "#rrggbb" or "#rgb", not {color!r}'
        raise ValueError(wrong) from None
    if not all(0 <= channel <= 255 for channel in (red, green, blue)):
        raise ValueError(f"the channels of a colour are from 0 to 255, not {color!r}")
    return red, green, blue


def triple_of(values: Sequence[float], what: str) -> Triple:
    """Checks a point, a direction or factors."""
    try:
        x, y, z = (float(value) for value in values)
    except (TypeError, ValueError):
        raise ValueError(f"{what}: three numbers are needed, not {values!r}") from None
    return x, y, z


# The properties of a node that stay as they are.
UNCHANGED: dict[str, object] = dict.fromkeys(
    ("name", "visible", "pose", "material", "opacity", "sides")
)


def material_of(material: Any) -> Material | str | None:
    """Checks a material, or the name of one."""
    if material is None or isinstance(material, str):
        return material
    if not isinstance(material, Material):
        raise TypeError(f"a material is a Material or a name, not {type(material).__name__}")
    return Material(
        diffuse=triple_of(material.diffuse, "diffuse"),
        ambient=triple_of(material.ambient, "ambient"),
        specular=triple_of(material.specular, "specular"),
        exponent=float(material.exponent),
        emission=triple_of(material.emission, "emission"),
        reflection=str(material.reflection),
        transmission=triple_of(material.transmission, "transmission"),
        ior=float(material.ior),
    )


def tuples(values: dict[str, Any]) -> dict[str, Any]:
    """Converts arrays of the kernel to tuples: bytes arrive as bytes, other arrays as lists."""
    arrays = (bytes, list)
    return {
        key: tuple(value) if isinstance(value, arrays) else value for key, value in values.items()
    }


class Material(NamedTuple):
    """A material of Phong's model: factors from 0 to 1, and the exponent of the highlight.

    `Material.named("gold")` is one of 19 materials; wherever a material is expected, its name may
    be given instead.
    """

    diffuse: Triple = (0.8, 0.8, 0.8)
    """The fraction of a light that is reflected diffusely: Kd."""
    ambient: Triple = (0.2, 0.2, 0.2)
    """The fraction of ambient light that is reflected: Ka."""
    specular: Triple = (0.0, 0.0, 0.0)
    """The fraction of a light that is reflected specularly: Ks."""
    exponent: float = 32.0
    """The exponent of the highlight: Ns, at least 0."""
    emission: Triple = (0.0, 0.0, 0.0)
    """The emitted light: Ke, at least 0."""
    reflection: str = "none"
    """How the surroundings are mirrored: none, constant (Ks) or fresnel."""
    transmission: Triple = (0.0, 0.0, 0.0)
    """The fraction of light that passes through the surface: Tf."""
    ior: float = 1.0
    """The index of refraction: Ni, from 0.1 to 10."""

    @classmethod
    def named(cls, name: str) -> Material:
        """Returns a material by its name."""
        for other, values in _marraztu.materials():
            if other == name:
                return cls(**tuples(values))
        raise ValueError(f"there is no material {name!r}; write {', '.join(cls.names())}")

    @staticmethod
    def names() -> list[str]:
        """Lists the names of materials."""
        return [name for name, _ in _marraztu.materials()]


class Light(NamedTuple):
    """A light. Build one with `ambient`, `sky`, `sun`, `bulb` or `spot`."""

    kind: str
    """ambient, sky, sun, bulb or spot."""
    name: str = ""
    color: tuple[int, int, int] = (255, 255, 255)
    shadows: bool = False
    """Whether objects cast shadows in this light."""
    size: float = 0.0
    """With shadows, the extent of the light, which makes them soft: the radius of a bulb or
    spot, or the angular diameter of a sun in radians."""
    ground: tuple[int, int, int] = (0, 0, 0)
    """Of a sky: the colour below the horizon, without a panorama."""
    position: Triple | None = None
    direction: Triple | None = None
    """The direction in which the light travels."""
    angle: float = 0.0
    """Of a spot: radians from the axis to the edge of the cone, at most pi / 2."""
    exponent: float = 0.0
    """Of a spot: the concentration of the light along the axis."""
    attenuation: Triple = (1.0, 0.0, 0.0)
    """(c, l, q): light is divided by c + l d + q d^2 at the distance d."""
    panorama: str | PathLike[str] | None = None
    """Of a sky: the file of a picture of everything around, as HDR, EXR, PNG or JPEG.

    It is read when lights are set, unless a light of the scene has read it before."""
    turn: float = 0.0
    """The angle by which a panorama is turned about Y, in radians, anticlockwise from above."""
    shown: bool = True
    """Whether a panorama is the background; mirrors show it in any case."""

    @classmethod
    def ambient(cls, color: Sequence[int] | str = (255, 255, 255)) -> Light:
        """Light from everywhere."""
        return cls("ambient", "ambient", bytes_of(color))

    @classmethod
    def sky(
        cls,
        color: Sequence[int] | str = (255, 255, 255),
        ground: Sequence[int] | str = (92, 84, 76),
        *,
        panorama: str | PathLike[str] | None = None,
        turn: float = 0.0,
        shown: bool = True,
        shadows: bool = False,
    ) -> Light:
        """Light from the sky above and the ground below; with shadows, surfaces hide it.

        A panorama takes the place of the two colours, and is multiplied by `color`.
        """
        return cls(
            "sky",
            "sky",
            bytes_of(color),
            shadows,
            ground=bytes_of(ground),
            panorama=panorama,
            turn=float(turn),
            shown=shown,
        )

    @classmethod
    def sun(
        cls,
        direction: Sequence[float],
        color: Sequence[int] | str = (255, 255, 255),
        *,
        shadows: bool = False,
        size: float = 0.0,
    ) -> Light:
        """Light from infinitely far away. `direction` is the direction in which it travels."""
        towards = triple_of(direction, "direction")
        return cls("sun", "sun", bytes_of(color), shadows, float(size), direction=towards)

    @classmethod
    def bulb(
        cls,
        position: Sequence[float],
        color: Sequence[int] | str = (255, 255, 255),
        *,
        attenuation: Sequence[float] = (1.0, 0.0, 0.0),
        shadows: bool = False,
        size: float = 0.0,
    ) -> Light:
        """Light from a point in all directions."""
        return cls(
            "bulb",
            "bulb",
            bytes_of(color),
            shadows,
            float(size),
            position=triple_of(position, "position"),
            attenuation=triple_of(attenuation, "attenuation"),
        )

    @classmethod
    def spot(
        cls,
        position: Sequence[float] | None = None,
        direction: Sequence[float] | None = None,
        color: Sequence[int] | str = (255, 255, 255),
        *,
        angle: float = math.pi / 8,
        exponent: float = 5.0,
        attenuation: Sequence[float] = (1.0, 0.0, 0.0),
        shadows: bool = False,
        size: float = 0.0,
    ) -> Light:
        """Light from a point within a cone. Without position and direction, the camera holds it."""
        return cls(
            "spot",
            "spot",
            bytes_of(color),
            shadows,
            float(size),
            position=None if position is None else triple_of(position, "position"),
            direction=None if direction is None else triple_of(direction, "direction"),
            angle=angle,
            exponent=exponent,
            attenuation=triple_of(attenuation, "attenuation"),
        )


class Axis(NamedTuple):
    """A decision between exact and fast."""

    name: str
    """The argument of `Scene.render`: "samples", "filter"."""
    what: str
    """The purpose: "How a texture is filtered between its texels"."""
    choices: tuple[str, ...]
    """The choices, from the coarse to the exact if they can be ranked."""


def axes() -> list[Axis]:
    """Lists the axes of accuracy, which are arguments of `Scene.render`."""
    return [
        Axis(key.replace("-", "_"), what, tuple(choices)) for key, what, choices in _marraztu.axes()
    ]
