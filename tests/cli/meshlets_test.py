"""`sightcell pack --meshlets`, read by a reader of its own: triangles, table, bounds, and what a bake makes of it."""
import collections
import json
import math
import os
import random
import struct

from decode_pvs import Contents
from harness import InFolder, read

TYPES = {5120: 'b', 5121: 'B', 5122: 'h', 5123: 'H', 5125: 'I', 5126: 'f'}
WIDTHS = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3, 'VEC4': 4, 'MAT4': 16}
ANYWHERE = struct.unpack('<f', b'\xff\xff\x7f\x7f')[0]
LevelGroup = collections.namedtuple('LevelGroup', 'first count level error x y z radius')
Levels = collections.namedtuple('Levels', 'leaves ranges meshlets groups links indices')
NONE = 0xFFFFFFFF
Meshlet = collections.namedtuple('Meshlet', 'group first count vertex vertices center radius apex axis cutoff')


class Glb:
    def __init__(self, path):
        data = read(path)
        magic, version, length, size = struct.unpack_from('<4sIII', data)
        assert (magic, version, length) == (b'glTF', 2, len(data))
        self.json = json.loads(data[20:20 + size])
        self.binary = data[20 + size + 8:]
        assert len(self.binary) - self.json['buffers'][0]['byteLength'] in range(4)

    def view(self, number):
        view = self.json['bufferViews'][number]
        at = view.get('byteOffset', 0)
        assert at % 4 == 0 and at + view['byteLength'] <= len(self.binary)
        return self.binary[at:at + view['byteLength']]

    def numbers(self, accessor):
        """The elements, as tuples. Floats keep their bits as they are packed again."""
        a = self.json['accessors'][accessor]
        view = self.json['bufferViews'][a['bufferView']]
        form = '<' + str(WIDTHS[a['type']]) + TYPES[a['componentType']]
        stride = view.get('byteStride', struct.calcsize(form))
        at = view.get('byteOffset', 0) + a.get('byteOffset', 0)
        return [struct.unpack_from(form, self.binary, at + i * stride) for i in range(a['count'])]

    def primitives(self):
        for m, mesh in enumerate(self.json['meshes']):
            for p, primitive in enumerate(mesh['primitives']):
                yield (m, p), primitive

    def corners(self, primitive):
        """The vertex numbers of triangles."""
        if 'indices' in primitive:
            flat = [i for i, in self.numbers(primitive['indices'])]
        else:
            flat = list(range(self.json['accessors'][primitive['attributes']['POSITION']]['count']))
        mode = primitive.get('mode', 4)
        if mode == 5:
            return [(flat[i], flat[i + 1 + i % 2], flat[i + 2 - i % 2]) for i in range(len(flat) - 2)]
        assert mode == 4
        return [tuple(flat[i:i + 3]) for i in range(0, len(flat) // 3 * 3, 3)]

    @staticmethod
    def records(data, at, count):
        rows = [struct.unpack_from('<5I11f', data, at + 64 * i) for i in range(count)]
        return [Meshlet(*r[:5], r[5:8], r[8], r[9:12], r[12:15], r[15]) for r in rows]

    def levels(self):
        """What follows the meshlets in version 2."""
        data = self.view(self.json['extras']['sightcell']['meshlets']['bufferView'])
        groups, leaves = struct.unpack_from('<2I', data, 8)
        at, = struct.unpack_from('<I', data, 24)
        coarse, level_groups, indices, *sizes = struct.unpack_from('<8I', data, at)
        assert sizes == [64, 32, 8, 0, 0]
        at += 32
        ranges = [struct.unpack_from('<4I', data, at + 16 * i) for i in range(groups)]
        at += 16 * groups
        records = self.records(data, at, coarse)
        at += 64 * coarse
        made = [LevelGroup(*struct.unpack_from('<3I5f', data, at + 32 * i)) for i in range(level_groups)]
        at += 32 * level_groups
        links = [struct.unpack_from('<2I', data, at + 8 * i) for i in range(leaves + coarse)]
        at += 8 * len(links)
        assert len(data) == at + 4 * indices
        return Levels(leaves, ranges, records, made, links, struct.unpack_from(f'<{indices}I', data, at))

    def table(self):
        """(groups, meshlets)"""
        where = self.json['extras']['sightcell']['meshlets']
        data = self.view(where['bufferView'])
        magic, version, groups, meshlets, group_bytes, bytes_each, *rest = struct.unpack_from('<8I', data)
        assert (magic, version, group_bytes, bytes_each, rest[1]) == (0x4C4D4353, where['version'], 16, 64, 0)
        end = 32 + 16 * groups + 64 * meshlets
        assert (version, rest[0], len(data)) == (1, 0, end) if version == 1 else (version, rest[0]) == (2, end)
        records = self.records(data, 32 + 16 * groups, meshlets)
        return [struct.unpack_from('<4I', data, 32 + 16 * i) for i in range(groups)], records


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def write_glb(path, document, parts):
    """parts: bytes of the buffer views, in their order."""
    binary, views = b'', []
    for part in parts:
        binary += b'\0' * (-len(binary) % 4)
        views.append({'buffer': 0, 'byteOffset': len(binary), 'byteLength': len(part)})
        binary += part
    binary += b'\0' * (-len(binary) % 4)
    text = json.dumps({'asset': {'version': '2.0'}, **document, 'bufferViews': views,
                       'buffers': [{'byteLength': len(binary)}]}).encode()
    text += b' ' * (-len(text) % 4)
    with open(path, 'wb') as out:
        out.write(struct.pack('<4sII', b'glTF', 2, 28 + len(text) + len(binary)))
        out.write(struct.pack('<I4s', len(text), b'JSON') + text + struct.pack('<I4s', len(binary), b'BIN\0') + binary)


def write_sketch(path):
    """A hilly grid of 800 triangles in an order without neighbors, twice with other materials, once mirrored; a strip; a
    mesh that its scene has clusters for; one of another scene."""
    random.seed(5)
    points = [(x, math.sin(x) + math.cos(z), z) for z in range(21) for x in range(21)]
    grid = []
    for z in range(20):
        for x in range(20):
            a = 21 * z + x
            grid += [(a, a + 21, a + 1), (a + 1, a + 21, a + 22)]
    random.shuffle(grid)
    some = grid[:300]
    parts = [b''.join(struct.pack('<3f', *p) for p in points),
             b''.join(struct.pack('<3H', *t) for t in grid), b''.join(struct.pack('<3H', *t) for t in some),
             struct.pack('<6H', 0, 21, 1, 22, 2, 23), struct.pack('<300B', *(i % 3 * 7 for i in range(300)))]
    accessors = [{'bufferView': 0, 'componentType': 5126, 'count': len(points), 'type': 'VEC3',
                  'min': [0, -2, 0], 'max': [20, 2, 20]}]
    accessors += [{'bufferView': i, 'componentType': 5121 if i == 4 else 5123, 'count': count, 'type': 'SCALAR'}
                  for i, count in ((1, 2400), (2, 900), (3, 6), (4, 300))]
    position = {'POSITION': 0}
    write_glb(path, {
        'scene': 0, 'scenes': [{'nodes': [0, 1, 2]}, {'nodes': [3]}],
        'nodes': [{'mesh': 0, 'name': 'hills'}, {'mesh': 0, 'scale': [-1, 1, 1], 'translation': [-5, 0, 0]},
                  {'mesh': 1, 'translation': [0, 30, 0]}, {'mesh': 2}],
        'materials': [{'name': 'plain'}, {'name': 'both', 'doubleSided': True}],
        'meshes': [{'primitives': [{'attributes': position, 'indices': 1, 'material': 0},
                                   {'attributes': position, 'indices': 2, 'material': 1}]},
                   {'primitives': [{'attributes': position, 'indices': 3, 'mode': 5},
                                   {'attributes': position, 'indices': 2,
                                    'extras': {'sightcell': {'clusters': 4}, 'other': 1}}]},
                   {'primitives': [{'attributes': position, 'indices': 2}]}],
        'accessors': accessors, 'extras': {'sightcell': {'start': 1}}}, parts)


class Meshlets(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sketch = cls.path('sketch.glb')
        write_sketch(cls.sketch)
        cls.city = cls.make_city('city.glb', polygons=3000)

    def pack(self, scene, name, *more):
        packed = self.path(name)
        told = json.loads(self.expect(0, 'pack', '--meshlets', *more, scene, '-o', packed, '--json')[0])
        self.assertEqual(told['bytes'], os.path.getsize(packed))
        return Glb(packed), told

    def expect_same_triangles(self, source, packed):
        """Of each primitive: the same triangles, each as often, with the same corners first."""
        self.assertEqual(packed.json['nodes'], source.json['nodes'])
        for (key, before), (same_key, after) in zip(source.primitives(), packed.primitives()):
            self.assertEqual(key, same_key)
            self.assertEqual(before.get('material'), after.get('material'))
            corners = []
            for glb, primitive in ((source, before), (packed, after)):
                columns = [glb.numbers(primitive['attributes'][name]) for name in sorted(primitive['attributes'])]
                vertices = list(zip(*columns))
                corners.append(sorted(tuple(vertices[i] for i in t) for t in glb.corners(primitive)))
            self.assertEqual(corners[0], corners[1], key)

    def expect_table(self, packed, told):
        groups, meshlets = packed.table()
        self.assertEqual((len(groups), len(meshlets)), (told['primitives'], told['meshlets']))
        self.assertEqual([g[:2] for g in groups], sorted(g[:2] for g in groups))
        primitives = dict(packed.primitives())
        at = 0
        for number, (mesh, primitive, first, count) in enumerate(groups):
            self.assertEqual(first, at)
            self.expect_group(packed, primitives[mesh, primitive], number, meshlets[first:first + count])
            at += count
        self.assertEqual(at, len(meshlets))
        return groups, meshlets

    def expect_group(self, packed, primitive, number, meshlets):
        triangles = packed.corners(primitive)
        positions = packed.numbers(primitive['attributes']['POSITION'])
        clusters = [c for c, in packed.numbers(primitive['extras']['sightcell']['clusters'])]
        self.assertEqual(clusters, [i for i, m in enumerate(meshlets) for _ in range(m.count)])
        at = 0
        for m in meshlets:
            self.assertEqual((m.group, m.first), (number, 3 * at))
            own = triangles[at:at + m.count]
            used = {i for t in own for i in t}
            self.assertEqual((min(used), max(used) + 1), (m.vertex, m.vertex + m.vertices))
            for i in used:
                self.assertLessEqual(math.dist(positions[i], m.center), m.radius)
            widest = max(math.dist(positions[i], positions[j]) for i in used for j in used)
            self.assertLessEqual(m.radius, widest + 1e-4)
            self.expect_cone(m, [[positions[i] for i in t] for t in own])
            at += m.count
        self.assertEqual(at, len(triangles))

    def expect_cone(self, m, triangles):
        """Where the cone faces away, so does each triangle."""
        if m.cutoff == 1:
            self.assertEqual(m.axis, (0, 0, 0))
            return
        self.cones += 1
        for _ in range(30):
            eye = tuple(c + 4 * m.radius * random.uniform(-1, 1) for c in m.center)
            to_apex = minus(m.apex, eye)
            if dot(to_apex, m.axis) < m.cutoff * math.hypot(*to_apex):
                continue
            self.culled += 1
            for a, b, c in triangles:
                normal = cross(minus(b, a), minus(c, a))
                self.assertGreaterEqual(dot(normal, minus(a, eye)), -1e-4 * math.hypot(*normal) * m.radius)

    def expect_columns(self, packed_path, told, *more):
        """A bake of the packed scene has a column for each meshlet of each draw, also after a recode."""
        bake = ['bake', packed_path, *more, '--quality', 'draft', '--cell-limit', '3']
        plain, baked, recoded = (self.path(name) for name in ('plain.pvs', 'baked.pvs', 'recoded.pvs'))
        self.expect(0, *bake, '-o', plain)
        self.expect(0, *bake, '-o', baked, '--granularity', 'cluster')
        self.expect(0, 'recode', plain, '--granularity', 'cluster', '--scene', packed_path, '-o', recoded)
        for path in (baked, recoded):
            info = json.loads(self.expect(0, 'info', path, '--json')[0])
            self.assertEqual((info['clusters'], info['polygons']), (told['drawn_meshlets'], told['polygons']))
            self.expect_clusters_are_meshlets(Glb(packed_path), Contents(read(path)))

    def expect_clusters_are_meshlets(self, packed, contents):
        """Each cluster of the file is a meshlet of a draw, found by its first polygon alone, and each is there once."""
        groups, meshlets = packed.table()
        counts = {(mesh, primitive, m.first): m.count for mesh, primitive, first, count in groups
                  for m in meshlets[first:first + count]}
        begins = contents.header.begins + [contents.header.polygons]
        found = set()
        for begin, end in zip(begins, begins[1:]):
            source = contents.source_of_stored[begin]
            node, mesh, primitive, instance, _, _, first, polygons = next(
                d for d in contents.draws if d[6] <= source < d[6] + d[7])[:8]
            self.assertEqual(contents.source_of_stored[begin:end], list(range(source, source + end - begin)))
            self.assertEqual(counts[mesh, primitive, 3 * (source - first)], end - begin)
            found.add((node, primitive, instance, source))
        self.assertEqual(len(found), len(begins) - 1)

    def test_sketch(self):
        self.cones = self.culled = 0
        packed, told = self.pack(self.sketch, 'sketch-packed.glb')
        self.expect_same_triangles(Glb(self.sketch), packed)
        groups, meshlets = self.expect_table(packed, told)
        self.assertEqual([g[:2] for g in groups], [(0, 0), (0, 1), (1, 0), (1, 1)], 'not of the other scene')
        self.assertEqual(groups[3][3], 3, "the scene's own clusters")
        self.assertTrue(all(m.cutoff == 1 for m in meshlets if m.group == 1), 'double-sided')
        self.assertTrue(self.cones > 5 and self.culled > 20, (self.cones, self.culled))
        self.assertTrue(max(m.count for m in meshlets if m.group == 0) <= 128)
        self.assertEqual(packed.json['extras']['sightcell']['start'], 1)
        self.assertEqual(packed.json['meshes'][1]['primitives'][1]['extras']['other'], 1)
        self.assertEqual(told['drawn_meshlets'], 2 * (groups[0][3] + groups[1][3]) + groups[2][3] + groups[3][3])
        again, _ = self.pack(self.path('sketch-packed.glb'), 'again.glb')
        self.assertEqual(again.table(), packed.table(), 'packing again changes nothing')

    def expect_levels(self, packed, number):
        """Of the primitive of a group of the table: each cut has its border, and what is coarser has fewer triangles."""
        groups, leaves = packed.table()
        levels = packed.levels()
        mesh, primitive, first_leaf, leaf_count = groups[number]
        first, count, _, _ = levels.ranges[number]
        source = dict(packed.primitives())[mesh, primitive]
        positions = packed.numbers(source['attributes']['POSITION'])
        triangles = [list(packed.corners(source)[m.first // 3:m.first // 3 + m.count])
                     for m in leaves[first_leaf:first_leaf + leaf_count]]
        numbers = list(range(first_leaf, first_leaf + leaf_count)) + list(range(first, first + count))
        for m in levels.meshlets[first - levels.leaves:first - levels.leaves + count]:
            self.assertEqual(m.group, number)
            corners = levels.indices[m.first:m.first + 3 * m.count]
            triangles.append([corners[i:i + 3] for i in range(0, len(corners), 3)])
            self.assertTrue(all(math.dist(positions[i], m.center) <= m.radius for i in corners))
        for c in numbers:
            made_by, member_of = levels.links[c]
            self.assertEqual(made_by == NONE, c < levels.leaves)
            if made_by != NONE:
                g = levels.groups[made_by]
                self.assertTrue(g.first <= c < g.first + g.count)
            if NONE not in (made_by, member_of):
                below, above = levels.groups[made_by], levels.groups[member_of]
                self.assertTrue(above.error >= below.error and above.level > below.level and above.first > c)
                self.assertLessEqual(math.dist(above[4:7], below[4:7]) + below.radius, above.radius)

        def border(some):
            edges = collections.Counter()
            for a, b, c in (t for own in some for t in own):
                for e in ((a, b), (b, c), (c, a)):
                    edges[tuple(sorted(e))] += 1 if e[0] < e[1] else -1
            return {e: n for e, n in edges.items() if n}

        whole = border(triangles[:leaf_count])
        sizes = []
        for limit in sorted({-1, *(g.error for g in levels.groups)}):
            def fine(g):
                return levels.groups[g].error <= limit
            cut = [own for c, own in zip(numbers, triangles)
                   if (levels.links[c][0] == NONE or fine(levels.links[c][0]))
                   and (levels.links[c][1] == NONE or not fine(levels.links[c][1]))]
            self.assertEqual(border(cut), whole)
            sizes.append(sum(map(len, cut)))
        self.assertEqual(sizes, sorted(sizes, reverse=True))
        self.assertLess(2 * sizes[-1], sizes[0])

    def test_levels(self):
        packed, told = self.pack(self.sketch, 'levels.glb', '--levels')
        plain, plainly = self.pack(self.sketch, 'plain.glb')
        self.assertEqual(packed.json['extras']['sightcell']['meshlets']['version'], 2)
        self.assertEqual(packed.table(), plain.table())
        self.assertEqual(plainly['coarse_meshlets'], 0)
        levels = packed.levels()
        self.assertEqual(len(levels.meshlets), told['coarse_meshlets'])
        self.expect_levels(packed, 0)
        before = read(self.path('levels.glb'))
        out, _ = self.expect(0, 'pack', '--meshlets', '--levels', self.sketch, '-o', self.path('levels.glb'))
        self.assertRegex(out, r'with all instances\), [\d,]+ coarser ones, table')
        self.assertEqual(read(self.path('levels.glb')), before)
        self.expect(0, 'bake', self.path('levels.glb'), '-o', self.path('levels.pvs'), '--quality', 'draft',
                    '--cell-limit', '2', '--granularity', 'cluster')
        cuts = json.loads(self.expect(0, 'verify', self.path('levels.glb'), self.path('levels.pvs'), '--cut', '0,4,1e4',
                                      '--rays', '5000', '--json')[0])['cuts']
        self.assertEqual([c['pixels'] for c in cuts], [0, 4, 1e4])
        self.assertLess(cuts[2]['cut_triangles'], cuts[0]['cut_triangles'])
        self.assertEqual(cuts[0]['leaf_clusters'], told['drawn_meshlets'])

    def test_city(self):
        self.cones = self.culled = 0
        packed, told = self.pack(self.city, 'packed.glb')
        self.expect_same_triangles(Glb(self.city), packed)
        self.expect_table(packed, told)
        before = read(self.path('packed.glb'))
        out, _ = self.expect(0, 'pack', '--meshlets', self.city, '-o', self.path('packed.glb'))
        self.assertEqual(read(self.path('packed.glb')), before)
        self.assertRegex(out, r'packed\.glb: [\d,]+ triangles of \d+ primitives in [\d,]+ meshlets \([\d,]+ with all inst')
        self.expect_columns(self.path('packed.glb'), told)

    def test_wrong_use(self):
        for arguments in (['--meshlets', self.city, 'level.pvs', '-o', 'a.glb'], [self.city, '-o', 'a.glb'],
                          ['--meshlets', '--stream', self.city, '-o', 'a'], ['--levels', self.city, '-o', 'a']):
            self.assert_one_error_line(self.expect(2, 'pack', *arguments)[1], 'cli.wrong-use')
        self.assert_one_error_line(self.expect(2, 'pack', '--meshlets', self.city, '-o', self.city)[1],
                                   'cli.output-is-input')
