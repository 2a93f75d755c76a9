"""Pictures and their arrays."""

import io
import math
import sys
import threading

import marraztu as mz
import numpy as np
import pytest


def test_arrays_are_memory_of_the_renderer(cam):
    picture = mz.Scene([cam]).render(64, 48)
    assert (picture.color.shape, picture.color.dtype) == ((48, 64, 3), np.uint8)
    assert picture.color.base is not None and np.shares_memory(picture.color, picture.rgba)
    owner = picture.rgba
    while isinstance(owner, np.ndarray):
        assert not owner.flags.owndata
        owner = owner.base
    assert type(owner).__name__ == "PySliceContainer"
    picture.rgba[0, 0] = 7
    assert (picture.color[0, 0] == 7).all()


def test_a_picture_outlives_later_pictures(cam):
    scene = mz.Scene([cam])
    first = scene.render(64, 48)
    before = first.rgba.copy()
    background = scene.background
    scene.background = "#ff0000"
    second = scene.render(64, 48)
    assert np.array_equal(first.rgba, before)
    assert not np.array_equal(second.rgba, before)
    scene.background = background
    assert np.array_equal(scene.render(64, 48).rgba, before)


@pytest.mark.parametrize("preset", [None, "draft"])
@pytest.mark.parametrize("threads", [1, 2, 3])
def test_pictures_do_not_depend_on_threads_or_history(cam, threads, preset):
    scene = mz.Scene([cam])
    expected = mz.Scene([cam]).render(90, 70, preset=preset).rgba
    for size in [(33, 20), (90, 70), (91, 70), (90, 70)]:
        picture = scene.render(*size, threads=threads, preset=preset)
    assert np.array_equal(picture.rgba, expected)


def test_a_notebook_shows_a_png(cam):
    picture = mz.Scene([cam]).render(32, 24)
    png = picture._repr_png_()
    assert png.startswith(b"\x89PNG") and mz.Scene([cam])._repr_png_().startswith(b"\x89PNG")
    image = pytest.importorskip("PIL.Image", reason="Pillow is missing: no decoder")
    assert np.array_equal(np.asarray(image.open(io.BytesIO(png))), picture.color)
    assert np.array_equal(np.asarray(picture.pil()), picture.color)


def test_transparent_pictures_have_alpha(quad):
    scene = mz.Scene([quad])
    picture = scene.render(32, 32, transparent=True, camera=mz.Camera.look_at((0, 0, 5), (0, 0, 0)))
    assert picture.rgba[0, 0, 3] == 0 and picture.rgba[16, 16, 3] == 255


def test_saved_pictures_come_back_and_no_other_file_is_replaced(cam, tmp_path):
    picture = mz.Scene([cam]).render(32, 24)
    picture.save(tmp_path / "a.png")
    assert mz.testing.difference(picture, tmp_path / "a.png") == (0, 0, 0.0)
    (tmp_path / "poem.png").write_text("Roses are red")
    with pytest.raises(OSError, match="not a picture"):
        picture.save(tmp_path / "poem.png")
    with pytest.raises(OSError, match="has to end in"):
        picture.save(tmp_path / "a.tiff")
    picture.save(tmp_path / "a.npz")
    picture.save(tmp_path / "B.NPZ")
    for name in ("a.npz", "B.NPZ"):
        assert np.array_equal(np.load(tmp_path / name)["color"], picture.color)


def test_wrong_arguments_have_one_clear_error(cam):
    scene = mz.Scene([cam])
    for arguments, words in [
        ({"width": 0}, "from 1 to 16384"),
        ({"preset": "best"}, "there is no preset 'best'|\"best\".*draft"),
        ({"samples": 5}, 'samples is not "5"; write 1, 4'),
        ({"filters": "nearest"}, 'no axis "filters".*filter'),
        ({"threads": 5000}, "at most 1024"),
        ({"layers": ("colour",)}, 'no layer "colour".*depth'),
        ({"normals": "object"}, "normals is camera or world"),
    ]:
        with pytest.raises(ValueError, match=words):
            scene.render(**{"width": 8, "height": 8, **arguments})
    with pytest.raises((OverflowError, ValueError)):
        scene.render(-1, 8)
    with pytest.raises(TypeError):
        scene.render("a", 8)


def test_render_many_is_ordered_and_bounded(cam):
    scene = mz.Scene([cam])
    drawn, taken, most = 0, 0, 0

    def shots():
        nonlocal taken, most
        for i in range(30):
            taken += 1
            most = max(most, taken - drawn)
            yield scene.shot(16 + i, 16, camera=mz.Camera.around(i / 5), samples=1)

    for i, picture in enumerate(mz.render_many(shots(), threads=2, ahead=3)):
        drawn += 1
        assert picture.width == 16 + i
        alone = scene.render(16 + i, 16, camera=mz.Camera.around(i / 5), samples=1, threads=1)
        assert np.array_equal(picture.rgba, alone.rgba)
    assert drawn == 30 and most <= 2 + 3 + 1


def test_render_many_stops_early_and_passes_errors_on(cam):
    scene = mz.Scene([cam])

    def endless():
        for i in range(10**9):
            assert i < 100, "the shots are taken before they are needed"
            yield scene.shot(16, 16)

    many = mz.render_many(endless())
    assert next(many).width == 16
    many.close()

    def fails():
        yield from (scene.shot(16 + i, 16) for i in range(5))
        raise KeyError("mine")

    # The pictures before the error come first.
    drawn = []
    with pytest.raises(KeyError, match="mine"):
        drawn.extend(picture.width for picture in mz.render_many(fails(), ahead=20))
    assert drawn == [16, 17, 18, 19, 20]
    with pytest.raises(ValueError):
        mz.render_many([], ahead=-1)


def test_a_shot_does_not_follow_the_scene(cam):
    scene = mz.Scene([cam])
    shot = scene.shot(32, 32)
    before = shot.render().rgba
    scene.nodes[0].visible = False
    assert np.array_equal(shot.render().rgba, before)
    assert not np.array_equal(scene.render(32, 32).rgba, before)


def test_python_runs_while_pictures_are_drawn(cam):
    """Another thread counts in steps far shorter than the picture takes."""
    scene = mz.Scene([cam])
    interval = sys.getswitchinterval()
    counts = []

    def draw():
        scene.render(2000, 2000, samples=64, threads=1)
        counts.append(None)

    thread = threading.Thread(target=draw)
    # Without releasing the lock, this thread would wait until the picture is done.
    sys.setswitchinterval(60)
    try:
        thread.start()
        steps = 0
        while not counts:
            threading.Event().wait(0.001)
            steps += 1
    finally:
        sys.setswitchinterval(interval)
        thread.join()
    assert steps > 10


def test_scenes_of_several_threads_do_not_disturb_each_other(cam, quad):
    scenes = [mz.Scene([cam]), mz.Scene([quad])]
    expected = [scene.render(50, 40).rgba for scene in scenes]
    failures = []

    def draw(which):
        for _ in range(20):
            if not np.array_equal(scenes[which].render(50, 40).rgba, expected[which]):
                failures.append(which)

    threads = [threading.Thread(target=draw, args=(i % 2,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures


def test_an_explained_colour_is_the_sum_of_its_terms(cam):
    scene = mz.Scene([cam])
    picture = scene.render(64, 48, samples=1)
    explanation = scene.explain(32, 24, 64, 48)
    assert explanation.color == tuple(picture.color[24, 32])
    total = np.sum([value for _, value in explanation.terms], axis=0)
    assert np.allclose(np.clip(np.round(total), 0, 255), explanation.color, atol=1)
    assert explanation.surface.object == scene.nodes[0].id
    polygons = scene.render(64, 48, layers=("polygon",)).polygon
    assert explanation.surface.polygon == polygons[24, 32]
    assert "clamped and rounded" in str(explanation)
    draft = scene.render(64, 48, preset="draft")
    explanation = scene.explain(33, 25, 64, 48, preset="draft")
    assert explanation.color == tuple(draft.color[25, 33])
    assert "pixel 33,25" in str(explanation) and "half the size" in str(explanation)
    assert scene.explain(0, 0, 64, 48).surface is None
    with pytest.raises(IndexError, match="outside of 64 x 48"):
        scene.explain(64, 0, 64, 48)


def test_a_plan_counts_pixels_and_gives_reasons(cam):
    plan = mz.Scene([cam]).plan(64, 48)
    surfaces = next(effect for effect in plan if effect.effect == "Surfaces")
    assert surfaces.is_on and surfaces.on == "cam" and 0 < surfaces.pixels < 64 * 48
    texture = next(effect for effect in plan if effect.effect == "Textures")
    assert not texture.is_on and texture.why


def test_settings_for_a_budget_keep_to_it_and_serve_other_pictures(cam):
    scene = mz.Scene([cam])
    fit = scene.shot(96, 64).fitted(error=20)
    assert fit.is_reached and fit.error <= 20
    low, high = fit.error_interval
    assert low <= fit.error <= high and fit.milliseconds > 0
    again = scene.render(96, 64, **fit.accuracy)
    assert np.array_equal(fit.shot.render().rgba, again.rgba)
    assert not scene.shot(96, 64).fitted(within=1e-9).is_reached
    for wrong in ({}, {"within": 5, "error": 1}, {"error": 0}, {"within": float("nan")}):
        with pytest.raises(ValueError, match=r"one of within|a number above 0"):
            scene.shot(96, 64).fitted(**wrong)


def test_the_axes_are_arguments(cam):
    axes = {axis.name: axis for axis in mz.axes()}
    assert "nearest" in axes["filter"].choices and "shadow_method" in axes
    scene = mz.Scene([cam])
    for axis in axes.values():
        assert scene.render(8, 8, **{axis.name: axis.choices[0]}).width == 8


def test_angles_are_radians(quad):
    """A square of side 2 at distance 1 / tan(fov / 2) fills the picture."""
    distance = 1 / math.tan(0.4)
    camera = mz.Camera.look_at((0, 0, distance), (0, 0, 0), yfov=0.8)
    scene = mz.Scene([quad])
    picture = scene.render(100, 100, camera=camera, transparent=True)
    assert (picture.rgba[..., 3] == 255).all()
    smaller = scene.render(
        100,
        100,
        transparent=True,
        camera=mz.Camera.look_at((0, 0, distance * 1.05), (0, 0, 0), yfov=0.8),
    )
    assert smaller.rgba[50, 0, 3] == 0 and smaller.rgba[50, 50, 3] == 255
