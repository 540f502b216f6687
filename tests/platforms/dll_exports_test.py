#!/usr/bin/env python3
"""libsightcell.dll exports exactly what sightcell.h declares, and needs no DLL that Windows does not have.

usage: dll_exports_test.py OBJDUMP LIBRARY.dll HEADER
"""
import re
import subprocess
import sys

objdump, library, header = sys.argv[1:4]
output = subprocess.run([objdump, "-p", library], check=True, capture_output=True, text=True).stdout
table = output[output.index("[Ordinal/Name Pointer] Table"):]
exported = set(re.findall(r"^\s*\[ *\d+\].* (\w+)$", table, re.MULTILINE))
with open(header, encoding="utf-8") as file:
    declared = set(re.findall(r"^SIGHTCELL_API [^;(]*?(sightcell_\w+)\(", file.read(), re.MULTILINE))
if not declared or exported != declared:
    sys.exit(f"exported only: {sorted(exported - declared)}\ndeclared only: {sorted(declared - exported)}")
needed = {name.lower() for name in re.findall(r"DLL Name: (\S+)", output)}
if not needed or needed - {"kernel32.dll", "msvcrt.dll"}:
    sys.exit(f"needs {sorted(needed)}")
