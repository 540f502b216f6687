#!/usr/bin/python3
"""Bakes scenes, verifies each file with fresh rays and prints one table row per scene.

usage: bench_scenes.py --bin FOLDER [--cell-limit 16] [--quick] [--results DIR] [--json-file OUT.json] SCENE...
                       [-- OPTION ...]

--bin: the folder with the program sightcell. --quick: 4 cells and a tenth of the rays. SCENE: .glb or .gltf; the word
"city" stands for our own city of 100,000 polygons (seed 1), made on the spot. After -- options of `sightcell bake`; without them its defaults.
Its table is in BENCHMARKS.md. Timings are CPU seconds of the whole process, all threads.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile

import result_files


# Columns of the published table.
PUBLISHED = ["scene", "polygons", "cells", "visible_percent", "pixel_error", "upper_bound", "bake_cpu_seconds_per_cell",
             "bits_per_visible_polygon"]


def run(command):
    """Runs a command; gives its standard output as JSON and the CPU seconds it took. Exit code 3 is a result too."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 3):
        sys.exit(f"bench_scenes: {' '.join(command)} ended with {done.returncode}")
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return json.loads(done.stdout), cpu


def make_city(folder, generator):
    path = os.path.join(folder, "city.glb")
    subprocess.run([generator, "--polygons", "100000", "--seed", "1", "--out", path], check=True,
                   stdout=subprocess.DEVNULL)
    return path


def measure(sightcell, scene, folder, cell_limit, rays, more):
    output = os.path.join(folder, "out.pvs")
    baked, bake_cpu = run([sightcell, "bake", scene, "-o", output, "--profile", "exact", "--cell-limit", str(cell_limit), "--fresh", "--json",
                           "--progress", "none", *more])
    info, _ = run([sightcell, "info", output, "--json"])
    proof, verify_cpu = run([sightcell, "verify", scene, output, "--rays", str(rays), "--json", "--picture", folder])
    return {
        "scene": os.path.splitext(os.path.basename(scene))[0],
        "polygons": info["polygons"],
        "cells": info["cells"],
        "visible_percent": baked["visible_set_percent"],
        "pixel_error": proof["pixel_error"],
        "upper_bound": proof["upper_bound"],
        "rays": proof["rays"],
        "largest_cell_bound": baked["max_upper_bound"],
        "bake_cpu_seconds_per_cell": bake_cpu / max(info["cells"], 1),
        "verify_cpu_seconds": verify_cpu,
        "bytes": info["bytes"],
        "bits_per_visible_polygon": info["bits_per_visible_polygon"],
        "device": baked["device"],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    parser.add_argument("--bin", required=True)
    parser.add_argument("--cell-limit", type=int, default=16)
    parser.add_argument("--quick", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("--json-file")
    own = sys.argv[1:]
    own, more = (own[:own.index("--")], own[own.index("--") + 1:]) if "--" in own else (own, [])
    options = parser.parse_args(own)
    limit, rays = (4, 100_000) if options.quick else (options.cell_limit, 1_000_000)
    sightcell = os.path.join(options.bin, "sightcell")
    rows = []
    print("| scene | polygons | cells | drawn | pixel error | upper bound | bake, CPU s per cell | bits per visible polygon |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for scene in options.scenes:
            path = make_city(folder, os.path.join(options.bin, "sightcell-city")) if scene == "city" else scene
            row = measure(sightcell, path, folder, limit, rays, more)
            rows.append(row)
            print(f"| {row['scene']} | {row['polygons']:,} | {row['cells']} | {row['visible_percent']:.2f} % "
                  f"| {row['pixel_error']:.1e} | {row['upper_bound']:.1e} | {row['bake_cpu_seconds_per_cell']:.2f} "
                  f"| {row['bits_per_visible_polygon']:.2f} |", flush=True)
    result_files.write(options.results, "scenes", f"{limit} cells spread over each scene, {' '.join(more) or 'default settings'}, profile exact, verified with "
                       f"{rays:,} rays.",
                       [{key: row[key] for key in PUBLISHED} for row in rows])
    if options.json_file:
        with open(options.json_file, "w", encoding="utf-8") as out:
            json.dump(rows, out, indent=2)


if __name__ == "__main__":
    main()
