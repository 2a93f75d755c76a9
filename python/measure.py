"""Measures pictures from Python: python measure.py MODEL [PROGRAM]

Prints the least time of a small picture, the gain of a second thread, and the memory of a picture.
With the program (`marraztu`), the same picture is also timed without Python. Other programs on the
machine only add time, so the least of alternating runs counts.
"""

import re
import resource
import subprocess
import sys
import tempfile
import threading
import time

import marraztu as mz

SIDE = 256
PICTURES = 100
ROUNDS = 7


def seconds(work):
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def draw(shot):
    for _ in range(PICTURES):
        shot.render(threads=1)


def draw_in_threads(shot, count):
    threads = [threading.Thread(target=draw, args=(shot,)) for _ in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def of_program(program, model, samples):
    """The milliseconds of a picture by the program's own clock."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "render", model, "--size", str(SIDE), "--samples", str(samples)]
        command += ["--threads", "1", "--report", "--out", f"{folder}/a.png"]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(re.search(r"([\d.]+) ms a picture", done.stdout + done.stderr)[1])


def measure(scene, samples, model, program):
    def shot():
        return scene.shot(SIDE, SIDE, samples=samples)

    kept = shot()
    draw(kept)
    warm = min(seconds(lambda: kept.render(threads=1)) for _ in range(3 * PICTURES))
    fresh = min(seconds(lambda: shot().render(threads=1)) for _ in range(PICTURES))
    print(f"{samples} samples: {1000 * warm:.2f} ms, with a new shot {1000 * fresh:.2f} ms")
    if program:
        ms = min(of_program(program, model, samples) for _ in range(3))
        print(f"{samples} samples: {ms:.2f} ms in the program")
    times = {1: [], 2: []}
    for _ in range(ROUNDS):
        for count, list_ in times.items():
            list_.append(seconds(lambda count=count: draw_in_threads(kept, count)))
    gain = 2 * min(times[1]) / min(times[2])
    print(f"{samples} samples: two threads of Python are {gain:.2f} times as fast as one")


def main(model, program=None):
    mesh = mz.Mesh.load(model)
    scene = mz.Scene([mesh])
    print(f"{mesh}, {SIDE} x {SIDE} pixels, one thread")
    for samples in (1, 16):
        measure(scene, samples, model, program)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    picture = scene.render(8000, 8000, samples=1, threads=1)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(f"a picture of {picture.rgba.nbytes / 1e6:.0f} MB adds {(after - before) / 1e3:.0f} MB")


if __name__ == "__main__":
    main(*sys.argv[1:])
