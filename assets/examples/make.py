#!/usr/bin/env python3
"""Answers: how are the three scenes of File > Examples made again?

Run as `python3 assets/examples/make.py`: it writes still-life, chess and harbour beside itself, each a scene file and a
folder of models and textures. It takes about a minute, needs the standard library only, and writes the same bytes on
every run. Chance is seeded, and shadows are painted (see kit.py).
"""

import chess
import harbour
import still_life

if __name__ == "__main__":
    for example in (still_life, chess, harbour):
        example.make()
