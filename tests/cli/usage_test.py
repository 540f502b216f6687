"""The command line of `sightcell`: help, messages about wrong use, `info` of scenes, `view`."""
import json
import os
import re
import shutil
import stat

from harness import InRoom, program, run, write_triangles

VERBS = ('bake', 'verify', 'report', 'view', 'info', 'diff', 'patch', 'recode', 'migrate', 'pack', 'strip', 'merge', 'cells', 'samplers')


class Usage(InRoom):
    def test_help_lists_every_verb(self):
        out, err = self.expect(0, '--help')
        for verb in VERBS:
            self.assertRegex(out, rf'(?m)^  {verb} ')
            self.assertTrue(self.expect(0, verb, '--help')[0].startswith(f'Usage: sightcell {verb} '))
        self.assertEqual(err, '')

    def test_help_all_of_the_program_has_all_of_every_verb(self):
        out, _ = self.expect(0, '--help-all')
        for verb in VERBS:
            self.assertIn(self.expect(0, verb, '--help-all')[0].strip(), out)

    def test_lines_of_help_fit(self):
        for line in self.expect(0, '--help-all')[0].splitlines():
            self.assertLessEqual(len(line), 100, line)

    def test_help_of_bake_has_what_most_users_need_and_two_examples(self):
        out, _ = self.expect(0, 'bake', '--help')
        self.assertEqual(re.findall(r'(?m)^  (-o|--[a-z-]+)', out), [
            '-o', '--volumes', '--sun', '--lights', '--importance', '--report', '--cells-file', '--cells-grid', '--reach', '--start',
            '--fly', '--cell-size', '--cell-limit', '--quality', '--max-pixel-error', '--player-radius', '--animated',
            '--time-budget', '--threads', '--shard', '--fresh', '--keep-records', '--since', '--keep-found', '--keep-order',
            '--watch', '--help-all'])
        self.assertEqual(re.findall(r'(?m)^(\w.*):$', out),
                         ['Output', 'Cells', 'Quality', 'Scene rules', 'Time and machines', 'Edits', 'Help',
                          'Examples'])
        self.assertEqual(len(re.findall(r'(?m)^  sightcell bake ', out)), 2)
        self.assertNotIn('Expert', out)

    def test_help_all_of_bake_has_every_option(self):
        out, _ = self.expect(0, 'bake', '--help-all')
        everyday = self.expect(0, 'bake', '--help')[0]
        for option in re.findall(r'(?m)^  (-o|--[a-z-]+)', everyday):
            self.assertIn(f'\n  {option}', out)
        for option in ('--profile', '--layout', '--names', '--report-unseen', '--embed', '--most-cells', '--merge-cells',
                       '--path', '--margin', '--safety-ring', '--smallest-gap', '--all-double-sided', '--closed', '--memory',
                       '--order', '--progress', '--json', '--json-file', '--polygons-from', '--cells-from', '--scene',
                       '--misses', '--metric', '--view-resolution', '--view-fov', '--view-pitch', '--view-least',
                       '--sampler', '--samples', '--sampling-rays', '--source', '--resolution', '--seed', '--phase',
                       '--scratch', '--player-height', '--player-step', '--player-jump', '--player-gap', '--player-slope',
                       '--eye-heights', '--path-camera', '--path-radius', '--near'):
            self.assertIn(f'\n  {option}', out)
            self.assertNotIn(f'\n  {option} ', everyday)

    def test_ranges_in_help_are_those_that_are_checked(self):
        """Both ends of the range of every option of bake are accepted, so that the missing scene is the failure; numbers
        beyond are rejected."""
        text = ' '.join(self.expect(0, 'bake', '--help-all')[0].split())
        found = re.findall(r' (--[a-z-]+) \S+ (?:(?! --[a-z-]+ [A-Z]).)*?Range: (\S+) to ([0-9.e-]*[0-9])', text)
        self.assertGreater(len(found), 20)
        for option, low, high in found:
            if option in ('--view-resolution', '--view-pitch', '--eye-heights'):  # two numbers
                continue
            more = ['--metric', 'view'] if option.startswith('--view') else []
            bake = ['bake', self.path('missing.glb'), '-o', self.path('no.pvs'), *more]
            for value in (low, high):
                self.expect(4, *bake, option, value)
            above = str(2 * float(high) + 2) if '.' in high or 'e' in high else str(2 * int(high) + 2)
            _, err = self.expect(2, *bake, option, above)
            self.assertIn(option, err)

    def test_version(self):
        self.assertRegex(self.expect(0, '--version')[0], r'^\d+\.\d+\.\d+\n$')

    def test_wrong_use_is_2(self):
        scene, file = self.room, self.path('no.pvs')
        for arguments in ([], ['fly'], ['bake'], ['bake', scene], ['verify', scene], ['info'],
                          ['info', scene, '--nonsense'],
                          ['bake', scene, '-o', file, '--samples', 'many'],
                          ['bake', scene, '-o', file, '--samples', '-8'],
                          ['bake', scene, '-o', file, '--cells-grid', '1,2,3'],
                          ['bake', scene, '-o', file, '--animated', 'sometimes'],
                          ['bake', scene, '-o', file, '--metric', 'taste'],
                          ['bake', scene, '-o', file, '--metric', 'view', '--view-resolution', '1920'],
                          ['bake', scene, '-o', file, '--metric', 'view', '--view-pitch', '0'],
                          ['verify', scene, file, '--metric', 'taste'],
                          ['bake', scene, '-o', file, '--safety-ring', 'face'],
                          ['bake', scene, '-o', file, '--profile', 'tiny'],
                          ['bake', scene, '-o', file, '--order', 'free'],
                          ['recode', file, '--profile', 'tiny'],
                          ['bake', scene, '-o', file, '--layout', 'shuffled'],
                          ['bake', scene, '-o', file, '--progress', 'loud']):
            out, err = self.expect(2, *arguments)
            self.assertEqual(out, '', arguments)
            self.assert_one_error_line(err, 'cli.wrong-use')

    def test_options_of_later_versions_are_unknown(self):
        for option in ('--summary=x', '--watched=x'):
            _, err = self.expect(2, 'bake', self.room, '-o', self.path('no.pvs'), option)
            self.assert_one_error_line(err, 'cli.wrong-use')

    def test_wrong_words_name_the_nearest_right_one(self):
        scene, file = self.room, self.path('no.pvs')
        bake = ['bake', scene, '-o', file]
        for arguments, expected in (
                ([*bake, '--cells-limit', '4'],
                 '--cells-limit: unknown option; did you mean --cell-limit? see sightcell bake --help'),
                ([*bake, '--cells-limit=4'], '--cells-limit: unknown option; did you mean --cell-limit?'),
                (['bake', scene, '--max-pixel', '1e-3'], '--max-pixel: unknown option; did you mean --max-pixel-error?'),
                ([*bake, '--treads', '2'], 'did you mean --threads?'),
                (['verify', scene, file, '--ray', '5'], '--ray: unknown option; did you mean --rays?'),
                (['--versoin'], '--versoin: unknown option; did you mean --version? see sightcell --help'),
                (['verfy', scene], 'verfy: unknown verb; did you mean verify? see sightcell --help'),
                ([*bake, '--quality', 'finale'],
                 '--quality: is "finale"; give one of draft, normal, final; did you mean final?'),
                ([*bake, '--profile', 'smal'], 'did you mean small?'),
                ([*bake, '--layout', 'merge'], 'did you mean merged?'),
                (['recode', file, '--order', 'per-mseh'], 'did you mean per-mesh?'),
                ([*bake, '--sampler', 'guded'], 'did you mean guided?'),
                ([*bake, '--source', 'gpus'], 'did you mean gpu?')):
            _, err = self.expect(2, *arguments)
            self.assertEqual(len(err.splitlines()), 1, err)
            self.assertIn(expected, err)

    def test_words_that_are_like_none_name_none(self):
        for arguments in (['fly'], ['bake', self.room, '-o', self.path('no.pvs'), '--zoom', 'x'],
                          ['bake', self.room, '-o', self.path('no.pvs'), '--profile', 'gigantic']):
            _, err = self.expect(2, *arguments)
            self.assertNotIn('did you mean', err)

    def test_values_out_of_range_are_2_and_name_the_option(self):
        for option, value in (('--cell-size', '0.1'), ('--merge-cells', '11'), ('--most-cells', '63'), ('--margin', '11'), ('--player-radius', '0'),
                              ('--sampler', 'guesswork'), ('--source', 'opengl'), ('--samples', '5'), ('--resolution', '255'),
                              ('--max-pixel-error', '0.9'), ('--time-budget', '-1'),
                              ('--volumes', '0.2'), ('--volumes', '1001'),
                              ('--cells-grid', '0,0,0,1,0,1'), ('--cells-grid', '0,0,0,1,nan,1')):
            _, err = self.expect(2, 'bake', self.room, '-o', self.path('no.pvs'), option, value)
            self.assertIn(option, self.assert_one_error_line(err, 'settings.out-of-range'))
        for option, value in (('--eye-heights', '2,1'), ('--eye-heights', '-1,2'), ('--start', '1,2'), ('--start', 'a,b,c'),
                              ('--start', 'inf,0,0'), ('--fly', '1,2,3'), ('--fly', '0,0,0,1,0,1'),
                              ('--fly', '0,0,0,1,nan,1'), ('--reach', 'none'), ('--path-radius', '101')):
            _, err = self.expect(2, 'bake', self.room, '-o', self.path('no.pvs'), option, value)
            self.assertIn(option, self.assert_one_error_line(err, 'settings.out-of-range'))
        _, err = self.expect(2, 'verify', self.room, self.path('no.pvs'), '--rays', '0')
        self.assertIn('--rays', err)
        for option, value in (('--view-resolution', '8x1080'), ('--view-fov', '171'), ('--view-pitch', '-91,0'),
                              ('--view-pitch', '10,-10'), ('--view-least', '-1')):
            for verb in (['bake', self.room, '-o', self.path('no.pvs')], ['verify', self.room, self.path('no.pvs')]):
                _, err = self.expect(2, *verb, '--metric', 'view', option, value)
                self.assertIn(option, self.assert_one_error_line(err, 'settings.out-of-range'))

    def test_options_of_a_view_are_refused_without_one(self):
        for verb in (['bake', self.room, '-o', self.path('no.pvs')], ['verify', self.room, self.path('no.pvs')]):
            for metric in ([], ['--metric', 'pixel'], ['--metric', 'color']):
                _, err = self.expect(2, *verb, '--view-fov', '50', *metric)
                self.assertIn('--view-fov', self.assert_one_error_line(err, 'cli.wrong-use'))

    def test_misses_take_the_place_of_rays(self):
        out, _ = self.expect(0, 'verify', '--help')
        self.assertIn('--from', out)
        verify = ['verify', self.room, self.path('no.pvs'), '--from', self.path('misses.json')]
        for option, value in (('--cells', '1'), ('--seed', '1'), ('--max-pixel-error', '0.1'), ('--metric', 'color'),
                              ('--picture', 'x')):
            _, err = self.expect(2, *verify, option, value)
            self.assertIn(option, self.assert_one_error_line(err, 'cli.wrong-use'))
            _, err = self.expect(4, *verify, option, value, '--rays', '1')
            self.assert_one_error_line(err, 'cli.unreadable')

    def test_one_scene_or_two(self):
        both = ['--polygons-from', self.room, '--cells-from', self.room]
        output, file = ['-o', self.path('no.pvs')], self.path('no.pvs')
        for arguments in (['bake', *output, *both, self.room], ['bake', *output, *both[:2]], ['bake', *output, *both[2:]],
                          ['bake', *output, *both[:2], self.room], ['bake', *output, *both[2:], self.room],
                          ['bake', *output, *both, '--scene', '0'], ['bake', *output], ['verify', *both],
                          ['verify', self.room, file, *both], ['verify', file, *both[:2]], ['verify', self.room]):
            _, err = self.expect(2, *arguments)
            self.assert_one_error_line(err, 'cli.wrong-use')
        _, err = self.expect(4, 'verify', *both, file)
        self.assert_one_error_line(err, 'cli.unreadable')
        for arguments in (['--polygons-from', self.room, '--cells-from', self.path('none.glb')],
                          ['--polygons-from', self.path('none.glb'), '--cells-from', self.room]):
            _, err = self.expect(4, 'bake', *output, *arguments)
            self.assertIn('none.glb', self.assert_one_error_line(err, 'scene.not-found'))
        _, err = self.expect(2, 'bake', '-o', self.cells, '--polygons-from', self.room, '--cells-from', self.cells)
        self.assert_one_error_line(err, 'cli.output-is-input')
        _, err = self.expect(2, 'bake', *output, *both, '--volumes', '2')
        self.assertIn('--volumes', self.assert_one_error_line(err, 'settings.volumes'))

    def test_outputs_must_not_be_inputs(self):
        inputs = ([self.room], [self.room, '--misses', self.cells], [self.room, '--cells-file', self.cells],
                  ['--polygons-from', self.room, '--cells-from', self.cells])
        for arguments in inputs:
            for output in (['-o', arguments[-1]], ['-o', self.path('no.pvs'), '--json-file', arguments[-1]]):
                _, err = self.expect(2, 'bake', *arguments, *output)
                self.assertIn(arguments[-1], self.assert_one_error_line(err, 'cli.output-is-input'))

    def test_bad_input_is_4(self):
        missing = self.path('missing.glb')
        self.assertIn('missing.glb', self.expect(4, 'info', missing)[1])
        self.assertIn('missing.glb', self.expect(4, 'bake', missing, '-o', self.path('no.pvs'))[1])
        self.assertIn('missing.pvs', self.expect(4, 'verify', self.room, self.path('missing.pvs'))[1])
        self.expect(4, 'info', self.folder)
        for name, content in (('text.glb', b'hello'), ('empty.glb', b''), ('text.pvs', b'hello'), ('empty.pvs', b'')):
            with open(self.path(name), 'wb') as out:
                out.write(content)
            out, err = self.expect(4, 'info', '--json', self.path(name))
            self.assertEqual(out, '')
            self.assertEqual(len(err.splitlines()), 1, err)
            self.assertIn(name, err)

    def test_info_of_a_scene(self):
        out, err = self.expect(0, 'info', self.room, '--json')
        info = json.loads(out)
        self.assertEqual((info['polygons'], info['draws'], info['instances']), (12, 1, 1))
        self.assertEqual(info['bounds'], {'min': [0, 0, 0], 'max': [8, 4, 8]})
        self.assertRegex(info['fingerprint'], '^[0-9a-f]{32}$')
        self.assertEqual(err, '')
        self.assertIn('12 polygons', self.expect(0, 'info', self.room)[0])

    def test_info_counts_what_a_scene_is_made_of(self):
        """Primitives of one triangle each: two opaque ones in the same place, a MASK leaf and its back, a sheet of glass,
        one without area, and a MASK that is cut away."""
        a, b, c = 0, 1, 2
        scene = self.path('made.gltf')
        write_triangles(scene, [((a, b, c), 0), ((b, c, a), 0), ((3, b, c), 1), ((3, c, b), 1), ((a, 3, c), 2),
                                ((a, a, c), 0), ((a, b, 3), 3)],
                        materials=[{}, {'alphaMode': 'MASK'}, {'alphaMode': 'BLEND', 'doubleSided': True},
                                   {'alphaMode': 'MASK', 'pbrMetallicRoughness': {'baseColorFactor': [1, 1, 1, 0.2]}}],
                        extensionsUsed=['KHR_texture_transform', 'KHR_materials_unlit', 'ACME_moss'],
                        extensionsRequired=['KHR_texture_transform'])
        info = json.loads(self.expect(0, 'info', scene, '--json')[0])
        self.assertEqual([info[key] for key in ('polygons', 'draws', 'instances', 'meshes', 'geometries', 'materials',
                                                'images')], [7, 7, 1, 1, 7, 4, 0])
        self.assertEqual(info['kinds'], {'opaque': 2, 'mask': 2, 'alpha_tested': 0, 'blend': 1, 'double_sided': 3,
                                         'in_every_set': 0, 'never_hide_by_tag': 0})
        self.assertEqual(info['absent'], {'not_finite': 0, 'no_area': 1, 'cut_away': 1, 'tagged': 0,
                                          'coarser_level': 0})
        coincident = info['coincident']
        self.assertEqual([coincident[key] for key in ('duplicates', 'any_winding', 'opposite')], [4, 4, 2])
        self.assertAlmostEqual(coincident['duplicates_percent'], 400 / 7)
        self.assertEqual(info['extensions'], [
            {'name': 'ACME_moss', 'required': False, 'treated': 'ignored'},
            {'name': 'KHR_materials_unlit', 'required': False, 'treated': 'ignored'},
            {'name': 'KHR_texture_transform', 'required': True, 'treated': 'read'}])
        self.assertEqual(len(info['warnings']), 2)
        self.assertIn('1 polygons have no area', info['warnings'][1])
        out = self.expect(0, 'info', scene)[0]
        for text in ('2 opaque, 2 mask, 1 blend, 3 double sided', '1 no area, 1 cut away',
                     '4 (57.14 %) exact duplicates', '2 (28.57 %) of them back to back',
                     'KHR_texture_transform (required, read)', 'warning            the extension ACME_moss is ignored'):
            self.assertIn(text, out)


class View(InRoom):
    """`view` with a viewer that prints its arguments: beside a copy of the program, or in PATH."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        os.mkdir(cls.path('bin'))
        os.mkdir(cls.path('path'))
        cls.program = shutil.copy(program('sightcell'), cls.path('bin/sightcell'))

    def write_viewer(self, folder, name):
        path = self.path(os.path.join(folder, 'sightcell-viewer'))
        with open(path, 'w', encoding='utf-8') as out:
            out.write(f'#!/bin/sh\necho {name} "$#" "$@"\nexit 7\n')
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
        self.addCleanup(os.remove, path)

    def view(self, *arguments):
        return run(self.program, 'view', *arguments,
                   environment={'PATH': f'{self.path("nowhere")}:{self.path("path")}:/usr/bin:/bin'})

    def test_without_a_viewer_one_line_says_so(self):
        code, out, err = self.view('s.glb')
        self.assertEqual((code, out), (1, ''))
        self.assertIn('sightcell-viewer', self.assert_one_error_line(err, 'view.not-installed'))

    def test_the_viewer_in_path_takes_files_and_options_and_answers(self):
        self.write_viewer('path', 'in-path')
        self.assertEqual(self.view('s.glb'), (7, 'in-path 1 s.glb\n', ''))
        self.assertEqual(self.view('s.glb', 'f.pvs', '--cell', '3', '--mode=tint'),
                         (7, 'in-path 5 s.glb f.pvs --cell 3 --mode=tint\n', ''))

    def test_the_viewer_beside_the_program_comes_first(self):
        self.write_viewer('path', 'in-path')
        self.write_viewer('bin', 'beside')
        self.assertEqual(self.view('s.glb', 'f.pvs'), (7, 'beside 2 s.glb f.pvs\n', ''))

    def test_a_scene_is_needed(self):
        code, _, err = self.view()
        self.assertEqual(code, 2)
        self.assert_one_error_line(err, 'cli.wrong-use')
