#!/usr/bin/python3
"""Bytes and decode times of .pvs files beside CRoaring, varint runs and zstd, on frozen cell sets.

usage: bench_format.py --bin FOLDER [--scene NAME ...] [--file NAME=PATH ...] [--repeat N] [--again] [--quick]
                       [--results DIR] [--json OUT.json]

--bin: the folder with sightcell, sightcell-city, bench_format, bench_format_parts and bench_vertex_cache. Eight corpora: what the default sampler finds at an error
of 1e-4 in six real scenes under SIGHTCELL_DATA (said so where one is missing), in the city's preset vienna800k (seed 2) and
in a town of 145,000 polygons whose cells are more than 10,000; small-town when it is named. Prints Markdown tables.
--file takes a file that is there already for a corpus of that name, or of any other name.

The bakes take 1 to 25 CPU minutes each; stopped ones go on where they were. They are kept under $SIGHTCELL_CACHE (default
build/cache) as the only shard of a bake, by scene, options and bake_version; `sightcell merge` makes the file of them, again
whenever the code that writes files has changed: the sets stay frozen, and a new format costs seconds.
Results are kept by program and file; --again measures anew.

  rows        bytes of rows, chunk directory and code tables
  sets        bytes of a file without its sections SIDE below: with header, directory, code tables and order
  b/vp        bits per (cell, visible polygon), as `sightcell info` has it
  atom        polygons that the same cells see
  to ranges, to index list  sightcell_view_move into a cell and the call that delivers, nothing else between two cells
  move        sightcell_view_move; ranges, polygons, indices: those calls after it, all of them in each cell; cold: move
              after 64 MiB were written between two moves, which a last-level cache may be large enough to hold besides
  own         rows that are no difference; depth 1, 2: differences to one, or to a difference
  Rows of peers have no offsets; a file's have. Times are of single calls by the steady clock, medians per cell, means over
  cells, in shuffled order.
"""
import argparse
import hashlib
import json
import os
import re
import statistics
import subprocess
import sys

import bench_targets
import result_files
import sampler_plan as plan
import sampler_runs
from sampler_runs import ROOT, hash_of

# Cells that are baked, spread evenly; 0: all.
CELLS = {"czest3ctf": 0, "oacmpctf3": 600, "accident": 1000, "denhaag_01": 1000, "intel_castle": 700, "candela_city": 500,
         "vienna800k": 2000, "town145k": 0, plan.TOWN: 8}
TOWNS = {"town145k": 145_000, plan.TOWN: 20_000}
OPTIONS = ["--max-pixel-error", "1e-4", "--source", "cpu"]
# Sections of a file.
SIDE = {"settings", "certificate", "draws", "cells"}
ROWS = {"rows", "row directory", "codes"}
WRITERS = ["format/include", "format/src", "bake/src/order", *("bake/src/" + name for name in (
    "file/pvs_output.cpp", "shards/merge.cpp"))]
PROFILES = ("balanced", "small")
PEERS = {"roaring": "CRoaring", "roaring_zstd": "CRoaring + zstd", "varint": "varint runs",
         "varint_zstd_dictionary": "varint + zstd + dictionary", "varint_zstd_whole": "varint, whole-file zstd",
         "roaring_zstd_whole": "CRoaring, whole-file zstd"}


def say(text):
    print(f"bench_format: {text}", file=sys.stderr, flush=True)


def fail(text):
    sys.exit(f"bench_format: {text}")


def digest(*words):
    return hashlib.sha256("\0".join(words).encode()).hexdigest()[:24]


def bake_version():
    with open(os.path.join(ROOT, "bake", "src", "job", "bake_key.cpp"), encoding="utf-8") as stream:
        found = re.search(r"bake_version = (\d+);", stream.read())
    return found[1] if found else fail("bake/src/job/bake_key.cpp has no bake_version")


def writer_code():
    """A hash of the sources that decide a file's bytes, given its sets."""
    files = []
    for name in WRITERS:
        path = os.path.join(ROOT, name)
        files += [path] if os.path.isfile(path) else [os.path.join(at, f) for at, _, names in os.walk(path) for f in names]
    return digest(*(hash_of(f) for f in sorted(files)))


class Bench:
    def __init__(self, options):
        self.options = options
        self.cache = os.path.abspath(os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "bench_format"))
        os.makedirs(self.cache, exist_ok=True)
        self.samplers = sampler_runs.Bench(options.bin, 1, lambda name: 0, {}, real=bench_targets.REAL)

    def program(self, name):
        return self.samplers.program(name)

    def run(self, *command):
        """Standard output of a program; what it says beside passes through."""
        done = subprocess.run([self.program(command[0]), *command[1:]], stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode not in (0, 3):  # 3: a bound was not met
            fail(f"{' '.join(command)} ended with {done.returncode}")
        return done.stdout

    def scene(self, name):
        if name not in TOWNS:
            found = self.samplers.scene(name)
            return found and found[0]
        path = os.path.join(self.cache, f"{name}-{plan.CITY_SEED}-{hash_of(self.program('sightcell-city'))[:16]}.glb")
        if not os.path.exists(path):
            say(f"making {name}")
            part = path[:-len(".glb")] + ".part.glb"
            self.run("sightcell-city", "--polygons", str(TOWNS[name]), "--seed", str(plan.CITY_SEED), "--out", part)
            os.replace(part, path)
        return path

    def shards(self, name, scene):
        """The frozen cell sets: both phases of the one shard of a bake."""
        options = OPTIONS + (["--cell-limit", str(CELLS[name])] if CELLS[name] else [])
        stem = os.path.join(self.cache, f"{name}-{digest(hash_of(scene), bake_version(), *options)}")
        found = []
        for phase in ("1", "2"):
            shard, done = f"{stem}.pvs.shard-0-of-1.phase-{phase}", f"{stem}.phase-{phase}.done"
            if not os.path.exists(done):
                say(f"{name}: phase {phase} of its bake; when it is stopped, the next run goes on with it")
                self.run("sightcell", "bake", scene, "-o", stem + ".pvs", *options, "--profile", "exact", "--shard", "0/1",
                         "--phase", phase)
                with open(done, "w", encoding="utf-8"):
                    pass
            found += [shard] if os.path.exists(shard) else []
        return stem, found

    def file(self, name):
        """A corpus's .pvs, or None where its scene is missing."""
        if name in self.options.file:
            return self.options.file[name]
        scene = self.scene(name)
        if not scene:
            return None
        stem, shards = self.shards(name, scene)
        path = f"{stem}-{writer_code()}.pvs"
        if not os.path.exists(path):
            self.run("sightcell", "merge", path, *shards)
        return path

    def measure(self, name):
        path = self.file(name)
        if path is None:
            return None
        words = ["--quick"] if self.options.quick else ["--repeat", str(self.options.repeat)]
        kept = os.path.join(self.cache, digest(hash_of(self.program("bench_format")), hash_of(path), *words) + ".json")
        if self.options.again or not os.path.exists(kept):
            say(f"{name}: measuring {os.path.basename(path)}")
            self.run("bench_format", path, *words, "--json", kept + ".part")
            os.replace(kept + ".part", kept)
        with open(kept, encoding="utf-8") as stream:
            result = json.load(stream)
        info = json.loads(self.run("sightcell", "info", path, "--json"))
        info.pop("certificate", None)
        check(name, result["facts"], info)
        side = sum(s["size"] for s in info["sections"] if s["name"] in SIDE)
        return {"name": name, **result, "info": info, "sets_bytes": result["facts"]["file_bytes"] - side,
                "row_bytes": row_bytes(info), "parts": self.parts(path), "vertex_cache": self.vertex_cache(name, path),
                "profiles": {p: self.recoded(path, p) for p in PROFILES}}

    def parts(self, path):
        """Rows with and without each part of the format."""
        kept = path[:-len(".pvs")] + ".parts.json"
        if not os.path.exists(kept):
            self.run("bench_format_parts", path, "--json", kept + ".part")
            os.replace(kept + ".part", kept)
        with open(kept, encoding="utf-8") as stream:
            return json.load(stream)

    def vertex_cache(self, name, path):
        """What the stored order costs a GPU; None where the scene is not known."""
        scene = self.scene(name) if name in CELLS else None
        if not scene:
            return None
        words = ["--quick"] if self.options.quick else []
        kept = os.path.join(self.cache, digest(hash_of(self.program("bench_vertex_cache")), hash_of(path), *words) + ".json")
        if not os.path.exists(kept):
            self.run("bench_vertex_cache", scene, path, *words, "--json", kept + ".part")
            os.replace(kept + ".part", kept)
        with open(kept, encoding="utf-8") as stream:
            return json.load(stream)

    def recoded(self, path, profile):
        """What sightcell info says of the file in another profile."""
        if self.options.quick:
            return None
        out = f"{path[:-len('.pvs')]}-{profile}.pvs"
        if not os.path.exists(out):
            self.run("sightcell", "recode", path, "--profile", profile, "-o", out)
        info = json.loads(self.run("sightcell", "info", out, "--json"))
        info.pop("certificate", None)
        return info


def row_bytes(info):
    return sum(s["size"] for s in info["sections"] if s["name"] in ROWS)


def check(name, facts, info):
    """What the C ABI delivered against what the file says of itself."""
    pairs = [("cells", "cells"), ("polygons", "polygons"), ("draws", "draws"), ("file_bytes", "bytes"),
             ("format_version", "format_version"), ("visible_set_percent", "visible_set_percent"),
             ("ranges_per_cell", "ranges_per_cell")]
    for mine, theirs in pairs:
        if abs(facts[mine] - info[theirs]) > 1e-6 * abs(info[theirs]):
            fail(f"{name}: {mine} is {facts[mine]}, and {info[theirs]} by sightcell info")


def table(title, columns, rows):
    print(f"\n{title}\n\n| {' | '.join(columns)} |\n{'|---' * len(columns)}|")
    for row in rows:
        print(f"| {' | '.join(row)} |")


def facts_table(results):
    def row(r):
        f, info = r["facts"], r["info"]
        return [r["name"], f"{f['polygons']:,}", f"{f['draws']:,}", f"{f['cells']:,}", f"{f['visible_set_percent']:.2f}",
                f"{f['visible_polygons'] / f['cells']:,.0f}", f"{f['polygons_seen'] / max(f['atoms'], 1):.2f}",
                f"{f['runs_per_cell']:,.0f}", f"{f['ranges_per_cell']:,.0f}", f"{info['delta_row_percent']:.0f}",
                f"{f['file_bytes']:,}", f"{info['bits_per_visible_polygon']:.3f}"]

    table(f"Corpora (format version {', '.join(sorted({str(r['facts']['format_version']) for r in results}))})",
          ["", "polygons", "draws", "cells", "visible set %", "polygons per cell", "polygons per atom",
           "runs per cell, source order", "ranges per cell, delivered", "delta rows %", "file bytes", "b/vp"],
          [row(r) for r in results])


def peer_bytes(result, with_dictionary):
    sizes = {name: result["peers"][name]["bytes"] for name in PEERS}
    if with_dictionary:
        sizes["varint_zstd_dictionary"] = result["peers"]["varint_zstd_dictionary"]["bytes_with_dictionary"]
    sizes["whole"] = min(sizes["varint_zstd_whole"], sizes["roaring_zstd_whole"])
    return sizes


def bytes_tables(results):
    kinds = ["roaring", "roaring_zstd", "varint", "varint_zstd_dictionary"]

    def row(r):
        sizes, used = peer_bytes(r, False), r["peers"]["varint_zstd_dictionary"]["dictionary"]
        return [r["name"], f"{r['facts']['file_bytes']:,}", f"{r['sets_bytes']:,}", *(f"{sizes[k]:,}" for k in kinds),
                f"{used:,}", f"{sizes['whole']:,}"]

    table("Bytes", ["", "ours: file", "ours: sets", *(PEERS[k] for k in kinds), "its dictionary",
                    "best whole-file zstd"], [row(r) for r in results])

    def ratios(r, own):
        without, counted = peer_bytes(r, False), peer_bytes(r, True)
        return [size / own for size in (*(without[k] for k in kinds), counted["varint_zstd_dictionary"], without["whole"])]

    for what, own in (("rows", lambda r: r["row_bytes"]), ("sets", lambda r: r["sets_bytes"]), ("file", lambda r: r["facts"]["file_bytes"])):
        found = [ratios(r, own(r)) for r in results]
        rows = [[r["name"], *(f"{v:.2f}" for v in values)] for r, values in zip(results, found)]
        rows.append(["**median**", *(f"{statistics.median(column):.2f}" for column in zip(*found))])
        table(f"Bytes of peers through ours: {what}",
              ["", *(PEERS[k] for k in kinds), "the same, dictionary counted", "best whole-file zstd"], rows)


def parts_table(results):
    kinds = [("source_order", "own"), ("source_order", "differences"), ("stored_order", "own"),
             ("stored_order", "differences"), ("stored_order", "slack"), ("source_order", "slack")]
    found = [[r["parts"][order][rows] / r["parts"]["stored_order"]["differences"] for order, rows in kinds]
             for r in results]
    rows = [[r["name"], f"{r['parts']['stored_order']['differences']:,}", *(f"{v:.2f}" for v in values)]
            for r, values in zip(results, found)]
    rows.append(["**median**", "", *(f"{statistics.median(column):.2f}" for column in zip(*found))])
    table("Bytes of rows without parts of the format, through those with order and differences",
          ["", "with both", "source order, no differences", "source order", "no differences", "both", "and slack of 5 %",
           "source order, slack of 5 %"], rows)


def profiles_table(results):
    for profile in PROFILES:
        found = []
        for r in results:
            exact, other = r["info"], r["profiles"][profile]
            found.append([row_bytes(other) / row_bytes(exact), other["bytes"] / exact["bytes"],
                          other["runs_per_cell"] / exact["runs_per_cell"],
                          other["ranges_per_cell"] / exact["ranges_per_cell"], other["false_visible_percent"]])
        rows = [[r["name"], f"{row_bytes(r['profiles'][profile]):,}", f"{r['profiles'][profile]['bytes']:,}",
                 f"{r['profiles'][profile]['ranges_per_cell']:,.0f}", *(f"{v:.3f}" for v in values)]
                for r, values in zip(results, found)]
        rows.append(["**median**", "", "", "", *(f"{statistics.median(column):.3f}" for column in zip(*found))])
        table(f"Profile {profile}, through exact", ["", "row bytes", "file bytes", "ranges per cell", "rows", "file", "runs",
                                                    "ranges", "false visible %"], rows)


def times_tables(results):
    own = ["to_ranges", "to_indices", "memcpy_of_indices", "move", "ranges", "polygons", "indices"]
    others = ["roaring", "roaring_zstd", "varint", "varint_zstd_dictionary"]
    headings = ["to ranges", "to index list", "memcpy of the same", "move alone", "move, cold", "move, file order", "ranges",
                "polygons", "indices", "CRoaring to ids", "CRoaring + zstd to ids", "varint to runs",
                "varint + zstd + dictionary to runs"]

    def row(r, unit, digits):
        times = r["times"]
        mine, other = ([times["shuffled"][n][unit] for n in names] for names in (own, others))
        values = [*mine[:4], times["cold"]["calls"]["move"][unit], times["file_order"]["move"][unit], *mine[4:], *other]
        return [r["name"], *(f"{v:,.{digits}f}" for v in values)]

    table("Decoding, ns per cell", ["", *headings], [row(r, "ns_per_cell", 0) for r in results])
    table("Decoding, ns per run: ours by range delivered, peers by run in source order", ["", *headings],
          [row(r, "ns_per_run", 1) for r in results])
    clock = statistics.median(r["times"]["clock_ns"] for r in results)
    print(f"\nThe clock's own {clock:.0f} ns are in each time per cell.")


def depths_table(results):
    """To ranges by what a row stands on, and to the index list beside memcpy."""
    def row(r):
        times, rows = r["times"]["shuffled"], r["facts"]["rows_of_depth"]
        by_depth = times["to_ranges"]["ns_per_run_of_depth"]
        listed = times["to_indices"]["ns_per_cell"] / max(times["memcpy_of_indices"]["ns_per_cell"], 1e-9)
        alone = times["indices"]["ns_per_cell"] / max(times["memcpy_of_indices"]["ns_per_cell"], 1e-9)
        return [r["name"], " / ".join(f"{n:,}" for n in rows), *(f"{ns:.1f}" for ns in by_depth),
                *(f"{ns / max(by_depth[0], 1e-9):.2f}" for ns in by_depth[1:]), f"{listed:.2f}", f"{alone:.2f}"]

    table("To ranges by depth of the row, ns per range; to the index list through memcpy of the same bytes",
          ["", "rows of depth 0 / 1 / 2", "own", "depth 1", "depth 2", "1 / own", "2 / own", "lookup to index list / memcpy",
           "indices alone / memcpy"], [row(r) for r in results])


def vertex_table(results):
    found = [r for r in results if r["vertex_cache"]]
    if found:
        table(f"Vertices transformed per polygon of a cell's list, draw by draw (first in, first out, "
              f"{found[0]['vertex_cache']['cache']} vertices)",
              ["", "cells", "stored order", "source order", "by meshoptimizer", "stored / meshoptimizer", "its worst cell"],
              [[r["name"], str(v["cells"]), *(f"{v[k]:.3f}" for k in (
                  "acmr_stored", "acmr_source", "acmr_optimized", "stored_by_optimized", "worst_cell_stored_by_optimized"))]
               for r in found for v in [r["vertex_cache"]]])


def bytes_row(r):
    facts, sizes = r["facts"], peer_bytes(r, False)
    row = {"scene": r["name"], "cells": facts["cells"], "bits_per_visible_polygon": r["info"]["bits_per_visible_polygon"],
           "runs_per_cell": r["info"]["runs_per_cell"], "ranges_per_cell": facts["ranges_per_cell"],
           "difference_rows_percent": r["info"]["delta_row_percent"], "row_bytes": r["row_bytes"], "file_bytes": facts["file_bytes"]}
    for name, peer in (("roaring_zstd", "roaring_zstd"), ("dictionary", "varint_zstd_dictionary"), ("whole_file", "whole")):
        row[name + "_over_rows"] = sizes[peer] / r["row_bytes"]
        row[name + "_over_file"] = sizes[peer] / facts["file_bytes"]
    return row


def parts_row(r):
    source, stored = r["parts"]["source_order"], r["parts"]["stored_order"]
    ours = stored["differences"]
    return {"scene": r["name"], "source_order_no_differences": source["own"] / ours, "source_order": source["differences"] / ours,
            "no_differences": stored["own"] / ours, "slack_5_percent": stored["slack"] / ours,
            "source_order_slack_5_percent": source["slack"] / ours}


def profile_row(r, profile):
    exact, other = r["info"], r["profiles"][profile]
    return {"scene": r["name"], "profile": profile, "rows": row_bytes(other) / row_bytes(exact), "file": other["bytes"] / exact["bytes"],
            "ranges": other["ranges_per_cell"] / exact["ranges_per_cell"], "false_visible_percent": other["false_visible_percent"]}


def decoding_row(r):
    warm, cold = r["times"]["shuffled"], r["times"]["cold"]["calls"]

    def us(call):
        return warm[call]["ns_per_cell"] / 1000.0

    own, depth_1, depth_2 = warm["to_ranges"]["ns_per_run_of_depth"]
    return {"scene": r["name"], "to_ranges_us": us("to_ranges"), "own_rows_ns_per_range": own, "depth_1_ns_per_range": depth_1,
            "depth_2_ns_per_range": depth_2, "move_cold_us": cold["move"]["ns_per_cell"] / 1000.0,
            "to_index_list_us": us("to_indices"), "memcpy_us": us("memcpy_of_indices"), "ids_after_us": us("polygons"),
            "roaring_us": us("roaring"), "roaring_zstd_us": us("roaring_zstd"),
            "runs_zstd_dictionary_us": us("varint_zstd_dictionary")}


def write_results(folder, results):
    frozen = "on frozen cell sets of the default sampler at 1e-4."
    result_files.write(folder, "format_bytes", f"Bytes of exact files beside other codecs, {frozen}", [bytes_row(r) for r in results])
    result_files.write(folder, "format_parts", f"Bytes of rows without parts of the format, over those with stored order and differences, "
                       f"{frozen}", [parts_row(r) for r in results])
    profiles = [profile_row(r, p) for r in results for p in PROFILES if r["profiles"][p]]
    if profiles:
        result_files.write(folder, "format_profiles", f"Files of the profiles balanced and small, over exact ones, {frozen}", profiles)
    result_files.write(folder, "decoding", "Decoding of exact files, microseconds per cell: means over cells of medians, cells in shuffled "
                       "order.", [decoding_row(r) for r in results])
    found = [(r["name"], r["vertex_cache"]) for r in results if r["vertex_cache"]]
    if found:
        keys = {"stored_order": "acmr_stored", "source_order": "acmr_source", "meshoptimizer": "acmr_optimized",
                "stored_over_meshoptimizer": "stored_by_optimized", "worst_cell": "worst_cell_stored_by_optimized"}
        result_files.write(folder, "vertex_cache", f"Vertices transformed per polygon of a cell's list, draw by draw, cache of "
                           f"{found[0][1]['cache']} vertices, first in first out.",
                           [{"scene": name, **{key: v[own] for key, own in keys.items()}} for name, v in found])


def ready_file(text):
    name, _, path = text.partition("=")
    if not path:
        raise argparse.ArgumentTypeError(f"{text} is not NAME=PATH")
    return name, path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--scene", nargs="+", choices=list(CELLS), metavar="NAME")
    parser.add_argument("--file", nargs="+", action="extend", type=ready_file, metavar="NAME=PATH", default=[])
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--quick", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("--json")
    options = parser.parse_args()
    options.file = dict(options.file)
    named = options.scene or ([] if options.file else [name for name in CELLS if name != plan.TOWN])
    named += [name for name in options.file if name not in named]
    bench = Bench(options)
    try:
        results = [r for r in map(bench.measure, named) if r]
    except KeyboardInterrupt:
        fail("stopped; the next run goes on from here")
    if not results:
        fail("no scene is there")
    facts_table(results)
    bytes_tables(results)
    parts_table(results)
    if not options.quick:
        profiles_table(results)
    times_tables(results)
    depths_table(results)
    vertex_table(results)
    write_results(options.results, results)
    if options.json:
        with open(options.json, "w", encoding="utf-8") as stream:
            json.dump(results, stream, indent=1)


if __name__ == "__main__":
    main()
