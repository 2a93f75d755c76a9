#!/usr/bin/env python3
"""Writes assets/licences.txt: each package that the program is built from, with its licence.

The list is that of Cargo.lock without what only tests and benchmarks need, for all platforms."""

import json
import subprocess
from pathlib import Path

root = Path(__file__).resolve().parent.parent
command = ["cargo", "metadata", "--format-version", "1", "--locked"]
metadata = json.loads(subprocess.run(command, cwd=root, check=True, capture_output=True).stdout)
packages = {package["id"]: package for package in metadata["packages"]}
nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
start = metadata["resolve"]["root"]

found, waiting = set(), [start]
while waiting:
    for dependency in nodes[waiting.pop()]["deps"]:
        only_tests = all(kind["kind"] == "dev" for kind in dependency["dep_kinds"])
        if not only_tests and dependency["pkg"] not in found:
            found.add(dependency["pkg"])
            waiting.append(dependency["pkg"])

# Our own crates have no registry.
found = {package for package in found if packages[package]["source"]}

lines = []
for package in (packages[identity] for identity in found):
    licence = package["license"] or f"see {package['license_file']}"
    # Some write "MIT/Apache-2.0", as was usual once.
    licence = " ".join(licence.replace("/", " OR ").split())
    lines.append(f"{package['name']} {package['version']} {licence}\n")
(root / "assets" / "licences.txt").write_text("".join(sorted(lines)))
