"""bench_samplers on a small town: its JSON has what is promised, and a rerun measures only what is missing. No timings."""
import copy
import glob
import json
import os
import subprocess
import tempfile
import unittest

from harness import program

JOBS = {"jobs": [
    {"label": "depth 24", "code": "one", "settings": {"sampler": "importance-depth", "samples": 24, "resolution": 128}},
    {"label": "nir 24", "code": "one", "settings": {"sampler": "nir04", "samples": 24, "resolution": 128, "jitter": True}},
    {"label": "uniform 6", "code": "one", "settings": {"sampler": "uniform", "samples": 6, "resolution": 64}}],
    "truth": {"interval": 0.5, "first_rays": 20000, "max_rays": 200000}}


def run(*words):
    return subprocess.run([program('bench_samplers'), *words], capture_output=True, text=True, check=False)


def without_source(result):
    """The same but for what says where a figure came from."""
    kept = copy.deepcopy(result)
    for job in kept["jobs"]:
        for cell in job["cells"]:
            del cell["from_cache"]
    return kept


def from_cache(result):
    return [[cell["from_cache"] for cell in job["cells"]] for job in result["jobs"]]


class BenchSamplers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.town, cls.cells = (os.path.join(cls.folder.name, name) for name in ("town.glb", "all.json"))
        subprocess.run([program('sightcell-city'), "--polygons", "20000", "--seed", "2", "--out", cls.town, "--cells", cls.cells], check=True,
                       stdout=subprocess.DEVNULL)
        # Two of its cells, and one in the ground, where no eye can be.
        with open(cls.cells, encoding="utf-8") as stream:
            chosen = json.load(stream)["cells"]
        low = chosen[0]["min"]
        nowhere = {"name": "nowhere", "min": [low[0], -0.02, low[2]], "max": [low[0] + 1, -0.01, low[2] + 1]}
        chosen = [chosen[0], nowhere, chosen[-1]]
        cls.cells = os.path.join(cls.folder.name, "cells.json")
        with open(cls.cells, "w", encoding="utf-8") as stream:
            json.dump({"cells": chosen}, stream)
        cls.cache = os.path.join(cls.folder.name, "cache")
        cls.first, cls.told = cls.measure(JOBS)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def measure(cls, jobs, *words, cache=None):
        asked, out = (os.path.join(cls.folder.name, name) for name in ("jobs.json", "out.json"))
        with open(asked, "w", encoding="utf-8") as stream:
            json.dump(jobs, stream)
        done = run("measure", cls.town, "--cells", cls.cells, "--jobs", asked, "--out", out, "--cache", cache or cls.cache,
                   *words)
        if done.returncode != 0:
            raise AssertionError(f"{done.returncode}: {done.stderr}")
        with open(out, encoding="utf-8") as stream:
            return json.load(stream), done.stderr

    def test_all_is_there_and_sane(self):
        result = self.first
        self.assertEqual(result["polygons"], 20000)
        self.assertEqual(result["left_out"], ["nowhere"])
        self.assertIn("nowhere", self.told)
        self.assertEqual(len(result["cells"]), 2)
        for cell in result["cells"]:
            self.assertGreaterEqual(cell["truth_rays"], 20000)
            self.assertTrue(0 < cell["truth_polygons"] < 20000)
            self.assertTrue(0 < cell["free_share"] <= 1)
        self.assertEqual([job["label"] for job in result["jobs"]], ["depth 24", "nir 24", "uniform 6"])
        for job, asked in zip(result["jobs"], JOBS["jobs"]):
            self.assertEqual({key: job["settings"][key] for key in asked["settings"]}, asked["settings"])
            for one in [*job["cells"], job["pooled"]]:
                self.assertTrue(0 <= one["low"] <= one["pixel_error"] <= one["high"] <= 1, one)
                self.assertTrue(0 <= one["color_error"] <= one["pixel_error"], one)
                self.assertGreater(one["cpu_seconds"], 0)
            for cell in job["cells"]:
                self.assertLessEqual(cell["samples"], asked["settings"]["samples"])
                self.assertTrue(0 < cell["set"] < 20000)
                self.assertLessEqual(cell["misses_effective"], cell["misses"] * 1.0001)
            mean = sum(cell["pixel_error"] for cell in job["cells"]) / 2
            self.assertAlmostEqual(job["pooled"]["pixel_error"], mean)
            sets = sum(cell["set"] for cell in job["cells"]) / 2
            self.assertAlmostEqual(job["pooled"]["visible_percent"], sets / 200)
        errors = [job["pooled"]["pixel_error"] for job in result["jobs"]]
        self.assertLess(errors[0], errors[2], "24 hemicubes against 6 coarse ones")
        self.assertAlmostEqual(result["sampling_cpu_seconds"],
                               sum(cell["cpu_seconds"] for job in result["jobs"] for cell in job["cells"]))

    def test_the_interval_is_as_asked_for_or_said(self):
        for job in self.first["jobs"]:
            pooled = job["pooled"]
            wider = max(pooled["high"] - pooled["pixel_error"], pooled["pixel_error"] - pooled["low"])
            self.assertEqual(pooled["interval_met"], wider <= 0.5 * pooled["pixel_error"])
        strict = copy.deepcopy(JOBS)
        strict["truth"].update(interval=0.001, first_rays=1000, max_rays=5000)
        result, told = self.measure(strict, cache=os.path.join(self.folder.name, "strict"))
        self.assertFalse(result["truth"]["interval_met"])
        self.assertIn("wider than asked for", told)
        self.assertLess(result["truth"]["rays"], 10000)

    def test_a_rerun_takes_all_from_the_cache(self):
        again, told = self.measure(JOBS, "--threads", "1")
        self.assertEqual(without_source(again), without_source(self.first))
        self.assertEqual(from_cache(again), [[True, True]] * 3)
        self.assertEqual(from_cache(self.first), [[False, False]] * 3)
        self.assertNotIn("rays per CPU second", told)

    def test_other_code_or_settings_are_measured_and_nothing_else(self):
        changed = copy.deepcopy(JOBS)
        changed["jobs"][1]["code"] = "two"
        changed["jobs"][2]["settings"]["seed"] = 5
        result, _ = self.measure(changed)
        self.assertEqual(from_cache(result), [[True, True], [False, False], [False, False]])
        old, new = without_source(self.first), without_source(result)
        for key in ("set", "pixel_error", "samples"):
            self.assertEqual([c[key] for c in old["jobs"][1]["cells"]], [c[key] for c in new["jobs"][1]["cells"]])
        self.assertEqual(old["jobs"][0], new["jobs"][0])

    def test_what_is_damaged_is_made_again(self):
        cache = os.path.join(self.folder.name, "damaged")
        first, _ = self.measure(JOBS, cache=cache)
        for kind in ("sampled", "truth", "judgement"):
            file = sorted(glob.glob(os.path.join(cache, "*", "*." + kind)))[0]
            with open(file, "r+b") as stream:
                stream.seek(20)
                byte = stream.read(1)
                stream.seek(20)
                stream.write(bytes([byte[0] ^ 1]))
            again, _ = self.measure(JOBS, cache=cache)
            self.assertEqual([cell for job in from_cache(again) for cell in job].count(False), int(kind == "sampled"), kind)
            self.assertEqual(first["cells"], again["cells"])
            for one, two in zip(first["jobs"], again["jobs"]):
                for a, b in zip(one["cells"], two["cells"]):
                    for key in ("set", "pixel_error", "low", "high", "color_error"):
                        self.assertEqual(a[key], b[key], kind)
        whole, _ = self.measure(JOBS, cache=cache)
        self.assertEqual(without_source(whole), without_source(again))
        self.assertFalse(glob.glob(os.path.join(cache, "*", "*.part")))

    def test_fewer_cells_are_taken_evenly(self):
        limited, _ = self.measure(JOBS, "--cell-limit", "2")  # of three, the first and the last
        self.assertEqual((limited["cells"], limited["left_out"]), (self.first["cells"], []))
        self.assertTrue(all(all(job) for job in from_cache(limited)))

    def command(self, verb, out, *words):
        asked = os.path.join(self.folder.name, "jobs.json")
        with open(asked, "w", encoding="utf-8") as stream:
            json.dump(JOBS, stream)
        with open(self.cells, encoding="utf-8") as stream:
            name = json.load(stream)["cells"][0]["name"]
        return run(verb, self.town, "--cells", self.cells, "--cell", name, "--jobs", asked, "--out", out, *words)

    def test_growth_of_five_faces(self):
        out = os.path.join(self.folder.name, "growth.json")
        done = self.command("growth", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(out, encoding="utf-8") as stream:
            faces = json.load(stream)["faces"]
        self.assertEqual([face["face"] for face in faces], ["-x", "+x", "+y", "-z", "+z"])
        for face in faces:
            self.assertEqual([job["label"] for job in face["jobs"]], [job["label"] for job in JOBS["jobs"]])
            for job, asked in zip(face["jobs"], JOBS["jobs"]):
                self.assertTrue(0 < len(job["sizes"]) <= asked["settings"]["samples"], job)
                self.assertEqual(job["sizes"], sorted(job["sizes"]))
                self.assertTrue(0 < job["sizes"][-1] < 20000)

    def test_pictures_show_what_is_missed(self):
        out = os.path.join(self.folder.name, "pictures")
        done = self.command("pictures", out, "--cache", self.cache)
        if "gl.no-context" in done.stderr:
            self.skipTest(done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        with open(os.path.join(out, "pictures.json"), encoding="utf-8") as stream:
            self.assertEqual(json.load(stream), told)
        names = [told["picture"], told["outside"]]
        for job, measured in zip(told["jobs"], self.first["jobs"]):
            self.assertEqual((job["label"], job["set"]), (measured["label"], measured["cells"][0]["set"]))
            self.assertLess(job["differing_pixels"], told["pixels"] / 4)
            names += [job[key] for key in ("picture", "red", "red_grown", "outside")]
        self.assertGreater(told["jobs"][0]["differing_pixels"], 0, "there it misses most")
        self.assertEqual(sorted(names), sorted(set(os.listdir(out)) - {"pictures.json"}))
        for name in names:
            with open(os.path.join(out, name), "rb") as stream:
                self.assertEqual(stream.read(4), b"\x89PNG")

    def test_unknown_settings_are_refused(self):
        wrong = copy.deepcopy(JOBS)
        wrong["jobs"][0]["settings"]["difference"] = 0.5
        with self.assertRaisesRegex(AssertionError, "no setting of importance-depth"):
            self.measure(wrong)
