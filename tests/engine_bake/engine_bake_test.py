"""samples/engine_bake: what its museum's rooms see and do not see, by the names that went through the tags."""
import os
import re

from harness import program, run, skip_without_egl

# Room: statues that are seen from it, the lattice where it is. Seen through two doors or the lattice, or not at all.
EXPECTED = {
    'A1': {'lattice', 'statue A1', 'statue A2', 'statue B1'},
    'A2': {'lattice', 'statue A1', 'statue A2', 'statue B2'},
    'A3': {'statue A3', 'statue B3'},
    'B1': {'lattice', 'statue A1', 'statue B1'},
    'B2': {'statue A2', 'statue B2', 'statue B3'},
    'B3': {'statue A3', 'statue B2', 'statue B3'},
}


def test_wrong_use():
    assert run(program('sightcell-engine-bake'))[0] == 2


def test_rooms_see_what_they_should(folder):
    code, out, err = run(program('sightcell-engine-bake'), os.path.join(folder, 'museum.pvs'))
    skip_without_egl(code, err)
    assert code == 0, out + err
    assert os.listdir(folder) == ['museum.pvs']
    seen = {room: set(filter(None, map(str.strip, names.split(';'))))
            for room, names in re.findall(r'^room (\w+): \d+ of \d+ polygons;(.*)$', out, re.M)}
    assert seen == EXPECTED
    assert float(re.search(r'^verified: .* at most (\S+)$', out, re.M).group(1)) <= 1e-4
