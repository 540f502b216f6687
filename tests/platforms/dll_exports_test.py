"""libsightcell.dll exports exactly what its headers declare, and needs no DLL that Windows does not have."""
import os
import re
import subprocess

from harness import ROOT, SETTINGS, read

HEADERS = [os.path.join(ROOT, 'runtime', 'include', 'sightcell', name)
           for name in ('sightcell.h', 'casters.h', 'clusters.h', 'viewpoints.h', 'identity.h', 'residency.h', 'lights.h')]


def test_exports_and_needs():
    output = subprocess.run([SETTINGS['objdump'], '-p', SETTINGS['library']], check=True, capture_output=True,
                            text=True).stdout
    table = output[output.index('[Ordinal/Name Pointer] Table'):]
    exported = set(re.findall(r'^\s*\[ *\d+\].* (\w+)$', table, re.MULTILINE))
    text = ''.join(read(header).decode() for header in HEADERS)
    declared = set(re.findall(r'^SIGHTCELL_API [^;(]*?(sightcell_\w+)\(', text, re.MULTILINE))
    assert declared and exported == declared
    needed = {name.lower() for name in re.findall(r'DLL Name: (\S+)', output)}
    assert needed and needed <= {'kernel32.dll', 'msvcrt.dll'}
