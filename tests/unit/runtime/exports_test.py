#!/usr/bin/env python3
"""libsightcell exports exactly what sightcell.h declares. usage: exports_test.py NM LIBRARY HEADER"""
import re
import subprocess
import sys

nm, library, header = sys.argv[1:4]
output = subprocess.run([nm, "-D", "--defined-only", library], check=True, capture_output=True, text=True).stdout
exported = {line.split()[-1].split("@")[0] for line in output.splitlines() if line.strip()}
with open(header, encoding="utf-8") as file:
    declared = set(re.findall(r"^SIGHTCELL_API [^;(]*?(sightcell_\w+)\(", file.read(), re.MULTILINE))
if not declared or exported != declared:
    sys.exit(f"exported only: {sorted(exported - declared)}\ndeclared only: {sorted(declared - exported)}")
