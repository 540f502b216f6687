"""Two bakes of what should be the same scene: their polygons matched by position, their sets compared.

Imported by bench_data.py; sets come through the runtime's C API (libsightcell.so).
"""
import ctypes
import itertools

import numpy as np

DRAW_ALL = 2


class Sets:
    """The cells of a .pvs file: boxes [n, 2, 3] and for each the source ids of its set."""

    def __init__(self, library, path):
        lib = ctypes.CDLL(library)
        lib.sightcell_db_polygon_count.restype = lib.sightcell_db_cell_count.restype = ctypes.c_uint32
        db = ctypes.c_void_p()
        need(lib.sightcell_db_open_file(path.encode(), None, ctypes.byref(db)) == 0, f"{path}: cannot be opened")
        self.polygons = lib.sightcell_db_polygon_count(db)
        self.boxes, self.ids = [], []
        for cell in range(lib.sightcell_db_cell_count(db)):
            box = (ctypes.c_float * 6)()
            high = ctypes.cast(ctypes.addressof(box) + 12, ctypes.POINTER(ctypes.c_float))
            need(lib.sightcell_db_cell_box(db, ctypes.c_uint32(cell), box, high) == 0, f"{path}: no cell {cell}")
            self.boxes.append(np.array(box, "f4").reshape(2, 3))
            self.ids.append(self.set_of(lib, db, self.boxes[-1].mean(0), cell, path))
        lib.sightcell_db_close(db)

    def set_of(self, lib, db, eye, cell, path):
        view, count = ctypes.c_void_p(), ctypes.c_size_t()
        need(lib.sightcell_view_create(db, ctypes.byref(view)) == 0, f"{path}: no view")
        frame = (ctypes.c_uint32 * 16)()
        need(lib.sightcell_view_move(view, (ctypes.c_float * 3)(*eye), frame) == 0, f"{path}: no move")
        need(frame[0] == cell and not frame[1] & DRAW_ALL, f"{path}: the center of cell {cell} is in cell {frame[0]}")
        ids = np.zeros(frame[2], "u4")
        lib.sightcell_view_polygons(view, ids.ctypes.data_as(ctypes.c_void_p), ctypes.c_size_t(len(ids)),
                                    ctypes.byref(count))
        need(count.value == len(ids), f"{path}: cell {cell} has another count than its frame says")
        lib.sightcell_view_destroy(view)
        return ids

    def cell_at(self, box):
        """The number of the cell with that box, or None: cells inside solids are left out of a file."""
        for i, own in enumerate(self.boxes):
            if np.abs(own - box).max() < 1e-4:
                return i
        return None


def need(condition, what):
    if not condition:
        raise SystemExit(f"bench_data: {what}")


def read_triangles(path):
    return np.fromfile(path, "f4").reshape(-1, 3, 3)


def corner_distance(a, b):
    """The largest distance of corners, for the best of the three rotations; never mirrored: facing must agree."""
    rotated = [np.linalg.norm(a - np.roll(b, k, axis=1), axis=2).max(1) for k in range(3)]
    return np.minimum.reduce(rotated)


def candidates(a, b, reach):
    """Pairs (i, j) of triangles whose centroids are at most about reach apart: in the same or neighboring grid cells."""
    low = np.minimum(a.min((0, 1)), b.min((0, 1)))
    grid_a = np.floor((a.mean(1).astype("f8") - low) / reach).astype("i8") + 1
    grid_b = np.floor((b.mean(1).astype("f8") - low) / reach).astype("i8") + 1
    size = np.maximum(grid_a.max(0), grid_b.max(0)) + 2
    key = lambda g: (g[:, 0] * size[1] + g[:, 1]) * size[2] + g[:, 2]
    keys = key(grid_b)
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    for offset in itertools.product((-1, 0, 1), repeat=3):
        wanted = key(grid_a + offset)
        first, last = np.searchsorted(keys, wanted, "left"), np.searchsorted(keys, wanted, "right")
        for k in range(int((last - first).max(initial=0))):
            i = np.nonzero(first + k < last)[0]
            yield i, order[first[i] + k]


def match(a, b, tolerance):
    """For each triangle of a the number of its partner in b or -1: one to one, nearest first, all corners within tolerance.

    In growing steps, so that dense parts are settled before the reach is wide.
    """
    partner = np.full(len(a), -1, "i8")
    taken = np.zeros(len(b), bool)
    for reach in (tolerance / 64, tolerance / 8, tolerance):
        left_a, left_b = np.nonzero(partner < 0)[0], np.nonzero(~taken)[0]
        if not len(left_a) or not len(left_b):
            break
        found = []
        for i, j in candidates(a[left_a], b[left_b], reach):
            distance = corner_distance(a[left_a[i]], b[left_b[j]])
            near = distance <= reach
            found.append(np.stack([distance[near], left_a[i[near]], left_b[j[near]]], 1))
        found = np.concatenate(found)
        for _, i, j in found[np.lexsort((found[:, 2], found[:, 1], found[:, 0]))]:
            i, j = int(i), int(j)
            if partner[i] < 0 and not taken[j]:
                partner[i] = j
                taken[j] = True
    return partner


def compare(first, second, partner, shares_of):
    """Sets of first against those of second (its ids brought back through partner), over the cells that both have.

    shares_of(cell): pairs (polygon, share of rays) of a cell of first, from fresh rays.
    Gives: cells, union and difference in polygons, share of rays and of those that end on polygons of the difference.
    """
    back = np.full(second.polygons, -1, "i8")
    back[partner[partner >= 0]] = np.nonzero(partner >= 0)[0]
    total = dict(cells=0, union=0, only_first=0, only_second=0, unmatched=0, rays=0.0, rays_only_first=0.0,
                 rays_only_second=0.0)
    for cell, box in enumerate(first.boxes):
        other = second.cell_at(box)
        if other is None:
            continue
        a = np.zeros(first.polygons, bool)
        a[first.ids[cell]] = True
        ids = back[second.ids[other]]
        total["unmatched"] += int((ids < 0).sum() + (partner[first.ids[cell]] < 0).sum())
        a[partner < 0] = False
        b = np.zeros(first.polygons, bool)
        b[ids[ids >= 0]] = True
        total["cells"] += 1
        total["union"] += int((a | b).sum())
        total["only_first"] += int((a & ~b).sum())
        total["only_second"] += int((b & ~a).sum())
        for polygon, share in shares_of(cell):
            total["rays"] += share
            total["rays_only_first"] += share * bool(a[polygon] and not b[polygon])
            total["rays_only_second"] += share * bool(b[polygon] and not a[polygon])
    return total


def percent(total):
    """Difference of the sets: (by polygons of their union, by rays that hit anything), in percent."""
    polygons = (total["only_first"] + total["only_second"]) / max(total["union"], 1)
    rays = (total["rays_only_first"] + total["rays_only_second"]) / max(total["rays"], 1e-30)
    return 100 * polygons, 100 * rays
