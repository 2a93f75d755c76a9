"""Scenes, nodes, lights and cameras."""

import math
import pickle
from pathlib import Path

import marraztu as mz
import numpy as np
import pytest

FRONT = mz.Camera.look_at((0, 0, 8), (0, 0, 0), yfov=math.pi / 4)


def test_a_pose_moves_a_node(quad):
    scene = mz.Scene(lights=[mz.Light.ambient()])
    pose = np.eye(4)
    pose[0, 3] = 2
    node = scene.add(quad, pose=pose, material=mz.Material(ambient=(1, 1, 1)), name="sign")
    lit = scene.render(80, 80, camera=FRONT, samples=1).color[..., 0] == 255
    columns = np.flatnonzero(lit.any(axis=0))
    # 8 tan(pi / 8) = 3.31 units are 40 pixels, so the square lies from 1 to 3 units.
    scale = 40 / (8 * math.tan(math.pi / 8))
    assert abs(columns[0] - (40 + scale)) < 1 and abs(columns[-1] + 1 - (40 + 3 * scale)) < 1
    node.pose = np.diag([0.5, 0.5, 0.5, 1])
    lit = scene.render(80, 80, camera=FRONT, samples=1).color[..., 0] == 255
    assert abs(lit.any(axis=0).sum() - scale) <= 1
    assert np.array_equal(node.pose, np.diag([0.5, 0.5, 0.5, 1])) and node.name == "sign"


def test_nodes_are_hidden_removed_and_renamed(quad):
    scene = mz.Scene([quad])
    first = scene.nodes[0]
    second = scene.add(quad, name="other", id=7)
    assert (first.id, second.id) == (1, 7)
    assert scene.add(quad).id == 2
    for wrong, words in [(7, "has the id 7"), (0, "ids start at 1")]:
        with pytest.raises(ValueError, match=words):
            scene.add(quad, id=wrong)
    second.name = "sign"
    assert scene.render(8, 8).names[7] == "sign"
    scene.remove(second)
    assert 7 not in scene.render(8, 8).names and len(scene.nodes) == 2
    with pytest.raises(ValueError, match="not in this scene"):
        scene.remove(second)
    with pytest.raises(ValueError, match="has been removed"):
        second.visible = False
    background = scene.background
    for node in scene.nodes:
        node.visible = False
    assert (scene.render(16, 16).color == background).all()


def test_the_material_of_the_mesh_comes_back(quad):
    scene = mz.Scene([quad])
    node = scene.nodes[0]
    before = scene.render(32, 32).color
    for own in ("file", None):
        node.set_material("gold")
        assert not np.array_equal(scene.render(32, 32).color, before)
        node.set_material(own)
        assert np.array_equal(scene.render(32, 32).color, before)


def test_a_failed_change_changes_nothing(quad):
    scene = mz.Scene([quad])
    node = scene.nodes[0]
    before = scene.render(32, 32).color
    for change in [
        lambda: node.set_material("unobtainium"),
        lambda: node.set_sides("none"),
        lambda: setattr(node, "opacity", 2),
        lambda: setattr(node, "pose", np.eye(3)),
        lambda: setattr(node, "pose", np.eye(4) * np.nan),
        lambda: setattr(scene, "background", (0, 0, 256)),
        lambda: setattr(scene, "background", "blue"),
        lambda: setattr(scene, "exposure", 11),
        lambda: setattr(scene, "line_width", 0.5),
        lambda: setattr(scene, "edges", "all"),
        lambda: setattr(scene, "lights", [mz.Light.sun((0, 0, 0))]),
        lambda: setattr(scene, "lights", [mz.Light("lamp")]),
        lambda: setattr(scene, "lights", [mz.Light("sun")]),
        lambda: setattr(scene, "lights", [mz.Light.bulb((0, 0, 0), attenuation=(0, 0, 0))]),
        lambda: scene.add(quad, opacity=-1),
    ]:
        with pytest.raises(ValueError):
            change()
    assert np.array_equal(scene.render(32, 32).color, before)
    assert len(scene.nodes) == 1 and node.opacity == 1


def test_lights_that_are_read_can_be_written(cam):
    scene = mz.Scene([cam])
    camera = mz.Camera.around(0.3, 0.2)
    lights = scene.lights
    assert sorted(light.kind for light in lights) == ["ambient", "spot", "sun"]
    before = scene.render(64, 48).color
    scene.lights = lights
    assert np.array_equal(scene.render(64, 48).color, before)
    assert scene.lights == lights
    scene.lights = [mz.Light.bulb((1, 2, 3), "#ff8000", attenuation=(1, 0, 0.5))]
    assert scene.lights[0].color == (255, 128, 0) and scene.lights[0].position == (1, 2, 3)
    dark = scene.render(64, 48).color
    assert not np.array_equal(dark, before)
    scene.lights = None
    assert np.array_equal(scene.render(64, 48).color, before)
    assert scene.render(64, 48, camera=camera).color.any()


def test_a_spot_without_a_place_is_held_by_the_camera(quad):
    material = mz.Material(diffuse=(1, 1, 1))
    scene = mz.Scene(lights=[mz.Light.spot(angle=0.2, exponent=0)])
    scene.add(quad, material=material)
    for x in (-1, 0, 1):
        camera = mz.Camera.look_at((x, 0, 4), (0, 0, 0))
        picture = scene.render(65, 65, camera=camera, samples=1)
        assert picture.color[32, 32].max() > 200
    assert picture.color[32, 60].max() < 200


def test_shadows_fall(quad):
    scene = mz.Scene(lights=[mz.Light.sun((0, 0, -1))])
    scene.add(quad, material=mz.Material(diffuse=(1, 1, 1)))
    small = np.diag([0.3, 0.3, 1, 1])
    small[2, 3] = 1
    scene.add(quad, pose=small, material=mz.Material(diffuse=(0, 0, 1)))
    side = mz.Camera.look_at((6, 0, 6), (0, 0, 0))
    lit = scene.render(80, 80, camera=side, samples=1).color
    scene.set_shadows(True)
    shadowed = scene.render(80, 80, camera=side, samples=1).color
    assert (shadowed.astype(int) <= lit).all() and (shadowed < lit).any()
    assert scene.lights[0].shadows


def test_the_axes_of_a_camera_are_stated():
    assert "'opengl'" in repr(mz.Camera(yfov=1))
    K = [[50, 0, 20], [0, 50, 10], [0, 0, 1]]
    camera = mz.Camera(K, convention="opencv")
    assert "'opencv'" in repr(camera) and np.array_equal(camera.K, K)
    assert np.array_equal(camera.pose(), np.eye(4))
    assert np.array_equal(camera.pose("opengl"), np.diag([1, -1, -1, 1]))
    assert np.array_equal(mz.Camera(yfov=1).pose("opencv"), np.diag([1, -1, -1, 1]))
    with pytest.raises(TypeError):
        mz.Camera(K, np.eye(4), "opencv")


def test_opencv_cameras_look_along_z(quad):
    """The same picture from both conventions; x points to the right in both."""
    corner = np.eye(4)
    corner[:3, 3] = 0.8, 0.4, 0
    scene = mz.Scene(lights=[mz.Light.ambient()])
    scene.add(
        quad, pose=corner @ np.diag([0.1, 0.1, 1, 1]), material=mz.Material(ambient=(1, 1, 1))
    )
    K = [[64, 0, 32], [0, 64, 32], [0, 0, 1]]
    world = np.eye(4)
    world[2, 3] = 4
    opengl = scene.render(64, 64, camera=mz.Camera(K, world), samples=1)
    flipped = world @ np.diag([1, -1, -1, 1])
    opencv = scene.render(64, 64, camera=mz.Camera(K, flipped, convention="opencv"), samples=1)
    assert np.array_equal(opengl.color, opencv.color)
    rows, columns = np.nonzero(opengl.color[..., 0] == 255)
    # (0.8, 0.4, -4) is projected to 32 + 64 * 0.8 / 4 and 32 - 64 * 0.4 / 4.
    assert abs(columns.mean() + 0.5 - 44.8) < 0.5 and abs(rows.mean() + 0.5 - 25.6) < 0.5


def test_the_camera_of_a_picture_draws_the_same_pixels(cam):
    scene = mz.Scene([cam])
    for size in [(64, 48), (48, 64)]:
        picture = scene.render(*size)
        K = picture.camera.K
        assert (K[0, 2], K[1, 2]) == (size[0] / 2, size[1] / 2)
        again = scene.render(*size, camera=picture.camera)
        differing = (again.color != picture.color).any(axis=2).mean()
        assert differing < 0.01, differing


def test_a_camera_looks_with_its_own_lens_whatever_the_scene_file_says(tmp_path):
    cameras = [mz.Camera(yfov=0.8, pose=mz.Camera.look_at((1, 2, 4), (0, 0, 0)).pose())]
    cameras += [mz.Camera.around(0.4, 0.3)]

    def pictures(view):
        path = tmp_path / "a.marraztu"
        path.write_text(
            f"""(
                version: 1,
                objects: [(id: 1, name: "ball", model: Own("sphere"), material: Preset("ruby"))],
                cameras: [(id: 2, name: "camera 1", eye: (0.0, 20.0, 160.0))],
                lights: [(id: 3, name: "sun", slot: 1, kind: Sun(direction: (-0.6, -0.8, 0.0)))],
                view: (object: Some(1), camera: 2, {view}),
            )"""
        )
        scene = mz.Scene.load(path)
        return [scene.render(48, 48, camera=camera).rgba.copy() for camera in cameras]

    posed, around = pictures("")
    assert all(len(np.unique(it.reshape(-1, 4), axis=0)) > 10 for it in (posed, around))
    for ours, expected in zip(pictures("observer: Object"), (posed, around), strict=True):
        assert np.array_equal(ours, expected)
    assert np.array_equal(pictures("projection: Orthographic")[0], posed)


def test_a_saved_scene_has_the_same_picture(tmp_path):
    (tmp_path / "roof.obj").write_text("v 0 0 0\nv 2 0 0\nv 1 1 -1\nv 1 0 2\nf 1 4 3\nf 4 2 3\n")
    scene = mz.Scene([mz.Mesh.load(tmp_path / "roof.obj")], background="#203040")
    pose = np.eye(4)
    pose[:3, 3] = (0, 1, 0)
    scene.add(scene.nodes[0].mesh, pose=pose, material="gold", opacity=0.5)
    before = scene.render(64, 48).rgba.copy()
    path = tmp_path / "roofs.marraztu"
    scene.save(path)
    assert np.array_equal(mz.Scene.load(path).render(64, 48).rgba, before)
    content = path.read_bytes()
    # Arrays are in no file, whatever their name.
    for name in ("mesh", "sphere"):
        arrays = mz.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], name=name)
        with pytest.raises(OSError, match="was not loaded from a file"):
            mz.Scene([arrays]).save(path)
    assert path.read_bytes() == content
    with pytest.raises(ValueError, match="choose one in"):
        scene.save(tmp_path / "roofs.obj")


def test_scenes_meshes_and_shots_of_files_are_pickled(tmp_path):
    (tmp_path / "roof.obj").write_text("v 0 0 0\nv 2 0 0\nv 1 1 -1\nv 1 0 2\nf 1 4 3\nf 4 2 3\n")
    mesh = mz.Mesh.load(tmp_path / "roof.obj", scale=2, up="z")
    scene = mz.Scene([mesh], background="#203040", unit=0.5)
    scene.add(mesh, id=7, material="ruby").visible = False
    layers = ("color", "depth", "object")
    shot = scene.shot(64, 48, layers=layers, samples="4")
    before = shot.render()
    again = pickle.loads(pickle.dumps(scene))
    assert [node.id for node in again.nodes] == [1, 7] and again.unit == 0.5
    for picture in (
        again.render(64, 48, layers=layers, samples="4"),
        pickle.loads(pickle.dumps(shot)).render(),
        pickle.loads(pickle.dumps(before)),
    ):
        for layer in ("rgba", "depth", "object"):
            assert np.array_equal(getattr(picture, layer), getattr(before, layer)), layer
    # Automatic lights stay automatic.
    again.add(pickle.loads(pickle.dumps(mesh)), pose=np.diag((9.0, 9, 9, 1)))
    scene.add(mesh, pose=np.diag((9.0, 9, 9, 1)))
    assert np.array_equal(again.render(32, 32).rgba, scene.render(32, 32).rgba)
    arrays = mz.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], name="sphere")
    for it in (arrays, mz.Scene([arrays]), mz.Scene([arrays]).shot(8, 8)):
        with pytest.raises(ValueError, match="was not loaded from a file"):
            pickle.dumps(it)


def test_automatic_lights_of_a_scene_file_are_those_of_models(tmp_path):
    path = tmp_path / "a.marraztu"
    path.write_text(
        """(
            version: 1,
            objects: [(id: 1, name: "ball", model: Own("sphere"), material: Preset("pearl"))],
            cameras: [(id: 2, name: "camera 1", eye: (0.0, 0.0, 4.0))],
            view: (object: Some(1), camera: 2),
        )"""
    )
    scene = mz.Scene.load(path)
    scene.lights = None
    kinds = {light.kind for light in scene.lights}
    assert kinds == {"ambient", "sun", "spot"}, "the bulb of the first scene is far away"
    color = scene.render(48, 48).color
    assert 100 < color[24, 24].max() < 256 and (color[12:36, 12:36] == 255).mean() < 0.1


@pytest.mark.parametrize("size", [(64, 48), (48, 64), (50, 50)])
def test_yfov_is_the_vertical_angle(quad, size):
    picture = mz.Scene([quad]).render(*size, camera=mz.Camera(yfov=0.8))
    focal = size[1] / 2 / math.tan(0.4)
    assert np.allclose(
        picture.camera.K, [[focal, 0, size[0] / 2], [0, focal, size[1] / 2], [0, 0, 1]]
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "by K or by yfov"),
        ({"yfov": 4}, "between 0 and pi"),
        ({"yfov": 1, "pose": np.eye(3)}, "finite 4x4"),
        ({"yfov": 1, "convention": "blender"}, "opengl or opencv"),
        ({"K": np.eye(4)}, "3x3"),
        ({"K": np.diag([50, -60, 1])}, "above 0, not 50.0 and -60.0"),
        ({"K": [[50, 9, 0], [0, 50, 0], [0, 0, 1]]}, "a skew of 9"),
        ({"K": [[50, 0, 0], [9, 50, 0], [0, 0, 1]]}, "K has rows"),
    ],
)
def test_wrong_cameras_have_one_clear_error(arguments, words):
    with pytest.raises(ValueError, match=words):
        mz.Camera(**arguments)


def test_k_projects_points_onto_the_pixels_that_show_them(quad):
    """Two focal lengths and a principal point beside the centre, in both conventions of pixels."""
    scene = mz.Scene([quad])
    pose = mz.Camera.look_at((0.7, 0.4, 3), (0.5, 0.5, 0)).pose("opencv")
    K = np.array([[80, 0, 41.3], [0, 60, 11.7], [0, 0, 1]])
    camera = mz.Camera(K, pose, convention="opencv")
    picture = scene.render(64, 48, camera=camera, layers=("position", "depth", "mask"))
    assert np.allclose(picture.camera.K, K, atol=1e-9)
    rows, columns = np.nonzero(picture.mask)
    assert len(rows) > 100
    points = np.concatenate([picture.position[rows, columns], np.ones((len(rows), 1))], axis=1)
    seen = (K @ (np.linalg.inv(pose) @ points.T)[:3]).T
    assert np.allclose(seen[:, :2] / seen[:, 2:], np.stack([columns, rows], 1) + 0.5, atol=1 / 256)
    assert np.allclose(seen[:, 2], picture.depth[rows, columns], rtol=1e-5)
    K[:2, 2] -= 0.5
    opencv = mz.Camera(K, pose, convention="opencv", pixel_center=0)
    pictures = [scene.render(64, 48, camera=it).color for it in (camera, opencv)]
    assert np.array_equal(*pictures)
    assert "focal=(80, 60), center=(41.3, 11.7)" in repr(camera)


def test_matrices_that_are_no_pose_are_rejected(quad):
    scene = mz.Scene([quad])
    for_rows = mz.Camera.look_at((3, 2, 5), (0, 0, 0)).pose().T
    for pose in (np.diag([2, 2, 2, 1]), np.diag([1, 1, 1, 2]), for_rows):
        with pytest.raises(ValueError, match="a rotation and a position"):
            scene.render(64, 48, camera=mz.Camera(yfov=1, pose=pose))
    with pytest.raises(ValueError, match="not parallel to up"):
        mz.Camera.look_at((0, 1, 0), (0, 0, 0))


def test_an_empty_scene_shows_its_background():
    scene = mz.Scene(background=(1, 2, 3))
    assert (scene.render(9, 9).color == (1, 2, 3)).all()
    assert repr(scene) == "<Scene of nothing>"
    with pytest.raises(TypeError, match="holds objects of Mesh"):
        scene.add("cow.obj")


def test_materials_have_names():
    assert len(mz.Material.names()) == 19
    gold = mz.Material.named("gold")
    assert gold.diffuse == (0.75164, 0.60648, 0.22648) and gold.exponent == 51.2
    with pytest.raises(ValueError, match="unobtainium"):
        mz.Material.named("unobtainium")


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"camera": 5}, TypeError, "camera is a Camera, not int"),
        ({"width": -1}, ValueError, "from 1 to 16384"),
        ({"threads": -1}, ValueError, "at least 0"),
        ({"layers": ["dept"]}, ValueError, "no layer"),
    ],
)
def test_wrong_arguments_of_render_are_named(quad, arguments, error, words):
    with pytest.raises(error, match=words):
        mz.Scene([quad]).render(**{"width": 8, "height": 8, **arguments})


def test_one_layer_may_be_named_without_a_tuple(quad):
    assert mz.Scene([quad]).render(8, 8, layers="depth").depth.shape == (8, 8)


def test_wrong_lights_backgrounds_units_shots_and_pixels_are_rejected(quad):
    scene = mz.Scene([quad])
    with pytest.raises(TypeError, match="objects of Light"):
        scene.lights = [5]
    with pytest.raises(ValueError, match="from 0 to 255"):
        scene.lights = [mz.Light("ambient", color=(300, 0, 0))]
    for color in (5, (1, 2), (0.5, 0.5, 0.5), "#+1+2+3", "#zzzzzz", "red"):
        with pytest.raises(ValueError, match="a colour is three bytes"):
            scene.background = color
    scene.background = "#f08"
    assert scene.background == (255, 0, 136)
    with pytest.raises(ValueError, match=r"is a model: use Scene\(\[Mesh.load"):
        mz.Scene.load("a.obj")
    with pytest.raises(ValueError, match="is a scene"):
        mz.Mesh.load("a.marraztu")
    for unit in (0, -1, math.nan, math.inf, "cm"):
        with pytest.raises(ValueError, match="a unit is"):
            scene.unit = unit
    assert scene.unit == 1
    with pytest.raises(TypeError, match="render_many draws shots"):
        next(mz.render_many([5]))
    with pytest.raises(IndexError, match="pixel -1,0 is outside"):
        scene.explain(-1, 0, 8, 8)


def test_a_panorama_is_the_background_and_lights(tmp_path, quad):
    sky = tmp_path / "sky.png"
    mz.Scene(background=(10, 120, 240)).render(8, 4).save(sky)
    scene = mz.Scene([quad])
    scene.lights = [mz.Light.sky(panorama=sky, turn=0.5, shadows=True)]
    (light,) = scene.lights
    assert (Path(light.panorama), light.turn, light.shown) == (sky, pytest.approx(0.5), True)
    picture = scene.render(32, 24)
    assert tuple(picture.color[0, 0]) == (10, 120, 240)
    red, green, blue = (int(channel) for channel in picture.color[12, 16])
    assert red < green < blue, "the square is lit by the blue sky"
    scene.lights = [light._replace(shown=False)]
    assert tuple(scene.render(32, 24).color[0, 0]) == scene.background
    with pytest.raises(mz.LoadError, match=r"none\.hdr"):
        scene.lights = [mz.Light.sky(panorama="none.hdr")]
    assert scene.lights == [light._replace(shown=False)]
