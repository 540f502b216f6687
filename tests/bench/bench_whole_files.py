#!/usr/bin/python3
"""A streamed scene (docs/streaming.md) beside the whole scene as one compressed file, over the same simulated connection.

usage: bench_whole_files.py --bin FOLDER [--gltfpack FILE] [--gltf-transform FILE] [--draco-transcoder FILE] [--poses N]
                            [--picture-poses N] [--limit SECONDS] [--only REGEX] [--quick] [--results DIR]
                            [SCENE.glb[=FILE.pvs] ...]

--bin: the folder with sightcell, stream_truth and two_pictures. Scenes and kept files are those of bench_streaming.py. A tool
that is neither named nor in PATH is left out, with a message; nothing is fetched. --limit: CPU seconds that a tool may take
for one file. --picture-poses 0: no pictures.

A whole file is the .glb, and what gltfpack, gltf-transform and Draco make of it, each as it is and compressed by gzip -9, zstd
-19 and brotli -q 11 (that one up to 8 MB); the smallest of these counts. Its first view is complete when all of it has arrived.
Of the streamed scene, the means over the views of bench_streaming.py, from a client without any file: pages as they are, or their
copies with gzip or brotli; 6 requests at a time, or all at once with answers in order. 40 ms from a request to its answer.
Decoding takes no time in either. Bytes and times are without images. The pictures have them: the share of pixels that differ by
more than 8 of 255 levels from the .glb as it is.

The grid of a file is the largest step of its positions in meters, 0 if these are exact.
"""
import argparse
import dataclasses
import hashlib
import json
import math
import os
import re
import resource
import shutil
import struct
import subprocess
import sys
import zlib

sys.dont_write_bytecode = True  # nothing is written into the sources
import numpy as np  # noqa: E402
import bench_streaming  # noqa: E402
import result_files  # noqa: E402
import stream_network  # noqa: E402
import stream_orders as orders  # noqa: E402
import stream_poses  # noqa: E402
from gltf_reader import node_matrix, split_glb  # noqa: E402
from stream_poses import streamed_scene  # noqa: E402

RATES = (10, 25, 50, 100)  # Mbit/s
IN_ORDER = "in order"
REQUESTS = (str(stream_network.PARALLEL), IN_ORDER)  # HTTP/1.1 of a browser; HTTP/2 or 3 with priorities (RFC 9218)
OUR_GRID = 1 / 4096  # m
RIGHT = 0.1  # %: pictures with more wrong pixels are not those of the scene
UV_BITS = 20  # of Draco
PICTURE_WIDTH = 640
INTEGERS = {5120: 1, 5121: 1, 5122: 1, 5123: 1}
LARGEST = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}
STREAMED = ("99", "99_9", "cell")


def log(text):
    print(f"bench_whole_files: {text}", file=sys.stderr, flush=True)


# --- .glb files


def read_glb(path):
    with open(path, "rb") as stream:
        return split_glb(stream.read())


def write_glb(path, document, binary):
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    with open(path, "wb") as stream:
        stream.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
        stream.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def without_images(path, to):
    """A file of the size that the .glb has without its images. Others than this script cannot read it."""
    document, binary = read_glb(path)
    views = document.get("bufferViews", [])
    gone = [views[image.pop("bufferView")] for image in document.get("images", []) if "bufferView" in image]
    if not gone:
        return path
    # Whole words go, so that the rest keeps its alignment.
    cuts = sorted((view.get("byteOffset", 0), view["byteLength"] // 4 * 4) for view in gone)
    places = [view for view in views if view["buffer"] == 0]
    places += [one for view in views for one in view.get("extensions", {}).values()]
    for place in places:
        at = place.get("byteOffset", 0)
        place["byteOffset"] = at - sum(length for begin, length in cuts if begin < at)
    for view in gone:
        view["byteLength"] = 0
    rest, at = bytearray(), 0
    for begin, length in cuts:
        rest += binary[at:begin]
        at = begin + length
    write_glb(to, document, rest + binary[at:])
    return to


def drawn_primitives(document):
    """Each primitive with the longest column of the matrix to world space of a node that draws it."""
    nodes = document.get("nodes", [])
    stack = [(root, np.eye(4)) for root in document["scenes"][document.get("scene", 0)].get("nodes", [])]
    while stack:
        number, above = stack.pop()
        matrix = above @ node_matrix(nodes[number])
        stack += [(child, matrix) for child in nodes[number].get("children", [])]
        if "mesh" in nodes[number]:
            scale = float(np.linalg.norm(matrix[:3, :3], axis=0).max())
            yield from ((primitive, scale) for primitive in document["meshes"][nodes[number]["mesh"]]["primitives"])


def largest_range(document):
    """In meters, of the positions of any primitive."""
    ranges = [0.0]
    for primitive, scale in drawn_primitives(document):
        accessor = document["accessors"][primitive["attributes"]["POSITION"]]
        ranges.append(max(b - a for a, b in zip(accessor["min"], accessor["max"])) * scale)
    return max(ranges)


def grid_of(document, bits):
    """The largest step between positions in meters. bits: of positions, where the file does not name them."""
    steps = [0.0]
    for primitive, scale in drawn_primitives(document):
        accessor = document["accessors"][primitive["attributes"]["POSITION"]]
        low, high = accessor["min"], accessor["max"]
        if accessor["componentType"] in INTEGERS:
            steps.append(scale / (LARGEST[accessor["componentType"]] if accessor.get("normalized") else 1))
        elif "KHR_draco_mesh_compression" in primitive.get("extensions", {}):
            steps.append(scale * max(b - a for a, b in zip(low, high)) / 2**bits)
        else:
            view = document["bufferViews"][accessor["bufferView"]] if "bufferView" in accessor else {}
            if any(one.get("filter") == "EXPONENTIAL" for one in view.get("extensions", {}).values()):
                most = max(map(abs, (*low, *high)))
                steps.append(scale * 2.0 ** (math.ceil(math.log2(most)) - bits) if most else 0.0)
    return max(steps)


# --- tools


@dataclasses.dataclass
class Method:
    name: str
    steps: list  # of (tool, its arguments); BITS in them becomes what our grid needs
    bits: int = 0  # of positions


def packed(arguments, bits=14):
    return Method(f"gltfpack {arguments}", [("gltfpack", arguments.split())], bits)


FINE = "--quantize-position 16 --quantize-texcoord 16".split()
SLOW = ["--encode-speed", "0", "--decode-speed", "0"]
TRANSCODED = ("draco_transcoder", ["-qp", "BITS", "-qt", str(UV_BITS)])
METHODS = [
    Method("as it is", []), packed("-c"), packed("-cc"), packed("-cc -vp 16 -vt 16", 16),
    packed("-cc -vpf -vp 16 -vtf -vt 16", 16), packed("-cc -kn -km -vpf -vp 16 -vtf -vt 16", 16), packed("-cc -noq"),
    Method("gltf-transform meshopt, 16 bits", [("gltf-transform", ["meshopt", *FINE])], 16),
    Method("gltf-transform draco", [("gltf-transform", ["draco"])], 14),
    Method("gltf-transform draco, 16 bits, slowest", [("gltf-transform", ["draco", *FINE, *SLOW])], 16),
    Method("draco_transcoder, our grid", [TRANSCODED]),
    Method("draco_transcoder, our grid, joined", [("gltf-transform", ["join"]), ("gltf-transform", ["weld"]), TRANSCODED])]
CONTAINER = [[packed(f"-cc -kv {positions} {bits} {textures} 16", bits) for bits in (15, 16)]
             for positions, textures in (("-vp", "-vt"), ("-vpf -vp", "-vtf -vt"))]
COMMANDS = {"gltfpack": lambda source, to, more: ["-i", source, "-o", to, *more],
            "draco_transcoder": lambda source, to, more: ["-i", source, "-o", to, *more],
            "gltf-transform": lambda source, to, more: [more[0], source, to, *more[1:]]}
VERSIONS = {"gltfpack": "-v", "gltf-transform": "--version", "brotli": "--version", "zstd": "--version"}
ENCODINGS = {"zstd": ["-19", "-q", "-c"], "brotli": ["-q", "11", "-w", "24", "-c"]}
MOST_FOR_BROTLI = 8 << 20  # bytes; above, it takes minutes for 3 % less than zstd -19


class Tools:
    """Runs them once for the same input; keeps what they made, and why they made nothing."""

    def __init__(self, options, kept):
        self.limit, self.kept = options.limit, kept
        named = {"gltfpack": options.gltfpack, "gltf-transform": options.gltf_transform, "draco_transcoder": options.draco_transcoder}
        self.paths = {name: named.get(name) or shutil.which(name) for name in (*COMMANDS, *ENCODINGS)}
        self.versions = {name: self.version(name) for name, path in self.paths.items() if path}
        for name, path in self.paths.items():
            if not path:
                log(f"{name} was not found; its files are left out")

    def version(self, name):
        if name not in VERSIONS:
            return self.kept.hash_of(os.path.realpath(self.paths[name]))[:8]
        text = subprocess.run([self.paths[name], VERSIONS[name]], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              check=False)
        return re.search(r"\d+(\.\d+)+", text.stdout + " 0.0")[0]

    def place(self, *parts):
        place = os.path.join(self.kept.folder, "whole", hashlib.sha256("\0".join(map(str, parts)).encode()).hexdigest()[:24])
        os.makedirs(place, exist_ok=True)
        return place

    def noted(self, measure, *parts):
        """What measure() returns, from a kept file the next time."""
        path = os.path.join(self.place(*parts), "noted.json")
        if not os.path.exists(path):
            found = measure()
            with open(path + ".part", "w", encoding="utf-8") as stream:
                json.dump(found, stream)
            os.replace(path + ".part", path)
        with open(path, encoding="utf-8") as stream:
            return json.load(stream)

    def run(self, name, arguments, output=None):
        """Nothing, or why it failed."""
        def limited():
            resource.setrlimit(resource.RLIMIT_CPU, (self.limit, self.limit + 5))
        with open(output or os.devnull, "wb") as stream:
            ended = subprocess.run([self.paths[name], *arguments], stdout=stream, stderr=subprocess.PIPE, preexec_fn=limited,
                                   check=False)
        if ended.returncode == 0:
            return None
        if ended.returncode in (-24, -9, 152, 137):
            return f"more than {self.limit} s"
        return (ended.stderr.decode(errors="replace").strip().splitlines() or [f"ended with {ended.returncode}"])[-1]

    def made(self, parts, name, arguments, output=None):
        """The path of what a tool makes, None if nothing. arguments: of the path."""
        if not self.paths[name]:
            return None
        place = self.place(name, self.versions[name], *parts)
        done, why = os.path.join(place, "done.glb"), os.path.join(place, "failed")
        if not os.path.exists(done) and not os.path.exists(why):
            part = os.path.join(place, "part.glb")
            failed = self.run(name, arguments(part), part if output else None)
            if not failed and not os.path.exists(part):
                failed = "made no file"
            if failed:
                with open(why, "w", encoding="utf-8") as stream:
                    stream.write(failed)
            else:
                os.replace(part, done)
        if os.path.exists(done):
            return done
        with open(why, encoding="utf-8") as stream:
            log(f"{name} {' '.join(map(str, parts[1:]))}: {stream.read()}; left out")
        return None

    def whole_file(self, scene, method):
        """Its path and the bits of its positions."""
        path, bits = scene, method.bits
        for tool, arguments in method.steps:
            if not self.paths[tool]:
                return None, bits
            if "BITS" in arguments:
                bits = max(1, min(30, math.ceil(math.log2(max(largest_range(read_glb(path)[0]), OUR_GRID) / OUR_GRID))))
            more = [str(bits) if one == "BITS" else one for one in arguments]
            source = path
            path = self.made([self.kept.hash_of(source), *more], tool, lambda part: COMMANDS[tool](source, part, more))
            if path is None:
                return None, bits
        return path, bits

    def encoded_sizes(self, path):
        """Bytes as it is, and compressed."""
        sizes = {"as_it_is": os.path.getsize(path), "gzip": self.noted(lambda: gzip_size(path), "gzip", self.kept.hash_of(path))}
        for name, more in ENCODINGS.items():
            if name == "brotli" and sizes["as_it_is"] > MOST_FOR_BROTLI:
                sizes[name] = None
                continue
            done = self.made([self.kept.hash_of(path), *more], name, lambda _: [*more, os.path.realpath(path)], output=True)
            sizes[name] = os.path.getsize(done) if done else None
        return sizes


def gzip_size(path):
    with open(path, "rb") as stream:
        return len(zlib.compress(stream.read(), 9)) + 12  # the head and the end of gzip are 12 bytes longer than those of zlib


# --- measurements


def whole_seconds(size):
    return {f"seconds_{rate}": stream_network.arrivals([size], rate=rate * 1e6 / 8)[0] for rate in RATES}


class Pictures:
    def __init__(self, options, tools, scene, pvs):
        kept, self.tools, self.scene = tools.kept, tools, scene
        self.program = os.path.join(options.bin, "two_pictures")
        self.poses = None
        if options.picture_poses:
            self.poses = kept.make("poses", "stream_truth", [scene, pvs], ["--poses", str(options.picture_poses), "--seed", "2"],
                                   lambda part: [scene, pvs, part])

    def wrong(self, path):
        """Shares of pixels in percent: of all pictures, and of the worst one."""
        if not self.poses or not path:
            return {"wrong_percent": None, "worst_percent": None}
        if path == self.scene:
            return {"wrong_percent": 0.0, "worst_percent": 0.0}
        inputs = [self.scene, path, self.poses]
        found = self.tools.noted(lambda: self.compare(inputs), *map(self.tools.kept.hash_of, [self.program, *inputs]), PICTURE_WIDTH)
        return {f"{key}_percent": found and 100 * found[f"{key}_share"] for key in ("wrong", "worst")}

    def compare(self, inputs):
        ended = subprocess.run([self.program, *inputs, "--size", str(PICTURE_WIDTH)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, check=False)
        if ended.returncode:
            log(f"no pictures of {inputs[1]}: {ended.stderr.strip()}")
        return None if ended.returncode else json.loads(ended.stdout)


def whole_files(tools, pictures, name, scene, only):
    for method in METHODS:
        if only and not re.search(only, method.name):
            continue
        path, bits = tools.whole_file(scene, method)
        if path is None:
            continue
        bare = without_images(path, os.path.join(tools.place(tools.kept.hash_of(path), "bare"), "bare.glb"))
        sizes = tools.encoded_sizes(bare)
        smallest = min((size, encoding) for encoding, size in sizes.items() if size)
        row = {"scene": name, "method": method.name, "bits": bits or None, "grid": grid_of(read_glb(path)[0], bits),
               **{f"{encoding}_bytes": size for encoding, size in sizes.items()}, "smallest": smallest[1].replace("_", " "),
               "smallest_bytes": smallest[0], **whole_seconds(smallest[0]), **pictures.wrong(path)}
        log(f"{name}, {method.name}: {sizes}, wrong {row['wrong_percent']}")
        yield row


def arrivals(sizes, begin, rate, requests):
    """When each file is there. In order: all requests are made at once, and one answer is sent after the other."""
    if requests == IN_ORDER:
        return begin + stream_network.ROUND_TRIP + np.cumsum(sizes) / rate
    return np.array(stream_network.arrivals(sizes, begin, rate, parallel=int(requests)))


def streamed_seconds(gains, sizes, ready, rate, requests):
    """Until each of STREAMED."""
    there = arrivals(sizes, ready, rate, requests)
    order = np.argsort(there, kind="stable")
    times, total = np.cumsum(gains[order]), gains.sum()
    found = {key: there[order][np.searchsorted(times, share * total * (1 - bench_streaming.ROUNDING))]
             for key, share in (("99", 0.99), ("99_9", 0.999))}
    return {**found, "cell": there.max()}


def streamed(name, of, site, poses, encoding, page_bytes, requests):
    """Means over the views of bench_streaming.py: bytes, and seconds at each rate. page_bytes: as they are sent."""
    front_bytes = os.path.getsize(os.path.join(site.folder, "scene.front"))
    rows = []
    for pose in poses:
        boxes = site.front.chunk_boxes
        chunks = np.flatnonzero(((boxes[:, 0] <= pose.eye) & (pose.eye < boxes[:, 1])).all(axis=1))
        sizes = [*site.front.chunk_bytes[chunks].tolist(), *page_bytes[site.front.everywhere].tolist()]
        ready = {rate: arrivals(sizes, stream_network.arrivals([front_bytes], rate=rate * 1e6 / 8)[0], rate * 1e6 / 8, requests).max()
                 for rate in RATES}
        cell = streamed_scene.cell_at(site, pose.eye)
        for turn in range(stream_poses.VIEWS):
            view = orders.View(of, pose, cell, turn)
            if view.weight < bench_streaming.LEAST_WEIGHT or not len(view.numbers):
                continue
            pages, startup = orders.ours(view), front_bytes + sum(sizes)
            gains, sent = view.true[pages], page_bytes[pages]
            spent, _ = bench_streaming.until_levels(gains, sent.astype("f8"), gains.sum())
            row = {"startup_bytes": startup, "bytes_99": startup + spent["99"], "bytes_99_9": startup + spent["99_9"],
                   "bytes_cell": startup + float(sent.sum())}
            for rate in RATES:
                found = streamed_seconds(gains, sent.tolist(), ready[rate], rate * 1e6 / 8, requests)
                row.update({f"seconds_{key}_{rate}": found[key] for key in STREAMED})
            rows.append(row)
    return {"scene": name, "pages": encoding, "requests": requests, "poses": len(poses), "views": len(rows),
            **{key: float(np.mean([row[key] for row in rows])) for key in rows[0]}}


def at_our_grid(tools, scene, pair):
    """gltfpack has at most 16 bits. Each bit more has no pattern, so that it costs as much as the last one."""
    sizes, grid = [], 0.0
    for method in pair:
        path, bits = tools.whole_file(scene, method)
        if path is None:
            return None
        grid = grid_of(read_glb(path)[0], bits)
        bare = without_images(path, os.path.join(tools.place(tools.kept.hash_of(path), "bare"), "bare.glb"))
        sizes.append((os.path.getsize(bare), gzip_size(bare)))
    missing = max(0, math.ceil(math.log2(grid / OUR_GRID)))
    equal = [last + missing * max(0, last - before) for before, last in zip(*sizes)]
    return {"gltfpack": pair[1].name, "grid_16": grid, "bytes_16": sizes[1][0], "missing_bits": missing, "equal_bytes": equal[0],
            "equal_gzip_bytes": equal[1]}


def container(tools, name, scene, site):
    """All that our site has without images beside gltfpack's file, at a grid as fine as ours."""
    files = {kind: sorted(os.path.join(site.folder, kind, one) for one in os.listdir(os.path.join(site.folder, kind))
                          if one.endswith(ending)) for kind, ending in (("pages", ".glb"), ("cells", ".cells"))}
    files["front"] = [os.path.join(site.folder, "scene.front")]
    ours = {kind: sum(map(os.path.getsize, some)) for kind, some in files.items()}
    everything = [one for some in files.values() for one in some]
    compressed = tools.noted(lambda: sum(map(gzip_size, everything)), "gzip of files", *map(os.path.basename, everything),
                             tools.kept.hash_of(everything[-1]))
    row = {"scene": name, **{f"{kind}_bytes": size for kind, size in ours.items()}, "ours_bytes": sum(ours.values()),
           "ours_gzip_bytes": compressed}
    found = [one for one in (at_our_grid(tools, scene, pair) for pair in CONTAINER) if one]
    if found:
        row.update(min(found, key=lambda one: one["equal_bytes"]))
        row.update(over_16_bits=row["ours_bytes"] / row["bytes_16"], over_equal=row["ours_bytes"] / row["equal_bytes"],
                   over_equal_gzip=row["ours_gzip_bytes"] / row["equal_gzip_bytes"])
        yield row


def best_whole_file(rows, right=RIGHT):
    """The smallest one whose pictures are those of the scene, and the smallest one."""
    known = [row for row in rows if row["wrong_percent"] is not None and row["wrong_percent"] <= right]
    return (min(some, key=lambda row: row["smallest_bytes"], default=None) for some in (known, rows))


# --- tables


def kb(number):
    return f"{number / 1000:.1f}"


def cells(values):
    print("| " + " | ".join("" if value is None else value if isinstance(value, str) else f"{value:.3g}" for value in values) + " |")


def print_tables(whole, streams, containers):
    cells(["scene", "file", "grid, mm", "KB", "gzip", "zstd", "brotli", *(f"s at {rate}" for rate in RATES), "wrong, %", "worst"])
    print("|---" * (9 + len(RATES)) + "|")
    for row in whole:
        sizes = [row[f"{name}_bytes"] for name in ("as_it_is", "gzip", "zstd", "brotli")]
        cells([row["scene"], row["method"], 1000 * row["grid"], *(size and kb(size) for size in sizes),
               *(f"{row[f'seconds_{rate}']:.2f}" for rate in RATES), row["wrong_percent"], row["worst_percent"]])
    print()
    cells(["scene", "pages", "requests", "views", "wrong, %", "KB until 99 %", "99.9 %", "cell", *(f"s until 99 % at {rate}" for rate in RATES),
           *(f"99.9 % at {rate}" for rate in RATES), "best right file", "KB", *(f"times sooner, 99 %, at {rate}" for rate in RATES),
           *(f"99.9 %, at {rate}" for rate in RATES)])
    print("|---" * (10 + 4 * len(RATES)) + "|")
    for row in streams:
        best, _ = best_whole_file([one for one in whole if one["scene"] == row["scene"]])
        keys = [f"{level}_{rate}" for level in ("99", "99_9") for rate in RATES]
        cells([row["scene"], row["pages"], row["requests"], str(row["views"]), row["wrong_percent"], *(kb(row[f"bytes_{key}"]) for key in STREAMED),
               *(f"{row[f'seconds_{key}']:.2f}" for key in keys), best and best["method"], best and kb(best["smallest_bytes"]),
               *(best and f"{best['seconds_' + key.split('_')[-1]] / row[f'seconds_{key}']:.2f}" for key in keys)])
    print()
    for row in containers:
        print(", ".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items()))


def measure(options, kept, tools, named):
    files = kept.scene(options, named)
    if files is None:
        log(f"{named} is not there")
        return None
    scene, pvs = files
    name = os.path.splitext(os.path.basename(scene))[0]
    pictures = Pictures(options, tools, scene, pvs)
    site_folder = kept.site(options, scene, pvs)
    site = streamed_scene.open_site(site_folder)
    whole = list(whole_files(tools, pictures, name, scene, options.only))
    of = orders.Scene(site.front, stream_poses.pages_of_scene(scene, site), site.front.page_bytes)
    poses = stream_poses.read_poses(kept.poses(options, scene, pvs))
    wrong = pictures.wrong(rebuilt(options, kept, scene, pvs) if options.picture_poses else None)
    sizes = {encoding: site.sent_page_bytes(accepted) for encoding, accepted in bench_streaming.ENCODINGS.items()}
    streams = [{**streamed(name, of, site, poses, encoding, some, requests), **wrong}
               for encoding, some in sizes.items() for requests in REQUESTS]
    return whole, streams, list(container(tools, name, scene, site))


def rebuilt(options, kept, scene, pvs):
    """One .glb of all pages, with images."""
    size = ["--page-size", str(options.page_size)] if options.page_size else []
    site = kept.make("images", "sightcell", [scene, pvs], size, lambda part: ["pack", "--stream", scene, pvs, "-o", part])
    path = os.path.join(os.path.dirname(site), "rebuilt.glb")
    if not os.path.exists(path):
        program = os.path.join(result_files.ROOT, "tests", "stream", "rebuilt_glb.py")
        subprocess.run([sys.executable, program, site, path + ".part"], check=True)
        os.replace(path + ".part", path)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    for name in COMMANDS:
        parser.add_argument("--" + name.replace("_", "-"), metavar="FILE")
    parser.add_argument("--poses", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--page-size", type=int)
    parser.add_argument("--picture-poses", type=int, default=8)
    parser.add_argument("--limit", type=int, default=300)
    parser.add_argument("--only", metavar="REGEX", help="of whole files, those whose name it finds")
    parser.add_argument("--quick", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("scenes", nargs="*")
    options = parser.parse_args()
    options.poses = options.poses or (8 if options.quick else 200)
    options.page_size = options.page_size or (bench_streaming.QUICK_PAGES if options.quick else None)
    kept = bench_streaming.Kept(options.bin)
    tools, tables = Tools(options, kept), ([], [], [])
    if not options.scenes:
        options.scenes = [kept.make("town.glb", "sightcell-city", [], ["--polygons", "20000", "--seed", "1"],
                                    lambda part: ["--out", part])]
    for named in options.scenes:
        for table, rows in zip(tables, measure(options, kept, tools, named) or ((), (), ())):
            table.extend(rows)
    if not tables[1]:
        print("skipped: no scenes; SIGHTCELL_DATA names the folder of real scenes")
        return 77
    print_tables(*tables)
    notes = [", ".join(f"{name} {version}" for name, version in tools.versions.items() if name in VERSIONS),
             f"{options.poses} random poses in each scene, four views of 60 degrees from each; pictures from {options.picture_poses}. "
             "Without images, but for the pictures."]
    for name, what, rows in (("whole_files", "Whole files: bytes, seconds until all of it is there by Mbit/s, wrong pixels.", tables[0]),
                             ("whole_files_streamed", "The streamed scene on the same connection, in the mean over views.", tables[1]),
                             ("whole_files_container", "All files of a streamed scene beside gltfpack's file.", tables[2])):
        if rows:
            result_files.write(options.results, name, what, rows, notes)
    return 0


if __name__ == "__main__":
    sys.exit(main())
