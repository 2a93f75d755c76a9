"""Meshes from files, arrays and trimesh."""

import math
import warnings

import marraztu as mz
import numpy as np
import pytest

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def test_a_file_that_cannot_be_loaded_names_file_line_and_reason(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    with pytest.raises(mz.LoadError, match=r"a\.obj:4: ") as caught:
        mz.Mesh.load(path)
    assert (caught.value.file, caught.value.line) == (str(path), 4)
    assert "9" in caught.value.reason and str(path) not in caught.value.reason
    with pytest.raises(mz.LoadError) as caught:
        mz.Mesh.load(tmp_path / "none.obj")
    assert (caught.value.line, caught.value.reason) == (None, "there is no such file")
    (tmp_path / "a.marraztu").write_text("(version: 1,\n objects: [oops])")
    with pytest.raises(mz.LoadError) as caught:
        mz.Scene.load(tmp_path / "a.marraztu")
    assert caught.value.line == 2 and caught.value.file.endswith("a.marraztu")


def test_findings_are_warnings_at_the_callers_line(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(TRIANGLE + "f 1 2 7\n")
    with pytest.warns(mz.FindingWarning, match="does not have") as caught:
        mesh = mz.Mesh.load(path)
    assert caught[0].filename == __file__ and len(mesh.findings) == len(caught) == 1
    path.write_text(TRIANGLE)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert mz.Mesh.load(path).findings == []


def test_a_load_warns_once_of_all_findings_and_not_at_all_if_they_are_ignored(tmp_path):
    path = tmp_path / "a.obj"
    odd = ["mtllib none.mtl", "usemtl red", "f 1 2 7", "f 1 x 3", "vt 0"]
    for count in (3, 5):
        path.write_text(TRIANGLE + "\n".join(odd[:count]) + "\n")
        with pytest.warns(mz.FindingWarning) as caught:
            mesh = mz.Mesh.load(path)
        assert len(mesh.findings) > 1 and len(caught) == 1
        assert all(finding in str(caught[0].message) for finding in mesh.findings[:5])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warnings.simplefilter("ignore", mz.FindingWarning)
        assert mz.Mesh.load(path).findings and not caught


def test_options_of_files(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(TRIANGLE)
    mesh = mz.Mesh.load(path, up="z", scale=2)
    assert np.allclose(mesh.vertices, [[0, 0, 0], [2, 0, 0], [0, 0, -2]])
    assert np.allclose(mesh.bounds, [[0, 0, -2], [2, 0, 0]])
    for wrong in [{"up": "w"}, {"scale": 0}, {"crease": 4.0}, {"bump_maps": "x"}]:
        with pytest.raises(ValueError, match=next(iter(wrong))):
            mz.Mesh.load(path, **wrong)


def test_stl_files_stand_on_the_plane_of_the_table(tmp_path):
    """As on the command line, z is up in STL files."""
    path = tmp_path / "a.stl"
    corners = ["vertex 0 0 0", "vertex 1 0 0", "vertex 0 2 3"]
    facet = ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    path.write_text("\n".join(["solid a", *facet, "endsolid a"]))
    assert np.allclose(mz.Mesh.load(path).bounds, [[0, 0, -2], [1, 3, 0]])
    assert np.allclose(mz.Mesh.load(path, up="y").bounds, [[0, 0, 0], [1, 2, 3]])


def test_arrays_draw_like_the_same_file(tmp_path):
    rng = np.random.default_rng(1)
    vertices = rng.normal(size=(40, 3))
    faces = rng.permuted(np.tile(np.arange(40), (30, 1)), axis=1)[:, :3]
    lines = [f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in faces + 1]
    path = tmp_path / "a.obj"
    path.write_text("\n".join(lines) + "\n")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mz.FindingWarning)
        file = mz.Scene([mz.Mesh.load(path)]).render(80, 60)
    assert len(np.unique(file.color.reshape(-1, 3), axis=0)) > 50
    for kind in (faces, faces.astype(np.uint64), faces.tolist(), np.asfortranarray(faces)):
        ours = mz.Scene([mz.Mesh(vertices, kind)]).render(80, 60)
        assert np.array_equal(ours.color, file.color)


def test_polygons_of_any_size():
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 2, 0]]
    mesh = mz.Mesh(vertices, [[0, 1, 2, 3], [3, 2, 4]])
    assert len(mesh.triangles) == 3 and "2 polygons" in repr(mesh)
    assert len(mz.Mesh(vertices, np.empty((0, 3), int)).triangles) == 0


def test_textures_and_colors_show_their_own_colours(quad, tmp_path):
    corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
    texture = np.zeros((2, 2, 3), np.uint8)
    texture[0] = 255, 0, 0
    texture[1] = 0, 0, 255
    camera = mz.Camera.look_at((0, 0, 4), (0, 0, 0))
    light = [mz.Light.sun((0, 0, -1))]
    arguments = {"camera": camera, "samples": 1, "filter": "nearest"}
    args = quad.vertices, [[0, 1, 2, 3]]
    textured = mz.Scene([mz.Mesh(*args, uv=corners, texture=texture)], lights=light)
    picture = textured.render(64, 64, **arguments)
    # Row 0 of the texture is above: the uv (0, 0) is the lower left.
    assert tuple(picture.color[24, 32]) == (255, 0, 0)
    assert tuple(picture.color[40, 32]) == (0, 0, 255)
    mz.Scene([quad]).render(4, 4).save(tmp_path / "a.png")
    from_file = mz.Mesh(*args, uv=corners, texture=tmp_path / "a.png")
    assert not np.array_equal(
        mz.Scene([from_file], lights=light).render(64, 64, **arguments).color, picture.color
    )
    bytes_ = mz.Mesh(*args, colors=np.full((4, 4), 128, np.uint8))
    factors = mz.Mesh(*args, colors=np.full((4, 3), 128 / 255))
    shown = [
        mz.Scene([mesh], lights=light).render(64, 64, **arguments) for mesh in (bytes_, factors)
    ]
    assert tuple(shown[0].color[32, 32]) == (128, 128, 128)
    assert np.array_equal(shown[0].color, shown[1].color)


def test_normals_and_creases_change_the_shading():
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]

    def colours(mesh):
        picture = mz.Scene([mesh], lights=[mz.Light.sun((-1, -2, -3))]).render(64, 64, samples=1)
        return len(np.unique(picture.color.reshape(-1, 3), axis=0))

    flat = colours(mz.Mesh(cube, faces, material=mz.Material()))
    smooth = colours(mz.Mesh(cube, faces, material=mz.Material(), crease=3.1))
    given = colours(mz.Mesh(cube, faces, material=mz.Material(), normals=cube - 0.5))
    assert flat <= 4 < 20 < min(smooth, given)


@pytest.mark.parametrize(
    ("vertices", "faces", "more", "words"),
    [
        ([[0, 0]], [[0, 0, 0]], {}, r"vertices needs the shape \(n, 3\)"),
        (np.eye(3), [[0, 1, 3]], {}, "refers to vertex 3, but there are 3"),
        (np.eye(3), [[0, 1, -1]], {}, "refers to vertex -1"),
        (np.eye(3), [[0, 1]], {}, "fewer than 3 corners"),
        (np.eye(3), [[0, 1, 2], [0, 1]], {}, "face 1 has fewer than 3 corners"),
        (np.eye(3), [[0, 1, 2], []], {}, "face 1 has fewer than 3 corners"),
        (np.eye(3), [[0.0, 1.0, 2.0]], {}, "faces are numbers of vertices"),
        (np.eye(3) * np.nan, [[0, 1, 2]], {}, "not finite"),
        (np.eye(3), [[0, 1, 2]], {"uv": [[0, 0]]}, r"uv needs the shape \(3, 2\)"),
        (np.eye(3), [[0, 1, 2]], {"colors": np.ones((3, 2))}, r"colors needs the shape \(3, 3\)"),
        (np.eye(3), [[0, 1, 2]], {"normals": np.full((3, 3), np.inf)}, "not finite"),
        (np.eye(3), [[0, 1, 2]], {"texture": np.ones((2, 2))}, "a picture is a file, an array"),
        (np.eye(3), [[0, 1, 2]], {"material": "unobtainium"}, "no material.*brass"),
        (np.eye(3), [[0, 1, 2]], {"crease": -1}, "crease is from 0 to pi"),
    ],
)
def test_wrong_arrays_have_one_clear_error(vertices, faces, more, words):
    with pytest.raises(ValueError, match=words):
        mz.Mesh(vertices, faces, **more)


def test_meshes_of_trimesh_keep_shape_texture_and_colours(quad):
    trimesh = pytest.importorskip("trimesh", reason="trimesh is missing: from_trimesh is untested")
    image = pytest.importorskip("PIL.Image", reason="Pillow is missing: from_trimesh is untested")
    box = trimesh.creation.box()
    plain = mz.Scene([mz.Mesh.from_trimesh(box)]).render(64, 64)
    direct = mz.Scene([mz.Mesh(box.vertices, box.faces)]).render(64, 64)
    assert np.array_equal(plain.color, direct.color)
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    picture = image.new("RGB", (2, 2), (255, 0, 0))
    visual = trimesh.visual.TextureVisuals(uv=uv, image=picture)
    textured = trimesh.Trimesh(quad.vertices, quad.triangles, visual=visual, process=False)
    light = [mz.Light.sun((0, 0, -1))]
    camera = mz.Camera.look_at((0, 0, 4), (0, 0, 0))

    def centre(mesh):
        scene = mz.Scene([mz.Mesh.from_trimesh(mesh)], lights=light)
        return tuple(scene.render(32, 32, camera=camera, samples=1).color[16, 16])

    assert centre(textured) == (255, 0, 0)
    colored = trimesh.Trimesh(
        quad.vertices, quad.triangles, vertex_colors=[[0, 255, 0, 255]] * 4, process=False
    )
    assert centre(colored) == (0, 255, 0)
    faces = trimesh.creation.box()
    faces.visual = trimesh.visual.ColorVisuals(faces, face_colors=[[0, 0, 255, 255]] * 12)
    assert centre(faces) == (0, 0, 255)
    faces.visual.face_colors[6:] = [255, 0, 0, 255]
    mixed = mz.Mesh.from_trimesh(faces)
    assert 8 < len(mixed.vertices) <= 16 and mixed.triangles.shape == (12, 3)
    with pytest.raises(TypeError, match="not a Scene: use its method to_mesh"):
        mz.Mesh.from_trimesh(trimesh.Scene([box]))


def test_colours_are_integers_or_factors(quad):
    def shown(colors):
        mesh = mz.Mesh(quad.vertices, quad.triangles, colors=colors)
        camera = mz.Camera.look_at((0, 0, 4), (0, 0, 0))
        scene = mz.Scene([mesh], lights=[mz.Light.sun((0, 0, -1))])
        return scene.render(32, 32, camera=camera, samples=1).color[16, 16].tolist()

    expected = shown([[0.25, 0.5, 1.0]] * 4)
    row = [64, 128, 255]
    for integers in ([row] * 4, np.full((4, 3), row, np.uint8), np.full((4, 3), row, np.int64)):
        assert np.abs(np.subtract(shown(integers), expected)).max() <= 1
    for wrong in (300, -1, 1.5, -0.5, math.nan):
        with pytest.raises(ValueError, match="colors are"):
            shown([[wrong, wrong, wrong]] * 4)
    with pytest.raises(ValueError, match="colors are numbers"):
        shown("red")


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"material": 5}, TypeError, "a material is a Material or a name, not int"),
        ({"material": mz.Material(diffuse=0.5)}, ValueError, "diffuse: three numbers"),
        ({"name": 5}, TypeError, "^name: "),
        ({"crease": "x"}, TypeError, "^crease: "),
        ({"faces": None}, ValueError, "faces are lists"),
        ({"vertices": None}, ValueError, "vertices needs the shape"),
    ],
)
def test_errors_name_the_argument(quad, arguments, error, words):
    arrays = {"vertices": quad.vertices, "faces": quad.triangles}
    with pytest.raises(error, match=words):
        mz.Mesh(**{**arrays, **arguments})
