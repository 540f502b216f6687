#!/usr/bin/python3
"""bench_samplers.py on the small town: its tables name every sampler, its page has the figures, and a rerun measures
nothing. No timings are judged.

usage: bench_samplers_driver_test.py BIN
"""
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bench"))
import result_files  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
SAMPLERS = ["guided", "importance-depth", "importance-depth-color", "uniform", "halton", "nir04", "gvs", "gvs++", "agvs"]


def main():
    with tempfile.TemporaryDirectory() as folder:
        out, numbers = os.path.join(folder, "page"), os.path.join(folder, "results")

        def run():
            done = subprocess.run([os.path.join(HERE, "bench_samplers.py"), "--bin", sys.argv[1], "--scene",
                                   "small-town", "--quick", "--out", out, "--results", numbers], capture_output=True,
                                  text=True, check=False, env={**os.environ, "SIGHTCELL_CACHE": folder})
            if done.returncode != 0:
                sys.exit(f"bench_samplers.py ended with {done.returncode}:\n{done.stderr}")
            _, pooled = result_files.read(os.path.join(numbers, "samplers_pooled.csv"))
            if {(row["kind"], row["method"]) for row in pooled} != {(k, m) for k in ("samples", "time") for m in SAMPLERS}:
                sys.exit(f"samplers_pooled.csv has other rows than a quick run: {pooled}")
            return done.stdout, result_files.read(os.path.join(numbers, "samplers.csv"))[1]

        text, rows = run()
        for heading in ("Equal samples", "Equal time"):
            part = text[text.index(heading):]
            named = re.findall(r"^\| (\S+) \|", part, re.M)
            missing = [name for name in SAMPLERS if name not in named]
            if missing:
                sys.exit(f"the table of {heading} lacks {missing}:\n{part}")
        if {row["method"] for row in rows} != set(SAMPLERS) or any(int(row["polygons"]) == 0 for row in rows):
            sys.exit("the CSV lacks a sampler, or one saw nothing")
        with open(os.path.join(out, "index.html"), encoding="utf-8") as stream:
            page = stream.read()
        pictures = re.findall(r'<img src="([^"]+)"', page)
        gone = [p for p in pictures if not os.path.exists(os.path.join(out, p))]
        if page.count("<svg") != 6 or len(pictures) != 2 + 2 * len(SAMPLERS) or gone:
            sys.exit(f"{page.count('<svg')} charts, {len(pictures)} pictures, of which these are missing: {gone}")
        _, again = run()
        if again != rows:
            sys.exit("a rerun has other numbers: it measured what was there")


main()
