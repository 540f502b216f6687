#!/usr/bin/python3
"""CPU time of the viewer's frames: with the set of the camera's cell, and with everything.

usage: bench_viewer.py --bin FOLDER [--cells N] [--poses N] [--quick] [--results DIR] [SCENE ...]

--bin: the folder with sightcell, sightcell-city and sightcell-viewer, and libsightcell.so beside it in ../lib. SCENE:
intel_castle, candela_city or czest3ctf under $SIGHTCELL_DATA (left out where they are missing), or city or vienna800k,
which are generated. Each is baked with --cells cells (24) of the default quality, spread over it. The poses (64) are valid
viewpoints of these cells, four directions each. `sightcell-viewer --benchmark` draws each pose twice, 1280 x 800 pixels,
under Xvfb with a software rasterizer, where drawing is CPU time of this process. Bakes are kept in $SIGHTCELL_CACHE
(default build/cache) under the hash of program and scene. --quick: a small town, four cells, eight poses.
"""
import argparse
import csv
import ctypes
import hashlib
import math
import os
import subprocess
import sys

sys.dont_write_bytecode = True  # nothing is written into the sources
import result_files  # noqa: E402

REAL = ["intel_castle", "candela_city", "czest3ctf"]
MADE = {"city": ["--polygons", "100000", "--seed", "1"], "vienna800k": ["--preset", "vienna800k", "--seed", "2"],
        "small": ["--polygons", "5000", "--seed", "1"]}
WIDTH, HEIGHT = 1280, 800


def fail(text):
    sys.exit(f"bench_viewer: {text}")


def run(*command, **more):
    done = subprocess.run(list(map(str, command)), stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
                          **more)
    if done.returncode not in (0, 3):
        fail(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr.strip().splitlines()[-1:]}")
    return done.stdout


def find_scene(name, data):
    """The path of a real scene, looked for by its file name; none where it is missing."""
    for folder, _, files in os.walk(data):
        if name + ".glb" in files:
            return os.path.join(folder, name + ".glb")
    return None


class Bakes:
    def __init__(self, options):
        self.options = options
        self.folder = os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "bench_viewer")
        os.makedirs(self.folder, exist_ok=True)

    def program(self, name):
        return os.path.join(self.options.bin, name)

    def scene(self, name):
        if name not in MADE:
            return find_scene(name, os.environ.get("SIGHTCELL_DATA", ""))
        path = os.path.join(self.folder, name + ".glb")
        if not os.path.exists(path):
            run(self.program("sightcell-city"), *MADE[name], "--out", path)
        return path

    def file(self, scene):
        key = hashlib.sha256()
        for path in (self.program("sightcell"), scene):
            with open(path, "rb") as stream:
                key.update(stream.read())
        path = os.path.join(self.folder, f"{key.hexdigest()[:16]}.{self.options.cells}.pvs")
        if not os.path.exists(path):
            run(self.program("sightcell"), "bake", scene, "-o", path, "--cell-limit", self.options.cells, "--progress",
                "none")
        return path

    def eyes(self, file):
        """A valid viewpoint of each cell."""
        library = ctypes.CDLL(os.path.join(self.options.bin, "..", "lib", "libsightcell.so"))
        db = ctypes.c_void_p()
        if library.sightcell_db_open_file(file.encode(), None, ctypes.byref(db)) != 0:
            fail(f"{file} cannot be opened")
        library.sightcell_db_cell_count.argtypes = [ctypes.c_void_p]
        found = []
        for cell in range(library.sightcell_db_cell_count(db)):
            eye = (ctypes.c_float * 3)()
            if library.sightcell_db_cell_eye(db, cell, 0, eye) == 0:
                found.append(tuple(eye))
        library.sightcell_db_close(db)
        return found


def write_path(path, eyes, poses):
    chosen = eyes[::max(1, math.ceil(4 * len(eyes) / poses))]
    with open(path, "w", encoding="ascii") as stream:
        stream.write("seconds,x,y,z,yaw,pitch\n")
        for number, (eye, turn) in enumerate((eye, turn) for eye in chosen for turn in range(4)):
            stream.write(f"{number},{eye[0]!r},{eye[1]!r},{eye[2]!r},{0.5 * math.pi * turn - math.pi + 0.3!r},0\n")


def measure(name, bakes):
    scene = bakes.scene(name)
    if scene is None:
        print(f"bench_viewer: {name} is not under SIGHTCELL_DATA: left out", file=sys.stderr)
        return None
    file = bakes.file(scene)
    poses, costs = os.path.join(bakes.folder, name + ".path.csv"), os.path.join(bakes.folder, name + ".costs.csv")
    write_path(poses, bakes.eyes(file), bakes.options.poses)
    run("xvfb-run", "-a", bakes.program("sightcell-viewer"), scene, file, "--replay", poses, "--benchmark", costs, "--size",
        f"{WIDTH}x{HEIGHT}", env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"})
    with open(costs, encoding="ascii") as stream:
        rows = list(csv.DictReader(stream))
    wrong = sum(int(row["wrong_pixels"]) for row in rows) / (len(rows) * WIDTH * HEIGHT)
    set_ms, all_ms = mean(rows, "culled_cpu_ms"), mean(rows, "all_cpu_ms")
    return {"scene": name, "poses": len(rows), "polygons": int(rows[0]["all_polygons"]),
            "polygons_drawn": round(mean(rows, "polygons")), "calls": round(mean(rows, "calls"), 1), "set_ms": set_ms,
            "everything_ms": all_ms, "ratio": all_ms / set_ms, "wrong_pixels": wrong}


def mean(rows, key):
    return sum(float(row[key]) for row in rows) / len(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--cells", type=int, default=24)
    parser.add_argument("--poses", type=int, default=64)
    parser.add_argument("--quick", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("scenes", nargs="*")
    options = parser.parse_args()
    if options.quick:
        options.cells, options.poses, options.scenes = 4, 8, ["small"]
    bakes = Bakes(options)
    rows = [row for row in (measure(name, bakes) for name in options.scenes or [*REAL, "city", "vienna800k"]) if row]
    if not rows:
        fail("no scene is left")
    print("| scene | poses | polygons | drawn | calls | CPU ms with the set | with everything | ratio | wrong pixels |")
    print("|---|---|---|---|---|---|---|---|---|")
    for r in rows:
        print(f"| {r['scene']} | {r['poses']} | {r['polygons']:,} | {r['polygons_drawn']:,} | {r['calls']} |"
              f" {r['set_ms']:.1f} | {r['everything_ms']:.1f} | {r['ratio']:.1f} | {r['wrong_pixels']:.1e} |")
    result_files.write(options.results, "viewer", "CPU time of a frame of the viewer with the set and with everything.",
                       rows, [f"{WIDTH} x {HEIGHT} pixels, software rasterizer; {options.cells} cells of the default quality."])


if __name__ == "__main__":
    main()
