"""The reader of ordinary .glb and .gltf files: order of polygons, places, and what it rejects."""
import json
import os
import struct

import numpy as np
import pytest

import gltf_reader
from colonnade_scene import Glb, write_colonnade
from gltf_reader import read_draws, split_glb, world_triangles
from small_site import glb

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


@pytest.mark.parametrize('change', [
    lambda data: data[:19], lambda data: b'GLTF' + data[4:], lambda data: data[:4] + b'\1' + data[5:], lambda data: data + bytes(4),
    lambda data: data[:8] + struct.pack('<I', len(data) + 4) + data[12:], lambda data: data[:16] + b'BIN\0' + data[20:],
    lambda data: data[:12] + struct.pack('<I', 4000) + data[16:], lambda data: data[:-1]])
def test_broken_containers(change):
    data = glb({'asset': {'version': '2.0'}}, bytes(8))
    assert split_glb(data)[1] == bytes(8)
    with pytest.raises(ValueError):
        split_glb(change(data))


@pytest.mark.parametrize('kind, number, change', [
    ('buffers', 0, {'byteLength': 13}), ('buffers', 0, {'byteLength': 8}), ('buffers', 0, {'byteLength': -12}),
    ('bufferViews', 0, {'byteOffset': 1}), ('bufferViews', 0, {'byteLength': 13}), ('bufferViews', 0, {'buffer': 1}),
    ('bufferViews', 0, {'byteStride': 2}), ('accessors', 0, {'count': 2}), ('accessors', 0, {'byteOffset': 4}),
    ('accessors', 0, {'componentType': 5124}), ('accessors', 0, {'type': 'MAT9'}), ('accessors', 0, {'bufferView': -1}),
    ('accessors', 0, {'count': True}), ('accessors', 0, {'sparse': {}}), ('buffers', 0, {'uri': 'elsewhere.bin'})])
def test_broken_references(kind, number, change):
    document = {
        'asset': {'version': '2.0'}, 'buffers': [{'byteLength': 12}], 'bufferViews': [{'buffer': 0, 'byteLength': 12}],
        'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 1, 'type': 'VEC3'}]}
    read = gltf_reader.malformed_is_value_error(lambda: gltf_reader.Gltf(document, bytes(12)).floats(0))
    assert read().tolist() == [[0, 0, 0]]
    document[kind][number].update(change)
    with pytest.raises(ValueError):
        read()
