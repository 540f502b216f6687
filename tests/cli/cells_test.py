"""Cells without a bake: what `sightcell cells` says is what a bake of the same options has."""
import json
import os
import struct

from harness import InFolder, read

# Few cells.
QUICK = ['--cell-size', '8', '--quality', 'draft']


def glb_document(data):
    """The JSON of a .glb file, and the bytes behind it."""
    magic, version, length, size, kind = struct.unpack_from('<4sII I4s', data)
    assert (magic, version, length, kind) == (b'glTF', 2, len(data), b'JSON'), data[:20]
    return json.loads(data[20:20 + size]), data[28 + size:]


class Cells(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.city = cls.make_city('city.glb', polygons=600)

    def preview(self, *options):
        return json.loads(self.expect(0, 'cells', self.city, '--json', *QUICK, *options)[0])

    def test_a_bake_has_these_cells(self):
        said = self.preview()
        file = self.path('city.pvs')
        err = self.expect(0, 'bake', self.city, '-o', file, *QUICK, '--progress', 'none', '--json')[1]
        self.assertIn(said['description'], err)
        stored = json.loads(self.expect(0, 'info', file, '--json')[0])['cells']
        self.assertLessEqual(stored, len(said['cells']), 'cells without a valid viewpoint are left out')
        self.assertGreater(stored, 0.5 * len(said['cells']))
        self.assertGreater(said['cpu_seconds'], 0)
        self.assertGreater(said['polygons_per_cell'], 0)

    def test_merged_cells_cover_those_that_are_not(self):
        small, merged = self.preview('--merge-cells', '0')['cells'], self.preview('--merge-cells', '0.5')['cells']
        self.assertLess(len(merged), 0.5 * len(small))

        def area(cell):
            return (cell['max'][0] - cell['min'][0]) * (cell['max'][2] - cell['min'][2])

        self.assertEqual({area(cell) for cell in small}, {64.0})
        for cell in merged:
            self.assertLessEqual(cell['max'][1] - cell['min'][1], cell['max'][0] - cell['min'][0], 'no higher than wide')
        self.assertGreater(len({area(cell) for cell in merged}), 1)
        for cell in small:
            middle = [0.5 * (a + b) for a, b in zip(cell['min'], cell['max'])]
            around = [m for m in merged
                      if all(a <= p < b for a, p, b in zip(m['min'], middle, m['max']))]
            self.assertEqual(len(around), 1, middle)

    def test_boxes_are_a_gltf_file(self):
        path = self.path('boxes.glb')
        cells = json.loads(self.expect(0, 'cells', self.city, '--boxes', path, '--json', *QUICK)[0])['cells']
        document, rest = glb_document(read(path))
        self.assertEqual(len(document['nodes']), len(cells))
        for node, cell in zip(document['nodes'], cells):
            for axis in range(3):
                low, side = cell['min'][axis], cell['max'][axis] - cell['min'][axis]
                self.assertAlmostEqual(node['translation'][axis], low + 0.01 * side, places=4)
                self.assertAlmostEqual(node['scale'][axis], 0.98 * side, places=4)
        # The front of each triangle of the unit cube is outside.
        corners = [struct.unpack_from('<3f', rest, 12 * i) for i in range(8)]
        for triangle in range(12):
            a, b, c = (corners[i] for i in struct.unpack_from('<3H', rest, 96 + 6 * triangle))
            u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
            normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            out = [x + y + z - 1.5 for x, y, z in zip(a, b, c)]
            self.assertGreater(sum(n * o for n, o in zip(normal, out)), 0, triangle)
        self.assertIn(f'{12 * len(cells):,} polygons', self.expect(0, 'info', path)[0])

    def test_boxes_that_cannot_be_written_leave_nothing(self):
        self.assert_one_error_line(
            self.expect(1, 'cells', self.city, '--boxes', self.path('none/boxes.glb'))[1], 'cli.not-writable')
        self.assertFalse(os.path.exists(self.path('none')))
