#!/usr/bin/python3
"""Writes the seeds of the corpora: small scenes of our own, one per feature of the import, small .pvs files, and lists
of cells as a checkpoint has them.

usage: make_corpus.py [FOLDER]      FOLDER: default tests/fuzz/corpus

Seeds are named seed_*; what a search found (regressions) keeps its own name and is not touched.
"""
import base64
import json
import os
import shutil
import struct
import sys
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))

# A grid of 2 x 2 squares (8 triangles, 9 vertices with coordinates) by Draco's own encoder at 11 and 10 bits.
DRACO_EDGEBREAKER = ("RFJBQ08CAgEBAAAACQgBCAIAA3/aB/8BEf8CiEAC/wAAAAAAAQAJAwAAAgEDCQIAAQIBAQEADAOtKiNVFQMqYkz/B8D//w8AAAAA"
                     "AP8HAAAAAAAA/wcAAAAAAAAAAAAAAAAAAAAAAEALAQEBAAsDrSofVRUDKmJM////PwAA/A8AAAAAAP8DAAAAAAAAAAAAAAAAgD8K")
DRACO_VALENCE = ("RFJBQ08CAgEBAAAACQgBCAIAA3/aB/8BEf8CiEAC/wABAAAAAQAJAwAAAgEDCQIAAQIBAQEADAOtKiNVFQMqYkz/B8D//w8AAAAAAP8H"
                 "AAAAAAAA/wcAAAAAAAAAAAAAAAAAAAAAAEALBQEBAAsDyTEfOQ4DoI6b////PwAAAAcAAAAlA/UFgQAAAAD/AwAAAAAAAAAAAAAAAIA/"
                 "Cg==")
DRACO_SEQUENTIAL = ("RFJBQ08CAgEAAAAICQEAAQIAAgMDAgQDBAUBBgcBBwICBwgCCAQBAgAJAwAAAwkCAAECAgABAQAMAx0HHQcfyTEDZz5x+D8AAAAAAPz/"
                    "/wAAwP8B4P//AwAAIQAA8H8AAMD/AAAAAP8HAAAAAQEACwMdBx0HG8kxA2c+cfwPAAD//w/A//7/D0AC8D8A/gMAAAAA/wMAAAAAAAAA"
                    "AAAAAAAAAAAAAEALAAAAAAAAAAAAAIA/Cg==")
# Four triangles in a row (12 vertices of 12 bytes; 12 indices) by meshoptimizer's encoders.
MESHOPT_ATTRIBUTES = ("oAAAAT///wD///////+Af4CAfwE/mAAAfn1+AAABDzzzAP////////8BDzzzAH59fn1+fX4AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"
                      "AAAAAAAAAAAAAAA=")
MESHOPT_TRIANGLES = "4fDw8PAAdodWZ3iphmWJaJgBaQAA"
MESHOPT_INDICES = "0QAEBAQEBAQEBAQEBAAAAAA="
MESHOPT_EXPONENTIAL = ("oAABPwP/AEA/QCAfIB8gAAEgmAkAAAEPPPMAQD9APyAfIAABIJgJAAAAAAEgmAkAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAADyAAAA8gAA"
                       "API=")


class Sketch:
    """A glTF document under construction: four triangles in a row, one node, one scene."""

    def __init__(self, triangles=4):
        self.binary = b""
        self.json = {"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "meshes": [], "nodes": []}
        points = []
        for i in range(triangles):
            points += [i, 0, 0, i + 1, 0, 0, i, 1, 0]
        self.count = 3 * triangles
        self.positions = self.accessor(struct.pack(f"<{len(points)}f", *points), "VEC3", 5126, self.count)
        self.json["meshes"].append({"primitives": [{"attributes": {"POSITION": self.positions}}]})
        self.json["nodes"].append({"mesh": 0, "name": "row"})
        self.json["scenes"] = [{"nodes": [0]}]
        self.json["scene"] = 0

    def view(self, data, **more):
        self.binary += b"\0" * (-len(self.binary) % 4)
        self.json["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data), **more})
        self.binary += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, data, kind, component, count, **more):
        stride = {"byteStride": more.pop("stride")} if "stride" in more else {}
        self.json["accessors"].append(
            {"bufferView": self.view(data, **stride), "type": kind, "componentType": component, "count": count, **more})
        return len(self.json["accessors"]) - 1

    def use(self, *names):
        self.json["extensionsUsed"] = list(names)
        self.json["extensionsRequired"] = list(names)

    @property
    def primitive(self):
        return self.json["meshes"][0]["primitives"][0]

    def glb(self):
        self.json.setdefault("buffers", [{"byteLength": len(self.binary)}])
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = self.binary + b"\0" * (-len(self.binary) % 4)
        return (struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(binary), len(text), b"JSON") + text +
                struct.pack("<I4s", len(binary), b"BIN\0") + binary)

    def gltf(self):
        self.json["buffers"] = [{"byteLength": len(self.binary), "uri": data_uri(self.binary)}]
        return json.dumps(self.json, separators=(",", ":")).encode()


def data_uri(data, kind="application/octet-stream"):
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def png(width=4, height=4, promised=None):
    """RGBA; alpha is a chessboard. promised: the size that the header gives instead."""
    rows = b"".join(b"\0" + b"".join(bytes([200, 100, 50, 255 * ((x + y) % 2)]) for x in range(width))
                    for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", promised or width, promised or height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def with_uvs(s):
    uvs = [c for i in range(s.count) for c in ((i % 3 == 1) * 1.0, (i % 3 == 2) * 1.0)]
    s.primitive["attributes"]["TEXCOORD_0"] = s.accessor(struct.pack(f"<{len(uvs)}f", *uvs), "VEC2", 5126, s.count)
    return s


def with_mask(s, image=None, **texture):
    with_uvs(s)
    s.json["images"] = [image or {"bufferView": s.view(png()), "mimeType": "image/png"}]
    s.json["samplers"] = [{"wrapS": 33071, "wrapT": 33648}]
    s.json["textures"] = [{"source": 0, "sampler": 0}]
    s.json["materials"] = [{"alphaMode": "MASK", "alphaCutoff": 0.4, "doubleSided": True, "pbrMetallicRoughness": {
        "baseColorFactor": [1, 1, 1, 0.9], "baseColorTexture": {"index": 0, **texture}}}]
    s.primitive["material"] = 0
    return s


def plain():
    s = Sketch()
    s.primitive["indices"] = s.accessor(struct.pack("<12H", *range(12)), "SCALAR", 5123, 12)
    return s


def index_types():
    s = Sketch()
    first = s.primitive
    s.json["meshes"][0]["primitives"] = [
        {**first, "indices": s.accessor(struct.pack("<12" + letter, *range(12)), "SCALAR", kind, 12)}
        for letter, kind in (("B", 5121), ("H", 5123), ("I", 5125))]
    return s


def strips():
    s = Sketch()
    s.json["meshes"][0]["primitives"] = [{**s.primitive, "mode": mode} for mode in range(7)]
    return s


def sparse(zero_base):
    s = Sketch()
    accessor = s.json["accessors"][0]
    accessor["sparse"] = {"count": 2, "indices": {"bufferView": s.view(struct.pack("<2H", 1, 7)), "componentType": 5123},
                          "values": {"bufferView": s.view(struct.pack("<6f", 5, 0, 1, 0, 6, 1))}}
    if zero_base:
        del accessor["bufferView"]
    return s


def instancing():
    s = Sketch()
    s.use("EXT_mesh_gpu_instancing")
    attributes = {
        "TRANSLATION": s.accessor(struct.pack("<9f", 0, 0, 0, 9, 0, 0, 0, 0, 9), "VEC3", 5126, 3),
        "ROTATION": s.accessor(struct.pack("<12h", 0, 0, 0, 32767, 0, 32767, 0, 0, 23170, 0, 0, 23170), "VEC4", 5122, 3,
                               normalized=True),
        "SCALE": s.accessor(struct.pack("<9f", 1, 1, 1, -1, 1, 1, 2, 2, 2), "VEC3", 5126, 3)}
    s.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    return s


def quantized():
    s = Sketch()
    s.use("KHR_mesh_quantization")
    data = b"".join(struct.pack("<3hxx", 8000 * i, 8000 * (i % 3), -i) for i in range(4)) * 3
    s.primitive["attributes"]["POSITION"] = s.accessor(data, "VEC3", 5122, 12, normalized=True, stride=8)
    s.json["nodes"][0].update(scale=[4, 4, 4], translation=[1, 2, 3])
    return s


def texture_transform():
    s = with_mask(Sketch(), texCoord=1, extensions={
        "KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": 0.7, "scale": [2, 3], "texCoord": 0}})
    s.use("KHR_texture_transform")
    s.primitive["attributes"]["COLOR_0"] = s.accessor(bytes(range(0, 240, 5)), "VEC4", 5121, 12, normalized=True)
    return s


def nodes():
    s = Sketch()
    s.json["nodes"] = [{"children": [1, 2], "scale": [1, 1, -1]}, {"mesh": 0, "rotation": [0, 0.6, 0, 0.8]},
                       {"children": [3], "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 3, 4, 5, 1]}, {"mesh": 0}]
    s.json["scenes"] = [{"nodes": [0]}, {"nodes": [3]}]
    return s


def with_joints(s):
    s.primitive["attributes"]["JOINTS_0"] = s.accessor(bytes([0, 1, 0, 0] * s.count), "VEC4", 5121, s.count)
    s.primitive["attributes"]["WEIGHTS_0"] = s.accessor(
        struct.pack("<4f", 0.75, 0.25, 0, 0) * s.count, "VEC4", 5126, s.count)
    s.json["nodes"] = [{"mesh": 0, "skin": 0}, {"children": [2], "translation": [1, 0, 0]}, {"translation": [0, 1, 0]}]
    s.json["scenes"] = [{"nodes": [0, 1]}]
    matrices = struct.pack("<32f", *[1.0 if i % 5 == 0 else 0.0 for i in range(16)] * 2)
    s.json["skins"] = [{"joints": [1, 2], "skeleton": 1,
                        "inverseBindMatrices": s.accessor(matrices, "MAT4", 5126, 2)}]
    return s


def with_morph(s):
    s.primitive["targets"] = [{"POSITION": s.accessor(struct.pack("<36f", *[0.5] * 36), "VEC3", 5126, 12)}]
    s.json["meshes"][0]["weights"] = [0.5]
    return s


def with_animation(s):
    times = s.accessor(struct.pack("<2f", 0, 1), "SCALAR", 5126, 2)
    moves = s.accessor(struct.pack("<6f", 0, 0, 0, 1, 2, 3), "VEC3", 5126, 2)
    node = len(s.json["nodes"]) - 1
    s.json["animations"] = [{"samplers": [{"input": times, "output": moves, "interpolation": "LINEAR"}],
                             "channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}}]}]
    return s


def tags():
    s = Sketch()
    marks = [{"occluder": False}, {"dynamic": True}, {"always": True}, {"never": True}, {"group": "doors"}, {}]
    s.json["nodes"] = [{"mesh": 0, "name": f"n{i}", "translation": [0, 0, i], "extras": {"sightcell": mark}}
                       for i, mark in enumerate(marks)]
    s.json["nodes"][5]["children"] = [4]
    s.json["scenes"] = [{"nodes": [0, 1, 2, 3, 5]}]
    s.json["materials"] = [{"extras": {"sightcell": {"occluder": False}}, "alphaMode": "BLEND"}]
    s.primitive["material"] = 0
    s.primitive["extras"] = {"sightcell": {"always": True}}
    s.json["meshes"][0]["extras"] = {"sightcell": {"group": "windows"}}
    return s


def lod():
    s = Sketch()
    s.json["extensionsUsed"] = ["MSFT_lod"]
    s.json["meshes"].append({"primitives": [dict(s.primitive, mode=5)]})
    s.json["nodes"] = [{"mesh": 0, "extensions": {"MSFT_lod": {"ids": [1, 2]}}, "extras": {"MSFT_screencoverage": [0.5, 0.1]}},
                       {"mesh": 1}, {"mesh": 1}]
    s.json["materials"] = [{"extensions": {"MSFT_lod": {"ids": [1]}}}, {}]
    s.primitive["material"] = 0
    return s


def draco(stream):
    data = base64.b64decode(stream)
    s = Sketch()
    s.json["accessors"] = [{"componentType": 5126, "count": 9, "type": "VEC3"},
                           {"componentType": 5126, "count": 9, "type": "VEC2"},
                           {"componentType": 5123, "count": 24, "type": "SCALAR"}]
    s.use("KHR_draco_mesh_compression")
    s.json["meshes"][0]["primitives"] = [{
        "attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2,
        "extensions": {"KHR_draco_mesh_compression": {
            "bufferView": s.view(data), "attributes": {"POSITION": 0, "TEXCOORD_0": 1}}}}]
    return s


def meshopt(triangles, attributes, **more):
    s = Sketch()
    s.use("EXT_meshopt_compression")

    def view(stream, stride, mode, length, **extra):
        data = base64.b64decode(stream)
        number = s.view(data)
        s.json["bufferViews"][number] = {
            "buffer": 1, "byteLength": length, "extensions": {"EXT_meshopt_compression": {
                "buffer": 0, "byteOffset": s.json["bufferViews"][number]["byteOffset"], "byteLength": len(data),
                "byteStride": stride, "mode": mode, "count": 12, **extra}}}
        return number
    s.json["accessors"] = [
        {"bufferView": view(attributes, 12, "ATTRIBUTES", 144, **more), "componentType": 5126, "count": 12, "type": "VEC3"},
        {"bufferView": view(triangles[0], 4, triangles[1], 48), "componentType": 5125, "count": 12, "type": "SCALAR"}]
    s.primitive["indices"] = 1
    s.json["buffers"] = [{"byteLength": len(s.binary)},
                         {"byteLength": 1000, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}]
    return s


def everything():
    s = with_animation(with_morph(with_joints(with_mask(Sketch()))))
    s.json["nodes"][0]["extras"] = {"sightcell": {"occluder": False}}
    s.json["extensionsUsed"] = ["KHR_lights_punctual", "KHR_materials_variants", "ACME_other"]
    return s


def seeds():
    broken = Sketch()
    broken.json["nodes"][0]["children"] = [0]
    yield "plain.glb", plain().glb()
    yield "plain.gltf", plain().gltf()
    yield "index_types.glb", index_types().glb()
    yield "strips.glb", strips().glb()
    yield "sparse.glb", sparse(False).glb()
    yield "sparse_zero.glb", sparse(True).glb()
    yield "instancing.glb", instancing().glb()
    yield "quantized.glb", quantized().glb()
    yield "mask.glb", with_mask(Sketch()).glb()
    yield "mask_data_uri.gltf", with_mask(Sketch(), {"uri": data_uri(png(3, 2), "image/png")}).gltf()
    yield "texture_transform.glb", texture_transform().glb()
    yield "nodes.glb", nodes().glb()
    yield "cycle.glb", broken.glb()
    yield "skin.glb", with_animation(with_joints(Sketch())).glb()
    yield "morph.glb", with_animation(with_morph(Sketch())).glb()
    yield "tags.glb", tags().glb()
    yield "lod.glb", lod().glb()
    yield "draco_edgebreaker.glb", draco(DRACO_EDGEBREAKER).glb()
    yield "draco_valence.glb", draco(DRACO_VALENCE).glb()
    yield "draco_sequential.glb", draco(DRACO_SEQUENTIAL).glb()
    yield "meshopt.glb", meshopt((MESHOPT_TRIANGLES, "TRIANGLES"), MESHOPT_ATTRIBUTES).glb()
    yield "meshopt_indices.glb", meshopt((MESHOPT_INDICES, "INDICES"), MESHOPT_EXPONENTIAL, filter="EXPONENTIAL").glb()
    yield "everything.glb", everything().glb()
    # Few bytes that promise much.
    yield "promised_pixels.glb", with_mask(Sketch(), {"uri": data_uri(png(4, 4, 16384), "image/png")}).glb()
    huge = bytearray(base64.b64decode(DRACO_EDGEBREAKER))
    many = b"\xFF\xFF\xFF\x7F"
    huge[12:16] = many + many + b"\x01" + many  # points, triangles, symbols
    yield "promised_triangles.glb", draco(base64.b64encode(huge)).glb()
    zeros = Sketch()
    zeros.json["accessors"].append({"componentType": 5126, "count": (1 << 23) - 1, "type": "VEC3"})
    zeros.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"SCALE": 1}}}
    yield "promised_instances.glb", zeros.glb()


def cells_list(cells, boxes=(), warnings=(), width=4.0):
    """The bytes of bake/src/cells/decided_cells.cpp. cells: (z, y, x, level, layers, floor area, floor)."""
    def text(value):
        return struct.pack("<Q", len(value)) + value

    def positions(of):
        return struct.pack("<Q", len(of)) + b"".join(struct.pack("<qqqBidd", *cell) for cell in of)

    return (b"\x01" + text(b"inputs") + text(b"cpu device") + text(b"3 cells of 4 m") + struct.pack("<Q", len(warnings)) +
            b"".join(text(warning) for warning in warnings) + struct.pack("<d", width) + positions(cells) + positions(boxes))


def seeds_of_cells():
    columns = [(z, -2, x, 0, 4, 16.0, -1.5) for z in range(2) for x in range(3)]
    yield "one", cells_list([(0, 0, 0, 0, 1, 0.0, 0.0)])
    yield "columns", cells_list(columns, warnings=[b"a warning", b""])
    yield "merged", cells_list([(0, -2, 0, 3, 12, 600.0, -1.25), (0, 3, 1, 1, 4, 30.0, 2.0)], columns)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(HERE, "corpus")
    for kind in ("gltf", "pvs", "cells"):
        os.makedirs(os.path.join(folder, kind), exist_ok=True)
    for name, data in seeds():
        with open(os.path.join(folder, "gltf", "seed_" + name), "wb") as out:
            out.write(data)
    for name, data in seeds_of_cells():
        with open(os.path.join(folder, "cells", "seed_" + name), "wb") as out:
            out.write(data)
    golden = os.path.join(HERE, "..", "golden")
    for name in ("v0_small.pvs", "v0_tiny.pvs", "v1_small.pvs", "v1_tiny.pvs", "v1_lattice.pvs", "v1_merged.pvs",
                 "v1_importance.pvs", "v1_volumes.pvs", "v1_groups.pvs", "v1_viewpoints.pvs",
                 "v1_grid.pvs", "v1_chunks.pvs", "v1_eyes.pvs",
                 "v1_identity.pvs"):
        shutil.copyfile(os.path.join(golden, name), os.path.join(folder, "pvs", "seed_" + name))
    # What those do not have: two references behind each other, a lattice without cells, draws that share an order.
    for name in ("undamaged_rows.pvs", "undamaged_no_cells.pvs", "undamaged_whole.pvs", "undamaged_volumes.pvs",
                 "undamaged_named_groups.pvs", "undamaged_viewpoints.pvs"):
        shutil.copyfile(os.path.join(golden, "golden_errors", name), os.path.join(folder, "pvs", "seed_" + name))


if __name__ == "__main__":
    main()
