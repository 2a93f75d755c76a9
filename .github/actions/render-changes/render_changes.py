#!/usr/bin/env python3
"""Draws the models and scenes that differ between a commit and HEAD, before and after:

    render_changes.py BASE OUT [OPTIONS OF BATCH ...]

OUT/index.html shows the pictures, and the summary of the job lists them. The exit status is 1 if a
changed model can no longer be drawn.

All models of the commit are drawn. At HEAD, --resume then draws only models that have changed,
directly or by a material or a texture.
"""
import html
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import quote

PATTERNS = [f":(icase)*.{ending}" for ending in ("obj", "obj.gz", "stl", "stl.gz", "marraztu")]
PAGE = "<!doctype html><meta charset=utf-8><title>Changed models</title>\n"
STYLE = "<style>body { font: 16px sans-serif } td { vertical-align: top }</style>\n"


def git(*arguments, folder="."):
    result = subprocess.run(["git", "-C", folder, *arguments], stdout=subprocess.PIPE, text=True)
    # Git has written the reason.
    return result.stdout if result.returncode == 0 else sys.exit(result.returncode)


def draw(folder, out, options):
    """Draws the models below a folder, and returns their lines of the report by name."""
    models = [name for name in git("ls-files", "-z", *PATTERNS, folder=folder).split("\0") if name]
    if not models:
        return {}
    # Artifacts allow few characters in names.
    rows = [{"file": name, "out": f"{out}/{quote(name)}.png"} for name in models]
    rows = "".join(json.dumps(row) + "\n" for row in rows)
    report = out.with_suffix(".jsonl")
    command = ["marraztu", "batch", "--list", "-", "--resume", "--quiet", "--report", report, *options]
    status = subprocess.run(command, cwd=folder, input=rows, text=True).returncode
    # 1: some models cannot be drawn, as the report says.
    if status not in (0, 1):
        sys.exit(status)
    lines = [json.loads(line) for line in report.read_text().splitlines()]
    return {line["in"]: line for line in lines if "in" in line}


def change(before, after, difference):
    """Describes the change of a model. `None` if its pictures are equal."""
    if not before:
        return "added" if not after["error"] else after["error"]
    if not after:
        return "removed"
    if after["error"] or before["error"]:
        same = after["in_sha256"] == before["in_sha256"]
        return None if same else after["error"] or "repaired"
    if after["out_sha256"] == before["out_sha256"]:
        return None
    command = ["marraztu", "compare", before["out"], after["out"], "--out", difference]
    result = subprocess.run(command, capture_output=True, text=True)
    return (result.stdout or result.stderr) if result.returncode else None


def main():
    base, out, options = sys.argv[1], Path(sys.argv[2]).resolve(), sys.argv[3:]
    if not shutil.which("marraztu"):
        sys.exit("error: the program marraztu is not on the PATH")
    shutil.rmtree(out, ignore_errors=True)
    (out / "difference").mkdir(parents=True)
    with tempfile.TemporaryDirectory() as folder:
        git("worktree", "add", "--detach", folder, base)
        try:
            before = draw(folder, out / "before", options)
        finally:
            git("worktree", "remove", "--force", folder)
    # A base of broken models has no pictures.
    if (out / "before").exists():
        shutil.copytree(out / "before", out / "after")
    after = draw(".", out / "after", options)
    rows, cells, broken = [], [], False
    for number, name in enumerate(sorted({*before, *after})):
        lines = [before.get(name), after.get(name)]
        difference = out / "difference" / f"{number}.png"
        text = change(*lines, difference)
        if text is None:
            continue
        broken |= bool(lines[1] and lines[1]["error"])
        drawn = [Path(line["out"]) for line in lines if line and not line["error"]]
        paths = [path.relative_to(out) for path in [*drawn, difference] if path.exists()]
        pictures = "".join(f'<td>{path.parts[0]}<br><img src="{quote(str(path))}">' for path in paths)
        row = f"<tr><td>{html.escape(name)}<td><pre>{html.escape(text.strip())}</pre>"
        cells.append(row + "</tr>\n")
        rows.append(f"{row}{pictures}</tr>\n")
    # The summary of a job cannot show the pictures of an artifact.
    print(f"changed models: {len(rows)}")
    (out / "index.html").write_text(f"{PAGE}{STYLE}<table>{''.join(rows)}</table>\n")
    if summary := os.environ.get("GITHUB_STEP_SUMMARY"):
        with open(summary, "a") as file:
            file.write(f"Changed models: {len(rows)}\n\n<table>{''.join(cells)}</table>\n")
    sys.exit(broken)


if __name__ == "__main__":
    main()
