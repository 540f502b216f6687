"""The GIF and PNG code of make_animation.py, against a decoder and an encoder of its own."""
import os
import struct
import sys
import tempfile
import unittest
import zlib

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '../../samples/viewer'))
import make_animation


def read_gif(data):
    """(pictures as RGB rows, times)"""
    width, height, flags = struct.unpack('<HHB', data[6:11])
    at = 13 + 3 * (2 << (flags & 7))
    palette = numpy.frombuffer(data[13:at], numpy.uint8).reshape(-1, 3)
    pictures, times = [], []

    def blocks(at):
        out = b''
        while data[at]:
            out += data[at + 1:at + 1 + data[at]]
            at += 1 + data[at]
        return out, at + 1
    while data[at] != 0x3B:
        if data[at] == 0x21:
            kind = data[at + 1]
            content, at = blocks(at + 2)
            if kind == 0xF9:
                times.append(struct.unpack('<H', content[1:3])[0])
            continue
        bits = data[at + 10]
        codes, at = blocks(at + 11)
        pictures.append(palette[values_of(codes, bits)].reshape(height, width, 3))
    return pictures, times


def values_of(codes, bits):
    stream, clear = int.from_bytes(codes, 'little'), 1 << bits
    out, table, width, last = [], [], bits + 1, None
    while True:
        code = stream & ((1 << width) - 1)
        stream >>= width
        if code == clear:
            table, width, last = [[i] for i in range(clear)] + [None, None], bits + 1, None
            continue
        if code == clear + 1:
            return out
        entry = table[code] if code < len(table) else last + last[:1]
        if last is not None and len(table) < 4096:
            table.append(last + entry[:1])
        out += entry
        last = entry
        if len(table) == 1 << width and width < 12:
            width += 1


class Animation(unittest.TestCase):
    def test_pictures_come_back(self):
        random = numpy.random.default_rng(1)
        colors = random.integers(0, 256, (make_animation.COLORS, 3), numpy.uint8)
        noise, few = (colors[random.integers(0, count, (90, 120))] for count in (make_animation.COLORS, 3))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'a.gif')
            make_animation.write_gif(path, [(noise, 12), (few, 130)])
            with open(path, 'rb') as file:
                pictures, times = read_gif(file.read())
        self.assertEqual(times, [12, 130])
        for expected, picture in zip((noise, few), pictures, strict=True):
            # A rare color may share its entry with a near one.
            self.assertLess(float((picture != expected).any(axis=2).mean()), 0.05)

    def test_all_filters_of_png(self):
        random = numpy.random.default_rng(2)
        rows = random.integers(0, 256, (5, 4 * 3), numpy.uint8)
        raw = b''
        for y in range(5):
            above = rows[y - 1] if y else numpy.zeros(12, numpy.uint8)
            left, corner = (numpy.concatenate([numpy.zeros(3, numpy.uint8), line[:-3]]) for line in (rows[y], above))
            a, b, c = (line.astype(int) for line in (left, above, corner))
            near = numpy.where((abs(b - c) <= abs(a - c)) & (abs(b - c) <= abs(a + b - 2 * c)), a,
                               numpy.where(abs(a - c) <= abs(a + b - 2 * c), b, c))
            guess = (numpy.zeros(12, int), a, b, (a + b) // 2, near)[y]
            raw += bytes([y]) + ((rows[y].astype(int) - guess) & 255).astype(numpy.uint8).tobytes()
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'a.png')
            with open(path, 'wb') as file:
                file.write(b'\x89PNG\r\n\x1a\n')
                for kind, content in ((b'IHDR', struct.pack('>IIBBBBB', 4, 5, 8, 2, 0, 0, 0)),
                                      (b'IDAT', zlib.compress(raw))):
                    file.write(struct.pack('>I', len(content)) + kind + content + b'\0\0\0\0')
            numpy.testing.assert_array_equal(make_animation.read_png(path), rows.reshape(5, 4, 3))
