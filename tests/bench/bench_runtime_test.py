#!/usr/bin/python3
"""bench_runtime on small cells and on a golden file: every figure that RESULTS.md shows is there. No timings are judged.

usage: bench_runtime_test.py BENCH_RUNTIME FILE.pvs
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

BENCH, FILE = sys.argv[1:3]


class BenchRuntime(unittest.TestCase):
    def test_rows(self):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "out.json")
            done = subprocess.run([BENCH, FILE, "--quick", "--sizes", "3,60", "--json-file", out], capture_output=True,
                                  text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(out, encoding="utf-8") as stream:
                result = json.load(stream)
        kinds = [(row["kind"], row["cells"]) for row in result["lookups"]]
        self.assertEqual(len(kinds), 6, "three kinds of cells, 1,000 and 10,000 of them")
        for row in result["lookups"]:
            for name in ("bytes_per_cell", "random_ns", "coherent_ns", "frame_ns"):
                self.assertGreater(row[name], 0.0, name)
        lattice = [row for row in result["lookups"] if row["kind"] == "lattice"]
        self.assertLessEqual(max(row["bytes_per_cell"] for row in lattice), 1.0)
        self.assertEqual([row["cold"] for row in result["switches"]], [False, True, False, True])
        small, large = result["switches"][0], result["switches"][2]
        self.assertLess(small["polygons"], large["polygons"])
        for row in result["switches"]:
            self.assertGreaterEqual(row["polygons"], row["ranges"])
            for name in ("move_us", "ranges_us", "polygons_us", "indices_us", "commands_us", "objects_us", "memcpy_us",
                         "roaring_us"):
                self.assertIn(name, row)

    def test_a_file_that_is_none(self):
        done = subprocess.run([BENCH, BENCH, "--quick"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
