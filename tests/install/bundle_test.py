"""The bundle: all it loads but glibc comes from inside; it runs in a root where nothing else is; hosts build on it."""
import os
import re
import shutil
import subprocess
import unittest

import installed
from installed import GOLDEN_ANSWER, build, golden, install, needed, run

# What the machine has to bring. The rule of make_bundle.cmake.in, said once more on purpose.
GLIBC = re.compile(r'(ld-linux[-\w]*|lib(c|m|mvec|pthread|dl|rt|util|resolv))\.so(\.\d+)?')
MACHINE_VENDORS = ('/etc/glvnd/egl_vendor.d', '/usr/share/glvnd/egl_vendor.d')
QUICK_BAKE = ['--cell-limit', '4', '--samples', '6', '--resolution', '64', '--max-pixel-error', '1e-2']
IN_NEW_NAMESPACE = ['unshare', '--mount', '--propagation', 'private']


class Bundle(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        first = os.path.join(installed.ARGS.work, 'first')
        cls.said = install(first, 'bundle')
        cls.root = os.path.join(installed.ARGS.work, 'root')  # to be the / of a machine with nothing on it
        cls.prefix = os.path.join(cls.root, 'opt/moved')
        os.makedirs(os.path.dirname(cls.prefix))
        os.rename(first, cls.prefix)
        cls.vendor = os.path.join(cls.prefix, 'lib/sightcell/mesa/egl_vendor.d/90_sightcell_mesa.json')
        cls.program = os.path.join(cls.prefix, 'bin/sightcell')

    def needs_bake(self):
        if not installed.ARGS.bake:
            self.skipTest('this build has no bake half')

    def elf_files(self):
        for folder, _, names in os.walk(self.prefix):
            for name in names:
                path = os.path.join(folder, name)
                if not os.path.islink(path):
                    with open(path, 'rb') as file:
                        if file.read(4) == b'\x7fELF':
                            yield path

    def test_every_needed_library_is_inside(self):
        count = 0
        for path in self.elf_files():
            count += 1
            libraries, runpaths = needed(path)
            folders = [p for r in runpaths for p in r.split(':')]
            self.assertTrue(all(p.startswith('$ORIGIN') for p in folders), f'{path}: {folders}')
            for library in libraries:
                if not GLIBC.fullmatch(library):
                    places = [os.path.join(p.replace('$ORIGIN', os.path.dirname(path)), library) for p in folders]
                    self.assertTrue(any(map(os.path.exists, places)), f'{path} needs {library}')
        self.assertGreater(count, 20 if installed.ARGS.bake else 1)

    def test_licenses_are_there(self):
        self.assertNotIn('license', self.said)  # a warning when one is missing
        if installed.ARGS.bake:
            names = os.listdir(os.path.join(self.prefix, 'share/doc/sightcell-bundle'))
            self.assertIn('libstdc++6', names)
            self.assertIn('libepoxy0', names)
            self.assertTrue(os.path.exists(os.path.join(self.prefix, 'share/doc/sightcell-tools/THIRD_PARTY.md')))
            self.assertEqual(os.listdir(os.path.join(self.prefix, 'share/sightcell')), ['sightcell-blender-0.1.0.zip'])

    def test_hosts_build_on_it(self):
        libraries = os.path.join(self.prefix, installed.ARGS.libdir)
        for name, static, shared in (('c', 'runtime_consumer', 'runtime_shared_consumer'),
                                     ('cpp', 'my_game', 'my_game_shared')):
            folder, _ = build(name, self.prefix)
            for program in (static, shared):
                self.assertEqual(run(os.path.join(folder, program), golden()), GOLDEN_ANSWER)
            self.assertIn('libsightcell.so.1', needed(os.path.join(folder, shared))[0])
        flags = run('pkg-config', '--cflags', '--libs', 'sightcell',
                    env={'PKG_CONFIG_PATH': os.path.join(libraries, 'pkgconfig')})
        program = os.path.join(installed.ARGS.work, 'by_pkg_config')
        run(installed.ARGS.cc, os.path.join(installed.ARGS.source, 'tests/install/c/main.c'), '-o', program,
            *flags.split())
        self.assertEqual(run(program, golden(), env={'LD_LIBRARY_PATH': libraries}), GOLDEN_ANSWER)

    def loaded_while_baking(self, **variables):
        """What the loader opened, in that order; the scene is baked with nothing else in the environment."""
        scene = os.path.join(installed.ARGS.work, 'city.glb')
        log = os.path.join(installed.ARGS.work, 'log')
        subprocess.run([os.path.join(self.prefix, 'bin/sightcell-city'), '--polygons', '600', '--out', scene], env={},
                       check=True, stderr=subprocess.DEVNULL)
        subprocess.run([self.program, 'bake', scene, '-o', scene + '.pvs', '--fresh', '--source', 'gpu', *QUICK_BAKE],
                       check=True,
                       env={'LD_DEBUG': 'files', 'LD_DEBUG_OUTPUT': log, **variables}, stderr=subprocess.DEVNULL)
        (name,) = [n for n in os.listdir(installed.ARGS.work) if n.startswith('log.')]
        path = os.path.join(installed.ARGS.work, name)
        with open(path, encoding='utf-8') as file:
            files = re.findall(r'calling init: (.*)', file.read())
        os.remove(path)
        return [os.path.normpath(f) for f in files]

    def test_nothing_outside_is_loaded(self):
        self.needs_bake()
        files = self.loaded_while_baking(__EGL_VENDOR_LIBRARY_FILENAMES=self.vendor)
        self.assertGreater(len(files), 30)
        self.assertIn(os.path.join(self.prefix, 'lib/sightcell/mesa/dri/swrast_dri.so'), files)
        outside = [f for f in files if not f.startswith(self.prefix) and not GLIBC.fullmatch(os.path.basename(f))]
        self.assertEqual(outside, [])

    def test_the_machine_s_own_driver_comes_first(self):
        self.needs_bake()
        if not any(os.path.isdir(f) and os.listdir(f) for f in MACHINE_VENDORS):
            self.skipTest('this machine has no driver of its own')
        files = self.loaded_while_baking()
        vendors = [f for f in files if re.match(r'libEGL_.*\.so', os.path.basename(f))]
        self.assertFalse(vendors[0].startswith(self.prefix), vendors)
        self.assertTrue(vendors[-1].startswith(self.prefix), vendors)
        drivers = [f for f in files if '/dri/' in f]
        self.assertFalse(any(d.startswith(self.prefix) for d in drivers), drivers)

    def test_an_empty_root_is_enough(self):
        self.needs_bake()
        if os.geteuid() != 0:
            self.skipTest('only root may change the root')
        if subprocess.run([*IN_NEW_NAMESPACE, 'mount', '-t', 'tmpfs', 'none', self.root], check=False,
                          stderr=subprocess.DEVNULL).returncode != 0:
            self.skipTest('nothing may be mounted here')
        for folder in ('proc', 'tmp'):
            os.makedirs(os.path.join(self.root, folder))
        # glibc alone, where the programs look for it.
        loader = re.search(r'interpreter: (.*)\]', run('readelf', '-l', '-W', self.program, env={'LC_ALL': 'C'}))[1]
        libraries = {loader}
        for line in run('ldd', self.program).splitlines():
            path = line.split('=>')[-1].split('(')[0].strip()
            if GLIBC.fullmatch(os.path.basename(path)) and os.path.exists(path):
                libraries.add(path)
        beside = os.path.dirname(next(p for p in libraries if 'libc.so' in p))
        libraries |= {os.path.join(beside, n) for n in os.listdir(beside) if GLIBC.fullmatch(n)}
        for path in libraries:
            os.makedirs(os.path.dirname(self.root + path), exist_ok=True)
            shutil.copyfile(os.path.realpath(path), self.root + path)
            os.chmod(self.root + path, 0o755)

        def inside(program, *arguments, code=0, **variables):
            script = f'mount -t proc proc {self.root}/proc && exec chroot {self.root} "$@"'
            command = [*IN_NEW_NAMESPACE, 'sh', '-c', script, 'sh', '/opt/moved/bin/' + program, *arguments]
            done = subprocess.run(command, env={'PATH': os.environ['PATH'], **variables}, text=True, check=False,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            self.assertEqual(done.returncode, code, f'{program} {arguments}: {done.stdout}')
            return done.stdout

        inside('sightcell-city', '--polygons', '2000', '--out', '/tmp/c.glb')
        bake = ['bake', '/tmp/c.glb', '-o', '/tmp/c.pvs', *QUICK_BAKE]
        # Without any driver the rasterizer draws; with the bundle's own one OpenGL can be asked for.
        no_driver = {'__EGL_VENDOR_LIBRARY_FILENAMES': '/usr/local/nvidia/none.json'}
        self.assertIn('source cpu', inside('sightcell', *bake, **no_driver))
        # What the user says holds, also when there is nothing: the bundle's own driver is not put in its place.
        self.assertIn('[gl.no-context]', inside('sightcell', *bake, '--source', 'gpu', code=1, **no_driver))
        self.assertIn('llvmpipe', inside('sightcell', *bake, '--source', 'gpu'))
        self.assertIn(' cells, 2,000 polygons', inside('sightcell', 'info', '/tmp/c.pvs'))
        self.assertIn('passed', inside('sightcell', 'verify', '/tmp/c.glb', '/tmp/c.pvs', '--rays', '20000',
                                       '--max-pixel-error', '1e-2'))
        self.assertIn('overview.png', inside('sightcell-headless-walk', '/tmp/c.glb', '/tmp/c.pvs', '--frames', '2',
                                             '--out', '/tmp/walk'))
        self.assertIn('2000 polygons', inside('sightcell-hello-cull', '/tmp/c.pvs'))
