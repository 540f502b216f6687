"""THIRD_PARTY.md against what the built programs and libraries name and the sources include."""
import os
import re
import unittest

import check_layering  # which files are looked at, and what is of the platform
import installed
from installed import needed

TOOLCHAIN = re.compile(r'(ld-linux[-\w]*|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s|atomic))\.so(\.\d+)?')


def table(text, first_column, width):
    """The rows of the table that begins with this column."""
    lines = iter(text.split('\n'))
    for line in lines:
        cells = [c.strip() for c in line.strip('|').split('|')]
        if cells[0] == first_column and len(cells) == width[0] and cells[1] == width[1]:
            next(lines)
            break
    rows = []
    for line in lines:
        if not line.startswith('|'):
            break
        rows.append([c.strip() for c in line.strip('|').split('|')])
    return rows


class ThirdParty(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(os.path.join(installed.ARGS.source, 'THIRD_PARTY.md'), encoding='utf-8') as file:
            text = file.read()
        cls.licenses = {row[0]: row[1] for row in table(text, 'library', (4, 'license'))}
        cls.rows = table(text, 'library', (4, 'shared library'))

    def test_every_library_has_a_license_and_a_use(self):
        self.assertGreater(len(self.rows), 10)
        self.assertEqual(sorted(self.licenses), sorted(row[0] for row in self.rows))
        self.assertTrue(all(self.licenses.values()))

    def test_what_is_linked_is_listed(self):
        listed = {}  # binary -> names of shared libraries
        for _, library, _, binaries in self.rows:
            for binary in binaries.split(', '):
                listed.setdefault(binary, set())
                if library.startswith('lib'):
                    listed[binary].add(library)
        opened = [binaries for _, library, _, binaries in self.rows if library == 'opened']
        files = {n: os.path.join(installed.ARGS.build, 'bin', n)
                 for n in os.listdir(os.path.join(installed.ARGS.build, 'bin'))
                 if re.match(r'sightcell(-(?!test)|$)', n)}
        files['libsightcell.so'] = os.path.join(installed.ARGS.build, 'lib/libsightcell.so')
        self.assertGreater(len(files), 4 if installed.ARGS.bake else 0)
        for binary, path in files.items():
            with self.subTest(binary):
                really = {n.split('.so')[0] for n in needed(path)[0] if not TOOLCHAIN.fullmatch(n)}
                if any(binary in o.split(', ') for o in opened):
                    really -= {'libEGL', 'libGL', 'libOpenGL'}  # some linkers keep what nobody calls
                self.assertEqual(really, listed.get(binary, set()), f'{binary}: really linked, against THIRD_PARTY.md')

    def test_what_is_included_is_listed(self):
        names = [name for row in self.rows if row[2] != '-' for name in row[2].split(', ')]
        seen = set()
        for path in check_layering.source_files(installed.ARGS.source):
            with open(os.path.join(installed.ARGS.source, path), encoding='utf-8') as file:
                for line in file:
                    match = check_layering.INCLUDE.match(line)
                    if not match or match[1] != '<' or match[2].startswith(('sightcell/', *check_layering.PLATFORM)):
                        continue
                    if not check_layering.is_standard(match[2]):
                        fitting = [n for n in names if match[2].startswith(n)]
                        self.assertEqual(len(fitting), 1, f'{path} includes <{match[2]}>: not in THIRD_PARTY.md')
                        seen |= set(fitting)
        self.assertEqual(sorted(seen), sorted(names), 'included by no file')
