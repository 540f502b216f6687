"""bench_whole_files.py on a small town, with the tools that are in PATH, and its parts on small files."""
import csv
import os
import shutil
import sys

import pytest
from harness import BIN, ROOT, run

sys.path[:0] = [os.path.join(ROOT, "tests", "bench")]
import bench_whole_files as whole  # noqa: E402


def rows_of(folder, name):
    with open(os.path.join(folder, name + ".csv"), encoding="utf-8") as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("# ")))


def test_small_town(folder):
    results = os.path.join(folder, "results")
    code, out, err = run(os.path.join(ROOT, "tests", "bench", "bench_whole_files.py"), "--bin", BIN, "--quick", "--picture-poses", 1,
                         "--results", results, environment={"SIGHTCELL_CACHE": folder})
    assert code == 0, out + err
    assert "no pictures" not in err
    raw = rows_of(results, "whole_files")[0]
    assert float(raw["wrong_percent"]) == 0
    assert raw["method"] == "as it is" and float(raw["grid"]) == 0
    smallest = min(int(raw[key]) for key in ("as_it_is_bytes", "gzip_bytes", "zstd_bytes", "brotli_bytes") if raw[key])
    assert int(raw["smallest_bytes"]) == smallest
    for rate in whole.RATES:  # one request, and then bytes at the rate
        assert float(raw[f"seconds_{rate}"]) == pytest.approx(0.04 + smallest * 8 / (rate * 1e6), rel=1e-4)
    streams = rows_of(results, "whole_files_streamed")
    for row in streams:
        assert 0 <= float(row["wrong_percent"]) <= float(row["worst_percent"]) < 0.1
        assert 0 < float(row["startup_bytes"]) < float(row["bytes_99"]) <= float(row["bytes_99_9"]) <= float(row["bytes_cell"])
        for rate in whole.RATES:  # three round trips: front, cell chunk, page
            assert 0.12 < float(row[f"seconds_99_{rate}"]) <= float(row[f"seconds_99_9_{rate}"]) <= float(row[f"seconds_cell_{rate}"])
    six, in_order = ([row for row in streams if row["requests"] == requests] for requests in whole.REQUESTS)
    assert all(float(b["seconds_cell_100"]) < float(a["seconds_cell_100"]) for a, b in zip(six, in_order, strict=True))
    assert shutil.which("gltfpack") or "gltfpack was not found" in err


def document(**accessor):
    """A primitive drawn by a node of scale 2 below another one of scale 3."""
    return {"scenes": [{"nodes": [0]}], "nodes": [{"scale": [3, 3, 3], "children": [1]}, {"scale": [2, 2, 2], "mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"componentType": 5126, "min": [-1, 0, 0], "max": [7, 5, 3], **accessor}]}


def test_grid():
    assert whole.grid_of(document(), 14) == 0
    assert whole.grid_of(document(componentType=5123), 16) == 6
    assert whole.grid_of(document(componentType=5123, normalized=True), 16) == pytest.approx(6 / 65535)
    draco = document()
    draco["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": {}}
    assert whole.grid_of(draco, 10) == pytest.approx(6 * 8 / 1024)
    assert whole.largest_range(draco) == pytest.approx(48)
    exponents = document(bufferView=0)
    exponents["bufferViews"] = [{"extensions": {"EXT_meshopt_compression": {"filter": "EXPONENTIAL"}}}]
    assert whole.grid_of(exponents, 16) == pytest.approx(6 * 8 / 65536)


def test_without_images(folder):
    path, bare = os.path.join(folder, "a.glb"), os.path.join(folder, "b.glb")
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": 8}, {"buffer": 0, "byteOffset": 8, "byteLength": 7},
             {"buffer": 0, "byteOffset": 16, "byteLength": 4},
             {"buffer": 1, "byteLength": 4, "extensions": {"EXT_meshopt_compression": {"buffer": 0, "byteOffset": 20, "byteLength": 4}}}]
    whole.write_glb(path, {"bufferViews": views, "images": [{"bufferView": 1}]}, b"geometryPICTURE.moreLAST")
    assert whole.without_images(path, bare) == bare
    left, binary = whole.read_glb(bare)
    assert binary == b"geometryURE.moreLAST"  # whole words go
    assert left["bufferViews"][2]["byteOffset"] == 12
    assert left["bufferViews"][3]["extensions"]["EXT_meshopt_compression"]["byteOffset"] == 16
    assert whole.without_images(bare, path) == bare  # none left


def test_best():
    rows = [{"method": "broken", "smallest_bytes": 1, "wrong_percent": 5.0}, {"method": "unknown", "smallest_bytes": 2, "wrong_percent": None},
            {"method": "right", "smallest_bytes": 3, "wrong_percent": 0.05}, {"method": "exact", "smallest_bytes": 9, "wrong_percent": 0.0}]
    assert [row["method"] for row in whole.best_whole_file(rows)] == ["right", "broken"]
