#!/usr/bin/python3
"""Writes the whole contents of a streamed scene as one .glb: a node per draw, a mesh per geometry and material.

usage: rebuilt_glb.py SITE OUT.glb

For comparing a streamed scene with what it was packed from (tests/bench/two_pictures.cpp). Positions and coordinates of
textures are floats with the values of the pages; images are the last file of each.
"""
import json
import os
import struct
import sys

sys.dont_write_bytecode = True  # nothing is written into the sources
import numpy as np  # noqa: E402
import streamed_scene  # noqa: E402

MIME = {'png': 'image/png', 'jpg': 'image/jpeg', 'webp': 'image/webp', 'ktx2': 'image/ktx2'}
TYPES = {2: 'VEC2', 3: 'VEC3', 4: 'VEC4'}


class Document:
    def __init__(self, json_of_front):
        self.json = {**json_of_front, 'buffers': [{}], 'bufferViews': [], 'accessors': [], 'meshes': [], 'nodes': []}
        self.binary = bytearray()

    def view(self, data):
        self.binary += bytes(-len(self.binary) % 4)
        self.json['bufferViews'].append({'buffer': 0, 'byteOffset': len(self.binary), 'byteLength': len(data)})
        self.binary += data
        return len(self.json['bufferViews']) - 1

    def accessor(self, values, kind, component):
        entry = {'bufferView': self.view(values.tobytes()), 'componentType': component, 'count': len(values), 'type': kind}
        if kind == 'VEC3' and len(values):
            entry.update(min=values.min(axis=0).tolist(), max=values.max(axis=0).tolist())
        self.json['accessors'].append(entry)
        return len(self.json['accessors']) - 1

    def write(self, path):
        self.json['buffers'] = [{'byteLength': len(self.binary)}]
        text = json.dumps({k: v for k, v in self.json.items() if v != []}).encode()
        text += b' ' * (-len(text) % 4)
        self.binary += bytes(-len(self.binary) % 4)
        with open(path, 'wb') as file:
            file.write(struct.pack('<4sII', b'glTF', 2, 28 + len(text) + len(self.binary)))
            file.write(struct.pack('<I4s', len(text), b'JSON') + text)
            file.write(struct.pack('<I4s', len(self.binary), b'BIN\0') + self.binary)


def joined(parts):
    """One list of corners per attribute: floats [3 n, width]."""
    names = set.intersection(*(set(part.attributes) for part in parts))
    return {name: np.concatenate([part.attributes[name][part.triangles].reshape(-1, part.attributes[name].shape[1])
                                  for part in parts]).astype('f4') for name in names}


def rebuild(site, path):
    front = site.front
    parts = [[] for _ in front.geometry_polygons]
    for number in range(len(front.page_bytes)):
        for part in site.page(number):
            parts[part.geometry].append(part)
    out = Document(front.document)
    attributes = []
    for some in parts:
        here = joined(some) if some else {}
        attributes.append({name: out.accessor(values, TYPES[values.shape[1]], 5126) for name, values in here.items()
                           if name == 'POSITION' or name.startswith(('TEXCOORD', 'COLOR'))})
    meshes = {}
    for draw, (geometry, material) in enumerate(zip(front.draw_geometry.tolist(), front.draw_material.tolist())):
        node = {'matrix': np.vstack([front.draw_matrices[draw], [0, 0, 0, 1]]).T.reshape(-1).tolist()}
        if attributes[geometry]:
            if (geometry, material) not in meshes:
                primitive = {'attributes': attributes[geometry], **({'material': material} if material >= 0 else {})}
                meshes[geometry, material] = len(meshes)
                out.json['meshes'].append({'primitives': [primitive]})
            node['mesh'] = meshes[geometry, material]
        out.json['nodes'].append(node)
    for image, files in enumerate(front.images):
        if files and files[-1].type in MIME:
            data = site.read(files[-1].name())
            out.json['images'][image].update(bufferView=out.view(data), mimeType=MIME[files[-1].type])
    out.json.update(scene=0, scenes=[{'nodes': list(range(len(front.draw_flags)))}])
    out.write(path)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__.split('\n\n')[1])
    rebuild(streamed_scene.open_site(os.path.abspath(sys.argv[1])), sys.argv[2])


if __name__ == '__main__':
    main()
