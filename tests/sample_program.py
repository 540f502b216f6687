"""What the tests of the samples share: how programs are run, a folder for a class of tests, the exit code.

A test file defines classes of tests and calls main() with the names of its options, each of which takes a program.
"""
import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAMS = argparse.Namespace()  # filled by main
TIMEOUT = 280  # seconds; the longest run here takes a few


def run(program, *arguments, display=None):
    """Exit code, standard output, standard error. The program sees no display but the given one."""
    environment = {k: v for k, v in os.environ.items() if k not in ('DISPLAY', 'WAYLAND_DISPLAY')}
    if display:
        environment['DISPLAY'] = display
    done = subprocess.run([program, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=TIMEOUT, env=environment)
    return done.returncode, done.stdout, done.stderr


class InFolder(unittest.TestCase):
    """A folder of its own."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='sightcell-sample-')
        cls.addClassCleanup(shutil.rmtree, cls.folder)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def must(cls, *command):
        code, _, err = run(*command)
        if code == 1 and '[gl.' in err:
            raise unittest.SkipTest('no EGL device: ' + err)
        if code != 0:
            raise RuntimeError(f'{command}: {code}\n{err}')

    @classmethod
    def make_city(cls, name, *more):
        """A small town, the same each time."""
        scene = cls.path(name)
        cls.must(PROGRAMS.city, '--polygons', 3000, '--seed', 1, '--out', scene, *more)
        return scene


def main(*names):
    """Exit code 77: every test was skipped."""
    parser = argparse.ArgumentParser()
    for name in names:
        parser.add_argument('--' + name, required=True)
    _, rest = parser.parse_known_args(namespace=PROGRAMS)
    result = unittest.main(module='__main__', argv=[sys.argv[0], *rest], exit=False, verbosity=2).result
    if not result.wasSuccessful():
        sys.exit(1)
    # A class that is skipped as a whole has run no test.
    sys.exit(77 if len(result.skipped) >= max(result.testsRun, 1) else 0)
