"""Layers as arrays."""

import math

import marraztu as mz
import numpy as np
import pytest

ALL = (
    "depth",
    "distance",
    "normal",
    "position",
    "uv",
    "object",
    "part",
    "material",
    "polygon",
    "mask",
)
CAMERA = mz.Camera.look_at((0, 0, 5), (0, 0, 0), yfov=math.pi / 4)


def test_layers_have_their_shapes_types_and_background(quad):
    picture = mz.Scene([quad]).render(64, 48, camera=CAMERA, layers=("color", *ALL))
    for name in ALL:
        array = getattr(picture, name)
        channels = {"normal": (3,), "position": (3,), "uv": (2,)}.get(name, ())
        assert array.shape == (48, 64, *channels), name
        kind = {"mask": np.bool_}.get(name, np.float32 if name in ALL[:5] else np.int32)
        assert array.dtype == kind, name
        background = math.inf if name in ("depth", "distance") else 0
        assert (array[0, 0] == background).all() and (name == "uv" or array[24, 32].any()), name
        assert not array.flags.owndata
    assert picture.color.shape == (48, 64, 3)


def test_layers_measure_the_scene(quad):
    scene = mz.Scene()
    pose = np.eye(4)
    pose[2, 3] = 1
    node = scene.add(quad, pose=pose, id=9, name="sign")
    picture = scene.render(65, 65, camera=CAMERA, layers=ALL)
    assert picture.depth[32, 32] == 4 and picture.object[32, 32] == node.id == 9
    assert picture.names == {9: "sign"}
    assert np.allclose(picture.normal[32, 32], (0, 0, 1))
    x, y = 20, 28
    # The centre of the pixel, by the matrix of intrinsics.
    ray = np.linalg.inv(picture.camera.K) @ (x + 0.5, y + 0.5, 1)
    point = picture.camera.pose("opencv") @ (*(ray * picture.depth[y, x]), 1)
    # Vertices are snapped to 1/256 pixel.
    most = picture.depth[y, x] / picture.camera.K[0, 0] / 256
    assert np.allclose(point[:3], picture.position[y, x], rtol=0, atol=most)
    assert abs(picture.position[y, x, 2] - 1) < 1e-6
    along = np.linalg.norm(picture.position[y, x] - (0, 0, 5))
    assert abs(picture.distance[y, x] - along) < 1e-5
    assert picture.polygon[32, 32] == 1 and picture.mask.sum() == (picture.object == 9).sum()
    assert picture.part_names[picture.part[32, 32]] == "quad"
    assert picture.material[32, 32] in picture.material_names


def test_ids_are_those_of_nodes_in_any_order(quad):
    scene = mz.Scene()
    ids = {}
    for id_, x in [(5, -1.0), (None, 0.0), (300, 1.0)]:
        pose = np.diag([0.2, 0.2, 1, 1])
        pose[0, 3] = x
        ids[scene.add(quad, pose=pose, id=id_).id] = x
    assert sorted(ids) == [1, 5, 300]
    picture = scene.render(64, 64, camera=CAMERA, layers=("object", "position"))
    for id_, x in ids.items():
        places = picture.position[picture.object == id_]
        assert len(places) > 10 and abs(places[:, 0].mean() - x) < 0.1
    assert set(np.unique(picture.object)) == {0, 1, 5, 300}


def test_lengths_are_multiplied_by_the_unit(quad):
    scene = mz.Scene([quad], unit=0.001)
    picture = scene.render(32, 32, camera=CAMERA, layers=("depth", "position", "distance"))
    assert abs(picture.depth[16, 16] - 0.005) < 1e-9 and math.isinf(picture.depth[0, 0])
    assert np.abs(picture.position).max() < 0.002


def test_normals_are_in_the_space_of_the_camera_or_of_the_world(quad):
    scene = mz.Scene([quad])
    side = mz.Camera.look_at((4, 0, 4), (0, 0, 0))
    pixel = (16, 16)
    camera = scene.render(32, 32, camera=side, layers=("normal",)).normal[pixel]
    world = scene.render(32, 32, camera=side, layers=("normal",), normals="world").normal[pixel]
    assert np.allclose(world, (0, 0, 1), atol=1e-6)
    assert np.allclose(camera, (-math.sqrt(0.5), 0, math.sqrt(0.5)), atol=1e-6)


def test_layers_do_not_depend_on_samples_and_threads(cam):
    scene = mz.Scene([cam])
    one = scene.render(70, 50, layers=ALL, samples=1, threads=1)
    other = scene.render(70, 50, layers=("color", *ALL), samples=64, threads=3)
    for name in ALL:
        assert np.array_equal(getattr(one, name), getattr(other, name)), name


def test_a_missing_layer_is_named(cam):
    picture = mz.Scene([cam]).render(8, 8, layers=("depth",))
    with pytest.raises(AttributeError, match="no color: name the layer in layers="):
        _ = picture.color
    with pytest.raises(AttributeError, match="has no attribute 'colour'"):
        _ = picture.colour
    assert picture._repr_png_() is None and not hasattr(picture, "normal")
    with pytest.raises(ValueError, match="no colours to save"):
        picture.save("a.png")
