# SPDX-License-Identifier: GPL-3.0-or-later
"""pixels.py PNG X Y R G B [X Y R G B ...]: exit 0 where each pixel has its colour within 2 of 255 and the picture has more
than 20 different colours. Decodes 8-bit RGB PNG without further modules."""
import struct
import sys
import zlib


def decode(path):
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "not a PNG"
    at, compressed, header = 8, b"", None
    while at < len(data):
        (length,) = struct.unpack(">I", data[at:at + 4])
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        if kind == b"IDAT":
            compressed += body
        at += 12 + length
    width, height, depth, colour_type = header[:4]
    assert (depth, colour_type) == (8, 2), "not 8-bit RGB"
    raw, stride = zlib.decompress(compressed), 3 * width
    rows, above = [], bytearray(stride)
    for y in range(height):
        kind = raw[y * (stride + 1)]
        row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left = row[x - 3] if x >= 3 else 0
            corner = above[x - 3] if x >= 3 else 0
            if kind == 1:
                guess = left
            elif kind == 2:
                guess = above[x]
            elif kind == 3:
                guess = (left + above[x]) // 2
            elif kind == 4:
                p = left + above[x] - corner
                guess = min((left, above[x], corner), key=lambda c: abs(p - c))
            else:
                guess = 0
            row[x] = (row[x] + guess) & 255
        rows.append(row)
        above = row
    return width, height, rows


width, height, rows = decode(sys.argv[1])
colours = {bytes(row[3 * x:3 * x + 3]) for row in rows for x in range(width)}
wrong = 0
wanted = [int(a) for a in sys.argv[2:]]
for k in range(0, len(wanted), 5):
    x, y, *rgb = wanted[k:k + 5]
    found = list(rows[y][3 * x:3 * x + 3])
    if max(abs(a - b) for a, b in zip(found, rgb)) > 2:
        print(f"pixel ({x}, {y}) is {found}, expected {rgb}")
        wrong += 1
if len(colours) <= 20:
    print(f"only {len(colours)} colours in {width} x {height}")
    wrong += 1
sys.exit(1 if wrong else 0)
