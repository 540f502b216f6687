#!/usr/bin/env python3
"""Prints the SHA-256 of a .pvs file and that of everything in it but the settings.

usage: section_hashes.py FILE.pvs ...

The settings name the device that baked the file. So files of two devices differ in the settings, and in the checksums, the
offsets and the total size that depend on them. The second hash is over the other header fields and sections: equal hashes
mean equal cells, sets, orders and certificates. format/SPEC.md describes header and sections.
"""
import hashlib
import struct
import sys

SETTINGS = 6  # id of the section
SIZE, FINGERPRINT, CHECKSUMS = 16, 24, 88  # offsets in the header
TABLE, RECORD = 96, 32  # offset of the section table, bytes of one of its records


def without_settings(content):
    """The hash over the header fields and over all sections but the settings, by id."""
    if content[:4] != b"\x89PVS" or struct.unpack_from("<I", content, 8) != (1,):
        sys.exit("section_hashes.py: not a .pvs file of version 1")
    count, = struct.unpack_from("<I", content, 12)
    records = sorted(struct.unpack_from("<IIQQ", content, TABLE + RECORD * i) for i in range(count))
    total = hashlib.sha256(content[:SIZE] + content[FINGERPRINT:CHECKSUMS])
    for number, flags, offset, size in records:
        if number != SETTINGS:
            total.update(struct.pack("<IIQ", number, flags, size) + content[offset:offset + size])
    return total.hexdigest()


for path in sys.argv[1:]:
    with open(path, "rb") as stream:
        whole = stream.read()
    print(f"{path}: file {hashlib.sha256(whole).hexdigest()[:16]}, without settings {without_settings(whole)[:16]}")
