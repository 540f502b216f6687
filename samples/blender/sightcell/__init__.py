"""Sightcell for Blender: marks objects, bakes visibility, shows the result in the viewport."""
bl_info = {
    'name': 'Sightcell',
    'description': 'Baked visibility: marks, bake, view cells, and what a cell does not see',
    'author': 'The Sightcell authors',
    'version': (0, 1, 0),
    'blender': (3, 4, 0),
    'location': '3D Viewport > Sidebar > Sightcell',
    'category': 'Game Engine',
}

import bpy  # noqa: E402  (Blender reads bl_info without running the file)

from . import bake_operator, mark_operators, overlay, panel, properties, view_operators  # noqa: E402
from .marks import glTF2ExportUserExtension  # noqa: E402,F401  Blender's glTF exporter asks add-ons for this name

PARTS = (properties, mark_operators, bake_operator, view_operators, overlay, panel)


def register():
    for part in PARTS:
        for kind in part.CLASSES:
            bpy.utils.register_class(kind)
    properties.attach()
    overlay.attach()


def unregister():
    bake_operator.stop()
    overlay.detach()
    properties.detach()
    for part in reversed(PARTS):
        for kind in reversed(part.CLASSES):
            bpy.utils.unregister_class(kind)
