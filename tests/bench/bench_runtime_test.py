"""bench_runtime on small cells and on a golden file: every figure of tests/bench/results is there. No timings are judged."""
import json
import os
import subprocess
import tempfile
import unittest

from harness import BIN, ROOT

BENCH = os.path.join(BIN, "bench_runtime")
FILE = os.path.join(ROOT, "tests", "golden", "v1_small.pvs")


def sizes_of_sets():
    """Of the golden file's cells, as the text beside it has them."""
    with open(os.path.splitext(FILE)[0] + ".txt", encoding="utf-8") as stream:
        return [len(line.split("sees")[1].split()) for line in stream if line.startswith("cell ")]


class BenchRuntime(unittest.TestCase):
    def test_rows(self):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "out.json")
            done = subprocess.run([BENCH, FILE, "--quick", "--sizes", "3,60", "--json-file", out], capture_output=True,
                                  text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(out, encoding="utf-8") as stream:
                result = json.load(stream)
        self.assertEqual([row["kind"] for row in result["lookups"]], 2 * ["lattice", "lattice of two levels", "boxes"])
        for row, cells in zip(result["lookups"], 3 * [1000] + 3 * [10000]):
            self.assertAlmostEqual(row["cells"], cells, delta=cells / 20)
        for row in result["lookups"]:
            for name in ("bytes_per_cell", "random_ns", "coherent_ns", "frame_ns"):
                self.assertGreater(row[name], 0.0, name)
        lattice = [row for row in result["lookups"] if row["kind"] == "lattice"]
        self.assertLessEqual(max(row["bytes_per_cell"] for row in lattice), 1.0)
        self.assertEqual([row["volumes"] for row in result["box_tests"]], [1600])
        for row in result["box_tests"]:
            self.assertTrue(0.1 < row["visible_share"] < 0.5)  # a box touches several volumes, a tenth of which is seen
            for name in ("random_ns", "walking_ns", "with_origin_ns"):
                self.assertGreater(row[name], 0.0, name)
        self.assertEqual([row["cold"] for row in result["switches"]], [False, True, False, True])
        sizes = sizes_of_sets()
        for row, wanted in zip(result["switches"], (3, 3, 60, 60)):
            self.assertEqual(row["file"], FILE)
            self.assertEqual(row["polygons"], sizes[row["cell"]])
            self.assertEqual(abs(row["polygons"] - wanted), min(abs(size - wanted) for size in sizes))
            self.assertGreaterEqual(row["polygons"], row["ranges"])
            for name in ("move_us", "ranges_us", "polygons_us", "indices_us", "commands_us", "objects_us", "memcpy_us",
                         "roaring_us"):
                self.assertIn(name, row)

    def test_a_file_that_is_none(self):
        done = subprocess.run([BENCH, BENCH, "--quick"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)

    def test_a_result_that_cannot_be_written(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([BENCH, "--quick", "--json-file", os.path.join(folder, "none", "out.json")],
                                  capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("cannot be written", done.stderr)
