"""The reader of streamed scenes, on one that small_site.py writes: two polygons, shown twice."""
import os
import random
import struct
import zlib

import numpy as np
import pytest

import streamed_scene
from harness import read
from small_site import (CORNERS, IMAGES, MATRICES, TRIANGLES, SmallSite, box_columns, deltas, exponential_words, floats, gaps,
                        packed_chunk, packed_front, varints)
from streamed_scene import LEAST, cell_at, hash_of, open_site, rebuild


@pytest.fixture
def site():
    return SmallSite()


class TestReader:
    def test_contents(self, site, folder):
        site.write(folder)
        found = open_site(folder)
        front = found.front
        assert front.fingerprint == '000102030405060708090a0b0c0d0e0f'
        assert (front.polygons, front.geometry_polygons.tolist(), front.draw_geometry.tolist()) == (4, [2], [0, 0])
        assert (front.draw_material.tolist(), front.draw_object.tolist()) == ([0, -1], [-1, 0])
        assert (front.draw_node.tolist(), front.draw_primitive.tolist()) == ([3, 4], [2, 2])
        assert (front.draw_matrices == MATRICES).all()
        assert np.allclose(front.page_boxes, [[[0, 0, -3], [8, 3, 8]]])
        assert [(file.width, file.height, file.type) for file in front.images[0]] == [(4, 0, 'webp'), (8, 8, 'png')]
        cells = found.cells()
        assert [cells[i].draws.tolist() for i in range(3)] == [[0, 1], [], [1]]
        assert [cells[i].pages.tolist() for i in range(3)] == [[0], [], [0]]
        assert [cells[i].page_weights().tolist() for i in range(3)] == [[1], [], [1]]
        assert (cells[0].images.tolist(), cells[0].image_codes.tolist()) == ([0], [LEAST])
        part, = found.page(0)
        assert (part.corners() == CORNERS[np.reshape(TRIANGLES, (2, 3))]).all()
        assert part.attributes['NORMAL'].tolist() == [[0, 0, 1]] * 4
        assert (part.attributes['TEXCOORD_0'] == CORNERS[:, :2]).all() and (part.attributes['COLOR_0'] == 1).all()

    def test_rebuild(self, site, folder):
        site.write(folder)
        draws, world = rebuild(open_site(folder))
        assert draws.tolist() == [0, 0, 1, 1]
        assert world[:2].reshape(6, 3).tolist() == [[CORNERS[i][0] + 5, CORNERS[i][1], -3] for i in TRIANGLES]
        assert world[2:].reshape(6, 3).tolist() == [[-1, 2 * CORNERS[i][1], 4 - 2 * CORNERS[i][0]] for i in TRIANGLES]

    @pytest.mark.parametrize('point, number', [
        ((1, 1, 1), 0), ((2, 0, 2), 2), ((2.5, 1, 3), 2), ((3, 1, 3), 1), ((4, 1, 3), 1), ((5, 1, 3), 0), ((0, 0, 0), 0),
        ((8, 1, 1), None), ((1, 2, 1), None), ((-0.01, 1, 1), None)])
    def test_cell_at(self, site, folder, point, number):
        site.write(folder)
        cell = cell_at(open_site(folder), point)
        assert (cell and cell.number) == number

    def test_columns_of_many_numbers(self):
        numbers = [0, 1, 127, 128, 16383, 16384, (1 << 32) - 1, 5]
        columns = streamed_scene.Columns(varints(*numbers) + deltas(*numbers[:6]) + gaps(0, 1, 9) + gaps(3), 'columns')
        assert columns.varints(8).tolist() == numbers
        assert columns.deltas(6).tolist() == numbers[:6]
        assert [one.tolist() for one in columns.gaps([0, 3, 0, 1], 10, 'number')] == [[], [0, 1, 9], [], [3]]
        columns.end()

    def test_columns_that_end_early(self):
        for payload, method in ((b'\5', lambda columns: columns.bytes(2)), (b'\x80', lambda columns: columns.varint()),
                                (b'\1\x80\x80', lambda columns: columns.varints(2)), (bytes(7), lambda columns: columns.floats(2)),
                                (bytes(9), lambda columns: columns.hashes(2)), (b'\1', lambda columns: columns.gaps([2], 9, ''))):
            with pytest.raises(ValueError, match='columns: the payload ends early'):
                method(streamed_scene.Columns(payload, 'columns'))

    @pytest.mark.parametrize('field, value, message', [
        ('counts', varints(5, 1, 2, 1, 1, 2, 1, 3), 'have not 5 polygons'),
        ('counts', varints(4, 1, 2, 1, 1, 2, 1, 4), 'have not 4 cells'),
        ('counts', varints(4, 1, 2, 1, 2, 2, 1, 3), 'has not 2 images'),
        ('counts', varints(4, (1 << 32) - 1, 2, 1, 1, 2, 1, 3), 'ends early'),
        ('box', floats([9, 0, -3, 8, 3, 8]), 'box of the scene'), ('box', floats([np.nan, 0, -3, 8, 3, 8]), 'not finite'),
        ('geometries', deltas(0, 1), 'geometry is negative or not below 1'),
        ('geometries', deltas(0, -1), 'geometry is negative or not below 1'),
        ('materials', varints(2, 0), 'material is not below 2'), ('flags', varints(0, 8), 'flag is not below'),
        ('flags', varints(0, 6), 'in every cell and in none'),
        ('nodes', b'\x06\xff\xff\xff\xff\x1f', 'more than 32 bits'),
        ('nodes', b'\x06\x80\x80\x80\x80\x80\0', 'more than 5 bytes'),
        ('matrices', floats(*[[np.inf, 0]] * 12), 'not finite'),
        ('page boxes', bytes([1, 0, 0, 0, 255, 255]), 'box of a page'), ('file types', bytes([2, 5]), 'type of an image'),
        ('file counts', varints(1), 'have not 2 files'), ('heights', varints(9, 8), 'ascending size'),
        ('chunk cells', varints(2), 'have not 3 cells'), ('chunk boxes', box_columns([[0, 0, 0], [8, -1, 8]]), 'a box has'),
        ('everywhere', varints(1) + gaps(1), 'page is not below 1'), ('everywhere', varints(2) + gaps(0, 1), 'not below 2'),
        ('images everywhere', varints(1) + gaps(1), 'image is not below 1'), ('images everywhere', varints(0) + b'\0', 'behind the payload')])
    def test_fields_of_the_front(self, site, field, value, message):
        if field == 'heights':
            site.front['widths'] = varints(9, 8)
        site.front[field] = value
        with pytest.raises(ValueError, match=message):
            streamed_scene.front(site.contents()[0])

    def test_pages_that_are_there_twice(self, site):
        site.front.update({'counts': varints(4, 1, 2, 2, 1, 2, 1, 3), 'page bytes': varints(9, 9), 'page hashes': bytes(16),
                           'page boxes': bytes(12)})
        with pytest.raises(ValueError, match='a page is there twice'):
            streamed_scene.front(site.contents()[0])

    @pytest.mark.parametrize('change', [
        {'images': [{'uri': 'a.png'}]}, {'images': [{'bufferView': 0}]}, {'images': []}, {'asset': {'version': '3.0'}},
        {'asset': None}, {'meshes': []}, {'images': 3}])
    def test_json_of_the_front(self, site, change):
        streamed_scene.front(site.contents()[0])
        site.materials.update(change)
        with pytest.raises(ValueError):
            streamed_scene.front(site.contents()[0])

    def test_header_of_the_front(self, site):
        data = site.contents()[0]
        for wrong, message in ((b'SIGHTFRU' + data[8:], 'no scene.front'), (data[:8] + b'\2' + data[9:], 'version 2'),
                               (data[:12] + b'\xff' + data[13:], 'has not'), (data + b'\0', 'zlib'),
                               (data[:40] + bytes([data[40] ^ 1]) + data[41:], '')):
            with pytest.raises(ValueError, match=message):
                streamed_scene.front(wrong)

    @pytest.mark.parametrize('field, value, message', [
        ('count', varints(0), 'no cells'), ('count', varints(4), 'count of cells is not below 4'),
        ('numbers', deltas(0, 2, 3), 'cell is negative or not below 3'), ('numbers', deltas(0, 2, 2), 'twice'),
        ('boxes', box_columns(*[[[0, 0, 0], [1, 1, 0]]] * 3), 'without volume'),
        ('weights', floats([1, 2, -1]), 'negative weight'),
        ('weights', floats([1, 2, np.inf]), 'not finite'),
        ('page counts', varints(1, 2, 0), 'count of pages is not below 2'),
        ('page counts', varints(1, 0, 0), ''), ('pages', gaps(0) + gaps(1), 'page is not below 1'),
        ('runs', varints(0, 2) + varints(1, 0), 'draw is not below 2'),
        ('runs', varints(0, 1) + varints(2, 0), 'draw is not below 2'),
        ('images', gaps(1), 'image is not below 1'), ('image weights', bytes(2), 'behind the payload')])
    def test_fields_of_a_chunk(self, site, field, value, message):
        front = streamed_scene.front(site.contents()[0])
        site.chunk[field] = value
        with pytest.raises(ValueError, match=message):
            streamed_scene.cell_chunk(site.contents()[1], front)

    def test_draws_that_no_cell_lists(self, site):
        for flag, listed in ((1, True), (2, False), (4, False)):
            site.front['flags'] = varints(flag, 0)
            front, chunk, _ = site.contents()
            if listed:
                streamed_scene.cell_chunk(chunk, streamed_scene.front(front))
            else:
                with pytest.raises(ValueError, match='no cell lists'):
                    streamed_scene.cell_chunk(chunk, streamed_scene.front(front))

    def test_several_cells_take_16_kb(self, site):
        front = streamed_scene.front(site.contents()[0])
        payload = site.chunk_payload()
        big = struct.pack('<I', len(payload)) + zlib.compress(payload, 0)
        streamed_scene.cell_chunk(big, front)
        # Stored blocks of no bytes make the stream longer.
        stream = big[4:6] + b'\0\0\0\xff\xff' * 3300 + big[6:]
        with pytest.raises(ValueError, match='several cells'):
            streamed_scene.cell_chunk(big[:4] + stream, front)

    @pytest.mark.parametrize('where, change, message', [
        ('primitive', {'material': 0}, 'material'), ('primitive', {'mode': 5}, 'without triangles'),
        ('primitive', {'extras': {'sightcell': [1, 2]}}, 'no geometry 1'),
        ('primitive', {'extras': {'sightcell': [-1, 2]}}, 'is -1'),
        ('primitive', {'extras': {'sightcell': [0, 1]}}, '3 of 6 indices'),
        ('primitive', {'extras': {'sightcell': [0, 2.0]}}, 'is 2.0'),
        ('primitive', {'extras': {'sightcell': [0, 3]}}, 'more polygons'),
        ('primitive', {'extras': {'sightcell': [0]}}, 'pairs'),
        ('primitive', {'extras': {'sightcell': []}}, 'pairs'), ('primitive', {'extras': {}}, 'malformed'),
        ('primitive', {'extras': {'sightcell': [0, 0]}}, 'no polygons'),
        ('primitive', {'attributes': {'POSITION': 0, '_HEAT': 1}}, '_HEAT'),
        ('primitive', {'attributes': {'NORMAL': 1}}, 'no POSITION'),
        ('primitive', {'attributes': {'POSITION': 5}}, 'accessors has no 5'),
        ('primitive', {'attributes': {'POSITION': -1}}, 'no -1'),
        ('primitive', {'attributes': {'POSITION': 0, 'NORMAL': 0}}, 'type of NORMAL'),
        ('primitive', {'indices': 7}, 'accessors has no 7'),
        ('document', {'nodes': [{'mesh': 0, 'translation': [1, 0, 0]}]}, 'transform'),
        ('document', {'nodes': []}, 'one node'), ('document', {'meshes': [{'primitives': []}] * 2}, 'not one mesh'),
        ('document', {'meshes': [{'primitives': []}]}, 'no polygons'),
        ('document', {'nodes': [{'mesh': 0}, {'mesh': 0}]}, 'one node'), ('document', {'asset': {'version': '1.0'}}, '2.0'),
        ('document', {'extensionsUsed': ['KHR_mesh_quantization']}, 'meshopt'),
        ('document', {'extensionsRequired': ['EXT_meshopt_compression']}, 'quantization')])
    def test_json_of_a_page(self, site, where, change, message):
        front = streamed_scene.front(site.contents()[0])
        getattr(site, where).update(change)
        with pytest.raises(ValueError, match=message):
            streamed_scene.page(site.page_bytes(), front)

    @pytest.mark.parametrize('number, change, message', [
        (0, {'max': [2, 1, 0]}, 'min or max'), (0, {'min': None}, ''), (1, {'normalized': False}, 'NORMAL and normalized'),
        (2, {'bufferView': 0, 'type': 'VEC2', 'componentType': 5123}, 'type of TEXCOORD_0'),
        (3, {'count': 3}, 'unequal length'), (3, {'count': 0}, 'is empty'),
        (3, {'count': 5}, 'leaves its view'), (4, {'count': 3}, '6 of 3 indices'), (4, {'bufferView': 9}, 'no 9'),
        (2, {'bufferView': 3, 'type': 'VEC2'}, 'filter EXPONENTIAL'), (0, {'byteOffset': 2}, 'aligned')])
    def test_accessors_of_a_page(self, site, number, change, message):
        front = streamed_scene.front(site.contents()[0])
        site.accessors[number].update(change)
        with pytest.raises(ValueError, match=message):
            streamed_scene.page(site.page_bytes(), front)

    @pytest.mark.parametrize('number, elements, filter_name, message', [
        (4, np.array([0, 1, 2, 0, 2, 4], '<u2').view(np.uint8).reshape(6, 2), 'NONE', 'beyond the last vertex'),
        (0, exponential_words(CORNERS, -4).view(np.uint8).reshape(4, 12), 'NONE', 'filter EXPONENTIAL'),
        (2, (exponential_words(CORNERS[:, :2], -4) & 0xFFFFFF | 120 << 24).view(np.uint8).reshape(4, 8), 'EXPONENTIAL', 'beyond 100')])
    def test_views_of_a_page(self, site, number, elements, filter_name, message):
        front = streamed_scene.front(site.contents()[0])
        site.views[number] = elements, site.views[number][1], filter_name
        with pytest.raises(ValueError, match=message):
            streamed_scene.page(site.page_bytes(), front)

    def test_cut_files_are_rejected(self, site):
        front, chunk, page = site.contents()
        read_front = streamed_scene.front(front)
        for data, reader in ((front, lambda part: streamed_scene.front(part)),
                             (chunk, lambda part: streamed_scene.cell_chunk(part, read_front)),
                             (page, lambda part: streamed_scene.page(part, read_front))):
            reader(data)
            for size in [*range(len(data)), len(data) + 1]:
                with pytest.raises(ValueError):
                    reader((data + b'\0')[:size])

    def test_cut_payloads_are_rejected(self, site):
        front, chunk, page = site.contents()
        read_front = streamed_scene.front(front)
        for payload, reader in ((site.front_payload(page, chunk), lambda part: streamed_scene.front(packed_front(part))),
                                (site.chunk_payload(), lambda part: streamed_scene.cell_chunk(packed_chunk(part), read_front))):
            reader(payload)
            for size in [*range(len(payload)), len(payload) + 1]:
                with pytest.raises(ValueError):
                    reader((payload + b'\0')[:size])

    def test_damage_is_a_value_error(self, site):
        front, chunk, page = site.contents()
        read_front, draw = streamed_scene.front(front), random.Random(1)
        for data, reader in ((site.front_payload(page, chunk), lambda part: streamed_scene.front(packed_front(part))),
                             (site.chunk_payload(), lambda part: streamed_scene.cell_chunk(packed_chunk(part), read_front)),
                             (page, lambda part: streamed_scene.page(part, read_front))):
            rejected = 0
            for _ in range(500):
                damaged = bytearray(data)
                damaged[draw.randrange(len(data))] = draw.randrange(256)
                try:
                    reader(bytes(damaged))
                except ValueError:
                    rejected += 1
            assert rejected > 100

    def test_files_that_are_missing_or_changed(self, site, folder):
        for number in (1, 2):
            for change, message in ((None, 'is missing'), (lambda data: data + b'\0', 'bytes instead of'),
                                    (lambda data: data[:-1] + bytes([data[-1] ^ 1]), 'another hash')):
                paths = site.write(folder)
                open_site(folder)
                data = read(paths[number])
                os.remove(paths[number])
                if change is not None:
                    with open(paths[number], 'wb') as file:
                        file.write(change(data))
                with pytest.raises(ValueError, match=message):
                    open_site(folder)

    def test_images_that_are_changed(self, site, folder):
        site.write(folder)
        name, = (name for name in os.listdir(os.path.join(folder, 'images')) if name.endswith('.png'))
        with open(os.path.join(folder, 'images', name), 'wb') as file:
            file.write(IMAGES[1][::-1])
        with pytest.raises(ValueError, match='another hash'):
            open_site(folder)

    @pytest.mark.parametrize('field, value, message', [
        ('chunk boxes', box_columns([[0, 0, 0], [8, 2, 9]]), 'another box'), ('chunk cells', varints(4), 'as many cells')])
    def test_fronts_that_disagree_with_their_chunks(self, site, folder, field, value, message):
        if field == 'chunk cells':
            site.front['counts'] = varints(4, 1, 2, 1, 1, 2, 1, 4)
        site.front[field] = value
        site.write(folder)
        with pytest.raises(ValueError, match=message):
            open_site(folder).cells()

    def test_cells_in_two_chunks(self, site, folder):
        site.front['counts'] = varints(4, 1, 2, 1, 1, 2, 2, 6)
        one, other = site.contents()[1], struct.pack('<I', len(site.chunk_payload())) + zlib.compress(site.chunk_payload(), 0)
        site.front.update({
            'chunk bytes': varints(len(one), len(other)), 'chunk cells': varints(3, 3),
            'chunk hashes': bytes.fromhex(hash_of(one) + hash_of(other)), 'chunk boxes': box_columns(*[site.cells[0]] * 2)})
        site.write(folder)
        with open(os.path.join(folder, 'cells', hash_of(other) + '.cells'), 'wb') as file:
            file.write(other)
        with pytest.raises(ValueError, match='in two chunks'):
            open_site(folder).cells()

    def test_pages_with_a_polygon_twice(self, site, folder):
        site.document['meshes'] = [{'primitives': [site.primitive] * 2}]
        site.write(folder)
        with pytest.raises(ValueError, match='too many polygons of geometry 0'):
            rebuild(open_site(folder))
