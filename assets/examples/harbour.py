"""Answers: what lies in the harbour at sunset?

Three sailing boats, a jetty with lanterns, a lighthouse on its rock and a row of houses, under a painted sky. Waves are
real polygons: the sun glitters on them. Lengths are metres; still water is y = 0, and the camera looks to -Z.
"""

from kit import *

FOLDER = "harbour"
SUN = unit((-0.30, 0.115, -1.0))  # towards the sun
EYE = (2.0, 4.6, 30.0)
LIGHTHOUSE = (26.5, 2.6, -62.0)
JETTY = (-8.2, 1.1)  # its x and the height of its planks
LANTERNS = [(-7.0, 3.5, 3.0), (-7.0, 3.5, -4.0), (-7.0, 3.5, -11.0)]
BOATS = [("red boat", (5.0, 0, 4.0), 28.0, 1.0, (150, 34, 34)), ("blue boat", (11.6, 0, -12.0), 62.0, 1.1, (30, 62, 120)), ("green boat", (-2.6, 0, -22.0), -36.0, 1.0, (38, 92, 66))]


def sky_color(direction):
    """The sky in a direction: from violet above to gold at the horizon, with the sun and bands of cloud."""
    x, y, z = direction
    h = clamp(y)
    stops = [(0.0, (255, 196, 116)), (0.06, (255, 168, 96)), (0.16, (226, 124, 104)), (0.32, (140, 92, 128)), (0.6, (62, 62, 116)), (1.0, (26, 34, 78))]
    color = stops[-1][1]
    for (low, a), (high, b) in zip(stops, stops[1:]):
        if h <= high:
            color = mix(a, b, (h - low) / (high - low))
            break
    near = max(dot(direction, SUN), 0.0)
    color = mix(color, (255, 224, 150), 0.75 * near**24)
    color = mix(color, (255, 214, 150), 0.35 * near**5 * (1 - h))
    angle = z and x / max(abs(z), 0.05)
    cloud = fractal(angle * 2.2 + 11, h * 17 + 3.0 * fractal(angle * 1.3 + 5, h * 5, 2), 5)
    strength = smooth(0.50, 0.72, cloud) * smooth(0.015, 0.07, h) * smooth(0.62, 0.2, h)
    lit = mix((112, 66, 100), (255, 170, 112), clamp(0.25 + 1.1 * near**6 + 0.5 * (cloud - 0.6)))
    color = mix(color, lit, 0.78 * strength)
    disc = smooth(0.99935, 0.99955, near)
    return mix(color, (255, 246, 214), disc)


def sky_model():
    """Half a drum around everything, seen from within; its texture is the sky before the camera."""
    sky = Model("sky", 1)
    radius, wide, high = 700.0, 2.5, 0.62

    def place(u, v):
        angle = (u - 0.5) * wide
        return (radius * sin(angle), -30 + 700 * high * v, -radius * cos(angle))

    sky.grid(place, 40, 1, uv=True)
    sky.write(FOLDER)
    columns, rows = 512, 288
    colors = []
    for j in range(rows):
        for i in range(columns):
            x, y, z = place((i + 0.5) / columns, 1 - (j + 0.5) / rows)
            colors.append(sky_color(unit((x, y + 8, z))))
    palette = cut(colors, 256)
    known = {}

    def nearest(color):
        key = tuple(round(c) >> 1 for c in color)
        if key not in known:
            known[key] = min(range(len(palette)), key=lambda k: sum((a - b) ** 2 for a, b in zip(palette[k], color)))
        return known[key]

    def index(i, j):
        step = (((j & 3) * 5 + (i & 3) * 7) % 16 / 16 - 0.5) * 3.0
        return nearest(tuple(c + step for c in colors[j * columns + i]))

    picture(f"{FOLDER}/sky.png", columns, rows, index, palette)


def cut(colors, count):
    """A palette by median cut (Heckbert 1982)."""
    boxes = [colors[::7]]
    while len(boxes) < count:
        def spread(box):
            return max(max(c[k] for c in box) - min(c[k] for c in box) for k in range(3)) * len(box) ** 0.5 if len(box) > 1 else 0

        widths = [spread(box) for box in boxes]
        k = widths.index(max(widths))
        box = boxes.pop(k)
        axis = max(range(3), key=lambda a: max(c[a] for c in box) - min(c[a] for c in box))
        box.sort(key=lambda c: c[axis])
        boxes += [box[: len(box) // 2], box[len(box) // 2 :]]
    return [tuple(sum(c[k] for c in box) / len(box) for k in range(3)) for box in boxes]


def wave(x, z, detail):
    """The height of the water; `detail` is the length of the shortest wave that the grid can carry."""
    y = 0.0
    for k, (dx, dz, size, height, phase) in enumerate([(0.5, 1.0, 13.0, 0.13, 0.3), (-0.7, 1.0, 8.1, 0.09, 2.1), (0.2, 1.0, 4.7, 0.055, 4.0), (-0.35, 1.0, 2.9, 0.035, 1.1), (0.85, 1.0, 1.9, 0.022, 5.2)]):
        along = (x * dx + z * dz) / sqrt(dx * dx + dz * dz)
        bend = 1.5 * (noise(x / size / 2 + 7 * k, z / size / 2) - 0.5)
        y += height * smooth(detail, 2.6 * detail, size) * sin(2 * pi * (along / size + bend) + phase)
    return y


def sea_model():
    """Water: rows closer together near the camera, each a little longer than the one before."""
    sea = Model("sea", 2)
    columns, rows = 52, 70

    def place(u, v):
        away = 4.0 * (175.0 ** v)
        x = EYE[0] + (u - 0.5) * 2.0 * (4 + away * 1.15)
        z = EYE[2] + 3 - away
        cell = max(2.0 * away * 1.15 / columns, away * 0.075)
        return (x, wave(x, z, cell), z)

    def color(u, v, p):
        away = length(sub(p, EYE))
        far = smooth(20, 420, away)
        glow = max(dot(unit((p[0] - EYE[0], 0, p[2] - EYE[2])), unit((SUN[0], 0, SUN[2]))), 0) ** 14
        deep = mix((0.10, 0.20, 0.26), (0.36, 0.30, 0.36), far)
        return mix(deep, (0.95, 0.58, 0.34), glow * (0.12 + 0.5 * far))

    sea.grid(place, columns, rows, color=color)
    sea.write(FOLDER)


def boat_model():
    """A hull of sections, white above and in the boat's tint below; deck, cabin, mast, boom and sails."""
    hull = Model("hull", 3)
    trim = Model("rig", 3)
    sections, ribs = 16, 9
    deck = lambda t: 0.95 + 0.35 * (2 * t - 1) ** 2 + 0.25 * max(2 * t - 1, 0)
    wide = lambda t: 1.25 * (1 - abs(2 * t - 0.9) ** 2.6) if t < 0.95 else 0.02
    rows = []
    for i in range(sections + 1):
        t = i / sections
        half = max(wide(t), 0.62 if t == 0 else 0.02)
        if t < 0.45:
            half = mix(0.78, 1.22, smooth(0, 0.45, t))
        row = []
        for j in range(ribs):
            a = (j / (ribs - 1) - 0.5) * pi
            side, low = sin(a), cos(a)
            y = deck(t) * (1 - low**0.7) - 0.35 * low * (1 - 0.75 * t)
            p = (half * (abs(side) ** 0.6) * (1 if side > 0 else -1), y, 3.6 - 7.4 * t - 0.25 * (1 - low) * t)
            stripe = 0.62 < y / deck(t) < 0.8
            color = (0.97, 0.95, 0.90) if y < 0.12 or stripe else (1.0, 1.0, 1.0)
            row.append(hull.point(p, color))
        rows.append(row)
    for low, high in zip(rows, rows[1:]):
        for j in range(ribs - 1):
            hull.face([low[j], high[j], high[j + 1], low[j + 1]])
    hull.face(rows[0])
    hull.write(FOLDER)
    wood_tone = lambda p: mix((0.62, 0.42, 0.24), (0.50, 0.32, 0.17), noise(p[0] * 9, p[2] * 1.5))
    edge = [hull.points[row[0] - 1] for row in rows], [hull.points[row[-1] - 1] for row in rows]
    planks = []
    for a, b in zip(*edge):
        planks.append([trim.point(add(mix(a, b, k / 6), (0, -0.06, 0)), wood_tone(mix(a, b, k / 6))) for k in range(7)])
    for low, high in zip(planks, planks[1:]):
        for k in range(6):
            trim.face([low[k], low[k + 1], high[k + 1], high[k]])
    for side in edge:
        trim.tube([add(p, (0, 0.02, 0)) for p in side], [0.07] * len(side), 6, color=lambda i, p: (0.42, 0.25, 0.12))
    trim.box((-0.62, 0.9, -1.3), (0.62, 1.55, 0.9), 0.12, color=lambda p: (0.94, 0.92, 0.86))
    for z in (-0.9, -0.2, 0.5):
        trim.box((-0.64, 1.18, z - 0.18), (0.64, 1.38, z + 0.18), 0.02, color=lambda p: (0.10, 0.12, 0.16))
    mast = (0.0, 0.9, -1.5)
    trim.tube([mast, add(mast, (0, 4, 0)), add(mast, (0, 9.0, 0))], [0.1, 0.09, 0.05], 8, color=lambda i, p: (0.56, 0.40, 0.24))
    trim.tube([add(mast, (0, 1.3, 0.05)), add(mast, (0.5, 1.35, 4.4))], [0.07, 0.05], 6, color=lambda i, p: (0.56, 0.40, 0.24))
    for foot in ((0, 1.5, -3.75), (0.9, 1.0, -0.9), (-0.9, 1.0, -0.9), (0, 1.3, 3.5)):
        trim.tube([foot, add(mast, (0, 8.8, 0))], [0.018, 0.018], 3, color=lambda i, p: (0.25, 0.22, 0.2))
    trim.write(FOLDER)
    sails = Model("sails", 3)

    def sail(tack, clew, head, belly):
        def place(u, v):
            p = mix(mix(tack, clew, u), head, v)
            return add(p, (belly * sin(pi * u) * (1 - v) ** 0.8 * (0.3 + sin(pi * min(v + 0.15, 1))), 0, 0))

        def color(u, v, p):
            return mix((0.98, 0.93, 0.82), (0.86, 0.76, 0.62), clamp(0.55 * v + 0.5 * fractal(u * 3, v * 4, 2) - 0.1))

        sails.grid(place, 10, 18, color=color)

    sail(add(mast, (0.02, 1.45, 0.12)), add(mast, (0.52, 1.5, 4.3)), add(mast, (0, 8.6, 0.1)), 0.55)
    sail((0, 1.75, -3.6), add(mast, (0.35, 0.9, 0.1)), add(mast, (0, 7.6, -0.1)), 0.4)
    sails.write(FOLDER)


def jetty_model():
    jetty = Model("jetty", 2)
    rng = Rng(11)
    x, y = JETTY
    z = 24.0
    while z > -13.5:
        tone = rng.between(0.75, 1.1)
        lift, slip = rng.between(-0.02, 0.02), rng.between(-0.12, 0.12)
        color = lambda p, tone=tone: tuple(c * tone * (0.85 + 0.3 * noise(p[0] * 2.5, p[2] * 9)) for c in (0.46, 0.36, 0.29))
        jetty.box((x - 1.3 + slip, y - 0.14 + lift, z - 0.55), (x + 1.3 + slip, y + lift, z), 0.02, color=color)
        z -= 0.60
    for k in range(7):
        for side in (-1.15, 1.15):
            post = (x + side, 0, 22.0 - 6.0 * k)
            top = y + (0.75 if side > 0 else 0.4)
            wet = lambda i, p: mix((0.12, 0.13, 0.11), (0.40, 0.31, 0.25), smooth(0.1, 0.8, p[1]))
            jetty.tube([add(post, (0, h, 0)) for h in (-1.2, 0.2, 0.7, top)], [0.17, 0.17, 0.16, 0.15], 10, color=wet)
    for lantern in LANTERNS:
        foot = (lantern[0], y, lantern[2])
        iron = lambda i, p: (0.10, 0.11, 0.12)
        jetty.tube([foot, add(foot, (0, 2.1, 0))], [0.06, 0.045], 8, color=iron)
        jetty.lathe([(0, 2.75), (0.05, 2.75), (0.3, 2.55), (0.28, 2.52), (0, 2.6)][::-1], 12, at=lambda p, f=foot: add(f, p), color=lambda i, n, p: (0.10, 0.11, 0.12))
        jetty.lathe([(0, 2.08), (0.2, 2.1), (0.2, 2.16), (0, 2.16)], 12, at=lambda p, f=foot: add(f, p), color=lambda i, n, p: (0.10, 0.11, 0.12))
    jetty.write(FOLDER)
    lamp = Model("lamp", 3)
    lamp.lathe([(0, -0.22), (0.13, -0.2), (0.17, 0), (0.13, 0.2), (0, 0.22)], 12, uv=True)
    lamp.write(FOLDER)
    picture(f"{FOLDER}/lamp.png", 1, 16, lambda i, j: j, ramp([(0, (255, 206, 120)), (0.5, (255, 246, 208)), (1, (255, 214, 130))], 16))


def lighthouse_model():
    tower = Model("lighthouse", 3)

    def color(i, n, p):
        band = int(p[1] / 2.5) % 2
        return (0.78, 0.16, 0.13) if band and p[1] < 14.5 else (0.95, 0.92, 0.86)

    profile = [(0, 0), (2.3, 0), (2.35, 0.3)]
    for k in range(1, 7):
        y = 2.5 * k
        r = mix(2.2, 1.45, y / 15)
        profile += [(r + 0.002, y - 0.01), (r, y + 0.01)] if k < 6 else [(r, y)]
    profile += [(2.0, 15.2), (2.0, 15.5), (1.15, 15.5), (1.1, 15.6)]
    tower.lathe(profile, 28, color=color)
    for k in range(10):
        a = 2 * pi * k / 10
        post = (1.9 * sin(a), 15.5, 1.9 * cos(a))
        tower.tube([post, add(post, (0, 0.8, 0))], [0.04, 0.04], 4, color=lambda i, p: (0.15, 0.15, 0.17))
    tower.lathe([(0.98, 17.5), (1.35, 17.5), (1.4, 17.6), (0.9, 18.3), (0.2, 18.8), (0.12, 19.4), (0, 19.5)], 20, color=lambda i, n, p: (0.56, 0.12, 0.10))
    tower.write(FOLDER)
    light = Model("light", 3)
    light.lathe([(0, 15.6), (0.95, 15.6), (0.95, 17.5), (0, 17.5)], 16, uv=True)
    light.write(FOLDER)
    rock = Model("rock", 2)

    def stone(p):
        a = fractal(p[0] * 0.35 + 20, p[2] * 0.35 + p[1] * 0.5, 4)
        return mix((0.20, 0.17, 0.18), (0.46, 0.38, 0.35), a)

    profile = [(9.5, -1.0), (9.2, 0.2), (8.2, 1.2), (6.6, 2.0), (5.0, 2.5), (3.4, 2.7), (0, 2.75)]

    def bulge(angle, i):
        return 1 + 0.55 * (fractal(4 + 2.2 * sin(angle), 4 + 2.2 * cos(angle) + 0.3 * i, 3) - 0.5) * (1 if i < 5 else 0.3)

    rock.lathe(profile, 36, color=lambda i, n, p: stone(p), bulge=bulge)
    rock.write(FOLDER)


def town_model():
    """Houses on a quay at the left, with windows lit in a texture, and hills behind."""
    town = Model("town", 2)
    rng = Rng(23)
    x = -88.0
    while x < -15.0:
        wide, high, deep = rng.between(5.5, 9.0), rng.between(6.5, 12.0), 8.0
        z = -78.0 + rng.between(-1.5, 1.5)
        shift, tone = int(rng.between(0, 4)) / 4, int(rng.between(0, 4)) / 4
        low, mid = 1.4, 1.4 + high
        a, b, c, d = [(x, low, z), (x + wide, low, z), (x + wide, mid, z), (x, mid, z)]
        v = tone + 0.005, tone + 0.2
        span = wide / 16
        front = [town.point(p) for p in (a, b, c, d)]
        town.face(front, [town.uv(shift, v[0]), town.uv(shift + span, v[0]), town.uv(shift + span, v[1]), town.uv(shift, v[1])])
        back = [town.point(add(p, (0, 0, -deep))) for p in (a, b, c, d)]
        plain = town.uv(0.002, tone + 0.1)
        for i, k in ((1, 2), (3, 0)):
            town.face([front[i], back[i], back[k], front[k]], [plain] * 4)
        roof = town.uv(0.5, tone + 0.235)
        ridge = [town.point((x + wide / 2, mid + wide * 0.42, z + 0.3)), town.point((x + wide / 2, mid + wide * 0.42, z - deep))]
        eaves = [town.point(p) for p in ((x - 0.3, mid - 0.2, z + 0.3), (x + wide + 0.3, mid - 0.2, z + 0.3), (x + wide + 0.3, mid - 0.2, z - deep), (x - 0.3, mid - 0.2, z - deep))]
        town.face([eaves[1], eaves[2], ridge[1], ridge[0]], [roof] * 4)
        town.face([eaves[3], eaves[0], ridge[0], ridge[1]], [roof] * 4)
        gable = town.uv(0.002, tone + 0.1)
        town.face([front[3], front[2], town.point((x + wide / 2, mid + wide * 0.42, z))], [gable] * 3)
        if rng.next() < 0.6:
            cx = x + wide * rng.between(0.25, 0.75)
            town.box((cx - 0.5, mid, z - 4), (cx + 0.5, mid + wide * 0.42 + 1.0, z - 3), uv=lambda p, n, r=tone: (0.5, r + 0.235))
        x += wide + rng.between(0, 0.25)
    town.box((-120, -1.5, -90), (-12, 1.4, -72), 0.2, uv=lambda p, n: (0.5, 0.985))
    town.write(FOLDER)
    wide, high = 256, 256
    walls = [(150, 112, 96), (166, 128, 92), (128, 104, 112), (158, 106, 86)]
    windows = Rng(3)
    lit = [windows.next() for _ in range(4 * 16 * 3)]

    def index(i, j):
        v = 1 - (j + 0.5) / high
        row, inside = int(v * 4), v * 4 % 1
        if inside > 0.87:
            return 12 + (1 if (i + j) % 3 else 0) if row < 3 or inside < 0.93 else 14
        floor_number, y = int(inside / 0.86 * 3), inside / 0.86 * 3 % 1
        column, x = i * 16 // wide, i * 16 / wide % 1
        if 0.30 < x < 0.72 and 0.28 < y < 0.78:
            frame = abs(x - 0.51) < 0.04 or abs(y - 0.55) < 0.03
            state = lit[(row * 16 + column) * 3 + min(floor_number, 2)]
            return 10 if frame else 8 if state > 0.62 else 9 if state > 0.45 else 11
        return row * 2 + (1 if noise(i * 0.6, j * 0.6) > 0.55 else 0)

    tones = []
    for wall in walls:
        tones += [tuple(c * 0.62 for c in wall), tuple(c * 0.56 for c in wall)]
    tones += [(255, 212, 120), (250, 170, 82), (70, 52, 48), (44, 40, 58), (92, 46, 42), (80, 38, 38), (84, 72, 74)]
    picture(f"{FOLDER}/town.png", wide, high, index, tones)
    hills = Model("hills", 1)

    def ridge(base, height, z, seed, rows):
        def place(u, v):
            x = -520 + 1040 * u
            top = base + height * fractal(x * 0.008 + seed, seed, 4) ** 1.6
            top *= 0.25 + 0.75 * smooth(-30, -230, x) + 0.35 * smooth(60, 300, x)
            return (x, mix(-3, top, v), z)

        hills.grid(place, 90, 1, color=lambda u, v, p: rows[1] if v else rows[0])

    ridge(6, 110, -420, 3.0, [(0.68, 0.42, 0.42), (0.46, 0.30, 0.40)])
    ridge(4, 72, -300, 9.0, [(0.46, 0.28, 0.34), (0.30, 0.20, 0.30)])
    hills.write(FOLDER)


def birds_model():
    birds = Model("birds", 3)
    for x, y, z, size, bank in ((-2, 13.5, -20, 0.9, 0.2), (1.2, 14.6, -24, 0.8, -0.3), (4.0, 12.9, -18, 0.7, 0.5), (7.0, 15.4, -30, 0.9, 0.1), (-6.0, 15.8, -30, 0.9, -0.2)):
        turn = lambda p, x=x, y=y, z=z, s=size, b=bank: (x + s * (p[0] * cos(b) - p[1] * sin(b)), y + s * (p[0] * sin(b) + p[1] * cos(b)), z + s * p[2])
        for side in (-1, 1):
            wing = [(0, 0, -0.16), (0, 0, 0.2), (side * 0.6, 0.28, 0.16), (side * 1.3, 0.12, 0.3), (side * 0.62, 0.3, -0.1)]
            birds.face([birds.point(turn(p), (0.16, 0.13, 0.17)) for p in (wing if side < 0 else wing[::-1])])
    birds.write(FOLDER)


def scene():
    scene = Scene(FOLDER, (255, 190, 120))
    white = (1.0, 1.0, 1.0)
    flat = material(white, 1.0, 0.0, 1.0)
    selected = None
    for name, at, turn, size, tint in BOATS:
        at = (at[0], wave(at[0], at[2], 1.0) - 0.05, at[2])
        hull = material(tuple(c / 255 for c in tint), 0.5, 0.55, 50.0)
        lean = 3.0 if name != "blue boat" else -2.0
        id = scene.object(name, "hull", hull, placed(at, turn, size, lean), crease=50.0, sides="Two")
        selected = selected or id
        scene.object(f"{name}: rig", "rig", material(white, 0.5, 0.2, 20.0), placed(at, turn, size, lean), sides="Two")
        scene.object(f"{name}: sails", "sails", material((0.96, 0.94, 0.90), 0.62, 0.05, 6.0), placed(at, turn, size, lean), sides="Two")
    scene.object("jetty", "jetty", material(white, 0.5, 0.12, 14.0))
    for k, at in enumerate(LANTERNS):
        scene.object(f"lantern {k + 1}", "lamp", flat, placed((at[0], at[1] - 0.02, at[2])), texture="lamp.png", surface="Texture")
    scene.object("lighthouse", "lighthouse", material(white, 0.5, 0.2, 20.0), placed(LIGHTHOUSE), crease=40.0)
    scene.object("light of the lighthouse", "light", flat, placed(LIGHTHOUSE), texture="lamp.png", surface="Texture")
    scene.object("rock", "rock", material(white, 0.5, 0.15, 10.0), placed((LIGHTHOUSE[0], 0, LIGHTHOUSE[2])), crease=25.0, sides="Two")
    scene.object("town", "town", material(white, 0.95, 0.0, 1.0), texture=("town.png", "Repeat"), sides="Two")
    scene.object("gulls", "birds", material(white, 0.8, 0.0, 1.0), sides="Two")
    scene.object("hills", "hills", material(white, 1.0, 0.0, 1.0), sides="Two")
    scene.object("sea", "sea", material(white, 0.62, (1.0, 0.74, 0.48), 110.0), sides="Two")
    scene.object("sky", "sky", flat, texture="sky.png", surface="Texture", sides="Two")
    scene.light("sky", "Ambient", (214, 186, 196))
    scene.light("sunset", sun(add((0, 0, 0), SUN, -1)), (255, 172, 104))
    scene.light("evening sky", sun((0.4, -0.8, -0.5)), (88, 84, 120))
    for k, at in enumerate(LANTERNS):
        scene.light(f"lantern {k + 1}", bulb(at), (255, 178, 92), (1.0, 0.0, 0.12))
    top = add(LIGHTHOUSE, (0, 16.6, 0))
    scene.light("lighthouse", spot(top, (-6, 0.5, -6), 9.0, 4.0), (120, 112, 84))
    scene.write("A harbour at sunset", EYE, (1.3, 4.9, 0.0), 20.0, 1.0, 1500.0, selected)


def make():
    sky_model()
    sea_model()
    boat_model()
    jetty_model()
    lighthouse_model()
    town_model()
    birds_model()
    scene()


if __name__ == "__main__":
    make()
