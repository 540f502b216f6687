"""level_flight and shadow_cascades in a hall with a wall and boxes: nothing differs, and planted faults are found."""
import json
import os
import sys

from harness import ROOT, InRoom, program, run

sys.path[:0] = [os.path.join(ROOT, 'tests', 'cli')]
from slivers_test import write_solids  # noqa: E402

HALL = ([-4, -4, -4], [20, 4, 4])
BOX, LEVEL = ([12, -1, -1], [13, 1, 1]), ([12.1, -0.9, -0.9], [12.9, 0.9, 0.9])
CANOPY, GROUND = ([4, 3, -3], [6, 3.5, 3]), ([-20, -1, -20], [20, 0, 20])


class Views(InRoom):
    def bake(self, scene, cell, *more):
        file = self.path('file.pvs')
        self.expect(0, 'bake', scene, '-o', file, f'--cells-grid={cell}', '--max-pixel-error', '1e-3', '--fresh', *more)
        return file

    def measured(self, name, *arguments):
        code, out, err = run(program(name), *arguments)
        self.assertEqual(code, 0, err)
        return json.loads(out)

    def test_a_flight_across_a_switch(self):
        """The box is in the set, and its level in its place."""
        def put(document):
            document['nodes'][0]['name'] = 'box'
            document['nodes'][1]['extras'] = {'sightcell': {'level_of': 'box', 'from_distance': 11}}
        scene = self.path('levels.glb')
        write_solids(scene, [BOX, LEVEL], [HALL], put)
        file = self.bake(scene, '-1.5,-0.5,-0.5,5.5,0.5,0.5')
        way = scene, file, '--from=-1,0,0', '--to=5,0,0', '--frames', '13', '--width', '64', '--height', '36'
        right = self.measured('level_flight', *way)
        self.assertEqual((right['frames'], right['objects_that_switch'], right['switches']), (26, 1, 1))
        self.assertGreater(right['at_levels_percent'], 0)
        self.assertEqual(right['differ'], 0)
        dropped = self.measured('level_flight', *way, '--drop-levels')
        self.assertEqual(dropped['missed_pixels'], round(right['at_levels_percent'] / 100 * right['pixels']))

    def test_shadow_maps(self):
        """A canopy behind a wall: only its shadow is visible. The floor is lit from above."""
        scene = self.path('shadow.glb')
        wall = ([3, 1.5, -3], [3.2, 6, 3])
        write_solids(scene, [GROUND, CANOPY, wall])
        file = self.bake(scene, '-0.5,0.6,-0.5,0.5,1.2,0.5', '--sun', '180,80')
        right = self.measured('shadow_cascades', scene, file, '--views', '12', '--width', '64', '--height', '36')
        self.assertGreater(right['shadowed_percent'], 0)
        self.assertEqual(right['wrong'], 0)
        self.assertGreater(right['wrong_of_sets'], 0)
        fault = self.measured('shadow_cascades', scene, file, '--views', '12', '--width', '64', '--height', '36', '--no-casters')
        self.assertEqual(fault['wrong'], right['wrong_of_sets'])
        self.assertGreater(fault['standard_error'], 0)
        # Pixels at the edge of a shadow are wrong beside their points.
        self.assertLess(0.9 * fault['wrong'], fault['wrong_at_point'])
        self.assertLess(fault['wrong_at_point'], fault['wrong'])
