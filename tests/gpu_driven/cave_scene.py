"""A closed cave with wavy walls, seen from the inside: a picture with a pixel of the sky has a gap."""
import math
import random

from colonnade_scene import Glb


def tube(around, along):
    """60 m long and 10 m wide. Corners of the rings from end to end, and triangles that face the inside."""
    corners = [(30, 0, 0), (-30, 0, 0)]
    for row in range(1, along):
        for column in range(around):
            u, v = 2 * math.pi * column / around, math.pi * row / along
            r = 5 + 0.2 * math.sin(7 * u) * math.sin(15 * v) + 0.02 * math.sin(31 * u + 57 * v) * math.sin(v)
            corners.append((6 * r * math.cos(v), r * math.sin(v) * math.cos(u), r * math.sin(v) * math.sin(u)))

    def at(row, column):
        return 0 if row == 0 else 1 if row == along else 2 + (row - 1) * around + column % around
    quads = [(at(r, c), at(r, c + 1), at(r + 1, c + 1), at(r + 1, c)) for r in range(along) for c in range(around)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    triangles = [t for t in triangles if len(set(t)) == 3]
    random.Random(3).shuffle(triangles)  # clusters of neighbors in all directions, not of rows
    return corners, triangles


def write_cave(path):
    """Node 0 has the cave; it is scaled, and mirrored."""
    glb = Glb()
    meshes = [glb.mesh(tube(64, 160), 0)]
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0]}], 'meshes': meshes,
        'nodes': [{'mesh': 0, 'scale': [-1.2, 1, 1], 'translation': [30, 0, -2]}],
        'materials': [{'pbrMetallicRoughness': {'baseColorFactor': [0.5, 0.3, 0.2, 1]}}],
        'buffers': [{'byteLength': len(glb.binary)}], 'bufferViews': glb.views, 'accessors': glb.accessors}
    glb.write(path, document)
