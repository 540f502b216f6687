"""Cells without a bake: what `sightcell cells` says is what a bake of the same options has."""
import base64
import json
import os
import struct

from harness import InFolder, read, write_triangles

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
        size = os.path.getsize(file)
        self.assertLess(size / 2, said['file_bytes'])
        self.assertLess(said['file_bytes'], 2 * size)
        self.assertEqual(self.preview()['file_bytes'], said['file_bytes'])

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

    def test_plan_is_a_picture_of_each_floor(self):
        before = set(os.listdir(self.path('')))
        pictures = {}
        for prefix in ('one', 'two'):
            said = json.loads(self.expect(0, 'cells', self.city, '--plan', self.path(prefix), '--json', *QUICK)[0])
            floors = said['floors']
            self.assertGreater(len(floors), 0)
            self.assertEqual(sorted(cell for floor in floors for cell in floor['cells']),
                             list(range(len(said['cells']))))
            pictures[prefix] = [read(self.path(f'{prefix}-{i + 1}.png')) for i in range(len(floors))]
        self.assertEqual(pictures['one'], pictures['two'])
        for data in pictures['one']:
            self.assertEqual(data[:8], b'\x89PNG\r\n\x1a\n')
            self.assertLessEqual(max(struct.unpack_from('>2I', data, 16)), 4200)
        self.assertEqual(len(set(os.listdir(self.path(''))) - before), 2 * len(floors), 'and no other file')

    def test_a_plan_that_cannot_be_written_leaves_nothing(self):
        self.assert_one_error_line(
            self.expect(1, 'cells', self.city, '--plan', self.path('none/plan'), *QUICK)[1], 'picture.write')
        self.assertFalse(os.path.exists(self.path('none')))

    def test_boxes_that_cannot_be_written_leave_nothing(self):
        self.assert_one_error_line(
            self.expect(1, 'cells', self.city, '--boxes', self.path('none/boxes.glb'))[1], 'cli.not-writable')
        self.assertFalse(os.path.exists(self.path('none')))


# Cells without floors: 4 x 4 x 4 of 8 x 4 x 8 m, in four blocks.
FLY = ['--fly=-16,0,-16,16,16,16', '--reach', 'none', '--max-pixel-error', '3e-2', '--cell-size', '8']


class OtherWays(InFolder):
    """Cells where no floor is: --fly, --path, and boxes in the scene."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.city = cls.make_city('city.glb', polygons=600)

    def cells(self, scene, *options):
        return json.loads(self.expect(0, 'cells', scene, '--json', *options)[0])

    def bake(self, scene, name, *options):
        file = self.path(name)
        err = self.expect(0, 'bake', scene, '-o', file, '--progress', 'none', *options)[1]
        return read(file), json.loads(self.expect(0, 'info', file, '--json')[0]), err

    def test_a_box_is_all_cells_and_merged(self):
        all_cells = self.cells(self.city, *FLY, '--merge-cells', '0')
        self.assertEqual(len(all_cells['cells']), 4 * 4 * 4)
        self.assertEqual(all_cells['description'], '64 cells of 8 m in 1 box of --fly')
        merged = self.cells(self.city, *FLY, '--merge-cells', '0.5')
        self.assertLess(len(merged['cells']), 32)

        def volume(cell):
            sides = [b - a for a, b in zip(cell['min'], cell['max'])]
            return sides[0] * sides[1] * sides[2]

        self.assertEqual(sum(map(volume, merged['cells'])), 32 * 32 * 16)

    def test_shards_of_a_box_give_the_same_bytes(self):
        alone, info, _ = self.bake(self.city, 'alone.pvs', *FLY)
        self.assertEqual(info['settings']['fly'], [[-16, 0, -16, 16, 16, 16]])
        self.assertEqual(info['settings']['reach'], 'none')
        shards = self.path('shards.pvs')
        for phase in '1', '2':
            for shard in '0/2', '1/2':
                self.expect(0, 'bake', self.city, '-o', shards, *FLY, '--progress', 'none', '--shard', shard, '--phase',
                            phase)
        self.expect(0, 'merge', shards)
        self.assertEqual(read(shards), alone)

    def test_another_box_is_another_bake(self):
        file = self.path('kept.pvs')
        options = ['--quality', 'draft', '--cell-size', '8', '--reach', 'none', '--progress', 'none']
        # A shard leaves its file, which has the key of its bake.
        self.expect(0, 'bake', self.city, '-o', file, *options, '--fly', '0,0,0,8,4,8', '--shard', '0/1')
        self.assert_one_error_line(
            self.expect(2, 'bake', self.city, '-o', file, *options, '--fly', '0,0,0,16,4,8', '--shard', '0/1')[1],
            'shard.other-bake')

    def test_a_path_has_the_cells_along_it(self):
        path = self.path('path.json')
        with open(path, 'w', encoding='utf-8') as out:
            json.dump({'path': [[1, 18, 1], [30, 18, 1]]}, out)
        options = ['--path', path, '--reach', 'none', '--cell-size', '8', '--merge-cells', '0']
        found = self.cells(self.city, *options)
        self.assertEqual(sorted(cell['min'] for cell in found['cells']), [[x, 16, 0] for x in (0, 8, 16, 24)])
        self.assertEqual(len(self.cells(self.city, *options, '--path-radius', '1.5')['cells']), 5 * 2)
        _, info, err = self.bake(self.city, 'path.pvs', *options, '--quality', 'draft')
        self.assertIn('cells: 4 cells of 8 m within 0.5 m of 1 path', err)
        self.assertEqual(info['settings']['path_radius'], 0.5)

    def test_a_path_file_is_not_overwritten(self):
        path = self.path('kept.json')
        with open(path, 'w', encoding='utf-8') as out:
            out.write('{"path": [[0, 0, 0]]}')
        self.assert_one_error_line(self.expect(2, 'bake', self.city, '-o', path, '--path', path)[1],
                                   'cli.output-is-input')
        self.assertEqual(read(path), b'{"path": [[0, 0, 0]]}')

    def test_boxes_of_the_scene_are_cells(self):
        scene = self.path('marked.gltf')
        mark = {'sightcell': {'cell': True}}
        faces = [((0, 1, 2), 0), ((0, 2, 3), 0), ((0, 3, 1), 0), ((1, 3, 2), 0)]
        write_triangles(scene, faces, [{'doubleSided': True}], scenes=[{'nodes': [0, 1, 2]}],
                        nodes=[{'mesh': 0},
                               {'name': 'above', 'extras': mark, 'translation': [0, 4, 0]},
                               {'name': 'aside', 'mesh': 0, 'extras': mark, 'translation': [3, 0, 0]}])
        found = self.cells(scene)
        self.assertEqual(found['cells'], [{'name': 'above', 'min': [-1, 3, -1], 'max': [1, 5, 1]},
                                          {'name': 'aside', 'min': [3, 0, 0], 'max': [4, 1, 1]}])
        _, info, err = self.bake(scene, 'marked.pvs', '--quality', 'draft')
        self.assertIn('cells: 2 cells of the scene (extras.sightcell.cell), instead of cells over floors', err)
        self.assertEqual((info['cells'], info['polygons'], info['settings']['cells']), (2, 8, 'scene'))
        # The box mesh at 3 m does not occlude: each polygon of the other one is visible from inside of it or above.
        self.assertLessEqual(info['visible_set_percent'], 50)
        self.expect(0, 'verify', scene, self.path('marked.pvs'), '--rays', '20000')
        other = self.cells(scene, '--fly', '0,0,0,4,4,4', '--reach', 'none')
        self.assertEqual(len(other['cells']), 2)
        self.assertIn('2 cells of the scene (extras.sightcell.cell) are left out', other['warnings'][0])

    def test_a_camera_that_moves_is_a_path(self):
        scene = self.path('ride.gltf')
        write_triangles(scene, [((0, 1, 2), 0)], [{'doubleSided': True}], scenes=[{'nodes': [0, 1]}],
                        nodes=[{'mesh': 0}, {'name': 'ride', 'camera': 0}],
                        cameras=[{'type': 'perspective', 'perspective': {'yfov': 1, 'znear': 0.1}}])
        with open(scene, encoding='utf-8') as file:
            document = json.load(file)
        keys = struct.pack('<8f', 0, 1, 1, 1, 1, 11, 1, 1)
        document['buffers'].append({'byteLength': len(keys), 'uri': 'data:application/octet-stream;base64,' +
                                    base64.b64encode(keys).decode()})
        document['bufferViews'].append({'buffer': 1, 'byteLength': len(keys)})
        first = len(document['accessors'])
        document['accessors'] += [{'bufferView': 1, 'componentType': 5126, 'count': 2, 'type': 'SCALAR'},
                                  {'bufferView': 1, 'byteOffset': 8, 'componentType': 5126, 'count': 2, 'type': 'VEC3'}]
        document['animations'] = [{'samplers': [{'input': first, 'output': first + 1}],
                                   'channels': [{'sampler': 0, 'target': {'node': 1, 'path': 'translation'}}]}]
        with open(scene, 'w', encoding='utf-8') as file:
            json.dump(document, file)
        found = self.cells(scene, '--path-camera', 'ride', '--reach', 'none', '--merge-cells', '0')
        self.assertEqual([cell['min'] for cell in found['cells']], [[0, 0, 0], [4, 0, 0], [8, 0, 0]])
        self.assertEqual(found['description'], '3 cells of 4 m within 0.5 m of 1 path')
