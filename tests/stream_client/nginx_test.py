"""Streamed scenes behind nginx with samples/stream_client/nginx.conf: its headers."""
import http.client
import json
import os
import unittest

import harness
import nginx_server
import rooms_scene
from harness import InFolder, read
from streamed_scene import open_site

ROOMS = 5
STRIDE = rooms_scene.SIZE + 1
IMMUTABLE = 'public, max-age=31536000, immutable'


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
                          ['pack', '--stream', scene, pvs, '-o', cls.site, '--page-size', 2048]):
            harness.must(harness.program('sightcell'), *arguments)
        cls.server = nginx_server.Nginx({'rooms': cls.site})
        cls.addClassCleanup(cls.server.stop)

    def setUp(self):
        self.connection = http.client.HTTPConnection('127.0.0.1', self.server.port, timeout=10)
        self.addCleanup(self.connection.close)

    def get(self, name, **headers):
        """Status, headers and body."""
        self.connection.request('GET', f'/rooms/{name}', headers={k.replace('_', '-'): v for k, v in headers.items()})
        answer = self.connection.getresponse()
        return answer.status, answer.headers, answer.read()

    def test_files_with_a_hash_are_immutable(self):
        kinds = {'glb': 'model/gltf-binary', 'cells': 'application/octet-stream', 'png': 'image/png', 'webp': 'image/webp'}
        seen = set()
        for name, size, _ in open_site(self.site).files():
            kind = name.rsplit('.', 1)[1]
            status, headers, body = self.get(name, Accept_Encoding='gzip')
            self.assertEqual((status, len(body), headers.get_all('Cache-Control'), headers['Content-Type']),
                             (200, size, [IMMUTABLE], kinds[kind]), name)
            self.assertIsNone(headers['Content-Encoding'])
            seen.add(kind)
        self.assertLessEqual({'glb', 'cells', 'png'}, seen)

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
