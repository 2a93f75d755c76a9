"""Snapshots of scenes, which draw and explain pictures."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _marraztu
from ._picture import Picture
from ._values import tuples

if TYPE_CHECKING:
    from concurrent.futures import Future


class Surface(NamedTuple):
    """The surface at a pixel."""

    object: int
    """The id of the node; 0 for a mark of a camera or a light."""
    polygon: int
    """The number of the polygon, from 1, as in the layer."""
    triangle: int
    """The row of `Mesh.triangles`, from 0."""
    barycentrics: tuple[float, float, float]
    depth: float
    """The distance along the camera's axis, in units of the models."""
    position: tuple[float, float, float]
    normal: tuple[float, float, float]
    is_back: bool


class Explanation(NamedTuple):
    """What a pixel shows, and the terms of its colour. Its text explains all of them."""

    text: str
    color: tuple[int, int, int]
    """The bytes of the pixel with one sample."""
    surface: Surface | None
    """None for the background and for lines."""
    terms: tuple[tuple[str, tuple[float, float, float]], ...]
    """Light by light, in steps of a byte. Their sum, clamped and rounded, is the colour; with
    `values="linear"`, it is linear light, which is encoded first."""

    def __str__(self) -> str:
        return self.text


class Effect(NamedTuple):
    """An effect of the renderer, on a node or on the whole picture."""

    effect: str
    name: str
    """The label, or the name of a light."""
    on: str
    """The name of the node; "" for the whole picture."""
    is_on: bool
    why: str
    """The reason, if it is left out; else a remark."""
    pixels: int | None
    """The number of pixels that it contributes to."""


class Fit(NamedTuple):
    """The settings for a budget, as `Shot.fitted` finds them."""

    shot: Shot
    """The shot with these settings."""
    accuracy: dict[str, str]
    """The settings, for other pictures: `scene.render(640, 480, **fit.accuracy)`."""
    milliseconds: float
    """The time of a picture on this machine."""
    error: float
    """The root mean square difference from the ideal, 256 samples per pixel, in steps of 255."""
    error_interval: tuple[float, float]
    """The 95% interval of the error."""
    is_reached: bool
    """Whether the settings keep to the budget. If none do, they are the nearest ones."""


class Shot:
    """A snapshot of a scene with everything that a picture depends on. `Scene.shot` makes it."""

    __slots__ = ("_shot", "layers", "normals", "transparent", "unit")

    def __init__(
        self,
        kernel: _marraztu.Shot,
        layers: tuple[str, ...],
        normals: str,
        transparent: bool,
        unit: float,
    ) -> None:
        self._shot = kernel
        self.layers = layers
        self.normals = normals
        self.transparent = transparent
        self.unit = unit

    def __reduce__(self) -> tuple[Any, ...]:
        # Pickles name the files of meshes, which are read again: see `Mesh.__reduce__`.
        rest = (self.layers, self.normals, self.transparent, self.unit)
        return Shot._restored, (*self._shot.dump(), *rest)

    @classmethod
    def _restored(cls, text: Any, size: tuple[int, int], *rest: Any) -> Shot:
        return cls(_marraztu.Shot.restore(text, size), *rest)

    @property
    def width(self) -> int:
        """The width of the picture in pixels."""
        return self._shot.size[0]

    @property
    def height(self) -> int:
        """The height of the picture in pixels."""
        return self._shot.size[1]

    @property
    def settings(self) -> str:
        """The settings that differ from the default, in words."""
        return self._shot.settings

    def render(self, threads: int | None = None) -> Picture:
        """Draws the picture with this number of threads, by default one per core."""
        if threads is not None and threads < 0:
            raise ValueError("threads is at least 0")
        arrays = self._shot.render(threads or 0, list(self.layers), self.normals, self.transparent)
        return Picture(self, arrays)

    def fitted(
        self,
        *,
        within: float | None = None,
        error: float | None = None,
        unseen: bool = False,
        threads: int | None = None,
    ) -> Fit:
        """Finds settings for a budget, by drawing parts of the picture: it takes some seconds.

        One of the budgets is given: `within` for the most exact settings for pictures that this
        machine draws in this number of milliseconds; `error` for the fastest ones with at most
        this error; `unseen` for the fastest whose pictures look like the ideal. They are those of
        `marraztu render --within`, `--error` and `--unseen`.
        """
        budgets = {"within": within, "error": error, "unseen": 0.0 if unseen else None}
        given = [(kind, limit) for kind, limit in budgets.items() if limit is not None]
        if len(given) != 1:
            raise ValueError("one of within, error and unseen is given")
        kind, limit = given[0]
        if not (unseen or 0 < limit < float("inf")):
            raise ValueError(f"{kind} is a number above 0, not {limit}")
        if threads is not None and threads < 0:
            raise ValueError("threads is at least 0")
        kernel, fit = self._shot.fitted(threads or 0, kind, limit)
        shot = Shot(kernel, self.layers, self.normals, self.transparent, self.unit)
        return Fit(shot, **{**fit, "error_interval": tuple(fit["error_interval"])})

    def explain(self, x: int, y: int) -> Explanation:
        """Explains the pixel in column x of row y, from the upper left."""
        values = self._shot.explain(x, y)
        surface = values["surface"] and Surface(**tuples(values["surface"]))
        terms = tuple((label, tuple(value)) for label, value in values["terms"])
        return Explanation(values["text"], tuple(values["color"]), surface, terms)

    def plan(self) -> list[Effect]:
        """Lists the effects of the picture, and those left out, with the reasons."""
        return [Effect(**row) for row in self._shot.plan()]

    def __repr__(self) -> str:
        settings = f", {self.settings}" if self.settings else ""
        return f"<Shot of {self.width} x {self.height} pixels{settings}>"


def render_many(shots: Iterable[Shot], threads: int = 0, ahead: int = 4) -> Iterator[Picture]:
    """Draws pictures on several threads (0: one per core), in the order of the shots.

    Each picture is drawn by one thread. Shots are taken as needed, and at most `threads + ahead`
    pictures exist that have not been yielded, so memory is bounded for any number of shots.
    """
    threads = threads or _marraztu.cores()
    if threads < 0 or ahead < 0:
        raise ValueError("threads and ahead are at least 0")
    return _drawn(shots, threads, ahead)


def _drawn(shots: Iterable[Shot], threads: int, ahead: int) -> Iterator[Picture]:
    from concurrent.futures import ThreadPoolExecutor

    waiting: deque[Future[Picture]] = deque()
    with ThreadPoolExecutor(threads) as pool:
        try:
            source, error = iter(shots), None
            while True:
                try:
                    shot = next(source)
                    if not isinstance(shot, Shot):
                        kind = type(shot).__name__
                        raise TypeError(f"render_many draws shots, as of Scene.shot, not {kind}")
                except StopIteration:
                    break
                except Exception as raised:
                    # The pictures of the shots before it come first.
                    error = raised
                    break
                # Room for this shot is made first.
                if len(waiting) >= threads + ahead:
                    yield waiting.popleft().result()
                waiting.append(pool.submit(shot.render, 1))
            while waiting:
                yield waiting.popleft().result()
            if error is not None:
                raise error
        finally:
            # The caller may stop early.
            for future in waiting:
                future.cancel()
