#!/usr/bin/env python3
"""Answers: what do the small scenes show that teach one axis of accuracy each?

Run as `python3 assets/lessons/make.py`: it writes ball.obj, cushion.obj, plate.obj, wheel.obj and tiles.png beside itself.

The decision: each thing is as coarse as it can be while one still knows what it is, so that a fault of drawing is large:
a ball of 16 by 8 patches, whose highlight falls inside a patch; a cushion of nine patches, whose middle one alone
faces the eye; a square plate; a wheel of 48 spokes, thinner than a pixel at their ends; a picture of 16 by 16 texels.

Space: right-handed, Y up, counter-clockwise faces seen from outside. Standard library only, no chance.
"""

import struct
import zlib
from math import cos, pi, sin
from pathlib import Path

HERE = Path(__file__).parent
HEAD = "# {}\n# Made by the project: written by assets/lessons/make.py, which is the place to change it.\no {}\n"


def number(x):
    return f"{round(x, 4) + 0.0:.4f}".rstrip("0").rstrip(".")


def ball(radius=50, rings=8, segments=16):
    """A ball of patches; half a patch turned, so that a patch and no corner faces +Z."""
    lines = [HEAD.format("ball: 16 by 8 patches", "ball")]
    points = [(0, radius, 0)]
    for ring in range(1, rings):
        polar = pi * ring / rings
        for segment in range(segments):
            angle = 2 * pi * (segment + 0.5) / segments
            points.append((radius * sin(polar) * sin(angle), radius * cos(polar), radius * sin(polar) * cos(angle)))
    points.append((0, -radius, 0))
    lines += ["v " + " ".join(number(c) for c in p) + "\n" for p in points]
    lines += ["vn " + " ".join(number(c / radius) for c in p) + "\n" for p in points]

    def at(ring, segment):
        return 2 + (ring - 1) * segments + segment % segments

    for segment in range(segments):
        faces = [(1, at(1, segment), at(1, segment + 1))]
        for ring in range(1, rings - 1):
            faces.append((at(ring, segment), at(ring + 1, segment), at(ring + 1, segment + 1), at(ring, segment + 1)))
        faces.append((at(rings - 1, segment), len(points), at(rings - 1, segment + 1)))
        lines += ["f " + " ".join(f"{i}//{i}" for i in face) + "\n" for face in faces]
    (HERE / "ball.obj").write_text("".join(lines), encoding="ascii", newline="\n")


def cushion(half=52, inner=34, height=22):
    """A cushion of nine patches that faces +Z: its normals lean outwards at every corner, and at none towards +Z."""
    lines = [HEAD.format("cushion: nine patches that face +Z", "cushion")]
    places = (-half, -inner, inner, half)
    points, normals = [], []
    for y in places:
        for x in places:
            rim = max(abs(x), abs(y)) == half
            points.append((x, y, 0 if rim else height))
            # As those of a ball about a place behind it.
            nx, ny, nz = x, y, 40 if rim else 62
            length = (nx * nx + ny * ny + nz * nz) ** 0.5
            normals.append((nx / length, ny / length, nz / length))
    lines += ["v " + " ".join(number(c) for c in p) + "\n" for p in points]
    lines += ["vn " + " ".join(number(c) for c in n) + "\n" for n in normals]
    for row in range(3):
        for column in range(3):
            first = 1 + 4 * row + column
            face = (first, first + 1, first + 5, first + 4)
            lines.append("f " + " ".join(f"{i}//{i}" for i in face) + "\n")
    (HERE / "cushion.obj").write_text("".join(lines), encoding="ascii", newline="\n")


def plate(half=50):
    """A square in the plane z = 0 that faces +Z, with the whole picture on it."""
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    lines = [HEAD.format("plate: a square that faces +Z", "plate")]
    lines += [f"v {x} {y} 0\n" for x, y in corners]
    lines += [f"vt {u} {v}\n" for u, v in [(0, 0), (1, 0), (1, 1), (0, 1)]]
    lines += ["f 1/1 2/2 3/3 4/4\n"]
    (HERE / "plate.obj").write_text("".join(lines), encoding="ascii", newline="\n")


def wheel(radius=50, spokes=48, width=1.2):
    """Spokes in the plane z = 0 that face +Z: triangles as wide as `width` near the middle, thin outside."""
    lines = [HEAD.format(f"wheel: {spokes} spokes that face +Z", "wheel")]
    points = []
    for spoke in range(spokes):
        angle = 2 * pi * (spoke + 0.37) / spokes
        along, across = (cos(angle), sin(angle)), (-sin(angle), cos(angle))
        for at, side in [(8, -0.5), (radius, 0), (8, 0.5)]:
            points.append([along[i] * at + across[i] * side * width for i in range(2)])
    lines += [f"v {number(x)} {number(y)} 0\n" for x, y in points]
    lines += [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}\n" for i in range(spokes)]
    (HERE / "wheel.obj").write_text("".join(lines), encoding="ascii", newline="\n")


def tiles(side=16):
    """A face in 16 by 16 texels: round, two eyes, a mouth, on a ground of two blues."""
    rows = []
    for y in range(side):
        row = bytearray([0])
        for x in range(side):
            px, py = x - 7.5, y - 7.5
            colour = (60, 90, 170) if (x // 2 + y // 2) % 2 else (40, 60, 130)
            if px * px + py * py < 46:
                colour = (250, 205, 70)
            if y in (5, 6) and x in (5, 10):
                colour = (50, 30, 20)
            if (y == 10 and x in (4, 11)) or (y == 11 and 5 <= x <= 10):
                colour = (170, 40, 40)
            row += bytes(colour)
        rows.append(bytes(row))

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    content = zlib.compress(b"".join(rows), 9)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", content) + chunk(b"IEND", b"")
    (HERE / "tiles.png").write_bytes(png)


if __name__ == "__main__":
    ball()
    cushion()
    plate()
    wheel()
    tiles()
