"""Which source of hemicubes a bake takes, and what it loads for it."""
import json
import os

from harness import QUICK_BAKE, InRoom, read, run, sightcell


class Sources(InRoom):
    """--source on machines with and without EGL. No EGL: libEGL is told to look for drivers in an empty folder."""

    def setUp(self):
        self.no_egl = {'__EGL_VENDOR_LIBRARY_DIRS': self.path('empty'), '__EGL_VENDOR_LIBRARY_FILENAMES': ''}
        os.makedirs(self.path('empty'), exist_ok=True)

    def bake(self, output, *more, environment=None):
        if os.path.exists(output):
            os.remove(output)
        return sightcell('bake', self.room, '-o', output, '--cells-file', self.cells, '--json', *QUICK_BAKE, *more,
                   environment=environment)

    def has_gpu(self):
        code, _, err = self.bake(self.path('probe.pvs'), '--source', 'gpu')
        if code == 0:
            return True
        self.assert_one_error_line(err, 'gl.no-context')
        return False

    def test_the_source_is_named_everywhere(self):
        for source in ['cpu', 'rays'] + ['gpu'] * self.has_gpu():
            file = self.path(f'{source}.pvs')
            code, out, err = self.bake(file, '--source', source)
            self.assertEqual(code, 0, err)
            summary = json.loads(out)
            self.assertEqual(summary['source'], source)
            self.assertIn(f"device: {summary['device']}, source {source}\n", err)
            settings = json.loads(self.expect(0, 'info', file, '--json')[0])['settings']
            self.assertEqual((settings['source'], settings['device']), (source, summary['device']))

    def test_without_egl_all_but_gpu_bake_the_same_bytes(self):
        for source in ('cpu', 'rays'):
            with_egl, without = self.path('with.pvs'), self.path('without.pvs')
            self.assertEqual(self.bake(with_egl, '--source', source)[0], 0)
            code, _, err = self.bake(without, '--source', source, environment=self.no_egl)
            self.assertEqual(code, 0, err)
            self.assertEqual(read(with_egl), read(without), source)
        # Unasked as well, with no word but the note.
        code, out, err = self.bake(without, environment=self.no_egl)
        self.assertEqual((code, json.loads(out)['source']), (0, 'cpu'), err)
        self.assertIn('source cpu (no hardware GPU was found)', err)
        self.assertNotIn('warning', err)
        self.assertEqual(err.count('EGL'), 0, err)
        code, _, err = self.bake(self.path('gpu.pvs'), '--source', 'gpu', environment=self.no_egl)
        self.assertEqual(code, 1)
        self.assert_one_error_line(err, 'gl.no-context')

    def test_only_gpu_and_auto_load_egl(self):
        """By the dynamic loader's own word. The others have to run where there is no EGL."""
        def loads_egl(source):
            stem = self.path(f'loader-{source}')
            self.bake(self.path('loaded.pvs'), '--source', source,
                      environment={'LD_DEBUG': 'files', 'LD_DEBUG_OUTPUT': stem})
            words = [read(self.path(name)).decode() for name in os.listdir(self.folder)
                     if name.startswith(os.path.basename(stem) + '.')]
            if not any('libtbb' in text for text in words):
                self.skipTest('this loader does not say what it loads')
            return any('libEGL' in text for text in words)

        if not loads_egl('gpu'):
            self.skipTest('there is no libEGL')
        self.assertTrue(loads_egl('auto'))
        self.assertFalse(loads_egl('cpu'))
        self.assertFalse(loads_egl('rays'))
