"""What window_test.py runs in Blender with a window: bakes in the background. Writes what it finds as JSON.

usage: blender --factory-startup --python in_window.py -- ZIP PROGRAM FOLDER SCREEN

SCREEN: where Xvfb writes its picture.
"""
import json
import os
import sys
import traceback

import bpy

sys.dont_write_bytecode = True  # nothing is written into the sources
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.dirname(HERE)]
import screen  # noqa: E402
from objects import box, empty, mark  # noqa: E402

ZIP, PROGRAM, FOLDER, SCREEN = sys.argv[sys.argv.index('--') + 1:]
QUICK, LONG = '--samples 8 --resolution 64', '--samples 100000 --resolution 1024 --threads 1'
PAUSE = 0.3  # seconds between two steps: the window is drawn, and the operator takes its turn
FACTS = {}


def settings():
    return bpy.context.scene.sightcell_settings


def in_view():
    """Timers have no window of their own."""
    window = bpy.context.window_manager.windows[0]
    area = next(found for found in window.screen.areas if found.type == 'VIEW_3D')
    region = next(found for found in area.regions if found.type == 'WINDOW')
    return bpy.context.temp_override(window=window, area=area, region=region)


def start_bake(options):
    settings().options = options
    with in_view():
        return sorted(bpy.ops.sightcell.bake('INVOKE_DEFAULT'))


def show_panels(*names):
    """As popovers: in the sidebar, only a click opens another tab."""
    with in_view():
        for name in names:
            bpy.ops.wm.call_panel(name=f'SIGHTCELL_PT_{name}')


def finished():
    return sightcell.state.job is None


def in_work():
    """Whether the program has begun with the cells."""
    return 'phase' in sightcell.state.job.progress


def color_in_view():
    """(rows, columns): how far each pixel in the middle of the viewport, where nothing but the scene is drawn, is from
    gray. The scene is gray, and its edges change while Blender smooths them."""
    with in_view():
        region, rows = bpy.context.region, bpy.context.window.height
        left, top = region.x + region.width // 4, rows - region.y - 3 * region.height // 4
        shown = screen.pixels(SCREEN)[top:top + region.height // 2, left:left + region.width // 2].astype(int)
        return shown.max(2) - shown.min(2)


def make_level():
    for each in list(bpy.data.objects):
        bpy.data.objects.remove(each)
    box('floor', (-4, -4, -0.2), (4, 4, 0))
    box('crate', (-1, 2, 0), (1, 3, 1))
    for number in range(4):
        place = empty(f'cell {number}', (2 * number - 3, 0, 1.5), (1, 1, 0.5))
        place.empty_display_type = 'CUBE'
        mark('CELL', place)
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, 'level.blend'))


def first_bake():
    FACTS['started'] = start_bake(LONG)


def work_on():
    """The bake goes on in the background: objects move, and a second bake is refused."""
    bpy.data.objects['crate'].location.x += 0.5
    FACTS['second bake'] = bpy.ops.sightcell.bake.poll()


def cancel():
    FACTS['process of the canceled bake'] = sightcell.state.job.process.pid
    bpy.ops.sightcell.cancel_bake()


def after_cancel():
    FACTS['canceled'] = sightcell.state.summary
    FACTS['files after the cancel'] = sorted(os.listdir(FOLDER))
    start_bake(QUICK)


def after_bake():
    FACTS['summary'] = sightcell.state.summary
    FACTS['files'] = sorted(os.listdir(FOLDER))
    FACTS['without cells'] = color_in_view()


def show_cells():
    settings().show_cells = True
    sightcell.state.redraw()


def after_cells():
    FACTS['share of cells'] = float((color_in_view() > FACTS.pop('without cells') + 20).mean())
    show_panels('result', 'marks')  # not before, because they cover the viewport until the mouse moves


def flat_cell():
    mark('CELL', empty('flat', (0, 0, 1), (1, 1, 0)))
    FACTS['start of the failing bake'] = start_bake(QUICK)


def after_failure():
    FACTS['messages'] = [(each.kind, each.text, each.object_name) for each in sightcell.state.messages]
    FACTS['files after the failure'] = sorted(os.listdir(FOLDER))
    show_panels('messages')


def last_bake():
    bpy.data.objects.remove(bpy.data.objects['flat'])
    start_bake(LONG)


def show_progress():
    show_panels('bake')


def quit_meanwhile():
    """Blender ends while a bake runs."""
    FACTS['process at the end'] = sightcell.state.job.process.pid
    with open(os.path.join(FOLDER, 'facts.json'), 'w', encoding='utf-8') as out:
        json.dump(FACTS, out)
    bpy.ops.wm.quit_blender()


# A step that returns False is taken again.
STEPS = [make_level, first_bake, in_work, work_on, cancel, finished, after_cancel, finished, after_bake, show_cells,
         after_cells, flat_cell, finished, after_failure, last_bake, in_work, show_progress, quit_meanwhile]


def next_step():
    try:
        if STEPS[0]() is not False:
            STEPS.pop(0)
    except Exception:  # a timer would go on without a word
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)
    return PAUSE if STEPS else None


bpy.context.preferences.view.show_splash = False
bpy.ops.preferences.addon_install(filepath=ZIP)
bpy.ops.preferences.addon_enable(module='sightcell')
bpy.context.preferences.addons['sightcell'].preferences.program = PROGRAM
import sightcell  # noqa: E402  installed just now

bpy.app.timers.register(next_step, first_interval=PAUSE)
