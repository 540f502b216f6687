"""sightcell-test-drop-polygon takes one polygon out of one cell and nothing else."""
import os
import shlex
import subprocess

import decode_pvs
from harness import ROOT, SETTINGS, read


def text_of(path):
    return list(decode_pvs.Contents(read(path)).text())


def test_one_polygon_goes(folder):
    program = shlex.split(SETTINGS['program'])  # with its emulator in front, where it needs one
    source, target = os.path.join(ROOT, 'tests', 'golden', 'v1_small.pvs'), os.path.join(folder, 'out.pvs')

    def code_of(*arguments):
        return subprocess.run([*program, *arguments], stderr=subprocess.DEVNULL, check=False).returncode

    before = text_of(source)
    line = next(i for i, text in enumerate(before) if text.startswith('cell 3:'))
    polygon = before[line].split()[-1]
    assert code_of(source, target, '3', polygon) == 0
    before[line] = before[line].rsplit(' ', 1)[0]
    assert text_of(target) == before
    assert code_of(target, target, '3', polygon) == 1, 'a polygon that is not there cannot be dropped'
    for wrong in (['3'], ['3', 'x'], ['3', '-1']):
        assert code_of(source, target, *wrong) == 2
    assert code_of(source, target, '9999', '0') == 1
