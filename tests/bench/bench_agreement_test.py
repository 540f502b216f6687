#!/usr/bin/python3
"""bench_agreement on a tiny town: its JSON has what is promised and its counts add up.

usage: bench_agreement_test.py PROGRAM
"""
import json
import os
import subprocess
import sys
import tempfile

program = sys.argv[1]
with tempfile.TemporaryDirectory() as cache:
    path = os.path.join(cache, "out.json")
    done = subprocess.run([program, "--quick", "--json-file", path], env=dict(os.environ, SIGHTCELL_CACHE=cache),
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{done.returncode}: {done.stderr}")
    with open(path, encoding="utf-8") as stream:
        told = json.load(stream)

assert told["resolution"] == 256, told
results = {result["source"]: result for result in told["results"]}
assert "cpu" in results and "rays" not in results, list(results)
for name, result in results.items():
    assert result["polygons"] == 20000 and result["poses"] == 3, name
    assert result["pixels"] == 3 * 3 * 256 * 256, name
    assert result["different"] == result["coincident"] + result["at_edge"] + result["elsewhere"], name
    assert result["rest"] == result["different"] - result["coincident"], name
    assert abs(result["share"] - result["rest"] / result["pixels"]) < 1e-12, name
    assert result["share"] < 1e-2 and result["device"], name
    assert f"| {result['scene']} | 20000 | 3 | {name} |" in done.stdout, done.stdout
