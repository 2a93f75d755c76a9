"""What several tests use."""

import os
from pathlib import Path

import marraztu as mz
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def assets() -> Path:
    return ROOT / "assets"


@pytest.fixture(scope="session")
def program() -> str:
    """The command line program, which tools/python-wheel builds."""
    program = os.environ.get("MARRAZTU_PROGRAM")
    if program is None:
        pytest.skip("MARRAZTU_PROGRAM does not name the program: pictures are not compared with it")
    return program


@pytest.fixture
def quad() -> mz.Mesh:
    """A square of side 2 around the origin, in the plane z = 0."""
    vertices = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    return mz.Mesh(vertices, [[0, 1, 2, 3]], name="quad")


@pytest.fixture(scope="session")
def cam(assets) -> mz.Mesh:
    return mz.Mesh.load(assets / "cam.obj")
