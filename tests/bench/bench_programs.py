#!/usr/bin/python3
"""Runs the benchmarks that are programs of their own and writes their tables as CSV files.

usage: bench_programs.py --bin FOLDER --results DIR PROGRAM [-- OPTION ...]

--bin: the folder with the program. PROGRAM: agreement, gpu_counters, hemicube or runtime, which stands for bench_agreement and so on.
After -- options of the program, its --help lists them. What the program prints passes through.
"""
import argparse
import json
import os
import shlex
import subprocess
import sys
import tempfile

import result_files


def agreement(found):
    keys = {"scene": "scene", "polygons": "polygons", "source": "source", "pixels": "pixels", "differ": "different",
            "same_place": "coincident", "rest": "rest", "share": "share", "at_edge": "at_edge", "elsewhere": "elsewhere"}
    rows = [{name: one[key] for name, key in keys.items()} for one in found["results"]]
    yield "agreement", "Pixels of hemicubes whose polygon differs from that of a ray through the pixel center.", rows


def hemicube_row(one):
    any_source = next(iter(one["sources"].values()))
    row = {"scene": one["scene"], "height": one["height"], "pixels_seen": round(any_source["pixels_seen"]),
           "polygons_seen": round(any_source["polygons_seen"])}
    for source in ("cpu", "gpu", "rays"):
        measured = one["sources"].get(source, {})
        row.update({f"{source}_{key}": measured.get(key) for key in ("ms", "draw_ms", "gather_ms", "statistics_ms")})
    return {**row, "floor_ms": one["sources"].get("floor", {}).get("ms")}


def hemicube(found):
    kernels = [name for name in found["results"][0]["sources"] if name.startswith("cpu-")]
    if kernels:
        rows = [{"scene": one["scene"], "height": one["height"], **{f"{name[4:]}_ms": one["sources"][name]["ms"] for name in kernels}}
                for one in found["results"]]
        yield "hemicube_kernels", "Cost of a hemicube by instruction set of the rasterizer.", rows
        return
    rows = [hemicube_row(one) for one in found["results"]]
    yield "hemicubes", "Cost of a hemicube by scene, height above the street and source.", rows
    mib = 2.0**20
    rows = [{"scene": scene, "scene_mib": next(iter(sources.values()))["before"] / mib,
             **{source + "_mib": sources[source]["own"] / mib if source in sources else None for source in ("cpu", "gpu", "rays")}}
            for scene, sources in (found["memory"] or {}).items()]
    yield "hemicubes_memory", "Memory of each hemicube source beyond the scene, at its peak, in MiB.", rows


def gpu_counters(found):
    if "hemicubes" not in found:
        return
    hemicubes = found["hemicubes"]
    rows = [{"scene": os.path.splitext(os.path.basename(hemicubes["scene"]))[0], "resolution": found["resolution"],
             "device": found["device"], "gather": pace["gather"], "culling": pace["culling"], "at_once": pace["at_once"],
             "cpu_ms": pace["cpu_ms_per_sample"], "triangles": pace["triangles_per_sample"], "polygons_seen": pace["polygons_seen"]}
            for pace in hemicubes["paces"]]
    yield "opengl_culling", "Hemicubes of the OpenGL source by way of culling.", rows


def runtime(found):
    rows = [{"cells_are": row["kind"], "cells": row["cells"], "bytes_per_cell": row["bytes_per_cell"], "random_ns": row["random_ns"],
             "along_a_path_ns": row["coherent_ns"], "frame_in_its_cell_ns": row["frame_ns"]} for row in found["lookups"]]
    yield "lookups", "Finding the cell of a place, and a frame that stays in its cell: processor time per call.", rows
    rows = [{"volumes": row["volumes"], "visible_percent": 100.0 * row["visible_share"], "random_ns": row["random_ns"],
             "along_walks_ns": row["walking_ns"], "with_origin_ns": row["with_origin_ns"]} for row in found["box_tests"]]
    yield "box_tests", "sightcell_view_box_visible of a box of 0.6 x 1.8 x 0.6 m among volumes of 2 m in four layers.", rows
    rows = [{"file": os.path.splitext(os.path.basename(row["file"]))[0], "polygons": row["polygons"], "ranges": row["ranges"],
             "cache": "cold" if row["cold"] else "warm", "move_us": row["move_us"], "ranges_us": row["ranges_us"],
             "ids_us": row["polygons_us"], "indices_us": row["indices_us"], "commands_us": row["commands_us"],
             "objects_us": row["objects_us"], "memcpy_us": row["memcpy_us"], "roaring_us": row["roaring_us"]}
            for row in found.get("switches", [])]
    yield "switches", "A change of cell and the outputs after it, microseconds of single calls, medians.", rows


PROGRAMS = {"agreement": agreement, "gpu_counters": gpu_counters, "hemicube": hemicube, "runtime": runtime}


def main():
    own = sys.argv[1:]
    own, more = (own[:own.index("--")], own[own.index("--") + 1:]) if "--" in own else (own, [])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    result_files.add_option(parser)
    parser.add_argument("program", choices=PROGRAMS)
    options = parser.parse_args(own)
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out.json")
        command = [os.path.join(options.bin, "bench_" + options.program), *more]
        done = subprocess.run([*command, "--json-file", out], check=False)
        if done.returncode != 0:
            return done.returncode
        with open(out, encoding="utf-8") as stream:
            found = json.load(stream)
    for name, what, rows in PROGRAMS[options.program](found):
        if rows:
            result_files.write(options.results, name, what, rows, command=shlex.join(command))
    return 0


if __name__ == "__main__":
    sys.exit(main())
