"""Verification of files that lack a polygon, and of real scenes."""
import json
import os

from harness import InRoom, program_or_skip, run, sightcell


class Missing(InRoom):
    """Files of the city that lack one polygon in one cell: verify has to notice."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.city = cls.make_city('city.glb', polygons=10000)
        cls.drop = program_or_skip('sightcell-test-drop-polygon')
        cls.shares = program_or_skip('sightcell-test-polygon-shares')

    def bake_and_share(self):
        """The file, a cell in its middle, and what its rays see: (polygon, share), largest first."""
        file = self.path('city.pvs')
        self.expect(0, 'bake', self.city, '-o', file, '--cell-limit', '4', '--max-pixel-error', '5e-4',
                    '--progress', 'none', '--fresh')
        cell = json.loads(self.expect(0, 'info', file, '--json')[0])['cells'] // 2
        code, out, err = run(self.shares, self.city, file, cell, 200000)
        self.assertEqual(code, 0, err)
        shares = [(int(line.split()[0]), float(line.split()[1])) for line in out.splitlines()]
        return file, cell, shares

    def verify_without(self, code, file, cell, polygon, *more):
        broken = self.path('broken.pvs')
        self.assertEqual(run(self.drop, file, broken, cell, polygon)[0], 0)
        out, err = self.expect(code, 'verify', self.city, broken, '--max-pixel-error', '1e-3', '--json', *more)
        return json.loads(out), err

    def test_what_is_missing_is_found_and_named(self):
        file, cell, shares = self.bake_and_share()
        polygon, share = shares[0]
        result, err = self.verify_without(3, file, cell, polygon, '--rays', '200000')
        self.assertEqual((result['worst_view']['cell'], result['worst_view']['polygon']), (cell, polygon))
        self.assertEqual(result['worst_cell'], cell)
        self.assertAlmostEqual(result['missing'][0]['share'] / share, 1.0, delta=0.2)
        self.assertIn(f'polygon {polygon} (draw', err)
        self.assertEqual(len(result['worst_view']['pictures']), 3)

        # One in ten thousand rays of its cell: half a million find it.
        polygon, share = min(shares, key=lambda entry: abs(entry[1] - 1e-4))
        self.assertLess(abs(share - 1e-4), 5e-5)
        self.verify_without(0, file, cell, polygon, '--rays', '10000')
        result, _ = self.verify_without(0, file, cell, polygon, '--rays', '500000')
        self.assertIn((cell, polygon), [(miss['cell'], miss['polygon']) for miss in result['missing']])



class Data(InRoom):
    """Real scenes, found by SIGHTCELL_DATA: a few cells of each meet the bound, by the bake's word and by verify's."""

    def test_cells_of_real_scenes_meet_the_bound(self):
        data = os.environ.get('SIGHTCELL_DATA', '')
        scenes = [os.path.join(data, name) for name in ('levels/czest3ctf.glb', 'city/denhaag_01.glb')]
        if not data or not all(os.path.exists(scene) for scene in scenes):
            self.skipTest('SIGHTCELL_DATA does not name a folder with the real scenes')
        for scene in scenes:
            with self.subTest(scene=os.path.basename(scene)):
                file = self.path('real.pvs')
                out, _ = self.expect(0, 'bake', scene, '-o', file, '--cell-limit', '2', '--fresh', '--json',
                                     '--progress', 'none')
                baked = json.loads(out)
                self.assertLessEqual(baked['max_upper_bound'], 1e-4)
                self.assertLess(baked['visible_set_percent'], 30.0)
                out, _ = self.expect(0, 'verify', scene, file, '--rays', '200000', '--json', '--picture', self.folder)
                self.assertLessEqual(json.loads(out)['upper_bound'], 1e-4)
