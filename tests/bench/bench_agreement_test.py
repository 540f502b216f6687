"""bench_agreement on a tiny town: its JSON has what is promised and its counts add up."""
import json
import os

from harness import program, run


def test_counts(folder):
    path = os.path.join(folder, "out.json")
    code, out, err = run(program("bench_agreement"), "--quick", "--json-file", path,
                         environment={"SIGHTCELL_CACHE": folder})
    assert code == 0, err
    with open(path, encoding="utf-8") as stream:
        told = json.load(stream)
    assert told["resolution"] == 256, told
    results = {result["source"]: result for result in told["results"]}
    assert "cpu" in results and "rays" not in results, list(results)
    for name, result in results.items():
        assert result["polygons"] == 20000 and result["poses"] == 3, name
        assert result["pixels"] == 3 * 3 * 256 * 256, name
        assert result["different"] == result["coincident"] + result["at_edge"] + result["elsewhere"], name
        assert result["rest"] == result["different"] - result["coincident"], name
        assert abs(result["share"] - result["rest"] / result["pixels"]) < 1e-12, name
        assert result["share"] < 1e-2 and result["device"], name
        assert f"| {result['scene']} | 20000 | 3 | {name} |" in out, out
