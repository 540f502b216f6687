"""The reader of ordinary .glb and .gltf files: order of polygons, places, and what it rejects."""
import json
import os
import struct

import numpy as np
import pytest

import gltf_reader
from colonnade_scene import Glb, write_colonnade
from gltf_reader import read_draws, split_glb, world_triangles
from small_site import encoded_attributes, glb

POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 2, 0)]


def write(path, nodes, primitives, made, **more):
    document = {'asset': {'version': '2.0'}, 'scenes': [{'nodes': [0]}], 'nodes': nodes,
                'meshes': [{'primitives': primitives}], 'buffers': [{'byteLength': len(made.binary), 'uri': 'my%20bytes.bin'}],
                'bufferViews': made.views, 'accessors': made.accessors, **more}
    with open(os.path.join(os.path.dirname(path), 'my bytes.bin'), 'wb') as file:
        file.write(made.binary)
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(document, file)


def corners_of(path):
    """By polygon: the numbers of its corners among POINTS."""
    return [[POINTS.index(tuple(corner)) for corner in polygon] for polygon in world_triangles(path).tolist()]


@pytest.mark.parametrize('mode, indices, expected', [
    (4, [0, 1, 2, 2, 1, 3, 4], [[0, 1, 2], [2, 1, 3]]), (5, [0, 1, 2, 3, 4], [[0, 1, 2], [1, 3, 2], [2, 3, 4]]),
    (6, [0, 1, 2, 3], [[1, 2, 0], [2, 3, 0]]), (5, [0, 1], []), (1, [0, 1, 2], []), (None, None, [[0, 1, 2]])])
def test_modes(folder, mode, indices, expected):
    made, path = Glb(), os.path.join(folder, 'a.gltf')
    primitive = {'attributes': {'POSITION': made.add(POINTS, 'VEC3')}}
    if mode is not None:
        primitive.update(mode=mode, indices=made.add([indices], 'SCALAR', 'I'))
    write(path, [{'mesh': 0}], [primitive], made)
    assert corners_of(path) == expected


def test_order_and_places(folder):
    made, path = Glb(), os.path.join(folder, 'a.gltf')
    primitive = {'attributes': {'POSITION': made.add(POINTS[:3], 'VEC3')}}
    turns = {'TRANSLATION': made.add([(0, 0, 5), (0, 0, 6)], 'VEC3'), 'SCALE': made.add([(1, 1, 1), (2, 1, 1)], 'VEC3')}
    half = 0.5 ** 0.5
    nodes = [
        {'translation': [10, 0, 0], 'scale': [2, 2, 2], 'children': [2, 1]},
        {'mesh': 0, 'extensions': {'EXT_mesh_gpu_instancing': {'attributes': turns}}},
        {'mesh': 0, 'rotation': [0, 0, half, half], 'children': [3]},  # a quarter turn from x to y
        {'mesh': 0, 'matrix': [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1]}]
    write(path, nodes, [primitive, {**primitive, 'mode': 0}], made)
    draws = read_draws(path)
    assert [(d.node, d.primitive, d.instance, d.first, d.material) for d in draws] == [
        (2, 0, 0, 0, -1), (2, 1, 0, 1, -1), (3, 0, 0, 1, -1), (3, 1, 0, 2, -1), (1, 0, 0, 2, -1), (1, 0, 1, 3, -1),
        (1, 1, 0, 4, -1), (1, 1, 1, 4, -1)]
    np.testing.assert_allclose(world_triangles(path), [
        [[10, 0, 0], [10, 2, 0], [8, 0, 0]], [[10, 6, 0], [10, 8, 0], [8, 6, 0]],
        [[10, 0, 10], [12, 0, 10], [10, 2, 10]], [[10, 0, 12], [14, 0, 12], [10, 2, 12]]], atol=1e-12)


def test_normalized_components():
    made = gltf_reader.Gltf({
        'asset': {'version': '2.0'}, 'buffers': [{'byteLength': 12}], 'bufferViews': [{'buffer': 0, 'byteLength': 12}],
        'accessors': [{'bufferView': 0, 'componentType': kind, 'count': 2, 'type': 'VEC3', 'normalized': True}
                      for kind in (5120, 5121, 5122, 5123)]}, struct.pack('<bbbbbbBBBBBB', -128, -127, 0, 127, 1, -1, *range(6)))
    assert made.floats(0).tolist() == [[-1, -1, 0], [1, 1 / 127, -1 / 127]]
    assert made.floats(1)[0].tolist() == [128 / 255, 129 / 255, 0]
    assert made.floats(2)[0, 1] == 127 * 256 / 32767 and made.floats(3)[0, 0] == (128 + 129 * 256) / 65535


def test_instances_of_a_real_file(folder):
    path = os.path.join(folder, 'hall.glb')
    write_colonnade(path)
    draws = read_draws(path)
    assert [draw.instance for draw in draws] == [0, *range(12), *[0] * 7]
    assert draws[-1].first + len(draws[-1].local) == len(world_triangles(path)) == 1104


@pytest.mark.parametrize('change, message', [
    (lambda data: data[:19], 'no .glb'), (lambda data: b'GLTF' + data[4:], 'no .glb'),
    (lambda data: data[:4] + b'\1' + data[5:], 'version 1'), (lambda data: data + bytes(4), 'has'),
    (lambda data: data[:16] + b'BIN\0' + data[20:], 'first chunk'),
    (lambda data: data[:12] + struct.pack('<I', 4000) + data[16:], 'first chunk'),
    (lambda data: resized(data[:-16] + struct.pack('<I', 12) + data[-12:]), 'is cut'),
    (lambda data: resized(data + bytes(4)), 'is cut'),
    (lambda data: resized(data + data[-16:]), 'not the second one'),
    (lambda data: resized(data[:20] + b'[]' + b' ' * (len(data) - 38) + data[-16:]), 'no object')])
def test_broken_containers(change, message):
    data = glb({'asset': {'version': '2.0'}}, bytes(8))
    assert split_glb(data)[1] == bytes(8)
    with pytest.raises(ValueError, match=message):
        split_glb(change(data))


def resized(data):
    return data[:8] + struct.pack('<I', len(data)) + data[12:]


@pytest.mark.parametrize('kind, change, message', [
    ('buffers', {'byteLength': 13}, 'is a chunk of'), ('buffers', {'byteLength': 8}, 'is a chunk of'),
    ('buffers', {'byteLength': -12}, 'byteLength of a buffer is -12'), ('buffers', {'uri': 'elsewhere.bin'}, 'another file'),
    ('buffers', {'uri': 'data:,AAAA'}, '3 of 12 bytes'), ('bufferViews', {'byteOffset': 1}, 'leaves its buffer'),
    ('bufferViews', {'byteLength': 13}, 'leaves its buffer'), ('bufferViews', {'buffer': 1}, 'no 1'),
    ('bufferViews', {'byteStride': 2}, 'not aligned'), ('accessors', {'count': 2}, 'leaves its view'),
    ('accessors', {'byteOffset': 4}, 'leaves its view'), ('accessors', {'componentType': 5124}, 'malformed'),
    ('accessors', {'type': 'MAT9'}, 'malformed'), ('accessors', {'bufferView': -1}, 'no -1'),
    ('accessors', {'count': True}, 'is True'), ('accessors', {'sparse': {}}, 'sparse')])
def test_broken_references(kind, change, message):
    document = {
        'asset': {'version': '2.0'}, 'buffers': [{'byteLength': 12}], 'bufferViews': [{'buffer': 0, 'byteLength': 12}],
        'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 1, 'type': 'VEC3'}]}
    read = gltf_reader.malformed_is_value_error(lambda: gltf_reader.Gltf(document, bytes(12)).floats(0))
    assert read().tolist() == [[0, 0, 0]]
    document[kind][0].update(change)
    with pytest.raises(ValueError, match=message):
        read()


def test_a_buffer_without_bytes():
    with pytest.raises(ValueError, match='has no bytes'):
        gltf_reader.Gltf({'asset': {'version': '2.0'}, 'buffers': [{'byteLength': 4}]}).buffer_of(0)


@pytest.mark.parametrize('view, change, message', [
    ({'byteLength': 15}, {}, 'length of its elements'), ({'byteStride': 8}, {}, 'another stride'), ({'byteOffset': 4}, {}, 'leaves'),
    ({}, {'count': 3}, 'length of its elements'), ({}, {'byteLength': 102}, 'leaves its buffer'), ({}, {'mode': 'NONE'}, 'no mode')])
def test_broken_compressed_views(view, change, message):
    data = encoded_attributes(np.zeros((4, 4), np.uint8))
    packed = {'buffer': 0, 'byteLength': len(data), 'byteStride': 4, 'count': 4, 'mode': 'ATTRIBUTES'}
    whole_view = {'buffer': 1, 'byteLength': 16, 'byteStride': 4}
    document = {'asset': {'version': '2.0'}, 'buffers': [{'byteLength': len(data)}, {'byteLength': 16}]}
    for changes, expected in (({}, None), (view, message)):
        extension = {**packed, **(change if expected else {})}
        document['bufferViews'] = [{**whole_view, **changes, 'extensions': {'EXT_meshopt_compression': extension}}]
        gltf = gltf_reader.Gltf(document, data)
        if expected is None:
            assert gltf.view_of(0) == bytes(16)
        else:
            with pytest.raises(ValueError, match=expected):
                gltf.view_of(0)
