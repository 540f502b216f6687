"""bench_incremental.py: three edits of a small town. The file of `bake --since` has the bytes of a full bake after each."""
import csv
import os
import sys

import harness
from harness import ROOT, run

BENCHMARK = os.path.join(ROOT, 'tests', 'bench', 'bench_incremental.py')
RAYS, MOST_MISSES = 20000, 20  # the bound of draft cells: 1e-3


def test_three_edits(folder):
    town = os.path.join(folder, 'town.glb')
    harness.write_city(town, polygons=4000)
    code, out, err = run(sys.executable, '-B', BENCHMARK, town, '--bin', harness.BIN, '--cells', 6, '--cell-size', 8,
                         '--quality', 'draft', '--rays', RAYS, '--quick')
    assert code == 0, out + err
    place, *table = out.splitlines()
    assert place.startswith('6 cells, ')
    rows = {row['edit']: row for row in csv.DictReader(table)}
    assert list(rows) == ['removed', 'moved', 'reordered']
    for row in rows.values():
        assert row['equal'] == 'yes'
        assert int(row['misses_found'].split(' of ')[0]) <= MOST_MISSES
    assert [int(rows[edit]['cells_again']) > 0 for edit in rows] == [True, True, False]
