"""bench_viewer.py on a small town."""
import os

import pytest
from harness import BIN, ROOT, run


def test_quick(tmp_path):
    code, out, err = run(os.path.join(ROOT, "tests", "bench", "bench_viewer.py"), "--bin", BIN, "--quick", "--results",
                         tmp_path, environment={"SIGHTCELL_CACHE": str(tmp_path)})
    if "viewer.no-context" in err:
        pytest.skip("no OpenGL under Xvfb")
    assert code == 0, err
    name, poses, polygons, drawn, *_, wrong = (word.strip() for word in out.splitlines()[2].strip("|").split("|"))
    assert (name, int(poses)) == ("small", 8)
    assert 0 < int(drawn.replace(",", "")) < 0.5 * int(polygons.replace(",", ""))
    assert float(wrong) < 1e-3
    assert (tmp_path / "viewer.csv").read_text().startswith("# what: ")
