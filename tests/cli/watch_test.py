"""`bake --watch`: saves of all kinds, and what is on the disk meanwhile."""
import json
import os
import queue
import signal
import subprocess
import threading

from harness import QUICK_BAKE, TIMEOUT, InRoom, program, read, write_room

HEIGHTS = (4, 5)  # of the room, in its two versions
# A preview, and then half a second of one thread.
FEW = ['--samples', '8', '--resolution', '64', '--threads', '1']
DRAFT, SLOW = [*FEW, '--quality', 'draft'], [*FEW, '--quality', 'final']


class Watcher:
    """A running watch. Its lines are read as they come."""

    def __init__(self, test, scene, output, *options, cells=None):
        self.test, self.lines, self.all = test, queue.Queue(), []
        self.process = subprocess.Popen(
            [program('sightcell'), 'bake', scene, '-o', output, '--watch', '--cells-file', cells or test.cells, '--progress',
             'json', *options], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.reader = threading.Thread(target=self.read)
        self.reader.start()
        test.addCleanup(self.end)

    def read(self):
        for line in self.process.stderr:
            self.lines.put(line)
        self.lines.put(None)

    def until(self, *texts):
        """The lines up to one with one of these texts."""
        lines = []
        while True:
            line = self.lines.get(timeout=TIMEOUT)
            self.all.append(line)
            self.test.assertIsNotNone(line, f'none of {texts} in\n{self.all}')
            lines.append(line)
            if any(text in line for text in texts):
                return lines

    def end(self, number=signal.SIGKILL):
        """The exit code."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        self.process.wait(timeout=TIMEOUT)
        self.reader.join()
        self.process.stderr.close()
        return self.process.returncode


class Watch(InRoom):
    """A room with a lower and a higher ceiling."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.versions, cls.known = [], {}
        for height in HEIGHTS:
            write_room(cls.path(f'{height}.glb'), height)
            cls.versions.append(read(cls.path(f'{height}.glb')))

    def baked(self, options):
        """The bytes of the file of each version."""
        files = self.known.setdefault(tuple(options), [])
        for height in HEIGHTS[len(files):]:
            output = self.path('plain.pvs')
            self.expect(0, 'bake', self.path(f'{height}.glb'), '-o', output, '--cells-file', self.cells, *options)
            files.append(read(output))
        return files

    def save(self, version, by_rename=False):
        path = self.path('new.glb') if by_rename else self.room
        with open(path, 'wb') as out:
            out.write(self.versions[version])
        if by_rename:
            os.rename(path, self.room)

    def assert_nothing_left(self, output):
        self.assertEqual([n for n in os.listdir(self.folder) if n.startswith(os.path.basename(output) + '.')], [])

    def test_fifty_saves_in_quick_succession(self):
        files, output = self.baked(QUICK_BAKE), self.path('saves.pvs')
        self.save(0)
        embedded = self.path('embedded.glb')
        running = Watcher(self, self.room, output, *QUICK_BAKE, '--embed', embedded)
        running.until('waiting for')
        self.assertEqual(read(output), files[0])
        self.assertIn(files[0], read(embedded))
        for i in range(50):
            self.save(1 - i % 2 if i < 49 else 1, by_rename=i % 3 == 0)
            self.assertIn(read(output), files)
        loads = 0
        while read(output) != files[1]:
            loads += sum(': 12 polygons' in line for line in running.until('waiting for'))
        self.assertLess(loads, 25)
        # The same scene once more, as exporters save it when a color has changed.
        self.save(1)
        running.until('nothing that decides visibility has changed')
        running.until('waiting for')
        self.assertEqual(running.end(signal.SIGINT), 0)
        self.assertEqual(read(output), files[1])
        self.assertIn(files[1], read(embedded))
        self.assert_nothing_left(output)

    def test_a_save_during_a_bake_stops_it_and_a_broken_file_keeps_the_old_one(self):
        draft, files, output = self.baked(DRAFT), self.baked(SLOW), self.path('during.pvs')
        self.save(0)
        running = Watcher(self, self.room, output, *SLOW)
        for _ in range(10):  # on a busy machine the bake may end before the signal
            running.until('preview of 1 cells')
            running.process.send_signal(signal.SIGSTOP)  # the bake must not end before the save
            self.assertIn(read(output), (draft[0], files[0]))
            self.save(1)
            running.process.send_signal(signal.SIGCONT)
            if 'stopped' in running.until('stopped', 'waiting for')[-1]:
                break
            running.until('waiting for')
            self.save(0)
        else:
            self.fail('no save stopped a bake')
        running.until('preview of 1 cells')
        running.until('waiting for')
        self.assertEqual(read(output), files[1])
        with open(self.room, 'wb') as out:
            out.write(self.versions[0][:100])
        lines = running.until('waiting for')
        named = [line for line in lines if line.startswith('sightcell: ')]
        self.assertEqual(len(named), 1, lines)
        self.assertIn('room.glb', named[0])
        self.assertTrue(named[0].endswith('[scene.truncated]\n'), named)
        self.assertEqual(read(output), files[1])
        self.save(0)
        running.until('waiting for')
        self.assertEqual(read(output), files[0])
        self.save(1)
        running.until('preview of 1 cells')
        code = running.end(signal.SIGINT)
        self.assertIn((code, read(output)), ((130, draft[1]), (0, files[1])))  # unfinished, or ended before the signal

    def test_a_kill_leaves_a_complete_file(self):
        known = self.baked(DRAFT) + self.baked(SLOW)
        output = self.path('killed.pvs')
        with open(output, 'wb') as out:
            out.write(known[2])
        moments = ('12 polygons', '"phase":"writing_file"', 'preview of', '"cells_in_work":1', 'waiting for')
        for i, moment in enumerate(moments):
            self.save(1 - i % 2)
            running = Watcher(self, self.room, output, *SLOW)
            running.until(moment, 'waiting for')  # a quick bake reports no cell in work
            self.assertEqual(running.end(), -signal.SIGKILL)
            self.assertIn(read(output), known, moment)
        self.assert_nothing_left(output)

    def test_all_files_that_the_scene_names_are_watched(self):
        """Also where events do not come: the scene is a symbolic link to another folder."""
        os.makedirs(self.path('elsewhere'))
        text = {'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0]}], 'nodes': [{'mesh': 0}]}
        whole = self.versions[0]
        length = int.from_bytes(whole[12:16], 'little')
        document = {**json.loads(whole[20:20 + length]), **text}
        document['buffers'][0]['uri'] = 'room.bin'
        scene, output = self.path('linked.gltf'), self.path('named.pvs')
        with open(self.path('elsewhere/room.gltf'), 'w', encoding='utf-8') as out:
            json.dump(document, out)
        os.symlink(self.path('elsewhere/room.gltf'), scene)
        with open(self.path('room.bin'), 'wb') as out:
            out.write(whole[28 + length:])
        files = self.baked(QUICK_BAKE)
        running = Watcher(self, scene, output, *QUICK_BAKE)
        running.until('waiting for')
        self.assertEqual(read(output), files[0])
        with open(self.path('room.bin'), 'wb') as out:
            out.write(self.versions[1][-len(whole[28 + length:]):])
        running.until('waiting for')
        self.assertEqual(read(output), files[1])
        document['nodes'][0]['translation'] = [0, 0.5, 0]
        with open(self.path('elsewhere/room.gltf'), 'w', encoding='utf-8') as out:
            json.dump(document, out)
        running.until('waiting for')
        self.assertNotIn(read(output), files)

    def test_kept_records_save_what_a_save_did_not_change(self):
        files, output = self.baked([*FEW, '--source', 'cpu']), self.path('kept.pvs')
        self.save(0)
        running = Watcher(self, self.room, output, *FEW, '--source', 'cpu', '--keep-records')
        running.until('waiting for')
        self.save(1)
        running.until('baked again: 1 of 1 cells')
        running.until('waiting for')
        self.assertEqual(read(output), files[1])
        write_room(self.room, HEIGHTS[1], nodes=[{'mesh': 0, 'name': 'renamed'}, {'mesh': 0}])
        running.until('baked again: 0 of 1 cells')
        running.until('waiting for')
        self.assertEqual(read(output), files[1])
        self.assertEqual(running.end(signal.SIGINT), 0)
        left = [n for n in os.listdir(self.folder) if n.startswith('kept.pvs.')]
        self.assertEqual(left, ['kept.pvs.records'])
        # Of an earlier command, too, unless its settings were others, or the records are damaged.
        running = Watcher(self, self.room, output, *FEW, '--source', 'cpu', '--keep-records')
        running.until('baked again: 0 of 1 cells')
        running.until('waiting for')
        self.assertEqual(read(output), files[1])
        self.assertEqual(running.end(signal.SIGINT), 0)
        running = Watcher(self, self.room, output, *FEW, '--source', 'cpu', '--keep-records', '--seed', '7', '--keep-found')
        self.assertIn('records.other-bake', running.until('all cells are baked')[-1])
        running.until('waiting for')
        self.assertNotEqual(read(output), files[1])
        self.assertEqual(running.end(signal.SIGINT), 0)
        with open(output + '.records', 'r+b') as records:
            records.truncate(100)
        running = Watcher(self, self.room, output, *FEW, '--source', 'cpu', '--keep-records')
        self.assertIn('records.damaged', running.until('all cells are baked')[-1])
        running.until('waiting for')
        self.assertEqual(read(output), files[1])
        self.assertEqual(running.end(signal.SIGINT), 0)

    def test_a_preview_starts_from_the_one_before(self):
        """Also while no final bake has ended."""
        for i in range(10):  # on a busy machine the bake may end before the signal
            self.save(0)
            running = Watcher(self, self.room, self.path(f'preview{i}.pvs'), *SLOW, '--source', 'cpu', '--keep-records')
            running.until('preview of 1 cells')
            running.process.send_signal(signal.SIGSTOP)  # the bake must not end before the save
            write_room(self.room, HEIGHTS[0], nodes=[{'mesh': 0, 'name': 'renamed'}, {'mesh': 0}])
            running.process.send_signal(signal.SIGCONT)
            if 'stopped' in running.until('stopped', 'waiting for')[-1]:
                self.assertIn('(0 baked again)', running.until('preview of 1 cells')[-1])
                return
            running.end()
        self.fail('no save stopped a bake')

    def test_keep_found_from_the_second_bake_on(self):
        output = self.path('found.pvs')

        def says_so():
            settings = json.loads(self.expect(0, 'info', output, '--json')[0])['settings']
            self.assertEqual(settings.get('keep_order'), settings.get('keep_found'))
            return settings.get('keep_found')
        self.save(0)
        running = Watcher(self, self.room, output, *FEW, '--source', 'cpu', '--keep-records', '--keep-found', '--keep-order')
        running.until('waiting for')
        self.assertIsNone(says_so(), 'there was nothing to start from')
        self.save(1)
        running.until('tested again: 1 of 1 cells')
        running.until('waiting for')
        self.assertTrue(says_so())
        self.assertEqual(running.end(signal.SIGINT), 0)

    def test_a_preview_of_the_nearest_cells(self):
        """Of 68 cells along the room."""
        cells, output, plain = self.path('many.json'), self.path('near.pvs'), self.path('all.pvs')
        boxes = [{'name': str(i), 'min': [1 + 0.09 * i, 1, 3], 'max': [1.05 + 0.09 * i, 1.2, 3.2]} for i in range(68)]
        with open(cells, 'w', encoding='utf-8') as out:
            json.dump({'cells': boxes}, out)
        self.save(0)
        found, _ = self.expect(0, 'cells', self.room, '--cells-file', cells, '--cell-limit', '2', '--near', '7,1,3', '--json')
        self.assertEqual([cell['name'] for cell in json.loads(found)['cells']], ['66', '67'])
        draft = [*FEW, '--max-pixel-error', '1e-2']
        self.expect(0, 'bake', self.room, '-o', plain, '--cells-file', cells, *draft)
        running = Watcher(self, self.room, output, *draft, '--near', '1,1,3', cells=cells)
        lines = running.until('waiting for')
        self.assertTrue(any('64 nearest of 68 cells' in line for line in lines), lines)
        self.assertTrue(any('preview of 64 cells' in line for line in lines), lines)
        self.assertEqual(read(output), read(plain))
        self.assertEqual(running.end(signal.SIGINT), 0)
        place = self.path('camera.json')
        running = Watcher(self, self.room, output, *draft, '--near', place, cells=cells)
        lines = running.until('waiting for')
        self.assertFalse(any('preview' in line for line in lines), 'all cells at once while there is no camera')
        with open(place, 'w', encoding='utf-8') as out:
            json.dump({'path': [[1, 1, 3], [7, 1, 3]]}, out)
        self.save(1)
        lines = running.until('waiting for')
        self.assertTrue(any('preview of 64 cells' in line for line in lines), lines)
        self.assertEqual(running.end(signal.SIGINT), 0)
        found, _ = self.expect(0, 'cells', self.room, '--cells-file', cells, '--cell-limit', '2', '--near', place, '--json')
        self.assertEqual([cell['name'] for cell in json.loads(found)['cells']], ['66', '67'])
        _, err = self.expect(4, 'cells', self.room, '--cell-limit', '2', '--near', self.path('gone.json'))
        self.assertIn('gone.json', self.assert_one_error_line(err, 'path.unreadable'))
        for wrong in (['1,2', '--cell-limit', '2'], ['1,2,3']):
            _, err = self.expect(2, 'bake', self.room, '-o', output, '--near', *wrong)
            self.assertIn('--near', self.assert_one_error_line(err, 'settings.out-of-range'))

    def test_what_ends_it_at_the_beginning(self):
        output = self.path('no.pvs')
        _, err = self.expect(4, 'bake', self.path('missing.glb'), '-o', output, '--watch')
        self.assert_one_error_line(err, 'scene.not-found')
        _, err = self.expect(2, 'bake', self.room, '-o', output, '--watch', '--embed', self.room)
        self.assert_one_error_line(err, 'cli.output-is-input')
        for more in (['--shard', '0/2'], ['--since', output], ['--time-budget', '5']):
            _, err = self.expect(2, 'bake', self.room, '-o', output, '--watch', *more)
            self.assert_one_error_line(err, 'cli.wrong-use')
