#!/usr/bin/env python3
"""Makes mountain.ttf beside it: a font of one letter, 山, for tests of fonts that the system has.

It needs fontTools: pip install fonttools
"""
import pathlib

from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen

# Left, bottom, right and top of the strokes, in thousandths of the letter's size.
STROKES = [(100, 0, 180, 450), (460, 0, 540, 800), (820, 0, 900, 450), (100, 0, 900, 80)]


def glyph(strokes):
    pen = TTGlyphPen(None)
    for left, bottom, right, top in strokes:
        pen.moveTo((left, bottom))
        for corner in ((left, top), (right, top), (right, bottom)):
            pen.lineTo(corner)
        pen.closePath()
    return pen.glyph()


builder = FontBuilder(1000, isTTF=True)
builder.setupGlyphOrder([".notdef", "mountain"])
builder.setupCharacterMap({ord("山"): "mountain"})
builder.setupGlyf({".notdef": glyph([]), "mountain": glyph(STROKES)})
builder.setupHorizontalMetrics({".notdef": (1000, 0), "mountain": (1000, 100)})
builder.setupHorizontalHeader(ascent=850, descent=-150)
builder.setupNameTable({"familyName": "Mountain Sans", "styleName": "Regular", "psName": "MountainSans"})
builder.setupOS2(sTypoAscender=850, sTypoDescender=-150)
builder.setupPost()
builder.save(pathlib.Path(__file__).with_name("mountain.ttf"))
