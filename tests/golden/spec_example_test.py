"""The worked example of SPEC.md is the golden file, byte for byte."""
import os
import re

from harness import ROOT, read


def test_example():
    rows = re.findall(r'^([0-9a-f]{4})  ((?:[0-9a-f]{2} ?)+)(?: |$)',
                      read(os.path.join(ROOT, 'format', 'SPEC.md')).decode(), re.MULTILINE)
    example = b''
    for offset, text in rows:
        assert int(offset, 16) == len(example), 'a row does not follow'
        example += bytes.fromhex(text)
    assert rows and example == read(os.path.join(ROOT, 'tests', 'golden', 'v1_tiny.pvs'))
