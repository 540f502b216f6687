"""The Blender add-on, installed from its zip: marks in the .glb, bakes, cells, freeze, what no cell sees, failures.

All of it is one start of Blender, whose script (in_blender.py) writes down what happened.
"""
import json
import os
import subprocess
import sys

import harness
from harness import SETTINGS, program, read, run

LEVEL_OPTIONS = ['--quality', 'draft', '--samples', '8', '--resolution', '64', '--progress', 'none']
NOT_SEEN_FROM_THE_FIRST_ROOM = {'corner', 'pile', 'treasure', 'navigation'}


def document_of(path):
    data = read(path)
    return json.loads(data[20:20 + int.from_bytes(data[12:16], 'little')])


def environment_of(home):
    """What makes Blender keep its settings and add-ons in a new folder."""
    os.makedirs(os.path.join(home, 'scripts', 'addons'))
    return {'HOME': home, 'BLENDER_USER_CONFIG': home, 'BLENDER_USER_SCRIPTS': os.path.join(home, 'scripts'),
            'XDG_CONFIG_HOME': home, 'XDG_CACHE_HOME': home}


class Addon(harness.InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.level, home = cls.path('a level ü'), cls.path('home')
        os.mkdir(cls.level)
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'in_blender.py')
        code, out, err = run(SETTINGS['blender'], '--background', '--factory-startup', '--python-exit-code', 1,
                             '--python', script, '--', SETTINGS['zip'], program('sightcell'), cls.level,
                             environment=environment_of(home))
        if code != 0:
            raise RuntimeError(f'Blender: {code}\n{out}\n{err}')
        with open(os.path.join(cls.level, 'facts.json'), encoding='utf-8') as file:
            cls.facts = json.load(file)

    def file(self, name):
        return os.path.join(self.level, name)

    def test_the_zip_has_the_same_bytes_each_time(self):
        maker = os.path.join(harness.ROOT, 'samples', 'blender', 'make_zip.py')
        again = self.path('again.zip')
        subprocess.run([sys.executable, '-B', maker, os.path.join(os.path.dirname(maker), 'sightcell'),
                        os.path.join(harness.ROOT, 'LICENSE'), again], check=True)
        self.assertEqual(read(again), read(SETTINGS['zip']))

    def test_marks_arrive_as_documented(self):
        document = document_of(self.file('first.glb'))
        found = {node['name']: node['extras']['sightcell'] for node in document['nodes'] if 'extras' in node}
        self.assertEqual(found, {
            'door': {'group': 'door 1'}, 'cart': {'dynamic': True}, 'fence': {'occluder': False},
            'navigation': {'never': True}, 'cell of the first room': {'cell': True},
            'cell of the second room': {'cell': True}, 'Start': {'start': True}, 'lamp': 'shiny'})
        for mark in found.values():
            for value in mark.values() if isinstance(mark, dict) else ():
                self.assertIn(type(value), (bool, str))  # 1 is equal to True
        self.assertNotIn('extras', document['scenes'][0])
        self.assertEqual(self.facts['scale of the cell'], [0.5, 0.5, 0.5])
        self.assertEqual(self.facts['marks']['door'], 'Door "door 1"')
        self.assertIn('clear it', self.facts['marks']['lamp'])

    def test_the_bake_is_that_of_the_command_line(self):
        self.assertEqual(self.facts['files'], ['level.blend', 'level.glb', 'level.pvs'])
        again = self.path('again.pvs')
        self.expect(0, 'bake', self.file('first.glb'), '-o', again, *LEVEL_OPTIONS)
        self.assertEqual(read(again), read(self.file('first.pvs')))

    def test_a_bake_leaves_edit_modes_as_they_were(self):
        self.assertEqual((self.facts['mode'], self.facts['active']), ('EDIT', 'door'))

    def test_a_broken_mark_is_named(self):
        error, messages = self.facts['bake']
        self.assertIsNone(error)
        self.assertEqual([(kind, name) for kind, _, name in messages], [('WARNING', 'lamp')])
        self.assertIn('"lamp"', messages[0][1])
        self.assertNotIn('nodes[', messages[0][1])

    def test_cells_are_boxes_in_the_axes_of_blender(self):
        for got, wanted in zip(self.facts['boxes'], ([[-3, -1, 1], [-1, 1, 2]], [[4, 1, 1], [6, 3, 2]])):
            for corner, place in zip(got, wanted):
                for value, right in zip(corner, place):
                    self.assertAlmostEqual(value, right, 4)
        self.assertEqual(len(self.facts['boxes']), 2)

    def test_overlay_has_a_floor_and_twelve_edges_for_each_cell(self):
        for color_by in ('POLYGONS', 'BOUND'):
            shown = self.facts[color_by]
            self.assertEqual([len(shown[name]) for name in ('floor_positions', 'floor_colors')], [12, 12])
            self.assertEqual([len(shown[name]) for name in ('edge_positions', 'edge_colors')], [48, 48])
            self.assertLess(0, shown['lowest'])
        first = self.facts['POLYGONS']['floor_positions'][:6]
        self.assertEqual({round(z, 1) for _, _, z in first}, {1.0})
        self.assertEqual(({round(x, 1) for x, _, _ in first}, {round(y, 1) for _, y, _ in first}), ({-3, -1}, {-1, 1}))
        for wanted, end in ((min, 'lowest'), (max, 'highest')):
            self.assertEqual(wanted(self.facts['polygons']), self.facts['POLYGONS'][end])
        more = self.facts['polygons'].index(max(self.facts['polygons']))
        red, _, blue, _ = self.facts['POLYGONS']['floor_colors'][6 * more]
        self.assertGreater(red, blue)

    def test_freeze_hides_what_the_cell_does_not_see_and_nothing_else(self):
        before, selected = self.facts['before']
        self.assertNotIn('put away', before)
        for moment in ('frozen', 'frozen on the floor'):
            self.assertEqual(set(before) - set(self.facts[moment][0]), NOT_SEEN_FROM_THE_FIRST_ROOM, moment)
        self.assertEqual(self.facts['after'], [before, selected])
        hidden = set(before) - set(self.facts['frozen by the camera'][0])
        self.assertLessEqual({'heap', 'chest', 'treasure', 'navigation'}, hidden)
        self.assertFalse({'corner', 'pile', 'straight', 'door', 'cart', 'floor'} & hidden)
        self.assertIn('in no cell', self.facts['outside'])

    def test_unseen_objects_are_those_of_the_report(self):
        self.assertEqual(self.facts['unseen'], ['treasure'])
        out, _ = self.expect(0, 'strip', self.file('first.glb'), self.file('first.pvs'), '--json')
        whole = [each['node_name'] for each in json.loads(out)['objects'] if each['unseen'] == each['polygons'] > 0]
        self.assertEqual(whole, ['treasure'])

    def test_failures_are_errors_and_leave_no_file(self):
        self.assertIn('save the .blend file first', self.facts['unsaved'])
        self.assertIn('is not the program "sightcell"', self.facts['no program'])
        self.assertIn('bake first', self.facts['freeze before a bake'])
        error, messages = self.facts['flat cell']
        self.assertRegex(error, r' on z;.*\[cells\.empty-box\]$')
        self.assertEqual([(kind, name) for kind, _, name in messages if kind == 'ERROR'], [('ERROR', 'flat')])
        self.assertFalse(self.facts['after disabling'])

    def test_quick_bakes_again_are_those_of_the_command_line(self):
        (first, _, _), *later = self.facts['quick']
        self.assertIsNone(first)
        for (error, summary, _), wanted in zip(later, ('0 of 2 cells', '2 of 2 cells', None)):
            self.assertIsNone(error)
            self.assertEqual('baked again' in summary, wanted is not None, summary)  # other settings: a whole bake
            self.assertIn(wanted or '', summary)
        self.assertEqual(self.facts['quick'][1][2], self.facts['quick'][0][2])
        again = self.path('last.pvs')
        self.expect(0, 'bake', self.file('level.glb'), '-o', again, '--samples', 8, '--resolution', 64)
        self.assertEqual(read(again).hex(), self.facts['quick'][3][2])

    def test_a_canceled_bake_leaves_its_checkpoint_alone(self):
        self.assertEqual(self.facts['canceled'], [None, 'Canceled. The next bake of this scene continues from there'])
        self.assertEqual(self.facts['files after failures'], ['level.blend', 'level.pvs.bake'])
