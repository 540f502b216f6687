"""Freeze: hide the objects that a cell does not see, and show exactly these again. The scene remembers them."""
from . import state


def hide(scene, layer, bake, sight):
    """Hide the objects of a view layer that a sight (baked.Sight) does not have."""
    settings = state.settings(scene)
    visible, described = bake.split(sight.nodes)
    for found in layer.objects:
        if found.name in described and found.name not in visible and not found.hide_get(view_layer=layer):
            entry = settings.frozen.add()
            entry.target, entry.selected = found, found.select_get(view_layer=layer)
            found.hide_set(True, view_layer=layer)
    settings.frozen_layer, settings.frozen_cell = layer.name, sight.cell
    settings.frozen_text = f'Cell {sight.cell}: {len(visible)} of {len(described)} objects, {sight.polygons:,} polygons'


def unfreeze(scene):
    """Shows what hide() has hidden, and selects what was selected. Objects that are gone are skipped."""
    settings = state.settings(scene)
    layer = scene.view_layers.get(settings.frozen_layer)
    for entry in settings.frozen if layer else ():
        if entry.target is not None and entry.target.name in layer.objects:
            entry.target.hide_set(False, view_layer=layer)
            if entry.selected:
                entry.target.select_set(True, view_layer=layer)
    settings.frozen.clear()
    settings.frozen_text, settings.frozen_cell = '', -1
