"""Scenes and their nodes."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from . import _marraztu
from ._camera import Camera
from ._mesh import Mesh, warn_of
from ._shot import Effect, Explanation, Shot
from ._values import UNCHANGED, Light, Material, bytes_of, material_of, tuples

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from ._picture import Picture


class Node:
    """A mesh at a place in a scene. `Scene.add` makes nodes; changes show in the next picture."""

    __slots__ = ("_id", "_key", "_mesh", "_name", "_opacity", "_pose", "_scene", "_visible")

    def __init__(
        self,
        scene: _marraztu.Scene,
        row: tuple[int, int, str, bool, list[list[float]], float],
        mesh: Mesh | None = None,
    ) -> None:
        self._scene = scene
        self._mesh = mesh
        self._key, self._id, self._name, self._visible, self._pose, self._opacity = row

    def _change(self, key: str, value: object) -> None:
        self._scene.change(self._key, {**UNCHANGED, key: value})

    @property
    def id(self) -> int:
        """The number of the node in the layer "object"."""
        return self._id

    @property
    def mesh(self) -> Mesh:
        """The shape."""
        if self._mesh is None:
            self._mesh = Mesh._wrap(self._scene.mesh(self._key))
        return self._mesh

    @property
    def name(self) -> str:
        """The name, in `Picture.names` and in explanations."""
        return self._name

    @name.setter
    def name(self, name: str) -> None:
        self._change("name", name)
        self._name = name

    @property
    def visible(self) -> bool:
        """Whether the node is drawn."""
        return self._visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._change("visible", visible)
        self._visible = visible

    @property
    def pose(self) -> NDArray[np.float64]:
        """The 4x4 matrix from the mesh to the world. It may scale."""
        import numpy as np

        return np.array(self._pose)

    @pose.setter
    def pose(self, pose: ArrayLike) -> None:
        rows = _rows(pose)
        self._change("pose", rows)
        self._pose = rows

    @property
    def opacity(self) -> float:
        """The opacity, from 0 to 1; it multiplies the opacities of the file."""
        return self._opacity

    @opacity.setter
    def opacity(self, opacity: float) -> None:
        self._change("opacity", opacity)
        self._opacity = opacity

    def set_material(self, material: Material | str | None) -> None:
        """Replaces the material; "file" or None restores those of the mesh. Textures stay."""
        self._change("material", "file" if material is None else material_of(material))

    def set_sides(self, sides: str) -> None:
        """Draws "one" or "two" sides of faces, or two sides of open surfaces alone ("auto")."""
        self._change("sides", sides)

    def __repr__(self) -> str:
        return f"<Node {self.name!r}, id {self.id}>"


def _rows(pose: ArrayLike) -> list[list[float]]:
    import numpy as np

    array = np.asarray(pose, np.float64)
    if array.shape != (4, 4):
        raise ValueError(f"a pose is a 4x4 matrix, not {array.shape}")
    rows: list[list[float]] = array.tolist()
    return rows


class Scene:
    """Meshes with lights, seen by cameras.

    Unless lights are given, the scene is lit like models in `marraztu render`: the lights follow
    the size of the models, and nothing but highlights reaches white. Pictures have the same bytes.
    """

    __slots__ = ("_nodes", "_scene", "_unit", "findings")

    def __init__(
        self,
        meshes: Iterable[Mesh] = (),
        *,
        lights: Iterable[Light] | None = None,
        background: Sequence[int] | str | None = None,
        unit: float = 1.0,
    ) -> None:
        self._scene = _marraztu.Scene()
        self._nodes: list[Node] = []
        self.findings: list[str] = []
        self.unit = unit
        for mesh in meshes:
            self.add(mesh)
        if lights is not None:
            self.lights = lights
        if background is not None:
            self.background = background

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """Opens a scene file (.marraztu), with its view, lights and settings.

        Missing models are boxes and a `FindingWarning`. Raises `LoadError`.
        """
        if os.fspath(path).lower().endswith((".obj", ".obj.gz", ".stl")):
            raise ValueError(f"{path} is a model: use Scene([Mesh.load({os.fspath(path)!r})])")
        scene = cls()
        scene._scene, scene.findings = _marraztu.Scene.load(os.fspath(path))
        scene._nodes = [Node(scene._scene, row) for row in scene._scene.objects()]
        warn_of(scene.findings)
        return scene

    def save(self, path: str | os.PathLike[str]) -> None:
        """Saves the scene as a file of the editor (.marraztu), with its default view and lights.

        The file names the files of the meshes and textures, so each needs one: meshes of arrays
        raise `OSError`, and the file stays as it was.
        """
        if not os.fspath(path).lower().endswith(".marraztu"):
            raise ValueError(f"{path} is not the name of a scene: choose one in .marraztu")
        self._scene.save(os.fspath(path))

    def __reduce__(self) -> tuple[Any, ...]:
        # Pickles name the files of meshes, which are read again: see `Mesh.__reduce__`.
        keys = [node._key for node in self._nodes]
        return Scene._restored, (*self._scene.dump(), keys, self.unit, self.findings)

    @classmethod
    def _restored(
        cls,
        text: Any,
        is_lit: bool,
        is_file: bool,
        keys: list[int],
        unit: float,
        findings: list[str],
    ) -> Scene:
        scene = cls(unit=unit)
        scene._scene, scene.findings = _marraztu.Scene.restore(text, is_lit, is_file), findings
        rows = {row[0]: row for row in scene._scene.objects()}
        scene._nodes = [Node(scene._scene, rows[key]) for key in keys]
        return scene

    @property
    def unit(self) -> float:
        """The factor of the layers depth, distance and position: metres per unit of the models.
        Poses stay in units of the models."""
        return self._unit

    @unit.setter
    def unit(self, unit: float) -> None:
        if isinstance(unit, str) or not 0 < unit < math.inf:
            raise ValueError(f"a unit is a finite number of metres above 0, not {unit!r}")
        self._unit = float(unit)

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes in the order of their addition, or of the file."""
        return tuple(self._nodes)

    def add(
        self,
        mesh: Mesh,
        *,
        pose: ArrayLike | None = None,
        name: str | None = None,
        id: int | None = None,
        material: Material | str | None = None,
        opacity: float = 1.0,
        sides: str = "auto",
    ) -> Node:
        """Adds a mesh. `id` is its number in the layer "object", from 1; by default a free one."""
        if not isinstance(mesh, Mesh):
            raise TypeError(f"a scene holds objects of Mesh, not {type(mesh).__name__}")
        properties = {
            **UNCHANGED,
            "name": name,
            "pose": None if pose is None else _rows(pose),
            "material": material_of(material),
            "opacity": opacity,
            "sides": sides,
        }
        key, _ = self._scene.add(mesh._mesh, id, properties)
        row = next(row for row in self._scene.objects() if row[0] == key)
        node = Node(self._scene, row, mesh)
        self._nodes.append(node)
        return node

    def remove(self, node: Node) -> None:
        """Removes a node."""
        if node not in self._nodes:
            raise ValueError(f"{node!r} is not in this scene")
        self._scene.remove(node._key)
        self._nodes.remove(node)

    @property
    def lights(self) -> list[Light]:
        """The lights that are on. Set a list to replace them, and None for automatic lights."""
        return [Light(**tuples(values)) for values in self._scene.lights()]

    @lights.setter
    def lights(self, lights: Iterable[Light] | None) -> None:
        if lights is None:
            self._scene.set_lights(None)
            return
        checked = []
        for light in lights:
            if not isinstance(light, Light):
                raise TypeError(f"lights are objects of Light, not {type(light).__name__}")
            checked.append(light._replace(color=bytes_of(light.color)))
        self._scene.set_lights(checked)

    def set_shadows(self, on: bool) -> None:
        """Switches the shadows of all lights, as far as they can cast any."""
        self._scene.set_shadows(on)

    @property
    def background(self) -> tuple[int, int, int]:
        """The background: red, green and blue from 0 to 255; "#rrggbb" and "#rgb" can be set."""
        return self._scene.background

    @background.setter
    def background(self, color: Sequence[int] | str) -> None:
        self._scene.background = bytes_of(color)

    @property
    def line_width(self) -> float:
        """The width in pixels of the lines of models, and the diameter of their points."""
        return self._scene.line_width

    @line_width.setter
    def line_width(self, pixels: float) -> None:
        self._scene.line_width = pixels

    @property
    def exposure(self) -> float:
        """The exposure in stops: each doubles the light."""
        return self._scene.exposure

    @exposure.setter
    def exposure(self, stops: float) -> None:
        self._scene.exposure = stops

    @property
    def edges(self) -> str:
        """The edges of polygons: "none", "over" filled polygons, or "only" (a wireframe)."""
        return self._scene.edges

    @edges.setter
    def edges(self, edges: str) -> None:
        self._scene.edges = edges

    def shot(
        self,
        width: int,
        height: int,
        *,
        camera: Camera | None = None,
        layers: Sequence[str] = ("color",),
        normals: str = "camera",
        transparent: bool = False,
        preset: str | None = None,
        **accuracy: str | int,
    ) -> Shot:
        """Returns a snapshot of the scene for one picture. Later changes do not affect it.

        The arguments are those of `render`.
        """
        if camera is not None and not isinstance(camera, Camera):
            raise TypeError(f"camera is a Camera, not {type(camera).__name__}")
        layers = (layers,) if isinstance(layers, str) else tuple(layers)
        aim = None if camera is None else camera._aim(width, height)
        choices = {key.replace("_", "-"): str(word) for key, word in accuracy.items()}
        kernel = self._scene.shot(width, height, aim, preset, choices)
        return Shot(kernel, layers, normals, transparent, self.unit)

    def render(
        self,
        width: int,
        height: int,
        *,
        camera: Camera | None = None,
        layers: Sequence[str] = ("color",),
        normals: str = "camera",
        transparent: bool = False,
        threads: int | None = None,
        preset: str | None = None,
        **accuracy: str | int,
    ) -> Picture:
        """Draws a picture of this size in pixels.

        Without a camera, the models are framed, and a scene from a file is seen by its own camera.
        `layers` are arrays of the picture: see `Picture`. `normals` is their space, "camera" or
        "world". `transparent` leaves out the background: see `Picture.rgba`. `threads` is the
        number of threads, by default one per core; pictures do not depend on it.

        `preset` and the axes of accuracy (`samples=4`, `filter="nearest"`; see `axes`) are those of
        `marraztu render`: without `samples`, pictures have 16 samples per pixel.
        """
        shot = self.shot(
            width,
            height,
            camera=camera,
            layers=layers,
            normals=normals,
            transparent=transparent,
            preset=preset,
            **accuracy,
        )
        return shot.render(threads)

    def explain(self, x: int, y: int, width: int, height: int, **arguments: Any) -> Explanation:
        """Explains the pixel in column x of row y of a picture. Takes the arguments of `shot`."""
        return self.shot(width, height, **arguments).explain(x, y)

    def plan(self, width: int, height: int, **arguments: Any) -> list[Effect]:
        """Lists the effects of a picture, and those left out, with the reasons."""
        return self.shot(width, height, **arguments).plan()

    def _repr_png_(self) -> bytes | None:
        return self.render(400, 300)._repr_png_()

    def __repr__(self) -> str:
        nodes = ", ".join(node.name for node in self._nodes[:4])
        more = f" and {len(self._nodes) - 4} more" if len(self._nodes) > 4 else ""
        return f"<Scene of {nodes or 'nothing'}{more}>"
