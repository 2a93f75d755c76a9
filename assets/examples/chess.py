"""Answers: where do the pieces stand, and what are they turned from?

The position after Black's 17th move in Anderssen against Kieseritzky, London 1851, which is known as the Immortal Game.
A square is 5 centimetres; the board's top is y = 0, and the corner square a1 has its centre at (-17.5, 17.5).
"""

from kit import *

FOLDER = "chess"
# The rows of the board from rank 8 down, white in upper case.
POSITION = ["rnb.k.nr", "p..p.ppp", "........", ".pbN.N.P", "....PBP.", "...P.Q..", "PqP.....", "R....KR."]
LAMP = (-24.0, 46.0, 14.0)

PAWN = [(0, 0), (1.45, 0), (1.5, 0.35), (1.2, 0.6), (1.25, 0.95), (0.95, 1.2), (0.72, 1.9), (0.58, 2.8), (0.6, 3.2)]
PAWN += [(0.98, 3.4), (0.98, 3.58), (0.5, 3.75)] + [(0.86 * sin(a), 4.45 - 0.86 * cos(a)) for a in [pi * k / 9 for k in range(2, 9)]] + [(0, 5.31)]
BASE = [(0, 0), (1.8, 0), (1.88, 0.4), (1.5, 0.75), (1.58, 1.15), (1.22, 1.5)]
ROOK = BASE + [(1.02, 2.4), (0.95, 3.9), (1.0, 4.2), (1.35, 4.5), (1.35, 4.75), (1.25, 4.8), (1.25, 5.3), (0.9, 5.3), (0.88, 4.9), (0, 4.9)]
BISHOP = BASE + [(0.85, 2.5), (0.66, 4.2), (0.68, 4.7), (1.15, 4.95), (1.15, 5.15), (0.6, 5.35), (0.95, 6.0), (1.0, 6.5), (0.8, 7.2), (0.42, 7.8)]
BISHOP += [(0.2, 7.95), (0.3, 8.15), (0.3, 8.35), (0.18, 8.5), (0, 8.55)]
QUEEN = BASE + [(0.95, 2.6), (0.7, 5.2), (0.72, 5.9), (1.25, 6.2), (1.25, 6.42), (0.78, 6.6), (0.85, 7.2), (1.3, 8.5), (1.22, 8.6), (0.8, 8.25), (0.45, 8.6), (0.5, 9.0), (0.3, 9.3), (0, 9.36)]
KING = BASE + [(1.0, 2.6), (0.75, 5.6), (0.78, 6.3), (1.32, 6.6), (1.32, 6.85), (0.82, 7.05), (0.9, 7.6), (1.25, 8.8), (1.1, 9.1), (0.5, 9.3), (0, 9.35)]
KNIGHT_FOOT = BASE + [(1.28, 1.75), (1.2, 1.95), (0, 1.95)]
# The outline of a knight's head: chest, muzzle, ears, mane.
KNIGHT = [(1.15, 1.9), (1.2, 2.5), (0.95, 3.3), (0.75, 4.1), (0.95, 4.25), (1.5, 3.75), (2.0, 3.65), (2.3, 3.95), (2.25, 4.4), (1.75, 5.1)]
KNIGHT += [(1.35, 5.75), (0.95, 6.25), (0.72, 6.95), (0.42, 6.45), (0.0, 6.5), (-0.65, 6.1), (-1.15, 5.3), (-1.4, 4.3), (-1.42, 3.2), (-1.2, 1.9)]
PROFILES = {"pawn": PAWN, "rook": ROOK, "bishop": BISHOP, "queen": QUEEN, "king": KING}
NAMES = {"p": "pawn", "r": "rook", "n": "knight", "b": "bishop", "q": "queen", "k": "king"}


def pieces():
    """(white, kind, file and rank, place) of each piece."""
    for row, line in enumerate(POSITION):
        for column, letter in enumerate(line):
            if letter != ".":
                at = (-17.5 + 5 * column, 0.0, -17.5 + 5 * row)
                yield letter.isupper(), NAMES[letter.lower()], "abcdefgh"[column] + str(8 - row), at


def occluders():
    shade = Shade()
    for _, kind, _, at in pieces():
        profile = PROFILES.get(kind, BASE + [(1.3, 2.4), (1.2, 4.0), (1.3, 5.5), (0.6, 6.6)])
        high = profile[-1][1]
        shade.column(at, [(r, y) for r, y in profile if r > 0], max(4, round(high / 1.1)))
    return shade


def turned(name, profile, extra=None, bulge=None):
    model = Model(name, 3)
    dark = lambda i, n, p: (mix(0.55, 1.0, smooth(0, 2.4, p[1])),) * 3
    model.lathe(profile, 28, color=dark, bulge=bulge)
    if extra:
        extra(model)
    model.write(FOLDER)


def battlements(model):
    for k in range(6):
        low, high = 2 * pi * (k + 0.15) / 6, 2 * pi * (k + 0.85) / 6
        ring = []
        for r, y in ((1.27, 5.0), (1.29, 5.9), (0.86, 5.9), (0.84, 5.0)):
            ring.append([model.point((r * sin(a), y, r * cos(a)), (1, 1, 1)) for a in [mix(low, high, t / 3) for t in range(4)]])
        for a, b in zip(ring, ring[1:]):
            for t in range(3):
                model.face([a[t], a[t + 1], b[t + 1], b[t]])
        model.face([ring[0][0], ring[1][0], ring[2][0], ring[3][0]])
        model.face([ring[3][3], ring[2][3], ring[1][3], ring[0][3]])


def cross_on_top(model):
    white = lambda p: (1, 1, 1)
    model.box((-0.18, 9.2, -0.16), (0.18, 10.6, 0.16), 0.06, color=white)
    model.box((-0.5, 9.75, -0.15), (0.5, 10.1, 0.15), 0.06, color=white)


def models():
    turned("pawn", PAWN)
    turned("rook", ROOK, battlements)
    turned("bishop", BISHOP)
    turned("queen", QUEEN, bulge=lambda a, i: 1 + (0.10 * cos(9 * a) if i in (13, 14) else 0))
    turned("king", KING, cross_on_top)
    knight = Model("knight", 3)
    knight.lathe(KNIGHT_FOOT, 28, color=lambda i, n, p: (mix(0.55, 1.0, smooth(0, 2.4, p[1])),) * 3)
    first = len(knight.points)
    outline = []
    for i, (x, y) in enumerate(KNIGHT):
        # The outline's corners are rounded by cutting each twice.
        ax, ay = KNIGHT[i - 1]
        bx, by = KNIGHT[(i + 1) % len(KNIGHT)]
        outline += [(mix(x, ax, 0.25), mix(y, ay, 0.25)), (mix(x, bx, 0.25), mix(y, by, 0.25))]
    knight.plate(outline, 1.7, 0.3, at=lambda p: (-p[2] * (1.0 - 0.06 * max(p[1] - 3, 0)), p[1], p[0]))
    for i in range(first, len(knight.points)):
        knight.colors[i] = (1.0, 1.0, 1.0)
    for side in (-1, 1):
        knight.ball((side * 0.62, 5.45, 0.95), 0.22, 10, 6, color=lambda i, n, p: (0.3, 0.3, 0.3))
    knight.write(FOLDER)
    board_model()
    table_model()


def board_model():
    board = Model("board", 3)
    half = 23.5
    board.box((-half, -2.2, -half), (half, 0, half), 0.45, uv=lambda p, n: ((p[0] + half) / (2 * half), (half - p[2]) / (2 * half)))
    board.write(FOLDER)
    shade, count = occluders(), 704
    at = lambda i, j: (-half + 2 * half * (i + 0.5) / count, 0.0, -half + 2 * half * (j + 0.5) / count)

    def light(i, j):
        p = at(i, j)
        return (1 - 0.75 * shade.hidden(p, unit(sub(LAMP, p)), 0.045)) * (0.4 + 0.6 * shade.ambient(p, (0, 1, 0)))

    lit = coarse(count, count, 4, light)

    def texel(i, j):
        x, _, z = at(i, j)
        a, b = (x + 20) / 5, (z + 20) / 5
        light = lit(i, j)
        if not (0 <= a < 8 and 0 <= b < 8):
            rim = max(abs(x), abs(z))
            grain = wood(z if abs(x) > abs(z) else x, 60 + 0.22 * rim, 1.2)
            if 20.25 < rim < 20.6 or 22.6 < rim < 22.75:
                return 5 * 2 + 1, light * 0.95
            mitre = 0.6 + 0.4 * smooth(0, 0.15, abs(abs(x) - abs(z)))
            return 10 if grain < 0.3 else 5 + min(int(grain * 3.4), 4), light * 0.62 * mitre
        column, row = int(a), int(b)
        seam = min(a % 1, 1 - a % 1, b % 1, 1 - b % 1) * 5
        white = (column + row) % 2 == 0
        along, across = (x, z) if (column * 3 + row) % 2 else (z, x)
        grain = clamp(wood(along + 31 * column, across * 0.20 + 7 * row + 3 * column, 1.0))
        return (0 if white else 5) + min(int(grain * 5), 4), light * (0.72 + 0.28 * smooth(0, 0.10, seam))

    tones = ramp([(0, (196, 150, 96)), (1, (236, 204, 150))], 5) + ramp([(0, (74, 38, 22)), (1, (122, 68, 38))], 5) + [(46, 24, 16), (214, 176, 96)]
    shaded_picture(f"{FOLDER}/board.png", count, count, tones, texel, (0.13, 0.10, 0.11), steps=21)


def table_model():
    table = Model("table", 1)
    table.grid(lambda u, v: (-130 + 260 * u, -2.2, 130 - 260 * v), 1, 1, uv=True)
    table.write(FOLDER)
    count = 384

    def texel(i, j):
        x, z = -130 + 260 * (i + 0.5) / count, -130 + 260 * (j + 0.5) / count
        away = max(abs(x) - 23.5, abs(z) - 23.5, 0)
        pool = smooth(120, 8, sqrt((x + 4) ** 2 + (z - 2) ** 2))
        contact = smooth(-1.5, 5.0, away)
        # The board's own shadow, away from the lamp.
        shifted = max(abs(x - 1.6) - 23.5, abs(z + 1.0) - 23.5, 0)
        shadow = 0.45 + 0.55 * smooth(0, 3.5, shifted)
        leather = fractal(x * 0.35, z * 0.35, 4)
        return int(clamp(0.5 + (leather - 0.5) * 1.6) * 7.99), (0.08 + 0.92 * pool) * (0.25 + 0.75 * contact) * shadow

    tones = ramp([(0, (44, 92, 80)), (1, (64, 122, 106))], 8)
    shaded_picture(f"{FOLDER}/table.png", count, count, tones, texel, (0.06, 0.07, 0.10), steps=30)


def scene():
    scene = Scene(FOLDER, (7, 9, 14))
    boxwood = material((0.88, 0.69, 0.42), 0.34, (0.42, 0.38, 0.30), 46.0)
    ebony = material((0.30, 0.10, 0.06), 0.45, (0.85, 0.72, 0.62), 60.0)
    king = None
    for white, kind, square, at in pieces():
        turn = (180.0 if white else 0.0) + (14 if kind == "knight" and white else -18 if kind == "knight" else 0)
        turn += {"king": 8.0, "bishop": 30.0}.get(kind, 0.0)
        color = "white" if white else "black"
        id = scene.object(f"{color} {kind} {square}", kind, boxwood if white else ebony, placed(at, turn), crease=34.0 if kind in ("rook", "knight") else None)
        king = id if white and kind == "king" else king
    scene.object("board", "board", material((1.0, 1.0, 1.0), 0.32, 0.24, 36.0), texture="board.png")
    scene.object("table", "table", material((1.0, 1.0, 1.0), 0.34, 0.03, 6.0), texture="table.png")
    scene.light("room", "Ambient", (206, 210, 226))
    scene.light("lamp", spot(LAMP, (2, 0, 0), 50.0, 2.0), (244, 222, 186))
    scene.light("moon", sun((0.75, -0.45, 0.65)), (84, 104, 158))
    scene.light("fire", bulb((54, 16, 20)), (236, 124, 58), (1.0, 0.0, 0.0001))
    scene.write("A game of chess under a lamp: Anderssen against Kieseritzky, 1851", (-17.0, 22.5, 45.0), (0.4, 0.9, 0.0), 20.5, 4.0, 600.0, king)


def make():
    models()
    scene()


if __name__ == "__main__":
    make()
