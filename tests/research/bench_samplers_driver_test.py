"""bench_samplers.py on the small town: its tables name every sampler, its page has the figures, and a rerun measures
nothing. No timings are judged."""
import os
import re

import result_files
from harness import BIN, ROOT, run

SAMPLERS = ["guided", "importance-depth", "importance-depth-color", "uniform", "halton", "nir04", "gvs", "gvs++", "agvs"]


def run_bench(folder):
    """What it prints, and the rows of samplers.csv."""
    numbers = os.path.join(folder, "results")
    code, out, err = run(os.path.join(ROOT, "tests", "research", "bench_samplers.py"), "--bin", BIN, "--scene",
                         "small-town", "--quick", "--out", os.path.join(folder, "page"), "--results", numbers,
                         environment={"SIGHTCELL_CACHE": folder})
    assert code == 0, err
    _, pooled = result_files.read(os.path.join(numbers, "samplers_pooled.csv"))
    assert {(row["kind"], row["method"]) for row in pooled} == {(k, m) for k in ("samples", "time") for m in SAMPLERS}
    return out, result_files.read(os.path.join(numbers, "samplers.csv"))[1]


def test_tables_page_and_rerun(folder):
    text, rows = run_bench(folder)
    for heading in ("Equal samples", "Equal time"):
        named = re.findall(r"^\| (\S+) \|", text[text.index(heading):], re.M)
        assert [name for name in SAMPLERS if name not in named] == [], heading
    assert {row["method"] for row in rows} == set(SAMPLERS)
    assert all(int(row["polygons"]) > 0 for row in rows), "a sampler saw nothing"
    out = os.path.join(folder, "page")
    with open(os.path.join(out, "index.html"), encoding="utf-8") as stream:
        page = stream.read()
    pictures = re.findall(r'<img src="([^"]+)"', page)
    assert (page.count("<svg"), len(pictures)) == (6, 2 + 2 * len(SAMPLERS))
    assert [p for p in pictures if not os.path.exists(os.path.join(out, p))] == []
    assert run_bench(folder)[1] == rows, "a rerun has other numbers: it measured what was there"
