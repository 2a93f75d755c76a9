"""Cameras: intrinsics, poses and their conventions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

CONVENTIONS = ("opengl", "opencv")


class Camera:
    """A camera with a pose, or one that frames the whole scene from a direction.

    The lens is given by the matrix `K` of intrinsics in pixels, with two focal lengths and any
    principal point, or by `yfov`, the vertical angle of view in radians, for square pixels and the
    centre of the picture. In `K`, the upper left corner of the picture is (0, 0), so the centre of
    the first pixel is (0.5, 0.5), as in COLMAP; for a `K` that puts it at (0, 0), as OpenCV and BOP
    do, give `pixel_center=0`. Lenses that distort have no `K`: undistort their pictures first.

    `pose` is a 4x4 matrix from camera to world. With `convention="opengl"`, x points to the right,
    y up, and the camera looks along -z (glTF, NeRF, pyrender, Blender). With `"opencv"`, y points
    down and the camera looks along z (COLMAP, BOP, ROS).
    """

    __slots__ = ("_K", "_direction", "_pose", "convention", "yfov")

    def __init__(
        self,
        K: ArrayLike | None = None,
        pose: ArrayLike | None = None,
        *,
        yfov: float | None = None,
        convention: str = "opengl",
        pixel_center: float = 0.5,
    ) -> None:
        import numpy as np

        if convention not in CONVENTIONS:
            raise ValueError(f"convention is opengl or opencv, not {convention!r}")
        if (K is None) == (yfov is None):
            raise ValueError("give the lens of a camera by K or by yfov")
        if yfov is not None and not 0 < yfov < math.pi:
            raise ValueError(f"yfov is between 0 and pi radians, not {yfov}")
        self._direction: tuple[float, float] | None = None
        self.convention = convention
        self.yfov = yfov
        self._K = None if K is None else _intrinsics(np.asarray(K, np.float64), pixel_center)
        pose = np.eye(4) if pose is None else np.array(pose, np.float64)
        if pose.shape != (4, 4) or not np.isfinite(pose).all():
            raise ValueError("a pose is a finite 4x4 matrix from camera to world")
        self._pose: NDArray[np.float64] | None = _flipped(pose, convention)

    @classmethod
    def look_at(
        cls,
        eye: Sequence[float],
        target: Sequence[float],
        up: Sequence[float] = (0, 1, 0),
        yfov: float = math.pi / 4,
    ) -> Camera:
        """A camera at `eye` that looks at `target`. `yfov` is in radians."""
        import numpy as np

        origin = np.asarray(eye, np.float64)
        z = origin - np.asarray(target, np.float64)
        x = np.cross(np.asarray(up, np.float64), z)
        if not (np.linalg.norm(x) > 1e-6 * np.linalg.norm(z) > 0):
            raise ValueError("eye and target differ, and the view is not parallel to up")
        x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
        pose = np.eye(4)
        pose[:3] = np.stack([x, np.cross(z, x), z, origin], axis=1)
        return cls(pose=pose, yfov=yfov)

    @classmethod
    def around(cls, right: float = math.radians(30), up: float = math.radians(20)) -> Camera:
        """A camera that frames the whole scene, like `marraztu render --from`.

        `right` and `up` are the angles of the direction from the front, in radians. The lights of
        the scene are placed for this view, if the scene has no others. The camera of the picture
        has the pose.
        """
        if not (math.isfinite(right) and abs(up) <= math.pi / 2):
            raise ValueError("right is finite, and up is from -pi / 2 to pi / 2 radians")
        camera = cls.__new__(cls)
        camera._K = camera._pose = camera.yfov = None
        camera.convention = "opengl"
        camera._direction = (float(right), float(up))
        return camera

    @property
    def K(self) -> NDArray[np.float64]:
        """The matrix of intrinsics, in pixels. The centre of the first pixel is (0.5, 0.5)."""
        if self._K is None:
            raise ValueError("K depends on the size of the picture: use the camera of a picture")
        return self._K.copy()

    def pose(self, convention: str | None = None) -> NDArray[np.float64]:
        """Returns the 4x4 matrix from camera to world, by default in the camera's convention."""
        if self._pose is None:
            raise ValueError("the pose depends on the scene: use the camera of a picture")
        convention = self.convention if convention is None else convention
        if convention not in CONVENTIONS:
            raise ValueError(f"convention is opengl or opencv, not {convention!r}")
        return _flipped(self._pose, convention)

    def _aim(self, width: int, height: int) -> tuple[Any, Any]:
        """The camera as the kernel expects it."""
        if self._direction is not None:
            return self._direction
        if self._K is not None:
            lens = self._K[[0, 1, 0, 1], [0, 1, 2, 2]].tolist()
        elif self.yfov is not None:
            focal = height / 2 / math.tan(self.yfov / 2)
            lens = [focal, focal, width / 2, height / 2]
        return self.pose("opengl").tolist(), lens

    def __repr__(self) -> str:
        if self._direction is not None:
            right, up = self._direction
            return f"Camera.around(right={right:.4g}, up={up:.4g})"
        x, y, z = self.pose()[:3, 3]
        if self._K is None:
            lens = f"yfov={self.yfov:.4g}"
        else:
            fx, fy, cx, cy = self._K[[0, 1, 0, 1], [0, 1, 2, 2]]
            lens = f"focal=({fx:.5g}, {fy:.5g}), center=({cx:.5g}, {cy:.5g})"
        return f"Camera({lens}, eye=({x:.4g}, {y:.4g}, {z:.4g}), convention={self.convention!r})"


def _flipped(pose: NDArray[np.float64], convention: str) -> NDArray[np.float64]:
    """Converts from the axes of OpenGL to a convention, or back."""
    import numpy as np

    return pose @ np.diag([1.0, -1.0, -1.0, 1.0]) if convention == "opencv" else pose.copy()


def _intrinsics(K: NDArray[np.float64], pixel_center: float) -> NDArray[np.float64]:
    import numpy as np

    if K.shape != (3, 3) or not np.isfinite(K).all():
        raise ValueError("K is a finite 3x3 matrix")
    (fx, skew, cx), (shear, fy, cy), row = K
    if not (fx > 0 and fy > 0):
        raise ValueError(f"the focal lengths of K are above 0, not {fx} and {fy}")
    if shear != 0 or list(row) != [0, 0, 1]:
        raise ValueError("K has rows (fx, 0, cx), (0, fy, cy), (0, 0, 1)")
    # Across the picture, a skew of less than this is below a thousandth of a pixel.
    if abs(skew) > 1e-3 * fy / max(abs(cx), abs(cy), 1):
        raise ValueError(
            f"K has a skew of {skew:g}; only rows and columns at right angles are drawn"
        )
    K = K.copy()
    K[0, 1] = 0
    K[:2, 2] += 0.5 - pixel_center
    return K
