"""Incremental bakes: after each of a dozen edits `bake --since` writes the bytes of a full bake, and bakes few cells."""
import copy
import json
import struct
import zlib

from harness import InFolder, read

# Two touching cells in the middle of each of six rooms of 6 x 3 x 6 m, three along x and two along z. Doors join rooms
# 0 - 1 - 2 at z = 3; the three others are closed.
ROOMS = [(x, z) for z in (0, 1) for x in (0, 1, 2)]
THICK = 0.2
BAKE = ['--samples', '6', '--resolution', '64', '--max-pixel-error', '1e-2', '--source', 'cpu', '--json', '--progress',
        'none']
CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]  # outward


def wall_with_door(name, x, z):
    """A wall at x, along z, with a door of 1 m in its middle."""
    low, high = (x - THICK / 2, 0, z), (x + THICK / 2, 3, z + 6)
    return [(name + ' a', low, (high[0], 3, z + 2.5), 0), (name + ' b', (low[0], 0, z + 3.5), high, 0),
            (name + ' c', (low[0], 2.2, z + 2.5), (high[0], 3, z + 3.5), 0)]


def house():
    """name, min, max, material of each box."""
    boxes = [('floor', (-1, -0.5, -1), (19, 0, 13), 0), ('roof', (-1, 3, -1), (19, 3.5, 13), 0)]
    boxes += [('south', (-0.1, 0, -0.1), (18.1, 3, 0.1), 0), ('north', (-0.1, 0, 11.9), (18.1, 3, 12.1), 0)]
    boxes += [(f'between {x}', (6 * x - 0.1, 0, 5.9), (6 * x + 6.1, 3, 6.1), 0) for x in range(3)]
    boxes += [('west', (-0.1, 0, 0), (0.1, 3, 12), 0), ('east', (17.9, 0, 0), (18.1, 3, 12), 0)]
    for x in (6, 12):
        boxes += wall_with_door(f'door at {x}', x, 0)
        boxes.append((f'wall at {x}', (x - 0.1, 0, 6), (x + 0.1, 3, 12), 0))
    for x, z in ROOMS:
        boxes.append((f'crate {x} {z}', (6 * x + 0.6, 0.1, 6 * z + 0.6), (6 * x + 1.4, 0.7, 6 * z + 1.3), 0))
        boxes.append((f'grate {x} {z}', (6 * x + 4.6, 0.1, 6 * z + 4.4), (6 * x + 5.3, 1.6, 6 * z + 4.5), 1))
    return boxes


def png(rows):
    """A gray image with alpha; rows: of alpha values."""
    def chunk(kind, body):
        return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
    pixels = b''.join(b'\0' + b''.join(bytes((128, alpha)) for alpha in row) for row in rows)
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', len(rows[0]), len(rows), 8, 4, 0, 0, 0)) +
            chunk(b'IDAT', zlib.compress(pixels)) + chunk(b'IEND', b''))


class Scene:
    """A scene that edits change."""

    def __init__(self):
        self.boxes = house()
        self.pebbles = [(14 + 0.4 * i, 0, 10) for i in range(4)]  # instances of a box of 0.2 m, in room 2 1
        self.alpha = [[255, 0] * 4, [0, 255] * 4] * 4
        self.split = False  # the mesh of boxes has two primitives

    def change(self, name, **to):
        for i, (old, low, high, material) in enumerate(self.boxes):
            if old == name:
                self.boxes[i] = (to.get('name', old), to.get('low', low), to.get('high', high),
                                 to.get('material', material))
                return
        raise KeyError(name)

    def write(self, path):
        corners = [CORNERS[i] for quad in QUADS for i in quad]
        uvs = [(0, 0), (0, 1), (1, 1), (1, 0)] * 6
        indices = [4 * quad + i for quad in range(6) for i in (0, 1, 2, 0, 2, 3)]
        parts = [b''.join(struct.pack('<3f', *c) for c in corners), b''.join(struct.pack('<2f', *uv) for uv in uvs),
                 struct.pack(f'<{len(indices)}H', *indices),
                 b''.join(struct.pack('<3f', *(5 * c for c in p)) for p in self.pebbles), png(self.alpha)]
        views, binary = [], b''
        for part in parts:
            views.append({'buffer': 0, 'byteOffset': len(binary), 'byteLength': len(part)})
            binary += part + b'\0' * (-len(part) % 4)
        half = len(indices) // 2
        accessors = [{'bufferView': 0, 'componentType': 5126, 'count': 24, 'type': 'VEC3', 'min': [0] * 3, 'max': [1] * 3},
                     {'bufferView': 1, 'componentType': 5126, 'count': 24, 'type': 'VEC2'},
                     {'bufferView': 2, 'componentType': 5123, 'count': len(indices), 'type': 'SCALAR'},
                     {'bufferView': 3, 'componentType': 5126, 'count': len(self.pebbles), 'type': 'VEC3'},
                     {'bufferView': 2, 'componentType': 5123, 'count': half, 'type': 'SCALAR'},
                     {'bufferView': 2, 'byteOffset': 2 * half, 'componentType': 5123, 'count': half, 'type': 'SCALAR'}]

        def mesh(material):
            return {'primitives': [{'attributes': {'POSITION': 0, 'TEXCOORD_0': 1}, 'indices': i, 'material': material}
                                   for i in ((4, 5) if self.split else (2,))]}
        nodes = [{'name': name, 'mesh': material, 'translation': low, 'scale': [b - a for a, b in zip(low, high)]}
                 for name, low, high, material in self.boxes]
        nodes.append({'name': 'pebbles', 'mesh': 0, 'scale': [0.2, 0.2, 0.2], 'extensions': {
            'EXT_mesh_gpu_instancing': {'attributes': {'TRANSLATION': 3}}}})  # the scale is that of places, too
        document = {
            'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': list(range(len(nodes)))}], 'nodes': nodes,
            'meshes': [mesh(0), mesh(1)], 'accessors': accessors, 'bufferViews': views,
            'buffers': [{'byteLength': len(binary)}], 'extensionsUsed': ['EXT_mesh_gpu_instancing'],
            'images': [{'bufferView': 4, 'mimeType': 'image/png'}], 'textures': [{'source': 0}],
            'materials': [{}, {'alphaMode': 'MASK', 'doubleSided': True,
                               'pbrMetallicRoughness': {'baseColorTexture': {'index': 0}}}]}
        text = json.dumps(document).encode()
        text += b' ' * (-len(text) % 4)
        with open(path, 'wb') as out:
            out.write(struct.pack('<4sII', b'glTF', 2, 28 + len(text) + len(binary)))
            out.write(struct.pack('<I4s', len(text), b'JSON') + text + struct.pack('<I4s', len(binary), b'BIN\0') + binary)


def add(scene):
    scene.boxes.append(('new', (8, 0, 10), (8.7, 0.8, 10.6), 0))


def remove(scene):
    scene.boxes = [box for box in scene.boxes if box[0] != 'crate 1 1']


def move(scene):
    scene.change('crate 1 1', low=(7.6, 0.1, 7), high=(8.4, 0.7, 7.7))


def resize(scene):
    scene.change('crate 2 0', high=(13.9, 1.9, 1.8))


def to_mask(scene):
    scene.change('crate 0 1', material=1)


def open_wall(scene):
    scene.boxes = [box for box in scene.boxes if box[0] != 'between 0']


def close_door(scene):
    scene.boxes.append(('leaf', (5.95, 0, 2.5), (6.05, 2.2, 3.5), 0))


def open_and_move(scene):
    """Two edits in rooms that do not see each other."""
    close_door(scene)
    move(scene)


def split(scene):
    scene.split = True


def rename(scene):
    scene.boxes = [('box ' + name[::-1], *rest) for name, *rest in scene.boxes]


def reorder(scene):
    scene.boxes = scene.boxes[::-1]


def change_alpha(scene):
    scene.alpha = [[255] * 8] * 4 + [[0] * 8] * 4


def change_instances(scene):
    scene.pebbles = scene.pebbles[:1] + [(15, 0, 9)] + scene.pebbles[2:]


def outside(scene):
    """Beyond all that was there."""
    scene.boxes.append(('tower', (60, 0, 60), (64, 30, 64), 0))


def screens(scene):
    """Four around the cells of a closed room: next to nothing of what they saw is left."""
    for low, high in (((7.4, 0, 7.4), (7.5, 3, 10.6)), ((10.5, 0, 7.4), (10.6, 3, 10.6)),
                      ((7.4, 0, 7.4), (10.6, 3, 7.5)), ((7.4, 0, 10.5), (10.6, 3, 10.6))):
        scene.boxes.append(('screen', low, high, 0))


# Edits, and how many of the 12 cells they may bake again at most.
EDITS = [(add, 2), (remove, 2), (move, 2), (resize, 6), (to_mask, 2), (open_wall, 10), (close_door, 6), (open_and_move, 8),
         (split, 0), (rename, 0), (reorder, 0), (change_alpha, 12), (change_instances, 2), (outside, 0)]


class Since(InFolder):
    """Edits of a house."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.cells = cls.path('cells.json')
        with open(cls.cells, 'w', encoding='utf-8') as out:
            json.dump({'cells': [{'name': f'{x} {z} {half}', 'min': [6 * x + 2 + half, 1, 6 * z + 2],
                                  'max': [6 * x + 3 + half, 2, 6 * z + 4]} for x, z in ROOMS for half in (0, 1)]}, out)
        cls.before = Scene()
        cls.before.write(cls.path('before.glb'))

    def bake(self, scene, output, *more, cells=None):
        """The summary."""
        out, _ = self.expect(0, 'bake', self.path(scene), '-o', self.path(output), '--cells-file', cells or self.cells,
                             *BAKE, *more)
        return json.loads(out)

    def edited(self, edit):
        scene = copy.deepcopy(self.before)
        edit(scene)
        scene.write(self.path('edited.glb'))

    def test_every_edit_has_the_bytes_of_a_full_bake(self):
        kept = self.bake('before.glb', 'before.pvs', '--keep-records')
        self.bake('before.glb', 'plain.pvs')
        self.assertEqual(read(self.path('before.pvs')), read(self.path('plain.pvs')), 'records change no byte')
        self.assertIsNone(kept['cells_rebaked'])
        for edit, most in EDITS:
            with self.subTest(edit.__name__):
                self.edited(edit)
                self.bake('edited.glb', 'full.pvs')
                some = self.bake('edited.glb', 'some.pvs', '--since', self.path('before.pvs'))
                self.assertEqual(read(self.path('some.pvs')), read(self.path('full.pvs')))
                again = some['cells_rebaked']
                self.assertEqual(again['cells'],
                                 sum(again[why] for why in ('changed_polygon', 'something_new', 'neighbors', 'started',
                                                            'new')))
                self.assertLessEqual(again['cells'], most, again)
                self.assertGreaterEqual(again['cells'], min(most, 1), again)

    def test_keep_found_proves_the_bound_again(self):
        self.bake('before.glb', 'kept.pvs', '--keep-records')
        for edit, most in EDITS:
            with self.subTest(edit.__name__):
                self.edited(edit)
                found = self.bake('edited.glb', 'found.pvs', '--since', self.path('kept.pvs'), '--keep-found')
                again = found['cells_rebaked']
                self.assertLessEqual(again['cells'], most, again)
                self.assertLessEqual(found['max_upper_bound'], 1e-2)
                out, _ = self.expect(0, 'verify', self.path('edited.glb'), self.path('found.pvs'), '--rays', '40000', '--json')
                self.assertLess(json.loads(out)['misses'], 0.01 * 40000)
                info, _ = self.expect(0, 'info', self.path('found.pvs'), '--json')
                self.assertIs(json.loads(info)['settings']['keep_found'], True)

    def test_a_full_bake_after_keep_found_has_its_bytes(self):
        self.bake('before.glb', 'kept.pvs', '--keep-records')
        self.edited(open_wall)
        found = self.bake('edited.glb', 'found.pvs', '--since', self.path('kept.pvs'), '--keep-found')
        some = self.bake('edited.glb', 'some.pvs', '--since', self.path('found.pvs'))
        self.bake('edited.glb', 'full.pvs')
        self.assertEqual(read(self.path('some.pvs')), read(self.path('full.pvs')))
        self.assertGreater(some['cells_rebaked']['started'], 0)
        self.assertLessEqual(some['cells_rebaked']['started'], found['cells_rebaked']['cells'])

    def test_keep_found_bakes_a_cell_anew_where_little_of_its_set_is_left(self):
        self.bake('before.glb', 'kept.pvs', '--keep-records')
        for edit, started in ((move, 2), (screens, 0)):
            with self.subTest(edit.__name__):
                self.edited(edit)
                found = self.bake('edited.glb', 'found.pvs', '--since', self.path('kept.pvs'), '--keep-found')
                some = self.bake('edited.glb', 'some.pvs', '--since', self.path('found.pvs'))
                self.assertEqual(found['cells_rebaked']['cells'], 2)
                self.assertEqual(some['cells_rebaked']['started'], started)

    def test_many_edits_in_a_row_keep_the_bound(self):
        self.bake('before.glb', 'row.pvs', '--keep-records')
        scene = copy.deepcopy(self.before)
        for edit in (close_door, add, move, resize, open_wall, change_instances):
            edit(scene)
            scene.write(self.path('edited.glb'))
            self.bake('edited.glb', 'row.pvs', '--since', self.path('row.pvs'), '--keep-found')
        out, _ = self.expect(0, 'verify', self.path('edited.glb'), self.path('row.pvs'), '--rays', '40000', '--json')
        self.assertLess(json.loads(out)['misses'], 0.01 * 40000)

    def test_keep_order_has_the_sets_of_a_full_bake(self):
        for layout, edits in (('instanced', (remove, move, open_wall, split, reorder, change_instances)),
                              ('merged', (remove, reorder))):
            how = ('--layout', layout, '--profile', 'exact')
            self.bake('before.glb', 'kept.pvs', '--keep-records', *how)
            for edit in edits:
                with self.subTest(layout + ' ' + edit.__name__):
                    self.edited(edit)
                    self.bake('edited.glb', 'full.pvs', *how)
                    self.bake('edited.glb', 'some.pvs', '--since', self.path('kept.pvs'), '--keep-order', *how)
                    out, _ = self.expect(0, 'diff', self.path('full.pvs'), self.path('some.pvs'), '--json')
                    self.assertEqual((json.loads(out)['cells_in_both'], json.loads(out)['cells_changed']), (12, 0))
                    info, _ = self.expect(0, 'info', self.path('some.pvs'), '--json')
                    self.assertIs(json.loads(info)['settings']['keep_order'], True)

    def test_keep_order_of_a_damaged_file_is_a_new_order(self):
        """Its records are whole, so no cell is lost."""
        self.bake('before.glb', 'kept.pvs', '--keep-records')
        whole = read(self.path('kept.pvs'))
        with open(self.path('kept.pvs'), 'wb') as damaged:
            damaged.write(whole[:200])
        _, err = self.expect(0, 'bake', self.path('before.glb'), '-o', self.path('some.pvs'), '--cells-file', self.cells, *BAKE,
                             '--since', self.path('kept.pvs'), '--keep-order')
        self.assertRegex(err, 'the order of .*kept.pvs is not kept')
        self.assertEqual(read(self.path('some.pvs')), whole)

    def test_what_an_edit_keeps_needs_an_earlier_bake(self):
        for option in ('--keep-found', '--keep-order'):
            _, err = self.expect(2, 'bake', self.path('before.glb'), '-o', self.path('none.pvs'), option)
            self.assertIn('--since', self.assert_one_error_line(err, 'settings.records'))

    def test_one_edit_after_the_other_in_one_file(self):
        self.bake('before.glb', 'level.pvs', '--keep-records')
        scene = copy.deepcopy(self.before)
        for edit in (add, close_door, reorder):
            edit(scene)
            scene.write(self.path('edited.glb'))
            self.bake('edited.glb', 'level.pvs', '--since', self.path('level.pvs'))
            self.bake('edited.glb', 'full.pvs')
            self.assertEqual(read(self.path('level.pvs')), read(self.path('full.pvs')), edit.__name__)

    def test_cells_that_come_and_go(self):
        self.bake('before.glb', 'cells.pvs', '--keep-records')
        with open(self.cells, encoding='utf-8') as file:
            cells = json.load(file)['cells']
        fewer = self.path('other.json')
        with open(fewer, 'w', encoding='utf-8') as out:
            json.dump({'cells': cells[2:] + [{'name': 'new', 'min': [1, 1, 7], 'max': [1.5, 2, 8]}]}, out)
        again = self.bake('before.glb', 'some.pvs', '--since', self.path('cells.pvs'), cells=fewer)
        self.bake('before.glb', 'full.pvs', cells=fewer)
        self.assertEqual(read(self.path('some.pvs')), read(self.path('full.pvs')))
        self.assertEqual(again['cells_rebaked'], {'cells': 1, 'changed_polygon': 0, 'something_new': 0, 'neighbors': 0,
                                                  'started': 0, 'new': 1})

    def test_damaged_records_are_refused(self):
        self.bake('before.glb', 'damaged.pvs', '--keep-records')
        whole = read(self.path('damaged.pvs.records'))
        for place in (0, 20, len(whole) // 2, len(whole) - 1):
            with open(self.path('damaged.pvs.records'), 'wb') as out:
                out.write(whole[:place] + bytes((whole[place] ^ 1,)) + whole[place + 1:])
            _, err = self.expect(4, 'bake', self.path('before.glb'), '-o', self.path('some.pvs'), '--cells-file',
                                 self.cells, *BAKE, '--since', self.path('damaged.pvs'))
            self.assertIn('damaged.pvs.records', self.assert_one_error_line(err, 'records.damaged'))
