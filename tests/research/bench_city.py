#!/usr/bin/python3
"""Makes the city's presets, checks them and measures how much their cells see: the calibration of samples/city.

usage: bench_city.py --bin FOLDER [--preset NAME ...] [--seed N ...] [--cheap | --fine] [--cell-limit N]
                     [--converge CELL] [--quick] [--results DIR] [--json-file OUT.json]

--bin: the folder with sightcell, sightcell-city and bench_city. For each preset and seed: makes the scene twice and
compares the bytes, checks the number of polygons, imports it, prints histograms (bench_city), and bakes its cells as a
dense reference: halton hemicubes and rays down to a small bound, see DENSE and, for what is too dear, COARSER. --cheap:
with the bake's defaults instead. --fine: DENSE for all.
--cell-limit: only so many cells, spread evenly. --converge CELL: bakes that cell alone (its name) with half, once and
twice the samples, to show how much the reference itself still moves. --quick: the smallest preset, one seed, defaults,
four cells.
Results are kept under $SIGHTCELL_CACHE (default build/cache) by content: scene, cells, settings and the program; a bake
that was stopped goes on where it was. Memory is the largest resident set of the child.
"""
import argparse
import ctypes
import hashlib
import json
import os
import re
import resource
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bench"))
import result_files  # noqa: E402

POLYGONS = {"vienna800k": 865_979, "vienna8m": 7_928_519, "hongkong": 2_164_567}
THESIS = {"vienna800k": 3.2, "vienna8m": 0.43, "hongkong": 1.9}  # % visible, mean of its 20 cells
DENSE = {"--sampler": "halton", "--samples": "48", "--resolution": "512", "--max-pixel-error": "1e-4"}
COARSER = {"hongkong": {"--max-pixel-error": "1e-3"}}  # 1e-4 takes minutes per cell where 70,000 polygons are seen
CHEAP = {"--sampler": "importance-depth", "--samples": "24", "--resolution": "256", "--max-pixel-error": "1e-3"}


def say(text):
    print(text, file=sys.stderr, flush=True)


def run(command):
    """Runs a command; gives its standard output, CPU seconds, wall seconds and its largest resident set in bytes."""
    start = time.monotonic()
    try:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    except FileNotFoundError:
        sys.exit(f"bench_city: {command[0]} is not there; build it: cmake --build --preset release")
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 3):
        sys.exit(f"bench_city: {' '.join(command)} ended with {process.returncode}")
    return output, usage.ru_utime + usage.ru_stime, time.monotonic() - start, usage.ru_maxrss * 1024


def digest(*parts):
    total = hashlib.sha256()
    for part in parts:
        if os.path.exists(part):
            with open(part, "rb") as stream:
                while block := stream.read(1 << 22):
                    total.update(block)
        else:
            total.update(part.encode())
        total.update(b"\0")
    return total.hexdigest()[:24]


class Frame(ctypes.Structure):
    _fields_ = [("cell", ctypes.c_uint32), ("flags", ctypes.c_uint32), ("polygon_count", ctypes.c_uint32),
                ("revision", ctypes.c_uint32), ("reserved", ctypes.c_uint32 * 12)]


def cell_sets(library, path):
    """The cells of a .pvs file through the runtime: [(box, polygons in the set)]."""
    runtime = ctypes.CDLL(library)
    db, view, frame = ctypes.c_void_p(), ctypes.c_void_p(), Frame()
    if runtime.sightcell_db_open_file(path.encode(), None, ctypes.byref(db)) != 0:
        sys.exit(f"bench_city: {path} does not open")
    runtime.sightcell_db_cell_count.argtypes = [ctypes.c_void_p]
    out = []
    for cell in range(runtime.sightcell_db_cell_count(db)):
        low, high = (ctypes.c_float * 3)(), (ctypes.c_float * 3)()
        runtime.sightcell_db_cell_box(db, ctypes.c_uint32(cell), low, high)
        eye = (ctypes.c_float * 3)(*[(a + b) / 2 for a, b in zip(low, high)])
        runtime.sightcell_view_create(db, ctypes.byref(view))
        runtime.sightcell_view_move(view, eye, ctypes.byref(frame))
        if frame.cell != cell:
            sys.exit(f"bench_city: {path}: cell {cell} is not found at its own middle")
        out.append((list(low), frame.polygon_count))
        runtime.sightcell_view_destroy(view)
    runtime.sightcell_db_close(db)
    return out


class Bench:
    def __init__(self, options):
        self.bin = options.bin
        self.options = options
        self.cache = os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "bench_city")
        os.makedirs(self.cache, exist_ok=True)

    def settings(self, preset):
        if self.options.cheap or self.options.quick:
            return dict(CHEAP)
        found = dict(DENSE)
        if not self.options.fine:
            found.update(COARSER.get(preset, {}))
        return found

    def program(self, name):
        return os.path.join(self.bin, name)

    def remembered(self, key, measure):
        path = os.path.join(self.cache, key + ".json")
        if not os.path.exists(path):
            result = measure()
            with open(path + ".part", "w", encoding="utf-8") as stream:
                json.dump(result, stream)
            os.replace(path + ".part", path)
        with open(path, encoding="utf-8") as stream:
            return json.load(stream)

    def make(self, preset, seed):
        """The scene and its cells, made twice; the paths."""
        stem = os.path.join(self.cache, f"{preset}-{seed}-{digest(self.program('sightcell-city'))}")
        scene, cells = stem + ".glb", stem + ".cells.json"

        def twice():
            hashes = []
            for _ in range(2):
                command = [self.program("sightcell-city"), "--preset", preset, "--seed", str(seed), "--out", scene,
                           "--cells", cells]
                _, cpu, _, memory = run(command)
                hashes.append((digest(scene), digest(cells)))
            if hashes[0] != hashes[1]:
                sys.exit(f"bench_city: {preset}, seed {seed}: not the same bytes twice")
            return {"hash": hashes[0][0], "make_cpu": cpu, "make_memory": memory, "bytes": os.path.getsize(scene)}

        made = self.remembered(os.path.basename(stem) + ".made", twice)
        if not os.path.exists(scene) or digest(scene) != made["hash"]:
            twice()
        return scene, cells, made

    def import_scene(self, scene):
        def measure():
            output, cpu, wall, memory = run([self.program("sightcell"), "info", scene, "--json"])
            return {"polygons": json.loads(output)["polygons"], "cpu": cpu, "wall": wall, "memory": memory}

        return self.remembered("import-" + digest(self.program("sightcell"), scene), measure)

    def histograms(self, scene):
        def measure():
            path = os.path.join(self.cache, "histograms.json")
            run([self.program("bench_city"), scene, "--json-file", path] + (["--quick"] if self.options.quick else []))
            with open(path, encoding="utf-8") as stream:
                return next(iter(json.load(stream).values()))

        return self.remembered("histograms-" + digest(self.program("bench_city"), scene), measure)

    def bake(self, scene, cells, settings, cell_limit):
        words = [word for pair in sorted(settings.items()) for word in pair]
        if cell_limit:
            words += ["--cell-limit", str(cell_limit)]
        key = "bake-" + digest(self.program("sightcell"), scene, cells, " ".join(words))

        def measure():
            pvs = os.path.join(self.cache, key + ".pvs")
            output, cpu, wall, memory = run([self.program("sightcell"), "bake", scene, "-o", pvs, "--profile", "exact", "--cells-file", cells,
                                             "--json", "--progress", "none"] + words)
            summary = json.loads(output)
            library = os.path.join(self.bin, "..", "lib", "libsightcell.so")
            with open(cells, encoding="utf-8") as stream:
                named = json.load(stream)["cells"]
            sets = {}
            for low, count in cell_sets(library, pvs):
                name = min(named, key=lambda cell: sum(abs(a - b) for a, b in zip(cell["min"], low)))["name"]
                sets[name] = count
            os.remove(pvs)
            return {"summary": summary, "cpu": cpu, "wall": wall, "memory": memory, "sets": sets}

        return self.remembered(key, measure)

    def measure(self, preset, seed):
        scene, cells, made = self.make(preset, seed)
        imported = self.import_scene(scene)
        if imported["polygons"] != POLYGONS[preset]:
            sys.exit(f"bench_city: {preset}, seed {seed}: {imported['polygons']} polygons")
        histograms = self.histograms(scene)
        say(f"{preset}, seed {seed}: {imported['polygons']:,} polygons, same bytes twice; baking")
        baked = self.bake(scene, cells, self.settings(preset), self.options.cell_limit)
        shares = [100.0 * count / POLYGONS[preset] for count in baked["sets"].values()]
        return {"preset": preset, "seed": seed, "polygons": imported["polygons"], "made": made, "import": imported,
                "histograms": histograms, "sets": baked["sets"], "bake": baked["summary"], "bake_cpu": baked["cpu"],
                "bake_memory": baked["memory"], "mean": sum(shares) / len(shares), "min": min(shares),
                "max": max(shares), "thesis": THESIS[preset], "ratio": sum(shares) / len(shares) / THESIS[preset],
                "settings": self.settings(preset)}

    def converge(self, preset, seed, name):
        """One cell with half, once and twice the samples."""
        scene, cells, _ = self.make(preset, seed)
        with open(cells, encoding="utf-8") as stream:
            one = [cell for cell in json.load(stream)["cells"] if cell["name"] == name]
        if not one:
            sys.exit(f"bench_city: {preset}, seed {seed} has no cell '{name}'")
        alone = re.sub(r"\.cells\.json$", "." + name.replace(" ", "-") + ".json", cells)
        with open(alone, "w", encoding="utf-8") as stream:
            json.dump({"cells": one}, stream)
        rows = []
        for factor in (0.5, 1, 2):
            settings = self.settings(preset)
            settings["--samples"] = str(round(float(settings["--samples"]) * factor))
            baked = self.bake(scene, alone, settings, 0)
            rows.append({"preset": preset, "seed": seed, "cell": name, "samples": settings["--samples"],
                         "polygons": baked["sets"][name], "bound": baked["summary"]["max_upper_bound"],
                         "cpu": baked["cpu"]})
        return rows


def print_tables(results, converged):
    print("| preset | seed | polygons | cells | visible, mean | smallest | largest | thesis | ratio | bound of a cell |"
          " bake, CPU s | import, CPU s | import peak | bake peak |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for r in results:
        print(f"| {r['preset']} | {r['seed']} | {r['polygons']:,} | {len(r['sets'])} | {r['mean']:.2f} % | {r['min']:.2f} % |"
              f" {r['max']:.2f} % | {r['thesis']} % | {r['ratio']:.2f} | {r['bake']['max_upper_bound']:.1e} |"
              f" {r['bake_cpu']:.0f} | {r['import']['cpu']:.1f} | {r['import']['memory'] / 2**30:.2f} GiB |"
              f" {r['bake_memory'] / 2**30:.2f} GiB |")
    print()
    print("| share of the polygons |" + "".join(f" {r['preset']}, {r['seed']} |" for r in results))
    print("|---|" + "---|" * len(results))
    for i, (name, _, is_share) in enumerate(results[0]["histograms"]):
        values = [r["histograms"][i][1] for r in results]
        print(f"| {name} |" + "".join(f" {100 * v:.1f} % |" if is_share else f" {v:,.1f} |" for v in values))
    print()
    print("| cell | " + " | ".join(f"{r['preset']}, {r['seed']}" for r in results) + " |")
    print("|---|" + "---|" * len(results))
    for name in sorted({name for r in results for name in r["sets"]}):
        print(f"| {name} |" + "".join(f" {r['sets'].get(name, 0):,} |" for r in results))
    if converged:
        print("\n| preset | seed | cell | samples | polygons in the set | bound | CPU s |\n|---|---|---|---|---|---|---|")
        for row in converged:
            print(f"| {row['preset']} | {row['seed']} | {row['cell']} | {row['samples']} | {row['polygons']:,} |"
                  f" {row['bound']:.1e} | {row['cpu']:.0f} |")


def write_results(folder, results, converged):
    gib = 2.0**30
    result_files.write(folder, "city_presets", "The presets of samples/city beside the published scenes they stand in for: visible share "
                       "per cell.", [{
                           "preset": r["preset"], "seed": r["seed"], "polygons": r["polygons"], "visible_percent_mean": r["mean"],
                           "visible_percent_smallest": r["min"], "visible_percent_largest": r["max"], "thesis_percent": r["thesis"],
                           "ratio": r["ratio"], "largest_cell_bound": r["bake"]["max_upper_bound"],
                           "bake_cpu_seconds": r["bake_cpu"], "make_cpu_seconds": r["made"]["make_cpu"],
                           "import_cpu_seconds": r["import"]["cpu"], "import_wall_seconds": r["import"]["wall"],
                           "import_peak_gib": r["import"]["memory"] / gib, "bake_peak_gib": r["bake_memory"] / gib}
                           for r in results])
    result_files.write(folder, "city_cells", "Cell sets of the presets.", [
        {"preset": r["preset"], "seed": r["seed"], "cell": name, "polygons": count}
        for r in results for name, count in sorted(r["sets"].items())])
    result_files.write(folder, "city_composition", "What the presets of samples/city are made of.", [
        {"measure": name, "scene": r["preset"], "seed": r["seed"], "value": 100.0 * value if is_share else value,
         "unit": "percent" if is_share else ""} for r in results for name, value, is_share in r["histograms"]])
    if converged:
        result_files.write(folder, "city_reference", "How far the reference bake of the presets still moves.", converged)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--preset", nargs="+", choices=list(POLYGONS), default=list(POLYGONS))
    parser.add_argument("--seed", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--cheap", action="store_true")
    parser.add_argument("--fine", action="store_true")
    parser.add_argument("--cell-limit", type=int, default=0)
    parser.add_argument("--converge", metavar="CELL")
    parser.add_argument("--quick", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("--json-file")
    options = parser.parse_args()
    if options.quick:
        options.preset, options.seed, options.cell_limit = ["vienna800k"], [1], 4
    bench = Bench(options)
    results, converged = [], []
    for preset in options.preset:
        for seed in options.seed:
            results.append(bench.measure(preset, seed))
            if options.converge and seed == options.seed[0]:
                converged += bench.converge(preset, seed, options.converge)
    for preset in options.preset:
        print(f"{preset}: bake " + " ".join(word for pair in sorted(bench.settings(preset).items()) for word in pair))
    print()
    print_tables(results, converged)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"\n{used.ru_utime + used.ru_stime:.0f} CPU seconds in this run; what was remembered is not counted again")
    write_results(options.results, results, converged)
    if options.json_file:
        with open(options.json_file, "w", encoding="utf-8") as stream:
            json.dump({"results": results, "converged": converged}, stream, indent=1)


if __name__ == "__main__":
    main()
