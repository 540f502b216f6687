"""The OpenGL source on a second driver: zink, which turns OpenGL into Vulkan, over Mesa's Vulkan driver for the CPU
(lavapipe). The programs are those of other entries. Each test that has a context reports its GL_RENDERER in the results
of GoogleTest, so a run on another driver fails."""
import json
import unittest

from harness import InRoom, QUICK_BAKE, program, program_or_skip, run, vulkan_on_cpu


def environment(folder):
    """What makes EGL choose zink over lavapipe."""
    return {'LIBGL_ALWAYS_SOFTWARE': 1, 'MESA_LOADER_DRIVER_OVERRIDE': 'zink', 'GALLIUM_DRIVER': 'zink',
            **vulkan_on_cpu(), 'XDG_RUNTIME_DIR': folder, 'SIGHTCELL_TEST_STEP': 7}


class Zink(InRoom):
    def run_on_zink(self, name, tests):
        """Runs the tests, a filter of GoogleTest; returns how many of them ran."""
        results = self.path('results.json')
        code, out, err = run(program_or_skip(name), f'--gtest_filter={tests}', f'--gtest_output=json:{results}',
                             environment=environment(self.folder))
        self.assertEqual(code, 0, out + err)
        with open(results, encoding='utf-8') as file:
            suites = json.load(file)['testsuites']
        ran = 0
        for test in [test for suite in suites for test in suite['testsuite']]:
            which = f'{name}: {test["classname"]}.{test["name"]}'
            self.assertNotEqual(test['result'], 'SKIPPED', which + ' was skipped\n' + out + err)
            self.assertIn('zink', test.get('renderer', 'no renderer'), which)
            ran += 1
        return ran

    def test_contexts_and_pictures(self):
        self.assertGreaterEqual(self.run_on_zink('picture_test', 'gl_context_test.*:picture_test.*'), 25)

    def test_the_source_sees_what_the_others_see(self):
        ran = self.run_on_zink('sightcell_test_bake', '*source*/read_back:*source*/compute:*gather_test.*')
        self.assertGreaterEqual(ran, 70)

    def test_culling(self):
        self.assertGreaterEqual(self.run_on_zink('sightcell_test_bake', 'gpu_culling_test.*'), 6)

    def test_several_hemicubes_in_flight(self):
        self.assertGreaterEqual(self.run_on_zink('sightcell_test_bake', 'gpu_flight_test.*'), 5)

    def test_pixels_agree_with_rays(self):
        ran = self.run_on_zink('agreement_test', '*/agreement_test.*/read_back:*/agreement_test.*/compute')
        self.assertEqual(ran, 6)

    def test_a_bake_names_the_driver(self):
        code, out, err = run(program('sightcell'), 'bake', self.room, '-o', self.path('room.pvs'), '--cells-file',
                             self.cells, '--json', '--source', 'gpu', *QUICK_BAKE, environment=environment(self.folder))
        self.assertEqual(code, 0, err)
        self.assertIn('zink', json.loads(out)['device'])
