"""A hall with screens: masks that cut away half of them, double-sided and single-sided ones, mirrored ones, glass, and
blocks of many small triangles behind them."""

from colonnade_scene import Glb, hall

CUT_AWAY = 0.5  # alpha below which a mask cuts


def screen(half, alphas):
    """A square of 2 * half meters, seen from +z; alphas of its lower and its upper corners."""
    corners = [(-half, 0, 0), (half, 0, 0), (half, 2 * half, 0), (-half, 2 * half, 0)]
    colors = [(1, 0.7, 0.4, alphas[0])] * 2 + [(0.5, 0.8, 1, alphas[1])] * 2
    return corners, [(0, 1, 2), (0, 2, 3)], colors


def bumps(columns, size):
    """A single-sided sheet of small pyramids, seen from +z."""
    corners, triangles = [], []
    step = size / columns
    for row in range(columns):
        for column in range(columns):
            x, y, first = column * step - size / 2, row * step, len(corners)
            corners += [(x, y, 0), (x + step, y, 0), (x + step, y + step, 0), (x, y + step, 0),
                        (x + step / 2, y + step / 2, 0.4 * step)]
            triangles += [(first + k, first + (k + 1) % 4, first + 4) for k in range(4)]
    return corners, triangles, [(0.8, 0.8, 0.7, 1)] * len(corners)


def primitive(glb, shape, material):
    corners, triangles, colors = shape
    return {'primitives': [{'attributes': {'POSITION': glb.add(corners, 'VEC3'), 'COLOR_0': glb.add(colors, 'VEC4')},
                            'indices': glb.add(triangles, 'SCALAR', 'I'), 'material': material}]}


def write_screens(path, mask='MASK'):
    """mask: OPAQUE leaves the screens whole."""
    glb = Glb()
    corners, triangles = hall()
    walls = primitive(glb, (corners, triangles, [(0.9, 0.9, 0.9, 1)] * len(corners)), 0)
    meshes = [walls, primitive(glb, screen(1, (1, 0)), 1), primitive(glb, screen(1, (1, 1)), 2),
              primitive(glb, bumps(12, 2), 0), primitive(glb, screen(0.8, (0.3, 0.6)), 3)]
    half_turn, quarter = [0, 1, 0, 0], [0, 0.7071068, 0, 0.7071068]
    nodes = [{'mesh': 0},
             {'mesh': 1, 'translation': [-8, 0, -1]},  # masked, seen from both sides
             {'mesh': 1, 'translation': [-4, 0, 1], 'rotation': half_turn},
             {'mesh': 1, 'translation': [-6, 0, 0], 'rotation': quarter, 'scale': [-1, 1, 1]},
             {'mesh': 2, 'translation': [0, 0, -2]},  # opaque, seen from both sides
             {'mesh': 2, 'translation': [2, 0, 0], 'rotation': quarter},
             {'mesh': 4, 'translation': [1, 0.5, 1]},  # glass
             {'mesh': 4, 'translation': [3, 0.5, -1], 'rotation': half_turn}]
    for i in range(8):  # single-sided; each second one is mirrored
        nodes.append({'mesh': 3, 'translation': [3 * i - 11, 0.2, 4 if i % 3 else -4], 'rotation': half_turn if i % 4 > 1
                      else [0, 0, 0, 1], 'scale': [-1 if i % 2 else 1, 1, 1]})
    materials = [{'name': 'stone'}, {'name': 'grid', 'alphaMode': mask, 'doubleSided': True,
                                      **({'alphaCutoff': CUT_AWAY} if mask == 'MASK' else {})},
                 {'name': 'board', 'doubleSided': True}, {'name': 'glass', 'alphaMode': 'BLEND', 'doubleSided': True}]
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': list(range(len(nodes)))}], 'nodes': nodes,
        'meshes': meshes, 'materials': materials, 'buffers': [{'byteLength': len(glb.binary)}],
        'bufferViews': glb.views, 'accessors': glb.accessors}
    glb.write(path, document)
