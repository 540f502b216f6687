#!/usr/bin/env python3
"""Compresses a .tgz file anew with zopfli, which finds a shorter code than zlib for the same contents: 7 % fewer bytes.

usage: recompress.py ZOPFLI FILE.tgz
"""
import gzip
import os
import subprocess
import sys


def main():
    zopfli, path = sys.argv[1:]
    tar = f'{path}.tar'
    with gzip.open(path) as file, open(tar, 'wb') as out:
        out.write(file.read())
    try:
        compressed = subprocess.run([zopfli, '-c', tar], check=True, capture_output=True).stdout
    finally:
        os.remove(tar)
    with open(path, 'wb') as out:
        out.write(compressed)


if __name__ == '__main__':
    main()
