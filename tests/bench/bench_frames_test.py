"""bench_frames.py on a small town: every way draws what it should, nothing is missing, a rerun measures nothing. No timings
are judged."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

from harness import BIN

HERE = os.path.dirname(os.path.abspath(__file__))
WAYS = ["full", "frustum", "pvs_commands", "pvs_indices", "pvs_frustum"]
FRAMES = 60


class BenchFrames(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.told = cls.bench()
        cls.result = cls.read()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def run_program(cls, *command):
        return subprocess.run(command, env=dict(os.environ, SIGHTCELL_CACHE=cls.folder.name), capture_output=True,
                              text=True, check=False)

    @classmethod
    def bench(cls, *words):
        done = cls.run_program(sys.executable, os.path.join(HERE, "bench_frames.py"), "--bin", BIN, "--scene",
                               "small-town", "--frames", str(FRAMES), "--set-cluster", "64", "--json",
                               os.path.join(cls.folder.name, "out.json"), *words)
        if "gl.no-context" in done.stderr or "libEGL" in done.stderr:
            sys.exit(77)
        if done.returncode != 0:
            raise AssertionError(f"{done.returncode}: {done.stderr}")
        return done

    @classmethod
    def read(cls):
        with open(os.path.join(cls.folder.name, "out.json"), encoding="utf-8") as stream:
            result, = json.load(stream)
        return result

    def kept(self, suffix):
        folder = os.path.join(self.folder.name, "bench_frames")
        found, = (os.path.join(folder, f) for f in os.listdir(folder) if f.endswith(suffix))
        return found

    def draw(self, *words):
        scenes = os.path.join(self.folder.name, "bench_format")
        town, = (os.path.join(scenes, f) for f in os.listdir(scenes) if f.endswith(".glb"))
        return self.run_program(os.path.join(BIN, "bench_frames"), "draw", town, *words)

    def test_every_frame_is_there_and_in_a_cell(self):
        self.assertEqual([f["frame"] for f in self.result["frames"]], list(range(FRAMES)))
        self.assertFalse(any(f["outside"] for f in self.result["frames"]))
        self.assertEqual(self.result["polygons"], 20000)
        visited = {f["cell"] for f in self.result["frames"]}
        self.assertGreater(len(visited), 2)
        self.assertLessEqual(len(visited), self.result["cells"])

    def test_counts_of_each_way(self):
        for f in self.result["frames"]:
            full, frustum, commands, indices, both = (f[w] for w in WAYS)
            self.assertEqual(full["polygons"], 20000)
            self.assertLess(frustum["polygons"], 20000)
            self.assertLess(commands["polygons"], 20000)
            self.assertEqual(commands["polygons"], indices["polygons"])
            self.assertLessEqual(both["polygons"], commands["polygons"])
            self.assertGreater(both["polygons"], 0)
            self.assertEqual(full["calls"], full["draws"])
            self.assertEqual(indices["calls"], indices["draws"])
            self.assertGreaterEqual(commands["draws"], commands["calls"])
            self.assertEqual(indices["calls"], commands["calls"])
        mean = {w: sum(f[w]["polygons"] for f in self.result["frames"]) / FRAMES for w in WAYS}
        self.assertLess(mean["pvs_frustum"], 0.8 * mean["pvs_commands"])
        self.assertLess(mean["frustum"], 0.8 * mean["full"])

    def test_sets_change_with_the_cell_alone(self):
        frames = self.result["frames"]
        for before, after in zip(frames, frames[1:]):
            for way in WAYS[2:]:
                self.assertEqual(after[way]["changed"], before["cell"] != after["cell"])

    def test_pictures_are_those_of_the_full_draw(self):
        pixels = self.result["pixels"]
        self.assertGreater(sum(f["seen"] for f in self.result["frames"]) / (pixels * FRAMES), 0.3, "there is something to miss")
        for f in self.result["frames"]:
            self.assertEqual(f["frustum"]["differing"], 0, "a frustum leaves nothing out that is in the picture")
            self.assertEqual(f["pvs_commands"]["differing"], f["pvs_indices"]["differing"])
            self.assertEqual(f["pvs_commands"]["differing"], f["pvs_frustum"]["differing"])
        wrong = sum(f["pvs_commands"]["differing"] for f in self.result["frames"])
        self.assertLess(wrong / (pixels * FRAMES), 1e-3)

    def test_outside_all_cells_everything_is_drawn(self):
        path = os.path.join(self.folder.name, "above.path")
        with open(self.kept(".path"), encoding="utf-8") as stream:
            x, _, z, heading = next(line for line in stream if not line.startswith("#")).split()
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(f"# above all cells\n{x} 80 {z} {heading}\n")
        done = self.draw(self.kept(".merged.pvs"), path)
        self.assertEqual(done.returncode, 0, done.stderr)
        frame, = json.loads(done.stdout)["frames"]
        self.assertTrue(frame["outside"])
        for way in WAYS[2:4]:
            self.assertEqual((frame[way]["polygons"], frame[way]["differing"]), (20000, 0))

    def test_table_has_a_row_for_each_way(self):
        for way in WAYS:
            self.assertEqual(len(re.findall(rf"^\| {way} \|", self.told.stdout, re.M)), 1, way)

    def test_a_rerun_measures_nothing(self):
        again = self.bench()
        self.assertEqual(again.stderr, "")
        self.assertEqual({**self.read(), "cpu_seconds": 0}, {**self.result, "cpu_seconds": 0})

    def test_what_does_not_fit_is_said(self):
        folder = os.path.join(self.folder.name, "bench_frames")
        instanced, = (os.path.join(folder, f) for f in os.listdir(folder)
                      if f.endswith(".pvs") and not f.endswith(".merged.pvs"))
        for pvs, path, word in ((instanced, self.kept(".path"), "merged"), (self.kept(".merged.pvs"), BIN + ".path", "cannot be read"),
                                (self.kept(".merged.pvs"), self.kept(".cells.json"), "four numbers")):
            done = self.draw(pvs, path)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn(word, done.stderr)
