"""The curves that plot_streaming.py draws."""
import plot_streaming
import pytest

ROWS = """# note: a line of notes
scene,order,page_bytes,share
town,ours,8192,0.5
town,ours,16384,0.99
town,oracle,8192,0.75
town,oracle,16384,1.0
"""


@pytest.fixture(name="rows")
def rows_of_a_town(tmp_path):
    path = tmp_path / "curves.csv"
    path.write_text(ROWS)
    return path


def test_curves_are_what_is_missing(rows):
    curves = plot_streaming.curves_of(rows)
    assert list(curves) == ["town"] and list(curves["town"]) == ["ours", "oracle"]
    kilobytes, missing = curves["town"]["ours"]
    assert kilobytes == pytest.approx([8.192, 16.384]) and missing == pytest.approx([0.5, 0.01])
    assert curves["town"]["oracle"][1][1] > 0  # on a logarithmic axis


def test_the_same_curves_are_the_same_picture(rows, tmp_path):
    pytest.importorskip("matplotlib", reason="python3-matplotlib is not installed")
    for name in ("a.png", "b.png"):
        plot_streaming.draw(plot_streaming.curves_of(rows), tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes() != b""
