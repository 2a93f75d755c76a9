"""Answers: what is on the table of the still life?

A bowl of fruit on a gingham cloth, a bottle, a candle and a cut orange, lit by a window at the left and the candle.
Lengths are centimetres; the table's top is y = 0.
"""

from kit import *

FOLDER = "still-life"
WINDOW = unit((-0.72, 0.62, 0.42))  # towards the window's light
TABLE = (64.0, 34.0)  # half of its length and depth
BOWL = (-9.0, 0.35, -5.0)
BOTTLE = (18.5, 0.0, -13.0)
CANDLE = (-32.0, 0.0, -9.0)
PEAR = (15.5, 0.35, 10.5)
LEMON = (7.5, 3.3, 17.5)
HALF = (24.0, 0.35, 4.5)
FLAME = add(CANDLE, (0, 23.2, 0))

BOWL_PROFILE = [(0, 0), (6.2, 0), (6.5, 0.5), (5.6, 1.3), (9.0, 2.6), (12.6, 4.9), (15.2, 7.6), (16.8, 10.2)]
BOWL_PROFILE += [(17.2, 10.5), (16.9, 10.8), (16.3, 10.3), (14.5, 7.9), (12.0, 5.5), (8.4, 3.4), (4.0, 2.4), (0, 2.2)]
BOTTLE_PROFILE = [(0, 0), (3.9, 0), (4.4, 0.5), (4.5, 2), (4.5, 17.5), (4.2, 20), (3.2, 22.2), (2.1, 23.8), (1.65, 25.5)]
BOTTLE_PROFILE += [(1.5, 30.2), (1.85, 30.3), (1.85, 31.6), (1.5, 31.8), (0, 31.8)]
HOLDER_PROFILE = [(0, 0), (6.2, 0), (6.6, 0.4), (6.2, 0.9), (3.6, 1.5), (1.6, 2.6), (1.1, 4.2), (1.6, 5.2), (2.1, 5.6)]
HOLDER_PROFILE += [(1.5, 6.1), (1.3, 7.2), (2.5, 8.4), (3.0, 9.2), (2.7, 9.3), (2.0, 8.7), (0, 8.7)]


def fruit_places():
    """(kind, centre, turn) of the fruit in the bowl: four of five places below, three above."""
    kinds = {0: "apple", 1: "orange", 3: "orange", 4: "orange"}
    places = []
    for i, kind in kinds.items():
        angle = 2 * pi * (i + 0.15) / 5
        places.append((kind, add(BOWL, (7.6 * sin(angle), 8.0, 7.6 * cos(angle))), 70.0 * i))
    for i, kind in enumerate(["orange", "apple", "apple"]):
        angle = 2 * pi * (i + 0.42) / 3
        places.append((kind, add(BOWL, (4.3 * sin(angle), 14.0, 4.3 * cos(angle))), 130.0 * i + 20))
    return places


def occluders():
    shade = Shade()
    for _, centre, _ in fruit_places():
        shade.sphere(centre, 4.4)
    for i in range(16):
        angle = 2 * pi * i / 16
        shade.sphere(add(BOWL, (12.5 * sin(angle), 7.0, 12.5 * cos(angle))), 3.6)
        shade.sphere(add(BOWL, (6.5 * sin(angle), 3.0, 6.5 * cos(angle))), 2.8)
    shade.sphere(add(BOWL, (0, 4, 0)), 4.5)
    shade.column(BOTTLE, BOTTLE_PROFILE, 9)
    shade.column(CANDLE, HOLDER_PROFILE, 6)
    shade.column(add(CANDLE, (0, 8.7, 0)), [(1.7, 0), (1.7, 12)], 6)
    shade.sphere(add(PEAR, (0, 4.2, 0)), 4.3)
    shade.sphere(add(PEAR, (0.9, 8.2, 0)), 2.6)
    shade.sphere(LEMON, 3.2)
    shade.sphere(add(HALF, (0, 2.4, 0)), 3.6)
    for p in grapes():
        shade.sphere(p, 1.35)
    return shade


def grapes():
    """Centres of the grapes: a bunch that lies beside the bowl, thinner towards its end."""
    rng = Rng(5)
    places = []
    for layer, rows in enumerate(([4, 4, 4, 3, 3, 2, 1], [3, 3, 2, 2, 1], [2, 1])):
        for row, count in enumerate(rows):
            for i in range(count):
                along = 2.15 * (row + 0.55 * layer) + rng.between(-0.25, 0.25)
                aside = 2.45 * (i - (count - 1) / 2) + rng.between(-0.3, 0.3)
                height = 1.65 + 1.75 * layer + rng.between(-0.15, 0.15)
                places.append((-10.0 + 0.93 * along + 0.36 * aside, height, 14.5 - 0.36 * along + 0.93 * aside))
    return places


def light_on(shade, p, normal, but=None):
    """Light on a point from 0 to 1: the window's, hidden or not, and the sky's."""
    return (1 - 0.62 * shade.hidden(p, WINDOW, 0.10, but)) * (0.35 + 0.65 * shade.ambient(p, normal, but))


def table_model(shade):
    table = Model("table", 2)
    x, z = TABLE
    top = lambda p, n: ((p[0] + x) / (2 * x), (p[2] + z) / (2 * z))
    table.box((-x, -5, -z), (x, 0, z), 0.7, uv=top)
    table.write(FOLDER)
    wide, deep = 640, 320
    floor_light = lambda i, j: light_on(shade, (-x + 2 * x * (i + 0.5) / wide, 0, z - 2 * z * (j + 0.5) / deep), (0, 1, 0))
    lit = coarse(wide, deep, 6, floor_light)

    def texel(i, j):
        px, pz = -x + 2 * x * (i + 0.5) / wide, z - 2 * z * (j + 0.5) / deep
        board = floor((pz + z) / 17.0)
        grain = wood(px + 61 * board, (pz + z) * 0.21 + 13.7 * board, 1.6)
        edge = (pz + z) % 17.0
        light = lit(i, j) * (0.45 + 0.55 * smooth(0.0, 0.35, min(edge, 17 - edge)))
        # Light falls off away from the window.
        light *= 1.0 - 0.38 * smooth(-40, 75, px)
        return int(clamp(0.15 + 0.85 * grain) * 11.99), light

    tones = ramp([(0, (88, 46, 22)), (0.35, (122, 70, 35)), (0.7, (150, 92, 49)), (1, (176, 116, 66))], 12)
    shaded_picture(f"{FOLDER}/table.png", wide, deep, tones, texel, (0.16, 0.12, 0.14))


def cloth_model(shade):
    """The cloth lies with a corner over the table's edge; folds begin where it hangs."""
    cloth = Model("cloth", 2)
    side, turn = 27.0, 38 * pi / 180
    edge = TABLE[1] + 0.2
    middle = (1.5, 9.0)

    def flat(u, v):
        s, t = (2 * u - 1) * side, (1 - 2 * v) * side
        return (middle[0] + s * cos(turn) + t * sin(turn), middle[1] - s * sin(turn) + t * cos(turn))

    def place(u, v):
        x, z = flat(u, v)
        lift = 0.22 + 0.5 * fractal(x * 0.13 + 5, z * 0.13, 2) ** 2
        rim = min(u, 1 - u, v, 1 - v)
        lift *= 0.35 + 0.65 * smooth(0, 0.1, rim)
        if z <= edge - 0.8:
            return (x, lift, z)
        over = z - (edge - 0.8)
        bend = min(over / 1.3, pi / 2)
        y = lift - 0.8 * (1 - cos(bend)) - max(over - 1.3 * pi / 2, 0)
        out = edge - 0.8 + 0.8 * sin(bend)
        fold = smooth(0, 9, over) * (0.9 * sin(x * 0.62 + 0.6) + 0.5 * sin(x * 1.35 + 2.0))
        return (x, y, out + 0.55 * (1 + fold) * smooth(0, 6, over))

    cloth.grid(place, 36, 36, uv=True)
    cloth.write(FOLDER)
    count = 448
    lit = coarse(count, count, 6, lambda i, j: light_on(shade, place((i + 0.5) / count, 1 - (j + 0.5) / count), (0, 1, 0)))

    def texel(i, j):
        u, v = (i + 0.5) / count, 1 - (j + 0.5) / count
        p = place(u, v)
        checks = 13
        a, b = int(u * checks) % 2, int(v * checks) % 2
        # A thread of the warp, or of the weft, lies above.
        thread = (i // 2 + j // 2) % 2
        rim = min(u, 1 - u, v, 1 - v)
        tone = 3 * (a + b) + (1 if thread else 0) if rim > 0.018 else 7
        if (i * 7 + j * 3) % 5 == 0:
            tone = min(tone + 1, 8)
        hangs = smooth(0, 3, p[2] - TABLE[1] + 0.5)
        light = mix(lit(i, j), 0.78, hangs) * (1.0 - 0.3 * smooth(-40, 75, p[0]))
        return tone, light

    tones = [(244, 238, 226), (238, 231, 217), (232, 224, 210), (205, 112, 104), (196, 102, 96), (188, 92, 88)]
    tones += [(166, 30, 36), (156, 26, 32), (146, 22, 28)]
    shaded_picture(f"{FOLDER}/cloth.png", count, count, tones, texel, (0.2, 0.14, 0.2))


def bowl_model(shade):
    bowl = Model("bowl", 3)
    bowl.lathe(BOWL_PROFILE, 48, uv=True, around=1)
    inside = Shade()
    inside.spheres = [(sub(centre, BOWL), 4.4) for _, centre, _ in fruit_places()]
    for i, p in enumerate(bowl.points):
        row = 0 if i == 0 else 1 + (i - 1) // 48
        if row >= 10:
            normal = unit((-p[0], 9.0, -p[2]))
            light = (1 - 0.5 * inside.hidden(p, WINDOW, 0.15)) * inside.ambient(p, normal) * (0.62 + 0.036 * p[1])
        else:
            light = 0.62 + 0.38 * smooth(0, 9, p[1])
        bowl.colors[i] = (light, light, light)
    bowl.write(FOLDER)
    wide, high = 1024, 256

    def index(i, j):
        u, v = i / wide, 1 - (j + 0.5) / high
        if v > 0.5:  # within: plain, with a line near the rim
            return 2 if 0.56 < v < 0.575 else 0
        leaf = u * 16 % 1 - 0.5
        row = (v - 0.36) / 0.09
        petal = abs(leaf) * 2.2 + abs(row) ** 1.5
        stalk = abs(row - 0.55 * sin(u * 32 * pi)) < 0.10
        if abs(v - 0.262) < 0.006 or abs(v - 0.456) < 0.010 or abs(v - 0.10) < 0.02:
            return 2
        if abs(row) < 1 and petal < 0.72:
            return 3 if petal < 0.22 else 2 if petal < 0.6 else 1
        if abs(row) < 1 and stalk:
            return 1
        return 0

    picture(f"{FOLDER}/bowl.png", wide, high, index, [(240, 236, 224), (120, 150, 200), (32, 66, 150), (222, 172, 60)])


def apple_model():
    apple = Model("apple", 3)
    rows = 18
    profile = []
    for i in range(rows + 1):
        a = pi * i / rows
        r = 4.5 * sin(a) * (1 - 0.06 * cos(a)) ** -1
        dent = 1.1 * exp(-((pi - a) / 0.42) ** 2) + 0.7 * exp(-(a / 0.35) ** 2)
        y = -4.05 * cos(a) + (dent if a < pi / 2 else -dent * 1.25)
        profile.append((r if 0 < i < rows else 0, y))

    def color(i, count, p):
        h = (p[1] + 4) / 8
        angle = 0.5 + 0.5 * sin(0.9 + 1.0 * (1 if p[0] > 0 else -1) * 0 + p[0] * 0.42 + p[2] * 0.28)
        streak = fractal(p[0] * 1.1 + 9, p[2] * 1.1 + p[1] * 0.1, 3)
        red = smooth(0.18, 0.78, 0.5 * angle + 0.45 * streak + 0.2 * h - 0.12)
        base = mix((0.78, 0.66, 0.22), (0.70, 0.07, 0.06), red)
        hollow = smooth(0.0, 1.3, sqrt(p[0] ** 2 + p[2] ** 2))
        return mix((0.42, 0.36, 0.10), base, hollow if h > 0.6 else 1)

    apple.lathe(profile, 28, color=color, bulge=lambda angle, i: 1 + 0.018 * cos(5 * angle) * (1 - i / rows))
    apple.tube([(0, 2.4, 0), (0.15, 3.6, 0.05), (0.55, 4.9, 0.2)], [0.16, 0.13, 0.2], 6, color=lambda i, p: (0.26, 0.17, 0.09))
    apple.write(FOLDER)


def orange_model():
    orange = Model("orange", 3)
    orange.ball((0, 0, 0), 4.35, 28, 18, color=lambda i, count, p: mix((0.93, 0.46, 0.06), (0.85, 0.36, 0.03), noise(p[0] * 1.7 + 30, p[2] * 1.7 + p[1] * 2)) if i < count - 2 else (0.35, 0.36, 0.10))
    orange.write(FOLDER)


def lemon_model():
    lemon = Model("lemon", 3)
    profile = [(0, -4.6), (0.5, -4.45), (0.75, -4.0)]
    profile += [(3.05 * sin(pi * (0.13 + 0.74 * i / 12)) ** 0.9, -3.7 + 7.4 * i / 12) for i in range(1, 12)]
    profile += [(0.95, 3.85), (0.6, 4.5), (0, 4.8)]
    # It lies: its axis is X.
    lemon.lathe(profile, 24, at=lambda p: (p[1], -p[0], p[2]), color=lambda i, n, p: mix((0.96, 0.80, 0.12), (0.90, 0.70, 0.08), noise(p[0] * 2, p[2] * 2 + p[1])))
    lemon.write(FOLDER)


def pear_model(shade):
    pear = Model("pear", 3)
    profile = [(0, 0.5), (0.9, 0.15), (2.2, 0.35), (3.5, 1.4), (4.2, 3.2), (4.25, 4.6), (3.7, 6.2), (2.9, 7.6), (2.3, 8.9)]
    profile += [(2.0, 10.0), (1.65, 10.9), (1.0, 11.5), (0.4, 11.6), (0, 11.4)]
    lean = lambda p: (p[0] + 0.012 * p[1] ** 2, p[1], p[2])

    def color(i, n, p):
        spots = noise(p[0] * 3.1 + 8, p[1] * 3.1 + p[2] * 2.3)
        blush = smooth(0.35, 0.9, fractal(p[0] * 0.35 + 3, p[1] * 0.3 + p[2] * 0.3, 2) + 0.06 * p[0])
        return mix(mix((0.62, 0.66, 0.16), (0.80, 0.46, 0.14), blush), (0.48, 0.42, 0.14), smooth(0.72, 0.95, spots) * 0.7)

    pear.lathe(profile, 26, at=lean, color=color)
    pear.tube([(1.6, 11.2, 0), (1.8, 12.6, 0.1), (2.4, 13.9, 0.3)], [0.2, 0.16, 0.24], 6, color=lambda i, p: (0.25, 0.16, 0.08))
    pear.write(FOLDER)


def half_model():
    """Half an orange: peel below, flesh above, with a texture of its segments."""
    half = Model("half", 3)
    rows = 9
    profile = [(0, -4.2)] + [(4.3 * sin(pi / 2 * i / rows), -4.3 * cos(pi / 2 * i / rows)) for i in range(1, rows + 1)]
    rings = []
    for r, y in profile:
        rings.append([half.point((r * sin(2 * pi * j / 32), y, r * cos(2 * pi * j / 32))) for j in range(32 if r else 1)])
    rim = half.uv(0.995, 0.5)
    for low, high in zip(rings, rings[1:]):
        for j in range(32):
            k = (j + 1) % 32
            corners = [low[j], low[k], high[k], high[j]] if len(low) > 1 else [low[0], high[k], high[j]]
            half.face(corners, [rim] * len(corners))
    top = rings[-1]
    cut = [half.point((4.3 * sin(2 * pi * j / 32), 0.0, 4.3 * cos(2 * pi * j / 32))) for j in range(32)]
    place = lambda i: (0.5 + half.points[i - 1][0] / 8.9, 0.5 + half.points[i - 1][2] / 8.9)
    half.face(cut, [half.uv(*place(i)) for i in cut])
    half.write(FOLDER)
    count = 192

    def index(i, j):
        x, y = (i + 0.5) / count * 2 - 1, (j + 0.5) / count * 2 - 1
        r = sqrt(x * x + y * y)
        if r > 0.945:
            return 0
        if r > 0.84:
            return 1
        angle = (0.0 if r == 0 else acos(clamp(x / r, -1, 1)) * (1 if y > 0 else -1)) / (2 * pi) * 10 + 0.2
        off = abs(angle - floor(angle) - 0.5)
        wall = (0.5 - off) * r * 0.63
        if r < 0.07 or wall < 0.016:
            return 1
        pulp = noise(r * 9 + 3 * floor(angle), (angle % 1) * (5 + 9 * r) + 31 * floor(angle))
        return 2 + int(pulp * 5.99)

    tones = [(232, 118, 16), (250, 226, 176)] + ramp([(0, (232, 120, 20)), (1, (255, 176, 62))], 6)
    picture(f"{FOLDER}/half.png", count, count, index, tones)


def bunch_model(shade):
    bunch = Model("grapes", 3)
    places = grapes()
    for n, centre in enumerate(places):
        def color(i, count, p, centre=centre, n=n):
            others = lambda c: c == centre
            tone = mix((0.20, 0.06, 0.20), (0.34, 0.10, 0.22), noise(n * 1.7, 3.0))
            bloom = noise(p[0] * 1.5, p[2] * 1.5 + p[1])
            tone = mix(tone, (0.45, 0.36, 0.50), 0.28 * bloom)
            light = 0.35 + 0.65 * light_on(shade, p, unit(sub(p, centre)), others)
            return tuple(c * light for c in tone)

        bunch.ball(centre, 1.35, 12, 8, color=color)
    stalk = [(-8.5, 2.8, 14.2), (-11.5, 2.6, 15.2), (-13.4, 2.2, 15.6), (-15.0, 2.9, 15.2)]
    bunch.tube(stalk, [0.22, 0.2, 0.22, 0.34], 6, color=lambda i, p: (0.36, 0.26, 0.10))
    bunch.write(FOLDER)


def bottle_model():
    bottle = Model("bottle", 3)
    bottle.lathe(BOTTLE_PROFILE, 40)
    bottle.write(FOLDER)
    cork = Model("cork", 3)
    cork.lathe([(0, 30.5), (1.35, 30.5), (1.35, 33.2), (1.2, 33.4), (0, 33.4)], 20, color=lambda i, n, p: mix((0.66, 0.48, 0.30), (0.52, 0.36, 0.20), noise(p[0] * 7, p[2] * 7 + p[1] * 5)))
    cork.write(FOLDER)
    label = Model("label", 3)

    def place(u, v):
        angle = (u - 0.5) * 2.3
        return (4.54 * sin(angle), 5.0 + 9.5 * v, 4.54 * cos(angle))

    label.grid(place, 20, 1, uv=True)
    label.write(FOLDER)
    wide, high = 208, 192

    def index(i, j):
        x, y = (i + 0.5) / wide, (j + 0.5) / high
        rim = min(x * wide, (1 - x) * wide, y * high, (1 - y) * high)
        if 5 <= rim < 8 or 10 <= rim < 11:
            return 1
        # A sun over three hills.
        px, py = x - 0.5, y - 0.42
        r = sqrt(px * px * 1.15 + py * py)
        hill = 0.56 + 0.045 * sin(x * 17) + 0.03 * sin(x * 9 + 1)
        if 0.14 < x < 0.86:
            if hill < y < 0.80:
                return 3 if int((y - hill) * 90 + 6 * sin(x * 17)) % 3 else 4
            if r < 0.13 and y <= hill:
                return 2
            ray = (acos(clamp(px * 1.07 / max(r, 1e-9), -1, 1)) / pi * 11) % 1
            if 0.155 < r < 0.235 and y < hill - 0.01 and ray < 0.42:
                return 2
        if 0.84 < y < 0.895 and 0.2 < x < 0.8 and int(x * 46) % 4 != 0:
            return 1
        return 0

    picture(f"{FOLDER}/label.png", wide, high, index, [(236, 224, 194), (122, 40, 30), (214, 150, 40), (86, 104, 52), (120, 134, 66)])


def candle_model():
    holder = Model("holder", 3)
    holder.lathe(HOLDER_PROFILE, 36)
    handle = [(6.0 + 2.3 * sin(a), 2.6 - 2.2 * cos(a), 0.0) for a in [pi * k / 8 for k in range(-1, 9)]]
    holder.tube(handle, [0.42] * len(handle), 8)
    holder.write(FOLDER)
    candle = Model("candle", 3)
    glow = lambda i, n, p: mix((0.80, 0.72, 0.58), (1.0, 0.86, 0.58), smooth(10, 21, p[1]))
    profile = [(0, 8.6), (1.65, 8.6), (1.7, 12), (1.65, 17), (1.68, 19.6), (1.5, 20.1), (1.15, 19.9), (0, 19.5)]
    candle.lathe(profile, 24, color=glow, bulge=lambda a, i: 1 + (0.05 * sin(3 * a + i) if 1 < i < 6 else 0))
    for angle, low in ((0.4, 15.5), (2.2, 17.3), (4.4, 13.2)):
        drip = [(1.72 * sin(angle), y, 1.72 * cos(angle)) for y in (low, low + 0.6, low + 2.2, 19.8)]
        candle.tube(drip, [0.2, 0.34, 0.24, 0.2], 8, color=lambda i, p: (0.96, 0.84, 0.60))
    candle.tube([(0, 19.4, 0), (0.05, 20.4, 0), (0.2, 21.2, 0)], [0.12, 0.1, 0.08], 6, color=lambda i, p: (0.08, 0.06, 0.05))
    candle.write(FOLDER)
    flame = Model("flame", 3)
    flame.lathe([(0, 20.7), (0.42, 21.1), (0.72, 21.9), (0.74, 22.7), (0.5, 23.9), (0.2, 25.2), (0, 26.1)], 16, uv=True)
    flame.write(FOLDER)
    stops = [(0, (90, 110, 230)), (0.14, (255, 150, 50)), (0.4, (255, 226, 130)), (0.62, (255, 244, 190)), (1, (255, 176, 60))]
    picture(f"{FOLDER}/flame.png", 1, 64, lambda i, j: 63 - j, ramp(stops, 64))


def wall_model():
    wall = Model("wall", 1)
    wall.grid(lambda u, v: (-190 + 380 * u, -70 + 190 * v, -58), 1, 1, uv=True)
    wall.write(FOLDER)
    wide, high = 384, 192

    def texel(i, j):
        x, y = -190 + 380 * (i + 0.5) / wide, -70 + 190 * (1 - (j + 0.5) / high)
        plaster = fractal(x * 0.03 + 50, y * 0.03 + 7, 5)
        beam = smooth(70, -15, abs(y - 34 + 0.34 * (x + 30)) + 0.10 * max(x + 30, 0))
        glow = exp(-((x + 37) ** 2 + (y - 24) ** 2) / 900)
        corner = smooth(200, 60, sqrt(x * x + (y - 20) ** 2))
        light = (0.20 + 0.55 * beam) * (0.4 + 0.6 * corner) + 0.3 * glow
        return int(clamp(0.5 + (plaster - 0.5) * 1.5) * 7.99), light

    tones = ramp([(0, (126, 112, 92)), (1, (164, 148, 122))], 8)
    shaded_picture(f"{FOLDER}/wall.png", wide, high, tones, texel, (0.10, 0.075, 0.07), steps=30)


def make():
    shade = occluders()
    table_model(shade)
    cloth_model(shade)
    bowl_model(shade)
    apple_model()
    orange_model()
    lemon_model()
    pear_model(shade)
    half_model()
    bunch_model(shade)
    bottle_model()
    candle_model()
    wall_model()
    scene()


def scene():
    scene = Scene(FOLDER, (18, 14, 12))
    white = (1.0, 1.0, 1.0)
    waxy = material(white, 0.32, 0.22, 24.0)
    bowl = scene.object("bowl", "bowl", material(white, 0.36, 0.55, 70.0), placed(BOWL), texture="bowl.png")
    for n, (kind, centre, turn) in enumerate(fruit_places()):
        lean = (-14.0, 22.0, 9.0, -25.0, 16.0, 12.0, -20.0, 26.0)[n]
        shine = waxy if kind == "orange" else material(white, 0.30, 0.42, 48.0)
        scene.object(f"{kind} {n + 1}", kind, shine, placed(centre, turn, 1.0, lean))
    scene.object("pear", "pear", material(white, 0.32, 0.16, 18.0), placed(PEAR, 200.0))
    scene.object("lemon", "lemon", waxy, placed(LEMON, 24.0))
    scene.object("half an orange", "half", material(white, 0.42, 0.30, 30.0), placed(add(HALF, (0, 3.9, 0)), 30.0, 1.0, 0.0), texture="half.png")
    scene.object("grapes", "grapes", material(white, 0.34, 0.50, 60.0))
    scene.object("bottle", "bottle", material((0.05, 0.14, 0.07), (0.02, 0.06, 0.03), 0.85, 110.0), placed(BOTTLE))
    scene.object("cork", "cork", material(white, 0.3, 0.05, 8.0), placed(BOTTLE))
    scene.object("label", "label", material(white, 0.34, 0.05, 8.0), placed(BOTTLE, -8.0), texture="label.png")
    scene.object("candle holder", "holder", 'Preset("brass")', placed(CANDLE, 205.0))
    scene.object("candle", "candle", material(white, 0.55, 0.2, 20.0), placed(CANDLE))
    scene.object("flame", "flame", material(white, 1.0, 0.0, 1.0), placed(CANDLE), texture="flame.png", surface="Texture")
    scene.object("cloth", "cloth", material(white, 0.34, 0.04, 8.0), texture="cloth.png", sides="Two")
    scene.object("table", "table", material(white, 0.30, 0.26, 26.0), texture="table.png")
    scene.object("wall", "wall", material(white, 1.0, 0.0, 1.0), texture="wall.png", surface="Texture")
    scene.light("room", "Ambient", (178, 184, 205))
    scene.light("window", sun(add((0, 0, 0), WINDOW, -1)), (255, 240, 214))
    scene.light("candle", bulb(FLAME), (255, 150, 66), (1.0, 0.0, 0.0016))
    scene.light("reading lamp", spot((46, 62, 44), (4, 4, 2), 30.0, 14.0), (92, 78, 66))
    scene.write("A still life: fruit in a bowl, by a window and a candle", (3, 34, 96), (-4.6, 11.0, 0), 17.8, 10.0, 600.0, bowl)


if __name__ == "__main__":
    make()
