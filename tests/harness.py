"""What tests in Python share: built programs, how they run, temporary folders, small scenes, bakes that are stopped.

conftest.py sets BIN and SETTINGS from the command line, before it imports a test.
"""
import base64
import glob
import json
import os
import shutil
import struct
import subprocess
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BIN = None  # the folder with the built programs
SETTINGS = {}  # what only CMake knows
TIMEOUT = 280  # seconds; a bake here takes a few
QUICK_BAKE = ['--samples', '8', '--resolution', '64', '--max-pixel-error', '1e-2']


def program(name):
    """The path of a program that every build with this test has."""
    path = os.path.join(BIN, name)
    if not os.path.exists(path):
        raise RuntimeError(f'{path} does not exist: build it, or name the folder with the programs by --bin')
    return path


def program_or_skip(name):
    """The path of a program that some builds leave out."""
    path = os.path.join(BIN, name)
    if not os.path.exists(path):
        raise unittest.SkipTest(f'no {name} in this build')
    return path


def run(path, *arguments, environment=None, display=None):
    """Exit code, standard output, standard error. environment: what changes in it, None removes. The program sees no
    display but the given one."""
    changes = {'DISPLAY': display, 'WAYLAND_DISPLAY': None, **(environment or {})}
    variables = {k: str(v) for k, v in {**os.environ, **changes}.items() if v is not None}
    done = subprocess.run([path, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          errors='surrogateescape', timeout=TIMEOUT, env=variables)
    return done.returncode, done.stdout, done.stderr


def sightcell(*arguments, **more):
    return run(program('sightcell'), *arguments, **more)


def must(path, *arguments):
    """Runs what a test needs. Skips where there is no OpenGL, else it has to end well."""
    code, _, err = run(path, *arguments)
    skip_without_egl(code, err)
    if code != 0:
        raise RuntimeError(f'{path} {arguments}: {code}\n{err}')


# Where Vulkan's loader looks for drivers.
VULKAN_MANIFESTS = ('/etc/vulkan/icd.d/lvp_icd*.json', '/usr/local/share/vulkan/icd.d/lvp_icd*.json',
                    '/usr/share/vulkan/icd.d/lvp_icd*.json')


def vulkan_on_cpu():
    """What makes Vulkan's loader choose Mesa's driver for the CPU (lavapipe), or skips."""
    manifests = [path for pattern in VULKAN_MANIFESTS for path in sorted(glob.glob(pattern))]
    if not manifests:
        raise unittest.SkipTest('no Vulkan driver for the CPU: ' + VULKAN_MANIFESTS[-1] + ' (mesa-vulkan-drivers)')
    return {'VK_ICD_FILENAMES': manifests[0], 'VK_DRIVER_FILES': manifests[0]}


def skip_without_xvfb():
    if shutil.which('Xvfb') is None:
        raise unittest.SkipTest('Xvfb is not installed')


def start_screen(add_cleanup, folder):
    """A virtual X server until the cleanup, or skips. folder: receives its picture. Returns its display."""
    skip_without_xvfb()
    ready, told = os.pipe()
    server = subprocess.Popen(['Xvfb', '-displayfd', str(told), '-screen', '0', '1024x768x24', '-nolisten', 'tcp',
                               '-fbdir', folder], stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, pass_fds=[told])
    os.close(told)
    add_cleanup(server.wait)
    add_cleanup(server.terminate)
    with os.fdopen(ready) as pipe:
        number = pipe.readline().strip()
    if not number:
        raise unittest.SkipTest('Xvfb does not start here')
    return ':' + number


def skip_without_egl(code, err):
    if code == 1 and '[gl.' in err:
        raise unittest.SkipTest('no EGL device: ' + err)


def new_folder(add_cleanup):
    """A temporary folder. add_cleanup: addCleanup of a test, or addClassCleanup of its class."""
    folder = tempfile.mkdtemp(prefix='sightcell-test-')
    add_cleanup(shutil.rmtree, folder)
    return folder


def read(path):
    with open(path, 'rb') as file:
        return file.read()


def write_city(path, *more, polygons):
    """A small town, the same each time."""
    must(program('sightcell-city'), '--polygons', polygons, '--seed', 1, '--out', path, *more)


def write_room(path, height=4, scenes=((0,),), **more):
    """A room of 8 x 4 x 8 m seen from inside: 12 polygons; 0 and 1 are the floor, about a tenth of the view each. Nodes 0
    and 1 are both the room; scenes: the nodes of each; more: of the document."""
    corners = [(x, y, z) for x in (0, 8) for y in (0, height) for z in (0, 8)]
    quads = [(0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6), (0, 4, 6, 2), (1, 3, 7, 5)]
    indices = [i for a, b, c, d in quads for i in (a, b, c, a, c, d)]
    binary = b''.join(struct.pack('<3f', *c) for c in corners) + struct.pack(f'<{len(indices)}H', *indices)
    document = {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': list(nodes)} for nodes in scenes],
        'nodes': [{'mesh': 0, 'name': 'room'}, {'mesh': 0, 'name': 'again'}],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0}, 'indices': 1}]}],
        'buffers': [{'byteLength': len(binary)}],
        'bufferViews': [{'buffer': 0, 'byteOffset': 0, 'byteLength': 96},
                        {'buffer': 0, 'byteOffset': 96, 'byteLength': len(binary) - 96}],
        'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 8, 'type': 'VEC3', 'min': [0, 0, 0],
                       'max': [8, height, 8]},
                      {'bufferView': 1, 'componentType': 5123, 'count': len(indices), 'type': 'SCALAR'}]}
    write_glb(path, {**document, **more}, binary)


def write_glb(path, document, binary):
    text = json.dumps(document).encode()
    text += b' ' * (-len(text) % 4)
    binary += b'\0' * (-len(binary) % 4)
    with open(path, 'wb') as out:
        out.write(struct.pack('<4sII', b'glTF', 2, 28 + len(text) + len(binary)))
        out.write(struct.pack('<I4s', len(text), b'JSON') + text + struct.pack('<I4s', len(binary), b'BIN\0') + binary)


def write_triangles(path, triangles, materials, **more):
    """One mesh with a primitive per triangle ((corners), material) of the origin and the three unit vectors."""
    binary = struct.pack('<12f', 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
    binary += b''.join(struct.pack('<3I', *corners) for corners, _ in triangles)
    accessors = [{'bufferView': 0, 'componentType': 5126, 'count': 4, 'type': 'VEC3', 'min': [0] * 3, 'max': [1] * 3}]
    accessors += [{'bufferView': 0, 'byteOffset': 48 + 12 * i, 'componentType': 5125, 'count': 3, 'type': 'SCALAR'}
                  for i in range(len(triangles))]
    document = {
        'asset': {'version': '2.0'}, 'scenes': [{'nodes': [0]}], 'nodes': [{'mesh': 0}], 'materials': materials,
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0}, 'indices': 1 + i, 'material': material}
                                   for i, (_, material) in enumerate(triangles)]}],
        'accessors': accessors, 'bufferViews': [{'buffer': 0, 'byteLength': len(binary)}],
        'buffers': [{'byteLength': len(binary), 'uri': 'data:application/octet-stream;base64,' +
                     base64.b64encode(binary).decode()}], **more}
    with open(path, 'w', encoding='utf-8') as out:
        json.dump(document, out)


def write_boxes(path, nodes):
    """A .glb of solid boxes: a node for each of ([(low, high), ...], marks), with the marks as extras.sightcell."""
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    binary, document = b'', {'asset': {'version': '2.0'}, 'scenes': [{'nodes': list(range(len(nodes)))}], 'nodes': [],
                             'meshes': [], 'accessors': [], 'bufferViews': []}
    for boxes, marks in nodes:
        corners = [(ends[i >> 2 & 1][0], ends[i >> 1 & 1][1], ends[i & 1][2]) for ends in boxes for i in range(8)]
        indices = [8 * box + i for box in range(len(boxes)) for a, b, c, d in quads for i in (a, c, b, a, d, c)]
        for kind, count, form, rows in ((5126, 3, 'VEC3', corners), (5125, 1, 'SCALAR', [(i,) for i in indices])):
            part = b''.join(struct.pack(f'<{count}{"f" if kind == 5126 else "I"}', *row) for row in rows)
            document['bufferViews'].append({'buffer': 0, 'byteOffset': len(binary), 'byteLength': len(part)})
            accessor = {'bufferView': len(document['accessors']), 'componentType': kind, 'count': len(rows), 'type': form}
            if form == 'VEC3':
                accessor.update(min=[min(row[i] for row in rows) for i in range(3)], max=[max(row[i] for row in rows) for i in range(3)])
            document['accessors'].append(accessor)
            binary += part
        last = len(document['accessors']) - 1
        document['nodes'].append({'mesh': len(document['meshes']), 'extras': {'sightcell': marks}})
        document['meshes'].append({'primitives': [{'attributes': {'POSITION': last - 1}, 'indices': last}]})
    document['buffers'] = [{'byteLength': len(binary)}]
    write_glb(path, document, binary)


def write_middle_cell(path):
    """The cell in the middle of the room."""
    with open(path, 'w', encoding='utf-8') as out:
        out.write('{"cells":[{"name":"middle","min":[3,1,3],"max":[5,2,5]}]}')


class InFolder(unittest.TestCase):
    """A folder for the tests of a class."""

    @classmethod
    def setUpClass(cls):
        cls.folder = new_folder(cls.addClassCleanup)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def make_city(cls, name, *more, polygons=3000):
        write_city(cls.path(name), *more, polygons=polygons)
        return cls.path(name)

    def expect(self, code, *arguments):
        """What sightcell prints when it ends with this exit code."""
        answer, out, err = sightcell(*arguments)
        if code != 1:
            skip_without_egl(answer, err)
        self.assertEqual(answer, code, f'{arguments}\n{out}\n{err}')
        return out, err

    def assert_one_error_line(self, err, identifier):
        lines = [line for line in err.splitlines() if line.startswith('sightcell: ')]
        self.assertEqual(len(lines), 1, err)
        self.assertTrue(lines[0].endswith(f'[{identifier}]'), lines[0])
        return lines[0]


class InRoom(InFolder):
    """With a room and a cell in its middle."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.room, cls.cells = cls.path('room.glb'), cls.path('cells.json')
        write_room(cls.room)
        write_middle_cell(cls.cells)


class Stopped(InRoom):
    """A bake of several cells, to be stopped."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.city = cls.make_city('city.glb', polygons=2000)

    # Enough to do for one thread: seconds are left after the first cell, for whoever comes to stop it.
    SAMPLES, RESOLUTION = 96, 512

    def command(self, output, *more):
        return ['bake', self.city, '-o', output, '--cell-limit', '8', '--samples', str(self.SAMPLES), '--resolution',
                str(self.RESOLUTION), '--quality', 'draft', '--threads', '1', '--progress', 'json', *more]

    def start(self, output, *more, before=None):
        """A running bake with at least one cell finished by this very run; before: called in its process first."""
        running = subprocess.Popen([program('sightcell'), *self.command(output, *more)], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=before)
        self.addCleanup(running.stderr.close)
        said, resumed = '', 0
        for line in running.stderr:
            said += line
            if 'resuming: ' in line:
                resumed = int(line.split('resuming: ')[1].split()[0])
            if line.startswith('{') and json.loads(line)['cells'] > resumed:
                return running
        code = running.wait()
        skip_without_egl(code, said)
        self.fail(f'exit code {code} before the first cell\n{said}')

    def stop(self, output, number):
        running = self.start(output)
        running.send_signal(number)
        running.communicate(timeout=TIMEOUT)
        self.assertFalse(os.path.exists(output), 'a stopped bake has no output')
        self.assertTrue(os.path.exists(output + '.bake'), 'a stopped bake has a checkpoint')
        return running.returncode

    def whole(self):
        """The bytes of a bake that nobody stopped."""
        output = self.path('whole.pvs')
        if not os.path.exists(output):
            self.expect(0, *self.command(output))
        return read(output)

    def assert_resumes(self, output, after=1):
        """After so many stops, each of which left a cell at least."""
        out, err = self.expect(0, *self.command(output, '--json'))
        self.assertGreaterEqual(json.loads(out)['cells_resumed'], after)
        self.assertIn('resuming', err)
        self.assertEqual(read(output), self.whole())
        self.assertEqual([n for n in os.listdir(self.folder) if n.startswith(os.path.basename(output) + '.')], [])
