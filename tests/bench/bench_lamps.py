#!/usr/bin/python3
"""Lamps (docs/lights.md) that are added to a scene, against brute force: what their sets have, what rays find, what is missing,
and the time of each.

usage: bench_lamps.py --bin FOLDER --within x0,y0,z0,x1,y1,z1 [--lamps N] [--seed N] [--cells N] [--rays N] [--cell-rays N]
                      [--verify-rays N] [--quality NAME] [--results DIR] SCENE.glb

--bin: the folder with sightcell and lamp_rays. --within: the town. --lamps: places in its streets that lamp_rays finds, 3 to 5 m
above what is below; the ranges are 15 to 40 m, and every third lamp is a spot light that shines down, with 30 to 60 degrees
between axis and edge. --cells: boxes of 4 m below the first lamps. --rays: of brute force, per lamp. --cell-rays: likewise per cell; from what
they meet, a ray goes to each lamp. --verify-rays: of sightcell
verify, of all lamps. The time per lamp is the CPU time of a bake with --lights less that of one without, divided by the lamps.
"""
import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import make_levels  # noqa: E402
import result_files  # noqa: E402


def run(*arguments):
    done = subprocess.run(arguments, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        sys.exit(f"bench_lamps: {' '.join(arguments)}: {done.stderr.strip().splitlines()[-1:]}")
    return done.stdout


def write_lit_scene(scene, out, places, seed):
    document, binary = make_levels.read_glb(scene)
    draw = random.Random(seed)
    lights = []
    for number, place in enumerate(places):
        light = {"type": "point", "intensity": 100.0, "range": round(draw.uniform(15.0, 40.0), 2)}
        if number % 3 == 2:
            light = {**light, "type": "spot", "spot": {"outerConeAngle": round(math.radians(draw.uniform(30.0, 60.0)), 4)}}
        lights.append(light)
        node = {"name": f"lamp {number}", "translation": place["position"],
                "extensions": {"KHR_lights_punctual": {"light": number}}}
        if light["type"] == "spot":  # a spot light shines along -z: turned by 90 degrees about x, down
            node["rotation"] = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
        document["scenes"][document.get("scene", 0)]["nodes"].append(len(document["nodes"]))
        document["nodes"].append(node)
    document.setdefault("extensions", {})["KHR_lights_punctual"] = {"lights": lights}
    document.setdefault("extensionsUsed", []).append("KHR_lights_punctual")
    make_levels.write_glb(out, document, binary)


def write_cells(out, places):
    cells = []
    for number, place in enumerate(places):
        x, _, z = place["position"]
        floor = place["floor"]
        cells.append({"name": f"lamp {number}", "min": [x - 2, floor + 0.9, z - 2], "max": [x + 2, floor + 2.1, z + 2]})
    with open(out, "w", encoding="utf-8") as file:
        json.dump({"cells": cells}, file)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--within", required=True)
    parser.add_argument("--lamps", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cells", type=int, default=6)
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--cell-rays", type=int, default=1_000_000)
    parser.add_argument("--verify-rays", type=int, default=2_000_000)
    parser.add_argument("--quality", default="normal")
    parser.add_argument("scene")
    result_files.add_option(parser)
    options = parser.parse_args()
    sightcell, lamp_rays = (os.path.join(options.bin, name) for name in ("sightcell", "lamp_rays"))
    name = os.path.splitext(os.path.basename(options.scene))[0]
    places = json.loads(run(lamp_rays, "place", options.scene, f"--within={options.within}", "--count", str(options.lamps), "--seed",
                            str(options.seed)))
    with tempfile.TemporaryDirectory() as folder:
        scene, cells, plain, lit = (os.path.join(folder, file) for file in ("lit.glb", "cells.json", "plain.pvs", "lit.pvs"))
        write_lit_scene(options.scene, scene, places, options.seed)
        write_cells(cells, places[:options.cells])
        common = ["--cells-file", cells, "--quality", options.quality, "--fresh", "--progress", "none", "--json"]
        before = json.loads(run(sightcell, "bake", scene, "-o", plain, *common))
        after = json.loads(run(sightcell, "bake", scene, "-o", lit, *common, "--lights"))
        print(json.dumps({"before": before["cpu_seconds"], "after": after["cpu_seconds"], "lights": after["lights"]}), flush=True)
        verified = run(sightcell, "verify", scene, lit, "--lights", "--rays", str(options.verify_rays), "--json")
        proof = json.loads(verified)["lights"]
        print(json.dumps({key: value for key, value in proof.items() if key != "missing"}), flush=True)
        checked = json.loads(run(lamp_rays, "check", scene, lit, "--rays", str(options.rays), "--cell-rays", str(options.cell_rays)))
        rows, of_cells = ([{"scene": name, **row} for row in checked[key]] for key in ("lamps", "cells"))
        for row in rows + of_cells:
            print(json.dumps(row))
    found = after["lights"]
    total = {"scene": name, "quality": options.quality, "lamps": len(rows), "inside_solids": found["inside_solids"],
             "cells": after["cells"],
             "cpu_seconds_without": before["cpu_seconds"], "cpu_seconds_with": after["cpu_seconds"],
             "cpu_seconds_per_lamp": (after["cpu_seconds"] - before["cpu_seconds"]) / len(rows),
             "cpu_seconds_per_cell": before["cpu_seconds"] / max(before["cells"], 1),
             "million_rays_per_lamp": found["rays"] / len(rows) / 1e6,
             "bytes_per_lamp": (after["bytes"] - before["bytes"]) / len(rows),
             "polygons_per_lamp": found["polygons_per_light"], "lamps_per_cell": found["lights_per_cell"],
             "max_upper_bound": found["max_upper_bound"], "over_bound": found["over_bound"],
             "verify_rays": proof["rays"], "verify_misses": proof["misses"], "verify_upper_bound": proof["upper_bound"],
             "rays": sum(row["rays"] for row in rows), "misses": sum(row["misses"] for row in rows),
             "found": sum(row["found"] for row in rows), "not_in_set": sum(row["not_in_set"] for row in rows),
             "missed": sum(row["missed"] for row in rows)}
    print(json.dumps(total), flush=True)
    result_files.write(options.results, "lamps", "lamps in streets: polygons of the set of each, polygons that rays from it meet in its "
                       "range and cone, and those of them that the set lacks", rows)
    result_files.write(options.results, "lamps_cells", "which lamps touch a cell, and which of them rays find: from random valid "
                       "viewpoints in random directions, then from what they meet to each lamp", of_cells)
    result_files.write(options.results, "lamps_cost", "a bake with lamps beside one without, verify --lights, and rays of brute force "
                       "over all lamps", [total])
    return 0


if __name__ == "__main__":
    sys.exit(main())
