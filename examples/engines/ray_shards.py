#!/usr/bin/env python3
"""Draws a list in parts with Ray Data: ray_shards.py PARTS OPTIONS OF BATCH ...

Needs `pip install "ray[data]"`. RAY_ADDRESS names a cluster that shares this folder; without it,
Ray starts here. A pool of one actor can hang if the actor exits (ray-project/ray#62746).
"""
import subprocess
import sys
from pathlib import Path

import ray


class Painter:
    """An actor that draws parts."""

    def __init__(self, parts, options, folder):
        self.parts, self.options, self.folder = parts, options, folder

    def __call__(self, batch):
        return {"part": batch["item"], "status": [self.draw(part) for part in batch["item"]]}

    def draw(self, part):
        """Draws a part, and returns the exit status."""
        command = ["marraztu", "batch", *self.options, "--shard", f"{part}/{self.parts}"]
        command += ["--resume", "--quiet", "--threads", "1", "--report", f"reports/{part}.jsonl"]
        return subprocess.run(command, cwd=self.folder).returncode


def main():
    parts, options = int(sys.argv[1]), sys.argv[2:]
    Path("reports").mkdir(exist_ok=True)
    # The list is in memory: a task that reads it would wait for a core that the actors hold.
    drawn = ray.data.from_items(list(range(parts)), override_num_blocks=parts).map_batches(
        Painter,
        fn_constructor_args=(parts, options, Path.cwd()),
        batch_size=1,
        num_cpus=1,
        compute=ray.data.ActorPoolStrategy(min_size=2, max_size=max(2, parts)),
    )
    statuses = [row["status"] for row in drawn.take_all()]
    # The folder may also hold reports of an earlier run in more parts.
    reports = [f"reports/{part}.jsonl" for part in range(parts)]
    merged = subprocess.run(["marraztu", "merge", *reports, "--out", "report.jsonl"])
    # A part that a signal has killed has a negative status.
    sys.exit(merged.returncode or int(any(statuses)))


if __name__ == "__main__":
    main()
