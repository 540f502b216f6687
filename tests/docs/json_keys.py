#!/usr/bin/env python3
"""docs/json-files.md has the keys that the program prints, and no others.

usage: json_keys.py ROOT BIN    BIN: the folder with the built programs
"""
import json
import os
import re
import struct
import subprocess
import sys
import tempfile

PAGE = 'docs/json-files.md'


def section(text, heading):
    found = re.search(rf'^(#+) {re.escape(heading)}[^\n]*\n(.*?)(?=^#|\Z)', text, re.MULTILINE | re.DOTALL)
    if not found:
        sys.exit(f'{PAGE} has no heading "{heading}"')
    return found.group(2)


def keys_of_table(text, header):
    """What stands in backticks in the first column of the table with this first header."""
    keys, inside = set(), False
    for line in text.split('\n'):
        first = line.split('|')[1].strip() if line.startswith('|') else None
        if first is None:
            inside = False
        elif first == header:
            inside = True
        elif inside:
            keys.update(re.findall(r'`(\w+)`', first))
    return keys


def keys_of_verbs(text):
    """verb -> the keys in its row of the table verb | keys."""
    verbs = {}
    for line in text.split('\n'):
        cells = line.split('|')
        if len(cells) == 4:
            for verb in re.findall(r'`(\w+)`', cells[1]):
                verbs[verb] = set(re.findall(r'`(\w+)`', cells[2]))
    return verbs


def write_with_level(scene, path):
    """Writes a .glb whose second node with a mesh is a level of the first."""
    with open(scene, 'rb') as file:
        content = file.read()
    size = struct.unpack_from('<I', content, 12)[0]
    document = json.loads(content[20:20 + size])
    finest, coarser = [node for node in document['nodes'] if 'mesh' in node][:2]
    finest['name'] = 'finest'
    coarser['extras'] = {'sightcell': {'level_of': 'finest', 'from_distance': 5}}
    text = json.dumps(document).encode()
    text += b' ' * (-len(text) % 4)
    rest = content[20 + size:]
    with open(path, 'wb') as file:
        file.write(struct.pack('<4sIII4s', b'glTF', 2, 20 + len(text) + len(rest), len(text), b'JSON') + text + rest)


def main():
    root, programs = sys.argv[1], os.path.abspath(sys.argv[2])
    with open(os.path.join(root, PAGE), encoding='utf-8') as file:
        text = file.read()
    problems = []

    def compare(what, documented, printed):
        problems.extend(f'{what}: {key} is printed and not in {PAGE}' for key in sorted(printed - documented))
        problems.extend(f'{what}: {key} is in {PAGE} and not printed' for key in sorted(documented - printed))

    with tempfile.TemporaryDirectory(prefix='sightcell-keys-') as folder:
        def run(*command):
            done = subprocess.run([os.path.join(programs, command[0]), *command[1:]], cwd=folder, text=True,
                                  stdin=subprocess.DEVNULL, capture_output=True, timeout=300, check=True)
            return done.stdout, done.stderr

        def keys(*command):
            return set(json.loads(run('sightcell', *command, '--json')[0]))

        run('sightcell-city', '--polygons', '600', '--seed', '1', '--out', 's.glb')
        bake = ['bake', 's.glb', '--cell-limit', '4', '--max-pixel-error', '1e-2']
        compare('bake', keys_of_table(section(text, 'bake'), 'key'), keys(*bake, '-o', 'a.pvs'))
        _, progress = run('sightcell', *bake, '-o', 'b.pvs', '--layout', 'merged', '--progress', 'json')
        lines = [json.loads(line) for line in progress.splitlines() if line.startswith('{')]
        compare('progress', keys_of_table(section(text, 'Progress'), 'key'), set(lines[0]))
        compare('cells', keys_of_table(section(text, 'cells'), 'key'), keys('cells', 's.glb', '--cell-limit', '2'))
        verify = section(text, 'verify')
        compare('verify', keys_of_table(verify, 'key'), keys('verify', 's.glb', 'a.pvs', '--rays', '5000'))
        with open(os.path.join(folder, 'm.json'), 'w', encoding='utf-8') as file:
            file.write('{"misses": [{"eye": [1, 1.7, 2], "polygon": 3}]}')
        found = json.loads(run('sightcell', 'verify', 's.glb', 'a.pvs', '--from', 'm.json', '--json')[0])
        compare('verify --from', keys_of_table(verify, 'key of `from`') | {'list'}, set(found['from']))
        cuts = json.loads(run('sightcell', 'verify', 's.glb', 'a.pvs', '--cut', '2', '--rays', '5000', '--json')[0])['cuts']
        compare('verify --cut', keys_of_table(verify, 'key of `cuts`'), set(cuts[0]))
        write_with_level(os.path.join(folder, 's.glb'), os.path.join(folder, 'l.glb'))
        run('sightcell', 'bake', 'l.glb', '--cell-limit', '1', '--max-pixel-error', '1e-2', '-o', 'l.pvs')
        levels = json.loads(run('sightcell', 'verify', 'l.glb', 'l.pvs', '--levels', '--rays', '5000', '--max-pixel-error', '1',
                                '--json')[0])['levels']
        compare('verify --levels', keys_of_table(verify, 'key of `levels`'), set(levels))
        compare('info, of a file', keys_of_table(section(text, 'info, of a .pvs file'), 'key'), keys('info', 'a.pvs'))
        compare('info, of a scene', keys_of_table(section(text, 'info, of a scene'), 'key'), keys('info', 's.glb'))
        compare('diff', keys_of_table(section(text, 'diff'), 'key'), keys('diff', 'a.pvs', 'b.pvs'))
        verbs = keys_of_verbs(section(text, 'pack, patch'))
        compare('pack', verbs.get('pack', set()), keys('pack', 's.glb', 'b.pvs', '-o', 'p.glb'))
        compare('patch', verbs.get('patch', set()), keys('patch', 'a.pvs', '--add', '0:1'))
        compare('recode', verbs.get('recode', set()), keys('recode', 'a.pvs', '--profile', 'small', '-o', 'c.pvs'))
        unseen = keys_of_table(section(text, 'Unseen polygons'), 'key')
        compare('strip', unseen | verbs.get('strip', set()), keys('strip', 's.glb', 'a.pvs'))
        run('sightcell', 'strip', 's.glb', 'a.pvs', '--report', 'u.json')
        with open(os.path.join(folder, 'u.json'), encoding='utf-8') as file:
            compare('strip --report', unseen, set(json.load(file)))
        compare('migrate', verbs.get('migrate', set()), keys('migrate', 'c.pvs'))
    print('\n'.join(problems) or 'keys: fine')
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main())
