"""Compares with other programs that draw many pictures without a graphics card.

    xvfb-run -a python peers.py PROGRAM MODEL [MODEL ...]

PROGRAM is `marraztu`. Needs the packages marraztu, f3d and pyrender, Debian's libegl1 and
libgl1-mesa-dri (llvmpipe), and its program f3d, which needs a display. Each model is drawn from 48
views around it, 256 x 256 pixels, one sample each, in a process that has drawn one picture before.
The scenes are alike, not equal: one mesh, its own normals, one light or the program's usual ones.
"""

import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time

SIDE = 256
VIEWS = 48
ANGLES = [2 * math.pi * i / VIEWS for i in range(VIEWS)]


def marraztu(model, _program):
    import marraztu as mz

    scene = mz.Scene([mz.Mesh.load(model)])
    return lambda angle: (
        scene.render(SIDE, SIDE, samples=1, camera=mz.Camera.around(angle, 0.3), threads=1).color
    )


def pyrender(model, _program):
    os.environ["PYOPENGL_PLATFORM"] = "egl"
    import numpy as np

    np.infty = np.inf  # pyrender 0.1.45 was written for NumPy 1
    import pyrender
    import trimesh

    mesh = trimesh.load(model, force="mesh")
    middle, reach = mesh.bounds.mean(axis=0), float(np.linalg.norm(np.ptp(mesh.bounds, axis=0)))
    scene = pyrender.Scene(ambient_light=[0.2] * 3)
    scene.add(pyrender.Mesh.from_trimesh(mesh))
    camera = pyrender.PerspectiveCamera(yfov=0.8, znear=0.01 * reach, zfar=10 * reach)
    camera = scene.add(camera)
    light = scene.add(pyrender.DirectionalLight(intensity=3.0))
    renderer = pyrender.OffscreenRenderer(SIDE, SIDE)

    def draw(angle):
        pose = np.eye(4)
        pose[:3, :3] = [
            [math.cos(angle), 0, math.sin(angle)],
            [0, 1, 0],
            [-math.sin(angle), 0, math.cos(angle)],
        ]
        pose[:3, 3] = middle + 1.3 * reach * pose[:3, 2]
        scene.set_pose(camera, pose)
        scene.set_pose(light, pose)
        return renderer.render(scene)[0]

    return draw


def f3d(model, _program):
    import f3d
    import numpy as np

    f3d.Log.set_verbose_level(f3d.Log.VerboseLevel.ERROR)
    engine = f3d.Engine.create_egl()
    engine.window.size = (SIDE, SIDE)
    engine.scene.add(model)
    camera = engine.window.camera
    camera.reset_to_bounds()

    def draw(_angle):
        camera.azimuth(360 / VIEWS)
        return np.asarray(engine.window.render_to_image().content)

    return draw


def processes(command):
    """One process per picture; `command` gets the model, the angle in degrees and the file."""

    def start(model, program):
        folder = tempfile.mkdtemp()

        def draw(angle):
            out = os.path.join(folder, "picture.png")
            words = command(program, model, math.degrees(angle), out)
            subprocess.run(words, check=True, capture_output=True, timeout=60)
            os.remove(out)

        return draw

    return start


def f3d_process(_program, model, angle, out):
    view = f"--camera-azimuth-angle={angle}"
    return ["f3d", model, "--output", out, f"--resolution={SIDE},{SIDE}", view]


def marraztu_process(program, model, angle, out):
    # Whole degrees to the right of the front, and up.
    view = f"{angle:.0f},17"
    words = [program, "render", model, "--out", out, "--size", str(SIDE), "--samples", "1"]
    return [*words, "--from", view, "--quiet"]


PEERS = {
    "marraztu, Python, one thread": marraztu,
    "pyrender, EGL": pyrender,
    "f3d's wheel, EGL": f3d,
    "marraztu, a process each": processes(marraztu_process),
    "f3d, a process each": processes(f3d_process),
}


def measure(name, model, program):
    """Prints the median milliseconds of a picture after the first one."""
    draw = PEERS[name](model, program)
    draw(0.0)
    # Slow programs get fewer pictures.
    times, end = [], time.perf_counter() + 20
    for angle in ANGLES:
        start = time.perf_counter()
        draw(angle)
        times.append(time.perf_counter() - start)
        if times[-1] + time.perf_counter() > end:
            break
    print(json.dumps(1000 * statistics.median(times)))


def main(program, models):
    lines = []
    for model in models:
        for name in PEERS:
            words = [sys.executable, __file__, "--one", name, model, program]
            done = subprocess.run(words, capture_output=True, text=True)
            if done.returncode:
                reason = done.stderr.strip().splitlines()
                print(f"{name}: {reason[-1] if reason else 'failed'}", file=sys.stderr)
                continue
            lines.append((os.path.basename(model), name, float(done.stdout.split()[-1])))
            print(f"{lines[-1][0]:28} {name:30} {lines[-1][2]:9.2f} ms", flush=True)
    own = {model: ms for model, name, ms in lines if name == next(iter(PEERS))}
    for name in PEERS:
        ratios = [ms / own[model] for model, other, ms in lines if other == name and model in own]
        if ratios:
            mean = statistics.geometric_mean(ratios)
            print(f"{name:30} {mean:9.1f} times the time of {next(iter(PEERS))}")


if __name__ == "__main__":
    if sys.argv[1] == "--one":
        measure(*sys.argv[2:])
    else:
        main(sys.argv[1], sys.argv[2:])
