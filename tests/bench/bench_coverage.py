#!/usr/bin/python3
"""How often the bound that a bake prints is above the truth: 12 cells, two targets, 40 seeds.

usage: bench_coverage.py --bin FOLDER [--scene NAME ...] [--cells N] [--seeds N] [--threads N] [--results DIR]

--bin: the folder with sightcell-city and bench_samplers. Scenes: the small town of our city (made with seed 2) and
czest3ctf (under SIGHTCELL_DATA; said so where it is missing), or those that are named, as bench_targets.py knows them.
A bound is one of 95 %: of n, at least 95 % less two standard errors of a binomial are to hold, else the exit code is 1.
Truth is of 8,000,000 rays per cell, the same for all seeds; a bound that is below that estimate counts as one that does
not hold. Truth and results are kept under $SIGHTCELL_CACHE (default build/cache), and a rerun does what changed.
"""
import argparse
import math
import os
import statistics
import sys

import bench_targets
import result_files
import sampler_plan as plan
import sampler_runs

TARGETS = (1e-4, 1e-5)
CONFIDENCE = 0.95


def jobs(seeds):
    made = []
    for target in TARGETS:
        for seed in range(1, seeds + 1):
            one = plan.job("target", {**plan.guided(24), "max_pixel_error": target, "seed": seed})
            made.append({**one, "label": f"{target:g} seed {seed}", "target": target})
    return made


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = plan.PRESETS + list(bench_targets.REAL) + [plan.TOWN]
    parser.add_argument("--bin", required=True)
    parser.add_argument("--scene", nargs="+", choices=names, metavar="NAME", default=[plan.TOWN, "czest3ctf"])
    parser.add_argument("--cells", type=int, default=12)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    result_files.add_option(parser)
    options = parser.parse_args()
    plan.check_code(sampler_runs.ROOT)
    bench = sampler_runs.Bench(options.bin, options.threads, lambda name: options.cells, bench_targets.TRUTH,
                                 "-coverage", bench_targets.REAL)
    print("| scene | target | bounds | hold | at least | met | E over bound: mean, largest |\n|---|---|---|---|---|---|---|")
    short, rows = 0, []
    for name in options.scene:
        result = bench.measure(name, jobs(options.seeds))
        for target in TARGETS if result else ():
            cells = [c for job in result["jobs"] if job["target"] == target for c in job["cells"]]
            hold = sum(c["pixel_error"] <= c["upper_bound"] for c in cells)
            least = len(cells) * CONFIDENCE - 2.0 * math.sqrt(len(cells) * CONFIDENCE * (1.0 - CONFIDENCE))
            ratios = [c["pixel_error"] / c["upper_bound"] for c in cells]
            short += hold < least
            rows.append({"scene": name, "target": target, "bounds": len(cells), "hold": hold, "at_least": round(least, 1),
                         "met": sum(c["upper_bound"] <= target for c in cells),
                         "error_over_bound_mean": statistics.fmean(ratios), "error_over_bound_largest": max(ratios)})
            print(f"| {name} | {target:g} | {len(cells)} | {hold} ({100.0 * hold / len(cells):.1f} %) | {least:.1f} | "
                  f"{sum(c['upper_bound'] <= target for c in cells)} | {statistics.fmean(ratios):.2f}, {max(ratios):.2f} |")
    if rows:
        result_files.write(options.results, "coverage", f"How often the bound of a cell is above the truth: {options.cells} "
                           f"cells, {options.seeds} seeds.", rows)
    sys.exit(1 if short else 0)


if __name__ == "__main__":
    main()
