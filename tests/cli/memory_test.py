"""bake --memory: what does not fit is refused before it is built, what fits keeps under the limit, and no byte changes."""
import os
import re
import subprocess

import pytest
from harness import program, read, write_city

CELLS = ['--cells-grid', '-16,0,-16,16,2,16', '--cell-limit', '6']
QUICK = ['--samples', '6', '--resolution', '64', '--max-pixel-error', '1e-2', '--source', 'cpu', '--progress', 'none']


def bake(scene, output, *more):
    """Exit code, standard error and the largest resident set in bytes."""
    command = [program('sightcell'), 'bake', scene, '-o', output, *CELLS, *QUICK, *more]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    with process.stderr:
        said = process.stderr.read().decode()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, said, usage.ru_maxrss * 1024


@pytest.mark.skipif(bool(os.environ.get('SIGHTCELL_SANITIZE')), reason='a sanitizer takes several times the memory')
def test_memory(folder):
    scene, free, kept = (os.path.join(folder, name) for name in ('town.glb', 'free.pvs', 'kept.pvs'))
    write_city(scene, polygons=60_000)
    code, said, unlimited = bake(scene, free, '--threads', '4')
    assert code == 0, said

    code, said, peak = bake(scene, kept, '--threads', '4', '--memory', '16M')
    assert code == 1 and said.rstrip().endswith('[bake.memory]'), said
    assert peak < unlimited, 'bytes were taken before it was refused'
    assert sorted(os.listdir(folder)) == ['free.pvs', 'town.glb']

    # What it says it needs is enough, and not absurd.
    limit = int(re.search(r'needs about (\d+) MiB', said).group(1))
    print(f'{unlimited / 2**20:.1f} MiB without a limit, {limit} MiB said to be needed')
    assert limit << 20 < 3 * unlimited
    code, said, peak = bake(scene, kept, '--threads', '4', '--memory', f'{limit + 1}M')
    assert code == 0, said
    assert peak <= (limit + 1) << 20
    assert read(kept) == read(free)

    code, said, peak = bake(scene, kept, '--threads', '4', '--memory', '2G')
    assert code == 0, said
    assert read(kept) == read(free)
    code, said, _ = bake(scene, kept, '--memory', '2 parsecs')
    assert code == 2 and '--memory' in said, said
