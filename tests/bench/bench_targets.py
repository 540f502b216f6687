#!/usr/bin/python3
"""The default sampler at the errors that are asked of it, and beside all others at equal time.

usage: bench_targets.py --bin FOLDER [--scene NAME ...] [--cells N] [--threads N] [--part targets|times] [--results DIR]
    [--json OUT.json]

--bin: the folder with sightcell-city and bench_samplers. Eleven scenes: the city's presets (made with seed 2) and eight
real ones under SIGHTCELL_DATA (said so where they are missing), N cells of each, 8 unless told, spread evenly over all:
open ones, ones with geometry inside, ones that lie in walls in part. Prints Markdown tables. Truth and results are kept
under $SIGHTCELL_CACHE (default build/cache) as those of tests/research/bench_samplers.py are; a rerun does what changed.

--part runs the bounds alone, or equal times alone: equal times take nine tenths of all.

Errors of a cell below 1e-8 count as 1e-8. Rivals have jitter, and 512 pixels, at which they do best in most cells; at one
second those of 256 are there as well.
"""
import argparse
import json
import math
import os
import statistics
import sys

import result_files
import sampler_plan as plan
import sampler_runs

REAL = {**plan.REAL, "denhaag_01": "city/denhaag_01.glb", "colosseum": "building/ancient_colosseum_labyrinth.glb",
        "temple": "foliage/temple.glb", "oacmpctf3": "levels/oacmpctf3.glb"}
TRUTH = {"interval": 1.0, "first_rays": 8_000_000, "max_rays": 8_000_000}
TARGETS = (1e-4, 1e-5, 3e-6)
SECONDS = (0.5, 1.0, 2.0)
LEAST = 1e-8


def target_jobs():
    made = [plan.job("target", {**plan.guided(24), "max_pixel_error": t}) for t in TARGETS]
    for one, target in zip(made, TARGETS):
        one["label"], one["target"] = f"guided to {target:g}", target
    return made


def time_jobs():
    made = []
    for seconds in SECONDS:
        many = 100_000
        group = [plan.guided(many, seconds), plan.rays("gvs", 1000, seconds), plan.rays("gvs++", 1000, seconds)]
        for size in (256, 512) if seconds == 1.0 else (512,):
            group += [plan.hemicubes(m, many, size, True, seconds) for m in ("halton", "nir04", "importance-depth")]
        made += [plan.job("time", s) for s in group]
    return made


def geometric(values):
    return math.exp(statistics.fmean(math.log(v) for v in values))


def errors(job):
    return [max(c["pixel_error"], LEAST) for c in job["cells"]]


def row(*columns):
    return "| " + " | ".join(columns) + " |"


def target_rows(results):
    """A row for each scene and target, then one for all scenes together."""
    rows, pooled = [], {t: [] for t in TARGETS}
    for result in results:
        for job in result["jobs"]:
            if "target" in job:
                pooled[job["target"]] += job["cells"]
                rows.append(target_row(result["name"], job["target"], job["cells"]))
    return rows + [target_row("all", target, cells) for target, cells in pooled.items()]


def target_row(name, target, cells):
    seconds = [c["cpu_seconds"] for c in cells]
    each = [1e6 * c["cpu_seconds"] / max(c["set"], 1) for c in cells]
    return {"scene": name, "target": target, "cells": len(cells),
            "met_by_truth": sum(c["pixel_error"] <= target for c in cells),
            "bound_met": sum(c["upper_bound"] <= target for c in cells),
            "hemicubes": round(statistics.fmean(c["samples"] for c in cells)),
            "million_rays": statistics.fmean(c["rays"] for c in cells) / 1e6,
            "cpu_seconds_mean": statistics.fmean(seconds), "cpu_seconds_median": statistics.median(seconds),
            "cpu_seconds_worst": max(seconds), "pixel_error_mean": statistics.fmean(c["pixel_error"] for c in cells),
            "polygons_in_set": round(statistics.fmean(c["set"] for c in cells)),
            "us_per_polygon_median": statistics.median(each), "us_per_polygon_worst": max(each)}


def print_targets(rows):
    print(row("scene", "target", "met by truth", "bound met", "samples", "rays, M", "CPU s: mean, median, worst",
              "E: mean", "seen", "us per polygon: median, worst"))
    print("|---|---|---|---|---|---|---|---|---|---|")
    for r in rows:
        print(row(r["scene"], f"{r['target']:g}", f"{r['met_by_truth']} of {r['cells']}", f"{r['bound_met']}",
                  f"{r['hemicubes']}", f"{r['million_rays']:.2f}",
                  f"{r['cpu_seconds_mean']:.2f}, {r['cpu_seconds_median']:.2f}, {r['cpu_seconds_worst']:.1f}",
                  f"{r['pixel_error_mean']:.1e}", f"{r['polygons_in_set']:,}",
                  f"{r['us_per_polygon_median']:.0f}, {r['us_per_polygon_worst']:,.0f}"))


def time_table(results, seconds):
    """Geometric means over the cells of a scene, and of all, of E; below how often E is that of guided. Gives rows."""
    groups = {}
    for result in results:
        for job in result["jobs"]:
            if job.get("target") is None and job["settings"]["seconds_per_cell"] == seconds:
                groups.setdefault(job["label"], {})[result["name"]] = job
    ours = next(label for label in groups if label.startswith("guided"))
    names = [r["name"] for r in results]
    print(f"\n#### {seconds:g} s of a core\n")
    print(row("", *names, "all cells", "over guided", "CPU s"))
    print("|---" * (len(names) + 4) + "|")
    own = [e for n in names for e in errors(groups[ours][n])]
    rows = []
    best = [math.inf] * len(own)
    for label, of in groups.items():
        every = [e for n in names for e in errors(of[n])]
        if label != ours:
            best = [min(a, b) for a, b in zip(best, every)]
        spent = [c["cpu_seconds"] for n in names for c in of[n]["cells"]]
        means, total = [geometric(errors(of[n])) for n in names], geometric(every)
        print(row(label, *(f"{mean:.1e}" for mean in means), f"{total:.1e}", f"{total / geometric(own):.2f}",
                  f"{statistics.fmean(spent):.2f}"))
        rows += [{"seconds": seconds, "setting": label, "scene": name, "pixel_error": mean, "over_guided": None,
                  "cpu_seconds": None} for name, mean in zip(names, means)]
        rows.append({"seconds": seconds, "setting": label, "scene": "all", "pixel_error": total,
                     "over_guided": total / geometric(own), "cpu_seconds": statistics.fmean(spent)})
    ratios = sorted(b / o for b, o in zip(best, own))
    print(f"\nBest rival of each cell over guided: median {statistics.median(ratios):.2f}, least {ratios[0]:.2f}, "
          f"greatest {ratios[-1]:.2f}; below 1 in {sum(r < 1.0 for r in ratios)} of {len(ratios)} cells.")
    return rows


def write_targets(results, options):
    rows = target_rows(results)
    print_targets(rows)
    result_files.write(options.results, "targets", f"The default sampler at bounds that are asked for: {options.cells} cells of each "
                       "scene, truth of 8,000,000 rays per cell.", rows)


def write_times(results, options):
    rows = [one for seconds in SECONDS for one in time_table(results, seconds)]
    result_files.write(options.results, "equal_time", "Samplers at equal time of one core: geometric mean of the pixel error over "
                       "the cells of a scene.", rows, ["Errors below 1e-8 count as 1e-8."])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = plan.PRESETS + list(REAL)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--scene", nargs="+", choices=names + [plan.TOWN], metavar="NAME", default=names)
    parser.add_argument("--cells", type=int, default=8)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--part", choices=["targets", "times"])
    result_files.add_option(parser)
    parser.add_argument("--json")
    options = parser.parse_args()
    plan.check_code(sampler_runs.ROOT)
    bench = sampler_runs.Bench(options.bin, options.threads, lambda name: options.cells, TRUTH, "-targets", REAL)
    made = (target_jobs() if options.part != "times" else []) + (time_jobs() if options.part != "targets" else [])
    results = [r for r in (bench.measure(name, made) for name in options.scene) if r]
    if not results:
        sys.exit("bench_targets: no scene is there")
    if options.part != "times":
        write_targets(results, options)
    if options.part != "targets":
        write_times(results, options)
    if options.json:
        with open(options.json, "w", encoding="utf-8") as stream:
            json.dump(results, stream, indent=1)


if __name__ == "__main__":
    main()
