"""sightcell-gpu-driven on baked scenes: each mode shows what drawing everything shows, with fewer clusters; faults show."""
import json
import os

import numpy

import harness
from cave_scene import write_cave
from colonnade_scene import write_cells, write_colonnade
from harness import must, program, run, skip_without_egl
from png import read_png
from screens_scene import write_screens

MODES = ['everything', 'frustum', 'pvs', 'last_frame', 'two_pass', 'pvs_two_pass']
SKY = (181, 208, 239)  # of the sample, in sRGB
RIGHT = ['frustum', 'pvs', 'two_pass', 'pvs_two_pass']  # last_frame misses what comes into view


class GpuDriven(harness.InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.city_cells, cls.hall_cells = cls.path('city.json'), cls.path('hall.json')
        cls.city = cls.pack(cls.make_city('plain.glb', '--cells', cls.city_cells, polygons=20000), 'city.glb')
        cls.hall, cls.screens = cls.path('hall.glb'), cls.path('screens.glb')
        write_colonnade(cls.hall)
        write_screens(cls.screens)
        write_cells(cls.hall_cells)

    @classmethod
    def pack(cls, scene, name):
        must(program('sightcell'), 'pack', '--meshlets', '--levels', scene, '-o', cls.path(name))
        return cls.path(name)

    @classmethod
    def bake(cls, scene, cells, *more):
        out = scene.replace('.glb', '.pvs')
        if not os.path.exists(out):
            must(program('sightcell'), 'bake', scene, '-o', out, '--cells-file', cells, '--progress', 'none', *more)
        return out

    def draw(self, code, *arguments):
        """Standard output and error."""
        answer, out, err = run(program('sightcell-gpu-driven'), *arguments)
        skip_without_egl(answer, err)
        self.assertEqual(answer, code, f'{arguments}\n{out}\n{err}')
        return out, err

    def measure(self, code, *arguments):
        """The JSON object."""
        return json.loads(self.draw(code, *arguments, '--json', '--width', 200, '--height', 150)[0])

    def bake_city(self):
        return self.bake(self.city, self.city_cells, '--cell-limit', 6)

    def assert_same_pictures(self, section, modes=MODES):
        self.assertEqual(list(section['modes']), modes)
        for name in RIGHT:
            mode = section['modes'][name]
            self.assertLessEqual(mode['wrong_share'], 1e-4, name)
            self.assertEqual(mode['missed_with_wrong'] == 0, mode['wrong_pixels'] == 0, name)
        for name in ('frustum', 'two_pass'):
            self.assertEqual(section['modes'][name]['wrong_pixels'], 0, name)
        self.assertGreaterEqual(section['seen_in_set_share'], 0.99)

    def clusters(self, section):
        return {name: mode['clusters'] for name, mode in section['modes'].items() if name != 'everything'}

    def test_a_city(self):
        said = self.measure(0, self.city, self.bake_city(), '--cuts', 8, '--frames', 40)
        self.assertEqual((said['polygons'], said['triangles'], said['cells']), (20000, 20000, 6))
        self.assertGreaterEqual(said['clusters'], 20000 / 128)
        self.assertEqual({name: s['frames'] for name, s in said['sections'].items() if name != 'turns'},
                         {'cuts': 8, 'settled': 8, 'walk': 40})
        for section in said['sections'].values():
            self.assert_same_pictures(section)
            drawn = self.clusters(section)
            self.assertLessEqual(section['seen'], drawn['two_pass'])
            self.assertLess(drawn['pvs'], drawn['frustum'])
            self.assertLessEqual(drawn['pvs_two_pass'], min(drawn['pvs'], drawn['two_pass']))
            self.assertEqual(section['modes']['pvs']['in_set_share'], 1)
        # After a cut nothing is known of what is visible: depth occludes little in the first frame, the PVS much.
        first, settled = (self.clusters(said['sections'][name]) for name in ('cuts', 'settled'))
        self.assertGreater(first['two_pass'], 1.5 * settled['two_pass'])
        self.assertEqual(first['pvs'], settled['pvs'])
        self.assertLess(first['pvs'], first['two_pass'])

    def test_cuts_of_a_city(self):
        drawn = []
        for pixels in (0, 8):
            said = self.measure(0, self.city, self.bake_city(), '--levels', pixels, '--cuts', 6, '--frames', 12)
            self.assertEqual((said['cut_pixels'], said['triangles']), (pixels, 20000))
            self.assertGreater(said['coarse_clusters'], 100)
            for section in said['sections'].values():
                self.assert_same_pictures(section, MODES + ['leaves'])
                self.assertEqual(section['modes']['pvs']['in_set_share'], 1)
                triangles = {name: mode['triangles'] for name, mode in section['modes'].items()}
                self.assertLess(triangles['pvs'], triangles['frustum'])
                self.assertLessEqual(triangles['everything'], 20000)
            drawn.append(said['sections']['cuts']['modes'])
        for finer, coarser in zip(drawn, drawn[1:]):
            self.assertLess(coarser['everything']['triangles'], finer['everything']['triangles'])
            self.assertGreaterEqual(coarser['leaves']['mean_difference'], finer['leaves']['mean_difference'])
        self.assertLess(drawn[0]['leaves']['differing_share'], 1e-3)
        self.assertEqual(drawn[0]['leaves']['triangles'], drawn[1]['leaves']['triangles'])

    def sky_pixels(self, *arguments):
        file = self.path('cave.png')
        self.draw(0, *arguments, '--screenshot', file, '--cuts', 0, '--frames', 0, '--width', 240, '--height', 160)
        away = numpy.abs(read_png(file).astype(int) - SKY)
        return int((away.max(axis=2) <= 1).sum())

    def test_cuts_have_no_gaps(self):
        source, cells = self.path('cave-source.glb'), self.path('cave.json')
        write_cave(source)
        with open(cells, 'w') as out:
            json.dump({'margin': 0.25, 'cells': [{'min': [29, -1, -3], 'max': [31, 1, -1]}]}, out)
        cave = self.pack(source, 'cave.glb')
        pvs = self.bake(cave, cells, '--quality', 'draft')
        triangles = []
        for pixels in (2, 8):
            said = self.measure(0, cave, pvs, '--levels', pixels, '--cuts', 6, '--frames', 0)
            modes = said['sections']['cuts']['modes']
            triangles += [modes['everything']['triangles'], modes['leaves']['triangles']]
            for view in range(3):
                for mode in ('everything', 'pvs'):
                    self.assertEqual(self.sky_pixels(cave, pvs, '--levels', pixels, '--view', view, '--mode', mode), 0)
        self.assertLess(triangles[2], triangles[0])
        self.assertLess(triangles[0], 0.9 * said['triangles'])
        self.assertGreater(self.sky_pixels(cave, pvs, '--levels', 2, '--mode', 'pvs', '--leave-out', 9), 0)

    def test_the_last_frame_misses_what_comes_into_view(self):
        said = self.measure(0, self.city, self.bake_city(), '--cuts', 12, '--frames', 0, '--seed', 3)
        self.assertGreater(said['sections']['cuts']['modes']['last_frame']['wrong_share'], 1e-3)
        self.assertGreater(said['sections']['cuts']['modes']['last_frame']['missed_with_wrong'], 0)
        self.assertEqual(said['sections']['settled']['modes']['last_frame']['wrong_pixels'], 0)

    def test_instances_masks_both_sides_and_glass(self):
        for scene, bins in ((self.hall, 3), (self.screens, 5)):
            said = self.measure(0, scene, self.bake(scene, self.hall_cells), '--cuts', 24, '--frames', 0)
            self.assertEqual(said['bins'], bins)
            for section in said['sections'].values():
                self.assert_same_pictures(section)
                drawn = self.clusters(section)
                self.assertLess(drawn['frustum'], said['clusters'])
                self.assertLessEqual(drawn['two_pass'], drawn['frustum'])

    def test_masks_are_seen_through(self):
        whole = self.path('whole.glb')
        write_screens(whole, mask='OPAQUE')
        seen = []
        for scene in (whole, self.screens):
            said = self.measure(0, scene, self.bake(scene, self.hall_cells), '--cuts', 12, '--frames', 0)
            seen.append(said['sections']['cuts']['seen'])
        self.assertLess(*seen)

    def test_a_device_that_cannot_count_draws(self):
        arguments = (self.screens, self.bake(self.screens, self.hall_cells), '--cuts', 4, '--frames', 20)
        counts, said = self.measure(0, *arguments), self.measure(0, *arguments, '--no-draw-count')
        self.assertFalse(said['count_in_buffer'])
        for section in ('cuts', 'settled', 'walk'):
            for name in MODES[1:]:
                for key in ('clusters', 'triangles', 'missed', 'wrong_pixels'):
                    self.assertEqual(said['sections'][section]['modes'][name][key],
                                     counts['sections'][section]['modes'][name][key], (section, name, key))

    def test_a_missing_cluster_shows(self):
        said = self.measure(1, self.city, self.bake_city(), '--leave-out', 4, '--cuts', 4, '--frames', 0)
        for name in ('pvs', 'pvs_two_pass'):
            mode = said['sections']['cuts']['modes'][name]
            self.assertGreater(mode['wrong_share'], 1e-2)
            self.assertGreater(mode['missed_with_wrong'], 0)
            self.assertGreater(mode['beyond_bound'], 0)
        self.assertLess(said['sections']['cuts']['seen_in_set_share'], 0.95)
        self.assertEqual(said['sections']['cuts']['modes']['two_pass']['wrong_pixels'], 0)
        self.measure(0, self.city, self.bake_city(), '--leave-out', 4, '--cuts', 1, '--frames', 0, '--max-wrong', 1)

    def test_a_screenshot(self):
        pictures = []
        for mode in ('everything', 'pvs_two_pass'):
            file = self.path(mode + '.png')
            self.draw(0, self.city, self.bake_city(), '--screenshot', file, '--mode', mode, '--cuts', 1, '--frames', 0,
                      '--width', 320, '--height', 200)
            pictures.append(read_png(file))
        self.assertEqual(pictures[0].shape, (200, 320, 3))
        self.assertGreater(len(numpy.unique(pictures[0].reshape(-1, 3), axis=0)), 20)
        self.assertLessEqual(float((pictures[0] != pictures[1]).any(axis=2).mean()), 1e-3)

    def test_refusals(self):
        pvs = self.bake(self.hall, self.hall_cells)
        for identifier, arguments in (('gpu-driven.other-scene', (self.city, pvs)),
                                      ('gpu-driven.runtime', (self.hall, self.hall_cells))):
            out, err = self.draw(4, *arguments)
            self.assertEqual((out, len(err.splitlines())), ('', 1), err)
            self.assertTrue(err.rstrip().endswith(f'[{identifier}]'), err)
        out, err = self.draw(4, self.hall, pvs, '--levels', 1)
        self.assertTrue(err.rstrip().endswith('[gpu-driven.no-levels]'), err)
        with open(self.city, 'rb') as file:
            data = bytearray(file.read())
        at = data.index(b'SCML')
        for place, value in ((16, 2), (24, 1 << 31), (12, 1 << 30)):
            damaged = self.path('damaged.glb')
            with open(damaged, 'wb') as file:
                file.write(data[:at + place] + value.to_bytes(4, 'little') + data[at + place + 4:])
            out, err = self.draw(4, damaged, self.bake_city(), '--levels', 1)
            self.assertEqual((out, len(err.splitlines())), ('', 1), err)
            self.assertTrue(err.rstrip().endswith('[gpu-driven.levels]'), err)
        self.draw(2, self.hall)
        self.draw(2, self.hall, pvs, '--mode', 'nothing')
