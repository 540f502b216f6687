"""libdraco brings a tinygltf of its own. Ours must not be visible, or the program calls the wrong one."""
import argparse
import subprocess
import sys
import unittest

OPTIONS = argparse.Namespace()


def run(kind):
    program = getattr(OPTIONS, kind)[0]
    return subprocess.run([program], capture_output=True, text=True, errors='replace', timeout=120)


def exported_tinygltf(kind):
    library = getattr(OPTIONS, kind)[1]
    symbols = subprocess.run([OPTIONS.nm, '-D', '-C', '--defined-only', library], capture_output=True, text=True,
                             check=True).stdout
    assert 'polygons_of' in symbols, 'nm sees no symbols at all'
    return [line for line in symbols.splitlines() if 'tinygltf::' in line]


class LinkOrder(unittest.TestCase):
    def test_hidden_symbols_load_draco_with_libdraco_first(self):
        done = run('hidden')
        self.assertEqual((done.returncode, done.stdout), (0, '3 plain, 16 compressed\n'), done.stderr)
        self.assertEqual(exported_tinygltf('hidden'), [])

    def test_libdraco_is_first(self):
        needed = subprocess.run(['readelf', '-d', OPTIONS.hidden[0]], capture_output=True, text=True,
                                check=True).stdout
        self.assertLess(needed.index('libdraco'), needed.index('sightcell_test_shared_scene_hidden'))

    def test_exported_symbols_go_wrong(self):
        """What the rule is for. Were this to pass, libdraco would bring no other tinygltf any more."""
        self.assertNotEqual(exported_tinygltf('exported'), [])
        done = run('exported')
        self.assertNotEqual(done.returncode, 0, done.stdout)
        print(f'with exported symbols: exit {done.returncode}, {(done.stdout + done.stderr).strip()!r}',
              file=sys.stderr)


if __name__ == '__main__':
    parser = argparse.ArgumentParser()
    parser.add_argument('--nm', required=True)
    parser.add_argument('--hidden', nargs=2, required=True)
    parser.add_argument('--exported', nargs=2, required=True)
    parser.parse_args(namespace=OPTIONS)
    unittest.main(argv=sys.argv[:1], verbosity=2)
