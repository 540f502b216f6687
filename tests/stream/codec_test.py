"""The decoders of EXT_meshopt_compression: streams made by hand, and a real file that another program wrote."""
import os

import numpy as np
import pytest

import meshopt_codec
from gltf_reader import apply, node_matrix, read_draws, read_gltf
from matching import partners
from pair_sets import candidates, corner_distance
from small_site import encoded_attributes, encoded_triangles, exponential_words

TOLERANCE = 1.5 / (1 << 13)  # of corners, in parts of the size of their node
# One byte of each element is stored in each of the four ways. That of the last four bits is the example of the text.
BYTES_0 = bytes([0])  # no deltas
BYTES_1 = bytes([1, 0x1B, 0xE4, 0x00, 0xC0, 0x10, 0x0F, 0xFE])  # 2 bits: 0 1 2 *, * 2 1 0, four 0, * 0 0 0
BYTES_2 = bytes([2, 0x17, 0x5F, 0xF0, 0xBC, 0x77, 0xA9, 0x21, 0x00, 0x34, 0xB5])
BYTES_3 = bytes([3, *range(16)])
BASELINE = bytes([7, 100, 50, 250])
ATTRIBUTES = b'\xa0' + BYTES_0 + BYTES_1 + BYTES_2 + BYTES_3 + bytes(28) + BASELINE
DELTAS = [[0] * 16,
          [0, -1, 1, 8, -8, 1, -1, 0, 0, 0, 0, 0, 127, 0, 0, 0],
          [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0],
          [0, -1, 1, -2, 2, -3, 3, -4, 4, -5, 5, -6, 6, -7, 7, -8]]

# Each way to store a triangle, and what comes out.
TABLE = bytes([0x00, 0x10, 0x02] + [0] * 13)
TRIANGLES = [  # code, further bytes, corners
    (0xF0, b'', (0, 1, 2)),  # three unused ones. Edges from here on, the latest first: 0-2 2-1 1-0
    (0x00, b'', (0, 2, 3)),  # the latest edge and an unused vertex. Edges 0-3 3-2
    (0x13, b'', (3, 2, 0)),  # the edge before, and the fourth vertex back. Edges 3-0 0-2
    (0xF1, b'', (4, 3, 5)),  # the latest vertex in second place
    (0xF2, b'', (6, 7, 4)),  # the one before the latest in third place, when 5 and 4 are the latest
    (0x0F, bytes([40]), (6, 4, 20)),  # a number: 20 above 0
    (0x0D, b'', (6, 20, 19)),  # one less than that
    (0x0E, b'', (6, 19, 20)),  # and one more
    (0xFE, bytes([0x1F, 1]), (8, 20, 19)),  # unused, the latest, a number
    (0xFF, bytes([0xF0, 0x82, 0x01, 3]), (84, 82, 9)),  # two numbers, of which one takes two bytes, and an unused one
    (0xFE, bytes([0x00]), (0, 1, 2)),  # unused ones begin anew
]

# 5 and 100 above 0, by each of the baselines; 1 above the first, 1 below the second, 1 below the first.
INDICES = b'\xd1' + bytes([5 << 2, 0x91, 0x03, 1 << 2, 3, 2]) + bytes(4)


def decoded(data, count, stride, mode, kind, filter_name='NONE'):
    return np.frombuffer(meshopt_codec.decode(data, count, stride, mode, filter_name), kind)


def assert_prefixes_are_rejected(data, *how):
    for size in range(len(data)):
        with pytest.raises(ValueError):
            meshopt_codec.decode(data[:size], *how)


class TestAttributes:
    def test_each_way_to_store_deltas(self):
        expected = (np.cumsum(DELTAS, axis=1) + np.frombuffer(BASELINE, np.uint8)[:, None]) % 256
        assert (decoded(ATTRIBUTES, 16, 4, 'ATTRIBUTES', 'u1').reshape(16, 4) == expected.T).all()

    def test_what_fills_a_group_is_ignored(self):
        whole = decoded(ATTRIBUTES, 16, 4, 'ATTRIBUTES', 'u1')
        assert (decoded(ATTRIBUTES, 13, 4, 'ATTRIBUTES', 'u1') == whole[:52]).all()

    def test_blocks_continue_each_other(self):
        # 256 bytes in blocks of 32 elements: two groups, and one of a single element. The tail is as long as an element.
        first = bytes([0x0C]) + bytes([2] * 16) + bytes(255)  # byte 0 of the second group: steps of 1
        second = bytes([0x03, 1] + [0] * 15) + bytes(255)  # byte 0: one step of -1
        values = decoded(b'\xa0' + first + second + bytes(range(256)), 33, 256, 'ATTRIBUTES', 'u1').reshape(33, 256)
        assert values[:, 0].tolist() == [0] * 16 + list(range(1, 17)) + [15]
        assert (values[:, 1:] == np.arange(1, 256)).all()

    def test_groups_beyond_the_first_byte_of_a_header(self):
        values = np.random.default_rng(1).integers(0, 256, (1000, 12), np.uint8)
        assert meshopt_codec.decode(encoded_attributes(values), 1000, 12, 'ATTRIBUTES') == values.tobytes()

    def test_none(self):
        assert meshopt_codec.decode(b'\xa0' + bytes(32), 0, 4, 'ATTRIBUTES') == b''

    def test_cut_streams_are_rejected(self):
        assert_prefixes_are_rejected(ATTRIBUTES, 16, 4, 'ATTRIBUTES')

    @pytest.mark.parametrize('data, count, stride, message', [
        (b'\xa1' + ATTRIBUTES[1:], 16, 4, 'header 0xa1'), (ATTRIBUTES + b'\0', 16, 4, 'end at their tail'),
        (ATTRIBUTES, 65, 4, 'cut|tail'), (ATTRIBUTES, 1 << 60, 4, 'cut'), (ATTRIBUTES, -1, 4, 'count or stride'),
        (ATTRIBUTES, 16, 0, 'count or stride'), (ATTRIBUTES, 16.0, 4, 'count or stride'), (ATTRIBUTES, 16, 8, 'cut|tail'),
        (encoded_attributes(np.zeros((16, 6), np.uint8)), 16, 6, 'stride of 6'),
        (encoded_attributes(np.zeros((16, 260), np.uint8)), 16, 260, 'stride of 260')])
    def test_what_the_text_forbids_is_rejected(self, data, count, stride, message):
        with pytest.raises(ValueError, match=message):
            meshopt_codec.decode(data, count, stride, 'ATTRIBUTES')


def triangles_stream(rows=TRIANGLES, table=TABLE):
    return b'\xe1' + bytes(code for code, *_ in rows) + b''.join(more for _, more, *_ in rows) + table


class TestTriangles:
    def test_each_way_to_store_a_triangle(self):
        for stride, kind in ((2, '<u2'), (4, '<u4')):
            corners = decoded(triangles_stream(), 3 * len(TRIANGLES), stride, 'TRIANGLES', kind).reshape(-1, 3)
            assert [tuple(row) for row in corners.tolist()] == [row[2] for row in TRIANGLES]

    def test_fifos_have_sixteen_entries(self):
        # Edge 14, the oldest that a code can name, is the second of the first triangle: of four edges pushed later
        # by each pair of triangles, twelve are newer.
        rows = [(0xF0, b''), *[(0x00, b'')] * 6, (0xE0, b'')]
        corners = decoded(triangles_stream(rows), 24, 2, 'TRIANGLES', '<u2').reshape(-1, 3)
        assert corners[-1].tolist() == [1, 0, 9]
        with pytest.raises(ValueError, match='edge that was not there'):
            meshopt_codec.decode(triangles_stream([(0xF0, b''), (0x30, b'')]), 6, 2, 'TRIANGLES')

    def test_numbers(self):
        indices = [4000000000, 0, 77, 2147483648, 1, 4294967295]
        assert decoded(encoded_triangles(indices), 6, 4, 'TRIANGLES', '<u4').tolist() == indices
        with pytest.raises(ValueError, match='16 bits'):
            meshopt_codec.decode(encoded_triangles(indices), 6, 2, 'TRIANGLES')

    def test_cut_streams_are_rejected(self):
        assert_prefixes_are_rejected(triangles_stream(), 3 * len(TRIANGLES), 2, 'TRIANGLES')

    @pytest.mark.parametrize('data, count, stride, filter_name, message', [
        (b'\xe0' + triangles_stream()[1:], 33, 2, 'NONE', 'header 0xe0'),
        (triangles_stream(), 32, 2, 'NONE', '3 does not divide'), (triangles_stream(), 30, 2, 'NONE', 'end at their tail'),
        (triangles_stream(), 36, 2, 'NONE', ''), (triangles_stream(), 33, 1, 'NONE', 'stride of 1'),
        (triangles_stream(), 33, 2, 'EXPONENTIAL', 'filter EXPONENTIAL'),
        (triangles_stream() + bytes(17), 33, 2, 'NONE', 'end at their tail'),
        (triangles_stream(table=TABLE[:15] + b'\1'), 33, 2, 'NONE', 'table'),
        (triangles_stream(table=b'\xf0' + TABLE[1:]), 33, 2, 'NONE', 'table'),
        (triangles_stream(table=b'\x0f' + TABLE[1:]), 33, 2, 'NONE', 'table'),
        (triangles_stream([(0x00, b'')]), 3, 2, 'NONE', 'edge that was not there'),
        # The triangle's own first corner is no entry yet.
        (triangles_stream([(0xFE, b'\x10')]), 3, 2, 'NONE', 'vertex that was not there'),
        (triangles_stream([(0xFF, b'\xff' + b'\xff' * 5 + b'\0\0\0')]), 3, 4, 'NONE', 'more than 5 bytes'),
        (triangles_stream([(0xFF, b'\xff' + b'\xff' * 4 + b'\x1f\0\0')]), 3, 4, 'NONE', 'more than 32 bits')])
    def test_what_the_text_forbids_is_rejected(self, data, count, stride, filter_name, message):
        with pytest.raises(ValueError, match=message):
            meshopt_codec.decode(data, count, stride, 'TRIANGLES', filter_name)


class TestIndices:
    def test_two_baselines(self):
        assert decoded(INDICES, 5, 2, 'INDICES', '<u2').tolist() == [5, 100, 6, 99, 5]

    def test_cut_streams_are_rejected(self):
        assert_prefixes_are_rejected(INDICES, 5, 2, 'INDICES')

    @pytest.mark.parametrize('data, count, stride, message', [
        (b'\xd0' + INDICES[1:], 5, 2, 'header 0xd0'), (INDICES, 4, 2, 'end at their tail'), (INDICES, 6, 2, 'are cut'),
        (INDICES + b'\0', 5, 2, 'end at their tail'), (INDICES, 1 << 60, 2, 'are cut'),
        (INDICES[:-1] + b'\1', 5, 2, 'not zero'), (INDICES, 5, 3, 'stride of 3'),
        (b'\xd1' + bytes([2]) + bytes(4), 1, 2, '16 bits')])
    def test_what_the_text_forbids_is_rejected(self, data, count, stride, message):
        with pytest.raises(ValueError, match=message):
            meshopt_codec.decode(data, count, stride, 'INDICES')

    def test_other_modes_are_rejected(self):
        with pytest.raises(ValueError, match='no mode'):
            meshopt_codec.decode(INDICES, 5, 2, 'POINTS')


class TestFilters:
    def through(self, elements, kind, name):
        elements = np.array(elements)
        stride = elements[0].nbytes
        data = encoded_attributes(elements.view(np.uint8).reshape(-1, stride))
        return decoded(data, len(elements), stride, 'ATTRIBUTES', kind, name).reshape(len(elements), -1).tolist()

    def test_exponential(self):
        words = np.array([[0x00000001, 0xFF000003], [0x0A800000, 0xFEFFFFFF], [0x647FFFFF, 0x9C000001]], '<u4')
        assert self.through(words, '<f4', 'EXPONENTIAL') == [
            [1, 1.5], [-(2.0 ** 33), -0.25], [(2.0 ** 23 - 1) * 2.0 ** 100, 2.0 ** -100]]
        values = np.array([[0.125, -7.75, 100]])
        assert self.through(exponential_words(values, -3), '<f4', 'EXPONENTIAL') == values.tolist()

    def test_octahedral_bytes(self):
        # Of 8 and of 4 bits; the lower hemisphere; the last component is not touched.
        assert self.through(np.array([[0, 0, 127, -5], [127, 0, 127, 0], [0, -7, 7, 9], [7, 7, 7, 0], [42, 42, 127, 1],
                                      [-85, 85, 127, 2]], 'i1'), 'i1', 'OCTAHEDRAL') == [
            [0, 0, 127, -5], [127, 0, 0, 0], [0, -127, 0, 9], [0, 0, -127, 0], [73, 73, 74, 1], [-73, 73, -74, 2]]

    def test_octahedral_shorts(self):
        assert self.through(np.array([[511, 0, 1023, 77], [-32767, 0, 32767, -1]], '<i2'), '<i2', 'OCTAHEDRAL') == [
            [23147, 0, 23192, 77], [-32767, 0, 0, -1]]

    @pytest.mark.parametrize('elements, name, message', [
        (np.array([[0x65000001]], '<u4'), 'EXPONENTIAL', 'beyond 100'),
        (np.array([[0, 0, 100, 0]], 'i1'), 'OCTAHEDRAL', 'wrong one'), (np.array([[0, 0, 3, 0]], 'i1'), 'OCTAHEDRAL', 'wrong one'),
        (np.array([[0, 0, -1, 0]], 'i1'), 'OCTAHEDRAL', 'wrong one'), (np.array([[0, 8, 7, 0]], 'i1'), 'OCTAHEDRAL', 'above its one'),
        (np.array([[0, 0, 127, 0, 0, 0]], '<i2'), 'OCTAHEDRAL', 'stride of 12'),
        (np.array([[0] * 8], 'i1'), 'QUATERNION', 'not supported')])
    def test_what_the_text_forbids_is_rejected(self, elements, name, message):
        with pytest.raises(ValueError, match=message):
            self.through(elements, 'u1', name)


class TestData:
    """A game level, and what another program made of it: positions have 14 bits of the size of their
    node, normals went through the filter OCTAHEDRAL in 8."""

    @pytest.fixture(scope='class')
    def paths(self):
        data = os.environ.get('SIGHTCELL_DATA', '')
        paths = [os.path.join(data, *name) for name in (('meshopt', 'czest3ctf.meshopt.glb'), ('levels', 'czest3ctf.glb'))]
        if not data or not all(map(os.path.exists, paths)):
            pytest.skip('SIGHTCELL_DATA does not name a folder with the real scenes')
        return paths

    def test_polygons(self, paths):
        packed, original = map(read_draws, paths)
        assert [(d.node, d.primitive, len(d.local)) for d in packed] == [(d.node, d.primitive, len(d.local)) for d in original]
        for ours, others in zip(packed, original):
            partner = partners(ours.world(), others.world(), TOLERANCE * np.abs(ours.matrix[:3, :3]).max())
            assert (partner >= 0).all(), f'{(partner < 0).sum()} of {len(partner)} polygons of a draw'

    def test_normals(self, paths):
        (packed, matrix), (original, _) = map(first_mesh, paths)
        for (corners, ours), (others_corners, others) in zip(packed, original):
            # Polygons of two sides are in one place: the nearer normal counts.
            cosine, corners = np.full(len(ours), -1.0), apply(matrix, corners)
            for i, j in candidates(corners, others_corners, TOLERANCE * matrix[0, 0]):
                near = corner_distance(corners[i], others_corners[j]) < TOLERANCE * matrix[0, 0]
                np.maximum.at(cosine, i[near], (ours[i[near]] * others[j[near]]).sum(axis=1))
            assert cosine.min() > np.cos(np.radians(1))


def first_mesh(path):
    """Of each primitive: its polygons and their mean normals. Then the matrix of the node."""
    gltf = read_gltf(path)
    rows = []
    for primitive in gltf.document['meshes'][0]['primitives']:
        corners, attributes = gltf.corners(primitive), primitive['attributes']
        normals = gltf.floats(attributes['NORMAL'])[corners].sum(axis=1)
        rows.append((gltf.floats(attributes['POSITION'])[corners],
                     normals / np.linalg.norm(normals, axis=1, keepdims=True)))
    return rows, node_matrix(gltf.document['nodes'][0])
