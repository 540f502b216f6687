"""The C library asks for the pages of a cell in the order that docs/streaming.md describes."""
import subprocess

import numpy as np

import harness
from small_site import SmallSite, box_columns, floats, gaps, varints
from streamed_scene import Site, cell_at

PAGES = 90
LOW, HIGH = np.array([-100, -20, -100]), np.array([100, 40, 100])  # meters, around the scene
CELLS = np.array([[[-50, 0, -50], [50, 10, 50]], [[-10, 0, -10], [20, 5, 20]], [[0, 0, 0], [30, 5, 20]]], 'f4')


def random_site(draw, folder):
    """Three cells that overlap; pages of all sizes, weights and places."""
    site = SmallSite()
    lists = [np.sort(draw.choice(PAGES, count, replace=False)).tolist() for count in (PAGES, 40, 60)]
    total = sum(map(len, lists))
    steps = np.sort(draw.integers(0, 256, (2, 3, PAGES)), axis=0)
    middle = draw.integers(0, 230, (3, PAGES))
    small = draw.random(PAGES) < 0.7
    steps[:, :, small] = np.stack([middle, middle + draw.integers(0, 25, (3, PAGES))])[:, :, small]
    headings = draw.integers(0, 256, total)
    headings[draw.random(total) < 0.3] = 255
    site.front |= {
        'counts': varints(4, 1, 2, PAGES, 1, 2, 1, len(CELLS)), 'box': floats([*LOW, *HIGH]),
        'page bytes': varints(*draw.integers(500, 30_000, PAGES).tolist()), 'page hashes': draw.bytes(8 * PAGES),
        'page boxes': steps.astype(np.uint8).tobytes(), 'chunk boxes': box_columns(CELLS[0])}
    site.chunk |= {
        'boxes': box_columns(*CELLS), 'weights': floats(draw.uniform(1, 12, len(CELLS))),
        'page counts': varints(*map(len, lists)), 'pages': b''.join(gaps(*pages) for pages in lists),
        'page weights': draw.integers(0, 90, total).astype(np.uint8).tobytes(),
        'page headings': headings.astype(np.uint8).tobytes()}
    site.write(folder)
    return Site(folder)


def directions_in(pose):
    """Many directions of a view."""
    forward, (wide, high) = pose[3:6] / np.linalg.norm(pose[3:6]), pose[6:]
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    x, y = (grid.ravel()[:, None] for grid in np.meshgrid(np.linspace(-wide, wide, 201), np.linspace(-high, high, 51)))
    return forward, right, up, forward + x * right + y * up


def sectors_in(pose):
    """How much of each sector of headings a view surely shows, and how much it may show: to eighths of a sector."""
    forward, *_, directions = directions_in(pose)
    turns = np.arctan2(directions[:, 2], directions[:, 0]) / np.pi * 32 % 64
    parts = turns.astype(int) % 64
    low, high = np.ones(64), np.zeros(64)  # within each part
    np.minimum.at(low, parts, turns % 1)
    np.maximum.at(high, parts, turns % 1)
    has_middle, has_any = (low < 0.5) & (high > 0.5), low <= high
    has_any[int(np.arctan2(forward[2], forward[0]) / np.pi * 32 % 64)] = True
    return has_middle.reshape(8, 8).mean(axis=1), has_any.reshape(8, 8).mean(axis=1)


def share_of(headings, sectors):
    """In 64ths, rounded down."""
    has = headings[:, None] >> np.arange(8) & 1
    return np.floor(has @ sectors * 64 / np.maximum(has.sum(axis=1), 1) + 1e-9)


def boxes_in(boxes, pose):
    """Boxes of which no plane of the frustum has all corners behind it."""
    forward, right, up, _ = directions_in(pose)
    corners = np.stack([np.where(bits, boxes[:, 1], boxes[:, 0]) for bits in np.ndindex(2, 2, 2)], axis=1) - pose[:3]
    depth, side, height = corners @ forward, corners @ right, corners @ up
    wide, high = pose[6:]
    behind = [depth <= 0, side >= wide * depth, side <= -wide * depth, height >= high * depth, height <= -high * depth]
    return ~np.any([plane.all(axis=1) for plane in behind], axis=0)


class TestRequests:
    def test_pages_in_the_order_of_the_text(self, folder):
        draw = np.random.default_rng(7)
        site = random_site(draw, folder)
        poses = np.zeros((150, 8), 'f4')
        poses[:, :3] = draw.uniform(CELLS[0, 0] + 0.1, CELLS[0, 1] - 0.1, (150, 3))
        poses[75:, :3] = draw.uniform(CELLS[1, 0], CELLS[2, 1], (75, 3))
        poses[:, 3:6] = draw.normal(size=(150, 3)) * [1, 0.3, 1]
        poses[:, 6:] = draw.uniform(0.2, 1.2, (150, 2))
        done = subprocess.run([harness.program('sightcell-test-stream-requests'), folder], check=True, capture_output=True,
                              text=True, input='\n'.join(' '.join(map(str, pose)) for pose in poses))
        lines = [list(map(int, line.split())) for line in done.stdout.splitlines()]
        assert len(lines) == len(poses)
        certain, cells = 0, set()
        for pose, (number, *pages) in zip(poses.astype('f8'), lines):
            cell = cell_at(site, pose[:3])
            assert number == cell.number
            assert sorted(pages) == cell.pages.tolist()
            surely, perhaps = sectors_in(pose)
            inside = boxes_in(site.front.page_boxes[cell.pages], pose)
            value = cell.page_weights() / site.front.page_bytes[cell.pages]
            place = np.searchsorted(cell.pages, pages)
            least, most = ((value * np.maximum(inside * share_of(cell.page_headings, sectors), 1))[place]
                           for sectors in (surely, perhaps))
            of_later_ones = np.maximum.accumulate(least[::-1])[::-1]
            assert (of_later_ones[1:] <= most[:-1] * 1.00001).all(), f'{pose}'
            certain += (most < least * 1.25).mean()
            cells.add(number)
        assert certain > 0.9 * len(poses) and len(cells) == len(CELLS)
