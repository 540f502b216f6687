#!/usr/bin/python3
"""Makes the picture of README.md: a town of sightcell-city, baked in Blender, with panel, cells and a frozen cell.

usage: xvfb-run -a -s '-screen 0 1280x1000x24' samples/blender/make_picture.py --bin BIN [-o panel.png]

BIN: the folder with the built programs. Needs Blender and xdotool; renders without a graphics card. Takes a minute.
"""
import argparse
import math
import os
import subprocess
import sys
import tempfile

WIDTH, HEIGHT = 1280, 1000
HERE = os.path.dirname(os.path.abspath(__file__))
POLYGONS = 30000
FROM = 0.0, 0.0  # the frozen cell is the one nearest to here, in meters
ANGLES, DISTANCE = (0.62, 0.0, 0.55), 130.0  # of the view of it
ASIDE = 11.0  # meters: the sidebar covers the right part of the view
TAB = 1043, 252  # where a click opens our tab of the sidebar, in pixels


def outside():
    """Makes town and zip, starts Blender, and reduces the colors of its picture."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument('--bin', required=True)
    options.add_argument('-o', '--output', default=os.path.join(HERE, 'panel.png'))
    given = options.parse_args()
    from PIL import Image
    with tempfile.TemporaryDirectory() as folder:
        town, archive, picture = (os.path.join(folder, name) for name in ('town.glb', 'sightcell.zip', 'panel.png'))
        programs = os.path.abspath(given.bin)
        subprocess.run([os.path.join(programs, 'sightcell-city'), '--polygons', str(POLYGONS), '--seed', '1',
                        '--out', town], check=True)
        subprocess.run([sys.executable, '-B', os.path.join(HERE, 'make_zip.py'), os.path.join(HERE, 'sightcell'),
                        os.path.join(HERE, '..', '..', 'LICENSE'), archive], check=True)
        environment = {**os.environ, 'HOME': folder, 'TMPDIR': folder, 'BLENDER_USER_CONFIG': folder,
                       'LIBGL_ALWAYS_SOFTWARE': '1', 'BLENDER_USER_SCRIPTS': os.path.join(folder, 'scripts')}
        os.makedirs(os.path.join(folder, 'scripts', 'addons'))
        subprocess.run(['blender', '--factory-startup', '--window-geometry', '0', '0', str(WIDTH),
                        str(HEIGHT), '--python', os.path.abspath(__file__), '--', town, archive,
                        os.path.join(programs, 'sightcell'), picture], check=True, env=environment)
        Image.open(picture).convert('RGB').quantize(160, dither=Image.Dither.NONE).save(given.output, optimize=True)
    print(f'{given.output}: {os.path.getsize(given.output)} bytes')


def inside():
    """In Blender: steps that a timer takes one by one, so that the window is drawn between them."""
    import bpy
    import numpy
    from mathutils import Euler, Vector
    town, archive, program, picture = sys.argv[sys.argv.index('--') + 1:]

    def view():
        for area in bpy.context.window_manager.windows[0].screen.areas:
            if area.type == 'VIEW_3D':
                return area
        return None

    def in_view():
        """Timers have no window of their own."""
        area = view()
        region = next(found for found in area.regions if found.type == 'WINDOW')
        return bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region)

    def prepare():
        bpy.context.preferences.view.show_splash = False
        bpy.context.preferences.view.show_developer_ui = False
        bpy.ops.preferences.addon_install(filepath=archive)
        bpy.ops.preferences.addon_enable(module='sightcell')
        bpy.context.preferences.addons['sightcell'].preferences.program = program
        for each in list(bpy.data.objects):
            bpy.data.objects.remove(each)
        numpy.bool = bool  # NumPy 1.24 of Debian 12 has no such name any more; the importer of its Blender uses it
        bpy.ops.import_scene.gltf(filepath=town)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(os.path.dirname(town), 'town.blend'))
        bpy.context.window_manager.windows[0].workspace = bpy.data.workspaces['Modeling']  # no timeline

    def start_bake():
        with in_view():
            bpy.ops.sightcell.bake('INVOKE_DEFAULT')

    def set_view():
        settings, space = bpy.context.scene.sightcell_settings, view().spaces[0]
        import sightcell
        centers = sightcell.state.bake(bpy.context.scene).boxes.mean(1)
        bpy.context.scene.cursor.location = min(centers.tolist(), key=lambda at: math.dist(at[:2], FROM))
        settings.show_cells = True
        with in_view():
            bpy.ops.sightcell.freeze()
        for each in bpy.context.view_layer.objects:
            each.select_set(each.name == 'outskirts')
        bpy.context.view_layer.objects.active = bpy.data.objects['outskirts']
        space.show_region_ui = True
        space.overlay.show_outline_selected = False
        space.overlay.show_relationship_lines = space.overlay.show_extras = space.overlay.show_floor = False
        space.overlay.show_axis_x = space.overlay.show_axis_y = False
        space.shading.show_cavity, space.shading.color_type = True, 'MATERIAL'
        space.clip_start, space.clip_end = 1, 2000
        space.region_3d.view_perspective = 'PERSP'
        rotation = Euler(ANGLES).to_quaternion()
        space.region_3d.view_rotation, space.region_3d.view_distance = rotation, DISTANCE
        space.region_3d.view_location = bpy.context.scene.cursor.location + rotation @ Vector((ASIDE, 0, 0))

    def click_tab():
        # Blender has to see each step, so nothing waits here.
        subprocess.Popen(['xdotool', 'mousemove', '1040', '245', 'sleep', '0.5', 'mousemove', *map(str, TAB), 'sleep',
                          '0.5', 'mousedown', '1', 'sleep', '0.3', 'mouseup', '1', 'sleep', '0.3', 'mousemove',
                          '400', '700'])

    def take():
        with in_view():
            bpy.ops.screen.screenshot(filepath=picture)

    def wait():
        pass

    steps = [prepare, start_bake, set_view, click_tab, wait, wait, take, bpy.ops.wm.quit_blender]

    def next_step():
        try:
            import sightcell
            if sightcell.state.job is not None:
                return 0.5
        except ImportError:
            pass
        try:
            steps.pop(0)()
        except Exception as problem:  # a timer would go on without a word
            print(f'make_picture: {problem}', file=sys.stderr)
            os._exit(1)
        return 2.0 if steps else None

    bpy.app.timers.register(next_step, first_interval=2.0)


if __name__ == '__main__':
    try:
        import bpy  # noqa: F401
        inside()
    except ImportError:
        outside()
