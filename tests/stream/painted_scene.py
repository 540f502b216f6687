"""A painted room with a box in it that the host moves: normals, two sets of texture coordinates, colors and an image."""
import base64
import json
import struct
import zlib

import numpy as np

from colonnade_scene import Glb

FACES = [(0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6), (0, 4, 6, 2), (1, 3, 7, 5)]  # of a box, from inside
PIXELS = 16  # width and height of the image


def png(step=16):
    """Gray, lighter to the right."""
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    rows = b''.join(b'\0' + bytes(x * step for x in range(PIXELS)) for _ in range(PIXELS))
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', PIXELS, PIXELS, 8, 0, 0, 0, 0)) +
            chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))


def box(low, high, outside):
    """Attributes of a box with corners of its own for each face, and its triangles."""
    corners = np.array([(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])], 'f8')
    order = [face[::-1] if outside else face for face in FACES]
    positions = corners[np.array(order)].reshape(24, 3)
    sides = positions.reshape(6, 4, 3)
    normals = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]).repeat(4, axis=0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    tilted = normals + 0.2 * np.linspace(-1, 1, 72).reshape(24, 3)  # no multiples of anything
    normals = tilted / np.linalg.norm(tilted, axis=1, keepdims=True)
    fractions = np.linspace(0, 1, 24)
    attributes = {
        'POSITION': positions, 'NORMAL': normals, 'TEXCOORD_0': np.stack([3.1 * fractions, 1 - fractions ** 2], axis=1),
        'TEXCOORD_1': np.stack([fractions / 7, fractions / 3], axis=1),
        'COLOR_0': np.stack([fractions, 1 - fractions, fractions ** 2, np.ones(24)], axis=1)}
    triangles = [(4 * i + a, 4 * i + b, 4 * i + c) for i in range(6) for a, b, c in ((0, 1, 2), (0, 2, 3))]
    return attributes, triangles


def write_painted(path):
    glb = Glb()
    meshes = []
    for low, high, outside in (((0, 0, 0), (8, 4, 8), False), ((1, 0, 1), (2, 1.3, 2), True)):
        attributes, triangles = box(low, high, outside)
        numbers = {name: glb.add(rows.tolist(), f'VEC{rows.shape[1]}') for name, rows in attributes.items()}
        meshes.append({'primitives': [{'attributes': numbers, 'material': 0, 'indices': glb.add(triangles, 'SCALAR', 'I')}]})
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0, 1]}], 'meshes': meshes,
        'nodes': [{'mesh': 0}, {'mesh': 1, 'extras': {'sightcell': {'dynamic': True}}}],
        'materials': [{'pbrMetallicRoughness': {'baseColorTexture': {'index': 0}}}],
        'textures': [{'source': 0, 'sampler': 0}], 'samplers': [{'wrapS': 10497}],
        'images': [{'uri': 'data:image/png;base64,' + base64.b64encode(png()).decode()}],
        'buffers': [{'byteLength': len(glb.binary), 'uri': 'data:application/octet-stream;base64,' +
                     base64.b64encode(glb.binary).decode()}],
        'bufferViews': glb.views, 'accessors': glb.accessors}
    with open(path, 'w', encoding='utf-8') as out:
        json.dump(document, out)
