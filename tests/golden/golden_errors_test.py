"""The Python decoder refuses every damaged file with the status that is listed for it, and reads those that have none."""
import os

from decode_pvs import Contents
from harness import ROOT, read
from pvs_parts import Refused

FOLDER = os.path.join(ROOT, 'tests', 'golden', 'golden_errors')


def outcome(path):
    try:
        Contents(read(path))
    except Refused as refusal:
        return refusal.status, str(refusal)
    return 'ok', 'ok'


def test_every_file_has_its_status():
    with open(os.path.join(FOLDER, 'statuses.txt'), encoding='utf-8') as file:
        listed = dict(line.split() for line in file)
    assert listed
    found = {name: outcome(os.path.join(FOLDER, name)) for name in listed}
    assert {name: status for name, (status, _) in found.items()} == listed, found
