"""Closed rooms in a row, so that each view cell needs pages of its own: bumpy floors, painted with three images."""
import base64
import json
import random

import numpy as np

from colonnade_scene import Glb
from painted_images import png

SIZE, HEIGHT = 8, 4  # meters
STEPS = 24  # squares along a side of a floor
IMAGES = 3
PIXELS = 80  # width and height of an image: large enough for a smaller version


def room(number):
    """Corners, coordinates and triangles. The floor is random; the rest of a box is seen from inside."""
    heights = random.Random(number)
    corners, triangles = [], []
    for i in range(STEPS + 1):
        for k in range(STEPS + 1):
            corners.append((SIZE * i / STEPS, heights.uniform(0, 0.5), SIZE * k / STEPS))
    row = STEPS + 1
    for i in range(STEPS):
        for k in range(STEPS):
            a = i * row + k
            triangles += [(a, a + 1, a + row + 1), (a, a + row + 1, a + row)]
    first = len(corners)
    corners += [(x, y, z) for x in (0, SIZE) for y in (-1, HEIGHT) for z in (0, SIZE)]
    for a, b, c, d in ((2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6), (0, 4, 6, 2), (1, 3, 7, 5)):
        triangles += [(first + a, first + b, first + c), (first + a, first + c, first + d)]
    return corners, [(x / SIZE, (y + z) / SIZE) for x, y, z in corners], triangles


def paint(number):
    """Gray, lighter to the right, with noise."""
    ramp = np.linspace(0, 240 - 60 * number, PIXELS)[None, :, None]
    return (ramp + np.random.default_rng(number).integers(0, 16, (PIXELS, PIXELS, 3))).astype(np.uint8)


def write_rooms(path, count):
    glb, meshes = Glb(), []
    for number in range(count):
        corners, coordinates, triangles = room(number)
        meshes.append({'primitives': [{
            'attributes': {'POSITION': glb.add(corners, 'VEC3'), 'TEXCOORD_0': glb.add(coordinates, 'VEC2')},
            'material': number % IMAGES, 'indices': glb.add(triangles, 'SCALAR', 'I')}]})

    def uri(kind, data):
        return f'data:{kind};base64,' + base64.b64encode(data).decode()
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': list(range(count))}], 'meshes': meshes,
        'nodes': [{'mesh': i, 'translation': [i * (SIZE + 1), 0, 0]} for i in range(count)],
        'materials': [{'pbrMetallicRoughness': {'baseColorTexture': {'index': i}}} for i in range(IMAGES)],
        'textures': [{'source': i} for i in range(IMAGES)],
        'images': [{'uri': uri('image/png', png(paint(i)))} for i in range(IMAGES)],
        'buffers': [{'byteLength': len(glb.binary), 'uri': uri('application/octet-stream', glb.binary)}],
        'bufferViews': glb.views, 'accessors': glb.accessors}
    with open(path, 'w', encoding='utf-8') as out:
        json.dump(document, out)


def eye(number, height=2):
    """In the middle of a room."""
    return [number * (SIZE + 1) + SIZE / 2, height, SIZE / 2]


def write_cells(path, count):
    """A cell in the middle of each room."""
    cells = [{'min': [eye(i)[0] - 3, 1.2, 1], 'max': [eye(i)[0] + 3, 3, 7]} for i in range(count)]
    with open(path, 'w', encoding='utf-8') as out:
        json.dump({'cells': cells}, out)
