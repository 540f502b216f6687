"""Walks from view cell to adjacent view cell of a streamed scene, for benchmarks of clients."""
import heapq
import math
import random

import numpy as np

DOOR = 0.5  # meters: adjacent cells touch along at least this much
HIGH = 0.1  # and as much of their heights is the same
TOUCH = 1e-3  # between boxes that touch


class Cells:
    """The boxes of the cells, and which are adjacent."""

    def __init__(self, site):
        cells = site.cells()
        self.boxes = np.array([cells[number].box for number in sorted(cells)], 'f8')
        self.doors = [self.doors_of(i) for i in range(len(self.boxes))]

    def doors_of(self, i):
        """[(cell, a point of both)]"""
        low, high = np.maximum(self.boxes[:, 0], self.boxes[i, 0]), np.minimum(self.boxes[:, 1], self.boxes[i, 1])
        wide = high - low
        touch = (wide >= -TOUCH).all(axis=1) & (wide[:, 1] >= HIGH) & (wide[:, [0, 2]].max(axis=1) >= DOOR)
        touch[i] = False
        return [(int(j), (low[j] + high[j]) / 2) for j in np.flatnonzero(touch)]

    def middle(self, i):
        return self.boxes[i].mean(axis=0)

    def reached(self, first):
        found, left = {first}, [first]
        while left:
            for cell, _ in self.doors[left.pop()]:
                if cell not in found:
                    found.add(cell)
                    left.append(cell)
        return sorted(found)

    def way(self, first, last):
        """Points of the shortest way over the middles of cells and of what they share."""
        best, before, queue = {first: 0.0}, {}, [(0.0, first)]
        while queue:
            length, cell = heapq.heappop(queue)
            if cell == last:
                break
            if length > best[cell]:
                continue
            for other, door in self.doors[cell]:
                further = length + math.dist(self.middle(cell), door) + math.dist(door, self.middle(other))
                if further < best.get(other, math.inf):
                    best[other], before[other] = further, (cell, door)
                    heapq.heappush(queue, (further, other))
        points, cell = [], last
        while cell != first:
            points.append(self.middle(cell))
            cell, door = before[cell]
            points.append(door)
        return points[::-1]

    def walk(self, length, seed):
        """Points of a walk of this many meters, to one random cell after the other."""
        one = random.Random(seed)
        here = max((one.randrange(len(self.boxes)) for _ in range(8)), key=lambda i: len(self.reached(i)))
        reached = self.reached(here)
        if len(reached) == 1:
            raise ValueError("a site without adjacent cells")
        # It begins beside the middle of its cell: else turns lie at multiples of the size of cells.
        first = self.doors[here][0][1]
        points, left = [self.middle(here) + (first - self.middle(here)) * one.uniform(0.1, 0.4)], length
        while left > 0:
            there = one.choice(reached)
            for point in self.way(here, there):
                step = math.dist(points[-1], point)
                if step > left:
                    point = points[-1] + (point - points[-1]) * left / step
                points.append(point)
                left -= step
                if left <= 0:
                    break
            here = there
        return [[float(f'{c:.7g}') for c in point] for point in points]
