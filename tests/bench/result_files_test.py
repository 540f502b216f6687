"""result_files.py: what is written is read again, and a command line names no folder of this machine."""
import os
import sys
import tempfile
import unittest

import result_files


class ResultFiles(unittest.TestCase):
    def test_rows_and_facts_are_read_again(self):
        rows = [{"scene": "a, b", "value": 1.5e-7, "left": None}, {"scene": 'say "c"', "value": 12345678, "left": 0}]
        with tempfile.TemporaryDirectory() as folder:
            result_files.write(os.path.join(folder, "new"), "one", "What: this.", rows, ["first", "second: note"], commit="0123abc")
            self.assertEqual(os.listdir(os.path.join(folder, "new")), ["one.csv"])
            facts, found = result_files.read(os.path.join(folder, "new", "one.csv"))
        self.assertEqual((facts["what"], facts["commit"], facts["note"]), ("What: this.", "0123abc", ["first", "second: note"]))
        self.assertTrue(facts["machine"] and facts["command"])
        self.assertEqual(found, [{"scene": "a, b", "value": "1.5e-07", "left": ""},
                                 {"scene": 'say "c"', "value": "12345678", "left": "0"}])

    def test_rows_have_the_same_columns(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaises(ValueError):
            result_files.write(folder, "one", "", [{"a": 1}, {"b": 2}])

    def test_without_a_folder_nothing_is_written(self):
        result_files.write(None, "one", "", [])

    def test_the_command_is_that_of_any_clone(self):
        own = sys.argv
        try:
            sys.argv = [os.path.join(result_files.FOLDER, "..", "bench_x.py"), "--results", "/tmp/x", "--bin",
                        os.path.join(result_files.ROOT, "build", "dev"), "/data/level one.glb", "--results=/tmp/y", "--", "--seed", "1"]
            self.assertEqual(result_files.command(), "tests/bench/bench_x.py --bin build/dev 'level one.glb' -- --seed 1")
        finally:
            sys.argv = own

    def test_every_published_file_says_how_it_was_made(self):
        for at, _, names in os.walk(result_files.FOLDER):
            for name in names:
                if name.endswith(".csv"):
                    facts, rows = result_files.read(os.path.join(at, name))
                    self.assertTrue(rows, name)
                    for key in ("what", "command", "commit", "machine"):
                        self.assertTrue(facts.get(key), f"{name}: {key}")
