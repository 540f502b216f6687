"""Hosts in C and C++ are built against an installed prefix, before and after the prefix was moved."""
import os
import shlex
import unittest

import installed
from installed import GOLDEN_ANSWER, build, configure, golden, install, needed, run


class Prefix(unittest.TestCase):
    components = ()

    @classmethod
    def setUpClass(cls):
        """Everything is looked at in a place it was not installed to."""
        first = os.path.join(installed.ARGS.work, cls.__name__ + '_first')
        cls.prefix = os.path.join(installed.ARGS.work, cls.__name__)
        install(first, *cls.components)
        cls.in_first_place = build('c', first) if not cls.components else None
        os.rename(first, cls.prefix)
        cls.libraries = os.path.join(cls.prefix, installed.ARGS.libdir)

    def answers(self, program, shared):
        text = run(program, golden(), env={'LD_LIBRARY_PATH': self.libraries} if shared else {})
        self.assertEqual(text, GOLDEN_ANSWER)
        self.assertEqual('libsightcell.so.1' in needed(program)[0], shared)


class Everything(Prefix):
    def test_cmake_finds_what_was_moved(self):
        folder, _ = self.in_first_place
        self.answers(os.path.join(folder, 'runtime_consumer'), shared=False)
        for name, static, shared in (('c', 'runtime_consumer', 'runtime_shared_consumer'),
                                     ('cpp', 'my_game', 'my_game_shared')):
            with self.subTest(name):
                folder, _ = build(name, self.prefix)
                self.answers(os.path.join(folder, static), shared=False)
                self.answers(os.path.join(folder, shared), shared=True)

    def test_pkg_config_finds_what_was_moved(self):
        where = {'PKG_CONFIG_PATH': os.path.join(self.libraries, 'pkgconfig')}
        self.assertEqual(run('pkg-config', '--modversion', 'sightcell', env=where), '0.1.0\n')
        sources = os.path.join(installed.ARGS.source, 'tests/install')
        for name, compiler in (('c/main.c', [installed.ARGS.cc, '-std=c11']),
                               ('cpp/main.cpp', [installed.ARGS.cxx, '-std=c++20'])):
            for kind in ([], ['-static']):
                with self.subTest(name, kind=kind):
                    flags = run('pkg-config', '--cflags', '--libs', *['--static'][:len(kind)], 'sightcell', env=where)
                    program = os.path.join(installed.ARGS.work, 'pc_' + os.path.basename(name) + ''.join(kind))
                    run(*compiler, '-Wall', '-Werror', *kind, os.path.join(sources, name), '-o', program,
                        *shlex.split(flags))
                    self.answers(program, shared=not kind)

    def test_nothing_names_a_place_of_the_build(self):
        seen = 0
        places = [installed.ARGS.work, installed.ARGS.build, installed.ARGS.source]
        if installed.ARGS.libdir == 'lib':
            places.append('/usr/')  # a build for /usr asks whether /lib is /usr/lib
        for folder, _, names in os.walk(self.prefix):
            for name in names:
                if name.endswith(('.cmake', '.pc', '.h', '.hpp')):
                    seen += 1
                    with open(os.path.join(folder, name), encoding='utf-8') as file:
                        text = file.read()
                    for place in places:
                        self.assertNotIn(place, text, name)
        self.assertGreater(seen, 6)

    def test_versions(self):
        folder = os.path.join(installed.ARGS.work, 'wants_other_version')
        write_project(folder, 'find_package(sightcell ${wanted} REQUIRED)')
        configure(folder, self.prefix, '-Dwanted=0.1')
        _, text = configure(folder, self.prefix, '-Dwanted=1.0', code=1)
        self.assertIn('compatible with requested version "1.0"', text)

    def test_clients_of_streamed_scenes(self):
        if not installed.ARGS.bake:
            self.skipTest('this build has no library for streamed scenes')
        folder, _ = build('stream', self.prefix)
        self.assertEqual(run(os.path.join(folder, 'stream_consumer')), 'values of the file contradict each other\n')
        _, text = configure(os.path.join(installed.ARGS.source, 'tests/install/stream'), self.prefix,
                            '-DCMAKE_DISABLE_FIND_PACKAGE_ZLIB=ON', code=1)
        self.assertIn("component 'stream' needs ZLIB (Debian: zlib1g-dev), not found", text)

    def test_bake_half(self):
        if not installed.ARGS.bake:
            self.skipTest('this build has no bake half')
        folder, text = build('bake', self.prefix)
        self.assertIn('0.1.0', text)  # of the imported programs
        self.assertIn('Usage: sightcell-city', text)
        scene = os.path.join(folder, 'c.glb')
        run(os.path.join(self.prefix, 'bin/sightcell-city'), '--polygons', '600', '--out', scene)
        text = run(os.path.join(folder, 'bake_consumer'), scene)
        self.assertIn('polygons 600\n', text)
        self.assertIn('samples', text)  # the message of the wrong setting
        _, text = configure(os.path.join(installed.ARGS.source, 'tests/install/bake'), self.prefix,
                            '-DCMAKE_DISABLE_FIND_PACKAGE_embree=ON', code=1)
        self.assertIn("component 'bake' needs embree (Debian: libembree-dev), not found", text)


class RuntimeAlone(Prefix):
    components = ('runtime', 'dev')

    def test_it_is_enough_for_a_host(self):
        folder, _ = build('c', self.prefix)
        self.answers(os.path.join(folder, 'runtime_shared_consumer'), shared=True)
        self.assertFalse(os.path.exists(os.path.join(self.prefix, 'bin')))
        self.assertEqual(sorted(os.listdir(os.path.join(self.prefix, 'include/sightcell'))),
                         ['casters.h', 'clusters.h', 'format', 'hosts', 'identity.h', 'lights.h', 'residency.h', 'sightcell.h', 'sightcell.hpp', 'viewpoints.h'])

    def test_asking_for_the_bake_half_says_what_is_missing(self):
        folder = os.path.join(installed.ARGS.work, 'wants_bake')
        write_project(folder, 'find_package(sightcell REQUIRED COMPONENTS runtime bake)')
        _, text = configure(folder, self.prefix, code=1)
        self.assertIn("component 'bake' is not installed in", text)
        self.assertIn('only the runtime is: install the component bake-dev', text)
        write_project(folder, 'find_package(sightcell COMPONENTS tools)\nmessage("found=${sightcell_FOUND}")')
        _, text = configure(folder, self.prefix)
        self.assertIn("component 'tools' is not installed in", text)
        self.assertIn('found=0', text)
        write_project(folder, 'find_package(sightcell REQUIRED COMPONENTS stream)')
        _, text = configure(folder, self.prefix, code=1)
        self.assertIn('install the component stream-dev (Debian: libsightcell-stream-dev)', text)
        write_project(folder, 'find_package(sightcell REQUIRED COMPONENTS sound)')
        _, text = configure(folder, self.prefix, code=1)
        self.assertIn("there is no component 'sound'", text)

    def test_the_bake_half_may_be_optional(self):
        folder = os.path.join(installed.ARGS.work, 'may_bake')
        write_project(folder, 'find_package(sightcell REQUIRED COMPONENTS runtime OPTIONAL_COMPONENTS bake)\n'
                              'message("found=${sightcell_FOUND} ${sightcell_runtime_FOUND} ${sightcell_bake_FOUND}")')
        _, text = configure(folder, self.prefix)
        self.assertIn('found=1 TRUE FALSE', text)


class Document(unittest.TestCase):
    def test_it_shows_the_project_that_is_built_here(self):
        with open(os.path.join(installed.ARGS.source, 'tests/install/cpp/CMakeLists.txt'), encoding='utf-8') as file:
            lines = file.read().split('\n# [tests')[0]
        with open(os.path.join(installed.ARGS.source, 'docs/packaging.md'), encoding='utf-8') as file:
            self.assertIn('```cmake\n' + lines + '```', file.read())


def write_project(folder, lines):
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, 'CMakeLists.txt'), 'w', encoding='utf-8') as file:
        file.write('cmake_minimum_required(VERSION 3.25)\nproject(consumer LANGUAGES C)\n' + lines + '\n')
