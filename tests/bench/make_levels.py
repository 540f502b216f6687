#!/usr/bin/python3
"""Writes a copy of a .glb in which each node with a mesh has two coarser levels of detail (MSFT_lod), outside the tree.

usage: make_levels.py IN.glb OUT.glb [--grids 0.02,0.06] [--coverages 1,0.3]

--grids: step of the grid that the vertices of a level are snapped to, as a share of the diagonal of the mesh. A vertex moves to
the first one of its grid box, and triangles without area go. Nothing is random. --coverages: where the levels begin
(MSFT_screencoverage). Prints one line of JSON: objects, and triangles of each level over all of them.
"""
import argparse
import array
import copy
import json
import math
import struct

COMPONENTS = {5121: ("B", 1), 5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}
WIDTH = {"SCALAR": 1, "VEC3": 3}


def read_glb(path):
    with open(path, "rb") as file:
        data = file.read()
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), bytearray(data[28 + size:])


def write_glb(path, document, binary):
    binary += bytes(-len(binary) % 4)
    document["buffers"][0]["byteLength"] = len(binary)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(binary)))
        file.write(struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary)


def values(document, binary, number):
    """The rows of an accessor."""
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    code, size = COMPONENTS[accessor["componentType"]]
    width = WIDTH[accessor["type"]]
    start, stride = view.get("byteOffset", 0) + accessor.get("byteOffset", 0), view.get("byteStride", size * width)
    return [struct.unpack_from(f"<{width}{code}", binary, start + i * stride) for i in range(accessor["count"])]


def snapped(positions, indices, low, step):
    """The indices with each vertex replaced by the first one of its grid box, without triangles that vanish."""
    first, to = {}, []
    for i, point in enumerate(positions):
        to.append(first.setdefault(tuple(math.floor((p - l) / step) for p, l in zip(point, low)), i))
    out = []
    for i in range(0, len(indices) - 2, 3):
        corners = [to[k] for k in indices[i:i + 3]]
        if len(set(corners)) == 3:
            out += corners
    return out


def add_indices(document, binary, indices):
    binary += bytes(-len(binary) % 4)
    document["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": 4 * len(indices)})
    binary += array.array("I", indices).tobytes()
    document["accessors"].append({"bufferView": len(document["bufferViews"]) - 1, "componentType": 5125, "count": len(indices),
                                  "type": "SCALAR"})
    return len(document["accessors"]) - 1


def coarser_mesh(document, binary, mesh, share):
    """The number of a new mesh, and its triangles."""
    parts = []
    for primitive in mesh["primitives"]:
        if primitive.get("mode", 4) != 4 or "indices" not in primitive:
            raise SystemExit("make_levels: only indexed triangles are read")
        parts.append((values(document, binary, primitive["attributes"]["POSITION"]),
                      [row[0] for row in values(document, binary, primitive["indices"])]))
    low, high = ([pick(p[k] for points, _ in parts for p in points) for k in range(3)] for pick in (min, max))
    step, level, triangles = share * math.dist(low, high), copy.deepcopy(mesh), 0
    level["primitives"] = []
    for primitive, (positions, indices) in zip(mesh["primitives"], parts):
        kept = snapped(positions, indices, low, step)
        if kept:
            level["primitives"].append({**primitive, "indices": add_indices(document, binary, kept)})
            triangles += len(kept) // 3
    if not level["primitives"]:
        return None, 0
    document["meshes"].append(level)
    return len(document["meshes"]) - 1, triangles


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source")
    parser.add_argument("output")
    parser.add_argument("--grids", default="0.02,0.06")
    parser.add_argument("--coverages", default="1,0.3")
    options = parser.parse_args()
    grids, coverages = ([float(word) for word in text.split(",")] for text in (options.grids, options.coverages))
    document, binary = read_glb(options.source)
    meshes = [[coarser_mesh(document, binary, mesh, share) for share in grids] for mesh in list(document["meshes"])]
    objects, triangles = 0, [0] * len(grids)
    for node in list(document["nodes"]):
        if "mesh" not in node or any(mesh is None for mesh, _ in meshes[node["mesh"]]):
            continue
        objects += 1
        ids = []
        for i, (mesh, count) in enumerate(meshes[node["mesh"]]):
            place = {key: node[key] for key in ("translation", "rotation", "scale", "matrix") if key in node}
            ids.append(len(document["nodes"]))
            document["nodes"].append({**place, "mesh": mesh})
            triangles[i] += count
        node.setdefault("extensions", {})["MSFT_lod"] = {"ids": ids}
        node["extras"] = {**node.get("extras", {}), "MSFT_screencoverage": [*coverages, 0]}
    document["extensionsUsed"] = sorted({*document.get("extensionsUsed", []), "MSFT_lod"})
    write_glb(options.output, document, binary)
    print(json.dumps({"objects": objects, "triangles": triangles}))


if __name__ == "__main__":
    main()
