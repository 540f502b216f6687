"""Runs the program `sightcell` end to end on small scenes: what it prints, answers and leaves on the disk."""
import json
import os

from harness import QUICK_BAKE, InRoom, program_or_skip, read, run, sightcell, write_room


class Bake(InRoom):
    def bake(self, code, output, *more):
        return self.expect(code, 'bake', self.room, '-o', output, '--cells-file', self.cells, *QUICK_BAKE, *more)

    def test_bake_info_verify(self):
        file, summary_file = self.path('room.pvs'), self.path('summary.json')
        out, err = self.bake(0, file, '--json', '--json-file', summary_file, '--progress', 'json')
        summary = json.loads(out)
        self.assertEqual(summary, json.loads(read(summary_file)))
        self.assertEqual((summary['result'], summary['cells'], summary['polygons']), ('done', 1, 12))
        self.assertEqual(summary['visible_set_percent'], 100.0)
        self.assertEqual(summary['bytes'], os.path.getsize(file))
        progress = [json.loads(line) for line in err.splitlines() if line.startswith('{')]
        self.assertEqual((progress[-1]['cells'], progress[-1]['cells_total']), (1, 1))
        self.assertFalse(os.path.exists(file + '.bake'), 'a finished bake leaves no checkpoint')

        info = json.loads(self.expect(0, 'info', file, '--json')[0])
        for key in ('cells', 'polygons', 'bytes', 'bits_per_visible_polygon', 'runs_per_cell', 'ranges_per_cell',
                    'draws_per_cell', 'joined_ranges_per_cell',
                    'delta_row_percent', 'false_visible_percent', 'layout', 'sections', 'fingerprint', 'settings',
                    'repeatable', 'certificate'):
            self.assertIn(key, info)
        self.assertEqual((info['cells'], info['polygons'], info['layout']), (1, 12, 'instanced'))
        self.assertEqual(info['bytes'], os.path.getsize(file))
        self.assertEqual(info['settings']['samples'], 8)
        self.assertTrue(info['repeatable'])
        self.assertEqual(set(info['certificate'][0]), {'cell', 'rays', 'misses', 'upper_bound', 'confidence', 'seed'})
        scene = json.loads(self.expect(0, 'info', self.room, '--json')[0])
        self.assertEqual(info['fingerprint'], scene['fingerprint'])
        self.assertIn('1 cells', self.expect(0, 'info', file)[0])

        out, _ = self.expect(0, 'verify', self.room, file, '--rays', '20000', '--json')
        result = json.loads(out)
        for key in ('pixel_error', 'upper_bound', 'confidence', 'rays', 'misses', 'cells', 'visible_set_percent',
                    'worst_view', 'worst_cell', 'worst_cell_error', 'worst_cell_upper_bound'):
            self.assertIn(key, result)
        self.assertEqual((result['misses'], result['pixel_error'], result['worst_view']), (0, 0.0, None))
        self.assertEqual((result['rays'], result['cells'], result['confidence']), (20000, 1, 0.95))
        self.assertAlmostEqual(result['upper_bound'], 1.0 - 0.05 ** (1.0 / 20000), places=9)

    def test_quality_is_a_name_for_a_bound(self):
        """The bytes of the explicit bound; which wins where both are given; normal is the default."""
        bound = {'draft': 1e-3, 'normal': 1e-4, 'final': 1e-5}
        bake = ['bake', self.room, '--cells-file', self.cells, '--samples', '8', '--resolution', '64', '--fresh']

        def baked(*options):
            file = self.path('quality.pvs')
            self.expect(0, *bake, '-o', file, *options)
            return read(file), json.loads(self.expect(0, 'info', file, '--json')[0])['settings']

        for quality, error in bound.items():
            content, settings = baked('--quality', quality)
            self.assertEqual(settings['max_pixel_error'], error)
            self.assertNotIn('quality', settings)
            self.assertEqual(content, baked('--max-pixel-error', str(error))[0])
        self.assertEqual(baked()[0], baked('--quality', 'normal')[0])
        self.assertEqual(baked('--quality', 'final', '--max-pixel-error', '0.01')[1]['max_pixel_error'], 0.01)

    def test_verify_judges_by_what_the_bake_was_asked_for(self):
        file = self.path('asked.pvs')
        bake = ['bake', self.room, '-o', file, '--cells-file', self.cells, '--samples', '8', '--resolution', '64',
                '--fresh', '--max-pixel-error']
        verify = ['verify', self.room, file, '--json']
        for error in ('1e-2', '1e-3'):
            self.expect(0, *bake, error)
            result = json.loads(self.expect(0, *verify, '--rays', '20000')[0])
            self.assertEqual((result['max_pixel_error'], result['passed']), (float(error), True))
            result = json.loads(self.expect(3, *verify, '--rays', '20000', '--max-pixel-error', '1e-6')[0])
            self.assertEqual((result['max_pixel_error'], result['passed']), (1e-6, False))
        result = json.loads(self.expect(0, *verify, '--max-pixel-error', '8e-6')[0])
        self.assertEqual((result['rays'], result['passed']), (1250000, True))
        self.expect(0, *bake, '0')
        result = json.loads(self.expect(0, *verify)[0])
        self.assertEqual((result['max_pixel_error'], result['rays']), (1e-4, 1000000), 'the bake was asked for none')

    def test_a_merged_file_says_so_and_holds_the_same(self):
        """The room twice, of one material: one draw group, but where one of them moves."""
        two, instanced, merged = self.path('twice.glb'), self.path('instanced.pvs'), self.path('merged.pvs')
        moves = [{'channels': [{'sampler': 0, 'target': {'node': 1, 'path': 'scale'}}], 'samplers': []}]
        for animations, groups in (([], 1), (moves, 2)):
            write_room(two, scenes=[[0, 1]], animations=animations)
            bake = ['bake', two, '--cells-file', self.cells, *QUICK_BAKE, '--fresh', '--profile', 'exact']
            self.expect(0, *bake, '-o', instanced)
            self.expect(0, *bake, '-o', merged, '--layout', 'merged')
            info = json.loads(self.expect(0, 'info', merged, '--json')[0])
            self.assertEqual((info['layout'], info['settings']['layout'], info['polygons']), ('merged', 'merged', 24))
            self.assertEqual(info['ranges_per_cell'], groups)
            self.assertRegex(self.expect(0, 'info', merged)[0], r'layout +merged,')
            difference = json.loads(self.expect(0, 'diff', instanced, merged, '--json')[0])
            self.assertEqual((difference['polygons_gained'], difference['polygons_lost']), (0, 0))
            self.expect(0, 'verify', two, merged, '--rays', '20000')
            # recode writes what a bake in the other layout does.
            for source, layout, made in ((instanced, 'merged', merged), (merged, 'instanced', instanced)):
                self.expect(0, 'recode', source, '--layout', layout, '--scene', two, '-o', self.path('other.pvs'))
                self.assertEqual(read(self.path('other.pvs')), read(made))

    def test_pack_writes_the_mesh_of_a_merged_file(self):
        two, file, mesh = self.path('twice.glb'), self.path('merged.pvs'), self.path('packed.glb')
        write_room(two, scenes=[[0], [0, 1]])
        bake = ['bake', two, '-o', file, '--scene', '1', '--cells-file', self.cells, *QUICK_BAKE, '--fresh']
        self.expect(0, *bake, '--layout', 'merged')
        told = json.loads(self.expect(0, 'pack', two, file, '-o', mesh, '--json')[0])
        self.assertEqual(told, {'output': mesh, 'polygons': 24, 'vertices': 16, 'groups': 1, 'moving': 0,
                                'bytes': os.path.getsize(mesh)})
        info = json.loads(self.expect(0, 'info', mesh, '--json')[0])
        self.assertEqual((info['polygons'], info['draws']), (24, 1))
        before = read(mesh)
        self.assertRegex(self.expect(0, 'pack', two, file, '-o', mesh)[0], '24 polygons, 16 vertices, 1 draw groups')
        self.assertEqual(read(mesh), before)
        for output in (two, file):
            self.assert_one_error_line(self.expect(2, 'pack', two, file, '-o', output)[1], 'cli.output-is-input')
        write_room(two, height=5, scenes=[[0], [0, 1]])
        self.assert_one_error_line(self.expect(4, 'pack', two, file, '-o', mesh)[1], 'pvs.other-scene')
        self.assertEqual(read(mesh), before)
        self.assertEqual([name for name in os.listdir(self.folder) if 'packed' in name], ['packed.glb'])

    def test_verify_loads_the_scene_of_the_bake(self):
        """A file of two scenes: the room, and the room twice."""
        two, file = self.path('two.glb'), self.path('two.pvs')
        write_room(two, scenes=[[0], [0, 1]])
        self.expect(0, 'bake', two, '-o', file, '--scene', '1', '--cells-file', self.cells, *QUICK_BAKE)
        info = json.loads(self.expect(0, 'info', file, '--json')[0])
        self.assertEqual((info['polygons'], info['settings']['scene']), (24, 1))
        self.assertEqual(json.loads(self.expect(0, 'info', two, '--json')[0])['polygons'], 12)
        self.assertEqual(json.loads(self.expect(0, 'info', two, '--scene', '1', '--json')[0])['polygons'], 24)
        self.expect(0, 'verify', two, file, '--rays', '20000')
        self.assertIn('[scene.no-such-scene]',
                      self.expect(2, 'bake', two, '-o', file, '--scene', '2', '--cells-file', self.cells)[1])

    def test_verify_takes_what_moves_as_the_bake_did(self):
        """The room twice, the second one moved by an animation: left out, it is in no set and rays pass through it."""
        two, file = self.path('moving.glb'), self.path('moving.pvs')
        moves = [{'channels': [{'sampler': 0, 'target': {'node': 1, 'path': 'scale'}}], 'samplers': []}]
        write_room(two, scenes=[[0, 1]], animations=moves)
        _, err = self.expect(0, 'bake', two, '-o', file, '--animated', 'dynamic', '--cells-file', self.cells,
                             *QUICK_BAKE)
        self.assertIn('warning: animations and skins move 1 draw of 12 polygons', err)
        info = json.loads(self.expect(0, 'info', file, '--json')[0])
        self.assertEqual((info['polygons'], info['visible_set_percent']), (24, 50.0))
        self.assertEqual(info['settings']['animated'], 'dynamic')
        self.expect(0, 'verify', two, file, '--rays', '20000')

    def test_too_few_rays_prove_too_little(self):
        file = self.path('few.pvs')
        self.bake(0, file)
        self.expect(3, 'verify', self.room, file, '--rays', '100')
        self.expect(0, 'verify', self.room, file, '--rays', '100', '--max-pixel-error', '0.05')

    def test_a_missing_polygon_is_found_named_and_drawn(self):
        drop = program_or_skip('sightcell-test-drop-polygon')
        file, broken = self.path('whole.pvs'), self.path('broken.pvs')
        self.bake(0, file)
        self.assertEqual(run(drop, file, broken, 0, 1)[0], 0)
        out, err = self.expect(3, 'verify', self.room, broken, '--rays', '20000', '--json',
                               '--picture', self.path('views'))
        result = json.loads(out)
        self.assertGreater(result['pixel_error'], 0.02)
        self.assertEqual({miss['polygon'] for miss in result['missing']}, {1})
        worst = result['worst_view']
        self.assertEqual((worst['cell'], worst['polygon'], worst['node_name']), (0, 1, 'room'))
        self.assertIn('polygon 1 (draw 0, node 0 "room") in cell 0', err)
        self.assertEqual(len(worst['pictures']), 3)
        for picture in worst['pictures']:
            self.assertEqual(read(picture)[:8], b'\x89PNG\r\n\x1a\n')
        self.assertGreater(worst['differing_pixels'], 1000)

    def test_what_a_host_found_missing_is_reproduced_and_repaired(self):
        drop = program_or_skip('sightcell-test-drop-polygon')
        file, broken, misses = self.path('seen.pvs'), self.path('dropped.pvs'), self.path('misses.json')
        self.bake(0, file)
        fingerprint = json.loads(self.expect(0, 'info', file, '--json')[0])['fingerprint']
        self.assertEqual(run(drop, file, broken, 0, 1)[0], 0)
        eye = [4, 1.5, 4.25]
        with open(misses, 'w', encoding='utf-8') as out:
            json.dump({'scene_fingerprint': fingerprint,
                       'misses': [{'eye': eye, 'polygon': 1, 'frame': 8}, {'eye': eye, 'polygon': 2},
                                  {'eye': [7, 1.5, 7], 'polygon': 1}]}, out)
        out, err = self.expect(3, 'verify', self.room, broken, '--from', misses, '--json')
        self.assertEqual(json.loads(out), {'passed': False, 'from': {
            'reports': 3, 'reproduced': 1, 'not_missing': 1, 'not_visible': 0, 'not_free': 0, 'outside': 1,
            'list': [{'cell': 0, 'polygon': 1, 'draw': 0, 'node': 0, 'node_name': 'room', 'eye': eye}]}})
        self.assertIn('reproduced: polygon 1 (node 0 "room") is missing in cell 0 and seen from 4,1.5,4.25', err)
        self.assertIn('1 of 3 reports reproduced; 1 not missing, 0 not visible, 0 from no free place, 1 from no cell', err)

        # With rays both have to pass.
        out, _ = self.expect(3, 'verify', self.room, broken, '--from', misses, '--rays', '2000', '--json',
                             '--max-pixel-error', '1')
        both = json.loads(out)
        self.assertEqual((both['passed'], both['from']['reproduced']), (False, 1))
        self.assertLess(both['upper_bound'], 1)

        repaired = self.path('repaired.pvs')
        self.bake(0, repaired, '--misses', misses)
        out, _ = self.expect(0, 'verify', self.room, repaired, '--from', misses, '--json')
        self.assertEqual([json.loads(out)['from'][key] for key in ('reproduced', 'not_missing', 'outside')], [0, 2, 1])
        settings = json.loads(self.expect(0, 'info', repaired, '--json')[0])['settings']
        self.assertEqual(settings.pop('misses'), 3)
        self.assertEqual(settings, json.loads(self.expect(0, 'info', file, '--json')[0])['settings'])

    def test_what_a_host_found_missing_in_one_of_two_cells(self):
        drop = program_or_skip('sightcell-test-drop-polygon')
        file, broken, misses = self.path('two.pvs'), self.path('one.pvs'), self.path('two_misses.json')
        with open(self.path('two.json'), 'w', encoding='utf-8') as out:
            out.write('{"cells":[{"name":"a","min":[3,0,3],"max":[4,2,5]},{"name":"b","min":[4,0,3],"max":[5,2,5]}]}')
        self.expect(0, 'bake', self.room, '-o', file, '--cells-file', self.path('two.json'), *QUICK_BAKE)
        self.assertEqual(run(drop, file, broken, 0, 1)[0], 0)

        def report(*eyes):
            with open(misses, 'w', encoding='utf-8') as out:
                json.dump({'misses': [{'eye': eye, 'polygon': 1} for eye in eyes]}, out)
        report([4.1, 1.5, 4.25], [3.5, 0.01, 4], [4.5, 1.5, 4])  # both may be in use; at the floor; the second alone
        out, _ = self.expect(3, 'verify', self.room, broken, '--from', misses, '--json')
        found = json.loads(out)['from']
        self.assertEqual([found[key] for key in ('reports', 'reproduced', 'not_missing', 'not_visible', 'not_free',
                                                 'outside')], [3, 1, 1, 0, 1, 0])
        self.assertEqual([miss['cell'] for miss in found['list']], [0])

        # Reports that are no misses do not make up for what the rays find.
        report([4.5, 1.5, 4])
        self.expect(0, 'verify', self.room, broken, '--from', misses)
        out, _ = self.expect(3, 'verify', self.room, broken, '--from', misses, '--rays', '20000', '--json')
        self.assertEqual((json.loads(out)['passed'], json.loads(out)['from']['reproduced']), (False, 0))

    def test_what_one_level_sees_of_another(self):
        """A high room sees of the same one, half as high, the floor and the lower halves of its walls, which lie in the
        higher ones; its ceiling is between them and is seen from below alone."""
        high, file = self.path('high.glb'), self.path('levels.pvs')
        write_room(high, height=8)
        both = ['--polygons-from', self.room, '--cells-from', high]
        out, err = self.expect(0, 'bake', *both, '-o', file, '--cells-file', self.cells, *QUICK_BAKE, '--json')
        self.assertEqual((json.loads(out)['polygons'], json.loads(out)['cells']), (12, 1))
        self.assertIn('cells among 12 polygons', err)
        info = json.loads(self.expect(0, 'info', file, '--json')[0])
        of_high = json.loads(self.expect(0, 'info', high, '--json')[0])['fingerprint']
        of_room = json.loads(self.expect(0, 'info', self.room, '--json')[0])['fingerprint']
        self.assertEqual((info['polygons'], info['fingerprint'], info['settings']['cells_from']), (12, of_room, of_high))
        out, _ = self.expect(0, 'verify', *both, file, '--rays', '20000', '--json')
        self.assertEqual(json.loads(out)['misses'], 0)
        self.expect(0, 'verify', file, *both, '--rays', '20000')
        _, err = self.expect(2, 'verify', self.room, file)
        self.assert_one_error_line(err, 'pvs.two-scenes')
        _, err = self.expect(4, 'verify', file, '--polygons-from', self.room, '--cells-from', self.room)
        self.assert_one_error_line(err, 'pvs.other-scene')
        own = self.path('own_level.pvs')
        self.bake(0, own)
        _, err = self.expect(4, 'verify', own, *both)
        self.assert_one_error_line(err, 'pvs.other-scene')
        misses = self.path('level_misses.json')
        with open(misses, 'w', encoding='utf-8') as out:
            out.write('{"misses":[{"eye":[4,1.5,4],"polygon":1}]}')
        out, _ = self.expect(0, 'verify', file, *both, '--from', misses, '--json')
        self.assertEqual(json.loads(out)['from']['reports'], 1)

    def test_the_metric_is_named_everywhere(self):
        view = ['--view-resolution', '640x360', '--view-fov', '90', '--view-pitch', '-30,20.5', '--view-least', '0.5']
        of_view = {'view_resolution': [640, 360], 'view_fov': 90, 'view_pitch': [-30, 20.5], 'view_least': 0.5}
        for metric, more in (('pixel', []), ('view', view), ('color', [])):
            file = self.path(f'{metric}.pvs')
            out, err = self.bake(0, file, '--metric', metric, *more, '--json')
            self.assertEqual(json.loads(out)['metric'], metric)
            self.assertIn(f"largest bound of a cell's {metric} error: ", err)
            info = json.loads(self.expect(0, 'info', file, '--json')[0])
            self.assertEqual(info['metric'], metric)
            self.assertEqual(info['settings'].get('metric', 'pixel'), metric)
            for key, value in of_view.items():
                self.assertEqual(info['settings'].get(key), value if metric == 'view' else None)
            self.assertRegex(self.expect(0, 'info', file)[0], f'{metric} error +at most')
            for measured in ('pixel', metric):
                asked = [] if measured == 'pixel' else ['--metric', measured, *more]
                out, err = self.expect(0, 'verify', self.room, file, '--rays', '20000', '--json', *asked)
                self.assertEqual(json.loads(out)['metric'], measured)
                self.assertIn(f'; {measured} error ', err)
                self.assertEqual('bounds in the file are of' in err, measured != metric)
        self.bake(0, self.path('default.pvs'))
        self.assertEqual(read(self.path('default.pvs')), read(self.path('pixel.pvs')))

    def test_verify_measures_what_it_is_told(self):
        drop = program_or_skip('sightcell-test-drop-polygon')
        file, broken = self.path('seen.pvs'), self.path('unseen.pvs')
        self.bake(0, file)
        self.assertEqual(run(drop, file, broken, 0, 1)[0], 0)

        def error(*metric):
            out, _ = self.expect(3, 'verify', self.room, broken, '--rays', '20000', '--json', *metric)
            return json.loads(out)['pixel_error']
        # Half of the floor is missing, white before the sky: all of it counts, less, or none where nobody looks down.
        self.assertGreater(error(), 0.02)
        self.assertTrue(0.1 * error() < error('--metric', 'color') < 0.9 * error())
        self.assertGreater(error('--metric', 'view', '--view-pitch', '-90,-60'), error())
        self.assertGreater(error('--metric', 'view', '--view-least', '10'), 0.02)
        for more in (['--view-least', '1e6', '--view-resolution', '16x16'], ['--view-pitch', '60,90']):
            self.expect(0, 'verify', self.room, broken, '--rays', '20000', '--metric', 'view', *more)

    def test_a_missing_polygon_is_patched(self):
        drop = program_or_skip('sightcell-test-drop-polygon')
        file, broken, whole = self.path('p.pvs'), self.path('p-broken.pvs'), self.path('p-whole.pvs')
        self.bake(0, file)
        self.assertEqual(run(drop, file, broken, 0, 1)[0], 0)
        self.expect(3, 'verify', self.room, broken, '--rays', '20000')
        before = read(broken)
        out, _ = self.expect(0, 'patch', broken, '--add', '0:0-1', '--add', '0:11', '-o', whole, '--json')
        answer = json.loads(out)
        self.assertEqual((answer['output'], answer['added'], answer['already_there']), (whole, 1, 2))
        self.assertEqual(answer['bytes'], os.path.getsize(whole))
        self.assertEqual(read(broken), before)
        self.expect(0, 'verify', self.room, whole, '--rays', '20000')
        info, old = (json.loads(self.expect(0, 'info', name, '--json')[0]) for name in (whole, broken))
        self.assertEqual(info['settings'].pop('added'), [[0, 1, 1]])
        self.assertEqual((info['settings'], info['certificate']), (old['settings'], old['certificate']))
        # Without -o the file itself; a second time there is nothing to add.
        self.assertIn('1 polygons added, 0 were there', self.expect(0, 'patch', broken, '--add', '0:1')[0])
        self.assertEqual(read(broken), read(whole))
        self.assertIn('0 polygons added, 1 were there', self.expect(0, 'patch', broken, '--add', '0:1')[0])
        self.assertEqual(read(broken), read(whole))

    def test_diff_tells_what_was_gained_and_lost(self):
        drop = program_or_skip('sightcell-test-drop-polygon')
        file, less = self.path('d.pvs'), self.path('d-less.pvs')
        self.bake(0, file)
        self.assertEqual(run(drop, file, less, 0, 1)[0], 0)

        def differences(a, b):
            return json.loads(self.expect(0, 'diff', a, b, '--json')[0])
        lost = differences(file, less)
        self.assertEqual(lost['changed'], [{'cell': 0, 'other_cell': 0, 'gained': 0, 'lost': 1}])
        self.assertEqual((lost['polygons_gained'], lost['polygons_lost'], lost['cells_changed']), (0, 1, 1))
        self.assertEqual(lost['polygons_before'] - 1, lost['polygons_after'])
        gained = differences(less, file)
        self.assertEqual((gained['polygons_gained'], gained['polygons_lost']), (1, 0))
        same = differences(file, file)
        self.assertEqual((same['cells_changed'], same['changed']), (0, []))
        self.assertIn('cell 0 (0): 0 gained, 1 lost', self.expect(0, 'diff', file, less)[0])
        # Cells are matched by their boxes: other cells are lost and gained.
        moved = self.path('d-moved.pvs')
        self.expect(0, 'bake', self.room, '-o', moved, '--cells-grid', '0,0,0,4,2,4', '--cell-size', '2',
                    '--samples', '8')
        other = differences(file, moved)
        self.assertEqual(other['cells_in_both'] + other['cells_lost'],
                         json.loads(self.expect(0, 'info', file, '--json')[0])['cells'])
        self.assertGreater(other['cells_gained'], 0)

    def test_volumes_are_told_of(self):
        coarse, fine, none = self.path('v-2.pvs'), self.path('v-1.pvs'), self.path('v-0.pvs')
        for file, width in ((coarse, '2'), (fine, '1'), (none, '0')):
            out = self.expect(0, 'bake', self.room, '-o', file, '--cells-grid', '0,0,0,2,2,2', '--cell-size', '2',
                              '--samples', '8', '--volumes', width, '--json')[0]
            info = json.loads(self.expect(0, 'info', file, '--json')[0])
            self.assertEqual(json.loads(out)['volumes'], info['volumes'])
            self.assertAlmostEqual(json.loads(out)['volumes_per_cell'], info['volumes_per_cell'])
            if file == none:
                self.assertEqual((info['volumes'], info['volume_width'], info['volume_percent']), (0, None, 0.0))
                continue
            self.assertEqual(info['volume_width'], float(width))
            self.assertGreater(info['volumes_per_cell'], 8)
            self.assertGreater(info['volumes'], info['volumes_per_cell'] - 1)
            self.assertTrue(0 < info['volume_percent'] < 100)
            self.assertIn('volumes  ', self.expect(0, 'info', file)[0])
        result = json.loads(self.expect(0, 'verify', self.room, fine, '--rays', '20000', '--max-pixel-error', '0.01',
                                        '--json')[0])
        self.assertLessEqual(result['volume_misses'], result['misses'])

        def differences(a, b):
            return json.loads(self.expect(0, 'diff', a, b, '--json')[0])
        same = differences(fine, fine)
        self.assertEqual((same['volumes_gained'], same['volumes_lost'], same['changed']), (0, 0, []))
        self.assertGreater(same['volumes_before'], 0)
        for other in (coarse, none):  # they cannot be compared
            self.assertIsNone(differences(fine, other)['volumes_before'])
        # Other random numbers find other ones of those that are hardly seen, or none; polygons are told apart.
        again = self.path('v-again.pvs')
        self.expect(0, 'bake', self.room, '-o', again, '--cells-grid', '0,0,0,2,2,2', '--cell-size', '2', '--samples',
                    '8', '--volumes', '1', '--margin', '0.5')
        change = differences(fine, again)
        self.assertEqual(change['volumes_before'] + change['volumes_gained'] - change['volumes_lost'],
                         change['volumes_after'])
        drop = program_or_skip('sightcell-test-drop-polygon')
        lacking = self.path('v-lacking.pvs')
        volumes = json.loads(self.expect(0, 'info', fine, '--json')[0])['volumes']
        items = range(12 + volumes // 2, 12 + volumes)  # behind the polygons
        self.assertTrue(any(run(drop, fine, lacking, 0, item)[0] == 0 for item in items))
        for a, b, gained, lost in ((fine, lacking, 0, 1), (lacking, fine, 1, 0)):
            change = differences(a, b)
            self.assertEqual((change['volumes_gained'], change['volumes_lost']), (gained, lost))
            self.assertEqual(change['changed'], [{'cell': 0, 'other_cell': 0, 'gained': 0, 'lost': 0,
                                                  'volumes_gained': gained, 'volumes_lost': lost}])

    def test_profiles_are_recoded_and_told_of(self):
        self.city = self.make_city('city.glb', polygons=2000)
        files = {name: self.path(f'profile-{name}.pvs') for name in ('exact', 'balanced', 'small')}
        for name in ('exact', 'balanced'):
            self.expect(0, 'bake', self.city, '-o', files[name], '--cell-limit', '6', '--quality', 'draft', '--profile', name)
        recoded = self.path('profile-recoded.pvs')
        out, _ = self.expect(0, 'recode', files['exact'], '--profile', 'balanced', '-o', recoded, '--json')
        self.assertEqual(read(recoded), read(files['balanced']), 'baked or recoded: the same file')
        self.expect(0, 'recode', files['exact'], '--profile', 'small', '-o', files['small'])
        infos = {name: json.loads(self.expect(0, 'info', file, '--json')[0]) for name, file in files.items()}
        slack = [infos[name]['false_visible_percent'] for name in files]
        self.assertEqual(slack[0], 0)
        self.assertTrue(0 < slack[1] <= 5.0 < slack[2] <= 10.0, slack)
        self.assertEqual(json.loads(out)['false_visible_percent'], slack[1])
        for key in ('bytes', 'ranges_per_cell'):
            values = [infos[name][key] for name in files]
            self.assertEqual(values, sorted(values, reverse=True), key)
        self.assertEqual([infos[name]['settings']['profile'] for name in files], list(files))
        for name in ('balanced', 'small'):
            change = json.loads(self.expect(0, 'diff', files['exact'], files[name], '--json')[0])
            self.assertEqual((change['polygons_lost'], change['cells_gained'], change['cells_lost']), (0, 0, 0))
            self.assertAlmostEqual(100 * change['polygons_gained'] / change['polygons_before'],
                                   infos[name]['false_visible_percent'], places=3)
            self.expect(0, 'verify', self.city, files[name], '--rays', '20000')
        self.assert_one_error_line(self.expect(2, 'recode', recoded, '--profile', 'exact')[1], 'recode.has-slack')
        self.clusters_are_baked_or_recoded(files['exact'])
        # In place, and not at all.
        self.expect(0, 'recode', recoded, '--order', 'per-instance')
        self.assertNotEqual(read(recoded), read(files['balanced']))
        before = read(recoded)
        self.assertIn('format version 1 -> 1', self.expect(0, 'migrate', recoded)[0])
        self.assertEqual(read(recoded), before)

    def clusters_are_baked_or_recoded(self, exact):
        baked, recoded = self.path('clusters-baked.pvs'), self.path('clusters-recoded.pvs')
        self.expect(0, 'bake', self.city, '-o', baked, '--cell-limit', '6', '--quality', 'draft', '--profile', 'exact',
                    '--granularity', 'cluster')
        self.expect(0, 'recode', exact, '--granularity', 'cluster', '--scene', self.city, '-o', recoded)
        self.assertEqual(read(recoded), read(baked), 'baked or recoded: the same file')
        info, before = (json.loads(self.expect(0, 'info', file, '--json')[0]) for file in (baked, exact))
        self.assertEqual((before['clusters'], info['settings']['granularity']), (0, 'cluster'))
        self.assertTrue(0 < info['clusters_per_cell'] < info['clusters'], info)
        rows = [section['size'] for file in (info, before) for section in file['sections'] if section['name'] == 'rows']
        self.assertLess(rows[0], rows[1])
        self.assertIn('clusters  ', self.expect(0, 'info', baked)[0])
        change = json.loads(self.expect(0, 'diff', exact, baked, '--json')[0])
        self.assertEqual(change['polygons_lost'], 0)
        self.assertGreater(change['polygons_gained'], 0)
        self.expect(0, 'verify', self.city, baked, '--rays', '20000')
        self.expect(0, 'recode', baked, '--profile', 'small', '--order', 'per-instance', '-o', recoded)
        self.assertEqual(json.loads(self.expect(0, 'info', recoded, '--json')[0])['clusters'], info['clusters'])

    def test_importance_is_baked_or_added_to_a_file(self):
        self.city = self.make_city('city.glb', polygons=2000)
        plain, whole, added = (self.path(f'importance-{name}.pvs') for name in ('plain', 'whole', 'added'))
        bake = ['bake', self.city, '--cell-limit', '6', '--quality', 'draft']
        self.expect(0, *bake, '-o', plain)
        _, log = self.expect(0, *bake, '-o', whole, '--importance')
        self.assertIn('importance of polygons: 100 %', log)
        out, _ = self.expect(0, 'recode', plain, '--importance', self.city, '-o', added, '--json')
        self.assertEqual(read(added), read(whole), 'baked or recoded: the same file')
        self.assertEqual(json.loads(out)['bytes'], len(read(added)))
        infos = [json.loads(self.expect(0, 'info', file, '--json')[0]) for file in (plain, whole)]
        self.assertIsNone(infos[0]['importance'])
        section = [s for s in infos[1]['sections'] if s['name'] == 'importance']
        self.assertEqual([s['size'] for s in section], [infos[1]['importance']['bytes']])
        self.assertTrue(0 < infos[1]['importance']['bits_per_visible_polygon'] < 4, infos[1]['importance'])
        self.assertIn('importance  ', self.expect(0, 'info', whole)[0])
        self.expect(0, 'verify', self.city, whole, '--rays', '20000')
        # What a file knows stays.
        self.assertIsNone(infos[1]['identity'])
        self.expect(0, 'recode', whole, '--names', '--scene', self.city)
        self.expect(0, 'patch', whole, '--add', '0:0-99')
        patched = json.loads(self.expect(0, 'info', whole, '--json')[0])
        self.assertIsNotNone(patched['importance'])
        self.assertGreater(patched['identity']['geometries'], 1)
        self.assertGreaterEqual(patched['draws'], patched['identity']['draws'])

    def test_a_safety_ring_is_told_of(self):
        self.city = self.make_city('city.glb', polygons=2000)
        sizes, file = {}, self.path('ring.pvs')
        for ring in ('none', 'edge', 'vertex'):
            out, err = self.expect(0, 'bake', self.city, '-o', file, '--cell-limit', '2', *QUICK_BAKE, '--safety-ring',
                                   ring, '--profile', 'exact', '--json')
            summary = json.loads(out)
            info = json.loads(self.expect(0, 'info', file, '--json')[0])
            self.assertEqual(info['settings'].get('safety_ring', 'none'), ring)
            # Of the sets with the ring: what was seen and what joined unseen.
            sizes[ring] = summary['visible_set_percent'] / (1 + summary['unseen_percent'] / 100)
            text = self.expect(0, 'info', file)[0]
            if ring == 'none':
                self.assertEqual((summary['unseen_per_cell'], summary['unseen_percent']), (0, 0))
                self.assertEqual(info['false_visible_percent'], 0)
                self.assertNotIn('safety ring', err + text)
                continue
            self.assertGreater(summary['unseen_per_cell'], 1)
            self.assertIsNone(info['false_visible_percent'])
            self.assertIn(f"safety ring: {summary['unseen_per_cell']:.1f} polygons per cell added unseen", err)
            self.assertIn(f'safety ring        {ring}:', text)
        self.assertAlmostEqual(sizes['edge'], sizes['none'])
        self.assertAlmostEqual(sizes['vertex'], sizes['none'])

    def test_a_time_budget_that_is_not_needed(self):
        file = self.path('in-time.pvs')
        out, err = self.bake(0, file, '--time-budget', '1000', '--json', '--progress', 'json')
        summary = json.loads(out)
        self.assertEqual([summary[key] for key in ('result', 'cells', 'cells_over_bound', 'cells_out_of_time',
                                                   'cells_unreached')], ['done', 1, 0, 0, 0])
        targets = {json.loads(line)['target'] for line in err.splitlines() if line.startswith('{')}
        self.assertEqual(targets, {1e-2})
        info = json.loads(self.expect(0, 'info', file, '--json')[0])
        self.assertEqual((info['repeatable'], info['settings']['time_budget']), (False, 1000))
        self.assertIn('not repeatable', self.expect(0, 'info', file)[0])
        self.expect(0, 'verify', self.room, file, '--rays', '20000')

    def test_a_time_budget_that_is_spent(self):
        file = self.path('out-of-time.pvs')
        out, err = self.expect(3, 'bake', self.room, '-o', file, '--cells-file', self.cells, '--resolution', '64',
                               '--max-pixel-error', '1e-7', '--time-budget', '2', '--json')
        summary = json.loads(out)
        self.assertEqual([summary[key] for key in ('result', 'cells', 'cells_over_bound', 'cells_out_of_time')],
                         ['bound_not_met', 1, 1, 1])
        self.assertIn('1 of 1 cells are above --max-pixel-error 1e-07, 1 because --time-budget was spent', err)
        _, err = self.expect(3, 'verify', self.room, file, '--rays', '20000')
        self.assertIn('20,000 rays are too few to prove 1e-07: give --rays 100000000 or more', err)
        self.expect(0, 'verify', self.room, file, '--rays', '20000', '--max-pixel-error', '1e-3')

    def test_file_of_another_scene_is_refused(self):
        other, file = self.path('other.glb'), self.path('of-this-room.pvs')
        write_room(other, height=5)
        self.bake(0, file)
        out, err = self.expect(4, 'verify', other, file, '--json')
        self.assertEqual(out, '')
        self.assertEqual(len([line for line in err.splitlines() if line.startswith('sightcell: ')]), 1, err)

    def test_damaged_files_are_refused(self):
        file = self.path('damaged.pvs')
        self.bake(0, file)
        whole = read(file)
        for at in range(0, len(whole), max(1, len(whole) // 16)):
            with open(file, 'wb') as out:
                out.write(whole[:at] + bytes([whole[at] ^ 0x10]) + whole[at + 1:])
            self.expect(4, 'info', file)
        with open(file, 'wb') as out:
            out.write(whole[:-1])
        self.expect(4, 'info', file)

    def test_a_scene_without_triangles(self):
        empty = self.path('empty.gltf')
        with open(empty, 'w', encoding='utf-8') as out:
            out.write('{"asset":{"version":"2.0"}}')
        self.expect(0, 'info', empty)
        _, err = self.expect(4, 'bake', empty, '-o', self.path('empty.pvs'))
        self.assertIn('empty.gltf', self.assert_one_error_line(err, 'bake.nothing-to-see'))

    def test_broken_cells_file_names_the_cell(self):
        with open(self.path('bad.json'), 'w', encoding='utf-8') as out:
            out.write('{"cells":[{"name":"lane 3","min":[0,0,0],"max":[0,1,1]}]}')
        _, err = self.expect(4, 'bake', self.room, '-o', self.path('no.pvs'), '--cells-file', self.path('bad.json'))
        self.assertIn('"lane 3"', self.assert_one_error_line(err, 'cells.empty-box'))

    def test_a_folder_that_takes_no_file(self):
        for output in ('/proc/no.pvs', self.path('no/such/folder/x.pvs')):
            _, err = self.bake(1, output)
            self.assertIn(output, self.assert_one_error_line(err, 'checkpoint.not-writable'))

    def test_threads_and_repetition_change_no_byte(self):
        a, b = self.path('a.pvs'), self.path('b.pvs')
        self.bake(0, a, '--threads', '1')
        self.bake(0, b, '--threads', '2')
        self.assertEqual(read(a), read(b))
        self.bake(0, a)  # over an existing file
        self.assertEqual(read(a), read(b))
