"""What provokes every error of bake/: a command line where one can, else the unit test that does.

CASES: (id, exit code, prepare); prepare(folder) makes the input inside the folder and returns a `call`.
UNIT_TESTS: id -> a test's source that mentions the id; for what no command line can reach.
"""
import base64
import dataclasses
import json
import os
import shutil
import sqlite3
import struct
import subprocess

UNIT_TESTS = {
    'bake.disk-space': 'tests/unit/bake/job/disk_space_test.cpp',
    'cells.not-finite': 'tests/unit/bake/cells/cells_file_test.cpp',
    'checkpoint.disk-full': 'tests/unit/bake/checkpoint/checkpoint_test.cpp',
    'checkpoint.failed': 'tests/unit/bake/checkpoint/checkpoint_test.cpp',
    'checkpoint.not-copied': 'tests/unit/bake/checkpoint/checkpoint_test.cpp',
    'checkpoint.other-version': 'tests/unit/bake/checkpoint/checkpoint_test.cpp',
    'cli.memory': 'tests/unit/cli/run_action_test.cpp',
    'cli.unexpected': 'tests/unit/cli/run_action_test.cpp',
    'embed.scene-changed': 'tests/cli/embed_test.py',
    'embed.too-large': 'tests/unit/scene/embed_test.cpp',
    'gl.bind': 'tests/unit/picture/gl_context_test.cpp',
    'gl.error': 'tests/unit/picture/gl_context_test.cpp',
    'gl.lost': 'tests/unit/picture/gl_context_test.cpp',
    'gl.shader': 'tests/unit/picture/gl_context_test.cpp',
    'gpu.scene-too-large': 'tests/unit/bake/hemicube/source_view_test.cpp',
    'hemicube.resolution': 'tests/unit/bake/hemicube/source_view_test.cpp',
    'host.bad-array': 'tests/unit/bake/input/host_scene_test.cpp',
    'host.no-colors': 'tests/unit/bake/input/host_scene_test.cpp',
    'output.encode': 'tests/unit/bake/verify/verify_test.cpp',
    'pack.too-large': 'tests/unit/scene/pack_test.cpp',
    'picture.camera': 'tests/unit/picture/picture_test.cpp',
    'picture.empty': 'tests/unit/picture/write_png_test.cpp',
    'picture.no-such-polygon': 'tests/unit/picture/picture_test.cpp',
    'picture.size': 'tests/unit/picture/compare_test.cpp',
    'picture.write': 'tests/unit/picture/write_png_test.cpp',
    'scene.draco': 'tests/unit/scene/compressed_test.cpp',
    'shard.damaged': 'tests/unit/bake/shards/shards_test.cpp',
    'shard.doubles-differ': 'tests/unit/bake/shards/shards_test.cpp',
    'shard.missing-blocks': 'tests/unit/bake/shards/shards_test.cpp',
    'shard.other-bake': 'tests/unit/bake/shards/shards_test.cpp',
    'settings.two-kinds-of-cells': 'tests/unit/bake/input/settings_test.cpp',
    'strip.too-large': 'tests/unit/scene/strip_test.cpp',
}

QUICK = ['--samples', '6', '--resolution', '16', '--max-pixel-error', '0']


@dataclasses.dataclass
class Call:
    arguments: list
    named: str  # the error line has to contain it: the file or option that is to blame
    environment: dict = dataclasses.field(default_factory=dict)
    memory: int = 0  # limit of the address space, bytes; 0: none
    slow: bool = False  # only in complete runs
    stdout: str = ''  # a file that standard output goes to
    program: str = ''  # another copy of the program
    keep: object = None  # lives until the program has ended
    runner: tuple = ()  # a command that starts the program
    skip: str = ''  # why this case cannot be provoked here


# --- inputs

def write(folder, name, content):
    path = os.path.join(folder, name)
    with open(path, 'wb') as out:
        out.write(content if isinstance(content, bytes) else content.encode())
    return path


def data_uri(content):
    return 'data:application/octet-stream;base64,' + base64.b64encode(content).decode()


def document(scale=1.0, inward=False, **more):
    """A closed box of 2 x 2 x 2 m around the origin; keys of `more` replace those of the document."""
    corners = [(x * scale, y * scale, z * scale) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    if inward:
        triangles = [(a, c, b) for a, b, c in triangles]
    binary = b''.join(struct.pack('<3f', *c) for c in corners)
    binary += b''.join(struct.pack('<3H', *t) for t in triangles)
    made = {'asset': {'version': '2.0'}, 'scenes': [{'nodes': [0]}], 'nodes': [{'mesh': 0, 'name': 'box'}],
            'meshes': [{'primitives': [{'attributes': {'POSITION': 0}, 'indices': 1}]}],
            'buffers': [{'byteLength': len(binary), 'uri': data_uri(binary)}],
            'bufferViews': [{'buffer': 0, 'byteLength': 96}, {'buffer': 0, 'byteOffset': 96, 'byteLength': 72}],
            'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 8, 'type': 'VEC3'},
                          {'bufferView': 1, 'componentType': 5123, 'count': 36, 'type': 'SCALAR'}]}
    made.update(more)
    return made


def scene(folder, name='scene.gltf', change=None, **more):
    made = document(**more)
    if change:
        change(made)
    return write(folder, name, json.dumps(made))


def room(folder):
    """A box that is seen from inside."""
    return scene(folder, 'room.gltf', scale=2.0, inward=True)


def cells(folder, content=None, name='cells.json', low=(-0.5, -0.5, -0.5), high=(0.5, 0.5, 0.5)):
    content = content or json.dumps({'cells': [{'name': 'middle', 'min': low, 'max': high}]})
    return write(folder, name, content)


# --- calls

def view_without_viewer(folder, program):
    """A copy of the program in a folder without a viewer, and no other folder to search."""
    return Call(['view', 'x.glb'], 'sightcell-viewer', environment={'PATH': folder},
                program=shutil.copy(program, os.path.join(folder, 'sightcell')))



def info(make):
    """`info` of what make(folder) writes."""
    def prepare(folder):
        path = make(folder)
        return Call(['info', path], path)
    return prepare


def info_of(change):
    return info(lambda folder: scene(folder, change=change))


def bake(folder, *more, scene_file=None, cells_file=None):
    return ['bake', scene_file or room(folder), '-o', os.path.join(folder, 'out.pvs'), '--cells-file',
            cells_file or cells(folder), *QUICK, *more]


def bake_with_path(content):
    """make(folder): a bake along the path of a file with this content, or one that content(folder) makes."""
    def make(folder):
        path = content(folder) if callable(content) else write(folder, 'path.json', content)
        return Call(['bake', room(folder), '-o', os.path.join(folder, 'out.pvs'), '--path', path, *QUICK], path)
    return make


def bake_with_cells(content, slow=False):
    def prepare(folder):
        path = content(folder) if callable(content) else cells(folder, content)
        return Call(bake(folder, cells_file=path), path, slow=slow)
    return prepare


def options(named, *given):
    def prepare(folder):
        return Call(['bake', room(folder), '-o', os.path.join(folder, 'out.pvs'), *given], named)
    return prepare


def option(name, value):
    return options(name, name, value)


def checkpoint(make):
    """A bake that finds make(path) where its checkpoint belongs."""
    def prepare(folder):
        path = os.path.join(folder, 'out.pvs.bake')
        keep = make(path)
        return Call(bake(folder), path, keep=keep)
    return prepare


def not_a_database(path):
    with open(path, 'wb') as out:
        out.write(b'SQLite format 3\0' + b'\xff' * 4080)


def foreign_database(path):
    with sqlite3.connect(path) as database:
        database.execute('CREATE TABLE song(name TEXT)')
    database.close()


def other_bake(path):
    with sqlite3.connect(path) as database:
        database.execute(f'PRAGMA application_id={0x53434B31}')
        database.execute('PRAGMA user_version=999')
        database.execute('CREATE TABLE bake(key TEXT)')
    database.close()


def locked_database(path):
    database = sqlite3.connect(path)
    database.execute('BEGIN EXCLUSIVE')
    return database


def baked(folder, program):
    """A bake of the room: made once per run of the test."""
    import subprocess
    out = os.path.join(folder, 'out.pvs')
    subprocess.run([program, *bake(folder)], check=True, capture_output=True, timeout=120)
    return out


def chunk_damaged(folder, program):
    file = baked(folder, program)
    with open(file, 'rb') as f:
        content = bytearray(f.read())
    # SPEC.md: the table of sections begins at 96, 32 bytes each; id 3 are the rows.
    for at in range(96, 96 + 32 * struct.unpack_from('<I', content, 12)[0], 32):
        identifier, _, offset, size = struct.unpack_from('<IIQQ', content, at)
        if identifier == 3:
            content[offset + size - 1] ^= 0xFF
    write(folder, 'out.pvs', bytes(content))
    return Call(['verify', os.path.join(folder, 'room.gltf'), file, '--rays', '100'], file)


def other_scene(folder, program):
    file = baked(folder, program)
    return Call(['verify', scene(folder, 'other.gltf', scale=3.0), file, '--rays', '100'], file)


def output_is_a_folder(folder):
    os.mkdir(os.path.join(folder, 'out.pvs'))
    return Call(bake(folder), os.path.join(folder, 'out.pvs'))


def golden(folder, name, copy):
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), '../golden', name), 'rb') as file:
        return write(folder, copy, file.read())


def patch(add, *more, named='--add'):
    return lambda folder: Call(['patch', golden(folder, 'v1_tiny.pvs', 'a.pvs'), '--add', add, *more], named)


def packed(*more, named, layout='merged', scene_of=room, verb='pack', bake_options=()):
    """`pack`, or another verb with the same arguments, of a bake of the room."""
    def prepare(folder, program):
        import subprocess
        file = os.path.join(folder, 'out.pvs')
        subprocess.run([program, *bake(folder, '--layout', layout, *bake_options)], check=True, capture_output=True, timeout=120)
        return Call([verb, scene_of(folder), file, '-o', *more], named)
    return prepare


def recoded(*more, named, file='v1_lattice.pvs'):
    return lambda folder: Call(['recode', golden(folder, file, 'a.pvs'), *more], named)


def diff_of_two_scenes(folder):
    return Call(['diff', golden(folder, 'v1_tiny.pvs', 'a.pvs'), golden(folder, 'v1_small.pvs', 'b.pvs')], 'b.pvs')


def misses(folder, content):
    return content(folder) if callable(content) else write(folder, 'misses.json', content)


def bake_with_misses(content):
    def prepare(folder):
        path = misses(folder, content)
        return Call(bake(folder, '--misses', path), path)
    return prepare


def verify_from(content):
    def prepare(folder, program):
        path = misses(folder, content)
        return Call(['verify', os.path.join(folder, 'room.gltf'), baked(folder, program), '--from', path], path)
    return prepare


def verify_without(option):
    """verify with an option for what the file does not have."""
    def prepare(folder, program):
        return Call(['verify', os.path.join(folder, 'room.gltf'), baked(folder, program), option], 'out.pvs')
    return prepare


def verify_without_levels(folder, program):
    return Call(['verify', os.path.join(folder, 'room.gltf'), baked(folder, program), '--levels'], 'room.gltf')


def kept(folder, program):
    """out.pvs with its records. Ends in an error if the program fails."""
    done = subprocess.run([program, *bake(folder, '--source', 'cpu', '--keep-records')], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return os.path.join(folder, 'out.pvs')


def since_damaged(folder, program):
    path = kept(folder, program)
    with open(path + '.records', 'r+b') as file:
        file.seek(30)
        file.write(b'damaged')
    return Call(bake(folder, '--source', 'cpu', '--since', path), 'out.pvs.records')


def since_other(folder, program):
    path = kept(folder, program)
    return Call(bake(folder, '--source', 'cpu', '--since', path, '--seed', '7'), 'seed')


def reported(result):
    """A report of a bake, with something else than a result of verify."""
    def prepare(folder, program):
        path = write(folder, 'result.json', result)
        return Call(['report', baked(folder, program), '--scene', os.path.join(folder, 'room.gltf'), '-o',
                     os.path.join(folder, 'report.html'), '--verify', path], path)
    return prepare


def too_large_misses(folder):
    path = misses(folder, '{}')
    os.truncate(path, (16 << 20) + 1)
    return path


def of_two_scenes(make):
    """make(folder, file): a call with what the cells of a larger room see of the room."""
    def prepare(folder, program):
        import subprocess
        file = os.path.join(folder, 'out.pvs')
        subprocess.run([program, 'bake', '--polygons-from', room(folder), '--cells-from',
                        scene(folder, 'larger.gltf', scale=3.0, inward=True), '-o', file, '--cells-file',
                        cells(folder), *QUICK], check=True, capture_output=True, timeout=120)
        return Call(make(folder, file), 'out.pvs')
    return prepare


def too_many_cells(folder):
    box = '{"min":[0,0,0],"max":[1,1,1]}'
    return cells(folder, '{"cells":[' + ','.join([box] * 1_000_001) + ']}')


def too_large_path(folder):
    path = write(folder, 'path.json', '{}')
    os.truncate(path, (64 << 20) + 1)
    return path


def too_large_cells(folder):
    path = cells(folder)
    os.truncate(path, (256 << 20) + 1)
    return path


def glb(*chunks, version=2, length=None):
    body = b''.join(struct.pack('<I4s', len(c), kind) + c for kind, c in chunks)
    return struct.pack('<4sII', b'glTF', version, 12 + len(body) if length is None else length) + body


def embed_elsewhere(folder):
    os.makedirs(os.path.join(folder, 'elsewhere'), exist_ok=True)
    return Call(bake(folder, '--embed', os.path.join(folder, 'elsewhere', 's.gltf')), 'out.pvs')


def embed_in_empty_glb(folder):
    """The scene names its buffer."""
    text = b'{"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"a.bin"}]}'
    path = write(folder, 'named.glb', glb((b'JSON', text)))
    return Call(bake(folder, '--embed', path, scene_file=path), path)


def set_in(*path, value):
    """A change: the value at the path of keys and indices; None removes the key."""
    def change(made):
        for key in path[:-1]:
            made = made[key]
        if value is None:
            del made[path[-1]]
        else:
            made[path[-1]] = value
    return change


def meshopt(made):
    made['buffers'].append({'byteLength': 16, 'uri': data_uri(bytes(16))})
    made['bufferViews'][0] = {'buffer': 0, 'byteLength': 96, 'extensions': {'EXT_meshopt_compression': {
        'buffer': 1, 'byteLength': 16, 'byteStride': 12, 'count': 8, 'mode': 'ATTRIBUTES'}}}


def outside(made):
    made['buffers'][0]['uri'] = '../secret.bin'


def huge(made):
    made['accessors'][0] = {'componentType': 5126, 'count': 1 << 30, 'type': 'VEC3'}


def out_of_memory(folder):
    # 16,777,216 vertices that are all zero: in no file, but in memory.
    def change(made):
        made['accessors'][0] = {'componentType': 5126, 'count': 1 << 24, 'type': 'VEC3'}
    path = scene(folder, change=change)
    return Call(['info', path], path, memory=300 << 20)


def in_folder(*arguments, named):
    return lambda folder: Call([*arguments], named)


# The superuser reads every file, unless these capabilities are taken away.
NO_OVERRIDE = ('setpriv', '--bounding-set=-dac_override,-dac_read_search', '--inh-caps=-dac_override,-dac_read_search')


def unreadable(folder):
    path = write(folder, 'unreadable.glb', 'glTF')
    os.chmod(path, 0)
    if os.geteuid() != 0:
        return Call(['info', path], path)
    may = subprocess.run([*NO_OVERRIDE, 'true'], stderr=subprocess.PIPE, text=True)
    skip = '' if may.returncode == 0 else f'as the superuser it needs setpriv: {may.stderr.strip()}'
    return Call(['info', path], path, runner=NO_OVERRIDE, skip=skip)


CASES = [
    ('bake.memory', 1, lambda f: Call(bake(f, '--memory', '1M'), 'room.gltf')),
    ('bake.no-free-cell', 1, lambda f: Call(bake(f, cells_file=cells(f, low=(90, 90, 90), high=(91, 91, 91)),
                                                 scene_file=scene(f, 'solid.gltf', scale=100.0)), 'solid.gltf')),
    ('bake.nothing-to-see', 4, lambda f: Call(bake(f, scene_file=scene(f, nodes=[{}])), 'scene.gltf')),
    ('bake.time-budget', 1, options('room.gltf', '--time-budget', '1e-6')),
    ('cells.bad-box', 4, bake_with_cells('{"cells":[{"min":[0,0],"max":[1,1,1]}]}')),
    ('cells.bad-name', 4, bake_with_cells('{"cells":[{"name":7,"min":[0,0,0],"max":[1,1,1]}]}')),
    ('cells.bad-override', 4, bake_with_cells('{"never":7,"cells":[{"min":[0,0,0],"max":[1,1,1]}]}')),
    ('cells.no-such-node', 4, bake_with_cells('{"never":{"nodes":["moon"]},"cells":[{"min":[0,0,0],"max":[1,1,1]}]}')),
    ('cells.no-such-polygon', 4, bake_with_cells('{"cells":[{"min":[0,0,0],"max":[1,1,1],"add":{"polygons":[12]}}]}')),
    ('cells.empty-box', 4, bake_with_cells('{"cells":[{"min":[0,0,0],"max":[0,1,1]}]}')),
    ('cells.no-list', 4, bake_with_cells('{}')),
    ('cells.no-list', 4, bake_with_cells('{"cells":[]}')),
    ('cells.not-json', 4, bake_with_cells('{"cells":')),
    ('cells.too-far', 4, bake_with_cells('{"cells":[{"min":[0,0,0],"max":[1e9,1,1]}]}')),
    ('cells.too-large', 4, bake_with_cells(too_large_cells)),
    ('cells.too-many', 2, lambda f: Call(['bake', room(f), '-o', os.path.join(f, 'out.pvs'), '--cells-grid',
                                          '0,0,0,9999,9999,9999', '--cell-size', '1'], '--cells-grid')),
    ('cells.too-many', 2, options('--fly', '--fly', '0,0,0,9999,9999,9999')),
    ('cells.too-many', 4, bake_with_cells(too_many_cells, slow=True)),
    ('cells.unreadable', 4, bake_with_cells(lambda f: os.path.join(f, 'missing.json'))),
    ('checkpoint.damaged', 4, checkpoint(not_a_database)),
    ('checkpoint.in-use', 1, checkpoint(locked_database)),
    ('checkpoint.not-ours', 4, checkpoint(foreign_database)),
    ('checkpoint.not-writable', 1, lambda f: Call(['bake', room(f), '-o', os.path.join(f, 'no/out.pvs'), '--cells-file',
                                                   cells(f), *QUICK], os.path.join(f, 'no/out.pvs'))),
    ('checkpoint.other-bake', 2, checkpoint(other_bake)),
    ('cli.not-writable', 1, lambda f: Call(bake(f, '--json-file', os.path.join(f, 'no/out.json')), 'no/out.json')),
    ('cli.not-writable', 1, lambda f: Call(['info', room(f)], 'standard output', stdout='/dev/full')),
    ('cli.output-is-input', 2, lambda f: Call(['bake', room(f), '-o', os.path.join(f, 'room.gltf')], 'room.gltf')),
    ('cli.unreadable', 4, info(lambda f: os.path.join(f, 'missing.pvs'))),
    ('cli.wrong-use', 2, in_folder('fly', named='fly')),
    ('cli.wrong-use', 2, in_folder('bake', 'x.glb', '-o', 'x.pvs', '--samples', 'many', named='--samples')),
    ('diff.other-scene', 4, diff_of_two_scenes),
    ('embed.none', 4, lambda f: Call(['verify', room(f), room(f)], 'room.gltf')),
    ('embed.outside-folder', 4, embed_elsewhere),
    ('embed.separate-buffers', 4, embed_in_empty_glb),
    ('gl.no-context', 1, lambda f: Call(bake(f, '--source', 'gpu'), 'OpenGL', environment={
        '__EGL_VENDOR_LIBRARY_DIRS': f, '__EGL_VENDOR_LIBRARY_FILENAMES': ''})),
    ('hemicube.far-plane', 4, lambda f: Call(bake(f, scene_file=scene(f, scale=1e-5)), 'scene')),
    ('hemicube.far-plane', 4, lambda f: Call(bake(f, scene_file=scene(f, scale=1e30)), 'scene')),
    ('misses.bad-report', 4, bake_with_misses('{"misses":[{"eye":[0,0],"polygon":1}]}')),
    ('misses.bad-report', 4, bake_with_misses('{"misses":[{"eye":[0,0,0],"polygon":-1}]}')),
    ('misses.no-list', 4, bake_with_misses('{}')),
    ('misses.no-such-polygon', 4, bake_with_misses('{"misses":[{"eye":[0,0,0],"polygon":12}]}')),
    ('misses.no-such-polygon', 4, verify_from('{"misses":[{"eye":[0,0,0],"polygon":12}]}')),
    ('misses.not-json', 4, bake_with_misses('{"misses":')),
    ('misses.other-scene', 4, bake_with_misses('{"misses":[],"scene_fingerprint":"' + '0' * 32 + '"}')),
    ('misses.other-scene', 4, verify_from('{"misses":[],"scene_fingerprint":"' + '0' * 32 + '"}')),
    ('misses.too-large', 4, bake_with_misses(too_large_misses)),
    ('misses.unreadable', 4, bake_with_misses(lambda f: os.path.join(f, 'missing.json'))),
    ('output.io', 1, output_is_a_folder),
    ('pack.instanced', 2, packed('p.glb', layout='instanced', named='out.pvs')),
    ('pack.no-importance', 2, packed('site', '--stream', named='out.pvs')),
    ('pack.not-folder', 2, packed('out.pvs', '--stream', named='out.pvs')),
    ('pack.not-written', 1, packed('no/p.glb', named='no/p.glb')),
    ('pack.not-written', 1, lambda f: Call(['pack', '--meshlets', room(f), '-o', os.path.join(f, 'no/p.glb')], 'no/p.glb')),
    ('pack.not-written', 1, packed('room.gltf/site', '--stream', bake_options=['--importance'], named='room.gltf/site')),
    ('patch.bad-add', 2, patch('7')),
    ('patch.bad-add', 2, patch('0:7-')),
    ('patch.bad-add', 2, patch('0:7-6')),
    ('patch.bad-add', 2, patch('0:0-4294967295')),
    ('patch.no-such-cell', 2, patch('99:1', named='a.pvs')),
    ('patch.no-such-polygon', 2, patch('0:1-99999999', named='a.pvs')),
    ('patch.not-written', 1, patch('0:1', '-o', 'no/b.pvs', named='no/b.pvs')),
    ('pvs.broken', 4, chunk_damaged),
    ('pvs.other-scene', 4, other_scene),
    ('pvs.other-scene', 4, packed('p.glb', named='out.pvs', scene_of=lambda f: scene(f, 'other.gltf', scale=3.0))),
    ('pvs.no-casters', 2, verify_without('--sun')),
    ('pvs.no-lights', 2, verify_without('--lights')),
    ('pvs.two-scenes', 2, of_two_scenes(lambda f, file: ['verify', os.path.join(f, 'room.gltf'), file])),
    ('records.damaged', 4, since_damaged),
    ('records.missing', 4, options('out.pvs.records', '--since', 'out.pvs')),
    ('records.other-bake', 2, since_other),
    ('recode.two-scenes', 2, of_two_scenes(lambda f, file: ['recode', file, '--importance',
                                                            os.path.join(f, 'room.gltf')])),
    ('recode.has-clusters', 2, recoded('--granularity', 'polygon', named='a.pvs', file='v1_clusters.pvs')),
    ('recode.has-slack', 2, recoded('--profile', 'exact', named='a.pvs')),
    ('recode.merged', 2, recoded('--order', 'per-instance', named='a.pvs', file='v1_merged.pvs')),
    ('recode.no-scene', 2, recoded('--layout', 'merged', named='a.pvs')),
    ('recode.no-scene', 2, recoded('--granularity', 'cluster', named='a.pvs')),
    ('recode.not-written', 1, recoded('-o', 'no/b.pvs', named='no/b.pvs')),
    ('pvs.refused', 4, info(lambda f: write(f, 'text.pvs', 'hello'))),
    ('scene.accessor-bounds', 4, info_of(set_in('accessors', 0, 'count', value=9))),
    ('scene.accessor-type', 4, info_of(set_in('accessors', 0, 'type', value='VEC2'))),
    ('scene.bad-field', 4, info_of(set_in('nodes', value=7))),
    ('scene.bad-json', 4, info(lambda f: write(f, 'bad.gltf', '{"asset":'))),
    ('scene.buffer-size', 4, info_of(set_in('buffers', 0, 'byteLength', value=1000))),
    ('scene.extension', 4, info_of(set_in('extensionsRequired', value=['ACME_moss']))),
    ('scene.index-out-of-range', 4, info_of(set_in('nodes', 0, 'mesh', value=5))),
    ('scene.meshopt', 4, info_of(meshopt)),
    ('scene.missing-field', 4, info_of(set_in('bufferViews', 0, 'buffer', value=None))),
    ('path.bad-point', 4, bake_with_path('{"path":[[0,0,0],[0,1e9,0]]}')),
    ('path.no-points', 4, bake_with_path('{"path":[]}')),
    ('path.not-json', 4, bake_with_path('{"path":')),
    ('path.too-large', 4, bake_with_path(too_large_path)),
    ('path.unreadable', 4, bake_with_path(lambda f: os.path.join(f, 'missing.json'))),
    ('report.not-json', 4, reported('[]')),
    ('report.other-file', 4, reported('{}')),
    ('scene.camera-at-rest', 2, lambda f: Call(['cells', scene(f, nodes=[{'mesh': 0, 'name': 'cart'}]), '--path-camera',
                                                'cart'], 'cart')),
    ('scene.no-levels', 4, verify_without_levels),
    ('scene.no-such-camera', 2, lambda f: Call(['cells', room(f), '--path-camera', 'nobody'], 'nobody')),
    ('scene.no-such-scene', 2, lambda f: Call(['info', room(f), '--scene', '3'], 'room.gltf')),
    ('scene.node-cycle', 4, info_of(set_in('nodes', 0, 'children', value=[0]))),
    ('scene.not-found', 4, info(lambda f: os.path.join(f, 'missing.glb'))),
    ('scene.not-gltf', 4, info(lambda f: write(f, 'text.glb', 'hello'))),
    ('scene.out-of-memory', 1, out_of_memory),
    ('scene.outside-folder', 4, info_of(outside)),
    ('scene.read', 4, unreadable),
    ('scene.too-large', 4, info_of(huge)),
    ('scene.truncated', 4, info(lambda f: write(f, 'short.glb', glb((b'JSON', b'{}  '), length=999)))),
    ('scene.version', 4, info(lambda f: write(f, 'old.glb', glb((b'JSON', b'{}  '), version=1)))),
    ('shard.bad-option', 2, lambda f: Call(bake(f, '--shard', 'three'), '--shard')),
    ('shard.importance', 2, lambda f: Call(bake(f, '--shard', '0/2', '--importance'), '--importance')),
    ('shard.residency', 2, lambda f: Call(bake(f, '--shard', '0/2', '--residency'), '--residency')),
    ('shard.no-array', 2, lambda f: Call(bake(f, '--shard', 'array'), '--shard array')),
    ('shard.none', 4, in_folder('merge', 'none.pvs', named='none.pvs')),
    ('shard.out-of-range', 2, lambda f: Call(bake(f, '--shard', '3/3'), '--shard')),
    ('settings.out-of-range', 2, option('--cell-size', '0.1')),
    ('settings.out-of-range', 2, option('--resolution', '255')),
    ('settings.out-of-range', 2, options('--reach', '--reach', 'none')),
    ('settings.out-of-range', 2, option('--source', 'opengl')),
    ('settings.records', 2, options('--since', '--since', 'a.pvs', '--sampler', 'halton')),
    ('settings.records', 2, options('--keep-records', '--keep-records', '--source', 'rays')),
    ('settings.two-scenes', 2, lambda f: Call(['bake', '--polygons-from', room(f), '--cells-from', room(f), '-o',
                                               os.path.join(f, 'out.pvs'), '--metric', 'color'], '--metric')),
    ('settings.time-budget', 2, options('--time-budget', '--time-budget', '60', '--sampler', 'halton')),
    ('settings.time-budget', 2, options('--time-budget', '--time-budget', '60', '--shard', '0/2')),
    ('settings.suns', 2, options('--sun', '--sun', '180,45', '--max-pixel-error', '0')),
    ('settings.suns', 2, options('--sun', '--sun', '180,45', '--shard', '0/2')),
    ('settings.lights', 2, options('--lights', '--lights', '--max-pixel-error', '0')),
    ('settings.lights', 2, options('--lights', '--lights', '--sampler', 'halton')),
    ('settings.lights', 2, options('--lights', '--lights', '--shard', '0/2')),
    ('settings.no-such-group', 2, option('--closed', 'door')),
    ('settings.volumes', 2, options('--volumes', '--volumes', '2', '--max-pixel-error', '0')),
    ('strip.not-written', 1, packed('no/s.glb', named='no/s.glb', verb='strip')),
    ('view.not-installed', 1, view_without_viewer),
    ('volumes.too-many', 2, options('--volumes', '--volumes', '0.25', '--cells-grid', '0,0,0,999,499,999', '--cell-size',
                                    '1000')),
]
