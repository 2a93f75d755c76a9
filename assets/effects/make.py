#!/usr/bin/env python3
"""Writes panels.obj with its materials and maps: six panels, each a little bent, each with one map;
and evening.hdr, a panorama of fields under a low sun.

Run it in any folder: it writes beside itself.
"""

from math import cos, frexp, ldexp, pi, sin, sqrt
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


def hdr(name, width, height, light):
    """A Radiance picture; `light` gives red, green, blue by column and row from above."""

    def texel(color):
        most = max(color)
        _, exponent = frexp(most)
        scale = ldexp(256, -exponent)
        return [*(min(int(channel * scale), 255) for channel in color), exponent + 128]

    def packed(numbers):
        """Run-length encoding: runs of 3 or more equal numbers, and stretches of others."""
        out, others, i = b"", b"", 0
        while i < len(numbers):
            run = 1
            while i + run < len(numbers) and run < 127 and numbers[i + run] == numbers[i]:
                run += 1
            if run >= 3 or len(others) == 128:
                out += (bytes([len(others)]) + others if others else b"")
                others = b""
            if run >= 3:
                out += bytes([128 + run, numbers[i]])
                i += run
            else:
                others += bytes([numbers[i]])
                i += 1
        return out + (bytes([len(others)]) + others if others else b"")

    content = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    for y in range(height):
        texels = [texel(light(x, y)) for x in range(width)]
        content += bytes([2, 2, width >> 8, width & 255])
        for channel in range(4):
            content += packed([texel[channel] for texel in texels])
    (HERE / name).write_bytes(content)


def evening(x, y, width=512, height=256):
    """Light of a clear evening, by column and row of a panorama."""
    turn, fall = 2 * pi * ((x + 0.5) / width - 0.5), pi * (y + 0.5) / height
    direction = sin(fall) * sin(turn), cos(fall), -sin(fall) * cos(turn)
    low = pi / 2 - 0.24
    sun = sin(low) * sin(0.9), cos(low), -sin(low) * cos(0.9)
    near = sum(a * b for a, b in zip(direction, sun))
    hills = 0.035 + 0.03 * sin(3 * turn + 1) + 0.018 * sin(8 * turn) + 0.008 * sin(21 * turn + 2)
    up = direction[1]
    land = min(max((hills - up) * height / pi + 0.5, 0.0), 1.0)
    if land > 0:
        # Fields: furrows that meet at the horizon, lighter near it.
        furrow = 0.5 + 0.5 * sin(2.2 / (0.06 - min(up, 0.0)) + 5 * sin(turn))
        shade = 0.55 + 0.25 * furrow + 0.3 * max(near, 0.0) ** 4
        fields = [channel * shade for channel in (0.20, 0.19, 0.08)]
        if land == 1:
            return [round(channel, 3) for channel in fields]
    height_part = min(max(up, 0.0), 1.0) ** 0.55
    color = [a + (b - a) * height_part for a, b in zip((0.95, 0.62, 0.40), (0.10, 0.22, 0.55))]
    glow = max(near, 0.0)
    color = [c + g * (0.9 * glow**24 + 0.35 * glow**6) for c, g in zip(color, (1.0, 0.62, 0.28))]
    cloud = sin(9 * up + 2 * sin(turn * 2)) * sin(3 * turn + 6 * up) + 0.5 * sin(7 * turn - 11 * up)
    veil = max(0.0, cloud - 0.4) * (1 - height_part) * 0.7
    color = [c + veil * v for c, v in zip(color, (0.9, 0.55, 0.45))]
    if near > 0.9993:
        color = [620.0, 480.0, 300.0]
    elif near > 0.998:
        color = [c + 12 * v for c, v in zip(color, (1.0, 0.8, 0.5))]
    if land > 0:
        color = [c + land * (f - c) for c, f in zip(color, fields)]
    return [round(channel, 3) for channel in color]


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
    hdr("evening.hdr", 512, 256, evening)
