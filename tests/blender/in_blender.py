"""What addon_test.py runs inside Blender: a level, marks, bakes, freeze. Writes what it finds as JSON.

usage: blender --background --factory-startup --python in_blender.py -- ZIP PROGRAM FOLDER
"""
import json
import os
import shutil
import sys
import threading
import time

import bpy

sys.dont_write_bytecode = True  # nothing is written into the sources
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from objects import box, empty, mark, select  # noqa: E402

ZIP, PROGRAM, FOLDER = sys.argv[sys.argv.index('--') + 1:]
QUICK = '--samples 8 --resolution 64'
FACTS = {}


def instance(name, collection, location):
    made = empty(name, location)
    made.instance_type, made.instance_collection = 'COLLECTION', collection
    return made


def make_level():
    """Two rooms, a door between them; x leads from the first to the second."""
    for each in list(bpy.data.objects):
        bpy.data.objects.remove(each)
    box('floor', (-4, -4, -0.2), (8, 4, 0))
    box('ceiling', (-4, -4, 3), (8, 4, 3.2))
    for name, low, high in (('west', (-4.2, -4, 0), (-4, 4, 3)), ('east', (8, -4, 0), (8.2, 4, 3)),
                            ('south', (-4, -4.2, 0), (8, -4, 3)), ('north', (-4, 4, 0), (8, 4.2, 3)),
                            ('wall left', (2, -4, 0), (2.2, -0.5, 3)), ('wall right', (2, 0.5, 0), (2.2, 4, 3)),
                            ('lintel', (2, -0.5, 2.2), (2.2, 0.5, 3)), ('lamp', (0.5, -3, 0), (1, -2.5, 1)),
                            ('straight', (6, -0.3, 0), (6.5, 0.3, 1.8)), ('corner', (2.5, 3, 0), (3, 3.5, 1)),
                            ('put away', (3.2, 3, 0), (3.4, 3.5, 1)), ('chest', (-3.5, 3, 0), (-2.5, 3.9, 1)),
                            ('treasure', (-3.2, 3.2, 0.2), (-2.8, 3.6, 0.6)),
                            ('navigation', (2.5, 2, 0.1), (3, 3, 0.2))):
        box(name, low, high)
    mark('GROUP', box('door', (2.05, -0.5, 0), (2.15, 0.5, 2.2)), group='door 1')
    mark('DYNAMIC', box('cart', (2.5, -3.5, 0), (3, -3, 1)))
    mark('NON_OCCLUDER', box('fence', (-1, -3, 0), (0, -2.95, 1)))
    mark('NEVER', bpy.data.objects['navigation'])
    stones = bpy.data.collections.new('stones')
    for number in range(2):
        box(f'stone {number}', (0, 0.5 * number, 0), (0.3, 0.5 * number + 0.3, 0.3), stones)
    instance('pile', stones, (4, 3, 0))
    instance('heap', stones, (0, 2, 0))
    view_cell = empty('cell of the first room', (-2, 0, 1.5))
    view_cell.empty_display_type, view_cell.empty_display_size = 'CUBE', 0.5
    mark('CELL', view_cell)
    FACTS['scale of the cell'] = list(view_cell.scale)
    view_cell.scale = (1, 1, 0.5)
    bpy.context.scene.cursor.location = (5, 2, 1.5)
    bpy.ops.sightcell.add(kind='CELL')
    bpy.context.active_object.name, bpy.context.active_object.scale = 'cell of the second room', (1, 1, 0.5)
    bpy.ops.sightcell.add(kind='START')
    bpy.data.objects['put away'].hide_set(True)
    select(bpy.data.objects['corner'], bpy.data.objects['lamp'])


def bake(options=QUICK):
    """The error of a bake, or None."""
    settings().options = options
    try:
        bpy.ops.sightcell.bake()
    except RuntimeError as problem:
        return str(problem)
    return None


def settings():
    return bpy.context.scene.sightcell_settings


def messages():
    return [(each.kind, each.text, each.object_name) for each in sightcell.state.messages]


def names_where(test):
    return sorted(each.name for each in bpy.context.view_layer.objects if test(each))


def shown():
    return names_where(lambda each: not each.hide_get()), names_where(lambda each: each.select_get())


def cancel_soon():
    """Cancels the next bake when its first cell is in work."""
    def wait():
        while sightcell.state.job is None or 'phase' not in sightcell.state.job.progress:
            time.sleep(0.01)
        sightcell.state.job.cancel()
    threading.Thread(target=wait, daemon=True).start()


def failing_bakes():
    preferences = bpy.context.preferences.addons['sightcell'].preferences
    preferences.program = PROGRAM
    FACTS['unsaved'] = bake()
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, 'level.blend'))
    preferences.program = os.path.join(FOLDER, 'no such program')
    FACTS['no program'] = bake()
    preferences.program = os.path.dirname(os.path.dirname(PROGRAM))  # a folder, as of a bundle
    FACTS['freeze before a bake'] = None
    try:
        bpy.ops.sightcell.freeze()
    except RuntimeError as problem:
        FACTS['freeze before a bake'] = str(problem)
    flat = empty('flat', (0, 0, 1), (1, 1, 0))
    mark('CELL', flat)
    FACTS['flat cell'] = bake(), messages()
    bpy.data.objects.remove(flat)
    cancel_soon()
    FACTS['canceled'] = bake('--samples 4000 --resolution 1024 --threads 1'), sightcell.state.summary
    FACTS['files after failures'] = sorted(os.listdir(FOLDER))


def good_bake():
    bpy.data.objects['lamp']['sightcell'] = 'shiny'
    select(bpy.data.objects['lamp'])
    bpy.ops.object.mode_set(mode='EDIT')
    bpy.context.view_layer.objects.active = bpy.data.objects['door']
    FACTS['bake'] = bake(), messages()
    FACTS['mode'], FACTS['active'] = bpy.data.objects['lamp'].mode, bpy.context.active_object.name
    bpy.context.view_layer.objects.active = bpy.data.objects['lamp']
    bpy.ops.object.mode_set(mode='OBJECT')
    FACTS['files'] = sorted(os.listdir(FOLDER))
    for ending in ('glb', 'pvs'):
        shutil.copy(os.path.join(FOLDER, f'level.{ending}'), os.path.join(FOLDER, f'first.{ending}'))
    FACTS['marks'] = {each.name: sightcell.marks.describe(each) for each in bpy.data.objects}
    found = sightcell.state.bake(bpy.context.scene)
    FACTS['boxes'], FACTS['polygons'] = found.boxes.tolist(), found.polygons.tolist()
    for color_by in ('POLYGONS', 'BOUND'):
        settings().color_by, settings().show_cells = color_by, True
        geometry = sightcell.overlay.geometry()
        FACTS[color_by] = {name: getattr(geometry, name).tolist() for name in (
            'floor_positions', 'floor_colors', 'edge_positions', 'edge_colors')}
        FACTS[color_by].update(lowest=geometry.lowest, highest=geometry.highest)


def bake_again():
    """Quick re-bakes: nothing changed, then an edit that one room sees, then other settings."""
    settings().keep_records = True
    FACTS['quick'] = []
    for edit in (None, None, 'lamp', 'quality'):
        if edit == 'lamp':
            bpy.data.objects['lamp'].location.x -= 0.1
        settings().quality = 'normal' if edit == 'quality' else 'draft'
        FACTS['quick'].append((bake(), sightcell.state.summary))
        with open(os.path.join(FOLDER, 'level.pvs'), 'rb') as file:
            FACTS['quick'][-1] += (file.read().hex(),)


def freezes():
    FACTS['before'] = shown()
    bpy.context.scene.cursor.location = (-2, 0, 1.4)
    bpy.ops.sightcell.freeze()
    FACTS['frozen'] = shown()
    bpy.context.scene.cursor.location = (-2, 0, 0)  # on the floor below the cell
    bpy.ops.sightcell.freeze(source='CURSOR')
    FACTS['frozen on the floor'] = shown()
    bpy.ops.sightcell.unfreeze()
    FACTS['after'] = shown()
    camera = bpy.data.objects.new('camera', bpy.data.cameras.new('camera'))
    camera.location = (5, 2, 1.5)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    bpy.context.view_layer.update()
    bpy.ops.sightcell.freeze(source='CAMERA')
    FACTS['frozen by the camera'] = shown()
    bpy.ops.sightcell.unfreeze()
    bpy.context.scene.cursor.location = (0, 0, 50)
    try:
        bpy.ops.sightcell.freeze()
    except RuntimeError as problem:
        FACTS['outside'] = str(problem)
    bpy.ops.sightcell.select_unseen()
    FACTS['unseen'] = shown()[1]


bpy.ops.preferences.addon_install(filepath=ZIP)
bpy.ops.preferences.addon_enable(module='sightcell')
import sightcell  # noqa: E402  installed just now

make_level()
failing_bakes()
good_bake()
freezes()
bake_again()
bpy.ops.preferences.addon_disable(module='sightcell')
FACTS['after disabling'] = hasattr(bpy.types.Scene, 'sightcell_settings')
with open(os.path.join(FOLDER, 'facts.json'), 'w', encoding='utf-8') as out:
    json.dump(FACTS, out)
