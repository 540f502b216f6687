#!/usr/bin/env python3
"""Prints the includes between the rooms of bake/src and fails where they make a circle or run back up.

usage: room_order.py ROOT

ROOMS below is the order: a room may include itself and the rooms above it. A folder inside a room (hemicube/gpu) is a
folder of its own when pairs of folders that include each other are counted.
Exit code 0: fine, 1: an include that runs back up, a pair of folders, or a folder that is no room, 2: nothing to look at.
"""
import collections
import os
import re
import sys

ROOMS = ['touched', 'trace', 'hemicube', 'cells', 'order', 'volumes', 'bound', 'cell_set', 'checkpoint', 'search', 'input',
         'file', 'casters', 'stream', 'sampler', 'misses', 'since', 'job', 'shards', 'verify']
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"')
SUFFIXES = ('.h', '.cpp', '.inl')


def source_files(top):
    for folder, folders, names in os.walk(top):
        folders.sort()
        for name in sorted(names):
            if name.endswith(SUFFIXES):
                yield os.path.relpath(os.path.join(folder, name), top).replace(os.sep, '/')


def included_files(top, path):
    """The files under top that this file includes, each as its path under top."""
    with open(os.path.join(top, path), encoding='utf-8') as source:
        for line in source:
            match = INCLUDE.match(line)
            if not match:
                continue
            for folder in (os.path.dirname(path), ''):
                found = os.path.normpath(os.path.join(folder, match[1])).replace(os.sep, '/')
                if os.path.isfile(os.path.join(top, found)):
                    yield found
                    break


def read_includes(top):
    """The number of files, and a list of (file, file it includes) where the two are in different folders."""
    files, arrows = 0, []
    for path in source_files(top):
        files += 1
        arrows += [(path, found) for found in included_files(top, path)
                   if os.path.dirname(found) != os.path.dirname(path)]
    return files, arrows


def room_of(path):
    return path.split('/')[0] if '/' in path else ''


def upward(arrows):
    return [(a, b) for a, b in arrows
            if room_of(a) in ROOMS and room_of(b) in ROOMS and ROOMS.index(room_of(b)) > ROOMS.index(room_of(a))]


def pairs(arrows):
    """Folders that include each other, each pair once with an include of each direction."""
    between = collections.defaultdict(list)
    for a, b in arrows:
        between[os.path.dirname(a), os.path.dirname(b)].append((a, b))
    return [(one, other, between[one, other][0], between[other, one][0])
            for one, other in sorted(between) if one < other and (other, one) in between]


def main():
    top = os.path.join(sys.argv[1], 'bake', 'src')
    files, arrows = read_includes(top)
    if files == 0:
        print(f'{top}: nothing was checked')
        return 2
    lost = [path for path in source_files(top) if room_of(path) not in ROOMS]
    up, mutual = upward(arrows), pairs(arrows)
    for path in lost:
        print(f'bake/src/{path}: is in no room of ROOMS (tests/layering/room_order.py)')
    for a, b in up:
        print(f'bake/src/{a}: includes {b}, but {room_of(b)} is below {room_of(a)}')
    for one, other, there, back in mutual:
        print(f'bake/src/{one} and bake/src/{other} include each other: {there[0]} includes {there[1]}, '
              f'{back[0]} includes {back[1]}')
    print(f'{files} files, {len(arrows)} includes between folders, {len(up)} run back up, {len(mutual)} pairs of folders '
          f'include each other')
    return 1 if lost or up or mutual else 0


if __name__ == '__main__':
    sys.exit(main())
