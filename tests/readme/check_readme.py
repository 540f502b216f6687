#!/usr/bin/python3
"""The lines that a README shows are the lines that are compiled. usage: check_readme.py ten_lines.c README.md..."""
import sys
import textwrap


def main():
    source = open(sys.argv[1], encoding="utf-8").read()
    begin, end = "  /* [ten lines */\n", "  /* ten lines] */\n"
    lines = textwrap.dedent(source[source.index(begin) + len(begin):source.index(end)])
    for page in sys.argv[2:]:
        if "```c\n" + lines + "```" not in open(page, encoding="utf-8").read():
            sys.exit(f"{page} does not show the ten lines of {sys.argv[1]}:\n{lines}")


main()
