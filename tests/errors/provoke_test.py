"""Provokes every error that a command line can reach: exit code, and one line that names the culprit and ends in [id].
"""
import inspect
import os
import resource
import subprocess
import unittest

import cases
from harness import TIMEOUT, new_folder, program


def limit_memory(size):
    if size:
        resource.setrlimit(resource.RLIMIT_AS, (size, size))


class Provoke(unittest.TestCase):
    """One test per case, made below."""

    def provoke(self, identifier, code, prepare):
        folder, sightcell = new_folder(self.addCleanup), program('sightcell')
        wants_program = len(inspect.signature(prepare).parameters) == 2
        call = prepare(folder, sightcell) if wants_program else prepare(folder)
        if call.memory and os.environ.get('SIGHTCELL_SANITIZE'):
            self.skipTest('sanitizers reserve more memory than this case may have')
        if call.slow and os.environ.get('SIGHTCELL_TEST_STEP'):
            self.skipTest('takes 5 seconds: scripts/test --all')
        if call.skip:
            self.skipTest(f'{identifier}: {call.skip}')
        with open(call.stdout or os.devnull, 'w', encoding='utf-8') as out:
            done = subprocess.run([*call.runner, call.program or sightcell, *call.arguments], stdin=subprocess.DEVNULL,
                                  stdout=out, stderr=subprocess.PIPE, text=True, timeout=TIMEOUT, cwd=folder,
                                  env={**os.environ, **call.environment},
                                  preexec_fn=lambda: limit_memory(call.memory))
        # Notes of a bake (its device, its cells) and warnings are no errors.
        lines = [line for line in done.stderr.splitlines() if line.startswith('sightcell: ')]
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertEqual(done.stderr.splitlines()[-1], lines[0], 'the error is the last line')
        self.assertTrue(lines[0].endswith(f'[{identifier}]'), lines[0])
        self.assertIn(call.named, lines[0])
        self.assertEqual(done.returncode, code, lines[0])


def add_tests():
    for number, (identifier, code, prepare) in enumerate(cases.CASES):
        name = f'test_{number:02}_{identifier.replace(".", "_").replace("-", "_")}'
        setattr(Provoke, name, lambda self, i=identifier, c=code, p=prepare: self.provoke(i, c, p))


add_tests()
