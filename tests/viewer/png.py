"""Reads the PNG files that the viewer writes: 8 bits per channel, RGB or RGBA, not interlaced."""
import struct
import zlib

import numpy


def read_png(path):
    """The picture as height x width x 3 bytes."""
    with open(path, 'rb') as file:
        data = file.read()
    if data[:8] != b'\x89PNG\r\n\x1a\n':
        raise ValueError(f'{path} is no PNG file')
    at, packed, header = 8, b'', None
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        if kind == b'IHDR':
            header = struct.unpack('>IIBBBBB', data[at + 8:at + 8 + size])
        elif kind == b'IDAT':
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    width, height, depth, color, _, _, interlaced = header
    channels = {2: 3, 6: 4}.get(color)
    if depth != 8 or channels is None or interlaced:
        raise ValueError(f'{path} is a kind of PNG that the viewer does not write')
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + channels * width)
    out = numpy.zeros((height, width, channels), numpy.uint8)
    above = numpy.zeros((width, channels), numpy.uint8)
    for y in range(height):
        above = out[y] = unfilter(int(rows[y, 0]), rows[y, 1:].reshape(width, channels), above)
    return out[:, :, :3]


def unfilter(kind, row, above):
    if kind == 0:
        return row
    if kind == 1:
        return numpy.cumsum(row, axis=0, dtype=numpy.uint8)
    if kind == 2:
        return row + above
    if kind not in (3, 4):
        raise ValueError('unknown filter')
    width, channels = row.shape
    out = []
    row, above = row.tolist(), above.tolist()
    left, corner = [0] * channels, [0] * channels
    for x in range(width):
        pixel = []
        for c in range(channels):
            a, b, d = left[c], above[x][c], corner[c]
            if kind == 3:
                guess = (a + b) // 2
            else:
                pa, pb, pd = abs(b - d), abs(a - d), abs(a + b - 2 * d)
                guess = a if pa <= pb and pa <= pd else b if pb <= pd else d
            pixel.append((row[x][c] + guess) & 255)
        left, corner = pixel, above[x]
        out.append(pixel)
    return numpy.array(out, numpy.uint8)
