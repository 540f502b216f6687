#!/usr/bin/env python3
"""The worked example of SPEC.md is the golden file, byte for byte. usage: spec_example_test.py SPEC.md v1_tiny.pvs"""
import re
import sys

with open(sys.argv[1], encoding="utf-8") as spec:
    rows = re.findall(r"^([0-9a-f]{4})  ((?:[0-9a-f]{2} ?)+)(?: |$)", spec.read(), re.MULTILINE)
with open(sys.argv[2], "rb") as file:
    expected = file.read()
example = b""
for offset, text in rows:
    if int(offset, 16) != len(example):
        sys.exit(f"row {offset} does not follow: {len(example):04x} was expected")
    example += bytes.fromhex(text)
if not rows or example != expected:
    sys.exit(f"the example has {len(example)} bytes and differs from the file of {len(expected)}")
