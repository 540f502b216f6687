"""The Debian packages: what they are called, need and contain; unpacked together they are a working prefix."""
import os
import shutil
import unittest

import installed
from installed import GOLDEN_ANSWER, build, golden, needed, run

RUNTIME, DEV, BAKE_DEV, TOOLS = 'libsightcell1', 'libsightcell-dev', 'libsightcell-bake-dev', 'sightcell-tools'
STREAM_DEV = 'libsightcell-stream-dev'


@unittest.skipUnless(all(map(shutil.which, ('dpkg-deb', 'dpkg-shlibdeps', 'file'))), 'no dpkg-dev, or no file')
class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = os.path.join(installed.ARGS.work, 'packages')
        run(os.path.join(os.path.dirname(installed.ARGS.cmake), 'cpack'), '-G', 'DEB', '-C', installed.ARGS.config,
            '-B', folder, cwd=installed.ARGS.build)
        files = [os.path.join(folder, n) for n in sorted(os.listdir(folder)) if n.endswith('.deb')]
        cls.files = {run('dpkg-deb', '-f', f, 'Package').strip(): f for f in files}
        cls.root = os.path.join(installed.ARGS.work, 'root')
        cls.contents = {}
        for name, file in cls.files.items():
            alone = os.path.join(installed.ARGS.work, name)
            for place in (alone, cls.root):
                run('dpkg-deb', '-x', file, place)
            cls.contents[name] = sorted(os.path.relpath(os.path.join(f, n), alone)
                                        for f, _, names in os.walk(alone) for n in names)

    def field(self, package, name):
        return run('dpkg-deb', '-f', self.files[package], name).strip()

    def names_in(self, package):
        return [os.path.basename(p) for p in self.contents[package]]

    def test_one_package_per_component(self):
        expected = [BAKE_DEV, DEV, STREAM_DEV, RUNTIME, TOOLS] if installed.ARGS.bake else [DEV, RUNTIME]
        self.assertEqual(sorted(self.files), expected)
        everything = [path for package in self.contents.values() for path in package]
        self.assertEqual(len(everything), len(set(everything)), 'two packages have the same file')
        for package in self.files:
            self.assertEqual(self.field(package, 'Version'), '0.1.0')
            self.assertEqual(self.field(package, 'Maintainer'), 'The Sightcell authors')
            synopsis, *text = self.field(package, 'Description').split('\n')
            self.assertTrue(synopsis.startswith('baked visibility for engines: '), synopsis)
            self.assertGreater(len(text), 3)
            self.assertTrue(all(len(line) < 80 for line in text), text)
            with open(os.path.join(self.root, f'usr/share/doc/{package}/copyright'), encoding='utf-8') as file:
                self.assertTrue(file.read().startswith('MIT License'))

    def test_runtime_needs_glibc_alone(self):
        self.assertRegex(self.field(RUNTIME, 'Depends'), r'^libc6 \(>= [\d.]+\)$')
        self.assertEqual(self.names_in(RUNTIME), ['libsightcell.so.1', 'libsightcell.so.1.0.0', 'copyright'])
        self.assertIn('libsightcell 1 libsightcell1 (>= 0.1.0)', run('dpkg-deb', '-I', self.files[RUNTIME], 'shlibs'))

    def test_dev_packages_need_what_they_are_linked_with(self):
        self.assertEqual(self.field(DEV, 'Depends'), 'libsightcell1 (= 0.1.0)')
        for name in ('libsightcell.so', 'libsightcell.a', 'sightcell.h', 'sightcell.pc', 'sightcell-config.cmake'):
            self.assertIn(name, self.names_in(DEV))
        if installed.ARGS.bake:
            self.assertIn('libsightcell-dev (= 0.1.0), libembree-dev', self.field(BAKE_DEV, 'Depends'))
            self.assertIn('bake.h', self.names_in(BAKE_DEV))
            self.assertIn('stream.h', self.names_in(STREAM_DEV))
            # Every package that the config file tells a Debian user to install comes with this one.
            for package, config, least in ((BAKE_DEV, 'bake/package/sightcell-bake.cmake', 10),
                                           (STREAM_DEV, 'runtime/stream/package/sightcell-stream.cmake', 3)):
                with open(os.path.join(installed.ARGS.source, config), encoding='utf-8') as file:
                    wanted = [w.rstrip(')') for line in file if line.startswith('sightcell_need')
                              for w in line.split() if w.rstrip(')').endswith(('-dev', 'pkg-config'))]
                self.assertGreaterEqual(len(wanted), least)
                for other in wanted:
                    self.assertIn(other, self.field(package, 'Depends').split(', '))

    def test_tools(self):
        if not installed.ARGS.bake:
            self.skipTest('this build has no bake half')
        self.assertIn('sightcell-blender-0.1.0.zip', self.names_in(TOOLS))
        self.assertIn('libsightcell1 (= 0.1.0)', self.field(TOOLS, 'Recommends'))  # of that add-on
        depends = self.field(TOOLS, 'Depends')
        for package in ('libegl1', 'libembree3-3', 'libtbb12', 'libepoxy0', 'libsqlite3-0', 'libstdc++6'):
            self.assertRegex(depends, r'(^|, )' + package.replace('+', r'\+'))
        for name in ('sightcell', 'sightcell-city'):
            program = os.path.join(self.root, 'usr/bin', name)
            self.assertEqual(needed(program)[1], [], 'a RUNPATH')
            self.assertNotIn('.symtab', run('readelf', '-S', '-W', program))
            self.assertIn(name, run(program, '--help'))
        self.assertEqual(run(os.path.join(self.root, 'usr/bin/sightcell'), '--version'), '0.1.0\n')

    def test_hosts_build_on_them(self):
        folder, _ = build('c', os.path.join(self.root, 'usr'))
        for program in ('runtime_consumer', 'runtime_shared_consumer'):
            self.assertEqual(run(os.path.join(folder, program), golden()), GOLDEN_ANSWER)
