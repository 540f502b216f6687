"""Runs bench_samplers, the program that measures samplers, and keeps what it finds under $SIGHTCELL_CACHE.

Imported by bench_targets.py, bench_coverage.py, bench_format.py, bench_frames.py and tests/research/bench_samplers.py.
"""
import hashlib
import json
import os
import subprocess
import sys

import sampler_plan as plan

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def say(text):
    print(text, file=sys.stderr, flush=True)


def hash_of(path):
    total = hashlib.sha256()
    with open(path, "rb") as stream:
        while block := stream.read(1 << 22):
            total.update(block)
    return total.hexdigest()[:32]


class Bench:
    """Measures jobs over a scene's cells. limit: of a scene's name, how many cells, 0 for all; what: of its files' names."""

    def __init__(self, folder, threads, limit, truth, what="", real=None):
        self.folder, self.threads, self.limit, self.truth = folder, threads, limit, truth
        self.what, self.real = what, real or plan.REAL
        self.cache = os.path.abspath(os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "bench_samplers"))
        os.makedirs(self.cache, exist_ok=True)

    def program(self, name):
        path = os.path.join(self.folder, name)
        if not os.path.exists(path):
            sys.exit(f"bench_samplers: {path} is not there; build it: cmake --build --preset release")
        return path

    def scene(self, name):
        """Scene, cells file or None, cell limit; None where the scene is missing."""
        limit = self.limit(name)
        if name in plan.PRESETS + [plan.TOWN]:
            asked = ["--preset", name] if name in plan.PRESETS else ["--polygons", "20000"]
            city = self.program("sightcell-city")
            stem = os.path.join(self.cache, f"{name}-{plan.CITY_SEED}-{hash_of(city)[:16]}")
            scene, cells = stem + ".glb", stem + ".cells.json"
            if not (os.path.exists(scene) and os.path.exists(cells)):
                say(f"making {name}")
                part = stem + ".part.glb"
                subprocess.run([city, *asked, "--seed", str(plan.CITY_SEED), "--out", part, "--cells", cells],
                               check=True, stdout=subprocess.DEVNULL)
                os.replace(part, scene)
            return scene, cells, limit
        data = os.environ.get("SIGHTCELL_DATA")
        scene = data and os.path.join(data, self.real[name])
        if not scene or not os.path.exists(scene):
            say(f"{name} is skipped: " + ("SIGHTCELL_DATA is not set" if not data else f"{scene} is missing"))
            return None
        return scene, None, limit

    def jobs_file(self, name, jobs):
        path = os.path.join(self.cache, f"{name}{self.what}.jobs.json")
        asked = [{"label": j["label"], "settings": j["settings"], "importance": j.get("importance", True),
                  "code": plan.code_of(ROOT, j["settings"]["sampler"])} for j in jobs]
        with open(path, "w", encoding="utf-8") as stream:
            json.dump({"jobs": asked, "truth": self.truth}, stream, indent=1)
        return path

    def run(self, verb, scene, cells, limit, jobs_file, *more):
        command = [self.program("bench_samplers"), verb, scene, "--jobs", jobs_file, *more]
        if cells:
            command += ["--cells", cells]
        if limit:
            command += ["--cell-limit", str(limit)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)  # what it says is in its files

    def measure(self, name, jobs):
        found = self.scene(name)
        if found is None:
            return None
        scene, cells, limit = found
        asked = self.jobs_file(name, jobs)
        out = asked.replace(".jobs.json", ".results.json")
        say(f"{name}: {len(jobs)} settings")
        self.run("measure", scene, cells, limit, asked, "--out", out, "--cache", self.cache, "--threads",
                 str(self.threads))
        with open(out, encoding="utf-8") as stream:
            result = json.load(stream)
        for mine, measured in zip(jobs, result["jobs"]):
            measured.update(mine)  # its settings are those that were asked for, without defaults
        result.update({"name": name, "file": scene, "cells_file": cells, "limit": limit, "jobs_file": asked})
        return result
