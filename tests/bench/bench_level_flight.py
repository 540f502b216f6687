#!/usr/bin/python3
"""A flight across switches of levels of detail: pictures with the set of the cell against those with everything
(docs/levels.md, level_flight.cpp). Each object gets two levels by make_levels.py.

usage: bench_level_flight.py --bin FOLDER --from X,Y,Z --to X,Y,Z [--coverages A,B]... [--frames N] [--quality NAME] [--results DIR]
                             SCENE.glb

--bin: the folder with sightcell and level_flight. --coverages: where the levels begin, a row each. The cells are those of 4 m on
the way. Levels are outside the tree, so one bake serves all rows.
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
        sys.exit(f"bench_level_flight: {' '.join(arguments)}: {done.stderr.strip().splitlines()[-1:]}")
    return done.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--from", dest="start", required=True)
    parser.add_argument("--to", dest="end", required=True)
    parser.add_argument("--coverages", action="append")
    parser.add_argument("--frames", default="121")
    parser.add_argument("--quality", default="draft")
    parser.add_argument("scene")
    result_files.add_option(parser)
    options = parser.parse_args()
    ends = [[float(word) for word in text.split(",")] for text in (options.start, options.end)]
    box = [pick(pair) + by for pick, by in ((min, -0.1), (max, 0.1)) for pair in zip(*ends)]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        scene, file = os.path.join(folder, "levels.glb"), os.path.join(folder, "levels.pvs")
        for coverages in options.coverages or ["1,0.3", "3,1"]:
            run(sys.executable, os.path.join(os.path.dirname(os.path.abspath(__file__)), "make_levels.py"), options.scene, scene,
                "--coverages", coverages)
            if not rows:
                run(os.path.join(options.bin, "sightcell"), "bake", scene, "-o", file, "--quality", options.quality, "--fresh",
                    "--cells-grid=" + ",".join(f"{number:g}" for number in box), "--progress", "none")
            row = json.loads(run(os.path.join(options.bin, "level_flight"), scene, file, f"--from={options.start}", f"--to={options.end}",
                                 "--frames", options.frames, "--width", "320", "--height", "180"))
            rows.append({**row, "scene": os.path.splitext(os.path.basename(options.scene))[0], "coverages": coverages})
            print(json.dumps(rows[-1]), flush=True)
    result_files.write(options.results, "level_flight", "pixels of a flight whose picture with the set differs from that with everything, "
                       "each object at the level that its distance chooses", rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
