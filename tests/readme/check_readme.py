#!/usr/bin/python3
"""The snippets of README.md and docs/ are compiled and run: each block of C or JavaScript is a region of a source, between
/* [name */ and /* name] */, and each region is in a document. usage: check_readme.py ROOT SOURCE..."""
import glob
import os
import re
import sys
import textwrap

LANGUAGES = {".c": "c", ".mjs": "js"}


def regions_of(source):
    """(language, name, text) of each region."""
    with open(source, encoding="utf-8") as stream:
        found = re.findall(r"^ */\* \[([^*]+) \*/\n(.*?)^ */\* \1\] \*/$", stream.read(), re.MULTILINE | re.DOTALL)
    if not found:
        sys.exit(f"{source} has no regions")
    return [(LANGUAGES[os.path.splitext(source)[1]], name, textwrap.dedent(lines)) for name, lines in found]


def main():
    root, sources = sys.argv[1], sys.argv[2:]
    regions = [region for source in sources for region in regions_of(source)]
    pages = [os.path.join(root, "README.md"), *sorted(glob.glob(os.path.join(root, "docs/**/*.md"), recursive=True))]
    shown = set()
    for page in pages:
        with open(page, encoding="utf-8") as stream:
            blocks = re.findall(r"^```(c|js)\n(.*?)^```$", stream.read(), re.MULTILINE | re.DOTALL)
        if page == pages[0] and not blocks:
            sys.exit("README.md has no snippet")
        for language, lines in blocks:
            names = [name for l, name, text in regions if (l, text) == (language, lines)]
            if not names:
                sys.exit(f"{page} has a snippet that is no region of {' '.join(sources)}:\n{lines}")
            shown.update(names)
    missing = sorted({name for _, name, _ in regions} - shown)
    if missing:
        sys.exit(f"no document shows: {', '.join(missing)}")


main()
