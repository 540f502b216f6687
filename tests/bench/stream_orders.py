"""Orders in which a simulated client of bench_streaming.py can load the pages of a cell."""
import dataclasses

import numpy as np

from stream_poses import EVERYWHERE, HIGH, TILES_ACROSS, TILES_UP, WIDE

LEAST_AHEAD = 1 / 64  # docs/streaming.md
VIEW_FACTOR = 16  # of what is ahead, in orders that were tried
PARTS = 64  # of all headings
NEAR = 0.01  # meters. Boxes around the eye have no projection nearer than this

# The twelve edges of a box, as pairs of its corners.
EDGES = np.array([(a, a | 1 << axis) for a in range(8) for axis in range(3) if not a >> axis & 1])


def corners_of(boxes):
    """[n, 8, 3]"""
    bits = np.arange(8)[:, None] >> np.arange(3) & 1
    return np.take_along_axis(boxes, np.broadcast_to(bits, (len(boxes), 8, 3)), axis=1)


def distances(boxes, eye):
    return np.linalg.norm(np.maximum(np.maximum(boxes[:, 0] - eye, eye - boxes[:, 1]), 0), axis=1)


def in_frustum(boxes, eye, axes):
    """Does no plane of the frustum have the whole box behind it?"""
    right, up, forward = axes
    planes = np.array([forward, WIDE * forward + right, WIDE * forward - right, HIGH * forward + up, HIGH * forward - up])
    farthest = np.where(planes[None] > 0, boxes[:, None, 1] - eye, boxes[:, None, 0] - eye)
    return ((farthest * planes).sum(axis=2) > 0).all(axis=1)


def screen_rectangles(boxes, eye, axes):
    """The rectangle around each projected box, [n, 2] from -1 to 1 each, and the depth of its nearest corner in front."""
    places = (corners_of(boxes) - eye) @ axes.T  # right, up, depth
    a, b = places[:, EDGES[:, 0]], places[:, EDGES[:, 1]]
    with np.errstate(divide="ignore", invalid="ignore"):
        cut = a + (b - a) * ((NEAR - a[:, :, 2:]) / (b[:, :, 2:] - a[:, :, 2:]))
    crosses = (a[:, :, 2] < NEAR) != (b[:, :, 2] < NEAR)
    cut[:, :, 2][crosses] = NEAR
    points = np.concatenate([places, cut], axis=1)
    there = np.concatenate([places[:, :, 2] >= NEAR, crosses], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        screen = points[:, :, :2] / points[:, :, 2:] / (WIDE, HIGH)
    low = np.clip(np.where(there[:, :, None], screen, np.inf).min(axis=1), -1, 1)
    high = np.clip(np.where(there[:, :, None], screen, -np.inf).max(axis=1), -1, 1)
    return low, high, np.where(there, points[:, :, 2], np.inf).min(axis=1)


def rectangles(boxes, eye, axes):
    """The share of the screen that the rectangle around each projected box takes."""
    low, high, _ = screen_rectangles(boxes, eye, axes)
    return np.prod(np.maximum(high - low, 0), axis=1) / 4


def largest_in(tiles, first, last):
    """The largest value of each rectangle of tiles, from four overlapping squares or rectangles of powers of two."""
    levels = np.floor(np.log2(last - first + 1)).astype(int)  # [n, 2] in x and y
    out = np.empty(len(first))
    for level in np.unique(levels, axis=0):
        wide, high = 2 ** level
        windows = np.lib.stride_tricks.sliding_window_view(tiles, (high, wide)).max(axis=(2, 3))
        at = np.flatnonzero((levels == level).all(axis=1))
        (x, y), (right, top) = first[at].T, (last[at] - 2 ** level + 1).T
        out[at] = np.max([windows[y, x], windows[y, right], windows[top, x], windows[top, right]], axis=0)
    return out


def pass_depth_test(boxes, eye, axes, depths):
    """Boxes in the frustum whose nearest corner is not behind the largest depth of all tiles that they are in."""
    low, high, near = screen_rectangles(boxes, eye, axes)
    count = np.array([TILES_ACROSS, TILES_UP])
    first = np.clip(np.floor((low + 1) / 2 * count), 0, count - 1).astype(int)
    last = np.clip(np.floor((high + 1) / 2 * count), 0, count - 1).astype(int)
    return in_frustum(boxes, eye, axes) & (near <= largest_in(depths, first, np.maximum(last, first)))


def sphere_angles(boxes, eye):
    """The solid angle of the sphere around each box."""
    radius = np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1) / 2
    away = np.linalg.norm(boxes.mean(axis=1) - eye, axis=1)
    sine = np.minimum(radius / np.maximum(away, 1e-9), 1)
    return np.where(away <= radius, 4 * np.pi, 2 * np.pi * (1 - np.sqrt(1 - sine * sine)))


def sums(at, values, count):
    return np.bincount(at, values, minlength=count)


@dataclasses.dataclass
class Scene:
    """A site as its client sees it, and what only this measurement knows: where its polygons are."""
    front: object
    pages: object  # PagesOfScene
    sent: object  # bytes of each page as a server sends it

    @property
    def count(self):
        return len(self.front.page_bytes)


class View:
    """One view from a pose, or all directions (view None): what can arrive, and the pages that a client asks for."""

    def __init__(self, scene, pose, cell, view):
        self.scene, self.pose, self.cell, self.view = scene, pose, cell, view
        front, where = scene.front, scene.pages
        everywhere = front.draw_flags & EVERYWHERE > 0
        draws = np.zeros(len(front.draw_geometry), bool)
        draws[cell.draws], draws[everywhere] = True, True
        listed = np.zeros(scene.count + 1, bool)  # the last one: no page
        listed[cell.pages], listed[front.everywhere] = True, True
        angle = pose.angles[:, 0 if view is None else 1 + view]
        seen = angle > 0
        ids, angle = pose.ids[seen], angle[seen]
        of_page = where.page_of[ids]
        drawn = draws[np.searchsorted(where.draw_first, ids, side="right") - 1]
        self.weight = angle.sum()
        self.page_ceiling = angle[listed[of_page]].sum() / max(self.weight, 1e-12)
        arrives = listed[of_page] & drawn
        self.ceiling = angle[arrives].sum() / max(self.weight, 1e-12)
        self.ids, self.angles, self.of_page = ids[arrives], angle[arrives], of_page[arrives]
        self.true = sums(self.of_page, self.angles, scene.count)
        self.draws, self.numbers = draws, cell.pages
        self.bytes = front.page_bytes[cell.pages].astype("f8")
        self.boxes = front.page_boxes[cell.pages]
        self.weights = cell.page_weights()
        self.axes = None if view is None else pose.axes(view)

    def in_view(self, boxes):
        return np.ones(len(boxes), bool) if self.view is None else in_frustum(boxes, self.pose.eye, self.axes)

    def share_ahead(self):
        """How much of the headings of each page, eight sectors of 45 degrees, is in the view; 0 where its box is not."""
        if self.view is None:
            return np.ones(len(self.numbers))
        right, _, forward = self.axes
        middles = (np.arange(PARTS) + 0.5) * 2 * np.pi / PARTS
        ways = np.stack([np.cos(middles), np.zeros(PARTS), np.sin(middles)], axis=1)
        sectors = (np.abs(ways @ right) < WIDE * (ways @ forward)).reshape(8, -1).mean(axis=1)
        has = self.cell.page_headings[:, None] >> np.arange(8) & 1
        return has @ sectors / np.maximum(has.sum(axis=1), 1) * self.in_view(self.boxes)

    def area(self, boxes):
        if self.view is None:
            return sphere_angles(boxes, self.pose.eye)
        return rectangles(boxes, self.pose.eye, self.axes)

    def draw_boxes(self):
        """Boxes of the polygons of one draw in one page, of draws that the cell lists."""
        where = self.scene.pages
        chosen = self.draws[where.box_draw]
        return where.box_page[chosen], where.boxes[chosen]

    def by(self, *keys):
        """Page numbers, the largest keys first; the first key counts most."""
        return self.numbers[np.lexsort((self.numbers, *(-np.asarray(key, "f8") for key in reversed(keys))))]


def ours_of(view, sizes):
    """By the weight over these sizes."""
    return view.by(view.weights / sizes * np.maximum(view.share_ahead(), LEAST_AHEAD))


def ours(view):
    return ours_of(view, view.bytes)


def distance(view):
    return view.by(-distances(view.boxes, view.pose.eye))


def distance_in_view(view):
    return view.by(view.in_view(view.boxes), -distances(view.boxes, view.pose.eye))


def area_of_rectangle(view):
    away = -distances(view.boxes, view.pose.eye)
    return view.by(view.area(view.boxes) / view.bytes, away)


def area_of_sphere(view):
    inside = view.in_view(view.boxes)
    return view.by(inside, sphere_angles(view.boxes, view.pose.eye) / view.bytes)


def distance_of_draws(view):
    """To the nearest draw of the page that is in the frustum, then to the nearest one."""
    of, boxes = view.draw_boxes()
    away, inside = distances(boxes, view.pose.eye), view.in_view(boxes)
    nearest = np.full((2, view.scene.count), np.inf)
    np.minimum.at(nearest[0], of[inside], away[inside])
    np.minimum.at(nearest[1], of, away)
    return view.by(*(-np.minimum(nearest[:, view.numbers], 1e9)))


def area_of_draws(view):
    """Projected area with the boxes of draws instead of those of pages."""
    of, boxes = view.draw_boxes()
    area = sums(of, view.area(boxes), view.scene.count)[view.numbers]
    return view.by(area / view.bytes, -distances(view.boxes, view.pose.eye))


def depth_test(view, boxes):
    """What a hierarchical Z of the whole scene in this view would say (Greene, Kass and Miller 1993)."""
    if view.view is None:
        return np.ones(len(boxes), bool)
    return pass_depth_test(boxes, view.pose.eye, view.axes, view.pose.depths[view.view])


def hierarchical_z(view):
    """Those that pass the depth test first, by projected area."""
    passes = depth_test(view, view.boxes)
    return view.by(passes, view.area(view.boxes) / view.bytes, -distances(view.boxes, view.pose.eye))


def hierarchical_z_of_draws(view):
    """By the projected area of the boxes of draws that pass it."""
    of, boxes = view.draw_boxes()
    area = sums(of, view.area(boxes) * depth_test(view, boxes), view.scene.count)[view.numbers]
    return view.by(area / view.bytes, -distances(view.boxes, view.pose.eye))


def oracle(view):
    return view.by(view.true[view.numbers] / view.scene.sent[view.numbers])


# Tried beside them, to see what is missing. Those that end with "pose" or "view" know what no client knows.

def ours_without_view(view):
    return view.by(view.weights / view.bytes)


def ours_sixteen_times(view):
    return view.by(view.weights / view.bytes * np.where(view.share_ahead() > 0, VIEW_FACTOR, 1))


def ours_boxes_alone(view):
    return view.by(view.weights / view.bytes * np.where(view.in_view(view.boxes), VIEW_FACTOR, 1))


def ours_view_first(view):
    return view.by(view.share_ahead() > 0, view.weights / view.bytes)


def draws_in_view(view):
    """Pages that have a draw whose box is in the frustum."""
    of, boxes = view.draw_boxes()
    return sums(of[view.in_view(boxes)], None, view.scene.count)[view.numbers] > 0


def ours_boxes_of_draws(view):
    return view.by(view.weights / view.bytes * np.where(draws_in_view(view), VIEW_FACTOR, 1))


def ours_boxes_of_draws_first(view):
    return view.by(draws_in_view(view), view.weights / view.bytes)


def share_in_view(view):
    """How much of the projected boxes of a page's draws is in the frustum."""
    of, boxes = view.draw_boxes()
    angles = sphere_angles(boxes, view.pose.eye)
    inside = sums(of, angles * view.in_view(boxes), view.scene.count)
    return (inside / np.maximum(sums(of, angles, view.scene.count), 1e-12))[view.numbers]


def ours_times_share_in_view(view):
    return view.by(view.weights / view.bytes * share_in_view(view), view.weights / view.bytes)


def weight_at_pose(view):
    """The order of ours, if the weights were those of the viewpoint instead of the mean over the cell."""
    where, pose = view.scene.pages, view.pose
    of_page = where.page_of[pose.ids]
    true = sums(of_page[of_page >= 0], pose.angles[of_page >= 0, 0], view.scene.count)[view.numbers]
    return view.by(true / view.bytes * np.maximum(view.share_ahead(), LEAST_AHEAD))


def truth_in_view(view):
    """The order of ours, if the client knew which pages carry anything in the view."""
    return view.by(view.true[view.numbers] > 0, view.weights / view.bytes)


# The ones that are published; of each rival its variants, of which the best one counts.
ORDERS = {"ours": [ours], "distance": [distance, distance_in_view, distance_of_draws],
          "projected area": [area_of_rectangle, area_of_sphere, area_of_draws], "hierarchical Z": [hierarchical_z, hierarchical_z_of_draws], "oracle": [oracle]}
TRIED = [ours_without_view, ours_sixteen_times, ours_boxes_alone, ours_view_first, ours_boxes_of_draws, ours_boxes_of_draws_first, ours_times_share_in_view,
         weight_at_pose, truth_in_view]
