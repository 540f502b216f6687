"""Reads .glb and .gltf files, written from the text of glTF 2.0 alone: accessors as arrays, and the polygons of a scene in
the order of source ids (docs/glossary.md).

Knows EXT_meshopt_compression, KHR_mesh_quantization and EXT_mesh_gpu_instancing. Sparse accessors and Draco are not
supported. What the texts forbid is a ValueError.
"""
import base64
import dataclasses
import functools
import json
import os
import struct
import urllib.parse

import numpy as np

import meshopt_codec
from meshopt_codec import need

COMPONENTS = {5120: 'i1', 5121: 'u1', 5122: '<i2', 5123: '<u2', 5125: '<u4', 5126: '<f4'}
WIDTHS = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3, 'VEC4': 4}
TRIANGLES, STRIP, FAN = 4, 5, 6
MESHOPT = 'EXT_meshopt_compression'


def malformed_is_value_error(function):
    """JSON that lacks something, or has another type in its place, is found where it is used."""
    @functools.wraps(function)
    def wrapped(*arguments, **more):
        try:
            return function(*arguments, **more)
        except (KeyError, TypeError, AttributeError, RecursionError) as error:
            raise ValueError(f'{function.__name__}: malformed: {type(error).__name__} {error}') from error
    return wrapped


def item(document, kind, number):
    """An element of a list of the document, by its number."""
    rows = document.get(kind, [])
    need(isinstance(number, int) and 0 <= number < len(rows), f'{kind} has no {number}')
    return rows[number]


def whole(value, what):
    need(isinstance(value, int) and not isinstance(value, bool) and value >= 0, f'{what} is {value!r}')
    return value


def split_glb(data):
    """The JSON and the bytes of the binary chunk."""
    need(len(data) >= 20 and data[:4] == b'glTF', 'no .glb')
    version, length, size, kind = struct.unpack_from('<IIII', data, 4)
    need(version == 2, f'version {version} of .glb')
    need(length == len(data), f'a .glb of {length} bytes has {len(data)}')
    need(kind == 0x4E4F534A and size % 4 == 0 and 20 + size <= length, 'the first chunk of a .glb is not whole JSON')
    document = json.loads(bytes(data[20:20 + size]).decode())
    need(isinstance(document, dict), 'the JSON of a .glb is no object')
    at, binary = 20 + size, None
    while at < length:
        need(at + 8 <= length, 'a chunk of a .glb is cut')
        size, kind = struct.unpack_from('<II', data, at)
        need(size % 4 == 0 and at + 8 + size <= length, 'a chunk of a .glb is cut')
        if kind == 0x004E4942:
            need(at == 20 + struct.unpack_from('<I', data, 12)[0], 'the binary chunk is not the second one')
            binary = data[at + 8:at + 8 + size]
        at += 8 + size
    return document, binary


class Gltf:
    """A document with its buffers. Buffer views are decoded once."""

    @malformed_is_value_error
    def __init__(self, document, binary=None, folder=None):
        self.document, self.binary, self.folder = document, binary, folder
        need(document['asset']['version'] == '2.0', 'no glTF 2.0')
        self.view_of = functools.lru_cache(maxsize=None)(self.read_view)
        self.buffer_of = functools.lru_cache(maxsize=None)(self.read_buffer)

    def read_buffer(self, number):
        buffer = item(self.document, 'buffers', number)
        length = whole(buffer['byteLength'], 'byteLength of a buffer')
        uri = buffer.get('uri')
        if uri is None:
            need(number == 0 and self.binary is not None, f'buffer {number} has no bytes')
            data = self.binary
            need(len(data) - length in range(4), f'buffer 0 of {length} bytes is a chunk of {len(data)}')
        elif uri.startswith('data:'):
            data = base64.b64decode(uri.partition(',')[2], validate=True)
        else:
            need(self.folder is not None, 'a buffer in another file')
            with open(os.path.join(self.folder, urllib.parse.unquote(uri)), 'rb') as file:
                data = file.read()
        need(len(data) >= length, f'buffer {number} has {len(data)} of {length} bytes')
        return data[:length]

    def slice_of(self, place):
        first, length = whole(place.get('byteOffset', 0), 'byteOffset'), whole(place['byteLength'], 'byteLength')
        data = self.buffer_of(place['buffer'])
        need(first + length <= len(data), 'a view leaves its buffer')
        return data[first:first + length]

    def read_view(self, number):
        view = item(self.document, 'bufferViews', number)
        packed = view.get('extensions', {}).get(MESHOPT)
        if packed is None:
            return self.slice_of(view)
        count, stride = whole(packed['count'], 'count'), whole(packed['byteStride'], 'byteStride')
        need(view['byteLength'] == count * stride, 'a compressed view has not the length of its elements')
        need(view.get('byteStride', stride) == stride, 'a compressed view has another stride than its elements')
        uncompressed = item(self.document, 'buffers', view['buffer'])
        need(whole(view.get('byteOffset', 0), 'byteOffset') + view['byteLength'] <= uncompressed['byteLength'],
             'a compressed view leaves its buffer')
        return meshopt_codec.decode(self.slice_of(packed), count, stride, packed['mode'], packed.get('filter', 'NONE'))

    def accessor(self, number):
        """The elements as they are stored, [count, components]."""
        accessor = item(self.document, 'accessors', number)
        need('sparse' not in accessor, 'sparse accessors are not supported')
        kind, width = np.dtype(COMPONENTS[accessor['componentType']]), WIDTHS[accessor['type']]
        count = whole(accessor['count'], 'count of an accessor')
        view = item(self.document, 'bufferViews', accessor['bufferView'])
        first, size = whole(accessor.get('byteOffset', 0), 'byteOffset'), kind.itemsize * width
        stride = whole(view.get('byteStride', size), 'byteStride')
        need(stride >= size and first % kind.itemsize == 0 and stride % kind.itemsize == 0, 'an accessor is not aligned')
        data = self.view_of(accessor['bufferView'])
        need(count == 0 or first + stride * (count - 1) + size <= len(data), f'accessor {number} leaves its view')
        if count == 0:
            return np.zeros((0, width), kind)
        return np.ndarray((count, width), kind, bytes(data), first, (stride, kind.itemsize))

    def floats(self, number):
        values, accessor = self.accessor(number), item(self.document, 'accessors', number)
        if values.dtype.kind == 'f' or not accessor.get('normalized', False):
            return values.astype('f8')
        return np.maximum(values.astype('f8') / np.iinfo(values.dtype).max, -1)

    def corners(self, primitive):
        """Vertices of each polygon, [n, 3]."""
        mode = primitive.get('mode', TRIANGLES)
        if mode not in (TRIANGLES, STRIP, FAN):
            return np.zeros((0, 3), 'i8')
        vertices = item(self.document, 'accessors', primitive['attributes']['POSITION'])['count']
        indices = np.arange(vertices)
        if 'indices' in primitive:
            indices = self.accessor(primitive['indices'])[:, 0].astype('i8')
        need(not len(indices) or indices.max() < vertices, 'an index is beyond the last vertex')
        if mode == TRIANGLES:
            return indices[:len(indices) // 3 * 3].reshape(-1, 3)
        first = np.arange(max(len(indices) - 2, 0))
        if mode == STRIP:
            return indices[np.stack([first, first + 1 + first % 2, first + 2 - first % 2], 1)]
        return indices[np.stack([first + 1, first + 2, 0 * first], 1)]


def read_gltf(path):
    with open(path, 'rb') as file:
        data = file.read()
    folder = os.path.dirname(os.path.abspath(path))
    if data[:4] == b'glTF':
        return Gltf(*split_glb(data), folder)
    return Gltf(json.loads(data), None, folder)


def from_trs(translation=(0, 0, 0), rotation=(0, 0, 0, 1), scale=(1, 1, 1)):
    x, y, z, w = np.asarray(rotation, 'f8')  # of length 1, says glTF; quantized ones are nearly so
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                               [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                               [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]) * scale
    matrix[:3, 3] = translation
    return matrix


def node_matrix(node):
    if 'matrix' in node:
        return np.array(node['matrix'], 'f8').reshape(4, 4).T
    return from_trs(**{key: node[key] for key in ('translation', 'rotation', 'scale') if key in node})


def instance_matrices(gltf, node):
    attributes = node.get('extensions', {}).get('EXT_mesh_gpu_instancing', {}).get('attributes')
    if attributes is None:
        return [np.eye(4)]
    columns = {key.lower(): gltf.floats(number) for key, number in attributes.items()
               if key in ('TRANSLATION', 'ROTATION', 'SCALE')}
    count = gltf.document['accessors'][next(iter(attributes.values()))]['count']
    return [from_trs(**{key: rows[i] for key, rows in columns.items()}) for i in range(count)]


def apply(matrix, points):
    """points: [..., 3]; matrix: the upper three rows, at least."""
    return points @ np.asarray(matrix, 'f8')[:3, :3].T + np.asarray(matrix, 'f8')[:3, 3]


@dataclasses.dataclass
class Draw:
    node: int
    mesh: int
    primitive: int
    instance: int
    material: int  # -1: the default
    matrix: np.ndarray  # [4, 4]
    local: np.ndarray  # [n, 3, 3] corners of the polygons in the space of the mesh
    first: int  # source id of the first polygon

    def world(self):
        return apply(self.matrix, self.local)


def read_draws(path, scene=None):
    """The draws of a scene in the order of source ids."""
    gltf = read_gltf(path)
    document = gltf.document
    roots = document['scenes'][document.get('scene', 0) if scene is None else scene].get('nodes', [])
    draws, shapes, first = [], {}, 0
    stack = [(number, np.eye(4)) for number in reversed(roots)]
    while stack:
        number, above = stack.pop()
        node = document['nodes'][number]
        matrix = above @ node_matrix(node)
        stack += [(child, matrix) for child in reversed(node.get('children', []))]
        if 'mesh' not in node:
            continue
        for index, primitive in enumerate(document['meshes'][node['mesh']]['primitives']):
            key = node['mesh'], index
            if key not in shapes:
                shapes[key] = gltf.floats(primitive['attributes']['POSITION'])[gltf.corners(primitive)]
            for instance, within in enumerate(instance_matrices(gltf, node)):
                draws.append(Draw(number, node['mesh'], index, instance, primitive.get('material', -1), matrix @ within,
                                  shapes[key], first))
                first += len(shapes[key])
    return draws


def world_triangles(path, scene=None):
    """All polygons by source id, [n, 3, 3]."""
    return np.concatenate([draw.world() for draw in read_draws(path, scene)] or [np.zeros((0, 3, 3))])
