#!/usr/bin/python3
"""What READMEs show is what is compiled: each region of a C file, between /* [name */ and /* name] */, stands in every
page. usage: check_readme.py FILE.c PAGE.md..."""
import re
import sys
import textwrap


def main():
    with open(sys.argv[1], encoding="utf-8") as stream:
        regions = re.findall(r"^ */\* \[([^*]+) \*/\n(.*?)^ */\* \1\] \*/$", stream.read(), re.MULTILINE | re.DOTALL)
    if not regions:
        sys.exit(f"{sys.argv[1]} has no regions")
    for page in sys.argv[2:]:
        with open(page, encoding="utf-8") as stream:
            text = stream.read()
        for name, lines in regions:
            lines = textwrap.dedent(lines)
            if "```c\n" + lines + "```" not in text:
                sys.exit(f"{page} does not show '{name}' of {sys.argv[1]}:\n{lines}")


main()
