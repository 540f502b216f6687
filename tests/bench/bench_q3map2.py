#!/usr/bin/python3
"""Cell sets of Quake 3 levels beside the visibility that the levels' own compiler (q3map2) stored in them.

usage: bench_q3map2.py --bin FOLDER [--lib libsightcell.so] [--level NAME ...] [--cell-limit 200] [--results DIR]
                       [-- OPTION ...]

--bin: the folder with sightcell. After -- options of `sightcell bake`. Levels lie under $SIGHTCELL_DATA/levels, each as
NAME.glb and NAME.bspvis.npz: the level's BSP tree, the faces that q3map2 calls potentially visible from each of its
clusters, and the face of each triangle. A cell is compared with the union over the clusters that its grown box touches
(6,000 random points). Faces of sub-models and of the sky are left out: q3map2 says nothing of them.

  outside     faces of our sets that q3map2 calls invisible; its sets are conservative, so there should be none
  size_ratio  faces of our set over those of q3map2's, mean over cells

Exit code 1 where more than a thousandth of the faces is outside, 77 without data.
"""
import argparse
import json
import os
import resource
import struct
import subprocess
import sys
import tempfile

import numpy as np

import pair_sets
import result_files

LEVELS = ["accident", "czest3ctf", "oacmpctf3"]
MARGIN = 0.26  # meters: the margin of a cell, and a little
OUTSIDE_BOUND = 1e-3


def children_cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def sky_of(scene, level):
    """Which triangles are of a material with extras.sky, in the order of the file's table of primitives."""
    with open(scene, "rb") as stream:
        size = struct.unpack("<5I", stream.read(20))[3]
        document = json.loads(stream.read(size))
    materials = document.get("materials", [])
    sky = np.zeros(len(level["tri_face"]), bool)
    for mesh, primitive, first, count, _ in level["prim_table"]:
        material = document["meshes"][mesh]["primitives"][primitive].get("material")
        if material is not None and materials[material].get("extras", {}).get("sky"):
            sky[first:first + count] = True
    return sky


def clusters_of(level, points):
    """The cluster of each point, by the level's BSP tree; -1 in solids."""
    nodes = np.zeros(len(points), "i8")
    while (live := np.nonzero(nodes >= 0)[0]).size:
        plane = level["node_plane"][nodes[live]]
        distance = np.einsum("ij,ij->i", level["plane_normal"][plane].astype("f8"), points[live])
        nodes[live] = level["node_children"][nodes[live], (distance < level["plane_dist"][plane]).astype(int)]
    return level["leaf_cluster"][-nodes - 1]


def compare(level, sky, sets):
    """Cells, our faces, those outside, and the mean ratio of sizes."""
    faces = len(level["face_drawn"])
    visible = np.unpackbits(level["cluster_visible_faces"], axis=1, bitorder="little")[:, :faces].astype(bool)
    counted = level["face_world"].astype(bool) & level["face_drawn"].astype(bool)
    counted[level["tri_face"][sky]] = False
    random, total, outside, ratios = np.random.default_rng(3), 0, 0, []
    for cell, (low, high) in enumerate(sets.boxes):
        points = low - MARGIN + (high - low + 2 * MARGIN) * random.random((6000, 3))
        clusters = np.unique(clusters_of(level, points))
        clusters = clusters[clusters >= 0]
        if not clusters.size:
            continue
        ours = np.zeros(faces, bool)
        ours[level["tri_face"][sets.ids[cell]]] = True
        ours &= counted
        theirs = visible[clusters].any(axis=0) & counted
        total += int(ours.sum())
        outside += int((ours & ~theirs).sum())
        ratios.append(ours.sum() / max(theirs.sum(), 1))
    return len(ratios), total, outside, float(np.mean(ratios)) if ratios else 0.0


def measure(options, name, folder):
    scene = os.path.join(options.data, "levels", name + ".glb")
    level = np.load(os.path.join(options.data, "levels", name + ".bspvis.npz"))
    out = os.path.join(folder, name + ".pvs")
    before = children_cpu()
    done = subprocess.run([os.path.join(options.bin, "sightcell"), "bake", scene, "-o", out, "--profile", "exact", "--progress", "none",
                           "--cell-limit", str(options.cell_limit), *options.more], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        sys.exit(f"bench_q3map2: the bake of {name} ended with {done.returncode}: {done.stderr}")
    cells, total, outside, ratio = compare(level, sky_of(scene, level), pair_sets.Sets(options.lib, out))
    return {"level": name, "cells": cells, "faces": total, "outside": outside, "size_ratio": round(ratio, 3),
            "bake_cpu_seconds": round(children_cpu() - before, 1)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--lib", help="default: ../lib/libsightcell.so beside --bin")
    parser.add_argument("--data", default=os.environ.get("SIGHTCELL_DATA", ""))
    parser.add_argument("--level", nargs="+", choices=LEVELS, default=LEVELS)
    parser.add_argument("--cell-limit", type=int, default=200)
    result_files.add_option(parser)
    own = sys.argv[1:]
    own, more = (own[:own.index("--")], own[own.index("--") + 1:]) if "--" in own else (own, [])
    options = parser.parse_args(own)
    options.more = more
    options.lib = os.path.abspath(options.lib or os.path.join(options.bin, "..", "lib", "libsightcell.so"))
    if not os.path.exists(os.path.join(options.data, "levels")):
        print("skipped: no levels; SIGHTCELL_DATA names the folder of real scenes")
        return 77
    print("| level | cells | our faces | outside | ours / q3map2's | bake, CPU s |\n|---|---|---|---|---|---|")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in options.level:
            rows.append(row := measure(options, name, folder))
            print(f"| {name} | {row['cells']} | {row['faces']:,} | {row['outside']} | {row['size_ratio']:.2f} "
                  f"| {row['bake_cpu_seconds']:.0f} |", flush=True)
    result_files.write(options.results, "q3map2", "Cell sets beside those of q3map2, in faces of the level.", rows)
    return 1 if any(row["outside"] > OUTSIDE_BOUND * row["faces"] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
