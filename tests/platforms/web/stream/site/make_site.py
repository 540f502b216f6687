#!/usr/bin/env python3
"""Makes the scene and the site of the tests of sightcell-stream anew: three closed rooms, each with a cell of its own,
so that each cell needs pages that the others do not. There are an image with a smaller version, leaves with an alpha
test, transparent panes, pillars that are instances and one that is mirrored, one object that the host moves, and colors
of corners with the default material.

usage: make_site.py BIN    BIN: sightcell
Writes rooms.glb, rooms.site, and rooms.json with what the reader of tests/stream finds in it, beside this file. Needed
only where the format of sites changes.
"""
import glob
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
TESTS = os.path.join(HERE, '..', '..', '..', '..')
sys.path += [os.path.join(TESTS, folder) for folder in ('engine_hook', 'stream', 'stream_client')]
from colonnade_scene import Glb, pillar  # noqa: E402
from painted_images import png  # noqa: E402
import rooms_scene  # noqa: E402
import streamed_scene  # noqa: E402

rooms_scene.STEPS = 9  # squares along a side of a floor: few, so that the files are small
PITCH = rooms_scene.SIZE + 1  # meters from room to room
SIDES = ((0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6), (0, 4, 6, 2), (1, 3, 7, 5))
PIXELS = 72


def box(length):
    corners = [(x, y, z) for x in (0, length) for y in (0, length) for z in (0, length)]
    quads = [side[::-1] for side in SIDES]
    return corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def sheet():
    return [(0, 0.6, 0), (2, 0.6, 0), (2, 2.6, 0), (0, 2.6, 0)], [(0, 1, 2), (0, 2, 3)]


def bricks():
    y, x = np.mgrid[0:PIXELS, 0:PIXELS]
    mortar = (y % 12 < 2) | ((x + y // 12 * 12) % 24 < 2)
    noise = np.random.default_rng(1).integers(0, 2, (PIXELS, PIXELS, 1))
    return (np.where(mortar[:, :, None], [180, 180, 170], [150, 70, 50]) + noise).astype(np.uint8)


def leaves():
    y, x = np.mgrid[0:32, 0:32]
    opaque = (x % 16 - 8) ** 2 + (y % 16 - 8) ** 2 < 40
    return np.where(opaque[:, :, None], [40, 150, 50, 255], [0, 0, 0, 0]).astype(np.uint8)


def primitive(glb, corners, triangles, material=None, colors=None):
    attributes = {'POSITION': glb.add(corners, 'VEC3')}
    if material in (0, 1):
        attributes['TEXCOORD_0'] = glb.add([(x / 2, (y + z) / 2) for x, y, z in corners], 'VEC2')
    if colors is not None:
        attributes['COLOR_0'] = glb.add(colors, 'VEC4')
    out = {'attributes': attributes, 'indices': glb.add(triangles, 'SCALAR', 'I')}
    return out if material is None else {**out, 'material': material}


def scene():
    glb = Glb()
    rooms = [rooms_scene.room(number)[::2] for number in range(3)]
    shades = [(0.5 + 0.06 * (x % 8), 0.9 - 0.05 * z, 0.7, 1) for x, _, z in rooms[1][0]]
    meshes = [[primitive(glb, *rooms[0], 0)], [primitive(glb, *rooms[1], colors=shades)],
              [primitive(glb, *rooms[2], 0)], [primitive(glb, *pillar(), 2)],
              [primitive(glb, *sheet(), 1)], [primitive(glb, *sheet(), 3)],
              [primitive(glb, *box(0.7), 4)]]
    instances = {'TRANSLATION': glb.add([(20, 0, 2), (22, 0.2, 5), (24, 0, 3)], 'VEC3'),
                 'ROTATION': glb.add([(0, 0, 0, 1), (0, 0.6, 0, 0.8), (0, 1, 0, 0)], 'VEC4'),
                 'SCALE': glb.add([(1, 1, 1), (0.8, 0.8, 0.8), (1, 1.1, 1)], 'VEC3')}
    nodes = [{'mesh': i, 'translation': [i * PITCH, 0, 0]} for i in range(3)] + [
        {'mesh': 3, 'translation': [2, 0, 5]}, {'mesh': 3, 'translation': [5.5, 0, 6], 'scale': [0.7, 0.9, 0.7]},
        {'mesh': 3, 'translation': [14, 0, 4], 'scale': [-1, 1, 1]},
        {'mesh': 3, 'extensions': {'EXT_mesh_gpu_instancing': {'attributes': instances}}},
        {'mesh': 4, 'translation': [3, 0, 2]}, {'mesh': 5, 'translation': [11, 0, 6]},
        {'mesh': 5, 'translation': [12, 0, 7]},
        {'mesh': 6, 'translation': [6, 0.5, 3], 'name': 'crate', 'extras': {'sightcell': {'dynamic': True}}}]

    def view(data):
        glb.binary += bytes(-len(glb.binary) % 4)
        glb.views.append({'buffer': 0, 'byteOffset': len(glb.binary), 'byteLength': len(data)})
        glb.binary += data
        return {'bufferView': len(glb.views) - 1, 'mimeType': 'image/png'}
    images = [view(png(bricks())), view(png(leaves()))]
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': list(range(len(nodes)))}],
        'extensionsUsed': ['EXT_mesh_gpu_instancing'], 'nodes': nodes,
        'meshes': [{'primitives': primitives} for primitives in meshes],
        'materials': [
            {'name': 'bricks', 'pbrMetallicRoughness': {'baseColorTexture': {'index': 0}, 'metallicFactor': 0}},
            {'name': 'leaves', 'pbrMetallicRoughness': {'baseColorTexture': {'index': 1}, 'metallicFactor': 0},
             'alphaMode': 'MASK', 'doubleSided': True},
            {'name': 'stone', 'pbrMetallicRoughness': {'baseColorFactor': [0.6, 0.6, 0.5, 1], 'metallicFactor': 0}},
            {'name': 'glass', 'pbrMetallicRoughness': {'baseColorFactor': [0.3, 0.6, 0.9, 0.4], 'metallicFactor': 0},
             'alphaMode': 'BLEND', 'doubleSided': True},
            {'name': 'wood', 'pbrMetallicRoughness': {'baseColorFactor': [0.5, 0.3, 0.1, 1], 'metallicFactor': 0}}],
        'textures': [{'source': 0, 'sampler': 0}, {'source': 1, 'sampler': 1}],
        'samplers': [{'wrapS': 10497, 'wrapT': 10497, 'minFilter': 9987},
                     {'wrapS': 33071, 'wrapT': 10497, 'minFilter': 9729}],
        'images': images, 'bufferViews': glb.views, 'accessors': glb.accessors}
    return document, glb.binary


def write_glb(path, document, binary):
    binary += bytes(-len(binary) % 4)
    text = json.dumps({**document, 'buffers': [{'byteLength': len(binary)}]}, separators=(',', ':')).encode()
    text += b' ' * (-len(text) % 4)
    with open(path, 'wb') as out:
        out.write(struct.pack('<4sIIII', b'glTF', 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A) + text)
        out.write(struct.pack('<II', len(binary), 0x004E4942) + binary)


def answers(site):
    def read(pattern, parse, *more):
        with open(glob.glob(os.path.join(site, pattern))[0], 'rb') as file:
            return parse(file.read(), *more)
    front = read('scene.front', streamed_scene.front)
    names = ('geometry', 'material', 'flags', 'object', 'level', 'node', 'mesh', 'instance', 'primitive')
    columns = {name: getattr(front, 'draw_' + name) for name in names}
    draws = [{**{name: int(column[i]) for name, column in columns.items()},
              'matrix': front.draw_matrices[i].T.flatten().tolist()} for i in range(len(front.draw_flags))]
    cells = [{'number': cell.number, 'box': cell.box.flatten().tolist(), 'weight': cell.weight,
              'pages': cell.pages.tolist(), 'shares': cell.page_codes.tolist(), 'headings': cell.page_headings.tolist(),
              'draws': cell.draws.tolist(), 'images': cell.images.tolist(), 'imageShares': cell.image_codes.tolist()}
             for cell in read('cells/*', streamed_scene.cell_chunk, front)]
    return {'fingerprint': front.fingerprint, 'polygons': front.polygons, 'box': front.box.flatten().tolist(),
            'json': front.document, 'draws': draws,
            'pages': [{'url': front.page_name(i), 'bytes': int(front.page_bytes[i]),
                       'box': front.page_boxes[i].flatten().tolist()} for i in range(len(front.page_hashes))],
            'images': [[{'url': file.name(), 'bytes': file.bytes, 'width': file.width} for file in files]
                       for files in front.images],
            'chunks': [{'url': front.chunk_name(0), 'box': front.chunk_boxes[0].flatten().tolist()}],
            'everywhere': {'pages': front.everywhere.tolist(), 'images': front.images_everywhere.tolist()},
            'cells': cells}


def main():
    program = os.path.join(sys.argv[1], 'sightcell')
    path, site = os.path.join(HERE, 'rooms.glb'), os.path.join(HERE, 'rooms.site')
    write_glb(path, *scene())
    boxes = [(i * PITCH + 1, 1.2, 1, i * PITCH + 7, 3, 7) for i in range(3)]
    boxes.append((3, 1.2, 3, 5, 3, 5))  # in the first one
    with tempfile.TemporaryDirectory() as folder:
        pvs, cells = os.path.join(folder, 'rooms.pvs'), os.path.join(folder, 'cells.json')
        with open(cells, 'w', encoding='utf-8') as out:
            json.dump({'cells': [{'min': list(ends[:3]), 'max': list(ends[3:])} for ends in boxes]}, out)
        subprocess.run([program, 'bake', path, '-o', pvs, '--cells-file', cells, '--importance', '--quality', 'draft',
                        '--threads', '1'], check=True)
        shutil.rmtree(site, ignore_errors=True)
        subprocess.run([program, 'pack', '--stream', path, pvs, '-o', site, '--page-size', '2048', '--tileset'],
                       check=True)
    with open(os.path.join(HERE, 'rooms.json'), 'w', encoding='utf-8') as out:
        json.dump(answers(site), out)
        out.write('\n')


if __name__ == '__main__':
    main()
