#!/usr/bin/python3
"""Frames of whole scenes along a recorded path: full draw, frustum by cluster, cell sets, and cell sets in the frustum.

usage: bench_frames.py --bin FOLDER [--scene NAME ...] [--frames N] [--cluster N] [--set-cluster N] [--again]
                       [--results DIR] [--json OUT.json]

--bin: the folder with sightcell, sightcell-city and bench_frames. Scenes: intel_castle and candela_city under
SIGHTCELL_DATA (said so where they are missing) and the city's preset vienna800k (seed 2); small-town when it is named.
Prints a Markdown table for each.

The path of vienna800k is frames/vienna800k.path; others are walked by bench_frames itself, from cell to adjacent cell and
the same each time. Only the cells that a path goes through are baked, as bench_format.py bakes its cells: those lie
spread over the scene, and no path stays in them. Paths, bakes and measured pieces of 50 frames are kept under
$SIGHTCELL_CACHE (default build/cache) by content; a run that was stopped goes on where it was. --again measures anew.

  full          a glDrawElements per draw group
  frustum       clusters whose box touches the frustum, a glMultiDrawElements per group
  pvs_commands  sightcell_view_commands, a glMultiDrawElementsIndirect per group
  pvs_indices   sightcell_view_indices into mapped memory, a glDrawElements per group
  pvs_frustum   the set sorted into clusters when the cell changes, and each frame those of them that touch the frustum
  cull          before any call that draws: moves, lists, frustum tests, at a change of cells also the upload of a list
  submit        cull and all calls; CPU time of the calling thread
  frame         submit and glFinish; CPU time of the program. Where the device is a software rasterizer this is mostly its
                own work, and submit has its vertices.
  pixel error   share of the pixels that show another place than the full draw, or other blended layers before it
  in place      share of those that show another surface of the same place (rule 2 of seeing)
"""
import argparse
import json
import os
import resource
import statistics
import sys

import bench_format
import result_files
import sampler_plan as plan
from bench_format import OPTIONS, bake_version, digest, fail, table, writer_code
from sampler_runs import hash_of

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = ["intel_castle", "candela_city", "vienna800k"]
WAYS = ["full", "frustum", "pvs_commands", "pvs_indices", "pvs_frustum"]
SEED = 1
PIECE = 50  # frames that are kept together


def say(text):
    print(f"bench_frames: {text}", file=sys.stderr, flush=True)


def children_cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def code_of(*names):
    """A hash of sources that decide a result."""
    return digest(*(hash_of(os.path.join(HERE, "frames", n)) for n in names))


class Bench:
    def __init__(self, options):
        self.options = options
        self.scenes = bench_format.Bench(options)
        self.run = self.scenes.run
        self.cache = os.path.abspath(os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "bench_frames"))
        os.makedirs(self.cache, exist_ok=True)

    def kept(self, name, suffix, make, *key):
        """A file by its content; make writes it under another name first."""
        stem = os.path.join(self.cache, f"{name}-{digest(*key)}")
        if not os.path.exists(stem + suffix):
            make(stem + ".part" + suffix)
            os.replace(stem + ".part" + suffix, stem + suffix)
        return stem + suffix

    def path(self, name, scene):
        recorded = os.path.join(HERE, "frames", name + ".path")
        if os.path.exists(recorded):
            return recorded
        words = ["--frames", str(self.options.frames), "--seed", str(SEED)]
        return self.kept(name, ".path", lambda out: self.run("bench_frames", "walk", scene, out, *words),
                         hash_of(scene), code_of("walk.cpp", "path_file.cpp"), bake_version(), *words)

    def baked(self, name, scene, path):
        """The merged file of the cells of a path, and what its bake took."""
        cells = self.kept(name, ".cells.json", lambda out: self.run("bench_frames", "cells", scene, path, out),
                          hash_of(scene), hash_of(path), code_of("walk.cpp"), bake_version())

        def bake(out):
            # Not under a new name: the checkpoint of a stopped bake goes by it.
            start = children_cpu()
            self.run("sightcell", "bake", scene, "-o", out, "--cells-file", cells, *OPTIONS, "--profile", "exact")
            with open(out + ".json", "w", encoding="utf-8") as stream:
                json.dump({"cpu_seconds": children_cpu() - start}, stream)

        key = (hash_of(scene), hash_of(cells), bake_version(), *OPTIONS)
        stem = os.path.join(self.cache, f"{name}-{digest(*key)}.pvs")
        if not os.path.exists(stem + ".json"):
            say(f"{name}: baking the cells of its path; when this is stopped, the next run goes on with it")
            bake(stem)
        merged = self.kept(name, ".merged.pvs", lambda out: self.run(
            "sightcell", "recode", stem, "--layout", "merged", "--scene", scene, "-o", out), hash_of(stem), writer_code())
        with open(stem + ".json", encoding="utf-8") as stream:
            return merged, json.load(stream)["cpu_seconds"]

    def piece(self, name, scene, pvs, path, first):
        words = [str(w) for w in ("--first", first, "--count", PIECE, "--cluster", self.options.cluster, "--set-cluster",
                                  self.options.set_cluster)]
        key = digest(hash_of(self.scenes.program("bench_frames")), hash_of(pvs), hash_of(path), *words)
        out = os.path.join(self.cache, f"{name}-{key}.frames.json")
        if self.options.again or not os.path.exists(out):
            say(f"{name}: frames {first} to {first + PIECE - 1}")
            self.run("bench_frames", "draw", scene, pvs, path, *words, "--json", out + ".part")
            os.replace(out + ".part", out)
        with open(out, encoding="utf-8") as stream:
            return json.load(stream)

    def measure(self, name):
        scene = self.scenes.scene(name)
        if not scene:
            return None
        path = self.path(name, scene)
        with open(path, encoding="utf-8") as stream:
            frames = sum(1 for line in stream if not line.startswith("#"))
        pvs, cpu = self.baked(name, scene, path)
        start = children_cpu()
        pieces = [self.piece(name, scene, pvs, path, first) for first in range(0, frames, PIECE)]
        result = {"name": name, "path": os.path.basename(path), "bake_cpu_seconds": cpu,
                  "cpu_seconds": children_cpu() - start, **pieces[0]}
        result["frames"] = [f for p in pieces for f in p["frames"]]
        return result


def percentile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def row_of(result, way):
    frames, pixels = [f[way] for f in result["frames"]], result["pixels"]
    changes = [f["cull_ms"] for f in frames if f["changed"]]
    row = {"scene": result["name"], "method": way}
    row.update((key, statistics.fmean(f[key] for f in frames)) for key in ("polygons", "draws", "calls"))
    for name, values in (("cull", [f["cull_ms"] for f in frames]), ("submit", [f["cull_ms"] + f["issue_ms"] for f in frames]),
                         ("frame", [f["frame_ms"] for f in frames])):
        row.update({name + "_ms_median": statistics.median(values), name + "_ms_99": percentile(values, 0.99)})
    compared = way != "full"
    row.update({"cull_ms_at_change": statistics.median(changes) if changes else None,
                "pixel_error_mean": statistics.fmean(f["differing"] for f in frames) / pixels if compared else None,
                "pixel_error_max": max(f["differing"] for f in frames) / pixels if compared else None,
                "in_place": statistics.fmean(f["in_place"] for f in frames) / pixels if compared else None})
    return row


def frames_table(result, rows):
    def both(row, name):
        return f"{row[name + '_ms_median']:.3f} / {row[name + '_ms_99']:.3f}"

    def written(row):
        change, shares = row["cull_ms_at_change"], [row[key] for key in ("pixel_error_mean", "pixel_error_max", "in_place")]
        return [row["method"], *(f"{row[key]:,.0f}" for key in ("polygons", "draws", "calls")), both(row, "cull"),
                "" if change is None else f"{change:.3f}", both(row, "submit"), both(row, "frame"),
                *("" if share is None else f"{share:.1e}" for share in shares)]

    frames = result["frames"]
    table(f"{result['name']}: {result['polygons']:,} polygons in {result['groups']} draw groups, {len(frames)} frames through "
          f"{result['cells']} cells, {sum(f['outside'] for f in frames)} of them outside; {result['device']}; bake "
          f"{result['bake_cpu_seconds']:.0f} CPU s, frames {result['cpu_seconds']:.0f}",
          ["", "polygons", "draws", "calls", "cull ms: median / 99 %", "at a change", "submit ms", "frame ms", "pixel error: mean",
           "max", "in place"], [written(row) for row in rows])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--scene", nargs="+", choices=SCENES + [plan.TOWN], metavar="NAME", default=SCENES)
    parser.add_argument("--frames", type=int, default=400)
    parser.add_argument("--cluster", type=int, default=256)
    parser.add_argument("--set-cluster", type=int, default=256)
    parser.add_argument("--again", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("--json")
    options = parser.parse_args()
    bench = Bench(options)
    try:
        results = [r for r in map(bench.measure, options.scene) if r]
    except KeyboardInterrupt:
        fail("stopped; the next run goes on from here")
    if not results:
        fail("no scene is there")
    rows = []
    for result in results:
        rows += (own := [row_of(result, way) for way in WAYS])
        frames_table(result, own)
    result_files.write(options.results, "frames", f"Frames along a recorded path of {options.frames} frames.", rows,
                       [f"device: {results[0]['device']}"])
    if options.json:
        with open(options.json, "w", encoding="utf-8") as stream:
            json.dump(results, stream, indent=1)


if __name__ == "__main__":
    main()
