#!/usr/bin/env python3
"""Writes panels.obj with its materials and maps: six panels, each a little bent, each with one map.

Run it in any folder: it writes beside itself.
"""

from math import cos, pi, sin, sqrt
from pathlib import Path
import struct
import zlib

HERE = Path(__file__).parent
SIDE = 64


def png(name, texel):
    """A picture of SIDE x SIDE texels; `texel` gives red, green, blue by column and row from below."""
    rows = []
    for y in reversed(range(SIDE)):
        rows.append(b"\0" + b"".join(bytes(texel(x, y)) for x in range(SIDE)))

    def chunk(kind, content):
        body = kind + content
        return struct.pack(">I", len(content)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", SIDE, SIDE, 8, 2, 0, 0, 0)
    data = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"".join(rows), 9)) + chunk(b"IEND", b"")
    (HERE / name).write_bytes(b"\x89PNG\r\n\x1a\n" + data)


def stud(x, y):
    """The height of round studs, 16 texels apart, from 0 to 1."""
    u, v = x % 16 - 7.5, y % 16 - 7.5
    r = sqrt(u * u + v * v) / 6.5
    return (1 + cos(pi * r)) / 2 if r < 1 else 0.0


def grey(value):
    return [round(255 * value)] * 3


def normal(x, y, gain=5.0):
    """The normal of the studs, green up."""
    dx, dy = (stud(x + 1, y) - stud(x - 1, y)) / 2 * gain, (stud(x, y + 1) - stud(x, y - 1)) / 2 * gain
    length = sqrt(dx * dx + dy * dy + 1)
    return [round(127 * part / length + 128) for part in (-dx, -dy, 1)]


def window(x, y):
    """Lit windows of a dark house."""
    inside = 3 <= x % 16 <= 12 and 3 <= y % 16 <= 12
    lit = (x // 16 * 7 + y // 16 * 5) % 3 != 0
    return [255, 190, 90] if inside and lit else [0, 0, 0]


def ring(x, y):
    u, v = x - 31.5, y - 31.5
    return grey(1.0 if 16 < sqrt(u * u + v * v) < 28 or abs(u) + abs(v) < 9 else 0.0)


def stripes(x, y):
    return grey(1.0 if x // 8 % 2 else 0.08)


PANELS = [
    ("emission", "Kd 0.15 0.15 0.2\nKs 0 0 0\nKe 1 1 1\nmap_Ke windows.png"),
    ("specular", "Kd 0.25 0.05 0.05\nKs 1 1 1\nNs 12\nmap_Ks stripes.png"),
    ("exponent", "Kd 0.05 0.2 0.05\nKs 0.8 0.8 0.8\nNs 120\nmap_Ns stripes.png"),
    ("opacity", "Kd 0.7 0.6 0.3\nKs 0 0 0\nmap_d ring.png"),
    ("bump", "Kd 0.5 0.5 0.55\nKs 0.4 0.4 0.4\nNs 20\nbump -bm 5 studs.png"),
    ("normal", "Kd 0.5 0.5 0.55\nKs 0.4 0.4 0.4\nNs 20\nnorm normals.png"),
]


def panels(steps=6, side=10.0, gap=1.0, depth=1.2):
    lines = ["# Six panels, each with one map. Made by make.py.\n", "mtllib panels.mtl\n"]
    first = 1
    for number, (name, _) in enumerate(PANELS):
        left = (number % 3) * (side + gap) - 1.5 * side - gap
        top = (number // 3) * -(side + gap) + side + gap / 2
        lines.append(f"o {name}\nusemtl {name}\n")
        for row in range(steps + 1):
            for column in range(steps + 1):
                u, v = column / steps, row / steps
                z = depth * sin(pi * u) * sin(pi * v)
                lines.append(f"v {left + side * u:.4f} {top - side + side * v:.4f} {z:.4f}\n")
                lines.append(f"vt {u:.4f} {v:.4f}\n")
        for row in range(steps):
            for column in range(steps):
                a = first + row * (steps + 1) + column
                face = [a, a + 1, a + steps + 2, a + steps + 1]
                lines.append("f " + " ".join(f"{i}/{i}" for i in face) + "\n")
        first += (steps + 1) ** 2
    (HERE / "panels.obj").write_text("".join(lines), encoding="ascii", newline="\n")
    head = "# Made by make.py.\n"
    text = "".join(f"newmtl {name}\nKa 0.05 0.05 0.05\n{body}\n" for name, body in PANELS)
    (HERE / "panels.mtl").write_text(head + text, encoding="ascii", newline="\n")


if __name__ == "__main__":
    panels()
    png("windows.png", window)
    png("stripes.png", stripes)
    png("ring.png", ring)
    png("studs.png", lambda x, y: grey(stud(x, y)))
    png("normals.png", normal)
