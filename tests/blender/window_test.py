"""The Blender add-on in a window: bakes in the background, cancel, errors, the cells in the viewport, and the end of
Blender during a bake.

All of it is one start of Blender under Xvfb, whose script (in_window.py) writes down what happened.
"""
import json
import os
import time

import harness
from addon_test import environment_of
from harness import SETTINGS, program, run

RESULT = ['level.glb', 'level.pvs']


def runs(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


class Window(harness.InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.level, home, screen = (cls.path(name) for name in ('level', 'home', 'screen'))
        os.mkdir(cls.level)
        os.mkdir(screen)
        display = harness.start_screen(cls.addClassCleanup, screen)
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'in_window.py')
        code, out, err = run(SETTINGS['blender'], '--factory-startup', '--window-geometry', 0, 0, 1024, 768,
                             '--python-exit-code', 1, '--python', script, '--', SETTINGS['zip'],
                             program('sightcell'), cls.level, screen, display=display,
                             environment={**environment_of(home), 'LIBGL_ALWAYS_SOFTWARE': 1})
        if code != 0 or not os.path.exists(os.path.join(cls.level, 'facts.json')):
            raise RuntimeError(f'Blender: {code}\n{out}\n{err}')
        cls.printed = out + err
        with open(os.path.join(cls.level, 'facts.json'), encoding='utf-8') as file:
            cls.facts = json.load(file)

    def test_a_bake_goes_on_in_the_background(self):
        self.assertEqual(self.facts['started'], ['RUNNING_MODAL'])
        self.assertFalse(self.facts['second bake'])
        self.assertRegex(self.facts['summary'], '^4 cells, ')
        self.assertEqual(self.facts['files'], ['level.blend', *RESULT])

    def test_a_cancel_ends_the_program_and_keeps_its_checkpoint(self):
        self.assertEqual(self.facts['canceled'], 'Canceled. The next bake of this scene continues from there')
        self.assertEqual(self.facts['files after the cancel'], ['level.blend', 'level.pvs.bake'])
        self.assertFalse(runs(self.facts['process of the canceled bake']))

    def test_cells_are_drawn(self):
        self.assertGreater(self.facts['share of cells'], 0.01)

    def test_a_failure_is_a_message_and_leaves_the_result(self):
        self.assertEqual(self.facts['start of the failing bake'], ['RUNNING_MODAL'])
        (kind, text, name), = self.facts['messages']
        self.assertEqual((kind, name), ('ERROR', 'flat'))
        self.assertRegex(text, r'\[cells\.empty-box\]$')
        self.assertLessEqual(set(RESULT), set(self.facts['files after the failure']))
        self.assertNotIn('level.export.glb', self.facts['files after the failure'])

    def test_panels_are_drawn_without_errors(self):
        self.assertNotIn('Traceback', self.printed)

    def test_a_bake_ends_with_blender(self):
        until = time.monotonic() + 20
        while runs(self.facts['process at the end']) and time.monotonic() < until:
            time.sleep(0.1)
        self.assertFalse(runs(self.facts['process at the end']))
        self.assertNotIn('level.export.glb', os.listdir(self.level))
