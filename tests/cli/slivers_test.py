"""Cells that are nearly all solid: a bake of them ends, and says which it stored."""
import json
import struct

from harness import InRoom

CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
OUTSIDES = [(0, 4, 5, 1), (2, 3, 7, 6), (0, 1, 3, 2), (4, 6, 7, 5), (0, 2, 6, 4), (1, 5, 7, 3)]


def write_solids(path, solids, hollows=(), change=None):
    """Solid boxes and hollows in them, each the cube of a mesh as a node moves and scales it. change: of the document."""
    indices = [i for a, b, c, d in OUTSIDES for i in (a, b, c, a, c, d)]
    indices += indices[::-1]
    binary = b''.join(struct.pack('<3f', *c) for c in CORNERS) + struct.pack(f'<{len(indices)}H', *indices)
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': list(range(len(solids) + len(hollows)))}],
        'nodes': [{'mesh': mesh, 'translation': low, 'scale': [b - a for a, b in zip(low, high)]}
                  for mesh, boxes in enumerate((solids, hollows)) for low, high in boxes],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0}, 'indices': 1 + mesh}]} for mesh in (0, 1)],
        'buffers': [{'byteLength': len(binary)}],
        'bufferViews': [{'buffer': 0, 'byteLength': 96}, {'buffer': 0, 'byteOffset': 96, 'byteLength': 144}],
        'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 8, 'type': 'VEC3', 'min': [0] * 3, 'max': [1] * 3},
                      *({'bufferView': 1, 'byteOffset': 72 * mesh, 'componentType': 5123, 'count': 36, 'type': 'SCALAR'}
                        for mesh in (0, 1))]}
    if change is not None:
        change(document)
    text = json.dumps(document).encode()
    text += b' ' * (-len(text) % 4)
    with open(path, 'wb') as out:
        out.write(struct.pack('<4sII', b'glTF', 2, 28 + len(text) + len(binary)))
        out.write(struct.pack('<I4s', len(text), b'JSON') + text + struct.pack('<I4s', len(binary), b'BIN\0') + binary)


class Slivers(InRoom):
    def bake(self, name, *boxes):
        """Bakes the cell from the origin to (4, 2, 4), and an open one beside it, for a player 2 mm wide."""
        scene, file = self.path(f'{name}.glb'), self.path(f'{name}.pvs')
        write_solids(scene, *boxes)
        out, err = self.expect(0, 'bake', scene, '-o', file, '--cells-grid=-3.9,0.1,0.1,3.9,1.9,3.9', '--player-radius',
                               '0.001', '--max-pixel-error', '1e-2', '--json')
        return json.loads(out), err

    def test_a_slit_of_3_mm_is_no_cell(self):
        said, err = self.bake('slit', [([-1, -1, -1], [1.9985, 3, 5]), ([2.0015, -1, -1], [5, 3, 5])])
        self.assertEqual((said['cells'], said['cells_left_out'], said['cells_over_bound']), (1, 1, 0))
        self.assertIn('1 of 2 cells have no valid viewpoint, or too few for a camera', err)

    def test_a_hole_of_a_hundred_thousandth_is_no_cell(self):
        said, _ = self.bake('hole', [([-1, -1, -1], [5, 3, 5])], [([2, 1, 2], [2.08, 1.08, 2.08])])
        self.assertEqual((said['cells'], said['cells_left_out'], said['cells_over_bound']), (1, 1, 0))

    def test_a_slit_of_5_cm_is_a_cell_with_a_bound(self):
        said, _ = self.bake('gap', [([-1, -1, -1], [1.975, 3, 5]), ([2.025, -1, -1], [5, 3, 5])])
        self.assertEqual((said['cells'], said['cells_left_out'], said['cells_over_bound']), (2, 0, 0))
        self.assertLessEqual(said['max_upper_bound'], 1e-2)
