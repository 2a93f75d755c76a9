"""Forks, spawned processes and the import."""

import os
import subprocess
import sys
import textwrap

import pytest

HEAD = """
import os, threading, time
import marraztu as mz
mesh = mz.Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2, 3]])
scene = mz.Scene([mesh])
"""


def run(code, *, head=HEAD, limit=60):
    """Runs a program in a new process. A hang fails by the time limit."""
    code = textwrap.dedent(head) + textwrap.dedent(code)
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, timeout=limit
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")


@needs_fork
def test_a_child_of_a_fork_draws_the_same_picture():
    output = run(
        """
        expected = scene.render(200, 200, threads=4).rgba.tobytes()
        for threads in (1, 4, None):
            child = os.fork()
            if child == 0:
                same = scene.render(200, 200, threads=threads).rgba.tobytes() == expected
                new = mz.Scene([mz.Mesh(mesh.vertices, [[0, 1, 2]])]).render(50, 50)
                os._exit(0 if same and new.width == 50 else 1)
            assert os.waitpid(child, 0)[1] == 0
        assert scene.render(200, 200, threads=4).rgba.tobytes() == expected
        print("done")
        """
    )
    assert output == "done\n"


@needs_fork
def test_a_fork_while_another_thread_draws_raises_an_error_that_names_spawn():
    output = run(
        """
        large = {"samples": 256, "threads": 1}
        thread = threading.Thread(target=scene.render, args=(8000, 8000), kwargs=large)
        thread.start()
        time.sleep(0.3)
        child = os.fork()
        if child == 0:
            calls = [
                lambda: scene.render(8, 8),
                lambda: scene.background,
                lambda: mz.Mesh(mesh.vertices, [[0, 1, 2]]),
                lambda: list(mz.render_many([])) or scene.shot(8, 8),
            ]
            for call in calls:
                try:
                    call()
                except RuntimeError as error:
                    assert "spawn" in str(error), error
                else:
                    os._exit(1)
            os._exit(0)
        assert thread.is_alive(), "the picture was drawn too early"
        status = os.waitpid(child, 0)[1]
        print(status)
        os._exit(0)
        """
    )
    assert output.strip() == "0"


def test_processes_that_are_spawned_draw(tmp_path):
    path = tmp_path / "job.py"
    path.write_text(
        textwrap.dedent(
            """
            import multiprocessing
            import marraztu as mz

            def draw(size):
                mesh = mz.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
                return mz.Scene([mesh]).render(size, size).rgba.tobytes()

            if __name__ == "__main__":
                with multiprocessing.get_context("spawn").Pool(2) as pool:
                    assert pool.map(draw, [20, 30]) == [draw(20), draw(30)]
            """
        )
    )
    subprocess.run([sys.executable, path], check=True, timeout=60)


def test_the_import_loads_neither_numpy_nor_pools():
    """NumPy takes longer to load than everything else."""
    code = (
        "import sys, marraztu\n"
        "print({'numpy', 'PIL', 'concurrent.futures', 'trimesh'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


@pytest.mark.skipif(os.name == "nt", reason="processes of Windows get no SIGINT")
def test_ctrl_c_during_the_first_picture_raises_keyboard_interrupt(tmp_path):
    model = tmp_path / "a.obj"
    model.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    # Nothing loads NumPy before the picture.
    head = f"""
        import os, signal, sys, threading, time
        import marraztu as mz
        scene = mz.Scene([mz.Mesh.load({str(model)!r})])
        """
    output = run(
        """
        def interrupt():
            # Python itself may lose an interrupt while it imports.
            loads = True
            while loads:
                time.sleep(0.01)
                spec = getattr(sys.modules.get("numpy"), "__spec__", None)
                loads = getattr(spec, "_initializing", True)
            # The picture takes longer.
            time.sleep(0.5)
            os.kill(os.getpid(), signal.SIGINT)

        # Background jobs of a shell ignore it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        threading.Thread(target=interrupt).start()
        try:
            scene.render(8000, 8000, samples=256, threads=1)
            time.sleep(30)
        except KeyboardInterrupt:
            print("interrupted")
        """,
        head=head,
    )
    assert output == "interrupted\n"


@pytest.mark.skipif(sys.platform != "linux", reason="the limit of memory is that of Linux")
def test_layers_without_memory_raise_memory_error():
    output = run(
        """
        import resource
        scene.render(64, 64, layers=("color", "normal"), threads=1)
        used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + (1 << 30),) * 2)
        try:
            scene.render(16384, 16384, layers=("normal", "position"), threads=1)
        except MemoryError as error:
            print(error)
        print(scene.render(64, 64, layers=("depth",), threads=1).depth.shape)
        """
    )
    assert output == "there is not enough memory for 16384 x 16384 pixels\n(64, 64)\n"


def test_ctrl_c_ends_a_picture_that_would_take_minutes():
    output = run(
        """
        import _thread, signal
        # A background job of a shell ignores Ctrl+C.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        mesh = mz.Mesh([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2, 3]])
        scene = mz.Scene([mesh] * 200)
        for threads in (1, 2):
            for more in ({}, {"layers": ("color", "depth")}, {"transparent": True}):
                threading.Timer(0.5, _thread.interrupt_main).start()
                try:
                    scene.render(9000, 9000, samples=256, threads=threads, **more)
                except KeyboardInterrupt:
                    print("interrupted")
        scene.render(20, 20)
        """,
        limit=100,
    )
    assert output == "interrupted\n" * 6
