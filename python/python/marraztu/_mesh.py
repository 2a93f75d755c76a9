"""Meshes from files, arrays and trimesh."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from . import _marraztu
from ._values import UNCHANGED, Material, material_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

CREASE = math.radians(60)
"""Edges between faces are smooth below this angle, unless the mesh has normals."""


MOST_SHOWN = 5
"""The most findings in the text of a warning."""


class FindingWarning(UserWarning):
    """Something in a file was repaired, left out or odd.

    `warnings.simplefilter("ignore", marraztu.FindingWarning)` silences these warnings.
    """


def warn_of(findings: list[str]) -> None:
    """Warns once of all findings, at the caller of the public function."""
    lines = findings[:MOST_SHOWN]
    if len(findings) > MOST_SHOWN:
        lines.append(f"and {len(findings) - MOST_SHOWN} more: see findings")
    if lines:
        warnings.warn("\n".join(lines), FindingWarning, stacklevel=3)


class Mesh:
    """A shape with its materials. It never changes, and scenes and threads may share it.

    `vertices` has the shape (n, 3). `faces` has the shape (m, 3), or (m, 4) and so on, or is a list
    of polygons of any size; its numbers are vertices from 0, counter-clockwise seen from the front.
    The other arrays have a row per vertex: `normals` (n, 3), `uv` (n, 2) with (0, 0) at the lower
    left of the texture, and `colors` (n, 3) or (n, 4), which are integers from 0 to 255 or floats
    from 0 to 1; alpha is ignored. `texture` is a picture file, an array of bytes (height, width, 3
    or 4), or a picture of PIL. `material` is a `Material` or the name of one. Without normals,
    edges between faces are smooth below the angle `crease` in radians; 0 gives flat faces.
    """

    __slots__ = ("_mesh",)

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike | Sequence[Sequence[int]],
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        texture: Any = None,
        material: Material | str | None = None,
        crease: float = CREASE,
        name: str = "mesh",
    ) -> None:
        import numpy as np

        if vertices is None:
            raise ValueError("vertices needs the shape (n, 3), not None")
        positions = _array(vertices, np.float64, None, 3, "vertices")
        count = len(positions)
        corners, arities = _polygons(faces, count)
        arrays = {
            "name": name,
            "vertices": positions,
            "corners": corners,
            "arities": arities,
            "normals": _array(normals, np.float32, count, 3, "normals"),
            "uvs": _array(uv, np.float32, count, 2, "uv"),
            "colors": None if colors is None else _factors(colors, count),
            "texture": None if texture is None else pixels_of(texture),
            "material": material_of(material),
            "crease": crease,
        }
        self._mesh = _marraztu.Mesh.from_arrays(arrays)

    @classmethod
    def _wrap(cls, kernel: _marraztu.Mesh) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._mesh = kernel
        return mesh

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles the mesh by the name of its file, which the other process reads again. Raises
        `ValueError` for a mesh of arrays."""
        scene = _marraztu.Scene()
        scene.add(self._mesh, None, UNCHANGED)
        return Mesh._restored, scene.dump()

    @classmethod
    def _restored(cls, text: Any, is_lit: bool, is_file: bool) -> Mesh:
        scene = _marraztu.Scene.restore(text, is_lit, is_file)
        return cls._wrap(scene.mesh(scene.objects()[0][0]))

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        *,
        up: str | None = None,
        scale: float = 1.0,
        flip_winding: bool = False,
        crease: float | None = None,
        bump_maps: str = "auto",
    ) -> Mesh:
        """Loads an .obj, .obj.gz or .stl file, with its MTL files and textures.

        `up` is the axis of the file that points up: x, y, z, -x, -y or -z; by default the axis
        stated in its comments, z for STL, or y. `crease` is in radians, and used if the file has
        neither normals nor smoothing groups; by default `CREASE`, and 0 for STL. Repairs are in
        `findings`, and in a warning (`FindingWarning`).

        Raises `LoadError` with `file`, `line` and `reason`.
        """
        if os.fspath(path).lower().endswith(".marraztu"):
            raise ValueError(f"{path} is a scene: use Scene.load")
        reading = {
            "up": up,
            "scale": scale,
            "flip_winding": flip_winding,
            "crease": crease,
            "bump_maps": bump_maps,
        }
        mesh = cls._wrap(_marraztu.Mesh.load(os.fspath(path), reading))
        warn_of(mesh.findings)
        return mesh

    @classmethod
    def from_trimesh(cls, mesh: Any, *, name: str | None = None, crease: float = CREASE) -> Mesh:
        """Converts a `trimesh.Trimesh`, with its texture, or the colours of its vertices or faces.

        Vertices between faces of different colours are split, so these edges are sharp.
        """
        if not (hasattr(mesh, "faces") and hasattr(mesh, "visual")):
            kind = type(mesh).__name__
            hint = ": use its method to_mesh" if hasattr(mesh, "to_mesh") else ""
            raise TypeError(f"from_trimesh converts a trimesh.Trimesh, not a {kind}{hint}")
        visual, vertices, faces = mesh.visual, mesh.vertices, mesh.faces
        arrays: dict[str, Any] = {}
        uv = getattr(visual, "uv", None)
        if uv is not None:
            arrays["uv"] = uv
            material = getattr(visual, "material", None)
            # Names of trimesh's SimpleMaterial and PBRMaterial.
            image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
            if image is not None:
                arrays["texture"] = image
        elif getattr(visual, "kind", None) == "vertex":
            arrays["colors"] = visual.vertex_colors
        elif getattr(visual, "kind", None) == "face":
            vertices, faces, arrays["colors"] = _split(vertices, faces, visual.face_colors)
        name = name or mesh.metadata.get("name") or "mesh"
        return cls(vertices, faces, name=name, crease=crease, **arrays)

    @property
    def name(self) -> str:
        """The name of the file without its ending, or the given name."""
        return self._mesh.name

    @property
    def findings(self) -> list[str]:
        """Everything that was repaired, left out or odd in the file."""
        return self._mesh.findings

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The positions of the vertices, (n, 3)."""
        return self._mesh.vertices()

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """The vertices of each triangle, (n, 3)."""
        return self._mesh.triangles()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The smallest and the largest corner of the bounding box, (2, 3)."""
        import numpy as np

        if self._mesh.bounds is None:
            raise ValueError("the mesh has no vertices")
        return np.array(self._mesh.bounds)

    def __repr__(self) -> str:
        return f"<Mesh {self.name!r} of {self._mesh.polygons} polygons>"


def _array(values: ArrayLike | None, dtype: type, rows: int | None, columns: int, what: str) -> Any:
    """Converts values to a contiguous array of the kernel."""
    import numpy as np

    if values is None:
        return None
    array: NDArray[Any] = np.ascontiguousarray(values, dtype)
    if array.ndim != 2 or array.shape[1] != columns or rows not in (None, len(array)):
        shape = f"({'n' if rows is None else rows}, {columns})"
        raise ValueError(f"{what} needs the shape {shape}, not {array.shape}")
    return array


def _factors(colors: ArrayLike, count: int) -> Any:
    """Converts the colours of vertices to factors."""
    import numpy as np

    array = np.asarray(colors)
    if array.dtype.kind not in "biuf":
        raise ValueError(f"colors are numbers, not {array.dtype}")
    most = 255 if array.dtype.kind in "iu" else 1
    if array.ndim == 2 and array.shape[1] == 4:
        array = array[:, :3]
    if array.size and not 0 <= array.min() <= array.max() <= most:
        allowed = "integers from 0 to 255" if most == 255 else "floats from 0 to 1"
        raise ValueError(f"colors are {allowed}, not from {array.min()} to {array.max()}")
    return _array(array / most, np.float32, count, 3, "colors")


def _split(vertices: Any, faces: Any, colors: Any) -> tuple[Any, Any, Any]:
    """Splits vertices between faces of different colours. Returns a colour for each vertex."""
    import numpy as np

    rows = np.column_stack([np.ravel(faces), np.repeat(colors, 3, axis=0)])
    unique, corners = np.unique(rows, axis=0, return_inverse=True)
    return vertices[unique[:, 0]], corners.reshape(-1, 3), unique[:, 1:]


def _polygons(faces: Any, count: int) -> tuple[Any, Any]:
    """Returns the corners of all polygons, and the number of corners of each."""
    import numpy as np

    if faces is None or np.isscalar(faces):
        raise ValueError(f"faces are lists of vertices, not {faces!r}")
    array: Any
    try:
        array = np.asarray(faces)
    except ValueError:
        # Lists of different lengths are not an array.
        array = None
    if array is None or array.dtype == object:
        # An empty list would be an array of floats.
        lists = [np.asarray(face) if len(face) else np.empty(0, np.int64) for face in faces]
        arities = np.array([len(face) for face in lists], np.uint32)
        array = np.concatenate(lists) if lists else np.empty(0, np.int64)
    elif array.size == 0:
        arities = np.empty(0, np.uint32)
        array = array.astype(np.int64)
    elif array.ndim == 2:
        arities = np.full(array.shape[0], array.shape[1], np.uint32)
    else:
        raise ValueError(f"faces needs the shape (m, 3), not {array.shape}")
    if array.dtype.kind not in "iu":
        raise ValueError(f"faces are numbers of vertices, not {array.dtype}")
    corners = array.ravel()
    if corners.size and not 0 <= corners.min() <= corners.max() < count:
        wrong = corners.min() if corners.min() < 0 else corners.max()
        raise ValueError(f"a face refers to vertex {wrong}, but there are {count} vertices")
    if arities.size and arities.min() < 3:
        raise ValueError(f"face {int(arities.argmin())} has fewer than 3 corners")
    return np.ascontiguousarray(corners, np.uint32), arities


def pixels_of(picture: Any) -> NDArray[np.uint8]:
    """Converts a file, an array or a picture of PIL to an array of RGBA bytes."""
    import numpy as np

    if isinstance(picture, (str, os.PathLike)):
        return _marraztu.load_picture(os.fspath(picture))
    if hasattr(picture, "convert"):
        picture = picture.convert("RGBA")
    array = np.asarray(picture)
    if array.dtype != np.uint8 or array.ndim != 3 or array.shape[2] not in (3, 4):
        raise ValueError(
            "a picture is a file, an array of bytes of shape (height, width, 3 or 4), or a picture "
            f"of PIL, not {array.dtype} {array.shape}"
        )
    if array.shape[2] == 3:
        alpha = np.full((*array.shape[:2], 1), 255, np.uint8)
        array = np.concatenate([array, alpha], axis=2)
    return np.ascontiguousarray(array)
