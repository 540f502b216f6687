#!/usr/bin/env python3
"""Packs the add-on for Blender's "Install": the same files give the same bytes.

usage: make_zip.py FOLDER LICENSE OUT.zip    FOLDER: the package sightcell
"""
import os
import sys
import zipfile

FIRST_DAY = 1980, 1, 1, 0, 0, 0


def main(folder, license_file, out):
    package = os.path.basename(os.path.normpath(folder))
    files = [(f'{package}/{name}', os.path.join(folder, name)) for name in os.listdir(folder) if name.endswith('.py')]
    files.append((f'{package}/LICENSE', license_file))
    with zipfile.ZipFile(out, 'w') as archive:
        for name, path in sorted(files):
            entry = zipfile.ZipInfo(name, FIRST_DAY)
            entry.compress_type, entry.create_system, entry.external_attr = zipfile.ZIP_DEFLATED, 3, 0o644 << 16
            with open(path, 'rb') as file:
                archive.writestr(entry, file.read(), compresslevel=9)


if __name__ == '__main__':
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
