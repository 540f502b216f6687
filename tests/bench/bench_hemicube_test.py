"""bench_hemicube on a tiny town: its JSON has what is promised, and two runs count the same polygons. No timings."""
import json
import os
import subprocess
import tempfile
import unittest

from harness import program


def bench(cache, *words):
    path = os.path.join(cache, "out.json")
    command = [program('bench_hemicube'), "--quick", "--poses", "2", "--json-file", path, *words]
    done = subprocess.run(command, env=dict(os.environ, SIGHTCELL_CACHE=cache), capture_output=True, text=True,
                          check=False)
    if "no source of hemicubes" in done.stderr:
        raise unittest.SkipTest(done.stderr)
    if done.returncode != 0:
        raise AssertionError(f"{done.returncode}: {done.stderr}")
    with open(path, encoding="utf-8") as stream:
        return json.load(stream), done


class BenchHemicube(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.first, cls.told = bench(cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_every_height_and_source_is_there(self):
        results = self.first["results"]
        self.assertEqual([r["height"] for r in results], ["street", "20"])
        names = list(results[0]["sources"])
        self.assertIn("floor", names)
        self.assertGreater(len(names), 1)
        for result in results:
            self.assertEqual(list(result["sources"]), names)
            self.assertEqual(result["polygons"], 20000)
            self.assertEqual(result["poses"], 2)
            for name, source in result["sources"].items():
                self.assertGreater(source["ms"], 0, name)
                self.assertEqual(len(source["ms_of_poses"]), 2)
                for key in ("wall_ms", "draw_ms", "gather_ms", "statistics_ms"):
                    self.assertIn(key, source)

    def test_counts_are_sane(self):
        for result in self.first["results"]:
            for name, source in result["sources"].items():
                self.assertTrue(source["steady"], name)
                self.assertTrue(all(0 < count < 20000 for count in source["polygons_of_poses"]), name)
                self.assertGreater(source["pixels_seen"], 0, name)

    def test_sources_see_about_the_same(self):
        # Where sources differ is told by the tests of the sources; here it is enough that they drew the same poses.
        for result in self.first["results"]:
            counts = [s["polygons_of_poses"] for s in result["sources"].values()]
            for other in counts[1:]:
                for a, b in zip(counts[0], other):
                    self.assertLess(abs(a - b), 0.05 * max(a, b) + 5)

    def test_memory_of_every_source(self):
        memory = self.first["memory"]["small-town"]
        self.assertEqual(set(memory), set(self.first["results"][0]["sources"]) - {"floor"})
        for source in memory.values():
            self.assertGreaterEqual(source["peak"], source["before"])
            self.assertGreater(source["own"], 0)

    def test_what_a_second_thread_costs_is_printed(self):
        self.assertIn("with two threads", self.told.stdout)

    def test_another_run_counts_the_same(self):
        again, _ = bench(self.folder.name, "--fresh")
        for one, two in zip(self.first["results"], again["results"]):
            for name, source in one["sources"].items():
                self.assertEqual(source["polygons_of_poses"], two["sources"][name]["polygons_of_poses"], name)

    def test_what_is_kept_is_not_measured_again(self):
        before, _ = bench(self.folder.name)
        kept, told = bench(self.folder.name)
        self.assertEqual(kept, before)
        self.assertNotIn("round 1", told.stderr)

    def test_pace_of_the_gpu(self):
        paced, _ = bench(self.folder.name, "--pace", "--no-memory")
        for result in paced["results"]:
            if "gpu" in result["sources"]:
                self.assertGreater(result["sources"]["gpu"]["samples_per_second"], 0)
                self.assertGreater(result["sources"]["gpu"]["plain_draws_per_second"], 0)

    def test_a_missing_scene_is_said_and_skipped(self):
        kept, told = bench(self.folder.name, "--scenes", "small-town", "nowhere.glb")
        self.assertIn("nowhere.glb is skipped", told.stderr)
        self.assertEqual({r["scene"] for r in kept["results"]}, {"small-town"})
