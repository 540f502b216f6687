"""A bake: its cells and what they see, in the axes of Blender and by the nodes of the exported scene."""
import os

import numpy

from . import program, runtime, scene_file
from .problem import Problem

TRIES = 64  # points in a box that other cells overlap


def to_gltf(point):
    """A point of Blender (+Z up) in the axes of glTF (+Y up)."""
    x, y, z = point
    return x, z, -y


def to_blender(boxes):
    """Boxes in the axes of glTF, (cells, 2, 3), in those of Blender: (x, y, z) becomes (x, -z, y)."""
    low, high = boxes[:, 0], boxes[:, 1]
    return numpy.stack([numpy.stack([low[:, 0], -high[:, 2], low[:, 1]], 1),
                        numpy.stack([high[:, 0], -low[:, 2], high[:, 1]], 1)], 1)


class Sight:
    """What is visible from a point. cell: its number, or None outside all cells. nodes: those with a visible polygon,
    or None where everything would be drawn. polygons: to draw."""

    def __init__(self, cell, nodes, polygons):
        self.cell, self.nodes, self.polygons = cell, nodes, polygons


class Bake:
    """A .pvs file with the .glb that it was baked from.

    boxes: corners of the cells in the axes of Blender, (cells, 2, 3). polygons: of the set of each cell, -1 for a cell
    that lies within smaller ones. drawn: nodes with polygons in the file. seen: nodes with a polygon in some set.
    """

    def __init__(self, pvs, glb, objects, program_path):
        self.pvs, self.program_path = pvs, program_path
        self.nodes = scene_file.Nodes(scene_file.read_document(glb), objects)
        if not os.path.exists(pvs):
            raise Problem(f'{pvs} does not exist: bake first')
        self.database = runtime.Database(runtime.load(program_path), pvs)
        try:
            self.table = self.database.draws()
            self.check_scene(glb)
            self.drawn = {int(node) for node in self.table['node'][self.table['polygon_count'] > 0]}
            boxes = self.database.cell_boxes()
            self.boxes = to_blender(boxes)
            self.read_sets(boxes)
        except Exception:
            self.close()
            raise
        self.bound_list = None

    def close(self):
        self.database.close()

    def check_scene(self, glb):
        for draw in self.table:
            if not self.nodes.has_draw(int(draw['node']), int(draw['mesh']), int(draw['primitive']),
                                       int(draw['polygon_count'])):
                raise Problem(f'{self.pvs} was not baked from {os.path.basename(glb)} as it is now: bake again')

    def read_sets(self, boxes):
        """Moves into each cell once."""
        self.polygons = numpy.full(len(boxes), -1, numpy.int64)
        seen = numpy.zeros(len(self.table), bool)
        for cell, (low, high) in enumerate(boxes.astype(float)):
            for point in points_in(low, high):
                frame = self.database.move(point)
                if frame.cell != cell:  # kept by the view, or a smaller cell is there
                    self.database.new_view()
                    frame = self.database.move(point)
                if frame.cell == cell:
                    self.polygons[cell] = frame.polygon_count
                    seen |= self.database.seen_draws()
                    break
        self.seen = {int(node) for node in self.table['node'][seen]}

    def at(self, point):
        """What is visible from a point of Blender. The result depends on the point alone, not on earlier calls."""
        self.database.new_view()
        frame = self.database.move(to_gltf(point))
        cell = None if frame.cell == runtime.NO_CELL else int(frame.cell)
        if frame.flags & runtime.DRAW_ALL:
            return Sight(cell, None, int(frame.polygon_count))
        nodes = {int(node) for node in self.table['node'][self.database.seen_draws()]}
        return Sight(cell, nodes, int(frame.polygon_count))

    def bounds(self):
        """The bound of each cell (docs/baking.md, "Quality"), 0 for a cell without one."""
        if self.bound_list is None:
            found = numpy.zeros(len(self.boxes))
            for cell in program.answer(self.program_path, 'info', self.pvs, '--json').get('certificate') or []:
                found[cell['cell']] = cell['upper_bound']
            self.bound_list = found
        return self.bound_list

    def split(self, nodes):
        """(names of objects with one of these nodes, names of all objects that the sets describe)."""
        described, among = set(), set()
        for node in self.drawn - self.nodes.unknown:
            owner = self.nodes.owners[node]
            if owner is not None:
                described.add(owner)
                if node in nodes:
                    among.add(owner)
        moving = {self.nodes.owners[node] for node in self.drawn & self.nodes.unknown}
        return among, described - (moving - among)


def points_in(low, high):
    """Points in a box: its center, then others all over it, the same each time."""
    yield (low + high) / 2
    for number in range(1, TRIES):
        share = [(number * step) % 1 * 0.98 + 0.01 for step in (0.8191725134, 0.6710436067, 0.5497004779)]
        yield low + (high - low) * share
