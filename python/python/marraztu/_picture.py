"""Pictures: arrays of pixels, with the camera that they show."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from . import _marraztu
from ._camera import Camera

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._shot import Shot


class Picture:
    """A picture with its layers, as arrays in rows from the top.

    Layers show the surface at the centre of each pixel, for any number of samples. A transparent
    surface counts like an opaque one. Lengths are in units of the models, times `Scene.unit`. The
    arrays are memory of the renderer, not copies. For a picture of h rows and w columns:

        rgba      uint8    (h, w, 4)  red, green, blue, and alpha: 255 unless `transparent` is set
        color     uint8    (h, w, 3)  a view of `rgba`; `numpy.ascontiguousarray` closes its gaps
        depth     float32  (h, w)     the distance along the camera's axis; background: inf
        distance  float32  (h, w)     the distance along the ray; background: inf
        normal    float32  (h, w, 3)  the unit normal, in the space that `normals` names: the
                                      camera's x points to the right, y up, z towards the camera
        position  float32  (h, w, 3)  the position in the world
        uv        float32  (h, w, 2)  the texture coordinates, (0, 0) at the lower left
        object    int32    (h, w)     the id of the node: see `names`
        part      int32    (h, w)     the part of a file, from 1: see `part_names`
        material  int32    (h, w)     the material, from 1: see `material_names`
        polygon   int32    (h, w)     the polygon of the node, from 1
        mask      bool     (h, w)     whether the pixel shows a node

    Where nothing is said, the background is 0. Arrays exist for the layers that were asked for.
    """

    rgba: NDArray[np.uint8]
    color: NDArray[np.uint8]
    depth: NDArray[np.float32]
    distance: NDArray[np.float32]
    normal: NDArray[np.float32]
    position: NDArray[np.float32]
    uv: NDArray[np.float32]
    object: NDArray[np.int32]
    part: NDArray[np.int32]
    material: NDArray[np.int32]
    polygon: NDArray[np.int32]
    mask: NDArray[np.bool_]

    def __init__(self, shot: Shot, arrays: dict[str, Any]) -> None:
        self.shot = shot
        """The snapshot that the picture shows."""
        self.layers = shot.layers
        """The names of the layers."""
        if "color" in arrays:
            self.rgba = arrays.pop("color")
            self.color = self.rgba[..., :3]
        for name, array in arrays.items():
            if name in ("depth", "distance", "position") and shot.unit != 1:
                array *= shot.unit
            setattr(self, name, array.view("?") if name == "mask" else array)

    if not TYPE_CHECKING:
        # Type checkers find misspelt layers without it.
        def __getattr__(self, name):
            if name in Picture.__annotations__:
                raise AttributeError(f"the picture has no {name}: name the layer in layers=")
            raise AttributeError(f"a picture has no attribute {name!r}")

    @property
    def width(self) -> int:
        """The width in pixels."""
        return self.shot.width

    @property
    def height(self) -> int:
        """The height in pixels."""
        return self.shot.height

    @property
    def camera(self) -> Camera:
        """The camera that the picture shows, with `K` and `pose()`."""
        return Camera(*self.shot._shot.camera)

    @property
    def names(self) -> dict[int, str]:
        """The names of nodes by their id in `object`."""
        return self.shot._shot.names

    @property
    def part_names(self) -> dict[int, str]:
        """The names of parts by their number in `part`."""
        return self.shot._shot.part_names

    @property
    def material_names(self) -> dict[int, str]:
        """The names of materials by their number in `material`."""
        return self.shot._shot.material_names

    def pil(self) -> Any:
        """Returns the colours as a picture of PIL: RGB, or RGBA if `transparent` is set."""
        from PIL import Image

        return Image.fromarray(self.rgba if self.shot.transparent else self.color)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Saves the colours as .png, .jpg, .webp or .ppm, or all layers as .npz.

        Pictures have the same bytes as those of `marraztu render`. A file that is not a picture is
        never overwritten by one.
        """
        path = os.fspath(path)
        if path.lower().endswith((".exr", ".npy")):
            raise ValueError(f"{path}: name a picture, or .npz for the arrays of all layers")
        if "color" not in self.layers and not path.lower().endswith(".npz"):
            raise ValueError("the picture has no colours to save: name color in layers=")
        if path.lower().endswith(".npz"):
            import numpy as np

            # NumPy would append .npz to a name that ends in .NPZ.
            with open(path, "wb") as file:
                np.savez(file, **{name: getattr(self, name) for name in self.layers})
        else:
            _marraztu.save_picture(path, self.rgba)

    def _repr_png_(self) -> bytes | None:
        return _marraztu.png(self.rgba) if "color" in self.layers else None

    def __repr__(self) -> str:
        return f"<Picture of {self.width} x {self.height} pixels: {', '.join(self.layers)}>"
