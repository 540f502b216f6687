"""bench_coverage.py on the small town, two cells and two seeds: four bounds for each of two targets, and all hold."""
import os
import re

from harness import BIN, ROOT, run


def test_bounds_hold(folder):
    code, out, err = run(os.path.join(ROOT, "tests", "bench", "bench_coverage.py"), "--bin", BIN, "--scene",
                         "small-town", "--cells", 2, "--seeds", 2, environment={"SIGHTCELL_CACHE": folder})
    assert code == 0, out + err
    rows = re.findall(r"^\| small-town \| (\S+) \| 4 \| 4 \(100.0 %\) \|", out, re.M)
    assert rows == ["0.0001", "1e-05"], out
