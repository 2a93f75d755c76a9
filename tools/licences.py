#!/usr/bin/env python3
"""Writes the packages that the program and the Python module are built from, with their licences:
assets/licences.txt and python/licences.txt.

The lists are those of Cargo.lock without what only tests and benchmarks need, for all platforms."""

import json
import subprocess
from pathlib import Path

root = Path(__file__).resolve().parent.parent
command = ["cargo", "metadata", "--format-version", "1", "--locked"]
metadata = json.loads(subprocess.run(command, cwd=root, check=True, capture_output=True).stdout)
packages = {package["id"]: package for package in metadata["packages"]}
nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
members = {packages[member]["name"]: member for member in metadata["workspace_members"]}


def write(name, path):
    found, waiting = set(), [members[name]]
    while waiting:
        for dependency in nodes[waiting.pop()]["deps"]:
            only_tests = all(kind["kind"] == "dev" for kind in dependency["dep_kinds"])
            if not only_tests and dependency["pkg"] not in found:
                found.add(dependency["pkg"])
                waiting.append(dependency["pkg"])
    lines = []
    # Our own crates have no registry.
    for package in (packages[it] for it in found if packages[it]["source"]):
        licence = package["license"] or f"see {package['license_file']}"
        # Some write "MIT/Apache-2.0", as was usual once.
        licence = " ".join(licence.replace("/", " OR ").split())
        lines.append(f"{package['name']} {package['version']} {licence}\n")
    (root / path).write_text("".join(sorted(lines)))


write("marraztu", "assets/licences.txt")
write("marraztu-python", "python/licences.txt")
