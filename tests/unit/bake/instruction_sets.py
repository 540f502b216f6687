#!/usr/bin/env python3
"""No function of an object file for one instruction set may be one that the linker could take for the whole program.

usage: instruction_sets.py NM OBJECT

A weak function (an inline one, an instance of a template) may stand in many object files; the linker keeps one of them,
and a processor without the instructions would come to run it. Exit code 0: there is none, 1: there are, one line each.
"""
import subprocess
import sys

WEAK = 'W'  # a weak function; weak objects (V) hold no instructions, undefined weak ones (w) are nowhere

nm, path = sys.argv[1:]
lines = subprocess.run([nm, '--demangle', path], check=True, capture_output=True, text=True).stdout.splitlines()
found = [line[19:] for line in lines if line[17:18] == WEAK]
for name in found:
    print(f'{path}: {name}: other files could come to use this one')
if not any(line[17:18] in 'Tt' for line in lines):
    sys.exit(f'{path}: has no function at all')
sys.exit(1 if found else 0)
