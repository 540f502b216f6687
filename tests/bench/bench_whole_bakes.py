#!/usr/bin/python3
"""Whole scenes baked with automatic cells: what a user of `sightcell bake SCENE` waits for and gets.

usage: bench_whole_bakes.py --bin FOLDER [--threads N] [--quality Q] [--results DIR] SCENE.glb [SCENE.glb ...]

--bin: the folder with sightcell. SCENE: a path, or a name below $SIGHTCELL_DATA. A bake may take hours: results are kept
in $SIGHTCELL_CACHE (default: build/cache) under the hash of scene, program and options. A bake that was interrupted goes
on from its checkpoint, and its CPU seconds are the sum of all runs, so cells that a stop discarded count twice.

  cells           cells in the file
  cpu_seconds     of the whole command: import, cells, sets, file
  median, longest CPU seconds of single cells (blank where the bake was interrupted: they are of its last run)
  largest_bound   largest 95 % upper bound of any cell; over_bound: cells whose bound is above what was asked for

Exit code 77 where all scenes are missing.
"""
import argparse
import glob
import hashlib
import json
import os
import resource
import subprocess
import sys

import result_files


def children_cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def scene_path(name):
    """The file, or None where it is missing."""
    if os.path.exists(name):
        return name
    data = os.environ.get("SIGHTCELL_DATA")
    found = glob.glob(os.path.join(glob.escape(data), "**", name), recursive=True) if data else []
    return found[0] if found else None


def key_of(options, scene):
    total = hashlib.sha256(f"{options.threads} {options.quality}".encode())
    for path in (os.path.join(options.bin, "sightcell"), scene):
        with open(path, "rb") as stream:
            while block := stream.read(1 << 22):
                total.update(block)
    return total.hexdigest()[:16]


def bake(options, scene, stem):
    """The result of `bake --json` and the CPU seconds of each run."""
    runs_file, json_file = stem + ".runs", stem + ".json"
    if not os.path.exists(json_file):
        before = children_cpu()
        try:
            done = subprocess.run([os.path.join(options.bin, "sightcell"), "bake", scene, "-o", stem + ".pvs", "--quality",
                                   options.quality, "--threads", str(options.threads), "--json-file", json_file],
                                  check=False)
        finally:
            with open(runs_file, "a", encoding="utf-8") as stream:
                stream.write(f"{children_cpu() - before:.1f}\n")
        if done.returncode not in (0, 3):
            if os.path.exists(json_file):  # of a bake that was stopped
                os.remove(json_file)
            sys.exit(f"bench_whole_bakes: the bake of {scene} ended with {done.returncode}; run the command again to go on")
    with open(json_file, encoding="utf-8") as stream:
        result = json.load(stream)
    with open(runs_file, encoding="utf-8") as stream:
        return result, [float(line) for line in stream]


def row_of(scene, result, runs):
    cells, whole = result["cell_seconds"], len(runs) == 1
    return {
        "scene": os.path.splitext(os.path.basename(scene))[0],
        "polygons": result["polygons"],
        "cells": result["cells"],
        "visible_percent": round(result["visible_set_percent"], 3),
        "cpu_seconds": round(sum(runs)),
        "runs": len(runs),
        "median": round(cells["median"], 3) if whole else "",
        "percentile_99": round(cells["percentile_99"], 3) if whole else "",
        "longest": round(cells["longest"], 3) if whole else "",
        "largest_bound": f"{result['max_upper_bound']:.2e}",
        "over_bound": result["cells_over_bound"],
        "bytes": result["bytes"],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--quality", default="normal")
    parser.add_argument("scenes", nargs="+", metavar="SCENE.glb")
    result_files.add_option(parser)
    options = parser.parse_args()
    cache = os.path.abspath(os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "whole_bakes"))
    os.makedirs(cache, exist_ok=True)
    rows = []
    for name in options.scenes:
        scene = scene_path(name)
        if scene is None:
            print(f"{name} is skipped: it is neither here nor below SIGHTCELL_DATA", file=sys.stderr)
            continue
        row = row_of(scene, *bake(options, scene, os.path.join(cache, key_of(options, scene))))
        print(json.dumps(row), flush=True)
        rows.append(row)
    if not rows:
        return 77
    result_files.write(options.results, "whole_bakes",
                       f"Whole scenes, automatic cells, quality {options.quality}, threads: {options.threads}.", rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
