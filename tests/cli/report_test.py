"""Reports: a page about a bake of the small town of the web tests, whose numbers are those of `info` and `verify`."""
import html.parser
import json
import os
import shutil

from harness import QUICK_BAKE, ROOT, InRoom, read

TOWN = os.path.join(ROOT, 'tests', 'platforms', 'web', 'npm', 'scene')
# Elements without an end.
VOID = {'meta', 'link', 'img'}


class Page(html.parser.HTMLParser):
    """What tools read of a report, and whether its elements are nested well."""

    def __init__(self, path):
        super().__init__()
        self.values, self.cells, self.pictures, self.addresses, self.texts, self.open = {}, [], 0, [], [], []
        with open(path, encoding='utf-8') as file:
            self.feed(file.read())
        assert not self.open, self.open

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        if tag not in VOID:
            self.open.append(tag)
        if 'data-key' in found:
            self.values.setdefault(found['data-key'], json.loads(found['data-value']))
        if 'data-cell' in found:
            self.cells.append(int(found['data-cell']))
        self.pictures += tag == 'img'
        self.addresses += [found[key] for key in ('src', 'href') if key in found]
        assert not any(key.startswith('on') for key in found), found
        assert tag != 'script'

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag, tag

    def handle_data(self, data):
        self.texts.append(data)


class Report(InRoom):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene, cls.file = cls.path('town.glb'), cls.path('town.pvs')
        shutil.copy(os.path.join(TOWN, 'town.glb'), cls.scene)
        shutil.copy(os.path.join(TOWN, 'floor.pvs'), cls.file)

    def report(self, code, *more, scene=None, file=None, output='report.html'):
        return self.expect(code, 'report', file or self.file, '--scene', scene or self.scene, '-o', self.path(output),
                           *more)

    def test_numbers_are_those_of_info_and_verify(self):
        rays = ['--rays', '50000']
        self.report(0, *rays)
        page = Page(self.path('report.html'))
        info = json.loads(self.expect(0, 'info', self.file, '--json')[0])
        verify_out = self.expect(0, 'verify', self.scene, self.file, *rays, '--json')[0]
        verify = json.loads(verify_out)
        for whose, found in (('info', info), ('verify', verify)):
            keys = [key for key in page.values if key.startswith(whose + '.')]
            self.assertGreaterEqual(len(keys), 3)
            for key in keys:
                self.assertEqual(page.values[key], found[key.split('.')[1]], key)
        for key in ('info.cells', 'info.polygons', 'info.bytes', 'info.max_pixel_error', 'verify.rays', 'verify.misses',
                    'verify.upper_bound', 'info.visible_set_percent', 'info.bits_per_visible_polygon'):
            self.assertIn(key, page.values)
        largest = sorted(info['certificate'], key=lambda c: -c['upper_bound'])[:10]
        bounds = {c['cell']: c['upper_bound'] for c in info['certificate']}
        self.assertEqual([bounds[c] for c in page.cells], [c['upper_bound'] for c in largest])
        # One file: only pictures inside it and shapes of its own.
        self.assertTrue(all(a.startswith(('data:', '#ground-')) for a in page.addresses), 'no other file')
        self.assertIn(page.pictures, (0, 30))  # 0 without OpenGL
        self.assertLess(os.path.getsize(self.path('report.html')), 2_000_000)

        # The same bytes again, and the same from the result of verify.
        before = read(self.path('report.html'))
        self.report(0, *rays)
        self.assertEqual(read(self.path('report.html')), before)
        with open(self.path('verify.json'), 'w', encoding='utf-8') as out:
            out.write(verify_out)
        self.report(0, '--verify', self.path('verify.json'), output='other.html')
        self.assertEqual(Page(self.path('other.html')).values, page.values)

    def test_misses_are_the_first_views(self):
        """Of a set without the polygons that it should have: the result of verify names one, a picture shows it."""
        self.bake_room()
        miss = {'cell': 0, 'polygon': 0, 'rays': 9, 'eye': [4, 1.5, 4], 'target': [4.5, 0, 4.25], 'node_name': '<script>'}
        result = {'rays': 100, 'misses': 9, 'upper_bound': 0.2, 'confidence': 0.95, 'max_pixel_error': 1e-2, 'cells': 1,
                  'missing': [miss]}
        with open(self.path('v.json'), 'w', encoding='utf-8') as out:
            json.dump(result, out)
        _, err = self.report(0, '--verify', self.path('v.json'), scene=self.room, file=self.path('room.pvs'))
        self.assertIn('next: Verification did not confirm the bound', err)
        page = Page(self.path('report.html'))
        text = ''.join(page.texts)
        self.assertIn('Verification failed', text)
        if page.pictures:
            self.assertIn('node \u201c<script>\u201d', text)
            self.assertRegex(text, r'sightcell view \S+room\.glb \S+room\.pvs --eye=4\.000,1\.500,4\.000 --look=\d+\.\d\d,-\d+')

    def bake_room(self, *more):
        return self.expect(0, 'bake', self.room, '-o', self.path('room.pvs'), '--cells-file', self.cells, *QUICK_BAKE, *more)

    def test_a_bake_adds_what_the_file_has_not(self):
        out, err = self.bake_room('--report', self.path('baked.html'), '--json')
        self.assertIn('baked.html: a report of', err)
        page, summary = Page(self.path('baked.html')), json.loads(out)
        self.assertEqual(page.values['bake.cpu_seconds'], summary['cpu_seconds'])
        self.assertEqual(page.values['bake.cells_left_out'], 0)
        text = ''.join(page.texts)
        self.assertIn(summary['device'], text)
        for phase in summary['phases']:
            self.assertIn(phase['phase'].replace('_', ' '), text)
        self.assertIn('Bake seconds per cell', text)
        self.assertAlmostEqual(sum(summary['found_by'].values()), 1)
        self.assertGreater(summary['found_by']['sampler'], 0.5)
        growth = summary['growth']
        self.assertEqual([p['hemicubes'] for p in growth[:-1]], [2 ** i for i in range(len(growth) - 1)])
        self.assertEqual([p['share'] for p in growth], sorted(p['share'] for p in growth))
        self.assertGreater(growth[0]['share'], 0)
        self.assertEqual([p['cells'] for p in growth], sorted((p['cells'] for p in growth), reverse=True))
        of_hemicubes = summary['found_by']['sampler'] + summary['found_by']['later_hemicubes']
        self.assertAlmostEqual(growth[-1]['share'], of_hemicubes)
        self.assertIn('How the sets grew', text)
        self.assertIn('the first hemicube of each cell found ', text)
        self.assertIn('hemicubes of the sampler', text)
        # The same from the JSON of the bake, but for the seconds of each cell.
        with open(self.path('bake.json'), 'w', encoding='utf-8') as file:
            file.write(out)
        self.report(0, '--bake', self.path('bake.json'), scene=self.room, file=self.path('room.pvs'))
        later = Page(self.path('report.html'))
        self.assertEqual(later.values, page.values)
        self.assertNotIn('Bake seconds per cell', ''.join(later.texts))

    def test_wrong_input_is_one_line(self):
        _, err = self.report(4, scene=self.room)
        self.assert_one_error_line(err, 'pvs.other-scene')
        with open(self.path('empty.pvs'), 'w', encoding='utf-8'):
            pass
        self.assert_one_error_line(self.report(4, file=self.path('empty.pvs'))[1], 'pvs.refused')
        for text, identifier in (('{', 'report.not-json'), ('[]', 'report.not-json'), ('{}', 'report.other-file')):
            with open(self.path('bad.json'), 'w', encoding='utf-8') as out:
                out.write(text)
            for option in ('--verify', '--bake'):
                line = self.assert_one_error_line(self.report(4, option, self.path('bad.json'))[1], identifier)
                self.assertIn('bad.json', line)
        for option in ('--verify', '--bake'):
            self.assert_one_error_line(self.report(4, option, self.path('no.json'))[1], 'cli.unreadable')
        good = {'rays': 1, 'misses': 0, 'upper_bound': 1, 'confidence': 0.95, 'max_pixel_error': 1, 'cells': 1}
        for missing in (3, [3], [{'cell': 440, 'polygon': 0, 'rays': 1, 'eye': [0, 0, 0], 'target': [1, 0, 0], 'node_name': ''}],
                        [{'cell': 0, 'polygon': 0, 'rays': 1, 'eye': [0, 0], 'target': [1, 0, 0], 'node_name': ''}]):
            with open(self.path('bad.json'), 'w', encoding='utf-8') as out:
                json.dump({**good, 'missing': missing}, out)
            self.assert_one_error_line(self.report(4, '--verify', self.path('bad.json'))[1], 'report.other-file')
        self.assert_one_error_line(self.report(1, '--rays', '0', output='no/folder.html')[1], 'cli.not-writable')
        for output in ('town.glb', 'town.pvs'):
            self.assert_one_error_line(self.report(2, output=output)[1], 'cli.output-is-input')
        for output in (self.path('c.pvs'), self.room):
            _, err = self.expect(2, 'bake', self.room, '-o', self.path('c.pvs'), '--report', output)
            self.assert_one_error_line(err, 'cli.output-is-input')
        _, err = self.expect(1, 'bake', self.room, '-o', self.path('c.pvs'), '--report', self.path('no/x.html'))
        self.assertIn('--report', self.assert_one_error_line(err, 'cli.not-writable'))
        self.assertFalse(os.path.exists(self.path('c.pvs')))
