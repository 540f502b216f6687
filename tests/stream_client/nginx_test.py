"""Streamed scenes behind nginx with samples/stream_client/nginx.conf: headers, and the benchmarks of walks and of the server."""
import http.client
import json
import os
import random
import unittest

import bench_stream_walks
import harness
import nginx_server
import numpy as np
import result_files
import rooms_scene
from harness import InFolder, read
from painted_images import png
from stream_walks import Cells
from streamed_scene import cell_at, decoded, open_site

ROOMS = 5
STRIDE = rooms_scene.SIZE + 1
IMMUTABLE = 'public, max-age=31536000, immutable'
TYPES = {'glb': 'model/gltf-binary', 'gltf': 'model/gltf+json', 'json': 'application/json'}
BENCH = os.path.join(harness.ROOT, 'tests', 'bench')


class BehindNginx(InFolder):
    """Rooms in a row, whose cells touch."""

    @classmethod
    def setUpClass(cls):
        if nginx_server.PROGRAM is None:
            raise unittest.SkipTest('nginx is not installed (scripts/bootstrap --tests)')
        super().setUpClass()
        harness.program_or_skip('sightcell-stream-client')
        scene, cells, pvs, cls.site = map(cls.path, ('rooms.gltf', 'cells.json', 'rooms.pvs', 'site'))
        rooms_scene.write_rooms(scene, ROOMS)
        boxes = [{'min': [STRIDE * i - 0.5, 1.2, 1], 'max': [STRIDE * i + STRIDE - 0.5, 3, 7]} for i in range(ROOMS)]
        with open(cells, 'w', encoding='utf-8') as out:
            json.dump({'cells': boxes}, out)
        for arguments in (['bake', scene, '-o', pvs, '--importance', '--progress', 'none', '--cells-file', cells,
                           *harness.QUICK_BAKE],
                          ['pack', '--stream', scene, pvs, '-o', cls.site, '--page-size', 2048, '--tileset', '--compress', 'brotli']):
            harness.must(harness.program('sightcell'), *arguments)
        cls.server = nginx_server.Nginx({'rooms': cls.site})
        cls.addClassCleanup(cls.server.stop)

    def setUp(self):
        self.connection = http.client.HTTPConnection('127.0.0.1', self.server.port, timeout=10)
        self.addCleanup(self.connection.close)

    def get(self, name, connection=None, **headers):
        """Status, headers and body."""
        connection = connection or self.connection
        connection.request('GET', f'/rooms/{name}', headers={k.replace('_', '-'): v for k, v in headers.items()})
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()

    def load(self, url, *more):
        """What the client prints."""
        code, out, err = harness.run(harness.program('sightcell-stream-client'), url, '--eye', '4,2,4', '--no-draw', '--json',
                                     '--list', *more)
        self.assertEqual((code, err), (0, ''))
        return json.loads(out)

    def bench(self, script, *arguments):
        """Rows that a benchmark writes."""
        results = self.path(f'results of {self.id()}')
        code, out, err = harness.run(os.path.join(BENCH, f'bench_{script}.py'), *arguments, '--results', results)
        harness.skip_without_egl(code, err)
        self.assertEqual(code, 0, f'{out}\n{err}')
        rows = result_files.read(os.path.join(results, f'{script}.csv'))[1]
        return [{key: float(value) for key, value in row.items() if key != 'scene'} for row in rows]

    def test_files_with_a_hash_are_immutable(self):
        kinds = {'glb': 'model/gltf-binary', 'cells': 'application/octet-stream', 'png': 'image/png', 'webp': 'image/webp'}
        seen = set()
        for name, size, _ in open_site(self.site).files():
            kind = name.rsplit('.', 1)[1]
            status, headers, body = self.get(name)
            self.assertEqual((status, len(body), headers.get_all('Cache-Control'), headers['Content-Type']),
                             (200, size, [IMMUTABLE], kinds[kind]), name)
            self.assertIsNone(headers['Content-Encoding'])
            seen.add(kind)
        self.assertLessEqual({'glb', 'cells', 'png'}, seen)

    def assert_encoded(self, connection, accepted, encoding):
        """Pages and tiles are sent with this encoding, and all else as it is."""
        compressed = 0
        tiles = [f'tiles/{name}' for name in os.listdir(os.path.join(self.site, 'tiles')) if name.endswith('.gltf')]
        for name in [*(name for name, _, _ in open_site(self.site).files()), *tiles, 'tileset.json', 'scene.front']:
            file, (status, headers, body) = read(os.path.join(self.site, *name.split('/'))), self.get(
                name, connection, Accept_Encoding=accepted)
            self.assertEqual(status, 200)
            changes = name in ('tileset.json', 'scene.front')
            self.assertEqual(headers.get_all('Cache-Control'), ['no-cache' if changes else IMMUTABLE])
            if headers['Content-Encoding'] is None:
                self.assertFalse(name.endswith(('.glb', '.gltf', '.json')), name)
                self.assertEqual(body, file)
                continue
            self.assertEqual((headers['Content-Encoding'], headers['Vary']), (encoding, 'Accept-Encoding'))
            self.assertEqual(headers['Content-Type'], TYPES[name.rsplit('.', 1)[1]])
            self.assertLess(len(body), len(file))
            self.assertEqual(decoded(body, encoding), file)
            compressed += 1
        self.assertGreater(compressed, 2 * ROOMS)

    def test_pages_and_tiles_are_sent_compressed(self):
        self.assert_encoded(self.connection, 'gzip', 'gzip')
        self.assert_encoded(self.connection, 'gzip, deflate, br, zstd', 'gzip')  # nginx without the module

    def brotli_server(self):
        if not os.path.exists(nginx_server.BROTLI):
            self.skipTest('libnginx-mod-http-brotli-static is not installed (scripts/bootstrap --tests)')
        server = nginx_server.Nginx({'rooms': self.site}, brotli=True)
        self.addCleanup(server.stop)
        return server

    def test_brotli_is_preferred(self):
        server = self.brotli_server()
        connection = http.client.HTTPConnection('127.0.0.1', server.port, timeout=10)
        self.addCleanup(connection.close)
        self.assert_encoded(connection, 'gzip, deflate, br, zstd', 'br')
        self.assert_encoded(connection, 'gzip', 'gzip')
        self.assertIsNone(self.get(open_site(self.site).front.page_name(0), connection)[1]['Content-Encoding'])

    def test_client_loads_compressed_pages(self):
        """It counts the bytes that are sent, and has the same files."""
        site = open_site(self.site)
        for server, accepted in ((self.server, {'gzip'}), (self.brotli_server(), {'gzip', 'br'})):
            got = self.load(server.url('rooms'), '--save', self.path('saved'))
            self.assertEqual((got['complete'], got['errors']), (True, 0))
            for name in got['present']:
                self.assertEqual(read(os.path.join(self.path('saved'), *name.split('/'))), site.read(name))
            sent = sum(site.sent_bytes(name, accepted) for name in ['scene.front', *got['present']])
            headers = (got['bytes'] - sent) / got['requests']
            self.assertTrue(150 < headers < 600, headers)

    def test_client_uses_http2(self):
        """Over one connection of TLS, it has the same files. Without the certificate it has none, and says why."""
        server = nginx_server.Nginx({'rooms': self.site}, http2=True)
        self.addCleanup(server.stop)
        plain = self.load(self.server.url('rooms'))
        got = self.load(server.url('rooms'), '--authorities', server.authority)
        self.assertEqual((plain['http2'], got['http2'], got['complete'], got['errors']), (False, True, True, 0))
        self.assertEqual(sorted(got['present']), sorted(plain['present']))
        code, _, err = harness.run(harness.program('sightcell-stream-client'), server.url('rooms'), '--eye', '4,2,4', '--no-draw',
                                   '--attempts', 1)
        self.assertNotEqual(code, 0)
        self.assertIn('certificate', err)

    def test_front_is_validated(self):
        status, headers, body = self.get('scene.front')
        self.assertEqual((status, headers.get_all('Cache-Control'), body),
                         (200, ['no-cache'], read(os.path.join(self.site, 'scene.front'))))
        status, again, body = self.get('scene.front', If_None_Match=headers['ETag'])
        self.assertEqual((status, again['Cache-Control'], body), (304, 'no-cache', b''))
        os.utime(os.path.join(self.site, 'scene.front'), (1e9, 1e9))  # as another one of the same size
        status, other, _ = self.get('scene.front', If_None_Match=headers['ETag'])
        self.assertEqual(status, 200)
        self.assertNotEqual(other['ETag'], headers['ETag'])

    def test_errors_are_not_immutable(self):
        for name in ('pages/0123456789abcdef.glb', 'cells/0123456789abcdef.cells', 'other'):
            status, headers, _ = self.get(name)
            self.assertEqual((status, headers['Cache-Control']), (404, None), name)

    def test_walks_stay_in_cells(self):
        site = open_site(self.site)
        cells = Cells(site)
        self.assertEqual([len(doors) for doors in cells.doors], [1] + [2] * (ROOMS - 2) + [1])
        for seed in range(4):
            points = np.array(cells.walk(50, seed))
            self.assertEqual(points.tolist(), cells.walk(50, seed))
            self.assertAlmostEqual(np.linalg.norm(np.diff(points, axis=0), axis=1).sum(), 50, places=3)
            for a, b in zip(points, points[1:]):
                self.assertIsNotNone(cell_at(site, a + (b - a) * random.Random(seed).random()))

    def test_walks(self):
        row, = self.bench('stream_walks', '--bin', harness.BIN, '--walks', 1, '--seconds', 1.5, '--speeds', 20, '--site',
                          f'rooms={self.site}')
        self.assertGreaterEqual(row['cells_entered'], 1)
        self.assertGreater(row['bytes_per_cell'], 0)
        self.assertGreater(row['pictures'], 0)
        self.assertLessEqual(row['missing_percent'], row['pending_percent'])

    def recorded(self, *names):
        """A folder with a walk: one file after the other, 50 ms apart."""
        folder = self.path(f'walks of {self.id()}')
        os.makedirs(os.path.join(folder, 'rooms-1.5-0'))
        with open(os.path.join(folder, 'rooms-1.5-0', 'requests.csv'), 'w', encoding='utf-8') as out:
            out.write('seconds,name\n' + ''.join(f'{i / 20},{name}\n' for i, name in enumerate(names)))
        return folder

    def test_server(self):
        site = open_site(self.site)
        names = [name for name, _, _ in site.files()][:18]
        row, = self.bench('stream_server', '--walks', self.recorded('scene.front', *names), '--connections', 10, '--visit', 2,
                          '--seconds', 2, '--site', f'rooms={self.site}')
        # 19 requests per connection and visit.
        self.assertTrue(0.2 < row['requests_per_second'] / 95 < 1.5, row)
        mean = sum(site.sent_bytes(name, {'gzip'}) for name in ['scene.front', *names]) / 19
        self.assertTrue(mean < row['bytes_per_second'] / row['requests_per_second'] < mean + 600, (row, mean))
        self.assertLessEqual(row['latency_50_ms'], row['latency_95_ms'])

    def test_server_lacks_a_file(self):
        walks = self.recorded('scene.front', 'pages/0123456789abcdef.glb')
        code, _, err = harness.run(os.path.join(BENCH, 'bench_stream_server.py'), '--walks', walks, '--connections', 2,
                                   '--visit', 0.2, '--seconds', 0.3, '--site', f'rooms={self.site}')
        self.assertEqual(code, 1)
        self.assertIn('the first one: /rooms/pages/0123456789abcdef.glb', err)


class Measures(InFolder):
    """What bench_stream_walks.py makes of frames and pictures."""

    def walk(self, *frames):
        """Frames: seconds, bytes, cell, unknown, pending, weight present of 4 sr. The walk is as old as the run."""
        walk = bench_stream_walks.Walk(self.path(self.id()), 'path.json', 1)
        with open(os.path.join(walk.folder, 'frames.csv'), 'w', encoding='utf-8') as out:
            out.write('seconds,walked_seconds,bytes,cell,unknown_cell,pending,missing,weight,weight_present\n')
            for seconds, received, cell, unknown, pending, present in frames:
                out.write(f'{seconds},{seconds},{received},{cell},{unknown},{pending},0,4,{present}\n')
        return walk

    def test_frames(self):
        of = self.walk((0, 100, '', 1, 1, 0), (1, 500, 7, 0, 1, 3), (2, 1000, 7, 0, 0, 4), (3, 1100, 8, 0, 1, 3),
                       (5, 1400, 8, 0, 1, 3.9999), (6, 1500, 8, 0, 0, 4), (7, 1500, 8, 1, 0, 4), (7.5, 1700, 7, 0, 0, 4),
                       (8, 2000, 9, 0, 0, 4), (9, 2100, 9, 0, 0, 4), (10, 9999, 10, 0, 0, 4)).measure(10)
        self.assertEqual((of['first_seconds'], of['first_bytes'], of['seconds'], of['bytes']), (2, 1000, 7, 1100))
        self.assertEqual((of['entered'], of['between']), (2, [100, 900]))
        self.assertEqual((of['pending'], of['missing']), (3.5, 2.5))  # 0.5 s in an unknown cell
        row = bench_stream_walks.row_of('x', 1, [of, of])
        self.assertEqual((row['bytes_per_second'], row['bytes_per_cell'], row['pending_percent']), (1100 / 7, 550, 50))

    def test_pictures(self):
        walk = self.walk()
        folder, *references = os.path.join(walk.folder, 'pictures'), self.path('first'), self.path('second')
        for at in (folder, *references):
            os.makedirs(at, exist_ok=True)
            for place in range(4):
                pixels = np.full((90, 160, 3), 100, np.uint8)
                if at == folder:
                    pixels[0, :(5, 20, 14, 15)[place]] += 9
                    pixels[1:3] += 8
                if at == references[1]:
                    pixels[3] += 9
                with open(os.path.join(at, f'{place:05}.png'), 'wb') as out:
                    out.write(png(pixels))
        measured = {'places': range(1, 4), 'pictures': 0, 'wrong': 0, 'wrong_pixels': 0.0}
        walk.compare(measured, references)
        self.assertEqual((measured['pictures'], measured['wrong']), (3, 2))
        self.assertAlmostEqual(measured['wrong_pixels'], 49 / 14400)
