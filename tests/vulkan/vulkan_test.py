"""sightcell-vulkan on baked scenes: all modes show what drawing everything shows, with fewer triangles; faults show."""
import json
import os

import numpy

import harness
from colonnade_scene import write_cells, write_colonnade
from harness import must, program, run, start_screen, vulkan_on_cpu
from png import read_png

MODES = ['everything', 'frustum', 'commands', 'clusters']
MOST_WRONG = 1e-4  # share of the pixels


class InFolder(harness.InFolder):
    """A town and a hall of instances, mirrored ones and panes among them, each with four cells."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.driver = vulkan_on_cpu()
        cls.city_cells, cls.hall, cls.hall_cells = map(cls.path, ('city.json', 'hall.glb', 'hall.json'))
        cls.city = cls.make_city('city.glb', '--cells', cls.city_cells, polygons=20000)
        write_colonnade(cls.hall)
        write_cells(cls.hall_cells)

    @classmethod
    def bake(cls, scene, cells, name, *more):
        out = cls.path(name)
        if not os.path.exists(out):
            must(program('sightcell'), 'bake', scene, '-o', out, '--cells-file', cells, '--cell-limit', 4,
                     '--progress', 'none', *more)
        return out

    def draw(self, code, *arguments, display=None):
        """Standard output and error."""
        answer, out, err = run(program('sightcell-vulkan'), *arguments, environment=self.driver, display=display)
        self.assertEqual(answer, code, f'{arguments}\n{out}\n{err}')
        return out, err

    def measure(self, code, *arguments):
        """The JSON object."""
        out, _ = self.draw(code, *arguments, '--json', '--width', 256, '--height', 192)
        return json.loads(out)


class Draws(InFolder):
    def assert_same_pictures(self, said, frames):
        self.assertEqual(list(said['modes']), MODES)
        for name, mode in said['modes'].items():
            self.assertEqual(mode['frames'], frames, name)
            self.assertLessEqual(mode['wrong_share'], MOST_WRONG, name)
        for name in ('everything', 'frustum'):
            self.assertEqual(said['modes'][name]['wrong_pixels'], 0, name)

    def assert_fewer_triangles(self, said, *names):
        triangles = [said['modes'][name]['triangles'] for name in names]
        self.assertEqual(triangles, sorted(triangles, reverse=True), names)
        self.assertEqual(len(set(triangles)), len(names), f'{names}: {triangles}')

    def test_a_city(self):
        said = self.measure(0, self.city, self.bake(self.city, self.city_cells, 'city.pvs'))
        self.assertEqual((said['polygons'], said['cells'], said['draw_count']), (20000, 4, True))
        self.assertGreaterEqual(said['clusters'], 20000 / 128)
        self.assert_same_pictures(said, 16)
        self.assertEqual(said['modes']['everything']['triangles'], 20000)
        self.assertEqual(said['modes']['everything']['draws'], said['draws'])
        self.assert_fewer_triangles(said, 'everything', 'frustum', 'clusters', 'commands')

    def test_instances_of_one_mesh(self):
        said = self.measure(0, self.hall, self.bake(self.hall, self.hall_cells, 'hall.pvs'))
        self.assertEqual((said['polygons'], said['draws']), (1104, 20))
        self.assertEqual(said['pipelines'], 3, 'polygons of instances, of mirrored ones, and of panes')
        self.assert_same_pictures(said, 16)
        self.assert_fewer_triangles(said, 'everything', 'frustum', 'commands')

    def test_a_device_that_cannot_count_draws(self):
        for scene, pvs in ((self.city, self.bake(self.city, self.city_cells, 'city.pvs')),
                           (self.hall, self.bake(self.hall, self.hall_cells, 'hall.pvs'))):
            counts = self.measure(0, scene, pvs)
            said = self.measure(0, scene, pvs, '--no-draw-count')
            self.assertFalse(said['draw_count'])
            for name in MODES:
                for key in ('draws', 'triangles', 'wrong_pixels'):
                    self.assertEqual(said['modes'][name][key], counts['modes'][name][key], (name, key))

    def test_gaps_are_drawn_where_asked_for(self):
        pvs = self.bake(self.hall, self.hall_cells, 'exact.pvs', '--profile', 'exact')
        exact, said = self.measure(0, self.hall, pvs), self.measure(0, self.hall, pvs, '--min-gap', 6)
        self.assert_same_pictures(said, 16)
        self.assertGreater(said['modes']['commands']['triangles'], exact['modes']['commands']['triangles'])
        self.assertLess(said['modes']['commands']['draws'], exact['modes']['commands']['draws'])

    def test_a_missing_cluster_shows(self):
        pvs = self.bake(self.city, self.city_cells, 'city.pvs')
        said = self.measure(1, self.city, pvs, '--leave-out', 4)
        self.assertGreater(said['modes']['clusters']['wrong_share'], 100 * MOST_WRONG)
        self.assertLessEqual(said['modes']['commands']['wrong_share'], MOST_WRONG)
        self.draw(0, self.city, pvs, '--leave-out', 4, '--max-wrong', 1)

    def test_a_missing_polygon_shows(self):
        pvs, damaged = self.bake(self.hall, self.hall_cells, 'hall.pvs'), self.path('damaged.pvs')
        must(program('sightcell-test-drop-polygon'), pvs, damaged, 1, 0)  # half of the floor
        said = self.measure(1, self.hall, damaged)
        self.assertGreater(said['modes']['commands']['wrong_share'], 10 * MOST_WRONG)
        self.assertEqual(said['modes']['frustum']['wrong_pixels'], 0)

    def test_a_screenshot(self):
        pvs, pictures = self.bake(self.city, self.city_cells, 'city.pvs'), []
        for mode in ('everything', 'clusters'):
            file = self.path(mode + '.png')
            self.draw(0, self.city, pvs, '--screenshot', file, '--mode', mode, '--cells', 1, '--headings', 1)
            pictures.append(read_png(file))
        self.assertEqual(pictures[0].shape, (480, 640, 3))
        self.assertGreater(len(numpy.unique(pictures[0].reshape(-1, 3), axis=0)), 20)
        self.assertLessEqual(float((pictures[0] != pictures[1]).any(axis=2).mean()), 1e-3)


class Refusals(InFolder):
    def assert_refused(self, identifier, *arguments):
        out, err = self.draw(4, *arguments)
        self.assertEqual((out, len(err.splitlines())), ('', 1), err)
        self.assertTrue(err.rstrip().endswith(f'[{identifier}]'), err)

    def test_files_that_do_not_belong_together(self):
        quick = ('--quality', 'draft')
        pvs = self.bake(self.hall, self.hall_cells, 'quick.pvs', *quick)
        self.assert_refused('vulkan.other-scene', self.city, pvs)
        self.assert_refused('vulkan.layout', self.hall,
                            self.bake(self.hall, self.hall_cells, 'merged.pvs', *quick, '--layout', 'merged'))
        self.assert_refused('vulkan.per-instance', self.hall,
                            self.bake(self.hall, self.hall_cells, 'own.pvs', *quick, '--order', 'per-instance'))
        self.assert_refused('vulkan.runtime', self.hall, self.hall_cells)

    def test_wrong_use(self):
        self.draw(2, self.hall)
        self.draw(2, self.hall, self.hall, '--mode', 'nothing')


class Window(InFolder):
    def test_a_walk_under_a_virtual_screen(self):
        display = start_screen(self.addCleanup, self.folder)
        pvs, picture = self.bake(self.hall, self.hall_cells, 'hall.pvs', '--quality', 'draft'), self.path('walk.png')
        self.draw(0, self.hall, pvs, '--window', '--frames', 10, '--width', 320, '--height', 240, '--screenshot',
                  picture, display=display)
        self.assertEqual(read_png(picture).shape, (240, 320, 3))
        self.assertGreater(len(numpy.unique(read_png(picture).reshape(-1, 3), axis=0)), 20)
        _, err = self.draw(1, self.hall, pvs, '--window')
        self.assertTrue(err.rstrip().endswith('[vulkan.window]'), err)
