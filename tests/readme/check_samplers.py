#!/usr/bin/python3
"""docs/sampler-settings.md is what the program prints. usage: check_samplers.py sightcell PAGE"""
import difflib
import subprocess
import sys


def main():
    program, page = sys.argv[1:]
    printed = subprocess.run([program, "samplers", "--markdown"], stdout=subprocess.PIPE, text=True, check=True).stdout
    with open(page, encoding="utf-8") as stream:
        written = stream.read()
    if printed != written:
        sys.stdout.writelines(difflib.unified_diff(written.splitlines(True), printed.splitlines(True), page, "printed"))
        sys.exit(f"{page} differs; write it again: sightcell samplers --markdown > {page}")


main()
