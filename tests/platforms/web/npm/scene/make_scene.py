#!/usr/bin/env python3
"""Makes the scene of three_test.mjs anew: a small town in which trees are instances (EXT_mesh_gpu_instancing), lamps are
children of a node whose mesh has one primitive (so that three.js has one object for both), one lamp is mirrored, one is
marked as dynamic, and roofs of one kind are transparent. Then bakes it and prints the answers of the native runtime.

usage: make_scene.py BIN    BIN: sightcell, sightcell-city, sightcell-test-dump
Writes town.glb, town.pvs and town.txt beside this file, and floor.pvs, whose cells cover all floors. Needed only where a change of the format ends the support of the
committed file.
"""
import json
import os
import re
import struct
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
EXTENSION = 'EXT_mesh_gpu_instancing'


def read_glb(path):
    with open(path, 'rb') as file:
        data = file.read()
    size = struct.unpack_from('<I', data, 12)[0]
    return json.loads(data[20:20 + size]), data[28 + size:]


def write_glb(path, document, binary):
    text = json.dumps(document, separators=(',', ':')).encode()
    text += b' ' * (-len(text) % 4)
    binary += b'\0' * (-len(binary) % 4)
    with open(path, 'wb') as out:
        out.write(struct.pack('<4sII', b'glTF', 2, 28 + len(text) + len(binary)))
        out.write(struct.pack('<I4s', len(text), b'JSON') + text + struct.pack('<I4s', len(binary), b'BIN\0') + binary)


def unlink(document, number):
    """Takes a node out of its place in the tree."""
    for holder in [node.get('children') for node in document['nodes']] + [document['scenes'][0]['nodes']]:
        if holder and number in holder:
            holder.remove(number)


def add_accessor(document, binary, rows):
    """The bytes with these rows of floats at their end, and the number of the new accessor."""
    kind = {3: 'VEC3', 4: 'VEC4'}[len(rows[0])]
    content = b''.join(struct.pack(f'<{len(row)}f', *row) for row in rows)
    binary += b'\0' * (-len(binary) % 4)
    document['bufferViews'].append({'buffer': 0, 'byteOffset': len(binary), 'byteLength': len(content)})
    document['accessors'].append({'bufferView': len(document['bufferViews']) - 1, 'componentType': 5126, 'type': kind,
                                  'count': len(rows)})
    return binary + content, len(document['accessors']) - 1


def change(document, binary):
    nodes = document['nodes']
    trees = [i for i, node in enumerate(nodes) if node.get('name') == 'small tree']
    lamps = [i for i, node in enumerate(nodes) if node.get('name') == 'lamp']
    ground = next(i for i, node in enumerate(nodes) if node.get('name') == 'outer ground')
    assert len(trees) > 2 and len(lamps) > 1
    attributes = {}
    for key, name, absent in (('TRANSLATION', 'translation', [0, 0, 0]), ('ROTATION', 'rotation', [0, 0, 0, 1]),
                              ('SCALE', 'scale', [1, 1, 1])):
        binary, attributes[key] = add_accessor(document, binary, [nodes[i].get(name, absent) for i in trees])
    for number in trees:
        unlink(document, number)
    for number in lamps:
        unlink(document, number)
    nodes.append({'mesh': nodes[trees[0]]['mesh'], 'name': 'trees', 'extensions': {EXTENSION: {'attributes': attributes}}})
    document['scenes'][0]['nodes'].append(len(nodes) - 1)
    nodes[ground]['children'] = lamps
    nodes[lamps[0]]['scale'] = [-1, 1, 1]
    nodes[lamps[1]]['extras'] = {'sightcell': {'dynamic': True}}
    next(m for m in document['materials'] if m['name'] == 'roof tile')['alphaMode'] = 'BLEND'
    document['extensionsUsed'] = [EXTENSION]
    document['buffers'][0]['byteLength'] = len(binary)
    return document, binary


def main():
    programs = sys.argv[1]
    glb, pvs = os.path.join(HERE, 'town.glb'), os.path.join(HERE, 'town.pvs')
    with tempfile.TemporaryDirectory() as folder:
        town, cells = os.path.join(folder, 'town.glb'), os.path.join(folder, 'cells.json')
        subprocess.run([os.path.join(programs, 'sightcell-city'), '--polygons', '1000', '--seed', '1', '--out', town,
                        '--cells', cells], check=True)
        write_glb(glb, *change(*read_glb(town)))
        subprocess.run([os.path.join(programs, 'sightcell'), 'bake', glb, '-o', pvs, '--cells-file', cells, '--quality',
                        'draft', '--threads', '1'], check=True)
        subprocess.run([os.path.join(programs, 'sightcell'), 'bake', glb, '-o', os.path.join(HERE, 'floor.pvs'),
                        '--merge-cells', '0', '--threads', '1'], check=True)
    dump = subprocess.run([os.path.join(programs, 'sightcell-test-dump'), pvs], check=True, capture_output=True,
                          text=True).stdout
    lines = [re.sub(r'  sees.*', '', line) for line in dump.splitlines() if re.match(r'cell|ranges', line)]
    with open(os.path.join(HERE, 'town.txt'), 'w', encoding='utf-8') as out:
        out.write('\n'.join(lines) + '\n')


if __name__ == '__main__':
    main()
