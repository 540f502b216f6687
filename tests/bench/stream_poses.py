"""What bench_streaming.py measures: poses with what is visible from them, and the page of each polygon of a scene."""
import dataclasses
import os
import struct
import sys

import numpy as np

sys.path[:0] = [os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "stream")]
import streamed_scene  # noqa: E402
from gltf_reader import apply, read_draws  # noqa: E402
from matching import partners  # noqa: E402

EVERYWHERE = streamed_scene.EVERYWHERE
VIEWS = 4
TILES_ACROSS, TILES_UP = 64, 36  # from the lower left of a view
HIGH = np.tan(np.pi / 6)  # of a view, at the distance 1 from the eye: half its height and half its width
WIDE = HIGH * 16 / 9


@dataclasses.dataclass
class Pose:
    eye: np.ndarray
    heading: float
    cell: int
    ids: np.ndarray  # of the visible polygons
    angles: np.ndarray  # [n, 1 + VIEWS] in sr: in all directions, and in each view
    depths: np.ndarray  # [VIEWS, TILES_UP, TILES_ACROSS] in meters: the largest one of each tile of each view

    def axes(self, view):
        """Right, up and forward of a view."""
        turned = self.heading + view * np.pi / 2
        forward = np.array([np.sin(turned), 0, -np.cos(turned)])
        return np.array([np.cross(forward, [0, 1, 0]), [0, 1, 0], forward])


def read_poses(path):
    """A file of stream_truth."""
    with open(path, "rb") as stream:
        data = stream.read()
    magic, version, count = struct.unpack_from("<8sII", data)
    if magic != b"SIGHTPOS" or version != 2:
        raise ValueError(f"{path}: no poses")
    poses, at = [], 16
    for _ in range(count):
        x, y, z, heading, cell, polygons = struct.unpack_from("<4fII", data, at)
        at += 24
        ids = np.frombuffer(data, "<u4", polygons, at).astype(np.int64)
        at += 4 * polygons
        angles = np.frombuffer(data, "<f4", polygons * (1 + VIEWS), at).reshape(polygons, 1 + VIEWS).astype("f8")
        at += 4 * angles.size
        depths = np.frombuffer(data, "<f4", VIEWS * TILES_UP * TILES_ACROSS, at).reshape(VIEWS, TILES_UP, TILES_ACROSS)
        at += 4 * depths.size
        poses.append(Pose(np.array([x, y, z], "f4"), heading, cell, ids, angles, depths))
    if at != len(data):
        raise ValueError(f"{path}: cut")
    return poses


def grid_step(corners):
    """The largest power of two of which all coordinates are multiples."""
    steps = np.abs(corners[corners != 0]) * 2.0**40
    if not len(steps):
        return 1.0
    bits = int(np.bitwise_or.reduce(steps.astype(np.int64)))
    return 2.0 ** ((bits & -bits).bit_length() - 1 - 40)


def keys_of(corners, step):
    """A row of whole numbers for each polygon, the same wherever its corners begin."""
    places = np.rint(corners / step).astype(np.int64)
    order = np.lexsort((places[:, :, 2], places[:, :, 1], places[:, :, 0]), axis=1) if len(places) else np.zeros((0, 3), int)
    turned = (order[:, :1] + np.arange(3)) % 3
    return np.take_along_axis(places, turned[:, :, None], axis=1).reshape(-1, 9)


def match(ours, packed):
    """For each polygon of a geometry its number in the pages, -1 where it is in none. Positions in pages are rounded."""
    if not len(ours) or not len(packed):
        return np.full(len(ours), -1)
    step = grid_step(packed)
    partner = match_keys(keys_of(ours, step), keys_of(packed, step))
    # A coordinate between two places of the grid may have been rounded to the other one.
    left, free = np.flatnonzero(partner < 0), np.setdiff1d(np.arange(len(packed)), partner)
    found = partners(ours[left], packed[free], 2 * step)
    partner[left[found >= 0]] = free[found[found >= 0]]
    return partner


def match_keys(ours, packed):
    """Equal rows in their order, one to one."""
    _, names = np.unique(np.concatenate([ours, packed]), axis=0, return_inverse=True)
    names = names.reshape(-1)

    def ranked(part):
        order = np.argsort(part, kind="stable")
        ends = part[order]
        rank = np.empty(len(part), np.int64)
        rank[order] = np.arange(len(part)) - np.searchsorted(ends, ends)
        return part * (len(names) + 1) + rank

    a, b = ranked(names[:len(ours)]), ranked(names[len(ours):])
    order = np.argsort(b)
    at = np.minimum(np.searchsorted(b[order], a), len(b) - 1)
    return np.where(b[order][at] == a, order[at], -1)


@dataclasses.dataclass
class PagesOfScene:
    """Where the polygons of a scene are."""
    draw_first: np.ndarray  # source id of the first polygon of each draw
    page_of: np.ndarray  # by source id; -1: in no page
    same: np.ndarray  # by source id: a number that polygons share which are one in a page
    page_polygons: np.ndarray  # without duplicates
    # The polygons of one draw in one page: their box.
    box_page: np.ndarray
    box_draw: np.ndarray
    boxes: np.ndarray  # [n, 2, 3]


def pages_of_scene(scene, site):
    """Matches the polygons of the .glb with those in the pages: nothing in a page names them."""
    front, draws = site.front, read_draws(scene)
    if [len(draw.local) for draw in draws] != front.geometry_polygons[front.draw_geometry].tolist():
        raise ValueError(f"{scene}: the draws are not those of the site")
    corners, pages = streamed_scene.local_polygons(site)
    firsts = np.cumsum([0, *front.geometry_polygons])
    page_of, same = np.full(front.polygons, -1), np.zeros(front.polygons, np.int64)
    known, box_page, box_draw, boxes = {}, [], [], []
    for number, (draw, geometry) in enumerate(zip(draws, front.draw_geometry)):
        if geometry not in known:
            partner = match(draw.local, corners[geometry])
            known[geometry] = np.where(partner < 0, -1, np.append(pages[geometry], -1)[partner])
        ids = slice(draw.first, draw.first + len(draw.local))
        page_of[ids], same[ids] = known[geometry], firsts[geometry] + np.arange(len(draw.local))
        world = apply(front.draw_matrices[number], corners[geometry])
        for page in np.unique(pages[geometry]):
            part = world[pages[geometry] == page].reshape(-1, 3)
            box_page.append(page)
            box_draw.append(number)
            boxes.append([part.min(axis=0), part.max(axis=0)])
    polygons = np.zeros(len(front.page_bytes), np.int64)
    for numbers in pages:
        polygons += np.bincount(numbers, minlength=len(polygons))
    return PagesOfScene(np.array([draw.first for draw in draws]), page_of, same, polygons, np.array(box_page),
                        np.array(box_draw), np.array(boxes))
