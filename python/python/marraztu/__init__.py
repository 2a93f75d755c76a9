"""Pictures of .obj models, drawn by the CPU alone.

    import marraztu as mz

    mesh = mz.Mesh.load("cow.obj")
    scene = mz.Scene([mesh])
    picture = scene.render(640, 480, layers=("color", "depth"))
    picture.color    # (480, 640, 3) uint8
    picture.depth    # (480, 640) float32
    picture          # a notebook shows it

Angles are in radians. Poses are 4x4 matrices that lead from the object or camera to the world; y is
up. Cameras have the axes of OpenGL unless `convention="opencv"` is given.
"""

import os as _os

from . import _marraztu, testing
from ._camera import Camera
from ._marraztu import LoadError, __version__
from ._mesh import FindingWarning, Mesh
from ._picture import Picture
from ._scene import Node, Scene
from ._shot import Effect, Explanation, Fit, Shot, Surface, render_many
from ._values import Light, Material, axes

__all__ = [
    "Camera",
    "Effect",
    "Explanation",
    "FindingWarning",
    "Fit",
    "Light",
    "LoadError",
    "Material",
    "Mesh",
    "Node",
    "Picture",
    "Scene",
    "Shot",
    "Surface",
    "__version__",
    "axes",
    "render_many",
    "testing",
]

# A child process has none of the threads that draw. Windows does not fork.
if hasattr(_os, "register_at_fork"):
    _os.register_at_fork(after_in_child=_marraztu.after_fork)
