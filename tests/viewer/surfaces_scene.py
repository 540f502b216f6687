"""A small scene with one of every kind of surface that a renderer can get wrong."""
import json
import struct
import zlib


def write_png(width, height, rgba):
    """The bytes of a PNG file. rgba(x, y): four numbers."""
    rows = b''.join(b'\0' + b''.join(bytes(rgba(x, y)) for x in range(width)) for y in range(height))

    def part(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    return (b'\x89PNG\r\n\x1a\n' + part(b'IHDR', struct.pack('>IIBBBBB', width, height, 8, 6, 0, 0, 0)) +
            part(b'IDAT', zlib.compress(rows)) + part(b'IEND', b''))


def write_surfaces(path):
    """Twelve quads of 2 x 2 m in a row along x, to be seen from +z: 24 polygons."""
    texture = write_png(16, 16, lambda x, y: (16 * x, 16 * y, 200 if (x // 4 + y // 4) % 2 else 40,
                                              255 if (x // 4 + y // 4) % 2 else 60))
    quad = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    uvs = [(0, 1), (1, 1), (1, 0), (0, 0)]
    # A wedge: one side of a box turned to +x +z. Mirrored without turning its polygons over it would vanish.
    wedge = [(0, -1, 1), (1, -1, 0), (1, 1, 0), (0, 1, 1)]
    indices = struct.pack('<6H', 0, 1, 2, 0, 2, 3)
    blobs = [b''.join(struct.pack('<3f', *p) for p in quad), b''.join(struct.pack('<2f', *p) for p in uvs), indices,
             b''.join(struct.pack('<3f', *p) for p in wedge), texture]
    binary, views = b'', []
    for blob in blobs:
        views.append({'buffer': 0, 'byteOffset': len(binary), 'byteLength': len(blob)})
        binary += blob + b'\0' * (-len(blob) % 4)

    def material(color, **more):
        textured = more.pop('textured', False)
        rough = {'baseColorFactor': color}
        if textured:
            rough['baseColorTexture'] = {'index': 0}
        return {'pbrMetallicRoughness': rough, **more}

    def mesh(position, material_number):
        primitive = {'attributes': {'POSITION': position, 'TEXCOORD_0': 1}, 'indices': 2}
        if material_number is not None:
            primitive['material'] = material_number
        return {'primitives': [primitive]}
    turned = [0, 1, 0, 0]  # half a turn about y: seen from behind
    nodes = [
        {'mesh': 0, 'translation': [-7.5, 0, 0]},                                   # default material
        {'mesh': 1, 'translation': [-5, 0, 0]},                                     # textured
        {'mesh': 2, 'translation': [-2.5, 0, 0]},                                   # mask, before a plain one
        {'mesh': 0, 'translation': [-2.5, 0, -1]},
        {'mesh': 3, 'translation': [0, 0.3, 0]},                                    # blend, before a textured one
        {'mesh': 1, 'translation': [0, 0, -1]},
        {'mesh': 0, 'translation': [2.5, 0, 0], 'rotation': turned},                # single-sided from behind: not seen
        {'mesh': 4, 'translation': [5, 0, 0], 'rotation': turned},                  # double-sided from behind: seen
        {'mesh': 5, 'translation': [7.5, 0, 0]},
        {'mesh': 5, 'translation': [7.5, 0, 0], 'scale': [-1, 1, 1]},               # mirrored: seen too
        {'mesh': 0, 'translation': [2.5, -2.2, 0], 'scale': [1, -1, 1]},            # mirrored upside down: seen
        {'mesh': 0, 'translation': [5, -2.2, 0], 'scale': [-1, -1, -1]},            # three times: shows its back
    ]
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': list(range(len(nodes)))}], 'nodes': nodes,
        'meshes': [mesh(0, None), mesh(0, 0), mesh(0, 1), mesh(0, 2), mesh(0, 3), mesh(3, 4)],
        'materials': [material([1, 1, 1, 1], textured=True),
                      material([1, 0.8, 0.6, 1], textured=True, alphaMode='MASK', alphaCutoff=0.5),
                      material([0.2, 1, 0.2, 0.4], alphaMode='BLEND'),
                      material([0.9, 0.5, 0.1, 1], doubleSided=True), material([0.3, 0.3, 1, 1])],
        'textures': [{'source': 0}], 'images': [{'bufferView': 4, 'mimeType': 'image/png'}],
        'buffers': [{'byteLength': len(binary)}], 'bufferViews': views,
        'accessors': [
            {'bufferView': 0, 'componentType': 5126, 'count': 4, 'type': 'VEC3', 'min': [-1, -1, 0], 'max': [1, 1, 0]},
            {'bufferView': 1, 'componentType': 5126, 'count': 4, 'type': 'VEC2'},
            {'bufferView': 2, 'componentType': 5123, 'count': 6, 'type': 'SCALAR'},
            {'bufferView': 3, 'componentType': 5126, 'count': 4, 'type': 'VEC3', 'min': [0, -1, 0], 'max': [1, 1, 1]}]}
    text = json.dumps(document).encode()
    text += b' ' * (-len(text) % 4)
    with open(path, 'wb') as out:
        out.write(struct.pack('<4sII', b'glTF', 2, 28 + len(text) + len(binary)))
        out.write(struct.pack('<I4s', len(text), b'JSON') + text + struct.pack('<I4s', len(binary), b'BIN\0') + binary)
