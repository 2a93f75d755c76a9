"""Answers: how are the models, textures and scenes of the examples made and written?

Three tools: `Model` collects polygons and writes OBJ; `picture` writes an indexed PNG; `Scene` writes a scene file.
The program draws no shadows, so `Shade` paints them: spheres stand for the objects, and what they hide of a light or
of the sky darkens textures and vertex colours.

Space: right-handed, Y up, counter-clockwise faces seen from outside. Standard library only, and the same bytes on
every run: chance comes from `Rng`, which has a seed.
"""

import struct
import zlib
from math import acos, cos, exp, floor, pi, sin, sqrt
from pathlib import Path

HERE = Path(__file__).parent

# ------------------------------------------------------------------------------------------------------- numbers


def add(a, b, k=1.0):
    """a + k b"""
    return (a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return sqrt(dot(a, a))


def unit(a):
    return add((0.0, 0.0, 0.0), a, 1 / length(a))


def mix(a, b, t):
    """From a (t = 0) to b (t = 1): numbers or tuples of them."""
    if isinstance(a, tuple):
        return tuple(x + (y - x) * t for x, y in zip(a, b))
    return a + (b - a) * t


def clamp(x, low=0.0, high=1.0):
    return low if x < low else high if x > high else x


def smooth(low, high, x):
    """0 below `low`, 1 above `high`, and smooth in between."""
    t = clamp((x - low) / (high - low))
    return t * t * (3 - 2 * t)


class Rng:
    """Numbers by chance, the same on every run: Numerical Recipes' `ranqd1`."""

    def __init__(self, seed):
        self.state = seed

    def next(self):
        """From 0 up to, but never, 1."""
        self.state = (1664525 * self.state + 1013904223) & 0xFFFFFFFF
        return (self.state >> 8) / (1 << 24)

    def between(self, low, high):
        return low + (high - low) * self.next()


def table(seed):
    rng = Rng(seed)
    return [rng.next() for _ in range(4096)]


_VALUES = table(7)


def noise(x, y):
    """Value noise in the plane, from 0 to 1, a value at each whole number."""
    i, j = floor(x), floor(y)
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    rows = ((i * 131 + j * 7919) & 4095, (i * 131 + 131 + j * 7919) & 4095)
    a, b = _VALUES[rows[0]], _VALUES[rows[1]]
    c, d = _VALUES[(rows[0] + 7919) & 4095], _VALUES[(rows[1] + 7919) & 4095]
    low = a + (b - a) * u
    return low + (c + (d - c) * u - low) * v


def fractal(x, y, octaves):
    """Sum of noise, each octave twice as fine and half as strong; from 0 to 1."""
    total, weight, sum_of_weights = 0.0, 1.0, 0.0
    for _ in range(octaves):
        total += weight * noise(x, y)
        sum_of_weights += weight
        x, y, weight = 2 * x + 17.3, 2 * y + 9.1, weight / 2
    return total / sum_of_weights


def wood(along, across, rings=1.0):
    """Grain of a board, from 0 (dark) to 1: rings stretched along the board, and fine fibres."""
    wave = across * 1.7 + 1.6 * fractal(along * 0.045, across * 0.35, 3) * rings
    ring = 0.5 + 0.5 * sin(2 * pi * wave)
    fibre = noise(along * 0.22, across * 9.0)
    return clamp(0.52 * ring**1.6 + 0.3 * fibre + 0.24 * fractal(along * 0.1, across * 1.1 + 40, 2))


# ------------------------------------------------------------------------------------------------------- pictures


def picture(name, width, height, index, palette):
    """Writes an indexed PNG; `index(x, y)` names the colour of a texel, from the top left."""
    rows = bytearray()
    for y in range(height):
        rows.append(0)
        rows += bytes(index(x, y) for x in range(width))
    colors = b"".join(bytes(round(clamp(c, 0, 255)) for c in color) for color in palette)

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"PLTE", colors)
    png += chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b"")
    (HERE / name).write_bytes(png)


# Thresholds of an ordered dither of 4 x 4 texels: Bayer's.
_BAYER = [[(v + 0.5) / 16 for v in row] for row in [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]]]


def shaded_picture(name, width, height, tones, texel, shadow=(0.0, 0.0, 0.0), steps=20):
    """A picture of a few tones under light: `texel(x, y)` gives a tone's number and the light, from 0 to 1.

    Light has `steps` steps, dithered; in the dark a tone goes over into its product with `shadow`.
    """
    assert len(tones) * steps <= 256
    palette = []
    for tone in tones:
        dark = tuple(c * s for c, s in zip(tone, shadow))
        palette += [mix(dark, tone, step / (steps - 1)) for step in range(steps)]

    def index(x, y):
        tone, light = texel(x, y)
        step = int(clamp(light) * (steps - 1) + _BAYER[y & 3][x & 3])
        return tone * steps + min(step, steps - 1)

    picture(name, width, height, index, palette)


def coarse(width, height, step, value):
    """`value(x, y)` of a picture's places, asked at every `step`th and interpolated: for light, which changes slowly."""
    columns, rows = width // step + 2, height // step + 2
    known = [[value(x * step, y * step) for x in range(columns)] for y in range(rows)]

    def at(x, y):
        i, j, u, v = x // step, y // step, x % step / step, y % step / step
        a, b = known[j], known[j + 1]
        return mix(mix(a[i], a[i + 1], u), mix(b[i], b[i + 1], u), v)

    return at


def ramp(stops, count):
    """`count` colours along stops of (place from 0 to 1, colour)."""
    colors = []
    for i in range(count):
        t = i / (count - 1)
        for (low, a), (high, b) in zip(stops, stops[1:]):
            if t <= high or high == stops[-1][0]:
                colors.append(mix(a, b, clamp((t - low) / (high - low))))
                break
    return colors


# --------------------------------------------------------------------------------------------------------- light


class Shade:
    """What spheres, standing for objects, hide of lights and of the sky."""

    def __init__(self):
        self.spheres = []

    def sphere(self, centre, radius):
        self.spheres.append((centre, radius))

    def column(self, foot, profile, count):
        """Spheres along the profile of a body that stands upright: (radius, height) from below."""
        low, high = profile[0][1], profile[-1][1]
        for i in range(count):
            y = mix(low, high, (i + 0.5) / count)
            radius = max((r for r, h in profile if abs(h - y) <= (high - low) / count), default=0)
            if radius > 0:
                self.sphere(add(foot, (0, y, 0)), radius)

    def hidden(self, point, towards, softness, but=None):
        """How much of a light is hidden that lies in the direction `towards`, from 0 to 1.

        `softness` is the radius of the light as seen from one unit away.
        """
        worst = 0.0
        for centre, radius in self.spheres:
            if but is not None and but(centre):
                continue
            d = sub(centre, point)
            along = dot(d, towards)
            if along <= 0:
                continue
            aside = sqrt(max(dot(d, d) - along * along, 0.0))
            penumbra = softness * along + 0.12 * radius
            worst = max(worst, smooth(-penumbra, penumbra, radius - aside) * smooth(0, radius, along))
        return worst

    def ambient(self, point, normal, but=None):
        """How much of the sky is left, from 0 to 1: a sphere hides cos(angle) (r / d)^2 of it."""
        left = 1.0
        for centre, radius in self.spheres:
            if but is not None and but(centre):
                continue
            d = sub(centre, point)
            distance = max(length(d), radius)
            left *= 1 - clamp(dot(d, normal) / distance) * (radius / distance) ** 2 * 0.9
        return left


# -------------------------------------------------------------------------------------------------------- models


def number(x, digits):
    return f"{round(x, digits) + 0.0:.{digits}f}".rstrip("0").rstrip(".") if digits else str(round(x))


class Model:
    """Polygons of one OBJ file. A point has a colour or none; a corner is a point and a place in the texture."""

    def __init__(self, name, digits=3):
        self.name, self.digits = name, digits
        self.points, self.colors, self.uvs, self.faces = [], [], [], []
        self.known = {}

    def point(self, p, color=None):
        self.points.append(p)
        self.colors.append(color)
        return len(self.points)

    def uv(self, u, v):
        key = (round(u, 4), round(v, 4))
        if key not in self.known:
            self.uvs.append(key)
            self.known[key] = len(self.uvs)
        return self.known[key]

    def face(self, points, uvs=None):
        self.faces.append((points, uvs))

    def lathe(self, profile, segments, at=lambda p: p, color=None, uv=False, around=1.0, bulge=None):
        """A body turned about Y from a profile of (radius, height), which runs up on the outside.

        `bulge(angle, i)` scales the radius of row i; `color(row, rows, p)` is that of a point.
        """
        rows = []
        for i, (radius, y) in enumerate(profile):
            ring = []
            for j in range(segments if radius > 0 else 1):
                angle = 2 * pi * j / segments
                r = radius * (bulge(angle, i) if bulge else 1)
                p = at((r * sin(angle), y, r * cos(angle)))
                ring.append(self.point(p, color(i, len(profile), p) if color else None))
            rows.append(ring)
        for i, (low, high) in enumerate(zip(rows, rows[1:])):
            v = (i / (len(rows) - 1), (i + 1) / (len(rows) - 1))
            for j in range(segments):
                u = (around * j / segments, around * (j + 1) / segments)
                k = (j + 1) % segments
                corners = [(low[j % len(low)], u[0], v[0]), (low[k % len(low)], u[1], v[0])]
                corners += [(high[k % len(high)], u[1], v[1]), (high[j % len(high)], u[0], v[1])]
                if len(low) == 1:
                    del corners[1]
                elif len(high) == 1:
                    del corners[2]
                self.face([c[0] for c in corners], [self.uv(c[1], c[2]) for c in corners] if uv else None)

    def grid(self, place, columns, rows, color=None, uv=False, flip=False):
        """A sheet: `place(u, v)` for u and v from 0 to 1; u x v points to its front."""
        ids = []
        for j in range(rows + 1):
            for i in range(columns + 1):
                u, v = i / columns, j / rows
                p = place(u, v)
                ids.append(self.point(p, color(u, v, p) if color else None))
        for j in range(rows):
            for i in range(columns):
                corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                if flip:
                    corners.reverse()
                points = [ids[y * (columns + 1) + x] for x, y in corners]
                self.face(points, [self.uv(x / columns, y / rows) for x, y in corners] if uv else None)

    def box(self, low, high, bevel=0.0, color=None, uv=None):
        """A box with its edges cut off at 45 degrees; `uv(p, n)` is the place in the texture."""
        ids = {}
        middle = mix(low, high, 0.5)
        for axis in range(3):
            for s in range(8):
                sign = [1 if s >> k & 1 else -1 for k in range(3)]
                p = []
                for k in range(3):
                    reach = (high[k] - low[k]) / 2 - (0 if k == axis else bevel)
                    p.append(middle[k] + sign[k] * reach)
                p = tuple(p)
                ids[axis, s] = self.point(p, color(p) if color else None)

        def face(corners, normal):
            points = [ids[c] for c in corners]
            a, b, c = (self.points[i - 1] for i in points[:3])
            if dot(cross(sub(b, a), sub(c, a)), normal) < 0:
                points.reverse()
            self.face(points, [self.uv(*uv(self.points[i - 1], normal)) for i in points] if uv else None)

        for axis in range(3):
            a, b = (axis + 1) % 3, (axis + 2) % 3
            for side in (0, 1):
                s = side << axis
                loop = [s, s | 1 << a, s | 1 << a | 1 << b, s | 1 << b]
                normal = tuple((2 * side - 1 if k == axis else 0) for k in range(3))
                face([(axis, c) for c in loop], normal)
        if bevel == 0:
            return
        for axis in range(3):
            a, b = (axis + 1) % 3, (axis + 2) % 3
            for corner in range(4):
                s = (corner & 1) << a | (corner >> 1) << b
                normal = [0, 0, 0]
                normal[a], normal[b] = 2 * (corner & 1) - 1, 2 * (corner >> 1) - 1
                face([(a, s), (a, s | 1 << axis), (b, s | 1 << axis), (b, s)], tuple(normal))
        for s in range(8):
            face([(k, s) for k in range(3)], tuple(1 if s >> k & 1 else -1 for k in range(3)))

    def tube(self, path, radii, segments, color=None):
        """A tube around a path, closed at both ends."""
        rings = []
        up = (0.0, 0.0, 1.0)
        for i, (p, radius) in enumerate(zip(path, radii)):
            before, after = path[max(i - 1, 0)], path[min(i + 1, len(path) - 1)]
            along = unit(sub(after, before))
            if abs(dot(along, up)) > 0.95:
                up = (1.0, 0.0, 0.0)
            right = unit(cross(up, along))
            forth = cross(along, right)
            ring = []
            for j in range(segments):
                angle = 2 * pi * j / segments
                q = add(add(p, right, radius * cos(angle)), forth, radius * sin(angle))
                ring.append(self.point(q, color(i, q) if color else None))
            rings.append(ring)
        for low, high in zip(rings, rings[1:]):
            for j in range(segments):
                k = (j + 1) % segments
                self.face([low[j], low[k], high[k], high[j]])
        self.face(rings[0][::-1])
        self.face(rings[-1])

    def plate(self, outline, depth, bevel, at=lambda p: p):
        """An outline in x and y, counter-clockwise, as a plate about z = 0 with its edges cut off at 45 degrees."""
        count = len(outline)
        inner = []
        for i, (x, y) in enumerate(outline):
            (ax, ay), (bx, by) = outline[i - 1], outline[(i + 1) % count]
            ux, uy = x - ax, y - ay
            vx, vy = bx - x, by - y
            lu, lv = sqrt(ux * ux + uy * uy), sqrt(vx * vx + vy * vy)
            nx, ny = -(uy / lu + vy / lv), ux / lu + vx / lv
            # Short edges get less, so that the inner outline does not cross itself.
            reach = min(bevel, 0.45 * min(lu, lv)) * 2 / max(nx * nx + ny * ny, 1.0)
            inner.append((x + nx * reach, y + ny * reach))
        half = depth / 2
        rows = [(inner, half), (outline, half - bevel), (outline, bevel - half), (inner, -half)]
        rings = [[self.point(at((x, y, z))) for x, y in row] for row, z in rows]
        self.face(rings[0])
        for front, back in zip(rings, rings[1:]):
            for i in range(count):
                k = (i + 1) % count
                self.face([front[i], back[i], back[k], front[k]])
        self.face(rings[3][::-1])

    def ball(self, centre, radius, segments, rows, color=None):
        profile = [(0.0, -radius)]
        profile += [(radius * sin(pi * i / rows), -radius * cos(pi * i / rows)) for i in range(1, rows)]
        profile.append((0.0, radius))
        self.lathe(profile, segments, at=lambda p: add(p, centre), color=color)

    def write(self, folder):
        lines = [f"# Made by assets/examples/make.py, which is the place to change it.\no {self.name}\n"]
        for p, color in zip(self.points, self.colors):
            line = "v " + " ".join(number(c, self.digits) for c in p)
            if color is not None:
                line += "".join(" " + number(clamp(c), 2) for c in color)
            lines.append(line + "\n")
        lines += [f"vt {number(u, 4)} {number(v, 4)}\n" for u, v in self.uvs]
        for points, uvs in self.faces:
            corners = [f"{p}/{t}" for p, t in zip(points, uvs)] if uvs else map(str, points)
            lines.append("f " + " ".join(corners) + "\n")
        (HERE / folder / f"{self.name}.obj").write_text("".join(lines), encoding="ascii", newline="\n")


# --------------------------------------------------------------------------------------------------------- scenes


def real(x):
    return repr(round(float(x), 6))


def real_vector(v):
    return "(" + ", ".join(real(c) for c in v) + ")"


def placed(at=(0, 0, 0), turn=0.0, size=1.0, lean=0.0):
    """Columns of world_from_object: leaned about Z, turned about Y, scaled, moved. Degrees."""
    a, b = turn * pi / 180, lean * pi / 180
    x = (cos(a) * cos(b) * size, sin(b) * size, -sin(a) * cos(b) * size, 0)
    y = (-cos(a) * sin(b) * size, cos(b) * size, sin(a) * sin(b) * size, 0)
    z = (sin(a) * size, 0, cos(a) * size, 0)
    return (x, y, z, (*at, 1))


def material(color, ambient=0.35, specular=0.1, exponent=20.0):
    """Phong's coefficients: ambient and highlight as parts of the colour, or colours of their own."""
    part = lambda x: tuple(c * x for c in color) if isinstance(x, float) and x <= 1 else x
    shine = specular if isinstance(specular, tuple) else (specular,) * 3
    rows = f"ambient: {real_vector(part(ambient))}, diffuse: {real_vector(color)}, specular: {real_vector(shine)}"
    return f"Own(({rows}, exponent: {real(exponent)}))"


class Scene:
    """The text of a scene file."""

    def __init__(self, folder, background):
        self.folder, self.background = folder, background
        self.objects, self.lights, self.id = [], [], 0

    def next_id(self):
        self.id += 1
        return self.id

    def object(self, name, model, material, placement=None, texture=None, surface=None, crease=None, sides=None):
        id = self.next_id()
        crease = f", crease: {real(crease)}" if crease is not None else ""
        lines = [f"id: {id}", f'name: "{name}"', f'model: File(path: "{self.folder}/{model}.obj"{crease})']
        if placement:
            lines.append("placement: (" + ", ".join(real_vector(column) for column in placement) + ")")
        lines.append(f"material: {material}")
        if texture:
            path, wrap = texture if isinstance(texture, tuple) else (texture, "Clamp")
            lines.append(f'texture: Some((path: "{self.folder}/{path}", wrap: {wrap}))')
        if surface:
            lines.append(f"surface: {surface}")
        if sides:
            lines.append(f"sides: {sides}")
        self.objects.append("        (\n" + "".join(f"            {line},\n" for line in lines) + "        ),\n")
        return id

    def light(self, name, kind, color=(255, 255, 255), attenuation=None, on=True):
        slot = len(self.lights)
        fade = ""
        if attenuation:
            fade = ", attenuation: (constant: {}, linear: {}, quadratic: {})".format(*map(real, attenuation))
        off = "" if on else ", on: false"
        line = f'(id: {self.next_id()}, name: "{name}", slot: {slot}{off}, color: {color}{fade}, kind: {kind})'
        self.lights.append(f"        {line},\n")

    def write(self, comment, eye, target, half_angle, near, far, selected=1):
        z = unit(sub(eye, target))
        x = unit(cross((0.0, 1.0, 0.0), z))
        y = cross(z, x)
        axes = "(" + ", ".join("(" + ", ".join(repr(round(c, 9)) for c in a) + ")" for a in (x, y, z)) + ")"
        camera = self.next_id()
        lens = f"(half_angle: {real(half_angle)}, near: {real(near)}, far: {real(far)})"
        text = f"// {comment}\n// Made by assets/examples/make.py, which is the place to change it.\n(\n    version: 1,\n"
        text += f"    background: {self.background},\n    next_id: {self.id + 1},\n"
        text += "    objects: [\n" + "".join(self.objects) + "    ],\n"
        text += f'    cameras: [\n        (\n            id: {camera},\n            name: "camera 1",\n'
        text += f"            eye: {real_vector(eye)},\n            axes: {axes},\n            lens: {lens},\n        ),\n    ],\n"
        text += "    lights: [\n" + "".join(self.lights) + "    ],\n"
        text += f"    view: (object: Some({selected}), camera: {camera}, subject: Camera, marks: false),\n"
        text += "    settings: (samples: 4, filter: Anisotropic),\n)\n"
        (HERE / f"{self.folder}.marraztu").write_text(text, encoding="ascii", newline="\n")


def sun(direction):
    return f"Sun(direction: {real_vector(unit(direction))})"


def bulb(position):
    return f"Bulb(position: {real_vector(position)})"


def spot(position, target, half_aperture, exponent):
    direction = real_vector(unit(sub(target, position)))
    return (
        f"Spot(owner: Fixed(position: {real_vector(position)}, direction: {direction}), "
        f"half_aperture: {real(half_aperture)}, exponent: {real(exponent)})"
    )
