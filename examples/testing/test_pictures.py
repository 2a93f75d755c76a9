"""Compares pictures with golden ones, by `marraztu compare`: a pattern for tests of graphics code.

    pytest                        compares
    WRITE_GOLDEN=1 pytest         accepts the pictures as they are now

After a failure, the folder `failed` has the picture and its difference from the golden one.
"""
import os
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
MODELS = HERE.parent.parent / "assets"


def run(*command):
    return subprocess.run(command, text=True, capture_output=True)


@pytest.fixture
def assert_golden(request):
    """Returns a function that compares a picture with the golden one of the test. By default, all
    pixels have to be equal; limits are options of `marraztu compare`."""

    def check(picture, *limits):
        name = request.node.name
        golden = HERE / "golden" / f"{name}.png"
        if os.environ.get("WRITE_GOLDEN"):
            golden.parent.mkdir(exist_ok=True)
            shutil.copy(picture, golden)
            return
        difference = picture.with_name("difference.png")
        result = run("marraztu", "compare", golden, picture, "--out", difference, *limits)
        if result.returncode == 0:
            return
        failed = HERE / "failed"
        failed.mkdir(exist_ok=True)
        shutil.copy(picture, failed / f"{name}.png")
        if difference.exists():
            shutil.copy(difference, failed / f"{name}-difference.png")
        pytest.fail(f"see {failed}/{name}*.png\n{result.stdout}{result.stderr}", pytrace=False)

    return check


def draw(model, out):
    """Draws a picture: put your renderer here."""
    result = run("marraztu", "render", MODELS / model, "--size", "64", "--out", out)
    assert result.returncode == 0, result.stderr
    return out


def test_cam(tmp_path, assert_golden):
    assert_golden(draw("cam.obj", tmp_path / "cam.png"))


def test_ship(tmp_path, assert_golden):
    # Limits for renderers that differ between machines, such as graphics cards.
    assert_golden(draw("x_wing.obj", tmp_path / "ship.png"), "--max", "8", "--flip", "0.01")
