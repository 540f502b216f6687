"""libdraco brings a tinygltf of its own. Ours must not be visible, or the program calls the wrong one."""
import os
import re
import subprocess
import unittest

from harness import SETTINGS


def run(kind):
    return subprocess.run([SETTINGS[kind + '_program']], capture_output=True, text=True, errors='replace', timeout=120)


def exported_tinygltf(kind):
    symbols = subprocess.run([SETTINGS['nm'], '-D', '-C', '--defined-only', SETTINGS[kind + '_library']], capture_output=True, text=True,
                             check=True).stdout
    assert 'polygons_of' in symbols, 'nm sees no symbols at all'
    # clang exports friends of the class templates of std, whatever is hidden. tinygltf's comparisons of maps have some;
    # neither the import nor anything else calls those.
    friend = re.compile(r'\w+ W std::operator==\(std::_Rb_tree<')
    return [line for line in symbols.splitlines() if 'tinygltf::' in line and not friend.match(line)]


def bound_to_libdraco(kind):
    """Symbols of tinygltf that our library takes from libdraco."""
    program, library = SETTINGS[kind + '_program'], SETTINGS[kind + '_library']
    done = subprocess.run([program], capture_output=True, text=True, errors='replace', timeout=120,
                          env={**os.environ, 'LD_DEBUG': 'bindings', 'LD_BIND_NOW': '1'})
    pattern = re.compile(r'binding file \S*/%s \[0\] to \S*/libdraco\.\S* .*`(\S*)\'' % re.escape(os.path.basename(library)))
    bound = pattern.findall(done.stderr)
    assert any('draco' in symbol for symbol in bound), 'the loader says nothing of bindings'
    return [symbol for symbol in bound if 'tinygltf' in symbol]


class LinkOrder(unittest.TestCase):
    def test_hidden_symbols_load_draco_with_libdraco_first(self):
        done = run('hidden')
        self.assertEqual((done.returncode, done.stdout), (0, '3 plain, 16 compressed\n'), done.stderr)
        self.assertEqual(exported_tinygltf('hidden'), [])
        self.assertEqual(bound_to_libdraco('hidden'), [])

    def test_libdraco_is_first(self):
        needed = subprocess.run(['readelf', '-d', SETTINGS['hidden_program']], capture_output=True, text=True,
                                check=True).stdout
        self.assertLess(needed.index('libdraco'), needed.index('sightcell_test_shared_scene_hidden'))

    def test_exported_symbols_are_taken_from_libdraco(self):
        """What the rule is for, whether that ends well or not. Were there none, libdraco would bring no other tinygltf
        any more."""
        self.assertNotEqual(exported_tinygltf('exported'), [])
        self.assertTrue(any('LoadASCIIFromString' in symbol for symbol in bound_to_libdraco('exported')))
