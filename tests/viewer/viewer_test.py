"""Runs sightcell-viewer under a virtual X server, looks at its pictures and presses its keys."""
import csv
import json
import math
import os
import shutil
import subprocess
import tempfile
import time
import unittest

import numpy

import harness
import screen
from harness import TIMEOUT, must, program, run, write_middle_cell, write_room
from png import read_png
from surfaces_scene import write_surfaces

SIZE = '320x240'
SAME = 0.001  # of all pixels: the bound of the bakes here


class InFolder(harness.InFolder):
    """A baked city of ours and a baked room, in a folder of its own."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.city_cells, cls.city_pvs = cls.path('cells.json'), cls.path('city.pvs')
        cls.city = cls.make_city('city.glb', '--cells', cls.city_cells)
        cls.bake(cls.city, cls.city_pvs, cls.city_cells, '--cell-limit', 3)
        cls.room, cls.room_cells, cls.room_pvs = map(cls.path, ('room.glb', 'room.json', 'room.pvs'))
        write_room(cls.room)
        write_middle_cell(cls.room_cells)
        cls.bake(cls.room, cls.room_pvs, cls.room_cells)

    @classmethod
    def bake(cls, scene, out, cells, *more):
        must(program('sightcell'), 'bake', scene, '-o', out, '--cells-file', cells, '--quality', 'draft',
                 '--progress', 'none', *more)


class UnderX(InFolder):
    """One virtual X server for the class."""

    @classmethod
    def setUpClass(cls):
        harness.skip_without_xvfb()
        super().setUpClass()
        cls.display = harness.start_screen(cls.addClassCleanup, cls.folder)

    def view(self, scene, pvs, *arguments):
        """A screenshot and what the viewer says about it."""
        picture = self.path('picture.png')
        files = [scene, pvs] if pvs else [scene]
        code, out, err = run(program('sightcell-viewer'), *files, '--screenshot', picture, '--size', SIZE, *arguments,
                             display=self.display)
        if code == 1 and '[viewer.no-context]' in err:
            self.skipTest('no OpenGL under Xvfb: ' + err)
        self.assertEqual(code, 0, f'{arguments}\n{out}\n{err}')
        self.assertEqual(len(out.splitlines()), 1, out)
        pixels = read_png(picture)
        self.assertEqual(pixels.shape, (240, 320, 3))
        return pixels, json.loads(out)


def differing(a, b):
    """Share of the pixels that differ."""
    return float((a != b).any(axis=2).mean())


def commonest(picture):
    """Share of the pixels that have the most frequent color."""
    return float(numpy.unique(picture.reshape(-1, 3), axis=0, return_counts=True)[1].max() / picture[:, :, 0].size)


def red(picture):
    """Share of the pixels in the color of what a set leaves out."""
    r, g, b = (picture[:, :, c].astype(int) for c in range(3))
    return float(((r > 150) & (g < 20) & (b < 20)).mean())


class Pictures(UnderX):
    def test_from_inside_a_cell_nothing_is_missing(self):
        for cell, yaw in ((0, 0), (1, 150), (2, 60)):
            aim = ['--cell', cell, f'--look={yaw},5']
            full, said = self.view(self.city, self.city_pvs, *aim, '--mode', 'all')
            self.assertEqual((said['polygons_drawn'], said['polygons'], said['cells']), (3000, 3000, 3))
            culled, said = self.view(self.city, self.city_pvs, *aim)
            self.assertEqual((said['cell'], said['shown_cell'], said['flags']), (cell, cell, '-'))
            self.assertLess(said['polygons_drawn'], 1500)
            self.assertLess(commonest(full), 0.8, 'hardly anything to be seen')
            self.assertLessEqual(differing(full, culled), SAME, aim)
            tinted, _ = self.view(self.city, self.city_pvs, *aim, '--mode', 'tint')
            self.assertLessEqual(red(tinted), SAME, aim)
            self.assertLessEqual(differing(full, tinted), SAME, aim)

    def test_a_merged_file_draws_the_same(self):
        instanced, merged = self.path('instanced.pvs'), self.path('merged.pvs')
        for output, layout in ((instanced, 'instanced'), (merged, 'merged')):
            self.bake(self.city, output, self.city_cells, '--cell-limit', 3, '--profile', 'exact', '--layout', layout)
        for cell in range(2):
            for mode in ('pvs', 'tint'):
                aim = ['--cell', cell, '--look=40,-5', '--mode', mode]
                expected, said = self.view(self.city, instanced, *aim)
                picture, also_said = self.view(self.city, merged, *aim)
                self.assertEqual(also_said['polygons_drawn'], said['polygons_drawn'])
                self.assertLessEqual(also_said['ranges'], said['ranges'])
                self.assertLessEqual(differing(picture, expected), SAME, aim)

    def test_frozen_from_above_most_is_missing(self):
        aim = ['--eye=0,160,120', '--look=0,-50']
        full, said = self.view(self.city, self.city_pvs, *aim)
        self.assertEqual((said['cell'], said['flags'], said['polygons_drawn']), (None, 'DRAW_ALL OUTSIDE', 3000))
        inside = self.view(self.city, self.city_pvs, '--cell', 0)[1]['polygons_drawn']
        frozen, said = self.view(self.city, self.city_pvs, *aim, '--frozen-from', 0)
        self.assertEqual((said['cell'], said['shown_cell'], said['frozen']), (None, 0, True))
        self.assertEqual(said['polygons_drawn'], inside)
        self.assertGreater(differing(full, frozen), 0.1)
        tinted, _ = self.view(self.city, self.city_pvs, *aim, '--frozen-from', 0, '--mode', 'tint')
        self.assertGreater(red(tinted), 0.1)
        self.assertEqual(red(frozen), 0.0)
        # The tinted picture has the shape of the whole scene: what is not red is as in the full picture.
        r, g, b = (tinted[:, :, c].astype(int) for c in range(3))
        clean = ~((r > g + 20) & (r > b + 20))  # panes that blend over red are reddish
        self.assertLess(float((tinted != full).any(axis=2)[clean].mean()), 0.01)

    def test_the_box_and_the_text_are_drawn_where_asked_for(self):
        aim = ['--eye=0,160,120', '--look=0,-50', '--frozen-from', 0]
        plain, _ = self.view(self.city, self.city_pvs, *aim)
        for word in ('box', 'cells', 'hud', 'wireframe'):
            shown, _ = self.view(self.city, self.city_pvs, *aim, '--show', word)
            self.assertGreater(differing(plain, shown), 0.0005, word)

    def test_a_missing_polygon_shows(self):
        aim = ['--cell', 0, '--look=0,-60']
        damaged = self.path('damaged.pvs')
        full, _ = self.view(self.room, self.room_pvs, *aim, '--mode', 'all')
        whole, said = self.view(self.room, self.room_pvs, *aim)
        self.assertEqual((said['polygons_drawn'], differing(full, whole)), (12, 0.0))
        self.assertEqual(red(self.view(self.room, self.room_pvs, *aim, '--mode', 'tint')[0]), 0.0)
        must(program('sightcell-test-drop-polygon'), self.room_pvs, damaged, 0, 0)  # half of the floor
        culled, said = self.view(self.room, damaged, *aim)
        self.assertEqual(said['polygons_drawn'], 11)
        hole = differing(full, culled)
        self.assertGreater(hole, 0.1)
        self.assertAlmostEqual(red(self.view(self.room, damaged, *aim, '--mode', 'tint')[0]), hole, delta=0.001)

    def test_surfaces_are_drawn_as_the_other_renderer_draws_them(self):
        # Textures, mask, blend, sides, mirrored instances: sightcell::picture shares no drawing code with the viewer.
        surfaces, surfaces_pvs, cells = map(self.path, ('surfaces.glb', 'surfaces.pvs', 'surfaces.json'))
        write_surfaces(surfaces)
        with open(cells, 'w', encoding='utf-8') as out:
            out.write('{"cells":[{"name":"before","min":[-1,-1,9.5],"max":[1,1,11.5]}]}')
        self.bake(surfaces, surfaces_pvs, cells)
        for scene, pvs, eye in ((surfaces, None, '0,-0.5,10.5'), (surfaces, surfaces_pvs, '0,-0.5,10.5'),
                                (self.city, None, '0,40,160')):
            reference = self.path('reference.png')
            must(program('sightcell-test-reference-picture'), scene, reference, *SIZE.split('x'), *eye.split(','), 0, 0,
                 -1)
            expected = read_png(reference).astype(int)
            drawn, said = self.view(scene, pvs, f'--eye={eye}', '--look=0,0')
            self.assertLess(commonest(drawn), 0.9, 'nothing but sky')
            wrong = float((abs(drawn.astype(int) - expected).max(axis=2) > 3).mean())
            self.assertLess(wrong, 0.002, (scene, pvs))
        self.assertEqual(said['polygons'], 3000)

    def test_a_scene_alone(self):
        pixels, said = self.view(self.city, None)
        self.assertEqual((said['cells'], said['polygons_drawn']), (0, 3000))
        self.assertLess(commonest(pixels), 0.9, 'nothing but sky')


class UnderKeys(UnderX):
    """A window, and keys and mouse for it."""

    @classmethod
    def setUpClass(cls):
        if shutil.which('xdotool') is None:
            raise unittest.SkipTest('xdotool is not installed')
        super().setUpClass()

    def tell(self, *arguments):
        return run('xdotool', *arguments, display=self.display)

    def open(self, *arguments):
        self.shots = tempfile.mkdtemp(dir=self.folder)
        self.viewer = subprocess.Popen(
            [program('sightcell-viewer'), *map(str, arguments)], cwd=self.shots,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, 'DISPLAY': self.display})
        self.addCleanup(self.end)
        code, out, err = self.tell('search', '--sync', '--onlyvisible', '--pid', self.viewer.pid)
        self.assertEqual(code, 0, err)
        self.window = out.split()[-1]

    def said(self):
        """The next line of JSON that the viewer prints."""
        return json.loads(self.viewer.stdout.readline())

    def numbers(self):
        self.press('2')
        return self.said()

    def numbers_when(self, good, what):
        for _ in range(100):
            numbers = self.numbers()
            if good(numbers):
                return numbers
        self.fail(f'{what}: {numbers}')

    def leave(self):
        self.tell('key', '--window', self.window, 'Escape')
        out, err = self.viewer.communicate(timeout=TIMEOUT)
        self.assertEqual(self.viewer.returncode, 0, err)
        return out, err

    def end(self):
        if self.viewer.poll() is None:
            self.viewer.kill()
        self.viewer.communicate(timeout=TIMEOUT)

    def press(self, *keys):
        for key in keys:
            self.assertEqual(self.tell('key', '--window', self.window, key)[0], 0)
            time.sleep(0.05)

    def shot(self):
        self.press('1')
        return read_png(os.path.join(self.shots, self.viewer.stdout.readline().strip()))

    def shot_that_differs(self, before, what, *again):
        """Takes some: a busy machine may not have drawn a frame since the key went down."""
        for _ in range(20):
            if again:
                self.tell(*again)
            if differing(before, self.shot()) > 0.01:
                return
        self.fail(what + ' changes nothing')

    def on_the_screen(self):
        """What the X server really shows of the window."""
        _, out, _ = self.tell('getwindowgeometry', '--shell', self.window)
        where = {k: int(v) for k, v in (line.split('=') for line in out.split())}
        x, y = where['X'], where['Y']
        return screen.pixels(self.folder)[y:y + where['HEIGHT'], x:x + where['WIDTH']]


class Window(UnderKeys):
    """The window itself: keys, focus, sizes."""

    def test_keys_sizes_and_the_way_out(self):
        self.open(self.city, self.city_pvs, '--cell', 0, '--look=0,0', '--size', '400x300')
        self.press('h', 'o')  # no text, no box: what is left is the scene
        inside = self.shot()
        self.assertEqual(inside.shape, (300, 400, 3))
        deadline = time.monotonic() + 10  # the frame is shown after its screenshot is written
        while differing(inside, self.on_the_screen()) > 0 and time.monotonic() < deadline:
            time.sleep(0.1)
        self.assertEqual(differing(inside, self.on_the_screen()), 0.0, 'the window shows what the screenshot does')
        self.press('p')
        self.assertLessEqual(differing(inside, self.shot()), SAME, 'PVS off looks the same from inside')
        self.press('p', 'x')
        self.assertGreater(differing(inside, self.shot()), 0.2, 'wireframe')
        self.press('x', 'n')
        self.assertGreater(differing(inside, self.shot()), 0.2, 'the next cell')
        self.press('b')
        self.assertEqual(differing(inside, self.shot()), 0.0, 'and back')
        self.tell('keydown', '--window', self.window, 'w')
        self.shot_that_differs(inside, 'flown forward')
        self.tell('keyup', '--window', self.window, 'w')
        ahead = self.shot()
        self.assertEqual(differing(ahead, self.shot()), 0.0, 'and stopped')
        self.press('n', 'b')
        self.assertEqual(differing(inside, self.shot()), 0.0, 'and back')
        self.tell('mousemove', '--window', self.window, 200, 150, 'mousedown', 1)
        self.shot_that_differs(inside, 'dragged round', 'mousemove_relative', 20, 0)
        self.tell('mouseup', 1)
        self.press('f', 'n', 'v')
        self.assertGreater(red(self.shot()), 0.01, "from another cell the frozen cell's set lacks something")
        self.press('v', 'f', 'b')
        self.assertEqual(self.tell('windowsize', '--sync', self.window, 500, 200)[0], 0)
        time.sleep(0.2)
        self.assertEqual(self.shot().shape, (200, 500, 3))
        self.assertEqual(self.tell('windowunmap', '--sync', self.window)[0], 0)
        time.sleep(0.2)
        self.assertIsNone(self.viewer.poll(), 'a hidden window ends nothing')
        self.assertEqual(self.tell('windowmap', '--sync', self.window)[0], 0)
        self.tell('keydown', '--window', self.window, 'Escape')
        self.assertEqual(self.viewer.wait(timeout=TIMEOUT), 0, self.viewer.stderr.read())


class Visit(UnderKeys):
    """A visit: on foot, frozen and from outside, over the map, recorded, followed again, with a file that changes."""

    def test_a_visit(self):
        path = self.path('walk.csv')
        pvs = self.path('visited.pvs')
        shutil.copy(self.city_pvs, pvs)
        self.open(self.city, pvs, '--cell', 0, '--size', '640x360', '--record', path)
        begun = self.numbers()
        self.assertEqual((begun['cell'], begun['walking'], begun['cells']), (0, False, 3))

        # On foot: down to the street, along it, and no further down.
        self.press('g')
        street = self.numbers_when(lambda n: n['on_floor'], 'stands on the street')
        self.tell('keydown', '--window', self.window, 'w')
        away = self.numbers_when(lambda n: math.dist(n['eye'], street['eye']) > 1.5, 'walks')
        self.tell('keyup', '--window', self.window, 'w')
        self.assertTrue(away['walking'])
        self.assertAlmostEqual(away['eye'][1], street['eye'][1], delta=0.4)
        self.press('g')

        # Frozen: the set stays the same wherever the camera flies; inside its cell nothing is wrong, outside it is.
        self.press('n', 'b')
        inside = self.numbers()
        self.assertEqual(inside['cell'], 0)
        self.press('k', 'f')
        frozen = self.numbers_when(lambda n: n['frozen'] and n['wrong_pixels'] is not None, 'frozen, counts')
        self.assertLess(frozen['wrong_pixels'], SAME * 640 * 360)
        self.press('k')
        self.tell('keydown', '--window', self.window, 'Shift_L', 'e')
        outside = self.numbers_when(lambda n: n['eye'][1] > 40, 'flies up')
        self.tell('keyup', '--window', self.window, 'e', 'Shift_L')
        self.assertEqual((outside['shown_cell'], outside['polygons_drawn']), (0, inside['polygons_drawn']))
        self.tell('mousemove', '--window', self.window, 560, 300, 'mousedown', 1)
        down = self.numbers_when(lambda n: self.tell('mousemove_relative', 0, 60) and n['look'][1] < -60, 'looks down')
        self.tell('mouseup', 1)
        self.assertIsNone(down['wrong_pixels'])
        self.press('k')
        self.assertGreater(self.numbers_when(lambda n: n['wrong_pixels'] is not None, 'counts')['wrong_pixels'], 1000)
        self.press('k', 'f')
        everything = self.numbers_when(lambda n: not n['frozen'], 'not frozen')
        self.assertEqual((everything['cell'], everything['polygons_drawn']), (None, 3000))

        # The map, upper right: two of its cells are clicked, one after the other.
        boxes = []
        for cell in range(3):
            boxes.append(self.numbers_when(lambda n: n['cell'] == cell or self.press('n'), 'next cell')['cell_box'])
        for cell in (0, 2):
            for x, y in self.around_on_the_map(boxes, cell):
                self.tell('mousemove', '--window', self.window, x, y, 'click', 1)
                if self.numbers()['cell'] == cell:
                    break
            else:
                self.fail(f'the map does not go to cell {cell}')

        # The panel, upper left: its first switch.
        self.tell('mousemove', '--window', self.window, 27, 66, 'click', 1)
        self.assertEqual(self.numbers_when(lambda n: n['polygons_drawn'] == 3000, 'PVS off')['cell'], 2)
        self.press('p')

        # Objects draw more than ranges; what is not in view is left out.
        ranges = self.numbers()
        self.press('r')
        objects = self.numbers_when(lambda n: n['polygons_drawn'] != ranges['polygons_drawn'], 'objects')
        self.assertGreater(objects['polygons_drawn'], ranges['polygons_drawn'])
        self.press('r', 'u')
        in_view = self.numbers_when(lambda n: n['polygons_drawn'] < ranges['polygons_drawn'], 'frustum')
        self.assertGreater(in_view['polygons_drawn'], 0)
        self.press('u')

        # A file that breaks is named and the old one kept; one that is whole again is read.
        with open(pvs, 'rb') as file:
            whole = file.read()
        with open(pvs, 'wb') as file:
            file.write(whole[:200])
        broken = self.numbers_when(lambda n: n['message'], 'names the broken file')
        self.assertIn('the old file is kept', broken['message'])
        self.assertEqual((broken['cells'], broken['polygons_drawn']), (3, ranges['polygons_drawn']))
        with open(self.fewer_pvs(), 'rb') as file, open(pvs, 'wb') as out:
            out.write(file.read())
        again = self.numbers_when(lambda n: n['cells'] == 2, 'reads the new file')
        self.assertEqual(again['message'], '')

        out, err = self.leave()
        recorded = json.loads(out.splitlines()[-1])
        self.assertIn('[viewer.runtime]; the old file is kept', err)
        with open(path, encoding='utf-8') as file:
            poses = file.read().splitlines()[1:]
        self.assertEqual(recorded['recorded'], len(poses))

        # The same path again ends in the same place.
        self.open(self.city, pvs, '--size', '640x360', '--replay', self.shortened(path, poses))
        replayed = self.said()
        for name in ('eye', 'look', 'cell', 'polygons_drawn'):
            self.assertEqual(replayed[name], recorded[name], name)
        self.leave()

        costs = self.path('costs.csv')
        code, out, err = run(program('sightcell-viewer'), self.city, pvs, '--replay', path, '--benchmark', costs,
                             '--poses', 5, '--size', SIZE, display=self.display)
        self.assertEqual(code, 0, err)
        sums = json.loads(out)
        with open(costs, encoding='utf-8', newline='') as file:
            rows = list(csv.DictReader(file))
        self.assertEqual((sums['poses'], len(rows)), (5, 5))
        self.assertEqual(sums['polygons'], sum(int(row['polygons']) for row in rows))
        self.assertEqual(sums['all_polygons'], 5 * 3000)

    @staticmethod
    def around_on_the_map(boxes, number):
        """Pixels about the center of a cell on the map of a window of 640 x 360."""
        low, high = ([pick(box[end][axis] for box in boxes) for axis in (0, 2)] for end, pick in ((0, min), (1, max)))
        border = 2 + max(4, 0.1 * max(high[0] - low[0], high[1] - low[1]))
        # Contents of the map's window: 8 pixels of padding, a line of text above and the legend below.
        left, top, wide, tall = 640 - 160 - 2, 35, 144, 136
        scale = min(wide / (high[0] - low[0] + 2 * border), tall / (high[1] - low[1] + 2 * border))
        center = [(boxes[number][0][axis] + boxes[number][1][axis]) / 2 for axis in (0, 2)]
        x, y = (begin + size / 2 + scale * (c - (a + b) / 2) for begin, size, c, a, b in
                zip((left, top), (wide, tall), center, low, high))
        return [(round(x + dx), round(y + dy)) for dy in (0, 4, -4, 8, -8) for dx in (0, 4, -4, 8, -8)]

    def fewer_pvs(self):
        out = self.path('fewer.pvs')
        self.bake(self.city, out, self.city_cells, '--cell-limit', 2)
        return out

    def shortened(self, path, poses):
        """Every tenth pose and the last one, in no time."""
        out = self.path('short.csv')
        with open(path, encoding='utf-8') as file:
            heading = file.readline()
        with open(out, 'w', encoding='utf-8') as file:
            file.write(heading)
            for pose in poses[:-1:10] + poses[-1:]:
                file.write('0,' + pose.split(',', 1)[1] + '\n')
        return out


def bakes_of(scene):
    """The processes that bake a scene."""
    found = []
    for process in filter(str.isdigit, os.listdir('/proc')):
        try:
            with open(f'/proc/{process}/cmdline', 'rb') as file:
                words = file.read().decode(errors='replace').split('\0')
        except OSError:
            continue  # it has ended
        if words[1:3] == ['bake', scene]:
            found.append(process)
    return found


class Edit(UnderKeys):
    """A scene that is edited while its window is open."""

    def test_an_edit(self):
        scene, pvs, place = self.path('edit.glb'), self.path('edit.pvs'), self.path('camera.json')
        shutil.copy(self.city, scene)
        shutil.copy(self.city_pvs, pvs)
        self.open(scene, pvs, '--cell', 1, '--camera-file', place, '--size', '400x300')
        before = self.numbers_when(lambda n: os.path.exists(place), 'the camera is written')
        with open(place, encoding='utf-8') as file:
            numpy.testing.assert_allclose(json.load(file)['path'], [before['eye']], atol=1e-4)
        self.assertEqual((before['polygons'], before['cells']), (3000, 3))
        self.press('u')

        # The file of the new version comes after the scene. Both are replaced as editors and bakes do it.
        shutil.copy(self.room, self.path('new.glb'))
        os.replace(self.path('new.glb'), scene)
        same = self.numbers()
        self.assertEqual((same['polygons'], same['message']), (3000, ''))
        shutil.copy(self.room_pvs, self.path('new.pvs'))
        os.replace(self.path('new.pvs'), pvs)
        after = self.numbers_when(lambda n: n['polygons'] != 3000, 'the new version is shown')
        self.assertEqual((after['cells'], after['eye'], after['look']), (1, before['eye'], before['look']))
        self.press('n')
        inside = self.numbers_when(lambda n: n['cell'] == 0, 'its cell')
        self.assertNotEqual(inside['eye'], before['eye'])

        # A file of a version that is not there changes nothing.
        shutil.copy(self.city_pvs, self.path('new.pvs'))
        os.replace(self.path('new.pvs'), pvs)
        kept = self.numbers_when(lambda n: n['message'], 'it is named')
        self.assertIn('another scene', kept['message'])
        self.assertEqual((kept['polygons'], kept['cells']), (after['polygons'], 1))
        with open(place, encoding='utf-8') as file:
            self.assertNotEqual(json.load(file)['path'], [before['eye']])
        _, err = self.leave()
        self.assertIn(f'{scene} and {pvs} were read: 1 cells', err)


class Bake(UnderKeys):
    """A bake in the background, of a scene without a .pvs file."""

    def test_a_bake(self):
        scene, pvs = self.path('alone.glb'), self.path('alone.pvs')
        shutil.copy(self.city, scene)
        self.open(scene, '--cells-file', self.city_cells, '--bake', 'draft', '--size', '640x360')
        begun = self.numbers()
        self.assertEqual((begun['cells'], begun['polygons_drawn']), (0, 3000))
        self.assertEqual((begun['bake']['step'], begun['bake']['output']), ('running', pvs))
        done = self.numbers_when(lambda n: n['bake']['step'] != 'running', 'the bake ends')
        self.assertEqual((done['bake']['step'], done['bake']['error']), ('done', ''))
        count = done['bake']['cells_total']
        self.assertEqual((done['bake']['cells'], done['bake']['cells_shown'], done['cells']), (count, count, count))
        self.assertEqual(done['cells_timed'], count)
        self.assertIsNotNone(done['cell'], 'the camera is in a cell of the new file')
        self.assertLess(done['polygons_drawn'], 1500)
        self.assertIn(f'{pvs} was read: {count} cells', self.leave()[1])

        # A file beside the scene is offered, not opened and not replaced.
        before = os.stat(pvs)
        self.open(scene, '--size', '640x360')
        self.assertEqual(self.numbers()['bake']['step'], 'idle')
        self.leave()
        self.assertEqual(os.stat(pvs).st_mtime_ns, before.st_mtime_ns)

        # A bake that fails names its cause, and the scene is still there.
        os.remove(pvs)
        os.mkdir(pvs)
        self.open(scene, '--bake', 'draft', '--size', '640x360')
        failed = self.numbers_when(lambda n: n['bake']['step'] != 'running', 'the bake ends')
        self.assertEqual((failed['bake']['step'], failed['polygons_drawn']), ('failed', 3000))
        self.assertIn(pvs, failed['bake']['error'])
        self.leave()

    def test_closing_the_window_ends_the_bake(self):
        scene, pvs = self.path('closed.glb'), self.path('closed.pvs')
        shutil.copy(self.city, scene)
        self.open(scene, '--cells-file', self.city_cells, '--bake', 'final', '--size', '640x360')
        self.numbers_when(lambda n: n['bake']['cells_total'] > 0, 'the bake begins')
        self.assertEqual(len(bakes_of(scene)), 1)
        self.leave()
        self.assertEqual(bakes_of(scene), [], 'the bake goes on')

        self.open(scene, '--cells-file', self.city_cells, '--bake', 'final', '--size', '640x360')
        self.numbers_when(lambda n: n['bake']['cells_total'] > 0, 'the bake begins')
        self.viewer.terminate()
        self.viewer.communicate(timeout=TIMEOUT)
        self.assertEqual((self.viewer.returncode, bakes_of(scene)), (0, []), 'after a signal')
        self.assertFalse(os.path.exists(pvs))


class Refusals(InFolder):
    """One line and an exit code for all that cannot be shown. None of it needs a display."""

    def refuse(self, code, identifier, *arguments):
        answer, out, err = run(program('sightcell-viewer'), *arguments)
        self.assertEqual((answer, out), (code, ''), f'{arguments}\n{err}')
        lines = err.splitlines()
        self.assertEqual(len(lines), 1, err)
        self.assertTrue(lines[0].startswith('sightcell-viewer: '), err)
        self.assertTrue(lines[0].endswith(f'[{identifier}]'), err)
        return lines[0]

    def test_wrong_use(self):
        for arguments in ([], [self.city, self.city_pvs, '--fly'], [self.city, '--mode', 'half'],
                          [self.city, '--size', '800'], [self.city, '--size', '0x0'], [self.city, '--size', '8x8k'],
                          [self.city, '--eye', '1,2'], [self.city, '--eye', '1,nan,2'], [self.city, '--look', 'up,1'],
                          [self.city, '--frames', '3'], [self.city, '--cell', '0'], [self.city, '--fov', '0'],
                          [self.city, '--benchmark', 'x.csv'], [self.city, '--record', 'x', '--screenshot', 'x.png'],
                          [self.city, '--screenshot', 'x.png', '--show', 'sky'],
                          [self.city, '--bake', 'best'], [self.city, self.city_pvs, '--bake', 'draft'],
                          [self.city, '--bake', 'draft', '--screenshot', 'x.png'],
                          [self.city, '--screenshot', 'x.png', '--frames', '0']):
            self.refuse(2, 'viewer.wrong-use', *arguments)

        for option in ('--cell', '--frozen-from'):
            self.refuse(2, 'viewer.no-such-cell', self.city, self.city_pvs, option, 3)

    def test_another_scene_names_both(self):
        line = self.refuse(4, 'viewer.other-scene', self.room, self.city_pvs)
        self.assertIn('room.glb', line)
        self.assertIn('city.pvs', line)
        higher = self.path('higher.glb')  # as many draws and polygons
        write_room(higher, 5)
        self.refuse(4, 'viewer.other-scene', higher, self.room_pvs)

    def test_broken_files(self):
        broken = self.path('broken')
        with open(broken, 'wb') as out:
            out.write(b'nothing of ours' * 100)
        with open(self.city_pvs, 'rb') as file:
            whole = file.read()
        cut = self.path('cut.pvs')
        with open(cut, 'wb') as out:
            out.write(whole[:len(whole) // 2])
        self.assertIn(broken, self.refuse(4, 'viewer.runtime', self.city, broken))
        self.assertIn(cut, self.refuse(4, 'viewer.runtime', self.city, cut))
        self.assertIn('no.pvs', self.refuse(4, 'viewer.runtime', self.city, self.path('no.pvs')))
        self.assertIn('no.json', self.refuse(4, 'viewer.cells', self.city, self.city_pvs, '--cells-file',
                                             self.path('no.json')))
        self.refuse(4, 'viewer.cells', self.city, self.city_pvs, '--cells-file', broken)
        for path in (broken, self.path('no.csv')):
            self.assertIn(path, self.refuse(4, 'viewer.path', self.city, '--replay', path))
        for scene in (broken, self.path('no.glb')):
            answer, _, err = run(program('sightcell-viewer'), scene)
            self.assertEqual((answer, len(err.splitlines())), (4, 1), err)

    def test_no_display(self):
        line = self.refuse(1, 'viewer.no-display', self.city, self.city_pvs)
        self.assertIn('DISPLAY', line)

    def test_help(self):
        answer, out, err = run(program('sightcell-viewer'), '--help')
        self.assertEqual((answer, err), (0, ''))
        for option in ('--cells-file', '--size', '--cell', '--eye', '--look', '--mode', '--frozen-from',
                       '--screenshot', '--frames', '--show', '--fov', '--walk', '--record', '--replay', '--benchmark'):
            self.assertIn(option, out)
