"""bench_streaming.py on a small town, a few cells and poses."""
import os
import re

from harness import BIN, ROOT, read, run


def table(out, order, columns):
    found = re.search(rf"^\| \S+ \| {order} \|" + r" (\S+) \|" * columns + "$", out, re.M)
    assert found, out
    return [float(text) for text in found.groups()]


def test_small_town(folder):
    results = os.path.join(folder, "results")
    asked = [os.path.join(ROOT, "tests", "bench", "bench_streaming.py"), "--bin", BIN, "--quick", "--worst", 1,
             "--results", results]
    environment = {"SIGHTCELL_CACHE": folder}
    code, out, err = run(*asked, environment=environment)
    assert code == 0, out + err
    for order in ("ours", "distance", "projected area", "oracle"):
        *levels, startup, over, over_999, _, waste, soon, later, ceiling, least = table(out, order, 13)
        assert 0 < startup < levels[0] <= levels[1] <= levels[2] <= levels[3]
        assert over >= 0.95 and over_999 >= 0.95  # the oracle is greedy, so it need not be the best
        assert 0 <= waste < 100 and 0 < soon <= later
        assert 99 < least <= ceiling <= 100
    oracle = table(out, "oracle", 13)
    assert oracle[5] == oracle[6] == 1 and oracle[8] == 0  # over itself, and without waste
    # Single polygons are a bound that no order of pages gets below.
    assert table(out, "single polygons", 5)[1] <= table(out, "oracle", 5)[1]
    assert sorted(os.listdir(results)) == ["streaming.csv", "streaming_curves.csv", "streaming_encodings.csv", "streaming_tried.csv"]
    encodings = [table(out, f"{name} \\| {order}", 5) for name in ("as they are", "gzip", "brotli")
                 for order in ("ours", "ours, of sent bytes")]
    assert encodings[0] == encodings[1]
    for larger, smaller in zip(encodings[::2], encodings[2::2]):
        assert all(a > b for a, b in zip(larger, smaller))
    # The first table counts what is sent with gzip.
    assert table(out, "ours", 13)[:4] == encodings[2][1:]
    # A second run takes what the first one has kept, and measures the same.
    first = read(os.path.join(results, "streaming_tried.csv"))
    assert run(*asked, environment=environment)[0] == 0
    assert read(os.path.join(results, "streaming_tried.csv")) == first
