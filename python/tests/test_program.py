"""Pictures have the same bytes as those of the command line."""

import json
import math
import subprocess

import marraztu as mz
import numpy as np
import pytest

CASES = {
    "default": ([], {}),
    "samples": (["--samples", "4"], {"samples": 4}),
    "draft": (["--preset", "draft"], {"preset": "draft"}),
    "axes": (
        ["--shading", "vertex", "--rounding", "dithered"],
        {"shading": "vertex", "rounding": "dithered"},
    ),
    "from": (
        ["--from", "145,-20"],
        {"camera": mz.Camera.around(math.radians(145), math.radians(-20))},
    ),
    "transparent": (["--transparent"], {"transparent": True}),
}


def render(program, out, *arguments):
    command = [program, "render", *map(str, arguments), "--out", str(out), "--quiet"]
    subprocess.run(command, check=True, timeout=60)
    return out.read_bytes()


@pytest.mark.parametrize("case", CASES)
def test_files_equal_those_of_render(program, assets, tmp_path, case):
    options, arguments = CASES[case]
    scene = mz.Scene([mz.Mesh.load(assets / "x_wing.obj")])
    scene.render(100, 80, **arguments).save(tmp_path / "ours.png")
    theirs = render(
        program, tmp_path / "a.png", assets / "x_wing.obj", "--size", "100x80", *options
    )
    assert (tmp_path / "ours.png").read_bytes() == theirs


def test_several_models_and_switches_equal_render(program, assets, tmp_path):
    files = [assets / "cam.obj", assets / "r_falke.obj"]
    scene = mz.Scene([mz.Mesh.load(file) for file in files], background="#102030")
    scene.nodes[0].set_material("gold")
    scene.nodes[1].set_material("gold")
    scene.edges = "over"
    scene.exposure = 0.5
    scene.set_shadows(True)
    scene.render(64, 96).save(tmp_path / "ours.ppm")
    options = ["--background", "16,32,48", "--material", "gold", "--edges-over"]
    options += ["--exposure", "0.5", "--shadows", "all", "--size", "64x96"]
    theirs = render(program, tmp_path / "a.ppm", *files, *options)
    assert (tmp_path / "ours.ppm").read_bytes() == theirs


def test_a_scene_file_equals_render(program, tmp_path):
    path = tmp_path / "a.marraztu"
    path.write_text(
        """(
            version: 1,
            objects: [(id: 1, name: "ball", model: Own("sphere"), material: Preset("ruby"))],
            cameras: [(id: 2, name: "camera 1", eye: (0.0, 20.0, 160.0))],
            lights: [(id: 3, name: "sun", slot: 1, kind: Sun(direction: (-0.6, -0.8, 0.0)))],
            view: (object: Some(1), camera: 2),
        )"""
    )
    scene = mz.Scene.load(path)
    assert [(node.id, node.name) for node in scene.nodes] == [(1, "ball")]
    scene.render(64, 64).save(tmp_path / "ours.png")
    assert (tmp_path / "ours.png").read_bytes() == render(
        program, tmp_path / "a.png", path, "--size", "64"
    )


def test_cameras_of_transforms_json_equal_batch(program, assets, tmp_path):
    """Intrinsics and poses mean the same in Python, in both conventions."""
    mesh = mz.Mesh.load(assets / "cam.obj")
    centre = mesh.bounds.mean(axis=0)
    size = np.ptp(mesh.bounds, axis=0).max()
    camera = mz.Camera.look_at(centre + size * np.array([1, 0.7, 2]), centre)
    K = [[90.0, 0, 43.5], [0, 85, 27.25], [0, 0, 1]]
    frame = {"transform_matrix": camera.pose().tolist()}
    lens = {"fl_x": 90, "fl_y": 85, "w": 80, "h": 60, "cx": 43.5, "cy": 27.25}
    cameras = {**lens, "frames": [frame]}
    (tmp_path / "cameras.json").write_text(json.dumps(cameras))
    command = [program, "batch", str(assets / "cam.obj"), "--views", str(tmp_path / "cameras.json")]
    command += ["--out", str(tmp_path / "{view}.ppm"), "--quiet"]
    subprocess.run(command, check=True, timeout=60)
    theirs = mz.testing._pixels(next(tmp_path.glob("*.ppm")))
    scene = mz.Scene([mesh])
    for convention in ("opengl", "opencv"):
        ours = mz.Camera(K, camera.pose(convention), convention=convention)
        assert np.array_equal(scene.render(80, 60, camera=ours).rgba, theirs), convention
