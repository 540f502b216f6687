#!/usr/bin/python3
"""Bakes every scene of $SIGHTCELL_DATA (malformed/ aside) at a small budget, and compares pairs that should be the same.

usage: bench_data.py --bin FOLDER [--lib libsightcell.so] [--only TEXT] [--no-table] [--no-pairs] [--cell-limit 12]
                     [--results DIR]

--bin: programs sightcell, and for the pairs dump_triangles and sightcell-test-polygon-shares. --only: files whose path
contains the text. Results are kept in $SIGHTCELL_CACHE (default: sightcell-cache in the folder for temporary files)
under the hash of scene, program and settings; a second run takes from there what is done.
Table: polygons must be as many as in tests/bench/results/real_scenes.csv, the upper bound of `verify` at most 1e-3. Pairs: see pair_sets.py;
sets of a converged bake of the same cells, and of another seed of the same file as the noise floor.
Exit code 1 when something is over its bound, 77 without data.
"""
import argparse
import hashlib
import json
import os
import struct
import subprocess
import sys
import tempfile

import instances_as_nodes
import pair_sets
import result_files

BOUND = 1e-3
# first, second, tolerance of corners in meters (of the quantization), bound of the difference in percent
# NODES as second: the first, with a node for every instance.
NODES = "with instances as nodes"
PAIRS = [("instancing/temple.instanced.glb", NODES, 1e-3, 0.1),
         ("foliage/temple.glb", "instancing/temple.instanced.glb", 1e-3, 0.1),
         ("features/denhaag_01.quantized.glb", "city/denhaag_01.glb", 0.05, 1.0),
         ("city/candela_city.glb", "draco/candela_city.draco.glb", 0.1, 1.0)]


def sha256(path):
    digest = hashlib.sha256()
    with open(path, "rb") as source:
        while block := source.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


class RunCache:
    """Runs programs once: what they gave lies under the hash of scene, program and settings."""

    def __init__(self, folder, cache):
        self.folder, self.cache, self.hashes = folder, cache, {}

    def hash_of(self, path):
        if path not in self.hashes:
            self.hashes[path] = sha256(path)
        return self.hashes[path]

    def place(self, program, scene, settings):
        parts = [self.hash_of(os.path.join(self.folder, program)), self.hash_of(scene), *settings]
        place = os.path.join(self.cache, hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32])
        os.makedirs(place, exist_ok=True)
        return place

    def bake(self, scene, settings, cells=None):
        """The .pvs file, the program's summary and what it cost."""
        place = self.place("sightcell", scene, settings + ([self.hash_of(cells)] if cells else []))
        output, summary = os.path.join(place, "out.pvs"), os.path.join(place, "summary.json")
        if not os.path.exists(summary):
            command = [os.path.join(self.folder, "sightcell"), "bake", scene, "-o", output, "--profile", "exact", "--json", "--progress",
                       "none", *settings, *(["--cells-file", cells] if cells else [])]
            text, usage = run(command)
            keep(summary, {**json.loads(text), "cpu": usage.ru_utime + usage.ru_stime, "memory": usage.ru_maxrss * 1024})
        return output, load(summary)

    def verify(self, scene, pvs, rays):
        place = self.place("sightcell", scene, ["verify", self.hash_of(pvs), str(rays)])
        summary = os.path.join(place, "verify.json")
        if not os.path.exists(summary):
            text, _ = run([os.path.join(self.folder, "sightcell"), "verify", scene, pvs, "--rays", str(rays), "--json",
                           "--picture", place])
            keep(summary, json.loads(text))
        return load(summary)

    def triangles(self, scene):
        output = os.path.join(self.place("dump_triangles", scene, []), "triangles.f32")
        if not os.path.exists(output):
            run([os.path.join(self.folder, "dump_triangles"), scene, output + ".part"])
            os.replace(output + ".part", output)
        return pair_sets.read_triangles(output)

    def shares(self, scene, pvs, cell, rays):
        """Which polygons fresh rays of a cell see: (polygon, share of all rays)."""
        program = "sightcell-test-polygon-shares"
        output = os.path.join(self.place(program, scene, [self.hash_of(pvs), str(cell), str(rays)]), "shares.json")
        if not os.path.exists(output):
            text, _ = run([os.path.join(self.folder, program), scene, pvs, str(cell), str(rays)])
            keep(output, [[int(line.split()[0]), float(line.split()[1])] for line in text.splitlines()])
        return load(output)


def keep(path, value):
    with open(path + ".part", "w", encoding="utf-8") as out:
        json.dump(value, out)
    os.replace(path + ".part", path)


def load(path):
    with open(path, encoding="utf-8") as source:
        return json.load(source)


def run(command):
    """Standard output and rusage. Exit code 3 (a bound was not met) is a result too."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        child = subprocess.Popen(command, stdout=out, stderr=err)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0), err.seek(0)
        if child.returncode not in (0, 3):
            lines = err.read().decode(errors="replace").splitlines()
            raise Failed(f"{os.path.basename(command[0])} {command[1]} ended with {child.returncode}: "
                         f"{lines[-1] if lines else 'nothing said'}")
        return out.read().decode(), usage


class Failed(Exception):
    pass


def recorded_polygons():
    """Of the published table: path -> polygons."""
    _, rows = result_files.read(os.path.join(result_files.FOLDER, "real_scenes.csv"))
    return {row["file"]: int(row["polygons"]) for row in rows}


def extensions_of(path):
    with open(path, "rb") as source:
        head = source.read(20)
        return json.loads(source.read(struct.unpack_from("<I", head, 12)[0])).get("extensionsUsed", [])


def scene_files(data):
    found = []
    for place, _, names in os.walk(data):
        found += [os.path.relpath(os.path.join(place, name), data) for name in names if name.endswith((".glb", ".gltf"))]
    return sorted(path for path in found if not path.startswith("malformed" + os.sep))


def small_budget(options):
    return ["--cell-limit", str(options.cell_limit), "--max-pixel-error", "1e-3", "--seed", "1"]


def table_row(runs, options, path, recorded):
    """The row and what is wrong with it."""
    scene = os.path.join(options.data, path)
    try:
        pvs, baked = runs.bake(scene, small_budget(options))
        proof = runs.verify(scene, pvs, options.rays)
    except Failed as failed:
        return None, [f"{path}: {failed}"]
    wrong = []
    if recorded is not None and baked["polygons"] != recorded:
        wrong.append(f"{path}: {baked['polygons']} polygons, real_scenes.csv has {recorded}")
    if not proof["upper_bound"] <= BOUND:
        wrong.append(f"{path}: pixel error up to {proof['upper_bound']:.2e}")
    return {"file": path, "polygons": baked["polygons"], "extensions": ", ".join(extensions_of(scene)) or "none",
            "cells": baked["cells"], "visible_percent": baked["visible_set_percent"], "upper_bound": proof["upper_bound"],
            "cpu_seconds": baked["cpu"], "peak_mib": baked["memory"] / (1 << 20)}, wrong


def write_table(runs, options, files):
    recorded = recorded_polygons()
    wrong = [f"{path}: in real_scenes.csv but not there" for path in recorded if path not in files and not options.only]
    print("| file | polygons | extensions used | cells | drawn % | upper bound | CPU s | peak MiB |")
    print("|---|---|---|---|---|---|---|---|")
    rows = []
    for path in files:
        row, problems = table_row(runs, options, path, recorded.get(path))
        wrong += problems
        if row is None:
            print(f"| {path} | | | | | | | {problems[0]} |", flush=True)
            continue
        rows.append(row)
        print(f"| {path} | {row['polygons']:,} | {row['extensions']} | {row['cells']} | {row['visible_percent']:.2f} "
              f"| {row['upper_bound']:.1e} | {row['cpu_seconds']:.1f} | {row['peak_mib']:.0f} |", flush=True)
    if rows:
        result_files.write(options.results, "real_scenes", f"Every real scene: {' '.join(small_budget(options))}, verified with "
                           f"{options.rays:,} rays.", rows)
    return wrong


def pair_row(runs, options, first, second, tolerance, bound):
    """The row and what is wrong with it."""
    paths = [os.path.join(options.data, path) for path in (first, second)]
    if second == NODES:
        paths[1] = os.path.join(runs.place("sightcell", paths[0], [NODES]), "nodes.glb")
        instances_as_nodes.write_with_nodes(paths[0], paths[1])
    a, b = (runs.triangles(path) for path in paths)
    partner = pair_sets.match(a, b, tolerance)
    pvs, _ = runs.bake(paths[0], ["--cell-limit", str(options.pair_cells), "--max-pixel-error", "1e-3", "--seed", "1"])
    boxes = pair_sets.Sets(options.lib, pvs).boxes
    cells = os.path.join(os.path.dirname(pvs), "cells.json")
    keep(cells, {"cells": [{"name": f"c{i}", "min": box[0].tolist(), "max": box[1].tolist()}
                           for i, box in enumerate(boxes)]})
    settings = ["--max-pixel-error", options.pair_error, "--samples", str(options.pair_samples)]
    files = [runs.bake(path, settings + ["--seed", str(seed)], cells)[0]
             for path, seed in ((paths[0], 1), (paths[0], 2), (paths[1], 1))]
    one, again, other = (pair_sets.Sets(options.lib, file) for file in files)

    def shares(cell):
        return runs.shares(paths[0], files[0], cell, options.pair_rays)
    noise = pair_sets.compare(one, again, pair_sets.np.arange(len(a)), shares)
    difference = pair_sets.compare(one, other, partner, shares)
    by_polygons, by_rays = pair_sets.percent(difference)
    noise_polygons, noise_rays = pair_sets.percent(noise)
    print(f"| {first}, {second} | {len(a):,} / {len(b):,} | {int((partner < 0).sum()):,} | {difference['cells']} "
          f"| {by_polygons:.3f} | {noise_polygons:.3f} | {by_rays:.5f} | {noise_rays:.5f} | {bound} |", flush=True)
    wrong = []
    if len(a) != len(b):
        wrong.append(f"{first}, {second}: {len(a)} and {len(b)} polygons")
    if by_polygons > bound:
        wrong.append(f"{first}, {second}: sets differ by {by_polygons:.3f} % of their polygons, {by_rays:.5f} % of the rays; "
                     f"another seed of the first by {noise_polygons:.3f} % and {noise_rays:.5f} %")
    return {"first": first, "second": second, "settings": f"{options.pair_error}, {options.pair_samples} samples",
            "polygons_first": len(a), "polygons_second": len(b), "unmatched": int((partner < 0).sum()),
            "cells": difference["cells"], "differ_percent_of_polygons": by_polygons,
            "other_seed_percent_of_polygons": noise_polygons, "differ_percent_of_rays": by_rays,
            "other_seed_percent_of_rays": noise_rays}, wrong


def write_pairs(runs, options):
    print("\n| pair | polygons | unmatched | cells | differ, % of polygons | another seed | differ, % of rays | another seed "
          "| bound |")
    print("|---|---|---|---|---|---|---|---|---|")
    rows, wrong = [], []
    for first, second, tolerance, bound in PAIRS:
        if options.only in first + ", " + second:
            row, problems = pair_row(runs, options, first, second, tolerance, bound)
            rows.append(row)
            wrong += problems
    if rows:
        result_files.write(options.results, "pairs", "Two files of one scene: by how much their cell sets differ, beside two seeds of the "
                           "first file.", rows)
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--lib", help="default: ../lib/libsightcell.so beside --bin")
    parser.add_argument("--data", default=os.environ.get("SIGHTCELL_DATA", ""))
    parser.add_argument("--only", default="")
    parser.add_argument("--no-table", action="store_true")
    parser.add_argument("--no-pairs", action="store_true")
    parser.add_argument("--cell-limit", type=int, default=12)
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--pair-cells", type=int, default=6)
    parser.add_argument("--pair-error", default="1e-5")
    parser.add_argument("--pair-samples", type=int, default=200)
    parser.add_argument("--pair-rays", type=int, default=1_000_000)
    result_files.add_option(parser)
    options = parser.parse_args()
    options.lib = options.lib or os.path.join(options.bin, "..", "lib", "libsightcell.so")
    all_files = scene_files(options.data) if options.data else []
    files = [path for path in all_files if options.only in path]
    if not all_files:
        print("skipped: no scenes; SIGHTCELL_DATA names the folder of real scenes")
        return 77
    cache = os.environ.get("SIGHTCELL_CACHE") or os.path.join(tempfile.gettempdir(), "sightcell-cache")
    runs = RunCache(options.bin, cache)
    wrong = [] if options.no_table else write_table(runs, options, files)
    if not options.no_pairs:
        wrong += write_pairs(runs, options)
    for line in wrong:
        print(f"FAILED {line}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
