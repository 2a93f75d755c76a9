"""Comparison of pictures in tests.

    def test_logo():
        picture = scene.render(128, 128)
        marraztu.testing.assert_same(picture, "tests/logo.png")

Pictures have the same bytes on all processors and thread counts, so a test may compare all of them.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _marraztu
from ._mesh import pixels_of
from ._picture import Picture

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Difference", "amplified", "assert_same", "difference"]

WRITE = "MARRAZTU_WRITE_GOLDEN"
"""The environment variable with which `assert_same` writes the expected pictures."""

AMPLIFIED = 16


class Difference(NamedTuple):
    """The difference of two pictures, as `marraztu compare` measures it."""

    largest: int
    """The largest difference of a channel, in steps of a byte."""
    pixels: int
    """The number of pixels that differ."""
    flip: float
    """FLIP: the perceived difference, from 0 to 1 (Andersson and others, 2020)."""


def difference(a: Any, b: Any) -> Difference:
    """Measures the difference of two pictures of one size: pictures, arrays or files."""
    return _difference(_pixels(a), _pixels(b))


def amplified(a: Any, b: Any, factor: int = AMPLIFIED) -> NDArray[np.uint8]:
    """Returns the difference of two pictures of one size, multiplied, as RGBA bytes."""
    return _marraztu.amplified(_pixels(a), _pixels(b), factor)


def assert_same(
    picture: Any,
    expected: str | os.PathLike[str],
    *,
    max: int = 0,
    flip: float | None = None,
    out: str | os.PathLike[str] | None = None,
) -> None:
    """Fails unless a picture equals the one in a file.

    `max` is the largest difference of a channel that counts as the same, in steps of a byte.
    `flip` limits the perceived difference instead, unless `max` is given, too. On failure, the
    picture, the difference times 16 and a page that shows both are written into the folder `out`,
    by default the folder of the file, as NAME.actual.png, NAME.diff.png and NAME.html. With
    MARRAZTU_WRITE_GOLDEN=1 in the environment, the file is written instead.
    """
    __tracebackhide__ = True
    from pathlib import Path

    expected = Path(expected)
    if expected.suffix.lower() in (".jpg", ".jpeg"):
        raise ValueError(f"{expected}: JPEG changes the pixels; name a .png")
    if max < 0:
        raise ValueError(f"max is a number of steps from 0 on, not {max}")
    if isinstance(picture, Picture) and "color" not in picture.layers:
        raise ValueError("the picture has no colours to compare: name color in layers=")
    actual = _pixels(picture)
    if os.environ.get(WRITE, "0") not in ("", "0"):
        expected.parent.mkdir(parents=True, exist_ok=True)
        _marraztu.save_picture(os.fspath(expected), actual)
        return
    if not expected.is_file():
        kind = "is not a file" if expected.exists() else f"does not exist; {WRITE}=1 writes it"
        raise AssertionError(f"{expected} {kind}")
    golden = _pixels(expected)
    folder = expected.parent if out is None else Path(out)
    stem = folder / expected.stem
    if golden.shape != actual.shape:
        sizes = [f"{array.shape[1]}x{array.shape[0]}" for array in (actual, golden)]
        path = _write(stem, "actual", actual)
        raise AssertionError(f"the picture has {sizes[0]} pixels, {expected} {sizes[1]}: {path}")
    found = _difference(actual, golden)
    within = found.largest <= max or (max == 0 and flip is not None)
    if within and (flip is None or found.flip <= flip):
        return
    pictures = {"actual": actual, "diff": amplified(actual, golden)}
    paths = [_write(stem, word, pixels) for word, pixels in pictures.items()]
    page = stem.with_name(stem.name + ".html")
    page.write_text(_page(expected, found, {"expected": golden, **pictures}), encoding="utf-8")
    raise AssertionError(
        f"the picture differs from {expected} in {found.pixels} pixels, by up to {found.largest} "
        f"steps (FLIP {found.flip:.4f}): see {page}, {paths[0]} and {paths[1]}"
    )


def _pixels(picture: Any) -> Any:
    return picture.rgba if isinstance(picture, Picture) else pixels_of(picture)


def _difference(a: Any, b: Any) -> Difference:
    import numpy as np

    if a.shape != b.shape:
        raise ValueError(f"the pictures have the shapes {a.shape} and {b.shape}")
    steps = np.abs(a.astype(np.int16) - b).max(axis=2)
    largest = int(steps.max())
    return Difference(largest, int((steps > 0).sum()), _marraztu.flip(a, b) if largest else 0.0)


def _write(stem: Path, word: str, pixels: Any) -> Path:
    path = stem.with_name(f"{stem.name}.{word}.png")
    path.parent.mkdir(parents=True, exist_ok=True)
    _marraztu.save_picture(os.fspath(path), pixels)
    return path


def _page(expected: Path, found: Difference, pictures: dict[str, Any]) -> str:
    # These take longer to import than the rest of the package.
    import base64
    import html

    name = html.escape(str(expected))
    figures = ""
    for word, pixels in pictures.items():
        png = base64.b64encode(_marraztu.png(pixels)).decode()
        figures += f"<figure><img src='data:image/png;base64,{png}' alt='{word}'>"
        figures += f"<figcaption>{word}</figcaption></figure>\n"
    return (
        f"<!doctype html><meta charset='utf-8'><title>{name}</title>\n"
        "<style>body{font:16px sans-serif;background:#777;color:#fff}figure{display:inline-block}"
        "img{image-rendering:pixelated;min-width:256px}</style>\n"
        f"<h1>{name}</h1>\n<p>{found.pixels} pixels differ, by up to {found.largest} steps of a "
        f"byte; FLIP {found.flip:.4f}. The difference is multiplied by {AMPLIFIED}.</p>\n{figures}"
    )
