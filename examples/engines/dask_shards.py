#!/usr/bin/env python3
"""Draws a list in parts with Dask: dask_shards.py PARTS OPTIONS OF BATCH ...

Needs `pip install distributed`. DASK_SCHEDULER_ADDRESS names a cluster that shares this folder;
without it, two workers are started here.

Dask repeats the parts of a lost worker, whose program may still run. Both write the same bytes.
"""
import os
import subprocess
import sys
from pathlib import Path

from distributed import Client, LocalCluster


def draw(part, parts, options, folder):
    """Draws a part, and returns the exit status."""
    command = ["marraztu", "batch", *options, "--shard", f"{part}/{parts}", "--resume", "--quiet"]
    command += ["--threads", "1", "--report", f"reports/{part}.jsonl"]
    return subprocess.run(command, cwd=folder).returncode


def main():
    parts, options = int(sys.argv[1]), sys.argv[2:]
    folder = Path.cwd()
    Path("reports").mkdir(exist_ok=True)
    cluster = os.environ.get("DASK_SCHEDULER_ADDRESS") or LocalCluster(2, threads_per_worker=1)
    with Client(cluster) as client:
        tasks = client.map(
            draw, range(parts), parts=parts, options=options, folder=folder, retries=2, pure=False
        )
        statuses = client.gather(tasks)
    # The folder may also hold reports of an earlier run in more parts.
    reports = [f"reports/{part}.jsonl" for part in range(parts)]
    merged = subprocess.run(["marraztu", "merge", *reports, "--out", "report.jsonl"])
    # A part that a signal has killed has a negative status.
    sys.exit(merged.returncode or int(any(statuses)))


if __name__ == "__main__":
    main()
