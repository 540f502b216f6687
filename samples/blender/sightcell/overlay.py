"""Cells in the viewport: floors and edges in colors."""
import bpy
import gpu
import numpy
from gpu_extras.batch import batch_for_shader

from . import state

# From few polygons, or a small bound, to many.
RAMP = numpy.array([(0.10, 0.35, 0.95), (0.05, 0.75, 0.80), (0.20, 0.80, 0.25), (0.95, 0.85, 0.15), (0.95, 0.20, 0.10)])
UNKNOWN = 0.5, 0.5, 0.5
FLOOR_ALPHA, EDGE_ALPHA = 0.30, 0.75
FROZEN_COLOR = 1.0, 1.0, 1.0, 1.0
CORNERS = numpy.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)])
EDGES = numpy.array([(0, 1), (1, 3), (3, 2), (2, 0), (4, 5), (5, 7), (7, 6), (6, 4), (0, 4), (1, 5), (2, 6), (3, 7)])
FLOOR = numpy.array([0, 1, 3, 0, 3, 2])
INSET = 0.02  # meters: neighbors do not share an edge

_handler = None
_geometry = None
_batches = None


class Geometry:
    """What is drawn. floor_positions, edge_positions: (vertices, 3), meters in the axes of Blender. floor_colors,
    edge_colors: (vertices, 4). lowest, highest: the values at the ends of the colors, None if no cell has one."""

    def __init__(self, boxes, values, logarithmic):
        colors, self.lowest, self.highest = colors_of(values, logarithmic)
        corners = corners_of(boxes, INSET)
        self.floor_positions = corners[:, FLOOR].reshape(-1, 3)
        self.edge_positions = corners[:, EDGES.reshape(-1)].reshape(-1, 3)
        self.floor_colors = with_alpha(colors, FLOOR_ALPHA, len(FLOOR))
        self.edge_colors = with_alpha(colors, EDGE_ALPHA, EDGES.size)
        self.boxes = boxes


def corners_of(boxes, inset):
    """(cells, 8, 3)."""
    low, high = boxes[:, None, 0] + inset, boxes[:, None, 1] - inset
    return (low + (high - low) * CORNERS).astype(numpy.float32)


def colors_of(values, logarithmic):
    """(cells, 3) with the ends of the scale. Cells without a value (below 0, or 0 on a logarithmic scale) are gray."""
    values = numpy.asarray(values, float)
    known = values > 0 if logarithmic else values >= 0
    colors = numpy.tile(UNKNOWN, (len(values), 1))
    if not known.any():
        return colors, None, None
    lowest, highest = values[known].min(), values[known].max()
    scale = numpy.log if logarithmic else (lambda value: value)
    span = scale(highest) - scale(lowest)
    share = (scale(values[known]) - scale(lowest)) / span if span > 0 else numpy.zeros(known.sum())
    places = numpy.linspace(0, 1, len(RAMP))
    colors[known] = numpy.stack([numpy.interp(share, places, RAMP[:, channel]) for channel in range(3)], 1)
    return colors, float(lowest), float(highest)


def with_alpha(colors, alpha, vertices):
    whole = numpy.concatenate([colors, numpy.full((len(colors), 1), alpha)], 1)
    return numpy.repeat(whole, vertices, axis=0).astype(numpy.float32)


def prepare(bake, color_by):
    """Computes what is drawn. Throws Problem where the bounds cannot be read."""
    global _geometry, _batches
    values = bake.bounds() if color_by == 'BOUND' else bake.polygons
    _geometry, _batches = Geometry(bake.boxes, values, color_by == 'BOUND'), None
    return _geometry


def geometry():
    """What was prepared last, or None."""
    return _geometry


def shader():
    """Version 4 of Blender has no prefix in this name."""
    return gpu.shader.from_builtin('SMOOTH_COLOR' if bpy.app.version >= (4, 0, 0) else '3D_SMOOTH_COLOR')


def draw():
    """Called for each viewport: after its scene, in world space."""
    global _batches
    settings = state.settings(bpy.context.scene)
    if not settings.show_cells or _geometry is None or state.known_bake() is None:
        return
    program = shader()
    if _batches is None:
        shown = _geometry
        parts = (('TRIS', shown.floor_positions, shown.floor_colors),
                 ('LINES', shown.edge_positions, shown.edge_colors))
        _batches = [batch_for_shader(program, kind, {'pos': positions, 'color': colors})
                    for kind, positions, colors in parts]
    gpu.state.blend_set('ALPHA')
    gpu.state.depth_test_set('LESS_EQUAL')
    gpu.state.depth_mask_set(False)  # floors of cells that overlap are both shown
    for batch in _batches:
        batch.draw(program)
    if 0 <= settings.frozen_cell < len(_geometry.boxes):
        box = corners_of(_geometry.boxes[settings.frozen_cell][None], 0.0)[:, EDGES.reshape(-1)].reshape(-1, 3)
        gpu.state.depth_test_set('NONE')
        gpu.state.line_width_set(3.0)
        batch_for_shader(program, 'LINES', {'pos': box, 'color': [FROZEN_COLOR] * len(box)}).draw(program)
        gpu.state.line_width_set(1.0)
    gpu.state.depth_test_set('NONE')
    gpu.state.blend_set('NONE')


def attach():
    global _handler
    if not bpy.app.background:
        _handler = bpy.types.SpaceView3D.draw_handler_add(draw, (), 'WINDOW', 'POST_VIEW')


def detach():
    global _handler, _geometry, _batches
    if _handler is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handler, 'WINDOW')
    _handler = _geometry = _batches = None


CLASSES = ()
