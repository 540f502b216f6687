"""scripts/gpu-check run: what it does with programs that succeed and fail. The programs are shell scripts."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import harness

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "gpu-check"
PROGRAMS = ("sightcell", "sightcell-city", "bench_gpu_counters", "bench_hemicube", "bench_agreement", "gpu_test")
WORKS = "#!/bin/sh\necho \"$(basename $0) $*\"\n"


class GpuCheck(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.tmp = pathlib.Path(temporary.name)
        self.folder = self.tmp / "gpu-check"
        for name in ("bin", "lib", "older", "scenes"):
            (self.folder / name).mkdir(parents=True)
        shutil.copy(SCRIPT, self.folder)
        for name in PROGRAMS:
            self.program(name, WORKS)
        (self.folder / "tests.txt").write_text("first_test\tbin/gpu_test\t--gtest_filter=first.*\n")
        (self.folder / "scenes" / "a b.glb").write_text("")

    def program(self, name, text):
        path = self.folder / "bin" / name
        path.write_text(text)
        path.chmod(0o755)

    def check(self, *arguments, **environment):
        return subprocess.run([self.folder / "gpu-check", *arguments], cwd=self.tmp, capture_output=True, text=True,
                              env={**os.environ, **environment}, timeout=60)

    def test_runs_all_steps_and_keeps_a_log_of_each(self):
        done = self.check("run", "out put")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        logs = {path.name for path in (self.tmp / "out put").iterdir()}
        self.assertLessEqual({"bake-auto.log", "bake-a b.log", "tests.log", "test-first_test.log", "pace.log"}, logs)
        self.assertIn("scenes/a b.glb", (self.tmp / "out put" / "bake-auto.log").read_text())
        self.assertIn("--source gpu", (self.tmp / "out put" / "bake-a b.log").read_text())

    def test_names_the_steps_that_fail_and_goes_on(self):
        self.program("bench_agreement", "#!/bin/sh\nexit 3\n")
        self.program("gpu_test", "#!/bin/sh\necho '[  FAILED  ] first.one'\nexit 7\n")
        done = self.check("run")
        self.assertEqual(done.returncode, 1)
        self.assertIn("failed: tests agreement", done.stdout)
        self.assertIn("first_test: exit 7", (self.tmp / "results" / "tests.log").read_text())
        self.assertIn("[  FAILED  ] first.one", done.stdout)
        self.assertTrue((self.tmp / "results" / "pace.log").exists())

    def test_makes_a_town_where_no_scenes_were_packed(self):
        (self.folder / "scenes" / "a b.glb").unlink()
        shutil.copy(harness.program("sightcell-city"), self.folder / "bin")
        done = self.check("run", SIGHTCELL_GPU_STEPS="bake-town")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertGreater((self.folder / "scenes" / "town.glb").stat().st_size, 1_000_000)
        self.assertIn("scenes/town.glb", (self.tmp / "results" / "bake-town.log").read_text())

    def test_runs_the_steps_that_are_named(self):
        done = self.check("run", SIGHTCELL_GPU_STEPS="verify counters")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual({path.name for path in (self.tmp / "results").iterdir()},
                         {"verify.log", "counters.log"})

    def test_without_a_command_it_says_how_it_is_used(self):
        done = self.check()
        self.assertEqual(done.returncode, 2)
        self.assertIn("usage: scripts/gpu-check pack", done.stderr)


if __name__ == "__main__":
    unittest.main()
