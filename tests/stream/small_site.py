"""Writes a streamed scene of two polygons, shown twice, and lets tests change each field of its files. Encoders here write
the longest form of everything: what a decoder must understand, too."""
import json
import os
import struct
import zlib

import numpy as np

from streamed_scene import hash_of

CORNERS = np.array([[0, 0, 0], [2, 0, 0], [2, 1.5, 0], [0, 1.5, 0]], 'f8')  # a wall, seen from +z
TRIANGLES = [0, 1, 2, 0, 2, 3]
NORMAL = (0, 0, 127)
STEP = -4  # corners are multiples of 2^-4 m
MATRICES = np.array([[[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, -3]], [[0, 0, 2, -1], [0, 2, 0, 0], [-2, 0, 0, 4]]], 'f4')
IMAGES = (b'a small image', b'and a larger one')


def varints(*numbers):
    out = bytearray()
    for number in numbers:
        while number > 127:
            out.append(number & 127 | 128)
            number >>= 7
        out.append(number)
    return bytes(out)


def zigzag(number):
    return 2 * number if number >= 0 else -2 * number - 1


def deltas(*numbers):
    return varints(*(zigzag(b - a) for a, b in zip((0, *numbers), numbers)))


def gaps(*numbers):
    return varints(*(b - a - 1 for a, b in zip((-1, *numbers), numbers)))


def floats(*columns):
    """Each column: its four planes."""
    return b''.join(np.array(column, '<f4').view(np.uint8).reshape(-1, 4).T.tobytes() for column in columns)


def box_columns(*boxes):
    return floats(*np.array(boxes, 'f4').reshape(len(boxes), 6).T)


def encoded_attributes(elements):
    """elements: bytes [n, stride]; all deltas are stored as bytes."""
    count, stride = elements.shape
    out, before = b'\xa0', elements[0]
    for first in range(0, count, min(8192 // stride & ~15, 256)):
        block = elements[first:first + min(8192 // stride & ~15, 256)]
        steps = np.diff(block, axis=0, prepend=before[None])
        zigzags = np.where(steps & 128, ~(steps << 1), steps << 1)
        groups = -(-len(block) // 16)
        padded = np.zeros((groups * 16, stride), np.uint8)
        padded[:len(block)] = zigzags
        header = sum(3 << 2 * group for group in range(groups)).to_bytes(-(-groups // 4), 'little')
        out += b''.join(header + padded[:, i].tobytes() for i in range(stride))
        before = block[-1]
    return out + bytes(max(0, 32 - stride)) + elements[0].tobytes()


def encoded_triangles(indices):
    """All corners of all triangles are stored as numbers."""
    extra, last = b'', 0
    for first in range(0, len(indices), 3):
        extra += b'\xff'
        for index in indices[first:first + 3]:
            extra += varints(zigzag((index - last + (1 << 31)) % (1 << 32) - (1 << 31)))
            last = index
    return b'\xe1' + b'\xff' * (len(indices) // 3) + extra + bytes(16)


def exponential_words(values, exponent):
    mantissas = np.rint(np.asarray(values) / 2.0 ** exponent).astype('i8')
    return (mantissas & 0xFFFFFF | (exponent & 255) << 24).astype('<u4')


def octahedral_bytes(vectors, count):
    """A row of four bytes for each of count vectors on the hemisphere of +z; all are the same."""
    x, y, z = np.array(vectors) / np.abs(vectors).sum()
    assert z >= 0
    return np.tile(np.array([round(x * 127), round(y * 127), 127, 0], 'i1').view(np.uint8), (count, 1))


def glb(document, binary):
    text = json.dumps(document).encode()
    text += b' ' * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    return (struct.pack('<4sIIII', b'glTF', 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A) + text +
            struct.pack('<II', len(binary), 0x004E4942) + binary)


class SmallSite:
    """Fields are bytes by name, in the order of the text. Tests change them before `write`."""

    def __init__(self):
        self.views = [  # elements as bytes, mode, filter
            (exponential_words(CORNERS, STEP).view(np.uint8).reshape(4, 12), 'ATTRIBUTES', 'EXPONENTIAL'),
            (octahedral_bytes(NORMAL, 4), 'ATTRIBUTES', 'OCTAHEDRAL'),
            (exponential_words(CORNERS[:, :2], -8).view(np.uint8).reshape(4, 8), 'ATTRIBUTES', 'EXPONENTIAL'),
            (np.full((4, 4), 255, np.uint8), 'ATTRIBUTES', 'NONE'),
            (np.array(TRIANGLES, '<u2').view(np.uint8).reshape(6, 2), 'TRIANGLES', 'NONE')]
        vertices = {'count': 4, 'type': 'VEC3'}
        self.accessors = [
            {**vertices, 'bufferView': 0, 'componentType': 5126, 'min': [0, 0, 0], 'max': [2, 1.5, 0]},
            {**vertices, 'bufferView': 1, 'componentType': 5120, 'normalized': True},
            {**vertices, 'bufferView': 2, 'componentType': 5126, 'type': 'VEC2'},
            {**vertices, 'bufferView': 3, 'componentType': 5121, 'type': 'VEC4', 'normalized': True},
            {'bufferView': 4, 'componentType': 5123, 'count': 6, 'type': 'SCALAR'}]
        self.primitive = {'attributes': {'POSITION': 0, 'NORMAL': 1, 'TEXCOORD_0': 2, 'COLOR_0': 3}, 'indices': 4,
                          'extras': {'sightcell': [0, 2]}}
        extensions = ['EXT_meshopt_compression', 'KHR_mesh_quantization']
        self.document = {'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0]}], 'nodes': [{'mesh': 0}],
                         'extensionsUsed': extensions, 'extensionsRequired': extensions}
        self.materials = {'asset': {'version': '2.0'}, 'materials': [{'name': 'wall'}], 'images': [{'name': 'bricks'}]}
        # The second cell is in the first one, and the third one is as large as the second one, shifted by half of it.
        self.cells = np.array([[[0, 0, 0], [8, 2, 8]], [[2, 0, 2], [4, 2, 4]], [[3, 0, 2], [5, 2, 4]]], 'f4')
        self.chunk = {
            'count': varints(3), 'numbers': deltas(0, 2, 1), 'boxes': box_columns(*self.cells),
            'weights': floats([1, 2, 0.5]),
            'page counts': varints(1, 1, 0), 'pages': gaps(0) + gaps(0), 'page weights': bytes([0, 8]),
            'page headings': bytes([255, 3]),
            'run counts': varints(1, 1, 0), 'runs': varints(0, 1) + varints(1, 0),
            'image counts': varints(1, 0, 0), 'images': gaps(0), 'image weights': bytes([255])}
        self.front = {
            'fingerprint': bytes(range(16)), 'counts': varints(4, 1, 2, 1, 1, 2, 1, 3), 'bytes of JSON': b'',
            'box': floats([0, 0, -3, 8, 3, 8]), 'JSON': b'',
            'polygons': varints(2), 'geometries': deltas(0, 0), 'materials': varints(1, 0), 'flags': varints(0, 0), 'objects': varints(0, 1),
            'levels': varints(0, 0), 'nodes': deltas(3, 4), 'meshes': deltas(1, 1), 'instances': deltas(0, 0),
            'primitives': varints(2, 2), 'matrices': floats(*MATRICES.transpose(2, 1, 0).reshape(12, 2)),
            'page bytes': b'', 'page hashes': b'', 'page boxes': bytes([0, 0, 0, 255, 255, 255]),
            'file counts': varints(2), 'widths': varints(4, 8), 'heights': varints(0, 8),
            'file bytes': varints(*map(len, IMAGES)), 'file types': bytes([2, 0]),
            'file hashes': bytes.fromhex(''.join(map(hash_of, IMAGES))),
            'chunk bytes': b'', 'chunk cells': varints(3), 'chunk hashes': b'', 'chunk boxes': box_columns(self.cells[0]),
            'everywhere': varints(0), 'images everywhere': varints(0)}

    def page_bytes(self):
        views, binary, uncompressed = [], b'', 0
        for elements, mode, filter_name in self.views:
            if mode == 'ATTRIBUTES':
                data = encoded_attributes(elements)
            else:
                data = encoded_triangles(elements.view('<u2')[:, 0].tolist())
            views.append({
                'buffer': 1, 'byteOffset': uncompressed, 'byteLength': elements.size,
                'extensions': {'EXT_meshopt_compression': {
                    'buffer': 0, 'byteOffset': len(binary), 'byteLength': len(data), 'byteStride': elements.shape[1],
                    'count': len(elements), 'mode': mode, 'filter': filter_name}}})
            if mode == 'ATTRIBUTES':
                views[-1]['byteStride'] = elements.shape[1]
            binary += data + bytes(-len(data) % 4)
            uncompressed += elements.size
        buffers = [{'byteLength': len(binary)},
                   {'byteLength': uncompressed, 'extensions': {'EXT_meshopt_compression': {'fallback': True}}}]
        return glb({'meshes': [{'primitives': [self.primitive]}], **self.document, 'accessors': self.accessors,
                    'bufferViews': views, 'buffers': buffers}, binary)

    def chunk_payload(self):
        return b''.join(self.chunk.values())

    def front_payload(self, page, chunk):
        text = json.dumps(self.materials).encode()
        made = {'JSON': text, 'bytes of JSON': varints(len(text)), 'page bytes': varints(len(page)),
                'page hashes': bytes.fromhex(hash_of(page)), 'chunk bytes': varints(len(chunk)),
                'chunk hashes': bytes.fromhex(hash_of(chunk))}
        return b''.join(value or made.get(name, b'') for name, value in self.front.items())

    def contents(self):
        """The bytes of front, chunk and page."""
        page, chunk = self.page_bytes(), packed_chunk(self.chunk_payload())
        return packed_front(self.front_payload(page, chunk)), chunk, page

    def write(self, folder):
        """The paths of front, chunk and page."""
        front, chunk, page = self.contents()
        names = [('scene.front', front), (f'cells/{hash_of(chunk)}.cells', chunk), (f'pages/{hash_of(page)}.glb', page),
                 (f'images/{hash_of(IMAGES[0])}.webp', IMAGES[0]), (f'images/{hash_of(IMAGES[1])}.png', IMAGES[1])]
        for name, data in names:
            path = os.path.join(folder, *name.split('/'))
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, 'wb') as file:
                file.write(data)
        return [os.path.join(folder, *name.split('/')) for name, _ in names[:3]]


def packed_front(payload):
    return struct.pack('<8sII', b'SIGHTFRT', 1, len(payload)) + zlib.compress(payload)


def packed_chunk(payload):
    return struct.pack('<I', len(payload)) + zlib.compress(payload)
