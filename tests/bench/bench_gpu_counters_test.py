"""bench_gpu_counters on a tiny town: what it promises is there, and every way of culling sees the same. No timings."""
import json
import os
import subprocess
import tempfile
import unittest

from harness import program, write_city


def run(*words):
    return subprocess.run([program('bench_gpu_counters'), "--quick", *words], capture_output=True, text=True, check=False)


class BenchGpuCounters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.town = os.path.join(cls.folder.name, "town.glb")
        cls.cells = os.path.join(cls.folder.name, "town.json")
        write_city(cls.town, "--cells", cls.cells, polygons=20000)
        path = os.path.join(cls.folder.name, "out.json")
        cls.told = run(cls.town, "--cells", cls.cells, "--json-file", path)
        if "no headless context" in cls.told.stderr or "libEGL" in cls.told.stderr:
            raise unittest.SkipTest("no EGL device: " + cls.told.stderr)
        if cls.told.returncode != 0:
            raise AssertionError(cls.told.stderr)
        with open(path, encoding="utf-8") as stream:
            cls.result = json.load(stream)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_device_is_named(self):
        self.assertTrue(self.result["device"])
        self.assertIn(self.result["device"], self.told.stdout)

    def test_every_counter_counts(self):
        self.assertEqual(len(self.result["counters"]), 5)
        for name, value in self.result["counters"].items():
            self.assertGreater(value, 1000, name)

    def test_every_way_of_culling_sees_the_same_and_draws_less(self):
        hemicubes = self.result["hemicubes"]
        self.assertEqual((hemicubes["polygons"], hemicubes["poses"]), (20000, 4))
        drawn = {}
        for pace in hemicubes["paces"]:
            self.assertGreater(pace["samples_per_second"], 0)
            self.assertGreater(pace["polygons_seen"], 10)
            self.assertEqual(pace["polygons_seen"], hemicubes["paces"][0]["polygons_seen"], pace)
            drawn.setdefault(pace["culling"], set()).add(pace["triangles_per_sample"])
        self.assertEqual(drawn["none"], {5 * 20000})
        self.assertLess(max(drawn["frustum"]), 5 * 20000)
        if "occlusion" in drawn:
            self.assertLess(max(drawn["occlusion"]), min(drawn["frustum"]))

    def test_wrong_use_is_one_line(self):
        self.assertNotEqual(run(self.town).returncode, 0)
        unwritable = run("--json-file", os.path.join(self.folder.name, "no", "folder.json"))
        self.assertEqual((unwritable.returncode, unwritable.stderr.count("\n")), (1, 1))
