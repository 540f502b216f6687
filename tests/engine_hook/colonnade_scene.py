"""A hall whose pillars are all instances of one mesh: by nodes, mirrored, and by EXT_mesh_gpu_instancing."""
import json
import math
import struct

SIDES, RINGS = 8, 4  # of a pillar: 64 polygons


def pillar():
    """Corners and triangles of a pillar 0.8 m thick, from y = 0 to 3, thinner and turned a little at the top."""
    corners, triangles = [], []
    for ring in range(RINGS + 1):
        for side in range(SIDES):
            angle = 2 * math.pi * side / SIDES + 0.1 * ring
            radius = 0.4 - 0.03 * ring
            corners.append((radius * math.cos(angle), 3 * ring / RINGS, -radius * math.sin(angle)))
    for ring in range(RINGS):
        for side in range(SIDES):
            a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
            triangles += [(a, b, b + SIDES), (a, b + SIDES, a + SIDES)]
    return corners, triangles


def hall():
    """The inside of a box of 24 x 3 x 12 m: polygons 0 and 1 are the floor."""
    corners = [(x, y, z) for x in (-12, 12) for y in (0, 3) for z in (-6, 6)]
    quads = [(0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def pane():
    return [(-1, 0.5, 0), (1, 0.5, 0), (1, 2.5, 0), (-1, 2.5, 0)], [(0, 1, 2), (0, 2, 3)]


class Glb:
    def __init__(self):
        self.binary, self.views, self.accessors = b'', [], []

    def add(self, rows, kind, component='f'):
        data = b''.join(struct.pack(f'<{len(row)}{component}', *row) for row in rows)
        self.views.append({'buffer': 0, 'byteOffset': len(self.binary), 'byteLength': len(data)})
        self.binary += data
        count = len(rows) * (len(rows[0]) if kind == 'SCALAR' else 1)
        accessor = {'bufferView': len(self.views) - 1, 'componentType': 5126 if component == 'f' else 5125,
                    'count': count, 'type': kind}
        if kind == 'VEC3':
            accessor.update(min=[min(c) for c in zip(*rows)], max=[max(c) for c in zip(*rows)])
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def mesh(self, shape, material):
        corners, triangles = shape
        return {'primitives': [{'attributes': {'POSITION': self.add(corners, 'VEC3')}, 'material': material,
                                'indices': self.add(triangles, 'SCALAR', 'I')}]}

    def write(self, path, document):
        """document: its JSON, with this buffer, these views and accessors in it."""
        text = json.dumps(document).encode()
        text += b' ' * (-len(text) % 4)
        with open(path, 'wb') as out:
            out.write(struct.pack('<4sII', b'glTF', 2, 28 + len(text) + len(self.binary)))
            out.write(struct.pack('<I4s', len(text), b'JSON') + text)
            out.write(struct.pack('<I4s', len(self.binary), b'BIN\0') + self.binary)


def write_colonnade(path):
    """Walls first, then 17 pillars of one mesh and two blended panes of another."""
    glb = Glb()
    meshes = [glb.mesh(hall(), 0), glb.mesh(pillar(), 1), glb.mesh(pane(), 2)]
    places = [(-9 + 3 * i, 0, z) for i in range(6) for z in (-2.5, 2.5)]
    turns = [(0, math.sin(0.3 * i), 0, math.cos(0.3 * i)) for i in range(len(places))]
    sizes = [(1 + 0.05 * (i % 5), 1, 1 + 0.05 * (i % 5)) for i in range(len(places))]
    instances = {'TRANSLATION': glb.add(places, 'VEC3'), 'ROTATION': glb.add(turns, 'VEC4'),
                 'SCALE': glb.add(sizes, 'VEC3')}
    nodes = [{'mesh': 0},
             {'mesh': 1, 'extensions': {'EXT_mesh_gpu_instancing': {'attributes': instances}}},
             {'mesh': 1, 'translation': [9, 0, 0]},
             {'mesh': 1, 'translation': [-11, 0, 0.5], 'scale': [-1, 1, 1]},  # mirrored
             {'mesh': 1, 'translation': [10, 0, -4], 'scale': [1.5, 1, 1.5]},
             {'mesh': 1, 'translation': [10, 0, 4], 'scale': [1, 1, -1]},  # mirrored
             {'mesh': 1, 'translation': [9, 0, 0]},  # a second time in the same place
             {'mesh': 2, 'translation': [-4.5, 0, 0.5]},
             {'mesh': 2, 'translation': [5, 0, -1], 'rotation': [0, math.sin(0.5), 0, math.cos(0.5)]}]
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': list(range(len(nodes)))}], 'nodes': nodes,
        'extensionsUsed': ['EXT_mesh_gpu_instancing'], 'extensionsRequired': ['EXT_mesh_gpu_instancing'],
        'meshes': meshes,
        'materials': [{'name': 'walls'}, {'name': 'stone'},
                      {'name': 'glass', 'alphaMode': 'BLEND', 'doubleSided': True,
                       'pbrMetallicRoughness': {'baseColorFactor': [0.5, 0.8, 1, 0.3]}}],
        'buffers': [{'byteLength': len(glb.binary)}], 'bufferViews': glb.views, 'accessors': glb.accessors}
    glb.write(path, document)


def write_cells(path):
    """Four places between the pillars."""
    boxes = [((-7.8, 1, -1), (-6.6, 2, 1)), ((-1, 1, -1.5), (1, 2, 1.5)), ((4.2, 1.2, 0.4), (5.6, 2, 1.6)),
             ((-10, 1, -5), (-8, 2, -4))]
    cells = [{'name': f'place {i}', 'min': low, 'max': high} for i, (low, high) in enumerate(boxes)]
    with open(path, 'w', encoding='utf-8') as out:
        json.dump({'cells': cells}, out)
