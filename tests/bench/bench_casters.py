#!/usr/bin/python3
"""Shadow casters (docs/shadows.md) against sets alone: what they cost in the bake and in the file, and what they repair.

usage: bench_casters.py --bin FOLDER [--sun A,E] [--cells N] [--rays N] [--quality NAME] [--results DIR] SCENE.glb ...

--bin: the folder with sightcell. --cells: of each scene, spread evenly; 0: all. Bakes each scene with and without --sun, and
verifies the casters. Prints a row per scene: CPU seconds and bytes without and with casters, casters per cell beside the set,
polygons drawn into the shadow map as a share of everything, and the share of rays that show a point without its shadow, with
the sets alone and with casters.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import result_files  # noqa: E402


def run(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        sys.exit(f"bench_casters: {' '.join(arguments)}: {done.stderr.strip().splitlines()[-1:]}")
    return done.stdout


def measure(program, scene, options, folder):
    common = ["--cell-limit", str(options.cells), "--quality", options.quality, "--fresh", "--progress", "none", "--json"]
    plain, lit = (os.path.join(folder, name) for name in ("plain.pvs", "lit.pvs"))
    before = json.loads(run(program, "bake", scene, "-o", plain, *common))
    after = json.loads(run(program, "bake", scene, "-o", lit, "--sun", options.sun, *common))
    checked = json.loads(run(program, "verify", scene, lit, "--sun", "--rays", str(options.rays), "--json"))
    sun, proof = after["suns"][0], checked["casters"]["suns"][0]
    return {
        "scene": os.path.splitext(os.path.basename(scene))[0],
        "cells": after["cells"],
        "quality": options.quality,
        "cpu_seconds_of_sets": before["cpu_seconds"],
        "cpu_seconds": after["cpu_seconds"],
        "bytes_of_sets": before["bytes"],
        "bytes": after["bytes"],
        "casters_per_cell": sun["casters_per_cell"],
        "cells_over_bound": sun["cells_over_bound"],
        "max_upper_bound": sun["max_upper_bound"],
        "set_percent": proof["set_percent"],
        "drawn_percent": proof["drawn_percent"],
        "rays": proof["rays"],
        "misses_of_sets": proof["misses_of_sets"],
        "misses": proof["misses"],
        "upper_bound": proof["upper_bound"],
    }


def text(row):
    times = row["cpu_seconds"] / row["cpu_seconds_of_sets"]
    larger = row["bytes"] / row["bytes_of_sets"]
    return (f"{row['scene']}: {row['cells']} cells, CPU {row['cpu_seconds_of_sets']:.1f} -> {row['cpu_seconds']:.1f} s ({times:.2f} "
            f"times), {row['bytes_of_sets']} -> {row['bytes']} bytes ({larger:.2f} times), {row['casters_per_cell']:.0f} casters per "
            f"cell, drawn {row['set_percent']:.2f} -> {row['drawn_percent']:.2f} % of everything, wrong "
            f"{row['misses_of_sets'] / row['rays']:.2e} -> {row['misses'] / row['rays']:.2e} (at most "
            f"{row['upper_bound']:.2e}), {row['cells_over_bound']} cells above the bound")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--sun", default="150,40")
    parser.add_argument("--cells", type=int, default=24)
    parser.add_argument("--rays", type=int, default=200_000)
    parser.add_argument("--quality", default="normal")
    result_files.add_option(parser)
    parser.add_argument("scenes", nargs="+")
    options = parser.parse_args()
    program = os.path.join(options.bin, "sightcell")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for scene in options.scenes:
            rows.append(measure(program, scene, options, folder))
            print(text(rows[-1]), flush=True)
    result_files.write(options.results, "casters", "a bake with a sun beside one without, and verify --sun", rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
