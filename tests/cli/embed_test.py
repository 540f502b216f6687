"""`bake --embed`: the .pvs file in a .glb, or named by a .gltf."""
import json
import os
import shutil
import signal
import subprocess

from harness import QUICK_BAKE, TIMEOUT, InRoom, program, program_or_skip, read, run, write_room, write_triangles


def json_of(path):
    glb = read(path)
    return json.loads(glb[20:20 + int.from_bytes(glb[12:16], 'little')])


class Embed(InRoom):
    def bake(self, scene, output, *more, code=0):
        return self.expect(code, 'bake', scene, '-o', output, '--cells-file', self.cells, *QUICK_BAKE, *more)

    def info(self, path):
        return json.loads(self.expect(0, 'info', path, '--json')[0])

    def test_in_a_glb(self):
        scene, pvs = self.path('level.glb'), self.path('level.pvs')
        shutil.copyfile(self.room, scene)
        before = self.info(scene)
        self.assertIsNone(before['embedded'])
        _, said = self.bake(scene, pvs, '--embed', scene)
        self.assertIn('level.glb: ', said)
        after = self.info(scene)
        self.assertEqual(after['embedded'], {'buffer_view': 2, 'uri': None, 'bytes': len(read(pvs)), 'cells': 1,
                                             'same_scene': True})
        self.assertEqual({**after, 'embedded': None}, before, 'the scene is the same')
        self.assertIn('  .pvs file          buffer view 2, ', self.expect(0, 'info', scene)[0])
        document, whole = json_of(scene), read(scene)
        view = document['bufferViews'][document['extras']['sightcell']['pvs']['bufferView']]
        begin = len(whole) - int.from_bytes(whole[12 + 8 + int.from_bytes(whole[12:16], 'little'):][:4], 'little')
        self.assertEqual(whole[begin + view['byteOffset']:][:view['byteLength']], read(pvs))
        # Baked again, with another file and back again.
        again = self.path('again.pvs')
        self.bake(scene, again, '--embed', scene)
        self.assertEqual(read(again), read(pvs))
        self.assertEqual(read(scene), whole)
        self.bake(scene, again, '--embed', scene, '--names')
        self.assertEqual(self.info(scene)['embedded']['bytes'], len(read(again)))
        self.assertNotEqual(read(scene), whole)
        self.bake(scene, again, '--embed', scene)
        self.assertEqual(read(scene), whole)
        # The runtime opens it.
        sample = program_or_skip('sightcell-hello-cull')
        code, out, _ = run(sample, scene)
        self.assertEqual(code, 0)
        self.assertEqual(out.replace('level.glb', 'level.pvs'), run(sample, pvs)[1])
        self.assertNotEqual(run(sample, self.room)[0], 0)
        # Commands that only read take the scene in place of the file.
        rays = ('--rays', '2000', '--json')
        of_file = json.loads(self.expect(0, 'verify', scene, pvs, *rays)[0])
        self.assertGreater(of_file['rays'], 0)
        self.assertEqual(json.loads(self.expect(0, 'verify', scene, scene, *rays)[0]), of_file)
        self.assertEqual(json.loads(self.expect(0, 'diff', scene, pvs, '--json')[0])['polygons_gained'], 0)
        self.expect(0, 'report', scene, '--scene', scene, '-o', self.path('page.html'), '--rays', '0')
        self.expect(0, 'strip', scene, scene, '--report', self.path('unseen.json'))
        _, said = self.expect(4, 'verify', scene, self.room)
        self.assertIn('contains and names no .pvs file', said)
        # What is left of a stripped scene has other polygons.
        self.expect(0, 'strip', scene, pvs, '-o', self.path('stripped.glb'))
        self.assertIsNone(self.info(self.path('stripped.glb'))['embedded'])

    def test_a_file_of_another_scene_or_none_is_reported(self):
        scene, pvs = self.path('other.glb'), self.path('other.pvs')
        self.bake(self.room, pvs, '--embed', scene)
        self.assertTrue(self.info(scene)['embedded']['same_scene'])
        view = json_of(scene)['bufferViews'][2]
        write_room(scene, 5, extras={'sightcell': {'pvs': {'bufferView': 0}}})
        found = self.info(scene)
        self.assertIsNone(found['embedded'])
        self.assertIn('[pvs.refused]', found['warnings'][-1])
        write_room(scene, 5, extras={'sightcell': {'pvs': {'uri': 'other.pvs'}}})
        self.assertEqual(self.info(scene)['embedded'], {'buffer_view': None, 'uri': 'other.pvs',
                                                        'bytes': view['byteLength'], 'cells': 1, 'same_scene': False})
        for named in (5, {'bufferView': 9}, {'uri': '../x.pvs'}, {'uri': 'none.pvs'}, {}):
            write_room(scene, 5, extras={'sightcell': {'pvs': named}})
            found = self.info(scene)
            self.assertIsNone(found['embedded'])
            self.assertIn('[scene.', found['warnings'][-1], named)

    def test_a_scene_that_is_saved_during_the_bake_is_left_as_it_is(self):
        scene, pvs = self.path('saved.glb'), self.path('saved.pvs')
        write_room(self.path('higher.glb'), 5)
        command = [program('sightcell'), 'bake', scene, '-o', pvs, '--cells-file', self.cells, '--samples', '8',
                   '--resolution', '64', '--threads', '1', '--quality', 'final', '--embed', scene, '--fresh']
        for _ in range(10):  # on a busy machine the bake may end before the signal
            shutil.copyfile(self.room, scene)
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as running:
                while '12 polygons' not in running.stderr.readline():
                    self.assertIsNone(running.poll())
                running.send_signal(signal.SIGSTOP)
                shutil.copyfile(self.path('higher.glb'), scene)
                running.send_signal(signal.SIGCONT)
                err = running.communicate(timeout=TIMEOUT)[1]
            if running.returncode != 0:
                break
        self.assertEqual(running.returncode, 1, err)
        self.assertTrue(err.endswith('[embed.scene-changed]\n'), err)
        self.assertEqual(read(scene), read(self.path('higher.glb')))
        self.assertEqual(self.info(pvs)['fingerprint'], self.info(self.room)['fingerprint'])

    def test_beside_a_gltf(self):
        os.makedirs(self.path('text/sets'))
        scene, pvs = self.path('text/level.gltf'), self.path('text/sets/a b.pvs')
        write_triangles(scene, [((0, 1, 2), 0)], [{'doubleSided': True}])
        before = self.info(scene)
        self.bake(scene, pvs, '--embed', scene)
        with open(scene, encoding='utf-8') as file:
            self.assertEqual(json.load(file)['extras'], {'sightcell': {'pvs': {'uri': 'sets/a%20b.pvs'}}})
        after = self.info(scene)
        self.assertEqual(after['embedded']['uri'], 'sets/a%20b.pvs')
        self.assertTrue(after['embedded']['same_scene'])
        self.assertEqual({**after, 'embedded': None}, before)
        whole = read(scene)
        self.bake(scene, pvs, '--embed', scene)
        self.assertEqual(read(scene), whole)

    def test_what_cannot_be_embedded(self):
        scene = self.path('text.gltf')
        write_triangles(scene, [((0, 1, 2), 0)], [{'doubleSided': True}])
        os.makedirs(self.path('away'), exist_ok=True)
        _, err = self.bake(scene, self.path('away.pvs'), '--embed', self.path('away/text.gltf'), code=4)
        self.assertIn('away.pvs', self.assert_one_error_line(err, 'embed.outside-folder'))
        _, err = self.bake(self.room, self.path('same.pvs'), '--embed', self.path('same.pvs'), code=2)
        self.assert_one_error_line(err, 'cli.output-is-input')
        _, err = self.bake(self.room, self.path('no.pvs'), '--embed', self.path('missing/room.glb'), code=1)
        self.assert_one_error_line(err, 'cli.not-writable')
        write_room(self.path('separate.glb'),
                   buffers=[{'byteLength': 168, 'uri': 'data:application/octet-stream;base64,' + 'AAAA' * 56}])
        _, err = self.bake(self.path('separate.glb'), self.path('no.pvs'), '--embed', self.path('out.glb'), code=4)
        self.assertIn('separate.glb', self.assert_one_error_line(err, 'embed.separate-buffers'))
