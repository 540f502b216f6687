#!/usr/bin/python3
"""How a bake grows: with cells, with polygons, and what a farm would take.

usage: bench_scale.py --bin FOLDER [--part cells city polygons stages sets farm ...] [--quick] [--results DIR]
                      [--json-file OUT.json]

--bin: the folder with sightcell, sightcell-city, bench_stages and bench_sets. Everything is baked with --source cpu.

  cells     our city of 5,000 polygons, 10,240 cells of 1 m in two layers. The same cells in one bake, in two of half as
            many, in four, in eight, all in whole blocks: rows differ in the size of a bake and in nothing else
  city      the same with the preset vienna8m (7,928,519 polygons): 512 cells of 4 m around a crossroads, in four blocks
  polygons  100,000 polygons, vienna800k and vienna8m: one block of cells at a crossroads each, default settings
  stages    what comes before the first cell, by scene: CPU seconds and bytes per polygon (bench_stages)
  sets      10,000 records of 30,000 polygons each through checkpoint and writer, without rendering (bench_sets)
  farm      what 10,000 and 100,000 cells would take on 100 machines of 2 and of 16 cores, computed from the others

cells and city are baked with cheap samples (CHEAP below), polygons with the defaults. Rows are kept under $SIGHTCELL_CACHE
(default build/cache) by content: programs, scene and options; a bench that was stopped goes on after the last finished bake.
--quick: small scenes, few cells, in a minute; its numbers say nothing.

Memory is the largest resident set of the child; the checkpoint is looked at ten times a second, so that its last growth
can be missed. CPU seconds are those of all threads, everything included from import to writing.
"""
import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
import threading
import time

import result_files

CHEAP = ["--samples", "6", "--resolution", "64", "--max-pixel-error", "1e-2"]
POLYGONS = {"town5k": 5_000, "town100k": 100_000, "vienna800k": 865_979, "vienna8m": 7_928_519}
QUICK = {"vienna8m": "town100k", "vienna800k": "town5k"}  # what stands for what with --quick
# Parts with rows that are written as CSV files; stages and sets have steps inside their rows.
WHAT = {"cells": "How CPU time and memory grow with cells, 5,000 polygons.", "city": "The same with 7,928,519 polygons.",
        "polygons": "One block of cells by polygons of the scene.", "farm": "What a farm would take, computed from the others."}
PARTS = ["cells", "city", "polygons", "stages", "sets", "farm"]


def say(text):
    print(f"bench_scale: {text}", file=sys.stderr, flush=True)


def fail(text):
    sys.exit(f"bench_scale: {text}")


def run(command, watched=()):
    """Runs a command; gives its standard output, CPU seconds, largest resident set and the most bytes that the files
    watched had together."""
    try:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    except FileNotFoundError:
        fail(f"{command[0]} is not there; build it: cmake --build --preset release")
    largest, ended = [0], threading.Event()

    def watch():
        while not ended.wait(0.1):
            try:
                largest[0] = max(largest[0], sum(os.path.getsize(f) for f in watched if os.path.exists(f)))
            except OSError:  # it has just gone
                pass

    watcher = threading.Thread(target=watch, daemon=True)
    errors = []
    reader = threading.Thread(target=lambda: errors.append(process.stderr.read()), daemon=True)
    reader.start()
    if watched:
        watcher.start()
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    ended.set()
    reader.join()
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 3):
        fail(f"{' '.join(command)} ended with {process.returncode}: {''.join(errors).strip().splitlines()[-1:]}")
    return output, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, largest[0]


def digest(*parts):
    """Of files' contents and of words."""
    total = hashlib.sha256()
    for part in parts:
        if os.path.exists(part):
            with open(part, "rb") as stream:
                while block := stream.read(1 << 22):
                    total.update(block)
        else:
            total.update(part.encode())
        total.update(b"\0")
    return total.hexdigest()[:24]


class Bench:
    def __init__(self, options):
        self.options = options
        self.cache = os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "bench_scale")
        os.makedirs(self.cache, exist_ok=True)
        self.digests = {}

    def program(self, name):
        return os.path.join(self.options.bin, name)

    def digest_of(self, path):
        if path not in self.digests:
            self.digests[path] = digest(path)
        return self.digests[path]

    def remembered(self, what, files, words, measure):
        """What measure() gave for these files and words, now or in an earlier run."""
        key = digest(*(self.digest_of(f) for f in files), *words)
        path = os.path.join(self.cache, key + ".json")
        if not os.path.exists(path):
            say(what)
            began = time.monotonic()
            result = measure()
            with open(path + ".part", "w", encoding="utf-8") as stream:
                json.dump(result, stream)
            os.replace(path + ".part", path)
            say(f"{what}: {time.monotonic() - began:.0f} s")
        with open(path, encoding="utf-8") as stream:
            return json.load(stream)

    def scene(self, name):
        """The scene and its named cells, made where they are not there yet."""
        if self.options.quick:
            name = QUICK.get(name, name)
        path, cells = (os.path.join(self.cache, name + end) for end in (".glb", ".cells.json"))
        if not (os.path.exists(path) and os.path.exists(cells)):
            kind = ["--preset", name] if name.startswith("vienna") else ["--polygons", str(POLYGONS[name])]
            run([self.program("sightcell-city"), *kind, "--seed", "1", "--out", path + ".part", "--cells", cells])
            os.replace(path + ".part", path)
        return path, cells

    def bake(self, name, grid, more):
        scene, _ = self.scene(name)
        words = ["--cells-grid", ",".join(f"{v:g}" for v in grid), *more, "--source", "cpu"]

        def measure():
            with tempfile.TemporaryDirectory(prefix="sightcell-scale-") as folder:
                out = os.path.join(folder, "out.pvs")
                said, cpu, memory, checkpoint = run(
                    [self.program("sightcell"), "bake", scene, "-o", out, *words, "--progress", "none", "--json"],
                    (out + ".bake", out + ".bake-wal"))
            summary = json.loads(said)
            return {"cpu": cpu, "memory": memory, "checkpoint": checkpoint, "file": summary["bytes"],
                    "cells": summary["cells"], "left_out": summary["cells_left_out"],
                    "visible": summary["visible_set_percent"], "polygons": summary["polygons"]}

        return self.remembered(f"{os.path.basename(scene)} {' '.join(words)}", [self.program("sightcell"), scene], words,
                               measure)

    def stages(self, name, threads):
        scene, _ = self.scene(name)
        words = [scene, "--threads", str(threads)]
        return self.remembered(f"stages of {os.path.basename(scene)}, {threads} threads",
                               [self.program("bench_stages"), scene], words[1:],
                               lambda: json.loads(run([self.program("bench_stages"), *words])[0]))


def strips(box, axis, count):
    """The box in so many equal parts along an axis."""
    low, high = box[axis], box[axis + 3]
    for i in range(count):
        part = list(box)
        part[axis], part[axis + 3] = low + (high - low) * i / count, low + (high - low) * (i + 1) / count
        yield part


def pieces_of(box, count, block):
    """So many equal parts of a box: along z first, then along x, so that blocks of that width stay whole."""
    along_z = min(count, round((box[5] - box[2]) / block))
    return [piece for strip in strips(box, 2, along_z) for piece in strips(strip, 0, count // along_z)]


def by_cells(bench, name, box, counts, block, more):
    """Rows of the same cells in count bakes each."""
    rows = []
    for count in counts:
        bakes = [bench.bake(name, piece, more) for piece in pieces_of(box, count, block)]
        asked = sum(b["cells"] + b["left_out"] for b in bakes)
        rows.append({"bakes": count, "asked": asked / count, "stored": sum(b["cells"] for b in bakes) / count,
                     "cpu": sum(b["cpu"] for b in bakes) / count, "per_cell": sum(b["cpu"] for b in bakes) / asked,
                     "memory": max(b["memory"] for b in bakes), "file": sum(b["file"] for b in bakes) / count,
                     "checkpoint": sum(b["checkpoint"] for b in bakes) / count,
                     "visible": sum(b["visible"] * b["cells"] for b in bakes) / sum(b["cells"] for b in bakes)})
    return rows


def print_by_cells(title, rows):
    print(f"\n{title}\n")
    print("| cells asked for | stored | bakes | CPU s of a bake | CPU s per cell | against the smallest | peak memory |"
          " file per cell | checkpoint per cell |")
    print("|---|---|---|---|---|---|---|---|---|")
    for r in rows:
        print(f"| {r['asked']:,.0f} | {r['stored']:,.0f} | {r['bakes']} | {r['cpu']:,.1f} | {r['per_cell']:.4f} |"
              f" {100 * (r['per_cell'] / rows[0]['per_cell'] - 1):+.1f} % | {r['memory'] / 2**20:,.1f} MiB |"
              f" {r['file'] / r['stored']:,.0f} | {r['checkpoint'] / r['stored']:,.0f} |")


def crossroads(bench, name, blocks, layers):
    """A box of so many blocks of 4 m cells (x, z) around the first crossroads of a town, from its ground up."""
    with open(bench.scene(name)[1], encoding="utf-8") as stream:
        cells = json.load(stream)["cells"]
    cell = next((c for c in cells if c["name"].startswith("crossroads")), cells[0])
    middle = [(low + high) / 2 for low, high in zip(cell["min"], cell["max"])]
    first = [32 * round(middle[axis] / 32 - blocks[axis // 2] / 2) for axis in (0, 2)]
    floor = 2 * ((cell["min"][1] + 0.5) // 2)
    return [first[0], floor, first[1], first[0] + 32 * blocks[0], floor + 2 * layers, first[1] + 32 * blocks[1]]


def part_cells(bench):
    """10 x 8 blocks of 8 m, two layers of half a meter at eye height."""
    box = [-16, 1, -32, 16, 1.5, 32] if bench.options.quick else [-40, 1, -32, 40, 2, 32]
    rows = by_cells(bench, "town5k", box, [8, 1] if bench.options.quick else [8, 4, 2, 1], 8,
                    ["--cell-size", "1", *CHEAP])
    print_by_cells(f"5,000 polygons, {' '.join(CHEAP)}", rows)
    return rows


def part_city(bench):
    box = crossroads(bench, "vienna8m", (2, 2), 1 if bench.options.quick else 2)
    rows = by_cells(bench, "vienna8m", box, [4, 2, 1], 32, CHEAP)
    print_by_cells(f"vienna8m, {' '.join(CHEAP)}", rows)
    return rows


def part_polygons(bench):
    rows = []
    for name in ("town100k", "vienna800k", "vienna8m"):
        more = CHEAP if bench.options.quick else []
        rows.append(bench.bake(name, crossroads(bench, name, (1, 1), 1), more))
    print("\none block at a crossroads, default settings; without what comes before the first cell (stages)\n")
    print("| polygons | cells asked for | stored | CPU s | before the first cell | CPU s per cell | polygons per set |"
          " peak memory | bytes per polygon | file per cell | checkpoint per cell |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for name, r in zip(("town100k", "vienna800k", "vienna8m"), rows):
        r["before"] = sum(s["cpu"] for s in bench.stages(name, 1)["stages"])
        asked = r["cells"] + r["left_out"]
        r["per_cell"] = (r["cpu"] - r["before"]) / asked
        print(f"| {r['polygons']:,} | {asked} | {r['cells']} | {r['cpu']:.1f} | {r['before']:.1f} | {r['per_cell']:.3f} |"
              f" {r['visible'] * r['polygons'] / 100:,.0f} | {r['memory'] / 2**20:,.0f} MiB |"
              f" {r['memory'] / r['polygons']:.0f} | {r['file'] / max(r['cells'], 1):,.0f} |"
              f" {r['checkpoint'] / max(r['cells'], 1):,.0f} |")
    return rows


def parallel_share(bench, name):
    """Of what comes before the first cell: of two threads the second computes half of what is parallel."""
    stages = bench.stages(name, 2)["stages"]
    return min(2 * sum(s["workers"] for s in stages) / sum(s["cpu"] for s in stages), 1.0)


def part_stages(bench):
    table = [bench.stages(name, 1) for name in ("town100k", "vienna800k", "vienna8m")]
    print("\nbefore the first cell, one thread: CPU s, and bytes per polygon that stay (at most while it is built)\n")
    print("| stage | " + " | ".join(f"{t['polygons']:,} polygons" for t in table) + " |")
    print("|---|" + "---|" * len(table))
    for i, stage in enumerate(table[0]["stages"]):
        cells = (f"{t['stages'][i]['cpu']:.2f} s, {t['stages'][i]['stays'] / t['polygons']:.0f}"
                 f" ({t['stages'][i]['peak'] / t['polygons']:.0f})" for t in table)
        print(f"| {stage['stage']} | " + " | ".join(cells) + " |")
    shares = [parallel_share(bench, name) for name in ("town100k", "vienna800k", "vienna8m")]
    print("| parallel | " + " | ".join(f"{100 * s:.0f} %" for s in shares) + " |")
    return table


def part_sets(bench):
    words = ["--cells", "200" if bench.options.quick else "10000", "--ids", "30000"]

    def measure():
        with tempfile.TemporaryDirectory(prefix="sightcell-scale-") as folder:
            return json.loads(run([bench.program("bench_sets"), "--folder", folder, *words])[0])

    row = bench.remembered(f"sets {' '.join(words)}", [bench.program("bench_sets")], words, measure)
    print(f"\n{row['cells']:,} records of {row['ids']:,} polygons, {row['cells'] * row['ids'] * 4 / 2**20:,.0f} MiB"
          " uncompressed\n")
    print("| step | CPU s | peak memory | bytes on the disk |")
    print("|---|---|---|---|")
    for step in row["steps"]:
        print(f"| {step['step']} | {step['cpu']:.1f} | {step['peak'] / 2**20:,.1f} MiB | {step['bytes']:,} |")
    return row


def part_farm(bench):
    """Every shard pays for what comes before the first cell, in each of the two phases; that part of it which is not
    parallel does not get shorter with cores. Cells are taken to use all cores."""
    rows = []
    print("\na farm, computed: 2 x (what comes before the first cell) + cells, one shard per machine\n")
    print("| polygons | cells | CPU h of cells | machines | cores | wall | CPU spent beside cells |"
          " shards at which half of the wall time is beside cells |")
    print("|---|---|---|---|---|---|---|---|")
    for name in ("town100k", "vienna800k", "vienna8m"):
        bake = bench.bake(name, crossroads(bench, name, (1, 1), 1), CHEAP if bench.options.quick else [])
        before = sum(s["cpu"] for s in bench.stages(name, 1)["stages"])
        share = parallel_share(bench, name)
        per_cell = (bake["cpu"] - before) / (bake["cells"] + bake["left_out"])
        for cells in (10_000, 100_000):
            for machines, cores in ((1, 2), (1, 16), (100, 2), (100, 16)):
                fixed = 2 * before * (1 - share + share / cores)
                work = per_cell * cells / cores
                row = {"polygons": bake["polygons"], "cells": cells, "machines": machines, "cores": cores,
                       "wall": fixed + work / machines, "beside": 2 * before * machines / (per_cell * cells),
                       "shards_that_pay": work / fixed}
                rows.append(row)
                print(f"| {row['polygons']:,} | {cells:,} | {per_cell * cells / 3600:.1f} | {machines} | {cores} |"
                      f" {row['wall'] / 60:,.1f} min | {100 * row['beside']:.1f} % | {row['shards_that_pay']:,.0f} |")
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--part", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--quick", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("--json-file")
    options = parser.parse_args()
    bench = Bench(options)
    found = {part: globals()["part_" + part](bench) for part in PARTS if part in options.part}
    for part, rows in found.items():
        if part in WHAT:
            result_files.write(options.results, "growth_" + part, WHAT[part], rows)
    if options.json_file:
        with open(options.json_file, "w", encoding="utf-8") as stream:
            json.dump(found, stream, indent=1)


if __name__ == "__main__":
    main()
