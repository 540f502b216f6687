#!/usr/bin/env python3
"""Who may include whom: the rule of the rooms, as an allow-list.

usage: check_layering.py ROOT

Looks at every C, C++ and GLSL file of every room under ROOT. An include is fine when it is a header of the standard
library, a file of the same room, or on the room's list below; everything else fails. Looking at no file fails too: a
check that checks nothing must not pass. Exit code 0: fine, 1: a forbidden include, 2: nothing to look at.
"""
import os
import re
import sys

SUFFIXES = ('.h', '.hpp', '.hpp.in', '.h.in', '.c', '.cpp', '.glsl', '.comp', '.vert', '.frag', '.geom')
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')

# C headers are named one by one; C++ headers are all those without a suffix and a folder.
C_STANDARD = {name + '.h' for name in (
    'assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic '
    'stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype').split()}

POSIX = ['unistd.h', 'fcntl.h', 'poll.h', 'spawn.h', 'sys/']
SYSTEM = POSIX + ['windows.h']
PLATFORM = SYSTEM + ['io.h']  # of tests
FORMAT_READ = ['sightcell/format/layout.h', 'sightcell/format/status.h', 'sightcell/format/records.h',
               'sightcell/format/reader.h', 'sightcell/format/packed_columns.h', 'sightcell/format/cell_lattice.h',
               'sightcell/format/caster_table.h', 'sightcell/format/chunk_borders.h', 'sightcell/format/cluster_table.h',
               'sightcell/format/draw_ranges.h', 'sightcell/format/extra_sets.h', 'sightcell/format/light_table.h',
               'sightcell/format/eye_table.h', 'sightcell/format/geometry_hash.h', 'sightcell/format/residency_table.h',
               'sightcell/format/identity_table.h', 'sightcell/format/importance_classes.h',
               'sightcell/format/viewpoint_table.h', 'sightcell/format/volume_table.h']
FORMAT = ['sightcell/format/']
BASE = ['sightcell/base/']
SCENE = BASE + ['sightcell/scene/', 'glm/']
PICTURE = ['sightcell/picture/']
BAKE = ['sightcell/bake/']
RUNTIME = ['sightcell/sightcell.h', 'sightcell/sightcell.hpp', 'sightcell/casters.h', 'sightcell/clusters.h', 'sightcell/identity.h', 'sightcell/lights.h', 'sightcell/residency.h',
           'sightcell/viewpoints.h', 'sightcell/hosts/', 'sightcell/stream.h']
GL = ['epoxy/', 'EGL/', 'GL/']
SHADERS = ['shared/', 'shaders/']

# Room -> what it may include beside the standard library and itself. The longest matching room counts. Where a single
# file needs more than its room, it is a room of its own: that keeps, for example, tinygltf in one file.
ALLOWED = {
    # The rule everything hangs on: format knows nobody; runtime knows format alone; bake and runtime never meet.
    'format': [],
    'format/src/platform_file.cpp': SYSTEM,
    'runtime': FORMAT_READ,
    'runtime/src/file_input.cpp': FORMAT_READ + SYSTEM,
    'runtime/stream': FORMAT_READ + ['sightcell/stream.h'],
    'runtime/stream/src/inflated.cpp': ['sha2.h', 'zlib.h'],
    'shaders': [],
    'bake/base': ['glm/', 'nlohmann/', 'tbb/'],
    'bake/base/src/disk.cpp': POSIX,
    'bake/scene': BASE + ['glm/', 'nlohmann/', 'xxhash.h'],
    'bake/scene/src/draco_decode.cpp': ['draco/'],
    'bake/scene/src/load_gltf.cpp': BASE + ['glm/', 'nlohmann/', 'tiny_gltf.h'],
    'bake/scene/src/clusters.cpp': ['meshoptimizer.h', 'glm/'],
    'bake/scene/src/meshlet_bytes.cpp': ['meshoptimizer.h', 'glm/'],
    'bake/scene/src/simplified_group.cpp': ['meshoptimizer.h', 'glm/'],
    'bake/scene/src/meshopt_decode.cpp': ['meshoptimizer.h'],
    'bake/scene/src/meshopt_encode.cpp': ['meshoptimizer.h'],
    'bake/scene/src/decode_image.cpp': ['stb_image.h'],
    'bake/picture': SCENE + SHADERS + GL + ['stb_image_write.h', 'fmt/', 'sys/', 'unistd.h'],
    'bake/picture/src/plan_canvas.cpp': ['glm/', 'stb_easy_font.h', 'sightcell/picture/'],
    'bake': SCENE + PICTURE + FORMAT + SHADERS + ['embree3/', 'tbb/', 'fmt/', 'nlohmann/', 'xxhash.h'],
    'bake/src/checkpoint/checkpoint.cpp': SCENE + ['sqlite3.h', 'xxhash.h', 'fmt/', 'nlohmann/'],
    'bake/src/stream/payload.cpp': ['sha2.h', 'zlib.h'],
    'bake/src/stream/encoded_copies.cpp': ['brotli/', 'zlib.h'],
    'bake/src/stream/smaller_images.cpp': SCENE + ['webp/'],
    'bake/src/since': SCENE + ['tbb/', 'xxhash.h', 'zlib.h'],
    'bake/src/touched': SCENE + ['zlib.h'],
    'bake/src/job/disk_space.cpp': SCENE + ['sys/', 'fmt/'],
    'bake/src/cells/voxel_field.cpp': SCENE + ['Recast.h', 'tbb/'],
    'bake/src/cells/walkable.cpp': SCENE + ['fmt/', 'tbb/'],
    'bake/src/hemicube': SCENE + PICTURE + SHADERS + GL + ['embree3/', 'tbb/', 'fmt/'],
    'bake/src/hemicube/cpu': SCENE + ['tbb/', 'hwy/'],
    'bake/cli/console.cpp': ['unistd.h', 'fcntl.h', 'sys/ioctl.h'],
    'bake/cli': BAKE + SCENE + PICTURE + FORMAT_READ + ['sightcell/format/set_reader.h', 'CLI/', 'fmt/', 'nlohmann/',
                                                       'unistd.h'],
    'bake/cli/watch/input_watch.cpp': BASE + ['poll.h', 'sys/inotify.h', 'unistd.h'],
    'bake/cli/report/data_uri.cpp': ['webp/', 'sightcell/picture/'],
    'samples': RUNTIME + SCENE + PICTURE + ['CLI/', 'fmt/', 'nlohmann/', 'stb_image_write.h'] + GL,
    'samples/gpu_driven': RUNTIME + SCENE + PICTURE + GL + ['gpu_driven_shaders/', 'CLI/', 'fmt/', 'nlohmann/'],
    'samples/hello_cull': RUNTIME,  # C, and nothing else: it is what a host writes
    'samples/ogre': RUNTIME + ['Ogre.h', 'assimp/', 'CLI/', 'fmt/'],
    'samples/stream_client': ['sightcell/stream.h', 'sightcell/sightcell.h', 'curl/'] + SCENE + PICTURE + GL +
                             ['CLI/', 'fmt/', 'nlohmann/'],
    'samples/stream_client/decoders.cpp': SCENE + ['sightcell/stream.h', 'webp/'],
    'samples/stream_client/page.cpp': BASE + ['meshoptimizer.h', 'nlohmann/'],
    'samples/engine_bake': BAKE + RUNTIME + SCENE + PICTURE,
    'samples/viewer': RUNTIME + SCENE + PICTURE + GL +
                      ['GLFW/', 'imgui', 'backends/imgui_impl_opengl3.h', 'CLI/', 'fmt/', 'nlohmann/'],
    'samples/viewer/background_bake.cpp': POSIX + BASE + ['nlohmann/', 'glm/'],
    'samples/vulkan': RUNTIME + SCENE + ['vulkan/', 'SDL.h', 'SDL_vulkan.h', 'spirv/', 'CLI/', 'fmt/', 'nlohmann/',
                                         'stb_image_write.h'],
    'tests/bench/format_peers': RUNTIME + FORMAT_READ + ['roaring/', 'zstd.h', 'zdict.h'],
    # Tests may look at everything, inside the rooms too.
    'tests': BAKE + SCENE + PICTURE + FORMAT + RUNTIME + SHADERS + GL + PLATFORM +
             ['draco/', 'meshoptimizer.h', 'gtest/', 'gmock/', 'benchmark/', 'embree3/', 'tbb/', 'fmt/', 'nlohmann/', 'xxhash.h', 'sqlite3.h',
              'CLI/', 'boost/'],
    'tests/unit/runtime/stream': RUNTIME + ['gtest/', 'sha2.h', 'zlib.h'],
}
# A file of these rooms can be included by path inside the room. bake/base, bake/scene, bake/picture and bake/cli are
# rooms of their own: bake/src may use their public headers and nothing else of them.
ROOMS = ['format', 'runtime', 'shaders', 'bake/base', 'bake/scene', 'bake/picture', 'bake/cli', 'bake', 'samples',
         'tests']
# Where quoted includes are looked for inside a room, beside the folder of the file.
ROOTS_IN_ROOM = ['', 'src', 'include']
# Rooms whose private headers a test may look at.
PRIVATE_FOR_TESTS = ['format/src', 'runtime/src', 'bake/src', 'bake/scene/src', 'bake/picture/src', 'bake/cli',
                     'samples/city', 'samples/viewer']


def longest(path, candidates):
    """The longest of the folders or files that path is or lies in."""
    fitting = [c for c in candidates if path == c or path.startswith(c + '/')]
    return max(fitting, key=len) if fitting else None


def is_standard(name):
    return name in C_STANDARD or re.fullmatch(r'[a-z_0-9]+', name) is not None


def room_of(path):
    # Each sample is a room: samples do not share code.
    parts = path.split('/')
    if parts[0] == 'samples' and len(parts) > 2:
        return '/'.join(parts[:2])
    return longest(path, ROOMS)


def is_own_file(root, path, name):
    room = room_of(path)
    folders = [os.path.dirname(path)] + [os.path.join(room, r) for r in ROOTS_IN_ROOM]
    if room == 'tests':
        folders += PRIVATE_FOR_TESTS
    for folder in folders:
        found = os.path.normpath(os.path.join(folder, name)).replace(os.sep, '/')
        if os.path.isfile(os.path.join(root, found)) and (room_of(found) == room or room == 'tests'):
            return True
    return False


def problem_with(root, path, bracket, name):
    """Why this include is forbidden, or None."""
    if '..' in name.split('/'):
        return 'includes must not climb out of their folder'
    if is_standard(name):
        return None
    if bracket == '"' and is_own_file(root, path, name):
        return None
    room = longest(path, ALLOWED)
    if any(name == a or ((a.endswith('/') or a == 'imgui') and name.startswith(a)) for a in ALLOWED[room]):
        return None
    return f'{room} may not include it'


def source_files(root):
    for room in sorted({r.split('/')[0] for r in ROOMS}):
        for folder, folders, names in os.walk(os.path.join(root, room)):
            folders.sort()
            if os.path.relpath(folder, root) == os.path.join('tests', 'layering'):
                folders[:] = [f for f in folders if not f.startswith('planted')]  # mistakes for this very check to find
            for name in sorted(names):
                if name.endswith(SUFFIXES):
                    yield os.path.relpath(os.path.join(folder, name), root).replace(os.sep, '/')


def main():
    root = sys.argv[1]
    files = includes = bad = 0
    for path in source_files(root):
        files += 1
        with open(os.path.join(root, path), encoding='utf-8') as source:
            for number, line in enumerate(source, 1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                includes += 1
                problem = problem_with(root, path, *match.groups())
                if problem:
                    bad += 1
                    print(f'{path}:{number}: {match.group(2)}: {problem}')
    print(f'{files} files, {includes} includes, {bad} forbidden')
    if files == 0 or includes == 0:
        print(f'no file with an include under {root}: nothing was checked')
        return 2
    return 1 if bad else 0


if __name__ == '__main__':
    sys.exit(main())
