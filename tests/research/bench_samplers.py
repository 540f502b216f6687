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
import os
import resource
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bench"))
import report  # noqa: E402
import result_files  # noqa: E402
import sampler_plan as plan  # noqa: E402
import sampler_runs  # noqa: E402
import tables  # noqa: E402
import thesis  # noqa: E402

# Rays of truth per cell: enough for +-10 % where E is 1e-5, and what the time allows where it is less.
TRUTH = {"interval": 0.1, "first_rays": 1_000_000, "max_rays": 8_000_000}
QUICK_TRUTH = {"interval": 0.1, "first_rays": 1_000_000, "max_rays": 2_000_000}


def bench_of(options):
    def limit(name):
        if options.quick:
            return 2 if name == plan.TOWN else 4
        return thesis.REAL_CELLS if name in plan.REAL else 0

    return sampler_runs.Bench(options.bin, options.threads, limit, QUICK_TRUTH if options.quick else TRUTH,
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
    plan.check_code(sampler_runs.ROOT)
    bench = bench_of(options)
    wanted = options.scene or (["vienna800k", "czest3ctf"] if options.quick else names)
    results = [r for r in (bench.measure(name, thesis.jobs_of(name, options.quick)) for name in wanted) if r]
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
