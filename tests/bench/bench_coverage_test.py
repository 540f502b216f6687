#!/usr/bin/python3
"""bench_coverage.py on the small town, two cells and two seeds: four bounds for each of two targets, and all hold.

usage: bench_coverage_test.py BIN
"""
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))


def main():
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([os.path.join(HERE, "bench_coverage.py"), "--bin", sys.argv[1], "--scene", "small-town",
                               "--cells", "2", "--seeds", "2"], capture_output=True, text=True, check=False,
                              env={**os.environ, "SIGHTCELL_CACHE": folder})
    rows = re.findall(r"^\| small-town \| (\S+) \| 4 \| 4 \(100.0 %\) \|", done.stdout, re.M)
    if done.returncode != 0 or rows != ["0.0001", "1e-05"]:
        sys.exit(f"bench_coverage.py ended with {done.returncode}:\n{done.stdout}{done.stderr}")


main()
