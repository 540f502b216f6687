#!/usr/bin/env python3
"""No function of an object file for one instruction set may replace a function of the rest of the program.

usage: instruction_sets.py NM OBJECT NAMESPACE    NAMESPACE: Highway's for the instruction set, for example N_AVX2

Several object files may define the same weak function (an inline one, an instance of a template). The linker keeps one
of them, and a processor without the instructions would then run it. Highway's functions in the namespace of the
instruction set are exempt: only files for that set have them. Exit code 0: no other weak function, 1: one line for each.
"""
import subprocess
import sys

WEAK = 'W'  # a weak function; weak data (V) has no instructions, weak references (w) define nothing

nm, path, namespace = sys.argv[1:]
lines = subprocess.run([nm, path], check=True, capture_output=True, text=True).stdout.splitlines()
own = tuple(f'_ZN{qualifier}3hwy{len(namespace)}{namespace}' for qualifier in ('', 'K'))
found = [line[19:] for line in lines if line[17:18] == WEAK and not line[19:].startswith(own)]
for name in found:
    print(f'{path}: {name}: other files could come to use this function')
if not any(line[17:18] in 'Tt' for line in lines):
    sys.exit(f'{path}: has no function at all')
sys.exit(1 if found else 0)
