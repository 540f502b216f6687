"""Polygons of one list matched with those of another by their corners."""
import numpy as np

from pair_sets import candidates, corner_distance


def partners(a, b, tolerance):
    """For each polygon of a, [n, 3, 3], the number of its partner in b, or -1: one to one, nearest first, facing the same
    way, all corners within the tolerance."""
    partner, taken = np.full(len(a), -1), np.zeros(len(b), bool)
    if not len(a) or not len(b):
        return partner
    found = [np.zeros((0, 3))]
    for i, j in candidates(a, b, tolerance):
        distance = corner_distance(a[i], b[j])
        near = distance <= tolerance
        found.append(np.stack([distance[near], i[near], j[near]], axis=1))
    found = np.concatenate(found)
    for i, j in found[np.lexsort((found[:, 2], found[:, 1], found[:, 0]))][:, 1:].astype(np.int64):
        if partner[i] < 0 and not taken[j]:
            partner[i] = j
            taken[j] = True
    return partner
