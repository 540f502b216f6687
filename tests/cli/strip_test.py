"""Unseen polygons: what a bake reports, what `sightcell strip` reports and removes."""
import json
import os

from harness import QUICK_BAKE, InRoom, write_room


class Strip(InRoom):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # The room again, 100 m away behind its walls.
        cls.scene = cls.path('two.glb')
        write_room(cls.scene, scenes=((0, 1),), nodes=[
            {'mesh': 0, 'name': 'room'}, {'mesh': 0, 'name': 'far', 'translation': [100, 0, 0]}])

    def bake(self, name, *more):
        return self.expect(0, 'bake', self.scene, '-o', self.path(name), '--cells-file', self.cells, *QUICK_BAKE[:4],
                           *(more if '--max-pixel-error' in more else (*QUICK_BAKE[4:], *more)))

    def report(self, name):
        with open(self.path(name), encoding='utf-8') as file:
            return json.load(file)

    def test_bake_and_strip_report_the_same(self):
        _, err = self.bake('a.pvs', '--report-unseen', self.path('a.json'))
        self.assertIn(f'12 of 24 polygons (50.0 %) are visible from no cell: {self.path("a.json")}', err)
        found = self.report('a.json')
        self.assertEqual([(o['node'], o['node_name'], o['polygons'], o['unseen'], o['share']) for o in found['objects']],
                         [(1, 'far', 12, 12, 1.0), (0, 'room', 12, 0, 0.0)])
        self.assertEqual(found['unseen_polygons'], [[12, 23]])
        self.assertEqual(found['share'], 0.5)
        self.assertLessEqual(found['bound']['largest_upper_bound'], 1e-2)
        out, _ = self.expect(0, 'strip', self.scene, self.path('a.pvs'), '--report', self.path('b.json'))
        self.assertEqual(self.report('b.json'), found)
        self.assertIn(found['bound']['text'], out)
        self.assertIn('12 of         12   node 1 "far"', out)
        self.assertNotIn('"room"', out)

    def test_bounds_are_there_only_where_the_bake_has_them(self):
        self.bake('none.pvs', '--max-pixel-error', '0')
        out, _ = self.expect(0, 'strip', self.scene, self.path('none.pvs'), '--json')
        bound = json.loads(out)['bound']
        self.assertEqual((bound['cells'], bound['cells_without'], bound['largest_upper_bound']), (0, 1, None))
        self.assertIn('No cell has a bound', bound['text'])
        self.bake('color.pvs', '--metric', 'color')
        out, _ = self.expect(0, 'strip', self.scene, self.path('color.pvs'))
        self.assertIn('differences of colors', out)

    def test_strip_keeps_what_another_node_shows(self):
        self.bake('a.pvs')
        output = self.path('same.glb')
        out, _ = self.expect(0, 'strip', self.scene, self.path('a.pvs'), '-o', output, '--json')
        result = json.loads(out)
        self.assertEqual((result['polygons'], result['unseen'], result['polygons_after']), (24, 12, 24))
        self.assertEqual(result['bytes'], os.path.getsize(output))
        self.assertEqual(result['bytes_before'], os.path.getsize(self.scene))
        out, _ = self.expect(0, 'strip', self.scene, self.path('a.pvs'), '-o', output)
        self.assertIn('24 polygons instead of 24', out)
        self.assertIn('12 unseen polygons stay', out)

    def test_outputs_are_no_inputs(self):
        self.bake('a.pvs')
        file = self.path('a.pvs')
        for option, path in (('-o', self.scene), ('-o', file), ('--report', self.scene), ('--report', file)):
            _, err = self.expect(2, 'strip', self.scene, file, option, path)
            self.assert_one_error_line(err, 'cli.output-is-input')
        both = self.path('both')
        _, err = self.expect(2, 'strip', self.scene, file, '-o', both, '--report', both)
        self.assert_one_error_line(err, 'cli.output-is-input')
        for option, path in (('--report-unseen', self.path('c.pvs')), ('--report-unseen', self.scene)):
            _, err = self.expect(2, 'bake', self.scene, '-o', self.path('c.pvs'), option, path)
            self.assert_one_error_line(err, 'cli.output-is-input')

    def test_a_shard_has_no_report(self):
        _, err = self.expect(2, 'bake', self.scene, '-o', self.path('c.pvs'), '--shard', '0/2', '--report-unseen', 'x')
        self.assert_one_error_line(err, 'cli.wrong-use')

    def test_reports_that_cannot_be_written_are_refused_before_the_bake(self):
        _, err = self.expect(1, 'bake', self.scene, '-o', self.path('c.pvs'), '--report-unseen', self.path('no/x.json'))
        self.assertIn('--report-unseen', self.assert_one_error_line(err, 'cli.not-writable'))
        self.assertFalse(os.path.exists(self.path('c.pvs')))

    def test_another_scene_is_refused(self):
        self.bake('a.pvs')
        _, err = self.expect(4, 'strip', self.room, self.path('a.pvs'))
        self.assert_one_error_line(err, 'pvs.other-scene')
