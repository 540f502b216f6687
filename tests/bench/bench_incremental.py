#!/usr/bin/env python3
"""Incremental bakes of a scene after edits of single nodes: cells baked again, CPU seconds, and whether the file has the
bytes of a full bake.

usage: bench_incremental.py SCENE.glb [--bin FOLDER] [--cells N] [--cell-size M] [--quality NAME] [--rays N] [--quick]

Then the same with --keep-found: CPU seconds, polygons of the sets over those of the full bake, and misses of `verify`.

Edits of a prop (a node whose box has a diagonal of 0.5 to 8 m): removed, moved by a meter, twice as large, its material
to MASK, a copy of it added 3 m away. Edits of the file alone: other names, the
nodes of the scene in another order. --quick: three edits.
Exit code 1 if a file differs.
"""
import argparse
import copy
import json
import os
import random
import struct
import subprocess
import sys
import tempfile


def read_glb(path):
    with open(path, 'rb') as file:
        content = file.read()
    length = struct.unpack_from('<I', content, 12)[0]
    return json.loads(content[20:20 + length]), content[20 + length:]


def write_glb(path, document, rest):
    text = json.dumps(document).encode()
    text += b' ' * (-len(text) % 4)
    with open(path, 'wb') as out:
        out.write(struct.pack('<4sII', b'glTF', 2, 20 + len(text) + len(rest)))
        out.write(struct.pack('<I4s', len(text), b'JSON') + text + rest)


def product(a, b):
    """Of two matrices, column by column as in glTF."""
    return [sum(a[4 * k + row] * b[4 * column + k] for k in range(4)) for column in range(4) for row in range(4)]


def matrix_of(node):
    if 'matrix' in node:
        return node['matrix']
    x, y, z, w = node.get('rotation', (0, 0, 0, 1))
    s, t = node.get('scale', (1, 1, 1)), node.get('translation', (0, 0, 0))
    columns = [(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)),
               (2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)),
               (2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y))]
    return [*(v * s[0] for v in columns[0]), 0, *(v * s[1] for v in columns[1]), 0, *(v * s[2] for v in columns[2]), 0, *t, 1]


def box_of(document, node, to_world):
    low, high = [1e30] * 3, [-1e30] * 3
    for primitive in document['meshes'][node['mesh']]['primitives']:
        accessor = document['accessors'][primitive['attributes']['POSITION']]
        for corner in range(8):
            p = [accessor['max' if corner >> k & 1 else 'min'][k] for k in range(3)] + [1]
            at = [sum(to_world[4 * k + row] * p[k] for k in range(4)) for row in range(3)]
            low, high = [min(a, b) for a, b in zip(low, at)], [max(a, b) for a, b in zip(high, at)]
    return low, high


def boxes_of_nodes(document):
    """Of each node with a mesh: its box in the world."""
    found = {}

    def walk(number, above):
        node = document['nodes'][number]
        here = product(above, matrix_of(node))
        if 'mesh' in node:
            found[number] = box_of(document, node, here)
        for child in node.get('children', []):
            walk(child, here)
    for root in document['scenes'][document.get('scene', 0)]['nodes']:
        walk(root, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    return found


def near_cells(box, cells):
    """Whether a box is within 20 m of a cell."""
    return any(all(box[0][k] < cell['max'][k] + 20 and box[1][k] > cell['min'][k] - 20 for k in range(3)) for cell in cells)


def set_matrix(node, matrix):
    for key in ('rotation', 'scale', 'translation'):
        node.pop(key, None)
    node['matrix'] = matrix


def removed(document, prop):
    del document['nodes'][prop]['mesh']


def moved(document, prop):
    node = document['nodes'][prop]
    set_matrix(node, product(matrix_of(node), [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1]))


def resized(document, prop):
    node = document['nodes'][prop]
    low = document['accessors'][document['meshes'][node['mesh']]['primitives'][0]['attributes']['POSITION']]['min']
    set_matrix(node, product(matrix_of(node), [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, -low[0], -low[1], -low[2], 1]))


def to_mask(document, prop):
    node = document['nodes'][prop]
    mesh = copy.deepcopy(document['meshes'][node['mesh']])
    for primitive in mesh['primitives']:
        material = copy.deepcopy(document['materials'][primitive['material']]) if 'material' in primitive else {}
        document.setdefault('materials', []).append({**material, 'alphaMode': 'MASK', 'doubleSided': True})
        primitive['material'] = len(document['materials']) - 1
    document['meshes'].append(mesh)
    node['mesh'] = len(document['meshes']) - 1


def added(document, prop):
    node = document['nodes'][prop]
    document['nodes'].append({'mesh': node['mesh'], 'matrix': [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 3, 1]})
    node.setdefault('children', []).append(len(document['nodes']) - 1)


def renamed(document, _):
    for number, node in enumerate(document['nodes']):
        node['name'] = f'node {number}'


def reordered(document, _):
    document['scenes'][document.get('scene', 0)]['nodes'].reverse()


EDITS = [removed, moved, reordered, resized, to_mask, added, renamed]


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument('scene')
    arguments.add_argument('--bin', default='build/release/bin')
    arguments.add_argument('--cells', type=int, default=64)
    arguments.add_argument('--cell-size', default='4')
    arguments.add_argument('--quality', default='normal')
    arguments.add_argument('--seed', type=int, default=1, help='chooses the prop of each edit')
    arguments.add_argument('--rays', type=int, default=1000000, help='rays of verify')
    arguments.add_argument('--quick', action='store_true')
    given = arguments.parse_args()
    program = os.path.join(given.bin, 'sightcell')
    document, rest = read_glb(given.scene)
    with tempfile.TemporaryDirectory() as folder:
        def path(name):
            return os.path.join(folder, name)

        def run(*command):
            done = subprocess.run([program, *command], capture_output=True, text=True, check=False)
            if done.returncode not in (0, 3):
                sys.exit(done.stderr)
            return json.loads(done.stdout)

        def bake(scene, output, *more):
            return run('bake', scene, '-o', path(output), '--cells-file', path('cells.json'), '--quality', given.quality,
                       '--source', 'cpu', '--progress', 'none', '--json', *more)
        listed = run('cells', given.scene, '--cell-size', given.cell_size, '--merge-cells', '0', '--json')['cells']
        middle = listed[len(listed) // 2]
        # Neighbors of each other, as all cells of a level are.
        listed.sort(key=lambda cell: sum((cell['min'][k] - middle['min'][k]) ** 2 for k in range(3)))
        cells = listed[:given.cells]
        with open(path('cells.json'), 'w', encoding='utf-8') as out:
            json.dump({'cells': cells}, out)
        props = [n for n, box in sorted(boxes_of_nodes(document).items())
                 if 0.5 < sum((a - b) ** 2 for a, b in zip(*box)) ** 0.5 < 8 and near_cells(box, cells)]
        chosen = random.Random(given.seed)
        before = bake(given.scene, 'before.pvs', '--keep-records')
        print(f'{len(cells)} cells, {before["polygons"]} polygons, {len(props)} props near them; with records '
              f'{before["cpu_seconds"]:.1f} CPU s, {os.path.getsize(path("before.pvs.records")) / 1e6:.1f} MB of records')
        print('edit,cells_again,changed_polygon,something_new,neighbors,cpu_full,cpu_since,share,equal,cpu_found,'
              'share_found,polygons_found,misses_found')
        good = True
        for edit in EDITS[:3] if given.quick else EDITS:
            changed = copy.deepcopy(document)
            edit(changed, chosen.choice(props))
            write_glb(path('edited.glb'), changed, rest)
            full, some = bake(path('edited.glb'), 'full.pvs'), bake(path('edited.glb'), 'some.pvs', '--since',
                                                                    path('before.pvs'))
            with open(path('full.pvs'), 'rb') as a, open(path('some.pvs'), 'rb') as b:
                equal = a.read() == b.read()
            good = good and equal
            quick = bake(path('edited.glb'), 'quick.pvs', '--since', path('before.pvs'), '--keep-found')
            checked = run('verify', path('edited.glb'), path('quick.pvs'), '--rays', str(given.rays), '--json')
            again = some['cells_rebaked']
            print(f'{edit.__name__},{again["cells"]},{again["changed_polygon"]},{again["something_new"]},{again["neighbors"]},'
                  f'{full["cpu_seconds"]:.1f},{some["cpu_seconds"]:.1f},'
                  f'{some["cpu_seconds"] / full["cpu_seconds"]:.2f},{"yes" if equal else "NO"},'
                  f'{quick["cpu_seconds"]:.1f},{quick["cpu_seconds"] / full["cpu_seconds"]:.2f},'
                  f'{quick["visible_set_percent"] / full["visible_set_percent"]:.3f},{checked["misses"]} of {given.rays}',
                  flush=True)
    sys.exit(0 if good else 1)


if __name__ == '__main__':
    main()
