#!/usr/bin/python3
"""Shadow maps with four cascades: sets and casters against everything (docs/shadows.md, shadow_cascades.cpp).

usage: bench_shadows.py --bin FOLDER [--sun A,E] [--quality NAME] [--views N] [--size WxH] [--results DIR]
                        SCENE.glb:CELLS[@X,Y,Z] ...

--bin: the folder with sightcell and shadow_cascades. CELLS: of the scene, spread evenly, or those nearest to a point: cells take
casters from adjacent ones, as in a whole bake. Views: per cell, 60 degrees high.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import result_files  # noqa: E402


def run(*arguments):
    done = subprocess.run(arguments, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        sys.exit(f"bench_shadows: {' '.join(arguments)}: {done.stderr.strip().splitlines()[-1:]}")
    return done.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--sun", default="150,40")
    parser.add_argument("--quality", default="normal")
    parser.add_argument("--views", default="64")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("scenes", nargs="+")
    result_files.add_option(parser)
    options = parser.parse_args()
    width, height = options.size.split("x")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "scene.pvs")
        for given in options.scenes:
            scene, cells = given.rsplit(":", 1)
            cells, _, near = cells.partition("@")
            run(os.path.join(options.bin, "sightcell"), "bake", scene, "-o", file, "--sun", options.sun, "--cell-limit", cells,
                "--quality", options.quality, "--fresh", "--progress", "none", *(["--near=" + near] if near else []))
            rows.append(json.loads(run(os.path.join(options.bin, "shadow_cascades"), scene, file, "--views", options.views,
                                       "--width", width, "--height", height)))
            print(json.dumps(rows[-1]), flush=True)
    result_files.write(options.results, "shadows", "pixels whose shadow differs from that with everything, four cascades of 2048 texels, "
                       "with the standard error over views, and those where the shadow of the visible point itself is missing; "
                       "polygons drawn of those in the boxes of the cascades, each polygon by its own box", rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
