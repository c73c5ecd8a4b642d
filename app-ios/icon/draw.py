#!/usr/bin/env python3
"""Draws the icon of the iPhone app: a block that leaps, and its shadow on the ground, as app-android/res has it.

Writes AppIcon60x60@2x.png and @3x.png beside this file, and the one size that Xcode makes all others of.
"""

import struct
import zlib
from pathlib import Path

HERE = Path(__file__).parent
TABLE = (0xEF, 0xE6, 0xD8)
# In a square of 72 units, as Android shows of its 108; each a polygon and its colour.
SHAPES = [
    ([(28, 60), (56, 60), (64, 52), (40, 52)], (0x7A, 0x6A, 0x55)),
    ([(16, 16), (42, 12), (46, 38), (20, 42)], (0xB5, 0x56, 0x3A)),
    ([(42, 12), (52, 18), (56, 42), (46, 38)], (0x8C, 0x3F, 0x29)),
]
SAMPLES = 4


def crossings(polygon, y):
    """Where a row crosses the polygon's edges, in order."""
    found = []
    for (x0, y0), (x1, y1) in zip(polygon, polygon[1:] + polygon[:1]):
        if (y0 <= y) != (y1 <= y):
            found.append(x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return sorted(found)


def png(side):
    """An opaque picture, smoothed by SAMPLES x SAMPLES samples a pixel."""
    rows = bytearray()
    fine = side * SAMPLES
    for top in range(0, fine, SAMPLES):
        sums = [[SAMPLES * SAMPLES * channel for channel in TABLE] for _ in range(side)]
        for sub in range(SAMPLES):
            y = (top + sub + 0.5) * 72 / fine
            painted = [TABLE] * fine
            for polygon, colour in SHAPES:
                at = crossings(polygon, y)
                for left, right in zip(at[::2], at[1::2]):
                    first, last = (round(x * fine / 72) for x in (left, right))
                    painted[first:last] = [colour] * (last - first)
            for index, colour in enumerate(painted):
                if colour is not TABLE:
                    pixel = sums[index // SAMPLES]
                    for channel in range(3):
                        pixel[channel] += colour[channel] - TABLE[channel]
        rows.append(0)
        for pixel in sums:
            rows.extend(round(total / SAMPLES**2) for total in pixel)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b"")
    )


(HERE / "AppIcon60x60@2x.png").write_bytes(png(120))
(HERE / "AppIcon60x60@3x.png").write_bytes(png(180))
(HERE.parent / "Assets.xcassets/AppIcon.appiconset/icon.png").write_bytes(png(1024))
