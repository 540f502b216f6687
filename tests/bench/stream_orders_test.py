"""Orders, the connection and the matching of bench_streaming.py against what can be counted by hand."""
import numpy as np
import pytest
import stream_network
import stream_orders as orders
import stream_poses

AXES = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, -1]])  # right, up, forward
EYE = np.zeros(3)


def box(low, high):
    return np.array([[low, high]], "f8")


def test_a_box_ahead_is_in_the_frustum():
    assert orders.in_frustum(box((-1, -1, -11), (1, 1, -10)), EYE, AXES)[0]
    assert orders.in_frustum(box((-1, -1, -1), (1, 1, 1)), EYE, AXES)[0]
    assert not orders.in_frustum(box((-1, -1, 10), (1, 1, 11)), EYE, AXES)[0]
    assert not orders.in_frustum(box((12, -1, -11), (13, 1, -10)), EYE, AXES)[0]  # 46 degrees and more to the right
    assert orders.in_frustum(box((9, -1, -11), (10, 1, -10)), EYE, AXES)[0]
    for low, high in ((7, 8), (-8, -7)):  # above 30 degrees, below
        assert not orders.in_frustum(box((-1, low, -11), (1, high, -10)), EYE, AXES)[0]
    for low, high in ((5, 6), (-6, -5)):
        assert orders.in_frustum(box((-1, low, -11), (1, high, -10)), EYE, AXES)[0]


def test_the_rectangle_of_a_box():
    """A face of 2 x 2 m at 10 m: a part of the screen of 20 tan 30 m in height."""
    high = 2 * 10 * np.tan(np.pi / 6)
    share = 4 / (high * high * 16 / 9)
    assert orders.rectangles(box((-1, -1, -10.001), (1, 1, -10)), EYE, AXES)[0] == pytest.approx(share, rel=1e-3)
    assert orders.rectangles(box((-1, -1, 10), (1, 1, 11)), EYE, AXES)[0] == 0  # behind the eye
    assert orders.rectangles(box((-1, -1, -1), (1, 1, 1)), EYE, AXES)[0] == pytest.approx(1)  # around it
    # From behind the eye to 10 m, left of the middle: it reaches from the middle to the border.
    assert orders.rectangles(box((-5, -20, -10), (0, 20, 5)), EYE, AXES)[0] == pytest.approx(0.5)


def test_the_sphere_of_a_box():
    half = np.sqrt(3)  # radius
    angle = orders.sphere_angles(box((-1, -1, -11), (1, 1, -9)), EYE)[0]
    assert angle == pytest.approx(2 * np.pi * (1 - np.sqrt(1 - (half / 10) ** 2)))
    assert orders.sphere_angles(box((-1, -1, -1), (1, 1, 1)), EYE)[0] == pytest.approx(4 * np.pi)


def test_the_largest_value_of_a_rectangle():
    draw = np.random.default_rng(3)
    tiles = draw.random((36, 64))
    ends = np.sort(draw.integers(0, [[64, 36]], (500, 2, 2)), axis=1)
    expected = [tiles[y:top + 1, x:right + 1].max() for (x, y), (right, top) in ends]
    assert (orders.largest_in(tiles, ends[:, 0], ends[:, 1]) == expected).all()


def test_boxes_behind_what_is_visible_fail_the_depth_test():
    depths = np.full((stream_poses.TILES_UP, stream_poses.TILES_ACROSS), 8.0, "f4")  # a wall
    depths[:, stream_poses.TILES_ACROSS // 2:] = np.inf  # that ends in the middle
    boxes = np.concatenate([box((-3, -1, -11), (-1, 1, -10)), box((-3, -1, -11), (-1, 1, -7)), box((1, -1, -11), (3, 1, -10)),
                            box((-3, -1, -11), (1, 1, -10)), box((-3, -1, 10), (-1, 1, 11)), box((-1, -1, -1), (1, 1, 1))])
    assert orders.pass_depth_test(boxes, EYE, AXES, depths).tolist() == [False, True, True, True, False, True]


def test_the_share_of_headings_ahead():
    """A view along -z is 91 degrees wide, from -135 to -45 degrees: sectors 5 and 6 of headings, and half a degree more."""
    view = orders.View.__new__(orders.View)
    view.view, view.axes, view.numbers, view.boxes = 0, AXES, np.arange(5), np.repeat(box((-1, -1, -11), (1, 1, -10)), 5, axis=0)
    view.pose = stream_poses.Pose(EYE, 0.0, 0, None, None, None)
    view.cell = type("Cell", (), {"page_headings": np.array([1 << 5, 0b01100000, 0b00110000, 0b01100011, 255], np.uint8)})
    assert view.share_ahead() == pytest.approx([1, 1, 0.5, 0.5, 0.25])
    view.boxes[0] = box((-1, -1, 10), (1, 1, 11))
    assert view.share_ahead() == pytest.approx([0, 1, 0.5, 0.5, 0.25])


def test_one_file_takes_a_round_trip_and_its_bytes():
    assert stream_network.arrivals([1000], 2.0, 1000, 0.5, 6) == pytest.approx([3.5])


def test_answers_share_the_rate():
    # Two of 500 and 1,000 bytes: the first is there after 1,000 bytes of both, the second after 500 more.
    assert stream_network.arrivals([500, 1000], 0.0, 1000, 0.5, 2) == pytest.approx([1.5, 2.0])


def test_the_next_request_waits_for_a_free_one():
    # One at a time: each takes a round trip and a second.
    assert stream_network.arrivals([1000, 1000, 1000], 0.0, 1000, 0.5, 1) == pytest.approx([1.5, 3.0, 4.5])
    # Two at a time: the third is asked for at 2.5, when both are complete.
    assert stream_network.arrivals([1000, 1000, 1000], 0.0, 1000, 0.5, 2) == pytest.approx([2.5, 2.5, 4.0])


def test_polygons_are_matched_whatever_their_first_corner():
    ours = np.random.default_rng(1).uniform(-5, 5, (200, 3, 3))
    ours = np.concatenate([ours, ours[:20]])  # some are there twice
    order = np.random.default_rng(2).permutation(len(ours))
    assert (stream_poses.keys_of(ours, 1 / 1024) == stream_poses.keys_of(np.roll(ours, 1, axis=1), 1 / 1024)).all()
    packed = np.rint(np.roll(ours, 1, axis=1)[order] * 1024) / 1024
    partner = stream_poses.match(ours, packed)
    assert sorted(partner.tolist()) == list(range(len(ours)))
    np.testing.assert_allclose(np.roll(packed[partner], -1, axis=1), ours, atol=1 / 2048)
    # Without a partner, and facing the other way.
    assert (stream_poses.match(ours[:3], packed[partner[:2]]) == [0, 1, -1]).all()
    assert (stream_poses.match(ours[:2], packed[partner[:2]][:, ::-1]) == -1).all()
