"""marraztu.testing."""

import marraztu as mz
import numpy as np
import pytest
from marraztu.testing import assert_same, difference


@pytest.fixture
def golden(cam, tmp_path):
    picture = mz.Scene([cam]).render(48, 32)
    picture.save(tmp_path / "logo.png")
    return picture, tmp_path / "logo.png"


def test_the_same_picture_passes_and_writes_nothing(golden):
    picture, path = golden
    for same in (picture, picture.rgba, picture.color, path, str(path)):
        assert_same(same, path)
    assert [entry.name for entry in path.parent.iterdir()] == ["logo.png"]


def test_another_picture_fails_and_writes_what_differs(golden, tmp_path):
    picture, path = golden
    changed = picture.rgba.copy()
    changed[3, 4, 1] ^= 5
    with pytest.raises(AssertionError, match="in 1 pixels, by up to") as caught:
        assert_same(changed, path, out=tmp_path / "failed")
    written = {entry.name for entry in (tmp_path / "failed").iterdir()}
    assert written == {"logo.actual.png", "logo.diff.png", "logo.html"}
    assert str(tmp_path / "failed" / "logo.html") in str(caught.value)
    assert difference(tmp_path / "failed" / "logo.actual.png", changed).largest == 0
    page = (tmp_path / "failed" / "logo.html").read_text()
    assert page.count("data:image/png;base64,") == 3 and "1 pixels differ" in page
    assert difference(path, picture).largest == 0, "the expected picture is never changed"
    step = difference(changed, picture).largest
    assert_same(changed, path, max=step)
    with pytest.raises(AssertionError):
        assert_same(changed, path, max=step - 1, out=tmp_path / "failed")


def test_what_cannot_be_compared_is_an_error_of_the_test(golden, cam, tmp_path):
    picture, _ = golden
    with pytest.raises(ValueError, match="JPEG changes the pixels"):
        assert_same(picture, tmp_path / "logo.jpg")
    with pytest.raises(ValueError, match="a number of steps from 0 on"):
        assert_same(picture, tmp_path / "logo.png", max=-1)
    with pytest.raises(ValueError, match="no colours to compare"):
        assert_same(mz.Scene([cam]).render(8, 8, layers="depth"), tmp_path / "logo.png")
    with pytest.raises(AssertionError, match="is not a file"):
        assert_same(picture, tmp_path)
    with pytest.raises(ValueError, match="for the arrays of all layers"):
        picture.save(tmp_path / "logo.exr")


def test_flip_limits_what_a_viewer_sees(golden, tmp_path):
    picture, path = golden
    slight = np.where(picture.rgba > 128, picture.rgba - 1, picture.rgba)
    strong = np.where(picture.rgba > 64, picture.rgba - 60, picture.rgba)
    assert_same(slight, path, flip=0.05)
    with pytest.raises(AssertionError, match="FLIP"):
        assert_same(strong, path, flip=0.05, out=tmp_path / "failed")
    with pytest.raises(AssertionError):
        assert_same(strong, path, flip=0.99, max=2, out=tmp_path / "failed")


def test_sizes_and_missing_files_are_told(golden, tmp_path):
    picture, path = golden
    with pytest.raises(AssertionError, match=r"has 40x32 pixels, .* 48x32"):
        assert_same(picture.rgba[:, :40], path)
    with pytest.raises(AssertionError, match="MARRAZTU_WRITE_GOLDEN=1 writes it"):
        assert_same(picture, tmp_path / "new.png")
    with pytest.raises(ValueError, match="shapes"):
        difference(picture, picture.rgba[:9])


def test_expected_pictures_are_written_on_request(golden, tmp_path, monkeypatch):
    picture, _ = golden
    monkeypatch.setenv("MARRAZTU_WRITE_GOLDEN", "1")
    assert_same(picture, tmp_path / "folder" / "new.png")
    monkeypatch.delenv("MARRAZTU_WRITE_GOLDEN")
    assert_same(picture, tmp_path / "folder" / "new.png")


def test_differences_are_counted_by_hand():
    a = np.zeros((2, 3, 4), np.uint8)
    a[..., 3] = 255
    b = a.copy()
    b[0, 1] = 9, 0, 0, 255
    b[1, 2] = 0, 0, 4, 255
    found = difference(a, b)
    assert (found.largest, found.pixels) == (9, 2) and 0 < found.flip < 1
