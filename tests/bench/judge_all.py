#!/usr/bin/python3
"""Bakes every plain .glb of $SIGHTCELL_DATA (malformed/ aside) and has an independent judge look at the sets.

usage: judge_all.py --judge FOLDER --bin FOLDER [--lib libsightcell.so] [--only TEXT] [--cell-limit 12]
                    [--max-pixel-error 1e-3] [--eyes 2000] [--rays 100]

--judge: a folder with judge.py SCENE FILE.pvs LIBRARY --eyes N --rays N --max-miss E, which prints one JSON object and
then one line, and fails when the bound E is not met or polygons are not those of the scene. Plain: without compressed meshes. Bakes are kept as those
of bench_data.py. Exit code 1 when the judge finds anything, 77 without data.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import bench_data

COMPRESSED = {"KHR_draco_mesh_compression", "EXT_meshopt_compression"}


def judged_row(workshop, options, path):
    scene = os.path.join(options.data, path)
    try:
        pvs, baked = workshop.bake(scene, ["--cell-limit", str(options.cell_limit), "--max-pixel-error",
                                           options.max_pixel_error, "--seed", "1", "--threads", "1"])
    except bench_data.Failed as failed:
        return f"| {path} | | | | | | | {failed} |", [f"{path}: {failed}"]
    done = subprocess.run(["/usr/bin/python3", os.path.join(options.judge, "judge.py"), scene, pvs, options.lib,
                           "--eyes", str(options.eyes), "--rays", str(options.rays), "--max-miss", options.max_pixel_error],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    lines = done.stdout.splitlines() or ["nothing said"]
    found = next((json.loads(line) for line in lines if line.startswith("{")), None)
    if found is None:
        return f"| {path} | {baked['polygons']:,} | | | | | | {lines[-1]} |", [f"{path}: {lines[-1]}"]
    wrong = [] if done.returncode == 0 else [f"{path}: {lines[-1]}"]
    if found["polygons"] != baked["polygons"]:
        wrong.append(f"{path}: {baked['polygons']} polygons, the judge counts {found['polygons']}")
    return (f"| {path} | {baked['polygons']:,} | {baked['cpu']:.1f} | {baked['max_upper_bound']:.1e} | {found['judged']} | {found['rays']:,} | {found['rate']:.1e} "
            f"({found['low']:.1e} .. {found['high']:.1e}) | {'holds' if not wrong else 'FAILS'} |"), wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--judge", required=True)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--lib", help="default: ../lib/libsightcell.so beside --bin")
    parser.add_argument("--data", default=os.environ.get("SIGHTCELL_DATA", ""))
    parser.add_argument("--only", default="")
    parser.add_argument("--cell-limit", type=int, default=12)
    parser.add_argument("--max-pixel-error", default="1e-3")
    parser.add_argument("--eyes", type=int, default=2000)
    parser.add_argument("--rays", type=int, default=100)
    options = parser.parse_args()
    options.lib = os.path.abspath(options.lib or os.path.join(options.bin, "..", "lib", "libsightcell.so"))
    files = [path for path in bench_data.scene_files(options.data) if options.only in path] if options.data else []
    if not files:
        print("skipped: no scenes; SIGHTCELL_DATA names the folder of real scenes")
        return 77
    cache = os.environ.get("SIGHTCELL_CACHE") or os.path.join(tempfile.gettempdir(), "sightcell-cache")
    workshop = bench_data.Workshop(options.bin, cache)
    wrong = []
    print("| file | polygons | CPU s | largest bound | cells judged | rays | miss rate (90 %) | |")
    print("|---|---|---|---|---|---|---|---|")
    for path in files:
        if COMPRESSED & set(bench_data.extensions_of(os.path.join(options.data, path))):
            continue
        row, problems = judged_row(workshop, options, path)
        print(row, flush=True)
        wrong += problems
    for line in wrong:
        print(f"FAILED {line}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
