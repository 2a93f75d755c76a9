#!/usr/bin/env python3
"""Answers: what do the three models that every new scene starts with look like, and are they sound?

Run as `python3 assets/models.py`: it writes x_wing.obj, r_falke.obj and cam.obj beside itself, after checking them.

The decision: a model is a pile of closed solids that reach into one another, not one welded skin. A loft, a lathe and
a plate are each watertight by construction, so the only operation on a face that is needed is the inset, which draws a
face in and lifts or sinks it: panels, frames, glazing and nozzles are all insets. No `vn` is written. The editor takes
the mean of the unit normals around a `v`, so a crease is made by giving its two sides different `v`s: `corners` below
does that from one angle per solid. The ships are seen from behind first, under a sun straight above and a lamp at the
camera; hence the bevels of about 45 degrees that look back and up, and the deep nozzles.

Space: right-handed, Y up, nose to -Z, counter-clockwise faces seen from outside. Standard library only, no chance.
"""

from math import acos, cos, degrees, hypot, pi, radians, sin, sqrt
from pathlib import Path

DIGITS = 4  # decimals in the files, and the grid on which two positions are the same

# ---------------------------------------------------------------------------------------------------------- vectors


def add(a, b, k=1.0):
    """a + k b"""
    return (a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return add((0, 0, 0), a, 1 / sqrt(dot(a, a)))


def mean(points):
    return tuple(sum(p[i] for p in points) / len(points) for i in range(3))


def newell(face):
    """The polygon's normal, twice its area long."""
    n = (0.0, 0.0, 0.0)
    for p, q in zip(face, face[1:] + face[:1]):
        n = add(n, cross(p, q))
    return n


def snap(p):
    return tuple(round(c, DIGITS) + 0.0 for c in p)


def mix(a, b, t):
    return a + (b - a) * t


def curve(knots, t):
    """Smooth interpolation (Catmull-Rom on uneven knots) of rows (t, value, value, ...), in order of t."""
    i = max(j for j in range(len(knots) - 1) if knots[j][0] <= t or j == 0)
    a, b = knots[i], knots[i + 1]
    before, after = knots[max(i - 1, 0)], knots[min(i + 2, len(knots) - 1)]
    h = b[0] - a[0]
    u = (t - a[0]) / h
    row = []
    for k in range(1, len(a)):
        m0 = (b[k] - before[k]) / (b[0] - before[0]) * h
        m1 = (after[k] - a[k]) / (after[0] - a[0]) * h
        row.append(
            (2 * u**3 - 3 * u**2 + 1) * a[k]
            + (u**3 - 2 * u**2 + u) * m0
            + (3 * u**2 - 2 * u**3) * b[k]
            + (u**3 - u**2) * m1
        )
    return row


# ----------------------------------------------------------------------------------------------------------- solids


class Solid:
    """One closed skin: faces by key, so that a face can be found again and inset."""

    def __init__(self, faces, crease):
        self.faces = faces
        self.crease = crease  # degrees: a sharper edge is shown sharp
        if self.volume() < 0:
            self.faces = {key: face[::-1] for key, face in faces.items()}

    def volume(self):
        return sum(dot(face[0], newell(face)) for face in split(self.faces.values())) / 6

    def inset(self, key, margin, lift=0.0):
        """Draws a face in by `margin` and lifts it (or sinks it, if negative). The key stays with the inner face."""
        outer, inner = self.faces[key], []
        n = unit(newell(outer))
        for i, p in enumerate(outer):
            before = cross(n, unit(sub(p, outer[i - 1])))
            after = cross(n, unit(sub(outer[(i + 1) % len(outer)], p)))
            inner.append(add(add(p, add(before, after), margin / (1 + dot(before, after))), n, lift))
        for i in range(len(outer)):
            j = (i + 1) % len(outer)
            self.faces[key + ("rim", len(self.faces))] = [outer[i], outer[j], inner[j], inner[i]]
        self.faces[key] = inner
        return self

    def moved(self, where):
        """A copy with every point p at where(p)."""
        return Solid({key: [where(p) for p in face] for key, face in self.faces.items()}, self.crease)

    def mirrored(self):
        return self.moved(lambda p: (-p[0], p[1], p[2]))


def both(*solids):
    """The solids and their mirror images: left and right."""
    return [s for solid in solids for s in (solid, solid.mirrored())]


def split(faces):
    """Quadrilaterals that are not flat become two triangles, along the shorter diagonal. Larger polygons are flat."""
    for face in faces:
        if len(face) == 4 and unflatness(face) > 8e-4:
            a, b, c, d = face
            if dot(sub(a, c), sub(a, c)) > dot(sub(b, d), sub(b, d)):
                a, b, c, d = b, c, d, a
            yield [a, b, c]
            yield [a, c, d]
        else:
            yield face


def unflatness(face):
    """The largest distance of a corner from the polygon's mean plane, over the polygon's size."""
    n, centre = unit(newell(face)), mean(face)
    size = max(sqrt(dot(d, d)) for d in (sub(p, centre) for p in face))
    return max(abs(dot(n, sub(p, centre))) for p in face) / size


def loft(rings, crease=30.0):
    """A skin over rings of equally many points; a ring of one point is an apex, an end ring of more is a cap."""
    faces = {}
    for i, (a, b) in enumerate(zip(rings, rings[1:])):
        n = max(len(a), len(b))
        for j in range(n):
            k = (j + 1) % n
            if len(a) == 1:
                faces[(i, j)] = [a[0], b[k], b[j]]
            elif len(b) == 1:
                faces[(i, j)] = [a[j], a[k], b[0]]
            else:
                faces[(i, j)] = [a[j], a[k], b[k], b[j]]
    if len(rings[0]) > 1:
        faces[("first",)] = rings[0][::-1]
    if len(rings[-1]) > 1:
        faces[("last",)] = list(rings[-1])
    return Solid(faces, crease)


def lathe(profile, n, crease=30.0, turn=0.5):
    """A solid of revolution about Z from (radius, z) pairs; `turn` is the first corner's angle in n-ths of a circle."""
    rings = []
    for r, z in profile:
        angles = [2 * pi * (i + turn) / n for i in range(n)]
        rings.append([(r * cos(a), r * sin(a), z) for a in angles] if r else [(0.0, 0.0, z)])
    return loft(rings, crease)


def octagon(w, top, bottom, z, cut):
    """An upright rectangle at z with its corners cut."""
    return [
        (w, top - cut, z), (w - cut, top, z), (cut - w, top, z), (-w, top - cut, z), (-w, bottom + cut, z),
        (cut - w, bottom, z), (w - cut, bottom, z), (w, bottom + cut, z),
    ]


def box(w, bottom, top, z0, z1, cut, crease=10.0):
    """A box with all its edges cut."""
    return loft(
        [
            octagon(w - cut, top - cut, bottom + cut, z0, cut * 0.6),
            octagon(w, top, bottom, z0 + cut, cut),
            octagon(w, top, bottom, z1 - cut, cut),
            octagon(w - cut, top - cut, bottom + cut, z1, cut * 0.6),
        ],
        crease,
    )


def ridge(base, stations):
    """A bar along Z with cut shoulders, from (z, half width, top) rows."""
    rings = []
    for z, w, top in stations:
        half = [(w, base), (w, top - 1.1), (w * 0.48, top)]
        rings.append([(x, y, z) for x, y in half] + [(-x, y, z) for x, y in half[::-1]])
    return loft(rings, 11)


def polar(r, angle, y):
    """A point of the disc: angle in degrees from the stern (+Z) towards +X."""
    return (r * sin(radians(angle)), y, r * cos(radians(angle)))


# ----------------------------------------------------------------------------------------------------------- x_wing


def x_wing():
    """A long ship: a needle with a sharp chine that rounds into three engines, and four curved blades for wings."""

    def section(z, w, top, bottom, round_, y):
        """Twelve points; `round_` goes from 0 (steep flanks, a flat keel, a sharp chine between) to 1 (an ellipse)."""
        ring = []
        for i in range(12):
            c, s = cos(2 * pi * i / 12), sin(2 * pi * i / 12)
            h = max(0.0, 1 - abs(c) ** mix(3.6 if s > 0 else 1.4, 2, round_)) ** mix(1, 0.5, round_)
            ring.append((w * c, y + (top if s > 0 else -bottom) * h, z))
        return ring

    # z, half width, height above and below the chine, roundness, height of the chine
    knots = [
        (-56, 0.9, 0.7, 0.6, 0.6, -1.2), (-48, 2.6, 1.7, 1.4, 0.3, -1.0), (-34, 5.0, 3.2, 2.4, 0.0, -0.6),
        (-14, 7.6, 5.0, 3.6, 0.0, -0.2), (6, 9.4, 6.0, 4.6, 0.2, 0.0), (24, 9.0, 6.6, 5.6, 0.7, 0.0),
        (40, 7.4, 6.4, 5.8, 1.0, 0.0),
    ]
    rings = [[(0.0, -1.25, -62.0)]]
    for z, step in [
        (-56, 1), (-49, 1), (-48.4, 1.1), (-40, 1.03), (-28, 1), (-14, 1), (-5, 1), (-4.4, 1.06), (5, 1.05),
        (14, 1.05), (14.8, 0.96), (27, 0.98), (39, 1),
    ]:
        w, top, bottom, round_, y = curve(knots, z)
        rings.append(section(z, w * step, top * step, bottom * step, round_, y))
    w, top, bottom, round_, y = curve(knots, 40)
    rings.append(section(41.2, w - 1.2, top - 1.2, bottom - 1.2, round_, y))
    hull = loft(rings, 28)
    for strip in (8, 9):  # flank panels behind the step
        for j in (0, 5):
            hull.inset((strip, j), 0.7, -0.5)

    # the canopy: flat panes, each sunk in its frame
    panes = [[(0.0, 1.8, -37.0)]]
    for z, w, top in [(-31, 1.8, 4.4), (-24, 2.7, 6.7), (-16, 2.9, 7.6), (-8, 2.3, 7.5)]:
        base = 1.2
        panes.append(
            [
                (w * c, base + (top - base) * s, z)
                for c, s in [
                    (1.0, 0.0), (0.95, 0.5), (0.55, 0.92), (0.0, 1.0), (-0.55, 0.92), (-0.95, 0.5), (-1.0, 0.0),
                ]
            ]
        )
    panes.append([(x * 0.55, y - 1.4, 1.0) for x, y, _ in panes[-1]])
    canopy = loft(panes, 8)
    for strip in (1, 2, 3):
        for j in (1, 2, 3, 4):
            canopy.inset((strip, j), 0.32, -0.4)

    # the spine from the canopy to the engines
    spine = ridge(2.0, [(-3, 1.6, 7.0), (4, 2.2, 8.3), (26, 2.0, 9.0), (38, 1.5, 8.4), (44, 0.9, 5.6)])
    for key in ((0, 2), (1, 2)):
        spine.inset(key, 0.5, -0.3)

    parts = {"hull": [hull], "canopy": [canopy], "spine": [spine]}

    # the wings: a blade swept along a curve in XY; chord, sweep and thickness shrink towards the tip
    def wing(path, lead, chord, thick):
        blade = [(0.0, 0.0), (0.16, 0.5), (0.78, 0.5), (1.0, 0.16), (1.0, -0.16), (0.78, -0.5), (0.16, -0.5)]
        (x0, y0), (x1, y1), (x2, y2) = path
        stations = []
        for t in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0):
            x = mix(mix(x0, x1, t), mix(x1, x2, t), t)
            y = mix(mix(y0, y1, t), mix(y1, y2, t), t)
            dx, dy = mix(x1 - x0, x2 - x1, t), mix(y1 - y0, y2 - y1, t)
            nx, ny = -dy / hypot(dx, dy), dx / hypot(dx, dy)
            z, c, h = mix(lead[0], lead[1], t**1.25), mix(chord[0], chord[1], t**0.8), mix(thick[0], thick[1], t)
            # the trailing edge hangs by an eighth of the chord, to show the blade's upper side to an eye behind it
            rise = [h * v - (u - 0.45) * c * 0.12 for u, v in blade]
            stations.append([(x + nx * e, y + ny * e, z + c * u) for e, (u, v) in zip(rise, blade)])
        # the tip: drawn in and swept on, so that the blade ends in a bevel
        last = stations[-1]
        m = mean(last)
        stations.append(
            [
                (mix(p[0], m[0], 0.5) + dx * 0.018, mix(p[1], m[1], 0.5) + dy * 0.018, mix(p[2], m[2], 0.3) + 1.6)
                for p in last
            ]
        )
        solid = loft(stations, 11)
        for k in (1, 2):
            solid.inset((k, 1), 0.6, 0.4)
            solid.inset((k, 5), 0.6, 0.4)
        # a slim body through the blade where the curve turns up: it rounds off the trailing edge
        m, z = mean(stations[3]), [p[2] for p in stations[3]]
        body = lathe(
            [
                (0, min(z) - 5),
                (1.5, min(z) + 4),
                (1.5, max(z) - 2),
                (1.3, max(z) + 1.5),
                (0.8, max(z) + 1.5),
                (0, max(z) + 6),
            ],
            8,
        )
        return [solid, body.moved(lambda p: (p[0] + m[0], p[1] + m[1], p[2]))]

    upper = wing([(8.0, 2.0), (27.0, 5.5), (43.0, 27.0)], (0.0, 38.0), (41.0, 9.0), (4.4, 1.1))
    lower = wing([(8.0, -2.0), (24.0, -4.5), (36.0, -22.0)], (4.0, 34.0), (36.0, 8.0), (3.8, 1.0))
    parts["wings_upper"] = both(*upper)
    parts["wings_lower"] = both(*lower)

    # engines: spinner, duct, lip, shell with one step, nozzle, bell, plug - one profile each
    side = lathe(
        [
            (0, 3.5), (1.9, 8.5), (3.7, 8.5), (4.0, 3.6), (4.6, 3.6), (5.3, 10), (5.3, 32), (4.8, 32.6),
            (4.8, 35.4), (5.3, 36), (4.3, 47), (3.8, 47.0), (3.2, 42.5), (1.7, 42.5), (0, 47.5),
        ],
        14,
    )
    parts["engines_side"] = both(side.moved(lambda p: (p[0] + 11.6, p[1], p[2])))
    parts["engine_main"] = [
        lathe(
            [
                (6.8, 38), (6.9, 42.5), (6.2, 43.2), (6.2, 44.4), (6.9, 45.1), (6.4, 49), (5.6, 53.0), (5.0, 53.0),
                (4.6, 48.5), (3.9, 46.5), (2.2, 46.5), (1.5, 50), (0, 54.0),
            ],
            18,
        )
    ]
    return {part: [s.moved(lambda p: (p[0], p[1] - 1, p[2] - 13)) for s in solids] for part, solids in parts.items()}


# ---------------------------------------------------------------------------------------------------------- r_falke


def r_falke():
    """A flat round ship, after the falcon: shingled plates for plumage, talons around a beak that holds the cockpit."""
    n = 32
    profile = [
        (14, -8.0), (30, -6.2), (31, -5.0), (44.0, -3.2), (45.4, -1.9), (45.4, -1.1), (44.0, -0.8), (44.0, 0.8),
        (45.4, 1.1), (45.4, 1.9), (43.6, 3.8), (32.4, 5.8), (31.0, 7.8), (19.0, 10.0), (17.4, 12.0), (12, 12.4),
    ]
    hull = loft([[polar(r, 360 * i / n, y) for i in range(n)] for r, y in profile], 25)
    parts = {"hull": [hull]}

    # plumage: each feather is a flat plate that lies on the cone, so that a row of them stands in steps
    def feather(angle, half, r0, r1, y0, y1, thick):
        """Lies along the line from (r0, y0) to (r1, y1) at `angle`; `half` is half its width in degrees."""
        shoulder = mix(r0, r1, 0.68)
        shape = [(r0, -0.9), (r0, 0.9), (shoulder, 0.9), (r1, 0.34), (r1, -0.34), (shoulder, -0.9)]
        slope = (y1 - y0) / (r1 - r0)

        def ring(draw, lift):
            pts = []
            for r, a in shape:
                x, _, z = polar(r, a * half, 0)
                z, x = mix(z, (r0 + r1) / 2, draw), mix(x, 0, draw)
                pts.append((x, y0 + slope * (z - r0) + lift * (1 if y0 > 0 else -1), z))
            return pts

        plate = loft([ring(0, -1.2), ring(0.07, thick)], 5)
        c, s = cos(radians(angle)), sin(radians(angle))
        return plate.moved(lambda p: (p[0] * c + p[2] * s, p[1], p[2] * c - p[0] * s))

    plumage = []
    for i in (0, 1, 2, 3, 4, 5, 14, 15, 16, 17, 18, 19):  # the outer row, open for the talons and for the engines
        plumage.append(feather(-133 + 14 * i, 7, 31.0, 44.2, 6.1, 4.2, 1.1))
    for i in range(14):  # the inner row, over the outer one's roots
        plumage.append(feather(-123.5 + 19 * i, 9.5, 18.0, 34.6, 10.4, 7.6, 1.3))
    parts["plumage"] = plumage
    parts["belly"] = [feather(-150 + 30 * i, 15, 15.0, 31.2, -8.0, -6.2, 0.9) for i in range(11)]

    # the crown in the middle, above and below
    upright = lambda p: (p[0], p[2], -p[1])
    parts["crown"] = [
        lathe(
            [(13.2, 11), (12.2, 13.4), (8.8, 13.8), (8.0, 12.8), (6.6, 12.8), (6.0, 14.2), (3.6, 15.2), (0, 15.5)],
            16,
            28,
        ).moved(upright),
        lathe([(11, -7), (10.2, -9.4), (5.4, -9.5), (4.2, -10.0), (0, -10.3)], 12, 28).moved(upright),
    ]

    # the engine band: a sector of nine facets, each with a deep nozzle and a vane in it
    section = [
        (35, 7.2), (43.6, 6.8), (46.4, 6.2), (48.6, 4.7), (49.2, 3.9), (49.2, -3.7), (48.2, -4.8), (45, -5.6),
        (35, -5.8),
    ]
    steps = 9
    across = [2 * i / steps - 1 for i in range(steps + 1)]  # -1 to 1, over 110 degrees; the band is low at its ends
    rings = [[polar(r, 55 * a, y * (1.1 - 0.45 * a * a)) for r, y in section] for a in across]
    ends = [[polar(mix(r, 37, 0.5), 61 * a, y * 0.55) for r, y in section] for a in (-1, 1)]
    band = loft([ends[0], *rings, ends[1]], 30)
    for i, (a, b) in enumerate(zip(across, across[1:]), 1):
        h = 1.1 - 0.45 * max(a * a, b * b)
        key = (i, 4)
        for margin, lift in [
            (0.7, 0), (0.9, -1.0), (0.2, -2.0), (0.9, 0), (0.85, 0.9),
        ]:  # frame, lip, well, floor, vane
            band.inset(key, margin * h, lift)
    parts["engines"] = [band]

    # the talons: a six-cornered section along a curve, down to a point
    stations = []
    knots = [
        (0, 22, -30, 8.5, 4.6), (1, 27.5, -42, 7.2, 3.9), (2, 26.5, -51, 5.2, 3.0), (3, 20.5, -57, 3.2, 2.0),
        (3.8, 13.5, -59.0, 1.4, 1.1),
    ]
    for i in range(8):
        t = 3.8 * i / 7
        x, z, w, h = curve(knots, t)
        u, v = curve(knots, max(0, t - 0.05)), curve(knots, min(3.8, t + 0.05))
        dx, dz = v[0] - u[0], v[1] - u[1]
        sx, sz = -dz / hypot(dx, dz), dx / hypot(dx, dz)  # to the outer side
        stations.append(
            [
                (x + sx * w * a, h * b - 0.3, z + sz * w * a)
                for a, b in [(1, 0.25), (0.55, 1), (-0.25, 1), (-1, 0), (-0.25, -0.9), (0.55, -0.9), (1, -0.25)]
            ]
        )
    stations.append([(10.0, -0.5, -58.6)])
    talon = loft(stations, 24)
    parts["talons"] = both(talon)

    # the beak and its canopy
    beak = loft(
        [
            [
                (w * c, mix(low, top, (s + 1) / 2), z)
                for c, s in [(1, 0.1), (0.62, 1), (-0.62, 1), (-1, 0.1), (-0.7, -1), (0.7, -1)]
            ]
            for z, w, low, top in [
                (-14, 10.5, -5, 10.4), (-30, 9.0, -5, 7.6), (-42, 7.4, -4.4, 5.2), (-50, 5.0, -3.8, 2.8),
                (-54.5, 2.0, -3.4, -0.4),
            ]
        ],
        10,
    )
    for k in (0, 1):
        beak.inset((k, 0), 0.9, -0.4).inset((k, 2), 0.9, -0.4)
    parts["beak"] = [beak]
    panes = [[(0.0, 3.4, -49.0)]]
    for z, w, top in [(-44, 2.8, 7.4), (-37, 4.4, 11.4), (-28, 5.2, 13.6), (-19, 4.8, 14.0)]:
        base = 3.0
        panes.append(
            [
                (w * c, base + (top - base) * s, z)
                for c, s in [
                    (1.0, 0.0), (0.97, 0.42), (0.62, 0.88), (0.22, 1.0), (-0.22, 1.0), (-0.62, 0.88), (-0.97, 0.42),
                    (-1.0, 0.0),
                ]
            ]
        )
    panes.append([(x * 0.7, y * 0.97, -10.0) for x, y, _ in panes[-1]])
    canopy = loft(panes, 8)
    for strip in (1, 2, 3):
        for j in (1, 2, 4, 5):
            canopy.inset((strip, j), 0.45, -0.5)
    parts["canopy"] = [canopy]

    # the spine from the crown to the stern, and two canted fins
    parts["spine"] = [ridge(4.0, [(10, 3.2, 13.6), (22, 3.6, 12.6), (36, 3.0, 10.2), (44, 2.2, 8.4), (48, 1.4, 5.8)])]

    def level(x, y, z0, z1, w):
        """A level cut through a fin: sharp in front, cut off with bevels behind."""
        half = [(w * 0.2, z0), (w, mix(z0, z1, 0.35)), (w, z1 - 0.8), (w * 0.4, z1)]
        return [(x + dx, y, z) for dx, z in half] + [(x - dx, y, z) for dx, z in half[::-1]]

    cuts = [(16, 4, 24, 46, 1.5), (18, 9, 31, 47, 1.25), (21, 13.6, 39, 50, 0.9), (22.1, 15, 42, 50.6, 0.5)]
    fins = loft([level(*cut) for cut in cuts], 20)
    parts["fins"] = both(fins)
    return parts


# -------------------------------------------------------------------------------------------------------------- cam


def cam():
    """A film camera: its eye is the origin, the view leaves it as a pyramid, and two reels say which way is up."""

    def square(w, h, z):
        return [(w, h, z), (-w, h, z), (-w, -h, z), (w, -h, z)]

    view = loft(
        [[(0.0, 0.0, 1.0)], square(25, 19, -36), square(25, 19, -38.5), square(22.6, 16.6, -38.5), [(0.0, 0.0, -8.0)]],
        10,
    )
    for j in range(4):
        view.inset((0, j), 2.4, -0.7)

    body = box(6.5, -7.5, 7.0, -3.0, 21.0, 1.5)
    for j in (3, 7):  # the flanks
        body.inset((1, j), 1.2, -0.6)
    body.inset(("last",), 1.0, -0.5)
    eye = lathe([(3.0, 19), (3.0, 23.6), (3.9, 24.2), (3.9, 25.6), (3.3, 26.0), (2.6, 26.0), (1.9, 23.0)], 12, 28)

    def reel(r, y, z):
        disc = lathe([(r - 0.7, -2.6), (r, -1.9), (r, 1.9), (r - 0.7, 2.6)], 16, 30)
        for side in ("first", "last"):
            disc.inset((side,), 1.2).inset((side,), 0.3, -0.9).inset((side,), r * 0.38).inset((side,), 0.3, 1.2)
        return disc.moved(lambda p: (p[2], p[1] + y, p[0] + z))

    return {"view": [view], "body": [body], "eyepiece": [eye], "reels": [reel(8.2, 14.0, 3.5), reel(6.4, 12.4, 17.0)]}


# -------------------------------------------------------------------------------------------------- check and write


def check(name, solids):
    """Closed, wound outward, flat, convex and nowhere degenerate; each solid alone, and no edge shared between two."""
    edges = set()
    for solid in solids:
        faces = [[snap(p) for p in face] for face in split(solid.faces.values())]
        own = {}
        for face in faces:
            n = newell(face)
            area = sqrt(dot(n, n)) / 2
            assert len(set(face)) == len(face) >= 3, (name, "repeated corner", face)
            assert area > 0.005, (name, "degenerate", area, face)
            assert unflatness(face) < 1e-3, (name, "not flat", unflatness(face), face)
            for i, p in enumerate(face):
                q, r = face[(i + 1) % len(face)], face[(i + 2) % len(face)]
                turn = dot(cross(sub(q, p), sub(r, q)), n)
                assert turn > 0, (name, "not strictly convex", face)
                own[p, q] = own.get((p, q), 0) + 1
        assert all(count == 1 and own.get((q, p)) == 1 for (p, q), count in own.items()), (name, "not closed")
        assert edges.isdisjoint(own), (name, "two solids share an edge")
        edges.update(own)
        assert sum(dot(face[0], newell(face)) for face in split(faces)) > 0, (name, "inside out")


def corners(solid):
    """The solid's faces, each corner as (position, group): corners of one group share a `v`, hence a normal."""
    faces = [[snap(p) for p in face] for face in split(solid.faces.values())]
    normals = [unit(newell(face)) for face in faces]
    leader = {(f, p): (f, p) for f, face in enumerate(faces) for p in face}

    def find(c):
        while leader[c] != c:
            c = leader[c]
        return c

    side = {}
    for f, face in enumerate(faces):
        for p, q in zip(face, face[1:] + face[:1]):
            side[p, q] = f
    for (p, q), f in side.items():
        g = side[q, p]
        if degrees(acos(max(-1.0, min(1.0, dot(normals[f], normals[g]))))) < solid.crease:
            for c in (p, q):
                leader[find((f, c))] = find((g, c))
    return [[(p, find((f, p))) for p in face] for f, face in enumerate(faces)]


def write(name, about, colour, parts):
    lines, positions, corner_counts = [], [], {}
    for part, solids in parts.items():
        check(name + "/" + part, solids)
        vs, fs = [], []
        for solid in solids:
            index = {}
            for face in corners(solid):
                for p, group in face:
                    if (p, group) not in index:
                        index[p, group] = len(positions) + 1
                        positions.append(p)
                        vs.append("v " + " ".join(f"{c:.{DIGITS}f}".rstrip("0").rstrip(".") for c in p))
                fs.append("f " + " ".join(str(index[c]) for c in face))
                corner_counts[len(face)] = corner_counts.get(len(face), 0) + 1
        lines += [f"g {part}", *vs, *fs]
    head = [
        f"# {name}: {about}",
        "# Made by the project: written by assets/models.py, which is the place to change it.",
        f"c {colour}",
        f"o {name}",
    ]
    Path(__file__).with_name(name + ".obj").write_text("\n".join(head + lines) + "\n", encoding="ascii", newline="\n")
    low, high = [tuple(f(p[i] for p in positions) for i in range(3)) for f in (min, max)]
    print(
        f"{name}: {sum(corner_counts.values())} faces {dict(sorted(corner_counts.items()))}, {len(positions)} v, "
        f"{low} to {high}, mean {tuple(round(c, 2) for c in mean(positions))}"
    )


if __name__ == "__main__":
    write("x_wing", "a long ship, its nose to -Z", "140 255 190", x_wing())
    write("r_falke", "a flat round ship, its beak to -Z", "255 170 140", r_falke())
    write("cam", "a camera that looks along -Z, its eye at the origin", "205 205 255", cam())
