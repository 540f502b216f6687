#!/usr/bin/python3
"""Automatic cells of real scenes: are players always in one, and what do wide cells save and cost?

usage: bench_reach.py --bin FOLDER [--lib libsightcell.so] [--only REGEX] [--part spawns walks sizes] [--steps N]
                      [--quality NAME] [--data FOLDER] [--results DIR]

--bin: the folder with sightcell and reach_walk. Scenes are those of $SIGHTCELL_DATA; missing ones are skipped, with a
message. --only: scenes whose path matches. --quality: of the bakes for sizes. Results of the programs are kept in
$SIGHTCELL_CACHE (default: sightcell-cache in the folder for temporary files) under the hash of scene, program and
settings; a second run takes from there what is done.

spawns: the points where players appear in game levels, dropped to the first floor below (at most 8 m): share of the
eyes 1.6 m above it that are in an automatic cell.
walks: a person walks at random (reach_walk.cpp, which knows polygons and no voxels), from the spawns of a level and
from those of 24 random places in cells whose trial walks get around. Eyes in no cell, of the automatic cells and of the
columns before merging.
sizes: the automatic cells of a region; its columns, 4 m wide, before merging; and the lattice of boxes 4 m wide and 2 m
high that the columns intersect. Polygons drawn: those of the set, in the mean over the same random eyes of such walks
in the region. Sets have no slack. CPU seconds of a bake are without merging, which is measured over the whole scene.

Exit code 1 where an eye is in no cell, or less than 98 % of the spawns; 77 without data.
"""
import argparse
import ctypes
import itertools
import json
import os
import re
import sys
import tempfile

sys.dont_write_bytecode = True  # nothing is written into the sources
import numpy as np  # noqa: E402
import bench_data  # noqa: E402
import pair_sets  # noqa: E402
import result_files  # noqa: E402

LEVELS = ("levels/accident.glb", "levels/czest3ctf.glb", "levels/oacmpctf3.glb")
WALKS = (*LEVELS, "cube/zdm2.glb", "city/denhaag_01.glb", "city/intel_castle.glb", "city/candela_city.glb")
# x0, z0, x1, z1 in meters, of whole blocks of cells, so that no cell is in two; None: the whole scene. Those of cities
# are among the parts where walks are most: streets.
REGIONS = {"city/candela_city.glb": (448, 128, 512, 192), "city/denhaag_01.glb": (-384, -128, -320, -64),
           "city/intel_castle.glb": (64, 64, 128, 96), "levels/czest3ctf.glb": None}
SEARCHED = "floors are searched for in"  # of a warning
EYE = 1.6  # m
WIDTH, HEIGHT = 4.0, 2.0  # m, of uniform cells
TRIALS, TRIAL_STEPS = 24, 48_000  # walks from places that may become a start, steps of all
MEASURED_EYES = 5000
WHAT = {"spawns": "Players' starts in game levels, 1.6 m above the first floor below: in an automatic cell or not.",
        "walks": "Steps of a random walk over the floors, eyes at 1.6 m: how many are in no automatic cell.",
        "sizes": "Automatic cells against cells of one size in the same region."}
NOTES = {"spawns": [],
         "walks": ["A person is 0.5 m wide and 1.8 m high, climbs 0.45 m, jumps 1.2 m up, falls from any height, and "
                   "stands on slopes up to 45 degrees. Steps of 0.5 m."],
         "sizes": ["Explicit cells, one thread, profile exact. Regions x0, z0, x1, z1 in m: " +
                   "; ".join(f"{path} {region or 'all'}" for path, region in REGIONS.items())]}


def log(text):
    print(f"bench_reach: {text}", file=sys.stderr, flush=True)


# --- boxes and eyes


def boxes_of(cells):
    """[n, 2, 3] in meters."""
    return np.array([[cell["min"], cell["max"]] for cell in cells["cells"]], "f8").reshape(-1, 2, 3)


def containing(eyes, boxes):
    """For each eye the number of a box that it is in, or -1. Borders are in."""
    found = np.full(len(eyes), -1, "i8")
    square = np.floor(eyes[:, [0, 2]] / 16.0).astype("i8")
    for x, z in np.unique(square, axis=0):
        own = np.nonzero((square == (x, z)).all(1))[0]
        low, high = np.array([x, z]) * 16.0, np.array([x, z]) * 16.0 + 16.0
        near = np.nonzero((boxes[:, 0, ::2] <= high).all(1) & (boxes[:, 1, ::2] >= low).all(1))[0]
        if not len(near):
            continue
        inside = ((eyes[own, None] >= boxes[None, near, 0]) & (eyes[own, None] <= boxes[None, near, 1])).all(2)
        found[own] = np.where(inside.any(1), near[inside.argmax(1)], -1)
    return found


def within(boxes, region):
    """Those whose middle is in the region."""
    if region is None:
        return boxes
    middle = boxes.mean(1)
    return boxes[((middle[:, ::2] > region[:2]) & (middle[:, ::2] < region[2:])).all(1)]


def uniform_lattice(boxes, width=WIDTH, height=HEIGHT):
    """Boxes of a lattice that intersect any of the boxes, sorted."""
    size, places = np.array([width, height, width]), []
    for low, high in boxes:
        first, last = np.floor(low / size + 1e-6).astype("i8"), np.ceil(high / size - 1e-6).astype("i8")
        axes = [np.arange(a, b) for a, b in zip(first, last, strict=True)]
        places.append(np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3))
    places = np.unique(np.concatenate(places), axis=0)
    return np.stack([places * size, (places + 1) * size], 1)


def squares_of(eyes):
    """The number of different squares of 4 m that eyes are in."""
    return len(np.unique(np.floor(eyes[:, [0, 2]] / WIDTH), axis=0))


# --- programs


class Runs(bench_data.RunCache):
    def __init__(self, options, cache):
        super().__init__(options.bin, cache)
        self.quality = options.quality

    def kept(self, program, scene, settings, measure):
        """What measure(place) returns, from a kept file the next time."""
        path = os.path.join(self.place(program, scene, settings), "kept.json")
        if not os.path.exists(path):
            bench_data.keep(path, measure(os.path.dirname(path)))
        return bench_data.load(path)

    def cells(self, scene, *settings):
        """The automatic cells, with the CPU seconds of finding and merging them and of a few trial cells."""
        asked = ["cells", "--quality", "draft", *settings]

        def measure(_):
            program = os.path.join(self.folder, "sightcell")
            text, usage = bench_data.run([program, asked[0], scene, "--json", *asked[1:]])
            return {**json.loads(text), "cpu": usage.ru_utime + usage.ru_stime}
        return self.kept("sightcell", scene, asked, measure)

    def walk(self, scene, starts, steps, region=None):
        """Heights of the floors below the starts, or None, and the eyes of the walks from each start."""
        settings = ["--steps", str(steps), "--eye", str(EYE)]
        if region is not None:
            settings.append("--region=" + ",".join(map(str, region)))

        def measure(place):
            begin, out = os.path.join(place, "starts.json"), os.path.join(place, "out.json")
            bench_data.keep(begin, starts)
            bench_data.run([os.path.join(self.folder, "reach_walk"), scene, begin, out, *settings])
            return bench_data.load(out)
        found = self.kept("reach_walk", scene, [json.dumps(starts), *settings], measure)
        return found["floors"], [np.array(eyes, "f8").reshape(-1, 3) for eyes in found["eyes"]]

    def sets(self, scene, boxes):
        """The .pvs file of explicit cells and the CPU seconds of its bake."""
        folder = os.path.join(self.cache, "cells")
        os.makedirs(folder, exist_ok=True)
        path = os.path.join(folder, f"{os.getpid()}.json")
        cells = [{"name": f"c{i}", "min": low, "max": high} for i, (low, high) in enumerate(boxes.tolist())]
        bench_data.keep(path, {"cells": cells})
        self.hashes.pop(path, None)
        return self.bake(scene, ["--quality", self.quality, "--threads", "1", "--fresh"], path)


class DrawnPolygons:
    """Sizes of the sets that a host draws, through the runtime."""

    def __init__(self, library, path):
        self.lib, self.db = ctypes.CDLL(library), ctypes.c_void_p()
        opened = self.lib.sightcell_db_open_file(path.encode(), None, ctypes.byref(self.db))
        pair_sets.need(opened == 0, f"{path}: cannot be opened")

    def at(self, eye):
        """The polygons of its cell, or None outside all cells."""
        frame, view = (ctypes.c_uint32 * 16)(), ctypes.c_void_p()
        # A new view, because one stays in a cell a little beyond its border.
        pair_sets.need(self.lib.sightcell_view_create(self.db, ctypes.byref(view)) == 0, "no view")
        pair_sets.need(self.lib.sightcell_view_move(view, (ctypes.c_float * 3)(*eye), frame) == 0, "no move")
        self.lib.sightcell_view_destroy(view)
        return None if frame[1] & pair_sets.DRAW_ALL else frame[2]


def fine_columns(runs, scene, columns):
    """The columns of 4 m, where --most-cells makes the smallest cells wider."""
    if columns["cells"][0]["max"][0] - columns["cells"][0]["min"][0] > WIDTH:
        columns = runs.cells(scene, "--merge-cells", "0", "--most-cells", "1000000")
    return columns


# --- where walks begin


def spawns_of(scene):
    """Positions in a level, else None."""
    path = scene.removesuffix(".glb") + ".bspvis.npz"
    if not os.path.exists(path):
        return None
    with np.load(path) as known:
        return known["spawn_pos"].astype("f8").tolist()


def good_starts(runs, scene, columns, region=None):
    """Random places in columns of 4 m, with the eye above the floor in the column, whose trial walks get around: to a
    quarter of the squares of the best and more. In a column at a wall the inside of a closed building is a floor too,
    which has no cells; walks there are short."""
    inside, random = within(columns, region), np.random.default_rng(1)
    chosen = inside[random.integers(len(inside), size=TRIALS)]
    places = chosen[:, 0] + random.uniform(size=(TRIALS, 3)) * (1, 0, 1) * (chosen[:, 1] - chosen[:, 0])
    places[:, 1] = chosen[:, 1, 1]
    floors, eyes = runs.walk(scene, places.tolist(), TRIAL_STEPS, region)
    squares = np.array([squares_of(of_one) for of_one in eyes])
    above = np.array([np.nan if floor is None else floor + EYE for floor in floors])
    squares[~((above >= chosen[:, 0, 1]) & (above <= chosen[:, 1, 1]))] = 0
    return places[4 * squares >= squares.max()].tolist()


# --- tables


def spawn_row(runs, scene, boxes):
    spawns = spawns_of(scene)
    if spawns is None:
        return None
    floors, _ = runs.walk(scene, spawns, 0)
    dropped = zip(spawns, floors, strict=True)
    eyes = np.array([[x, floor + EYE, z] for (x, _, z), floor in dropped if floor is not None]).reshape(-1, 3)
    inside = int((containing(eyes, boxes) >= 0).sum())
    return {"spawns": len(spawns), "with_floor": len(eyes), "in_cells": inside,
            "percent": 100.0 * inside / max(len(eyes), 1)}


def walk_row(runs, scene, steps, boxes, found):
    """boxes: of the automatic cells. found: the answer of `sightcell cells` before merging."""
    searched_in_part = any(SEARCHED in warning for warning in found["warnings"])  # the scene is too wide
    columns, fine = boxes_of(found), boxes_of(fine_columns(runs, scene, found))
    ends = np.concatenate([fine[:, 0].min(0)[::2], fine[:, 1].max(0)[::2]])
    region = tuple(ends.tolist()) if searched_in_part else None
    starts = (spawns_of(scene) or []) + good_starts(runs, scene, fine, region)
    eyes = np.concatenate(runs.walk(scene, starts, steps, region)[1])
    in_cells, in_columns = containing(eyes, boxes), containing(eyes, columns)
    heights = eyes[in_cells < 0, 1]
    for eye in eyes[in_cells < 0][:5]:
        log(f"{scene}: no cell contains the eye ({', '.join(f'{c:.3f}' for c in eye)})")
    return {"starts": len(starts), "steps": len(eyes), "outside": int((in_cells < 0).sum()),
            "beyond_heights_of_cells": int(((heights < boxes[:, 0, 1].min()) | (heights > boxes[:, 1, 1].max())).sum()),
            "outside_before_merging": int((in_columns < 0).sum()), "cells": len(boxes),
            "cells_visited": len(np.unique(in_cells[in_cells >= 0])), "columns": len(columns),
            "columns_visited": len(np.unique(in_columns[in_columns >= 0]))}


def size_rows(runs, library, scene, region, steps, merged, columns):
    """A row per kind of cells. merged, columns: answers of `sightcell cells`."""
    columns = fine_columns(runs, scene, columns)
    starts = (spawns_of(scene) if region is None else None) or good_starts(runs, scene, boxes_of(columns), region)
    eyes = np.concatenate(runs.walk(scene, starts, steps, region)[1])
    eyes = eyes[np.random.default_rng(1).permutation(len(eyes))]
    kinds = {"merged": within(boxes_of(merged), region), "columns": within(boxes_of(columns), region)}
    kinds["lattice"] = uniform_lattice(kinds["columns"])
    rows, sets = [], []
    for kind, boxes in kinds.items():
        pvs, summary = runs.sets(scene, boxes)
        sets.append(DrawnPolygons(library, pvs))
        rows.append({"quality": runs.quality, "cells_are": kind, "cells": len(boxes), "stored": summary["cells"],
                     "cpu_seconds": summary["cpu"], "bytes": os.path.getsize(pvs)})
    # Cells in solids are not stored, and walks get into what is closed around them, such as a hill.
    counts = ([of_kind.at(eye) for of_kind in sets] for eye in eyes)
    measured = list(itertools.islice((of_eye for of_eye in counts if None not in of_eye), MEASURED_EYES))
    for row, drawn in zip(rows, np.mean(measured, axis=0).tolist(), strict=True):
        merging = merged["cpu"] - columns["cpu"] if row["cells_are"] == "merged" else None
        row.update({"eyes": len(measured), "drawn": drawn, "merging_cpu_seconds_of_scene": merging})
    return rows


def measure_scene(runs, library, options, path, scene):
    """Rows by table."""
    columns, merged = runs.cells(scene, "--merge-cells", "0"), runs.cells(scene)
    found = {}
    if "spawns" in options.part:
        found["spawns"] = [spawn_row(runs, scene, boxes_of(merged))]
    if "walks" in options.part and path in WALKS:
        found["walks"] = [walk_row(runs, scene, options.steps, boxes_of(merged), columns)]
    if "sizes" in options.part and path in REGIONS:
        found["sizes"] = size_rows(runs, library, scene, REGIONS[path], options.steps, merged, columns)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--lib", help="default: ../lib/libsightcell.so beside --bin")
    parser.add_argument("--data", default=os.environ.get("SIGHTCELL_DATA", ""))
    parser.add_argument("--only", default="")
    parser.add_argument("--part", nargs="+", choices=("spawns", "walks", "sizes"), default=["spawns", "walks", "sizes"])
    parser.add_argument("--steps", type=int, default=100_000)
    parser.add_argument("--quality", choices=("draft", "normal", "final"), default="normal")
    result_files.add_option(parser)
    options = parser.parse_args()
    library = options.lib or os.path.join(options.bin, "..", "lib", "libsightcell.so")
    cache = os.environ.get("SIGHTCELL_CACHE") or os.path.join(tempfile.gettempdir(), "sightcell-cache")
    runs = Runs(options, cache)
    tables, there = {name: [] for name in WHAT}, 0
    for path in dict.fromkeys((*WALKS, *REGIONS)):
        scene = os.path.join(options.data, path)
        if not re.search(options.only, path):
            continue
        if not os.path.exists(scene):
            log(f"{path} was not found; it is left out")
            continue
        there += 1
        for table, rows in measure_scene(runs, library, options, path, scene).items():
            for row in filter(None, rows):
                tables[table].append({"scene": os.path.splitext(os.path.basename(path))[0], **row})
                shown = (f"{key} {result_files.text_of(value)}" for key, value in tables[table][-1].items())
                print(f"{table}: " + ", ".join(shown), flush=True)
    if not there:
        print("skipped: no scenes; SIGHTCELL_DATA names the folder of real scenes")
        return 77
    for table, rows in tables.items():
        if rows:
            other = "_" + options.quality if table == "sizes" and options.quality != "normal" else ""
            result_files.write(options.results, f"reach_{table}{other}", WHAT[table], rows, NOTES[table])
    return int(any(row["outside"] for row in tables["walks"]) or any(row["percent"] < 98.0 for row in tables["spawns"]))


if __name__ == "__main__":
    sys.exit(main())
