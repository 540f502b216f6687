#!/usr/bin/env python3
"""Incremental bakes of a scene after edits of single nodes: cells baked again, CPU seconds, and whether the file has the
bytes of a full bake.

usage: bench_incremental.py SCENE.glb [--bin FOLDER] [--cells N] [--cell-size M] [--quality NAME] [--rays N] [--quick]
                            [--buildings] [--at N] [--found-only] [--edits NAME ...]

Then with --keep-found --keep-order: CPU seconds, polygons of the sets and bytes over those of the full bake, and misses
of `verify`.

The cells are those around the cell in the middle of the list that has props within 20 m; with --at N, those around
cell N of the list. Edits of a prop (a node whose box has a diagonal of 0.5 to 8 m; without those, to 40 m; without
those, one of the four smallest nodes): removed, moved by a meter, twice as large, its material to MASK, a copy of it
added 3 m away, another mesh in its place. With --buildings, props are nodes of 8 to 40 m. Edits of a wall (a larger
node): the last tenth of its triangles removed, a copy of a prop stretched to a panel of 3 x 3 m beside it. A material
with alpha takes another image. Edits of the file alone: other names, the nodes of the scene in another order, a mesh
split into two primitives.
--quick: three edits. --edits: those with these names. --found-only: no plain `--since`; its columns are empty. Exit code
1 if a file differs.
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


def swapped(document, prop):
    """The mesh of another node, as if an instance were replaced."""
    others = [n['mesh'] for n in document['nodes'] if 'mesh' in n and n['mesh'] != document['nodes'][prop]['mesh']]
    document['nodes'][prop]['mesh'] = others[prop % len(others)]


def cut_indices(document, primitive, first, count):
    """A copy of a primitive with some of its triangles."""
    made = copy.deepcopy(primitive)
    accessor = copy.deepcopy(document['accessors'][primitive['indices']])
    size = {5121: 1, 5123: 2, 5125: 4}[accessor['componentType']]
    accessor['byteOffset'] = accessor.get('byteOffset', 0) + 3 * first * size
    accessor['count'] = 3 * count
    for key in ('min', 'max'):
        accessor.pop(key, None)
    document['accessors'].append(accessor)
    made['indices'] = len(document['accessors']) - 1
    return made


def with_primitives(document, number, change):
    """Gives a node a mesh of its own, with the primitives that change returns for each of the old ones."""
    node = document['nodes'][number]
    mesh = copy.deepcopy(document['meshes'][node['mesh']])
    mesh['primitives'] = [made for p in mesh['primitives']
                          for made in change(p, document['accessors'][p['indices']]['count'] // 3)]
    document['meshes'].append(mesh)
    node['mesh'] = len(document['meshes']) - 1


def opened(document, wall):
    with_primitives(document, wall, lambda p, n: [cut_indices(document, p, 0, n - max(1, n // 10))] if n > 1 else [])


def split(document, wall):
    def halves(primitive, n):
        half = n // 2
        return [cut_indices(document, primitive, *part) for part in ((0, half), (half, n - half)) if part[1] > 0]
    with_primitives(document, wall, halves)


def panel(document, prop):
    """A copy of the prop beside it, stretched to 3 x 3 m and 0.1 m thick."""
    node = document['nodes'][prop]
    accessors = [document['accessors'][p['attributes']['POSITION']] for p in document['meshes'][node['mesh']]['primitives']]
    low = [min(a['min'][k] for a in accessors) for k in range(3)]
    size = [max(max(a['max'][k] for a in accessors) - low[k], 1e-3) for k in range(3)]
    scale = [3 / size[0], 3 / size[1], 0.1 / size[2]]
    at = boxes_of_nodes(document)[prop][1]
    document['nodes'].append({'mesh': node['mesh'], 'scale': scale, 'translation': [at[k] - scale[k] * low[k] for k in range(3)]})
    document['scenes'][document.get('scene', 0)]['nodes'].append(len(document['nodes']) - 1)


def other_alpha(document, _):
    for material in document.get('materials', []):
        texture = material.get('pbrMetallicRoughness', {}).get('baseColorTexture')
        if material.get('alphaMode') == 'MASK' and texture and len(document['images']) > 1:
            changed = copy.deepcopy(document['textures'][texture['index']])
            changed['source'] = (changed['source'] + 1) % len(document['images'])
            document['textures'].append(changed)
            texture['index'] = len(document['textures']) - 1
            return
    raise LookupError('no material has alpha')


def renamed(document, _):
    for number, node in enumerate(document['nodes']):
        node['name'] = f'node {number}'


def reordered(document, _):
    document['scenes'][document.get('scene', 0)]['nodes'].reverse()


EDITS = [removed, moved, reordered, resized, to_mask, added, renamed, swapped, opened, panel, split, other_alpha]
OF_WALLS = (opened, split)


class Place:
    """Adjacent cells of a scene, and the nodes near them that edits choose from."""

    def __init__(self, document, listed, count, buildings=False, at=None):
        boxes = sorted(boxes_of_nodes(document).items())
        sizes = {n: sum((a - b) ** 2 for a, b in zip(*box)) ** 0.5 for n, box in boxes}
        classes = [(8, 40)] if buildings else [(0.5, 8), (8, 40)]  # props, then buildings

        def of_class(cells, low, high):
            return [n for n, box in boxes if low < sizes[n] < high and near_cells(box, cells)]
        middle = len(listed) // 2
        if at is None:
            at = next((i for of in classes for i in sorted(range(len(listed)), key=lambda i: abs(i - middle))
                       if of_class(listed[i:i + 1], *of)), middle)
        # Neighbors of each other, as all cells of a level are.
        center = listed[at]['min']
        self.cells = sorted(listed, key=lambda cell: sum((cell['min'][k] - center[k]) ** 2 for k in range(3)))[:count]
        self.near = {n: sizes[n] for n, box in boxes if near_cells(box, self.cells)}
        self.props = (next(filter(None, (of_class(self.cells, *of) for of in classes)), None)
                      or sorted(self.near, key=self.near.get)[:4])
        self.walls = [n for n, size in self.near.items() if size >= 8] or self.props

    def chosen(self, edit, random_numbers):
        return random_numbers.choice(self.walls if edit in OF_WALLS else self.props)

    def __str__(self):
        sizes = [self.near[n] for n in self.props]
        return f'{len(self.cells)} cells, {len(sizes)} props near them of {min(sizes):.1f} to {max(sizes):.1f} m'


def versions(document, place, edits, seed, names):
    """Each of the edits, or of those with these names, with the scene after it."""
    random_numbers = random.Random(seed)
    for edit in edits:
        changed = copy.deepcopy(document)
        node = place.chosen(edit, random_numbers)
        if names and edit.__name__ not in names:
            continue
        try:
            edit(changed, node)
        except LookupError as reason:
            print(f'{edit.__name__}: left out, {reason}', flush=True)
            continue
        yield edit, changed


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument('scene')
    arguments.add_argument('--bin', default='build/release/bin')
    arguments.add_argument('--cells', type=int, default=64)
    arguments.add_argument('--cell-size', default='4')
    arguments.add_argument('--quality', default='normal')
    arguments.add_argument('--seed', type=int, default=1, help='chooses the prop of each edit')
    arguments.add_argument('--rays', type=int, default=1000000, help='rays of verify')
    arguments.add_argument('--found-only', action='store_true', help='without plain --since')
    arguments.add_argument('--quick', action='store_true')
    arguments.add_argument('--buildings', action='store_true', help='edit nodes of 8 to 40 m')
    arguments.add_argument('--at', type=int, help='number of the cell in the middle')
    arguments.add_argument('--edits', nargs='+', choices=[edit.__name__ for edit in EDITS])
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
        place = Place(document, listed, given.cells, given.buildings, given.at)
        with open(path('cells.json'), 'w', encoding='utf-8') as out:
            json.dump({'cells': place.cells}, out)
        before = bake(given.scene, 'before.pvs', '--keep-records')
        print(f'{place}; {before["polygons"]} polygons; with records {before["cpu_seconds"]:.1f} CPU s, {os.path.getsize(path("before.pvs.records")) / 1e6:.1f} MB of records')
        print('edit,cells_again,changed_polygon,something_new,neighbors,cpu_full,cpu_since,share,equal,cpu_found,'
              'share_found,polygons_found,bytes_found,misses_found')
        good = True
        for edit, changed in versions(document, place, EDITS[:3] if given.quick else EDITS, given.seed, given.edits):
            write_glb(path('edited.glb'), changed, rest)
            full = bake(path('edited.glb'), 'full.pvs')
            since = ',,'
            if not given.found_only:
                some = bake(path('edited.glb'), 'some.pvs', '--since', path('before.pvs'))
                with open(path('full.pvs'), 'rb') as a, open(path('some.pvs'), 'rb') as b:
                    equal = a.read() == b.read()
                good = good and equal
                since = (f'{some["cpu_seconds"]:.1f},{some["cpu_seconds"] / full["cpu_seconds"]:.2f},'
                         f'{"yes" if equal else "NO"}')
            quick = bake(path('edited.glb'), 'quick.pvs', '--since', path('before.pvs'), '--keep-found',
                         '--keep-order')
            checked = run('verify', path('edited.glb'), path('quick.pvs'), '--rays', str(given.rays), '--json')
            again = (quick if given.found_only else some)['cells_rebaked']
            print(f'{edit.__name__},{again["cells"]},{again["changed_polygon"]},{again["something_new"]},{again["neighbors"]},'
                  f'{full["cpu_seconds"]:.1f},{since},'
                  f'{quick["cpu_seconds"]:.1f},{quick["cpu_seconds"] / full["cpu_seconds"]:.2f},'
                  f'{quick["visible_set_percent"] / full["visible_set_percent"]:.3f},'
                  f'{quick["bytes"] / full["bytes"]:.3f},{checked["misses"]} of {given.rays}',
                  flush=True)
    sys.exit(0 if good else 1)


if __name__ == '__main__':
    main()
