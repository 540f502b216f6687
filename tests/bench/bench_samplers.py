#!/usr/bin/python3
"""Every sampler on the city's presets and on real scenes: the thesis's tables 5.1 to 5.3 and figures 5.4 to 5.13.

usage: bench_samplers.py --bin FOLDER [--scene NAME ...] [--quick] [--threads N] [--out FOLDER] [--results DIR]
                         [--no-pictures]

--bin: the folder with sightcell-city and bench_samplers. Prints Markdown tables; writes the figures into one HTML page,
OUT/index.html (default build/samplers). Scenes: vienna800k, vienna8m, hongkong (made with seed 2), intel_castle,
candela_city, accident, czest3ctf (under SIGHTCELL_DATA; said so where they are missing); small-town when it is named.
Truth and results are kept under $SIGHTCELL_CACHE (default build/cache) by content: scene, cell, method, settings and
the sources that decide what the method finds. A rerun does what changed.
--quick: vienna800k and czest3ctf with four cells, main rows alone.
"""
import argparse
import hashlib
import json
import os
import resource
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "samplers"))
import plan  # noqa: E402
import report  # noqa: E402
import result_files  # noqa: E402
import tables  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Rays of truth per cell: enough for +-10 % where E is 1e-5, and what the time allows where it is less.
TRUTH = {"interval": 0.1, "first_rays": 1_000_000, "max_rays": 8_000_000}
QUICK_TRUTH = {"interval": 0.1, "first_rays": 1_000_000, "max_rays": 2_000_000}


def say(text):
    print(text, file=sys.stderr, flush=True)


def hash_of(path):
    total = hashlib.sha256()
    with open(path, "rb") as stream:
        while block := stream.read(1 << 22):
            total.update(block)
    return total.hexdigest()[:32]


class Bench:
    """Measures jobs over a scene's cells. limit: of a scene's name, how many cells, 0 for all; what: of its files' names."""

    def __init__(self, folder, threads, limit, truth, what="", real=None):
        self.folder, self.threads, self.limit, self.truth = folder, threads, limit, truth
        self.what, self.real = what, real or plan.REAL
        self.cache = os.path.abspath(os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "bench_samplers"))
        os.makedirs(self.cache, exist_ok=True)

    def program(self, name):
        path = os.path.join(self.folder, name)
        if not os.path.exists(path):
            sys.exit(f"bench_samplers: {path} is not there; build it: cmake --build --preset release")
        return path

    def scene(self, name):
        """Scene, cells file or None, cell limit; None where the scene is missing."""
        limit = self.limit(name)
        if name in plan.PRESETS + [plan.TOWN]:
            asked = ["--preset", name] if name in plan.PRESETS else ["--polygons", "20000"]
            city = self.program("sightcell-city")
            stem = os.path.join(self.cache, f"{name}-{plan.CITY_SEED}-{hash_of(city)[:16]}")
            scene, cells = stem + ".glb", stem + ".cells.json"
            if not (os.path.exists(scene) and os.path.exists(cells)):
                say(f"making {name}")
                part = stem + ".part.glb"
                subprocess.run([city, *asked, "--seed", str(plan.CITY_SEED), "--out", part, "--cells", cells],
                               check=True, stdout=subprocess.DEVNULL)
                os.replace(part, scene)
            return scene, cells, limit
        data = os.environ.get("SIGHTCELL_DATA")
        scene = data and os.path.join(data, self.real[name])
        if not scene or not os.path.exists(scene):
            say(f"{name} is skipped: " + ("SIGHTCELL_DATA is not set" if not data else f"{scene} is missing"))
            return None
        return scene, None, limit

    def jobs_file(self, name, jobs):
        path = os.path.join(self.cache, f"{name}{self.what}.jobs.json")
        asked = [{"label": j["label"], "settings": j["settings"], "importance": j.get("importance", True),
                  "code": plan.code_of(ROOT, j["settings"]["sampler"])} for j in jobs]
        with open(path, "w", encoding="utf-8") as stream:
            json.dump({"jobs": asked, "truth": self.truth}, stream, indent=1)
        return path

    def run(self, verb, scene, cells, limit, jobs_file, *more):
        command = [self.program("bench_samplers"), verb, scene, "--jobs", jobs_file, *more]
        if cells:
            command += ["--cells", cells]
        if limit:
            command += ["--cell-limit", str(limit)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)  # what it says is in its files

    def measure(self, name, jobs):
        found = self.scene(name)
        if found is None:
            return None
        scene, cells, limit = found
        asked = self.jobs_file(name, jobs)
        out = asked.replace(".jobs.json", ".results.json")
        say(f"{name}: {len(jobs)} settings")
        self.run("measure", scene, cells, limit, asked, "--out", out, "--cache", self.cache, "--threads",
                 str(self.threads))
        with open(out, encoding="utf-8") as stream:
            result = json.load(stream)
        for mine, measured in zip(jobs, result["jobs"]):
            measured.update(mine)  # its settings are those that were asked for, without defaults
        result.update({"name": name, "file": scene, "cells_file": cells, "limit": limit, "jobs_file": asked})
        return result


def bench_of(options):
    def limit(name):
        if options.quick:
            return 2 if name == plan.TOWN else 4
        return plan.REAL_CELLS if name in plan.REAL else 0

    return Bench(options.bin, options.threads, limit, QUICK_TRUTH if options.quick else TRUTH,
                 "-quick" if options.quick else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = plan.PRESETS + list(plan.REAL)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--scene", nargs="+", choices=names + [plan.TOWN], metavar="NAME")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--out", default=os.path.join("build", "samplers"))
    result_files.add_option(parser)
    parser.add_argument("--no-pictures", action="store_true")
    options = parser.parse_args()
    plan.check_code(ROOT)
    bench = bench_of(options)
    wanted = options.scene or (["vienna800k", "czest3ctf"] if options.quick else names)
    results = [r for r in (bench.measure(name, plan.jobs_of(name, options.quick)) for name in wanted) if r]
    if not results:
        sys.exit("bench_samplers: no scene is there")
    print(tables.markdown(results))
    print("### Pixel error of rivals (the better of published and best) over that of importance-depth\n")
    print(tables.rival_ratios(results))
    result_files.write(options.results, "samplers", "Samplers against each other: every cell of every setting; means are in "
                       "samplers_pooled.csv.", tables.cell_rows(results))
    result_files.write(options.results, "samplers_pooled", "Samplers against each other: means over the cells of each scene, with the "
                       "published rows of the thesis.", tables.pooled_rows(results))
    report.write(bench, results, options.out, pictures=not options.no_pictures)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{(used.ru_utime + used.ru_stime) / 60:.1f} CPU minutes in this run, of which truth "
          f"{sum(r['truth_cpu_seconds'] for r in results) / 60:.1f}; what was remembered is not counted again")


if __name__ == "__main__":
    main()
