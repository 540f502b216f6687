"""bench_format.py on a small town: its JSON has what is promised, its sums are those of `sightcell info`, its frozen sets
make the file that a bake writes, and a rerun measures nothing. That peers give the same ids back is checked by bench_format
itself, which fails where one does not. No timings are judged."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

from harness import BIN

HERE = os.path.dirname(os.path.abspath(__file__))
PEERS = ["roaring", "roaring_zstd", "varint", "varint_zstd_dictionary", "varint_zstd_whole", "roaring_zstd_whole"]
CALLS = ["to_ranges", "to_indices", "memcpy_of_indices", "move", "ranges", "polygons", "indices", "roaring",
         "roaring_zstd", "varint", "varint_zstd_dictionary"]


class BenchFormat(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.told = cls.bench("--scene", "small-town")
        cls.result = cls.read()
        cls.kept = [os.path.join(cls.folder.name, "bench_format", f)
                    for f in os.listdir(os.path.join(cls.folder.name, "bench_format"))]
        cls.file, = (f for f in cls.kept if f.endswith(".pvs"))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def run_program(cls, *command):
        return subprocess.run(command, env=dict(os.environ, SIGHTCELL_CACHE=cls.folder.name), capture_output=True,
                              text=True, check=False)

    @classmethod
    def bench(cls, *words):
        done = cls.run_program(sys.executable, os.path.join(HERE, "bench_format.py"), "--bin", BIN, "--quick", "--json",
                               os.path.join(cls.folder.name, "out.json"), *words)
        if done.returncode != 0:
            raise AssertionError(f"{done.returncode}: {done.stderr}")
        return done

    @classmethod
    def read(cls):
        with open(os.path.join(cls.folder.name, "out.json"), encoding="utf-8") as stream:
            result, = json.load(stream)
        return result

    def test_facts_are_those_of_the_file(self):
        done = self.run_program(os.path.join(BIN, "sightcell"), "info", self.file, "--json")
        info, facts = json.loads(done.stdout), self.result["facts"]
        for mine, theirs in (("cells", "cells"), ("polygons", "polygons"), ("draws", "draws"), ("file_bytes", "bytes")):
            self.assertEqual(facts[mine], info[theirs], mine)
        for name in ("visible_set_percent", "ranges_per_cell"):
            self.assertAlmostEqual(facts[name], info[name], msg=name)
        self.assertEqual(facts["file_bytes"], os.path.getsize(self.file))
        self.assertEqual(facts["polygons"], 20000)
        self.assertGreater(facts["cells"], 2)
        self.assertGreaterEqual(facts["visible_polygons"], facts["runs"])
        self.assertGreaterEqual(facts["polygons_seen"], facts["atoms"])
        self.assertGreater(facts["atoms"], 1)
        self.assertLess(self.result["sets_bytes"], facts["file_bytes"])

    def test_every_peer_is_there(self):
        peers, facts = self.result["peers"], self.result["facts"]
        self.assertEqual(list(peers), PEERS)
        self.assertTrue(all(p["bytes"] > 0 for p in peers.values()))
        self.assertGreaterEqual(peers["varint"]["bytes"], 2 * facts["runs"])
        for small, large in (("roaring_zstd", "roaring"), ("varint_zstd_dictionary", "varint"),
                             ("varint_zstd_whole", "varint"), ("roaring_zstd_whole", "roaring")):
            self.assertLess(peers[small]["bytes"], peers[large]["bytes"])
        dictionary = peers["varint_zstd_dictionary"]
        self.assertEqual(dictionary["bytes_with_dictionary"], dictionary["bytes"] + dictionary["dictionary"])
        self.assertEqual(dictionary["bytes_with_dictionary"],
                         min(t["bytes"] + t["dictionary"] for t in dictionary["tries"]))

    def test_every_time_is_there(self):
        times = self.result["times"]
        for order in ("shuffled", "file_order"):
            self.assertEqual(list(times[order]), CALLS)
        self.assertEqual(list(times["cold"]["calls"]), ["move"])
        for calls in (times["shuffled"], times["file_order"], times["cold"]["calls"]):
            for call in calls.values():
                self.assertEqual(set(call), {"ns_per_cell", "ns_per_run", "ns_per_polygon", "worst_cell_ns",
                                             "ns_per_run_of_depth"})
                by_depth = call.pop("ns_per_run_of_depth")
                self.assertTrue(all(value > 0 for value in call.values()))
                if calls is not times["cold"]["calls"]:  # which enters a few cells alone
                    self.assertEqual([ns > 0 for ns in by_depth], [n > 0 for n in self.result["facts"]["rows_of_depth"]])
        self.assertEqual(sum(self.result["facts"]["rows_of_depth"]), self.result["facts"]["cells"])

    def test_vertices_are_counted(self):
        counted = self.result["vertex_cache"]
        self.assertEqual(counted["cells"], 2)
        for order in ("stored", "source", "optimized"):
            self.assertTrue(0.5 <= counted[f"acmr_{order}"] <= 3.0, order)
        self.assertGreaterEqual(counted["stored_by_optimized"], 1.0)
        self.assertLessEqual(counted["stored_by_optimized"], counted["worst_cell_stored_by_optimized"])

    def test_tables_name_the_corpus(self):
        self.assertEqual(self.told.stdout.count("\n| small-town |"), 10)

    def test_each_part_of_the_format_pays(self):
        stored, source = (self.result["parts"][order] for order in ("stored_order", "source_order"))
        self.assertEqual(stored["differences"], self.result["row_bytes"])
        self.assertLess(stored["own"], source["own"])
        self.assertLessEqual(stored["differences"], stored["own"] + 64)
        self.assertLess(stored["slack"], stored["differences"])

    def test_frozen_sets_make_the_file_of_a_bake(self):
        scene, = (f for f in self.kept if f.endswith(".glb"))
        out = os.path.join(self.folder.name, "plain.pvs")
        done = self.run_program(os.path.join(BIN, "sightcell"), "bake", scene, "-o", out, "--max-pixel-error", "1e-4",
                                "--source", "cpu", "--cell-limit", "8", "--profile", "exact")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(out, "rb") as plain, open(self.file, "rb") as merged:
            self.assertEqual(plain.read(), merged.read())

    def test_a_rerun_measures_nothing(self):
        again = self.bench("--scene", "small-town")
        self.assertEqual(again.stderr, "")
        self.assertEqual(self.read(), self.result)

    def test_a_file_that_is_there_is_taken(self):
        self.bench("--file", f"mine={self.file}")
        self.assertEqual({**self.read(), "name": "small-town"}, {**self.result, "vertex_cache": None})

    def test_what_is_no_pvs_is_said(self):
        done = self.run_program(os.path.join(BIN, "bench_format"), os.path.join(HERE, "bench_format.py"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("bench_format.py: ", done.stderr)
