#!/usr/bin/env python3
"""bake --memory: what does not fit is refused before it is built, what fits keeps under the limit, and no byte changes.

usage: memory_test.py SIGHTCELL SIGHTCELL_CITY
"""
import os
import re
import subprocess
import sys
import tempfile

POLYGONS = 60_000
CELLS = ['--cells-grid', '-16,0,-16,16,2,16', '--cell-limit', '6']
QUICK = ['--samples', '6', '--resolution', '64', '--max-pixel-error', '1e-2', '--source', 'cpu', '--progress', 'none']


def bake(program, scene, output, *more):
    """Exit code, standard error and the largest resident set in bytes."""
    command = [program, 'bake', scene, '-o', output, *CELLS, *QUICK, *more]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = process.stderr.read().decode()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, said, usage.ru_maxrss * 1024


def content(path):
    with open(path, 'rb') as stream:
        return stream.read()


def main():
    program, city = sys.argv[1:]
    if os.environ.get('SIGHTCELL_SANITIZE'):
        print('skipped: a sanitizer takes several times the memory')
        return 77
    failed = []

    def expect(true, what):
        if not true:
            failed.append(what)

    with tempfile.TemporaryDirectory(prefix='sightcell-memory-') as folder:
        scene = os.path.join(folder, 'town.glb')
        subprocess.run([city, '--polygons', str(POLYGONS), '--out', scene], check=True, stdout=subprocess.DEVNULL)
        free, kept = os.path.join(folder, 'free.pvs'), os.path.join(folder, 'kept.pvs')
        code, said, unlimited = bake(program, scene, free, '--threads', '4')
        expect(code == 0, f'without a limit: {code}, {said}')

        code, said, peak = bake(program, scene, kept, '--threads', '4', '--memory', '16M')
        expect(code == 1 and said.rstrip().endswith('[bake.memory]'), f'16M: {code}, {said}')
        expect(peak < unlimited, f'16M: {peak} bytes were taken before it was refused, {unlimited} without a limit')
        expect(sorted(os.listdir(folder)) == ['free.pvs', 'town.glb'], f'16M: it left {os.listdir(folder)}')

        # What it says it needs is enough, and not absurd.
        needed = re.search(r'needs about (\d+) MiB', said)
        expect(needed, f'16M: no need in {said!r}')
        limit = int(needed.group(1)) if needed else 1024
        expect(limit << 20 < 3 * unlimited, f'needs {limit} MiB, and {unlimited} bytes are taken')
        code, said, peak = bake(program, scene, kept, '--threads', '4', '--memory', f'{limit + 1}M')
        expect(code == 0, f'{limit + 1}M: {code}, {said}')
        expect(peak <= (limit + 1) << 20, f'{limit + 1}M: {peak} bytes were taken')
        expect(code != 0 or content(kept) == content(free), f'{limit + 1}M: other bytes')

        code, said, peak = bake(program, scene, kept, '--threads', '4', '--memory', '2G')
        expect(code == 0 and content(kept) == content(free), f'2G: {code}, {said}')
        code, said, _ = bake(program, scene, kept, '--memory', '2 parsecs')
        expect(code == 2 and '--memory' in said, f'2 parsecs: {code}, {said}')
    for what in failed:
        print(what)
    print(f'{unlimited / 2**20:.1f} MiB without a limit, {limit} MiB said to be needed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
