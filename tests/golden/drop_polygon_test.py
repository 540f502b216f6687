#!/usr/bin/env python3
"""sightcell-test-drop-polygon takes one polygon out of one cell and nothing else.

usage: drop_polygon_test.py FILE.pvs PROGRAM...   (PROGRAM... with its emulator in front, where it needs one)
"""
import os
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True  # nothing is written into the source tree
import decode_pvs  # noqa: E402

source, *program = sys.argv[1:]
with open(source, "rb") as file:
    before = list(decode_pvs.Contents(file.read()).text())
with tempfile.TemporaryDirectory() as folder:
    target = os.path.join(folder, "out.pvs")
    line = next(i for i, text in enumerate(before) if text.startswith("cell 3:"))
    polygon = before[line].split()[-1]
    subprocess.run([*program, source, target, "3", polygon], check=True)
    with open(target, "rb") as file:
        after = list(decode_pvs.Contents(file.read()).text())
    before[line] = before[line].rsplit(" ", 1)[0]
    assert after == before, "more than the polygon changed"
    again = subprocess.run([*program, target, target, "3", polygon], stderr=subprocess.DEVNULL)
    assert again.returncode == 1, "a polygon that is not there cannot be dropped"
    for wrong in (["3"], ["3", "x"], ["3", "-1"]):
        assert subprocess.run([*program, source, target, *wrong], stderr=subprocess.DEVNULL).returncode == 2
    assert subprocess.run([*program, source, target, "9999", "0"], stderr=subprocess.DEVNULL).returncode == 1
