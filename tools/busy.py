"""Compares the laboratory on an idle and on a busy machine.

    python3 tools/busy.py PROGRAM COMMAND ...

Measures the first scene three times, then three times beside COMMAND, such as a build, which has to
run long enough and is left to end. In a run, one choice is faster than another if their intervals
do not overlap. Prints for how many pairs of choices the runs agree. The exit status is 1 if two
runs order a pair in opposite ways.
"""

import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

RUNS = 3


def intervals(program):
    """Returns the interval of each choice's time relative to the default, and the noise."""
    with tempfile.TemporaryDirectory() as folder:
        words = [program, "lab", "--quick", "--quiet", "--out", folder]
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
        report = json.loads((pathlib.Path(folder) / "report.json").read_text())
    floor = report["floor"]
    found = {}
    for point in report["points"]:
        low, high = point["ratio"]["interval"]
        middle = point["ratio"]["quartiles"]["median"]
        least = [middle / (1 + floor), middle * (1 + floor)]
        found[point["name"]] = (min(low, least[0]), max(high, least[1]))
    return found, floor


def order(run, a, b):
    """Returns -1 if `a` is faster, 1 if `b` is, 0 if the run does not tell."""
    return (run[a][0] > run[b][1]) - (run[a][1] < run[b][0])


def measure(program, words, wait):
    runs = []
    for _ in range(RUNS):
        run, floor = intervals(program)
        runs.append(run)
        print(f"{words}: noise of the default against itself {100 * floor:.1f}%", flush=True)
        if wait and wait.poll() is not None:
            sys.exit("tools/busy.py: the command has ended before the measurement")
    return runs


def main(program, command):
    idle = measure(program, "idle", None)
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as load:
        busy = measure(program, "busy", load)
    pairs = list(itertools.combinations(idle[0], 2))
    told = {pair: {order(run, *pair) for run in idle} for pair in pairs}
    sure = [pair for pair in pairs if told[pair] in ({-1}, {1})]
    opposed_idle = [pair for pair in pairs if {-1, 1} <= told[pair]]
    counts = {"same": 0, "not told": 0, "opposite": 0}
    opposed = []
    for pair in sure:
        [wanted] = told[pair]
        for run in busy:
            found = order(run, *pair)
            counts["same" if found == wanted else "opposite" if found else "not told"] += 1
            if found == -wanted:
                opposed.append(pair)
    print(f"{len(pairs)} pairs of choices; all idle runs tell the order of {len(sure)}")
    print(f"idle runs that contradict each other: {len(opposed_idle)} pairs")
    print("these pairs in the busy runs:", ", ".join(f"{what} {n}" for what, n in counts.items()))
    for a, b in dict.fromkeys(opposed + opposed_idle):
        times = [[(run[a], run[b]) for run in runs] for runs in (idle, busy)]
        print(f"  {a} / {b}: idle {times[0]}; busy {times[1]}")
    sys.exit(1 if opposed or opposed_idle else 0)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
