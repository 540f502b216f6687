#!/usr/bin/env python3
"""samples/engine_bake: what its museum's rooms see and do not see, by the names that went through the tags.

usage: engine_bake_test.py PROGRAM
"""
import os
import re
import subprocess
import sys
import tempfile

# Room: statues that are seen from it, the lattice where it is. Seen through two doors or the lattice, or not at all.
EXPECTED = {
    'A1': {'lattice', 'statue A1', 'statue A2', 'statue B1'},
    'A2': {'lattice', 'statue A1', 'statue A2', 'statue B2'},
    'A3': {'statue A3', 'statue B3'},
    'B1': {'lattice', 'statue A1', 'statue B1'},
    'B2': {'statue A2', 'statue B2', 'statue B3'},
    'B3': {'statue A3', 'statue B2', 'statue B3'},
}


def main():
    program = sys.argv[1]
    if subprocess.run([program], capture_output=True).returncode != 2:
        sys.exit('without a file it has to exit with 2')
    with tempfile.TemporaryDirectory() as folder:
        result = subprocess.run([program, os.path.join(folder, 'museum.pvs')], capture_output=True, text=True)
        if result.returncode != 0 and 'gl.no-context' in result.stderr:
            print('no OpenGL: skipped', result.stderr)
            sys.exit(77)
        print(result.stdout, result.stderr)
        if result.returncode != 0:
            sys.exit(f'exit code {result.returncode}')
        if os.listdir(folder) != ['museum.pvs']:
            sys.exit(f'left behind: {os.listdir(folder)}')
    seen = {room: set(filter(None, map(str.strip, names.split(';'))))
            for room, names in re.findall(r'^room (\w+): \d+ of \d+ polygons;(.*)$', result.stdout, re.M)}
    if seen != EXPECTED:
        sys.exit(f'rooms see {seen}, expected {EXPECTED}')
    bound = float(re.search(r'^verified: .* at most (\S+)$', result.stdout, re.M).group(1))
    if not bound <= 1e-4:
        sys.exit(f'the bound is {bound}')


if __name__ == '__main__':
    main()
