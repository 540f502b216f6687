"""sightcell-stream-client against a server that injects faults: in the end it has and draws what it has without them."""
import hashlib
import json
import os
import random
import re
import socket
import struct
import sys
import zlib

import harness
import numpy as np
import rooms_scene
from faulty_server import Plan, Server
from harness import InFolder, read
from png import read_png
from streamed_scene import cell_at, open_site

ROOMS = 24
ATTEMPTS = 20
IN_A_ROW = 11  # errors of a file: less, because a busy machine adds to them
FAULTS = 1000
MEMORY = 0.3  # MB: a third of all pages


def with_other_names(page):
    """The page with spaces of its JSON elsewhere: as many bytes, the same polygons."""
    size = struct.unpack_from('<I', page, 12)[0]
    text = page[20:20 + size]
    return page[:20] + text[-1:] + text[:-1] + page[20 + size:] if text.endswith(b' ') else page


class StreamClient(InFolder):
    """In rooms in a row."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program = harness.program_or_skip('sightcell-stream-client')
        scene, cells, pvs, cls.site_folder = map(cls.path, ('rooms.gltf', 'cells.json', 'rooms.pvs', 'site'))
        rooms_scene.write_rooms(scene, ROOMS)
        rooms_scene.write_cells(cells, ROOMS)
        for arguments in (['bake', scene, '-o', pvs, '--importance', '--progress', 'none', '--cells-file', cells,
                           *harness.QUICK_BAKE],
                          ['pack', '--stream', scene, pvs, '-o', cls.site_folder, '--page-size', 2048]):
            harness.must(harness.program('sightcell'), *arguments)
        cls.site = open_site(cls.site_folder)

    def serve(self, plan=None, folder=None):
        server = Server(folder or self.site_folder, plan)
        self.addCleanup(server.stop)
        return server

    def load(self, server, *more, code=0):
        """What the client prints: its JSON, its errors."""
        options = {'--attempts': ATTEMPTS, '--backoff': 1, '--longest-backoff': 8, '--stall': 250, '--connect': 1000,
                   '--size': '160x90', '--memory': MEMORY}
        usual = [part for name, value in options.items() if name not in more for part in (name, value)]
        url = server.url if isinstance(server, Server) else server
        answer, out, err = harness.run(self.program, url, '--json', '--list', *usual, *more)
        harness.skip_without_egl(answer, err)
        self.assertEqual(answer, code, f'{out}\n{err}')
        return json.loads(out) if out else None, err

    def needed(self, room):
        """Names of the files that a client needs in a room."""
        front = self.site.front
        cell = cell_at(self.site, rooms_scene.eye(room))
        images = [file.name() for image in cell.images.tolist() for file in front.images[image]]
        return {*map(front.page_name, cell.pages.tolist()), *map(front.page_name, front.everywhere.tolist()), *images}

    def changed_pages(self, change):
        """A copy of the site with other bytes in its pages, and their hashes in the front. change: number, bytes -> bytes of
        the same length. Returns the folder, and the new names by number."""
        folder = harness.new_folder(self.addCleanup)
        packed, names = self.site.read('scene.front'), {}
        payload, files = zlib.decompress(packed[16:]), {name: self.site.read(name) for name, _, _ in self.site.files()}
        for number in range(len(self.site.front.page_bytes)):
            name = self.site.front.page_name(number)
            data = files.pop(name)
            new = change(number, data)
            self.assertEqual(len(new), len(data))
            before, after = bytes.fromhex(name[6:22]), hashlib.sha256(new).digest()[:8]
            self.assertEqual(payload.count(before), 1)
            payload = payload.replace(before, after)
            names[number] = f'pages/{after.hex()}.glb'
            files[names[number]] = new
        files['scene.front'] = packed[:12] + struct.pack('<I', len(payload)) + zlib.compress(payload)
        for name, data in files.items():
            os.makedirs(os.path.dirname(os.path.join(folder, name)), exist_ok=True)
            with open(os.path.join(folder, name), 'wb') as file:
                file.write(data)
        return folder, names

    def walk(self, server, name):
        """What the client prints after a walk, and its last picture."""
        path, picture = self.path('path.json'), self.path(name + '.png')
        with open(path, 'w', encoding='utf-8') as file:
            json.dump({'path': [rooms_scene.eye(number) for number in (0, ROOMS - 1, 0)]}, file)
        result, err = self.load(server, '--walk', path, '--speed', 250, '--wait', '--picture', picture, '--save',
                                self.path(name))
        self.assertEqual((result['failed'], err), ([], ''))
        self.assertTrue(result['complete'])
        self.assertLessEqual(result['memory_peak'], result['memory_limit'])
        self.assertGreater(result['removed'], 0)
        self.assertLessEqual(self.needed(0), set(result['present']))
        return result, read(picture)

    def test_a_thousand(self):
        clean, expected = self.walk(self.serve(), 'clean')
        self.assertEqual((clean['errors'], clean['refetches']), (0, 0))
        server = self.serve(Plan(seed=1, in_a_row=IN_A_ROW, stalls=0.03, harmless=0.1))
        faulty, picture = self.walk(server, 'faulty')
        self.assertGreaterEqual(sum(server.plan.counts.values()), FAULTS, server.plan.counts)
        self.assertGreater(faulty['errors'], FAULTS * 2 // 3)
        self.assertGreater(faulty['refetches'], FAULTS // 2)
        # Endless bodies (64 MB each) are cut after at most about one buffer of the client, 64 KB. In the mean, all that
        # arrives is less than that for each. How many faults there are depends on how long the walk takes.
        endless = sum(count for kind, count in server.plan.counts.items() if 'endless' in kind)
        self.assertGreater(endless, 100)
        self.assertLess(faulty['bytes'], endless * (64 << 10))
        self.assertEqual(picture, expected)
        for name in faulty['present']:
            self.assertEqual(read(os.path.join(self.path('faulty'), name)), self.site.read(name), name)

    def test_encodings(self):
        """Of bodies that are what they are called, and of such that are not: where that is true of each answer, one of two
        attempts succeeds."""
        pages = sorted(name for name in self.needed(0) if name.startswith('pages'))
        expected, _ = self.load(self.serve(), '--eye', '4,2,4', '--no-draw')
        for kind, errors in (('compressed', 0), ('false encoding', 1), ('not asked to compress', 0)):
            with self.subTest(kind):
                server = self.serve(Plan(always={name: kind for name in pages}))
                result, err = self.load(server, '--eye', '4,2,4', '--no-draw', '--save', self.path(kind))
                self.assertEqual((result['errors'], result['refetches'], result['failed'], err),
                                 (errors * len(pages), errors * len(pages), [], ''))
                self.assertEqual(result['present'], expected['present'])
                for name in pages:
                    self.assertEqual(read(os.path.join(self.path(kind), name)), self.site.read(name))
                if not errors:
                    self.assertLess(result['bytes'], 0.95 * expected['bytes'])

    def test_wrong_encodings(self):
        """Are reported, and end before they fill memory."""
        page = min(name for name in self.needed(0) if name.startswith('pages'))
        for kind, cause in (('cut in compressed', 'bytes instead of'), ('other file compressed', ''), ('compressed twice', ''),
                            ('endless compressed', 'more than'), ('other encoding', ''), ('unknown encoding', '')):
            with self.subTest(kind):
                result, err = self.load(self.serve(Plan(always={page: kind})), '--eye', '4,2,4', '--no-draw', '--attempts', 3,
                                        code=1)
                self.assertEqual([failure['name'] for failure in result['failed']], [page])
                self.assertIn(cause, result['failed'][0]['cause'])
                self.assertEqual((result['errors'], len(err.splitlines())), (3, 1), err)
                self.assertLess(result['bytes'], 1 << 20)

    def test_picture_is_that_of_the_scene(self):
        reference, picture = self.path('reference.png'), self.path('picture.png')
        harness.must(harness.program_or_skip('sightcell-test-reference-picture'), self.path('rooms.gltf'), reference, 320, 180,
                     4, 2, 4, 1, -0.7, 0.5)
        result, _ = self.load(self.serve(), '--eye', '4,2,4', '--look', '5,1.3,4.5', '--size', '320x180', '--picture',
                              picture)
        self.assertEqual(self.needed(0), set(result['present']) - {self.site.front.chunk_name(0)})
        differs = np.abs(read_png(reference).astype(int) - read_png(picture).astype(int)).max(axis=2) > 8
        self.assertLess(differs.mean(), 1e-3)

    def test_missing_files(self):
        """Are named, and all others are there."""
        pages = sorted(name for name in self.needed(0) if name.startswith('pages'))
        image, = (name for name in self.needed(0) if name.endswith('.png'))
        server = self.serve(Plan(missing=[pages[0], image]))
        picture = self.path('missing.png')
        result, err = self.load(server, '--eye', '4,2,4', '--picture', picture, code=1)
        self.assertEqual([failure['name'] for failure in result['failed']], [pages[0], image])
        self.assertEqual(server.plan.asked[pages[0]], ATTEMPTS)
        lines = err.splitlines()
        self.assertEqual(len(lines), 2, err)
        for name, line in zip((pages[0], image), lines):
            self.assertRegex(line, rf'^{name}: HTTP status 404; .*\[client\.not-loaded\]$')
        self.assertFalse(result['complete'])
        self.assertEqual(self.needed(0) - {pages[0], image}, self.needed(0) & set(result['present']))
        self.assertTrue(os.path.exists(picture))

    def test_missing_chunk(self):
        """Without it no cell is known; a camera that waits for one goes on."""
        name, path = self.site.front.chunk_name(0), self.path('short.json')
        with open(path, 'w', encoding='utf-8') as file:
            json.dump({'path': [rooms_scene.eye(number) for number in (0, 1)]}, file)
        for camera in (['--eye', '4,2,4'], ['--walk', path, '--speed', 100, '--wait']):
            result, err = self.load(self.serve(Plan(missing=[name])), '--no-draw', *camera, code=1)
            self.assertEqual([failure['name'] for failure in result['failed']], [name])
            self.assertIsNone(result['first_cell'])
            self.assertEqual(len(err.splitlines()), 1, err)

    def test_another_front(self):
        """The server gets a new scene, and no longer has the pages of the old one."""
        folder, names = self.changed_pages(lambda number, data: with_other_names(data))
        server = self.serve(folder=folder)
        new = server.files['scene.front']
        server.changes['scene.front'] = [self.site.read('scene.front'), new]
        result, err = self.load(server, '--eye', '4,2,4', '--no-draw')
        self.assertEqual((result['fronts'], result['failed'], err), (2, [], ''))
        front = self.site.front
        pages = cell_at(self.site, (4, 2, 4)).pages.tolist()
        self.assertLessEqual({names[page] for page in pages}, set(result['present']))

    def test_front_damaged_on_its_way(self):
        """A front that is replaced while it is sent: the begin of one, the end of another."""
        good = self.site.read('scene.front')
        half = len(good) // 2
        server = self.serve()
        server.changes['scene.front'] = [good[:half] + bytes(len(good) - half), good[:half], b'', good]
        result, err = self.load(server, '--eye', '4,2,4', '--no-draw')
        self.assertEqual((result['errors'], result['refetches'], result['fronts'], err), (3, 3, 1, ''))

    def test_what_is_no_front(self):
        server = self.serve()
        for contents, code in ((b'<!DOCTYPE html>', 4), (bytes(100), 4), (None, 1)):
            with self.subTest(contents):
                server.files['scene.front'] = contents
                _, err = self.load(server, '--attempts', 2, '--no-draw', code=code)
                self.assertRegex(err, r'^http://[\d.:]+/scene\.front: .*; .* \[client\.front\]\n$')
        server.stop()
        _, err = self.load(server.url, '--attempts', 2, '--no-draw', code=1)
        self.assertIn('[client.front]', err)

    def test_cell_larger_than_the_limit(self):
        """Is loaded nevertheless."""
        result, _ = self.load(self.serve(), '--eye', '4,2,4', '--no-draw', '--memory', 0.01)
        self.assertTrue(result['complete'])
        self.assertGreater(result['memory_peak'], result['memory_limit'])

    def test_wrong_use(self):
        for arguments in (['--eye', '1,2'], ['--size', '0x9'], ['--memory', 0], ['--no-draw', '--picture', 'x.png'],
                          ['--eye', '1,2,3', '--walk', 'x.json'], ['--connections', 0]):
            with self.subTest(arguments):
                self.assertEqual(harness.run(self.program, 'http://127.0.0.1:9/', *arguments)[0], 2)
        for text in ('{', '[]', '{"path": []}', '{"path": [[1, 2]]}', '{"paths": 3}', '{"path": [[1, 2, 1e30]]}'):
            path = self.path('wrong.json')
            with open(path, 'w', encoding='utf-8') as file:
                file.write(text)
            with self.subTest(text):
                _, err = self.load(self.serve(), '--no-draw', '--walk', path, code=4)
                self.assertRegex(err, r'^[^\n]*wrong\.json: .*\[client\.path\]\n$')

    def test_benchmark(self):
        """Runs, over a connection that is not slow."""
        with socket.socket() as free:
            free.bind(('127.0.0.1', 0))
            port = free.getsockname()[1]
        server = self.serve()
        server.files = {f'rooms/{name}': data for name, data in server.files.items()}
        code, out, err = harness.run(
            sys.executable, os.path.join(harness.ROOT, 'tests', 'bench', 'bench_stream_client.py'), '--bin', harness.BIN,
            '--server', server.server_address[1], '--port', port, '--poses', 2, '--rate', 1000, '--round-trip', 1,
            f'rooms={self.site_folder}')
        self.assertEqual((code, err), (0, ''))
        self.assertRegex(out.splitlines()[-1], r'^rooms \| 2 \| (\d.*s / .*s \| \d.* KB / .* KB( \| )?){3}$')

    def reported(self, change):
        """Loads a site whose pages are changed, with hashes that are right. Returns the causes by number of a page that
        failed, and the pages that were needed."""
        folder, names = self.changed_pages(change)
        everywhere = self.path('everywhere.json')
        with open(everywhere, 'w', encoding='utf-8') as file:
            json.dump({'path': [rooms_scene.eye(number) for number in (0, ROOMS - 1)]}, file)
        result, err = self.load(self.serve(folder=folder), '--no-draw', '--walk', everywhere, '--speed', 250, '--wait',
                                '--memory', 16, code=1)
        numbers = {name: number for number, name in names.items()}
        self.assertEqual(len(err.splitlines()), len(result['failed']))
        for failure in result['failed']:
            self.assertNotIn('\n', failure['cause'])
        needed = {page for number in range(ROOMS) for page in cell_at(self.site, rooms_scene.eye(number)).pages.tolist()}
        return {numbers[failure['name']]: failure['cause'] for failure in result['failed']}, needed

    def unchanged(self, change, number):
        page = self.site.read(self.site.front.page_name(number))
        return change(number, page) == page

    def test_random_bytes(self):
        """Anywhere in a page. Some changes leave it a page."""
        def change(number, data):
            one, new = random.Random(number), bytearray(data)
            for _ in range(one.choice((1, 4, 32))):
                new[one.randrange(len(new))] = one.randrange(256)
            return bytes(new)
        causes, pages = self.reported(change)
        self.assertGreater(len(causes), len(pages) // 2)

    def test_other_json(self):
        """Each page has a wrong number or name in its JSON."""
        changes = [
            (rb'5126,"count":(\d+)', b'9'), (rb'5126,"count":(\d+)', b'1'), (rb'"count":(\d+)', b'0'),
            (rb'"byteLength":(\d+),"byteS', b'9'), (rb'"byteStride":(\d+)', b'3'), (rb'"POSITION":(\d+)', b'9'),
            (rb'"indices":(\d+)', b'0'),
            (rb'"sightcell":\[(\d+,\d+)', b'9'), (rb'"sightcell":\[\d+,(\d+)', b'1'), (rb'"mode":"(\w+)"', b'X'),
            (rb'"filter":"(\w+)"', b'X'), (rb'"componentType":(5126)', b'5'), (rb'"bufferView":(\d+)', b'9'),
            (rb'"(meshes)"', b'm'), (rb'"(primitives)"', b'p'), (rb'("POSITION":\d+)', b' '), (rb'(\{"asset")', b'[')]

        def change(number, data):
            pattern, filler = changes[number % len(changes)]
            return re.sub(pattern, lambda found: found[0].replace(found[1], (filler * len(found[1]))[:len(found[1])], 1), data)
        causes, pages = self.reported(change)
        same = {number for number in pages if self.unchanged(change, number)}
        self.assertLess(len(same), 3)
        well = [changes[number % len(changes)] for number in pages - same if number not in causes]
        self.assertFalse(well)
        self.assertEqual(len({number % len(changes) for number in pages}), len(changes))
