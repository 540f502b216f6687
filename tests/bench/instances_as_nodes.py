"""A .glb whose EXT_mesh_gpu_instancing instances become a node each: the same floats, so the same polygons in the same
places under other source ids. Imported by bench_data.py."""
import json
import struct

COLUMNS = {"TRANSLATION": "translation", "ROTATION": "rotation", "SCALE": "scale"}


def floats(document, binary, accessor):
    """The elements of an accessor of floats, a list each."""
    source = document["accessors"][accessor]
    view = document["bufferViews"][source["bufferView"]]
    width = {"VEC3": 3, "VEC4": 4}[source["type"]]
    if source["componentType"] != 5126:
        raise ValueError("only instances of floats are taken apart")
    first = view.get("byteOffset", 0) + source.get("byteOffset", 0)
    stride = view.get("byteStride", 4 * width)
    return [list(struct.unpack_from(f"<{width}f", binary, first + i * stride)) for i in range(source["count"])]


def take_apart(document, binary):
    nodes = document["nodes"]
    for number in range(len(nodes)):
        node = nodes[number]
        instancing = node.get("extensions", {}).pop("EXT_mesh_gpu_instancing", None)
        if instancing is None:
            continue
        columns = {COLUMNS[key]: floats(document, binary, accessor)
                   for key, accessor in instancing["attributes"].items() if key in COLUMNS}
        mesh = node.pop("mesh")
        made = range(len(nodes), len(nodes) + len(next(iter(columns.values()))))
        node["children"] = [*made, *node.get("children", [])]
        if not node["extensions"]:
            del node["extensions"]
        nodes += [{"mesh": mesh, **{key: values[i] for key, values in columns.items()}} for i in range(len(made))]
    for key in ("extensionsUsed", "extensionsRequired"):
        names = [name for name in document.pop(key, []) if name != "EXT_mesh_gpu_instancing"]
        if names:
            document[key] = names


def write_with_nodes(source, target):
    with open(source, "rb") as file:
        data = file.read()
    length = struct.unpack_from("<I", data, 12)[0]
    document, rest = json.loads(data[20:20 + length]), data[20 + length:]
    take_apart(document, rest[8:])
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(target, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest)))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text + rest)
