#!/usr/bin/python3
"""Makes the animation of README.md: a street of our own city, its set frozen, from outside, PVS on and off.

usage: make_animation.py --bin BIN [-o animation.gif]    BIN: the folder with the built programs

Needs a display with OpenGL 4.5; `xvfb-run -a` gives it one.
"""
import argparse
import json
import os
import struct
import subprocess
import tempfile
import zlib

import numpy

SIZE = '480x300'
COLORS = 128
STEPS = 14  # pictures of the flight
OUTSIDE = (20.0, 68.0, 136.0), (0.0, -37.0)  # eye, look


def read_png(path):
    """Rows of RGB. The viewer writes 8 bits, RGB or RGBA, not interlaced."""
    with open(path, 'rb') as file:
        data = file.read()
    at, parts = 8, {}
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        parts.setdefault(kind, b'')
        parts[kind] += data[at + 8:at + 8 + size]
        at += 12 + size
    width, height, _, kind = struct.unpack('>IIBB', parts[b'IHDR'][:10])
    channels = {2: 3, 6: 4}[kind]
    rows = numpy.frombuffer(zlib.decompress(parts[b'IDAT']), numpy.uint8).reshape(height, 1 + width * channels)
    out = numpy.zeros((height, width * channels), numpy.uint8)
    above = numpy.zeros(width * channels, numpy.uint8)
    for y in range(height):
        row = unfiltered(rows[y, 0], rows[y, 1:], above, channels)
        out[y] = above = row
    return out.reshape(height, width, channels)[:, :, :3]


def unfiltered(kind, row, above, channels):
    if kind == 0:
        return row.copy()
    if kind == 2:
        return row + above
    out = [0] * len(row)
    for i, value in enumerate(row.tolist()):
        left = out[i - channels] if i >= channels else 0
        up, corner = int(above[i]), int(above[i - channels]) if i >= channels else 0
        if kind == 1:
            guess = left
        elif kind == 3:
            guess = (left + up) // 2
        else:
            distances = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
            guess = (left, up, corner)[distances.index(min(distances))]
        out[i] = (value + guess) & 255
    return numpy.array(out, numpy.uint8)


def palette_of(pictures):
    """COLORS colors for all pictures: the box of colors that is widest is divided at its median, again and again."""
    pixels = numpy.concatenate([p[::2, ::2].reshape(-1, 3) for p in pictures]).astype(int)
    colors, counts = numpy.unique(pixels, axis=0, return_counts=True)
    boxes = [numpy.arange(len(colors))]
    while len(boxes) < COLORS:
        spans = [(numpy.ptp(colors[b], axis=0).max() * numpy.sqrt(counts[b].sum()) if len(b) > 1 else 0) for b in boxes]
        widest = int(numpy.argmax(spans))
        if spans[widest] == 0:
            break
        box = boxes.pop(widest)
        axis = int(numpy.ptp(colors[box], axis=0).argmax())
        box = box[numpy.argsort(colors[box][:, axis], kind='stable')]
        middle = int(numpy.searchsorted(numpy.cumsum(counts[box]), counts[box].sum() / 2))
        middle = min(max(middle, 1), len(box) - 1)
        boxes += [box[:middle], box[middle:]]
    return numpy.array([numpy.average(colors[b], axis=0, weights=counts[b]) for b in boxes]).round().astype(int)


def indexed(picture, palette):
    flat = picture.reshape(-1, 3).astype(int)
    colors, inverse = numpy.unique(flat, axis=0, return_inverse=True)
    nearest = ((colors[:, None, :] - palette[None, :, :]) ** 2).sum(axis=2).argmin(axis=1)
    return nearest[inverse.reshape(-1)].astype(numpy.uint8)


def lzw(values, bits):
    """The code stream of GIF."""
    clear, end = 1 << bits, (1 << bits) + 1
    out, held, used = bytearray(), 0, 0
    table, width = {}, bits + 1

    def put(code):
        nonlocal held, used
        held |= code << used
        used += width
        while used >= 8:
            out.append(held & 255)
            held >>= 8
            used -= 8
    put(clear)
    following = end + 1
    prefix = values[0]
    for value in values[1:]:
        if (prefix, value) in table:
            prefix = table[prefix, value]
            continue
        put(prefix)
        if following == 4096:
            put(clear)
            table, width, following = {}, bits + 1, end + 1
        else:
            table[prefix, value] = following
            if following == 1 << width:
                width += 1
            following += 1
        prefix = value
    put(prefix)
    put(end)
    if used:
        out.append(held & 255)
    return bytes(out)


def write_gif(path, frames):
    """frames: (picture, hundredths of a second). Plays again and again."""
    palette = palette_of([picture for picture, _ in frames])
    bits = max(2, (len(palette) - 1).bit_length())
    height, width = frames[0][0].shape[:2]
    colors = palette.astype(numpy.uint8).tobytes().ljust(3 << bits, b'\0')
    out = b'GIF89a' + struct.pack('<HHBBB', width, height, 0xF0 | (bits - 1), 0, 0) + colors
    out += b'\x21\xFF\x0BNETSCAPE2.0\x03\x01\0\0\0'
    for picture, time in frames:
        codes = lzw(indexed(picture, palette).tolist(), bits)
        out += b'\x21\xF9\x04\x04' + struct.pack('<H', time) + b'\0\0'
        out += b'\x2C' + struct.pack('<HHHHB', 0, 0, width, height, 0) + bytes([bits])
        for i in range(0, len(codes), 255):
            out += bytes([len(codes[i:i + 255])]) + codes[i:i + 255]
        out += b'\0'
    with open(path, 'wb') as file:
        file.write(out + b'\x3B')


def draw(viewer, folder, *arguments):
    picture = os.path.join(folder, 'frame.png')
    done = subprocess.run([*viewer, '--screenshot', picture, '--size', SIZE, *arguments], check=True,
                          stdout=subprocess.PIPE, text=True)
    return read_png(picture), json.loads(done.stdout)


def pose(eye, look):
    return ['--eye=' + ','.join(f'{v:.4f}' for v in eye), '--look=' + ','.join(f'{v:.3f}' for v in look)]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument('--bin', required=True)
    arguments.add_argument('-o', '--output', default=os.path.join(os.path.dirname(__file__), 'animation.gif'))
    chosen = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scene, pvs, cells = (os.path.join(folder, name) for name in ('city.glb', 'city.pvs', 'cells.json'))
        made = lambda name: os.path.join(chosen.bin, name)
        subprocess.run([made('sightcell-city'), '--polygons', '100000', '--seed', '1', '--out', scene, '--cells', cells],
                       check=True, stdout=subprocess.DEVNULL)
        subprocess.run([made('sightcell'), 'bake', scene, '-o', pvs, '--cells-file', cells, '--progress', 'none'],
                       check=True, stderr=subprocess.DEVNULL)
        viewer = [made('sightcell-viewer'), scene, pvs]
        street, said = draw(viewer, folder)
        cell, eye, look = said['cell'], numpy.array(said['eye']), numpy.array(said['look'])
        frozen = ['--frozen-from', str(cell), '--show', 'box']
        frames = [(street, 120)]
        for step in range(1, STEPS + 1):
            part = step / STEPS
            part = part * part * (3 - 2 * part)
            at = (eye + part * (numpy.array(OUTSIDE[0]) - eye), look + part * (numpy.array(OUTSIDE[1]) - look))
            frames.append((draw(viewer, folder, *frozen, *pose(*at))[0], 12))
        kept = frames[-1][0]
        everything = draw(viewer, folder, *frozen, '--mode', 'all', *pose(*OUTSIDE))[0]
        frames += [(kept, 110), (everything, 130), (kept, 130), (everything, 130), (kept, 160)]
        write_gif(chosen.output, frames)
    print(f'{chosen.output}: {os.path.getsize(chosen.output)} bytes, {len(frames)} pictures')


if __name__ == '__main__':
    main()
