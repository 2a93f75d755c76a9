"""The examples of docs/python.md and of the module run, and the notebook is current."""

import json
import shutil

import marraztu as mz
import pytest
from conftest import ROOT


def blocks(text):
    return [part.split("```")[0] for part in text.split("```python\n")[1:]]


def test_the_examples_of_the_page_run(tmp_path, monkeypatch, capsys, assets):
    shutil.copytree(assets, tmp_path / "assets")
    monkeypatch.chdir(tmp_path)
    examples = blocks((ROOT / "docs" / "python.md").read_text(encoding="utf-8"))
    assert len(examples) >= 9
    names = {}
    for example in examples:
        exec(compile(example, "docs/python.md", "exec"), names)
    assert "there is no such file" in capsys.readouterr().out
    for written in ("x_wing.png", "two.png", "layers.npz", "view-7.png"):
        assert (tmp_path / written).stat().st_size > 100, written


def test_the_example_of_the_readme_runs(tmp_path, monkeypatch, assets):
    shutil.copy(assets / "cam.obj", tmp_path / "cow.obj")
    monkeypatch.chdir(tmp_path)
    (example,) = blocks((ROOT / "python" / "README.md").read_text(encoding="utf-8"))
    names = {}
    exec(compile(example, "README.md", "exec"), names)
    assert names["picture"].depth.shape == (480, 640)


def test_the_cells_of_the_notebook_run(monkeypatch):
    pytest.importorskip("PIL", reason="Pillow is missing: the notebook is untested")
    folder = ROOT / "python" / "notebooks"
    notebook = json.loads((folder / "what_accuracy_costs.ipynb").read_text(encoding="utf-8"))
    assert len(notebook["cells"]) == 10
    monkeypatch.chdir(folder)
    names = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)


def test_every_public_name_is_documented():
    for name in mz.__all__:
        value = getattr(mz, name)
        if callable(value):
            assert value.__doc__, name
            for member, attribute in vars(value).items():
                is_public = not member.startswith("_") and hasattr(attribute, "__doc__")
                if is_public and (callable(attribute) or isinstance(attribute, property)):
                    assert attribute.__doc__ or hasattr(attribute, "__func__"), f"{name}.{member}"
